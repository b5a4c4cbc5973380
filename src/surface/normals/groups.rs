//! Corners of facets that share a nodal normal, and their mean.

use super::super::facets::Facets;
use super::weight::Weight;
use crate::Vec3;

/// Corners grouped around their nodes by the edges that join them.
pub struct Groups {
    of: Vec<[u32; 4]>,
    pub count: usize,
    /// Whether a group ends at an edge that does not join, rather than closing around its node.
    pub open: Vec<bool>,
}

impl Groups {
    /// Groups the corners on both sides of each edge (facet, number) that `joins`.
    pub fn new(facets: &Facets, joins: impl Fn(usize, usize) -> bool) -> Self {
        let mut of = vec![[u32::MAX; 4]; facets.nodes.len()];
        let (mut open, mut stack) = (Vec::new(), Vec::new());
        for (f, k) in facets.corners() {
            if of[f][k] != u32::MAX {
                continue;
            }
            let group = open.len();
            open.push(false);
            stack.push((f, k));
            while let Some((f, k)) = stack.pop() {
                if of[f][k] != u32::MAX {
                    continue;
                }
                of[f][k] = group as u32;
                let last = (k + facets.count(f) - 1) % facets.count(f);
                // The node begins edge k and ends the one before; in the neighbours it is the other way round.
                for (edge, begins) in [(k, true), (last, false)] {
                    match facets.across[f][edge].filter(|_| joins(f, edge)) {
                        Some((g, j)) => stack.push((g, if begins { (j + 1) % facets.count(g) } else { j })),
                        None => open[group] = true,
                    }
                }
            }
        }
        Self { of, count: open.len(), open }
    }

    /// The group of a corner.
    pub fn of(&self, f: usize, k: usize) -> usize {
        self.of[f][k] as usize
    }

    /// The normal of each corner of each facet from those of the groups.
    pub fn spread(&self, facets: &Facets, normals: &[Vec3]) -> Vec<[Vec3; 4]> {
        let corner = |f: usize, k: usize| normals[self.of(f, k % facets.count(f))];
        (0..facets.nodes.len()).map(|f| std::array::from_fn(|k| corner(f, k))).collect()
    }

    /// Mean normal of each group over the corners that count; zero when none do.
    ///
    /// A closed group takes the normals of its corners, which makes the mean exact on a sphere; where a part is missing
    /// those of the facets are less one-sided.
    pub fn mean(&self, facets: &Facets, weight: Weight, counts: impl Fn((usize, usize)) -> bool) -> Vec<Vec3> {
        let mut part = self.open.clone();
        facets.corners().filter(|corner| !counts(*corner)).for_each(|(f, k)| part[self.of(f, k)] = true);
        let mut sums = vec![Vec3::zeros(); self.count];
        for (f, k) in facets.corners().filter(|corner| counts(*corner)) {
            let (normal, weight) = weight.at(facets, f, k);
            let group = self.of(f, k);
            sums[group] += weight * if part[group] { facets.normals[f] } else { normal };
        }
        sums.iter().map(|sum| sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()).collect()
    }
}
