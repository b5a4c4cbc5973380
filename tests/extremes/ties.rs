//! Ties of unlike meshes and stiffnesses.

use crate::case::Case;
use crate::numbers::rounded;
use crate::oracle::value;
use crate::scenes::{STACK, held_bar_force, stack_force};

family!(stiffness_ratios, unlike_meshes, units, gaps);

/// [`STACK`] tied, pressed or pulled.
fn tied(name: String, by: f64, young: [f64; 2], tolerance: f64) -> Case {
    let contact = "[contact.c]\nslave = \"lower.zmax\"\nmaster = \"upper.zmin\"";
    let scene = STACK
        .replace(contact, "[tie.c]\nslave = \"lower.zmax\"\nmaster = \"upper.zmin\"")
        .replace("-0.2]", &format!("{by:?}]"));
    // `stack_force` is of a shortening: pulled bars of unlike stiffness are looked at where one takes all.
    let force = if by < 0.0 {
        stack_force(young[0], young[1], 0.3, -by)
    } else {
        held_bar_force(young[0], 0.3, 4.0, 1.0 + by / 4.0)
    };
    Case::text(name, scene)
        .set(format!("material.a.young={:?}", young[0]))
        .set(format!("material.b.young={:?}", young[1]))
        .oracle(value("upper.zmax.fz", force, tolerance, "closed form"))
        .oracle(value("lower.zmin.fz", -force, tolerance, "closed form"))
}

fn stiffness_ratios() -> Vec<Case> {
    [-12, -9, -6, -3, 3, 6, 9, 12]
        .map(|power: i32| {
            let ratio = 10f64.powi(power);
            let case = tied(format!("upper 1e{power} times lower"), -0.2, [100.0, 100.0 * ratio], rounded(ratio));
            case.quick_if(power.abs() == 6)
        })
        .into()
}

fn unlike_meshes() -> Vec<Case> {
    let mut cases = Vec::new();
    for (lower, upper) in [
        ([1, 1, 1], [100, 1, 1]),
        ([100, 1, 1], [1, 1, 1]),
        ([20, 20, 1], [2, 2, 1]),
        ([2, 2, 1], [20, 20, 1]),
        ([3, 3, 1], [7, 7, 1]),
        ([100, 1, 1], [1, 100, 1]),
    ] {
        for by in [-0.2, 0.2] {
            let case = tied(format!("{lower:?} on {upper:?} by {by}"), by, [100.0; 2], 1e-6)
                .set(format!("body.lower.block.elements={lower:?}"))
                .set(format!("body.upper.block.elements={upper:?}"));
            cases.push(case.quick_if(lower == [3, 3, 1] && by > 0.0));
        }
    }
    for n in [1, 1000] {
        cases.push(
            tied(format!("{n} increments"), 0.2, [100.0; 2], 1e-6).set(format!("step.press.increments={n}")).slow(),
        );
    }
    for ranks in [4, 7] {
        let case = tied(format!("one on one, {ranks} ranks"), 0.2, [100.0; 2], 1e-6).ranks(ranks).must_run();
        cases.push(case.sets(["body.lower.block.elements=[1, 1, 1]", "body.upper.block.elements=[1, 1, 1]"]).slow());
    }
    cases
}

/// Forces go with the modulus: also of both at once.
fn units() -> Vec<Case> {
    [1e-8, 1e-4, 1e8, 1e16]
        .map(|modulus| tied(format!("E times {modulus:e}"), -0.2, [100.0 * modulus; 2], 1e-6).must_run().slow())
        .into()
}

/// Small gaps are closed, larger ones refused.
fn gaps() -> Vec<Case> {
    [1e-12, 1e-6, 1e-3, 0.05, 0.5]
        .map(|gap| {
            let case = tied(format!("a gap of {gap:e}"), 0.2, [100.0; 2], 1e-6 + gap)
                .set(format!("body.upper.block.box.origin=[0.0, 0.0, {:?}]", 2.0 + gap));
            if gap > 0.2 { case.must_be_refused(&["apart"]) } else { case.slow() }
        })
        .into()
}
