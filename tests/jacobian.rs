//! The assembled Jacobian of the whole system against differences of the residual, by PETSc's `-snes_test_jacobian`, at
//! every Newton iteration: elements, follower loads, contact in gap, stick and slip, force-driven tools.
//!
//! The differences are one-sided: they are good to about 1e-7.

mod common;

use common::{Bench, Run, msh};

/// A 3x3x2 block of soft material, its bottom held, its top the slave of `tool`.
fn scene(element: &str, model: &str, tool: &str, contact: &str, steps: &str) -> String {
    format!(
        r#"
title = "block under a tool"
[body.block]
block = {{ box = {{ origin = [-3, -3, -4], size = [6, 6, 4] }}, elements = [3, 3, 2], faces = {{ bottom = "zmin", top = "zmax" }} }}
material = "soft"
element = "{element}"
[material.soft]
model = "{model}"
young = 100
poisson = 0.3
[tool.punch]
{tool}
[contact.top]
slave = "block.top"
master = "punch"
{contact}
{steps}
"#
    )
}

const SPHERE: &str = "sphere = { center = [0.1, 0.2, 6.0], radius = 6.0 }";
const PRESS_AND_SLIDE: &str = r#"
[[step]]
increments = 2
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0, 0, -0.4] }]
[[step]]
increments = 3
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0.3, 0.1, 0] }]
"#;

/// Runs with PETSc's test and returns the number of Jacobians tested; fails when one is wrong.
fn check(scene: &str, ranks: usize) -> usize {
    check_run(&Bench::new(scene).solve(ranks, TESTED))
}

/// Arguments for PETSc's test.
const TESTED: &[&str] = &["--", "-snes_test_jacobian"];

fn check_run(run: &Run) -> usize {
    let errors: Vec<f64> = run
        .stdout
        .lines()
        .filter_map(|line| line.trim().strip_prefix("||J - Jfd||_F/||J||_F = ")?.split(',').next()?.parse().ok())
        .collect();
    assert!(!errors.is_empty(), "nothing was tested:\n{}", run.stdout);
    for error in &errors {
        assert!(*error < 2e-7, "{errors:?}\n{}", run.stdout);
    }
    errors.len()
}

#[test]
fn stick_slip_and_gap_on_a_sphere() {
    for friction in ["friction = 0.02", "friction = 0.3", "friction = 2.0"] {
        assert!(check(&scene("hex8", "neo-hookean", SPHERE, friction, PRESS_AND_SLIDE), 2) > 8);
    }
}

/// From segment to segment the weights of points on a tool stand still.
#[test]
fn segments_on_a_sphere() {
    for contact in ["friction = 0.02", "friction = 0.2\nmethod = \"lagrange\""] {
        let contact = format!("discretization = \"segment\"\n{contact}");
        assert!(check(&scene("hex8", "neo-hookean", SPHERE, &contact, PRESS_AND_SLIDE), 2) > 8, "{contact}");
    }
}

/// With so small a penalty the local unknown does nothing; with a large one the tangent is that of the residual where it has
/// settled, as the tests of the element have it.
#[test]
fn other_methods() {
    for method in ["lagrange", "penalty"] {
        let contact = format!("friction = 0.2\nmethod = \"{method}\"\npenalty = 20.0");
        assert!(
            check(&scene("hex8", "neo-hookean", SPHERE, &contact, &PRESS_AND_SLIDE.replace("-0.4", "-0.2")), 2) > 8
        );
    }
}

/// A slanted torus, a blunt cone, and a punch with a rounded edge.
#[test]
fn other_round_tools() {
    let tools = [
        "torus = { center = [0.1, 0.2, 6.0], axis = [1.0, 0.2, 0.1], radius = 4.0, tube = 2.0 }",
        "cone = { apex = [0.1, 0.2, -0.1], axis = [0.1, 0.0, 1.0], angle = 75.0 }",
        r#"
        profile.points = [[0.0, 0.3], [2.5, 0.0], [2.6, 5.0]]
        profile.fillets = 1.5
        profile.revolve = { point = [0.1, 0.2, 0.1], axis = [0.05, 0.02, 1.0] }
        "#,
    ];
    for tool in tools {
        assert!(check(&scene("hex8", "neo-hookean", tool, "friction = 0.3", PRESS_AND_SLIDE), 2) > 8, "{tool}");
    }
}

