//! Conditions that stay, loads and motions by tables, weights, spins.

mod common;

use common::{Bench, History, assert_close, assert_small, nagata};

/// Linear between points.
fn factor(table: &[[f64; 2]], time: f64) -> f64 {
    let k = table.iter().position(|point| time <= point[0] + 1e-12).unwrap().max(1);
    let ([from, low], [to, high]) = (table[k - 1], table[k]);
    low + (high - low) * (time - from) / (to - from)
}

/// ```text
///    ( O )  pressed, then driven by a force, then drawn along
///   |_____| fixed below           |=====| pulled, pressed from above, with a body force
/// ```
#[test]
fn what_is_kept_is_as_if_written_again() {
    let scene = |load: &str, drag: &str| {
        format!(
            r#"
            body.pad.block = {{ box = {{ origin = [-4, -4, 0], size = [8, 8, 4] }}, elements = [4, 4, 2] }}
            body.pad.material = "soft"
            body.bar.block = {{ box = {{ origin = [20, 0, 0], size = [4, 1, 1] }}, elements = [4, 1, 1] }}
            body.bar.material = "soft"
            material.soft = {{ model = "neo-hookean", young = 10, poisson = 0.3, density = 0.01 }}
            tool.ball.sphere = {{ center = [0, 0, 14], radius = 10 }}
            contact.top = {{ slave = "pad.zmax", master = "ball", friction = 0.3 }}
            output.history = ["pad.zmin", "bar.xmin", "bar.xmax"]
            [[step]]
            increments = 4
            fix = [{{ set = "pad.zmin" }}, {{ set = "bar.xmin" }}]
            move = [
              {{ target = "ball", by = [0, 0, -0.3] }},
              {{ target = "bar.xmax", by = [0.4, 0, 0.1], directions = "xz", table = [[0, 0], [0.5, 1], [1, 0.5]] }},
            ]
            pressure = [{{ set = "bar.zmax", value = 0.4, table = [[0, 0], [0.25, 1], [1, 0.5]] }}]
            body_force = [{{ body = "bar", per_volume = [0, 0.05, 0] }}]
            gravity = [0, 0, -2]
            [[step]]
            increments = 3
            {load}
            force = [{{ target = "ball", total = [0, 0, -8], directions = "z" }}]
            [[step]]
            increments = 3
            {drag}
            move = [{{ target = "ball", by = [0.5, 0, 0] }}]
            "#
        )
    };
    let fix = r#"fix = [{ set = "pad.zmin" }, { set = "bar.xmin" }, { set = "bar.xmax", directions = "xz" }]"#;
    let pressure = r#"pressure = [{ set = "bar.zmax", value = 0.2 }]"#;
    let pull = r#"body_force = [{ body = "bar", per_volume = [0, 0.05, 0] }]"#;
    let again = scene(
        &format!("{fix}\n{pressure}\n{pull}\ngravity = [0, 0, -2]"),
        &format!(
            "{fix}\n{pressure}\nforce = [{{ target = \"ball\", total = [0, 0, -8], directions = \"z\" }}]\ngravity = [0, 0, -1]"
        ),
    );
    let again = Bench::new(&again).solve(1, &[]).history();
    let kept = Bench::new(&scene("keep = true", "keep = true\nrelease = [\"bar\"]\ngravity = [0, 0, -1]"));
    let one = kept.solve(1, &[]).history();
    assert_small("kept and written again", one.difference(&again), 1e-14);
    assert_small("two ranks", kept.solve(2, &[]).history().difference(&one), 1e-9);
    let end = one.len() - 1;
    assert_close("a set that was moved stays", one.column("bar.xmax.ux")[end], 0.2, 1e-14);
    assert_close("the force on the tool stays", one.column("ball.fz")[end], -8.0, 1e-9);
    let pulled = |row: usize| one.column("bar.xmin.fy")[row];
    assert!(pulled(6) < -0.05 && pulled(end).abs() < 1e-9, "released: {} {}", pulled(6), pulled(end));
}

