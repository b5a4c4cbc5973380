//! Elements: internal forces and tangent of one element from its nodes, its displacements and its [`Medium`].
//!
//! With reference coordinates X, displacements u, x = X + u and shape functions N_a, at every integration point
//!
//! ```text
//! F    = 1 + sum_a u_a (dN_a/dX)^T,     g_a = dN_a/dx = F^-T dN_a/dX
//! R_a  = int tau g_a dV                                                           internal force on node a
//! K_ab = int B_a^T c B_b dV + int (g_a . tau g_b) 1 dV = dR_a/du_b
//! ```
//!
//! V is the reference volume, tau and c are of [`super::material`]. In components, with the spatial tangent and the
//! initial stress in one fourth-order tensor, K_aibk = int g_aj (c_ijkl + delta_ik tau_jl) g_bl dV. (Bonet and Wood,
//! Nonlinear Continuum Mechanics for Finite Element Analysis; de Souza Neto, Peric and Owen, Computational Methods
//! for Plasticity.)
//!
//! Forces and tangents are node-major: entry 3 a + i is direction i of node a. Elements have a positive Jacobian in the
//! reference state; [`hex8::min_jacobian`], [`hex27::min_jacobian`], [`wedge6::min_jacobian`], [`wedge18::min_jacobian`], [`pyramid5::min_jacobian`], [`tet10::min_jacobian`] and
//! [`tet4::volume`] tell.
//!
//! Nothing here changes a state: elements are evaluated from the states of the last accepted increment, and [`advance`]
//! makes the new ones when an increment is accepted. Each element gives its integration points as [`Sample`]s, over which
//! stresses, energies and states are summed alike for all.

mod enhanced;
mod formulation;
pub mod hex27;
pub mod hex8;
pub mod hex8_eas;
pub mod hex8_fbar;
pub mod hex8_shell;
pub mod hex8_sri;
mod mixed;
mod parameters;
pub mod plane4;
pub mod pyramid5;
pub mod pyramid5_sri;
pub mod ring4;
pub mod tet10;
pub mod tet10_sri;
pub mod tet4;
pub mod wedge18;
pub mod wedge18_sri;
pub mod wedge6;
pub mod wedge6_sri;

use super::material::{Material, State};
use super::voigt::{INDEX, Voigt, logarithmic_strain};
use crate::Mat3;
pub use enhanced::Amplitudes;
pub use formulation::Formulation;

/// Internal forces of an element with D degrees of freedom, and their derivative.
#[derive(Clone, Debug)]
pub struct ElementMatrices<const D: usize> {
    /// R, force.
    pub residual: [f64; D],
    /// K\[row\]\[column\], full, force per length.
    pub tangent: [[f64; D]; D],
    /// Of the enhanced strain, where there is any; set with the tangent.
    pub amplitudes: Amplitudes,
}

impl<const D: usize> Default for ElementMatrices<D> {
    fn default() -> Self {
        Self { residual: [0.0; D], tangent: [[0.0; D]; D], amplitudes: Amplitudes::default() }
    }
}

/// An element is turned inside out at an integration point, or its displacements are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverted {
    /// The smallest det F of the element; NaN when displacements are not finite.
    pub det_f: f64,
}

/// What fills an element: its material, how each integration point has flowed until the last accepted increment, and where
/// the search for the enhanced strain begins.
#[derive(Clone, Copy, Debug)]
pub struct Medium<'a> {
    pub material: &'a Material,
    /// One for each integration point; none for a material without memory, and where nothing has flowed yet.
    pub states: &'a [State],
    /// Of the enhanced strain, where some are known.
    pub amplitudes: Option<&'a Amplitudes>,
}

impl<'a> Medium<'a> {
    /// A material that has not flowed.
    pub fn virgin(material: &'a Material) -> Self {
        Self { material, states: &[], amplitudes: None }
    }

