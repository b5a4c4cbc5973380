//! Penalty, Lagrange, augmented Lagrangian and Uzawa: one solution, by different ways.

mod common;

use common::{Bench, History, Run, assert_close, assert_small, nagata};

const METHODS: [&str; 4] = ["penalty", "lagrange", "augmented-lagrangian", "uzawa"];

/// A small block is pressed into a wide soft one, whose faces are the coarser, and drawn over it askew.
fn block() -> Bench {
    Bench::new(
        r#"
        [body.table]
        block = { box = { size = [9.0, 8.0, 3.0] }, elements = [7, 6, 2] }
        material = "soft"
        [body.block]
        block = { box = { origin = [2.1, 2.2, 3.0], size = [3.0, 3.0, 2.0] }, elements = [4, 3, 2] }
        material = "hard"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 400.0
        poisson = 0.2
        [contact.pair]
        slave = "block.zmin"
        master = "table.zmax"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "table.zmin" }]
        move = [{ target = "block.zmax", by = [0.0, 0.0, -0.3] }]
        [[step]]
        name = "drag"
        increments = 4
        fix = [{ set = "table.zmin" }]
        move = [{ target = "block.zmax", by = [0.8, 0.35, 0.0] }]
        [output]
        every = 100
        history = ["block.zmax", "table.zmin"]
        "#,
    )
}

/// A ball is pressed into a slab, and drawn along it while it turns.
fn ball() -> Bench {
    Bench::new(
        r#"
        [body.slab]
        block = { box = { origin = [-3.0, -2.0, -3.0], size = [6.0, 4.0, 3.0] }, elements = [8, 5, 4] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.ball]
        sphere = { center = [-0.4, 0.13, 4.05], radius = 4.0 }
        [contact.pair]
        slave = "slab.zmax"
        master = "ball"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "slab.zmin" }]
        move = [{ target = "ball", by = [0.0, 0.0, -0.5] }]
        [[step]]
        name = "drag"
        increments = 4
        fix = [{ set = "slab.zmin" }]
        [[step.move]]
        target = "ball"
        by = [0.8, 0.2, 0.0]
        rotate = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 5.0 }
        [output]
        every = 100
        history = ["slab.zmin"]
        "#,
    )
}

fn solve(bench: &Bench, ranks: usize, method: &str, more: &[&str]) -> Run {
    let method = format!("contact.pair.method={method}");
    bench.solve(ranks, &[&["--set", &method], more].concat())
}

/// The force that goes in comes out.
fn check_balance(history: &History, one: &str, other: &str) {
    let scale = history.largest_force(one);
    let sum = |c: &str| {
        let [a, b] = [one, other].map(|name| history.column(&format!("{name}.{c}")));
        a.iter().zip(b).map(|(a, b)| (a + b).abs() / scale).fold(0.0, f64::max)
    };
    assert_small("balance", ["fx", "fy", "fz"].map(sum).into_iter().fold(0.0, f64::max), 1e-8);
}

/// Nodes that slip are on the cone, those that stick in it, and others have no force.
fn check_cone(run: &Run, friction: f64) {
    let last = run.written();
    let [force, normal] = ["force", "normal"].map(|name| run.vectors(last, "contact.pair", name));
    let status = run.scalars(last, "contact.pair", "status");
    let mut slips = 0;
    for ((f, n), status) in force.iter().zip(&normal).zip(status) {
        let pressed: f64 = f.iter().zip(n).map(|(f, n)| f * n).sum();
        let tangential = f.iter().zip(n).map(|(f, n)| (f - pressed * n).powi(2)).sum::<f64>().sqrt();
        match status as u8 {
            0 => assert_eq!(f, &[0.0; 3]),
            1 => assert!(pressed > 0.0 && tangential <= friction * pressed * (1.0 + 1e-8)),
            _ => {
                assert!(pressed > 0.0);
                assert_close("friction over pressure", tangential / pressed, friction, 1e-8);
                slips += 1;
            }
        }
    }
    assert!(slips > 5);
}

#[test]
fn all_methods_find_one_solution_between_bodies() {
    let bench = block();
    let runs = METHODS.map(|method| solve(&bench, 2, method, &[]));
    let [_, _, augmented, _] = runs.each_ref().map(Run::history);
    for (run, method) in runs.iter().zip(METHODS) {
        let (summary, history) = (run.summary(), run.history());
        let multipliers = if ["penalty", "uzawa"].contains(&method) { 0 } else { 60 };
        assert_eq!((&summary["multipliers"], &summary["dofs"]), (&multipliers.into(), &(456 + multipliers).into()));
        assert_eq!(summary["cutbacks"], 0, "{method}");
        assert_eq!(summary["outer_iterations"].as_u64() > Some(0), ["lagrange", "uzawa"].contains(&method));
        check_balance(&history, "block.zmax", "table.zmin");
        check_cone(run, 0.3);
        let tolerance = if method == "penalty" { 0.05 } else { 1e-8 };
        assert_small(method, without_iterations(&history, &augmented), tolerance);
    }
}