#[test]
fn frictionless() {
    check(&scene("hex8", "hooke", SPHERE, "", PRESS_AND_SLIDE), 2);
}

#[test]
fn selective_integration_and_enhanced_strain() {
    for element in ["hex8-sri", "hex8-eas"] {
        check(&scene(element, "neo-hookean", SPHERE, "friction = 0.2", PRESS_AND_SLIDE), 1);
    }
}

#[test]
fn f_bar() {
    check(&scene("hex8-fbar", "neo-hookean", SPHERE, "friction = 0.2", PRESS_AND_SLIDE), 1);
}

#[test]
fn nagata_patches_and_nurbs() {
    for file in ["mesh = \"FOLDER/ironing-indenter.msh\"", "nurbs = \"FOLDER/ironing-indenter.igs\""] {
        let tool = file.replace("FOLDER", &format!("{}/inputs", env!("CARGO_MANIFEST_DIR")));
        assert!(check(&under_the_indenter(&tool), 2) > 8, "{file}");
    }
}

/// A block in plane strain under the indenter, which turns a little.
fn under_the_indenter(tool: &str) -> String {
    // The profile lies in the x-y plane with its bottom at y = 0: the block's top is its upper y face here.
    let scene = scene("hex8", "neo-hookean", tool, "friction = 0.2", "")
        .replace("origin = [-3, -3, -4], size = [6, 6, 4]", "origin = [0, -8, 0], size = [16, 8, 1]")
        .replace("elements = [3, 3, 2]", "elements = [6, 2, 1]")
        .replace("bottom = \"zmin\", top = \"zmax\"", "bottom = \"ymin\", top = \"ymax\"")
        .replace("material = \"soft\"", "material = \"soft\"\nplane_strain = true");
    let steps = r#"
[[step]]
increments = 3
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0, -1.2, 0] }]
[[step]]
increments = 2
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [-0.5, 0, 0], rotate = { point = [25, 40, 0], axis = [0, 0, 1], angle = 0.2 } }]
"#;
    scene + steps
}

#[test]
fn force_driven_tool_and_follower_pressure() {
    let press = r#"
[[step]]
increments = 1
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0, 0, -0.3] }]
[[step]]
increments = 3
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0.1, 0, 0] }] # at rest a slipping node would stand on the edge of its cone: no derivative
force = [{ target = "punch", total = [0, 0, -60.0], directions = "z" }]
pressure = [{ set = "block.xmin", value = 3.0 }]
"#;
    let drag = r#"
[[step]]
increments = 2
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0.3, 0, 0] }]
force = [{ target = "punch", total = [0, -2.0, -60.0], directions = "yz" }]
"#;
    check(&scene("hex8", "neo-hookean", SPHERE, "friction = 0.2", &format!("{press}{drag}")), 2);
    check(&scene("hex8", "neo-hookean", SPHERE, "", press), 2);
}

/// A sphere that turns by a torque about an axis beside its middle, and sinks under a force.
#[test]
fn torque_driven_tool() {
    let steps = r#"
[[step]]
increments = 1
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0, 0, -0.3] }]
[[step]]
increments = 3
fix = [{ set = "block.bottom" }]
move = [{ target = "punch", by = [0.1, 0, 0] }]
force = [{ target = "punch", total = [0, 0, -60.0], directions = "z" }]
torque = [{ tool = "punch", total = 6.0, point = [0.5, 0.2, 5.0], axis = [0.1, 1.0, 0.2] }]
"#;
    for contact in ["friction = 0.4", "friction = 0.4\nmethod = \"penalty\"\npenalty = 20.0"] {
        assert!(check(&scene("hex8", "neo-hookean", SPHERE, contact, steps), 2) > 6, "{contact}");
    }
    check(&scene("hex8", "neo-hookean", SPHERE, "", steps), 1);
}

