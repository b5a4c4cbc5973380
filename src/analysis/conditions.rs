//! What a step prescribes: displacements, tool motions and loads, as functions of the fraction s of the step.
//!
//! Displacements are relative to the start of the step. A load ramps linearly from its value at the end of the last step;
//! one that a step does not list falls to zero over it. A tool that a step hands over to a force begins with the force that
//! it has.

use crate::Vec3;
use crate::contact::{Pair, Pose, Tool};
use crate::error::{Error, Location, Result};
use crate::model::{Model, elements};
use crate::parallel::sum;
use crate::scene::{Formulation, Rotation, Step};
use crate::system::dofs::{Prescribed, ToolFreedom};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// Motion of a tool over the step.
#[derive(Clone, Copy, Debug, Default)]
pub struct ToolMotion {
    pub by: Vec3,
    pub rotation: Option<Rotation>,
    pub free: [bool; 3],
}

/// A load at the start and at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ramp<T> {
    pub from: T,
    pub to: T,
}

impl Ramp<f64> {
    pub fn at(&self, s: f64) -> f64 {
        self.from + (self.to - self.from) * s
    }
}

impl Ramp<Vec3> {
    pub fn at(&self, s: f64) -> Vec3 {
        self.from + (self.to - self.from) * s
    }
}

/// The conditions of a step on this rank.
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    /// Three entries an owned node.
    pub prescribed: Vec<Prescribed>,
    pub motions: Vec<ToolMotion>,
    /// Dead load on each owned node, N.
    pub loads: Vec<Ramp<Vec3>>,
    /// Follower pressure by set.
    pub pressures: BTreeMap<String, Ramp<f64>>,
    /// Force on each tool, N.
    pub tool_forces: Vec<Ramp<Vec3>>,
}

impl Conditions {
    /// No conditions: what is before the first step.
    pub fn none(model: &Model) -> Self {
        Self {
            loads: vec![Ramp::default(); model.part.owned],
            tool_forces: vec![Ramp::default(); model.masters.tools.len()],
            ..Self::default()
        }
    }

    /// The conditions of `step`, which begins at displacements `u` with the loads that `last` ended with. Collective.
    ///
    /// # Errors
    /// Two conditions that contradict each other at a node; only on the rank that owns it.
    pub fn new(comm: &SimpleCommunicator, model: &Model, step: &Step, u: &[Vec3], last: &Self) -> Result<Self> {
        let mut conditions = Self {
            prescribed: vec![None; 3 * model.part.owned],
            motions: vec![ToolMotion::default(); model.masters.tools.len()],
            loads: vec![Ramp::default(); model.part.owned],
            pressures: (last.pressures.iter().filter(|(_, p)| p.to != 0.0))
                .map(|(k, p)| (k.clone(), Ramp { from: p.to, to: 0.0 }))
                .collect(),
            tool_forces: vec![Ramp::default(); model.masters.tools.len()],
        };
        for (ramp, before) in conditions.loads.iter_mut().zip(&last.loads) {
            ramp.from = before.to;
        }
        for (ramp, before) in conditions.tool_forces.iter_mut().zip(&last.tool_forces) {
            ramp.from = before.to;
        }
        for pressure in &step.pressures {
            conditions.pressures.entry(pressure.set.value.clone()).or_default().to += pressure.value;
        }
        conditions.add_body_forces(model, step);
        conditions.add_forces(comm, model, step);
        conditions.prescribe(model, step, u)?;
        Ok(conditions)
    }

    /// Lets tools that were not driven by force until now begin with the contact forces that hold them, those of the last
    /// converged increment.
    pub fn hand_over(&mut self, last: &Self, contact_forces: &[Vec3]) {
        for (t, (ramp, force)) in self.tool_forces.iter_mut().zip(contact_forces).enumerate() {
            for d in 0..3 {
                if self.motions[t].free[d] && !last.motions.get(t).is_some_and(|m| m.free[d]) {
                    ramp.from[d] = -force[d];
                }
            }
        }
    }

    /// Puts the tools where they are at fraction `s` of the step, which they began at `poses`, moved on by `offsets` along the
    /// directions in which forces drive them.
    pub fn place_tools(&self, tools: &mut [Tool], poses: &[Pose], offsets: &[Vec3], s: f64) {
        for (t, tool) in tools.iter_mut().enumerate() {
            let motion = &self.motions[t];
            tool.trial = poses[t].moved(&motion.by, motion.rotation.as_ref(), s).driven_by(&offsets[t]);
        }
    }

    /// What the equation numbering needs to know of the tools.
    pub fn freedoms(&self) -> Vec<ToolFreedom> {
        let moves = |m: &ToolMotion, d: usize| {
            let keeps_apart = m.rotation.is_none_or(|r| (1.0 - r.axis.normalize()[d].abs()) < 1e-14);
            keeps_apart.then_some(m.by[d])
        };
        self.motions.iter().map(|m| ToolFreedom { free: m.free, moves: [0, 1, 2].map(|d| moves(m, d)) }).collect()
    }

    /// How far the step moves each tool along each direction: NaN where a force does, infinite where it turns.
    pub fn moves_of_tools(&self) -> Vec<[f64; 3]> {
        let of_tool = |tool: &ToolFreedom| {
            [0, 1, 2].map(|d| if tool.free[d] { f64::NAN } else { tool.moves[d].unwrap_or(f64::INFINITY) })
        };
        self.freedoms().iter().map(of_tool).collect()
    }

    /// How far the step moves an owned node along a direction; NaN where it is free.
    pub fn move_of(&self, node: u32, d: usize) -> f64 {
        self.prescribed[3 * node as usize + d].map_or(f64::NAN, |(_, by)| by)
    }

