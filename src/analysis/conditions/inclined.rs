//! Conditions along directions that are no coordinate axes: n·u is prescribed, with a unit vector n.
//!
//! Several conditions at a node are made orthogonal to each other, coordinate axes first, by Gram and Schmidt: with a_k the
//! directions that there are and w_k what is prescribed along them, n·u = w becomes
//!
//! ```text
//!     a·u = (w - Σ (a_k·n) w_k) / s,     s a = n - Σ (a_k·n) a_k,   |a| = 1.
//! ```
//!
//! Where s is 0, n lies among the others, and w has to be what they make of it.

use super::Conditions;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::scene::Located;
use crate::system::dofs::{Motion, Prescribed, node_name};
use crate::{Mat3, Vec3};
use std::collections::BTreeMap;

/// Sine of the angle between a direction and others below which it lies among them.
const AMONG: f64 = 1e-6;
/// Sine of the angle from which it says something of its own that is worth solving for.
const APART: f64 = 1e-3;
/// Distance of a unit vector from a coordinate axis that is rounding.
const AXIS: f64 = 1e-12;

/// A condition along a direction.
#[derive(Clone, Debug)]
struct Condition<'s> {
    normal: Vec3,
    by: f64,
    course: u32,
    set: &'s Located<String>,
}

/// Those of the nodes that this rank owns, of nodes that move as one at the first.
#[derive(Clone, Debug, Default)]
pub(super) struct Inclined<'s>(BTreeMap<u32, Vec<Condition<'s>>>);

/// The coordinate axis that a unit vector is.
pub(super) fn axis_of(normal: &Vec3) -> Option<usize> {
    (0..3).find(|&d| (normal.abs() - Vec3::ith(d, 1.0)).amax() <= AXIS)
}

impl<'s> Inclined<'s> {
    /// Prescribes how a node moves along a unit vector.
    pub fn add(&mut self, node: u32, set: &'s Located<String>, normal: Vec3, (by, course): (f64, u32)) {
        self.0.entry(node).or_default().push(Condition { normal, by, course, set });
    }

    /// Adds them to the conditions along the coordinate axes of nodes that are displaced by `u`.
    ///
    /// # Errors
    /// Conditions that contradict each other, or nearly do; in a model with ties.
    pub fn add_to(&self, conditions: &mut Conditions, model: &Model, u: &[Vec3]) -> Result<()> {
        for (&n, of_node) in &self.0 {
            if let Some(tie) = model.joints.first() {
                let what =
                    format!("an inclined condition, beside tie `{}`: ties know the coordinate axes alone", tie.name);
                let help = "turn the model so that the condition is along an axis, or mesh the bodies as one";
                return Err(Error::input(&of_node[0].set.at, what, help));
            }
            let n = n as usize;
            let slots = 3 * n..3 * n + 3;
            if conditions.prescribed[slots.clone()].iter().flatten().any(|motion| motion.turn.is_some()) {
                let set = of_node[0].set;
                let what =
                    format!("node {} of `{}` is turned, too, by `rotate`", node_name(model, n as u32), set.value);
                return Err(Error::input(&set.at, what, "take it out of one of the two sets"));
            }
            let mut frame = Frame::new(&conditions.prescribed[slots.clone()]);
            for condition in of_node {
                frame.add(condition).map_err(|(what, help)| {
                    let node = node_name(model, n as u32);
                    Error::input(&condition.set.at, format!("node {node} of `{}` {what}", condition.set.value), help)
                })?;
            }
            let Some((axes, motions)) = frame.finish(&u[n]) else { continue };
            conditions.axes.set(n, axes);
            conditions.prescribed[slots].copy_from_slice(&motions);
        }
        Ok(())
    }
}

/// The directions of a node, as far as they are known, with the motions along them: how far, on which course.
struct Frame {
    along: [Option<(Vec3, f64, u32)>; 3],
    is_inclined: bool,
}

impl Frame {
    /// Along the coordinate axes.
    fn new(prescribed: &[Prescribed]) -> Self {
        let of = |d: usize| prescribed[d].map(|motion| (Vec3::ith(d, 1.0), motion.by, motion.course));
        Self { along: [of(0), of(1), of(2)], is_inclined: false }
    }

