//! The law of contact at a slave node: augmented Lagrangian with Coulomb friction, with its derivatives.
//!
//! With the gap g and outward normal n of the master at the closest point x̄, the multiplier λ (the nodal contact force,
//! N; λ·n <= 0 in contact) and the slip g_t = (I - nn) Δ along the path Δ = x̄ - x̃ since the last converged increment (x̃
//! the contact point of then, carried along by the master; eqs. (6)-(7) of Neto, Oliveira and Menezes), the augmented
//! multiplier is
//!
//!   λ̂_n = λ·n + ε_n g,   λ̂_t = (I - nn) λ + ε_t g_t,
//!
//! and the contact force F on the master (its opposite acts on the slave) by status (eqs. (63)-(65)):
//!
//!   gap    λ̂_n > 0              F = 0
//!   stick  |λ̂_t| <= -μ λ̂_n      F = λ̂_n n + λ̂_t
//!   slip   otherwise            F = λ̂_n (n - μ t),  t = λ̂_t / |λ̂_t|
//!
//! A direction in which neither the node nor the master can give way makes no condition of its own:
//!
//! - Where the node stands still relative to the master (a plane of symmetry, plane strain), it meets the master's
//!   section with the directions left to it: with their projector P and c = |P n|, the normal P n / c, the gap g / c and,
//!   the normal force being N = λ̂_n / c, friction bounded by μ N. The force has the component of N n in the held directions, and
//!   there the friction κ that the node bears already, as after it was drawn that way, which is part of λ̂_t. The multiplier has
//!   no component in them.
//! - Where it is drawn along the master, by g_d of its slip, it cannot stick, and ε_t is at least so large that λ̂_t is along the
//!   way with what is left on the cone beside the part of λ_t across: else F = λ would hold with friction that pushes the
//!   node on, as that of the way there on the way back, as long as ε_t |g_t| is less than the friction.
//!
//! A node that begins inside the master may be as deep as that at first, and less and less: g is its distance and what is left
//! of that depth.
//!
//! Without friction one multiplier λ_n a node suffices, and F = λ̂_n n.
//!
//! A constraint that gives way, by s λ/ε about the rest ρ, has this law for the gap g - (s/ε_n)(λ_n - ρ_n) and the slip
//! g_t - (s/ε_t)(λ_t - ρ_t) that are left, with the penalties ε/(1+s):
//!
//!   λ̂ = λ + (ε g - s (λ - ρ))/(1+s) = m + ε g/(1+s),   m = (λ + s ρ)/(1+s).
//!
//! So status and force follow from the constraint that is solved: where F = λ, forces are on the cone and no gap pulls,
//! one state for each gap and slip. Were λ + ε g to decide, a node with ε g between 0 and s|ρ|/(1+s) could touch or not,
//! and what touches would have another force than its multiplier. With these penalties, and no others, the frictionless
//! tangent stays symmetric.
//!
//! Where friction alone holds a body and all of it slips, to both sides, equilibrium does not say where the body is: between
//! the slips of an increment every place is right. Friction may then grow by a share ϰ of itself with the length of the slip
//! since the last converged increment, μ (1 + ϰ |g_t|) for μ, which is least in the middle.
//!
//! On the way to a solution the normal force may be that of the central path of interior-point methods, with a parameter θ
//! (Chen and Harker, SIAM J. Matrix Anal. Appl. 14 (1993) 1168-1190; Kanzow, SIAM J. Matrix Anal. Appl. 17 (1996) 851-868):
//!
//!   F_n = (λ̂_n - √(λ̂_n² + 4θ²)) / 2,   so that F_n (F_n - λ̂_n) = θ²,
//!
//! and where λ_n = F_n, -F_n ε_n g = θ²: every node has a force and a gap, smoothly, and the law itself is the limit θ = 0.
//!
//! All methods have this law, and differ in the [`Multiplier`]:
//!
//! - augmented Lagrangian: λ is an unknown, and its residual -(λ - F).
//! - penalty and Uzawa: λ is held, and F is what λ + ε g becomes on the cone, with the penalty ε. A large one makes
//!   Newton's method overshoot: what curvature leaves of a gap after an iteration, times ε, is far from the force that the
//!   iteration was after, and statuses go to and fro. So F is an unknown σ of the node alone, with the compliance 1/ε
//!   and an augmentation ε_a < ε that does not change the solution,
//!
//! ```text
//!     σ = F(m + ε_a g),   m = (1 - r) σ + r λ,   r = ε_a / ε,
//! ```
//!
//!   whose linear equation is solved for dσ beforehand; what is left has the unknowns of the bodies alone. The normal part
//!   of λ is a gap h that is added, λ_n = ε h; h = 0 for the penalty.
//! - Lagrange: λ is an unknown with the same residual, the status is given, and the force is λ itself, without penalty.

