//! Checkpoints and restarts: a run that is stopped or killed at any moment, and goes on on any number of ranks, ends as one
//! that is not; what is no checkpoint of the scene is refused.

mod common;

use common::jobs::{Job, send, shown_times, wait_for};
use common::{Bench, Run, assert_small, nagata, sector};
use std::fs;
use std::process::Command;
use std::time::Duration;

/// A plate that yields by Hill's criterion, so that an increment begins with other forces than the last ended with, on a pad of
/// another mesh, with friction between both and under a ball, which a force presses and a motion draws along. The pad's
/// elements have enhanced strain, and the plate's two layers of solid-shells.
const PRESS: &str = r#"
[body.plate]
material = "steel"
element = "hex8-shell"
shell = { points = 3 }
block = { box = { origin = [-8, -8, 0], size = [16, 16, 4] }, elements = [4, 4, 2], faces = { bottom = "zmin", top = "zmax" } }

[body.pad]
material = "rubber"
element = "hex8-eas"
block = { box = { origin = [-9, -9, -6], size = [18, 18, 6] }, elements = [3, 3, 2], faces = { bottom = "zmin", top = "zmax" } }

[material.steel]
model = "hill"
young = 200.0
poisson = 0.3
yield_stress = 2.0
hardening = { linear = 20.0 }
hill = { f = 0.283, g = 0.358, h = 0.642, n = 1.289 }

[material.rubber]
model = "neo-hookean"
young = 60.0
poisson = 0.4

[tool.ball]
sphere = { center = [0.3, 0.2, 14.0], radius = 10.0 }

[contact.top]
slave = "plate.top"
master = "ball"
friction = 0.3

[contact.joint]
slave = "plate.bottom"
master = "pad.top"
friction = 0.2

[[step]]
name = "press"
increments = 12
fix = [{ set = "pad.bottom" }, { set = "plate.top", directions = "y" }]
force = [{ target = "ball", total = [0.0, 0.0, -60.0], directions = "z" }]

[[step]]
name = "draw"
increments = 12
fix = [{ set = "pad.bottom" }, { set = "plate.top", directions = "y" }]
force = [{ target = "ball", total = [0.0, 0.0, -50.0], directions = "z" }]
move = [{ target = "ball", by = [2.0, 0.0, 0.0] }]

[output]
every = 3
history = ["pad.bottom"]
"#;

/// The strip of `inputs/`, which closes onto itself, in fewer increments.
fn strip() -> Bench {
    let folder = env!("CARGO_MANIFEST_DIR");
    let bench = Bench::new(&fs::read_to_string(format!("{folder}/inputs/c-strip.toml")).unwrap());
    bench.write("c-strip.msh", include_str!("../inputs/c-strip.msh"));
    bench
}

/// Runs `nagata run scene.toml --out out`.
fn run(bench: &Bench, ranks: usize, arguments: &[&str]) -> Run {
    nagata(&bench.path(""), ranks, &[&["run", "scene.toml", "--out", "out"], arguments].concat(), bench.path("out"))
}

/// Both ended, with the same history, and the same fields at the same times.
fn assert_same(run: &Run, whole: &Run) {
    assert_eq!(run.code, 0, "{}\n{}", run.stdout, run.stderr);
    let (history, expected) = (run.history(), whole.history());
    assert_small("history", history.difference(&expected), 1e-10);
    let (summary, of_whole) = (run.summary(), whole.summary());
    for key in ["increments", "cutbacks", "jumps", "warnings"] {
        assert_eq!(summary[key], of_whole[key], "{key}");
    }
    assert_eq!(summary["estimate"].as_array().unwrap().len(), of_whole["estimate"].as_array().unwrap().len());
    let rows = run.log().lines().filter(|line| line.contains("  increment ")).count();
    assert_eq!(rows, history.len(), "{}", run.log());
    assert_eq!(shown_times(&run.out), shown_times(&whole.out));
    let last = whole.written();
    assert_eq!(run.written(), last);
    for grid in names(whole, "grids") {
        let [a, b] = [run, whole].map(|run| run.field(&format!("grids/{grid}/points")));
        assert_eq!(a, b, "{grid}");
        for place in ["node", "cell"] {
            for field in names(whole, &format!("increments/{last:06}/{grid}/{place}")) {
                let name = format!("increments/{last:06}/{grid}/{place}/{field}");
                let [a, b] = [run, whole].map(|run| run.field(&name));
                let scale = b.iter().fold(0.0f64, |most, x| if x.is_nan() { most } else { most.max(x.abs()) });
                let off = a.iter().zip(&b).filter(|(a, b)| !(a.is_nan() && b.is_nan())).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
                assert_small(&name, off / scale.max(1e-6), 1e-10);
            }
        }
    }
}