const RISE: [[f64; 2]; 3] = [[0.0, 0.0], [0.5, 1.0], [2.0, 0.2]];
const SWAY: [[f64; 2]; 3] = [[0.0, 0.0], [1.5, -1.0], [2.0, 0.5]];
const LATER: [[f64; 2]; 3] = [[0.0, 0.2], [0.3, 0.7], [1.0, 0.0]];
const TAKEN: [[f64; 2]; 3] = [[0.0, 0.0], [0.3, 0.5], [1.0, 1.0]];

/// Cubes side by side, fixed below: one pushed, one pressed on, one with a body force, one whose top is moved, one under a
/// plane that a force drives from the beginning, one under a plane that a force takes over.
#[test]
fn loads_and_motions_follow_their_tables() {
    let mut scene = String::from("material.m = { model = \"hooke\", young = 1000, poisson = 0.3 }\n");
    for (k, name) in ["a", "b", "c", "d", "e", "g"].iter().enumerate() {
        scene += &format!(
            "body.{name} = {{ material = \"m\", block = {{ box = {{ origin = [{}, 0, 0], size = [1, 1, 1] }}, elements = [2, 2, 2] }} }}\n",
            3 * k
        );
    }
    for (slave, tool) in [("e", "press"), ("g", "late")] {
        scene += &format!(
            "tool.{tool}.plane = {{ point = [0, 0, 1], normal = [0, 0, -1] }}\n\
             contact.{tool} = {{ slave = \"{slave}.zmax\", master = \"{tool}\" }}\n"
        );
    }
    let held = |bodies: &[&str]| {
        let all: Vec<String> =
            bodies.iter().map(|body| format!("{{ set = \"{body}\", directions = \"xy\" }}")).collect();
        let below = ["a", "b", "c", "d", "e", "g"].map(|body| format!("{{ set = \"{body}.zmin\" }}"));
        format!("fix = [{}, {}]", below.join(", "), all.join(", "))
    };
    scene += &format!(
        r#"
        output.history = ["a.zmin", "b.zmin", "c.zmin", "d.zmax", "e.zmin", "g.zmin"]
        [[step]]
        duration = 2
        increments = 3
        {held}
        force = [
          {{ target = "a.zmax", total = [0, 0, -6], table = {RISE:?} }},
          {{ target = "press", total = [0, 0, -5], directions = "z", table = {RISE:?} }},
        ]
        pressure = [{{ set = "b.zmax", value = 4, table = {RISE:?} }}]
        body_force = [{{ body = "c", per_volume = [0, 0, -7], table = {SWAY:?} }}]
        move = [
          {{ target = "d.zmax", by = [0, 0, 0.01], table = {SWAY:?} }},
          {{ target = "late", by = [0, 0, -0.002] }},
        ]
        [[step]]
        increments = 2
        {held}
        force = [
          {{ target = "a.zmax", total = [0, 0, -6], table = {LATER:?} }},
          {{ target = "press", total = [0, 0, -3], directions = "z" }},
          {{ target = "late", total = [0, 0, -9], directions = "z", table = {TAKEN:?} }},
        ]
        pressure = [{{ set = "b.zmax", value = 2 }}]
        "#,
        held = held(&["a", "b", "c", "d", "e", "g"])
    );
    let bench = Bench::new(&scene);
    let history = bench.solve(2, &[]).history();
    assert_small("one rank", bench.solve(1, &[]).history().difference(&history), 1e-9);
    let expected = [0.5, 2.0 / 3.0, 4.0 / 3.0, 1.5, 2.0, 2.3, 2.5, 3.0];
    let times = history.column("time");
    assert_eq!(times.len(), expected.len(), "{times:?}");
    let taken_over = history.column("g.zmin.fz")[4];
    assert!(taken_over > 1.0, "{taken_over}");
    for (row, time) in expected.into_iter().enumerate() {
        assert_small("increments end where tables turn", times[row] - time, 1e-12);
        let check = |column: &str, value: f64| follows(&history, row, column, value);
        if time <= 2.0 {
            check("a.zmin.fz", 6.0 * factor(&RISE, time));
            check("b.zmin.fz", 4.0 * factor(&RISE, time));
            check("c.zmin.fz", 7.0 * factor(&SWAY, time));
            check("d.zmax.uz", 0.01 * factor(&SWAY, time));
            check("e.zmin.fz", 5.0 * factor(&RISE, time));
            check("late.uz", -0.001 * time);
        } else {
            let s = time - 2.0;
            check("a.zmin.fz", 6.0 * factor(&LATER, s));
            check("b.zmin.fz", 0.8 + (2.0 - 0.8) * s);
            check("c.zmin.fz", 3.5 * (1.0 - s));
            check("e.zmin.fz", 1.0 + 2.0 * s);
            check("g.zmin.fz", taken_over * (1.0 - s) + 9.0 * factor(&TAKEN, s));
        }
    }
}

