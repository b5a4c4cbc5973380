//! Runs that go on from a checkpoint in the middle of an extreme: as if they had never stopped.

use crate::case::Case;
use crate::numbers::ball;
use crate::oracle::same;
use crate::scenes::{SLAB, sphere};

family!(all);

fn all() -> Vec<Case> {
    let cases = vec![
        ("cap.fx", sphere("penalty 1e9 times automatic", [4, 4, 2], 2, 4).set("contact.top.penalty=2e11")),
        ("cap.fx", sphere("penalty 1e-3 times automatic", [4, 4, 2], 2, 4).set("contact.top.penalty=0.2")),
        ("cap.fx", sphere("uzawa, nu = 0.499999", [4, 4, 2], 2, 2).sets(UZAWA)),
        ("cap.fx", sphere("from segment to segment", [4, 4, 2], 2, 2).set("contact.top.discretization=segment")),
        ("cap.fx", sphere("ogden", [4, 4, 2], 2, 2).set("body.block.element=hex8-fbar").set(OGDEN)),
        ("cap.fx", sphere("mu = 100", [4, 4, 2], 2, 2).set("contact.top.friction=100.0")),
        ("cap.fx", ball("lengths times 1e-9, E times 1e16", 1e-9, 1e16, 0.0)),
        ("cap.fx", ball("lengths times 1e9, E times 1e-8", 1e9, 1e-8, 0.0)),
        ("cap.fx", ball("100 sizes away", 1.0, 1.0, 4000.0)),
        (
            "t.fx",
            Case::text(
                "orthotropic, moduli 1e4 apart",
                SLAB.replace("model = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3", ORTHOTROPIC),
            ),
        ),
        (
            "t.fx",
            Case::text("perfectly plastic by Hill", SLAB.replace("model = \"neo-hookean\"", HILL)).sets([
                "body.b.element=hex8-sri",
                "step.press.increments=10",
                "step.draw.increments=10",
            ]),
        ),
        ("t.fx", Case::text("tolerance 1e-14", SLAB).set("solver.tolerance=1e-14")),
    ];
    cases
        .into_iter()
        .enumerate()
        .map(|(k, (quantity, case))| {
            let case = case.set("output.checkpoint={ increments = 1 }");
            let whole = case.clone();
            case.goes_on().oracle(same(quantity, whole, 1e-8, "the run in one go")).quick_if(k == 3)
        })
        .collect()
}

const UZAWA: [&str; 3] =
    ["contact.top.method=uzawa", "body.block.element=hex8-fbar", "material.rubber.poisson=0.499999"];
const OGDEN: &str = "material.rubber={ model = \"ogden\", terms = [[20.0, 30.0], [5.0, -30.0]], bulk = 1e5 }";
const ORTHOTROPIC: &str = "model = \"orthotropic\"\northotropic = { e1 = 1e5, e2 = 100.0, e3 = 10.0, nu12 = 3.0, nu13 = 9.0, nu23 = 0.3, g12 = 40.0, g13 = 4.0, g23 = 4.0 }";
const HILL: &str = "model = \"hill\"\nyield_stress = 1.0\nhill = { f = 0.5, g = 0.05, h = 0.5, n = 1.5 }";
