//! Curved masters of facets: their edges and corners exactly over nodes of the slave, and facets 100 times as large as those of
//! the slave, or as small.

use crate::case::Case;
use crate::common::msh::{block, surface};
use crate::oracle::{balance, near, same, value};
use crate::scenes::METHODS;

family!(tool_to_and_fro, body_to_and_fro, coarse_and_fine_tools, coarse_and_fine_bodies);

/// How much higher a barrel along y or a dome, with its lowest point at (2, 2), is at a place; of radius 10.
fn rise(shape: &str, x: f64, y: f64) -> f64 {
    let y = if shape == "dome" { y } else { 2.0 };
    ((x - 2.0).powi(2) + (y - 2.0).powi(2)) / 20.0
}

/// A slab of 4 x 4 elements of 1 under a master of facets of 1, that goes to and fro by a facet: nodes are on corners at the ends of
/// all steps.
fn to_and_fro(name: String, master: &str, moved: &str, friction: f64) -> Case {
    let step = |name: &str, n: usize, by: [f64; 3]| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = {n}\nfix = [{{ set = \"b.zmin\" }}]\nmove = [{{ target = \"{moved}\", by = {by:?} }}]\n"
        )
    };
    let case = Case::text(
        name,
        format!(
            "[body.b]\nmaterial = \"m\"\nelement = \"hex8\"\nblock = {{ box = {{ size = [4.0, 4.0, 2.0] }}, elements = [4, 4, 2] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{master}friction = {friction:?}\n{}{}{}{}[output]\nevery = 1000\nhistory = [\"b.zmin\"{}]\n",
            step("press", 2, [0.0, 0.0, -0.2]),
            step("to", 2, [1.0, 0.0, 0.0]),
            step("fro", 4, [-2.0, 0.0, 0.0]),
            step("back", 2, [1.0, 0.0, 0.0]),
            if moved.contains('.') { format!(", \"{moved}\"") } else { String::new() }
        ),
    );
    case.file(
        "t.msh",
        surface(16, |s, t| {
            let (x, y) = (16.0 * t - 6.0, 16.0 * s - 6.0);
            [x, y, 2.0 + rise(if master.contains("dome") { "dome" } else { "barrel" }, x, y)]
        }),
    )
}

/// What symmetry says, to rounding, since a node that is exactly between facets is on all of them, but for two passes without
/// friction, where there may be jumps; and without friction the same force on every way. Where facets meet in a ridge a node on
/// it is on the side that it came from: of them only what holds across. So it is at the small kinks between the patches of a
/// dome, and of what has been deformed.
fn symmetric(case: Case, of: &str, friction: f64, [shape, smoothing, discretization]: [&str; 3]) -> Case {
    let scale = 40.0;
    let rounding = if discretization == "two-pass" && friction == 0.0 { 5e-3 } else { 1e-9 };
    let case = case.oracle(near(&format!("{of}.fy"), 0.0, scale, rounding, "symmetry")).oracle(near(
        &format!("{of}.fx@press"),
        0.0,
        scale,
        rounding,
        "symmetry",
    ));
    // With two passes nodes that yield go on to do so for a while.
    if friction > 0.0 || smoothing == "facet" || discretization == "two-pass" {
        return case;
    }
    let tolerance = match (discretization, shape) {
        ("tool", "dome") => 2e-4,
        ("tool", _) => 1e-6,
        _ => 5e-3,
    };
    case.oracle(near(&format!("{of}.fx"), 0.0, scale, tolerance, "symmetry"))
        .oracle(value(&format!("{of}.fz/{of}.fz@press"), 1.0, tolerance, "no memory"))
        .oracle(value(&format!("{of}.fz@to/{of}.fz@fro"), 1.0, tolerance, "symmetry"))
        .oracle(value(&format!("{of}.fx@to/{of}.fx@fro"), -1.0, tolerance, "symmetry"))
}

fn tool_to_and_fro() -> Vec<Case> {
    let mut cases = Vec::new();
    for shape in ["barrel", "dome"] {
        for smoothing in ["nagata", "facet"] {
            for method in METHODS {
                for friction in [0.0, 0.3] {
                    for ranks in [1, 2, 3, 4] {
                        let tool = format!(
                            "[tool.t]\nmesh = \"t.msh\"\nsmoothing = \"{smoothing}\"\n[contact.c] # a {shape}\nslave = \"b.zmax\"\nmaster = \"t\"\nmethod = \"{method}\"\n"
                        );
                        let of = |ranks: usize| {
                            let name = format!("{shape}, {smoothing}, mu = {friction}, {method}, {ranks} ranks");
                            to_and_fro(name, &tool, "t", friction).ranks(ranks)
                        };
                        let case = symmetric(of(ranks), "t", friction, [shape, smoothing, "tool"])
                            .oracle(balance(&["t", "b.zmin"], 1e-8));
                        let case = if ranks == 1 {
                            case
                        } else {
                            case.oracle(same("t.fx@fro", of(1), 1e-6, "1 rank")).oracle(same(
                                "t.fz",
                                of(1),
                                1e-6,
                                "1 rank",
                            ))
                        };
                        let case = if method == "augmented-lagrangian" { case.must_run() } else { case };
                        cases.push(case.quick_if(
                            method == METHODS[0] && (ranks == 1 || ranks == 3 && friction > 0.0 && shape == "dome"),
                        ));
                    }
                }
            }
        }
    }
    cases
}

/// The same with a body whose lower side is so.
fn body_to_and_fro() -> Vec<Case> {
    let mut cases = Vec::new();
    for shape in ["barrel", "dome"] {
        let mesh = block([8, 8, 1], false, |[x, y, z]| {
            let (x, y) = (8.0 * x - 2.0, 8.0 * y - 2.0);
            let low = 2.0 + rise(shape, x, y);
            [x, y, low + (5.0 - low) * z]
        });
        for discretization in ["one-pass", "two-pass", "segment"] {
            for smoothing in ["nagata", "facet"] {
                for friction in [0.0, 0.02, 0.3, 1.0, 5.0] {
                    // Of frictions beside the usual one the first rank says it for all.
                    let most = if [0.0, 0.3].contains(&friction) { 4 } else { 1 };
                    for ranks in 1..=most {
                        let body = format!(
                            "[body.u]\nmesh = \"u.msh\"\nmaterial = \"n\"\nelement = \"hex8\"\n[material.n]\nmodel = \"neo-hookean\"\nyoung = 1000.0\npoisson = 0.3\n[contact.c] # a {shape}\nslave = \"b.zmax\"\nmaster = \"u.zmin\"\nsmoothing = \"{smoothing}\"\ndiscretization = \"{discretization}\"\n"
                        );
                        let of = |ranks: usize| {
                            let name =
                                format!("{shape}, {discretization}, {smoothing}, mu = {friction}, {ranks} ranks");
                            to_and_fro(name, &body, "u.zmax", friction).file("u.msh", mesh.as_str()).ranks(ranks)
                        };
                        let case = symmetric(of(ranks), "u.zmax", friction, [shape, smoothing, discretization])
                            .oracle(balance(&["u.zmax", "b.zmin"], 1e-8))
                            .limit(300);
                        // Which nodes let go after a jump is not resolved, and need not be like what mirrors them.
                        let case = match (discretization, friction) {
                            ("two-pass", 1.0..) => case.or_warns(&["a jump took its force"]),
                            _ => case,
                        };
                        let case = if ranks == 1 {
                            case
                        } else {
                            case.oracle(same("u.zmax.fx@fro", of(1), 1e-6, "1 rank")).oracle(same(
                                "u.zmax.fz",
                                of(1),
                                1e-6,
                                "1 rank",
                            ))
                        };
                        // Of barrels, where nodes go to and fro over kinks across the way while they are exactly between pieces along it.
                        let is_quick = match (shape, friction) {
                            ("dome", 0.3) => [discretization, smoothing] == ["two-pass", "nagata"],
                            ("barrel", 1.0) => [discretization, smoothing] == ["one-pass", "facet"],
                            _ => false,
                        };
                        cases.push(case.quick_if(is_quick && ranks == 1));
                    }
                }
            }
        }
    }
    cases
}

/// A roller of radius 2 on a slab of 4 x 2 in plane strain; `master` has its description, `moved` is what is pressed by 0.2 and
/// drawn by 0.5.
fn roller(name: String, elements: usize, master: &str, moved: &str, friction: f64) -> Case {
    let step = |name: &str, n: usize, by: [f64; 3]| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = {n}\nfix = [{{ set = \"b.ymin\" }}]\nmove = [{{ target = \"{moved}\", by = {by:?} }}]\n"
        )
    };
    let text = format!(
        "[body.b]\nmaterial = \"m\"\nelement = \"hex8\"\nplane_strain = true\nblock = {{ box = {{ size = [4.0, 2.0, 1.0] }}, elements = [{elements}, 4, 1] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{master}friction = {friction:?}\n{}{}[output]\nevery = 1000\nhistory = [\"b.ymin\"]\n",
        step("press", 2, [0.0, -0.2, 0.0]),
        step("draw", 4, [0.5, 0.0, 0.0])
    );
    // Nearly 400 nodes that stick take minutes.
    Case::text(name, text).limit(if elements > 100 { 900 } else { 300 })
}

/// The exact one.
fn cylinder(elements: usize, friction: f64) -> Case {
    let tool = "[tool.t]\ncylinder = { point = [2.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }\n[contact.c]\nslave = \"b.ymax\"\nmaster = \"t\"\n";
    roller("a cylinder".into(), elements, tool, "t", friction)
}

/// Slaves of elements of 0.25 under facets of 0.0025, and of 0.009 under facets of 0.9.
const SIZES: [(usize, usize, f64); 2] = [(16, 1117, 1e-3), (430, 3, 1e-2)];

fn coarse_and_fine_tools() -> Vec<Case> {
    let mut cases = Vec::new();
    for (elements, facets, tolerance) in SIZES {
        // The outside of an arc of 80 degrees.
        let mesh = block([facets, 1, 1], false, |[s, t, h]| {
            let angle = (80.0 * s - 40.0).to_radians();
            let radius = 2.0 - 0.5 * t;
            [2.0 + radius * angle.sin(), 4.0 - radius * angle.cos(), 2.0 * h - 0.5]
        });
        for method in METHODS {
            for friction in [0.0, 0.3, 5.0] {
                let tool = format!(
                    "[tool.t]\nmesh = \"t.msh\"\ngroup = \"ymin\"\nnormals = \"cylinder\"\nsmoothing = \"nagata\"\ncylinder = {{ point = [2.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }}\n[contact.c]\nslave = \"b.ymax\"\nmaster = \"t\"\nmethod = \"{method}\"\n"
                );
                let exact = cylinder(elements, friction).set(format!("contact.c.method={method}"));
                let name = format!("{elements} elements under {facets} facets, mu = {friction}, {method}");
                let case = roller(name, elements, &tool, "t", friction)
                    .file("t.msh", mesh.as_str())
                    .oracle(same("t.fx", exact.clone(), tolerance, "a cylinder"))
                    .oracle(same("t.fy", exact, tolerance, "a cylinder"))
                    .oracle(balance(&["t", "b.ymin"], 1e-8));
                cases.push(case.quick_if(elements == 16 && method == METHODS[0] && friction == 0.3));
            }
        }
    }
    cases
}

fn coarse_and_fine_bodies() -> Vec<Case> {
    let mut cases = Vec::new();
    for (elements, facets, tolerance) in SIZES {
        for discretization in ["one-pass", "two-pass", "segment"] {
            for friction in [0.0, 0.3, 5.0] {
                // So stiff that it is as good as rigid.
                let body = format!(
                    "[body.u]\nmaterial = \"n\"\nelement = \"hex8\"\nplane_strain = true\nblock = {{ sector = {{ center = [2.0, 4.0, 0.0], radii = [1.5, 2.0], angles = [230.0, 310.0], length = 1.0 }}, elements = [1, {facets}, 1] }}\n[material.n]\nmodel = \"neo-hookean\"\nyoung = 1e7\npoisson = 0.3\n[contact.c]\nslave = \"b.ymax\"\nmaster = \"u.rmax\"\ndiscretization = \"{discretization}\"\n"
                );
                // Nodes of the fine master that press between those of the slave make more of it.
                let tolerance = if discretization == "one-pass" { tolerance } else { 5e-2 };
                let name = format!("{elements} elements under {facets} facets, mu = {friction}, {discretization}");
                let case = roller(name, elements, &body, "u", friction).oracle(same(
                    "b.ymin.fy",
                    cylinder(elements, friction),
                    tolerance,
                    "a cylinder",
                ));
                // Without friction there is next to none of it.
                let along = same("b.ymin.fx", cylinder(elements, friction), tolerance, "a cylinder");
                cases.push(if friction > 0.0 { case.oracle(along) } else { case }.slow());
            }
        }
    }
    cases
}
