//! Numbers of any size: lengths, moduli, offsets, vectors, tolerances.

use crate::case::Case;
use crate::oracle::{balance, same, scaled, value};
use crate::scenes::{METHODS, sphere};

family!(units, offsets, afar, vectors, tolerances, aspect_ratios, thin_sheets, stiffness_ratios, small_forces);

/// A sphere on a block: all lengths times `length` with an offset, E = 100 times `modulus`.
pub fn ball(name: &str, length: f64, modulus: f64, offset: f64) -> Case {
    let l = |x: f64| x * length;
    let at = |[x, y, z]: [f64; 3]| [l(x + offset), l(y + offset), l(z + offset)];
    Case::text(
        name,
        format!(
            r#"[body.block]
material = "rubber"
element = "hex8"
block = {{ box = {{ origin = {:?}, size = {:?} }}, elements = [4, 4, 2] }}
[material.rubber]
model = "neo-hookean"
young = {:?}
poisson = 0.3
[tool.cap]
sphere = {{ center = {:?}, radius = {:?} }}
[contact.top]
slave = "block.zmax"
master = "cap"
friction = 0.3
[[step]]
name = "press"
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [0.0, 0.0, {:?}] }}]
[[step]]
name = "slide"
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [{:?}, 0.0, 0.0] }}]
[output]
every = 1000
history = ["block.zmin"]
"#,
            at([-20.0, -20.0, 0.0]),
            [l(40.0), l(40.0), l(20.0)],
            100.0 * modulus,
            at([0.0, 0.0, 40.0]),
            l(20.0),
            -l(1.0),
            l(1.0),
        ),
    )
}

/// Lengths from 1e-9 to 1e9, moduli from 1e-6 to 1e18: forces go with the square of the one and with the other.
fn units() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |length: f64, modulus: f64, method: &str| {
        let set = |case: Case| case.set(format!("contact.top.method={method}"));
        let (one, times) = (set(ball("one", 1.0, 1.0, 0.0)), length * length * modulus);
        cases.push(
            set(ball(&format!("lengths times {length:e}, E times {modulus:e}, {method}"), length, modulus, 0.0))
                .oracle(scaled("cap.fx", one.clone(), times, 1e-6, "the scene in other units"))
                .oracle(scaled("cap.fz", one, times, 1e-6, "the scene in other units"))
                .must_run()
                .quick_if(method == METHODS[0]),
        );
    };
    for length in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9] {
        add(length, 1.0, METHODS[0]);
    }
    for modulus in [1e-8, 1e-4, 1e4, 1e8, 1e16] {
        add(1.0, modulus, METHODS[0]);
    }
    for method in METHODS {
        add(1e-9, 1e16, method);
        add(1e9, 1e-8, method);
        add(1e-9, 1e-8, method);
        add(1e9, 1e16, method);
    }
    cases
}

/// Everything 1 to 1e9 sizes of the block away from the origin.
fn offsets() -> Vec<Case> {
    let one = |quantity| same(quantity, ball("one", 1.0, 1.0, 0.0), 1e-4, "the scene at the origin");
    (0..=9)
        .map(|power| {
            let case = ball(&format!("1e{power} sizes"), 1.0, 1.0, 40.0 * 10f64.powi(power));
            let case = case.oracle(one("cap.fx")).oracle(one("cap.fz")).oracle(balance(&["cap", "block.zmin"], 1e-6));
            if power <= 2 { case.must_run() } else { case }
        })
        .chain([roller(1e5), roller(1e3), roller(1e7)])
        .chain([4, 8].map(patches))
        .collect()
}

