//! Coulomb's law against what statics says of blocks and cylinders that stick, slip and turn back.

mod common;

use common::{Bench, Run, assert_close, assert_small, msh};
use nagata::Vec3;

const MU: f64 = 0.3;

/// A soft block of 2 x 1 x 1 on the plane z = 0.
fn block_on_a_plane(steps: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.block]
        block = {{ box = {{ size = [2.0, 1.0, 1.0] }}, elements = [4, 2, 2] }}
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.floor]
        plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
        [contact.foot]
        slave = "block.zmin"
        master = "floor"
        friction = {MU:?}
        {steps}
        [output]
        every = 1
        history = ["block.zmax"]
        "#
    ))
}

/// Tangential over normal force of the block's top, at each increment of a step.
fn ratios(run: &Run, step: &str) -> Vec<f64> {
    let history = run.history();
    let (fx, fz) = (history.column("block.zmax.fx"), history.column("block.zmax.fz"));
    (0..history.len()).filter(|&k| history.steps[k] == step).map(|k| -fx[k] / fz[k]).collect()
}

/// ```text
///      v v v v  pressed, then moved ->
///     +-------+                           |T| / N grows while some of the foot sticks, then is mu: the mean of nodes that
///     | block |                           all slip alike.
///   --+-------+-------------- plane
/// ```
/// Pressed by a prescribed displacement, so that the normal force is the solver's.
#[test]
fn block_pulled_under_displacement() {
    let bench = block_on_a_plane(
        r#"
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "block.zmax", directions = "xy" }]
        move = [{ target = "block.zmax", by = [0.0, 0.0, -0.05], directions = "z" }]
        [[step]]
        name = "pull"
        increments = 8
        fix = [{ set = "block.zmax", directions = "yz" }]
        move = [{ target = "block.zmax", by = [0.08, 0.0, 0.0], directions = "x" }]
        [[step]]
        name = "drag"
        increments = 8
        fix = [{ set = "block.zmax", directions = "yz" }]
        move = [{ target = "block.zmax", by = [0.8, 0.0, 0.0], directions = "x" }]
        "#,
    );
    let run = bench.solve(2, &[]);
    assert_small("no pull while pressed", ratios(&run, "press")[1], 1e-9);
    let pull = ratios(&run, "pull");
    let stick = run.history().column("foot.stick").to_vec();
    assert!(pull[0] > 0.01 && pull[0] < 0.9 * MU && stick[2] > 0.0);
    for k in 1..pull.len() {
        assert!(pull[k] >= pull[k - 1] - 1e-9 && pull[k] <= MU + 1e-9);
        assert!(stick[2 + k] == 0.0 || pull[k] < MU - 1e-6, "{pull:?}");
    }
    assert_close("full slip", *ratios(&run, "drag").last().unwrap(), MU, 1e-10);
}

/// The same under a dead load N: the pull is mu N at full slip whatever way it came there, one way and back.
#[test]
fn block_pulled_under_a_dead_load_and_back() {
    let step = |name: &str, by: f64| {
        format!(
            r#"
            [[step]]
            name = "{name}"
            increments = 10
            fix = [{{ set = "block.zmax", directions = "y" }}]
            force = [{{ target = "block.zmax", total = [0.0, 0.0, -6.0] }}]
            move = [{{ target = "block.zmax", by = [{by:?}, 0.0, 0.0], directions = "x" }}]
            "#
        )
    };
    let press = r#"
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "block.zmax", directions = "xy" }]
        force = [{ target = "block.zmax", total = [0.0, 0.0, -6.0] }]
        "#;
    let scene = [press.to_string(), step("forth", 1.0), step("back", -1.5), step("again", 1.0)].concat();
    let run = block_on_a_plane(&scene).solve(2, &[]);
    let history = run.history();
    for (step, sign) in [("forth", 1.0), ("back", -1.0), ("again", 1.0)] {
        let rows: Vec<usize> = (0..history.len()).filter(|&k| history.steps[k] == step).collect();
        let pull = |k: usize| history.column("block.zmax.fx")[k] / 6.0;
        println!("{step}: {:?}", rows.iter().map(|&k| pull(k)).collect::<Vec<_>>());
        assert!(rows.iter().all(|&k| pull(k).abs() <= MU + 1e-9));
        assert_close(step, pull(*rows.last().unwrap()), sign * MU, 1e-8);
        assert_close("normal force", history.column("floor.fz")[*rows.last().unwrap()], 6.0, 1e-9);
    }
}

