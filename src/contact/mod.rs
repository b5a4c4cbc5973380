//! Contact of slave nodes with rigid tools and with the faces of deformable bodies.
//!
//! - [`law`]: Coulomb friction by multipliers and penalties, what the contact elements have in common
//! - [`element`]: the element of a slave node and its master, residual and tangent
//! - [`master`]: tools and the surfaces of bodies behind one type
//! - [`meeting`]: where a slave node meets its master at an iterate, and what its element is evaluated with
//! - [`moves`]: how a step moves points, as far as it prescribes that
//! - [`pose`]: where a tool is
//! - [`tool`]: tools in their place, and which part of them a rank watches
//! - [`self_contact`]: which patches of its own surface a node may meet
//! - [`body_surface`]: a deformable master surface that moves with its nodes, wherever they are owned
//! - [`method`]: how contact is described and enforced, by name
//! - [`mates`]: contact from node to node
//! - [`segment`]: contact from segment to segment
//! - [`watch`]: whether a node went through the master, by its place alone
//! - [`guidance`]: whether slave and master are the right way round
//! - [`stiffness`]: how stiffly bodies resist contact forces, the unit of penalties
//! - here: the contact pairs, and the state of their slave nodes

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
pub mod stiffness;
pub mod tool;
pub mod watch;

pub use body_surface::BodySurface;
pub use law::{Compliance, Guide, Law, Multiplier, Response, Status};
pub use master::{Ground, Master, Masters, Meets, Receiver};
pub use mates::Mate;
pub use method::{Discretization, Enforcement, MasterSurface, Tangent};
pub use moves::Movement;
pub use pose::{Axle, Pose, Rotation};
pub use segment::{Faces, Segments};
pub use self_contact::{Avoided, Outlook};
pub use tool::Tool;
pub use watch::Sight;

use crate::controls::Controls;
use crate::partition::Gather;
use crate::surface::{Patch, Projection};
use crate::{Mat3, Vec3};
use std::collections::BTreeMap;

/// A contact pair on this rank: the owned nodes of a slave surface against a master.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: String,
    pub master: Master,
    /// Index of the body of the slave nodes, and of that of the master.
    pub body: usize,
    pub master_body: Option<usize>,
    /// Sections that nodes of the slave count as, and of a master on a body.
    pub sections: Vec<usize>,
    pub master_sections: Vec<usize>,
    /// Both sides are layers, in plane strain or axisymmetric: nothing happens along z.
    pub planar: bool,
    /// Coulomb coefficient.
    pub friction: f64,
    pub tangent: Tangent,
    /// How it is enforced: as the scene says, or by Uzawa's method since several contacts made the same conditions.
    pub method: Enforcement,
    /// What the scene says, with the penalty that it gives.
    pub asked: (Enforcement, Option<f64>),
    /// With Uzawa's method: penetration and slip that may remain, a length; `None` is what the solver's tolerance lets through.
    pub tolerance: Option<f64>,
    /// Index of the slave surface in the part's sets.
    pub set: usize,
    pub slaves: Vec<Slave>,
    /// From segment to segment the slave's faces.
    pub faces: Option<Faces>,
    /// Distance from the master within which a slave node is projected.
    pub reach: f64,
    /// Longest edge of the slave facets.
    pub facet_size: f64,
    /// Both sides are on one body: only faces that look at each other can meet.
    pub within_body: bool,
    /// Cosine between the normals of what meets in self-contact, at most.
    pub facing: f64,
    pub controls: Controls,
    /// Within a body the outward unit normals of the slave nodes at the last converged increment.
    pub outward: Vec<Vec3>,
    /// Index of the pair that is the other pass of the same contact.
    pub other: Option<usize>,
    /// It is the second pass, which yields where nodes of both sides coincide.
    pub is_second: bool,
    /// In self-contact what each slave node must not meet; else empty.
    pub avoided: Vec<Avoided>,
    /// The nodes that the thickness of its sheets depends on.
    pub sheet: Gather,
}

impl Pair {
    /// What slave node `slave` can meet from `x`: within a body only what looks at it.
    pub fn outlook<'a>(&'a self, slave: usize, x: &'a Vec3) -> Outlook<'a> {
        Outlook { x, outward: self.outward.get(slave), avoided: self.avoided.get(slave), facing: self.facing }
    }

