//! What no solution may do: nodes that go through a master or stay in it. Each scene is right, or refused.

mod common;

use common::stl::{rectangle, text};
use common::{Bench, assert_close, assert_small, msh};
use nagata::Vec3;

/// A block of 4 x 4 x 2 under something that comes from above, of which `master` says what it is and `how` what moves.
fn block(master: &str, how: &str) -> Bench {
    Bench::new(&format!(
        r#"
[body.b]
material = "m"
element = "hex8"
[body.b.block]
box = {{ size = [4.0, 4.0, 2.0] }}
elements = [4, 4, 2]
faces = {{ top = "zmax", bottom = "zmin" }}
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.t.{master}
[contact.c]
slave = "b.top"
master = "t"
friction = 0.3
[[step]]
name = "press"
increments = 1
{how}
[output]
history = ["b.bottom"]
"#
    ))
}

/// A closed plate of a thickness, 0.2 above the block.
fn plate(thickness: f64) -> String {
    let top = 2.2 + thickness;
    format!(
        r#"profile]
points = [[-1.0, 2.2], [5.0, 2.2], [5.0, {top}], [-1.0, {top}]]
closed = true
extrude = {{ origin = [0.0, 5.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] }}"#
    )
}

const PRESS: &str = r#"fix = [{ set = "b.bottom" }]
move = [{ target = "t", by = [0.0, 0.0, -1.0] }]"#;

/// A ball of radius 10 pressed by 12: the nodes under it must not come out above it.
#[test]
fn a_ball_does_not_pass_through_a_block_in_one_or_two_increments() {
    let bench = Bench::new(
        r#"
[body.block]
material = "rubber"
element = "hex8"
[body.block.block]
elements = [8, 8, 4]
box = { origin = [-20.0, -20.0, 0.0], size = [40.0, 40.0, 20.0] }
faces = { bottom = "zmin", top = "zmax" }
[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.cap]
sphere = { center = [0.0, 0.0, 30.0], radius = 10.0 }
[contact.top]
slave = "block.top"
master = "cap"
friction = 0.3
[[step]]
name = "press"
increments = 12
fix = [{ set = "block.bottom" }]
move = [{ target = "cap", by = [0.0, 0.0, -12.0] }]
"#,
    );
    let force = |increments: &str| {
        let run = bench.solve(1, &["--set", &format!("step.press.increments={increments}")]);
        (run.history().last("cap.fz"), run.log().contains("went through the tool `cap` (contact `top`)"))
    };
    let (exact, flagged) = force("12");
    assert!(!flagged);
    for increments in ["1", "2"] {
        let (found, flagged) = force(increments);
        assert!(flagged);
        // Friction depends on the path a little.
        assert_close(&format!("{increments} increments"), found, exact, 0.01);
    }
}

#[test]
fn a_ball_does_not_pass_through_a_sheet() {
    let bench = Bench::new(
        r#"
[body.s]
material = "m"
element = "hex8-eas"
[body.s.block]
box = { origin = [-10.0, -10.0, 0.0], size = [20.0, 20.0, 1.0] }
elements = [10, 10, 1]
faces = { rim = ["xmin", "xmax", "ymin", "ymax"] }
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
increments = 4
fix = [{ set = "s.rim" }]
move = [{ target = "ball", by = [0.0, 0.0, -6.0] }]
"#,
    );
    let force = |increments: usize| {
        bench.solve(1, &["--set", &format!("step.push.increments={increments}")]).history().last("ball.fz")
    };
    // Without friction the end does not depend on the path.
    assert_close("force", force(1), force(4), 1e-6);
}

/// Plates moved by more than their thickness in one increment: as in 16.
#[test]
fn a_closed_tool_does_not_pass_through_whatever_its_thickness() {
    for thickness in [0.3, 0.03, 1e-4] {
        let bench = block(&plate(thickness), PRESS);
        let [one, many] =
            ["1", "16"].map(|n| bench.solve(1, &["--set", &format!("step.press.increments={n}")]).history());
        assert!(one.last("c.active") == 25.0);
        assert_close("force", one.last("t.fz"), many.last("t.fz"), 0.01);
        assert_small("penetration", one.last("c.max_penetration"), 1e-9);
    }
}

/// The same on more ranks, with the same increments.
#[test]
fn ranks_see_the_same() {
    let bench = block(&plate(0.3), PRESS);
    let one = bench.solve(1, &[]);
    for ranks in [2, 3] {
        let run = bench.solve(ranks, &[]);
        let reasons =
            |log: &str| log.lines().filter(|l| l.contains("went through")).map(str::to_string).collect::<Vec<_>>();
        assert_eq!(reasons(&run.log()), reasons(&one.log()));
        assert_eq!(run.history().len(), one.history().len());
        assert_close("force", run.history().last("t.fz"), one.history().last("t.fz"), 1e-8);
    }
}

/// A sheet 0.1 thick, both sides of which are the master, under a block that goes down by 0.8 in one increment.
#[test]
fn a_body_does_not_pass_through_a_thin_sheet() {
    let bench = Bench::new(
        r#"
[body.low]
material = "m"
element = "hex8-eas"
[body.low.block]
box = { origin = [0.0, 0.0, 0.0], size = [8.0, 2.0, 0.1] }
elements = [12, 3, 1]
faces = { ends = ["xmin", "xmax"], skin = ["zmin", "zmax"] }
[body.high]
material = "m"
element = "hex8"
[body.high.block]
box = { origin = [3.1, 0.3, 0.3], size = [1.5, 1.3, 1.0] }
elements = [2, 2, 2]
faces = { bottom = "zmin", top = "zmax" }
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[contact.c]
slave = "high.bottom"
master = "low.skin"
[[step]]
name = "press"
increments = 8
fix = [{ set = "low.ends" }]
move = [{ target = "high.top", by = [0.0, 0.0, -0.8] }]
[output]
history = ["high.top"]
"#,
    );
    let run = |increments: usize| bench.solve(1, &["--set", &format!("step.press.increments={increments}")]);
    let (one, many) = (run(1), run(8));
    assert!(one.log().contains("went through `low.skin`"), "{}", one.log());
    assert_close("force", one.history().last("high.top.fz"), many.history().last("high.top.fz"), 1e-6);
}

/// Nodes that cannot give way, on a master that cannot either: the run ends, with the node, the contact and the depth.
#[test]
fn nodes_that_are_held_in_a_master_are_refused() {
    let bench = Bench::new(
        r#"
[body.low]
material = "m"
block = { box = { size = [4.0, 4.0, 1.0] }, elements = [4, 4, 1], faces = { top = "zmax", bottom = "zmin" } }
[body.high]
material = "m"
[body.high.block]
box = { origin = [1.1, 1.1, 1.1], size = [1.5, 1.5, 1.0] }
elements = [2, 2, 1]
faces = { bottom = "zmin" }
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[contact.c]
slave = "high.bottom"
master = "low.top"
[[step]]
name = "press"
increments = 1
fix = [{ set = "low.top" }, { set = "low.bottom" }]
move = [{ target = "high.bottom", by = [0.0, 0.0, -0.2] }]
"#,
    );
    // In several increments the first that are too deep are so by little.
    for increments in ["1", "3", "40"] {
        let run = bench.run(2, &["--set", &format!("step.press.increments={increments}")]);
        assert_eq!(run.code, 1, "{}", run.stdout);
        let said = &run.stderr;
        assert!(said.contains("node 1 of body `high` at (1.100000, 1.100000, 1.100000) is "), "{said}");
        assert!(said.contains(" deep in `low.top` (contact `c`) with the smallest increment"), "{said}");
        assert_eq!(run.summary()["jumps"], 0);
    }
}

/// A plate that stands beside the block and turns over it by 100 degrees, by 25 in an increment: its nodes stand on an arc in
/// the plate's frame, at both ends of which they are in front of it.
#[test]
fn a_tool_that_turns_is_followed_on_its_arc() {
    let plate = r#"profile]
points = [[-0.3, 1.5], [-0.1, 1.5], [-0.1, 7.0], [-0.3, 7.0]]
closed = true
extrude = { origin = [0.0, 5.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] }"#;
    let turn = r#"fix = [{ set = "b.bottom" }]
move = [{ target = "t", rotate = { point = [-0.2, 0.0, 1.5], axis = [0.0, 1.0, 0.0], angle = 100.0 } }]"#;
    let run = block(plate, turn).solve(1, &[]);
    assert!(run.log().contains("went through the tool `t` (contact `c`) with increment 2.5"), "{}", run.log());
    let history = run.history();
    assert_eq!(history.last("c.active"), 25.0);
    assert_small("penetration", history.last("c.max_penetration"), 1e-9);
}

/// Nodes that are past the end of an open surface may be behind it.
#[test]
fn beside_an_open_surface_a_node_may_be_behind_it() {
    // Half a step of the plate's length over the block; the part of the block beside it swells up past its end.
    let strip = r#"profile]
points = [[-3.0, 2.0], [2.4, 2.0]]
extrude = { origin = [0.0, 5.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] }"#;
    let how = r#"fix = [{ set = "b.bottom" }]
move = [{ target = "t", by = [0.0, 0.0, -0.6] }]"#;
    let pressed = block(strip, how).solve(1, &["--set", "step.press.increments=4"]);
    assert!(pressed.history().last("c.active") > 0.0);
    assert_small("penetration", pressed.history().last("c.max_penetration"), 1e-9);
    assert!(!pressed.log().contains("tool `t` (contact"), "{}", pressed.log());
    assert_eq!(pressed.summary()["cutbacks"], 0);
}

