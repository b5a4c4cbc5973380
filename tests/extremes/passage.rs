//! Tools that go through a body in one increment, look the other way, or turn all the way round.

use crate::case::Case;
use crate::oracle::{balance, value};
use crate::scenes::{BAR, METHODS, SLAB, bar_force, plate};

family!(
    ball_deep_in_a_block,
    ball_into_a_sheet,
    thin_tool,
    thin_sheet,
    reversed_tool,
    full_turns,
    whole_path_at_once,
    opening_and_closing,
    gaps_and_overlaps,
    off_the_end
);

/// A ball of radius 10 is pressed 12 into a block.
fn ball_deep_in_a_block() -> Vec<Case> {
    let scene = r#"[body.block]
material = "rubber"
element = "hex8"
block = { box = { origin = [-20.0, -20.0, 0.0], size = [40.0, 40.0, 20.0] }, elements = [8, 8, 4] }
[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.cap]
sphere = { center = [0.0, 0.0, 30.0], radius = 10.0 }
[contact.top]
slave = "block.zmax"
master = "cap"
friction = 0.3
[[step]]
name = "press"
increments = 12
fix = [{ set = "block.zmin" }]
move = [{ target = "cap", by = [0.0, 0.0, -12.0] }]
[[step]]
name = "slide"
increments = 2
fix = [{ set = "block.zmin" }]
move = [{ target = "cap", by = [1.0, 0.0, 0.0] }]
[output]
every = 1000
history = ["block.zmin"]
"#;
    [1, 2, 4, 12]
        .map(|n| {
            Case::text(format!("{n} increments"), scene)
                .set(format!("step.press.increments={n}"))
                .oracle(value("cap.fz@press", -28789.0, 2e-2, "4 and 12 increments"))
                .oracle(balance(&["cap", "block.zmin"], 1e-8))
                .slow()
        })
        .into()
}

/// A ball is pushed 6 into a clamped sheet of 1.
fn ball_into_a_sheet() -> Vec<Case> {
    let scene = r#"[body.s]
material = "m"
element = "hex8-eas"
block = { box = { origin = [-10.0, -10.0, 0.0], size = [20.0, 20.0, 1.0] }, elements = [16, 16, 1], faces = { rim = ["xmin", "xmax", "ymin", "ymax"] } }
[material.m]
model = "neo-hookean"
young = 10.0
poisson = 0.4
[tool.ball]
sphere = { center = [0.3, 0.2, 5.0], radius = 4.0 }
[contact.c]
slave = "s.zmax"
master = "ball"
[[step]]
name = "push"
increments = 1
fix = [{ set = "s.rim" }]
move = [{ target = "ball", by = [0.0, 0.0, -6.0] }]
[output]
every = 1000
history = ["s.rim"]
"#;
    let case = |n: usize| {
        Case::text(format!("{n} increments"), scene)
            .set(format!("step.push.increments={n}"))
            .oracle(value("ball.fz", -27.96, 1e-3, "3 and 20 increments"))
            .oracle(balance(&["ball", "s.rim"], 1e-8))
            .must_run()
            .slow()
            .limit(300)
    };
    vec![case(1), case(2), case(3), case(20)]
}

/// The force when the bar under a tool that comes down by `by` from a gap is not passed through.
fn bar_after(down: f64) -> f64 {
    bar_force(10.0, 4.0, 1.0 - down / 2.0)
}

/// A closed tool 0.3 thick comes down by 0.5 from 0.1 above the bar.
fn thin_tool() -> Vec<Case> {
    let lower = "profile = { points = [[-9.0, 2.1], [9.0, 2.1], [9.0, 2.4], [-9.0, 2.4]], closed = true, extrude = { origin = [0.0, 9.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0], length = 18.0 } }";
    let bar = BAR.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", lower);
    let mesh = BAR.replace(
        "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
        "mesh = \"tool.msh\"\ngroup = \"all\"",
    );
    let closed = closed_box([-9.0, -9.0, 2.1], [9.0, 9.0, 2.4]);
    let mut cases = Vec::new();
    for n in [1, 2, 5] {
        let set = |case: Case| {
            case.set(format!("step.press.increments={n}")).set("step.press.move.0.by=[0, 0, -0.5]").oracle(value(
                "p.fz",
                bar_after(0.4),
                1e-6,
                "closed form",
            ))
        };
        cases.push(set(Case::text(format!("profile, {n} increments"), bar.as_str())));
        cases.push(set(Case::text(format!("mesh, {n} increments"), mesh.as_str()).file("tool.msh", closed.as_str())));
    }
    cases
}

