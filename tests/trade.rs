//! `nagata trade` as a user meets it: sweeps of a tiny scene from the command to the tables.

mod common;

use common::{Bench, History, jobs, mpirun};
use nagata::scene;
use nagata::trade::plan::{Plan, Wishes};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::SystemTime;

/// A roller that is pressed into a pad and drawn along it.
const SCENE: &str = r#"title = "A roller on a pad"

[body.pad]
material = "rubber"
plane_strain = true

[body.pad.block]
box = { size = [8.0, 2.0, 0.5] }
elements = [16, 4, 1]
faces = { bottom = "ymin", top = "ymax" }

[material.rubber]
model = "neo-hookean"
young = 6.0
poisson = 0.4

[tool.roller]
cylinder = { point = [3.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }

[contact.tread]
slave = "pad.top"
master = "roller"
friction = 0.3

[[step]]
name = "press"
increments = 4
fix = [{ set = "pad.bottom" }]
move = [{ target = "roller", by = [0.0, -0.4, 0.0] }]

[[step]]
name = "drag"
increments = 8
fix = [{ set = "pad.bottom" }]
move = [{ target = "roller", by = [1.0, 0.0, 0.0] }]

[output]
history = ["pad.bottom"]
"#;

/// What is varied: one setting twice, two that go together, and one that no run can have.
const TRADE: &str = r#"
[trade]
reference = ["solver.pace=0.25"]
next = ["solver.pace=0.5"]
vary = [
    { key = "contact.tread.method", values = ["penalty", "uzawa"] },
    { name = "rough", set = ["solver.pace=4.0", "solver.tolerance=1e-4"] },
    { key = "contact.tread.slave", values = ["pad.tp"] },
]
"#;

/// `nagata trade scene.toml` in the folder of a bench, without `mpirun`.
fn command(bench: &Bench, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nagata"));
    // The environment of runs under `mpirun`, but for what makes a process a rank.
    let environment = mpirun(1);
    command.envs(environment.get_envs().filter_map(|(name, value)| Some((name, value?))));
    command.arg("trade").arg("scene.toml").args(["--out", "out"]).args(arguments).current_dir(bench.path(""));
    command
}

fn trade(bench: &Bench, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } = command(bench, arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (status.code().unwrap_or(-1), text(&stdout), text(&stderr))
}

fn succeeds(bench: &Bench, arguments: &[&str]) -> (String, String) {
    let (code, stdout, stderr) = trade(bench, arguments);
    assert_eq!(code, 0, "{stdout}\n{stderr}");
    (stdout, stderr)
}

/// `trade.csv`: rows by run, cells by column. No cell of these scenes has a comma.
fn rows(bench: &Bench) -> BTreeMap<String, BTreeMap<String, String>> {
    let text = fs::read_to_string(bench.path("out/trade.csv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(str::to_string).collect();
    let row = |line: &str| -> BTreeMap<String, String> {
        let cells: Vec<String> = line.split(',').map(str::to_string).collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        names.iter().cloned().zip(cells).collect()
    };
    lines
        .map(row)
        .map(|row| (if row["run"].is_empty() { row["kind"].clone() } else { row["run"].clone() }, row))
        .collect()
}

fn history(bench: &Bench, run: &str) -> History {
    History::read(&bench.path(&format!("out/runs/{run}/history.csv")))
}

/// Largest difference of the forces of roller and support, over the largest force of the second, row by row.
fn forces_apart(a: &History, b: &History) -> f64 {
    let (mut off, mut scale) = (0.0f64, 0.0f64);
    let vectors = |history: &History, row: usize| {
        ["fx", "fy", "fz"].map(|component| history.column(&format!("roller.{component}"))[row])
    };
    for row in 0..b.len() {
        let (a, b) = (vectors(a, row), vectors(b, row));
        off = off.max((0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt());
        scale = scale.max(b.iter().map(|f| f * f).sum::<f64>().sqrt());
    }
    off / scale
}

#[test]
fn a_sweep_shows_errors_and_costs_and_failures() {
    let bench = Bench::new(&format!("{SCENE}{TRADE}"));
    let (stdout, stderr) = succeeds(&bench, &["--reference", "solver.tolerance=1e-11"]);
    let rows = rows(&bench);
    // The reference of the command line takes the place of that of the scene, and has the increments of the others.
    let number =
        |run: &str, column: &str| rows[run][column].parse::<f64>().unwrap_or_else(|_| panic!("{run} {column}"));
    for run in ["method=penalty", "method=uzawa"] {
        let folder = format!("contact.tread.{run}");
        let expected = forces_apart(&history(&bench, &folder), &history(&bench, "reference"));
        let found = number(&folder, "force");
        assert!((found - expected).abs() <= 1e-12 * expected, "{run}: {found} {expected}");
        let deepest = history(&bench, &folder).column("tread.max_penetration").iter().fold(0.0f64, |a, &b| a.max(b));
        assert_eq!(number(&folder, "penetration"), deepest);
    }
    // The penalty method is off by as much as it lets nodes through, Uzawa's method by the tolerance.
    assert!((1e-3..1e-1).contains(&number("contact.tread.method=penalty", "force")));
    assert!(number("contact.tread.method=uzawa", "force") < 1e-7);
    assert!(number("contact.tread.method=penalty", "stress") > 1e-3);
    assert!(number("contact.tread.method=penalty", "pressure") > 1e-3);
    // Drawn at a fourfold pace, three increments are left.
    assert_eq!(rows["rough"]["increments"], "3");
    assert!(number("rough", "force") > 1e-3);
    let failed = &rows["contact.tread.slave=pad.tp"];
    assert_eq!((failed["kind"].as_str(), failed["code"].as_str()), ("failed", "2"));
    assert!(failed["reason"].contains("body `pad` has no group `tp`"), "{}", failed["reason"]);
    assert!(stdout.contains("contact.tread.slave=pad.tp: failed, exit code 2: "), "{stdout}");
    assert_eq!(rows["reference"]["kind"], "reference");
    assert_eq!(rows["reference"]["force"], "");
    let next = number("next to the reference", "force");
    assert_eq!(number("reference error", "force"), next, "the reference may be off by as much as the next differs");
    for row in rows.values().filter(|row| row["kind"] == "run") {
        assert!(row["cpu_s"].parse::<f64>().unwrap() > 0.0 && row["memory_mb"].parse::<f64>().unwrap() > 1.0);
    }
    let markdown = fs::read_to_string(bench.path("out/trade.md")).unwrap();
    assert!(markdown.contains("`solver.pace=4.0` `solver.tolerance=1e-4`"), "{markdown}");
    for name in ["wall.svg", "cpu.svg", "memory.svg"] {
        assert!(fs::read_to_string(bench.path(&format!("out/{name}"))).unwrap().ends_with("</svg>\n"));
    }
    assert!(stderr.contains("1 of 7: as it is"), "{stderr}");
}

/// When the results of a run were written.
fn written(bench: &Bench) -> BTreeMap<String, SystemTime> {
    let runs = fs::read_dir(bench.path("out/runs")).unwrap().map(|entry| entry.unwrap());
    let time = |path: &Path| path.join("summary.json").metadata().ok()?.modified().ok();
    runs.filter_map(|run| Some((run.file_name().into_string().unwrap(), time(&run.path())?))).collect()
}

#[test]
fn finished_runs_are_not_made_again() {
    let bench = Bench::new(&format!("{SCENE}{TRADE}"));
    succeeds(&bench, &["--no-combined"]);
    let first = written(&bench);
    assert_eq!(first.len(), 6, "{first:?}");
    // One is lost, and of another only a half is left.
    fs::remove_dir_all(bench.path("out/runs/rough")).unwrap();
    let half = "contact.tread.method=uzawa";
    fs::remove_file(bench.path(&format!("out/runs/{half}.json"))).unwrap();
    let (_, stderr) = succeeds(&bench, &["--no-combined"]);
    let again: Vec<String> =
        written(&bench).into_iter().filter(|(k, t)| first.get(k) != Some(t)).map(|(k, _)| k).collect();
    assert_eq!(again, [half, "rough"]);
    assert_eq!(stderr.matches("(as before)").count(), 5, "{stderr}");
    // The failure is known, too; other settings, or the wish, make all anew.
    assert!(stderr.contains("pad.tp: failed: ") && stderr.contains("`tp` (as before)"), "{stderr}");
    bench.write("scene.toml", &format!("{SCENE}{}", TRADE.replace("\"uzawa\"", "\"uzawa\", \"lagrange\"")));
    let (_, stderr) = succeeds(&bench, &["--no-combined"]);
    assert_eq!(stderr.matches("(as before)").count(), 7, "what is varied is no part of a run: {stderr}");
    for arguments in [&["--no-combined", "--set", "material.rubber.young=7"][..], &["--no-combined", "--fresh"]] {
        let (before, (_, stderr)) = (written(&bench), succeeds(&bench, arguments));
        assert_eq!(stderr.matches("(as before)").count(), 0, "{stderr}");
        assert!(written(&bench).iter().all(|(run, time)| before[run] != *time));
    }
}

/// What stands at a time between values at increasing times, 0 at the start.
fn linear(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.iter().position(|&t| t >= time).unwrap();
    let (begin, first) = if after == 0 { (0.0, 0.0) } else { (times[after - 1], values[after - 1]) };
    first + (time - begin) / (times[after] - begin) * (values[after] - first)
}

#[test]
fn what_is_known_exactly_takes_the_place_of_the_reference() {
    let exact = r#"exact = [
        { of = "roller.fy", value = -2.5, step = "press" },
        { of = "pad.bottom.fy", curve = [[0.5, 1.0], [1.0, 2.5], [1.5, 2.0]] },
        { of = "tread.mean_pressure", curve = [[1.0, 1.0], [2.0, 1.0]] },
    ]"#;
    let bench = Bench::new(&format!("{SCENE}{TRADE}{exact}"));
    let (stdout, _) = succeeds(&bench, &["--no-combined"]);
    let rows = rows(&bench);
    for (run, folder) in [("reference", "reference"), ("as it is", "as_it_is")] {
        let history = history(&bench, folder);
        let end = history.steps.iter().rposition(|step| step == "press").unwrap();
        let mut expected = (history.column("roller.fy")[end] + 2.5).abs() / 2.5;
        // At all times of the reference, with the run linear between its own.
        for &time in self::history(&bench, "reference").column("time") {
            let force = linear(history.column("time"), history.column("pad.bottom.fy"), time);
            let exact = if time <= 1.0 { 1.0 + 3.0 * (time - 0.5) } else { 2.5 - (time - 1.0) };
            if (0.5..=1.5).contains(&time) {
                expected = expected.max((force - exact).abs() / 2.5);
            }
        }
        let found = rows[run]["force"].parse::<f64>().unwrap();
        assert!((found - expected).abs() < 1e-14, "{run}: {found} {expected}");
        assert_ne!(rows[run]["pressure"], "");
    }
    assert_eq!(rows["reference error"]["force"], "");
    assert!(stdout.contains("pressure"), "{stdout}");
}

#[test]
fn wrong_entries_are_refused() {
    let cases = [
        ("[trade]\nvry = []", "unknown key `vry` in trade"),
        ("[trade]\nvary = [{ key = \"solver.pace\" }]", "must have either `key` and `values`, or `name` and `set`"),
        ("[trade]\nvary = [{ key = \"solver.pac\", values = [2] }]", "unknown key `pac`"),
        ("[trade]\nvary = [{ key = \"solver.pace\", values = [-2] }]", "scene.toml:40:9: --set solver.pace=-2: "),
        ("[trade]\nvary = [{ key = \"solver.pace\", values = [{ a = 1 }] }]", "must be a number, a string"),
        ("[trade]\nvary = [{ name = \"a\", set = [\"solver.pace\"] }]", "the override has no `=`"),
        ("[trade]\nset = [\"solver.linear=fast\"]", "cannot be \"fast\""),
        ("[trade]\nreference = [\"solver.linear=fast\"]", "cannot be \"fast\""),
        ("[trade]\nnext = [\"solver.pace=0.5\"]", "stands without `reference`"),
        ("[trade]\nexact = [{ of = \"roller.fy\" }]", "must have either `value`"),
        ("[trade]\nexact = [{ of = \"roller.fy\", value = 0 }]", "must be other than 0"),
        ("[trade]\nexact = [{ of = \"roler.fy\", value = 1 }]", "did you mean `roller`?"),
        ("[trade]\nexact = [{ of = \"roller.q\", value = 1 }]", "cannot be compared with something exact"),
        ("[trade]\nexact = [{ of = \"roller.fy\", value = 1, step = \"prss\" }]", "did you mean `press`?"),
        ("[trade]\nexact = [{ of = \"roller.fy\", curve = [[1, 1], [1, 2]] }]", "whose times increase"),
        (
            "[trade]\nexact = [{ of = \"roller.fy\", curve = [[5, 1], [6, 2]] }]",
            "one of the run, which goes from 0 to 2",
        ),
        ("[trade]\nexact = [{ of = \"pad.plastic_strain_99\", value = 1 }]", "none of its materials flows"),
        ("[trade]\nsteps = 0", "must be 1 or more"),
    ];
    for (table, words) in cases {
        let bench = Bench::new(&format!("{SCENE}{table}\n"));
        let (code, _, stderr) = trade(&bench, &[]);
        assert_eq!(code, 2, "{table}: {stderr}");
        assert!(stderr.contains(words), "{table}: {stderr}");
        assert!(!bench.path("out").exists(), "{table}");
    }
    let bench = Bench::new(SCENE);
    for arguments in [
        &["--vary", "solver.pace"][..],
        &["--vary", "solver.pace=2,0"],
        &["--reference", "body.pad.mesh=1"],
        &["--next", "solver.pace=1"],
        &["--ranks", "0"],
        &["--budget", "-1"],
    ] {
        let (code, _, stderr) = trade(&bench, arguments);
        assert_eq!(code, 2, "{arguments:?}: {stderr}");
    }
    let run = common::nagata(&bench.path(""), 2, &["trade", "scene.toml"], bench.path("out"));
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert_eq!(run.stderr.matches("give it --ranks N").count(), 1, "{}", run.stderr);
}

/// Without the reference there is nothing to compare: its own exit code, and what it said.
#[test]
fn a_reference_that_fails_ends_the_study() {
    let bench = Bench::new(SCENE);
    let (code, _, stderr) = trade(&bench, &["--reference", "contact.tread.slave=pad.tp"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("the run `reference` failed, without which there is nothing to compare"), "{stderr}");
    assert!(stderr.contains("has no group `tp`"), "{stderr}");
}

/// One that nobody asked for gives its place to the next; here elements cannot be split once more.
#[test]
fn a_suggested_reference_that_fails_gives_its_place_to_the_next() {
    let scene = "[body.pad]\nmaterial = \"rubber\"\nplane_strain = true\nrefine = 6\n\
                 block = { box = { size = [1, 1, 1] }, elements = [1, 1, 1] }\n\
                 [material.rubber]\nmodel = \"neo-hookean\"\nyoung = 6.0\npoisson = 0.4\n\
                 [[step]]\nincrements = 2\nfix = [{ set = \"pad.ymin\" }]\n\
                 move = [{ target = \"pad.ymax\", by = [0, -0.1, 0] }]\n[output]\nhistory = [\"pad.ymin\"]\n";
    let bench = Bench::new(scene);
    let (_, stderr) = succeeds(&bench, &["--vary", "solver.tolerance=1e-6", "--no-combined"]);
    assert!(stderr.contains("`reference without split` takes its place"), "{stderr}");
    let table = fs::read_to_string(bench.path("out/trade.csv")).unwrap();
    assert!(
        table.contains(",reference,failed,2,") && table.contains(",reference without split,reference,0,"),
        "{table}"
    );
}

/// A signal ends the run under way; what is finished is not made again.
#[test]
fn a_signal_ends_the_run_and_keeps_the_others() {
    let bench = Bench::new(SCENE);
    let slow = "solver.pace=0.001";
    let arguments = ["--reference", "solver.tolerance=1e-11", "--vary", slow, "--no-combined", "--limit", "100000"];
    let mut job = command(&bench, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let begun = bench.path(&format!("out/runs/{slow}/history.csv"));
    jobs::wait_for(&mut job, "the slow run", |_| begun.exists().then_some(()));
    let children = jobs::children(job.id());
    assert_eq!(children.len(), 1);
    let asked = Command::new("kill").args(["-TERM", &job.id().to_string()]).status().unwrap();
    assert!(asked.success());
    let code = jobs::wait_for(&mut job, "the end", |job| job.try_wait().unwrap()).code();
    assert_eq!(code, Some(4));
    assert!(!Path::new(&format!("/proc/{}", children[0])).exists(), "the run goes on");
    let kept = written(&bench);
    let (_, stderr) = succeeds(&bench, &["--reference", "solver.tolerance=1e-11", "--vary", "solver.pace=4"]);
    assert_eq!(stderr.matches("(as before)").count(), 2, "{stderr}");
    assert!(["as_it_is", "reference"].iter().all(|run| kept[*run] == written(&bench)[*run]));
}

#[test]
fn a_run_that_takes_too_long_is_stopped_and_shown() {
    let bench = Bench::new(SCENE);
    let arguments = ["--reference", "solver.tolerance=1e-11", "--vary", "solver.pace=0.001", "--limit", "5"];
    succeeds(&bench, &arguments);
    let row = &rows(&bench)["solver.pace=0.001"];
    assert!(row["reason"].starts_with("stopped after 5 s"), "{row:?}");
    assert_eq!(row["code"], "");
}

/// Ranks number nodes and elements otherwise; the results are the same.
#[test]
fn runs_on_two_ranks_are_compared_alike() {
    let mut errors = Vec::new();
    for ranks in ["1", "2"] {
        let bench = Bench::new(&format!("{SCENE}{TRADE}"));
        succeeds(&bench, &["--ranks", ranks, "--no-combined"]);
        let row = rows(&bench)["contact.tread.method=penalty"].clone();
        errors.push(["force", "pressure", "stress", "peak_stress"].map(|of| row[of].parse::<f64>().unwrap()));
    }
    for (one, two) in errors[0].iter().zip(errors[1]) {
        assert!((one - two).abs() < 1e-9, "{errors:?}");
    }
}

/// What a scene suggests can be read, fits into the budget, and has nothing that the scene is already.
#[test]
fn scenes_suggest_what_can_be_run() {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let mut count = 0;
    for entry in fs::read_dir(inputs).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.extension().is_none_or(|end| end != "toml") {
            continue;
        }
        let (plan, scene) = Plan::new(&entry, &Wishes { budget: 20.0, ..Wishes::default() }).unwrap();
        let cost: f64 = plan.runs.iter().filter_map(|run| run.cost).sum();
        assert!(cost <= 20.0 && plan.runs.len() >= 6, "{}: {cost}, {} runs", entry.display(), plan.runs.len());
        for run in &plan.runs {
            let all: Vec<String> = plan.common.iter().chain(&run.overrides).cloned().collect();
            let changed = scene::load(&entry, &all).unwrap_or_else(|error| panic!("{}: {error}", entry.display()));
            assert_eq!(changed.text == scene.text, run.overrides.is_empty(), "{}: {}", entry.display(), run.label);
        }
        count += 1;
    }
    assert!(count > 10);
}
