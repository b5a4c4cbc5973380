//! Enhanced assumed strain in finite deformation, for any shape functions and modes.
//!
//! ```text
//! F   = Fh + (j0/j) x0 E J0^-1,     E = sum_m alpha_m f_m(xi) E_m
//! R_a = int tau g_a dV,             r_m = int tau : h_m dV = 0,     h_m = dF/dalpha_m F^-1
//! ```
//!
//! Fh is that of the nodes, J and x the derivatives of the reference and the current position by the parameters, j = det J,
//! 0 marks the centre. E stands in the parameters, and is pushed to the reference and the current base vectors of the centre, so
//! that its modes turn with the element; j0/j makes their integral vanish with that of f_m, and so the patch test is passed
//! (Simo and Armero, IJNME 33, 1992; Glaser and Armero, Eng. Comput. 14, 1997). The amplitudes alpha make r vanish and are
//! no unknowns of the system: they are found for given displacements by Newton's method, so that forces and tangent are
//! functions of the displacements. It begins from the amplitudes at the last tangent, with their linear change since: in
//! Newton's method on the displacements that is the step of both together, beside which the amplitudes have little left to
//! find. From zero, under displacements that change the volume much, they may not be found.
//!
//! As x0 follows the nodes, the gradient of a node is that of its shape function and a part of E:
//!
//! ```text
//! g_a  = F^-T (dN_a/dX + (j0/j) J0^-T E^T dN_a/dxi|0)
//! K_am = int [ (c : h_m + h_m tau) g_a + tau F^-T (j0/j) J0^-T f_m E_m^T dN_a/dxi|0 ] dV
//! K_mn = int h_m : (c : h_n + h_n tau) dV
//! K    = K_ab - K_am K_mn^-1 K_nb,     R = R_a - K_am K_mn^-1 r_n
//! ```

use super::{
    ElementMatrices, Gradients, Inverted, Medium, Point, Sample, add_force, add_scaled, contract, inverse, jacobian,
    stress_rate,
};
use crate::Mat3;
use crate::solid::material::Response;
use crate::solid::voigt::to_matrix;

/// M modes of the enhanced strain at Q integration points.
pub struct Modes<const M: usize, const Q: usize> {
    /// E_m: 3 i + j is e_i x e_j, and [`VOLUME`] the unit tensor.
    pub components: [usize; M],
    /// f_m at each point.
    pub amplitudes: [[f64; M]; Q],
}

impl<const M: usize, const Q: usize> Modes<M, Q> {
    /// Whether some mode has component `c`, one of the first nine.
    #[inline(always)]
    fn have(&self, c: usize) -> bool {
        self.components.contains(&c) || self.components.contains(&VOLUME) && c.is_multiple_of(4)
    }
}

/// See [`Modes::components`].
pub const VOLUME: usize = 9;

/// Derivatives of the shape functions by the parameters and weights of an integration rule.
pub(super) struct Rule<'a, const N: usize, const Q: usize> {
    pub gradients: &'a [Gradients<N>; Q],
    pub centre: &'a Gradients<N>,
    /// Thickness of an element without a third parameter, or 0.
    pub depth: f64,
}

/// What does not depend on the amplitudes.
struct Kinematics<const N: usize, const Q: usize> {
    /// Fh, inverse of J and weight of each point.
    points: [(Mat3, Mat3, f64); Q],
    /// x0: current base vectors of the centre.
    base: Mat3,
    /// J0^-1 j0/j of each point.
    enhancement: [Mat3; Q],
    volume: f64,
}

/// A solution of the equations of the amplitudes.
pub(super) struct Solution<const M: usize, const N: usize, const Q: usize> {
    pub points: [Point<N>; Q],
    responses: [Response; Q],
    /// Transposed F^-T J0^-T j0/j of each point: its row j is y_j, and h of component (i, j) is x_i y_j^T.
    duals: [Mat3; Q],
    /// x0.
    base: Mat3,
    /// Of K_mn.
    factor: Factor<M>,
    amplitudes: [f64; M],
    /// -K_mn^-1 r_n, the step that is left.
    step: [f64; M],
}

