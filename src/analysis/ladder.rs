//! What is tried, in which order, when an increment does not converge.
//!
//! 1. Newton's method from the extrapolation of the last increments, where there is one, then from the converged state.
//! 2. Where the matrix is singular and multipliers are unknowns, several may make the same condition.
//!
//!    Where nodes touch several masters, one of them with friction, the multipliers of these contacts are held from then on, by
//!    Uzawa's method, and no unknowns: penalties share out what a node gets of each. A block that is pushed into a corner of
//!    three planes with friction takes some 15 iterations an increment then; with constraints that give way it is cut without
//!    end, or comes out unlike in directions that are alike. So it is, too, where Newton's method fails, and where it has
//!    converged with null pivots, which give all to one of the contacts, or by multigrid, which does not see them.
//!
//!    Elsewhere constraints give way until they are tightened. Once that has helped, it is the way of the step. In
//!    self-contact, where they give way always, by more, and wherever an increment has failed: nodes that almost meet send
//!    each other to and fro.
//! 3. The same in shorter increments, by turns with contacts that *settle*: what touches sticks until all is nearly in
//!    balance, for a few iterations at most, and slips only then; with the automatic penalty, too, where another one is
//!    given. Where friction alone holds a body, an iteration that lets all slip at once, as far as the tool has moved,
//!    leaves the body without stiffness and behind; so there every increment settles first, and one that does not is what is
//!    tried by turns.
//!    Before an increment is cut for the first time it is tried with *soft* contacts, whose penalties are lower, from then on by
//!    turns; what has helped is kept. Penalties come from the stiffness around a node, and a slender body, a sheet or a hook, is
//!    far softer in bending: there an iteration leaves gaps that outweigh the force, the node lets go, and comes back. Where
//!    contacts slide with friction lower penalties are slower. The solution does not depend on them.
//!    What that does not help is tried along the *central path*, on which forces of contacts grow smoothly before gaps are
//!    closed: a sheet between two tools may touch them in so many ways that the iteration goes to and fro between them. Where
//!    residuals do not fall there, it is tried once more with such that fall in each iteration.
//!    Then it is tried by active *sets*, that stand still until Newton's method has converged: where a sheet
//!    lies on a sheet, nodes that bear nothing touch all the same, and each rotation of an iteration sends some of them to and
//!    fro. It has the unknowns and the solution of the augmented Lagrangian; what has helped is kept.
//! 4. A jump, in an increment so short that the tools hardly move in it: friction then follows their way, not that of the
//!    jump. Close to where equilibrium ends little drives a jump, and longer increments are tried, too.
//!
//! No increment is shorter than the scene's minimum, and a path of little but jumps ends the run; so do jumps that the watch
//! refuses again and again.

use super::event::Remedy;
use super::increments::Increments;
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

/// How an increment was found, after how many failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    pub way: Way,
    pub failures: usize,
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

/// How far the tries are, of what a [`Ladder`] has under these names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tries {
    can_yield: Yields,
    yields: Option<bool>,
    way: Way,
    soft: bool,
    sets: bool,
    central: Option<bool>,
    turned: bool,
    sorted: bool,
    failures: usize,
    jumps: usize,
    jumped: usize,
}

crate::words!(Tries { can_yield, yields, way, soft, sets, central, turned, sorted, failures, jumps, jumped });
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

/// The state of the tries at an increment.
#[derive(Clone, Copy, Debug)]
pub struct Ladder {
    /// There are contacts.
    pub can_soften: bool,
    /// Some contact has an augmented Lagrangian, which active sets can have the place of.
    pub can_sort: bool,
    /// Contacts can be sought along the central path: two tools press on a body.
    pub can_center: bool,
    /// Some contact has friction, or a penalty that is not the automatic one.
    can_settle: bool,
    /// When constraints of multipliers give way more than they do anyway.
    pub can_yield: Yields,
    /// Constraints give way until they are tightened; `None` when it did not help in this increment.
    yields: Option<bool>,
    /// Nodes touch several masters with friction and multipliers that are unknowns.
    pub can_hold: bool,
    /// Jumps that may fail.
    most_jumps: usize,
    /// Friction alone holds something: what is done otherwise when an increment has failed is done first, and the other way
    /// round.
    pub settles: bool,
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
    /// Failures in succession.
    failures: usize,
    /// Jumps that have failed, and those that the watch has refused.
    jumps: usize,
    refused: usize,
    /// How much of the path was jumped over of late: `jump_weight` for each jump, less one for each increment after it.
    jumped: usize,
    controls: Controls,
}

