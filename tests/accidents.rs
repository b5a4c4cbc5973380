//! Accidents of a run: another one in its folder, signals, full disks, want of memory, tools that run away. What was
//! there stays, what converged is kept, all ranks end with one message, and nothing hangs.

mod common;

use common::jobs::{BLOCK_UNDER_PLATE, Job, children, rows_in, send, shown_times, wait_for};
use common::{Bench, History, Run, assert_small, deck, mpirun, nagata};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Pressed in very many increments, with fields seldom.
const STEP: &str = r#"[[step]]
name = "press"
increments = 100000
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.5] }]

[output]
every = 100000
"#;

/// The block, its plate and the step.
fn scene() -> String {
    format!("{BLOCK_UNDER_PLATE}{STEP}")
}

fn results(bench: &Bench) -> Run {
    Run::of(bench.path("out"))
}

/// The fields of the last converged increment are written, the summary tells of the signal, and nothing else is left.
fn ended_in_order(bench: &Bench, signal: &str, (code, said): (i32, String)) {
    assert_eq!(code, 4, "{said}");
    assert!(said.starts_with(&format!("error: {signal} ended the run in step `press`, after time 0.")), "{said}");
    assert_eq!(said.matches("error:").count(), 1, "{said}");
    let run = results(bench);
    assert!(run.log().contains(&said), "{}", run.log());
    let (history, summary) = (run.history(), run.summary());
    assert_eq!((&summary["interrupted"], &summary["converged"]), (&true.into(), &false.into()));
    assert_eq!(summary["increments"], history.len());
    assert!(history.len() < 100000);
    assert_eq!(shown_times(&run.out), [history.last("time")]);
    let moved = run.field("increments/000001/tool_plate/node/displacement");
    assert_small("motion of the plate", moved[2] - history.last("plate.uz"), 1e-12);
    let there = |name: &&&str| run.out.join(name).exists();
    let written: Vec<_> = nagata::output::RUN.iter().filter(there).collect();
    // A report has not been asked for, and no increment has failed, which makes two files.
    assert_eq!(
        (std::fs::read_dir(&run.out).unwrap().count(), written.len()),
        (nagata::output::results_in(&run.out).len() - 3, nagata::output::RUN.len() - 3)
    );
}

#[test]
fn a_second_run_is_refused_and_the_first_goes_on() {
    let bench = Bench::new(&scene());
    let job = Job::start(&bench, 2, 3, &[]);
    let rows = rows_in(&bench.path("out"));
    let second = nagata(&bench.path(""), 2, &["run", "scene.toml", "--out", "out"], bench.path("out"));
    assert_eq!(second.code, 2, "{}", second.stderr);
    let holder = format!("error: another run writes to output folder out, process {} on ", job.ranks[0]);
    assert!(second.stderr.starts_with(&holder), "{}", second.stderr);
    assert!(second.stderr.contains("--out DIR") && second.stderr.matches("error:").count() == 1);
    let mut job = job;
    wait_for(&mut job.child, "more rows", |_| (rows_in(&bench.path("out")) > rows + 2).then_some(()));
    // What mpirun passes on.
    send("USR1", job.child.id());
    ended_in_order(&bench, "SIGUSR1", job.end());
}

/// One rank's word is enough; the next run takes the folder over.
#[test]
fn a_signal_to_one_rank_ends_all_in_order() {
    let bench = Bench::new(&scene());
    for (ranks, victim, signal) in [(2, 1, "TERM"), (1, 0, "INT")] {
        let job = Job::start(&bench, ranks, 3, &[]);
        send(signal, job.ranks[victim]);
        ended_in_order(&bench, &format!("SIG{signal}"), job.end());
    }
    let again = nagata(
        &bench.path(""),
        2,
        &["run", "scene.toml", "--out", "out", "--set", "step.press.increments=2"],
        bench.path("out"),
    );
    assert_eq!((again.code, again.history().len()), (0, 2), "{}", again.stderr);
    assert_eq!(again.summary()["interrupted"], false);
}

