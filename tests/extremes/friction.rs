//! What friction holds, and how much of it.

use crate::case::Case;
use crate::oracle::{balance, near, same, value};
use crate::scenes::{GLUED, METHODS, SLAB, glued, sphere};

family!(
    strip_by_a_roller,
    turning_plate,
    rolling,
    coefficients,
    a_block_on_a_slope,
    a_block_that_slides,
    thin_belt,
    slopes_in_two_passes,
    tilted_cubes
);

/// Half of an elastic strip, drawn in by a roller that turns.
fn strip_by_a_roller() -> Vec<Case> {
    let scene = r#"[body.strip]
material = "rubber"
element = "hex8"
plane_strain = true
symmetry = ["ymin"]
block = { box = { origin = [-3.0, 0.0, 0.0], size = [20.0, 1.0, 1.0] }, elements = [80, 4, 1] }
[material.rubber]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[tool.roller]
cylinder = { point = [0.0, 6.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 5.0 }
[contact.nip]
slave = "strip.ymax"
master = "roller"
friction = 0.4
[[step]]
name = "squeeze"
increments = 5
fix = [{ set = "strip.xmax", directions = "x" }]
move = [{ target = "roller", by = [0.0, -0.1, 0.0] }]
[[step]]
name = "feed"
increments = 40
move = [{ target = "roller", rotate = { point = [0.0, 5.9, 0.0], axis = [0.0, 0.0, 1.0], angle = -57.29577951308232 } }]
[output]
every = 1000
history = ["strip.xmax"]
"#;
    let case =
        |name: &str| Case::text(name, scene).oracle(value("strip.xmax.ux", -4.885, 6e-3, "100 and 400 increments"));
    vec![
        case("40 increments").must_run(),
        case("10 increments").set("step.feed.increments=10").must_run(),
        case("80 increments").set("step.feed.increments=80").must_run(),
        case("100 increments").set("step.feed.increments=100").must_run().slow(),
        case("lagrange").set("contact.nip.method=lagrange"),
        case("uzawa").set("contact.nip.method=uzawa"),
        case("penalty=0.1").set("contact.nip.penalty=0.1").slow(),
    ]
}

/// Two blocks on each other on a plate.
const BLOCKS: &str = r#"[body.A]
material = "m"
element = "hex8"
block = { box = { origin = [1.0, -1.0, 0.0], size = [3.0, 3.0, 1.0] }, elements = [4, 4, 2] }
[body.B]
material = "m"
element = "hex8"
block = { box = { origin = [1.5, -0.5, 1.0], size = [2.0, 2.0, 1.0] }, elements = [5, 5, 2] }
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.plate]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
[contact.plate]
slave = "A.zmin"
master = "plate"
friction = 0.5
[contact.AB]
slave = "B.zmin"
master = "A.zmax"
friction = 0.5
[[step]]
name = "weight"
increments = 1
body_force = [{ body = "A", per_volume = [0.0, 0.0, -0.1] }, { body = "B", per_volume = [0.0, 0.0, -0.1] }]
[[step]]
name = "go"
increments = 10
body_force = [{ body = "A", per_volume = [0.0, 0.0, -0.1] }, { body = "B", per_volume = [0.0, 0.0, -0.1] }]
move = [{ target = "plate", MOTION }]
[output]
every = 1000
history = ["A.zmax", "B.zmax"]
"#;

