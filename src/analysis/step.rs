//! One step: its equations, its increments, and what becomes of each.

use super::between::Between;
use super::conditions::Conditions;
use super::cost::size::Systems;
use super::increments::Increments;
use super::ladder::{Ladder, Way, Yields};
use super::last_iterate::LastIterate;
use super::newton::{Newton, Round, Share, Start, System};
use super::state::Progress;
use super::{
    Event, Increment, Iteration, Observer, Remedy, Retried, Rounded, Simulation, conditioning, cost, describe, ending,
    suspects,
};
use crate::Vec3;
use crate::contact::{Manner, Pair, Pose, Status};
use crate::controls::Controls;
use crate::error::{Error, Result};
use crate::failure::{Cause, Failure, Place};
use crate::interrupt;
use crate::model::{Model, states};
use crate::output::phases::Phase;
use crate::parallel::{agree, any, first_word, sum, word_of_largest};
use crate::scene::{Enforcement, Linear, Step};
use crate::system::dofs::node_name;
use crate::system::near::{self, Near};
use crate::system::{DofMap, Pattern};
use petsc::{Factorization, LinearFailure, LinearStatistics, Matrix, Petsc, Reason, Snes, Vector};
use std::time::Instant;

/// A step under way: what stays the same over it, and how far it is.
pub(super) struct Frame {
    pub(super) progress: Progress,
    pub(super) dofs: DofMap,
    pub(super) pattern: Pattern,
    /// Supports alone do not hold every body and force-driven tool.
    pub(super) hangs: bool,
    /// Failed increments say more of Newton's method than of its remedies: the last such.
    plain: Option<Failed>,
}

/// The equations of a step, and its solver.
pub(super) struct Running<'a> {
    pub(super) frame: Frame,
    snes: Snes<'a>,
    x: Vector<'a>,
    systems: Systems,
    /// Systems are solved by multigrid, which does not tell what conditions say what others say.
    is_blind: bool,
    /// What was done for linear systems before it.
    before: LinearStatistics,
    pub(super) told: Told,
}

/// What of the linear solver has been told of in a step.
#[derive(Default)]
pub(super) struct Told {
    null_pivots: bool,
    unsolved: bool,
    impatience: bool,
}

impl Frame {
    pub(super) fn conditions(&self) -> &Conditions {
        &self.progress.conditions
    }

    pub(super) fn name(&self) -> &str {
        &self.progress.step.name.value
    }
}

impl Progress {
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
    pub(super) end: f64,
    pub(super) u: Vec<Vec3>,
    forces: Vec<Vec3>,
    damped: Vec<Vec3>,
    tool_forces: Vec<Vec3>,
    offsets: Vec<Vec3>,
    multipliers: Vec<Vec<Vec3>>,
    tie_forces: Vec<Vec<Vec3>>,
    seen: Vec<f64>,
    /// Residual that is let through at each contact, N.
    pub(super) limits: Vec<f64>,
    /// Of each pair how deep its master is between nodes, as the watch saw it.
    pub(super) between: Vec<Between>,
    /// Largest residual that was let through, over the forces that it counts against.
    limit: f64,
    rounded: Option<Rounded>,
    trace: Vec<f64>,
    changes: Vec<usize>,
    calmed: Vec<u32>,
    rounds: usize,
}

