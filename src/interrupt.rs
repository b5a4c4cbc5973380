//! A wish that the run end, sent as a signal: it ends after the current iteration, on all ranks together, whichever got it.
//!
//! SIGINT is Ctrl-C; SIGTERM comes from `kill` and from batch systems. `mpirun` itself ends its ranks one second after
//! either, but passes SIGUSR1 on as it is.

use crate::error::{Error, Result};
use mpi::collective::SystemOperation;
use mpi::traits::*;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};
use signal_hook::flag;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

/// The last of the signals that this rank got; 0 without one.
static GOT: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// From now on signals are wishes. A second Ctrl-C ends this process at once.
///
/// # Errors
/// [`Error::System`] when the system does not let it.
pub fn heed() -> Result<()> {
    let register = || -> io::Result<()> {
        let insisting = Arc::new(AtomicBool::new(false));
        flag::register_conditional_default(SIGINT, insisting.clone())?;
        flag::register(SIGINT, insisting)?;
        for signal in [SIGINT, SIGTERM, SIGUSR1] {
            flag::register_usize(signal, GOT.clone(), signal as usize)?;
        }
        Ok(())
    };
    register().map_err(|error| Error::System(format!("signals cannot be received: {error}")))
}

/// Makes a write beyond the largest size of files (`ulimit -f`) an error, as on a full disk, instead of the end.
pub fn outlive_file_limit() {
    // Without it, such a write ends the process, as before.
    let _ = flag::register(SIGXFSZ, Arc::default());
}

/// Whether this rank got a signal.
pub fn wished() -> bool {
    GOT.load(Ordering::Relaxed) != 0
}

/// The signal that some rank got, by name; the same on all ranks. Collective.
pub fn signal(comm: &impl Communicator) -> &'static str {
    let (own, mut highest) = (GOT.load(Ordering::Relaxed) as i32, 0);
    comm.all_reduce_into(&own, &mut highest, SystemOperation::max());
    match highest {
        SIGINT => "SIGINT",
        SIGTERM => "SIGTERM",
        SIGUSR1 => "SIGUSR1",
        _ => "a signal",
    }
}
