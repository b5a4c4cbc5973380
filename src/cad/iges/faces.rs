//! Faces: trimmed (144) and bounded (143) surfaces, bounded planes (108), and surfaces as they are.

use super::boundary::Boundary;
use super::entry::Entry;
use super::file::File;
use super::parameters::Parameters;
use super::planes::Plane;
use super::surfaces::{self, Surface};
use super::{curves, loops, transform};
use crate::error::Result;
use crate::surface::{Curve, Face, Nurbs};

/// The faces of a surface that stands for itself.
pub(super) fn read(file: &File, entry: &Entry) -> Result<Vec<Face>> {
    match entry.kind {
        108 => Ok(vec![plane(file, entry)?]),
        143 | 144 => Ok(vec![trimmed(file, entry)?]),
        _ => whole(file, entry),
    }
}

fn whole(file: &File, entry: &Entry) -> Result<Vec<Face>> {
    let surfaces = surfaces::read(file, entry)?;
    let count = surfaces.len();
    let name = |k: usize| match count {
        1 => entry.name(),
        _ => format!("{}, part {} of {count}", entry.name(), k + 1),
    };
    let face = |(k, surface): (usize, Surface)| Face {
        surface: surface.nurbs,
        loops: Vec::new(),
        reversed: false,
        name: name(k),
    };
    Ok(surfaces.into_iter().enumerate().map(face).collect())
}

fn trimmed(file: &File, entry: &Entry) -> Result<Face> {
    let mut parameters = Parameters::new(file, entry)?;
    if entry.kind == 143 {
        parameters.int("0 or 1 for curves in space alone, or in parameters too")?;
    }
    let base = parameters.entity("a surface")?;
    let surface = if base.kind == 108 { None } else { Some(single(file, base, &parameters)?) };
    let (is_whole, boundaries) = match entry.kind {
        143 => bounds(file, &mut parameters, base)?,
        _ => trims(file, &mut parameters, base)?,
    };
    let (surface, loops) = match surface {
        Some(surface) => {
            let mut loops = Vec::new();
            if is_whole && !boundaries.is_empty() {
                loops.push(loops::rectangle(&surface.nurbs));
            }
            for boundary in boundaries {
                loops.push(boundary.in_parameters(file, &surface)?);
            }
            (surface.nurbs, loops)
        }
        None if is_whole => return Err(parameters.error("a plane without outer boundary is not read", "")),
        None => {
            let chains = boundaries.iter().map(|boundary| boundary.in_space(file)).collect::<Result<Vec<_>>>()?;
            let plane = Plane::read(file, base)?.transformed(transform::of(file, base)?);
            plane.face(&chains).map_err(|what| parameters.error(what, ""))?
        }
    };
    face(file, entry, surface, loops)
}

/// The surface that loops are to cut.
fn single(file: &File, base: &Entry, parameters: &Parameters) -> Result<Surface> {
    let mut surfaces = surfaces::read(file, base)?;
    match (surfaces.pop(), surfaces.len()) {
        (Some(surface), 0) => Ok(surface),
        _ => {
            let what = format!("{} is made of a chain of curves and cannot be trimmed", base.name());
            Err(parameters.error(what, "one spline (126) can be such a chain"))
        }
    }
}

/// The boundaries of a trimmed surface; true when the outer one is that of the domain.
fn trims<'a, 'f>(
    file: &'f File<'a>,
    parameters: &mut Parameters<'a, 'f>,
    base: &Entry,
) -> Result<(bool, Vec<Boundary<'a, 'f>>)> {
    let flag = parameters.int("0 or 1 for the outer boundary")?;
    let holes = parameters.count("the number of inner boundaries")?;
    let outer = parameters.optional_entity("the outer boundary")?;
    let mut boundaries = Vec::new();
    match (flag, outer) {
        (0, _) => {}
        (1, Some(outer)) => boundaries.push(Boundary::on_surface(file, outer, base)?),
        (1, None) => return Err(parameters.error("it has no outer boundary", "0 before is for none")),
        _ => return Err(parameters.error(format!("{flag} for the outer boundary"), "0 for none, 1 for one")),
    }
    for _ in 0..holes {
        boundaries.push(Boundary::on_surface(file, parameters.entity("an inner boundary")?, base)?);
    }
    Ok((flag == 0, boundaries))
}

/// The boundaries of a bounded surface.
fn bounds<'a, 'f>(
    file: &'f File<'a>,
    parameters: &mut Parameters<'a, 'f>,
    base: &Entry,
) -> Result<(bool, Vec<Boundary<'a, 'f>>)> {
    let mut boundaries = Vec::new();
    for _ in 0..parameters.count("the number of boundaries")? {
        boundaries.push(Boundary::of_surface(file, parameters.entity("a boundary")?, base)?);
    }
    Ok((boundaries.is_empty(), boundaries))
}

/// A plane inside a closed curve.
fn plane(file: &File, entry: &Entry) -> Result<Face> {
    let plane = Plane::read(file, entry)?;
    let Some(bound) = plane.bound else {
        let help = "form 1 has a closed curve around it";
        return Err(file.entry_error(entry, "a plane without bounds is not read", help));
    };
    let cut = plane.face(&[curves::read(file, bound)?]);
    let (surface, loops) = cut.map_err(|what| file.entry_error(entry, what, ""))?;
    face(file, entry, surface, loops)
}

/// The face of an entity. Loops that are the sides of the domain are left out.
fn face(file: &File, entry: &Entry, surface: Nurbs, mut loops: Vec<Vec<Curve<2>>>) -> Result<Face> {
    if loops.len() == 1 && loops::is_rectangle(&loops[0], &surface) {
        loops.clear();
    }
    let surface = match transform::of(file, entry)? {
        Some((matrix, shift)) => surface.transformed(&matrix, &shift),
        None => surface,
    };
    Ok(Face { surface, loops, reversed: false, name: entry.name() })
}
