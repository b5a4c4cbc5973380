//! One patch: a triangle or a quadrilateral with quadratic edges.
//!
//! Edge k runs from node k to the next one around, with the coefficient c_k of [`super::nagata`]. On the square
//! `[0,1]^2`, nodes 0 to 3 at (0,0), (1,0), (1,1), (0,1), a quadrilateral is
//!
//! ```text
//!     P = sum w_i x_i - [ c_0 e(1-e)(1-z) + c_2 e(1-e) z + c_3 z(1-z)(1-e) + c_1 z(1-z) e + m e(1-e) z(1-z) ]
//! ```
//!
//! with w bilinear and m = 0 unless it is biquadratic, and on 0 <= z <= e <= 1, nodes 0 to 2 at (0,0), (1,0), (1,1), a triangle is
//!
//! ```text
//!     P = sum b_i x_i - [ c_0 b_0 b_1 + c_1 b_1 b_2 + c_2 b_2 b_0 ],   b = (1-e, e-z, z)
//! ```
//!
//! Both interpolate the edge curves, so patches that share two nodes and their normals meet without a gap. With c = 0 and m = 0
//! they are the flat or bilinear facet.

use super::numbers::{flags, from_flags};
use super::parametric::{Closest, Local, Parametric};
use super::piece::{EXTENSION, Edge, Piece, Polygon};
use super::projection::Extent;
use crate::Vec3;

/// A triangle, or a quadrilateral when `count` is 4. Its normal points out of the tool, nodes counter-clockwise around
/// it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The same on all ranks.
    pub id: u32,
    /// 3 or 4.
    pub count: u8,
    /// The first `count` hold.
    pub nodes: [Vec3; 4],
    /// Coefficients of the edges; zero for a facet.
    pub coefficients: [Vec3; 4],
    /// The coefficient m of its inside; zero unless it is biquadratic.
    pub middle: Vec3,
    pub edges: [Edge; 4],
    /// Nodes where the surface ends, though perhaps in an edge of another patch.
    pub on_boundary: [bool; 4],
    /// How far the smooth surface that its nodes stand for is from it, at most: see [`super::from_mesh`].
    pub deviation: f64,
}

impl Patch {
    /// Length of [`Self::to_array`].
    pub const LEN: usize = 31;

    /// The patch at parameters `xi`, which may lie outside the domain.
    pub fn local(&self, [e, z]: [f64; 2]) -> Local {
        let [x0, x1, x2, x3] = &self.nodes;
        let [c0, c1, c2, c3] = &self.coefficients;
        if self.count == 3 {
            let [b0, b1, b2] = [1.0 - e, e - z, z];
            // Derivatives by the barycentric coordinates as if they were independent.
            let d0 = x0 - c0 * b1 - c2 * b2;
            let d1 = x1 - c0 * b0 - c1 * b2;
            let d2 = x2 - c1 * b1 - c2 * b0;
            return Local {
                point: x0 * b0 + x1 * b1 + x2 * b2 - c0 * (b0 * b1) - c1 * (b1 * b2) - c2 * (b2 * b0),
                tangents: [d1 - d0, d2 - d1],
                second: [c0 * 2.0, c2 - c0 - c1, c1 * 2.0],
            };
        }
        let (f, y) = (1.0 - e, 1.0 - z);
        let (be, bz) = (e * f, z * y);
        let (de, dz) = (1.0 - 2.0 * e, 1.0 - 2.0 * z);
        let along_e = c0 * y + c2 * z;
        let along_z = c3 * f + c1 * e;
        let (slope_e, slope_z) = (c2 - c0, c1 - c3);
        let m = &self.middle;
        Local {
            point: (x0 * f + x1 * e) * y + (x3 * f + x2 * e) * z - along_e * be - along_z * bz - m * (be * bz),
            tangents: [
                (x1 - x0) * y + (x2 - x3) * z - along_e * de - slope_z * bz - m * (de * bz),
                (x3 - x0) * f + (x2 - x1) * e - along_z * dz - slope_e * be - m * (be * dz),
            ],
            second: [
                (along_e + m * bz) * 2.0,
                x0 - x1 + x2 - x3 - slope_e * de - slope_z * dz - m * (de * dz),
                (along_z + m * be) * 2.0,
            ],
        }
    }

    /// The point at `xi`.
    pub fn point(&self, xi: [f64; 2]) -> Vec3 {
        self.local(xi).point
    }

    /// The outward unit normal at `xi`.
    pub fn normal(&self, xi: [f64; 2]) -> Vec3 {
        self.local(xi).area_vector().normalize()
    }

    /// True when all edges are straight.
    pub fn is_facet(&self) -> bool {
        self.coefficients[..self.count as usize].iter().chain([&self.middle]).all(|c| *c == Vec3::zeros())
    }