/// A sheet over a square hole in a plate is drawn off it: its middle hangs in the hole, and would go on under the plate, its sides on
/// top.
#[test]
fn a_sheet_is_not_cut_by_a_plate_with_a_hole() {
    let bench = Bench::new(
        r#"
[body.b]
material = "m"
block = { box = { origin = [-2.5, -6.0, 0.0], size = [8.0, 12.0, 1.0] }, elements = [8, 12, 1] }
[material.m]
model = "hooke"
young = 15.0
poisson = 0.3
[tool.t]
mesh = "plate.stl"
[contact.c]
slave = "b.zmin"
master = "t"
[[step]]
name = "press"
increments = 4
fix = [{ set = "b.xmax", directions = "xy" }]
pressure = [{ set = "b.zmax", value = 0.3 }]
[[step]]
name = "draw"
increment = { initial = 0.05, max = 0.05, min = 0.025 }
keep = true
move = [{ target = "b.xmax", by = [9.0, 0.0, 0.0], directions = "xy" }]
"#,
    );
    let lines = [-20.0, -3.2, 3.2, 20.0];
    bench.write("plate.stl", &plate_in_plane(&lines, &lines));
    for ranks in [1, 2] {
        let run = bench.run(ranks, &[]);
        assert_eq!(run.code, 1, "{}", run.log());
        let said = &run.stderr;
        assert!(
            said.contains(" behind the tool `t`, which it came round an end of, and the node next to it"),
            "{said}"
        );
        assert!(said.contains("the tool `t` cuts the body between them") && said.contains("(contact `c`)"), "{said}");
        // A facet beyond the hole, at the latest two.
        let at = said.split("is in front: at (").nth(1).unwrap().split(',').next().unwrap();
        assert!((4.0..5.0).contains(&at.parse::<f64>().unwrap()), "{said}");
    }
}