#[test]
fn all_methods_find_one_solution_under_a_tool() {
    let bench = ball();
    let runs = METHODS.map(|method| solve(&bench, 2, method, &[]));
    let [_, _, augmented, _] = runs.each_ref().map(Run::history);
    for (run, method) in runs.iter().zip(METHODS) {
        let history = run.history();
        check_balance(&history, "ball", "slab.zmin");
        check_cone(run, 0.3);
        let tolerance = if method == "penalty" { 0.05 } else { 1e-8 };
        assert_small(method, without_iterations(&history, &augmented), tolerance);
    }
}

/// The largest difference of forces, displacements and pressures over the largest of their kind.
fn without_iterations(one: &History, other: &History) -> f64 {
    assert_eq!(one.steps, other.steps);
    let names: Vec<&str> =
        ["block.zmax", "table.zmin", "ball", "slab.zmin"].into_iter().filter(|n| one.has(n)).collect();
    let rows = (0..one.len()).map(|k| one.row_difference(k, other, k, &names)).fold(0.0, f64::max);
    let [a, b] = [one, other].map(|h| h.column("pair.max_pressure"));
    let most = b.iter().fold(0.0f64, |m, p| m.max(*p));
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / most).fold(rows, f64::max)
}

/// The error of the penalty is inverse to it; the iterations do not feel it.
#[test]
fn the_error_of_a_penalty_is_inverse_to_it() {
    for bench in [block(), ball()] {
        let exact = bench.solve(1, &[]).history();
        let of = |exponent: i32| {
            let run = solve(&bench, 1, "penalty", &["--set", &format!("contact.pair.penalty=1e{exponent}")]);
            (without_iterations(&run.history(), &exact), run.summary()["iterations"].as_f64().unwrap())
        };
        let [a, b, c, d] = [4, 5, 6, 7].map(of);
        println!("errors and iterations: {a:?} {b:?} {c:?} {d:?}");
        // Least squares through four points a decade apart.
        let slope = 0.3 * (d.0 / a.0).log10() + 0.1 * (c.0 / b.0).log10();
        assert_close("slope", slope, -1.0, 0.02);
        assert!(d.1 < 1.2 * a.1);
    }
}

#[test]
fn the_number_of_ranks_does_not_matter() {
    for bench in [block(), ball()] {
        for method in METHODS {
            let alone = solve(&bench, 1, method, &[]).history();
            for ranks in [2, 3] {
                let difference = alone.difference(&solve(&bench, ranks, method, &[]).history());
                assert_small(&format!("{method} on {ranks} ranks"), difference, 1e-8);
            }
        }
    }
}

/// Without friction nothing depends on the way, and forces with a potential keep the matrix symmetric.
#[test]
fn frictionless_methods_keep_the_matrix_symmetric() {
    let frictionless =
        ["--set", "contact.pair.friction=0.0", "--set", "contact.pair.transfer=\"variational\"", "--steps"];
    let bench = block();
    let runs = METHODS.map(|method| solve(&bench, 1, method, &[frictionless.as_slice(), &["1"]].concat()));
    let augmented = runs[2].history();
    for (run, method) in runs.iter().zip(METHODS) {
        assert_eq!(run.summary()["matrix"], "symmetric indefinite", "{method}");
        let tolerance = if method == "penalty" { 0.01 } else { 1e-8 };
        assert_small(method, without_iterations(&run.history(), &augmented), tolerance);
    }
}

/// What a tool does to the force that drives it passes through the contact.
#[test]
fn a_tool_may_be_driven_by_force() {
    let steps = r#"
        [[step]]
        increments = 1
        fix = [{ set = "slab.zmin" }]
        move = [{ target = "ball", by = [0.0, 0.0, -0.3] }]
        [[step]]
        increments = 2
        fix = [{ set = "slab.zmin" }]
        force = [{ target = "ball", total = [0.0, 0.0, -80.0], directions = "z" }]
        move = [{ target = "ball", by = [0.3, 0.0, 0.0] }]
        [output]
        every = 100
        history = ["slab.zmin"]
    "#;
    let scene = std::fs::read_to_string(ball().path("scene.toml")).unwrap();
    let bench = Bench::new(&format!("{}{steps}", &scene[..scene.find("[[step]]").unwrap()]));
    let histories = METHODS.map(|method| solve(&bench, 2, method, &[]).history());
    for (history, method) in histories.iter().zip(METHODS) {
        assert_close(method, history.last("ball.fz"), -80.0, 1e-8);
        let tolerance = if method == "penalty" { 0.05 } else { 1e-8 };
        assert_small(method, without_iterations(history, &histories[2]), tolerance);
    }
}

