//! Newton's method: solves F(x) = 0 by x <- x - step with J(x) step = F(x), through PETSc's SNES.
//!
//! The caller's [`Problem`] computes F and J, says when to stop, and may shorten steps. Its methods are called on all
//! ranks together. After each the ranks agree: an error or a panic on one comes out of [`Snes::solve`] as the same error
//! on all. The methods may communicate, as long as a rank that fails does so where no other waits for it: after the
//! communication of the method, or with an agreement of its own ([`Petsc::agree`]).
//!
//! The defaults are full steps and a checked direct solution ([`LinearSolver`], as the PC of a KSP `preonly`). PETSc's
//! options change them: `-snes_linesearch_type bt`, `-snes_monitor`, `-ksp_type cg -pc_type gamg`.

use std::ffi::c_void;
use std::fmt;
use std::ptr::{null, null_mut};

use crate::agree::agree_on_call;
use crate::error::{Error, check, forget, owned};
use crate::linear::{
    Factorization, Factors, LinearError, LinearFailure, LinearSolver, LinearStatistics, Negative, RESIDUAL_TOLERANCE,
};
use crate::matrix::Matrix;
use crate::multigrid::{Node, Unknowns};
use crate::runtime::Petsc;
use crate::sys;
use crate::vector::{Array, ArrayMut, Vector, norm2};

/// A nonlinear system F(x) = 0, distributed by rows. Slices are the part of this rank.
pub trait Problem {
    /// Computes r = F(x).
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<Evaluation, String>;

    /// Computes J(x), and lends its rows for the copy into the matrix.
    fn jacobian(&mut self, x: &[f64]) -> Result<Jacobian<'_>, String>;

    /// Judges the start and each new iterate. Where ranks differ, one that wants to go on outweighs one that has
    /// converged, and one that has diverged outweighs both.
    fn converged(&mut self, iterate: &Iterate<'_>) -> Result<Verdict, String>;

    /// May change the Newton step before x <- x - step. Returns whether it has.
    fn limit_step(&mut self, _x: &[f64], _step: &mut [f64]) -> Result<bool, String> {
        Ok(false)
    }
}

/// How an evaluation of F went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// The residual is there.
    Done,
    /// F is not defined at x, as with an inverted element. One rank's word suffices, and r is of no use.
    OutOfDomain,
}

/// The rows of J on this rank.
#[derive(Clone, Copy, Debug)]
pub enum Jacobian<'a> {
    /// New values in the standing pattern, as for [`Matrix::update`].
    Values(&'a [f64]),
    /// A new pattern with values, as for [`Matrix::rebuild`]: on all ranks at once.
    Pattern { row_offsets: &'a [i32], columns: &'a [i32], values: &'a [f64] },
}

/// An iterate to judge.
#[derive(Clone, Copy, Debug)]
pub struct Iterate<'a> {
    /// Its number; 0 is the start.
    pub iteration: usize,
    /// The part of x on this rank.
    pub x: &'a [f64],
    /// The part of F(x) on this rank.
    pub residual: &'a [f64],
    /// The Euclidean norm of F(x) on all ranks.
    pub residual_norm: f64,
    /// The Euclidean norm of the last step on all ranks; 0 at the start.
    pub step_norm: f64,
}

/// What to do after an iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is the solution.
    Converged,
    /// Go on.
    Iterate,
    /// Give up.
    Diverged,
}

/// Why an iteration ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// [`Problem::converged`] said so.
    Converged,
    /// [`Problem::converged`] said so.
    Diverged,
    /// F is not defined at the last iterate tried.
    OutOfDomain,
    /// F has an infinity or a NaN at the last iterate tried.
    NotFinite,
    /// A linear system could not be solved.
    Linear(LinearFailure),
    /// A line search, chosen by options, found no better iterate.
    LineSearch,
    /// Too many iterations; only with `-snes_max_it`.
    IterationLimit,
    /// Another reason of PETSc's, in its words.
    Other(String),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::Diverged => "diverged",
            Self::OutOfDomain => "the residual is not defined at the last iterate",
            Self::NotFinite => "the residual is not finite at the last iterate",
            Self::Linear(failure) => return failure.fmt(f),
            Self::LineSearch => "the line search found no better iterate",
            Self::IterationLimit => "too many iterations",
            Self::Other(text) => text,
        })
    }
}

