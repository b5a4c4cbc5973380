//! Contact of slave nodes with rigid tools and with the faces of deformable bodies.
//!
//! - [`law`]: Coulomb friction by multipliers and penalties, what the contact elements have in common
//! - [`element`]: the element of a slave node and its master, residual and tangent
//! - [`master`]: tools and the surfaces of bodies behind one type
//! - [`meeting`]: where a slave node meets its master at an iterate, and what its element is evaluated with
//! - [`moves`]: how a step moves points, as far as it prescribes that
//! - [`pose`]: where a tool is
//! - [`tool`]: tools in their place, and which part of them a rank watches
//! - [`slave`]: a slave node and its history
//! - [`trial`]: the iterate of a slave node
//! - [`self_contact`]: which patches of its own surface a node may meet
//! - [`body_surface`]: a deformable master surface that moves with its nodes, wherever they are owned
//! - [`method`]: how contact is described and enforced, by name
//! - [`mates`]: contact from node to node
//! - [`segment`]: contact from segment to segment
//! - [`watch`]: whether a node went through the master, by its place alone
//! - [`guidance`]: whether slave and master are the right way round
//! - [`stiffness`]: how stiffly bodies resist contact forces, the unit of penalties
//! - here: the contact pairs

pub mod body_surface;
pub mod element;
pub mod guidance;
pub mod law;
pub mod master;
pub mod mates;
pub mod meeting;
pub mod method;
pub mod moves;
pub mod pose;
pub mod segment;
pub mod self_contact;
pub mod slave;
pub mod stiffness;
pub mod tool;
pub mod trial;
pub mod watch;

pub use body_surface::BodySurface;
pub use law::{Compliance, Guide, Law, Multiplier, Response, Status};
pub use master::{Ground, Master, Masters, Meets, Receiver};
pub use mates::Mate;
pub use method::{Discretization, Enforcement, Interference, MasterSurface, Tangent};
pub use moves::Movement;
pub use pose::{Axle, Pose, Rotation};
pub use segment::{Faces, Segments};
pub use self_contact::{Avoided, Outlook};
pub use slave::{Beside, Committed, Held, Local, Manner, Mover, Sights, Slave};
pub use tool::Tool;
pub use trial::{Trial, touching};
pub use watch::Sight;

use crate::Vec3;
use crate::controls::Controls;
use crate::parallel::max;
use crate::partition::Gather;
use crate::surface::{EXTENSION, Patch, Projection, Sides};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// A surface of a body that takes part in a contact.
#[derive(Clone, Debug)]
pub struct Side {
    /// Index of the body, and of the surface in the part's sets.
    pub body: usize,
    pub set: usize,
    /// Sections that its nodes count as.
    pub sections: Vec<usize>,
}

/// What the scene says of a contact, and how far it is kept to.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Coulomb coefficient.
    pub friction: f64,
    pub tangent: Tangent,
    /// How it is enforced: as the scene says, or by Uzawa's method since several contacts made the same conditions.
    pub method: Enforcement,
    /// What the scene says, with the penalty that it gives.
    pub asked: (Enforcement, Option<f64>),
    /// Share of Uzawa's automatic penalty: below 1 where rounding leaves too much of forces with all of it.
    pub eased: f64,
    pub interference: Interference,
    /// With Uzawa's method: penetration and slip that may remain, a length; `None` is what the solver's tolerance lets through.
    pub tolerance: Option<f64>,
}

/// Which pass of its contact a pair is, with the index of the other one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pass {
    #[default]
    Only,
    First {
        second: usize,
    },
    /// It yields where nodes of both sides coincide.
    Second {
        first: usize,
    },
}

impl Pass {
    /// Index of the pair that is the other pass of the same contact.
    pub fn other(self) -> Option<usize> {
        match self {
            Self::Only => None,
            Self::First { second: other } | Self::Second { first: other } => Some(other),
        }
    }

