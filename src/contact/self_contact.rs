//! Self-contact: which of the patches of its own surface a node may meet.
//!
//! Every node of the surface is a slave against the patches of the same surface: two passes by nature. A node meets no
//! patch of the facets around it, nor one that shares a node with these. What it meets looks back at it: the angle
//! between the opposite of its own outward normal and that of the patch is less than `self_facing`. And it is less than half the thickness
//! below the patch: deeper, it is the far side of the sheet that the patch bounds, like the nodes opposite in Fig. 31 of
//! Neto, Oliveira and Menezes.
//!
//! The thickness at a facet is how far the straight line from its middle into the body goes to the next facet of the
//! same surface, on the initial mesh; that at a node is the least of the facets around. As the sheet deforms, it is how far
//! the point across that the line met is below the facet. Where no facet comes, such as where the other side of a sheet is
//! not part of the surface, nothing is excluded by depth.

use crate::Vec3;
use crate::controls::Controls;
use crate::parallel::{Parcels, exchange};
use crate::surface::projection::{Extent, Foot};
use crate::surface::{Admission, MovingPatch, Patch, PatchSet, Piece, Polygon};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// What a node must not meet on its own surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Avoided {
    /// Ids of the patches around it, ascending.
    around: Vec<u32>,
    /// Least depth below a patch from which the node is on the other side of its sheet.
    deep: f64,
    /// What is across the sheet from the facets around it, where the thickness was measured.
    across: Vec<Across>,
}

/// A facet, and the point of the other side of the sheet that is straight below its middle on the initial mesh. Nodes by
/// their global numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Across {
    count: u8,
    facet: [u64; 4],
    triangle: [u64; 3],
    /// Weights of the triangle's corners.
    weights: [f64; 3],
}

impl Across {
    /// Length of [`Self::to_numbers`].
    const LEN: usize = 11;

    fn nodes(&self) -> impl Iterator<Item = u64> + '_ {
        self.facet[..self.count as usize].iter().chain(&self.triangle).copied()
    }

    /// How far the point is below the facet, with nodes at `place`.
    fn thickness(&self, place: &impl Fn(u64) -> Vec3) -> f64 {
        let corner = |k: usize| place(self.facet[k % self.count as usize]);
        let area = (corner(2) - corner(0)).cross(&(corner(3) - corner(1)));
        let middle = (0..self.count as usize).map(corner).sum::<Vec3>() / f64::from(self.count);
        let point: Vec3 = self.triangle.iter().zip(self.weights).map(|(n, w)| place(*n) * w).sum();
        (middle - point).dot(&area) / area.norm()
    }

    fn to_numbers(self) -> [f64; Self::LEN] {
        let mut numbers = [0.0; Self::LEN];
        numbers[0] = f64::from(self.count);
        self.facet.iter().chain(&self.triangle).zip(&mut numbers[1..]).for_each(|(n, to)| *to = *n as f64);
        numbers[8..].copy_from_slice(&self.weights);
        numbers
    }

    fn from_numbers(numbers: &[f64; Self::LEN]) -> Self {
        let node = |k: usize| numbers[k] as u64;
        let [facet, triangle] = [[1, 2, 3, 4], [5, 6, 7, 7]].map(|k| k.map(node));
        let weights = [numbers[8], numbers[9], numbers[10]];
        Self { count: numbers[0] as u8, facet, triangle: [triangle[0], triangle[1], triangle[2]], weights }
    }
}

impl Avoided {
    /// Whether a node may meet a patch at a point with its unit normal.
    fn allows(&self, look: &Outlook, outward: &Vec3, id: u32, point: &Vec3, normal: &Vec3) -> bool {
        outward.dot(normal) < look.facing && (look.x - point).dot(normal) > -self.deep && !self.is_beside(id)
    }

    /// Whether a patch is one of those around the node.
    pub fn is_beside(&self, id: u32) -> bool {
        self.around.binary_search(&id).is_ok()
    }

    /// Whether the node may meet some point of a patch.
    fn may_allow(&self, look: &Outlook, outward: &Vec3, id: u32, extent: &Extent) -> bool {
        extent.may_face(outward, look.facing) && !extent.is_far_above(look.x, self.deep) && !self.is_beside(id)
    }

    /// Whether the node, which looks `outward`, may meet a patch before long.
    pub fn may_meet(&self, outward: &Vec3, patch: &Patch) -> bool {
        let normal = patch.local(patch.center()).area_vector();
        outward.dot(&normal) < 0.0 && !self.is_beside(patch.id)
    }

    /// Least depth below a patch from which the node is on the other side of its sheet.
    pub fn deep(&self) -> f64 {
        self.deep
    }