impl Ladder {
    /// `has_memory` where friction or flow make the state depend on the way to it.
    pub fn new(can_settle: bool, has_memory: bool, controls: &Controls) -> Self {
        let most_jumps = if has_memory { controls.jump_tries } else { usize::MAX };
        let way = Way::Newton { settle: false };
        Self {
            can_soften: false,
            can_sort: false,
            can_center: false,
            can_settle,
            can_yield: Yields::Never,
            yields: Some(false),
            can_hold: false,
            most_jumps,
            settles: false,
            way,
            soft: false,
            sets: false,
            central: None,
            turned: false,
            sorted: false,
            failures: 0,
            jumps: 0,
            refused: 0,
            jumped: 0,
            controls: *controls,
        }
    }

    /// The same without jumps, which have no time that dashpots could go by.
    pub fn without_jumps(self) -> Self {
        Self { most_jumps: 0, ..self }
    }

    /// How far it is.
    pub fn tries(&self) -> Tries {
        let Self { can_yield, yields, way, soft, sets, central, turned, sorted, failures, jumps, jumped, .. } = *self;
        Tries { can_yield, yields, way, soft, sets, central, turned, sorted, failures, jumps, jumped }
    }

    /// Goes on from there.
    pub fn go_on(&mut self, tries: Tries) {
        let Tries { can_yield, yields, way, soft, sets, central, turned, sorted, failures, jumps, jumped } = tries;
        *self = Self { can_yield, yields, way, soft, sets, central, turned, sorted, failures, jumps, jumped, ..*self };
    }

    /// How to seek the increment now.
    pub fn way(&self) -> Way {
        match self.way {
            Way::Newton { settle } => Way::Newton { settle: settle != self.settles },
            Way::Jump => Way::Jump,
        }
    }

    /// Whether it is sought in the other way because it has failed: then with automatic penalties, too.
    pub fn is_remedy(&self) -> bool {
        self.way == Way::Newton { settle: true }
    }

    /// Whether penalties are lower than they are given, or come of themselves.
    pub fn is_soft(&self) -> bool {
        self.soft
    }

    /// Whether active sets stand still while Newton's method runs.
    pub fn is_by_sets(&self) -> bool {
        self.can_sort && self.sets && self.way != Way::Jump
    }

    /// Whether contacts are sought along the central path.
    pub fn is_central(&self) -> bool {
        self.can_center && self.central.is_some() && self.way != Way::Jump
    }

    /// Whether a path of little but jumps, or jumps that are refused, leave nothing to try.
    pub fn jumps_on(&self) -> bool {
        self.jumped >= self.controls.jump_weight * self.controls.jump_run || self.refused > self.controls.jump_tries
    }

    /// Whether the increment has failed already.
    pub fn has_failed(&self) -> bool {
        self.failures > 0
    }

    /// Whether constraints of multipliers give way until they are tightened.
    pub fn yields(&self) -> bool {
        self.yields == Some(true)
    }

    /// In plastic bodies, and along the central path, each residual must be below the last, not only below the largest of the
    /// last few. What fails in one way is tried again in the other: neither serves both contacts that come and go and flow that
    /// overshoots.
    pub fn is_strict(&self) -> bool {
        let by_turns = self.failures % self.controls.remedy_period == 1;
        self.way == Way::Jump || self.central.unwrap_or(by_turns)
    }

    /// The increment has converged. Says how it was found.
    pub fn succeed(&mut self) -> Found {
        let found = Found { way: self.way(), failures: self.failures };
        self.yields = Some(self.yields() && self.can_yield == Yields::OnceSingular);
        self.jumped =
            if self.way == Way::Jump { self.jumped + self.controls.jump_weight } else { self.jumped.saturating_sub(1) };
        (self.way, self.failures) = (Way::Newton { settle: false }, 0);
        (self.turned, self.sorted, self.refused) = (self.turned && !self.soft, self.sorted && !self.sets, 0);
        found
    }