/// Rectangles between lines along x and y in the plane z = 0 without that in the middle, looking up.
fn plate_in_plane(x: &[f64], y: &[f64]) -> String {
    let at = |i: usize, j: usize| Vec3::new(x[i], y[j], 0.0);
    let cells = (0..x.len() - 1).flat_map(|i| (0..y.len() - 1).map(move |j| (i, j)));
    let middle = [x, y].map(|lines| (lines.len() - 2) / 2);
    let solid = cells.filter(|(i, j)| [*i, *j] != middle);
    let parts = solid.flat_map(|(i, j)| rectangle([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    text("plate", &parts.collect::<Vec<_>>())
}

/// A tyre in plane strain rolls over a gap in an open road: part of it falls through, and would be drawn on under the road.
#[test]
fn a_tyre_is_not_cut_by_a_road_with_a_gap() {
    let bench = Bench::new(
        r#"
[body.w]
material = "m"
element = "hex8-fbar"
plane_strain = true
block = { sector = { center = [0.0, 10.0, 0.0], radii = [5.0, 10.0], angles = [0.0, 360.0], length = 1.0 }, elements = [3, 40, 1] }
[material.m]
model = "neo-hookean"
young = 1.0
poisson = 0.45
[tool.road]
mesh = "road.stl"
[contact.c]
slave = "w.rmax"
master = "road"
friction = 0.2
[[step]]
name = "press"
increments = 4
move = [{ target = "w.rmin", by = [0.0, -1.5, 0.0] }]
[[step]]
name = "roll"
increment = { initial = 0.00625, max = 0.00625, min = 0.003125 }
move = [{ target = "w.rmin", by = [30.0, 0.0, 0.0] }]
"#,
    );
    let at = |x: f64, z: f64| Vec3::new(x, 0.0, z);
    let part = |from: f64, to: f64| rectangle([at(from, -1.0), at(from, 3.0), at(to, 3.0), at(to, -1.0)]);
    let parts = [[-30.0, -10.0], [-10.0, 6.0], [8.0, 25.0], [25.0, 60.0]];
    bench.write("road.stl", &text("road", &parts.map(|[from, to]| part(from, to)).concat()));
    let run = bench.run(1, &[]);
    assert_eq!(run.code, 1, "{}", run.log());
    assert!(run.stderr.contains("the tool `road` cuts the body between them"), "{}", run.stderr);
}

/// A strip hangs over the end of a plate and is pulled round it: the facet there spans the end, with a node on top and the next
/// one below.
#[test]
fn a_facet_may_span_the_end_of_a_plate() {
    let bench = Bench::new(
        r#"
[body.b]
material = "m"
element = "hex8-eas"
plane_strain = true
block = { box = { origin = [-6.0, 0.0, 0.0], size = [9.0, 0.4, 1.0] }, elements = [12, 1, 1] }
[material.m]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[tool.t.profile]
points = [[0.0, 0.0], [-10.0, 0.0]]
extrude = { origin = [0.0, 0.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0] }
[contact.c]
slave = "b.ymin"
master = "t"
[[step]]
name = "hang"
increments = 10
fix = [{ set = "b.xmin" }]
force = [{ target = "b.xmax", total = [0.0, -0.05, 0.0] }]
[controls]
watch_aside_most = 1.0 # the end of the plate bends the sheet by some 50 degrees, and bears it along its own normal
"#,
    );
    let run = bench.solve(1, &[]);
    assert_eq!(run.summary()["cutbacks"], 0);
    assert!(run.log().contains("2 nodes were behind the tool `t`, past an end of its surface"), "{}", run.log());
}

/// A blade and a small ball go into facets of the block between its nodes, which feel nothing: refused, also where the ball is
/// inside as a whole at the end, or after its first increment.
#[test]
fn what_goes_in_between_nodes_is_refused() {
    let blade = r#"profile]
points = [[0.9, 4.0], [1.5, 2.0], [2.1, 4.0]]
extrude = { origin = [0.0, 5.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] }"#;
    let ball = "sphere]\ncenter = [1.5, 1.5, 2.2]\nradius = 0.2";
    let go = |tool: &str, by: f64, increments: usize, ranks: usize, elements: usize| {
        let how = format!("fix = [{{ set = \"b.bottom\" }}]\nmove = [{{ target = \"t\", by = [0.0, 0.0, {by}] }}]");
        let elements = format!("body.b.block.elements=[{elements}, {elements}, 2]");
        let increments = format!("step.press.increments={increments}");
        block(tool, &how).run(ranks, &["--set", &elements, "--set", &increments])
    };
    let run = |tool: &str, by: f64, ranks: usize, elements: usize| go(tool, by, 3, ranks, elements);
    let at_once = go(ball, -1.2, 1, 2, 4);
    assert_eq!(at_once.code, 1, "{}", at_once.log());
    assert!(at_once.log().contains("between its nodes, which never touched it"), "{}", at_once.log());
    for tool in [blade, ball] {
        assert!(!run(tool, -0.15, 1, 4).log().contains("between its nodes"));
        for (ranks, by) in [(1, -0.3), (2, -0.3), (1, -0.9)] {
            let refused = run(tool, by, ranks, 4);
            assert_eq!(refused.code, 1, "{}", refused.log());
            assert!(refused.stderr.contains("deep in body `b` between its nodes"), "{}", refused.stderr);
        }
    }
    let refused = run(blade, -0.7, 2, 4);
    assert_eq!(refused.code, 1, "{}", refused.log());
    assert!(refused.stderr.contains("deep in body `b` between its nodes, 0.5"), "{}", refused.stderr);
    // A node is under the tip.
    let felt = run(blade, -0.15, 1, 8);
    assert!(felt.code == 0 && felt.history().last("t.fz") < -0.5 && !felt.log().contains("between its nodes"));
}

/// A block is upset between rough plates, and its sides fold over onto them: refused where no contact names the sides.
#[test]
fn sides_that_fold_over_are_named() {
    let run = |slaves: [&str; 2]| {
        let [top, bottom] = slaves;
        Bench::new(&format!(
            r#"
            [body.b]
            material = "m"
            plane_strain = true
            block = {{ box = {{ size = [1.0, 1.0, 0.1] }}, elements = [6, 6, 1], faces = {{ skin = ["xmin", "xmax", "ymin", "ymax"] }} }}
            [material.m]
            model = "j2"
            young = 70e3
            poisson = 0.3
            yield_stress = 100.0
            hardening = {{ linear = 100.0 }}
            [tool]
            upper.plane = {{ point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }}
            lower.plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }}
            [contact]
            upper = {{ slave = "b.{top}", master = "upper", friction = 1.0 }}
            lower = {{ slave = "b.{bottom}", master = "lower", friction = 1.0 }}
            [[step]]
            increments = 20
            move = [{{ target = "upper", by = [0.0, -0.4, 0.0] }}]
            "#
        ))
        .run(2, &[])
    };
    let folds = run(["ymax", "ymin"]);
    assert_eq!(folds.code, 1, "{}", folds.log());
    assert!(folds.stderr.contains("it is in none of the faces that contacts of its body"), "{}", folds.stderr);
    let named = run(["skin", "skin"]);
    assert_eq!(named.code, 0, "{}", named.stderr);
}

/// A quarter of a ring is crushed until it would meet itself: its other half is its mirror image.
#[test]
fn a_mirror_image_is_not_entered() {
    let bench = Bench::new(
        r#"
        [body.b]
        material = "m"
        plane_strain = true
        element = "hex8-sri"
        block = { sector = { radii = [1.0, 1.2], angles = [0.0, 90.0], length = 0.2 }, elements = [2, 10, 1] }
        symmetry = ["amin", "amax"]
        [material.m]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [tool.plate]
        plane = { point = [0.0, 1.2, 0.0], normal = [0.0, -1.0, 0.0] }
        [contact.c]
        slave = "b.rmax"
        master = "plate"
        [[step]]
        increments = 12
        move = [{ target = "plate", by = [0.0, -1.15, 0.0] }]
        "#,
    );
    let run = bench.run(2, &[]);
    assert_eq!(run.code, 1, "{}", run.log());
    assert!(run.stderr.contains("lies beyond the plane of symmetry of `b.amin`"), "{}", run.stderr);
}

/// How wide a layer is in plane strain says nothing of what is between its nodes.
#[test]
fn the_width_of_a_layer_does_not_matter() {
    let force = |width: f64| {
        let bench = Bench::new(&format!(
            r#"
            body.b = {{ material = "m", plane_strain = true, block = {{ box = {{ size = [4.0, 2.0, {width}] }}, elements = [8, 4, 1] }} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            tool.t.cylinder = {{ point = [2.1, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }}
            contact.c = {{ slave = "b.ymax", master = "t", friction = 0.3 }}
            [[step]]
            name = "press"
            increments = 2
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "t", by = [0.0, -0.2, 0.0] }}]
            "#
        ));
        let run = bench.solve(1, &[]);
        assert!(!run.log().contains("between its nodes"), "{}", run.log());
        run.history().last("t.fy") / width
    };
    assert_close("force over width", force(0.01), force(1.0), 1e-8);
}

/// A pad that overlaps a slab by less than the watch tells of, and slides over it onto nodes that nothing touched before: the
/// force stays, whichever of both is the slave and however thick the layer. Deeper it is refused, as thick as the layer is.
#[test]
fn an_overlap_stays_where_it_slides_onto_other_nodes() {
    let scene = |overlap: f64, thickness: f64, [slave, master]: [&str; 2]| {
        Bench::new(&format!(
            r#"
[body.slab]
material = "m"
plane_strain = true
block = {{ box = {{ origin = [0.0, -5.0, 0.0], size = [40.0, 5.0, {thickness}] }}, elements = [40, 5, 1] }}
[body.pad]
material = "m"
plane_strain = true
block = {{ box = {{ origin = [5.0, -{overlap}, 0.0], size = [10.0, 5.0, {thickness}] }}, elements = [10, 5, 1] }}
[material.m]
model = "hooke"
young = 200000.0
poisson = 0.3
[contact.c]
slave = "{slave}"
master = "{master}"
[[step]]
name = "fit"
increments = 1
fix = [{{ set = "slab.ymin" }}, {{ set = "pad.ymax" }}]
[[step]]
name = "slide"
increments = 20
fix = [{{ set = "slab.ymin" }}]
move = [{{ target = "pad.ymax", by = [20.0, 0.0, 0.0] }}]
[output]
history = ["slab.ymin"]
"#
        ))
    };
    let (slab, pad) = ("slab.ymax", "pad.ymin");
    for (thickness, sides) in [(1.0, [slab, pad]), (100.0, [slab, pad]), (1.0, [pad, slab])] {
        let history = scene(0.008, thickness, sides).solve(1, &[]).history();
        let forces = history.column("slab.ymin.fy");
        // At the beginning and the end of the way the pad's nodes are on those of the slab.
        assert_close("force", forces[20] / forces[0], 1.0, 1e-6);
        for force in forces {
            assert_close("force over thickness", *force / thickness, 2075.6, 5e-3);
        }
    }
    let run = scene(0.06, 100.0, [slab, pad]).run(2, &["--set", "step.slide.increments=40"]);
    assert!(run.code == 1 && run.stderr.contains("is inside body `pad`"), "{}\n{}", run.code, run.stderr);
}

/// A plane that goes along itself farther than anybody could look: no answer, and no endless look either.
#[test]
fn a_way_that_is_too_long_to_follow_ends_the_increment() {
    let plane = "plane]\npoint = [0.0, 0.0, 2.0]\nnormal = [0.0, 0.0, -1.0]";
    let far = "fix = [{ set = \"b.bottom\" }]\nmove = [{ target = \"t\", by = [1e20, 0.0, -0.1] }]";
    let run = block(plane, far).run(1, &[]);
    assert!(
        run.code == 1 && run.stderr.contains("too far to see what it went through"),
        "{}\n{}",
        run.code,
        run.stderr
    );
}

/// At the end of a run: a contact that never was, one that ended, and one that was ended on purpose.
#[test]
fn contacts_that_do_not_act_are_named_at_the_end() {
    let plane = "plane]\npoint = [0.0, 0.0, 2.1]\nnormal = [0.0, 0.0, -1.0]";
    let moved =
        |by: &str| format!("fix = [{{ set = \"b.bottom\" }}]\nmove = [{{ target = \"t\", by = [0.0, 0.0, {by}] }}]");
    let step = |by: &str| format!("[[step]]\nname = \"next\"\nincrements = 1\n{}", moved(by));
    let warnings = |how: &str| {
        let run = block(plane, how).solve(2, &[]);
        let list: Vec<String> = serde_json::from_value(run.summary()["warnings"].clone()).unwrap();
        for warning in &list {
            assert!(run.log().contains(warning) && run.stdout.contains(warning), "{}", run.stdout);
        }
        list
    };
    assert_eq!(warnings(&moved("-0.05")), ["contact `c`: no node has ever touched the tool `t`"]);
    assert_eq!(warnings(&moved("-0.3")), Vec::<String>::new());
    assert_eq!(warnings(&(moved("-0.3") + "\n" + &step("0.5"))), Vec::<String>::new());
    // What is pushed out too weakly.
    let soft = "contact.c = { slave = \"b.top\", master = \"t\", method = \"penalty\", penalty = 1.0 }";
    let scene = std::fs::read_to_string(block(plane, &moved("-0.3")).path("scene.toml")).unwrap();
    let (before, after) = scene.split_once("[contact.c]").unwrap();
    let bench = Bench::new(&format!("{soft}\n{before}{}", &after[after.find("[[step]]").unwrap()..]));
    let let_in = bench.solve(1, &[]);
    let depth = let_in.history().last("c.max_penetration");
    assert!(depth > 0.05 && let_in.log().contains(&format!("its penalty let nodes be {depth:.3e} deep")));
    let loose = ["--set", "contact.c.method=uzawa", "--set", "contact.c.tolerance=0.2"];
    assert!(bench.solve(1, &loose).log().contains("its tolerance let nodes be"));
    // The tool goes off along the block, which friction drags along with it.
    let along = "[[step]]\nname = \"next\"\nincrements = 8\nfix = [{ set = \"b.bottom\" }]\nmove = [{ target = \"t\", by = [8.0, 0.0, 0.0] }]";
    let ball = "sphere]\ncenter = [2.0, 2.0, 3.05]\nradius = 1.0";
    let run = block(ball, &(moved("-0.1") + "\n" + along)).solve(1, &[]);
    assert!(run.history().last("c.active") == 0.0 && !run.log().contains("any more"), "{}", run.log());
    // A table that goes along itself has not left: a load was forgotten, and springs lift the block off.
    let table = "plane]\npoint = [0.0, 0.0, 2.01]\nnormal = [0.0, 0.0, -1.0]";
    let springs = "spring = [{ set = \"b\", stiffness = [100.0, 100.0, 100.0] }]";
    let pressed = format!("{springs}\nforce = [{{ target = \"b.bottom\", total = [0.0, 0.0, 200.0] }}]");
    let along = format!(
        "[[step]]\nname = \"drag\"\nincrements = 5\n{springs}\nmove = [{{ target = \"t\", by = [0.1, 0.0, 0.0] }}]"
    );
    let run = block(table, &format!("{pressed}\n{along}")).solve(1, &[]);
    assert!(run.history().last("c.active") == 0.0 && run.log().contains("nothing touches the tool `t` any more"));
    // The block is drawn away from under the tool.
    let drawn = "[[step]]\nname = \"next\"\nincrements = 1\nmove = [{ target = \"b.bottom\", by = [0.0, 0.0, -0.5] }]";
    let until = warnings(&(moved("-0.3") + "\n" + drawn));
    assert_eq!(until, ["contact `c`: nothing touches the tool `t` any more since time 1.000000"]);
}

/// Two equal blocks lie flush on each other, and the upper one is drawn aside, without friction: the row of nodes at its end slides
/// off, and a quarter of the force is lost between nodes. From segment to segment it is not.
#[test]
fn nodes_that_slide_off_an_end_with_much_of_the_force_are_told_of() {
    let bench = Bench::new(
        r#"
[body.lower]
material = "m"
element = "hex8"
block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
[body.upper]
material = "m"
element = "hex8"
block = { box = { origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
[material.m]
model = "hooke"
young = 100.0
poisson = 0.3
[contact.c]
slave = "lower.zmax"
master = "upper.zmin"
[[step]]
name = "press"
increments = 2
fix = [{ set = "lower.zmin" }]
move = [{ target = "upper.zmax", by = [0.0, 0.0, -0.2] }]
[[step]]
name = "draw"
increments = 4
fix = [{ set = "lower.zmin" }]
move = [{ target = "upper.zmax", by = [0.1, 0.0, 0.0] }]
[output]
history = ["lower.zmin"]
"#,
    );
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let list: Vec<String> = serde_json::from_value(run.summary()["warnings"].clone()).unwrap();
        let told = |words: &str| list.iter().filter(|warning| warning.contains(words)).count();
        assert_eq!(
            [told("slid off the end of `upper.zmin` with 22 %"), told("a jump took its force")],
            [1, 1],
            "{list:?}"
        );
        let force = run.history().last("lower.zmin.fz");
        assert!(force < 18.0, "the loss that is told of: {force}");
    }
    let segments = bench.solve(2, &["--set", "contact.c.discretization=\"segment\""]);
    assert!(segments.history().last("lower.zmin.fz") > 22.7 && !segments.log().contains("slid off"));
    let refused = bench.run(1, &["--set", "contact.c.friction=1e-3"]);
    assert_eq!(refused.code, 1, "{}", refused.log());
    assert!(refused.stderr.contains("are past the end of `upper.zmin`, about to slide off"), "{}", refused.stderr);
}

/// A thin plate of a mesh passes over two blocks, of which the one farther away, whose contact is listed last, is too low for
/// it: what the watch looks at for that one must not be all that it knows of the plate.
#[test]
fn a_tool_is_watched_at_all_its_contacts() {
    // Along its lower side, and back along the upper one.
    let plate = msh::surface(120, |u, v| {
        let (x, z) = if u <= 0.5 { (u, 2.2) } else { (1.0 - u, 2.5) };
        [92.0 * x - 1.0, 5.0 - 6.0 * v, z]
    });
    let scene = |contacts: &str| {
        format!(
            r#"
body.a.material = "m"
body.a.block = {{ box = {{ size = [4, 4, 2] }}, elements = [4, 4, 2], faces = {{ top = "zmax", bottom = "zmin" }} }}
body.b.material = "m"
body.b.block = {{ box = {{ origin = [40, 0, -4], size = [4, 4, 2] }}, elements = [4, 4, 2], faces = {{ top = "zmax", bottom = "zmin" }} }}
material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
tool.t = {{ mesh = "plate.msh", smoothing = "facet" }}
{contacts}
step = [{{ name = "press", increments = 1, fix = [{{ set = "a.bottom" }}, {{ set = "b.bottom" }}], move = [{{ target = "t", by = [0, 0, -1] }}] }}]
"#
        )
    };
    let [near, far] = ["a", "b"].map(|b| format!("contact.{b} = {{ slave = \"{b}.top\", master = \"t\" }}\n"));
    for contacts in [near.clone() + &far, far + &near] {
        let bench = Bench::new(&scene(&contacts));
        bench.write("plate.msh", &plate);
        let run = bench.solve(1, &[]);
        assert!(run.log().contains("went through the tool `t` (contact `a`)"), "{}", run.log());
        assert_eq!(run.history().last("a.active"), 25.0);
    }
}

/// A pad is pressed into one table and drawn over its end. Where a higher one stands beside it, of which the contact names the top
/// alone, it goes into that one past its edge, where nothing holds it; where there is none, it hangs over the end.
#[test]
fn a_body_is_not_entered_through_faces_that_no_contact_names() {
    let scene = |second: &str, contact: &str, fixed: &str| {
        format!(
            r#"
[body.table]
material = "m"
plane_strain = true
block = {{ box = {{ size = [3.0, 1.0, 1.0] }}, elements = [4, 2, 1] }}
[body.pad]
material = "m"
plane_strain = true
block = {{ box = {{ origin = [1.0, 1.0, 0.0], size = [1.5, 1.0, 1.0] }}, elements = [3, 2, 1] }}
{second}
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[contact.one]
slave = "pad.ymin"
master = "table.ymax"
{contact}
[[step]]
increments = 2
fix = [{{ set = "table.ymin" }}{fixed}]
move = [{{ target = "pad.ymax", by = [0.0, -0.1, 0.0] }}]
[[step]]
increments = 12
fix = [{{ set = "table.ymin" }}{fixed}]
move = [{{ target = "pad.ymax", by = [2.4, 0.0, 0.0] }}]
"#
        )
    };
    let hangs = Bench::new(&scene("", "", "")).run(1, &[]);
    assert_eq!(hangs.code, 0, "{}", hangs.stderr);
    let second = "[body.next]\nmaterial = \"m\"\nplane_strain = true\n\
                  block = { box = { origin = [3.0, 0.0, 0.0], size = [3.0, 1.3, 1.0] }, elements = [4, 2, 1] }";
    let contact = "[contact.two]\nslave = \"pad.ymin\"\nmaster = \"next.ymax\"";
    let higher = Bench::new(&scene(second, contact, ", { set = \"next.ymin\" }"));
    for ranks in [1, 2] {
        let run = higher.run(ranks, &[]);
        let says = "is inside body `next`, which it entered where no contact names a face";
        assert!(run.code == 1 && run.stderr.contains(says), "{}\n{}", run.code, run.stderr);
    }
}

/// A group that names a part of a face only, as of a mesh whose groups are not complete: what goes into the body beside it is not seen
/// by the contact, by however little it is past the end of the group.
#[test]
fn a_node_goes_in_beside_a_part_of_a_face() {
    let place =
        |origin: [f64; 3], size: [f64; 3]| move |x: [f64; 3]| std::array::from_fn(|d| origin[d] + size[d] * x[d]);
    let table = msh::block([6, 3, 2], false, place([0.0; 3], [6.0, 3.0, 2.0]));
    let pad = msh::block([4, 2, 2], false, place([1.0, 0.5, 2.0], [2.8, 2.0, 1.0]));
    // The first half of the top's faces, by their order from x = 0, and the others to a side that nothing names.
    let top: Vec<&str> = table.lines().filter(|line| line.contains(" 3 2 6 6 ")).collect();
    let half =
        top[9..].iter().fold(table.clone(), |mesh, line| mesh.replace(line, &line.replace(" 2 6 6 ", " 2 1 1 ")));
    let scene = |discretization: &str, by: f64| {
        Bench::new(&format!(
            "body.table = {{ mesh = \"table.msh\", material = \"m\" }}\nbody.pad = {{ mesh = \"pad.msh\", material = \"m\" }}\n\
             material.m = {{ model = \"neo-hookean\", young = 1000.0, poisson = 0.3 }}\n\
             contact.c = {{ slave = \"pad.zmin\", master = \"table.zmax\", discretization = {discretization:?} }}\n\
             [[step]]\nincrements = 2\nfix = [{{ set = \"table.zmin\" }}]\n\
             move = [{{ target = \"pad.zmax\", by = [0.0, 0.0, {by:?}] }}]\n"
        ))
    };
    for (discretization, by, ranks) in
        [("one-pass", -0.2, 1), ("one-pass", -0.6, 2), ("segment", -0.2, 2), ("two-pass", -0.2, 1)]
    {
        let bench = scene(discretization, by);
        bench.write("pad.msh", &pad);
        bench.write("table.msh", &half);
        let run = bench.run(ranks, &[]);
        let says = "is inside body `table`, which it entered where no contact names a face";
        assert!(run.code == 1 && run.stderr.contains(says), "{discretization}: {}\n{}", run.code, run.stderr);
        bench.write("table.msh", &table);
        let whole = bench.run(ranks, &[]);
        assert_eq!(whole.code, 0, "{discretization}: {}", whole.stderr);
    }
}

/// ```text
///       |  |        A punch with sharp edges is pressed a little into a flat and drawn along: one node of the flat stays above the edge,
///   ____|__|____    on the wall, and is carried along with all around it. From segment to segment, or with a fillet, nothing resists.
/// ```
#[test]
fn a_node_hooks_on_a_wall() {
    let scene = |fillet: f64, contact: &str| {
        Bench::new(&format!(
            r#"
            [body.base]
            material = "m"
            plane_strain = true
            block = {{ box = {{ origin = [-1.0, -1.0, 0.0], size = [2.0, 1.0, 1.0] }}, elements = [20, 10, 1] }}
            [material.m]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [tool.punch]
            profile = {{ points = [[-0.3, 0.5], [-0.3, 0.0], [0.3, 0.0], [0.3, 0.5]], fillets = {fillet:?} }}
            [contact.c]
            slave = "base.ymax"
            master = "punch"
            {contact}
            [[step]]
            increments = 2
            fix = [{{ set = "base.ymin" }}]
            move = [{{ target = "punch", by = [0.0, -0.02, 0.0] }}]
            [[step]]
            increments = 8
            fix = [{{ set = "base.ymin" }}]
            move = [{{ target = "punch", by = [-0.3, 0.0, 0.0] }}]
            "#
        ))
    };
    let says = "is held by a side of the tool `punch` that it does not look at, beside a sharp edge";
    for (contact, ranks) in [("", 1), ("", 2), ("friction = 0.4", 1), ("method = \"lagrange\"", 1)] {
        let run = scene(0.0, contact).run(ranks, &[]);
        assert!(run.code == 1 && run.stderr.contains(says), "{contact}: {}\n{}", run.code, run.stderr);
    }
    for (fillet, contact) in [(0.0, "discretization = \"segment\""), (0.05, "")] {
        let history = scene(fillet, contact).solve(1, &[]).history();
        let force = history.last("punch.fy").abs();
        assert!(force > 0.1, "{force}");
        assert_small("across", history.last("punch.fx") / force, 1e-2);
    }
}

/// ```text
///      \         A corner of 20 and 60 degrees is pressed a little into a flat and drawn along, without friction: a node beside it is
///   ____\____    pushed by its steep side, where the corner itself meets a facet. What is right is a force across, but for what the
///        ''--    dent leans; where the corner is round, it is.
/// ```
#[test]
fn a_corner_pushes_nodes_aside() {
    let scene = |[fillet, facet]: [f64; 2], contact: &str| {
        let count = (4.0 / facet).round() as usize;
        Bench::new(&format!(
            r#"
            [body.base]
            material = "m"
            plane_strain = true
            block = {{ box = {{ origin = [-2.0, -1.0, 0.0], size = [4.0, 1.0, 1.0] }}, elements = [{count}, {}, 1] }}
            [material.m]
            model = "hooke"
            young = 1000.0
            poisson = 0.3
            [tool.corner]
            profile = {{ points = [[-1.410, 0.513], [0.0, 0.0], [0.75, 1.299]], fillets = {fillet:?} }}
            [contact.c]
            slave = "base.ymax"
            master = "corner"
            {contact}
            [[step]]
            increments = 4
            fix = [{{ set = "base.ymin" }}]
            move = [{{ target = "corner", by = [0.0075, {}, 0.0] }}]
            [[step]]
            increments = 15
            fix = [{{ set = "base.ymin" }}]
            move = [{{ target = "corner", by = [0.2, 0.0, 0.0] }}]
            "#,
            count / 4,
            // A fillet has its lowest point above the corner.
            -0.025 - 0.2266 * fillet
        ))
    };
    let says = "sides of the tool `corner` that none of the facets around a node looks at pushed nodes aside with";
    // A finer mesh does not help.
    for (facet, contact, ranks) in [(0.125, "", 1), (0.125, "friction = 0.2", 2), (0.0625, "", 1)] {
        let run = scene([0.0, facet], contact).run(ranks, &[]);
        assert!(run.code == 1 && run.stderr.contains(says), "{facet} {contact}: {}\n{}", run.code, run.stderr);
    }
    let round = scene([0.125, 0.0625], "").solve(1, &[]);
    let force = round.history().last("corner.fy").abs();
    assert!(force > 0.1 && !round.log().contains(says), "{force}");
    assert_small("across", round.history().last("corner.fx") / force, 0.2);
}

/// What is held by a side beside it as it should be: the thin end of a strip against a wall, with all its faces as the slave; a block
/// that a low stop holds by the end of its bottom; and a block that is drawn off the end of a table, round whose corner a node snaps.
#[test]
fn what_is_held_by_its_end_is_not_hooked() {
    let scene = |block: &str, master: &str, tool: &str, rest: &str| {
        Bench::new(&format!(
            "body.b = {{ material = \"m\", plane_strain = true, block = {{ {block} }} }}\n\
             material.m = {{ model = \"neo-hookean\", young = 1.0, poisson = 0.45 }}\n\
             contact.c = {{ slave = \"b.under\", master = {master:?} }}\n{tool}\n{rest}"
        ))
    };
    let strip = scene(
        "box = { size = [10.0, 0.2, 1.0] }, elements = [10, 1, 1], faces = { under = [\"xmin\", \"xmax\", \"ymin\", \"ymax\"] }",
        "wall",
        "tool.wall.profile = { points = [[10.001, 50.0], [10.001, -50.0]] }",
        "[[step]]\nincrements = 2\nfix = [{ set = \"b.ymin\", directions = \"y\" }]\n\
         move = [{ target = \"b.xmin\", by = [0.02, 0.0, 0.0], directions = \"x\" }]\n",
    );
    assert!(strip.solve(1, &[]).history().last("wall.fx") < -3e-4);
    let stopped = scene(
        "box = { size = [3.0, 1.0, 0.5] }, elements = [6, 4, 1], faces = { under = [\"ymin\"] }",
        "stop",
        "tool.stop.profile = { points = [[9.0, 0.1], [3.02, 0.1], [3.02, -3.0]] }\n\
         tool.floor.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n\
         contact.below = { slave = \"b.ymin\", master = \"floor\" }\n",
        "[[step]]\nincrements = 5\nmove = [{ target = \"b.ymax\", by = [0.0, -0.05, 0.0], directions = \"y\" }, \
         { target = \"b.xmin\", by = [0.1, 0.0, 0.0], directions = \"x\" }]\n",
    );
    assert_close("stop", stopped.solve(2, &[]).history().last("stop.fx"), -0.0401, 5e-3);
    let drawn = scene(
        "box = { origin = [-4.0, 0.0, 0.0], size = [4.0, 1.0, 0.5] }, elements = [12, 3, 1], faces = { under = [\"ymin\"] }",
        "table.ymax",
        "body.table = { material = \"hard\", plane_strain = true, \
         block = { box = { origin = [-12.0, -1.0, 0.0], size = [12.3, 1.0, 0.5] }, elements = [16, 2, 1] } }\n\
         material.hard = { model = \"neo-hookean\", young = 200.0, poisson = 0.3 }\n",
        "[[step]]\nincrements = 3\nfix = [{ set = \"table.ymin\" }]\nmove = [{ target = \"b.ymax\", by = [0.0, -0.1, 0.0] }]\n\
         [[step]]\nincrements = 15\nfix = [{ set = \"table.ymin\" }]\nmove = [{ target = \"b.ymax\", by = [1.5, 0.0, 0.0] }]\n",
    );
    for ranks in [1, 2] {
        // From segment to segment it is 0.3409.
        assert_close("drawn off", drawn.solve(ranks, &[]).history().last("c.fy").abs(), 0.33648, 1e-4);
    }
}

/// The band of a hose clamp, half of it, one thin layer: a node of the hose behind its end goes in at the end and out of the outer
/// face, which no contact names, within few increments.
#[test]
fn a_node_goes_through_a_thin_band() {
    let bench = Bench::new(
        r#"
        [body.hose]
        material = "rubber"
        plane_strain = true
        symmetry = ["amin", "amax"]
        block = { sector = { center = [0, 0, 0], radii = [7.0, 10.0], angles = [0.0, 180.0], length = 1.0 }, elements = [4, 36, 1] }
        [body.band]
        material = "steel"
        plane_strain = true
        element = "hex8-eas"
        symmetry = ["amax"]
        block = { sector = { center = [0, 0, 0], radii = [10.0, 10.4], angles = [12.0, 180.0], length = 1.0 }, elements = [1, 24, 1] }
        [material.rubber]
        model = "neo-hookean"
        young = 8.0
        poisson = 0.45
        [material.steel]
        model = "hooke"
        young = 20000.0
        poisson = 0.3
        [contact.c]
        slave = "hose.rmax"
        master = "band.rmin"
        [[step]]
        name = "tighten"
        increments = 10
        fix = [{ set = "hose.rmin" }]
        move = [{ target = "band.amin", by = [0, -0.8, 0], directions = "y" }]
        "#,
    );
    for (ranks, increments) in [(1, 10), (2, 10), (1, 5), (1, 7)] {
        let run = bench.run(ranks, &["--set", &format!("step.tighten.increments={increments}")]);
        let says = "is inside body `band`, which it entered where no contact names a face";
        assert!(run.code == 1 && run.stderr.contains(says), "{increments}: {}\n{}", run.code, run.stderr);
    }
}

/// A slab under tools, each of them with a contact, that are pressed down onto it and then drawn along.
fn slab_under(tools: &str, names: &[&str], friction: f64, [down, along]: [f64; 2], increments: usize) -> Bench {
    let each = |of: &dyn Fn(&str) -> String| names.iter().map(|name| of(name)).collect::<Vec<_>>();
    let contacts =
        each(&|n| format!("contact.{n} = {{ slave = \"b.zmax\", master = \"{n}\", friction = {friction:?} }}\n"));
    let moves = |by: [f64; 3]| each(&|n| format!("{{ target = \"{n}\", by = {by:?} }}")).join(", ");
    Bench::new(&format!(
        r#"
body.b.material = "m"
body.b.block = {{ box = {{ origin = [-2.0, -2.0, -1.0], size = [4.0, 4.0, 1.0] }}, elements = [10, 10, 2] }}
material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
{tools}
{}
[output]
every = 100
history = ["b.zmin"]
[[step]]
increments = 4
fix = [{{ set = "b.zmin" }}]
move = [{}]
[[step]]
increments = {increments}
fix = [{{ set = "b.zmin" }}]
move = [{}]
"#,
        contacts.concat(),
        moves([0.0, 0.0, -down]),
        moves([along, 0.0, 0.0])
    ))
}

/// A platen in two pieces, with the sides that lie on each other, and one with a pin in it, are as a whole one: nodes go over the
/// seam, and are not caught by its sides, which all of them have come from in front of.
#[test]
fn seams_of_tools_hold_nothing() {
    let scene = |tools: &str, friction: f64, ways: [f64; 2], names: &[&str]| {
        let run = slab_under(tools, names, friction, ways, 12).solve(1, &[]);
        ["fx", "fz"].map(|c| run.history().last(&format!("b.zmin.{c}")))
    };
    let bar = |name: &str, from: f64, to: f64| {
        format!(
            "tool.{name}.profile = {{ points = [[{from:?}, 0.0], [{to:?}, 0.0], [{to:?}, 2.0], [{from:?}, 2.0]], closed = true, \
             extrude = {{ y = [0.0, 0.0, 1.0] }} }}\n"
        )
    };
    let ring = |name: &str, from: f64, to: f64| {
        format!(
            "tool.{name}.profile = {{ points = [[{from:?}, 0.0], [{to:?}, 0.0], [{to:?}, 2.0], [{from:?}, 2.0]], closed = {}, \
             revolve = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] }} }}\n",
            from > 0.0
        )
    };
    let whole = bar("left", -4.0, 4.0);
    for (friction, ways, seam) in [(0.0, [0.02, 0.9], 0.05), (0.3, [0.05, 0.35], 0.2)] {
        let [fx, fz] = scene(&whole, friction, ways, &["left"]);
        assert_small("Coulomb", fx.abs() / fz.abs() - friction, 1e-6);
        for (tools, names) in [
            (bar("left", -4.0, seam) + &bar("right", seam, 4.0), ["left", "right"]),
            (ring("pin", 0.0, 1.1) + &ring("die", 1.1, 6.0), ["pin", "die"]),
        ] {
            let found = scene(&tools, friction, ways, &names);
            for (a, b) in found.iter().zip([fx, fz]) {
                assert_small(&format!("{names:?}, {friction}: {found:?}"), (a - b) / fz, 1e-5);
            }
        }
    }
}

/// A faceted cap that is cut in two is as a whole one, in however long increments: nodes that an iteration takes past the end of
/// one half, and so far into the other that they would be behind it, came from its front.
#[test]
fn a_cap_in_two_is_a_whole_one() {
    let seam = 0.17;
    let cap = |n: usize, from: f64, to: f64| {
        msh::block([n, 16, 1], false, |[u, v, w]| {
            let (x, y) = (from + (to - from) * u, 3.2 * (v - 0.5));
            [seam + x, 0.12 + y, 0.25 * (x * x + y * y) + w]
        })
    };
    let run = |parts: &[(&str, &str)], increments: usize, friction: f64| {
        let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
        let tool = |n: &&str| format!("tool.{n} = {{ mesh = \"{n}.msh\", group = \"zmin\", smoothing = \"facet\" }}\n");
        let tools: String = names.iter().map(tool).collect();
        let bench = slab_under(&tools, &names, friction, [0.15, -0.5], increments);
        for (name, mesh) in parts {
            bench.write(&format!("{name}.msh"), mesh);
        }
        let run = bench.solve(1, &[]);
        assert!(!run.stderr.contains("warning"), "{}", run.stderr);
        ["fx", "fz"].map(|c| run.history().last(&format!("b.zmin.{c}")))
    };
    let (left, right, whole) = (cap(8, -1.6, 0.0), cap(8, 0.0, 1.6), cap(16, -1.6, 1.6));
    let halves = [("left", &left[..]), ("right", &right[..])];
    // With friction the path counts, and rounding decides what a node on the seam is on.
    for (friction, tolerance) in [(0.0, 1e-9), (0.3, 1e-4)] {
        for increments in [3, 7, 28] {
            let [found, expected] =
                [&halves[..], &[("whole", &whole[..])]].map(|parts| run(parts, increments, friction));
            for (a, b) in found.iter().zip(expected) {
                let what = format!("{friction}, {increments} increments: {found:?} for {expected:?}");
                assert_small(&what, (a - b) / expected[1], tolerance);
            }
        }
    }
}

/// A pad that is drawn over the joint of two tables bears what it does on one: nodes that leave the first, sunk into it, are lower
/// than the second, and go on over it. They end two facets from the joint, where normals are those of one table again.
#[test]
fn a_pad_goes_over_the_joint_of_two_masters() {
    let body = |name: &str, from: f64, length: f64, elements: usize| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\nplane_strain = true\n\
             block = {{ box = {{ origin = [{from}, 0.0, 0.0], size = [{length}, 2.0, 1.0] }}, elements = [{elements}, 2, 1] }}\n"
        )
    };
    let contact = |master: &str| {
        format!("[contact.on-{master}]\nslave = \"pad.ymin\"\nmaster = \"{master}.ymax\"\nfriction = 0.2\n")
    };
    let scene = |tables: &str, fixed: &str| {
        format!(
            "{tables}[body.pad]\nmaterial = \"m\"\nplane_strain = true\n\
             block = {{ box = {{ origin = [1.0, 2.0, 0.0], size = [2.0, 1.0, 1.0] }}, elements = [4, 2, 1] }}\n\
             [material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nname = \"press\"\nincrements = 2\nfix = [{fixed}]\n\
             move = [{{ target = \"pad.ymax\", by = [0.0, -0.1, 0.0] }}]\n\
             [[step]]\nname = \"draw\"\nincrements = 12\nfix = [{fixed}]\n\
             move = [{{ target = \"pad.ymax\", by = [4.2, 0.0, 0.0] }}]\n[output]\nhistory = [\"pad.ymax\"]\n"
        )
    };
    let one = Bench::new(&scene(&(body("table", 0.0, 8.0, 8) + &contact("table")), "{ set = \"table.ymin\" }"));
    let tables = body("left", 0.0, 4.0, 4) + &body("right", 4.0, 4.0, 4) + &contact("left") + &contact("right");
    let tie = "[tie.joint]\nslave = \"right.xmin\"\nmaster = \"left.xmax\"\n";
    let two = Bench::new(&scene(&(tables + tie), "{ set = \"left.ymin\" }, { set = \"right.ymin\" }"));
    let [one, two] = [one.solve(1, &[]), two.solve(2, &[])].map(|run| {
        assert!(!run.log().contains("slid off"), "{}", run.log());
        run.history()
    });
    for column in ["pad.ymax.fx", "pad.ymax.fy"] {
        assert_close(column, two.last(column), one.last(column), 1e-9);
    }
}

