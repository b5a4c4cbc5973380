//! ```text
//!        _____  held, pressed       An elastic cylinder, R = 10, is pressed over its flat end on a rigid plane by N, evenly as nu
//!       |     |                     = 0, and the plane is turned about the cylinder's axis, mu = 0.3: when all slips, the torque is
//!       |_____|                     int mu p r dA = 2/3 mu N R.
//!      ///////// turned, mu
//! ```
//! With a bore of R / 50, which adds 4e-4.

use crate::solve;
use crate::table::Oracle;

#[test]
fn limit_torque() {
    let (radius, mu) = (10.0, 0.3);
    let scene = format!(
        r#"
        [body.cylinder]
        material = "rubber"
        block = {{ sector = {{ radii = [0.2, {radius:?}], angles = [0.0, 360.0], length = 10.0 }}, elements = [8, 24, 4] }}
        [material.rubber]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.0
        [tool.plate]
        plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
        [contact.foot]
        slave = "cylinder.zmin"
        master = "plate"
        friction = {mu:?}
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "cylinder.zmax", directions = "xy" }}]
        move = [{{ target = "cylinder.zmax", by = [0.0, 0.0, -1.0], directions = "z" }}]
        [[step]]
        name = "turn"
        increments = 10
        fix = [{{ set = "cylinder.zmax" }}]
        move = [{{ target = "plate", rotate = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 40.0 }} }}]
        "#
    );
    let run = solve(2, &scene, &[]);
    let history = run.history();
    let (points, k) = (run.points("contact.foot"), run.written());
    let (moved, forces) = (run.vectors(k, "contact.foot", "displacement"), run.vectors(k, "contact.foot", "force"));
    let mut torque = 0.0;
    for ((x, u), f) in points.iter().zip(&moved).zip(&forces) {
        torque += (x[0] + u[0]) * f[1] - (x[1] + u[1]) * f[0];
    }
    let mut oracle = Oracle::new("torsion of a pressed disk");
    let push = history.last("plate.fz");
    // The last ring of facets is a polygon of 24 sides.
    oracle.close(
        "normal force, N",
        push,
        10.0 * 0.5 * (1.0 / 0.9 - 0.9) * 0.5 * 24.0 * 15f64.to_radians().sin() * (100.0 - 0.04),
        1e-3,
    );
    oracle.close("limit torque", torque.abs(), 2.0 / 3.0 * mu * push * radius, 0.02);
    let sideways = history.last("plate.fx").hypot(history.last("plate.fy"));
    oracle.within("sideways force over mu N", sideways / (mu * push), 0.0, 1e-6);
}
