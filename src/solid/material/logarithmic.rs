//! The logarithmic strain E = 1/2 ln C, and what is conjugate to it, in space.
//!
//! ```text
//! C   = F^T F = sum_A exp(2 e_A) N_A x N_A,     E = sum_A e_A N_A x N_A,     n_A = F N_A / exp(e_A)
//! T   : E' = tau : d                             T, the stress conjugate to E; T' = D : E'
//! E'_AB   = theta_AB d_AB,                       theta_AB = x / sinh x,  x = e_A - e_B
//! tau_AB  = theta_AB T_AB
//! d:c:d   = sum_ABCD theta_AB d_AB D_ABCD theta_CD d_CD + sum_AKB g_AKB T_AB d_AK d_KB
//! g_AKB   = 8 [C_A, C_K, C_B] l_A l_K^2 l_B,     l_A = exp(e_A),  C_A = l_A^2
//! ```
//!
//! Components of T, E and D are those by N_A, of tau, d and c those by n_A; [a, b, c] is the second divided difference of 1/2
//! ln. That is Miehe, Apel and Lambrecht's P = 2 dE/dC and L = 4 d2E/dC2 (CMAME 191, 2002), pushed forward, with derivatives
//! of a tensor function as divided differences (Daleckii and Krein, 1951). theta is regular in x. [a, b, c] is taken as a
//! difference over its widest gap or, when all three are close, as a series around their mean:
//!
//! ```text
//! [a, b, c] = 1/2 sum_k (-1)^(k+1) h_k(p, q, r) / ((k + 2) m^2),    a = m (1 + p), b = m (1 + q), c = m (1 + r)
//! ```
//!
//! with h_k the complete homogeneous symmetric polynomials. So nothing is lost for equal or nearly equal stretches.

use crate::Mat3;
use crate::solid::eigen::symmetric_eigen;
use crate::solid::voigt::{
    INDEX, PAIRS, Voigt, combine, compose, congruent, mirror, right_cauchy_green, symmetric_product, transpose,
};

/// How often each component stands in the tensor.
const TIMES: Voigt = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];

/// The logarithmic strain at a point.
pub struct LogarithmicStrain {
    /// E, tensor components.
    pub strain: Voigt,
    f: Mat3,
    principal: Principal,
}

impl LogarithmicStrain {
    /// Of a deformation gradient; `None` unless det F > 0.
    #[inline]
    pub fn new(f: Mat3) -> Option<Self> {
        let principal = Principal::new(&right_cauchy_green(&f), f.determinant())?;
        Some(Self { strain: compose(&principal.strains, &principal.directions), f, principal })
    }

    /// Its axes.
    #[inline]
    pub fn axes(&self) -> Axes {
        let Principal { squares, strains, directions } = self.principal;
        let stretches = squares.map(f64::sqrt);
        let mut turned = [[0.0; 3]; 3];
        for a in 0..3 {
            turned[a] = (self.f * crate::Vec3::from(directions[a]) / stretches[a]).into();
        }
        let (mut reference, mut spatial, mut theta) = ([[0.0; 6]; 6], [[0.0; 6]; 6], [1.0; 6]);
        for (p, &(a, b)) in PAIRS.iter().enumerate() {
            reference[p] = symmetric_product(&directions[a], &directions[b]);
            (0..6).for_each(|v| reference[p][v] *= TIMES[v]);
            spatial[p] = symmetric_product(&turned[a], &turned[b]);
            let x = strains[a] - strains[b];
            if x != 0.0 {
                theta[p] = x / x.sinh();
            }
        }
        Axes { squares, stretches, theta, reference, spatial }
    }
}

/// The principal axes of a strain before and after the deformation: between components by them, and tensors in space.
pub struct Axes {
    /// C_A.
    squares: [f64; 3],
    /// l_A.
    stretches: [f64; 3],
    /// theta_AB.
    theta: Voigt,
    /// sym(N_A x N_B), with components as often as they stand in the tensor.
    reference: [Voigt; 6],
    /// sym(n_A x n_B).
    spatial: [Voigt; 6],
}