/// A platen that is narrower than a block goes into the facets at its edges, whose outer nodes are beside it: told of, however
/// thick the layer.
#[test]
fn a_rim_that_no_node_feels_is_told_of() {
    for thickness in [0.1, 3.0] {
        let bench = Bench::new(&format!(
            r#"
            body.b = {{ material = "m", plane_strain = true, block = {{ box = {{ size = [4.0, 2.0, {thickness}] }}, elements = [8, 4, 1] }} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            contact.c = {{ slave = "b.ymax", master = "t" }}
            [tool.t.profile]
            points = [[1.05, 3.0], [1.05, 2.0], [2.95, 2.0], [2.95, 3.0]]
            closed = true
            extrude = {{ origin = [0.0, 0.0, -1.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0], length = 5.0 }}
            [[step]]
            increments = 4
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "t", by = [0.0, -0.4, 0.0] }}]
            "#
        ));
        let run = bench.solve(1, &[]);
        assert!(run.log().contains("deep in body `b` between its nodes"), "{thickness}: {}", run.log());
    }
}

/// A block in the corner of two tools with friction: what the nodes of its edge bear on each does not follow from equilibrium.
/// Told of where they bear much, and where friction holds them.
#[test]
fn what_tools_share_with_friction_is_told_of() {
    let run = |elements: usize, friction: f64, ranks: usize| {
        Bench::new(&format!(
            r#"
            body.b = {{ material = "m", plane_strain = true, block = {{ box = {{ size = [1.0, 1.0, 0.1] }}, elements = [{elements}, {elements}, 1] }} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            tool.floor.plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }}
            tool.wall.plane = {{ point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }}
            contact.below = {{ slave = "b.ymin", master = "floor", friction = {friction:?} }}
            contact.beside = {{ slave = "b.xmin", master = "wall", friction = {friction:?} }}
            [[step]]
            increments = 2
            pressure = [{{ set = "b.xmax", value = 2.0 }}, {{ set = "b.ymax", value = 5.0 }}]
            "#
        ))
        .solve(ranks, &[])
    };
    let told = |elements, friction, ranks| {
        let log = run(elements, friction, ranks).log();
        ["below", "beside"].map(|name| log.contains(&format!("contact `{name}`: nodes that the tool")))
    };
    for ranks in [1, 2] {
        assert_eq!(told(2, 0.5, ranks), [true, true]);
    }
    assert_eq!(told(2, 0.0, 1), [false, false]);
    assert!(!told(24, 0.5, 1)[0]);
}

