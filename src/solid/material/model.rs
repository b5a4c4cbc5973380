//! Material models with their parameters.

use crate::Mat3;

/// The material models and their parameters, checked to be physical.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialModel {
    /// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.
    NeoHookean { young: f64, poisson: f64 },
    /// Kirchhoff stress linear in the logarithmic strain.
    Hooke { young: f64, poisson: f64 },
    /// An isochoric law, and K/2 (J - 1)^2 with the bulk modulus K.
    Hyperelastic { law: Isochoric, bulk: f64 },
    /// Elastic-plastic in logarithmic strain, by von Mises or, when given, by Hill.
    Plastic { young: f64, poisson: f64, hill: Option<Hill>, hardening: Hardening },
}

impl MaterialModel {
    /// Young's modulus.
    pub fn young(&self) -> f64 {
        match *self {
            Self::NeoHookean { young, .. } | Self::Hooke { young, .. } | Self::Plastic { young, .. } => young,
            Self::Hyperelastic { ref law, bulk } => 9.0 * bulk * law.shear() / (3.0 * bulk + law.shear()),
        }
    }

    /// Poisson's ratio in the undeformed state.
    pub fn poisson(&self) -> f64 {
        match *self {
            Self::NeoHookean { poisson, .. } | Self::Hooke { poisson, .. } | Self::Plastic { poisson, .. } => poisson,
            Self::Hyperelastic { ref law, bulk } => {
                let shear = law.shear();
                0.5 * (3.0 * bulk - 2.0 * shear) / (3.0 * bulk + shear)
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
