//! Evaluation of a Nagata patch, and projection onto the unit sphere in each description: points onto a band of 600
//! pieces, one by one; and a million points, search included, onto 10,000.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nagata::Vec3;
use nagata::mesh::{Facet, Mesh};
use nagata::scene::Smoothing;
use nagata::surface::analytic::Sphere;
use nagata::surface::{
    Analytic, Curve, Face, FaceSet, KnotVector, NormalOptions, Nurbs, PatchSet, Projection, patches_from_mesh, sew,
};
use std::f64::consts::TAU;
use std::hint::black_box;

/// Half of the height of the band, radians.
const HALF: f64 = 0.6;

fn on_sphere(turn: f64, height: f64) -> Vec3 {
    Vec3::new(turn.cos() * height.cos(), turn.sin() * height.cos(), height.sin())
}

/// The band in m by n quadrilaterals.
fn band(m: u32, n: u32) -> Mesh {
    let node = |i: u32, j: u32| j * m + i % m;
    let mut mesh = Mesh { source: "band".into(), ..Mesh::default() };
    for j in 0..=n {
        for i in 0..m {
            let height = HALF * (2.0 * j as f64 / n as f64 - 1.0);
            mesh.points.push(on_sphere(TAU * i as f64 / m as f64, height).into());
        }
    }
    for j in 0..n {
        for i in 0..m {
            let nodes = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            mesh.facets.push(Facet { count: 4, nodes, id: mesh.facets.len() as u64 });
        }
    }
    mesh
}

fn patches(m: u32, n: u32, smoothing: Smoothing) -> PatchSet {
    PatchSet::new(patches_from_mesh(&band(m, n), smoothing, &NormalOptions::default(), false).unwrap_or_default())
}

/// Bézier points of the cubic through four points at 0, 1/3, 2/3 and 1.
fn cubic([a, b, c, d]: [Vec3; 4]) -> [Vec3; 4] {
    [a, (a * -5.0 + b * 18.0 - c * 9.0 + d * 2.0) / 6.0, (a * 2.0 - b * 9.0 + c * 18.0 - d * 5.0) / 6.0, d]
}

/// The band in m by n bicubic Bézier patches.
fn bezier(m: u32, n: u32) -> Option<FaceSet> {
    let mut faces = Vec::new();
    for k in 0..m * n {
        let (i, j) = ((k % m) as f64, (k / m) as f64);
        let at = |s: usize, t: usize| {
            let height = HALF * (2.0 * (j + t as f64 / 3.0) / n as f64 - 1.0);
            on_sphere(TAU * (i + s as f64 / 3.0) / m as f64, height)
        };
        let rows: [[Vec3; 4]; 4] = std::array::from_fn(|t| cubic(std::array::from_fn(|s| at(s, t))));
        let columns: [[Vec3; 4]; 4] = std::array::from_fn(|s| cubic(std::array::from_fn(|t| rows[t][s])));
        let control = (0..16).map(|k| columns[k % 4][k / 4]).collect();
        let surface = Nurbs::new([KnotVector::bezier(3), KnotVector::bezier(3)], control, vec![1.0; 16]).ok()?;
        faces.push(Face { surface, loops: Vec::new(), reversed: false, name: format!("patch {k}") });
    }
    Some(FaceSet::new(&sew(&faces, 0.5, 1e-6, false).ok()?))
}

/// The band as one rational biquadratic face, cut into pieces by the set.
fn nurbs() -> Option<FaceSet> {
    let arc = Curve::arc(Vec3::zeros(), Vec3::x(), Vec3::z(), 1.0, [-HALF, HALF]).ok()?;
    let surface = Nurbs::revolution(&arc, Vec3::zeros(), Vec3::z(), [0.0, TAU]).ok()?;
    let face = Face { surface, loops: Vec::new(), reversed: true, name: "band".into() };
    Some(FaceSet::new(&sew(&[face], 0.5, 1e-6, false).ok()?))
}

type Closest<'a> = Box<dyn Fn(&Vec3, Option<(u32, [f64; 2])>) -> Option<Projection> + 'a>;

fn projection(c: &mut Criterion) {
    let (facets, nagata) = (patches(60, 10, Smoothing::Facet), patches(60, 10, Smoothing::Nagata));
    let patch = nagata.patches()[300];
    c.bench_function("evaluate a Nagata patch", |b| b.iter(|| black_box(&patch).local(black_box([0.3, 0.7]))));

    let (Some(bezier), Some(nurbs)) = (bezier(60, 10), nurbs()) else { return };
    let sphere = Analytic::Sphere(Sphere { center: Vec3::zeros(), radius: 1.0, hollow: false });
    let descriptions: [(&str, Closest); 5] = [
        ("facets", Box::new(|x, warm| facets.closest(x, 0.5, warm))),
        ("Nagata", Box::new(|x, warm| nagata.closest(x, 0.5, warm))),
        ("bicubic Bézier", Box::new(|x, warm| bezier.closest(x, 0.5, warm))),
        ("NURBS", Box::new(|x, warm| nurbs.closest(x, 0.5, warm))),
        ("sphere", Box::new(|x, _| sphere.closest(x, 0.5, None))),
    ];
    let x = Vec3::new(0.62, 0.75, 0.2).normalize() * 1.01;
    for (name, closest) in &descriptions {
        let start = closest(&x, None).map(|p| (p.patch, [p.xi[0] + 0.01, p.xi[1] - 0.01]));
        c.bench_function(&format!("project, {name}, near the last"), |b| b.iter(|| closest(black_box(&x), start)));
        c.bench_function(&format!("project, {name}, from nothing"), |b| b.iter(|| closest(black_box(&x), None)));
    }
}

fn a_million(c: &mut Criterion) {
    const POINTS: u64 = 1_000_000;
    let mut group = c.benchmark_group("a million points on 10,000 patches");
    group.sample_size(10).throughput(Throughput::Elements(POINTS));
    // Irrational steps spread the points evenly, in no order that a search could profit from.
    let fraction = |k: u64, step: f64| (k as f64 * step).fract();
    let point = |k: u64| {
        let height = HALF * (1.9 * fraction(k, 2f64.sqrt()) - 0.95);
        on_sphere(TAU * fraction(k, 3f64.sqrt()), height) * (0.99 + 0.02 * fraction(k, 5f64.sqrt()))
    };
    let points: Vec<Vec3> = (0..POINTS).map(point).collect();
    for (name, smoothing) in [("facets", Smoothing::Facet), ("Nagata", Smoothing::Nagata)] {
        let set = patches(250, 40, smoothing);
        let project = || points.iter().filter(|x| set.closest(x, 0.5, None).is_some()).count();
        group.bench_function(name, |b| b.iter(project));
    }
    group.finish();
    c.bench_function("normals, patches and search tree of 10,000", |b| b.iter(|| patches(250, 40, Smoothing::Nagata)));
}

criterion_group!(benches, projection, a_million);
criterion_main!(benches);
