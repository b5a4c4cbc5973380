//! A watch that does not trust the solution: did a slave node go through the master, and is it behind one of its faces?
//!
//! It looks at places alone, those of the last accepted state and of the one that would follow it, with its own projection
//! and its own reach; what the contact elements found does not enter, but for the force that explains a penetration under a
//! penalty. It takes two states:
//!
//! - [`Ground`]: the master as it is at the end of the increment. The node's place at the beginning is brought there with
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

use super::deformable::frame;
use super::{BodySurface, Pair, Pose};
use crate::Vec3;
use crate::controls::Controls;
use crate::surface::{EXTENSION, Parametric, Polygon, Projection};
use crate::tool::Surface;

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

/// What is wrong with a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// So deep behind the master.
    Behind(f64),
    /// It went through the master on a way of this length.
    Through(f64),
}

impl Finding {
    /// A length to compare findings by.
    pub fn size(&self) -> f64 {
        match self {
            Self::Behind(size) | Self::Through(size) => *size,
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
    pub controls: &'a Controls,
}

/// Where a node began, on the ground as it is now.
pub struct Start {
    pub place: Vec3,
    /// The normal of its last sight.
    pub normal: Option<Vec3>,
    /// A chain of straight parts from there, where it did not go straight.
    pub way: Vec<Vec3>,
}

/// The master as it is at the end of the increment.
#[derive(Clone, Copy)]
pub enum Ground<'a> {
    Tool(&'a Surface),
    /// A deformable master, and which slave node looks at it.
    Body(&'a BodySurface, &'a Pair, usize),
}

/// Poses of a tool on its way from one to another, in parts of which it turns by no more than `part`, radians; none where
/// it does not turn.
pub fn turning(begin: &Pose, end: &Pose, part: f64) -> Vec<Pose> {
    let parts = (begin.angle(end) / part).ceil();
    if parts < 2.0 {
        return Vec::new();
    }
    (0..=parts as usize).map(|k| begin.toward(end, k as f64 / parts)).collect()
}

/// The way of a node, which goes straight, in the frame of a tool at these poses on its way.
pub fn way_past(poses: &[Pose], from: &Vec3, to: &Vec3) -> Vec<Vec3> {
    let part = 1.0 / (poses.len() - 1) as f64;
    poses.iter().enumerate().map(|(k, pose)| pose.inward(&(from + (to - from) * (k as f64 * part)))).collect()
}

/// Where a node would be now that was at `place` before, with its last sight, if the patch that is now nearest to it had
/// carried it along; `before` are the places of the surface's near nodes of then. As it was where nothing is near.
pub fn carried(surface: &BodySurface, seen: &Seen, before: &[Vec3], place: &Vec3, last: &Sight) -> Start {
    let along = || {
        let at = seen.nearest?;
        let (patch, stencil) = surface.patch(at.patch)?;
        let positions: Vec<Vec3> = stencil.iter().map(|&n| before[n as usize]).collect();
        let then = patch.shape(&positions).local(at.xi);
        let now = surface.shapes().get(at.patch)?.local(at.xi);
        let turn = frame(&now) * frame(&then).try_inverse()?;
        let normal = last.normal.and_then(|n| (turn * n).try_normalize(f64::MIN_POSITIVE));
        Some(Start { place: now.point + turn * (place - then.point), normal, way: Vec::new() })
    };
    along().unwrap_or_else(|| Start { place: *place, normal: last.normal, way: Vec::new() })
}

impl Ground<'_> {
    /// The nearest point, ends included.
    fn nearest(&self, x: &Vec3, reach: f64) -> Option<Projection> {
        match self {
            Self::Tool(surface) => surface.nearest(x, reach),
            Self::Body(surface, pair, slave) => surface.shapes().nearest_of(x, reach, &pair.outlook(*slave, x)),
        }
    }

    /// How deep a point is behind the surface, if it is, where the nearest point is so `far`; `None` beside an end.
    fn depth(&self, x: &Vec3, far: f64) -> Option<f64> {
        let reach = far * (1.0 + ROUNDED);
        let found = match self {
            Self::Tool(surface) => surface.closest(x, reach),
            Self::Body(surface, pair, slave) => surface.shapes().closest_of(x, reach, None, &pair.outlook(*slave, x)),
        };
        found.map(|p| -p.gap).filter(|depth| *depth > 0.0)
    }

    /// How deep `x` is behind the inside of a patch of a body.
    fn depth_behind(&self, patch: u32, x: &Vec3) -> Option<f64> {
        let Self::Body(surface, ..) = self else { return None };
        let patch = surface.shapes().get(patch)?;
        let foot = patch.closest(x);
        let is_inside = patch.sides(foot.xi).iter().all(|side| *side > POINT);
        is_inside.then(|| -(x - foot.point).dot(&patch.normal(foot.xi)))
    }

    /// How deep a node may be while it stays on the extension of another piece than the nearest, see [`Pair::project`]: the
    /// extension times the sine of the greatest angle there.
    fn lingers(&self, at: &Projection, controls: &Controls) -> f64 {
        match self {
            Self::Tool(surface) => surface.lingers(at.patch),
            Self::Body(surface, ..) => {
                let cosine = 1.0 - controls.kink_same;
                EXTENSION * (1.0 - cosine * cosine).sqrt() * surface.facet_size
            }
        }
    }
}

/// What is seen from a place.
pub struct Seen {
    /// As [`Sight::gap`].
    gap: f64,
    nearest: Option<Projection>,
    /// Depth behind the master; zero in front of it and beside it.
    depth: f64,
    /// Depth up to which it is not behind.
    allowed: f64,
}

impl Seen {
    fn new(ground: &Ground, x: &Vec3, may: &Allowance) -> Self {
        let nearest = ground.nearest(x, may.reach);
        let gap = nearest.map_or(may.reach, |p| p.gap);
        let depth = if gap < -may.controls.no_gap * may.facet { ground.depth(x, -gap).unwrap_or(0.0) } else { 0.0 };
        let allowed = nearest.filter(|_| depth > 0.0).map_or(0.0, |p| allowed(ground, &p, may));
        Self { gap, nearest, depth, allowed }
    }

