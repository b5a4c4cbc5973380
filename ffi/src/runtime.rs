//! Start and end of PETSc, its options and its log.

use std::ffi::{CString, c_char, c_int};
use std::fs::File;
use std::marker::PhantomData;
use std::mem::{MaybeUninit, forget};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

use crate::agree;
use crate::error::{Error, check, collect_reports, owned};
use crate::memory::settle_blas;
use crate::sys;

/// The running PETSc library; dropping it finalizes PETSc. Collective.
///
/// MPI must outlive it: keep the `Universe` of `mpi::initialize()` in a variable declared before.
pub struct Petsc<'c> {
    comm: &'c SimpleCommunicator,
    /// A duplicate for agreements, which thus never meet messages of the caller's.
    own: SimpleCommunicator,
    /// PETSc keeps a pointer to its command line.
    _arguments: Arguments,
    /// PETSc belongs to the thread that started it.
    _not_send: PhantomData<*const ()>,
}

/// PETSc starts once in a process.
static STARTED: AtomicBool = AtomicBool::new(false);

impl<'c> Petsc<'c> {
    /// Starts PETSc on the ranks of `comm`, with its signal handler off and its log of times on. Collective.
    ///
    /// `options` are PETSc's own, as on a command line: `["-snes_monitor", "-mat_mumps_icntl_14", "200"]`.
    /// Errors: a stray word among the options, an options file that cannot be read, a second start.
    pub fn initialize(comm: &'c SimpleCommunicator, options: &[String]) -> Result<Self, Error> {
        let own = comm.duplicate();
        let mut arguments = agree::agree(&own, check_options(options).and_then(|()| Arguments::new(options)))?;
        let again = STARTED.swap(true, Ordering::Relaxed);
        agree::agree(&own, if again { Err("PETSc has been started before".to_string()) } else { Ok(()) })?;
        if let Err(error) = agree::agree(&own, start(comm, &mut arguments).map_err(|error| error.0)) {
            // PETSc is in no state to be finalized, and may still point to them.
            forget(arguments);
            return Err(error);
        }
        Ok(Petsc { comm, own, _arguments: arguments, _not_send: PhantomData })
    }

    /// Takes the memory that the linear algebra would otherwise wait for without end when a limit leaves none. Collective.
    pub fn reserve_memory(&self) -> Result<(), Error> {
        self.agree(settle_blas())
    }

    /// PETSc's version, such as `3.18.5`.
    pub fn version() -> String {
        let mut number: [sys::PetscInt; 4] = [0; 4];
        let [major, minor, subminor, release] = &mut number;
        // SAFETY: writes four integers, and needs no running PETSc.
        unsafe { sys::PetscGetVersionNumber(major, minor, subminor, release) };
        format!("{major}.{minor}.{subminor}")
    }

