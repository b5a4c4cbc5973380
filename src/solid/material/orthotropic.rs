//! Orthotropic elasticity in the logarithmic strain: the finite-strain form of the law of engineering constants used here.
//!
//! With E = 1/2 ln C of the reference by the material's axes, and T conjugate to it ([`super::logarithmic`]):
//!
//! ```text
//! W   = 1/2 E : D : E,     T = D : E
//! D^-1 = [  1/E1     -nu12/E1  -nu13/E1            ]
//!        [ -nu12/E1   1/E2     -nu23/E2            ]      xx, yy, zz
//!        [ -nu13/E1  -nu23/E2   1/E3               ]
//!        [            1/G12, 1/G23, 1/G13          ]      engineering shears xy, yz, zx
//! ```
//!
//! The axes stay with the reference, as fibres do that are carried along and turned: the law is hyperelastic and does not see
//! rotations. Against St. Venant and Kirchhoff's, linear in the strain of Green, it does not soften in compression until
//! nothing is left, and is Hencky's where the constants are isotropic. Where a shear is large the axes are no longer at right
//! angles to each other in space, and what that does to a real fabric is not in it.

use super::Response;
use super::logarithmic::LogarithmicStrain;
use super::model::Orthotropy;
use crate::Mat3;
use crate::solid::voigt::{Voigt, double_contraction};

/// An orthotropic elastic material.
#[derive(Clone, Debug)]
pub struct Orthotropic {
    /// Columns are the axes of the material.
    axes: Mat3,
    /// D, for engineering shears.
    moduli: [Voigt; 6],
    /// Lame's constants of their mean over all directions.
    pub isotropic: (f64, f64),
}

impl Orthotropic {
    /// With constants that are admissible.
    pub fn new(constants: &Orthotropy) -> Self {
        Self { axes: constants.axes, moduli: constants.moduli().unwrap_or_default(), isotropic: constants.isotropic() }
    }

    /// Stress and tangent.
    pub fn response(&self, f: &Mat3) -> Option<Response> {
        let strain = self.strain(f)?;
        let (stress, axes) = (self.stress(&strain.strain), strain.axes());
        Some(Response { kirchhoff: axes.kirchhoff(&stress), tangent: axes.tangent(&stress, &self.moduli) })
    }

    /// Kirchhoff stress.
    pub fn kirchhoff(&self, f: &Mat3) -> Option<Voigt> {
        let strain = self.strain(f)?;
        Some(strain.axes().kirchhoff(&self.stress(&strain.strain)))
    }

    /// Stored energy per reference volume.
    pub fn energy(&self, f: &Mat3) -> Option<f64> {
        let strain = self.strain(f)?.strain;
        Some(0.5 * double_contraction(&self.stress(&strain), &strain))
    }

    /// The strain by the material's axes.
    fn strain(&self, f: &Mat3) -> Option<LogarithmicStrain> {
        LogarithmicStrain::new(f * self.axes)
    }