/// The end of an iteration; the same on all ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Why it ended. Unless it converged, x is the last iterate or one that was tried.
    pub reason: Reason,
    /// Steps taken.
    pub iterations: usize,
    /// The Euclidean norm of the residual last accepted.
    pub residual_norm: f64,
}

/// Newton's method on one matrix.
pub struct Snes<'p> {
    petsc: &'p Petsc<'p>,
    raw: sys::SNES,
    /// PETSc computes residuals in it.
    residual: Vector<'p>,
    matrix: Matrix<'p>,
    linear: LinearSolver<'p>,
    /// Factors matrices that are not solved with, in this way.
    judge: Option<(Factorization, LinearSolver<'p>)>,
}

impl<'p> Snes<'p> {
    /// Newton's method with J stored in `matrix`, factored so. PETSc's options apply. Collective.
    pub fn new(petsc: &'p Petsc<'p>, matrix: Matrix<'p>, factorization: Factorization) -> Result<Self, Error> {
        let residual = Vector::zeros(petsc, matrix.local_rows())?;
        let raw = create(petsc)?;
        let linear = LinearSolver::new(petsc, factorization);
        let snes = Self { petsc, raw, residual, matrix, linear, judge: None };
        snes.configure()?;
        Ok(snes)
    }

    /// Goes on with a system of other unknowns, J of which is stored in `matrix`, in place of the last one. What was
    /// learnt of how such systems are best solved stays, and so do the statistics. Collective.
    pub fn renew(&mut self, matrix: Matrix<'p>, unknowns: impl FnOnce() -> Unknowns) -> Result<(), Error> {
        self.linear.renew(unknowns)?;
        self.judge = None;
        self.residual = Vector::zeros(self.petsc, matrix.local_rows())?;
        let mut old = std::mem::replace(&mut self.raw, create(self.petsc)?);
        // SAFETY: a live solver that nobody else holds.
        check(unsafe { sys::SNESDestroy(&mut old) })?;
        self.matrix = matrix;
        self.configure()
    }

    fn configure(&self) -> Result<(), Error> {
        self.set_callbacks()?;
        self.set_defaults()?;
        // SAFETY: a live solver.
        check(unsafe { sys::SNESSetFromOptions(self.raw) })
    }

    fn set_callbacks(&self) -> Result<(), Error> {
        let (raw, matrix, none) = (self.raw, self.matrix.raw(), null_mut());
        let (line_search, (_, pc)) = (self.line_search()?, self.linear_solver()?);
        // SAFETY: live objects, which SNES keeps references to; callbacks of the types it asks for, which find their
        // data in the application context and do not unwind.
        unsafe {
            check(sys::SNESSetFunction(raw, self.residual.raw(), Some(residual), none))?;
            check(sys::SNESSetJacobian(raw, matrix, matrix, Some(jacobian), none))?;
            check(sys::SNESSetConvergenceTest(raw, Some(converged), none, None))?;
            check(sys::SNESLineSearchSetPreCheck(line_search, Some(before_step), none))?;
            check(sys::PCSetType(pc, c"shell".as_ptr()))?;
            check(sys::PCShellSetApply(pc, Some(solve_linear)))?;
            check(sys::PCShellSetName(pc, c"checked MUMPS".as_ptr()))
        }
    }

    fn set_defaults(&self) -> Result<(), Error> {
        // The problem alone judges.
        const NEVER: f64 = 0.0;
        const UNLIMITED: i32 = -1;
        const MAX_ITERATIONS: i32 = 10_000;
        let (line_search, (ksp, _)) = (self.line_search()?, self.linear_solver()?);
        // SAFETY: live objects, names that PETSc copies.
        unsafe {
            check(sys::SNESSetType(self.raw, c"newtonls".as_ptr()))?;
            check(sys::SNESLineSearchSetType(line_search, c"basic".as_ptr()))?;
            check(sys::SNESSetTolerances(self.raw, NEVER, NEVER, NEVER, MAX_ITERATIONS, UNLIMITED))?;
            check(sys::KSPSetType(ksp, c"preonly".as_ptr()))
        }
    }

