//! Nodes inside a body that others of their body are to meet, which came in past the faces that contacts name, or are named by
//! none: by the places of nodes and the volume of elements alone.
//!
//! Surfaces that are named are watched by [`crate::contact::watch`]. A node that goes beside them, over an end of the surface,
//! may go into the body through a face that no contact names; no contact holds it there, and its forces are missing. So nodes
//! that are not near a face of their contacts, or have none, are looked for in the elements of the body. One is inside when all
//! points around it are, as far away as smooth surfaces differ from faces, along directions in which it is free; one that was
//! there before anything moved is meant so. A slave node may go through a thin body from one increment to the next: between them it
//! is looked for at parts of its way. A way around a corner may seem to go through it; shorter increments do not.

use super::conditions::Conditions;
use crate::Vec3;
use crate::contact::watch::Side;
use crate::contact::{Pair, Slave};
use crate::model::locate::held;
use crate::model::{Model, elements};
use crate::parallel::{any, max};
use crate::partition::parcels::{bounds, hull, meets};
use crate::surface::Patch;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// An owned node far from the faces of all contacts with the body, with the index of one of these.
pub(super) type Suspect = (usize, u32);

/// Parts of the way of an increment at which slave nodes are looked for.
const ON_THE_WAY: [f64; 3] = [0.25, 0.5, 0.75];

/// Nodes that are inside the body of their master at displacements `after`, as the watch sighted them, or on the way there from
/// those `before`. Collective.
pub(super) fn intruders(
    comm: &SimpleCommunicator,
    model: &Model,
    way: [&[Vec3]; 2],
    conditions: &Conditions,
) -> Vec<Suspect> {
    let of_bodies = || model.pairs.iter().filter(|pair| !pair.is_self());
    let mut bodies: Vec<usize> = of_bodies().filter_map(|pair| pair.master_body()).collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies.into_iter().flat_map(|body| in_body(comm, model, body, way, conditions)).collect()
}

fn in_body(
    comm: &SimpleCommunicator,
    model: &Model,
    body: usize,
    [before, after]: [&[Vec3]; 2],
    conditions: &Conditions,
) -> Vec<Suspect> {
    let part = &model.part;
    let at = |share: f64| {
        move |n: u32| {
            let tie = part.tie[n as usize] as usize;
            part.points[n as usize] + before[tie] * (1.0 - share) + after[tie] * share
        }
    };
    let (then, now) = (at(0.0), at(1.0));
    let mut suspects: Vec<Suspect> = unseen(model, body).collect();
    if !any(comm, !suspects.is_empty()) {
        return suspects;
    }
    let own = || elements::of_body(model, body).flat_map(|e| part.solids[e].nodes().iter().copied());
    let Some(hull) = hull(comm, bounds(own().flat_map(|n| [then(n), now(n)]))) else { return Vec::new() };
    suspects.retain(|(_, n)| bounds([then(*n), now(*n)].into_iter()).is_some_and(|way| meets(&hull, &way)));
    let keep = |suspects: Vec<Suspect>, points: &dyn Fn(Suspect) -> Vec<Vec3>, place: &dyn Fn(u32) -> Vec3| {
        let points: Vec<Vec<Vec3>> = suspects.iter().map(|suspect| points(*suspect)).collect();
        let mut held = held(comm, model, body, &points.concat(), place).into_iter();
        let mut all = |points: &Vec<Vec3>| held.by_ref().take(points.len()).filter(|held| !held).count() == 0;
        suspects.into_iter().zip(&points).filter_map(|(suspect, points)| all(points).then_some(suspect)).collect()
    };
    let most = bulge(comm, model, body);
    let around = |(p, n): Suspect, place: &dyn Fn(u32) -> Vec3| {
        let pair = &model.pairs[p];
        // Beside a face that is known.
        let of_patch = |slave: &Slave| model.masters.of(pair.master).bulge(slave.sights.judged.patch);
        let beside = pair.index_of(n).map(|s| &pair.slaves[s]).filter(|slave| slave.sights.judged.side == Side::Beside);
        let margin = beside.map_or(most, of_patch) + pair.controls.watch_deep * pair.facet_size;
        around(&place(n), &free_axes(pair, n, conditions), margin)
    };
    // The way of one that is let go at an end of the surface seems to go through the corner there.
    let is_lost = |&(p, n): &Suspect| {
        let pair = &model.pairs[p];
        pair.index_of(n).is_some_and(|s| !has_sight(&pair.slaves[s]))
    };
    let slaves: Vec<Suspect> = suspects.iter().copied().filter(is_lost).collect();
    let found = |suspects: Vec<Suspect>, share: f64| {
        let place = at(share);
        let inside: Vec<Suspect> = keep(suspects, &|(_, n)| vec![place(n)], &place);
        keep(inside, &|suspect| around(suspect, &place), &place)
    };
    let mut inside: Vec<Suspect> = found(suspects, 1.0);
    for share in ON_THE_WAY {
        inside.extend(found(slaves.clone(), share));
    }
    inside.sort_unstable();
    inside.dedup();
    let initial = |n: u32| part.points[n as usize];
    let began: Vec<Suspect> = keep(inside.clone(), &|suspect| around(suspect, &initial), &initial);
    inside.into_iter().filter(|suspect| !began.contains(suspect)).collect()
}