fn names(run: &Run, group: &str) -> Vec<String> {
    let file = hdf5::File::open(run.out.join("fields.h5")).unwrap();
    file.group(group).and_then(|group| group.member_names()).unwrap_or_default()
}

/// Stops a run after so many increments, and goes on with it on another number of ranks.
fn stopped(bench: &Bench, [before, after]: [usize; 2], rows: usize) -> Run {
    let job = Job::start(bench, before, rows, &[]);
    send("USR1", job.child.id());
    let (code, said) = job.end();
    assert_eq!(code, 4, "{said}");
    let run = run(bench, after, &["--restart"]);
    assert!(run.stdout.contains("goes on from the checkpoint after increment"), "{}", run.stdout);
    run
}

/// In the first step and in the second, from one rank to two and from four to three.
#[test]
fn friction_plasticity_and_a_tool_under_force_go_on() {
    let bench = Bench::new(PRESS);
    let whole = bench.solve(2, &[]);
    assert!(whole.history().last("plate.plastic_work") > 1.0 && whole.history().last("joint.slip") > 0.0);
    for (ranks, rows) in [([1, 2], 4), ([4, 3], 15)] {
        assert_same(&stopped(&bench, ranks, rows), &whole);
    }
}

#[test]
fn self_contact_goes_on() {
    let bench = strip();
    let whole = bench.solve(1, &[]);
    assert_same(&stopped(&bench, [2, 1], 30), &whole);
}

/// A shaft that is too large for its hub is pushed out of it, little by little as the scene says, with penalties and with forces
/// that are held.
#[test]
fn a_fit_that_is_ramped_goes_on() {
    for how in ["friction = 0.3", "method = \"uzawa\""] {
        let bench = Bench::new(&format!(
            "{}{}material.m = {{ model = \"hooke\", young = 1000.0, poisson = 0.3 }}\n\
             contact.c = {{ slave = \"hub.rmin\", master = \"shaft.rmax\", {how}, interference = \"ramped\" }}\n\
             [[step]]\nincrements = 100\n[output]\nevery = 10\n",
            sector("shaft", [0.5, 1.1], [5, 6]),
            sector("hub", [1.0, 2.0], [5, 9])
        ));
        let whole = bench.solve(2, &[]).history();
        let run = stopped(&bench, [2, 1], 20);
        assert_eq!(run.code, 0, "{}\n{}", run.stdout, run.stderr);
        // On which side of Uzawa's tolerance a round ends may be up to rounding, which other ranks, and processors, have of their own.
        let [run, whole] = [run.history(), whole].map(|history| history.without("iterations"));
        assert_small(how, run.difference(&whole), 1e-10);
    }
}