    /// What is left when the step ends at fraction `s`, before its end.
    pub fn ended_at(mut self, s: f64) -> Self {
        self.loads.iter_mut().for_each(|ramp| ramp.to = ramp.at(s));
        self.tool_forces.iter_mut().for_each(|ramp| ramp.to = ramp.at(s));
        self.pressures.values_mut().for_each(|ramp| ramp.to = ramp.at(s));
        self
    }

    /// Whether the tangent is symmetric: no friction, no follower pressure, no F-bar, and forces on deformable masters that
    /// have a potential.
    pub fn is_symmetric(&self, model: &Model) -> bool {
        let potential = |pair: &Pair| model.masters.of(pair.master).has_potential(pair.tangent);
        let conservative = model.pairs.iter().all(|p| p.friction == 0.0 && potential(p)) && self.pressures.is_empty();
        conservative && model.sections.iter().all(|section| section.element != Formulation::Hex8Fbar)
    }

    fn add_body_forces(&mut self, model: &Model, step: &Step) {
        for force in &step.body_forces {
            for solid in &model.part.solids {
                if model.bodies[solid.body as usize].name != force.body.value {
                    continue;
                }
                let shares = elements::body_force(model, solid, &force.per_volume);
                for (&n, share) in solid.nodes().iter().zip(shares) {
                    if (n as usize) < model.part.owned {
                        self.loads[n as usize].to += share;
                    }
                }
            }
        }
    }

    /// Total forces on sets, spread by reference area, evenly over a set without faces. Collective.
    fn add_forces(&mut self, comm: &SimpleCommunicator, model: &Model, step: &Step) {
        for force in &step.forces {
            if let Some(tool) = model.masters.tools.iter().position(|t| t.name == force.target.value) {
                self.tool_forces[tool].to += force.total;
                for d in (0..3).filter(|&d| force.directions[d]) {
                    self.motions[tool].free[d] = true;
                }
                continue;
            }
            let weights = nodal_weights(comm, model, &force.target.value);
            for (&n, w) in &weights {
                self.loads[n as usize].to += force.total * *w;
            }
        }
    }

    fn prescribe(&mut self, model: &Model, step: &Step, u: &[Vec3]) -> Result<()> {
        for fix in &step.fix {
            self.prescribe_set(model, &fix.set.value, &fix.set.at, u, &fix.directions, &Vec3::zeros())?;
        }
        for motion in &step.moves {
            if let Some(tool) = model.masters.tools.iter().position(|t| t.name == motion.target.value) {
                self.motions[tool].by = motion.by;
                self.motions[tool].rotation = motion.rotate;
            } else {
                let target = &motion.target;
                self.prescribe_set(model, &target.value, &target.at, u, &motion.directions, &motion.by)?;
            }
        }
        for plane in &model.symmetry {
            let across = [0, 1, 2].map(|d| d == plane.axis);
            self.prescribe_set(model, &plane.set.value, &plane.set.at, u, &across, &Vec3::zeros())?;
        }
        for n in 0..model.part.owned {
            if model.bodies[model.part.body[n] as usize].plane_strain {
                self.prescribed[3 * n + 2] = Some((u[n].z, 0.0));
            }
        }
        for n in 0..model.part.owned {
            let one = model.part.tie[n] as usize;
            (0..3).for_each(|d| self.prescribed[3 * n + d] = self.prescribed[3 * one + d]);
        }
        Ok(())
    }

    fn prescribe_set(
        &mut self,
        model: &Model,
        set: &str,
        at: &Location,
        u: &[Vec3],
        directions: &[bool; 3],
        by: &Vec3,
    ) -> Result<()> {
        for &n in &model.set(set).nodes {
            let body = &model.bodies[model.part.body[n as usize] as usize];
            if body.plane_strain && directions[2] && by.z != 0.0 {
                let what = format!("body `{}` is in plane strain, where nothing moves along z", body.name);
                return Err(Error::input(at, what, "take `plane_strain` out, or make the motion along z 0"));
            }
            // Nodes that move as one are prescribed as one.
            let one = model.part.tie[n as usize] as usize;
            for d in (0..3).filter(|&d| directions[d]) {
                let value = (u[one][d], by[d]);
                let slot = &mut self.prescribed[3 * one + d];
                if slot.is_some_and(|other| other.1 != value.1) {
                    let axis = ["x", "y", "z"][d];
                    let node = model.part.id[n as usize];
                    let what = format!(
                        "node {node} of `{set}` is already moved otherwise along {axis} by another condition of this step"
                    );
                    return Err(Error::input(
                        at,
                        what,
                        "restrict one of them with `directions`, or take the node out of one set",
                    ));
                }
                *slot = Some(value);
            }
        }
        Ok(())
    }
}

/// Share of each owned node in a set: by reference area over the faces, evenly over bare nodes; the sum over ranks is 1.
/// Collective.
pub fn nodal_weights(comm: &SimpleCommunicator, model: &Model, set: &str) -> BTreeMap<u32, f64> {
    let set = model.set(set);
    let mut has_faces = [set.facets.len() as f64];
    sum(comm, &mut has_faces);
    let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
    if has_faces[0] > 0.0 {
        let still = vec![Vec3::zeros(); model.part.points.len()];
        elements::add_nodal_areas(model, &set.facets, &still, |n, area| {
            if (n as usize) < model.part.owned {
                *weights.entry(n).or_default() += area;
            }
        });
    } else {
        weights.extend(set.nodes.iter().map(|&n| (n, 1.0)));
    }
    let mut total = [weights.values().sum::<f64>()];
    sum(comm, &mut total);
    weights.values_mut().for_each(|w| *w /= total[0]);
    weights
}
