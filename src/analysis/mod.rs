//! The analysis: steps, increments, one nonlinear solve each, and what is kept of them.
//!
//! - `conditions`: what a step prescribes
//! - `step`: one step: its equations, its increments, what becomes of each
//! - `newton`: one increment as a nonlinear problem for SNES, and its contact part
//! - `increments`: how long the next increment is
//! - `ladder`, `jump`: what is tried when it does not converge
//! - `hold`: what holds bodies and tools
//! - [`preflight`]: what is checked before the first increment
//! - `watch`: whether an increment that has converged may be accepted
//! - `results`: the history and the fields of what has converged
//! - `ending`: what ends a run at once
//! - `conditioning`: what makes a matrix ill-conditioned
//! - `runaway`: tools that nothing can hold
//! - [`describe`]: what is said
//!
//! The state of the last converged increment is replaced only when the next has converged. A failed increment is tried
//! again from it, shorter, until it would be shorter than the scene's minimum.

mod conditioning;
mod conditions;
pub mod describe;
mod ending;
mod hold;
mod increments;
mod jump;
mod ladder;
mod newton;
pub mod preflight;
mod results;
mod runaway;
mod step;
mod watch;

use crate::contact::{Master, Status, follow_all, watch_all};
use crate::error::{Error, Result};
use crate::interrupt;
use crate::model::Model;
use crate::output::log::Log;
use crate::output::phases::{Phase, Phases};
use crate::output::summary::Summary;
use crate::output::{self, OutputFolder};
use crate::parallel::agree;
use crate::scene::{Enforcement, Scene};
use crate::system::DofMap;
use crate::{Mat3, Vec3};
use conditions::Conditions;
use mpi::topology::SimpleCommunicator;
use newton::balance::Balance;
use petsc::Petsc;
use results::Results;
use std::path::Path;
use std::time::Instant;
use watch::Touch;

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

/// The state at the last converged increment, besides the histories that slave nodes and tools keep.
#[derive(Clone, Debug)]
struct State {
    /// Displacements of all local nodes.
    u: Vec<Vec3>,
    /// Time since the beginning.
    time: f64,
    /// Contact force on each tool.
    tool_forces: Vec<Vec3>,
    /// Largest force of each body, contact and tool so far, as [`newton::balance::Balance`] has them.
    seen: Vec<f64>,
    /// Forces that count while there are none.
    floors: Vec<f64>,
    conditions: Conditions,
}

/// An analysis in progress.
struct Analysis<'a> {
    comm: &'a SimpleCommunicator,
    petsc: &'a Petsc<'a>,
    scene: &'a Scene,
    model: Model,
    state: State,
    results: Results,
    /// What each pair did until now.
    touches: Vec<Touch>,
    log: Log,
    phases: &'a Phases,
    summary: Summary,
}

/// Runs a scene and writes its results. Collective; errors are the same on all ranks.
///
/// # Errors
/// Wrong input; no convergence, a failing library, a signal: the results until then are kept.
pub fn run(comm: &SimpleCommunicator, petsc: &Petsc, scene: &Scene, options: &Options) -> Result<()> {
    let begun = Instant::now();
    let phases = Phases::default();
    let mut model = Model::new(comm, scene, &phases)?;
    let begins = preflight::check(comm, scene, &mut model)?;
    agree(comm, interrupt::heed())?;
    let folder = OutputFolder::create(options.out, &output::RUN, &[("scene file", options.source)], comm)?;
    folder.write(comm, "scene.toml", &scene.text)?;
    let mut log = Log::create(&folder, comm, options.quiet)?;
    log.line(&describe::heading(comm, scene, &model));
    model.tools.iter().for_each(|tool| log.line(&describe::tool(tool)));
    model.surfaces.iter().for_each(|surface| log.line(&describe::master(surface)));
    begins.iter().for_each(|line| log.line(line));
    log.record(&scene.controls.describe());
    model.warnings.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    let results = phases.time(Phase::Output, || Results::create(comm, &folder, scene, &model))?;
    let floors = Balance::floors(comm, &model, scene.solver.force_floor);
    let state = State {
        u: vec![Vec3::zeros(); model.part.points.len()],
        tool_forces: vec![Vec3::zeros(); model.tools.len()],
        time: 0.0,
        seen: vec![0.0; floors.len()],
        floors,
        conditions: Conditions::none(&model),
    };
    let summary = Summary {
        scene: scene.name.clone(),
        elements: model.part.total_solids,
        warnings: model.warnings.clone(),
        controls: scene.controls.changed().map(|(name, value, _)| (name, value)).collect(),
        ..Summary::default()
    };
    let touches = Vec::new();
    let mut analysis = Analysis { comm, petsc, scene, model, state, results, touches, log, phases: &phases, summary };
    let outcome = analysis.steps(options.steps.unwrap_or(usize::MAX));
    analysis.summary.converged = outcome.is_ok();
    analysis.summary.interrupted = matches!(outcome, Err(Error::Interrupted(_)));
    analysis.summary.search_fetches = analysis.model.surfaces.iter().map(|s| s.fetches).sum();
    analysis.summary.wall_s = begun.elapsed().as_secs_f64();
    analysis.measure_solver();
    let written = analysis.summary.write(&folder, comm, &phases);
    analysis.log.finish();
    analysis.log.line(&describe::farewell(&analysis.summary, options.out));
    // The terminal hears of it from the command line.
    if let Err(error) = &outcome {
        analysis.log.record(&format!("error: {error}"));
    }
    outcome.and(written)
}

