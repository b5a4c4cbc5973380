//! Plasticity at finite strain, multiplicative: F = Fe Fp (Lee, J. Appl. Mech. 36, 1969).
//!
//! With the elastic strain Ee = 1/2 ln Fe^T Fe and its conjugate stress T ([`super::logarithmic`]) the law is that of small
//! strains (Eterovic and Bathe, Int. J. Numer. Methods Eng. 30, 1990; Simo, CMAME 99, 1992):
//!
//! ```text
//! T   = K tr(Ee) 1 + 2 mu dev Ee
//! s^2 = T : P : T      s, the equivalent stress; P of von Mises or of Hill (Proc. R. Soc. A 193, 1948):
//!       F (Tyy - Tzz)^2 + G (Tzz - Txx)^2 + H (Txx - Tyy)^2 + 2 L Tyz^2 + 2 M Tzx^2 + 2 N Txy^2
//! s  <= Y(e)           Y, the yield stress by the equivalent plastic strain e ([`super::hardening`])
//! Fp' Fp^-1 = e' P : T / s         associated flow, without plastic spin
//! ```
//!
//! In an increment the strain adds to that of its beginning, with Dp the integral of Fp' Fp^-1:
//!
//! ```text
//! F*  = F Fp^-1,   E* = 1/2 ln F*^T F* = Ee + Dp,   Fp^-1 at the end = Fp^-1 exp(-E*) exp(Ee)
//! ```
//!
//! So stress and tangent of an increment are those of an elastic law in E*, which has a potential (Miehe, Apel and Lambrecht,
//! CMAME 191, 2002), and Ee is at its end what it is at the beginning of the next. By von Mises E* is coaxial with Ee and the
//! last is Fp^-1 exp(-Dp); by Hill the spin that is left is of the size of [Ee, Dp]. Strains that add from the beginning on,
//! instead, bear too little in shear: 3 % at 1, 17 at 2.
//!
//! Axes of the material turn with Fe. An increment is integrated by the implicit Euler method. P has fixed eigentensors v_i,
//! without trace, with eigenvalues p_i, so that the stress relaxes in each by itself, and one unknown is left, y in [0, 1):
//!
//! ```text
//! T_i = m_i T*_i,   m_i = (1 - y) / (1 - y + y q_i),   q_i = 2 p_i / 3         T*, the stress if nothing flowed
//! s   = (1 - y) S,  De = y S / (3 mu),                 S^2 = sum_i p_i (T*_i / (1 - y + y q_i))^2
//! 0   = s - Y(e + De)
//! ```
//!
//! The right-hand side falls all the way from s* - Y > 0 at y = 0 to -Y(e + De) < 0 at y = 1: there is one solution for any
//! increment, and Newton's method with that bracket finds it. For von Mises' P all q_i are 1, and it is the radial return.
//! The tangent of the increment,
//!
//! ```text
//! D = K 1 x 1 + 2 mu [ sum_i m_i v_i x v_i - k N x N ],     N = sum_i p_i T_i m_i / s v_i
//! k = a s / (a R + Y' s / 2 mu),     a = 1 - Y' De / s,     R = sum_i p_i^2 m_i T_i^2 / s
//! ```
//!
//! is symmetric. A point that stands at its yield limit, as after any increment in which it flowed, is taken to flow on. Both
//! tangents are right there, and in forming this is the one that the next increment needs. Where a step begins or a table
//! turns it is taken to rest, with D of an elastic point: where a structure softens, a force that is eased is in equilibrium
//! on the way on, too, and which way Newton's method goes is up to its first iteration.

use super::logarithmic::LogarithmicStrain;
use super::model::{Hardening, Hill};
use super::{Response, State};
use crate::Mat3;
use crate::solid::voigt::{IDENTITY, Voigt, add_square, double_contraction, exponential, mirror, to_matrix};

/// An elastic-plastic material.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// Bulk modulus.
    bulk: f64,
    pub mu: f64,
    /// Columns are the axes of the material.
    axes: Mat3,
    /// Eigentensors of P, tensor components by the axes.
    modes: [Voigt; 5],
    /// Their eigenvalues.
    squares: [f64; 5],
    hardening: Hardening,
}

/// A point of the material after an increment.
struct Flow {
    /// tr E*.
    volume_strain: f64,
    /// T*_i.
    trial: [f64; 5],
    /// y; 0 without flow.
    y: f64,
    /// De, of the equivalent plastic strain.
    increment: f64,
    /// Whether it flows, or would at once.
    yields: bool,
}

/// Yield stress over itself by which a stress may be below it and still be at it: above rounding, which is that of a strain over
/// the elastic one, and below what a residual within the tolerance leaves, or a part that is only turned, all of it at its limit,
/// goes to and fro with tangents of flow where it rests.
const AT_LIMIT: f64 = 1e-11;

