//! How long the next increment is.
//!
//! Increments of the largest size make a grid of times, and no increment steps over one of these: after a cut the analysis
//! comes back to the grid, so that a run with cuts reports at the same times as one without. Nor does one step over a time at
//! which a table of loads or motions turns.

use crate::controls::Controls;
use crate::scene::Increment;

/// Chooses increments of a step; all in fractions of it.
#[derive(Clone, Debug)]
pub struct Increments {
    /// Fraction done.
    pub done: f64,
    /// Fractions that none steps over, besides the grid.
    corners: Vec<f64>,
    size: f64,
    /// The length and the iterations of the last hard increment after which a shorter one was taken.
    shortened: Option<(f64, usize)>,
    /// The length of the last that failed, or was shortened so: what is not easy does not grow up to it.
    limit: f64,
    min: f64,
    max: f64,
    controls: Controls,
}

/// Over an increment or the minimum, what is too little to be left to the grid or the end.
const SLIVER: f64 = 0.25;

impl Increments {
    pub fn new(bounds: &Increment, duration: f64, controls: &Controls) -> Self {
        let [size, min, max] = [bounds.initial, bounds.min, bounds.max].map(|time| time / duration);
        Self {
            done: 0.0,
            corners: Vec::new(),
            size,
            shortened: None,
            limit: f64::INFINITY,
            min,
            max,
            controls: *controls,
        }
    }

    /// The same, which end at these fractions, too, at which loads turn; in their order.
    pub fn meeting(self, corners: Vec<f64>) -> Self {
        Self { corners, ..self }
    }

    /// Whether loads turn where it is.
    pub fn is_at_corner(&self) -> bool {
        self.corners.contains(&self.done)
    }

    /// What is done, how long the next is to be, the length and the iterations of the one that was shortened, and the limit.
    pub fn course(&self) -> [f64; 5] {
        let (longer, iterations) = self.shortened.unwrap_or_default();
        [self.done, self.size, longer, iterations as f64, self.limit]
    }

    /// Goes on from there.
    pub fn go_on(&mut self, [done, size, longer, iterations, limit]: [f64; 5]) {
        (self.done, self.size, self.limit) = (done, size, limit);
        self.shortened = (longer > 0.0).then_some((longer, iterations as usize));
    }

    /// The fraction of the step at the end of the next increment; `None` at the end of the step.
    pub fn next(&self) -> Option<f64> {
        self.next_of(self.size)
    }

    /// The same of an increment of another size.
    fn next_of(&self, size: f64) -> Option<f64> {
        let rounding = 1e-9 * self.max;
        if self.done >= 1.0 - rounding {
            return None;
        }
        // What would leave less than a sliver to the grid, to a corner, or to the end, goes all the way.
        let sliver = SLIVER * size.min(self.min);
        let grid = (((self.done + sliver.max(rounding)) / self.max).floor() + 1.0) * self.max;
        let corner = self.corners.iter().copied().find(|corner| *corner > self.done + rounding).unwrap_or(1.0);
        let stop = if grid > corner - sliver.max(rounding) { corner } else { grid };
        Some(if self.done + size > stop - sliver { stop } else { self.done + size })
    }

    /// The increment to `end` has converged in so many iterations; `busy` when many contacts changed. After an easy one the next
    /// is longer; after others that are not hard it is, too, but shorter than the last that was shortened or failed. After a hard one
    /// it is shorter. Where that has saved less than half of what it costs in increments, length is not why, and it is as long again.
    pub fn accept(&mut self, end: f64, iterations: usize, busy: bool) {
        let length = end - std::mem::replace(&mut self.done, end);
        let Controls { easy_iterations, hard_iterations, increment_growth, increment_cut, .. } = self.controls;
        let is_cut = |longer: f64| length <= increment_cut * longer * (1.0 + 1e-9);
        let is_as_long = |longer: f64| length >= longer * (1.0 - 1e-9);
        let serves = |then: usize| iterations as f64 <= 0.5 * (1.0 + increment_cut) * then as f64;
        let grown = (increment_growth * self.size).min(self.max);
        match self.shortened {
            _ if busy && iterations <= hard_iterations => {}
            _ if iterations <= easy_iterations => {
                (self.size, self.shortened, self.limit) = (grown, None, f64::INFINITY);
            }
            _ if iterations <= hard_iterations => {
                self.size = if grown < self.limit * (1.0 - 1e-9) { grown } else { self.size };
            }
            Some((longer, then)) if is_cut(longer) && !serves(then) => {
                (self.size, self.limit) = (longer.min(self.max), f64::INFINITY);
            }
            Some((longer, then)) if is_as_long(longer) && iterations <= then => {}
            // It had grown too far.
            Some((longer, _)) if !is_cut(longer) && !is_as_long(longer) => {
                (self.size, self.limit) = ((increment_cut * longer).max(self.min), length);
            }
            _ => {
                self.size = (increment_cut * self.size).max(self.min);
                (self.shortened, self.limit) = (Some((length, iterations)), length);
            }
        }
    }

