//! Geometry of surfaces, no mechanics.
//!
//! A surface mesh becomes a set of patches in three steps: [`facets`] gives it neighbours, [`normals`] gives every
//! corner of every facet a nodal normal, [`nagata`] turns the normals at the ends of an edge into the curvature of that
//! edge. A [`patch`] is a facet with curved edges; a flat facet is a patch whose edges are straight. [`projection`]
//! finds the closest point of one [`piece`] of a surface, [`piece_set`] that of a whole surface, and [`Way`] the side through
//! which a point behind it has come; [`from_mesh`] goes all the way from a mesh to its patches. [`moving`] has patches whose
//! nodes move, with their derivatives. [`analytic`] has the shapes with closed forms, [`nurbs`] the curves and surfaces of CAD,
//! [`face`] a surface cut to its loops, and [`faces`] sews those together and makes pieces of them.

pub mod analytic;
pub mod cell;
mod closest;
mod entrance;
pub mod face;
pub mod faces;
pub mod facets;
pub mod from_mesh;
pub mod moving;
pub mod nagata;
pub mod normals;
mod numbers;
pub mod nurbs;
pub mod parametric;
pub mod patch;
pub mod piece;
pub mod piece_set;
pub mod projection;
mod smoothing;
pub mod tessellation;

#[cfg(test)]
pub(crate) mod test_meshes;

pub use analytic::Analytic;
pub use entrance::{Sides, Way};
pub use face::Face;
pub use faces::{FaceSet, SewnFace, sew};
pub use from_mesh::{patches_from_mesh, smooth};
pub use moving::{MovingPatch, QuadraticFace};
pub use normals::{NormalOptions, Weight};
pub use nurbs::{Bezier, Curve, CurveLocal, KnotVector, Nurbs};
pub use parametric::{Closest, Local, Parametric};
pub use patch::Patch;
pub use piece::{EXTENSION, Edge, Piece, Polygon};
pub use piece_set::{Admission, Even, PatchSet, PieceSet, looks_aslant, shortest};
pub use projection::Projection;
pub use smoothing::{Smoothing, Transfer};
pub use tessellation::Tessellation;
