//! Forces of tools, supports and loads add up to nothing in every increment.

mod common;

use common::{Bench, Run, assert_close, assert_small};

/// ```text
///        (O) -> x, y         A ball is pressed into a block and slides askew over it, while the block is pushed at a side and
///     ___\_/____             by its weight; the bottom is held. Ball + bottom + side + weight = 0 along x, y and z.
///    |          |<- side
///    |__________| held
/// ```
#[test]
fn tool_support_and_loads() {
    let (push, weight) = ([0.3, -0.2, 0.1], [0.02, 0.01, -0.05]);
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        block = {{ box = {{ size = [3.0, 3.0, 1.0] }}, elements = [8, 8, 2] }}
        material = "soft"
        element = "hex8-fbar"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.4
        [tool.ball]
        sphere = {{ center = [1.2, 1.3, 3.0], radius = 2.0 }}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        friction = 0.25
        [[step]]
        name = "press"
        increments = 3
        fix = [{{ set = "block.zmin" }}]
        move = [{{ target = "ball", by = [0.0, 0.0, -0.2] }}]
        force = [{{ target = "block.xmax", total = {push:?} }}]
        body_force = [{{ body = "block", per_volume = {weight:?} }}]
        [[step]]
        name = "slide"
        increments = 6
        fix = [{{ set = "block.zmin" }}]
        move = [{{ target = "ball", by = [0.5, 0.3, -0.02] }}]
        force = [{{ target = "block.xmax", total = {push:?} }}]
        body_force = [{{ body = "block", per_volume = {weight:?} }}]
        [output]
        every = 100
        history = ["block.zmin", "block"]
        "#
    ));
    let history = bench.solve(2, &[]).history();
    let largest =
        ["fx", "fy", "fz"].map(|c| history.column(&format!("ball.{c}")).iter().fold(0.0f64, |m, f| m.max(f.abs())));
    println!("ball {largest:?}, {:?} stick, {:?} slip", history.column("top.stick"), history.column("top.slip"));
    let scale = largest[2];
    assert!(largest[0] > 0.1 * scale && largest[1] > 0.05 * scale);
    assert!(
        history.column("top.slip").iter().any(|&n| n > 3.0) && history.column("top.stick").iter().any(|&n| n > 3.0)
    );
    let mut worst = 0.0f64;
    for k in 0..history.len() {
        let ramp = if history.steps[k] == "press" { history.column("time")[k] } else { 1.0 };
        for (d, c) in ["fx", "fy", "fz"].iter().enumerate() {
            let reactions = history.column(&format!("ball.{c}"))[k] + history.column(&format!("block.zmin.{c}"))[k];
            let loads = ramp * (push[d] + weight[d] * 9.0);
            worst = worst.max((reactions + loads).abs() / scale);
            // The nodes that are not held are in equilibrium.
            let all = history.column(&format!("block.{c}"))[k] - history.column(&format!("block.zmin.{c}"))[k];
            worst = worst.max(all.abs() / scale);
        }
    }
    assert_small("balance", worst, 1e-8);
}

/// What is kept of a run, be it refused later, is right to 1e-5: the support bears what is given.
#[track_caller]
fn held(run: &Run, given: impl Fn(usize) -> f64, support: &str) {
    let history = run.history();
    for (k, borne) in history.column(support).iter().enumerate() {
        let given = given(k);
        assert!(
            (borne + given).abs() <= 1e-5 * given.abs(),
            "{given:e} is given, {support} is {borne:e}\n{}",
            run.log()
        );
    }
    assert!(
        run.code == 0 || run.code == 1 && run.stderr.contains("what rounding leaves of the forces of"),
        "{}",
        run.stderr
    );
}

