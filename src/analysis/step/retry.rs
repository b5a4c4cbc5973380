//! What becomes of an increment that has failed: how it is tried again, or what is told of it.

use super::super::describe::Last;
use super::super::ladder::{Way, Yields};
use super::super::last_iterate::LastIterate;
use super::super::newton::Lost;
use super::super::state::Progress;
use super::super::{Event, Observer, Remedy, Retried, Simulation, conditioning, describe, suspects, watch};
use super::Frame;
use super::attempt::Failed;
use crate::contact::{Pair, Status};
use crate::error::{Error, Result};
use crate::failure::{Cause, Failure, Place};
use crate::parallel::{any, word_of_largest};
use mpi::topology::SimpleCommunicator;

/// Whether an increment fails for its shortness: rounding leaves too much of what it adds to the state at `done`, but not of what
/// a longer one would have added, which failed for another reason.
fn is_of_cuts(failed: &Failed, longer: &Failed, done: f64) -> bool {
    let is_little = |lost: Lost| lost.0 * (failed.end - done) <= longer.end - done;
    longer.cause.is_of_iteration() && failed.lost.is_some_and(is_little)
}

impl Simulation<'_> {
    /// Decides what to do about an increment that failed.
    pub(super) fn retry(
        &mut self,
        frame: &mut Frame,
        failed: Failed,
        duration: f64,
        observer: &mut Observer,
    ) -> Result<Remedy> {
        frame.failures += 1;
        let end = failed.end;
        let done = frame.progress.increments.done;
        let size = (end - done) * duration;
        if let Some(told) = self.runaway(frame, [done, end], false) {
            return Err(Error::Diverged(Box::new(told)));
        }
        /// Far enough below what may be lost; the solution does not depend on it.
        const BELOW: f64 = 2.0;
        if let Some(Lost(times)) = failed.lost.filter(|_| failed.cause == Cause::Rounding)
            && self.model.pairs.iter_mut().map(|pair| usize::from(pair.ease(BELOW * times))).sum::<usize>() > 0
        {
            let remedy = Remedy::Ease;
            observer(&Event::Retried(Retried { step: frame.name(), size, reason: &failed.reason, remedy }))?;
            return Ok(remedy);
        }
        let (can_yield, can_hold) = (self.yields(), self.shares_nodes(frame.conditions()));
        frame.progress.ladder.lets_go = frame.hangs && lets_go(self.comm, &self.model.pairs);
        frame.progress.ladder.turns = failed.turns;
        let Progress { increments, ladder, past, .. } = &mut frame.progress;
        let was = (ladder.is_soft(), ladder.is_by_sets());
        let is_other =
            ladder.yields() || ladder.is_by_sets() || ladder.glides() || ladder.lingers() || ladder.way() == Way::Jump;
        let is_remedy = ladder.is_remedy() || is_other;
        ladder.note(can_yield, can_hold);
        let Some(remedy) = ladder.fail(increments, end, failed.cause) else {
            // What the watch has refused was in equilibrium.
            if failed.cause != Cause::Watch
                && let Some(told) = self.runaway(frame, [done, end], true)
            {
                return Err(Error::Diverged(Box::new(told)));
            }
            let of_remedy = is_remedy && failed.cause.is_of_remedy();
            let plain = frame.plain.take().filter(|plain| of_remedy || is_of_cuts(&failed, plain, done));
            let lost = Some(failed.reason.clone()).filter(|_| plain.is_some() && failed.cause == Cause::Rounding);
            let mut told = plain.unwrap_or(failed);
            let sizes = [(told.end - done) * duration, size];
            let time = frame.progress.start + told.end * duration;
            self.last_iterate = told.last.take().map(|last| Box::new(LastIterate { time, ..*last }));
            return Err(Error::Diverged(Box::new(self.tell_failure(frame, &told, sizes, lost.as_deref()))));
        };
        if (ladder.is_soft(), ladder.is_by_sets()) != was {
            // Multipliers are unknowns over the penalty.
            past.clear();
        }
        self.summary.counts.cutbacks += usize::from(remedy == Remedy::Cut);
        observer(&Event::Retried(Retried { step: frame.name(), size, reason: &failed.reason, remedy }))?;
        if !is_remedy && !frame.plain.as_ref().is_some_and(|plain| is_of_cuts(&failed, plain, done)) {
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

    /// Names the worst equation of all ranks, and what to try, where an increment of a `size` has failed, and one of the `least` was
    /// tried last; `lost` says why a shorter increment is none. Collective.
    fn tell_failure(&mut self, frame: &Frame, failed: &Failed, [size, least]: [f64; 2], lost: Option<&str>) -> Failure {
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
        let mut remedies = suspects::remedies(self.comm, self.scene, &self.model, (failure.cause, body));
        if failed.cause.is_of_iteration() || frame.hangs {
            // The last iterate has been kept.
            self.model.masters.tools.iter_mut().for_each(|tool| tool.trial = tool.committed);
            watch::attend(self.comm, &mut self.model, &self.state.u);
        }
        if failed.cause.is_of_iteration() {
            remedies.splice(0..0, suspects::hanging(self.comm, &self.model));
            if self.state.increments == 0 {
                remedies.splice(0..0, suspects::overlapping(self.comm, &self.model));
                remedies.splice(0..0, suspects::flush(self.comm, &self.model, &self.state.u));
            }
            remedies.splice(0..0, suspects::hollow(self.comm, &self.model, &self.state.u));
        }
        if frame.hangs {
            let at = (failed.end, &self.state.u[..]);
            let pushed = suspects::pushed(self.comm, &self.model, frame.conditions(), at, &self.unsupported(frame));
            if pushed.is_empty() {
                remedies.extend(suspects::holding(self.comm, &self.model, &self.state.u));
            }
            remedies.extend(pushed);
        }
        let Progress { increments, ladder, .. } = &frame.progress;
        let last = match lost {
            Some(why) => Last::Lost(why),
            None if !ladder.jumps_on() || increments.is_shortest(failed.end) => Last::Smallest(least),
            None => Last::Jumps,
        };
        let what =
            describe::failure(&failure, &failed.reason, (conditioning.as_deref(), word.as_deref()), &remedies, last);
        Failure { what, ..failure }
    }
}

/// Whether some contact touched in the last converged increment, and nowhere where an attempt has ended. Collective.
fn lets_go(comm: &SimpleCommunicator, pairs: &[Pair]) -> bool {
    let before = watch::idle(comm, pairs, |slave| slave.committed.status);
    let now = watch::idle(comm, pairs, |slave| slave.trial.status);
    before.iter().zip(&now).any(|(before, now)| !before && *now)
}
