//! Curves: arcs (100), lines (110), paths of points (106), B-splines (126), and chains of them (102).

use super::entry::Entry;
use super::file::File;
use super::parameters::Parameters;
use super::scale::Scale;
use super::transform;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::surface::{Curve, KnotVector};
use std::f64::consts::TAU;

/// A curve with its parameter in the file.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub curve: Curve<3>,
    pub scale: Scale,
}

/// What the ends of an arc may differ by in their distance from the centre, of the radius.
const ROUND: f64 = 1e-3;
/// Limits of parameters that differ by less than this from those of the knots, over the domain, are the same.
const SAME: f64 = 1e-9;

/// The curves that an entity consists of, one after the other, in space.
pub(super) fn read(file: &File, entry: &Entry) -> Result<Vec<Piece>> {
    let mut pieces = match entry.kind {
        102 => chain(file, entry)?,
        _ => vec![simple(file, entry)?],
    };
    if let Some((matrix, shift)) = transform::of(file, entry)? {
        for piece in &mut pieces {
            piece.curve = piece.curve.transformed(&matrix, &shift);
        }
    }
    Ok(pieces)
}

/// The two points of a line (110), which may go on beyond them.
pub(super) fn line_ends(file: &File, entry: &Entry) -> Result<[Vec3; 2]> {
    if entry.kind != 110 {
        return Err(file.entry_error(entry, "not a line (110)", "an axis is a line"));
    }
    let mut parameters = Parameters::new(file, entry)?;
    let ends = [parameters.reals("a coordinate")?, parameters.reals("a coordinate")?].map(Vec3::from);
    let moved = transform::of(file, entry)?;
    Ok(ends.map(|end| moved.map_or(end, |(matrix, shift)| matrix * end + shift)))
}

fn chain(file: &File, entry: &Entry) -> Result<Vec<Piece>> {
    let mut parameters = Parameters::new(file, entry)?;
    let mut pieces = Vec::new();
    for _ in 0..parameters.count("the number of curves")? {
        let part = parameters.entity("a curve")?;
        match part.kind {
            // A point may stand between curves.
            116 | 132 => {}
            102 => return Err(parameters.error("a composite curve is part of another", "")),
            _ => pieces.extend(read(file, part)?),
        }
    }
    if pieces.is_empty() { Err(parameters.error("it has no curves", "")) } else { Ok(pieces) }
}

fn simple(file: &File, entry: &Entry) -> Result<Piece> {
    match (entry.kind, entry.form) {
        (100, _) => arc(&mut Parameters::new(file, entry)?),
        (106, 11..=13 | 63) => path(&mut Parameters::new(file, entry)?),
        (110, 0) => {
            let mut parameters = Parameters::new(file, entry)?;
            let ends = [parameters.reals("a coordinate")?, parameters.reals("a coordinate")?].map(Vec3::from);
            Ok(Piece { curve: Curve::line(ends[0], ends[1]), scale: Scale::same([0.0, 1.0]) })
        }
        (126, _) => spline(&mut Parameters::new(file, entry)?),
        (_, form) => {
            let help = "curves are read from types 100, 102, 106 (paths), 110 (form 0) and 126";
            Err(file.entry_error(entry, format!("not a curve that can be read (form {form})"), help))
        }
    }
}

/// Counter-clockwise about the centre in a plane z = const; a circle where the ends are one point.
fn arc(parameters: &mut Parameters) -> Result<Piece> {
    let [z, x, y] = parameters.reals("a coordinate")?;
    let center = Vec3::new(x, y, z);
    let ends: [[f64; 2]; 2] = [parameters.reals("a coordinate")?, parameters.reals("a coordinate")?];
    let arms = ends.map(|end| Vec3::new(end[0] - x, end[1] - y, 0.0));
    let radii = arms.map(|arm| arm.norm());
    if (radii[0] - radii[1]).abs() > ROUND * radii[0] || radii[0] == 0.0 {
        let what = format!("its ends are {} and {} away from its centre", radii[0], radii[1]);
        return Err(parameters.error(what, "both distances are the radius, above 0"));
    }
    let angles = arms.map(|arm| arm.y.atan2(arm.x));
    let start = if angles[0] < 0.0 { angles[0] + TAU } else { angles[0] };
    let closed = (arms[1] - arms[0]).norm() <= SAME * radii[0];
    let turn = if closed { TAU } else { (angles[1] - angles[0]).rem_euclid(TAU) };
    let radius = 0.5 * (radii[0] + radii[1]);
    let curve = Curve::arc(center, Vec3::x(), Vec3::y(), radius, [start, start + turn]);
    let curve = curve.map_err(|what| parameters.error(what, ""))?;
    let scale = Scale::angle(curve.domain(), curve.domain(), curve.knots().spans().count());
    Ok(Piece { curve, scale })
}

