//! Slave nodes that a side of the master holds which they do not look at, as the wall of a punch that is drawn over a flat: one
//! node stands above the edge, beside the wall, and is carried along, with all that it is tied to. Between nodes the surface is
//! under the punch. Such a state is in balance, and smaller increments do not leave it; what it bears is a matter of where nodes are.
//!
//! Nodes where the slave's surface ends may be held by a side beside them, as a block that pushes a wall with its lower face named
//! alone. What a blade bears on both of its flanks is in balance, and is none either.
//!
//! Less steep sides of a sharp edge push the nodes beside it aside, where the force should look as the slave does: each node snaps over
//! the edge in its turn, and takes energy along. What is between the normals of the facets around a node, at a corner of the slave on
//! a flat, is no such side.

use crate::Vec3;
use crate::contact::watch::Finding;
use crate::contact::{Pair, Slave, Status};
use crate::model::Model;
use crate::mortar::Corners;
use crate::parallel::{any, sum, to_all};
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

/// Cosine of the angle between the normals of a node and of what presses it, below which it does not look at that: 78 degrees. In a
/// wall that is farther out of plumb nodes do not stay.
const EDGE_ON: f64 = 0.2;
/// The same of each facet around it, 60 degrees, one of which looks at what it presses where the node is at an edge of its own.
const ASKEW: f64 = 0.5;
/// The sine of the angle, 15 degrees, between what presses a node and the nearest direction between those of its facets, from where
/// it is another side than the one that these look at: they turn by less from one to the next where they show a surface.
const ASIDE: f64 = 0.26;

/// What presses a slave node along the normal of the master, if something does: that normal, and the force, N. That of the slave is
/// the one on the master.
fn pressed(slave: &Slave) -> Option<(Vec3, f64)> {
    let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
    Some((at.normal, -at.normal.dot(&slave.trial.force)))
}

