//! What is tried, in which order, when an increment does not converge.
//!
//! 1. Newton's method from the extrapolation of the last increments, where there is one, then from the converged state.
//!    Where prescribed nodes turn a part of a body, and that fails, all of it is carried along in the first iteration, in the rest of
//!    the step, too, if that helps.
//! 2. Where the matrix is singular, a tool may have gone away from a body that only loads press on it, and all nodes have let
//!    go: then what touches goes along with its master in the first iteration, in the rest of the step, too, if that helps.
//!
//!    Where multipliers are unknowns, several may make the same condition.
//!
//!    Where nodes touch several masters, one of them with friction, or cannot give way to a tool that is driven, the
//!    multipliers of these contacts are held from then on, by Uzawa's method, and no unknowns: penalties share out what a node
//!    gets of each. A block that is pushed into a corner of three planes with friction takes some 15 iterations an increment
//!    then; with constraints that give way it is cut without end, or comes out unlike in directions that are alike. So it is,
//!    too, where Newton's method fails, if not in an increment that is cut first, and where it has converged to such nodes of
//!    several masters, or that cannot give way to a driven tool: rounding would give all to one of them.
//!
//!    Where rounding leaves too much of forces then, penalties of held multipliers are lowered by as much first.
//!
//!    Elsewhere constraints give way until they are tightened. Once that has helped, it is the way of the step. In
//!    self-contact, where they give way always, by more, and wherever an increment has failed: nodes that almost meet send
//!    each other to and fro.
//!    Where friction alone holds a body, and all of it slips, equilibrium does not say where it is: friction grows a little with
//!    slip then, and in the rest of the step if that has helped.
//!    Where a body comes loose, as when a tool that has pressed it is lifted, what it rested on no longer says where it is: it goes
//!    along with whatever the iteration let go last. So it *lingers*, on springs that end: it stays on what it rested on.
//! 3. The same in shorter increments, by turns with contacts that *settle*: what touches sticks until all is nearly in
//!    balance, for a few iterations at most, and slips only then; with the automatic penalty, too, where another one is
//!    given. Where friction alone holds a body, an iteration that lets all slip at once, as far as the tool has moved,
//!    leaves the body without stiffness and behind; so there every increment settles first, and one that does not is what is
//!    tried by turns.
//!    Before an increment is cut for the first time it is tried with *soft* contacts, whose penalties are lower, from then on by
//!    turns; what has helped is kept. Penalties come from the stiffness around a node, and a slender body, a sheet or a hook, is
//!    far softer in bending: there an iteration leaves gaps that outweigh the force, the node lets go, and comes back. Where
//!    contacts slide with friction lower penalties are slower. The solution does not depend on them.
//!    What that does not help, though the increment before it converged, is cut once: the small cup takes 1656 iterations so,
//!    and 4352 where it is not. What fails again, or follows none that converged, is tried along the *central path*, on which
//!    forces of contacts grow smoothly before gaps are closed: a sheet between two tools, or one that lies on another, may touch
//!    in so many ways that the iteration goes to and fro between them. Penalties are lower there, for what gives way there is
//!    bending; where that fails, it is tried once more with those that were given, and residuals that fall in each iteration.
//!    And it is tried by active *sets*, that stand still until Newton's method has converged: where a sheet
//!    lies on a sheet, nodes that bear nothing touch all the same, and each rotation of an iteration sends some of them to and
//!    fro. There sets come first, for they take a third of the iterations of the path. They have the unknowns and the solution
//!    of the augmented Lagrangian; what has helped is kept.
//!    Where nothing has converged yet and bodies overlap, the first increment is to push that out however short it is: what fails so,
//!    with both kinds of penalties, is sought with overlaps that are *ramped*, over the step.
//!    Where nothing has converged yet and some contact has friction, what begins to touch *glides* before that: its friction comes
//!    when all is in balance without it. Where much begins to touch at once with no force and is to slip, as a belt around a pulley, the
//!    forces that friction follows are not known otherwise, and the iteration goes to and fro in increments of any length. Where
//!    bodies lie on each other, as in a stack of sheets that is bent, that is tried by active sets, too.
//! 4. A jump, in an increment so short that the tools hardly move in it: friction then follows their way, not that of the
//!    jump. Close to where equilibrium ends little drives a jump, and longer increments are tried, too. So is what the watch refuses
//!    in the shortest increment, where contacts settle: what friction had pushed along lets go.
//!
//! No increment is shorter than the scene's minimum, and a path of little but jumps ends the run; so do jumps that the watch
//! refuses again and again.