/// Tools on a block of edges of 10 that are described by numbers up to 1e9: a point far along a plane, an axis or a profile does
/// not matter; a sphere of a large radius is nearly a plane; a plate may be meshed, and a tool come, from far away.
fn afar() -> Vec<Case> {
    let scene = |tool: &str, step: &str| {
        format!(
            r#"[body.block]
material = "rubber"
element = "hex8"
block = {{ box = {{ origin = [-20.0, -20.0, 0.0], size = [40.0, 40.0, 20.0] }}, elements = [4, 4, 2] }}
[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.cap]
{tool}
[contact.top]
slave = "block.zmax"
master = "cap"
friction = 0.3
{step}
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [0.0, 0.0, -1.0] }}]
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [1.0, 0.0, 0.0] }}]
[output]
every = 1000
history = ["block.zmin"]
"#
        )
    };
    const POINTS: &str = "points = [[-30.0, 50.0], [-10.0, 20.0], [10.0, 20.0], [30.0, 50.0]], fillets = 5.0";
    /// A tool, where its point is, and the way along it.
    const ALONG: [(&str, &str, [f64; 3], [f64; 3]); 6] = [
        ("plane", "plane = { point = POINT, normal = [0.0, 0.0, -1.0] }", [0.0, 0.0, 20.0], [1.0, 1.0, 0.0]),
        (
            "slanted plane",
            "plane = { point = POINT, normal = [0.0, 0.125, -1.0] }",
            [0.0, 0.0, 20.0],
            [0.0, 1.0, 0.125],
        ),
        (
            "cylinder",
            "cylinder = { point = POINT, axis = [0.0, 1.0, 0.0], radius = 20.0 }",
            [0.0, 0.0, 40.0],
            [0.0, 1.0, 0.0],
        ),
        (
            "slanted cylinder",
            "cylinder = { point = POINT, axis = [0.6, 0.8, 0.0], radius = 20.0 }",
            [0.0, 0.0, 40.0],
            [0.6, 0.8, 0.0],
        ),
        (
            "profile",
            "profile = { PROFILE, extrude = { origin = POINT, x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] } }",
            [0.0; 3],
            [0.0, 1.0, 0.0],
        ),
        (
            "slanted profile",
            "profile = { PROFILE, extrude = { origin = POINT, x = [0.8, -0.6, 0.0], y = [0.0, 0.0, 1.0] } }",
            [0.0; 3],
            [0.6, 0.8, 0.0],
        ),
    ];
    let flat = "plane = { point = [0.0, 0.0, 20.0], normal = [0.0, 0.0, -1.0] }";
    let plate = |d: f64| crate::common::msh::surface(3, |s, t| [d * (2.0 * t - 1.0), d * (2.0 * s - 1.0), 20.0]);
    let mut cases = Vec::new();
    let mut add = |case: Case, one: Case, tolerance: f64, source: &str| {
        cases.push(
            case.oracle(same("cap.fx", one.clone(), tolerance, source))
                .oracle(same("cap.fz", one, tolerance, source))
                .oracle(balance(&["cap", "block.zmin"], 1e-6)),
        );
    };
    for power in [3, 5, 6, 7, 8, 9] {
        let d = 10f64.powi(power);
        for (name, tool, at, way) in ALONG {
            let tool = |d: f64| {
                let point: [f64; 3] = std::array::from_fn(|k| at[k] + way[k] * d);
                tool.replace("POINT", &format!("{point:?}")).replace("PROFILE", POINTS)
            };
            let one = Case::text("one", scene(&tool(0.0), ""));
            let case = Case::text(format!("{name}, point 1e{power} along it"), scene(&tool(d), "")).must_run();
            add(case.quick_if(power == 8), one, 1e-6, "the point at the origin");
        }
        let case = |name: &str, tool: String| {
            let case = Case::text(format!("{name} of 1e{power}"), scene(&tool, ""));
            if power <= 6 { case.must_run() } else { case }
        };
        let one = || Case::text("one", scene(flat, ""));
        let middle = 20.0 + d;
        if power > 3 {
            // Off the plane by 400 / R at the most, for a press of 1.
            let ball = format!("sphere = {{ center = [0.0, 0.0, {middle:?}], radius = {d:?} }}");
            add(case("sphere", ball).quick_if(power == 8), one(), 400.0 / d + 1e-6, "a plane");
            let roll =
                format!("cylinder = {{ point = [0.0, 0.0, {middle:?}], axis = [0.0, 1.0, 0.0], radius = {d:?} }}");
            add(case("cylinder", roll), one(), 400.0 / d + 1e-6, "a plane");
        }
        let mesh = "mesh = \"plate.msh\"";
        add(case("plate", mesh.into()).file("plate.msh", plate(d)).quick_if(power == 8), one(), 1e-6, "a plane");
        // Brought in by the first step.
        let come = format!(
            "[[step]]\nincrements = 1\nfix = [{{ set = \"block.zmin\" }}]\nmove = [{{ target = \"cap\", by = [-{d:?}, 0.0, 0.0] }}]"
        );
        let ball = |x: f64| format!("sphere = {{ center = [{x:?}, 0.0, 40.0], radius = 20.0 }}");
        let from = Case::text(format!("sphere that comes from 1e{power}"), scene(&ball(d), &come));
        let from = if power <= 6 { from.must_run() } else { from };
        add(from, Case::text("one", scene(&ball(0.0), "")), 1e-6, "where it comes to");
    }
    cases
}

