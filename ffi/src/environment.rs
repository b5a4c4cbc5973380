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
