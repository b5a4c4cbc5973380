//! Points with first and second derivatives of Bézier patches and of a NURBS surface, and the patches of the surface.

use criterion::{Criterion, criterion_group, criterion_main};
use nagata::Vec3;
use nagata::surface::{Bezier, Curve, Nurbs};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::hint::black_box;

fn patch(p: usize, q: usize, rational: bool) -> Option<Bezier> {
    let count = (p + 1) * (q + 1);
    let control = (0..count).map(|k| Vec3::new((k % (p + 1)) as f64, (k / (p + 1)) as f64, (k as f64).sin())).collect();
    let weights = (0..count).map(|k| if rational { 1.0 + 0.3 * (k as f64).cos() } else { 1.0 }).collect();
    Bezier::new([p, q], control, weights).ok()
}

fn sphere() -> Option<Nurbs> {
    let half = Curve::arc(Vec3::zeros(), Vec3::x(), Vec3::z(), 1.0, [-FRAC_PI_2, FRAC_PI_2]).ok()?;
    Nurbs::revolution(&half, Vec3::zeros(), Vec3::z(), [0.0, TAU]).ok()
}

fn nurbs(c: &mut Criterion) {
    for (p, q, rational) in [(1, 1, false), (2, 1, true), (2, 2, true), (3, 3, false), (3, 3, true)] {
        let name = format!("evaluate a Bézier patch, {p} by {q}{}", if rational { ", rational" } else { "" });
        if let Some(patch) = patch(p, q, rational) {
            c.bench_function(&name, |b| b.iter(|| black_box(&patch).local(black_box([0.3, 0.7]))));
        }
    }
    if let Some(sphere) = sphere() {
        c.bench_function("evaluate a NURBS sphere", |b| b.iter(|| black_box(&sphere).local(black_box([0.3, 0.7]))));
        c.bench_function("Bézier patches of a NURBS sphere", |b| b.iter(|| black_box(&sphere).beziers()));
    }
}

criterion_group!(benches, nurbs);
criterion_main!(benches);
