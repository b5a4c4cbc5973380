//! Torques on tools: moments balance, at full slip and held below, and a knob turns by the angle that its torque makes.

mod common;

use common::{Bench, Run, assert_close, assert_small, nagata};

type Vec3 = nalgebra::Vector3<f64>;

/// A roller of radius 5 on a rubber pad of 16 x 6 x 4, pressed with 40 N, then turned about its axis along y.
fn roller(steps: &str) -> String {
    format!(
        r#"
body.pad.block = {{ box = {{ origin = [-8, -3, -4], size = [16, 6, 4] }}, elements = [16, 1, 2] }}
body.pad.material = "rubber"
material.rubber = {{ model = "neo-hookean", young = 20, poisson = 0.3 }}
tool.roller.cylinder = {{ point = [0, 0, 5], axis = [0, 1, 0], radius = 5 }}
contact.tread = {{ slave = "pad.zmax", master = "roller", friction = 0.4 }}
output.history = ["pad.zmin"]
output.checkpoint = {{ increments = 1 }}
[[step]]
name = "press"
increments = 2
fix = [{{ set = "pad.zmin" }}]
move = [{{ target = "roller", by = [0, 0, -0.5] }}]
{steps}
"#
    )
}

/// Contact is from segment to segment.
const SEGMENTS: &str = "contact.tread.discretization=\"segment\"";

/// The moment of the contact forces on the slave about a line, from the fields.
fn moment(run: &Run, increment: usize, contact: &str, line: (Vec3, Vec3)) -> f64 {
    moment_of(run, increment, [&format!("contact.{contact}"), "force"], line)
}

/// The moment of a field of forces.
fn moment_of(run: &Run, increment: usize, [grid, forces]: [&str; 2], (point, axis): (Vec3, Vec3)) -> f64 {
    let (points, moved) = (run.points(grid), run.vectors(increment, grid, "displacement"));
    let forces = run.vectors(increment, grid, forces);
    let all = points.iter().zip(&moved).zip(&forces);
    all.map(|((x, u), f)| axis.dot(&(Vec3::from(*x) + Vec3::from(*u) - point).cross(&Vec3::from(*f)))).sum()
}

/// The force that keeps the roller down while something turns it about its axis.
fn turned(name: &str, by: &str) -> String {
    let force = r#"force = [{ target = "roller", total = [0, 0, -40], directions = "z" }]"#;
    format!("[[step]]\nname = \"{name}\"\nincrements = 4\nkeep = true\n{force}\n{by}\n")
}

fn torque(total: f64, table: &str) -> String {
    turned(
        "turn",
        &format!("torque = [{{ tool = \"roller\", total = {total:?}, point = [0, 0, 4.5], axis = [0, 2, 0]{table} }}]"),
    )
}

/// Pulled along its axis by more than friction bears, a roller slides, and with a torque beside it spins before that bears all alone.
#[test]
fn a_roller_slides_beyond_the_force_of_full_slip() {
    let pulled = |force: f64, torque: &str| {
        let force = format!("force = [{{ target = \"roller\", total = [0, {force:?}, 0], directions = \"y\" }}]");
        let step = format!("[[step]]\nname = \"pull\"\nincrements = 4\nkeep = true\n{force}\n{torque}\n");
        Bench::new(&roller(&step)).run(1, &[])
    };
    for (run, says) in [
        (pulled(40.0, ""), "the tool `roller` slides: its force comes to 2.7"),
        (
            pulled(22.0, "torque = [{ tool = \"roller\", total = 130, point = [0, 0, 4.5], axis = [0, 1, 0] }]"),
            "does not hold that beside its force, though without one it held 1.",
        ),
    ] {
        assert_eq!(run.code, 1, "{}", run.stdout);
        assert!(run.stderr.contains(says), "{says}: {}", run.stderr);
    }
}

