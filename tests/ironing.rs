//! inputs/ironing-rigid.toml against an independent two-dimensional code (bilinear quadrilaterals, the same law and
//! contact conditions, dense Python), which is the same discrete problem: forces must agree to the printed digits.
//!
//! ```text
//!          |  | 10 mm down, then to the right
//!          \__/
//!   ----------------------    mu = 0.3
//!   |       slab         |    300 x 100 x 1 mm, 120 x 30 x 1 elements
//!   //////////////////////
//! ```

mod common;

use common::{Bench, History};
use std::path::Path;

/// (slide in mm, V, H) in N.
type Reference = [(f64, f64, f64); 3];

/// Presses, slides 10 mm in the increments of the scene, and compares forces.
fn check(smoothing: &str, reference: &Reference) -> History {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let bench = Bench::new(&std::fs::read_to_string(inputs.join("ironing-rigid.toml")).unwrap());
    std::fs::copy(inputs.join("ironing-indenter.msh"), bench.path("ironing-indenter.msh")).unwrap();
    let set = format!("tool.indenter.smoothing={smoothing}");
    let short = ["--set", "step.slide.increments=32", "--set", "step.slide.move.0.by=[10.0, 0.0, 0.0]", "--set", &set];
    let run = bench.solve(2, &short);
    let history = run.history();
    for &(slide, v, h) in reference {
        let at = |k: &usize| (history.column("indenter.ux")[*k] - slide).abs() < 1e-9;
        let row = (0..history.len()).rev().find(at).unwrap_or_else(|| panic!("no increment ends at {slide} mm"));
        let (down, along) = (-history.column("indenter.fy")[row], history.column("indenter.fx")[row]);
        assert!((down / v - 1.0).abs() < 1e-7, "{smoothing}, {slide} mm: V = {down}, reference {v}");
        assert!((along / h - 1.0).abs() < 1e-7, "{smoothing}, {slide} mm: H = {along}, reference {h}");
    }
    assert_eq!(run.summary()["cutbacks"], 0);
    history
}

#[test]
fn nagata_patches() {
    let reference =
        [(0.0, 4884.783091, 1057.819235), (2.5, 5184.351072, 1606.191764), (10.0, 5520.232129, 1732.201284)];
    let history = check("nagata", &reference);
    let iterations = history.column("iterations");
    let mean = iterations.iter().sum::<f64>() / iterations.len() as f64;
    assert!(mean < 4.0, "{mean} iterations an increment");
}

#[test]
fn facets() {
    let reference =
        [(0.0, 4837.211176, 1034.159853), (2.5, 5135.262368, 1601.596109), (10.0, 5485.294614, 1770.229514)];
    check("facet", &reference);
}