    /// The matrix of the last J.
    pub fn matrix(&self) -> &Matrix<'p> {
        &self.matrix
    }

    /// What the linear solver has done so far.
    pub fn linear_statistics(&self) -> LinearStatistics {
        self.linear.statistics()
    }

    /// As [`LinearSolver::factors`].
    pub fn factors(&self) -> Result<Option<Factors>, Error> {
        self.linear.factors()
    }

    /// As [`LinearSolver::reuse_factors`]. Collective.
    pub fn reuse_factors(&mut self, least_worth: usize) -> Result<(), Error> {
        self.linear.reuse_factors(least_worth)
    }

    /// Begins with something new: what the pivots of the last J have told is of no more use.
    pub fn forget_pivots(&mut self) {
        self.linear.forget_pivots();
    }

    /// As [`LinearSolver::accept`].
    pub fn accept(&mut self, residual: f64) {
        self.linear.accept(residual);
    }

    /// As [`LinearSolver::keep_in`].
    pub fn keep_in(&mut self, folder: &str) {
        self.linear.keep_in(folder);
    }

    /// As [`LinearSolver::iterate`]. Collective.
    pub fn iterate(&mut self, unknowns: Unknowns, patience: usize) -> Result<(), Error> {
        self.linear.iterate(unknowns, patience)
    }

    /// As [`LinearSolver::impatience`].
    pub fn impatience(&self) -> Option<usize> {
        self.linear.impatience()
    }

    /// As [`LinearSolver::iterates`].
    pub fn iterates(&self) -> bool {
        self.linear.iterates()
    }

    /// As [`LinearSolver::place`].
    pub fn place(&mut self, nodes: impl FnOnce() -> Vec<Node>) {
        self.linear.place(nodes);
    }

    /// How many eigenvalues of a matrix in the pattern of J are negative, or of its symmetric part, which is factored to LDLᵀ.
    /// It takes the place of J until that is computed again. Where memory does not suffice for factors of both, those of J go.
    /// Collective.
    pub fn negative_eigenvalues(&mut self, values: &[f64], factorization: Factorization) -> Result<Negative, Error> {
        self.matrix.update(values)?;
        let part = match factorization {
            Factorization::Ldlt if !self.matrix.is_symmetric() => Some(self.matrix.symmetric_part()?),
            _ => None,
        };
        let matrix = part.as_ref().unwrap_or(&self.matrix);
        let kept = self.judge.take().filter(|(kind, _)| *kind == factorization);
        let (_, mut judge) = kept.unwrap_or_else(|| (factorization, LinearSolver::new(self.petsc, factorization)));
        if let Some(negative) = judge.negative_eigenvalues(matrix)? {
            self.judge = Some((factorization, judge));
            return Ok(negative);
        }
        // The next factors of J will want the memory again; those in files have little.
        let gives_way = !self.linear_statistics().out_of_core && self.linear.forget_factors();
        let negative = if gives_way { judge.negative_eigenvalues(matrix)? } else { None };
        Ok(negative.unwrap_or(Negative::Unknown))
    }

    /// As [`LinearSolver::null_part`], of the last J. Collective.
    pub fn null_part(&mut self, z: &Vector) -> Result<Option<Vector<'p>>, Error> {
        self.linear.null_part(&self.matrix, z)
    }

    /// Iterates from `x`, and leaves the last iterate there.
    ///
    /// Errors: those of the problem's methods and PETSc's; a solver that had one can be used again. Collective.
    pub fn solve(&mut self, x: &mut Vector, problem: &mut dyn Problem) -> Result<Outcome, Error> {
        self.matrix.require_layout(&[x])?;
        let (raw, (_, pc)) = (self.raw, self.linear_solver()?);
        let mut context = Context {
            petsc: self.petsc,
            problem,
            matrix: &mut self.matrix,
            linear: &mut self.linear,
            error: None,
            linear_failure: None,
            out_of_domain: false,
        };
        let pointer = (&raw mut context).cast();
        // SAFETY: live objects. The context outlives the solve, during which callbacks alone use it, one at a time;
        // the pointers to it are taken back after. An earlier failure of the PC is none of this solve.
        let result = unsafe {
            check(sys::SNESSetApplicationContext(raw, pointer))?;
            check(sys::PCShellSetContext(pc, pointer))?;
            check(sys::PCSetFailedReason(pc, sys::PC_NOERROR))?;
            let result = check(sys::SNESSolve(raw, null_mut(), x.raw()));
            check(sys::PCShellSetContext(pc, null_mut()))?;
            check(sys::SNESSetApplicationContext(raw, null_mut()))?;
            result
        };
        let Context { error, linear_failure, out_of_domain, .. } = context;
        if let Some(error) = error {
            return Err(error);
        }
        result?;
        self.outcome(linear_failure, out_of_domain)
    }

    fn outcome(&self, linear_failure: Option<LinearFailure>, out_of_domain: bool) -> Result<Outcome, Error> {
        let (mut code, mut iterations, mut residual_norm) = (0, 0, 0.0);
        let (mut text, mut krylov, (ksp, _)) = (null(), null(), self.linear_solver()?);
        // SAFETY: live objects and places for the answers; the texts are static.
        let (text, krylov) = unsafe {
            check(sys::SNESGetConvergedReason(self.raw, &mut code))?;
            check(sys::SNESGetIterationNumber(self.raw, &mut iterations))?;
            check(sys::SNESGetFunctionNorm(self.raw, &mut residual_norm))?;
            check(sys::SNESGetConvergedReasonString(self.raw, &mut text))?;
            check(sys::KSPGetConvergedReasonString(ksp, &mut krylov))?;
            (owned(text), owned(krylov))
        };
        let reason = match code {
            1.. => Reason::Converged,
            sys::SNES_DIVERGED_LINEAR_SOLVE => Reason::Linear(linear_failure.unwrap_or(LinearFailure::Krylov(krylov))),
            _ if out_of_domain => Reason::OutOfDomain,
            sys::SNES_DIVERGED_DTOL => Reason::Diverged,
            sys::SNES_DIVERGED_FNORM_NAN => Reason::NotFinite,
            sys::SNES_DIVERGED_LINE_SEARCH | sys::SNES_DIVERGED_LOCAL_MIN => Reason::LineSearch,
            sys::SNES_DIVERGED_MAX_IT => Reason::IterationLimit,
            _ => Reason::Other(text),
        };
        Ok(Outcome { reason, iterations: iterations as usize, residual_norm })
    }

    fn line_search(&self) -> Result<sys::SNESLineSearch, Error> {
        let mut line_search = null_mut();
        // SAFETY: a live solver and a place for the handle, which stays the solver's.
        check(unsafe { sys::SNESGetLineSearch(self.raw, &mut line_search) })?;
        Ok(line_search)
    }

    fn linear_solver(&self) -> Result<(sys::KSP, sys::PC), Error> {
        // SAFETY: a live solver.
        unsafe { linear_solver(self.raw) }
    }
}

