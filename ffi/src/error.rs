//! PETSc's error codes as Rust errors, with the words PETSc has for them.
//!
//! PETSc reports an error by calling a handler where it occurs and again in every function on the way out. Ours prints
//! nothing and keeps the report until [`check`] meets the code that the call returns.

use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use mpi::ffi::MPI_Comm;

use crate::sys;

/// A PETSc error with PETSc's own message, or a wrong use of this crate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(pub String);

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Error {}

/// For `?` in the methods of a [`Problem`](crate::Problem).
impl From<Error> for String {
    fn from(error: Error) -> Self {
        error.0
    }
}

/// What PETSc said of the error under way.
#[derive(Default)]
struct Report {
    /// The message at the origin.
    message: String,
    /// `function() at file:line`, the origin first.
    frames: Vec<String>,
}

thread_local! {
    static REPORT: RefCell<Report> = RefCell::default();
}

/// Turns the code that a PETSc function returned into a result.
pub(crate) fn check(code: sys::PetscErrorCode) -> Result<(), Error> {
    if code == 0 { Ok(()) } else { Err(take(code)) }
}

/// Forgets what PETSc reported: the cause is known from elsewhere.
pub(crate) fn forget() {
    REPORT.take();
}

fn take(code: sys::PetscErrorCode) -> Error {
    let report = REPORT.take();
    let mut text = format!("PETSc: {} (error {code})", general_text(code));
    if !report.message.is_empty() {
        text += &format!(": {}", report.message);
    }
    if let Some(origin) = report.frames.first() {
        text += &format!("; in {origin}");
    }
    if let [_, .., outermost] = report.frames.as_slice() {
        text += &format!(", called from {outermost}");
    }
    Error(text)
}

/// PETSc's text for a kind of error.
fn general_text(code: sys::PetscErrorCode) -> String {
    let mut text = null();
    // SAFETY: the function only looks the code up; `text` becomes NULL or a static string.
    let found = unsafe { sys::PetscErrorMessage(code, &mut text, null_mut()) };
    // SAFETY: as above.
    if found == 0 { unsafe { owned(text) } } else { "unknown error".into() }
}

/// A C string of PETSc's as our own; empty for NULL.
///
/// # Safety
/// `text` is NULL or a valid C string.
pub(crate) unsafe fn owned(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller vouches for it.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().trim().to_string()
}

/// Makes PETSc report errors to this thread's memory instead of the terminal. May be called before `PetscInitialize`.
pub(crate) fn collect_reports() -> Result<(), Error> {
    // SAFETY: the handler has the type PETSc asks for, needs no context, and does not unwind.
    check(unsafe { sys::PetscPushErrorHandler(Some(on_error), null_mut()) })
}

/// The handler: `kind` tells the origin of an error from its way out.
unsafe extern "C" fn on_error(
    _comm: MPI_Comm,
    line: c_int,
    function: *const c_char,
    file: *const c_char,
    code: sys::PetscErrorCode,
    kind: sys::PetscErrorType,
    message: *const c_char,
    _context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: PETSc passes NULL or C strings.
    let (function, file, message) = unsafe { (owned(function), owned(file), owned(message)) };
    // Neither access can fail but during the thread's end; the report is then of no use.
    let _ = REPORT.try_with(|report| {
        if let Ok(mut report) = report.try_borrow_mut() {
            if kind == sys::PETSC_ERROR_INITIAL {
                *report = Report { message, frames: Vec::new() };
            }
            report.frames.push(format!("{function}() at {file}:{line}"));
        }
    });
    code
}
