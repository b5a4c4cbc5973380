//! A watch that does not trust the solution: did a slave node go through the master, and is it behind one of its faces?
//!
//! It looks at places alone, those of the last accepted state and of the one that would follow it, with its own projection
//! and its own reach; what the contact elements found does not enter, but for the force that explains a penetration under a
//! penalty. It takes two states:
//!
//! - [`Ground`]: the master, here as it is at the end of the increment. The node's place at the beginning is brought there with
//!   the master: in the frame of a tool, or with the patch under the node. What is left is the node's way over a surface
//!   that stands still. A tool that turns makes the way an arc, which is cut in straight parts.
//! - [`Sight`]: what was seen at the last accepted state: how far the node was, and on which side.
//!
//! A node is *behind* when the nearest point of the master is inside its border and the node lies on the wrong side of it,
//! deeper than is [allowed](Allowance). One that came there round an end of an open surface is *beside* it, which is legal.
//!
//! Only what is between both places is unknown, and no straight line is the way that the node took: it cuts corners and
//! goes through what it slides around. So the way is lifted off the surface at both ends by a tenth of a facet; if
//! it still goes through the surface, so does every way near it. Such a way begins and ends outside, so that it goes through
//! thin walls as through thick ones. It is followed in steps of the distance to the surface, within which nothing is: no
//! wall is too thin for them.
//!
//! Most nodes need one projection: what is farther away than the node has moved has not been reached, and a node whose
//! nearest point has moved along the surface has kept to its side.

use super::element::frame;
use super::master::Past;
use super::pose::way_past;
use super::{Ground, Meets, Pair};
use crate::Vec3;
use crate::controls::Controls;
use crate::surface::Projection;
use std::f64::consts::TAU;

/// A step along a way over the distance to the surface, within which nothing is.
const SHARE: f64 = 0.9;

/// A length that is a point, and what two projections of the same point may differ by, over the size of a facet.
const POINT: f64 = 1e-6;
const ROUNDED: f64 = 1e-6;

/// On which side of the master a node is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    #[default]
    Front,
    /// Behind it, past an end of its surface.
    Beside,
    /// Behind it since the beginning.
    Inside,
}

crate::choices!(Side { Front, Beside, Inside });

/// What was seen of a slave node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// Distance to the master, negative behind it; with nothing in sight how far that is.
    pub gap: f64,
    /// Unit normal at the nearest point, if there is one in sight: in the tool's frame, or in space.
    pub normal: Option<Vec3>,
    /// The patch of the nearest point.
    pub patch: u32,
    pub side: Side,
    /// Depth behind the master, unless it is beside it.
    pub depth: f64,
}

crate::words!(Sight { gap, normal, patch, side, depth });

/// What is wrong with a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// So deep behind the master.
    Behind(f64),
    /// It went through the master on a way of this length.
    Through(f64),
    /// Its way is so long, and so near to the master, that it is not followed.
    Lost(f64),
    /// It bears from node to node, so far from the node that it meets.
    Apart(f64),
    /// Beside it, between nodes, the master is so deep in the slave.
    Between(f64),
    /// It is so deep behind the master, and no gap is closed in the mean around any node.
    Unfelt(f64),
    /// It cannot give way to a tool that is only turned by a torque, which it touches with so much force: how much, nothing says.
    Undetermined(f64),
    /// Friction of so much force pushes it along its way over a tool.
    Pushed(f64),
    /// A side of the master that another master covers holds it, with so much force.
    InSeam(f64),
    /// It is so deep behind the master, past whose end it came, and the node next to it is in front: the body is cut at a place.
    Astride(f64, Vec3),
    /// A side that it does not look at holds it, with so much force, and nodes like it with such a share of the contact's.
    Hooked(f64, f64),
}

impl Finding {
    /// A length to compare findings by.
    pub fn size(&self) -> f64 {
        match self {
            Self::Behind(size)
            | Self::Through(size)
            | Self::Lost(size)
            | Self::Apart(size)
            | Self::Between(size)
            | Self::Unfelt(size)
            | Self::Undetermined(size)
            | Self::Pushed(size)
            | Self::InSeam(size)
            | Self::Astride(size, _)
            | Self::Hooked(size, _) => *size,
        }
    }
}

