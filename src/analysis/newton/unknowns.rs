//! What the unknowns stand for: displacements, tools and multipliers, and what an increment begins with.

use super::Newton;
use crate::Vec3;
use crate::contact::{Pair, Slave, Status};
use crate::model::Model;
use crate::system::dofs::NONE;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

impl Newton<'_> {
    /// Starts from given unknowns, with the prescribed displacements of the end of the increment; or on the way there, if the
    /// increment is to be shorter.
    pub fn start_ahead(&mut self, trial: &[f64], x: &mut [f64]) {
        self.predicted();
        self.start_behind(x);
        let step: Vec<f64> = x.iter().zip(trial).map(|(x, t)| x - t).collect();
        let part = self.shorten(x, &step);
        if part < 1.0 {
            x.iter_mut().zip(step).for_each(|(x, s)| *x -= part * s);
        } else {
            x.copy_from_slice(trial);
        }
    }

    /// Starts from the unknowns of the last converged state; the prescribed displacements enter the first iteration linearly.
    pub fn start_behind(&self, x: &mut [f64]) {
        let dofs = &*self.system.dofs;
        for n in 0..self.system.model.part.owned {
            let at = dofs.axes.inward(n, &self.system.committed[n]);
            for d in 0..3 {
                if let Some(k) = dofs.local(dofs.node[n][d]) {
                    x[k] = at[d];
                }
            }
        }
        for (pair, equations) in self.system.model.pairs.iter().zip(&dofs.multiplier) {
            for (slave, equations) in pair.slaves.iter().zip(equations) {
                let multiplier = dofs.axes.inward_of(pair, slave.node, &slave.committed.multiplier);
                for d in 0..3 {
                    if let Some(k) = dofs.local(equations[d]) {
                        x[k] = multiplier[d] / slave.law.normal;
                    }
                }
            }
        }
        for (joint, equations) in self.system.model.joints.iter().zip(&self.system.dofs.tie) {
            for (slave, equations) in joint.slaves.iter().zip(equations) {
                for d in 0..3 {
                    if let Some(k) = self.system.dofs.local(equations[d]) {
                        x[k] = slave.force[d] / slave.stiffness;
                    }
                }
            }
        }
        for (equations, offset) in self.system.dofs.tool.iter().zip(&self.found.offsets) {
            for d in 0..3 {
                if let Some(k) = self.system.dofs.local(equations[d]) {
                    x[k] = offset[d];
                }
            }
        }
    }

    /// The component of the displacement of an owned node, which had these at the last converged state, that has no equation.
    fn settled(&self, node: usize, d: usize, committed: &Vec3) -> f64 {
        let conditions = self.system.conditions;
        match conditions.prescribed[3 * node + d] {
            Some(motion) if !self.strategy.predicting => conditions.place(&motion, self.s),
            _ => committed[d],
        }
    }

    /// Sets displacements and tool poses from the unknowns. Collective.
    pub(super) fn unpack(&mut self, x: &[f64]) {
        let part = &self.system.model.part;
        for n in 0..part.owned {
            let dofs = &*self.system.dofs;
            let committed = dofs.axes.inward(n, &self.system.committed[n]);
            let along = |d: usize| dofs.local(dofs.node[n][d]).map_or_else(|| self.settled(n, d, &committed), |k| x[k]);
            self.found.u[n] = dofs.axes.outward(n, &Vec3::new(along(0), along(1), along(2)));
        }
        for n in 0..part.owned {
            self.found.u[n] = self.found.u[part.tie[n] as usize];
        }
        update_halo(self.system.model, self.system.comm, &mut self.found.u);
        let free: Vec<(usize, usize)> = (0..self.system.dofs.tool.len())
            .flat_map(|t| (0..3).map(move |d| (t, d)))
            .filter(|&(t, d)| self.system.dofs.tool[t][d] != NONE)
            .collect();
        if !free.is_empty() {
            let mut offsets: Vec<f64> = free
                .iter()
                .map(|&(t, d)| self.system.dofs.local(self.system.dofs.tool[t][d]).map_or(0.0, |k| x[k]))
                .collect();
            self.system.comm.process_at_rank(0).broadcast_into(&mut offsets[..]);
            for (&(t, d), q) in free.iter().zip(offsets) {
                self.found.offsets[t][d] = q;
            }
        }
        self.system.conditions.place_tools(
            &mut self.system.model.masters.tools,
            self.system.start_poses,
            &self.found.offsets,
            self.s,
        );
    }

    /// How far each prescribed displacement still is from its value at the end of the increment; zero elsewhere. Collective.
    pub(super) fn prescribed_increments(&self) -> Vec<Vec3> {
        let mut ahead = vec![Vec3::zeros(); self.system.model.part.points.len()];
        let conditions = self.system.conditions;
        for (n, ahead) in ahead.iter_mut().enumerate().take(self.system.model.part.owned) {
            let committed = conditions.axes.inward(n, &self.system.committed[n]);
            let along = |d: usize| {
                conditions.prescribed[3 * n + d].map_or(0.0, |motion| conditions.place(&motion, self.s) - committed[d])
            };
            *ahead = conditions.axes.outward(n, &Vec3::new(along(0), along(1), along(2)));
        }
        update_halo(self.system.model, self.system.comm, &mut ahead);
        ahead
    }

    /// The multipliers at the unknowns `x`, N; for those that are held the local unknowns.
    pub fn multipliers(&self, x: &[f64]) -> Vec<Vec<Vec3>> {
        let dofs = &*self.system.dofs;
        let of = |pair: &Pair, slave: &Slave, equations: &[i64; 3]| {
            let along = Vec3::from_fn(|d, _| dofs.local(equations[d]).map_or(0.0, |k| x[k] * slave.law.normal));
            dofs.axes.outward_of(pair, slave.node, &along)
        };
        let pairs = self.system.model.pairs.iter().zip(&dofs.multiplier);
        let local = |s: &Slave| if s.trial.status == Status::Gap { Vec3::zeros() } else { s.trial.sigma };
        let locals = |pair: &Pair| pair.slaves.iter().map(local).collect();
        let unknowns =
            |pair: &Pair, all: &[[i64; 3]]| pair.slaves.iter().zip(all).map(|(s, e)| of(pair, s, e)).collect();
        pairs.map(|(pair, all)| if pair.width() == 0 { locals(pair) } else { unknowns(pair, all) }).collect()
    }
}

/// Gives halo nodes the displacements of their owners. Collective.
pub fn update_halo(model: &Model, comm: &SimpleCommunicator, u: &mut [Vec3]) {
    let mut flat: Vec<f64> = u.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    model.part.halo.update(comm, 3, &mut flat);
    for (v, value) in u.iter_mut().zip(flat.as_chunks::<3>().0) {
        *v = Vec3::from(*value);
    }
}