/// While the model is set up, too: a run that reads its mesh from a pipe ends before its first increment.
#[test]
fn a_signal_during_the_set_up_ends_the_run_in_order() {
    let text = scene();
    let block = text.lines().find(|line| line.starts_with("block = ")).unwrap();
    let bench = Bench::new(&text.replace(block, "mesh = \"block.inp\""));
    let pipe = bench.path("block.inp");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut command = mpirun(1);
    command.args(["run", "scene.toml", "--out", "out"]).current_dir(bench.path("")).stderr(Stdio::piped());
    let mut job = Job { child: command.spawn().unwrap(), ranks: Vec::new() };
    // Of the signals that a process catches SIGUSR1 is the tenth.
    let catches = |pid: &u32| {
        let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap_or("0");
        status.starts_with("Name:\tnagata\n") && u64::from_str_radix(mask.trim(), 16).unwrap() & (1 << 9) != 0
    };
    let ready = |job: &mut Child| children(job.id()).into_iter().find(|pid| catches(pid));
    job.ranks = vec![wait_for(&mut job.child, "signals to be caught", ready)];
    send("USR1", job.ranks[0]);
    let mut end = std::fs::File::options().write(true).open(&pipe).unwrap();
    // Whoever reads it again finds a file.
    bench.write("mesh.inp", &deck([2, 2, 2]));
    std::fs::rename(bench.path("mesh.inp"), &pipe).unwrap();
    end.write_all(deck([2, 2, 2]).as_bytes()).unwrap();
    drop(end);
    let (code, said) = job.end();
    assert!(code == 4 && said.starts_with("error: SIGUSR1 ended the run in step `press`, after time 0.0000"), "{said}");
    let run = results(&bench);
    assert_eq!((&run.summary()["increments"], &run.summary()["interrupted"]), (&0.into(), &true.into()));
    assert!(bench.path("out/checkpoint.h5").exists());
}

/// The scene that a run has saved, run into its own folder.
#[test]
fn nothing_is_deleted_for_a_run_that_is_refused() {
    let bench = Bench::new(&scene());
    let first = bench.solve(2, &["--set", "step.press.increments=2"]);
    let all = || {
        let mut files: Vec<_> = std::fs::read_dir(&first.out).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (std::fs::read(&path).unwrap(), path)).collect::<Vec<_>>()
    };
    let before = all();
    for (scene, words) in [("scene.toml", "overwrite its own scene file"), ("../scene.toml", "`nowhere`")] {
        let bad = if scene == "scene.toml" { "step.press.increments=2" } else { "contact.top.master=nowhere" };
        let run = nagata(&first.out, 2, &["run", scene, "--out", ".", "--set", bad], first.out.clone());
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains(words), "{}", run.stderr);
        assert!(before == all(), "{scene}");
    }
}

/// A limit on the size of files stands for a full disk: of one rank or of all, it ends all.
#[test]
fn a_full_disk_ends_all_ranks() {
    for room in [0, 20_000] {
        let bench = Bench::new(&scene());
        let job = Job::start(&bench, 2, 3, &["--set", "output.every=1"]);
        let fields = bench.path("out/fields.h5");
        let size = std::fs::metadata(&fields).unwrap().len();
        let limit = format!("--fsize={}", size + room);
        assert!(Command::new("prlimit").args(["--pid", &job.ranks[0].to_string(), &limit]).status().unwrap().success());
        let (code, said) = job.end();
        assert_eq!(code, 3, "{said}");
        assert!(said.starts_with("error: cannot write out/fields.h5: ") && said.lines().count() == 1, "{said}");
        let run = results(&bench);
        assert_eq!(run.summary()["converged"], false);
        let (times, history) = (shown_times(&run.out), run.history());
        let all = history.column("time");
        assert!(all.starts_with(&times) && times.len() + 1 == all.len(), "{times:?}\n{all:?}");
    }
}

/// What a full device takes nothing of is not said to be written.
#[test]
fn what_cannot_be_printed_is_an_error() {
    let bench = Bench::new(&scene());
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    for arguments in [vec!["schema"], vec!["check", "scene.toml"], vec!["trade", "scene.toml", "--list"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nagata"));
        let run = command.args(&arguments).current_dir(bench.path("")).stdout(full()).output().unwrap();
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(3), "{arguments:?}: {said}");
        assert!(said.contains("error: cannot write to the standard output: "), "{arguments:?}: {said}");
    }
}

/// MPI would take what stands before a colon for a kind of file system.
#[test]
fn a_folder_may_have_a_colon() {
    let bench = Bench::new(&scene());
    let out = bench.path("12:30:00/a b");
    let arguments = ["run", "scene.toml", "--out", "12:30:00/a b", "--set", "step.press.increments=1"];
    let run = nagata(&bench.path(""), 2, &arguments, out.clone());
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(shown_times(&out), [1.0]);
}

