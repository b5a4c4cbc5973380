//! The run of a scene as the command line has it: its steps one after the other, with log, history, fields and summary.

use super::body_fields::Known;
use super::cost::machine::Machine;
use super::cost::predict::Prediction;
use super::cost::size::{Increments, Size};
use super::estimates::Estimates;
use super::keep::{Keeper, Record};
use super::paths::{self, End};
use super::results::{self, Results};
use super::{Event, Increment, Rounded, Simulation, describe};
use crate::error::{Error, Result};
use crate::estimate::energy::Energy;
use crate::estimate::recovery::Recovered;
use crate::failure::Cause;
use crate::interrupt;
use crate::output::log::{self, Log};
use crate::output::phases::{Phase, Phases};
use crate::output::summary::{Summary, peak_memory_mb};
use crate::output::{self, OutputFolder};
use crate::parallel::{Sent, agree, sent, sum};
use crate::report;
use crate::scene::{Scene, Step};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{LinearStatistics, Petsc};
use std::path::Path;
use std::time::{Duration, Instant};

/// What the command line says about a run.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    pub out: &'a Path,
    /// Run only so many steps.
    pub steps: Option<usize>,
    /// Estimate the error of the increments by a second run.
    pub estimate: bool,
    /// Go on from the checkpoint in the folder.
    pub restart: bool,
    pub quiet: bool,
    /// Write a report at the end, too, however it comes.
    pub report: bool,
    /// The scene file, which must not be overwritten.
    pub source: &'a Path,
}

/// Runs a scene and writes its results. Collective; errors are the same on all ranks.
///
/// # Errors
/// Wrong input; no convergence, a failing library, a signal: the results until then are kept.
pub fn run(comm: &SimpleCommunicator, petsc: &Petsc, scene: &Scene, options: &Options) -> Result<()> {
    let begun = Instant::now();
    // A signal while the model is set up ends the run in its first increment, in order.
    agree(comm, interrupt::heed())?;
    let mut simulation = Simulation::new(comm, petsc, scene)?;
    let size = Size::new(comm, scene, simulation.model(), begun.elapsed().as_secs_f64());
    let folder = open(comm, options)?;
    simulation.keep_factors_in(folder.path());
    let mut recorder = Recorder::new(&folder, &mut simulation, (scene, options), size)?;
    let outcome = recorder.steps(&mut simulation);
    let mut summary = Summary { carried: simulation.carried(), ..simulation.summary() };
    summary.converged = outcome.is_ok();
    summary.estimates.clone_from(&recorder.estimates.steps);
    summary.interrupted = matches!(outcome, Err(Error::Interrupted(_)));
    summary.wall_s = begun.elapsed().as_secs_f64();
    let prediction = recorder.seer.as_ref().and_then(|seer| seer.prediction);
    summary.predicted = prediction.map(|prediction| prediction.foretold());
    measure_solver(petsc, &summary.linear, simulation.phases());
    let (own, (messages, bytes)) = (sent(), petsc.sent());
    let sent = Sent { messages: own.messages + messages, bytes: own.bytes + bytes };
    let mut written = summary.write(&folder, comm, simulation.phases(), sent);
    recorder.log.finish();
    let mut outcome = outcome;
    if options.estimate && outcome.is_ok() && paths::matter(&simulation) {
        outcome = recorder.compare(&mut simulation, petsc);
        summary.estimates.clone_from(&recorder.estimates.steps);
        summary.warnings = simulation.summary().warnings;
        written = written.and(summary.write(&folder, comm, simulation.phases(), sent));
    }
    let log = &mut recorder.log;
    if let Some(words) = recorder.estimates.words() {
        log.line(&words);
    }
    log.line(&describe::farewell(&summary, options.out));
    let mut megabytes = [peak_memory_mb()];
    sum(comm, &mut megabytes);
    if let Some(prediction) = prediction.filter(|_| outcome.is_ok()) {
        log.line(&prediction.told(summary.wall_s, megabytes[0]));
    }
    // The terminal hears of it from the command line.
    if let Err(error) = &outcome {
        log.record(&format!("error: {error}"));
    }
    if options.report {
        written = written.and(write_report(comm, &folder, log));
    }
    outcome.and(written)
}

/// The folder that the run writes into. Collective.
fn open(comm: &SimpleCommunicator, options: &Options) -> Result<OutputFolder> {
    if options.restart {
        return OutputFolder::reopen(options.out, comm);
    }
    let replaced = output::results_in(options.out);
    let replaced: Vec<&str> = replaced.iter().map(String::as_str).collect();
    OutputFolder::create(options.out, &replaced, &[("scene file", options.source)], comm)
}

