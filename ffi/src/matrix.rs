//! A square sparse matrix distributed by rows, copied from compressed rows of the caller's.
//!
//! PETSc stores it as `MPIAIJ`, on one rank too. The pattern stands until [`Matrix::rebuild`]; new values for it come
//! by [`Matrix::update`], in the order of the compressed rows, which costs a copy.

use std::ptr::null_mut;
use std::sync::atomic::{AtomicU64, Ordering};

use mpi::collective::SystemOperation;
use mpi::traits::*;

use crate::error::{Error, check};
use crate::runtime::Petsc;
use crate::sys;
use crate::vector::{Vector, norm2};

/// A PETSc `Mat` on all ranks.
pub struct Matrix<'p> {
    petsc: &'p Petsc<'p>,
    raw: sys::Mat,
    local_rows: usize,
    /// Stored entries on this rank.
    local_entries: usize,
    symmetric: bool,
    /// Whether the values of this rank are numbers: MUMPS does not say.
    finite: bool,
    version: Version,
}

/// Tells a solver what has changed since it saw a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Version {
    /// Unique among the patterns of all matrices of this process.
    pub pattern: u64,
    /// Counts the sets of values in the pattern.
    pub values: u64,
}

impl Version {
    fn of_new_pattern() -> Self {
        static PATTERNS: AtomicU64 = AtomicU64::new(0);
        Self { pattern: PATTERNS.fetch_add(1, Ordering::Relaxed), values: 0 }
    }
}

/// Rows of this rank: row `i` has `columns[k]` and `values[k]` for `k` in `row_offsets[i]..row_offsets[i + 1]`.
struct CompressedRows<'a> {
    row_offsets: &'a [i32],
    columns: &'a [i32],
    values: &'a [f64],
}

impl<'p> Matrix<'p> {
    /// A matrix from the rows of this rank, possibly none.
    ///
    /// `row_offsets` has `local_rows + 1` entries; `columns` are global and ascend strictly in a row; zeros are stored
    /// too. There are as many columns as rows on all ranks. Collective.
    pub fn from_csr(
        petsc: &'p Petsc<'p>,
        local_rows: usize,
        row_offsets: &[i32],
        columns: &[i32],
        values: &[f64],
    ) -> Result<Self, Error> {
        let rows = CompressedRows { row_offsets, columns, values };
        let raw = create(petsc, local_rows, &rows)?;
        let (local_entries, finite) = (values.len(), is_finite(values));
        Ok(Self { petsc, raw, local_rows, local_entries, symmetric: false, finite, version: Version::of_new_pattern() })
    }

    /// New values in the standing pattern, in the order of its compressed rows. Collective.
    pub fn update(&mut self, values: &[f64]) -> Result<(), Error> {
        let (expected, found) = (self.local_entries, values.len());
        self.petsc.require(expected == found, || format!("{found} values for a pattern of {expected} entries"))?;
        self.finite = is_finite(values);
        self.version.values += 1;
        // SAFETY: a live matrix made by MatCreateMPIAIJWithArrays, and as many values as it was made with.
        check(unsafe { sys::MatUpdateMPIAIJWithArray(self.raw, values.as_ptr()) })
    }

    /// A new pattern with values, arguments as in [`Matrix::from_csr`], for the same number of rows on each rank.
    /// Solvers that use the matrix notice and analyse it anew. Collective.
    pub fn rebuild(&mut self, row_offsets: &[i32], columns: &[i32], values: &[f64]) -> Result<(), Error> {
        let mut new = create(self.petsc, self.local_rows, &CompressedRows { row_offsets, columns, values })?;
        (self.local_entries, self.finite, self.version) = (values.len(), is_finite(values), Version::of_new_pattern());
        // SAFETY: two live matrices of the same layout. The old contents are freed, `new` becomes NULL, and `self.raw`
        // stays valid for the solvers that hold it.
        check(unsafe { sys::MatHeaderReplace(self.raw, &mut new) })?;
        self.set_symmetric(self.symmetric)
    }

