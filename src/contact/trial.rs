//! The iterate of a slave node.

use super::law::{Response, Status};
use crate::surface::Projection;
use crate::{Mat3, Vec3};

/// What a slave node does about kinks between pieces of its master within an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinks {
    /// The piece of the master that it left last, or a number of those that it was between, and how often it has come back to one.
    pub left: Option<u32>,
    pub returns: u32,
    /// From so many returns on it keeps to its side of kinks.
    pub patience: u32,
    /// It does, where its closest point is on the other side.
    pub keeps: bool,
    /// How often it has come to the side that it was on, or left it.
    pub entrances: u32,
    /// k: the stiffness with which both sides of a hollow kink hold it between them, force per length; 0 where they do not.
    pub wedge: f64,
}

crate::words!(Kinks { left, returns, patience, keeps, entrances, wedge });

impl Kinks {
    /// Whether it has gone to and fro so often that it keeps to its side.
    pub fn is_settled(&self) -> bool {
        self.returns >= self.patience
    }

    /// Whether it goes to and fro even so.
    pub fn is_restless(&self) -> bool {
        self.returns >= 2 * self.patience
    }

    /// Whether it may still come to the side that it was on.
    pub fn may_enter(&self) -> bool {
        self.entrances < 2 * self.patience
    }

    /// Notes whether it is on the side that it was on, or came through.
    pub fn note_entrance(&mut self, enters: bool) {
        self.entrances += u32::from(enters != (self.entrances % 2 == 1));
    }

    /// It is on the piece `here`, and was on `last` before.
    fn go(&mut self, here: u32, last: u32) {
        if here != last {
            self.returns += u32::from(self.left == Some(here));
            self.left = Some(last);
        }
    }
}

/// The current iterate of a slave node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trial {
    pub status: Status,
    /// F: contact force on the master, N.
    pub force: Vec3,
    /// What the other pass of a contact, or other nodes in self-contact, add to F at this node: its opposite is the force that
    /// the node gets as one of the master.
    pub received: Vec3,
    /// It stands where a node of the master does, and in the second pass leaves the contact to that one.
    pub yields: bool,
    /// Projection in space, when there is one in reach.
    pub projection: Option<Projection>,
    pub kinks: Kinks,
    /// Slip since the last converged increment.
    pub slip: Vec3,
    /// Friction of the last converged increment that is not kept now that the node rests, N.
    pub let_go: f64,
    /// The status differs from that of the iterate before, or the slip has turned back.
    pub changed: bool,
    /// How often that happened in succession.
    pub flips: u32,
    /// With an active set: the status that gap and multiplier ask for in its place, and by how much that changes the
    /// residual of the multiplier, N.
    pub asked: Status,
    pub violation: f64,
    /// The local unknown, and where the node is.
    pub sigma: Vec3,
    pub position: Vec3,
    /// Residual of the multiplier, or of the local unknown, N.
    pub local: f64,
}

crate::words!(Trial {
    status,
    force,
    received,
    yields,
    projection,
    kinks,
    slip,
    let_go,
    changed,
    flips,
    asked,
    violation,
    sigma,
    position,
    local,
});

impl Trial {
    /// The contact force on the node, its own and what it receives as a node of the master.
    pub fn on_node(&self) -> Vec3 {
        -(self.force + self.received)
    }

    /// Takes over the response of a new iterate.
    pub fn update(&mut self, &Response { status, force, slip, constraint, asked, violation, .. }: &Response) {
        // Beyond rounding, for without friction there is nothing else.
        let turned = |p: &Projection| {
            let tangential = self.force - p.normal * p.normal.dot(&self.force);
            tangential.dot(&force) < -1e-12 * force.norm_squared()
        };
        let slips = status == Status::Slip && self.status == Status::Slip && self.kinks.wedge == 0.0;
        let turned = slips && self.projection.as_ref().is_some_and(turned);
        self.changed = status != self.status || turned;
        self.flips = if self.changed { self.flips + 1 } else { 0 };
        (self.status, self.force, self.slip) = (status, force, slip);
        (self.asked, self.violation, self.local) = (asked, violation, constraint.amax());
    }

    /// Takes over where it is on the master: `here`, a piece or the number of several; it was on `last` before.
    pub fn stand(&mut self, projection: Option<Projection>, here: Option<u32>, last: Option<u32>) {
        self.projection = projection;
        if let Some((here, last)) = here.zip(last) {
            self.kinks.go(here, last);
        }
    }

    /// The force along the surface.
    pub fn traction(&self) -> Vec3 {
        self.projection.map_or(Vec3::zeros(), |p| self.force - p.normal * p.normal.dot(&self.force))
    }
}

/// The projection of a slave node in the first iteration of a step: a gap `below` so much, which is but rounding, is closed. A
/// body that only a force drives would have no support otherwise. Further iterations see the gap as it is.
pub fn touching(projection: Projection, below: f64) -> Projection {
    let Projection { gap, normal_gradient, .. } = projection;
    if !(gap > 0.0 && gap < below) {
        return projection;
    }
    // On an edge or a corner the normal turns by the motion over the gap, and without a gap it stands still; elsewhere it
    // turns by the curvature, far less.
    let turns = normal_gradient.norm() * gap > 0.5;
    Projection { gap: 0.0, normal_gradient: if turns { Mat3::zeros() } else { normal_gradient }, ..projection }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_gap_leaves_the_normal_of_a_face_its_turn_and_that_of_a_corner_none() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let across = Mat3::identity() - normal * normal.transpose();
        let edge = Mat3::from_diagonal(&Vec3::y());
        let at = |gap: f64, normal_gradient: Mat3| {
            touching(Projection { gap, point: Vec3::zeros(), normal, normal_gradient, patch: 0, xi: [1.0, 0.0] }, 1e-4)
        };
        for (gap, turn, expected) in [
            (1e-8, across / 1e-8, (0.0, Mat3::zeros())),
            (1e-8, edge / 1e-8, (0.0, Mat3::zeros())),
            (5e-5, across / 3.0, (0.0, across / 3.0)),
            (2e-4, across / 2e-4, (2e-4, across / 2e-4)),
            (-1e-8, across / -1e-8, (-1e-8, across / -1e-8)),
        ] {
            let closed = at(gap, turn);
            assert_eq!((closed.gap, closed.normal_gradient), expected);
        }
    }
}