fn follows(history: &History, row: usize, column: &str, value: f64) {
    assert_small(column, history.column(column)[row] - value, 1e-8 * value.abs().max(1.0));
}

/// Supports bear the weights of bodies of unlike densities, of hexahedra and in plane strain; one body has none.
#[test]
fn supports_bear_the_weight() {
    let scene = r#"
        body.tower = { material = "heavy", block = { box = { size = [1, 2, 3] }, elements = [1, 2, 3] } }
        body.sheet = { material = "light", plane_strain = true, block = { box = { origin = [5, 0, 0], size = [2, 1, 0.5] }, elements = [4, 2, 1] } }
        body.air = { material = "none", block = { box = { origin = [9, 0, 0], size = [1, 1, 1] }, elements = [1, 1, 1] } }
        material.heavy = { model = "hooke", young = 1000, poisson = 0.3, density = 0.8 }
        material.light = { model = "neo-hookean", young = 1000, poisson = 0.3, density = 0.1 }
        material.none = { model = "neo-hookean", young = 1000, poisson = 0.3, density = 0 }
        step = [{ increments = 2, gravity = [0.5, -10, 2], fix = [{ set = "tower.zmin" }, { set = "sheet.ymin" }, { set = "air.zmin" }] }]
        output.history = ["tower.zmin", "sheet.ymin", "air.zmin"]
        "#;
    let history = Bench::new(scene).solve(2, &[]).history();
    for (set, mass, directions) in [("tower.zmin", 4.8, 3), ("sheet.ymin", 0.1, 2), ("air.zmin", 0.0, 3)] {
        for (name, gravity) in ["fx", "fy", "fz"].iter().zip([0.5, -10.0, 2.0]).take(directions) {
            let column = format!("{set}.{name}");
            assert_small(&column, history.column(&column)[0] + 0.5 * mass * gravity, 1e-9);
            assert_small(&column, history.last(&column) + mass * gravity, 1e-9);
        }
    }
}

/// A column of two densities, in two bodies one above the other, under its weight, which rises and falls, is kept, and rises and
/// falls again.
/// A load that begins later in its step: nothing acts until then, which is no rounding of what will.
#[test]
fn a_load_may_begin_late() {
    for (load, last) in [
        ("force = [{ target = \"b.zmax\", total = [0, 0, -100.0], table = TABLE }]", 1.7),
        ("body_force = [{ body = \"b\", per_volume = [0, 0, -9.81], table = TABLE }]", 1.7),
        (
            "force = [{ target = \"b.zmax\", total = [0, 0, -100.0], table = TABLE }]\nbody_force = [{ body = \"b\", per_volume = [0, 0, -70.0] }]",
            0.3,
        ),
    ] {
        let load = load.replace("TABLE", &format!("[[0, 0], [0.29, 0], [1, {last:?}]]"));
        let bench = Bench::new(&format!(
            "body.b = {{ block = {{ box = {{ size = [1, 1, 1] }}, elements = [2, 2, 2] }}, material = \"m\" }}\n\
             material.m = {{ model = \"hooke\", young = 210000.0, poisson = 0.3 }}\n\
             [[step]]\nincrements = 10\nfix = [{{ set = \"b.zmin\" }}]\n{load}\n[output]\nhistory = [\"b.zmin\"]\n"
        ));
        let history = bench.solve(1, &[]).history();
        let (times, reactions) = (history.column("time"), history.column("b.zmin.fz"));
        let (even, by_table) = if load.contains("-70.0") {
            (70.0, 100.0)
        } else {
            (0.0, if load.contains("9.81") { 9.81 } else { 100.0 })
        };
        for (time, reaction) in times.iter().zip(reactions) {
            let exact = even * time + by_table * factor(&[[0.0, 0.0], [0.29, 0.0], [1.0, last]], *time);
            assert_small(&format!("{load} at {time}"), reaction - exact, 1e-7 * by_table);
            assert!(exact > 0.0 || *reaction == 0.0, "{load} at {time}: {reaction}");
        }
    }
}

