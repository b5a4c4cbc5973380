//! What memory a rank may still take, and the buffer of OpenBLAS, which must be had before it runs short.

use std::fs::read_to_string;
use std::ptr::null_mut;

use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

use crate::error::check;
use crate::sys;

/// What OpenBLAS reserves at the first product of matrices, bytes: its `BUFFER_SIZE` on x86-64.
const BLAS_BUFFER: u64 = 128 << 20;

/// What MPI and PETSc map as they start, bytes: Open MPI 4.1 with its components and PETSc 3.18, as measured.
const STARTING: u64 = 200 << 20;

/// Address space that this process may still take, bytes; `None` without a limit (`ulimit -v`).
pub fn address_space_left() -> Option<u64> {
    let read = |file: &str| read_to_string(file).unwrap_or_default();
    left(&read("/proc/self/limits"), &read("/proc/self/status"))
}

fn left(limits: &str, status: &str) -> Option<u64> {
    let number = |text: &str, key: &str| -> Option<u64> {
        text.lines().find_map(|line| line.strip_prefix(key))?.split_whitespace().next()?.parse().ok()
    };
    let limit = number(limits, "Max address space")?;
    Some(limit.saturating_sub(number(status, "VmSize:").unwrap_or(0) << 10))
}

/// Memory that each rank may still take, bytes, where the machine or a container's limit tells: what is free, by the ranks that
/// share it. Collective.
pub(crate) fn left_for_each(comm: &SimpleCommunicator) -> Option<u64> {
    let sharing = comm.split_shared(0).size() as u64;
    let read = |file: &str| read_to_string(file).unwrap_or_default();
    let number = |file: &str| read(file).trim().parse::<u64>().ok();
    let of_group = |folder: &str, [most, taken, cached]: [&str; 3]| {
        let cached = cached_files(&read(&format!("{folder}/memory.stat")), cached);
        Some((number(&format!("{folder}/{most}"))? + cached).saturating_sub(number(&format!("{folder}/{taken}"))?))
    };
    let shared = [
        free(&read("/proc/meminfo")),
        of_group("/sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file"]),
        of_group("/sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"]),
    ];
    let shared = shared.into_iter().flatten().min().map(|bytes| bytes / sharing);
    shared.into_iter().chain(address_space_left()).min()
}

/// What a group of processes holds of files that it does not use, which goes as soon as memory is asked for, bytes.
fn cached_files(stat: &str, key: &str) -> u64 {
    let of_key = |line: &str| line.strip_prefix(key)?.trim().parse().ok();
    stat.lines().find_map(of_key).unwrap_or(0)
}

/// What of /proc/meminfo can be had, bytes.
fn free(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? << 10)
}

/// What is to be said before MPI starts if less is left than the program cannot do without. MPI would fail to load its
/// components with less, and not say why, or crash.
pub fn enough_to_start() -> Result<(), String> {
    enough(STARTING + BLAS_BUFFER, "MPI, PETSc and the linear algebra take")
}

fn enough(least: u64, what: &str) -> Result<(), String> {
    match address_space_left().filter(|left| *left < least) {
        None => Ok(()),
        Some(left) => Err(format!(
            "not enough memory to start: {} MB of address space are left of the limit (`ulimit -v`), and {what} {} MB",
            left >> 20,
            least >> 20
        )),
    }
}

/// Lets OpenBLAS take its buffer now: it keeps it, and without memory for it would try again for ever.
pub(crate) fn settle_blas() -> Result<(), String> {
    enough(BLAS_BUFFER, "the linear algebra alone takes")?;
    // Large enough to be no small product, which needs no buffer.
    const SIZE: i32 = 128;
    let alone = SimpleCommunicator::self_comm();
    let (mut a, mut product) = (null_mut(), null_mut());
    // SAFETY: PETSc runs; NULL lets it allocate the entries, which are zero; the handles are destroyed once.
    let done = unsafe {
        check(sys::MatCreateSeqDense(alone.as_raw(), SIZE, SIZE, null_mut(), &mut a))
            .and_then(|()| check(sys::MatAssemblyBegin(a, sys::MAT_FINAL_ASSEMBLY)))
            .and_then(|()| check(sys::MatAssemblyEnd(a, sys::MAT_FINAL_ASSEMBLY)))
            .and_then(|()| check(sys::MatMatMult(a, a, sys::MAT_INITIAL_MATRIX, 1.0, &mut product)))
    };
    // SAFETY: NULL, or live matrices that nobody else holds.
    unsafe {
        sys::MatDestroy(&mut product);
        sys::MatDestroy(&mut a);
    }
    done.map_err(String::from)
}

#[cfg(test)]
mod tests {
    use super::{cached_files, free, left};

    #[test]
    fn what_is_left_is_the_limit_less_what_is_taken() {
        let limits = |limit: &str| format!("Limit  Soft\nMax address space         {limit}   unlimited  bytes\n");
        let status = "Name:\tx\nVmPeak:\t  900 kB\nVmSize:\t  300 kB\n";
        assert_eq!(left(&limits("1024000"), status), Some(1024000 - 300 * 1024));
        assert_eq!(left(&limits("1024"), status), Some(0));
        assert_eq!(left(&limits("unlimited"), status), None);
        assert_eq!(left("", status), None);
    }

    #[test]
    fn what_is_free_is_read() {
        assert_eq!(free("MemTotal: 9 kB\nMemFree: 1 kB\nMemAvailable:    8 kB\n"), Some(8192));
        assert_eq!(free("MemTotal: 9 kB\n"), None);
        let stat = "anon 7\ninactive_anon 3\ninactive_file 4096\n";
        assert_eq!((cached_files(stat, "inactive_file"), cached_files("", "inactive_file")), (4096, 0));
    }
}
