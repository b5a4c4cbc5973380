//! Evaluation of a Nagata patch, and projection of points onto a sphere of 600 patches, Nagata and facets.

use criterion::{Criterion, criterion_group, criterion_main};
use nagata::Vec3;
use nagata::mesh::{Facet, Mesh};
use nagata::scene::Smoothing;
use nagata::surface::{PatchSet, patches_from_mesh};
use std::hint::black_box;

/// A band of the unit sphere, 60 by 10 quadrilaterals.
fn band() -> Mesh {
    let (m, n) = (60, 10);
    let node = |i: u32, j: u32| j * m + i % m;
    let mut mesh = Mesh { source: "band".into(), ..Mesh::default() };
    for j in 0..=n {
        for i in 0..m {
            let a = 2.0 * std::f64::consts::PI * i as f64 / m as f64;
            let b = 1.2 * (j as f64 / n as f64 - 0.5);
            mesh.points.push([a.cos() * b.cos(), a.sin() * b.cos(), b.sin()]);
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

fn projection(c: &mut Criterion) {
    let set = |smoothing| PatchSet::new(patches_from_mesh(&band(), smoothing, 40.0, false).unwrap_or_default());
    let (nagata, facets) = (set(Smoothing::Nagata), set(Smoothing::Facet));
    let x = Vec3::new(0.62, 0.75, 0.2).normalize() * 1.01;
    let warm = |set: &PatchSet| set.closest(&x, 0.5, None).map(|p| (p.patch, [p.xi[0] + 0.01, p.xi[1] - 0.01]));
    let (nagata_start, facet_start) = (warm(&nagata), warm(&facets));
    let patch = nagata.patches()[300];
    c.bench_function("evaluate a Nagata patch", |b| b.iter(|| black_box(&patch).local(black_box([0.3, 0.7]))));
    c.bench_function("project, Nagata, warm", |b| b.iter(|| nagata.closest(black_box(&x), 0.5, nagata_start)));
    c.bench_function("project, Nagata, cold", |b| b.iter(|| nagata.closest(black_box(&x), 0.5, None)));
    c.bench_function("project, facets, warm", |b| b.iter(|| facets.closest(black_box(&x), 0.5, facet_start)));
    c.bench_function("project, facets, cold", |b| b.iter(|| facets.closest(black_box(&x), 0.5, None)));
}

criterion_group!(benches, projection);
criterion_main!(benches);
