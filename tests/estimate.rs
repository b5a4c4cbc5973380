//! The estimates of errors against closed forms: how large they are, how they converge, and that they say where they are worth
//! nothing.

mod common;

use common::hertz::Layer;
use common::{Bench, Run, assert_close};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

/// The estimate at the end of the last step.
fn estimate(run: &Run) -> Value {
    run.summary()["estimate"].as_array().unwrap().last().unwrap().clone()
}

/// Lame's thick cylinder under pressure from inside, so many elements across.
fn cylinder(across: usize, element: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.ring]
        material = "ring"
        element = "{element}"
        plane_strain = true
        block = {{ sector = {{ radii = [0.5, 1.0], angles = [0.0, 90.0], length = 1.0 }}, elements = [{across}, {}, 1] }}
        [material.ring]
        model = "hooke"
        young = 1e6
        poisson = 0.3
        [[step]]
        increments = 1
        fix = [{{ set = "ring.amin", directions = "y" }}, {{ set = "ring.amax", directions = "x" }}]
        pressure = [{{ set = "ring.rmin", value = 1.0 }}]
        [output]
        history = ["ring.rmin"]
        "#,
        12 * across
    ))
}

/// ||e||^2 / ||u||^2 as estimated and as it is. The force is given: ||u||^2 - ||u_h||^2 = ||e||^2, and ||u||^2 is the work of the
/// pressure, which goes with the displacement of the bore, u = (1 + nu) / E p a^3 / (b^2 - a^2) (1 - 2 nu + b^2 / a^2).
fn of_cylinder(across: usize, element: &str, ranks: usize) -> (f64, f64) {
    let run = cylinder(across, element).solve(ranks, &[]);
    let exact = 1.3 / 1e6 * 0.125 / 0.75 * (0.4 + 4.0);
    let nodes = 12 * across + 1;
    let mean = (0..nodes).map(|k| (FRAC_PI_2 * k as f64 / (nodes - 1) as f64).cos()).sum::<f64>() / nodes as f64;
    let found = run.history().last("ring.rmin.ux") / mean;
    let estimated = estimate(&run)["bodies"]["ring"]["energy"].as_f64().unwrap();
    (estimated * estimated, 1.0 - found / exact)
}

#[test]
fn a_thick_cylinder() {
    for element in ["hex8", "hex8-fbar"] {
        let [coarse, fine] = [4, 8].map(|n| of_cylinder(n, element, 1));
        for (estimated, exact) in [coarse, fine] {
            assert_close(&format!("{element} over the true error"), estimated / exact, 1.0, 0.08);
        }
        let order = (coarse.0 / fine.0).log2();
        assert!((1.85..2.0).contains(&order), "{element}: order {order}");
        let shared = of_cylinder(4, element, 2);
        assert_close("on two ranks", shared.0, coarse.0, 1e-9);
    }
}

const LAYER: Layer = Layer { young: 1000.0, poisson: 0.3, side: 10.0, depth: 10.0 };
/// So large that strains are small.
const RADIUS: f64 = 5000.0;

/// A rigid ball on a quarter of a block, pressed in steps to several approaches.
fn ball(elements: usize, grading: f64) -> Bench {
    let fix = r#"fix = [
        { set = "block.xmin", directions = "x" }, { set = "block.xmax", directions = "x" },
        { set = "block.ymin", directions = "y" }, { set = "block.ymax", directions = "y" },
        { set = "block.zmin", directions = "z" },
    ]"#;
    let step = |by: f64| {
        format!("[[step]]\nincrements = 1\n{fix}\nmove = [{{ target = \"ball\", by = [0.0, 0.0, {by:?}] }}]\n")
    };
    let steps: String =
        APPROACHES.iter().zip([0.0].iter().chain(&APPROACHES)).map(|(to, from)| step(from - to)).collect();
    Bench::new(&format!(
        r#"
        [body.block]
        material = "soft"
        [body.block.block]
        box = {{ origin = [0.0, 0.0, -10.0], size = [10.0, 10.0, 10.0] }}
        elements = [{elements}, {elements}, {elements}]
        grading = [{grading:?}, {grading:?}, {:?}]
        [material.soft]
        model = "hooke"
        young = 1000.0
        poisson = 0.3
        [tool.ball]
        sphere = {{ center = [0.0, 0.0, {RADIUS:?}], radius = {RADIUS:?} }}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        {steps}
        "#,
        1.0 / grading
    ))
}

const APPROACHES: [f64; 4] = [1.4e-4, 1.6e-4, 1.8e-4, 2.0e-4];

/// Force of the ball: d = a^2 / R + F c, as in the tests against Hertz.
fn expected(approach: f64) -> f64 {
    let force = |a: f64| 4.0 / 3.0 * LAYER.modulus() * a.powi(3) / RADIUS;
    force(common::root(0.0, 5.0, |a| a * a / RADIUS + force(a) * LAYER.softness() - approach))
}

