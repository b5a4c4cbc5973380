//! Nodes on edges, vertices and corners, and on several tools.

use crate::case::Case;
use crate::oracle::{balance, coulomb, near, same, scaled, value};
use crate::scenes::{BAR, METHODS, SLAB, plate};

family!(
    to_and_fro,
    node_on_two_tools,
    node_on_three_tools,
    into_a_corner,
    coincident_tools,
    trench,
    across_an_edge,
    closed_platens,
    past_a_platen,
    off_a_body
);

/// A slab is drawn over a grid of facets by whole facets and back: its nodes begin, turn and end on vertices.
fn to_and_fro() -> Vec<Case> {
    let steps = "[[step]]\nname = \"back\"\nincrements = 4\nfix = [{ set = \"b.zmin\" }]\nmove = [{ target = \"t\", by = [-2.0, 0.0, 0.0] }]\n[output]";
    let scene = SLAB
        .replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", "mesh = \"tool.msh\"")
        .replace("by = [0.5, 0.0, 0.0]", "by = [2.0, 0.0, 0.0]")
        .replace("friction = 0.3", "friction = 0.05")
        .replace("[output]", steps);
    let flat = SLAB
        .replace("by = [0.5, 0.0, 0.0]", "by = [2.0, 0.0, 0.0]")
        .replace("friction = 0.3", "friction = 0.05")
        .replace("[output]", steps);
    let tool = plate(16, 8.0, 2.0, false);
    let mut cases = Vec::new();
    for method in METHODS {
        for smoothing in ["nagata", "facet"] {
            for ranks in [1, 2, 3, 4] {
                let case = Case::text(format!("{method}, {smoothing}, {ranks} ranks"), scene.as_str())
                    .file("tool.msh", tool.as_str())
                    .set(format!("contact.c.method={method}"))
                    .set(format!("tool.t.smoothing={smoothing}"))
                    .ranks(ranks)
                    .oracle(value("t.fx@draw/t.fz@draw", -0.05, 1e-6, "Coulomb"))
                    .oracle(value("t.fx/t.fz", 0.05, 1e-6, "Coulomb"))
                    .oracle(same(
                        "t.fz",
                        Case::text("flat", flat.as_str()).set(format!("contact.c.method={method}")),
                        1e-6,
                        "a plane",
                    ))
                    .must_run();
                cases.push(case.quick_if(method == METHODS[0] && ranks % 3 != 0));
            }
        }
    }
    // Bodies on each other with the same grid, drawn by one facet and back.
    for ranks in [1, 2, 3, 4] {
        for discretization in ["one-pass", "two-pass"] {
            let (_, head) = SLAB.split_once("[body.b]").unwrap();
            let head = head.split_once("[tool.t]").unwrap().0;
            let upper = "[body.u]\nmaterial = \"m\"\nelement = \"hex8\"\nblock = { box = { origin = [-2.0, -2.0, 2.0], size = [8.0, 8.0, 2.0] }, elements = [8, 8, 2] }\n";
            let step = |name: &str, by: &str| {
                format!(
                    "[[step]]\nname = \"{name}\"\nincrements = 4\nfix = [{{ set = \"b.zmin\" }}]\nmove = [{{ target = \"u.zmax\", by = {by} }}]\n"
                )
            };
            let text = format!(
                "[body.b]{head}{upper}[contact.c]\nslave = \"b.zmax\"\nmaster = \"u.zmin\"\nfriction = 0.05\ndiscretization = \"{discretization}\"\n{}{}{}[output]\nevery = 1000\nhistory = [\"b.zmin\", \"u.zmax\"]\n",
                step("press", "[0.0, 0.0, -0.1]"),
                step("draw", "[1.0, 0.0, 0.0]"),
                step("back", "[-1.0, 0.0, 0.0]")
            );
            let one = Case::text("1 rank", text.as_str());
            let case = Case::text(format!("two bodies, {discretization}, {ranks} ranks"), text)
                .ranks(ranks)
                // The lower body dents the upper one: normals at its rim lean.
                .oracle(value("b.zmin.fx@draw/b.zmin.fz@draw", -0.05, 5e-2, "Coulomb"))
                .oracle(same("u.zmax.fz", one, 1e-6, "1 rank"))
                .oracle(balance(&["b.zmin", "u.zmax"], 1e-6));
            cases.push(case.slow());
        }
    }
    cases
}

