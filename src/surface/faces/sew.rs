//! Sewing: what lies beyond the rims of the faces of a CAD model.
//!
//! Faces of a file know nothing of each other, and where they meet their borders differ by the tolerance of the program
//! that wrote them. A rim is joined where another rim runs within the tolerance and in nearly the same direction: of
//! another face, or of the same where a surface closes on itself. It is cut where the rims of neighbours end and where
//! the kind of the join changes. Rims of one point, like the poles of a sphere, are smooth when the surface has one
//! normal there.
//!
//! Then the faces are [turned](super::orient) to one side, and their rims [learn](super::rims) what is beyond them.

use super::border::{Border, Side};
use super::curves::bisect;
use super::piece::FacePiece;
use super::sewn::{Rim, SewnFace};
use crate::Vec3;
use crate::error::{Error, Result};
use crate::surface::Face;
use crate::surface::cell::Cell;
use crate::surface::facets::angle;
use crate::surface::piece::Edge;
use crate::surface::piece_set::PieceSet;

/// Tolerance that suits most files, over the diagonal of the model's box: gaps are between 1e-6 and 1e-3 of it.
const TOLERANCE: f64 = 2e-4;

/// Samples of a rim between two cuts.
const SAMPLES: usize = 8;
/// Cosine of the angle between rims from which they are not joined.
const PARALLEL: f64 = 0.7;

/// The tolerance, a length, that suits most models.
pub fn usual_tolerance(faces: &[Face]) -> f64 {
    let boxes = faces.iter().map(|face| face.surface.bounds());
    let whole = boxes.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
    whole.map_or(0.0, |(low, high)| TOLERANCE * (high - low).norm())
}

/// Joins the faces of a model.
///
/// Edges are sharp where normals differ by `feature_angle` (radians) or more. Rims within `tolerance`, a length, are
/// joined, see [`usual_tolerance`]. `flip` turns the whole model over. Fails, naming the faces, when they cannot be oriented,
/// and for a model without faces.
pub fn sew(faces: &[Face], feature_angle: f64, tolerance: f64, flip: bool) -> Result<Vec<SewnFace>> {
    if faces.is_empty() {
        return Err(Error::input_anywhere("the model has no faces", "give a model with trimmed or plain surfaces"));
    }
    let borders: Vec<Border> = faces.iter().map(|face| Border::new(face, tolerance)).collect();
    let mut sewing = Sewing::new(borders, feature_angle, tolerance)?;
    sewing.orient(faces, flip)?;
    sewing.finish()
}

/// Where a rim is joined.
#[derive(Clone, Copy)]
pub struct Join {
    pub face: usize,
    pub side: Side,
    pub distance: f64,
}

pub struct Sewing {
    pub borders: Vec<Border>,
    pieces: PieceSet<FacePiece>,
    pub feature_angle: f64,
    pub tolerance: f64,
    /// Places to cut every curve of every face.
    pub cuts: Vec<Vec<Vec<f64>>>,
    /// Faces to be turned over.
    pub turned: Vec<bool>,
}

impl Sewing {
    fn new(borders: Vec<Border>, feature_angle: f64, tolerance: f64) -> Result<Self> {
        let (mut pieces, mut first) = (Vec::new(), 0);
        for (id, border) in borders.iter().enumerate() {
            let face = sewn(border, id as u32, first, feature_angle, border.bare_rims());
            first = next_id(first, &face)?;
            pieces.extend(FacePiece::of_face(&face));
        }
        let pieces = PieceSet::of_pieces(pieces);
        let turned = vec![false; borders.len()];
        let mut sewing = Self { borders, pieces, feature_angle, tolerance, cuts: Vec::new(), turned };
        sewing.cuts = sewing.cuts_at_corners();
        Ok(sewing)
    }

    /// Rims within the tolerance of a point: face, curve, its parameter and the distance.
    fn rims_near(&self, x: &Vec3) -> Vec<(usize, usize, f64, f64)> {
        let mut found = Vec::new();
        for k in self.pieces.within(&x.add_scalar(-self.tolerance), &x.add_scalar(self.tolerance)) {
            let piece = &self.pieces.pieces()[k as usize];
            let face = piece.face() as usize;
            for (rim, t, distance) in piece.rims_near(x, self.tolerance) {
                if !self.borders[face].collapsed[rim as usize] {
                    found.push((face, rim as usize, t, distance));
                }
            }
        }
        found
    }

