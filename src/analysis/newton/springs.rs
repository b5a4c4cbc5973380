//! Springs and dashpots between nodes and the ground: the force -k u - c Δu/Δt on a node that is displaced by u from where it was
//! meshed, by Δu over the time Δt of the increment (backward Euler). They count as supports: what they bear is the reaction of
//! their nodes.

use super::{Newton, System};
use crate::Vec3;
use crate::analysis::conditions::Footing;

impl Newton<'_> {
    /// What the springs and dashpots of an owned node bear.
    pub fn footing_force(&self, n: u32) -> Vec3 {
        let Some(footing) = self.system.conditions.springs.get(&n) else { return Vec3::zeros() };
        footing.stiffness.component_mul(&self.found.u[n as usize]) + self.damping_force(n, footing)
    }

    /// What dashpots bear; in an increment without a time what they did at its start.
    fn damping_force(&self, n: u32, footing: &Footing) -> Vec3 {
        let (n, time) = (n as usize, self.time());
        if time == 0.0 {
            return self.system.damped[n];
        }
        footing.damping.component_mul(&(self.found.u[n] - self.system.committed[n])) / time
    }

    /// How long the increment takes.
    fn time(&self) -> f64 {
        (self.s - self.strategy.share.begin) * self.system.conditions.duration
    }

    /// What the dashpots of the owned nodes bear.
    pub fn damped(&self) -> Vec<Vec3> {
        let mut damped = vec![Vec3::zeros(); self.system.model.part.owned];
        for (&n, footing) in &self.system.conditions.springs {
            damped[n as usize] = self.damping_force(n, footing);
        }
        damped
    }

    pub(super) fn add_springs(&mut self, r: &mut [f64]) {
        let System { model, dofs, conditions, .. } = &self.system;
        for &n in conditions.springs.keys() {
            let force = self.footing_force(n);
            // What a place rounds to is no displacement.
            let (place, u) = (model.part.points[n as usize], self.found.u[n as usize]);
            if u.amax() > self.epsilon() * place.amax() {
                self.found.balance.load(model.part.section[n as usize] as usize, force.amax());
            }
            let force = dofs.axes.inward(n as usize, &force);
            for d in 0..3 {
                if let Some(k) = dofs.local(dofs.node[n as usize][d]) {
                    r[k] += force[d];
                }
            }
        }
    }

    pub(super) fn add_spring_tangent(&mut self) {
        let time = self.time();
        let System { dofs, pattern, conditions, .. } = &self.system;
        for (&n, footing) in &conditions.springs {
            let damping = if time == 0.0 { Vec3::zeros() } else { footing.damping / time };
            let stiffness = footing.stiffness + damping;
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
