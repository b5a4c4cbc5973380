//! ```text
//!         \ v v /          Two rings, radii 0.2, 0.6 and 1 m, E = 1e9 Pa, nu = 0.2, frictionless, under a pressure of p = 1e6 Pa
//!      > /  ___  \ <       from outside (Code_Aster ssnp152). They are as one ring (Lame):
//!      > | (___) | <         contact pressure  p (1 - 0.2^2 / 0.6^2) / (1 - 0.2^2) = 925,925.93 Pa.
//!      > \_______/ <       It stays when they are turned together, here by 2.1 rad.
//!         / ^ ^ \
//! ```
//! Interference: rings of 20 to 40 and 40 to 60 mm with an interference d = 0.04 mm at the radius b = 40, E = 210 GPa, nu
//! = 0.3, plane strain: p = E' d (b^2 - a^2) (c^2 - b^2) / (2 b^3 (c^2 - a^2)), E' = E / (1 - nu^2).

use crate::common::Run;
use crate::grid::{Grid, even};
use crate::solve;
use crate::table::Oracle;
use std::f64::consts::TAU;

/// Mean pressure and largest difference from it over the contact.
fn pressure(run: &Run, increment: usize) -> (f64, f64) {
    let pressures = run.scalars(increment, "contact.fit", "pressure");
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    (mean, pressures.iter().map(|p| (p / mean - 1.0).abs()).fold(0.0, f64::max))
}

/// A quarter of two rings, `n` elements across each, and so many around the inner and the outer one.
fn quarter(radii: [f64; 4], n: usize, around: [usize; 2], elastic: &str, step: &str) -> Run {
    let scene = format!(
        r#"
        [body.inner]
        material = "ring"
        plane_strain = true
        symmetry = ["amin", "amax"]
        block = {{ sector = {{ radii = [{:?}, {:?}], angles = [0.0, 90.0], length = 1.0 }}, elements = [{n}, {}, 1] }}
        [body.outer]
        material = "ring"
        plane_strain = true
        symmetry = ["amin", "amax"]
        block = {{ sector = {{ radii = [{:?}, {:?}], angles = [0.0, 90.0], length = 1.0 }}, elements = [{n}, {}, 1] }}
        [material.ring]
        model = "hooke"
        {elastic}
        [contact.fit]
        slave = "inner.rmax"
        master = "outer.rmin"
        [[step]]
        increments = 1
        {step}
        "#,
        radii[0], radii[1], around[0], radii[2], radii[3], around[1],
    );
    solve(1, &scene, &[])
}

/// Under a hundredth of the pressure: the closed form is linear, and strains of 1e-3 are off by as much.
#[test]
fn pressed_from_outside() {
    let exact = (1.0 - 0.04 / 0.36) / (1.0 - 0.04);
    let under = |p: f64, n: usize, around: [usize; 2]| {
        let load = format!("pressure = [{{ set = \"outer.rmax\", value = {p:?} }}]");
        let (mean, scatter) =
            pressure(&quarter([0.2, 0.6, 0.6, 1.0], n, around, "young = 1e9\npoisson = 0.2", &load), 1);
        (mean / p, scatter)
    };
    let mut oracle = Oracle::new("Lame's rings");
    let [coarse, fine] = [5, 10].map(|n| under(1e4, n, [2 * n; 2]));
    oracle.close("contact pressure over p, 20 across", fine.0, exact, 1e-3);
    oracle.within("the same, unevenness", fine.1, 0.0, 1e-8);
    oracle.within("order of convergence", ((coarse.0 - exact) / (fine.0 - exact)).log2(), 2.0, 0.2);
    // Two nodes of the inner ring to one of the outer: patches are parabolas over 4.5 degrees.
    let unlike = under(1e6, 10, [40, 20]);
    oracle.close("contact pressure over p, unlike meshes", unlike.0, exact, 1e-3);
    oracle.within("the same, unevenness", unlike.1, 0.0, 0.01);
}

#[test]
fn with_interference() {
    let mut oracle = Oracle::new("rings with interference");
    let run = quarter([20.0, 40.02, 39.98, 60.0], 8, [48, 24], "young = 210e3\npoisson = 0.3", "");
    let (a, b, c): (f64, f64, f64) = (20.0, 40.0, 60.0);
    let exact = 210e3 / (1.0 - 0.09) * 0.04 * (b * b - a * a) * (c * c - b * b) / (2.0 * b.powi(3) * (c * c - a * a));
    let (mean, scatter) = pressure(&run, run.written());
    oracle.close("contact pressure, MPa", mean, exact, 0.01);
    oracle.within("unevenness", scatter, 0.0, 0.02);
}

