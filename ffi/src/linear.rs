//! Direct solution of A x = b with MUMPS, checked every time.
//!
//! The analysis (ordering, symbolic factorization) is kept while the pattern of the matrix stands, the factors while its
//! values do; if it is told to, it solves with those of an earlier matrix, too: they precondition FGMRES as long as that is cheaper
//! than new ones. Want of workspace is met by more of it. A solution counts only when its true residual ||b - A x|| / ||b||
//! is small, after iterative refinement if need be: MUMPS itself goes on past a null pivot. What it took for null may be
//! small and needed: where replacing it spoils the solution, the matrix is factored again with all pivots as they are.
//!
//! `ICNTL`, `CNTL` and `INFOG` are MUMPS's controls and answers; see its Users' guide. Every control can be given as a
//! PETSc option, `-mat_mumps_icntl_14 200`, which takes precedence over the values here.

use std::ffi::CStr;
use std::fmt;
use std::mem::MaybeUninit;
use std::ptr::null_mut;
use std::time::Instant;

use crate::error::{Error, check, forget};
use crate::krylov::{Iterated, Krylov, Preconditioner};
use crate::matrix::{Matrix, Version};
use crate::memory::left_for_each;
use crate::multigrid::{Multigrid, Node, Unknowns};
use crate::runtime::Petsc;
use crate::sys;
use crate::vector::{Vector, norm2};

/// The largest ||b - A x|| / ||b|| of a solution that is not refined, and that counts unless more is [accepted](LinearSolver::accept).
pub const RESIDUAL_TOLERANCE: f64 = 1e-6;
/// Steps of iterative refinement, after which a solution is as good as it gets.
const MAX_REFINEMENTS: usize = 2;
/// Systems in a row that the iterative solver may be tried on in vain.
const MOST_IN_VAIN: usize = 3;
/// Systems after which its iterations may be found too many.
const SYSTEMS_TO_JUDGE_BY: usize = 3;
/// Doublings of the workspace before a factorization is given up.
const MAX_RETRIES: usize = 5;

/// A factorization in applications of it: so many for scaling, sending and assembling entries, and one more for so many
/// operations per entry of the factors.
const OVERHEAD: f64 = 5.0;
const SPEED: f64 = 33.0;
/// Systems that are factored at most, where factors have not solved the next, before it is tried again.
const LONGEST_PAUSE: u32 = 15;

const ORDERING: i32 = 7;
const SCALING: i32 = 8;
const LDLT_ORDERING: i32 = 12;
const SCALAPACK_ROOT: i32 = 13;
/// Workspace beyond the estimate, in percent.
const WORKSPACE: i32 = 14;
/// Factors in files.
const OUT_OF_CORE: i32 = 22;
const NULL_PIVOTS: i32 = 24;
const ANALYSIS: i32 = 28;
const DETERMINANT: i32 = 33;

/// The kind of factorization.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factorization {
    /// For any matrix.
    Lu,
    /// For a symmetric, possibly indefinite matrix, of which only the upper triangle is used.
    Ldlt,
}

/// Why a linear system could not be solved. A smaller increment may help, unless memory is what it wants.
#[derive(Clone, Debug, PartialEq)]
pub enum LinearFailure {
    /// An infinity or a NaN in the `matrix` or the `right-hand side`.
    NotFinite(&'static str),
    /// MUMPS found the matrix singular: INFOG(1), INFOG(2).
    Singular(i32, i32),
    /// Memory did not suffice: INFOG(1); what could not be had, and MUMPS's estimate of what the rank that needs most
    /// takes in all, MB; 0 where it does not say. A smaller increment does not help.
    Memory { code: i32, missing: u64, estimate: u64 },
    /// MUMPS failed otherwise: INFOG(1), INFOG(2).
    Mumps(i32, i32),
    /// The true relative residual, and the null pivots that MUMPS replaced: with any, the system has no solution.
    Inaccurate { relative_residual: f64, null_pivots: usize },
    /// A solver chosen by PETSc options did not converge, for this reason.
    Krylov(String),
}

impl fmt::Display for LinearFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "linear solver: ")?;
        match self {
            Self::NotFinite(what) => write!(f, "the {what} is not finite"),
            Self::Singular(one, two) => write!(f, "the matrix is singular (MUMPS INFOG(1) = {one}, INFOG(2) = {two})"),
            Self::Memory { code, missing, estimate } => {
                write!(f, "not enough memory to factor the matrix (MUMPS INFOG(1) = {code})")?;
                if *missing > 0 {
                    write!(f, ": {missing} MB were asked for in vain")?;
                }
                if *estimate > 0 {
                    write!(f, "; the rank that needs most takes about {estimate} MB")?;
                }
                Ok(())
            }
            Self::Mumps(one, two) => {
                write!(f, "the factorization failed (MUMPS INFOG(1) = {one}, INFOG(2) = {two})")
            }
            Self::Inaccurate { relative_residual, null_pivots: 0 } => {
                write!(f, "the relative residual is {relative_residual:.1e}: the matrix is nearly singular")
            }
            Self::Inaccurate { relative_residual, null_pivots } => {
                write!(f, "the relative residual is {relative_residual:.1e}, with {null_pivots} null pivots: ")?;
                write!(f, "the matrix is singular")
            }
            Self::Krylov(reason) => write!(f, "{reason}"),
        }
    }
}

