//! Material models with their parameters.

use crate::Mat3;
use crate::solid::voigt::Voigt;

/// The material models and their parameters, checked to be physical.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialModel {
    /// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.
    NeoHookean { young: f64, poisson: f64 },
    /// Kirchhoff stress linear in the logarithmic strain.
    Hooke { young: f64, poisson: f64 },
    /// Orthotropic, linear in the logarithmic strain.
    Orthotropic(Orthotropy),
    /// An isochoric law, and K/2 (J - 1)^2 with the bulk modulus K.
    Hyperelastic { law: Isochoric, bulk: f64 },
    /// Elastic-plastic in logarithmic strain, by von Mises or, when given, by Hill.
    Plastic { young: f64, poisson: f64, hill: Option<Hill>, hardening: Hardening },
}

impl MaterialModel {
    /// Young's modulus; of an orthotropic material that of its mean over all directions.
    pub fn young(&self) -> f64 {
        match *self {
            Self::NeoHookean { young, .. } | Self::Hooke { young, .. } | Self::Plastic { young, .. } => young,
            Self::Hyperelastic { ref law, bulk } => 9.0 * bulk * law.shear() / (3.0 * bulk + law.shear()),
            Self::Orthotropic(ref constants) => {
                let (lambda, mu) = constants.isotropic();
                mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu)
            }
        }
    }

    /// Poisson's ratio in the undeformed state; of an orthotropic material as Young's modulus.
    pub fn poisson(&self) -> f64 {
        match *self {
            Self::NeoHookean { poisson, .. } | Self::Hooke { poisson, .. } | Self::Plastic { poisson, .. } => poisson,
            Self::Hyperelastic { ref law, bulk } => {
                let shear = law.shear();
                0.5 * (3.0 * bulk - 2.0 * shear) / (3.0 * bulk + shear)
            }
            Self::Orthotropic(ref constants) => {
                let (lambda, mu) = constants.isotropic();
                0.5 * lambda / (lambda + mu)
            }
        }
    }

    /// Why the material nearly keeps its volume, in words that follow "a material"; `None` when it does not.
    pub fn keeps_volume(&self) -> Option<&'static str> {
        /// Poisson's ratio from which elements with full integration are clearly too stiff.
        const STIFF: f64 = 0.45;
        match *self {
            Self::Plastic { .. } => Some("that flows plastically"),
            _ if self.poisson() > STIFF => Some("with Poisson's ratio above 0.45"),
            _ => None,
        }
    }
}

/// What resists a change of shape, by the isochoric left Cauchy-Green tensor with the invariants I1 and I2.
#[derive(Clone, Debug, PartialEq)]
pub enum Isochoric {
    /// c10 (I1 - 3) + c01 (I2 - 3).
    MooneyRivlin { c10: f64, c01: f64 },
    /// c10 (I1 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3.
    Yeoh { c10: f64, c20: f64, c30: f64 },
    /// Terms (mu, alpha) of 2 mu / alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3), with the isochoric stretches l.
    Ogden(Vec<[f64; 2]>),
}

impl Isochoric {
    /// Shear modulus in the undeformed state.
    pub fn shear(&self) -> f64 {
        match self {
            Self::MooneyRivlin { c10, c01 } => 2.0 * (c10 + c01),
            Self::Yeoh { c10, .. } => 2.0 * c10,
            Self::Ogden(terms) => terms.iter().map(|term| term[0]).sum(),
        }
    }
}
/// Engineering constants of an orthotropic material.
#[derive(Clone, Debug, PartialEq)]
pub struct Orthotropy {
    /// E1, E2, E3.
    pub young: [f64; 3],
    /// nu12, nu13, nu23: of the contraction along the second axis under tension along the first.
    pub poisson: [f64; 3],
    /// G12, G13, G23.
    pub shear: [f64; 3],
    /// Columns are the axes of the material in the reference state, orthonormal.
    pub axes: Mat3,
}

impl Orthotropy {
    /// The compliance of normal stresses.
    pub fn compliance(&self) -> Mat3 {
        let ([e1, e2, e3], [nu12, nu13, nu23]) = (self.young, self.poisson);
        let (a, b, c) = (-nu12 / e1, -nu13 / e1, -nu23 / e2);
        Mat3::new(1.0 / e1, a, b, a, 1.0 / e2, c, b, c, 1.0 / e3)
    }

    /// The moduli by the axes, for engineering shears; `None` unless they are positive definite.
    pub fn moduli(&self) -> Option<[Voigt; 6]> {
        let normal = self.compliance().cholesky()?.inverse();
        let [g12, g13, g23] = self.shear;
        let mut moduli = [[0.0; 6]; 6];
        for i in 0..3 {
            (0..3).for_each(|j| moduli[i][j] = 0.5 * (normal[(i, j)] + normal[(j, i)]));
        }
        [g12, g23, g13].into_iter().enumerate().for_each(|(k, g)| moduli[3 + k][3 + k] = g);
        [g12, g23, g13].iter().all(|g| *g > 0.0).then_some(moduli)
    }

    /// Lame's constants (lambda, mu) of the moduli's mean over all directions (Voigt).
    pub fn isotropic(&self) -> (f64, f64) {
        let c = self.moduli().unwrap_or_default();
        let normal = c[0][0] + c[1][1] + c[2][2];
        let (across, shear) = (c[0][1] + c[1][2] + c[2][0], c[3][3] + c[4][4] + c[5][5]);
        let mu = (normal - across + 3.0 * shear) / 15.0;
        ((normal + 2.0 * across) / 9.0 - 2.0 / 3.0 * mu, mu)
    }
}

/// Hill's criterion of 1948.
#[derive(Clone, Debug, PartialEq)]
pub struct Hill {
    /// F, G, H, L, M, N.
    pub coefficients: [f64; 6],
    /// Columns are the axes of the material in the reference state, orthonormal.
    pub axes: Mat3,
}

/// The yield stress by the equivalent plastic strain; it is above 0 and never falls.
#[derive(Clone, Debug, PartialEq)]
pub enum Hardening {
    /// yield_stress + modulus e; perfectly plastic when the modulus is 0.
    Linear { yield_stress: f64, modulus: f64 },
    /// k (e0 + e)^n.
    Swift { k: f64, e0: f64, n: f64 },
    /// yield_stress + modulus e + (saturation - yield_stress) (1 - exp(-rate e)).
    Voce { yield_stress: f64, saturation: f64, rate: f64, modulus: f64 },
    /// Points (e, stress) from e = 0; linear between them, constant after the last.
    Table(Vec<[f64; 2]>),
}
