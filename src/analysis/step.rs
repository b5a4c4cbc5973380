//! One step: its equations, its increments, and what becomes of each.
//!
//! - [`attempt`]: one attempt at an increment
//! - [`accept`]: what becomes of one that has converged
//! - [`retry`]: and of one that has failed
//! - [`stability`]: whether what was found is stable

mod accept;
mod attempt;
mod retry;
mod stability;

use super::conditions::Conditions;
use super::cost::size::Systems;
use super::increments::Increments;
use super::ladder::{Ladder, Means, Way};
use super::newton::Share;
use super::state::Progress;
use super::{Event, Increment, Observer, Remedy, Retried, Simulation, cost, describe, ending};
use crate::Vec3;
use crate::contact::{Interference, Pair, Pose};
use crate::error::Result;
use crate::failure::Cause;
use crate::interrupt;
use crate::model::{Model, elements};
use crate::output::phases::Phase;
use crate::parallel::{agree, any, first_word, word_of_largest};
use crate::scene::{Formulation, Linear, Step};
use crate::system::near::{self, Near};
use crate::system::{DofMap, Pattern};
use attempt::Failed;
pub(super) use attempt::{Attempt, Converged};
use mpi::topology::SimpleCommunicator;
use petsc::{Factorization, LinearStatistics, Matrix, Petsc, Snes, Vector};
use stability::Judged;
use std::time::Instant;

/// A step under way: what stays the same over it, and how far it is.
pub(super) struct Frame {
    pub(super) progress: Progress,
    pub(super) dofs: DofMap,
    pub(super) pattern: Pattern,
    /// Supports alone do not hold every body and force-driven tool.
    pub(super) hangs: bool,
    /// Where stability was judged last.
    judged: Option<Judged>,
    /// A warning has said that the way is not stable; it is not judged any more.
    is_unstable: bool,
    /// Tries at the increment under way that have failed or were refused.
    failures: usize,
    /// Failed increments say more of Newton's method than of its remedies: the last such.
    plain: Option<Failed>,
}

/// The equations of a step, and its solver.
pub(super) struct Running<'a> {
    pub(super) frame: Frame,
    snes: Snes<'a>,
    x: Vector<'a>,
    systems: Systems,
    /// What was done for linear systems before it.
    before: LinearStatistics,
    pub(super) told: Told,
}

/// What of the linear solver has been told of in a step.
#[derive(Default)]
pub(super) struct Told {
    null_pivots: bool,
    folded: bool,
    unsolved: bool,
    out_of_core: bool,
    impatience: bool,
    unpaid: bool,
}

impl Frame {
    pub(super) fn conditions(&self) -> &Conditions {
        &self.progress.conditions
    }