/// Collective.
fn create(petsc: &Petsc) -> Result<sys::SNES, Error> {
    let mut raw = null_mut();
    // SAFETY: a live communicator and a place for the handle.
    check(unsafe { sys::SNESCreate(petsc.raw_comm(), &mut raw) })?;
    Ok(raw)
}

impl Drop for Snes<'_> {
    fn drop(&mut self) {
        // SAFETY: a live solver; the objects it refers to are dropped after it.
        unsafe { sys::SNESDestroy(&mut self.raw) };
    }
}

/// # Safety
/// `snes` is a live solver. The handles stay its own.
unsafe fn linear_solver(snes: sys::SNES) -> Result<(sys::KSP, sys::PC), Error> {
    let (mut ksp, mut pc) = (null_mut(), null_mut());
    // SAFETY: the caller vouches for the solver; the rest are places for handles.
    unsafe {
        check(sys::SNESGetKSP(snes, &mut ksp))?;
        check(sys::KSPGetPC(ksp, &mut pc))?;
    }
    Ok((ksp, pc))
}

/// What the callbacks share during a solve.
struct Context<'a, 'p> {
    petsc: &'a Petsc<'p>,
    problem: &'a mut dyn Problem,
    matrix: &'a mut Matrix<'p>,
    linear: &'a mut LinearSolver<'p>,
    /// What made a callback return an error code.
    error: Option<Error>,
    /// The last failure of a linear solve.
    linear_failure: Option<LinearFailure>,
    /// Whether the last evaluation of F was out of its domain.
    out_of_domain: bool,
}