impl Converged {
    /// Why it is not accepted.
    pub(super) fn refused(self, cause: Cause, reason: String) -> Failed {
        let Self { end, changes, .. } = self;
        Failed { end, cause, reason, extrapolated: false, worst: None, changes, last: None }
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
    changes: Vec<usize>,
    /// Where the iteration ended.
    last: Option<Box<LastIterate>>,
}

impl<'a> Simulation<'a> {
    /// Begins a step where the simulation is; one that is under way ends there, with the loads that it has. Collective.
    ///
    /// # Errors
    /// Conditions that contradict each other, or name what there is not.
    pub fn begin(&mut self, step: &Step) -> Result<()> {
        agree(self.comm, self.check_names(step))?;
        if let Some(running) = self.running.take() {
            let done = running.frame.progress.increments.done;
            self.state.conditions = running.frame.progress.conditions.ended_at(done);
        }
        let forces = &self.state.tool_forces;
        let poses = self.poses();
        let conditions = self.conditions(step, &self.state.u, &self.state.conditions, (forces, &poses))?;
        self.state.handed.push(forces.clone());
        let progress = self.progress(step, conditions);
        self.set_up(progress, near::around(&self.model.pairs, |slave| &slave.accepted, None))
    }

    /// Where the tools are at the last converged increment.
    fn poses(&self) -> Vec<Pose> {
        self.model.masters.tools.iter().map(|tool| tool.committed).collect()
    }

    /// The conditions of a step that begins at displacements `u` with the contact `forces` on tools at these poses, after what
    /// the `last` step ended with. Collective.
    pub(super) fn conditions(
        &self,
        step: &Step,
        u: &[Vec3],
        last: &Conditions,
        (forces, poses): (&[Vec3], &[Pose]),
    ) -> Result<Conditions> {
        let mut conditions = agree(self.comm, Conditions::new(self.comm, &self.model, step, u, last))?;
        conditions.hand_over(last, forces, poses);
        Ok(conditions)
    }

    /// The next step at its start, where the simulation is.
    pub(super) fn progress(&mut self, step: &Step, conditions: Conditions) -> Progress {
        let frictional = self.model.pairs.iter().any(|p| p.friction > 0.0);
        let contacts = &self.scene.contacts;
        let given = contacts.iter().any(|c| c.penalty.is_some() && !c.method.holds_multipliers());
        let mut ladder = Ladder::new(frictional || given, frictional || self.model.can_flow(), &self.scene.controls);
        ladder.can_soften = !self.model.pairs.is_empty();
        ladder.can_sort = self.model.pairs.iter().any(can_sort);
        ladder.can_center = can_center(&self.model.pairs);
        self.begun += 1;
        Progress {
            serial: self.begun,
            step: step.clone(),
            conditions,
            start: self.state.time,
            before: self.state.u.clone(),
            poses: self.poses(),
            offsets: vec![Vec3::zeros(); 2 * self.model.masters.tools.len()],
            increments: Increments::new(&step.sizes(), step.duration, &self.scene.controls).meeting(step.corners()),
            ladder: match step.dashpots.is_empty() {
                true => ladder,
                false => ladder.without_jumps(),
            },
            past: Vec::new(),
        }
    }

    /// Makes the equations of a step, in which these slave nodes have some of contact. Collective.
    pub(super) fn set_up(&mut self, progress: Progress, near: Near) -> Result<()> {
        let conditions = &progress.conditions;
        let begun = Instant::now();
        let dofs = DofMap::new(self.comm, &self.model, conditions.supports(), &conditions.freedoms(), near);
        let pattern = self.pattern(&dofs)?;
        let set_up_s = begun.elapsed().as_secs_f64();
        let symmetric = conditions.is_symmetric(&self.model);
        let matrix = matrix(self.petsc, &dofs, &pattern, symmetric)?;
        let kind = if symmetric { Factorization::Ldlt } else { Factorization::Lu };
        self.summary.matrix = if symmetric { "symmetric indefinite" } else { "unsymmetric" }.into();
        self.summary.linear_solver = if symmetric { "MUMPS LDL^T, SCOTCH" } else { "MUMPS LU, SCOTCH" }.into();
        let mut snes = Snes::new(self.petsc, matrix, kind)?;
        let linear = self.scene.solver.linear;
        let systems = Systems::new(self.comm, linear, (&dofs, &pattern), symmetric, set_up_s);
        self.summary.count(dofs.total, dofs.total_multipliers, systems.entries as u64);
        // Whatever is near now: the same in all steps.
        let most = dofs.total + dofs.spared;
        let solver = cost::solver(linear, most, self.model.is_plane());
        match solver {
            Linear::Iterative => {
                let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
                snes.iterate(dofs.unknowns(&self.model, place), cost::patience(linear, most))?;
                snes.reuse_factors(cost::least_worth(linear))?;
                self.summary.linear_solver = "FGMRES, multigrid".into();
            }
            Linear::Reuse => snes.reuse_factors(cost::least_worth(linear))?,
            Linear::Direct | Linear::Auto => {}
        }
        let x = Vector::zeros(self.petsc, dofs.count)?;
        let mut frame = Frame { progress, dofs, pattern, hangs: false, plain: None };
        frame.hangs = self.hangs(&frame);
        let (is_blind, before) = (solver == Linear::Iterative, self.summary.linear);
        self.running = Some(Running { frame, snes, x, systems, is_blind, before, told: Told::default() });
        Ok(())
    }

