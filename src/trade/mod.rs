//! `nagata trade`: what speed costs in accuracy, measured by runs of one scene in many settings.
//!
//! - [`history`], [`fields`]: results of runs, read back and compared
//! - [`errors`]: the errors of a run, by quantity
//! - [`front`](mod@front): who is beaten by nobody
//! - [`plan`], [`settings`]: which runs are made
//! - [`child`]: a run as a process of its own; finished ones are known again
//! - [`combine`]: the best settings together
//! - [`sheet`], `table`, `figures`: errors and costs side by side
//!
//! Runs are processes, one after the other, so that none takes time from another that is measured, and started from a process
//! in which MPI is not initialized, for that would hand down its environment. docs/trade.md has the definitions of the errors.

pub mod child;
pub mod combine;
pub mod errors;
pub mod fields;
mod figures;
pub mod front;
pub mod history;
pub mod plan;
pub mod settings;
pub mod sheet;
mod table;

use crate::error::{Error, Result};
use crate::interrupt;
use crate::output::OutputFolder;
use crate::stdout::print;
use child::{Bench, Cost, Ended};
use errors::{Errors, Quantity, Reading};
use plan::{Plan, Variant, Wishes};
use sheet::{Price, Sheet};
use std::path::Path;

/// What is asked of a study.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    pub scene: &'a Path,
    pub wishes: Wishes<'a>,
    pub out: &'a Path,
    pub ranks: usize,
    /// Seconds that a run may take; by default several times what it should, and without end where nobody knows.
    pub limit: Option<f64>,
    /// Make finished runs anew.
    pub fresh: bool,
    /// Combine the best settings.
    pub combine: bool,
    /// Print the runs, and make none.
    pub list: bool,
}

/// A run that has ended.
#[derive(Clone, Debug)]
pub struct Made {
    pub variant: Variant,
    pub ended: Ended,
}

impl Made {
    /// Its cost, if it converged.
    pub fn cost(&self) -> Option<Cost> {
        self.ended.cost
    }
}

/// How many times longer than it should a run may take, and seconds more.
const LONGEST: f64 = 5.0;
const GRACE_S: f64 = 5.0;

/// Runs a scene in many settings, prints errors and costs, and writes them. Not collective: for one process without MPI.
///
/// # Errors
/// Wrong input; the scene as it is, or its reference, that fails; a signal. What is finished stays, and is not run again.
pub fn run(options: &Options) -> Result<()> {
    let (plan, scene) = Plan::new(options.scene, &options.wishes)?;
    if options.list {
        return print(&listed(&plan));
    }
    let folder = OutputFolder::of_this_process(options.out)?;
    interrupt::heed()?;
    let bench = Bench {
        folder: &folder,
        path: options.scene,
        scene: &scene,
        common: &plan.common,
        steps: plan.steps,
        ranks: options.ranks,
        fresh: options.fresh,
    };
    let mut study = Study::new(&bench, &plan, options)?;
    let total = plan.runs.len();
    for (k, number) in plan.order().into_iter().enumerate() {
        study.perform(&plan.runs[number], &format!("{} of {total}", k + 1))?;
        let is_reference = study.chain.first().is_some_and(|first| first.0 == number);
        if number == 0 || is_reference && !study.takes_next_reference()? {
            study.must_have_converged()?;
        }
        study.write()?;
    }
    if options.combine {
        for variant in combine::combinations(&study.runs, &study.errors, &study.floor.unwrap_or_default()) {
            study.perform(&variant, "combined")?;
            study.write()?;
        }
    }
    study.write()?;
    let text = table::text(&study.sheet(), &plan);
    print(&format!("{text}written to {}\n", options.out.display()))
}

/// The runs of a plan, as text.
fn listed(plan: &Plan) -> String {
    let row = |run: &Variant| {
        let cost = run.cost.map_or("?".into(), |cost| format!("{cost:.1}"));
        format!("{:<48} {cost:>5}  {}\n", run.label, run.overrides.join(" "))
    };
    let mut text = format!("{:<48} {:>5}\n", "run", "cost");
    text.extend(plan.runs.iter().map(row));
    text.extend(plan.left_out.iter().map(|label| format!("left out, --budget: {label}\n")));
    text
}

/// Runs that have been made, the scene as it is first.
struct Study<'a> {
    bench: &'a Bench<'a>,
    plan: &'a Plan,
    options: &'a Options<'a>,
    runs: Vec<Made>,
    /// Of each run that converged, once the reference has been made.
    errors: Vec<Option<Errors>>,
    reference: Option<Reading>,
    /// As in [`plan::Reference`], but for references that failed.
    chain: Vec<(usize, f64)>,
    /// How far it is off itself, once that is known.
    floor: Option<Errors>,
    /// Quantities of which something is known exactly.
    exact: Vec<Quantity>,
}

impl<'a> Study<'a> {
    fn new(bench: &'a Bench<'a>, plan: &'a Plan, options: &'a Options<'a>) -> Result<Self> {
        let exact = bench.scene.trade.exact.iter().map(|exact| errors::check_exact(exact, bench.scene));
        let exact = exact.collect::<Result<_>>()?;
        let (runs, errors) = (Vec::new(), Vec::new());
        let chain = plan.reference.chain.clone();
        Ok(Self { bench, plan, options, runs, errors, reference: None, chain, floor: None, exact })
    }