    /// Declares the matrix to be symmetric, now and after every change of its values. Collective.
    pub fn set_symmetric(&mut self, symmetric: bool) -> Result<(), Error> {
        self.symmetric = symmetric;
        for option in [sys::MAT_SYMMETRIC, sys::MAT_SYMMETRY_ETERNAL] {
            // SAFETY: a live matrix; both are options that take a truth value.
            check(unsafe { sys::MatSetOption(self.raw, option, symmetric.into()) })?;
        }
        Ok(())
    }

    /// Whether [`Matrix::set_symmetric`] declared it symmetric.
    pub fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// Number of rows on this rank.
    pub fn local_rows(&self) -> usize {
        self.local_rows
    }

    /// Number of rows on all ranks.
    pub fn global_rows(&self) -> Result<usize, Error> {
        let (mut rows, mut columns) = (0, 0);
        // SAFETY: a live matrix.
        check(unsafe { sys::MatGetSize(self.raw, &mut rows, &mut columns) })?;
        Ok(rows as usize)
    }

    /// (A + Aᵀ) / 2, of which the values cannot be updated. As long as the pattern of A stands, that of this is one and the
    /// same to solvers. Collective.
    pub fn symmetric_part(&self) -> Result<Self, Error> {
        let mut raw = null_mut();
        // SAFETY: a live matrix and a place for the handle of its transpose, to which the matrix, of the same layout, is added.
        check(unsafe { sys::MatTranspose(self.raw, sys::MAT_INITIAL_MATRIX, &mut raw) })?;
        let mut part = Self { raw, symmetric: false, local_entries: 0, ..*self };
        // SAFETY: as above.
        check(unsafe { sys::MatAXPY(raw, 1.0, self.raw, sys::DIFFERENT_NONZERO_PATTERN) })?;
        // SAFETY: a live matrix.
        check(unsafe { sys::MatScale(raw, 0.5) })?;
        part.set_symmetric(true)?;
        Ok(part)
    }

    /// y = A x. Collective.
    pub fn multiply(&self, x: &Vector, y: &mut Vector) -> Result<(), Error> {
        self.require_layout(&[x, y])?;
        // SAFETY: live objects of one layout; the vectors are distinct since one is borrowed mutably.
        check(unsafe { sys::MatMult(self.raw, x.raw(), y.raw()) })
    }

    /// r = b - A x, and its Euclidean norm. Collective.
    pub fn residual(&self, b: &Vector, x: &Vector, r: &mut Vector) -> Result<f64, Error> {
        self.require_layout(&[b, x, r])?;
        // SAFETY: live objects of one layout; `r` is distinct from the others since it is borrowed mutably.
        unsafe { self.raw_residual(b.raw(), x.raw(), r.raw()) }
    }

    /// r = b - A x, and its norm.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, `r` distinct from the others.
    pub(crate) unsafe fn raw_residual(&self, b: sys::Vec, x: sys::Vec, r: sys::Vec) -> Result<f64, Error> {
        // SAFETY: the caller vouches for the vectors.
        check(unsafe { sys::MatResidual(self.raw, b, x, r) })?;
        // SAFETY: as above.
        unsafe { norm2(r) }
    }

    /// An error on all ranks unless the vectors have as many entries as the matrix has rows on each rank. Collective.
    pub(crate) fn require_layout(&self, vectors: &[&Vector]) -> Result<(), Error> {
        let rows = self.local_rows;
        let misfit = vectors.iter().map(|vector| vector.local_len()).find(|&length| length != rows);
        self.petsc.require(misfit.is_none(), || {
            format!("a vector of {} entries for a matrix of {rows} rows on a rank", misfit.unwrap_or_default())
        })
    }

    /// Whether the values of all ranks are finite. Collective.
    pub(crate) fn is_finite_everywhere(&self) -> bool {
        !self.petsc.any(!self.finite)
    }

    pub(crate) fn raw(&self) -> sys::Mat {
        self.raw
    }

    pub(crate) fn version(&self) -> Version {
        self.version
    }
}

impl Drop for Matrix<'_> {
    fn drop(&mut self) {
        // SAFETY: a live matrix, which PETSc frees once its solvers have let go of it too.
        unsafe { sys::MatDestroy(&mut self.raw) };
    }
}

