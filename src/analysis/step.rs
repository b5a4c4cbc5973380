//! One step: its equations, its increments, and what becomes of each.

use super::conditions::Conditions;
use super::increments::Increments;
use super::ladder::{Cause, Found, Ladder, Remedy, Way, Yields};
use super::newton::{Newton, Round, Share, Start};
use super::{Analysis, conditioning, describe, ending, results};
use crate::contact::{Manner, Master, Pair, Pose, Status, follow_all, watch_all};
use crate::controls::Controls;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::model::Model;
use crate::output::log;
use crate::output::phases::Phase;
use crate::parallel::{agree, any, first_word, sum, word_of_largest};
use crate::scene::Step;
use crate::system::dofs::node_name;
use crate::system::{DofMap, Pattern, assembly};
use crate::{Mat3, Vec3};
use petsc::{Factorization, LinearFailure, Matrix, Reason, Snes, Vector};
use std::time::Instant;

/// What stays the same over a step.
pub(super) struct Frame<'a> {
    pub(super) step: &'a Step,
    pub(super) conditions: Conditions,
    dofs: DofMap,
    pattern: Pattern,
    /// Poses of the tools at its start.
    poses: Vec<Pose>,
    /// Force-driven translations of the tools so far in it.
    pub(super) offsets: Vec<Vec3>,
    /// Unknowns at the last converged ends of increments of this step, at most three, with their fractions of the step.
    pub(super) past: Vec<(f64, Vec<f64>)>,
    pub(super) ladder: Ladder,
    /// Supports alone do not hold every body and force-driven tool.
    pub(super) hangs: bool,
}

impl Frame<'_> {
    /// The free directions of each tool.
    pub(super) fn driven(&self) -> Vec<[bool; 3]> {
        self.conditions.motions.iter().map(|motion| motion.free).collect()
    }

    /// Remembers the unknowns of a converged increment.
    fn remember(&mut self, end: f64, x: &[f64]) {
        self.past.push((end, x.to_vec()));
        if self.past.len() > 3 {
            self.past.remove(0);
        }
    }

    /// The unknowns at `end` if they go on as before; `None` while there are no two to go on from. A short last increment, to a
    /// time of the grid, says too little of a long one: what it follows is then part of the base.
    fn extrapolated(&self, end: f64, farthest: f64) -> Option<Vec<f64>> {
        let [earlier @ .., (last, new)] = &self.past[..] else { return None };
        let ratio = |from: f64| (end - last) / (last - from);
        let (from, old) = earlier.iter().rev().find(|(from, _)| ratio(*from) <= farthest).or(earlier.first())?;
        let ratio = ratio(*from);
        Some(old.iter().zip(new).map(|(a, b)| b + (b - a) * ratio).collect())
    }
}

/// A converged increment, before it is accepted.
pub(super) struct Converged {
    /// Fraction of the step.
    end: f64,
    pub(super) u: Vec<Vec3>,
    forces: Vec<Vec3>,
    tool_forces: Vec<Vec3>,
    offsets: Vec<Vec3>,
    multipliers: Vec<Vec<Vec3>>,
    seen: Vec<f64>,
    /// Residual that is let through at each contact, N.
    pub(super) limits: Vec<f64>,
    /// Largest residual that was let through, over the forces that it counts against.
    limit: f64,
    trace: Vec<f64>,
    changes: Vec<usize>,
    calmed: Vec<u32>,
    rounds: usize,
}

impl Converged {
    /// Why it is not accepted.
    pub(super) fn refused(self, cause: Cause, reason: String) -> Failed {
        let Self { end, trace, changes, .. } = self;
        Failed { end, cause, reason, extrapolated: false, worst: None, trace, changes }
    }
}

/// How an attempt at an increment ended.
pub(super) enum Attempt {
    Converged(Box<Converged>),
    Failed(Failed),
}