/// ```text
///               __--+         NAFEMS benchmark CGS-4: a block of weight G on a slope tan(a) = 0.1 with mu = 0.3, pushed by a
///       F -> |block |         horizontal force F. It goes up when F / G = (tan a + mu) / (1 - mu tan a) = 0.412371, and is
///            |__--               pulled down when -F / G = (mu - tan a) / (1 + mu tan a) = 0.194175.
///         __--  a
/// ```
/// The face is moved along x and free otherwise, so that its reaction is the horizontal force.
#[test]
fn block_on_a_slope() {
    let (slope, weight) = (0.1f64, 2.0);
    let (s, c) = slope.atan().sin_cos();
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        mesh = "block.msh"
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.slope]
        plane = {{ point = [0.0, 0.0, 0.0], normal = [{:?}, 0.0, {c:?}] }}
        [contact.foot]
        slave = "block.zmin"
        master = "slope"
        friction = {MU:?}
        [[step]]
        name = "load"
        increments = 2
        fix = [{{ set = "block.xmin", directions = "xz" }}, {{ set = "block", directions = "y" }}]
        body_force = [{{ body = "block", per_volume = [0.0, 0.0, {:?}] }}]
        [[step]]
        name = "up"
        increments = 10
        fix = [{{ set = "block", directions = "y" }}]
        move = [{{ target = "block.xmin", by = [0.5, 0.0, 0.0], directions = "x" }}]
        body_force = [{{ body = "block", per_volume = [0.0, 0.0, {:?}] }}]
        [[step]]
        name = "down"
        increments = 10
        fix = [{{ set = "block", directions = "y" }}]
        move = [{{ target = "block.xmin", by = [-0.5, 0.0, 0.0], directions = "x" }}]
        body_force = [{{ body = "block", per_volume = [0.0, 0.0, {:?}] }}]
        [solver]
        tolerance = 1e-12 # the law is exact, and so is the comparison
        [output]
        history = ["block.xmin"]
        "#,
        -s,
        -weight / 4.0,
        -weight / 4.0,
        -weight / 4.0
    ));
    let turned = |x: [f64; 3]| [4.0 * x[0] * c - 2.0 * x[2] * s, 0.5 * x[1], 4.0 * x[0] * s + 2.0 * x[2] * c];
    bench.write("block.msh", &msh::block([8, 1, 4], false, turned));
    let history = bench.solve(2, &[]).history();
    let push = history.column("block.xmin.fx");
    let last = |step: &str| push[history.steps.iter().rposition(|s| s == step).unwrap()] / weight;
    assert_close("up", last("up"), (slope + MU) / (1.0 - MU * slope), 1e-8);
    assert_close("down", last("down"), (slope - MU) / (1.0 + MU * slope), 1e-8);
    assert_close("up, as printed", last("up"), 0.412371, 1e-6);
    let up: Vec<f64> = (0..push.len()).filter(|&k| history.steps[k] == "up").map(|k| push[k] / weight).collect();
    assert!(up.iter().all(|&f| f < (slope + MU) / (1.0 - MU * slope) * (1.0 + 1e-8)));
    let floor = [history.last("slope.fx"), history.last("slope.fz")];
    assert_small("balance along x", (floor[0] + history.last("block.xmin.fx")) / weight, 1e-9);
    assert_close("weight", floor[1], weight, 1e-9);
}

/// ```text
///        ( O )  ->            A cylinder is pressed into a slab in plane strain, slides, and slides back.
///     ___/   \_____
///    |  slab       |
///    |_____________| held
/// ```
fn ironing(increments: usize) -> Bench {
    Bench::new(&format!(
        r#"
        [body.slab]
        block = {{ box = {{ origin = [-4.0, -3.0, 0.0], size = [10.0, 3.0, 0.5] }}, elements = [30, 6, 1] }}
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.roll]
        cylinder = {{ point = [0.0, 2.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }}
        [contact.top]
        slave = "slab.ymax"
        master = "roll"
        friction = {MU:?}
        [[step]]
        name = "press"
        increments = 4
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [0.0, -0.3, 0.0] }}]
        [[step]]
        name = "forth"
        increments = {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [1.2, 0.0, 0.0] }}]
        [[step]]
        name = "back"
        increments = {increments}
        fix = [{{ set = "slab.ymin" }}]
        move = [{{ target = "roll", by = [-1.2, 0.0, 0.0] }}]
        [output]
        history = ["slab.ymin"]
        "#
    ))
}

