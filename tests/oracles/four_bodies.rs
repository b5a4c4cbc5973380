//! ```text
//!       |v v v| -2 mm            Elastic bodies on the axis, E = 200 GPa, nu = 0.3, frictionless: a plate of radius 10 and
//!       |_____| 10 x 2           thickness 2, balls of R = 5 and 10, a plate of radius 20 and thickness 4 that is held at its rim
//!         (_)   R = 5            (Code_Aster ssna102). The top goes down by 2 mm: the lower face of the lower plate goes down by
//!        (   )  R = 10           0.81 mm on the axis (mean of Abaqus, Systus and Samcef), 0.841 in Code_Aster; the reaction of the
//!        (___)                   rim is 17,230 N a radian, 17,497 in Code_Aster.
//!     |________|  held
//!          PA4    20 x 4
//! ```
//! A quarter of all, with a bore of radius 0.1 along the axis that keeps the elements whole.

use crate::grid::{Grid, disk, even, on, part, turned};
use crate::table::Oracle;
use crate::{component, mean, solve};
use std::f64::consts::FRAC_PI_2;

const BORE: f64 = 0.1;

/// A ball about a point of the axis: rows and columns of a square that is taken to the disk.
fn ball(radius: f64, middle: f64, fine: f64) -> String {
    let edge = 2.0f64.sqrt();
    let start = BORE / radius;
    let across = on(vec![edge * start], 0.3 / radius / fine * edge, 1.0, part(12, fine) as i32);
    let half = on(vec![-1.0], 0.3 / radius / fine, 0.0, part(9, fine) as i32);
    let up: Vec<f64> = half.iter().copied().chain(half.iter().rev().skip(1).map(|v| -v)).collect();
    let (around, turned) = (even(0.0, 1.0, part(4, fine)), turned(part(4, fine)));
    // The bore is straight, as the columns of the square are at the axis.
    Grid::default()
        .block([&across, &around, &up], ["", "", "xz", "yz", "below", "above"], |[u, turn, v]| {
            let (r, z) = disk(u, v);
            turned([radius * r, turn, middle + radius * z])
        })
        .text()
}

fn plate(radius: f64, low: f64, high: f64, fine: f64, layers: usize) -> String {
    let across = on(vec![BORE], 0.4 / fine, radius, part(10 + radius as usize, fine) as i32);
    let (around, turned) = (even(0.0, 1.0, part(4, fine)), turned(part(4, fine)));
    Grid::default()
        .block(
            [&across, &around, &even(low, high, part(layers, fine))],
            ["", "rim", "xz", "yz", "below", "above"],
            turned,
        )
        .text()
}

fn against_the_published(fine: f64) {
    // Where the bores of the balls end; the bodies touch there.
    let tip = |radius: f64| {
        let (r, z) = disk(2.0f64.sqrt() * BORE / radius, 1.0);
        assert!((radius * r - BORE).abs() < 1e-12);
        radius * z
    };
    let large = tip(10.0);
    let small = 2.0 * large + tip(5.0);
    let top = small + tip(5.0);
    let meshes = [
        ("ground.msh", plate(20.0, -4.0, 0.0, fine, 4)),
        ("large.msh", ball(10.0, large, fine)),
        ("small.msh", ball(5.0, small, fine)),
        ("head.msh", plate(10.0, top, top + 2.0, fine, 3)),
    ];
    let bodies = ["ground", "large", "small", "head"].map(|name| {
        format!("[body.{name}]\nmesh = \"{name}.msh\"\nmaterial = \"steel\"\nsymmetry = [\"xz\", \"yz\"]\n")
    });
    let scene = format!(
        r#"
        {}
        [material.steel]
        model = "hooke"
        young = 200e3
        poisson = 0.3
        [contact.first]
        slave = "small.above"
        master = "head.below"
        [contact.second]
        slave = "small.below"
        master = "large.above"
        [contact.third]
        slave = "large.below"
        master = "ground.above"
        [[step]]
        increments = 4
        fix = [{{ set = "ground.rim" }}]
        move = [{{ target = "head.above", by = [0.0, 0.0, -2.0], directions = "z" }}]
        [output]
        every = 100
        history = ["ground.rim", "head.above"]
        "#,
        bodies.join("")
    );
    let run = solve(2, &scene, &meshes);
    let mut oracle = Oracle::new("four bodies");
    let moved = component(&run.vectors(run.written(), "body.ground", "displacement"), 2);
    let sunk = mean(&run.points("body.ground"), &moved, |x| x[2] == -4.0 && x[0].hypot(x[1]) < 1.5 * BORE);
    oracle.between("u_z of the lower plate on the axis, mm", sunk, -0.81, -0.841, 0.04);
    // Not 4 %: theirs are small strains, and those under the balls are 0.2, where Hencky's law is the stiffer.
    oracle.between(
        "reaction of the rim, N a radian",
        run.history().last("ground.rim.fz") / FRAC_PI_2,
        17_229.58,
        17_496.6,
        0.1,
    );
}

#[test]
fn as_published() {
    against_the_published(1.0);
}

#[test]
#[ignore = "extremes: elements of two thirds of the size"]
fn as_published_finer() {
    against_the_published(1.5);
}
