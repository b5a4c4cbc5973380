//! What of its contacts may be why an increment has no solution: roles, discretizations, methods and tangents that fail
//! where others do not.

use super::conditions::Conditions;
use super::preflight::DEEP;
use crate::Vec3;
use crate::contact::{Discretization, Interference, Pair, Status, Tangent, guidance};
use crate::failure::Cause;
use crate::model::Model;
use crate::parallel::{sum, word_of_largest};
use crate::scene::{Contact, Enforcement, Scene, Smoothing};
use crate::system::dofs::node_name;
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the friction that contacts can bear from which they hardly hold what they hold.
const SPENT: f64 = 0.95;
/// Over the stiffness of an element: a force below it is rounding.
const NOTHING: f64 = 1e-9;

/// What the last converged increment, with displacements `u`, tells of contacts that hold something: that they have not begun, or
/// bear all the friction that they can. Collective.
pub fn holding(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Vec<String> {
    model.pairs.iter().filter_map(|pair| of_hold(comm, model, pair, u)).collect()
}

/// Slave nodes that are on the master, at displacements `u`, those with no force, too, with its outward normal there in space.
fn on_master(model: &Model, pair: &Pair, u: &[Vec3]) -> Vec<(u32, Vec3)> {
    let ground = model.masters.of(pair.master);
    let of = |(s, node): (usize, u32)| {
        let x = ground.seen_from(&(model.part.points[node as usize] + u[node as usize]));
        let near = ground.nearest(pair, s, &x, pair.reach)?;
        let is_on = near.gap.abs() <= pair.controls.touching_gap * pair.facet_size;
        is_on.then(|| (node, ground.frame_at(None) * near.normal))
    };
    pair.slaves.iter().enumerate().filter_map(|(s, slave)| of((s, slave.node))).collect()
}

/// Of `bodies`, which supports leave free, those that a single flat contact holds which loads push along it by more than its friction
/// can bear, at fraction `end` of the step and displacements `u`: then there is no equilibrium. Collective.
pub fn pushed(
    comm: &SimpleCommunicator,
    model: &Model,
    conditions: &Conditions,
    (end, u): (f64, &[Vec3]),
    bodies: &[usize],
) -> Vec<String> {
    /// By what share of their number the sum of the normals of a plane may differ from it.
    const FLAT: f64 = 1e-6;
    if !(conditions.pressures.is_empty() && conditions.spins.is_empty() && model.joints.is_empty()) {
        return Vec::new();
    }
    let of = |body: usize| {
        let mut touching = model.pairs.iter().filter(|pair| pair.is_of(body));
        let (Some(pair), None) = (touching.next(), touching.next()) else { return None };
        let loads = (0..model.part.owned).filter(|n| model.part.body[*n] as usize == body);
        let load: Vec3 = loads.map(|n| conditions.loads[n].at(end)).sum();
        let on = on_master(model, pair, u);
        let normal: Vec3 = on.iter().map(|(_, normal)| normal).sum();
        let mut sums = [load.x, load.y, load.z, normal.x, normal.y, normal.z, on.len() as f64];
        sum(comm, &mut sums);
        let [load, normal] = [0, 3].map(|k| Vec3::new(sums[k], sums[k + 1], sums[k + 2]));
        // Walls of a groove bear what is pushed along its middle.
        if sums[6] == 0.0 || normal.norm() < (1.0 - FLAT) * sums[6] {
            return None;
        }
        // Onto the master, of which the slave is on the outer side.
        let normal = normal.normalize() * if body == pair.side.body { 1.0 } else { -1.0 };
        let (presses, friction) = (-load.dot(&normal), pair.rules.friction);
        let along = (load + normal * presses).norm();
        (presses > 0.0 && along > friction * presses).then(|| {
            format!(
                "contact `{}` alone holds body `{}`, and its loads push it along by {:.4} of what they press with, of which friction bears \
                 {friction}: it slides, and has no equilibrium: `move` it, hold it by a `spring`, or give it more friction",
                pair.name,
                model.bodies[body].name,
                along / presses
            )
        })
    };
    bodies.iter().filter_map(|&body| of(body)).collect()
}

fn of_hold(comm: &SimpleCommunicator, model: &Model, pair: &Pair, u: &[Vec3]) -> Option<String> {
    let is_on = pair.faces.as_ref().is_some_and(|faces| {
        let on: BTreeSet<u32> = on_master(model, pair, u).iter().map(|(node, _)| *node).collect();
        faces.any_of(&on)
    });
    let mut sums = [0.0, 0.0, 0.0, f64::from(u8::from(is_on))];
    let touching = pair.slaves.iter().map(|slave| &slave.accepted).filter(|at| at.status != Status::Gap);
    for (at, normal) in touching.filter_map(|at| Some((at, at.projection?.normal))) {
        let pressed = at.force.dot(&normal).abs();
        sums = [sums[0] + 1.0, sums[1] + at.traction().norm(), sums[2] + pair.rules.friction * pressed, sums[3]];
    }
    sum(comm, &mut sums);
    let ([count, along, most, on], name) = (sums, &pair.name);
    // A point or a line of it may be on the master all the same.
    if count == 0.0 && pair.faces.is_some() && on == 0.0 {
        return Some(format!(
            "contact `{name}` is from segment to segment and feels the mean gap around a node, which is open: let the first \
             increment close it, or take `discretization = \"one-pass\"`"
        ));
    }
    let share = 100.0 * along / most;
    // What bears nothing but rounding holds nothing.
    let is_spent = most > NOTHING * model.stiffness * model.size && along >= SPENT * most;
    is_spent.then(|| {
        format!(
            "contact `{name}` bears {share:.1} % of the friction that it can: where that has to hold a body, lower what pushes it \
             along, `move` it, or end the step before"
        )
    })
}

/// Contacts of which much hangs past an end of the master, as its last converged increment is, which the master attends to:
/// equilibrium may end where it slides off. Collective.
pub fn hanging(comm: &SimpleCommunicator, model: &Model) -> Vec<String> {
    model.pairs.iter().filter_map(|pair| of_end(comm, model, pair)).collect()
}

fn of_end(comm: &SimpleCommunicator, model: &Model, pair: &Pair) -> Option<String> {
    let ground = model.masters.of(pair.master);
    let mut sums = [0.0; 2];
    if pair.slides_at_nodes() {
        for (s, slave) in pair.slaves.iter().enumerate().filter(|(_, slave)| slave.accepted.status != Status::Gap) {
            let (at, force) = (&slave.accepted, slave.accepted.force.norm());
            let near = ground.nearest(pair, s, &ground.seen_from(&at.position), pair.reach);
            let aside = pair.sides().aside;
            // In a kink it may keep to a piece that is not the nearest.
            let is_in_kink = at.kinks.keeps || at.kinks.wedge > 0.0;
            let hangs = near.zip(at.projection).is_some_and(|(near, at)| near.gap.abs() > at.gap.abs() + aside);
            sums = [sums[0] + force, sums[1] + if hangs && !is_in_kink { force } else { 0.0 }];
        }
    }
    sum(comm, &mut sums);
    let share = sums[1] / sums[0];
    (share > pair.controls.watch_slid).then(|| {
        format!(
            "nodes with {:.0} % of the force of contact `{}` are past the end of {}, about to slide off, and between its nodes a \
             slave does not feel where a master ends: extend that, or take `discretization = \"segment\"`",
            100.0 * share,
            pair.name,
            model.master_name(pair)
        )
    })
}

/// Contacts of which nodes begin deep inside the master, where nothing has converged yet: a shorter increment pushes them out as far.
/// Collective.
pub fn overlapping(comm: &SimpleCommunicator, model: &Model) -> Vec<String> {
    let of = |pair: &Pair| {
        let deepest = pair.overlap(comm);
        (deepest > DEEP * pair.facet_size).then(|| {
            format!(
                "contact `{}` begins with nodes up to {:.3e} deep in {}, which the first increment pushes out however short it is: \
                 give it `interference = \"ramped\"`, or begin apart and move there, over a cone where that goes along the surface",
                pair.name,
                deepest,
                model.master_name(pair)
            )
        })
    };
    model.pairs.iter().filter(|pair| pair.rules.interference != Interference::Ramped).filter_map(of).collect()
}

/// Contacts whose masters lie flush on the same slave nodes, at displacements `u`, which the masters attend to: which of them a node
/// is to bear is for the iteration to find. Collective.
pub fn flush(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Vec<String> {
    /// Cosine of the normals of masters, from which they are on the same side of a node.
    const ALIKE: f64 = 0.9;
    let open = |pair: &Pair| !pair.is_self() && !pair.pass.is_second();
    let on: Vec<(&Pair, BTreeMap<u32, Vec3>)> = (model.pairs.iter())
        .filter(|pair| open(pair))
        .map(|pair| (pair, on_master(model, pair, u).into_iter().collect()))
        .collect();
    let mut told = Vec::new();
    for (q, (second, others)) in on.iter().enumerate() {
        for (first, nodes) in &on[..q] {
            let is_both = |(node, a): &(&u32, &Vec3)| others.get(*node).is_some_and(|b| a.dot(b) > ALIKE);
            let mut count = [nodes.iter().filter(is_both).count() as f64];
            sum(comm, &mut count);
            if count[0] > 1.0 {
                told.push(format!(
                    "{} and {} lie flush on {} nodes, slaves of contact `{}` and of contact `{}`: leave out \
                     of each what only the other is to press, or let one master begin apart",
                    model.master_name(first),
                    model.master_name(second),
                    count[0],
                    first.name,
                    second.name
                ));
            }
        }
    }
    told
}

/// What to do about a hollow edge that presses nodes from both sides.
const OF_HOLLOWS: &str =
    "round the edge by a fillet, or give each side a contact of its own, as faces with a name or a tool for each";

/// Contacts of which nodes are in hollow edges of the master, at displacements `u`, which the master attends to: two sides press
/// them, and a contact has one force for a node. Collective.
pub fn hollow(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Vec<String> {
    /// Over the facets of the slave: how near a node is to both sides.
    const NEAR: f64 = 0.1;
    let of_pair = |pair: &Pair| {
        let (node, turn) = in_hollow(comm, model, pair, (u, NEAR))?;
        Some(format!(
            "node {node} is in a hollow edge of {}, whose sides, which turn by {turn:.0} degrees there, both press it, and contact `{}` has \
             one force for a node: {OF_HOLLOWS}",
            model.master_name(pair),
            pair.name
        ))
    };
    model.pairs.iter().filter_map(of_pair).collect()
}

/// Warnings of contacts whose nodes begin in hollow edges of the master, or next to one, as a block does that fills its groove.
/// Collective.
pub fn begun_hollow(comm: &SimpleCommunicator, model: &Model) -> Vec<String> {
    /// As above; what fills a groove has some play.
    const NEAR: f64 = 0.25;
    let still = vec![Vec3::zeros(); model.part.points.len()];
    let of_pair = |pair: &Pair| {
        let (node, turn) = in_hollow(comm, model, pair, (&still, NEAR))?;
        Some(format!(
            "contact `{}`: node {node} begins at a hollow edge of {}, whose sides turn by {turn:.0} degrees there: increments may fail \
             where both press it, for a contact has one force for a node; {OF_HOLLOWS}",
            pair.name,
            model.master_name(pair)
        ))
    };
    model.pairs.iter().filter(|pair| !pair.is_self()).filter_map(of_pair).collect()
}

/// The slave node that is within so much of a facet of both sides of the sharpest hollow edge, and by how much that turns, degrees.
/// Collective.
fn in_hollow(
    comm: &SimpleCommunicator,
    model: &Model,
    pair: &Pair,
    (u, near): (&[Vec3], f64),
) -> Option<(String, f64)> {
    let ground = model.masters.of(pair.master);
    let sides = |node: u32| {
        let x = model.part.points[node as usize] + u[node as usize];
        let [a, b] = ground.hollow(pair, &x, near * pair.facet_size)?;
        Some((node, a.dot(&b).clamp(-1.0, 1.0).acos().to_degrees()))
    };
    let sharpest = pair.slaves.iter().filter_map(|slave| sides(slave.node)).max_by(|a, b| a.1.total_cmp(&b.1));
    word_of_largest(comm, sharpest, |node| node_name(model, node))
}

/// What to change in the contacts of the `body` where an increment failed, of all bodies where that is not known. Collective.
pub fn remedies(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &Model,
    (cause, body): (Cause, Option<&str>),
) -> Vec<String> {
    if !(cause.is_of_iteration() || matches!(cause, Cause::Rounds | Cause::Watch)) {
        return Vec::new();
    }
    // A slave that is far too coarse was refused.
    let wrong = model.guidance(comm, scene).unwrap_or_default().wrong;
    let concerns = |set: &str| body.is_none_or(|body| set.split('.').next() == Some(body));
    let concerned = scene.contacts.iter().filter(|c| concerns(&c.slave.value) || concerns(&c.master.value));
    concerned
        .flat_map(|contact| {
            let reason = wrong.iter().find(|w| w.contact == contact.name.value).map(|w| w.reason.as_str());
            of_contact(scene, contact, reason, cause)
        })
        .collect()
}

/// What to change in a contact, with the reason why it is the wrong way round, if it is.
fn of_contact(scene: &Scene, contact: &Contact, reason: Option<&str>, cause: Cause) -> Vec<String> {
    let name = &contact.name.value;
    let mut remedies = Vec::new();
    if contact.discretization == Discretization::NodeToNode {
        remedies
            .push(format!("contact `{name}` is \"node-to-node\", for small sliding: take another `discretization`"));
    }
    if cause == Cause::Watch {
        return remedies;
    }
    let two_passes = contact.discretization == Discretization::TwoPass;
    if let Some(reason) = reason {
        remedies.push(format!("exchange slave and master of contact `{name}`: {reason}"));
    }
    if two_passes {
        let is_flat = contact.surface.as_ref().is_some_and(|of| of.smoothing == Smoothing::Facet);
        let or = if is_flat { "" } else { ", or between flat faces `smoothing = \"facet\"`" };
        remedies.push(match guidance::far_softer(scene, contact) {
            Some(softer) => format!("contact `{name}` has two passes: take one, with the far softer `{softer}` as the slave"),
            None => format!(
                "contact `{name}` has two passes, whose conditions may contradict each other: take `discretization = \"segment\"`{or}"
            ),
        });
    }
    let slides_freely = contact.friction == 0.0 && contact.surface.is_some() && !contact.is_self();
    if contact.discretization == Discretization::OnePass && slides_freely {
        remedies.push(format!(
            "contact `{name}` has one pass, and what slides without friction may go to and fro over edges of its master's facets: \
             take `discretization = \"segment\"`, which feels the mean"
        ));
    }
    if matches!(contact.method, Enforcement::Lagrange | Enforcement::Uzawa) && cause != Cause::Rounds {
        let (method, best) = (contact.method.key(), Enforcement::AugmentedLagrangian.key());
        remedies
            .push(format!("contact `{name}` has the method \"{method}\": take \"{best}\", which finds more solutions"));
    }
    if contact.tangent == Tangent::FixedFrame {
        remedies.push(format!(
            "contact `{name}` has the tangent \"fixed-frame\", which converges slowly where contact slides: take \"exact\""
        ));
    }
    remedies
}
