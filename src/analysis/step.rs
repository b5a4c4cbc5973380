//! One step: its equations, its increments, and what becomes of each.

use super::conditions::Conditions;
use super::increments::Increments;
use super::newton::{Newton, Start};
use super::{Analysis, describe, results};
use crate::Vec3;
use crate::contact::{Pose, Status, watch_all};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::output::log;
use crate::output::phases::Phase;
use crate::parallel::{agree, first_word, max, sum};
use crate::scene::Step;
use crate::system::dofs::node_name;
use crate::system::{DofMap, Pattern};
use petsc::{Factorization, LinearFailure, Matrix, Reason, Snes, Vector};
use std::time::Instant;

/// What stays the same over a step.
struct Frame<'a> {
    step: &'a Step,
    conditions: Conditions,
    dofs: DofMap,
    pattern: Pattern,
    /// Poses of the tools at its start.
    poses: Vec<Pose>,
    /// Force-driven translations of the tools so far in it.
    offsets: Vec<Vec3>,
    /// Unknowns at the last converged ends of increments of this step, at most two, with their fractions of the step.
    past: Vec<(f64, Vec<f64>)>,
}

impl Frame<'_> {
    /// Remembers the unknowns of a converged increment.
    fn remember(&mut self, end: f64, x: &[f64]) {
        self.past.push((end, x.to_vec()));
        if self.past.len() > 2 {
            self.past.remove(0);
        }
    }

    /// The unknowns at `end` if they go on as in the last increment; `None` while there is no last two.
    fn extrapolated(&self, end: f64) -> Option<Vec<f64>> {
        let [(before, old), (last, new)] = &self.past[..] else { return None };
        let ratio = (end - last) / (last - before);
        Some(old.iter().zip(new).map(|(a, b)| b + (b - a) * ratio).collect())
    }
}

/// A converged increment, before it is accepted.
struct Converged {
    u: Vec<Vec3>,
    forces: Vec<Vec3>,
    tool_forces: Vec<Vec3>,
    offsets: Vec<Vec3>,
    multipliers: Vec<Vec<Vec3>>,
    scale: f64,
    trace: Vec<f64>,
    changes: Vec<usize>,
    calmed: Vec<u32>,
}

/// How an attempt at an increment ended.
enum Attempt {
    Converged(Box<Converged>),
    Failed(Failed),
}

/// An attempt that did not converge.
struct Failed {
    reason: String,
    /// The matrix was singular from the start: a shorter increment does not help.
    singular: bool,
    /// The iteration began from an extrapolation; the same increment may do from the converged state.
    extrapolated: bool,
    /// The worst equation of this rank, with its residual.
    worst: (usize, f64),
    /// Nodes that changed their status in the last iteration.
    changes: usize,
}

