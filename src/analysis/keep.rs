//! When checkpoints are written, and what a run adds to them of its own: how far its files are, what it has counted.

use super::Simulation;
use super::estimates::Estimates;
use super::probes::Lengths;
use super::restart::Layout;
use crate::error::{Error, Result};
use crate::estimate::facets::Stiffness;
use crate::output::OutputFolder;
use crate::output::checkpoint::{self, Stored, checksum};
use crate::output::summary::{Counts, Rounded};
use crate::parallel::{agree, any};
use crate::scene::{Checkpoint, Scene};
use mpi::traits::*;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

/// What a run knows of itself at a checkpoint.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    /// Bytes of the history and of the log.
    pub history: u64,
    pub log: u64,
    /// Increments in the fields, and increments since the last of these.
    pub written: usize,
    pub since_written: usize,
    /// What the contacts of tools have shown so far.
    pub stiffness: Vec<Stiffness>,
    pub counts: Counts,
}

crate::words!(Record { history, log, written, since_written, stiffness, counts });

/// Writes checkpoints of a run.
pub(super) struct Keeper<'f> {
    folder: &'f OutputFolder,
    layout: Layout,
    /// A line a file that the scene names, with its checksum; on rank 0.
    files: String,
    often: Option<Checkpoint>,
    /// When the last was written, and after how many increments.
    last: (Instant, usize),
}

impl<'f> Keeper<'f> {
    /// Of a run into a folder. Collective.
    ///
    /// # Errors
    /// A file of the scene that cannot be read, on all ranks.
    pub fn new(folder: &'f OutputFolder, simulation: &Simulation) -> Result<Self> {
        let (comm, scene) = (simulation.comm(), simulation.scene());
        let files = agree(comm, if comm.rank() == 0 { checksums(scene) } else { Ok(String::new()) })?;
        let layout = Layout::new(comm, simulation.model());
        Ok(Self { folder, layout, files, often: scene.output.checkpoint, last: (Instant::now(), 0) })
    }

    /// Takes a simulation to the checkpoint in the folder; gives what its run knew, and adds what it had estimated.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there is none, it is damaged, or of another scene.
    pub fn go_back(&mut self, simulation: &mut Simulation, estimates: &mut Estimates) -> Result<(Record, Lengths)> {
        let comm = simulation.comm();
        let stored = Stored::open(self.folder, comm)?;
        let [scene, files, told] = ["scene", "files", "told"].map(|name| stored.text(comm, name));
        let differs = simulation.scene().differs_from(&scene?).or_else(|| other_line(&files.ok()?, &self.files));
        // Only rank 0 knows the files.
        agree(comm, differs.map_or(Ok(()), |what| Err(another(&what))))?;
        let record: Record = simulation.restore(&stored, &self.layout)?;
        let told: Value = serde_json::from_str(&told?).unwrap_or_default();
        let list = |key: &str| told[key].as_array().cloned().unwrap_or_default();
        let summary = &mut simulation.summary;
        summary.counts = record.counts;
        let increments = record.counts.increments;
        summary.warnings = list("warnings").iter().filter_map(|w| w.as_str().map(str::to_string)).collect();
        summary.rounded = Rounded::from_json(&told["rounded"]);
        summary.restarted = Some(increments);
        estimates.go_on(list("estimates"), record.stiffness.clone());
        self.last = (Instant::now(), increments);
        Ok((record, serde_json::from_value(told["probes"].clone()).unwrap_or_default()))
    }

    /// Whether a checkpoint is asked for after an increment, the last of the run or not; rank 0's clock counts. Collective.
    pub fn is_due(&self, simulation: &Simulation, is_last: bool) -> bool {
        let Some(Checkpoint { increments, minutes }) = self.often else { return false };
        let since = simulation.state().increments - self.last.1;
        let is_time = |minutes: f64| self.last.0.elapsed() >= Duration::from_secs_f64(60.0 * minutes);
        let on_time = simulation.comm().rank() == 0 && minutes.is_some_and(is_time);
        is_last || any(simulation.comm(), on_time) || increments.is_some_and(|every| since >= every)
    }

    /// Writes one, when `files` that are written on have come to the disk. Collective.
    ///
    /// # Errors
    /// [`Error::System`] on all ranks when it cannot be written; the last one stays.
    pub fn keep(
        &mut self,
        simulation: &mut Simulation,
        (record, probes): (Record, Lengths),
        files: &[&Path],
        estimates: &[Value],
    ) -> Result<()> {
        let comm = simulation.comm();
        let forced = || files.iter().try_for_each(|file| checkpoint::sync(file));
        let forced = if comm.rank() == 0 { forced() } else { Ok(()) };
        agree(comm, forced.map_err(|error| Error::System(format!("results cannot be forced to the disk: {error}"))))?;
        let summary = &simulation.summary;
        let told = json!({
            "estimates": estimates,
            "rounded": summary.rounded.as_ref().map(Rounded::to_json),
            "warnings": summary.warnings,
            "probes": probes,
        });
        let told = told.to_string();
        let texts = [("scene", &simulation.scene().text[..]), ("files", &self.files), ("told", &told)];
        simulation.save(self.folder, &self.layout, &Record { counts: summary.counts, ..record }, &texts)?;
        self.last = (Instant::now(), simulation.state().increments);
        Ok(())
    }
}

/// The checksums of the files of a scene; those of descriptions that do not act need not be there.
fn checksums(scene: &Scene) -> Result<String> {
    let mut lines = String::new();
    for path in scene.files() {
        let sum = match File::open(path).and_then(|mut file| checksum(&mut file, u64::MAX)) {
            Ok(sum) => format!("{sum:016x}"),
            Err(error) if error.kind() == ErrorKind::NotFound => "none".into(),
            Err(error) => return Err(Error::input_anywhere(format!("cannot read {}: {error}", path.display()), "")),
        };
        let _ = writeln!(lines, "{sum} {}", path.file_name().unwrap_or_default().display());
    }
    Ok(lines)
}

/// The first file that is not what it was.
fn other_line(before: &str, now: &str) -> Option<String> {
    let pair = before.lines().zip(now.lines()).find(|(before, now)| before != now);
    pair.map(|(_, now)| format!("the file {} has other content", now.split_once(' ').map_or(now, |(_, name)| name)))
}

fn another(what: &str) -> Error {
    Error::input_anywhere(
        format!("the checkpoint is of another scene: {what}"),
        "only steps may be added, and `output` changed, with the same --set as before; or run without --restart",
    )
}
