//! The commands and flags as a user meets them.

mod common;

use clap::{CommandFactory, Parser};
use common::{Bench, Run, deck, nagata};
use nagata::cli::Cli;
use nagata::scene;
use std::fs;
use std::path::Path;

/// A slab of cubes under a plate that presses, then slides. The mesh lies in a folder beside the scene.
const SCENE: &str = r#"title = "Press and slide" # two steps

[body.slab]
material = "rubber"
mesh = "meshes/slab.inp"

[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3

[tool.plate]
plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }

[contact.top]
slave = "slab.top"
master = "plate"
friction = 0.2

[[step]]
name = "press"
increments = 2
fix = [{ set = "slab.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.1] }]

[[step]]
name = "slide"
increments = 2
fix = [{ set = "slab.bottom", directions = "z" }, { set = "slab.edge" }]
move = [{ target = "plate", by = [0.05, 0.0, 0.0] }]
"#;

fn bench() -> Bench {
    let bench = Bench::new(SCENE);
    fs::create_dir(bench.path("meshes")).unwrap();
    bench.write("meshes/slab.inp", &deck([2, 2, 1]));
    bench
}

/// Runs on two ranks in the folder with any arguments; exit code 0 is asserted.
#[track_caller]
fn succeeds(bench: &Bench, arguments: &[&str]) -> Run {
    let run = nagata(&bench.path(""), 2, arguments, bench.path("out/scene"));
    assert_eq!(run.code, 0, "{}\n{}", run.stdout, run.stderr);
    run
}

/// Help needs no memory for MPI; what is wrong in the command line is told first.
#[test]
fn help_needs_little_memory() {
    for (words, code, says) in
        [("--help", 0, "Usage: nagata"), ("bogus", 2, "subcommand 'bogus'"), ("schema", 3, "memory")]
    {
        let command = format!("ulimit -v 200000; exec '{}' {words}", env!("CARGO_BIN_EXE_nagata"));
        let done = std::process::Command::new("sh").args(["-c", &command]).output().unwrap();
        let said = String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned();
        assert!(done.status.code() == Some(code) && said.contains(says), "{words}: {said}");
    }
}

#[test]
fn the_version_names_the_libraries() {
    let run = succeeds(&bench(), &["--version"]);
    let text = run.stdout.trim_end();
    assert!(text.starts_with(&format!("nagata {} (PETSc 3.", env!("CARGO_PKG_VERSION"))), "{text}");
    for library in ["MUMPS 5.", "METIS 5.", "HDF5 1.", "Open MPI v"] {
        assert_eq!(text.matches(library).count(), 1, "{text}");
    }
    assert_eq!(text.lines().count(), 1, "said once on two ranks");
}

#[test]
fn help_is_plain_text_and_said_once() {
    let bench = bench();
    let run = succeeds(&bench, &["run", "--help"]);
    for words in [
        "Usage: nagata run [OPTIONS] <SCENE> [-- PETSC OPTIONS]",
        "--set <KEY=VALUE>",
        "--out <DIR>",
        "--steps <N>",
        "--quiet",
    ] {
        assert_eq!(run.stdout.matches(words).count(), 1, "{words}\n{}", run.stdout);
    }
    let all = succeeds(&bench, &["--help"]).stdout;
    assert!(["  run ", "  check ", "Exit codes: 0 converged"].iter().all(|words| all.contains(words)), "{all}");
    assert!(!run.stdout.contains('\x1b') && !all.contains('\x1b'));
    assert_eq!(run.stderr, "");
}

/// Also of what does not run under mpirun.
#[test]
fn help_is_had_under_mpirun() {
    let bench = bench();
    for name in ["trade", "convert"] {
        let run = succeeds(&bench, &[name, "--help"]);
        assert_eq!(run.stdout.matches(&format!("Usage: nagata {name}")).count(), 1, "{}", run.stdout);
    }
}

/// Every help ends with examples: commands that are read, of its subcommand, whose scenes have what is overridden.
#[test]
fn help_has_examples_that_are_right() {
    let scratch = tempfile::tempdir().unwrap();
    let first = scratch.path().join("first.toml");
    scene::begin(&first).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Cli::command();
    let own = all.render_long_help().to_string();
    let commands = all.get_subcommands_mut().filter(|own| own.get_name() != "help");
    let helps = commands.map(|own| (own.get_name().to_string(), own.render_long_help().to_string()));
    let helps: Vec<_> = [(String::new(), own)].into_iter().chain(helps).collect();
    assert!(helps.len() > 9);
    for (name, help) in &helps {
        let (_, lines) = help.split_once("\n\nExamples:\n").unwrap_or_else(|| panic!("`{name}` has no examples"));
        assert!((2..=3).contains(&lines.lines().count()), "{name}: {lines}");
        for line in lines.lines() {
            let words: Vec<&str> = line.split(" > ").next().unwrap().split_whitespace().collect();
            let words = words.strip_prefix(&["mpirun", "-n", "2"]).unwrap_or(&words);
            assert!(words[0] == "nagata" && (name.is_empty() || words[1] == name), "{name}: {line}");
            Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{line}: {error}"));
            let overrides = words.windows(2).filter(|pair| ["--set", "--reference"].contains(&pair[0]));
            let overrides: Vec<String> = overrides.map(|pair| pair[1].into()).collect();
            let scenes = words.iter().filter(|word| **word == "first.toml" || word.starts_with("inputs/"));
            for scene in scenes {
                let path = if *scene == "first.toml" { first.clone() } else { root.join(scene) };
                scene::load(&path, &overrides).unwrap_or_else(|error| panic!("{line}: {error}"));
            }
        }
    }
}

/// The number before `unit` in a text.
fn number(text: &str, unit: &str) -> u64 {
    let before = text.split(unit).next().unwrap().trim_end();
    before
        .rsplit(|c: char| !c.is_ascii_digit())
        .next()
        .unwrap()
        .parse()
        .unwrap_or_else(|e| panic!("{unit}: {e}\n{text}"))
}

#[test]
fn check_tells_what_run_then_does() {
    let bench = bench();
    for (friction, kind, factorization) in
        [("0.2", "unsymmetric", "MUMPS LU"), ("0.0", "symmetric indefinite", "MUMPS LDL^T")]
    {
        let set = format!("contact.top.friction={friction}");
        let check = succeeds(&bench, &["check", "scene.toml", "--set", &set]);
        assert!(check.stderr.is_empty() && !bench.path("out").exists());
        let text = &check.stdout;
        for words in [
            "Press and slide\n",
            "body `slab`: hex8, neo-hookean",
            "tool `plate`: rigid, exact plane",
            "contact `top`: 9 slave nodes",
        ] {
            assert!(text.contains(words), "{words}\n{text}");
        }
        let step = |name: &str| text.lines().find(|line| line.starts_with(&format!("step `{name}`: "))).unwrap();
        for (count, name) in [("1", "press"), ("2", "slide")] {
            let run = bench.solve(2, &["--quiet", "--steps", count, "--set", &set]);
            let (summary, line) = (run.summary(), step(name));
            assert_eq!(number(line, " dofs"), summary["dofs"]);
            assert_eq!(number(line, " multipliers"), summary["multipliers"]);
            assert_eq!(number(text, " elements"), summary["elements"]);
            assert!(line.contains(&format!(" {kind} matrix with ")) && summary["matrix"] == kind, "{line}");
            assert!(summary["linear_solver"].as_str().unwrap().starts_with(factorization));
            assert!(line.ends_with(factorization), "{line}");
        }
        // The second step frees nodes of the bottom.
        assert!(number(step("slide"), " dofs") > number(step("press"), " dofs"));
    }
}

#[test]
fn only_so_many_steps_are_run() {
    let bench = bench();
    let run = bench.solve(2, &["--steps", "1"]);
    assert_eq!(run.history().steps, ["press", "press"]);
    assert_eq!(run.summary()["increments"], 2);
    assert_eq!(run.summary()["converged"], true);
    assert!(run.log().contains("100%"), "{}", run.log());
    let run = bench.solve(1, &["--steps", "7"]);
    assert!(run.stderr.contains("warning: --steps 7, and the scene has "), "{}", run.stderr);
}

#[test]
fn the_written_scene_gives_the_same_results_from_any_folder() {
    let bench = bench();
    let first = succeeds(&bench, &["run", "scene.toml", "--set", "contact.top.friction=0.1", "--quiet"]);
    let text = fs::read_to_string(first.out.join("scene.toml")).unwrap();
    assert!(text.contains("friction = 0.1") && !text.contains("friction = 0.2"), "{text}");
    assert!(text.contains(&format!("mesh = \"{}\"", bench.path("meshes/slab.inp").display())), "{text}");
    let again = bench.path("again");
    let arguments = ["run", "scene.toml", "--out", again.to_str().unwrap(), "--quiet"];
    let second = nagata(&first.out, 2, &arguments, again.clone());
    assert_eq!(second.code, 0, "{}", second.stderr);
    assert!(first.history().difference(&second.history()) < 1e-9);
    assert_eq!(fs::read_to_string(again.join("scene.toml")).unwrap(), text);

    let other = bench.solve(2, &["--quiet"]);
    assert!(first.history().difference(&other.history()) > 1e-3);
    let kept = fs::read_to_string(other.out.join("scene.toml")).unwrap();
    assert!(kept.starts_with("title = \"Press and slide\" # two steps\n"), "{kept}");
}

#[test]
fn a_run_never_overwrites_its_own_scene() {
    let bench = bench();
    let run = nagata(&bench.path(""), 2, &["run", "scene.toml", "--out", "."], bench.path(""));
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("the run would overwrite its own scene file scene.toml"), "{}", run.stderr);
    assert_eq!(fs::read_to_string(bench.path("scene.toml")).unwrap(), SCENE);
}

#[test]
fn petsc_options_pass_through_and_misspelt_ones_are_warned_about() {
    let run = bench().solve(
        2,
        &[
            "--steps",
            "1",
            "--",
            "-snes_monitor",
            "-snes_monitr",
            "-mat_mumps_icntl_14",
            "150",
            "-log_view",
            ":/dev/null",
        ],
    );
    assert!(run.stdout.contains("SNES Function norm"), "{}", run.stdout);
    assert_eq!(run.stderr, "warning: nothing asked for the PETSc option -snes_monitr; is it misspelt?\n");
}

#[test]
fn quiet_is_quiet_and_results_go_to_a_folder_named_after_the_scene() {
    let bench = bench();
    let run = succeeds(&bench, &["run", "scene.toml", "--quiet"]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    for name in ["fields.h5", "fields.xdmf", "history.csv", "log.txt", "scene.toml", "summary.json"] {
        assert!(bench.path("out/scene").join(name).exists(), "{name}");
    }
    assert_eq!(fs::read_dir(bench.path("out")).unwrap().count(), 1);
    assert_eq!(run.history().steps, ["press", "press", "slide", "slide"]);
}

/// Pattern and places of a block, 3.3 kB an element when rows and elements kept what their nodes have in common.
#[test]
fn setting_up_takes_little_more_than_what_is_kept() {
    let block = r#"block = { box = { size = [2.0, 2.0, 1.0] }, elements = [40, 40, 40],
        faces = { top = ["zmax"], bottom = ["zmin"], edge = ["xmin"] } }"#;
    let bench = Bench::new(&SCENE.replace(r#"mesh = "meshes/slab.inp""#, block));
    for ranks in [1, 2] {
        let check = nagata(&bench.path(""), ranks, &["check", "scene.toml"], bench.path("out"));
        assert_eq!(check.code, 0, "{}", check.stderr);
        let line = check.stdout.lines().find(|line| line.starts_with("set up with ")).unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        let megabytes: f64 = words[3].parse().unwrap();
        assert!(megabytes < 250.0 + 50.0 * (ranks - 1) as f64, "{line}");
        if ranks > 1 {
            let share: f64 = words[words.len() - 4].parse().unwrap();
            assert!((0.8..1.2).contains(&share), "{line}");
        }
    }
}
