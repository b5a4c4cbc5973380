//! What a run will take: its time and its memory, from its size and the rates of the machine.
//!
//! How often each kind of work is done, and what is held in memory, are laws whose constants are fitted to the scenes of
//! `inputs/`, docs/validation/prediction.md.

use super::machine::Machine;
use super::size::{Increments, Size, Systems};
use super::work::Work;
use super::{least_worth, patience, solver};
use crate::output::summary::Foretold;
use crate::scene::Linear;
use petsc::Factors;
use std::fmt::Write;

/// What a run will take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Wall time, and what of it elements, contact, and linear systems take, s.
    pub wall_s: f64,
    assembly_s: f64,
    contact_s: f64,
    linear_s: f64,
    /// Peak memory of all ranks, MB of 10^6 bytes.
    pub memory_mb: f64,
    /// The same should multigrid fail or take too long, and factors take over; 0 where that is not foreseen.
    fallback_mb: f64,
    ranks: f64,
}

/// How systems are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Course {
    solver: Linear,
    /// From multigrid to factors, after the first systems.
    hands_over: bool,
    increments: f64,
    /// Newton iterations.
    iterations: f64,
    /// Share of the systems that are factored, and iterations of each of the others with old factors.
    factored: f64,
    old: f64,
    /// Iterations of multigrid a system.
    cycles: f64,
}

/// Newton iterations a step, and an increment: elastic bodies, those that meet themselves, plastic bodies, those with friction.
const OF_A_STEP: f64 = 2.0;
const ELASTIC: f64 = 2.7;
const SELF_CONTACT: f64 = 5.5;
const PLASTIC: f64 = 4.2;
const PLASTIC_WITH_FRICTION: f64 = 7.0;
/// Increments over those asked for, where they may vary and plastic bodies rub.
const CUT: f64 = 1.3;
/// Share of the systems that are factored, and iterations of the others: elastic bodies, plastic ones, those with friction.
const OLD: [[f64; 2]; 3] = [[0.26, 6.5], [0.55, 11.0], [0.7, 16.0]];
/// Set-ups of multigrid a system; iterations of a system under tools, between bodies, in thin bodies; systems until factors
/// take over.
const SET_UPS: f64 = 0.27;
const CYCLES: [f64; 3] = [14.5, 25.0, 90.0];
const UNTIL_FACTORS: f64 = 3.0;
/// Evaluations of all elements an iteration: in plane strain, in space, with plastic flow.
const PASSES: [f64; 3] = [1.45, 1.15, 1.05];
/// What is written of an increment, s.
const OUTPUT: f64 = 2e-3;
/// A slave node of a tool over one of a body.
const OF_A_TOOL: f64 = 0.3;
/// MB that each rank takes for libraries at work, bytes an entry of the matrix, an entry of the factors on one rank, a unit of
/// multigrid, and a number of a vector.
const AT_WORK: f64 = 8.8;
const ENTRY: f64 = 62.0;
const OF_FACTORS: f64 = 9.5;
const ON_SEVERAL: f64 = 1.25;
const OF_MULTIGRID: f64 = 48.0;
/// Of the symmetric matrix by which stability is judged with friction; its own factors are half as many as those of the tangent.
/// Without friction it is the tangent itself, which tells by its factors unless old ones serve.
const JUDGED: f64 = 46.0;
const VECTOR: f64 = 8.0;
/// Entries over n log n, operations over n^(3/2), of a symmetric matrix in a plane and in a sheet; over n^(4/3) and n^2 in
/// space.
const PLANE: [f64; 2] = [5.5, 40.0];
const SHEET: [f64; 2] = [20.0, 430.0];
const SPACE: [f64; 2] = [16.0, 15.0];

impl Prediction {
    /// Of a scene with these steps.
    pub fn new(machine: &Machine, size: &Size, steps: &[(Increments, Systems)]) -> Self {
        let mut all = Self { wall_s: size.seconds, memory_mb: size.megabytes, ranks: size.ranks, ..Self::default() };
        for (increments, systems) in steps {
            let course = Course::new(size, *increments, systems);
            all.add_time(machine, size, &course, systems);
            all.add_memory(size, &course, systems);
        }
        all
    }

