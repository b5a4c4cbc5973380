//! What a step prescribes: displacements, tool motions and loads, as functions of the fraction s of the step.
//!
//! Displacements are relative to the start of the step. A load ramps linearly from its value at the end of the last step;
//! one that a step does not list falls to zero over it. A tool that a step hands over to a force begins with the force that
//! it has.
//!
//! With a table A(s) in the place of the ramp, a motion is A(s) times what is listed, and a load L
//!
//! ```text
//! f(s) = (f0 - A(0) L) (1 - s) + A(s) L = f0 (1 - s) + f1 s + [A(s) - A(0) (1 - s) - A(1) s] L,     f1 = A(1) L
//! ```
//!
//! with f0 the value at the end of the last step: A(s) L where that is A(0) L, as scenes must have it; what a tool was held by
//! before a force took it over falls to zero beside it. In brackets is the bow of the table over its chord.

mod inclined;
mod prescribe;

use crate::contact::moves::{RIGHT, way};
use crate::contact::pose::are_along;
use crate::contact::{Axle, Movement, Pair, Pose, Tool};
use crate::error::Result;
use crate::model::{Model, axisymmetric, elements, plane_strain};
use crate::parallel::sum;
use crate::partition::PartSolid;
use crate::scene::{Amplitude, Formulation, Reduction, Rotation, Spin, Step, Torque};
use crate::surface::normals::tangents;
use crate::system::Axes;
use crate::system::dofs::{Motion, Prescribed, ToolFreedom};
use crate::{Mat3, Vec3};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;
use std::ops::{Add, Mul, Sub};
use std::sync::Arc;

/// Motion of a tool over the step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ToolMotion {
    pub by: Vec3,
    pub rotation: Option<Rotation>,
    /// The course of both, as that of a [`Motion`].
    pub course: u32,
    pub free: [bool; 3],
    /// The axis about which a torque turns it, at the start of the step but for what forces have moved it by.
    pub axle: Option<Axle>,
}

impl ToolMotion {
    /// How it moves all points of the tool: along the axis of a turn as it moves the tool, across it no two alike.
    fn movement(&self) -> Movement {
        // Cosines below this are rounding.
        const NONE: f64 = 1e-14;
        let turn = self.rotation.map(|turn| turn.axis.normalize()).or(self.axle.map(|axle| axle.axis));
        let axes = match turn.filter(|axis| !(0..3).any(|d| are_along(axis, &Vec3::ith(d, 1.0)))) {
            Some(axis) => {
                let [a, b] = tangents(&axis);
                Mat3::from_columns(&[axis, a, b])
            }
            None => Mat3::identity(),
        };
        // Of what turns besides nothing is known across the axis, against which digits of a way along it would be found to be none.
        let along = |direction: &Vec3| {
            let along = self.by.dot(direction);
            if turn.is_some() && along.abs() <= RIGHT * self.by.norm() { 0.0 } else { along }
        };
        let way_along = |direction: Vec3| {
            let is_free = (0..3).any(|d| self.free[d] && direction[d].abs() > NONE);
            let is_across = turn.is_some_and(|axis| !are_along(&axis, &direction));
            match is_across {
                _ if is_free || is_across && self.axle.is_some() => f64::NAN,
                true => f64::INFINITY,
                false => way(along(&direction), self.course),
            }
        };
        Movement { axes, ways: [0, 1, 2].map(|d| way_along(axes.column(d).into_owned())) }
    }
}

/// The springs and dashpots between a node and the ground, along the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footing {
    /// Force per length.
    pub stiffness: Vec3,
    /// Force per velocity.
    pub damping: Vec3,
}

impl Footing {
    /// Along which axes it resists a motion.
    pub fn resists(&self) -> [bool; 3] {
        [0, 1, 2].map(|d| self.stiffness[d] > 0.0 || self.damping[d] > 0.0)
    }
}

/// A load at the start and at the end of a step, and what of it has a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ramp<T> {
    pub from: T,
    pub to: T,
    /// What of the end has no table.
    even: T,
    /// Loads with their tables.
    bows: Vec<(Arc<Amplitude>, T)>,
}