use crate::{Mat3, Vec3};

/// What a slave node does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    #[default]
    Gap = 0,
    Stick = 1,
    Slip = 2,
}

crate::choices!(Status { Gap, Stick, Slip });

impl Status {
    /// The status in words; without friction what touches neither sticks nor slips.
    pub fn name(self, friction: f64) -> &'static str {
        match self {
            Self::Gap => "not touching",
            _ if friction == 0.0 => "touching",
            Self::Stick => "sticking",
            Self::Slip => "slipping",
        }
    }
}

/// Parameters of the law at a slave node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Coulomb coefficient μ.
    pub friction: f64,
    /// Normal penalty ε_n, force per length.
    pub normal: f64,
    /// Tangential penalty ε_t, force per length.
    pub tangential: f64,
    /// Penalty ε where multipliers are held; ε_n = ε_t are then the augmentation.
    pub penalty: f64,
    /// What touches sticks, however large the force, unless it is drawn.
    pub rough: bool,
    /// It has no friction yet: it slips when it touches.
    pub glides: bool,
    /// It touches, however far it is: an iteration that begins with this does not leave behind what a master goes away from.
    pub clings: bool,
    /// How deep it may be inside the master: what is left of an overlap that is taken back little by little.
    pub allowed: f64,
    /// By how much the constraint of a multiplier that is an unknown gives way.
    pub compliance: Compliance,
    /// θ of the central path, N; 0 for the law itself.
    pub barrier: f64,
    /// By what share friction grows with the length of the slip, 1/length: where all slips, it holds the mean place of what
    /// slips to and fro.
    pub creep: f64,
    /// The least friction of a drawn node along its way, of all of it: where all was across it.
    pub drawn_least: f64,
}

impl Law {
    /// The gap g that counts where the master is so far.
    pub fn gap(&self, distance: f64) -> f64 {
        distance + self.allowed
    }

    /// F_n of λ̂_n in contact, with its derivative.
    fn pressed(&self, augmented: f64) -> (f64, f64) {
        if self.barrier == 0.0 {
            return (augmented, 1.0);
        }
        let root = augmented.hypot(2.0 * self.barrier);
        // Where both almost cancel, their product with the sum.
        let force =
            if augmented > 0.0 { -2.0 * self.barrier.powi(2) / (augmented + root) } else { 0.5 * (augmented - root) };
        (force, -force / root)
    }
}

/// For tests.
#[cfg(test)]
pub const LAW: Law = Law {
    friction: 0.3,
    normal: 40.0,
    tangential: 25.0,
    penalty: 100.0,
    rough: false,
    glides: false,
    clings: false,
    allowed: 0.0,
    compliance: Compliance { slack: 0.0, rest: Vec3::new(0.0, 0.0, 0.0) },
    barrier: 0.0,
    creep: 0.0,
    drawn_least: 0.1,
};

/// By how much the constraint of a multiplier gives way: where several nodes or masters make the same condition, only this
/// shares the force out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compliance {
    /// Over 1/ε: the constraint gives way by this times λ/ε.
    pub slack: f64,
    /// The multiplier in contact at which it has not given way, N.
    pub rest: Vec3,
}