/// Two blocks, one up to 1e14 times as stiff as the other, pressed together.
#[test]
fn what_a_stiff_body_passes_on() {
    for (ratio, by) in [(1e-14, 0.2), (1e-12, 0.002), (1e-8, 0.2), (1e8, 0.2), (1e10, 0.002), (1e12, 0.2), (1e14, 0.2)]
    {
        let young = 100.0 * ratio;
        let run = Bench::new(&format!(
            r#"
            [body.lower]
            block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
            material = "a"
            element = "hex8"
            [body.upper]
            block = {{ box = {{ origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
            material = "b"
            element = "hex8"
            [material.a]
            model = "hooke"
            young = 100.0
            poisson = 0.3
            [material.b]
            model = "hooke"
            young = {young:?}
            poisson = 0.3
            [contact.c]
            slave = "lower.zmax"
            master = "upper.zmin"
            friction = 0.3
            [[step]]
            increments = 2
            fix = [{{ set = "lower.zmin" }}]
            move = [{{ target = "upper.zmax", by = [0.0, 0.0, -{by:?}] }}]
            [output]
            every = 100
            history = ["lower.zmin", "upper.zmax"]
            "#
        ))
        .run(1 + usize::from(ratio > 1.0), &[]);
        let history = run.history();
        println!("ratio {ratio:e}, by {by}: exit code {}, {} kept", run.code, history.len());
        held(&run, |k| history.column("upper.zmax.fz")[k], "lower.zmin.fz");
        assert_eq!(run.code == 0, (1e-9..1e9).contains(&ratio), "{}", run.stderr);
        assert!(run.code == 0 || history.len() == 0);
    }
}

/// A cube of steel of 10 mm, in metres, under a force on its top, by a tool, by a pressure that hardly widens it, by its
/// weight.
#[test]
fn loads_that_are_lost_in_the_stiffness() {
    for total in [1e1, 1e-1, 1e-6, 1e-8, 1e-10, 1e-20] {
        for how in ["force", "tool", "pressure", "weight"] {
            let load = match how {
                "force" => format!("force = [{{ target = \"b.zmax\", total = [0.0, 0.0, -{total:?}] }}]"),
                "tool" => format!("force = [{{ target = \"t\", total = [0.0, 0.0, -{total:?}], directions = \"z\" }}]"),
                "pressure" => format!("pressure = [{{ set = \"b.zmax\", value = {:?} }}]", total / 1e-4),
                _ => format!("body_force = [{{ body = \"b\", per_volume = [0.0, 0.0, -{:?}] }}]", total / 1e-6),
            };
            let run = Bench::new(&format!(
                r#"
                [body.b]
                block = {{ box = {{ size = [0.01, 0.01, 0.01] }}, elements = [3, 3, 3] }}
                material = "m"
                element = "hex8"
                [material.m]
                model = "neo-hookean"
                young = 2e11
                poisson = 0.3
                [tool.t]
                plane = {{ point = [0.0, 0.0, 0.01], normal = [0.0, 0.0, -1.0] }}
                [contact.c]
                slave = "b.zmax"
                master = "t"
                [[step]]
                increments = 2
                fix = [{{ set = "b.zmin" }}]
                {load}
                [output]
                every = 100
                history = ["b.zmin"]
                "#
            ))
            .run(1, &[]);
            let history = run.history();
            println!("{how} of {total:e}: exit code {}, {} kept", run.code, history.len());
            held(&run, |k| -total * history.column("time")[k], "b.zmin.fz");
            assert_eq!(run.code == 0, total > 1e-2, "{}", run.stderr);
        }
    }
}

/// Nearly incompressible blocks, stretched by their supports alone.
#[test]
fn stretched_by_supports() {
    for element in ["hex8-fbar", "hex8-sri"] {
        for below in [1e-3, 1e-6, 1e-10, 1e-12] {
            let run = Bench::new(&format!(
                r#"
                [body.b]
                block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [3, 3, 3] }}
                material = "m"
                element = "{element}"
                [material.m]
                model = "neo-hookean"
                young = 10.0
                poisson = {:?}
                [[step]]
                increments = 2
                fix = [{{ set = "b.zmin" }}]
                move = [{{ target = "b.zmax", by = [0.0, 0.0, 0.2] }}]
                [output]
                every = 100
                history = ["b.zmin", "b.zmax"]
                "#,
                0.5 - below
            ))
            .run(1, &[]);
            let history = run.history();
            println!("{element}, nu = 1/2 - {below:e}: exit code {}, {} kept", run.code, history.len());
            held(&run, |k| history.column("b.zmax.fz")[k], "b.zmin.fz");
            assert_eq!(run.code == 0, below > 1e-8, "{}", run.stderr);
        }
    }
}

/// What moves without strain has forces that are but rounding, and is no failure for it: free of all else, beside what it
/// touches, and where a contact has opened.
#[test]
fn moved_without_a_load() {
    for (upper, height, step) in [
        (
            2e5,
            2.0,
            "move = [{ target = \"b.zmax\", by = [10.0, 0.0, 0.0] }, { target = \"a.zmin\", by = [10.0, 0.0, 0.0] }]",
        ),
        (
            2e5,
            2.0,
            "move = [{ target = \"b.zmax\", by = [0.0, 0.0, 50.0] }, { target = \"a.zmin\", by = [0.0, 0.0, -50.0] }]",
        ),
        (2e11, 2.0, "move = [{ target = \"b.zmax\", by = [1.0, 1.0, 0.0] }]\nfix = [{ set = \"a.zmin\" }]"),
        (2e5, 0.02, "move = [{ target = \"b.xmin\", by = [0.0, 0.0, 50.0] }]\nfix = [{ set = \"a.zmin\" }]"),
    ] {
        Bench::new(&format!(
            r#"
            [body.a]
            block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
            material = "soft"
            element = "hex8"
            [body.b]
            block = {{ box = {{ origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, {height:?}] }}, elements = [3, 3, 1] }}
            material = "stiff"
            element = "hex8-eas"
            [material.soft]
            model = "hooke"
            young = 1.0
            poisson = 0.3
            [material.stiff]
            model = "hooke"
            young = {upper:?}
            poisson = 0.3
            [contact.c]
            slave = "a.zmax"
            master = "b.zmin"
            friction = 0.3
            [[step]]
            increments = 3
            {step}
            [output]
            every = 100
            history = ["a.zmin", "b.zmax"]
            "#
        ))
        .solve(1, &[]);
    }
}

/// A soft block that its supports strain, and a stiff one that only moves, of which rounding leaves 64 ε k d of the forces,
/// k being its stiffness and d how far it is moved, where 1e-6 k h counts, h being the size of the elements, 1.
const SOFT_AND_STIFF: &str = r#"
    [body.soft]
    block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
    material = "soft"
    element = "hex8"
    [body.stiff]
    block = { box = { origin = [4.0, 0.0, 0.0], size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
    material = "stiff"
    element = "hex8"
    [material.soft]
    model = "neo-hookean"
    young = 1.0
    poisson = 0.3
    [material.stiff]
    model = "neo-hookean"
    young = 2e8
    poisson = 0.3
    [[step]]
    increments = 3
    fix = [{ set = "soft.zmin" }]
    move = [{ target = "soft.zmax", by = [0.3, 0.0, -0.4] }, { target = "stiff.zmin", by = [10.0, 5.0, 0.0] }]
    [output]
    every = 100
    "#;

/// `residual` and `limit` of the history are of one body: the one that is nearest to what is let through there, not the one
/// that is let through most.
#[test]
fn the_residual_stands_beside_its_own_limit() {
    let both = Bench::new(SOFT_AND_STIFF).solve(1, &[]).history();
    let (before, after) = SOFT_AND_STIFF.split_once("[body.stiff]").unwrap();
    let scene = format!("{before}{}", &after[after.find("[material.soft]").unwrap()..]);
    let alone = Bench::new(&scene.replace(", { target = \"stiff.zmin\", by = [10.0, 5.0, 0.0] }", ""));
    let alone = alone.solve(1, &[]).history();
    assert_eq!(both.len(), 3);
    for k in 0..3 {
        let [one, other] = [&both, &alone].map(|history| history.column("residual")[k]);
        assert!(one > 1e-12, "{one:e}: too little to tell");
        assert_close("residual", one, other, 1e-2);
        assert_eq!([both.column("limit")[k], alone.column("limit")[k]], [1e-10; 2]);
    }
    // Where the stiff one is all there is, it has more.
    let scene = SOFT_AND_STIFF.replace("by = [0.3, 0.0, -0.4]", "by = [0.0, 0.0, 0.0]");
    let stiff = Bench::new(&scene).solve(1, &[]).history();
    assert_close("limit of what only moves", stiff.last("limit"), 64.0 * f64::EPSILON * 10.0 / 1e-6, 1e-6);
}

/// What rounding excuses stands in the summary and the log, of the increment in which it was most.
#[test]
fn what_rounding_excuses_is_told() {
    for (by, of) in [("1.0", None), ("100.0", Some("body `stiff`"))] {
        let run = Bench::new(&SOFT_AND_STIFF.replace("[10.0, 5.0, 0.0]", &format!("[{by}, 5.0, 0.0]"))).solve(1, &[]);
        let (told, log) = (&run.summary()["rounded"], run.log());
        assert_eq!((told["of"].as_str(), told.is_null()), (of, of.is_none()), "{told}");
        let excused: Vec<&str> = log.lines().filter(|line| line.contains("let through")).collect();
        assert_eq!(told["increments"].as_u64().unwrap_or(0), excused.len() as u64, "{excused:?}");
        let Some(of) = of else { continue };
        let [residual, limit, time] = ["residual", "limit", "time"].map(|key| told[key].as_f64().unwrap());
        assert!(residual > 1e-10 && residual < limit, "{told}");
        assert_close("limit", limit, 64.0 * f64::EPSILON * 100.0 * time / 1e-6, 1e-6);
        let line = format!("    {of}: residual {residual:.1e} let through, of which rounding leaves up to {limit:.1e}");
        assert!(excused.contains(&line.as_str()), "{line}: {excused:?}");
    }
}