impl Axes {
    /// tau of T.
    #[inline]
    pub fn kirchhoff(&self, stress: &Voigt) -> Voigt {
        let (mut components, weights) = (self.components(stress), self.weights());
        (0..6).for_each(|p| components[p] *= weights[p]);
        combine(&components, &self.spatial)
    }

    /// c of T and of D, for engineering shear rates.
    #[inline]
    pub fn tangent(&self, stress: &Voigt, moduli: &[Voigt; 6]) -> [Voigt; 6] {
        let (mut form, weights) = (congruent(&self.reference, moduli), self.weights());
        for p in 0..6 {
            (0..6).for_each(|q| form[p][q] = weights[p] * form[p][q] * weights[q]);
        }
        self.add_turning(&self.components(stress), &mut form);
        let mut tangent = congruent(&transpose(&self.spatial), &form);
        mirror(&mut tangent);
        tangent
    }

    /// Components by the N_A of a tensor of stress.
    #[inline(always)]
    fn components(&self, stress: &Voigt) -> Voigt {
        combine(stress, &transpose(&self.reference))
    }

    #[inline(always)]
    fn weights(&self) -> Voigt {
        std::array::from_fn(|p| TIMES[p] * self.theta[p])
    }

    /// Adds the sum of g_AKB T_AB d_AK d_KB, as a symmetric form in the components d_P.
    #[inline(always)]
    fn add_turning(&self, stress: &Voigt, form: &mut [Voigt; 6]) {
        let unlike = self.second_difference(0, 1, 2);
        // [C_A, C_A, C_K].
        let mut alike = [[0.0; 3]; 3];
        for (a, k) in (0..3).flat_map(|a| (0..3).map(move |k| (a, k))) {
            alike[a][k] = self.second_difference(a, a, k);
        }
        for a in 0..3 {
            for b in a..3 {
                for k in 0..3 {
                    let difference = match k {
                        _ if a == b => alike[a][k],
                        _ if k == a => alike[a][b],
                        _ if k == b => alike[b][a],
                        _ => unlike,
                    };
                    let g = 8.0 * difference * self.stretches[a] * self.squares[k] * self.stretches[b];
                    // Both of AB and BA, half of it in each of PQ and QP.
                    let (p, q) = (INDEX[a][k], INDEX[k][b]);
                    let value = if a == b { 0.5 } else { 1.0 } * g * stress[INDEX[a][b]];
                    form[p][q] += value;
                    form[q][p] += value;
                }
            }
        }
    }

    /// The first divided difference of 1/2 ln.
    fn first_difference(&self, a: usize, b: usize) -> f64 {
        0.5 * self.theta[INDEX[a][b]] / (self.squares[a] * self.squares[b]).sqrt()
    }

    /// The second divided difference of 1/2 ln.
    fn second_difference(&self, a: usize, b: usize, c: usize) -> f64 {
        let mut order = [a, b, c];
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if self.squares[order[j]] < self.squares[order[i]] {
                order.swap(i, j);
            }
        }
        let [low, middle, high] = order;
        let values = order.map(|i| self.squares[i]);
        let mean = (values[0] + values[1] + values[2]) / 3.0;
        if values[2] - values[0] > CLOSE * mean {
            let ends = self.first_difference(low, middle) - self.first_difference(middle, high);
            return ends / (values[0] - values[2]);
        }
        0.5 * close_difference(values.map(|v| (v - mean) / mean)) / (mean * mean)
    }
}

/// Spread of three squares over their mean below which the series is better than the difference.
const CLOSE: f64 = 0.1;

/// Terms of the series below it, and all that follow them, are lost in the rounding of its sum, 1/2.
const NEGLIGIBLE: f64 = 1e-18;

/// The series of twice the second divided difference of 1/2 ln at m = 1 for deviations whose sum is 0.
fn close_difference(deviations: [f64; 3]) -> f64 {
    let [p, q, r] = deviations;
    let (second, third) = (p * q + q * r + r * p, p * q * r);
    // h_k of the last three k, the latest first; h_k = -second h_(k-2) + third h_(k-3).
    let mut last = [1.0, 0.0, 0.0];
    let (mut sum, mut sign) = (-0.5, 1.0);
    for k in 1..=16 {
        let next = -second * last[1] + third * last[2];
        last = [next, last[0], last[1]];
        sum += sign * next / f64::from(k + 2);
        sign = -sign;
        if last.iter().all(|h| h.abs() < NEGLIGIBLE) {
            break;
        }
    }
    sum
}

