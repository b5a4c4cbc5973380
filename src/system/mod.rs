//! The algebraic system: which unknowns there are, where their entries stand, and how they are filled.
//!
//! - [`dofs`]: equation numbers of displacements, multipliers and free tool motions
//! - [`pattern`]: the compressed-row pattern and the place of every element's entries in it
//! - [`assembly`]: structural residual and tangent of this rank's rows

pub mod assembly;
pub mod dofs;
pub mod pattern;

pub use assembly::nodal_stiffness;
pub use dofs::DofMap;
pub use pattern::Pattern;