impl std::error::Error for LinearFailure {}

/// What [`LinearSolver::solve`] can end with besides a solution; the same on all ranks.
#[derive(Clone, Debug)]
pub enum LinearError {
    /// The system has no good solution.
    Failure(LinearFailure),
    /// PETSc failed, or was used wrongly.
    Error(Error),
}

impl From<Error> for LinearError {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

impl From<LinearFailure> for LinearError {
    fn from(failure: LinearFailure) -> Self {
        Self::Failure(failure)
    }
}

impl fmt::Display for LinearError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failure(failure) => failure.fmt(f),
            Self::Error(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for LinearError {}

/// What a solver has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearStatistics {
    /// Analyses of a pattern.
    pub analyses: usize,
    /// Numeric factorizations, repeated ones included.
    pub factorizations: usize,
    /// Factorizations repeated with more workspace.
    pub workspace_retries: usize,
    /// Systems solved or tried.
    pub solves: usize,
    /// Steps of iterative refinement.
    pub refinements: usize,
    /// ||b - A x|| / ||b|| of the last system.
    pub relative_residual: f64,
    /// Null pivots of the last factorization: redundant equations, if the residual is small all the same.
    pub null_pivots: usize,
    /// How many eigenvalues of the matrix of the last system are negative, if it was factored.
    pub negative: Negative,
    /// Factorizations repeated with pivots that MUMPS had taken for null, and that the solution needed.
    pub small_pivots: usize,
    /// Systems solved iteratively, and iterations for them.
    pub iterative_solves: usize,
    pub krylov_iterations: usize,
    /// Systems solved with the factors of an earlier one.
    pub reused: usize,
    /// Systems that the iterative solver was tried on in vain, and that were factored.
    pub unsolved: usize,
    /// Systems solved by factors whose solution was let through although rounding leaves more than [`RESIDUAL_TOLERANCE`].
    pub rough: usize,
    /// Factors are kept in files, for memory does not suffice for them.
    pub out_of_core: bool,
    /// Time for setting multigrid up, and for iterating, applications of factors excepted, s.
    pub set_up_s: f64,
    pub iterate_s: f64,
}

impl LinearStatistics {
    /// What was done before and `later` in all; the last system's figures are those of `later`.
    pub fn and(&self, later: &Self) -> Self {
        Self {
            analyses: self.analyses + later.analyses,
            factorizations: self.factorizations + later.factorizations,
            workspace_retries: self.workspace_retries + later.workspace_retries,
            solves: self.solves + later.solves,
            refinements: self.refinements + later.refinements,
            relative_residual: later.relative_residual,
            null_pivots: later.null_pivots,
            negative: later.negative,
            small_pivots: self.small_pivots + later.small_pivots,
            iterative_solves: self.iterative_solves + later.iterative_solves,
            krylov_iterations: self.krylov_iterations + later.krylov_iterations,
            reused: self.reused + later.reused,
            unsolved: self.unsolved + later.unsolved,
            rough: self.rough + later.rough,
            out_of_core: self.out_of_core || later.out_of_core,
            set_up_s: self.set_up_s + later.set_up_s,
            iterate_s: self.iterate_s + later.iterate_s,
        }
    }
}

/// How many real eigenvalues of a matrix are negative, as far as its factors tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Negative {
    /// Nothing was factored, or null pivots were replaced.
    #[default]
    Unknown,
    /// Of LDLᵀ: as many as negative pivots.
    Count(usize),
    /// Of LU: an odd number of them makes the determinant negative.
    Odd(bool),
}

impl Negative {
    /// Whether they are certainly not `count`.
    pub fn is_not(&self, count: usize) -> bool {
        match self {
            Self::Unknown => false,
            Self::Count(negative) => *negative != count,
            Self::Odd(is_odd) => *is_odd != (count % 2 == 1),
        }
    }
}

/// What factors are, as MUMPS foresees it from the pattern of the matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// Entries, those of both factors of LU.
    pub entries: f64,
    /// Operations on numbers of the factorization.
    pub operations: f64,
}

impl Factors {
    /// What computing them costs, in applications of them.
    pub fn worth(&self) -> usize {
        (OVERHEAD + self.operations / self.entries / SPEED) as usize
    }
}

