//! Everything a run writes into its output folder: fields for ParaView, force history, summary, log.
//!
//! Files that are replaced as a whole are renamed into place, those of HDF5 change as a whole, and the others are complete
//! after every increment, so what stands in the folder is readable at any time, also after a kill.

pub mod checkpoint;
pub mod fields;
pub mod figure;
pub mod history;
mod lock;
pub mod log;
pub mod phases;
pub mod quantity;
mod rows;
pub mod summary;
mod vtkhdf;
mod xdmf;

use crate::error::{Error, Result};
use crate::parallel::agree;
use lock::{Lock, Taken};
use mpi::traits::*;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What a run leaves in its folder, and the next run replaces.
pub const RUN: [&str; 10] = [
    "fields.xdmf",
    "fields.h5",
    "failed.xdmf",
    "failed.h5",
    "history.csv",
    "summary.json",
    "log.txt",
    "scene.toml",
    "report.html",
    checkpoint::NAME,
];

/// How the names of MUMPS's files begin that hold the factors that memory does not; those of a killed run stay.
pub const FACTORS: &str = "factors";

/// Whether a run writes into a folder now; `None` where the file system has no locks.
pub fn is_being_written(folder: &Path) -> Option<bool> {
    lock::is_held(folder)
}

/// What the next run into a folder replaces: [`RUN`], and the tables of all probes and the single grids that are there.
pub fn results_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let ends = [("probe-", ".csv"), ("fields-", ".xdmf"), ("fields-", ".vtkhdf")];
    let is_result = |name: &String| ends.iter().any(|(start, end)| name.starts_with(start) && name.ends_with(end));
    RUN.iter().map(ToString::to_string).chain(names.filter(is_result)).collect()
}

/// The folder that a run writes to, and no other while this one lives.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// On rank 0 alone, where the file system has locks.
    _lock: Option<Lock>,
}

/// A file that the run reads, with what it is.
pub type Input<'a> = (&'static str, &'a Path);

impl OutputFolder {
    /// Makes the folder, or clears it of the files named `results` of an earlier run and of nothing else; deletes nothing
    /// unless all is well. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when the folder cannot be made or written, when another run writes into it, or when
    /// one of the `results` is one of the `inputs`.
    pub fn create(path: &Path, results: &[&str], inputs: &[Input], comm: &impl Communicator) -> Result<Self> {
        let prepared = if comm.rank() == 0 { prepare(path, results, inputs) } else { Ok(None) };
        Ok(Self { path: path.to_path_buf(), _lock: agree(comm, prepared)? })
    }

    /// The folder of an earlier run, to go on in it: nothing is cleared. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there is none, when it cannot be written, or when another run writes into it.
    pub fn reopen(path: &Path, comm: &impl Communicator) -> Result<Self> {
        let prepare = || if path.is_dir() { prepare(path, &[], &[]) } else { Err(not_there(path)) };
        let prepared = if comm.rank() == 0 { prepare() } else { Ok(None) };
        Ok(Self { path: path.to_path_buf(), _lock: agree(comm, prepared)? })
    }

    /// The folder of one process alone, from which nothing is cleared.
    ///
    /// # Errors
    /// [`Error::Input`] when the folder cannot be made or written, or when another run writes into it.
    pub fn of_this_process(path: &Path) -> Result<Self> {
        Ok(Self { path: path.to_path_buf(), _lock: prepare(path, &[], &[])? })
    }

