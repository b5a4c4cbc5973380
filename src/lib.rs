//! nagata: implicit, parallel finite elements for large-sliding frictional contact on Nagata-smoothed surfaces.
//!
//! The way through the program; a module may use those listed before it, not those after. Only the kinds that [`scene`] names
//! (smoothing, formulations, material models, methods) are at home further down, in leaves that use nothing.
//!
//! - [`failure`]: why an increment has no solution
//! - [`mod@words`]: structs as numbers, for checkpoints
//! - [`error`]: the one error type; wrong input, no convergence, a failing library
//! - [`encoding`]: marks before texts, and encodings that are not read
//! - [`interrupt`]: signals as the wish that a run end
//! - [`parallel`]: what ranks say to each other: agreement on errors, sums, exchanges
//! - [`stdout`]: what commands print, which is written or an error
//! - [`controls`]: the numbers that decide whether a solution is found, with their reasons
//! - [`scene`]: the scene file as plain structs, checked for form with file:line:column errors
//! - [`mesh`]: points, elements, groups; readers for Gmsh, Abaqus and STL; elements of second order split, collapsed
//!   ones taken for what they are; blocks; checks
//! - [`partition`]: METIS, node ownership, the node halo
//! - [`surface`]: geometry without mechanics: facets, normals, Nagata patches, analytic shapes, closest points
//! - [`cad`]: surfaces of tools from CAD files: IGES, Bézier patches
//! - [`mortar`]: integration over the overlap of two surfaces of faces, and the interpolation that it makes
//! - [`refine`]: meshes split by midpoints, curved boundaries kept
//! - [`tool`]: the surfaces of rigid tools, dealt out over the ranks
//! - [`solid`]: elements and materials as pure functions on fixed-size arrays; what plastic points remember
//! - [`contact`]: masters (placed tools, surfaces of bodies), contact pairs, the laws of contact, and the contact element
//! - [`output`]: fields for ParaView and VTK, tables of history and probes, checkpoints, summary, log, phases, figures
//! - [`report`]: one page of what runs have left in their folders
//! - [`accuracy`]: how well a surface is described: errors, dead zones, projections of points
//! - [`model`]: scene and meshes to what is modelled, and no more than the scene asks for
//! - [`estimate`]: how far a converged state may be from the solution, without a reference
//! - [`system`]: equation numbers, sparsity pattern, assembly
//! - [`analysis`]: what is checked before a run, steps, increments, the nonlinear problem for SNES, commit and rollback
//! - [`convert`]: decks of Abaqus and CalculiX to scenes
//! - [`trade`]: runs of a scene in many settings, errors against costs
//! - [`cli`]: the commands

pub mod accuracy;
pub mod analysis;
pub mod cad;
pub mod cli;
pub mod contact;
pub mod controls;
pub mod convert;
pub mod encoding;
pub mod error;
pub mod estimate;
pub mod failure;
pub mod interrupt;
pub mod mesh;
pub mod model;
pub mod mortar;
pub mod output;
pub mod parallel;
pub mod partition;
pub mod refine;
pub mod report;
pub mod scene;
pub mod solid;
pub mod stdout;
pub mod surface;
pub mod system;
pub mod tool;
pub mod trade;
pub mod words;

/// The coordinate axes in words.
const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// A vector in a plane.
pub type Vec2 = nalgebra::Vector2<f64>;
/// A second-order tensor in a plane.
pub type Mat2 = nalgebra::Matrix2<f64>;
/// A vector in space.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A second-order tensor.
pub type Mat3 = nalgebra::Matrix3<f64>;
