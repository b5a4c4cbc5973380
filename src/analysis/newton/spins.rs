//! Centrifugal loads: with P = I - e eᵀ the part across the axis e through p, and the mass m of a node (its shape function is
//! integrated at the nodes, which is as exact as the element is), the node at x bears
//!
//! ```text
//! f = m ω² P (x - p),     ∂f/∂x = m ω² P.
//! ```

use super::{Newton, System};
use crate::Vec3;

impl Newton<'_> {
    /// Takes the loads off the forces of the owned nodes.
    pub(super) fn add_spins(&mut self, forces: &mut [Vec3]) {
        let System { model, conditions, .. } = &self.system;
        for spin in &conditions.spins {
            let (square, across) = (spin.square.at(self.s), spin.across(model.is_axisymmetric()));
            for (&n, mass) in &spin.masses {
                let n = n as usize;
                let load = across * (model.part.points[n] + self.found.u[n] - spin.point) * (mass * square);
                forces[n] -= load;
                self.found.balance.load(model.part.section[n] as usize, load.amax());
            }
        }
    }

    pub(super) fn add_spin_tangent(&mut self) {
        let System { model, dofs, pattern, conditions, .. } = &self.system;
        for spin in &conditions.spins {
            let (square, across) = (spin.square.at(self.s), spin.across(model.is_axisymmetric()));
            for (&n, mass) in &spin.masses {
                for (i, j) in (0..9).map(|k| (k / 3, k % 3)).filter(|&at| across[at] != 0.0) {
                    for (row, share) in dofs.shares(n, i) {
                        let Some(local) = dofs.local(row) else { continue };
                        for (column, part) in dofs.shares(n, j) {
                            let softening = mass * square * across[(i, j)] * share * part;
                            pattern.add(&mut self.values, local, column, -softening);
                        }
                    }
                }
            }
        }
    }
}
