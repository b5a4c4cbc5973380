//! Axisymmetric bodies: rings of any radius, in any unit, under a plate.

use crate::case::Case;
use crate::oracle::{near, same, scaled, value};
use crate::scenes::{METHODS, bar_force};
use std::f64::consts::PI;

family!(radii, units, poisson, penalties, increments, frictions, cores);

/// A ring of the section `width` x `height` from radius `inner` on, free at its sides, of E = 10, under a smooth plate.
fn ring(name: String, [inner, width, height]: [f64; 3], young: f64) -> Case {
    let scene = format!(
        r#"[body.b]
material = "m"
element = "hex8-sri"
axisymmetric = true
symmetry = ["ymin"]
block = {{ box = {{ origin = [{inner:?}, 0.0, 0.0], size = [{width:?}, {height:?}, {:?}] }}, elements = [3, 3, 1] }}
[material.m]
model = "hooke"
young = {young:?}
poisson = 0.3
[tool.p]
plane = {{ point = [0.0, {height:?}, 0.0], normal = [0.0, -1.0, 0.0] }}
[contact.c]
slave = "b.ymax"
master = "p"
[[step]]
name = "press"
increments = 2
move = [{{ target = "p", by = [0.0, {:?}, 0.0] }}]
[output]
every = 1000
history = ["b.ymin", "b.xmax"]
"#,
        0.1 * height,
        -0.2 * height
    );
    // Any ring under axial stress alone is strained alike: no hoop stress.
    let outer = inner + width;
    Case::text(name, scene)
        .oracle(value("p.fy", bar_force(young, PI * width * (outer + inner), 0.8), 1e-6, "closed form"))
        .oracle(near("b.ymin.fx", 0.0, 2.0 * PI * young * outer * height, 1e-7, "free sides"))
}

fn radii() -> Vec<Case> {
    [0.0, 1e-6, 1e-3, 1.0, 1e2, 1e3, 1e4, 1e6]
        .map(|inner| {
            let case = ring(format!("inner radius {inner:e} times the width"), [inner, 1.0, 1.0], 10.0);
            let case = if inner <= 1e3 { case.must_run() } else { case };
            case.quick_if([0.0, 1e-6, 1e3].contains(&inner))
        })
        .into()
}

fn units() -> Vec<Case> {
    let mut cases = Vec::new();
    for (length, modulus) in [(1e-9, 1.0), (1e9, 1.0), (1.0, 1e-7), (1.0, 1e17), (1e-9, 1e17), (1e9, 1e-7)] {
        let name = format!("lengths times {length:e}, E times {modulus:e}");
        let case = ring(name, [0.5 * length, length, length], 10.0 * modulus).must_run();
        cases.push(case.quick_if(length == 1e-9 && modulus == 1.0));
    }
    for flat in [1e-4, 1e-2, 1e2, 1e4] {
        cases.push(ring(format!("height over width {flat:e}"), [0.5, 1.0, flat], 10.0).slow());
    }
    cases
}

fn poisson() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["hex8", "hex8-fbar", "hex8-sri"] {
        for nu in ["-0.99", "0.0", "0.4999", "0.499999999", "0.499999999999"] {
            let case = ring(format!("nu = {nu}, {element}"), [0.0, 1.0, 1.0], 10.0);
            let case = case.sets([format!("body.b.element={element}").as_str(), &format!("material.m.poisson={nu}")]);
            cases.push(case.slow());
        }
    }
    cases
}

fn penalties() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in &METHODS[..3] {
        for power in [-6, -3, 3, 6, 9, 12, 15] {
            let case = ring(format!("1e{power} times 10, {method}"), [0.0, 1.0, 1.0], 10.0)
                .set(format!("contact.c.method={method}"))
                .set(format!("contact.c.penalty={:?}", 10.0 * 10f64.powi(power)));
            cases.push(case.slow());
        }
    }
    cases
}

fn increments() -> Vec<Case> {
    let mut cases: Vec<Case> = [1, 1000]
        .map(|n| {
            let case = ring(format!("{n} increments"), [0.0, 1.0, 1.0], 10.0).must_run();
            case.set(format!("step.press.increments={n}")).slow()
        })
        .into();
    cases.push(ring("tolerance 1e-14".into(), [0.0, 1.0, 1.0], 10.0).set("solver.tolerance=1e-14").slow());
    cases.push(
        ring("7 ranks".into(), [0.0, 1.0, 1.0], 10.0).set("body.b.block.elements=[1, 1, 1]").ranks(7).must_run().slow(),
    );
    cases
}

/// No friction to speak of, and so much that all sticks: what nodes give that are moved with the plate.
fn frictions() -> Vec<Case> {
    let disc = |name: &str| ring(name.into(), [0.0, 1.0, 1.0], 10.0).set("body.b.block.elements=[6, 6, 1]").slow();
    let moved = disc("moved").set("step.press.move.0.target=b.ymax").set("tool.p.plane.point=[0.0, 3.0, 0.0]");
    vec![
        disc("mu = 1e-12").set("contact.c.friction=1e-12"),
        disc("mu = 100")
            .without_oracles()
            .set("contact.c.friction=100.0")
            .oracle(value("p.fy/b.ymin.fy", -1.0, 1e-8, "balance"))
            .oracle(same("b.ymin.fy", moved, 1e-6, "nodes that are moved with the plate")),
    ]
}

/// A core that is pressed into a ring, in other units.
fn cores() -> Vec<Case> {
    let fit = |name: String, length: f64, modulus: f64, overlap: f64| {
        let body = |name: &str, x: f64, w: f64| {
            format!(
                "[body.{name}]\nmaterial = \"m\"\nelement = \"hex8-sri\"\naxisymmetric = true\nblock = {{ box = {{ origin = \
                 [{:?}, 0.0, 0.0], size = [{:?}, {length:?}, {:?}] }}, elements = [4, 2, 1] }}\n",
                x * length,
                w * length,
                0.1 * length
            )
        };
        let held = ["core.ymin", "core.ymax", "ring.ymin", "ring.ymax"]
            .map(|set| format!("{{ set = \"{set}\", directions = \"y\" }}"))
            .join(", ");
        Case::text(
            name,
            format!(
                "{}{}[material.m]\nmodel = \"hooke\"\nyoung = {:?}\npoisson = 0.3\n[contact.c]\nslave = \"core.xmax\"\nmaster = \
                 \"ring.xmin\"\n[[step]]\nincrements = 1\nfix = [{held}]\n[output]\nevery = 1000\nhistory = [\"ring.xmax\"]\n",
                body("core", 0.0, 1.0 + overlap),
                body("ring", 1.0, 1.0),
                100.0 * modulus
            ),
        )
    };
    let one = fit("one".into(), 1.0, 1.0, 1e-3);
    let mut cases = Vec::new();
    for (length, modulus) in [(1e-9, 1e16), (1e9, 1e-8)] {
        let name = format!("lengths times {length:e}, E times {modulus:e}");
        let case = fit(name, length, modulus, 1e-3).must_run();
        cases.push(
            case.oracle(scaled("c.fx", one.clone(), length * length * modulus, 1e-6, "the scene in other units"))
                .slow(),
        );
    }
    for overlap in [1e-12, 1e-9, 1e-6] {
        let case = fit(format!("overlap {overlap:e}"), 1.0, 1.0, overlap);
        // By Lame the force is linear in small overlaps.
        cases.push(
            case.oracle(scaled("c.fx", one.clone(), overlap / 1e-3, 1e-2 + 1e-14 / overlap, "linear in it")).slow(),
        );
    }
    cases
}
