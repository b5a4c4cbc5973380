//! A vector distributed over the ranks, each holding a part that follows the one of the rank before.

use std::ops::{Deref, DerefMut};
use std::ptr::{null, null_mut};
use std::slice;

use crate::error::{Error, check};
use crate::runtime::Petsc;
use crate::sys;

/// A PETSc `Vec` on all ranks.
pub struct Vector<'p> {
    petsc: &'p Petsc<'p>,
    raw: sys::Vec,
    local_len: usize,
}

impl<'p> Vector<'p> {
    /// A vector of zeros with `local_len` entries on this rank, possibly none. Collective.
    pub fn zeros(petsc: &'p Petsc<'p>, local_len: usize) -> Result<Self, Error> {
        let length = petsc.agree(i32::try_from(local_len).map_err(|_| format!("a vector of {local_len} entries")))?;
        let mut raw = null_mut();
        // SAFETY: a live communicator and a place for the handle.
        check(unsafe { sys::VecCreateMPI(petsc.raw_comm(), length, sys::PETSC_DETERMINE, &mut raw) })?;
        let mut vector = Self { petsc, raw, local_len };
        vector.set(0.0)?;
        Ok(vector)
    }

    /// A vector with these entries on this rank. Collective.
    pub fn from_slice(petsc: &'p Petsc<'p>, local: &[f64]) -> Result<Self, Error> {
        let mut vector = Self::zeros(petsc, local.len())?;
        vector.array_mut()?.copy_from_slice(local);
        Ok(vector)
    }

    /// Number of entries on this rank.
    pub fn local_len(&self) -> usize {
        self.local_len
    }

    /// Number of entries on all ranks.
    pub fn global_len(&self) -> Result<usize, Error> {
        let mut length = 0;
        // SAFETY: a live vector.
        check(unsafe { sys::VecGetSize(self.raw, &mut length) })?;
        Ok(length as usize)
    }

    /// The entries of this rank, to read.
    pub fn array(&self) -> Result<Array<'_>, Error> {
        // SAFETY: a live vector; the borrow of `self` keeps writers off.
        unsafe { Array::new(self.raw) }
    }

    /// The entries of this rank, to write.
    ///
    /// Call it on all ranks or on none, even where there is nothing to write: PETSc remembers norms until a vector is
    /// written to, and a rank that remembers would not join the others in computing the new one.
    pub fn array_mut(&mut self) -> Result<ArrayMut<'_>, Error> {
        // SAFETY: a live vector; the borrow of `self` keeps all others off.
        unsafe { ArrayMut::new(self.raw) }
    }

    /// Sets all entries to a value. Collective.
    pub fn set(&mut self, value: f64) -> Result<(), Error> {
        // SAFETY: a live vector.
        check(unsafe { sys::VecSet(self.raw, value) })
    }

    /// self = x. Collective.
    pub fn copy_from(&mut self, x: &Vector) -> Result<(), Error> {
        self.require_same_layout(x)?;
        // SAFETY: two live vectors of the same layout.
        check(unsafe { sys::VecCopy(x.raw, self.raw) })
    }

    /// self = self + a x. Collective.
    pub fn axpy(&mut self, a: f64, x: &Vector) -> Result<(), Error> {
        self.require_same_layout(x)?;
        // SAFETY: two live vectors of the same layout, distinct since one is borrowed mutably.
        check(unsafe { sys::VecAXPY(self.raw, a, x.raw) })
    }

    /// The inner product with `x`. Collective.
    pub fn dot(&self, x: &Vector) -> Result<f64, Error> {
        self.require_same_layout(x)?;
        let mut product = 0.0;
        // SAFETY: two live vectors of the same layout.
        check(unsafe { sys::VecDot(self.raw, x.raw, &mut product) })?;
        Ok(product)
    }

    /// The Euclidean norm. Collective.
    pub fn norm2(&self) -> Result<f64, Error> {
        // SAFETY: a live vector.
        unsafe { norm2(self.raw) }
    }

    /// The largest magnitude; 0 for an empty vector. Collective.
    pub fn norm_inf(&self) -> Result<f64, Error> {
        let mut norm = 0.0;
        // SAFETY: a live vector.
        check(unsafe { sys::VecNorm(self.raw, sys::NORM_INFINITY, &mut norm) })?;
        Ok(norm)
    }

    pub(crate) fn raw(&self) -> sys::Vec {
        self.raw
    }

    /// An error on all ranks unless all parts of the two vectors are of the same lengths. Collective.
    fn require_same_layout(&self, x: &Vector) -> Result<(), Error> {
        let (mine, other) = (self.local_len, x.local_len);
        self.petsc.require(mine == other, || format!("vectors of {mine} and {other} entries on a rank do not match"))
    }
}

