//! Material models with their parameters.

use crate::Mat3;

/// The material models and their parameters, checked to be physical.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialModel {
    /// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.
    NeoHookean { young: f64, poisson: f64 },
    /// Kirchhoff stress linear in the logarithmic strain.
    Hooke { young: f64, poisson: f64 },
    /// Elastic-plastic in logarithmic strain, by von Mises or, when given, by Hill.
    Plastic { young: f64, poisson: f64, hill: Option<Hill>, hardening: Hardening },
}

impl MaterialModel {
    /// Young's modulus.
    pub fn young(&self) -> f64 {
        match *self {
            Self::NeoHookean { young, .. } | Self::Hooke { young, .. } | Self::Plastic { young, .. } => young,
        }
    }

    /// Why the material nearly keeps its volume, in words that follow "a material"; `None` when it does not.
    pub fn keeps_volume(&self) -> Option<&'static str> {
        /// Poisson's ratio from which elements with full integration are clearly too stiff.
        const STIFF: f64 = 0.45;
        match *self {
            Self::Plastic { .. } => Some("that flows plastically"),
            Self::NeoHookean { poisson, .. } | Self::Hooke { poisson, .. } if poisson > STIFF => {
                Some("with Poisson's ratio above 0.45")
            }
            _ => None,
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
