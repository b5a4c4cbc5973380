//! 8-node hexahedron with the F-bar cure of volumetric locking.
//!
//! The volume change of every integration point is that of the element's centre, index 0:
//!
//! ```text
//! Fb     = (J0/J)^(1/3) F,    det Fb = J0
//! R_a    = int sigma(Fb) g_a dv = int (J/J0) tau(Fb) g_a dV
//! K_aibk = int (J/J0) [ g_aj (cb_ijkl + delta_ik taub_jl) g_bl + q_ij g_aj (g0_bk - g_bk) ] dV
//! q      = (cb : 1 - taub) / 3
//! ```
//!
//! sigma is the Cauchy stress; bars mark what is taken at Fb. K is exact and not symmetric. De Souza Neto, Peric, Dutko
//! and Owen, Int. J. Solids Struct. 33 (1996); their q is a:1/3 - 2/3 sigma x 1 with a_ijkl = cb_ijkl + delta_ik
//! taub_jl, per current volume. R derives from no energy.

use super::{ElementMatrices, Gradients, Inverted, Medium, Point, Sample, hex8, integrate, use_volume_of};

/// Integration points.
pub const POINTS: usize = hex8::POINTS;

/// Internal forces and, if `want_tangent`, the unsymmetric tangent of the element with reference nodes `x0` displaced
/// by `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    let (points, centre) = points(x0, u)?;
    integrate(&points, Some(&centre), medium, want_tangent, out)
}

/// The integration points, with F-bar and weights dV J/J0.
pub fn samples(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.0.map(|point| point.sample()))
}

/// Integration points with F-bar and weights dV J/J0, and the gradients at the centre.
#[inline(always)]
fn points(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<([Point<8>; 8], Gradients<8>), Inverted> {
    let mut points = hex8::points(x0, u)?;
    let centre = hex8::centre(x0, u)?;
    use_volume_of(&centre, &mut points);
    Ok((points, centre.gradients))
}