    /// Whether slave node `slave` may meet a patch before long: in self-contact none around it or that looks the same way.
    pub fn may_meet(&self, slave: usize, patch: &Patch) -> bool {
        match (self.outward.get(slave), self.avoided.get(slave)) {
            (Some(outward), Some(avoided)) => avoided.may_meet(outward, patch),
            _ => true,
        }
    }

    /// Distance from the slave nodes within which the master must be known: points of the faces around them are farther away.
    pub fn sight_reach(&self) -> f64 {
        self.reach + self.faces.as_ref().map_or(0.0, |_| self.facet_size)
    }

    /// The slave at an owned node, if there is one.
    pub fn slave_at(&mut self, node: u32) -> Option<&mut Slave> {
        self.slaves.binary_search_by_key(&node, |s| s.node).ok().map(|s| &mut self.slaves[s])
    }

    /// Whether it can be sought along the central path: with a status that is not given, between sides that tell gaps apart.
    pub fn is_smooth(&self) -> bool {
        self.method != Enforcement::Lagrange && !self.is_self() && self.other.is_none()
    }

    /// Whether a surface meets itself.
    pub fn is_self(&self) -> bool {
        matches!(self.master, Master::Surface(_, Meets::Own))
    }

    /// How far a slave node may move in one iteration.
    pub fn longest_step(&self) -> f64 {
        self.avoided
            .iter()
            .map(|avoided| self.controls.self_step * avoided.deep())
            .fold(self.controls.step_facets * self.facet_size, f64::min)
    }

    /// Has the slave nodes enforced by a method, with the penalty of the scene where it is the one that was asked for.
    pub fn enforce(&mut self, method: Enforcement) {
        let given = self.asked.1.filter(|_| method == self.asked.0);
        self.method = method;
        for slave in &mut self.slaves {
            let stiffness = slave.automatic / self.controls.augmentation;
            slave.enforce(method, given.unwrap_or(penalty_share(method, &self.controls) * stiffness));
        }
    }

    /// Has multipliers that are unknowns held from now on, with the forces of the last converged increment, at which the
    /// master's `ground` is.
    pub fn hold(&mut self, ground: &Ground) {
        self.enforce(Enforcement::Uzawa);
        self.slaves.iter_mut().for_each(|slave| slave.committed.held = slave.held_at(ground));
    }

