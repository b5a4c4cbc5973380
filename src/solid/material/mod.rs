//! Materials: Kirchhoff stress and spatial tangent from the deformation gradient.
//!
//! With the stored energy W(F) per reference volume, the velocity gradient L = F' F^-1 and d = sym L:
//!
//! ```text
//! tau = dW/dF F^T                        Kirchhoff stress, J times the Cauchy stress
//! tau' - L tau - tau L^T = c : d         c: the tangent of the Lie derivative
//! ```
//!
//! c is stored 6x6 in [`super::voigt`] order for engineering shear rates. It has the minor symmetries, and the major one, as
//! there is an energy, of an increment at least. A material with memory is asked for what it is at the end of an increment
//! that begins in a [`State`]; it changes nothing, so an increment can be tried again.

mod hardening;
mod hencky;
mod hyperelastic;
mod logarithmic;
mod model;
mod neo_hookean;
mod orthotropic;
mod plastic;

pub use logarithmic::strain_between;

use super::voigt::Voigt;
use crate::Mat3;
pub use hencky::Hencky;
pub use hyperelastic::Hyperelastic;
pub use model::{Hardening, Hill, Isochoric, MaterialModel, Orthotropy};
pub use neo_hookean::NeoHookean;
pub use orthotropic::Orthotropic;
pub use plastic::Plastic;

/// How a material has flowed at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The inverse of the plastic deformation gradient, by the material's axes.
    pub inverse_plastic: Mat3,
    /// Equivalent plastic strain.
    pub equivalent: f64,
    /// A step has begun since it flowed, or a table has turned, which may ease what is at its yield limit.
    pub rests: bool,
}

crate::words!(State { inverse_plastic, equivalent, rests });

impl State {
    /// Of a material that has not flowed.
    pub const VIRGIN: Self =
        Self { inverse_plastic: Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), equivalent: 0.0, rests: false };
}

/// Stress and tangent at a point, in the unit of the moduli.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// tau: xx, yy, zz, xy, yz, zx.
    pub kirchhoff: Voigt,
    /// c, symmetric.
    pub tangent: [Voigt; 6],
}

/// A material with its constants.
#[derive(Clone, Debug)]
pub enum Material {
    NeoHookean(NeoHookean),
    Hencky(Hencky),
    Hyperelastic(Box<Hyperelastic>),
    Orthotropic(Box<Orthotropic>),
    Plastic(Box<Plastic>),
}

impl Material {
    /// The material of a card.
    pub fn new(model: &MaterialModel) -> Self {
        match model {
            &MaterialModel::NeoHookean { young, poisson } => {
                let (lambda, mu) = lame(young, poisson);
                Self::NeoHookean(NeoHookean { lambda, mu })
            }
            &MaterialModel::Hooke { young, poisson } => {
                let (lambda, mu) = lame(young, poisson);
                Self::Hencky(Hencky { lambda, mu })
            }
            MaterialModel::Hyperelastic { law, bulk } => {
                Self::Hyperelastic(Box::new(Hyperelastic { law: law.clone(), bulk: *bulk }))
            }
            MaterialModel::Orthotropic(constants) => Self::Orthotropic(Box::new(Orthotropic::new(constants))),
            MaterialModel::Plastic { young, poisson, hill, hardening } => {
                Self::Plastic(Box::new(Plastic::new(lame(*young, *poisson), hill.as_ref(), hardening.clone())))
            }
        }
    }

    /// Lame's constants (lambda, mu) in the undeformed state; of an orthotropic material those of the mean over all
    /// directions.
    pub fn initial_moduli(&self) -> (f64, f64) {
        match self {
            &Self::NeoHookean(NeoHookean { lambda, mu }) | &Self::Hencky(Hencky { lambda, mu }) => (lambda, mu),
            Self::Hyperelastic(material) => {
                let shear = material.law.shear();
                (material.bulk - 2.0 / 3.0 * shear, shear)
            }
            Self::Orthotropic(material) => material.isotropic,
            Self::Plastic(material) => (material.lambda(), material.mu),
        }
    }