/// A Cauchy-Green tensor in its principal directions.
pub struct Principal {
    /// Squares of the stretches, the eigenvalues of the tensor.
    pub squares: [f64; 3],
    /// Logarithmic strains.
    pub strains: [f64; 3],
    pub directions: [[f64; 3]; 3],
}

impl Principal {
    /// Of a tensor; `None` unless det F > 0.
    pub fn new(cauchy_green: &Voigt, det_f: f64) -> Option<Self> {
        let (squares, directions) = symmetric_eigen(cauchy_green);
        // Rounding may leave no positive square when F is singular to working accuracy.
        let valid = det_f > 0.0 && squares.iter().all(|&c| c > 0.0);
        valid.then(|| Self { squares, strains: squares.map(|c| 0.5 * c.ln()), directions })
    }
}

/// Largest principal logarithmic strain of what lies between two deformation gradients; `None` where one is inverted.
pub fn strain_between(before: &Mat3, after: &Mat3) -> Option<f64> {
    let f = after * before.try_inverse()?;
    let principal = Principal::new(&right_cauchy_green(&f), f.determinant())?;
    Some(principal.strains.iter().fold(0.0, |most, strain| strain.abs().max(most)))
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{Random, rotation};
    use super::*;

    #[test]
    fn differences_and_series_meet() {
        let mut random = Random::new(31);
        for spread in [0.09, 0.1, 0.11, 0.14] {
            for _ in 0..20 {
                let middle = random.number(0.5 * spread);
                let stretches: [f64; 3] = [-0.5 * spread, middle, 0.5 * spread].map(|d| (1.3 * (1.0 + d)).sqrt());
                let f = rotation(random.vector(2.0)) * Mat3::from_diagonal(&stretches.into());
                let strain = LogarithmicStrain::new(f).unwrap().axes();
                let values = strain.squares;
                let mean = values.iter().sum::<f64>() / 3.0;
                let series = 0.5 * close_difference(values.map(|v| (v - mean) / mean)) / (mean * mean);
                let mut order = [0, 1, 2];
                order.sort_by(|&i: &usize, &j| values[i].total_cmp(&values[j]));
                let [low, middle, high] = order;
                let ends = strain.first_difference(low, middle) - strain.first_difference(middle, high);
                assert!((ends / (values[low] - values[high]) / series - 1.0).abs() < 4e-14);
            }
        }
    }

    #[test]
    fn strain_between_does_not_see_rotations() {
        let mut random = Random::new(32);
        let before = Mat3::identity() + random.matrix(0.2);
        let stretch = Mat3::from_diagonal(&[1.1, 0.8, 0.95].into());
        let turn = [(); 3].map(|()| rotation(random.vector(2.0)));
        let after = turn[0] * stretch * turn[1] * before;
        assert!((strain_between(&before, &after).unwrap() + 0.8f64.ln()).abs() < 1e-14);
        assert!(strain_between(&before, &(turn[2] * before)).unwrap() < 1e-14);
        assert!(strain_between(&before, &-before).is_none());
    }

    #[test]
    fn differences_of_the_logarithm_in_closed_form() {
        let strain = LogarithmicStrain::new(Mat3::from_diagonal(&[1.0, 2f64.sqrt(), 2.0].into())).unwrap().axes();
        assert!((strain.first_difference(0, 1) - 0.5 * 2f64.ln()).abs() < 1e-15);
        // ([1, 2] - [2, 4]) / (1 - 4), and with two equal ([1, 1] - [1, 2]) / (1 - 2).
        assert!((strain.second_difference(2, 0, 1) + 2f64.ln() / 12.0).abs() < 1e-15);
        assert!((strain.second_difference(0, 1, 0) + 0.5 - 0.5 * 2f64.ln()).abs() < 1e-15);
        let same = LogarithmicStrain::new(2.0 * Mat3::identity()).unwrap().axes();
        assert!((same.second_difference(0, 1, 2) + 0.25 / 16.0).abs() < 1e-17);
    }
}
