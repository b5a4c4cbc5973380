//! Thin safe types over Debian's PETSc: what an implicit finite-element program needs of it, and no more.
//!
//! [`Petsc`] starts and ends the library; [`Vector`] and [`Matrix`] are distributed by rows, each rank giving its own;
//! [`LinearSolver`] factors with MUMPS, or iterates with old factors or multigrid; [`Snes`] is Newton's method over a [`Problem`] of the caller's.
//!
//! Three rules hold throughout.
//! - Objects borrow [`Petsc`], and that borrows the communicator: the order of destruction is the compiler's concern.
//! - Functions marked *collective* must be called on all ranks of the communicator, in the same order. Their errors are
//!   the same on all ranks; that includes errors and panics of callbacks, wherever they happened.
//! - Nothing aborts: PETSc's errors come back as [`Error`] with PETSc's own words, a singular matrix as
//!   [`LinearFailure`], an iteration that goes nowhere as [`Outcome`].

mod agree;
pub mod environment;
mod error;
mod krylov;
mod linear;
mod matrix;
mod memory;
mod multigrid;
mod runtime;
mod snes;
mod sys;
mod vector;

pub use error::Error;
pub use linear::{
    Factorization, Factors, LinearError, LinearFailure, LinearSolver, LinearStatistics, Negative, RESIDUAL_TOLERANCE,
};
pub use matrix::Matrix;
pub use memory::{address_space_left, enough_to_start};
pub use multigrid::{Multipliers, Node, Unknowns};
pub use runtime::Petsc;
pub use snes::{Evaluation, Iterate, Jacobian, Outcome, Problem, Reason, Snes, Verdict};
pub use vector::{Array, ArrayMut, Vector};