impl<T> Ramp<T>
where
    T: Copy + Default + PartialEq + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    /// Its value at fraction `s` of the step.
    pub fn at(&self, s: f64) -> T {
        if self.is_straight() {
            return self.from + (self.to - self.from) * s;
        }
        // Nothing but the sum of what acts, so that where all tables are at 0 it is none.
        let from = self.bows.iter().fold(self.from, |from, (table, load)| from - *load * table.begin());
        let straight = from * (1.0 - s) + self.even * s;
        self.bows.iter().fold(straight, |sum, (table, load)| sum + *load * table.at(s))
    }

    /// Adds a load, by a table if it has one.
    fn add(&mut self, load: T, table: Option<&Arc<Amplitude>>) {
        self.to = self.to + load * table.map_or(1.0, |table| table.end());
        self.even = if table.is_none() { self.even + load } else { self.even };
        self.bows.extend(table.map(|table| (table.clone(), load)));
    }

    /// The load that goes on from it in the next step, to zero.
    fn fading(&self) -> Self {
        Self { from: self.to, ..Self::default() }
    }

    /// What is left when the step ends at fraction `s`.
    fn end_at(&mut self, s: f64) {
        let to = self.at(s);
        *self = Self { from: self.from, to, even: to, bows: Vec::new() };
    }

    pub fn is_straight(&self) -> bool {
        self.bows.is_empty()
    }

    /// Whether it is the same all over the step.
    pub fn stays(&self) -> bool {
        self.from == self.to && self.is_straight()
    }

    /// Whether it is to act, later in the step or at its end.
    pub fn acts(&self) -> bool {
        self.to != T::default() || !self.is_straight()
    }
}

/// A body that spins, with the masses of its owned nodes.
#[derive(Clone, Debug)]
pub struct Spinning {
    body: String,
    pub point: Vec3,
    /// A unit vector.
    pub axis: Vec3,
    /// The square of the angular velocity.
    pub square: Ramp<f64>,
    pub masses: BTreeMap<u32, f64>,
}

impl Spinning {
    /// The part of a vector across the axis, I - e eᵀ; around the axis of rings nothing acts.
    pub fn across(&self, is_ring: bool) -> Mat3 {
        if is_ring { Mat3::from_diagonal(&Vec3::x()) } else { Mat3::identity() - self.axis * self.axis.transpose() }
    }
}

/// The conditions of a step on this rank.
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    /// Three entries an owned node, along its directions.
    pub prescribed: Vec<Prescribed>,
    /// The directions of owned nodes.
    pub axes: Axes,
    pub motions: Vec<ToolMotion>,
    /// Dead load on each owned node, N.
    pub loads: Vec<Ramp<Vec3>>,
    /// Centrifugal loads.
    pub spins: Vec<Spinning>,
    /// Follower pressure by set.
    pub pressures: BTreeMap<String, Ramp<f64>>,
    /// Force on each tool, N; then for each the torque about its axis over its lever, in the first place.
    pub tool_forces: Vec<Ramp<Vec3>>,
    /// Of overlaps that are taken back little by little: 1 before the first step, and like any load that ends 0 after it.
    pub overlaps: Ramp<f64>,
    /// Springs and dashpots between owned nodes and the ground.
    pub springs: BTreeMap<u32, Footing>,
    /// Owned nodes that are in a set which something supports or moves; another node may move as one with them.
    pub supported: Vec<bool>,
    /// Of the step, a time.
    pub duration: f64,
    /// Tables of motions, from course 1 on.
    courses: Vec<Amplitude>,
    /// The axes about which sets turn, or did last.
    axes_of_sets: BTreeMap<String, AxisOfSet>,
}

/// The axis about which a set turns, and which goes along with it.
#[derive(Clone, Copy, Debug)]
struct AxisOfSet {
    /// At the start of the step.
    point: Vec3,
    /// A unit vector.
    axis: Vec3,
    by: Vec3,
    course: u32,
}

impl Conditions {
    /// No conditions: what is before the first step.
    pub fn none(model: &Model) -> Self {
        Self {
            loads: vec![Ramp::default(); model.part.owned],
            tool_forces: vec![Ramp::default(); 2 * model.masters.tools.len()],
            overlaps: Ramp { to: 1.0, ..Ramp::default() },
            ..Self::default()
        }
    }

