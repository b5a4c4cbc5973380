//! ```text
//!       T2 <- ==___           A belt a hundredth of the radius thick, over a quarter of a fixed cylinder, mu = 0.3, drawn until
//!            ( |   \\         it slips: T2 / T1 = exp(mu pi / 2) = 1.602 (Euler, Eytelwein). Tension acts in its middle, t / 2
//!             -+-   ||        off the cylinder, which makes the exponent smaller by 1 + t / 2R: 1.598.
//!                   |v T1
//! ```
//! Twice: the lower end held, or drawn by a force.

use crate::solve;
use crate::table::Oracle;
use std::f64::consts::FRAC_PI_2;

fn tensions(around: usize, steps: &str) -> [f64; 2] {
    let scene = format!(
        r#"
        [body.belt]
        material = "strap"
        plane_strain = true
        block = {{ sector = {{ radii = [1.0, 1.01], angles = [0.0, 90.0], length = 0.1 }}, elements = [1, {around}, 1] }}
        [material.strap]
        model = "hooke"
        young = 1000.0
        poisson = 0.0
        [tool.drum]
        cylinder = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }}
        [contact.wrap]
        slave = "belt.rmin"
        master = "drum"
        friction = 0.3
        {steps}
        [output]
        every = 100
        history = ["belt.amin", "belt.amax"]
        "#
    );
    let history = solve(1, &scene, &[]).history();
    [history.last("belt.amax.fx"), history.last("belt.amin.fy")].map(f64::abs)
}

fn exact() -> f64 {
    (0.3 * FRAC_PI_2).exp()
}

#[test]
fn held_and_drawn() {
    let [drawn, held] = tensions(
        90,
        r#"
        [[step]]
        increments = 5
        fix = [{ set = "belt.amin", directions = "y" }]
        move = [{ target = "belt.amax", by = [-0.005, 0.0, 0.0], directions = "x" }]
        "#,
    );
    Oracle::new("belt, end held").close("tension ratio", drawn / held, exact(), 0.01);
}

fn weighted(increments: usize) {
    let force = "force = [{ target = \"belt.amin\", total = [0.0, -0.001, 0.0] }]";
    let [drawn, _] = tensions(
        90,
        &format!(
            r#"
        [[step]]
        name = "tighten"
        increments = 2
        fix = [{{ set = "belt.amax", directions = "x" }}]
        {force}
        [[step]]
        name = "draw"
        increments = {increments}
        move = [{{ target = "belt.amax", by = [-0.05, 0.0, 0.0], directions = "x" }}]
        {force}
        "#
        ),
    );
    Oracle::new("belt, end with a weight").close("tension ratio", drawn / 0.001, exact(), 0.01);
}

#[test]
#[ignore = "default settings: right, but in 1165 increments with 24 jumps since contacts settle first; 7 before"]
fn weighted_and_drawn() {
    weighted(50);
}

#[test]
#[ignore = "extremes: half an element in an increment, right but by many cuts and jumps"]
fn weighted_and_drawn_far() {
    weighted(5);
}
