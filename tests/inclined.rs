//! Conditions in planes of any orientation: turned scenes against unturned ones; in cylindrical frames, and on circles.

mod common;

use common::{Bench, Run, assert_close, assert_small, msh};
use nalgebra::{Rotation3, Vector3};

/// A thick cylinder under inner pressure as a sector of so many elements of 10 degrees, from an angle on.
fn sector(from: f64, elements: usize, conditions: &str) -> Run {
    let to = from + 10.0 * elements as f64;
    let scene = format!(
        r#"
        material.m = {{ model = "hooke", young = 100, poisson = 0.3 }}
        [body.ring]
        material = "m"
        {conditions}
        [body.ring.block]
        sector = {{ radii = [1, 2], angles = [{from}, {to}], length = 0.3 }}
        elements = [4, {elements}, 1]
        [output]
        every = 100
        history = ["ring.rmin", "ring.amin", "ring.amax"]
        [[step]]
        increments = 2
        fix = [{{ set = "ring", directions = "z" }}]
        pressure = [{{ set = "ring.rmin", value = 8 }}]
        "#
    );
    Bench::new(&scene).solve(1, &[])
}

/// The mean radial displacement of the bore over that of its nodes' mean direction, and the normal forces on both sides.
fn widening(run: &Run, from: f64, elements: usize) -> [f64; 3] {
    let history = run.history();
    let vector = |what: &str| {
        let [set, kind] = what.split('.').collect::<Vec<_>>()[..] else { panic!() };
        Vector3::from(["x", "y", "z"].map(|c| history.last(&format!("ring.{set}.{kind}{c}"))))
    };
    let at = |angle: f64| Vector3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
    let mean: Vector3<f64> = (0..=elements).map(|k| at(from + 10.0 * k as f64)).sum::<Vector3<f64>>();
    let mean = mean / (elements + 1) as f64;
    let side = |set: &str, angle: f64, sign: f64| {
        let (force, normal) = (vector(&format!("{set}.f")), at(angle + 90.0) * sign);
        assert_small("along the plane nothing is borne", (force - normal * normal.dot(&force)).xy().norm(), 1e-9);
        normal.dot(&force)
    };
    let to = from + 10.0 * elements as f64;
    [vector("rmin.u").norm() / mean.norm(), side("amin", from, 1.0), side("amax", to, -1.0)]
}

/// The planes of a sector of 30 degrees against the quarter, of which both are along the axes.
#[test]
fn a_sector_is_as_the_quarter() {
    let quarter = widening(&sector(0.0, 9, "symmetry = [\"amin\", \"amax\"]"), 0.0, 9);
    let symmetric = widening(&sector(17.0, 3, "symmetry = [\"amin\", \"amax\"]"), 17.0, 3);
    for (what, found, expected) in [
        ("bore", symmetric[0], quarter[0]),
        ("one side", symmetric[1], quarter[1]),
        ("the other side", symmetric[2], quarter[2]),
    ] {
        assert_close(what, found, expected, 1e-10);
    }
}

