//! Tools that turn, are driven by force, come, go and are fast.

mod common;

use common::{Bench, History, Run, assert_close, assert_small, msh};
use nagata::Vec3;

/// A slab in plane strain, 8 x 2, with its top at y = 0 and its bottom held.
fn slab(tool: &str, friction: f64, contact: &str, steps: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.slab]
        block = {{ box = {{ origin = [-4.0, -2.0, 0.0], size = [8.0, 2.0, 0.5] }}, elements = [24, 5, 1] }}
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.roll]
        {tool}
        [contact.top]
        slave = "slab.ymax"
        master = "roll"
        friction = {friction:?}
        {contact}
        {steps}
        [output]
        history = ["slab.ymin", "slab.xmax"]
        "#
    ))
}

fn step(name: &str, increments: usize, conditions: &str) -> String {
    format!("[[step]]\nname = \"{name}\"\nincrements = {increments}\nfix = [{{ set = \"slab.ymin\" }}]\n{conditions}\n")
}

const ROLL: &str = "cylinder = { point = [0.0, 1.5, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.5 }";

fn roll_by(x: f64, y: f64) -> String {
    format!("move = [{{ target = \"roll\", by = [{x:?}, {y:?}, 0.0] }}]")
}

/// ```text
///        ( <-' )          A pressed roll turns about its own axis, which stays. Once all nodes slip, its torque is mu R times
///     ___/   \___         the sum of the normal forces, and it drags the slab along x.
/// ```
#[test]
fn roll_that_turns_about_its_axis() {
    let mu = 0.3;
    let turn =
        "move = [{ target = \"roll\", rotate = { point = [0.0, 1.3, 0.0], axis = [0.0, 0.0, 1.0], angle = 30.0 } }]";
    let steps = step("press", 4, &roll_by(0.0, -0.2)) + &step("turn", 12, turn);
    let run = slab(ROLL, mu, "", &steps).solve(2, &[]);
    let history = run.history();
    let last = run.written();
    let (points, moved) = (run.points("contact.top"), run.vectors(last, "contact.top", "displacement"));
    let (force, status) = (run.vectors(last, "contact.top", "force"), run.scalars(last, "contact.top", "status"));
    let (mut torque, mut normal) = (0.0, 0.0);
    for n in 0..points.len() {
        let x = Vec3::from(points[n]) + Vec3::from(moved[n]);
        let arm = Vec3::new(x.x, x.y - 1.3, 0.0);
        let f = Vec3::from(force[n]);
        torque += arm.cross(&f).z;
        normal += f.dot(&arm.normalize());
        assert!(status[n] != 1.0 && (status[n] == 0.0 || (arm.norm() - 1.5).abs() < 1e-10));
    }
    assert_close("torque", torque, mu * 1.5 * normal, 1e-8);
    let (drag, push) = (history.last("roll.fx"), -history.last("roll.fy"));
    println!("drag over push {}", drag / push);
    assert!(drag > 0.9 * mu * push, "{drag} {push}");
    assert_small("balance", (drag + history.last("slab.ymin.fx")) / push, 1e-9);
    let before = history.steps.iter().rposition(|s| s == "press").unwrap();
    assert_small("no drag before", history.column("roll.fx")[before] / push, 1e-9);
}

/// A force has pressed the roll, how far only the run knows; it turns about its own axis all the same, and without
/// friction nothing changes.
#[test]
fn roll_that_a_force_has_moved_turns_about_its_axis() {
    let force = "force = [{ target = \"roll\", total = [0.0, -8.0, 0.0], directions = \"y\" }]\n";
    let turn =
        "move = [{ target = \"roll\", rotate = { point = [0.0, 1.5, 0.0], axis = [0.0, 0.0, 1.0], angle = 90.0 } }]";
    for held in [true, false] {
        let turn = if held { turn.to_string() } else { force.to_string() + turn };
        let steps = step("press", 2, force) + &step("turn", 4, &turn);
        let run = slab(ROLL, 0.0, "", &steps).solve(1, &[]);
        let [before, after] = [2, 6].map(|k| run.vectors(k, "body.slab", "displacement"));
        let depth = before.iter().map(|u| -u[1]).fold(0.0, f64::max);
        assert!(depth > 0.05, "{depth}");
        for (before, after) in before.iter().zip(&after) {
            (0..3).for_each(|d| assert_small("what turning changes", (after[d] - before[d]) / depth, 1e-8));
        }
    }
}