/// The quarter of a bar that is also kept from getting thicker along x by a wall, with friction at the plate and at the wall.
fn beside_a_wall([plate, wall]: [f64; 2], method: &str) -> String {
    BAR.replace("symmetry = [\"xmin\", \"ymin\", \"zmin\"]", "symmetry = [\"xmin\", \"zmin\"]")
        .replace("model = \"hooke\"\nyoung = 10.0", "model = \"neo-hookean\"\nyoung = 100.0")
        .replace("size = [2.0, 2.0, 2.0]", "size = [4.0, 4.0, 2.0]")
        .replace("[contact.c]", &format!("[tool.wx]\nplane = {{ point = [4.0, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }}\n[contact.cx]\nslave = \"b.xmax\"\nmaster = \"wx\"\nfriction = {wall:?}\nmethod = \"{method}\"\n[contact.c]\nfriction = {plate:?}\nmethod = \"{method}\""))
        .replace("increments = 2\n", "increments = 2\nfix = [{ set = \"b.ymin\", directions = \"y\" }]\n")
        .replace("by = [0.0, 0.0, -0.4]", "by = [0.0, 0.0, -0.2]")
        .replace("[\"b.zmin\", \"b.zmax\"]", "[\"b\", \"b.xmax\", \"b.zmax\"]")
}

/// All four quarters of it, between two plates and two walls, which nothing else holds along x and z.
fn between_walls(friction: f64) -> Case {
    let tools = [("p", "z", 2.0, 2), ("q", "z", -2.0, 2), ("wx", "x", 4.0, 0), ("wl", "x", -4.0, 0)];
    let mut text = String::new();
    for (name, letter, at, axis) in tools {
        let along = |s: f64| [0, 1, 2].map(|c| if c == axis { s } else { 0.0 });
        let side = if at > 0.0 { "max" } else { "min" };
        text += &format!(
            "[tool.{name}]\nplane = {{ point = {:?}, normal = {:?} }}\n[contact.c{name}]\nslave = \"b.{letter}{side}\"\nmaster = \"{name}\"\nfriction = {friction:?}\n",
            along(at),
            along(-at.signum())
        );
    }
    Case::text(
        "whole",
        format!(
            "[body.b]\nmaterial = \"m\"\nelement = \"hex8\"\nblock = {{ box = {{ origin = [-4.0, 0.0, -2.0], size = [8.0, 4.0, 4.0] }}, elements = [4, 2, 4] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{text}[[step]]\nincrements = 2\nfix = [{{ set = \"b.ymin\", directions = \"y\" }}]\nmove = [{{ target = \"p\", by = [0.0, 0.0, -0.2] }}, {{ target = \"q\", by = [0.0, 0.0, 0.2] }}]\n[output]\nevery = 1000\n"
        ),
    )
}

