//! What masters do between the nodes of a slave, where no contact feels them: an edge of a tool that goes into a facet, a ball
//! smaller than a facet. By places alone, in points of the facets near a master.
//!
//! Facets at whose nodes the master looks much the same way are looked at in their middle, others, at edges and small radii,
//! closely, those of a layer only along its plane. How deep nodes are themselves is left out: that belongs to the law of
//! contact. In self-contact and in two passes the nodes of the other side see what happens, and from node to node nothing is
//! between.

use super::intruders::{all_axes, around};
use super::watch::{allowance, reach};
use crate::contact::watch::{self, Finding, Side, View};
use crate::contact::{Master, Meets, Pair, Sight, Slave, Status};
use crate::model::Model;
use crate::model::locate::held;
use crate::mortar::Corners;
use crate::mortar::face::bilinear;
use crate::parallel::{max, sum};
use crate::partition::PartFacet;
use crate::{Vec2, Vec3};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::BTreeMap;

/// Where a facet is looked at in a direction, closely or not.
const CLOSELY: &[f64] = &[0.1, 0.3, 0.5, 0.7, 0.9];
const MIDDLE: &[f64] = &[0.5];

/// How deep a master was in a slave between its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Between {
    /// Over the size of the facet that counts; of a facet that touches no more than what would end the run.
    pub share: f64,
    pub depth: f64,
    pub place: Vec3,
    /// What it would take to push all facets of the slave out of the master, each node as stiff as the surface around it, N.
    pub lacks: f64,
}

crate::words!(Between { share, depth, place, lacks });

impl Between {
    /// The one that is deeper, measured by its facet.
    pub fn or_deeper(self, other: Self) -> Self {
        if other.share > self.share { other } else { self }
    }

    /// What is said of it, of the master of a pair.
    pub fn word(&self, model: &Model, pair: &Pair) -> String {
        let Self { share, depth, place, .. } = self;
        let (master, slave) = (model.master_name(pair), &model.bodies[pair.side.body].name);
        format!(
            "contact `{}`: {master} is {depth:.3e} deep in body `{slave}` between its nodes, {}at ({:.6}, {:.6}, {:.6}), \
             where nothing resists it",
            pair.name,
            if share.is_finite() { format!("{share:.2} of the facet ") } else { "which never touched it, ".into() },
            place.x,
            place.y,
            place.z
        )
    }

    /// What both are together.
    fn and(self, other: Self) -> Self {
        Self { lacks: self.lacks + other.lacks, ..self.or_deeper(other) }
    }
}

/// The deepest between the nodes of each pair, of which none has gone farther than its entry of `travels`, as the watch
/// sighted them; `idle` are those of which no node is in contact. Collective.
pub(super) fn between(
    comm: &SimpleCommunicator,
    model: &Model,
    (travels, idle): (&[f64], &[bool]),
    u: &[Vec3],
) -> Vec<Between> {
    let deepest = |((pair, travel), is_idle): ((&Pair, &f64), &bool)| {
        if !is_unseen_between(pair) {
            return Between::default();
        }
        let sights = Sights::new(comm, model, pair);
        let facets = model.part.pieces(&model.part.sets[pair.side.set].facets);
        let of = |facet| Facet::new(model, pair, &sights, facet, u).map(|facet| facet.deepest(model, pair, *travel));
        let beside = facets.iter().filter_map(of).fold(Between::default(), Between::and);
        if *is_idle && !pair.is_within_body() { beside.and(swallowed(comm, model, pair, u)) } else { beside }
    };
    let mine: Vec<Between> = model.pairs.iter().zip(travels).zip(idle).map(deepest).collect();
    let mut shares: Vec<f64> = mine.iter().map(|mine| mine.share).collect();
    max(comm, &mut shares);
    // Of ranks that are as deep, the first says where.
    let here = -f64::from(comm.rank());
    let has = |(mine, share): (&Between, &f64)| if mine.share == *share { here } else { f64::NEG_INFINITY };
    let mut first: Vec<f64> = mine.iter().zip(&shares).map(has).collect();
    max(comm, &mut first);
    let said = |(mine, first): (&Between, &f64)| {
        let Between { depth, place, lacks, .. } = *mine;
        if here == *first { [lacks, depth, place.x, place.y, place.z] } else { [lacks, 0.0, 0.0, 0.0, 0.0] }
    };
    let mut sums = mine.iter().zip(&first).map(said).collect::<Vec<_>>().concat();
    sum(comm, &mut sums);
    let deepest = |(share, &[lacks, depth, x, y, z]): (f64, &[f64; 5])| {
        let place = Vec3::new(x, y, z);
        Between { share, depth, place, lacks }
    };
    shares.into_iter().zip(sums.as_chunks().0).map(deepest).collect()
}

