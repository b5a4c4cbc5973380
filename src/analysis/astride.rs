//! Slaves that are cut by an open master: a node has come behind it round an end of its surface, as it may, while the next
//! one stays in front. Near that end the facet between them spans it, as facets at a rim do; far from it no body in one
//! piece can have got there, though each of its nodes has. By places alone, along the edges of facets.
//!
//! Left out are pairs as in [`super::between`], and nodes that began past an end of the master, or inside it.

use super::between::is_unseen_between;
use super::watch::allowance;
use crate::Vec3;
use crate::contact::watch::{self, Finding, Side, View};
use crate::contact::{Pair, Sight, Slave, Status};
use crate::model::Model;
use crate::mortar::Corners;
use crate::parallel::max;
use crate::partition::PartFacet;
use mpi::topology::SimpleCommunicator;

/// The node that is deepest behind a master which cuts a facet around it, as the watch sighted nodes; none of a pair has gone
/// farther than its entry of `travels`. Collective.
pub(super) fn astride(
    comm: &SimpleCommunicator,
    model: &Model,
    travels: &[f64],
    u: &[Vec3],
) -> Option<(usize, usize, Finding)> {
    let has_behind = |pair: &Pair| pair.slaves.iter().any(|slave| place_of(slave) == BEHIND);
    let mut behind: Vec<f64> =
        model.pairs.iter().map(|pair| f64::from(is_unseen_between(pair) && has_behind(pair))).collect();
    max(comm, &mut behind);
    let mut worst: Option<(usize, usize, Finding)> = None;
    for (p, pair) in model.pairs.iter().enumerate().filter(|(p, _)| behind[*p] > 0.0) {
        let places = places(comm, model, pair);
        let facets = model.part.pieces(&model.part.sets[pair.side.set].facets);
        for facet in facets.iter() {
            let found = cut(model, (pair, travels[p]), &places, facet, u);
            let size = worst.map_or(0.0, |(_, _, worst)| worst.size());
            worst = found.filter(|(_, found)| found.size() > size).map(|(s, found)| (p, s, found)).or(worst);
        }
    }
    worst
}

/// On which side of the master a node is that counts.
const FRONT: f64 = 1.0;
/// Where it came round an end.
const BEHIND: f64 = -1.0;

/// FRONT, BEHIND or neither: past an end, and below it, a node that hangs is on no side.
fn place_of(slave: &Slave) -> f64 {
    let Sight { gap, side, .. } = slave.sights.judged;
    match side {
        Side::Front if gap >= 0.0 || slave.trial.status != Status::Gap => FRONT,
        Side::Beside if !slave.committed.aside => BEHIND,
        _ => 0.0,
    }
}

/// Places of the nodes of a slave, by local node whose displacements they have. Collective.
fn places(comm: &SimpleCommunicator, model: &Model, pair: &Pair) -> Vec<f64> {
    let mut places = vec![0.0; model.part.points.len()];
    pair.slaves.iter().for_each(|slave| places[slave.node as usize] = place_of(slave));
    model.part.halo.update(comm, 1, &mut places);
    places
}

/// A slave node of this rank that is behind the master, and next to one in front of it, where the edge of the facet between them
/// goes through the master farther from its ends than the facet is long, as it is or was meshed.
fn cut(
    model: &Model,
    (pair, travel): (&Pair, f64),
    places: &[f64],
    facet: &PartFacet,
    u: &[Vec3],
) -> Option<(usize, Finding)> {
    let part = &model.part;
    let all = &facet.nodes[..facet.count as usize];
    let node = |k: usize| part.tie[all[k % all.len()] as usize];
    let is = |k: usize, place: f64| places[node(k) as usize] == place;
    let has = |place: f64| (0..all.len()).any(|k| is(k, place));
    if !has(FRONT) || !has(BEHIND) {
        return None;
    }
    let is_layer = model.bodies[pair.side.body].is_layer();
    let now = Corners::new(all).map(|n| part.points[n as usize] + u[part.tie[n as usize] as usize]);
    // How wide a layer is says nothing.
    let length = |line: Vec3| if is_layer { line.xy().norm() } else { line.norm() };
    let longest = now.edges().map(length).fold(part.longest_edge(facet, is_layer), f64::max);
    let may = allowance(pair, f64::INFINITY, travel);
    let of_edge = |(front, behind): (usize, usize)| {
        let s = pair.index_of(node(behind)).filter(|_| is(front, FRONT) && is(behind, BEHIND))?;
        let view = View { ground: model.masters.of(pair.master), pair, slave: s };
        let ends = [front, behind].map(|k| now.x[k % all.len()]);
        let at = watch::cut(&view, &ends, longest, is_layer, &may)?;
        Some((s, Finding::Astride(-pair.slaves[s].sights.judged.gap, at)))
    };
    (0..all.len()).flat_map(|k| [(k, k + 1), (k + 1, k)]).find_map(of_edge)
}