/// The six sides of a box, outwards, as two triangles each way, in the group `all`.
fn closed_box(low: [f64; 3], high: [f64; 3]) -> String {
    let corner = |i: usize| [0, 1, 2].map(|c| if i >> c & 1 == 0 { low[c] } else { high[c] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"all\"\n$EndPhysicalNames\n$Nodes\n8\n"
            .to_string();
    for i in 0..8 {
        let [x, y, z] = corner(i);
        text += &format!("{} {x:?} {y:?} {z:?}\n", i + 1);
    }
    text += "$EndNodes\n$Elements\n6\n";
    for (k, side) in sides.iter().enumerate() {
        let [a, b, c, d] = side.map(|i| i + 1);
        text += &format!("{} 3 2 1 1 {a} {b} {c} {d}\n", k + 1);
    }
    text + "$EndElements\n"
}

/// The same with a sheet 0.1 thick of a deformable body, all of whose nodes are moved.
fn thin_sheet() -> Vec<Case> {
    let (bar, steps) = BAR.split_once("[tool.p]").unwrap();
    let steps = steps.split_once("[contact.c]").unwrap().1.replace("master = \"p\"", "master = \"sheet.zmin\"");
    let steps = steps.replace("target = \"p\", by = [0.0, 0.0, -0.4]", "target = \"sheet\", by = [0.0, 0.0, -0.5]");
    let sheet = "[body.sheet]\nmaterial = \"m\"\nelement = \"hex8\"\nblock = { box = { origin = [-1.0, -1.0, 2.1], size = [4.0, 4.0, 0.1] }, elements = [4, 4, 1] }\n";
    [1, 2, 5]
        .map(|n| {
            Case::text(format!("{n} increments"), format!("{sheet}{bar}[contact.c]{steps}"))
                .set(format!("step.press.increments={n}"))
                .oracle(value("b.zmin.fz", -bar_after(0.4), 1e-6, "closed form"))
        })
        .into()
}

/// A plate whose normals look away from the bar: touching, a bit above, 30 above, and where the bar is.
fn reversed_tool() -> Vec<Case> {
    let mesh = BAR.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", "mesh = \"tool.msh\"");
    let plane = |z: f64, up: f64| {
        BAR.replace(
            "point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0]",
            &format!("point = [0.0, 0.0, {z:?}], normal = [0.0, 0.0, {up:?}]"),
        )
    };
    let by = |case: Case, above: f64| {
        case.set(format!("step.press.move.0.by=[0, 0, {:?}]", -0.4 - above)).oracle(value(
            "p.fz",
            bar_after(0.4),
            1e-6,
            "closed form",
        ))
    };
    let mut cases = Vec::new();
    for above in [0.0, 0.01, 1.0, 30.0] {
        let tool = |up| plate(12, 9.0, 2.0 + above, up);
        cases.push(by(Case::text(format!("mesh, {above} above"), mesh.as_str()).file("tool.msh", tool(true)), above));
        cases.push(
            by(
                Case::text(format!("mesh, {above} above, right way"), mesh.as_str()).file("tool.msh", tool(false)),
                above,
            )
            .must_run(),
        );
        cases.push(by(Case::text(format!("plane, {above} above"), plane(2.0 + above, 1.0)), above));
    }
    for inside in [0.01, 0.6, 1.5] {
        let text = format!("{inside} inside the bar");
        let tool = plate(12, 9.0, 2.0 - inside, true);
        cases.push(
            by(Case::text(format!("mesh, {text}"), mesh.as_str()).file("tool.msh", tool), 0.0).must_be_refused(&[]),
        );
        let plane = Case::text(format!("plane, {text}"), plane(2.0 - inside, 1.0));
        cases.push(by(plane, 0.0).must_be_refused(&[]));
    }
    let hollow = |name: &str, z: f64| {
        let ball = format!("sphere = {{ center = [0.0, 0.0, {z:?}], radius = 2.0, hollow = true }}");
        Case::text(name, BAR.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", &ball))
            .must_be_refused(&[])
    };
    cases.push(hollow("a ball as a bore, touching", 4.0));
    cases.push(hollow("a ball as a bore, 30 above", 34.0).set("step.press.move.0.by=[0, 0, -30.4]"));
    cases
}

/// A roller that turns by 360 degrees and more on a slab.
fn full_turns() -> Vec<Case> {
    let scene = SLAB
        .replace(
            "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
            "cylinder = { point = [2.0, 0.0, 3.5], axis = [0.0, 1.0, 0.0], radius = 1.5 }",
        )
        .replace("elements = [4, 4, 2]", "elements = [8, 2, 3]")
        .replace("by = [0.0, 0.0, -0.2]", "by = [0.0, 0.0, -0.1]")
        .replace("by = [0.5, 0.0, 0.0]", "rotate = { point = [2.0, 0.0, 3.4], axis = [0.0, 1.0, 0.0], angle = 360.0 }");
    let case = |name: &str, angle: f64, n: usize| {
        Case::text(name, scene.as_str())
            .set(format!("step.draw.move.0.rotate.angle={angle:?}"))
            .set(format!("step.draw.increments={n}"))
            .oracle(balance(&["t", "b.zmin"], 1e-8))
    };
    let slips = |case: Case| case.oracle(value("t.fx", -7.8875, 1e-3, "4 and 90 increments"));
    vec![
        slips(case("360 degrees in 1", 360.0, 1)),
        slips(case("360 degrees in 2", 360.0, 2)),
        slips(case("360 degrees in 3", 360.0, 3)),
        slips(case("360 degrees in 4", 360.0, 4)).must_run(),
        slips(case("360 degrees in 90", 360.0, 90)).must_run().slow(),
        slips(case("3600 degrees in 40", 3600.0, 40)).must_run(),
        slips(case("720 degrees in 1", 720.0, 1)),
        slips(case("180 degrees in 1", 180.0, 1)),
        slips(case("179 degrees in 1", 179.0, 1)),
    ]
}

/// One increment, and 1000.
fn whole_path_at_once() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        let tolerance = if method == "penalty" { 2e-2 } else { 1e-6 };
        for n in [1, 100, 1000] {
            let bar = Case::text(format!("bar, {method}, {n} increments"), BAR)
                .set(format!("contact.c.method={method}"))
                .set(format!("step.press.increments={n}"))
                .oracle(value("p.fz", bar_after(0.4), tolerance, "closed form"))
                .must_run()
                .limit(400);
            cases.push(bar.quick_if(n < 1000 && method == METHODS[0]));
            let slab = |name: String, n: usize| {
                Case::text(name, SLAB)
                    .set(format!("contact.c.method={method}"))
                    .sets(["step.draw.move.0.by=[3, 0, 0]", "contact.c.friction=0.05"])
                    .set(format!("step.draw.increments={n}"))
                    .limit(400)
            };
            let slab = slab(format!("slab that slips, {method}, {n} increments"), n)
                .oracle(value("t.fx/t.fz", -0.05, 1e-4, "Coulomb"))
                .oracle(balance(&["t", "b.zmin"], 1e-8))
                .must_run();
            cases.push(slab.quick_if(n == 1 && method == METHODS[0]));
        }
    }
    cases
}

