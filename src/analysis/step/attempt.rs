//! One attempt at an increment: Newton's method, as it is to be sought, and what becomes of what it ends with.

use super::super::between::Between;
use super::super::ending;
use super::super::last_iterate::LastIterate;
use super::super::newton::drag::Kind;
use super::super::newton::{Lost, Newton, Round, Share, Start, System};
use super::super::preflight::rigid::Free;
use super::super::state::Progress;
use super::super::strays::Strays;
use super::super::{Event, Iteration, Observer, Rounded, Simulation};
use super::{Frame, matrix, stability};
use crate::Vec3;
use crate::error::Result;
use crate::failure::Cause;
use crate::model::Model;
use crate::output::phases::Phase;
use crate::output::summary::Summary;
use crate::scene::{Enforcement, Step};
use petsc::{LinearFailure, Negative, Petsc, Reason, Snes, Vector};
use std::ops::ControlFlow;
use std::time::Instant;

/// A converged increment, before it is accepted.
pub struct Converged {
    /// Fraction of the step.
    pub end: f64,
    pub u: Vec<Vec3>,
    pub forces: Forces,
    pub offsets: Vec<Vec3>,
    pub seen: Vec<f64>,
    /// Residual that is let through at each contact, N.
    pub limits: Vec<f64>,
    /// Of each pair how deep its master is between nodes, as the watch saw it.
    pub between: Vec<Between>,
    /// What pushes nodes aside of each contact, N.
    pub aside: Vec<f64>,
    /// Bodies that nothing holds, and that stay where they were, in words, with the motion that is free if that is not any.
    pub loose: Vec<(String, Option<String>)>,
    /// Bodies that supports do not hold and nothing presses on, and those of them that something did before, in words.
    pub unpressed: Vec<Free>,
    pub let_go: Vec<String>,
    /// What it saw of nodes that no contact names.
    pub strays: Vec<Strays>,
    /// How many eigenvalues of the tangent are negative.
    pub negative: Negative,
    pub effort: Effort,
}

/// Forces of a converged increment, as [`Evaluated`](crate::analysis::newton::Evaluated) has those of nodes and tools.
pub struct Forces {
    pub nodes: Vec<Vec3>,
    pub loads: Vec<Vec3>,
    pub dashpots: Vec<Vec3>,
    pub tools: Vec<Vec3>,
    /// Multipliers of the slave nodes of each pair, and of each tie.
    pub contacts: Vec<Vec<Vec3>>,
    pub ties: Vec<Vec<Vec3>>,
}

/// What a converged increment has taken.
pub struct Effort {
    pub residuals: Vec<f64>,
    pub changes: Vec<usize>,
    pub rounds: usize,
    pub calmed: Vec<u32>,
    /// The residual that comes nearest to what is let through there, and that, over the forces that they count against.
    pub residual: f64,
    pub limit: f64,
    pub rounded: Option<Rounded>,
}

impl Converged {
    /// Why it is not accepted, while the model is still as it is in it.
    pub fn refused(self, model: &Model, cause: Cause, reason: String) -> Failed {
        let Self { end, u, effort: Effort { changes, .. }, .. } = self;
        let last = Some(Box::new(LastIterate::refused(model, u)));
        Failed { end, cause, reason, extrapolated: false, turns: false, worst: None, changes, last, lost: None }
    }
}

/// How an attempt at an increment ended.
pub enum Attempt {
    Converged(Box<Converged>),
    Failed(Failed),
}

/// An attempt that did not converge.
pub struct Failed {
    /// Fraction of the step at the end of the increment.
    pub end: f64,
    pub cause: Cause,
    pub reason: String,
    /// The iteration began from an extrapolation; the same increment may do from the converged state.
    pub extrapolated: bool,
    /// Prescribed nodes turn a part of a body as one.
    pub turns: bool,
    /// The worst equation of this rank, with its residual, where balance was not found.
    pub worst: Option<(usize, f64)>,
    pub changes: Vec<usize>,
    /// Where the iteration ended.
    pub last: Option<Box<LastIterate>>,
    /// What rounding leaves of forces, where it fails for that.
    pub lost: Option<Lost>,
}