/// Every node obeys Signorini's and Coulomb's laws in every increment: in the gap no force and no penetration; in contact
/// no gap and a push; sticking within the cone; slipping on it, against the way the node went over the tool.
#[test]
fn every_node_obeys_the_laws() {
    let run = ironing(16).solve(2, &[]);
    let history = run.history();
    let (points, grid) = (run.points("contact.top"), "contact.top");
    let largest = history.column("roll.fy").iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let mut worst = [0.0f64; 4];
    let mut seen = [0; 3];
    let mut before = vec![[0.0; 3]; points.len()];
    let mut tool_before = Vec3::zeros();
    assert_eq!(run.written(), history.len());
    for k in 1..=run.written() {
        let (status, gap) = (run.scalars(k, grid, "status"), run.scalars(k, grid, "gap"));
        let (force, normal) = (run.vectors(k, grid, "force"), run.vectors(k, grid, "normal"));
        let moved = run.vectors(k, grid, "displacement");
        let tool = Vec3::from(["ux", "uy", "uz"].map(|c| history.column(&format!("roll.{c}"))[k - 1]));
        for (n, x) in points.iter().enumerate() {
            let (f, normal) = (Vec3::from(force[n]), Vec3::from(normal[n]));
            let push = f.dot(&normal);
            let friction = f - normal * push;
            seen[status[n] as usize] += 1;
            if status[n] == 0.0 {
                assert_eq!(f, Vec3::zeros());
                worst[0] = worst[0].max(if gap[n].is_nan() { 0.0 } else { -gap[n] });
                continue;
            }
            let center = Vec3::new(0.0, 2.0, 0.0) + tool;
            let place = Vec3::from(*x) + Vec3::from(moved[n]);
            let arm = Vec3::new(place.x - center.x, place.y - center.y, 0.0);
            assert!(push > 0.0 && (arm / arm.norm() - normal).norm() < 1e-12);
            worst[1] = worst[1].max((arm.norm() - 2.0).abs());
            if status[n] == 1.0 {
                assert!(friction.norm() <= MU * push * (1.0 + 1e-8), "{k} {n}: {} {}", friction.norm(), MU * push);
                continue;
            }
            worst[2] = worst[2].max((friction.norm() / (MU * push) - 1.0).abs());
            // How the node went over the tool in this increment, for small turns of the normal.
            let went = Vec3::from(moved[n]) - Vec3::from(before[n]) - (tool - tool_before);
            let slip = went - normal * went.dot(&normal);
            if slip.norm() > 1e-3 {
                worst[3] = worst[3].max((friction / friction.norm() + slip / slip.norm()).norm());
            }
        }
        (before, tool_before) = (moved, tool);
    }
    println!("gap, stick, slip: {seen:?}");
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
    assert_small("penetration in the gap", worst[0], 1e-10);
    assert_small("distance in contact", worst[1], 1e-10);
    assert_small("slip on the cone", worst[2], 1e-8);
    assert_small("friction against the slip", worst[3], 1e-6);
    assert!(largest > 1.0);
    // The way back is the way forth turned over: what drives the tool changes its sign.
    let last = |step: &str| history.column("roll.fx")[history.steps.iter().rposition(|s| s == step).unwrap()];
    assert!(last("forth") > 0.2 * largest && last("back") < -0.2 * largest, "{} {}", last("forth"), last("back"));
}

/// ```text
///       T2 <- ==___           A band around a quarter of a drum slips when T2 / T1 = exp(mu theta), with the angle theta over which
///            ( |   \\         it lies on (Euler, Eytelwein). Its tension acts in its middle, t / 2 off the drum, so that an
///             -+-   ||        element of it turns by dT (R + t/2) = mu T R d theta: the exponent is mu theta / (1 + t / 2R).
///              drum |v T1
/// ```
/// One end is held along the drum, the other drawn: the band stretches and slips all over.
#[test]
fn band_around_a_drum() {
    let thickness = 0.02;
    let bench = Bench::new(&format!(
        r#"
        [body.band]
        material = "strap"
        plane_strain = true
        [body.band.block]
        sector = {{ radii = [1.0, {:?}], angles = [0.0, 90.0], length = 0.05 }}
        elements = [2, 60, 1]
        [material.strap]
        model = "hooke"
        young = 1000.0
        poisson = 0.0
        [tool.drum]
        cylinder = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }}
        [contact.wrap]
        slave = "band.rmin"
        master = "drum"
        friction = {MU:?}
        [[step]]
        increments = 5
        fix = [{{ set = "band.amin", directions = "y" }}]
        move = [{{ target = "band.amax", by = [-0.005, 0.0, 0.0], directions = "x" }}]
        [output]
        every = 100
        history = ["band.amin", "band.amax"]
        "#,
        1.0 + thickness
    ));
    let history = bench.solve(2, &[]).history();
    println!(
        "{:?} {:?} {:?}",
        history.column("band.amax.fx"),
        history.column("wrap.slip"),
        history.column("wrap.stick")
    );
    let ratio = -history.last("band.amax.fx") / -history.last("band.amin.fy");
    let exponent = MU * std::f64::consts::FRAC_PI_2 / (1.0 + 0.5 * thickness);
    assert_close("tension", ratio, exponent.exp(), 5e-3);
}