/// A bowl of Nagata patches and a plane are tilted and turned about a slanted axis and back: without friction everything is
/// as before.
#[test]
fn turning_there_and_back() {
    let bowl = |s: f64, t: f64| {
        let (x, y) = (6.0 * s - 1.5, 4.5 - 6.0 * t);
        [x, y, 1.0 + 0.1 * ((x - 1.2).powi(2) + 0.5 * (y - 1.1).powi(2))]
    };
    for tool in ["mesh = \"bowl.msh\"", "plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }"] {
        let turn = |angle: f64| {
            format!(
                r#"
                [[step]]
                increments = 3
                fix = [{{ set = "block.zmin" }}]
                move = [{{
                    target = "tool",
                    rotate = {{ point = [1.5, 1.5, 0.9], axis = [0.3, 1.0, 0.7], angle = {angle:?} }},
                }}]
                "#
            )
        };
        let bench = Bench::new(&format!(
            r#"
            [body.block]
            block = {{ box = {{ size = [3.0, 3.0, 1.0] }}, elements = [6, 6, 2] }}
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = 10.0
            poisson = 0.3
            [tool.tool]
            {tool}
            [contact.top]
            slave = "block.zmax"
            master = "tool"
            [[step]]
            increments = 2
            fix = [{{ set = "block.zmin" }}]
            move = [{{ target = "tool", by = [0.0, 0.0, -0.2] }}]
            {}
            {}
            [output]
            every = 100
            history = ["block.zmin", "block.xmax", "block.zmax"]
            "#,
            turn(6.0),
            turn(-6.0)
        ));
        bench.write("bowl.msh", &msh::surface(5, bowl));
        let history = bench.solve(2, &[]).history();
        let sets = ["tool", "block.zmin", "block.xmax", "block.zmax"];
        let moved = history.row_difference(4, &history, 1, &sets);
        assert!(moved > 0.05, "{moved}");
        assert_small(tool, history.row_difference(7, &history, 1, &sets), 1e-8);
    }
}

/// A roll that is pushed by a force, not moved by a displacement, bears just this force, and stands where the displacement
/// would have had to bring it.
#[test]
fn driven_by_force() {
    let push = |y: f64| format!("force = [{{ target = \"roll\", total = [0.0, {y:?}, 0.0], directions = \"y\" }}]");
    let steps = step("press", 4, &push(-12.0)) + &step("lift", 2, &push(-6.0));
    let driven = slab(ROLL, 0.0, "", &steps).solve(2, &[]);
    assert_eq!(driven.summary()["matrix"], "symmetric indefinite");
    let driven = driven.history();
    for (k, force) in [-3.0, -6.0, -9.0, -12.0, -9.0, -6.0].into_iter().enumerate() {
        assert_close("force", driven.column("roll.fy")[k], force, 1e-8);
        assert_small("no other", driven.column("roll.fx")[k], 1e-8);
    }
    let depth = driven.column("roll.uy");
    println!("depths {depth:?}");
    let steps = step("press", 4, &roll_by(0.0, depth[3])) + &step("lift", 2, &roll_by(0.0, depth[5] - depth[3]));
    let moved = slab(ROLL, 0.0, "", &steps).solve(2, &[]).history();
    for k in [3, 5] {
        assert_small("as when moved", driven.row_difference(k, &moved, k, &["roll", "slab.ymin", "slab.xmax"]), 1e-8);
    }
}

/// A force closes the gap first, whatever its size.
#[test]
fn driven_by_force_from_a_distance() {
    let steps = step("press", 2, "force = [{ target = \"roll\", total = [0.0, -4.0, 0.0], directions = \"y\" }]");
    let near = slab(ROLL, 0.0, "", &steps).solve(1, &[]).history();
    for gap in [0.05, 3.0] {
        let far = ROLL.replace("1.5, 0.0]", &format!("{:?}, 0.0]", 1.5 + gap));
        let far = slab(&far, 0.0, "", &steps).solve(2, &[]).history();
        assert_close("way", near.last("roll.uy") - far.last("roll.uy"), gap, 1e-8);
        assert_close("support", far.last("slab.ymin.fy"), near.last("slab.ymin.fy"), 1e-9);
    }
}

