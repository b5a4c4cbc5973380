//! Equation numbers.
//!
//! Only what a step leaves free gets one, of contacts what is [`near`](super::near); the rest is -1, and neither row nor column
//! exists. A node's displacements are numbered together, along the coordinate axes or, where conditions are inclined, along
//! directions of its own ([`Axes`]); its multipliers follow, with friction along the same directions. The free motions of tools
//! come last on rank 0: the translations of all, then the rotations. Numbers are contiguous by rank.

use super::axes::Axes;
use super::near::Near;
use crate::contact::Movement;
use crate::contact::moves::{still, way};
use crate::failure::Place;
use crate::model::Model;
use crate::model::ties::Joint;
use crate::parallel::{any, number, starts};
use crate::{AXIS_NAMES, Vec3};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{Multipliers, Node, Unknowns};

/// No equation.
pub const NONE: i64 = -1;

/// How a displacement component moves over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// At its start.
    pub from: f64,
    /// By how much it moves, as often as its course says.
    pub by: f64,
    /// The course over time, by its number in the step; 0 is straight.
    pub course: u32,
    /// Besides, where it turns about an axis.
    pub turn: Option<Turn>,
}

/// A component of how a point at r from an axis with the unit vector e turns about it (Rodrigues): by the angle φ it moves by
///
/// ```text
/// R(φ) r - r = (cos φ - 1) a + sin φ b,     a = r - e (e·r),   b = e × r.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// φ over the step, radians, as often as the course says.
    pub angle: f64,
    /// The components of a and b.
    pub outward: f64,
    pub ahead: f64,
}

impl Turn {
    /// How far it is along when a share is done.
    fn at(&self, done: f64) -> f64 {
        let half = 0.5 * self.angle * done;
        self.ahead * (2.0 * half).sin() - 2.0 * half.sin().powi(2) * self.outward
    }
}

impl Motion {
    /// Stays where it is.
    pub fn still(from: f64) -> Self {
        Self { from, by: 0.0, course: 0, turn: None }
    }

    /// Where it is when a share of it is done.
    pub fn place(&self, done: f64) -> f64 {
        self.from + self.by * done + self.turn.map_or(0.0, |turn| turn.at(done))
    }

    /// How long its way is at most, per share of the motion.
    pub fn length(&self) -> f64 {
        self.by.abs() + self.turn.map_or(0.0, |turn| turn.angle.abs() * turn.outward.hypot(turn.ahead))
    }

    /// Whether it stays where it is.
    pub fn stays(&self) -> bool {
        self.by == 0.0 && self.turn.is_none()
    }

    /// As that of a [`Movement`].
    pub fn way(&self) -> f64 {
        if self.turn.is_some() { f64::INFINITY } else { way(self.by, self.course) }
    }
}

/// The motion of a displacement component that is prescribed.
pub type Prescribed = Option<Motion>;

/// The equations of one step on this rank.
#[derive(Clone, Debug)]
pub struct DofMap {
    /// Equations of the displacements of every local node, along its directions.
    pub node: Vec<[i64; 3]>,
    /// The directions of local nodes, and whether some node of any rank has its own.
    pub axes: Axes,
    pub is_inclined: bool,
    /// For each pair and slave node its multiplier equations; without friction only the first, none when they are held.
    pub multiplier: Vec<Vec<[i64; 3]>>,
    /// For each tie and slave node the equations of its force along the axes; none where the step prescribes how it moves.
    pub tie: Vec<Vec<[i64; 3]>>,
    /// The slave nodes that have equations of contact.
    pub near: Near,
    /// For each tool the equations of its free translations; then for each that of its rotation by a torque, in the first place.
    pub tool: Vec<[i64; 3]>,
    /// Global number of this rank's first equation.
    pub first: i64,
    /// Equations of this rank.
    pub count: usize,
    /// Where each rank's equations begin, and the end.
    pub starts: Vec<i64>,
    /// Equations, and multipliers among them, of all ranks.
    pub total: u64,
    pub total_multipliers: u64,
    /// Multipliers that slave nodes which are not near do without, on all ranks.
    pub spared: u64,
}

/// What a step says about the motion of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolFreedom {
    /// Directions in which a force moves it.
    pub free: [bool; 3],
    /// Whether a torque turns it.
    pub turns: bool,
    /// How all its points move.
    pub movement: Movement,
}