    /// The conditions of `step`, which begins at displacements `u` with the loads that `last` ended with. Collective.
    ///
    /// # Errors
    /// Two conditions that contradict each other at a node; only on the rank that owns it. What axisymmetric bodies cannot have.
    pub fn new(comm: &SimpleCommunicator, model: &Model, step: &Step, u: &[Vec3], last: &Self) -> Result<Self> {
        axisymmetric::check_step(model, step)?;
        plane_strain::check_step(model, step)?;
        let mut conditions = Self {
            prescribed: vec![None; 3 * model.part.owned],
            axes: Axes::default(),
            motions: vec![ToolMotion::default(); model.masters.tools.len()],
            loads: last.loads.iter().map(Ramp::fading).collect(),
            spins: Vec::new(),
            pressures: (last.pressures.iter().filter(|(_, p)| p.to != 0.0))
                .map(|(set, p)| (set.clone(), p.fading()))
                .collect(),
            tool_forces: last.tool_forces.iter().map(Ramp::fading).collect(),
            overlaps: last.overlaps.fading(),
            springs: BTreeMap::new(),
            supported: vec![false; model.part.owned],
            duration: step.duration,
            courses: Vec::new(),
            axes_of_sets: last.axes_of_sets.iter().map(|(set, axis)| (set.clone(), last.stopped(axis, 1.0))).collect(),
        };
        for pressure in &step.pressures {
            let ramp = conditions.pressures.entry(pressure.set.value.clone()).or_default();
            ramp.add(pressure.value, shared(&pressure.table).as_ref());
        }
        conditions.add_body_forces(model, step);
        conditions.add_spins(model, step, last)?;
        conditions.add_forces(comm, model, step);
        step.torques.iter().for_each(|torque| conditions.add_torque(comm, model, torque));
        for spring in &step.springs {
            for (n, weight) in nodal_weights(comm, model, &spring.set.value) {
                conditions.springs.entry(n).or_default().stiffness += spring.stiffness * weight;
            }
        }
        for dashpot in &step.dashpots {
            for (n, weight) in nodal_weights(comm, model, &dashpot.set.value) {
                conditions.springs.entry(n).or_default().damping += dashpot.damping * weight;
            }
        }
        conditions.prescribe(model, step, u)?;
        conditions.note_supported(model, step);
        Ok(conditions)
    }

    /// Takes note of the nodes of the sets that the step, or a plane of symmetry, supports or moves.
    fn note_supported(&mut self, model: &Model, step: &Step) {
        let moved = step.moves.iter().map(|motion| &motion.target.value);
        let footed = step.springs.iter().map(|spring| &spring.set.value);
        let damped = step.dashpots.iter().map(|dashpot| &dashpot.set.value);
        let mirrored = model.symmetry.iter().map(|plane| &plane.set.value);
        let fixed = step.fix.iter().map(|fix| &fix.set.value);
        for set in fixed.chain(moved).chain(footed).chain(damped).chain(mirrored).filter_map(|set| model.find_set(set))
        {
            let owned = set.nodes.iter().filter(|n| (**n as usize) < model.part.owned);
            owned.for_each(|&n| self.supported[n as usize] = true);
        }
    }

    /// Lets tools that were not driven by force, or by torque about the same line, until now begin with the contact forces that hold
    /// them and, after those of all, their moments about the origin, of the last converged increment; tools are at `poses`.
    pub fn hand_over(&mut self, last: &Self, contact_forces: &[Vec3], poses: &[Pose]) {
        let tools = self.motions.len();
        let (forces, moments) = contact_forces.split_at(tools);
        for (t, motion) in self.motions.iter().enumerate() {
            let Some(axle) = motion.axle else { continue };
            let axle = Axle { point: axle.point + poses[t].driven, ..axle };
            let drove = last.motions.get(t).is_some_and(|last| last.axle.is_some());
            let old = poses[t].axle_in_space().filter(|_| drove);
            let from = &mut self.tool_forces[tools + t].from;
            *from = match old.and_then(|old| Some(*from * (old.sense_on_line(&axle)? * old.lever / axle.lever))) {
                Some(same) => same,
                None => Vec3::x() * -axle.drive(&forces[t], &moments[t]),
            };
        }
        for (t, (ramp, force)) in self.tool_forces.iter_mut().zip(forces).enumerate() {
            for d in 0..3 {
                if self.motions[t].free[d] && !last.motions.get(t).is_some_and(|m| m.free[d]) {
                    ramp.from[d] = -force[d];
                }
            }
        }
    }

