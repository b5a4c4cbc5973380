//! The meeting of a slave node with its master at an iterate: where it is, and what its element is evaluated with.

use super::element::{Contact, Element, Method, Opposite, Origin, Portion, Site, Spread};
use super::master::{Ground, SlipOrigin};
use super::moves::{Movement, still};
use super::segment::points::mean_of;
use super::segment::{Moved, Point, Segments, Share, Spot};
use super::slave::number_of;
use super::{Beside, Guide, Mover, Multiplier, Pair, Response, Slave, Status, Tangent, touching};
use crate::surface::Projection;
use crate::surface::moving::Transfer;
use crate::{Mat3, Vec3};

/// What the element of a slave node was evaluated with, kept for its tangent.
#[derive(Clone, Debug)]
pub struct Meeting {
    method: Method,
    multiplier: Multiplier,
    /// The part of a held multiplier that the master carries along.
    carried: Vec3,
    /// On the master, unless that is out of reach or feels nothing of the node.
    contact: Option<(Projection, Touch)>,
    /// With what stiffness both sides of a hollow kink hold it, force per length.
    wedge: f64,
    /// Where neither can give way.
    pub guide: Guide,
}

/// How a slave node meets the master.
#[derive(Clone, Debug)]
enum Touch {
    /// In its closest point.
    Node(SlipOrigin),
    /// In points of the faces around it.
    Faces(Vec<Share>),
    /// In those of the pieces that it is exactly between.
    Pieces(Vec<Point>),
}

impl Touch {
    /// The projector on the directions that its normal may have in the element: of means those that are not held.
    fn free(&self, guide: &Guide) -> Mat3 {
        if let Self::Faces(_) = self { guide.free() } else { Mat3::identity() }
    }
}

/// A normal that has some part along what is `free`, along that.
fn along(free: &Mat3, normal: &Vec3) -> Vec3 {
    (free * normal).normalize()
}

/// Where the nodes of the slave are, and the points of its faces where it has them.
#[derive(Clone, Copy)]
pub struct Ahead<'a> {
    pub place: &'a dyn Fn(u32) -> Vec3,
    pub segments: Option<&'a Segments>,
}

/// How a step moves a slave node and the nodes of its master.
pub struct Moves<'a> {
    pub slave: Movement,
    pub master: &'a [Movement],
}

