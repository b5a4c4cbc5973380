//! Loops in the parameters of a surface: curves are lined up, and gaps between them closed.

use crate::surface::{Curve, Nurbs};
use nalgebra::{Matrix2, Vector2};

type Vec2 = Vector2<f64>;
/// What one curve of the file becomes: curves one after the other.
pub(super) type Part = Vec<Curve<2>>;

/// Gaps in a loop up to this are closed, and loops may leave the domain by this much, over the size of the domain.
const GAP: f64 = 1e-3;
/// Gaps up to this are rounding: an end is moved. A line closes larger ones.
const ROUNDING: f64 = 1e-9;
/// Lines that end or run this near to a side of the domain, over its size, do so on it: files have 9 or 10 digits.
const ON_SIDE: f64 = 1e-8;
/// Points of a surface are one when they are nearer than this, over the size of the surface.
const SAME: f64 = 1e-8;

/// The rectangle of all parameters.
pub(super) fn rectangle(surface: &Nurbs) -> Vec<Curve<2>> {
    let [u, v] = surface.domain();
    let corners = [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]].map(Vec2::from);
    (0..4).map(|k| Curve::line(corners[k], corners[(k + 1) % 4])).collect()
}

/// True for a loop that runs along all sides of the domain and nowhere else.
pub(super) fn is_rectangle(chain: &[Curve<2>], surface: &Nurbs) -> bool {
    let domain = surface.domain();
    let boxes: Vec<(Vec2, Vec2)> = chain.iter().flat_map(Curve::beziers).map(|(_, piece)| piece.bounds()).collect();
    let runs_along = |(low, high): &(Vec2, Vec2), k: usize, limit: f64| low[k] == limit && high[k] == limit;
    let sides = [0, 1].map(|k| domain[k].map(|limit| (k, limit))).concat();
    sides.iter().all(|&(k, limit)| boxes.iter().any(|piece| runs_along(piece, k, limit)))
        && boxes.iter().all(|piece| sides.iter().any(|&(k, limit)| runs_along(piece, k, limit)))
}

/// Makes a closed loop of curves that nearly are one, in the domain of `surface`; some may have to be turned round, or
/// moved from one side of a seam to the other. Fails, saying why, where gaps are too wide.
pub(super) fn close(parts: Vec<Part>, surface: &Nurbs) -> Result<Vec<Curve<2>>, String> {
    let domain = surface.domain();
    let size = Vec2::new(domain[0][1] - domain[0][0], domain[1][1] - domain[1][0]);
    // Along a pole there is nothing between two points.
    let gap = |a: &Vec2, b: &Vec2| if is_point(surface, a, b) { 0.0 } else { (a - b).component_div(&size).amax() };
    let mut curves = line_up(parts, surface, gap);
    for curve in &mut curves {
        *curve = on_sides(curve, &domain)?;
    }
    let count = curves.len();
    if count == 0 {
        return Err("the loop has no curves".into());
    }
    for k in 0..count {
        let next = (k + 1) % count;
        let [end, start] = [end_of(&curves[k]), start_of(&curves[next])];
        if gap(&end, &start) > GAP {
            let what = format!("the loop is open between curves {} and {}", k + 1, next + 1);
            let [a, b] = [end, start].map(|x| format!("({}, {})", x.x, x.y));
            return Err(format!("{what} of {count}, from {a} to {b} in the parameters of the surface"));
        }
        if (end - start).component_div(&size).amax() <= ROUNDING && is_clamped(&curves[next], 0) {
            curves[next] = with_start(&curves[next], end)?;
        }
    }
    let mut closed = Vec::new();
    for (k, curve) in curves.iter().enumerate() {
        let [end, start] = [end_of(curve), start_of(&curves[(k + 1) % count])];
        closed.push(curve.clone());
        if end != start {
            closed.push(Curve::line(end, start));
        }
    }
    match closed.iter().find(|curve| leaves(curve, &domain, &size)) {
        None => Ok(closed),
        Some(curve) => {
            let [x, y] = curve.local(0.5 * (curve.domain()[0] + curve.domain()[1])).point.into();
            Err(format!("the loop leaves the parameters of the surface, near ({x}, {y}){}", at_a_seam(surface)))
        }
    }
}

/// All curves, parts turned and moved so that the gaps between them add up to the least; points are left out.
fn line_up(mut parts: Vec<Part>, surface: &Nurbs, gap: impl Fn(&Vec2, &Vec2) -> f64) -> Vec<Curve<2>> {
    for part in &mut parts {
        part.retain(|curve| curve.points().iter().any(|point| *point != curve.points()[0]));
    }
    parts.retain(|part| !part.is_empty());
    let between = |before: &Part, next: &Part| gap(&end_of(&before[before.len() - 1]), &start_of(&next[0]));
    let (count, none) = (parts.len(), Vec2::repeat(f64::INFINITY));
    let boxes = parts.iter().flatten().map(Curve::bounds);
    let (low, high) = boxes.fold((none, -none), |all, one| (all.0.inf(&one.0), all.1.sup(&one.1)));
    let small = GAP.min(0.01 * gap(&low, &high));
    if (0..count).all(|k| between(&parts[k], &parts[(k + 1) % count]) <= small) {
        return parts.concat();
    }
    let closed = is_closed(surface);
    let mut variants: Vec<Vec<Part>> = parts.iter().map(|part| variants(part, surface, closed)).collect();
    // The first part may stay on its side of a seam.
    variants[0].truncate(2);
    let chosen = least_gaps(&variants, between);
    chosen.into_iter().zip(variants).flat_map(|(k, mut variants)| variants.swap_remove(k)).collect()
}

