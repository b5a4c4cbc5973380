//! What the rims of sewn faces are: their kinds, the normals beyond them, and the corners where they meet.

use super::border::exchanged;
use super::curves::part;
use super::piece::FacePiece;
use super::sew::{Join, Sewing, next_id, sewn};
use super::sewn::{Corner, Rim, SewnFace};
use crate::Vec3;
use crate::error::Result;
use crate::surface::Parametric;
use crate::surface::facets::angle;
use crate::surface::piece::Edge;
use nalgebra::Vector2;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::f64::consts::TAU;

/// Samples of a rim.
const SAMPLES: usize = 8;

/// A corner of one face: its normal times its angle, and whether the surface ends in one of its rims.
type Wedge = GeomWithData<[f64; 3], (Vec3, bool)>;

/// A part of a curve of a border between two cuts.
struct Part {
    curve: usize,
    range: [f64; 2],
}

/// The parts of the border of a face.
struct Parts {
    parts: Vec<Part>,
    rims: Vec<Rim>,
    /// The part that leads to each part around its loop.
    before: Vec<usize>,
}

impl Sewing {
    /// The faces with their rims as they are now known.
    pub fn finish(mut self) -> Result<Vec<SewnFace>> {
        self.cut_at_changes();
        let mut all = Vec::new();
        for face in 0..self.borders.len() {
            let parts = self.parts(face);
            let rims: Vec<Rim> = parts.iter().map(|part| self.rim(face, part)).collect();
            all.push(Parts { before: self.before(face, &parts), parts, rims });
        }
        self.set_corners(&mut all);
        let (mut faces, mut first) = (Vec::new(), 0);
        let turned = std::mem::take(&mut self.turned);
        for (id, (Parts { mut rims, .. }, turn)) in all.into_iter().zip(turned).enumerate() {
            let border = &mut self.borders[id];
            if turn {
                border.turn();
                rims.iter_mut().for_each(|rim| rim.curve = exchanged(&rim.curve));
            }
            let mut face = sewn(border, id as u32, first, self.feature_angle, rims);
            let pieces = FacePiece::of_face(&face);
            face.bounds =
                pieces.iter().map(|piece| piece.bounds()).fold(face.bounds, |(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
            first = next_id(first, &face)?;
            faces.push(face);
        }
        Ok(faces)
    }

    /// The parts that the curves of a face are cut into.
    fn parts(&self, face: usize) -> Vec<Part> {
        let mut parts = Vec::new();
        for (curve, cuts) in self.cuts[face].iter().enumerate() {
            let ends: Vec<f64> = [0.0].iter().chain(cuts).chain(&[1.0]).copied().collect();
            parts.extend(ends.windows(2).map(|pair| Part { curve, range: [pair[0], pair[1]] }));
        }
        parts
    }

    fn rim(&self, face: usize, &Part { curve, range: [a, b] }: &Part) -> Rim {
        let border = &self.borders[face];
        let at = |s: f64| a + (b - a) * s;
        let no_corner = Corner { normal: Vec3::zeros(), is_end: false, is_soft: false };
        let shape = part(&border.curves[curve], [a, b]);
        let bare =
            Rim { curve: shape, edge: Edge::Smooth, gap: 0.0, beyond: [Vec3::zeros(); 3], corners: [no_corner; 2] };
        if border.collapsed[curve] {
            return self.pole(face, curve, bare);
        }
        let samples: Vec<(Edge, Option<Join>)> =
            (0..SAMPLES).map(|k| self.kind(face, curve, at((k as f64 + 0.5) / SAMPLES as f64))).collect();
        let count = |kind: Edge| samples.iter().filter(|(edge, _)| *edge == kind).count();
        let edge = [Edge::Smooth, Edge::Sharp, Edge::Boundary].into_iter().max_by_key(|kind| count(*kind));
        let gap = samples.iter().filter_map(|(_, join)| *join).map(|join| join.distance).fold(0.0, f64::max);
        let beyond = [0, SAMPLES / 2, SAMPLES - 1]
            .map(|k| samples[k].1.map_or(Vec3::zeros(), |join| self.outward(join.face, &join.side)));
        Rim { edge: edge.unwrap_or(Edge::Boundary), gap, beyond, ..bare }
    }

    /// A rim that is one point: the surface goes on through it when it has one normal there.
    fn pole(&self, face: usize, curve: usize, bare: Rim) -> Rim {
        let border = &self.borders[face];
        let [[u0, u1], [v0, v1]] = border.surface.domain();
        let middle = Vector2::new(0.5 * (u0 + u1), 0.5 * (v0 + v1));
        let normal = |k: usize| {
            let c = border.curves[curve].local(k as f64 / SAMPLES as f64).point;
            // A little inside, where the surface has a normal.
            let area = border.surface.local((c + (middle - c) * 1e-6).into()).area_vector();
            let normal = area.try_normalize(0.0)?;
            Some(if self.turned[face] { -normal } else { normal })
        };
        let normals: Vec<Vec3> = (0..=SAMPLES).filter_map(normal).collect();
        let sum: Vec3 = normals.iter().sum();
        let is_smooth = normals.iter().all(|n| angle(n, &sum) < 0.5 * self.feature_angle);
        Rim { edge: if is_smooth { Edge::Smooth } else { Edge::Sharp }, beyond: [sum; 3], ..bare }
    }

    /// Gives every rim its corners: what the faces around them look like.
    fn set_corners(&self, all: &mut [Parts]) {
        let wedges = all.iter().enumerate().flat_map(|(face, own)| self.wedges(face, own)).collect();
        let wedges: RTree<Wedge> = RTree::bulk_load(wedges);
        for (face, Parts { before, parts, rims }) in all.iter_mut().enumerate() {
            for k in 0..parts.len() {
                let (last, part) = (before[k], &parts[k]);
                let point = self.borders[face].point(part.curve, part.range[0]);
                let (mut normal, mut is_end) = (Vec3::zeros(), false);
                for wedge in wedges.locate_within_distance(point.into(), (2.0 * self.tolerance).powi(2)) {
                    normal += wedge.data.0;
                    is_end |= wedge.data.1;
                }
                let is_pole = |k: usize| self.borders[face].collapsed[parts[k].curve];
                if let Some(pole) = [k, last].into_iter().find(|k| is_pole(*k)) {
                    normal = rims[pole].beyond[0];
                } else if normal.norm() < 1e-3 {
                    // Faces that cancel out.
                    normal = rims[k].beyond[0] + rims[last].beyond[2];
                }
                let is_soft = [last, k].iter().any(|k| rims[*k].edge != Edge::Sharp);
                let corner = Corner { normal, is_end, is_soft };
                rims[k].corners[0] = corner;
                rims[last].corners[1] = corner;
            }
        }
    }

    /// The part that leads to each part around its loop.
    fn before(&self, face: usize, parts: &[Part]) -> Vec<usize> {
        let first = |curve: usize| parts.partition_point(|part| part.curve < curve);
        let mut before = vec![0; parts.len()];
        for (k, part) in parts.iter().enumerate() {
            let next = if part.range[1] < 1.0 { k + 1 } else { first(self.borders[face].next[part.curve]) };
            before[next] = k;
        }
        before
    }

    /// The corners of a face; poles have none.
    fn wedges(&self, face: usize, own: &Parts) -> Vec<Wedge> {
        let border = &self.borders[face];
        let wedge = |k: usize| {
            let (before, after) = (&own.parts[own.before[k]], &own.parts[k]);
            if border.collapsed[after.curve] || border.collapsed[before.curve] {
                return None;
            }
            let inner = |[a, b]: [f64; 2], s: f64| a + (b - a) * s;
            let arrives = border.side(before.curve, inner(before.range, 1.0 - 1e-6))?;
            let leaves = border.side(after.curve, inner(after.range, 1e-6))?;
            let back = -arrives.tangent;
            let turn = leaves.inward.dot(&back).atan2(leaves.tangent.dot(&back));
            let angle = if turn < 1e-6 { turn + TAU } else { turn };
            let is_end = [own.before[k], k].iter().any(|k| own.rims[*k].edge == Edge::Boundary);
            Some(Wedge::new(leaves.point.into(), (self.outward(face, &leaves) * angle, is_end)))
        };
        (0..own.parts.len()).filter_map(wedge).collect()
    }
}