/// A belt of thickness 0.2 and so many elements that lies around half of a pulley of radius 50.
fn belt_around_a_pulley(elements: usize) -> String {
    format!(
        r#"
        [body.belt]
        material = "strap"
        plane_strain = true
        [body.belt.block]
        sector = {{ radii = [50.0, 50.2], angles = [0.0, 180.0], length = 1.0 }}
        elements = [2, {elements}, 1]
        [material.strap]
        model = "hooke"
        young = 1000.0
        poisson = 0.3
        [tool.pulley]
        cylinder = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 50.0 }}
        [contact.wrap]
        slave = "belt.rmin"
        master = "pulley"
        friction = {MU:?}
        "#
    )
}

/// The same around half of a pulley, thin and fine: all nodes begin to touch at once, with no force, and are to slip. Without friction
/// first the iteration went to and fro in increments of any length. By methods that hold multipliers, and those that do not.
#[test]
fn a_thin_belt_around_a_pulley_is_pulled_without_jumps() {
    for (elements, method, tolerance) in [
        (60, "augmented-lagrangian", 0.02),
        (240, "augmented-lagrangian", 6e-3),
        (240, "uzawa", 6e-3),
        (240, "penalty", 6e-3),
    ] {
        let bench = Bench::new(&format!(
            r#"
            {}
            method = "{method}"
            [[step]]
            increments = 10
            fix = [{{ set = "belt.amax" }}]
            move = [{{ target = "belt.amin", by = [0.0, -1.0, 0.0], directions = "y" }}]
            [output]
            every = 100
            history = ["belt.amin", "belt.amax"]
            "#,
            belt_around_a_pulley(elements)
        ));
        let run = bench.solve(1, &[]);
        let (history, log) = (run.history(), run.log());
        assert_eq!(run.summary()["cutbacks"], 0, "{elements} {method}");
        assert!(!log.contains("jump, step") && log.contains("once all is in balance without it"), "{log}");
        let ratio = history.last("belt.amin.fy") / history.last("belt.amax.fy");
        let exponent = MU * std::f64::consts::PI / (1.0 + 0.1 / 50.0);
        assert_close(&format!("tension, {elements}, {method}"), ratio, exponent.exp(), tolerance);
    }
}

/// Beside a belt that is pulled so, a wedge of 5 degrees that friction has locked between two planes stays there: what bears already
/// keeps its friction all the time.
#[test]
fn what_friction_has_locked_stays_beside_what_begins_to_touch() {
    let belt = belt_around_a_pulley(60);
    let springs = "spring = [{ set = \"w\", stiffness = [0.001, 0.001, 0.0] }]";
    let held = "fix = [{ set = \"belt.amax\" }, { set = \"belt.amin\" }]";
    let bench = Bench::new(&format!(
        r#"
        {belt}
        [body.w]
        mesh = "wedge.msh"
        material = "strap"
        plane_strain = true
        [tool.left]
        plane = {{ point = [195.0, 0.0, 0.0], normal = [0.9961946980917455, 0.08715574274765817, 0.0] }}
        [tool.right]
        plane = {{ point = [205.0, 0.0, 0.0], normal = [-0.9961946980917455, 0.08715574274765817, 0.0] }}
        [contact.l]
        slave = "w.xmin"
        master = "left"
        friction = {MU:?}
        [contact.r]
        slave = "w.xmax"
        master = "right"
        friction = {MU:?}
        [[step]]
        name = "in"
        increments = 5
        {held}
        force = [{{ target = "w.ymax", total = [0.0, -84.0, 0.0] }}]
        {springs}
        [[step]]
        name = "free"
        increments = 5
        {held}
        {springs}
        [[step]]
        name = "pull"
        increments = 10
        fix = [{{ set = "belt.amax" }}]
        move = [{{ target = "belt.amin", by = [0.0, -1.0, 0.0], directions = "y" }}]
        {springs}
        [output]
        every = 100
        history = ["belt.amin", "w.ymax"]
        "#
    ));
    let lean = 5f64.to_radians().tan();
    let place = |[s, t, r]: [f64; 3]| [200.0 + (2.0 * s - 1.0) * (5.0 + lean * 10.0 * t), 10.0 * t, r];
    bench.write("wedge.msh", &msh::block([6, 6, 1], false, place));
    // With more iterations, or as sums of two ranks round at times, another way may find it.
    let run = bench.solve(1, &["--set", "solver.max_iterations=10"]);
    assert!(run.log().contains("once all is in balance without it"), "{}", run.log());
    let history = run.history();
    let at_end = |step: &str| {
        let row = history.steps.iter().rposition(|name| name == step).unwrap();
        [history.column("left.fx")[row].abs(), history.column("w.ymax.uy")[row]]
    };
    let [free, pulled] = ["free", "pull"].map(at_end);
    assert!(free[0] > 80.0, "{free:?}");
    assert_close("force of the wedge", pulled[0], free[0], 1e-3);
    assert_close("where it is", pulled[1], free[1], 1e-3);
}

