//! 6-node wedge with one change of volume for the whole element.
//!
//! The equations are those of [`super::hex8_sri`] at the points of [`super::wedge6`]. Stands beside all hexahedra that do not lock
//! in volume; where wedges are as many as in a mesh of nothing else, two constraints a node for three degrees of freedom, it
//! locks less than [`super::wedge6`] does, but locks.

use super::hex8_sri::{integrate, use_mean_volume};
use super::{ElementMatrices, Inverted, Medium, Sample, wedge6};

/// Integration points.
pub const POINTS: usize = wedge6::POINTS;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 6],
    u: &[[f64; 3]; 6],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<18>,
) -> Result<(), Inverted> {
    integrate(&mut wedge6::points(x0, u)?, medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 6], u: &[[f64; 3]; 6]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = wedge6::points(x0, u)?;
    use_mean_volume(&mut points);
    Ok(points.map(|point| point.sample()))
}
