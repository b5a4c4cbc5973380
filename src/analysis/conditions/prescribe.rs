//! The displacements that a step prescribes: along the coordinate axes, along a direction, in a cylindrical frame, on circles.

use super::inclined::{self, Inclined};
use super::{AxisOfSet, Conditions, ToolMotion};
use crate::contact::moves::alike;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::scene::{Around, Located, Reduction, Rotation, Step};
use crate::system::dofs::{Motion, Turn, node_name};
use crate::{AXIS_NAMES, Vec3};

/// Over the size of the model, what is no distance from an axis.
const ON_AXIS: f64 = 1e-12;

/// How a set moves: where from, how far, on which course.
#[derive(Clone, Copy)]
struct Way<'a> {
    set: &'a Located<String>,
    /// Of all nodes at the start of the step.
    u: &'a [Vec3],
    by: Vec3,
    course: u32,
    rotation: Option<&'a Rotation>,
}

impl<'a> Way<'a> {
    fn still(set: &'a Located<String>, u: &'a [Vec3]) -> Self {
        Self { set, u, by: Vec3::zeros(), course: 0, rotation: None }
    }

    /// The motion of a node along a coordinate axis.
    fn motion(&self, model: &Model, node: usize, d: usize) -> Motion {
        let from = self.u[node];
        let turn = self.rotation.filter(|rotation| rotation.angle != 0.0).and_then(|rotation| {
            let axis = rotation.axis.normalize();
            let arm = model.part.points[node] + from - rotation.point;
            let (outward, ahead) = (arm - axis * axis.dot(&arm), axis.cross(&arm));
            let moves = outward[d].abs().max(ahead[d].abs()) > ON_AXIS * model.size;
            moves.then(|| Turn { angle: rotation.angle.to_radians(), outward: outward[d], ahead: ahead[d] })
        });
        Motion { from: from[d], by: self.by[d], course: self.course, turn }
    }
}

impl Conditions {
    pub(super) fn prescribe(&mut self, model: &Model, step: &Step, u: &[Vec3]) -> Result<()> {
        let mut inclined = Inclined::default();
        for fix in &step.fix {
            let way = Way::still(&fix.set, u);
            match (&fix.around, fix.normal) {
                (Some(around), _) => self.prescribe_around(model, around, &way, &mut inclined)?,
                (None, Some(normal)) => self.prescribe_along(model, &normal, &way, &mut inclined)?,
                (None, None) => self.prescribe_set(model, &fix.directions, &way)?,
            }
        }
        for motion in &step.moves {
            let course = self.number(&motion.table);
            let rotation = motion.rotate.as_ref();
            let way = Way { by: motion.by, course, rotation, ..Way::still(&motion.target, u) };
            if let Some(tool) = model.tool_named(&motion.target.value) {
                let own = &mut self.motions[tool];
                *own = ToolMotion { by: motion.by, rotation: motion.rotate, course, ..*own };
            } else if let Some(around) = &motion.around {
                self.prescribe_around(model, around, &Way { by: around.by, ..way }, &mut inclined)?;
            } else if let Some(normal) = motion.normal {
                self.prescribe_along(model, &normal, &way, &mut inclined)?;
            } else {
                self.prescribe_set(model, &motion.directions, &way)?;
                if let Some(Rotation { point, axis, .. }) = motion.rotate {
                    let axis = AxisOfSet { point, axis: axis.normalize(), by: motion.by, course };
                    self.axes_of_sets.insert(motion.target.value.clone(), axis);
                }
            }
        }
        for plane in &model.symmetry {
            self.prescribe_along(model, &plane.normal, &Way::still(&plane.set, u), &mut inclined)?;
        }
        for n in 0..model.part.owned {
            if model.bodies[model.part.body[n] as usize].is_layer() {
                self.prescribed[3 * n + 2] = Some(Motion::still(u[n].z));
            }
            if model.is_on_axis(n) {
                self.prescribed[3 * n] = Some(Motion::still(u[n].x));
            }
        }
        inclined.add_to(self, model, u)?;
        for n in 0..model.part.owned {
            let one = model.part.tie[n] as usize;
            (0..3).for_each(|d| self.prescribed[3 * n + d] = self.prescribed[3 * one + d]);
            if let Some(axes) = self.axes.of(one).copied() {
                self.axes.set(n, axes);
            }
        }
        Ok(())
    }