/// Blocks ride on a plate: their middles go where the plate goes. They sink by their weight, 0.1 of E = 100, alone.
fn turning_plate() -> Vec<Case> {
    let turn = BLOCKS.replace("MOTION", "rotate = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 90.0 }");
    let carry = BLOCKS.replace("MOTION", "by = [3.0, 0.0, 0.0]");
    // The middles of both are at (2.5, 0.5), and go to (-0.5, 2.5).
    let turned = |name: &str| {
        let case = Case::text(name, turn.as_str());
        let to = |c: Case, body: &str| {
            c.oracle(near(&format!("{body}.zmax.ux"), -3.0, 3.0, 2e-3, "rigid turn")).oracle(near(
                &format!("{body}.zmax.uy"),
                2.0,
                3.0,
                2e-3,
                "rigid turn",
            ))
        };
        to(to(case, "A"), "B")
    };
    let carried = |name: &str| {
        Case::text(name, carry.as_str())
            .oracle(value("A.zmax.ux", 3.0, 1e-3, "rigid motion"))
            .oracle(value("B.zmax.ux", 3.0, 1e-3, "rigid motion"))
            .oracle(near("A.zmax.uy", 0.0, 3.0, 1e-3, "rigid motion"))
    };
    vec![
        turned("90 degrees in 90").set("step.go.increments=90").must_run(),
        turned("90 degrees in 30").set("step.go.increments=30").must_run(),
        turned("90 degrees in 10").must_run(),
        turned("90 degrees in 3").set("step.go.increments=3").must_run(),
        turned("90 degrees in 30, lagrange")
            .set("step.go.increments=30")
            .sets(["contact.plate.method=lagrange", "contact.AB.method=lagrange"])
            .slow(),
        carried("carried in 10").must_run(),
        carried("carried in 1").set("step.go.increments=1").must_run(),
        carried("carried in 1, lagrange")
            .set("step.go.increments=1")
            .sets(["contact.plate.method=lagrange", "contact.AB.method=lagrange"]),
        carried("carried in 1000").set("step.go.increments=1000").must_run().slow().limit(400),
    ]
}

