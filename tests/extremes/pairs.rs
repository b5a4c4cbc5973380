//! Two bodies on each other, in each way to keep them apart: nu = 0, so that an even pressure is the answer, and friction has
//! nothing to do.

use crate::case::Case;
use crate::common::root;
use crate::numbers::rounded;
use crate::oracle::{Oracle, balance, near, same, value};
use crate::scenes::{METHODS, STACK, stack_force};

family!(penalties, frictions, drawn, gaps_and_overlaps, stiffness_ratios, two_passes_by_penalty);

/// With their methods.
fn ways() -> Vec<(&'static str, &'static str)> {
    let all = ["one-pass", "two-pass", "node-to-node", "segment"];
    all.iter().flat_map(|discretization| METHODS.map(|method| (*discretization, method))).collect()
}

fn stack(name: &str, (discretization, method): (&str, &str), balances: f64) -> Case {
    Case::text(format!("{name}, {discretization}, {method}"), STACK)
        .sets(["material.a.poisson=0.0", "material.b.poisson=0.0"])
        .set(format!("contact.c.discretization={discretization}"))
        .set(format!("contact.c.method={method}"))
        .oracle(balance(&["upper.zmax", "lower.zmin"], balances))
}

fn pressed(force: f64, tolerance: f64) -> Oracle {
    value("upper.zmax.fz", force, tolerance, "closed form")
}

/// From 1e-6 to 1e15 of 20, the automatic one of the augmented Lagrangian. Only `penalty` depends on it: a spring at each of
/// the four nodes.
fn penalties() -> Vec<Case> {
    let mut cases = Vec::new();
    for way in ways() {
        for power in [-6, -3, -1, 1, 3, 6, 9, 12, 15] {
            let penalty = 20.0 * 10f64.powi(power);
            let give = |depth: f64| stack_force(100.0, 100.0, 0.0, 0.2 - depth) + 4.0 * penalty * depth;
            let depth = if way.1 == "penalty" { root(0.0, 0.2, give) } else { 0.0 };
            let case = stack(&format!("1e{power}"), way, 1e-8)
                .sets(["body.lower.block.elements=[1, 1, 1]", "body.upper.block.elements=[1, 1, 1]"])
                .set(format!("contact.c.penalty={penalty:?}"))
                .oracle(pressed(stack_force(100.0, 100.0, 0.0, 0.2 - depth), 1e-6));
            cases.push(case.quick_if(power.abs() == 6 && way.1 == METHODS[0]));
        }
    }
    cases
}

/// mu = 0 to 100, of which an even pressure knows nothing.
fn frictions() -> Vec<Case> {
    let mut cases = Vec::new();
    for way in ways() {
        for mu in ["0.0", "1e-12", "1.0", "5.0", "100.0"] {
            let tolerance = if way.1 == "penalty" { 5e-2 } else { 1e-6 };
            let case = stack(&format!("mu = {mu}"), way, 1e-8)
                .set(format!("contact.c.friction={mu}"))
                .oracle(pressed(stack_force(100.0, 100.0, 0.0, 0.2), tolerance))
                .must_run();
            cases.push(case.quick_if(mu == "100.0" && way.1 == METHODS[0]));
        }
    }
    cases
}