    /// Along a unit vector.
    fn prescribe_along<'s>(
        &mut self,
        model: &Model,
        normal: &Vec3,
        way: &Way<'s>,
        inclined: &mut Inclined<'s>,
    ) -> Result<()> {
        let by = normal.dot(&way.by);
        if let Some(axis) = inclined::axis_of(normal) {
            return self.prescribe_set(model, &[0, 1, 2].map(|d| d == axis), &Way { by: normal * by, ..*way });
        }
        for &n in &model.set(&way.set.value).nodes {
            inclined.add(model.part.tie[n as usize], way.set, *normal, (by, way.course));
        }
        Ok(())
    }

    /// In the directions that each node has in a cylindrical frame.
    fn prescribe_around<'s>(
        &mut self,
        model: &Model,
        around: &Around,
        way: &Way<'s>,
        inclined: &mut Inclined<'s>,
    ) -> Result<()> {
        let directions = around.directions;
        for &n in &model.set(&way.set.value).nodes {
            let (radius, frame) = around.frame(&model.part.points[n as usize]);
            if radius <= ON_AXIS * model.size && (directions[0] || directions[1]) {
                let what = format!("node {} of `{}` is on the axis of `around`", node_name(model, n), way.set.value);
                let help = "take it out of the set: no direction leads away from the axis there; or keep \"z\" alone";
                return Err(Error::input(&way.set.at, what, help));
            }
            for d in (0..3).filter(|&d| directions[d]) {
                match inclined::axis_of(&frame[d]) {
                    Some(along) => {
                        let only = [0, 1, 2].map(|d| d == along);
                        self.prescribe_node(model, n, &only, &Way { by: frame[d] * way.by[d], ..*way })?;
                    }
                    None => inclined.add(model.part.tie[n as usize], way.set, frame[d], (way.by[d], way.course)),
                }
            }
        }
        Ok(())
    }

    fn prescribe_set(&mut self, model: &Model, directions: &[bool; 3], way: &Way) -> Result<()> {
        let nodes = &model.set(&way.set.value).nodes;
        nodes.iter().try_for_each(|&n| self.prescribe_node(model, n, directions, way))
    }

    fn prescribe_node(&mut self, model: &Model, n: u32, directions: &[bool; 3], way: &Way) -> Result<()> {
        let Located { value: set, at } = way.set;
        let (n, by) = (n as usize, way.by);
        let body = &model.bodies[model.part.body[n] as usize];
        if let Some(reduction) = body.reduction {
            let refuse = |what: &str, help: String| {
                Err(Error::input(at, format!("body `{}` is {}, {what}", body.name, reduction.words()), help))
            };
            let key = reduction.key();
            if directions[2] && by.z != 0.0 {
                return refuse(
                    "where nothing moves along z",
                    format!("take `{key}` out, or make the motion along z 0"),
                );
            }
            let is_ring = reduction == Reduction::Axisymmetric;
            if way.rotation.is_some_and(|rotation| is_ring || !rotation.is_along(2)) {
                let help = if is_ring { "" } else { ", or turn the set about z" };
                return refuse("where nothing turns so", format!("take `{key}` out{help}"));
            }
        }
        if model.is_on_axis(n) && directions[0] && by.x != 0.0 {
            let what = format!("node {} of `{set}` is on the axis, and cannot move along x", model.part.id[n]);
            let help = "leave x out of `directions`, or name a group that ends before the axis";
            return Err(Error::input(at, what, help));
        }
        // Nodes that move as one are prescribed as one.
        let one = model.part.tie[n] as usize;
        for d in (0..3).filter(|&d| directions[d]) {
            let motion = way.motion(model, one, d);
            let slot = &mut self.prescribed[3 * one + d];
            if slot.is_some_and(|other| !is_same(&other, &motion)) {
                let (node, axis) = (model.part.id[n], AXIS_NAMES[d]);
                let what = format!(
                    "node {node} of `{set}` is already moved otherwise along {axis} by another condition of this step"
                );
                return Err(Error::input(
                    at,
                    what,
                    "restrict one of them with `directions`, or take the node out of one set",
                ));
            }
            *slot = Some(motion);
        }
        Ok(())
    }
}

/// Whether two motions of a component of a node are the same.
fn is_same(a: &Motion, b: &Motion) -> bool {
    match (a.turn, b.turn) {
        (None, None) => alike(a.way(), b.way()),
        // By one condition for two sets with a common edge.
        _ => a == b,
    }
}
