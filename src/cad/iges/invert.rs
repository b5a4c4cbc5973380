//! From a curve in space that lies on a surface to the same curve in the parameters of the surface.
//!
//! The parameters xi(t) of C(t) minimise |S(xi) - C(t)|. Their derivatives solve, by least squares,
//!
//! ```text
//!     S,a xi_a' = C',        S,a xi_a'' = C'' - S,ab xi_a' xi_b'
//! ```
//!
//! At a pole, where a tangent vanishes, they are taken nearby and extended by Taylor's formula.

use super::fit::{Jet, fit};
use super::loops::at_a_seam;
use crate::Vec3;
use crate::surface::{Curve, CurveLocal, Local, Nurbs};
use nalgebra::{Matrix2, Matrix3x2, Vector2};

type Vec2 = Vector2<f64>;

/// How far the curve may be off the surface, over the size of the surface.
const OFF: f64 = 1e-3;
/// Error of the points in space, over the size of the surface.
const TOLERANCE: f64 = 1e-8;
/// Length of a tangent of a pole, for parameters from 0 to 1, over the size of the surface, and how far from it along a
/// curve of that length it is left.
const POLE: f64 = 1e-6;
const BESIDE: f64 = 1e-3;
/// Of [`nearest`], over the square of the size of the surface.
const STIFFNESS: f64 = 1e-12;
/// Samples of each span of the surface in search of a start, and steps from the middle of a curve to its ends.
const SAMPLES: usize = 4;
const STEPS: usize = 16;

/// The curves in the parameters, one for each span of `curve`. Fails, saying why, where the curve leaves the surface.
pub(super) fn invert(surface: &Nurbs, curve: &Curve<3>) -> Result<Vec<Curve<2>>, String> {
    let mut guess = None;
    let mut curves = Vec::new();
    for (_, span) in curve.beziers() {
        let curve = invert_smooth(surface, &span, guess)?;
        guess = Some(curve.local(0.5).point);
        curves.push(curve);
    }
    Ok(curves)
}

/// For a curve on [0, 1] without corners.
fn invert_smooth(surface: &Nurbs, curve: &Curve<3>, guess: Option<Vec2>) -> Result<Curve<2>, String> {
    let (low, high) = surface.bounds();
    let size = (high - low).norm();
    let most = OFF * size;
    let widths = surface.domain().map(|[start, end]| end - start);
    // Where the surface closes on itself, a curve may end on the seam: its inside tells on which side.
    let x = curve.local(0.5).point;
    let near = guess.map(|guess| nearest(surface, &guess, &x));
    let near = near.filter(|xi| (surface.local((*xi).into()).point - x).norm() <= most);
    let middle = near.unwrap_or_else(|| nearest(surface, &start(surface, &x), &x));
    let walk = |end: f64| {
        let steps = (1..=STEPS).map(|k| 0.5 + (end - 0.5) * k as f64 / STEPS as f64);
        steps.fold(middle, |xi, t| nearest(surface, &xi, &curve.local(t).point))
    };
    let mut worst: f64 = 0.0;
    let mut regular = |t: f64, guess: &Vec2| {
        let target = curve.local(t);
        let xi = nearest(surface, guess, &target.point);
        let local = surface.local(xi.into());
        worst = worst.max((local.point - target.point).norm());
        let tangents = [0, 1].map(|k| local.tangents[k].norm() * widths[k]);
        if worst > most { None } else { Some((jet(xi, &local, &target), tangents[0].min(tangents[1]) > POLE * size)) }
    };
    let sample = |t: f64, guess: &Vec2| match regular(t, guess)? {
        (jet, true) => jet,
        _ => {
            let beside = if t < 0.5 { t + BESIDE } else { t - BESIDE };
            let (jet, h) = (regular(beside, &walk(beside))?.0?, t - beside);
            let first = jet.first + jet.second * h;
            Some(Jet { point: jet.point + (jet.first + first) * (0.5 * h), first, second: jet.second })
        }
    };
    let point = |xi: &Vec2| surface.local((*xi).into()).point;
    let is_close = |a: &Vec2, b: &Vec2| (point(a) - point(b)).norm() <= TOLERANCE * size;
    match fit([0.0, 1.0], [walk(0.0), walk(1.0)], sample, is_close) {
        Some(curve) => Ok(curve),
        None if worst > most => {
            Err(format!("the curve in space is {worst:.3e} away from the surface{}", at_a_seam(surface)))
        }
        None => Err("the curve in space cannot be followed in the parameters of the surface".into()),
    }
}

fn jet(xi: Vec2, local: &Local, target: &CurveLocal<3>) -> Option<Jet> {
    let tangents = Matrix3x2::from_columns(&local.tangents);
    let inverse = (tangents.transpose() * tangents).try_inverse()?;
    let solve = |right: Vec3| inverse * (tangents.transpose() * right);
    let first = solve(target.first);
    let [s11, s12, s22] = local.second;
    let bend = s11 * (first.x * first.x) + s12 * (2.0 * first.x * first.y) + s22 * (first.y * first.y);
    let second = solve(target.second - bend);
    second.iter().all(|x| x.is_finite()).then_some(Jet { point: xi, first, second })
}

