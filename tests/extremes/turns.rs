//! Rolling by a full turn.

use crate::case::Case;
use crate::oracle::{balance, near, value};
use crate::scenes::METHODS;
use std::f64::consts::TAU;

family!(roller_on_a_block, roller_that_is_drawn, wheel_on_a_road);

/// A rigid roller of radius 1 that a small force presses onto a block. Its elements, 0.25, let it rest upon one node as far as
/// 0.125 beside it, which friction must bear.
const ROLLER: &str = r#"[body.b]
material = "m"
element = "hex8"
plane_strain = true
block = { box = { origin = [-1.0, -1.0, 0.0], size = [9.0, 1.0, 0.25] }, elements = [36, 4, 1] }
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.r]
cylinder = { point = [0.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }
[contact.c]
slave = "b.ymax"
master = "r"
[[step]]
name = "press"
increments = 2
fix = [{ set = "b.ymin" }]
force = [{ target = "r", total = [0.0, -0.2, 0.0], directions = "y" }]
[[step]]
name = "roll"
increments = 24
fix = [{ set = "b.ymin" }]
MOTION
[output]
every = 1000
history = ["b.ymin"]
"#;

/// What is left of rolling without slip: a node sticks where it is met at the end of an increment, which is off by the tangent or
/// the sine of the angle; and something for elements and strain.
fn left(n: usize) -> f64 {
    0.5 * (TAU / n as f64).powi(2) + 5e-3
}

/// Nothing draws it: it goes where its turn takes it.
fn roller_on_a_block() -> Vec<Case> {
    let motion = "force = [{ target = \"r\", total = [0.0, -0.2, 0.0], directions = \"xy\" }]\nmove = [{ target = \"r\", rotate = { point = [0.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0], angle = -360.0 } }]";
    let mut cases = Vec::new();
    for method in METHODS {
        for mu in ["0.2", "1.0", "5.0", "100.0"] {
            for n in [13, 24, 120, 1000] {
                let case = Case::text(format!("mu = {mu}, {n} increments, {method}"), ROLLER.replace("MOTION", motion))
                    .set(format!("contact.c.friction={mu}"))
                    .set(format!("contact.c.method={method}"))
                    .set(format!("step.roll.increments={n}"))
                    .oracle(value("r.ux", TAU, left(n), "rolling without slip"))
                    .oracle(near("r.fx", 0.0, 0.2, 1e-6, "nothing draws it"))
                    .oracle(balance(&["r", "b.ymin"], 1e-6));
                // `lagrange` may not find a node that begins to touch, and says so.
                let is_ordinary = method == METHODS[0] || method == METHODS[1] && n < 1000;
                let case = if is_ordinary { case.must_run() } else { case };
                let is_quick = method == METHODS[0] && (n == 24 || n == 120 && mu == "0.2");
                cases.push(case.quick_if(is_quick).limit(300));
            }
        }
    }
    cases
}

/// It is drawn by the length of its circumference, and free to turn.
fn roller_that_is_drawn() -> Vec<Case> {
    let motion = "force = [{ target = \"r\", total = [0.0, -0.2, 0.0], directions = \"y\" }]\nmove = [{ target = \"r\", by = [6.283185307179586, 0.0, 0.0] }]\ntorque = [{ tool = \"r\", total = 0.0, point = [0.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0] }]";
    let mut cases = Vec::new();
    for method in &METHODS[..2] {
        for mu in ["0.2", "1.0", "5.0", "100.0"] {
            for n in [24, 120, 1000] {
                let case = Case::text(format!("mu = {mu}, {n} increments, {method}"), ROLLER.replace("MOTION", motion))
                    .set(format!("contact.c.friction={mu}"))
                    .set(format!("contact.c.method={method}"))
                    .set(format!("step.roll.increments={n}"))
                    .oracle(value("r.angle", -360.0, left(n), "rolling without slip"))
                    .oracle(near("r.moment", 0.0, 0.2, 1e-6, "free to turn"))
                    .oracle(balance(&["r", "b.ymin"], 1e-8))
                    .must_run();
                cases.push(case.quick_if(*method == METHODS[0] && n == 24).limit(300));
            }
        }
    }
    cases
}

/// An elastic wheel on a rigid road, which is free along x, turns by its hub, on which nothing but the road acts. After a full
/// turn all is as before, and the road has gone by its circumference.
fn wheel_on_a_road() -> Vec<Case> {
    let scene = r#"[body.b]
material = "m"
element = "hex8"
plane_strain = true
block = { sector = { radii = [0.5, 1.0], angles = [0.0, 360.0], length = 0.25 }, elements = [2, 48, 1] }
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.road]
plane = { point = [0.0, -1.0, 0.0], normal = [0.0, 1.0, 0.0] }
[contact.c]
slave = "b.rmax"
master = "road"
[[step]]
name = "press"
increments = 2
fix = [{ set = "b.rmin" }]
move = [{ target = "road", by = [0.0, 0.01, 0.0] }]
[[step]]
name = "roll"
increments = 24
move = [{ target = "b.rmin", rotate = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = -360.0 } }]
force = [{ target = "road", total = [0.0, 0.0, 0.0], directions = "x" }]
[output]
every = 1000
history = ["b.rmin"]
"#;
    let mut cases = Vec::new();
    for method in METHODS {
        for mu in ["0.0", "1e-12", "0.1", "1.0", "5.0", "100.0"] {
            for n in [13, 24, 96, 1000] {
                let is_smooth = ["0.0", "1e-12"].contains(&mu);
                let scene = if is_smooth {
                    scene.replace("force = [{ target = \"road\", total = [0.0, 0.0, 0.0], directions = \"x\" }]\n", "")
                } else {
                    scene.to_string()
                };
                let case = Case::text(format!("mu = {mu}, {n} increments, {method}"), scene)
                    .set(format!("contact.c.friction={mu}"))
                    .set(format!("contact.c.method={method}"))
                    .set(format!("step.roll.increments={n}"))
                    .oracle(value("road.fy@roll/road.fy@press", 1.0, 1e-6, "as before the turn"))
                    // About the hub, of radius 1, under a force of 1.6.
                    .oracle(near("b.rmin.moment", 0.0, 1.6, 1e-6, "symmetry"))
                    .oracle(near("road.fx", 0.0, 1.6, 1e-6, "symmetry"))
                    .oracle(balance(&["road", "b.rmin"], 1e-8))
                    .must_run();
                let case =
                    if is_smooth { case } else { case.oracle(value("road.ux", -TAU, left(n), "rolling without slip")) };
                cases.push(case.quick_if(method == METHODS[0] && n == 24).limit(300));
            }
        }
    }
    cases
}