/// What the log says of a run that begins, or goes on. Collective.
fn announce(log: &mut Log, simulation: &Simulation, machine: (&Machine, Option<String>), goes_on: bool) {
    let (comm, scene, model) = (simulation.comm(), simulation.scene(), simulation.model());
    if goes_on {
        let super::State { increments, time, .. } = simulation.state();
        log.line(&format!("goes on from the checkpoint after increment {increments}, time {time:.6}"));
    }
    log.line(&describe::heading(comm, scene, model));
    let (bodies, contacts) = (describe::bodies(scene, model), describe::contacts(comm, model));
    bodies.lines().chain(contacts.lines()).for_each(|line| log.record(line));
    model.masters.tools.iter().for_each(|tool| log.line(&describe::tool(tool)));
    model.masters.surfaces.iter().for_each(|surface| log.line(&describe::master(surface)));
    simulation.gaps().iter().for_each(|line| log.line(line));
    log.line(&scene.solver.describe());
    log.record(&scene.controls.describe());
    model.warnings.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    let (machine, damage) = machine;
    log.record(&machine.origin());
    damage.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
}

/// Writes the page of a run that has ended. Collective.
fn write_report(comm: &SimpleCommunicator, folder: &OutputFolder, log: &mut Log) -> Result<()> {
    let page = if comm.rank() == 0 { report::page(&[folder.path()]) } else { Ok(String::new()) };
    folder.write(comm, report::NAME, &agree(comm, page)?)?;
    log.line(&format!("report:      {}", folder.file(report::NAME).display()));
    Ok(())
}

/// Takes the times of the linear solver from PETSc's log, and what it has measured itself.
fn measure_solver(petsc: &Petsc, linear: &LinearStatistics, phases: &Phases) {
    let seconds = |events: &[&str]| {
        let total: f64 = events.iter().map(|e| petsc.log_seconds(e).unwrap_or(0.0)).sum();
        Duration::from_secs_f64(total)
    };
    let factor = seconds(&["MatLUFactorSym", "MatLUFactorNum", "MatCholFctrSym", "MatCholFctrNum"]);
    let [set_up, iterate] = [linear.set_up_s, linear.iterate_s].map(Duration::from_secs_f64);
    phases.add_calls(Phase::Factor, factor + set_up, linear.factorizations);
    phases.add_calls(Phase::Solve, seconds(&["MatSolve"]) + iterate, linear.solves);
}

/// Writes what a simulation does.
struct Recorder<'s> {
    folder: &'s OutputFolder,
    log: Log,
    results: Results,
    /// Increments from one writing of the fields to the next, and since the last.
    every: usize,
    since_written: usize,
    estimates: Estimates,
    /// The ends of steps.
    ends: Vec<End>,
    steps: &'s [Step],
    seer: Option<Seer<'s>>,
    keeper: Keeper<'s>,
}

/// Foretells what the run will take, once it has its first systems.
struct Seer<'s> {
    machine: Machine,
    size: Size,
    steps: &'s [Step],
    prediction: Option<Prediction>,
    /// It knows what factors are.
    knows_factors: bool,
}

impl Seer<'_> {
    /// Foretells by the systems of the step that is under way, as if all steps had these.
    fn look(&mut self, simulation: &Simulation) -> Result<()> {
        let Some(systems) = simulation.systems()? else { return Ok(()) };
        let steps: Vec<_> = self.steps.iter().map(|step| (Increments::of(step), systems)).collect();
        self.prediction = Some(Prediction::new(&self.machine, &self.size, &steps));
        self.knows_factors = systems.factors.is_some();
        Ok(())
    }

    /// Once the first factorization has told what factors are.
    fn look_again(&mut self, simulation: &Simulation) -> Result<()> {
        if self.knows_factors { Ok(()) } else { self.look(simulation) }
    }
}