/// What is no finding, and how far to look.
#[derive(Clone, Copy, Debug)]
pub struct Allowance<'a> {
    /// Size of the slave facets.
    pub facet: f64,
    /// How deep the law of contact lets the node be.
    pub explained: f64,
    /// The farthest that any node has gone over the ground; distance within which the ground is known around the node.
    pub travel: f64,
    pub reach: f64,
    /// It began past an end of the master, and has not been in front of it since.
    pub aside: bool,
    pub controls: &'a Controls,
}

/// Where a node began, on the ground as it is now.
struct Start {
    place: Vec3,
    /// The normal of its last sight.
    normal: Option<Vec3>,
    /// A chain of straight parts from there, where it did not go straight.
    way: Vec<Vec3>,
}

/// A slave node and the master that it looks at, as that is at the end of the increment.
#[derive(Clone, Copy)]
pub struct View<'a> {
    pub ground: Ground<'a>,
    pub pair: &'a Pair,
    pub slave: usize,
}

/// Where a node began that is at `place` and was at `before`, on the ground as it is now; with a deformable master as the patch
/// that is now nearest to it has carried it along, or as it was where nothing is near.
fn start(view: &View, past: &Past, seen: &Seen, last: &Sight, [before, place]: [&Vec3; 2]) -> Start {
    let places = match past {
        Past::Poses(poses) => {
            let way = if poses.is_empty() { Vec::new() } else { way_past(poses, before, place) };
            return Start { place: view.ground.inward(before), normal: last.normal, way };
        }
        Past::Places(places) => places,
    };
    let along = || {
        let at = seen.nearest?;
        let (patch, stencil) = view.ground.patch(at.patch)?;
        let local = |place: &dyn Fn(u32) -> Vec3| {
            patch.shape(&stencil.iter().map(|&n| place(n)).collect::<Vec<_>>()).local(at.xi)
        };
        let (then, now) = (local(&|n| places[n as usize]), local(&|n| view.ground.position(n)));
        let turn = frame(&now) * frame(&then).try_inverse()?;
        let normal = last.normal.and_then(|n| (turn * n).try_normalize(f64::MIN_POSITIVE));
        Some(Start { place: now.point + turn * (before - then.point), normal, way: Vec::new() })
    };
    along().unwrap_or_else(|| Start { place: *before, normal: last.normal, way: Vec::new() })
}

impl View<'_> {
    /// The nearest point, ends included.
    fn nearest(&self, x: &Vec3, reach: f64) -> Option<Projection> {
        self.ground.nearest(self.pair, self.slave, x, reach)
    }

    /// How deep a point is behind the surface, if it is, where the nearest point is so `far`; `None` beside an end.
    fn depth(&self, x: &Vec3, far: f64) -> Option<f64> {
        let found = self.ground.closest(self.pair, self.slave, x, far * (1.0 + ROUNDED));
        found.map(|p| -p.gap).filter(|depth| *depth > 0.0)
    }
}

/// What is seen from a place.
struct Seen {
    /// As [`Sight::gap`].
    gap: f64,
    nearest: Option<Projection>,
    /// Depth behind the master; zero in front of it and beside it.
    depth: f64,
    /// Depth up to which it is not behind.
    allowed: f64,
}

impl Seen {
    fn new(view: &View, x: &Vec3, may: &Allowance) -> Self {
        let nearest = view.nearest(x, may.reach);
        let gap = nearest.map_or(may.reach, |p| p.gap);
        let depth = if gap < -may.controls.no_gap * may.facet { view.depth(x, -gap).unwrap_or(0.0) } else { 0.0 };
        let allowed = nearest.filter(|_| depth > 0.0).map_or(0.0, |p| allowed(view, &p, may));
        Self { gap, nearest, depth, allowed }
    }

    fn is_behind(&self) -> bool {
        self.depth > self.allowed
    }

    /// Whether it is still past the end of the master where it began, and does not touch it in front of it.
    fn is_aside(&self, may: &Allowance) -> bool {
        may.aside && self.gap <= may.controls.touching_gap * may.facet
    }