impl Context<'_, '_> {
    /// Runs the body of a callback and makes its error, the same on all ranks, an error code for PETSc.
    fn run(&mut self, body: impl FnOnce(&mut Self) -> Result<(), Error>) -> sys::PetscErrorCode {
        let Err(error) = body(self) else { return 0 };
        forget();
        self.error = Some(error);
        sys::PETSC_ERR_USER as sys::PetscErrorCode
    }

    /// # Safety
    /// `snes` is the solver at work, `x` and `r` distinct live vectors of the matrix's layout.
    unsafe fn residual(&mut self, snes: sys::SNES, x: sys::Vec, r: sys::Vec) -> Result<(), Error> {
        let problem = &mut *self.problem;
        let level = agree_on_call(self.petsc.own(), || {
            // SAFETY: the caller vouches for the vectors, and PETSc does not touch them meanwhile.
            let (x, mut r) = unsafe { (Array::new(x)?, ArrayMut::new(r)?) };
            Ok(i32::from(problem.residual(&x, &mut r)? == Evaluation::OutOfDomain))
        })?;
        self.out_of_domain = level > 0;
        if self.out_of_domain {
            // Line searches look at either.
            // SAFETY: live objects.
            unsafe {
                check(sys::VecSet(r, f64::NAN))?;
                check(sys::SNESSetFunctionDomainError(snes))?;
            }
        }
        Ok(())
    }

    /// # Safety
    /// `x` is a live vector of the matrix's layout, `snes` the solver at work, `operator` its operator.
    unsafe fn jacobian(&mut self, snes: sys::SNES, x: sys::Vec, operator: sys::Mat) -> Result<(), Error> {
        let (problem, mut lent) = (&mut *self.problem, Jacobian::Values(&[]));
        let is_new_pattern = |rows: &Jacobian| matches!(rows, Jacobian::Pattern { .. });
        let level = agree_on_call(self.petsc.own(), || {
            // SAFETY: the caller vouches for the vector, and PETSc does not touch it meanwhile.
            let x = unsafe { Array::new(x)? };
            lent = problem.jacobian(&x)?;
            Ok(i32::from(is_new_pattern(&lent)))
        })?;
        // Only now, with rows from all ranks, do they enter PETSc's collectives.
        let alike = i32::from(is_new_pattern(&lent)) == level;
        self.petsc.require(alike, || "a new pattern must come from all ranks at once".to_string())?;
        match lent {
            Jacobian::Values(values) => self.matrix.update(values)?,
            Jacobian::Pattern { row_offsets, columns, values } => {
                self.matrix.rebuild(row_offsets, columns, values)?;
                // SAFETY: a live solver. A PC chosen by options might take the new pattern for the old.
                check(unsafe { sys::PCReset(linear_solver(snes)?.1) })?;
            }
        }
        if operator != self.matrix.raw() {
            // Matrix-free, by options.
            // SAFETY: a live matrix.
            unsafe {
                check(sys::MatAssemblyBegin(operator, sys::MAT_FINAL_ASSEMBLY))?;
                check(sys::MatAssemblyEnd(operator, sys::MAT_FINAL_ASSEMBLY))?;
            }
        }
        Ok(())
    }