    /// Multipliers that a slave node may have as unknowns: none when they are held, one without friction, three with.
    pub fn width(&self) -> usize {
        match self.method.holds_multipliers() {
            true => 0,
            false if self.friction > 0.0 => 3,
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

/// Notes for each slave node what other master it touched at the last converged increment.
pub fn note_bearers(pairs: &mut [Pair]) {
    if pairs.len() < 2 {
        return;
    }
    let mut of_node: BTreeMap<u32, Vec<(usize, Vec3)>> = BTreeMap::new();
    for (p, pair) in pairs.iter().enumerate() {
        for slave in pair.slaves.iter().filter(|slave| slave.committed.status != Status::Gap) {
            let at = slave.accepted.projection.map(|at| (p, at.normal));
            of_node.entry(slave.node).or_default().extend(at);
        }
    }
    for (p, pair) in pairs.iter_mut().enumerate() {
        for slave in &mut pair.slaves {
            let others = of_node.get(&slave.node).map_or(&[][..], |all| all);
            slave.borne = others.iter().find(|(other, _)| *other != p).map(|(_, normal)| *normal);
        }
    }
}

/// In which way an increment is sought.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manner {
    /// What touches sticks until all is nearly in balance.
    pub settles: bool,
    /// It begins from an extrapolation, in which what slips slips on.
    pub ahead: bool,
    /// With automatic penalties, whatever is given.
    pub automatic: bool,
    /// With penalties that are lower than the automatic ones, and those that are given, by `soft_augmentation` of the [`Controls`].
    pub soft: bool,
    /// Along the central path.
    pub central: bool,
    /// It has failed before: what goes to and fro over a kink keeps to its side at the first return.
    pub again: bool,
    /// The constraints of multipliers give way until they are tightened, by `slack`, in self-contact by `wide_slack` of the
    /// [`Controls`].
    pub yields: bool,
}

/// A slave node and its history.
#[derive(Clone, Debug)]
pub struct Slave {
    /// Owned local node.
    pub node: u32,
    pub law: Law,
    /// The one node of the master that it meets, in contact from node to node.
    pub mate: Option<Mate>,
    /// Another slave node may make the same constraint, for its surface meets itself.
    pub repeats: bool,
    /// The automatic augmentation, force per length.
    pub automatic: f64,
    /// Penalties in the law at the start of an increment, and by what share they are lower in it.
    augmentation: f64,
    pub softness: f64,
    /// The multiplier, where it is no unknown.
    pub held: Held,
    /// The force, where it is a local unknown.
    pub local: Local,
    /// State of the last converged increment.
    pub committed: Committed,
    /// State of the current iterate.
    pub trial: Trial,
    /// The iterate that became the last converged increment.
    pub accepted: Trial,
    /// Normal of another master that it touched then.
    pub borne: Option<Vec3>,
    /// What the watch saw of it at the last converged increment, and of the one that is judged.
    pub sight: Sight,
    pub sighted: Sight,
    /// The patches of a body that its points were on at the last iterate, with their slip origins.
    pub met: Vec<u32>,
}

/// What a slave node remembers of the last converged increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Committed {
    /// Nodal contact force λ, N; without friction λ_n stands in the first entry.
    pub multiplier: Vec3,
    /// Closest point, in the frame of a tool the slip origin, else in space. Kept for every node in reach, in contact or not.
    pub anchor: Option<Vec3>,
    /// Where the node itself was, in the frame of a tool, else in space.
    pub place: Option<Vec3>,
    /// Patch and parameters of the closest point, where the next projection starts: on a deformable master, the slip
    /// origin.
    pub warm: Option<(u32, [f64; 2])>,
    pub status: Status,
    /// What a multiplier that is no unknown begins the next increment with.
    pub held: Held,
}

crate::words!(Committed { multiplier, anchor, place, warm, status, held });

/// A multiplier that is held while Newton's method runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// λ_n / ε: a gap that is added.
    pub gap: f64,
    /// A part of λ_t, in space.
    pub tangential: Vec3,
    /// A part that the master carries along: in the frame of the tool, or of the slip origin on a deformable master.
    pub carried: Vec3,
}

crate::words!(Held { gap, tangential, carried });

/// A local unknown, the force of a slave node, as a linear function of positions: what the last tangent has for it.
#[derive(Clone, Debug, Default)]
pub struct Local {
    /// σ where the positions are those of then.
    pub force: Vec3,
    /// Derivatives by the positions of nodes, with these positions.
    pub by: Vec<(Mover, Mat3, Vec3)>,
}

/// A node that a slave node's contact depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// A node of the slave, by its local number.
    Slave(u32),
    /// A node of the master, by its number whatever the rank sees.
    Master(u64),
}

impl Local {
    /// σ at other positions.
    pub fn at(&self, place: impl Fn(Mover) -> Option<Vec3>) -> Vec3 {
        let moved = |(mover, by, then): &(Mover, Mat3, Vec3)| by * (place(*mover).unwrap_or(*then) - then);
        self.force + self.by.iter().map(moved).sum::<Vec3>()
    }

    /// Takes over a tangent: the unknown `force` with its response.
    pub fn learn(&mut self, force: Vec3, response: &Response) {
        self.by.clear();
        self.force = force - response.inverse * response.constraint;
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
    /// The piece of the master that it left last, and how often it has come back to one.
    pub left: Option<u32>,
    pub returns: u32,
    /// From so many returns on it keeps to its side of kinks.
    pub patience: u32,
    /// Slip since the last converged increment.
    pub slip: Vec3,
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
    left,
    returns,
    patience,
    slip,
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
        let slips = status == Status::Slip && self.status == Status::Slip;
        let turned = slips && self.projection.as_ref().is_some_and(turned);
        self.changed = status != self.status || turned;
        self.flips = if self.changed { self.flips + 1 } else { 0 };
        (self.status, self.force, self.slip) = (status, force, slip);
        (self.asked, self.violation, self.local) = (asked, violation, constraint.amax());
    }

    /// Takes over where it is on the master; it was on the piece `last` before.
    pub fn stand(&mut self, projection: Option<Projection>, last: Option<u32>) {
        self.projection = projection;
        if let (Some(here), Some(last)) = (projection.map(|p| p.patch), last)
            && here != last
        {
            self.returns += u32::from(self.left == Some(here));
            self.left = Some(last);
        }
    }