/// A strip under a plane that presses it and then slides along it by 2.5: either the plane moves or the strip.
fn strip_across(steps: &str) -> Run {
    let bench = Bench::new(&format!(
        r#"
        [body.strip]
        block = {{ box = {{ origin = [-10.0, 0.0, 0.0], size = [20.0, 5.0, 2.0] }}, elements = [10, 3, 1] }}
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.plate]
        plane = {{ point = [0.0, 5.0, 0.0], normal = [0.0, -1.0, 0.0] }}
        [contact.top]
        slave = "strip.ymax"
        master = "plate"
        friction = {MU:?}
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "strip.ymin", directions = "xy" }}, {{ set = "strip", directions = "z" }}]
        move = [{{ target = "plate", by = [0.0, -1.0, 0.0] }}]
        {steps}
        [output]
        history = ["strip.ymin", "strip.xmax"]
        "#
    ));
    bench.solve(2, &[])
}

/// A block under its weight, led to and fro over a plane by a face with an edge on the plane, in short increments and long: each
/// way it meets mu times its weight, whatever the nodes of that edge had before it turned.
#[test]
fn what_is_led_back_meets_as_much_friction() {
    let dragged = |[there, back]: [usize; 2], how: &str| {
        Bench::new(&format!(
            r#"
            [body.b]
            material = "m"
            plane_strain = true
            block = {{ box = {{ size = [4.0, 3.0, 1.0] }}, elements = [4, 3, 1] }}
            [material.m]
            model = "hooke"
            young = 1000.0
            poisson = 0.3
            density = 1.0
            [tool.floor]
            plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }}
            [contact.c]
            slave = "b.ymin"
            master = "floor"
            friction = 0.25
            {how}
            [[step]]
            name = "rest"
            increments = 2
            gravity = [0.0, -1.0, 0.0]
            [[step]]
            name = "there"
            keep = true
            increments = {there}
            move = [{{ target = "b.xmin", by = [0.3, 0.0, 0.0], directions = "x" }}]
            [[step]]
            name = "back"
            keep = true
            increments = {back}
            move = [{{ target = "b.xmin", by = [-0.3, 0.0, 0.0], directions = "x" }}]
            "#
        ))
    };
    for increments in [[20, 8], [4, 60], [60, 200]] {
        for how in ["", "method = \"lagrange\"", "method = \"uzawa\"", "discretization = \"segment\"", "penalty = 10.0"]
        {
            let run = dragged(increments, how).solve(1, &[]);
            let history = run.history();
            let force = history.column("floor.fx");
            assert_close(how, force[1 + increments[0]], -3.0, 1e-6);
            assert_close(how, history.last("floor.fx"), 3.0, 1e-6);
        }
    }
}

/// A block pressed on a floor by a face that is held, with an edge that slides out along y and is then led along x by little: its
/// friction turns from the one way to the other at once, and all methods and penalties find how far.
#[test]
fn what_is_led_across_what_it_bore_has_one_friction() {
    let bench = Bench::new(
        r#"
        [body.b]
        material = "m"
        block = { box = { size = [2.0, 2.0, 1.0] }, elements = [2, 2, 2] }
        [material.m]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.floor]
        plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
        [contact.c]
        slave = "b.zmin"
        master = "floor"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "b.xmin", directions = "x" }]
        move = [{ target = "b.zmax", by = [0.0, 0.0, -0.05] }]
        [[step]]
        name = "slide"
        increments = 1
        move = [
            { target = "b.zmax", by = [2e-4, 0.0, 0.0] },
            { target = "b.xmin", by = [2e-4, 0.0, 0.0], directions = "x" },
        ]
        "#,
    );
    let ways = ["method=\"lagrange\"", "method=\"uzawa\"", "penalty=\"auto\"", "penalty=10.0", "penalty=1e4"];
    let forces = ways.map(|how| bench.solve(1, &["--set", &format!("contact.c.{how}")]).history().last("floor.fx"));
    for (how, force) in ways.iter().zip(forces) {
        // As the method with active sets had it before nodes that are led had a penalty of their own.
        assert_close(how, force, -3.734187336605356, 1e-8);
    }
}

