//! Springs and dashpots between a body and the ground.

use crate::case::Case;
use crate::oracle::{balance, near, value};

family!(springs, dashpots, under_a_tool, without_effect);

/// A block of E = 100 under a force of 8, and what holds it below.
fn block(name: String, below: &str, force: f64, n: usize) -> Case {
    Case::text(
        name,
        format!(
            r#"[body.b]
material = "m"
block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 2] }}
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.0
[[step]]
name = "load"
duration = 2.0
increments = {n}
fix = [{{ set = "b.xmin", directions = "x" }}, {{ set = "b.ymin", directions = "y" }}]
{below}
force = [{{ target = "b.zmax", total = [0.0, 0.0, {:?}] }}]
[output]
every = 1000
history = ["b.zmin", "b.zmax"]
"#,
            -force
        ),
    )
}

fn spring(stiffness: f64) -> String {
    format!("spring = [{{ set = \"b.zmin\", stiffness = [0.0, 0.0, {stiffness:?}] }}]")
}

/// Stiffness 1e-12 to 1e12, under a force that they bear by a tenth, or under 8 where they hardly give way.
fn springs() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let stiffness = 10f64.powi(power);
        let force = f64::min(0.1 * stiffness, 8.0);
        let case = block(format!("1e{power}, a force of {force:e}"), &spring(stiffness), force, 2)
            .oracle(value("b.zmin.fz", force, 1e-6, "equilibrium"))
            .oracle(value("b.zmin.uz", -force / stiffness, 1e-6 + 1e-14 * stiffness, "F / k"));
        let case = if power.abs() <= 3 { case.must_run() } else { case };
        cases.push(case.quick_if(power.abs() == 6));
    }
    for n in [1, 1000] {
        let case = block(format!("{n} increments"), &spring(40.0), 8.0, n).must_run();
        cases.push(case.oracle(value("b.zmin.uz", -0.2, 1e-6, "F / k")).slow());
    }
    for (ranks, elements) in [(4, "[1, 1, 1]"), (7, "[1, 1, 2]")] {
        let case = block(format!("{elements}, {ranks} ranks"), &spring(40.0), 8.0, 2).ranks(ranks).must_run();
        let case = case.set(format!("body.b.block.elements={elements}"));
        cases.push(case.oracle(value("b.zmin.uz", -0.2, 1e-6, "F / k")).slow());
    }
    cases
}

/// Damping 1e-12 to 1e12: by backward Euler, F rising, the way is F T (n + 1) / (2 n c).
fn dashpots() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let damping = 10f64.powi(power);
        let force = f64::min(0.05 * damping, 8.0);
        let below = format!("dashpot = [{{ set = \"b.zmin\", damping = [0.0, 0.0, {damping:?}] }}]");
        for n in [1, 4, 1000] {
            let way = force * 2.0 * (n + 1) as f64 / (2.0 * n as f64 * damping);
            let case = block(format!("1e{power}, {n} increments"), &below, force, n)
                .oracle(value("b.zmin.fz", force, 1e-6, "equilibrium"))
                .oracle(value("b.zmin.uz", -way, 1e-6 + 1e-14 * damping, "backward Euler"));
            let case = if power.abs() <= 3 { case.must_run() } else { case };
            cases.push(case.quick_if(n == 4 && power.abs() == 6));
        }
    }
    cases
}

/// A plate presses a block by 0.1 into springs of any stiffness, 100 of the block itself in series with them.
fn under_a_tool() -> Vec<Case> {
    let scene = |below: &str| {
        crate::scenes::BAR
            .replace("symmetry = [\"xmin\", \"ymin\", \"zmin\"]", "symmetry = [\"xmin\", \"ymin\"]")
            .replace("increments = 2", &format!("increments = 2\nduration = 1.0\n{below}"))
    };
    let mut cases = Vec::new();
    for power in [-12, -6, -3, 0, 3, 6, 12] {
        let stiffness = 10f64.powi(power);
        // k (0.4 - s) = -F(1 - s / 2) of the bar, shortened by s.
        let bar = |s: f64| -crate::scenes::bar_force(10.0, 4.0, 1.0 - s / 2.0);
        let s = crate::common::root(0.0, 0.4, |s| bar(s) - stiffness * (0.4 - s));
        let force = if stiffness < 1.0 { stiffness * (0.4 - s) } else { bar(s) };
        for method in ["augmented-lagrangian", "lagrange"] {
            let case = Case::text(format!("spring 1e{power}, {method}"), scene(&spring(stiffness)))
                .set(format!("contact.c.method={method}"))
                .oracle(value("b.zmin.fz", force, 1e-6, "in series"))
                .oracle(balance(&["p", "b.zmin"], 1e-6));
            cases.push(case.quick_if(power == -6 && method == "lagrange"));
        }
    }
    cases
}

/// What acts on nodes that are held, and what is listed twice.
fn without_effect() -> Vec<Case> {
    let held = |more: &str| block("".into(), &format!("keep = false\n{more}"), 8.0, 2).set(FIXED);
    const FIXED: &str = "step.load.fix=[{ set = \"b.zmin\" }]";
    let idle: &'static [&'static str] = &["does nothing but to the reactions"];
    let twice = |name: &str, key: &str, item: &str| {
        held(&format!("{key} = [{item}, {item}]")).named(name).must_be_refused(&["twice"])
    };
    vec![
        held(&spring(10.0))
            .named("springs on held nodes")
            .oracle(near("b.zmin.uz", 1.0, 1.0, 0.0, "a warning"))
            .or_warns(idle),
        held("pressure = [{ set = \"b.zmin\", value = 1.0 }]")
            .named("pressure on held nodes")
            .oracle(near("b.zmin.uz", 1.0, 1.0, 0.0, "a warning"))
            .or_warns(idle),
        twice("pressure, twice", "pressure", "{ set = \"b.zmax\", value = 1.0 }"),
        twice("body force, twice", "body_force", "{ body = \"b\", per_volume = [0, 0, 1] }"),
        twice("springs, twice", "spring", "{ set = \"b.zmax\", stiffness = [0, 0, 1] }"),
        twice("dashpots, twice", "dashpot", "{ set = \"b.zmax\", damping = [0, 0, 1] }"),
    ]
}