/// Solves systems with MUMPS, or iteratively.
pub struct LinearSolver<'p> {
    petsc: &'p Petsc<'p>,
    factorization: Factorization,
    /// Workspace beyond the estimate, in percent, since the default or the user's has not sufficed.
    workspace: Option<i32>,
    /// Where factors may be kept in files.
    folder: Option<String>,
    factor: Option<Factor<'p>>,
    /// Solves with the factors of an earlier matrix, if it may.
    reuse: Option<Reuse<'p>>,
    multigrid: Option<Multigrid<'p>>,
    /// Iterations of multigrid a system, in the mean, above which factors are taken; how many it has taken, for how many.
    patience: usize,
    taken: [usize; 2],
    /// Systems in a row that multigrid did not solve.
    in_vain: usize,
    /// The largest ||b - A x|| / ||b|| of a solution by factors without null pivots.
    pub(crate) accepts: f64,
    statistics: LinearStatistics,
}

/// Solves with the factors of an earlier matrix.
struct Reuse<'p> {
    krylov: Krylov<'p>,
    least_worth: usize,
    /// Systems in a row that this did not solve, and how many more are factored before it is tried again: one more each time.
    in_vain: u32,
    pause: u32,
}

/// A factored matrix.
struct Factor<'p> {
    raw: sys::Mat,
    pattern: u64,
    /// The values that the factors are of, once they are.
    values: Option<Version>,
    wear: Wear,
    residual: Vector<'p>,
    correction: Vector<'p>,
}

impl<'p> LinearSolver<'p> {
    /// A solver that has seen no matrix yet.
    pub fn new(petsc: &'p Petsc<'p>, factorization: Factorization) -> Self {
        let statistics = LinearStatistics::default();
        Self {
            petsc,
            factorization,
            workspace: None,
            folder: None,
            factor: None,
            reuse: None,
            multigrid: None,
            patience: usize::MAX,
            taken: [0; 2],
            in_vain: 0,
            accepts: RESIDUAL_TOLERANCE,
            statistics,
        }
    }

    /// From now on takes solutions by factors without null pivots that have a larger residual than [`RESIDUAL_TOLERANCE`] after
    /// refinement, too, up to this part of b: who iterates makes up for it.
    pub fn accept(&mut self, residual: f64) {
        self.accepts = residual.max(RESIDUAL_TOLERANCE);
    }

    /// From now on solves systems with the factors of an earlier one, too, as long as that is cheaper than new ones, be its
    /// pattern another, if computing them costs at least so many applications of them. Collective.
    pub fn reuse_factors(&mut self, least_worth: usize) -> Result<(), Error> {
        self.reuse = Some(Reuse { krylov: Krylov::new(self.petsc)?, least_worth, in_vain: 0, pause: 0 });
        Ok(())
    }

    /// What pivots have told is of no more use.
    pub(crate) fn forget_pivots(&mut self) {
        (self.statistics.null_pivots, self.statistics.negative) = (0, Negative::Unknown);
    }

    /// Gives the memory of factors back, if it holds any.
    pub(crate) fn forget_factors(&mut self) -> bool {
        self.factor.take().is_some()
    }

    /// Where memory does not suffice for factors they are kept in files of this folder from now on, in vain if they are more than
    /// the disk has.
    pub fn keep_in(&mut self, folder: &str) {
        self.folder = Some(folder.into());
    }

    /// From now on tries to solve systems iteratively, of which the rows belong to these unknowns; what it cannot is solved
    /// directly, and all that comes after three such in a row, or after three or more that have taken more iterations than
    /// `patience` has, in the mean. Collective.
    pub fn iterate(&mut self, unknowns: Unknowns, patience: usize) -> Result<(), Error> {
        self.multigrid = Some(Multigrid::new(self.petsc, unknowns)?);
        self.patience = patience;
        Ok(())
    }

    /// Goes on with systems of other unknowns: factors and multigrid are of no more use, all else stays. Collective.
    pub(crate) fn renew(&mut self, unknowns: impl FnOnce() -> Unknowns) -> Result<(), Error> {
        self.factor = None;
        if let Some(reuse) = &mut self.reuse {
            reuse.krylov = Krylov::new(self.petsc)?;
        }
        if let Some(multigrid) = &mut self.multigrid {
            *multigrid = Multigrid::new(self.petsc, unknowns())?;
        }
        Ok(())
    }

    /// The iterations of multigrid a system, if they were too many.
    pub fn impatience(&self) -> Option<usize> {
        let [iterations, systems] = self.taken;
        (systems >= SYSTEMS_TO_JUDGE_BY).then(|| iterations / systems).filter(|mean| *mean > self.patience)
    }

    /// Whether it tries to solve systems iteratively.
    pub fn iterates(&self) -> bool {
        self.multigrid.is_some()
    }

