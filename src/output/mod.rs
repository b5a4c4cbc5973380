//! Everything a run writes into its output folder: fields for ParaView, force history, summary, log.
//!
//! Files that are replaced as a whole are renamed into place, the others are complete after every increment, so what
//! stands in the folder is readable at any time, also after a kill.

pub mod fields;
pub mod history;
pub mod log;
pub mod phases;
pub mod summary;
mod xdmf;

use crate::error::{Error, Result};
use crate::parallel::agree;
use mpi::traits::*;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What a run leaves in its folder, besides `scene.toml`, which the next run replaces.
pub const RUN: [&str; 5] = ["fields.xdmf", "fields.h5", "history.csv", "summary.json", "log.txt"];

/// The folder that a run writes to.
#[derive(Clone, Debug)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes the folder, or clears it of the files named `results` of an earlier run and of nothing else. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when the folder cannot be made or written.
    pub fn create(path: &Path, results: &[&str], comm: &impl Communicator) -> Result<Self> {
        let prepared = if comm.rank() == 0 { prepare(path, results) } else { Ok(()) };
        agree(comm, prepared.map_err(|error| not_writable(path, &error)))?;
        Ok(Self { path: path.to_path_buf() })
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes a file as a whole on rank 0; the `text` of other ranks does not count. Collective.
    ///
    /// # Errors
    /// [`Error::System`] on all ranks when the file cannot be written.
    pub fn write(&self, comm: &impl Communicator, name: &str, text: &str) -> Result<()> {
        agree(comm, if comm.rank() == 0 { replace(&self.file(name), text) } else { Ok(()) })
    }

    /// Writes `scene.toml`: `text`, the scene as run. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] when this would overwrite `source`, the file that the user wrote.
    pub fn write_scene(&self, comm: &impl Communicator, source: &Path, text: &str) -> Result<()> {
        let path = self.file("scene.toml");
        let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
        let result = if comm.rank() != 0 {
            Ok(())
        } else if same(source, &path) {
            Err(Error::input_anywhere(
                format!("the run would overwrite its own scene file {}", source.display()),
                "choose another folder with --out, or rename the scene file",
            ))
        } else {
            replace(&path, text)
        };
        agree(comm, result)
    }
}

/// Makes the folder and clears it; the probe file shows a folder that can be read but not written.
fn prepare(path: &Path, results: &[&str]) -> io::Result<()> {
    if path.exists() && !path.is_dir() {
        return Err(io::Error::other("it is a file"));
    }
    fs::create_dir_all(path)?;
    for name in results.iter().flat_map(|name| [name.to_string(), partial(name)]) {
        match fs::remove_file(path.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    let probe = path.join(partial("probe"));
    fs::write(&probe, "probe")?;
    fs::remove_file(&probe)
}

fn not_writable(path: &Path, error: &io::Error) -> Error {
    Error::input_anywhere(
        format!("cannot write to output folder {}: {error}", path.display()),
        "choose another folder with --out DIR",
    )
}

/// The name that a file has until it is complete.
fn partial(name: &str) -> String {
    format!("{name}.part")
}

/// Replaces a file as a whole: whoever opens it sees the old text or the new one.
fn replace(path: &Path, text: &str) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part = path.with_file_name(partial(&name));
    fs::write(&part, text).and_then(|()| fs::rename(&part, path)).map_err(|error| cannot_write(path, error))
}

/// The error of a file that became unwritable during the run.
fn cannot_write(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::System(format!("cannot write {}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_results_of_an_earlier_run_are_cleared() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out/case");
        prepare(&path, &RUN).unwrap();
        for name in RUN.into_iter().chain(["scene.toml", "notes.md", "fields.xdmf.part"]) {
            fs::write(path.join(name), "old").unwrap();
        }
        prepare(&path, &RUN).unwrap();
        let mut left: Vec<_> = fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["notes.md", "scene.toml"]);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_wrong_input() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        for path in [file.clone(), file.join("below"), PathBuf::from("/proc/nagata")] {
            let error = not_writable(&path, &prepare(&path, &RUN).unwrap_err());
            assert_eq!(error.exit_code(), 2);
            let text = error.to_string();
            assert!(text.contains(&format!("cannot write to output folder {}", path.display())), "{text}");
            assert!(text.contains("--out"), "{text}");
        }
    }

    #[test]
    fn a_file_is_replaced_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        replace(&path, "one").unwrap();
        replace(&path, "two").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let lost = replace(&folder.path().join("gone/summary.json"), "three").unwrap_err();
        assert!(lost.to_string().contains("gone/summary.json"), "{lost}");
        assert_eq!(lost.exit_code(), 3);
    }
}
