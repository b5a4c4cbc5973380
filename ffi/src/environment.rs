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
