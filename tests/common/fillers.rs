//! Scenes of what fills in between hexahedra.

use super::{Bench, History, Run, assert_small, msh, nagata};
use std::f64::consts::PI;
use std::fmt::Write;

const YOUNG: f64 = 100.0;
const PRESSURE: f64 = 0.01;

/// The unit cube as a quarter of a tube of radii 1 and 2, of length 0.2 from z = `at`.
pub fn in_tube(at: f64, [r, t, z]: [f64; 3]) -> [f64; 3] {
    let (sine, cosine) = (0.5 * PI * t).sin_cos();
    [(1.0 + r) * cosine, (1.0 + r) * sine, at + 0.2 * z].map(|x| if x.abs() < 1e-12 { 0.0 } else { x })
}

/// Errors (rms) of the displacements of such tubes, each with its mesh, in plane strain under inner pressure, where
/// `u(r) = (1 + nu) p / 3E ((1 - 2 nu) r + 4 / r)`; and the log.
pub fn tubes(element: &str, poisson: f64, meshes: &[(String, String)]) -> (Vec<f64>, String) {
    let mut scene = format!("[material.m]\nmodel = \"hooke\"\nyoung = {YOUNG:?}\npoisson = {poisson:?}\n");
    let (mut fix, mut pressure) = (String::new(), String::new());
    for (body, _) in meshes {
        let _ = writeln!(scene, "[body.{body}]\nmesh = \"{body}.msh\"\nmaterial = \"m\"\nelement = \"{element}\"");
        for (side, axis) in [("ymin", "y"), ("ymax", "x"), ("zmin", "z"), ("zmax", "z")] {
            let _ = write!(fix, "{{ set = \"{body}.{side}\", directions = \"{axis}\" }}, ");
        }
        let _ = write!(pressure, "{{ set = \"{body}.xmin\", value = {PRESSURE:?} }}, ");
    }
    let bench = Bench::new(&format!("{scene}[[step]]\nincrements = 1\nfix = [{fix}]\npressure = [{pressure}]\n"));
    meshes.iter().for_each(|(body, mesh)| bench.write(&format!("{body}.msh"), mesh));
    let run = bench.solve(2, &[]);
    let error = |(body, _): &(String, String)| {
        let grid = format!("body.{body}");
        let (points, moved) = (run.points(&grid), run.vectors(1, &grid, "displacement"));
        let off = |(x, u): (&[f64; 3], &[f64; 3])| {
            let r = x[0].hypot(x[1]);
            let exact = (1.0 + poisson) * PRESSURE / (3.0 * YOUNG) * ((1.0 - 2.0 * poisson) * r + 4.0 / r);
            ((x[0] * u[0] + x[1] * u[1]) / r / exact - 1.0).powi(2)
        };
        (points.iter().zip(&moved).map(off).sum::<f64>() / points.len() as f64).sqrt()
    };
    let found: Vec<f64> = meshes.iter().map(error).collect();
    println!("{element}, {poisson}: {found:?}");
    (found, run.log())
}

/// Two blocks of unlike meshes on each other between smooth walls, of so many hexahedra along a side, distorted within the seam by `most`,
/// which `fill` makes those with fillers: of the text of a mesh, its number of hexahedra, and 0 below, 1 above.
pub fn blocks(
    joint: &str,
    [lower, upper]: [usize; 2],
    most: f64,
    fill: impl Fn(&str, usize, usize) -> String,
) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.lower]
        mesh = "lower.msh"
        material = "soft"
        [body.upper]
        mesh = "upper.msh"
        material = "soft"
        element = "hex8-sri"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        {joint}
        [[step]]
        increments = 2
        fix = [
            {{ set = "lower.zmin", directions = "z" }},
            {{ set = "lower.xmin", directions = "x" }}, {{ set = "lower.xmax", directions = "x" }},
            {{ set = "upper.xmin", directions = "x" }}, {{ set = "upper.xmax", directions = "x" }},
            {{ set = "lower.ymin", directions = "y" }}, {{ set = "lower.ymax", directions = "y" }},
            {{ set = "upper.ymin", directions = "y" }}, {{ set = "upper.ymax", directions = "y" }},
        ]
        move = [{{ target = "upper.zmax", by = [0.0, 0.0, -1.0], directions = "z" }}]
        "#
    ));
    let askew = |s: f64, t: f64| s + most * (PI * s).sin() * (2.0 * PI * t).sin();
    for (name, n, from, odd) in [("lower", lower, 0.0, 0), ("upper", upper, 10.0, 1)] {
        let place = |[s, t, r]: [f64; 3]| [10.0 * askew(s, t), 10.0 * askew(t, s), from + 10.0 * r];
        let mesh = msh::block([n, n, 2], false, place);
        bench.write(&format!("{name}.msh"), &fill(&mesh, n, odd));
    }
    bench
}

/// They are strained alike all over, and along z alone.
pub fn assert_even(what: &str, run: &Run, tolerance: f64) {
    for grid in ["body.lower", "body.upper"] {
        let moved = run.vectors(run.written(), grid, "displacement");
        let off = |(x, u): (&[f64; 3], &[f64; 3])| u[0].abs().max(u[1].abs()).max((u[2] + 0.05 * x[2]).abs());
        let most = run.points(grid).iter().zip(&moved).map(off).fold(0.0, f64::max);
        assert_small(&format!("{what}, {grid}"), most, tolerance);
    }
}

/// On two ranks, and begun on two and restarted on one after the first step, a scene has the same history. Rounding decides on the
/// last iteration.
pub fn assert_same_on_ranks_and_restarted(bench: &Bench, history: &History) {
    let same = |what: &str, other: History| assert_small(what, other.without("iterations").difference(history), 1e-8);
    same("two ranks", bench.solve(2, &[]).history());
    let first = bench.solve(2, &["--steps", "1"]);
    let (scene, out) = (bench.path("scene.toml"), first.out.to_str().unwrap());
    let arguments = ["run", scene.to_str().unwrap(), "--out", out, "--restart"];
    let on = nagata(&bench.path(""), 1, &arguments, first.out.clone());
    assert_eq!(on.code, 0, "{}", on.stderr);
    same("restarted", on.history());
}