/// A roll is pressed into a slab in plane strain and drawn to and fro. With this penalty, of twice the stiffness of the
/// nodes, slips flip from one side of the cone to the other at the reversal, and increments are cut, unless it is reduced.
#[test]
fn a_friction_penalty_that_makes_slips_flip_is_reduced() {
    let step = |name: &str, by: [f64; 2]| {
        let [x, y] = by;
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = 4\nfix = [{{ set = \"slab.ymin\" }}]\n\
             move = [{{ target = \"roll\", by = [{x:?}, {y:?}, 0.0] }}]\n"
        )
    };
    let bench = Bench::new(&format!(
        r#"
        output = {{ every = 100, history = ["slab.ymin"] }}
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
        [contact.pair]
        slave = "slab.ymax"
        master = "roll"
        friction = 0.3
        {}{}{}"#,
        step("press", [0.0, -0.6]),
        step("forth", [1.0, 0.0]),
        step("back", [-1.0, 0.0])
    ));
    let gentle = bench.solve(1, &[]);
    let run = bench.solve(1, &["--set", "contact.pair.penalty=100.0"]);
    assert_eq!(run.summary()["cutbacks"], 0);
    assert!(run.log().contains("friction penalty reduced at flipping nodes"));
    let (run, gentle) = (run.history(), gentle.history());
    let difference = (0..12).map(|k| run.row_difference(k, &gentle, k, &["roll", "slab.ymin"])).fold(0.0, f64::max);
    assert_small("the penalty does not matter", difference, 1e-8);
}

/// With a tolerance Uzawa's method ends its rounds as soon as what is left is below that: the looser, the sooner.
#[test]
fn a_tolerance_ends_uzawas_rounds() {
    let bench = ball();
    let exact = bench.solve(1, &[]).history();
    let of = |tolerance: f64| {
        let set = ["contact.pair.penalty=300.0".to_string(), format!("contact.pair.tolerance={tolerance:e}")];
        let run = solve(&bench, 2, "uzawa", &["--set", &set[0], "--set", &set[1]]);
        let (history, summary) = (run.history(), run.summary());
        let penetration = history.column("pair.max_penetration").iter().copied().fold(0.0, f64::max);
        assert!(penetration <= tolerance && penetration > 1e-4 * tolerance, "{penetration:e} with {tolerance:e}");
        (summary["outer_iterations"].as_u64().unwrap(), without_iterations(&history, &exact))
    };
    let [loose, tight] = [1e-3, 1e-6].map(of);
    println!("rounds and errors: {loose:?} {tight:?}");
    assert!(2 * loose.0 < tight.0);
    assert!(loose.1 < 1e-2 && tight.1 < 1e-5);
}

/// A penalty far below the stiffness takes Uzawa's method too many rounds.
#[test]
fn rounds_that_do_not_settle_name_the_worst_node() {
    let few =
        ["contact.pair.penalty=10.0", "contact.pair.method=uzawa", "step.press.increment={ initial = 0.5, min = 0.5 }"];
    let scene = std::fs::read_to_string(block().path("scene.toml")).unwrap();
    let bench = Bench::new(&scene.replacen("        increments = 2\n", "", 1));
    let run = bench.run(2, &["--set", few[0], "--set", few[1], "--set", few[2]]);
    assert_eq!(run.code, 1);
    let told = &run.stderr;
    assert!(told.contains("60 rounds of contact forces do not settle: node "), "{told}");
    assert!(
        told.contains("of body `block` at (") && told.contains("contact `pair`, sticking, penetration or slip "),
        "{told}"
    );
    assert!(told.contains("raise the contact's `penalty`"), "{told}");
}

#[test]
fn check_says_what_each_method_has() {
    let bench = block();
    let expected = ["penalty, friction 0.3, no multipliers", "Lagrange, friction 0.3, at most 3 multipliers a node"]
        .into_iter()
        .chain(["augmented Lagrangian, friction 0.3, at most 3", "Uzawa, friction 0.3, no multipliers"]);
    for (method, expected) in METHODS.into_iter().zip(expected) {
        let method = format!("contact.pair.method={method}");
        let scene = bench.path("scene.toml");
        let run = nagata(&bench.path(""), 1, &["check", scene.to_str().unwrap(), "--set", &method], bench.path("none"));
        let text = format!("contact `pair`: 20 slave nodes, {expected}");
        assert!(run.code == 0 && run.stdout.contains(&text), "{}{}", run.stdout, run.stderr);
        let none = expected.contains("no multipliers");
        assert_eq!(run.stdout.contains("dofs, 0 multipliers among them"), none, "{}", run.stdout);
    }
}