    /// How far it is from the facet of its nodes, at most: an edge is c/4 from its chord, and the inside as much again, and m/16.
    pub fn bulge(&self) -> f64 {
        self.coefficients.iter().map(|c| 0.5 * c.norm()).fold(0.0, f64::max) + self.middle.norm() / 16.0
    }

    /// How far from it, at `xi`, the arcs are that its curved edges stand for: with u from -1 to 1 along an edge of length L that turns
    /// by b, Nagata's from normals or quadratic in its own nodes,
    ///
    /// ```text
    /// L b³ (1 - u²)² / 128,     L b³ u²(1 - u²) / 128
    /// ```
    ///
    /// but for higher orders. Those of both directions make a sum as of [`Self::deviation`]. A quadratic quadrilateral is a quarter of
    /// a face, whose corner is its first. A facet does not tell.
    pub fn off_arc(&self, [e, z]: [f64; 2], is_quadratic: bool) -> f64 {
        let count = self.count as usize;
        let is_quarter = is_quadratic && count == 4;
        let of_edge = |k: usize| {
            let length = (self.nodes[(k + 1) % count] - self.nodes[k]).norm();
            let turn = if length > 0.0 { 2.0 * self.coefficients[k].norm() / length } else { 0.0 };
            // That of a whole face is twice as long and turns twice as far.
            (if is_quarter { 16.0 } else { 1.0 }) * length * turn.powi(3) / 128.0
        };
        // By 1 - u².
        let profile = |inside: f64| {
            let inside = inside.clamp(0.0, 1.0);
            inside * if is_quadratic { 1.0 - inside } else { inside }
        };
        if count == 3 {
            let b = [1.0 - e, e - z, z];
            let sides = [0, 1, 2].map(|k| of_edge(k) * profile(4.0 * b[k] * b[(k + 1) % 3]));
            return 4.0 / 3.0 * sides.into_iter().fold(0.0, f64::max);
        }
        let [along, across] = [(e, [0, 2]), (z, [1, 3])].map(|(xi, edges)| {
            let inside = if is_quarter { 1.0 - (1.0 - xi).powi(2) } else { 4.0 * xi * (1.0 - xi) };
            edges.map(of_edge).into_iter().fold(0.0, f64::max) * profile(inside)
        });
        (along.sqrt() + across.sqrt()).powi(2)
    }

    /// Lower and upper corner of a box that holds the patch and its extension beyond all edges.
    ///
    /// The straight part lies in the hull of its extended corners. In a quadrilateral |e(1-e)| <= 1/4 and the
    /// coefficients of opposite edges are interpolated with weights whose sizes add up to 1 + 2 ext at most; in a
    /// triangle |b_i b_j| <= ((1+ext)/2)^2.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let count = self.count as usize;
        let straight = Patch { coefficients: [Vec3::zeros(); 4], middle: Vec3::zeros(), ..*self };
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for corner in &self.corners(&[EXTENSION; 4])[..count] {
            let point = straight.point(*corner);
            low = low.inf(&point);
            high = high.sup(&point);
        }
        let [c0, c1, c2, c3] = self.coefficients.map(|c| c.abs());
        let bulge = if count == 3 {
            (c0 + c1 + c2) * (0.5 * (1.0 + 2.0 * EXTENSION)).powi(2)
        } else {
            let most = 0.25 * (1.0 + 2.0 * EXTENSION);
            (c0.sup(&c2) + c1.sup(&c3)) * most + self.middle.abs() * (most * most)
        };
        (low - bulge, high + bulge)
    }

    /// The patch as numbers, to be sent to another rank.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        for (k, v) in self.nodes.iter().chain(&self.coefficients).chain([&self.middle]).enumerate() {
            array[3 * k..3 * k + 3].copy_from_slice(v.as_slice());
        }
        array[27] = self.id as f64;
        array[28] = self.count as f64;
        array[29] = flags(&self.edges, &self.on_boundary);
        array[30] = self.deviation;
        array
    }

    /// The patch of [`Self::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let vector = |k: usize| Vec3::new(array[3 * k], array[3 * k + 1], array[3 * k + 2]);
        let (edges, on_boundary) = from_flags(array[29]);
        Self {
            id: array[27] as u32,
            count: array[28] as u8,
            nodes: std::array::from_fn(vector),
            coefficients: std::array::from_fn(|k| vector(4 + k)),
            middle: vector(8),
            edges,
            on_boundary,
            deviation: array[30],
        }
    }
}

impl Parametric for Patch {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        Self::local(self, xi)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        Self::bounds(self)
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let foot = self.core(&Extent::new(self), x, None, f64::INFINITY);
        Closest { xi: foot.xi, point: foot.local.point, distance: foot.distance }
    }
}

impl Polygon for Patch {
    fn count(&self) -> usize {
        self.count as usize
    }