impl Meeting {
    /// Finds slave node `s` of `pair` on the master, and notes in its trial where; `unknown` is λ'. In the `first` iteration of a
    /// step a gap that is but rounding is closed.
    pub fn new(
        pair: &mut Pair,
        ground: &Ground,
        (s, ahead): (usize, &Ahead),
        moves: &Moves,
        unknown: &Vec3,
        first: bool,
    ) -> Self {
        let slave = &pair.slaves[s];
        let position = &(ahead.place)(slave.node);
        let warm = slave.trial.projection.map(|p| (p.patch, p.xi)).or(slave.committed.warm);
        let may_keep = slave.trial.kinks.is_settled();
        let projection = ground.project(pair, s, position, (warm, may_keep));
        let other = || ground.project(pair, s, position, (warm, false));
        let keeps = may_keep && projection.map(|p| p.patch) != other().map(|p| p.patch);
        // One that goes to and fro between sides is on the nearest.
        let may_enter = slave.trial.kinks.may_enter();
        let entrance = projection.filter(|_| may_enter).and_then(|p| ground.entrance(pair, s, position, &p));
        let enters = entrance.is_some();
        let is_nearest =
            !keeps && entrance.map(|p| p.patch).is_none_or(|side| projection.is_some_and(|p| p.patch == side));
        let projection = entrance.or(projection);
        let projection = projection.filter(|p| !is_beside(pair, ground, s, position, p));
        let sigma = slave.local.at(|mover| match mover {
            Mover::Slave(n) => Some((ahead.place)(n)),
            Mover::Master(n) => ground.position_of(n),
        });
        let multiplier = slave.multiplier(pair.rules.method, unknown * slave.law.normal, sigma);
        let (tangent, controls) = (pair.rules.tangent, pair.controls);
        let closed = if first { controls.touching_gap * pair.facet_size } else { 0.0 };
        let seen = projection.or_else(|| ahead.segments.and_then(|segments| segments.weightiest(pair, s)));
        let mut guide = seen.map_or(Guide::default(), |p| guide(ground, &p, moves));
        let (kept, let_go) = slave.friction_across(&guide, ahead.segments.is_some());
        guide.kept = kept;
        let met = ahead.segments.map(|segments| segments.meet(pair, s, projection.as_ref()));
        // One that goes to and fro over a kink keeps to what it was on, unless it has left it for another piece; to a single piece as
        // long as it is not exactly between that and others, which on the way it is by symmetry alone.
        let is_free = slave.pieces.is_empty() && !slave.trial.kinks.is_restless();
        let is_on = |pieces: &[Beside]| projection.is_none_or(|p| pieces.iter().any(|piece| piece.patch == p.patch));
        let kept = (may_keep && !is_free).then_some(&slave.pieces[..]);
        let kept = kept.filter(|pieces| pieces.is_empty() || is_on(pieces));
        let from = warm.filter(|_| may_keep).map(|(patch, _)| patch);
        let wedge = projection.and_then(|at| Wedge::new(pair, ground, s, (position, multiplier.normal()), (&at, from)));
        let Wedge { stiffness, points } = wedge.unwrap_or_default();
        let projection = points.iter().copied().min_by(|a, b| a.gap.total_cmp(&b.gap)).or(projection);
        let even = projection.filter(|_| points.is_empty() && (kept.is_some() || is_nearest));
        let even = even.map_or(Vec::new(), |at| ground.evenly(pair, (s, position), &at, kept));
        let even = if stiffness > 0.0 { shared(&points) } else { even };
        let between = projection.and_then(|at| between(pair, ground, &pair.slaves[s], &at, &even));
        let (projection, several) = match (met, between) {
            (Some(met), _) => met.map_or((None, None), |(mean, shares)| (Some(mean), Some(Touch::Faces(shares)))),
            (_, Some((mean, points))) => (Some(mean), Some(Touch::Pieces(points))),
            _ => (projection, None),
        };
        let slave = &mut pair.slaves[s];
        let last = number_of(&slave.pieces).or(warm.map(|(patch, _)| patch));
        slave.pieces = pieces_of(&even);
        slave.trial.stand(projection, number_of(&slave.pieces).or(projection.map(|p| p.patch)), last);
        slave.trial.kinks.keeps = keeps;
        slave.trial.kinks.note_entrance(enters);
        slave.trial.kinks.wedge = stiffness;
        // A node goes on to yield until it is twice as far away, so that iterations do not go to and fro, but not where it is half as
        // deep as the watch lets it be.
        let is_deep = |p: Projection| p.gap < -0.5 * controls.watch_deep * pair.facet_size;
        let goes_on = slave.trial.yields && !projection.is_some_and(is_deep);
        let near = if goes_on { 2.0 } else { 1.0 } * controls.repeat_distance;
        slave.trial.let_go = if guide.drawn == [false; 3] { let_go } else { 0.0 };
        slave.trial.yields =
            pair.pass.is_second() && projection.is_some_and(|p| ground.is_at_node(pair.planar, &p, near));
        let felt = projection.filter(|p| guide.gives_way(&p.normal) && !slave.trial.yields);
        let touch = |p: &Projection| several.unwrap_or_else(|| Touch::Node(ground.slip_origin(slave, p)));
        let contact = felt.map(|p| (touching(p, closed), touch(&p)));
        (slave.trial.sigma, slave.trial.position) = (sigma, *position);
        let from_last = contact.as_ref().filter(|(_, touch)| match touch {
            Touch::Node(SlipOrigin::Carried(id, xi)) => Some((*id, *xi)) == slave.committed.warm,
            _ => true,
        });
        let carried = from_last.map_or(Vec3::zeros(), |(_, touch)| match touch {
            Touch::Node(_) => slave.held.carried,
            Touch::Faces(_) | Touch::Pieces(_) => ground.frame_at(slave.committed.warm) * slave.held.carried,
        });
        let frictional = slave.law.friction > 0.0;
        slave.met = match (ahead.segments, &contact) {
            (Some(segments), Some((_, Touch::Faces(shares)))) => {
                shares.iter().flat_map(|share| segments.get(share).patches(frictional)).collect()
            }
            (_, Some((_, Touch::Pieces(points)))) => {
                points.iter().flat_map(|point| point.patches(frictional)).collect()
            }
            (Some(_), _) => std::mem::take(&mut slave.met),
            _ => Vec::new(),
        };
        slave.met.sort_unstable();
        slave.met.dedup();
        let method = Method { law: slave.law, transfer: ground.transfer(), tangent };
        Self { method, multiplier, carried, contact, wedge: stiffness, guide }
    }