/// Rollers.
fn rolling() -> Vec<Case> {
    let free = r#"[body.pad]
material = "rubber"
element = "hex8-fbar"
block = { box = { size = [40.0, 10.0, 10.0] }, elements = [20, 5, 5] }
[material.rubber]
model = "neo-hookean"
young = 6.0
poisson = 0.49
[tool.roller]
cylinder = { point = [12.0, 0.0, 20.0], axis = [0.0, 1.0, 0.0], radius = 10.0 }
[contact.tread]
slave = "pad.zmax"
master = "roller"
friction = 0.5
[[step]]
name = "press"
increments = 5
fix = [{ set = "pad.zmin" }]
force = [{ target = "roller", total = [0.0, 0.0, -60.0], directions = "z" }]
[[step]]
name = "roll"
increments = 20
fix = [{ set = "pad.zmin" }]
force = [{ target = "roller", total = [0.0, 0.0, -60.0], directions = "xz" }]
move = [{ target = "roller", rotate = { point = [12.0, 0.0, 20.0], axis = [0.0, 1.0, 0.0], angle = 57.29577951308232 } }]
[output]
every = 1000
history = ["pad.zmin"]
"#;
    let carter = r#"[body.slab]
material = "m"
element = "hex8-fbar"
plane_strain = true
block = { box = { origin = [-18.5, -14.0, 0.0], size = [40.0, 14.0, 0.5] }, elements = [320, 24, 1], grading = [1.0, 0.05, 1.0] }
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.49
[tool.roller]
cylinder = { point = [0.0, 50.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 50.0 }
[contact.c]
slave = "slab.ymax"
master = "roller"
friction = 0.3
[[step]]
name = "press"
increments = 5
fix = [{ set = "slab.ymin" }]
force = [{ target = "roller", total = [0.0, -10.335546300795476, 0.0], directions = "y" }]
[[step]]
name = "pull"
increments = 5
fix = [{ set = "slab.ymin" }]
force = [{ target = "roller", total = [1.5503319451193214, -10.335546300795476, 0.0], directions = "xy" }]
[[step]]
name = "roll"
increments = 24
fix = [{ set = "slab.ymin" }]
force = [{ target = "roller", total = [1.5503319451193214, -10.335546300795476, 0.0], directions = "xy" }]
move = [{ target = "roller", rotate = { point = [0.0, 50.0, 0.0], axis = [0.0, 0.0, 1.0], angle = -3.437746770784939 } }]
[output]
every = 1000
history = ["slab.ymin"]
"#;
    vec![
        Case::text("a free roller on rubber", free)
            .oracle(near("roller.ux", 9.885, 9.885, 3e-3, "penalty=4"))
            .oracle(balance(&["roller", "pad.zmin"], 1e-8))
            .must_run()
            .limit(300),
        // Carter's creep is 1.757e-3 of the way of 3, and the pull moves the roller by less than 1e-2.
        Case::text("Carter's roller", carter)
            .oracle(near("roller.ux", 3.0, 3.0, 1e-2, "rolling without slip"))
            .oracle(balance(&["roller", "slab.ymin"], 1e-8))
            .must_run()
            .slow()
            .limit(300),
        Case::text("Carter's roller, lagrange", carter)
            .set("contact.c.method=lagrange")
            .oracle(near("roller.ux", 3.0, 3.0, 1e-2, "rolling without slip"))
            .slow()
            .limit(300),
    ]
}

/// mu = 0, 1e-12, 1, 5, 100.
fn coefficients() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        let slab = |mu: &str| {
            Case::text(format!("slab, mu = {mu}, {method}"), SLAB)
                .quick_if(method == METHODS[0] || mu == "100.0")
                .set(format!("contact.c.friction={mu}"))
                // Where all sticks no node may lift off: little shear.
                .set(if mu == "100.0" { "step.draw.move.0.by=[0.1, 0, 0]" } else { "step.draw.move.0.by=[0.5, 0, 0]" })
                .set(format!("contact.c.method={method}"))
                .oracle(balance(&["t", "b.zmin"], 1e-8))
        };
        let some = if method == "penalty" { 3e-2 } else { 1e-6 };
        let base = sphere("mu = 0", [4, 4, 2], 2, 2).set("contact.top.friction=0.0");
        cases.extend([
            slab("0.0").oracle(near("t.fx", 0.0, 1.0, 1e-9, "no friction")),
            slab("1e-12").oracle(near("t.fx/t.fz", 0.0, 1.0, 2e-12, "Coulomb")),
            // Drawn on until all slips: 20 degrees of shear at 0.3.
            slab("0.05").oracle(near("t.fx/t.fz", -0.05, 0.05, 1e-6, "Coulomb")),
            slab("100.0").oracle(same("b.zmin.fx", glued([0.1, 0.0, 0.0]), some, GLUED)),
            slab("100.0")
                .named(&format!("slab, mu = 100.0, in one increment, {method}"))
                .sets(["step.press.increments=1", "step.draw.increments=1"])
                .oracle(same("b.zmin.fx", glued([0.1, 0.0, 0.0]), some, GLUED)),
        ]);
        for mu in ["1e-12", "1.0", "5.0", "100.0"] {
            let case = sphere(format!("sphere, mu = {mu}, {method}"), [4, 4, 2], 2, 2)
                .set(format!("contact.top.friction={mu}"))
                .oracle(balance(&["cap", "block.bottom"], 1e-8));
            let tolerance = if method == "penalty" { 3e-2 } else { 1e-6 };
            let other = if method == "lagrange" { "augmented-lagrangian" } else { "lagrange" };
            let reference = case.clone().set(format!("contact.top.method={other}"));
            let case = case.set(format!("contact.top.method={method}"));
            cases.push(if mu == "1e-12" {
                case.oracle(same("cap.fz", base.clone().set(format!("contact.top.method={method}")), 1e-9, "mu = 0"))
            } else {
                case.oracle(same("cap.fx", reference, tolerance, &format!("method={other}"))).slow()
            });
        }
    }
    cases
}

