//! The search of the closest point among many pieces, and the choice between those that are equally close.

use super::PieceSet;
use super::tree::away;
use crate::surface::piece::{EXTENSION, Edge, Piece};
use crate::surface::projection::{Extent, Foot, Projection, descend};
use crate::{Mat3, Vec3};
use smallvec::SmallVec;

/// Distances that differ by less, over the size of a piece, are equal.
const EQUAL: f64 = 1e-12;
/// The same for the piece of the last projection.
pub(super) const KEEP: f64 = 1e-6;
/// Distance to an edge, over the size of the piece, below which the direction to it means nothing.
const TOUCH: f64 = 1e-9;
/// Angle between the normals of a surface and one of its pieces, in radians, below which there is no edge.
const FLAT: f64 = 1e-3;
/// Overshoots that differ by less are equal.
const ROUNDED: f64 = 1e-9;
/// Parameters within which a point that is between pieces counts as on the edge or corner where they meet.
const BORDER: f64 = 1e-3;

/// Beyond the extension of smooth edges, where pieces turn away from each other, the way to the edge leans no more than this to the
/// surface of either: tan 30 degrees, that between facets of which three make a quarter circle.
const LEANS: f64 = 0.577;

/// What is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// The nearest point.
    Nearest,
    /// The point of contact.
    Contact,
    /// The same, asking the neighbours of every edge.
    WaryContact,
    /// The points of contact that are as good.
    Even,
}

/// Which pieces count.
pub trait Admission<P> {
    /// Whether some point of the piece may be admitted: what says no is not looked at closely.
    fn may_admit(&self, _: &P, _: &Extent) -> bool {
        true
    }

    /// Whether the piece counts, with its point nearest to x.
    fn admits(&self, piece: &P, nearest: &Foot) -> bool;
}

impl<P, F: Fn(&P, &Foot) -> bool> Admission<P> for F {
    fn admits(&self, piece: &P, nearest: &Foot) -> bool {
        self(piece, nearest)
    }
}

/// A piece with a projection of x.
#[derive(Clone, Copy)]
struct Hit {
    index: usize,
    /// Least distance to the piece without extension, and where it is.
    distance: f64,
    core: Landing,
    /// The same with the extension that the edges allow.
    place: Landing,
    overshoot: f64,
}

/// Parameters, and the limits of the domain that they lie on.
#[derive(Clone, Copy)]
struct Landing {
    xi: [f64; 2],
    limits: u32,
}

impl From<Foot> for Landing {
    fn from(foot: Foot) -> Self {
        Self { xi: foot.xi, limits: foot.limits }
    }
}

/// As many pieces as are told apart around one point; of more, those with the lowest ids count.
const HITS: usize = 24;
/// As many as are close in most places: a point inside a piece, on an edge, on a corner of four.
const FEW: usize = 4;

pub struct Search<'a, P> {
    set: &'a PieceSet<P>,
    x: &'a Vec3,
    kept: Option<usize>,
    question: Question,
    admission: &'a dyn Admission<P>,
    /// Least distance of a piece with a projection, and of one without.
    best: f64,
    lost: f64,
    /// They are as close as the best was when they were found.
    hits: SmallVec<[Hit; FEW]>,
    /// Some piece was not admitted.
    hides: bool,
}

impl<'a, P: Piece> Search<'a, P> {
    pub fn new(
        set: &'a PieceSet<P>,
        x: &'a Vec3,
        reach: f64,
        kept: Option<usize>,
        question: Question,
        admission: &'a dyn Admission<P>,
    ) -> Self {
        let hits = SmallVec::new();
        Self { set, x, kept, question, admission, best: reach, lost: f64::INFINITY, hits, hides: false }
    }

    /// Considers all pieces whose boxes are as close as the best piece: from the box around x when a last projection
    /// tells how large it must be, else near ones first.
    pub fn run(&mut self, warm: Option<[f64; 2]>) {
        if let Some(kept) = self.kept {
            self.consider(kept, warm);
        }
        let set = self.set;
        let equal = if self.question == Question::Even { KEEP } else { EQUAL };
        let margin = equal * set.largest + self.rounding() + set.seam;
        if !self.hits.is_empty() {
            let around = Vec3::repeat(self.best + margin);
            for (index, bounds) in set.tree.meeting(&(self.x - around), &(self.x + around)) {
                if self.kept != Some(index) && away(&bounds, self.x) <= self.best + margin {
                    self.consider(index, None);
                }
            }
        } else {
            set.tree.approach(self.x, self.best + margin, |index| {
                if self.kept != Some(index) {
                    self.consider(index, None);
                }
                self.best + margin
            });
        }
    }

    /// Whether a piece without projection is closer than the edge to be chosen: it may be the one across the edge.
    pub fn is_doubtful(&self) -> bool {
        self.choice().is_some_and(|hit| hit.place.limits != 0 && self.lost < hit.distance)
    }

    /// The projection to choose.
    pub fn answer(&self) -> Option<Projection> {
        self.choice().map(|hit| self.projection(hit))
    }