    /// # Safety
    /// `snes` is the solver at work.
    unsafe fn converged(
        &mut self,
        snes: sys::SNES,
        iteration: usize,
        residual_norm: f64,
        step_norm: f64,
    ) -> Result<sys::SNESConvergedReason, Error> {
        let problem = &mut *self.problem;
        let level = agree_on_call(self.petsc.own(), || {
            let (mut x, mut r) = (null_mut(), null_mut());
            // SAFETY: a live solver and places for its vectors, which nobody writes to meanwhile.
            let (x, r) = unsafe {
                check(sys::SNESGetSolution(snes, &mut x))?;
                check(sys::SNESGetFunction(snes, &mut r, null_mut(), null_mut()))?;
                (Array::new(x)?, Array::new(r)?)
            };
            let iterate = Iterate { iteration, x: &x, residual: &r, residual_norm, step_norm };
            Ok(match problem.converged(&iterate)? {
                Verdict::Converged => 0,
                Verdict::Iterate => 1,
                Verdict::Diverged => 2,
            })
        })?;
        Ok(match level {
            0 => sys::SNES_CONVERGED_FNORM_ABS,
            1 => sys::SNES_CONVERGED_ITERATING,
            _ => sys::SNES_DIVERGED_DTOL,
        })
    }

    /// Checks the step and lets the problem limit it; returns whether it has changed.
    ///
    /// # Safety
    /// `snes` is the solver at work, `x` and `step` distinct live vectors of the matrix's layout.
    unsafe fn before_step(&mut self, snes: sys::SNES, x: sys::Vec, step: sys::Vec) -> Result<bool, Error> {
        // SAFETY: as for this function.
        if !unsafe { self.check_foreign_solver(snes, step) }? {
            // The line search still evaluates a residual before SNES looks at the reason: let it be one that exists.
            // SAFETY: live objects.
            unsafe {
                check(sys::VecSet(step, 0.0))?;
                check(sys::SNESSetConvergedReason(snes, sys::SNES_DIVERGED_LINEAR_SOLVE))?;
            }
            return Ok(true);
        }
        let problem = &mut *self.problem;
        let level = agree_on_call(self.petsc.own(), || {
            // SAFETY: the caller vouches for the vectors, and PETSc does not touch them meanwhile.
            let (x, mut step) = unsafe { (Array::new(x)?, ArrayMut::new(step)?) };
            Ok(i32::from(problem.limit_step(&x, &mut step)?))
        })?;
        Ok(level > 0)
    }

    /// Checks the true residual of a linear solver that options have put in the place of ours: a direct one as we do
    /// ours, an iterative one against the tolerance that it was given, with room for its preconditioned norm.
    ///
    /// # Safety
    /// `snes` is the solver at work, `step` its solution of the linear system.
    unsafe fn check_foreign_solver(&mut self, snes: sys::SNES, step: sys::Vec) -> Result<bool, Error> {
        const ROOM: f64 = 100.0;
        let (mut direct, mut ours, mut tolerance) = (0, 0, 0.0);
        let (mut operator, mut b) = (null_mut(), null_mut());
        // SAFETY: a live solver, its parts, and places for the answers; NULL where no answer is wanted.
        unsafe {
            let (ksp, pc) = linear_solver(snes)?;
            check(sys::PetscObjectTypeCompare(ksp.cast(), c"preonly".as_ptr(), &mut direct))?;
            check(sys::PetscObjectTypeCompare(pc.cast(), c"shell".as_ptr(), &mut ours))?;
            check(sys::KSPGetTolerances(ksp, &mut tolerance, null_mut(), null_mut(), null_mut()))?;
            check(sys::KSPGetOperators(ksp, &mut operator, null_mut()))?;
            check(sys::SNESGetFunction(snes, &mut b, null_mut(), null_mut()))?;
        }
        if direct != 0 && ours != 0 {
            return Ok(true);
        }
        let limit = if direct != 0 { self.linear.accepts } else { RESIDUAL_TOLERANCE.max(ROOM * tolerance) };
        let r = Vector::zeros(self.petsc, self.matrix.local_rows())?;
        // SAFETY: live objects of one layout, the vectors distinct.
        let relative_residual = unsafe {
            check(sys::MatResidual(operator, b, step, r.raw()))?;
            norm2(r.raw())? / norm2(b)?.max(f64::MIN_POSITIVE)
        };
        let is_solved = relative_residual <= limit;
        self.linear.record(relative_residual, direct != 0 && is_solved);
        if is_solved {
            return Ok(true);
        }
        self.linear_failure = Some(LinearFailure::Inaccurate { relative_residual, null_pivots: 0 });
        Ok(false)
    }

