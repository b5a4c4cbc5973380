//! What every slave node sees of its master where it stands, however far away that is.
//!
//! The search widens by a factor until every node has found something, each time for those only that have found nothing.
//! So a rank holds no more of a master than lies between its farthest nodes and what is nearest to these; and that is
//! given back at the end.

use super::gaps::DEEP;
use crate::Vec3;
use crate::contact::Pair;
use crate::contact::master::Prospect;
use crate::model::locate::held;
use crate::model::{Model, outward_of};
use crate::parallel::any;
use crate::partition::Part;
use crate::surface::Projection;
use mpi::topology::SimpleCommunicator;

/// How much farther the search goes when nothing is found.
const WIDER: f64 = 4.0;
/// Share of a depth below which the nearest point is another one than that of contact, beyond rounding.
const NEARER: f64 = 1.0 - 1e-6;
/// Cosine of the normals of a slave node and of a face, above which the node does not look at the face.
const LOOKS: f64 = -0.5;
/// Widenings after which there is nothing: far beyond what numbers can tell.
const MOST: usize = 100;

/// What a slave node sees.
#[derive(Clone, Copy, Debug, Default)]
pub struct Standing {
    /// Outward unit normal of the slave faces around it; zero where they cancel.
    pub outward: Vec3,
    /// How far the elements around it reach into the body from there, the least of them.
    pub depth: f64,
    /// Where it would meet the master, as in the run, but without a limit to the distance; `None` beyond an end of it.
    pub contact: Option<Projection>,
    /// Normal of the master where it is nearest, ends included, of the face there that is the most along the node's own;
    /// and the distance. `None` where both are on one body.
    pub nearest: Option<(Vec3, f64)>,
    /// The normals of both sides of an edge or a tip of the master that is nearest, if it looks at both, and at none squarely.
    pub sides: Option<[Vec3; 2]>,
    /// The component of the mesh that the master is of there; a tool has none.
    pub component: Option<usize>,
    /// It is past an end of the master, and behind another face of it, which it does not look at.
    pub is_aside: bool,
}

impl Standing {
    /// Normal of the master.
    pub fn normal(&self) -> Option<Vec3> {
        self.contact.map(|p| p.normal).or(self.nearest.map(|(normal, _)| normal))
    }

    /// Where it would meet a face that it does not look at, if it is behind that, or within a `rounding` of it.
    fn behind(&self, rounding: f64) -> Option<Projection> {
        self.contact.filter(|at| at.gap <= rounding && self.outward.dot(&at.normal) > LOOKS)
    }

    /// Whether it is behind a face there, by more than a `rounding`, and an end of the master is nearer: it is past that end, as what is
    /// flush with a wall, below it, is below its top. What is on an edge is behind neither of its sides.
    fn is_past_an_end(&self, at: &Projection, rounding: f64) -> bool {
        at.gap < -rounding && self.nearest.is_some_and(|(_, distance)| distance < -at.gap * NEARER)
    }

    /// Distance from the master, below zero inside.
    pub fn gap(&self) -> Option<f64> {
        self.contact.map(|p| p.gap).or(self.nearest.map(|(_, distance)| distance))
    }
}