/// A roller that a force presses, so many sizes of the pad away from the origin.
fn roller(sizes: f64) -> Case {
    let scene = |o: f64| {
        format!(
            r#"[body.pad]
material = "rubber"
element = "hex8-fbar"
block = {{ box = {{ origin = [{o:?}, {o:?}, {o:?}], size = [40.0, 10.0, 10.0] }}, elements = [6, 2, 2] }}
[material.rubber]
model = "neo-hookean"
young = 6.0
poisson = 0.49
[tool.roller]
cylinder = {{ point = {:?}, axis = [0.0, 1.0, 0.0], radius = 10.0 }}
[contact.tread]
slave = "pad.zmax"
master = "roller"
friction = 0.5
[[step]]
name = "press"
increments = 2
fix = [{{ set = "pad.zmin" }}]
force = [{{ target = "roller", total = [0.0, 0.0, -60.0], directions = "z" }}]
[[step]]
name = "drag"
increments = 4
fix = [{{ set = "pad.zmin" }}]
force = [{{ target = "roller", total = [0.0, 0.0, -60.0], directions = "z" }}]
move = [{{ target = "roller", by = [10.0, 0.0, 0.0] }}]
[output]
every = 1000
history = ["pad.zmin"]
"#,
            [o + 12.0, o, o + 20.0]
        )
    };
    let at_origin = Case::text("one", scene(0.0));
    Case::text(format!("a roller, {sizes:e} sizes"), scene(40.0 * sizes))
        .oracle(same("roller.fx", at_origin.clone(), 1e-4, "the scene at the origin"))
        .oracle(same("roller.uz", at_origin, 1e-4, "the scene at the origin"))
}

/// A cap of Nagata patches from a mesh, 10^`power` sizes away.
fn patches(power: i32) -> Case {
    let scene = |o: f64| {
        let cap = crate::common::msh::surface(8, |s, t| {
            // Normals down: the second direction is turned over.
            let (x, y) = (20.0 * t - 10.0, 20.0 * s - 10.0);
            [x + o, y + o, 40.0 - (400.0 - x * x - y * y).sqrt() + o]
        });
        let text = format!(
            r#"[body.block]
material = "rubber"
element = "hex8"
block = {{ box = {{ origin = {:?}, size = [40.0, 40.0, 20.0] }}, elements = [4, 4, 2] }}
[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.cap]
mesh = "cap.msh"
[contact.top]
slave = "block.zmax"
master = "cap"
friction = 0.3
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [0.0, 0.0, -1.0] }}]
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [1.0, 0.0, 0.0] }}]
[output]
every = 1000
history = ["block.zmin"]
"#,
            [o - 20.0, o - 20.0, o]
        );
        (text, cap)
    };
    let (at_origin, cap) = scene(0.0);
    let one = Case::text("one", at_origin).file("cap.msh", cap);
    let (text, cap) = scene(40.0 * 10f64.powi(power));
    Case::text(format!("patches, 1e{power} sizes"), text).file("cap.msh", cap).oracle(same(
        "cap.fx",
        one,
        1e-4,
        "the scene at the origin",
    ))
}

/// Normals and axes of any length.
fn vectors() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [-320, -300, -160, -155, -100, 100, 155, 160, 200, 300, 308] {
        let size = format!("1e{power}");
        let is_quick = [-160, 155, 308].contains(&power);
        let plane = Case::text(format!("normal of {size}"), crate::scenes::SLAB)
            .set(format!("tool.t.plane.normal=[0.0, 0.0, -{size}]"))
            .oracle(same("t.fx", Case::text("one", crate::scenes::SLAB), 1e-9, "a unit vector"));
        cases.push(plane.quick_if(is_quick));
        let scene = crate::scenes::SLAB
            .replace(
                "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
                "cylinder = { point = [2.0, 0.0, 3.5], axis = [0.0, 1.0, 0.0], radius = 1.5 }",
            )
            .replace(
                "by = [0.5, 0.0, 0.0]",
                "rotate = { point = [2.0, 0.0, 3.4], axis = [0.0, 1.0, 0.0], angle = 10.0 }",
            );
        let one = Case::text("one", scene.as_str());
        cases.push(
            Case::text(format!("axis of {size}"), scene.as_str())
                .set(format!("tool.t.cylinder.axis=[0.0, {size}, 0.0]"))
                .oracle(same("t.fx", one.clone(), 1e-9, "a unit vector"))
                .quick_if(is_quick),
        );
        cases.push(
            Case::text(format!("axis of turning of {size}"), scene.as_str())
                .set(format!("step.draw.move.0.rotate.axis=[0.0, {size}, 0.0]"))
                .oracle(same("t.fx", one, 1e-9, "a unit vector"))
                .quick_if(is_quick),
        );
    }
    cases
}