    pub(super) fn name(&self) -> &str {
        &self.progress.step.name.value
    }
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
        self.model.history.rest();
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
        let frictional = self.model.pairs.iter().any(|p| p.rules.friction > 0.0);
        let contacts = &self.scene.contacts;
        let given = contacts.iter().any(|c| c.penalty.is_some() && !c.method.holds_multipliers());
        let jumps = match frictional || self.model.can_flow() {
            // No time goes by in a jump that dashpots could resist.
            _ if !step.dashpots.is_empty() => 0,
            true => self.scene.controls.jump_tries,
            false => usize::MAX,
        };
        let means = Means {
            soften: !self.model.pairs.is_empty(),
            sort: self.model.pairs.iter().any(Pair::can_sort),
            sort_first: self.model.pairs.iter().any(|pair| pair.master.tool().is_none()),
            center: can_center(&self.model.pairs),
            settle: frictional || given,
            // What flows does so on the way, and surfaces that meet themselves have a remedy of their own.
            glide: frictional && !self.model.can_flow() && !self.model.pairs.iter().any(Pair::is_self),
            ramp: self.state.increments == 0 && self.model.pairs.iter().any(|pair| overlaps(self.comm, pair)),
            hold: false,
            jumps,
        };
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
            ladder: Ladder::new(means, &self.scene.controls),
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
        self.summary.systems.matrix = if symmetric { "symmetric indefinite" } else { "unsymmetric" }.into();
        self.summary.systems.solver = if symmetric { "MUMPS LDL^T, SCOTCH" } else { "MUMPS LU, SCOTCH" }.into();
        let mut snes = Snes::new(self.petsc, matrix, kind)?;
        snes.accept(self.model.controls.singular_residual);
        let linear = self.scene.solver.linear;
        let systems = Systems::new(self.comm, linear, (&dofs, &pattern), symmetric, set_up_s);
        self.summary.systems.count(dofs.total, dofs.total_multipliers, systems.entries as u64);
        // Whatever is near now: the same in all steps.
        let most = dofs.total + dofs.spared;
        let solver = cost::solver(linear, most, self.model.is_flat());
        match solver {
            Linear::Iterative => {
                let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
                snes.iterate(dofs.unknowns(&self.model, place), cost::patience(linear, most))?;
                snes.reuse_factors(cost::least_worth(linear))?;
                self.summary.systems.solver = "FGMRES, multigrid".into();
            }
            Linear::Reuse => snes.reuse_factors(cost::least_worth(linear))?,
            Linear::Direct | Linear::Auto => {}
        }
        if let Some(folder) = &self.scratch {
            snes.keep_in(folder);
        }
        let x = Vector::zeros(self.petsc, dofs.count)?;
        let mut frame =
            Frame { progress, dofs, pattern, hangs: false, judged: None, is_unstable: false, failures: 0, plain: None };
        frame.hangs = self.hangs(&frame);
        let before = self.summary.linear;
        self.running = Some(Running { frame, snes, x, systems, before, told: Told::default() });
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
        let Running { frame, snes, x, told, .. } = running;
        let frictional = self.model.pairs.iter().any(|p| p.rules.friction > 0.0);
        let duration = frame.progress.step.duration;
        while let Some(end) = frame.progress.increments.next() {
            frame.progress.ladder.hangs = frame.hangs;
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
            // One negative eigenvalue for each multiplier, and none else, where what was found is stable.
            let multipliers = frame.dofs.total_multipliers as usize;
            let is_unstable =
                matches!(&outcome, Attempt::Converged(converged) if converged.negative.is_not(multipliers));
            let may_be_shorter = frame.progress.ladder.way() != Way::Jump && !frame.progress.increments.is_short(end);
            match outcome {
                // Whatever the factorization has left out would bear nothing, and friction go on from that. A jump has gone
                // too far to begin anew.
                Attempt::Converged(_)
                    if frame.progress.ladder.way() != Way::Jump && self.shares_nodes(frame.conditions()) =>
                {
                    frame.failures += 1;
                    let reason = "conditions of contact say what others say, or may";
                    let size = (end - done) * duration;
                    let retried = Retried { step: frame.name(), size, reason, remedy: Remedy::Hold };
                    observer(&Event::Retried(retried))?;
                    self.hold_multipliers(running)?;
                    return self.seek(running, observer);
                }
                Attempt::Converged(converged) if is_unstable && may_be_shorter => {
                    let reason = "converged to an equilibrium that is not stable".to_string();
                    self.retry(frame, converged.refused(&self.model, Cause::Unstable, reason), duration, observer)?;
                }
                Attempt::Converged(converged) => {
                    let folded = self.folded(&converged);
                    if let Some(element) = folded.as_ref().filter(|_| may_be_shorter && !told.folded) {
                        let reason = format!("{element} has folded over at a node");
                        self.retry(frame, converged.refused(&self.model, Cause::Folded, reason), duration, observer)?;
                        continue;
                    }
                    let unpaid = self.unpaid(frame, &converged)?.filter(|_| !std::mem::replace(&mut told.unpaid, true));
                    let Converged { loose, let_go, unpressed, .. } = &*converged;
                    let is_loose = !unpressed.is_empty() || !loose.is_empty();
                    let (loose, let_go) = (loose.clone(), let_go.clone());
                    let increment = self.accept(frame, *converged, x)?;
                    self.tell_of_loose(frame.name(), (loose, let_go), observer)?;
                    if let Some(unpaid) = unpaid {
                        self.warn(unpaid, observer)?;
                    }
                    if let Some(element) = folded.filter(|_| !std::mem::replace(&mut told.folded, true)) {
                        self.warn(describe::folded(frame.name(), self.state.time, &element), observer)?;
                    }
                    if is_unstable {
                        frame.is_unstable = true;
                        let has_shells = self.model.sections.iter().any(|s| s.element == Formulation::Hex8Shell);
                        self.warn(describe::unstable(frame.name(), self.state.time, has_shells), observer)?;
                    }
                    self.tell_of_strangers(observer)?;
                    observer(&Event::Increment(&increment))?;
                    self.tell_of_solver(frame, (snes, is_loose), told, observer)?;
                    return Ok(Some(increment));
                }
                Attempt::Failed(failed) if failed.extrapolated => {
                    frame.progress.past.clear();
                    observer(&Event::Detail("    again, not ahead of the last state"))?;
                }
                Attempt::Failed(failed) => match self.retry(frame, failed, duration, observer)? {
                    Remedy::Hold => {
                        self.hold_multipliers(running)?;
                        return self.seek(running, observer);
                    }
                    Remedy::Ramp => self.ramp_overlaps(frame.name(), observer)?,
                    _ => {}
                },
            }
        }
        Ok(None)
    }

    /// Says once what nothing holds, in words with the motion that it is free for, if that is not any; in a later step anew of bodies
    /// that something had pressed on until now.
    fn tell_of_loose(
        &mut self,
        step: &str,
        (mut loose, let_go): (Vec<(String, Option<String>)>, Vec<String>),
        observer: &mut Observer,
    ) -> Result<()> {
        let now = self.begun;
        self.notices.loose.retain(|(who, told_in)| *told_in == now || !let_go.contains(who));
        loose.retain(|(who, _)| !let_go.contains(who));
        loose.extend(let_go.into_iter().map(|who| (who, None)));
        for (who, motion) in loose {
            if self.notices.loose.iter().all(|(told, _)| *told != who) {
                self.warn(describe::loose(step, self.state.time, &who, motion.as_deref()), observer)?;
                self.notices.loose.push((who, now));
            }
        }
        Ok(())
    }

    /// Has overlaps of contacts that leave it to the run pushed out over the step. Collective.
    fn ramp_overlaps(&mut self, step: &str, observer: &mut Observer) -> Result<()> {
        let mut told = Vec::new();
        for pair in self.model.pairs.iter_mut().filter(|pair| pair.rules.interference == Interference::Auto) {
            pair.rules.interference = Interference::Ramped;
            let deepest = pair.overlap(self.comm);
            if deepest > pair.controls.no_gap * pair.facet_size {
                told.push(describe::ramped(step, &pair.name, deepest));
            }
        }
        told.into_iter().try_for_each(|told| self.warn(told, observer))
    }

    /// Says what has come to be in each other in the last increment while no contact is between. Collective.
    fn tell_of_strangers(&mut self, observer: &mut Observer) -> Result<()> {
        let begun = Instant::now();
        let mut met = self.notices.strangers.meet(self.comm, &self.model, &self.state.u);
        met.extend(self.state.strays.iter_mut().filter_map(|strays| strays.told.take()));
        self.phases.add(Phase::Watch, begun.elapsed());
        met.into_iter().try_for_each(|met| self.warn(format!("{met} (time {:.6})", self.state.time), observer))
    }

    /// An element that has folded over, in words. Collective.
    fn folded(&self, converged: &Converged) -> Option<String> {
        first_word(self.comm, elements::folded(&self.model, &self.state.u, &converged.u))
    }

    /// Says once in a step what is to be known of its linear systems. Collective.
    fn tell_of_solver(
        &mut self,
        frame: &Frame,
        (snes, is_loose): (&mut Snes, bool),
        told: &mut Told,
        observer: &mut Observer,
    ) -> Result<()> {
        let LinearStatistics { null_pivots, unsolved, out_of_core, .. } = snes.linear_statistics();
        if out_of_core && !std::mem::replace(&mut told.out_of_core, true) {
            self.summary.systems.solver += ", factors in files";
            observer(&Event::Detail(&describe::out_of_core(frame.name())))?;
        }
        if unsolved > 0 && !std::mem::replace(&mut told.unsolved, true) {
            self.warn(describe::unsolved(frame.name()), observer)?;
        }
        if let Some(mean) = snes.impatience()
            && !std::mem::replace(&mut told.impatience, true)
        {
            observer(&Event::Detail(&describe::impatience(frame.name(), mean)))?;
        }
        // Of what is loose it is known.
        if null_pivots > 0 && !is_loose && !std::mem::replace(&mut told.null_pivots, true) {
            let free = self.free_motion(frame, snes)?;
            let warning = describe::null_pivots(frame.name(), null_pivots, free.as_deref());
            self.warn(warning, observer)?;
        }
        Ok(())
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
}