/// For each pair what its slave nodes see. Collective.
pub fn look(comm: &SimpleCommunicator, model: &mut Model) -> Vec<Vec<Standing>> {
    let own: Vec<Vec<Standing>> = model.pairs.iter().map(|pair| own_side(&model.part, pair)).collect();
    let Model { part, masters, pairs, .. } = model;
    let place = |n: u32| part.points[n as usize];
    // Those within a body look as in the run: only what looks back at them counts.
    masters.follow(comm, pairs, place);
    let fetches: Vec<usize> = masters.surfaces.iter().map(|s| s.fetches).collect();
    let mut seen = Vec::new();
    for (pair, mut sights) in pairs.iter().zip(own) {
        if pair.is_within_body() || pair.is_by_nodes() {
            let ground = masters.of(pair.master);
            for (s, sight) in sights.iter_mut().enumerate() {
                sight.contact = ground.project(pair, s, &place(pair.slaves[s].node), (None, false));
                sight.component = sight.contact.and_then(|at| ground.component(&at));
            }
        } else {
            widen(comm, pair, place, &mut sights, |points, outward, reach| {
                masters.seek(comm, pair.master, (points, outward), reach, place)
            });
            masters.forget(pair.master);
        }
        seen.push(sights);
    }
    // As they were found.
    masters.attend(comm, pairs, place);
    masters.surfaces.iter_mut().zip(fetches).for_each(|(surface, fetches)| surface.fetches = fetches);
    for (pair, sights) in model.pairs.iter().zip(&mut seen) {
        let rounding = pair.controls.no_gap * pair.facet_size;
        let behind: Vec<(usize, Projection)> =
            sights.iter().enumerate().filter_map(|(s, sight)| Some((s, sight.behind(rounding)?))).collect();
        let under = under(comm, model, pair, sights, &behind);
        for ((s, at), is_under) in behind.into_iter().zip(under) {
            let sight = &mut sights[s];
            if is_under || sight.is_past_an_end(&at, rounding) {
                (sight.contact, sight.is_aside) = (None, true);
            }
        }
    }
    seen
}

/// Which of the slave nodes that are `behind` a face of a body, or on it, without a look at it, are nearer to where the body ends
/// below them: what stands on a face, flush with it or a little in it, is behind each side of the body. Collective.
fn under(
    comm: &SimpleCommunicator,
    model: &Model,
    pair: &Pair,
    sights: &[Standing],
    behind: &[(usize, Projection)],
) -> Vec<bool> {
    let Some(body) = pair.master_body().filter(|_| !pair.is_within_body() && !pair.is_by_nodes()) else {
        return vec![false; behind.len()];
    };
    let place = |n: u32| model.part.points[n as usize];
    let below = |(s, at): &(usize, Projection)| {
        let (depth, least) = (-at.gap, DEEP * pair.facet_size);
        let x = place(pair.slaves[*s].node) - at.normal * (least - depth).max(0.0);
        x - sights[*s].outward * depth.max(least)
    };
    let points: Vec<Vec3> = behind.iter().map(below).collect();
    held(comm, model, body, &points, &place).into_iter().map(|is_held| !is_held).collect()
}

/// Asks `find` for the nodes that have found nothing, farther and farther; it gets their places, their outward normals, and
/// the reach. Collective.
fn widen(
    comm: &SimpleCommunicator,
    pair: &Pair,
    place: impl Fn(u32) -> Vec3,
    sights: &mut [Standing],
    mut find: impl FnMut(&[Vec3], &[Vec3], f64) -> Vec<Option<Prospect>>,
) {
    let mut open: Vec<usize> = (0..sights.len()).collect();
    let mut reach = pair.reach;
    for _ in 0..MOST {
        if !any(comm, !open.is_empty()) {
            return;
        }
        let points: Vec<Vec3> = open.iter().map(|&s| place(pair.slaves[s].node)).collect();
        let outward: Vec<Vec3> = open.iter().map(|&s| sights[s].outward).collect();
        let found = find(&points, &outward, reach);
        let mut rest = Vec::new();
        for (&s, found) in open.iter().zip(found) {
            match found {
                Some(Prospect { contact, nearest, sides, component }) => {
                    sights[s] = Standing { contact, nearest, sides, component, ..sights[s] };
                }
                None => rest.push(s),
            }
        }
        open = rest;
        reach *= WIDER;
    }
}

/// What slave nodes know of their own side: normals by the areas of the slave faces around, and the depth of the elements.
fn own_side(part: &Part, pair: &Pair) -> Vec<Standing> {
    let outward = outward_of(part, pair, |n| part.points[n as usize]);
    let mut depths = vec![f64::INFINITY; part.points.len()];
    for solid in &part.solids {
        for &n in solid.nodes() {
            let n = part.tie[n as usize] as usize;
            let below = |m: &u32| (part.points[n] - part.points[*m as usize]).dot(&outward[n]);
            depths[n] = depths[n].min(solid.nodes().iter().map(below).fold(0.0, f64::max));
        }
    }
    let sight = |n: usize| Standing { outward: outward[n], depth: depths[n], ..Standing::default() };
    pair.slaves.iter().map(|s| sight(s.node as usize)).collect()
}