/// A roll that was pressed by a displacement and is then driven by force begins with the force that it has.
#[test]
fn a_force_takes_over() {
    let push = "force = [{ target = \"roll\", total = [0.0, -6.0, 0.0], directions = \"y\" }]";
    let steps = step("press", 2, &roll_by(0.0, -0.3)) + &step("ease", 3, push);
    let history = slab(ROLL, 0.3, "", &steps).solve(2, &[]).history();
    let force = history.column("roll.fy");
    assert!(force[1] < -8.0, "{force:?}");
    for k in 1..=3 {
        assert_close("force", force[1 + k], force[1] + (-6.0 - force[1]) * k as f64 / 3.0, 1e-9);
    }
}

/// A plate that sticks to a block is pushed askew by a force along all axes; and one that slips along x by its own
/// displacement carries a force along y.
#[test]
fn driven_by_force_with_friction() {
    let bench = Bench::new(
        r#"
        [body.block]
        block = { box = { size = [2.0, 2.0, 1.0] }, elements = [4, 4, 2] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [tool.plate]
        plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }
        [contact.top]
        slave = "block.zmax"
        master = "plate"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "block.zmin" }]
        force = [{ target = "plate", total = [0.5, -0.3, -4.0], directions = "xyz" }]
        [[step]]
        name = "drag"
        increments = 6
        fix = [{ set = "block.zmin" }]
        move = [{ target = "plate", by = [1.5, 0.0, 0.0] }]
        force = [{ target = "plate", total = [0.0, 0.0, -4.0], directions = "z" }]
        [output]
        every = 100
        history = ["block.zmin"]
        "#,
    );
    let history = bench.solve(2, &[]).history();
    for (component, force) in [("fx", 0.5), ("fy", -0.3), ("fz", -4.0)] {
        assert_close(component, history.column(&format!("plate.{component}"))[1], force, 1e-8);
        assert_close(component, history.column(&format!("block.zmin.{component}"))[1], -force, 1e-8);
    }
    assert_close("drag", history.last("plate.fx"), 1.2, 1e-6);
    assert_close("push", history.last("plate.fz"), -4.0, 1e-8);
}

/// The penalty is on the way only, not in the result.
#[test]
fn penalties() {
    let steps = step("press", 4, &roll_by(0.0, -0.3)) + &step("slide", 4, &roll_by(0.6, -0.05));
    let bench = |penalty: &str, friction: f64| slab(ROLL, friction, penalty, &steps).solve(2, &[]).history();
    // The automatic one is a fifth of the stiffness of a node, which is about E times the thickness of the slab.
    for (friction, penalties) in [(0.0, &[1.0, 10.0, 100.0][..]), (0.3, &[3.0, 10.0, 30.0])] {
        let auto = bench("", friction);
        for penalty in penalties {
            let other = bench(&format!("penalty = {penalty:?}"), friction);
            assert_eq!(auto.len(), other.len());
            let worst = (0..auto.len())
                .map(|k| other.row_difference(k, &auto, k, &["roll", "slab.ymin", "slab.xmax"]))
                .fold(0.0, f64::max);
            assert_small(&format!("friction {friction}, penalty {penalty}"), worst, 1e-8);
        }
    }
}

/// A roll comes from afar, presses as one does that began at the surface, and goes again: then nothing is left.
#[test]
fn comes_and_goes() {
    let away = "cylinder = { point = [0.0, 5.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.5 }";
    for friction in [0.0, 0.3] {
        let steps = step("come", 7, &roll_by(0.0, -3.5))
            + &step("press", 2, &roll_by(0.0, -0.2))
            + &step("go", 3, &roll_by(0.0, 1.5));
        let history = slab(away, friction, "", &steps).solve(2, &[]).history();
        let near = slab(ROLL, friction, "", &step("press", 2, &roll_by(0.0, -0.2))).solve(2, &[]).history();
        assert!((0..6).all(|k| history.column("roll.fy")[k] == 0.0 && history.column("top.active")[k] == 0.0));
        assert_small("pressed", history.row_difference(8, &near, 1, &["slab.ymin", "slab.xmax"]), 1e-8);
        assert_close("force", history.column("roll.fy")[8], near.last("roll.fy"), 1e-8);
        let scale = history.largest_force("roll");
        for set in ["roll", "slab.ymin", "slab.xmax"] {
            let force = ["fx", "fy", "fz"].map(|c| history.last(&format!("{set}.{c}")).abs()).iter().sum::<f64>();
            assert_small(&format!("force on {set} when gone"), force / scale, 1e-9);
        }
        let rest = ["ux", "uy"].map(|c| history.last(&format!("slab.xmax.{c}")).abs()).iter().sum::<f64>();
        assert_small("displacement when gone", rest, 1e-10);
    }
}