/// Lets the deformable masters follow displacements `u`, and learn the equations and conditions of their nodes. Collective.
fn survey(comm: &SimpleCommunicator, model: &mut Model, conditions: &Conditions, dofs: &DofMap, u: &[Vec3]) {
    let Model { part, surfaces, pairs, .. } = model;
    let place = |n: u32| part.points[n as usize] + u[n as usize];
    follow_all(comm, surfaces, pairs, place);
    for surface in surfaces {
        surface.learn(comm, place, &dofs.node, |n, d| conditions.move_of(n, d));
    }
}

impl Analysis<'_> {
    fn steps(&mut self, count: usize) -> Result<()> {
        self.log.start(self.scene.steps.iter().take(count).map(|s| s.duration).sum());
        self.look_around();
        self.begin_watch();
        for step in self.scene.steps.iter().take(count) {
            self.step(step)?;
        }
        self.warn_of_contacts();
        Ok(())
    }

    /// Projects every slave node where it stands: the first slip origins. Collective.
    fn look_around(&mut self) {
        let Model { part, tools, surfaces, pairs, .. } = &mut self.model;
        let place = |n: u32| part.points[n as usize];
        watch_all(self.comm, tools, pairs, place);
        follow_all(self.comm, surfaces, pairs, place);
        for pair in pairs {
            for s in 0..pair.slaves.len() {
                let position = place(pair.slaves[s].node);
                let projection = match pair.master {
                    Master::Tool(t) => tools[t].project(&position, pair.reach, None),
                    Master::Surface(k) => pair.project(&surfaces[k], s, &position, None),
                };
                let slave = &mut pair.slaves[s];
                slave.trial.projection = projection;
                // An active set begins with what touches; nothing else may hold a body.
                let touches = projection.is_some_and(|p| p.gap <= pair.controls.no_gap * pair.facet_size);
                if touches && pair.method == Enforcement::Lagrange {
                    slave.trial.status = Status::Stick;
                }
                match pair.master {
                    Master::Tool(t) => slave.commit(pair.method, Vec3::zeros(), &tools[t].committed, &position),
                    Master::Surface(_) => {
                        slave.commit_on_surface(pair.method, Vec3::zeros(), &Mat3::identity(), &position);
                    }
                }
            }
        }
    }

    /// Takes the times of the linear solver from PETSc's log.
    fn measure_solver(&mut self) {
        let seconds = |events: &[&str]| {
            let total: f64 = events.iter().map(|e| self.petsc.log_seconds(e).unwrap_or(0.0)).sum();
            std::time::Duration::from_secs_f64(total)
        };
        let factor = ["MatLUFactorSym", "MatLUFactorNum", "MatCholFctrSym", "MatCholFctrNum"];
        self.phases.add(Phase::Factor, seconds(&factor));
        self.phases.add(Phase::Solve, seconds(&["MatSolve"]));
    }
}