impl<'s> Recorder<'s> {
    /// Opens the files, after the last checkpoint where the run goes on, and says what is modelled. Collective.
    fn new(
        folder: &'s OutputFolder,
        simulation: &mut Simulation,
        (scene, options): (&'s Scene, &Options),
        size: Size,
    ) -> Result<Self> {
        let (machine, damage) = Machine::find(simulation.comm());
        let mut keeper = Keeper::new(folder, simulation)?;
        let mut estimates = Estimates::default();
        let record = options.restart.then(|| keeper.go_back(simulation, &mut estimates)).transpose()?;
        let steps = &scene.steps[..options.steps.unwrap_or(usize::MAX).min(scene.steps.len())];
        if simulation.begun > steps.len() {
            let (step, asked) = (&scene.steps[simulation.begun - 1].name.value, steps.len());
            let what = format!(
                "the checkpoint is in step `{step}`, number {}, and --steps {asked} ends before",
                simulation.begun
            );
            return Err(Error::input_anywhere(what, "give more steps, or run without --restart"));
        }
        simulation.end_after(steps.len());
        let (comm, model) = (simulation.comm(), simulation.model());
        let results = simulation.phases().time(Phase::Output, || match &record {
            Some((record, probes)) => {
                // The state at time 0 is written by a run without increments, this one if it has none.
                let written = (simulation.state().increments > 0).then_some(record.written);
                Results::go_on(comm, folder, scene, model, (record.history, written, probes))
            }
            None => Results::create(comm, folder, scene, model),
        })?;
        let mut log = match &record {
            Some((record, _)) => Log::go_on(folder, comm, options.quiet, record.log)?,
            None => Log::create(folder, comm, options.quiet)?,
        };
        // Of the run that goes on.
        folder.discard(comm, &["summary.json", report::NAME, "failed.xdmf", "failed.h5"])?;
        folder.write(comm, "scene.toml", &scene.text)?;
        announce(&mut log, simulation, (&machine, damage), record.is_some());
        if record.is_some() && !results.goes_on() {
            let warning = "the fields that the run had written are gone, and begin anew".to_string();
            log.line(&format!("  warning: {warning}"));
            simulation.warned(warning);
        }
        // What is left of a run is not foretold.
        let seer = record.is_none().then_some(Seer { machine, size, steps, prediction: None, knows_factors: false });
        Ok(Self {
            folder,
            log,
            results,
            every: scene.output.every,
            since_written: record.map_or(0, |(record, _)| record.since_written),
            estimates,
            ends: Vec::new(),
            steps,
            seer,
            keeper,
        })
    }
}

impl Recorder<'_> {
    /// Runs the steps. Collective.
    fn steps(&mut self, simulation: &mut Simulation) -> Result<()> {
        let steps = self.steps;
        self.log.start(steps.iter().map(|s| s.duration).sum());
        if simulation.state().increments == 0 {
            let begun = Instant::now();
            self.write_alone(simulation)?;
            simulation.phases().add(Phase::Output, begun.elapsed());
        }
        // The last of these is under way, or at its end.
        let begun = simulation.begun;
        for (k, step) in steps.iter().enumerate().skip(begun.saturating_sub(1)) {
            let outcome = if k < begun { Ok(()) } else { simulation.begin(step) };
            let outcome = outcome.and_then(|()| self.step(simulation));
            match outcome {
                Err(Error::Interrupted(_)) => self.keep_last(simulation),
                Err(Error::Diverged(_)) => self.tell_failed(simulation),
                _ => {}
            }
            if outcome.is_err() && self.since_written > 0 {
                // The first error counts.
                let _ = self.write_alone(simulation);
            }
            let begun = Instant::now();
            let indexed = self.results.index(simulation.comm());
            simulation.phases().add(Phase::Output, begun.elapsed());
            outcome.and(indexed)?;
        }
        self.warn(simulation, simulation.last_warnings());
        match simulation.pushed_aside() {
            Some(word) => Err(Error::diverged(Cause::Watch, word)),
            None => Ok(()),
        }
    }

    /// Says what is not as it should be.
    fn warn(&mut self, simulation: &mut Simulation, warnings: Vec<String>) {
        for warning in warnings {
            self.log.line(&format!("  warning: {warning}"));
            simulation.warned(warning);
        }
    }

    /// Goes to the end of the step that is under way. Collective.
    fn step(&mut self, simulation: &mut Simulation) -> Result<()> {
        if let Some(seer) = self.seer.as_mut().filter(|seer| seer.prediction.is_none()) {
            seer.look(simulation)?;
        }
        while let Some(increment) = simulation.advance(&mut |event| self.hear(event))? {
            let begun = Instant::now();
            self.seer.as_mut().map_or(Ok(()), |seer| seer.look_again(simulation))?;
            self.since_written += 1;
            let written = self.since_written >= self.every || increment.ends_step;
            let recovered = self.recover(simulation, written, increment.ends_step)?;
            let known = Known { energy: None, recovered: recovered.as_ref() };
            self.results.add_row(simulation, &increment, known)?;
            self.estimates.learn(simulation);
            let energy = match &recovered {
                Some(recovered) if increment.ends_step => {
                    Some(self.estimate(simulation, &increment.step, recovered)?)
                }
                _ => None,
            };
            if written {
                self.write_fields(simulation, Known { energy: energy.as_ref(), ..known })?;
            }
            self.tell(&increment);
            let is_last = increment.ends_step && simulation.begun == self.steps.len();
            if self.keeper.is_due(simulation, is_last) {
                self.keep(simulation)?;
            }
            simulation.phases().add(Phase::Output, begun.elapsed());
        }
        Ok(())
    }