    /// Puts the tools where they are at fraction `s` of the step, which they began at `poses`, moved on by `offsets`: along the
    /// directions in which forces drive them and, after those of all, by torques.
    pub fn place_tools(&self, tools: &mut [Tool], poses: &[Pose], offsets: &[Vec3], s: f64) {
        let count = tools.len();
        for (t, tool) in tools.iter_mut().enumerate() {
            tool.trial = self.pose(t, &poses[t], s).driven_by(&offsets[t]);
            let ToolMotion { by, course, axle, .. } = &self.motions[t];
            if let Some(axle) = axle {
                let point = axle.point + tool.trial.driven + by * self.done(*course, s);
                tool.trial = tool.trial.turned_by(&Axle { point, ..*axle }, offsets[count + t].x / axle.lever);
            }
        }
    }

    /// Along which directions a force drives a tool, and about which axis, where that is with the tool at a pose, a torque.
    pub fn driven(&self, t: usize, pose: &Pose) -> ([bool; 3], Option<Axle>) {
        let ToolMotion { free, axle, .. } = self.motions[t];
        let about = |axle: Axle| {
            // One of another line has another lever.
            let now = pose.axle_in_space().filter(|now| now.lever == axle.lever && now.sense(&axle.axis) == Some(1.0));
            now.unwrap_or(Axle { point: axle.point + pose.driven, ..axle })
        };
        (free, axle.map(about))
    }

    /// Where a motion prescribes to be at fraction `s` of the step.
    pub fn place(&self, motion: &Motion, s: f64) -> f64 {
        motion.place(self.done(motion.course, s))
    }

    /// The pose at fraction `s` of the step of tool `t`, which began at `start`, but for what forces move it by.
    pub fn pose(&self, t: usize, start: &Pose, s: f64) -> Pose {
        let ToolMotion { by, rotation, course, .. } = &self.motions[t];
        start.moved(by, rotation.as_ref(), self.done(*course, s))
    }

    /// The table of a course; `None` of a straight one.
    pub fn course(&self, course: u32) -> Option<&Amplitude> {
        course.checked_sub(1).map(|k| &self.courses[k as usize])
    }

    /// The share of a motion that is done at fraction `s`.
    fn done(&self, course: u32, s: f64) -> f64 {
        self.course(course).map_or(s, |table| table.at(s))
    }

    /// The number of the course by a table; like tables have one.
    fn number(&mut self, table: &Option<Amplitude>) -> u32 {
        let Some(table) = table else { return 0 };
        let known = self.courses.iter().position(|known| known == table);
        let k = known.unwrap_or_else(|| {
            self.courses.push(table.clone());
            self.courses.len() - 1
        });
        k as u32 + 1
    }

    /// What the equation numbering needs to know of owned nodes.
    pub fn supports(&self) -> (&[Prescribed], &Axes) {
        (&self.prescribed, &self.axes)
    }

    /// What the equation numbering needs to know of the tools.
    pub fn freedoms(&self) -> Vec<ToolFreedom> {
        let freedom = |m: &ToolMotion| ToolFreedom { free: m.free, turns: m.axle.is_some(), movement: m.movement() };
        self.motions.iter().map(freedom).collect()
    }

    /// How all points of each tool move over the step.
    pub fn movements_of_tools(&self) -> Vec<Movement> {
        self.freedoms().iter().map(|tool| tool.movement).collect()
    }

    /// How an owned node moves over the step.
    pub fn movement(&self, node: u32) -> Movement {
        let of = |d: usize| self.prescribed[3 * node as usize + d].map_or(f64::NAN, |motion| motion.way());
        Movement {
            axes: self.axes.of(node as usize).copied().unwrap_or_else(Mat3::identity),
            ways: [of(0), of(1), of(2)],
        }
    }

    /// A unit vector along which an owned node is prescribed, if it is, as the d-th of three.
    pub fn held_along(&self, node: usize, d: usize) -> Option<Vec3> {
        self.prescribed[3 * node + d].map(|_| self.axes.direction(node, d))
    }

    /// Whether an owned node turns, so that where it goes depends on where it begins.
    pub fn turns(&self, node: usize) -> bool {
        self.prescribed[3 * node..3 * node + 3].iter().flatten().any(|motion| motion.turn.is_some())
    }