    fn sight(&self, side: Side) -> Sight {
        Sight {
            gap: self.gap,
            normal: self.nearest.map(|p| p.normal),
            patch: self.nearest.map_or(0, |p| p.patch),
            side,
            depth: if side == Side::Beside { 0.0 } else { self.depth },
        }
    }

    /// Whether the nearest point has moved along the surface since the `last` sight, as the node went here from its start.
    fn is_along(&self, last: &Sight, start: &Start, to: &Vec3, may: &Allowance) -> bool {
        let (Some(n), Some(m)) = (start.normal, self.nearest.map(|p| p.normal)) else { return false };
        let way = (to - m * self.gap) - (start.place - n * last.gap);
        let [rises, bends] = [way.dot(&(n + m)) / 2.0, way.dot(&(n - m)) / 8.0];
        let Controls { watch_along, watch_lift, .. } = *may.controls;
        way.norm() <= may.facet && n.dot(&m) >= watch_along && rises.abs().max(bends.abs()) <= watch_lift * may.facet
    }
}

/// Depth behind the surface up to which a node is not behind it, with its nearest point there.
fn allowed(view: &View, nearest: &Projection, may: &Allowance) -> f64 {
    may.controls.watch_deep * may.facet + may.explained + view.ground.kink(view.pair, nearest)
}

/// What is seen of a node at `x` before anything has moved.
pub fn first_sight(view: &View, x: &Vec3, may: &Allowance) -> Sight {
    let seen = Seen::new(view, &view.ground.seen_from(x), may);
    seen.sight(match seen.is_behind() {
        _ if seen.is_aside(may) => Side::Beside,
        true => Side::Inside,
        false => Side::Front,
    })
}

/// Judges a node that went between two places, and had the sight `last` where it began; `past` is how the master has moved.
pub fn judge(
    view: &View,
    last: &Sight,
    past: &Past,
    [from, place]: [&Vec3; 2],
    may: &Allowance,
) -> (Sight, Option<Finding>) {
    let to = &view.ground.seen_from(place);
    if let Ground::Surface(_, Meets::Own) = view.ground {
        return judge_self(view, last, to, may);
    }
    let seen = Seen::new(view, to, may);
    if seen.is_aside(may) {
        return (seen.sight(Side::Beside), None);
    }
    if last.side != Side::Front {
        return of_one_behind(&seen, last);
    }
    let front = seen.sight(Side::Front);
    let is_behind = seen.is_behind();
    if may.travel <= seen.gap {
        return (front, None);
    }
    let start = start(view, past, &seen, last, [from, place]);
    let straight = [start.place, *to];
    let way = if start.way.is_empty() { &straight } else { &start.way[..] };
    let travel: f64 = way.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
    let is_clear = || travel <= last.gap || travel <= seen.gap || seen.is_along(last, &start, to, may);
    if !is_behind && is_clear() {
        return (front, None);
    }
    let (through, clear) = match is_behind {
        true => (Finding::Behind(seen.depth), seen.sight(Side::Beside)),
        false => (Finding::Through(travel), front),
    };
    match passage(view, way, may, !is_behind) {
        Passage::Through => (front, Some(through)),
        Passage::Lost => (front, Some(Finding::Lost(travel))),
        Passage::Clear => (clear, None),
    }
}

/// Judges a node of a surface that meets itself. Both sides of its sheet are near, and the way alone does not tell: what
/// it looked at must still be in front of it.
fn judge_self(view: &View, last: &Sight, to: &Vec3, may: &Allowance) -> (Sight, Option<Finding>) {
    let seen = Seen::new(view, to, may);
    if last.side != Side::Front {
        return of_one_behind(&seen, last);
    }
    let depth = if seen.is_behind() {
        Some(seen.depth)
    } else {
        let allowed = seen.nearest.map_or(0.0, |p| allowed(view, &p, may));
        // Where that is still the nearest, it has been looked at.
        let left = last.normal.filter(|_| seen.nearest.is_none_or(|p| p.patch != last.patch));
        left.and_then(|_| view.ground.depth_behind(last.patch, to)).filter(|depth| *depth > allowed)
    };
    (seen.sight(Side::Front), depth.map(Finding::Behind))
}