/// Two blocks under one plate that stands on the first alone, the second pushed into the first and up through the plate: where a
/// contact is missing they are as if the other were not there, and that is told of once.
#[test]
fn what_no_contact_brings_together_is_told_of_when_it_meets() {
    let scene = |by: [f64; 3], more: &str| {
        format!(
            r#"
[body.a]
material = "m"
block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1] }}
[body.b]
material = "m"
block = {{ box = {{ origin = [3.0, 0.3, -0.25], size = [2.0, 1.0, 1.0] }}, elements = [3, 1, 1] }}
[material.m]
model = "hooke"
young = 100.0
poisson = 0.3
[tool.plate]
plane = {{ point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }}
[contact.c]
slave = "a.zmax"
master = "plate"
{more}
[[step]]
name = "push"
increments = 4
fix = [{{ set = "a.zmin" }}]
move = [{{ target = "b", by = {by:?} }}, {{ target = "plate", by = [0.0, 0.0, -0.01] }}]
"#
        )
    };
    let told = |by: [f64; 3], more: &str| {
        [1, 2].map(|ranks| {
            let run = Bench::new(&scene(by, more)).solve(ranks, &[]);
            assert_eq!(run.code, 0, "{}", run.stderr);
            let log = run.log();
            let lines = log.lines().filter(|line| line.contains("warning") && line.contains("(time"));
            lines.map(str::to_string).collect::<Vec<_>>()
        })
    };
    let aside = [-1.6, 0.0, 0.0];
    let [one, two] = told(aside, "");
    assert_eq!(one, two);
    let says = |line: &str, words: &[&str]| words.iter().all(|word| line.contains(word));
    assert!(
        one.len() == 1 && says(&one[0], &["bodies `a` and `b` touch or are in each other", "(time 0.75"]),
        "{one:?}"
    );
    let [one, two] = told([0.0, 0.0, 0.9], "");
    assert_eq!(one, two);
    assert!(
        one.len() == 1
            && says(
                &one[0],
                &[
                    "of body `b`",
                    "tool `plate`",
                    "no contact is between them: add one, or end the tool before it (a plane and a cylinder go"
                ]
            ),
        "{one:?}"
    );
    let above = "[contact.d]\nslave = \"b.zmax\"\nmaster = \"plate\"";
    let [one, _] = told([0.0, 0.0, 0.2], above);
    assert!(one.is_empty(), "{one:?}");
}

