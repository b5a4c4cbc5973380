//! Increments that fail and are tried again in halves leave no trace in the result.

mod common;

use common::{Bench, assert_small};

/// A roll is pressed into a slab and drawn along it, in two steps of so many increments.
fn rolling(friction: f64, increments: usize) -> Bench {
    Bench::new(&format!(
        r#"
        [body.slab]
        block = {{ box = {{ origin = [-4.0, -3.0, 0.0], size = [8.0, 3.0, 0.5] }}, elements = [16, 4, 1] }}
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.roll]
        cylinder = {{ point = [0.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 4.0 }}
        [contact.top]
        slave = "slab.ymax"
        master = "roll"
        friction = {friction:?}
        reach = 3.0 # no node comes from farther away
        [[step]]
        increments = {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [1.0, -1.2, 0.0] }}]
        [[step]]
        increments = {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [-2.0, 0.0, 0.0] }}]
        [output]
        every = 100
        history = ["slab.ymin", "slab.xmax"]
        "#
    ))
}

const SETS: [&str; 3] = ["roll", "slab.ymin", "slab.xmax"];

/// Without friction the end does not depend on the way.
#[test]
fn frictionless_end() {
    let bench = rolling(0.0, 3);
    let plain = bench.solve(2, &[]);
    let cut = bench.solve(2, &["--set", "solver.max_iterations=3"]);
    assert_eq!(plain.summary()["cutbacks"], 0);
    let cutbacks = cut.summary()["cutbacks"].as_u64().unwrap();
    println!("{cutbacks} cutbacks, {} increments", cut.history().len());
    assert!(cutbacks >= 3);
    let (plain, cut) = (plain.history(), cut.history());
    // The times of the plain run are met, whatever was cut.
    for (k, time) in plain.column("time").iter().enumerate() {
        let at = cut.column("time").iter().position(|t| (t - time).abs() < 1e-12).unwrap();
        assert_small(&format!("at time {time}"), cut.row_difference(at, &plain, k, &SETS), 1e-8);
    }
}

/// With friction the way counts: when each step fails as a whole, for it takes more iterations than its halves do, the run
/// is the one with halves from the beginning. A failed attempt that left a multiplier, a slip origin, a status or a tool
/// behind would show.
#[test]
fn frictional_way() {
    let (whole, halves) = (rolling(0.3, 1), rolling(0.3, 2).solve(2, &[]).history());
    let uncut = whole.solve(2, &[]).history();
    println!("iterations {:?}, in halves {:?}", uncut.column("iterations"), halves.column("iterations"));
    let enough = halves.column("iterations").iter().fold(0.0f64, |m, n| m.max(*n));
    let cut = whole.solve(2, &["--set", &format!("solver.max_iterations={enough}")]);
    assert_eq!(cut.summary()["cutbacks"], 2);
    let cut = cut.history();
    assert_eq!((cut.len(), halves.len()), (4, 4));
    for k in 0..4 {
        assert_small(&format!("increment {}", k + 1), cut.row_difference(k, &halves, k, &SETS), 1e-8);
    }
    assert!(uncut.row_difference(1, &halves, 3, &SETS) > 1e-4, "the way matters");
}