/// A plate that opens and closes in each increment, ten times.
fn opening_and_closing() -> Vec<Case> {
    let (head, steps) = SLAB.split_once("[[step]]").unwrap();
    let tail = steps.split_once("[output]").unwrap().1;
    let mut cycles = String::new();
    for k in 0..20 {
        let by = match k {
            0 => "-0.2",
            k if k % 2 == 0 => "-0.5",
            _ => "0.5",
        };
        cycles += &format!(
            "[[step]]\nname = \"s{k}\"\nincrements = 1\nfix = [{{ set = \"b.zmin\" }}]\nmove = [{{ target = \"t\", by = [0.0, 0.0, {by}] }}]\n"
        );
    }
    // Ends closed.
    cycles += "[[step]]\nname = \"end\"\nincrements = 1\nfix = [{ set = \"b.zmin\" }]\nmove = [{ target = \"t\", by = [0.0, 0.0, -0.5] }]\n";
    let scene = format!("{head}{cycles}[output]{tail}");
    METHODS
        .map(|method| {
            let once =
                Case::text("once", SLAB).set("step.draw.move.0.by=[0, 0, 0]").set(format!("contact.c.method={method}"));
            Case::text(method, scene.as_str())
                .set(format!("contact.c.method={method}"))
                .oracle(crate::oracle::same("t.fz", once, 2e-3, "one closing"))
                .oracle(crate::oracle::near("t.fz@s19", 0.0, 1.0, 1e-9, "open"))
                .must_run()
        })
        .into()
}

