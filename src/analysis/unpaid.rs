//! Elastic energy that nothing gave: of bodies that friction may hold, a state may be found that keeps them pressed though
//! nothing pressed them, as one that stands askew in a slot. It is in equilibrium, but no way leads there.
//!
//! In an increment loads, supports and tools give no more than their largest forces over how far they go, and an overlap that
//! is pushed out no more than its force over its depth; friction, flow and dashpots only take.

use super::Simulation;
use super::step::{Converged, Frame};
use crate::Vec3;
use crate::contact::Slave;
use crate::error::Result;
use crate::model::{Model, states};
use crate::parallel::{agree, sum};

/// What is known at the end of an increment for the next one.
#[derive(Debug)]
pub(super) struct Account {
    /// Elastic energy of all bodies.
    energy: f64,
    /// Loads on the owned nodes.
    loads: Vec<Vec3>,
}

/// Strain below which energy is rounding.
const STILL: f64 = 1e-6;

impl Simulation<'_> {
    /// Accounts for an increment before it becomes the state; says so if it has energy that nothing gave. Only where friction may
    /// hold what supports do not. Collective.
    ///
    /// # Errors
    /// An element that cannot follow.
    pub(super) fn unpaid(&mut self, frame: &Frame, converged: &Converged) -> Result<Option<String>> {
        if !frame.hangs || !self.model.pairs.iter().any(|pair| pair.rules.friction > 0.0) {
            self.account = None;
            return Ok(None);
        }
        let loads = converged.forces.loads.clone();
        let before = match self.account.take() {
            Some(account) => account,
            None => Account { energy: self.elastic(&self.state.u)?, loads: loads.clone() },
        };
        let energy = self.elastic(&converged.u)?;
        let mut given = [self.given(converged, [&before.loads, &loads])];
        sum(self.comm, &mut given);
        self.account = Some(Account { energy, loads });
        let gained = energy - before.energy;
        let rounding = self.model.stiffness * (STILL * self.model.size).powi(2);
        let most = self.model.controls.watch_unpaid * given[0] + STILL * energy + rounding;
        let unpaid = || {
            format!(
                "bodies took up {gained:.3e} of elastic energy in the increment to time {:.6}, and loads, supports and tools cannot \
                 have given more than {:.3e}: friction keeps them pressed, though nothing pressed them; hold what is loose, or \
                 take smaller increments",
                frame.progress.start + converged.end * frame.progress.step.duration,
                given[0]
            )
        };
        Ok((gained > most).then(unpaid))
    }

    fn elastic(&self, u: &[Vec3]) -> Result<f64> {
        let bodies = 0..self.model.bodies.len();
        let mut energies = Vec::new();
        for body in bodies {
            energies.push(agree(self.comm, states::energies(&self.model, u, body))?[0]);
        }
        sum(self.comm, &mut energies);
        Ok(energies.iter().sum())
    }

    /// What an increment can have been given at most, on this rank, at these loads before and after.
    fn given(&self, converged: &Converged, loads: [&[Vec3]; 2]) -> f64 {
        let Model { part, masters, pairs, .. } = &self.model;
        let larger = |a: &Vec3, b: &Vec3| a.norm().max(b.norm());
        let at_node = |n: usize| {
            let way = converged.u[part.tie[n] as usize] - self.state.u[part.tie[n] as usize];
            let held = larger(&self.state.reactions[n], &converged.forces.nodes[n]);
            way.norm() * (larger(&loads[0][n], &loads[1][n]) + held)
        };
        let mut given: f64 = (0..part.owned).map(at_node).sum();
        for pair in pairs {
            let tool = pair.master.tool().map(|t| &masters.tools[t]);
            let of_slave = |slave: &Slave| {
                let n = slave.node as usize;
                let x = part.points[n] + converged.u[n];
                let way = tool.map_or(0.0, |tool| (x - tool.committed.outward(&tool.trial.inward(&x))).norm());
                larger(&slave.accepted.on_node(), &slave.trial.on_node()) * (way + slave.sights.accepted.depth)
            };
            given += pair.slaves.iter().map(of_slave).sum::<f64>();
        }
        given
    }
}