/// From segment to segment a node may be a quarter of a facet deep: from there on it is refused, as from where it touches, and is
/// not lost out of sight, whether a ball smaller than its facets comes or goes over nodes that are held.
#[test]
fn a_node_that_segments_let_in_stays_in_sight() {
    let scene = |ball: &str, how: &str, steps: &str| {
        let bench = Bench::new(&format!(
            r#"
[body.b]
material = "m"
block = {{ box = {{ size = [4.0, 4.0, 2.0] }}, elements = [4, 4, 2] }}
[material.m]
model = "neo-hookean"
young = 1000.0
poisson = 0.3
[tool.t]
sphere = {ball}
[contact.c]
slave = "b.zmax"
master = "t"
discretization = "segment"
{how}
{steps}
"#
        ));
        bench.run(1, &[])
    };
    let by = |z: f64| {
        format!(
            "[[step]]\nincrements = 20\nfix = [{{ set = \"b.zmin\" }}]\nmove = [{{ target = \"t\", by = [0.0, 0.0, {z:?}] }}]\n"
        )
    };
    let small = "{ center = [2.0, 2.0, 2.6], radius = 0.6 }";
    let there = scene(small, "", &by(-0.5));
    let and_back = scene(small, "", &(by(-0.5) + &by(1.0)));
    let over = "[[step]]\nincrements = 5\nfix = [{ set = \"b.zmin\" }, { set = \"b.xmin\", directions = \"xz\" }]\n\
                move = [{ target = \"t\", by = [0.0, 0.0, -0.3] }]\n\
                [[step]]\nincrements = 20\nkeep = true\nmove = [{ target = \"t\", by = [-2.0, 0.0, -0.1] }]\n";
    let over = scene("{ center = [2.0, 2.0, 7.0], radius = 5.0 }", "friction = 0.1", over);
    for run in [there, and_back, over] {
        let (last, log) = (run.history(), run.log());
        let deepest = last.column("c.max_penetration").iter().fold(0.0, |most: f64, depth| most.max(*depth));
        assert!(run.code == 1 && run.stderr.contains("deep in the tool `t`"), "{}: {}{log}", run.code, run.stderr);
        assert!((0.2..0.2601).contains(&deepest), "{deepest}");
    }
}

