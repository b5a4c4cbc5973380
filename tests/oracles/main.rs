//! Contact against values that others published, and against closed forms, by default settings.
//!
//! One file a scene. Each opens with a sketch, the source and the constants; each prints its rows of one table:
//!
//!     cargo test --release --test oracles -- --nocapture
//!
//! Finer meshes that show convergence, and what takes more than 20 s, run with `--ignored`; all together by
//! `scripts/test --oracles`. `NAGATA_ORACLE_METHOD=lagrange` (or another) has every contact
//! that the scene leaves to the default take that method.

#[path = "../common/mod.rs"]
mod common;
mod grid;
mod table;

mod belt;
mod carter;
mod cattaneo_mindlin;
mod four_bodies;
mod greco_plate;
mod incline;
mod nafems_punch;
mod nafems_roller;
mod patch;
mod rings;
mod spheres;
mod torsion;
mod wheel;

/// A scene with the meshes that it names.
fn bench(scene: &str, meshes: &[(&str, String)]) -> common::Bench {
    let scene = match std::env::var("NAGATA_ORACLE_METHOD") {
        Ok(method) => scene.replace("slave = ", &format!("method = \"{method}\"\nslave = ")),
        Err(_) => scene.to_string(),
    };
    let bench = common::Bench::new(&scene);
    for (name, text) in meshes {
        bench.write(name, text);
    }
    bench
}

/// Runs a scene by default settings, and says how it went: what took cuts of increments or jumps is worth a look.
fn solve(ranks: usize, scene: &str, meshes: &[(&str, String)]) -> common::Run {
    let run = bench(scene, meshes).solve(ranks, &[]);
    let summary = run.summary();
    println!(
        "{} dofs, {} increments, {} iterations, {} cut, {} jumps, {:.1} s",
        summary["dofs"],
        summary["increments"],
        summary["iterations"],
        summary["cutbacks"],
        summary["jumps"],
        summary["wall_s"].as_f64().unwrap()
    );
    run
}

/// Of the nodes of a contact on the plane z = 0: first coordinate and value.
fn along_x(run: &common::Run, contact: &str, values: &[f64]) -> Vec<(f64, f64)> {
    let points = run.points(contact);
    points.iter().zip(values).filter(|(x, _)| x[2] == 0.0).map(|(x, v)| (x[0], *v)).collect()
}

/// Mean value at the points that `at` takes.
fn mean(points: &[[f64; 3]], values: &[f64], at: impl Fn(&[f64; 3]) -> bool) -> f64 {
    let there: Vec<f64> = points.iter().zip(values).filter(|(x, _)| at(x)).map(|(_, v)| *v).collect();
    assert!(!there.is_empty());
    there.iter().sum::<f64>() / there.len() as f64
}

/// One component of vectors.
fn component(vectors: &[[f64; 3]], d: usize) -> Vec<f64> {
    vectors.iter().map(|v| v[d]).collect()
}