#[test]
fn weights_follow_their_table() {
    let scene = format!(
        r#"
        body.foot = {{ material = "light", block = {{ box = {{ size = [1, 2, 1] }}, elements = [1, 2, 2] }} }}
        body.head = {{ material = "heavy", block = {{ box = {{ origin = [0, 0, 1], size = [1, 2, 2] }}, elements = [1, 2, 2] }} }}
        material.light = {{ model = "neo-hookean", young = 1000, poisson = 0.3, density = 0.1 }}
        material.heavy = {{ model = "hooke", young = 1000, poisson = 0.3, density = 0.8 }}
        tie.joint = {{ slave = "head.zmin", master = "foot.zmax" }}
        output.history = ["foot.zmin"]
        solver.tolerance = 1e-13
        [[step]]
        duration = 2
        increments = 3
        fix = [{{ set = "foot.zmin" }}]
        gravity = {{ acceleration = [0.5, 0, -10], table = {RISE:?} }}
        [[step]]
        increments = 2
        keep = true
        [[step]]
        increments = 2
        keep = true
        gravity = {{ acceleration = [0.5, 0, -10], table = {LATER:?} }}
        "#
    );
    let bench = Bench::new(&scene);
    let mass = 0.1 * 2.0 + 0.8 * 4.0;
    for ranks in [1, 2] {
        let history = bench.solve(ranks, &[]).history();
        let times = history.column("time");
        assert!(times.len() == 4 + 2 + 3 && times.contains(&0.5) && times.contains(&3.3), "{times:?}");
        for (row, time) in times.iter().enumerate() {
            let share = match time {
                ..=2.0 => factor(&RISE, *time),
                ..=3.0 => 0.2,
                _ => factor(&LATER, time - 3.0),
            };
            for (name, gravity) in [("fx", 0.5), ("fy", 0.0), ("fz", -10.0)] {
                let column = format!("foot.zmin.{name}");
                let off = history.column(&column)[row] + mass * gravity * share;
                assert_small(&column, off, 1e-10 * mass * 10.0);
            }
        }
    }
}

