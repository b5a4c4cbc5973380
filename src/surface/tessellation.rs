//! Surfaces as flat cells, for display.

use super::faces::FacePiece;
use super::parametric::Parametric;
use super::patch::Patch;

/// As often a side of a cell is halved to find where a face ends on it.
const HALVINGS: usize = 30;

/// Part of the way to the middle of its cell at which a point is asked whether it belongs to a face.
const INWARD: f64 = 1e-6;

/// Points, and cells that index them, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub quads: Vec<[u32; 4]>,
}

impl Tessellation {
    /// Each curved patch in `n` by `n` cells, each facet as it is. Patches share no points.
    pub fn of_patches(patches: &[Patch], n: usize) -> Self {
        let mut cells = Self::default();
        for patch in patches {
            cells.add_patch(patch, if patch.is_facet() { 1 } else { n.max(1) });
        }
        cells
    }

    /// A patch in `n` by `n` cells, flat or not.
    pub fn add_patch(&mut self, patch: &Patch, n: usize) {
        if patch.count == 3 { self.add_triangle(patch, n) } else { self.add_quad(patch, n) }
    }

    /// How many points a patch of so many corners has in `n` by `n` cells.
    pub fn points_of(corners: u8, n: usize) -> usize {
        if corners == 3 { (n + 1) * (n + 2) / 2 } else { (n + 1) * (n + 1) }
    }

    /// A surface between the values of its parameters, in rising order.
    pub fn of_grid(surface: &dyn Parametric, [u, v]: &[Vec<f64>; 2]) -> Self {
        let mut cells = Self::default();
        for v in v {
            cells.points.extend(u.iter().map(|u| <[f64; 3]>::from(surface.point([*u, *v]))));
        }
        let row = u.len() as u32;
        for j in 1..v.len() as u32 {
            cells.quads.extend((1..row).map(|i| (j - 1) * row + i - 1).map(|p| [p, p + 1, p + row + 1, p + row]));
        }
        cells
    }

    /// The pieces of the faces of a CAD model, each cut into `n` by `n` cells and to its loops.
    pub fn of_faces(pieces: &[FacePiece], n: usize) -> Self {
        let mut cells = Self::default();
        let at = |k: usize| k as f64 / n.max(1) as f64;
        for piece in pieces {
            for (i, j) in (0..n.max(1)).flat_map(|j| (0..n.max(1)).map(move |i| (i, j))) {
                let corners = [[at(i), at(j)], [at(i + 1), at(j)], [at(i + 1), at(j + 1)], [at(i), at(j + 1)]];
                let middle = [at(i) + 0.5 * at(1), at(j) + 0.5 * at(1)];
                // Just inside the cell: loops often run along the border of the domain.
                let inward = |xi: [f64; 2]| std::array::from_fn(|a| xi[a] + INWARD * (middle[a] - xi[a]));
                cells.add_polygon(piece, &cut(corners, |xi| piece.holds(inward(xi))));
            }
        }
        cells
    }

    /// A convex polygon of parameters.
    fn add_polygon(&mut self, surface: &impl Parametric, corners: &[[f64; 2]]) {
        let first = self.points.len() as u32;
        self.points.extend(corners.iter().map(|xi| <[f64; 3]>::from(surface.point(*xi))));
        match corners.len() as u32 {
            4 => self.quads.push([first, first + 1, first + 2, first + 3]),
            count => self.triangles.extend((2..count).map(|k| [first, first + k - 1, first + k])),
        }
    }

    fn add_quad(&mut self, patch: &Patch, n: usize) {
        let (first, row) = (self.points.len() as u32, n as u32 + 1);
        for j in 0..=n {
            self.points
                .extend((0..=n).map(|i| <[f64; 3]>::from(patch.point([i as f64 / n as f64, j as f64 / n as f64]))));
        }
        for j in 0..n as u32 {
            self.quads.extend((0..n as u32).map(|i| first + j * row + i).map(|p| [p, p + 1, p + row + 1, p + row]));
        }
    }

