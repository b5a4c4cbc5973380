//! The square cup of Numisheet'93, the beginning of the draw on a coarse blank: balance of the blank holder, volume, tools
//! that nothing enters, symmetry, descriptions of the tools, ranks.

mod common;

use common::{Bench, Run, assert_close, assert_small};
use nagata::solid::element::hex8;
use std::collections::HashMap;
use std::path::Path;

const N: usize = 12;
const SIZE: f64 = 75.0;
const THICKNESS: f64 = 0.78;
const STROKE: f64 = 2.0;

/// `inputs/square-cup-small.toml` with a coarser blank and a shorter stroke.
fn solve(ranks: usize, sets: &[&str]) -> Run {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let scene = std::fs::read_to_string(inputs.join("square-cup-small.toml")).unwrap();
    let bench = Bench::new(&scene.replace("\"square-cup-", &format!("\"{}/square-cup-", inputs.display())));
    let elements = format!("body.blank.block.elements=[{N}, {N}, 2]");
    let stroke = format!("step.draw.move.0.by=[0.0, 0.0, {}]", -STROKE);
    let duration = format!("step.draw.duration={STROKE}");
    let mut arguments = vec!["--set", &elements, "--set", &stroke, "--set", &duration, "--set", "output.every=1000"];
    arguments.extend(sets.iter().flat_map(|set| ["--set", set]));
    bench.solve(ranks, &arguments)
}

fn holder_balances(run: &Run) {
    let history = run.history();
    let along = history.column("holder.fz").iter().zip(history.column("time"));
    let worst = along.map(|(f, t)| (f / (-4900.0 * t.min(1.0)) - 1.0).abs()).fold(0.0, f64::max);
    assert_small("force of the holder", worst, 1e-6);
    let sum = |c: &str| ["die", "punch", "holder"].map(|tool| history.last(&format!("{tool}.{c}"))).iter().sum::<f64>();
    assert_small("vertical balance of the tools", sum("fz") / 4900.0, 1e-8);
}

/// Positions of the blank's nodes at the end by their places in the block.
fn positions(run: &Run) -> HashMap<[usize; 3], [f64; 3]> {
    let (points, u) = (run.points("body.blank"), run.vectors(run.written(), "body.blank", "displacement"));
    let steps = [SIZE / N as f64, SIZE / N as f64, THICKNESS / 2.0];
    let place = |p: &[f64; 3]| [0, 1, 2].map(|d| (p[d] / steps[d]).round() as usize);
    points.iter().zip(&u).map(|(p, u)| (place(p), [0, 1, 2].map(|d| p[d] + u[d]))).collect()
}

fn volume(at: &HashMap<[usize; 3], [f64; 3]>) -> f64 {
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let element = |i: usize, j: usize, k: usize| hex8::volume(&corners.map(|[a, b, c]| at[&[i + a, j + b, k + c]]));
    (0..N * N * 2).map(|e| element(e % N, e / N % N, e / (N * N))).sum()
}

/// Distance from the corner's centre in plan, and height.
fn section(x: &[f64; 3]) -> (f64, f64) {
    ((x[0] - 25.0).max(0.0).hypot((x[1] - 25.0).max(0.0)), x[2])
}

/// Distance from the die: flat at z = 0, shoulder 5, plan radius 12.
fn above_die(x: &[f64; 3]) -> f64 {
    let (r, z) = section(x);
    if r >= 17.0 {
        z
    } else if z >= -5.0 {
        (r - 17.0).hypot(z + 5.0) - 5.0
    } else {
        12.0 - r
    }
}

/// Distance from the punch at its end: profile 8, plan radius 10.
fn below_punch(x: &[f64; 3]) -> f64 {
    let (r, z) = section(x);
    let bottom = THICKNESS - STROKE;
    if r <= 2.0 {
        bottom - z
    } else if z <= bottom + 8.0 {
        (r - 2.0).hypot(z - bottom - 8.0) - 8.0
    } else {
        r - 10.0
    }
}

#[test]
fn cup() {
    let exact = solve(2, &["tool.die.smoothing=bezier", "tool.punch.smoothing=bezier", "tool.holder.smoothing=bezier"]);
    holder_balances(&exact);
    let at = positions(&exact);
    assert_close("volume", volume(&at), SIZE * SIZE * THICKNESS, 1e-3);
    let lowest = |k: usize, gap: fn(&[f64; 3]) -> f64| {
        at.iter().filter(|(place, _)| place[2] == k).map(|(_, x)| gap(x)).fold(f64::INFINITY, f64::min)
    };
    assert_small("gap of the die", lowest(0, above_die), 1e-8);
    assert_small("gap of the punch", lowest(2, below_punch), 1e-8);

    // The same with patches.
    let smoothed = solve(2, &[]);
    holder_balances(&smoothed);
    assert_close("volume", volume(&positions(&smoothed)), SIZE * SIZE * THICKNESS, 1e-3);
    let force = |run: &Run| -run.history().last("punch.fz");
    assert_close("punch, Nagata patches", force(&smoothed), force(&exact), 0.02);
}

#[test]
fn isotropic_cup_is_symmetric_and_the_same_on_all_ranks() {
    let isotropic = "material.steel.hill={ f = 0.5, g = 0.5, h = 0.5, n = 1.5 }";
    let runs = [1, 2, 4].map(|ranks| solve(ranks, &[isotropic]));
    let at = positions(&runs[0]);
    let mirrored = |place: &[usize; 3]| at[&[place[1], place[0], place[2]]];
    let lean = |(place, x): (&[usize; 3], &[f64; 3])| {
        let y = mirrored(place);
        (x[0] - y[1]).abs().max((x[1] - y[0]).abs()).max((x[2] - y[2]).abs())
    };
    assert_small("symmetry across the diagonal, mm", at.iter().map(lean).fold(0.0, f64::max), 1e-6);
    for run in &runs[1..] {
        // Iterations may differ by rounding.
        let [more, one] = [run, &runs[0]].map(|run| run.history().without("iterations"));
        assert_small("history on more ranks", more.difference(&one), 1e-6);
    }
}
