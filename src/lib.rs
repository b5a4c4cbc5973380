//! nagata: implicit, parallel finite elements for large-sliding frictional contact on Nagata-smoothed surfaces.
//!
//! The way through the program; a module may use those listed before it, not those after.
//!
//! - [`error`]: the one error type; wrong input, no convergence, a failing library
//! - [`parallel`]: what ranks say to each other: agreement on errors, sums, exchanges
//! - [`scene`]: the scene file as plain structs, checked for form with file:line:column errors
//! - [`mesh`]: points, elements, groups; readers for Gmsh and Abaqus; structured blocks; checks
//! - [`partition`]: METIS, node ownership, the node halo
//! - [`surface`]: geometry without mechanics: facets, Nagata patches, analytic shapes, normals, closest points
//! - [`solid`]: elements and materials as pure functions on fixed-size arrays
//! - [`contact`]: tools, contact pairs, search, and the augmented-Lagrangian contact element
//! - [`output`]: HDF5/XDMF, history, summary, log, phases
//! - [`model`]: scene and meshes to what is modelled, and no more than the scene asks for
//! - [`system`]: equation numbers, sparsity pattern, assembly
//! - [`analysis`]: steps, increments, the nonlinear problem for SNES, commit and rollback
//! - [`cli`]: the commands

pub mod analysis;
pub mod cli;
pub mod contact;
pub mod error;
pub mod mesh;
pub mod model;
pub mod output;
pub mod parallel;
pub mod partition;
pub mod scene;
pub mod solid;
pub mod surface;
pub mod system;

/// A vector in space.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A second-order tensor.
pub type Mat3 = nalgebra::Matrix3<f64>;