    /// Tells the iterative solver, if there is one, where its nodes are now.
    pub fn place(&mut self, nodes: impl FnOnce() -> Vec<Node>) {
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.place(nodes());
        }
    }

    /// Analyses the pattern of a matrix, which the next factorization then need not; of its values only those of multipliers
    /// count, for the ordering of a symmetric one. Collective.
    pub fn analyse(&mut self, matrix: &Matrix) -> Result<Factors, LinearError> {
        let factor = self.analysed(matrix)?;
        let factors = factor.size()?;
        self.factor = Some(factor);
        Ok(factors)
    }

    /// What the factors are, if there has been a need for them.
    pub fn factors(&self) -> Result<Option<Factors>, Error> {
        self.factor.as_ref().map(Factor::size).transpose()
    }

    /// What it has done so far.
    pub fn statistics(&self) -> LinearStatistics {
        self.statistics
    }

    /// Counts a system that another solver tried, or solved by factors.
    pub(crate) fn record(&mut self, relative_residual: f64, by_factors: bool) {
        self.statistics.solves += 1;
        self.statistics.relative_residual = relative_residual;
        self.statistics.rough += usize::from(by_factors && relative_residual > RESIDUAL_TOLERANCE);
    }

    /// Solves A x = b. Collective.
    ///
    /// On [`LinearError::Failure`] `x` is of no use, and the solver as good as before.
    pub fn solve(&mut self, matrix: &Matrix, b: &Vector, x: &mut Vector) -> Result<(), LinearError> {
        matrix.require_layout(&[b, x])?;
        // SAFETY: live vectors of the matrix's layout, distinct since one is borrowed mutably.
        unsafe { self.solve_raw(matrix, b.raw(), x.raw()) }
    }

    /// Solves A x = b. Collective.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, distinct.
    pub(crate) unsafe fn solve_raw(&mut self, matrix: &Matrix, b: sys::Vec, x: sys::Vec) -> Result<(), LinearError> {
        self.statistics.solves += 1;
        self.statistics.relative_residual = 0.0;
        // SAFETY: the caller vouches for `b`.
        let norm = unsafe { norm2(b) }?;
        if !norm.is_finite() {
            self.statistics.relative_residual = f64::NAN;
            return Err(LinearFailure::NotFinite("right-hand side").into());
        }
        if norm == 0.0 {
            // An empty system, too.
            // SAFETY: the caller vouches for `x`.
            return Ok(check(unsafe { sys::VecSet(x, 0.0) })?);
        }
        let is_wanted = self.in_vain < MOST_IN_VAIN && self.impatience().is_none();
        if let Some(multigrid) = self.multigrid.as_mut().filter(|_| is_wanted) {
            if !matrix.is_finite_everywhere() {
                return Err(LinearFailure::NotFinite("matrix").into());
            }
            let before = self.statistics.krylov_iterations;
            // SAFETY: as for this function.
            let solved = unsafe { multigrid.solve(matrix, (b, norm), x, &mut self.statistics) }?;
            self.taken = [self.taken[0] + self.statistics.krylov_iterations - before, self.taken[1] + 1];
            if let Some(relative_residual) = solved {
                self.in_vain = 0;
                self.statistics.relative_residual = relative_residual;
                self.forget_pivots();
                return Ok(());
            }
            self.in_vain += 1;
            self.statistics.unsolved += 1;
        }
        // SAFETY: as for this function.
        if unsafe { self.reuse(matrix, (b, norm), x) }? {
            return Ok(());
        }
        let mut factor = self.factored(matrix)?;
        let accepts = if self.statistics.null_pivots == 0 { self.accepts } else { RESIDUAL_TOLERANCE };
        // SAFETY: as for this function.
        let mut result = unsafe { factor.solve(matrix, (b, norm), x, (accepts, &mut self.statistics)) };
        if let Err(LinearError::Failure(LinearFailure::Inaccurate { null_pivots: 1.., .. })) = result {
            let replaced = self.statistics;
            if factor.keep_pivots(matrix, self.factorization)? {
                self.statistics.factorizations += 1;
                self.forget_pivots();
                // SAFETY: as for this function.
                let kept = unsafe { factor.solve(matrix, (b, norm), x, (RESIDUAL_TOLERANCE, &mut self.statistics)) };
                if kept.is_ok() {
                    self.statistics.small_pivots += 1;
                    result = kept;
                } else {
                    self.statistics = LinearStatistics { factorizations: self.statistics.factorizations, ..replaced };
                    factor.values = None;
                }
            } else {
                return result;
            }
        }
        // Kept unless MUMPS failed: PETSc would neither factor nor solve with it again.
        if matches!(result, Ok(()) | Err(LinearError::Failure(LinearFailure::Inaccurate { .. }))) {
            self.factor = Some(factor);
        }
        result
    }

    /// Tries to solve A x = b with the factors of an earlier matrix. Collective.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, distinct; `b` comes with its norm.
    unsafe fn reuse(&mut self, matrix: &Matrix, (b, norm): (sys::Vec, f64), x: sys::Vec) -> Result<bool, LinearError> {
        let (Some(reuse), Some(factor)) = (&mut self.reuse, &mut self.factor) else { return Ok(false) };
        if factor.values.is_none_or(|values| values == matrix.version()) || !factor.wear.is_fit(reuse.least_worth) {
            return Ok(false);
        }
        if reuse.pause > 0 {
            reuse.pause -= 1;
            return Ok(false);
        }
        if !matrix.is_finite_everywhere() {
            return Err(LinearFailure::NotFinite("matrix").into());
        }
        let (begun, applied) = (Instant::now(), self.petsc.log_seconds("MatSolve")?);
        let most = factor.wear.worth;
        // SAFETY: as for this function.
        let Iterated { solved, iterations } = unsafe { reuse.krylov.solve(matrix, (b, norm), x, factor, most) }?;
        // Applications are in PETSc's log.
        let applied = self.petsc.log_seconds("MatSolve")? - applied;
        self.statistics.iterate_s += (begun.elapsed().as_secs_f64() - applied).max(0.0);
        factor.wear.count(iterations, solved.is_some());
        reuse.in_vain = if solved.is_some() { 0 } else { reuse.in_vain + 1 };
        reuse.pause = reuse.in_vain.saturating_sub(1).min(LONGEST_PAUSE);
        self.statistics.krylov_iterations += iterations;
        self.statistics.relative_residual = solved.unwrap_or_default();
        self.statistics.reused += usize::from(solved.is_some());
        if solved.is_some() {
            self.statistics.negative = Negative::Unknown;
        }
        Ok(solved.is_some())
    }

    /// How many eigenvalues of a matrix are negative, as far as its factors tell; of one that cannot be factored nothing is known.
    /// `None` where memory does not suffice for factors, which do not go to files for this. Collective.
    pub fn negative_eigenvalues(&mut self, matrix: &Matrix) -> Result<Option<Negative>, Error> {
        match self.count_negative(matrix) {
            Ok(negative) => Ok(negative),
            Err(LinearError::Failure(LinearFailure::Memory { .. })) => Ok(None),
            Err(LinearError::Failure(_)) => Ok(Some(Negative::Unknown)),
            Err(LinearError::Error(error)) => Err(error),
        }
    }

    fn count_negative(&mut self, matrix: &Matrix) -> Result<Option<Negative>, LinearError> {
        if self.factor.as_ref().is_none_or(|factor| factor.pattern != matrix.version().pattern) {
            let factor = self.analysed(matrix)?;
            if self.lacks_memory(&factor)? {
                return Ok(None);
            }
            self.factor = Some(factor);
        }
        self.factor = Some(self.factored(matrix)?);
        Ok(Some(self.statistics.negative))
    }

    /// What A, with null pivots replaced in its factors, does not give back of `z`: z - A⁺ A z, which is in the null space of
    /// A. Rounding where A is regular; `None` where the solver fails. Collective.
    pub fn null_part(&mut self, matrix: &Matrix, z: &Vector) -> Result<Option<Vector<'p>>, Error> {
        let rows = matrix.local_rows();
        let (mut b, mut y) = (Vector::zeros(self.petsc, rows)?, Vector::zeros(self.petsc, rows)?);
        matrix.multiply(z, &mut b)?;
        let accepts = std::mem::replace(&mut self.accepts, RESIDUAL_TOLERANCE);
        let solved = self.solve(matrix, &b, &mut y);
        self.accepts = accepts;
        match solved {
            Ok(()) => {}
            Err(LinearError::Failure(_)) => return Ok(None),
            Err(LinearError::Error(error)) => return Err(error),
        }
        y.axpy(-1.0, z)?;
        Ok(Some(y))
    }

    /// Takes the factors of the matrix, up to date; after a failure none are left. Collective.
    fn factored(&mut self, matrix: &Matrix) -> Result<Factor<'p>, LinearError> {
        let version = matrix.version();
        if let Some(factor) = self.factor.take_if(|factor| factor.values == Some(version)) {
            return Ok(factor);
        }
        if !matrix.is_finite_everywhere() {
            return Err(LinearFailure::NotFinite("matrix").into());
        }
        let kept = self.factor.take().filter(|factor| factor.pattern == version.pattern);
        let mut factor = match kept {
            Some(factor) => factor,
            None => self.placed(matrix)?,
        };
        for retry in 0.. {
            self.statistics.factorizations += 1;
            match factor.factor(matrix, self.factorization)? {
                Answer::Done { null_pivots, negative } => {
                    (self.statistics.null_pivots, self.statistics.negative) = (null_pivots, negative);
                    break;
                }
                Answer::MoreWorkspace(_) if retry < MAX_RETRIES => {
                    self.statistics.workspace_retries += 1;
                    self.workspace = Some(factor.workspace()?.max(50).saturating_mul(2));
                    drop(factor);
                    factor = self.analysed(matrix)?;
                }
                Answer::Failed(LinearFailure::Memory { .. }) if self.may_go_to_disk() => {
                    drop(factor);
                    self.statistics.out_of_core = true;
                    factor = self.analysed(matrix)?;
                }
                Answer::MoreWorkspace(failure) | Answer::Failed(failure) => return Err(failure.into()),
            }
        }
        factor.values = Some(version);
        factor.wear = if self.statistics.null_pivots > 0 { Wear::default() } else { Wear::new(factor.worth()?) };
        Ok(factor)
    }

    /// Analyses the pattern of the matrix. Collective.
    fn analysed(&mut self, matrix: &Matrix) -> Result<Factor<'p>, LinearError> {
        const FOLDER: &str = "mat_mumps_ooc_tmpdir";
        self.statistics.analyses += 1;
        // The option counts for all solvers of the process, which may have other folders; a user's own counts more.
        let folder = match &self.folder {
            Some(folder) if self.statistics.out_of_core && !self.petsc.has_option(FOLDER)? => Some(folder),
            _ => None,
        };
        folder.map(|folder| self.petsc.option(FOLDER, folder)).transpose()?;
        let factor = Factor::analyse(self.petsc, matrix, self.factorization);
        folder.map(|_| self.petsc.clear_option(FOLDER)).transpose()?;
        let mut factor = factor?;
        if let Some(workspace) = self.workspace {
            factor.set_control(WORKSPACE, workspace)?;
        }
        if self.statistics.out_of_core {
            factor.set_control(OUT_OF_CORE, 1)?;
        }
        Ok(factor)
    }

    /// The same, with factors in files if memory does not suffice for them. Collective.
    fn placed(&mut self, matrix: &Matrix) -> Result<Factor<'p>, LinearError> {
        let factor = self.analysed(matrix)?;
        if !self.may_go_to_disk() || !self.lacks_memory(&factor)? {
            return Ok(factor);
        }
        drop(factor);
        self.statistics.out_of_core = true;
        self.analysed(matrix)
    }

    fn may_go_to_disk(&self) -> bool {
        self.folder.is_some() && !self.statistics.out_of_core
    }

    /// Whether some rank has less memory left than MUMPS foresees for the one that takes most. Collective.
    fn lacks_memory(&self, factor: &Factor) -> Result<bool, Error> {
        let wanted = factor.infog(16)?.max(0) as u64 * 1_000_000;
        let left = left_for_each(self.petsc.own());
        Ok(self.petsc.any(left.is_some_and(|left| left < wanted)))
    }
}