/// Slave nodes that are led along z cannot stick, and their friction does not depend on who moves.
#[test]
fn nodes_drawn_along_a_tool_slip() {
    let by_strip = strip_across(
        r#"
        [[step]]
        name = "slide"
        increments = 5
        fix = [{ set = "strip.ymin", directions = "xy" }]
        move = [{ target = "strip", by = [0.0, 0.0, 2.5], directions = "z" }]
        "#,
    )
    .history();
    let by_plate = strip_across(
        r#"
        [[step]]
        name = "slide"
        increments = 5
        fix = [{ set = "strip.ymin", directions = "xy" }, { set = "strip", directions = "z" }]
        move = [{ target = "plate", by = [0.0, 0.0, -2.5] }]
        "#,
    )
    .history();
    let all = ["plate.fy", "plate.fz", "strip.ymin.fx", "strip.xmax.fx", "strip.xmax.ux", "strip.xmax.uy"];
    for name in all {
        let scale = if name.contains(".f") { by_plate.last("plate.fy") } else { 1.0 };
        assert_small(name, (by_strip.last(name) - by_plate.last(name)) / scale, 1e-9);
    }
    let ratio = by_strip.last("plate.fz") / by_strip.last("plate.fy");
    assert!((0.995 * MU..MU).contains(&ratio), "{ratio}");
    assert_eq!(by_strip.last("top.slip"), 22.0);
}

/// A sphere on a block, or on a part of it with planes of symmetry.
fn sphere_on_a_block(origin: f64, center: [f64; 2], elements: usize, fix: &str) -> Run {
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        block = {{ box = {{ origin = [{origin:?}, {origin:?}, 0.0], size = [{0:?}, {0:?}, 10.0] }}, elements = [{elements}, {elements}, 5] }}
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.ball]
        sphere = {{ center = [{1:?}, {2:?}, 30.0], radius = 20.0 }}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        friction = 0.8
        [[step]]
        increments = 4
        fix = [{{ set = "block.zmin" }}, {fix}]
        move = [{{ target = "ball", by = [0.0, 0.0, -1.0] }}]
        "#,
        10.0 - origin,
        center[0],
        center[1]
    ));
    bench.solve(2, &[])
}

/// Nodes on a plane of symmetry stick and slip in that plane, also where the tool leans over it.
#[test]
fn planes_of_symmetry() {
    let symmetry = r#"{ set = "block.xmin", directions = "x" }, { set = "block.ymin", directions = "y" }"#;
    let quarter = sphere_on_a_block(0.0, [0.0, 0.0], 5, symmetry).history();
    let whole = sphere_on_a_block(-10.0, [0.0, 0.0], 10, "").history();
    assert_close("force", 4.0 * quarter.last("ball.fz"), whole.last("ball.fz"), 1e-8);
    let leaning = sphere_on_a_block(0.0, [1.0, 1.5], 5, symmetry).summary();
    assert_eq!(leaning["cutbacks"], 0);
    assert!(leaning["iterations"].as_u64().unwrap() <= 20, "{leaning}");
}

/// A block stands on another by friction alone, with nothing that presses it until a ball does, and again when it has left.
fn block_on_a_block(method: &str, more: &str) -> Bench {
    Bench::new(&format!(
        r#"
        body.a = {{ material = "m", block = {{ box = {{ origin = [-0.5, -0.5, 0.0], size = [6.0, 5.0, 2.0] }}, elements = [5, 4, 2] }} }}
        body.b = {{ material = "m", element = "hex8", block = {{ box = {{ origin = [0.6, 0.4, 2.0], size = [3.9, 3.1, 1.5] }}, elements = [4, 3, 2] }} }}
        material.m = {{ model = "neo-hookean", young = 50.0, poisson = 0.3 }}
        contact.j = {{ slave = "b.zmin", master = "a.zmax", friction = 0.3 }}
        tool.t.sphere = {{ center = [2.6, 2.1, 6.55], radius = 3.0 }}
        contact.c = {{ slave = "b.zmax", master = "t", method = "{method}" }}
        output.history = ["b.zmax"]
        [[step]]
        name = "press"
        increments = 3
        fix = [{{ set = "a.zmin" }}]
        move = [{{ target = "t", by = [0.0, 0.0, -0.3] }}]
        {more}
        "#
    ))
}

