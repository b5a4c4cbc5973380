//! What holds every body, or every part of one that shares no nodes with the rest, and every force-driven tool, in each step:
//! supports, and contacts.
//!
//! A motion that neither the supports of a step nor any of its contacts could hold, even if all slave nodes touched, has no
//! equilibrium that is the only one: it is refused, with or without a load along it. There is no exception for motions
//! that seem harmless, such as a frictionless ring that turns in its bore: where it ends would be a matter of rounding.
//!
//! The first step begins with nothing but supports and what touches: nodes within 1e-4 of a facet, and those that
//! a tool or body reaches by its prescribed motion in the first increment. What is free to translate then is refused, too;
//! what is free to turn is warned about, since a curved body that touches at a point may settle. Contacts hold both ways
//! here: whether a body is pressed on or pulled off is not asked.
//!
//! Later any slave node may touch any part of its master, wherever that is at the start: along the normal that it sees now, or
//! its own where it sees none.
//!
//! With friction a contact that touches sticks. A force-driven tool counts as held then: the solver takes it over a gap to
//! where it meets something.

use super::super::conditions::{Conditions, Ramp};
use super::rigid::{Free, RigidMotions, Side, Touch};
use super::sight::Standing;
use crate::Vec3;
use crate::contact::Tool;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::scene::{Fix, Scene, Step, body_of};
use mpi::topology::SimpleCommunicator;

/// Refuses what nothing holds. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &mut Model,
    (steps, sights): (&[Conditions], &[Vec<Standing>]),
    freed: &[(&Step, &str)],
) -> Result<()> {
    let component = &model.part.component;
    let masters = master_components(comm, scene, model);
    let mut warnings = Vec::new();
    for (k, (step, conditions)) in scene.steps.iter().zip(steps).enumerate() {
        let still = |n: usize| model.part.points[n];
        let mut held = supported(comm, model, conditions, true, still);
        for (p, pair) in model.pairs.iter().enumerate() {
            let place = |s: usize| model.part.points[pair.slaves[s].node as usize];
            let state = |s: usize| {
                let (sight, sticks) = (&sights[p][s], pair.rules.friction > 0.0);
                Some(Touch { at: place(s), normal: sight.normal()?, sticks, side: Side::of(pair, sight.component)? })
            };
            held.touch_pair(pair, component, state);
            // Parts of the master that are not what a node sees now. What sees nothing of its own body may meet it any way.
            let coming = sights[p].iter().enumerate().filter_map(|(s, sight)| {
                let blind = pair.is_within_body() && sight.contact.is_none();
                let settled = pair.is_by_nodes() || sight.component.is_some_and(|seen| masters[p] == [seen]);
                let own = component[pair.slaves[s].node as usize] as usize;
                let normal = sight.normal().unwrap_or(sight.outward);
                (blind || !settled).then(|| (own, place(s), normal, blind || pair.rules.friction > 0.0))
            });
            held.expect(masters[p].clone(), coming.filter(|_| !masters[p].is_empty()));
        }
        let free = held.free(comm);
        if !free.is_empty() {
            return Err(loose(scene, model, (step, k), &free, freed));
        }
        if k > 0 {
            continue;
        }
        let first = step.sizes().initial / step.duration;
        let drifts = drifts(comm, model, conditions, first);
        let mut touched = supported(comm, model, conditions, false, still);
        for (p, pair) in model.pairs.iter().enumerate() {
            let state = |s: usize| {
                let n = pair.slaves[s].node as usize;
                let (x, sight) = (model.part.points[n], &sights[p][s]);
                let (at, side) = (sight.contact?, Side::of(pair, sight.component)?);
                let master = match side {
                    Side::Component(other) => drifts[other],
                    Side::Tool(t) => {
                        conditions.pose(t, &model.masters.tools[t].committed, first).outward(&at.point) - at.point
                    }
                };
                let comes = at.normal.dot(&(drifts[component[n] as usize] - master)).min(0.0);
                (at.gap + comes <= pair.controls.touching_gap * pair.facet_size).then_some(Touch {
                    at: x,
                    normal: at.normal,
                    sticks: pair.rules.friction > 0.0,
                    side,
                })
            };
            touched.touch_pair(pair, component, state);
        }
        let free = touched.free(comm);
        if free.iter().any(|free| !free.along.is_empty()) {
            return Err(apart(comm, model, (step, conditions), sights, &free));
        }
        warnings.extend(free.iter().map(|free| {
            format!(
                "step `{}` begins with {} free to {}: what touches does not hold it; `fix` it if the run fails",
                step.name.value,
                free.who,
                free.motion()
            )
        }));
    }
    model.warnings.extend(warnings);
    Ok(())
}

