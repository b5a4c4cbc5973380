//! Increments that fail and are tried again in halves leave no trace in the result; those that would change too much are
//! shortened.

mod common;

use common::{Bench, History, assert_close, assert_small};
use std::f64::consts::PI;

/// A roll is pressed into a slab and drawn along it, in two steps with these increments.
fn rolling(friction: f64, increments: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.slab]
        block = {{ box = {{ origin = [-4.0, -3.0, 0.0], size = [8.0, 3.0, 0.5] }}, elements = [16, 4, 1] }}
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.roll]
        cylinder = {{ point = [0.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 4.0 }}
        [contact.top]
        slave = "slab.ymax"
        master = "roll"
        friction = {friction:?}
        reach = 3.0 # no node comes from farther away
        [[step]]
        {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [1.0, -1.2, 0.0] }}]
        [[step]]
        {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [-2.0, 0.0, 0.0] }}]
        [output]
        every = 100
        history = ["slab.ymin", "slab.xmax"]
        "#
    ))
}

/// Active sets, each of which has as many iterations, end what needs too many without a cut.
const ONE_SET: &str = "controls.outer_rounds=1";

const SETS: [&str; 3] = ["roll", "slab.ymin", "slab.xmax"];

/// Without friction the end does not depend on the way.
#[test]
fn frictionless_end() {
    let bench = rolling(0.0, "increments = 3");
    let plain = bench.solve(2, &[]);
    let cut = bench.solve(2, &["--set", "solver.max_iterations=3", "--set", ONE_SET]);
    assert_eq!(plain.summary()["cutbacks"], 0);
    let cutbacks = cut.summary()["cutbacks"].as_u64().unwrap();
    println!("{cutbacks} cutbacks, {} increments", cut.history().len());
    assert!(cutbacks >= 3);
    let (plain, cut) = (plain.history(), cut.history());
    // The times of the plain run are met, whatever was cut.
    for (k, time) in plain.column("time").iter().enumerate() {
        let at = cut.column("time").iter().position(|t| (t - time).abs() < 1e-12).unwrap();
        assert_small(&format!("at time {time}"), cut.row_difference(at, &plain, k, &SETS), 1e-8);
    }
}

/// With friction the way counts: when each step fails as a whole, for it takes more iterations than its halves do, the run
/// is the one with halves from the beginning. A failed attempt that left a multiplier, a slip origin, a status or a tool
/// behind would show.
#[test]
fn frictional_way() {
    let [whole, halves] = ["increments = 1", "increments = 2"].map(|increments| rolling(0.3, increments));
    let halves = halves.solve(2, &[]).history();
    let uncut = whole.solve(2, &[]).history();
    println!("iterations {:?}, in halves {:?}", uncut.column("iterations"), halves.column("iterations"));
    let enough = halves.column("iterations").iter().fold(0.0f64, |m, n| m.max(*n));
    let cut = whole.solve(2, &["--set", &format!("solver.max_iterations={enough}"), "--set", ONE_SET]);
    assert_eq!(cut.summary()["cutbacks"], 2);
    let cut = cut.history();
    assert_eq!((cut.len(), halves.len()), (4, 4));
    for k in 0..4 {
        assert_small(&format!("increment {}", k + 1), cut.row_difference(k, &halves, k, &SETS), 1e-8);
    }
    assert!(uncut.row_difference(1, &halves, 3, &SETS) > 1e-4, "the way matters");
}

/// Largest change of a column from row to row, from 0 at the start.
fn largest_change(history: &History, column: &str, change: impl Fn(f64, f64) -> f64) -> f64 {
    let mut last = 0.0;
    history.column(column).iter().fold(0.0, |most: f64, &now| most.max(change(std::mem::replace(&mut last, now), now)))
}

