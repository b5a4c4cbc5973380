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
use crate::mortar::Corners;
use crate::parallel::{any, sum};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// Cosine of the angle between the normals of a node and of what presses it, below which it does not look at that: 78 degrees. In a
/// wall that is farther out of plumb nodes do not stay.
const EDGE_ON: f64 = 0.2;
/// The same of each facet around it, 60 degrees, one of which looks at what it presses where the node is at an edge of its own.
const ASKEW: f64 = 0.5;

/// The node that is held so with the most force, where what holds such nodes of a contact makes up more of its force than
/// `watch_hooked`, and more than the residual that is let through at each contact, with nodes displaced by `u`. Collective.
pub(super) fn hooked(
    comm: &SimpleCommunicator,
    model: &Model,
    u: &[Vec3],
    residuals: &[f64],
) -> Option<(usize, usize, Finding)> {
    let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| pair.faces.is_none() && !pair.is_within_body());
    // The normal, and the force along it; that of the slave is the one on the master.
    let pressed = |slave: &Slave| {
        let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
        Some((at.normal, -at.normal.dot(&slave.trial.force)))
    };
    // From where nodes looked when the increment began it is seen where to look more closely.
    let is_askew = |slave: &Slave, outward: &Vec3, most: f64| {
        pressed(slave).filter(|(normal, force)| *force > 0.0 && -normal.dot(outward) < most)
    };
    let may_be =
        |pair: &Pair| pair.slaves.iter().zip(&pair.outward).any(|(s, outward)| is_askew(s, outward, ASKEW).is_some());
    let doubtful: Vec<bool> = pairs().map(|(_, pair)| may_be(pair)).collect();
    if !any(comm, doubtful.contains(&true)) {
        return None;
    }
    let mut sums = vec![0.0; 4 * model.pairs.len()];
    let mut worst: Vec<Option<(usize, f64)>> = vec![None; model.pairs.len()];
    for ((p, pair), is_doubtful) in pairs().zip(doubtful) {
        let sums = &mut sums[4 * p..4 * (p + 1)];
        sums[3] = pair.slaves.iter().filter_map(pressed).map(|(_, force)| force.abs()).sum();
        if !is_doubtful {
            continue;
        }
        let place = |n: u32| model.part.points[n as usize] + u[n as usize];
        let (outward, around) = (outward_of(&model.part, pair, place), around(model, pair, place));
        for (s, slave) in pair.slaves.iter().enumerate() {
            let Some((normal, force)) = is_askew(slave, &outward[slave.node as usize], EDGE_ON) else { continue };
            let is_hooked = |around: &Around| {
                around.is_inside(model.bodies[pair.side.body].is_layer())
                    && around.normals.iter().all(|facet| -normal.dot(facet) < ASKEW)
            };
            if !around.get(&model.part.tie[slave.node as usize]).is_some_and(is_hooked) {
                continue;
            }
            (0..3).for_each(|d| sums[d] += force * normal[d]);
            let most = worst[p].map_or(0.0, |(_, most)| most);
            worst[p] = if force > most { Some((s, force)) } else { worst[p] };
        }
    }
    sum(comm, &mut sums);
    let found = pairs().filter_map(|(p, pair)| {
        let (held, all) = (Vec3::from_column_slice(&sums[4 * p..4 * p + 3]).norm(), sums[4 * p + 3]);
        let (s, force) = worst[p].filter(|_| held > (pair.controls.watch_hooked * all).max(residuals[p]))?;
        Some((p, s, Finding::Hooked(force, held / all)))
    });
    found.max_by(|a, b| a.2.size().total_cmp(&b.2.size()))
}

/// What is around a node of a slave's facets.
#[derive(Default)]
struct Around {
    /// The nodes next to it, and how many facets it shares with each.
    beside: BTreeMap<u32, usize>,
    /// Unit normals of the facets.
    normals: Vec<Vec3>,
}

impl Around {
    /// Whether the surface does not end there: along each edge it has a facet on both sides; in a layer it goes on to two sides.
    fn is_inside(&self, is_layer: bool) -> bool {
        if is_layer { self.beside.len() > 1 } else { self.beside.values().all(|count| *count > 1) }
    }
}

/// That of the nodes of a slave, at `place`.
fn around(model: &Model, pair: &Pair, place: impl Fn(u32) -> Vec3) -> BTreeMap<u32, Around> {
    let part = &model.part;
    let mut all: BTreeMap<u32, Around> = BTreeMap::new();
    for facet in part.pieces(&part.sets[pair.side.set].facets).iter() {
        let nodes = &facet.nodes[..facet.count as usize];
        let node = |k: usize| part.tie[nodes[k % nodes.len()] as usize];
        let normal = Corners::new(nodes).map(&place).area_vector().try_normalize(f64::MIN_POSITIVE);
        for (a, b) in (0..nodes.len()).map(|k| (node(k), node(k + 1))) {
            all.entry(a).or_default().normals.extend(normal);
            if a != b {
                *all.entry(a).or_default().beside.entry(b).or_default() += 1;
                *all.entry(b).or_default().beside.entry(a).or_default() += 1;
            }
        }
    }
    all
}
