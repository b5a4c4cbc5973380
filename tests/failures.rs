//! Runs that fail: what is known until then is kept, the message says where and why, and nothing hangs; and what is left
//! open in runs that do not.

mod common;

use common::jobs::{BLOCK_UNDER_PLATE, children, shown_times, wait_for};
use common::{Bench, History, Run, mpirun};
use std::path::Path;
use std::process::{Command, Stdio};

/// Pressed flat and beyond.
const STEP: &str = r#"[[step]]
name = "press"
increment = { initial = 0.1, min = 0.1 }
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -2.5] }]
"#;

/// The block, its plate and the step.
fn scene() -> String {
    format!("{BLOCK_UNDER_PLATE}{STEP}")
}

/// What is said of a run that did not converge: once on the terminal, and in the log.
#[track_caller]
fn failure(run: &Run) -> String {
    assert_eq!(run.code, 1, "{}\n{}", run.stdout, run.stderr);
    assert!(run.stderr.starts_with("error: ") && run.stderr.matches("error:").count() == 1, "{}", run.stderr);
    assert!(run.log().contains(&run.stderr), "{}\n{}", run.stderr, run.log());
    let first = run.stderr.lines().next().unwrap();
    assert!(!run.stdout.contains(first), "{}", run.stdout);
    assert_eq!(run.summary()["converged"], false);
    run.stderr.clone()
}

/// What failed.h5 has of the increment that was not found.
fn shown_of_failed(run: &Run, name: &str) -> Vec<f64> {
    let failed = hdf5::File::open(run.out.join("failed.h5")).unwrap();
    failed.dataset(&format!("increments/000001/{name}")).unwrap().read_raw().unwrap()
}

