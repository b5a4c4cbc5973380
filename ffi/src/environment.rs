//! Settings of libraries that must be made before they start.

/// Sets a variable that the user has not set, for libraries that start later in this process.
///
/// Does nothing once the process has a second thread, where changing the environment would be unsound.
pub fn set_default(name: &str, value: &str) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let alone = status.lines().any(|line| line.strip_prefix("Threads:").is_some_and(|n| n.trim() == "1"));
    if alone && std::env::var_os(name).is_none() {
        // SAFETY: no other thread can read the environment, there is none.
        unsafe { std::env::set_var(name, value) };
    }
}

/// Keeps HDF5 from closing its files when the process exits, or when MPI ends: after a write that failed it does so twice and
/// crashes. Files must be closed before. Call it before MPI is initialized: HDF5 ties its end to that of an MPI it finds.
pub fn leave_hdf5_at_exit() {
    // SAFETY: no arguments, and no HDF5 call before them.
    unsafe {
        hdf5_sys::h5::H5dont_atexit();
        hdf5_sys::h5::H5open();
    }
}

/// Ends the process once MPI has ended, without what libraries do at exit: a thread that one of them has left running then meets
/// what another has taken down, and the process ends by a signal after all is done. What they still have to print is printed.
pub fn leave(code: i32) -> ! {
    use std::ffi::{c_char, c_int, c_void};
    use std::io::Write as _;
    unsafe extern "C" {
        fn fflush(stream: *mut c_void) -> c_int;
        fn dlsym(handle: *mut c_void, symbol: *const c_char) -> *mut c_void;
        fn _exit(code: c_int) -> !;
    }
    let _ = std::io::stdout().flush();
    // SAFETY: no stream means all of them, no handle the whole process; the Fortran library has this function since its
    // beginning, and no unit means all of them, too. Nothing runs after `_exit`.
    unsafe {
        fflush(std::ptr::null_mut());
        let flush = dlsym(std::ptr::null_mut(), c"_gfortran_flush_i4".as_ptr());
        if !flush.is_null() {
            let flush: extern "C" fn(*const i32) = std::mem::transmute(flush);
            flush(std::ptr::null());
        }
        _exit(code)
    }
}

/// Lets the process give memory back that it has freed. SuperLU_DIST, which PETSc is linked with, keeps malloc from it as
/// soon as it is loaded (CombBLAS sets M_MMAP_MAX to 0): the largest array of every phase would stay beside all others.
///
/// Only large blocks get pages of their own again, as many megabytes as malloc allows: smaller ones come and go in every
/// iteration, and new pages for them took 6 % of the time of a solve.
pub fn return_freed_memory() {
    // glibc's malloc.h.
    const M_TRIM_THRESHOLD: i32 = -1;
    const M_MMAP_THRESHOLD: i32 = -3;
    const M_MMAP_MAX: i32 = -4;
    const OWN_PAGES: i32 = 32 << 20;
    unsafe extern "C" {
        fn mallopt(parameter: i32, value: i32) -> i32;
    }
    for (parameter, value) in [(M_MMAP_MAX, 1 << 16), (M_MMAP_THRESHOLD, OWN_PAGES), (M_TRIM_THRESHOLD, 4 * OWN_PAGES)]
    {
        // SAFETY: documented parameters; a value that malloc does not take changes nothing.
        unsafe { mallopt(parameter, value) };
    }
}