    /// T.
    fn stress(&self, strain: &Voigt) -> Voigt {
        let engineering: Voigt = std::array::from_fn(|v| if v < 3 { strain[v] } else { 2.0 * strain[v] });
        self.moduli.map(|row| row.iter().zip(&engineering).map(|(d, e)| d * e).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{Random, derivative, relative_error, rotation};
    use super::super::{Material, MaterialModel, State};
    use super::*;
    use crate::Vec3;
    use crate::solid::voigt::to_matrix;

    /// Spruce, N/mm^2, and a laminate that is much stiffer one way; isotropic constants besides.
    fn constants(axes: Mat3) -> [Orthotropy; 3] {
        [
            Orthotropy {
                young: [11000.0, 890.0, 430.0],
                poisson: [0.38, 0.48, 0.51],
                shear: [690.0, 620.0, 40.0],
                axes,
            },
            Orthotropy { young: [140e3, 10e3, 10e3], poisson: [0.3, 0.3, 0.45], shear: [5e3, 5e3, 3.4e3], axes },
            Orthotropy { young: [10.0; 3], poisson: [0.3; 3], shear: [10.0 / 2.6; 3], axes },
        ]
    }

    fn gradients() -> Vec<Mat3> {
        let mut random = Random::new(41);
        let mut list: Vec<Mat3> = (0..8).map(|_| Mat3::identity() + random.matrix(0.3)).collect();
        list.push(Mat3::identity());
        list.push(rotation(random.vector(2.0)) * Mat3::from_diagonal(&Vec3::new(1.2, 1.2 + 1e-9, 0.7)));
        list
    }

    #[test]
    fn stress_and_tangent_are_derivatives() {
        let mut random = Random::new(42);
        for constants in constants(rotation(random.vector(2.0))) {
            let scale = constants.young[0];
            let material = Orthotropic::new(&constants);
            for f in gradients() {
                let l = random.matrix(1.0);
                let Response { kirchhoff, tangent } = material.response(&f).unwrap();
                assert_eq!(kirchhoff, material.kirchhoff(&f).unwrap());
                let tau = to_matrix(&kirchhoff);
                let power = derivative(2e-3, |t| [material.energy(&(f + t * l * f)).unwrap()])[0];
                assert!((power - tau.dot(&l)).abs() < 1e-11 * scale, "{power}");
                let rate = to_matrix(&derivative(1e-3, |t| material.kirchhoff(&(f + t * l * f)).unwrap()));
                let lie = rate - l * tau - tau * l.transpose();
                let d = 0.5 * (l + l.transpose());
                let sums = [d[(0, 0)], d[(1, 1)], d[(2, 2)], 2.0 * d[(0, 1)], 2.0 * d[(1, 2)], 2.0 * d[(2, 0)]];
                let product = to_matrix(&tangent.map(|row| (0..6).map(|j| row[j] * sums[j]).sum()));
                let error = relative_error(product.iter(), lie.iter());
                assert!(error < 1e-9, "{error}");
            }
        }
    }

    /// The observer may turn, and the body may be turned with its axes before it deforms.
    #[test]
    fn turns_with_the_observer_and_with_the_axes() {
        let mut random = Random::new(43);
        let axes = rotation(random.vector(2.0));
        for f in gradients() {
            let (r, q) = (rotation(random.vector(3.0)), rotation(random.vector(3.0)));
            for (one, turned) in constants(axes).iter().zip(&constants(q * axes)) {
                let scale = one.young[0];
                let [one, turned] = [one, turned].map(Orthotropic::new);
                let found = to_matrix(&turned.kirchhoff(&(r * f * q.transpose())).unwrap());
                let tau = r * to_matrix(&one.kirchhoff(&f).unwrap()) * r.transpose();
                assert!((found - tau).norm() < 1e-13 * scale);
            }
        }
    }

    #[test]
    fn engineering_constants_are_those_of_tension_and_shear() {
        for constants in constants(Mat3::identity()) {
            let material = Orthotropic::new(&constants);
            let Orthotropy { young, poisson: [nu12, nu13, nu23], shear, .. } = constants;
            let [nu21, nu31, nu32] =
                [nu12 * young[1] / young[0], nu13 * young[2] / young[0], nu23 * young[2] / young[1]];
            for (d, lateral) in [[-1.0, nu12, nu13], [nu21, -1.0, nu23], [nu31, nu32, -1.0]].iter().enumerate() {
                let strain = 0.2f64;
                let f = Mat3::from_diagonal(&Vec3::from_fn(|i, _| (-lateral[i] * strain).exp()));
                let tau = material.kirchhoff(&f).unwrap();
                for (v, value) in tau.iter().enumerate() {
                    let exact = if v == d { young[d] * strain } else { 0.0 };
                    assert!((value - exact).abs() < 1e-12 * young[0], "{d} {v} {value} {exact}");
                }
            }
            for ((i, j), modulus) in [(0, 1), (0, 2), (1, 2)].into_iter().zip(shear) {
                let mut f = Mat3::identity();
                f[(i, j)] = 1e-7;
                let tau = to_matrix(&material.kirchhoff(&f).unwrap());
                assert!((tau[(i, j)] / (modulus * 1e-7) - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn isotropic_constants_are_henckys_law() {
        let [.., same] = constants(rotation(Vec3::new(0.3, 0.7, -1.0)));
        let hooke = Material::new(&MaterialModel::Hooke { young: 10.0, poisson: 0.3 });
        for f in gradients() {
            let [a, b] = [Orthotropic::new(&same).response(&f), hooke.response(&f, &State::VIRGIN)].map(Option::unwrap);
            assert!((to_matrix(&a.kirchhoff) - to_matrix(&b.kirchhoff)).norm() < 1e-12);
            let apart = |i: usize| (0..6).map(|j| (a.tangent[i][j] - b.tangent[i][j]).abs()).fold(0.0, f64::max);
            assert!((0..6).map(apart).fold(0.0, f64::max) < 1e-11);
        }
        assert!(hooke.initial_moduli().1 - same.isotropic().1 < 1e-14);
    }
}
