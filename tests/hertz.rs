//! A rigid sphere on an elastic block against Hertz.

mod common;

use common::hertz::{Layer, ellipse};
use common::{Bench, Run, assert_close, assert_small, msh};
use std::f64::consts::PI;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const RADIUS: f64 = 50.0;
/// Sides of the quarter block; the contact radius is about 1.
const SIDE: f64 = 10.0;
const DEPTH: f64 = 10.0;

const LAYER: Layer = Layer { young: YOUNG, poisson: POISSON, side: SIDE, depth: DEPTH };

/// Force and contact radius at an approach: d = a^2 / R + F c.
fn expected(approach: f64) -> (f64, f64) {
    let force = |a: f64| 4.0 / 3.0 * LAYER.modulus() * a.powi(3) / RADIUS;
    let a = common::root(0.0, 5.0, |a| a * a / RADIUS + force(a) * LAYER.softness() - approach);
    (force(a), a)
}

const APPROACH: f64 = 0.02;

fn scene(elements: usize, grading: f64, model: &str, tool: &str) -> Bench {
    Bench::new(&text(elements, grading, model, tool))
}

fn text(elements: usize, grading: f64, model: &str, tool: &str) -> String {
    format!(
        r#"
        [body.block]
        material = "soft"
        [body.block.block]
        box = {{ origin = [0.0, 0.0, -{DEPTH:?}], size = [{SIDE:?}, {SIDE:?}, {DEPTH:?}] }}
        elements = [{elements}, {elements}, {elements}]
        grading = [{grading:?}, {grading:?}, {:?}]
        [material.soft]
        model = "{model}"
        young = {YOUNG:?}
        poisson = {POISSON:?}
        [tool.ball]
        {tool}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        [[step]]
        increments = 1
        fix = [
            {{ set = "block.xmin", directions = "x" }}, {{ set = "block.xmax", directions = "x" }},
            {{ set = "block.ymin", directions = "y" }}, {{ set = "block.ymax", directions = "y" }},
            {{ set = "block.zmin", directions = "z" }},
        ]
        move = [{{ target = "ball", by = [0.0, 0.0, -{APPROACH:?}] }}]
        [output]
        history = ["block.zmin"]
        "#,
        1.0 / grading
    )
}

/// Elements along a side, and the size of those at the sides over those in the middle: four and a half in the contact.
const MESH: (usize, f64) = (14, 16.0);

const ANALYTIC: &str = "sphere = { center = [0.0, 0.0, 50.0], radius = 50.0 }";

/// Distance from the middle and pressure of the nodes in contact along an edge of the quarter, from the middle outwards.
fn pressures(run: &Run) -> Vec<(f64, f64)> {
    let (points, pressure) = (run.points("contact.top"), run.scalars(run.written(), "contact.top", "pressure"));
    let edge = points.iter().zip(pressure).filter(|(x, p)| x[1] == 0.0 && *p > 0.0);
    let mut nodes: Vec<(f64, f64)> = edge.map(|(x, p)| (x[0], p)).collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    nodes
}

#[test]
fn sphere_on_a_block() {
    let (force, radius) = expected(APPROACH);
    let half_space = 4.0 / 3.0 * LAYER.modulus() * RADIUS.sqrt() * APPROACH.powf(1.5);
    println!("a {radius}, F {force}, on a half space {half_space}");
    for model in ["hooke", "neo-hookean"] {
        let run = scene(MESH.0, MESH.1, model, ANALYTIC).solve(2, &[]);
        assert_eq!(run.summary()["matrix"], "symmetric indefinite");
        let history = run.history();
        assert_close(&format!("{model} force"), -4.0 * history.last("ball.fz"), force, 0.01);
        assert_small("balance", history.last("ball.fz") / history.last("block.zmin.fz") + 1.0, 1e-9);
        let nodes = pressures(&run);
        let rim = nodes.windows(2).last().unwrap();
        let element = rim[1].0 - rim[0].0;
        assert_small(&format!("{model} contact radius"), (ellipse(&nodes).0 - radius) / element, 0.25);
        assert_close(&format!("{model} pressure"), nodes[0].1, 1.5 * force / (PI * radius * radius), 0.02);
    }
}

/// The same block of quadratic tetrahedra, seven times six along each side.
#[test]
fn sphere_on_quadratic_tetrahedra() {
    let (force, radius) = expected(APPROACH);
    let blocks = |scene: &str| {
        let (from, to) = (scene.find("[body.block.block]").unwrap(), scene.find("[material.soft]").unwrap());
        scene.replacen(&scene[from..to], "mesh = \"block.msh\"\n", 1)
    };
    let bench = Bench::new(&blocks(&text(MESH.0, MESH.1, "hooke", ANALYTIC)));
    let graded = |t: f64| (MESH.1.powf(t) - 1.0) / (MESH.1 - 1.0);
    let place = |[x, y, z]: [f64; 3]| [SIDE * graded(x), SIDE * graded(y), -DEPTH * graded(1.0 - z)];
    bench.write("block.msh", &msh::second_order(&msh::block([MESH.0 / 2; 3], true, place)));
    let run = bench.solve(2, &[]);
    let history = run.history();
    assert_close("force", -4.0 * history.last("ball.fz"), force, 0.015);
    assert_small("balance", history.last("ball.fz") / history.last("block.zmin.fz") + 1.0, 1e-9);
    let highest = 1.5 * force / (PI * radius * radius);
    assert_close("pressure", pressures(&run)[0].1, highest, 0.02);
    assert_close("highest pressure", history.last("top.max_pressure"), highest, 0.04);
}

/// The same with the ball as 4 by 4 quadrilaterals, one of them as wide as four radii of contact. A Nagata patch over the
/// angle b is off the sphere by at most b^4 R / 128, here 8e-4 of the approach, and the force goes with its power 3/2.
/// With flat facets the ball would be a blunt pyramid.
#[test]
fn sphere_of_nagata_patches_on_a_block() {
    let analytic = scene(10, 12.0, "hooke", ANALYTIC).solve(2, &[]);
    let bench = scene(10, 12.0, "hooke", "mesh = \"ball.msh\"");
    let side = 16.0f64;
    let place = |s: f64, t: f64| {
        let (x, y) = (side * (s - 0.5), side * (0.5 - t));
        [x, y, RADIUS - (RADIUS * RADIUS - x * x - y * y).sqrt()]
    };
    bench.write("ball.msh", &msh::surface(4, place));
    let meshed = bench.solve(2, &[]);
    assert_eq!(meshed.summary()["matrix"], "symmetric indefinite");
    let force = |run: &Run| run.history().last("ball.fz");
    let off = (side / 4.0 / RADIUS).powi(4) * RADIUS / 128.0 / APPROACH;
    assert_close("force", force(&meshed), force(&analytic), 1.5 * off);
    let [smooth, exact] = [ellipse(&pressures(&meshed)).0, ellipse(&pressures(&analytic)).0];
    assert_close("contact radius", smooth, exact, 0.01);
    let facets = bench.solve(2, &["--set", "tool.ball.smoothing=facet"]);
    println!("facets: {}", force(&facets) / force(&analytic));
    assert!((force(&facets) / force(&analytic) - 1.0).abs() > 0.1);
}
