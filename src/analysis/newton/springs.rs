//! Springs between nodes and the ground: the force -k u on a node that is displaced by u from where it was meshed. They count as
//! supports: what they bear is the reaction of their nodes.

use super::{Newton, System};

impl Newton<'_> {
    pub(super) fn add_springs(&mut self, r: &mut [f64]) {
        let System { model, dofs, conditions, .. } = &self.system;
        for (&n, stiffness) in &conditions.springs {
            let n = n as usize;
            let force = stiffness.component_mul(&self.found.u[n]);
            self.found.balance.load(model.part.section[n] as usize, force.amax());
            let force = dofs.axes.inward(n, &force);
            for d in 0..3 {
                if let Some(k) = dofs.local(dofs.node[n][d]) {
                    r[k] += force[d];
                }
            }
        }
    }

    pub(super) fn add_spring_tangent(&mut self) {
        let System { dofs, pattern, conditions, .. } = &self.system;
        for (&n, stiffness) in &conditions.springs {
            for d in (0..3).filter(|&d| stiffness[d] != 0.0) {
                for (row, share) in dofs.shares(n, d) {
                    let Some(local) = dofs.local(row) else { continue };
                    for (column, part) in dofs.shares(n, d) {
                        pattern.add(&mut self.values, local, column, stiffness[d] * share * part);
                    }
                }
            }
        }
    }
}
