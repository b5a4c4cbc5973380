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
