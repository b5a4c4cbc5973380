//! A Bézier patch ready for projection: with bounds on its second derivatives, small enough for them to be tight, and
//! with a normal at its poles.
//!
//! Where an edge is one point, tau_1 = 0 along it and grows like d P,12 with the distance d from it, so that the normal
//! there is that of P,12 x tau_2, turned like tau_1 inside. On the way to the pole the digits of the curvature are lost
//! like 1/d^2; nearer than `POLE` it is taken from that distance.

use super::nurbs::{Bezier, Nurbs, Rectangle};
use super::parametric::{Closest, Local, Parametric};
use super::piece::Polygon;
use super::projection::{Foot, on_surface};
use crate::{Mat3, Vec3};
use nalgebra::Rotation3;

/// Samples of a cell along each parameter.
const SAMPLES: usize = 5;
/// Over their range: how much further than their samples second derivatives are taken to reach.
const MARGIN: f64 = 0.25;
/// Greatest angle, in radians, between the normals of a cell and that in its middle.
const CONE: f64 = 0.35;
/// Greatest change of P,ab over a cell, over |tau_a||tau_b|/size.
const CHANGE: f64 = 0.5;
/// As often a Bézier patch is halved to make it so.
const HALVINGS: usize = 10;
/// |tau_a| over its greatest value in the cell, below which the curvature is taken from a little further inside.
const POLE: f64 = 1e-3;

/// A Bézier patch, and how its second derivatives vary.
#[derive(Clone, Debug)]
pub struct Cell {
    pub bezier: Bezier,
    /// Mean of P,11, P,12, P,22 and the farthest that they are from it.
    mean: [Vec3; 3],
    spread: [f64; 3],
    /// Greatest |tau_a|^2.
    greatest: [f64; 2],
}

impl Cell {
    /// A cell of the whole of `bezier`.
    pub fn new(bezier: Bezier) -> Self {
        Self::with_samples(bezier).0
    }

    fn with_samples(bezier: Bezier) -> (Self, Vec<Local>) {
        let at = |k: usize| k as f64 / (SAMPLES - 1) as f64;
        let locals: Vec<Local> =
            (0..SAMPLES * SAMPLES).map(|k| bezier.local([at(k % SAMPLES), at(k / SAMPLES)])).collect();
        let mean: [Vec3; 3] =
            std::array::from_fn(|k| locals.iter().map(|l| l.second[k]).sum::<Vec3>() / locals.len() as f64);
        let spread = std::array::from_fn(|k| {
            let far = locals.iter().map(|l| (l.second[k] - mean[k]).norm()).fold(0.0, f64::max);
            far * (1.0 + MARGIN)
        });
        let greatest = std::array::from_fn(|a| locals.iter().map(|l| l.tangents[a].norm_squared()).fold(0.0, f64::max));
        (Self { bezier, mean, spread, greatest }, locals)
    }

    /// The cells of `surface`, with their parts of its domain: xi = 0 to 1 runs over u0 to u1 and v0 to v1.
    pub fn of_surface(surface: &Nurbs) -> Vec<(Rectangle, Self)> {
        let mut cells = Vec::new();
        let mut open: Vec<_> = surface.beziers().into_iter().rev().map(|(rect, bezier)| (rect, bezier, 0)).collect();
        while let Some((rect, bezier, halvings)) = open.pop() {
            let (cell, locals) = Self::with_samples(bezier);
            match cell.rough_direction(&locals).filter(|_| halvings < HALVINGS) {
                None => cells.push((rect, cell)),
                Some(direction) => {
                    let (parts, halves) = halve(&cell.bezier, rect, direction);
                    let pair = parts.into_iter().zip(halves).map(|(part, half)| (half, part, halvings + 1));
                    open.extend(pair.rev());
                }
            }
        }
        cells
    }