/// `solver.tolerance` from 1e-14 to just below 1e-2.
fn tolerances() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        for (tolerance, error) in [("1e-14", 1e-6), ("1e-12", 1e-6), ("1e-6", 1e-4), ("1e-3", 1e-2), ("0.0099", 0.05)] {
            let case =
                sphere(format!("{tolerance}, {method}"), [4, 4, 2], 2, 4).set(format!("contact.top.method={method}"));
            let reference = sphere("reference", [4, 4, 2], 2, 4).set(format!("contact.top.method={method}"));
            cases.push(
                case.set(format!("solver.tolerance={tolerance}"))
                    .oracle(same("cap.fx", reference, error, "tolerance=1e-10"))
                    .oracle(balance(&["cap", "block.bottom"], error))
                    .quick_if(method == METHODS[0]),
            );
        }
    }
    cases
}

/// Bars of flat elements, 10:1 to 500,000:1, and of needles, pressed hard and by so little that a flat one hardly resists
/// as much as its own forces round to.
fn aspect_ratios() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["hex8", "hex8-fbar", "hex8-sri", "hex8-eas"] {
        for aspect in [1e1, 1e2, 1e3, 1e4, 5e5] {
            for (height, stretch) in [2.0 / aspect, 2.0 * aspect].into_iter().flat_map(|h| [(h, 0.8), (h, 0.999)]) {
                let scene = crate::scenes::BAR
                    .replace("size = [2.0, 2.0, 2.0]", &format!("size = [2.0, 2.0, {height:?}]"))
                    .replace("point = [0.0, 0.0, 2.0]", &format!("point = [0.0, 0.0, {height:?}]"))
                    .replace("by = [0.0, 0.0, -0.4]", &format!("by = [0.0, 0.0, {:?}]", (stretch - 1.0) * height));
                let name = format!("{element}, height over width {:e}, stretch {stretch}", height / 2.0);
                let case = Case::text(name, scene).set(format!("body.b.element={element}")).oracle(value(
                    "p.fz",
                    crate::scenes::bar_force(10.0, 4.0, stretch),
                    1e-6,
                    "closed form",
                ));
                let case = if aspect <= 1e3 { case.must_run() } else { case };
                cases.push(case.quick_if(element == "hex8"));
            }
        }
    }
    cases
}

/// Cantilevers of thickness over length 1e-1 to 1e-4, bent by a smooth roller at 8 of 10 by 0.01.
fn thin_sheets() -> Vec<Case> {
    let mut cases = Vec::new();
    for element in ["hex8-eas", "hex8-sri", "hex8-fbar"] {
        for thickness in [0.5f64, 0.1, 1e-2, 1e-3] {
            let scene = format!(
                r#"[body.b]
material = "m"
element = "{element}"
plane_strain = true
block = {{ box = {{ size = [10.0, {thickness:?}, 1.0] }}, elements = [20, 1, 1] }}
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.r]
cylinder = {{ point = [8.0, {:?}, 0.0], axis = [0.0, 0.0, 1.0], radius = 0.5 }}
[contact.c]
slave = "b.ymax"
master = "r"
[[step]]
increments = 4
fix = [{{ set = "b.xmin" }}]
move = [{{ target = "r", by = [0.0, -0.01, 0.0] }}]
[output]
every = 1000
history = ["b.xmin"]
"#,
                thickness + 0.5
            );
            let beam = -3.0 * (1000.0 / 0.91) * (thickness.powi(3) / 12.0) * 0.01 / 512.0;
            let case =
                Case::text(format!("{element}, {:e}", thickness / 10.0), scene).oracle(balance(&["r", "b.xmin"], 1e-6));
            // The others lock in bending with one layer, which is said in docs/trouble.md: only balance and contact.
            let case = if element == "hex8-eas" {
                case.oracle(value("r.fy", beam, 0.03, "3 E I d / a^3"))
            } else {
                case.oracle(crate::oracle::near("c.active", 1.0, 1.0, 0.0, "one node"))
            };
            cases.push(case.quick_if(element == "hex8-eas"));
        }
    }
    cases
}

