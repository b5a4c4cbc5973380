//! Axisymmetric bodies against closed forms, and against themselves in space.

mod common;

use common::hertz::ellipse;
use common::{Bench, Run, assert_close, assert_small};
use std::f64::consts::{PI, TAU};

const SOFT: &str = "[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n";

/// A rectangle of the section, from its lower corner, turned about y.
fn ring(name: &str, [x, y, w, h]: [f64; 4], [n, m]: [usize; 2], more: &str) -> String {
    format!(
        "[body.{name}]\nmaterial = \"soft\"\naxisymmetric = true\n{more}\n\
         block = {{ box = {{ origin = [{x:?}, {y:?}, 0.0], size = [{w:?}, {h:?}, 0.3] }}, elements = [{n}, {m}, 1] }}\n"
    )
}

fn stresses(run: &Run, body: &str) -> Vec<f64> {
    run.field(&format!("increments/{:06}/body_{body}/cell/stress", run.written()))
}

/// A tube under pressure from inside, between smooth ends. Lame: u(r) = (1 + nu) p a^2 / (E (b^2 - a^2)) ((1 - 2 nu) r + b^2 / r),
/// and 2 pi nu p a^2 on the ends, to first order. F-bar and the mean change of volume do not lock.
#[test]
fn tube_under_inner_pressure() {
    let (a, b, young, p) = (1.0, 2.0, 1000.0, 1e-3);
    for (element, poisson, tolerance) in
        [("hex8", 0.3, 7e-4), ("hex8-fbar", 0.4999, 3e-4), ("hex8-sri", 0.3, 3e-4), ("hex8-sri", 0.4999, 3e-4)]
    {
        let bench = Bench::new(&format!(
            "{}[material.soft]\nmodel = \"hooke\"\nyoung = {young:?}\npoisson = {poisson:?}\n[[step]]\nincrements = 1\n\
             fix = [{{ set = \"tube.ymin\", directions = \"y\" }}, {{ set = \"tube.ymax\", directions = \"y\" }}]\n\
             pressure = [{{ set = \"tube.xmin\", value = {p:?} }}]\n[output]\nhistory = [\"tube.xmin\", \"tube.xmax\", \"tube.ymin\"]\n",
            ring("tube", [a, 0.0, b - a, 0.5], [16, 2], &format!("element = \"{element}\""))
        ));
        let history = bench.solve(1, &[]).history();
        for (set, r) in [("xmin", a), ("xmax", b)] {
            let exact =
                (1.0 + poisson) * p * a * a / (young * (b * b - a * a)) * ((1.0 - 2.0 * poisson) * r + b * b / r);
            let found = history.last(&format!("tube.{set}.ux"));
            assert_small(&format!("{element} {poisson} {set}"), found / exact - 1.0, tolerance);
        }
        assert_close("ends", history.last("tube.ymin.fy"), -TAU * poisson * p * a * a, 1e-5);
    }
}

/// A tube of rubber blown up by half under pressure that follows. Incompressible neo-Hookean, l = r / R:
/// p = mu int (l^2 - l^-2) dr / r over the wall as it is, here by Simpson's rule.
#[test]
fn a_tube_is_blown_up() {
    let (inner, outer, to) = (1.0f64, 2.0f64, 1.5f64);
    let (young, poisson) = (3.0, 0.49999);
    let end = (outer * outer + to * to - inner * inner).sqrt();
    let integrand = |r: f64| {
        let square = r * r / (r * r - to * to + inner * inner);
        (square - 1.0 / square) / r
    };
    let n = 200;
    let h = (end - to) / n as f64;
    let weight = |k: usize| if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
    let sum: f64 = (0..=n).map(|k| weight(k) * integrand(to + h * k as f64)).sum();
    let p = young / (2.0 * (1.0 + poisson)) * sum * h / 3.0;
    let bench = Bench::new(&format!(
        "{}[material.soft]\nmodel = \"neo-hookean\"\nyoung = {young:?}\npoisson = {poisson:?}\n[[step]]\nincrements = 8\n\
         fix = [{{ set = \"tube.ymin\", directions = \"y\" }}, {{ set = \"tube.ymax\", directions = \"y\" }}]\n\
         pressure = [{{ set = \"tube.xmin\", value = {p:?} }}]\n[output]\nhistory = [\"tube.xmin\"]\n",
        ring("tube", [inner, 0.0, outer - inner, 0.2], [24, 1], "")
    ));
    let run = bench.solve(1, &[]);
    assert_small("inner radius", run.history().last("tube.xmin.ux") / (to - inner) - 1.0, 2e-3);
    // The tangent knows that the area grows.
    assert!(run.summary()["iterations"].as_f64().unwrap() <= 8.0 * 6.0);
}

