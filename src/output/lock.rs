//! One run at a time writes into a folder: it holds a lock, which the system takes back when the process ends, however it
//! ends.

use std::fs::{File, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// The file that is locked; it is gone after a run that was not killed.
const NAME: &str = ".lock";

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    file: File,
}

/// What came of taking a lock.
#[derive(Debug)]
pub(super) enum Taken {
    Held(Lock),
    /// By another process, in its own words.
    ByAnother(String),
    /// The file system has no locks.
    Unknown(io::Error),
}

impl Lock {
    /// Takes the lock of a folder that exists.
    pub(super) fn take(folder: &Path) -> io::Result<Taken> {
        let path = folder.join(NAME);
        loop {
            let mut file = File::options().read(true).write(true).create(true).truncate(false).open(&path)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let mut holder = String::new();
                    let _ = file.read_to_string(&mut holder);
                    return Ok(Taken::ByAnother(holder.trim().to_string()));
                }
                Err(TryLockError::Error(error)) => return Ok(Taken::Unknown(error)),
            }
            // The run before may have removed the file since it was opened: others would lock a new one.
            if is_at(&file, &path) {
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(this_process().as_bytes())?;
                return Ok(Taken::Held(Self { path, file }));
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is locked, lest it is another's by now.
        if is_at(&self.file, &self.path) {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Whether a run holds the lock of a folder; `None` where the file system has no locks.
pub(super) fn is_held(folder: &Path) -> Option<bool> {
    let Ok(file) = File::open(folder.join(NAME)) else { return Some(false) };
    match file.try_lock_shared() {
        Ok(()) => Some(false),
        Err(TryLockError::WouldBlock) => Some(true),
        Err(TryLockError::Error(_)) => None,
    }
}

/// Whether an open file is what stands at a path.
fn is_at(file: &File, path: &Path) -> bool {
    matches!((file.metadata(), path.metadata()), (Ok(a), Ok(b)) if (a.dev(), a.ino()) == (b.dev(), b.ino()))
}

fn this_process() -> String {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    format!("process {} on {}\n", std::process::id(), host.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_locked_once() {
        let folder = tempfile::tempdir().unwrap();
        let take = || Lock::take(folder.path()).unwrap();
        assert_eq!(is_held(folder.path()), Some(false));
        let Taken::Held(first) = take() else { panic!() };
        assert_eq!(is_held(folder.path()), Some(true));
        let Taken::ByAnother(holder) = take() else { panic!() };
        assert!(holder.starts_with(&format!("process {} on ", std::process::id())), "{holder}");
        drop(first);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(matches!(take(), Taken::Held(_)));
    }

    #[test]
    fn a_lock_that_a_kill_left_is_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(NAME), "process 1 on the moon, long ago\n").unwrap();
        assert_eq!(is_held(folder.path()), Some(false));
        let Taken::Held(_held) = Lock::take(folder.path()).unwrap() else { panic!() };
        let text = std::fs::read_to_string(folder.path().join(NAME)).unwrap();
        assert_eq!(text, this_process());
    }
}