    fn center(&self) -> [f64; 2] {
        if self.count == 3 { [2.0 / 3.0, 1.0 / 3.0] } else { [0.5, 0.5] }
    }

    fn sides(&self, [e, z]: [f64; 2]) -> [f64; 4] {
        if self.count == 3 { [z, 1.0 - e, e - z, f64::INFINITY] } else { [z, 1.0 - e, 1.0 - z, e] }
    }

    fn corners(&self, by: &[f64; 4]) -> [[f64; 2]; 4] {
        if self.count == 3 {
            let last = [1.0 + by[1], 1.0 + by[1] + by[2]];
            [[-by[0] - by[2], -by[0]], [1.0 + by[1], -by[0]], last, last]
        } else {
            [[-by[3], -by[0]], [1.0 + by[1], -by[0]], [1.0 + by[1], 1.0 + by[2]], [-by[3], 1.0 + by[2]]]
        }
    }

    fn clamp(&self, [e, z]: [f64; 2]) -> [f64; 2] {
        let e = e.clamp(0.0, 1.0);
        [e, z.clamp(0.0, if self.count == 3 { e } else { 1.0 })]
    }

    /// The minima themselves: where (C - x).C' = 0 for the edge C = x_k + (d - c) t + c t^2.
    fn along_edge(&self, edge: usize, x: &Vec3, look: &mut dyn FnMut(f64)) {
        let (from, to) = (self.nodes[edge], self.nodes[(edge + 1) % self.count as usize]);
        let (r, c) = (from - x, self.coefficients[edge]);
        let b = to - from - c;
        let slope = [r.dot(&b), b.norm_squared() + 2.0 * r.dot(&c), 3.0 * b.dot(&c), 2.0 * c.norm_squared()];
        let at = |t: f64| ((slope[3] * t + slope[2]) * t + slope[1]) * t + slope[0];
        // Between its own extrema the slope rises or falls.
        let [a, half, free] = [3.0 * slope[3], slope[2], slope[1]];
        let root = (half * half - a * free).max(0.0).sqrt();
        let turns = [-half - root, -half + root].map(|t| if a > 0.0 { (t / a).clamp(0.0, 1.0) } else { 1.0 });
        for [mut low, mut high] in [[0.0, turns[0]], turns, [turns[1], 1.0]] {
            if !(at(low) <= 0.0 && at(high) >= 0.0) {
                continue;
            }
            while high - low > 1e-9 {
                let middle = 0.5 * (low + high);
                *(if at(middle) < 0.0 { &mut low } else { &mut high }) = middle;
            }
            look(low);
        }
    }

    /// The straight part is between the nodes. In a quadrilateral e(1-e) and z(1-z) are 1/4 at most, times a mean of opposite
    /// edges each, and their product 1/16; in a triangle the b_i b_j sum to 1/3 at most.
    fn farthest_along(&self, direction: &Vec3) -> f64 {
        let count = self.count as usize;
        let highest = self.nodes[..count].iter().map(|x| x.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
        let [c0, c1, c2, c3] = self.coefficients.map(|c| f64::max(-c.dot(direction), 0.0));
        let inside = f64::max(-self.middle.dot(direction), 0.0) / 16.0;
        highest + inside + if count == 3 { c0.max(c1).max(c2) / 3.0 } else { (c0.max(c2) + c1.max(c3)) / 4.0 }
    }

    fn bend(&self, y: &Vec3) -> [f64; 4] {
        let [c0, c1, c2, c3] = self.coefficients.map(|c| c.dot(y));
        if self.count == 3 {
            return [2.0 * c0, c2 - c0 - c1, 0.0, 2.0 * c1];
        }
        let [x0, x1, x2, x3] = &self.nodes;
        let twist = (x0 - x1 + x2 - x3).dot(y);
        let m = self.middle.dot(y);
        let most = 0.5 * m.max(0.0);
        [2.0 * c0.max(c2) + most, twist, (c2 - c0).abs() + (c1 - c3).abs() + m.abs(), 2.0 * c1.max(c3) + most]
    }
}

impl Piece for Patch {
    fn id(&self) -> u32 {
        self.id
    }

    fn edges(&self) -> [Edge; 4] {
        self.edges
    }