/// An even pressure passes from ring to ring of unlike meshes, on the axis, too, with all that knows of areas.
#[test]
fn an_even_pressure_passes_unlike_rings() {
    let discs = |n: [usize; 2], joint: &str, step: &str| {
        let lower = ring("lower", [0.0, 0.0, 1.0, 1.0], [n[0], 3], "");
        let upper = ring("upper", [0.0, 1.0, 1.0, 1.0], [n[1], 3], "");
        Bench::new(&format!(
            "{lower}{upper}{SOFT}{joint}\n[[step]]\nincrements = 2\nfix = [{{ set = \"lower.ymin\", directions = \"y\" }}]\n\
             {step}\n[output]\nhistory = [\"lower.ymin\", \"upper.xmax\"]\n"
        ))
    };
    let sides = "slave = \"upper.ymin\"\nmaster = \"lower.ymax\"\n";
    let contact = |more: &str| format!("[contact.joint]\n{sides}{more}");
    let pressure = "pressure = [{ set = \"upper.ymax\", value = 5.0 }]";
    let cases = [
        ([4, 8], contact("friction = 0.4"), 2),
        ([3, 5], contact("discretization = \"segment\"\nfriction = 0.3"), 1),
        ([5, 3], contact("discretization = \"two-pass\"\n"), 1),
        ([4, 4], contact("discretization = \"node-to-node\"\n"), 1),
        ([5, 3], format!("[tie.joint]\n{sides}"), 2),
    ];
    for (n, joint, ranks) in cases {
        let run = discs(n, &joint, pressure).solve(ranks, &[]);
        for body in ["lower", "upper"] {
            for s in stresses(&run, body).chunks(6) {
                let off = s.iter().zip([0.0, -5.0, 0.0, 0.0, 0.0, 0.0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert_small(&format!("{joint} stress"), off, 1e-9);
            }
        }
        let history = run.history();
        let radius = 1.0 + history.last("upper.xmax.ux");
        assert_close(&format!("{joint} force"), history.last("lower.ymin.fy"), 5.0 * PI * radius * radius, 1e-9);
    }
}

/// Rings pressed onto each other. Lame: p = E' d (b^2 - a^2) (c^2 - b^2) / (2 b^3 (c^2 - a^2)), E' = E / (1 - nu^2), and the
/// error falls with the square of the elements' size.
#[test]
fn press_fit() {
    let ([a, b, c], [young, poisson], d) = ([1.0f64, 2.0, 3.0], [100.0, 0.3], 1e-4);
    let stiff = young / (1.0 - poisson * poisson);
    let exact = stiff * d * (b * b - a * a) * (c * c - b * b) / (2.0 * b.powi(3) * (c * c - a * a));
    let errors = [5, 10].map(|n| {
        let smooth = ["inner", "outer"].map(|body| {
            ["ymin", "ymax"].map(|side| format!("{{ set = \"{body}.{side}\", directions = \"y\" }}")).join(", ")
        });
        let bench = Bench::new(&format!(
            "{}{}[material.soft]\nmodel = \"hooke\"\nyoung = {young:?}\npoisson = {poisson:?}\n[contact.fit]\n\
             slave = \"inner.xmax\"\nmaster = \"outer.xmin\"\n[[step]]\nincrements = 1\nfix = [{}]\n",
            ring("inner", [a, 0.0, b - a + d, 1.0], [n, 4], ""),
            ring("outer", [b, 0.0, c - b, 1.0], [n, 4], ""),
            smooth.join(", ")
        ));
        let pressures = bench.solve(1, &[]).scalars(1, "contact.fit", "pressure");
        let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
        pressures.iter().for_each(|p| assert_small("even", p / mean - 1.0, 1e-9));
        mean / exact - 1.0
    });
    assert_small("pressure", errors[1], 6e-4);
    assert_small("order", (errors[0] / errors[1]).log2() - 2.0, 0.1);
}

/// Zeros of the Bessel function J1, and J0^2 there, by McMahon's expansion; of the first the numbers.
fn zeros(count: usize) -> impl Iterator<Item = (f64, f64)> {
    let first = [(3.831705970, 0.4027593957f64), (7.015586670, 0.3001157525), (10.17346814, 0.2497048771)];
    (1..=count).map(move |n| match first.get(n - 1) {
        Some((j, v)) => (*j, v * v),
        None => {
            let beta = (n as f64 + 0.25) * PI;
            let j = beta - 3.0 / (8.0 * beta) + 36.0 / (3.0 * (8.0 * beta).powi(3));
            (j, 2.0 / (PI * j) * (1.0 - 3.0 / (8.0 * j * j)).abs())
        }
    })
}

/// A rigid ball of radius R, the round of a cylinder along z, on a layer of radius and depth 1 between smooth walls, which gives
/// way under a force F by F c more than a half-space (as in `oracles/spheres.rs`). Hertz: a^2 = d R, F = 4/3 E* a^3 / R,
/// p0 = 2 E* a / (pi R).
#[test]
fn hertz_ball_on_a_layer() {
    let (modulus, poisson, radius, a, n) = (1000.0, 0.3f64, 8.0, 0.04, 60);
    let young = modulus * (1.0 - poisson * poisson);
    let spread = 0.01f64;
    let waves: f64 = zeros(400)
        .map(|(k, squared)| {
            let w = (2.0 * k).min(100.0);
            2.0 / (modulus * k) * (w.cosh() - 1.0) / (w.sinh() + w) * (-0.5 * (k * spread).powi(2)).exp() / squared
        })
        .sum();
    let even = (1.0 + poisson) * (1.0 - 2.0 * poisson) / (young * (1.0 - poisson));
    let softness = (even + waves) / PI - 1.0 / (modulus * spread * TAU.sqrt());
    let (force, peak) = (4.0 / 3.0 * modulus * a * a * a / radius, 2.0 * modulus * a / (PI * radius));
    let approach = a * a / radius + force * softness;
    let bench = Bench::new(&format!(
        "[body.layer]\nmaterial = \"soft\"\naxisymmetric = true\n\
         block = {{ box = {{ origin = [0.0, -1.0, 0.0], size = [1.0, 1.0, 0.05] }}, elements = [{n}, {n}, 1], \
         grading = [40.0, 0.025, 1.0] }}\n\
         [material.soft]\nmodel = \"hooke\"\nyoung = {young:?}\npoisson = {poisson:?}\n\
         [tool.ball]\ncylinder = {{ point = [0.0, {radius:?}, 0.0], axis = [0.0, 0.0, 1.0], radius = {radius:?} }}\n\
         [contact.spot]\nslave = \"layer.ymax\"\nmaster = \"ball\"\n[[step]]\nincrements = 2\n\
         fix = [{{ set = \"layer.ymin\", directions = \"y\" }}, {{ set = \"layer.xmax\", directions = \"x\" }}]\n\
         move = [{{ target = \"ball\", by = [0.0, {:?}, 0.0] }}]\n[output]\nevery = 100\nhistory = [\"layer.ymin\"]\n",
        -approach
    ));
    let direct = bench.solve(2, &[]);
    let pressures = direct.scalars(direct.written(), "contact.spot", "pressure");
    let nodes: Vec<(f64, f64)> =
        direct.points("contact.spot").iter().zip(&pressures).map(|(x, p)| (x[0], *p)).collect();
    let (found, highest) = ellipse(&nodes);
    assert_small("force", direct.history().last("layer.ymin.fy") / force - 1.0, 1e-3);
    assert_small("radius", found / a - 1.0, 5e-3);
    assert_small("p0", highest / peak - 1.0, 5e-3);
    // Rigid motions that the ring has not do not mislead multigrid.
    let iterated = bench.solve(1, &["--set", "solver.linear=iterative"]);
    assert_close("iterative", iterated.history().last("ball.fy"), direct.history().last("ball.fy"), 1e-8);
}

/// A ring of metal is upset by 30 % under a rough die, in half-plane and as a sector of hexahedra between planes of symmetry: the
/// forces differ by the square of the angle of its elements, here 1.5 degrees.
#[test]
fn an_upset_ring_is_a_sector_of_hexahedra() {
    let scene = |body: &str, axis: char, point: &str, by: &str, normal: &str| {
        Bench::new(&format!(
            "[body.ring]\nmaterial = \"metal\"\n{body}\n[material.metal]\nmodel = \"j2\"\nyoung = 1000.0\npoisson = 0.3\n\
             yield_stress = 5.0\nhardening = {{ linear = 10.0 }}\n[tool.die]\nplane = {{ point = {point}, normal = {normal} }}\n\
             [contact.top]\nslave = \"ring.{axis}max\"\nmaster = \"die\"\nfriction = 0.2\n[[step]]\nincrements = 12\n\
             fix = [{{ set = \"ring.{axis}min\", directions = \"{axis}\" }}]\nmove = [{{ target = \"die\", by = {by} }}]\n\
             [output]\nevery = 100\nhistory = [\"ring.{axis}min\"]\n"
        ))
    };
    let flat =
        "axisymmetric = true\nblock = { box = { origin = [1, 0, 0], size = [1, 1, 0.1] }, elements = [5, 5, 1] }";
    let flat = scene(flat, 'y', "[0, 1, 0]", "[0, -0.3, 0]", "[0, -1, 0]").solve(1, &[]);
    let sector = "symmetry = [\"amin\", \"amax\"]\n\
                  block = { sector = { radii = [1, 2], angles = [0, 3], length = 1 }, elements = [5, 2, 5] }";
    let sector = scene(sector, 'z', "[0, 0, 1]", "[0, 0, -0.3]", "[0, 0, -1]").solve(1, &[]);
    let (of_ring, of_sector) = (flat.history().last("ring.ymin.fy"), 120.0 * sector.history().last("ring.zmin.fz"));
    assert_small("force", of_sector / of_ring - 1.0, 2e-4);
    let work = |run: &Run| run.history().last("ring.plastic_work");
    assert_small("plastic work", 120.0 * work(&sector) / work(&flat) - 1.0, 2e-4);
}

/// Weight, a spring and a force on a tool are those of the whole ring, in balance.
#[test]
fn loads_are_those_of_the_ring() {
    let (width, height, density, force) = (2.0, 1.0, 2.0, 10.0);
    let bench = Bench::new(&format!(
        "{}{SOFT}density = {density:?}\n[tool.plate]\nplane = {{ point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }}\n\
         [contact.top]\nslave = \"disc.ymax\"\nmaster = \"plate\"\nfriction = 0.2\n[[step]]\nincrements = 2\n\
         gravity = [0.0, -0.5, 0.0]\nfix = [{{ set = \"disc.ymin\", directions = \"y\" }}]\n\
         force = [{{ target = \"plate\", total = [0.0, {:?}, 0.0], directions = \"y\" }}]\n[output]\nhistory = [\"disc.ymin\"]\n",
        ring("disc", [0.0, 0.0, width, height], [6, 3], ""),
        -force
    ));
    let history = bench.solve(2, &[]).history();
    let weight = density * 0.5 * PI * width * width * height;
    assert_close("weight and force", history.last("disc.ymin.fy"), weight + force, 1e-9);
}

/// What is not alike all around is refused.
#[test]
fn what_is_not_round_is_refused() {
    let scene = format!(
        "{}{SOFT}density = 1.0\n[tool.die]\nplane = {{ point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }}\n[contact.top]\n\
         slave = \"disc.ymax\"\nmaster = \"die\"\n[[step]]\nincrements = 1\nfix = [{{ set = \"disc.ymin\", directions = \"y\" }}]\n\
         move = [{{ target = \"die\", by = [0.0, -0.01, 0.0] }}]\n",
        ring("disc", [0.0, 0.0, 1.0, 1.0], [2, 2], "")
    );
    let plane = "plane = { point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }";
    let by = "by = [0.0, -0.01, 0.0]";
    for (before, after, words) in [
        ("axisymmetric", "plane_strain = true\naxisymmetric", "stands beside `plane_strain`"),
        ("origin = [0.0", "origin = [-0.5", "node 1 is beyond the axis of revolution, at x = -0.5"),
        ("axisymmetric", "element = \"hex8-eas\"\naxisymmetric", "enhanced strain is not for axisymmetric bodies"),
        (
            "axisymmetric",
            "symmetry = [\"xmax\"]\naxisymmetric",
            "in no plane that an axisymmetric body can be mirrored",
        ),
        (plane, "sphere = { center = [0.0, 2.0, 0.0], radius = 1.0 }", "tool `die` is not drawn out along z"),
        ("slave = \"disc.ymax\"", "slave = \"disc.zmax\"", "has faces within a z-plane"),
        (by, "by = [0.01, 0.0, 0.0]", "tool `die` moves along x"),
        (
            by,
            "by = [0.0; 3], rotate = { point = [0.0, 0.0, 0.0], axis = [0.0, 1.0, 0.0], angle = 3.0 }",
            "tool `die` rotates",
        ),
        ("move =", "gravity = [1.0, 0.0, 0.0]\nmove =", "gravity acts across the axis"),
        ("move = [", "move = [{ target = \"disc.xmin\", by = [0.1, 0.0, 0.0] }, ", "of `disc.xmin` is on the axis"),
        (
            "[tool",
            "[body.other]\nmaterial = \"soft\"\nblock = { box = { size = [1, 1, 1] }, elements = [1, 1, 1] }\n[tool",
            "body `other` is not axisymmetric, but body `disc` is",
        ),
    ] {
        let text = scene.replacen(before, &after.replace("[0.0; 3]", "[0.0, 0.0, 0.0]"), 1);
        assert_ne!(text, scene, "{before}");
        let run = Bench::new(&text).run(1, &[]);
        assert!(run.code == 2 && run.stderr.contains(words), "{words}: {}\n{}", run.code, run.stderr);
    }
}
