//! 8-node hexahedron with selective reduced integration: the deviatoric part at 2x2x2 points, one change of volume for the
//! whole element.
//!
//! The equations are those of [`super::mixed`] with one function. A law whose pressure depends on the volume alone (`hooke`,
//! and plasticity that is free of pressure) thus has one pressure in the element: this is Hughes's selective reduced
//! integration with the mean of the element in the place of its centre, the mean-dilatation element of Simo, Taylor and Pister
//! (CMAME 51, 1985). With the gradients of the centre a distorted hexahedron fails the patch test (Flanagan and Belytschko,
//! IJNME 17, 1981). It cures the same locking as [`super::hex8_fbar`], and hourglasses and bends alike; what it adds is that
//! the forces of a hyperelastic law derive from an energy and the tangent is symmetric.

use super::mixed::{self, integrate, project};
use super::{ElementMatrices, Inverted, Medium, Sample, hex8};

/// Integration points.
pub const POINTS: usize = hex8::POINTS;

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    integrate(&mut hex8::points(x0, u)?, &mixed::mean(), medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = hex8::points(x0, u)?;
    project(&mut points, &mixed::mean())?;
    Ok(points.map(|point| point.sample()))
}