    fn add_time(&mut self, machine: &Machine, size: &Size, course: &Course, systems: &Systems) {
        let rate = |work| machine.rates.of(work);
        let elements: f64 = size.elements.iter().map(|(work, count)| count * rate(*work)).sum();
        let passes = match (size.flows, size.plane) {
            (true, _) => PASSES[2],
            (false, true) => PASSES[0],
            (false, false) => PASSES[1],
        };
        let slave = rate(Work::Slave) * if size.meets_bodies { 1.0 } else { OF_A_TOOL };
        // Half of what comes besides goes with the unknowns, half with the entries, of which 60 are usual in space.
        let besides = rate(Work::Unknown) * (0.4 * systems.unknowns + 0.6 * systems.entries / 60.0);
        let assembly = systems.set_up_s + course.iterations * passes * elements;
        let contact = course.iterations * size.slaves * slave;
        let linear = course.linear(machine, size, systems);
        self.assembly_s += assembly;
        self.contact_s += contact;
        self.linear_s += linear;
        self.wall_s += assembly + contact + linear + course.iterations * besides + course.increments * OUTPUT;
    }

    fn add_memory(&mut self, size: &Size, course: &Course, systems: &Systems) {
        let several = if size.ranks > 1.0 { ON_SEVERAL } else { 1.0 };
        let vectors = |iterations: f64| 1e-6 * 2.0 * VECTOR * iterations * systems.unknowns;
        let common = size.megabytes + AT_WORK * size.ranks + 1e-6 * ENTRY * systems.entries;
        let of_factors = 1e-6 * OF_FACTORS * several * systems.factored(size).entries;
        let judged = match course.solver {
            Linear::Iterative => 0.0,
            _ if size.meets_itself => 0.0,
            _ if size.rubs => 0.5 * of_factors + 1e-6 * JUDGED * systems.entries,
            Linear::Reuse => of_factors,
            _ => 0.0,
        };
        let factors = of_factors + judged + vectors(course.old);
        let multigrid = 1e-6 * OF_MULTIGRID * systems.entries + vectors(course.cycles);
        let (memory, fallback) = match course.solver {
            Linear::Iterative if course.hands_over => (factors + multigrid, 0.0),
            Linear::Iterative => (multigrid, common + factors + multigrid),
            _ => (factors, 0.0),
        };
        self.memory_mb = self.memory_mb.max(common + memory);
        self.fallback_mb = self.fallback_mb.max(fallback);
    }

    /// In words: its memory, against what the machine has, MB, and its time.
    pub fn describe(&self, machine: &Machine, has: Option<f64>) -> String {
        let mut text = format!("memory: about {:.0} MB", self.memory_mb);
        if self.ranks > 1.0 {
            let _ = write!(text, ", {:.0} a rank", self.memory_mb / self.ranks);
        }
        if self.fallback_mb > self.memory_mb {
            let _ = write!(text, "; {:.0} MB where factors take over from multigrid", self.fallback_mb);
        }
        if let Some(has) = has.filter(|has| *has < self.memory_mb) {
            let _ = write!(text, "\n  warning: this machine has {has:.0} MB");
        }
        let parts = [("elements", self.assembly_s), ("contact", self.contact_s), ("linear systems", self.linear_s)];
        let (most, seconds) = parts.into_iter().fold(parts[0], |most, part| if part.1 > most.1 { part } else { most });
        let share = 100.0 * seconds / self.wall_s;
        let [low, middle, high] = [0.5, 1.0, 2.0].map(|factor| duration(factor * self.wall_s));
        let _ = write!(text, "\ntime: about {middle} ({low} to {high}), of which {most} take {share:.0} %");
        let _ = write!(text, "\n  {}", machine.origin());
        text
    }

    /// What is written into the summary.
    pub fn foretold(&self) -> Foretold {
        Foretold { wall_s: self.wall_s, memory_mb: self.memory_mb }
    }

    /// How far it was off, in words.
    pub fn told(&self, wall_s: f64, memory_mb: f64) -> String {
        format!(
            "predicted:   {}, {:.0} MB; measured over that {:.2}, {:.2}",
            duration(self.wall_s),
            self.memory_mb,
            wall_s / self.wall_s,
            memory_mb / self.memory_mb
        )
    }
}

