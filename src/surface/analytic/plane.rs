//! The plane.

use crate::surface::normals::tangents;
use crate::surface::{Closest, Local, Parametric, Projection};
use crate::{Mat3, Vec3};

/// The half space behind the plane is solid. Parameters: lengths along two directions of the plane, from `point`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub point: Vec3,
    /// Unit vector out of the solid.
    pub normal: Vec3,
}

impl Plane {
    /// Closest point of the plane to `x`.
    pub fn project(&self, x: &Vec3) -> Projection {
        let gap = (x - self.point).dot(&self.normal);
        Projection {
            gap,
            point: x - self.normal * gap,
            normal: self.normal,
            normal_gradient: Mat3::zeros(),
            patch: 0,
            xi: [0.0; 2],
        }
    }
}

impl Parametric for Plane {
    fn domain(&self) -> [[f64; 2]; 2] {
        [[f64::NEG_INFINITY, f64::INFINITY]; 2]
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        let [a, b] = tangents(&self.normal);
        Local { point: self.point + a * xi[0] + b * xi[1], tangents: [a, b], second: [Vec3::zeros(); 3] }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let reach = |k: usize| if self.normal[k].abs() == 1.0 { 0.0 } else { f64::INFINITY };
        let reach = Vec3::from_fn(|k, _| reach(k));
        (self.point - reach, self.point + reach)
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let arm = x - self.point;
        Closest::new(self, tangents(&self.normal).map(|t| arm.dot(&t)), x)
    }
}