/// Errors of the force depend on where the next node lies: their root mean square over the approaches, as estimated and as it
/// is.
#[test]
fn a_ball_on_a_block() {
    for (elements, grading) in [(10, 12.0), (14, 16.0)] {
        let run = ball(elements, grading).solve(1, &[]);
        let history = run.history();
        let forces = history.column("ball.fz").to_vec();
        let (mut found, mut exact) = (0.0f64, 0.0f64);
        for (k, approach) in APPROACHES.iter().enumerate() {
            let estimated = run.summary()["estimate"][k]["contacts"]["top"]["force"].as_f64().unwrap();
            found += estimated.powi(2);
            exact += (-4.0 * forces[k] / expected(*approach) - 1.0).powi(2);
        }
        let effectivity = (found / exact).sqrt();
        println!("{elements}: {effectivity}");
        assert!((0.5..2.0).contains(&effectivity), "{elements}: {effectivity}");
    }
}

/// A block of metal or rubber under a tool, in 2D.
fn pad(elements: [usize; 2], material: &str, tool: &str, contact: &str, steps: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.pad]
        material = "soft"
        plane_strain = true
        [body.pad.block]
        box = {{ origin = [-10.0, -8.0, 0.0], size = [20.0, 8.0, 1.0] }}
        elements = [{}, {}, 1]
        [material.soft]
        {material}
        [tool.die]
        {tool}
        [contact.top]
        slave = "pad.ymax"
        master = "die"
        {contact}
        {steps}
        "#,
        elements[0], elements[1]
    ))
}

const ELASTIC: &str = "model = \"hooke\"\nyoung = 1000.0\npoisson = 0.3";
const ROLLER: &str = "cylinder = { point = [0.0, 20.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 20.0 }";

fn press(by: f64, increments: usize) -> String {
    format!(
        "[[step]]\nincrements = {increments}\nfix = [{{ set = \"pad.ymin\" }}]\nmove = [{{ target = \"die\", by = [0.0, {by:?}, 0.0] }}]\n"
    )
}

fn doubts(of: &Value) -> String {
    of["doubts"].as_array().unwrap().iter().map(|d| d.as_str().unwrap()).collect::<Vec<_>>().join("; ")
}

#[test]
fn what_is_not_to_be_trusted_is_said() {
    let run = |elements, material, tool, by| {
        let run = pad(elements, material, tool, "", &press(by, 2)).solve(1, &[]);
        let found = estimate(&run);
        assert!(run.log().contains("estimated errors: energy of `pad`"));
        (doubts(&found["bodies"]["pad"]), doubts(&found["contacts"]["top"]), run.log())
    };
    let (body, contact, log) = run([40, 16], ELASTIC, ROLLER, -0.4);
    assert_eq!((body.as_str(), contact.as_str()), ("", ""));
    assert!(!log.contains("not to be trusted"));
    let (_, contact, log) = run([40, 16], ELASTIC, ROLLER, -0.02);
    assert_eq!(contact, "2 nodes from its edge to its middle: the pressure is not resolved");
    assert!(log.contains("  not to be trusted: `top`: 2 nodes from its edge"));
    let punch = "profile = { points = [[-4.0, 9.0], [-4.0, 0.0], [4.0, 0.0], [4.0, 9.0]] }";
    let (_, contact, _) = run([40, 16], ELASTIC, punch, -0.1);
    assert_eq!(contact, "the highest pressure is at its edge, and grows with a finer mesh where that is sharp");
    let (body, _, _) = run([40, 1], ELASTIC, ROLLER, -0.4);
    assert_eq!(body, "it is one element thick: what varies through the thickness is not seen");
    let flows = "model = \"j2\"\nyoung = 1000.0\npoisson = 0.3\nyield_stress = 10.0\nhardening = { linear = 10.0 }";
    let (body, _, _) = run([40, 16], flows, ROLLER, -0.4);
    assert!(body.contains("it flows"), "{body}");
}

/// A blank that a holder presses onto a die: beside the die's fillet, which the contact ends at, the estimate stays one.
#[test]
fn where_the_master_turns_away() {
    let bench = Bench::new(
        r#"
        body.blank = { material = "steel", axisymmetric = true, block = { box = { size = [50.0, 1.0, 1.0] }, elements = [75, 3, 1] } }
        material.steel = { model = "hooke", young = 206e3, poisson = 0.3 }
        tool.die = { profile = { points = [[80.0, 0.0], [26.3, 0.0], [26.3, -60.0]], fillets = [0.0, 5.0, 0.0] } }
        tool.holder = { profile = { points = [[26.5, 20.0], [26.5, 1.0], [80.0, 1.0]] } }
        contact.d = { slave = "blank.ymin", master = "die", friction = 0.1 }
        contact.h = { slave = "blank.ymax", master = "holder", friction = 0.1 }
        [[step]]
        increments = 2
        force = [{ target = "holder", total = [0.0, -10000.0, 0.0], directions = "y" }]
        "#,
    );
    let of = estimate(&bench.solve(1, &[]))["contacts"]["d"]["force"].clone();
    assert!((0.001..0.1).contains(&of.as_f64().unwrap()), "{of}");
}

