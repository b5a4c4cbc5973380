//! Slave nodes that bear several contacts, one of them with friction: multipliers that are unknowns may say of them what others
//! say, and are held from then on.

use super::Simulation;
use super::state::Progress;
use super::step::Running;
use crate::contact::Status;
use crate::error::Result;
use crate::model::Model;
use crate::parallel::max;
use crate::system::near;
use std::collections::BTreeMap;

impl<'a> Simulation<'a> {
    /// The pairs with multipliers as unknowns of which a slave node touches another master, too, as the iterate is, one of them
    /// with friction. Collective.
    fn shared(&self) -> Vec<bool> {
        let pairs = &self.model.pairs;
        let mut touching: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (p, pair) in pairs.iter().enumerate().filter(|(_, pair)| pair.width() > 0 && !pair.is_self()) {
            let touch = pair.slaves.iter().filter(|slave| slave.trial.status != Status::Gap);
            touch.for_each(|slave| touching.entry(slave.node).or_default().push(p));
        }
        let mut shared = vec![0.0; pairs.len()];
        for at in touching.values().filter(|at| at.len() > 1 && at.iter().any(|&p| pairs[p].friction > 0.0)) {
            at.iter().for_each(|&p| shared[p] = 1.0);
        }
        max(self.comm, &mut shared);
        shared.iter().map(|shared| *shared > 0.0).collect()
    }

    /// Whether there are such pairs. Collective.
    pub(super) fn shares_nodes(&self) -> bool {
        self.shared().contains(&true)
    }

    /// Holds the multipliers of the pairs that share nodes, from the last converged increment on, and numbers the step's
    /// equations anew. Collective.
    pub(super) fn hold_multipliers(&mut self, running: &mut Running<'a>) -> Result<()> {
        let shared = self.shared();
        let Model { part, masters, pairs, .. } = &mut self.model;
        masters.tools.iter_mut().for_each(|tool| tool.trial = tool.committed);
        masters.follow(self.comm, pairs, |n| part.points[n as usize] + self.state.u[n as usize]);
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