#[test]
fn wrong_gravity_is_refused() {
    let told = |gravity: &str| {
        let scene = format!(
            "body.b = {{ material = \"m\", block = {{ box = {{ size = [1, 1, 1] }}, elements = [1, 1, 1] }} }}\n\
             material.m = {{ model = \"hooke\", young = 1, poisson = 0.3, density = 1 }}\n\
             [[step]]\nincrements = 1\nfix = [{{ set = \"b.zmin\" }}]\ngravity = {gravity}\n"
        );
        let bench = Bench::new(&scene);
        let check = nagata(&bench.path(""), 1, &["check", "scene.toml"], bench.path("out"));
        assert_eq!((check.code, check.stderr.matches("error:").count()), (2, 1), "{gravity}\n{}", check.stderr);
        assert!(check.stderr.contains("scene.toml:6:"), "{}", check.stderr);
        check.stderr
    };
    for (gravity, words) in [
        ("\"down\"", "step.0.gravity must be a list of 3 numbers, not a string"),
        ("[0, -1]", "step.0.gravity must be a list of 3 numbers, not of 2"),
        ("{ table = [[0, 0], [1, 1]] }", "step.0.gravity has no `acceleration`"),
        ("{ acceleration = 9.81 }", "step.0.gravity.acceleration must be a list of 3 numbers, not a number"),
        ("{ acceleration = [0, 0, -1], tabel = [[0, 0], [1, 1]] }", "unknown key `tabel` in step.0.gravity"),
        ("{ acceleration = [0, 0, -1], table = \"wave\" }", "step.0.gravity.table must be a list, not a string"),
        ("{ acceleration = [0, 0, -1], table = [[0, 0], [2, 1]] }", "must have the time 1.0, as the last point"),
        (
            "{ acceleration = [0, 0, -1], table = [[0, 1], [1, 0]] }",
            "step `step 1` pulls by gravity with [0.0, 0.0, -1.0] at the beginning of its table, but before it that was [0.0",
        ),
    ] {
        assert!(told(gravity).contains(words), "{}", told(gravity));
    }
}

/// A thick ring that turns, axisymmetric between planes, and a part of it of hexahedra: u = A r + B/r - ρω²r³/(8M), from
/// M (u'' + u'/r - u/r²) + ρω²r = 0 with M u' + λ u/r = 0 at both radii. A step later it is at rest.
#[test]
fn a_ring_that_spins_widens() {
    let (young, poisson, density, speed) = (1000.0, 0.3, 2.0, 0.02f64);
    let scene = |body: &str, axis: &str| {
        format!(
            r#"
            material.m = {{ model = "hooke", young = {young}, poisson = {poisson}, density = {density} }}
            [body.ring]
            material = "m"
            {body}
            [output]
            history = ["ring.inner", "ring.outer"]
            [[step]]
            increments = 2
            fix = [{{ set = "ring.low" }}, {{ set = "ring.high" }}]
            spin = [{{ body = "ring", speed = {speed}, {axis}, table = [[0, 0], [0.5, 2], [1, 1]] }}]
            [[step]]
            increments = 1
            fix = [{{ set = "ring.low" }}, {{ set = "ring.high" }}]
            "#
        )
        .replace("\"ring.low\" }", "\"ring.low\", directions = \"DIR\" }")
        .replace("\"ring.high\" }", "\"ring.high\", directions = \"DIR\" }")
    };
    let rows = |scene: &str, ranks: usize| Bench::new(scene).solve(ranks, &[]).history();
    let box_of = r#"axisymmetric = true
        block = { box = { origin = [1, 0, 0], size = [1, 0.1, 0.1] }, elements = [16, 1, 1], faces = { inner = "xmin", outer = "xmax", low = "ymin", high = "ymax" } }"#;
    let sector = r#"symmetry = ["amin", "amax"]
        block = { sector = { center = [3, 4, 0], radii = [1, 2], angles = [-3, 3], length = 0.1 }, elements = [16, 1, 1], faces = { inner = "rmin", outer = "rmax", low = "zmin", high = "zmax" } }"#;
    let ring = rows(&scene(box_of, "point = [0, 3, 0], axis = [0, 1, 0]").replace("DIR", "y"), 1);
    let part = rows(&scene(sector, "point = [3, 4, 0], axis = [0, 0, -2]").replace("DIR", "z"), 2);

    let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let (modulus, load) = (lame * (1.0 - poisson) / poisson, density * speed * speed);
    let square = load / (8.0 * modulus);
    // (M + λ) A - (M - λ) B/r² = (3 M + λ) square r² at both radii.
    let (sum, difference, right) = (modulus + lame, modulus - lame, (3.0 * modulus + lame) * square);
    let b = right * (4.0 - 1.0) / (difference * (1.0 - 0.25));
    let a = (right + difference * b) / sum;
    let exact = |r: f64| a * r + b / r - square * r.powi(3);
    // The nodes of the part stand at ±3 degrees.
    let slanted = 3f64.to_radians().cos();
    for (set, r) in [("inner", 1.0), ("outer", 2.0)] {
        for (name, history, share) in [("ring", &ring, 1.0), ("part", &part, slanted)] {
            let widened = history.column(&format!("ring.{set}.ux"));
            assert_close(name, widened[1], share * exact(r), 2e-3);
            assert_close("twice the load", widened[0], 2.0 * widened[1], 1e-4);
            assert_small("at rest", widened[2], 1e-12);
        }
    }
}