/// Whether a contact that leaves it to the run begins with an overlap by more than the shape of bodies is known to. Collective.
fn overlaps(comm: &SimpleCommunicator, pair: &Pair) -> bool {
    pair.rules.interference == Interference::Auto && pair.overlap(comm) > pair.controls.watch_deep * pair.facet_size
}

/// Whether contacts may be sought along the central path: two tools press on a body, or bodies on each other, and all contacts
/// have smooth forces there.
fn can_center(pairs: &[Pair]) -> bool {
    let is_other = |a: &Pair, b: &Pair| a.side.body == b.side.body && a.master.tool() != b.master.tool();
    let is_between = |pair: &Pair| pair.master.tool().is_none() || pairs.iter().any(|other| is_other(pair, other));
    pairs.iter().all(Pair::is_smooth) && pairs.iter().any(is_between)
}

/// The matrix of a step, with zeros. Collective.
fn matrix<'a>(petsc: &'a Petsc<'a>, dofs: &DofMap, pattern: &Pattern, symmetric: bool) -> Result<Matrix<'a>> {
    let values = vec![0.0; pattern.columns.len()];
    let mut matrix = Matrix::from_csr(petsc, dofs.count, &pattern.offsets, &pattern.columns, &values)?;
    matrix.set_symmetric(symmetric)?;
    Ok(matrix)
}