    /// The communicator that all objects live on.
    pub fn communicator(&self) -> &'c SimpleCommunicator {
        self.comm
    }

    /// Sets an option, `name` without its dash, for objects made from now on. Same on all ranks.
    pub fn option(&self, name: &str, value: &str) -> Result<(), Error> {
        let (name, value) = (c_string(&format!("-{name}"))?, c_string(value)?);
        // SAFETY: two C strings, which PETSc copies, into the global options (NULL).
        check(unsafe { sys::PetscOptionsSetValue(null_mut(), name.as_ptr(), value.as_ptr()) })
    }

    /// Takes an option back, `name` without its dash.
    pub fn clear_option(&self, name: &str) -> Result<(), Error> {
        let name = c_string(&format!("-{name}"))?;
        // SAFETY: a C string, and the global options (NULL).
        check(unsafe { sys::PetscOptionsClearValue(null_mut(), name.as_ptr()) })
    }

    /// Whether an option, `name` without its dash, was given.
    pub fn has_option(&self, name: &str) -> Result<bool, Error> {
        let name = c_string(&format!("-{name}"))?;
        let mut found = 0;
        // SAFETY: a C string, and a place for the answer; NULLs are the global options and no prefix.
        check(unsafe { sys::PetscOptionsHasName(null_mut(), null(), name.as_ptr(), &mut found) })?;
        Ok(found != 0)
    }

    /// The options, without their dash, that nothing has asked for until now: misspelt ones, at the end of a run.
    pub fn unused_options(&self) -> Result<Vec<String>, Error> {
        let (mut count, mut names, mut values) = (0, null_mut(), null_mut());
        // SAFETY: `names` and `values` become arrays of `count` C strings that stay PETSc's.
        check(unsafe { sys::PetscOptionsLeftGet(null_mut(), &mut count, &mut names, &mut values) })?;
        // SAFETY: as above; read before they are given back.
        let unused = (0..count as usize).map(|i| unsafe { owned(*names.add(i)) }).collect();
        // SAFETY: gives back what the call above handed out.
        check(unsafe { sys::PetscOptionsLeftRestore(null_mut(), &mut count, &mut names, &mut values) })?;
        Ok(unused)
    }

    /// Seconds that this rank has spent in a logged event, such as `MatLUFactorNum`, `MatCholFctrNum`, `MatSolve`,
    /// `SNESFunctionEval`; 0 for an event that PETSc does not know (yet).
    pub fn log_seconds(&self, event: &str) -> Result<f64, Error> {
        Ok(self.log_event(event)?.map_or(0.0, |info| info.time))
    }

    /// How often this rank has been in a logged event.
    pub fn log_count(&self, event: &str) -> Result<usize, Error> {
        Ok(self.log_event(event)?.map_or(0, |info| info.count as usize))
    }

    /// Messages that PETSc has sent from this rank, and the bytes in them. Libraries below it, such as MUMPS, send more, which
    /// it does not know of.
    pub fn sent(&self) -> (u64, u64) {
        // SAFETY: plain numbers, which only PETSc writes, on this thread.
        let [messages, bytes] =
            unsafe { [sys::petsc_isend_ct + sys::petsc_send_ct, sys::petsc_isend_len + sys::petsc_send_len] };
        (messages as u64, bytes as u64)
    }

    fn log_event(&self, name: &str) -> Result<Option<sys::PetscEventPerfInfo>, Error> {
        const MAIN_STAGE: c_int = 0;
        let (name, mut event) = (c_string(name)?, -1);
        // SAFETY: a C string, and a place for the answer.
        check(unsafe { sys::PetscLogEventGetId(name.as_ptr(), &mut event) })?;
        if event < 0 {
            return Ok(None);
        }
        let mut info = MaybeUninit::zeroed();
        // SAFETY: the event exists, and stage 0 always does; the call fills `info`.
        check(unsafe { sys::PetscLogEventGetPerfInfo(MAIN_STAGE, event, info.as_mut_ptr()) })?;
        // SAFETY: plain numbers, for which zeros are valid too.
        Ok(Some(unsafe { info.assume_init() }))
    }

    /// Gives every rank its own value if all have one, and otherwise every rank the error of the lowest that has none.
    /// Collective.
    pub fn agree<T>(&self, mine: Result<T, String>) -> Result<T, Error> {
        agree::agree(&self.own, mine)
    }

    /// Whether the condition holds on any rank. Collective.
    pub(crate) fn any(&self, mine: bool) -> bool {
        let mut any = false;
        self.own.all_reduce_into(&mine, &mut any, SystemOperation::logical_or());
        any
    }

    /// An error on all ranks unless the condition holds on all. Collective.
    pub(crate) fn require(&self, condition: bool, otherwise: impl FnOnce() -> String) -> Result<(), Error> {
        self.agree(if condition { Ok(()) } else { Err(otherwise()) })
    }

    /// The communicator for agreements.
    pub(crate) fn own(&self) -> &SimpleCommunicator {
        &self.own
    }

    /// The communicator of all objects, for calls to PETSc.
    pub(crate) fn raw_comm(&self) -> mpi::ffi::MPI_Comm {
        self.comm.as_raw()
    }
}