/// Least distance of the slab's top from the surface of the roll, whose axis began at (-1, 9); negative inside.
fn least_gap(run: &Run) -> f64 {
    let (history, last) = (run.history(), run.written());
    let center = [history.last("roll.ux") - 1.0, history.last("roll.uy") + 9.0];
    let (points, moved) = (run.points("body.slab"), run.vectors(last, "body.slab", "displacement"));
    let top = points.iter().zip(moved).filter(|(x, _)| x[1] == 0.0);
    top.map(|(x, u)| (x[0] + u[0] - center[0]).hypot(x[1] + u[1] - center[1]) - 1.5).fold(f64::INFINITY, f64::min)
}

/// A roll that comes from seven times the reach in a single increment, and goes on by several elements in another, is not
/// overlooked: without friction the slab is as if it had been slow. The same with a tool of many small patches, of which
/// several go by in an increment.
#[test]
fn fast_tools_are_seen() {
    let analytic = "cylinder = { point = [-1.0, 9.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.5 }";
    // A quarter of the cylinder, with normals down; patches over the angle b are off by b^4 R / 128.
    let arc = |s: f64, t: f64| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * (s - 0.5)).sin_cos();
        [1.5 * sin - 1.0, 9.0 - 1.5 * cos, t - 0.25]
    };
    for (tool, tolerance) in [(analytic, 1e-12), ("mesh = \"arc.msh\"", 1e-6)] {
        let run = |come: usize, slide: usize| {
            let steps = step("come", come, &roll_by(0.0, -7.7)) + &step("slide", slide, &roll_by(2.0, 0.0));
            let bench = slab(tool, 0.0, "", &steps);
            bench.write("arc.msh", &msh::surface(16, arc));
            let run = bench.solve(2, &[]);
            assert_small("inside the roll", least_gap(&run).min(0.0), tolerance);
            assert_small("penetration", run.history().last("top.max_penetration").max(0.0), 1e-10);
            run.history()
        };
        let (fast, slow) = (run(1, 1), run(77, 20));
        let at = |history: &History, step: &str| history.steps.iter().rposition(|s| s == step).unwrap();
        for step in ["come", "slide"] {
            let sets = ["roll", "slab.ymin", "slab.xmax"];
            let error = fast.row_difference(at(&fast, step), &slow, at(&slow, step), &sets);
            assert_small(&format!("{step}, fast and slow"), error, 1e-8);
        }
        assert!(slow.largest_force("roll") > 1.0);
    }
}

/// Two bodies far apart under one plate of 12 x 12 facets: each contact sees its own part of the plate.
#[test]
fn two_contacts_of_one_tool() {
    let bench = Bench::new(
        r#"
        [body.a]
        material = "soft"
        block = { box = { origin = [-9.0, -9.0, -5.0], size = [4.0, 4.0, 5.0] }, elements = [2, 2, 3] }
        [body.b]
        material = "soft"
        block = { box = { origin = [5.0, 5.0, -5.0], size = [4.0, 4.0, 5.0] }, elements = [2, 2, 3] }
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.plate]
        mesh = "plate.msh"
        [contact.on_a]
        slave = "a.zmax"
        master = "plate"
        [contact.on_b]
        slave = "b.zmax"
        master = "plate"
        [[step]]
        increments = 3
        fix = [{ set = "a.zmin" }, { set = "b.zmin" }]
        move = [{ target = "plate", by = [0.0, 0.0, -0.5] }]
        [output]
        history = ["a.zmin", "b.zmin"]
        "#,
    );
    bench.write("plate.msh", &msh::surface(12, |s, t| [24.0 * t - 12.0, 24.0 * s - 12.0, 0.1]));
    for ranks in [1, 2] {
        let history = bench.solve(ranks, &[]).history();
        let (a, b) = (history.last("a.zmin.fz"), history.last("b.zmin.fz"));
        assert!(a > 100.0 && history.last("on_a.active") == 9.0);
        assert_close("the same force on both", a, b, 1e-9);
        assert_close("balance", -history.last("plate.fz"), a + b, 1e-9);
    }
}