/// The two sides of a wedge of 60 degrees, which meet in an edge, hold it as it is drawn along that: it thins as a free bar.
#[test]
fn planes_that_meet_in_an_edge_both_hold() {
    let turn = oblique();
    let (second, third) = (Vector3::new(0.5, 0.75f64.sqrt(), 0.0), Vector3::z());
    let place = |[x, y, z]: [f64; 3]| (turn * (Vector3::x() * x + second * (0.8 * y) + third * (2.0 * z))).into();
    let normal = |n: Vector3<f64>| format!("{:?}", (turn * n).data.0[0]);
    let [sides, end] = [[Vector3::y(), second.cross(&third)].map(normal), [third, third * 0.5].map(normal)];
    let bench = Bench::new(&format!(
        r#"
        material.m = {{ model = "hooke", young = 100, poisson = 0.3 }}
        body.wedge = {{ material = "m", mesh = "wedge.msh" }}
        output.history = ["wedge.xmax"]
        [[step]]
        increments = 2
        fix = [
            {{ set = "wedge.ymin", normal = {} }}, {{ set = "wedge.xmin", normal = {} }},
            {{ set = "wedge.zmin", normal = {} }},
        ]
        move = [{{ target = "wedge.zmax", by = {}, normal = {} }}]
        "#,
        sides[0], sides[1], end[0], end[1], end[0]
    ));
    bench.write("wedge.msh", &msh::block([2, 2, 2], false, place));
    let (stretch, history) = (1.25f64, bench.solve(1, &[]).history());
    let thinning = stretch.powf(-0.3) - 1.0;
    let middle = (Vector3::x() + second * 0.4) * thinning + third * (stretch - 1.0);
    let found = Vector3::from(["ux", "uy", "uz"].map(|c| history.last(&format!("wedge.xmax.{c}"))));
    assert_small("displacement", (found - turn * middle).norm(), 1e-10);
    let scene = std::fs::read_to_string(bench.path("scene.toml")).unwrap();
    let held = format!("{{ set = \"wedge.ymin\", normal = {} }}, ", sides[0]);
    bench.write("scene.toml", &scene.replace(&held, ""));
    let (told, along) = (bench.run(1, &[]), turn * second);
    let along = along * along[along.iamax()].signum();
    let free = format!("body `wedge` can move along ({:.3}, {:.3}, {:.3})", along.x, along.y, along.z);
    assert!(told.code == 2 && told.stderr.contains(&free), "{free}\n{}", told.stderr);
}

fn oblique() -> Rotation3<f64> {
    Rotation3::new(Vector3::new(1.0, 2.0, -0.5).normalize() * 37f64.to_radians())
}

/// Decimals that leave all of a number.
const ALL: i32 = 15;

/// With coordinates and vectors of so many decimals:
/// ```text
///      ______       a lid, pressed down and drawn along
///     |      |      on two bodies, one on the other, both cut by a plane of symmetry
///    _|______|_
///   |__________|    fixed below
/// ```
fn drawn(turn: &Rotation3<f64>, digits: i32, more: &[&str], ranks: usize) -> Run {
    drawn_scene(turn, digits).solve(ranks, more)
}

fn drawn_scene(turn: &Rotation3<f64>, digits: i32) -> Bench {
    let rounded = |x: f64| (x * 10f64.powi(digits)).round() / 10f64.powi(digits);
    let vector = |v: [f64; 3]| format!("{:?}", (turn * Vector3::from(v)).map(rounded).data.0[0]);
    let scene = format!(
        r#"
        material.soft = {{ model = "neo-hookean", young = 10, poisson = 0.3 }}
        body.base = {{ material = "soft", mesh = "base.msh", symmetry = ["xmin"] }}
        body.block = {{ material = "soft", mesh = "block.msh" }}
        tool.lid.plane = {{ point = {lid}, normal = {down} }}
        contact.lid = {{ slave = "block.zmax", master = "lid", friction = 0.4 }}
        contact.joint = {{ slave = "block.zmin", master = "base.zmax", friction = 0.3 }}
        output.history = ["base.zmin", "base.xmin", "block.xmin", "block.zmax"]
        [[step]]
        increments = 2
        fix = [{{ set = "base.zmin" }}, {{ set = "block.xmin", normal = {side} }}]
        spring = [{{ set = "base.ymax", stiffness = [3, 3, 3] }}]
        pressure = [{{ set = "base.ymin", value = 0.2 }}]
        move = [{{ target = "lid", by = {press} }}]
        [[step]]
        increments = 4
        keep = true
        move = [{{ target = "lid", by = {draw} }}]
        "#,
        lid = vector([0.0, 0.0, 3.0]),
        down = vector([0.0, 0.0, -1.0]),
        side = vector([1.0, 0.0, 0.0]),
        press = vector([0.0, 0.0, -0.2]),
        draw = vector([0.0, 0.3, 0.0]),
    );
    let bench = Bench::new(&scene);
    let place = |low: [f64; 3], size: [f64; 3]| {
        move |x: [f64; 3]| (turn * Vector3::from_fn(|d, _| low[d] + size[d] * x[d])).map(rounded).into()
    };
    bench.write("base.msh", &msh::block([3, 4, 1], false, place([0.0, -2.0, 0.0], [3.0, 4.0, 1.0])));
    bench.write("block.msh", &msh::block([2, 2, 2], false, place([0.0, -1.0, 1.0], [2.0, 2.0, 2.0])));
    bench
}