impl Analysis<'_> {
    /// Runs a step. Collective.
    ///
    /// # Errors
    /// No convergence at the smallest increment; what has converged is kept and written.
    pub(super) fn step(&mut self, step: &Step) -> Result<()> {
        let last = &self.state.conditions;
        let mut conditions = agree(self.comm, Conditions::new(self.comm, &self.model, step, &self.state.u, last))?;
        conditions.hand_over(last, &self.state.tool_forces);
        let dofs = DofMap::new(self.comm, &self.model, &conditions.prescribed, &conditions.freedoms());
        let pattern = self.phases.time(Phase::Assembly, || Pattern::new(self.comm, &self.model, &dofs));
        let poses = self.model.tools.iter().map(|t| t.committed).collect();
        let offsets = vec![Vec3::zeros(); self.model.tools.len()];
        let mut frame = Frame { step, conditions, dofs, pattern, poses, offsets, past: Vec::new() };
        self.summary.dofs = frame.dofs.total;
        self.summary.multipliers = frame.dofs.total_multipliers;

        let symmetric = frame.conditions.is_symmetric(&self.model);
        let values = vec![0.0; frame.pattern.columns.len()];
        let mut matrix =
            Matrix::from_csr(self.petsc, frame.dofs.count, &frame.pattern.offsets, &frame.pattern.columns, &values)?;
        matrix.set_symmetric(symmetric)?;
        let kind = if symmetric { Factorization::Ldlt } else { Factorization::Lu };
        self.summary.matrix = if symmetric { "symmetric indefinite" } else { "unsymmetric" }.into();
        self.summary.linear_solver = if symmetric { "MUMPS LDL^T, SCOTCH" } else { "MUMPS LU, SCOTCH" }.into();
        let mut snes = Snes::new(self.petsc, matrix, kind)?;
        let mut x = Vector::zeros(self.petsc, frame.dofs.count)?;

        let start = self.state.time;
        let mut increments = Increments::new(&step.increment, step.duration);
        let mut since_written = 0;
        let mut warned = false;
        while let Some(end) = increments.next() {
            let outcome = self.attempt(&mut frame, &mut snes, &mut x, end)?;
            match outcome {
                Attempt::Converged(converged) => {
                    let iterations = converged.trace.len() - 1;
                    let size = (end - increments.done) * step.duration;
                    frame.remember(end, &x.array()?);
                    let busy = self.is_busy();
                    increments.accept(end, iterations, busy);
                    self.state.time = start + end * step.duration;
                    since_written += 1;
                    let last = increments.next().is_none();
                    let write = since_written >= self.scene.output.every || last;
                    if write {
                        since_written = 0;
                    }
                    self.accept(&mut frame, *converged, size, write)?;
                    let null_pivots = snes.linear_statistics().null_pivots;
                    if null_pivots > 0 && !std::mem::replace(&mut warned, true) {
                        self.log.line(&describe::null_pivots(&step.name.value, null_pivots));
                    }
                }
                Attempt::Failed(failed) if failed.extrapolated => frame.past.clear(),
                Attempt::Failed(failed) => {
                    self.summary.cutbacks += 1;
                    let size = (end - increments.done) * step.duration;
                    if failed.singular || !increments.cut(end) {
                        if since_written > 0 {
                            self.results.write_fields(self.comm, &self.model, self.state.time, &self.state.u)?;
                        }
                        let told = self.tell_failure(&frame, &failed, size);
                        return Err(Error::Diverged(told));
                    }
                    let line =
                        format!("  {}: {} with increment {size:.3e}; cut to a half", step.name.value, failed.reason);
                    self.log.line(&line);
                }
            }
        }
        self.state.conditions = frame.conditions;
        Ok(())
    }

    /// Tries one increment to fraction `end` of the step. A search that proves too narrow is widened and the iteration goes
    /// on from where it is. Collective.
    fn attempt(&mut self, frame: &mut Frame, snes: &mut Snes, x: &mut Vector, end: f64) -> Result<Attempt> {
        self.watch_ahead(frame, end);
        let (log, number) = (&self.log, self.summary.increments + 1);
        let watcher = |iteration| log.iteration(&frame.step.name.value, number, iteration);
        let start = Start {
            start_poses: &frame.poses,
            committed: &self.state.u,
            offsets: &frame.offsets,
            s: end,
            tolerance: self.scene.solver.tolerance,
            max_iterations: self.scene.solver.max_iterations,
            scale: self.state.scale,
            watcher: &watcher,
        };
        // Between facets the solution jumps: extrapolated, it would be sought on the facet that a node is about to leave.
        let smooth = self.model.tools.iter().all(|t| !t.surface.faceted);
        let trial = frame.extrapolated(end).filter(|_| smooth);
        let extrapolated = trial.is_some();
        let reach: Vec<f64> = self.model.pairs.iter().map(|p| p.reach).collect();
        let mut newton = Newton::new(
            self.comm,
            &mut self.model,
            &frame.dofs,
            &frame.pattern,
            &frame.conditions,
            self.phases,
            &start,
        );
        match trial {
            Some(trial) => newton.start_ahead(&trial, &mut x.array_mut()?),
            None => newton.start_behind(&mut x.array_mut()?),
        }
        let attempt = loop {
            let outcome = snes.solve(x, &mut newton)?;
            self.summary.iterations += outcome.iterations;
            if outcome.reason != Reason::Converged {
                let changes = newton.changes.last().copied().unwrap_or(0);
                break Attempt::Failed(Failed {
                    reason: told(&outcome.reason, self.scene.solver.max_iterations),
                    singular: is_singular(&outcome.reason) && newton.trace.len() <= 1,
                    extrapolated,
                    worst: newton.worst,
                    changes,
                });
            }
            // Where some node went farther than the search had looked, the iteration goes on.
            if !newton.widen_search() {
                break Attempt::Converged(Box::new(converged(&newton, &x.array()?)));
            }
        };
        for (pair, reach) in self.model.pairs.iter_mut().zip(reach) {
            pair.reach = reach;
        }
        Ok(attempt)
    }

    /// Fetches the patches that the slave nodes may meet in the increment to `end`. Collective.
    fn watch_ahead(&mut self, frame: &Frame, end: f64) {
        let begun = Instant::now();
        let Model { part, tools, pairs, .. } = &mut self.model;
        frame.conditions.place_tools(tools, &frame.poses, &frame.offsets, end);
        watch_all(self.comm, tools, pairs, |n| part.points[n as usize] + self.state.u[n as usize]);
        self.phases.add(Phase::Search, begun.elapsed());
    }

    /// Makes a converged increment the state, and reports it. Collective.
    fn accept(&mut self, frame: &mut Frame, converged: Converged, size: f64, write: bool) -> Result<()> {
        for tool in &mut self.model.tools {
            tool.committed = tool.trial;
        }
        let Model { part, tools, pairs, .. } = &mut self.model;
        for (pair, multipliers) in pairs.iter_mut().zip(&converged.multipliers) {
            for (slave, multiplier) in pair.slaves.iter_mut().zip(multipliers) {
                let node = slave.node as usize;
                let position = part.points[node] + converged.u[node];
                slave.commit(*multiplier, &tools[pair.tool].committed, &position);
            }
        }
        frame.offsets = converged.offsets;
        self.state.u = converged.u;
        self.state.tool_forces = converged.tool_forces;
        self.state.scale = converged.scale;
        self.summary.increments += 1;
        let step = &frame.step.name.value;
        let (number, time) = (self.summary.increments, self.state.time);
        let iterations = converged.trace.len() - 1;
        let begun = Instant::now();
        let row = results::Row {
            step,
            number,
            time,
            iterations,
            u: &self.state.u,
            forces: &converged.forces,
            tool_forces: &self.state.tool_forces,
        };
        self.results.add_row(self.comm, &self.model, &row)?;
        if write {
            self.results.write_fields(self.comm, &self.model, time, &self.state.u)?;
        }
        self.phases.add(Phase::Output, begun.elapsed());
        let note = self.note(converged.calmed.len());
        self.log.increment(&log::Increment { step, number, time, size, iterations, note: &note });
        self.log.record(&describe::trace(&converged.trace, &converged.changes));
        if let Some(name) = first_word(self.comm, converged.calmed.first().map(|&n| node_name(&self.model, n))) {
            self.log.record(&format!("    friction penalty reduced at flipping nodes, such as {name}"));
        }
        Ok(())
    }

    /// Whether this increment, which has converged, saw so much change of contact that the next should not be longer: a
    /// quarter of the contact nodes changed sides, or a node slid so far on a curved surface that its path is no longer
    /// short against the radius of curvature. Collective.
    fn is_busy(&self) -> bool {
        const FAR: f64 = 0.3;
        let mut counts = [0.0; 3];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            let (before, now) = (slave.committed.status != Status::Gap, slave.trial.status != Status::Gap);
            counts[0] += f64::from(before || now);
            counts[1] += f64::from(before != now);
            let curvature = slave.trial.projection.map_or(0.0, |p| p.normal_gradient.norm());
            counts[2] += f64::from(now && slave.trial.slip.norm() * curvature > FAR);
        }
        sum(self.comm, &mut counts);
        4.0 * counts[1] > counts[0] || counts[2] > 0.0
    }

    /// Contact in a few words. Collective.
    fn note(&self, calmed: usize) -> String {
        let mut counts = [0.0, 0.0, calmed as f64];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            counts[0] += f64::from(slave.trial.status != Status::Gap);
            counts[1] += f64::from(slave.trial.status == Status::Slip && slave.law.friction > 0.0);
        }
        sum(self.comm, &mut counts);
        let mut note = format!("{} in contact, {} slip", counts[0], counts[1]);
        if counts[2] > 0.0 {
            note += &format!(", {} calmed", counts[2]);
        }
        note
    }

    /// Names the worst equation of all ranks, and what to try. Collective.
    fn tell_failure(&self, frame: &Frame, failed: &Failed, size: f64) -> String {
        let mut largest = [failed.worst.1];
        max(self.comm, &mut largest);
        let here = largest[0] == failed.worst.1 && frame.dofs.count > 0;
        let place = first_word(self.comm, here.then(|| frame.dofs.describe(&self.model, failed.worst.0)));
        describe::failure(&describe::Failure {
            step: &frame.step.name.value,
            time: self.state.time,
            reason: &failed.reason,
            singular: failed.singular,
            place: place.as_deref().unwrap_or("an unknown equation"),
            residual: largest[0] / self.state.scale,
            changes: failed.changes,
            size,
        })
    }
}

/// What is kept of a converged iterate.
fn converged(newton: &Newton, x: &[f64]) -> Converged {
    Converged {
        u: newton.u.clone(),
        forces: newton.forces.clone(),
        tool_forces: newton.tool_forces.clone(),
        offsets: newton.offsets.clone(),
        multipliers: newton.multipliers(x),
        scale: newton.scale,
        trace: newton.trace.clone(),
        changes: newton.changes.clone(),
        calmed: newton.calmed.clone(),
    }
}

/// Whether MUMPS found equations that determine nothing.
fn is_singular(reason: &Reason) -> bool {
    matches!(reason, Reason::Linear(LinearFailure::Singular(..) | LinearFailure::Inaccurate { null_pivots: 1.., .. }))
}

/// Why an increment failed, in the user's terms.
fn told(reason: &Reason, iterations: usize) -> String {
    match reason {
        Reason::Diverged => format!("no convergence in {iterations} iterations"),
        Reason::OutOfDomain => "an element turned inside out".into(),
        other => other.to_string(),
    }
}