    /// The systems of the step that is under way, with their factors if there has been a need for them.
    pub fn systems(&self) -> Result<Option<Systems>> {
        let Some(Running { systems, snes, .. }) = &self.running else { return Ok(None) };
        Ok(Some(Systems { factors: snes.factors()?, ..*systems }))
    }

    /// Finds the next increment of the step that was begun, in as many attempts as it takes; `None` at the step's end. The
    /// `observer` is told how it goes. Collective.
    ///
    /// # Errors
    /// No convergence at the smallest increment, or what ends a run at once; the state is that of the last converged
    /// increment. An error of the observer.
    pub fn advance(&mut self, observer: &mut Observer) -> Result<Option<Increment>> {
        let Some(mut running) = self.running.take() else { return Ok(None) };
        let outcome = self.seek(&mut running, observer);
        match &outcome {
            Ok(None) => self.state.conditions = running.frame.progress.conditions,
            _ => self.running = Some(running),
        }
        outcome
    }

    fn seek(&mut self, running: &mut Running<'a>, observer: &mut Observer) -> Result<Option<Increment>> {
        let Running { frame, snes, x, .. } = running;
        let frictional = self.model.pairs.iter().any(|p| p.friction > 0.0);
        let duration = frame.progress.step.duration;
        while let Some(end) = frame.progress.increments.next() {
            frame.progress.ladder.settles = frictional && frame.hangs && self.is_held_by_friction(frame);
            let increments = &frame.progress.increments;
            let done = increments.done;
            let outcome = match frame.progress.ladder.way() {
                _ if any(self.comm, interrupt::wished()) => {
                    return Err(ending::by_signal(self.comm, (frame.name(), self.state.time)));
                }
                Way::Newton { .. } => {
                    let limits = frame.progress.step.increment.limits;
                    let share = Share { begin: done, most: increments.most_parts(end), limits };
                    self.attempt(frame, (snes, x), (end, share), 0.0, observer)?
                }
                Way::Jump => self.jump(frame, (snes, x), end, observer)?,
            };
            self.summary.linear = running.before.and(&snes.linear_statistics());
            // Of the last factorization.
            let redundant = snes.linear_statistics().null_pivots;
            match outcome {
                // Whatever the factorization has left out would bear nothing, and friction go on from that. A jump has gone
                // too far to begin anew.
                Attempt::Converged(_)
                    if (redundant > 0 || running.is_blind)
                        && frame.progress.ladder.way() != Way::Jump
                        && self.shares_nodes() =>
                {
                    let reason = "nodes bear several contacts, whose conditions may say what others say";
                    let size = (end - done) * duration;
                    let retried = Retried { step: frame.name(), size, reason, remedy: Remedy::Hold };
                    observer(&Event::Retried(retried))?;
                    self.hold_multipliers(running)?;
                    return self.seek(running, observer);
                }
                Attempt::Converged(converged) => {
                    let increment = self.accept(frame, *converged, x)?;
                    observer(&Event::Increment(&increment))?;
                    let LinearStatistics { null_pivots, unsolved, .. } = snes.linear_statistics();
                    if unsolved > 0 && !std::mem::replace(&mut running.told.unsolved, true) {
                        self.warn(describe::unsolved(frame.name()), observer)?;
                    }
                    if let Some(mean) = snes.impatience()
                        && !std::mem::replace(&mut running.told.impatience, true)
                    {
                        observer(&Event::Detail(&describe::impatience(frame.name(), mean)))?;
                    }
                    if null_pivots > 0 && !std::mem::replace(&mut running.told.null_pivots, true) {
                        let free = self.free_motion(frame, snes)?;
                        let warning = describe::null_pivots(frame.name(), null_pivots, free.as_deref());
                        self.warn(warning, observer)?;
                    }
                    return Ok(Some(increment));
                }
                Attempt::Failed(failed) if failed.extrapolated => {
                    frame.progress.past.clear();
                    observer(&Event::Detail("    again, not ahead of the last state"))?;
                }
                Attempt::Failed(failed) => {
                    if self.retry(frame, failed, duration, observer)? == Remedy::Hold {
                        self.hold_multipliers(running)?;
                        return self.seek(running, observer);
                    }
                }
            }
        }
        Ok(None)
    }