    /// Solves J step = b with our own solver; returns whether it could.
    ///
    /// # Safety
    /// Distinct live vectors of the matrix's layout.
    unsafe fn solve_linear(&mut self, b: sys::Vec, step: sys::Vec) -> Result<bool, Error> {
        // SAFETY: the caller vouches for the vectors.
        match unsafe { self.linear.solve_raw(self.matrix, b, step) } {
            Ok(()) => Ok(true),
            Err(LinearError::Error(error)) => Err(error),
            Err(LinearError::Failure(failure)) => {
                self.linear_failure = Some(failure);
                Ok(false)
            }
        }
    }
}

/// The context of the solve under way.
///
/// # Safety
/// Called by a callback of `snes`, at most once and after no other.
unsafe fn context<'a>(snes: sys::SNES) -> Option<&'a mut Context<'a, 'a>> {
    let mut pointer: *mut Context = null_mut();
    // SAFETY: a live solver and a place for a pointer.
    unsafe { sys::SNESGetApplicationContext(snes, (&raw mut pointer).cast()) };
    // SAFETY: NULL, or set by `Snes::solve` for as long as callbacks run, which do not nest.
    unsafe { pointer.as_mut() }
}

/// The error code of a callback outside a solve.
const NO_CONTEXT: sys::PetscErrorCode = sys::PETSC_ERR_ORDER as sys::PetscErrorCode;

unsafe extern "C" fn residual(snes: sys::SNES, x: sys::Vec, r: sys::Vec, _: *mut c_void) -> sys::PetscErrorCode {
    // SAFETY: SNES calls this with its own objects.
    unsafe { context(snes).map_or(NO_CONTEXT, |context| context.run(|context| context.residual(snes, x, r))) }
}

unsafe extern "C" fn jacobian(
    snes: sys::SNES,
    x: sys::Vec,
    operator: sys::Mat,
    _: sys::Mat,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: SNES calls this with its own objects.
    unsafe { context(snes).map_or(NO_CONTEXT, |context| context.run(|context| context.jacobian(snes, x, operator))) }
}

unsafe extern "C" fn converged(
    snes: sys::SNES,
    iteration: sys::PetscInt,
    _x_norm: f64,
    step_norm: f64,
    residual_norm: f64,
    reason: *mut sys::SNESConvergedReason,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: SNES calls this with its own objects and a place for the reason.
    unsafe {
        context(snes).map_or(NO_CONTEXT, |context| {
            context.run(|context| {
                *reason = context.converged(snes, iteration as usize, residual_norm, step_norm)?;
                Ok(())
            })
        })
    }
}

unsafe extern "C" fn before_step(
    line_search: sys::SNESLineSearch,
    x: sys::Vec,
    step: sys::Vec,
    changed: *mut sys::PetscBool,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    let mut snes = null_mut();
    // SAFETY: the line search calls this with its own objects and a place for the answer.
    unsafe {
        sys::SNESLineSearchGetSNES(line_search, &mut snes);
        context(snes).map_or(NO_CONTEXT, |context| {
            context.run(|context| {
                *changed = context.before_step(snes, x, step)?.into();
                Ok(())
            })
        })
    }
}

unsafe extern "C" fn solve_linear(pc: sys::PC, b: sys::Vec, step: sys::Vec) -> sys::PetscErrorCode {
    let mut pointer: *mut Context = null_mut();
    // SAFETY: the KSP calls this with its own objects. The context is NULL, or set by `Snes::solve` for as long as
    // callbacks run, which do not nest.
    unsafe {
        sys::PCShellGetContext(pc, (&raw mut pointer).cast());
        pointer.as_mut().map_or(NO_CONTEXT, |context| {
            context.run(|context| {
                let solved = context.solve_linear(b, step)?;
                if !solved {
                    check(sys::VecSet(step, 0.0))?;
                }
                check(sys::PCSetFailedReason(pc, if solved { sys::PC_NOERROR } else { sys::PC_SUBPC_ERROR }))
            })
        })
    }
}