/// The solid of a bore is around it: a roll that is hollow by mistake has the slab inside.
#[test]
fn a_slab_inside_its_tool_is_refused() {
    let bore = ROLL.replace(" }", ", hollow = true }");
    let run = slab(&bore, 0.0, "", &step("press", 1, &roll_by(0.0, -0.01))).run(2, &[]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("the tool `roll` looks away from `slab.ymax`"), "{}", run.stderr);
    let run = slab(ROLL, 0.0, "", &step("press", 1, &roll_by(0.0, -0.01))).run(2, &[]);
    assert!(!run.log().contains("warning"), "{}", run.log());
}

/// Nodes that are held along the normal of a tool cannot give way to it: where it stays away from them the others carry
/// it, where it would go into them it is refused.
#[test]
fn nodes_held_against_a_tool() {
    let plate = "plane = { point = [0.0, 0.0, 8.0], normal = [0.0, 0.0, -1.0] }";
    let roll = "cylinder = { point = [12.0, 0.0, 28.0], axis = [0.0, 1.0, 0.0], radius = 20.0 }";
    for (friction, tool) in [(0.0, roll), (0.3, roll), (0.0, plate), (0.3, plate)] {
        let bench = Bench::new(&format!(
            r#"
            [body.block]
            block = {{ box = {{ size = [20.0, 20.0, 8.0] }}, elements = [5, 5, 4] }}
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [tool.plate]
            {tool}
            [contact.top]
            slave = "block.zmax"
            master = "plate"
            friction = {friction:?}
            [[step]]
            increments = 2
            fix = [{{ set = "block.zmin" }}, {{ set = "block.xmin", directions = "xz" }}]
            move = [{{ target = "plate", by = [0.0, 0.0, -0.2] }}]
            "#
        ));
        if tool == roll {
            let history = bench.solve(2, &[]).history();
            assert_eq!(history.last("top.active"), 6.0);
        } else {
            let run = bench.run(2, &[]);
            assert_eq!(run.code, 2);
            assert!(run.stderr.contains("comes to be 2.000e-1 inside the tool `plate`"), "{}", run.stderr);
        }
    }
}

/// A block that only a pressure holds to a table goes down with it, as far as that goes in an increment and in whatever way
/// contact is enforced; so it does on a table that is a body.
#[test]
fn what_only_loads_press_goes_down_with_its_table() {
    let scene = |table: &str, method: &str, friction: f64, down: &str| {
        Bench::new(&format!(
            r#"
            [body.block]
            block = {{ box = {{ origin = [0.0, 0.0, 1.0], size = [1.0, 1.0, 1.0] }}, elements = [2, 2, 2] }}
            material = "soft"
            {table}
            [material.soft]
            model = "neo-hookean"
            young = 2000.0
            poisson = 0.3
            [contact.c]
            slave = "block.zmin"
            friction = {friction:?}
            method = "{method}"
            {down}
            "#
        ))
    };
    let steps = |master: &str, fix: &str, target: &str| {
        let fix = format!("[{{ set = \"block.zmax\", directions = \"xy\" }}{fix}]");
        format!(
            r#"
            master = "{master}"
            [[step]]
            increments = 1
            fix = {fix}
            pressure = [{{ set = "block.zmax", value = 1.0 }}]
            [[step]]
            increments = 2
            keep = true
            move = [{{ target = "{target}", by = [0.0, 0.0, -1.0] }}]
            [output]
            history = ["block.zmax", "block.zmin"]
            "#
        )
    };
    let rigid = steps("table", "", "table");
    let rigid = |method, friction| {
        scene("[tool.table]\nplane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, 1.0] }", method, friction, &rigid)
    };
    let body = "[body.t]\nmaterial = \"soft\"\nblock = { box = { origin = [-0.5, -0.5, 0.0], size = [2.0, 2.0, 1.0] }, elements = [4, 4, 1] }";
    let deformable = steps("t.zmax", ", { set = \"t.zmin\" }", "t.zmin");
    let mut benches = vec![("c.fz", scene(body, "augmented-lagrangian", 0.3, &deformable))];
    for method in ["augmented-lagrangian", "penalty", "uzawa", "lagrange"] {
        benches.extend([0.0, 0.3].map(|friction| ("table.fz", rigid(method, friction))));
    }
    for (force, bench) in benches {
        let history = bench.solve(2, &[]).history();
        let column = history.column("block.zmax.uz");
        assert_close("it goes down", column[2] - column[0], -1.0, 1e-3);
        assert_close("pressed as before", history.last(force).abs(), 1.0, 1e-9);
    }
}

