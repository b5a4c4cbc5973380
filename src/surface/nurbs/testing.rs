//! Random curves and surfaces, and derivatives by differences.

use super::{Bezier, Curve, KnotVector, Nurbs};
use crate::Vec3;
use crate::surface::Local;
use nalgebra::SVector;
use proptest::collection::vec;
use proptest::prelude::*;

/// Clamped and unclamped knot vectors of degrees 1 to 7 with inner knots of any multiplicity.
pub fn knot_vectors() -> impl Strategy<Value = KnotVector> {
    (1..=7_usize, vec((0.1..1.0, 1..=7_usize), 1..5), prop::bool::ANY, -2.0..2.0).prop_map(
        |(p, gaps, clamped, start)| {
            let outer = |k: usize| if clamped { 0.0 } else { k as f64 * 0.4 };
            let mut knots: Vec<f64> = (0..=p).rev().map(|k| start - outer(k)).collect();
            let mut t = start;
            for (k, (gap, multiplicity)) in gaps.iter().enumerate() {
                t += gap;
                let last = k == gaps.len() - 1;
                knots.extend(vec![t; if last { 1 } else { *multiplicity.min(&p) }]);
            }
            knots.extend((1..=p).map(|k| t + outer(k)));
            KnotVector::new(p, knots).unwrap()
        },
    )
}

fn controls<const D: usize>(count: usize) -> impl Strategy<Value = (Vec<SVector<f64, D>>, Vec<f64>)> {
    let point = vec(-1.0..1.0, D).prop_map(|x| SVector::from_fn(|a, _| x[a]));
    (vec(point, count), vec(0.5..2.0, count), prop::bool::ANY).prop_map(|(points, weights, rational)| {
        let weights = if rational { weights } else { vec![2.0; weights.len()] };
        (points, weights)
    })
}

pub fn curves<const D: usize>() -> impl Strategy<Value = Curve<D>> {
    knot_vectors().prop_flat_map(|knots| {
        controls(knots.count()).prop_map(move |(points, weights)| Curve::new(knots.clone(), points, weights).unwrap())
    })
}

pub fn surfaces() -> impl Strategy<Value = Nurbs> {
    (knot_vectors(), knot_vectors()).prop_flat_map(|(a, b)| {
        controls(a.count() * b.count())
            .prop_map(move |(points, weights)| Nurbs::new([a.clone(), b.clone()], points, weights).unwrap())
    })
}

pub fn patches() -> impl Strategy<Value = Bezier> {
    [1..=7_usize, 1..=7_usize].prop_flat_map(|degrees| {
        controls((degrees[0] + 1) * (degrees[1] + 1))
            .prop_map(move |(points, weights)| Bezier::new(degrees, points, weights).unwrap())
    })
}

/// The derivative of `f` at 0, by five points with step `h`.
pub fn derivative<const D: usize>(h: f64, f: impl Fn(f64) -> SVector<f64, D>) -> SVector<f64, D> {
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

/// All derivatives of a surface at `xi` against differences with steps of `h`.
pub fn check_derivatives(h: [f64; 2], xi: [f64; 2], local: impl Fn([f64; 2]) -> Local) {
    let here = local(xi);
    for a in 0..2 {
        let at = |s: f64| local(std::array::from_fn(|b| xi[b] + if a == b { s } else { 0.0 }));
        close(&here.tangents[a], &derivative(h[a], |s| at(s).point), 1e-7);
        for b in 0..2 {
            close(&here.second[a + b], &derivative(h[a], |s| at(s).tangents[b]), 1e-7);
        }
    }
}

/// Fails unless `a` and `b` agree within `tolerance` times the larger of 1 and their size.
#[track_caller]
pub fn close<const D: usize>(a: &SVector<f64, D>, b: &SVector<f64, D>, tolerance: f64) {
    assert!((a - b).norm() <= tolerance * a.norm().max(1.0), "{a} is not {b}: {:e}", (a - b).norm());
}

/// Fails unless `point` is the point of `curve` at `t`, which is known up to rounding.
#[track_caller]
pub fn on_curve<const D: usize>(point: &SVector<f64, D>, curve: &Curve<D>, t: f64) {
    let here = curve.local(t);
    close(point, &here.point, 5e-14 + 4.0 * f64::EPSILON * t.abs() * here.first.norm());
}

/// Fails unless `x` lies in the box up to rounding.
#[track_caller]
pub fn inside<const D: usize>(x: &SVector<f64, D>, (low, high): &(SVector<f64, D>, SVector<f64, D>)) {
    let margin = 1e-14 * low.amax().max(high.amax());
    assert!((0..D).all(|a| low[a] - margin <= x[a] && x[a] <= high[a] + margin), "{x} outside {low} {high}");
}

/// Points of a regular grid on the rectangle `domain`.
pub fn grid(n: usize, domain: [[f64; 2]; 2]) -> impl Iterator<Item = [f64; 2]> {
    let at = move |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / n as f64;
    (0..=n).flat_map(move |j| (0..=n).map(move |i| [at(domain[0], i), at(domain[1], j)]))
}

/// A vector without symmetry, for axes and directions.
pub fn oblique() -> Vec3 {
    Vec3::new(0.3, -0.5, 0.8)
}
