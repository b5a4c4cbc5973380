//! The closest point of a surface made of pieces.
//!
//! Two questions are asked. [`PieceSet::nearest`] is plain geometry: the nearest of all points of all pieces, however
//! far away, and there always is one. [`PieceSet::closest`] is what contact asks. It starts from the nearest point, which
//! from outside a convex edge is a point of the edge, from inside the nearer facet, in a concave corner the nearer wall,
//! in a thin tool the nearer side. What it means depends on where it is:
//!
//! - inside a piece: gap and normal are those of the piece;
//! - on a smooth edge: both pieces are extended by [`EXTENSION`] and the one that needs less of it is taken. Beyond
//!   that, far from the surface, the edge counts as sharp;
//! - on a sharp edge or corner: the normal points from the edge to x. Inside or outside is told by the sum of the
//!   normals of the pieces around, weighted by their angles (Baerentzen and Aanaes 2005, IEEE Trans. Vis. Comput.
//!   Graph. 11, 243-253);
//! - on the boundary of the surface: the piece is extended, and beyond that x has no projection on it; pieces further
//!   away may still have one. The edge of a piece whose neighbour comes closer to x has no projection either.
//!
//! The edges of a mesh are those of its patches. The edges of a CAD face are the curves it is trimmed with, and what
//! meets there is found by sewing ([`super::faces`]); its extension is that of the surface beyond the trim. Faces may
//! meet at a distance, and then the closest of them gives way, beyond its smooth edge, to one that needs less extension
//! and is no further away than that.
//!
//! Nothing depends on the order of the pieces: equal distances go to the least extension, then to the lower id. The
//! piece of the last projection is kept when it is as close within a millionth of its size.
//!
//! [`EXTENSION`]: super::piece::EXTENSION
//!
//! [`PieceSet::normal_projection`] has no policy: it knows feet of perpendiculars only, and so has dead zones.

mod search;
#[cfg(test)]
mod tests;

pub use search::settle;

use super::patch::Patch;
use super::piece::Piece;
use super::projection::{Extent, Projection};
use crate::Vec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use search::{Question, Search};

type Leaf = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// Pieces with a search tree over their boxes.
pub struct PieceSet<P> {
    /// By rising id.
    pieces: Vec<P>,
    extents: Vec<Extent>,
    tree: RTree<Leaf>,
    largest: f64,
    /// Greatest distance between neighbours where they meet.
    seam: f64,
}

/// The surface of a mesh.
pub type PatchSet = PieceSet<Patch>;

impl PatchSet {
    /// A set of patches with different ids.
    pub fn new(patches: Vec<Patch>) -> Self {
        Self::of_pieces(patches)
    }

    /// The patches, by rising id.
    pub fn patches(&self) -> &[Patch] {
        &self.pieces
    }
}

impl<P: Piece> PieceSet<P> {
    /// A set of pieces with different ids.
    pub fn of_pieces(mut pieces: Vec<P>) -> Self {
        pieces.sort_by_key(Piece::id);
        let extents: Vec<Extent> = pieces.iter().map(Extent::new).collect();
        let leaf = |(k, piece): (usize, &P)| {
            let (low, high) = piece.bounds();
            Leaf::new(Rectangle::from_corners(low.into(), high.into()), k as u32)
        };
        let tree = RTree::bulk_load(pieces.iter().enumerate().map(leaf).collect());
        let largest = extents.iter().map(|e| e.radius).fold(0.0, f64::max);
        let seam = pieces.iter().map(Piece::seam).fold(0.0, f64::max);
        Self { pieces, extents, tree, largest, seam }
    }

    /// The pieces, by rising id.
    pub fn pieces(&self) -> &[P] {
        &self.pieces
    }

    /// The piece with this id.
    pub fn get(&self, id: u32) -> Option<&P> {
        self.index(id).map(|k| &self.pieces[k])
    }

    /// Indices into [`Self::pieces`], rising, of the patches whose boxes meet a box.
    pub fn within(&self, low: &Vec3, high: &Vec3) -> Vec<u32> {
        let mut found: Vec<u32> = self.boxes(low, high).map(|leaf| leaf.data).collect();
        found.sort_unstable();
        found
    }

    /// The point of all pieces nearest to `x`; `None` for an empty set, or when `x` is not finite.
    ///
    /// The normal is that of the surface; where `x` is beside an end, an edge or a corner it points along the line
    /// between `x` and the point.
    pub fn nearest(&self, x: &Vec3) -> Option<Projection> {
        self.nearest_within(x, f64::INFINITY)
    }

    /// The same when it is not further away than `reach`.
    pub fn nearest_within(&self, x: &Vec3, reach: f64) -> Option<Projection> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let mut search = Search::new(self, x, reach, None, Question::Nearest);
        search.run(None);
        search.answer()
    }

    /// The point of contact for `x` within the distance `reach`; `warm` is the piece and parameters of the last
    /// projection.
    ///
    /// Depends on the pieces within reach only. `None` when there are none, or when `x` lies beyond an end of the
    /// surface.
    pub fn closest(&self, x: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let kept = warm.and_then(|(id, _)| self.index(id));
        let start = warm.map(|(_, xi)| xi);
        let mut search = Search::new(self, x, reach, kept, Question::Contact);
        search.run(start);
        if search.is_doubtful() {
            search = Search::new(self, x, reach, kept, Question::WaryContact);
            search.run(start);
        }
        search.answer()
    }

    /// The normal projection alone: piece, parameters and gap of the foot of a perpendicular with the least |gap| up to
    /// `reach`, among the minima of the distance inside the pieces, which reach over their edges by `extension` of
    /// their parameters. `None` in a dead zone.
    pub fn normal_projection(&self, x: &Vec3, extension: f64, reach: f64) -> Option<(u32, [f64; 2], f64)> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        // The boxes of the pieces need not hold their extensions.
        let margin = 4.0 * extension * self.largest;
        let (mut best, mut least) = (None, reach);
        for (leaf, distance_2) in self.tree.nearest_neighbor_iter_with_distance_2((*x).into()) {
            if distance_2 > (least + margin).powi(2) {
                break;
            }
            let k = leaf.data as usize;
            let Some((xi, gap)) = self.pieces[k].perpendicular(&self.extents[k], x, extension) else { continue };
            let id = self.pieces[k].id();
            if gap.abs() < least || gap.abs() == least && best.is_none_or(|(other, _, _)| id < other) {
                (best, least) = (Some((id, xi, gap)), gap.abs());
            }
        }
        best
    }

    fn index(&self, id: u32) -> Option<usize> {
        self.pieces.binary_search_by_key(&id, Piece::id).ok()
    }

    fn boxes(&self, low: &Vec3, high: &Vec3) -> impl Iterator<Item = &Leaf> + use<'_, P> {
        self.tree.locate_in_envelope_intersecting(AABB::from_corners((*low).into(), (*high).into()))
    }
}
