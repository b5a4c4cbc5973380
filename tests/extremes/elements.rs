//! Wedges, solid-shells and tetrahedra: bars in which every element is strained alike.

use crate::case::Case;
use crate::common::msh::{block, wedges};
use crate::oracle::{balance, value};
use crate::scenes::{BAR, bar_force};

family!(poisson, aspect_ratios);

const ELEMENTS: [&str; 4] = ["wedge6", "wedge6-sri", "hex8-shell", "tet4"];

/// A bar of `n` cells of a size that is shortened by a fifth of its height.
fn bar(name: String, element: &str, n: [usize; 3], size: [f64; 3]) -> Case {
    let place = |p: [f64; 3]| [0, 1, 2].map(|d| size[d] * p[d]);
    let mesh = match element {
        "tet4" => block(n, true, place),
        "hex8-shell" => block(n, false, place),
        _ => wedges(&block(n, false, place), |_| true),
    };
    let shell = if element == "hex8-shell" { "shell = { face = \"zmax\" }\n" } else { "" };
    let scene = BAR
        .replace(
            "block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }",
            &format!("mesh = \"b.msh\"\n{shell}"),
        )
        .replace("point = [0.0, 0.0, 2.0]", &format!("point = [0.0, 0.0, {:?}]", size[2]))
        .replace("-0.4]", &format!("{:?}]", -0.2 * size[2]));
    Case::text(name, scene)
        .file("b.msh", mesh)
        .set(format!("body.b.element={element}"))
        .oracle(value("p.fz", bar_force(10.0, size[0] * size[1], 0.8), 1e-6, "closed form"))
        .oracle(balance(&["p", "b.zmin"], 1e-6))
}

/// Free sides: the force does not depend on nu.
fn poisson() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ELEMENTS {
        for nu in ["-0.99", "-0.9", "-0.5", "0.0", "0.3", "0.49", "0.499", "0.4999"] {
            let case = bar(format!("nu = {nu}, {element}"), element, [2, 2, 1], [2.0, 2.0, 0.5]);
            let case = case.set(format!("material.m.poisson={nu}"));
            cases.push(match (element, nu) {
                ("hex8-shell", "-0.99") => case.must_be_refused(&["enhanced strain buckle"]),
                _ => case.must_run(),
            });
        }
    }
    cases
}

/// Needles and sheets, that stand and lie; of solid-shells sheets alone.
fn aspect_ratios() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["wedge6", "wedge6-sri", "hex8-shell", "tet4", "tet10", "tet10-sri"] {
        for aspect in [1e1, 1e2, 1e3, 1e4] {
            for (shape, size) in [
                ("high", [2.0, 2.0, 2.0 * aspect]),
                ("flat", [2.0, 2.0, 2.0 / aspect]),
                ("long", [2.0 * aspect, 2.0, 2.0]),
                ("narrow", [2.0 / aspect, 2.0, 2.0]),
            ] {
                if element == "hex8-shell" && shape != "flat" {
                    continue;
                }
                let name = format!("{shape} by {aspect:e}, {element}");
                let case = if element.starts_with("tet10") {
                    crate::bars::bar(name, element, [1, 1, 1], size)
                } else {
                    bar(name, element, [2, 2, 1], size)
                };
                let case = if aspect <= 1e3 { case.must_run() } else { case };
                // A refusal takes mpirun some seconds.
                cases.push(case.quick_if(aspect == 1e3 || aspect == 1e4 && shape == "high"));
            }
        }
    }
    cases
}
