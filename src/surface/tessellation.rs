//! Surfaces as flat cells, for display.

use super::analytic::{Cylinder, Plane, Sphere};
use super::normals::tangents;
use super::patch::Patch;
use crate::Vec3;

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
            let n = if patch.is_facet() { 1 } else { n.max(1) };
            if patch.count == 3 { cells.add_triangle(patch, n) } else { cells.add_quad(patch, n) }
        }
        cells
    }

    /// The rectangle of the plane onto which the box falls.
    pub fn of_plane(plane: &Plane, low: &Vec3, high: &Vec3) -> Self {
        let [a, b] = tangents(&plane.normal);
        let ([a0, a1], [b0, b1]) = (range(&plane.point, &a, low, high), range(&plane.point, &b, low, high));
        let corners = [[a0, b0], [a1, b0], [a1, b1], [a0, b1]];
        let points = corners.map(|[s, t]| (plane.point + a * s + b * t).into()).to_vec();
        Self { points, quads: vec![[0, 1, 2, 3]], ..Self::default() }
    }

    /// The cylinder in `segments` strips, along its axis as far as the box.
    pub fn of_cylinder(cylinder: &Cylinder, segments: usize, low: &Vec3, high: &Vec3) -> Self {
        let along = range(&cylinder.point, &cylinder.axis, low, high);
        let rings = along.map(|s| (cylinder.point + cylinder.axis * s, cylinder.radius));
        Self::of_rings(&rings, &cylinder.axis, segments, cylinder.hollow)
    }

    /// The sphere in `segments` around its axis z and half as many from pole to pole.
    pub fn of_sphere(sphere: &Sphere, segments: usize) -> Self {
        let count = segments.max(4) / 2;
        let ring = |k: usize| {
            let (sin, cos) = (std::f64::consts::PI * k as f64 / count as f64).sin_cos();
            (sphere.center - Vec3::z() * (sphere.radius * cos), sphere.radius * sin)
        };
        let rings: Vec<(Vec3, f64)> = (0..=count).map(ring).collect();
        Self::of_rings(&rings, &Vec3::z(), segments, sphere.hollow)
    }

    /// Rings (centre, radius) about an axis, joined one to the next.
    fn of_rings(rings: &[(Vec3, f64)], axis: &Vec3, segments: usize, hollow: bool) -> Self {
        let mut cells = Self::default();
        let ([a, b], m) = (tangents(axis), segments.max(3));
        for (center, radius) in rings {
            cells.points.extend((0..m).map(|k| {
                let (sin, cos) = (2.0 * std::f64::consts::PI * k as f64 / m as f64).sin_cos();
                <[f64; 3]>::from(center + (a * cos + b * sin) * *radius)
            }));
        }
        for ring in 0..rings.len().saturating_sub(1) {
            for k in 0..m {
                let [p, q] = [k, (k + 1) % m].map(|k| (ring * m + k) as u32);
                let above = m as u32;
                cells.quads.push(if hollow { [p, p + above, q + above, q] } else { [p, q, q + above, p + above] });
            }
        }
        cells
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

/// Least and greatest coordinate of the corners of a box along `direction` from `origin`.
fn range(origin: &Vec3, direction: &Vec3, low: &Vec3, high: &Vec3) -> [f64; 2] {
    let middle = ((low + high) * 0.5 - origin).dot(direction);
    let half = ((high - low) * 0.5).abs().dot(&direction.abs());
    [middle - half, middle + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::test_meshes::{wavy_quad, wavy_triangle};

    /// Sum of the area vectors, and of the volume that the cells sweep from the origin.
    fn sums(cells: &Tessellation) -> (Vec3, f64) {
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

    #[test]
    fn round_shapes_are_closed_and_turned_outwards() {
        let (low, high) = (Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 1.0, 2.0));
        for (hollow, sign) in [(false, 1.0), (true, -1.0)] {
            let sphere = Sphere { center: Vec3::new(0.1, 0.2, 0.3), radius: 2.0, hollow };
            let (area, volume) = sums(&Tessellation::of_sphere(&sphere, 64));
            assert!(
                area.norm() < 1e-12 && (sign * volume / (4.0 / 3.0 * std::f64::consts::PI * 8.0) - 1.0).abs() < 0.01
            );
            let cylinder = Cylinder { point: Vec3::zeros(), axis: Vec3::z(), radius: 2.0, hollow };
            let tube = Tessellation::of_cylinder(&cylinder, 64, &low, &high);
            let (area, volume) = sums(&tube);
            assert!(
                area.norm() < 1e-12
                    && (sign * volume / (2.0 / 3.0 * std::f64::consts::PI * 4.0 * 3.0) - 1.0).abs() < 0.01
            );
            assert!(tube.points.iter().all(|p| p[2] >= -1.0 - 1e-12 && p[2] <= 2.0 + 1e-12));
        }
        let plane = Plane { point: Vec3::new(5.0, 5.0, 0.5), normal: -Vec3::z() };
        let cells = Tessellation::of_plane(&plane, &low, &high);
        assert!((sums(&cells).0 + Vec3::z() * 4.0).norm() < 1e-12);
        assert!(cells.points.iter().all(|p| p[0].abs() <= 1.0 + 1e-12 && p[1].abs() <= 1.0 + 1e-12 && p[2] == 0.5));
    }
}
