//! Slave nodes that a side of the master holds which they do not look at, as the wall of a punch that is drawn over a flat: one
//! node stands above the edge, beside the wall, and is carried along, with all that it is tied to. Between nodes the surface is
//! under the punch. Such a state is in balance, and smaller increments do not leave it; what it bears is a matter of where nodes are.
//!
//! Nodes where the slave's surface ends may be held by a side beside them, as a block that pushes a wall with its lower face named
//! alone. What a blade bears on both of its flanks is in balance, and is none either.

use crate::Vec3;
use crate::contact::watch::Finding;
use crate::contact::{Pair, Slave, Status};
use crate::model::Model;
use crate::mortar::Corners;
use crate::parallel::{any, sum};
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

/// Cosine of the angle between the normals of a node and of what presses it, below which it does not look at that: 78 degrees. In a
/// wall that is farther out of plumb nodes do not stay.
const EDGE_ON: f64 = 0.2;
/// The same of each facet around it, 60 degrees, one of which looks at what it presses where the node is at an edge of its own.
const ASKEW: f64 = 0.5;
/// The same, 15 degrees, from where what presses it is another side than that which its facets look at: they turn by less from one to
/// the next where they show a surface.
const ASIDE: f64 = 0.966;

/// The node that is held so with the most force, where what holds such nodes of a contact makes up more of its force than
/// `watch_hooked`, and more than the residual that is let through at each contact, with nodes displaced by `u`; and for each contact
/// what pushes nodes aside, N: the sum of the forces along normals to which none of the facets around a node looks, without what is
/// along the node's own, so that what is in balance, as at a blade, is none. Collective.
pub(super) fn hooked(
    comm: &SimpleCommunicator,
    model: &Model,
    u: &[Vec3],
    residuals: &[f64],
) -> (Option<(usize, usize, Finding)>, Vec<f64>) {
    let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| !pair.is_within_body());
    // The normal, and the force along it; that of the slave is the one on the master.
    let pressed = |slave: &Slave| {
        let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
        Some((at.normal, -at.normal.dot(&slave.trial.force)))
    };
    let is_askew = |slave: &Slave, outward: &Vec3, most: f64| {
        pressed(slave).filter(|(normal, force)| *force > 0.0 && -normal.dot(outward) < most)
    };
    // From where nodes looked when the increment began it is seen where to look more closely.
    let may_be = |pair: &Pair| -> BTreeSet<u32> {
        let slaves = pair.slaves.iter().zip(&pair.outward);
        slaves.filter(|(s, outward)| is_askew(s, outward, ASIDE).is_some()).map(|(s, _)| s.node).collect()
    };
    let doubtful: Vec<BTreeSet<u32>> = pairs().map(|(_, pair)| may_be(pair)).collect();
    let mut aside = vec![0.0; model.pairs.len()];
    if !any(comm, doubtful.iter().any(|nodes| !nodes.is_empty())) {
        return (None, aside);
    }
    const EACH: usize = 7;
    let mut sums = vec![0.0; EACH * model.pairs.len()];
    let mut worst: Vec<Option<(usize, f64)>> = vec![None; model.pairs.len()];
    for ((p, pair), doubtful) in pairs().zip(doubtful) {
        let sums = &mut sums[EACH * p..EACH * (p + 1)];
        sums[3] = pair.slaves.iter().filter_map(pressed).map(|(_, force)| force.abs()).sum();
        if doubtful.is_empty() {
            continue;
        }
        let place = |n: u32| model.part.points[n as usize] + u[n as usize];
        let around = around(model, pair, &doubtful, place);
        let is_layer = model.bodies[pair.side.body].is_layer();
        for (s, slave) in pair.slaves.iter().enumerate() {
            let Some(around) = around.get(&slave.node).filter(|around| around.is_inside(is_layer)) else { continue };
            let Some((normal, force)) = pressed(slave).filter(|(_, force)| *force > 0.0) else { continue };
            let looks = |most: f64| around.normals.iter().all(|facet| -normal.dot(facet) < most);
            let own = around.outward();
            if looks(ASIDE) {
                let across = (normal - own * own.dot(&normal)) * force;
                (0..3).for_each(|d| sums[4 + d] += across[d]);
            }
            if pair.faces.is_some() || -normal.dot(&own) >= EDGE_ON || !looks(ASKEW) {
                continue;
            }
            (0..3).for_each(|d| sums[d] += force * normal[d]);
            let most = worst[p].map_or(0.0, |(_, most)| most);
            worst[p] = if force > most { Some((s, force)) } else { worst[p] };
        }
    }
    sum(comm, &mut sums);
    let norm = |p: usize, first: usize| Vec3::from_column_slice(&sums[EACH * p + first..][..3]).norm();
    pairs().for_each(|(p, _)| aside[p] = norm(p, 4));
    let found = pairs().filter_map(|(p, pair)| {
        let (held, all) = (norm(p, 0), sums[EACH * p + 3]);
        let (s, force) = worst[p].filter(|_| held > (pair.controls.watch_hooked * all).max(residuals[p]))?;
        Some((p, s, Finding::Hooked(force, held / all)))
    });
    (found.max_by(|a, b| a.2.size().total_cmp(&b.2.size())), aside)
}

/// What is around a node of a slave's facets.
#[derive(Default)]
struct Around {
    /// The nodes next to it, and how many facets it shares with each.
    beside: BTreeMap<u32, usize>,
    /// Unit normals of the facets.
    normals: Vec<Vec3>,
    /// The sum of their areas.
    area: Vec3,
}

impl Around {
    /// Whether the surface does not end there: along each edge it has a facet on both sides; in a layer it goes on to two sides.
    fn is_inside(&self, is_layer: bool) -> bool {
        if is_layer { self.beside.len() > 1 } else { self.beside.values().all(|count| *count > 1) }
    }

    /// Where the node looks.
    fn outward(&self) -> Vec3 {
        self.area.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
    }
}

/// That of some nodes of a slave, at `place`.
fn around(model: &Model, pair: &Pair, some: &BTreeSet<u32>, place: impl Fn(u32) -> Vec3) -> BTreeMap<u32, Around> {
    let part = &model.part;
    let mut all: BTreeMap<u32, Around> = some.iter().map(|&n| (n, Around::default())).collect();
    for facet in part.pieces(&part.sets[pair.side.set].facets).iter() {
        let nodes = &facet.nodes[..facet.count as usize];
        let node = |k: usize| part.tie[nodes[k % nodes.len()] as usize];
        if !(0..nodes.len()).any(|k| some.contains(&node(k))) {
            continue;
        }
        let area = Corners::new(nodes).map(&place).area_vector();
        for (a, b) in (0..nodes.len()).map(|k| (node(k), node(k + 1))) {
            if let Some(around) = all.get_mut(&a) {
                around.normals.extend(area.try_normalize(f64::MIN_POSITIVE));
                around.area += area;
            }
            for (from, to) in [(a, b), (b, a)].into_iter().filter(|(from, to)| from != to) {
                if let Some(around) = all.get_mut(&from) {
                    *around.beside.entry(to).or_default() += 1;
                }
            }
        }
    }
    all
}
