//! Equations for slave nodes that have come to touch without having any.
//!
//! The vectors of the solver, of fixed layout while it iterates, have no place for them. So it stops at that iterate, which is
//! numbered anew, and goes on from it: with zeros for the new multipliers, as they would have been with equations, and
//! with the residuals that were found.

use super::backtrack::Tried;
use super::{Newton, System};
use crate::error::Result;
use crate::output::phases::Phase;
use crate::system::{DofMap, near};
use petsc::Iterate;
use std::time::Instant;

impl Newton<'_> {
    /// Whether some slave node of this rank touches and has no equations.
    pub(super) fn lacks_equations(&self) -> bool {
        near::lacks(&self.system.dofs.near, &self.system.model.pairs)
    }

    /// Stops the iteration at an iterate.
    pub(super) fn stop_to_grow(&mut self, iterate: &Iterate) {
        self.course.iterated += iterate.iteration;
        self.growing = Some(Tried { x: iterate.x.to_vec(), residual: iterate.residual.to_vec() });
    }

    /// Whether the iteration was stopped so; the same on all ranks.
    pub fn grows(&self) -> bool {
        self.growing.is_some()
    }

    /// Gives equations to all slave nodes that are near now. Those that are not lose theirs, the first time in an attempt: were
    /// it each time, wild iterates could go to and fro. Returns the numbering of before, and the unknowns in the new one.
    /// Collective.
    pub fn grow(&mut self) -> Result<(DofMap, Vec<f64>)> {
        let begun = Instant::now();
        let stopped = self.growing.take().unwrap_or_default();
        let System { comm, model, dofs, conditions, .. } = &mut self.system;
        let stay = (self.course.growths > 0).then_some(&dofs.near);
        let near = near::around(&model.pairs, |slave| &slave.trial, stay);
        let new = DofMap::new(comm, model, conditions.supports(), &conditions.freedoms(), near);
        let old = std::mem::replace(*dofs, new);
        self.renew_pattern()?;
        self.learn();
        self.number_drag();
        self.found.balance.number(self.system.model, self.system.dofs);
        let [x, mut residual] = [&stopped.x, &stopped.residual].map(|values| self.system.dofs.carry(&old, values));
        self.add_constraints(&old, &mut residual);
        self.judge(&residual);
        self.found.at.clone_from(&x);
        self.line_search.tried = Some(Tried { x: x.clone(), residual });
        self.touching.left_out = 0.0;
        self.course.growths += 1;
        self.resumes = true;
        self.system.phases.add(Phase::Assembly, begun.elapsed());
        Ok((old, x))
    }

    /// The residuals of the multipliers that were not in the `old` numbering.
    fn add_constraints(&mut self, old: &DofMap, residual: &mut [f64]) {
        for p in 0..old.near.len() {
            for s in (0..old.near[p].len()).filter(|s| !old.near[p][*s]) {
                let equations = self.system.dofs.multiplier[p][s].map(|e| self.system.dofs.local(e));
                if equations == [None; 3] {
                    continue;
                }
                let constraint = self.constraint(p, s);
                let pair = &self.system.model.pairs[p];
                let constraint = self.system.dofs.axes.inward_of(pair, pair.slaves[s].node, &constraint);
                for (k, value) in equations.iter().zip(&constraint) {
                    if let Some(k) = k {
                        residual[*k] = *value;
                    }
                }
            }
        }
    }
}