use super::event::Remedy;
use super::increments::Increments;
use crate::contact::Manner;
use crate::controls::Controls;
use crate::failure::Cause;
use crate::words::Words;

/// How an increment is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Newton {
        /// What touches sticks until all is nearly in balance.
        settle: bool,
    },
    Jump,
}

/// When constraints of multipliers give way more than they do anyway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Yields {
    /// There are no multipliers that are unknowns.
    Never,
    /// From where the matrix was singular on, if that helps.
    OnceSingular,
    /// In self-contact, in each increment that has failed.
    Anew,
}

impl Yields {
    fn after(self, cause: Cause) -> bool {
        match self {
            Self::Never => false,
            Self::OnceSingular => cause.is_linear(),
            Self::Anew => cause.is_linear() || cause.is_of_iteration(),
        }
    }
}

/// How far the tries at an increment are, and what has helped in those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tries {
    /// When constraints of multipliers give way more than they do anyway.
    can_yield: Yields,
    /// Constraints give way until they are tightened; `None` when it did not help in this increment.
    yields: Option<bool>,
    /// What touches goes along in the first iteration; `None` when it did not help in this increment.
    follows: Option<bool>,
    /// Friction grows a little with slip; `None` when it did not help in this increment.
    creeps: Option<bool>,
    /// What prescribed nodes turn goes along in the first iteration; `None` when it did not help in this increment.
    carries: Option<bool>,
    /// Friction comes when all is in balance without it; `None` when it did not help in this increment.
    glides: Option<bool>,
    /// Weak springs keep in place what comes loose; `None` when it did not help in this increment.
    lingers: Option<bool>,
    way: Way,
    /// Penalties are lower.
    soft: bool,
    /// Active sets stand still while Newton's method runs.
    sets: bool,
    /// Contacts are sought along the central path, and each residual must be below the last on it.
    central: Option<bool>,
    /// Both kinds of penalties were tried in this increment, or in an earlier one, where the lower ones did not help.
    turned: bool,
    /// The same of active sets.
    sorted: bool,
    /// The last increment of the step has converged without the central path.
    goes_on: bool,
    /// Failures in succession.
    failures: usize,
    jumps: Jumps,
}

/// How jumps have gone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Jumps {
    /// Those that have failed.
    failed: usize,
    /// How much of the path was jumped over of late: `jump_weight` for each jump, less one for each increment after it.
    weight: usize,
}

crate::words!(Jumps { failed, weight });

/// What may help in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Means {
    /// Lower penalties: there are contacts.
    pub soften: bool,
    /// Active sets that stand still: some contact has an augmented Lagrangian, whose place they can take.
    pub sort: bool,
    /// These before the central path: bodies lie on each other.
    pub sort_first: bool,
    /// The central path: two tools press on a body, or bodies on each other.
    pub center: bool,
    /// Contacts that settle: some has friction, or a penalty that is not the automatic one.
    pub settle: bool,
    /// Friction that comes later: some contact has friction, nothing flows, and no surface meets itself.
    pub glide: bool,
    /// Overlaps that are pushed out over the step: nothing has converged yet, and some contact begins with one.
    pub ramp: bool,
    /// Multipliers that are held: nodes touch several masters with friction and multipliers that are unknowns.
    pub hold: bool,
    /// Jumps that may fail.
    pub jumps: usize,
}

crate::words!(Tries {
    can_yield,
    yields,
    follows,
    creeps,
    carries,
    glides,
    lingers,
    way,
    soft,
    sets,
    central,
    turned,
    sorted,
    goes_on,
    failures,
    jumps
});
crate::choices!(Yields { Never, OnceSingular, Anew });

impl Words for Way {
    fn put(&self, words: &mut Vec<f64>) {
        let (jumps, settles) = match self {
            Self::Newton { settle } => (false, *settle),
            Self::Jump => (true, false),
        };
        (jumps, settles).put(words);
    }

