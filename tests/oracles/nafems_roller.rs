//! ```text
//!              | 35 kN/mm        Steel roller, R = 50 mm, E = 210 GPa, on an aluminium block of 200 x 200 mm, E = 70 GPa, nu =
//!             _v_                0.3 both, plane strain; the block is held below. Half of it, by symmetry. NAFEMS, Advanced
//!            /   \               Finite Element Contact Benchmarks (Konter 2006), benchmark 1; also Code_Aster ssnp154.
//!            \_ _/
//!       ______ B ______          Closed form (Hertz): b = sqrt(4 F R / (pi E*)) = 6.21 mm, p0 = 2 F / (pi b) = 3585 MPa, with
//!      |     block     |         1/E* = (1 - nu^2) (1/E1 + 1/E2). Displacement of B, where they touch first, from Code_Aster's
//!      |_______________| held    linear elements: -1.3069 mm without friction, -1.3011 with mu = 0.1.
//! ```
//!
//! B is that point: "the point on the higher side of the block pertaining to the symmetry plane" (V6.03.154). The roller's top
//! goes down by 1.96 mm here, and by the more the finer it is meshed, for a force on a line leads into it.
//!
//! Hertz's theory is linear. Under this load the aluminium is strained by some per cent, and the law counts: Code_Aster
//! computes with Green's strain (GROT_GDEP), nagata's `hooke` is Hencky's. A plain program for the block alone under Hertz's
//! pressure, with 24 elements of 4 nodes over the half-width, gives -1.274 mm by Hencky's law, -1.279 by small strains and
//! -1.330 by Green's: 2 % are less than what lies between two laws. So B is held to 3.5 % as published, where it is 3.3 %
//! off, and all is held to a roller 100 times as large under a hundredth of the load, too: contact is as wide, strains and
//! displacements of the block are a hundredth, and B is 2.2 % off with 24 elements over the half-width, 2.1 % with 48.

use crate::common::hertz::ellipse;
use crate::grid::{Grid, disk, even, mirrored, on};
use crate::table::Oracle;
use crate::{along_x, component, mean, solve};
use std::f64::consts::PI;

/// Roller and block, MPa.
const YOUNG: [f64; 2] = [210e3, 70e3];
const POISSON: f64 = 0.3;

/// Displacement of B by small strains, from a plain program for this block alone: Hertz's pressure on 4-node elements, 12,
/// 24 and 48 over the half-width, gives -1.2790, -1.2784 and -1.2778 mm.
const LINEAR: f64 = -1.2778;

/// Half-width and highest pressure of Hertz under a force per length, N/mm.
fn hertz(radius: f64, force: f64) -> (f64, f64) {
    let modulus = 1.0 / YOUNG.iter().map(|e| (1.0 - POISSON * POISSON) / e).sum::<f64>();
    let b = (4.0 * force * radius / (PI * modulus)).sqrt();
    (b, 2.0 * force / (PI * b))
}