/// Judges a node that was behind the master already: it may not go deeper where it began so.
fn of_one_behind(seen: &Seen, last: &Sight) -> (Sight, Option<Finding>) {
    let side = if seen.is_behind() { last.side } else { Side::Front };
    let deeper = side == Side::Inside && seen.depth > last.depth + seen.allowed;
    (seen.sight(side), deeper.then_some(Finding::Behind(seen.depth)))
}

/// How far the master is in the slave at a point `x` of its faces, along the inward normal there; no farther than `most`. The
/// ground is known `reach` around the point.
pub fn intrusion(view: &View, x: &Vec3, inward: &Vec3, most: f64, reach: f64, may: &Allowance) -> f64 {
    const STEPS: f64 = 32.0;
    let depth = |way: f64| {
        let at = view.ground.seen_from(&(x + inward * way));
        let far = -view.nearest(&at, reach - way)?.gap;
        view.depth(&at, far).filter(|_| far > may.controls.watch_step * may.facet)
    };
    let mut way = 0.0;
    while let Some(depth) = depth(way).filter(|_| way < most) {
        // Beside an end the surface may be nearer than what lies behind it.
        way += depth.max(most / STEPS);
    }
    way.min(most)
}

/// Where a way goes.
#[derive(Clone, Copy, Debug)]
enum Passage {
    Clear,
    Through,
    /// It takes more steps than are taken.
    Lost,
}

/// Where a way from the front of the surface goes, also when it is lifted off it at its beginning and, with `lift_end`, at its
/// end.
fn passage(view: &View, way: &[Vec3], may: &Allowance, lift_end: bool) -> Passage {
    let last = way.len() - 1;
    let lifted = |k: usize, x: &Vec3| if k < last || lift_end { lift(view, x, may) } else { *x };
    let way: Vec<Vec3> = way.iter().enumerate().map(|(k, x)| lifted(k, x)).collect();
    let mut all = Passage::Clear;
    for ends in way.windows(2) {
        match crosses(view, &ends[0], &ends[1], &way[last], may) {
            Passage::Through => return Passage::Through,
            Passage::Lost => all = Passage::Lost,
            Passage::Clear => {}
        }
    }
    all
}

/// A place a little farther off the surface, if it is near or as deep behind it as is allowed; in a corner off both its sides.
fn lift(view: &View, x: &Vec3, may: &Allowance) -> Vec3 {
    const SIDES: usize = 3;
    let lift = may.controls.watch_lift * may.facet;
    let mut x = *x;
    for _ in 0..SIDES {
        let near = view.nearest(&x, may.reach).filter(|p| p.gap < lift && p.gap >= -allowed(view, p, may));
        match near {
            Some(p) => x += p.normal * (lift - p.gap),
            None => break,
        }
    }
    x
}

/// Whether a straight way crosses the surface from its front to its back, or a wall from front to front; the ground is known
/// around `center`.
fn crosses(view: &View, from: &Vec3, to: &Vec3, center: &Vec3, may: &Allowance) -> Passage {
    let look = |x: &Vec3| Point::new(view, x, (may.reach - (x - center).norm()).max(may.facet));
    let (length, along) = ((to - from).norm(), (to - from).normalize());
    let mut here = look(from);
    let mut done = 0.0;
    for _ in 0..may.controls.watch_steps {
        if done >= length {
            return Passage::Clear;
        }
        // Not all of it, which would end on the surface, by rounding on either side.
        let step = (SHARE * here.gap.abs()).max(may.controls.watch_step * may.facet);
        done = (done + step).min(length);
        let there = look(&(from + along * done));
        if is_between(&here, &there, &look, POINT * may.facet) {
            return Passage::Through;
        }
        here = there;
    }
    if done < length { Passage::Lost } else { Passage::Clear }
}

/// A point of a way, with its distance from the surface.
struct Point {
    x: Vec3,
    gap: f64,
    normal: Vec3,
}

impl Point {
    fn new(view: &View, x: &Vec3, reach: f64) -> Self {
        let found = view.nearest(x, reach);
        Self { x: *x, gap: found.map_or(reach, |p| p.gap), normal: found.map_or(Vec3::zeros(), |p| p.normal) }
    }