impl<'a> Simulation<'a> {
    /// Tries one increment to fraction `end` of the step, or a share of it. All that moves has the `drag` of so much force per
    /// length. Collective.
    pub(in super::super) fn attempt(
        &mut self,
        frame: &mut Frame,
        solver: (&mut Snes<'a>, &mut Vector<'a>),
        goal: (f64, Share),
        drag: f64,
        observer: &mut Observer,
    ) -> Result<Attempt> {
        self.watch_ahead(frame, goal.0);
        let reach: Vec<f64> = self.model.pairs.iter().map(|p| p.reach).collect();
        let sorted: Vec<usize> = (0..self.model.pairs.len())
            .filter(|p| frame.progress.ladder.is_by_sets() && self.model.pairs[*p].can_sort())
            .collect();
        sorted.iter().for_each(|&p| self.model.pairs[p].enforce(Enforcement::Lagrange));
        let attempt = self.iterate(frame, solver, goal, (drag, &sorted), observer);
        // Whatever it ended with.
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

    /// Newton's method to the end of an increment, with pairs that are `sorted` by active sets. A search that proves too narrow
    /// is widened and the iteration goes on from where it is. Collective.
    fn iterate(
        &mut self,
        frame: &mut Frame,
        (snes, x): (&mut Snes<'a>, &mut Vector<'a>),
        (end, share): (f64, Share),
        (drag, sorted): (f64, &[usize]),
        observer: &mut Observer,
    ) -> Result<Attempt> {
        let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
        snes.place(|| frame.dofs.unknowns(&self.model, place).nodes);
        let max_iterations = self.scene.solver.max_iterations;
        let name = frame.progress.step.name.value.clone();
        let increment = self.state.increments + 1;
        let mut watcher = |number, residual, [changes, touching]: [usize; 2]| {
            observer(&Event::Iteration(Iteration { step: &name, increment, number, residual, changes, touching }))
        };
        let controls = self.model.controls;
        let carries = frame.progress.ladder.carries();
        let smooth = self.model.can_flow() || self.model.masters.tools.iter().all(|t| !t.surface.faceted);
        let lingers = frame.progress.ladder.lingers() && drag == 0.0;
        // What is loose would go on.
        let may_extrapolate = controls.extrapolate > usize::from(!smooth) && !lingers && !carries;
        let trial = frame.progress.extrapolated(end, controls.extrapolate_farthest).filter(|_| may_extrapolate);
        let extrapolated = trial.is_some();
        let Progress { conditions, poses, offsets, ladder, past, .. } = &mut frame.progress;
        let start = Start {
            offsets,
            s: end,
            share,
            tolerance: self.scene.solver.tolerance,
            strict: ladder.is_strict(),
            manner: ladder.manner(extrapolated),
            max_iterations: max_iterations.min(if drag > 0.0 { controls.jump_iterations } else { usize::MAX }),
            seen: &self.state.seen,
            floors: &self.floors,
            least: self.scene.solver.force_floor.as_ref().map_or(0.0, |floor| floor.value),
        };
        let system = System {
            comm: self.comm,
            model: &mut self.model,
            dofs: &mut frame.dofs,
            pattern: &mut frame.pattern,
            conditions,
            phases: &self.phases,
            start_poses: poses,
            committed: &self.state.u,
            damped: &self.state.damped,
        };
        let mut newton = Newton::new(system, (&start, &mut watcher));
        newton.set_drag(match drag {
            0.0 if lingers => Kind::Each(controls.linger, 1),
            0.0 => Kind::Nothing,
            drag => Kind::All(drag),
        });
        if self.state.increments == 0 {
            newton.begin_with_what_touches(sorted);
        }
        match trial {
            Some(trial) => newton.start_ahead(&trial, &mut x.array_mut()?),
            None if carries => newton.start_carried(&mut x.array_mut()?),
            None => newton.start_behind(&mut x.array_mut()?),
        }
        // It may converge without any system.
        snes.forget_pivots();
        let rough = snes.linear_statistics().rough;
        let ended = loop {
            let outcome = snes.solve(x, &mut newton)?;
            self.summary.counts.iterations += outcome.iterations;
            if newton.grows() {
                grow(self.petsc, &mut newton, (snes, x), past)?;
                continue;
            }
            let (at, stopped) = ((name.as_str(), self.state.time), newton.course.stopped.take());
            if let Some(error) = stopped.or_else(|| {
                ending::at_once(self.comm, at, (newton.course.interrupted, snes.iterates()), &outcome.reason)
            }) {
                break Err(error);
            }
            let is_accurate = snes.linear_statistics().rough == rough;
            let ControlFlow::Break(end) = judge(&mut newton, (&outcome.reason, is_accurate), x, max_iterations)? else {
                continue;
            };
            if end.is_some() || !lingers {
                break Ok(end);
            }
            if newton.stands_without_drag(&x.array()?) {
                break Ok(newton.unresolved(true).map(of_rounding));
            }
            if !newton.drags() {
                break Ok(Some((Cause::Loose, None, FALLS.to_string())));
            }
            newton.judge_again();
        };
        note(&mut self.summary, &newton);
        Ok(match ended? {
            None => {
                let negative = match drag {
                    0.0 if !frame.is_unstable => {
                        stability::negative(&mut newton, snes, frame.hangs, &mut frame.judged)?
                    }
                    _ => Negative::Unknown,
                };
                Attempt::Converged(Box::new(converged(newton, &x.array()?, negative)))
            }
            Some(why) => Attempt::Failed(failed(newton, why, extrapolated)),
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
                Attempt::Failed(converged.refused(&self.model, Cause::Loose, reason))
            }
        }
    }

    /// Fetches the patches that the slave nodes may meet in the increment to `end`. Collective.
    pub(in super::super) fn watch_ahead(&mut self, frame: &Frame, end: f64) {
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
}

impl Progress {
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

/// Gives the equations to slave nodes that the iteration has stopped for. Collective.
fn grow<'a>(
    petsc: &'a Petsc<'a>,
    newton: &mut Newton,
    (snes, x): (&mut Snes<'a>, &mut Vector<'a>),
    past: &mut [(f64, Vec<f64>)],
) -> Result<()> {
    let (old, unknowns) = newton.grow()?;
    let System { model, dofs, pattern, conditions, committed, .. } = &newton.system;
    let matrix = matrix(petsc, dofs, pattern, conditions.is_symmetric(model))?;
    let place = |n: u32| model.part.points[n as usize] + committed[n as usize];
    snes.renew(matrix, || dofs.unknowns(model, place))?;
    *x = Vector::from_slice(petsc, &unknowns)?;
    past.iter_mut().for_each(|(_, past)| *past = dofs.carry(&old, past));
    Ok(())
}

/// Whether the iteration goes on after Newton's method has ended for a reason; if not, why there is no solution, if there is
/// none; `is_accurate` if no linear solution of the attempt was rough. Collective.
fn judge(
    newton: &mut Newton,
    (reason, is_accurate): (&Reason, bool),
    x: &Vector,
    max_iterations: usize,
) -> Result<ControlFlow<Ended>> {
    if *reason != Reason::Converged {
        let singular_residual = newton.system.model.controls.singular_residual;
        let cause = cause((reason, is_accurate), newton.course.trace.len() <= 1, singular_residual);
        return Ok(ControlFlow::Break(Some((cause, None, told(reason, max_iterations)))));
    }
    newton.course.iterated = 0;
    // Where some node went farther than the search had looked, the iteration goes on.
    if newton.widen_search() {
        return Ok(ControlFlow::Continue(()));
    }
    let round = match newton.end_round() {
        Round::Done => newton.tighten(&x.array()?),
        other => other,
    };
    Ok(match round {
        Round::Again => ControlFlow::Continue(()),
        Round::Done => ControlFlow::Break(newton.unresolved(true).map(of_rounding)),
        Round::Failed(reason) => ControlFlow::Break(Some((Cause::Rounds, None, reason))),
        Round::Contradicts(reason) => ControlFlow::Break(Some((Cause::Contradiction, None, reason))),
    })
}

/// Why what lingers is no solution.
const FALLS: &str = "what comes loose stays in place only while something keeps it there,";

/// Why there is no solution: what rounding has lost, and all of it in words.
type Why = (Cause, Option<Lost>, String);

/// The same, if there is none.
type Ended = Option<Why>;

fn of_rounding((lost, reason): (Lost, String)) -> Why {
    (Cause::Rounding, Some(lost), reason)
}

/// Counts what an attempt has taken. Collective.
fn note(summary: &mut Summary, newton: &Newton) {
    let Newton { system: System { comm, dofs, pattern, .. }, course, .. } = newton;
    summary.counts.outer_iterations += course.rounds.count;
    summary.counts.pattern_rebuilds += course.rebuilds;
    summary.counts.growths += course.growths;
    if course.rebuilds + course.growths > 0 {
        summary.systems.count(dofs.total, dofs.total_multipliers, pattern.entries(comm));
    }
}

/// What is kept of a converged iterate.
fn converged(mut newton: Newton, x: &[f64], negative: Negative) -> Converged {
    let (limits, [residual, limit], rounded) = (newton.limits(), newton.nearest_to_its_limit(), newton.rounded());
    let (contacts, ties, dashpots) = (newton.multipliers(x), newton.tie_forces(x), newton.damped());
    let (seen, loads) = (newton.found.balance.accepted(), newton.loads());
    let Newton { s: end, found, course, .. } = newton;
    let rounds = course.rounds.count + course.rounds.tightened;
    Converged {
        end,
        seen,
        u: found.u,
        forces: Forces { nodes: found.forces, loads, dashpots, tools: found.tool_forces, contacts, ties },
        offsets: found.offsets,
        limits,
        between: Vec::new(),
        aside: Vec::new(),
        loose: Vec::new(),
        unpressed: Vec::new(),
        let_go: Vec::new(),
        strays: Vec::new(),
        negative,
        effort: Effort {
            residuals: course.trace,
            changes: course.changes,
            rounds,
            calmed: course.calmed,
            residual,
            limit,
            rounded,
        },
    }
}

/// What is told of an iterate that is no solution.
fn failed(newton: Newton, why: Why, extrapolated: bool) -> Failed {
    let (cause, lost, reason) = newton.unresolved(false).map_or(why, of_rounding);
    let (last, turns) = (Some(Box::new(LastIterate::of(&newton))), newton.turns());
    let Newton { s: end, found, course, .. } = newton;
    Failed { end, cause, reason, extrapolated, turns, worst: Some(found.worst), changes: course.changes, last, lost }
}

/// Why Newton's method ended without convergence. There are equations that determine nothing where MUMPS found them, or what
/// it solved is no solution, or nearly none.
fn cause((reason, is_accurate): (&Reason, bool), at_once: bool, singular_residual: f64) -> Cause {
    let singular = match reason {
        Reason::Linear(LinearFailure::Singular(..)) => true,
        Reason::Linear(LinearFailure::Inaccurate { relative_residual, null_pivots }) => {
            *null_pivots > 0 || *relative_residual > singular_residual
        }
        _ if is_accurate => return Cause::Iteration,
        _ => false,
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