/// `fine` elements of the block over the half-width, the roller `scale` times as large under that part of the load.
/// Displacement of B times `scale`, and relative errors of half-width and highest pressure.
fn press(oracle: &mut Oracle, scale: f64, friction: f64, fine: usize) -> [f64; 3] {
    let (radius, force) = (50.0 * scale, 35e3 / scale);
    let (b, highest) = hertz(radius, force);
    let far = 7 * fine as i32 / 4;
    let size = b / fine as f64;
    // The roller's elements are a third longer: nodes of the block are the slaves.
    let arc = 4.0 / 3.0 * size / radius * 2.0f64.sqrt();
    let across = on(even(0.0, arc * fine as f64, fine), arc, 1.0, far + (4.0 * scale.log10()) as i32);
    let up = on(vec![-1.0], arc / 2.0f64.sqrt(), 0.0, far + 4 + (4.0 * scale.log10()) as i32);
    let up = on(up, 1.0 / 6.0, 1.0, 6);
    let roller = Grid::default()
        .block([&across, &up, &[0.0, 1.0]], ["axis", "", "rim", "", "", ""], |[u, v, z]| {
            let (x, y) = disk(u, v);
            [radius * x, radius * (1.0 + y), z]
        })
        .mark("top", |x| x[0] == 0.0 && x[1] == 2.0 * radius);
    let across = on(even(0.0, 1.25 * b, fine + fine / 4), size, 100.0, far + 2);
    let down = on(vec![0.0], 0.7 * size, 200.0, far + 6);
    let block =
        Grid::default().block([&across, &mirrored(&down), &[0.0, 1.0]], ["axis", "", "base", "top", "", ""], |x| x);
    let scene = format!(
        r#"
        [body.roller]
        mesh = "roller.msh"
        material = "steel"
        plane_strain = true
        symmetry = ["axis"]
        [body.block]
        mesh = "block.msh"
        material = "aluminium"
        plane_strain = true
        symmetry = ["axis"]
        [material.steel]
        model = "hooke"
        young = {:?}
        poisson = {POISSON:?}
        [material.aluminium]
        model = "hooke"
        young = {:?}
        poisson = {POISSON:?}
        [contact.strip]
        slave = "block.top"
        master = "roller.rim"
        friction = {friction:?}
        [[step]]
        name = "press"
        increments = 5
        fix = [{{ set = "block.base" }}]
        force = [{{ target = "roller.top", total = [0.0, {:?}, 0.0] }}]
        [output]
        every = 100
        history = ["block.base"]
        "#,
        YOUNG[0],
        YOUNG[1],
        -force / 2.0
    );
    let run = solve(1, &scene, &[("roller.msh", roller.text()), ("block.msh", block.text())]);
    let case = format!("R {radius}, mu {friction}");
    oracle.close(&format!("reaction of the base, {case}"), run.history().last("block.base.fy"), force / 2.0, 1e-6);
    let pressures = along_x(&run, "contact.strip", &run.scalars(run.written(), "contact.strip", "pressure"));
    let (found, peak) = ellipse(&pressures);
    if friction == 0.0 {
        oracle.within(&format!("half-width b, mm, {case}"), found, b, 0.5 * size);
        oracle.close(&format!("highest pressure p0, MPa, {case}"), peak, highest, 0.03);
    }
    let moved = component(&run.vectors(run.written(), "contact.strip", "displacement"), 1);
    let sunk = mean(&run.points("contact.strip"), &moved, |x| x[0] == 0.0);
    [sunk * scale, found / b - 1.0, peak / highest - 1.0]
}

/// Displacement of B without friction and with mu = 0.1.
const PUBLISHED: [(f64, f64); 2] = [(0.0, -1.3069), (0.1, -1.3011)];

#[test]
fn as_published() {
    let mut oracle = Oracle::new("NAFEMS 1, roller on block");
    for (friction, published) in PUBLISHED {
        let [sunk, ..] = press(&mut oracle, 1.0, friction, 12);
        oracle.close(&format!("u_y of B, mm, mu {friction}"), sunk, published, 0.035);
    }
}

#[test]
fn linearized() {
    let mut oracle = Oracle::new("NAFEMS 1, small strains");
    for (friction, published) in PUBLISHED {
        let [sunk, ..] = press(&mut oracle, 100.0, friction, 24);
        if friction == 0.0 {
            oracle.close("u_y of B, mm, against linear elements", sunk, LINEAR, 3e-3);
        }
        oracle.close(&format!("u_y of B, mm, mu {friction}"), sunk, published, 0.023);
    }
}

#[test]
#[ignore = "extremes: up to 48 elements over the half-width"]
fn finer() {
    let mut oracle = Oracle::new("NAFEMS 1, finer");
    let [coarse, fine] = [12, 48].map(|fine| press(&mut oracle, 100.0, 0.0, fine));
    oracle.close("u_y of B, mm, against linear elements", fine[0], LINEAR, 2e-3);
    oracle.close("u_y of B, mm, mu 0", fine[0], PUBLISHED[0].1, 0.021);
    oracle.close("half-width b over closed form", 1.0 + fine[1], 1.0, 1e-3);
    oracle.close("highest pressure p0 over closed form", 1.0 + fine[2], 1.0, 1e-3);
    assert!(fine[1].abs() < 0.3 * coarse[1].abs() && fine[2].abs() < 0.3 * coarse[2].abs(), "{coarse:?} {fine:?}");
}