    /// Point (i, j) with j <= i stands at i(i+1)/2 + j.
    fn add_triangle(&mut self, patch: &Patch, n: usize) {
        let first = self.points.len() as u32;
        for i in 0..=n {
            self.points
                .extend((0..=i).map(|j| <[f64; 3]>::from(patch.point([i as f64 / n as f64, j as f64 / n as f64]))));
        }
        let at = |i: u32, j: u32| first + i * (i + 1) / 2 + j;
        for i in 0..n as u32 {
            self.triangles.extend((0..=i).map(|j| [at(i, j), at(i + 1, j), at(i + 1, j + 1)]));
            self.triangles.extend((0..i).map(|j| [at(i, j), at(i + 1, j + 1), at(i, j + 1)]));
        }
    }
}

/// The part of a quadrilateral of parameters that `holds`, bounded by straight lines between the ends of its sides.
fn cut(corners: [[f64; 2]; 4], holds: impl Fn([f64; 2]) -> bool) -> Vec<[f64; 2]> {
    let inside = corners.map(&holds);
    let mut part = Vec::new();
    for k in 0..4 {
        let next = (k + 1) % 4;
        if inside[k] {
            part.push(corners[k]);
        }
        if inside[k] != inside[next] {
            let on = |t: f64| std::array::from_fn(|a| corners[k][a] + t * (corners[next][a] - corners[k][a]));
            let (mut from, mut to) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (from + to);
                if holds(on(middle)) == inside[k] { from = middle } else { to = middle }
            }
            part.push(on(0.5 * (from + to)));
        }
    }
    part
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::surface::test_meshes::{wavy_quad, wavy_triangle};
    use crate::surface::{Curve, Face, FaceSet, Nurbs, sew};
    use crate::{Vec2, Vec3};
    use std::f64::consts::{PI, TAU};

    /// Sum of the area vectors, and of the volume that the cells sweep from the origin.
    pub fn sums(cells: &Tessellation) -> (Vec3, f64) {
        let quads = cells.quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        let mut area = Vec3::zeros();
        let mut volume = 0.0;
        for t in cells.triangles.iter().copied().chain(quads) {
            let [a, b, c] = t.map(|k| Vec3::from(cells.points[k as usize]));
            area += (b - a).cross(&(c - a)) * 0.5;
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        (area, volume)
    }

    /// A square with a round hole that lies across several cells, and with one that touches none of their corners.
    #[test]
    fn faces_end_at_their_loops() {
        let plane = Nurbs::plane(Vec3::zeros(), Vec3::x() * 2.0, Vec3::y() * 2.0);
        let [[from, to], _] = plane.domain();
        let center = Vec2::repeat(0.5 * (from + to));
        for (radius, n, error) in [(0.3, 8, 0.04), (0.3, 64, 6e-4), (0.02, 5, 0.01)] {
            let circle = Curve::arc(center, Vec2::x(), Vec2::y(), radius * (to - from), [0.0, TAU]).unwrap();
            let border = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|p| Vec2::from(p) * (to - from));
            let border = (0..4).map(|k| Curve::line(border[k], border[(k + 1) % 4])).collect();
            let face =
                Face { surface: plane.clone(), loops: vec![border, vec![circle]], reversed: false, name: "".into() };
            let faces = sew(&[face], 0.7, 1e-6, false).unwrap();
            let cells = Tessellation::of_faces(FaceSet::new(&faces).pieces(), n);
            let exact = 4.0 - PI * (2.0 * radius).powi(2);
            let (area, _) = sums(&cells);
            assert!((area.z - exact).abs() < error, "{radius} {n}: {} {exact}", area.z);
        }
    }

    #[test]
    fn patches_keep_their_border_and_orientation() {
        for (patch, _) in [wavy_quad(), wavy_triangle()] {
            let facet = Patch { coefficients: [Vec3::zeros(); 4], ..patch };
            let (one, fine) = (Tessellation::of_patches(&[facet], 8), Tessellation::of_patches(&[patch, patch], 8));
            assert_eq!(one.quads.len() + one.triangles.len(), 1);
            assert_eq!(fine.quads.len() + fine.triangles.len(), 128);
            assert!(sums(&one).0.z > 0.3 && (sums(&fine).0 / 2.0 - sums(&one).0).norm() < 0.2);
        }
    }
}