    /// The increment to `end` has failed: what to do. `None` when nothing is left.
    pub fn fail(&mut self, increments: &mut Increments, end: f64, cause: Cause) -> Option<Remedy> {
        if cause == Cause::Watch {
            self.refused += usize::from(self.way == Way::Jump);
            self.way = Way::Newton { settle: false };
            let last = increments.is_shortest(end) || self.refused > self.controls.jump_tries;
            increments.cut(end, false);
            return (!last).then_some(Remedy::Cut);
        }
        // What fails by sets says nothing of what else may help.
        let cause = if std::mem::take(&mut self.sets) && self.can_sort && self.way != Way::Jump {
            if !std::mem::replace(&mut self.sorted, true) {
                return Some(Remedy::Sets);
            }
            Cause::Iteration
        } else {
            cause
        };
        let singular = matches!(cause, Cause::Singular | Cause::Rounding);
        if self.can_hold {
            self.yields = Some(false);
            self.failures += 1;
            return Some(Remedy::Hold);
        }
        if self.can_yield.after(cause) && self.yields == Some(false) {
            self.yields = Some(true);
            self.failures += 1;
            return Some(Remedy::Yield);
        }
        if cause.is_linear() {
            self.yields = None;
        }
        let Way::Newton { .. } = self.way else {
            self.jumps += 1;
            return (self.jumps < self.most_jumps && increments.lengthen(end)).then_some(Remedy::Jump);
        };
        if self.can_soften && cause.is_of_iteration() && !std::mem::replace(&mut self.turned, true) {
            self.soft = !self.soft;
            return Some(Remedy::Soften);
        }
        if self.can_center && cause.is_of_iteration() && self.central != Some(true) {
            (self.central, self.soft) = (Some(self.central.is_some()), false);
            return Some(Remedy::Central);
        }
        self.central = None;
        if self.can_sort && cause.is_of_iteration() && !std::mem::replace(&mut self.sorted, true) {
            self.sets = true;
            return Some(Remedy::Sets);
        }
        self.failures += 1;
        let again = self.can_settle && !self.is_remedy();
        let short = increments.is_short(end);
        if again && (short || singular) {
            self.way = Way::Newton { settle: true };
            return Some(Remedy::Settle);
        }
        if singular {
            return None;
        }
        if short {
            (self.way, self.jumps) = (Way::Jump, 0);
            return (!self.jumps_on()).then_some(Remedy::Jump);
        }
        self.way = Way::Newton { settle: self.can_settle && self.failures.is_multiple_of(self.controls.remedy_period) };
        self.soft = self.can_soften && !self.soft;
        self.sorted = !self.failures.is_multiple_of(self.controls.remedy_period);
        increments.cut(end, self.failures > 1);
        Some(Remedy::Cut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Increment, Limits};

    /// An increment that never converges is tried in ever shorter ones, then as jumps, and ends.
    #[test]
    fn tries_end() {
        for (frictional, min) in [(false, 1e-4), (true, 1e-4), (true, 0.3), (true, 0.5)] {
            let mut increments = Increments::new(
                &Increment { initial: 0.5, min, max: 0.5, limits: Limits::default() },
                1.0,
                &Controls::default(),
            );
            let mut ladder = Ladder::new(frictional, frictional, &Controls::default());
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

    /// An increment that fails is tried with the other penalties before it is cut; those that helped stay.
    #[test]
    fn contacts_are_softened_before_increments_are_cut() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = Ladder { can_soften: true, ..Ladder::new(false, true, &Controls::default()) };
        let mut fail = |ladder: &mut Ladder| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, Cause::Iteration), ladder.is_soft(), end)
        };
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), true, 0.5));
        ladder.succeed();
        assert!(ladder.is_soft());
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false, 0.5));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), true, 0.5));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false, 0.25));
    }

    /// What other penalties do not help is tried by active sets, which stay where they help; a matrix that is singular by sets does
    /// not end anything.
    #[test]
    fn active_sets_are_tried_before_increments_are_cut() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = Ladder { can_soften: true, can_sort: true, ..Ladder::new(false, true, &Controls::default()) };
        let mut fail = |ladder: &mut Ladder, cause: Cause| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, cause), ladder.is_by_sets())
        };
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Sets), true));
        ladder.succeed();
        assert!(ladder.is_by_sets());
        assert_eq!(fail(&mut ladder, Cause::Singular), (Some(Remedy::Sets), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Soften), false));
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Cut), false));
        let mut ladder = Ladder { can_sort: true, ..Ladder::new(false, true, &Controls::default()) };
        assert_eq!(fail(&mut ladder, Cause::Iteration), (Some(Remedy::Sets), true));
        assert_eq!(fail(&mut ladder, Cause::Singular), (Some(Remedy::Cut), false));
    }

    /// The watch refuses what jumps come to, and Newton's method finds nothing: that ends, too.
    #[test]
    fn jumps_that_are_refused_end() {
        let bounds = Increment { initial: 0.5, min: 1e-6, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder = Ladder { can_soften: true, ..Ladder::new(false, false, &Controls::default()) };
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

    /// What other penalties do not help is tried along the central path before it is cut, each time; where that has helped,
    /// it is the way of those after it.
    #[test]
    fn contacts_are_sought_along_the_central_path() {
        let bounds = Increment { initial: 0.5, min: 1e-3, max: 0.5, limits: Limits::default() };
        let mut increments = Increments::new(&bounds, 1.0, &Controls::default());
        let mut ladder =
            Ladder { can_soften: true, can_center: true, ..Ladder::new(false, true, &Controls::default()) };
        let mut fail = |ladder: &mut Ladder| {
            let end = increments.next().unwrap();
            (ladder.fail(&mut increments, end, Cause::Iteration), ladder.is_central())
        };
        assert_eq!(fail(&mut ladder), (Some(Remedy::Soften), false));
        assert_eq!((fail(&mut ladder), ladder.is_strict()), ((Some(Remedy::Central), true), false));
        ladder.succeed();
        assert!(ladder.is_central() && !ladder.is_soft());
        assert_eq!((fail(&mut ladder), ladder.is_strict()), ((Some(Remedy::Central), true), true));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Cut), false));
        assert_eq!(fail(&mut ladder), (Some(Remedy::Central), true));
    }

    #[test]
    fn constraints_of_a_singular_matrix_give_way_once() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.5, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        for cause in [Cause::Singular, Cause::Degenerate] {
            let mut ladder =
                Ladder { can_yield: Yields::OnceSingular, ..Ladder::new(false, true, &Controls::default()) };
            assert_eq!((ladder.fail(&mut increments, 0.5, cause), ladder.yields()), (Some(Remedy::Yield), true));
            ladder.succeed();
            assert!(ladder.yields());
            assert!(ladder.fail(&mut increments, 0.5, cause) != Some(Remedy::Yield) && !ladder.yields());
        }
        let mut ladder = Ladder { can_yield: Yields::OnceSingular, ..Ladder::new(false, true, &Controls::default()) };
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
        let ladder =
            Ladder { can_hold: true, can_yield: Yields::OnceSingular, ..Ladder::new(true, true, &Controls::default()) };
        for cause in [Cause::Singular, Cause::Iteration] {
            let mut ladder = ladder;
            assert_eq!((ladder.fail(&mut increments, 0.5, cause), ladder.yields()), (Some(Remedy::Hold), false));
            ladder.can_hold = false;
            assert_ne!(ladder.fail(&mut increments, 0.5, cause), Some(Remedy::Hold));
        }
    }

    #[test]
    fn a_singular_matrix_ends_it_unless_friction_may_help() {
        let mut increments = Increments::new(
            &Increment { initial: 0.5, min: 0.1, max: 0.5, limits: Limits::default() },
            1.0,
            &Controls::default(),
        );
        assert_eq!(Ladder::new(false, false, &Controls::default()).fail(&mut increments, 0.5, Cause::Singular), None);
        let mut ladder = Ladder::new(true, true, &Controls::default());
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), Some(Remedy::Settle));
        assert_eq!(ladder.fail(&mut increments, 0.5, Cause::Singular), None);
    }
}
