//! The run of a scene as the command line has it: its steps one after the other, with log, history, fields and summary.

use super::results::Results;
use super::{Event, Increment, Simulation, describe};
use crate::error::{Error, Result};
use crate::interrupt;
use crate::output::log::{self, Log};
use crate::output::phases::{Phase, Phases};
use crate::output::summary::Summary;
use crate::output::{self, OutputFolder};
use crate::parallel::{Sent, agree, sent};
use crate::scene::{Scene, Step};
use mpi::topology::SimpleCommunicator;
use petsc::{LinearStatistics, Petsc};
use std::path::Path;
use std::time::{Duration, Instant};

/// What the command line says about a run.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    pub out: &'a Path,
    /// Run only so many steps.
    pub steps: Option<usize>,
    pub quiet: bool,
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
    let folder = OutputFolder::create(options.out, &output::RUN, &[("scene file", options.source)], comm)?;
    folder.write(comm, "scene.toml", &scene.text)?;
    let mut log = Log::create(&folder, comm, options.quiet)?;
    let model = simulation.model();
    log.line(&describe::heading(comm, scene, model));
    model.masters.tools.iter().for_each(|tool| log.line(&describe::tool(tool)));
    model.masters.surfaces.iter().for_each(|surface| log.line(&describe::master(surface)));
    simulation.gaps().iter().for_each(|line| log.line(line));
    log.record(&scene.controls.describe());
    model.warnings.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    let results = simulation.phases().time(Phase::Output, || Results::create(comm, &folder, scene, model))?;
    let mut recorder = Recorder { log, results, every: scene.output.every, since_written: 0 };
    let outcome = recorder.steps(&mut simulation, options.steps.unwrap_or(usize::MAX));
    let mut summary = Summary { carried: simulation.carried(), ..simulation.summary() };
    summary.converged = outcome.is_ok();
    summary.interrupted = matches!(outcome, Err(Error::Interrupted(_)));
    summary.wall_s = begun.elapsed().as_secs_f64();
    measure_solver(petsc, &summary.linear, simulation.phases());
    let (own, (messages, bytes)) = (sent(), petsc.sent());
    let sent = Sent { messages: own.messages + messages, bytes: own.bytes + bytes };
    let written = summary.write(&folder, comm, simulation.phases(), sent);
    let log = &mut recorder.log;
    log.finish();
    log.line(&describe::farewell(&summary, options.out));
    // The terminal hears of it from the command line.
    if let Err(error) = &outcome {
        log.record(&format!("error: {error}"));
    }
    outcome.and(written)
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
struct Recorder {
    log: Log,
    results: Results,
    /// Increments from one writing of the fields to the next, and since the last.
    every: usize,
    since_written: usize,
}

impl Recorder {
    /// Runs so many steps. Collective.
    fn steps(&mut self, simulation: &mut Simulation, count: usize) -> Result<()> {
        let scene = simulation.scene();
        self.log.start(scene.steps.iter().take(count).map(|s| s.duration).sum());
        for step in scene.steps.iter().take(count) {
            let outcome = self.step(simulation, step);
            if outcome.is_err() && self.since_written > 0 {
                // The first error counts.
                let _ = self.write_fields(simulation);
            }
            outcome?;
        }
        for warning in simulation.idle_contacts() {
            self.log.line(&format!("  warning: {warning}"));
            simulation.warned(warning);
        }
        Ok(())
    }

    fn step(&mut self, simulation: &mut Simulation, step: &Step) -> Result<()> {
        simulation.begin(step)?;
        while let Some(increment) = simulation.advance(&mut |event| self.hear(event))? {
            let begun = Instant::now();
            self.results.add_row(simulation, &increment)?;
            self.since_written += 1;
            if self.since_written >= self.every || increment.ends_step {
                self.write_fields(simulation)?;
            }
            simulation.phases().add(Phase::Output, begun.elapsed());
            self.tell(&increment);
        }
        Ok(())
    }

    fn write_fields(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.since_written = 0;
        simulation.count_stresses();
        let state = simulation.state();
        self.results.write_fields(simulation.comm(), simulation.model(), state.time, &state.u)
    }

    fn hear(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Iteration(at) => self.log.iteration(at.step, at.increment, at.number),
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
        self.log.record(&describe::trace(&increment.residuals, &increment.changes));
        if let Some(name) = &increment.calmed_node {
            self.log.record(&format!("    friction penalty reduced at flipping nodes, such as {name}"));
        }
    }
}