/// The nodes of bodies that meet a body and are near none of the faces of it that their contacts name.
fn unseen(model: &Model, body: usize) -> impl Iterator<Item = Suspect> {
    let part = &model.part;
    let mut of_node: BTreeMap<u32, Option<Suspect>> = BTreeMap::new();
    let pairs = model.pairs.iter().enumerate();
    for (p, pair) in pairs.filter(|(_, pair)| pair.master_body() == Some(body) && pair.side.body != body) {
        for n in part.owned_of(pair.side.body).filter(|&n| part.tie[n] as usize == n).map(|n| n as u32) {
            of_node.entry(n).or_insert(Some((p, n)));
        }
        // What is tied to the body is where that is, though it may be in the means of coarse faces.
        let tied = model.joints.iter().flat_map(|joint| joint.nodes_between(pair.side.body, body));
        of_node.extend(tied.map(|n| (n, None)));
    }
    for pair in model.pairs.iter().filter(|pair| pair.master_body() == Some(body) && !pair.is_self()) {
        for slave in pair.slaves.iter().filter(|slave| is_seen(slave)) {
            of_node.insert(slave.node, None);
        }
    }
    of_node.into_values().flatten()
}

/// Whether a slave node has a face before it. What the watch sees may be but an end of the surface, on which the contact has no point.
fn is_seen(slave: &Slave) -> bool {
    let may_be_end = slave.sights.judged.side == Side::Front && slave.trial.projection.is_none();
    has_sight(slave) && !may_be_end
}

/// Whether the watch saw something before a slave node, or a face behind which it has been since the beginning.
fn has_sight(slave: &Slave) -> bool {
    let sight = &slave.sights.judged;
    match sight.side {
        Side::Inside => true,
        Side::Beside => false,
        Side::Front => sight.normal.is_some(),
    }
}

/// How far the smooth surfaces of a body are from its faces, at most, where slave nodes are near. Collective.
fn bulge(comm: &SimpleCommunicator, model: &Model, body: usize) -> f64 {
    let of_pair = |pair: &Pair| {
        let patches = pair.master.surface().map_or(&[][..], |k| model.masters.surfaces[k].shapes().patches());
        patches.iter().map(Patch::bulge).fold(0.0, f64::max)
    };
    let pairs = model.pairs.iter().filter(|pair| pair.master_body() == Some(body));
    let mut most = [pairs.map(of_pair).fold(0.0, f64::max)];
    max(comm, &mut most);
    most[0]
}

/// Directions in which a slave node may give way; all, if there are none.
fn free_axes(pair: &Pair, node: u32, conditions: &Conditions) -> Vec<Vec3> {
    let movement = conditions.movement(node);
    let free = (0..dimensions(pair)).filter(|&d| movement.ways[d].is_nan());
    let free: Vec<Vec3> = free.map(|d| movement.axes.column(d).into_owned()).collect();
    if free.is_empty() { all_axes(pair) } else { free }
}

fn dimensions(pair: &Pair) -> usize {
    if pair.planar { 2 } else { 3 }
}

/// The coordinate axes along which anything of a pair happens.
pub(super) fn all_axes(pair: &Pair) -> Vec<Vec3> {
    (0..dimensions(pair)).map(|d| Vec3::ith(d, 1.0)).collect()
}

/// The corners of a square or cube around a point.
pub(super) fn around(x: &Vec3, axes: &[Vec3], by: f64) -> Vec<Vec3> {
    let sign = |corner: usize, d: usize| if corner >> d & 1 == 1 { by } else { -by };
    let at = |corner: usize| axes.iter().enumerate().fold(*x, |x, (d, axis)| x + axis * sign(corner, d));
    (0..1 << axes.len()).map(at).collect()
}
