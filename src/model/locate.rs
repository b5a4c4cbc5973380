//! Where points stand in the bodies as they are before anything deforms.

use super::Model;
use super::elements::{mine, of_body};
use crate::Vec3;
use crate::mesh::{MOST_NODES, SolidShape};
use crate::parallel::{max, number, sum, word_of_largest};
use crate::partition::PartSolid;
use crate::partition::parcels::{bounds, grown};
use crate::solid::element::{hex8, hex27, pyramid5, tet4, tet10, wedge6, wedge18};
use crate::surface::piece_set::tree::{Tree, away};
use mpi::topology::SimpleCommunicator;

/// A point in an element of this rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Local nodes of the element; the first `count` count.
    nodes: [u32; MOST_NODES],
    /// Their shape functions at the point.
    shape: [f64; MOST_NODES],
    count: usize,
    /// The element; `None` of a node.
    pub element: Option<usize>,
}

impl Spot {
    /// The place of a local node.
    pub fn node(n: u32) -> Self {
        Self { nodes: [n; MOST_NODES], shape: [1.0; MOST_NODES], count: 1, element: None }
    }

    /// The nodes with their shape functions.
    pub fn shares(&self) -> impl Iterator<Item = (usize, f64)> {
        self.nodes.iter().map(|&n| n as usize).zip(self.shape).take(self.count)
    }
}

/// How far shape functions, or parameters, may be past the edge of an element: points on its faces are in it.
const EDGE: f64 = 1e-6;

/// How far past it they are by rounding.
const ROUNDING: f64 = 1e-12;

/// Finds an element for each point, in a given body or the first that holds it, on one of the ranks that have it; the index of
/// the first point that is in none is the error, on all ranks. Collective.
pub fn locate(
    comm: &SimpleCommunicator,
    model: &Model,
    points: &[Vec3],
    body: Option<usize>,
) -> Result<Vec<Option<Spot>>, usize> {
    // The lowest body counts, there the element that the point is least past the edge of, of these the first in the mesh:
    // between two materials that is the same on any number of ranks.
    let mut spots: Vec<Option<(f64, u64, Spot)>> = vec![None; points.len()];
    for e in mine(model) {
        let solid = &model.part.solids[e];
        if body.is_some_and(|body| body != solid.body as usize) {
            continue;
        }
        let corners = solid.nodes().iter().map(|&n| model.part.points[n as usize]);
        let Some((low, high)) = bounds(corners) else { continue };
        let (low, high) = grown((low, high), EDGE * (high - low).norm());
        for (x, best) in points.iter().zip(&mut spots) {
            let is_better = |key: f64| best.is_none_or(|(other, number, _)| (key, solid.number) < (other, number));
            let near = (0..3).all(|d| low[d] <= x[d] && x[d] <= high[d]);
            if near && is_better(f64::from(solid.body)) {
                let found = spot_in(model, e, x).map(|(past, spot)| (f64::from(solid.body) + past, solid.number, spot));
                *best = found.filter(|(key, ..)| is_better(*key)).or(*best);
            }
        }
    }
    let mut lowest: Vec<f64> = spots.iter().map(|s| s.map_or(f64::NEG_INFINITY, |(key, ..)| -key)).collect();
    max(comm, &mut lowest);
    if let Some(lost) = lowest.iter().position(|key| key.is_infinite()) {
        return Err(lost);
    }
    let has = |s: &Option<(f64, u64, Spot)>, lowest: f64| s.filter(|(key, ..)| *key == -lowest);
    let best: Vec<_> = spots.iter().zip(lowest).map(|(s, lowest)| has(s, lowest)).collect();
    let number = |s: &Option<(f64, u64, Spot)>| s.map_or(f64::NEG_INFINITY, |(_, number, _)| -(number as f64));
    let mut first: Vec<f64> = best.iter().map(number).collect();
    max(comm, &mut first);
    let own = |k: usize| best[k].filter(|_| number(&best[k]) == first[k]).map(|(.., spot)| spot);
    Ok((0..points.len()).map(own).collect())
}

/// The node nearest to a point, in a given body or any, in words with its distance. Collective.
pub fn nearest(comm: &SimpleCommunicator, model: &Model, x: &Vec3, body: Option<usize>) -> String {
    let part = &model.part;
    let owned = (0..part.owned).filter(|&n| body.is_none_or(|body| body == part.body[n] as usize));
    let distances = owned.map(|n| (n, -(part.points[n] - x).norm()));
    let found = distances.max_by(|a, b| a.1.total_cmp(&b.1));
    let words = |n: usize| {
        let (at, body) = (part.points[n], &model.bodies[part.body[n] as usize].name);
        format!("node {} of body `{body}` at [{:?}, {:?}, {:?}]", part.id[n], at.x, at.y, at.z)
    };
    word_of_largest(comm, found, words)
        .map_or(String::new(), |(node, distance)| format!("the nearest node is {node}, {:.6} away", -distance))
}

