//! `nagata surface`: errors, dead zones and projections against closed forms, on any number of ranks.

mod common;

use common::{Bench, Run, assert_close, assert_small, msh, nagata};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

/// Elements over the quarter of the unit cylinder about z.
const ELEMENTS: usize = 4;
/// Angle of one.
const BETA: f64 = PI / 2.0 / ELEMENTS as f64;

/// A quarter of the unit cylinder, 0 <= z <= 1, in squares of as many strips, and what else it can be measured against.
fn bench() -> Bench {
    let bench = Bench::new(
        r#"
        [tool.pipe]
        mesh = "pipe.msh"
        cylinder = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }
        [tool.wall]
        plane = { point = [2.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
        "#,
    );
    let arc = |s: f64, t: f64| [(PI / 2.0 * s).cos(), (PI / 2.0 * s).sin(), t];
    bench.write("pipe.msh", &msh::surface(ELEMENTS, arc));
    bench
}

/// Runs `nagata surface scene.toml --tool pipe` with its results in `out`.
fn surface(bench: &Bench, ranks: usize, out: &str, arguments: &[&str]) -> Run {
    let mut all = vec!["surface", "scene.toml", "--tool", "pipe", "--out", out];
    all.extend(arguments);
    nagata(&bench.path(""), ranks, &all, bench.path(out))
}

fn measured(bench: &Bench, ranks: usize, out: &str, arguments: &[&str]) -> Run {
    let run = surface(bench, ranks, out, arguments);
    assert_eq!(run.code, 0, "{}\n{}", run.stdout, run.stderr);
    run
}

/// Rows of a CSV file by the names of their columns.
fn rows(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_string));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|fields| names.iter().cloned().zip(fields).collect()).collect()
}

/// Largest angle between the normals of a circle and of a Nagata edge over the angle `beta`, degrees.
fn nagata_normal(beta: f64) -> f64 {
    let t = (beta / 2.0).tan();
    let error = |s: f64| ((t * s).atan() - (t * s / (1.0 + t * t * (1.0 - s * s) / 2.0)).atan()).abs();
    (0..=1_000_000).map(|k| error(k as f64 / 1e6)).fold(0.0, f64::max).to_degrees()
}

#[test]
fn errors_are_those_of_the_closed_forms() {
    let bench = bench();
    let c = (BETA / 2.0).cos();
    for (description, radial, key, normal) in [
        ("facet", c - 1.0, "distance_min", (BETA / 2.0).to_degrees()),
        ("nagata", (1.0 - c).powi(2) / (2.0 * c), "distance_max", nagata_normal(BETA)),
    ] {
        let arguments = ["--description", description, "--against", "cylinder", "--refine"];
        let run = measured(&bench, 2, description, &arguments);
        let summary = run.summary();
        assert_close("radial", summary[key]["value"].as_f64().unwrap(), radial, 1e-10);
        assert_close("normal", summary["normal_max_deg"]["value"].as_f64().unwrap(), normal, 1e-8);
        assert_eq!(summary["length"]["radius"], 1.0);
        let errors = rows(&run.out.join("errors.csv"));
        assert_eq!(errors.len(), ELEMENTS * ELEMENTS);
        let at = |row: usize, name: &str| errors[row][name].parse::<f64>().unwrap();
        for row in 0..errors.len() {
            let column = if description == "facet" { "distance_min" } else { "distance_max" };
            assert_close("radial, each patch", at(row, column), radial, 1e-9);
            let [x, y] = ["x", "y"].map(|name| at(row, &format!("{column}_{name}")));
            assert_small("where it is", x.hypot(y) - 1.0 - radial, 1e-12);
        }
        if description == "facet" {
            let area: f64 = (0..errors.len()).map(|row| at(row, "area")).sum();
            assert_close("area", area, ELEMENTS as f64 * 2.0 * (BETA / 2.0).sin(), 1e-12);
            // The mean of (cos(b/2)/cos(a) - 1)^2 over tan(a).
            let (t, count) = ((BETA / 2.0).tan(), 100_000);
            let square = |k: usize| (c * (t * (k as f64 + 0.5) / count as f64).hypot(1.0) - 1.0).powi(2);
            let mean = (0..count).map(square).sum::<f64>() / count as f64;
            assert_close("RMS", summary["distance_rms"].as_f64().unwrap(), mean.sqrt(), 1e-4);
        }
    }
}

