//! Curves that bound a face: on a surface (142), or a boundary (141).
//!
//! The file gives them in its own parameters of the surface, in space, or both; the parameters are taken where they
//! are.

use super::carry::carry;
use super::curves::{self, Piece};
use super::entry::Entry;
use super::file::File;
use super::invert::invert;
use super::loops;
use super::parameters::Parameters;
use super::surfaces::Surface;
use crate::error::Result;
use crate::surface::Curve;

/// A closed chain of curves as the file has it.
pub(super) struct Boundary<'a, 'f> {
    parameters: Parameters<'a, 'f>,
    sides: Vec<Side<'f>>,
}

/// One curve of the chain.
struct Side<'f> {
    in_parameters: Vec<&'f Entry>,
    in_space: Option<&'f Entry>,
}

const HELP: &str = "the end of each curve is the start of the next, and that of the last the start of the first";

impl<'a, 'f> Boundary<'a, 'f> {
    /// A curve on the surface `base` (142).
    pub fn on_surface(file: &'f File<'a>, entry: &'f Entry, base: &Entry) -> Result<Self> {
        if entry.kind != 142 {
            return Err(file.entry_error(entry, "not a curve on a surface (142)", ""));
        }
        let mut parameters = Parameters::new(file, entry)?;
        parameters.int("how the curve came about")?;
        same_surface(&mut parameters, base)?;
        let in_parameters = parameters.optional_entity("a curve in the parameters of the surface")?;
        let in_space = parameters.optional_entity("a curve in space")?;
        Ok(Self { parameters, sides: vec![Side { in_parameters: in_parameters.into_iter().collect(), in_space }] })
    }

    /// A boundary of the surface `base` (141).
    pub fn of_surface(file: &'f File<'a>, entry: &'f Entry, base: &Entry) -> Result<Self> {
        if entry.kind != 141 {
            return Err(file.entry_error(entry, "not a boundary (141)", ""));
        }
        let mut parameters = Parameters::new(file, entry)?;
        parameters.int("0 or 1 for curves in space alone, or in parameters too")?;
        parameters.int("the preferred representation")?;
        same_surface(&mut parameters, base)?;
        let mut sides = Vec::new();
        for _ in 0..parameters.count("the number of curves")? {
            let in_space = parameters.optional_entity("a curve in space")?;
            parameters.int("1 or 2 for the direction of a curve")?;
            let mut in_parameters = Vec::new();
            for _ in 0..parameters.count("the number of curves in the parameters")? {
                in_parameters.push(parameters.entity("a curve in the parameters of the surface")?);
            }
            sides.push(Side { in_parameters, in_space });
        }
        Ok(Self { parameters, sides })
    }

    /// The loop in the parameters of the NURBS surface: as the file gives it, or from the curves in space.
    pub fn in_parameters(&self, file: &File, surface: &Surface) -> Result<Vec<Curve<2>>> {
        let parts = if self.sides.iter().all(|side| !side.in_parameters.is_empty()) {
            carry(&self.flat(file)?, &surface.scales).map_err(|what| self.parameters.error(what, ""))?
        } else {
            let inverted = |piece: &Piece| invert(&surface.nurbs, &piece.curve);
            let parts: Result<_, String> = self.in_space(file)?.iter().map(inverted).collect();
            parts.map_err(|what| self.parameters.error(what, "give the curves in parameters too"))?
        };
        loops::close(parts, &surface.nurbs).map_err(|what| self.parameters.error(what, HELP))
    }

    /// The curves in the file's parameters.
    fn flat(&self, file: &File) -> Result<Vec<Curve<2>>> {
        let mut flat = Vec::new();
        for entry in self.sides.iter().flat_map(|side| &side.in_parameters) {
            for piece in curves::read(file, entry)? {
                let points = piece.curve.points().iter().map(|point| point.xy()).collect();
                let curve = Curve::new(piece.curve.knots().clone(), points, piece.curve.weights().to_vec());
                flat.push(curve.map_err(|what| file.entry_error(entry, what, ""))?);
            }
        }
        Ok(flat)
    }

    /// The chain in space.
    pub fn in_space(&self, file: &File) -> Result<Vec<Piece>> {
        let mut pieces = Vec::new();
        for side in &self.sides {
            let Some(entry) = side.in_space else {
                return Err(self.parameters.error("expected a curve in space, found none", ""));
            };
            pieces.extend(curves::read(file, entry)?);
        }
        Ok(pieces)
    }
}

/// Reads the surface, which must be `base` where it is given.
fn same_surface(parameters: &mut Parameters, base: &Entry) -> Result<()> {
    match parameters.optional_entity("a surface")?.filter(|found| found.number != base.number) {
        None => Ok(()),
        Some(other) => {
            let what = format!("it lies on D{}, but bounds a part of D{}", other.number, base.number);
            Err(parameters.error(what, "both are the same surface"))
        }
    }
}