/// The node that is held so with the most force, where what holds such nodes of a contact makes up more of its force than
/// `watch_hooked`, and more than the residual that is let through at each contact, with nodes displaced by `u`; and for each contact
/// what pushes nodes aside, N, see [`pushed`]. Collective.
pub(super) fn hooked(
    comm: &SimpleCommunicator,
    model: &Model,
    u: &[Vec3],
    residuals: &[f64],
) -> (Option<(usize, usize, Finding)>, Vec<f64>) {
    let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| !pair.is_within_body());
    // From where nodes looked when the increment began it is seen where to look more closely.
    let is_doubtful = |slave: &Slave, outward: &Vec3| {
        pressed(slave).is_some_and(|(n, force)| force > 0.0 && -n.dot(outward) < (1.0 - ASIDE * ASIDE).sqrt())
    };
    let may_be = |pair: &Pair| -> BTreeSet<u32> {
        let slaves = pair.slaves.iter().zip(&pair.outward);
        slaves.filter(|(slave, outward)| is_doubtful(slave, outward)).map(|(slave, _)| slave.node).collect()
    };
    let doubtful: Vec<BTreeSet<u32>> = pairs().map(|(_, pair)| may_be(pair)).collect();
    if !any(comm, doubtful.iter().any(|nodes| !nodes.is_empty())) {
        return (None, vec![0.0; model.pairs.len()]);
    }
    let mut sums = vec![0.0; 4 * model.pairs.len()];
    let mut worst: Vec<Option<(usize, f64)>> = vec![None; model.pairs.len()];
    let mut aside = Vec::new();
    for ((p, pair), doubtful) in pairs().zip(doubtful) {
        let sums = &mut sums[4 * p..4 * (p + 1)];
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
            let beyond = beyond(&-normal, &around.normals);
            if beyond.norm() > ASIDE {
                aside.push(Pushed { pair: p, node: slave.node, force: beyond * force });
            }
            let is_askew = around.normals.iter().all(|facet| -normal.dot(facet) < ASKEW);
            if pair.faces.is_some() || -normal.dot(&around.outward()) >= EDGE_ON || !is_askew {
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
    (found.max_by(|a, b| a.2.size().total_cmp(&b.2.size())), pushed(comm, model, &aside))
}

/// What is left of a direction when the nearest one between some `normals`, of which none counts negatively, is taken from it: nothing
/// if it is between them, as at a corner of the slave on a flat.
fn beyond(direction: &Vec3, normals: &[Vec3]) -> Vec3 {
    /// To a thousandth, of normals that are 10 degrees apart.
    const SWEEPS: usize = 200;
    let (mut rest, mut shares) = (*direction, vec![0.0; normals.len()]);
    for _ in 0..SWEEPS {
        for (normal, share) in normals.iter().zip(&mut shares) {
            let next = f64::max(*share + rest.dot(normal), 0.0);
            rest -= normal * (next - *share);
            *share = next;
        }
    }
    rest
}

/// An owned slave node of a pair that a side pushes aside with a force.
struct Pushed {
    pair: usize,
    node: u32,
    force: Vec3,
}

/// Pair and number of a node.
type Key = [u64; 2];

/// The forces with which nodes of each contact are pushed aside, N: the sum over a coherent part of the nodes that touch, in which what
/// is in balance, as at both flanks of a blade, is none, and without what the images of a part in planes of symmetry balance, or its
/// ring around an axis; added up over all parts. Collective.
fn pushed(comm: &SimpleCommunicator, model: &Model, aside: &[Pushed]) -> Vec<f64> {
    let part = &model.part;
    let numbers = part.global_numbers(comm);
    let row = |p: usize, n: u32, v: &Vec3| [p as f64, numbers[n as usize] as f64, v.x, v.y, v.z];
    let key = |p: f64, n: f64| [p as u64, n as u64];
    let forces: Vec<_> = aside.iter().map(|at| row(at.pair, at.node, &at.force)).collect();
    let forces = to_all(comm, &forces);
    let mut all = vec![0.0; model.pairs.len()];
    if forces.is_empty() {
        return all;
    }
    let (mut links, mut planes) = (Vec::new(), Vec::new());
    for p in forces.iter().map(|[p, ..]| *p as usize).collect::<BTreeSet<usize>>() {
        let pair = &model.pairs[p];
        let mut touches = vec![0.0; part.points.len()];
        for slave in pair.slaves.iter().filter(|slave| slave.trial.status != Status::Gap) {
            touches[slave.node as usize] = 1.0;
        }
        part.halo.update(comm, 1, &mut touches);
        for facet in part.pieces(&part.sets[pair.side.set].facets).iter() {
            let nodes = facet.nodes[..facet.count as usize].iter().map(|&n| part.tie[n as usize]);
            let touching: Vec<u32> = nodes.filter(|n| touches[*n as usize] > 0.0).collect();
            let number = |n: u32| numbers[n as usize] as f64;
            links.extend(touching.windows(2).map(|ends| [p as f64, number(ends[0]), number(ends[1])]));
        }
        let axis = pair.slaves.iter().filter(|slave| model.is_on_axis(slave.node as usize));
        let mirrors = pair.mirrored.iter().copied().chain(axis.map(|slave| (slave.node, Vec3::x())));
        planes.extend(mirrors.filter(|(n, _)| touches[*n as usize] > 0.0).map(|(n, normal)| row(p, n, &normal)));
    }
    let mut parts = Parts::default();
    for [p, a, b] in to_all(comm, &links) {
        parts.join(key(p, a), key(p, b));
    }
    let mut sums: BTreeMap<Key, Vec3> = BTreeMap::new();
    for [p, n, x, y, z] in forces {
        *sums.entry(parts.of(key(p, n))).or_default() += Vec3::new(x, y, z);
    }
    for [p, n, x, y, z] in to_all(comm, &planes) {
        let normal = Vec3::new(x, y, z);
        sums.entry(parts.of(key(p, n))).and_modify(|sum| *sum -= normal * normal.dot(sum));
    }
    sums.iter().for_each(|([p, _], force)| all[*p as usize] += force.norm());
    all
}

/// Nodes that hang together, each with another one of its part; the least of a part stands for it.
#[derive(Default)]
struct Parts(BTreeMap<Key, Key>);

impl Parts {
    fn of(&self, mut at: Key) -> Key {
        while let Some(next) = self.0.get(&at) {
            at = *next;
        }
        at
    }

    fn join(&mut self, a: Key, b: Key) {
        let (a, b) = (self.of(a), self.of(b));
        if a != b {
            self.0.insert(a.max(b), a.min(b));
        }
    }
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