/// A die with kinks between its patches is drawn along a block, and stops again and again. Nodes that keep to their side of a kink
/// as it stops do so when it goes on; they would not be in equilibrium on the other.
#[test]
fn nodes_that_keep_to_their_side_of_a_kink_go_on() {
    const STOPS: usize = 10;
    let folder = env!("CARGO_MANIFEST_DIR");
    let scene = fs::read_to_string(format!("{folder}/inputs/shallow-ironing.toml")).unwrap();
    let (scene, _) = scene.split_once("[[step]]\nname = \"slide\"").unwrap();
    let scene =
        scene.replace("elements = [120, 30, 1]", "elements = [48, 12, 1]").replace("increments = 20", "increments = 5");
    let slide = r#"
        [[step]]
        increments = 3
        fix = [{ set = "block.bottom" }]
        move = [{ target = "die.top", by = [0.08, 0.0, 0.0] }]
        "#;
    let bench = Bench::new(
        &(scene + &slide.repeat(STOPS) + "[controls]\nkink_gap = 0.01\n[output]\ncheckpoint = { increments = 100 }\n"),
    );
    bench.write("shallow-indenter.msh", include_str!("../inputs/shallow-indenter.msh"));
    let whole = bench.solve(1, &[]);
    run(&bench, 1, &["--steps", "1"]);
    for steps in 2..STOPS + 2 {
        let run = run(&bench, 1, &["--restart", "--steps", &steps.to_string()]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        if steps == STOPS + 1 {
            assert_same(&run, &whole);
        }
    }
}

/// The same run is killed again and again, and goes on from where its last checkpoint was.
#[test]
fn kills_lose_nothing() {
    let bench = Bench::new(PRESS);
    let whole = bench.solve(1, &[]);
    let often = ["--set", "output.checkpoint={ increments = 2 }"];
    let mut lost = 0;
    for (kill, wait) in [110, 40, 170, 90].into_iter().enumerate() {
        let restart: &[&str] = if bench.path("out/checkpoint.h5").exists() { &["--restart"] } else { &[] };
        let mut job = Job::go_on(&bench, 1 + kill % 2, 2, &[&often, restart].concat());
        std::thread::sleep(Duration::from_millis(wait));
        // It may have ended by now.
        let _ = Command::new("kill").args(["-s", "KILL", &job.ranks[0].to_string()]).status();
        let _ = wait_for(&mut job.child, "the end of the job", |job| job.try_wait().unwrap());
        lost += usize::from(bench.path("out/checkpoint.h5.part").exists());
    }
    println!("killed while a checkpoint was written: {lost}");
    let restart: &[&str] = if bench.path("out/checkpoint.h5").exists() { &["--restart"] } else { &[] };
    assert_same(&run(&bench, 2, &[&often, restart].concat()), &whole);
}

/// A checkpoint that is written because its time has come is all that a killed run leaves.
#[test]
fn checkpoints_are_written_by_the_clock() {
    let bench = Bench::new(PRESS);
    let whole = bench.solve(1, &[]);
    for (minutes, is_due) in [("60.0", false), ("1e-7", true)] {
        let often = format!("output.checkpoint={{ minutes = {minutes} }}");
        let job = Job::start(&bench, 2, 5, &["--set", &often]);
        send("KILL", job.ranks[0]);
        assert_ne!(job.end().0, 0, "it ended before");
        assert_eq!(bench.path("out/checkpoint.h5").exists(), is_due, "{minutes}");
        let rest = run(&bench, 1, &["--restart", "--set", &often]);
        assert_eq!(rest.code, if is_due { 0 } else { 2 }, "{}", rest.stderr);
        if is_due {
            assert!(rest.stdout.contains("goes on from the checkpoint after increment"), "{}", rest.stdout);
            assert_same(&rest, &whole);
        }
    }
}

/// The folder of a run has all that it takes to go on, what was set on the command line, too.
#[test]
fn a_run_goes_on_from_its_folder_alone() {
    let bench = Bench::new(PRESS);
    let friction = ["--set", "contact.top.friction=0.25"];
    let whole = bench.solve(1, &friction);
    let job = Job::start(&bench, 2, 5, &friction);
    send("USR1", job.child.id());
    let (code, said) = job.end();
    assert_eq!(code, 4, "{said}");
    std::fs::rename(bench.path("scene.toml"), bench.path("gone.toml")).unwrap();
    let run = nagata(&bench.path(""), 1, &["run", "out", "--restart"], bench.path("out"));
    assert_same(&run, &whole);
    let fresh = nagata(&bench.path(""), 1, &["run", "out"], bench.path("out"));
    assert!(fresh.code == 2 && fresh.stderr.contains("cannot read the scene out"), "{}", fresh.stderr);
}

/// A run that has ended goes on with the step that is added to its scene; what is written may change.
#[test]
fn a_step_is_added_to_a_finished_run() {
    let bench = Bench::new(PRESS);
    let whole = bench.solve(2, &[]);
    let (one, two) = PRESS.split_once("[[step]]\nname = \"draw\"").unwrap();
    let (_, output) = two.split_once("[output]").unwrap();
    bench.write("scene.toml", &format!("{one}[output]\ncheckpoint = {{ minutes = 60.0 }}{output}"));
    let first = run(&bench, 2, &[]);
    assert_eq!((first.code, first.history().len()), (0, 12), "{}", first.stderr);
    // Nothing is left of it.
    let again = run(&bench, 1, &["--restart"]);
    assert_eq!((again.code, again.history().len()), (0, 12), "{}", again.stderr);
    bench.write("scene.toml", PRESS);
    assert_same(&run(&bench, 1, &["--restart"]), &whole);
}

#[test]
fn what_is_no_checkpoint_of_the_scene_is_refused() {
    let bench = Bench::new(PRESS);
    let refuses = |ranks: usize, arguments: &[&str], words: &str| {
        let files =
            || fs::read_dir(bench.path("out")).map_or(Vec::new(), |all| all.map(|f| f.unwrap().path()).collect());
        let content = || files().into_iter().map(|path| (fs::read(&path).unwrap(), path)).collect::<Vec<_>>();
        let before = content();
        let run = run(&bench, ranks, &[&["--restart"], arguments].concat());
        assert_eq!(run.code, 2, "{words}\n{}\n{}", run.stdout, run.stderr);
        assert!(run.stderr.contains(words) && run.stderr.matches("error:").count() == 1, "{words}\n{}", run.stderr);
        assert!(content() == before, "{words}");
    };
    refuses(1, &[], "there is no run to go on with: no folder out");
    let every = ["--set", "output.checkpoint={ increments = 5 }", "--set", "step.draw.increments=2"];
    let done = run(&bench, 1, &[&every[..], &["--steps", "1"]].concat());
    assert_eq!(done.code, 0, "{}", done.stderr);
    let friction = [&every[..], &["--set", "contact.joint.friction=0.25"]].concat();
    refuses(2, &friction, "another scene: `contact.joint.friction` is 0.25, and was 0.2");
    refuses(1, &[], "another scene: `step.draw.increments` is 12, and was 2");
    refuses(1, &[&every[..], &["--set", "output.history=[]"]].concat(), "history.csv: it has other columns");
    let path = bench.path("out/checkpoint.h5");
    let whole = fs::read(&path).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    for (bytes, words) in [
        (&flipped[..], "its checksum is not that of what it holds"),
        (&whole[..whole.len() / 2], "it does not end as checkpoints"),
        (b"something else", "it does not end as checkpoints"),
    ] {
        fs::write(&path, bytes).unwrap();
        refuses(2, &every, words);
    }
    fs::remove_file(&path).unwrap();
    refuses(1, &every, "there is no checkpoint out/checkpoint.h5");
}

/// Multipliers that are no unknowns go on, too, and what is left of forces after few iterations is seen beside those on the tool,
/// which is moved; a probe goes on where it was. No run goes back to an earlier step.
#[test]
fn other_methods_and_probes_go_on() {
    let scene = |method: &str, friction: f64| {
        format!(
            "[body.b]\nmaterial = \"m\"\nblock = {{ box = {{ size = [4, 2, 2] }}, elements = [4, 2, 2] }}\n\
             [material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [tool.t]\ncylinder = {{ point = [2.1, 0, 4], axis = [0, 1, 0], radius = 2.0 }}\n\
             [contact.c]\nslave = \"b.zmax\"\nmaster = \"t\"\nfriction = {friction:?}\nmethod = \"{method}\"\n\
             [[step]]\nname = \"down\"\nincrements = 4\nfix = [{{ set = \"b.zmin\" }}]\n\
             move = [{{ target = \"t\", by = [0, 0, -0.5] }}]\n\
             [[step]]\nname = \"along\"\nincrements = 3\nfix = [{{ set = \"b.zmin\" }}]\n\
             move = [{{ target = \"t\", by = [0.3, 0, 0] }}]\n\
             [output]\ncheckpoint = {{ increments = 1 }}\n\
             [[output.probe]]\nname = \"p\"\npoint = [1.5, 1.0, 1.5]\nfields = [\"displacement\"]\n"
        )
    };
    for (method, friction) in
        [("augmented-lagrangian", 0.3), ("uzawa", 0.3), ("lagrange", 0.3), ("penalty", 0.3), ("penalty", 0.0)]
    {
        let bench = Bench::new(&scene(method, friction));
        let whole = bench.solve(1, &[]);
        assert_eq!(run(&bench, 1, &["--steps", "1"]).code, 0);
        let moved = run(&bench, 1, &["--restart", "--set", "output.probe.p.point=[1.5, 1.0, 1.6]"]);
        assert!(moved.code == 2 && moved.stderr.contains("probe `p` has another place"), "{}", moved.stderr);
        let rest = run(&bench, 2, &["--restart"]);
        assert_eq!(rest.code, 0, "{method}\n{}", rest.stderr);
        let out = Run::of(bench.path("out"));
        for name in ["t.fx", "t.fz"] {
            common::assert_close(name, out.history().last(name), whole.history().last(name), 1e-9);
        }
        let rows = |run: &Run| fs::read_to_string(run.out.join("probe-p.csv")).unwrap().lines().count();
        assert_eq!(rows(&out), rows(&whole));
        let back = run(&bench, 1, &["--restart", "--steps", "1"]);
        let says = "the checkpoint is in step `along`, number 2, and --steps 1 ends before";
        assert!(back.code == 2 && back.stderr.contains(says), "{}", back.stderr);
    }
}

/// A checkpoint that is whole, but whose displacements are not those at which its forces were: the model finds out.
#[test]
fn a_state_out_of_balance_is_refused() {
    let bench = Bench::new(PRESS);
    let set = ["--set", "output.checkpoint={ increments = 5 }", "--steps", "1"];
    assert_eq!(run(&bench, 1, &set).code, 0);
    let path = bench.path("out/checkpoint.h5");
    // The tail is made anew, as if the file had been written so.
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() - 16]).unwrap();
    let file = hdf5::File::open_rw(&path).unwrap();
    let nodes = file.dataset("nodes").unwrap();
    let mut values = nodes.read_raw::<f64>().unwrap();
    let width = values.len() / (5 * 5 * 3 + 4 * 4 * 3);
    values[40 * width] += 1e-4;
    nodes.write_raw(&values).unwrap();
    drop(nodes);
    file.close().unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let sum = nagata::output::checkpoint::checksum(&mut &bytes[..], u64::MAX).unwrap();
    bytes.extend(nagata::output::checkpoint::MARK);
    bytes.extend(sum.to_le_bytes());
    fs::write(&path, bytes).unwrap();
    let refused = run(&bench, 2, &[&set[..], &["--restart"]].concat());
    assert_eq!(refused.code, 2, "{}\n{}", refused.stdout, refused.stderr);
    assert!(refused.stderr.contains("forces at it differ from those that it had by"), "{}", refused.stderr);
}

