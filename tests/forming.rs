//! Forming of elastic-plastic bodies: a billet is pushed through a die that narrows.

mod common;

use common::{Bench, History, Run, assert_close, assert_small, root};
use std::f64::consts::PI;

const RADIUS: f64 = 50.0;
const LENGTH: f64 = 100.0;

/// A scene of `inputs/` with its mesh.
fn bench(scene: &str) -> Bench {
    let bench = Bench::new(scene);
    bench.write("extrusion.msh", include_str!("../inputs/extrusion.msh"));
    bench
}

/// Pushes the billet by so many increments of 1.5 mm.
fn push(scene: &str, ranks: usize, increments: usize, more: &[&str]) -> Run {
    let by = format!("step.push.move.0.by=[{}, 0.0, 0.0]", 1.5 * increments as f64);
    let increments = format!("step.push.increments={increments}");
    let set = ["--set", &by, "--set", &increments, "--set", "output.every=1000"];
    bench(scene).solve(ranks, &[&set, more].concat())
}

/// Radius of the bore as `scripts/meshes/extrusion.py` has it.
fn bore(x: f64) -> f64 {
    let beyond = (x - LENGTH).max(0.0);
    RADIUS - 0.035 * if beyond < 20.0 { beyond * beyond / 40.0 } else { beyond - 10.0 }
}

/// Force on a quarter of a billet that is pushed by `s` and keeps its volume, and the strain at its front, when plane
/// sections remain plane: F = A (w(e_front) - w(e_back)), w = 31 e + 130.6 e^2 the plastic work in a volume, e = 2 ln(R/r).
fn ideal(s: f64) -> (f64, f64) {
    let volume = |to: f64| {
        let h = (to - s) / 2000.0;
        (0..2000).map(|k| bore(s + h * (f64::from(k) + 0.5)).powi(2) * h).sum::<f64>()
    };
    let front = root(s + 50.0, s + 200.0, |x| volume(x) - RADIUS * RADIUS * LENGTH);
    let strain = |x: f64| 2.0 * (RADIUS / bore(x)).ln();
    let work = |e: f64| 31.0 * e + 130.6 * e * e;
    (0.25 * PI * bore(s).powi(2) * (work(strain(front)) - work(strain(s))), strain(front))
}

/// Forces on the back, each at its displacement.
fn forces(history: &History) -> Vec<(f64, f64)> {
    history.column("billet.back.ux").iter().copied().zip(history.column("billet.back.fx").iter().copied()).collect()
}

/// What oscillates: rms of the second differences of the force, behind the entry.
fn roughness(forces: &[(f64, f64)]) -> f64 {
    let late: Vec<f64> = forces.iter().filter(|(s, _)| *s > 20.0).map(|(_, f)| *f).collect();
    let bends: Vec<f64> = late.windows(3).map(|f| f[0] - 2.0 * f[1] + f[2]).collect();
    (bends.iter().map(|b| b * b).sum::<f64>() / bends.len() as f64).sqrt()
}

/// The work of the force is stored or plastic.
fn assert_energy(history: &History, tolerance: f64) {
    let (mut work, mut last) = (0.0, (0.0, 0.0));
    for (s, f) in forces(history) {
        work += 0.5 * (f + last.1) * (s - last.0);
        last = (s, f);
    }
    let bodies = ["billet", "die"].map(|body| [format!("{body}.elastic_energy"), format!("{body}.plastic_work")]);
    let kept: f64 = bodies.iter().flatten().filter(|n| history.names().contains(n)).map(|n| history.last(n)).sum();
    assert_close("energy", kept, work, tolerance);
}

/// The largest difference of two columns that should be opposite, over the largest of the first.
fn unbalance(history: &History, one: &str, other: &str) -> f64 {
    let pairs = || history.column(one).iter().zip(history.column(other));
    let largest = pairs().fold(0.0f64, |m, (a, _)| m.max(a.abs()));
    pairs().fold(0.0f64, |m, (a, b)| m.max((a + b).abs())) / largest
}