/// A row of nodes is on the plate and on the wall. Without friction stresses are even; a smooth tool is a support; and what
/// rubs at both is a quarter of a whole that is held by contact alone.
fn node_on_two_tools() -> Vec<Case> {
    // tau = mu (l^2 - 1) + lambda ln J of each stretch l: 1 along x, 0.9 along z, and free along y.
    let (shear, lambda, l) = (100.0 / 2.6, 30.0 / (1.3 * 0.4), 0.9f64);
    let wide = crate::common::root(1.0, 1.2, |t| shear * (t * t - 1.0) + lambda * (l * t).ln());
    let across = lambda * (l * wide).ln();
    let down = 16.0 * (shear * (l * l - 1.0) + across) / l;
    let mut cases = Vec::new();
    for method in METHODS {
        let tolerance = if method == "penalty" { 0.1 } else { 1e-6 };
        let of = |name: &str, frictions: [f64; 2]| {
            Case::text(format!("{name}, {method}"), beside_a_wall(frictions, method))
                .oracle(balance(&["p", "wx", "b"], 1e-8))
                .oracle(coulomb("p", 2, frictions[0]))
                .oracle(coulomb("wx", 0, frictions[1]))
        };
        let smooth = of("friction 0", [0.0; 2]);
        let smooth = smooth.oracle(value("p.fz", down, tolerance, "closed form"));
        let smooth = smooth.oracle(value("wx.fx", 8.0 * across, tolerance, "closed form"));
        cases.push(if method == "penalty" { smooth } else { smooth.must_run() });
        for (name, frictions) in [("the plate rubs", [0.3, 0.0]), ("the wall rubs", [0.0, 0.3])] {
            let text = beside_a_wall(frictions, method);
            let (quantities, held) = if frictions[1] == 0.0 {
                let held = text.replace("point = [4.0, 0.0, 0.0]", "point = [9.0, 0.0, 0.0]");
                let fix = "fix = [{ set = \"b.xmax\", directions = \"x\" }, ";
                (["p.fz", "b.fy"], held.replace("fix = [", fix))
            } else {
                let held = text.replace("point = [0.0, 0.0, 2.0]", "point = [0.0, 0.0, 9.0]");
                let moved = "{ target = \"b.zmax\", directions = \"z\", by";
                (["wx.fx", "wx.fz"], held.replace("{ target = \"p\", by", moved))
            };
            let held = Case::text("held", held);
            let case = quantities.iter().fold(of(name, frictions), |case, quantity| {
                case.oracle(same(quantity, held.clone(), tolerance, "a support"))
            });
            cases.push(if method == "penalty" { case } else { case.must_run() });
        }
        for friction in [0.3, 5.0] {
            let case = of(&format!("friction {friction}"), [friction; 2]);
            // Each bears a half of what the whole has at a side.
            let case = case
                .oracle(scaled("p.fz", between_walls(friction), 0.5, tolerance, "the whole"))
                .oracle(scaled("wx.fx", between_walls(friction), 0.5, tolerance, "the whole"));
            cases.push(if friction < 1.0 && method != "penalty" { case.must_run() } else { case });
        }
    }
    cases
}

/// A block in the corner of three walls that close on it: E / (1 - 2 nu) ln l under even pressure, over the area 4 l^2 of
/// a side, with J = l^3.
fn node_on_three_tools() -> Vec<Case> {
    let wall = |name: &str, normal: [f64; 3], by: [f64; 3], slave: &str, friction: f64, method: &str| {
        (
            format!(
                "[tool.{name}]\nplane = {{ point = [2.0, 2.0, 2.0], normal = {normal:?} }}\n[contact.c{name}]\nslave = \"b.{slave}\"\nmaster = \"{name}\"\nfriction = {friction:?}\nmethod = \"{method}\"\n"
            ),
            format!("{{ target = \"{name}\", by = {by:?} }}, "),
        )
    };
    let mut cases = Vec::new();
    for method in METHODS {
        for friction in [0.0, 0.3] {
            let (head, _) = BAR.split_once("[tool.p]").unwrap();
            let mut text = head.to_string();
            let mut moves = String::new();
            for (axis, name) in ["wx", "wy", "wz"].iter().enumerate() {
                let along = |s: f64| [0, 1, 2].map(|c| if c == axis { s } else { 0.0 });
                let (tool, by) = wall(name, along(-1.0), along(-0.1), ["xmax", "ymax", "zmax"][axis], friction, method);
                text += &tool;
                moves += &by;
            }
            text += &format!(
                "[[step]]\nincrements = 2\nmove = [{moves}]\n[output]\nevery = 1000\nhistory = [\"b.zmin\"]\n"
            );
            let even = 4.0 * 10.0 / 0.4 * 0.95f64.ln() / 0.95;
            let tolerance = if method == "penalty" { 5e-2 } else { 1e-6 };
            let case = Case::text(format!("friction {friction}, {method}"), text);
            cases.push(if friction == 0.0 {
                case.oracle(value("wx.fx", even, tolerance, "closed form")).oracle(value(
                    "wz.fz",
                    even,
                    tolerance,
                    "closed form",
                ))
            } else {
                case.oracle(value("wx.fx/wz.fz", 1.0, 1e-6, "all axes alike"))
            });
        }
    }
    cases
}