/// A cubic over the quarter of a circle whose middle is on it: control points (1, 0), (1, k), (k, 1), (0, 1).
#[test]
fn bezier_patches_are_measured_like_meshes() {
    let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
    let control = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]];
    let lines = [0.0, 1.0].map(|z| control.map(|[x, y]| format!("{x:?} {y:?} {z:?}\n")).concat());
    let bench = Bench::new(
        r#"
        [tool.pipe]
        bezier = "pipe.bpt"
        smoothing = "bezier"
        cylinder = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }
        "#,
    );
    bench.write("pipe.bpt", &format!("1\n3 1\n{}", lines.concat()));
    let radius = |t: f64| {
        let weights = [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
        let sum = |axis: usize| weights.iter().zip(control).map(|(w, c)| w * c[axis]).sum::<f64>();
        sum(0).hypot(sum(1))
    };
    let largest = (0..=1_000_000).map(|k| radius(k as f64 / 1e6) - 1.0).fold(0.0, f64::max);
    let run = measured(&bench, 2, "bezier", &["--against", "cylinder", "--refine"]);
    assert_close("radial", run.summary()["distance_max"]["value"].as_f64().unwrap(), largest, 1e-9);
    assert!(run.stdout.contains("1 Bézier face, 0 smooth joints"), "{}", run.stdout);
}

/// The sides of facets turn by beta, those of Nagata patches not at all.
#[test]
fn the_table_is_printed_without_a_reference_and_nothing_is_written() {
    let bench = bench();
    let run = measured(&bench, 2, "none", &["--description", "facet"]);
    for part in ["16 quadrilaterals", "12 smooth, 12 sharp, 16 boundary", "jump by 22.500000 degrees"] {
        assert!(run.stdout.contains(part), "{part} is not in\n{}", run.stdout);
    }
    assert!(!run.out.exists());
    let run = measured(&bench, 1, "none", &["--set", "tool.pipe.smoothing=nagata"]);
    assert!(run.stdout.contains("24 smooth, 0 sharp, 16 boundary"), "{}", run.stdout);
    assert!(run.stdout.contains("normals jump by 0.000000 degrees"), "{}", run.stdout);
}

#[test]
fn one_rank_and_two_write_the_same() {
    let bench = bench();
    let points: Vec<String> = (0..200).map(|k| [0.37, 0.71, 0.13].map(|a| a * k as f64 % 1.0 * 1.4)).map(row).collect();
    bench.write("points.csv", &points.concat());
    for description in ["facet", "nagata"] {
        let arguments = ["--description", description, "--against", "cylinder", "--refine", "--distance", "0.2"];
        let arguments = [&arguments[..], &["--samples", "9", "--points", "points.csv"]].concat();
        let [one, two] = [1, 2].map(|ranks| measured(&bench, ranks, &format!("on-{ranks}"), &arguments));
        assert_eq!(one.stdout, two.stdout);
        for name in ["errors.csv", "summary.json", "projections.csv", "surface.xdmf", "errors.svg", "dead-zones.svg"] {
            let [a, b] = [&one, &two].map(|run| fs::read_to_string(run.out.join(name)).unwrap());
            assert!(a == b && !a.is_empty(), "{name} differs");
        }
        let xdmf = fs::read_to_string(one.out.join("surface.xdmf")).unwrap();
        let files = [&one, &two].map(|run| hdf5::File::open(run.out.join("surface.h5")).unwrap());
        let mut datasets = 0;
        for reference in xdmf.split(">surface.h5:/").skip(1) {
            let path = reference.split('<').next().unwrap();
            let [a, b] = [&files[0], &files[1]].map(|file| file.dataset(path).unwrap().read_raw::<f64>().unwrap());
            assert!(a == b && a.iter().all(|x| x.is_finite()), "{path}");
            datasets += 1;
        }
        assert_eq!(datasets, 8, "{xdmf}");
    }
}

fn row([x, y, z]: [f64; 3]) -> String {
    format!("{x:?},{y:?},{z:?}\n")
}

