//! How large a described surface is, and how smooth.

use super::described::Described;
use super::sampling::Grid;
use crate::Vec3;
use crate::surface::Edge;
use crate::surface::facets::angle;

/// A piece, or all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Size {
    pub triangles: usize,
    pub quadrilaterals: usize,
    pub area: f64,
    /// Sides that are smooth and sharp edges, each of which two pieces have, and boundaries.
    sides: [usize; 3],
    /// Largest angle between the normals on both sides of a smooth and of a sharp edge, degrees.
    pub jumps: [f64; 2],
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Size {
    /// Length of [`Self::to_array`].
    pub const LEN: usize = 14;

    /// The size of nothing.
    pub fn none() -> Self {
        Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], ..Self::default() }
    }

    /// The size of a piece, sampled on a grid; `edges` if its edges matter.
    pub fn of(surface: &dyn Described, piece: usize, grid: &Grid, edges: bool) -> Self {
        let mut size = Self::none();
        match surface.is_triangle(piece) {
            true => size.triangles = 1,
            false => size.quadrilaterals = 1,
        }
        for (st, weight) in grid.points().zip(grid.integration_weights()) {
            let place = surface.at(piece, st);
            size.area += place.area * weight;
            if !place.held {
                continue;
            }
            for (k, x) in place.point.iter().enumerate() {
                size.low[k] = size.low[k].min(*x);
                size.high[k] = size.high[k].max(*x);
            }
        }
        for (side, edge) in surface.edges(piece).iter().enumerate().filter(|_| edges) {
            let kind = match edge {
                Edge::Smooth => 0,
                Edge::Sharp => 1,
                Edge::Boundary => 2,
            };
            size.sides[kind] += 1;
            if kind < 2 {
                size.jumps[kind] = size.jumps[kind].max(jump(surface, piece, side, grid, size.diagonal()));
            }
        }
        size
    }

    /// The size of both together.
    pub fn join(&self, other: &Self) -> Self {
        Self {
            triangles: self.triangles + other.triangles,
            quadrilaterals: self.quadrilaterals + other.quadrilaterals,
            area: self.area + other.area,
            sides: std::array::from_fn(|k| self.sides[k] + other.sides[k]),
            jumps: std::array::from_fn(|k| self.jumps[k].max(other.jumps[k])),
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Number of smooth, sharp and boundary edges.
    pub fn edges(&self) -> [usize; 3] {
        let [smooth, sharp, boundary] = self.sides;
        [smooth.div_ceil(2), sharp.div_ceil(2), boundary]
    }

    /// Diagonal of the box around the surface.
    pub fn diagonal(&self) -> f64 {
        (Vec3::from(self.high) - Vec3::from(self.low)).norm()
    }

    /// The size as numbers, to be sent to other ranks.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        let counts = [self.triangles, self.quadrilaterals, self.sides[0], self.sides[1], self.sides[2]];
        array[..5].copy_from_slice(&counts.map(|count| count as f64));
        array[5] = self.area;
        array[6..8].copy_from_slice(&self.jumps);
        array[8..11].copy_from_slice(&self.low);
        array[11..].copy_from_slice(&self.high);
        array
    }

    /// The size of [`Self::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let count = |k: usize| array[k] as usize;
        Self {
            triangles: count(0),
            quadrilaterals: count(1),
            area: array[5],
            sides: [count(2), count(3), count(4)],
            jumps: [array[6], array[7]],
            low: std::array::from_fn(|k| array[8 + k]),
            high: std::array::from_fn(|k| array[11 + k]),
        }
    }
}

/// Largest angle between the normal of a piece and those of its neighbours along a side, at the samples but the ends, where
/// further pieces meet; degrees.
fn jump(surface: &dyn Described, piece: usize, side: usize, grid: &Grid, diagonal: f64) -> f64 {
    const TOUCH: f64 = 1e-6;
    let corners = surface.corners(piece);
    let (from, to) = (corners[side], corners[(side + 1) % surface.sides(piece)]);
    let mut largest = 0.0;
    for k in 1..grid.side().max(3) - 1 {
        let s = k as f64 / (grid.side().max(3) - 1) as f64;
        let xi = [from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1])];
        let normal = surface.normal(piece, xi);
        for (other, xi) in surface.touching(&surface.local(piece, xi).point, TOUCH * diagonal) {
            if other != piece {
                largest = f64::max(largest, angle(&normal, &surface.normal(other, xi)));
            }
        }
    }
    largest.to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::PatchSet;
    use crate::surface::test_meshes::sphere_patches;

    fn size(n: usize, triangles: bool, faces: usize, smoothing: Smoothing) -> Size {
        let set = PatchSet::new(sphere_patches(n, triangles, faces, smoothing));
        let each = |k: usize| Size::of(&set, k, &Grid::new(13), true);
        let all = (0..set.patches().len()).fold(Size::none(), |all, k| all.join(&each(k)));
        assert_eq!(Size::from_array(&all.to_array()), all);
        all
    }

    #[test]
    fn closed_and_open_spheres_have_the_edges_of_euler() {
        for (faces, smoothing) in [(6, Smoothing::Nagata), (5, Smoothing::Facet)] {
            let quads = size(3, false, faces, smoothing);
            let triangles = size(3, true, faces, smoothing);
            assert_eq!((quads.quadrilaterals, quads.triangles), (9 * faces, 0));
            assert_eq!((triangles.quadrilaterals, triangles.triangles), (0, 18 * faces));
            for size in [quads, triangles] {
                let [smooth, sharp, boundary] = size.edges();
                let nodes = if faces == 6 { 56 } else { 52 };
                let euler = if faces == 6 { 2 } else { 1 };
                let pieces = size.triangles + size.quadrilaterals;
                assert_eq!((nodes + pieces) - (smooth + sharp + boundary), euler);
                assert_eq!(boundary, if faces == 6 { 0 } else { 12 });
                assert!(smoothing == Smoothing::Facet || sharp == 0);
            }
        }
    }

    #[test]
    fn jumps_are_those_between_the_normals_of_neighbours() {
        // Neighbouring facets of four of the face's sixteen squares turn by 90/4 degrees about.
        let facets = size(4, false, 1, Smoothing::Facet);
        assert!(facets.jumps[0] == 0.0 && (18.0..26.0).contains(&facets.jumps[1]), "{:?}", facets.jumps);
        let patches = size(4, false, 1, Smoothing::Nagata);
        assert!(patches.jumps[1] == 0.0 && (patches.jumps[0] - 1.1295).abs() < 1e-3, "{:?}", patches.jumps);
        assert!((patches.area / (4.0 * std::f64::consts::PI / 6.0) - 1.0).abs() < 1e-3, "{}", patches.area);
    }
}
