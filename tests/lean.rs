//! Only what a scene asks for is carried and computed: equations of contact where nodes are near their master, nothing
//! for features that the scene does not have.

mod common;

use common::{Bench, Run, assert_small, on_ranks};
use nagata::analysis::Simulation;
use nagata::scene;
use petsc::Petsc;
use serde_json::Value;
use std::path::Path;

/// ```text
///        ( O )  ->            A roller drawn along a bar of 60 elements, of which it touches a few.
///    ______________________
///   |______________________|
/// ```
const BAR: &str = r#"
[body.bar]
material = "rubber"
plane_strain = true
block = { box = { size = [60, 4, 1] }, elements = [60, 4, 1], faces = { bottom = "ymin", top = "ymax" } }
[material.rubber]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[material.metal]
model = "j2"
young = 10.0
poisson = 0.3
yield_stress = 0.2
hardening = { linear = 1.0 }
[tool.roller]
cylinder = { point = [10.3, 7.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 3.0 }
[contact.top]
slave = "bar.top"
master = "roller"
friction = 0.3
[[step]]
name = "press"
increments = 3
fix = [{ set = "bar.bottom" }]
move = [{ target = "roller", by = [0.0, -0.2, 0.0] }]
[[step]]
name = "slide"
increments = 24
fix = [{ set = "bar.bottom" }]
move = [{ target = "roller", by = [12.0, 0.0, 0.0] }]
[output]
every = 100
history = ["bar.bottom"]
"#;

fn count(run: &Run, key: &str) -> u64 {
    run.summary()[key].as_u64().unwrap()
}

/// All nodes are near with a long reach: what had no equations makes no difference.
#[test]
fn nodes_far_from_the_master_do_without_equations() {
    let bench = Bench::new(BAR);
    for (ranks, sets) in [
        (1, vec![]),
        (2, vec![]),
        (1, vec!["contact.top.friction=0"]),
        (1, vec!["contact.top.method=lagrange"]),
        (1, vec!["solver.linear=iterative"]),
        (2, vec!["body.bar.material=metal", "tool.roller.cylinder.radius=2.9"]),
        (1, vec!["solver.max_iterations=4", "step.slide.increments=6"]),
    ] {
        let run = |more: &[&str]| {
            let entries = sets.iter().chain(more).flat_map(|entry| ["--set", entry]);
            bench.solve(ranks, &entries.collect::<Vec<_>>())
        };
        let [lean, full] = [run(&[]), run(&["contact.top.reach=100"])];
        let width = if sets.contains(&"contact.top.friction=0") { 1 } else { 2 };
        assert_eq!((count(&full, "multipliers"), count(&full, "growths")), (61 * width, 0), "{sets:?}");
        let [multipliers, growths] = ["multipliers", "growths"].map(|key| count(&lean, key));
        assert!(multipliers < 16 * width && (3..20).contains(&growths), "{sets:?}: {multipliers} {growths}");
        assert_eq!(count(&full, "dofs") - count(&lean, "dofs"), 61 * width - multipliers);
        for key in ["increments", "iterations", "cutbacks"] {
            assert_eq!(count(&lean, key), count(&full, key), "{sets:?}: {key}");
        }
        assert_eq!(sets.contains(&"solver.max_iterations=4"), count(&lean, "cutbacks") > 0);
        assert_small(&format!("{sets:?}"), lean.history().difference(&full.history()), 1e-9);
    }
}

/// What one goes back to may have had other equations than are there now.
#[test]
fn one_goes_back_to_other_equations() {
    on_ranks("one_goes_back_to_other_equations", &[1, 2], |comm| {
        let petsc = Petsc::initialize(comm, &[]).unwrap();
        let scene = scene::parse("bar", BAR, Path::new("."), &[]).unwrap();
        let mut simulation = Simulation::new(comm, &petsc, &scene).unwrap();
        let advance = |simulation: &mut Simulation, count: usize| {
            for _ in 0..count {
                simulation.advance(&mut |_| Ok(())).unwrap().unwrap();
            }
            simulation.tool("roller").unwrap().force
        };
        simulation.begin(&scene.steps[0]).unwrap();
        advance(&mut simulation, 3);
        simulation.begin(&scene.steps[1]).unwrap();
        advance(&mut simulation, 4);
        let (then, growths) = (simulation.checkpoint(), simulation.summary().counts.growths);
        let force = advance(&mut simulation, 12);
        assert!(simulation.summary().counts.growths > growths + 1);
        simulation.go_back(&then).unwrap();
        let again = advance(&mut simulation, 12);
        assert!((force - again).norm() < 1e-10 * force.norm(), "{force} {again}");
    });
}

/// A tool that nothing is near to yet: equations come with the first touch, though that is an increment's end.
#[test]
fn equations_come_with_the_first_touch() {
    let bench = Bench::new(BAR);
    let far = ["--set", "tool.roller.cylinder.point=[10.3,17.0,0]", "--set", "step.press.move.0.by=[0,-10.2,0]"];
    let run = bench.solve(1, &[&far[..], &["--set", "step.press.increments=2", "--steps", "1"]].concat());
    let history = run.history();
    assert_eq!(history.column("top.active")[0], 0.0);
    assert!(history.last("top.active") >= 2.0 && history.last("roller.fy") < 0.0);
    assert_eq!((count(&run, "growths"), run.summary()["cutbacks"].as_u64()), (1, Some(0)));
}

fn summary_of(scene: &str) -> Value {
    Bench::new(scene).solve(1, &[]).summary()
}

/// Nothing of contact, of friction, or of plastic flow; stresses where fields are written alone, first at time 0.
#[test]
fn an_elastic_bar_carries_nothing_else() {
    let found = summary_of(
        r#"
        [body.bar]
        material = "rubber"
        block = { box = { size = [4, 1, 1] }, elements = [4, 1, 1] }
        [material.rubber]
        model = "neo-hookean"
        young = 1.0
        poisson = 0.3
        [[step]]
        increments = 5
        fix = [{ set = "bar.xmin" }]
        move = [{ target = "bar.xmax", by = [0.5, 0.0, 0.0] }]
        [output]
        every = 3
    "#,
    );
    for key in ["multipliers", "pattern_rebuilds", "growths", "search_fetches", "outer_iterations"] {
        assert_eq!(found[key], 0, "{key}");
    }
    for key in ["slave_nodes", "contact_bytes", "points", "history_bytes"] {
        assert_eq!(found["carried"][key], 0, "{key}");
    }
    assert_eq!(found["phase_calls"]["search"], 0);
    assert_eq!(found["carried"]["stress_fields"], 3);
    assert_eq!((&found["matrix"], &found["analyses"]), (&"symmetric indefinite".into(), &1.into()));
}

/// Without friction a node has one multiplier, and the matrix is symmetric; what does not flow has no state.
#[test]
fn features_cost_where_they_are() {
    let set = |entries: &[&str]| {
        let entries: Vec<&str> = entries.iter().flat_map(|entry| ["--set", entry]).collect();
        Bench::new(BAR).solve(1, &[&["--steps", "1"], &entries[..]].concat()).summary()
    };
    let [smooth, rough] = ["contact.top.friction=0", "contact.top.friction=0.3"].map(|entry| set(&[entry]));
    let multipliers = |summary: &Value| summary["multipliers"].as_u64().unwrap();
    // In plane strain two along the surface and across.
    assert_eq!(2 * multipliers(&smooth), multipliers(&rough));
    assert_eq!([&smooth, &rough].map(|s| s["matrix"].clone()), ["symmetric indefinite", "unsymmetric"]);
    assert_eq!([&smooth, &rough].map(|s| s["carried"]["points"].clone()), [0, 0]);
    assert_eq!([&smooth, &rough].map(|s| s["carried"]["slave_nodes"].clone()), [61, 61]);
    let flows = set(&["body.bar.material=metal"]);
    let [points, bytes] = ["points", "history_bytes"].map(|key| flows["carried"][key].as_u64().unwrap());
    // In plane strain four points an element.
    assert_eq!((points, bytes), (60 * 4 * 4, 60 * 4 * 4 * 88));
    let held = set(&["contact.top.method=penalty"]);
    assert_eq!((multipliers(&held), held["growths"].as_u64()), (0, Some(0)));
}
