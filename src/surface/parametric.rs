//! What all descriptions of a surface have in common.

use crate::Vec3;

/// A point of a surface with its first and second derivatives in the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local {
    pub point: Vec3,
    pub tangents: [Vec3; 2],
    /// P,11, P,12 and P,22.
    pub second: [Vec3; 3],
}

impl Local {
    /// tau_1 x tau_2, not normalised.
    pub fn area_vector(&self) -> Vec3 {
        self.tangents[0].cross(&self.tangents[1])
    }
}

/// The point of a surface next to another point, ends and corners of the surface included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    pub xi: [f64; 2],
    pub point: Vec3,
    pub distance: f64,
}

impl Closest {
    /// The point of `surface` at `xi` as the closest to `x`.
    pub fn new(surface: &(impl Parametric + ?Sized), xi: [f64; 2], x: &Vec3) -> Self {
        let point = surface.point(xi);
        Self { xi, point, distance: (x - point).norm() }
    }
}

/// A surface P(xi_1, xi_2).
pub trait Parametric {
    /// Lowest and highest value of each parameter; infinite where the surface goes on without end.
    fn domain(&self) -> [[f64; 2]; 2];

    /// The surface at `xi`, which may lie outside the domain.
    fn local(&self, xi: [f64; 2]) -> Local;

    /// The point at `xi`.
    fn point(&self, xi: [f64; 2]) -> Vec3 {
        self.local(xi).point
    }

    /// The outward unit normal at `xi`.
    fn normal(&self, xi: [f64; 2]) -> Vec3 {
        self.local(xi).area_vector().normalize()
    }

    /// Lower and upper corner of a box that holds the surface.
    fn bounds(&self) -> (Vec3, Vec3);

    /// The point of the surface next to `x`.
    fn closest(&self, x: &Vec3) -> Closest;
}
