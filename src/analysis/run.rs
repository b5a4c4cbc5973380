//! The run of a scene as the command line has it: its steps one after the other, with log, history, fields and summary.

use super::body_fields::Known;
use super::cost::machine::Machine;
use super::cost::predict::Prediction;
use super::cost::size::{Increments, Size};
use super::estimates::Estimates;
use super::paths::{self, End};
use super::results::Results;
use super::{Event, Increment, Iteration, Simulation, describe};
use crate::error::{Error, Result};
use crate::estimate::energy::Energy;
use crate::estimate::recovery::Recovered;
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
    let mut simulation = Simulation::new(comm, petsc, scene)?;
    agree(comm, interrupt::heed())?;
    let size = Size::new(comm, scene, simulation.model(), begun.elapsed().as_secs_f64());
    let (machine, damage) = Machine::find(comm);
    let replaced = output::results_in(options.out);
    let replaced: Vec<&str> = replaced.iter().map(String::as_str).collect();
    let folder = OutputFolder::create(options.out, &replaced, &[("scene file", options.source)], comm)?;
    folder.write(comm, "scene.toml", &scene.text)?;
    let mut log = Log::create(&folder, comm, options.quiet)?;
    let model = simulation.model();
    log.line(&describe::heading(comm, scene, model));
    let (bodies, contacts) = (describe::bodies(scene, model), describe::contacts(comm, model));
    bodies.lines().chain(contacts.lines()).for_each(|line| log.record(line));
    model.masters.tools.iter().for_each(|tool| log.line(&describe::tool(tool)));
    model.masters.surfaces.iter().for_each(|surface| log.line(&describe::master(surface)));
    simulation.gaps().iter().for_each(|line| log.line(line));
    log.line(&scene.solver.describe());
    log.record(&scene.controls.describe());
    model.warnings.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    log.record(&machine.origin());
    damage.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    let results = simulation.phases().time(Phase::Output, || Results::create(comm, &folder, scene, model))?;
    let count = options.steps.unwrap_or(usize::MAX).min(scene.steps.len());
    let seer = Seer { machine, size, steps: &scene.steps[..count], prediction: None, knows_factors: false };
    let mut recorder = Recorder {
        log,
        results,
        every: scene.output.every,
        since_written: 0,
        estimates: Estimates::default(),
        ends: Vec::new(),
        seer,
    };
    let outcome = recorder.steps(&mut simulation);
    let mut summary = Summary { carried: simulation.carried(), ..simulation.summary() };
    summary.converged = outcome.is_ok();
    summary.estimates.clone_from(&recorder.estimates.steps);
    summary.interrupted = matches!(outcome, Err(Error::Interrupted(_)));
    summary.wall_s = begun.elapsed().as_secs_f64();
    let prediction = recorder.seer.prediction;
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
    log: Log,
    results: Results,
    /// Increments from one writing of the fields to the next, and since the last.
    every: usize,
    since_written: usize,
    estimates: Estimates,
    /// The ends of steps.
    ends: Vec<End>,
    seer: Seer<'s>,
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

impl Recorder<'_> {
    /// Runs the steps. Collective.
    fn steps(&mut self, simulation: &mut Simulation) -> Result<()> {
        let steps = self.seer.steps;
        self.log.start(steps.iter().map(|s| s.duration).sum());
        if simulation.state().increments == 0 {
            let begun = Instant::now();
            self.write_alone(simulation)?;
            simulation.phases().add(Phase::Output, begun.elapsed());
        }
        for step in steps {
            let outcome = self.step(simulation, step);
            if outcome.is_err() && self.since_written > 0 {
                // The first error counts.
                let _ = self.write_alone(simulation);
            }
            let begun = Instant::now();
            let indexed = self.results.index(simulation.comm());
            simulation.phases().add(Phase::Output, begun.elapsed());
            outcome.and(indexed)?;
        }
        for warning in simulation.idle_contacts() {
            self.log.line(&format!("  warning: {warning}"));
            simulation.warned(warning);
        }
        Ok(())
    }

    fn step(&mut self, simulation: &mut Simulation, step: &Step) -> Result<()> {
        simulation.begin(step)?;
        if self.seer.prediction.is_none() {
            self.seer.look(simulation)?;
        }
        while let Some(increment) = simulation.advance(&mut |event| self.hear(event))? {
            let begun = Instant::now();
            self.seer.look_again(simulation)?;
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
            simulation.phases().add(Phase::Output, begun.elapsed());
            self.tell(&increment);
        }
        Ok(())
    }

    /// Estimates the error of the increments. Collective.
    fn compare(&mut self, simulation: &mut Simulation, petsc: &Petsc) -> Result<()> {
        match paths::compare(simulation.comm(), petsc, simulation.scene(), &self.ends) {
            Ok(found) => self.estimates.add("increments", found),
            Err(error) => {
                let warning = paths::failed(error)?;
                self.log.line(&format!("  warning: {warning}"));
                simulation.warned(warning);
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
            &Event::Iteration(Iteration { step, increment, number, residual, changes, touching }) => {
                self.log.iteration(&log::Iterate { step, increment, number, residual, changes, touching });
            }
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
        if let Some(name) = &increment.calmed_node {
            self.log.record(&format!("    friction penalty reduced at flipping nodes, such as {name}"));
        }
    }
}
