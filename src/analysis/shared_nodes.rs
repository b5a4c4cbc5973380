//! Slave nodes whose multipliers as unknowns may say what others say, which are held from then on: those that bear several
//! contacts, one of them with friction; and those that cannot give way to a tool that a force or torque drives, for what each of
//! them bears does not follow from its balance.

use super::Simulation;
use super::conditions::Conditions;
use super::state::Progress;
use super::step::Running;
use crate::contact::{Pair, Slave, Status, touching_nodes};
use crate::error::Result;
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::system::near;

impl<'a> Simulation<'a> {
    /// The pairs with multipliers as unknowns of which, as the iterate is, a slave node touches another master, too, one of them
    /// with friction. Collective.
    fn shared_by_nodes(&self) -> Vec<bool> {
        let pairs = &self.model.pairs;
        let touches =
            |pair: &Pair, slave: &Slave| pair.width() > 0 && !pair.is_self() && slave.trial.status != Status::Gap;
        let touching = touching_nodes(pairs, touches);
        let rubs = |at: &[(usize, &Slave)]| at.iter().any(|(p, _)| pairs[*p].rules.friction > 0.0);
        let mut shared = vec![0.0; pairs.len()];
        for at in touching.values().filter(|at| at.len() > 1 && rubs(at)) {
            at.iter().for_each(|(p, _)| shared[*p] = 1.0);
        }
        max(self.comm, &mut shared);
        shared.into_iter().map(|shared| shared > 0.0).collect()
    }

    /// Those of which two slave nodes cannot give way to a tool that can. Collective.
    fn shared_by_tools(&self, conditions: &Conditions) -> Vec<bool> {
        let pairs = &self.model.pairs;
        let tools = conditions.movements_of_tools();
        let is_held = |pair: &Pair, slave: &Slave| {
            // One that bears nothing, for others do, may have any status.
            let near = pair.controls.touching_gap * pair.facet_size;
            let touching =
                slave.trial.projection.filter(|at| slave.trial.status != Status::Gap || slave.law.gap(at.gap) <= near);
            pair.master.tool().zip(touching).is_some_and(|(t, at)| {
                tools[t].along(&at.normal).is_nan() && !conditions.movement(slave.node).along(&at.normal).is_nan()
            })
        };
        let count = |pair: &Pair| pair.slaves.iter().filter(|slave| is_held(pair, slave)).count() as f64;
        let mut held: Vec<f64> = pairs.iter().map(|pair| if pair.width() > 0 { count(pair) } else { 0.0 }).collect();
        sum(self.comm, &mut held);
        held.into_iter().map(|held| held > 1.0).collect()
    }

    /// Whether there are such pairs: what a factorization gives to which of their nodes is up to rounding, whether it finds null
    /// pivots or not. Collective.
    pub(super) fn shares_nodes(&self, conditions: &Conditions) -> bool {
        self.shared_by_nodes().contains(&true) || self.shared_by_tools(conditions).contains(&true)
    }

    /// Holds the multipliers of the pairs that share nodes, from the last converged increment on, and numbers the step's
    /// equations anew. Collective.
    pub(super) fn hold_multipliers(&mut self, running: &mut Running<'a>) -> Result<()> {
        let (by_nodes, by_tools) = (self.shared_by_nodes(), self.shared_by_tools(running.frame.conditions()));
        let Model { part, masters, pairs, .. } = &mut self.model;
        masters.tools.iter_mut().for_each(|tool| tool.trial = tool.committed);
        masters.follow(self.comm, pairs, |n| part.points[n as usize] + self.state.u[n as usize]);
        let shared = by_nodes.into_iter().zip(by_tools).map(|(nodes, tools)| nodes || tools);
        for (pair, _) in pairs.iter_mut().zip(shared).filter(|(_, shared)| *shared) {
            pair.hold(&masters.of(pair.master));
        }
        let progress = Progress { past: Vec::new(), ..running.frame.progress.clone() };
        self.set_up(progress, near::around(&self.model.pairs, |slave| &slave.accepted, None))?;
        if let Some(new) = self.running.take() {
            // A failure from before has its equation by its old number.
            running.told = std::mem::replace(running, new).told;
        }
        Ok(())
    }
}
