//! The central path: a way to the contacts of a sheet that tools press from both sides.
//!
//! A sheet is stiff against its contacts and far softer in bending. An iteration that lets all nodes go that pull, and holds all
//! that are inside, bends it to the other tool, where others are then inside, and goes to and fro between sets of contacts
//! as the finer the mesh is the more of them there are; lower penalties do not help, for sets do not depend on them. On the
//! central path of interior-point methods each node near its master has the force -F_n = θ²/(ε_n g) (see [`law`]), smooth in
//! the gap, so that a step along its tangent lowers the residual. θ begins with ε_n times a small share of a facet and falls
//! from stage to stage, each of which begins where the last has ended; the last stage is the law itself, with hardly a
//! contact left to change.
//!
//! [`law`]: crate::contact::law

use super::Newton;
use super::rounds::Round;
use crate::contact::Enforcement;

impl Newton<'_> {
    /// Begins the path.
    pub(super) fn begin_central(&mut self) {
        self.strategy.stages = self.system.model.controls.central_stages;
        self.set_barrier(self.system.model.controls.central_gap);
    }

    /// Whether the iteration is on the path.
    pub(super) fn is_central(&self) -> bool {
        self.strategy.stages > 0
    }

    /// After convergence on the path: goes on to its next stage.
    pub(super) fn end_stage(&mut self) -> Round {
        let controls = self.system.model.controls;
        self.strategy.stages -= 1;
        let done = (controls.central_stages - self.strategy.stages) as i32;
        let gap = if self.is_central() { controls.central_gap * controls.central_fall.powi(done) } else { 0.0 };
        self.set_barrier(gap);
        self.course.rounds.count += 1;
        self.course.rounds.early += 1;
        self.again()
    }

    /// Gives slave nodes θ over ε_n, a share of their facets. Residuals from before are those of another path.
    fn set_barrier(&mut self, gap: f64) {
        self.line_search.begin_anew(self.is_central() || self.system.model.can_flow());
        for pair in self.system.model.pairs.iter_mut().filter(|pair| pair.rules.method != Enforcement::Lagrange) {
            let gap = gap * pair.facet_size;
            pair.slaves.iter_mut().for_each(|slave| slave.law.barrier = gap * slave.law.normal);
        }
    }
}
