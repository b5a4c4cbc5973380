//! Contact from segment to segment.

use crate::case::Case;
use crate::numbers::{ball, rounded};
use crate::oracle::{balance, near, same, scaled, value};
use crate::scenes::{GLUED, SLAB, STACK, bar_force, glued, stack_force};

family!(stacks, units, frictions, opening);

const METHODS: [&str; 3] = ["augmented-lagrangian", "lagrange", "penalty"];

fn by_segments(case: Case, contact: &str) -> Case {
    case.set(format!("contact.{contact}.discretization=segment"))
}

/// Two bars of unlike meshes, stiffnesses, penalties, tolerances and increments: an even pressure passes.
fn stacks() -> Vec<Case> {
    let stack = |name: String, upper: f64, tolerance: f64| {
        let force = stack_force(100.0, upper, 0.3, 0.2);
        by_segments(Case::text(name, STACK), "c")
            .set(format!("material.b.young={upper:?}"))
            .oracle(value("upper.zmax.fz", force, tolerance, "closed form"))
            .oracle(value("lower.zmin.fz", -force, tolerance, "closed form"))
    };
    let mut cases = Vec::new();
    for method in METHODS {
        for power in [-12, -6, -3, 3, 6, 12] {
            let ratio = 10f64.powi(power);
            let tolerance = if method == "penalty" { 5e-2 } else { rounded(ratio) };
            cases.push(
                stack(format!("upper 1e{power} times lower, {method}"), 100.0 * ratio, tolerance)
                    .sets([format!("contact.c.method={method}").as_str(), "contact.c.friction=0.3"])
                    .quick_if(method == METHODS[0] && power.abs() == 6),
            );
        }
    }
    for (lower, upper) in
        [([1, 1, 1], [100, 1, 1]), ([100, 1, 1], [1, 1, 1]), ([3, 3, 1], [7, 7, 1]), ([20, 20, 1], [2, 2, 1])]
    {
        cases.push(
            stack(format!("{lower:?} on {upper:?}"), 100.0, 1e-6)
                .set(format!("body.lower.block.elements={lower:?}"))
                .set(format!("body.upper.block.elements={upper:?}"))
                .must_run()
                .quick_if(upper == [7, 7, 1]),
        );
    }
    for power in [-6, -3, 3, 6, 9, 12, 15] {
        for method in &METHODS[..2] {
            let penalty = 20.0 * 10f64.powi(power);
            cases.push(
                stack(format!("penalty 1e{power} times automatic, {method}"), 100.0, 1e-6)
                    .sets([format!("contact.c.method={method}").as_str(), &format!("contact.c.penalty={penalty:?}")])
                    .slow(),
            );
        }
    }
    for (tolerance, error) in [("1e-14", 1e-9), ("0.0099", 2e-2)] {
        cases.push(
            stack(format!("tolerance {tolerance}"), 100.0, error).set(format!("solver.tolerance={tolerance}")).slow(),
        );
    }
    for increments in [1, 1000] {
        let case = stack(format!("{increments} increments"), 100.0, 1e-6).must_run();
        cases.push(case.set(format!("step.press.increments={increments}")).slow());
    }
    cases
}

/// A sphere on a block in other units, and far from the origin.
fn units() -> Vec<Case> {
    let one = || by_segments(ball("one", 1.0, 1.0, 0.0), "top");
    let mut cases = Vec::new();
    for (length, modulus) in [(1e-9, 1e16), (1e9, 1e-8), (1e-9, 1e-8), (1e9, 1e16)] {
        let case =
            by_segments(ball(&format!("lengths times {length:e}, E times {modulus:e}"), length, modulus, 0.0), "top");
        let times = length * length * modulus;
        cases.push(
            case.oracle(scaled("cap.fx", one(), times, 1e-6, "the scene in other units"))
                .oracle(scaled("cap.fz", one(), times, 1e-6, "the scene in other units"))
                .must_run()
                .slow(),
        );
    }
    for power in [2, 4, 6, 9] {
        let case = by_segments(ball(&format!("1e{power} sizes away"), 1.0, 1.0, 40.0 * 10f64.powi(power)), "top");
        cases.push(
            case.oracle(same("cap.fx", one(), 1e-4, "the scene at the origin"))
                .oracle(balance(&["cap", "block.zmin"], 1e-6))
                .slow(),
        );
    }
    cases
}

/// mu = 0 to 100 under a plate.
fn frictions() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        let slab = |mu: &str, by: &str| {
            by_segments(Case::text(format!("mu = {mu}, {method}"), SLAB), "c")
                .sets([format!("contact.c.friction={mu}").as_str(), by, &format!("contact.c.method={method}")])
                .oracle(balance(&["t", "b.zmin"], 1e-8))
                .slow()
        };
        let (far, near_by) = ("step.draw.move.0.by=[0.5, 0, 0]", "step.draw.move.0.by=[0.1, 0, 0]");
        let some = if method == "penalty" { 3e-2 } else { 1e-6 };
        cases.extend([
            slab("0.0", far).oracle(near("t.fx", 0.0, 1.0, 1e-9, "no friction")),
            slab("1e-12", far).oracle(near("t.fx/t.fz", 0.0, 1.0, 2e-12, "Coulomb")),
            slab("0.05", far).oracle(near("t.fx/t.fz", -0.05, 0.05, 1e-6, "Coulomb")),
            slab("100.0", near_by).oracle(same("b.zmin.fx", glued([0.1, 0.0, 0.0]), some, GLUED)),
            slab("100.0", near_by)
                .named(&format!("mu = 100, in one increment, {method}"))
                .sets(["step.press.increments=1", "step.draw.increments=1"])
                .oracle(same("b.zmin.fx", glued([0.1, 0.0, 0.0]), some, GLUED)),
        ]);
    }
    cases
}

/// Closed, opened and closed again, each in one increment and in 100.
fn opening() -> Vec<Case> {
    let step = |by: f64, n: usize| {
        format!("[[step]]\nincrements = {n}\nmove = [{{ target = \"p\", by = [0.0, 0.0, {by:?}] }}]\n")
    };
    [1, 100]
        .map(|n| {
            let (head, _) = crate::scenes::BAR.split_once("[[step]]").unwrap();
            let steps = [step(-0.4, n), step(0.9, n), step(-0.9, n)].concat();
            by_segments(
                Case::text(
                    format!("{n} increments a step"),
                    format!("{head}{steps}[output]\nevery = 1000\nhistory = [\"b.zmin\"]\n"),
                ),
                "c",
            )
            .oracle(value("p.fz", bar_force(10.0, 4.0, 0.8), 1e-6, "closed form"))
            .must_run()
            .quick_if(n == 1)
        })
        .into()
}
