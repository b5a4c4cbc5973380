//! Bars of Mooney-Rivlin's, Yeoh's and Ogden's materials against closed forms.

mod common;

use common::{Bench, assert_close, nagata, root};
use std::fmt::Write;

const BULK: f64 = 500.0;
const LAWS: [(&str, &str); 3] = [
    ("mooney", "model = \"mooney-rivlin\", c10 = 0.4, c01 = 0.1, bulk = 500"),
    ("yeoh", "model = \"yeoh\", c10 = 0.5, c20 = -0.01, c30 = 0.002, d = 0.004"),
    ("ogden", "model = \"ogden\", terms = [[0.63, 1.3], [0.0012, 5], [-0.01, -2]], bulk = 500"),
];
/// By default as nearly incompressible materials have it, others, and in plane strain.
const ELEMENTS: [(&str, &str); 5] = [
    ("fbar", ""),
    ("sri", "element = \"hex8-sri\", "),
    ("eas", "element = \"hex8-eas\", "),
    ("plane", "plane_strain = true, "),
    ("flat", "plane_strain = true, element = \"hex8-sri\", "),
];

/// Principal Kirchhoff stresses at principal stretches.
fn kirchhoff(law: &str, stretches: [f64; 3]) -> [f64; 3] {
    let j: f64 = stretches.iter().product();
    let isochoric = stretches.map(|s| s / j.cbrt());
    let squares = isochoric.map(|s| s * s);
    let first: f64 = squares.iter().sum();
    let stress = |s: f64| match law {
        "mooney" => 2.0 * (0.4 + 0.1 * first) * s * s - 0.2 * s.powi(4),
        "yeoh" => 2.0 * (0.5 - 0.02 * (first - 3.0) + 0.006 * (first - 3.0).powi(2)) * s * s,
        _ => [(0.63, 1.3), (0.0012, 5.0), (-0.01, -2.0)].iter().map(|(mu, a)| 2.0 * mu / a * s.powf(*a)).sum(),
    };
    let all = isochoric.map(stress);
    let mean = all.iter().sum::<f64>() / 3.0;
    all.map(|t| t - mean + BULK * j * (j - 1.0))
}

/// ```text
///     |=========| ->      Rollers on three sides, the others free, along z held in plane strain: the lateral stretch t leaves
///     |_________|         no stress there, and the pull is tau(s)/s on the area.
/// ```
#[test]
fn bars_that_are_pulled_and_pressed() {
    let mut scene = String::new();
    let (mut fix, mut by) = (Vec::new(), Vec::new());
    for (law, card) in LAWS {
        let _ = writeln!(scene, "material.{law} = {{ {card} }}");
        for (element, keys) in ELEMENTS {
            let layers = if keys.contains("plane_strain") { 1 } else { 2 };
            let block = format!("block = {{ box = {{ size = [2, 1, 1] }}, elements = [2, 2, {layers}] }}");
            let _ = writeln!(scene, "body.{law}-{element} = {{ material = \"{law}\", {keys}{block} }}");
            for (side, direction) in [("xmin", "x"), ("ymin", "y"), ("zmin", "z")] {
                fix.push(format!("{{ set = \"{law}-{element}.{side}\", directions = \"{direction}\" }}"));
            }
            by.push(format!("{{ target = \"{law}-{element}.xmax\", by = [BY, 0, 0], directions = \"x\" }}"));
        }
    }
    let sets = LAWS.iter().flat_map(|(law, _)| ELEMENTS.map(|(element, _)| format!("\"{law}-{element}.xmax\"")));
    let _ = writeln!(scene, "output.history = [{}]", sets.collect::<Vec<_>>().join(", "));
    for (name, stretch, by_x) in [("pull", 1.6, 1.2), ("press", 0.7, -1.8)] {
        let moved = by.join(", ").replace("BY", &format!("{by_x:?}"));
        let _ = writeln!(scene, "[[step]]\nname = \"{name}\" # to {stretch}\nincrements = 4");
        let _ = writeln!(scene, "fix = [{}]\nmove = [{moved}]", fix.join(", "));
    }
    let bench = Bench::new(&scene);
    let said = nagata(&bench.path(""), 1, &["check", "scene.toml"], bench.path("")).stdout;
    assert!(said.contains("body `mooney-fbar`: hex8-fbar, mooney-rivlin"), "{said}");
    let history = bench.solve(2, &[]).history();
    for (row, stretch) in [(3, 1.6), (7, 0.7)] {
        for (law, _) in LAWS {
            for (element, keys) in ELEMENTS {
                let plane = keys.contains("plane_strain");
                let all = |t: f64| [stretch, t, if plane { 1.0 } else { t }];
                let t = root(0.3, 3.0, |t| kirchhoff(law, all(t))[1]);
                let column = format!("{law}-{element}.xmax.fx");
                let pull = kirchhoff(law, all(t))[0] / stretch;
                assert_close(&format!("{column} at {stretch}"), history.column(&column)[row], pull, 1e-8);
            }
        }
    }
}