/// A whole ring, with names for the nodes of one of its edges at 0, 90, 180 and 270 degrees.
fn whole(radii: [f64; 2], across: usize, around: usize, held: f64) -> String {
    let clean = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
    let place = |[r, part, z]: [f64; 3]| {
        let (s, c) = (part * TAU).sin_cos();
        [clean(r * c), clean(r * s), z]
    };
    Grid::default()
        .block(
            [&even(radii[0], radii[1], across), &even(0.0, 1.0, around), &[0.0, 1.0]],
            ["inside", "outside", "", "", "", ""],
            place,
        )
        .mark("east", |x| x[0] == held)
        .mark("west", |x| x[0] == -held)
        .mark("poles", |x| x[0] == 0.0 && x[1].abs() == held)
        .mark("equator", |x| x[1] == 0.0 && x[0].abs() == held)
        .text()
}

/// The turn holds the nodes at east and west of both rings to where the pressed rings turn to.
#[test]
fn turned_together() {
    let meshes = [("inner.msh", whole([0.2, 0.6], 4, 48, 0.2)), ("outer.msh", whole([0.6, 1.0], 4, 48, 1.0))];
    let names = ["inner", "outer"];
    let scene = |turns: &str| {
        let fixed = names.map(|b| {
            format!("{{ set = \"{b}.poles\", directions = \"x\" }}, {{ set = \"{b}.equator\", directions = \"y\" }}")
        });
        format!(
            r#"
            [body.inner]
            mesh = "inner.msh"
            material = "ring"
            plane_strain = true
            [body.outer]
            mesh = "outer.msh"
            material = "ring"
            plane_strain = true
            [material.ring]
            model = "hooke"
            young = 1e9
            poisson = 0.2
            [contact.fit]
            slave = "inner.outside"
            master = "outer.inside"
            [[step]]
            name = "press"
            increments = 1
            fix = [{}]
            pressure = [{{ set = "outer.outside", value = 1e6 }}]
            {turns}
            [output]
            history = ["inner.east", "outer.east"]
            "#,
            fixed.join(", ")
        )
    };
    let pressed = solve(1, &scene(""), &meshes);
    let radius = [0.2 + pressed.history().last("inner.east.ux"), 1.0 + pressed.history().last("outer.east.ux")];
    let (steps, angle) = (21, 0.1);
    let turns: String = (0..steps)
        .map(|k| {
            let at = |k: i32| (angle * f64::from(k)).sin_cos();
            let ((s0, c0), (s1, c1)) = (at(k), at(k + 1));
            let moves = names.iter().zip(radius).flat_map(|(body, r)| {
                [("east", r), ("west", -r)].map(|(side, r)| {
                    format!("{{ target = \"{body}.{side}\", by = [{:?}, {:?}, 0.0], directions = \"xy\" }}", r * (c1 - c0), r * (s1 - s0))
                })
            });
            format!(
                "[[step]]\nname = \"turn-{k}\"\nincrements = 1\nmove = [{}]\npressure = [{{ set = \"outer.outside\", value = 1e6 }}]\n",
                moves.collect::<Vec<_>>().join(", ")
            )
        })
        .collect();
    let run = solve(1, &scene(&turns), &meshes);
    let mut oracle = Oracle::new("rings turned together");
    let (first, last) = (pressure(&run, 1), pressure(&run, run.written()));
    oracle.close("contact pressure before, Pa", first.0, 1e6 * (1.0 - 0.04 / 0.36) / 0.96, 0.01);
    oracle.close("after the turn by 2.1 rad, over that before", last.0 / first.0, 1.0, 1e-8);
    oracle.within("unevenness after the turn", last.1, first.1, 1e-7);
    oracle.within("force that holds them, over p R", run.history().largest_force("outer.east") / 1e6, 0.0, 1e-6);
    let turned = run.history().last("outer.east.uy").atan2(run.history().last("outer.east.ux") + 1.0);
    oracle.within("angle, rad", turned, 2.1, 1e-9);
}