/// A plane that a force presses on the held sides of a block, and a cone on the held rim of a ring: nodes that cannot give way
/// share the force as symmetry says, on any number of ranks.
#[test]
fn nodes_that_cannot_give_way_share_a_driven_tool() {
    let block = Bench::new(
        r#"
        [body.block]
        block = { box = { size = [4.0, 4.0, 1.0] }, elements = [2, 2, 1] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.plate]
        plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }
        [contact.c]
        slave = "block.zmax"
        master = "plate"
        [[step]]
        increments = 2
        fix = [{ set = "block.zmin" }, { set = "block.xmin" }, { set = "block.xmax" }]
        force = [{ target = "plate", total = [0.0, 1e-14, -100.0], directions = "z" }]
        [output]
        history = ["block.xmin", "block.xmax"]
        "#,
    );
    let ring = Bench::new(
        r#"
        [body.ring]
        block = { sector = { radii = [10.0, 20.0], angles = [0.0, 90.0], length = 5.0 }, elements = [2, 4, 1] }
        material = "soft"
        symmetry = ["amin", "amax"]
        [material.soft]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.plug]
        cone = { apex = [0.0, 0.0, -114.300523027613], axis = [0.0, 0.0, 1.0], angle = 5.0 }
        [contact.c]
        slave = "ring.rmin"
        master = "plug"
        [[step]]
        increments = 2
        fix = [{ set = "ring.zmin" }]
        force = [{ target = "plug", total = [0.0, 0.0, -500.0], directions = "z" }]
        "#,
    );
    for ranks in [1, 2, 3] {
        let history = block.solve(ranks, &[]).history();
        for side in ["block.xmin.fz", "block.xmax.fz"] {
            assert_close(side, history.last(side), 50.0, 1e-6);
        }
        let history = ring.solve(ranks, &[]).history();
        assert_close("across", history.last("plug.fx"), history.last("plug.fy"), 1e-6);
    }
}

/// A cube of steel in a corner, 40 mm wide, on a floor and against a wall with friction, by its own weight of 5 N: its penalties
/// are eased until rounding leaves enough of that.
#[test]
fn steel_rests_in_a_corner() {
    let bench = Bench::new(
        r#"
        [body.cube]
        block = { box = { size = [40.0, 40.0, 40.0] }, elements = [4, 4, 4] }
        material = "steel"
        [material.steel]
        model = "neo-hookean"
        young = 210e3
        poisson = 0.3
        density = 7.85e-9
        [tool.floor]
        plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
        [tool.wall]
        plane = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
        [contact.f]
        slave = "cube.zmin"
        master = "floor"
        friction = 0.2
        [contact.w]
        slave = "cube.xmin"
        master = "wall"
        friction = 0.2
        [[step]]
        increments = 2
        gravity = [-2000.0, 0.0, -9810.0]
        "#,
    );
    let mass = 7.85e-9 * 64e3;
    for ranks in [1, 2] {
        let history = bench.solve(ranks, &[]).history();
        let sum = |of: &str| ["floor", "wall"].map(|tool| history.last(&format!("{tool}.{of}"))).iter().sum::<f64>();
        assert_close("push", sum("fx"), 2000.0 * mass, 1e-5);
        assert_close("weight", sum("fz"), 9810.0 * mass, 1e-5);
        assert_close("floor", history.last("floor.fz"), 4.734, 1e-3);
    }
}

/// A block with its bottom held and a tool over it, pressed down by so much in two increments.
fn under(tool: &str, by: f64, rest: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.b]
        block = {{ box = {{ origin = [-6.0, -6.0, 0.0], size = [12.0, 12.0, 6.0] }}, elements = [4, 4, 2] }}
        material = "m"
        [material.m]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.t]
        {tool}
        [contact.c]
        slave = "b.zmax"
        master = "t"
        {rest}
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "b.zmin" }}]
        move = [{{ target = "t", by = [0.0, 0.0, {by:?}] }}]
        "#
    ))
}

