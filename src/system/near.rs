//! Which slave nodes have equations of contact: those near their master.
//!
//! A slave node far from its master has no force, and needs neither multipliers nor entries in the matrix. So only nodes that
//! touch, or have the master within the reach of the search, have them. Contact elements look at all slave nodes at every
//! iterate all the same: where one touches that has no equations, it gets them before the iteration goes on, and with it
//! all that are near then. No multiplier is gained or lost that was not zero, so that iterates are those with equations for all.
//!
//! The reach is two facets where the scene does not say: under an indenter that slides by an eighth of a facet an increment
//! every 36th increment then asks for new equations, with a reach of one facet or a half every 18th.

use crate::contact::{Pair, Slave, Status, Trial};

/// For each pair and slave node of this rank whether it has equations of contact.
pub type Near = Vec<Vec<bool>>;

/// All slave nodes.
pub fn everywhere(pairs: &[Pair]) -> Near {
    pairs.iter().map(|pair| vec![true; pair.slaves.len()]).collect()
}

/// The slave nodes that touch, did so at the last converged increment, or are near, in the iterate `of` each; and those
/// that are to `stay`. Without multipliers there is nothing to spare.
pub fn around(pairs: &[Pair], of: impl Fn(&Slave) -> &Trial, stay: Option<&Near>) -> Near {
    let is_near = |pair: &Pair, slave: &Slave| {
        let trial = of(slave);
        let touches = [trial.status, slave.committed.status].iter().any(|status| *status != Status::Gap);
        pair.width() == 0 || touches || trial.projection.is_some()
    };
    let of_pair = |(p, pair): (usize, &Pair)| {
        let stays = |s: usize| stay.is_some_and(|stay| stay[p][s]);
        pair.slaves.iter().enumerate().map(|(s, slave)| stays(s) || is_near(pair, slave)).collect()
    };
    pairs.iter().enumerate().map(of_pair).collect()
}

/// Whether some slave node of this rank touches, as the iterate is, and has no equations.
pub fn lacks(near: &Near, pairs: &[Pair]) -> bool {
    let touches = |(slave, near): (&Slave, &bool)| !near && slave.trial.status != Status::Gap;
    pairs.iter().zip(near).any(|(pair, near)| pair.slaves.iter().zip(near).any(touches))
}
