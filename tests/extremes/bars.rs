//! Bars of tetrahedra of second order.

use crate::case::Case;
use crate::common::msh::{block, second_order, wedges};
use crate::oracle::{balance, value};
use crate::scenes::{BAR, METHODS, STACK, bar_force, stack_force};

family!(poisson, aspect_ratios, penalties, on_each_other);

const ELEMENTS: [&str; 2] = ["tet10", "tet10-sri"];

/// A bar of `n` cells of a size, in elements of any kind, that is shortened by a fifth of its height.
pub fn bar(name: String, element: &str, n: [usize; 3], size: [f64; 3]) -> Case {
    let of = |cut: bool| block(n, cut, |p| [0, 1, 2].map(|d| size[d] * p[d]));
    let (mesh, shell) = match element {
        "tet4" => (of(true), ""),
        "tet10" | "tet10-sri" => (second_order(&of(true)), ""),
        "hex8-shell" => (of(false), "shell = { face = \"zmax\" }\n"),
        _ => (wedges(&of(false), |_| true), ""),
    };
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

fn poisson() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ELEMENTS {
        for nu in ["-0.99", "0.0", "0.4999", "0.499999", "0.499999999", "0.499999999999"] {
            let case = bar(format!("nu = {nu}, {element}"), element, [1, 1, 1], [2.0; 3]);
            let case = if nu.len() < 7 { case.must_run() } else { case };
            cases.push(case.set(format!("material.m.poisson={nu}")).quick_if(nu == "0.499999"));
        }
    }
    cases
}

fn aspect_ratios() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ELEMENTS {
        for aspect in [1e2, 1e4, 1e-2, 1e-4] {
            let name = format!("height over width {aspect:e}, {element}");
            cases.push(bar(name, element, [1, 1, 1], [2.0, 2.0, 2.0 * aspect]).slow());
        }
    }
    cases
}

fn penalties() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in &METHODS[..3] {
        for power in [-6, -3, 3, 6, 9, 12, 15] {
            let case = bar(format!("1e{power} times 2, {method}"), "tet10", [2, 2, 2], [2.0; 3])
                .set(format!("contact.c.method={method}"))
                .set(format!("contact.c.penalty={:?}", 2.0 * 10f64.powi(power)));
            cases.push(case.slow());
        }
    }
    cases
}

/// Like meshes pass an even pressure, unlike ones one that is even but for what nodes of the master between them do.
fn on_each_other() -> Vec<Case> {
    let cube =
        |n: usize, low: f64| second_order(&block([n, n, 1], true, |[x, y, z]| [2.0 * x, 2.0 * y, low + 2.0 * z]));
    let bodies = [("lower", "size = [2.0, 2.0, 2.0]"), ("upper", "origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, 2.0]")];
    let scene = bodies.iter().fold(STACK.to_string(), |scene, (name, size)| {
        scene.replace(
            &format!("block = {{ box = {{ {size} }}, elements = [2, 2, 2] }}"),
            &format!("mesh = \"{name}.msh\""),
        )
    });
    let scene = scene.replace("element = \"hex8\"\n", "element = \"tet10\"\n");
    let mut cases = Vec::new();
    let mut of = |(lower, upper): (usize, usize), ratio: f64, discretization: &str, tolerance: f64| {
        let force = stack_force(100.0, 100.0 * ratio, 0.3, 0.2);
        let case =
            Case::text(format!("{lower} on {upper}, upper {ratio:e} times lower, {discretization}"), scene.as_str())
                .file("lower.msh", cube(lower, 0.0))
                .file("upper.msh", cube(upper, 2.0))
                .set(format!("material.b.young={:?}", 100.0 * ratio))
                .set(format!("contact.c.discretization={discretization}"))
                .oracle(value("upper.zmax.fz", force, tolerance, "closed form"))
                .oracle(value("upper.zmax.fz/lower.zmin.fz", -1.0, 1e-6, "balance"));
        cases.push(case.quick_if(lower == 1 && ratio == 1.0));
    };
    for ratio in [1e-6, 1.0, 1e6] {
        for (meshes, tolerance) in [((1, 1), 1e-6), ((2, 2), 1e-6), ((8, 1), 1e-2), ((8, 3), 1e-2)] {
            of(meshes, ratio, "one-pass", tolerance);
        }
        for meshes in [(1, 1), (8, 1), (8, 3), (3, 8)] {
            of(meshes, ratio, "segment", 1e-6);
        }
    }
    cases
}
