//! Conditions in planes of any orientation: turned scenes against unturned ones.

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

/// ```text
///      ______       a lid, pressed down and drawn along
///     |      |      on two bodies, one on the other, both cut by a plane of symmetry
///    _|______|_
///   |__________|    fixed below
/// ```
fn drawn(turn: &Rotation3<f64>, more: &[&str], ranks: usize) -> Run {
    let vector = |v: [f64; 3]| format!("{:?}", (turn * Vector3::from(v)).data.0[0]);
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
        move |x: [f64; 3]| (turn * Vector3::from_fn(|d, _| low[d] + size[d] * x[d])).into()
    };
    bench.write("base.msh", &msh::block([3, 4, 1], false, place([0.0, -2.0, 0.0], [3.0, 4.0, 1.0])));
    bench.write("block.msh", &msh::block([2, 2, 2], false, place([0.0, -1.0, 1.0], [2.0, 2.0, 2.0])));
    bench.solve(ranks, more)
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
    let still = drawn(&Rotation3::identity(), &[], 1);
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
        assert_small(what, difference(&drawn(&turn, more, ranks), &turn, &still), tolerance);
    }
    let uzawa = ["--set", "contact.lid.method=uzawa", "--set", "contact.joint.method=uzawa"];
    let [turned, still] = [&turn, &Rotation3::identity()].map(|turn| drawn(turn, &uzawa, 1));
    assert_small("Uzawa", difference(&turned, &turn, &still), 1e-7);
}
