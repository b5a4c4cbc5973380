//! Nearly incompressible rubber: an isochoric law and a bulk modulus.
//!
//! ```text
//! W   = Wi(bi) + K/2 (J - 1)^2,   bi = J^(-2/3) b,   I1 = tr bi,   I2 = (I1^2 - tr bi^2)/2
//! Mooney-Rivlin  Wi = c10 (I1 - 3) + c01 (I2 - 3)
//! Yeoh           Wi = c10 (I1 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3
//! Ogden          Wi = sum_p 2 mu_p/alpha_p^2 (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3),   l_A^2 the eigenvalues of bi
//! ```
//!
//! With the derivatives W1, W11 by I1 and W2 = c01 by I2, the first two have, with P = I - 1/3 1 x 1,
//!
//! ```text
//! t   = 2 (W1 + I1 W2) bi - 2 W2 bi^2
//! tau = P : t + K J (J - 1) 1
//! c   = P : ct : P + 2/3 tr t P - 2/3 (1 x P:t + P:t x 1) + K J (2 J - 1) 1 x 1 - 2 K J (J - 1) I
//! ct  = 4 (W2 + W11) bi x bi - 4 W2 (bi_ik bi_jl + bi_il bi_jk)/2
//! ```
//!
//! (Holzapfel, Nonlinear Solid Mechanics, 2000, sections 6.5 and 6.6, pushed forward). Ogden's law has, with e_A = ln l_A of b
//! and f_Ap = exp(alpha_p (e_A - 1/3 ln J)),
//!
//! ```text
//! tau_A = sum_p 2 mu_p/alpha_p (f_Ap - mean_p) + K J (J - 1),   mean_p = 1/3 sum_A f_Ap
//! D_AB  = d tau_A / d e_B = sum_p 2 mu_p (delta_AB f_Ap - (f_Ap + f_Bp)/3 + mean_p/3) + K J (2 J - 1)
//! c     = sum_AB (D_AB - 2 delta_AB tau_A) M_A x M_B + sum_{A<B} s_AB N_AB x N_AB
//! s_AB  = sum_p 2 mu_p/alpha_p sqrt(f_Ap f_Bp) sinh(alpha_p x/2) coth x - (tau_A + tau_B)/2,   x = e_A - e_B
//! ```
//!
//! with M and N as in [`super::hencky`]: s_AB = (tau_A b_B - tau_B b_A)/(b_A - b_B) without its 0/0 for equal stretches.

use super::Response;
use super::logarithmic::Principal;
use super::model::Isochoric;
use crate::Mat3;
use crate::solid::voigt::{
    IDENTITY, INDEX, PAIRS, Voigt, add_square, compose, double_contraction, left_cauchy_green, mirror,
    symmetric_product,
};

/// An isochoric law with its bulk modulus.
#[derive(Clone, Debug)]
pub struct Hyperelastic {
    pub law: Isochoric,
    pub bulk: f64,
}

impl Hyperelastic {
    /// Stress and tangent.
    pub fn response(&self, f: &Mat3) -> Option<Response> {
        match &self.law {
            &Isochoric::MooneyRivlin { c10, c01 } => self.response_of([c10, 0.0, 0.0], c01, f),
            &Isochoric::Yeoh { c10, c20, c30 } => self.response_of([c10, c20, c30], 0.0, f),
            Isochoric::Ogden(terms) => self.ogden_response(terms, f),
        }
    }

    /// Kirchhoff stress.
    pub fn kirchhoff(&self, f: &Mat3) -> Option<Voigt> {
        match &self.law {
            &Isochoric::MooneyRivlin { c10, c01 } => Some(self.stress(&Isochore::new([c10, 0.0, 0.0], c01, f)?)),
            &Isochoric::Yeoh { c10, c20, c30 } => Some(self.stress(&Isochore::new([c10, c20, c30], 0.0, f)?)),
            Isochoric::Ogden(terms) => {
                let principal = Principal::new(&left_cauchy_green(f), f.determinant())?;
                Some(compose(&self.ogden_stress(terms, &principal.strains, f.determinant()), &principal.directions))
            }
        }
    }