#[test]
fn a_crushed_block_keeps_what_converged() {
    let bench = Bench::new(&scene());
    let run = bench.run(2, &["--set", "output.every=100"]);
    let text = failure(&run);
    for words in [
        "error: step `press`, after time 0.",
        "no convergence in 15 iterations with the smallest increment, 1.000e-1\n",
        " of body `block` at (",
        "), sticking in contact `top`, residual ",
        " of the largest force\n",
        "help: load in smaller increments, allow a smaller `increment.min`",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let (history, summary) = (run.history(), run.summary());
    assert!((3..10).contains(&history.len()), "{}", run.stdout);
    assert_eq!((&summary["increments"], &summary["cutbacks"]), (&history.len().into(), &0.into()));
    assert_eq!(shown_times(&run.out), [history.last("time")]);
    let moved = run.field("increments/000001/tool_plate/node/displacement");
    assert_eq!(moved[2], history.last("plate.uz"));
    // Where the increment stood that was not found is shown apart: its time, and the residual that was told.
    let read = |name: &str| shown_of_failed(&run, name);
    assert!((read("time")[0] - history.last("time") - 0.1).abs() < 1e-12, "{:?}", read("time"));
    let [residual, flips] = ["body_block/node/residual", "contact_top/node/flips"].map(read);
    let worst = residual.iter().fold(0.0f64, |most, r| most.max(r.abs()));
    assert!(worst > 1e-3 && run.stdout.contains("failed.xdmf"), "{worst}\n{}", run.stdout);
    assert_eq!(flips.len(), read("contact_top/node/status").len());
    // The last state is an equilibrium: the plate's force is what the nodes under it bear.
    let forces = run.field("increments/000001/contact_top/node/force");
    let borne: f64 = forces.iter().skip(2).step_by(3).sum();
    let driving = history.last("plate.fz");
    assert!(driving < -100.0 && (borne - driving).abs() < 1e-8 * driving.abs(), "{borne} {driving}");
}

/// The tip of a cone between the points of segments is in the body, and nothing resists: the end of the step is refused, whether the
/// run would go on or not, and where that stood is shown.
#[test]
fn a_master_that_no_segment_feels_is_refused_at_the_end_of_a_step() {
    let step = |name: &str, by: [f64; 3]| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = 2\nfix = [{{ set = \"a.zmin\" }}]\nmove = [{{ target = \"p\", by = {by:?} }}]\n"
        )
    };
    let bench = Bench::new(&format!(
        r#"[body.a]
material = "m"
block = {{ box = {{ size = [4, 4, 2] }}, elements = [4, 4, 2] }}
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.p]
cone = {{ apex = [2, 2, 2], axis = [0, 0, 1], angle = 70 }}
[contact.c]
slave = "a.zmax"
master = "p"
discretization = "segment"
{}{}"#,
        step("press", [0.0, 0.0, -0.1]),
        step("lift", [0.0, 0.0, 0.2])
    ));
    let run = bench.run(2, &["--steps", "1"]);
    let text = failure(&run);
    assert!(text.contains("deep in the tool `p`, but no gap is closed in the mean"), "{text}");
    let whole = failure(&bench.run(2, &[]));
    assert!(whole.contains("step `press`") && whole.contains("but no gap is closed in the mean"), "{whole}");
    let [moved, residual] =
        ["tool_p/node/displacement", "body_a/node/residual"].map(|name| shown_of_failed(&run, name));
    assert!(moved[2] < -0.05 && residual.iter().all(|r| *r == 0.0), "{moved:?}");
}

/// A block tips over its edge, at which the faces below and beside it have contacts of their own: what one does not feel at a corner
/// that they share, the other does.
#[test]
fn a_corner_that_another_contact_holds_is_felt() {
    let side = |name: &str, face: &str| {
        format!("[contact.{name}]\nslave = \"w.{face}\"\nmaster = \"road\"\ndiscretization = \"segment\"\n")
    };
    let bench = Bench::new(&format!(
        r#"[body.w]
material = "r"
plane_strain = true
block = {{ box = {{ origin = [-1, 0, 0], size = [2, 2, 1] }}, elements = [2, 3, 1] }}
[material.r]
model = "neo-hookean"
young = 6.0
poisson = 0.45
[tool.road]
plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
{}{}
[[step]]
increments = 5
move = [{{ target = "w.ymax", by = [0.0, -0.3, 0.0] }}]
[[step]]
increments = 30
move = [{{ target = "w.ymax", rotate = {{ point = [0, 1, 0], axis = [0, 0, 1], angle = -60 }} }}]
"#,
        side("sole", "ymin"),
        side("heel", "xmax"),
    ));
    let run = bench.solve(1, &[]);
    let history = run.history();
    assert!(history.last("heel.active") > 0.0 && history.last("sole.active") == 0.0);
}

/// An edge of a cube is driven past the diagonal of the faces beside it, where the Jacobian at its nodes, (1 - 2d) at a way of d
/// along both sides, changes its sign; those at the integration points are positive still. Increments are cut down to where that
/// begins, and the run goes on with a word.
#[test]
fn an_element_that_folds_over_is_told_of() {
    let bench = Bench::new(
        r#"[body.cube]
mesh = "cube.inp"
material = "rubber"
element = "hex8"

[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3

[[step]]
name = "fold"
increments = 10
fix = [{ set = "cube.rest", directions = "xy" }, { set = "cube.foot", directions = "z" }]
move = [{ target = "cube.edge", by = [-0.6, -0.6, 0.0] }]
"#,
    );
    bench.write(
        "cube.inp",
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
         *ELEMENT, TYPE=C3D8, ELSET=all\n11, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=rest\n1, 2, 4, 5, 6, 8\n\
         *NSET, NSET=foot\n1, 2, 4\n*NSET, NSET=edge\n3, 7\n",
    );
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let summary = run.summary();
        let warnings = summary["warnings"].as_array().unwrap();
        let told = warnings[0].as_str().unwrap();
        let start = "step `fold`: element 11 of body `cube` has folded over at a node at time ";
        assert!(warnings.len() == 1 && told.starts_with(start), "{warnings:?}");
        let time: f64 = told[start.len()..].split(',').next().unwrap().parse().unwrap();
        let begins = 0.5 / 0.6;
        assert!((begins..begins + 2.0 * 0.1 / 256.0).contains(&time), "{time}");
        let history = run.history();
        assert_eq!(history.last("time"), 1.0);
        // Each that was refused counts.
        let tried: f64 = history.column("failures").iter().sum();
        assert!(tried > 0.0 && summary["cutbacks"] == tried as u64, "{tried} {}", summary["cutbacks"]);
    }
}

#[test]
fn without_iterations_nothing_converges_and_contact_is_blamed() {
    let bench = Bench::new(&scene());
    let run = bench.run(2, &["--set", "solver.max_iterations=1", "--quiet"]);
    assert_eq!(run.stdout, "");
    let text = failure(&run);
    for words in [
        "error: step `press`, after time 0.000000: no convergence in 1 iterations with the smallest increment",
        " of body `block` at (",
        " contact nodes still change their status\n",
        "lower the contact's `penalty`",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    assert_eq!(run.history().len(), 0);
    assert_eq!(run.summary()["increments"], 0);
    hdf5::File::open(run.out.join("fields.h5")).unwrap().group("grids/body_block").unwrap();
}

/// What only touches is held by that; pulled off it has nothing, along the contact's normal or askew to it.
#[test]
fn a_body_that_is_pulled_off_is_refused() {
    for total in ["0.0, 0.0, -1.0", "1.0, 0.0, -0.1"] {
        let pull = format!("[[step]]\nincrements = 1\nforce = [{{ target = \"block.top\", total = [{total}] }}]\n");
        let run = Bench::new(&format!("{BLOCK_UNDER_PLATE}{pull}")).run(2, &[]);
        assert_eq!(run.code, 2, "{}", run.stdout);
        assert!(run.stderr.contains("nothing presses body `block` against what touches it"), "{}", run.stderr);
    }
}

/// A tool that a body touches but for rounding holds it from the first iteration on.
#[test]
fn a_body_that_touches_is_held() {
    let push = "[[step]]\nincrements = 1\nforce = [{ target = \"block.bottom\", total = [1.0, 0.0, 10.0] }]\n";
    let scene = format!("{BLOCK_UNDER_PLATE}{push}").replace("[0.0, 0.0, 2.0]", "[0.0, 0.0, 2.000001]");
    let run = Bench::new(&scene).solve(2, &[]);
    let history = run.history();
    assert!((history.last("plate.fz") + 10.0).abs() < 1e-8 && (history.last("plate.fx") + 1.0).abs() < 1e-8);
}

/// A far stiffer block on a soft one, which a plate presses; nothing converges in one iteration.
const STIFF_ON_SOFT: &str = r#"
body.soft.block = { box = { size = [2.0, 2.0, 1.0] }, elements = [3, 3, 1] }
body.soft.material = "rubber"
body.stiff.block = { box = { origin = [0.5, 0.5, 1.0], size = [1.0, 1.0, 0.5] }, elements = [2, 2, 1] }
body.stiff.material = "steel"
material.rubber = { model = "neo-hookean", young = 5.0, poisson = 0.3 }
material.steel = { model = "neo-hookean", young = 500.0, poisson = 0.3 }
contact.between = { slave = "soft.zmax", master = "stiff.zmin", friction = 0.2 }
solver.max_iterations = 1
[[step]]
increments = 1
fix = [{ set = "soft.zmin" }]
move = [{ target = "stiff.zmax", by = [0.1, 0.0, -0.1] }]
"#;

/// A billet spreads into the corners of a die: as one contact it has one force for a node there, and with a contact for each
/// side, or a fillet, as many as it needs.
#[test]
fn hollow_edges_are_named() {
    let scene = |tools: &str, contacts: &str| {
        Bench::new(&format!(
            r#"
body.billet.block = {{ box = {{ origin = [-1.0, 0.0, 0.0], size = [2.0, 2.0, 0.25] }}, elements = [8, 8, 1], faces = {{ skin = ["xmin", "ymin", "xmax"] }} }}
body.billet.material = "rubber"
body.billet.plane_strain = true
material.rubber = {{ model = "neo-hookean", young = 10.0, poisson = 0.45 }}
tool.punch.plane = {{ point = [0.0, 2.0, 0.0], normal = [0.0, -1.0, 0.0] }}
contact.up = {{ slave = "billet.ymax", master = "punch", friction = 0.1 }}
{tools}
{contacts}
[[step]]
increments = 10
move = [{{ target = "punch", by = [0.0, -0.35, 0.0] }}]
"#
        ))
    };
    let die = |fillet: &str| {
        format!(
            "tool.die.profile = {{ points = [[1.05, 4.0], [1.05, 0.0], [-1.05, 0.0], [-1.05, 4.0]], fillets = {fillet} }}"
        )
    };
    let of_die = "contact.die = { slave = \"billet.skin\", master = \"die\", friction = 0.1 }";
    let run = scene(&die("0.0"), of_die).run(2, &[]);
    let told = "begins at a hollow edge of the tool `die`, whose sides turn by 90 degrees there";
    assert_eq!(run.log().matches(told).count(), 1, "{}", run.log());
    let text = failure(&run);
    for words in [
        "help: node ",
        "is in a hollow edge of the tool `die`, whose sides, which turn by 90 degrees there, both press it",
        "contact `die` has one force for a node",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let planes =
        [("floor", [0.0, 0.0], [0.0, 1.0]), ("left", [-1.05, 0.0], [1.0, 0.0]), ("right", [1.05, 0.0], [-1.0, 0.0])];
    let plane = |(name, [x, y], [nx, ny]): &(&str, [f64; 2], [f64; 2])| {
        let tool = format!("tool.{name}.plane = {{ point = [{x}, {y}, 0.0], normal = [{nx}, {ny}, 0.0] }}\n");
        (tool, format!("contact.{name} = {{ slave = \"billet.skin\", master = \"{name}\", friction = 0.1 }}\n"))
    };
    let (tools, contacts): (String, String) = planes.iter().map(plane).unzip();
    let force = |bench: Bench| bench.solve(2, &[]).history().last("punch.fy");
    let [sharp, rounded] = [force(scene(&tools, &contacts)), force(scene(&die("[0.0, 0.05, 0.05, 0.0]"), of_die))];
    assert!(sharp < -3.5 && (rounded / sharp - 1.0).abs() < 0.03, "{sharp} {rounded}");
}

/// What is peculiar to a contact is named before what always helps, and nothing of a contact that is as it should be.
#[test]
fn contacts_that_may_be_why_are_named() {
    let bench = Bench::new(STIFF_ON_SOFT);
    let told = |settings: &[&str]| {
        let settings: Vec<&str> = settings.iter().flat_map(|setting| ["--set", *setting]).collect();
        failure(&bench.run(2, &settings))
    };
    let text = told(&[]);
    assert!(!text.contains("help: contact") && !text.contains("help: exchange"), "{text}");
    assert!(text.contains("lower the contact's `penalty`"), "{text}");
    let wrong_way = ["contact.between.slave=\"stiff.zmin\"", "contact.between.master=\"soft.zmax\""];
    let two_passes = "contact.between.discretization=\"two-pass\"";
    let cases: [(&[&str], &str); 5] = [
        (
            &wrong_way,
            "help: exchange slave and master of contact `between`: `stiff.zmin` is the stiffer (Young's modulus 5.0000e2 \
             against 5.0000e0 of the master)\n",
        ),
        (
            &[two_passes],
            "help: contact `between` has two passes: take one, with the far softer `soft.zmax` as the slave\n",
        ),
        (
            &["contact.between.method=\"lagrange\""],
            "help: contact `between` has the method \"lagrange\": take \"augmented-lagrangian\"",
        ),
        (
            &["contact.between.method=\"uzawa\""],
            "help: contact `between` has the method \"uzawa\": take \"augmented-lagrangian\"",
        ),
        (
            &["contact.between.tangent=\"fixed-frame\""],
            "help: contact `between` has the tangent \"fixed-frame\", which converges slowly where contact slides: take \
             \"exact\"\n",
        ),
    ];
    for (settings, words) in cases {
        let text = told(settings);
        assert!(text.contains(words), "{words}\n{text}");
        assert!(text.ends_with("help: load in smaller increments, or allow a smaller `increment.min`\n"), "{text}");
    }
}

/// Kills a rank once the history has `rows` rows; returns how many there are in the end.
fn kill_one(victim: usize, rows: usize) -> usize {
    let bench = Bench::new(&scene());
    let out = bench.path("out");
    let mut job = mpirun(2)
        .args(["run", "scene.toml", "--out", "out", "--set", "step.press.increment={ initial = 1e-4 }"])
        .current_dir(bench.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = || std::fs::read_to_string(out.join("history.csv")).map_or(0, |text| text.lines().count());
    wait_for(&mut job, "rows", |_| (lines() > rows).then_some(()));
    let ranks = children(job.id());
    assert_eq!(ranks.len(), 2);
    assert!(Command::new("kill").args(["-9", &ranks[victim].to_string()]).status().unwrap().success());
    let status = wait_for(&mut job, "the end of the job", |job| job.try_wait().unwrap());
    assert!(status.code().is_some_and(|code| code != 0), "{status}");
    let gone = || ranks.iter().all(|pid| !Path::new(&format!("/proc/{pid}")).exists());
    wait_for(&mut job, "the end of the ranks", |_| gone().then_some(()));

    let history = History::read(&out.join("history.csv"));
    let (times, all) = (shown_times(&out), history.column("time"));
    // A kill between the two files may leave the fields one increment behind.
    assert!(all.starts_with(&times) && times.len() + 1 >= all.len(), "{times:?}\n{all:?}");
    assert!(!out.join("summary.json").exists());
    history.len()
}

#[test]
fn a_killed_rank_ends_the_job_and_leaves_readable_files() {
    for (victim, rows) in [(0, 3), (1, 5)] {
        assert!(kill_one(victim, rows) >= rows);
    }
}

/// Two cubes of one body that share an edge alone, which is a hinge: the second may hang as it likes, and no force depends on
/// it.
#[test]
fn what_can_move_freely_is_told() {
    let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,2,0,1\n10,2,1,1\n11,1,0,2\n12,2,0,2\n\
                13,2,1,2\n14,1,1,2\n*ELEMENT, TYPE=C3D8, ELSET=all\n1,1,2,3,4,5,6,7,8\n2,6,9,10,7,11,12,13,14\n\
                *NSET, NSET=low\n1,2,3,4\n*NSET, NSET=left\n1,4,5,8\n*NSET, NSET=hung\n11,14\n";
    let scene = r#"
        [body.b]
        mesh = "hinge.inp"
        material = "m"
        [material.m]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "b.low", directions = "yz" }]
        move = [{ target = "b.left", by = [0.1, 0.0, 0.0] }]
        "#;
    let run = |scene: &str| {
        let bench = Bench::new(scene);
        bench.write("hinge.inp", deck);
        bench.solve(1, &[])
    };
    let hinge = run(scene);
    let said = " can move freely: no support, contact or stiffness holds it, and nothing drives it. No force depends on where it is";
    let warning = told_once(&hinge, said);
    assert!(warning.starts_with("step `press`: ") && warning.contains(" of node "), "{warning}");
    // A node of the second cube beside the edge.
    let node = warning.split(" of node ").nth(1).unwrap().split(' ').next().unwrap();
    assert!(["9", "10", "11", "12", "13", "14"].contains(&node), "{warning}");
    let held = run(&scene.replace("fix = [", "fix = [{ set = \"b.hung\", directions = \"x\" }, "));
    assert_eq!(held.summary()["warnings"].as_array().unwrap().len(), 0, "{}", held.stdout);
}

/// Two plates that press on the same nodes without friction: what each bears is open, their sum is not.
#[test]
fn conditions_that_say_what_others_say_are_told() {
    let plate = "plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }";
    let scene = |plates: &[&str]| {
        let (mut head, mut moves) = (String::new(), Vec::new());
        for name in plates {
            head += &format!(
                "[tool.{name}]\n{plate}\n[contact.on_{name}]\nslave = \"b.zmax\"\nmaster = \"{name}\"\nmethod = \"lagrange\"\n"
            );
            moves.push(format!("{{ target = \"{name}\", by = [0.0, 0.0, -0.1] }}"));
        }
        format!(
            r#"
            [body.b]
            block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1] }}
            material = "m"
            [material.m]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            {head}
            [[step]]
            name = "press"
            increments = 2
            fix = [{{ set = "b.zmin" }}]
            move = [{}]
            "#,
            moves.join(", ")
        )
    };
    let [both, one] = [&["p", "q"][..], &["p"]].map(|plates| Bench::new(&scene(plates)).solve(1, &[]));
    let warning = told_once(&both, " conditions say what others say (null pivots)");
    // The nodes of the top.
    assert_eq!(
        warning,
        "step `press`: 9 conditions say what others say (null pivots): what each of them bears is left to rounding, and only \
         their sum is right"
    );
    assert_eq!(one.summary()["warnings"].as_array().unwrap().len(), 0, "{}", one.stdout);
    let sum = both.history().last("p.fz") + both.history().last("q.fz");
    common::assert_close("sum of both", sum, one.history().last("p.fz"), 1e-8);
}

