//! What can be written of a state, by the names that users give.

use crate::AXIS_NAMES;
use crate::solid::measure::Measure;

/// A field that a scene may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    // Bodies, at nodes.
    Displacement,
    Reaction,
    /// Of the recovered stress or strain.
    Nodal(Measure),
    StressJump,
    // Bodies, by elements.
    /// Of the mean over an element.
    Mean(Measure),
    EquivalentPlasticStrain,
    Error,
    // Slave surfaces, at nodes.
    Status,
    Gap,
    Pressure,
    Traction,
    Force,
    Normal,
}

use Measure::{PrincipalStrain, PrincipalStress, Strain, Stress, VonMises};
use Quantity::{
    Displacement, EquivalentPlasticStrain, Error, Force, Gap, Mean, Nodal, Normal, Pressure, Reaction, Status,
    StressJump, Traction,
};

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 21] = [
        Displacement,
        Reaction,
        Nodal(Stress),
        Nodal(VonMises),
        Nodal(PrincipalStress),
        StressJump,
        Nodal(Strain),
        Nodal(PrincipalStrain),
        Mean(Stress),
        Mean(VonMises),
        Mean(PrincipalStress),
        Mean(Strain),
        Mean(PrincipalStrain),
        EquivalentPlasticStrain,
        Error,
        Status,
        Gap,
        Pressure,
        Traction,
        Force,
        Normal,
    ];

    /// What is written of a scene that asks for nothing: what costs at most an evaluation of stresses.
    pub const USUAL: [Self; 12] = [
        Displacement,
        Reaction,
        Mean(Stress),
        Mean(VonMises),
        EquivalentPlasticStrain,
        Error,
        Status,
        Gap,
        Pressure,
        Traction,
        Force,
        Normal,
    ];

    /// What a probe may show: fields of bodies that shape functions interpolate.
    pub const OF_PROBES: [Self; 6] =
        [Displacement, Nodal(Stress), Nodal(VonMises), Nodal(PrincipalStress), Nodal(Strain), Nodal(PrincipalStrain)];

    /// What a probe shows that asks for nothing.
    pub const USUAL_OF_PROBES: [Self; 3] = [Displacement, Nodal(Stress), Nodal(VonMises)];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        match self {
            Displacement => "displacement",
            Reaction => "reaction",
            Nodal(Stress) => "nodal_stress",
            Nodal(VonMises) => "nodal_von_mises",
            Nodal(PrincipalStress) => "nodal_principal_stress",
            Nodal(Strain) => "nodal_strain",
            Nodal(PrincipalStrain) => "nodal_principal_strain",
            StressJump => "stress_jump",
            Mean(Stress) => "stress",
            Mean(VonMises) => "von_mises",
            Mean(PrincipalStress) => "principal_stress",
            Mean(Strain) => "strain",
            Mean(PrincipalStrain) => "principal_strain",
            EquivalentPlasticStrain => "equivalent_plastic_strain",
            Error => "error",
            Status => "status",
            Gap => "gap",
            Pressure => "pressure",
            Traction => "traction",
            Force => "force",
            Normal => "normal",
        }
    }

    /// Numbers of a value.
    pub fn width(self) -> usize {
        match self {
            Displacement | Reaction | Traction | Force | Normal => 3,
            Nodal(measure) | Mean(measure) => measure.width(),
            StressJump | EquivalentPlasticStrain | Error | Status | Gap | Pressure => 1,
        }
    }

    /// Its datasets, as (name, components): principal values are no vector, and stand each by itself.
    pub fn datasets(self) -> Vec<(String, usize)> {
        match self {
            Nodal(PrincipalStress | PrincipalStrain) | Mean(PrincipalStress | PrincipalStrain) => {
                (1..=3).map(|k| (format!("{}_{k}", self.key()), 1)).collect()
            }
            _ => vec![(self.key().to_string(), self.width())],
        }
    }

    /// Its columns in a table, as many as a value has numbers.
    pub fn columns(self) -> Vec<String> {
        const OF_TENSORS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];
        let column = |(name, width): (String, usize)| match width {
            1 => vec![name],
            3 => AXIS_NAMES.map(|part| format!("{name}.{part}")).to_vec(),
            _ => OF_TENSORS.map(|part| format!("{name}.{part}")).to_vec(),
        };
        self.datasets().into_iter().flat_map(column).collect()
    }

    /// Whether it needs recovered stresses or strains.
    pub fn is_recovered(self) -> bool {
        matches!(self, Nodal(_) | StressJump)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_unlike_and_columns_as_many_as_numbers() {
        let mut keys = Quantity::ALL.map(Quantity::key).to_vec();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), Quantity::ALL.len());
        for quantity in Quantity::ALL {
            assert_eq!(quantity.columns().len(), quantity.width(), "{}", quantity.key());
        }
        assert_eq!(Nodal(PrincipalStress).columns()[2], "nodal_principal_stress_3");
        assert_eq!(Nodal(Stress).columns()[4], "nodal_stress.yz");
    }
}
