//! A slave node: its law, what it remembers, and where it is.

use super::master::Ground;
use super::mates::Mate;
use super::method::Enforcement;
use super::trial::{Kinks, Trial};
use super::watch::Sight;
use super::{Compliance, Guide, Law, Multiplier, Response, Status, meeting};
use crate::controls::Controls;
use crate::surface::Projection;
use crate::{Mat3, Vec3};

/// In which way an increment is sought.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manner {
    /// What touches sticks until all is nearly in balance.
    pub settles: bool,
    /// What begins to touch slips without friction until all is in balance.
    pub glides: bool,
    /// It begins from an extrapolation, in which what slips slips on.
    pub ahead: bool,
    /// With automatic penalties, whatever is given.
    pub automatic: bool,
    /// With penalties that are lower than the automatic ones, and those that are given, by `soft_augmentation` of the [`Controls`].
    pub soft: bool,
    /// What touched goes along with its master in the first iteration, wherever that goes.
    pub clings: bool,
    /// Friction grows by `creep` of the [`Controls`] with each facet of slip.
    pub creeps: bool,
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
    /// Another slave node may make the same constraint, for its surface meets itself: by how much it gives way in the end, compliance
    /// over that of the automatic penalty.
    pub repeats: Option<f64>,
    pub penalties: Penalties,
    /// How deep inside the master it begins; none in self-contact.
    pub overlap: f64,
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
    pub sights: Sights,
    /// The patches of a body that its points were on at the last iterate, with their slip origins.
    pub met: Vec<u32>,
    /// The pieces of the master that it was exactly between at the last iterate; none if it was not.
    pub pieces: Vec<Beside>,
}

/// Where the penalties of a slave node's law begin.
#[derive(Clone, Copy, Debug)]
pub struct Penalties {
    /// The automatic augmentation, force per length.
    pub automatic: f64,
    /// That which the law has at the start of an increment, and by what share it is lower in it.
    augmentation: f64,
    pub softness: f64,
}

/// What the watch saw of a slave node.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sights {
    /// At the last converged increment.
    pub accepted: Sight,
    /// At the end of the one that is judged.
    pub judged: Sight,
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
    /// The others, where the node was exactly between pieces, with their shares.
    pub beside: [Beside; BESIDE],
    /// It keeps to that patch beyond its kink, and still does so as the next increment begins: the state would not be in
    /// equilibrium on the other side.
    pub keeps: bool,
    /// The stiffness with which both sides of a hollow kink hold it, see [`Kinks`].
    pub wedge: f64,
    pub status: Status,
    /// What a multiplier that is no unknown begins the next increment with.
    pub held: Held,
    /// The force with which it slid off the master, see [`super::Pair::slid_off`], until that is told.
    pub slid: f64,
    /// It began past an end of the master, and has not been in front of it since.
    pub aside: bool,
}

crate::words!(Committed { multiplier, anchor, place, warm, beside, keeps, wedge, status, held, slid, aside });

/// As many pieces as are told apart besides the first: six triangles around a corner.
const BESIDE: usize = 5;

/// Piece and parameters of a closest point that is one of several, and its share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beside {
    pub patch: u32,
    pub xi: [f64; 2],
    pub share: f64,
}

crate::words!(Beside { patch, xi, share });

/// A number for several pieces, beyond the ids of pieces.
pub fn number_of(pieces: &[Beside]) -> Option<u32> {
    const FIRST: u32 = 1 << 31;
    let number = |number: u32, piece: &Beside| number.wrapping_mul(31).wrapping_add(piece.patch);
    (!pieces.is_empty()).then(|| pieces.iter().fold(0, number) | FIRST)
}

impl Committed {
    /// Piece, parameters and share of each closest point of the last converged increment.
    pub fn origins(&self) -> impl Iterator<Item = Beside> {
        let beside = self.beside.into_iter().filter(|beside| beside.share > 0.0);
        let share = 1.0 - beside.clone().map(|beside| beside.share).sum::<f64>();
        self.warm.map(|(patch, xi)| Beside { patch, xi, share }).into_iter().chain(beside)
    }

    /// Whether the node was exactly between pieces.
    pub fn was_between(&self) -> bool {
        self.beside[0].share > 0.0
    }
}

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

impl Slave {
    /// A node with the automatic augmentation, force per length, that is not enforced yet.
    pub fn new(node: u32, friction: f64, automatic: f64) -> Self {
        let compliance = Compliance::default();
        let law = Law {
            friction,
            normal: automatic,
            tangential: automatic,
            penalty: automatic,
            rough: false,
            glides: false,
            clings: false,
            allowed: 0.0,
            compliance,
            barrier: 0.0,
            creep: 0.0,
            drawn_least: 0.0,
        };
        let (committed, trial, accepted) = (Committed::default(), Trial::default(), Trial::default());
        let (held, local) = (Held::default(), Local::default());
        Self {
            node,
            law,
            mate: None,
            repeats: None,
            penalties: Penalties { automatic, augmentation: automatic, softness: 1.0 },
            overlap: 0.0,
            held,
            local,
            committed,
            trial,
            accepted,
            borne: None,
            sights: Sights::default(),
            met: Vec::new(),
            pieces: Vec::new(),
        }
    }

