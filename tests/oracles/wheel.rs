//! ```text
//!         ____          A tyre, R = 1, shrunk onto a rigid hub that is pressed by d towards a rigid road, turned, and free to
//!        / __ \         advance. mu = 1 at both faces. It rolls without slip: in a turn it advances between 2 pi R and 2 pi (R -
//!       | (  ) |->      d), R as it stands after it was shrunk on; no force acts along the road.
//!        \____/
//!      ////////// road
//! ```

use crate::bench;
use crate::table::Oracle;
use std::f64::consts::TAU;

#[test]
fn rolls_freely() {
    let (pressed, turn): (f64, f64) = (0.02, 180.0);
    // The road is a little below the tyre: what shrinks on makes the tyre larger.
    let road = -1.02;
    let scene = |down: f64, turn: f64| {
        format!(
            r#"
            [body.tyre]
            material = "rubber"
            plane_strain = true
            block = {{ sector = {{ radii = [0.6, 1.0], angles = [0.0, 360.0], length = 0.1 }}, elements = [4, 96, 1] }}
            [material.rubber]
            model = "neo-hookean"
            young = 10.0
            poisson = 0.3
            [tool.hub]
            cylinder = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 0.615 }}
            [tool.road]
            plane = {{ point = [0.0, {road:?}, 0.0], normal = [0.0, 1.0, 0.0] }}
            [contact.fit]
            slave = "tyre.rmin"
            master = "hub"
            friction = 1.0
            [contact.tread]
            slave = "tyre.rmax"
            master = "road"
            friction = 1.0
            [[step]]
            name = "shrink"
            increments = 1
            [[step]]
            name = "press"
            increments = 4
            move = [{{ target = "hub", by = [0.0, {down:?}, 0.0] }}]
            [[step]]
            name = "roll"
            increments = 60
            force = [{{ target = "hub", total = [0.0, 0.0, 0.0], directions = "x" }}]
            move = [{{ target = "hub", rotate = {{ point = [0.0, {down:?}, 0.0], axis = [0.0, 0.0, 1.0], angle = {turn:?} }} }}]
            [output]
            every = 1
            "#
        )
    };
    // How large it is once shrunk on.
    let shrunk = bench(&scene(-0.01, 0.1), &[]).solve(1, &["--steps", "1"]);
    let outside = shrunk.points("contact.tread").into_iter().zip(shrunk.vectors(1, "contact.tread", "displacement"));
    let radii: Vec<f64> = outside.map(|(x, u)| (x[0] + u[0]).hypot(x[1] + u[1])).collect();
    let radius = radii.iter().sum::<f64>() / radii.len() as f64;
    let down = road + radius - pressed;
    let run = crate::solve(1, &scene(down, -turn), &[]);
    let history = run.history();
    let start = history.steps.iter().rposition(|s| s == "press").unwrap();
    let advance = |k: usize| history.column("hub.ux")[k];
    let steady = start + 20;
    let (last, increments) = (history.len() - 1, history.len() - 1 - steady);
    let a_turn = (advance(last) - advance(steady)) / (increments as f64 * turn / 60.0) * 360.0;
    let mut oracle = Oracle::new("free rolling wheel");
    oracle.between("advance in a turn", a_turn, TAU * radius, TAU * (radius - pressed), 0.01);
    let push = history.last("road.fy");
    oracle.within("force along the road over mu N", history.last("road.fx") / push, 0.0, 1e-6);
    let (points, k) = (run.points("contact.tread"), run.written());
    let (moved, forces) = (run.vectors(k, "contact.tread", "displacement"), run.vectors(k, "contact.tread", "force"));
    let hub = [history.last("hub.ux"), down];
    let torque: f64 = points
        .iter()
        .zip(&moved)
        .zip(&forces)
        .map(|((x, u), f)| (x[0] + u[0] - hub[0]) * f[1] - (x[1] + u[1] - hub[1]) * f[0])
        .sum();
    oracle.within("torque over N R", torque / (push * radius), 0.0, 0.01);
}