    /// The force along the surface.
    pub fn traction(&self) -> Vec3 {
        self.projection.map_or(Vec3::zeros(), |p| self.force - p.normal * p.normal.dot(&self.force))
    }
}

impl Slave {
    /// A node with the automatic augmentation, force per length, that is not enforced yet.
    pub fn new(node: u32, friction: f64, automatic: f64) -> Self {
        let (compliance, augmentation) = (Compliance::default(), automatic);
        let law = Law {
            friction,
            normal: automatic,
            tangential: automatic,
            penalty: automatic,
            rough: false,
            compliance,
            barrier: 0.0,
        };
        let (committed, trial, accepted) = (Committed::default(), Trial::default(), Trial::default());
        let (held, local) = (Held::default(), Local::default());
        let (sight, sighted) = (Sight::default(), Sight::default());
        Self {
            node,
            law,
            mate: None,
            repeats: false,
            automatic,
            augmentation,
            softness: 1.0,
            held,
            local,
            committed,
            trial,
            accepted,
            borne: None,
            sight,
            sighted,
            met: Vec::new(),
        }
    }

    /// Has the node enforced with a penalty, force per length. Where multipliers are held the automatic augmentation acts below
    /// it, else the penalty itself.
    fn enforce(&mut self, method: Enforcement, penalty: f64) {
        self.augmentation = if method.holds_multipliers() { self.automatic.min(penalty) } else { penalty };
        self.law = Law { normal: self.augmentation, tangential: self.augmentation, penalty, ..self.law };
    }

    /// Bytes that it takes, with what it was last evaluated with.
    pub fn bytes(&self) -> usize {
        let local = self.local.by.capacity() * size_of::<(Mover, Mat3, Vec3)>();
        size_of::<Self>() + local + size_of::<Option<meeting::Meeting>>()
    }

    /// The penalty by which gaps count, where the multiplier is an unknown: none that is given makes them large.
    pub fn measure(&self) -> f64 {
        self.law.normal.min(self.automatic)
    }

    /// Begins an increment from the last converged one.
    pub fn begin(&mut self, manner: &Manner, controls: &Controls) {
        let (status, yields) = (self.committed.status, self.accepted.yields);
        let patience = if manner.again { 1 } else { controls.kink_returns as u32 };
        self.trial = Trial { status, yields, patience, ..Trial::default() };
        let automatic = manner.automatic || manner.soft;
        let augmentation = if automatic { self.automatic.min(self.law.penalty) } else { self.augmentation };
        self.softness = if manner.soft { controls.soft_augmentation } else { 1.0 };
        let augmentation = augmentation * self.softness;
        (self.law.normal, self.law.tangential) = (augmentation, augmentation);
        self.law.barrier = 0.0;
        self.law.rough = manner.settles && !(manner.ahead && status == Status::Slip);
        let slack = match (self.repeats, manner.yields) {
            (true, true) => controls.wide_slack,
            (true, false) | (false, true) => controls.slack,
            (false, false) => 0.0,
        };
        let rest = if self.repeats { Vec3::zeros() } else { self.committed.multiplier };
        // Over a lower penalty they give way by as much.
        self.law.compliance = Compliance { slack: slack * self.softness, rest };
        self.held = self.committed.held;
        self.local.force = self.committed.multiplier;
        self.local.by.clear();
    }

    /// Reduces the friction penalty, with local unknowns all of the augmentation; `false` when it is low. The solution does
    /// not depend on it.
    pub fn calm(&mut self, method: Enforcement, controls: &Controls) -> bool {
        let least = controls.calm_least * self.augmentation;
        let can = self.law.friction > 0.0 && self.law.tangential > least;
        if can {
            self.law.tangential *= controls.calm_factor;
            if method.holds_multipliers() {
                self.law.normal = self.law.tangential;
            }
        }
        can
    }

    /// The multiplier of `method`, where `lambda` is that of the unknowns, beside the local unknown `force`; without the part of
    /// one that is held which the master carries along.
    pub fn multiplier(&self, method: Enforcement, lambda: Vec3, force: Vec3) -> Multiplier {
        let Held { gap, tangential, .. } = self.held;
        match method {
            Enforcement::AugmentedLagrangian => Multiplier::Augmented(lambda),
            Enforcement::Lagrange => Multiplier::Force(lambda, self.trial.status),
            _ => Multiplier::Held { gap, tangential, force },
        }
    }