    fn take(words: &mut &[f64]) -> Self {
        match Words::take(words) {
            (true, _) => Self::Jump,
            (false, settle) => Self::Newton { settle },
        }
    }
}

/// What is tried at an increment, and how far it is.
#[derive(Clone, Copy, Debug)]
pub struct Ladder {
    pub means: Means,
    tries: Tries,
    /// Friction alone holds something: what is done otherwise when an increment has failed is done first, and the other way
    /// round.
    pub settles: bool,
    /// Contacts hold something that supports do not.
    pub hangs: bool,
    /// A contact that touched did not where the last attempt ended.
    pub lets_go: bool,
    /// Prescribed nodes turn a part of a body as one in the last attempt.
    pub turns: bool,
    /// Jumps that the watch has refused.
    refused: usize,
    controls: Controls,
}

impl Ladder {
    /// At the begin of a step.
    pub fn new(means: Means, controls: &Controls) -> Self {
        let tries = Tries {
            can_yield: Yields::Never,
            yields: Some(false),
            follows: Some(false),
            creeps: Some(false),
            carries: Some(false),
            glides: Some(false),
            lingers: Some(false),
            way: Way::Newton { settle: false },
            soft: false,
            sets: false,
            central: None,
            turned: false,
            sorted: false,
            goes_on: false,
            failures: 0,
            jumps: Jumps::default(),
        };
        Self {
            means,
            tries,
            settles: false,
            hangs: false,
            lets_go: false,
            turns: false,
            refused: 0,
            controls: *controls,
        }
    }

    /// How far it is.
    pub fn tries(&self) -> Tries {
        self.tries
    }

    /// Goes on from there.
    pub fn go_on(&mut self, tries: Tries) {
        self.tries = tries;
    }

    /// Notes when constraints of multipliers may give way more than they do anyway, and whether multipliers can be held.
    pub fn note(&mut self, yields: Yields, hold: bool) {
        (self.tries.can_yield, self.means.hold) = (yields, hold);
    }

    /// How to seek the increment now.
    pub fn way(&self) -> Way {
        match self.tries.way {
            Way::Newton { settle } => Way::Newton { settle: settle != self.settles },
            Way::Jump => Way::Jump,
        }
    }

    /// Whether it is sought in the other way because it has failed: then with automatic penalties, too.
    pub fn is_remedy(&self) -> bool {
        self.tries.way == Way::Newton { settle: true }
    }

    /// Whether penalties are lower than they are given, or come of themselves. Not in a jump: each of its steps has few iterations,
    /// too few for nodes that slip with lower penalties.
    pub fn is_soft(&self) -> bool {
        self.tries.soft && self.tries.way != Way::Jump
    }

    /// Whether active sets stand still while Newton's method runs.
    pub fn is_by_sets(&self) -> bool {
        self.means.sort && self.tries.sets && self.tries.way != Way::Jump
    }

    /// Whether contacts are sought along the central path.
    pub fn is_central(&self) -> bool {
        self.means.center && self.tries.central.is_some() && self.tries.way != Way::Jump
    }

    /// In which way contacts are sought now; `ahead` where the iteration begins from an extrapolation.
    pub fn manner(&self, ahead: bool) -> Manner {
        Manner {
            settles: self.way() == Way::Newton { settle: true } && !self.glides(),
            glides: self.glides(),
            ahead,
            automatic: self.is_remedy() || self.yields(),
            soft: self.is_soft(),
            clings: self.tries.follows == Some(true),
            creeps: self.tries.creeps == Some(true),
            central: self.is_central(),
            yields: self.yields(),
            again: self.tries.failures > 0,
        }
    }

    /// Whether a path of little but jumps, or jumps that are refused, leave nothing to try.
    pub fn jumps_on(&self) -> bool {
        self.tries.jumps.weight >= self.controls.jump_weight * self.controls.jump_run
            || self.refused > self.controls.jump_tries
    }

    /// Whether friction of what begins to touch comes when all is in balance without it.
    pub fn glides(&self) -> bool {
        self.tries.glides == Some(true) && self.tries.way != Way::Jump
    }

    /// Whether what is turned goes along in the first iteration.
    pub fn carries(&self) -> bool {
        self.tries.carries == Some(true) && self.tries.way != Way::Jump
    }