/// Checks the rows on all ranks and copies them into a new PETSc matrix. Collective.
fn create(petsc: &Petsc, local_rows: usize, rows: &CompressedRows) -> Result<sys::Mat, Error> {
    let count = petsc.agree(i32::try_from(local_rows).map_err(|_| format!("{local_rows} rows on a rank")))?;
    let (mine, mut total) = (i64::from(count), 0);
    petsc.own().all_reduce_into(&mine, &mut total, SystemOperation::sum());
    petsc.agree(rows.check(local_rows, total))?;
    let (offsets, columns, values) = (rows.row_offsets.as_ptr(), rows.columns.as_ptr(), rows.values.as_ptr());
    let (comm, total, mut raw) = (petsc.raw_comm(), sys::PETSC_DETERMINE, null_mut());
    // SAFETY: `check` found valid compressed rows; PETSc copies them.
    check(unsafe {
        sys::MatCreateMPIAIJWithArrays(comm, count, count, total, total, offsets, columns, values, &mut raw)
    })?;
    Ok(raw)
}

impl CompressedRows<'_> {
    /// Whether they are as [`Matrix::from_csr`] wants them.
    fn check(&self, local_rows: usize, global_rows: i64) -> Result<(), String> {
        let Self { row_offsets, columns, values } = self;
        if row_offsets.len() != local_rows + 1 || row_offsets[0] != 0 || !row_offsets.is_sorted() {
            return Err(format!("the row offsets of {local_rows} rows must be {} and ascend from 0", local_rows + 1));
        }
        let entries = row_offsets[local_rows] as usize;
        if columns.len() != entries || values.len() != entries {
            return Err(format!("{} columns and {} values for {entries} entries", columns.len(), values.len()));
        }
        if global_rows > i64::from(i32::MAX) {
            return Err(format!("{global_rows} rows are more than PETSc's 32-bit indices can count"));
        }
        for (row, range) in row_offsets.windows(2).enumerate() {
            let columns = &columns[range[0] as usize..range[1] as usize];
            let inside = |&column: &i32| column >= 0 && i64::from(column) < global_rows;
            if !columns.iter().all(inside) || !columns.is_sorted_by(|a, b| a < b) {
                return Err(format!("the columns of local row {row} must ascend strictly within 0..{global_rows}"));
            }
        }
        Ok(())
    }
}

/// Whether all values are finite; an infinity or a NaN in one makes the sum of `0 x` a NaN, without a branch each.
fn is_finite(values: &[f64]) -> bool {
    values.iter().map(|value| 0.0 * value).sum::<f64>() == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressed_rows_are_checked() {
        let check = |rows, global, row_offsets: &[i32], columns: &[i32], values: &[f64]| {
            CompressedRows { row_offsets, columns, values }.check(rows, global)
        };
        assert_eq!(check(2, 3, &[0, 2, 3], &[0, 2, 1], &[1.0; 3]), Ok(()));
        assert_eq!(check(0, 3, &[0], &[], &[]), Ok(()));
        for bad in [
            check(2, 3, &[0, 2], &[0, 2], &[1.0; 2]),
            check(2, 3, &[0, 2, 1], &[0], &[1.0]),
            check(2, 3, &[1, 2, 3], &[0, 1, 2], &[1.0; 3]),
            check(1, 3, &[0, 2], &[0, 2], &[1.0]),
            check(1, 3, &[0, 2], &[2, 0], &[1.0; 2]),
            check(1, 3, &[0, 2], &[1, 1], &[1.0; 2]),
            check(1, 3, &[0, 1], &[3], &[1.0]),
            check(1, 3, &[0, 1], &[-1], &[1.0]),
            check(0, 3, &[], &[], &[]),
        ] {
            assert!(bad.is_err());
        }
    }

    #[test]
    fn finite_values_are_told_from_others() {
        assert!(is_finite(&[0.0, -0.0, f64::MAX, f64::MIN_POSITIVE]) && is_finite(&[]));
        assert!(!is_finite(&[1.0, f64::NAN]) && !is_finite(&[f64::NEG_INFINITY, f64::INFINITY]));
    }
}