    /// The same where all that touches sticks where it is, with the force that it has at a solution, and the exact tangent of a
    /// transfer that has a potential. `None` where points of faces slip with friction.
    pub fn stuck(&self, status: Status) -> Option<Self> {
        let mut stuck = self.clone();
        stuck.method.tangent = Tangent::Exact;
        // Others are nearly symmetric, but not against steep penalties.
        stuck.method.transfer = Transfer::Variational;
        let guide = self.guide;
        let Some((p, touch)) = stuck.contact.as_mut().filter(|_| self.method.law.friction > 0.0) else {
            return Some(stuck);
        };
        let normal = along(&touch.free(&guide), &p.normal);
        match touch {
            Touch::Faces(_) | Touch::Pieces(_) if status == Status::Slip => return None,
            Touch::Faces(_) | Touch::Pieces(_) => return Some(stuck),
            Touch::Node(SlipOrigin::Fixed(place)) => *place = p.point,
            Touch::Node(SlipOrigin::Carried(id, xi)) => (*id, *xi) = (p.patch, p.xi),
        }
        stuck.method.law.rough = true;
        // Where both sides are prescribed, nothing gives way, however they move.
        (0..3).for_each(|d| stuck.guide.held[d] |= stuck.guide.drawn[d]);
        (stuck.guide.drawn, stuck.guide.kept) = ([false; 3], Vec3::zeros());
        stuck.carried = Vec3::zeros();
        match &mut stuck.multiplier {
            Multiplier::Augmented(_) => {}
            Multiplier::Force(_, set) if *set == Status::Slip => *set = Status::Stick,
            Multiplier::Force(..) => {}
            Multiplier::Held { tangential, force, .. } => *tangential = *force - normal * normal.dot(force),
        }
        Some(stuck)
    }

    /// The patches of the master on which the element of a slave node has nodes; with friction those of slip origins, too.
    pub fn patches<'a>(&'a self, slave: &'a Slave) -> impl Iterator<Item = u32> + 'a {
        let frictional = self.method.law.friction > 0.0;
        let (on, origin) = match &self.contact {
            Some((p, Touch::Node(origin))) => (Some(p.patch), Some(origin)),
            _ => (None, None),
        };
        let from = origin.and_then(|origin| match origin {
            SlipOrigin::Carried(id, _) if frictional => Some(*id),
            _ => None,
        });
        let met = match &self.contact {
            Some((_, Touch::Faces(_) | Touch::Pieces(_))) => &slave.met[..],
            _ => &[],
        };
        on.into_iter().chain(from).chain(met.iter().copied())
    }
}

/// The pieces of points that a slave node has `evenly`, with their shares; none of a single one.
pub fn pieces_of(even: &[(Projection, f64)]) -> Vec<Beside> {
    let even = if even.len() > 1 { even } else { &[] };
    even.iter().map(|(at, share)| Beside { patch: at.patch, xi: at.xi, share: *share }).collect()
}

/// The mean of the points that a slave node has `even`ly; the rest is that of `at`.
pub fn mean_of_pieces(even: &[(Projection, f64)], at: &Projection) -> Option<Projection> {
    mean_of(even.iter().map(|(p, share)| (p, *share)), at)
}

