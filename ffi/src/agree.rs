//! Agreement of all ranks on what one of them met, before any of them acts on it.
//!
//! PETSc's solvers are collective: a rank that leaves one alone, by an error or a panic, lets the others wait for ever.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

use crate::error::Error;

/// Gives every rank its own value if all have one, and otherwise every rank the error of the lowest that has none.
/// Collective.
pub fn agree<T>(comm: &SimpleCommunicator, mine: Result<T, String>) -> Result<T, Error> {
    match mine {
        Ok(value) => agree_on_level(comm, Ok(0)).map(|_| value),
        Err(error) => {
            let agreed = agree_on_level(comm, Err(error.clone()));
            Err(agreed.err().unwrap_or(Error(error)))
        }
    }
}

/// The highest level (0 or a small number) of all ranks, or the error of the lowest rank that has one. Collective.
pub fn agree_on_level(comm: &SimpleCommunicator, mine: Result<i32, String>) -> Result<i32, Error> {
    // Errors stand above all levels, the lowest rank's on top.
    let encoded = mine.as_ref().map_or(i32::MAX - comm.rank(), |&level| level);
    let mut highest = 0;
    comm.all_reduce_into(&encoded, &mut highest, SystemOperation::max());
    if highest <= i32::MAX - comm.size() {
        return Ok(highest);
    }
    let speaker = comm.process_at_rank(i32::MAX - highest);
    let mut message = mine.err().unwrap_or_default().into_bytes();
    let mut length = message.len() as u64;
    speaker.broadcast_into(&mut length);
    message.resize(length as usize, 0);
    speaker.broadcast_into(&mut message[..]);
    Err(Error(String::from_utf8_lossy(&message).into_owned()))
}

/// Runs a callback of the user's on all ranks and agrees on its level. A panic is an error. Collective.
pub fn agree_on_call(comm: &SimpleCommunicator, callback: impl FnOnce() -> Result<i32, String>) -> Result<i32, Error> {
    let mine = catch_unwind(AssertUnwindSafe(callback))
        .unwrap_or_else(|panic| Err(format!("panic on rank {}: {}", comm.rank(), panic_text(panic.as_ref()))));
    agree_on_level(comm, mine)
}

/// The words of a panic.
fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}
