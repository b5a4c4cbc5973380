//! Elastic bodies on each other against Hertz, Cattaneo and Mindlin.

mod common;

use common::hertz::{Layer, arch, ellipse};
use common::{Bench, Run, assert_close, assert_small, msh};
use std::f64::consts::PI;

/// A run of a scene of `inputs/` on its own mesh, with further arguments.
fn shipped(scene: &str, mesh: &str, ranks: usize, arguments: &[&str]) -> Run {
    let read = |name: &str| std::fs::read_to_string(format!("{}/inputs/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let bench = Bench::new(&read(scene));
    bench.write(mesh, &read(mesh));
    bench.solve(ranks, arguments)
}

/// Places and values of a contact's nodes that `keep` takes.
fn nodes(run: &Run, contact: &str, values: &[f64], keep: impl Fn(&[f64; 3]) -> Option<f64>) -> Vec<(f64, f64)> {
    let points = run.points(contact);
    points.iter().zip(values).filter_map(|(x, v)| keep(x).map(|x| (x, *v))).collect()
}

fn rms(errors: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = errors.fold((0, 0.0), |(n, s), e| (n + 1, s + e * e));
    (sum / f64::from(count)).sqrt()
}

/// A quarter of a ball on a quarter of a block; both are cells of layers, so that the force at an approach is known:
/// d = a^2 / R + 2 F c.
#[test]
fn ball_on_a_block() {
    let run = shipped("hertz-sphere.toml", "hertz-sphere.msh", 2, &[]);
    let history = run.history();
    let layer = Layer { young: 1000.0, poisson: 0.3, side: 8.0, depth: 8.0 };
    let (modulus, radius) = (layer.modulus() / 2.0, 50.0);
    let load = |a: f64| 4.0 / 3.0 * modulus * a.powi(3) / radius;
    let approach = -history.last("ball.back.uz");
    let expected = load(common::root(0.0, 5.0, |a| a * a / radius + 2.0 * load(a) * layer.softness() - approach));
    let force = -4.0 * history.last("ball.back.fz");
    assert_close("force", force, expected, 0.03);
    assert_small("balance", history.last("ball.back.fz") / history.last("block.base.fz") + 1.0, 1e-9);
    let a = (0.75 * force * radius / modulus).cbrt();
    let highest = 1.5 * force / (PI * a * a);
    let pressures = run.scalars(run.written(), "contact.spot", "pressure");
    let all = nodes(&run, "contact.spot", &pressures, |x| Some(x[0].hypot(x[1])));
    assert_close("contact radius", ellipse(&all).0, a, 0.01);
    assert_close("highest pressure", history.last("spot.max_pressure"), highest, 0.025);
    let errors = all.iter().filter(|(r, _)| *r < a).map(|(r, p)| (p - arch(*r, a, highest)) / highest);
    assert_small("pressure, rms", rms(errors), 0.03);
}

/// Sides and depths of roller and block, the radius of the roller and the half-width that the mesh is made for.
const SIDE: f64 = 6.0;
const RADIUS: f64 = 50.0;
const HALF_WIDTH: f64 = 0.2;
const YOUNG: f64 = 210e3;

/// Places from 0 to `length`: `even` elements of the size `first`, and `count` that grow by a constant ratio.
fn graded(first: f64, even: usize, length: f64, count: i32) -> Vec<f64> {
    let far = |ratio: f64, n: i32| (0..n).map(|k| first * ratio.powi(k)).sum::<f64>();
    let start = even as f64 * first;
    let ratio = common::root(1.0, 4.0, |ratio| far(ratio, count) + start - length);
    let near = (0..even).map(|k| k as f64 * first);
    near.chain((0..=count).map(|n| start + far(ratio, n))).collect()
}

/// A block with `n` elements over the half-width of the contact and `far` on each side of those, above or below it; a
/// roller's underside is curved.
fn body(n: usize, far: i32, above: bool) -> String {
    let first = HALF_WIDTH / n as f64;
    let half = graded(first, 5 * n / 4, SIDE, far);
    let xs: Vec<f64> = half[1..].iter().rev().map(|x| -x).chain(half.iter().copied()).collect();
    let ys = graded(first, 0, SIDE, 4 * far / 3);
    let at = |places: &[f64], s: f64| places[(s * (places.len() - 1) as f64).round() as usize];
    msh::block([xs.len() - 1, ys.len() - 1, 1], false, |[s, t, z]| {
        let x = at(&xs, s);
        if !above {
            return [x, -at(&ys, 1.0 - t), z];
        }
        let y = at(&ys, t);
        [x, y + (RADIUS - (RADIUS * RADIUS - x * x).sqrt()) * (1.0 - y / SIDE), z]
    })
}

/// A roller on a block, each a layer between smooth walls, with `n` and `n / 2` elements over the half-width.
fn roller_on_a_block(n: usize) -> Run {
    let sides = ["block", "roller"]
        .map(|b| ["xmin", "xmax"].map(|side| format!("{{ set = \"{b}.{side}\", directions = \"x\" }}")).join(", "));
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        mesh = "block.msh"
        material = "steel"
        plane_strain = true
        [body.roller]
        mesh = "roller.msh"
        material = "steel"
        plane_strain = true
        [material.steel]
        model = "hooke"
        young = {YOUNG:?}
        poisson = 0.3
        [contact.strip]
        slave = "block.ymax"
        master = "roller.ymin"
        [[step]]
        increments = 1
        fix = [{{ set = "block.ymin", directions = "y" }}, {}]
        move = [{{ target = "roller.ymax", by = [0.0, -0.00154, 0.0], directions = "y" }}]
        [output]
        history = ["block.ymin", "roller.ymax"]
        "#,
        sides.join(", ")
    ));
    bench.write("block.msh", &body(n, n as i32, false));
    bench.write("roller.msh", &body(n / 2, n as i32, true));
    bench.solve(2, &[])
}