/// Largest difference between a turned run and an unturned one, of displacements, and of forces over the largest.
fn difference(turned: &Run, turn: &Rotation3<f64>, still: &Run) -> f64 {
    let [turned, still] = [turned, still].map(Run::history);
    assert_eq!(turned.len(), still.len());
    let force = still.largest_force("lid");
    let mut worst = 0.0f64;
    for name in ["lid", "base.zmin", "base.xmin", "block.xmin", "block.zmax"] {
        for (kind, scale) in [("f", force), ("u", 1.0)] {
            let vector = |history: &common::History, row: usize| {
                Vector3::from(["x", "y", "z"].map(|c| history.column(&format!("{name}.{kind}{c}"))[row]))
            };
            for row in 0..still.len() {
                worst = worst.max((vector(&turned, row) - turn * vector(&still, row)).norm() / scale);
            }
        }
    }
    worst
}

#[test]
fn a_turned_scene_is_the_unturned_one() {
    let still = drawn(&Rotation3::identity(), ALL, &[], 1);
    let history = still.history();
    let slips =
        |row: usize| ["lid", "joint"].iter().any(|contact| history.column(&format!("{contact}.slip"))[row] > 0.0);
    assert!((0..history.len()).any(slips), "what is drawn slips");
    assert!(history.last("block.xmin.fx").abs() > 0.1, "the plane bears something");
    let turn = oblique();
    for (what, more, ranks, tolerance) in [
        ("augmented Lagrangian", &[][..], 1, 1e-8),
        ("two ranks", &[], 2, 1e-8),
        ("multigrid", &["--set", "solver.linear=iterative"], 1, 1e-7),
    ] {
        assert_small(what, difference(&drawn(&turn, ALL, more, ranks), &turn, &still), tolerance);
    }
    let uzawa = ["--set", "contact.lid.method=uzawa", "--set", "contact.joint.method=uzawa"];
    let [turned, still] = [&turn, &Rotation3::identity()].map(|turn| drawn(turn, ALL, &uzawa, 1));
    assert_small("Uzawa", difference(&turned, &turn, &still), 1e-7);
}

/// Planes that are one but for the decimals of meshes and vectors are one, and a tool that is drawn along them slips across none.
#[test]
fn planes_and_directions_are_meant_as_far_as_they_are_typed() {
    let turn = oblique();
    let exact = drawn(&turn, ALL, &[], 1);
    for digits in 6..9 {
        let rounded = drawn(&turn, digits, &[], 1);
        assert_eq!(rounded.summary()["iterations"], exact.summary()["iterations"], "{digits} decimals");
        assert_eq!(rounded.summary()["warnings"], serde_json::json!([]), "{digits} decimals");
        assert_small("forces", difference(&rounded, &Rotation3::identity(), &exact), 20.0 * 10f64.powi(-digits));
    }
    let told = drawn_scene(&turn, 5).run(1, &[]);
    let fewer = "`base.xmin` lies in no plane: its nodes are 1";
    assert!(told.code == 2 && told.stderr.contains(fewer) && told.stderr.contains("more digits"), "{}", told.stderr);
}

