//! Slave nodes that a side of the master holds which they do not look at, as the wall of a punch that is drawn over a flat: one
//! node stands above the edge, beside the wall, and is carried along, with all that it is tied to. Between nodes the surface is
//! under the punch. Such a state is in balance, and smaller increments do not leave it; what it bears is a matter of where nodes are.
//!
//! Nodes where the slave's surface ends may be held by a side beside them, as a block that pushes a wall with its lower face named
//! alone. What a blade bears on both of its flanks is in balance, and is none either.

use crate::Vec3;
use crate::contact::watch::Finding;
use crate::contact::{Pair, Slave, Status};
use crate::model::{Model, outward_of};
use crate::parallel::{any, sum};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// Cosine of the angle between the normals of a node and of what presses it, below which it does not look at that: 78 degrees. In a
/// wall that is farther out of plumb nodes do not stay.
const EDGE_ON: f64 = 0.2;
/// The same, with where nodes looked when the increment began, from which on it is looked at more closely.
const NEARLY: f64 = 0.5;

/// The node that is held so with the most force, where what holds such nodes of a contact makes up more of its force than
/// `watch_hooked`, with nodes displaced by `u`. Collective.
pub(super) fn hooked(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Option<(usize, usize, Finding)> {
    let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| pair.faces.is_none() && !pair.is_within_body());
    let normal_force = |slave: &Slave| {
        let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
        // The force is that on the master.
        Some((at.normal, -at.normal.dot(&slave.trial.force)))
    };
    let is_on_edge = |slave: &Slave, outward: &Vec3, most: f64| {
        normal_force(slave).is_some_and(|(normal, force)| force > 0.0 && -normal.dot(outward) < most)
    };
    let may_be = |pair: &Pair| pair.slaves.iter().zip(&pair.outward).any(|(s, outward)| is_on_edge(s, outward, NEARLY));
    if !any(comm, pairs().any(|(_, pair)| may_be(pair))) {
        return None;
    }
    let mut sums = vec![0.0; 4 * model.pairs.len()];
    let mut worst: Vec<Option<(usize, f64)>> = vec![None; model.pairs.len()];
    for (p, pair) in pairs() {
        let sums = &mut sums[4 * p..4 * (p + 1)];
        sums[3] = pair.slaves.iter().filter_map(normal_force).map(|(_, force)| force.abs()).sum();
        if !may_be(pair) {
            continue;
        }
        let inside = inside(model, pair);
        let outward = outward_of(&model.part, pair, |n| model.part.points[n as usize] + u[n as usize]);
        for (s, slave) in pair.slaves.iter().enumerate() {
            let (n, node) = (slave.node as usize, model.part.tie[slave.node as usize]);
            if !is_on_edge(slave, &outward[n], EDGE_ON) || !inside.get(&node).copied().unwrap_or_default() {
                continue;
            }
            if let Some((normal, force)) = normal_force(slave) {
                (0..3).for_each(|d| sums[d] += force * normal[d]);
                let most = worst[p].map_or(0.0, |(_, most)| most);
                worst[p] = if force > most { Some((s, force)) } else { worst[p] };
            }
        }
    }
    sum(comm, &mut sums);
    let held = |p: usize| Vec3::from_column_slice(&sums[4 * p..4 * p + 3]).norm();
    let is_hooked = |p: usize, pair: &Pair| held(p) > pair.controls.watch_hooked * sums[4 * p + 3];
    let found = pairs().filter(|(p, pair)| is_hooked(*p, pair));
    let found =
        found.filter_map(|(p, _)| worst[p].map(|(s, force)| (p, s, Finding::Hooked(force, held(p) / sums[4 * p + 3]))));
    found.max_by(|a, b| a.2.size().total_cmp(&b.2.size()))
}

/// The nodes of a slave's facets around which the surface does not end: along each edge there it has a facet on both sides; in a layer
/// it goes on to two sides.
fn inside(model: &Model, pair: &Pair) -> BTreeMap<u32, bool> {
    let part = &model.part;
    let mut edges: BTreeMap<u32, BTreeMap<u32, usize>> = BTreeMap::new();
    for facet in part.pieces(&part.sets[pair.side.set].facets).iter() {
        let count = facet.count as usize;
        let node = |k: usize| part.tie[facet.nodes[k % count] as usize];
        for (a, b) in (0..count).map(|k| (node(k), node(k + 1))).filter(|(a, b)| a != b) {
            *edges.entry(a).or_default().entry(b).or_default() += 1;
            *edges.entry(b).or_default().entry(a).or_default() += 1;
        }
    }
    let is_inside = |beside: BTreeMap<u32, usize>| match pair.planar {
        true => beside.len() > 1,
        false => beside.values().all(|count| *count > 1),
    };
    edges.into_iter().map(|(node, beside)| (node, is_inside(beside))).collect()
}