impl Drop for Vector<'_> {
    fn drop(&mut self) {
        // SAFETY: a live vector, which PETSc frees once its solvers have let go of it too.
        unsafe { sys::VecDestroy(&mut self.raw) };
    }
}

/// The Euclidean norm. Collective.
///
/// # Safety
/// `raw` is a live vector.
pub(crate) unsafe fn norm2(raw: sys::Vec) -> Result<f64, Error> {
    let mut norm = 0.0;
    // SAFETY: the caller vouches for the vector.
    check(unsafe { sys::VecNorm(raw, sys::NORM_2, &mut norm) })?;
    Ok(norm)
}

/// The entries of a vector on this rank, to read. Derefs to `[f64]`.
pub struct Array<'v> {
    raw: sys::Vec,
    start: *const f64,
    entries: &'v [f64],
}

impl Array<'_> {
    /// # Safety
    /// `raw` is a live vector that nobody writes to or frees during the lifetime.
    pub(crate) unsafe fn new(raw: sys::Vec) -> Result<Self, Error> {
        let mut start = null();
        // SAFETY: a live vector.
        let length = unsafe { local_len(raw) }?;
        // SAFETY: a live vector.
        check(unsafe { sys::VecGetArrayRead(raw, &mut start) })?;
        // SAFETY: PETSc hands out `length` entries (perhaps NULL for none), and nobody writes to them meanwhile.
        let entries = if length == 0 { &[] } else { unsafe { slice::from_raw_parts(start, length) } };
        Ok(Self { raw, start, entries })
    }
}

impl Deref for Array<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        self.entries
    }
}

impl Drop for Array<'_> {
    fn drop(&mut self) {
        // SAFETY: gives back what `new` took.
        unsafe { sys::VecRestoreArrayRead(self.raw, &mut self.start) };
    }
}

/// The entries of a vector on this rank, to write. Derefs to `[f64]`.
pub struct ArrayMut<'v> {
    raw: sys::Vec,
    start: *mut f64,
    entries: &'v mut [f64],
}

impl ArrayMut<'_> {
    /// # Safety
    /// `raw` is a live vector that nobody else reads, writes or frees during the lifetime.
    pub(crate) unsafe fn new(raw: sys::Vec) -> Result<Self, Error> {
        let mut start = null_mut();
        // SAFETY: a live vector.
        let length = unsafe { local_len(raw) }?;
        // SAFETY: a live vector.
        check(unsafe { sys::VecGetArray(raw, &mut start) })?;
        // SAFETY: PETSc hands out `length` entries (perhaps NULL for none), and they are ours alone meanwhile.
        let entries = if length == 0 { &mut [] } else { unsafe { slice::from_raw_parts_mut(start, length) } };
        Ok(Self { raw, start, entries })
    }
}

impl Deref for ArrayMut<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        self.entries
    }
}

impl DerefMut for ArrayMut<'_> {
    fn deref_mut(&mut self) -> &mut [f64] {
        self.entries
    }
}

impl Drop for ArrayMut<'_> {
    fn drop(&mut self) {
        // SAFETY: gives back what `new` took, and lets PETSc know that the entries have changed.
        unsafe { sys::VecRestoreArray(self.raw, &mut self.start) };
    }
}

/// # Safety
/// `raw` is a live vector.
unsafe fn local_len(raw: sys::Vec) -> Result<usize, Error> {
    let mut length = 0;
    // SAFETY: the caller vouches for the vector.
    check(unsafe { sys::VecGetLocalSize(raw, &mut length) })?;
    Ok(length as usize)
}
