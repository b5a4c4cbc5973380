//! The algebraic system: which unknowns there are, where their entries stand, and how they are filled.
//!
//! - [`axes`]: nodes whose displacements are counted along other directions than the coordinate axes
//! - [`dofs`]: equation numbers of displacements, multipliers and free tool motions
//! - [`pattern`]: the compressed-row pattern and the place of every element's entries in it
//! - [`candidates`]: the patches of deformable masters that the pattern provides for
//! - [`foreign`]: entries that contact elements have in rows of other ranks
//! - [`masters`]: equations and prescribed motions of the nodes of masters
//! - [`assembly`]: structural residual and tangent of this rank's rows

pub mod assembly;
pub mod axes;
pub mod candidates;
pub mod dofs;
pub mod foreign;
pub mod masters;
pub mod near;
pub mod pattern;

pub use axes::Axes;
pub use dofs::DofMap;
pub use masters::MasterNodes;
pub use pattern::Pattern;