/// A stiff block on springs that spins is pulled out by M ω² (r + u), where it is then: u = M ω² r / (k - M ω²). Along an
/// oblique axis, too.
#[test]
fn what_spins_is_pulled_by_where_it_is() {
    let scene = |axis: &str, point: &str| {
        format!(
            r#"
            material.m = {{ model = "hooke", young = 1e7, poisson = 0.3, density = 0.5 }}
            body.b = {{ material = "m", block = {{ box = {{ origin = [4, -0.5, -0.5], size = [2, 1, 1] }}, elements = [2, 2, 2] }} }}
            output.history = ["b"]
            [[step]]
            increments = 2
            spring = [{{ set = "b", stiffness = [100, 0, 0] }}]
            fix = [{{ set = "b", directions = "yz" }}]
            spin = [{{ body = "b", point = {point}, axis = {axis}, speed = 3 }}]
            [[step]]
            increments = 1
            keep = true
            "#
        )
    };
    // Across (0.6, 0, 0.8) is 0.64 of x, and 0 of y and z in the middle of the block.
    for (axis, point, share) in [("[0, 0, 1]", "[0, 0, 7]", 1.0), ("[3, 0, 4]", "[0, 0, 0]", 0.64)] {
        let run = Bench::new(&scene(axis, point)).solve(1, &[]);
        let history = run.history();
        for (row, square) in [(0, 4.5), (1, 9.0), (2, 9.0)] {
            let pull = 0.5 * 2.0 * square * share;
            assert_close("way", history.column("b.ux")[row], pull * 5.0 / (100.0 - pull), 1e-4);
        }
        let iterations = history.column("iterations");
        assert!(iterations[1] <= 4.0, "{iterations:?}");
    }
}

/// ```text
///      v v v F       The springs give way by F / k below, whatever the block does, and bear F; a tool that pushes aside meets
///     |_____|        springs of k along x.
///      z z z
/// ```
#[test]
fn springs_bear_by_their_stiffness() {
    let scene = r#"
        body.block = { material = "m", block = { box = { size = [2, 2, 1] }, elements = [2, 2, 2] } }
        body.sheet = { material = "m", plane_strain = true, block = { box = { origin = [5, 0, 0], size = [2, 1, 0.5] }, elements = [4, 2, 1] } }
        material.m = { model = "neo-hookean", young = 100, poisson = 0 }
        tool.side.plane = { point = [-0.05, 0, 0], normal = [1, 0, 0] }
        contact.side = { slave = "block.xmin", master = "side" }
        output.history = ["block.zmin", "block.xmax", "sheet.ymin", "sheet.ymax"]
        [[step]]
        increments = 2
        spring = [
          { set = "block.zmin", stiffness = [0, 0, 40] },
          { set = "block.xmax", stiffness = [30, 0, 0] },
          { set = "sheet.ymin", stiffness = [10, 20, 0] },
        ]
        fix = [{ set = "block.ymin", directions = "y" }, { set = "sheet.ymax", directions = "x" }]
        force = [{ target = "block.zmax", total = [0, 0, -8] }, { target = "sheet.ymax", total = [0, -2, 0] }]
        [[step]]
        increments = 2
        keep = true
        move = [{ target = "side", by = [0.15, 0, 0] }]
        "#;
    let bench = Bench::new(scene);
    let history = bench.solve(2, &[]).history();
    assert_small("one rank", bench.solve(1, &[]).history().difference(&history), 1e-9);
    let read = |row: usize, column: &str| history.column(column)[row];
    for (row, share) in [(0, 0.5), (1, 1.0), (3, 1.0)] {
        assert_small("bears", read(row, "block.zmin.fz") - 8.0 * share, 1e-9);
        assert_small("gives way", read(row, "sheet.ymin.uy") + 0.1 * share, 1e-9);
        assert_small("bears in plane strain", read(row, "sheet.ymin.fy") - 2.0 * share, 1e-9);
    }
    assert_small("gives way", read(1, "block.zmin.uz") + 0.2, 1e-9);
    // The plane, the block, and the springs are in series.
    assert!(read(3, "side.fx") > 0.5);
    assert_small("pushed aside", read(3, "side.fx") + read(3, "block.xmax.fx"), 1e-9);
    assert_small("springs", read(3, "block.xmax.fx") + 30.0 * read(3, "block.xmax.ux"), 1e-9);
}

