//! What tools of bodies in plane strain can be: alike all along z, and moving in the plane. Others would meet a layer at one of
//! its two planes, and not the body that it stands for.

use super::Model;
use super::axisymmetric::is_drawn_out;
use crate::Vec2;
use crate::contact::Pair;
use crate::error::{Error, Faults, Result};
use crate::partition::GlobalMesh;
use crate::scene::{Body, Reduction, Scene, Step, body_of};

const TOOLS: &str = "a body in plane strain goes on alike along z, and so must the tools that it meets; else leave out \
                     `plane_strain`, and mesh it in space";

/// How much of its thickness a body may differ from another's.
const ALIKE: f64 = 1e-6;

fn is_layer(body: &Body) -> bool {
    body.reduction.as_ref().is_some_and(|reduction| reduction.value == Reduction::PlaneStrain)
}

/// Whether a tool meets bodies in plane strain.
fn meets_layers(scene: &Scene, tool: &str) -> bool {
    let is_met = |name: &str| scene.bodies.iter().any(|body| body.name.value == name && is_layer(body));
    scene.contacts.iter().any(|contact| contact.master.value == tool && is_met(body_of(&contact.slave.value)))
}

/// # Errors
/// Tools with a closed form that is not drawn out along z, and bodies in contact that are not equally thick.
pub(super) fn check(scene: &Scene, global: &GlobalMesh) -> Result<()> {
    let mut faults = Faults::default();
    for tool in scene.tools.iter().filter(|tool| meets_layers(scene, &tool.name.value)) {
        if !tool.smoothing.value.is_cad() && !is_drawn_out(tool) {
            let what = format!("tool `{}` is not drawn out along z, but meets a body in plane strain", tool.name.value);
            faults.note(&Err::<(), _>(Error::input(&tool.smoothing.at, what, TOOLS)));
        }
    }
    let of_body = |(b, body): (usize, &Body)| {
        let [low, high] = is_layer(body).then(|| global.z_range(b))?;
        Some(high - low)
    };
    let thick: Vec<Option<f64>> = scene.bodies.iter().enumerate().map(of_body).collect();
    let thickness = |set: &str| thick[scene.bodies.iter().position(|body| body.name.value == body_of(set))?];
    for contact in &scene.contacts {
        let [slave, master] = [&contact.slave, &contact.master].map(|side| thickness(&side.value));
        if let (Some(slave), Some(master)) = (slave, master)
            && (slave - master).abs() > ALIKE * slave
        {
            let what = format!(
                "contact `{}`: bodies in plane strain that are {slave:?} and {master:?} thick",
                contact.name.value
            );
            faults.note(&Err::<(), _>(Error::input(&contact.name.at, what, "mesh both as thick along z")));
        }
    }
    faults.finish()
}

/// # Errors
/// Motions of such tools out of the plane.
pub fn check_step(model: &Model, step: &Step) -> Result<()> {
    let meets_layers = |name: &str| {
        let tool = model.tool_named(name);
        tool.is_some() && {
            let meets = |pair: &Pair| pair.master.tool() == tool && model.bodies[pair.body].is_layer();
            model.pairs.iter().any(meets)
        }
    };
    if model.is_axisymmetric() {
        return Ok(());
    }
    Faults::all(step.moves.iter().filter(|motion| meets_layers(&motion.target.value)).map(|motion| {
        let leaves = match &motion.rotate {
            Some(rotation) if rotation.axis.xy() != Vec2::zeros() => "turns out of the plane",
            _ if motion.by.z != 0.0 => "moves along z",
            _ => return Ok(()),
        };
        let what = format!("tool `{}` {leaves}, but meets a body in plane strain", motion.target.value);
        Err(Error::input(&motion.target.at, what, TOOLS))
    }))
    .map(|_: Vec<()>| ())
}
