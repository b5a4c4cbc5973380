//! Slave nodes of ties that a step moves otherwise than their masters.
//!
//! A slave node whose motion a step prescribes along a direction is not tied along it: in a plane of symmetry, and where both
//! sides are held, nothing is lost by that, since the master beside it moves alike. Where that is free, or goes another way, the
//! tie would not hold, or would be held twice: such a scene is refused. Slave nodes that are pressed by penalties besides are warned of.

use super::super::conditions::Conditions;
use super::worst;
use crate::contact::moves::alike;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::ties::TiedNode;
use crate::scene::Scene;
use mpi::topology::SimpleCommunicator;

/// Weight in the mean of a slave node from which a master node is beside it.
const BESIDE: f64 = 1e-6;

/// Refuses what a tie would have to hold and does not. Collective.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &Model, steps: &[Conditions]) -> Result<()> {
    for (step, conditions) in scene.steps.iter().zip(steps) {
        // Not a number where it is free.
        let by = |n: u32, d: usize| conditions.movement(n).ways[d];
        for (joint, tie) in model.joints.iter().zip(&scene.ties) {
            let moves = joint.masters.fetch(comm, 3, by);
            let mut lost: Vec<(u32, f64)> = Vec::new();
            for slave in &joint.slaves {
                for (d, by) in (0..3).map(|d| (d, by(slave.node, d))).filter(|(_, by)| !by.is_nan()) {
                    let beside =
                        |(k, weight): &(u32, f64)| weight.abs() > BESIDE && alike(moves[3 * *k as usize + d], by);
                    if !slave.weights.iter().any(beside) {
                        lost.push((slave.node, 0.0));
                    }
                }
            }
            if let Some(node) = worst(comm, model, &lost) {
                let what = format!(
                    "step `{}` holds or moves node {node}, a slave of tie `{}`, and not the master beside it alike: the tie would \
                     not hold there",
                    step.name.value, joint.name
                );
                return Err(Error::input(
                    &tie.slave.at,
                    what,
                    "exchange `slave` and `master` of the tie, hold both alike, or tie faces that end before what is held",
                ));
            }
        }
    }
    Ok(())
}

/// Warns of slave nodes of ties that are means of several nodes and that contacts press by penalties: in the mean they are with what
/// presses their masters, and what one is off in it has the other's penalty. Collective.
pub fn pressed(comm: &SimpleCommunicator, model: &mut Model) {
    let mut warnings = Vec::new();
    for joint in &model.joints {
        for pair in model.pairs.iter().filter(|pair| pair.width() == 0 && pair.master.tool().is_some()) {
            let is_mean = |slave: &&TiedNode| slave.weights.iter().filter(|(_, w)| w.abs() > BESIDE).count() > 1;
            let is_slave = |n: &u32| pair.slaves.binary_search_by_key(n, |slave| slave.node).is_ok();
            let both = joint.slaves.iter().filter(is_mean).map(|slave| slave.node).filter(is_slave);
            let both: Vec<(u32, f64)> = both.map(|node| (node, 0.0)).collect();
            if let Some(node) = worst(comm, model, &both) {
                warnings.push(format!(
                    "contact `{}` presses node {node} by a penalty, a slave of tie `{}` that is the mean of several nodes: pressures \
                     there are uneven, while forces are right; take the ends of the tie out of the contact, or mesh them alike",
                    pair.name, joint.name
                ));
            }
        }
    }
    model.warnings.extend(warnings);
}