/// On a slope steeper than friction a block has no equilibrium, and what pushes it and what holds it is told, whichever the
/// discretization; of that from segment to segment not that it has not begun.
#[test]
fn what_slides_down_a_slope_is_told() {
    let scene = |kind: &str, degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        format!(
            "[body.b]\nmaterial = \"m\"\nblock = {{ box = {{ size = [10.0, 10.0, 10.0] }}, elements = [2, 2, 2] }}\n\
             [material.m]\nmodel = \"hooke\"\nyoung = 10.0\npoisson = 0.3\ndensity = 1e-8\n\
             [tool.plane]\nplane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}\n\
             [contact.c]\nslave = \"b.zmin\"\nmaster = \"plane\"\nfriction = 0.3\ndiscretization = \"{kind}\"\n\
             [[step]]\nincrements = 1\ngravity = [{}, 0.0, {}]\n",
            9810.0 * sin,
            -9810.0 * cos
        )
    };
    for kind in ["one-pass", "segment"] {
        Bench::new(&scene(kind, 16.0)).solve(1, &[]);
        let text = failure(&Bench::new(&scene(kind, 18.0)).run(2, &[]));
        // tan 18 degrees.
        let told = "help: contact `c` alone holds body `b`, and its loads push it along by 0.3249 of what they press with, of which \
                    friction bears 0.3: it slides";
        assert!(text.contains(told) && !text.contains("which is open"), "{told}\n{text}");
    }
}