/// MUMPS's own limit stands for that of the machine. Smaller increments take as much memory.
#[test]
fn want_of_memory_ends_a_run_at_once() {
    let bench = Bench::new(&scene());
    let larger = ["--set", "body.block.block.elements=[10, 10, 10]", "--set", "step.press.increments=2"];
    for (ranks, options) in [(2, "-mat_mumps_icntl_23"), (1, "-mat_mumps_icntl_23")] {
        let run = bench.run(ranks, &[&larger[..], &["--", options, "1"]].concat());
        assert_eq!(run.code, 3, "{}\n{}", run.stdout, run.stderr);
        let error = run.stderr.lines().next().unwrap();
        assert!(
            error.starts_with("error: step `press`, after time 0.000000: linear solver: not enough memory"),
            "{error}"
        );
        assert!(error.contains("MUMPS INFOG(1) = -19") && error.contains(" MB"), "{error}");
        assert!(run.stderr.contains("help: run on more memory"), "{}", run.stderr);
        let summary = run.summary();
        assert_eq!((&summary["cutbacks"], &summary["increments"]), (&0.into(), &0.into()));
    }
}

/// Between what MUMPS 5.5 takes of memory for the factors of this block and what it takes beside them.
#[test]
fn factors_go_to_files_where_memory_ends() {
    let bench = Bench::new(&scene());
    let larger = ["solver.linear=direct", "body.block.block.elements=[14, 14, 14]", "step.press.increments=2"];
    let larger = larger.map(|set| ["--set", set]).concat();
    for (ranks, limit) in [(1, "40"), (2, "48")] {
        let plain = bench.solve(ranks, &larger);
        let run = bench.solve(ranks, &[&larger[..], &["--", "-mat_mumps_icntl_23", limit]].concat());
        assert!(!plain.log().contains("factors, which are kept in files"), "{}", plain.log());
        assert_eq!(run.log().matches("factors, which are kept in files").count(), 1, "{}", run.log());
        assert_eq!(run.summary()["linear_solver"], "MUMPS LU, SCOTCH, factors in files");
        assert_small("forces", plain.history().difference(&run.history()), 1e-9);
        let files = std::fs::read_dir(&run.out).unwrap().map(|file| file.unwrap().file_name());
        let left: Vec<_> = files.filter(|name| name.to_string_lossy().contains("mumps")).collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

#[test]
fn quiet_hides_no_warning() {
    let bench = Bench::new(&scene().replace("point = [0.0, 0.0, 2.0]", "point = [0.0, 0.0, 1.8]"));
    let warning = "warning: contact `top`: 9 nodes start inside the tool `plate`";
    let loud = bench.solve(2, &["--set", "step.press.increments=10"]);
    assert!(loud.stdout.contains(warning) && loud.stderr.is_empty(), "{}\n{}", loud.stdout, loud.stderr);
    let quiet = bench.solve(2, &["--set", "step.press.increments=10", "--quiet"]);
    assert_eq!(quiet.stdout, "");
    assert!(quiet.stderr.starts_with(warning) && quiet.stderr.lines().count() == 1, "{}", quiet.stderr);
}

/// A tool that is pulled off the block, from the start or after it was pressed on, is named at the first increment that
/// cannot be. One that is pulled along without friction is refused before.
#[test]
fn a_tool_that_runs_away_is_named() {
    let fix = r#"fix = [{ set = "block.bottom" }]"#;
    let step = |total: &str, directions: &str| {
        let force = format!(r#"force = [{{ target = "plate", total = {total}, directions = "{directions}" }}]"#);
        format!("[[step]]\nincrements = 4\n{fix}\n{force}\n")
    };
    for (ranks, steps, friction, converged, pull) in [
        (2, step("[0, 0, 20]", "z"), "0.2", 0, "(0.000e0, 0.000e0, 5.000e0): it pulls away from all 9 slave nodes"),
        (1, step("[0, 0, -8]", "z") + &step("[0, 0, 8]", "z"), "0.2", 6, "it pulls away from all 9 slave nodes"),
    ] {
        let run = Bench::new(&format!("{BLOCK_UNDER_PLATE}{steps}"))
            .run(ranks, &["--set", &format!("contact.top.friction={friction}")]);
        assert_eq!(run.code, 1, "{}\n{}", run.stdout, run.stderr);
        for words in ["nothing can hold the tool `plate` against its force ", pull, "help: check the sign of `total`"] {
            assert!(run.stderr.contains(words), "{words}\n{}", run.stderr);
        }
        let summary = run.summary();
        let iterations = summary["iterations"].as_u64().unwrap();
        assert!(summary["increments"] == converged && iterations < 80, "{summary}");
    }
    let along = step("[0, 0, -8]", "z") + &step("[4, 0, 0]", "x");
    let run = Bench::new(&format!("{BLOCK_UNDER_PLATE}{along}")).run(2, &["--set", "contact.top.friction=0.0"]);
    assert_eq!(run.code, 2, "{}\n{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("step `step 2`: tool `plate` can move along x"), "{}", run.stderr);
}

/// Contacts that come and go change the matrix between two analyses. It is regular all along, on one rank, too.
#[test]
fn regular_systems_are_not_singular() {
    let cantilever = Bench::new(
        r#"
        [body.b]
        material = "m"
        element = "hex8-eas"
        plane_strain = true
        block = { box = { size = [10.0, 0.5, 1.0] }, elements = [20, 1, 1] }
        [material.m]
        model = "hooke"
        young = 1000.0
        poisson = 0.3
        [tool.r]
        cylinder = { point = [8.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 0.5 }
        [contact.c]
        slave = "b.ymax"
        master = "r"
        [[step]]
        increments = 20
        fix = [{ set = "b.xmin" }]
        move = [{ target = "r", by = [0.0, -1.0, 0.0] }]
        "#,
    );
    // With scaling by the values of the analysis, null pivots are found that are none: they are tried as they are.
    let stale = ["--", "-mat_mumps_icntl_8", "77"];
    let runs = [cantilever.solve(2, &[]), cantilever.solve(1, &[]), cantilever.solve(1, &stale)];
    for run in &runs {
        assert_eq!(run.summary()["cutbacks"], 0);
        assert!(!run.log().contains("null pivots"), "{}", run.log());
        assert_small("difference", run.history().difference(&runs[0].history()), 1e-9);
    }
}

/// Kills and signals at random times, to ranks and to mpirun, with the folder taken over from one run to the next. Run it
/// with `cargo test --release --test accidents -- --ignored --nocapture`.
#[test]
#[ignore = "some minutes"]
fn fifty_kills_and_signals() {
    let bench = Bench::new(&scene());
    let out = bench.path("out");
    let mut seed = 13u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 33) % below
    };
    println!("  no  ranks  signal  to      after/ms  code  end/ms  rows  fields  summary");
    for number in 1..=50 {
        let ranks = 1 + random(3) as usize;
        let signal = ["KILL", "TERM", "INT", "USR1"][random(4) as usize];
        let every = [1, 1, 5, 100000][random(4) as usize];
        let mut job = Job::start(&bench, ranks, 1, &["--set", &format!("output.every={every}")]);
        let (wait, victim) = (random(600), random(ranks as u64 + 1) as usize);
        std::thread::sleep(Duration::from_millis(wait));
        let (to, name) = match job.ranks.get(victim) {
            Some(rank) => (*rank, format!("rank {victim}")),
            None => (job.child.id(), "mpirun".to_string()),
        };
        let (pids, sent) = (job.ranks.clone(), Instant::now());
        send(signal, to);
        let status = wait_for(&mut job.child, "the end of the job", |job| job.try_wait().unwrap());
        // mpirun, killed, leaves ranks that notice it by themselves.
        let gone = || pids.iter().all(|pid| !Path::new(&format!("/proc/{pid}")).exists());
        wait_for(&mut job.child, "the end of the ranks", |_| gone().then_some(()));
        let (code, took) = (status.code().unwrap_or(-1), sent.elapsed().as_millis());

        let history = History::read(&out.join("history.csv"));
        let shown = if out.join("fields.xdmf").exists() { shown_times(&out) } else { Vec::new() };
        let all = history.column("time");
        assert!(shown.iter().all(|time| all.contains(time)), "{shown:?}\n{all:?}");
        if every == 1 {
            // A kill between the two files may leave the fields one increment behind.
            assert!(all.starts_with(&shown) && shown.len() + 1 >= all.len(), "{shown:?}\n{all:?}");
        }
        let summary = out.join("summary.json").exists();
        if summary && results(&bench).summary()["converged"] == false {
            assert_eq!(shown.last(), all.last(), "the last state is shown");
        }
        // What a rank is asked to do, it does in order; so do those that mpirun passes USR1 on to.
        if signal != "KILL" && (name != "mpirun" || signal == "USR1") {
            assert!(summary && [0, 4].contains(&code), "{code}");
        }
        println!(
            "{number:4}  {ranks:5}  {signal:6}  {name:6}  {wait:8}  {code:4}  {took:6}  {:4}  {:6}  {summary}",
            all.len(),
            shown.len()
        );
    }
    let last = nagata(
        &bench.path(""),
        2,
        &["run", "scene.toml", "--out", "out", "--set", "step.press.increments=3"],
        out.clone(),
    );
    assert_eq!((last.code, last.history().len()), (0, 3), "{}", last.stderr);
    let single = |name: &String| name.starts_with("fields-");
    let single = nagata::output::results_in(&out).into_iter().filter(single).count();
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 6 + single);
}