/// A block under a wide and stiff one is pressed, then drawn along x: what slips has mu times the pressure, what sticks moves with
/// the other, as its own nodes that are moved.
fn drawn() -> Vec<Case> {
    let scene = |more: &str, top: &str, by: f64| {
        let step = |name: &str, n: usize, by: [f64; 3]| {
            format!(
                "[[step]]\nname = \"{name}\"\nincrements = {n}\nfix = [{{ set = \"lower.zmin\" }}]\nmove = [{{ target = \"{top}\", by = {by:?} }}]\n"
            )
        };
        format!(
            "[body.lower]\nmaterial = \"a\"\nelement = \"hex8\"\nblock = {{ box = {{ size = [4.0, 4.0, 1.0] }}, elements = [4, 4, 2] }}\n[material.a]\nmodel = \"hooke\"\nyoung = 100.0\npoisson = 0.0\n{more}{}{}[output]\nevery = 1000\nhistory = [\"lower.zmin\", \"{top}\"]\n",
            step("press", 2, [0.0, 0.0, -0.1]),
            step("draw", 4, [by, 0.0, 0.0])
        )
    };
    let mut cases = Vec::new();
    for (discretization, method) in ways() {
        for mu in ["0.0", "1e-12", "0.05", "1.0", "5.0", "100.0"] {
            let upper = format!(
                "[body.upper]\nmaterial = \"b\"\nelement = \"hex8\"\nblock = {{ box = {{ origin = [-2.0, -2.0, 1.0], size = [8.0, 8.0, 1.0] }}, elements = [8, 8, 1] }}\n[material.b]\nmodel = \"hooke\"\nyoung = 1e8\npoisson = 0.0\n[contact.c]\nslave = \"lower.zmax\"\nmaster = \"upper.zmin\"\nfriction = {mu}\ndiscretization = \"{discretization}\"\nmethod = \"{method}\"\n"
            );
            let slips = mu.parse::<f64>().unwrap() < 0.5;
            let by = if slips { 0.8 } else { 0.02 };
            let case = Case::text(format!("mu = {mu}, {discretization}, {method}"), scene(&upper, "upper.zmax", by))
                .oracle(balance(&["lower.zmin", "upper.zmax"], 1e-6));
            let ratio = "lower.zmin.fx/lower.zmin.fz";
            // Where nodes of both penetrate, each by its own share of the force, the faces are not flat.
            let flat = if (discretization, method) == ("two-pass", "penalty") { 1e-3 } else { 1e-6 };
            let case = match mu {
                "0.0" | "1e-12" => case.oracle(near(ratio, 0.0, 1.0, flat, "no friction")),
                "0.05" => case.oracle(near(ratio, -0.05, 1.0, flat, "Coulomb")),
                _ => {
                    let tolerance = if method == "penalty" { 5e-2 } else { 1e-5 };
                    let moved = Case::text("moved", scene("", "lower.zmax", by));
                    case.oracle(same("lower.zmin.fx", moved, tolerance, "nodes that are moved"))
                }
            };
            cases.push(
                case.quick_if(method == METHODS[0] && discretization != "segment" && ["0.05", "5.0"].contains(&mu)),
            );
        }
    }
    cases
}

/// From 1e-12 to half an element apart and into each other.
fn gaps_and_overlaps() -> Vec<Case> {
    let mut cases = Vec::new();
    for way in ways() {
        for gap in [1e-12f64, 1e-9, 1e-6, 1e-3, 0.1, 0.5].into_iter().flat_map(|gap| [gap, -gap]) {
            let tolerance = if way.1 == "penalty" { 5e-2 } else { 1e-6 };
            let mut case = stack(&format!("{gap:e}"), way, 1e-8)
                .set(format!("body.upper.block.box.origin=[0.0, 0.0, {:?}]", 2.0 + gap))
                .set(format!("step.press.move.0.by=[0, 0, {:?}]", -0.6 - gap))
                .oracle(pressed(stack_force(100.0, 100.0, 0.0, 0.6), tolerance));
            if gap.abs() < 0.1 {
                case = case.must_run();
            }
            cases.push(case.quick_if(gap.abs() == 0.5 && way.1 == METHODS[0] && way.0 != "node-to-node"));
        }
    }
    cases
}

/// One up to 1e12 times stiffer than the other, as slave and as master, with friction.
fn stiffness_ratios() -> Vec<Case> {
    let mut cases = Vec::new();
    for way in ways() {
        for power in [-12, -9, -6, -3, 3, 6, 9, 12] {
            let ratio = 10f64.powi(power);
            let tolerance = if way.1 == "penalty" { 5e-2 } else { rounded(ratio) };
            let case = stack(&format!("upper 1e{power} times lower"), way, rounded(ratio))
                .set(format!("material.b.young={:?}", 100.0 * ratio))
                .set("contact.c.friction=1.0")
                .oracle(pressed(stack_force(100.0, 100.0 * ratio, 0.0, 0.2), tolerance));
            let case = if power.abs() <= 6 { case.must_run() } else { case };
            cases.push(case.quick_if(power.abs() == 9 && way.1 == METHODS[0]));
        }
    }
    cases
}

/// A node of the second pass that yields has no force of its own, and is as deep as that of the one that it yields to lets it.
fn two_passes_by_penalty() -> Vec<Case> {
    [20.0, 200.0]
        .map(|penalty| {
            let give = |depth: f64| stack_force(100.0, 100.0, 0.0, 0.2 - depth) + 4.0 * penalty * depth;
            let force = stack_force(100.0, 100.0, 0.0, 0.2 - root(0.0, 0.2, give));
            Case::text(format!("penalty = {penalty}"), STACK)
                .sets(["body.lower.block.elements=[1, 1, 1]", "body.upper.block.elements=[1, 1, 1]"])
                .sets(["material.a.poisson=0.0", "material.b.poisson=0.0", "contact.c.method=penalty"])
                .set("contact.c.discretization=two-pass")
                .set(format!("contact.c.penalty={penalty:?}"))
                .oracle(value("upper.zmax.fz", force, 1e-6, "closed form"))
                .must_run()
        })
        .into()
}
