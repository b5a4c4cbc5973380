//! Thin sheets of solid-shell elements against what is known of shells; bodies that are no sheets are refused.

mod common;

use common::{Bench, History, assert_close, assert_small};

const ROOF: &str = r#"
[body.roof]
block = { sector = { radii = [24.875, 25.125], angles = [50.0, 90.0], length = 25.0 }, elements = [1, 8, 8] }
material = "m"
element = "hex8-shell"
[material.m]
model = "hooke"
young = 4.32e8
poisson = 0.0
[[step]]
increments = 1
fix = [
    { set = "roof.amax", directions = "x" }, { set = "roof.zmin", directions = "z" },
    { set = "roof.zmax", directions = "xy" },
]
body_force = [{ body = "roof", per_volume = [0.0, -0.036, 0.0] }]
[output]
probe = [{ name = "edge", point = [16.069690242163485, 19.15111107797445, 0.0], fields = ["displacement"] }]
"#;

/// A quarter of the roof of Scordelis and Lo (1964), under a ten thousandth of its weight: the middle of its free edge sinks by
/// 0.3024 of that. The mesh tells that its thickness is along the radius.
#[test]
fn a_roof_bears_its_weight() {
    let run = Bench::new(ROOF).solve(1, &[]);
    let edge = History::read(&run.out.join("probe-edge.csv"));
    assert_close("sinking", edge.last("displacement.y"), -0.3024e-4, 0.01);
}

/// Metal that flows, bent along an arc to a radius of four thicknesses: the moment is that of rigid plastic layers, and what is
/// elastic in it is what these hold. Without a thickness strain that is quadratic through the sheet the moment was 38 % too
/// large, and the energy eleven times.
#[test]
fn metal_is_bent_to_few_thicknesses() {
    let (length, steps) = (3.0, 12);
    let end = |curvature: f64| {
        let turn = curvature * length;
        [turn.sin() / curvature, (1.0 - turn.cos()) / curvature]
    };
    let step = |k: usize| {
        let [before, after] = [k, k + 1].map(|k| 0.5 * (k as f64).max(1e-9) / steps as f64);
        let ([x, y], [u, v]) = (end(before), end(after));
        let angle = (length * (after - before)).to_degrees();
        format!(
            "[[step]]\nincrements = 4\nfix = [{{ set = \"b.xmin\", directions = \"x\" }}]\nmove = [{{ target = \"b.xmax\", by = [{:?}, {:?}, 0], \
             rotate = {{ point = [{x:?}, {y:?}, 0], axis = [0, 0, 1], angle = {angle:?} }} }}]\n",
            u - x,
            v - y
        )
    };
    let steps: String = (0..steps).map(step).collect();
    let bench = Bench::new(&format!(
        "[body.b]\nmaterial = \"m\"\nelement = \"hex8-shell\"\nsymmetry = [\"zmin\", \"zmax\"]\n\
         block = {{ box = {{ origin = [0, -0.25, 0], size = [3.0, 0.5, 1.0] }}, elements = [4, 1, 1] }}\n\
         [material.m]\nmodel = \"j2\"\nyoung = 70000.0\npoisson = 0.3\nyield_stress = 100.0\nhardening = {{ linear = 300.0 }}\n\
         {steps}[output]\nhistory = [\"b.xmin\", \"b.xmax\"]\n"
    ));
    let history = bench.solve(1, &[]).history();
    let (thickness, radius, plane) = (0.5_f64, 2.0, 2.0 / 3.0_f64.sqrt());
    let moment = plane * (100.0 * thickness.powi(2) / 4.0 + plane * 300.0 * thickness.powi(3) / (12.0 * radius));
    assert_close("moment", history.last("b.xmax.moment").abs(), moment, 0.04);
    // That of `hex8-sri` in 24 x 8 is 0.196.
    assert_close("elastic energy", history.last("b.elastic_energy"), 0.196, 0.05);
}

/// Turned up by more than half its length by a shear of 4 at its end (Sze, Liu and Lo, Finite Elem. Anal. Des. 40, 2004).
#[test]
fn a_strip_is_turned_up_by_its_end() {
    let bench = Bench::new(
        r#"
        [body.strip]
        block = { box = { size = [10.0, 1.0, 0.1] }, elements = [16, 1, 1] }
        material = "m"
        element = "hex8-shell"
        shell = { points = 3, face = "zmax" }
        [material.m]
        model = "hooke"
        young = 1.2e6
        poisson = 0.0
        [[step]]
        increments = 10
        fix = [{ set = "strip.xmin" }]
        force = [{ target = "strip.xmax", total = [0.0, 0.0, 4.0] }]
        [output]
        history = ["strip.xmin", "strip.xmax"]
        "#,
    );
    let alone = bench.solve(1, &[]).history();
    assert_close("back", alone.last("strip.xmax.ux"), -3.286, 0.02);
    assert_close("up", alone.last("strip.xmax.uz"), 6.698, 0.02);
    assert_small("2 ranks", alone.difference(&bench.solve(2, &[]).history()), 1e-8);
}

