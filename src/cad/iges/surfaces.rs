//! Surfaces: B-splines (128), of revolution (120), tabulated cylinders (122), ruled (118).
//!
//! Their parameters in the file are those of their curves, the angle of revolution, or run from 0 to 1; the
//! [`Scale`]s lead from them to the parameters of the NURBS surface, direction by direction.

use super::curves::{self, Piece};
use super::entry::Entry;
use super::file::File;
use super::parameters::Parameters;
use super::scale::Scale;
use super::transform;
use crate::Vec3;
use crate::error::Result;
use crate::surface::{Curve, KnotVector, Nurbs};
use std::f64::consts::TAU;

/// A surface with its parameters in the file.
pub(super) struct Surface {
    pub nurbs: Nurbs,
    pub scales: [Scale; 2],
}

/// The surfaces that an entity consists of: several where it is made of a chain of curves.
pub(super) fn read(file: &File, entry: &Entry) -> Result<Vec<Surface>> {
    let mut parameters = match entry.kind {
        118 | 120 | 122 | 128 => Parameters::new(file, entry)?,
        _ => {
            let help = "surfaces are read from types 118, 120, 122 and 128";
            return Err(file.entry_error(entry, "not a surface with parameters that can be read", help));
        }
    };
    let mut surfaces = match entry.kind {
        118 => vec![ruled(file, &mut parameters)?],
        120 => revolution(file, &mut parameters)?,
        122 => tabulated(file, &mut parameters)?,
        _ => vec![spline(&mut parameters)?],
    };
    if let Some((matrix, shift)) = transform::of(file, entry)? {
        for surface in &mut surfaces {
            surface.nurbs = surface.nurbs.transformed(&matrix, &shift);
        }
    }
    Ok(surfaces)
}

/// Lines between points of two curves at the same parameter (form 1) or length (form 0), both relative.
fn ruled(file: &File, parameters: &mut Parameters) -> Result<Surface> {
    let first = one(curves::read(file, parameters.entity("the first curve")?)?, parameters)?;
    let mut second = one(curves::read(file, parameters.entity("the second curve")?)?, parameters)?;
    let reversed = match parameters.int("0 or 1 for the direction of the second curve")? {
        0 => false,
        1 => true,
        other => return Err(parameters.error(format!("the direction of the second curve is {other}"), "0 or 1")),
    };
    // On lines and arcs, lengths go with parameters.
    let even = |piece: &Piece| !piece.scale.is_linear() || piece.curve.points().len() == 2;
    let by_length = parameters.entry.form == 0;
    if !first.scale.is_like(&second.scale) || by_length && !(even(&first) && even(&second)) {
        let help = "it can be between lines, between arcs of one angle, and between splines in form 1";
        return Err(parameters.error("no NURBS surface is exactly this one", help));
    }
    if reversed {
        second.curve = second.curve.reversed();
    }
    let unit = [0.0, 1.0];
    Ok(Surface {
        nurbs: Nurbs::ruled(&first.curve, &second.curve),
        scales: [first.scale.over(unit), Scale::same(unit)],
    })
}

/// A curve turned about a line; the second parameter is the angle.
fn revolution(file: &File, parameters: &mut Parameters) -> Result<Vec<Surface>> {
    let [point, end] = curves::line_ends(file, parameters.entity("the axis")?)?;
    let generatrix = curves::read(file, parameters.entity("the curve to be turned")?)?;
    let [start, stop] = parameters.reals("an angle")?;
    if stop - start > TAU + 1e-6 || stop <= start {
        let what = format!("the angles run from {start:?} to {stop:?} radians");
        return Err(parameters.error(what, "the second is larger, by a full turn at most"));
    }
    let sweep = [start, stop.min(start + TAU)];
    let turned = |piece: Piece| {
        let nurbs = Nurbs::revolution(&piece.curve, point, end - point, sweep);
        let nurbs = nurbs.map_err(|what| parameters.error(what, ""))?;
        let along = &nurbs.knots()[1];
        let angle = Scale::angle(sweep, along.domain(), along.spans().count());
        Ok(Surface { nurbs, scales: [piece.scale, angle] })
    };
    generatrix.into_iter().map(turned).collect()
}

