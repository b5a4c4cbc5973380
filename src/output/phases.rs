//! Where the wall time goes: seconds in each phase of a run, and how often it was entered.

use mpi::collective::SystemOperation;
use mpi::traits::*;
use std::cell::Cell;
use std::time::{Duration, Instant};

/// The phases of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Read,
    Partition,
    Search,
    Watch,
    Assembly,
    Factor,
    Solve,
    Output,
}

/// All phases with their names in `summary.json`, in the order of [`Phases::slowest`].
pub const PHASES: [(Phase, &str); 8] = [
    (Phase::Read, "read"),
    (Phase::Partition, "partition"),
    (Phase::Search, "search"),
    (Phase::Watch, "watch"),
    (Phase::Assembly, "assembly"),
    (Phase::Factor, "factor"),
    (Phase::Solve, "solve"),
    (Phase::Output, "output"),
];

/// Adds up the time of this rank in each phase. Shared by reference among the parts of an analysis.
#[derive(Debug, Default)]
pub struct Phases {
    seconds: [Cell<f64>; PHASES.len()],
    calls: [Cell<usize>; PHASES.len()],
}

impl Phases {
    /// Runs `work` and counts its time; phases do not nest.
    pub fn time<T>(&self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = work();
        self.add(phase, start.elapsed());
        done
    }

    /// Counts time measured elsewhere, of one call.
    pub fn add(&self, phase: Phase, time: Duration) {
        self.add_calls(phase, time, 1);
    }

    /// The same of so many calls.
    pub fn add_calls(&self, phase: Phase, time: Duration, calls: usize) {
        self.seconds[phase as usize].update(|seconds| seconds + time.as_secs_f64());
        self.calls[phase as usize].update(|before| before + calls);
    }

    /// Calls of this rank in each phase of [`PHASES`].
    pub fn calls(&self) -> [usize; PHASES.len()] {
        self.calls.each_ref().map(Cell::get)
    }

    /// Seconds of this rank in a phase.
    pub fn seconds(&self, phase: Phase) -> f64 {
        self.seconds[phase as usize].get()
    }

    /// Seconds in each phase of [`PHASES`], of the rank that took longest in it. Collective.
    pub fn slowest(&self, comm: &impl Communicator) -> [f64; PHASES.len()] {
        let own = self.seconds.each_ref().map(Cell::get);
        let mut slowest = own;
        comm.all_reduce_into(&own[..], &mut slowest[..], SystemOperation::max());
        slowest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_add_up_in_their_phase() {
        let phases = Phases::default();
        assert_eq!(phases.time(Phase::Solve, || 7), 7);
        phases.add(Phase::Solve, Duration::from_millis(500));
        phases.add(Phase::Solve, Duration::from_millis(250));
        phases.add_calls(Phase::Factor, Duration::ZERO, 4);
        assert!((0.75..0.76).contains(&phases.seconds(Phase::Solve)));
        assert_eq!(phases.calls(), [0, 0, 0, 0, 0, 4, 3, 0]);
        assert_eq!(phases.seconds(Phase::Read), 0.0);
    }

    #[test]
    fn names_stand_in_the_order_of_the_phases() {
        assert!(PHASES.iter().enumerate().all(|(index, (phase, _))| *phase as usize == index));
    }
}