/// An attempt that did not converge.
pub(super) struct Failed {
    /// Fraction of the step at the end of the increment.
    end: f64,
    cause: Cause,
    reason: String,
    /// The iteration began from an extrapolation; the same increment may do from the converged state.
    extrapolated: bool,
    /// The worst equation of this rank, with its residual, where balance was not found.
    worst: Option<(usize, f64)>,
    trace: Vec<f64>,
    changes: Vec<usize>,
}

impl Analysis<'_> {
    /// Runs a step. Collective.
    ///
    /// # Errors
    /// No convergence at the smallest increment, or what ends a run at once; what has converged is kept and written.
    pub(super) fn step(&mut self, step: &Step) -> Result<()> {
        let last = &self.state.conditions;
        let mut conditions = agree(self.comm, Conditions::new(self.comm, &self.model, step, &self.state.u, last))?;
        conditions.hand_over(last, &self.state.tool_forces);
        let dofs = DofMap::new(self.comm, &self.model, &conditions.prescribed, &conditions.freedoms());
        let pattern = self.pattern(&conditions, &dofs);
        let poses = self.model.tools.iter().map(|t| t.committed).collect();
        let offsets = vec![Vec3::zeros(); self.model.tools.len()];
        let frictional = self.model.pairs.iter().any(|p| p.friction > 0.0);
        let contacts = &self.scene.contacts;
        let given = contacts.iter().any(|c| c.penalty.is_some() && !c.method.holds_multipliers());
        let mut frame = Frame {
            step,
            conditions,
            dofs,
            pattern,
            poses,
            offsets,
            past: Vec::new(),
            ladder: Ladder::new(frictional || given, frictional || self.model.can_flow(), &self.scene.controls),
            hangs: false,
        };
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

        let (start, analyses) = (self.state.time, self.summary.analyses);
        let mut increments = Increments::new(&step.sizes(), step.duration, &self.scene.controls);
        let limits = step.increment.limits;
        let mut since_written = 0;
        let mut warned = false;
        // The last failure of Newton's method itself, which says more than that of a remedy.
        let mut plain: Option<Failed> = None;
        frame.hangs = self.hangs(&frame);
        while let Some(end) = increments.next() {
            frame.ladder.settles = frictional && frame.hangs && self.is_held_by_friction(&frame);
            let outcome = match frame.ladder.way() {
                _ if any(self.comm, interrupt::wished()) => {
                    Err(ending::by_signal(self.comm, (&step.name.value, self.state.time)))
                }
                Way::Newton { .. } => {
                    let share = Share { begin: increments.done, most: increments.most_parts(end), limits };
                    self.attempt(&mut frame, &mut snes, &mut x, (end, share), 0.0)
                }
                Way::Jump => self.jump(&mut frame, &mut snes, &mut x, end),
            };
            let outcome = match outcome {
                Ok(outcome) => outcome,
                Err(error) => {
                    // The first error counts.
                    let _ = self.keep(since_written);
                    return Err(error);
                }
            };
            self.summary.analyses = analyses + snes.linear_statistics().analyses;
            match outcome {
                Attempt::Converged(converged) => {
                    let is_remedy = frame.ladder.is_remedy();
                    let found = frame.ladder.succeed();
                    let end = converged.end;
                    let iterations = converged.trace.len() - 1;
                    let size = (end - increments.done) * step.duration;
                    match is_remedy {
                        true => frame.past.clear(),
                        false => frame.remember(end, &x.array()?),
                    }
                    let busy = self.is_busy();
                    increments.accept(end, iterations.div_ceil(1 + converged.rounds), busy);
                    if found.way == Way::Jump {
                        increments.resume();
                    }
                    let write = since_written + 1 >= self.scene.output.every || increments.next().is_none();
                    let span = (size, start + end * step.duration);
                    if let Err(error) = self.accept(&mut frame, *converged, found, span, write) {
                        let _ = self.keep(since_written);
                        return Err(error);
                    }
                    since_written = if write { 0 } else { since_written + 1 };
                    plain = None;
                    let null_pivots = snes.linear_statistics().null_pivots;
                    if null_pivots > 0 && !std::mem::replace(&mut warned, true) {
                        let free = self.free_motion(&frame, &mut snes)?;
                        let warning = describe::null_pivots(&step.name.value, null_pivots, free.as_deref());
                        self.log.line(&format!("  warning: {warning}"));
                        self.summary.warnings.push(warning);
                    }
                }
                Attempt::Failed(failed) if failed.extrapolated => frame.past.clear(),
                Attempt::Failed(failed) => {
                    let end = failed.end;
                    let size = (end - increments.done) * step.duration;
                    if let Some(told) = self.runaway(&frame, end) {
                        self.keep(since_written)?;
                        return Err(Error::Diverged(told));
                    }
                    let is_remedy =
                        frame.ladder.is_remedy() || frame.ladder.yields() || frame.ladder.way() == Way::Jump;
                    frame.ladder.can_yield = self.yields();
                    let Some(remedy) = frame.ladder.fail(&mut increments, end, failed.cause) else {
                        self.keep(since_written)?;
                        let told = plain.filter(|_| is_remedy && failed.cause.is_of_remedy()).unwrap_or(failed);
                        let size = (told.end - increments.done) * step.duration;
                        return Err(Error::Diverged(self.tell_failure(&frame, &told, size)));
                    };
                    self.summary.cutbacks += usize::from(remedy == Remedy::Cut);
                    self.log.line(&describe::remedy(&step.name.value, &failed.reason, size, remedy));
                    self.log.record(&describe::trace(&failed.trace, &failed.changes));
                    if !is_remedy {
                        plain = Some(failed);
                    }
                }
            }
        }
        self.state.conditions = frame.conditions;
        Ok(())
    }

    /// When constraints may give way, or more than they do anyway. Collective.
    fn yields(&self) -> Yields {
        let mut unknown = self.model.pairs.iter().filter(|pair| pair.width() > 0).peekable();
        if unknown.peek().is_none() {
            return Yields::Never;
        }
        let meets = |pair: &Pair| pair.is_self() && pair.slaves.iter().any(|s| s.trial.status != Status::Gap);
        if any(self.comm, unknown.any(meets)) { Yields::Anew } else { Yields::OnceSingular }
    }

    /// A motion that costs nothing, where MUMPS has found null pivots: its equation in words. `None` where only multipliers
    /// are left open. Collective.
    fn free_motion(&self, frame: &Frame, snes: &mut Snes) -> Result<Option<String>> {
        // Over what is sought, far above rounding.
        const SOME: f64 = 1e-4;
        let first = frame.dofs.first;
        let is_force: Vec<bool> = frame.dofs.forces();
        let sought: Vec<f64> = (is_force.iter().enumerate())
            .map(|(k, force)| (1.0 + (first + k as i64) as f64).sin() * if *force { self.model.stiffness } else { 1.0 })
            .collect();
        let Some(open) = snes.null_part(&Vector::from_slice(self.petsc, &sought)?)? else { return Ok(None) };
        let open = open.array()?;
        let moves = open.iter().zip(&is_force).map(|(open, force)| if *force { 0.0 } else { open.abs() }).enumerate();
        let (worst, size) = moves.fold((0, 0.0), |worst, at| if at.1 > worst.1 { at } else { worst });
        let moves = Some((worst, size)).filter(|(_, size)| *size > SOME);
        Ok(word_of_largest(self.comm, moves, |worst| frame.dofs.describe(&self.model, worst)).map(|(word, _)| word))
    }

    /// Writes the fields of the last converged increment, unless they are written. Collective.
    fn keep(&mut self, since_written: usize) -> Result<()> {
        if since_written == 0 {
            return Ok(());
        }
        self.results.write_fields(self.comm, &self.model, self.state.time, &self.state.u)
    }

    /// The pattern of a step. Collective.
    fn pattern(&mut self, conditions: &Conditions, dofs: &DofMap) -> Pattern {
        let begun = Instant::now();
        super::survey(self.comm, &mut self.model, conditions, dofs, &self.state.u);
        let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
        let pattern = Pattern::new(self.comm, &self.model, dofs, place);
        self.phases.add(Phase::Assembly, begun.elapsed());
        pattern
    }

    /// Tries one increment to fraction `end` of the step, or a share of it. A search that proves too narrow is widened and
    /// the iteration goes on from where it is. All that moves has the `drag` of so much force per length. Collective.
    pub(super) fn attempt(
        &mut self,
        frame: &mut Frame,
        snes: &mut Snes,
        x: &mut Vector,
        (end, share): (f64, Share),
        drag: f64,
    ) -> Result<Attempt> {
        self.watch_ahead(frame, end);
        let max_iterations = self.scene.solver.max_iterations;
        let (log, number) = (&self.log, self.summary.increments + 1);
        let watcher = |iteration| log.iteration(&frame.step.name.value, number, iteration);
        let controls = self.model.controls;
        let smooth = self.model.can_flow() || self.model.tools.iter().all(|t| !t.surface.faceted);
        let may_extrapolate = controls.extrapolate > usize::from(!smooth);
        let trial = frame.extrapolated(end, controls.extrapolate_farthest).filter(|_| may_extrapolate);
        let extrapolated = trial.is_some();
        let manner = Manner {
            settles: frame.ladder.way() == Way::Newton { settle: true },
            ahead: extrapolated,
            automatic: frame.ladder.is_remedy() || frame.ladder.yields(),
            yields: frame.ladder.yields(),
        };
        let start = Start {
            start_poses: &frame.poses,
            committed: &self.state.u,
            offsets: &frame.offsets,
            s: end,
            share,
            tolerance: self.scene.solver.tolerance,
            strict: frame.ladder.is_strict(),
            manner,
            max_iterations: max_iterations.min(if drag > 0.0 { controls.jump_iterations } else { usize::MAX }),
            seen: &self.state.seen,
            floors: &self.state.floors,
            watcher: &watcher,
        };
        let reach: Vec<f64> = self.model.pairs.iter().map(|p| p.reach).collect();
        let mut newton = Newton::new(
            self.comm,
            &mut self.model,
            &frame.dofs,
            &mut frame.pattern,
            &frame.conditions,
            self.phases,
            &start,
        );
        newton.set_drag(drag);
        match trial {
            Some(trial) => newton.start_ahead(&trial, &mut x.array_mut()?),
            None => newton.start_behind(&mut x.array_mut()?),
        }
        let attempt = loop {
            let outcome = snes.solve(x, &mut newton)?;
            self.summary.iterations += outcome.iterations;
            let at = (frame.step.name.value.as_str(), self.state.time);
            if let Some(error) = ending::at_once(self.comm, at, newton.interrupted, &outcome.reason) {
                return Err(error);
            }
            if outcome.reason != Reason::Converged {
                let reason = told(&outcome.reason, max_iterations);
                let cause = cause(&outcome.reason, newton.trace.len() <= 1, controls.singular_residual);
                break Attempt::Failed(failed(&newton, cause, reason, extrapolated));
            }
            // Where some node went farther than the search had looked, the iteration goes on.
            if newton.widen_search() {
                continue;
            }
            let round = match newton.end_round() {
                Round::Done => newton.tighten(&x.array()?),
                other => other,
            };
            match round {
                Round::Again => {}
                Round::Done => {
                    break match newton.unresolved(true) {
                        None => Attempt::Converged(Box::new(converged(&newton, &x.array()?))),
                        Some(reason) => Attempt::Failed(failed(&newton, Cause::Rounding, reason, extrapolated)),
                    };
                }
                Round::Failed(reason) => {
                    break Attempt::Failed(failed(&newton, Cause::Rounds, reason, extrapolated));
                }
                Round::Contradicts(reason) => {
                    break Attempt::Failed(failed(&newton, Cause::Contradiction, reason, extrapolated));
                }
            }
        };
        self.summary.outer_iterations += newton.rounds.count;
        self.summary.pattern_rebuilds += newton.rebuilds;
        for (pair, reach) in self.model.pairs.iter_mut().zip(reach) {
            pair.reach = reach;
        }
        Ok(match self.watched(attempt) {
            Attempt::Converged(converged) if drag == 0.0 => self.still_held(frame, converged),
            attempt => attempt,
        })
    }

    /// Fetches the patches that the slave nodes may meet in the increment to `end`. Collective.
    fn watch_ahead(&mut self, frame: &Frame, end: f64) {
        let begun = Instant::now();
        let Model { part, tools, surfaces, pairs, .. } = &mut self.model;
        frame.conditions.place_tools(tools, &frame.poses, &frame.offsets, end);
        let place = |n: u32| part.points[n as usize] + self.state.u[n as usize];
        watch_all(self.comm, tools, pairs, place);
        follow_all(self.comm, surfaces, pairs, place);
        self.phases.add(Phase::Search, begun.elapsed());
    }

    /// Makes a converged increment the state. Collective.
    ///
    /// # Errors
    /// An element that cannot follow; the state is then what it was.
    pub(super) fn commit(&mut self, frame: &mut Frame, converged: &Converged) -> Result<()> {
        let flown = agree(self.comm, assembly::flown(&mut self.model, &converged.u))?;
        assembly::flow(&mut self.model, flown);
        for tool in &mut self.model.tools {
            tool.committed = tool.trial;
        }
        let Model { part, tools, surfaces, pairs, .. } = &mut self.model;
        for (pair, multipliers) in pairs.iter_mut().zip(&converged.multipliers) {
            for (slave, multiplier) in pair.slaves.iter_mut().zip(multipliers) {
                let node = slave.node as usize;
                let position = part.points[node] + converged.u[node];
                match pair.master {
                    Master::Tool(t) => slave.commit(pair.method, *multiplier, &tools[t].committed, &position),
                    Master::Surface(k) => {
                        let frame = slave.trial.projection.and_then(|p| surfaces[k].frame(&p));
                        let frame = frame.unwrap_or_else(Mat3::identity);
                        slave.commit_on_surface(pair.method, *multiplier, &frame, &position);
                    }
                }
            }
        }
        frame.offsets.clone_from(&converged.offsets);
        self.state.u.clone_from(&converged.u);
        self.model.turn_slaves(&self.state.u);
        self.model.follow_sheets(self.comm, &self.state.u);
        self.state.tool_forces.clone_from(&converged.tool_forces);
        self.state.seen.clone_from(&converged.seen);
        Ok(())
    }

    /// Makes a converged increment of a size, to a time, the state, and reports it. Collective.
    fn accept(
        &mut self,
        frame: &mut Frame,
        converged: Converged,
        found: Found,
        (size, time): (f64, f64),
        write: bool,
    ) -> Result<()> {
        self.commit(frame, &converged)?;
        self.state.time = time;
        self.note_touches();
        self.summary.increments += 1;
        let step = &frame.step.name.value;
        let number = self.summary.increments;
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
            found,
            residual: converged.trace.last().copied().unwrap_or_default(),
            limit: converged.limit,
        };
        self.results.add_row(self.comm, &self.model, &row)?;
        if write {
            self.results.write_fields(self.comm, &self.model, time, &self.state.u)?;
        }
        self.phases.add(Phase::Output, begun.elapsed());
        let note = self.note(converged.calmed.len(), converged.rounds);
        self.log.increment(&log::Increment { step, number, time, size, iterations, note: &note });
        self.log.record(&describe::trace(&converged.trace, &converged.changes));
        if let Some(name) = first_word(self.comm, converged.calmed.first().map(|&n| node_name(&self.model, n))) {
            self.log.record(&format!("    friction penalty reduced at flipping nodes, such as {name}"));
        }
        Ok(())
    }

    /// Whether this increment, which has converged, saw so much change of contact that the next should not be longer: many
    /// of the contact nodes changed sides, or a node slid so far on a curved surface that its path is no longer
    /// short against the radius of curvature. Collective.
    fn is_busy(&self) -> bool {
        let Controls { busy_share, busy_turn, .. } = self.model.controls;
        let mut counts = [0.0; 3];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            let (before, now) = (slave.committed.status != Status::Gap, slave.trial.status != Status::Gap);
            counts[0] += f64::from(before || now);
            counts[1] += f64::from(before != now);
            let curvature = slave.trial.projection.map_or(0.0, |p| p.normal_gradient.norm());
            counts[2] += f64::from(now && slave.trial.slip.norm() * curvature > busy_turn);
        }
        sum(self.comm, &mut counts);
        counts[1] > busy_share * counts[0] || counts[2] > 0.0
    }

    /// Contact in a few words. Collective.
    fn note(&self, calmed: usize, rounds: usize) -> String {
        let mut counts = [0.0, 0.0, calmed as f64];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            counts[0] += f64::from(slave.trial.status != Status::Gap);
            counts[1] += f64::from(slave.trial.status == Status::Slip && slave.law.friction > 0.0);
        }
        sum(self.comm, &mut counts);
        let mut note = format!("{} in contact, {} slip", counts[0], counts[1]);
        if rounds > 0 {
            note += &format!(", {rounds} outer");
        }
        if counts[2] > 0.0 {
            note += &format!(", {} calmed", counts[2]);
        }
        note
    }

    /// Names the worst equation of all ranks, and what to try. Collective.
    fn tell_failure(&self, frame: &Frame, failed: &Failed, size: f64) -> String {
        let worst = failed.worst.filter(|_| frame.dofs.count > 0);
        let told = word_of_largest(self.comm, worst, |equation| frame.dofs.describe(&self.model, equation));
        let (place, residual) = told.unzip();
        let linear = failed.cause.is_linear() || failed.cause == Cause::Contradiction;
        let conditioning = linear.then(|| conditioning::reason(self.comm, &self.model)).flatten();
        describe::failure(&describe::Failure {
            step: &frame.step.name.value,
            time: self.state.time,
            reason: &failed.reason,
            cause: failed.cause,
            conditioning: conditioning.as_deref(),
            place: place.as_deref(),
            residual: residual.unwrap_or(0.0),
            changes: failed.changes.last().copied().unwrap_or(0),
            size,
        })
    }
}