/// A block is pushed into a corner of three planes with friction, and eased: nodes on its edges bear two of them, one all
/// three. What presses all sides alike gives all planes the same.
fn into_a_corner() -> Vec<Case> {
    let (head, _) = BAR.split_once("[tool.p]").unwrap();
    let head = head
        .replace("symmetry = [\"xmin\", \"ymin\", \"zmin\"]\n", "")
        .replace("elements = [2, 2, 2]", "elements = [3, 3, 3]");
    let alike = |f: f64| {
        let side = |axis: &str| format!("{{ set = \"b.{axis}max\", value = {f:?} }}");
        format!("pressure = [{}, {}, {}]", side("x"), side("y"), side("z"))
    };
    let askew = |f: f64| format!("force = [{{ target = \"b.zmax\", total = {:?} }}]", [-2.0 * f, -1.5 * f, -3.0 * f]);
    let weight =
        |f: f64| format!("body_force = [{{ body = \"b\", per_volume = {:?} }}]", [-0.3 * f, -0.25 * f, -0.4 * f]);
    let loads: [(&str, &dyn Fn(f64) -> String); 3] = [("alike", &alike), ("askew", &askew), ("by weight", &weight)];
    let mut cases = Vec::new();
    for (name, load) in loads {
        let scene = |method: &str| {
            let mut text = head.clone();
            for (name, normal) in [("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])] {
                text += &format!(
                    "[tool.w{name}]\nplane = {{ point = [0, 0, 0], normal = {normal:?} }}\n[contact.c{name}]\nslave = \"b.{name}min\"\nmaster = \"w{name}\"\nfriction = 0.3\nmethod = \"{method}\"\n"
                );
            }
            text += &format!("[[step]]\nname = \"push\"\nincrements = 4\n{}\n", load(1.0));
            text += &format!("[[step]]\nname = \"ease\"\nincrements = 2\n{}\n", load(0.5));
            text + "[output]\nevery = 1000\nhistory = [\"b\"]\n"
        };
        let uzawa = Case::text("uzawa", scene("uzawa"));
        for method in METHODS.into_iter().filter(|method| *method != "uzawa") {
            let tolerance = if method == "penalty" { 5e-2 } else { 1e-5 };
            let mut case = Case::text(format!("{name}, {method}"), scene(method)).must_run();
            for force in ["wx.fx@push", "wy.fy@push", "wz.fz@push", "wx.fz@push", "wz.fz"] {
                case = case.oracle(same(force, uzawa.clone(), tolerance, "uzawa"));
            }
            if name == "alike" {
                case = case.oracle(value("wx.fx/wz.fz", 1.0, 1e-6, "all axes alike"));
            }
            cases.push(case.quick_if(method == "augmented-lagrangian"));
        }
        let case = Case::text(format!("{name}, multigrid"), scene("augmented-lagrangian"));
        let case = case.set("solver.linear=iterative").oracle(same("wx.fz@push", uzawa, 1e-5, "uzawa"));
        cases.push(case.must_run().quick_if(name == "askew"));
    }
    cases
}

/// Two tools of the same plane on the same nodes.
fn coincident_tools() -> Vec<Case> {
    let mut cases = Vec::new();
    for friction in [0.0, 0.3] {
        for method in METHODS {
            let tool = format!(
                "[tool.q]\nplane = {{ point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }}\n[contact.d]\nslave = \"b.zmax\"\nmaster = \"q\"\nfriction = {friction:?}\nmethod = \"{method}\"\n[contact.c]"
            );
            let text = BAR
                .replace("[contact.c]", &tool)
                .replace("move = [", "move = [{ target = \"q\", by = [0.0, 0.0, -0.4] }, ");
            let right = crate::scenes::bar_force(10.0, 4.0, 0.8);
            let tolerance = if method == "penalty" { 2e-2 } else { 1e-6 };
            let case = Case::text(format!("friction {friction}, {method}"), text)
                .set(format!("contact.c.friction={friction:?}"))
                .set(format!("contact.c.method={method}"));
            // With friction the top is held sideways, and the force the larger.
            cases.push(if friction == 0.0 {
                case.oracle(value("b.zmin.fz", -right, tolerance, "closed form"))
            } else {
                let one =
                    Case::text("one", BAR).set("contact.c.friction=0.3").set(format!("contact.c.method={method}"));
                case.oracle(same("b.zmin.fz", one, 0.2, "one tool"))
            });
        }
    }
    cases
}

/// A square prism stands on its edge in a trench of two planes, and is closed in by two more: a bar turned by 45 degrees
/// that is pressed along both of its axes in plane strain.
fn trench() -> Vec<Case> {
    let s = std::f64::consts::FRAC_1_SQRT_2;
    let mesh = crate::common::msh::block([4, 4, 1], false, |[a, b, c]| {
        let (a, b) = (2.0 * a, 2.0 * b);
        [s * (a - b), s * (a + b), c]
    });
    // Sides of the prism: xmin, ymin below, xmax, ymax above.
    let tool = |name: &str, point: [f64; 3], normal: [f64; 3], slave: &str, method: &str, friction: f64| {
        format!(
            "[tool.{name}]\nplane = {{ point = {point:?}, normal = {normal:?} }}\n[contact.c{name}]\nslave = \"b.{slave}\"\nmaster = \"{name}\"\nfriction = {friction:?}\nmethod = \"{method}\"\n"
        )
    };
    let top = [0.0, 4.0 * s, 0.0];
    let mut cases = Vec::new();
    for method in METHODS {
        for friction in [0.0, 0.2] {
            let text = "[body.b]\nmesh = \"b.msh\"\nmaterial = \"m\"\nelement = \"hex8\"\nplane_strain = true\n[material.m]\nmodel = \"hooke\"\nyoung = 10.0\npoisson = 0.3\n".to_string()
                + &tool("la", [0.0; 3], [s, s, 0.0], "xmin", method, friction)
                + &tool("lb", [0.0; 3], [-s, s, 0.0], "ymin", method, friction)
                + &tool("ua", top, [-s, -s, 0.0], "xmax", method, friction)
                + &tool("ub", top, [s, -s, 0.0], "ymax", method, friction)
                + &format!("[[step]]\nincrements = 2\nmove = [{{ target = \"ua\", by = [{0:?}, {0:?}, 0.0] }}, {{ target = \"ub\", by = [{1:?}, {0:?}, 0.0] }}]\n[output]\nevery = 1000\nhistory = [\"b\"]\n", -0.1 * s, 0.1 * s);
            // Strain ln 0.95 along both axes: Kirchhoff E / ((1 + nu) (1 - 2 nu)) ln l, area 2 l, J = l^2; its share along y.
            let right = s * 2.0 * 10.0 / (1.3 * 0.4) * 0.95f64.ln() / 0.95;
            let tolerance = if method == "penalty" { 5e-2 } else { 1e-6 };
            let case = Case::text(format!("friction {friction}, {method}"), text).file("b.msh", mesh.as_str());
            let case = if friction == 0.0 {
                case.oracle(value("ua.fy", right, tolerance, "closed form")).oracle(value(
                    "la.fy",
                    -right,
                    tolerance,
                    "closed form",
                ))
            } else {
                case.oracle(near("ua.fy", right, right.abs(), 0.3, "without friction"))
                    .oracle(balance(&["la", "lb", "ua", "ub"], 1e-6))
            };
            cases.push(case);
        }
    }
    cases
}

/// A flat is drawn over the crest of a roof of two planes, with a row of nodes exactly on it at each increment.
fn across_an_edge() -> Vec<Case> {
    let roof = crate::common::msh::surface(2, |s, t| {
        let (x, y) = (12.0 * t - 6.0, 12.0 * s - 6.0);
        [x + 2.0, y + 2.0, 2.0 + 0.3 * x.abs()]
    });
    let scene = SLAB.replace(
        "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
        "mesh = \"roof.msh\"\nfeature_angle = 10.0",
    );
    let mut cases = Vec::new();
    for method in METHODS {
        for smoothing in ["nagata", "facet"] {
            for (by, name) in [("[1, 0, 0]", "by an element"), ("[2, 0, 0]", "to the end")] {
                let case = Case::text(format!("{name}, {method}, {smoothing}"), scene.as_str())
                    .file("roof.msh", roof.as_str())
                    .set(format!("contact.c.method={method}"))
                    .set(format!("tool.t.smoothing={smoothing}"))
                    .set(format!("step.draw.move.0.by={by}"))
                    .oracle(balance(&["t", "b.zmin"], 1e-8));
                let other = if method == "lagrange" { "uzawa" } else { "lagrange" };
                let reference = case.clone().set(format!("contact.c.method={other}"));
                let tolerance = if method == "penalty" { 5e-2 } else { 1e-3 };
                cases.push(case.oracle(same("t.fz", reference, tolerance, &format!("method={other}"))).slow());
            }
        }
    }
    cases
}

/// A cube is pressed by closed platens that are hardly wider, by more than its nodes are from their sides; also a quarter of it
/// by a platen cut in the planes of symmetry. Each presses as an endless plane does.
fn closed_platens() -> Vec<Case> {
    let scene = |tool: &str, supports: &str, friction: f64, increments: usize| {
        format!(
            "[body.b]\nmaterial = \"m\"\nblock = {{ box = {{ size = [1.0, 1.0, 1.0] }}, elements = [4, 4, 4] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n[tool.t]\n{tool}\n[contact.c]\nslave = \"b.zmax\"\nmaster = \"t\"\nfriction = {friction:?}\n[[step]]\nincrements = {increments}\nfix = [{{ set = \"b.zmin\" }}{supports}]\nmove = [{{ target = \"t\", by = [0.0, 0.0, -0.2] }}]\n[output]\nevery = 1000\nhistory = [\"b.zmin\"]\n"
        )
    };
    let plane = "plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }";
    let cut = ", { set = \"b.xmin\", directions = \"x\" }, { set = \"b.ymin\", directions = \"y\" }";
    let mut cases = Vec::new();
    for (supports, shape) in [("", "whole"), (cut, "quarter")] {
        for over in [0.0, 1e-6, 1e-3, 0.05, 0.15] {
            // Without friction the cube gets wider by 0.08.
            for friction in [0.0, 0.5].into_iter().filter(|friction| *friction > 0.0 || over > 0.1) {
                for thick in [0.05, 1.0] {
                    let side = |t: f64| t * (1.0 + 2.0 * over) - over;
                    let half = |t: f64| t * (1.0 + 2.0 * 0.15) - over.min(0.15);
                    let mesh = crate::common::msh::block([1, 1, 1], false, |[x, y, z]| match supports {
                        "" => [side(x), side(y), 1.0 + thick * z],
                        _ => [half(x), half(y), 1.0 + thick * z],
                    });
                    // Under a penalty friction lets the rim slide off by a thousandth.
                    let methods = METHODS.into_iter().filter(|method| *method != "penalty" || over > 0.01);
                    for (method, increments) in methods.flat_map(|m| [(m, 1), (m, 4)]) {
                        let name = format!(
                            "{shape}, over by {over:e}, {thick} thick, mu = {friction}, {method}, {increments}"
                        );
                        let with = |tool: &str| {
                            Case::text(name.as_str(), scene(tool, supports, friction, increments))
                                .set(format!("contact.c.method={method}"))
                        };
                        let case = with("mesh = \"t.msh\"").file("t.msh", mesh.as_str()).oracle(same(
                            "t.fz",
                            with(plane),
                            1e-6,
                            "a plane",
                        ));
                        cases.push(case.quick_if(over == 0.05 && method == METHODS[0] && increments == 1));
                    }
                }
            }
        }
    }
    cases
}

/// A block that is wider than the platen that is pressed into it, whose edges are between its nodes: as on a fine mesh that has
/// nodes under them, or told of. Of a layer it does not matter how thick it is.
fn past_a_platen() -> Vec<Case> {
    let scene = |[across, deep]: [usize; 2], size: f64, kind: &str, rim: f64| {
        let high = 4.0 - rim;
        format!(
            "[body.b]\nmaterial = \"m\"\n{kind}\nblock = {{ box = {{ size = [4.0, 2.0, {size:?}] }}, elements = [{across}, {}, {deep}] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n[tool.t.profile]\npoints = [[{rim:?}, 3.0], [{rim:?}, 2.0], [{high:?}, 2.0], [{high:?}, 3.0]]\nclosed = true\nextrude = {{ origin = [0.0, 0.0, -1.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0], length = 12.0 }}\n[contact.c]\nslave = \"b.ymax\"\nmaster = \"t\"\n[[step]]\nincrements = 4\nfix = [{{ set = \"b.ymin\" }}]\nmove = [{{ target = \"t\", by = [0.0, -0.4, 0.0] }}]\n[output]\nevery = 1000\nhistory = [\"b.ymin\"]\n",
            across / 2
        )
    };
    let mut cases = Vec::new();
    let layer = |size: f64| (format!("a layer of {size}"), "plane_strain = true", size);
    for (name, kind, size) in [layer(0.1), layer(1.0), layer(10.0), ("a block".into(), "", 4.0)] {
        for across in [4, 8, 16] {
            for rim in [0.05, 0.3, 0.8] {
                let [deep, fine] = if kind.is_empty() { [across, 40] } else { [1, 80] };
                let fine = Case::text("fine", scene([fine, deep.min(4)], size, kind, rim)).limit(300);
                let text = scene([across, deep], size, kind, rim);
                // What four elements are too stiff by is theirs.
                let tolerance = if across == 4 { 0.25 } else { 0.1 };
                let case = Case::text(format!("{name}, {across} elements, {rim} wider"), text)
                    .oracle(same("t.fy", fine, tolerance, "a fine mesh"))
                    .or_warns(&["between its nodes"]);
                cases.push(case.quick_if(across == 8 && !kind.is_empty() && rim == 0.3));
            }
        }
    }
    cases
}

/// A block is drawn off another until a half of it hangs over: as from segment to segment, or told of.
fn off_a_body() -> Vec<Case> {
    let scene = |elements: usize, friction: f64| {
        format!(
            "[body.lower]\nmaterial = \"m\"\nplane_strain = true\nblock = {{ box = {{ size = [4.0, 1.0, 1.0] }}, elements = [{elements}, {}, 1] }}\n[body.upper]\nmaterial = \"m\"\nplane_strain = true\nblock = {{ box = {{ origin = [2.0, 1.0, 0.0], size = [2.0, 1.0, 1.0] }}, elements = [{}, {}, 1] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n[contact.c]\nslave = \"upper.ymin\"\nmaster = \"lower.ymax\"\nfriction = {friction:?}\n[[step]]\nname = \"press\"\nincrements = 2\nfix = [{{ set = \"lower.ymin\" }}]\nmove = [{{ target = \"upper.ymax\", by = [0.0, -0.1, 0.0] }}]\n[[step]]\nname = \"draw\"\nincrements = 10\nfix = [{{ set = \"lower.ymin\" }}]\nmove = [{{ target = \"upper.ymax\", by = [1.0, 0.0, 0.0] }}]\n[output]\nevery = 1000\nhistory = [\"lower.ymin\", \"upper.ymax\"]\n",
            elements / 4,
            elements / 2 + 1,
            elements / 4
        )
    };
    let mut cases = Vec::new();
    for elements in [4, 8, 16, 32] {
        for friction in [0.0, 0.2] {
            let fine = Case::text("fine", scene(32, friction)).set("contact.c.discretization=segment").limit(300);
            for discretization in ["one-pass", "two-pass", "segment"] {
                let name = format!("{elements} elements, mu = {friction}, {discretization}");
                let case = Case::text(name, scene(elements, friction))
                    .set(format!("contact.c.discretization={discretization}"))
                    .oracle(same("upper.ymax.fy", fine.clone(), 0.15, "a fine mesh of segments"))
                    .oracle(balance(&["lower.ymin", "upper.ymax"], 1e-8))
                    .or_warns(&["slid off", "between its nodes", "a jump took its force"])
                    .limit(300);
                cases.push(case.quick_if(elements == 8 && discretization == "segment" && friction > 0.0));
            }
        }
    }
    cases
}
