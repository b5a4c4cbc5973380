//! Elements whose change of volume is a projection: the deviatoric part at all integration points, the volume by few functions.
//!
//! With functions psi_i on the element, and J the change of volume that the displacements make at its points,
//!
//! ```text
//! theta = psi_i M^-1_ij int psi_j J dV,     M_ij = int psi_i psi_j dV
//! Fs  = (theta/J)^(1/3) F
//! W   = int W(Fs) dV
//! R_a = int [ dev taus g_a + ps gm_a ] dV,     taus = tau(Fs),  ps = tr taus / 3
//! gm_a = d theta / theta = A_j B_ja,     A_j = psi_i M^-1_ij / theta,  B_ja = int psi_j J g_a dV
//! ```
//!
//! written for any law, as the material sees a deformation gradient and no parts of it. It is the three-field principle of Simo,
//! Taylor and Pister (CMAME 51, 1985) with pressures and changes of volume that are discontinuous from element to element. The
//! forces of a hyperelastic law derive from an energy, and the tangent is symmetric. With m_a = (gm_a - g_a)/3,
//! q = c : 1 + 2 taus, s = 1 : q, P_j = int ps A_j dV, y = J psi_j P_j:
//!
//! ```text
//! K_aibk = int [ g_aj (c_ijkl + delta_ik taus_jl + (ps - y) delta_il delta_jk + y delta_ij delta_kl) g_bl
//!                + q_ij g_aj m_bk + m_ai q_kl g_bl + s m_ai m_bk - ps gm_ai gm_bk ] dV
//! ```
//!
//! gm is the sum of few products, so that what it is in becomes as many products of vectors of the element. With psi = 1 alone
//! theta is the mean of J, A = 1/v with v the volume of the deformed element, and gm the mean of g over it: [`super::hex8_sri`].

use super::{ElementMatrices, Gradients, Inverted, Medium, Point, add_force, add_scaled, contract, stress_rate};
use crate::solid::material::Response;
use crate::solid::voigt::{INDEX, Voigt};
use nalgebra::SMatrix;

/// The projected change of volume.
struct Projection<const Q: usize, const M: usize> {
    /// theta at the points.
    theta: [f64; Q],
    /// A_j at the points, `[q][j]`.
    rates: [[f64; M]; Q],
}

impl<const Q: usize, const M: usize> Projection<Q, M> {
    /// Of standard points, with the functions at them.
    #[inline(always)]
    fn new<const N: usize>(points: &[Point<N>; Q], psi: &[[f64; M]; Q]) -> Result<Self, Inverted> {
        let (mut mass, mut moments) = (SMatrix::<f64, M, M>::zeros(), [0.0; M]);
        for (point, psi) in points.iter().zip(psi) {
            for i in 0..M {
                moments[i] += point.weight * point.det_f * psi[i];
                (0..M).for_each(|j| mass[(i, j)] += point.weight * psi[i] * psi[j]);
            }
        }
        let lost = Inverted { det_f: f64::NAN };
        let inverse = mass.try_inverse().ok_or(lost)?;
        let (mut theta, mut rates) = ([0.0; Q], [[0.0; M]; Q]);
        for q in 0..Q {
            for j in 0..M {
                rates[q][j] = (0..M).map(|i| psi[q][i] * inverse[(i, j)]).sum();
                theta[q] += rates[q][j] * moments[j];
            }
            if theta[q] <= 0.0 || theta[q].is_nan() {
                return Err(Inverted { det_f: theta[q] });
            }
            rates[q].iter_mut().for_each(|rate| *rate /= theta[q]);
        }
        Ok(Self { theta, rates })
    }

    /// Gives the points the projected change of volume.
    #[inline(always)]
    fn apply<const N: usize>(&self, points: &mut [Point<N>; Q]) {
        for (point, theta) in points.iter_mut().zip(self.theta) {
            point.take_volume(theta);
        }
    }
}

/// Gives standard points the projected change of volume.
#[inline(always)]
pub(super) fn project<const N: usize, const Q: usize, const M: usize>(
    points: &mut [Point<N>; Q],
    psi: &[[f64; M]; Q],
) -> Result<(), Inverted> {
    Projection::new(points, psi)?.apply(points);
    Ok(())
}