    /// Whether weak springs keep in place what comes loose.
    pub fn lingers(&self) -> bool {
        self.tries.lingers == Some(true) && self.tries.way != Way::Jump
    }

    /// Whether it was tried to keep in place what comes loose.
    pub fn has_lingered(&self) -> bool {
        self.tries.lingers != Some(false)
    }

    /// Whether constraints of multipliers give way until they are tightened.
    pub fn yields(&self) -> bool {
        self.tries.yields == Some(true)
    }

    /// In plastic bodies, and along the central path, each residual must be below the last, not only below the largest of the
    /// last few. What fails in one way is tried again in the other: neither serves both contacts that come and go and flow that
    /// overshoots.
    pub fn is_strict(&self) -> bool {
        let by_turns = self.tries.failures % self.controls.remedy_period == 1;
        self.tries.way == Way::Jump || self.tries.central.unwrap_or(by_turns)
    }

    /// The increment has converged, with something that `is_loose`. Says how it was found.
    pub fn succeed(&mut self, is_loose: bool) -> Way {
        let found = self.way();
        self.tries.yields = Some(self.yields() && self.tries.can_yield == Yields::OnceSingular);
        self.tries.follows = Some(self.tries.follows == Some(true));
        self.tries.creeps = Some(self.tries.creeps == Some(true));
        self.tries.carries = Some(self.carries());
        self.tries.glides = Some(false);
        self.tries.lingers = Some(self.lingers() && is_loose);
        self.means.ramp = false;
        self.tries.jumps.weight = if self.tries.way == Way::Jump {
            self.tries.jumps.weight + self.controls.jump_weight
        } else {
            self.tries.jumps.weight.saturating_sub(1)
        };
        self.tries.goes_on = self.tries.central.is_none();
        (self.tries.way, self.tries.failures) = (Way::Newton { settle: false }, 0);
        (self.tries.turned, self.tries.sorted, self.refused) =
            (self.tries.turned && !self.tries.soft, self.tries.sorted && !self.tries.sets, 0);
        found
    }

    /// The increment to `end` has failed: what to do. `None` when nothing is left.
    pub fn fail(&mut self, increments: &mut Increments, end: f64, cause: Cause) -> Option<Remedy> {
        // As deep as it is, whatever the increment: no cut makes it shallower.
        let may_ramp = cause == Cause::Watch || cause.is_of_iteration() && (self.tries.turned || !self.means.soften);
        if may_ramp && std::mem::take(&mut self.means.ramp) {
            (self.tries.soft, self.tries.turned) = (false, false);
            return Some(Remedy::Ramp);
        }
        if cause == Cause::Watch {
            return self.refuse(increments, end);
        }
        if matches!(cause, Cause::Unstable | Cause::Folded) {
            self.tries.failures += 1;
            increments.cut(end, false);
            return Some(Remedy::Cut);
        }
        // From the tangent of what would yield on it there may be no way back.
        if is_new(&mut self.tries.carries, self.turns && cause.is_of_iteration() && self.tries.way != Way::Jump) {
            return Some(Remedy::Carry);
        }
        // Friction alone holds something, and does not say where.
        let is_open = self.settles && (cause == Cause::Loose || cause.is_linear());
        if is_open && is_new(&mut self.tries.creeps, true) {
            return Some(Remedy::Creep);
        }
        // What loads press on a tool that goes away follows it.
        let may_follow = cause == Cause::Singular && self.means.soften && self.tries.follows == Some(false);
        let is_linear = cause.is_linear() && !may_follow;
        let is_loose = cause == Cause::Loose || is_linear || self.lets_go && cause.is_of_iteration();
        if is_loose && is_new(&mut self.tries.lingers, self.hangs) {
            return Some(Remedy::Linger);
        }
        // What fails by sets says nothing of what else may help.
        let by_sets = std::mem::take(&mut self.tries.sets) && self.means.sort && self.tries.way != Way::Jump;
        if by_sets && !std::mem::replace(&mut self.tries.sorted, true) {
            return Some(Remedy::Sets);
        }
        let cause = if by_sets { Cause::Iteration } else { cause };
        // After increments that converge one that does not is too long. Where none has, the length is not what matters.
        let is_long =
            self.tries.goes_on && self.tries.failures == 0 && cause == Cause::Iteration && !increments.is_short(end);
        if !(self.means.hold && is_long)
            && let Some(remedy) = self.relieve(cause)
        {
            return Some(remedy);
        }
        if self.tries.way == Way::Jump {
            self.tries.jumps.failed += 1;
            return (self.tries.jumps.failed < self.means.jumps && increments.lengthen(end)).then_some(Remedy::Jump);
        }
        if let Some(remedy) = self.turn(cause, is_long) {
            return Some(remedy);
        }
        let may_glide = self.means.glide && !is_long && cause.is_of_iteration() && !self.is_remedy();
        if is_new(&mut self.tries.glides, may_glide) {
            // By sets, too, where these come first.
            self.tries.sorted &= !self.means.sort_first;
            return Some(Remedy::Glide);
        }
        self.shorten(increments, end, cause)
    }