/// Directions in which neither a slave node nor its master can give way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// The directions, its columns, at right angles to each other.
    pub axes: Mat3,
    /// The node stands still relative to the master.
    pub held: [bool; 3],
    /// The node is drawn along the master.
    pub drawn: [bool; 3],
    /// κ: the friction along the directions in which it is held that it bears as the increment begins, N.
    pub kept: Vec3,
}

impl Default for Guide {
    fn default() -> Self {
        Self { axes: Mat3::identity(), held: [false; 3], drawn: [false; 3], kept: Vec3::zeros() }
    }
}

impl Guide {
    /// Whether the node, or the master, can give way to a force along `normal`. What cannot does not feel it.
    pub fn gives_way(&self, normal: &Vec3) -> bool {
        const ACROSS: f64 = 1e-6;
        (0..3).any(|d| !self.held[d] && !self.drawn[d] && self.axes.column(d).dot(normal).abs() > ACROSS)
    }

    /// The projector on the directions that are not held.
    pub fn free(&self) -> Mat3 {
        let free = Mat3::from_diagonal(&Vec3::from(self.held.map(|held| if held { 0.0 } else { 1.0 })));
        self.axes * free * self.axes.transpose()
    }
}

/// Where a slave node is relative to the master: what the law sees of the motion.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics {
    pub gap: f64,
    /// n.
    pub normal: Vec3,
    /// x̄.
    pub point: Vec3,
    /// x̃.
    pub origin: Vec3,
}

/// How the contact force comes from the multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Multiplier {
    /// λ is an unknown, and F the augmented one. Without friction λ_n stands first.
    Augmented(Vec3),
    /// λ is an unknown and F itself, with the status that the active set has.
    Force(Vec3, Status),
    /// λ is held, λ_n = ε `gap` and λ_t the tangential part of a vector; the force is the local unknown σ.
    Held { gap: f64, tangential: Vec3, force: Vec3 },
}

impl Multiplier {
    /// λ_n without friction.
    pub fn normal(&self) -> f64 {
        match self {
            Self::Augmented(force) | Self::Force(force, _) | Self::Held { force, .. } => force.x,
        }
    }
}

/// Derivatives by gap, normal, path and multiplier, as if these were independent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slopes {
    pub gap: Vec3,
    pub normal: Mat3,
    pub path: Mat3,
    pub multiplier: Mat3,
}

impl Slopes {
    /// Of the part of the force along what is free.
    fn along(&self, free: &Mat3) -> Self {
        let Self { gap, normal, path, multiplier } = self;
        Self { gap: free * gap, normal: free * normal, path: free * path, multiplier: free * multiplier }
    }
}

/// The contact force, the residual of the multiplier or of the local unknown, and their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    pub status: Status,
    /// F.
    pub force: Vec3,
    pub force_by: Slopes,
    /// The force in the balance of the bodies: F, with a local unknown what is left of it.
    pub load: Vec3,
    /// With a local unknown: the inverse of the derivative of its residual by itself.
    pub inverse: Mat3,
    /// The derivative of F by a held λ_t.
    pub by_held: Mat3,
    /// What is left of the friction in directions in which the node is held.
    pub kept: Vec3,
    /// -(λ - F) in the free directions, with F augmented. Without friction in the first component ε_n g in contact and
    /// -λ_n in the gap.
    pub constraint: Vec3,
    pub constraint_by: Slopes,
    pub slip: Vec3,
    /// The status that gap and multiplier ask for.
    pub asked: Status,
    /// With a status that is given: by how much the constraint changes with the one asked for, N. With a multiplier that is
    /// held: by what gap and slip it is from the force, a length.
    pub violation: f64,
}

/// The section of the master with the directions that are not held.
struct Section {
    free: Mat3,
    /// m = P n / c.
    normal: Vec3,
    /// dm/dn.
    turn: Mat3,
    tangential: Mat3,
    /// 1/c: the normal force over λ̂_n.
    lean: f64,
}

