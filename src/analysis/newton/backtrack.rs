//! Shorter steps where plastic flow makes full ones overshoot.
//!
//! Points that have just yielded are much softer than before, and a full Newton step may send the iteration far away, or to
//! and fro between two states. The step is halved or more, to the minimum of the parabola through what is known of the
//! squared residual (Dennis and Schnabel, Numerical Methods for Unconstrained Optimization, 1983, section 6.3), until the
//! residual falls below the largest of the last few iterates (Grippo, Lampariello and Lucidi, SIAM J. Numer. Anal. 23,
//! 1986). It need not fall below the last one: where contact changes it rises on the way to a solution, and short steps
//! would creep. Where flow alone is in the way each fall counts: an increment that fails is tried again with the last
//! iterate alone. When nothing helps, the full step is taken. Elastic bodies always take it, but along the
//! [central path](super::central), whose residual falls smoothly.

use super::Newton;
use crate::contact::{Slave, Trial};
use crate::controls::Controls;
use crate::parallel::{any, sum};
use mpi::topology::SimpleCommunicator;

/// Decrease of the squared residual over that of its tangent (Dennis and Schnabel, algorithm A6.3.1).
const DECREASE: f64 = 1e-4;

/// What is known of the steps so far.
pub struct LineSearch {
    /// Some body can flow, or the iteration is on the central path.
    pub(super) is_wanted: bool,
    /// The iterate that the last step leads to, where it was tried.
    pub(super) tried: Option<Tried>,
    /// The square of the length of the residual, where it is wanted.
    pub(super) squared_residual: f64,
    /// That of the iterates so far, and below how many of the last the next must fall.
    recent: Vec<f64>,
    memory: usize,
}

impl LineSearch {
    pub(super) fn new(is_wanted: bool, memory: usize) -> Self {
        Self { is_wanted, tried: None, squared_residual: f64::INFINITY, recent: Vec::new(), memory }
    }

    /// Begins anew with other equations.
    pub(super) fn begin_anew(&mut self, is_wanted: bool) {
        *self = Self::new(is_wanted, self.memory);
    }
}

/// An iterate that has been evaluated, and will be asked for again.
#[derive(Default)]
pub struct Tried {
    pub(super) x: Vec<f64>,
    pub(super) residual: Vec<f64>,
}

impl Newton<'_> {
    /// Part of `step` from `x` by which the residual falls below those of the last iterates. Collective.
    pub(super) fn backtrack(&mut self, x: &[f64], step: &[f64]) -> f64 {
        let Controls { line_search_shortest, line_search_least, line_search_most, .. } = self.system.model.controls;
        let start = self.line_search.squared_residual;
        self.line_search.recent.push(start);
        let highest = self.line_search.recent.iter().rev().take(self.line_search.memory).copied().fold(0.0, f64::max);
        let trials: Vec<Trial> = self.slaves().map(|s| s.trial).collect();
        let (mut factor, will_go_on) = (1.0, self.will_go_on());
        let mut best = self.try_step(x, step, factor, (&trials, will_go_on));
        while best > highest - 2.0 * DECREASE * factor * start {
            if factor <= line_search_shortest {
                factor = 1.0;
                self.try_step(x, step, factor, (&trials, will_go_on));
                break;
            }
            // r^2 = start (1 - 2 t) + bend t^2.
            let bend = (best - start * (1.0 - 2.0 * factor)) / (factor * factor);
            let lowest = start / bend;
            let part = if lowest.is_finite() { lowest / factor } else { 0.0 };
            factor *= part.clamp(line_search_least, line_search_most);
            best = self.try_step(x, step, factor, (&trials, will_go_on));
        }
        factor
    }

    /// The squared residual after a part of the step, infinite where an element is inverted. Each try begins from the same
    /// state of contact; from some Newton's method `will_go_on`. Collective.
    pub(super) fn try_step(
        &mut self,
        x: &[f64],
        step: &[f64],
        factor: f64,
        (trials, will_go_on): (&[Trial], bool),
    ) -> f64 {
        self.reset(trials);
        let mut tried = Tried { x: x.iter().zip(step).map(|(x, s)| x - factor * s).collect(), ..Tried::default() };
        tried.residual.resize(x.len(), 0.0);
        let sound = self.evaluate(&tried.x, &mut tried.residual, will_go_on);
        let inverted = any(self.system.comm, !sound);
        self.line_search.tried = (!inverted).then_some(tried);
        if inverted || !self.line_search.squared_residual.is_finite() {
            f64::INFINITY
        } else {
            self.line_search.squared_residual
        }
    }

    /// The residual at `x`, if it was the last tried. Collective.
    pub(super) fn recall(&mut self, x: &[f64], r: &mut [f64]) -> bool {
        let known = any(self.system.comm, self.line_search.tried.is_some())
            && !any(self.system.comm, self.line_search.tried.as_ref().is_none_or(|t| t.x != x));
        if let Some(tried) = self.line_search.tried.take().filter(|_| known) {
            r.copy_from_slice(&tried.residual);
        }
        known
    }

    /// Makes the state of contact what it was.
    pub(super) fn reset(&mut self, trials: &[Trial]) {
        let slaves = self.system.model.pairs.iter_mut().flat_map(|p| &mut p.slaves);
        slaves.zip(trials).for_each(|(slave, trial)| slave.trial = *trial);
    }

    pub(super) fn slaves(&self) -> impl Iterator<Item = &Slave> {
        self.system.model.pairs.iter().flat_map(|p| &p.slaves)
    }
}

/// The square of the length of a distributed vector, with what is not in it. Collective.
pub(super) fn squared(comm: &SimpleCommunicator, r: &[f64], more: f64) -> f64 {
    let mut total = [r.iter().map(|v| v * v).sum::<f64>() + more];
    sum(comm, &mut total);
    total[0]
}
