//! Cylinder and sphere: what is equally far from a line or a point.

use super::axis::Axis;
use crate::surface::{Closest, Local, Parametric, Projection};
use crate::{Mat3, Vec2, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A cylinder without end, solid inside, or around its bore when `hollow`. Parameters: angle, height from `point`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    pub point: Vec3,
    /// Unit vector.
    pub axis: Vec3,
    pub radius: f64,
    pub hollow: bool,
}

/// A sphere, solid inside, or around its bore when `hollow`. Parameters: longitude and latitude about z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub center: Vec3,
    pub radius: f64,
    pub hollow: bool,
}

impl Cylinder {
    /// Closest point of the cylinder to `x`.
    pub fn project(&self, x: &Vec3) -> Projection {
        let across = Mat3::identity() - self.axis * self.axis.transpose();
        project(x, across * (x - self.point), &across, self.radius, self.hollow)
    }

    fn axis(&self) -> Axis {
        Axis { point: self.point, direction: self.axis, clockwise: self.hollow }
    }
}

impl Sphere {
    /// Closest point of the sphere to `x`.
    pub fn project(&self, x: &Vec3) -> Projection {
        project(x, x - self.center, &Mat3::identity(), self.radius, self.hollow)
    }

    fn axis(&self) -> Axis {
        Axis { point: self.center, direction: Vec3::z(), clockwise: self.hollow }
    }
}

/// Projection along `arm`, which leads from the axis or centre to `x`; `across` projects onto the directions that it
/// can take.
fn project(x: &Vec3, arm: Vec3, across: &Mat3, radius: f64, hollow: bool) -> Projection {
    let sign = if hollow { -1.0 } else { 1.0 };
    let distance = arm.norm();
    let (outward, normal_gradient) = if distance <= f64::EPSILON * radius {
        // All directions are equally close: take the first that the shape has.
        (across.column(across.diagonal().imax()).normalize(), Mat3::zeros())
    } else {
        let outward = arm / distance;
        (outward, (across - outward * outward.transpose()) * (sign / distance))
    };
    let point = x + outward * (radius - distance);
    Projection {
        gap: sign * (distance - radius),
        point,
        normal: outward * sign,
        normal_gradient,
        patch: 0,
        xi: [0.0; 2],
    }
}

impl Parametric for Cylinder {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-PI, PI], [f64::NEG_INFINITY, f64::INFINITY]]
    }

    fn local(&self, [angle, height]: [f64; 2]) -> Local {
        self.axis().local(angle, [Vec2::new(self.radius, height), Vec2::y(), Vec2::zeros()])
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let along = |direction: Vec2| if direction.y == 0.0 { 0.0 } else { f64::INFINITY };
        self.axis().bounds(|direction| self.radius * direction.x + along(direction))
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let (at, e_r) = self.axis().split(x);
        Closest::new(self, [self.axis().angle(&e_r), at.y], x)
    }
}

impl Parametric for Sphere {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[-PI, PI], [-FRAC_PI_2, FRAC_PI_2]]
    }

    fn local(&self, [longitude, latitude]: [f64; 2]) -> Local {
        let (sin, cos) = latitude.sin_cos();
        let arm = Vec2::new(cos, sin) * self.radius;
        self.axis().local(longitude, [arm, Vec2::new(-arm.y, arm.x), -arm])
    }

    fn normal(&self, [longitude, latitude]: [f64; 2]) -> Vec3 {
        let (sin, cos) = latitude.sin_cos();
        self.axis().at_angle(longitude, &Vec2::new(cos, sin)) * if self.hollow { -1.0 } else { 1.0 }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (self.center.add_scalar(-self.radius), self.center.add_scalar(self.radius))
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let (at, e_r) = self.axis().split(x);
        Closest::new(self, [self.axis().angle(&e_r), at.y.atan2(at.x)], x)
    }
}