/// What is computed is 0 to rounding where it is meant so, as by the sine of half a turn.
#[test]
fn a_motion_gives_way_to_what_holds_nodes_by_rounding_alone() {
    let scene = |by: &str| {
        format!(
            r#"
            material.m = {{ model = "hooke", young = 100, poisson = 0.3 }}
            [body.b]
            material = "m"
            symmetry = ["ymin"]
            [body.b.block]
            box = {{ origin = [0, 0, 0], size = [1, 1, 1] }}
            elements = [1, 1, 1]
            [output]
            history = ["b.zmax"]
            [[step]]
            increments = 1
            fix = [{{ set = "b.zmin" }}]
            move = [{{ target = "b.zmax", by = {by} }}]
            "#
        )
    };
    let [rounded, exact] = ["[0.1, 1e-17, 0]", "[0.1, 0, 0]"].map(|by| Bench::new(&scene(by)).solve(1, &[]).history());
    assert_eq!(rounded.last("b.zmax.fx"), exact.last("b.zmax.fx"));
    let told = Bench::new(&scene("[0.1, 1e-7, 0]")).run(1, &[]);
    assert!(told.code == 2 && told.stderr.contains("moved otherwise along y"), "{}", told.stderr);
}

/// A roller on a block that a plane of symmetry across its axle cuts: nodes in that plane bear no friction along the axle, on which
/// the roller stands still, however the axle lies.
#[test]
fn a_tool_that_turns_stands_still_along_its_axle() {
    let rolled = |turn: &Rotation3<f64>, drive: &str| {
        let vector = |v: [f64; 3]| format!("{:?}", (turn * Vector3::from(v)).data.0[0]);
        let (point, axis) = (vector([1.5, 0.0, 2.0]), vector([0.0, 1.0, 0.0]));
        let along = vector([0.1, 0.0, 0.0]);
        let turned = format!("rotate = {{ point = {point}, axis = {axis}, angle = -3.0 }}");
        let torque = format!("torque = [{{ tool = \"roller\", point = {point}, axis = {axis}, total = 0.3 }}]");
        let drive = match drive {
            "torque" => torque,
            "torque, drawn" => format!("move = [{{ target = \"roller\", by = {along} }}]\n{torque}"),
            "rotate" => format!("move = [{{ target = \"roller\", {turned} }}]"),
            _ => format!("move = [{{ target = \"roller\", by = {along}, {turned} }}]"),
        };
        let bench = Bench::new(&format!(
            r#"
            material.soft = {{ model = "neo-hookean", young = 10, poisson = 0.3 }}
            body.pad = {{ material = "soft", mesh = "pad.msh", symmetry = ["ymin"] }}
            tool.roller.cylinder = {{ point = {point}, axis = {axis}, radius = 1.0 }}
            contact.top = {{ slave = "pad.zmax", master = "roller", friction = 0.5 }}
            output.history = ["pad.zmin", "pad.ymin"]
            [[step]]
            increments = 2
            fix = [{{ set = "pad.zmin" }}]
            move = [{{ target = "roller", by = {press} }}]
            [[step]]
            increments = 2
            fix = [{{ set = "pad.zmin" }}]
            {drive}
            "#,
            press = vector([0.0, 0.0, -0.15]),
        ));
        let place = |x: [f64; 3]| (turn * Vector3::new(3.0 * x[0], 2.0 * x[1], x[2])).into();
        bench.write("pad.msh", &msh::block([5, 3, 2], false, place));
        bench.solve(1, &[]).history()
    };
    for drive in ["rotate", "torque", "rotate, drawn", "torque, drawn"] {
        let turn = oblique();
        let [still, turned] = [Rotation3::identity(), turn].map(|turn| rolled(&turn, drive));
        let force = still.largest_force("roller");
        assert_eq!(turned.len(), still.len(), "{drive}");
        assert!(still.last("roller.fy").abs() > 1e-2 * force, "{drive}: nodes beside the plane widen along the roller");
        for name in ["roller", "pad.zmin", "pad.ymin"] {
            let of = |history: &common::History| {
                Vector3::from(["x", "y", "z"].map(|c| history.last(&format!("{name}.f{c}"))))
            };
            assert_small(&format!("{drive}: {name}"), (of(&turned) - turn * of(&still)).norm() / force, 1e-8);
        }
    }
}

