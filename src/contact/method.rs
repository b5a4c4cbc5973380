//! How contact is described and enforced, by name.

use crate::surface::{Smoothing, Transfer};

/// Which nodes are kept out of what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Discretization {
    /// The slave's nodes out of the master's surface.
    #[default]
    OnePass,
    /// These, and the master's nodes out of the slave's surface.
    TwoPass,
    /// Each node of the slave out of the node of the master that it lies on, for small sliding on conforming meshes.
    NodeToNode,
    /// The slave's faces, in the mean around each node.
    Segment,
}

/// What becomes of the overlap of bodies and tools with which a contact begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interference {
    /// At once, and where no increment is found so, ramped.
    #[default]
    Auto,
    /// The first increment pushes it out.
    AtOnce,
    /// It is pushed out in proportion to the time of the first step.
    Ramped,
}

/// How contact is enforced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Enforcement {
    /// Forces grow with penetration and slip; no multipliers.
    Penalty,
    /// Multipliers are the forces, under an active set that is fixed while Newton's method runs.
    Lagrange,
    /// Multipliers and penalty together in one system.
    #[default]
    AugmentedLagrangian,
    /// Multipliers are held while Newton's method runs, and take over the forces after it.
    Uzawa,
}

impl Enforcement {
    /// Every method with what the user calls it.
    pub const KEYS: [(&'static str, Self); 4] = [
        ("penalty", Self::Penalty),
        ("lagrange", Self::Lagrange),
        ("augmented-lagrangian", Self::AugmentedLagrangian),
        ("uzawa", Self::Uzawa),
    ];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        Self::KEYS.iter().find(|(_, method)| *method == self).map_or("", |(key, _)| key)
    }

    /// Whether multipliers are no unknowns.
    pub fn holds_multipliers(self) -> bool {
        matches!(self, Self::Penalty | Self::Uzawa)
    }
}

/// Which tangent contact elements have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangent {
    /// The derivative of the residual.
    #[default]
    Exact,
    /// That of the paper, eqs. (68)-(70): as if normal, weights and slip origin stood still.
    FixedFrame,
}

/// The faces of a body as a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterSurface {
    pub smoothing: Smoothing,
    /// Edges whose facets' normals differ by more stay sharp, degrees.
    pub feature_angle: f64,
    /// How the contact force goes to the master's nodes.
    pub transfer: Transfer,
}