    pub fn is_second(self) -> bool {
        matches!(self, Self::Second { .. })
    }
}

/// Of a pair with both sides on one body: only faces that look at each other can meet.
#[derive(Clone, Debug)]
pub struct Within {
    /// Cosine between the normals of what meets, at most.
    pub facing: f64,
    /// In self-contact what each slave node must not meet; else empty.
    pub avoided: Vec<Avoided>,
    /// From segment to segment the same of each face.
    pub of_faces: Vec<Avoided>,
    /// The nodes that the thickness of its sheets depends on.
    pub sheet: Gather,
}

/// A contact pair on this rank: the owned nodes of a slave surface against a master.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: String,
    pub master: Master,
    /// The slave, and a master on a body.
    pub side: Side,
    pub master_side: Option<Side>,
    /// Both sides are layers, in plane strain or axisymmetric: nothing happens along z.
    pub planar: bool,
    pub rules: Rules,
    pub pass: Pass,
    pub within: Option<Within>,
    pub slaves: Vec<Slave>,
    /// Owned nodes at which the slave goes on as its mirror image, with unit normals of the planes, at right angles where a node is in
    /// several.
    pub mirrored: Vec<(u32, Vec3)>,
    /// Where the slave nodes looked at the last converged increment: unit normals, by the areas of the facets around.
    pub outward: Vec<Vec3>,
    /// From segment to segment the slave's faces.
    pub faces: Option<Faces>,
    /// Distance from the master within which a slave node is projected.
    pub reach: f64,
    /// Longest edge of the slave facets.
    pub facet_size: f64,
    pub controls: Controls,
}

impl Pair {
    /// What slave node `slave` can meet from `x`: within a body only what looks at it.
    pub fn outlook<'a>(&'a self, slave: usize, x: &'a Vec3) -> Outlook<'a> {
        self.within.as_ref().map_or(Outlook::everywhere(x), |within| Outlook {
            x,
            outward: self.outward.get(slave),
            avoided: within.avoided.get(slave),
            facing: within.facing,
        })
    }