impl DofMap {
    /// Numbers what is free. `prescribed` has three entries an owned node, along its directions in `axes`. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        model: &Model,
        (prescribed, axes): (&[Prescribed], &Axes),
        tools: &[ToolFreedom],
        near: Near,
    ) -> Self {
        let part = &model.part;
        let mut by_node: Vec<Vec<(usize, usize)>> = vec![Vec::new(); part.owned];
        for (p, pair) in model.pairs.iter().enumerate() {
            for (s, slave) in pair.slaves.iter().enumerate() {
                by_node[slave.node as usize].push((p, s));
            }
        }
        let mut tied: Vec<Vec<(usize, usize)>> = vec![Vec::new(); part.owned];
        for (t, joint) in model.joints.iter().enumerate() {
            for (s, slave) in joint.slaves.iter().enumerate() {
                tied[slave.node as usize].push((t, s));
            }
        }
        let mut map = Self {
            node: vec![[NONE; 3]; part.points.len()],
            axes: Axes::default(),
            is_inclined: any(comm, !axes.is_empty()),
            multiplier: model.pairs.iter().map(|p| vec![[NONE; 3]; p.slaves.len()]).collect(),
            tie: model.joints.iter().map(|joint| vec![[NONE; 3]; joint.slaves.len()]).collect(),
            near,
            tool: vec![[NONE; 3]; 2 * tools.len()],
            first: 0,
            count: 0,
            starts: Vec::new(),
            total: 0,
            total_multipliers: 0,
            spared: 0,
        };
        let (mut multipliers, mut spared) = (0, 0);
        let mut next = 0i64;
        let mut number = || {
            next += 1;
            next - 1
        };
        for (node, slaves) in by_node.iter().enumerate() {
            if part.tie[node] as usize != node {
                continue;
            }
            let prescribed = [0, 1, 2].map(|d| prescribed[3 * node + d]);
            for d in (0..3).filter(|&d| prescribed[d].is_none()) {
                map.node[node][d] = number();
            }
            for &(p, s) in slaves {
                let pair = &model.pairs[p];
                let carried = match pair.master.tool() {
                    Some(t) => carried((&prescribed, axes, node), &tools[t].movement, pair.rules.friction > 0.0),
                    None => [true, true, !pair.planar],
                };
                let wanted = [pair.width() > 0, pair.width() > 1, pair.width() > 1];
                for d in (0..3).filter(|&d| carried[d] && wanted[d]) {
                    if map.near[p][s] {
                        map.multiplier[p][s][d] = number();
                        multipliers += 1;
                    } else {
                        spared += 1;
                    }
                }
            }
            for &(t, s) in &tied[node] {
                for d in (0..3).filter(|&d| prescribed[d].is_none()) {
                    map.tie[t][s][d] = number();
                    multipliers += 1;
                }
            }
        }
        if comm.rank() == 0 {
            for (equations, tool) in map.tool.iter_mut().zip(tools) {
                for d in (0..3).filter(|&d| tool.free[d]) {
                    equations[d] = number();
                }
            }
            for (equations, _) in map.tool[tools.len()..].iter_mut().zip(tools).filter(|(_, tool)| tool.turns) {
                equations[0] = number();
            }
        }
        if map.is_inclined {
            map.axes = axes.with_halo(comm, part);
        }
        map.spared = self::number(comm, spared).1;
        map.finish(comm, model, next as usize, multipliers);
        map
    }

    /// Makes the numbers global and fetches those of halo nodes and tools. Collective.
    fn finish(&mut self, comm: &SimpleCommunicator, model: &Model, count: usize, multipliers: usize) {
        let part = &model.part;
        self.count = count;
        self.starts = starts(comm, count as u64).iter().map(|&n| n as i64).collect();
        (self.first, self.total) = (self.starts[comm.rank() as usize], self.starts[comm.size() as usize] as u64);
        self.total_multipliers = number(comm, multipliers as u64).1;
        let first = self.first;
        let globalise = |equation: &mut i64| {
            if *equation != NONE {
                *equation += first;
            }
        };
        self.node.iter_mut().flatten().for_each(globalise);
        self.multiplier.iter_mut().chain(&mut self.tie).flatten().flatten().for_each(globalise);
        for node in 0..part.owned {
            self.node[node] = self.node[part.tie[node] as usize];
        }
        let mut flat: Vec<i64> = self.node.iter().flatten().copied().collect();
        part.halo.update(comm, 3, &mut flat);
        self.node = flat.as_chunks::<3>().0.to_vec();
        let mut tools: Vec<i64> = self.tool.iter().flatten().copied().collect();
        comm.process_at_rank(0).broadcast_into(&mut tools[..]);
        self.tool = tools.as_chunks::<3>().0.to_vec();
    }

    /// The equations that a component of a vector at a node counts in, and its share in each.
    pub fn shares(&self, node: u32, component: usize) -> impl Iterator<Item = (i64, f64)> {
        let (equations, axes) = (self.node[node as usize], self.axes.of(node as usize));
        let share = move |d: usize| axes.map_or(f64::from(u8::from(d == component)), |axes| axes[(component, d)]);
        let all = (0..3).map(move |d| (equations[d], share(d)));
        all.filter(|(equation, share)| *equation != NONE && *share != 0.0)
    }

    /// Index of an equation among this rank's, if it is one.
    pub fn local(&self, equation: i64) -> Option<usize> {
        let k = equation - self.first;
        (equation != NONE && (0..self.count as i64).contains(&k)).then_some(k as usize)
    }

    /// The `values` of the local unknowns that another numbering of the same step has, as this one has them: zero where it has
    /// none.
    pub fn carry(&self, from: &Self, values: &[f64]) -> Vec<f64> {
        let mut carried = vec![0.0; self.count];
        for (to, from_equation) in self.equations().zip(from.equations()) {
            if let (Some(k), Some(l)) = (self.local(to), from.local(from_equation)) {
                carried[k] = values[l];
            }
        }
        carried
    }

    /// All equations that this rank sees, in an order that does not depend on their numbers.
    fn equations(&self) -> impl Iterator<Item = i64> {
        let multipliers = self.multiplier.iter().chain(&self.tie).flatten();
        self.node.iter().chain(multipliers).chain(&self.tool).flatten().copied()
    }

    /// Of each local equation whether its unknown is a force, not a displacement.
    pub fn forces(&self) -> Vec<bool> {
        let mut forces = vec![false; self.count];
        for equation in self.multiplier.iter().chain(&self.tie).flatten().flatten() {
            if let Some(k) = self.local(*equation) {
                forces[k] = true;
            }
        }
        forces
    }

    /// What the equations of this rank belong to, for an iterative solver; nodes stand where `place` says.
    pub fn unknowns(&self, model: &Model, place: impl Fn(u32) -> Vec3) -> Unknowns {
        let row = |equation: i64| self.local(equation).map(|k| k as u32);
        let mut unknowns = Unknowns::default();
        let mut add = |equations: &[i64; 3], directions: [Vec3; 3], position: Vec3| {
            let rows = equations.map(row);
            if rows.iter().any(Option::is_some) {
                let directions = directions.map(|direction| direction.into());
                unknowns.nodes.push(Node { rows, directions, position: position.into() });
            }
        };
        let part = &model.part;
        for n in (0..part.owned).filter(|n| part.tie[*n] as usize == *n) {
            add(&self.node[n], [0, 1, 2].map(|d| self.axes.direction(n, d)), place(n as u32));
        }
        let (moved, turned) = self.tool.split_at(self.tool.len() / 2);
        for (equations, tool) in moved.iter().zip(&model.masters.tools) {
            add(equations, [0, 1, 2].map(|d| Vec3::ith(d, 1.0)), tool.trial.translation);
        }
        // About a fixed axis a tool does not take part in the rigid motions of all.
        for (equations, tool) in turned.iter().zip(&model.masters.tools) {
            add(equations, [Vec3::zeros(); 3], tool.trial.translation);
        }
        for (pair, equations) in model.pairs.iter().zip(&self.multiplier) {
            for (slave, equations) in pair.slaves.iter().zip(equations) {
                let mut rows = equations.iter().filter_map(|e| row(*e));
                if let Some(first) = rows.next() {
                    let stiffness = slave.penalties.automatic / pair.controls.augmentation;
                    unknowns.multipliers.push(Multipliers { first, count: 1 + rows.count() as u32, stiffness });
                }
            }
        }
        for (joint, equations) in model.joints.iter().zip(&self.tie) {
            for (slave, equations) in joint.slaves.iter().zip(equations) {
                let mut rows = equations.iter().filter_map(|e| row(*e));
                if let Some(first) = rows.next() {
                    let count = 1 + rows.count() as u32;
                    unknowns.multipliers.push(Multipliers { first, count, stiffness: slave.stiffness });
                }
            }
        }
        unknowns
    }

    /// The node of a local equation, with the direction of a displacement and none for a multiplier; none for those of tools.
    fn node_of(&self, model: &Model, equation: usize) -> Option<(u32, Option<usize>)> {
        let wanted = self.first + equation as i64;
        let of_node = |equations: &[i64; 3]| equations.iter().position(|&e| e == wanted);
        let mut displacements = self.node.iter().take(model.part.owned).enumerate();
        let displacement = displacements.find_map(|(n, equations)| Some((n as u32, Some(of_node(equations)?))));
        let found = displacement.or_else(|| {
            let pairs = model.pairs.iter().zip(&self.multiplier);
            let mut slaves = pairs.flat_map(|(pair, of_pair)| pair.slaves.iter().zip(of_pair));
            slaves.find(|(_, equations)| equations.contains(&wanted)).map(|(slave, _)| (slave.node, None))
        });
        let joints = model.joints.iter().zip(&self.tie);
        let mut tied = joints.flat_map(|(joint, of_joint)| joint.slaves.iter().zip(of_joint));
        let of_tie = || tied.find(|(_, equations)| equations.contains(&wanted)).map(|(slave, _)| (slave.node, None));
        found.or_else(of_tie)
    }

    /// The equations of the nodes of a tie's master. Collective.
    pub fn of_masters(&self, comm: &SimpleCommunicator, joint: &Joint) -> Vec<[i64; 3]> {
        joint.masters.fetch(comm, 3, |n, d| self.node[n as usize][d]).as_chunks::<3>().0.to_vec()
    }

    /// The node of a local equation; none for those of tools.
    pub fn place(&self, model: &Model, equation: usize) -> Option<Place> {
        self.node_of(model, equation).map(|(node, _)| place_of(model, node))
    }

    /// The free motion of a tool that a local equation is of, in words.
    fn tool_motion(&self, model: &Model, equation: usize) -> Option<String> {
        let wanted = self.first + equation as i64;
        let find = |(t, equations): (usize, &[i64; 3])| Some((t, equations.iter().position(|&e| e == wanted)?));
        let (t, d) = self.tool.iter().enumerate().find_map(find)?;
        let tools = &model.masters.tools;
        Some(match tools.get(t) {
            Some(tool) => format!("the motion along {} of the force-driven tool `{}`", AXIS_NAMES[d], tool.name),
            None => format!("the rotation of the tool `{}` by its torque", tools[t - tools.len()].name),
        })
    }

    /// The node and component, or else the slave or tool, of a local equation, for messages.
    pub fn describe(&self, model: &Model, equation: usize) -> String {
        let Some((node, direction)) = self.node_of(model, equation) else {
            return self.tool_motion(model, equation).unwrap_or("the motion of a force-driven tool".into());
        };
        let along = |d: usize| match self.axes.of(node as usize) {
            Some(axes) => format!("({:.3}, {:.3}, {:.3}) of", axes[(0, d)], axes[(1, d)], axes[(2, d)]),
            None => format!("{} of", AXIS_NAMES[d]),
        };
        let what = direction.map_or("the force of a contact or tie at".into(), along);
        format!("{what} node {}{}", node_name(model, node), contact_status(model, node))
    }
}