    /// The state of an integration point.
    #[inline(always)]
    pub fn state(&self, point: usize) -> &'a State {
        self.states.get(point).unwrap_or(&State::VIRGIN)
    }
}

/// An integration point as the material sees it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The deformation gradient.
    pub f: Mat3,
    /// Its determinant, positive.
    pub det_f: f64,
    /// What multiplies the Kirchhoff stress: the reference volume of the point, in standard elements.
    pub weight: f64,
}

/// Derivatives of N shape functions: `[j][a]` is dN_a by coordinate j.
type Gradients<const N: usize> = [[f64; N]; 3];

/// An integration point of a deformed element.
struct Point<const N: usize> {
    /// g\[j\]\[a\] = dN_a/dx_j.
    gradients: Gradients<N>,
    /// The deformation gradient that the material sees.
    f: Mat3,
    /// Its determinant, positive.
    det_f: f64,
    /// What multiplies tau: the reference volume of the point, in standard elements.
    weight: f64,
}

/// 1/sqrt(3): the points of the Gauss rule of two points, both of weight 1, stand at plus and minus it.
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;

/// The integration points of the element; `gradients` are those by the parameters, `weight` is the quadrature weight of
/// each. An element without a third parameter has the thickness `depth` along z; others give 0.
#[inline(always)]
fn deform<const N: usize, const Q: usize>(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    gradients: &[Gradients<N>; Q],
    weight: f64,
    depth: f64,
) -> Result<[Point<N>; Q], Inverted> {
    let mut worst = f64::INFINITY;
    let points = std::array::from_fn(|q| {
        let (mut reference, moved) = (jacobian(x0, &gradients[q]), jacobian(u, &gradients[q]));
        reference[(2, 2)] += depth;
        let (inverse0, det0) = inverse(&reference);
        let (inverse, det) = inverse(&(reference + moved));
        let mut g = [[0.0; N]; 3];
        for j in 0..3 {
            for m in 0..3 {
                add_scaled(&mut g[j], inverse[(m, j)], &gradients[q][m]);
            }
        }
        let det_f = det / det0;
        if det_f < worst || det_f.is_nan() {
            worst = det_f;
        }
        Point { gradients: g, f: Mat3::identity() + moved * inverse0, det_f, weight: weight * det0 }
    });
    if worst > 0.0 { Ok(points) } else { Err(Inverted { det_f: worst }) }
}

/// F-bar: gives the points the volume change of `centre`, and weights dV J/J0 (see [`hex8_fbar`]).
#[inline(always)]
fn use_volume_of<const N: usize>(centre: &Point<N>, points: &mut [Point<N>]) {
    for point in points {
        let ratio = centre.det_f / point.det_f;
        point.take_volume(centre.det_f);
        point.weight /= ratio;
    }
}

/// Derivative of the position by the parameters, `(i, m)` = dx_i/dxi_m, where nodes are at `x`.
#[inline(always)]
fn jacobian<const N: usize>(x: &[[f64; 3]; N], gradients: &Gradients<N>) -> Mat3 {
    let mut sum = Mat3::zeros();
    for a in 0..N {
        for m in 0..3 {
            (0..3).for_each(|i| sum[(i, m)] += x[a][i] * gradients[m][a]);
        }
    }
    sum
}

/// Inverse and determinant.
#[inline(always)]
fn inverse(m: &Mat3) -> (Mat3, f64) {
    let (a, b, c) = (m.column(0), m.column(1), m.column(2));
    let bc = b.cross(&c);
    let det = a.dot(&bc);
    (Mat3::from_columns(&[bc / det, c.cross(&a) / det, a.cross(&b) / det]).transpose(), det)
}