/// The variant of each part with which the gaps around the loop add up to the least; found from part to part, as the
/// best way to a variant is the best to some variant of the part before and on from there.
fn least_gaps(variants: &[Vec<Part>], between: impl Fn(&Part, &Part) -> f64) -> Vec<usize> {
    let mut best = (f64::INFINITY, vec![0; variants.len()]);
    for first in 0..variants[0].len() {
        // For each variant of the last part seen: the least sum, and where it comes from.
        let mut sums = vec![f64::INFINITY; variants[0].len()];
        sums[first] = 0.0;
        let mut from = Vec::new();
        for pair in variants.windows(2) {
            let least = |next: &Part| -> (f64, usize) {
                let ways = sums.iter().zip(&pair[0]).map(|(sum, before)| sum + between(before, next));
                ways.zip(0..).fold((f64::INFINITY, 0), |best, way| if way.0 < best.0 { way } else { best })
            };
            let (next, back): (Vec<f64>, Vec<usize>) = pair[1].iter().map(least).unzip();
            sums = next;
            from.push(back);
        }
        for (last, part) in variants[variants.len() - 1].iter().enumerate() {
            let sum = sums[last] + between(part, &variants[0][first]);
            if sum < best.0 {
                best.0 = sum;
                best.1[variants.len() - 1] = last;
                for (k, back) in from.iter().enumerate().rev() {
                    best.1[k] = back[best.1[k + 1]];
                }
            }
        }
    }
    best.1
}

/// What a part may mean: itself, backwards, and both on the other side of a seam.
fn variants(part: &Part, surface: &Nurbs, closed: [bool; 2]) -> Vec<Part> {
    let mut variants = vec![part.clone(), backwards(part)];
    for (k, [start, end]) in surface.domain().into_iter().enumerate().filter(|(k, _)| closed[*k]) {
        for width in [end - start, start - end] {
            let shift = Vec2::from_fn(|i, _| if i == k { width } else { 0.0 });
            let moved: Part = part.iter().map(|curve| curve.transformed(&Matrix2::identity(), &shift)).collect();
            variants.extend([backwards(&moved), moved]);
        }
    }
    variants
}

fn backwards(part: &Part) -> Part {
    part.iter().rev().map(Curve::reversed).collect()
}

/// Whether the surface meets itself at the ends of each parameter.
fn is_closed(surface: &Nurbs) -> [bool; 2] {
    let [u, v] = surface.domain();
    let within = |[a, b]: [f64; 2]| [0.0, 0.3, 0.7, 1.0].map(|t| a + (b - a) * t);
    let near = |a: [f64; 2], b: [f64; 2]| distance(surface, a, b) <= SAME;
    [within(v).iter().all(|&v| near([u[0], v], [u[1], v])), within(u).iter().all(|&u| near([u, v[0]], [u, v[1]]))]
}

/// What may be wrong with curves that go beyond a surface which meets itself.
pub(super) fn at_a_seam(surface: &Nurbs) -> &'static str {
    match is_closed(surface) {
        [false, false] => "",
        _ => {
            ": where the surface meets itself, at its seam, a loop must be split, or the seam be turned out of its way"
        }
    }
}

/// True where the surface is one point all along the line from `a` to `b`: at a pole.
fn is_point(surface: &Nurbs, a: &Vec2, b: &Vec2) -> bool {
    [0.25, 0.5, 0.7, 1.0].iter().all(|&t| distance(surface, (*a).into(), a.lerp(b, t).into()) <= SAME)
}

/// Between two points of the surface, over its size.
fn distance(surface: &Nurbs, a: [f64; 2], b: [f64; 2]) -> f64 {
    let (low, high) = surface.bounds();
    (surface.local(a).point - surface.local(b).point).norm() / (high - low).norm()
}

/// True when a sample of the curve is clearly outside the domain.
fn leaves(curve: &Curve<2>, domain: &[[f64; 2]; 2], size: &Vec2) -> bool {
    let inside = |x: f64, k: usize| x >= domain[k][0] - GAP * size[k] && x <= domain[k][1] + GAP * size[k];
    let mut samples = curve.knots().spans().flat_map(|[a, b]| [a, 0.5 * (a + b), b]);
    samples.any(|t| (0..2).any(|k| !inside(curve.local(t).point[k], k)))
}

/// The curve with lines that nearly meet sides of the domain moved there.
fn on_sides(curve: &Curve<2>, domain: &[[f64; 2]; 2]) -> Result<Curve<2>, String> {
    let mut points = curve.points().to_vec();
    for (k, [low, high]) in domain.iter().enumerate() {
        for limit in [low, high] {
            let is_near = |point: &Vec2| (point[k] - limit).abs() <= ON_SIDE * (high - low);
            let all = points.iter().all(is_near);
            let line = curve.knots().degree() == 1;
            points.iter_mut().filter(|point| all || line && is_near(point)).for_each(|point| point[k] = *limit);
        }
    }
    Curve::new(curve.knots().clone(), points, curve.weights().to_vec())
}

fn with_start(curve: &Curve<2>, start: Vec2) -> Result<Curve<2>, String> {
    let mut points = curve.points().to_vec();
    points[0] = start;
    Curve::new(curve.knots().clone(), points, curve.weights().to_vec())
}

fn start_of(curve: &Curve<2>) -> Vec2 {
    if is_clamped(curve, 0) { curve.points()[0] } else { curve.local(curve.domain()[0]).point }
}

fn end_of(curve: &Curve<2>) -> Vec2 {
    if is_clamped(curve, 1) { curve.points()[curve.points().len() - 1] } else { curve.local(curve.domain()[1]).point }
}

/// True when the curve begins (0) or ends (1) in a control point.
fn is_clamped(curve: &Curve<2>, end: usize) -> bool {
    curve.knots().multiplicity(curve.domain()[end]) > curve.knots().degree()
}