    /// Adds a condition; else what is wrong with it, and what would be right.
    fn add(&mut self, condition: &Condition) -> std::result::Result<(), (String, &'static str)> {
        let Condition { normal, by, mut course, .. } = *condition;
        let (mut rest, mut left, mut size) = (normal, by, by.abs());
        for (axis, own, own_course) in self.along.iter().flatten() {
            let part = axis.dot(&normal);
            rest -= axis * part;
            let share = part * own;
            if share.abs() > AMONG * own.abs() {
                if left == 0.0 {
                    course = *own_course;
                } else if course != *own_course {
                    let what = "is moved along inclined directions by two tables";
                    return Err((what.into(), "give both motions the same table"));
                }
                left -= share;
                size = size.max(share.abs());
            }
        }
        let told = format!("({:.6}, {:.6}, {:.6})", normal.x, normal.y, normal.z);
        let sine = rest.norm();
        if sine < AMONG {
            let what = format!("is already moved otherwise along {told} by other conditions of this step");
            let help = "restrict one of them, or take the node out of one set";
            return if left.abs() <= AMONG * size { Ok(()) } else { Err((what, help)) };
        }
        let Some(slot) = self.along.iter_mut().find(|slot| slot.is_none()).filter(|_| sine >= APART) else {
            let what = format!("is held along {told} and, but for {sine:.1e}, along the same by other conditions");
            return Err((what, "give planes that are meant to be one the same normal, with all digits"));
        };
        *slot = Some((rest / sine, if left.abs() <= AMONG * size { 0.0 } else { left / sine }, course));
        self.is_inclined = true;
        Ok(())
    }

    /// All directions, and the motions along them of a node that is displaced by `u`; `None` where they are the coordinate axes.
    fn finish(&self, u: &Vec3) -> Option<(Mat3, [Prescribed; 3])> {
        if !self.is_inclined {
            return None;
        }
        let mut axes = self.along.map(|known| known.map(|(axis, ..)| axis));
        for d in 0..3 {
            if axes[d].is_none() {
                // The coordinate axis that is farthest from all others.
                let rest = |k: usize| {
                    let axis = Vec3::ith(k, 1.0);
                    let without = |v: Vec3| axes.iter().flatten().fold(v, |v, a| v - a * a.dot(&v));
                    without(without(axis))
                };
                let all = [0, 1, 2].map(|k| rest((d + k) % 3));
                let farthest =
                    all.iter().fold(all[0], |most, v| if v.norm() > most.norm() + AMONG { *v } else { most });
                axes[d] = Some(farthest.normalize());
            }
        }
        let motion =
            |d: usize| self.along[d].map(|(axis, by, course)| Motion { from: axis.dot(u), by, course, turn: None });
        let columns = axes.map(Option::unwrap_or_default);
        Some((Mat3::from_columns(&columns), [motion(0), motion(1), motion(2)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(set: &Located<String>, normal: Vec3, by: f64, course: u32) -> Condition<'_> {
        Condition { normal: normal.normalize(), by, course, set }
    }

    /// Two planes through an axis, at an angle of 30 degrees, of which one moves: where they meet both hold.
    #[test]
    fn inclined_conditions_that_meet_all_hold() {
        let set = Located::given("sector.amin");
        let (sine, cosine) = 30f64.to_radians().sin_cos();
        let planes = [(Vec3::new(sine, -cosine, 0.2), 0.3), (Vec3::new(0.1, 1.0, 0.0), 0.0)];
        let mut frame = Frame::new(&[None, None, Some(Motion { by: -0.7, course: 2, ..Motion::still(0.0) })]);
        for (normal, by) in planes {
            frame.add(&condition(&set, normal, by, 2)).unwrap();
        }
        let (axes, motions) = frame.finish(&Vec3::zeros()).unwrap();
        assert!((axes.transpose() * axes - Mat3::identity()).norm() < 1e-15);
        let u = axes * Vec3::from(motions.map(|m| m.unwrap().by));
        for (normal, by) in planes.into_iter().chain([(Vec3::z(), -0.7)]) {
            assert!((normal.normalize().dot(&u) - by).abs() < 1e-14, "{normal}");
        }
        // A plane among them must agree.
        assert!(
            frame
                .add(&condition(&set, Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, 3.0).normalize().dot(&u), 2))
                .is_ok()
        );
        let error = frame.add(&condition(&set, Vec3::new(1.0, 2.0, 3.0), 0.0, 0)).unwrap_err().0;
        assert!(error.starts_with("is already moved otherwise along (0.26"), "{error}");
    }

    #[test]
    fn planes_that_are_nearly_one_and_tables_that_differ_are_refused() {
        let set = Located::given("a.b");
        let mut frame = Frame::new(&[None; 3]);
        frame.add(&condition(&set, Vec3::new(0.866, 0.5, 0.0), 0.0, 0)).unwrap();
        let error = frame.add(&condition(&set, Vec3::new(0.8660254, 0.5, 0.0), 0.0, 0)).unwrap_err().0;
        assert!(error.contains("but for 1.") && error.contains("e-5, along the same"), "{error}");
        frame.add(&condition(&set, Vec3::new(0.0, 0.6, 0.8), 0.1, 1)).unwrap();
        assert!(frame.add(&condition(&set, Vec3::new(0.0, 0.9, 0.1), 0.1, 3)).is_err());
    }
}
