//! Faces of CAD models, made ready for projection.
//!
//! [`sew`] finds out, once and on one rank, what lies beyond the borders of the faces; the [`SewnFace`]s that it gives are
//! plain numbers, and any selection of them makes a [`FaceSet`]. There every surface is cut into cells, Bézier patches that
//! curve little, and those that the loops cross carry the stretches of rim in them. A set is searched like the patches of
//! a mesh: see [`super::piece_set`] for the questions and what their answers mean.

mod border;
mod curves;
mod orient;
mod piece;
mod rims;
mod sew;
mod sewn;
mod stretch;
#[cfg(test)]
mod tests;
mod trim;

pub use piece::FacePiece;
pub use sew::{sew, usual_tolerance};
pub use sewn::{Corner, Rim, SewnFace};

use super::piece_set::PieceSet;

/// The surface of a CAD model, or the part of it that some faces make.
pub type FaceSet = PieceSet<FacePiece>;

impl FaceSet {
    /// A set of faces of one model.
    pub fn new(faces: &[SewnFace]) -> Self {
        Self::of_pieces(faces.iter().flat_map(FacePiece::of_face).collect())
    }

    /// Number of the face that a piece belongs to, and the parameters of its surface at parameters of the piece.
    pub fn face(&self, piece: u32, xi: [f64; 2]) -> Option<(u32, [f64; 2])> {
        self.get(piece).map(|piece| (piece.face(), piece.parameters(xi)))
    }
}