    /// The same of a point at `x` of the slave's face `f`, which looks along `outward`.
    pub fn outlook_of_face<'a>(&'a self, f: usize, x: &'a Vec3, outward: &'a Vec3) -> Outlook<'a> {
        self.within.as_ref().map_or(Outlook::everywhere(x), |within| Outlook {
            x,
            outward: Some(outward),
            avoided: within.of_faces.get(f),
            facing: within.facing,
        })
    }

    /// Whether both sides are on one body.
    pub fn is_within_body(&self) -> bool {
        self.within.is_some()
    }

    /// Within a body where slave node `slave` looked at the last converged increment: what it meets looks back at it.
    pub fn must_face(&self, slave: usize) -> Option<&Vec3> {
        self.outward.get(slave).filter(|_| self.is_within_body())
    }

    /// In self-contact what slave node `slave` must not meet.
    pub fn avoided(&self, slave: usize) -> Option<&Avoided> {
        self.within.as_ref().and_then(|within| within.avoided.get(slave))
    }

    /// Index of the body of the master, if it is on one.
    pub fn master_body(&self) -> Option<usize> {
        self.master_side.as_ref().map(|side| side.body)
    }

    /// Whether one of its sides is on a body.
    pub fn is_of(&self, body: usize) -> bool {
        self.side.body == body || self.master_body() == Some(body)
    }

    /// The force that slave node `s`, now at `position`, bore at the last converged increment, N, if it has left the master past
    /// an end, and is behind the plane on which it was: no gap has opened, and the facets around it still reach over the end.
    /// Otherwise what of that has not been told.
    pub fn slid_off(&self, s: usize, ground: &Ground, position: &Vec3) -> f64 {
        let slave = &self.slaves[s];
        if slave.trial.projection.is_some() || !self.slides_at_nodes() {
            return 0.0;
        }
        let last = slave.accepted.projection.filter(|_| slave.accepted.status != Status::Gap);
        let is_behind = |last: &Projection| {
            let end = ground.nearest(self, s, &ground.seen_from(position), self.reach)?;
            Some((position - ground.in_space(&end.point)).dot(&last.normal) < 0.0)
        };
        match last {
            Some(last) if is_behind(&last) == Some(true) => slave.accepted.force.norm(),
            _ => slave.committed.slid,
        }
    }

    /// Whether slave node `slave` may meet a patch before long: in self-contact none around it or that looks the same way.
    pub fn may_meet(&self, slave: usize, patch: &Patch) -> bool {
        match (self.must_face(slave), self.avoided(slave)) {
            (Some(outward), Some(avoided)) => avoided.may_meet(outward, patch),
            _ => true,
        }
    }

    /// Distance from the slave nodes within which the master must be known: points of the faces around them are farther away.
    pub fn sight_reach(&self) -> f64 {
        self.reach + self.faces.as_ref().map_or(0.0, |_| self.facet_size)
    }

    /// How deep its slave nodes begin inside the master, at most. Collective.
    pub fn overlap(&self, comm: &SimpleCommunicator) -> f64 {
        let mut deepest = [self.slaves.iter().map(|slave| slave.overlap).fold(0.0, f64::max)];
        max(comm, &mut deepest);
        deepest[0]
    }

    /// What counts as on one side of the master.
    pub fn sides(&self) -> Sides {
        Sides { aside: self.controls.edge_aside * self.facet_size, turn: self.controls.kink_turn }
    }

    /// How far past an end of the master a slave node may be and still be on it, a length. Pieces go on by [`EXTENSION`]: of those that
    /// are up to twice as long as the slave's facets that is less, but one may be as large as a face of CAD, and nothing holds up
    /// what hangs over its end.
    pub fn overhang(&self) -> f64 {
        2.0 * EXTENSION * self.facet_size
    }

    /// The place among the slaves of that at an owned node, if there is one.
    pub fn index_of(&self, node: u32) -> Option<usize> {
        self.slaves.binary_search_by_key(&node, |s| s.node).ok()
    }

    /// Whether active sets can have the place of its augmented Lagrangian.
    pub fn can_sort(&self) -> bool {
        self.rules.method == Enforcement::AugmentedLagrangian && !self.is_self()
    }

    /// Whether it can be sought along the central path: with a status that is not given, between sides that tell gaps apart.
    pub fn is_smooth(&self) -> bool {
        self.rules.method != Enforcement::Lagrange && !self.is_self() && self.pass == Pass::Only
    }

    /// Whether each slave node meets one node of the master for good.
    pub fn is_by_nodes(&self) -> bool {
        matches!(self.master, Master::Surface(_, Meets::Nodes))
    }

    /// Whether nodes alone slide over the faces of something else, and do not feel between them where these end.
    pub fn slides_at_nodes(&self) -> bool {
        self.faces.is_none() && !self.is_self() && !self.is_by_nodes()
    }

    /// Whether a slave node that is exactly between pieces of the master is on all of them, see [`Ground::evenly`].
    pub fn may_be_between(&self) -> bool {
        self.faces.is_none() && !self.is_within_body() && !self.is_by_nodes()
    }

    /// Whether a surface meets itself.
    pub fn is_self(&self) -> bool {
        matches!(self.master, Master::Surface(_, Meets::Own))
    }

    /// How far a slave node may move in one iteration.
    pub fn longest_step(&self) -> f64 {
        let avoided = self.within.iter().flat_map(|within| &within.avoided);
        avoided
            .map(|avoided| self.controls.self_step * avoided.deep())
            .fold(self.controls.step_facets * self.facet_size, f64::min)
    }

    /// Has the slave nodes enforced by a method, with the penalty of the scene where it is the one that was asked for.
    pub fn enforce(&mut self, method: Enforcement) {
        let given = self.rules.asked.1.filter(|_| method == self.rules.asked.0);
        self.rules.method = method;
        let eased = if method == Enforcement::Uzawa { self.rules.eased } else { 1.0 };
        for slave in &mut self.slaves {
            let stiffness = slave.stiffness(&self.controls);
            slave.enforce(method, given.unwrap_or(eased * penalty_share(method, &self.controls) * stiffness));
        }
    }

    /// Divides the automatic penalty of Uzawa's method by as much, down to the stiffness that it is a multiple of; what rounding
    /// leaves of forces falls with it, and the solution does not depend on it. Says whether there was anything to divide.
    pub fn ease(&mut self, by: f64) -> bool {
        let given = self.rules.asked.1.filter(|_| self.rules.method == self.rules.asked.0);
        let eased = (self.rules.eased / by).max(1.0 / self.controls.uzawa_penalty);
        if self.rules.method != Enforcement::Uzawa || given.is_some() || eased >= self.rules.eased {
            return false;
        }
        let times = self.rules.eased / eased;
        self.slaves.iter_mut().for_each(|slave| slave.committed.held.gap *= times);
        self.rules.eased = eased;
        self.enforce(Enforcement::Uzawa);
        true
    }

    /// Has multipliers that are unknowns held from now on, with the forces of the last converged increment, at which the
    /// master's `ground` is.
    pub fn hold(&mut self, ground: &Ground) {
        self.enforce(Enforcement::Uzawa);
        self.slaves.iter_mut().for_each(|slave| slave.committed.held = slave.held_at(ground));
    }

    /// Multipliers that a slave node may have as unknowns: none when they are held, one without friction, three with.
    pub fn width(&self) -> usize {
        match self.rules.method.holds_multipliers() {
            true => 0,
            false if self.rules.friction > 0.0 => 3,
            false => 1,
        }
    }
}