impl Response {
    /// The residual of the multiplier times so much.
    fn times(mut self, factor: f64) -> Self {
        let by = &mut self.constraint_by;
        self.constraint *= factor;
        by.gap *= factor;
        [&mut by.normal, &mut by.path, &mut by.multiplier].into_iter().for_each(|by| *by *= factor);
        self
    }
}

impl Section {
    fn new(normal: &Vec3, guide: &Guide) -> Self {
        let free = guide.free();
        let inside = free * normal;
        let lean = 1.0 / inside.norm();
        let normal = inside * lean;
        let tangential = free - normal * normal.transpose();
        Self { free, normal, turn: tangential * lean, tangential, lean }
    }
}

impl Section {
    /// What the held directions feel of the force λ̂_n on the section, which changes with the normal by `slope`: the
    /// component of N n in them, and its derivative by the normal.
    fn across(&self, normal: &Vec3, lambda_n: f64, slope: &Vec3) -> (Vec3, Mat3) {
        let held = Mat3::identity() - self.free;
        let (across, lean) = (held * normal, self.lean);
        let turn = slope * lean - self.normal * (lambda_n * lean * lean);
        (across * (lambda_n * lean), across * turn.transpose() + held * (lambda_n * lean))
    }
}

/// The response of a slave node; without a `place` it is in the gap.
pub fn respond(law: Law, multiplier: &Multiplier, place: Option<&Kinematics>, guide: &Guide) -> Response {
    let counted = place.map(|p| Kinematics { gap: law.gap(p.gap), ..*p });
    let place = counted.as_ref();
    let response = match *multiplier {
        Multiplier::Augmented(lambda) => yielding(law, &lambda, place, guide, None),
        Multiplier::Force(lambda, set) => {
            let free = yielding(law, &lambda, place, guide, None);
            let fixed = if free.status == set { free } else { yielding(law, &lambda, place, guide, Some(set)) };
            let violation = (free.constraint - fixed.constraint).norm();
            // With λ for the force, the tangent is symmetric so.
            let response = pure(law, &lambda, place, guide, fixed).times(1.0 + law.compliance.slack);
            Response { asked: free.status, violation, ..response }
        }
        Multiplier::Held { gap, tangential, force } => {
            let share = law.normal / law.penalty;
            let shifted = place.map(|p| Kinematics { gap: p.gap + gap, ..*p });
            let held = tangential * share;
            let response = augmented(law, [&(force * (1.0 - share)), &held], shifted.as_ref(), guide, None);
            let violation = apart(law, gap, &tangential, place, &response);
            return Response { violation, ..condensed(law, &force, share, guide, response) };
        }
    };
    Response { load: response.force, ..response }
}

/// The response with the augmented force of λ, of which the constraint gives way: that of m.
fn yielding(law: Law, lambda: &Vec3, place: Option<&Kinematics>, guide: &Guide, set: Option<Status>) -> Response {
    let Compliance { slack, rest } = law.compliance;
    if slack == 0.0 {
        // To the sign of a zero.
        return augmented(law, [lambda, &Vec3::zeros()], place, guide, set);
    }
    let share = 1.0 / (1.0 + slack);
    let mean = (lambda + rest * slack) * share;
    let softer = Law { normal: law.normal * share, tangential: law.tangential * share, ..law };
    let mut response = augmented(softer, [&mean, &Vec3::zeros()], place, guide, set);
    response.force_by.multiplier *= share;
    let own = Mat3::from_diagonal(&components(law));
    response.constraint += own * (mean - lambda);
    // ∂(F - λ)/∂λ, where the response has ∂F/∂m - I.
    response.constraint_by.multiplier = (response.constraint_by.multiplier + own) * share - own;
    response
}