/// What factors have cost and done, in applications of them.
#[derive(Clone, Copy, Debug, Default)]
struct Wear {
    /// What computing them has cost.
    worth: usize,
    /// Systems solved with them, and applications for these.
    systems: usize,
    applied: usize,
    /// Applications for the last system.
    last: usize,
}

impl Wear {
    /// Of factors that have solved the system that they are of.
    fn new(worth: usize) -> Self {
        Self { worth, systems: 1, applied: 1, last: 1 }
    }

    /// Whether another system like the last lowers what a system costs on the average, the factorization included.
    fn is_fit(&self, least_worth: usize) -> bool {
        self.worth > 0 && self.worth >= least_worth && self.last * self.systems <= self.worth + self.applied
    }

    /// Counts a system; after one that was not solved they are fit no more.
    fn count(&mut self, applied: usize, solved: bool) {
        let worth = if solved { self.worth } else { 0 };
        *self = Self { worth, systems: self.systems + 1, applied: self.applied + applied, last: applied };
    }
}

/// What MUMPS says after a factorization.
enum Answer {
    Done { null_pivots: usize, negative: Negative },
    MoreWorkspace(LinearFailure),
    Failed(LinearFailure),
}

impl<'p> Factor<'p> {
    /// Analyses the pattern of a matrix. Collective.
    fn analyse(petsc: &'p Petsc<'p>, matrix: &Matrix, factorization: Factorization) -> Result<Self, LinearError> {
        const MUMPS: &CStr = c"mumps";
        let kind = match factorization {
            Factorization::Lu => sys::MAT_FACTOR_LU,
            Factorization::Ldlt => sys::MAT_FACTOR_CHOLESKY,
        };
        let (residual, correction) =
            (Vector::zeros(petsc, matrix.local_rows())?, Vector::zeros(petsc, matrix.local_rows())?);
        let mut raw = null_mut();
        // SAFETY: a live matrix, the solver's name, and a place for the handle.
        check(unsafe { sys::MatGetFactor(matrix.raw(), MUMPS.as_ptr(), kind, &mut raw) })?;
        let mut factor =
            Self { raw, pattern: matrix.version().pattern, values: None, wear: Wear::default(), residual, correction };
        factor.set_controls(factorization)?;
        let info = factor_info()?;
        // SAFETY: a fresh factor of this matrix; MUMPS orders by itself (NULL).
        check(unsafe {
            match factorization {
                Factorization::Lu => sys::MatLUFactorSymbolic(raw, matrix.raw(), null_mut(), null_mut(), &info),
                Factorization::Ldlt => sys::MatCholeskyFactorSymbolic(raw, matrix.raw(), null_mut(), &info),
            }
        })?;
        match factor.infog(1)? {
            0.. => Ok(factor),
            _ => Err(factor.failure()?.into()),
        }
    }

