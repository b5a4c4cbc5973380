//! 5-node pyramid with one change of volume for the whole element.
//!
//! The equations are those of [`super::hex8_sri`] at the points of [`super::pyramid5`]. Stands beside all hexahedra that do not lock in
//! volume.

use super::hex8_sri::{integrate, use_mean_volume};
use super::{ElementMatrices, Inverted, Medium, Sample, pyramid5};

/// Integration points.
pub const POINTS: usize = pyramid5::POINTS;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 5],
    u: &[[f64; 3]; 5],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<15>,
) -> Result<(), Inverted> {
    integrate(&mut pyramid5::points(x0, u)?, medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 5], u: &[[f64; 3]; 5]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = pyramid5::points(x0, u)?;
    use_mean_volume(&mut points);
    Ok(points.map(|point| point.sample()))
}
