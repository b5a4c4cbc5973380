//! Symmetric second-order tensors as six components in the order xx, yy, zz, xy, yz, zx.
//!
//! Stresses hold the tensor's components. Strains that a 6x6 tangent multiplies have engineering shear, 2 d_xy, so that
//! the tangent's entries are the components c_ijkl themselves.

use super::eigen::symmetric_eigen;
use crate::Mat3;

/// Six components: xx, yy, zz, xy, yz, zx.
pub type Voigt = [f64; 6];

/// Position of component ij.
pub const INDEX: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// Rows and columns of the components.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// The unit tensor.
pub const IDENTITY: Voigt = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// The symmetric tensor as a matrix.
pub fn to_matrix(t: &Voigt) -> Mat3 {
    Mat3::from_fn(|i, j| t[INDEX[i][j]])
}

/// sym(a b^T) as components.
pub fn symmetric_product(a: &[f64; 3], b: &[f64; 3]) -> Voigt {
    let entry = |i: usize, j: usize| 0.5 * (a[i] * b[j] + a[j] * b[i]);
    [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)]
}

/// The left Cauchy-Green tensor b = F F^T.
pub fn left_cauchy_green(f: &Mat3) -> Voigt {
    let entry = |i: usize, j: usize| f[(i, 0)] * f[(j, 0)] + f[(i, 1)] * f[(j, 1)] + f[(i, 2)] * f[(j, 2)];
    [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)]
}

/// The right Cauchy-Green tensor C = F^T F.
pub fn right_cauchy_green(f: &Mat3) -> Voigt {
    left_cauchy_green(&f.transpose())
}

/// a : b of tensor components.
pub fn double_contraction(a: &Voigt, b: &Voigt) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// The tensor with these principal values and directions.
pub fn compose(values: &[f64; 3], directions: &[[f64; 3]; 3]) -> Voigt {
    let mut sum = [0.0; 6];
    for (value, n) in values.iter().zip(directions) {
        let product = symmetric_product(n, n);
        (0..6).for_each(|i| sum[i] += value * product[i]);
    }
    sum
}

/// The logarithm of a positive definite tensor.
pub fn logarithm(t: &Voigt) -> Voigt {
    let (values, directions) = symmetric_eigen(t);
    compose(&values.map(f64::ln), &directions)
}

/// The exponential of a tensor.
pub fn exponential(t: &Voigt) -> Voigt {
    let (values, directions) = symmetric_eigen(t);
    compose(&values.map(f64::exp), &directions)
}

/// The spatial logarithmic strain 1/2 ln b of a deformation gradient.
pub fn logarithmic_strain(f: &Mat3) -> Voigt {
    logarithm(&left_cauchy_green(f)).map(|s| 0.5 * s)
}

/// Adds `factor` t x t to the upper triangle.
pub fn add_square(tangent: &mut [Voigt; 6], factor: f64, t: &Voigt) {
    for i in 0..6 {
        let row = factor * t[i];
        for j in i..6 {
            tangent[i][j] += row * t[j];
        }
    }
}

/// Copies the upper triangle to the lower one.
pub fn mirror(tangent: &mut [Voigt; 6]) {
    for i in 1..6 {
        for j in 0..i {
            tangent[i][j] = tangent[j][i];
        }
    }
}

/// The sum of values times vectors.
#[inline(always)]
pub fn combine(values: &Voigt, vectors: &[Voigt; 6]) -> Voigt {
    let mut sum = [0.0; 6];
    for (value, vector) in values.iter().zip(vectors) {
        (0..6).for_each(|i| sum[i] += value * vector[i]);
    }
    sum
}

/// A M A^T.
#[inline(always)]
pub fn congruent(a: &[Voigt; 6], m: &[Voigt; 6]) -> [Voigt; 6] {
    let (transposed, mut half, mut product) = (transpose(a), [[0.0; 6]; 6], [[0.0; 6]; 6]);
    (0..6).for_each(|i| half[i] = combine(&m[i], &transposed));
    (0..6).for_each(|i| product[i] = combine(&a[i], &half));
    product
}

#[inline(always)]
pub fn transpose(a: &[Voigt; 6]) -> [Voigt; 6] {
    let mut transposed = [[0.0; 6]; 6];
    for i in 0..6 {
        (0..6).for_each(|j| transposed[j][i] = a[i][j]);
    }
    transposed
}

/// Von Mises stress of a Cauchy stress.
pub fn von_mises(s: &Voigt) -> f64 {
    let normal = (s[0] - s[1]).powi(2) + (s[1] - s[2]).powi(2) + (s[2] - s[0]).powi(2);
    let shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
    (0.5 * normal + 3.0 * shear).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn von_mises_of_simple_states() {
        assert_eq!(von_mises(&[-3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 3.0);
        assert_eq!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, -2.0, 0.0]) - 12f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn products_agree_with_matrices() {
        let f = Mat3::new(1.1, 0.2, -0.3, 0.4, 0.9, 0.1, -0.2, 0.5, 1.3);
        assert!((to_matrix(&left_cauchy_green(&f)) - f * f.transpose()).norm() < 1e-15);
        let (a, b) = ([1.0, 2.0, 3.0], [-0.5, 0.25, 4.0]);
        let ab = crate::Vec3::from(a) * crate::Vec3::from(b).transpose();
        assert_eq!(to_matrix(&symmetric_product(&a, &b)), 0.5 * (ab + ab.transpose()));
    }
}