    /// The parameter along which to halve the cell: along which its normal turns most when it turns too far, the longer one
    /// when second derivatives change too much.
    fn rough_direction(&self, locals: &[Local]) -> Option<usize> {
        let at = |k: usize| k as f64 / (SAMPLES - 1) as f64;
        let normal = |k: usize| self.normal_of([at(k % SAMPLES), at(k / SAMPLES)], &locals[k]);
        let normals: Vec<Vec3> = (0..locals.len()).map(normal).collect();
        let turn = |a: usize, b: usize| super::facets::angle(&normals[a], &normals[b]);
        let widest = (0..normals.len()).map(|k| turn(k, normals.len() / 2)).fold(0.0, f64::max);
        let (low, high) = self.bezier.bounds();
        let size = 0.5 * (high - low).norm();
        // Near a pole the way around it always changes, however small the cell.
        let has_pole = |a: usize| locals.iter().any(|l| self.is_near_pole(l, POLE)[a]);
        let [a, b] = self.greatest;
        let change = |k: usize, metric: f64| self.spread[k] * size / (metric * CHANGE);
        let change_1 = if has_pole(0) { 0.0 } else { change(0, a) };
        let change_2 = if has_pole(1) { 0.0 } else { change(2, b) };
        let change_12 = if has_pole(0) || has_pole(1) { 0.0 } else { change(1, (a * b).sqrt()) };
        if widest > CONE {
            let along = |stride: usize, across: usize| -> f64 {
                let step = |row: usize, k: usize| turn(row * across + k * stride, row * across + (k - 1) * stride);
                (0..SAMPLES).map(|row| (1..SAMPLES).map(|k| step(row, k)).sum()).fold(0.0, f64::max)
            };
            return Some((along(SAMPLES, 1) > along(1, SAMPLES)) as usize);
        }
        (change_1.max(change_12).max(change_2) > 1.0).then(|| self.long_direction())
    }

    /// Greatest length of the tangents: about those of the cell along its parameters.
    pub fn lengths(&self) -> [f64; 2] {
        self.greatest.map(f64::sqrt)
    }

    /// The parameter along which the cell is longer.
    pub fn long_direction(&self) -> usize {
        (self.greatest[1] > self.greatest[0]) as usize
    }

    /// Whether tau_a is so short at a point that it has lost digits.
    fn is_near_pole(&self, local: &Local, within: f64) -> [bool; 2] {
        std::array::from_fn(|a| local.tangents[a].norm_squared() <= within * within * self.greatest[a])
    }

    fn normal_of(&self, xi: [f64; 2], local: &Local) -> Vec3 {
        let [t, u] = &local.tangents;
        let turned = |a: usize| local.second[1] * if xi[a] < 0.5 { 1.0 } else { -1.0 };
        let area = match self.is_near_pole(local, 1e-8) {
            [false, false] => t.cross(u),
            [true, false] => turned(1).cross(u),
            [false, true] => t.cross(&turned(0)),
            [true, true] => Vec3::zeros(),
        };
        area.try_normalize(0.0).unwrap_or_else(|| {
            let inside = self.bezier.local(xi.map(|x| x + 1e-3 * (0.5 - x)));
            inside.area_vector().try_normalize(0.0).unwrap_or_else(Vec3::z)
        })
    }

    /// Gap, normal and its gradient at a foot that is on no edge.
    pub fn on_surface(&self, x: &Vec3, foot: &Foot) -> (f64, Vec3, Mat3) {
        let vanishing = self.is_near_pole(&foot.local, POLE);
        if vanishing == [false; 2] {
            return on_surface(x, &foot.local);
        }
        let mut inside = foot.xi;
        for (a, vanishing) in vanishing.into_iter().enumerate() {
            if vanishing {
                inside[1 - a] = inside[1 - a].clamp(POLE, 1.0 - POLE);
            }
        }
        let mut normal = self.normal_of(foot.xi, &foot.local);
        let mut gap = (x - foot.local.point).dot(&normal);
        if foot.distance > 1e-6 * self.greatest[0].max(self.greatest[1]).sqrt() {
            gap = foot.distance.copysign(gap);
            normal = (x - foot.local.point) / gap;
        }
        let local = self.bezier.local(inside);
        let beside = local.area_vector().normalize();
        let (_, _, gradient) = on_surface(&(local.point + beside * gap), &local);
        // From the tangent plane there into the one here.
        let turn = Rotation3::rotation_between(&beside, &normal).unwrap_or_else(Rotation3::identity);
        (gap, normal, turn * gradient * turn.transpose())
    }
}

/// The halves of a patch of a surface, and their parts of its domain.
pub fn halve(bezier: &Bezier, rect: Rectangle, direction: usize) -> ([Bezier; 2], [Rectangle; 2]) {
    let middle = 0.5 * (rect[direction][0] + rect[direction][1]);
    let (mut low, mut high) = (rect, rect);
    low[direction][1] = middle;
    high[direction][0] = middle;
    (bezier.split(direction, 0.5), [low, high])
}

