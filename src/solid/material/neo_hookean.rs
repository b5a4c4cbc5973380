//! Compressible neo-Hookean material.
//!
//! ```text
//! W   = mu/2 (tr b - 3) - mu ln J + lambda/2 ln^2 J
//! tau = mu (b - 1) + lambda ln J 1
//! c   = lambda 1 x 1 + 2 (mu - lambda ln J) I
//! ```
//!
//! Simo and Pister, CMAME 46 (1984); Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis.

use super::Response;
use crate::Mat3;
use crate::solid::voigt::{Voigt, left_cauchy_green};

/// Neo-Hookean material with Lame's constants.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean {
    pub lambda: f64,
    pub mu: f64,
}

impl NeoHookean {
    /// Stress and tangent.
    pub fn response(&self, f: &Mat3) -> Option<Response> {
        let pressure = self.lambda * log_volume(f)?;
        let shear = self.mu - pressure;
        let mut tangent = [[0.0; 6]; 6];
        for i in 0..3 {
            tangent[i][..3].fill(self.lambda);
            tangent[i][i] += 2.0 * shear;
            tangent[i + 3][i + 3] = shear;
        }
        Some(Response { kirchhoff: self.stress(f, pressure), tangent })
    }

    /// Kirchhoff stress.
    pub fn kirchhoff(&self, f: &Mat3) -> Option<Voigt> {
        Some(self.stress(f, self.lambda * log_volume(f)?))
    }

    /// Stored energy per reference volume.
    pub fn energy(&self, f: &Mat3) -> Option<f64> {
        let log_j = log_volume(f)?;
        Some(self.mu * (0.5 * (f.norm_squared() - 3.0) - log_j) + 0.5 * self.lambda * log_j * log_j)
    }

    fn stress(&self, f: &Mat3, pressure: f64) -> Voigt {
        let b = left_cauchy_green(f);
        let normal = |b: f64| self.mu * (b - 1.0) + pressure;
        [normal(b[0]), normal(b[1]), normal(b[2]), self.mu * b[3], self.mu * b[4], self.mu * b[5]]
    }
}

/// ln J, or `None` unless J > 0.
fn log_volume(f: &Mat3) -> Option<f64> {
    let j = f.determinant();
    (j > 0.0).then(|| j.ln())
}
