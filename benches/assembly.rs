//! Assembly of one rank's rows: internal forces, and the tangent into its compressed rows. The difference to the element
//! kernels of `elements.rs` is the gathering and scattering. One rank: run as `cargo bench --bench assembly`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mpi::traits::*;
use nagata::model::Model;
use nagata::output::phases::Phases;
use nagata::system::dofs::Motion;
use nagata::system::{Axes, DofMap, Pattern, assembly};
use nagata::{Vec3, scene};
use std::hint::black_box;
use std::path::Path;

const SCENE: &str = r#"
[body.block]
block = { box = { size = [20, 20, 20] }, elements = [20, 20, 20] }
material = "rubber"
[material.rubber]
model = "neo-hookean"
young = 100
poisson = 0.3
[[step]]
increments = 1
fix = [{ set = "block.zmin" }]
"#;

fn assemble(criterion: &mut Criterion) {
    let Some(universe) = mpi::initialize() else { return };
    let world = universe.world();
    let parsed = scene::parse("bench.toml", SCENE, Path::new("."), &[]);
    let model = parsed.and_then(|s| Model::new(&world, &s, &Phases::default()));
    let mut model = model.unwrap_or_else(|e| panic!("{e}"));
    let held: Vec<_> = model.part.points.iter().flat_map(|x| [(x.z == 0.0).then_some(Motion::still(0.0)); 3]).collect();
    let dofs = DofMap::new(&world, &model, (&held, &Axes::default()), &[], Vec::new());
    let points = model.part.points.clone();
    let place = |n: u32| points[n as usize];
    let pattern = Pattern::new(&world, &model, &dofs, place).unwrap();
    let u: Vec<Vec3> = model.part.points.iter().map(|x| 1e-3 * x.z * Vec3::new(x.x, x.z, -x.z)).collect();
    let mut forces = vec![Vec3::zeros(); u.len()];
    let mut values = vec![0.0; pattern.columns.len()];

    let mut group = criterion.benchmark_group("assembly of 20^3 hex8 neo-hookean");
    group.sample_size(20);
    group.throughput(Throughput::Elements(model.part.solids.len() as u64));
    group.bench_function("internal forces", |b| {
        b.iter(|| {
            forces.fill(Vec3::zeros());
            let _ = black_box(assembly::internal_forces(&model, &u, &mut forces, None, |_, _, _| ()));
        });
    });
    group.bench_function("internal forces and tangent", |b| {
        b.iter(|| {
            forces.fill(Vec3::zeros());
            values.fill(0.0);
            let tangent = Some((&pattern, &mut values[..]));
            let _ = black_box(assembly::internal_forces(&model, &u, &mut forces, tangent, |_, _, _| ()));
        });
    });
    group.bench_function("tangent", |b| {
        b.iter(|| {
            values.fill(0.0);
            assembly::add_tangent(&mut model, &pattern, black_box(&u), &mut values);
        });
    });
    group.bench_function("pattern", |b| {
        b.iter(|| black_box(Pattern::new(&world, &model, &dofs, place).unwrap()).columns.len())
    });
    group.finish();
    assert_eq!(world.size(), 1);
}

criterion_group!(benches, assemble);
criterion_main!(benches);