    /// The defaults of MUMPS that we change; PETSc's options come after them.
    fn set_controls(&mut self, factorization: Factorization) -> Result<(), Error> {
        self.set_control(ANALYSIS, 1)?; // sequential
        self.set_control(ORDERING, 3)?; // SCOTCH; PORD where MUMPS is built without it
        // By rows and columns, of the values that are factored. On one rank MUMPS would scale by those of the analysis, which
        // later iterations have not: contacts that come or go then look like null pivots, or hide them.
        self.set_control(SCALING, 7)?;
        self.set_control(SCALAPACK_ROOT, 1)?; // without ScaLAPACK, which cannot pivot past a null
        self.set_control(WORKSPACE, 100)?;
        self.set_control(NULL_PIVOTS, 1)?; // find and replace: redundant constraints are legal
        if factorization == Factorization::Lu {
            self.set_control(DETERMINANT, 1)?; // its sign tells of instability
        }
        if factorization == Factorization::Ldlt {
            self.set_control(LDLT_ORDERING, 2)?; // compressed graph: pairs multipliers with displacements
        }
        Ok(())
    }

    /// Computes the factors. Collective.
    fn factor(&mut self, matrix: &Matrix, factorization: Factorization) -> Result<Answer, Error> {
        let info = factor_info()?;
        // SAFETY: a factor analysed for the pattern of this matrix.
        check(unsafe {
            match factorization {
                Factorization::Lu => sys::MatLUFactorNumeric(self.raw, matrix.raw(), &info),
                Factorization::Ldlt => sys::MatCholeskyFactorNumeric(self.raw, matrix.raw(), &info),
            }
        })?;
        Ok(match self.infog(1)? {
            0.. => {
                let null_pivots = self.infog(28)?.max(0) as usize;
                let negative = if null_pivots > 0 { Negative::Unknown } else { self.negative(factorization)? };
                Answer::Done { null_pivots, negative }
            }
            // Integer or real workspace, send or receive buffer too small.
            -8 | -9 | -17 | -20 => Answer::MoreWorkspace(self.failure()?),
            _ => Answer::Failed(self.failure()?),
        })
    }