/// The nearest of a grid of samples.
fn start(surface: &Nurbs, x: &Vec3) -> Vec2 {
    let samples = |direction: usize| -> Vec<f64> {
        let spans = surface.knots()[direction].spans();
        spans
            .flat_map(|[low, high]| (0..=SAMPLES).map(move |k| low + (high - low) * k as f64 / SAMPLES as f64))
            .collect()
    };
    let (mut best, mut least) = (Vec2::zeros(), f64::INFINITY);
    let along_v = samples(1);
    for u in samples(0) {
        for &v in &along_v {
            let distance = (surface.local([u, v]).point - x).norm_squared();
            if distance < least {
                (best, least) = (Vec2::new(u, v), distance);
            }
        }
    }
    best
}

/// Newton's method for the nearest point, in the domain; falls back on Gauss and Newton's, and shorter steps. Where the
/// surface does not change with a parameter, at a pole, a little stiffness holds it.
fn nearest(surface: &Nurbs, start: &Vec2, x: &Vec3) -> Vec2 {
    let [u, v] = surface.domain();
    let (low, high) = surface.bounds();
    let widths = [u[1] - u[0], v[1] - v[0]];
    let stiffness =
        Matrix2::from_diagonal(&widths.map(|width| STIFFNESS * (high - low).norm_squared() / width.powi(2)).into());
    let inside = |xi: Vec2| Vec2::new(xi.x.clamp(u[0], u[1]), xi.y.clamp(v[0], v[1]));
    let mut xi = inside(*start);
    for _ in 0..50 {
        let local = surface.local(xi.into());
        let r = x - local.point;
        let tangents = Matrix3x2::from_columns(&local.tangents);
        let gradient = tangents.transpose() * r;
        let metric = tangents.transpose() * tangents + stiffness;
        let bend = local.second.map(|second| second.dot(&r));
        let full = metric - Matrix2::new(bend[0], bend[1], bend[1], bend[2]);
        let is_safe = full.determinant() > 0.1 * metric.determinant() && full.trace() > 0.0;
        let matrix = if is_safe { full } else { metric };
        let Some(mut step) = matrix.try_inverse().map(|inverse| inverse * gradient) else { break };
        // On a side of the domain that the step would cross it goes along the side.
        for (k, [low, high]) in surface.domain().into_iter().enumerate() {
            if xi[k] <= low && step[k] < 0.0 || xi[k] >= high && step[k] > 0.0 {
                step = Vec2::from_fn(|i, _| if i == k { 0.0 } else { gradient[i] / matrix[(i, i)] });
            }
        }
        let mut scale = 1.0;
        let mut next = inside(xi + step);
        while (surface.local(next.into()).point - x).norm_squared() > r.norm_squared() && scale > 1e-3 {
            scale *= 0.5;
            next = inside(xi + step * scale);
        }
        let moved = next - xi;
        xi = next;
        if (0..2).all(|k| moved[k].abs() <= 1e-15 * widths[k]) {
            break;
        }
    }
    xi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_on_a_cylinder_ends_on_both_sides_of_the_seam() {
        let wall = Curve::line(Vec3::x() * 2.0, Vec3::new(2.0, 0.0, 3.0));
        let cylinder = Nurbs::revolution(&wall, Vec3::zeros(), Vec3::z(), [0.0, std::f64::consts::TAU]).unwrap();
        let circle = Curve::arc(Vec3::z() * 1.5, Vec3::x(), Vec3::y(), 2.0, [0.0, std::f64::consts::TAU]).unwrap();
        let curves = invert(&cylinder, &circle).unwrap();
        assert_eq!(curves.len(), 4);
        let mut end = 0.0;
        for (curve, (_, arc)) in curves.iter().zip(circle.beziers()) {
            assert!((curve.local(0.0).point - Vec2::new(0.5, end)).amax() < 1e-12);
            end = curve.local(1.0).point.y;
            for k in 0..=20 {
                let t = k as f64 / 20.0;
                let xi = curve.local(t).point;
                assert!((cylinder.local([xi.x, xi.y]).point - arc.local(t).point).norm() < 1e-8);
            }
        }
        assert!((end - std::f64::consts::TAU).abs() < 1e-12);
    }

    #[test]
    fn curves_off_the_surface_are_refused() {
        let plane = Nurbs::plane(Vec3::zeros(), Vec3::x(), Vec3::y());
        let line = Curve::line(Vec3::new(0.1, 0.1, 0.0), Vec3::new(0.9, 0.8, 0.1));
        assert!(invert(&plane, &line).unwrap_err().contains("away from the surface"));
        let line = Curve::line(Vec3::new(0.1, 0.1, 0.0), Vec3::new(0.9, 0.8, 0.0));
        let ends = invert(&plane, &line).unwrap();
        assert!((ends[0].local(1.0).point - Vec2::new(0.9, 0.8)).amax() < 1e-14);
    }
}