/// Relative errors of the force at the approach, and, under that force, of half-width, highest and all pressures.
fn errors_of_roller(run: &Run, base: &str, back: &str) -> [f64; 4] {
    let layer = Layer { young: YOUNG, poisson: 0.3, side: SIDE, depth: SIDE };
    let modulus = layer.modulus() / 2.0;
    let half_width = |force: f64| 2.0 * (force * RADIUS / (PI * modulus)).sqrt();
    let history = run.history();
    let (approach, force) = (-history.last(&format!("{back}.uy")), -history.last(&format!("{back}.fy")));
    assert_small("balance", history.last(&format!("{base}.fy")) / force - 1.0, 1e-9);
    let expected = common::root(1.0, 500.0, |force| 2.0 * layer.under_a_strip(force, half_width(force)) - approach);
    let b = half_width(force);
    let highest = 2.0 * force / (PI * b);
    let pressures = run.scalars(run.written(), "contact.strip", "pressure");
    let front = nodes(run, "contact.strip", &pressures, |x| (x[2] == 0.0).then_some(x[0]));
    let off = front.iter().filter(|(x, _)| x.abs() < b).map(|(x, p)| (p - arch(*x, b, highest)) / highest);
    let found = history.last("strip.max_pressure");
    let errors = [force / expected - 1.0, ellipse(&front).0 / b - 1.0, found / highest - 1.0, rms(off)];
    println!("force, half-width, highest pressure, pressure rms: {errors:?}");
    errors
}

#[test]
fn roller_on_a_block_converges() {
    let [coarse, middle, fine] =
        [8, 16, 32].map(|n| errors_of_roller(&roller_on_a_block(n), "block.ymin", "roller.ymax"));
    for (k, tolerance) in [2e-3, 1e-3, 2e-3, 8e-3].into_iter().enumerate() {
        assert_small("error on the fine mesh", fine[k], tolerance);
        assert!(fine[k].abs() < 0.5 * coarse[k].abs(), "{coarse:?} {fine:?}");
    }
    assert!(middle[0] < 0.3 * coarse[0] && fine[0] < 0.3 * middle[0], "the force converges quadratically");
}

