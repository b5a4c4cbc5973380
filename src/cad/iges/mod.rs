//! IGES files, version 5.3 and before, in fixed ASCII format (Initial Graphics Exchange Specification 5.3, 1996).
//!
//! Read are surfaces of the types 118, 120, 122 and 128, trimmed (144), bounded (143) or whole, and bounded planes
//! (108), with the curves they are made of (100, 102, 106, 110, 126) and matrices (124). A surface that another entity
//! cuts or holds is not a surface by itself. Curves, points, annotation, colours and groups are passed over; surfaces
//! and solids of other types are named. Coordinates are those of the file, in its unit.

mod boundary;
mod carry;
mod curves;
mod entry;
mod faces;
mod file;
mod fit;
mod invert;
mod lines;
mod loops;
mod parameters;
mod planes;
mod scale;
mod surfaces;
#[cfg(test)]
mod tests;
mod transform;
mod write;

pub use write::write;

use super::{Cad, Read};
use crate::error::{Error, Result};
use entry::{Entry, Role};
use file::File;
use parameters::Parameters;
use std::collections::HashSet;

/// Reads a whole file; `source` names it in messages.
pub(super) fn read(source: &str, data: &[u8]) -> Result<Read> {
    let file = File::new(source, data)?;
    let held: HashSet<usize> = file.entries.iter().flat_map(|entry| held(&file, entry)).collect();
    let mut cad = Cad { unit: file.unit.clone(), ..Cad::default() };
    let mut faults = Vec::new();
    for entry in file.entries.iter().filter(|entry| !held.contains(&entry.number)) {
        match entry.role() {
            Role::Surface if entry.kind == 108 && entry.dependent => {}
            Role::Surface => match faces::read(&file, entry) {
                Ok(faces) => cad.faces.extend(faces),
                Err(error) => faults.push(error),
            },
            Role::Unread if !entry.dependent && places_surfaces(&file, entry) => faults.push(unread(&file, entry)),
            Role::Unread | Role::Other => {}
        }
    }
    Ok((cad, faults))
}

/// The surfaces that an entity cuts or holds, by their numbers. What is broken is told where it is read. A surface that
/// cuts another is not held itself, so that none disappears in a circle.
fn held(file: &File, entry: &Entry) -> Vec<usize> {
    let skipped = match entry.kind {
        144 | 510 => 0,
        142 | 143 => 1,
        141 => 2,
        140 => 4,
        308 => return members(file, entry).unwrap_or_default().into_iter().map(|member| member.number).collect(),
        _ => return Vec::new(),
    };
    let surface = || -> Result<Entry> {
        let mut parameters = Parameters::new(file, entry)?;
        for _ in 0..skipped {
            parameters.skip();
        }
        Ok(parameters.entity("a surface")?.clone())
    };
    surface()
        .into_iter()
        .filter(|surface| !matches!(surface.kind, 140 | 143 | 144))
        .map(|surface| surface.number)
        .collect()
}

/// What a subfigure (308) consists of.
fn members<'f>(file: &'f File, entry: &'f Entry) -> Result<Vec<&'f Entry>> {
    let mut parameters = Parameters::new(file, entry)?;
    parameters.int("the depth of the subfigure")?;
    parameters.skip();
    (0..parameters.count("the number of members")?).map(|_| parameters.entity("a member")).collect()
}

/// False for instances and arrays (408, 412, 414) of things that have no surface.
fn places_surfaces(file: &File, entry: &Entry) -> bool {
    let placed = || -> Result<bool> {
        let original = Parameters::new(file, entry)?.entity("what it places")?;
        let parts = if original.kind == 308 { members(file, original)? } else { vec![original] };
        Ok(parts.iter().any(|part| part.role() != Role::Other))
    };
    !matches!(entry.kind, 408 | 412 | 414) || placed().unwrap_or(true)
}

fn unread(file: &File, entry: &Entry) -> Error {
    let help = "write the surfaces as NURBS: types 128 and 144";
    file.entry_error(entry, "surfaces of this type are not read", help)
}