    /// Whether the surface is between this point, in front of it, and another one.
    fn is_parted_from(&self, other: &Self) -> bool {
        self.gap >= 0.0 && (other.gap < 0.0 || self.normal.dot(&other.normal) < 0.0)
    }
}

/// Whether the way between two points near the surface goes through it, and not round an end.
fn is_between(from: &Point, to: &Point, look: &impl Fn(&Vec3) -> Point, point: f64) -> bool {
    crossing(from, to, look, point).is_some()
}

/// Where the way between two points near the surface goes through it, and not round an end. Halves it, until the surface
/// is farther away than the points are from each other, or they are one.
fn crossing(from: &Point, to: &Point, look: &impl Fn(&Vec3) -> Point, point: f64) -> Option<Vec3> {
    let length = (to.x - from.x).norm();
    if !from.is_parted_from(to) || length * (1.0 + ROUNDED) <= from.gap.abs().max(to.gap.abs()) {
        return None;
    }
    if length <= point {
        return Some((from.x + to.x) / 2.0);
    }
    let middle = look(&((from.x + to.x) / 2.0));
    crossing(from, &middle, look, point).or_else(|| crossing(&middle, to, look, point))
}

/// Where in space the straight line from a node in front of the surface to one behind it, both in the body, goes through it, if
/// from there it goes on for more than `far` on all sides; in a layer on both sides in its plane.
pub fn cut(view: &View, ends: &[Vec3; 2], far: f64, is_layer: bool, may: &Allowance) -> Option<Vec3> {
    let [front, behind] = ends.map(|x| view.ground.seen_from(&x));
    // Around nodes the ground is known.
    let known = |x: &Vec3| may.reach - (x - front).norm().min((x - behind).norm());
    let look = |x: &Vec3| Point::new(view, x, known(x).max(may.facet));
    let at = crossing(&look(&lift(view, &front, may)), &look(&behind), &look, POINT * may.facet)?;
    let (at, normal) = inside(view, &at, known(&at), may)?;
    let goes_on = |way: Vec3| goes_on(view, (at, normal), way, far, known, may);
    ways(&normal, is_layer).into_iter().all(goes_on).then(|| view.ground.in_space(&at))
}

/// Directions along a surface of this normal.
fn ways(normal: &Vec3, is_layer: bool) -> Vec<Vec3> {
    /// An end is found if it is no farther than 0.98 of the way.
    const WAYS: usize = 16;
    if is_layer {
        let way = normal.cross(&Vec3::z());
        return vec![way, -way];
    }
    let first = normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize();
    let second = normal.cross(&first);
    let angle = |k: usize| TAU * k as f64 / WAYS as f64;
    (0..WAYS).map(|k| first * angle(k).cos() + second * angle(k).sin()).collect()
}

/// Whether the surface goes on from a point with its normal for so `far` along a way, without an end. Where it is not `known`,
/// that is not said.
fn goes_on(
    view: &View,
    (mut at, mut normal): (Vec3, Vec3),
    mut way: Vec3,
    far: f64,
    known: impl Fn(&Vec3) -> f64,
    may: &Allowance,
) -> bool {
    /// No slot that is wider than such a part of the way is missed.
    const STEPS: usize = 4;
    (0..STEPS).all(|_| {
        let Some(along) = (way - normal * normal.dot(&way)).try_normalize(f64::MIN_POSITIVE) else { return false };
        let next = at + along * (far / STEPS as f64);
        let found = inside(view, &next, known(&next), may);
        (at, normal) = found.unwrap_or((at, normal));
        way = along;
        found.is_some()
    })
}

/// The point of the surface that is nearest to a place, with its normal, where that is no end of it: past an end the closest
/// point, on the extension of a piece, is another one.
fn inside(view: &View, x: &Vec3, reach: f64, may: &Allowance) -> Option<(Vec3, Vec3)> {
    let nearest = view.nearest(x, reach)?;
    let closest = view.ground.closest(view.pair, view.slave, x, reach)?;
    let is_same = (closest.point - nearest.point).norm() <= may.controls.watch_step * may.facet;
    // On an end the way to it is the normal of the nearest.
    is_same.then_some((closest.point, closest.normal))
}
