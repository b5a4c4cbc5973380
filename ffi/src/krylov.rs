//! FGMRES, preconditioned by what this program itself applies.

use std::ffi::c_void;
use std::ptr::null_mut;

use crate::error::{check, forget};
use crate::linear::{LinearError, RESIDUAL_TOLERANCE};
use crate::matrix::Matrix;
use crate::runtime::{Petsc, c_string};
use crate::sys;
use crate::vector::Vector;

/// ||b - A x|| / ||b|| of a solution: so little that Newton's method goes the way that it goes with exact steps. Looser ones, as
/// its convergence allows, save a tenth of the time, and take up to a third more of its iterations.
const TOLERANCE: f64 = 1e-8;
/// The same of an iteration that leads nowhere.
const DIVERGED: f64 = 1e6;
/// Directions that FGMRES keeps, two vectors each.
const RESTART: i32 = 50;

/// Something near A⁻¹; it need not be the same each time.
pub(crate) trait Preconditioner {
    /// Computes z, about A⁻¹ r. Collective.
    ///
    /// # Safety
    /// Live vectors of A's layout, distinct.
    unsafe fn apply(&mut self, r: sys::Vec, z: sys::Vec) -> Result<(), LinearError>;
}

/// The end of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Iterated {
    /// ||b - A x|| / ||b||; `None` where it did not converge.
    pub solved: Option<f64>,
    pub iterations: usize,
}

/// FGMRES, with PETSc's options of prefix `linear_`.
pub(crate) struct Krylov<'p> {
    petsc: &'p Petsc<'p>,
    ksp: sys::KSP,
}

/// What the callback finds.
struct Context<'a> {
    preconditioner: &'a mut dyn Preconditioner,
    /// What went wrong in it.
    error: Option<LinearError>,
}

impl<'p> Krylov<'p> {
    /// Collective.
    pub(crate) fn new(petsc: &'p Petsc<'p>) -> Result<Self, crate::Error> {
        let (mut ksp, mut pc) = (null_mut(), null_mut());
        let prefix = c_string("linear_")?;
        // SAFETY: a live communicator, places for handles, C strings that PETSc copies; then live objects.
        unsafe {
            check(sys::KSPCreate(petsc.raw_comm(), &mut ksp))?;
            check(sys::KSPSetType(ksp, c"fgmres".as_ptr()))?;
            check(sys::KSPGMRESSetRestart(ksp, RESTART))?;
            check(sys::KSPGetPC(ksp, &mut pc))?;
            check(sys::PCSetType(pc, c"shell".as_ptr()))?;
            check(sys::PCShellSetApply(pc, Some(precondition)))?;
            check(sys::KSPSetOptionsPrefix(ksp, prefix.as_ptr()))?;
            check(sys::KSPSetFromOptions(ksp))?;
        }
        Ok(Self { petsc, ksp })
    }

    /// Tries to solve A x = b, from x = 0, in so many iterations at most. Collective.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, distinct; `b` comes with its norm.
    pub(crate) unsafe fn solve(
        &mut self,
        matrix: &Matrix,
        (b, norm): (sys::Vec, f64),
        x: sys::Vec,
        preconditioner: &mut dyn Preconditioner,
        most: usize,
    ) -> Result<Iterated, LinearError> {
        let mut context = Context { preconditioner, error: None };
        let (ksp, mut pc, mut reason, mut iterations) = (self.ksp, null_mut(), 0, 0);
        // SAFETY: live objects; the context lives through the solve, during which the callback alone uses it.
        let result = unsafe {
            check(sys::KSPSetTolerances(ksp, TOLERANCE, 0.0, DIVERGED, most as i32))?;
            check(sys::KSPSetOperators(ksp, matrix.raw(), matrix.raw()))?;
            check(sys::KSPGetPC(ksp, &mut pc))?;
            check(sys::PCShellSetContext(pc, (&raw mut context).cast()))?;
            let result = check(sys::KSPSolve(ksp, b, x));
            check(sys::PCShellSetContext(pc, null_mut()))?;
            check(sys::KSPGetConvergedReason(ksp, &mut reason))?;
            check(sys::KSPGetIterationNumber(ksp, &mut iterations))?;
            result
        };
        if let Some(error) = context.error {
            forget();
            return Err(error);
        }
        result?;
        let residual = Vector::zeros(self.petsc, matrix.local_rows())?;
        // SAFETY: live vectors of one layout, distinct.
        let relative_residual = unsafe { matrix.raw_residual(b, x, residual.raw())? } / norm;
        let is_solved = reason > 0 && relative_residual <= RESIDUAL_TOLERANCE;
        Ok(Iterated { solved: is_solved.then_some(relative_residual), iterations: iterations as usize })
    }
}

impl Drop for Krylov<'_> {
    fn drop(&mut self) {
        // SAFETY: a live solver.
        unsafe { sys::KSPDestroy(&mut self.ksp) };
    }
}

unsafe extern "C" fn precondition(pc: sys::PC, r: sys::Vec, z: sys::Vec) -> sys::PetscErrorCode {
    let mut pointer: *mut c_void = null_mut();
    // SAFETY: the KSP calls this with its own objects; the context is NULL, or set for as long as it solves.
    unsafe {
        sys::PCShellGetContext(pc, (&raw mut pointer).cast());
        let Some(context) = pointer.cast::<Context>().as_mut() else { return sys::PETSC_ERR_ORDER as _ };
        match context.preconditioner.apply(r, z) {
            Ok(()) => 0,
            Err(error) => {
                context.error = Some(error);
                sys::PETSC_ERR_USER as _
            }
        }
    }
}