/// Facets that meet in a line along y at a height of 6, and rise by so much to x = -6 and 6.
fn wedge_mesh(rise: f64) -> String {
    msh::surface(2, |s, t| [12.0 * t - 6.0, 18.0 * s - 9.0, 6.0 + rise * (2.0 * t - 1.0).abs()])
}

/// ```text
///      \     /         Nodes exactly under the edge of a wedge, or the tip of a cone, are on all of its sides: by symmetry nothing pushes
///     __\   /__        across. A profile and the facets of the same shape are one tool, however sharp the edge is. Where a torque turns
///        \_/           it, too.
/// ```
#[test]
fn what_stands_under_an_edge_is_on_both_sides() {
    let drawn = |points: &str| {
        format!(
            "profile = {{ points = [{points}], extrude = {{ origin = [0.0, 9.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0], length = 18.0 }} }}"
        )
    };
    let wedge = |rise: f64| drawn(&format!("[-6.0, {0:?}], [0.0, 6.0], [6.0, {0:?}]", 6.0 + rise));
    let told = "exactly under a sharp edge or a tip of the tool `t`";
    for friction in ["", "friction = 0.3"] {
        // In the last case iterates are so deep that their feet on the sides are far from the edge.
        for (rise, by) in [(2.0, -0.8), (12.0, -0.8), (12.0, -2.4)] {
            let facets = under("mesh = \"w.msh\"\nsmoothing = \"facet\"", by, friction);
            facets.write("w.msh", &wedge_mesh(rise));
            let (facets, profile) = (facets.solve(1, &[]).history(), under(&wedge(rise), by, friction).solve(2, &[]));
            assert!(!profile.log().contains(told), "{}", profile.log());
            let profile = profile.history();
            let force = facets.last("t.fz");
            assert_close("as facets", profile.last("t.fz"), force, 1e-8);
            assert_small("across the wedge", profile.last("t.fx") / force, 1e-9);
        }
    }
    let height = 6.0;
    let cone =
        |angle: f64| format!("cone = {{ apex = [0.0, 0.0, {height:?}], axis = [0.0, 0.0, 1.0], angle = {angle:?} }}");
    let revolved = |angle: f64| {
        format!(
            "profile = {{ points = [[0.0, {height:?}], [6.0, {:?}]], revolve = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] }} }}",
            height + 6.0 / angle.to_radians().tan()
        )
    };
    let forces = [cone(72.0), revolved(72.0), cone(40.0), revolved(40.0)].map(|tool| {
        let history = under(&tool, -0.8, "").solve(1, &[]).history();
        let force = history.last("t.fz");
        for across in ["t.fx", "t.fy"] {
            assert_small(across, history.last(across) / force, 1e-9);
        }
        force
    });
    assert_close("the cone as a profile", forces[1], forces[0], 1e-8);
    assert_close("the sharp cone as a profile", forces[3], forces[2], 1e-8);
    // Half of the block, held in its plane of symmetry, bears half.
    let half = [
        "body.b.block={ box = { origin = [0.0, -6.0, 0.0], size = [6.0, 12.0, 6.0] }, elements = [2, 4, 2] }",
        "step.press.fix=[{ set = \"b.zmin\" }, { set = \"b.xmin\", directions = \"x\" }]",
    ];
    let whole = under(&wedge(6.0), -0.2, "").solve(1, &[]).history();
    let held = under(&wedge(6.0), -0.2, "").solve(1, &["--set", half[0], "--set", half[1]]).history();
    assert_close("half", 2.0 * held.last("t.fz"), whole.last("t.fz"), 1e-9);
    // Free to turn it stays, and it turns by the angle that has the moment.
    let wedge_to_turn = || under(&wedge(1.0), -0.8, "");
    let line = "point = [0.0, 0.0, 6.0], axis = [0.0, 1.0, 0.0]";
    let driven = |total: f64| {
        let turn = format!("step.press.torque=[{{ tool = \"t\", total = {total:?}, {line} }}]");
        wedge_to_turn().solve(1, &["--set", &turn]).history()
    };
    let (still, free, turned) = (wedge_to_turn().solve(1, &[]).history(), driven(0.0), driven(500.0));
    assert_close("free to turn", free.last("t.fz"), still.last("t.fz"), 1e-8);
    assert_small("angle", free.last("t.angle"), 1e-8);
    let angle = turned.last("t.angle");
    assert!(angle.abs() > 0.5, "{angle}");
    let turn = format!(
        "step.press.move=[{{ target = \"t\", by = [0.0, 0.0, -0.8], rotate = {{ {line}, angle = {angle:?} }} }}]"
    );
    let prescribed = wedge_to_turn().solve(1, &["--set", &turn]).history();
    for component in ["t.fx", "t.fz"] {
        assert_close(component, prescribed.last(component), turned.last(component), 1e-8);
    }
    // Nodes under the edge of a block look at its lower side alone.
    let punch = drawn("[-3.0, 9.0], [-3.0, 6.0], [3.0, 6.0], [3.0, 9.0]");
    let run = under(&punch, -0.2, "").solve(1, &[]);
    assert!(!run.log().contains(told), "{}", run.log());
}

