//! What the runs came to: errors and costs side by side, and who is on the front of which.

use super::Made;
use super::child::Cost;
use super::errors::{Errors, Quantity};
use super::front::front;

/// What is paid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Price {
    Wall,
    Processor,
    Memory,
}

impl Price {
    /// All, in the order of their declaration.
    pub const ALL: [Self; 3] = [Self::Wall, Self::Processor, Self::Memory];

    pub fn of(self, cost: &Cost) -> f64 {
        match self {
            Self::Wall => cost.wall_s,
            Self::Processor => cost.cpu_s,
            Self::Memory => cost.memory_mb,
        }
    }

    /// What axes call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall time, s",
            Self::Processor => "processor time, s",
            Self::Memory => "memory, MB",
        }
    }
}

/// A run that converged.
#[derive(Clone, Debug)]
pub struct Row<'a> {
    /// The number that it has in tables and figures, from 1.
    pub number: usize,
    pub made: &'a Made,
    pub cost: Cost,
    /// Of the reference, those that no reference is needed for.
    pub errors: Errors,
    pub is_reference: bool,
    /// By price and quantity: whether no other run costs no more and errs no more.
    pub on_front: [[bool; Quantity::ALL.len()]; Price::ALL.len()],
}

/// All runs, those that converged by their wall time.
#[derive(Clone, Debug)]
pub struct Sheet<'a> {
    pub rows: Vec<Row<'a>>,
    /// With their numbers, which go on.
    pub failures: Vec<(usize, &'a Made)>,
    /// Quantities that some run has an error of.
    pub quantities: Vec<Quantity>,
    /// Those among them that are measured by what is known exactly.
    pub exact: Vec<Quantity>,
    /// How far the reference is off itself, where that is known; what is closer cannot be told from it.
    pub floor: Errors,
}

/// Below it an error is none but rounding.
const ROUNDING: f64 = 1e-13;

impl<'a> Sheet<'a> {
    /// Of runs with their errors, which those have that converged.
    pub fn new(
        runs: &'a [Made],
        errors: &[Option<Errors>],
        reference: Option<usize>,
        exact: &[Quantity],
        floor: Errors,
    ) -> Self {
        let judged = |of: &Quantity| of.is_absolute() || exact.contains(of);
        let own = |k: usize, errors: Errors| {
            let mut kept = errors;
            let relative = Quantity::ALL.into_iter().filter(|of| reference == Some(k) && !judged(of));
            relative.for_each(|of| kept.set(of, None));
            kept
        };
        let mut rows: Vec<Row> = (runs.iter().zip(errors).enumerate())
            .filter_map(|(k, (made, errors))| {
                let (cost, errors) = (made.cost()?, own(k, (*errors)?));
                let on_front = Default::default();
                Some(Row { number: 0, made, cost, errors, is_reference: reference == Some(k), on_front })
            })
            .collect();
        rows.sort_by(|a, b| a.cost.wall_s.total_cmp(&b.cost.wall_s));
        rows.iter_mut().enumerate().for_each(|(k, row)| row.number = k + 1);
        let failed = runs.iter().filter(|made| made.cost().is_none());
        let failures = failed.enumerate().map(|(k, made)| (rows.len() + k + 1, made)).collect();
        let has = |of: &Quantity| {
            rows.iter().any(|row| row.errors.get(*of).is_some_and(|error| error.is_nan() || error > ROUNDING))
        };
        let quantities = Quantity::ALL.into_iter().filter(has).collect();
        let mut sheet = Self { rows, failures, quantities, exact: exact.to_vec(), floor };
        sheet.mark();
        sheet
    }

    /// Finds the fronts.
    fn mark(&mut self) {
        for (p, price) in Price::ALL.into_iter().enumerate() {
            for of in Quantity::ALL {
                let pair = |row: &Row| {
                    let error = row.errors.get(of).map_or(f64::NAN, |error| error.max(self.least(of)));
                    (price.of(&row.cost), error)
                };
                let on = front(&self.rows.iter().map(pair).collect::<Vec<_>>());
                self.rows.iter_mut().zip(on).for_each(|(row, on)| row.on_front[p][of as usize] = on);
            }
        }
    }

    /// The error below which runs cannot be told from the reference.
    pub fn least(&self, of: Quantity) -> f64 {
        let floor = self.floor.get(of).filter(|_| !self.exact.contains(&of) && !of.is_absolute());
        floor.unwrap_or(0.0).max(ROUNDING)
    }

    /// The quantities for people: not all those for machines.
    pub fn shown(&self) -> impl Iterator<Item = Quantity> {
        self.quantities.iter().copied().filter(|of| of.is_shown() || self.exact.contains(of))
    }
}

#[cfg(test)]
mod tests {
    use super::super::child::Ended;
    use super::super::plan::Variant;
    use super::*;

    fn made(label: &str, wall_s: f64, memory_mb: f64) -> Made {
        let cost = Cost { wall_s, cpu_s: wall_s, memory_mb, ..Cost::default() };
        let ended = Ended { code: Some(0), cost: Some(cost), ..Ended::default() };
        Made { variant: Variant::new(label, Vec::new(), None), ended }
    }

    fn force(error: f64) -> Option<Errors> {
        let mut errors = Errors::default();
        errors.set(Quantity::Force, Some(error));
        Some(errors)
    }

    #[test]
    fn rows_are_by_wall_time_and_fronts_by_each_price() {
        let failed = Made {
            variant: Variant::new("failed", Vec::new(), None),
            ended: Ended { code: Some(1), reason: "no".into(), ..Ended::default() },
        };
        let runs = [made("a", 2.0, 50.0), failed, made("ref", 9.0, 90.0), made("b", 1.0, 60.0), made("c", 3.0, 40.0)];
        let errors = [force(0.1), None, force(0.0), force(0.5), force(0.2)];
        let floor = |error| force(error).unwrap();
        let sheet = Sheet::new(&runs, &errors, Some(2), &[], floor(0.01));
        let labels: Vec<&str> = sheet.rows.iter().map(|row| row.made.variant.label.as_str()).collect();
        assert_eq!(labels, ["b", "a", "c", "ref"]);
        let on = |price: Price| sheet.rows.iter().map(|row| row.on_front[price as usize][0]).collect::<Vec<_>>();
        assert_eq!(on(Price::Wall), [true, true, false, false]);
        assert_eq!(on(Price::Memory), [false, true, true, false]);
        assert_eq!(sheet.failures.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [5]);
        assert_eq!(sheet.quantities, [Quantity::Force]);
        // What cannot be told from the reference is equal, so that the cheaper is better.
        let sheet = Sheet::new(&runs, &errors, Some(2), &[], floor(0.6));
        assert_eq!(sheet.rows.iter().map(|row| row.on_front[0][0]).collect::<Vec<_>>(), [true, false, false, false]);
        // By what is known exactly, the reference is a run as others.
        let sheet = Sheet::new(&runs, &errors, Some(2), &[Quantity::Force], floor(0.6));
        assert_eq!(sheet.rows.iter().map(|row| row.on_front[0][0]).collect::<Vec<_>>(), [true, true, false, true]);
    }
}
