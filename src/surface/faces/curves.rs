//! Bézier curves in the plane of the parameters: parts, crossings with lines of constant parameter, and the closest
//! point of any curve.

use crate::surface::{Curve, CurveLocal};
use nalgebra::{SVector, Vector2};

const ITERATIONS: usize = 60;

/// The part of a Bézier curve on [0, 1] from `a` to `b`, again on [0, 1].
pub fn part(curve: &Curve<2>, [a, b]: [f64; 2]) -> Curve<2> {
    let before = if b < 1.0 { curve.split(b).ok().map(|[before, _]| before) } else { None };
    let before = before.unwrap_or_else(|| curve.clone());
    let behind = if a > 0.0 { before.split(a).ok().map(|[_, behind]| behind) } else { None };
    let behind = behind.unwrap_or(before);
    behind.beziers().into_iter().next().map_or(behind, |(_, bezier)| bezier)
}

/// The parameters inside (0, 1) at which a Bézier curve changes from one side of x_axis = `value` to the other, rising.
/// What stays within `tolerance` of the line does not cross it.
pub fn crossings(curve: &Curve<2>, axis: usize, value: f64, tolerance: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut open = vec![(curve.clone(), 0.0, 1.0)];
    while let Some((piece, from, to)) = open.pop() {
        let sides: Vec<f64> = piece.points().iter().map(|p| p[axis] - value).collect();
        if sides.iter().all(|s| *s >= -tolerance) || sides.iter().all(|s| *s <= tolerance) {
            continue;
        }
        let rises = sides.windows(2).all(|s| s[1] >= s[0]);
        if rises || sides.windows(2).all(|s| s[1] <= s[0]) {
            let t = bisect(|t| piece.local(t).point[axis] > value, rises);
            found.push(from + (to - from) * t);
        } else if to - from < 1e-12 {
            found.push(0.5 * (from + to));
        } else {
            let middle = 0.5 * (from + to);
            open.push((part(&piece, [0.5, 1.0]), middle, to));
            open.push((part(&piece, [0.0, 0.5]), from, middle));
        }
    }
    found.retain(|t| 0.0 < *t && *t < 1.0);
    found
}

/// Where in [0, 1] a condition that is `last` at 1 and not at 0 changes.
pub fn bisect(condition: impl Fn(f64) -> bool, last: bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..ITERATIONS {
        let middle = 0.5 * (low + high);
        if condition(middle) == last { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// The parts of a Bézier curve along which the second coordinate rises or falls, in order.
pub fn monotone_parts(curve: &Curve<2>) -> Vec<Curve<2>> {
    let mut parts = Vec::new();
    let mut open = vec![(curve.clone(), 0)];
    while let Some((piece, depth)) = open.pop() {
        let heights: Vec<f64> = piece.points().iter().map(|p| p.y).collect();
        let turn = if is_monotone(&heights) || depth > 8 { None } else { first_turn(&piece) };
        match turn {
            None => parts.push(piece),
            Some(t) => {
                open.push((part(&piece, [t, 1.0]), depth + 1));
                open.push((part(&piece, [0.0, t]), depth + 1));
            }
        }
    }
    parts
}

fn is_monotone(values: &[f64]) -> bool {
    values.windows(2).all(|v| v[0] <= v[1]) || values.windows(2).all(|v| v[0] >= v[1])
}

/// The first sample interval in which the slope of the second coordinate changes its sign, narrowed to a point.
fn first_turn(curve: &Curve<2>) -> Option<f64> {
    const SAMPLES: usize = 32;
    let slope = |t: f64| curve.local(t).first.y;
    let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
    let k = (1..SAMPLES).find(|k| slope(at(*k)) * slope(at(k - 1)) < 0.0)?;
    let (from, to) = (at(k - 1), at(k));
    let rises = slope(to) > 0.0;
    Some(from + (to - from) * bisect(|s| slope(from + (to - from) * s) > 0.0, rises))
}

/// Minimum of the distance of a curve to `x` that descent reaches from `start`, over the parameters from `low` to `high`.
pub fn descend_on<const D: usize>(
    curve: impl Fn(f64) -> CurveLocal<D>,
    x: &SVector<f64, D>,
    [low, high]: [f64; 2],
    start: f64,
) -> (f64, CurveLocal<D>) {
    let (mut t, mut local) = (start, curve(start));
    for _ in 0..ITERATIONS {
        let r = x - local.point;
        let (slope, metric) = (-local.first.dot(&r), local.first.norm_squared());
        let full = metric - r.dot(&local.second);
        let newton = full > 1e-6 * metric;
        let target = (t - slope / if newton { full } else { metric + 1e-150 }).clamp(low, high);
        let (step, f) = (target - t, 0.5 * r.norm_squared());
        let rounding = 16.0 * f64::EPSILON * r.amax() * (r.amax() + x.amax());
        let mut scale = 1.0;
        loop {
            let next = if scale == 1.0 { target } else { t + scale * step };
            let there = curve(next);
            let fall = 0.5 * (x - there.point).norm_squared() - f;
            if fall <= 1e-4 * scale * step * slope + rounding || scale < 1e-9 {
                (t, local) = (next, there);
                break;
            }
            scale *= 0.5;
        }
        if step.abs() < 1e-14 || scale == 1.0 && newton && step.abs() < 1e-8 || scale < 1e-9 {
            break;
        }
    }
    (t, local)
}

/// Parameter of the point of a Bézier curve next to `xi`, and their distance.
pub fn closest_on(curve: &Curve<2>, xi: [f64; 2]) -> (f64, f64) {
    const STARTS: usize = 9;
    let x = Vector2::from(xi);
    let at = |k: usize| k as f64 / (STARTS - 1) as f64;
    let distance = |t: f64| (curve.local(t).point - x).norm();
    let distances: [f64; STARTS] = std::array::from_fn(|k| distance(at(k)));
    let least = (0..STARTS).min_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0);
    let (t, local) = descend_on(|t| curve.local(t), &x, [0.0, 1.0], at(least));
    (t, (local.point - x).norm())
}
