//! The analysis: steps, increments, one nonlinear solve each, and what is kept of them.
//!
//! - `conditions`: what a step prescribes
//! - `step`: one step: its equations, its increments, what becomes of each
//! - `newton`: one increment as a nonlinear problem for SNES, and its contact part
//! - `increments`: how long the next increment is
//! - `results`: the history and the fields of what has converged
//! - [`describe`]: what is said
//!
//! The state of the last converged increment is replaced only when the next has converged. A failed increment is tried
//! again from it, shorter, until it would be shorter than the scene's minimum.

mod conditions;
pub mod describe;
mod increments;
mod jump;
mod newton;
mod results;
mod step;

use crate::contact::{Master, Status, follow_all, watch_all};
use crate::error::Result;
use crate::model::Model;
use crate::output::log::Log;
use crate::output::phases::{Phase, Phases};
use crate::output::summary::Summary;
use crate::output::{self, OutputFolder};
use crate::parallel::{agree, max, sum};
use crate::scene::{Enforcement, Scene};
use crate::system::DofMap;
use crate::{Mat3, Vec3};
use conditions::Conditions;
use mpi::topology::SimpleCommunicator;
use petsc::Petsc;
use results::Results;
use std::path::Path;
use std::time::Instant;

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
    /// Largest force so far.
    scale: f64,
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
    log: Log,
    phases: &'a Phases,
    summary: Summary,
}

/// Runs a scene and writes its results. Collective; errors are the same on all ranks.
///
/// # Errors
/// Wrong input, or no convergence: the results until then are kept.
pub fn run(comm: &SimpleCommunicator, petsc: &Petsc, scene: &Scene, options: &Options) -> Result<()> {
    let begun = Instant::now();
    let phases = Phases::default();
    let model = Model::new(comm, scene, &phases)?;
    check_conditions(comm, scene, &model)?;
    let folder = OutputFolder::create(options.out, &output::RUN, comm)?;
    folder.write_scene(comm, options.source, &scene.text)?;
    let mut log = Log::create(&folder, comm, options.quiet)?;
    log.line(&describe::heading(comm, scene, &model));
    model.tools.iter().for_each(|tool| log.line(&describe::tool(tool)));
    model.surfaces.iter().for_each(|surface| log.line(&describe::master(surface)));
    model.warnings.iter().for_each(|warning| log.line(&format!("  warning: {warning}")));
    let results = phases.time(Phase::Output, || Results::create(comm, &folder, scene, &model))?;
    let state = State {
        u: vec![Vec3::zeros(); model.part.points.len()],
        tool_forces: vec![Vec3::zeros(); model.tools.len()],
        time: 0.0,
        scale: scene.solver.force_floor.unwrap_or(FORCE_FLOOR * model.stiffness * model.size),
        conditions: Conditions::none(&model),
    };
    let summary = Summary { scene: scene.name.clone(), elements: model.part.total_solids, ..Summary::default() };
    let mut analysis = Analysis { comm, petsc, scene, model, state, results, log, phases: &phases, summary };
    let outcome = analysis.steps(options.steps.unwrap_or(usize::MAX));
    analysis.summary.converged = outcome.is_ok();
    analysis.summary.search_fetches = analysis.model.surfaces.iter().map(|s| s.fetches).sum();
    analysis.summary.wall_s = begun.elapsed().as_secs_f64();
    analysis.measure_solver();
    analysis.summary.write(&folder, comm, &phases)?;
    analysis.log.finish();
    analysis.log.line(&describe::farewell(&analysis.summary, options.out));
    // The terminal hears of it from the command line.
    if let Err(error) = &outcome {
        analysis.log.record(&format!("error: {error}"));
    }
    outcome
}

/// Refuses steps with conditions that contradict each other before the first one runs. Collective.
fn check_conditions(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Result<()> {
    let still = vec![Vec3::zeros(); model.part.points.len()];
    let mut last = Conditions::none(model);
    for step in &scene.steps {
        last = agree(comm, Conditions::new(comm, model, step, &still, &last))?;
    }
    Ok(())
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

/// Depth of a slave node in a master, over the size of a slave facet, from which it was hardly meant to start there.
const DEEP: f64 = 0.1;

/// Gap over the size of a slave facet that is none.
const TOUCHING: f64 = 1e-9;

/// Force of the scene while nothing acts yet, over the largest nodal stiffness times the element size: far below any force
/// of interest, well above rounding.
const FORCE_FLOOR: f64 = 1e-6;

impl Analysis<'_> {
    fn steps(&mut self, count: usize) -> Result<()> {
        self.log.start(self.scene.steps.iter().take(count).map(|s| s.duration).sum());
        self.look_around();
        for step in self.scene.steps.iter().take(count) {
            self.step(step)?;
        }
        Ok(())
    }

    /// Projects every slave node where it stands: the first slip origins. Warns of those deep in a tool. Collective.
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
                let touches = projection.is_some_and(|p| p.gap <= TOUCHING * pair.facet_size);
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
            let depths = pair.slaves.iter().filter_map(|s| s.trial.projection).map(|p| -p.gap);
            let deep: Vec<f64> = depths.filter(|depth| *depth > DEEP * pair.facet_size).collect();
            let (mut count, mut deepest) = ([deep.len() as f64], [deep.into_iter().fold(0.0, f64::max)]);
            sum(self.comm, &mut count);
            max(self.comm, &mut deepest);
            if count[0] > 0.0 {
                let master = match pair.master {
                    Master::Tool(t) => format!("the tool `{}`", tools[t].name),
                    Master::Surface(k) => format!("`{}`", surfaces[k].name),
                };
                let is_tool = matches!(pair.master, Master::Tool(_));
                self.log.line(&describe::inside(&pair.name, &master, is_tool, count[0] as usize, deepest[0]));
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
