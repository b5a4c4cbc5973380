//! Torques on tools.

use crate::case::Case;
use crate::oracle::{near, same, value};

family!(sizes, penalties, spins);

/// A plate that sticks to a block, pressed and turned by a torque, or by an angle, in other units.
fn knob(name: &str, turn: &str, [length, modulus]: [f64; 2]) -> Case {
    let l = |x: f64| x * length;
    Case::text(
        name,
        format!(
            r#"[body.block]
material = "m"
block = {{ box = {{ origin = {:?}, size = {:?} }}, elements = [3, 3, 3] }}
[material.m]
model = "neo-hookean"
young = {:?}
poisson = 0.3
[tool.knob]
plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, -1.0] }}
[contact.top]
slave = "block.zmax"
master = "knob"
friction = 3.0
[[step]]
name = "press"
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "knob", by = [0.0, 0.0, {:?}] }}]
[[step]]
name = "turn"
increments = 4
keep = true
{turn}
[output]
every = 1000
history = ["block.zmin"]
"#,
            [l(-2.0), l(-2.0), l(-4.0)],
            [l(4.0); 3],
            10.0 * modulus,
            l(-0.4)
        ),
    )
}

const LINE: &str = "point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, -1.0]";

fn torque(total: f64) -> String {
    format!("torque = [{{ tool = \"knob\", total = {total:?}, {LINE} }}]")
}

/// Torques from nothing to much, and units: the angle goes with the torque, and not with the unit.
fn sizes() -> Vec<Case> {
    let driven = |name: &str, total: f64, units: [f64; 2]| {
        knob(name, &torque(total * units[0].powi(3) * units[1]), units).oracle(value(
            "knob.moment",
            total * units[0].powi(3) * units[1],
            1e-6,
            "equilibrium",
        ))
    };
    let one = driven("one", 6.0, [1.0; 2]);
    let mut cases = Vec::new();
    for units in [[1e-9, 1.0], [1e9, 1.0], [1.0, 1e-7], [1.0, 1e17], [1e-9, 1e17], [1e9, 1e-7]] {
        let name = format!("lengths times {:e}, E times {:e}", units[0], units[1]);
        let case = driven(&name, 6.0, units).must_run();
        let case = case.oracle(same("knob.angle", one.clone(), 1e-6, "the scene in other units"));
        cases.push(case.quick_if(units[0] == 1e-9 && units[1] > 1.0));
    }
    let small = driven("small", 1e-2, [1.0; 2]);
    for power in [-4, -6, -9, -12] {
        let case = driven(&format!("a torque of 1e{power}"), 10f64.powi(power), [1.0; 2]);
        let times = 10f64.powi(power + 2);
        // Linear from there on, up to what the tolerance lets through.
        let tolerance = 1e-3 + 1e-8 / 10f64.powi(power);
        cases.push(
            case.oracle(crate::oracle::scaled("knob.angle", small.clone(), times, tolerance, "linear in it")).slow(),
        );
    }
    for n in [1, 1000] {
        let case = driven(&format!("{n} increments"), 6.0, [1.0; 2]).set(format!("step.turn.increments={n}"));
        cases.push(case.oracle(same("knob.angle", one.clone(), 1e-3, "4 increments")).slow());
    }
    cases.push(driven("4 ranks", 6.0, [1.0; 2]).ranks(4).oracle(same("knob.angle", one, 1e-6, "1 rank")).slow());
    cases
}

fn penalties() -> Vec<Case> {
    let one = knob("one", &torque(6.0), [1.0; 2]);
    let mut cases = Vec::new();
    for method in ["augmented-lagrangian", "lagrange"] {
        for power in [-6, -3, 3, 6, 9, 12, 15] {
            let case = knob(&format!("1e{power} times 5, {method}"), &torque(6.0), [1.0; 2])
                .set(format!("contact.top.method={method}"))
                .set(format!("contact.top.penalty={:?}", 5.0 * 10f64.powi(power)));
            cases.push(case.oracle(same("knob.angle", one.clone(), 1e-4, "the automatic one")).slow());
        }
    }
    for mu in ["10.0", "100.0"] {
        let case = knob(&format!("mu = {mu}"), &torque(6.0), [1.0; 2]).set(format!("contact.top.friction={mu}"));
        cases.push(case.oracle(same("knob.angle", one.clone(), 1e-6, "friction 3: all sticks")).slow());
    }
    cases
}

/// What nothing holds spins.
fn spins() -> Vec<Case> {
    let spin = |name: &str, total: f64| knob(name, &torque(total), [1.0; 2]);
    vec![
        spin("far beyond what friction bears", 1e6).must_be_refused(&["spins", "turn"]).limit(60).slow(),
        spin("little friction", 6.0).set("contact.top.friction=1e-3").must_be_refused(&["spins"]).limit(60),
        spin("no friction", 6.0).set("contact.top.friction=0.0").must_be_refused(&["can turn"]),
        spin("above the block", 6.0)
            .set("step.press.move.0.by=[0, 0, 1]")
            .must_be_refused(&["spins", "turn", "touch"])
            .limit(60),
        spin("no torque", 0.0).oracle(near("knob.angle", 0.0, 1.0, 1e-6, "symmetry")),
    ]
}