/// Below full slip the friction of a cylinder, whose normal forces pass through the axis, bears the torque: the history and the
/// fields say the same, on two ranks, with other methods and solvers, and in a run that goes on with a further step.
#[test]
fn moments_balance_on_a_roller() {
    let turn = torque(50.0, ", table = [[0, 0], [0.5, 1], [1, 0.4]]");
    let ease =
        "[[step]]\nname = \"ease\"\nincrements = 2\nkeep = true\nmove = [{ target = \"roller\", by = [0.1, 0, 0] }]\n";
    let bench = Bench::new(&roller(&format!("{turn}{ease}")));
    let run = bench.solve(2, &[]);
    let history = run.history();
    for (row, share) in [(2, 0.5), (3, 1.0), (4, 0.7), (5, 0.4), (7, 0.4)] {
        let [x, z] = ["ux", "uz"].map(|c| history.column(&format!("roller.{c}"))[row]);
        assert_small("history", history.column("roller.moment")[row] / 50.0 - share, 1e-9);
        let axis = Vec3::new(x, 0.0, 5.0 + z);
        assert_small("fields", moment(&run, row + 1, "tread", (axis, Vec3::y())) / 50.0 - share, 1e-9);
    }
    assert!(history.column("roller.angle")[3] > 0.5, "{:?}", history.column("roller.angle"));
    let one = bench.solve(1, &[]).history();
    assert_small("one rank", one.difference(&history), 1e-7);
    for set in ["contact.tread.method=\"lagrange\"", "contact.tread.method=\"penalty\"", "solver.linear=\"iterative\""]
    {
        let other = bench.solve(1, &["--set", set]).history();
        assert_small(set, other.last("roller.moment") / 20.0 - 1.0, 1e-8);
    }
    // With points on the roller that are its own.
    let [alone, shared] = [1, 3].map(|ranks| bench.solve(ranks, &["--set", SEGMENTS]).history());
    assert_small("segments", alone.last("roller.moment") / 20.0 - 1.0, 1e-8);
    assert_small("segments on three ranks", alone.difference(&shared), 1e-7);
    assert_small("segments in balance", alone.last("pad.zmin.fx") + alone.last("roller.fx"), 1e-9);
    let shorter = Bench::new(&roller(&turn));
    let first = shorter.solve(1, &[]);
    shorter.write("scene.toml", &roller(&format!("{turn}{ease}")));
    let out = first.out.to_str().unwrap();
    let went_on = nagata(&shorter.path(""), 2, &["run", "scene.toml", "--restart", "--out", out], first.out.clone());
    assert_eq!(went_on.code, 0, "{}", went_on.stderr);
    assert_small("gone on", went_on.history().difference(&one), 1e-7);
}

/// At full slip the moment is M = μ r Σ P: so much of a torque a roller bears, and it spins beyond it.
#[test]
fn a_roller_spins_beyond_the_moment_of_full_slip() {
    let rotate = "move = [{ target = \"roller\", rotate = { point = [0, 0, 4.5], axis = [0, 1, 0], angle = 60 } }]";
    let run = Bench::new(&roller(&turned("turn", rotate))).solve(1, &[]);
    let (last, grid) = (run.written(), "contact.tread");
    let [forces, normals] = ["force", "normal"].map(|name| run.vectors(last, grid, name));
    let pressed: f64 =
        forces.iter().zip(&normals).map(|(f, n)| Vec3::from(*f).dot(&Vec3::from(*n))).filter(|p| *p > 0.0).sum();
    let most = 0.4 * 5.0 * pressed;
    let history = run.history();
    let axis = (Vec3::new(history.last("roller.ux"), 0.0, 5.0 + history.last("roller.uz")), Vec3::y());
    // A little of the friction goes along the axis.
    assert_close("full slip", moment(&run, last, "tread", axis).abs(), most, 1e-4);
    // While it is pressed on in the same step, and after that.
    for (before, set) in [("", &[][..]), (&turned("load", ""), &[]), (&turned("load", ""), &["--set", SEGMENTS])] {
        let driven = |share: f64| Bench::new(&roller(&format!("{before}{}", torque(share * most, ""))));
        if !before.is_empty() {
            driven(0.97).solve(1, set);
        }
        let spins = driven(1.05).run(2, set);
        assert_eq!(spins.code, 1, "{}", spins.stdout);
        assert!(spins.stderr.contains("the tool `roller` spins: its torque comes to "), "{}", spins.stderr);
    }
}

