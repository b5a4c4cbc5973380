//! 18-node wedge with one change of volume for the whole element.
//!
//! The equations are those of [`super::hex8_sri`] at the points of [`super::wedge18`]. One pressure is what its nodes can bear: on
//! cubes of 2 to 4 wedges along each edge, that are held all around, the inf-sup constant is 0.48, 0.44 and 0.43 with it and no
//! less than that with diagonals that alternate; with pressures that are linear in the element, as [`super::hex27`] has them, it is
//! zero, for a wedge has no node inside. Displacements that turn and stretch alike in all directions, with a stretch that varies over
//! the element, cost it nothing, as they do [`super::tet10_sri`]: none of them fits the next element as well.

use super::hex8_sri::{integrate, use_mean_volume};
use super::{ElementMatrices, Inverted, Medium, Sample, wedge18};

/// Integration points.
pub const POINTS: usize = wedge18::POINTS;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 18],
    u: &[[f64; 3]; 18],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<54>,
) -> Result<(), Inverted> {
    integrate(&mut wedge18::points(x0, u)?, medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 18], u: &[[f64; 3]; 18]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = wedge18::points(x0, u)?;
    use_mean_volume(&mut points);
    Ok(points.map(|point| point.sample()))
}