/// Excess over the stress from which a root is not found yet, well above rounding.
const STEEP: f64 = 1e-12;

/// After so many iterations of Newton's method the interval is halved; together far more than any case takes.
const NEWTON: usize = 40;
const HALVINGS: usize = 60;

impl Plastic {
    /// With Lame's constants, and Hill's criterion or that of von Mises.
    pub fn new((lambda, mu): (f64, f64), hill: Option<&Hill>, hardening: Hardening) -> Self {
        const MISES: [f64; 6] = [0.5, 0.5, 0.5, 1.5, 1.5, 1.5];
        let (modes, squares) = modes(&hill.map_or(MISES, |hill| hill.coefficients));
        let axes = hill.map_or_else(Mat3::identity, |hill| hill.axes);
        Self { bulk: lambda + 2.0 / 3.0 * mu, mu, axes, modes, squares, hardening }
    }

    /// Lame's first constant.
    pub fn lambda(&self) -> f64 {
        self.bulk - 2.0 / 3.0 * self.mu
    }

    /// Stress and tangent.
    pub fn response(&self, f: &Mat3, before: &State) -> Option<Response> {
        let strain = self.strain(f, before)?;
        let flow = self.relax(&strain.strain, before);
        let stress = self.stress(&flow);
        let moduli = self.moduli(&flow, before.equivalent);
        let axes = strain.axes();
        Some(Response { kirchhoff: axes.kirchhoff(&stress), tangent: axes.tangent(&stress, &moduli) })
    }

    /// Kirchhoff stress.
    pub fn kirchhoff(&self, f: &Mat3, before: &State) -> Option<Voigt> {
        let strain = self.strain(f, before)?;
        Some(strain.axes().kirchhoff(&self.stress(&self.relax(&strain.strain, before))))
    }

    /// The state at the end of the increment.
    pub fn flow(&self, f: &Mat3, before: &State) -> Option<State> {
        let strain = self.strain(f, before)?.strain;
        let flow = self.relax(&strain, before);
        let mut state = State { rests: false, ..*before };
        if flow.increment > 0.0 {
            state.equivalent += flow.increment;
            let mut elastic = strain;
            for i in 0..5 {
                let share = flow.trial[i] * (1.0 - self.kept(&flow, i)) / (2.0 * self.mu);
                (0..6).for_each(|v| elastic[v] -= share * self.modes[i][v]);
            }
            let [back, forth] = [strain.map(|s| -s), elastic].map(|strain| to_matrix(&exponential(&strain)));
            state.inverse_plastic *= back * forth;
        }
        Some(state)
    }

    /// Stored energy per reference volume.
    pub fn energy(&self, f: &Mat3, before: &State) -> Option<f64> {
        let flow = self.relax(&self.strain(f, before)?.strain, before);
        let shear: f64 = (0..5).map(|i| (self.kept(&flow, i) * flow.trial[i]).powi(2)).sum();
        Some(0.5 * self.bulk * flow.volume_strain * flow.volume_strain + 0.25 * shear / self.mu)
    }

    /// Plastic work per reference volume.
    pub fn plastic_work(&self, state: &State) -> f64 {
        self.hardening.work(state.equivalent)
    }

    /// E* by the material's axes.
    fn strain(&self, f: &Mat3, before: &State) -> Option<LogarithmicStrain> {
        LogarithmicStrain::new(f * self.axes * before.inverse_plastic)
    }

    /// m_i.
    fn kept(&self, flow: &Flow, i: usize) -> f64 {
        let left = 1.0 - flow.y;
        left / (left + flow.y * self.squares[i] / 1.5)
    }

    /// T.
    fn stress(&self, flow: &Flow) -> Voigt {
        let mut stress = IDENTITY.map(|one| self.bulk * flow.volume_strain * one);
        for i in 0..5 {
            let value = self.kept(flow, i) * flow.trial[i];
            (0..6).for_each(|v| stress[v] += value * self.modes[i][v]);
        }
        stress
    }

    /// Integrates an increment that ends at a strain.
    fn relax(&self, strain: &Voigt, before: &State) -> Flow {
        let trial = self.modes.map(|mode| 2.0 * self.mu * double_contraction(&mode, strain));
        let volume_strain = strain[0] + strain[1] + strain[2];
        let yield_stress = self.hardening.stress(before.equivalent);
        let excess = self.unrelaxed(&trial, 0.0).0 - yield_stress;
        let yields = excess > if before.rests { AT_LIMIT } else { -AT_LIMIT } * yield_stress;
        let (y, increment) = if excess > 0.0 { self.solve(&trial, before.equivalent) } else { (0.0, 0.0) };
        Flow { volume_strain, trial, y, increment, yields }
    }