/// A strip bends alike however thin it is, if its load is as the cube of that, until rounding leaves too much of its forces: up to a
/// thousand times as long as thick, where the residuals of the linear systems are 1e-5 of their right-hand sides.
#[test]
fn thin_strips_bend_by_dead_loads() {
    let sinks = |thickness: f64| {
        let load = 2.1e5 * 50.0 * thickness.powi(3) / 12.0 * 3.0 * 25.0 / 500.0_f64.powi(3);
        let run = Bench::new(&format!(
            "[body.strip]\nmaterial = \"m\"\nelement = \"hex8-shell\"\nshell = {{ face = \"zmax\" }}\n\
             block = {{ box = {{ size = [500.0, 50.0, {thickness:?}] }}, elements = [20, 2, 1] }}\n\
             [material.m]\nmodel = \"hooke\"\nyoung = 2.1e5\npoisson = 0.0\n\
             [[step]]\nincrements = 4\nfix = [{{ set = \"strip.xmin\" }}]\n\
             force = [{{ target = \"strip.xmax\", total = [0.0, 0.0, {load:?}] }}]\n[output]\nhistory = [\"strip.xmax\"]\n"
        ))
        .solve(1, &[]);
        assert_eq!(run.summary()["cutbacks"], 0);
        run.history().last("strip.xmax.uz")
    };
    let thick = sinks(4.0);
    assert_close("an elastica", thick, 24.95, 2e-3);
    for thickness in [1.5, 0.5] {
        assert_close(&format!("{thickness} thick"), sinks(thickness), thick, 2e-4);
    }
}

/// Two leaves of a spring, clamped at one end and pressed at the other, share the force, F/2 each, which the upper one passes on
/// at the tip; between they touch and bear nothing. Each bends by F/2 L^3 / 3 E I.
#[test]
fn leaves_of_a_spring_share_a_force() {
    let leaf = |name: &str, z: f64| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\nelement = \"hex8-shell\"\n\
             block = {{ box = {{ origin = [0.0, 0.0, {z:?}], size = [10.0, 1.0, 0.1] }}, elements = [40, 1, 1] }}\n"
        )
    };
    let bench = Bench::new(&format!(
        r#"{}{}
        [material.m]
        model = "hooke"
        young = 1000.0
        poisson = 0.0
        [contact.c]
        slave = "upper.zmin"
        master = "lower.zmax"
        discretization = "one-pass"
        [[step]]
        increments = 2
        fix = [{{ set = "lower.xmin" }}, {{ set = "upper.xmin" }}]
        force = [{{ target = "upper.xmax", total = [0.0, 0.0, -1e-5] }}]
        [output]
        history = ["lower.xmax", "upper.xmax"]
        "#,
        leaf("lower", 0.0),
        leaf("upper", 0.1),
    ));
    let run = bench.solve(1, &[]);
    let history = run.history();
    assert_eq!(run.summary()["cutbacks"], 0);
    for leaf in ["lower", "upper"] {
        assert_close(leaf, history.last(&format!("{leaf}.xmax.uz")), -0.02, 2e-3);
    }
    assert_close("force passed on", history.last("c.fz").abs(), 5e-6, 2e-3);
}

#[test]
fn what_is_no_sheet_is_refused() {
    let bench = Bench::new(ROOF);
    for (sets, words) in [
        (&["body.roof.block.elements=[1, 70, 100]"][..], "which direction is the thickness is not clear"),
        (&["body.roof.shell={ face = \"side\" }"], "has no group `side` of faces"),
        (&["body.roof.shell={ points = 1 }"], "must be from 2 to 9"),
        (&["body.roof.shell={ points = 5 }", "body.roof.element=hex8"], "is for solid-shell elements"),
        (&["body.roof.plane_strain=true", "body.roof.block.elements=[2, 8, 1]"], "is in plane strain"),
        (&["material.m.poisson=-0.95"], "buckle"),
    ] {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let run = bench.run(2, &sets);
        assert_eq!(run.code, 2, "{words}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
}