/// A ring whose bore and rim go outwards by a share of their radius and around by another one is stretched and turned
/// evenly, whatever is between.
#[test]
fn what_goes_outwards_and_around_evenly_is_stretched_and_turned() {
    let (outward, around) = (0.1, 0.2);
    let by = |radius: f64| format!("[{:?}, {:?}, 0]", outward * radius, around * radius);
    let frame = "around = { point = [3, 1, 5], axis = [0, 0, 2] }";
    let bench = Bench::new(&format!(
        r#"
        material.m = {{ model = "neo-hookean", young = 100, poisson = 0.3 }}
        body.ring.material = "m"
        [body.ring.block]
        sector = {{ center = [3, 1, 0], radii = [1, 2], angles = [0, 360], length = 0.3 }}
        elements = [3, 8, 1]
        [[step]]
        increments = 2
        fix = [{{ set = "ring", directions = "z" }}]
        move = [
            {{ target = "ring.rmin", by = {}, directions = "rt", {frame} }},
            {{ target = "ring.rmax", by = {}, directions = "rt", {frame} }},
        ]
        "#,
        by(1.0),
        by(2.0)
    ));
    let run = bench.solve(1, &[]);
    let moved = run.vectors(run.written(), "body.ring", "displacement");
    for (x, u) in run.points("body.ring").iter().zip(&moved) {
        let [x, y] = [x[0] - 3.0, x[1] - 1.0];
        let exact = [outward * x - around * y, outward * y + around * x];
        assert_small("displacement", (u[0] - exact[0]).hypot(u[1] - exact[1]), 1e-9);
    }
    let through = "step.0.move.0.around.point=[4.0, 1.0, 0.0]";
    let told = bench.run(1, &["--set", through]);
    assert!(told.code == 2 && told.stderr.contains("is on the axis of `around`"), "{}", told.stderr);
}

const TWIST: &str = r#"
material.m = { model = "neo-hookean", young = 100, poisson = 0.3 }
body.bar.material = "m"
body.bar.block = { box = { origin = [0, -1, 2], size = [3, 2, 1] }, elements = [3, 2, 2] }
[output]
history = ["bar.xmin", "bar.xmax"]
"#;

/// Both ends of a bar turn about one oblique axis and go along: all of it moves as a rigid body, in the middle of a table, too, and
/// from where another step has left it. Nothing bears anything.
#[test]
fn ends_that_turn_alike_turn_the_body() {
    let motion = |set: &str| {
        let turn = "rotate = { point = [1, 2, 0.5], axis = [1, -2, 2], angle = 80 }";
        format!("{{ target = \"{set}\", by = [0.3, 0, -0.2], {turn}, table = [[0, 0], [0.5, 0.8], [1, 0.5]] }}")
    };
    let later = |set: &str| {
        format!("{{ target = \"{set}\", rotate = {{ point = [0, 0, 0], axis = [0, 0, 1], angle = -50 }} }}")
    };
    let [first, second] =
        [[motion("bar.xmin"), motion("bar.xmax")], [later("bar.xmin"), later("bar.xmax")]].map(|m| m.join(", "));
    let bench = Bench::new(&format!(
        "{TWIST}[[step]]\nincrements = 6\nmove = [{first}]\n\
         [[step]]\nincrements = 3\nmove = [{second}]\n"
    ));
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let turn =
            |axis: [f64; 3], degrees: f64| Rotation3::new(Vector3::from(axis).normalize() * degrees.to_radians());
        let point = Vector3::new(1.0, 2.0, 0.5);
        let way = |x: Vector3<f64>| turn([1.0, -2.0, 2.0], 40.0) * (x - point) + point + Vector3::new(0.15, 0.0, -0.1);
        let moved = run.vectors(run.written(), "body.bar", "displacement");
        for (x, u) in run.points("body.bar").iter().zip(&moved) {
            let x = Vector3::from([x[0], x[1], x[2]]);
            let exact = turn([0.0, 0.0, 1.0], -50.0) * way(x) - x;
            assert_small("place", (Vector3::new(u[0], u[1], u[2]) - exact).norm(), 1e-9);
        }
        let history = run.history();
        for column in ["fx", "fy", "fz", "moment"] {
            let largest =
                history.column(&format!("bar.xmax.{column}")).iter().fold(0.0f64, |most, f| most.max(f.abs()));
            assert_small(column, largest, 1e-6);
        }
    }
}