/// Tolerance at a ratio of stiffness: the stiff body is strained by so much less than the soft one, here by a tenth, and
/// strains are rounded in the size of 1.
pub fn rounded(ratio: f64) -> f64 {
    f64::max(1e-6, 10.0 * f64::EPSILON * f64::max(ratio, 1.0 / ratio))
}

/// Two bars on each other, one up to 1e12 times stiffer than the other.
fn stiffness_ratios() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in METHODS {
        for power in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
            let upper = 100.0 * 10f64.powi(power);
            // The automatic penalty is a share of the stiffness of the softer side: the two together give way by some percent.
            let tolerance = if method == "penalty" { 5e-2 } else { rounded(10f64.powi(power)) };
            for friction in [0.0, 0.3] {
                let case = Case::text(
                    format!("upper 1e{power} times lower, friction {friction}, {method}"),
                    crate::scenes::STACK,
                )
                .set(format!("material.b.young={upper:?}"))
                .set(format!("contact.c.friction={friction:?}"))
                .set(format!("contact.c.method={method}"))
                .oracle(value(
                    "upper.zmax.fz",
                    crate::scenes::stack_force(100.0, upper, 0.3, 0.2),
                    tolerance,
                    "closed form",
                ))
                .oracle(value(
                    "lower.zmin.fz",
                    -crate::scenes::stack_force(100.0, upper, 0.3, 0.2),
                    tolerance,
                    "closed form",
                ));
                cases.push(case.quick_if(friction > 0.0 && method == METHODS[0]));
            }
        }
    }
    for discretization in ["two-pass", "node-to-node", "segment"] {
        for upper in ["1e-4", "1e8", "1e14"] {
            let force = crate::scenes::stack_force(100.0, upper.parse().unwrap(), 0.3, 0.2);
            cases.push(
                Case::text(format!("E = 100 and {upper}, {discretization}"), crate::scenes::STACK)
                    .set(format!("material.b.young={upper}"))
                    .set(format!("contact.c.discretization={discretization}"))
                    .oracle(value("upper.zmax.fz", force, rounded(1e12), "closed form"))
                    .oracle(value("lower.zmin.fz", -force, rounded(1e12), "closed form")),
            );
        }
    }
    cases
}

/// A bar of E = 10 and 2 x 2 x 2 under forces down to 1e-30, beside one under 8.
fn small_forces() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [0, -3, -6, -9, -12, -15, -30] {
        for how in ["tool", "force", "pressure", "weight"] {
            let total = 10f64.powi(power);
            let load = match how {
                "tool" => format!("{{ target = \"q\", total = [0.0, 0.0, -{total:?}], directions = \"z\" }}]"),
                "force" => format!("{{ target = \"c.zmax\", total = [0.0, 0.0, -{total:?}] }}]"),
                "pressure" => format!("]\npressure = [{{ set = \"c.zmax\", value = {:?} }}]", total / 4.0),
                _ => format!("]\nbody_force = [{{ body = \"c\", per_volume = [0.0, 0.0, -{:?}] }}]", total / 8.0),
            };
            let scene = format!(
                r#"{}[body.c]
material = "m"
element = "hex8"
symmetry = ["zmin"]
block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
[tool.q]
plane = {{ point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }}
[contact.d]
slave = "c.zmax"
master = "q"
[[step]]
increments = 2
fix = [{{ set = "c.xmin", directions = "x" }}, {{ set = "c.ymin", directions = "y" }}]
force = [{{ target = "p", total = [0.0, 0.0, -8.0], directions = "z" }}, {load}
[output]
every = 1000
history = ["c.zmin"]
"#,
                crate::scenes::BAR.split("[[step]]").next().unwrap()
            );
            // The pressure acts on what the bar widens to.
            let borne = if how == "pressure" { total * (1.0 + 0.3 * total / 20.0) } else { total };
            let tolerance = if how == "pressure" { 1e-6 + 0.01 * total } else { 1e-6 };
            let case = Case::text(format!("{how} of {total:e}"), scene)
                .oracle(value("c.zmin.fz", borne, tolerance, "equilibrium"))
                .oracle(value("p.fz", -8.0, 1e-6, "equilibrium"));
            let case = if power >= -3 { case.must_run() } else { case };
            cases.push(case.quick_if(how == "force" || power == -12));
        }
    }
    cases
}