/// The warning of a run that ends in order that has these words: on the terminal, in the log and in the summary, once each.
#[track_caller]
fn told_once(run: &Run, words: &str) -> String {
    assert_eq!((run.code, &run.summary()["converged"]), (0, &true.into()), "{}\n{}", run.stdout, run.stderr);
    let summary = run.summary();
    let warnings: Vec<&str> = summary["warnings"].as_array().unwrap().iter().filter_map(|text| text.as_str()).collect();
    let [warning] = warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.contains(words), "{warning}");
    let line = format!("warning: {warning}");
    for told in [&run.stdout, &run.log()] {
        assert_eq!(told.matches(&line).count(), 1, "{line}\n{told}");
    }
    warning.to_string()
}

/// A punch begins flush with a holder that the contacts name over all of a blank: which of them is to bear is hard to find, and that
/// is told where it is not found.
#[test]
fn masters_that_lie_flush_are_named() {
    let run = Bench::new(
        r#"
[body.s]
material = "m"
axisymmetric = true
block = { box = { size = [45.0, 1.0, 1.0] }, elements = [45, 2, 1] }
[material.m]
model = "hooke"
young = 2e5
poisson = 0.3
[tool.punch.profile]
points = [[0.0, 41.0], [0.0, 1.0], [25.0, 1.0], [25.0, 41.0]]
fillets = [0.0, 0.0, 6.0, 0.0]
[tool.die]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }
[tool.holder]
plane = { point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }
[contact.p]
slave = "s.ymax"
master = "punch"
friction = 0.1
[contact.d]
slave = "s.ymin"
master = "die"
friction = 0.1
[contact.h]
slave = "s.ymax"
master = "holder"
friction = 0.1
[[step]]
increment = { initial = 1.0, min = 0.9 }
force = [{ target = "holder", total = [0.0, -10000.0, 0.0], directions = "y" }]
[solver]
max_iterations = 1
"#,
    )
    .run(2, &[]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let told =
        "help: the tool `punch` and the tool `holder` lie flush on 19 nodes, slaves of contact `p` and of contact `h`";
    assert!(run.stderr.contains(told), "{}", run.stderr);
}