#[test]
fn what_friction_alone_holds_is_not_thrown() {
    // The ball comes through a gap; all methods find the same.
    let [alike, other] = ["augmented-lagrangian", "lagrange"].map(|method| block_on_a_block(method, "").solve(2, &[]));
    for column in ["t.fz", "b.zmax.ux", "b.zmax.uy"] {
        let [a, b] = [&alike, &other].map(|run| run.history().last(column));
        assert_small(column, (a - b) / a.abs().max(1.0), 1e-9);
    }
    // Where the block ends that nothing presses any more is a matter of rounding: it stays, or the run ends before.
    let lifted = "[[step]]\nname = \"lift\"\nincrements = 2\nfix = [{ set = \"a.zmin\" }]\n\
                  move = [{ target = \"t\", by = [0.0, 0.0, 0.5] }]";
    let run = block_on_a_block("augmented-lagrangian", lifted).run(1, &[]);
    assert!(run.code == 0 || run.stderr.contains("for no contact holds it any more"), "{}", run.stderr);
    for column in ["b.zmax.ux", "b.zmax.uy"] {
        assert_small(column, run.history().last(column), 0.02);
    }
}

/// A body between two plates with friction, `p` above and `q` below: each presses on a set, at a height.
fn between_plates(block: &str, [above, below]: [(&str, f64); 2], steps: &str) -> Bench {
    let ((high, top), (low, bottom)) = (above, below);
    Bench::new(&format!(
        r#"
        [body.s]
        material = "m"
        element = "hex8-eas"
        plane_strain = true
        block = {block}
        [material.m]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.p]
        plane = {{ point = [0.0, {top:?}, 0.0], normal = [0.0, -1.0, 0.0] }}
        [tool.q]
        plane = {{ point = [0.0, {bottom:?}, 0.0], normal = [0.0, 1.0, 0.0] }}
        [contact]
        c = {{ slave = "{high}", master = "p", friction = 0.2 }}
        d = {{ slave = "{low}", master = "q", friction = 0.2 }}
        {steps}
        "#
    ))
}

/// A ring that is crushed between two plates and held along x by their friction alone: at times all nodes that touch slip
/// outwards, and equilibrium does not say where it is. Found without a cut, with the force of a ring that a soft spring holds,
/// in the middle, to the ends of what friction of 1e-6 an edge more makes of the slips.
#[test]
fn a_ring_that_slips_to_both_sides_stays() {
    let block = "{ sector = { radii = [9.0, 10.0], angles = [-90, 270], length = 1.0 }, elements = [2, 36, 1] }";
    let bench = between_plates(
        block,
        [("s.rmax", 10.0), ("s.rmax", -10.0)],
        r#"
        [[step]]
        increments = 16
        move = [{ target = "p", by = [0.0, -8.0, 0.0] }, { target = "q", by = [0.0, 8.0, 0.0] }]
        [output]
        history = ["s"]
        "#,
    );
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let history = run.history();
        assert_eq!(run.summary()["cutbacks"], 0, "{}", run.log());
        assert_close("force", history.last("p.fy"), -9.5839, 1e-5);
        assert_small("aside", history.last("s.ux"), 1e-3);
        assert_small("balance", history.last("p.fx") + history.last("q.fx"), 1e-8);
    }
}

