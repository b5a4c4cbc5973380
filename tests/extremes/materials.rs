//! Materials at their ends: Poisson's ratio, incompressibility, hardening from nothing, flow without hardening.

use crate::case::Case;
use crate::oracle::{balance, near, none, same, value};
use crate::scenes::{BAR, METHODS, SLAB, bar_force, sphere};

family!(poisson_in_a_bar, poisson_under_a_sphere, swift_from_nothing, perfect_plasticity, collapse, without_cuts);

/// Hooke's law in a bar: the force does not depend on nu.
fn poisson_in_a_bar() -> Vec<Case> {
    let mut cases = Vec::new();
    let tets = crate::common::msh::block([1, 1, 1], true, |p| p.map(|x| 2.0 * x));
    for element in ["hex8", "hex8-fbar", "hex8-sri", "hex8-eas", "tet4"] {
        for nu in
            ["-0.99", "-0.9", "-0.5", "0.0", "0.49", "0.499", "0.4999", "0.499999", "0.499999999", "0.499999999999"]
        {
            let scene = match element {
                "tet4" => BAR
                    .replace("block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }", "mesh = \"b.msh\""),
                _ => BAR.to_string(),
            };
            let case = Case::text(format!("nu = {nu}, {element}"), scene)
                .file("b.msh", tets.as_str())
                .set(format!("body.b.element={element}"))
                .set(format!("material.m.poisson={nu}"))
                .oracle(value("p.fz", bar_force(10.0, 4.0, 0.8), 1e-4, "closed form"))
                .oracle(balance(&["p", "b.zmin"], 1e-4));
            let case = match (nu, element) {
                ("-0.99", "hex8-eas") => case.must_be_refused(&["enhanced strain buckle"]),
                _ if nu.len() <= 6 => case.must_run(),
                _ => case,
            };
            cases.push(if ["hex8-fbar", "hex8-sri"].contains(&element) || nu == "-0.99" { case } else { case.slow() });
        }
    }
    cases
}

/// nu from -0.99 on, with friction, by default and by `lagrange`.
fn poisson_under_a_sphere() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["hex8", "hex8-fbar", "hex8-sri", "hex8-eas"] {
        for nu in ["-0.99", "-0.5", "0.0", "0.45", "0.49", "0.499", "0.4999", "0.49999", "0.4999999", "0.499999999"] {
            let case = sphere(format!("nu = {nu}, {element}"), [4, 4, 2], 2, 2)
                .set(format!("body.block.element={element}"))
                .set(format!("material.rubber.poisson={nu}"));
            // What does not lock has a limit: nothing changes any more.
            let (reference, tolerance, source) = match nu {
                "0.499999999" if element != "hex8" => {
                    (case.clone().set("material.rubber.poisson=0.499999"), 1e-3, "nu = 0.499999")
                }
                _ => (case.clone().set("contact.top.method=lagrange"), 1e-4, "method=lagrange"),
            };
            let case = case
                .oracle(same("cap.fx", reference, tolerance, source))
                .oracle(balance(&["cap", "block.bottom"], 1e-4));
            let case = match (nu, element) {
                ("-0.99", "hex8-eas") => case.must_be_refused(&["enhanced strain buckle"]),
                _ if nu.len() <= 7 => case.must_run(),
                _ => case,
            };
            cases.push(if element == "hex8-fbar" { case } else { case.slow() });
        }
    }
    cases
}

/// A bar of elastic-plastic material; its elastic strain is below 1e-2.
fn plastic_bar(name: &str, young: f64, flow: &str) -> Case {
    let scene = BAR.replace("model = \"hooke\"\nyoung = 10.0", &format!("model = \"j2\"\nyoung = {young:?}\n{flow}"));
    Case::text(name, scene).sets([
        "body.b.element=hex8-fbar",
        "step.press.increments=6",
        "step.press.move.0.by=[0, 0, -0.6]",
    ])
}

/// k e^n with e0 = 0: Kirchhoff stress over l, strain -ln 0.7.
fn swift_from_nothing() -> Vec<Case> {
    let right = -4.0 * 5.0 * 0.7f64.ln().abs().powf(0.2) / 0.7;
    ["1e-2", "1e-4", "1e-8", "1e-12", "1e-30", "1e-60", "1e-100", "1e-200", "1e-300"]
        .map(|e0| {
            plastic_bar(e0, 1000.0, &format!("hardening = {{ swift = {{ k = 5.0, n = 0.2, e0 = {e0} }} }}"))
                .oracle(value("p.fz", right, 1e-2, "closed form"))
        })
        .into()
}

