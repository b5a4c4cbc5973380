//! Wedges, solid-shells and tetrahedra: bars in which every element is strained alike.

use crate::bars::bar;
use crate::case::Case;

family!(poisson, aspect_ratios);

const ELEMENTS: [&str; 4] = ["wedge6", "wedge6-sri", "hex8-shell", "tet4"];

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
                let n = if element.starts_with("tet10") { [1, 1, 1] } else { [2, 2, 1] };
                let case = bar(name, element, n, size);
                let case = if aspect <= 1e3 { case.must_run() } else { case };
                // A refusal takes mpirun some seconds.
                cases.push(case.quick_if(aspect == 1e3 || aspect == 1e4 && shape == "high"));
            }
        }
    }
    cases
}
