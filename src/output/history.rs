//! `history.csv`: one row an increment, each on disk before the next increment starts; and the tables of probes.

mod read;

pub use read::{Components, DISPLACEMENT, FORCE, History};

use super::{OutputFolder, cannot_go_on, cannot_write, go_on, length};
use crate::error::Result;
use crate::parallel::agree;
use mpi::traits::*;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};

/// The force and contact history of a run; rank 0 writes it.
#[derive(Debug)]
pub struct HistoryFile {
    path: PathBuf,
    /// On rank 0 alone.
    file: Option<File>,
}

impl HistoryFile {
    /// Writes the header `step,increment,time,iterations,` and `columns`. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::System`] on all ranks when the file cannot be written.
    pub fn create(folder: &OutputFolder, comm: &impl Communicator, columns: &[String]) -> Result<Self> {
        Self::start(folder, comm, "history.csv", || header("step,increment,time,iterations", columns))
    }

    fn start(
        folder: &OutputFolder,
        comm: &impl Communicator,
        name: &str,
        header: impl FnOnce() -> String,
    ) -> Result<Self> {
        let path = folder.file(name);
        let file = if comm.rank() == 0 { File::create(&path).map(Some) } else { Ok(None) };
        let file = agree(comm, file.map_err(|error| cannot_write(&path, error)))?;
        let mut history = Self { path, file };
        history.append(comm, header)?;
        Ok(history)
    }

    /// Goes on with the file of an earlier run, cut to the `length` that it had at a checkpoint. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] on all ranks when it is another file, or has other columns.
    pub fn go_on(folder: &OutputFolder, comm: &impl Communicator, columns: &[String], length: u64) -> Result<Self> {
        let help = "`history` of `[output]` must list the same sets as before, and torques act on the same tools";
        Self::resume(
            folder.file("history.csv"),
            comm,
            &header("step,increment,time,iterations", columns),
            (length, help),
        )
    }

    fn resume(path: PathBuf, comm: &impl Communicator, header: &str, (length, help): (u64, &str)) -> Result<Self> {
        let open = || {
            let mut head = String::new();
            let read = File::open(&path).and_then(|file| BufReader::new(file).read_line(&mut head));
            read.map_err(|error| cannot_go_on(&path, error, ""))?;
            if head != header {
                return Err(cannot_go_on(&path, "it has other columns", help));
            }
            go_on(&path, length).map_err(|error| cannot_go_on(&path, error, ""))
        };
        let file = agree(comm, if comm.rank() == 0 { open().map(Some) } else { Ok(None) })?;
        Ok(Self { path, file })
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.path
    }

    /// Bytes written so far; zero on other ranks than 0.
    pub fn length(&self) -> u64 {
        length(self.file.as_ref())
    }

    /// Writes one increment: name of the step, number of the increment, time, Newton iterations, and the values of the
    /// columns, which count on rank 0 only. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::System`] on all ranks when the file cannot be written.
    pub fn row(
        &mut self,
        comm: &impl Communicator,
        step: &str,
        increment: usize,
        time: f64,
        iterations: usize,
        values: &[f64],
    ) -> Result<()> {
        self.append(comm, || row(step, increment, time, iterations, values))
    }

    /// One write call a line: a kill leaves no half row behind a whole one.
    fn append(&mut self, comm: &impl Communicator, line: impl FnOnce() -> String) -> Result<()> {
        let written = self.file.as_mut().map_or(Ok(()), |file| file.write_all(line().as_bytes()));
        agree(comm, written.map_err(|error| cannot_write(&self.path, error)))
    }
}

/// The table of a probe, `probe-NAME.csv`; rank 0 writes it.
#[derive(Debug)]
pub struct ProbeFile(HistoryFile);

impl ProbeFile {
    /// Writes the header `increment,time,` and `columns`. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::System`] on all ranks when the file cannot be written.
    pub fn create(folder: &OutputFolder, comm: &impl Communicator, name: &str, columns: &[String]) -> Result<Self> {
        HistoryFile::start(folder, comm, &probe_file(name), || header("increment,time", columns)).map(Self)
    }

    /// Goes on with the table of an earlier run, cut to the `length` that it had at a checkpoint; one that was not there then
    /// begins. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] on all ranks when it has other columns.
    pub fn go_on(
        folder: &OutputFolder,
        comm: &impl Communicator,
        name: &str,
        columns: &[String],
        length: Option<u64>,
    ) -> Result<Self> {
        let Some(length) = length else { return Self::create(folder, comm, name, columns) };
        let help = "a probe must have the same place and fields as before; give another one another name";
        let path = folder.file(&probe_file(name));
        HistoryFile::resume(path, comm, &header("increment,time", columns), (length, help)).map(Self)
    }

    /// Bytes written so far; zero on other ranks than 0.
    pub fn length(&self) -> u64 {
        self.0.length()
    }

    /// The file.
    pub fn file(&self) -> &Path {
        self.0.file()
    }

    /// Writes rows of one increment, so many values each, which count on rank 0 only. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::System`] on all ranks when the file cannot be written.
    pub fn rows(
        &mut self,
        comm: &impl Communicator,
        (increment, time): (usize, f64),
        width: usize,
        values: &[f64],
    ) -> Result<()> {
        let line = |values: &[f64]| cells(format!("{increment},{}", shortest(time)), values);
        self.0.append(comm, || values.chunks(width).map(line).collect())
    }
}

/// The name of the file of a probe.
pub fn probe_file(name: &str) -> String {
    format!("probe-{name}.csv")
}

fn header(leading: &str, columns: &[String]) -> String {
    let mut line = leading.to_string();
    for column in columns {
        line.push(',');
        line.push_str(&quoted(column));
    }
    line.push('\n');
    line
}

fn row(step: &str, increment: usize, time: f64, iterations: usize, values: &[f64]) -> String {
    cells(format!("{},{increment},{},{iterations}", quoted(step), shortest(time)), values)
}

/// A line that goes on with numbers.
fn cells(mut line: String, values: &[f64]) -> String {
    for &value in values {
        let _ = write!(line, ",{}", shortest(value));
    }
    line.push('\n');
    line
}

/// The fewest digits that read back as the same number; whole numbers without a point.
fn shortest(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_string).unwrap_or(text)
}

/// A text cell; quoted as RFC 4180 has it when it must be.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_they_were() {
        for value in [0.1, 1.0 / 3.0, -1e-300, 1.7976931348623157e308, 5e-324, 12.0, -0.0, 2.5e7, 123456789.125] {
            let back: f64 = shortest(value).parse().unwrap();
            assert_eq!(back.to_bits(), value.to_bits(), "{}", shortest(value));
        }
        assert_eq!(shortest(3.0), "3");
        assert_eq!(shortest(0.1), "0.1");
        assert!(shortest(f64::NAN).parse::<f64>().unwrap().is_nan());
    }

    #[test]
    fn a_row_has_the_cells_of_the_header() {
        let head = header("step,increment,time,iterations", &["indenter.fx".into(), "top, left.gap".into()]);
        assert_eq!(head, "step,increment,time,iterations,indenter.fx,\"top, left.gap\"\n");
        assert_eq!(row("press", 3, 0.25, 5, &[-12.5, 0.0]), "press,3,0.25,5,-12.5,0\n");
        assert_eq!(row("a \"b\"", 1, 1e-9, 0, &[]), "\"a \"\"b\"\"\",1,1e-9,0\n");
    }
}