/// No hardening at all, and softer than that.
fn perfect_plasticity() -> Vec<Case> {
    let mut cases = Vec::new();
    for young in [1e3, 1e6, 1e9, 1e12] {
        for element in ["hex8-fbar", "hex8-sri", "hex8-eas"] {
            let case = plastic_bar(&format!("E over yield stress {young:e}, {element}"), young, "yield_stress = 1.0")
                .set(format!("body.b.element={element}"))
                .oracle(value("p.fz", -4.0 / 0.7, 3e-3, "closed form"))
                .oracle(balance(&["p", "b.zmin"], 1e-4));
            cases.push(case.quick_if(element == "hex8-fbar" && young < 1e9));
        }
    }
    // A slab without hardening, all of it flowing: between a bar's 16 / 0.9 and that times 1 + 2 r / (3 sqrt(3) h), of a
    // disk of the same area that sticks.
    for method in METHODS {
        cases.push(
            Case::text(
                format!("slab with friction, {method}"),
                crate::scenes::SLAB.replace("model = \"neo-hookean\"", "model = \"j2\"\nyield_stress = 1.0"),
            )
            .sets(["body.b.element=hex8-fbar", "step.press.increments=10", "step.draw.increments=10"])
            .set(format!("contact.c.method={method}"))
            .oracle(near("t.fz@press", -22.1, 22.1, 0.2, "limits: a bar, and a disk that sticks"))
            .oracle(balance(&["t", "b.zmin"], 1e-8))
            .quick_if(method == METHODS[0]),
        );
    }
    cases
}

/// Forces below and above the limit load of a bar without hardening, 4 at its first flow; it hardens only by getting
/// thicker, F = 4 / l.
fn collapse() -> Vec<Case> {
    let bar = |name: &str, force: f64| {
        let scene = BAR
            .replace("model = \"hooke\"\nyoung = 10.0", "model = \"j2\"\nyield_stress = 1.0\nyoung = 1000.0")
            .replace(
                "move = [{ target = \"p\", by = [0.0, 0.0, -0.4] }]",
                &format!("force = [{{ target = \"p\", total = [0.0, 0.0, {force:?}], directions = \"z\" }}]"),
            );
        Case::text(name, scene).set("body.b.element=hex8-fbar").set("step.press.increments=10")
    };
    let pulled = |force: f64| {
        let (head, _) = BAR.split_once("[tool.p]").unwrap();
        let head =
            head.replace("model = \"hooke\"\nyoung = 10.0", "model = \"j2\"\nyield_stress = 1.0\nyoung = 1000.0");
        format!("{head}[[step]]\nincrements = 10\nforce = [{{ target = \"b.zmax\", total = [0.0, 0.0, {force:?}] }}]\n[output]\nevery = 1000\nhistory = [\"b.zmin\", \"b.zmax\"]\n").replace("element = \"hex8\"", "element = \"hex8-fbar\"")
    };
    vec![
        bar("0.99 of first flow", -3.96).oracle(near("p.uz", -0.00198, 0.00198, 1e-2, "closed form")).must_run(),
        bar("1.2 of first flow", -4.8).oracle(value("p.uz", 2.0 * (4.0 / 4.8 - 1.0), 1e-2, "closed form")),
        bar("2 of first flow", -8.0).oracle(value("p.uz", 2.0 * (0.5 - 1.0), 1e-2, "closed form")),
        // In tension it gets thinner, and nothing bears more than 4.
        Case::text("pulled by 1.1 of first flow", pulled(4.4)).must_be_refused(&[]),
        Case::text("pulled by 0.99 of first flow", pulled(3.96))
            .oracle(near("b.zmax.uz", 0.00198, 0.00198, 1e-2, "closed form"))
            .must_run(),
    ]
}

/// Friction costs no jump up to nu = 0.49999, and no cut up to 0.4999 unless elements lock, be it under a sphere or a plate;
/// under a sphere with F-bar none up to 0.49999.
fn without_cuts() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["hex8", "hex8-fbar", "hex8-sri", "hex8-eas"] {
        for nu in [0.3, 0.49, 0.499, 0.4999, 0.49999].into_iter().filter(|nu| element != "hex8" || *nu < 0.4999) {
            for method in METHODS {
                let is_tight = METHODS[..2].contains(&method);
                let what = format!("{element}, nu = {nu}, {method}");
                let press = |n: [usize; 3], increments: usize| {
                    let name = format!("sphere on {n:?}, {what}");
                    let case = sphere(name, n, increments, increments)
                        .set(format!("body.block.element={element}"))
                        .set(format!("material.rubber.poisson={nu}"))
                        .set(format!("contact.top.method={method}"))
                        .oracle(balance(&["cap", "block.bottom"], 1e-6));
                    (case, nu < 0.49999 || is_tight && element == "hex8-fbar")
                };
                let slab = Case::text(format!("slab, {what}"), SLAB)
                    .set(format!("body.b.element={element}"))
                    .set(format!("material.m.poisson={nu}"))
                    .set(format!("contact.c.method={method}"))
                    .oracle(balance(&["t", "b.zmin"], 1e-6));
                let slab = (slab, nu < 0.4999 || nu < 0.49999 && is_tight);
                for (case, is_uncut) in [press([4, 4, 2], 2), press([8, 8, 4], 4), slab] {
                    let case = case.oracle(none("jumps")).must_run();
                    let case = if is_uncut { case.oracle(none("cutbacks")) } else { case };
                    let is_small = !case.name.contains("[8, 8, 4]");
                    cases.push(case.quick_if(is_small && is_uncut && nu > 0.4998 && method == METHODS[0]));
                }
            }
        }
    }
    cases
}