/// A slave node without friction in a hollow kink between pieces of the master. A force on either side pushes it over to the other:
/// it has but its normal force to be found, and equilibrium there is with both gaps zero. One that iterations have carried to
/// and fro is held between the sides by springs over the differences of its gaps, see [`super::element`], as long as all sides press it.
#[derive(Default)]
struct Wedge {
    /// k; 0 where a single point is left.
    stiffness: f64,
    points: Vec<Projection>,
}

impl Wedge {
    /// What holds slave node `s` at `x`, with the normal force of its multiplier, where its nearest point is `at`; `from` a piece
    /// that it has left for that.
    fn new(
        pair: &Pair,
        ground: &Ground,
        s: usize,
        (x, force): (&Vec3, f64),
        (at, from): (&Projection, Option<u32>),
    ) -> Option<Self> {
        // By how much, over its share, a side may pull, and by what factor forces may differ from that of k.
        const PULLS: f64 = 1e-6;
        const FACTOR: f64 = 4.0;
        let slave = &pair.slaves[s];
        // The master's facets may be far larger than the slave's, and so would be what the node is aside.
        let most = ground.kink(pair, at).min(pair.controls.kink_gap * pair.facet_size);
        let has_points = pair.faces.is_some() || pair.is_by_nodes();
        if pair.rules.friction > 0.0 || has_points || force >= 0.0 || most == 0.0 {
            return None;
        }
        let was = slave.trial.kinks.wedge;
        let mut pieces: Vec<u32> = match was > 0.0 {
            true => slave.pieces.iter().map(|piece| piece.patch).collect(),
            false => vec![from.filter(|from| *from != at.patch)?],
        };
        let is_new = !pieces.contains(&at.patch);
        if is_new {
            pieces.push(at.patch);
        }
        let mut points = ground.hollow_of(pair, x, &pieces);
        if points.is_empty() && is_new && was > 0.0 {
            pieces.pop();
            points = ground.hollow_of(pair, x, &pieces);
        }
        let stiffness = match -force / most {
            stiffness if stiffness < FACTOR * was && was < FACTOR * stiffness => was,
            stiffness => stiffness,
        };
        // An increment begins with what it was between, and what has just come is not held yet.
        let is_judged = was > 0.0 && slave.trial.projection.is_some() && slave.trial.position != *x;
        while is_judged && points.len() > 1 {
            let mean = points.iter().map(|at| at.gap).sum::<f64>() / points.len() as f64;
            let (k, farthest) = points.iter().enumerate().max_by(|(_, a), (_, b)| a.gap.total_cmp(&b.gap))?;
            if farthest.patch == at.patch && is_new || 1.0 + was * (farthest.gap - mean) / force >= -PULLS {
                break;
            }
            points.remove(k);
        }
        match points.len() {
            0 => None,
            1 => Some(Self { stiffness: 0.0, points }),
            _ => Some(Self { stiffness, points }),
        }
    }
}

/// Points with the same shares each.
fn shared(points: &[Projection]) -> Vec<(Projection, f64)> {
    points.iter().map(|at| (*at, 1.0 / points.len() as f64)).collect()
}

/// What a slave node, which has the point `at`, meets where it is exactly between pieces of the master, on which it has points
/// `even`ly, or was at the last converged increment: the mean of these points, and each with each of the places from which slip
/// counts. Otherwise nothing.
fn between(
    pair: &Pair,
    ground: &Ground,
    slave: &Slave,
    at: &Projection,
    even: &[(Projection, f64)],
) -> Option<(Projection, Vec<Point>)> {
    let alone = [(*at, 1.0)];
    if even.len() < 2 && (pair.rules.friction == 0.0 || !slave.committed.was_between()) {
        return None;
    }
    let origins = ground.slip_origins(slave, at);
    let even = match even.len() {
        0 | 1 if origins.len() > 1 => &alone[..],
        0 | 1 => return None,
        _ => even,
    };
    let mean = mean_of_pieces(even, at)?;
    let moved = Moved::with(slave.node);
    let with_origins = |(at, share): &(Projection, f64)| {
        let (at, share) = (*at, *share);
        let of_origin = move |(origin, part): &(SlipOrigin, f64)| {
            let start = ground.place_of(origin).unwrap_or(at.point);
            let spot = Spot { shapes: [1.0, 0.0, 0.0, 0.0], weight: share * part };
            Point { spot, moved, place: at.slave(), at, origin: *origin, start }
        };
        origins.iter().map(of_origin).collect::<Vec<_>>()
    };
    Some((mean, even.iter().flat_map(with_origins).collect()))
}

