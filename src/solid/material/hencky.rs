//! Hencky's material: Kirchhoff stress linear in the logarithmic strain; the finite-strain form of Hooke's law used
//! here.
//!
//! ```text
//! e   = ln V = 1/2 ln b = sum_A e_A n_A x n_A
//! W   = mu e:e + lambda/2 (tr e)^2,     tr e = ln J
//! tau = 2 mu e + lambda tr e 1 = sum_A t_A n_A x n_A
//! c   = lambda 1 x 1 + sum_A 2 (mu - t_A) M_A x M_A + sum_{A<B} s_AB N_AB x N_AB
//! M_A = n_A x n_A,   N_AB = n_A x n_B + n_B x n_A
//! s_AB = (t_A b_B - t_B b_A) / (b_A - b_B) = mu x coth x - (t_A + t_B)/2,   x = e_A - e_B,  b_A = exp 2 e_A
//! ```
//!
//! The first form of s_AB is 0/0 for equal stretches; the second is regular, even in x and 1 in its first factor at x =
//! 0, so it is exact for equal stretches and loses nothing for nearly equal ones, whatever eigenvectors stand for them.
//!
//! The law is Hooke's at small strain, objective and hyperelastic, with tension and compression alike in logarithmic
//! strain. It fits metals at moderate strain (Anand, J. Appl. Mech. 46, 1979) and is elliptic for stretches from 0.21
//! to 1.39 (Bruhns, Xiao and Meyers, Proc. R. Soc. A 457, 2001). Plasticity in logarithmic strain has it as its elastic
//! part. The principal form of c is Simo and Taylor's, CMAME 85 (1991).

use super::Response;
use super::logarithmic::Principal;
use crate::Mat3;
use crate::solid::voigt::{IDENTITY, Voigt, add_square, compose, left_cauchy_green, mirror, symmetric_product};

/// Hencky's material with Lame's constants.
#[derive(Clone, Copy, Debug)]
pub struct Hencky {
    pub lambda: f64,
    pub mu: f64,
}

impl Hencky {
    /// Stress and tangent.
    pub fn response(&self, f: &Mat3) -> Option<Response> {
        let Principal { strains: strain, directions, .. } = principal(f)?;
        let stress = self.principal_stress(&strain);
        let mut tangent = [[0.0; 6]; 6];
        add_square(&mut tangent, self.lambda, &IDENTITY);
        for a in 0..3 {
            let b = (a + 1) % 3;
            let normal = symmetric_product(&directions[a], &directions[a]);
            add_square(&mut tangent, 2.0 * (self.mu - stress[a]), &normal);
            let shear = self.mu * x_coth_x(strain[a] - strain[b]) - 0.5 * (stress[a] + stress[b]);
            add_square(&mut tangent, 4.0 * shear, &symmetric_product(&directions[a], &directions[b]));
        }
        mirror(&mut tangent);
        Some(Response { kirchhoff: compose(&stress, &directions), tangent })
    }

    /// Kirchhoff stress.
    pub fn kirchhoff(&self, f: &Mat3) -> Option<Voigt> {
        let Principal { strains: strain, directions, .. } = principal(f)?;
        Some(compose(&self.principal_stress(&strain), &directions))
    }

    /// Stored energy per reference volume.
    pub fn energy(&self, f: &Mat3) -> Option<f64> {
        let e = principal(f)?.strains;
        let trace = e[0] + e[1] + e[2];
        Some(self.mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + 0.5 * self.lambda * trace * trace)
    }

    fn principal_stress(&self, strain: &[f64; 3]) -> [f64; 3] {
        let mean = self.lambda * (strain[0] + strain[1] + strain[2]);
        strain.map(|e| 2.0 * self.mu * e + mean)
    }
}

/// Principal strains and directions in space; `None` unless det F > 0.
fn principal(f: &Mat3) -> Option<Principal> {
    Principal::new(&left_cauchy_green(f), f.determinant())
}

fn x_coth_x(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x / x.tanh() }
}