/// Most modes and most displacements of an element with enhanced strain.
const MODES: usize = 12;
const DISPLACEMENTS: usize = 24;

/// The amplitudes of an element near some displacements, to first order. Smaller elements leave entries unused.
#[derive(Clone, Debug)]
pub struct Amplitudes {
    pub(super) at: [f64; DISPLACEMENTS],
    /// alpha there.
    pub(super) values: [f64; MODES],
    /// d(alpha)/du = -K_mn^-1 K_na.
    pub(super) slopes: [[f64; DISPLACEMENTS]; MODES],
}

crate::words!(Amplitudes { at, values, slopes });

impl Default for Amplitudes {
    fn default() -> Self {
        Self { at: [0.0; DISPLACEMENTS], values: [0.0; MODES], slopes: [[0.0; DISPLACEMENTS]; MODES] }
    }
}

impl Amplitudes {
    /// At displacements `u`.
    #[inline(always)]
    pub(super) fn ahead<const M: usize, const N: usize>(&self, u: &[[f64; 3]; N]) -> [f64; M] {
        let mut by = [0.0; DISPLACEMENTS];
        by.iter_mut().zip(u.as_flattened()).zip(&self.at).for_each(|((by, u), at)| *by = u - at);
        std::array::from_fn(|m| self.values[m] + dot(&self.slopes[m], &by))
    }
}

/// How the amplitudes are sought.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// Newton's method downhill, to a minimum of the energy: where K_mn is not positive definite with a further stiffness,
    /// and never far past the least along a step.
    Descend,
    /// Newton's method with full steps, and in the initial stiffness h_m : (h_n tau) the stress that the last step foresaw:
    /// under the large pressures of a wrong volume (Magisano, Leonetti and Garcea, CMAME 313,
    /// 2017; Pfefferkorn, Bieber, Oesterle, Bischoff and Betsch, IJNME 122, 2021).
    Carry,
}

/// The ways, the last from zero, and the most iterations.
const WAYS: [(Way, usize); 3] = [(Way::Descend, 10), (Way::Carry, 25), (Way::Descend, 60)];
/// Most halvings of a step.
pub(super) const MOST_HALVINGS: usize = 12;
/// The iteration ends when the energy of its step is below this times shear modulus and volume: strains are then off by
/// 1e-8, forces by the square of that, as the step enters them.
pub(super) const TOLERANCE: f64 = 1e-16;

/// Deformation and response at given amplitudes.
struct Trial<const M: usize, const Q: usize> {
    f: [(Mat3, Mat3, f64); Q],
    responses: [Response; Q],
    duals: [Mat3; Q],
    residual: [f64; M],
    tangent: [[f64; M]; M],
}

/// Second Piola-Kirchhoff stress at each point, as a step foresaw it.
type Carried<const Q: usize> = [Mat3; Q];

impl<const N: usize, const Q: usize> Kinematics<N, Q> {
    #[inline(always)]
    fn new(x0: &[[f64; 3]; N], u: &[[f64; 3]; N], rule: &Rule<N, Q>) -> Self {
        let with_depth = |mut j: Mat3| {
            j[(2, 2)] += rule.depth;
            j
        };
        let reference = with_depth(jacobian(x0, rule.centre));
        let base = reference + jacobian(u, rule.centre);
        let (inverse0, det0) = inverse(&reference);
        let mut volume = 0.0;
        // All rules have points of weight 1 or, without a third parameter, 1 times the thickness.
        let each = std::array::from_fn(|q| {
            let (inverse, det) = inverse(&with_depth(jacobian(x0, &rule.gradients[q])));
            let f = Mat3::identity() + jacobian(u, &rule.gradients[q]) * inverse;
            volume += det;
            ((f, inverse, det), inverse0 * (det0 / det))
        });
        Self { points: each.map(|e| e.0), base, enhancement: each.map(|e| e.1), volume }
    }