    /// S and its derivative by y.
    fn unrelaxed(&self, trial: &[f64; 5], y: f64) -> (f64, f64) {
        let (mut square, mut change) = (0.0, 0.0);
        for i in 0..5 {
            let q = self.squares[i] / 1.5;
            let share = 1.0 - y + y * q;
            let term = self.squares[i] * (trial[i] / share).powi(2);
            square += term;
            change += term * (1.0 - q) / share;
        }
        let root = square.sqrt();
        (root, if root > 0.0 { change / root } else { 0.0 })
    }

    /// y and De of a stress beyond the yield limit.
    fn solve(&self, trial: &[f64; 5], equivalent: f64) -> (f64, f64) {
        let (mut low, mut high) = (0.0, 1.0);
        let mut y = 0.0;
        for iteration in 0..NEWTON + HALVINGS {
            let (unrelaxed, change) = self.unrelaxed(trial, y);
            let e = equivalent + y * unrelaxed / (3.0 * self.mu);
            let excess = (1.0 - y) * unrelaxed - self.hardening.stress(e);
            let hardening = self.hardening.slope(e) / (3.0 * self.mu);
            let fall = unrelaxed - (1.0 - y) * change + hardening * (unrelaxed + y * change);
            if excess > 0.0 {
                low = y
            } else {
                high = y
            }
            let newton = y + excess / fall;
            let inside = iteration < NEWTON && newton > low && newton < high;
            let next = if inside { newton } else { 0.5 * (low + high) };
            // Where hardening is very steep a short step is not the last.
            let far = excess.abs() > STEEP * unrelaxed;
            let moved = if far { (next - y).abs() } else { (next - y).abs().min((newton - y).abs()) };
            let moved = if far && inside { f64::INFINITY } else { moved };
            y = if moved <= 4.0 * f64::EPSILON { newton.clamp(low, high) } else { next };
            if moved <= 4.0 * f64::EPSILON {
                break;
            }
        }
        (y, y * self.unrelaxed(trial, y).0 / (3.0 * self.mu))
    }

    /// D.
    fn moduli(&self, flow: &Flow, before: f64) -> [Voigt; 6] {
        let mut moduli = [[0.0; 6]; 6];
        add_square(&mut moduli, self.bulk, &IDENTITY);
        for i in 0..5 {
            add_square(&mut moduli, 2.0 * self.mu * self.kept(flow, i), &self.modes[i]);
        }
        if flow.yields {
            let equivalent = (1.0 - flow.y) * self.unrelaxed(&flow.trial, flow.y).0;
            let (mut direction, mut turn) = ([0.0; 6], 0.0);
            for i in 0..5 {
                let (p, m) = (self.squares[i], self.kept(flow, i));
                let stress = m * flow.trial[i];
                let share = p * stress * m / equivalent;
                (0..6).for_each(|v| direction[v] += share * self.modes[i][v]);
                turn += p * p * m * stress * stress / equivalent;
            }
            let slope = self.hardening.slope(before + flow.increment);
            let a = 1.0 - slope * flow.increment / equivalent;
            let k = a * equivalent / (a * turn + 0.5 * slope * equivalent / self.mu);
            add_square(&mut moduli, -2.0 * self.mu * k, &direction);
        }
        mirror(&mut moduli);
        moduli
    }
}

/// Eigentensors and eigenvalues of Hill's P with the coefficients F, G, H, L, M, N on tensors without trace.
fn modes(coefficients: &[f64; 6]) -> ([Voigt; 5], [f64; 5]) {
    let [f, g, h, l, m, n] = *coefficients;
    let form = |a: &[f64; 3], b: &[f64; 3]| {
        let difference = |i: usize, j: usize| (a[i] - a[j]) * (b[i] - b[j]);
        f * difference(1, 2) + g * difference(2, 0) + h * difference(0, 1)
    };
    let (a, b) = ([0.5f64.sqrt(), -(0.5f64.sqrt()), 0.0], [1.0, 1.0, -2.0].map(|x: f64| x / 6f64.sqrt()));
    let angle = 0.5 * (2.0 * form(&a, &b)).atan2(form(&a, &a) - form(&b, &b));
    let (sin, cos) = angle.sin_cos();
    let normal = [[cos, sin], [-sin, cos]].map(|[c, s]| std::array::from_fn(|i| c * a[i] + s * b[i]));
    let mut modes = [[0.0; 6]; 5];
    for (mode, normal) in modes.iter_mut().zip(&normal) {
        mode[..3].copy_from_slice(normal);
    }
    (2..5).for_each(|i| modes[i][i + 1] = 0.5f64.sqrt());
    (modes, [form(&normal[0], &normal[0]), form(&normal[1], &normal[1]), n, l, m])
}

#[cfg(test)]
mod tests;