/// Internal forces and, when wanted, the tangent. `centre` are the gradients at the element's centre for F-bar.
#[inline(always)]
fn integrate<const N: usize, const Q: usize, const D: usize>(
    points: &[Point<N>; Q],
    centre: Option<&Gradients<N>>,
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<D>,
) -> Result<(), Inverted> {
    const { assert!(D == 3 * N) };
    let mut force = [[0.0; N]; 3];
    if want_tangent {
        let mut rates = [[[[[0.0; N]; 3]; Q]; 3]; 3];
        for (q, point) in points.iter().enumerate() {
            let response =
                medium.material.response(&point.f, medium.state(q)).ok_or(Inverted { det_f: point.det_f })?;
            add_force(point, &response.kirchhoff, &mut force);
            for i in 0..3 {
                for k in if centre.is_some() { 0 } else { i }..3 {
                    stress_rate(point, &response.kirchhoff, &response.tangent, i, k, &mut rates[i][k][q]);
                }
            }
            if let Some(centre) = centre {
                add_volume_rate(point, centre, &response.kirchhoff, &response.tangent, q, &mut rates);
            }
        }
        contract(points, &rates, centre.is_none(), &mut out.tangent);
    } else {
        for (q, point) in points.iter().enumerate() {
            let kirchhoff =
                medium.material.kirchhoff(&point.f, medium.state(q)).ok_or(Inverted { det_f: point.det_f })?;
            add_force(point, &kirchhoff, &mut force);
        }
    }
    for a in 0..N {
        (0..3).for_each(|i| out.residual[3 * a + i] = force[i][a]);
    }
    Ok(())
}