    /// The part of a mode's amplitudes in E.
    #[inline(always)]
    fn enhanced<const M: usize>(modes: &Modes<M, Q>, q: usize, amplitudes: &[f64; M]) -> Mat3 {
        let mut e = Mat3::zeros();
        for m in 0..M {
            let value = amplitudes[m] * modes.amplitudes[q][m];
            match modes.components[m] {
                VOLUME => (0..3).for_each(|i| e[(i, i)] += value),
                c => e[(c / 3, c % 3)] += value,
            }
        }
        e
    }

    #[inline(always)]
    fn at<const M: usize>(
        &self,
        modes: &Modes<M, Q>,
        amplitudes: &[f64; M],
        medium: Medium,
        carried: Option<&Carried<Q>>,
    ) -> Result<Trial<M, Q>, Inverted> {
        let f: [(Mat3, Mat3, f64); Q] = std::array::from_fn(|q| {
            let f = self.points[q].0 + self.base * Self::enhanced(modes, q, amplitudes) * self.enhancement[q];
            let (inverse, det) = inverse(&f);
            (f, inverse, det)
        });
        let worst = f.iter().fold(f64::INFINITY, |worst, f| if f.2 < worst || f.2.is_nan() { f.2 } else { worst });
        if worst.is_nan() || worst <= 0.0 {
            return Err(Inverted { det_f: worst });
        }
        let mut trial = Trial {
            f,
            responses: [Response { kirchhoff: [0.0; 6], tangent: [[0.0; 6]; 6] }; Q],
            duals: [Mat3::zeros(); Q],
            residual: [0.0; M],
            tangent: [[0.0; M]; M],
        };
        for q in 0..Q {
            let (f, f_inverse, det_f) = &trial.f[q];
            let response = medium.material.response(f, medium.state(q)).ok_or(Inverted { det_f: *det_f })?;
            let duals = self.enhancement[q] * f_inverse;
            let (weight, amplitudes) = (self.points[q].2, &modes.amplitudes[q]);
            // h of the nine components and of the unit tensor, and their stresses.
            let mut h = [Mat3::zeros(); 10];
            let mut rate = [Mat3::zeros(); 10];
            let tau = to_matrix(&response.kirchhoff);
            let initial = carried.map_or(tau, |carried| f * carried[q] * f.transpose());
            for c in 0..9 {
                if modes.have(c) {
                    h[c] = self.base.column(c / 3) * duals.row(c % 3);
                    rate[c] = stress_rate_of(&h[c], &initial, &response.tangent);
                }
            }
            h[VOLUME] = h[0] + h[4] + h[8];
            rate[VOLUME] = rate[0] + rate[4] + rate[8];
            for m in 0..M {
                let (c, factor) = (modes.components[m], weight * amplitudes[m]);
                trial.residual[m] += factor * tau.dot(&h[c]);
                for n in 0..=m {
                    trial.tangent[m][n] += factor * amplitudes[n] * h[modes.components[n]].dot(&rate[c]);
                }
            }
            trial.responses[q] = response;
            trial.duals[q] = duals;
        }
        Ok(trial)
    }

    /// The stress that a step foresees.
    #[cold]
    fn carry<const M: usize>(&self, modes: &Modes<M, Q>, trial: &Trial<M, Q>, step: &[f64; M]) -> Carried<Q> {
        std::array::from_fn(|q| {
            let (response, inverse) = (&trial.responses[q], &trial.f[q].1);
            let h = self.base * Self::enhanced(modes, q, step) * trial.duals[q];
            let rate = stress_rate_of(&h, &Mat3::zeros(), &response.tangent);
            inverse * (to_matrix(&response.kirchhoff) + rate) * inverse.transpose()
        })
    }