/// The end of a profile lies on a row of nodes. As a torque turns it, what sticks there is neither lost nor found anew by rounding: it is
/// as on a tool that ends a little farther.
#[test]
fn a_torque_turns_a_profile_that_ends_on_nodes() {
    let plate = |more: f64| {
        let tool = format!(
            "profile = {{ points = [[-4.0, 0.0], [4.0, 0.0]], extrude = {{ origin = [0.0, {:?}, 6.0], x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0], length = {:?} }} }}",
            3.0 + more,
            6.0 + 2.0 * more
        );
        let torque = "[[step]]\nname = \"turn\"\nincrements = 2\nkeep = true\ntorque = [{ tool = \"t\", total = 100.0, point = [0.0, 0.0, 6.0], axis = [0.0, 0.0, 1.0] }]\n";
        let bench = under(&tool, -0.2, "friction = 0.4");
        let scene = std::fs::read_to_string(bench.path("scene.toml")).unwrap();
        bench.write("scene.toml", &(scene + torque));
        bench.solve(1, &[]).history()
    };
    let (on, beyond) = (plate(0.0), plate(0.1));
    assert_eq!((on.last("c.active"), on.steps.len()), (9.0, 4));
    for column in ["t.angle", "t.fz"] {
        assert_close(column, on.last(column), beyond.last(column), 1e-8);
    }
}

/// The tip of a V on a node of a round back, which is in the plane of symmetry of its half: the half bears half, and nothing pushes
/// it along.
#[test]
fn a_tip_in_a_plane_of_symmetry() {
    let pressed = |to: f64, symmetry: &str| {
        let bench = Bench::new(&format!(
            "[body.b]\nblock = {{ sector = {{ radii = [2.0, 4.0], angles = [60.0, {to:?}], length = 0.5 }}, \
             elements = [4, {}, 1] }}\nmaterial = \"m\"\nplane_strain = true\n{symmetry}\
             [material.m]\nmodel = \"hooke\"\nyoung = 1000.0\npoisson = 0.3\n\
             [tool.v]\nprofile = {{ points = [[-0.6, 7.4], [0.0, 4.0], [0.6, 7.4]], \
             extrude = {{ origin = [0, 0, -1], length = 3.0 }} }}\n\
             [contact.c]\nslave = \"b.rmax\"\nmaster = \"v\"\nfriction = 0.3\n\
             [[step]]\nincrements = 3\nfix = [{{ set = \"b.rmin\" }}]\nmove = [{{ target = \"v\", by = [0.0, -0.1, 0.0] }}]\n",
            ((to - 60.0) / 15.0).round()
        ));
        let history = bench.solve(1, &[]).history();
        ["v.fx", "v.fy", "c.max_pressure"].map(|column| history.last(column))
    };
    let ([x, y, pressure], whole) = (pressed(90.0, "symmetry = [\"amax\"]\n"), pressed(120.0, ""));
    assert_close("force", 2.0 * y, whole[1], 1e-9);
    assert_close("pressure", pressure, whole[2], 1e-9);
    assert!(y < -1.0 && x.abs() < 1e-9 * y.abs() && whole[0].abs() < 1e-9 * y.abs(), "{x} {y} {whole:?}");
}