    /// Decides what to do about an increment that failed.
    fn retry(&mut self, frame: &mut Frame, failed: Failed, duration: f64, observer: &mut Observer) -> Result<Remedy> {
        let end = failed.end;
        let done = frame.progress.increments.done;
        let size = (end - done) * duration;
        if let Some(told) = self.runaway(frame, end, false) {
            return Err(Error::Diverged(Box::new(told)));
        }
        let (can_yield, can_hold) = (self.yields(), self.shares_nodes());
        let Progress { increments, ladder, past, .. } = &mut frame.progress;
        let was = (ladder.is_soft(), ladder.is_by_sets());
        let is_remedy = ladder.is_remedy() || ladder.yields() || ladder.is_by_sets() || ladder.way() == Way::Jump;
        (ladder.can_yield, ladder.can_hold) = (can_yield, can_hold);
        let Some(remedy) = ladder.fail(increments, end, failed.cause) else {
            if let Some(told) = self.runaway(frame, end, true) {
                return Err(Error::Diverged(Box::new(told)));
            }
            let plain = frame.plain.take().filter(|_| is_remedy && failed.cause.is_of_remedy());
            let mut told = plain.unwrap_or(failed);
            let size = (told.end - done) * duration;
            let time = frame.progress.start + told.end * duration;
            self.last_iterate = told.last.take().map(|last| Box::new(LastIterate { time, ..*last }));
            return Err(Error::Diverged(Box::new(self.tell_failure(frame, &told, size))));
        };
        if (ladder.is_soft(), ladder.is_by_sets()) != was {
            // Multipliers are unknowns over the penalty.
            past.clear();
        }
        self.summary.cutbacks += usize::from(remedy == Remedy::Cut);
        observer(&Event::Retried(Retried { step: frame.name(), size, reason: &failed.reason, remedy }))?;
        if !is_remedy {
            frame.plain = Some(failed);
        }
        Ok(remedy)
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

    /// The pattern of a step. Collective.
    fn pattern(&mut self, dofs: &DofMap) -> Result<Pattern> {
        let begun = Instant::now();
        let Model { part, masters, pairs, .. } = &mut self.model;
        masters.follow(self.comm, pairs, |n| part.points[n as usize] + self.state.u[n as usize]);
        let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
        let pattern = Pattern::new(self.comm, &self.model, dofs, place)?;
        self.phases.add(Phase::Assembly, begun.elapsed());
        Ok(pattern)
    }

    /// Tries one increment to fraction `end` of the step, or a share of it. A search that proves too narrow is widened and
    /// the iteration goes on from where it is. All that moves has the `drag` of so much force per length. Collective.
    pub(super) fn attempt(
        &mut self,
        frame: &mut Frame,
        (snes, x): (&mut Snes<'a>, &mut Vector<'a>),
        (end, share): (f64, Share),
        drag: f64,
        observer: &mut Observer,
    ) -> Result<Attempt> {
        self.watch_ahead(frame, end);
        let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
        snes.place(|| frame.dofs.unknowns(&self.model, place).nodes);
        let max_iterations = self.scene.solver.max_iterations;
        let name = frame.progress.step.name.value.clone();
        let increment = self.state.increments + 1;
        let mut watcher = |number, residual, [changes, touching]: [usize; 2]| {
            observer(&Event::Iteration(Iteration { step: &name, increment, number, residual, changes, touching }))
        };
        let controls = self.model.controls;
        let smooth = self.model.can_flow() || self.model.masters.tools.iter().all(|t| !t.surface.faceted);
        let may_extrapolate = controls.extrapolate > usize::from(!smooth);
        let trial = frame.progress.extrapolated(end, controls.extrapolate_farthest).filter(|_| may_extrapolate);
        let extrapolated = trial.is_some();
        let manner = Manner {
            settles: frame.progress.ladder.way() == Way::Newton { settle: true },
            ahead: extrapolated,
            automatic: frame.progress.ladder.is_remedy() || frame.progress.ladder.yields(),
            soft: frame.progress.ladder.is_soft(),
            central: frame.progress.ladder.is_central(),
            yields: frame.progress.ladder.yields(),
            again: frame.progress.ladder.has_failed(),
        };
        let start = Start {
            offsets: &frame.progress.offsets,
            s: end,
            share,
            tolerance: self.scene.solver.tolerance,
            strict: frame.progress.ladder.is_strict(),
            manner,
            max_iterations: max_iterations.min(if drag > 0.0 { controls.jump_iterations } else { usize::MAX }),
            seen: &self.state.seen,
            floors: &self.floors,
        };
        let reach: Vec<f64> = self.model.pairs.iter().map(|p| p.reach).collect();
        let sorted: Vec<usize> = (0..self.model.pairs.len())
            .filter(|p| frame.progress.ladder.is_by_sets() && can_sort(&self.model.pairs[*p]))
            .collect();
        sorted.iter().for_each(|&p| self.model.pairs[p].enforce(Enforcement::Lagrange));
        let system = System {
            comm: self.comm,
            model: &mut self.model,
            dofs: &mut frame.dofs,
            pattern: &mut frame.pattern,
            conditions: &frame.progress.conditions,
            phases: &self.phases,
            start_poses: &frame.progress.poses,
            committed: &self.state.u,
            damped: &self.state.damped,
        };
        let mut newton = Newton::new(system, (&start, &mut watcher));
        newton.set_drag(drag);
        if self.state.increments == 0 {
            newton.begin_with_what_touches(&sorted);
        }
        match trial {
            Some(trial) => newton.start_ahead(&trial, &mut x.array_mut()?),
            None => newton.start_behind(&mut x.array_mut()?),
        }
        // Why there is no solution, if there is none.
        let ended = loop {
            let outcome = snes.solve(x, &mut newton)?;
            self.summary.iterations += outcome.iterations;
            if newton.grows() {
                let (old, unknowns) = newton.grow()?;
                let System { model, dofs, pattern, conditions, .. } = &newton.system;
                let matrix = matrix(self.petsc, dofs, pattern, conditions.is_symmetric(model))?;
                let place = |n: u32| model.part.points[n as usize] + self.state.u[n as usize];
                snes.renew(matrix, || dofs.unknowns(model, place))?;
                *x = Vector::from_slice(self.petsc, &unknowns)?;
                frame.progress.past.iter_mut().for_each(|(_, past)| *past = dofs.carry(&old, past));
                continue;
            }
            let at = (name.as_str(), self.state.time);
            let stopped = newton.course.stopped.take();
            if let Some(error) = stopped.or_else(|| {
                ending::at_once(self.comm, at, (newton.course.interrupted, snes.iterates()), &outcome.reason)
            }) {
                break Err(error);
            }
            if outcome.reason != Reason::Converged {
                let cause = cause(&outcome.reason, newton.course.trace.len() <= 1, controls.singular_residual);
                break Ok(Some((cause, told(&outcome.reason, max_iterations))));
            }
            // Where some node went farther than the search had looked, the iteration goes on.
            newton.course.iterated = 0;
            if newton.widen_search() {
                continue;
            }
            let round = match newton.end_round() {
                Round::Done => newton.tighten(&x.array()?),
                other => other,
            };
            match round {
                Round::Again => {}
                Round::Done => break Ok(newton.unresolved(true).map(|reason| (Cause::Rounding, reason))),
                Round::Failed(reason) => break Ok(Some((Cause::Rounds, reason))),
                Round::Contradicts(reason) => break Ok(Some((Cause::Contradiction, reason))),
            }
        };
        self.summary.outer_iterations += newton.course.rounds.count;
        self.summary.pattern_rebuilds += newton.course.rebuilds;
        self.summary.growths += newton.course.growths;
        if newton.course.rebuilds + newton.course.growths > 0 {
            let System { dofs, pattern, .. } = &newton.system;
            self.summary.count(dofs.total, dofs.total_multipliers, pattern.entries(self.comm));
        }
        let attempt = match ended {
            Err(error) => Err(error),
            Ok(None) => Ok(Attempt::Converged(Box::new(converged(newton, &x.array()?)))),
            Ok(Some((cause, reason))) => Ok(Attempt::Failed(failed(newton, cause, reason, extrapolated))),
        };
        for (pair, reach) in self.model.pairs.iter_mut().zip(reach) {
            pair.reach = reach;
        }
        sorted.into_iter().for_each(|p| self.model.pairs[p].enforce(Enforcement::AugmentedLagrangian));
        let attempt = match self.watched(attempt?, frame.conditions()) {
            Attempt::Converged(converged) if drag == 0.0 => self.still_held(frame, converged),
            attempt => attempt,
        };
        Ok(match attempt {
            Attempt::Converged(converged) => self.turned_little(converged),
            failed => failed,
        })
    }

    /// A converged increment, unless a torque turns a tool by more in it than a prescribed rotation may.
    fn turned_little(&self, converged: Box<Converged>) -> Attempt {
        let tools = &self.model.masters.tools;
        let angles = tools.iter().map(|tool| (tool, (tool.trial.turned - tool.committed.turned).to_degrees()));
        let far = angles.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs())).filter(|(_, a)| a.abs() > Step::TURN);
        match far.map(|(tool, angle)| (&tool.name, angle)) {
            None => Attempt::Converged(converged),
            Some((name, angle)) => {
                let most = Step::TURN;
                let reason =
                    format!("the tool `{name}` spins: its torque turns it by {angle:.0} degrees, of {most} at most,");
                Attempt::Failed(converged.refused(Cause::Loose, reason))
            }
        }
    }