    /// Writes a checkpoint. Collective.
    fn keep(&mut self, simulation: &mut Simulation) -> Result<()> {
        let (history, written, probes) = self.results.lengths();
        let record = Record {
            history,
            written,
            log: self.log.length(),
            since_written: self.since_written,
            stiffness: self.estimates.stiffness(),
            ..Record::default()
        };
        self.keeper.keep(simulation, (record, probes), &self.results.files(), &self.estimates.steps)
    }

    /// The same of a run that a signal ends: the fields that are written then are not those of an increment that goes on.
    /// Collective.
    fn keep_last(&mut self, simulation: &mut Simulation) {
        match self.keep(simulation) {
            Ok(()) => self.log.line("checkpoint written: the same command with --restart goes on from it"),
            Err(error) => self.log.line(&format!("  warning: no checkpoint: {error}")),
        }
    }

    /// Shows where the increment stood that was not found. Collective.
    fn tell_failed(&mut self, simulation: &Simulation) {
        match results::write_failed(self.folder, simulation) {
            Ok(false) => {}
            Ok(true) => {
                let file = self.folder.file("failed.xdmf");
                self.log.line(&format!("no result, but where it stood, with its residual: {}", file.display()));
            }
            Err(error) => self.log.line(&format!("  warning: {error}")),
        }
    }

    /// Estimates the error of the increments. Collective.
    fn compare(&mut self, simulation: &mut Simulation, petsc: &Petsc) -> Result<()> {
        match paths::compare(simulation.comm(), petsc, simulation.scene(), &self.ends) {
            Ok(found) => self.estimates.add("increments", found),
            Err(error) => {
                let warning = paths::failed(error)?;
                self.warn(simulation, vec![warning]);
            }
        }
        Ok(())
    }

    /// Estimates the end of a step, and gives the error in energy. Collective.
    fn estimate(&mut self, simulation: &Simulation, step: &str, recovered: &Recovered) -> Result<Energy> {
        let energy = Energy::new(simulation.comm(), simulation.model(), &simulation.state().u, recovered)?;
        self.estimates.end_step(simulation, step, &energy);
        self.ends.push(End::of(simulation, step));
        Ok(energy)
    }

    /// What is recovered of the state: for the estimate, or where fields or probes ask for it. Collective.
    fn recover(&self, simulation: &Simulation, written: bool, estimated: bool) -> Result<Option<Recovered>> {
        if !estimated && !self.results.need_recovery(written) {
            return Ok(None);
        }
        Recovered::new(simulation.comm(), simulation.model(), &simulation.state().u).map(Some)
    }

    /// Writes the fields of the state with nothing else known of it. Collective.
    fn write_alone(&mut self, simulation: &mut Simulation) -> Result<()> {
        let recovered = self.recover(simulation, true, false)?;
        self.write_fields(simulation, Known { energy: None, recovered: recovered.as_ref() })
    }

    /// Collective.
    fn write_fields(&mut self, simulation: &mut Simulation, known: Known) -> Result<()> {
        self.since_written = 0;
        if self.results.has_stresses() {
            simulation.count_stresses();
        }
        self.results.write_fields(simulation.comm(), simulation.model(), simulation.state(), known)
    }

    fn hear(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Iteration(iteration) => self.log.iteration(iteration),
            Event::Jumping { number, drag } => self.log.jump(*number, *drag),
            Event::Retried(retried) => self.log.line(&describe::retried(retried)),
            Event::Jumped { step, steps } => {
                self.log.line(&format!("  {step}: no equilibrium near; went on to another in {steps} steps"));
            }
            Event::Warning(warning) => self.log.line(&format!("  warning: {warning}")),
            Event::Detail(detail) => self.log.record(detail),
            Event::Increment(_) => {}
        }
        Ok(())
    }

    fn tell(&mut self, increment: &Increment) {
        let Increment { step, number, time, size, iterations, .. } = increment;
        let note = describe::note(increment);
        self.log.increment(&log::Increment {
            step,
            number: *number,
            time: *time,
            size: *size,
            iterations: *iterations,
            note: &note,
        });
        if let Some(Rounded { of, residual, limit, .. }) = &increment.rounded {
            let text =
                format!("    {of}: residual {residual:.1e} let through, of which rounding leaves up to {limit:.1e}");
            self.log.record(&text);
        }
        if let Some(name) = &increment.nodes.calmed_node {
            self.log.record(&format!("    friction penalty reduced at flipping nodes, such as {name}"));
        }
    }
}
