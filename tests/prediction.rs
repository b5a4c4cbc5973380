//! What a run is foretold to cost, and what `nagata calibrate` measures for it.

mod common;

use common::{Bench, Run, mpirun};
use std::fs;
use std::path::Path;

/// A block that a plate presses; so many elements along each side.
fn bench(elements: usize) -> Bench {
    Bench::new(&format!(
        r#"
        body.block.block = {{ box = {{ size = [1, 1, 1] }}, elements = [{elements}, {elements}, {elements}] }}
        body.block.material = "rubber"
        material.rubber = {{ model = "neo-hookean", young = 6.0, poisson = 0.3 }}
        tool.plate.plane = {{ point = [0, 0, 1], normal = [0, 0, -1] }}
        contact.top = {{ slave = "block.zmax", master = "plate", friction = 0.2 }}
        step = [{{ increments = 2, fix = [{{ set = "block.zmin" }}], move = [{{ target = "plate", by = [0.01, 0, -0.05] }}] }}]
        "#
    ))
}

/// Runs a command in the folder of a bench, with a cache; exit code 0 is asserted.
#[track_caller]
fn with_cache(bench: &Bench, cache: &Path, ranks: usize, arguments: &[&str]) -> (String, String) {
    let done = mpirun(ranks).args(arguments).current_dir(bench.path("")).env("XDG_CACHE_HOME", cache).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(done.status.success(), "{}", text(&done.stderr));
    (text(&done.stdout), text(&done.stderr))
}

#[track_caller]
fn ratio(run: &Run, what: &str) -> f64 {
    run.summary()["predicted"][what].as_f64().unwrap()
}

#[test]
fn memory_is_foretold() {
    for (elements, options) in [
        (4, &[][..]),
        (14, &[]),
        (14, &["--set", r#"solver.linear="direct""#]),
        (14, &["--set", r#"solver.linear="iterative""#]),
    ] {
        for ranks in [1, 2] {
            let ratio = ratio(&bench(elements).solve(ranks, options), "memory_ratio");
            assert!((0.8..1.25).contains(&ratio), "{elements} {options:?} on {ranks} ranks: {ratio}");
        }
    }
}

#[test]
fn a_run_says_how_far_it_was_off() {
    let run = bench(3).solve(2, &[]);
    let (log, predicted) = (run.log(), run.summary()["predicted"].clone());
    let line = log.lines().find(|line| line.starts_with("predicted:")).unwrap();
    let told: f64 = line.rsplit(' ').next().unwrap().parse().unwrap();
    // Two digits here, three there.
    assert!((told - predicted["memory_ratio"].as_f64().unwrap()).abs() < 0.0056, "{line}\n{predicted}");
    assert!(predicted["wall_s"].as_f64().unwrap() > 0.0 && predicted["wall_ratio"].as_f64().unwrap() > 0.0);
}

#[test]
fn what_was_calibrated_is_used() {
    let bench = bench(3);
    let cache = bench.path("cache");
    let check = |ranks| with_cache(&bench, &cache, ranks, &["check", "scene.toml"]).0;
    assert!(check(1).contains("\n  default rates; `nagata calibrate` measures this machine\n"));
    let (table, _) = with_cache(&bench, &cache, 2, &["calibrate", "--repeats", "1"]);
    let file = cache.join("nagata/machine.json");
    assert!(table.contains("  hex8-fbar, j2\n") && table.contains(&format!("kept in {}\n", file.display())), "{table}");
    assert_eq!(table.matches("kept in").count(), 1);
    for ranks in [1, 2] {
        let text = check(ranks);
        assert!(
            text.contains("\n  rates of this machine, calibrated on 20") && text.contains(" with 2 ranks\n"),
            "{text}"
        );
        let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
        assert_eq!((lines("memory: about "), lines("time: about ")), (1, 1), "{text}");
    }
    // A machine that is a million times slower takes longer.
    let kept = fs::read_to_string(&file).unwrap();
    let foretold = || {
        with_cache(&bench, &cache, 2, &["run", "scene.toml", "--quiet"]);
        let text = fs::read_to_string(bench.path("out/scene/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        summary["predicted"]["wall_s"].as_f64().unwrap()
    };
    let before = foretold();
    let mut slower: serde_json::Value = serde_json::from_str(&kept).unwrap();
    for seconds in slower["measured"][0]["seconds"].as_object_mut().unwrap().values_mut() {
        *seconds = (1e6 * seconds.as_f64().unwrap()).into();
    }
    fs::write(&file, slower.to_string()).unwrap();
    let after = foretold();
    assert!(after > 100.0 * before, "{before} {after}");
    fs::write(&file, &kept[..kept.len() / 2]).unwrap();
    let text = check(2);
    let warning = format!("  warning: {} is damaged, and passed over; ", file.display());
    assert!(text.matches(&warning).count() == 1 && text.contains("\n  default rates"), "{text}");
    let (_, told) = with_cache(&bench, &cache, 2, &["run", "scene.toml", "--quiet"]);
    assert_eq!(told.matches("is damaged").count(), 1, "{told}");
}

#[test]
fn without_a_place_for_a_cache_rates_are_shown_but_not_kept() {
    let bench = bench(3);
    let mut calibrate = mpirun(2);
    calibrate.args(["calibrate", "--repeats", "1"]).env("XDG_CACHE_HOME", bench.path("scene.toml"));
    let done = calibrate.output().unwrap();
    let [text, told] = [&done.stdout, &done.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(done.status.code(), Some(3), "{told}");
    assert!(text.starts_with("    ns  of\n") && !text.contains("kept in"), "{text}");
    assert_eq!(told.matches("error: what was measured is not kept: ").count(), 1, "{told}");
    let (text, _) = with_cache(&bench, &bench.path("scene.toml"), 1, &["check", "scene.toml"]);
    assert!(text.contains("\n  default rates"), "{text}");
}