/// A cube that is stretched evenly, so that its trial state has the strain that it will have: ln 1.25 = 0.223 and then ln
/// 1.2 = 0.182 by displacement in equal parts, 5 and 4 increments.
#[test]
fn strain_shortens_increments() {
    let cube = Bench::new(
        r#"
        [body.cube]
        block = { box = { size = [1.0, 1.0, 1.0] }, elements = [1, 1, 1] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [[step]]
        increment = { initial = 0.5, strain = 0.05 }
        fix = [{ set = "cube.xmin", directions = "x" }, { set = "cube.ymin", directions = "y" },
               { set = "cube.zmin", directions = "z" }]
        move = [{ target = "cube.zmax", by = [0.0, 0.0, 0.5], directions = "z" }]
        [output]
        history = ["cube.zmax"]
        "#,
    );
    let history = cube.solve(1, &[]).history();
    let times: Vec<f64> = [1.0, 2.0, 3.0, 4.0, 5.0, 6.25, 7.5, 8.75, 10.0].map(|t| 0.1 * t).to_vec();
    let off = history.column("time").iter().zip(&times).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(history.len() == 9 && off < 1e-12, "{:?}", history.column("time"));
    let strain = largest_change(&history, "cube.zmax.uz", |from, to| ((1.0 + to) / (1.0 + from)).ln());
    assert!((0.04..0.05 * (1.0 + 1e-9)).contains(&strain), "{strain}");
    // Where it may not be as short as that, it is as short as it may.
    let least = cube.solve(1, &["--set", "step.0.increment.min=0.2"]).history();
    assert_eq!(least.column("time"), [0.25, 0.5, 0.75, 1.0]);
}

/// Of 17 nodes some 7 touch the roll at the end of the press; to let in 15 % at a time the trial state is foreseen well, to one
/// node, and by all ranks alike.
#[test]
fn contacts_shorten_increments() {
    let entering = |history: &History| largest_change(history, "top.active", |from, to| (to - from).abs());
    let whole = rolling(0.3, "increment = { initial = 1.0 }").solve(2, &[]).history();
    assert!(entering(&whole) > 6.0, "{:?}", whole.column("top.active"));
    let bench = rolling(0.3, "increment = { initial = 1.0, contacts = 0.15 }");
    let [two, one] = [2, 1].map(|ranks| bench.solve(ranks, &[]).history());
    println!("{:?} at {:?}", two.column("top.active"), two.column("time"));
    assert!(entering(&two) <= 0.15 * 17.0 + 1.0, "{:?}", two.column("top.active"));
    assert!((5..20).contains(&two.len()));
    for time in [1.0, 2.0] {
        assert!(two.column("time").contains(&time));
    }
    assert_small("ranks", one.difference(&two), 1e-9);
}

/// A shallow clamped arch under a roll: the force on it falls by half after a limit, and then rises again. A roll that is moved
/// passes that. One that a force drives goes over to where the arch hangs through, on the same curve.
#[test]
fn snap_through() {
    let arch = |drive: &str| {
        let scene = format!(
            r#"
            [body.arch]
            block = {{ sector = {{ radii = [99.8, 100.2], angles = [80.0, 100.0], length = 1.0 }}, elements = [2, 40, 1] }}
            material = "steel"
            element = "hex8-eas"
            [material.steel]
            model = "hooke"
            young = 1000.0
            poisson = 0.3
            [tool.roll]
            cylinder = {{ point = [0.0, 105.2, 0.0], axis = [0.0, 0.0, 1.0], radius = 5.0 }}
            [contact.top]
            slave = "arch.rmax"
            master = "roll"
            [[step]]
            increments = 16
            fix = [{{ set = "arch.amin" }}, {{ set = "arch.amax" }}, {{ set = "arch.zmin", directions = "z" }},
                   {{ set = "arch.zmax", directions = "z" }}]
            {drive}
            "#
        );
        let run = Bench::new(&scene).solve(1, &[]);
        let history = run.history();
        let curve = ["roll.uy", "roll.fy"].map(|name| history.column(name).iter().map(|v| -v).collect::<Vec<f64>>());
        assert_eq!(run.summary()["jumps"], 0);
        curve
    };
    let [way, force] = arch("move = [{ target = \"roll\", by = [0.0, -3.2, 0.0] }]");
    println!("{force:?}");
    let limit = (1..).find(|&k| force[k] < force[k - 1]).unwrap() - 1;
    let valley = force[limit..].iter().copied().fold(f64::INFINITY, f64::min);
    assert!((0.4..0.6).contains(&(valley / force[limit])), "{force:?}");

    let [driven, load] = arch("force = [{ target = \"roll\", total = [0.0, -0.2, 0.0], directions = \"y\" }]");
    println!("{driven:?}");
    assert_close("load", *load.last().unwrap(), 0.2, 1e-8);
    let after = (limit..).find(|&k| force[k] > 0.2).unwrap();
    let share = (0.2 - force[after - 1]) / (force[after] - force[after - 1]);
    let there = way[after - 1] + share * (way[after] - way[after - 1]);
    assert_close("where it hangs through", *driven.last().unwrap(), there, 1e-2);
}

/// A hook snaps over a catch and back, without friction: far softer in bending than around a node, it needs lower penalties, which
/// come of themselves; and there it bears what it bore on the way.
#[test]
fn a_slender_hook_snaps_over_a_catch() {
    let bench = Bench::new(
        r#"
        [body.hook]
        material = "m"
        plane_strain = true
        element = "hex8-eas"
        block = { box = { size = [20.0, 1.0, 1.0] }, elements = [20, 1, 1], faces = { low = "ymin", root = "xmin" } }
        [material.m]
        model = "hooke"
        young = 2000.0
        poisson = 0.3
        [tool.catch]
        profile = { points = [[18.0, -4.0], [21.0, 2.0], [24.0, -4.0]], fillets = [0.0, 1.5, 0.0] }
        flip = true
        [contact.c]
        slave = "hook.low"
        master = "catch"
        [[step]]
        increments = 30
        fix = [{ set = "hook.root" }]
        move = [{ target = "catch", by = [-6.0, 0.0, 0.0] }]
        [[step]]
        increments = 30
        fix = [{ set = "hook.root" }]
        move = [{ target = "catch", by = [6.0, 0.0, 0.0] }]
        "#,
    );
    let run = bench.solve(1, &[]);
    assert_eq!((&run.summary()["cutbacks"], &run.summary()["jumps"]), (&0.into(), &0.into()));
    assert!(run.log().contains("with other penalties"), "{}", run.log());
    let history = run.history();
    let [at, along, up] = ["catch.ux", "catch.fx", "catch.fy"].map(|name| history.column(name));
    for place in [-3.0, -4.2] {
        let there: Vec<usize> = (0..at.len()).filter(|&k| (at[k] - place).abs() < 1e-9).collect();
        let (way, back) = (there[0], there[there.len() - 1]);
        assert!(there.len() == 2 && up[way].abs() > 1e-3, "{there:?}");
        assert_small("there and back", (up[way] - up[back]).hypot(along[way] - along[back]) / up[way].abs(), 1e-6);
    }
}

/// A sheet between die and holder, which a force drives, bent by a punch: far softer in bending than against what presses it, its
/// nodes go to and fro between the tools unless they are brought there along the central path. What is found is an equilibrium,
/// on one rank and on two.
#[test]
fn a_sheet_between_two_tools() {
    let bench = Bench::new(
        r#"
        [body.blank]
        material = "m"
        element = "hex8-fbar"
        plane_strain = true
        block = { box = { size = [75.0, 0.78, 1.0] }, elements = [120, 2, 1] }
        [material.m]
        model = "neo-hookean"
        young = 206e3
        poisson = 0.3
        [tool]
        die = { profile = { points = [[37.0, -60.0], [37.0, 0.0], [150.0, 0.0]], fillets = 5.0 }, flip = true }
        holder = { profile = { points = [[150.0, 0.78], [37.0, 0.78], [37.0, 60.0]], fillets = 5.0 }, flip = true }
        punch = { profile = { points = [[35.0, 60.0], [35.0, 0.78], [-10.0, 0.78]], fillets = 8.0 }, flip = true }
        [contact]
        die = { slave = "blank.ymin", master = "die" }
        holder = { slave = "blank.ymax", master = "holder" }
        punch = { slave = "blank.ymax", master = "punch" }
        [[step]]
        increments = 2
        fix = [{ set = "blank.xmin", directions = "x" }]
        force = [{ target = "holder", total = [0.0, -65.0, 0.0], directions = "y" }]
        [[step]]
        increments = 1
        fix = [{ set = "blank.xmin", directions = "x" }]
        force = [{ target = "holder", total = [0.0, -65.0, 0.0], directions = "y" }]
        move = [{ target = "punch", by = [0.0, -0.02, 0.0] }]
        "#,
    );
    let run = bench.solve(1, &[]);
    assert_eq!((&run.summary()["cutbacks"], &run.summary()["jumps"]), (&0.into(), &0.into()), "{}", run.log());
    assert!(run.log().contains("along the central path"), "{}", run.log());
    let history = run.history();
    let [die, holder, punch] = ["die.fy", "holder.fy", "punch.fy"].map(|name| history.last(name));
    assert_close("holder", holder, -65.0, 1e-9);
    assert_small("balance", (die + holder + punch) / 65.0, 1e-8);
    assert!(punch.abs() > 1e-3, "{punch}");
    assert_small("ranks", history.difference(&bench.solve(2, &[]).history()), 1e-7);
}

/// Three leaves of a spring, clamped at one end, of which the uppermost is pressed at the other. They touch all along and press
/// each other at the tips alone, so that nothing tells which of the nodes between touch; those are found along the central path.
/// Each leaf bears a third: w = F L³ / (9 E' I).
#[test]
fn leaves_that_bend_together() {
    let (elements, size) = ([100, 2, 1], [100.0, 2.0, 1.0]);
    let leaf = |name: &str, y: f64| {
        format!(
            "[body.{name}]\nmaterial = \"steel\"\nelement = \"hex8-eas\"\nplane_strain = true\n\
             block = {{ box = {{ origin = [0.0, {y:?}, 0.0], size = {size:?} }}, elements = {elements:?} }}\n"
        )
    };
    let rest = r#"
        [material.steel]
        model = "hooke"
        young = 2e5
        poisson = 0.3
        [contact]
        ab = { slave = "b.ymin", master = "a.ymax" }
        bc = { slave = "c.ymin", master = "b.ymax" }
        [[step]]
        increments = 2
        fix = [{ set = "a.xmin" }, { set = "b.xmin" }, { set = "c.xmin" }]
        force = [{ target = "c.xmax", total = [0.0, -0.4, 0.0] }]
        [output]
        history = ["a.xmin", "b.xmin", "c.xmin", "c.xmax"]
    "#;
    let bench = Bench::new(&format!("{}{}{}{rest}", leaf("a", 0.0), leaf("b", 2.0), leaf("c", 4.0)));
    let run = bench.solve(1, &[]);
    assert_eq!((&run.summary()["cutbacks"], &run.summary()["jumps"]), (&0.into(), &0.into()), "{}", run.log());
    assert!(run.log().contains("along the central path"), "{}", run.log());
    let history = run.history();
    let bent = 0.4 * 100f64.powi(3) / (9.0 * 2e5 / (1.0 - 0.3 * 0.3) * 8.0 / 12.0);
    assert_close("deflection", -history.last("c.xmax.uy"), bent, 3e-3);
    for clamp in ["a.xmin.fy", "b.xmin.fy", "c.xmin.fy"] {
        assert_close(clamp, history.last(clamp), 0.4 / 3.0, 0.01);
    }
    assert_small("ranks", history.difference(&bench.solve(2, &[]).history()), 1e-7);
}

/// A column between clamps, shortened in increments of ten times what it takes to buckle, with or without a side load towards
/// a wall.
fn column(side: f64) -> Bench {
    Bench::new(&format!(
        r#"
        [body.s]
        material = "m"
        element = "hex8-eas"
        plane_strain = true
        block = {{ box = {{ size = [1.0, 40.0, 1.0] }}, elements = [2, 40, 1] }}
        [material.m]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.wall]
        plane = {{ point = [3.0, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }}
        [contact]
        c = {{ slave = "s.xmax", master = "wall" }}
        [[step]]
        increments = 10
        fix = [{{ set = "s.ymin" }}]
        move = [{{ target = "s.ymax", by = [0.0, -2.0, 0.0] }}]
        force = [{{ target = "s.xmax", total = [{side:?}, 0.0, 0.0] }}]
        [output]
        history = ["s.ymax"]
        "#
    ))
}

/// The straight column is an equilibrium that ten increments find, with 25 times Euler's load; it is not stable. The way that a
/// side load begins is that of 800 increments, which need no cut for it.
#[test]
fn a_column_buckles() {
    let run = column(0.05).solve(1, &[]);
    assert!(run.log().contains("converged to an equilibrium that is not stable"), "{}", run.log());
    assert_close("force", run.history().last("s.ymax.fy"), -9.4508, 1e-4);
    assert_close("wall", run.history().last("wall.fx"), -2.0245, 1e-4);
}

/// A perfect column cannot know to which side: that it would buckle is told, once.
#[test]
fn a_perfect_column_is_told_of() {
    let run = column(0.0).solve(1, &[]);
    assert_eq!(run.log().matches("is not stable: a body would buckle").count(), 1, "{}", run.log());
    // Stable up to Euler's 4 π² E' I / L².
    let (history, euler) = (run.history(), 4.0 * PI * PI * 1000.0 / (1.0 - 0.09) / 12.0 / 1600.0);
    let [time, force] = ["time", "s.ymax.fy"].map(|name| history.column(name));
    let told = run.log().split("the equilibrium at time ").nth(1).unwrap()[..8].parse::<f64>().unwrap();
    let at = time.iter().position(|t| (t - told).abs() < 1e-6).unwrap();
    assert_close("Euler's load", -force[at], euler, 0.05);
}

/// A square column under a rough plate: two modes at once, which no sign of a determinant tells, and corners that slip. In five
/// increments it bore 52.4 without a word. A seventh of the last force is friction's, which depends on its way.
#[test]
fn a_square_column_buckles_under_friction() {
    let bench = Bench::new(
        r#"
        [body.s]
        material = "m"
        element = "hex8-eas"
        block = { box = { size = [1.0, 1.0, 20.0] }, elements = [2, 2, 20] }
        [material.m]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.p]
        plane = { point = [0.0, 0.0, 20.0], normal = [0.0, 0.0, -1.0] }
        [contact]
        c = { slave = "s.zmax", master = "p", friction = 0.5 }
        [[step]]
        increments = 5
        fix = [{ set = "s.zmin" }]
        move = [{ target = "p", by = [0.0, 0.0, -1.0] }]
        force = [{ target = "s.xmax", total = [0.05, 0.02, 0.0] }]
        "#,
    );
    let run = bench.solve(1, &[]);
    assert!(run.log().contains("converged to an equilibrium that is not stable"), "{}", run.log());
    assert_close("force", run.history().last("p.fz"), -4.994, 0.02);
    assert_close("ranks", bench.solve(2, &[]).history().last("p.fz"), -4.994, 0.02);
}

