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
/// Blocks of several megabytes get pages of their own again; smaller ones, which come and go in every iteration, do not.
pub fn return_freed_memory() {
    // glibc's malloc.h.
    const M_TRIM_THRESHOLD: i32 = -1;
    const M_MMAP_THRESHOLD: i32 = -3;
    const M_MMAP_MAX: i32 = -4;
    const OWN_PAGES: i32 = 4 << 20;
    unsafe extern "C" {
        fn mallopt(parameter: i32, value: i32) -> i32;
    }
    for (parameter, value) in [(M_MMAP_MAX, 1 << 16), (M_MMAP_THRESHOLD, OWN_PAGES), (M_TRIM_THRESHOLD, 16 * OWN_PAGES)]
    {
        // SAFETY: documented parameters; a value that malloc does not take changes nothing.
        unsafe { mallopt(parameter, value) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resident_kib() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().strip_suffix("kB").unwrap().trim().parse().unwrap()
    }

    #[test]
    fn freed_memory_is_given_back() {
        return_freed_memory();
        // The smallest block with pages of its own, many times, and what is allocated above it.
        let (blocks, kept): (Vec<_>, Vec<_>) = (0..64).map(|_| (vec![1u8; 5 << 20], vec![1u8; 1 << 10])).unzip();
        let full = resident_kib();
        drop(blocks);
        let left = resident_kib();
        assert!(full.saturating_sub(left) > 64 * 4 << 10, "{full} kB, then {left} kB");
        drop(kept);
    }
}
