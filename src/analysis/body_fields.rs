//! The fields of bodies: those that the scene asks for, from a state that has converged.

use super::State;
use super::results::{Column, vectors};
use crate::error::Result;
use crate::estimate::energy::Energy;
use crate::estimate::nodal::jumps;
use crate::estimate::recovery::Recovered;
use crate::model::{Model, elements, states};
use crate::output::quantity::Quantity;
use crate::parallel::agree;
use crate::solid::voigt::Voigt;
use mpi::topology::SimpleCommunicator;

/// What is known of a state besides its displacements.
#[derive(Clone, Copy, Default)]
pub(super) struct Known<'a> {
    /// The energy of its error.
    pub energy: Option<&'a Energy>,
    pub recovered: Option<&'a Recovered>,
}

/// What the fields of all bodies are made of, as far as it is asked for.
pub(super) struct BodyFields<'a> {
    model: &'a Model,
    state: &'a State,
    known: Known<'a>,
    wanted: &'a [Quantity],
    /// Means of the elements that this rank counts; none unless asked for.
    stresses: Vec<Voigt>,
    strains: Vec<Voigt>,
    /// Of owned nodes; none unless asked for.
    jumps: Vec<f64>,
}

impl<'a> BodyFields<'a> {
    /// Evaluates what is wanted. Collective.
    ///
    /// # Errors
    /// An element without stress, on all ranks.
    pub fn new(
        comm: &SimpleCommunicator,
        model: &'a Model,
        state: &'a State,
        known: Known<'a>,
        wanted: &'a [Quantity],
    ) -> Result<Self> {
        let of_strain = |strain: bool| {
            let is = |quantity: &Quantity| matches!(quantity, Quantity::Mean(m) if m.is_of_strain() == strain);
            wanted.iter().any(is)
        };
        let none = || Ok(Vec::new());
        let stresses = agree(comm, if of_strain(false) { states::stresses(model, &state.u) } else { none() })?;
        let strains = agree(comm, if of_strain(true) { states::strains(model, &state.u) } else { none() })?;
        let jumps = match known.recovered.filter(|_| wanted.contains(&Quantity::StressJump)) {
            Some(recovered) => agree(comm, jumps(model, recovered, &state.u))?,
            None => Vec::new(),
        };
        Ok(Self { model, state, known, wanted, stresses, strains, jumps })
    }

    /// The fields at these owned nodes.
    pub fn at_nodes(&self, nodes: &[u32]) -> Vec<Column> {
        let mut columns = Vec::new();
        for quantity in self.wanted {
            let nodes = nodes.iter().map(|&n| n as usize);
            let values = match quantity {
                Quantity::Displacement => vectors(nodes.map(|n| self.state.u[n])),
                Quantity::Reaction => vectors(nodes.map(|n| self.state.reactions[n])),
                Quantity::Nodal(measure) => {
                    let Some(recovered) = self.known.recovered else { continue };
                    let mut values = Vec::new();
                    nodes.for_each(|n| measure.add(&recovered.of(measure.is_of_strain(), self.model, n), &mut values));
                    values
                }
                Quantity::StressJump if self.known.recovered.is_some() => nodes.map(|n| self.jumps[n]).collect(),
                _ => continue,
            };
            add_columns(*quantity, values, &mut columns);
        }
        columns
    }

    /// The fields of the elements of body `b` that this rank counts.
    ///
    /// # Errors
    /// An element without stress.
    pub fn of_elements(&self, b: usize) -> Result<Vec<Column>> {
        let model = self.model;
        let mut columns = Vec::new();
        let of_body = |means: &[Voigt]| -> Vec<Voigt> {
            let mine = elements::mine(model).zip(means);
            mine.filter(|(e, _)| model.part.solids[*e].body as usize == b).map(|(_, mean)| *mean).collect()
        };
        for quantity in self.wanted {
            let values = match quantity {
                Quantity::Mean(measure) => {
                    let means = of_body(if measure.is_of_strain() { &self.strains } else { &self.stresses });
                    let mut values = Vec::new();
                    means.iter().for_each(|mean| measure.add(mean, &mut values));
                    values
                }
                Quantity::EquivalentPlasticStrain if model.body_can_flow(b) => {
                    states::plastic_strains(model, &self.state.u, b)?
                }
                Quantity::Error => match self.known.energy {
                    Some(energy) => energy.shares(model, b),
                    None => vec![f64::NAN; elements::of_body(model, b).count()],
                },
                _ => continue,
            };
            add_columns(*quantity, values, &mut columns);
        }
        Ok(columns)
    }
}

/// Adds the datasets of a quantity, whose values follow one another.
fn add_columns(quantity: Quantity, values: Vec<f64>, columns: &mut Vec<Column>) {
    let datasets = quantity.datasets();
    if let [(name, width)] = datasets.as_slice() {
        columns.push((name.clone(), *width, values));
        return;
    }
    for (k, (name, width)) in datasets.iter().enumerate() {
        let own = values.iter().skip(k).step_by(datasets.len()).copied();
        columns.push((name.clone(), *width, own.collect()));
    }
}