/// Whether nobody else sees what happens between the nodes of a slave: in self-contact and in two passes the nodes of the other side
/// do, and from node to node nothing is between.
pub(super) fn is_unseen_between(pair: &Pair) -> bool {
    pair.pass.other().is_none() && !matches!(pair.master, Master::Surface(_, Meets::Own | Meets::Nodes))
}

/// What the watch sighted of the nodes of a slave.
struct Sights {
    /// By local node whose displacements they have.
    all: Vec<[f64; 4]>,
    /// Of nodes of this rank in planes of symmetry how many times what is modelled of their surface is the whole of it.
    whole: BTreeMap<u32, f64>,
}

impl Sights {
    /// Collective.
    fn new(comm: &SimpleCommunicator, model: &Model, pair: &Pair) -> Self {
        let mut sights = vec![[f64::NAN; 4]; model.part.points.len()];
        for slave in &pair.slaves {
            let Sight { gap, normal, side, .. } = slave.sights.judged;
            let gap = if slave.trial.status == Status::Gap { gap } else { gap.min(0.0) };
            sights[slave.node as usize] = match normal {
                // Whatever is behind is told of by itself.
                Some(_) if side != Side::Front => [f64::NEG_INFINITY; 4],
                Some(n) => [gap, n.x, n.y, n.z],
                None => [f64::INFINITY; 4],
            };
        }
        model.part.halo.update(comm, 4, sights.as_flattened_mut());
        let mut whole = BTreeMap::new();
        pair.mirrored.iter().for_each(|(n, _)| *whole.entry(*n).or_insert(1.0) *= 2.0);
        Self { all: sights, whole }
    }

    /// Those of some nodes that are slaves.
    fn of(&self, nodes: &[u32]) -> Vec<[f64; 4]> {
        nodes.iter().map(|&n| self.all[n as usize]).filter(|[gap, ..]| !gap.is_nan()).collect()
    }
}

/// A facet near a master.
struct Facet {
    corners: Corners<Vec3>,
    inward: Vec3,
    /// One of its slave nodes.
    slave: usize,
    /// A node of it touches the master, and holds it off: what goes in beside, as an edge that the facet spans, goes in no
    /// farther than that lets it.
    touches: bool,
    /// What depths count against: its diagonal where it touches, else the edge of a square of its area; of a layer its length.
    size: f64,
    /// Its longest edge.
    longest: f64,
    /// How deep the deepest of its nodes is.
    deep: f64,
    /// Where it is looked at, along both parameters.
    spots: [&'static [f64]; 2],
    /// What its slave nodes of this rank have of its stiffness: all of them together the mean of its nodes.
    stiffness: f64,
}

impl Facet {
    /// `None` if the master is not near, or it has no slave node of this rank.
    fn new(model: &Model, pair: &Pair, sights: &Sights, facet: &PartFacet, u: &[Vec3]) -> Option<Self> {
        let part = &model.part;
        let all = &facet.nodes[..facet.count as usize];
        let nodes = all.iter().map(|&n| part.tie[n as usize]).collect::<Vec<_>>();
        let slave = nodes.iter().find_map(|&n| pair.index_of(n))?;
        let corners = Corners::new(all).map(|n| part.points[n as usize] + u[part.tie[n as usize] as usize]);
        // How wide a layer is says nothing.
        let is_layer = model.bodies[pair.side.body].is_layer();
        let length = |line: Vec3| if is_layer { line.xy().norm() } else { line.norm() };
        let longest = corners.edges().map(length).fold(0.0, f64::max);
        let seen = sights.of(&nodes);
        let nearest = seen.iter().map(|[gap, ..]| *gap).fold(f64::INFINITY, f64::min);
        if nearest == f64::NEG_INFINITY || nearest > longest {
            return None;
        }
        let along = |edge: &Vec3| !is_layer || edge.z.abs() < edge.xy().norm();
        let shortest = corners.edges().filter(along).map(length).fold(f64::INFINITY, f64::min);
        let touches = nearest <= pair.controls.watch_deep * shortest;
        let lines = corners.all().iter().flat_map(|a| corners.all().iter().map(move |b| a - b));
        let area = corners.area_vector();
        let size = match touches {
            true => lines.map(length).fold(0.0, f64::max),
            false if is_layer => shortest,
            false => area.norm().sqrt(),
        };
        let inward = -area.try_normalize(f64::MIN_POSITIVE)?;
        let normals: Vec<Vec3> = seen.iter().map(|[_, x, y, z]| Vec3::new(*x, *y, *z)).collect();
        // Two normals at this angle, at both ends of a chord: a wedge between is tan(angle)/2 of it deep at most.
        let same = 1.0 / (2.0 * pair.controls.watch_between).hypot(1.0);
        let spots = match &corners.all()[..2] {
            _ if normals.iter().all(|n| normals.iter().all(|m| n.dot(m) >= same)) => [MIDDLE, MIDDLE],
            [a, b] if is_layer && !along(&(b - a)) => [MIDDLE, CLOSELY],
            _ if is_layer => [CLOSELY, MIDDLE],
            _ => [CLOSELY, CLOSELY],
        };
        let slaves = nodes.iter().filter_map(|&n| pair.index_of(n)).map(|s| &pair.slaves[s]);
        let whole = |slave: &Slave| sights.whole.get(&slave.node).unwrap_or(&1.0);
        let stiffness =
            slaves.map(|slave| slave.stiffness(&pair.controls) * whole(slave)).sum::<f64>() / nodes.len() as f64;
        Some(Self { corners, inward, slave, touches, size, longest, deep: f64::max(-nearest, 0.0), spots, stiffness })
    }