/// A block under gravity that leans: it stays while the tangent of the slope is below mu, and has no equilibrium above.
fn a_block_on_a_slope() -> Vec<Case> {
    let scene = |tangent: f64| {
        format!(
            r#"[body.b]
material = "m"
element = "hex8"
block = {{ box = {{ size = [4.0, 4.0, 1.0] }}, elements = [4, 4, 2] }}
[material.m]
model = "neo-hookean"
young = 1000.0
poisson = 0.3
[tool.floor]
plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
[contact.c]
slave = "b.zmin"
master = "floor"
friction = 0.5
[[step]]
name = "weight"
increments = 1
body_force = [{{ body = "b", per_volume = [0.0, 0.0, -1.0] }}]
[[step]]
name = "lean"
increments = 4
body_force = [{{ body = "b", per_volume = [{tangent:?}, 0.0, -1.0] }}]
[output]
every = 1000
history = ["b.zmax"]
"#
        )
    };
    let mut cases = Vec::new();
    for method in METHODS {
        let set = |case: Case| case.set(format!("contact.c.method={method}"));
        cases.push(
            set(Case::text(format!("at 0.9 of the limit, {method}"), scene(0.45)))
                .oracle(value("floor.fx", -7.2, 1e-6, "weight"))
                .oracle(value("floor.fz", 16.0, 1e-6, "weight"))
                .oracle(near("b.zmax.ux", 0.0, 1.0, 1e-2, "it stays")),
        );
        cases.push(set(Case::text(format!("at 1.1 of the limit, {method}"), scene(0.55))).must_be_refused(&[]));
    }
    cases
}

/// A block that is dragged over a plate by one side, pressed by its weight: the force is mu times the weight.
fn a_block_that_slides() -> Vec<Case> {
    let scene = r#"[body.b]
material = "m"
element = "hex8"
block = { box = { size = [4.0, 4.0, 1.0] }, elements = [4, 4, 2] }
[material.m]
model = "neo-hookean"
young = 1000.0
poisson = 0.3
[tool.floor]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
[contact.c]
slave = "b.zmin"
master = "floor"
friction = 0.3
[[step]]
name = "weight"
increments = 1
fix = [{ set = "b.xmax", directions = "xy" }]
body_force = [{ body = "b", per_volume = [0.0, 0.0, -0.01] }]
[[step]]
name = "drag"
increments = 5
body_force = [{ body = "b", per_volume = [0.0, 0.0, -0.01] }]
move = [{ target = "b.xmax", by = [2.0, 0.0, 0.0], directions = "xy" }]
[output]
every = 1000
history = ["b.xmax"]
"#;
    let mut cases = Vec::new();
    for method in METHODS {
        for increments in [1, 5, 50] {
            cases.push(
                Case::text(format!("{method}, {increments}"), scene)
                    .set(format!("contact.c.method={method}"))
                    .set(format!("step.drag.increments={increments}"))
                    .oracle(value("b.xmax.fx", 0.3 * 0.16, 1e-4, "mu times the weight"))
                    .oracle(value("floor.fz", 0.16, 1e-6, "weight")),
            );
        }
    }
    cases
}

/// A belt 0.01 thick over a quarter of a drum of 10, pulled: its tensions are as exp(mu pi / 2).
fn thin_belt() -> Vec<Case> {
    let scene = r#"[body.belt]
material = "m"
element = "hex8"
plane_strain = true
block = { sector = { radii = [10.0, 10.01], angles = [0.0, 90.0], length = 1.0 }, elements = [1, 90, 1] }
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.0
[tool.drum]
cylinder = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 10.0 }
[contact.c]
slave = "belt.rmin"
master = "drum"
friction = 0.3
[[step]]
name = "pull"
increments = 40
fix = [{ set = "belt.amax", directions = "x" }]
move = [{ target = "belt.amin", by = [0.0, -0.2, 0.0], directions = "y" }]
[output]
every = 1000
history = ["belt.amin", "belt.amax"]
"#;
    let case = |name: &str| {
        Case::text(name, scene)
            .oracle(value(
                "belt.amin.fy/belt.amax.fx",
                (0.3 * std::f64::consts::FRAC_PI_2).exp(),
                5e-3,
                "Euler and Eytelwein",
            ))
            .slow()
            .limit(300)
    };
    vec![
        case("40 increments").must_run(),
        case("lagrange, 10 increments").sets(["contact.c.method=lagrange", "step.pull.increments=10"]),
        case("uzawa, 10 increments").sets(["contact.c.method=uzawa", "step.pull.increments=10"]),
    ]
}