/// The response with the augmented force of a multiplier λ, to which the tangential part of the second vector is added. A status that
/// is given overrides the one that they have.
fn augmented(
    law: Law,
    [multiplier, held]: [&Vec3; 2],
    place: Option<&Kinematics>,
    guide: &Guide,
    set: Option<Status>,
) -> Response {
    match place {
        None => gap(law, multiplier, Vec3::zeros()),
        Some(place) if law.friction == 0.0 => frictionless(law, multiplier.x, place, set),
        Some(place) => frictional(law, [multiplier, held], place, guide, set),
    }
}

/// The tangential penalty of a node that is drawn: that with which friction, where the node slips along its way alone, has the
/// part across that it bears already, and the rest along the way.
#[derive(Default)]
struct Lead {
    penalty: f64,
    /// Its derivatives by λ̂_n, by λ_t, and by the way that it is led.
    by_force: f64,
    by_base: Vec3,
    by_way: Vec3,
}

impl Lead {
    fn new(led: &Vec3, base: &Vec3, [friction, least]: [f64; 2], lambda_n: f64) -> Option<Self> {
        let length = led.norm();
        let way = led.try_normalize(f64::MIN_POSITIVE)?;
        let bound = -friction * lambda_n;
        let along = base.dot(&way);
        let across = base - way * along;
        let rest = (bound.powi(2) - across.norm_squared()).max(0.0).sqrt();
        // By the direction of the way the rest changes as the part along it does.
        let (rest, by_force, by_base, by_along) = match rest > least * bound {
            true => (rest, -friction * bound / rest, -across / rest, along / rest),
            false => (least * bound, -friction * least, Vec3::zeros(), 0.0),
        };
        let penalty = (rest - along) / length;
        let by_way = (across * ((by_along - 1.0) / length) - way * penalty) / length;
        Some(Self { penalty, by_force: by_force / length, by_base: (by_base - way) / length, by_way })
    }
}