    /// How far the prescribed motions of an owned node have moved it at fraction `s` of the step, along its directions: NaN where
    /// it is free.
    pub fn moved(&self, node: usize, s: f64) -> Vec3 {
        let motion = |d: usize| self.prescribed[3 * node + d];
        Vec3::from_fn(|d, _| motion(d).map_or(f64::NAN, |motion| self.place(&motion, s) - motion.from))
    }

    /// The axis about which a set turns, or did last, at fraction `s` of the step: a point and a unit vector.
    pub fn axis_of(&self, set: &str, s: f64) -> Option<(Vec3, Vec3)> {
        self.axes_of_sets.get(set).map(|of_set| (self.stopped(of_set, s).point, of_set.axis))
    }

    /// The same where it is at fraction `s`, and stays.
    fn stopped(&self, of_set: &AxisOfSet, s: f64) -> AxisOfSet {
        let AxisOfSet { point, axis, by, course } = *of_set;
        AxisOfSet { point: point + by * self.done(course, s), axis, by: Vec3::zeros(), course: 0 }
    }

    /// What is left when the step ends at fraction `s`, before its end.
    pub fn ended_at(mut self, s: f64) -> Self {
        let stopped = self.axes_of_sets.iter().map(|(set, of_set)| (set.clone(), self.stopped(of_set, s)));
        self.axes_of_sets = stopped.collect();
        self.loads.iter_mut().chain(&mut self.tool_forces).for_each(|ramp| ramp.end_at(s));
        self.pressures.values_mut().for_each(|ramp| ramp.end_at(s));
        self.spins.iter_mut().for_each(|spin| spin.square.end_at(s));
        self.overlaps.end_at(s);
        self
    }

    /// Whether the tangent is symmetric: no friction, no follower pressure, no F-bar, and forces on deformable masters that
    /// have a potential.
    pub fn is_symmetric(&self, model: &Model) -> bool {
        let potential = |pair: &Pair| model.masters.of(pair.master).has_potential(pair.rules.tangent);
        let conservative =
            model.pairs.iter().all(|p| p.rules.friction == 0.0 && potential(p)) && self.pressures.is_empty();
        conservative && self.has_symmetric_bodies(model)
    }

    /// Whether the tangents of all elements are symmetric: those of F-bar are not.
    pub fn has_symmetric_bodies(&self, model: &Model) -> bool {
        model.sections.iter().all(|section| section.element != Formulation::Hex8Fbar)
    }

    fn add_body_forces(&mut self, model: &Model, step: &Step) {
        for force in step.body_forces.iter().chain(&step.weights) {
            let mut shares: BTreeMap<u32, Vec3> = BTreeMap::new();
            let pulled = |solid: &&PartSolid| match force.section {
                Some(section) => solid.section as usize == section,
                None => model.bodies[solid.body as usize].name == force.body.value,
            };
            for solid in model.part.solids.iter().filter(pulled) {
                let of_solid = elements::body_force(model, solid, &force.per_volume);
                for (&n, share) in solid.nodes().iter().zip(of_solid) {
                    *shares.entry(n).or_default() += share;
                }
            }
            self.load_nodes(shares, &force.table);
        }
    }

    /// Spins of the step, and those of the last one, which end.
    fn add_spins(&mut self, model: &Model, step: &Step, last: &Self) -> Result<()> {
        let fading = last.spins.iter().filter(|spin| spin.square.to != 0.0);
        self.spins = fading.map(|spin| Spinning { square: spin.square.fading(), ..spin.clone() }).collect();
        for spin in &step.spins {
            let body = model.bodies.iter().find(|body| body.name == spin.body.value);
            let is_plane = body.is_some_and(|body| body.reduction == Some(Reduction::PlaneStrain));
            if let Some(error) = spin.across(2, false).filter(|_| is_plane) {
                return Err(error);
            }
            let known =
                self.spins.iter().position(|own| own.body == spin.body.value && spin.is_about(&own.point, &own.axis));
            let k = known.unwrap_or_else(|| {
                let Spin { point, axis, .. } = *spin;
                let (body, masses) = (spin.body.value.clone(), masses(model, spin));
                self.spins.push(Spinning { body, point, axis, square: Ramp::default(), masses });
                self.spins.len() - 1
            });
            self.spins[k].square.add(spin.square, shared(&spin.table).as_ref());
        }
        Ok(())
    }