/// A point at the radius r and the angle a from the middle of a facet has a normal projection when r |sin a| is at most half
/// the chord, and one on the facet extended by e when it is at most (1 + 2 e) times that.
#[test]
fn points_are_projected_as_geometry_says() {
    let bench = bench();
    let mut points = Vec::new();
    for k in 0..40 {
        for radius in [0.9, 1.05, 1.3, 2.0] {
            let angle = PI / 2.0 * (k as f64 + 0.5) / 40.0;
            points.push((radius, angle));
        }
    }
    let lines: Vec<String> = points.iter().map(|(r, a)| row([r * a.cos(), r * a.sin(), 0.4])).collect();
    bench.write("points.csv", &("x,y,z\n".to_string() + &lines.concat()));
    let (half, extension) = ((BETA / 2.0).sin(), 0.1);
    for e in [0.0, extension] {
        let arguments = ["--description", "facet", "--points", "points.csv", "--extension", &e.to_string()];
        let run = measured(&bench, 2, "points", &arguments);
        let found = rows(&run.out.join("projections.csv"));
        assert_eq!(found.len(), points.len());
        let mut counts = [0; 3];
        for ((radius, angle), row) in points.iter().zip(&found) {
            let middle = ((angle / BETA).floor() + 0.5) * BETA;
            let across = radius * (angle - middle).sin().abs() / half;
            let number = |name: &str| row[name].parse::<f64>().unwrap();
            let gap = radius * (angle - middle).cos() - (BETA / 2.0).cos();
            let kind = if across <= 1.0 {
                0
            } else if across <= 1.0 + 2.0 * e {
                1
            } else {
                2
            };
            counts[kind] += 1;
            match (kind, row["kind"].as_str()) {
                (0, "normal") | (1, "extended") => {
                    assert_small("gap", number("gap") - gap, 1e-12);
                    assert_small("normal", number("nx") - middle.cos(), 1e-12);
                }
                (2, "edge") => assert!(number("gap") > gap),
                (2, "none") => assert!(*angle < BETA / 2.0 || *angle > PI / 2.0 - BETA / 2.0),
                (_, other) => panic!("{radius} {angle}: {other}"),
            }
        }
        let summary = run.summary();
        assert_eq!(summary["projections"]["normal"], counts[0]);
        assert_eq!(summary["projections"]["extended"], counts[1]);
        assert!(counts[0] > 60 && counts[2] > 10, "{counts:?}");
    }
}

/// Outside at the distance d, the point over the angle a from the middle of a facet has a projection when (1 + d) sin a is at
/// most half the chord; there the facet is at tan(a)/tan(b/2) of its half. Inside all points have one.
#[test]
fn dead_zones_have_the_size_of_their_closed_form() {
    let bench = bench();
    let arguments = ["--description", "facet", "--against", "cylinder", "--distance", "0.5", "--samples", "61"];
    let summary = measured(&bench, 2, "dead", &arguments).summary();
    let dead = &summary["dead_zones"];
    let reached = ((BETA / 2.0).sin() / 1.5).asin().tan() / (BETA / 2.0).tan();
    assert_small("outside", dead["outside"]["strict"].as_f64().unwrap() - (1.0 - reached), 0.018);
    assert_eq!(dead["inside"]["strict"], 0.0);
    assert!(dead["outside"]["extended"].as_f64() < dead["outside"]["strict"].as_f64());
}

#[test]
fn wrong_input_says_what_would_be_right() {
    let bench = bench();
    bench.write("bad.csv", "x,y,z\n0,0,0\n1,2\n");
    bench.write("block.toml", "[tool]\n");
    let cases: [(&[&str], &[&str]); 9] = [
        (&["--description", "nurbs"], &["--description nurbs: tool `pipe` has no such description", "facet, nagata"]),
        (&["--against", "cylindr"], &["--against cylindr is no description of tool `pipe`", "did you mean `cylinder`"]),
        (&["--description", "cylinder"], &["tool `pipe` goes on without end", "--against"]),
        (&["--samples", "1"], &["--samples", "2..=1000"]),
        (&["--distance", "1.0"], &["--against"]),
        (&["--against", "wall", "--distance", "-1.0"], &["--distance", "above 0"]),
        (&["--extension", "0.6"], &["--extension", "0 to 0.5"]),
        (&["--points", "bad.csv"], &["bad.csv:3:1: is not a point", "x,y,z"]),
        (&["--points", "gone.csv"], &["cannot read gone.csv"]),
    ];
    for (arguments, parts) in cases {
        let run = surface(&bench, 2, "wrong", arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}{}", run.stdout, run.stderr);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part} is not in\n{}", run.stderr);
        }
        assert_eq!(run.stderr.matches("error:").count(), 1, "{}", run.stderr);
    }
    let both = nagata(&bench.path(""), 1, &["surface", "scene.toml"], bench.path("both"));
    assert!(both.code == 2 && both.stderr.contains("2 tools: pipe, wall") && both.stderr.contains("--tool NAME"));
    let none = nagata(&bench.path(""), 1, &["surface", "scene.toml", "--tool", "pip"], bench.path("none"));
    assert!(none.code == 2 && none.stderr.contains("has no tool `pip`") && none.stderr.contains("pipe"));
}
