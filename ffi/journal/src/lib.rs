//! HDF5 files that are changed as a whole or not at all, wherever the process is killed.
//!
//! HDF5 writes over its tables in any order as it closes a file, and a kill amid that leaves tables that refer to what is not
//! there. A [`Change`] is a driver of our own below the library. What HDF5 appends goes to the file, behind its end, where
//! nobody looks who does not know of it. What it writes over, a few pages of tables, stays in memory until the file is closed.
//! [`Change::commit`] then writes these pages to a journal beside the file, writes them over, and deletes the journal.
//! A process that is killed before the journal is complete leaves the file as it was; one that is killed later leaves the
//! journal, and [`recover`], with which each change begins, does what it says.
//!
//! HDF5 never hears of an error of the disk: it can neither close a file that it cannot write nor forget it. [`Change::commit`]
//! returns the first of them, and the file is as it was.

mod disk;
mod driver;

use disk::Disk;
use hdf5::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A change of a file that is under way, by one process. What is not committed has not happened.
#[derive(Debug)]
pub struct Change {
    path: PathBuf,
    disk: Arc<Mutex<Disk>>,
    file: Option<File>,
}

impl Change {
    /// Opens a file to change it, after what a journal says that is left of a change before.
    ///
    /// # Errors
    /// A file that is not there, cannot be written, or is none of HDF5's.
    pub fn begin(path: &Path) -> io::Result<Self> {
        recover(path)?;
        let disk = Arc::new(Mutex::new(Disk::open(path)?));
        let file = driver::open(path, &disk).map_err(|error| io::Error::other(error.to_string()))?;
        lock(&disk).begin();
        Ok(Self { path: path.to_path_buf(), disk, file: Some(file) })
    }

    /// The file as it will be.
    pub fn file(&self) -> &File {
        self.file.as_ref().expect("it is open until the change ends")
    }

    /// What the disk could not do until now, of which HDF5 says nothing, or something else.
    pub fn failure(&self) -> Option<String> {
        lock(&self.disk).failure()
    }

    /// Ends the change: the file is as HDF5 has it. What is open within the file must be closed.
    ///
    /// # Errors
    /// What the disk, or HDF5 as it closed the file, could not do; the file is then as it was. If the disk fails as tables are
    /// written over, the journal stays, for [`recover`].
    pub fn commit(mut self) -> io::Result<()> {
        let closed = self.close();
        lock(&self.disk).commit(closed, &journal(&self.path))
    }

    fn close(&mut self) -> io::Result<()> {
        let closed = self.file.take().map_or(Ok(()), File::close);
        closed.map_err(|error| io::Error::other(error.to_string()))
    }
}

impl Drop for Change {
    /// Takes the change back, if it has not been committed.
    fn drop(&mut self) {
        if self.file.is_some() {
            // What HDF5 writes now goes nowhere.
            lock(&self.disk).give_up();
            let _ = self.close();
            lock(&self.disk).go_back();
        }
    }
}

/// Does what the journal of a file says, if a process was killed while it changed the file.
///
/// # Errors
/// A file or journal that cannot be read or written.
pub fn recover(path: &Path) -> io::Result<()> {
    disk::recover(path, &journal(path))
}

/// The journal of a file.
pub fn journal(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".journal");
    name.into()
}

fn lock(disk: &Mutex<Disk>) -> MutexGuard<'_, Disk> {
    disk.lock().unwrap_or_else(PoisonError::into_inner)
}