impl Course {
    fn new(size: &Size, increments: Increments, systems: &Systems) -> Self {
        let unknowns = systems.unknowns as u64;
        let solver = solver(systems.linear, unknowns, size.plane || size.thin);
        let cycles = CYCLES[if size.thin { 2 } else { usize::from(size.meets_bodies) }];
        let reuses = match solver {
            Linear::Direct => false,
            _ => systems.factored(size).worth() >= least_worth(systems.linear),
        };
        let [share, old] = OLD[if size.flows { 1 + usize::from(size.rubs) } else { 0 }];
        let per_increment = match (size.flows, size.rubs) {
            (false, _) if size.meets_itself => SELF_CONTACT,
            (false, _) => ELASTIC,
            (true, false) => PLASTIC,
            (true, true) => PLASTIC_WITH_FRICTION,
        };
        let cut = if increments.vary && size.flows && size.rubs { CUT } else { 1.0 };
        Self {
            solver,
            hands_over: solver == Linear::Iterative && cycles > patience(systems.linear, unknowns) as f64,
            increments: cut * increments.asked,
            iterations: OF_A_STEP + per_increment * cut * increments.asked,
            factored: if reuses { share } else { 1.0 },
            old: if reuses { old } else { 0.0 },
            cycles,
        }
    }

    /// Seconds of all systems.
    fn linear(&self, machine: &Machine, size: &Size, systems: &Systems) -> f64 {
        let rate = |work| machine.rates.of(work);
        let by_multigrid = systems.entries * (SET_UPS * rate(Work::SetUp) + self.cycles * rate(Work::Cycle));
        let Factors { entries, operations } = systems.factored(size);
        let application = entries * rate(Work::Application) + systems.unknowns * rate(Work::Row);
        let factored = rate(Work::Factorization) + entries * rate(Work::Entry) + operations * rate(Work::Operation);
        let old = self.old * (application + systems.entries * rate(Work::Product));
        let by_factors = self.factored * (factored + application) + (1.0 - self.factored) * old;
        match self.solver {
            Linear::Iterative if self.hands_over => {
                let first = UNTIL_FACTORS.min(self.iterations);
                first * by_multigrid + (self.iterations - first) * by_factors
            }
            Linear::Iterative => self.iterations * by_multigrid,
            _ => self.iterations * by_factors,
        }
    }
}

impl Systems {
    /// What a factorization is, as analysed or as usual for so many unknowns: nested dissection of a grid in a plane takes
    /// n log n entries and n^(3/2) operations, as does one of a sheet, of one in space n^(4/3) and n^2 (A. George, SIAM J.
    /// Numer. Anal. 10 (1973)).
    fn factored(&self, size: &Size) -> Factors {
        self.factors.unwrap_or_else(|| {
            let (n, halves) = (self.unknowns.max(2.0), if self.is_symmetric { 1.0 } else { 2.0 });
            let flat = |[entries, operations]: [f64; 2]| [entries * n * n.ln(), operations * n.powf(1.5)];
            let [entries, operations] = match (size.plane, size.thin) {
                (true, _) => flat(PLANE),
                (_, true) => flat(SHEET),
                _ => [SPACE[0] * n.powf(4.0 / 3.0), SPACE[1] * n * n],
            };
            Factors { entries: halves * entries, operations: halves * operations }
        })
    }
}

/// A time as people say it.
fn duration(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.1} s"),
        10.0..120.0 => format!("{seconds:.0} s"),
        120.0..7200.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_memory_than_the_machine_has_is_warned_of() {
        let machine = Machine::usual(1);
        let foretold = Prediction {
            memory_mb: 4000.0,
            fallback_mb: 9000.0,
            wall_s: 100.0,
            linear_s: 60.0,
            ..Prediction::default()
        };
        let text = foretold.describe(&machine, Some(3000.0));
        let memory = "memory: about 4000 MB; 9000 MB where factors take over from multigrid\n";
        assert!(text.starts_with(&format!("{memory}  warning: this machine has 3000 MB\n")), "{text}");
        assert!(text.contains("\ntime: about 100 s (50 s to 3 min), of which linear systems take 60 %\n"), "{text}");
        assert!(!foretold.describe(&machine, Some(5000.0)).contains("warning"));
        assert!(!foretold.describe(&machine, None).contains("warning"));
    }

    #[test]
    fn factors_of_unknown_patterns_are_those_of_grids() {
        let systems = |unknowns, is_symmetric| Systems {
            unknowns,
            entries: 0.0,
            is_symmetric,
            factors: None,
            linear: Linear::Auto,
            set_up_s: 0.0,
        };
        let size = Size { ranks: 1.0, ..Size::default() };
        let (whole, half) = (systems(1e6, false).factored(&size), systems(1e6, true).factored(&size));
        assert_eq!((half.entries / whole.entries, half.operations / whole.operations), (0.5, 0.5));
        let more = systems(8e6, false).factored(&size);
        assert!(
            (more.entries / whole.entries / 16.0 - 1.0).abs() < 1e-9
                && (more.operations / whole.operations / 64.0 - 1.0).abs() < 1e-9
        );
    }
}
