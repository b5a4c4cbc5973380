//! The torus.

use super::axis::Axis;
use super::section::circle;
use crate::surface::{Closest, Local, Parametric, Projection};
use crate::{Vec2, Vec3};
use std::f64::consts::PI;

/// A tube bent to a ring, solid inside, or around its bore when `hollow`. Parameters: angle about the axis, angle about
/// the ring from its outermost point towards the axis's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    pub center: Vec3,
    /// Unit vector.
    pub axis: Vec3,
    /// Radius of the ring.
    pub radius: f64,
    /// Radius of the tube, less than that of the ring.
    pub tube: f64,
    pub hollow: bool,
}

impl Torus {
    /// Closest point of the torus to `x`.
    pub fn project(&self, x: &Vec3) -> Projection {
        let (at, e_r) = self.axis().split(x);
        let sign = if self.hollow { -1.0 } else { 1.0 };
        let planar = circle(at - self.ring(), self.tube, sign, Vec2::x());
        self.axis().lift(x, at, e_r, &planar)
    }

    fn axis(&self) -> Axis {
        Axis { point: self.center, direction: self.axis, clockwise: self.hollow }
    }

    /// (r, h) of the ring.
    fn ring(&self) -> Vec2 {
        Vec2::new(self.radius, 0.0)
    }
}

impl Parametric for Torus {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-PI, PI]; 2]
    }

    fn local(&self, [around, about]: [f64; 2]) -> Local {
        let (sin, cos) = about.sin_cos();
        let arm = Vec2::new(cos, sin) * self.tube;
        self.axis().local(around, [self.ring() + arm, Vec2::new(-arm.y, arm.x), -arm])
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.axis().bounds(|direction| self.radius * direction.x + self.tube)
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let (at, e_r) = self.axis().split(x);
        let arm = at - self.ring();
        Closest::new(self, [self.axis().angle(&e_r), arm.y.atan2(arm.x)], x)
    }
}
