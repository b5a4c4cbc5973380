//! What ends a run whatever increment is tried: a signal, or want of memory. What has converged is kept.

use crate::error::Error;
use crate::interrupt;
use mpi::traits::*;
use petsc::{LinearFailure, Reason};

/// The error that ends the run after this iteration, if it must; `at` is the step and the time of the last converged
/// increment, and `iterates` whether multigrid was tried. Collective when `interrupted`, which is the same on all ranks, as is
/// the `reason`.
pub(super) fn at_once(
    comm: &impl Communicator,
    at: (&str, f64),
    (interrupted, iterates): (bool, bool),
    reason: &Reason,
) -> Option<Error> {
    match reason {
        Reason::Linear(failure @ LinearFailure::Memory { .. }) => Some(out_of_memory(at, failure, iterates)),
        _ if interrupted => Some(by_signal(comm, at)),
        _ => None,
    }
}

/// The error of a run that a signal ends. Collective.
pub(super) fn by_signal(comm: &impl Communicator, (step, time): (&str, f64)) -> Error {
    let signal = interrupt::signal(comm);
    Error::Interrupted(format!(
        "{signal} ended the run in step `{step}`, after time {time:.6}; what converged until then is kept"
    ))
}

fn out_of_memory((step, time): (&str, f64), failure: &LinearFailure, iterates: bool) -> Error {
    let other = match iterates {
        true => "multigrid had been tried, and did not converge",
        false => "`linear = \"iterative\"` takes less",
    };
    Error::System(format!(
        "step `{step}`, after time {time:.6}: {failure}\n  \
         help: run on more memory, or machines, or with fewer unknowns, and with room for the factors in the folder of the run; \
         {other}; `-- -mat_mumps_icntl_14 20` reserves less"
    ))
}
