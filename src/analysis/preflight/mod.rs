//! What is checked before the first increment: models whose results could not be right are refused, suspicious ones are
//! warned about.
//!
//! - `sight`: what every slave node sees of its master, however far away
//! - `gaps`: the gap or overlap of every contact, and nodes too deep inside to be seen
//! - `fits`: overlaps that are hardly more than what faces lack of arcs
//! - `facing`: masters whose normals look away from the slave
//! - `stuck`: slave nodes that nothing lets give way to a tool that comes
//! - [`rigid`]: the rigid motions of bodies and tools that a set of supports and contacts leaves free
//! - `repeated`: contacts that are another one by other names or the other way round, also in part, and contacts side by side
//! - `tied`: slave nodes of ties that a step moves otherwise than their masters, or that are pressed by penalties
//! - `support`: what holds every body, or part of one that shares no nodes with the rest, and every force-driven tool, in each
//!   step
//! - `pressed`: bodies that nothing presses against what touches them
//! - `astride`: slave nodes exactly under sharp edges where they are on one side of these
//! - `anew`: sets that a step which keeps conditions frees by listing them, or holds in frames that they have turned away from
//! - `idle`: loads, springs and dashpots on nodes that are held
//! - `locking`: elements that are too stiff for their material, or have no stable solution
//! - `mirrored`: conditions that would be others beyond a plane of symmetry
//! - `units`: sizes that hint at mixed units, and coordinates too far from the origin
//!
//! Tools and bodies that no contact names are warned of, and bodies that meet with nothing between them. Places of
//! probes outside all bodies are refused, too. What is wrong with the meshes alone is found where they are read:
//! [`crate::model`].

mod anew;
mod astride;
mod facing;
mod fits;
mod gaps;
mod idle;
mod locking;
mod mirrored;
mod pressed;
mod repeated;
pub mod rigid;
mod sight;
mod stuck;
pub(super) mod support;
mod tied;
mod units;

pub use gaps::DEEP;

use super::conditions::Conditions;
use super::strangers::Strangers;
use super::{probes, suspects};
use crate::Vec3;
use crate::error::Result;
use crate::model::Model;
use crate::parallel::{agree, first_word, max};
use crate::scene::{Scene, Step, body_of};
use crate::system::dofs::node_name;
use mpi::topology::SimpleCommunicator;

/// What the first look at a model leaves.
pub struct Beginning {
    /// A line about the gap of every contact and tie.
    pub gaps: Vec<String>,
    /// Without those that meet from the beginning, of which a warning tells.
    pub(super) strangers: Strangers,
    /// For each pair the slave nodes that are on none of the master, though behind some face of it.
    pub(super) aside: Vec<Vec<bool>>,
}

/// Checks a model before it is run; warnings are added to the model. Collective; what is found does not depend on the number of
/// ranks.
///
/// # Errors
/// What cannot be right, with its place in the scene, on all ranks.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<Beginning> {
    let steps = conditions(comm, scene, model)?;
    units::offset(comm, scene, model)?;
    units::stresses(scene, model);
    units::floor(scene, model)?;
    probes::check(comm, scene, model)?;
    locking::check(comm, scene, model)?;
    repeated::check(comm, scene, model)?;
    turns(scene, model);
    let freed = anew::freed(comm, scene, model, &steps);
    anew::turned(scene, model);
    bystanders(scene, model);
    let still = vec![Vec3::zeros(); model.part.points.len()];
    let mut strangers = Strangers::new(comm, model);
    let met = strangers.meet(comm, model, &still);
    model.warnings.extend(met);
    let sights = sight::look(comm, model);
    let contacts = scene.passes();
    facing::check(comm, &contacts, model, &sights)?;
    let mut gaps = gaps::check(comm, &contacts, model, &sights)?;
    gaps.extend(model.joined.clone());
    fits::check(comm, model, &sights);
    repeated::seams(comm, model, &sights);
    units::sizes(comm, scene, model, &sights);
    mirrored::check(comm, scene, model, (&steps, &sights));
    stuck::check(comm, scene, model, &steps)?;
    stuck::rigid(comm, scene, model, &steps);
    stuck::clamped(comm, scene, model, &steps);
    let hollow = suspects::begun_hollow(comm, model);
    model.warnings.extend(hollow);
    tied::check(comm, scene, model, &steps)?;
    tied::pressed(comm, model);
    support::check(comm, scene, model, (&steps, &sights), &freed)?;
    pressed::check(comm, scene, model, (&steps, &sights))?;
    idle::check(comm, scene, model, &steps);
    astride::check(comm, model, (&steps, &sights));
    let aside = sights.iter().map(|sights| sights.iter().map(|sight| sight.is_aside).collect()).collect();
    Ok(Beginning { gaps, strangers, aside })
}

