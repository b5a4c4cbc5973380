//! Reads how the equations are solved, with the presets of accuracy, and paces the increments of steps.

use super::reader::{Item, Table};
use super::{Accuracy, Increment, Limits, Linear, Solver, Step};
use crate::error::{Faults, Result};

impl Accuracy {
    const ALL: [(&str, Self); 3] =
        [("draft", Self::Draft), ("balanced", Self::Balanced), ("reference", Self::Reference)];

    /// What it is in a scene file.
    pub fn key(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    /// The settings that it stands for, each of which may still be given by itself. `docs/validation/trade.md` has error and
    /// cost of each as measured: increments make the error that a run can trade, the tolerance hardly any.
    pub fn solver(self) -> Solver {
        let (pace, tolerance) = match self {
            Self::Draft => (4.0, 1e-6),
            Self::Balanced => (1.0, 1e-10),
            Self::Reference => (0.25, 1e-10),
        };
        Solver { accuracy: self, pace, tolerance, max_iterations: 15, force_floor: None, linear: Linear::Auto }
    }
}

/// The table `solver`.
pub(super) fn read(root: &Table) -> Result<Solver> {
    let keys = ["accuracy", "pace", "tolerance", "max_iterations", "force_floor", "linear"];
    let Some(table) = root.optional("solver", |item| item.table(&keys))? else {
        return Ok(Accuracy::default().solver());
    };
    let accuracy = table.optional("accuracy", |item| item.choice(&Accuracy::ALL));
    let pace = |item: &Item| {
        let help = "increments are so many times as long: 4 is coarse, 0.5 fine";
        item.number_that_is("at least 0.001 and at most 1000", |value| (1e-3..=1e3).contains(&value), help)
    };
    let tolerance = |item: &Item| {
        let help = "it is the largest residual over the largest force";
        item.number_that_is("above 0 and below 0.01", |value| value > 0.0 && value < 1e-2, help)
    };
    let (pace, tolerance) = (table.optional("pace", pace), table.optional("tolerance", tolerance));
    let most = table.optional("max_iterations", Item::count);
    let floor = table.optional("force_floor", |item| Ok(item.located(item.positive()?)));
    let kinds = [
        ("auto", Linear::Auto),
        ("direct", Linear::Direct),
        ("reuse", Linear::Reuse),
        ("iterative", Linear::Iterative),
    ];
    let linear = table.optional("linear", |item| item.choice(&kinds));
    let mut faults = Faults::default();
    faults.note(&accuracy);
    faults.note(&pace);
    faults.note(&tolerance);
    faults.note(&most);
    faults.note(&floor);
    faults.note(&linear);
    faults.finish()?;
    let solver = accuracy?.unwrap_or_default().solver();
    Ok(Solver {
        pace: pace?.unwrap_or(solver.pace),
        tolerance: tolerance?.unwrap_or(solver.tolerance),
        max_iterations: most?.unwrap_or(solver.max_iterations),
        force_floor: floor?,
        linear: linear?.unwrap_or_default(),
        ..solver
    })
}

impl Solver {
    /// What the preset has set, for the log: all that the scene does not give by itself.
    pub fn describe(&self) -> String {
        format!("accuracy `{}`: pace {}, tolerance {:e}", self.accuracy.key(), self.pace, self.tolerance)
    }
}

impl Step {
    /// With increments, and what one may change, `pace` times as large. Even increments stay even, at most that large; none
    /// is longer than the step, and cuts go as far as before.
    pub(super) fn at_pace(mut self, pace: f64) -> Self {
        if pace == 1.0 {
            return self;
        }
        let Increment { initial, min, max, limits } = self.increment;
        let count = self.duration / max;
        let is_even = initial == max && (count - count.round()).abs() < 1e-9 * count;
        let max = if is_even { self.duration / (count / pace - 1e-9).ceil() } else { (pace * max).min(self.duration) };
        let limits = Limits {
            strain: limits.strain.map(|strain| pace * strain),
            contacts: limits.contacts.map(|share| (pace * share).min(1.0)),
        };
        let initial = if is_even { max } else { (pace * initial).min(max) };
        self.increment = Increment { initial, min: min.min(pace * min), max, limits };
        self
    }
}
