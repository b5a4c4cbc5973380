//! A piece of a CAD model: a surface and where it ends.

use super::nurbs::{Curve, Nurbs};

/// One face of a CAD model: a NURBS surface and the loops that bound the part of it that counts.
#[derive(Clone, Debug)]
pub struct Face {
    pub surface: Nurbs,
    /// Closed loops in the parameters of `surface`, each a chain of curves; a point belongs to the face where it is
    /// inside an odd number of loops (the orientation of the loops does not matter). None: the whole domain.
    pub loops: Vec<Vec<Curve<2>>>,
    /// The outward normal is -(P,1 x P,2).
    pub reversed: bool,
    /// What the file calls it, for messages: "trimmed surface (144) at D17".
    pub name: String,
}
