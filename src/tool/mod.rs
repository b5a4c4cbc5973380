//! Rigid tools as surfaces: from the scene to something that points can be projected onto.
//!
//! - [`shape`]: a surface of any kind that points are projected onto
//! - [`geometry`]: the whole of one description of a tool, on the rank that reads its files
//! - [`normals`]: nodal normals of a mesh from another description
//! - [`surface`]: the surface dealt out over the ranks, each of which sees what is near its points

pub mod geometry;
pub mod normals;
pub mod shape;
pub mod surface;

pub use geometry::{Described, Geometry, describe};
pub use shape::Shape;
pub use surface::Surface;
