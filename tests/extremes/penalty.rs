//! The penalty, over all methods; what it must not decide.

use crate::case::Case;
use crate::oracle::{balance, same, value};
use crate::scenes::{METHODS, sphere};

family!(rubber_with_friction, ordinary, far_from_automatic, uzawa);

/// nu = 0.4999 with friction and defaults.
fn rubber_with_friction() -> Vec<Case> {
    let rubber = |name: &str, n, (press, slide), element: &str, poisson: &str| {
        sphere(name, n, press, slide)
            .set(format!("body.block.element={element}"))
            .set(format!("material.rubber.poisson={poisson}"))
            .oracle(balance(&["cap", "block.bottom"], 1e-6))
            .must_run()
    };
    let by_lagrange = |case: Case| {
        let reference = case.clone().set("contact.top.method=lagrange");
        case.oracle(same("cap.fx", reference, 1e-3, "method=lagrange"))
    };
    let ironing = Case::new("ironing, 4 facets a fillet", crate::case::Scene::Input("ironing-rigid.toml"))
        .sets(["body.slab.element=hex8-fbar", "body.slab.block.elements=[30, 8, 1]", "material.rubber.poisson=0.4999"])
        .sets(["tool.indenter.smoothing=profile", "step.press.increments=5", "step.slide.increments=10"])
        .sets(["step.press.move.0.by=[0, -5, 0]", "step.slide.move.0.by=[20, 0, 0]", "output.every=1000"])
        .oracle(value("indenter.fx", 916.0, 2e-3, "method=lagrange, penalty=50"))
        .must_run();
    vec![
        rubber("8x8x4 hex8-fbar", [8, 8, 4], (4, 4), "hex8-fbar", "0.4999").oracle(value(
            "cap.fx",
            221.45,
            1e-3,
            "method=lagrange",
        )),
        rubber("4x4x2 hex8", [4, 4, 2], (2, 2), "hex8", "0.4999").oracle(value(
            "cap.fx",
            1455.0,
            1e-3,
            "method=lagrange",
        )),
        by_lagrange(rubber("4x4x2 hex8-sri", [4, 4, 2], (2, 2), "hex8-sri", "0.4999")),
        by_lagrange(rubber("4x4x2 hex8-fbar", [4, 4, 2], (2, 2), "hex8-fbar", "0.4999")),
        by_lagrange(rubber("4x4x2 hex8-eas, 0.49999999", [4, 4, 2], (2, 2), "hex8-eas", "0.49999999")),
        ironing,
    ]
}

/// The methods agree in an ordinary scene.
fn ordinary() -> Vec<Case> {
    METHODS
        .map(|method| {
            // The automatic penalty of `penalty` leaves some penetration, and so is some tenths of a percent too soft.
            let tolerance = if method == "penalty" { 2e-2 } else { 1e-3 };
            sphere(method, [4, 4, 2], 2, 4)
                .set(format!("contact.top.method={method}"))
                .oracle(value("cap.fx", 191.5, tolerance, "method=lagrange"))
                .oracle(balance(&["cap", "block.bottom"], 1e-8))
                .must_run()
        })
        .into()
}

/// From 1e-6 to 1e15 times 200, which is about the automatic one of the augmented Lagrangian here.
fn far_from_automatic() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        for power in [-6, -4, -3, -2, -1, 1, 2, 3, 4, 6, 9, 12, 15] {
            let penalty = 200.0 * 10f64.powi(power);
            let case = sphere(format!("{method} 1e{power}"), [4, 4, 2], 2, 4)
                .set(format!("contact.top.method={method}"))
                .set(format!("contact.top.penalty={penalty:?}"))
                .oracle(balance(&["cap", "block.bottom"], 1e-4));
            // Only `penalty` depends on it: by a share of the stiffness of the block, 4e3, over the penalty.
            cases.push(
                match method {
                    "penalty" if power < 3 => case,
                    "penalty" => case.oracle(value("cap.fx", 191.5, 1e-3 + 2e4 / penalty, "method=lagrange")),
                    _ => case.oracle(value("cap.fx", 191.5, 1e-3, "method=lagrange")),
                }
                .slow(),
            );
        }
    }
    cases
}

/// Uzawa's method by its automatic tolerance, moved by little, beside contacts of other methods, and far from the origin: as by
/// multipliers.
fn uzawa() -> Vec<Case> {
    let mut cases = Vec::new();
    for share in [1.0, 1e-2, 1e-4, 1e-6] {
        for offset in [0.0, 1e3] {
            for beside in ["none", "lagrange", "augmented-lagrangian", "penalty"] {
                let [x, z] = [offset, offset + 2.0];
                // A plate below, too, whose contact is the one beside.
                let below = format!(
                    "[tool.q]\nplane = {{ point = [{x:?}, {x:?}, {x:?}], normal = [0.0, 0.0, 1.0] }}\n[contact.d]\nslave = \"b.zmin\"\nmaster = \"q\"\nfriction = 0.3\nmethod = \"{beside}\"\n[contact.c]"
                );
                let text = crate::scenes::SLAB
                    .replace(
                        "size = [4.0, 4.0, 2.0]",
                        &format!("origin = [{x:?}, {x:?}, {x:?}], size = [4.0, 4.0, 2.0]"),
                    )
                    .replace("point = [0.0, 0.0, 2.0]", &format!("point = [{x:?}, {x:?}, {z:?}]"))
                    .replace("[0.0, 0.0, -0.2]", &format!("[0.0, 0.0, {:?}]", -0.2 * share))
                    .replace("[0.5, 0.0, 0.0]", &format!("[{:?}, 0.0, 0.0]", 0.5 * share));
                let text = match beside {
                    "none" => text,
                    _ => text
                        .replace("[contact.c]", &below)
                        .replace("{ set = \"b.zmin\" }", "{ set = \"b.xmin\", directions = \"xy\" }"),
                };
                let of = |method: &str| Case::text(method, text.as_str()).set(format!("contact.c.method={method}"));
                let name = format!("moved by {share:e}, at {offset:e}, beside {beside}");
                let exact = of("lagrange");
                // What is far from the origin is as exact as places are there.
                let tolerance = 1e-6 + 640.0 * f64::EPSILON * offset / (0.2 * share);
                let case = of("uzawa").named(&name);
                let case = ["t.fx", "t.fz", "t.fz@press"]
                    .iter()
                    .fold(case, |case, force| case.oracle(same(force, exact.clone(), tolerance, "method=lagrange")));
                cases.push(case.quick_if(offset == 0.0 && beside != "penalty" && share != 1e-2));
            }
        }
    }
    cases
}