    /// Has the node enforced with a penalty, force per length. Where multipliers are held the automatic augmentation acts below
    /// it, else the penalty itself.
    pub(super) fn enforce(&mut self, method: Enforcement, penalty: f64) {
        let augmentation = if method.holds_multipliers() { self.penalties.automatic.min(penalty) } else { penalty };
        self.penalties.augmentation = augmentation;
        self.law = Law { normal: augmentation, tangential: augmentation, penalty, ..self.law };
    }

    /// How stiffly its body resists a force on it ([`super::stiffness`]), force per length.
    pub fn stiffness(&self, controls: &Controls) -> f64 {
        self.penalties.automatic / controls.augmentation
    }

    /// Bytes that it takes, with what it was last evaluated with.
    pub fn bytes(&self) -> usize {
        let local = self.local.by.capacity() * size_of::<(Mover, Mat3, Vec3)>();
        size_of::<Self>() + local + size_of::<Option<meeting::Meeting>>()
    }

    /// The penalty by which gaps count, where the multiplier is an unknown: none that is given makes them large.
    pub fn measure(&self) -> f64 {
        self.law.normal.min(self.penalties.automatic)
    }

    /// Whether it slips at the iterate, with friction.
    pub fn rubs(&self) -> bool {
        self.trial.status == Status::Slip && self.law.friction > 0.0
    }

    /// Begins an increment from the last converged one, on facets of this size.
    pub fn begin(&mut self, manner: &Manner, controls: &Controls, facet_size: f64) {
        let (status, yields) = (self.committed.status, self.accepted.yields);
        let patience = if manner.again { 1 } else { controls.kink_returns as u32 };
        let is_settled = self.committed.keeps || self.committed.wedge > 0.0;
        let returns = if is_settled { patience } else { 0 };
        self.pieces.clear();
        self.pieces.extend(self.committed.origins().filter(|_| self.committed.was_between()));
        let kinks = Kinks { patience, returns, wedge: self.committed.wedge, ..Kinks::default() };
        self.trial = Trial { status, yields, kinks, ..Trial::default() };
        let Penalties { automatic, augmentation, softness } = &mut self.penalties;
        let is_automatic = manner.automatic || manner.soft;
        *softness = if manner.soft { controls.soft_augmentation } else { 1.0 };
        let augmentation = if is_automatic { automatic.min(self.law.penalty) } else { *augmentation } * *softness;
        (self.law.normal, self.law.tangential) = (augmentation, augmentation);
        self.law.barrier = 0.0;
        self.law.drawn_least = controls.drawn_least;
        self.law.creep = if manner.creeps { controls.creep / facet_size } else { 0.0 };
        self.law.clings = manner.clings && status != Status::Gap;
        self.law.rough = manner.settles && !(manner.ahead && status == Status::Slip);
        // Not what bears already: friction may hold it where it is.
        self.law.glides = manner.glides && self.law.friction > 0.0 && self.accepted.force == Vec3::zeros();
        let slack = match (self.repeats, manner.yields) {
            (Some(_), true) => controls.wide_slack,
            (Some(slack), false) => slack,
            (None, true) => controls.slack,
            (None, false) => 0.0,
        };
        let rest = if self.repeats.is_some() { Vec3::zeros() } else { self.committed.multiplier };
        // Over a lower penalty they give way by as much.
        self.law.compliance = Compliance { slack: slack * self.penalties.softness, rest };
        self.held = self.committed.held;
        self.local.force = self.committed.multiplier;
        self.local.by.clear();
    }