/// What a slave node does in its contacts, in words; empty for other nodes.
fn contact_status(model: &Model, node: u32) -> String {
    let mut text = String::new();
    for pair in &model.pairs {
        for slave in pair.slaves.iter().filter(|s| s.node == node) {
            text += &format!(", {} in contact `{}`", slave.trial.status.name(pair.rules.friction), pair.name);
        }
    }
    text
}

/// A node as the user knows it.
pub fn place_of(model: &Model, node: u32) -> Place {
    let at = node as usize;
    let body = model.bodies[model.part.body[at] as usize].name.clone();
    Place { body, node: model.part.id[at], at: model.part.points[at].into() }
}

/// The same in words.
pub fn node_name(model: &Model, node: u32) -> String {
    place_of(model, node).to_string()
}

/// Components of a contact force that a slave node can have, along its directions: none when neither it nor the tool can give
/// way in any; with friction not those along which it stands still relative to the tool.
fn carried((prescribed, axes, node): (&[Prescribed; 3], &Axes, usize), tool: &Movement, frictional: bool) -> [bool; 3] {
    let of_tool = [0, 1, 2].map(|d| tool.along(&axes.direction(node, d)));
    let locked = [0, 1, 2].map(|d| prescribed[d].is_some() && !of_tool[d].is_nan());
    let still = still([0, 1, 2].map(|d| prescribed[d].map_or(f64::NAN, |motion| motion.way())), of_tool);
    let held = |d: usize| locked[d] && still[d];
    match (locked, frictional) {
        ([true, true, true], _) => [false; 3],
        (_, false) => [true; 3],
        _ => [0, 1, 2].map(|d| !held(d)),
    }
}