    /// Fetches the patches that the slave nodes may meet in the increment to `end`. Collective.
    pub(super) fn watch_ahead(&mut self, frame: &Frame, end: f64) {
        if self.model.is_alone() {
            return;
        }
        let begun = Instant::now();
        let Model { part, masters, pairs, .. } = &mut self.model;
        let Progress { conditions, poses, offsets, .. } = &frame.progress;
        conditions.place_tools(&mut masters.tools, poses, offsets, end);
        masters.attend(self.comm, pairs, |n| part.points[n as usize] + self.state.u[n as usize]);
        self.phases.add(Phase::Search, begun.elapsed());
    }

    /// Makes a converged increment the state. Collective.
    ///
    /// # Errors
    /// An element that cannot follow; the state is then what it was.
    pub(super) fn commit(&mut self, frame: &mut Frame, converged: &Converged) -> Result<()> {
        let flown = agree(self.comm, states::flown(&mut self.model, &converged.u))?;
        self.model.history.accept(flown);
        for tool in &mut self.model.masters.tools {
            tool.committed = tool.trial;
        }
        let Model { part, masters, pairs, joints, .. } = &mut self.model;
        for (joint, forces) in joints.iter_mut().zip(&converged.tie_forces) {
            joint.slaves.iter_mut().zip(forces).for_each(|(slave, force)| slave.force = *force);
        }
        for (pair, multipliers) in pairs.iter_mut().zip(&converged.multipliers) {
            let ground = masters.of(pair.master);
            for (slave, multiplier) in pair.slaves.iter_mut().zip(multipliers) {
                let node = slave.node as usize;
                slave.commit(pair.method, *multiplier, &ground, &(part.points[node] + converged.u[node]));
            }
        }
        frame.progress.offsets.clone_from(&converged.offsets);
        self.state.u.clone_from(&converged.u);
        self.model.turn_slaves(&self.state.u);
        self.model.follow_sheets(self.comm, &self.state.u);
        self.state.reactions.clone_from(&converged.forces);
        self.state.damped.clone_from(&converged.damped);
        self.state.tool_forces.clone_from(&converged.tool_forces);
        Ok(())
    }