/// A plate is lifted to where it touches a rubber block that it has pressed: from there the block needs no iteration, and what
/// an attempt before has factored says nothing of it.
#[test]
fn a_block_at_rest_is_stable() {
    let bench = Bench::new(
        r#"
        [body.b]
        material = "m"
        element = "hex8-fbar"
        plane_strain = true
        block = { box = { size = [40.0, 10.0, 1.0] }, elements = [40, 10, 1] }
        [material.m]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.49
        [tool.t]
        plane = { point = [0.0, 11.0, 0.0], normal = [0.0, -1.0, 0.0] }
        [contact]
        c = { slave = "b.ymax", master = "t" }
        [[step]]
        increments = 5
        fix = [{ set = "b.ymin" }]
        move = [{ target = "t", by = [0.0, -2.5, 0.0] }]
        [[step]]
        increments = 5
        keep = true
        move = [{ target = "t", by = [0.0, 2.5, 0.0] }]
        "#,
    );
    let run = bench.solve(1, &[]);
    assert!(!run.log().contains("not stable"), "{}", run.log());
}

/// What a step turns at one end goes along as one, without a strain: the tangent would make it yield.
#[test]
fn a_metal_bar_is_turned_by_its_end() {
    let bench = Bench::new(
        r#"
        [body.bar]
        material = "steel"
        block = { box = { size = [20, 2, 2] }, elements = [10, 2, 2] }
        [material.steel]
        model = "j2"
        young = 70000.0
        poisson = 0.33
        yield_stress = 100.0
        hardening = { linear = 200.0 }
        [[step]]
        increments = 6
        move = [{ target = "bar.xmin", rotate = { point = [1, 0, 0], axis = [0, 1, 1], angle = 150 } }]
        "#,
    );
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let counts = &run.summary()["counts"];
        assert_eq!(run.history().len(), 6, "{counts}");
        assert!(run.log().contains("again with what is turned going along at first"), "{}", run.log());
        assert!(run.history().column("iterations")[1..].iter().all(|&iterations| iterations <= 1.0), "{}", run.log());
        let moved = run.vectors(run.written(), "body.bar", "displacement");
        // About the axis w by Rodrigues' formula.
        let (sine, cosine, w) = ((5.0 * PI / 6.0).sin(), (5.0 * PI / 6.0).cos(), [0.0, 0.5f64.sqrt(), 0.5f64.sqrt()]);
        for (x, u) in run.points("body.bar").iter().zip(&moved) {
            let a = [x[0] - 1.0, x[1], x[2]];
            let cross = [w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2], w[0] * a[1] - w[1] * a[0]];
            let along: f64 = (0..3).map(|d| w[d] * a[d]).sum();
            let turned = [0, 1, 2].map(|d| a[d] * cosine + cross[d] * sine + w[d] * along * (1.0 - cosine));
            let off = (0..3).map(|d| (a[d] + u[d] - turned[d]).abs()).fold(0.0, f64::max);
            assert_small("off its place", off, 1e-9);
        }
    }
}