/// A strip between plates that is pulled by more than their friction: what slips to one side is let go.
#[test]
fn a_strip_that_is_pulled_off_is_let_go() {
    let bench = between_plates(
        "{ box = { size = [2.0, 1.0, 1.0] }, elements = [8, 4, 1] }",
        [("s.ymax", 1.0), ("s.ymin", 0.0)],
        r#"
        [[step]]
        increments = 2
        move = [{ target = "p", by = [0.0, -0.02, 0.0] }]
        [[step]]
        increments = 10
        force = [{ target = "s.xmax", total = [2.0, 0.0, 0.0] }]
        keep = true
        "#,
    );
    let run = bench.run(1, &[]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let (history, friction) = (run.history(), 0.2);
    let pulled = 2.0 * (history.last("time") - 1.0);
    let most = -2.0 * friction * history.last("p.fy");
    assert!(pulled <= most * (1.0 + 1e-6) && pulled > 0.9 * most, "{pulled} of {most}: {}", run.stderr);
    assert!(run.stderr.contains("% of the friction that it can"), "{}", run.stderr);
}

/// On a slope they let go of it, which is told of; in one step with the motion they keep it.
#[test]
fn friction_that_goes_where_held_nodes_rest_on_a_slope_is_told_of() {
    let scene = |steps: &str| {
        Bench::new(&format!(
            "[body.b]\nmaterial = \"m\"\nplane_strain = true\nblock = {{ box = {{ size = [4.0, 2.0, 1.0] }}, elements = [4, 2, 1] }}\n\
             [material.m]\nmodel = \"hooke\"\nyoung = 1000.0\npoisson = 0.0\n\
             [tool.floor]\nplane = {{ point = [0, 0, 0], normal = [0.1, 1, 0] }}\n\
             [contact.c]\nslave = \"b.ymin\"\nmaster = \"floor\"\nfriction = 0.3\n{steps}[output]\nhistory = [\"b\"]\n"
        ))
    };
    let press = "force = [{ target = \"b.ymax\", total = [0.0, -40.0, 0.0] }]\n";
    let push = |table: &str| format!("move = [{{ target = \"b\", by = [0.5, 0, 0], directions = \"x\"{table} }}]\n");
    let first = format!(
        "[[step]]\nname = \"press\"\nincrements = 2\nfix = [{{ set = \"b\", directions = \"x\" }}]\n{press}\
         [[step]]\nname = \"push\"\nincrements = 8\nkeep = true\n"
    );
    let told = |run: &Run| run.log().contains("let go of friction of ");
    let apart =
        scene(&format!("{first}{}[[step]]\nname = \"rest\"\nincrements = 2\nkeep = true\n", push(""))).solve(2, &[]);
    assert!(told(&apart), "{}", apart.log());
    let together = scene(&format!("{first}{}", push(", table = [[0, 0], [0.8, 1], [1, 1]]"))).solve(2, &[]);
    assert!(!told(&together), "{}", together.log());
}

/// A block that is pressed and pushed over a floor, rests, and is pressed harder and less: what nodes that are held along the floor
/// bear of the friction stays, as far as it is within the cone; in a step of its own as within one.
#[test]
fn friction_stays_where_nodes_that_are_held_rest() {
    for (held, method) in [
        ("b.xmin", "augmented-lagrangian"),
        ("b.xmin", "lagrange"),
        ("b", "augmented-lagrangian"),
        ("b", "penalty"),
        ("b", "uzawa"),
        ("b.ymax", "augmented-lagrangian"),
    ] {
        for discretization in ["one-pass", "segment"] {
            let press = |force: f64| format!("force = [{{ target = \"b.ymax\", total = [0.0, {force:?}, 0.0] }}]\n");
            let bench = Bench::new(&format!(
                "[body.b]\nmaterial = \"m\"\nplane_strain = true\nblock = {{ box = {{ size = [4.0, 2.0, 1.0] }}, elements = [4, 2, 1] }}\n\
                 [material.m]\nmodel = \"hooke\"\nyoung = 1000.0\npoisson = 0.0\n\
                 [tool.floor]\nplane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n\
                 [contact.c]\nslave = \"b.ymin\"\nmaster = \"floor\"\nfriction = 0.3\nmethod = \"{method}\"\n\
                 discretization = \"{discretization}\"\n\
                 [[step]]\nname = \"press\"\nincrements = 2\nfix = [{{ set = \"{held}\", directions = \"x\" }}]\n{}\
                 [[step]]\nname = \"push\"\nincrements = 5\nkeep = true\nmove = [{{ target = \"{held}\", by = [0.5, 0, 0], directions = \"x\" }}]\n\
                 [[step]]\nname = \"rest\"\nincrements = 2\nkeep = true\n\
                 [[step]]\nname = \"harder\"\nincrements = 2\nkeep = true\n{}\
                 [[step]]\nname = \"less\"\nincrements = 4\nkeep = true\n{}\
                 [output]\nhistory = [\"b\"]\n",
                press(-40.0),
                press(-60.0),
                press(-20.0),
            ));
            let run = bench.solve(1, &[]);
            assert!(!run.log().contains("let go of friction"), "{}", run.log());
            let history = run.history();
            let last = |step: &str| {
                let row = history.steps.iter().rposition(|name| name == step).unwrap();
                history.column("floor.fx")[row]
            };
            let tolerance = if method == "penalty" { 2e-2 } else { 1e-6 };
            let what = format!("{held}, {method}, {discretization}");
            assert_close(&format!("pushed: {what}"), last("push"), -12.0, tolerance);
            assert_close(&format!("at rest: {what}"), last("rest"), last("push"), 1e-7);
            // What sticks is sheared as the block gets lower.
            assert_close(&format!("pressed harder: {what}"), last("harder"), -12.0, tolerance.max(5e-3));
            // Half of the force can be borne.
            assert_close(&format!("pressed less: {what}"), last("less"), -6.0, tolerance);
        }
    }
}