    /// The watch has refused the increment. Where contacts settle, one that is as short as it may be is jumped over: what friction has
    /// pushed along lets go at once.
    fn refuse(&mut self, increments: &mut Increments, end: f64) -> Option<Remedy> {
        let (jumped, last) = (self.tries.way == Way::Jump, increments.is_shortest(end));
        self.refused += usize::from(jumped);
        if last && !jumped && self.means.settle && self.means.jumps > 0 && !self.jumps_on() {
            (self.tries.way, self.tries.jumps.failed) = (Way::Jump, 0);
            return Some(Remedy::Jump);
        }
        self.tries.way = Way::Newton { settle: false };
        increments.cut(end, false);
        (!last && self.refused <= self.controls.jump_tries).then_some(Remedy::Cut)
    }

    /// Other constraints, with the increment as it is.
    fn relieve(&mut self, cause: Cause) -> Option<Remedy> {
        if self.means.hold {
            self.tries.yields = Some(false);
            self.tries.failures += 1;
            return Some(Remedy::Hold);
        }
        if cause == Cause::Singular && is_new(&mut self.tries.follows, self.means.soften) {
            return Some(Remedy::Follow);
        }
        if self.tries.can_yield.after(cause) && self.tries.yields == Some(false) {
            self.tries.yields = Some(true);
            self.tries.failures += 1;
            return Some(Remedy::Yield);
        }
        if cause.is_linear() {
            self.tries.yields = None;
        }
        None
    }

    /// Another way to the same contacts, with the increment as it is. One that `is_long` is cut before the central path.
    fn turn(&mut self, cause: Cause, is_long: bool) -> Option<Remedy> {
        let tries = &mut self.tries;
        let may_soften = self.means.soften && tries.central.is_none() && cause.is_of_iteration();
        if may_soften && !std::mem::replace(&mut tries.turned, true) {
            tries.soft = !tries.soft;
            return Some(Remedy::Soften);
        }
        if self.means.sort_first && tries.central.is_none() && self.sort(cause) {
            return Some(Remedy::Sets);
        }
        if self.means.center && is_long {
            return None;
        }
        let tries = &mut self.tries;
        if self.means.center && cause.is_of_iteration() && tries.central != Some(true) {
            let strict = tries.central.is_some();
            (tries.central, tries.soft) = (Some(strict), !strict);
            return Some(Remedy::Central);
        }
        tries.central = None;
        self.sort(cause).then_some(Remedy::Sets)
    }

    /// Whether active sets that stand still, or not, are to be tried.
    fn sort(&mut self, cause: Cause) -> bool {
        let tries = &mut self.tries;
        tries.sets = self.means.sort && cause.is_of_iteration() && !std::mem::replace(&mut tries.sorted, true);
        tries.sets
    }