    /// After a jump, which was sought in a short increment for its own sake: the next is as long as it may be.
    pub fn resume(&mut self) {
        self.size = self.max;
    }

    /// How many equal parts the increment to `end` may be taken in, of which none is shorter than the minimum.
    pub fn most_parts(&self, end: f64) -> usize {
        ((end - self.done) / self.min * (1.0 + 1e-9)).max(1.0) as usize
    }

    /// The increment to `end` has failed: cuts it, or cuts it twice where it was cut before, to no less than the minimum, and to that
    /// where what is left over would be taken along again.
    pub fn cut(&mut self, end: f64, twice: bool) {
        (self.shortened, self.limit) = (None, end - self.done);
        let part = self.controls.increment_cut.powi(if twice { 2 } else { 1 });
        self.size = (part * (end - self.done)).max(self.min);
        if self.next().is_none_or(|shorter| shorter >= end) {
            self.size = self.min;
        }
    }

    /// Whether the increment to `end` is so short that a shorter one would hardly serve, or as short as it may be.
    pub fn is_short(&self, end: f64) -> bool {
        end - self.done <= (self.controls.short_increment * self.max).max(self.min) * (1.0 + 1e-9)
            || self.is_shortest(end)
    }

    /// Whether the increment to `end` is as short as it may be, or as short as what it would leave may be.
    pub fn is_shortest(&self, end: f64) -> bool {
        end - self.done <= self.min * (1.0 + 1e-9) || self.next_of(self.min).is_none_or(|shortest| shortest >= end)
    }

