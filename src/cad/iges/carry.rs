//! Plane curves from the file's parameters of a surface to those of its NURBS form.
//!
//! Straight lines along one parameter stay what they are whatever the [`Scale`]s of the surface. Other curves are kept
//! exactly where both scales are linear, and are fitted elsewhere.

use super::fit::{Jet, fit};
use super::loops::Part;
use super::scale::Scale;
use crate::surface::Curve;
use nalgebra::{Matrix2, Vector2};

type Vec2 = Vector2<f64>;

/// Error of fitted curves, over the domain.
const TOLERANCE: f64 = 1e-10;
/// Differences of one parameter along a line that follows the other, over the domain.
const STRAIGHT: f64 = 1e-13;

/// The curves of a loop.
pub(super) fn carry(curves: &[Curve<2>], scales: &[Scale; 2]) -> Result<Vec<Part>, String> {
    let turns = turns(curves, scales);
    curves.iter().map(|curve| carry_one(&curve.transformed(&Matrix2::identity(), &turns), scales)).collect()
}

/// Full turns that lead to the domain where a parameter is an angle; not all files take an angle from 0 to 2 pi.
fn turns(curves: &[Curve<2>], scales: &[Scale; 2]) -> Vec2 {
    let boxes = curves.iter().map(Curve::bounds);
    let all = boxes.reduce(|(low, high), (other_low, other_high)| (low.inf(&other_low), high.sup(&other_high)));
    let middle = all.map_or(Vec2::zeros(), |(low, high)| (low + high) * 0.5);
    Vec2::from_fn(|k, _| {
        let [start, end] = scales[k].domain();
        match scales[k].turn() {
            Some(turn) if !(start..=end).contains(&middle[k]) => {
                turn * ((0.5 * (start + end) - middle[k]) / turn).round()
            }
            _ => 0.0,
        }
    })
}

fn carry_one(curve: &Curve<2>, scales: &[Scale; 2]) -> Result<Part, String> {
    let mapped = |point: &Vec2| Vec2::new(scales[0].at(point.x)[0], scales[1].at(point.y)[0]);
    if scales.iter().all(Scale::is_linear) {
        let points = curve.points().iter().map(mapped).collect();
        return Ok(vec![Curve::new(curve.knots().clone(), points, curve.weights().to_vec())?]);
    }
    let tolerance = scales.each_ref().map(|scale| TOLERANCE * width(scale.range()));
    let mut part = Vec::new();
    for (_, span) in curve.beziers() {
        let (low, high) = span.bounds();
        let ends = [0.0, 1.0].map(|t| mapped(&span.local(t).point));
        if (0..2).any(|k| high[k] - low[k] <= STRAIGHT * width(scales[k].domain())) {
            part.push(Curve::line(ends[0], ends[1]));
            continue;
        }
        let sample = |t: f64, _: &Vec2| {
            let local = span.local(t);
            let scaled = [0, 1].map(|k| scales[k].at(local.point[k]));
            Some(Jet {
                point: Vec2::from_fn(|k, _| scaled[k][0]),
                first: Vec2::from_fn(|k, _| scaled[k][1] * local.first[k]),
                second: Vec2::from_fn(|k, _| {
                    scaled[k][2] * local.first[k] * local.first[k] + scaled[k][1] * local.second[k]
                }),
            })
        };
        let is_close = |a: &Vec2, b: &Vec2| (0..2).all(|k| (a[k] - b[k]).abs() <= tolerance[k]);
        part.push(fit([0.0, 1.0], ends, sample, is_close).ok_or("the curve is too rough to be followed")?);
    }
    Ok(part)
}

fn width(ends: [f64; 2]) -> f64 {
    ends[1] - ends[0]
}