/// For each pair the components of the master surface, the same on all ranks; none of tools. Collective.
fn master_components(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Vec<Vec<usize>> {
    let count = model.part.components.len();
    let contacts = scene.passes();
    let mut is_master = vec![0.0f64; count * contacts.len()];
    for (p, contact) in contacts.iter().enumerate().filter(|(p, _)| model.pairs[*p].master_side.is_some()) {
        for facet in &model.set(&contact.master.value).facets {
            is_master[count * p + model.part.component[facet.nodes[0] as usize] as usize] = 1.0;
        }
    }
    max(comm, &mut is_master);
    let of_pair = |p: usize| (0..count).filter(|k| is_master[count * p + k] > 0.0).collect();
    (0..contacts.len()).map(of_pair).collect()
}

/// The supports and ties of a step, with tools as its forces and torques `drive` them, or still, and nodes where `place` has
/// them. Collective.
pub fn supported(
    comm: &SimpleCommunicator,
    model: &Model,
    conditions: &Conditions,
    drive: bool,
    place: impl Fn(usize) -> Vec3,
) -> RigidMotions {
    let of_tool = |(t, tool): (usize, &Tool)| match drive {
        true => conditions.driven(t, &tool.committed),
        false => ([false; 3], None),
    };
    let driven = model.masters.tools.iter().enumerate().map(of_tool).collect();
    let component = |n: usize| model.part.component[n] as usize;
    let mut motions = RigidMotions::new(model, driven);
    for n in 0..model.part.owned {
        for along in (0..3).filter_map(|d| conditions.held_along(n, d)) {
            motions.hold(component(n), &place(n), &along);
        }
    }
    // Where rings get wider they resist: only along the axis they move freely.
    if model.is_axisymmetric() {
        (0..model.part.owned).for_each(|n| motions.hold(component(n), &place(n), &Vec3::x()));
    }
    for (&n, footing) in &conditions.springs {
        for d in (0..3).filter(|&d| footing.resists()[d]) {
            motions.hold(component(n as usize), &place(n as usize), &Vec3::ith(d, 1.0));
        }
    }
    // What is tied moves as one, but for slave nodes that are held themselves.
    for (n, [slave, master]) in model.tied_components(comm) {
        let n = n as usize;
        for d in (0..3).filter(|d| conditions.prescribed[3 * n + d].is_none()) {
            motions.touch(slave, Side::Component(master), &place(n), &Vec3::ith(d, 1.0), false);
        }
    }
    motions
}

/// How far the supports of a step have moved each component of a body at fraction `s`: along each direction the farthest
/// that they move a node. Collective.
fn drifts(comm: &SimpleCommunicator, model: &Model, conditions: &Conditions, s: f64) -> Vec<Vec3> {
    let mut ends = vec![0.0f64; 6 * model.part.components.len()];
    for n in 0..model.part.owned {
        let own = &mut ends[6 * model.part.component[n] as usize..];
        let along = conditions.moved(n, s).map(|by| if by.is_nan() { 0.0 } else { by });
        let by = conditions.axes.outward(n, &along);
        for d in 0..3 {
            (own[d], own[3 + d]) = (own[d].max(by[d]), own[3 + d].max(-by[d]));
        }
    }
    max(comm, &mut ends);
    let farther = |up: f64, down: f64| if up >= down { up } else { -down };
    ends.chunks_exact(6).map(|e| Vec3::new(farther(e[0], e[3]), farther(e[1], e[4]), farther(e[2], e[5]))).collect()
}

/// What else a part of a body may want.
const MERGE: &str = "merge the nodes where it should be one with the rest (Gmsh: Coherence Mesh, with a tolerance), or `tie` them; \
                     else ";

/// What is free even if all contacts touch.
fn loose(scene: &Scene, model: &Model, (step, k): (&Step, usize), free: &[Free], freed: &[(&Step, &str)]) -> Error {
    let what = format!("step `{}`: {}: no support and no contact could hold that", step.name.value, told(free));
    let lists = |fix: &Fix| step.fix.iter().any(|own| own.set.value == fix.set.value);
    let dropped = k > 0 && !scene.steps[k - 1].fix.iter().all(lists);
    let of_these = |(of, set): &&(&Step, &str)| {
        let is_of = |f: &Free| !f.is_tool && model.bodies[f.index].name == body_of(set);
        std::ptr::eq(*of, step) && free.iter().any(is_of)
    };
    let forgotten = match freed.iter().find(of_these) {
        Some((_, set)) => {
            format!("; the step lists `{set}` anew, and that takes the place of all that held it: list that, too")
        }
        None if dropped => {
            "; a step holds only what it lists: add `keep = true`, or repeat the `fix` of the step before".into()
        }
        None => String::new(),
    };
    if free.iter().all(|f| f.is_tool && f.along.is_empty()) {
        let help =
            "a torque needs friction, or a tool that is not round about its axis; `move` it with `rotate` otherwise";
        return Error::input(&step.name.at, what, help);
    }
    if free.iter().all(|f| f.is_tool) {
        return Error::input(
            &step.name.at,
            what,
            "let its force act only where it can meet a body, and `move` it otherwise",
        );
    }
    let smooth = model.pairs.iter().any(|p| p.rules.friction == 0.0);
    let friction = if smooth { ", or give its contact friction" } else { "" };
    let merge = if free.iter().any(|f| f.is_piece) { MERGE } else { "" };
    let turns = free.iter().all(|f| f.along.is_empty());
    let turned = if turns { "; one node held off the axis keeps a body from turning" } else { "" };
    Error::input(&step.name.at, what, format!("{merge}`fix` it in these directions{friction}{turned}{forgotten}"))
}

/// What is free as long as nothing more touches than at the start. Collective.
fn apart(
    comm: &SimpleCommunicator,
    model: &Model,
    (step, conditions): (&Step, &Conditions),
    sights: &[Vec<Standing>],
    free: &[Free],
) -> Error {
    let mut nearest = Vec::new();
    for (p, pair) in model.pairs.iter().enumerate() {
        let mut least = [sights[p].iter().filter_map(Standing::gap).map(|gap| -gap).fold(f64::NEG_INFINITY, f64::max)];
        max(comm, &mut least);
        let concerned = |f: &Free| match f.is_tool {
            true => pair.master.tool() == Some(f.index),
            false => pair.is_of(f.index),
        };
        if free.iter().any(concerned) && -least[0] > pair.controls.touching_gap * pair.facet_size {
            nearest.push(format!("`{}` begins with a gap of {:.3e}", pair.name, -least[0]));
        }
    }
    let gaps = if nearest.is_empty() { String::new() } else { format!(" (contact {})", nearest.join(", ")) };
    let pushed = if is_loaded(comm, conditions) { ", and a load acts" } else { "" };
    let what = format!(
        "step `{}`: {}: what touches at the start does not hold that{gaps}{pushed}: there is no equilibrium",
        step.name.value,
        told(free)
    );
    let merge = if free.iter().any(|f| f.is_piece) { MERGE } else { "" };
    let help = format!(
        "{merge}let the meshes touch, or `fix` or `move` it in these directions in a first step that closes the gap"
    );
    Error::input(&step.name.at, what, help)
}

/// Whether some load acts. Collective.
fn is_loaded(comm: &SimpleCommunicator, conditions: &Conditions) -> bool {
    let mut loads = [conditions.loads.iter().filter(|l| l.acts()).count() as f64];
    sum(comm, &mut loads);
    loads[0] > 0.0 || conditions.pressures.values().any(Ramp::acts) || conditions.tool_forces.iter().any(Ramp::acts)
}

fn told(free: &[Free]) -> String {
    let each: Vec<String> = free.iter().map(|free| format!("{} can {}", free.who, free.motion())).collect();
    each.join("; ")
}