    /// Makes a converged increment the state, and says what it was. Collective.
    fn accept(&mut self, frame: &mut Frame, converged: Converged, x: &Vector) -> Result<Increment> {
        let busy = self.is_busy();
        let Progress { increments, ladder, past, step, start, .. } = &mut frame.progress;
        let is_remedy = ladder.is_remedy();
        let found = ladder.succeed();
        let end = converged.end;
        let iterations = converged.trace.len() - 1;
        let size = (end - increments.done) * step.duration;
        let time = *start + end * step.duration;
        increments.accept(end, iterations.div_ceil(1 + converged.rounds), busy);
        if found.way == Way::Jump {
            increments.resume();
        }
        let ends_step = increments.next().is_none();
        // Where a table turns, the solution does not go on as before.
        if is_remedy || increments.is_at_corner() {
            past.clear();
        }
        if !is_remedy {
            frame.progress.remember(end, &x.array()?);
        }
        self.commit(frame, &converged)?;
        // Not those that a drag has balanced on the way.
        self.state.seen = converged.seen;
        frame.plain = None;
        self.state.time = time;
        self.state.increments += 1;
        self.note_touches(&converged.between);
        self.summary.increments += 1;
        self.note_rounded(converged.rounded.as_ref());
        let [touching, slipping, calmed] = self.count(converged.calmed.len());
        let calmed_node = first_word(self.comm, converged.calmed.first().map(|&n| node_name(&self.model, n)));
        Ok(Increment {
            step: frame.name().to_string(),
            number: self.state.increments,
            time,
            size,
            iterations,
            rounds: converged.rounds,
            residuals: converged.trace,
            changes: converged.changes,
            limit: converged.limit,
            rounded: converged.rounded,
            way: found.way,
            failures: found.failures,
            touching,
            slipping,
            calmed,
            calmed_node,
            ends_step,
        })
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

    /// Slave nodes of all ranks that touch, slip, and were calmed. Collective.
    fn count(&self, calmed: usize) -> [usize; 3] {
        let mut counts = [0.0, 0.0, calmed as f64];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            counts[0] += f64::from(slave.trial.status != Status::Gap);
            counts[1] += f64::from(slave.trial.status == Status::Slip && slave.law.friction > 0.0);
        }
        sum(self.comm, &mut counts);
        counts.map(|count| count as usize)
    }

