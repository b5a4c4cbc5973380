//! Which slave nodes have equations of contact: those near their master.
//!
//! A slave node far from its master has no force. It needs neither multipliers nor entries in the matrix, until it comes
//! near. So only nodes that touch, or are within a few facets of the master, have them. Contact elements look at all
//! slave nodes at every iterate all the same: one that touches without having equations gets them before the iteration goes
//! on, and with it all that are near then. No multiplier is lost or gained that was not zero, so that iterates are those
//! that they would be if all nodes had equations.

use crate::contact::{Pair, Slave, Status, Trial};

/// Distance within which a node is near, over the longest edge of the slave facets. Under an indenter that slides by an eighth
/// of a facet an increment, half of it asks for new equations every 17 increments, one for every 18, two for every 36.
const NEAR: f64 = 2.0;

/// For each pair and slave node of this rank whether it has equations of contact.
pub type Near = Vec<Vec<bool>>;

/// All slave nodes.
pub fn everywhere(pairs: &[Pair]) -> Near {
    pairs.iter().map(|pair| vec![true; pair.slaves.len()]).collect()
}

/// The slave nodes that touch, did so at the last converged increment, or are near, with the iterate `of` each; and those
/// that are to `stay`. Without multipliers there is nothing to spare.
pub fn around(pairs: &[Pair], of: impl Fn(&Slave) -> &Trial, stay: Option<&Near>) -> Near {
    let is_near = |pair: &Pair, slave: &Slave| {
        let trial = of(slave);
        let distance = NEAR * pair.facet_size;
        pair.width() == 0
            || [trial.status, slave.committed.status].iter().any(|status| *status != Status::Gap)
            || trial.projection.is_some_and(|p| p.gap <= distance)
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