/// A block that friction alone holds in a slot wider than it, pulled by next to nothing: equilibrium lets it stand askew and wedge
/// itself with forces that nothing has given it, and that is told of; where a tool presses it, it is not.
#[test]
fn energy_that_nothing_gave_is_told_of() {
    let pulled = |ceiling: f64, press: f64| {
        let bench = Bench::new(&format!(
            r#"
[body.b]
material = "m"
block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
[material.m]
model = "hooke"
young = 10.0
poisson = 0.3
[tool.above]
plane = {{ point = [0.0, 0.0, {ceiling:?}], normal = [0.0, 0.0, -1.0] }}
[tool.below]
plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
[contact.c]
slave = "b.zmax"
master = "above"
friction = 0.3
[contact.d]
slave = "b.zmin"
master = "below"
friction = 0.3
[[step]]
name = "hold"
increments = 1
fix = [{{ set = "b.zmin" }}]
move = [{{ target = "above", by = [0.0, 0.0, {press:?}] }}]
[[step]]
name = "pull"
increments = 2
force = [{{ target = "b.xmax", total = [0.001, 0.0, 0.0] }}]
"#
        ));
        bench.run(1, &[])
    };
    let told = "of elastic energy in the increment to time 1.5";
    let askew = pulled(2.2, 0.0);
    assert!(askew.code != 0 || askew.log().contains(told), "{}", askew.log());
    let pressed = pulled(2.0, -0.1);
    assert!(pressed.code == 0 && !pressed.log().contains("elastic energy in"), "{}", pressed.log());
}

/// A block of 10 x 10 x 5 between a floor and a plate, whose heights are given, with friction.
fn resting(floor: &str, plate: &str, steps: &str) -> Bench {
    Bench::new(&format!(
        r#"
[body.b]
material = "m"
[body.b.block]
box = {{ size = [10.0, 10.0, 5.0] }}
elements = [4, 4, 2]
[material.m]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[tool.floor]
plane = {{ point = [0.0, 0.0, {floor}], normal = [0.0, 0.0, 1.0] }}
[tool.plate]
plane = {{ point = [0.0, 0.0, {plate}], normal = [0.0, 0.0, -1.0] }}
[contact.below]
slave = "b.zmin"
master = "floor"
friction = 0.3
[contact.above]
slave = "b.zmax"
master = "plate"
friction = 0.3
{steps}
"#
    ))
}

/// Whether what rests and bears nothing is off its support by a rounding, or in it, makes no difference, nor whether it bore before.
#[test]
fn what_rests_may_be_off_by_a_rounding() {
    let press = "[[step]]\nincrements = 10\nmove = [{ target = \"plate\", by = [0.0, 0.0, -1.3] }]\n";
    let runs = ["0.0", "1e-14", "-1e-14", "-1e-5"].map(|floor| resting(floor, "6.0", press).solve(1, &[]));
    for run in &runs {
        let summary = run.summary();
        assert_eq!(
            (&summary["increments"], &summary["cutbacks"], &summary["jumps"]),
            (&10.into(), &0.into(), &0.into())
        );
        assert_close("force", run.history().last("floor.fz"), runs[0].history().last("floor.fz"), 1e-4);
    }
    assert_close("force", runs[1].history().last("floor.fz"), runs[0].history().last("floor.fz"), 1e-9);
    let again = format!(
        "{press}[[step]]\nincrements = 4\nkeep = true\nmove = [{{ target = \"plate\", by = [0.0, 0.0, 2.0] }}]\n\
         [[step]]\nincrements = 4\nkeep = true\nmove = [{{ target = \"plate\", by = [0.0, 0.0, -2.0] }}]\n"
    );
    for ranks in 1..=3 {
        let run = resting("0.0", "6.0", &again).solve(ranks, &[]);
        let (summary, history) = (run.summary(), run.history());
        // What is let go is no matter of rounding.
        assert_eq!((&summary["cutbacks"], &summary["jumps"]), (&0.into(), &0.into()));
        assert!(history.len() <= 22, "{}", history.len());
        // It stays where it was, and bears nothing.
        let lifted = history.column("time").iter().position(|time| *time == 2.0).unwrap();
        assert!(history.column("floor.fz")[lifted].abs() < 1e-9 * history.column("floor.fz")[9].abs());
        // Nothing slips that did not when it was first pressed, but by what it did on the way.
        assert_close("force", history.last("floor.fz"), runs[0].history().last("floor.fz"), 1e-4);
    }
}

/// A plate in a block by no more than what rounds in its mesh: what that bears is inexact, told of, and ends no run.
#[test]
fn forces_of_overlaps_as_small_as_rounding_are_told_of() {
    let steps = "[[step]]\nincrements = 1\n[[step]]\nincrements = 5\nkeep = true\n\
                 move = [{ target = \"plate\", by = [0.0, 0.0, -0.3] }]\n";
    let [touching, little, more] =
        ["5.0", "4.99999999999", "4.999999"].map(|plate| resting("0.0", plate, steps).solve(1, &[]));
    let told = "what acts on it was so little";
    let is_told = |run: &common::Run| run.summary()["warnings"].to_string().contains(told);
    assert_eq!([&touching, &little, &more].map(is_told), [false, true, false]);
    let [first, last] =
        [0, 5].map(|k| touching.history().column("floor.fz")[k].abs() - little.history().column("floor.fz")[k].abs());
    assert!(first.abs() < 1e-8 && last.abs() < 1e-6, "{first} {last}");
}