    /// Stored energy per reference volume.
    pub fn energy(&self, f: &Mat3) -> Option<f64> {
        let j = f.determinant();
        let isochoric = match &self.law {
            &Isochoric::MooneyRivlin { c10, c01 } => Isochore::new([c10, 0.0, 0.0], c01, f)?.energy([c10, 0.0, 0.0]),
            &Isochoric::Yeoh { c10, c20, c30 } => Isochore::new([c10, c20, c30], 0.0, f)?.energy([c10, c20, c30]),
            Isochoric::Ogden(terms) => {
                let strains = Principal::new(&left_cauchy_green(f), j)?.strains;
                terms
                    .iter()
                    .map(|term| 2.0 * term[0] / term[1].powi(2) * powers(term[1], &strains).iter().sum::<f64>())
                    .sum()
            }
        };
        Some(isochoric + 0.5 * self.bulk * (j - 1.0).powi(2))
    }

    /// K J (J - 1), the third of the trace of the stress.
    fn pressure(&self, j: f64) -> f64 {
        self.bulk * j * (j - 1.0)
    }

    /// Its derivative by ln J.
    fn pressure_rate(&self, j: f64) -> f64 {
        self.bulk * j * (2.0 * j - 1.0)
    }

    fn stress(&self, at: &Isochore) -> Voigt {
        let pressure = self.pressure(at.j);
        std::array::from_fn(|v| at.deviator[v] + pressure * IDENTITY[v])
    }

    fn response_of(&self, c: [f64; 3], c01: f64, f: &Mat3) -> Option<Response> {
        let at = Isochore::new(c, c01, f)?;
        let mut tangent = [[0.0; 6]; 6];
        // ct.
        let b = at.b;
        add_square(&mut tangent, 4.0 * (at.w2 + at.w11), &b);
        for (v, (i, j)) in PAIRS.into_iter().enumerate() {
            for (w, (k, l)) in PAIRS.into_iter().enumerate().skip(v) {
                let of = |i: usize, j: usize| b[INDEX[i][j]];
                tangent[v][w] -= 2.0 * at.w2 * (of(i, k) * of(j, l) + of(i, l) * of(j, k));
            }
        }
        mirror(&mut tangent);
        // What stands with 1: P : ct : P = ct - (1 x ct:1 + ct:1 x 1)/3 + (1:ct:1) 1 x 1 / 9.
        let of_volume: Voigt = tangent.map(|row| row[0] + row[1] + row[2]);
        let (volume, trace) = (of_volume[0] + of_volume[1] + of_volume[2], at.trace);
        let beside: Voigt = std::array::from_fn(|v| -of_volume[v] / 3.0 - 2.0 / 3.0 * at.deviator[v]);
        let both = volume / 9.0 - 2.0 / 9.0 * trace + self.pressure_rate(at.j);
        let unit = 2.0 / 3.0 * trace - 2.0 * self.pressure(at.j);
        for v in 0..6 {
            for w in v..6 {
                tangent[v][w] += beside[v] * IDENTITY[w] + IDENTITY[v] * beside[w] + both * IDENTITY[v] * IDENTITY[w];
            }
            tangent[v][v] += if v < 3 { unit } else { 0.5 * unit };
        }
        mirror(&mut tangent);
        Some(Response { kirchhoff: self.stress(&at), tangent })
    }

    fn ogden_stress(&self, terms: &[[f64; 2]], strains: &[f64; 3], j: f64) -> [f64; 3] {
        let mut stress = [self.pressure(j); 3];
        for [mu, alpha] in terms {
            let powers = powers(*alpha, strains);
            let mean = (powers[0] + powers[1] + powers[2]) / 3.0;
            (0..3).for_each(|a| stress[a] += 2.0 * mu / alpha * (powers[a] - mean));
        }
        stress
    }

