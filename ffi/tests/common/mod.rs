//! Runs the body of a test on several MPI ranks, and small distributed systems to run it on.
#![allow(dead_code)] // each test program uses a part

use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::Command;

use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{Matrix, Petsc, Vector};

const WORKER: &str = "PETSC_TEST_WORKER";

/// Runs `body` on each of these numbers of ranks, by starting this test alone in this program again under `mpirun`.
/// The harness's own process never starts MPI. A rank that fails ends all.
pub fn on_ranks(test: &str, ranks: &[usize], body: impl FnOnce(&SimpleCommunicator)) {
    if env::var_os(WORKER).is_some() {
        let universe = mpi::initialize().expect("MPI has not been started");
        let world = universe.world();
        if catch_unwind(AssertUnwindSafe(|| body(&world))).is_err() {
            world.abort(1);
        }
        return;
    }
    for count in ranks {
        let output = Command::new("mpirun")
            .args(["-n", &count.to_string(), "--bind-to", "none", "--timeout", "60"])
            .arg(env::current_exe().expect("a program has a path"))
            .args(["--exact", test, "--test-threads=1", "--nocapture"])
            .envs([(WORKER, "1"), ("PETSC_OPTIONS", "-objects_dump")])
            .env_remove("RUST_BACKTRACE")
            .envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")])
            .envs([("OMPI_MCA_rmaps_base_oversubscribe", "1"), ("OMPI_MCA_mpi_yield_when_idle", "1")])
            .envs([("OMPI_MCA_pml", "ob1"), ("OMPI_MCA_btl", "self,vader")])
            .envs([("OPENBLAS_NUM_THREADS", "1"), ("SCOTCH_PTHREAD_NUMBER", "1")])
            .output()
            .expect("mpirun starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
        let ran = stdout.contains("1 passed"); // not the case for a misspelt name
        assert!(output.status.success() && ran, "`{test}` on {count} ranks\n{stdout}\n{stderr}");
        assert!(!stdout.contains("never freed"), "`{test}` on {count} ranks leaks\n{stdout}");
    }
}

/// Like [`on_ranks`] with PETSc running, started with these options.
pub fn with_petsc(test: &str, ranks: &[usize], options: &str, body: impl FnOnce(&Petsc)) {
    on_ranks(test, ranks, |world| {
        let options: Vec<String> = options.split_whitespace().map(String::from).collect();
        let petsc = Petsc::initialize(world, &options).expect("PETSc starts");
        body(&petsc);
    });
}

/// The rows of this rank out of `total`: an equal share, but none on rank 1 of 3.
pub fn own_rows(petsc: &Petsc, total: usize) -> std::ops::Range<usize> {
    let (rank, size) = (petsc.communicator().rank(), petsc.communicator().size());
    match (rank, size) {
        (0, 1) => 0..total,
        (0, _) => 0..total / 2,
        (1, 3) => total / 2..total / 2,
        _ => total / 2..total,
    }
}

/// The rows of this rank of a matrix that is given whole, as compressed rows without zeros.
pub fn compress(rows: std::ops::Range<usize>, dense: &[Vec<f64>]) -> (Vec<i32>, Vec<i32>, Vec<f64>) {
    let (mut offsets, mut columns, mut values) = (vec![0], vec![], vec![]);
    for row in &dense[rows] {
        for (column, &value) in row.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            columns.push(column as i32);
            values.push(value);
        }
        offsets.push(columns.len() as i32);
    }
    (offsets, columns, values)
}

/// A distributed matrix from a whole one.
pub fn matrix<'p>(petsc: &'p Petsc<'p>, dense: &[Vec<f64>]) -> Matrix<'p> {
    let rows = own_rows(petsc, dense.len());
    let (offsets, columns, values) = compress(rows.clone(), dense);
    Matrix::from_csr(petsc, rows.len(), &offsets, &columns, &values).unwrap()
}

/// A distributed vector from a whole one.
pub fn vector<'p>(petsc: &'p Petsc<'p>, whole: &[f64]) -> Vector<'p> {
    Vector::from_slice(petsc, &whole[own_rows(petsc, whole.len())]).unwrap()
}

pub fn product(dense: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    dense.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}

/// A symmetric saddle point [K C^T; C 0] of a chain of `n` springs and `m` ties of its masses to points.
pub fn saddle_point(n: usize, m: usize) -> Vec<Vec<f64>> {
    let mut dense = vec![vec![0.0; n + m]; n + m];
    for i in 0..n {
        dense[i][i] = 2.1e5;
        if i + 1 < n {
            (dense[i][i + 1], dense[i + 1][i]) = (-1e5, -1e5);
        }
    }
    for j in 0..m {
        let i = (j + 1) * n / (m + 1);
        (dense[n + j][i], dense[i][n + j]) = (1.0, 1.0);
    }
    dense
}