    /// A shorter increment; or, where that hardly serves, contacts that settle, and a jump.
    fn shorten(&mut self, increments: &mut Increments, end: f64, cause: Cause) -> Option<Remedy> {
        self.tries.failures += 1;
        // What lets go passes through forces that are lost in rounding, in a shorter increment others.
        let singular = cause == Cause::Singular || cause == Cause::Rounding && !self.hangs;
        let again = self.means.settle && !self.is_remedy();
        let short = increments.is_short(end);
        if again && (short || singular) {
            self.tries.way = Way::Newton { settle: true };
            return Some(Remedy::Settle);
        }
        if singular {
            return None;
        }
        if short {
            (self.tries.way, self.tries.jumps.failed) = (Way::Jump, 0);
            return (self.means.jumps > 0 && !self.jumps_on()).then_some(Remedy::Jump);
        }
        let ends_period = self.tries.failures.is_multiple_of(self.controls.remedy_period);
        self.tries.way = Way::Newton { settle: self.means.settle && ends_period };
        self.tries.soft = self.means.soften && !self.tries.soft;
        self.tries.sorted = !ends_period;
        // What comes loose goes less far.
        self.tries.lingers = Some(false);
        increments.cut(end, self.tries.failures > 1);
        Some(Remedy::Cut)
    }
}