impl Parametric for Cell {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        self.bezier.local(xi)
    }

    fn normal(&self, xi: [f64; 2]) -> Vec3 {
        self.normal_of(xi, &self.bezier.local(xi))
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.bezier.bounds()
    }

    fn closest(&self, x: &Vec3) -> Closest {
        self.bezier.closest(x)
    }
}

impl Polygon for Cell {
    const SAMPLES: usize = SAMPLES;

    fn bend(&self, y: &Vec3) -> [f64; 4] {
        let size = y.norm();
        let [m11, m12, m22] = self.mean.map(|m| m.dot(y));
        [m11 + self.spread[0] * size, m12, self.spread[1] * size, m22 + self.spread[2] * size]
    }

    fn vanishing(&self) -> [f64; 2] {
        let [a, b] = self.greatest;
        [a, b].map(|own| 1e-16 * own.max(1e-8 * a.max(b)).max(1e-100))
    }

    /// In space, over the size of the cell. The way round a pole is as long as it is far from it, and Newton's method has
    /// the square of a step over that distance left.
    fn step_size(&self, local: &Local, step: [f64; 2]) -> f64 {
        let relative: [f64; 2] =
            std::array::from_fn(|a| (local.tangents[a].norm_squared() / self.greatest[a].max(1e-200)).sqrt());
        let size = f64::max(relative[0] * step[0].abs(), relative[1] * step[1].abs());
        if size > 1e-14 { size / relative[0].min(relative[1]).clamp(1e-4, 1.0).sqrt() } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::nurbs::Curve;
    use crate::surface::projection::{Extent, descend, starts};
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn sphere(radius: f64) -> Nurbs {
        let arc = Curve::arc(Vec3::zeros(), Vec3::x(), Vec3::z(), radius, [-FRAC_PI_2, FRAC_PI_2]).unwrap();
        Nurbs::revolution(&arc, Vec3::zeros(), Vec3::z(), [0.0, TAU]).unwrap().swapped()
    }

    #[test]
    fn cells_cover_the_surface_with_narrow_cones() {
        let surface = sphere(2.0);
        let cells = Cell::of_surface(&surface);
        assert!(cells.len() >= 24 && cells.len() <= 200, "{}", cells.len());
        let area: f64 = cells.iter().map(|(r, _)| (r[0][1] - r[0][0]) * (r[1][1] - r[1][0])).sum();
        let [[u0, u1], [v0, v1]] = surface.domain();
        assert!((area - (u1 - u0) * (v1 - v0)).abs() < 1e-12);
        for (rect, cell) in &cells {
            for xi in [[0.0, 0.0], [0.3, 0.8], [1.0, 0.5], [0.5, 1.0], [1.0, 1.0]] {
                let uv = std::array::from_fn(|a| rect[a][0] + (rect[a][1] - rect[a][0]) * xi[a]);
                assert!((cell.local(xi).point - surface.local(uv).point).norm() < 1e-14);
                assert!((cell.normal(xi) - cell.local(xi).point / 2.0).norm() < 1e-13, "{xi:?}");
            }
        }
    }

    #[test]
    fn certified_cells_have_one_minimum() {
        let (mut certain, mut all) = (0, 0);
        for (_, cell) in Cell::of_surface(&sphere(1.0)) {
            let extent = Extent::new(&cell);
            for k in 0..60 {
                let k = k as f64;
                let near = cell.local([0.5 + 0.5 * (1.3 * k).sin(), 0.5 + 0.5 * (2.1 * k).cos()]).point;
                let far = Vec3::new((1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin()) * 2.0;
                for (x, is_near) in [(near * (0.7 + 0.01 * k), true), (far, false)] {
                    let feet = starts(&cell).map(|start| descend(&cell, &x, &[0.0; 4], start).distance);
                    let certified = extent.has_one_minimum(&cell, &x);
                    (certain, all) = (certain + (certified && is_near) as usize, all + is_near as usize);
                    assert!(!certified || feet.iter().all(|d| (d - feet[0]).abs() < 1e-12), "{x} {feet:?}");
                }
            }
        }
        assert!(certain * 2 > all, "{certain} of {all}");
    }
}