/// Two blocks that begin a little inside each other, pressed together and sheared until some nodes slip, with every way of
/// bringing forces to the master. In one increment: its start, where slipping nodes stand on the edge of their cones, and
/// prescribed motions, which enter the first iteration linearly, have no derivative.
#[test]
fn deformable_masters() {
    let scene = |contact: &str, upper: &str| {
        format!(
            r#"
[body.lower]
block = {{ box = {{ size = [6, 6, 2] }}, elements = [3, 3, 1] }}
material = "soft"
[body.upper]
block = {{ box = {{ origin = [1.3, 1.4, 1.97], size = [3, 3, 2] }}, elements = {upper} }}
material = "soft"
[material.soft]
model = "neo-hookean"
young = 100
poisson = 0.3
[contact.between]
slave = "upper.zmin"
master = "lower.zmax"
{contact}
[[step]]
increments = 1
fix = [{{ set = "lower.zmin" }}, {{ set = "upper.zmax", directions = "xy" }}]
force = [{{ target = "upper.zmax", total = [0, 0, -25] }}]
body_force = [{{ body = "upper", per_volume = [0.8, 0.2, 0] }}]
[solver]
max_iterations = 30
"#
        )
    };
    let variants = [
        "",
        "transfer = \"variational\"",
        "friction = 0.3",
        "friction = 0.3\ntransfer = \"variational\"",
        "friction = 0.2\ntransfer = \"bilinear\"",
        "friction = 0.3\nsmoothing = \"facet\"",
        "discretization = \"two-pass\"",
        "friction = 0.3\ndiscretization = \"two-pass\"",
        "friction = 0.3\nmethod = \"lagrange\"",
        "friction = 0.3\nmethod = \"penalty\"\npenalty = 5.0",
    ];
    for contact in variants {
        assert!(check(&scene(contact, "[2, 3, 1]"), 2) > 3, "{contact}");
    }
}

/// A hairpin of five elements is pressed together: the patches that a node meets depend on the node itself.
#[test]
fn self_contact() {
    let (inner, outer, leg) = (0.1, 1.1, 2.0);
    // Two elements a leg, one around the bend, askew so that nodes do not meet nodes.
    let hairpin = |[s, t, z]: [f64; 3]| {
        let r = inner + (outer - inner) * t;
        let i = (5.0 * s).round();
        let bulge = if i == 2.0 || i == 3.0 { t } else { 0.0 };
        match i {
            i if i < 2.5 => [leg * (1.0 - 0.5 * i) - bulge, -r, z],
            i => [leg * (0.5 * i - 1.5) + 0.1 * (i - 2.0) - bulge, r, z],
        }
    };
    let scene = |contact: &str| {
        format!(
            r#"
[body.strip]
mesh = "strip.msh"
material = "soft"
plane_strain = true
[material.soft]
model = "neo-hookean"
young = 100
poisson = 0.3
[contact.inside]
slave = "strip.ymin"
master = "strip.ymin"
feature_angle = 180
{contact}
[[step]]
increments = 1
fix = [{{ set = "strip.xmin" }}]
pressure = [{{ set = "strip.ymax", value = 1.2 }}]
body_force = [{{ body = "strip", per_volume = [0.8, 0, 0] }}]
[solver]
max_iterations = 30
"#
        )
    };
    for contact in ["", "transfer = \"variational\"", "friction = 0.3", "friction = 0.1\nsmoothing = \"facet\""] {
        let bench = Bench::new(&scene(contact));
        bench.write("strip.msh", &msh::block([5, 1, 1], false, hairpin));
        let run = bench.solve(2, TESTED);
        assert!(check_run(&run) > 3, "{contact}");
        assert!(run.history().last("inside.active") > 0.0, "{contact}");
    }
}