    /// Names the worst equation of all ranks, and what to try. Collective.
    fn tell_failure(&self, frame: &Frame, failed: &Failed, size: f64) -> Failure {
        let worst = failed.worst.filter(|_| frame.dofs.count > 0);
        let told = word_of_largest(self.comm, worst, |equation| frame.dofs.describe(&self.model, equation));
        let node = |equation| frame.dofs.place(&self.model, equation).map_or(String::new(), |place| place.to_line());
        let place = word_of_largest(self.comm, worst, node).and_then(|(line, _)| Place::from_line(&line));
        let (word, residual) = told.unzip();
        let linear = failed.cause.is_linear() || failed.cause == Cause::Contradiction;
        let conditioning = linear.then(|| conditioning::reason(self.comm, &self.model)).flatten();
        let failure = Failure {
            cause: failed.cause,
            step: frame.name().to_string(),
            time: self.state.time,
            size,
            place,
            residual: residual.unwrap_or(0.0),
            changes: failed.changes.last().copied().unwrap_or(0),
            what: String::new(),
        };
        let body = failure.place.as_ref().map(|place| place.body.as_str());
        let remedies = suspects::remedies(self.comm, self.scene, &self.model, (failure.cause, body));
        let Progress { increments, ladder, .. } = &frame.progress;
        let smallest = !ladder.jumps_on() || increments.is_shortest(failed.end);
        let what = describe::failure(
            &failure,
            &failed.reason,
            (conditioning.as_deref(), word.as_deref()),
            &remedies,
            smallest,
        );
        Failure { what, ..failure }
    }
}