/// A thick tube is twisted by a small angle: its moment is G J φ / L, within what 24 chords and 2 layers are off, and that on the
/// other end the same. What is kept of it stays, and goes on.
#[test]
fn a_tube_that_is_twisted_has_its_moment() {
    let (young, poisson, length, angle) = (100.0, 0.3, 2.0, 0.1f64);
    let scene = format!(
        r#"
        material.m = {{ model = "hooke", young = {young}, poisson = {poisson} }}
        body.tube.material = "m"
        body.tube.block = {{ sector = {{ center = [5, 0, 0], radii = [1, 1.5], angles = [0, 360], length = {length} }}, elements = [2, 24, 4] }}
        output.history = ["tube.zmin", "tube.zmax"]
        [[step]]
        increments = 1
        move = [
          {{ target = "tube.zmin", rotate = {{ point = [5, 0, 0], axis = [0, 0, 1], angle = 0 }} }},
          {{ target = "tube.zmax", directions = "xy", rotate = {{ point = [5, 0, 7], axis = [0, 0, 1], angle = {angle} }} }},
        ]
        [[step]]
        increments = 1
        keep = true
        "#
    );
    let history = Bench::new(&scene).solve(1, &[]).history();
    let moments = |row: usize| ["zmin", "zmax"].map(|end| history.column(&format!("tube.{end}.moment"))[row]);
    let polar = std::f64::consts::PI / 2.0 * (1.5f64.powi(4) - 1.0);
    let exact = young / (2.0 * (1.0 + poisson)) * polar * angle.to_radians() / length;
    for row in 0..2 {
        let [below, above] = moments(row);
        assert_close("moment", above, exact, 3e-2);
        assert_close("balance", below, -above, 1e-9);
    }
}

/// What a set that turns cannot have beside it.
#[test]
fn sets_that_turn_are_refused_where_they_cannot() {
    let turn = |axis: &str| format!("rotate = {{ point = [0, 0, 0], axis = {axis}, angle = 10 }}");
    let step = |more: &str| format!("{TWIST}[[step]]\nincrements = 1\nfix = [{{ set = \"bar.xmin\" }}]\n{more}\n");
    let moves = |more: &str, axis: &str| format!("move = [{{ target = \"bar.xmax\", {}{more} }}]", turn(axis));
    let both = |more: &str| format!("move = [{{ target = \"bar.xmax\", {} }}, {more}]", turn("[1, 0, 0]"));
    for (body, conditions, says) in [
        (&[][..], moves(", directions = \"xy\"", "[1, 0, 0]"), "turns the set in z, which `directions` leaves free"),
        (&[][..], moves(", normal = [1, 0, 0]", "[1, 0, 0]"), "rotate stands beside `normal`"),
        (&[], both("{ target = \"bar.ymin\", by = [0, 0, 1], directions = \"z\" }"), "already moved otherwise along z"),
        (&[], both("{ target = \"bar.ymin\", by = [0, 0, 0], normal = [0, 1, 1] }"), "is turned, too, by `rotate`"),
        (
            &["body.bar.plane_strain=true", "body.bar.block.elements=[3, 2, 1]"],
            moves("", "[1, 0, 0]"),
            "nothing turns so",
        ),
    ] {
        let more: Vec<&str> = body.iter().flat_map(|set| ["--set", set]).collect();
        let told = Bench::new(&step(&conditions)).run(1, &more);
        assert!(told.code == 2 && told.stderr.contains(says), "{says}\n{}", told.stderr);
    }
}
