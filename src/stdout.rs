//! What commands print. It is written or an error, unless who reads it has stopped.

use crate::error::{Error, Result};
use crate::parallel::agree;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::io::{ErrorKind, Write as _};

/// Prints a text, from a process without MPI.
///
/// # Errors
/// [`Error::System`] when it cannot be written.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::System(format!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Rank 0 prints its text. Collective.
///
/// # Errors
/// As of [`print()`], on all ranks.
pub fn print_from_root(comm: &SimpleCommunicator, text: &str) -> Result<()> {
    agree(comm, if comm.rank() == 0 { print(text) } else { Ok(()) })
}