    /// A step downhill where K_mn is not positive definite, as under a large pressure far from the solution: with the size
    /// of the stress, or some times more of it, as a further stiffness against h.
    #[cold]
    fn convex_step<const M: usize>(&self, modes: &Modes<M, Q>, trial: &Trial<M, Q>) -> [f64; M] {
        let mut gram = [[0.0; M]; M];
        for q in 0..Q {
            let stress = to_matrix(&trial.responses[q].kirchhoff).norm();
            let factor = self.points[q].2 * stress;
            let h: [Mat3; M] = std::array::from_fn(|m| {
                let unit = std::array::from_fn(|n| if n == m { 1.0 } else { 0.0 });
                self.base * Self::enhanced(modes, q, &unit) * trial.duals[q]
            });
            for (m, n) in (0..M).flat_map(|m| (0..=m).map(move |n| (m, n))) {
                gram[m][n] += factor * h[m].dot(&h[n]);
            }
        }
        for times in [1.0, 4.0, 16.0, 64.0, 256.0] {
            let stiffer = std::array::from_fn(|m| std::array::from_fn(|n| trial.tangent[m][n] + times * gram[m][n]));
            if let Some(factor) = Factor::new(&stiffer).filter(Factor::positive) {
                return factor.solve(&trial.residual).map(|s| -s);
            }
        }
        [f64::NAN; M]
    }
}

/// c : h + h tau.
#[inline(always)]
fn stress_rate_of(h: &Mat3, tau: &Mat3, tangent: &[[f64; 6]; 6]) -> Mat3 {
    let d = [h[(0, 0)], h[(1, 1)], h[(2, 2)], h[(0, 1)] + h[(1, 0)], h[(1, 2)] + h[(2, 1)], h[(2, 0)] + h[(0, 2)]];
    let mut stress = [0.0; 6];
    for v in 0..6 {
        for w in 0..6 {
            stress[v] += tangent[v][w] * d[w];
        }
    }
    to_matrix(&stress) + h * tau
}

/// Finds the amplitudes of the modes.
#[inline(always)]
pub(super) fn solve<const M: usize, const N: usize, const Q: usize>(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    rule: &Rule<N, Q>,
    modes: &Modes<M, Q>,
    medium: Medium,
) -> Result<Solution<M, N, Q>, Inverted> {
    let kinematics = Kinematics::new(x0, u, rule);
    let enough = TOLERANCE * medium.material.initial_moduli().1 * kinematics.volume;
    let known = medium.amplitudes.map_or([0.0; M], |known| known.ahead(u));
    let mut failure = Inverted { det_f: f64::NAN };
    for ((way, most), mut amplitudes) in WAYS.into_iter().zip([known, known, [0.0; M]]) {
        let mut state = match kinematics.at(modes, &amplitudes, medium, None) {
            Ok(state) => state,
            Err(inverted) => {
                failure = inverted;
                continue;
            }
        };
        for _ in 0..most {
            let step = match Factor::new(&state.tangent) {
                Some(factor) if factor.energy(&state.residual) <= enough => {
                    let step = factor.solve(&state.residual).map(|s| -s);
                    return Ok(finish(kinematics, rule, modes, &amplitudes, state, (factor, step)));
                }
                Some(factor) if way == Way::Carry || factor.positive() => factor.solve(&state.residual).map(|s| -s),
                _ if way == Way::Carry => break,
                _ => kinematics.convex_step(modes, &state),
            };
            let slope = dot(&step, &state.residual);
            let mut size = 1.0;
            let accepted = (0..MOST_HALVINGS).find_map(|_| {
                let part = step.map(|s| size * s);
                size *= 0.5;
                let tried: [f64; M] = std::array::from_fn(|m| amplitudes[m] + part[m]);
                let carried = (way == Way::Carry).then(|| kinematics.carry(modes, &state, &part));
                let trial = kinematics.at(modes, &tried, medium, carried.as_ref());
                let trial = trial.map_err(|inverted| failure = inverted).ok()?;
                let better = way == Way::Carry || dot(&step, &trial.residual) <= -0.5 * slope;
                better.then_some((tried, trial))
            });
            let Some(accepted) = accepted else { break };
            (amplitudes, state) = accepted;
        }
    }
    Err(failure)
}

pub(super) fn dot<const M: usize>(a: &[f64; M], b: &[f64; M]) -> f64 {
    (0..M).map(|m| a[m] * b[m]).sum()
}