    /// The projections onto pieces between which there is nothing to choose, with the angles that the pieces fill there; on a
    /// sharp edge or corner the point of it instead.
    pub fn even(&self) -> Result<Vec<(Projection, f64)>, Vec3> {
        let Some(chosen) = self.choice() else { return Ok(Vec::new()) };
        let pieces = &self.set.pieces;
        if chosen.place.limits != 0 {
            return Err(pieces[chosen.index].point(chosen.core.xi));
        }
        let is_inside = |hit: &&Hit| hit.place.limits == 0 && self.is_close(hit, 0.0);
        let least = self.hits.iter().filter(is_inside).map(|hit| hit.overshoot).fold(f64::INFINITY, f64::min);
        let even = self.hits.iter().filter(is_inside).filter(|hit| hit.overshoot <= least + KEEP);
        Ok(even.map(|hit| (self.projection(hit), angle(&pieces[hit.index], hit.core.xi))).collect())
    }

    fn consider(&mut self, index: usize, start: Option<[f64; 2]>) {
        let (piece, extent) = (&self.set.pieces[index], self.set.extent(index));
        if !self.admission.may_admit(piece, extent) {
            // It may be this close: then the neighbours are asked.
            self.hides = true;
            self.lost = self.lost.min((self.x - extent.center).norm() - extent.radius);
            return;
        }
        let most = self.best + self.slack(index) + self.set.seam;
        if extent.is_beyond(self.x, most) {
            return;
        }
        let core = self.core(index, self.x, start, most);
        if core.distance > most {
            return;
        }
        let is_admitted = self.admission.admits(piece, &core);
        self.hides |= !is_admitted;
        let settled = match self.question {
            _ if !is_admitted => None,
            Question::Nearest => Some((core, 0.0)),
            _ => piece.settle(self.x, core),
        };
        let Some((foot, overshoot)) = settled else {
            self.lost = self.lost.min(core.distance);
            return;
        };
        let hit = Hit { index, distance: core.distance, core: core.into(), place: foot.into(), overshoot };
        if self.question == Question::WaryContact
            && foot.limits != 0
            && self.a_neighbour_is_closer(&hit, &core.local.point)
        {
            return;
        }
        self.best = self.best.min(core.distance);
        self.push(hit);
    }

    fn core(&self, index: usize, x: &Vec3, start: Option<[f64; 2]>, most: f64) -> Foot {
        self.set.pieces[index].core(self.set.extent(index), x, start, most)
    }

    fn push(&mut self, hit: Hit) {
        if self.hits.len() == HITS {
            let mut hits = std::mem::take(&mut self.hits);
            hits.retain(|hit| self.is_close(hit, self.set.seam));
            self.hits = hits;
        }
        if self.hits.len() < HITS {
            self.hits.push(hit);
        } else if let Some(last) = self.hits.iter_mut().max_by_key(|h| h.index).filter(|h| h.index > hit.index) {
            *last = hit;
        }
    }

    /// Whether a piece that touches `hit` at its core point comes closer to x.
    fn a_neighbour_is_closer(&self, hit: &Hit, point: &Vec3) -> bool {
        let touch = TOUCH * self.set.radii[hit.index] + self.set.pieces[hit.index].seam();
        let around = Vec3::repeat(touch);
        self.set.tree.meeting(&(point - around), &(point + around)).any(|(index, _)| {
            index != hit.index
                && self.core(index, point, None, touch).distance < touch
                && self.is_closer(index, hit.distance - self.slack(index))
        })
    }

    fn is_closer(&self, index: usize, than: f64) -> bool {
        self.core(index, self.x, None, than).distance < than
    }

    fn rounding(&self) -> f64 {
        8.0 * f64::EPSILON * self.x.amax()
    }

    /// How much further away than the best a piece may be and count as equally close.
    fn slack(&self, index: usize) -> f64 {
        let keeps = self.kept == Some(index) || self.question == Question::Even;
        let keep = if keeps { KEEP } else { EQUAL };
        keep * self.set.radii[index] + self.rounding()
    }

    /// Whether a hit is as close as the best, but for `seam`.
    fn is_close(&self, hit: &Hit, seam: f64) -> bool {
        hit.distance <= self.best + self.slack(hit.index) + seam
    }