/// Blocks that meet over a slope of 15 degrees or a step of 0.001, held by a force and by friction.
fn slopes_in_two_passes() -> Vec<Case> {
    let slope = 15f64.to_radians().tan();
    let wedge =
        crate::common::msh::block([16, 4, 4], false, |[x, y, z]| [8.0 * x, 2.0 * y, z * (2.0 + slope * 8.0 * x)]);
    let upper = crate::common::msh::block([10, 4, 5], false, |[x, y, z]| {
        let (x, y) = (2.0 + 4.0 * x, 0.25 + 1.5 * y);
        [x, y, (1.0 - z) * (2.0 + slope * x) + 6.0 * z]
    });
    let bodies = r#"[body.wedge]
mesh = "wedge.msh"
material = "m"
element = "hex8"
[body.upper]
mesh = "upper.msh"
material = "m"
element = "hex8"
[material.m]
model = "hooke"
young = 10000.0
poisson = 0.3
[contact.slope]
slave = "upper.zmin"
master = "wedge.zmax"
friction = 0.2
discretization = "two-pass"
"#;
    let plain = format!(
        "{bodies}
[[step]]
name = \"load\"
increments = 2
fix = [{{ set = \"upper.xmin\", directions = \"xy\" }}, {{ set = \"wedge.zmin\" }}]
force = [{{ target = \"upper.zmax\", total = [0.0, 0.0, -10.0] }}]
[output]
every = 1000
history = [\"upper.xmin\", \"wedge.zmin\"]
"
    );
    let floor = format!(
        "{bodies}
[tool.floor]
plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
[contact.floor]
slave = \"wedge.zmin\"
master = \"floor\"
friction = 0.1
[[step]]
name = \"load\"
increments = 2
fix = [{{ set = \"upper.xmin\", directions = \"xy\" }}, {{ set = \"wedge.xmax\", directions = \"xy\" }}]
force = [{{ target = \"upper.zmax\", total = [0, 0, -0.1] }}]
[[step]]
name = \"push\"
increments = 10
fix = [{{ set = \"upper.xmin\", directions = \"xy\" }}, {{ set = \"wedge.xmax\", directions = \"y\" }}]
force = [{{ target = \"upper.zmax\", total = [0.0, 0.0, -10.0] }}]
move = [{{ target = \"wedge.xmax\", by = [-0.2, 0.0, 0.0], directions = \"x\" }}]
[[step]]
name = \"back\"
increments = 20
fix = [{{ set = \"upper.xmin\", directions = \"xy\" }}, {{ set = \"wedge.xmax\", directions = \"y\" }}]
force = [{{ target = \"upper.zmax\", total = [0.0, 0.0, -10.0] }}]
move = [{{ target = \"wedge.xmax\", by = [0.3, 0.0, 0.0], directions = \"x\" }}]
[output]
every = 1000
history = [\"upper.xmin\", \"wedge.xmax\"]
"
    );
    let step = r#"[body.lower]
material = "m"
block = { box = { size = [8.0, 2.0, 2.0] }, elements = [16, 4, 4] }
[body.upper]
material = "m"
block = { box = { origin = [2, 0.25, 2.001], size = [4.0, 1.5, 4.0] }, elements = [10, 4, 5] }
[material.m]
model = "hooke"
young = 10000.0
poisson = 0.3
[contact.c]
slave = "upper.zmin"
master = "lower.zmax"
friction = 0.2
discretization = "two-pass"
[[step]]
name = "load"
increments = 2
fix = [{ set = "lower.zmin" }, { set = "upper.zmax", directions = "xy" }]
force = [{ target = "upper.zmax", total = [0.0, 0.0, -48.0] }]
[output]
every = 1000
history = ["upper.zmax", "lower.zmin"]
"#;
    let meshes = |case: Case| case.file("wedge.msh", wedge.as_str()).file("upper.msh", upper.as_str());
    // The wedge bears the force of 10 with both passes and with one; the slope takes what friction leaves sideways.
    let plain = meshes(Case::text("wedge", plain)).oracle(value("wedge.zmin.fz", 10.0, 1e-6, "the force"));
    let one_pass = |case: &Case| case.clone().set("contact.slope.discretization=one-pass");
    let floor = meshes(Case::text("wedge on a floor", floor));
    // Slides up the slope, then down: forces of the wedge by Coulomb at both faces.
    vec![
        plain.clone().must_run(),
        one_pass(&plain).named("wedge, one pass").must_run(),
        floor.clone().oracle(value("floor.fz", 10.0, 1e-6, "the force")).must_run(),
        one_pass(&floor).named("wedge on a floor, one pass").oracle(value("floor.fz", 10.0, 1e-6, "the force")).slow(),
        Case::text("a force across a gap of 0.001", step).oracle(value("lower.zmin.fz", 48.0, 1e-6, "the force")),
        Case::text("a force across no gap", step.replace("2.001", "2.0")).oracle(value(
            "lower.zmin.fz",
            48.0,
            1e-6,
            "the force",
        )),
    ]
}

/// Two cubes of 1 cm and 2e10 Pa on each other, turned about y, pressed together by 10 N along what was z.
fn tilted_cubes() -> Vec<Case> {
    let mut cases = Vec::new();
    for degrees in [0.0f64, 15.0, 45.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let turned = |x: f64, y: f64, z: f64| [0.01 * (c * x + s * z), 0.01 * y, 0.01 * (c * z - s * x)];
        let lower = crate::common::msh::block([3, 3, 3], false, |[x, y, z]| turned(x, y, z));
        let upper = crate::common::msh::block([2, 2, 2], false, |[x, y, z]| turned(x, y, 1.0 + z));
        for discretization in ["one-pass", "two-pass"] {
            for how in ["", "smoothing = \"facet\"", "transfer = \"variational\""] {
                let text = format!(
                    r#"[body.lower]
mesh = "lower.msh"
material = "a"
element = "hex8"
[body.upper]
mesh = "upper.msh"
material = "b"
element = "hex8"
[material.a]
model = "neo-hookean"
young = 1.5e10
poisson = 0.2
[material.b]
model = "neo-hookean"
young = 2e10
poisson = 0.4
[contact.c]
slave = "upper.zmin"
master = "lower.zmax"
friction = 0.3
discretization = "{discretization}"
{how}
[[step]]
increments = 2
fix = [{{ set = "lower.zmin" }}]
force = [{{ target = "upper.zmax", total = [{:?}, 0.0, {:?}] }}]
[output]
every = 1000
history = ["lower.zmin", "upper.zmax"]
"#,
                    -10.0 * s,
                    -10.0 * c
                );
                let what = if how.is_empty() { "patches" } else { how };
                let case = Case::text(format!("{degrees} degrees, {discretization}, {what}"), text)
                    .file("lower.msh", lower.as_str())
                    .file("upper.msh", upper.as_str())
                    .oracle(value("lower.zmin.fz", 10.0 * c, 1e-6, "the force"))
                    .oracle(near("lower.zmin.fx", 10.0 * s, 10.0, 1e-6, "the force"))
                    .must_run();
                cases.push(if degrees == 15.0 { case } else { case.slow() });
            }
        }
    }
    cases
}