/// Whether slave node `s`, found inside the master, has come past an end of it.
fn is_beside(pair: &Pair, ground: &Ground, s: usize, position: &Vec3, at: &Projection) -> bool {
    let slave = &pair.slaves[s];
    let gap = |x: &Vec3| ground.project(pair, s, x, (None, false)).map(|p| p.gap);
    let controls = &pair.controls;
    let shallow = || controls.watch_deep * pair.facet_size + ground.kink(pair, at) + ground.bulge(at.patch);
    slave.is_beside(|| ground.start(slave, at), position, at, (pair.facet_size, shallow, controls), gap)
}

/// In which directions a slave node with a prescribed motion cannot give way on the master: where the nodes that bear the
/// point are prescribed too, it is held when they move alike, else drawn.
fn guide(ground: &Ground, at: &Projection, moves: &Moves) -> Guide {
    // A node in a plane of symmetry has its point off the patch's edge there by its gap times what the patch leans.
    const BEARS: f64 = 1e-2;
    let Movement { axes, ways } = moves.slave;
    let mut guide = Guide { axes, ..Guide::default() };
    let bearing = ground.bearing(at).filter(|(_, weight)| weight.abs() > BEARS);
    let known = [0, 1, 2].map(|d| !ways[d].is_nan());
    if known == [false; 3] {
        return guide;
    }
    let directions = [0, 1, 2].map(|d| axes.column(d).into_owned());
    (guide.held, guide.drawn) = (known, known);
    for (n, _) in bearing {
        let of_master = directions.map(|direction| moves.master[n as usize].along(&direction));
        let still = still(ways, of_master);
        for d in 0..3 {
            guide.held[d] &= still[d];
            guide.drawn[d] &= !of_master[d].is_nan();
        }
    }
    (0..3).for_each(|d| guide.drawn[d] &= !guide.held[d]);
    guide
}

/// An element, and the positions of the stencils that it works on.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub element: Element,
    positions: Vec<Vec3>,
    origin: Vec<Vec3>,
}

impl Workspace {
    /// Evaluates the element of a slave node, with its tangent if asked for, and with the points of its faces where it meets the
    /// master in these.
    pub fn evaluate(
        &mut self,
        ground: &Ground,
        (meeting, slave): (&Meeting, &Slave),
        segments: Option<&Segments>,
        with_tangent: bool,
    ) -> Response {
        let Self { element, positions, origin } = self;
        let (method, guide, multiplier) = (&meeting.method, &meeting.guide, &meeting.multiplier);
        let portions: Option<Vec<Portion>> = match (segments, &meeting.contact) {
            (Some(segments), Some((_, Touch::Faces(shares)))) => {
                Some(shares.iter().map(|share| segments.portion(share)).collect())
            }
            (_, Some((_, Touch::Pieces(points)))) => {
                Some(points.iter().map(|point| point.portion(point.spot.weight)).collect())
            }
            (segments, _) => segments.map(|_| Vec::new()),
        };
        if let Some(portions) = portions {
            let spread = |(p, touch): &(Projection, Touch)| {
                let free = touch.free(guide);
                Spread {
                    node: slave.node,
                    portions: &portions,
                    gap: p.gap,
                    normal: along(&free, &p.normal),
                    free,
                    carried: meeting.carried,
                    wedge: meeting.wedge,
                }
            };
            let spread = meeting.contact.as_ref().map(spread);
            return match with_tangent {
                false => element.spread_residual(method, multiplier, (spread.as_ref(), ground), guide),
                true => element.spread_tangent(method, multiplier, (spread.as_ref(), ground), guide),
            };
        }
        let corner = match (ground, &meeting.contact) {
            // Of what does not slide only the tangent needs it.
            (Ground::Surface(surface, _), Some(_)) if with_tangent || method.law.friction > 0.0 => {
                slave.mate.and_then(|mate| mate.corner(surface))
            }
            _ => None,
        };
        let contact = meeting.contact.as_ref().and_then(|(projection, touch)| {
            let Touch::Node(from) = touch else { return None };
            let opposite = match ground {
                Ground::Tool(tool) => Opposite::Tool(tool.trial.rotation, tool.trial.axle_in_space()),
                _ => Opposite::Patch(site(ground, projection.patch, projection.xi, positions)?),
            };
            let origin = match *from {
                SlipOrigin::Fixed(place) => {
                    corner.as_ref().map_or(Origin::Fixed(place), |at| Origin::Beside(place, at))
                }
                SlipOrigin::Carried(id, xi) => Origin::Carried(site(ground, id, xi, origin)?),
            };
            Some(Contact { projection, opposite, origin, carried: meeting.carried })
        });
        match with_tangent {
            false => element.residual(method, multiplier, contact.as_ref(), guide),
            true => element.tangent(method, multiplier, contact.as_ref(), guide),
        }
    }