    /// What the factors tell of negative eigenvalues.
    fn negative(&self, factorization: Factorization) -> Result<Negative, Error> {
        if factorization == Factorization::Ldlt {
            return Ok(Negative::Count(self.infog(12)?.max(0) as usize));
        }
        let mut mantissa = 0.0;
        // SAFETY: a live MUMPS factor and a place for the answer.
        check(unsafe { sys::MatMumpsGetRinfog(self.raw, 12, &mut mantissa) })?;
        Ok(Negative::Odd(mantissa < 0.0))
    }

    /// Computes the factors anew without a search for null pivots; `false` when MUMPS cannot. Collective.
    fn keep_pivots(&mut self, matrix: &Matrix, factorization: Factorization) -> Result<bool, Error> {
        self.set_control(NULL_PIVOTS, 0)?;
        let answer = self.factor(matrix, factorization)?;
        self.set_control(NULL_PIVOTS, 1)?;
        Ok(matches!(answer, Answer::Done { .. }))
    }

    /// Solves with the factors, and refines until the true residual is small, or as small as it gets; up to what is accepted that
    /// counts. Collective.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, distinct. `b` comes with its norm.
    unsafe fn solve(
        &self,
        matrix: &Matrix,
        (b, norm): (sys::Vec, f64),
        x: sys::Vec,
        (accepts, statistics): (f64, &mut LinearStatistics),
    ) -> Result<(), LinearError> {
        let (residual, correction) = (self.residual.raw(), self.correction.raw());
        for refinement in 0.. {
            // SAFETY: live vectors of one layout, each pair distinct.
            unsafe {
                if refinement == 0 {
                    self.apply(b, x)?;
                } else {
                    statistics.refinements += 1;
                    self.apply(residual, correction)?;
                    check(sys::VecAXPY(x, 1.0, correction))?;
                }
                statistics.relative_residual = matrix.raw_residual(b, x, residual)? / norm;
            }
            if statistics.relative_residual <= RESIDUAL_TOLERANCE {
                return Ok(());
            }
            if refinement == MAX_REFINEMENTS || !statistics.relative_residual.is_finite() {
                break;
            }
        }
        if statistics.relative_residual <= accepts {
            statistics.rough += 1;
            return Ok(());
        }
        let (relative_residual, null_pivots) = (statistics.relative_residual, statistics.null_pivots);
        Err(LinearFailure::Inaccurate { relative_residual, null_pivots }.into())
    }

