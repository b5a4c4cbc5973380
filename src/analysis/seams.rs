//! Nodes in the seam of two masters that lie on each other, as the pieces of a die: what a side has there is covered by the other
//! piece, and the surface of a slave cannot be between them. A node that has lost its way over the seam may be held by such sides,
//! whose forces nothing else tells of: gaps are closed, and all is in balance.

use crate::Vec3;
use crate::contact::watch::Finding;
use crate::contact::{Pair, Slave, Status};
use crate::model::{Model, outward_of};
use crate::surface::Projection;
use std::cell::LazyCell;

/// A slave node, by its pair and its place in it, that is held by a side of the master which lies on another master of it, to
/// `hand_over` of the slave's facets, with nodes displaced by `u`; with its force.
pub(super) fn in_seam(model: &Model, u: &[Vec3]) -> Option<(usize, usize, Finding)> {
    let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| pair.may_be_between());
    if pairs().count() < 2 {
        return None;
    }
    pairs().find_map(|(p, pair)| {
        let place = |n: u32| model.part.points[n as usize] + u[n as usize];
        let outward = LazyCell::new(|| outward_of(&model.part, pair, place));
        let is_held = |slave: &Slave, at: &Projection| {
            let covers = |(q, other): (usize, &Pair)| {
                let ground = model.masters.of(other.master);
                let found = other.index_of(slave.node).filter(|_| q != p && other.master != pair.master);
                let opposite = found.and_then(|k| ground.project(other, k, &at.point, (None, false)));
                opposite.is_some_and(|opposite| {
                    opposite.gap.abs() <= other.controls.hand_over * other.facet_size
                        && opposite.normal.dot(&at.normal) <= other.controls.watch_opposed
                })
            };
            pairs().any(covers) && outward[slave.node as usize].dot(&at.normal) > pair.controls.watch_inward
        };
        pair.slaves.iter().enumerate().find_map(|(s, slave)| {
            let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
            is_held(slave, &at).then(|| (p, s, Finding::InSeam(slave.trial.force.norm())))
        })
    })
}
