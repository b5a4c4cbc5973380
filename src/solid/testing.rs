//! What the tests of this module share: accurate finite differences, repeatable random numbers, rotations.

use crate::{Mat3, Vec3};

/// Corners of the unit cube as hexahedra have them.
pub const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// Derivative of `f` at 0 by the sixth-order central difference; `step` trades truncation (step^6) for rounding
/// (1/step).
pub fn derivative<const N: usize>(step: f64, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (k, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        let (plus, minus) = (f(k * step), f(-k * step));
        (0..N).for_each(|i| sum[i] += weight * (plus[i] - minus[i]) / (60.0 * step));
    }
    sum
}

/// Largest difference of two arrays over the largest entry of the second.
pub fn relative_error<'a>(a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>) -> f64 {
    let (mut difference, mut size) = (0f64, 0f64);
    for (x, y) in a.into_iter().zip(b) {
        assert!(x.is_finite() && y.is_finite());
        difference = difference.max((x - y).abs());
        size = size.max(y.abs());
    }
    difference / size
}

/// Repeatable random numbers (splitmix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in [-size, size].
    pub fn number(&mut self, size: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        size * (((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    }

    pub fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::from_fn(|_, _| self.number(size))
    }

    pub fn matrix(&mut self, size: f64) -> Mat3 {
        Mat3::from_fn(|_, _| self.number(size))
    }

    pub fn points<const N: usize>(&mut self, size: f64) -> [[f64; 3]; N] {
        [[0.0; 3]; N].map(|p| p.map(|_| self.number(size)))
    }
}

/// Rotation by the rotation vector `w`.
pub fn rotation(w: Vec3) -> Mat3 {
    nalgebra::Rotation3::new(w).into_inner()
}

/// The displacements that take `x` to F x + shift.
pub fn affine<const N: usize>(x: &[[f64; 3]; N], f: &Mat3, shift: Vec3) -> [[f64; 3]; N] {
    x.map(|p| ((f - Mat3::identity()) * Vec3::from(p) + shift).into())
}

/// Entry-wise sum.
pub fn add<const N: usize>(a: &[[f64; 3]; N], b: &[[f64; 3]; N]) -> [[f64; 3]; N] {
    std::array::from_fn(|n| std::array::from_fn(|i| a[n][i] + b[n][i]))
}