    /// E / (1 - nu^2) in the undeformed state, by which a half-space resists an indenter, force per area.
    pub fn indentation_modulus(&self) -> f64 {
        let (lambda, mu) = self.initial_moduli();
        let poisson = 0.5 * lambda / (lambda + mu);
        2.0 * mu / (1.0 - poisson)
    }

    /// Whether the material has states; without, those given to it do not count.
    pub fn remembers(&self) -> bool {
        match self {
            Self::NeoHookean(_) | Self::Hencky(_) | Self::Hyperelastic(_) | Self::Orthotropic(_) => false,
            Self::Plastic(_) => true,
        }
    }

    /// Stress and tangent at the deformation gradient `f`, reached in one increment from a state; `None` unless det F > 0.
    #[inline(always)]
    pub fn response(&self, f: &Mat3, before: &State) -> Option<Response> {
        match self {
            Self::NeoHookean(material) => material.response(f),
            Self::Hencky(material) => material.response(f),
            Self::Hyperelastic(material) => material.response(f),
            Self::Orthotropic(material) => material.response(f),
            Self::Plastic(material) => material.response(f, before),
        }
    }

    /// The stress of [`Material::response`] alone.
    #[inline(always)]
    pub fn kirchhoff(&self, f: &Mat3, before: &State) -> Option<Voigt> {
        match self {
            Self::NeoHookean(material) => material.kirchhoff(f),
            Self::Hencky(material) => material.kirchhoff(f),
            Self::Hyperelastic(material) => material.kirchhoff(f),
            Self::Orthotropic(material) => material.kirchhoff(f),
            Self::Plastic(material) => material.kirchhoff(f, before),
        }
    }

    /// The state at `f`, reached in one increment from a state; `None` unless det F > 0.
    pub fn flow(&self, f: &Mat3, before: &State) -> Option<State> {
        match self {
            Self::NeoHookean(_) | Self::Hencky(_) | Self::Hyperelastic(_) | Self::Orthotropic(_) => Some(*before),
            Self::Plastic(material) => material.flow(f, before),
        }
    }

    /// Stored energy per reference volume at `f`, reached in one increment from a state; `None` unless det F > 0.
    pub fn energy(&self, f: &Mat3, before: &State) -> Option<f64> {
        match self {
            Self::NeoHookean(material) => material.energy(f),
            Self::Hencky(material) => material.energy(f),
            Self::Hyperelastic(material) => material.energy(f),
            Self::Orthotropic(material) => material.energy(f),
            Self::Plastic(material) => material.energy(f, before),
        }
    }

    /// Work of the stress on plastic strain, per reference volume, until a state.
    pub fn plastic_work(&self, state: &State) -> f64 {
        match self {
            Self::NeoHookean(_) | Self::Hencky(_) | Self::Hyperelastic(_) | Self::Orthotropic(_) => 0.0,
            Self::Plastic(material) => material.plastic_work(state),
        }
    }
}

/// Cauchy stress of a Kirchhoff stress at volume ratio J = det F.
pub fn cauchy(kirchhoff: &Voigt, det_f: f64) -> Voigt {
    kirchhoff.map(|t| t / det_f)
}