/// Against ideal work, plus what a frictionless entry adds by shear; on one rank and on others; on the exact bore; on
/// facets, whose chords are inside the bore, so that they squeeze the billet more, and where every node has its own corner.
#[test]
fn billet_in_a_rigid_die() {
    let scene = include_str!("../inputs/extrusion-rigid.toml");
    let nagata = push(scene, 2, 40, &[]);
    let history = nagata.history();
    assert_eq!(nagata.summary()["cutbacks"], 0);
    assert!(nagata.summary()["iterations"].as_u64().unwrap() < 6 * 40, "{}", nagata.summary());
    assert_small("back and die", unbalance(&history, "billet.back.fx", "die.fx"), 1e-8);
    for (s, force) in forces(&history).into_iter().filter(|(s, _)| *s > 25.0) {
        let over = force / ideal(s).0;
        assert!((0.98..1.12).contains(&over), "{over} times the ideal force at {s} mm");
    }
    assert_energy(&history, 3e-4);
    let strains = nagata.field("increments/000001/body_billet/cell/equivalent_plastic_strain");
    let largest = strains.iter().copied().fold(0.0, f64::max);
    assert_close("strain at the front", largest, ideal(60.0).1, 0.1);

    let alone = push(scene, 1, 10, &[]).history();
    for ranks in [2, 4] {
        assert_small("ranks", alone.difference(&push(scene, ranks, 10, &[]).history()), 1e-6);
    }
    let exact = push(scene, 2, 40, &["--set", "tool.die.smoothing=profile"]).history();
    assert_close("force on the exact bore", exact.last("billet.back.fx"), history.last("billet.back.fx"), 1e-3);
    let facets = push(scene, 2, 40, &["--set", "tool.die.smoothing=facet"]).history();
    assert!(facets.last("billet.back.fx") > 1.01 * history.last("billet.back.fx"));
    let [smooth, rough] = [&history, &facets].map(|h| roughness(&forces(h)));
    println!("roughness {smooth} and {rough}");
    assert!(smooth < 0.2 * rough, "{smooth} and {rough}");
}

/// A die that gives way and flows takes less force; the forces on back, contact and the rim of the die are one.
#[test]
fn billet_in_an_elastic_plastic_die() {
    let die = push(include_str!("../inputs/extrusion.toml"), 2, 20, &[]);
    assert_eq!(die.summary()["cutbacks"], 0);
    let history = die.history();
    assert_small("back and contact", unbalance(&history, "billet.back.fx", "skin.fx"), 1e-8);
    assert_small("back and rim", unbalance(&history, "billet.back.fx", "die.outer.fx"), 1e-8);
    assert_energy(&history, 2e-3);
    let rigid = push(include_str!("../inputs/extrusion-rigid.toml"), 2, 20, &[]).history();
    let [soft, hard] = [&history, &rigid].map(|h| h.last("billet.back.fx"));
    println!("{soft} and {hard}");
    assert!(soft < hard && soft > 0.97 * hard, "{soft} and {hard}");
}

/// A billet that fills a closed die under a punch, which presses at last by a force and is let go by none: the billet springs
/// back, and keeps to the die alone.
#[test]
fn a_punch_is_let_go_by_its_force() {
    let bench = Bench::new(
        r#"
        [body.b]
        material = "alu"
        axisymmetric = true
        [body.b.block]
        box = { size = [10.0, 12.0, 1.0] }
        elements = [12, 14, 1]
        faces = { skin = ["ymax", "xmax", "ymin"] }
        [material.alu]
        model = "j2"
        young = 70000.0
        poisson = 0.33
        yield_stress = 100.0
        hardening = { linear = 100.0 }
        [tool.die]
        flip = true
        profile = { points = [[-1.0, 0.0], [11.0, 0.0], [11.0, 30.0]], fillets = [0.0, 1.0, 0.0] }
        [tool.punch]
        plane = { point = [0.0, 12.0, 0.0], normal = [0.0, -1.0, 0.0] }
        [contact]
        d = { slave = "b.skin", master = "die", friction = 0.1 }
        p = { slave = "b.ymax", master = "punch" }
        [[step]]
        increments = 40
        move = [{ target = "punch", by = [0.0, -2.05, 0.0] }]
        [[step]]
        increments = 20
        force = [{ target = "punch", total = [0.0, -150e3, 0.0], directions = "y" }]
        [[step]]
        increments = 10
        force = [{ target = "punch", total = [0.0, 0.0, 0.0], directions = "y" }]
        [output]
        history = ["b.ymax"]
        "#,
    );
    let history = bench.solve(1, &[]).history();
    let [before, pressed] = [10, 1].map(|back| history.column("punch.fy")[history.len() - 1 - back]);
    assert_close("punch under its force", before, -150e3, 1e-9);
    assert_close("a tenth of it", pressed, -15e3, 1e-8);
    assert_small("die without punch", history.last("die.fy") / before, 1e-9);
    assert_eq!(history.last("p.active"), 0.0);
}