impl Drop for Petsc<'_> {
    fn drop(&mut self) {
        // SAFETY: PETSc runs, and no object of this crate is left: they borrow `self`.
        unsafe { sys::PetscFinalize() };
    }
}

/// Starts PETSc with the error handler in place.
fn start(comm: &SimpleCommunicator, arguments: &mut Arguments) -> Result<(), Error> {
    // SAFETY: PETSc asks for this variable to be set before it starts, and no other thread uses PETSc.
    unsafe { sys::PETSC_COMM_WORLD = comm.as_raw() };
    collect_reports()?;
    let (count, pointers) = (arguments.strings.len() as c_int, arguments.pointers.as_mut_ptr());
    // SAFETY: MPI runs, since `comm` exists; the arguments are `count` C strings and a NULL, and live as long as PETSc.
    check(unsafe { sys::PetscInitializeNoPointers(count, pointers, null(), null()) })?;
    // SAFETY: PETSc runs.
    check(unsafe { sys::PetscLogDefaultBegin() })
}

/// A command line as `main` has it in C.
struct Arguments {
    /// The owners of the text.
    strings: Vec<CString>,
    /// Pointers to them, and a NULL.
    pointers: Vec<*mut c_char>,
}

impl Arguments {
    fn new(options: &[String]) -> Result<Self, String> {
        // PETSc's signal handler would make a crash silent, as the error handler prints nothing.
        let own = ["nagata", "-no_signal_handler"].into_iter().chain(options.iter().map(String::as_str));
        let strings = own.map(|text| c_string(text).map_err(|error| error.0)).collect::<Result<Vec<_>, _>>()?;
        let pointers = strings.iter().map(|text| text.as_ptr().cast_mut()).chain([null_mut()]).collect();
        Ok(Self { strings, pointers })
    }
}

/// Finds what PETSc would pass over in silence, or would fail to read on rank 0 while the others wait.
fn check_options(options: &[String]) -> Result<(), String> {
    let is_name = |word: &str| {
        word.strip_prefix('-')
            .is_some_and(|rest| rest.trim_start_matches('-').starts_with(|c: char| c.is_ascii_alphabetic()))
    };
    let mut name: Option<&str> = None;
    for word in options {
        if is_name(word) {
            name = Some(word);
            continue;
        }
        let Some(option) = name.take() else {
            return Err(format!("PETSc option expected, found `{word}`: a name with a dash and one value at most"));
        };
        if matches!(option, "-options_file" | "-options_file_yaml") {
            File::open(word).map_err(|error| format!("PETSc option {option} {word}: {error}"))?;
        }
    }
    Ok(())
}

/// Text for PETSc.
pub(crate) fn c_string(text: &str) -> Result<CString, Error> {
    CString::new(text).map_err(|_| Error(format!("text for PETSc with a NUL character: {text:?}")))
}

#[cfg(test)]
mod tests {
    use super::check_options;

    fn check(line: &str) -> Result<(), String> {
        check_options(&line.split_whitespace().map(String::from).collect::<Vec<_>>())
    }

    #[test]
    fn options_are_names_with_a_value_at_most() {
        for good in ["", "-snes_monitor", "-mat_mumps_icntl_14 200 -snes_monitor", "-mat_mumps_cntl_3 -1e-9", "--a 1"] {
            assert_eq!(check(good), Ok(()), "{good}");
        }
        for (bad, word) in [("snes_monitor", "snes_monitor"), ("-a 1 2", "2"), ("-3", "-3")] {
            assert!(check(bad).unwrap_err().contains(&format!("`{word}`")), "{bad}");
        }
        assert!(check("-options_file /none/such").unwrap_err().contains("/none/such"));
    }
}