/// A pad between a drum and a ceiling wedges: the more the torque, the more it is pressed on, whatever was enough for before.
#[test]
fn what_wedges_holds_what_pressed_it_on() {
    let angle = |increments: usize| {
        let scene = format!(
            r#"
            [body.pad]
            material = "rubber"
            plane_strain = true
            block = {{ box = {{ origin = [-11.5, 49.27, 0.0], size = [3.0, 3.0, 1.0] }}, elements = [36, 18, 1] }}
            [material.rubber]
            model = "neo-hookean"
            young = 50.0
            poisson = 0.3
            [tool.drum]
            cylinder = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 50.0 }}
            [tool.ceiling]
            plane = {{ point = [0.0, 52.27, 0.0], normal = [0.0, -1.0, 0.0] }}
            [contact.c]
            slave = "pad.ymin"
            master = "drum"
            friction = 0.6
            [contact.t]
            slave = "pad.ymax"
            master = "ceiling"
            [[step]]
            increments = 5
            spring = [{{ set = "pad.ymax", stiffness = [0.2, 0.0, 0.0] }}]
            move = [{{ target = "ceiling", by = [0.0, -0.005, 0.0] }}]
            [[step]]
            increments = {increments}
            keep = true
            torque = [{{ tool = "drum", total = -170.0, point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] }}]
            "#
        );
        Bench::new(&scene).solve(1, &[]).history().last("drum.angle")
    };
    let [once, slowly] = [1, 10].map(angle);
    println!("{once}, {slowly}");
    assert!(once < -4.0);
    // Friction follows another path.
    assert_small("angle", once / slowly - 1.0, 0.05);
}

/// A plate that sticks to a block turns by the angle at which, prescribed, it has the moment.
#[test]
fn a_torque_turns_by_the_angle_that_has_its_moment() {
    let scene = |turn: &str| {
        format!(
            r#"
body.block = {{ material = "m", block = {{ box = {{ origin = [-2, -2, -4], size = [4, 4, 4] }}, elements = [4, 4, 4] }} }}
material.m = {{ model = "neo-hookean", young = 10, poisson = 0.3 }}
tool.knob.plane = {{ point = [0, 0, 0], normal = [0, 0, -1] }}
contact.top = {{ slave = "block.zmax", master = "knob", friction = 3 }}
output.fields = ["reaction"]
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "knob", by = [0, 0, -0.4] }}]
[[step]]
increments = 4
keep = true
{turn}
"#
        )
    };
    let line = "point = [0.5, 0, 0], axis = [0, 0, -1]";
    for set in [&[][..], &["--set", "contact.top.discretization=\"segment\""]] {
        let driven = Bench::new(&scene(&format!("torque = [{{ tool = \"knob\", total = 6, {line} }}]"))).solve(2, set);
        let angle = driven.history().last("knob.angle");
        assert!(angle > 3.0, "{angle}");
        let turn = format!("move = [{{ target = \"knob\", rotate = {{ {line}, angle = {angle:?} }} }}]");
        let prescribed = Bench::new(&scene(&turn)).solve(1, set);
        for component in ["ux", "uy", "fx", "fy", "fz"] {
            let [a, b] = [&driven, &prescribed].map(|run| run.history().last(&format!("knob.{component}")));
            assert_small(component, a - b, 1e-8);
        }
        let axis = (Vec3::new(0.5, 0.0, 0.0), -Vec3::z());
        let reactions = moment_of(&prescribed, prescribed.written(), ["body.block", "reaction"], axis);
        assert_close("moment", -reactions, 6.0, 1e-8);
    }
    let smooth = Bench::new(
        &scene(&format!("torque = [{{ tool = \"knob\", total = 6, {line} }}]")).replace("friction = 3", "friction = 0"),
    )
    .run(2, &[]);
    assert_eq!(smooth.code, 2, "{}", smooth.stderr);
    assert!(smooth.stderr.contains("tool `knob` can turn about"), "{}", smooth.stderr);
}