    /// Loads on nodes of this rank, of which those that it owns count.
    fn load_nodes(&mut self, loads: BTreeMap<u32, Vec3>, table: &Option<Amplitude>) {
        let table = shared(table);
        for (n, load) in loads {
            if let Some(ramp) = self.loads.get_mut(n as usize) {
                ramp.add(load, table.as_ref());
            }
        }
    }

    /// Total forces on sets, spread by reference area, evenly over a set without faces. Collective.
    fn add_forces(&mut self, comm: &SimpleCommunicator, model: &Model, step: &Step) {
        for force in &step.forces {
            if let Some(tool) = model.masters.tools.iter().position(|t| t.name == force.target.value) {
                self.tool_forces[tool].add(force.total, shared(&force.table).as_ref());
                for d in (0..3).filter(|&d| force.directions[d]) {
                    self.motions[tool].free[d] = true;
                }
                continue;
            }
            let weights = nodal_weights(comm, model, &force.target.value);
            self.load_nodes(weights.into_iter().map(|(n, w)| (n, force.total * w)).collect(), &force.table);
        }
    }

    /// A torque, whose lever is the mean distance of the tool's slave nodes from the axis, as they are meshed. Collective.
    fn add_torque(&mut self, comm: &SimpleCommunicator, model: &Model, torque: &Torque) {
        let Some(t) = model.tool_named(&torque.tool.value) else { return };
        let Torque { total, point, axis, table, .. } = torque;
        let slaves = model.pairs.iter().filter(|pair| pair.master.tool() == Some(t)).flat_map(|pair| &pair.slaves);
        let distance = |n: u32| axis.cross(&(model.part.points[n as usize] - point)).norm();
        let mut distances = slaves.fold([0.0; 2], |[sum, count], slave| [sum + distance(slave.node), count + 1.0]);
        sum(comm, &mut distances);
        let lever = Some(distances[0] / distances[1]).filter(|mean| *mean > 0.0).unwrap_or(model.size);
        let ramp = &mut self.tool_forces[model.masters.tools.len() + t];
        ramp.add(Vec3::x() * (total / lever), shared(table).as_ref());
        self.motions[t].axle = Some(Axle { point: *point, axis: *axis, lever });
    }
}

/// The mass of each owned node of a body that spins: the integral of its shape function times the density.
fn masses(model: &Model, spin: &Spin) -> BTreeMap<u32, f64> {
    let mut masses: BTreeMap<u32, f64> = BTreeMap::new();
    for solid in &model.part.solids {
        let Some((_, density)) = spin.densities.iter().find(|(section, _)| *section == solid.section as usize) else {
            continue;
        };
        let shares = elements::body_force(model, solid, &(Vec3::x() * *density));
        for (&n, share) in solid.nodes().iter().zip(shares).filter(|(n, _)| (**n as usize) < model.part.owned) {
            *masses.entry(n).or_default() += share.x;
        }
    }
    masses
}

/// A table that many loads have.
fn shared(table: &Option<Amplitude>) -> Option<Arc<Amplitude>> {
    table.clone().map(Arc::new)
}

/// Share of each owned node in a set: by reference area over the faces, evenly over bare nodes and those of faces without an
/// area, on the axis of rings; the sum over ranks is 1. Collective.
pub fn nodal_weights(comm: &SimpleCommunicator, model: &Model, set: &str) -> BTreeMap<u32, f64> {
    let set = model.set(set);
    let total = |weights: &BTreeMap<u32, f64>| {
        let mut total = [weights.values().sum::<f64>()];
        sum(comm, &mut total);
        total[0]
    };
    let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
    let still = vec![Vec3::zeros(); model.part.points.len()];
    elements::add_nodal_areas(model, &set.facets, &still, |n, area| {
        if (n as usize) < model.part.owned {
            *weights.entry(n).or_default() += area;
        }
    });
    let mut whole = total(&weights);
    if whole == 0.0 {
        weights = set.nodes.iter().map(|&n| (n, 1.0)).collect();
        whole = total(&weights);
    }
    weights.values_mut().for_each(|w| *w /= whole);
    weights
}