#[inline(always)]
fn finish<const M: usize, const N: usize, const Q: usize>(
    kinematics: Kinematics<N, Q>,
    rule: &Rule<N, Q>,
    modes: &Modes<M, Q>,
    amplitudes: &[f64; M],
    state: Trial<M, Q>,
    (factor, step): (Factor<M>, [f64; M]),
) -> Solution<M, N, Q> {
    let points = std::array::from_fn(|q| {
        let (f, f_inverse, det_f) = state.f[q];
        let of_shape = kinematics.points[q].1 * f_inverse;
        let of_modes = Kinematics::<N, Q>::enhanced(modes, q, amplitudes) * state.duals[q];
        let mut gradients = [[0.0; N]; 3];
        for j in 0..3 {
            for m in 0..3 {
                add_scaled(&mut gradients[j], of_shape[(m, j)], &rule.gradients[q][m]);
                add_scaled(&mut gradients[j], of_modes[(m, j)], &rule.centre[m]);
            }
        }
        Point { gradients, f, det_f, weight: kinematics.points[q].2 }
    });
    let (amplitudes, base) = (*amplitudes, kinematics.base);
    Solution { points, responses: state.responses, duals: state.duals, factor, amplitudes, step, base }
}

/// Internal forces and, if wanted, the symmetric tangent.
#[inline(always)]
pub(super) fn evaluate<const M: usize, const N: usize, const Q: usize, const D: usize>(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    rule: &Rule<N, Q>,
    modes: &Modes<M, Q>,
    (medium, want_tangent): (Medium, bool),
    out: &mut ElementMatrices<D>,
) -> Result<(), Inverted> {
    const { assert!(D == 3 * N) };
    let Solution { points, responses, duals, factor, amplitudes, step, base } = &solve(x0, u, rule, modes, medium)?;
    let mut force = [[0.0; N]; 3];
    let mut coupling = [[[0.0; N]; 3]; M];
    for q in 0..Q {
        let (point, response) = (&points[q], &responses[q]);
        add_force(point, &response.kirchhoff, &mut force);
        let tau = to_matrix(&response.kirchhoff);
        let mut of_component = [[[0.0; N]; 3]; 10];
        for c in 0..9 {
            if modes.have(c) {
                let dual = duals[q].row(c % 3);
                let rate = stress_rate_of(&(base.column(c / 3) * dual), &tau, &response.tangent);
                let of_base = dual * tau;
                for i in 0..3 {
                    (0..3).for_each(|j| add_scaled(&mut of_component[c][i], rate[(i, j)], &point.gradients[j]));
                    add_scaled(&mut of_component[c][i], of_base[i], &rule.centre[c / 3]);
                }
            }
        }
        for m in 0..M {
            let factor = point.weight * modes.amplitudes[q][m];
            let parts: &[usize] = match &modes.components[m] {
                &VOLUME => &[0, 4, 8],
                c => std::slice::from_ref(c),
            };
            for &c in parts {
                (0..3).for_each(|i| add_scaled(&mut coupling[m][i], factor, &of_component[c][i]));
            }
        }
    }
    for m in 0..M {
        (0..3).for_each(|i| add_scaled(&mut force[i], step[m], &coupling[m][i]));
    }
    for a in 0..N {
        (0..3).for_each(|i| out.residual[3 * a + i] = force[i][a]);
    }
    if !want_tangent {
        return Ok(());
    }

    let mut rates = [[[[[0.0; N]; 3]; Q]; 3]; 3];
    for (q, (point, response)) in points.iter().zip(responses).enumerate() {
        for i in 0..3 {
            for k in i..3 {
                stress_rate(point, &response.kirchhoff, &response.tangent, i, k, &mut rates[i][k][q]);
            }
        }
    }
    contract(points, &rates, true, &mut out.tangent);
    // With K_mn = L D L^T the condensation subtracts C^T D^-1 C, C = L^-1 K_ma.
    for m in 0..M {
        let (done, rest) = coupling.split_at_mut(m);
        for n in 0..m {
            (0..3).for_each(|i| add_scaled(&mut rest[0][i], -factor.lower[m][n], &done[n][i]));
        }
    }
    for (i, k) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
        for a in 0..N {
            let mut row = [0.0; N];
            for (c, pivot) in coupling.iter().zip(factor.diagonal) {
                add_scaled(&mut row, c[i][a] / pivot, &c[k]);
            }
            for b in if i == k { a } else { 0 }..N {
                out.tangent[3 * a + i][3 * b + k] -= row[b];
                out.tangent[3 * b + k][3 * a + i] = out.tangent[3 * a + i][3 * b + k];
            }
        }
    }
    // -K_mn^-1 K_na = -L^-T D^-1 C.
    let Amplitudes { at, values, slopes } = &mut out.amplitudes;
    at[..D].copy_from_slice(u.as_flattened());
    for m in (0..M).rev() {
        values[m] = amplitudes[m] + step[m];
        let (row, done) = slopes[m..].split_first_mut().expect("at most as many modes");
        for k in 0..D {
            let rest: f64 = (m + 1..M).map(|n| factor.lower[n][m] * done[n - m - 1][k]).sum();
            row[k] = -coupling[m][k % 3][k / 3] / factor.diagonal[m] - rest;
        }
    }
    Ok(())
}

