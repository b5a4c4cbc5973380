//! The cone.

use super::axis::Axis;
use super::chain::KEEP;
use super::section::{Planar, corner};
use crate::surface::normals::more_along;
use crate::surface::{Closest, Local, Parametric, Projection};
use crate::{Mat2, Vec2, Vec3};
use std::f64::consts::PI;

/// A cone from its apex without end, solid inside, or around its bore when `hollow`. Parameters: angle about the axis,
/// distance from the apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    pub apex: Vec3,
    /// Unit vector from the apex into the cone.
    pub axis: Vec3,
    /// Between axis and surface: half of the opening, radians, below a right angle.
    pub angle: f64,
    pub hollow: bool,
}

/// Distance to the apex, over the size of its coordinates, below which a point is in it.
const NEAR: f64 = 1e-9;

impl Cone {
    /// Closest point of the cone to `x`; that is the apex all around its back.
    pub fn project(&self, x: &Vec3) -> Projection {
        let (at, e_r) = self.axis().split(x);
        let sign = if self.hollow { -1.0 } else { 1.0 };
        let planar = if at.dot(&self.side()) > 0.0 {
            let normal = self.outward() * sign;
            Planar { gap: at.dot(&normal), normal, gradient: Mat2::zeros() }
        } else {
            corner(at, -Vec2::y() * sign, x.amax() + self.apex.amax())
        };
        self.axis().lift(x, at, e_r, &planar)
    }

    /// At the tip, next to the axis by a part of `reach`: the projections of `x`, whose closest point is `at`, onto planes that touch the
    /// cone at four places around. Elsewhere none.
    pub fn around(&self, x: &Vec3, at: &Projection, reach: f64) -> Vec<Projection> {
        let (near, (own, _)) = (KEEP * reach, self.axis().split(x));
        let normal = self.outward() * if self.hollow { -1.0 } else { 1.0 };
        let planar = |x: &Vec2| {
            let gap = x.dot(&normal);
            let is_even = (gap - at.gap).abs() <= near && x.dot(&self.side()) >= -near;
            is_even.then_some(Planar { gap, normal, gradient: Mat2::zeros() })
        };
        if own.x <= near { self.axis().around(x, (at.patch, 1), planar) } else { Vec::new() }
    }

    /// The normal at the point next to `x`; at the apex that of the side that is the most along `like`, whichever its sign.
    pub fn side_normal(&self, x: &Vec3, like: &Vec3) -> Vec3 {
        let (at, e_r) = self.axis().split(x);
        let across = like - self.axis * like.dot(&self.axis);
        let at_apex = at.norm() <= NEAR * (x.amax() + self.apex.amax());
        let e_r = if at_apex { across.try_normalize(0.0).unwrap_or(e_r) } else { e_r };
        let normal = |e_r: Vec3| e_r * self.outward().x + self.axis * self.outward().y;
        let normal = if at_apex { more_along(like, normal(e_r), normal(-e_r)) } else { normal(e_r) };
        if self.hollow { -normal } else { normal }
    }

    fn axis(&self) -> Axis {
        Axis { point: self.apex, direction: self.axis, clockwise: self.hollow }
    }

    /// Unit vector (r, h) from the apex along the surface.
    fn side(&self) -> Vec2 {
        Vec2::new(self.angle.sin(), self.angle.cos())
    }

    /// Unit vector (r, h) away from the axis across the surface.
    fn outward(&self) -> Vec2 {
        Vec2::new(self.angle.cos(), -self.angle.sin())
    }
}

impl Parametric for Cone {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-PI, PI], [0.0, f64::INFINITY]]
    }

    fn local(&self, [angle, distance]: [f64; 2]) -> Local {
        self.axis().local(angle, [self.side() * distance, self.side(), Vec2::zeros()])
    }

    fn normal(&self, [angle, _]: [f64; 2]) -> Vec3 {
        self.axis().at_angle(angle, &self.outward()) * if self.hollow { -1.0 } else { 1.0 }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.axis().bounds(|direction| if direction.dot(&self.side()) > 0.0 { f64::INFINITY } else { 0.0 })
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let (at, e_r) = self.axis().split(x);
        Closest::new(self, [self.axis().angle(&e_r), at.dot(&self.side()).max(0.0)], x)
    }
}
