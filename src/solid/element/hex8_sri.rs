//! 8-node hexahedron with selective reduced integration: the deviatoric part at 2x2x2 points, one change of volume for the
//! whole element.
//!
//! Written for any law, as the material sees a deformation gradient and no parts of it:
//!
//! ```text
//! Fs  = (Jm/J)^(1/3) F,     Jm = v/V,     gm_a = int g_a dv / v
//! W   = int W(Fs) dV
//! R_a = int [ dev taus g_a + ps gm_a ] dV,     taus = tau(Fs),  ps = tr taus / 3
//! ```
//!
//! v and V are the volumes of the deformed and the reference element. A law whose pressure depends on the volume alone (`hooke`,
//! and plasticity that is free of pressure) thus has one pressure in the element: this is Hughes's selective reduced
//! integration with the mean of the element in the place of its centre, the mean-dilatation element of Simo, Taylor and Pister
//! (CMAME 51, 1985). With the gradients of the centre a distorted hexahedron fails the patch test (Flanagan and Belytschko,
//! IJNME 17, 1981). It cures the same locking as [`super::hex8_fbar`], and hourglasses and bends alike; what it adds is that
//! the forces of a hyperelastic law derive from an energy and the tangent is symmetric. With m_a = (gm_a - g_a)/3,
//! q = c : 1 + 2 taus, s = 1 : q, x = ps - Ps J/v, Ps = int ps dV:
//!
//! ```text
//! K_aibk = int [ g_aj (c_ijkl + delta_ik taus_jl + x delta_il delta_jk + (ps - x) delta_ij delta_kl) g_bl
//!                + q_ij g_aj m_bk + m_ai q_kl g_bl + s m_ai m_bk ] dV - Ps gm_ai gm_bk
//! ```

use super::mixed::{add_rates, pressure, respond};
use super::{ElementMatrices, Inverted, Medium, Point, Sample, add_force, add_scaled, contract, hex8};

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
    integrate(&mut hex8::points(x0, u)?, medium, want_tangent, out)
}

/// The integration points, with the mean change of volume.
pub fn samples(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = hex8::points(x0, u)?;
    use_mean_volume(&mut points);
    Ok(points.map(|point| point.sample()))
}

/// Gives all points the mean change of volume.
#[inline(always)]
pub(super) fn use_mean_volume<const N: usize, const Q: usize>(points: &mut [Point<N>; Q]) {
    let (reference, current) = points.iter().fold((0.0, 0.0), |(r, c), p| (r + p.weight, c + p.weight * p.det_f));
    let mean = current / reference;
    for point in points {
        point.take_volume(mean);
    }
}

/// Internal forces and, when wanted, the tangent, from standard integration points.
#[inline(always)]
pub(super) fn integrate<const N: usize, const Q: usize, const D: usize>(
    points: &mut [Point<N>; Q],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<D>,
) -> Result<(), Inverted> {
    const { assert!(D == 3 * N) };
    // Share of each point in the current volume.
    let volume: f64 = points.iter().map(|p| p.weight * p.det_f).sum();
    let share = points.each_ref().map(|p| p.weight * p.det_f / volume);
    let mut mean = [[0.0; N]; 3];
    for (point, share) in points.iter().zip(share) {
        (0..3).for_each(|j| add_scaled(&mut mean[j], share, &point.gradients[j]));
    }
    use_mean_volume(points);

    let mut force = [[0.0; N]; 3];
    let responses = respond(points, medium, want_tangent, &mut force)?;
    let mut total = 0.0;
    for (point, response) in points.iter().zip(&responses) {
        total += point.weight * pressure(&response.kirchhoff);
    }
    for i in 0..3 {
        add_scaled(&mut force[i], total, &mean[i]);
        (0..N).for_each(|a| out.residual[3 * a + i] = force[i][a]);
    }
    if !want_tangent {
        return Ok(());
    }

    let mut rates = [[[[[0.0; N]; 3]; Q]; 3]; 3];
    let (mut cross, mut of_mean) = ([[0.0; N]; 3], -total);
    for (q, (point, response)) in points.iter().zip(&responses).enumerate() {
        let x = pressure(&response.kirchhoff) - total * share[q] / point.weight;
        let (with_mean, s) = add_rates(point, response, x, q, &mut rates);
        add_force(point, &with_mean, &mut cross);
        of_mean += point.weight * s / 9.0;
    }
    contract(points, &rates, true, &mut out.tangent);
    let at = |field: &[[f64; N]; 3], row: usize| field[row % 3][row / 3];
    for r in 0..D {
        for c in r..D {
            let (mean_r, mean_c) = (at(&mean, r), at(&mean, c));
            let more = at(&cross, r) * mean_c + mean_r * at(&cross, c) + of_mean * mean_r * mean_c;
            out.tangent[r][c] += more;
            out.tangent[c][r] = out.tangent[r][c];
        }
    }
    Ok(())
}
