//! 10-node tetrahedron with one change of volume for the whole element: quadratic displacements, constant pressure.
//!
//! The equations are those of [`super::hex8_sri`] at the points of [`super::tet10`]. Fields whose strain is a change of volume that
//! varies linearly over the element, and is zero on the mean, cost an element alone nothing where nothing else than volume is
//! resisted; neighbours do not allow them.

use super::hex8_sri::{integrate, use_mean_volume};
use super::{ElementMatrices, Inverted, Medium, Sample, tet10};

/// Integration points.
pub const POINTS: usize = tet10::POINTS;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 10],
    u: &[[f64; 3]; 10],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<30>,
) -> Result<(), Inverted> {
    integrate(&mut tet10::points(x0, u)?, medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 10], u: &[[f64; 3]; 10]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = tet10::points(x0, u)?;
    use_mean_volume(&mut points);
    Ok(points.map(|point| point.sample()))
}