    /// Writes a file as a whole, in a folder [of this process](Self::of_this_process).
    ///
    /// # Errors
    /// [`Error::System`] when the file cannot be written.
    pub fn replace(&self, name: &str, text: &str) -> Result<()> {
        replace(&self.file(name), text)
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Deletes these files, where they are there: they no longer tell how the run stands. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when the folder cannot be written.
    pub fn discard(&self, comm: &impl Communicator, names: &[&str]) -> Result<()> {
        let discard = || clear(&self.path, names).map_err(|error| not_writable(&self.path, &error));
        agree(comm, if comm.rank() == 0 { discard() } else { Ok(()) })
    }

    /// Writes a file as a whole on rank 0; the `text` of other ranks does not count. Collective.
    ///
    /// # Errors
    /// [`Error::System`] on all ranks when the file cannot be written.
    pub fn write(&self, comm: &impl Communicator, name: &str, text: &str) -> Result<()> {
        agree(comm, if comm.rank() == 0 { replace(&self.file(name), text) } else { Ok(()) })
    }
}

/// Makes the folder and clears it, unless another run or an input is in the way.
fn prepare(path: &Path, results: &[&str], inputs: &[Input]) -> Result<Option<Lock>> {
    make(path).map_err(|error| not_writable(path, &error))?;
    let lock = match Lock::take(path).map_err(|error| not_writable(path, &error))? {
        Taken::Held(lock) => Some(lock),
        Taken::ByAnother(holder) => return Err(in_use(path, &holder)),
        Taken::Unknown(error) => {
            eprintln!("warning: {} cannot be locked ({error}): let no other run write into it", path.display());
            None
        }
    };
    let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    let lost = |input: &&Input| results.iter().any(|name| same(input.1, &path.join(name)));
    if let Some((what, input)) = inputs.iter().find(lost) {
        let what = format!("the run would overwrite its own {what} {}", input.display());
        return Err(Error::input_anywhere(what, "choose another folder with --out, or rename the file"));
    }
    clear(path, results).and_then(|()| clear_factors(path)).map_err(|error| not_writable(path, &error))?;
    Ok(lock)
}

/// Makes the folder; the probe file shows one that can be read but not written.
fn make(path: &Path) -> io::Result<()> {
    if path.exists() && !path.is_dir() {
        return Err(io::Error::other("it is a file"));
    }
    fs::create_dir_all(path)?;
    let probe = path.join(partial("probe"));
    fs::write(&probe, "probe")?;
    fs::remove_file(&probe)
}

/// Deletes what an earlier run left.
fn clear(path: &Path, results: &[&str]) -> io::Result<()> {
    let files = results.iter().flat_map(|name| [name.to_string(), partial(name)]).map(|name| path.join(name));
    files.flat_map(|file| [journal::journal(&file), file]).try_for_each(|file| remove(&file))
}

/// Deletes what a run that was killed left of its factors.
fn clear_factors(path: &Path) -> io::Result<()> {
    let start = format!("{FACTORS}_mumps_");
    let is_left = |file: &PathBuf| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&start));
    fs::read_dir(path)?.flatten().map(|entry| entry.path()).filter(is_left).try_for_each(|file| remove(&file))
}

/// Deletes a file that may not be there.
fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn not_there(path: &Path) -> Error {
    Error::input_anywhere(
        format!("there is no run to go on with: no folder {}", path.display()),
        "give its folder with --out DIR, or run without --restart",
    )
}

/// Opens a file that an earlier run wrote line by line, cut to the length that it had at a checkpoint, to write on.
fn go_on(path: &Path, length: u64) -> io::Result<fs::File> {
    let file = fs::OpenOptions::new().append(true).open(path)?;
    if file.metadata()?.len() < length {
        return Err(io::Error::other(format!("it is shorter than at the checkpoint, when it had {length} bytes")));
    }
    file.set_len(length)?;
    Ok(file)
}

/// Bytes in an open file; zero without one.
fn length(file: Option<&fs::File>) -> u64 {
    file.and_then(|file| file.metadata().ok()).map_or(0, |data| data.len())
}

fn cannot_go_on(path: &Path, what: impl std::fmt::Display, help: &str) -> Error {
    Error::input_anywhere(format!("cannot go on with {}: {what}", path.display()), help)
}

fn in_use(path: &Path, holder: &str) -> Error {
    let by = if holder.is_empty() { String::new() } else { format!(", {holder}") };
    Error::input_anywhere(
        format!("another run writes to output folder {}{by}", path.display()),
        "wait until it has ended, or choose another folder with --out DIR",
    )
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
pub(crate) fn replace(path: &Path, text: &str) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part = path.with_file_name(partial(&name));
    fs::write(&part, text).and_then(|()| fs::rename(&part, path)).map_err(|error| cannot_write(path, error))
}

/// The error of a file that became unwritable during the run.
fn cannot_write(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::System(format!("cannot write {}: {}", path.display(), one_line(&error.to_string())))
}

/// HDF5 breaks the line after a time.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_results_of_an_earlier_run_are_cleared() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out/case");
        prepare(&path, &RUN, &[]).unwrap();
        for name in RUN.into_iter().chain([
            "notes.md",
            "fields.xdmf.part",
            "fields.h5.journal",
            "checkpoint.h5.part.journal",
            "factors_mumps_0_x",
        ]) {
            fs::write(path.join(name), "old").unwrap();
        }
        prepare(&path, &RUN, &[]).unwrap();
        let left: Vec<_> = fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["notes.md"]);
    }

    /// Another run, or an input among the results: all of the earlier run stays.
    #[test]
    fn nothing_is_cleared_before_all_is_well() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        RUN.iter().for_each(|name| fs::write(path.join(name), "old").unwrap());
        let other = prepare(path, &[], &[]).unwrap();
        let input = path.join("../").join(path.file_name().unwrap()).join("scene.toml");
        for (words, inputs) in
            [("another run writes to", vec![]), ("overwrite its own scene file", vec![("scene file", input.as_path())])]
        {
            let error = prepare(path, &RUN, &inputs).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(words), "{error}");
            assert!(RUN.iter().all(|name| path.join(name).exists()), "{words}");
            if inputs.is_empty() {
                fs::remove_file(path.join(".lock")).unwrap(); // as if the other were gone
            }
        }
        drop(other);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_wrong_input() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        for path in [file.clone(), file.join("below"), PathBuf::from("/proc/nagata")] {
            let error = not_writable(&path, &make(&path).unwrap_err());
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
