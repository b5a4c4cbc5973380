//! Contact of slave nodes with rigid tools.
//!
//! - [`element`]: the augmented-Lagrangian contact element of one slave node, residual and exact tangent
//! - [`pose`]: where a tool is
//! - [`search`]: tools in their place, and which part of them a rank watches
//! - here: the tools, the contact pairs, and the state of their slave nodes

pub mod element;
pub mod pose;
pub mod search;

pub use element::{Guide, Law, Status};
pub use pose::Pose;
pub use search::{Tool, watch_all};

use crate::Vec3;
use crate::surface::Projection;

/// A contact pair on this rank: the owned nodes of a slave surface against a tool.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: String,
    /// Index of the tool.
    pub tool: usize,
    /// Coulomb coefficient.
    pub friction: f64,
    /// Index of the slave surface in the part's sets.
    pub set: usize,
    pub slaves: Vec<Slave>,
    /// Distance from the tool within which a slave node is projected.
    pub reach: f64,
    /// Longest edge of the slave facets.
    pub facet_size: f64,
}

impl Pair {
    /// Multipliers that a slave node may have: one without friction, three with.
    pub fn width(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }
}

/// A slave node and its history.
#[derive(Clone, Debug)]
pub struct Slave {
    /// Owned local node.
    pub node: u32,
    pub law: Law,
    /// State of the last converged increment.
    pub committed: History,
    /// State of the current iterate.
    pub trial: Trial,
    /// The iterate that became the last converged increment.
    pub accepted: Trial,
}

/// What a slave node remembers of the last converged increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct History {
    /// Nodal contact force λ, N; without friction λ_n stands in the first entry.
    pub multiplier: Vec3,
    /// Closest point, in the tool's frame: the slip origin. Kept for every node in reach, in contact or not.
    pub anchor: Option<Vec3>,
    /// Where the node itself was, in the tool's frame.
    pub place: Option<Vec3>,
    /// Patch and parameters of the anchor, where the next projection starts.
    pub warm: Option<(u32, [f64; 2])>,
    pub status: Status,
}

/// The current iterate of a slave node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trial {
    pub status: Status,
    /// F: contact force on the tool, N.
    pub force: Vec3,
    /// Projection in space, when there is one in reach.
    pub projection: Option<Projection>,
    /// Slip since the last converged increment.
    pub slip: Vec3,
    /// The status differs from that of the iterate before, or the slip has turned back.
    pub changed: bool,
    /// How often that happened in succession.
    pub flips: u32,
}

impl Trial {
    /// Takes over the status and force of a new iterate.
    pub fn update(&mut self, status: Status, force: Vec3) {
        let tangential = |f: Vec3| self.projection.map_or(f, |p| f - p.normal * p.normal.dot(&f));
        let turned = status == Status::Slip && self.status == Status::Slip && tangential(self.force).dot(&force) < 0.0;
        self.changed = status != self.status || turned;
        self.flips = if self.changed { self.flips + 1 } else { 0 };
        self.status = status;
        self.force = force;
    }
}

impl Slave {
    /// A node with its penalty, force per length.
    pub fn new(node: u32, friction: f64, penalty: f64) -> Self {
        let law = Law { friction, normal: penalty, tangential: penalty };
        Self { node, law, committed: History::default(), trial: Trial::default(), accepted: Trial::default() }
    }

    /// The slip origin in space for a tool at `pose`: where the contact point of the last converged increment is now; for
    /// a node that was out of reach then, its own place, carried along. Slip sees no distance along the normal.
    pub fn slip_origin(&self, pose: &Pose) -> Vec3 {
        self.committed.anchor.or(self.committed.place).map_or(Vec3::zeros(), |origin| pose.outward(&origin))
    }

    /// Accepts the current iterate: remembers the projection with the tool at `pose` and the node at `position`.
    pub fn commit(&mut self, multiplier: Vec3, pose: &Pose, position: &Vec3) {
        self.accepted = self.trial;
        let projection = self.trial.projection;
        self.committed = History {
            multiplier,
            anchor: projection.map(|p| pose.inward(&p.point)),
            place: Some(pose.inward(position)),
            warm: projection.map(|p| (p.patch, p.xi)),
            status: self.trial.status,
        };
    }
}