    /// Faces that meet at a distance are equally close beyond the smooth edge of the closest.
    fn seam(&self) -> f64 {
        if self.set.seam == 0.0 {
            return 0.0;
        }
        let hits = self.hits.iter().filter(|hit| self.is_close(hit, 0.0));
        let closest = hits.min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index)));
        closest.filter(|hit| hit.overshoot > 0.0).map_or(0.0, |hit| self.set.pieces[hit.index].seam())
    }

    /// The hit to take: the least overshoot, inside rather than on an edge, the lowest id.
    fn choice(&self) -> Option<&Hit> {
        let rank = |hit: &Hit| {
            let kept = if self.kept == Some(hit.index) { KEEP } else { 0.0 };
            // In steps well above rounding, so that equal overshoots are seen to be equal.
            (((hit.overshoot - kept) / ROUNDED).round() as i64, hit.place.limits != 0, hit.index)
        };
        let seam = self.seam();
        self.hits.iter().filter(|hit| self.is_close(hit, seam)).min_by_key(|hit| rank(hit))
    }

    fn projection(&self, hit: &Hit) -> Projection {
        let piece = &self.set.pieces[hit.index];
        let Landing { xi, limits } = hit.place;
        let local = piece.local(xi);
        let r = self.x - local.point;
        let foot = Foot { xi, limits, local, distance: r.norm() };
        let (gap, normal, normal_gradient) = if limits == 0 || self.is_perpendicular(hit, &foot) {
            piece.on_surface(self.x, &foot)
        } else {
            let mean = self.mean_normal(hit);
            if foot.distance > TOUCH * self.set.radii[hit.index] {
                piece.on_edge(self.x, &foot, mean.dot(&r) < 0.0)
            } else {
                let normal = mean.normalize();
                (r.dot(&normal), normal, Mat3::zeros())
            }
        };
        Projection { gap, point: local.point, normal, normal_gradient, patch: piece.id(), xi }
    }

    /// Whether the nearest point, though on an edge, is the foot of a perpendicular; for x itself, whether the surface is
    /// smooth there.
    fn is_perpendicular(&self, hit: &Hit, foot: &Foot) -> bool {
        if self.question != Question::Nearest {
            return false;
        }
        let normal = self.set.pieces[hit.index].normal(foot.xi);
        let (along, tolerance) = if foot.distance > TOUCH * self.set.radii[hit.index] {
            (self.x - foot.local.point, TOUCH)
        } else {
            (self.mean_normal(hit), FLAT)
        };
        along.cross(&normal).norm() <= tolerance * along.norm()
    }

    /// Sum of the normals around the core point of `chosen`, weighted by angle; for the nearest point also of pieces that do not
    /// count: they bound the same solid.
    fn mean_normal(&self, chosen: &Hit) -> Vec3 {
        let pieces = &self.set.pieces;
        let point = pieces[chosen.index].point(chosen.core.xi);
        let touch = KEEP * self.set.radii[chosen.index];
        let normal =
            |piece: &P, foot: &Foot| ((foot.local.point - point).norm() <= touch).then(|| piece.angle_normal(foot));
        if self.hides && self.question == Question::Nearest {
            let around = Vec3::repeat(touch);
            let near = self.set.tree.meeting(&(point - around), &(point + around));
            return near.filter_map(|(k, _)| normal(&pieces[k], &self.core(k, &point, None, touch))).sum();
        }
        let of_hit = |hit: &Hit| {
            let Landing { xi, limits } = hit.core;
            let piece = &pieces[hit.index];
            normal(piece, &Foot { xi, limits, local: piece.local(xi), distance: 0.0 })
        };
        self.hits.iter().filter(|hit| self.is_close(hit, 0.0)).filter_map(of_hit).sum()
    }
}

/// The angle that a piece fills around a point of its own, which is on an edge or a corner if it is as good as there.
pub fn angle<P: Piece>(piece: &P, xi: [f64; 2]) -> f64 {
    let sides = piece.sides(xi);
    let limits = (0..piece.count()).filter(|k| sides[*k] < BORDER).map(|k| 1 << k).sum();
    piece.angle_normal(&Foot { xi, limits, local: piece.local(xi), distance: 0.0 }).norm()
}

/// From the closest point of a piece without extension to the one with the extension that its edges allow, and how much
/// of it that needs. `None` beyond an end of the surface.
pub fn settle<P: Piece + ?Sized>(piece: &P, x: &Vec3, core: Foot) -> Option<(Foot, f64)> {
    let edges = piece.edges();
    let on = |foot: &Foot, kind: &dyn Fn(Edge) -> bool| (0..4).any(|k| foot.is_on(k) && kind(edges[k]));
    let extension = |kind: &dyn Fn(Edge) -> bool| edges.map(|edge| if kind(edge) { EXTENSION } else { 0.0 });
    let (soft, end) = (|edge| edge != Edge::Sharp, |edge| edge == Edge::Boundary);
    let is_soft = on(&core, &soft);
    if is_soft {
        let foot = descend(piece, x, &extension(&soft), core.xi);
        if !on(&foot, &soft) {
            return Some((foot, piece.overshoot(foot.xi)));
        }
    }
    let foot = if on(&core, &end) { descend(piece, x, &extension(&end), core.xi) } else { core };
    let count = piece.count();
    let at_corner = |k: usize| foot.is_on(k) && foot.is_on((k + count - 1) % count);
    if on(&foot, &end) || (0..count).any(|k| at_corner(k) && piece.ends_at(k)) {
        return None;
    }
    // At a corner of the surface, beside a smooth edge drawn on past the end: the neighbour knows whether it is over the surface.
    let leans = |foot: &Foot| {
        let (way, normal) = (x - foot.local.point, piece.normal(foot.xi));
        let up = way.dot(&normal);
        (way - normal * up).norm() > LEANS * up.abs()
    };
    if is_soft && on(&core, &end) && foot.limits != core.limits && leans(&foot) {
        return None;
    }
    // Beyond all extension the smooth edge comes after any piece that needs less.
    Some((foot, if is_soft { 1.0 } else { 0.0 }))
}