/// What is kept of a converged iterate.
fn converged(newton: &Newton, x: &[f64]) -> Converged {
    Converged {
        end: newton.s,
        u: newton.u.clone(),
        forces: newton.forces.clone(),
        tool_forces: newton.tool_forces.clone(),
        offsets: newton.offsets.clone(),
        multipliers: newton.multipliers(x),
        seen: newton.balance.accepted(),
        limits: newton.limits(),
        limit: newton.balance.limit_of_all(newton.tolerance),
        trace: newton.trace.clone(),
        changes: newton.changes.clone(),
        calmed: newton.calmed.clone(),
        rounds: newton.rounds.count + newton.rounds.tightened,
    }
}

/// What is told of an iterate that is no solution.
fn failed(newton: &Newton, cause: Cause, reason: String, extrapolated: bool) -> Failed {
    let (trace, changes) = (newton.trace.clone(), newton.changes.clone());
    let (cause, reason) = match newton.unresolved(false) {
        Some(lost) => (Cause::Rounding, lost),
        None => (cause, reason),
    };
    Failed { end: newton.s, cause, reason, extrapolated, worst: Some(newton.worst), trace, changes }
}

/// Why Newton's method ended without convergence. There are equations that determine nothing where MUMPS found them, or what
/// it solved is no solution.
fn cause(reason: &Reason, at_once: bool, singular_residual: f64) -> Cause {
    let singular = match reason {
        Reason::Linear(LinearFailure::Singular(..)) => true,
        Reason::Linear(LinearFailure::Inaccurate { relative_residual, null_pivots }) => {
            *null_pivots > 0 || *relative_residual > singular_residual
        }
        _ => return Cause::Iteration,
    };
    if singular && at_once { Cause::Singular } else { Cause::Degenerate }
}

/// Why an increment failed, in the user's terms.
fn told(reason: &Reason, iterations: usize) -> String {
    match reason {
        Reason::Diverged => format!("no convergence in {iterations} iterations"),
        Reason::OutOfDomain => "an element turned inside out".into(),
        other => other.to_string(),
    }
}