    fn is_behind(&self) -> bool {
        self.depth > self.allowed
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
fn allowed(ground: &Ground, nearest: &Projection, may: &Allowance) -> f64 {
    may.controls.watch_deep * may.facet + may.explained + ground.lingers(nearest, may.controls)
}

/// What is seen of a node at `x` before anything has moved.
pub fn first_sight(ground: &Ground, x: &Vec3, may: &Allowance) -> Sight {
    let seen = Seen::new(ground, x, may);
    seen.sight(if seen.is_behind() { Side::Inside } else { Side::Front })
}

/// Judges a node that came over the ground to a place, and had the sight `last` where it began: its `start` is asked for when
/// it matters.
pub fn judge(
    ground: &Ground,
    last: &Sight,
    start: impl FnOnce(&Seen) -> Start,
    to: &Vec3,
    may: &Allowance,
) -> (Sight, Option<Finding>) {
    let seen = Seen::new(ground, to, may);
    if last.side != Side::Front {
        return of_one_behind(&seen, last);
    }
    let front = seen.sight(Side::Front);
    let is_behind = seen.is_behind();
    if may.travel <= seen.gap {
        return (front, None);
    }
    let start = start(&seen);
    let straight = [start.place, *to];
    let way = if start.way.is_empty() { &straight } else { &start.way[..] };
    if is_behind {
        return match goes_through(ground, way, may, false) {
            true => (front, Some(Finding::Behind(seen.depth))),
            false => (seen.sight(Side::Beside), None),
        };
    }
    let travel: f64 = way.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
    let clear = travel <= last.gap || travel <= seen.gap || seen.is_along(last, &start, to, may);
    let through = !clear && goes_through(ground, way, may, true);
    (front, through.then_some(Finding::Through(travel)))
}

/// Judges a node of a surface that meets itself. Both sides of its sheet are near, and the way alone does not tell: what
/// it looked at must still be in front of it.
pub fn judge_self(ground: &Ground, last: &Sight, to: &Vec3, may: &Allowance) -> (Sight, Option<Finding>) {
    let seen = Seen::new(ground, to, may);
    if last.side != Side::Front {
        return of_one_behind(&seen, last);
    }
    let depth = if seen.is_behind() {
        Some(seen.depth)
    } else {
        last.normal.and_then(|_| ground.depth_behind(last.patch, to)).filter(|depth| *depth > seen.allowed)
    };
    (seen.sight(Side::Front), depth.map(Finding::Behind))
}

/// Judges a node that was behind the master already: it may not go deeper where it began so.
fn of_one_behind(seen: &Seen, last: &Sight) -> (Sight, Option<Finding>) {
    let side = if seen.is_behind() { last.side } else { Side::Front };
    let deeper = side == Side::Inside && seen.depth > last.depth + seen.allowed;
    (seen.sight(side), deeper.then_some(Finding::Behind(seen.depth)))
}

/// Whether a way from the front of the surface goes through it, also when it is lifted off it at its beginning and, with
/// `lift_end`, at its end.
fn goes_through(ground: &Ground, way: &[Vec3], may: &Allowance, lift_end: bool) -> bool {
    let last = way.len() - 1;
    let lifted = |k: usize, x: &Vec3| if k < last || lift_end { lift(ground, x, may) } else { *x };
    let way: Vec<Vec3> = way.iter().enumerate().map(|(k, x)| lifted(k, x)).collect();
    way.windows(2).any(|ends| crosses(ground, &ends[0], &ends[1], &way[last], may))
}

/// A place a little farther off the surface, if it is near; in a corner off both its sides.
fn lift(ground: &Ground, x: &Vec3, may: &Allowance) -> Vec3 {
    const SIDES: usize = 3;
    let lift = may.controls.watch_lift * may.facet;
    let mut x = *x;
    for _ in 0..SIDES {
        match ground.nearest(&x, lift).filter(|p| p.gap >= -allowed(ground, p, may)) {
            Some(p) => x += p.normal * (lift - p.gap),
            None => break,
        }
    }
    x
}

/// Whether a straight way crosses the surface from its front to its back, or a wall from front to front; the ground is known
/// around `center`.
fn crosses(ground: &Ground, from: &Vec3, to: &Vec3, center: &Vec3, may: &Allowance) -> bool {
    let look = |x: &Vec3| Point::new(ground, x, (may.reach - (x - center).norm()).max(may.facet));
    let (length, along) = ((to - from).norm(), (to - from).normalize());
    let mut here = look(from);
    let mut done = 0.0;
    while done < length {
        // Not all of it, which would end on the surface, by rounding on either side.
        let step = (SHARE * here.gap.abs()).max(may.controls.watch_step * may.facet);
        done = (done + step).min(length);
        let there = look(&(from + along * done));
        if is_between(&here, &there, &look, POINT * may.facet) {
            return true;
        }
        here = there;
    }
    false
}

/// A point of a way, with its distance from the surface.
struct Point {
    x: Vec3,
    gap: f64,
    normal: Vec3,
}

impl Point {
    fn new(ground: &Ground, x: &Vec3, reach: f64) -> Self {
        let found = ground.nearest(x, reach);
        Self { x: *x, gap: found.map_or(reach, |p| p.gap), normal: found.map_or(Vec3::zeros(), |p| p.normal) }
    }

    /// Whether the surface is between this point, in front of it, and another one.
    fn is_parted_from(&self, other: &Self) -> bool {
        self.gap >= 0.0 && (other.gap < 0.0 || self.normal.dot(&other.normal) < 0.0)
    }
}

/// Whether the way between two points near the surface goes through it, and not round an end. Halves it, until the surface
/// is farther away than the points are from each other, or they are one.
fn is_between(from: &Point, to: &Point, look: &impl Fn(&Vec3) -> Point, point: f64) -> bool {
    let length = (to.x - from.x).norm();
    if !from.is_parted_from(to) || length * (1.0 + ROUNDED) <= from.gap.abs().max(to.gap.abs()) {
        return false;
    }
    if length <= point {
        return true;
    }
    let middle = look(&((from.x + to.x) / 2.0));
    is_between(from, &middle, look, point) || is_between(&middle, to, look, point)
}