    fn ends_at(&self, corner: usize) -> bool {
        self.on_boundary[corner]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::nagata::edge_coefficient;
    use crate::surface::test_meshes::{patch, sphere_quad, sphere_triangle, wavy_quad, wavy_triangle};

    #[test]
    fn edges_are_the_curves_and_tangents_are_orthogonal_to_the_nodal_normals() {
        for (patch, normals) in [wavy_quad(), wavy_triangle(), sphere_quad(), sphere_triangle()] {
            let count = patch.count as usize;
            let corners = patch.corners(&[0.0; 4]);
            for k in 0..count {
                let j = (k + 1) % count;
                let d = patch.nodes[j] - patch.nodes[k];
                let c = edge_coefficient(&d, &normals[k], &normals[j]);
                for t in [0.0, 0.3, 0.5, 1.0] {
                    let xi: [f64; 2] = std::array::from_fn(|a| corners[k][a] * (1.0 - t) + corners[j][a] * t);
                    let curve = patch.nodes[k] + (d - c) * t + c * (t * t);
                    assert!((patch.point(xi) - curve).norm() < 1e-15);
                }
                for tangent in patch.local(corners[k]).tangents {
                    assert!(tangent.dot(&normals[k]).abs() < 1e-14, "{}", tangent.dot(&normals[k]));
                }
                assert!((patch.normal(corners[k]) - normals[k]).norm() < 1e-14);
            }
        }
    }

    /// Equal normals, normals that lean together and apart, with quadrilaterals and triangles, and thin ones.
    #[test]
    fn patches_are_finite_for_all_normals_on_the_side_of_the_facet() {
        let leans = [-1.0, 0.0, 1.0];
        let normals: Vec<Vec3> = leans.iter().flat_map(|x| leans.map(|y| Vec3::new(*x, y, 0.5).normalize())).collect();
        for (count, width) in [(3, 1.0), (3, 1e-6), (4, 1.0), (4, 1e-6)] {
            let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y * width, 0.0));
            for choice in 0..9_usize.pow(count) {
                let chosen: Vec<Vec3> = (0..count).map(|k| normals[choice / 9_usize.pow(k) % 9]).collect();
                let patch = patch(&nodes[..count as usize], &chosen);
                for corner in patch.corners(&[0.0; 4]).iter().chain(&[patch.center(), [0.75, 0.25]]) {
                    let normal = patch.normal(*corner);
                    assert!((normal.norm() - 1.0).abs() < 1e-12, "{normal} {chosen:?}");
                    assert!(patch.local(*corner).second.iter().all(|s| s.norm() < 8.0));
                }
            }
        }
    }

    #[test]
    fn the_triangle_is_nagatas_polynomial() {
        let (p, _) = wavy_triangle();
        let [x0, x1, x2, _] = p.nodes;
        let [c1, c2, c3, _] = p.coefficients;
        for [e, z] in [[0.2, 0.1], [0.9, 0.4], [1.0, 1.0], [0.5, 0.5]] {
            let printed = x0
                + (x1 - x0 - c1) * e
                + (x2 - x1 + c1 - c3) * z
                + (c3 - c1 - c2) * (e * z)
                + c1 * (e * e)
                + c2 * (z * z);
            assert!((p.point([e, z]) - printed).norm() < 1e-15);
        }
    }

    #[test]
    fn derivatives_match_differences() {
        for (patch, _) in [wavy_quad(), wavy_triangle()] {
            let xi = [0.63, 0.27];
            let h = 1e-5;
            let here = patch.local(xi);
            for a in 0..2 {
                let step = |s: f64| std::array::from_fn(|b| xi[b] + if a == b { s * h } else { 0.0 });
                let (up, down) = (patch.local(step(1.0)), patch.local(step(-1.0)));
                assert!(((up.point - down.point) / (2.0 * h) - here.tangents[a]).norm() < 1e-9);
                for b in 0..2 {
                    let difference = (up.tangents[b] - down.tangents[b]) / (2.0 * h);
                    assert!((difference - here.second[a + b]).norm() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn bounds_hold_the_extended_patch() {
        for (patch, _) in [wavy_quad(), wavy_triangle(), sphere_quad(), sphere_triangle()] {
            let (low, high) = patch.bounds();
            let corners = patch.corners(&[EXTENSION; 4]);
            for i in 0..=20 {
                for j in 0..=20 {
                    let (s, t) = (i as f64 / 20.0, j as f64 / 20.0);
                    let xi = std::array::from_fn(|a| {
                        (corners[0][a] * (1.0 - s) + corners[1][a] * s) * (1.0 - t)
                            + (corners[3][a] * (1.0 - s) + corners[2][a] * s) * t
                    });
                    let point = patch.point(xi);
                    assert!(point >= low && point <= high);
                }
            }
            assert!((high - low).norm() < 3.0 * (patch.nodes[2] - patch.nodes[0]).norm());
        }
    }

    #[test]
    fn survives_the_trip_through_numbers() {
        let (mut patch, _) = wavy_quad();
        patch.id = u32::MAX;
        patch.edges = [Edge::Sharp, Edge::Boundary, Edge::Smooth, Edge::Sharp];
        patch.on_boundary = [true, false, false, true];
        assert_eq!(Patch::from_array(&patch.to_array()), patch);
        let (triangle, _) = wavy_triangle();
        assert_eq!(Patch::from_array(&triangle.to_array()), triangle);
    }
}