fn frictional(
    law: Law,
    [multiplier, held]: [&Vec3; 2],
    place: &Kinematics,
    guide: &Guide,
    set: Option<Status>,
) -> Response {
    let section = Section::new(&place.normal, guide);
    let Section { free, normal: n, turn, tangential, lean } = section;
    let path = place.point - place.origin;
    let slip = tangential * path;
    let way = slip.norm();
    let coefficient = if law.glides { 0.0 } else { law.friction };
    let friction = coefficient * lean * (1.0 + law.creep * way);
    // Beyond the rounding of positions.
    let is_drawn = |d: &usize| guide.drawn[*d] && slip.dot(&guide.axes.column(*d)).abs() > 1e-12 * place.point.amax();
    let along = |d: usize| guide.axes.column(d) * guide.axes.column(d).transpose();
    let leading: Mat3 = (0..3).filter(is_drawn).map(along).sum();
    let led = tangential * leading * slip;
    let drawn = led != Vec3::zeros();
    // What is drawn has its friction along its way.
    let kappa = if drawn || law.glides { Vec3::zeros() } else { guide.kept };
    let (lambda_n, share) = law.pressed(multiplier.dot(&n) + law.normal * place.gap * lean);
    let bound = -friction * lambda_n;
    let lead = match set {
        Some(Status::Stick) => None,
        _ if law.glides => None,
        _ => Lead::new(&led, &(tangential * (multiplier + held)), [friction, law.drawn_least], lambda_n),
    };
    let lead = lead.filter(|lead| lead.penalty > law.tangential);
    let penalty = lead.as_ref().map_or(law.tangential, |lead| lead.penalty);
    let combined = multiplier + held + path * penalty;
    let lambda_t = tangential * combined + kappa;
    let size = lambda_t.norm();
    // What rounding of places makes of a node that stands still has no direction to slip along.
    let still = 16.0 * f64::EPSILON * place.point.amax() * law.tangential;
    // A node that slipped last stands on the cone to rounding, and is taken to slip on.
    let status = match set {
        // Without a direction.
        Some(Status::Slip) if size <= 1e-12 * lambda_n.abs() => Status::Stick,
        Some(status) => status,
        None if lambda_n > 0.0 && !law.clings => Status::Gap,
        None if law.glides => Status::Slip,
        None if (law.rough || law.clings || size <= (bound * (1.0 - 1e-9)).max(still)) && !drawn => Status::Stick,
        None => Status::Slip,
    };
    let n_by_normal = (turn * multiplier - n * (law.normal * place.gap * lean * lean)) * share;
    // Of the part along the section.
    let by_normal = |v: &Vec3| -n * (turn * v).transpose() - turn * n.dot(v);
    let t_by_normal = by_normal(&combined);
    let (force, mut by, by_held) = match status {
        Status::Gap => return gap(law, multiplier, slip),
        Status::Stick => {
            let by = Slopes {
                gap: n * (law.normal * lean * share),
                normal: n * n_by_normal.transpose() + turn * lambda_n + t_by_normal,
                path: tangential * law.tangential,
                multiplier: free - n * n.transpose() * (1.0 - share),
            };
            (n * lambda_n + lambda_t, by, tangential)
        }
        Status::Slip => {
            // What glides needs no direction.
            let over = if size > 0.0 { 1.0 / size } else { 0.0 };
            let t = lambda_t * over;
            let direction = n - friction * t;
            let force = direction * lambda_n;
            let rotation = (Mat3::identity() - t * t.transpose()) * (bound * over);
            let leaning = t * n.transpose() * (friction * lambda_n * lean);
            // With what friction grows by with the slip; in the first iteration there may be none, but where it would go.
            let along = if way > 0.0 { slip / way } else { t };
            let growth = t * along.transpose() * (-law.creep * coefficient * lean * lambda_n);
            // With the penalty, too.
            let stretch = rotation * slip;
            let lead = lead.unwrap_or_default();
            let direction = direction + stretch * lead.by_force;
            let (by_base, by_way) = (stretch * lead.by_base.transpose(), stretch * lead.by_way.transpose());
            let steep = by_base * by_normal(&(multiplier + held))
                + by_way * (by_normal(&(leading * slip)) + tangential * leading * by_normal(&path));
            let by_base = (rotation + by_base) * tangential;
            let by = Slopes {
                gap: direction * (law.normal * lean * share),
                normal: direction * n_by_normal.transpose()
                    + turn * lambda_n
                    + rotation * t_by_normal
                    + leaning
                    + growth * by_normal(&path)
                    + steep,
                path: (rotation * penalty + growth + by_way * tangential * leading) * tangential,
                multiplier: direction * n.transpose() * share + by_base,
            };
            (force, by, by_base)
        }
    };
    // The multiplier has no part in κ, of which a status that is given does not make more.
    let (own, own_by, kept) = match status {
        _ if kappa == Vec3::zeros() => (force, by, kappa),
        Status::Slip => (free * force, by.along(&free), kappa * (bound / size).min(1.0)),
        _ => (free * force, by.along(&free), kappa),
    };
    let mut response = Response {
        status,
        asked: status,
        force: if kappa == Vec3::zeros() { force } else { own + kept },
        by_held,
        kept,
        constraint: own - multiplier,
        constraint_by: Slopes { multiplier: own_by.multiplier - Mat3::identity(), ..own_by },
        slip,
        ..Response::default()
    };
    if guide.held != [false; 3] {
        let (across, by_normal) = section.across(&place.normal, lambda_n, &n_by_normal);
        let lifted = (place.normal - free * place.normal) * lean;
        response.force += across;
        by.gap += lifted * (law.normal * lean * share);
        by.normal += by_normal;
        by.multiplier += lifted * n.transpose() * share;
    }
    Response { force_by: by, ..response }
}