    /// Solves with the factors once. Collective.
    ///
    /// # Safety
    /// Live vectors of the factor's layout, distinct.
    unsafe fn apply(&self, b: sys::Vec, x: sys::Vec) -> Result<(), LinearError> {
        // SAFETY: the caller vouches for the vectors; the factors are computed.
        let result = check(unsafe { sys::MatSolve(self.raw, b, x) });
        if result.is_err() && self.infog(1)? < 0 {
            forget();
            return Err(self.failure()?.into());
        }
        Ok(result?)
    }

    /// What computing the factors has cost, in applications of them.
    fn worth(&self) -> Result<usize, Error> {
        Ok(self.sized(29, 3)?.worth())
    }

    /// What the analysis has foreseen.
    fn size(&self) -> Result<Factors, Error> {
        self.sized(20, 1)
    }

    /// Entries by an INFOG, operations by a RINFOG.
    fn sized(&self, entries: i32, operations: i32) -> Result<Factors, Error> {
        let mut found = 0.0;
        // SAFETY: a live MUMPS factor and a place for the answer.
        check(unsafe { sys::MatMumpsGetRinfog(self.raw, operations, &mut found) })?;
        let entries = match self.infog(entries)? {
            many @ ..0 => -1e6 * f64::from(many),
            entries => f64::from(entries),
        };
        Ok(Factors { entries, operations: found })
    }

    fn workspace(&self) -> Result<i32, Error> {
        let mut workspace = 0;
        // SAFETY: a live MUMPS factor and a place for the answer.
        check(unsafe { sys::MatMumpsGetIcntl(self.raw, WORKSPACE, &mut workspace) })?;
        Ok(workspace)
    }

    fn set_control(&mut self, control: i32, value: i32) -> Result<(), Error> {
        // SAFETY: a live MUMPS factor.
        check(unsafe { sys::MatMumpsSetIcntl(self.raw, control, value) })
    }

    fn infog(&self, index: i32) -> Result<i32, Error> {
        let mut value = 0;
        // SAFETY: a live MUMPS factor and a place for the answer.
        check(unsafe { sys::MatMumpsGetInfog(self.raw, index, &mut value) })?;
        Ok(value)
    }

    /// The failure that INFOG tells of.
    fn failure(&self) -> Result<LinearFailure, Error> {
        Ok(match (self.infog(1)?, self.infog(2)?) {
            (one @ (-6 | -10), two) => LinearFailure::Singular(one, two),
            // No memory for integers, for reals; workspace that more of it did not cure; the user's limit, ICNTL(23).
            // Or no room for files.
            (code @ (-7 | -8 | -9 | -11 | -13 | -14 | -17 | -19 | -20 | -90), two) => {
                let missing = if code == -90 { 0 } else { megabytes(two) };
                let estimate = self.infog(16)?.max(0) as u64;
                LinearFailure::Memory { code, missing, estimate }
            }
            (one, two) => LinearFailure::Mumps(one, two),
        })
    }
}

impl Preconditioner for Factor<'_> {
    unsafe fn apply(&mut self, r: sys::Vec, z: sys::Vec) -> Result<(), LinearError> {
        // SAFETY: the caller vouches for the vectors.
        unsafe { Factor::apply(self, r, z) }
    }
}

impl Drop for Factor<'_> {
    fn drop(&mut self) {
        // SAFETY: a live factor that nobody else holds.
        unsafe { sys::MatDestroy(&mut self.raw) };
    }
}

/// What INFOG(2) says of missing memory, MB: a number of entries, or millions of them where it is negative.
fn megabytes(entries: i32) -> u64 {
    const BYTES: u64 = size_of::<f64>() as u64;
    let entries = if entries < 0 { u64::from(entries.unsigned_abs()) * 1_000_000 } else { entries as u64 };
    (entries * BYTES).div_ceil(1_000_000)
}

/// PETSc's defaults for a factorization; MUMPS does not look at them.
fn factor_info() -> Result<sys::MatFactorInfo, Error> {
    let mut info = MaybeUninit::zeroed();
    // SAFETY: the call writes defaults over plain numbers, for which zeros are valid too.
    check(unsafe { sys::MatFactorInfoInitialize(info.as_mut_ptr()) })?;
    // SAFETY: as above.
    Ok(unsafe { info.assume_init() })
}
