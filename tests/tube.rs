//! A thin-walled tube buckles in plastic flow, folds up, and its fold closes.

mod common;

use common::{Bench, assert_small};

const RADIUS: f64 = 20.0;

/// The scene of `inputs/` with 4 elements around a quarter, crushed by so much in increments of 0.1 mm.
fn crushed(by: f64) -> (Bench, Vec<String>) {
    let folder = env!("CARGO_MANIFEST_DIR");
    let bench = Bench::new(&std::fs::read_to_string(format!("{folder}/inputs/tube-buckling.toml")).unwrap());
    let keys = [
        "body.tube.block.elements=[1, 4, 30]".to_string(),
        format!("step.crush.duration={by:.1}"),
        "step.crush.increment={ initial = 0.01, min = 1e-5, max = 0.1 }".to_string(),
        format!("step.crush.move.0={{ target = \"tube.zmax\", by = [0.0, 0.0, -{by:.1}], directions = \"z\" }}"),
    ];
    (bench, keys.into_iter().flat_map(|key| ["--set".to_string(), key]).collect())
}

/// Without an imperfection: the held end alone starts the fold.
#[test]
fn a_tube_folds_until_the_fold_meets_itself() {
    let (bench, keys) = crushed(10.0);
    let run = bench.solve(1, &keys.iter().map(String::as_str).collect::<Vec<_>>());
    let history = run.history();
    let squash = 2.0 * std::f64::consts::PI * RADIUS * 240.0;
    let force: Vec<f64> = history.column("tube.zmax.fz").iter().map(|f| -4.0 * f).collect();
    let active = history.column("inner.active");
    let touch = active.iter().position(|n| *n > 0.0).expect("the fold closes");
    let peak = force[..touch].iter().copied().fold(0.0, f64::max);
    assert!((0.9..1.15).contains(&(peak / squash)), "first peak over the squash load: {}", peak / squash);
    assert!(force[touch - 1] < 0.4 * peak, "the drop ends at {} of the peak", force[touch - 1] / peak);
    assert!(force[history.len() - 1] > 1.5 * force[touch - 1], "no reversal");

    for contact in ["inner", "outer", "inner-on-plane", "outer-on-plane"] {
        let deepest = history.column(&format!("{contact}.max_penetration")).iter().copied().fold(0.0, f64::max);
        // What is left of the slack of self-contact once it has been taken back.
        assert_small(&format!("{contact}: penetration over the thickness"), deepest, 2e-6);
    }
    check_energy(&history, touch);
    check_circles(&run, touch);
}

/// From the peak to the first touch, work is what is stored and what flow has taken.
fn check_energy(history: &common::History, touch: usize) {
    let shortening = history.column("tube.zmax.uz");
    let force = history.column("tube.zmax.fz");
    let energy = |k: usize| history.column("tube.elastic_energy")[k] + history.column("tube.plastic_work")[k];
    let first = shortening.iter().position(|u| *u < -0.5).unwrap();
    let part = |k: usize| 0.5 * (force[k] + force[k + 1]) * (shortening[k + 1] - shortening[k]);
    let work: f64 = (first..touch - 1).map(part).sum();
    assert_small("energy", (energy(touch - 1) - energy(first)) / work - 1.0, 5e-3);
}

/// Until the first touch, nodes that began on a circle are on one.
fn check_circles(run: &common::Run, touch: usize) {
    let nodes = run.points("body.tube");
    let written = (touch - 1) / 10;
    let moved = run.vectors(written, "body.tube", "displacement");
    let radius = |x: &[f64; 3]| x[0].hypot(x[1]);
    for (x, u) in nodes.iter().zip(&moved).filter(|(x, _)| x[1].abs() < 1e-9) {
        let first = radius(&[x[0] + u[0], x[1] + u[1], 0.0]);
        let on_circle = |y: &[f64; 3]| (radius(y) - radius(x)).abs() < 1e-6 && (y[2] - x[2]).abs() < 1e-6;
        for (y, v) in nodes.iter().zip(&moved).filter(|(y, _)| on_circle(y)) {
            assert_small("off the circle", (radius(&[y[0] + v[0], y[1] + v[1], 0.0]) - first) / RADIUS, 1e-6);
        }
    }
}

#[test]
fn the_number_of_ranks_does_not_matter() {
    let (bench, keys) = crushed(1.0);
    let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
    let alone = bench.solve(1, &keys).history();
    assert_small("2 ranks", alone.difference(&bench.solve(2, &keys).history()), 1e-6);
}