/// The second Ctrl-C ends a run at once; the first leaves fields, a summary, a checkpoint and a word.
#[test]
fn ctrl_c_leaves_a_checkpoint_and_a_word() {
    let bench = Bench::new(PRESS);
    let job = Job::start(&bench, 1, 3, &[]);
    assert!(Command::new("kill").args(["-s", "INT", &job.ranks[0].to_string()]).status().unwrap().success());
    let (code, said) = job.end();
    assert!(code == 4 && said.starts_with("error: SIGINT ended the run"), "{said}");
    let run = Run::of(bench.path("out"));
    assert!(run.log().contains("checkpoint written: the same command with --restart goes on from it"), "{}", run.log());
    assert!(run.summary()["interrupted"] == true && run.out.join("checkpoint.h5").exists());
    assert_eq!(shown_times(&run.out).last(), Some(&run.history().last("time")));
}

/// A folder that is moved as a whole, its mesh with it, goes on where it was; another mesh of that name does not.
#[test]
fn a_folder_that_is_moved_goes_on() {
    let bench = Bench::new("");
    let [here, there] = ["here", "there"].map(|name| bench.path(name));
    fs::create_dir(&here).unwrap();
    let scene = "body.b = { mesh = \"b.inp\", material = \"m\" }\nmaterial.m = { model = \"hooke\", young = 10.0, poisson = 0.3 }\n\
                 tool.t = { plane = { point = [0, 0, 1], normal = [0, 0, -1] } }\n\
                 contact.c = { slave = \"b.top\", master = \"t\" }\noutput.checkpoint = { increments = 1 }\n\
                 [[step]]\nname = \"one\"\nincrements = 1\nfix = [{ set = \"b.bottom\" }]\nmove = [{ target = \"t\", by = [0, 0, -0.01] }]\n\
                 [[step]]\nname = \"two\"\nincrements = 1\nfix = [{ set = \"b.bottom\" }]\nmove = [{ target = \"t\", by = [0, 0, -0.01] }]\n";
    fs::write(here.join("scene.toml"), scene).unwrap();
    fs::write(here.join("b.inp"), common::deck([2, 2, 1])).unwrap();
    let run = |folder: &std::path::Path, arguments: &[&str]| {
        let all = [&["run", "scene.toml", "--out", "out"], arguments].concat();
        common::nagata(folder, 1, &all, folder.join("out"))
    };
    assert_eq!(run(&here, &["--steps", "1"]).code, 0);
    fs::rename(&here, &there).unwrap();
    let rest = run(&there, &["--restart"]);
    assert_eq!(rest.code, 0, "{}", rest.stderr);
    assert_eq!(rest.history().len(), 2);
    fs::write(there.join("b.inp"), common::deck([2, 2, 2])).unwrap();
    let other = run(&there, &["--restart"]);
    assert!(other.code == 2 && other.stderr.contains("the file b.inp has other content"), "{}", other.stderr);
}
