//! Eigenvalues and eigenvectors of symmetric positive definite 3x3 tensors by cyclic Jacobi rotations.
//!
//! Jacobi's method finds every eigenvalue of such a tensor to full *relative* accuracy and eigenvectors that are
//! orthonormal to rounding, however close the eigenvalues are (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13,
//! 1992); closed formulas for the roots of the cubic do neither.

use super::voigt::Voigt;

/// Far more than the four or five sweeps that quadratic convergence needs.
const MAX_SWEEPS: usize = 20;

/// Eigenvalues, in no particular order, and the eigenvectors that belong to them: `a = sum_k value[k] vector[k]
/// vector[k]^T`.
pub fn symmetric_eigen(a: &Voigt) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut diagonal = [a[0], a[1], a[2]];
    // off[r] is the entry in row and column other than r.
    let mut off = [a[4], a[5], a[3]];
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..MAX_SWEEPS {
        let rotated = rotate::<1, 2, 0>(&mut diagonal, &mut off, &mut vectors)
            | rotate::<2, 0, 1>(&mut diagonal, &mut off, &mut vectors)
            | rotate::<0, 1, 2>(&mut diagonal, &mut off, &mut vectors);
        if !rotated {
            break;
        }
    }
    (diagonal, vectors)
}

/// Makes the entry in row P and column Q zero, and says whether it was not; R is the third row. Constants, so that all stays
/// in registers.
#[inline(always)]
fn rotate<const P: usize, const Q: usize, const R: usize>(
    diagonal: &mut [f64; 3],
    off: &mut [f64; 3],
    vectors: &mut [[f64; 3]; 3],
) -> bool {
    let apq = off[R];
    let negligible = 0.25 * f64::EPSILON * f64::EPSILON * (diagonal[P] * diagonal[Q]).abs();
    if apq * apq <= negligible {
        return false;
    }
    let theta = 0.5 * (diagonal[Q] - diagonal[P]) / apq;
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    diagonal[P] -= t * apq;
    diagonal[Q] += t * apq;
    off[R] = 0.0;
    (off[Q], off[P]) = (c * off[Q] - s * off[P], s * off[Q] + c * off[P]);
    for i in 0..3 {
        let (vp, vq) = (vectors[P][i], vectors[Q][i]);
        vectors[P][i] = c * vp - s * vq;
        vectors[Q][i] = s * vp + c * vq;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Random, rotation};
    use super::super::voigt::{Voigt, to_matrix};
    use super::*;
    use crate::{Mat3, Vec3};

    fn voigt(m: &Mat3) -> Voigt {
        [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(1, 2)], m[(2, 0)]]
    }

    /// Worst errors of eigenvalues (relative), of the recomposition and of orthonormality.
    fn errors(values: [f64; 3], r: &Mat3) -> (f64, f64, f64) {
        let m = r * Mat3::from_diagonal(&values.into()) * r.transpose();
        let (mut found, vectors) = symmetric_eigen(&voigt(&m));
        let v = Mat3::from_columns(&vectors.map(Vec3::from));
        let back = (v * Mat3::from_diagonal(&found.into()) * v.transpose() - to_matrix(&voigt(&m))).norm() / m.norm();
        let orthonormal = (v.transpose() * v - Mat3::identity()).norm();
        let mut exact = values;
        exact.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        let value = (0..3).map(|k| (found[k] / exact[k] - 1.0).abs()).fold(0.0, f64::max);
        (value, back, orthonormal)
    }

    #[test]
    fn full_accuracy_whatever_the_gaps() {
        let mut random = Random::new(1);
        for gap in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 3.0] {
            for _ in 0..20 {
                let r = rotation(random.vector(3.0));
                for values in [[1.0, 1.0 + gap, 1.0 + gap], [2.0, 2.0 + gap, 0.5], [1.0, 1.0 + gap, 1.0 - 0.3 * gap]] {
                    let (value, back, orthonormal) = errors(values, &r);
                    assert!(value < 4e-15 && back < 4e-15 && orthonormal < 4e-15, "{gap} {value} {back} {orthonormal}");
                }
            }
        }
    }

    #[test]
    fn diagonal_is_exact() {
        let (values, vectors) = symmetric_eigen(&[3.0, 1.0, 2.0, 0.0, 0.0, 0.0]);
        assert_eq!(values, [3.0, 1.0, 2.0]);
        assert_eq!(vectors, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }

    #[test]
    fn scale_does_not_matter() {
        let m = [2.0, 3.0, 1.0, 0.4, -0.2, 0.7];
        let (values, _) = symmetric_eigen(&m);
        let (scaled, _) = symmetric_eigen(&m.map(|x| x * 1e-60));
        (0..3).for_each(|k| assert!((scaled[k] / (1e-60 * values[k]) - 1.0).abs() < 1e-14));
    }
}