/// Whether active sets can have the place of the augmented Lagrangian.
fn can_sort(pair: &Pair) -> bool {
    pair.method == Enforcement::AugmentedLagrangian && !pair.is_self()
}

/// Whether contacts may be sought along the central path: two tools press on a body, and all have smooth forces there.
fn can_center(pairs: &[Pair]) -> bool {
    let other =
        |pair: &Pair, tool| pairs.iter().any(|p| p.body == pair.body && p.master.tool().is_some_and(|t| t != tool));
    let is_between = |pair: &Pair| pair.master.tool().is_some_and(|tool| other(pair, tool));
    pairs.iter().all(Pair::is_smooth) && pairs.iter().any(is_between)
}

/// The matrix of a step, with zeros. Collective.
fn matrix<'a>(petsc: &'a Petsc<'a>, dofs: &DofMap, pattern: &Pattern, symmetric: bool) -> Result<Matrix<'a>> {
    let values = vec![0.0; pattern.columns.len()];
    let mut matrix = Matrix::from_csr(petsc, dofs.count, &pattern.offsets, &pattern.columns, &values)?;
    matrix.set_symmetric(symmetric)?;
    Ok(matrix)
}

/// What is kept of a converged iterate.
fn converged(newton: Newton, x: &[f64]) -> Converged {
    let (multipliers, limits, limit) = (newton.multipliers(x), newton.limits(), newton.limit());
    let rounded = newton.rounded();
    let (tie_forces, damped) = (newton.tie_forces(x), newton.damped());
    let Newton { s: end, found, course, .. } = newton;
    Converged {
        end,
        seen: found.balance.accepted(),
        u: found.u,
        forces: found.forces,
        damped,
        tool_forces: found.tool_forces,
        offsets: found.offsets,
        multipliers,
        tie_forces,
        limits,
        between: Vec::new(),
        limit,
        rounded,
        trace: course.trace,
        changes: course.changes,
        calmed: course.calmed,
        rounds: course.rounds.count + course.rounds.tightened,
    }
}

/// What is told of an iterate that is no solution.
fn failed(newton: Newton, cause: Cause, reason: String, extrapolated: bool) -> Failed {
    let (cause, reason) = match newton.unresolved(false) {
        Some(lost) => (Cause::Rounding, lost),
        None => (cause, reason),
    };
    let last = Some(Box::new(LastIterate::of(&newton)));
    let Newton { s: end, found, course, .. } = newton;
    Failed { end, cause, reason, extrapolated, worst: Some(found.worst), changes: course.changes, last }
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