/// Lame's constants (lambda, mu) of Young's modulus and Poisson's ratio.
fn lame(young: f64, poisson: f64) -> (f64, f64) {
    (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Random, derivative, relative_error, rotation};
    use super::super::voigt::{INDEX, to_matrix};
    use super::*;
    use crate::Vec3;

    const VIRGIN: &State = &State::VIRGIN;

    fn materials() -> [Material; 7] {
        // With Young's modulus 10 and Poisson's ratio 0.3, too.
        let (shear, bulk) = (10.0 / 2.6, 10.0 / 1.2);
        let hyperelastic = |law| Material::new(&MaterialModel::Hyperelastic { law, bulk });
        [
            hyperelastic(Isochoric::MooneyRivlin { c10: 0.4 * shear, c01: 0.1 * shear }),
            hyperelastic(Isochoric::Yeoh { c10: 0.5 * shear, c20: -0.02 * shear, c30: 0.01 * shear }),
            hyperelastic(Isochoric::Ogden(vec![[0.6 * shear, 1.3], [0.1 * shear, 5.0], [0.3 * shear, -2.0]])),
            Material::new(&MaterialModel::NeoHookean { young: 10.0, poisson: 0.3 }),
            Material::new(&MaterialModel::Hooke { young: 10.0, poisson: 0.3 }),
            Material::new(&MaterialModel::NeoHookean { young: 2.0, poisson: 0.49 }),
            Material::new(&MaterialModel::Hooke { young: 2.0, poisson: -0.2 }),
        ]
    }

    /// Deformation gradients with det F > 0: general ones, and every kind of (nearly) repeated stretches, rotated.
    fn gradients() -> Vec<Mat3> {
        let mut random = Random::new(7);
        let mut list: Vec<Mat3> = (0..10).map(|_| Mat3::identity() + random.matrix(0.3)).collect();
        for gap in [0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
            for stretches in [
                [1.0, 1.0 + gap, 1.0],
                [1.0 + gap, 1.0 - gap, 1.0 + 0.4 * gap],
                [1.2, 1.2 + gap, 0.7],
                [1.2, 1.2 + gap, 1.2 - 0.5 * gap],
                [0.5 + gap, 2.0, 0.5],
            ] {
                let stretch = Mat3::from_diagonal(&stretches.into());
                list.push(stretch);
                list.push(rotation(random.vector(2.0)) * stretch * rotation(random.vector(2.0)));
            }
        }
        assert!(list.iter().all(|f| f.determinant() > 0.0));
        list
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        let mut random = Random::new(3);
        for (material, f) in materials().iter().flat_map(|m| gradients().into_iter().map(move |f| (m, f))) {
            let velocity_gradient = random.matrix(1.0);
            let tau = to_matrix(&material.kirchhoff(&f, VIRGIN).unwrap());
            let rate = derivative(2e-3, |t| [material.energy(&(f + t * velocity_gradient * f), VIRGIN).unwrap()])[0];
            assert!((rate - tau.dot(&velocity_gradient)).abs() < 1e-12 * material.initial_moduli().1 * 10.0);
        }
    }

    #[test]
    fn tangent_is_the_lie_derivative_of_the_stress() {
        let mut random = Random::new(4);
        for (material, f) in materials().iter().flat_map(|m| gradients().into_iter().map(move |f| (m, f))) {
            let l = random.matrix(1.0);
            let response = material.response(&f, VIRGIN).unwrap();
            let tau = to_matrix(&response.kirchhoff);
            let rate = to_matrix(&derivative(1e-3, |t| material.kirchhoff(&(f + t * l * f), VIRGIN).unwrap()));
            let lie = rate - l * tau - tau * l.transpose();
            let d = 0.5 * (l + l.transpose());
            let engineering = [d[(0, 0)], d[(1, 1)], d[(2, 2)], 2.0 * d[(0, 1)], 2.0 * d[(1, 2)], 2.0 * d[(2, 0)]];
            let product = to_matrix(&response.tangent.map(|row| (0..6).map(|j| row[j] * engineering[j]).sum()));
            let error = relative_error(product.iter(), lie.iter());
            assert!(error < 2e-11, "{material:?} {f} {error}");
        }
    }

    #[test]
    fn response_and_stress_agree_and_the_tangent_is_symmetric() {
        for (material, f) in materials().iter().flat_map(|m| gradients().into_iter().map(move |f| (m, f))) {
            let response = material.response(&f, VIRGIN).unwrap();
            assert_eq!(response.kirchhoff, material.kirchhoff(&f, VIRGIN).unwrap());
            for i in 0..6 {
                for j in 0..i {
                    assert_eq!(response.tangent[i][j], response.tangent[j][i]);
                }
            }
        }
    }

    #[test]
    fn hookes_law_in_the_undeformed_state() {
        for material in materials() {
            let (lambda, mu) = material.initial_moduli();
            let response = material.response(&Mat3::identity(), VIRGIN).unwrap();
            assert_eq!(response.kirchhoff, [0.0; 6]);
            assert_eq!(material.energy(&Mat3::identity(), VIRGIN), Some(0.0));
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                let shear = if i < 3 { 2.0 * mu } else { mu };
                let exact = if i < 3 && j < 3 { lambda } else { 0.0 } + if i == j { shear } else { 0.0 };
                assert!((response.tangent[i][j] - exact).abs() < 4e-15 * mu);
            }
            let (e, nu) = (mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), lambda / (2.0 * (lambda + mu)));
            assert!((e - 10.0).abs() < 1e-13 && (nu - 0.3).abs() < 1e-15 || (e - 2.0).abs() < 1e-13);
        }
    }

    #[test]
    fn turns_with_the_observer_and_is_isotropic() {
        let mut random = Random::new(5);
        for (material, f) in materials().iter().flat_map(|m| gradients().into_iter().map(move |f| (m, f))) {
            let (r, q) = (rotation(random.vector(3.0)), rotation(random.vector(3.0)));
            let (a, b) = (material.response(&f, VIRGIN).unwrap(), material.response(&(r * f * q), VIRGIN).unwrap());
            let turned = r * to_matrix(&a.kirchhoff) * r.transpose();
            let (lambda, mu) = material.initial_moduli();
            let scale = lambda.abs() + 2.0 * mu;
            assert!((to_matrix(&b.kirchhoff) - turned).norm() < 2e-14 * scale);
            let energy = |f: &Mat3| material.energy(f, VIRGIN).unwrap();
            assert!((energy(&f) - energy(&(r * f * q))).abs() < 1e-14 * scale);
            let component = |c: &[Voigt; 6], n: [usize; 4]| c[INDEX[n[0]][n[1]]][INDEX[n[2]][n[3]]];
            let each = |n: usize| [n / 27, n / 9 % 3, n / 3 % 3, n % 3];
            for to in (0..81).map(each) {
                let weight = |from: [usize; 4]| (0..4).map(|k| r[(to[k], from[k])]).product::<f64>();
                let sum: f64 = (0..81).map(each).map(|from| weight(from) * component(&a.tangent, from)).sum();
                assert!((component(&b.tangent, to) - sum).abs() < 1e-13 * scale);
            }
        }
    }

    #[test]
    fn confined_compression_in_closed_form() {
        for s in [0.4, 0.9, 1.0, 1.7] {
            let f = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, s));
            for material in materials() {
                let (lambda, mu) = material.initial_moduli();
                let axial = match material {
                    Material::NeoHookean(_) => mu * (s * s - 1.0) + lambda * s.ln(),
                    Material::Hencky(_) | Material::Plastic(_) => (lambda + 2.0 * mu) * s.ln(),
                    Material::Hyperelastic(_) | Material::Orthotropic(_) => continue,
                };
                let exact = [lambda * s.ln(), lambda * s.ln(), axial, 0.0, 0.0, 0.0];
                let found = cauchy(&material.kirchhoff(&f, VIRGIN).unwrap(), s);
                (0..6).for_each(|i| assert!((found[i] - exact[i] / s).abs() < 1e-14 * (lambda + mu).abs()));
            }
        }
    }

    #[test]
    fn uniaxial_tension_of_the_logarithmic_law_is_hookes() {
        let material = Material::new(&MaterialModel::Hooke { young: 10.0, poisson: 0.3 });
        for s in [0.5f64, 1.2, 1.39] {
            let t = s.powf(-0.3);
            let tau = material.kirchhoff(&Mat3::from_diagonal(&Vec3::new(t, s, t)), VIRGIN).unwrap();
            assert!((tau[1] - 10.0 * s.ln()).abs() < 1e-13);
            assert!(tau[0].abs() < 1e-13 && tau[2].abs() < 1e-13);
        }
    }

    #[test]
    fn no_response_when_inverted() {
        let nan = Mat3::identity() * f64::NAN;
        for material in materials() {
            for f in [Mat3::zeros(), Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -1.0)), nan] {
                assert!(material.response(&f, VIRGIN).is_none());
                assert!(material.kirchhoff(&f, VIRGIN).is_none());
                assert!(material.energy(&f, VIRGIN).is_none());
            }
        }
    }
}
