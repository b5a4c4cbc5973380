//! Surfaces of revolution by their half plane (r, h): x = o + r e_r + h a.
//!
//! The closest point of the surface lies in the half plane of x. If the curve has there the unit normal (n_r, n_h) with
//! gradient G, the surface has
//!
//! ```text
//!     n = n_r e_r + n_h a,     dn/dx = [e_r a] G [e_r a]^T + (n_r/r) e_t e_t^T
//! ```
//!
//! where e_t is the unit vector around the axis and the last term the curvature of the hoop.

use super::section::Planar;
use crate::surface::normals::tangents;
use crate::surface::{Local, Projection};
use crate::{Vec2, Vec3};
use nalgebra::Matrix3x2;

/// An axis and the sense in which angles count about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    pub point: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Angles count against the right hand. Counted with it, the normals of a surface are on the right hand of the way
    /// along its curve in the plane (r, h); counted against it, on the left.
    pub clockwise: bool,
}

/// |n_r| below which a curve meets the axis at a right angle.
const FLAT: f64 = 1e-9;

impl Axis {
    /// An axis about which angles count with the right hand.
    pub fn new(point: Vec3, direction: Vec3) -> Self {
        Self { point, direction, clockwise: false }
    }

    /// (r, h) of a point, and e_r; on the axis, where any would do, that of angle 0.
    pub fn split(&self, x: &Vec3) -> (Vec2, Vec3) {
        let arm = x - self.point;
        let height = arm.dot(&self.direction);
        let radial = arm - self.direction * height;
        let radius = radial.norm();
        if radius <= 8.0 * f64::EPSILON * (x.amax() + self.point.amax()) {
            (Vec2::new(0.0, height), self.frame()[0])
        } else {
            (Vec2::new(radius, height), radial / radius)
        }
    }

    /// The closest point of the surface to `x`, which `split` has brought to `at` and `e_r`.
    pub fn lift(&self, x: &Vec3, at: Vec2, e_r: Vec3, planar: &Planar) -> Projection {
        let half_plane = Matrix3x2::from_columns(&[e_r, self.direction]);
        let e_t = self.direction.cross(&e_r);
        let hoop = match planar.normal.x {
            n_r if at.x > 0.0 => n_r / at.x,
            n_r if n_r.abs() < FLAT => planar.gradient[(0, 0)],
            // All points of a circle are equally close.
            _ => 0.0,
        };
        let normal = half_plane * planar.normal;
        Projection {
            gap: planar.gap,
            point: x - normal * planar.gap,
            normal,
            normal_gradient: half_plane * planar.gradient * half_plane.transpose() + e_t * e_t.transpose() * hoop,
            patch: 0,
            xi: [0.0; 2],
        }
    }

    /// Where a curve meets the axis at an angle: what `planar` finds in half planes at quarter turns around, next to `x`, with planes
    /// that touch the surface there. They are numbered on from `piece`, by `count`.
    pub fn around(
        &self,
        x: &Vec3,
        (piece, count): (u32, u32),
        planar: impl Fn(&Vec2) -> Option<Planar>,
    ) -> Vec<Projection> {
        let arm = x - self.point;
        let [e_1, e_2] = self.frame();
        let plane = |(k, e_r): (u32, Vec3)| {
            let planar = planar(&Vec2::new(arm.dot(&e_r), arm.dot(&self.direction)))?;
            let half_plane = Matrix3x2::from_columns(&[e_r, self.direction]);
            let normal = half_plane * planar.normal;
            Some(Projection {
                gap: planar.gap,
                point: x - normal * planar.gap,
                normal,
                normal_gradient: half_plane * planar.gradient * half_plane.transpose(),
                patch: piece + k * count,
                xi: [0.0; 2],
            })
        };
        (0..).zip([e_1, e_2, -e_1, -e_2]).filter_map(plane).collect()
    }

    /// The surface at an angle, where the curve is `curve[0]` with the derivatives `curve[1]` and `curve[2]`; the angle is
    /// the first parameter.
    pub fn local(&self, angle: f64, curve: [Vec2; 3]) -> Local {
        let [e_1, e_2] = self.frame();
        let (sin, cos) = angle.sin_cos();
        let (e_r, e_t) = (e_1 * cos + e_2 * sin, e_2 * cos - e_1 * sin);
        let [c, d, s] = curve;
        let a = self.direction;
        Local {
            point: self.point + e_r * c.x + a * c.y,
            tangents: [e_t * c.x, e_r * d.x + a * d.y],
            second: [-e_r * c.x, e_t * d.x, e_r * s.x + a * s.y],
        }
    }

    /// A direction (n_r, n_h) of the half plane at an angle.
    pub fn at_angle(&self, angle: f64, direction: &Vec2) -> Vec3 {
        let [e_1, e_2] = self.frame();
        (e_1 * angle.cos() + e_2 * angle.sin()) * direction.x + self.direction * direction.y
    }

    /// The angle at which e_r is this.
    pub fn angle(&self, e_r: &Vec3) -> f64 {
        let [e_1, e_2] = self.frame();
        e_r.dot(&e_2).atan2(e_r.dot(&e_1))
    }

    /// Lower and upper corner of the box of the surface, `support` being the greatest product of a direction of the plane
    /// (r, h) with the points of the curve.
    pub fn bounds(&self, support: impl Fn(Vec2) -> f64) -> (Vec3, Vec3) {
        let high = |k: usize, sign: f64| {
            let a = self.direction[k];
            support(Vec2::new((1.0 - a * a).max(0.0).sqrt(), sign * a))
        };
        (Vec3::from_fn(|k, _| self.point[k] - high(k, -1.0)), Vec3::from_fn(|k, _| self.point[k] + high(k, 1.0)))
    }

    /// e_r at the angle 0 and a quarter turn on.
    fn frame(&self) -> [Vec3; 2] {
        let [e_1, e_2] = tangents(&self.direction);
        [e_1, if self.clockwise { -e_2 } else { e_2 }]
    }
}