/// Half a beam that a roller bends over another one, from segment to segment: on coarse facets each is a tenth of the way in it unfelt,
/// which would be let pass, and both together let a fifth of the force go.
#[test]
fn what_contacts_let_in_one_after_the_other_adds_up() {
    let bent = |count: usize, ranks: usize| {
        let bench = Bench::new(&format!(
            r#"
            body.beam.material = "m"
            body.beam.element = "hex8-eas"
            body.beam.block = {{ box = {{ origin = [0, 0, 0], size = [50, 4, 5] }}, elements = [{count}, 2, 2] }}
            material.m = {{ model = "hooke", young = 70000, poisson = 0.3 }}
            tool.support.cylinder = {{ point = [40, -3, 0], axis = [0, 0, 1], radius = 3 }}
            tool.load.cylinder = {{ point = [0, 7, 0], axis = [0, 0, 1], radius = 3 }}
            contact.below = {{ slave = "beam.ymin", master = "support", friction = 0.2, discretization = "segment" }}
            contact.above = {{ slave = "beam.ymax", master = "load", friction = 0.2, discretization = "segment" }}
            [[step]]
            increments = 4
            fix = [{{ set = "beam.xmin", directions = "x" }}, {{ set = "beam.zmin", directions = "z" }}]
            move = [{{ target = "load", by = [0, -1, 0] }}]
            "#
        ));
        let run = bench.solve(ranks, &[]);
        let told = ["above", "below"].map(|contact| {
            let words = format!("contact `{contact}`: its gaps, closed in the mean over facets, let nodes be");
            run.log()
                .lines()
                .any(|line| line.contains(&words) && line.contains("with what other contacts of its bodies"))
        });
        (run.history().last("load.fy").abs(), told)
    };
    // 3 E I / L³ of a cantilever of L = 40 with I = 5 4³ / 12.
    let right = 3.0 * 70000.0 * (5.0 * 64.0 / 12.0) / 40f64.powi(3);
    for ranks in [1, 2] {
        let (force, told) = bent(25, ranks);
        assert!(force < 0.85 * right && told == [true; 2], "{ranks}: {force} for {right}, {told:?}");
    }
    let (force, told) = bent(100, 1);
    assert!((force / right - 1.0).abs() < 0.06 && told == [false; 2], "{force} for {right}, {told:?}");
}

/// A flat punch with fillets, which a force of more than friction bears drags over coarse facets, is found at once where a node comes
/// under a fillet: that it went there is told of. With less force it stays, and nothing is.
#[test]
fn what_goes_over_to_another_equilibrium_is_told_of() {
    for (along, goes) in [(24.4267, true), (9.0, false)] {
        let bench = Bench::new(&format!(
            r#"
            body.pad.block = {{ box = {{ size = [4, 1, 0.5] }}, elements = [8, 3, 1] }}
            body.pad.material = "m"
            body.pad.plane_strain = true
            material.m = {{ model = "neo-hookean", young = 1000, poisson = 0.3 }}
            tool.punch.profile = {{ points = [[1, 3], [1, 1], [3, 1], [3, 3]], fillets = 0.45 }}
            contact.c = {{ slave = "pad.ymax", master = "punch", friction = 0.3 }}
            [[step]]
            increments = 5
            fix = [{{ set = "pad.ymin" }}]
            move = [{{ target = "punch", by = [0, -0.06, 0] }}]
            [[step]]
            increments = 5
            fix = [{{ set = "pad.ymin" }}]
            force = [{{ target = "punch", total = [{along}, -62.6324, 0], directions = "xy" }}]
            "#
        ));
        let run = bench.solve(2, &[]);
        let words = "contact `c`: its nodes or its tool went";
        assert_eq!(run.log().contains(words), goes, "{along}: {}", run.log());
        assert_eq!(run.history().last("punch.ux") > 0.2, goes, "{along}");
    }
}

/// A roller that is pressed in between two rows of nodes, from segment to segment at first unfelt; in one pass it is drawn aside by as much
/// as it was deep, and has borne more before: both are told of, and so they are in a quarter of the model.
#[test]
fn what_is_unfelt_is_told_of_whenever_it_was() {
    let scene = |settings: &str, steps: &str| {
        format!(
            r#"
            body.pad.block = {{ box = {{ size = [4, 1, 2] }}, elements = [8, 2, 4] }}
            body.pad.material = "m"
            material.m = {{ model = "neo-hookean", young = 1000, poisson = 0.3 }}
            tool.roller.cylinder = {{ point = [2, 2, 0], axis = [0, 0, 1], radius = 1 }}
            contact.c = {{ slave = "pad.ymax", master = "roller"{settings} }}
            {steps}
            "#
        )
    };
    let press = |by: &str| {
        let turn = by.replace("AT", "point = [2.2, 1.95, 1.1], axis = [0.2, 0.1, 1]");
        format!(
            "[[step]]\nincrements = 3\nfix = [{{ set = \"pad.ymin\" }}]\nmove = [{{ target = \"roller\", {turn} }}]\n"
        )
    };
    let down = "[[step]]\nincrements = 4\nfix = [{ set = \"pad.ymin\" }]\nmove = [{ target = \"roller\", by = [0, -0.06, 0] }]";
    let run = Bench::new(&scene(", discretization = \"segment\"", down)).solve(2, &[]);
    let bears = run.history().column("roller.fy").iter().map(|f| *f != 0.0).collect::<Vec<_>>();
    assert!(!bears[0] && bears[3], "{bears:?}");
    let told = run.log().lines().find(|line| line.contains("while no gap was closed in the mean")).map(String::from);
    assert!(told.as_ref().is_some_and(|told| told.contains("(time 0.25")), "{}", run.log());

    let steps: String = [
        "by = [0.2, -0.05, 0.1]",
        "by = [0, -0.03, 0], rotate = { AT, angle = 24 }",
        "by = [0, 0, 0], rotate = { AT, angle = -12 }",
    ]
    .iter()
    .map(|by| press(by))
    .collect();
    let run = Bench::new(&scene("", &steps)).solve(2, &[]);
    let forces = run.history().column("roller.fy").to_vec();
    assert!(forces.iter().any(|f| *f < 1.05 * forces[8]), "{forces:?}");
    assert!(run.log().contains("of a facet, at the end of a step (time 3.000000)"), "{}", run.log());

    let told = [true, false].map(|whole| {
        let from = if whole { -1.0 } else { 0.0 };
        let (size, count) = (1.0 - from, if whole { 8 } else { 4 });
        let symmetry = if whole { "" } else { "body.b.symmetry = [\"xmin\", \"zmin\"]" };
        let run = Bench::new(&format!(
            r#"
            body.b.material = "m"
            body.b.element = "hex8-sri"
            {symmetry}
            body.b.block = {{ box = {{ origin = [{from:?}, 0, {from:?}], size = [{size:?}, 1, {size:?}] }}, elements = [{count}, 4, {count}] }}
            material.m = {{ model = "j2", young = 100, poisson = 0.3, yield_stress = 3, hardening = {{ linear = 10 }} }}
            tool.ball.sphere = {{ center = [0, 2.5, 0], radius = 1.5 }}
            contact.c = {{ slave = "b.ymax", master = "ball", friction = 0.2 }}
            [[step]]
            increments = 3
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "ball", by = [0, -0.12, 0] }}]
            "#
        ))
        .solve(1, &[]);
        run.log().contains("its nodes do not feel that between them the tool `ball` is")
    });
    assert_eq!(told, [true; 2]);
}

/// A cylinder that is pressed in midway between two nodes: coarse facets bear six tenths of what fine ones do, which is told of, on any
/// number of ranks, and where the cylinder has gone up again.
#[test]
fn what_is_between_nodes_is_told_of_by_what_gives_way() {
    let pressed = |x: f64, count: usize, more: &str, ranks: usize| {
        let bench = Bench::new(&format!(
            r#"
            body.b.material = "m"
            body.b.plane_strain = true
            body.b.block = {{ box = {{ origin = [-4.0, -3.0, 0.0], size = [8.0, 3.0, 1.0] }}, elements = [{}, {}, 1] }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            tool.t = {{ cylinder = {{ point = [{x}, 1.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }} }}
            contact.c = {{ slave = "b.ymax", master = "t" }}
            [[step]]
            increments = 4
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "t", by = [0.0, -0.05, 0.0] }}]
            {more}
            "#,
            8 * count,
            3 * count
        ));
        let run = bench.solve(ranks, &[]);
        let most = run.history().column("t.fy").iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        (most, run.log().contains("its nodes do not feel that between them"))
    };
    let up =
        "[[step]]\nincrements = 2\nfix = [{ set = \"b.ymin\" }]\nmove = [{ target = \"t\", by = [0.0, 0.045, 0.0] }]";
    let right = pressed(0.25, 16, "", 1);
    assert!(!right.1, "{right:?}");
    for (more, ranks) in [("", 1), ("", 2), (up, 1)] {
        let coarse = pressed(0.25, 2, more, ranks);
        assert!(coarse.0 < 0.6 * right.0 && coarse.1, "{more} {ranks}: {coarse:?}, {right:?}");
    }
    // On a node a mesh that is twice as fine lacks a ninth, of which is told, too, and one that is four times as fine 4 %, of which is not.
    for (count, off, is_told) in [(4, 0.14, true), (8, 0.05, false)] {
        let on_node = pressed(0.0, count, up, 2);
        assert!((on_node.0 / right.0 - 1.0).abs() < off && on_node.1 == is_told, "{count}: {on_node:?}, {right:?}");
    }
}