    /// What the multiplier becomes when it takes over the force of the iterate, for now.
    pub fn taken_over(&self) -> Held {
        match (self.trial.status, self.trial.projection) {
            (Status::Stick | Status::Slip, Some(p)) => {
                let friction = if self.law.friction > 0.0 { self.trial.traction() } else { Vec3::zeros() };
                Held { gap: self.held.gap + p.gap, tangential: friction, carried: Vec3::zeros() }
            }
            _ => Held::default(),
        }
    }

    /// The multiplier at the beginning of the next increment, with the master's `frame` as it is now: the friction force,
    /// carried along; for Uzawa's method also the normal force.
    fn handed_on(&self, method: Enforcement, frame: &Mat3) -> Held {
        let Held { gap, tangential, .. } = self.taken_over();
        match (method, frame.try_inverse()) {
            (Enforcement::Penalty, Some(inverse)) => Held { carried: inverse * tangential, ..Held::default() },
            (Enforcement::Uzawa, Some(inverse)) => Held { gap, carried: inverse * tangential, ..Held::default() },
            _ => Held::default(),
        }
    }

    /// What Uzawa's method begins with after an increment that another one has ended with, the master's `ground` as it was then.
    fn held_at(&self, ground: &Ground) -> Held {
        let Trial { status, force, projection, .. } = &self.accepted;
        match (status, projection, ground.carrier(projection.as_ref()).try_inverse()) {
            (Status::Stick | Status::Slip, Some(p), Some(inverse)) => Held {
                gap: force.dot(&p.normal) / self.law.penalty,
                tangential: Vec3::zeros(),
                carried: inverse * self.accepted.traction(),
            },
            _ => Held::default(),
        }
    }

    /// Takes back the gap of the last increment, which a multiplier has taken over for the next: the force is then again that
    /// of its end.
    pub fn hand_back(&mut self) {
        if let (Status::Stick | Status::Slip, Some(p)) = (self.accepted.status, self.accepted.projection) {
            self.held.gap -= p.gap;
        }
    }

    /// Whether the node, found at `position` inside the master, has come past an end of its surface, and is beside the
    /// master, not in it: at the last converged increment it was on none of it, and at `start`, its place then as seen from
    /// the master now, behind the point where it is found; and if it has come far, it had nowhere on its way a `gap`. One that
    /// touched another master, with much the same normal, goes from there on to this one.
    pub fn is_beside(
        &self,
        start: impl FnOnce() -> Option<Vec3>,
        position: &Vec3,
        at: &Projection,
        (facet_size, controls): (f64, &Controls),
        gap: impl Fn(&Vec3) -> Option<f64>,
    ) -> bool {
        const BEHIND: f64 = 1e-6;
        const MOST: f64 = 32.0;
        if at.gap >= 0.0 || self.committed.warm.is_some() {
            return false;
        }
        let goes_over = |borne: Vec3| {
            -at.gap <= controls.hand_over * facet_size && borne.dot(&at.normal) >= 1.0 - controls.kink_turn
        };
        if self.borne.is_some_and(goes_over) {
            return false;
        }
        let Some(start) = start() else { return false };
        if (start - at.point).dot(&at.normal) >= -BEHIND * facet_size {
            return false;
        }
        let way = position - start;
        // Steps of a facet: within one, start and end tell enough.
        let steps = (way.norm() / facet_size).min(MOST) as usize;
        (0..steps).all(|k| gap(&(start + way * (k as f64 / steps as f64))).is_none_or(|gap| gap < 0.0))
    }

    /// Accepts the current iterate, with the node at `position`: remembers where it met the master, as that is remembered.
    pub fn commit(&mut self, method: Enforcement, multiplier: Vec3, ground: &Ground, position: &Vec3) {
        (self.accepted, self.sight) = (self.trial, self.sighted);
        let projection = self.trial.projection;
        self.committed = Committed {
            held: self.handed_on(method, &ground.carrier(projection.as_ref())),
            multiplier,
            anchor: projection.map(|p| ground.inward(&p.point)),
            place: Some(ground.inward(position)),
            warm: projection.map(|p| (p.patch, p.xi)),
            status: self.trial.status,
        };
    }
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
