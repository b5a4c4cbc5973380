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
use crate::solid::voigt::{INDEX, Voigt, compose, right_cauchy_green, symmetric_product};

/// The components of a symmetric tensor: rows and columns.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// How often each of them stands in the tensor.
const TIMES: Voigt = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];

/// The logarithmic strain at a point.
pub struct LogarithmicStrain {
    /// E, tensor components.
    pub strain: Voigt,
    /// C_A.
    squares: [f64; 3],
    /// e_A.
    principal: [f64; 3],
    /// sym(N_A x N_B).
    reference: [Voigt; 6],
    /// sym(n_A x n_B).
    spatial: [Voigt; 6],
}

impl LogarithmicStrain {
    /// Of a deformation gradient; `None` unless det F > 0.
    pub fn new(f: &Mat3) -> Option<Self> {
        let Principal { squares, strains, directions } = Principal::new(&right_cauchy_green(f), f.determinant())?;
        let turned: [[f64; 3]; 3] = std::array::from_fn(|a| {
            let stretch = squares[a].sqrt();
            (f * crate::Vec3::from(directions[a]) / stretch).into()
        });
        Some(Self {
            strain: compose(&strains, &directions),
            squares,
            principal: strains,
            reference: PAIRS.map(|(a, b)| symmetric_product(&directions[a], &directions[b])),
            spatial: PAIRS.map(|(a, b)| symmetric_product(&turned[a], &turned[b])),
        })
    }

    /// tau of T.
    pub fn kirchhoff(&self, stress: &Voigt) -> Voigt {
        let components = self.components(stress);
        let mut kirchhoff = [0.0; 6];
        for (p, &(a, b)) in PAIRS.iter().enumerate() {
            let factor = TIMES[p] * self.theta(a, b) * components[p];
            (0..6).for_each(|v| kirchhoff[v] += factor * self.spatial[p][v]);
        }
        kirchhoff
    }

    /// c of T and of D, for engineering shear rates.
    pub fn tangent(&self, stress: &Voigt, moduli: &[Voigt; 6]) -> [Voigt; 6] {
        let mut by_axes = [[0.0; 6]; 6];
        let half: [Voigt; 6] = moduli.map(|row| self.components(&row));
        let weights: Voigt = std::array::from_fn(|p| TIMES[p] * self.theta(PAIRS[p].0, PAIRS[p].1));
        for q in 0..6 {
            let column = self.components(&std::array::from_fn(|v| half[v][q]));
            (0..6).for_each(|p| by_axes[p][q] = weights[p] * column[p] * weights[q]);
        }
        self.add_turning(&self.components(stress), &mut by_axes);
        let half: [Voigt; 6] = by_axes.map(|row| self.spread(&row));
        let mut tangent = [[0.0; 6]; 6];
        for w in 0..6 {
            let column = self.spread(&std::array::from_fn(|p| half[p][w]));
            (0..=w).for_each(|v| {
                tangent[v][w] = column[v];
                tangent[w][v] = column[v];
            });
        }
        tangent
    }

    /// Components by the N_A of a tensor of stress.
    fn components(&self, stress: &Voigt) -> Voigt {
        std::array::from_fn(|p| (0..6).map(|v| TIMES[v] * self.reference[p][v] * stress[v]).sum())
    }

    /// The sum of these values times sym(n_A x n_B).
    fn spread(&self, values: &Voigt) -> Voigt {
        std::array::from_fn(|v| (0..6).map(|p| values[p] * self.spatial[p][v]).sum())
    }

    fn theta(&self, a: usize, b: usize) -> f64 {
        let x = self.principal[a] - self.principal[b];
        if x == 0.0 { 1.0 } else { x / x.sinh() }
    }

    /// Adds the sum of g_AKB T_AB d_AK d_KB, as a symmetric form in the components d_P.
    fn add_turning(&self, stress: &Voigt, form: &mut [Voigt; 6]) {
        let stretch = self.squares.map(f64::sqrt);
        for a in 0..3 {
            for b in a..3 {
                for k in 0..3 {
                    let difference = self.second_difference(a, k, b);
                    let g = 8.0 * difference * stretch[a] * self.squares[k] * stretch[b];
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
        0.5 * self.theta(a, b) / (self.squares[a] * self.squares[b]).sqrt()
    }

    /// The second divided difference of 1/2 ln.
    fn second_difference(&self, a: usize, b: usize, c: usize) -> f64 {
        let mut order = [a, b, c];
        order.sort_by(|&i, &j| self.squares[i].total_cmp(&self.squares[j]));
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
                let strain = LogarithmicStrain::new(&f).unwrap();
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
        let strain = LogarithmicStrain::new(&Mat3::from_diagonal(&[1.0, 2f64.sqrt(), 2.0].into())).unwrap();
        assert!((strain.first_difference(0, 1) - 0.5 * 2f64.ln()).abs() < 1e-15);
        // ([1, 2] - [2, 4]) / (1 - 4), and with two equal ([1, 1] - [1, 2]) / (1 - 2).
        assert!((strain.second_difference(2, 0, 1) + 2f64.ln() / 12.0).abs() < 1e-15);
        assert!((strain.second_difference(0, 1, 0) + 0.5 - 0.5 * 2f64.ln()).abs() < 1e-15);
        let same = LogarithmicStrain::new(&(2.0 * Mat3::identity())).unwrap();
        assert!((same.second_difference(0, 1, 2) + 0.25 / 16.0).abs() < 1e-17);
    }
}
