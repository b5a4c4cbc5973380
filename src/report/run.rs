//! What a run has left in its folder, or has written so far.

use super::log::Told;
use crate::error::{Error, Result};
use crate::output::history::History;
use crate::output::is_being_written;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::Value;
use std::io;
use std::path::{Path, PathBuf};

/// A run as its folder tells it.
#[derive(Debug)]
pub struct Run {
    /// The folder as the user gave it.
    pub name: String,
    pub title: String,
    /// The text of the scene.
    pub scene: String,
    pub state: State,
    pub told: Told,
    pub history: History,
    /// `summary.json`; null before the end.
    pub summary: Value,
    pub pictures: Vec<Picture>,
}

/// How a run stands.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    Runs,
    Converged,
    /// Why.
    Failed(String),
    Interrupted(String),
    /// Without a summary.
    Killed,
}

/// A PNG file of the folder.
#[derive(Debug)]
pub struct Picture {
    pub name: String,
    pub base64: String,
    /// Made before the run began.
    pub is_older: bool,
}

impl Run {
    /// Reads a folder.
    ///
    /// # Errors
    /// [`Error::Input`] when it is not that of a run, or a file in it is not whole.
    pub fn read(folder: &Path) -> Result<Self> {
        if !folder.is_dir() {
            let what = if folder.exists() { "is a file, not a folder" } else { "does not exist" };
            return Err(wrong(folder, what));
        }
        // Before the summary, which a run writes before it gives the lock back.
        let runs = is_being_written(folder);
        let summary = match text(folder, "summary.json") {
            Ok(text) => serde_json::from_str(&text).map_err(|error| wrong(&folder.join("summary.json"), error))?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Value::Null,
            Err(error) => return Err(wrong(&folder.join("summary.json"), error)),
        };
        let path = folder.join("history.csv");
        let rows = text(folder, "history.csv").map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => wrong(folder, "holds no results of a run: there is no history.csv"),
            _ => wrong(&path, error),
        })?;
        let rows = whole_rows(&rows, summary.is_null()).ok_or_else(|| wrong(&path, "ends within a row"))?;
        let needed = |name: &str| text(folder, name).map_err(|error| wrong(&folder.join(name), error));
        let (log, scene) = (needed("log.txt")?, needed("scene.toml")?);
        let mut told = Told::new(&log);
        for warning in summary["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            told.warn(warning);
        }
        let why = || told.error.clone().unwrap_or_else(|| "log.txt does not say why".into());
        let state = match (&summary, summary["converged"].as_bool(), summary["interrupted"].as_bool()) {
            (Value::Null, ..) if runs == Some(true) => State::Runs,
            (Value::Null, ..) => State::Killed,
            (_, Some(true), _) => State::Converged,
            (_, _, Some(true)) => State::Interrupted(why()),
            _ => State::Failed(why()),
        };
        Ok(Self {
            name: folder.display().to_string(),
            title: title(&scene, &log),
            scene,
            state,
            told,
            history: History::parse(rows).map_err(|what| wrong(&path, what))?,
            summary,
            pictures: pictures(folder).map_err(|error| wrong(folder, error))?,
        })
    }

    /// Sum of a column of the history.
    pub fn sum(&self, column: &str) -> f64 {
        self.history.column(column).unwrap_or_default().iter().sum()
    }
}

fn wrong(path: &Path, what: impl std::fmt::Display) -> Error {
    Error::input_anywhere(
        format!("cannot report on {}: {what}", path.display()),
        "give folders that `nagata run` has written, such as out/roller",
    )
}

fn text(folder: &Path, name: &str) -> io::Result<String> {
    std::fs::read_to_string(folder.join(name))
}

/// The rows that end; a last one that does not is passed over where a run may write it, or was killed there.
fn whole_rows(text: &str, is_open: bool) -> Option<&str> {
    let end = text.rfind('\n').map_or(0, |at| at + 1);
    (end == text.len() || is_open).then_some(&text[..end])
}

/// The title in a scene; without one it is the first line of the log.
fn title(scene: &str, log: &str) -> String {
    let table: toml::Table = scene.parse().unwrap_or_default();
    let title = table.get("title").and_then(|title| title.as_str());
    title.or(log.lines().next()).unwrap_or_default().to_string()
}

/// The PNG files of a folder by name. A run does not delete those of an earlier one.
fn pictures(folder: &Path) -> io::Result<Vec<Picture>> {
    let begun = folder.join("scene.toml").metadata()?.modified()?;
    let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<PathBuf>>>()?;
    let is_png = |path: &PathBuf| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"));
    let mut paths: Vec<PathBuf> = entries.into_iter().filter(is_png).collect();
    paths.sort();
    let picture = |path: PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_older = path.metadata()?.modified()? < begun;
        Ok(Picture { name, base64: BASE64_STANDARD.encode(std::fs::read(&path)?), is_older })
    };
    paths.into_iter().map(picture).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_row_is_passed_over_only_while_a_run_may_write_it() {
        assert_eq!(whole_rows("a\nb\nc", true), Some("a\nb\n"));
        assert_eq!(whole_rows("a\nb\nc", false), None);
        assert_eq!(whole_rows("a\nb\n", false), Some("a\nb\n"));
        assert_eq!(whole_rows("ste", true), Some(""));
    }
}