    /// Takes over what [`Self::deep`] was at an earlier state.
    pub fn remember(&mut self, deep: f64) {
        self.deep = deep;
    }

    /// The depth by a given thickness, which stays, and a share of it.
    pub fn with_thickness(self, thickness: f64, share: f64) -> Self {
        Self { deep: share * thickness, across: Vec::new(), ..self }
    }

    /// What none of some nodes may meet: a face with these at its corners.
    pub fn of_all<'a>(nodes: impl Iterator<Item = &'a Self>) -> Self {
        let mut all = Self { deep: f64::INFINITY, ..Self::default() };
        for node in nodes {
            all.around.extend(&node.around);
            all.across.extend(&node.across);
            all.deep = all.deep.min(node.deep);
        }
        all.around.sort_unstable();
        all.around.dedup();
        all
    }

    fn to_numbers(&self, node: u64) -> Vec<f64> {
        let Self { around, deep, across } = self;
        let head = [node as f64, *deep, around.len() as f64, across.len() as f64];
        let around = around.iter().map(|&id| f64::from(id));
        head.into_iter().chain(around).chain(across.iter().flat_map(|across| across.to_numbers())).collect()
    }

    /// The nodes that its thickness depends on, by global numbers.
    pub fn depends_on(&self) -> impl Iterator<Item = u64> + '_ {
        self.across.iter().flat_map(Across::nodes)
    }

    /// Takes a share of the thickness of the sheet with these nodes at `place`. Where it is folded over, the last one stays.
    pub fn follow(&mut self, share: f64, place: impl Fn(u64) -> Vec3) {
        let least = self.across.iter().map(|across| across.thickness(&place)).fold(f64::INFINITY, f64::min);
        if least > 0.0 && least.is_finite() {
            self.deep = share * least;
        }
    }
}

/// What a node at `x` within a body can meet.
pub struct Outlook<'a> {
    pub x: &'a Vec3,
    /// Its outward unit normal; one that has none meets everything.
    pub outward: Option<&'a Vec3>,
    /// In self-contact what it must not meet.
    pub avoided: Option<&'a Avoided>,
    /// Cosine between the normals of what meets in self-contact, at most.
    pub facing: f64,
}

impl<'a> Outlook<'a> {
    /// That of a node at `x` that may meet all that there is.
    pub fn everywhere(x: &'a Vec3) -> Self {
        Self { x, outward: None, avoided: None, facing: 0.0 }
    }
}

impl Admission<Patch> for Outlook<'_> {
    fn may_admit(&self, patch: &Patch, extent: &Extent) -> bool {
        match (self.outward, self.avoided) {
            (Some(outward), Some(avoided)) => avoided.may_allow(self, outward, patch.id, extent),
            _ => true,
        }
    }

    fn admits(&self, patch: &Patch, nearest: &Foot) -> bool {
        let Some(outward) = self.outward else { return true };
        let normal = nearest.local.area_vector().normalize();
        match self.avoided {
            Some(avoided) => avoided.allows(self, outward, patch.id, &nearest.local.point, &normal),
            None => outward.dot(&normal) < 0.0,
        }
    }
}

/// What the nodes of a surface avoid, by their global numbers: from its patches, with nodes at `place`.
pub fn avoided(patches: &[MovingPatch], controls: &Controls, place: impl Fn(u64) -> Vec3) -> BTreeMap<u64, Avoided> {
    let own = |patch: &MovingPatch| patch.nodes[..patch.count as usize].to_vec();
    let mut at_node: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (k, patch) in patches.iter().enumerate() {
        own(patch).into_iter().for_each(|n| at_node.entry(n).or_default().push(k));
    }
    let straight = |patch: &MovingPatch| patch.straight(&patch.nodes.iter().map(|&n| place(n)).collect::<Vec<_>>());
    let facets = PatchSet::new(patches.iter().map(straight).collect());
    let longest = controls.self_thick * facets.pieces().iter().map(longest_edge).fold(0.0, f64::max);
    let index: BTreeMap<u32, usize> = patches.iter().enumerate().map(|(k, patch)| (patch.id, k)).collect();
    let across: Vec<Option<Across>> = (patches.iter())
        .map(|patch| {
            let (_, id, corners, weights) = thickness(&facets, patch.id, longest)?;
            let other = &patches[index[&id]].nodes;
            let mut facet = [patch.nodes[0]; 4];
            facet[..patch.count as usize].copy_from_slice(&patch.nodes[..patch.count as usize]);
            Some(Across { count: patch.count, facet, triangle: corners.map(|k| other[k]), weights })
        })
        .collect();
    let of_node = |beside: &Vec<usize>| {
        let ring = beside.iter().flat_map(|&k| own(&patches[k])).flat_map(|n| &at_node[&n]);
        let mut around: Vec<u32> = ring.map(|&k| patches[k].id).collect();
        around.sort_unstable();
        around.dedup();
        let across = beside.iter().filter_map(|&k| across[k]).collect();
        let mut avoided = Avoided { around, deep: f64::INFINITY, across };
        avoided.follow(controls.self_depth, &place);
        avoided
    };
    at_node.iter().map(|(&n, beside)| (n, of_node(beside))).collect()
}

