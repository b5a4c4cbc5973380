//! Loads, springs and dashpots on sets whose nodes supports hold along all that they act along: they change nothing but the
//! reactions there.

use super::super::conditions::{Conditions, nodal_weights};
use crate::Vec3;
use crate::model::Model;
use crate::parallel::any;
use crate::scene::{Scene, Step};
use mpi::topology::SimpleCommunicator;

/// Warns of what acts on such sets. Collective.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, steps: &[Conditions]) {
    let mut told = Vec::new();
    for (step, conditions) in scene.steps.iter().zip(steps) {
        for (what, set, along) in acting(step).filter(|(_, set, _)| model.tool_named(set).is_none()) {
            let gives_way = |n: u32| !is_held(conditions, n as usize, &along);
            if any(comm, nodal_weights(comm, model, set).into_keys().any(gives_way)) {
                continue;
            }
            told.push(format!(
                "step `{}`: {what} on `{set}` does nothing but to the reactions there: supports hold all of its nodes along it",
                step.name.value
            ));
        }
    }
    model.warnings.extend(told);
}

/// What acts in a step on which set, and how much along x, y and z.
fn acting(step: &Step) -> impl Iterator<Item = (&'static str, &str, Vec3)> {
    let everywhere = Vec3::repeat(1.0);
    (step.forces.iter().map(|f| ("the force", f.target.value.as_str(), f.total)))
        .chain(step.pressures.iter().map(move |p| ("the pressure", p.set.value.as_str(), everywhere * p.value)))
        .chain(step.springs.iter().map(|s| ("the spring", s.set.value.as_str(), s.stiffness)))
        .chain(step.dashpots.iter().map(|d| ("the dashpot", d.set.value.as_str(), d.damping)))
        .filter(|(_, _, along)| *along != Vec3::zeros())
}

/// Whether an owned node keeps its place along the axes along which something acts; one that is held along others must be
/// held along all.
fn is_held(conditions: &Conditions, node: usize, along: &Vec3) -> bool {
    let turned = conditions.axes.of(node).is_some();
    let stays = |d: usize| conditions.prescribed[3 * node + d].is_some_and(|motion| motion.stays());
    (0..3).all(|d| stays(d) || !turned && along[d] == 0.0)
}
