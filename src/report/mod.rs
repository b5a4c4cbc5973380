//! `nagata report`: one page of HTML on one or several runs, ended or not, that needs nothing else.
//!
//! All of it stands in their folders; where folders differ in their columns, the page says whose a curve is.

mod curves;
mod differences;
mod log;
mod page;
mod plot;
mod run;
mod tables;

use crate::error::{Error, Result};
use crate::output;
use run::Run;
use std::path::Path;

/// The page that a run writes into its own folder.
pub const NAME: &str = "report.html";

/// The page of the runs in `folders`, of which there is one at least.
///
/// # Errors
/// [`Error::Input`] when a folder is not that of a run, or a file in it is not whole.
pub fn page(folders: &[impl AsRef<Path>]) -> Result<String> {
    let runs = folders.iter().map(|folder| Run::read(folder.as_ref())).collect::<Result<Vec<_>>>()?;
    page::render(&runs)
}

/// Writes the page of the runs in `folders` to the file `out`.
///
/// # Errors
/// Those of [`page`]; [`Error::Input`] when `out` is not named as a page, or cannot be written.
pub fn write(folders: &[impl AsRef<Path>], out: &Path) -> Result<()> {
    if !out.extension().is_some_and(|end| end == "html" || end == "htm") {
        let what = format!("a report is a page of HTML, and {} is not named like one", out.display());
        return Err(Error::input_anywhere(what, "give it a name that ends in .html"));
    }
    let written = output::replace(out, &page(folders)?);
    written.map_err(|error| Error::input_anywhere(error.to_string(), "choose another file with --out FILE.html"))
}