fn frictionless(law: Law, multiplier: f64, place: &Kinematics, set: Option<Status>) -> Response {
    let (pressure, share) = law.pressed(multiplier + law.normal * place.gap);
    let touching = set.map_or(pressure <= 0.0 || law.clings, |set| set != Status::Gap);
    if !touching {
        return gap(law, &Vec3::new(multiplier, 0.0, 0.0), Vec3::zeros());
    }
    let first = Vec3::x() * (law.normal * share);
    Response {
        status: Status::Slip,
        asked: Status::Slip,
        force: place.normal * pressure,
        force_by: Slopes {
            gap: place.normal * (law.normal * share),
            normal: Mat3::from_diagonal_element(pressure),
            multiplier: place.normal * Vec3::x().transpose() * share,
            ..Slopes::default()
        },
        constraint: match law.barrier {
            0.0 => first * place.gap,
            _ => Vec3::x() * (pressure - multiplier),
        },
        constraint_by: Slopes {
            gap: first,
            multiplier: Mat3::from_diagonal(&Vec3::x()) * (share - 1.0),
            ..Slopes::default()
        },
        ..Response::default()
    }
}

/// The response with the force σ as a local unknown: `response` has the multiplier (1 - r) σ. The residual of σ is solved
/// for dσ in the directions that it has.
fn condensed(law: Law, sigma: &Vec3, share: f64, guide: &Guide, response: Response) -> Response {
    let own = if law.friction == 0.0 { Mat3::from_diagonal(&components(law)) } else { guide.free() };
    let (force_by, by) = (response.force_by.multiplier * (1.0 - share), response.constraint_by.multiplier);
    // ∂(F - σ)/∂σ = (1 - r) ∂F/∂m - I, where the response has ∂F/∂m - I.
    let by_sigma = own * (by * (1.0 - share) - own * share) * own;
    let inverse = (by_sigma - (Mat3::identity() - own)).try_inverse().unwrap_or_default() * own;
    let constraint = own * (response.constraint - sigma * share);
    Response {
        load: response.force - force_by * (inverse * constraint),
        force_by: Slopes { multiplier: force_by, ..response.force_by },
        constraint,
        constraint_by: Slopes { multiplier: by_sigma, ..response.constraint_by },
        inverse,
        by_held: response.by_held * share,
        ..response
    }
}

/// How far a multiplier that is held, λ_n / ε and λ_t, is from the force of the response, as gap and slip.
fn apart(law: Law, offset: f64, tangential: &Vec3, place: Option<&Kinematics>, response: &Response) -> f64 {
    let Some(place) = place.filter(|_| response.status != Status::Gap) else {
        return offset.abs().max(tangential.norm() / law.penalty);
    };
    let along = |f: Vec3| f - place.normal * place.normal.dot(&f);
    place.gap.abs().max(along(response.force - tangential).norm() / law.penalty)
}

/// The same status and constraint, with λ itself for the force.
fn pure(law: Law, lambda: &Vec3, place: Option<&Kinematics>, guide: &Guide, response: Response) -> Response {
    let Some(place) = place.filter(|_| response.status != Status::Gap) else { return response };
    if law.friction == 0.0 {
        let normal = Mat3::from_diagonal_element(lambda.x);
        let force_by = Slopes { normal, multiplier: place.normal * Vec3::x().transpose(), ..Slopes::default() };
        return Response { force: place.normal * lambda.x, force_by, ..response };
    }
    let section = Section::new(&place.normal, guide);
    let n = section.normal;
    let (across, normal) = section.across(&place.normal, lambda.dot(&n), &(section.turn * lambda));
    let lifted = (place.normal - section.free * place.normal) * section.lean;
    let multiplier = section.free + lifted * n.transpose();
    Response {
        force: section.free * lambda + across + response.kept,
        force_by: Slopes { normal, multiplier, ..Slopes::default() },
        ..response
    }
}

/// No force: the multiplier goes to zero.
fn gap(law: Law, multiplier: &Vec3, slip: Vec3) -> Response {
    let constraint_by = Slopes { multiplier: -Mat3::from_diagonal(&components(law)), ..Slopes::default() };
    Response { constraint: -multiplier, constraint_by, slip, ..Response::default() }
}

/// One in those components that a multiplier has.
fn components(law: Law) -> Vec3 {
    if law.friction == 0.0 { Vec3::x() } else { Vec3::repeat(1.0) }
}