/// Automatic penalty over the stiffness with which a slave node, or a softer master, resists contact.
fn penalty_share(method: Enforcement, controls: &Controls) -> f64 {
    match method {
        Enforcement::AugmentedLagrangian | Enforcement::Lagrange => controls.augmentation,
        Enforcement::Uzawa => controls.uzawa_penalty,
        Enforcement::Penalty => controls.penalty_method,
    }
}

/// The slave nodes that touch, as `touches` says, with the pairs in which they do and what they are there.
pub fn touching_nodes(pairs: &[Pair], touches: impl Fn(&Pair, &Slave) -> bool) -> BTreeMap<u32, Vec<(usize, &Slave)>> {
    let mut of_node: BTreeMap<u32, Vec<(usize, &Slave)>> = BTreeMap::new();
    for (p, pair) in pairs.iter().enumerate() {
        for slave in pair.slaves.iter().filter(|slave| touches(pair, slave)) {
            of_node.entry(slave.node).or_default().push((p, slave));
        }
    }
    of_node
}

/// Notes for each slave node what other master it touched at the last converged increment.
pub fn note_bearers(pairs: &mut [Pair]) {
    if pairs.len() < 2 {
        return;
    }
    let touching = touching_nodes(pairs, |_, slave| slave.committed.status != Status::Gap);
    let normals = |at: Vec<(usize, &Slave)>| -> Vec<(usize, Vec3)> {
        at.into_iter().filter_map(|(p, slave)| Some((p, slave.accepted.projection?.normal))).collect()
    };
    let of_node: BTreeMap<u32, Vec<(usize, Vec3)>> = touching.into_iter().map(|(n, at)| (n, normals(at))).collect();
    for (p, pair) in pairs.iter_mut().enumerate() {
        for slave in &mut pair.slaves {
            let others = of_node.get(&slave.node).map_or(&[][..], |all| all);
            slave.borne = others.iter().find(|(other, _)| *other != p).map(|(_, normal)| *normal);
        }
    }
}
