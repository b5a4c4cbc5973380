//! Ties in the nonlinear problem: with the nodal force F = ε λ' of each slave node as an unknown, the potential F·c, where
//! c = u_i - Σ_k P_ik u_k is linear, adds
//!
//! ```text
//!     r_i = F,     r_k = -P_ik F,     r_λ' = ε c
//! ```
//!
//! ε being the stiffness of the slave's body, so that the unknown is a length and its residual a force. Where a step prescribes
//! how a slave node moves along a direction, as in a plane of symmetry, it is not tied along it. Where the positions are means in
//! the beginning, c is that of positions as well, and forces and moments are in balance.

use super::Newton;
use crate::Vec3;
use crate::model::ties::{Joint, TiedNode};

impl Newton<'_> {
    /// Forces and residuals of ties; with prescribed displacements that are still `ahead`, as if they were done. Collective.
    pub(super) fn add_ties(&mut self, x: &[f64], ahead: Option<&[Vec3]>, r: &mut [f64]) {
        let (comm, dofs, model) = (self.system.comm, &*self.system.dofs, &*self.system.model);
        let u = &self.found.u;
        let now = |n: u32| u[n as usize] + ahead.map_or(Vec3::zeros(), |ahead| ahead[n as usize]);
        for (joint, equations) in model.joints.iter().zip(&dofs.tie) {
            let values = joint.masters.fetch(comm, 3, |n, d| now(n)[d]);
            let mut on_masters = vec![0.0; values.len()];
            for (slave, equations) in joint.slaves.iter().zip(equations) {
                let apart = now(slave.node) - joint.mean(slave, &values);
                let force = force(slave, equations.map(|e| dofs.local(e)), x);
                self.found.forces[slave.node as usize] += force;
                for (k, weight) in &slave.weights {
                    (0..3).for_each(|d| on_masters[3 * *k as usize + d] -= weight * force[d]);
                }
                for d in 0..3 {
                    if let Some(row) = dofs.local(equations[d]) {
                        r[row] += slave.stiffness * apart[d];
                    }
                }
            }
            let forces = &mut self.found.forces;
            let add = |n: u32, force: &[f64]| forces[n as usize] += Vec3::from_column_slice(force);
            joint.masters.add_to_owners(comm, 3, &on_masters, add);
        }
    }

    /// The tangent of ties, which is constant. Collective.
    pub(super) fn add_tie_tangent(&mut self) {
        let (comm, dofs, pattern) = (self.system.comm, &*self.system.dofs, &*self.system.pattern);
        let mut foreign = vec![0.0; pattern.foreign.len()];
        let values = &mut self.values;
        for (joint, equations) in self.system.model.joints.iter().zip(&dofs.tie) {
            let of_masters = dofs.of_masters(comm, joint);
            for (slave, equations) in joint.slaves.iter().zip(equations) {
                let own = dofs.node[slave.node as usize];
                slave.couplings(equations, own, &of_masters, |[row, column], value| {
                    if let Some(local) = dofs.local(row) {
                        pattern.add(values, local, column, value);
                    } else if let Some(k) = pattern.foreign.index(row as i32, column as i32) {
                        foreign[k] += value;
                    }
                });
            }
        }
        pattern.foreign.deliver(comm, &foreign, values);
    }

    /// The forces of ties at the unknowns `x`, N.
    pub fn tie_forces(&self, x: &[f64]) -> Vec<Vec<Vec3>> {
        let dofs = &*self.system.dofs;
        let of = |(joint, equations): (&Joint, &Vec<[i64; 3]>)| {
            let slaves = joint.slaves.iter().zip(equations);
            slaves.map(|(slave, equations)| force(slave, equations.map(|e| dofs.local(e)), x)).collect()
        };
        self.system.model.joints.iter().zip(&dofs.tie).map(of).collect()
    }
}

/// The force on a slave node, N.
fn force(slave: &TiedNode, rows: [Option<usize>; 3], x: &[f64]) -> Vec3 {
    Vec3::from_fn(|d, _| rows[d].map_or(0.0, |k| x[k] * slave.stiffness))
}
