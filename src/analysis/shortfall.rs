//! Bodies that bear less than they flow at: what the additive logarithmic strain does in shear.
//!
//! Plastic strain is subtracted from the logarithmic strain, and the stress T that belongs to that follows the yield stress. Its
//! components across the axes of the strain stand for less of the true stress the more the stretches differ: simple shear bears 3 %
//! less at a shear of 1, a sixth at 2. Where a body flows so at the end of a step, forces are too low by about as much.

use super::Simulation;
use crate::error::Result;
use crate::model::states;
use crate::parallel::{agree, sum};
use std::collections::BTreeMap;

/// From there it is said.
const TOLD: f64 = 0.03;

/// By how much bodies bore too little, of what they should, at worst, and in which step.
#[derive(Default)]
pub struct Shortfalls(BTreeMap<String, (f64, String)>);

impl Shortfalls {
    /// Looks at what flows now. Collective.
    ///
    /// # Errors
    /// An element that is inverted.
    pub fn look(&mut self, simulation: &Simulation, step: &str) -> Result<()> {
        let (comm, model, state) = (simulation.comm(), simulation.model(), simulation.state());
        for (b, body) in model.bodies.iter().enumerate().filter(|(b, _)| model.body_can_flow(*b)) {
            let mut sums = agree(comm, states::shortfall(model, &state.u, b))?;
            sum(comm, &mut sums);
            let [lost, work] = sums;
            let worst = self.0.get(&body.name).map_or(TOLD, |(worst, _)| *worst);
            if lost > worst * work {
                self.0.insert(body.name.clone(), (lost / work, step.to_string()));
            }
        }
        Ok(())
    }

    /// What is to be said of them.
    pub fn words(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|(body, (lost, step))| {
            format!(
                "body `{body}`: at the end of step `{step}` its stress is {:.0} % below what it flows at, in the mean over the \
                 plastic work: plastic strain is subtracted as a logarithm, which bears too little in large shear, and forces \
                 are too low by about as much",
                100.0 * lost
            )
        })
    }
}
