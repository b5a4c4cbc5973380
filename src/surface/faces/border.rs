//! The border of a face before sewing: closed chains of Bézier curves, and points of it with their directions.

use super::sewn::{Corner, Rim};
use super::trim::Trim;
use crate::Vec3;
use crate::surface::piece::Edge;
use crate::surface::{Curve, Face, Nurbs};
use nalgebra::{Matrix2, Vector2};

/// Samples that tell whether a curve is one point in space.
const SAMPLES: usize = 9;
/// How far inside a rim to look, over the size of the domain.
const INSIDE: f64 = 1e-7;

/// A face with its loops closed.
pub struct Border {
    pub surface: Nurbs,
    pub trimmed: bool,
    /// Bézier curves in the parameters of the surface.
    pub curves: Vec<Curve<2>>,
    /// The curve that follows each one around its loop.
    pub next: Vec<usize>,
    /// Curves that are one point in space, like the poles of a sphere.
    pub collapsed: Vec<bool>,
    /// Whether the face lies to the left of each curve.
    left: Vec<bool>,
}

/// A point of the border of a face.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    pub point: Vec3,
    /// Unit normal of the face.
    pub normal: Vec3,
    /// Unit vector along the rim.
    pub tangent: Vec3,
    /// Unit vector into the face, orthogonal to the rim.
    pub inward: Vec3,
}

impl Side {
    /// Unit vector along the rim with the face on its left, seen from its outside.
    pub fn around(&self) -> Vec3 {
        self.inward.cross(&self.normal)
    }
}

impl Border {
    /// The border of `face`, turned over if it is reversed; curves shorter in space than `tolerance` are points.
    pub fn new(face: &Face, tolerance: f64) -> Self {
        let [[u0, u1], [v0, v1]] = face.surface.domain();
        let mut loops: Vec<Vec<Curve<2>>> = face.loops.iter().map(|chain| closed(chain)).collect();
        if loops.is_empty() {
            let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(Vector2::from);
            loops.push((0..4).map(|k| Curve::line(corners[k], corners[(k + 1) % 4])).collect());
        }
        let next = loops.iter().flat_map(|chain| {
            let count = chain.len();
            (0..count).map(move |k| (k + 1) % count)
        });
        let firsts = loops.iter().scan(0, |first, chain| {
            let own = *first;
            *first += chain.len();
            Some(vec![own; chain.len()])
        });
        let next = next.zip(firsts.flatten()).map(|(k, first)| first + k).collect();
        let curves: Vec<_> = loops.concat();
        let trimmed = !face.loops.is_empty();
        let (collapsed, left) = (vec![false; curves.len()], vec![true; curves.len()]);
        let mut border = Self { surface: face.surface.clone(), trimmed, curves, next, collapsed, left };
        if face.reversed {
            border.turn();
        }
        border.examine(tolerance);
        border
    }

    /// Turns the face over, by exchanging its parameters.
    pub fn turn(&mut self) {
        self.surface = self.surface.swapped();
        self.curves.iter_mut().for_each(|curve| *curve = exchanged(curve));
        self.left.iter_mut().for_each(|left| *left = !*left);
    }

    fn examine(&mut self, tolerance: f64) {
        let trim = Trim::new(self.curves.iter());
        let everywhere = trim.seen_from([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        let step = INSIDE * (u1 - u0).min(v1 - v0);
        for (k, curve) in self.curves.iter().enumerate() {
            let at = |j: usize| curve.local(j as f64 / (SAMPLES - 1) as f64).point;
            let points: Vec<Vec3> = (0..SAMPLES).map(|j| self.surface.local(at(j).into()).point).collect();
            self.collapsed[k] = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum::<f64>() <= tolerance;
            let is_left = |t: &f64| {
                let local = curve.local(*t);
                let across = Vector2::new(-local.first.y, local.first.x).try_normalize(0.0).unwrap_or(Vector2::x());
                trim.holds((local.point + across * step).into(), &everywhere)
            };
            self.left[k] = [0.21, 0.52, 0.83].iter().filter(|t| is_left(t)).count() >= 2;
        }
    }

    /// The border at parameter `t` of curve `k`; `None` where it has no direction.
    pub fn side(&self, k: usize, t: f64) -> Option<Side> {
        let c = self.curves[k].local(t);
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        let inward = Vector2::new(-c.first.y, c.first.x).try_normalize(0.0)? * if self.left[k] { 1.0 } else { -1.0 };
        let s = self.surface.local(c.point.into());
        // At a pole the normal of the face is that of a point a little inside.
        let off = c.point + inward * (INSIDE * (u1 - u0).min(v1 - v0));
        let inside = self.surface.local(off.into());
        let regular = |l: &crate::surface::Local| {
            let area = l.area_vector();
            (area.norm() > 1e-9 * l.tangents[0].norm() * l.tangents[1].norm()).then(|| area.normalize())
        };
        let normal = regular(&s).or_else(|| regular(&inside))?;
        let tangent = (s.tangents[0] * c.first.x + s.tangents[1] * c.first.y).try_normalize(0.0)?;
        let into = inside.tangents[0] * inward.x + inside.tangents[1] * inward.y;
        let into = into - tangent * tangent.dot(&into);
        Some(Side { point: s.point, normal, tangent, inward: into.try_normalize(0.0)? })
    }

    /// Point of the border in space.
    pub fn point(&self, k: usize, t: f64) -> Vec3 {
        self.surface.local(self.curves[k].local(t).point.into()).point
    }

    /// Rims that know nothing of any neighbour.
    pub fn bare_rims(&self) -> Vec<Rim> {
        let corner = Corner { normal: Vec3::zeros(), is_end: true, is_soft: true };
        let bare = |curve: &Curve<2>| Rim {
            curve: curve.clone(),
            edge: Edge::Boundary,
            gap: 0.0,
            beyond: [Vec3::zeros(); 3],
            corners: [corner; 2],
        };
        self.curves.iter().map(bare).collect()
    }
}

/// The curve with its two coordinates exchanged.
pub fn exchanged(curve: &Curve<2>) -> Curve<2> {
    curve.transformed(&Matrix2::new(0.0, 1.0, 1.0, 0.0), &Vector2::zeros())
}

/// The Bézier curves of a chain, with lines where one does not begin where the last one ends.
fn closed(chain: &[Curve<2>]) -> Vec<Curve<2>> {
    let pieces: Vec<Curve<2>> = chain.iter().flat_map(|curve| curve.beziers()).map(|(_, bezier)| bezier).collect();
    let mut closed: Vec<Curve<2>> = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        closed.push(piece.clone());
        let points = piece.points();
        let (end, start) = (points[points.len() - 1], pieces[(k + 1) % pieces.len()].points()[0]);
        if end != start {
            closed.push(Curve::line(end, start));
        }
    }
    closed
}
