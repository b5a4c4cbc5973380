//! All that a simulation remembers: what an increment changes when it is accepted, what a jump that fails goes back to, and
//! what a driver may keep to go back to.

use super::conditions::Conditions;
use super::increments::Increments;
use super::ladder::Ladder;
use super::strays::Strays;
use super::touches::Touch;
use crate::Vec3;
use crate::contact::{Avoided, Committed, Enforcement, Interference, Pair, Pose, Sight, Trial};
use crate::model::Model;
use crate::scene::Step;
use crate::solid;
use crate::system::near::Near;

/// The state at the last converged increment, on this rank.
#[derive(Clone, Debug)]
pub struct State {
    /// Time since the beginning, and increments until then.
    pub time: f64,
    pub increments: usize,
    /// Displacements of all local nodes.
    pub u: Vec<Vec3>,
    /// Internal less external forces plus contact forces on the owned nodes, N: zero where free, the reaction where held.
    pub reactions: Vec<Vec3>,
    /// Of these what dashpots bear, N.
    pub damped: Vec<Vec3>,
    /// Contact force on each tool, N; then for each its moment about the origin.
    pub tool_forces: Vec<Vec3>,
    /// Largest force of each body, contact and tool so far, as the balance of forces has them.
    pub(super) seen: Vec<f64>,
    /// What each pair did until now.
    pub(super) touches: Vec<Touch>,
    /// What was seen of nodes that no contact names.
    pub(super) strays: Vec<Strays>,
    /// What the last step ended with.
    pub(super) conditions: Conditions,
    /// The same at the start of each step so far: what a force or torque begins with that takes a tool over.
    pub(super) handed: Vec<Vec<Vec3>>,
}

impl State {
    /// That in the beginning, with forces of so many groups.
    pub(super) fn first(model: &Model, groups: usize) -> Self {
        Self {
            time: 0.0,
            increments: 0,
            u: vec![Vec3::zeros(); model.part.points.len()],
            reactions: vec![Vec3::zeros(); model.part.owned],
            damped: vec![Vec3::zeros(); model.part.owned],
            tool_forces: vec![Vec3::zeros(); 2 * model.masters.tools.len()],
            seen: vec![0.0; groups],
            touches: vec![Touch::default(); model.pairs.len()],
            strays: Vec::new(),
            conditions: Conditions::none(model),
            handed: Vec::new(),
        }
    }
}

/// All that the simulation goes on from: a state, how far its step is, and what the model remembers with it.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    pub state: State,
    pub(super) progress: Option<Progress>,
    /// The slave nodes with equations: what the numbers of the unknowns follow from.
    pub(super) near: Option<Near>,
    pub(super) memory: Memory,
}

/// How far a step is.
#[derive(Clone, Debug)]
pub(super) struct Progress {
    /// Tells it from other steps of the simulation.
    pub serial: usize,
    pub step: Step,
    pub conditions: Conditions,
    /// Time, displacements of all local nodes, and poses of the tools, at its start.
    pub start: f64,
    pub before: Vec<Vec3>,
    pub poses: Vec<Pose>,
    /// Force-driven translations of the tools so far in it, then their rotations by torques, as their unknowns have them.
    pub offsets: Vec<Vec3>,
    pub increments: Increments,
    pub ladder: Ladder,
    /// Unknowns at the last converged ends of increments, at most three, with their fractions of the step.
    pub past: Vec<(f64, Vec<f64>)>,
}

/// What points, nodes and tools remember.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    solids: solid::history::History,
    poses: Vec<Pose>,
    pairs: Vec<OfPair>,
    /// The forces of the slave nodes of each tie.
    ties: Vec<Vec<Vec3>>,
}

/// What a contact pair remembers.
#[derive(Clone, Debug)]
struct OfPair {
    method: Enforcement,
    eased: f64,
    interference: Interference,
    /// Of the last converged increment; the iterate; what was seen.
    slaves: Vec<(Committed, Trial, Trial, Sight)>,
    /// Where slave nodes looked; in self-contact what they were not to meet.
    outward: Vec<Vec3>,
    avoided: Option<[Vec<Avoided>; 2]>,
}

impl Memory {
    /// What a model remembers.
    pub fn of(model: &Model) -> Self {
        let of_pair = |pair: &Pair| OfPair {
            method: pair.rules.method,
            eased: pair.rules.eased,
            interference: pair.rules.interference,
            slaves: pair.slaves.iter().map(|s| (s.committed, s.accepted, s.trial, s.sights.accepted)).collect(),
            outward: pair.outward.clone(),
            avoided: pair.within.as_ref().map(|within| [within.avoided.clone(), within.of_faces.clone()]),
        };
        Self {
            solids: model.history.clone(),
            poses: model.masters.tools.iter().map(|tool| tool.committed).collect(),
            pairs: model.pairs.iter().map(of_pair).collect(),
            ties: model.joints.iter().map(|joint| joint.slaves.iter().map(|slave| slave.force).collect()).collect(),
        }
    }

    /// How the pairs are enforced.
    pub fn methods(&self) -> impl Iterator<Item = Enforcement> {
        self.pairs.iter().map(|pair| pair.method)
    }

    /// Makes a model remember this.
    pub fn give(&self, model: &mut Model) {
        model.history.clone_from(&self.solids);
        for (tool, pose) in model.masters.tools.iter_mut().zip(&self.poses) {
            (tool.committed, tool.trial) = (*pose, *pose);
        }
        for (joint, forces) in model.joints.iter_mut().zip(&self.ties) {
            joint.slaves.iter_mut().zip(forces).for_each(|(slave, force)| slave.force = *force);
        }
        for (pair, memory) in model.pairs.iter_mut().zip(&self.pairs) {
            if (pair.rules.method, pair.rules.eased) != (memory.method, memory.eased) {
                pair.rules.eased = memory.eased;
                pair.enforce(memory.method);
            }
            pair.rules.interference = memory.interference;
            for (slave, (committed, accepted, trial, sight)) in pair.slaves.iter_mut().zip(&memory.slaves) {
                (slave.committed, slave.accepted, slave.trial, slave.sights.accepted) =
                    (*committed, *accepted, *trial, *sight);
            }
            pair.outward.clone_from(&memory.outward);
            if let Some((within, [avoided, of_faces])) = pair.within.as_mut().zip(memory.avoided.as_ref()) {
                within.avoided.clone_from(avoided);
                within.of_faces.clone_from(of_faces);
            }
        }
    }
}