/// A block that nothing strains, on springs and dashpots, under a force that rises, stays and goes: backward Euler's recursion
/// (k + c/Δt) u = F + c/Δt u_before, by increments of many lengths, in a run that goes on as well.
#[test]
fn dashpots_relax_by_backward_euler() {
    let scene = |steps: &[&str]| {
        let first = r#"
        body.block = { material = "m", block = { box = { size = [2, 1, 1] }, elements = [2, 1, 1] } }
        material.m = { model = "neo-hookean", young = 100, poisson = 0.3 }
        output = { history = ["block"], checkpoint = { increments = 1 } }
        [[step]]
        duration = 2
        increments = 2
        fix = [{ set = "block", directions = "y" }, { set = "block", normal = [1, 0, 1] }]
        spring = [{ set = "block", stiffness = [30, 0, 10] }]
        dashpot = [{ set = "block", damping = [8, 0, 4] }]
        force = [{ target = "block", total = [6, 0, -6] }]
        "#;
        Bench::new(&format!("{first}{}", steps.concat()))
    };
    let stay = "[[step]]\nduration = 3\nincrement = { initial = 0.1, max = 1 }\nkeep = true\n";
    let ease = "[[step]]\nduration = 0.5\nincrements = 3\nkeep = true\nrelease = [\"block\"]\nfix = [{ set = \"block\", directions = \"y\" }, \
                { set = \"block\", normal = [1, 0, 1] }]\nspring = [{ set = \"block\", stiffness = [30, 0, 10] }]\n\
                dashpot = [{ set = \"block\", damping = [8, 0, 4] }]\n";
    let run = scene(&[stay, ease]).solve(2, &[]);
    let history = run.history();
    // Along (1, 0, -1)/√2: half of each stiffness and of each damping, and a force of 6√2.
    let (mut before, mut last, mut lengths) = (0.0, 0.0, Vec::new());
    for (row, &time) in history.column("time").iter().enumerate() {
        let size = time - before;
        let force = 72f64.sqrt()
            * if time < 2.0 {
                time / 2.0
            } else if time > 5.0 {
                (5.5 - time) / 0.5
            } else {
                1.0
            };
        last = (force + 6.0 / size * last) / (20.0 + 6.0 / size);
        assert_small("recursion", history.column("block.ux")[row] - last / 2f64.sqrt(), 1e-10);
        assert_small("no strain", history.column("block.uz")[row] + last / 2f64.sqrt(), 1e-10);
        before = time;
        lengths.push(size);
    }
    assert!(lengths.len() > 8 && lengths.iter().any(|size| *size < 0.2) && lengths.contains(&1.0), "{lengths:?}");
    let timeless =
        Bench::new(&std::fs::read_to_string(scene(&[]).path("scene.toml")).unwrap().replace("duration = 2", ""));
    let refused = timeless.run(1, &[]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("has dashpots, and no `duration`"), "{}", refused.stderr);
    let shorter = scene(&[stay]);
    let first = shorter.solve(1, &[]);
    let out = first.out.to_str().unwrap();
    shorter.write("scene.toml", &std::fs::read_to_string(scene(&[stay, ease]).path("scene.toml")).unwrap());
    let gone_on =
        common::nagata(&shorter.path(""), 2, &["run", "scene.toml", "--restart", "--out", out], first.out.clone());
    assert_eq!(gone_on.code, 0, "{}", gone_on.stderr);
    assert_small("gone on", gone_on.history().difference(&history), 1e-9);
}