/// From 1e-12 to half an element, 0.5, apart and into each other.
fn gaps_and_overlaps() -> Vec<Case> {
    let mut cases = Vec::new();
    for gap in [1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5] {
        for gap in [gap, -gap] {
            // The plate goes to 0.4 below the top, from wherever it is.
            let scene = BAR.replace("point = [0.0, 0.0, 2.0]", &format!("point = [0.0, 0.0, {:?}]", 2.0 + gap));
            for method in METHODS {
                let tolerance = if method == "penalty" { 2e-2 } else { 1e-6 };
                cases.push(
                    Case::text(format!("{gap:e}, {method}"), scene.as_str())
                        .set(format!("contact.c.method={method}"))
                        .set(format!("step.press.move.0.by=[0, 0, {:?}]", -0.6 - gap))
                        .oracle(value("p.fz", bar_after(0.6), tolerance, "closed form"))
                        .quick_if(method == METHODS[0]),
                );
            }
            let (text, from) = (crate::scenes::STACK, "origin = [0.0, 0.0, 2.0]");
            cases.push(
                Case::text(
                    format!("{gap:e}, two bodies"),
                    text.replace(from, &format!("origin = [0.0, 0.0, {:?}]", 2.0 + gap)),
                )
                .set(format!("step.press.move.0.by=[0, 0, {:?}]", -0.6 - gap))
                .oracle(value(
                    "upper.zmax.fz",
                    crate::scenes::stack_force(100.0, 100.0, 0.3, 0.6),
                    1e-6,
                    "closed form",
                )),
            );
        }
    }
    cases
}

/// A block is drawn off the end of what it stands on, or the end comes off the block.
fn off_the_end() -> Vec<Case> {
    let scene = SLAB.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", "mesh = \"tool.msh\"");
    let mut cases = Vec::new();
    for method in METHODS {
        for n in [4, 40] {
            let tool = plate(3, 4.5, 2.0, false);
            let case = |name: &str, by: f64| {
                Case::text(format!("{name}, {method}, {n} increments"), scene.as_str())
                    .file("tool.msh", tool.as_str())
                    .set(format!("contact.c.method={method}"))
                    .set(format!("step.draw.move.0.by=[{by:?}, 0, 0]"))
                    .set(format!("step.draw.increments={n}"))
                    .oracle(balance(&["t", "b.zmin"], 1e-8))
            };
            // The plate covers -4.5 to 4.5, the slab 0 to 4.
            let quite = case("quite", -12.0).oracle(crate::oracle::near("t.fz", 0.0, 1.0, 1e-9, "nothing below"));
            cases.push(quite.quick_if(n == 4 && method == METHODS[0]));
            let half = case("half", -2.3);
            cases.push(half.quick_if(n == 4 && method == METHODS[0]));
        }
    }
    cases
}
