//! What is shown of stress and strain: the tensors themselves, and numbers that follow from them.

use super::eigen::symmetric_eigen;
use super::voigt::{Voigt, von_mises};

/// A measure of a Cauchy stress, or of the spatial logarithmic strain 1/2 ln b.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Stress,
    VonMises,
    PrincipalStress,
    Strain,
    PrincipalStrain,
}

impl Measure {
    /// Whether it is one of strain.
    pub fn is_of_strain(self) -> bool {
        matches!(self, Self::Strain | Self::PrincipalStrain)
    }

    /// Numbers of a value: 6 of a tensor, 3 principal values, 1 otherwise.
    pub fn width(self) -> usize {
        match self {
            Self::Stress | Self::Strain => 6,
            Self::PrincipalStress | Self::PrincipalStrain => 3,
            Self::VonMises => 1,
        }
    }

    /// Adds the value for a tensor, stress or strain as the measure has it.
    pub fn add(self, of: &Voigt, to: &mut Vec<f64>) {
        match self {
            Self::Stress | Self::Strain => to.extend(of),
            Self::PrincipalStress | Self::PrincipalStrain => to.extend(principal_values(of)),
            Self::VonMises => to.push(von_mises(of)),
        }
    }
}

/// The eigenvalues of a symmetric tensor, the largest first.
pub fn principal_values(t: &Voigt) -> [f64; 3] {
    let (mut values, _) = symmetric_eigen(t);
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

#[cfg(test)]
mod tests {
    use super::super::testing::Random;
    use super::super::voigt::to_matrix;
    use super::*;

    /// Stresses of both signs, equal and zero ones, which [`symmetric_eigen`] is not made for.
    #[test]
    fn principal_values_are_the_eigenvalues() {
        let mut random = Random::new(7);
        let mut tensors = vec![[0.0; 6], [-2.0, -2.0, -2.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 3.0, 0.0, 0.0]];
        for _ in 0..200 {
            let (a, b) = (random.vector(5.0), random.vector(5.0));
            tensors.push([a[0], a[1], a[2], b[0], b[1], b[2]]);
        }
        for t in tensors {
            let mut expected: Vec<f64> = to_matrix(&t).symmetric_eigenvalues().iter().copied().collect();
            expected.sort_by(|a, b| b.total_cmp(a));
            let scale = to_matrix(&t).norm();
            for (found, expected) in principal_values(&t).iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-14 * scale, "{t:?}: {found} {expected}");
            }
        }
    }
}