    fn ogden_response(&self, terms: &[[f64; 2]], f: &Mat3) -> Option<Response> {
        let j = f.determinant();
        let Principal { strains, directions, .. } = Principal::new(&left_cauchy_green(f), j)?;
        let stress = self.ogden_stress(terms, &strains, j);
        let mut normal = [[self.pressure_rate(j); 3]; 3];
        let mut shear = [0, 1, 2].map(|a| -0.5 * (stress[a] + stress[(a + 1) % 3]));
        for [mu, alpha] in terms {
            let f = powers(*alpha, &strains).map(|power| 1.0 + power);
            let mean = (f[0] + f[1] + f[2]) / 3.0;
            for a in 0..3 {
                (0..3).for_each(|b| normal[a][b] += 2.0 * mu / 3.0 * (mean - f[a] - f[b]));
                normal[a][a] += 2.0 * mu * f[a];
                let b = (a + 1) % 3;
                let x = strains[a] - strains[b];
                // sinh(alpha x / 2) coth x.
                let gap = if x == 0.0 { 0.5 * alpha } else { (0.5 * alpha * x).sinh() / x.tanh() };
                shear[a] += 2.0 * mu / alpha * (f[a] * f[b]).sqrt() * gap;
            }
        }
        let mut tangent = [[0.0; 6]; 6];
        let along = directions.map(|n| symmetric_product(&n, &n));
        for a in 0..3 {
            let row: Voigt = std::array::from_fn(|v| {
                (0..3).map(|b| normal[a][b] * along[b][v]).sum::<f64>() - 2.0 * stress[a] * along[a][v]
            });
            for v in 0..6 {
                (v..6).for_each(|w| tangent[v][w] += along[a][v] * row[w]);
            }
            add_square(&mut tangent, 4.0 * shear[a], &symmetric_product(&directions[a], &directions[(a + 1) % 3]));
        }
        mirror(&mut tangent);
        Some(Response { kirchhoff: compose(&stress, &directions), tangent })
    }
}

/// f_A - 1 of a power, without what rounding would leave of small strains.
fn powers(alpha: f64, strains: &[f64; 3]) -> [f64; 3] {
    let mean = (strains[0] + strains[1] + strains[2]) / 3.0;
    strains.map(|strain| (alpha * (strain - mean)).exp_m1())
}

/// A law of the invariants at a deformation.
struct Isochore {
    j: f64,
    /// bi.
    b: Voigt,
    first: f64,
    second: f64,
    w2: f64,
    w11: f64,
    /// tr t, and P : t.
    trace: f64,
    deviator: Voigt,
}

impl Isochore {
    /// Of sum_k c[k] (I1 - 3)^(k+1) + w2 (I2 - 3); `None` unless det F > 0.
    fn new(c: [f64; 3], w2: f64, f: &Mat3) -> Option<Self> {
        let j = f.determinant();
        if j.is_nan() || j <= 0.0 {
            return None;
        }
        let scale = j.cbrt().powi(-2);
        let b = left_cauchy_green(f).map(|b| scale * b);
        let first = b[0] + b[1] + b[2];
        let second = 0.5 * (first * first - double_contraction(&b, &b));
        let excess = first - 3.0;
        let w1 = c[0] + excess * (2.0 * c[1] + 3.0 * c[2] * excess);
        let square = PAIRS.map(|(i, j)| (0..3).map(|k| b[INDEX[i][k]] * b[INDEX[k][j]]).sum::<f64>());
        let (of_b, of_square) = (2.0 * (w1 + first * w2), 2.0 * w2);
        let squares = square[0] + square[1] + square[2];
        let trace = of_b * first - of_square * squares;
        // Of each tensor by itself, so that nothing is left of the undeformed state.
        let part = |t: &Voigt, trace: f64, v: usize| t[v] - trace / 3.0 * IDENTITY[v];
        let deviator = std::array::from_fn(|v| of_b * part(&b, first, v) - of_square * part(&square, squares, v));
        Some(Self { j, b, first, second, w2, w11: 2.0 * c[1] + 6.0 * c[2] * excess, trace, deviator })
    }

