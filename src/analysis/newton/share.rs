//! Increments that are as long as their trial state allows.
//!
//! The trial state of an increment, the linear prediction from the last converged one or its extrapolation, tells how much the
//! increment would change. Where an integration point would be strained by more than a limit, or more than a share of the
//! slave nodes would touch or leave, only a share r of the increment is taken (the r_min of Yamada, Yoshimura and Sakurai,
//! Int. J. Mech. Sci. 10 (1968) 343-354): from u + r Du at the fraction s + r Ds of the step Newton's method goes on. r is
//! 1/n, so that n such increments end where the whole one would have.

use super::Newton;
use crate::contact::{Status, Trial};
use crate::model::elements;
use crate::parallel::{max, sum};
use crate::scene::Limits;

/// How small a share of an increment may be taken, and when.
#[derive(Clone, Copy, Debug)]
pub struct Share {
    /// Fraction of the step at the beginning of the increment.
    pub begin: f64,
    /// 1/r at most.
    pub most: usize,
    pub limits: Limits,
}

impl Share {
    /// The whole increment, whatever it changes.
    pub const ALL: Self = Self { begin: 0.0, most: 1, limits: Limits { strain: None, contacts: None } };
}

impl Newton<'_> {
    /// The share of the increment to take when x - `step` is the trial state of the whole, by which the increment is
    /// shortened. Collective.
    pub(super) fn shorten(&mut self, x: &[f64], step: &[f64]) -> f64 {
        let Share { begin, most, limits } = self.strategy.share;
        if most <= 1 || limits == Limits::default() {
            return 1.0;
        }
        let whole = self.s - begin;
        let trials: Vec<Trial> = self.slaves().map(|s| s.trial).collect();
        let parts = parts(most, |r| {
            self.s = begin + r * whole;
            let strain = limits.strain.map_or(0.0, |limit| self.trial_strain(x, step, r) / limit);
            let contacts = limits.contacts.map_or(0.0, |share| self.trial_changes(x, step, r, &trials) / share);
            strain.max(contacts)
        });
        self.line_search.tried = None;
        self.reset(&trials);
        if parts > 1 {
            self.s = begin + whole / parts as f64;
        }
        1.0 / parts as f64
    }

    /// The largest strain in the trial state of a share of the increment. Collective.
    fn trial_strain(&mut self, x: &[f64], step: &[f64], r: f64) -> f64 {
        let there: Vec<f64> = x.iter().zip(step).map(|(x, s)| x - r * s).collect();
        self.unpack(&there);
        let mut strain = [elements::largest_strain(self.system.model, self.system.committed, &self.found.u)];
        max(self.system.comm, &mut strain);
        strain[0]
    }

    /// The share of the slave nodes that touch or leave in the trial state of a share of the increment; one node does not
    /// count. Collective.
    fn trial_changes(&mut self, x: &[f64], step: &[f64], r: f64, trials: &[Trial]) -> f64 {
        self.try_step(x, step, r, (trials, false));
        let mut counts = [0.0; 2];
        for pair in &self.system.model.pairs {
            let none = self.system.model.controls.touching_gap * pair.facet_size;
            for slave in &pair.slaves {
                let [apart, now_apart] = [slave.committed.status, slave.trial.status].map(|s| s == Status::Gap);
                // What stands on the master without a force, as bodies that are meshed to touch, touches already.
                let stands = apart && slave.accepted.projection.is_some_and(|p| p.gap <= none);
                counts[0] += 1.0;
                counts[1] += f64::from(apart != now_apart && !stands);
            }
        }
        sum(self.system.comm, &mut counts);
        if counts[1] > 1.0 { counts[1] / counts[0] } else { 0.0 }
    }
}

/// Into how many parts to divide a whole, `most` at most, for the first of them to have an `excess` of no more than 1.
fn parts(most: usize, mut excess: impl FnMut(f64) -> f64) -> usize {
    const ROUNDING: f64 = 1e-9;
    let mut n = 1;
    while n < most {
        let over = excess(1.0 / n as f64);
        if over <= 1.0 + ROUNDING {
            break;
        }
        // As if it were proportional to the part, which of an inverted element says nothing.
        let enough = if over.is_finite() { (n as f64 * over - ROUNDING).ceil() } else { 2.0 * n as f64 };
        n = (enough as usize).clamp(n + 1, 8 * n).min(most);
    }
    n
}

#[cfg(test)]
mod tests {
    use super::parts;

    #[test]
    fn the_first_part_has_no_excess() {
        assert_eq!(parts(1000, |r| 0.9 * r), 1);
        assert_eq!(parts(1000, |r| r), 1);
        assert_eq!(parts(1000, |r| 2.0 * r), 2);
        assert_eq!(parts(1000, |r| 2.1 * r), 3);
        assert_eq!(parts(1000, |r| 123.4 * r), 124);
        assert_eq!(parts(100, |r| 123.4 * r), 100);
        // Between the best and twice that where it is not proportional.
        for excess in [|r: f64| (30.0 * r).ln_1p(), |r: f64| 1.3 * (4.0 * r).exp_m1(), |r: f64| 7.0 * r.sqrt()] {
            let n = parts(1000, excess);
            let best = (1..).find(|&n| excess(1.0 / n as f64) <= 1.0).unwrap();
            assert!((best..=2 * best).contains(&n), "{n} and {best}");
        }
    }

    #[test]
    fn inverted_elements_divide_until_there_are_none() {
        assert_eq!(parts(1000, |r| if r > 0.2 { f64::INFINITY } else { 4.0 * r }), 8);
        assert_eq!(parts(10, |_| f64::INFINITY), 10);
    }
}