/// A wheel on a pad whose torque goes on about a line beside its axis: it begins with the moment that holds the wheel there,
/// whichever way the axis is written. Its angle is about the axis as written, and goes on from what it was.
#[test]
fn a_torque_about_another_line_begins_with_the_moment_that_holds() {
    let scene = |second: &str| {
        let step = |name: &str, n: usize, more: &str| {
            format!("[[step]]\nname = \"{name}\"\nincrements = {n}\nkeep = true\n{more}\n")
        };
        format!(
            "body.a = {{ material = \"m\", plane_strain = true, block = {{ box = {{ origin = [-10, -4, 0], size = [20, 4, 1] }}, elements = [20, 2, 1] }} }}\n\
             material.m = {{ model = \"neo-hookean\", young = 10, poisson = 0.3 }}\n\
             tool.w.cylinder = {{ point = [0, 5, 0], axis = [0, 0, 1], radius = 5 }}\n\
             contact.c = {{ slave = \"a.ymax\", master = \"w\", friction = 0.8 }}\n\
             [[step]]\nname = \"press\"\nincrements = 3\nfix = [{{ set = \"a.ymin\" }}]\nmove = [{{ target = \"w\", by = [0, -0.6, 0] }}]\n{}{}",
            step("turn", 2, "torque = [{ tool = \"w\", total = 4, point = [0, 4.4, 0], axis = [0, 0, 1] }]"),
            step("on", 4, second)
        )
    };
    let run =
        |second: &str| Bench::new(&scene(&format!("torque = [{{ tool = \"w\", {second} }}]"))).solve(1, &[]).history();
    // Beside, along and against the axis; the moments between are those of a straight line from the one that holds to the last.
    let along = run("total = -12, point = [-3, 4.4, 0], axis = [0, 0, 1]");
    let against = run("total = 12, point = [-3, 4.4, 0], axis = [0, 0, -1]");
    for name in ["w.fx", "w.fy", "w.uy"] {
        for (a, b) in along.column(name).iter().zip(against.column(name)) {
            assert_close(name, *a, *b, 1e-8);
        }
    }
    let before = along.steps.iter().rposition(|step| step == "turn").unwrap();
    let (held, force) = (along.column("w.moment")[before], along.column("w.fy")[before]);
    // The tool's force on the body is at its old axis, 3 beside the new one.
    let begin = held + 3.0 * force;
    for (k, moment) in (1..).zip(&along.column("w.moment")[before + 1..]) {
        assert_close("moment", *moment, begin + (-12.0 - begin) * 0.25 * f64::from(k), 1e-7);
    }
    // About the same line it goes on from its value, to zero, whichever way that is written.
    let [same, turned] = ["1", "-1"].map(|z| run(&format!("total = 0, point = [0, 4.4, 1], axis = [0, 0, {z}]")));
    for (a, b) in same.column("w.fx").iter().zip(turned.column("w.fx")) {
        assert_small("w.fx", a - b, 1e-8);
    }
    assert_close("ramp", same.column("w.moment")[before + 1], 3.0, 1e-7);
    assert_close("angle", same.last("w.angle"), -turned.last("w.angle"), 1e-8);
    assert_close("angle about the line beside", along.last("w.angle"), -against.last("w.angle"), 1e-8);
    assert!(same.last("w.angle").abs() < 0.5 * same.column("w.angle")[before], "{}", same.last("w.angle"));
}

/// What a node that is fixed bears of a pulley that can only turn is undetermined, and so is its friction.
#[test]
fn a_torque_against_held_nodes_is_refused() {
    let run = Bench::new(
        r#"
[body.belt]
material = "m"
plane_strain = true
block = { sector = { radii = [10.0, 10.2], angles = [0.0, 90.0], length = 1.0 }, elements = [2, 20, 1] }
[material.m]
model = "neo-hookean"
young = 1000.0
poisson = 0.3
[tool.pulley]
cylinder = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 10.0 }
[contact.c]
slave = "belt.rmin"
master = "pulley"
friction = 0.3
[[step]]
name = "tight"
increments = 2
fix = [{ set = "belt.amax" }, { set = "belt.amin" }]
pressure = [{ set = "belt.rmax", value = 0.02 }]
[[step]]
name = "turn"
increments = 2
keep = true
torque = [{ tool = "pulley", total = 0.1, point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] }]
"#,
    )
    .run(2, &[]);
    assert_eq!(run.code, 1, "{}", run.stdout);
    let says = "cannot give way to the tool `pulley`, which a torque turns, so that what it bears is undetermined";
    assert!(run.stderr.contains(says), "{}", run.stderr);
}
