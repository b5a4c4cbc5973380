//! A surface that points are projected onto: one of several kinds behind one type.

use crate::Vec3;
use crate::surface::{Analytic, FaceSet, PatchSet, Piece, PieceSet, Projection};

/// The whole of a surface, or what is near.
pub enum Shape {
    Patches(PatchSet),
    Faces(FaceSet),
    Analytic(Analytic),
}

impl Shape {
    /// Closest point to `x` within the distance `reach`; `warm` is the piece and parameters of the last projection. `None`
    /// beyond an end of the surface.
    pub fn closest(&self, x: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        match self {
            Self::Patches(patches) => patches.closest(x, reach, warm),
            Self::Faces(faces) => faces.closest(x, reach, warm),
            Self::Analytic(shape) => shape.closest(x, reach, warm.map(|(piece, _)| piece)),
        }
    }

    /// The point nearest to `x` within the distance `reach`, ends of the surface included: beside an end, an edge or a
    /// corner the normal points along the line between `x` and the point.
    pub fn nearest(&self, x: &Vec3, reach: f64) -> Option<Projection> {
        match self {
            Self::Patches(patches) => patches.nearest_within(x, reach),
            Self::Faces(faces) => faces.nearest_within(x, reach),
            Self::Analytic(shape) => shape.nearest(x).filter(|p| p.gap.abs() <= reach),
        }
    }

    /// The normal at the point next to `x`, ends of the surface included, and its distance. Where pieces meet at an angle
    /// the normal is that of the one that is the most along `like`, whichever its sign. `None` of nothing.
    pub fn side_normal(&self, x: &Vec3, like: &Vec3) -> Option<(Vec3, f64)> {
        match self {
            Self::Patches(patches) => side_normal(patches, x, like),
            Self::Faces(faces) => side_normal(faces, x, like),
            Self::Analytic(shape) => Some(shape.side_normal(x, like)),
        }
    }
}

/// Distances that differ by less, over the size of a piece, are equal.
const EQUAL: f64 = 1e-6;

fn side_normal<P: Piece>(set: &PieceSet<P>, x: &Vec3, like: &Vec3) -> Option<(Vec3, f64)> {
    let nearest = set.nearest(x)?;
    let distance = nearest.gap.abs();
    let home = set.get(nearest.patch)?;
    let (low, high) = home.bounds();
    let enough = distance + home.seam() + EQUAL * (high - low).norm();
    let around = Vec3::repeat(enough);
    let meets = |k: u32| {
        let piece = &set.pieces()[k as usize];
        let closest = piece.closest(x);
        (closest.distance <= enough).then(|| piece.normal(closest.xi))
    };
    let more = |a: Vec3, b: Vec3| if b.dot(like).abs() > a.dot(like).abs() { b } else { a };
    let normals = set.within(&(x - around), &(x + around)).into_iter().filter_map(meets);
    normals.reduce(more).map(|normal| (normal, distance))
}