/// Warns of steps in which tools or sets turn too far for the increments that are asked for.
fn turns(scene: &Scene, model: &mut Model) {
    for step in scene.steps.iter().filter(|step| step.sizes().max < step.increment.max) {
        model.warnings.push(format!(
            "step `{}`: a tool or set turns by more than {} degrees an increment; the increments are at most {:.3e} long",
            step.name.value,
            Step::TURN,
            step.sizes().max
        ));
    }
}

/// Warns of tools that no contact names, and where some bodies meet others or tools, of bodies that neither contact nor tie names.
fn bystanders(scene: &Scene, model: &mut Model) {
    let named = |name: &str| {
        let contacts = scene.contacts.iter().flat_map(|contact| [&contact.slave, &contact.master]);
        let mut sides = contacts.chain(scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]));
        sides.any(|side| body_of(&side.value) == name)
    };
    for tool in scene.tools.iter().filter(|tool| !named(&tool.name.value)) {
        model.warnings.push(format!("no contact names the tool `{}`: bodies pass through it", tool.name.value));
    }
    for body in scene.bodies.iter().filter(|body| !scene.contacts.is_empty() && !named(&body.name.value)) {
        model.warnings.push(format!(
            "neither contact nor tie names body `{}`: tools and other bodies pass through it",
            body.name.value
        ));
    }
}

/// The conditions of every step, as far as they are known beforehand. Collective.
///
/// # Errors
/// Conditions that contradict each other.
fn conditions(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Result<Vec<Conditions>> {
    let still = vec![Vec3::zeros(); model.part.points.len()];
    let mut steps: Vec<Conditions> = Vec::new();
    let none = Conditions::none(model);
    for step in &scene.steps {
        let next = agree(comm, Conditions::new(comm, model, step, &still, steps.last().unwrap_or(&none)))?;
        steps.push(next);
    }
    Ok(steps)
}

/// Among nodes of all ranks with a value each, the one with the largest, of several the one with the lowest number, in
/// words; `None` when there are none. Collective.
fn worst(comm: &SimpleCommunicator, model: &Model, nodes: &[(u32, f64)]) -> Option<String> {
    /// Values that differ by less are equal.
    const EQUAL: f64 = 1e-9;
    let mut largest = [nodes.iter().map(|(_, value)| *value).fold(f64::NEG_INFINITY, f64::max)];
    max(comm, &mut largest);
    let close = |value: f64| value >= largest[0] - EQUAL * largest[0].abs();
    let order = |n: u32| (f64::from(model.part.body[n as usize]), model.part.id[n as usize] as f64);
    let best = nodes.iter().filter(|(_, value)| close(*value)).map(|(n, _)| *n);
    let best = best.min_by(|a, b| order(*a).partial_cmp(&order(*b)).unwrap_or(std::cmp::Ordering::Equal));
    let mut lowest = [best.map_or(f64::NEG_INFINITY, |n| -order(n).0)];
    max(comm, &mut lowest);
    let best = best.filter(|n| -order(*n).0 == lowest[0]);
    let mut lowest = [best.map_or(f64::NEG_INFINITY, |n| -order(n).1)];
    max(comm, &mut lowest);
    let best = best.filter(|n| -order(*n).1 == lowest[0]);
    first_word(comm, best.map(|n| node_name(model, n)))
}