/// Straight from point to point.
fn path(parameters: &mut Parameters) -> Result<Piece> {
    let flag = parameters.int("1, 2 or 3 for pairs, triples or sextuples")?;
    if !(1..=3).contains(&flag) {
        return Err(parameters.error(format!("{flag} for pairs, triples or sextuples"), "1, 2 or 3"));
    }
    let count = parameters.count("the number of points")?;
    let z = if flag == 1 { parameters.real("a coordinate")? } else { 0.0 };
    let mut points: Vec<Vec3> = Vec::new();
    for _ in 0..count {
        let [x, y] = parameters.reals("a coordinate")?;
        let z = if flag == 1 { z } else { parameters.real("a coordinate")? };
        if flag == 3 {
            parameters.reals::<3>("a component of a vector")?;
        }
        points.push(Vec3::new(x, y, z));
    }
    if parameters.entry.form == 63 && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    let curve = Curve::polyline(points).map_err(|what| parameters.error(what, ""))?;
    Ok(Piece { scale: Scale::same(curve.domain()), curve })
}

fn spline(parameters: &mut Parameters) -> Result<Piece> {
    let last = parameters.count("the upper index of the sum")?;
    let degree = parameters.count("the degree")?;
    for _ in 0..4 {
        parameters.int("a property")?;
    }
    let knots = knots(parameters, degree, last + 1)?;
    let weights = reals(parameters, last + 1, "a weight")?;
    let mut points = Vec::new();
    for _ in 0..=last {
        points.push(Vec3::from(parameters.reals("a coordinate")?));
    }
    let curve = Curve::new(knots, points, weights).map_err(|what| parameters.error(what, ""))?;
    let limits = limits(parameters, curve.domain())?;
    let curve = part(curve, limits).map_err(|what| parameters.error(what, ""))?;
    Ok(Piece { scale: Scale::same(curve.domain()), curve })
}

/// The knots for `count` control points.
pub(super) fn knots(parameters: &mut Parameters, degree: usize, count: usize) -> Result<KnotVector> {
    let knots = reals(parameters, count + degree + 1, "a knot")?;
    KnotVector::new(degree, knots).map_err(|what| parameters.error(what, ""))
}

/// `count` numbers.
pub(super) fn reals(parameters: &mut Parameters, count: usize, what: &str) -> Result<Vec<f64>> {
    (0..count).map(|_| parameters.real(what)).collect()
}

/// The interval of a parameter that counts: all of the domain when none is given.
pub(super) fn limits(parameters: &mut Parameters, domain: [f64; 2]) -> Result<[f64; 2]> {
    if parameters.left() < 2 {
        return Ok(domain);
    }
    let given: [f64; 2] = parameters.reals("a limit of the parameter")?;
    let rounding = SAME * (domain[1] - domain[0]);
    let [low, high] = [0, 1].map(|k| if (given[k] - domain[k]).abs() <= rounding { domain[k] } else { given[k] });
    let wrong = |what| -> Error {
        let [start, end] = domain;
        parameters.error(what, format!("the knots allow {start} to {end}"))
    };
    match [low, high] {
        [0.0, 0.0] => Ok(domain),
        _ if low >= high => Err(wrong(format!("the parameter is to run from {low} to {high}"))),
        _ if low < domain[0] || high > domain[1] => {
            Err(wrong(format!("the parameter {low} to {high} leaves the knots")))
        }
        limits => Ok(limits),
    }
}

/// The part of a curve between two parameters of its domain.
pub(super) fn part<const D: usize>(curve: Curve<D>, [low, high]: [f64; 2]) -> Result<Curve<D>, String> {
    let [start, end] = curve.domain();
    let [_, curve] = if low > start { curve.split(low)? } else { [curve.clone(), curve] };
    let [curve, _] = if high < end { curve.split(high)? } else { [curve.clone(), curve] };
    Ok(curve)
}
