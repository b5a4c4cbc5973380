//! A surface that points are projected onto: one of several kinds behind one type.

use crate::Vec3;
use crate::controls::Controls;
use crate::surface::analytic::Profile;
use crate::surface::normals::more_along;
use crate::surface::{Analytic, Even, FaceSet, PatchSet, Piece, PieceSet, Projection};

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

    /// The closest point for a node that keeps to the piece `warm` that it comes from: where pieces meet at an angle it stays on
    /// its own for a while, see [`PieceSet::stays`].
    pub fn contact(
        &self,
        x: &Vec3,
        reach: f64,
        warm: Option<(u32, [f64; 2])>,
        controls: &Controls,
    ) -> Option<Projection> {
        let found = self.closest(x, reach, warm)?;
        let stays = match self {
            Self::Patches(patches) => patches.stays(x, warm, &found, (false, controls)),
            Self::Faces(faces) => faces.stays(x, warm, &found, (false, controls)),
            Self::Analytic(_) => None,
        };
        Some(stays.unwrap_or(found))
    }

    /// Where `x` is exactly between pieces: see [`PieceSet::evenly`] and [`Analytic::evenly`].
    pub fn evenly(&self, x: &Vec3, at: &Projection, even: &Even) -> Vec<(Projection, f64)> {
        match self {
            Self::Patches(patches) => patches.evenly(x, at, even),
            Self::Faces(faces) => faces.evenly(x, at, even),
            Self::Analytic(shape) => shape.evenly(x, at, even),
        }
    }

    /// The points of `x` on given pieces that make a hollow: see [`PieceSet::hollow`]. None of shapes without pieces.
    pub fn hollow(&self, x: &Vec3, ids: &[u32], turn: f64) -> Vec<Projection> {
        match self {
            Self::Patches(patches) => patches.hollow(x, ids, turn),
            Self::Faces(faces) => faces.hollow(x, ids, turn),
            Self::Analytic(_) => Vec::new(),
        }
    }

    /// Whether the point of contact `at` of `x` is past an end by more than `aside`, where a piece is extended; shapes without
    /// pieces are not.
    pub fn is_past_end(&self, x: &Vec3, at: &Projection, aside: f64) -> bool {
        match self {
            Self::Patches(patches) => patches.is_past_end(x, at, aside),
            Self::Faces(faces) => faces.is_past_end(x, at, aside),
            Self::Analytic(_) => false,
        }
    }

    /// Perpendiculars from `x` to all its pieces, no longer than `most`; they may miss a piece by a distance of `aside`. None
    /// of shapes without edges.
    pub fn perpendiculars(&self, x: &Vec3, most: f64, aside: f64) -> Vec<Projection> {
        match self {
            Self::Patches(patches) => patches.perpendiculars(x, most, aside),
            Self::Faces(faces) => faces.perpendiculars(x, most, aside),
            Self::Analytic(Analytic::Profile(profile)) => profile.perpendiculars(x, most, aside),
            Self::Analytic(_) => Vec::new(),
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

    /// Between which z a profile that is drawn out along z lies, if it ends.
    pub fn ends_along_z(&self) -> Option<[f64; 2]> {
        match self {
            Self::Analytic(Analytic::Profile(Profile { sweep, .. })) => sweep.ends().map(|ends| {
                let [from, to] = ends.map(|end| end.z);
                [from.min(to), from.max(to)]
            }),
            _ => None,
        }
    }

    /// How far a node that keeps to another piece may be behind `piece`, see [`Self::contact`].
    pub fn kink(&self, piece: u32, controls: &Controls) -> f64 {
        match self {
            Self::Patches(patches) => patches.kink(piece, (false, controls)),
            Self::Faces(faces) => faces.kink(piece, (false, controls)),
            Self::Analytic(_) => 0.0,
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

/// [`Shape::side_normal`] of pieces.
pub fn side_normal<P: Piece>(set: &PieceSet<P>, x: &Vec3, like: &Vec3) -> Option<(Vec3, f64)> {
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
    let normals = set.within(&(x - around), &(x + around)).into_iter().filter_map(meets);
    normals.reduce(|a, b| more_along(like, a, b)).map(|normal| (normal, distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::normals::NormalOptions;
    use crate::surface::patches_from_mesh;
    use crate::surface::test_meshes::grid;

    /// A point that goes over a kink between two patches and back changes sides late both times if it keeps to its side: when
    /// the gaps differ by the share of a patch. Where there is no kink, at the end of the extension.
    #[test]
    fn a_node_keeps_to_its_side_of_a_kink_for_a_while() {
        let mesh = grid(4, 4, false, |s, t| [s, t, 0.3 * (4.0 * s + 1.0).sin() * (3.0 * t).cos()]);
        let controls = Controls { kink_gap: 3.5e-4, ..Controls::default() };
        for smoothing in [Smoothing::Nagata, Smoothing::Facet] {
            let patches = patches_from_mesh(&mesh, smoothing, &NormalOptions::default(), false).unwrap();
            let shape = Shape::Patches(PatchSet::new(patches));
            let (mut late, mut most) = (0, 0.0f64);
            for y in (0..60).map(|k| 0.26 + 0.0036 * f64::from(k)) {
                let mut warm = None;
                // Over the edge, which is at x = 0.5, and back.
                let way = || (0..=50).map(|k| 0.4901 + 0.0004 * f64::from(k));
                for x in way().chain(way().rev()) {
                    let x = Vec3::new(x, y, shape.closest(&Vec3::new(x, y, 0.0), 1.0, None).unwrap().point.z - 0.01);
                    let there = shape.closest(&x, 1.0, warm).unwrap();
                    let kept = shape.contact(&x, 1.0, warm, &controls).unwrap();
                    let apart = (kept.gap - there.gap).abs();
                    assert!(apart <= shape.kink(there.patch, &controls) * 1.01, "{y}: {apart:e}");
                    late += usize::from(kept.patch != there.patch);
                    most = most.max(apart);
                    warm = Some((kept.patch, kept.xi));
                }
            }
            let share = most / shape.kink(0, &controls);
            assert!(late > 50 && share > 0.3, "{smoothing:?}: {late} {share}");
        }
    }
}