/// Distance, facet, three of its corners and their weights.
type Hit = (f64, u32, [usize; 3], [f64; 3]);

/// Where the line from the middle of a facet straight inwards comes to the next facet; none beyond `longest`.
fn thickness(facets: &PatchSet, id: u32, longest: f64) -> Option<Hit> {
    let facet = facets.get(id)?;
    let (from, inwards) = (middle(facet), -facet.local(facet.center()).area_vector().normalize());
    let to = from + inwards * longest;
    let hits = |k: u32| {
        let other = &facets.pieces()[k as usize];
        let fan = (2..other.count as usize).map(|j| [0, j - 1, j]);
        fan.filter_map(move |corners| {
            let (distance, weights) = crossing(&from, &inwards, &corners.map(|k| other.nodes[k]))?;
            Some((distance, other.id(), corners, weights))
        })
    };
    let near = facets.within(&from.inf(&to), &from.sup(&to)).into_iter();
    near.filter(|&k| facets.pieces()[k as usize].id() != id).flat_map(hits).min_by(|a, b| a.0.total_cmp(&b.0))
}

fn longest_edge(facet: &Patch) -> f64 {
    let count = facet.count as usize;
    (0..count).map(|k| (facet.nodes[(k + 1) % count] - facet.nodes[k]).norm()).fold(0.0, f64::max)
}

fn middle(facet: &Patch) -> Vec3 {
    let count = facet.count as usize;
    facet.nodes[..count].iter().sum::<Vec3>() / count as f64
}

/// How far along a direction a line leaves the body through a triangle, or through its edges to rounding, and the weights of
/// its corners there.
fn crossing(from: &Vec3, along: &Vec3, [a, b, c]: &[Vec3; 3]) -> Option<(f64, [f64; 3])> {
    const EDGE: f64 = -1e-6;
    let normal = (b - a).cross(&(c - a));
    let rate = along.dot(&normal);
    if rate <= 1e-12 * normal.norm() {
        return None;
    }
    let distance = (a - from).dot(&normal) / rate;
    let x = from + along * distance;
    let share = |p: &Vec3, q: &Vec3| (q - p).cross(&(x - p)).dot(&normal) / normal.norm_squared();
    let weights = [share(b, c), share(c, a), share(a, b)];
    (distance > 0.0 && weights.iter().all(|w| *w > EDGE)).then_some((distance, weights))
}

