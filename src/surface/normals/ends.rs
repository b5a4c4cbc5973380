//! Normals where the surface ends, extrapolated from its inside.

use super::super::facets::Facets;
use super::groups::Groups;
use super::tangents;
use crate::Vec3;
use crate::controls::Controls;
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::PI;

/// Conditions along directions closer together than this, as a ratio of eigenvalues, count as one.
const CUT: f64 = 1e-3;

/// What the normal of a fan at an end of the surface was extrapolated from.
pub struct End {
    /// The neighbours inside the surface, each once.
    pub neighbours: Vec<Neighbour>,
    /// In how many directions, 1 or 2, they have conditions (*).
    pub directions: usize,
}

/// A neighbour with a condition (*).
#[derive(Clone, Copy)]
pub struct Neighbour {
    pub node: usize,
    pub fan: usize,
    /// Of its condition in two combinations of all, a right-handed pair of principal directions; per edge length.
    pub weights: [f64; 2],
}

/// Moves the normals of fans at the ends of the surface as (*) asks, and says which and by what.
pub fn extrapolate_ends(
    facets: &Facets,
    fans: &Groups,
    counts: &[[bool; 4]],
    normals: &mut [Vec3],
    largest: f64,
    controls: &Controls,
) -> Vec<Option<End>> {
    let (mean, mut ranks) = (normals.to_vec(), end_ranks(facets, fans, controls));
    let mut ends: Vec<Option<End>> = (0..fans.count).map(|_| None).collect();
    // Fans along an end with neighbours in two directions first: then they are neighbours for the others.
    for (rank, all) in [(1, false), (1, true), (2, true)] {
        let mut conditions = vec![Conditions::default(); fans.count];
        let mut edges: Vec<Vec<(usize, usize, Vec3)>> = vec![Vec::new(); fans.count];
        for (f, k) in facets.corners().filter(|(f, k)| counts[*f][*k] && ranks[fans.of(*f, *k)] == rank) {
            for other in facets.beside(f, k) {
                let (here, there) = (fans.of(f, k), fans.of(f, other));
                if ranks[there] < rank {
                    let edge = facets.point(f, other) - facets.point(f, k);
                    conditions[here].add(&mean[here], &normals[there], &edge.normalize());
                    edges[here].push((facets.node(f, other), there, edge));
                }
            }
        }
        for fan in 0..fans.count {
            if conditions[fan].directions() > if all { 0 } else { 1 } {
                ranks[fan] = if all { rank } else { 0 };
                if let Some(normal) = conditions[fan].solve(&mean[fan], largest) {
                    normals[fan] = normal;
                    ends[fan] = Some(conditions[fan].end(&mean[fan], &edges[fan]));
                }
            }
        }
    }
    ends
}

/// 0 for fans that need no extrapolation, 1 along the ends of the surface, 2 at their corners.
fn end_ranks(facets: &Facets, fans: &Groups, controls: &Controls) -> Vec<u8> {
    let [corner, around] = [controls.end_corner, controls.end_around].map(|degrees| degrees * PI / 180.0);
    let mut angles = vec![0.0; fans.count];
    facets.corners().for_each(|(f, k)| angles[fans.of(f, k)] += facets.corner(f, k).1);
    let rank = |fan: usize| match angles[fan] {
        angle if !fans.open[fan] || angle > around => 0,
        angle if angle > corner => 1,
        _ => 2,
    };
    (0..fans.count).map(rank).collect()
}

/// Conditions (*) on a unit normal n = p + sqrt(1-p^2) m as normal equations for p, its part in the plane orthogonal to
/// the mean normal m of the facets.
#[derive(Clone, Copy, Default)]
struct Conditions {
    matrix: Matrix2<f64>,
    /// Sums over the edges d: of -d (n_u.d), and of d (m.d).
    values: Vector2<f64>,
    lean: Vector2<f64>,
    /// Sum and number of the neighbours' normals n_u.
    neighbours: Vec3,
    count: f64,
}

impl Conditions {
    fn add(&mut self, mean: &Vec3, neighbour: &Vec3, d: &Vec3) {
        let [a, b] = tangents(mean);
        let along = Vector2::new(a.dot(d), b.dot(d));
        self.matrix += along * along.transpose();
        self.values -= along * neighbour.dot(d);
        self.lean += along * mean.dot(d);
        self.neighbours += neighbour;
        self.count += 1.0;
    }

    /// In how many directions of the plane there are conditions.
    fn directions(&self) -> usize {
        let eigenvalues = self.matrix.symmetric_eigenvalues();
        eigenvalues.iter().filter(|value| **value > CUT * eigenvalues.max()).count()
    }

    /// The normal that meets the conditions and is closest to the linear extrapolation from the neighbours through the
    /// mean, 2m - n_u; `None` when that would be further from the mean than `largest`.
    fn solve(&self, mean: &Vec3, largest: f64) -> Option<Vec3> {
        let eigen = self.matrix.symmetric_eigen();
        let cut = CUT * eigen.eigenvalues.max();
        let inverse = |right: Vector2<f64>| -> Vector2<f64> {
            let parts = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
            parts.filter(|(value, _)| **value > cut).map(|(value, v)| v * (v.dot(&right) / value)).sum()
        };
        let [a, b] = tangents(mean);
        let guess = -Vector2::new(a.dot(&self.neighbours), b.dot(&self.neighbours)) / self.count;
        let mut p = guess;
        for _ in 0..5 {
            let height = (1.0 - p.norm_squared()).max(0.0).sqrt();
            p = guess + inverse(self.values - self.lean * height - self.matrix * guess);
        }
        if p.norm() > largest.min(0.5).sin() {
            return None;
        }
        Some(a * p.x + b * p.y + mean * (1.0 - p.norm_squared()).sqrt())
    }

    /// The conditions of `edges` (node, fan, vector) combined along the principal directions of all.
    fn end(&self, mean: &Vec3, edges: &[(usize, usize, Vec3)]) -> End {
        let eigen = self.matrix.symmetric_eigen();
        let first = eigen.eigenvectors.column(if eigen.eigenvalues[0] > eigen.eigenvalues[1] { 0 } else { 1 });
        let [a, b] = tangents(mean);
        let principal = [a * first.x + b * first.y, b * first.x - a * first.y];
        let mut neighbours: Vec<Neighbour> = Vec::new();
        for (node, fan, edge) in edges {
            let weights = principal.map(|v| v.dot(edge) / edge.norm_squared());
            match neighbours.iter_mut().find(|u| u.node == *node && u.fan == *fan) {
                Some(u) => u.weights = std::array::from_fn(|s| u.weights[s] + weights[s]),
                None => neighbours.push(Neighbour { node: *node, fan: *fan, weights }),
            }
        }
        End { neighbours, directions: self.directions() }
    }
}
