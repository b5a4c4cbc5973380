//! 4-node tetrahedron: constant strain, one integration point.
//!
//! Node 3 lies on the side of the face 0-1-2 from which it is seen counter-clockwise.

use super::{ElementMatrices, Gradients, Inverted, Medium, Point, Sample, deform, integrate, jacobian};
use crate::Vec3;

/// Integration points.
pub const POINTS: usize = 1;

/// Derivatives of 1 - xi - eta - zeta, xi, eta, zeta.
const GRADIENTS: Gradients<4> = [[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 1.0]];

/// Volume of the parent tetrahedron.
const WEIGHT: f64 = 1.0 / 6.0;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 4],
    u: &[[f64; 3]; 4],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<12>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current; negative when inside out.
pub fn volume(x: &[[f64; 3]; 4]) -> f64 {
    WEIGHT * jacobian(x, &GRADIENTS).determinant()
}

/// Shape functions at a point, where nodes are at `x`; `None` where these lie in a plane.
pub fn shape(x: &[[f64; 3]; 4], point: &Vec3) -> Option<[f64; 4]> {
    let [xi, eta, zeta] = (jacobian(x, &GRADIENTS).try_inverse()? * (point - Vec3::from(x[0]))).into();
    Some([1.0 - xi - eta - zeta, xi, eta, zeta])
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; 4], per_volume: Vec3) -> [f64; 12] {
    let share = 0.25 * volume(x0);
    std::array::from_fn(|k| share * per_volume[k % 3])
}

#[inline(always)]
fn points(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4]) -> Result<[Point<4>; 1], Inverted> {
    deform(x0, u, &[GRADIENTS], WEIGHT, 0.0)
}