    /// Makes the next increment longer than that to `end`, which failed, by what two cuts had taken away, as far as the grid
    /// allows; `false` when that was as long as it may be.
    pub fn lengthen(&mut self, end: f64) -> bool {
        self.size = ((end - self.done) / self.controls.increment_cut.powi(2)).min(self.max);
        self.next().is_some_and(|longer| longer > end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;

    fn bounds(initial: f64, min: f64, max: f64) -> Increment {
        Increment { initial, min, max, limits: Limits::default() }
    }

    #[test]
    fn an_increment_that_no_cut_makes_shorter_is_the_shortest() {
        for (initial, min, max, cut) in
            [(0.2, 0.17, 0.2, 0.5), (0.1, 0.09, 0.2, 0.5), (0.2, 0.05, 0.2, 0.5), (0.2, 0.1, 0.2, 0.9)]
        {
            let mut controls = Controls::default();
            assert!(controls.set("increment_cut", cut));
            let mut increments = Increments::new(&bounds(initial, min, max), 1.0, &controls);
            let mut end = increments.next().unwrap();
            for _ in 0..10 {
                if increments.is_shortest(end) {
                    break;
                }
                increments.cut(end, false);
                assert!(increments.next().unwrap() < end, "{initial} {min} {max} {cut}");
                end = increments.next().unwrap();
            }
            assert!(increments.is_shortest(end) && increments.is_short(end));
        }
    }

    fn times(mut increments: Increments, fails: impl Fn(f64, f64) -> bool) -> Vec<f64> {
        let mut times = Vec::new();
        while let Some(end) = increments.next() {
            if fails(increments.done, end) {
                increments.cut(end, false);
            } else {
                increments.accept(end, 3, false);
                times.push(end);
            }
        }
        times
    }

    #[test]
    fn uniform_increments_hit_the_end_exactly() {
        let all = times(Increments::new(&bounds(0.1, 1e-3, 0.1), 1.0, &Controls::default()), |_, _| false);
        assert_eq!(all.len(), 10);
        assert_eq!(all[9], 1.0);
        let bounds = bounds(0.00125, 1e-6, 0.00125);
        assert_eq!(times(Increments::new(&bounds, 1.0, &Controls::default()), |_, _| false).len(), 800);
    }

    #[test]
    fn after_a_cut_the_grid_is_met_again() {
        let bounds = bounds(0.1, 1e-3, 0.1);
        let cut = times(Increments::new(&bounds, 1.0, &Controls::default()), |from, to| {
            to > 0.35 && to - from > 0.06 && from < 0.35
        });
        for k in 1..=10 {
            assert!(cut.iter().any(|t| (t - 0.1 * k as f64).abs() < 1e-12), "{k} in {cut:?}");
        }
        assert!(cut.len() < 13, "{cut:?}");
    }

    #[test]
    fn a_grid_that_almost_meets_the_end_ends_there() {
        let bounds = bounds(0.3333, 1e-3, 0.3333);
        let all = times(Increments::new(&bounds, 1.0, &Controls::default()), |_, _| false);
        assert_eq!((all.len(), all[2]), (3, 1.0));
    }

    /// Corners between the points of the grid, on one but for rounding, close before one, and close behind one.
    #[test]
    fn none_steps_over_a_corner() {
        let bounds = bounds(0.1, 1e-3, 0.1);
        let corners = vec![0.05, 0.3 + 1e-15, 0.49999, 0.60001, 0.999_999];
        let increments = Increments::new(&bounds, 1.0, &Controls::default()).meeting(corners.clone());
        let all = times(increments.clone(), |_, _| false);
        assert!(corners.iter().all(|corner| all.contains(corner)), "{all:?}");
        assert_eq!(all.len(), 12, "{all:?}");
        let cut = times(increments, |from, to| to > 0.2 && to - from > 0.03 && from < 0.35);
        assert!(corners.iter().chain(&[0.4, 1.0]).all(|corner| cut.contains(corner)), "{cut:?}");
    }

    #[test]
    fn the_minimum_is_the_end() {
        let bounds = bounds(0.1, 0.04, 0.1);
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        increments.cut(0.1, false);
        assert!((increments.next(), increments.is_short(0.05)) == (Some(0.05), false));
        increments.cut(0.05, true);
        assert!((increments.next(), increments.is_short(0.04)) == (Some(0.04), true));
    }

    /// Increments that take many iterations however short they are stay long; those that take fewer when they are shorter
    /// do not.
    #[test]
    fn increments_are_shortened_while_that_saves_iterations() {
        let count = |initial: f64, iterations: fn(f64) -> usize| {
            let mut increments = Increments::new(&bounds(initial, 1e-4, 0.1), 1.0, &Controls::default());
            let mut count = 0;
            while let Some(end) = increments.next() {
                increments.accept(end, iterations(end - increments.done), false);
                count += 1;
            }
            count
        };
        // One half, and the rest of what it was cut from.
        assert_eq!(count(0.1, |_| 12), 11);
        assert_eq!(count(0.1, |length| if length > 0.06 { 15 } else { 14 }), 11);
        // All but the first.
        assert_eq!(count(0.1, |length| if length > 0.06 { 14 } else { 8 }), 19);
        assert_eq!(count(0.1, |length| if length > 0.06 { 30 } else { 20 }), 20);
        // It grows to the largest.
        assert_eq!(count(0.05, |_| 8), 11);
    }

    #[test]
    fn parts_are_not_below_the_minimum() {
        let mut increments = Increments::new(&bounds(0.1, 0.025, 0.1), 1.0, &Controls::default());
        assert_eq!(increments.most_parts(0.1), 4);
        increments.accept(0.05, 3, false);
        assert_eq!((increments.most_parts(0.1), increments.most_parts(0.06)), (2, 1));
    }
}