/// A curve moved along a line from its start to a given point; both parameters run from 0 to 1.
fn tabulated(file: &File, parameters: &mut Parameters) -> Result<Vec<Surface>> {
    let directrix = curves::read(file, parameters.entity("the curve to be moved")?)?;
    let end = Vec3::from(parameters.reals("a coordinate")?);
    let Some(start) = directrix.first().map(|piece| piece.curve.local(piece.curve.domain()[0]).point) else {
        return Ok(Vec::new());
    };
    let direction = end - start;
    if direction.norm() == 0.0 {
        return Err(parameters.error("the curve is moved by nothing", "the point is where its start moves to"));
    }
    let unit = [0.0, 1.0];
    let moved = |piece: Piece| Surface {
        nurbs: Nurbs::extrusion(&piece.curve, direction),
        scales: [piece.scale.over(unit), Scale::same(unit)],
    };
    Ok(directrix.into_iter().map(moved).collect())
}

fn spline(parameters: &mut Parameters) -> Result<Surface> {
    let last = [parameters.count("the upper index of the first sum")?, parameters.count("that of the second")?];
    let degrees = [parameters.count("the first degree")?, parameters.count("the second degree")?];
    for _ in 0..5 {
        parameters.int("a property")?;
    }
    let along_u = curves::knots(parameters, degrees[0], last[0] + 1)?;
    let along_v = curves::knots(parameters, degrees[1], last[1] + 1)?;
    let count = (last[0] + 1).saturating_mul(last[1] + 1);
    if count.saturating_mul(4) > parameters.left() {
        let what = format!("{count} control points and their weights are more than follow");
        return Err(parameters.error(what, ""));
    }
    let weights = curves::reals(parameters, count, "a weight")?;
    let mut points = Vec::new();
    for _ in 0..count {
        points.push(Vec3::from(parameters.reals("a coordinate")?));
    }
    let u = curves::limits(parameters, along_u.domain())?;
    let v = curves::limits(parameters, along_v.domain())?;
    let nurbs = Nurbs::new([along_u, along_v], points, weights).and_then(|nurbs| restrict(nurbs, [u, v]));
    let nurbs = nurbs.map_err(|what| parameters.error(what, ""))?;
    Ok(Surface { scales: nurbs.domain().map(Scale::same), nurbs })
}

/// The part of a surface over a part of its domain.
fn restrict(surface: Nurbs, domain: [[f64; 2]; 2]) -> Result<Nurbs, String> {
    if surface.domain() == domain {
        return Ok(surface);
    }
    let first = restrict_first(&surface, domain[0])?;
    Ok(restrict_first(&first.swapped(), domain[1])?.swapped())
}

/// Cuts every row of control points as a curve.
fn restrict_first(surface: &Nurbs, limits: [f64; 2]) -> Result<Nurbs, String> {
    let [along, across] = surface.knots();
    let rows = surface.points().chunks(along.count()).zip(surface.weights().chunks(along.count()));
    let (mut points, mut weights): (Vec<Vec3>, Vec<f64>) = Default::default();
    let mut knots: Option<KnotVector> = None;
    for (row, own) in rows {
        let curve = curves::part(Curve::new(along.clone(), row.to_vec(), own.to_vec())?, limits)?;
        points.extend(curve.points());
        weights.extend(curve.weights());
        knots = Some(curve.knots().clone());
    }
    Nurbs::new([knots.unwrap_or(along.clone()), across.clone()], points, weights)
}

fn one(mut pieces: Vec<Piece>, parameters: &Parameters) -> Result<Piece> {
    match (pieces.pop(), pieces.len()) {
        (Some(piece), 0) => Ok(piece),
        _ => Err(parameters.error("a ruled surface between chains of curves is not read", "one curve on each side")),
    }
}