    fn deepest(&self, model: &Model, pair: &Pair, travel: f64) -> Between {
        let view = View { ground: model.masters.of(pair.master), pair, slave: self.slave };
        let may = allowance(pair, 0.0, travel);
        let around = (reach(pair, travel) - self.longest).max(0.0);
        let most = 2.0 * pair.controls.watch_between_most * self.size + self.deep;
        let largest = if self.touches { pair.controls.watch_between_most } else { f64::INFINITY };
        let at = |place: Vec3| {
            let depth = watch::intrusion(&view, &place, &self.inward, most, around, &may) - self.deep;
            let lacks = self.stiffness * depth.max(0.0);
            Between { share: (depth / self.size).min(largest), depth, place, lacks }
        };
        let all = self.spots[0].iter().flat_map(|s| self.spots[1].iter().map(move |t| Vec2::new(*s, *t)));
        all.map(|xi| at(self.place(&xi))).fold(Between::default(), Between::or_deeper)
    }

    /// The place at parameters in the unit square, of which a triangle has one side drawn together.
    fn place(&self, xi: &Vec2) -> Vec3 {
        match self.corners.count {
            3 => self.corners.at(&[1.0 - xi.x, xi.x * (1.0 - xi.y), xi.x * xi.y, 0.0]),
            _ => self.corners.at(&bilinear(xi)[0]),
        }
    }
}

/// A master that is in the slave's body as a whole and that no node touches, as after a way through its faces between their
/// nodes, which no node and no facet has behind it: by where nodes see it before them. Collective.
fn swallowed(comm: &SimpleCommunicator, model: &Model, pair: &Pair, u: &[Vec3]) -> Between {
    let place = |n: u32| model.part.points[n as usize] + u[model.part.tie[n as usize] as usize];
    let ground = model.masters.of(pair.master);
    let axes = all_axes(pair);
    let margin = pair.controls.watch_between * pair.facet_size;
    let foot = |slave: &Slave| {
        let Sight { gap, normal, side, .. } = slave.sights.judged;
        let seen = ground.seen_from(&place(slave.node)) - normal? * gap;
        (side == Side::Front && gap > 0.0).then(|| (gap, ground.in_space(&seen)))
    };
    let feet: Vec<(f64, Vec3)> = pair.slaves.iter().filter_map(foot).collect();
    let points: Vec<Vec3> = feet.iter().flat_map(|(_, foot)| around(foot, &axes, margin)).collect();
    let held = held(comm, model, pair.side.body, &points, &place);
    let within = feet.iter().zip(held.chunks(1 << axes.len())).filter(|(_, held)| held.iter().all(|held| *held));
    let nearest = within.map(|(foot, _)| *foot).min_by(|a, b| a.0.total_cmp(&b.0));
    let whole = |(depth, place)| Between { share: f64::INFINITY, depth, place, lacks: 0.0 };
    nearest.map_or(Between::default(), whole)
}

/// What ends an increment: a pair whose master is deeper between the nodes of a facet than what these feel.
pub(super) fn too_deep(model: &Model, between: &[Between]) -> Option<(usize, Finding)> {
    let is_too_deep = |(pair, between): (&Pair, &Between)| between.share > pair.controls.watch_between_most;
    let p = model.pairs.iter().zip(between).position(is_too_deep)?;
    Some((p, Finding::Between(between[p].depth)))
}
