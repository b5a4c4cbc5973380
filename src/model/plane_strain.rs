//! What tools of bodies in plane strain can be: alike all along z, and moving in the plane. Others would meet a layer at one of
//! its two planes, and not the body that it stands for.

use super::Model;
use super::axisymmetric::is_drawn_out;
use super::layers::reduction;
use crate::contact::Pair;
use crate::error::{Error, Faults, Result};
use crate::scene::{Reduction, Scene, Step};
use crate::{Vec2, Vec3};

const TOOLS: &str = "a body in plane strain goes on alike along z, and so must the tools that it meets; else leave out \
                     `plane_strain`, and mesh it in space";

/// Whether a tool meets bodies in plane strain.
fn meets_layers(scene: &Scene, tool: &str) -> bool {
    let is_met = |set: &str| reduction(scene, set) == Some(Reduction::PlaneStrain);
    scene.contacts.iter().any(|contact| contact.master.value == tool && is_met(&contact.slave.value))
}

/// # Errors
/// Tools with a closed form that is not drawn out along z.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let mut faults = Faults::default();
    for tool in scene.tools.iter().filter(|tool| meets_layers(scene, &tool.name.value)) {
        if !tool.smoothing.value.is_cad() && !is_drawn_out(tool) {
            let what = format!("tool `{}` is not drawn out along z, but meets a body in plane strain", tool.name.value);
            faults.note(&Err::<(), _>(Error::input(&tool.smoothing.at, what, TOOLS)));
        }
    }
    faults.finish()
}

/// # Errors
/// Motions of such tools out of the plane, by forces and torques, too.
pub fn check_step(model: &Model, step: &Step) -> Result<()> {
    let meets_layers = |name: &str| {
        let tool = model.tool_named(name);
        tool.is_some() && {
            let meets = |pair: &Pair| pair.master.tool() == tool && model.bodies[pair.side.body].is_layer();
            model.pairs.iter().any(meets)
        }
    };
    if model.is_axisymmetric() {
        return Ok(());
    }
    let turns = |axis: Vec3| axis.xy() != Vec2::zeros();
    let of_motions = step.moves.iter().map(|motion| {
        let out = motion.rotate.as_ref().is_some_and(|rotation| turns(rotation.axis));
        (&motion.target, out, motion.by.z != 0.0)
    });
    let of_forces = step.forces.iter().map(|force| (&force.target, false, force.directions[2]));
    let of_torques = step.torques.iter().map(|torque| (&torque.tool, turns(torque.axis), false));
    let all = of_motions.chain(of_forces).chain(of_torques).filter(|(target, ..)| meets_layers(&target.value));
    Faults::all(all.map(|(target, turns, moves)| {
        let leaves = match (turns, moves) {
            (true, _) => "turns out of the plane",
            (_, true) => "moves along z",
            _ => return Ok(()),
        };
        let what = format!("tool `{}` {leaves}, but meets a body in plane strain", target.value);
        Err(Error::input(&target.at, what, TOOLS))
    }))
    .map(|_: Vec<()>| ())
}
