//! Geometry of surfaces, no mechanics.
//!
//! A surface mesh becomes a set of patches in three steps: [`facets`] gives it neighbours, [`normals`] gives every
//! corner of every facet a nodal normal, [`nagata`] turns the normals at the ends of an edge into the curvature of that
//! edge. A [`patch`] is a facet with curved edges; a flat facet is a patch whose edges are straight. [`projection`]
//! finds the closest point of one patch, [`patch_set`] that of a whole surface. [`analytic`] has the shapes with closed
//! forms and [`tool`] puts all of them behind one type.

pub mod analytic;
pub mod facets;
pub mod nagata;
pub mod normals;
pub mod patch;
pub mod patch_set;
pub mod projection;
pub mod tessellation;
pub mod tool;

#[cfg(test)]
mod test_meshes;

pub use patch::{Edge, Patch};
pub use patch_set::PatchSet;
pub use projection::Projection;
pub use tessellation::Tessellation;
pub use tool::{Shape, patches_from_mesh};