/// Whether an element with nodes at `place` holds a point, its faces included.
pub fn holds(solid: &PartSolid, place: impl Fn(u32) -> Vec3, x: &Vec3) -> bool {
    shapes_at(solid, place, x).is_some_and(|(past, _)| past <= EDGE)
}

/// A point in element `e`, if it is there, and how far it is past the edge.
fn spot_in(model: &Model, e: usize, x: &Vec3) -> Option<(f64, Spot)> {
    let solid = &model.part.solids[e];
    let (past, shape) = shapes_at(solid, |n| model.part.points[n as usize], x)?;
    (past <= EDGE).then_some((past, Spot { nodes: solid.nodes, shape, count: solid.nodes().len(), element: Some(e) }))
}

/// How far a point is past the edge of an element with nodes at `place`, in shape functions or parameters, and the shape
/// functions there; `None` far away.
fn shapes_at(solid: &PartSolid, place: impl Fn(u32) -> Vec3, x: &Vec3) -> Option<(f64, [f64; MOST_NODES])> {
    fn corners<const N: usize>(solid: &PartSolid, place: impl Fn(u32) -> Vec3) -> [[f64; 3]; N] {
        std::array::from_fn(|a| place(solid.nodes[a]).into())
    }
    let mut shape = [0.0; MOST_NODES];
    let past = match solid.shape {
        SolidShape::Tet4 => {
            let found = tet4::shape(&corners(solid, place), x)?;
            shape[..4].copy_from_slice(&found);
            found.iter().fold(0.0f64, |most, value| most.max(-value))
        }
        SolidShape::Tet10 => {
            let at = tet10::parameters(&corners(solid, place), x)?;
            shape[..10].copy_from_slice(&tet10::shape(&at));
            at.iter().fold(0.0f64, |most, value| most.max(-value))
        }
        SolidShape::Wedge6 => {
            let [xi, eta, zeta] = wedge6::parameters(&corners(solid, place), x)?;
            shape[..6].copy_from_slice(&wedge6::shape(xi, eta, zeta).0);
            past_wedge([xi, eta, zeta])
        }
        SolidShape::Pyramid5 => {
            let [p, r, t] = pyramid5::parameters(&corners(solid, place), x)?;
            shape[..5].copy_from_slice(&pyramid5::shape(p, r, t).0);
            [p.abs() - t, r.abs() - t, t - 1.0].into_iter().fold(0.0, f64::max)
        }
        SolidShape::Wedge18 => {
            let at = wedge18::parameters(&corners(solid, place), x)?;
            shape[..18].copy_from_slice(&wedge18::shape(at).0);
            past_wedge(at)
        }
        SolidShape::Hex27 => {
            let at = hex27::parameters(&corners(solid, place), x)?;
            shape = hex27::shape(at).0;
            at.iter().fold(0.0f64, |most, value| most.max(value.abs() - 1.0))
        }
        SolidShape::Hex8 => {
            let at = hex8::parameters(&corners(solid, place), x)?;
            shape[..8].copy_from_slice(&hex8::shape(at[0], at[1], at[2]).0);
            at.iter().fold(0.0f64, |most, value| most.max(value.abs() - 1.0))
        }
    };
    Some((if past < ROUNDING { 0.0 } else { past }, shape))
}

/// How far parameters are past the edge of a wedge.
fn past_wedge([xi, eta, zeta]: [f64; 3]) -> f64 {
    [-xi, -eta, xi + eta - 1.0, zeta.abs() - 1.0].into_iter().fold(0.0, f64::max)
}

/// Which of this rank's points are in an element of a body, on whatever rank, with nodes at `place`. Collective.
pub fn held(
    comm: &SimpleCommunicator,
    model: &Model,
    body: usize,
    points: &[Vec3],
    place: &dyn Fn(u32) -> Vec3,
) -> Vec<bool> {
    let (first, total) = number(comm, points.len() as u64);
    let own = first as usize..first as usize + points.len();
    if total == 0 {
        return Vec::new();
    }
    let mut all = vec![0.0; 3 * total as usize];
    for (x, to) in points.iter().zip(all[3 * own.start..].chunks_mut(3)) {
        to.copy_from_slice(x.as_slice());
    }
    sum(comm, &mut all);
    let solids: Vec<usize> = of_body(model, body).collect();
    let solid = |k: usize| &model.part.solids[solids[k]];
    let boxes: Vec<_> = (0..solids.len()).filter_map(|k| bounds(solid(k).nodes().iter().map(|&n| place(n)))).collect();
    let hull = boxes.iter().copied().reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
    let is_near = |x: &[f64]| hull.is_some_and(|hull| away(&hull, &Vec3::from_column_slice(x)) == 0.0);
    let tree = all.chunks(3).any(is_near).then(|| Tree::new(&boxes));
    let is_held = |x: &Vec3| tree.iter().flat_map(|tree| tree.meeting(x, x)).any(|(k, _)| holds(solid(k), place, x));
    let mut found: Vec<f64> =
        all.chunks(3).map(|x| if is_held(&Vec3::from_column_slice(x)) { 1.0 } else { 0.0 }).collect();
    max(comm, &mut found);
    found[own].iter().map(|held| *held > 0.0).collect()
}