/// y = y + a x. All sums over nodes go through here: a loop of known length over arrays, which becomes vector instructions.
#[inline(always)]
fn add_scaled<const N: usize>(y: &mut [f64; N], a: f64, x: &[f64; N]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// Adds weight tau_ij g_aj.
#[inline(always)]
fn add_force<const N: usize>(point: &Point<N>, kirchhoff: &Voigt, force: &mut [[f64; N]; 3]) {
    for i in 0..3 {
        for j in 0..3 {
            let stress = point.weight * kirchhoff[INDEX[i][j]];
            add_scaled(&mut force[i], stress, &point.gradients[j]);
        }
    }
}

/// `rate[j][b]` = weight (c_ijkl + delta_ik tau_jl) g_bl: how the stress on the nodes moves with node b in direction k.
#[inline(always)]
fn stress_rate<const N: usize>(
    point: &Point<N>,
    kirchhoff: &Voigt,
    tangent: &[Voigt; 6],
    i: usize,
    k: usize,
    rate: &mut Gradients<N>,
) {
    for j in 0..3 {
        for l in 0..3 {
            let initial = if i == k { kirchhoff[INDEX[j][l]] } else { 0.0 };
            let factor = point.weight * (tangent[INDEX[i][j]][INDEX[k][l]] + initial);
            add_scaled(&mut rate[j], factor, &point.gradients[l]);
        }
    }
}

/// The F-bar term of [`hex8_fbar`]: adds weight q_ij (g0_bk - g_bk).
#[inline(always)]
fn add_volume_rate<const N: usize, const Q: usize>(
    point: &Point<N>,
    centre: &Gradients<N>,
    kirchhoff: &Voigt,
    tangent: &[Voigt; 6],
    q: usize,
    rates: &mut [[[Gradients<N>; Q]; 3]; 3],
) {
    for i in 0..3 {
        for j in 0..3 {
            let v = INDEX[i][j];
            let factor = point.weight * (tangent[v][0] + tangent[v][1] + tangent[v][2] - kirchhoff[v]) / 3.0;
            for k in 0..3 {
                add_scaled(&mut rates[i][k][q][j], factor, &centre[k]);
                add_scaled(&mut rates[i][k][q][j], -factor, &point.gradients[k]);
            }
        }
    }
}

/// K_aibk = sum over points and j of g_aj rates_ikj_b: one product of an N x 3Q with a 3Q x N matrix for each pair of
/// directions; with symmetry for pairs i <= k alone.
#[inline(always)]
fn contract<const N: usize, const Q: usize, const D: usize>(
    points: &[Point<N>; Q],
    rates: &[[[Gradients<N>; Q]; 3]; 3],
    symmetric: bool,
    tangent: &mut [[f64; D]; D],
) {
    for i in 0..3 {
        for k in if symmetric { i } else { 0 }..3 {
            for a in 0..N {
                let mut row = [0.0; N];
                for (point, rate) in points.iter().zip(&rates[i][k]) {
                    for j in 0..3 {
                        add_scaled(&mut row, point.gradients[j][a], &rate[j]);
                    }
                }
                for b in 0..N {
                    tangent[3 * a + i][3 * b + k] = row[b];
                    if symmetric {
                        tangent[3 * b + k][3 * a + i] = row[b];
                    }
                }
            }
        }
    }
}

impl<const N: usize> Point<N> {
    /// Gives it another change of volume.
    #[inline(always)]
    fn take_volume(&mut self, det_f: f64) {
        self.f *= (det_f / self.det_f).cbrt();
        self.det_f = det_f;
    }

    fn sample(&self) -> Sample {
        Sample { f: self.f, det_f: self.det_f, weight: self.weight }
    }
}

impl Sample {
    fn inverted(&self) -> Inverted {
        Inverted { det_f: self.det_f }
    }

    fn volume(&self) -> f64 {
        self.weight * self.det_f
    }
}

/// Cauchy stress averaged over the current volume.
pub fn average_stress(samples: &[Sample], medium: Medium) -> Result<Voigt, Inverted> {
    let (mut sum, mut volume) = ([0.0; 6], 0.0);
    for (q, sample) in samples.iter().enumerate() {
        let kirchhoff = medium.material.kirchhoff(&sample.f, medium.state(q)).ok_or(sample.inverted())?;
        (0..6).for_each(|v| sum[v] += sample.weight * kirchhoff[v]);
        volume += sample.volume();
    }
    Ok(sum.map(|s| s / volume))
}

/// Spatial logarithmic strain averaged over the current volume.
pub fn average_strain(samples: &[Sample]) -> Voigt {
    let (mut sum, mut volume) = ([0.0; 6], 0.0);
    for sample in samples {
        let strain = logarithmic_strain(&sample.f);
        (0..6).for_each(|v| sum[v] += sample.volume() * strain[v]);
        volume += sample.volume();
    }
    sum.map(|s| s / volume)
}

/// Stored energy.
pub fn stored_energy(samples: &[Sample], medium: Medium) -> Result<f64, Inverted> {
    samples.iter().enumerate().try_fold(0.0, |sum, (q, sample)| {
        let energy = medium.material.energy(&sample.f, medium.state(q)).ok_or(sample.inverted())?;
        Ok(sum + sample.weight * energy)
    })
}

/// Work of the stress on plastic strain until now.
pub fn plastic_work(samples: &[Sample], medium: Medium) -> f64 {
    let work = |(q, sample): (usize, &Sample)| sample.weight * medium.material.plastic_work(medium.state(q));
    samples.iter().enumerate().map(work).sum()
}

/// Equivalent plastic strain averaged over the current volume.
pub fn average_plastic_strain(samples: &[Sample], states: &[State]) -> f64 {
    let sum: f64 = samples.iter().zip(states).map(|(sample, state)| sample.volume() * state.equivalent).sum();
    sum / samples.iter().map(Sample::volume).sum::<f64>()
}

/// Makes the states those that the material has at the samples. After an error they are undefined.
pub fn advance(samples: &[Sample], material: &Material, states: &mut [State]) -> Result<(), Inverted> {
    for (sample, state) in samples.iter().zip(states) {
        *state = material.flow(&sample.f, state).ok_or(sample.inverted())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_on_fillers;
#[cfg(test)]
mod tests_on_hex27;
#[cfg(test)]
mod tests_on_pyramids;
#[cfg(test)]
mod tests_on_wedge18;
#[cfg(test)]
mod tests_on_wedges;