/// A block that spins about an axis above it is pressed on the plane below it by that alone, M ω² r if it were rigid.
#[test]
fn what_spins_is_pressed_by_that() {
    let run = Bench::new(
        r#"
body.b = { material = "m", block = { box = { size = [4.0, 3.0, 5.0] }, elements = [3, 2, 3] } }
material.m = { model = "neo-hookean", young = 1e5, poisson = 0.0, density = 0.02 }
tool.p.plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
contact.c = { slave = "b.zmin", master = "p" }
[[step]]
increments = 1
fix = [{ set = "b.xmin", directions = "x" }, { set = "b.ymin", directions = "y" }]
spin = [{ body = "b", point = [0, 0, 10], axis = [1, 0, 0], speed = 1.0 }]
"#,
    )
    .solve(1, &[]);
    // 1.2 at 7.5 from the axis.
    assert_close("force", run.history().last("p.fz"), 9.0, 1e-4);
}

/// Two bodies of one mesh that share nodes: who is supported there has all of the reaction, and both their parts where both are.
#[test]
fn the_body_that_is_supported_has_the_reaction() {
    let mesh = "*NODE\n1,0,0,0\n2,1,0,0\n3,2,0,0\n4,0,1,0\n5,1,1,0\n6,2,1,0\n7,0,0,1\n8,1,0,1\n9,2,0,1\n10,0,1,1\n11,1,1,1\n12,2,1,1\n\
                *ELEMENT, TYPE=C3D8, ELSET=left\n1,1,2,5,4,7,8,11,10\n*ELEMENT, TYPE=C3D8, ELSET=right\n2,2,3,6,5,8,9,12,11\n\
                *SURFACE, NAME=lfoot\n1, S1\n*SURFACE, NAME=ltop\n1, S2\n*SURFACE, NAME=rfoot\n2, S1\n";
    let scene = |conditions: &str| {
        let bench = Bench::new(&format!(
            "body.l = {{ mesh = \"m.inp\", group = \"left\", material = \"m\" }}\nbody.r = {{ mesh = \"m.inp\", group = \"right\", material = \"m\" }}\n\
             material.m = {{ model = \"hooke\", young = 1e5, poisson = 0.0 }}\n[[step]]\nincrements = 1\n\
             force = [{{ target = \"l.ltop\", total = [0.0, 0.0, -100.0] }}]\n{conditions}\n\
             [output]\nhistory = [\"l.lfoot\", \"r.rfoot\"]\n"
        ));
        bench.write("m.inp", mesh);
        let history = bench.solve(1, &[]).history();
        [history.last("l.lfoot.fz"), history.last("r.rfoot.fz")]
    };
    let [left, right] = scene("fix = [{ set = \"l.lfoot\" }]");
    assert_close("one is fixed", left, 100.0, 1e-9);
    assert_small("the other", right, 1e-9);
    let [left, right] = scene(
        "fix = [{ set = \"l.ltop\", directions = \"xy\" }]\nspring = [{ set = \"l.lfoot\", stiffness = [0.0, 0.0, 1e3] }]",
    );
    assert_close("one is on springs", left, 100.0, 1e-9);
    assert_small("the other", right, 1e-9);
    let [left, right] = scene("fix = [{ set = \"l.lfoot\" }, { set = \"r.rfoot\" }]");
    assert_close("both are fixed", left + right, 100.0, 1e-9);
    assert!(right > 1.0 && left > right, "{left} {right}");
}