/// Brings what rank 0 found of nodes to the ranks that ask for them, each by their global numbers. Collective.
pub fn deal(comm: &SimpleCommunicator, found: &BTreeMap<u64, Avoided>, wanted: Vec<u64>) -> BTreeMap<u64, Avoided> {
    let asked = exchange(comm, &Parcels::from([(0, wanted)]));
    let parcel = |numbers: Vec<u64>| -> Vec<f64> {
        let known = numbers.into_iter().filter_map(|n| Some((n, found.get(&n)?)));
        known.flat_map(|(n, avoided)| avoided.to_numbers(n)).collect()
    };
    let parcels: Parcels<f64> = asked.into_iter().map(|(rank, numbers)| (rank, parcel(numbers))).collect();
    let received = exchange(comm, &parcels).remove(&0).unwrap_or_default();
    let mut of_node = BTreeMap::new();
    let mut rest = &received[..];
    while let [node, deep, count, sides, ids @ ..] = rest {
        let (around, after) = ids.split_at(*count as usize);
        let (across, after) = after.split_at(Across::LEN * *sides as usize);
        let around = around.iter().map(|&id| id as u32).collect();
        let across = across.as_chunks().0.iter().map(Across::from_numbers).collect();
        of_node.insert(*node as u64, Avoided { around, deep: *deep, across });
        rest = after;
    }
    of_node
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facet, Mesh};
    use crate::surface::MovingPatch;
    use crate::surface::Smoothing;

    /// The sides of a sheet of thickness 2 and length 10, and a second sheet 1 above it: strips of facets of length 1.
    fn sheets() -> (Vec<MovingPatch>, Vec<Vec3>) {
        let lines = [(0.0, -1.0), (2.0, 1.0), (3.0, -1.0)];
        let mut mesh = Mesh::default();
        for (height, side) in lines {
            let first = mesh.points.len() as u32;
            for i in 0..=10 {
                let x = if side > 0.0 { 10 - i } else { i } as f64;
                mesh.points.extend([[x, height, 0.0], [x, height, 1.0]]);
            }
            for i in 0..10 {
                let n = first + 2 * i;
                mesh.facets.push(Facet { count: 4, nodes: [n, n + 2, n + 3, n + 1], id: 0 });
            }
        }
        mesh.point_ids = (0..mesh.points.len() as u64).collect();
        let numbers: Vec<u64> = mesh.point_ids.clone();
        let points = mesh.points.iter().map(|x| Vec3::from(*x)).collect();
        (MovingPatch::all(&mesh, &numbers, Smoothing::Facet, 40.0, &[], &Controls::default()).unwrap(), points)
    }

    #[test]
    fn thickness_goes_through_the_sheet_not_across_the_gap() {
        let (patches, points) = sheets();
        let avoided = avoided(&patches, &Controls::default(), |n| points[n as usize]);
        // The facets of the lower side look down, those of the upper side up.
        assert!(patches[0].straight(&[0, 2, 3, 1].map(|n| points[n])).normal([0.5, 0.5]).y < 0.0);
        for n in 0..44 {
            assert!((avoided[&n].deep - 1.0).abs() < 1e-12, "{n}: {}", avoided[&n].deep);
        }
        for n in 44..66 {
            assert_eq!(avoided[&n].deep, f64::INFINITY);
        }
    }

    #[test]
    fn thickness_follows_the_sheet() {
        let (patches, mut points) = sheets();
        let mut avoided = avoided(&patches, &Controls::default(), |n| points[n as usize]);
        // Stretched to double its length at half its thickness, and turned.
        let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -0.2, 0.5));
        points.iter_mut().for_each(|x| *x = turn * Vec3::new(2.0 * x.x, 0.5 * x.y, x.z));
        for (n, avoided) in &mut avoided {
            let packed: Vec<_> = avoided.across.iter().map(|a| Across::from_numbers(&a.to_numbers())).collect();
            assert_eq!(avoided.across, packed);
            avoided.follow(0.5, |n| points[n as usize]);
            let expected = if *n < 44 { 0.5 } else { f64::INFINITY };
            assert!(avoided.deep == expected || (avoided.deep - expected).abs() < 1e-12, "{n}: {}", avoided.deep);
        }
        // Sheared along itself it keeps its thickness.
        points.iter_mut().for_each(|x| *x += turn * Vec3::x() * (turn.inverse() * *x).y);
        let node = avoided.get_mut(&32).unwrap();
        node.follow(0.5, |n| points[n as usize]);
        assert!((node.deep - 0.5).abs() < 1e-12, "{}", node.deep);
        let mut given = node.clone().with_thickness(6.0, 0.5);
        given.follow(0.5, |n| points[n as usize]);
        assert_eq!(given.deep, 3.0);
    }

    #[test]
    fn a_node_meets_what_looks_at_it_and_is_neither_beside_it_nor_across_the_sheet() {
        let (patches, points) = sheets();
        let avoided = avoided(&patches, &Controls::default(), |n| points[n as usize]);
        let (up, down) = (Vec3::y(), -Vec3::y());
        // A node amid the upper side of the lower sheet; facets run from right to left there.
        let (node, x) = (&avoided[&32], points[32]);
        let look = Outlook { x: &x, outward: None, avoided: None, facing: -0.5 };
        assert_eq!(node.around, [13, 14, 15, 16]);
        assert!(node.allows(&look, &up, 24, &(x + up), &down), "the other sheet");
        assert!(node.allows(&look, &up, 24, &(x - up * 0.9), &down), "the other sheet, penetrated");
        assert!(!node.allows(&look, &up, 5, &(x - up * 2.0), &down), "the other side of its own sheet");
        assert!(!node.allows(&look, &up, 17, &x, &up), "what looks the same way");
        assert!(!node.allows(&look, &up, 14, &x, &down), "what is beside it");
        // A face beside it avoids what any of its corners does.
        let face = Avoided::of_all([30, 31, 32, 33].iter().map(|n| &avoided[n]));
        assert_eq!((face.around, face.deep), (vec![12, 13, 14, 15, 16], node.deep));
        let thick = node.clone().with_thickness(6.0, 0.5);
        assert!(thick.allows(&look, &up, 5, &(x - up * 2.0), &down));
    }
}