/// A tool of facets is as far from its arc as one facet is high; what that does to the force is the difference to the exact
/// cylinder, at most.
#[test]
fn facets_of_a_tool() {
    let facets = "mesh = \"die.msh\"\nsmoothing = \"facet\"";
    let bench = pad([40, 16], ELASTIC, facets, "", &press(-0.4, 4));
    let half = 0.02f64;
    let place = |s: f64, t: f64| {
        let angle = half * (80.0 * s - 40.0);
        [20.0 * angle.sin(), 20.0 - 20.0 * angle.cos(), 2.0 * t - 0.5]
    };
    bench.write("die.msh", &common::msh::surface(40, place));
    let run = bench.solve(1, &[]);
    let tool = &estimate(&run)["tools"]["die"];
    assert_close("length", tool["length"].as_f64().unwrap(), 20.0 * (1.0 - half.cos()), 1e-3);
    let exact = pad([40, 16], ELASTIC, ROLLER, "", &press(-0.4, 4)).solve(1, &[]);
    let off = run.history().last("die.fy") - exact.history().last("die.fy");
    let ratio = tool["force"].as_f64().unwrap() / off.abs();
    println!("{off} {ratio}");
    assert!((1.0..4.0).contains(&ratio), "{ratio}");
    assert!(estimate(&exact)["tools"].as_object().unwrap().is_empty());
}

/// A slave bulges as far as the master in a plane of symmetry, too: a press fit of 30 degrees of rings is estimated as one of 60.
#[test]
fn planes_of_symmetry_are_no_ends() {
    let fit = |parts: usize| {
        let ring = |name: &str, radii: &str, across: usize| {
            format!(
                "[body.{name}]\nblock = {{ sector = {{ radii = {radii}, angles = [0.0, {}.0], length = 3.0 }}, \
                 elements = [{across}, {}, 1] }}\nmaterial = \"m\"\nsymmetry = [\"amin\", \"amax\", \"zmin\", \"zmax\"]\n",
                30 * parts,
                6 * parts
            )
        };
        let bench = Bench::new(
            &(ring("shaft", "[20.0, 30.02]", 4)
                + &ring("hub", "[30.0, 60.0]", 6)
                + "[material.m]\nmodel = \"hooke\"\nyoung = 2e5\npoisson = 0.3\n\
                   [contact.c]\nslave = \"shaft.rmax\"\nmaster = \"hub.rmin\"\n[[step]]\nincrements = 2\n"),
        );
        estimate(&bench.solve(1, &[]))["contacts"]["c"]["force"].as_f64().unwrap()
    };
    let (one, two) = (fit(1), fit(2));
    assert!(two < 0.01, "{two}");
    assert_close("force", one, two, 0.02);
}

/// What a second run differs by is the error of the first: half of it with half the increments.
#[test]
fn increments_by_a_second_run() {
    let drag = |increments: usize| {
        let steps = format!(
            "[[step]]\nname = \"press\"\nincrements = {increments}\nfix = [{{ set = \"pad.ymin\" }}]\n\
             move = [{{ target = \"die\", by = [0.1, -0.4, 0.0] }}]\n"
        );
        pad([40, 16], ELASTIC, ROLLER, "friction = 0.3", &steps)
    };
    let shear = |increments: usize, ranks: usize| {
        let run = drag(increments).solve(ranks, &["--estimate"]);
        assert!(run.log().contains("; increments, nodal forces of `top`"));
        estimate(&run)["increments"]["contacts"]["top"]["shear"].as_f64().unwrap()
    };
    let (coarse, fine) = (shear(8, 1), shear(16, 1));
    println!("{coarse} {fine}");
    assert!((1.5..3.0).contains(&(coarse / fine)), "{coarse} {fine}");
    assert_close("on two ranks", shear(8, 2), coarse, 1e-6);
    let one = drag(1).solve(1, &["--estimate"]);
    assert!(estimate(&one)["increments"].is_null());
    let smooth = pad([40, 16], ELASTIC, ROLLER, "", &press(-0.4, 4)).solve(1, &["--estimate"]);
    assert!(estimate(&smooth).get("increments").is_none());
}