/// Whether a remedy is begun, which it is if it `may` be and was not on; one that was has not helped in this increment.
fn is_new(tried: &mut Option<bool>, may: bool) -> bool {
    let is_new = may && *tried == Some(false);
    *tried = is_new.then_some(true);
    is_new
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Increment, Limits};

    fn begin(means: Means) -> Ladder {
        Ladder::new(means, &Controls::default())
    }

    /// With jumps where there is friction or flow.
    fn means() -> Means {
        Means { jumps: Controls::default().jump_tries, ..Means::default() }
    }

    /// An increment that never converges is tried in ever shorter ones, then as jumps, and ends.
    #[test]
    fn tries_end() {
        for (frictional, min) in [(false, 1e-4), (true, 1e-4), (true, 0.3), (true, 0.5)] {
            let mut increments = Increments::new(
                &Increment { initial: 0.5, min, max: 0.5, limits: Limits::default() },
                1.0,
                &Controls::default(),
            );
            let jumps = if frictional { Controls::default().jump_tries } else { usize::MAX };
            let mut ladder = begin(Means { settle: frictional, jumps, ..Means::default() });
            let (mut sizes, mut ways) = (Vec::new(), Vec::new());
            loop {
                let end = increments.next().unwrap();
                sizes.push(end);
                ways.push(ladder.way());
                if ladder.fail(&mut increments, end, Cause::Iteration).is_none() {
                    break;
                }
            }
            assert!(sizes.len() < 18 && sizes.iter().all(|size| *size >= min), "{sizes:?}");
            let jumps = ways.iter().filter(|way| **way == Way::Jump).count();
            assert!((1..=6).contains(&jumps) && ways[ways.len() - jumps..].iter().all(|way| *way == Way::Jump));
            assert_eq!(ways.contains(&Way::Newton { settle: true }), frictional);
        }
    }

    #[test]
    fn where_no_jump_may_fail_none_is_tried() {
        let bounds = Increment { initial: 0.5, min: 1e-4, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { settle: true, ..Means::default() });
        while let Some(end) = increments.next()
            && ladder.fail(&mut increments, end, Cause::Iteration).is_some()
        {
            assert_ne!(ladder.way(), Way::Jump);
        }
    }

    /// An increment that fails is tried with the other penalties before it is cut; those that helped stay.
    #[test]
    fn contacts_are_softened_before_increments_are_cut() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { soften: true, ..means() });
        let mut fail = |ladder: &mut Ladder| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, Cause::Iteration), ladder.is_soft(), end)
        };
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), true, 0.5));
        ladder.succeed(false);
        assert!(ladder.is_soft());
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false, 0.5));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), true, 0.5));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false, 0.25));
        let jump = (0..20).map(|_| fail(&mut ladder)).find(|(remedy, ..)| *remedy == Some(Remedy::Jump));
        assert!(jump.is_some_and(|(_, is_soft, _)| !is_soft));
    }

    /// What other penalties do not help is tried by active sets, which stay where they help; a matrix that is singular by sets does
    /// not end anything.
    #[test]
    fn active_sets_are_tried_before_increments_are_cut() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { soften: true, sort: true, ..means() });
        let mut fail = |ladder: &mut Ladder, cause: Cause| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, cause), ladder.is_by_sets())
        };
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Sets), true));
        ladder.succeed(false);
        assert!(ladder.is_by_sets());
        assert_eq!(fail(&mut ladder, Cause::Singular), (Some(Remedy::Sets), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Cut), false));
        let mut ladder = begin(Means { sort: true, ..means() });
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Sets), true));
        assert_eq!(fail(&mut ladder, Cause::Singular), (Some(Remedy::Cut), false));
    }

    /// The watch refuses what jumps come to, and Newton's method finds nothing: that ends, too.
    #[test]
    fn jumps_that_are_refused_end() {
        let bounds = Increment { initial: 0.5, min: 1e-6, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { soften: true, jumps: usize::MAX, ..Means::default() });
        let mut jumps = 0;
        let ended = (0..200).any(|_| {
            let end = increments.next().unwrap();
            // The second of a row of jumps converges.
            jumps = if ladder.way() == Way::Jump { jumps + 1 } else { 0 };
            let cause = if jumps == 2 { Cause::Watch } else { Cause::Iteration };
            ladder.fail(&mut increments, end, cause).is_none()
        });
        assert!(ended);
    }

    /// What the watch refuses in the shortest increment is jumped over where there is friction, once: refused there, too, it ends.
    #[test]
    fn what_is_refused_in_the_shortest_increment_is_jumped_over() {
        let bounds = Increment { initial: 0.5, min: 0.1, max: 0.5, limits: Limits::default() };
        for settle in [true, false] {
            let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
            let mut ladder = begin(Means { settle, ..means() });
            let mut told = Vec::new();
            loop {
                let end = increments.next().unwrap();
                match ladder.fail(&mut increments, end, Cause::Watch) {
                    Some(remedy) => told.push(remedy),
                    None => break,
                }
            }
            let jumps = usize::from(settle);
            assert_eq!(told.iter().filter(|remedy| **remedy == Remedy::Jump).count(), jumps, "{told:?}");
            assert!(told[..told.len() - jumps].iter().all(|remedy| *remedy == Remedy::Cut) && told.len() > 1);
        }
    }

    /// What other penalties and active sets do not help is tried along the central path before it is cut, each time; where that
    /// has helped, it is the way of those after it. After increments that converged without it, what fails is cut first.
    #[test]
    fn contacts_are_sought_along_the_central_path() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { soften: true, sort: true, sort_first: true, center: true, ..means() });
        let mut fail = |ladder: &mut Ladder| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, Cause::Iteration), ladder.is_central())
        };
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Sets), false));
        assert_eq!((fail(&mut ladder), ladder.is_strict()), ((Some(Remedy::Central), true), false));
        ladder.succeed(false);
        assert!(ladder.is_central() && ladder.is_soft() && !ladder.is_by_sets());
        assert_eq!((fail(&mut ladder), ladder.is_strict()), ((Some(Remedy::Central), true), true));
        assert!(!ladder.is_soft());
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Central), true));
        let mut ladder = begin(Means { soften: true, center: true, ..means() });
        ladder.succeed(false);
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Central), true));
    }

    /// Friction that comes later is tried by active sets, too, once, where bodies lie on each other; what has helped is kept.
    #[test]
    fn what_glides_is_sorted() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut fail = |ladder: &mut Ladder| {
            let end = increments.next().unwrap();
            let remedy = ladder.fail(&mut increments, end, Cause::Iteration);
            (remedy, ladder.glides(), ladder.is_by_sets())
        };
        let own = Means { soften: true, sort: true, sort_first: true, glide: true, ..means() };
        let mut ladder = begin(own);
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false, false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Sets), false, true));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Glide), true, false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Sets), true, true));
        let mut helped = ladder;
        helped.succeed(false);
        assert!(helped.is_by_sets() && !helped.glides());
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false, false));
        let mut ladder = begin(Means { sort_first: false, ..own });
        assert_eq!(fail(&mut ladder).0, Some(Remedy::Soften));
        assert_eq!(fail(&mut ladder).0, Some(Remedy::Sets));
        assert_eq!(fail(&mut ladder).0, Some(Remedy::Glide));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false, false));
    }

    /// What touches goes along where the matrix is singular, and on through the step where that has helped.
    #[test]
    fn what_a_tool_goes_away_from_follows() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.5, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        let mut ladder = begin(Means { soften: true, ..means() });
        ladder.note(Yields::OnceSingular, false);
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), Some(Remedy::Follow));
        ladder.succeed(false);
        assert!(ladder.manner(false).clings);
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), Some(Remedy::Yield));
        assert!(!ladder.manner(false).clings);
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), None);
    }

    /// What hangs lingers where it fails, once for each length, and on through the step while it is loose; what supports hold does not.
    #[test]
    fn what_comes_loose_lingers() {
        let bounds = Increment { initial: 0.5, min: 0.01, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(means());
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Loose), Some(Remedy::Cut));
        for is_loose in [true, false] {
            let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
            let mut ladder = Ladder { hangs: true, ..begin(means()) };
            assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Loose), Some(Remedy::Linger));
            assert!(ladder.lingers() && ladder.has_lingered());
            let mut failed = ladder;
            assert_eq!(failed.fail(&mut increments, 0.5, Cause::Loose), Some(Remedy::Cut));
            assert!(!failed.lingers() && !failed.has_lingered());
            assert_eq!(failed.fail(&mut increments, 0.25, Cause::Loose), Some(Remedy::Linger));
            ladder.succeed(is_loose);
            assert_eq!(ladder.lingers(), is_loose);
        }
    }

    /// Where nothing has converged, friction comes later, once; after increments that converge one that does not is too long.
    #[test]
    fn friction_comes_later_where_nothing_has_converged() {
        let bounds = Increment { initial: 0.5, min: 0.01, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = begin(Means { settle: true, glide: true, ..means() });
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Iteration), Some(Remedy::Glide));
        assert!(ladder.manner(false).glides);
        let mut helped = ladder;
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Iteration), Some(Remedy::Cut));
        assert!(!ladder.manner(false).glides);
        assert_eq!(ladder.fail(&mut increments, 0.25, Cause::Iteration), Some(Remedy::Cut));
        helped.succeed(false);
        assert!(!helped.manner(false).glides);
        assert_eq!(helped.fail(&mut increments, 0.5, Cause::Iteration), Some(Remedy::Cut));
        // Friction alone may not be all that holds something: what it holds without a force is let go, and nothing is lost.
        let mut ladder = begin(Means { settle: true, glide: true, ..means() });
        ladder.settles = true;
        assert!(ladder.manner(false).settles);
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Iteration), Some(Remedy::Glide));
        assert!(ladder.manner(false).glides && !ladder.manner(false).settles);
    }

    #[test]
    fn constraints_of_a_singular_matrix_give_way_once() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.5, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        for cause in [Cause::Singular, Cause::Degenerate] {
            let mut ladder = begin(means());
            ladder.note(Yields::OnceSingular, false);
            assert_eq!((ladder.fail(&mut increments, 0.5, cause), ladder.yields()), (Some(Remedy::Yield), true));
            ladder.succeed(false);
            assert!(ladder.yields());
            assert!(ladder.fail(&mut increments, 0.5, cause) != Some(Remedy::Yield) && !ladder.yields());
        }
        let mut ladder = begin(means());
        ladder.note(Yields::OnceSingular, false);
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), Some(Remedy::Yield));
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), None);
    }

    #[test]
    fn multipliers_of_nodes_on_several_masters_are_held() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.1, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        let mut ladder = begin(Means { settle: true, ..means() });
        ladder.note(Yields::OnceSingular, true);
        for cause in [Cause::Singular, Cause::Iteration] {
            let mut ladder = ladder;
            assert_eq!((ladder.fail(&mut increments, 0.5, cause), ladder.yields()), (Some(Remedy::Hold), false));
            ladder.note(Yields::OnceSingular, false);
            assert_ne!(ladder.fail(&mut increments, 0.5, cause), Some(Remedy::Hold));
        }
        // After one that converged, what does not is cut first.
        ladder.succeed(false);
        assert_eq!({ ladder }.fail(&mut increments, 0.5, Cause::Degenerate), Some(Remedy::Hold));
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Iteration), Some(Remedy::Cut));
        assert_eq!(ladder.fail(&mut increments, 0.25, Cause::Iteration), Some(Remedy::Hold));
    }

    #[test]
    fn a_singular_matrix_ends_it_unless_friction_may_help() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.1, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        assert_eq!(
            begin(Means { jumps: usize::MAX, ..Means::default() }).fail(&mut increments, 0.5, Cause::Singular),
            None
        );
        let mut ladder = begin(Means { settle: true, ..means() });
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), Some(Remedy::Settle));
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), None);
    }
}