/// The integration points.
#[inline(always)]
pub(super) fn samples<const M: usize, const N: usize, const Q: usize>(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    rule: &Rule<N, Q>,
    modes: &Modes<M, Q>,
    medium: Medium,
) -> Result<[Sample; Q], Inverted> {
    let solution = solve(x0, u, rule, modes, medium)?;
    let mut samples = solution.points.map(|point| point.sample());
    for (q, sample) in samples.iter_mut().enumerate() {
        let last = Kinematics::<N, Q>::enhanced(modes, q, &solution.step);
        sample.f += solution.base * last * solution.duals[q] * sample.f;
        sample.det_f = sample.f.determinant();
    }
    Ok(samples)
}

/// L D L^T of a symmetric matrix, of which the lower half is read.
pub(super) struct Factor<const M: usize> {
    pub lower: [[f64; M]; M],
    pub diagonal: [f64; M],
}

impl<const M: usize> Factor<M> {
    /// `None` if a pivot nearly vanishes.
    pub fn new(matrix: &[[f64; M]; M]) -> Option<Self> {
        let (mut lower, mut diagonal) = ([[0.0; M]; M], [0.0; M]);
        for i in 0..M {
            for j in 0..=i {
                let sum = matrix[i][j] - (0..j).map(|k| lower[i][k] * diagonal[k] * lower[j][k]).sum::<f64>();
                if i > j {
                    lower[i][j] = sum / diagonal[j];
                } else {
                    diagonal[i] = sum;
                }
            }
            if diagonal[i].is_nan() || diagonal[i].abs() <= 1e-12 * matrix[i][i].abs() {
                return None;
            }
        }
        Some(Self { lower, diagonal })
    }

    /// Whether the matrix is positive definite.
    pub fn positive(&self) -> bool {
        self.diagonal.iter().all(|&d| d > 0.0)
    }

    pub fn solve(&self, right: &[f64; M]) -> [f64; M] {
        let mut x = *right;
        self.forward(&mut x);
        (0..M).for_each(|i| x[i] /= self.diagonal[i]);
        for i in (0..M).rev() {
            x[i] -= (i + 1..M).map(|k| self.lower[k][i] * x[k]).sum::<f64>();
        }
        x
    }

    /// Of the step that `right` asks for, counting all its parts as positive.
    pub fn energy(&self, right: &[f64; M]) -> f64 {
        let mut x = *right;
        self.forward(&mut x);
        (0..M).map(|i| x[i] * x[i] / self.diagonal[i].abs()).sum()
    }

    fn forward(&self, x: &mut [f64; M]) {
        for i in 0..M {
            x[i] -= (0..i).map(|k| self.lower[i][k] * x[k]).sum::<f64>();
        }
    }
}