/// Internal forces and, when wanted, the symmetric tangent, from standard integration points and the functions at them.
#[inline(always)]
pub(super) fn integrate<const N: usize, const Q: usize, const M: usize, const D: usize>(
    points: &mut [Point<N>; Q],
    psi: &[[f64; M]; Q],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<D>,
) -> Result<(), Inverted> {
    const { assert!(D == 3 * N) };
    let projection = Projection::new(points, psi)?;
    let volumes = points.each_ref().map(|p| p.det_f);
    // B_j
    let mut of_volume = [[[0.0; N]; 3]; M];
    for (point, psi) in points.iter().zip(psi) {
        for (of, psi) in of_volume.iter_mut().zip(psi) {
            let share = point.weight * point.det_f * psi;
            (0..3).for_each(|i| add_scaled(&mut of[i], share, &point.gradients[i]));
        }
    }
    projection.apply(points);

    let mut force = [[0.0; N]; 3];
    let responses = respond(points, medium, want_tangent, &mut force)?;
    let mut pressures = [0.0; M];
    for ((point, response), rates) in points.iter().zip(&responses).zip(&projection.rates) {
        let borne = point.weight * pressure(&response.kirchhoff);
        (0..M).for_each(|j| pressures[j] += borne * rates[j]);
    }
    for (of, pressure) in of_volume.iter().zip(pressures) {
        (0..3).for_each(|i| add_scaled(&mut force[i], pressure, &of[i]));
    }
    for i in 0..3 {
        (0..N).for_each(|a| out.residual[3 * a + i] = force[i][a]);
    }
    if !want_tangent {
        return Ok(());
    }

    let mut rates = [[[[[0.0; N]; 3]; Q]; 3]; 3];
    // What is multiplied with B_j, and by both B_j and B_l.
    let (mut beside, mut between_both) = ([[[0.0; N]; 3]; M], [[0.0; M]; M]);
    for (q, (point, response)) in points.iter().zip(&responses).enumerate() {
        let pressure = pressure(&response.kirchhoff);
        let y = volumes[q] * psi[q].iter().zip(pressures).map(|(psi, p)| psi * p).sum::<f64>();
        let (with_mean, s) = add_rates(point, response, pressure - y, q, &mut rates);
        let mut of_point = [[0.0; N]; 3];
        add_force(point, &with_mean, &mut of_point);
        let own = &projection.rates[q];
        for j in 0..M {
            (0..3).for_each(|i| add_scaled(&mut beside[j][i], own[j], &of_point[i]));
            (0..M).for_each(|l| between_both[j][l] += point.weight * own[j] * own[l] * (s / 9.0 - pressure));
        }
    }
    contract(points, &rates, true, &mut out.tangent);
    for j in 0..M {
        for (l, of) in of_volume.iter().enumerate() {
            (0..3).for_each(|i| add_scaled(&mut beside[j][i], 0.5 * between_both[j][l], &of[i]));
        }
    }
    let at = |field: &[[f64; N]; 3], row: usize| field[row % 3][row / 3];
    for (beside, of) in beside.iter().zip(&of_volume) {
        for r in 0..D {
            let (beside_r, of_r) = (at(beside, r), at(of, r));
            for c in r..D {
                out.tangent[r][c] += beside_r * at(of, c) + of_r * at(beside, c);
            }
        }
    }
    for r in 0..D {
        (r..D).for_each(|c| out.tangent[c][r] = out.tangent[r][c]);
    }
    Ok(())
}

/// What the material says at points that have the change of volume that counts; adds the forces of the deviatoric stresses.
#[inline(always)]
pub(super) fn respond<const N: usize, const Q: usize>(
    points: &[Point<N>; Q],
    medium: Medium,
    want_tangent: bool,
    force: &mut [[f64; N]; 3],
) -> Result<[Response; Q], Inverted> {
    let mut responses = [Response { kirchhoff: [0.0; 6], tangent: [[0.0; 6]; 6] }; Q];
    for (q, (point, response)) in points.iter().zip(&mut responses).enumerate() {
        let (material, state) = (medium.material, medium.state(q));
        let inverted = Inverted { det_f: point.det_f };
        if want_tangent {
            *response = material.response(&point.f, state).ok_or(inverted)?;
        } else {
            response.kirchhoff = material.kirchhoff(&point.f, state).ok_or(inverted)?;
        }
        let pressure = pressure(&response.kirchhoff);
        add_force(point, &add_to_diagonal(&response.kirchhoff, -pressure), force);
    }
    Ok(responses)
}

/// Adds all that stands between g_a and g_b in the tangent at point q, with x = ps - y. Gives what stands between g_a and gm_b,
/// q/3 - s/9 1, and s.
#[inline(always)]
pub(super) fn add_rates<const N: usize, const Q: usize>(
    point: &Point<N>,
    Response { kirchhoff, tangent }: &Response,
    x: f64,
    q: usize,
    rates: &mut [[[Gradients<N>; Q]; 3]; 3],
) -> (Voigt, f64) {
    let pressure = pressure(kirchhoff);
    let rate_of_volume: Voigt =
        std::array::from_fn(|v| tangent[v][0] + tangent[v][1] + tangent[v][2] + 2.0 * kirchhoff[v]);
    let s = rate_of_volume[0] + rate_of_volume[1] + rate_of_volume[2];
    // delta_il delta_jk is twice the symmetric unit tensor less delta_ik delta_jl.
    let mut between = *tangent;
    for v in 0..6 {
        between[v][v] += if v < 3 { 2.0 * x } else { x };
        for w in 0..3 {
            between[v][w] -= rate_of_volume[v] / 3.0;
            between[w][v] -= rate_of_volume[v] / 3.0;
        }
    }
    for (v, w) in (0..3).flat_map(|v| (0..3).map(move |w| (v, w))) {
        between[v][w] += s / 9.0 + pressure - x;
    }
    let initial = add_to_diagonal(kirchhoff, -x);
    for i in 0..3 {
        for k in i..3 {
            stress_rate(point, &initial, &between, i, k, &mut rates[i][k][q]);
        }
    }
    (add_to_diagonal(&rate_of_volume.map(|r| r / 3.0), -s / 9.0), s)
}

/// A third of the trace.
#[inline(always)]
pub(super) fn pressure(stress: &Voigt) -> f64 {
    (stress[INDEX[0][0]] + stress[INDEX[1][1]] + stress[INDEX[2][2]]) / 3.0
}

#[inline(always)]
fn add_to_diagonal(stress: &Voigt, by: f64) -> Voigt {
    std::array::from_fn(|v| stress[v] + if v < 3 { by } else { 0.0 })
}