    /// Every curve is cut where another one ends on it.
    fn cuts_at_corners(&self) -> Vec<Vec<Vec<f64>>> {
        let mut cuts: Vec<Vec<Vec<f64>>> = self.borders.iter().map(|b| vec![Vec::new(); b.curves.len()]).collect();
        for border in &self.borders {
            for k in (0..border.curves.len()).filter(|k| !border.collapsed[*k]) {
                for (face, curve, t, _) in self.rims_near(&border.point(k, 0.0)) {
                    cuts[face][curve].push(t);
                }
            }
        }
        for (border, cuts) in self.borders.iter().zip(&mut cuts) {
            for (k, cuts) in cuts.iter_mut().enumerate() {
                self.space_out(border, k, cuts);
            }
        }
        cuts
    }

    /// Sorts cuts of a curve and drops those that are no further than the tolerance from another or from an end.
    fn space_out(&self, border: &Border, k: usize, cuts: &mut Vec<f64>) {
        cuts.sort_by(f64::total_cmp);
        let apart = |a: f64, b: f64| (border.point(k, a) - border.point(k, b)).norm() > 2.0 * self.tolerance;
        let mut last = 0.0;
        cuts.retain(|t| {
            let keep = *t - last > 1e-6 && apart(last, *t) && 1.0 - *t > 1e-6 && apart(*t, 1.0);
            last = if keep { *t } else { last };
            keep
        });
    }

    /// What a rim is joined with at a point of it.
    pub fn join(&self, face: usize, curve: usize, side: &Side) -> Option<Join> {
        let joins = self.rims_near(&side.point).into_iter().filter_map(|(other, rim, t, distance)| {
            if (other, rim) == (face, curve) {
                return None;
            }
            let there = self.borders[other].side(rim, t)?;
            let is_parallel = there.tangent.dot(&side.tangent).abs() > PARALLEL;
            let is_across = other != face || there.inward.dot(&side.inward) < 0.0;
            (is_parallel && is_across).then_some(Join { face: other, side: there, distance })
        });
        joins.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Parameters of samples between the cuts of a curve.
    pub fn samples(&self, face: usize, curve: usize) -> Vec<f64> {
        let ends: Vec<f64> = [0.0].iter().chain(&self.cuts[face][curve]).chain(&[1.0]).copied().collect();
        let between = |pair: &[f64]| {
            let (a, b) = (pair[0], pair[1]);
            (0..SAMPLES).map(move |k| a + (b - a) * (k as f64 + 0.5) / SAMPLES as f64).collect::<Vec<_>>()
        };
        ends.windows(2).flat_map(between).collect()
    }

    /// The outward normal of a face.
    pub fn outward(&self, face: usize, side: &Side) -> Vec3 {
        if self.turned[face] { -side.normal } else { side.normal }
    }

    /// What a rim is at a point of it, and the join.
    pub fn kind(&self, face: usize, curve: usize, t: f64) -> (Edge, Option<Join>) {
        let Some(side) = self.borders[face].side(curve, t) else { return (Edge::Boundary, None) };
        match self.join(face, curve, &side) {
            None => (Edge::Boundary, None),
            Some(join) => {
                let turn = angle(&self.outward(face, &side), &self.outward(join.face, &join.side));
                (if turn < self.feature_angle { Edge::Smooth } else { Edge::Sharp }, Some(join))
            }
        }
    }

    /// Adds cuts where the kind of the join changes.
    pub fn cut_at_changes(&mut self) {
        for face in 0..self.borders.len() {
            for curve in 0..self.borders[face].curves.len() {
                if self.borders[face].collapsed[curve] {
                    continue;
                }
                let samples = self.samples(face, curve);
                let kinds: Vec<Edge> = samples.iter().map(|t| self.kind(face, curve, *t).0).collect();
                let mut cuts = self.cuts[face][curve].clone();
                for k in (1..samples.len()).filter(|k| kinds[*k] != kinds[k - 1]) {
                    let (a, b) = (samples[k - 1], samples[k]);
                    if !cuts.iter().any(|cut| a < *cut && *cut < b) {
                        let is_later = |s: f64| self.kind(face, curve, a + (b - a) * s).0 != kinds[k - 1];
                        cuts.push(a + (b - a) * bisect(is_later, true));
                    }
                }
                self.space_out(&self.borders[face], curve, &mut cuts);
                self.cuts[face][curve] = cuts;
            }
        }
    }
}

/// The face with what is known of it.
pub fn sewn(border: &Border, id: u32, first: u32, feature_angle: f64, rims: Vec<Rim>) -> SewnFace {
    let bounds = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    SewnFace { id, first, surface: border.surface.clone(), trimmed: border.trimmed, feature_angle, bounds, rims }
}

/// The id after those of the pieces of a face.
pub fn next_id(first: u32, face: &SewnFace) -> Result<u32> {
    let count = u32::try_from(Cell::of_surface(&face.surface).len()).ok();
    count
        .and_then(|count| first.checked_add(count))
        .ok_or_else(|| Error::input_anywhere("the model has too many curved pieces", "give a simpler model"))
}
