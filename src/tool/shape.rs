//! A surface that points are projected onto: one of several kinds behind one type.

use crate::Vec3;
use crate::controls::Controls;
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

    /// The closest point for a node that comes from `warm`: where patches meet at a slight angle it stays on the extension
    /// of its own for a while, or an iteration could go to and fro between them.
    pub fn contact(
        &self,
        x: &Vec3,
        reach: f64,
        warm: Option<(u32, [f64; 2])>,
        controls: &Controls,
    ) -> Option<Projection> {
        let found = self.closest(x, reach, warm)?;
        let stays = match self {
            Self::Patches(patches) => stays(patches, x, warm, &found, controls),
            Self::Faces(faces) => stays(faces, x, warm, &found, controls),
            Self::Analytic(_) => None,
        };
        Some(stays.unwrap_or(found))
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

    /// How far a node that stays on the extension of another piece may be behind `piece`, see [`Self::contact`]: the way
    /// beyond the edge times the sine of the greatest angle there, for pieces of a size.
    pub fn lingers(&self, piece: u32, controls: &Controls) -> f64 {
        let size = match self {
            Self::Patches(patches) => patches.get(piece).map(size),
            Self::Faces(faces) => faces.get(piece).map(size),
            Self::Analytic(_) => None,
        };
        let cosine = 1.0 - controls.kink_most;
        size.unwrap_or(0.0) * controls.kink_linger * (1.0 - cosine * cosine).sqrt()
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

/// The projection onto the extension of the piece that a node comes from, if `found` is across a slight kink. How much
/// the normals differ tells nothing of it but on the edge itself: beyond it a flat is not along an arc, however smooth
/// their joint.
fn stays<P: Piece>(
    set: &PieceSet<P>,
    x: &Vec3,
    warm: Option<(u32, [f64; 2])>,
    found: &Projection,
    controls: &Controls,
) -> Option<Projection> {
    let (id, _) = warm.filter(|(id, _)| *id != found.patch)?;
    let (own, other) = (set.get(id)?, set.get(found.patch)?);
    let edge = own.closest(x);
    let kink = own.normal(edge.xi).dot(&other.normal(other.closest(&edge.point).xi));
    let Controls { kink_most, kink_least, kink_linger, kink_same, .. } = *controls;
    if !(1.0 - kink_most..1.0 - kink_least).contains(&kink) {
        return None;
    }
    let (low, high) = own.bounds();
    let kept = set.stays(x, warm, found, (0.5 * (high - low).norm(), kink_same));
    kept.filter(|p| own.overshoot(p.xi) <= kink_linger)
}

/// Diagonal of the box of a piece.
fn size<P: Piece>(piece: &P) -> f64 {
    let (low, high) = piece.bounds();
    (high - low).norm()
}

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
    let more = |a: Vec3, b: Vec3| if b.dot(like).abs() > a.dot(like).abs() { b } else { a };
    let normals = set.within(&(x - around), &(x + around)).into_iter().filter_map(meets);
    normals.reduce(more).map(|normal| (normal, distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::normals::NormalOptions;
    use crate::surface::patches_from_mesh;
    use crate::surface::test_meshes::{grid, indenter};

    /// A point that goes over a slight kink between two patches and back changes sides late both times; where there is no
    /// kink, at the edge.
    #[test]
    fn a_node_keeps_to_its_side_of_a_kink_for_a_while() {
        let mesh = grid(4, 4, false, |s, t| [s, t, 0.05 * (4.0 * s + 1.0).sin() * (3.0 * t).cos()]);
        let patches = patches_from_mesh(&mesh, Smoothing::Nagata, &NormalOptions::default(), false).unwrap();
        let shape = Shape::Patches(PatchSet::new(patches));
        let [mut kinks, mut joints] = [0; 2];
        for y in (0..60).map(|k| 0.26 + 0.0036 * f64::from(k)) {
            let (mut warm, mut angle) = (None, 0.0f64);
            // Over the edge, which is at x = 0.5, and back.
            let way = || (0..=50).map(|k| 0.4901 + 0.0004 * f64::from(k));
            let [late, early] = [way().collect::<Vec<_>>(), way().rev().collect()].map(|way| {
                let mut changes = Vec::new();
                for x in way {
                    let x = Vec3::new(x, y, shape.closest(&Vec3::new(x, y, 0.0), 1.0, None).unwrap().point.z);
                    let [there, kept] =
                        [shape.closest(&x, 1.0, warm), shape.contact(&x, 1.0, warm, &Controls::default())]
                            .map(Option::unwrap);
                    angle = angle.max(kept.normal.angle(&there.normal));
                    assert!((kept.gap - there.gap).abs() <= 0.003 * angle);
                    if warm.is_some_and(|(patch, _)| patch != kept.patch) {
                        changes.push(x.x);
                    }
                    warm = Some((kept.patch, kept.xi));
                }
                changes
            });
            match (&late[..], &early[..]) {
                ([late], [early]) if angle > 2e-3 => {
                    kinks += 1;
                    // A hundredth of the size of a patch, 0.25, on both sides.
                    assert!(late - early > 0.004 && late - early < 0.006, "{y}: {late}, {early}");
                }
                ([late], [early]) => {
                    joints += 1;
                    assert!(angle > 0.0 || late - early < 0.001, "{y}: {late}, {early}");
                }
                changes => panic!("{y}: {changes:?}"),
            }
        }
        assert!(kinks > 20 && joints > 5, "{kinks} and {joints}");
    }

    /// Where a flat goes over into an arc without a kink, a node changes over at the edge.
    #[test]
    fn a_joint_of_a_flat_and_an_arc_is_no_kink() {
        let mesh = indenter(1, false);
        let patches = patches_from_mesh(&mesh, Smoothing::Nagata, &NormalOptions::default(), false).unwrap();
        let shape = Shape::Patches(PatchSet::new(patches));
        let mut warm = None;
        let way = || (-50..=50).map(|k| 10.0 + 0.0013 * f64::from(k));
        for x in way().chain(way().rev()) {
            let x = Vec3::new(x, -0.001, 0.5);
            let [there, kept] =
                [shape.closest(&x, 1.0, warm), shape.contact(&x, 1.0, warm, &Controls::default())].map(Option::unwrap);
            assert_eq!(kept, there);
            warm = Some((kept.patch, kept.xi));
        }
    }
}
