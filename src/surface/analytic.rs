//! Surfaces with closed forms: plane, cylinder and sphere.

use super::projection::Projection;
use crate::{Mat3, Vec3};

/// The half space behind the plane is solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub point: Vec3,
    /// Unit vector out of the solid.
    pub normal: Vec3,
}

/// A cylinder without end, solid inside, or around its bore when `hollow`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    pub point: Vec3,
    /// Unit vector.
    pub axis: Vec3,
    pub radius: f64,
    pub hollow: bool,
}

/// A sphere, solid inside, or around its bore when `hollow`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub center: Vec3,
    pub radius: f64,
    pub hollow: bool,
}

impl Plane {
    /// Closest point of the plane to `x`.
    pub fn closest(&self, x: &Vec3) -> Projection {
        let gap = (x - self.point).dot(&self.normal);
        at(gap, x - self.normal * gap, self.normal, Mat3::zeros())
    }
}

impl Cylinder {
    /// Closest point of the cylinder to `x`.
    pub fn closest(&self, x: &Vec3) -> Projection {
        let arm = x - self.point;
        let across = Mat3::identity() - self.axis * self.axis.transpose();
        round(x, across * arm, &across, self.radius, self.hollow)
    }
}

impl Sphere {
    /// Closest point of the sphere to `x`.
    pub fn closest(&self, x: &Vec3) -> Projection {
        round(x, x - self.center, &Mat3::identity(), self.radius, self.hollow)
    }
}

/// Projection along `arm`, which leads from the axis or centre to `x`; `across` projects onto the directions that it
/// can take.
fn round(x: &Vec3, arm: Vec3, across: &Mat3, radius: f64, hollow: bool) -> Projection {
    let sign = if hollow { -1.0 } else { 1.0 };
    let distance = arm.norm();
    if distance <= f64::EPSILON * radius {
        // All directions are equally close: take the first that the shape has.
        let outward = across.column(across.diagonal().imax()).normalize();
        return at(-sign * radius, x + outward * radius, outward * sign, Mat3::zeros());
    }
    let outward = arm / distance;
    let gradient = (across - outward * outward.transpose()) * (sign / distance);
    at(sign * (distance - radius), x + outward * (radius - distance), outward * sign, gradient)
}

fn at(gap: f64, point: Vec3, normal: Vec3, normal_gradient: Mat3) -> Projection {
    Projection { gap, point, normal, normal_gradient, patch: 0, xi: [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::projection::tests::check_derivatives;

    #[test]
    fn gaps_points_and_derivatives() {
        let axis = Vec3::new(1.0, 2.0, -0.5).normalize();
        let center = Vec3::new(0.3, -0.2, 0.1);
        let x = Vec3::new(1.7, 0.4, 2.0);
        for hollow in [false, true] {
            let sign = if hollow { -1.0 } else { 1.0 };
            let sphere = Sphere { center, radius: 1.5, hollow };
            let p = sphere.closest(&x);
            assert!((p.gap - sign * ((x - center).norm() - 1.5)).abs() < 1e-15);
            assert!(((p.point - center).norm() - 1.5).abs() < 1e-15 && (p.point + p.normal * p.gap - x).norm() < 1e-15);
            check_derivatives(&x, |x| Some(sphere.closest(x)));
            let cylinder = Cylinder { point: center, axis, radius: 1.5, hollow };
            let p = cylinder.closest(&x);
            assert!(((p.point - center).cross(&axis).norm() - 1.5).abs() < 1e-15);
            assert!((p.point + p.normal * p.gap - x).norm() < 1e-15 && p.normal.dot(&axis).abs() < 1e-15);
            check_derivatives(&x, |x| Some(cylinder.closest(x)));
            for p in [sphere.closest(&center), cylinder.closest(&(center + axis * 3.0))] {
                assert!((p.gap + sign * 1.5).abs() < 1e-15 && (p.normal.norm() - 1.0).abs() < 1e-15);
            }
        }
        let plane = Plane { point: center, normal: axis };
        assert_eq!(plane.closest(&(center + axis * 2.0)).gap, 2.0);
        check_derivatives(&x, |x| Some(plane.closest(x)));
    }
}