    /// Makes a run, or takes it from an earlier study.
    fn perform(&mut self, variant: &Variant, count: &str) -> Result<()> {
        let limit = self.limit(variant);
        let known = self.bench.known(variant, limit);
        let again = if known.is_some() { " (as before)" } else { "" };
        let ended = match known {
            Some(ended) => ended,
            None => {
                eprintln!("{count}: {} ...", variant.label);
                self.bench.perform(variant, limit)?
            }
        };
        match ended.cost {
            Some(cost) => eprintln!("{count}: {}: {:.2} s{again}", variant.label, cost.wall_s),
            None => eprintln!("{count}: {}: failed: {}{again}", variant.label, ended.reason),
        }
        self.runs.push(Made { variant: variant.clone(), ended });
        self.errors.push(None);
        self.compare()
    }

    /// Seconds that a run may take.
    fn limit(&self, variant: &Variant) -> Option<f64> {
        let of_scene = self.runs.first().and_then(|base| base.cost()).map(|cost| cost.wall_s);
        let most = match self.plan.reference.is_suggested && self.number_in_chain(variant).is_some() {
            true => self.options.wishes.budget,
            false => f64::INFINITY,
        };
        let long = variant.cost.zip(of_scene);
        self.options.limit.or(long.map(|(cost, wall)| (LONGEST * cost.max(1.0)).min(most) * wall + GRACE_S))
    }

    /// Takes the next of the chain for the reference, if the run just made was that, failed or took too long, and nobody asked
    /// for it.
    fn takes_next_reference(&mut self) -> Result<bool> {
        let failed = self.runs.last().is_some_and(|made| made.cost().is_none());
        let can = failed && self.plan.reference.is_suggested && self.chain.len() > 1;
        if can {
            self.chain.remove(0);
            let label = &self.plan.runs[self.chain[0].0].label;
            eprintln!(
                "`{label}` takes its place: errors that it shares with the scene, such as the mesh's, do not count"
            );
            self.compare()?;
        }
        Ok(can)
    }

    /// 0 for the reference, 1 for the next to it, ...
    fn number_in_chain(&self, variant: &Variant) -> Option<usize> {
        self.chain.iter().position(|(number, _)| self.plan.runs[*number] == *variant)
    }

    /// The run just made must have converged: without it there is nothing to compare.
    fn must_have_converged(&self) -> Result<()> {
        let Some(Made { variant, ended }) = self.runs.last().filter(|made| made.cost().is_none()) else {
            return Ok(());
        };
        let changes: Vec<String> = variant.overrides.iter().map(|text| format!("--set {text}")).collect();
        let what =
            format!("the run `{}` failed, without which there is nothing to compare: {}", variant.label, ended.reason);
        Err(match ended.code {
            Some(1) => Error::diverged(Default::default(), what),
            Some(2) => Error::input_anywhere(what, changes.join(" ")),
            _ => Error::System(what),
        })
    }

    /// Makes the errors of all runs that have none yet.
    fn compare(&mut self) -> Result<()> {
        if self.reference.is_none()
            && let Some(made) = self.runs.iter().find(|made| self.number_in_chain(&made.variant) == Some(0))
            && made.cost().is_some()
        {
            self.reference = Some(self.read(made)?);
        }
        let Some(reference) = &self.reference else { return Ok(()) };
        for k in 0..self.runs.len() {
            if self.errors[k].is_none() && self.runs[k].cost().is_some() {
                let reading = self.read(&self.runs[k])?;
                self.errors[k] = Some(reading.errors(reference, &self.bench.scene.trade.exact));
            }
        }
        self.estimate()
    }

    fn read(&self, made: &Made) -> Result<Reading> {
        Reading::new(&self.bench.results(&made.variant), self.bench.scene)
    }

    /// How far the reference is off itself: the differences along the chain, each with its part. Nothing as long as the chain
    /// is not complete, and where what is known exactly takes its place.
    fn estimate(&mut self) -> Result<()> {
        let chain = &self.chain;
        let made = |number: usize| self.runs.iter().find(|made| made.variant == self.plan.runs[number]);
        let runs: Vec<&Made> = chain.iter().filter_map(|(number, _)| made(*number)).collect();
        let complete = chain.len() > 1 && runs.len() == chain.len() && runs.iter().all(|made| made.cost().is_some());
        if !complete || self.floor.is_some() {
            return Ok(());
        }
        let readings = runs.iter().map(|made| self.read(made)).collect::<Result<Vec<_>>>()?;
        let mut floor = Errors::default();
        for (pair, (_, share)) in readings.windows(2).zip(&chain[1..]) {
            let apart = pair[1].errors(&pair[0], &[]);
            for of in Quantity::ALL.into_iter().filter(|of| !of.is_absolute() && !self.exact.contains(of)) {
                let sum = apart.get(of).map(|apart| floor.get(of).unwrap_or(0.0) + share * apart);
                floor.set(of, sum.or(floor.get(of)));
            }
        }
        self.floor = Some(floor);
        Ok(())
    }

    fn sheet(&self) -> Sheet<'_> {
        let reference = self.runs.iter().position(|made| self.number_in_chain(&made.variant) == Some(0));
        Sheet::new(&self.runs, &self.errors, reference, &self.exact, self.floor.unwrap_or_default())
    }

    /// Writes all that is known so far, once there is a reference.
    fn write(&self) -> Result<()> {
        if self.reference.is_none() {
            return Ok(());
        }
        let (sheet, folder) = (self.sheet(), self.bench.folder);
        let title = &self.bench.scene.title;
        folder.replace("trade.csv", &table::csv(&sheet))?;
        folder.replace("trade.md", &table::markdown(title, &sheet, self.plan))?;
        for (price, name) in Price::ALL.into_iter().zip(["wall.svg", "cpu.svg", "memory.svg"]) {
            folder.replace(name, &figures::fronts(title, &sheet, price)?)?;
        }
        Ok(())
    }
}