    /// Keeps what the last tangent has for the local unknown of a slave node; other slave nodes are at `place`.
    pub fn learn(&self, slave: &mut Slave, response: &Response, ground: &Ground, place: impl Fn(u32) -> Vec3) {
        let element = &self.element;
        slave.local.learn(slave.trial.sigma, response);
        let by = |node| -response.inverse * element.constraint_by(node, slave.law.friction);
        slave.local.by.push((Mover::Slave(slave.node), by(None), slave.trial.position));
        for (j, &n) in element.beside.iter().enumerate() {
            slave.local.by.push((Mover::Slave(n), by(Some(j)), place(n)));
        }
        for (j, &n) in element.nodes.iter().enumerate() {
            let by = by(Some(element.beside.len() + j));
            slave.local.by.push((Mover::Master(ground.number(n)), by, ground.position(n)));
        }
    }

    /// Has the matrix along the directions `of` the slave nodes that have their own, those of slave node `own` with friction for its
    /// `width` multipliers too, and along those of the nodes of a master `at` each.
    pub fn turn<'a>(&mut self, own: u32, width: usize, of: impl Fn(u32) -> Option<&'a Mat3>, at: impl Fn(u32) -> Mat3) {
        let element = &mut self.element;
        if let Some(axes) = of(own) {
            element.turn(0, axes);
            if width == 3 {
                element.turn(3, axes);
            }
        }
        let first = 3 + width;
        for j in 0..element.beside.len() {
            if let Some(axes) = of(element.beside[j]) {
                element.turn(first + 3 * j, axes);
            }
        }
        let first = first + 3 * element.beside.len();
        for j in 0..element.nodes.len() {
            let axes = at(element.nodes[j]);
            if axes != Mat3::identity() {
                element.turn(first + 3 * j, &axes);
            }
        }
    }

    /// A multiplier that has an equation but no say, along a direction of the guide in which the node stands still on the
    /// master, is zero: `has_equation` along each. The matrix has the multipliers along these directions.
    pub fn hold(&mut self, has_equation: [bool; 3], meeting: &Meeting) {
        let columns = self.element.shape[1];
        for d in (0..3).filter(|&d| meeting.guide.held[d] && has_equation[d]) {
            let row = 3 + d;
            self.element.matrix[row * columns..(row + 1) * columns].fill(0.0);
            self.element.matrix[row * columns + row] = -meeting.method.law.normal;
        }
    }
}

/// A point of a patch, with the positions of its nodes in `positions`.
fn site<'a>(ground: &Ground<'a>, id: u32, xi: [f64; 2], positions: &'a mut Vec<Vec3>) -> Option<Site<'a>> {
    let (patch, stencil) = ground.patch(id)?;
    positions.clear();
    positions.extend(stencil.iter().map(|&n| ground.position(n)));
    Some(Site { patch, stencil, positions, xi })
}