    /// Reduces the friction penalty, with local unknowns all of the augmentation; `false` when it is low. The solution does
    /// not depend on it.
    pub fn calm(&mut self, method: Enforcement, controls: &Controls) -> bool {
        let least = controls.calm_least * self.penalties.augmentation;
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
                Held { gap: self.held.gap + self.law.gap(p.gap), tangential: friction, carried: Vec3::zeros() }
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
    pub(super) fn held_at(&self, ground: &Ground) -> Held {
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

    /// The part of the friction of the last increment along the directions in which it is held now, and how much of it is not kept
    /// where it rests, N. There is none in a plane of symmetry. It is not kept where the normal leans into these directions, for there
    /// the rest of it would be part of the force that presses the node. The normal of means of faces must not lean at all: what of it is
    /// across would be taken for friction.
    pub fn friction_across(&self, guide: &Guide, of_faces: bool) -> (Vec3, f64) {
        // Of the force, and of a unit vector.
        const ROUNDING: f64 = 1e-9;
        const LEANS: f64 = 1e-2;
        let (Status::Stick | Status::Slip, Some(at)) = (self.accepted.status, self.accepted.projection) else {
            return (Vec3::zeros(), 0.0);
        };
        if self.law.friction == 0.0 || guide.held == [false; 3] {
            return (Vec3::zeros(), 0.0);
        }
        let across = |v: &Vec3| v - guide.free() * v;
        let (kept, lean) = (across(&self.accepted.traction()), across(&at.normal).norm());
        let leans = lean > if of_faces { ROUNDING } else { LEANS };
        match () {
            _ if kept.norm() <= ROUNDING * self.accepted.force.norm() => (Vec3::zeros(), 0.0),
            _ if leans => (Vec3::zeros(), kept.norm()),
            _ => (kept, 0.0),
        }
    }

    /// Takes back the gap of the last increment, which a multiplier has taken over for the next: the force is then again that
    /// of its end.
    pub fn hand_back(&mut self) {
        if let (Status::Stick | Status::Slip, Some(p)) = (self.accepted.status, self.accepted.projection) {
            self.held.gap -= self.law.gap(p.gap);
        }
    }

    /// Whether the node, found at `position` inside the master, has come past an end of its surface, and is beside the
    /// master, not in it: it began there; or at the last converged increment it was on none of it, and at `start`, its place
    /// then as seen from the master now, behind the point where it is found; and if it has come far, it had nowhere on its way
    /// a `gap`. One that touched another master, with much the same normal, goes from there on to this one, however deep an
    /// iteration has it, if it was hardly behind it; and one no deeper than `shallow`, of which nobody tells, goes onto it past
    /// its end, as what is pressed into a hole that is a little too narrow.
    pub fn is_beside(
        &self,
        start: impl FnOnce() -> Option<Vec3>,
        position: &Vec3,
        at: &Projection,
        (facet_size, shallow, controls): (f64, impl FnOnce() -> f64, &Controls),
        gap: impl Fn(&Vec3) -> Option<f64>,
    ) -> bool {
        const BEHIND: f64 = 1e-6;
        const MOST: f64 = 32.0;
        if self.committed.aside {
            return at.gap <= controls.touching_gap * facet_size;
        }
        if at.gap >= 0.0 || self.committed.warm.is_some() || at.gap >= -shallow() {
            return false;
        }
        let Some(start) = start() else { return false };
        let was = (at.point - start).dot(&at.normal);
        if was <= BEHIND * facet_size || self.goes_over(at, was.min(-at.gap), facet_size, controls) {
            return false;
        }
        let way = position - start;
        // Steps of a facet: within one, start and end tell enough.
        let steps = (way.norm() / facet_size).min(MOST) as usize;
        (0..steps).all(|k| gap(&(start + way * (k as f64 / steps as f64))).is_none_or(|gap| gap < 0.0))
    }

    /// Whether it comes to the master, found `at` it and so `deep`, from another one beside it with much the same normal, as
    /// over a joint.
    pub fn goes_over(&self, at: &Projection, deep: f64, facet_size: f64, controls: &Controls) -> bool {
        let same = |borne: Vec3| borne.dot(&at.normal) >= 1.0 - controls.kink_turn;
        deep <= controls.hand_over * facet_size && self.borne.is_some_and(same)
    }

    /// Accepts the current iterate, with the node at `position`: remembers where it met the master, as that is remembered.
    /// With what force it `slid` off the master in between is noted, N.
    pub fn commit(&mut self, method: Enforcement, multiplier: Vec3, ground: &Ground, position: &Vec3, slid: f64) {
        (self.accepted, self.sights.accepted) = (self.trial, self.sights.judged);
        let projection = self.trial.projection;
        let others = self.pieces.iter().filter(|at| projection.is_some_and(|p| p.patch != at.patch));
        let mut beside = [Beside::default(); BESIDE];
        beside.iter_mut().zip(others).for_each(|(beside, other)| *beside = *other);
        self.committed = Committed {
            beside,
            held: self.handed_on(method, &ground.carrier(projection.as_ref())),
            multiplier,
            anchor: projection.map(|p| ground.inward(&p.point)),
            place: Some(ground.inward(position)),
            warm: projection.map(|p| (p.patch, p.xi)),
            keeps: self.trial.kinks.keeps,
            wedge: self.trial.kinks.wedge,
            status: self.trial.status,
            slid,
            aside: self.committed.aside && projection.is_none(),
        };
    }
}