/// On flat facets the nodes of the block that meet an edge between two of them bear more than those beside.
#[test]
fn pressure_is_smooth_on_a_smooth_master() {
    let errors = ["nagata", "facet"].map(|smoothing| {
        let smoothing = format!("contact.strip.smoothing={smoothing}");
        let run = shipped(
            "hertz-cylinder.toml",
            "hertz-cylinder.msh",
            2,
            &["--set", &smoothing, "--set", "step.press.increments=4"],
        );
        errors_of_roller(&run, "block.base", "roller.back")
    });
    let [nagata, facet] = errors;
    for (k, tolerance) in [0.01, 0.01, 5e-3, 8e-3].into_iter().enumerate() {
        assert_small("error", nagata[k], tolerance);
    }
    assert!(facet[3] > 5.0 * nagata[3]);
}

const FRICTION: f64 = 0.3;

/// The roller, pressed, is drawn sideways: a strip of half-width c = b sqrt(1 - Q / mu P) sticks, with shear tractions
/// mu p0 [sqrt(1 - (x/b)^2) - c/b sqrt(1 - (x/c)^2)].
#[test]
fn roller_drawn_sideways() {
    let run = shipped("cattaneo-mindlin.toml", "cattaneo-mindlin.msh", 2, &[]);
    let history = run.history();
    let (force, shear) = (-history.last("roller.back.fy"), history.last("roller.back.fx"));
    let pressed = history.steps.iter().position(|step| step == "shear").unwrap() - 1;
    assert_eq!(history.column("strip.slip")[pressed], 0.0, "pressing makes no slip");
    assert_close("force while it is drawn", force, -history.column("roller.back.fy")[pressed], 1e-4);
    assert_small("balance", history.last("block.base.fx") / shear + 1.0, 1e-9);

    let modulus = YOUNG / (2.0 * (1.0 - 0.3 * 0.3));
    let b = 2.0 * (force * RADIUS / (PI * modulus)).sqrt();
    let (c, highest) = (b * (1.0 - shear / (FRICTION * force)).sqrt(), 2.0 * force / (PI * b));
    let vectors = |name: &str| run.vectors(run.written(), "contact.strip", name);
    let along = vectors("traction").into_iter().zip(vectors("normal"));
    let traction: Vec<f64> = along.map(|(t, n)| (n[1] * t[0] - n[0] * t[1]).abs()).collect();
    let pressure = run.scalars(run.written(), "contact.strip", "pressure");
    let status = run.scalars(run.written(), "contact.strip", "status");
    let left: Vec<f64> = pressure.iter().zip(&traction).map(|(p, q)| FRICTION * p - q).collect();
    for (slips, left) in status.iter().map(|s| *s == 2.0).zip(&left) {
        assert!(if slips { left.abs() < 1e-8 * highest } else { *left >= -1e-8 * highest });
    }
    let front = |values: &[f64]| nodes(&run, "contact.strip", values, |x| (x[2] == 0.0).then_some(x[0]));
    assert_close("half-width that sticks", ellipse(&front(&left)).0, c, 3e-3);
    let element = HALF_WIDTH / 16.0;
    for (x, status) in
        front(&status).into_iter().filter(|(x, _)| (x.abs() - c).abs() > element && x.abs() < b - element)
    {
        assert_eq!(status, if x.abs() < c { 1.0 } else { 2.0 }, "at {x}, c = {c}");
    }
    let exact = |x: f64| arch(x, b, FRICTION * highest) - arch(x, c, FRICTION * highest * c / b);
    let off: Vec<f64> = front(&traction).iter().map(|(x, q)| (q - exact(*x)) / exact(c)).collect();
    assert_small("shear traction", off.iter().fold(0.0, |m, e| e.abs().max(m)), 0.03);
    assert_small("shear traction, rms", rms(off.into_iter().filter(|e| *e != 0.0)), 0.01);
}

/// All but the number of iterations: in two large increments of the press, half of the nodes touch at once with hardly
/// any friction force, and rounding decides which way they slip at first.
#[test]
fn drawn_sideways_on_any_number_of_ranks() {
    let coarse = ["--set", "step.press.increments=2", "--set", "step.shear.increments=3"];
    let on = |ranks| {
        shipped("cattaneo-mindlin.toml", "cattaneo-mindlin.msh", ranks, &coarse).history().without("iterations")
    };
    let alone = on(1);
    for ranks in [2, 3, 4] {
        assert_small(&format!("{ranks} ranks"), alone.difference(&on(ranks)), 1e-8);
    }
}