    fn energy(&self, c: [f64; 3]) -> f64 {
        let excess = self.first - 3.0;
        excess * (c[0] + excess * (c[1] + excess * c[2])) + self.w2 * (self.second - 3.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    const C: [f64; 2] = [0.4, 0.15];
    const YEOH: [f64; 3] = [0.5, -0.03, 0.004];
    const TERMS: [[f64; 2]; 3] = [[0.63, 1.3], [0.0012, 5.0], [-0.01, -2.0]];

    fn laws() -> [Hyperelastic; 3] {
        let bulk = 7.0;
        [
            Hyperelastic { law: Isochoric::MooneyRivlin { c10: C[0], c01: C[1] }, bulk },
            Hyperelastic { law: Isochoric::Yeoh { c10: YEOH[0], c20: YEOH[1], c30: YEOH[2] }, bulk },
            Hyperelastic { law: Isochoric::Ogden(TERMS.to_vec()), bulk },
        ]
    }

    fn yeoh_rate(first: f64) -> f64 {
        YEOH[0] + 2.0 * YEOH[1] * (first - 3.0) + 3.0 * YEOH[2] * (first - 3.0).powi(2)
    }

    fn ogden(a: f64, b: f64) -> f64 {
        TERMS.iter().map(|[mu, alpha]| 2.0 * mu / alpha * (a.powf(*alpha) - b.powf(*alpha))).sum()
    }

    /// Differences of principal stresses at stretches that keep the volume, of bars and of sheets: Treloar, The Physics of
    /// Rubber Elasticity, chapters 4, 5 and 11.
    #[test]
    fn bars_and_sheets_in_closed_form() {
        for s in [0.4f64, 0.8, 1.0, 1.5, 3.0] {
            let (thin, flat) = (s.powf(-0.5), s.powi(-2));
            let bar = [
                2.0 * (C[0] + C[1] / s) * (s * s - 1.0 / s),
                2.0 * yeoh_rate(s * s + 2.0 / s) * (s * s - 1.0 / s),
                ogden(s, thin),
            ];
            let sheet = [
                2.0 * (C[0] + C[1] * s * s) * (s * s - s.powi(-4)),
                2.0 * yeoh_rate(2.0 * s * s + s.powi(-4)) * (s * s - s.powi(-4)),
                ogden(s, flat),
            ];
            for (law, [bar, sheet]) in laws().iter().zip(bar.into_iter().zip(sheet).map(|(b, s)| [b, s])) {
                let difference = |stretches: Vec3| {
                    let tau = law.kirchhoff(&Mat3::from_diagonal(&stretches)).unwrap();
                    tau[0] - tau[2]
                };
                assert!((difference(Vec3::new(s, thin, thin)) - bar).abs() < 2e-14 * (1.0 + bar.abs()), "{law:?} {s}");
                assert!((difference(Vec3::new(s, s, flat)) - sheet).abs() < 2e-14 * (1.0 + sheet.abs()), "{law:?} {s}");
            }
        }
    }

    #[test]
    fn simple_shear_and_volume_in_closed_form() {
        for gamma in [-2.0f64, 0.1, 1.0] {
            let mut f = Mat3::identity();
            f[(0, 1)] = gamma;
            let stretch = 0.5 * (gamma + gamma.hypot(2.0));
            let exact = [
                2.0 * (C[0] + C[1]) * gamma,
                2.0 * yeoh_rate(3.0 + gamma * gamma) * gamma,
                ogden(stretch, 1.0 / stretch) / (stretch + 1.0 / stretch),
            ];
            for (law, exact) in laws().iter().zip(exact) {
                let found = law.kirchhoff(&f).unwrap()[3];
                assert!((found - exact).abs() < 1e-14 * (1.0 + exact.abs()), "{law:?} {gamma}: {found} {exact}");
            }
        }
        for law in laws() {
            let (s, j) = (1.1f64, 1.1f64.powi(3));
            let found = law.kirchhoff(&(Mat3::identity() * s)).unwrap();
            let exact = law.bulk * j * (j - 1.0);
            (0..6).for_each(|v| assert!((found[v] - exact * IDENTITY[v]).abs() < 1e-14 * exact));
        }
    }

    /// Mooney and Rivlin's law is Ogden's with the exponents 2 and -2.
    #[test]
    fn laws_by_invariants_and_by_stretches_agree() {
        let mut random = crate::solid::testing::Random::new(9);
        let [mooney_rivlin, ..] = laws();
        let terms = vec![[2.0 * C[0], 2.0], [2.0 * C[1], -2.0]];
        let ogden = Hyperelastic { law: Isochoric::Ogden(terms), bulk: mooney_rivlin.bulk };
        for _ in 0..20 {
            let f = Mat3::identity() + random.matrix(0.3);
            let (a, b) = (mooney_rivlin.response(&f).unwrap(), ogden.response(&f).unwrap());
            assert!((mooney_rivlin.energy(&f).unwrap() - ogden.energy(&f).unwrap()).abs() < 1e-14);
            (0..6).for_each(|v| assert!((a.kirchhoff[v] - b.kirchhoff[v]).abs() < 2e-14));
            let all = a.tangent.as_flattened().iter().zip(b.tangent.as_flattened());
            all.for_each(|(a, b)| assert!((a - b).abs() < 2e-13, "{a} {b}"));
        }
    }
}
