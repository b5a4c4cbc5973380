//! Surfaces of rigid tools from CAD files: IGES and Bézier patches.
//!
//! A reader gives the [`Face`]s of a file in the coordinates of the file. What it cannot read it names, see [`read`].

mod bezier;
pub mod iges;

use crate::encoding;
use crate::error::{Error, Result};
use crate::mesh::message;
use crate::surface::Face;
use std::path::Path;

/// What a CAD file holds.
#[derive(Clone, Debug, Default)]
pub struct Cad {
    pub faces: Vec<Face>,
    /// What could not be read and why.
    pub skipped: Vec<String>,
    /// Name of the unit of length that the file declares.
    pub unit: Option<String>,
}

/// Reads a file: IGES (`.igs`, `.iges`) or Bézier patches (`.bpt`).
///
/// A surface of a kind that is not read, or one that is broken, is an error that names it; with `incomplete` it is
/// [skipped](Cad::skipped). A file without surfaces is an error.
pub fn read(path: &Path, incomplete: bool) -> Result<Cad> {
    let name = path.display().to_string();
    let reader = match path.extension().unwrap_or_default().to_string_lossy().to_lowercase().as_str() {
        "igs" | "iges" => iges::read,
        "bpt" => bezier::read,
        _ => {
            let help = "surfaces are read from IGES (.igs, .iges) and Bézier patch (.bpt) files";
            return Err(message::whole_file(&name, "not a CAD file that can be read", help));
        }
    };
    let data = std::fs::read(path)
        .map_err(|error| Error::input_anywhere(format!("cannot read the CAD file '{name}': {error}"), ""))?;
    let data = encoding::unmarked(path, data)
        .map_err(|(what, help)| Error::input_anywhere(format!("the CAD file '{name}' {what}"), help))?;
    let (cad, faults) = reader(&name, &data)?;
    let is_empty = cad.faces.is_empty();
    match &faults[..] {
        [first, others @ ..] if is_empty || !incomplete => Err(together(first, others, !is_empty)),
        [] if is_empty => Err(message::whole_file(&name, "the file has no surfaces", "points and curves make no tool")),
        _ => Ok(Cad { skipped: faults.iter().map(|fault| what(fault).to_string()).collect(), ..cad }),
    }
}

/// What a reader makes of the name and the bytes of a file: its faces, and an error for each that it could not read.
type Read = (Cad, Vec<Error>);

/// The first error, with the subjects of the others; `rest` is true when there is something else to be read.
fn together(first: &Error, others: &[Error], rest: bool) -> Error {
    let mut all = first.clone();
    if let Error::Input { what: text, help, .. } = &mut all {
        if !others.is_empty() {
            let subject = |other| what(other).split_once(": ").map_or(what(other), |parts| parts.0);
            let names: Vec<&str> = others.iter().take(3).map(subject).collect();
            let more = message::and_more(others.len() - names.len());
            text.push_str(&format!("; also not read: {}{more}", names.join(", ")));
        }
        if rest {
            let gap = if help.is_empty() { "" } else { "; " };
            help.push_str(&format!("{gap}incomplete = true leaves out what cannot be read"));
        }
    }
    all
}

fn what(error: &Error) -> &str {
    match error {
        Error::Input { what, .. } | Error::System(what) | Error::Interrupted(what) => what,
        Error::Inputs(errors) => errors.first().map_or("", what),
        Error::Diverged(failure) => &failure.what,
    }
}
