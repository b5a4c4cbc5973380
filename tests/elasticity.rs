//! Blocks under loads with closed-form answers, without contact.
//!
//! A homogeneous deformation must come out exactly, on any mesh and with any element: each scene has bodies side by
//! side, of distorted hexahedra (full integration and F-bar), the same with wedges between them, and tetrahedra, linear and
//! quadratic, of both materials.

mod common;

use common::{Bench, assert_close, assert_small, msh, root};
use std::fmt::Write;

const YOUNG: f64 = 100.0;
const POISSON: f64 = 0.3;
/// Sides of the blocks.
const SIZE: [f64; 3] = [2.0, 1.5, 1.2];
const AREA: f64 = SIZE[0] * SIZE[1];

/// Lame's constants (lambda, mu).
fn lame() -> (f64, f64) {
    (YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)), 0.5 * YOUNG / (1.0 + POISSON))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Material {
    NeoHookean,
    Hooke,
}
use Material::{Hooke, NeoHookean};

impl Material {
    /// Principal Kirchhoff stresses at principal stretches: W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J, and W = mu e:e +
    /// lambda/2 (tr e)^2 with the logarithmic strain e.
    fn kirchhoff(self, stretches: [f64; 3]) -> [f64; 3] {
        let (lambda, mu) = lame();
        let volume = lambda * stretches.iter().product::<f64>().ln();
        stretches.map(|s| {
            volume
                + match self {
                    NeoHookean => mu * (s * s - 1.0),
                    Hooke => 2.0 * mu * s.ln(),
                }
        })
    }

    /// The lateral stretch that leaves the sides of a bar free, at an axial stretch.
    fn free_stretch(self, axial: f64) -> f64 {
        root(0.3, 3.0, |t| self.kirchhoff([t, t, axial])[0])
    }
}

/// A name and material for each of the bodies.
const BODIES: [(&str, Material); 12] = [
    ("hex-neo", NeoHookean),
    ("bar-neo", NeoHookean),
    ("mix-neo", NeoHookean),
    ("tet-neo", NeoHookean),
    ("ten-neo", NeoHookean),
    ("sri-neo", NeoHookean),
    ("hex-log", Hooke),
    ("bar-log", Hooke),
    ("mid-log", Hooke),
    ("tet-log", Hooke),
    ("ten-log", Hooke),
    ("sri-log", Hooke),
];

/// The bodies of `n` cells along each side, and a step from a template of its conditions, in which `@` is the body.
fn bodies(n: [usize; 3], increments: usize, conditions: &[(&str, &str)]) -> Bench {
    let mut scene = String::new();
    for (name, _) in BODIES {
        let (kind, material) = name.split_once('-').unwrap();
        let (element, file) = match kind {
            "bar" => ("element = \"hex8-fbar\"", "hex"),
            "mid" => ("element = \"hex8-fbar\"", "mix"),
            "sri" => ("element = \"tet10-sri\"", "ten"),
            file => ("", file),
        };
        let _ = writeln!(scene, "[body.{name}]\nmesh = \"{file}.msh\"\nmaterial = \"{material}\"\n{element}");
    }
    for (name, model) in [("neo", "neo-hookean"), ("log", "hooke")] {
        let _ = writeln!(scene, "[material.{name}]\nmodel = \"{model}\"\nyoung = {YOUNG:?}\npoisson = {POISSON:?}");
    }
    let _ = writeln!(scene, "[[step]]\nincrements = {increments}");
    for (key, template) in conditions {
        let all: Vec<String> = BODIES.iter().map(|(name, _)| template.replace('@', name)).collect();
        let _ = writeln!(scene, "{key} = [{}]", all.join(", "));
    }
    let sets = BODIES.iter().flat_map(|(name, _)| ["xmin", "xmax", "zmin", "zmax"].map(|s| format!("\"{name}.{s}\"")));
    let _ = writeln!(scene, "[output]\nevery = 100\nhistory = [{}]", sets.collect::<Vec<_>>().join(", "));
    let bench = Bench::new(&scene);
    bench.write("hex.msh", &msh::block(n, false, distorted));
    bench.write("mix.msh", &filled(n, distorted));
    bench.write("tet.msh", &msh::block(n, true, distorted));
    bench.write("ten.msh", &msh::second_order(&msh::block(n, true, distorted)));
    bench
}

/// Hexahedra, every other one of a layer as two wedges.
fn filled(n: [usize; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    msh::wedges(&msh::block(n, false, place), |e| (e % (n[0] * n[1])).is_multiple_of(2))
}

/// The unit cube to the block; what is inside is moved about, and so are the points of a side within it.
fn distorted(x: [f64; 3]) -> [f64; 3] {
    let inside = |d: usize| if x[d] > 1e-9 && x[d] < 1.0 - 1e-9 { 0.07 } else { 0.0 };
    let phase = 7.0 * x[0] + 11.0 * x[1] + 5.0 * x[2];
    std::array::from_fn(|d| SIZE[d] * (x[d] + inside(d) * (phase + 2.0 * d as f64).sin()))
}

const ROLLERS: &str = "{ set = \"@.xmin\", directions = \"x\" }, { set = \"@.ymin\", directions = \"y\" }, \
                       { set = \"@.zmin\", directions = \"z\" }";

/// ```text
///   z ^  v v v v  moved by (s - 1) H        P = tau_z(1, 1, s) / s per reference area
///     o=========o
///     o         o   rollers on all sides
///     o=========o
/// ```
#[test]
fn confined_compression() {
    let s = 0.6;
    let fix =
        format!("{ROLLERS}, {{ set = \"@.xmax\", directions = \"x\" }}, {{ set = \"@.ymax\", directions = \"y\" }}");
    let by = format!("{{ target = \"@.zmax\", by = [0.0, 0.0, {:?}], directions = \"z\" }}", (s - 1.0) * SIZE[2]);
    let history = bodies([3, 3, 3], 4, &[("fix", &fix), ("move", &by)]).solve(2, &[]).history();
    for (name, material) in BODIES {
        let tau = material.kirchhoff([1.0, 1.0, s]);
        assert_close(&format!("{name} axial"), history.last(&format!("{name}.zmax.fz")), tau[2] / s * AREA, 1e-9);
        let lateral = history.last(&format!("{name}.xmax.fx"));
        assert_close(&format!("{name} lateral"), lateral, tau[0] * SIZE[1] * SIZE[2], 1e-9);
    }
}

/// ```text
///   z ^  v v v v  moved by (s - 1) H
///     o=========|        P = tau_z(t, t, s) / s with the stretch t of the free sides from tau_x = 0;
///     o         | free   logarithmic law: P = E ln s / s, t = s^-nu
///     o=========|
/// ```
#[test]
fn uniaxial_compression_and_tension() {
    for s in [0.6, 1.3] {
        let by = format!("{{ target = \"@.zmax\", by = [0.0, 0.0, {:?}], directions = \"z\" }}", (s - 1.0) * SIZE[2]);
        let history = bodies([3, 3, 3], 4, &[("fix", ROLLERS), ("move", &by)]).solve(2, &[]).history();
        for (name, material) in BODIES {
            let t = material.free_stretch(s);
            let force = material.kirchhoff([t, t, s])[2] / s * AREA;
            if material == Hooke {
                assert_close("free stretch", t, s.powf(-POISSON), 1e-14);
                assert_close("force", force, YOUNG * s.ln() / s * AREA, 1e-13);
            }
            assert_close(&format!("{name} force at {s}"), history.last(&format!("{name}.zmax.fz")), force, 1e-9);
            let bulge = history.last(&format!("{name}.xmax.ux"));
            assert_close(&format!("{name} bulge at {s}"), bulge, (t - 1.0) * SIZE[0], 1e-9);
        }
    }
}

/// ```text
///      _________ -> gamma H     One layer of elements: F = 1 + gamma e_x e_z, J = 1, principal stretches exp(+-e) with
///     /        /                sinh e = gamma/2 at the angle theta, tan 2 theta = 2/gamma, and 1 along y, which stays free.
///    /________/  held           The faces across x load top and bottom alike, so that the top carries tau_xz and tau_zz:
///                               mu gamma and 0 (neo-Hookean); 2 mu e (sin, -cos) 2 theta (logarithmic).
/// ```
#[test]
fn simple_shear() {
    let gamma = 0.8;
    let fix = "{ set = \"@.zmin\", directions = \"xz\" }, { set = \"@.ymin\", directions = \"y\" }, \
               { set = \"@.zmax\", directions = \"z\" }";
    let by = format!("{{ target = \"@.zmax\", by = [{:?}, 0.0, 0.0], directions = \"x\" }}", gamma * SIZE[2]);
    let history = bodies([3, 3, 1], 4, &[("fix", fix), ("move", &by)]).solve(2, &[]).history();
    let (_, mu) = lame();
    let (e, double) = ((0.5 * gamma).asinh(), (2.0f64).atan2(gamma));
    // Quadratic elements have nodes between top and bottom, which nothing holds.
    let is_linear = |name: &str| !name.starts_with("ten") && !name.starts_with("sri");
    for (name, material) in BODIES.into_iter().filter(|(name, _)| is_linear(name)) {
        let (shear, normal) = match material {
            NeoHookean => (mu * gamma, 0.0),
            Hooke => (2.0 * mu * e * double.sin(), -2.0 * mu * e * double.cos()),
        };
        let force = |axis: &str| history.last(&format!("{name}.zmax.{axis}")) / AREA;
        assert_close(&format!("{name} shear"), force("fx"), shear, 1e-9);
        assert_small(&format!("{name} across"), (force("fz") - normal) / shear, 1e-9);
    }
}

/// ```text
///   z ^  p p p p  follows the top, which grows from A to t^2 A
///     o=========|        Cauchy stress -p along z, 0 on the free sides:  tau_z(t, t, s) = -p s t^2,
///     o         | free   reaction p t^2 A
///     o=========|
/// ```
#[test]
fn pressure_on_a_free_bar_acts_on_the_current_area() {
    let p = 45.0;
    let pressure = format!("{{ set = \"@.zmax\", value = {p:?} }}");
    let history = bodies([3, 3, 3], 5, &[("fix", ROLLERS), ("pressure", &pressure)]).solve(2, &[]).history();
    for (name, material) in BODIES {
        let cauchy = |s: f64| {
            let t = material.free_stretch(s);
            material.kirchhoff([t, t, s])[2] / (s * t * t)
        };
        let s = root(0.4, 1.0, |s| cauchy(s) + p);
        let t = material.free_stretch(s);
        assert_close(&format!("{name} reaction"), history.last(&format!("{name}.zmin.fz")), p * t * t * AREA, 1e-9);
        assert_close(&format!("{name} top"), history.last(&format!("{name}.zmax.uz")), (s - 1.0) * SIZE[2], 1e-9);
    }
}

/// A block that is pressed from all six sides shrinks alike along each: tau(s, s, s) = -p s^3, and its supports bear
/// nothing.
#[test]
fn hydrostatic_pressure() {
    let p = 60.0;
    let sides = ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"];
    let pressures = sides.map(|side| format!("{{ set = \"@.{side}\", value = {p:?} }}")).join(", ");
    let history = bodies([3, 3, 3], 3, &[("fix", ROLLERS), ("pressure", &pressures)]).solve(2, &[]).history();
    for (name, material) in BODIES {
        let s = root(0.5, 1.0, |s| material.kirchhoff([s; 3])[0] / s.powi(3) + p);
        assert_close(&format!("{name} top"), history.last(&format!("{name}.zmax.uz")), (s - 1.0) * SIZE[2], 1e-9);
        assert_close(&format!("{name} side"), history.last(&format!("{name}.xmax.ux")), (s - 1.0) * SIZE[0], 1e-9);
        let support = history.last(&format!("{name}.zmin.fz")).abs() + history.last(&format!("{name}.xmin.fx")).abs();
        assert_small(&format!("{name} supports"), support / (p * AREA), 1e-9);
    }
}

/// A column between smooth walls under its own weight w per reference volume: the foot bears w V, and at small strain
/// the top goes down by w H^2 / 2M with the modulus M = lambda + 2 mu of confined compression. Cuts at right angles to
/// the weight make linear elements exact at their nodes.
#[test]
fn column_under_its_own_weight() {
    let (lambda, mu) = lame();
    let w = 1e-5 * (lambda + 2.0 * mu) / SIZE[2];
    let walls = ["xmin", "xmax"].map(|side| format!("{{ set = \"@.{side}\", directions = \"x\" }}"));
    let others = ["ymin", "ymax"].map(|side| format!("{{ set = \"@.{side}\", directions = \"y\" }}"));
    let fix = format!("{}, {}, {{ set = \"@.zmin\", directions = \"z\" }}", walls.join(", "), others.join(", "));
    let weight = format!("{{ body = \"@\", per_volume = [0.0, 0.0, {:?}] }}", -w);
    let bench = bodies([3, 3, 3], 1, &[("fix", &fix), ("body_force", &weight)]);
    let straight = |x: [f64; 3]| std::array::from_fn(|d| SIZE[d] * x[d]);
    bench.write("hex.msh", &msh::block([2, 2, 4], false, straight));
    bench.write("mix.msh", &filled([2, 2, 4], straight));
    bench.write("tet.msh", &msh::block([2, 2, 4], true, straight));
    bench.write("ten.msh", &msh::second_order(&msh::block([2, 2, 4], true, straight)));
    let history = bench.solve(2, &[]).history();
    for (name, _) in BODIES {
        let foot = history.last(&format!("{name}.zmin.fz"));
        assert_close(&format!("{name} weight"), foot, w * AREA * SIZE[2], 1e-9);
        let top = history.last(&format!("{name}.zmax.uz"));
        let exact = -w * SIZE[2] * SIZE[2] / (2.0 * (lambda + 2.0 * mu));
        // A parabola, which constant strains, or pressures, are off from.
        if !name.starts_with("tet") && !name.starts_with("sri") {
            assert_close(&format!("{name} top"), top, exact, 2e-5);
        }
    }
}

/// A bar that is hardly loaded: rounding leaves fewer digits of its stress, and that must do.
#[test]
fn light_loads_converge() {
    let strain = -1e-8;
    let by = format!("{{ target = \"@.zmax\", by = [0.0, 0.0, {:?}], directions = \"z\" }}", strain * SIZE[2]);
    let run = bodies([3, 3, 3], 1, &[("fix", ROLLERS), ("move", &by)]).solve(2, &[]);
    assert_eq!(run.summary()["cutbacks"], 0);
    for (name, _) in BODIES {
        assert_close(name, run.history().last(&format!("{name}.zmax.fz")), YOUNG * strain * AREA, 1e-6);
    }
}

/// ```text
///      p p p p p p           A cantilever that bends far up or down: the pressure stays normal to it, so that its resultant
///    |============ )         is p times the vector area of the deformed top, 1/2 sum x_i x x_i+1 around its rim of straight
///    |  held                 edges. Its reaction along the beam shows that it turned.
/// ```
#[test]
fn pressure_turns_with_a_cantilever() {
    let p = 0.12;
    let bench = Bench::new(&format!(
        r#"
        [body.beam]
        block = {{ box = {{ size = [10.0, 1.0, 1.0] }}, elements = [12, 2, 2] }}
        material = "steel"
        element = "hex8-fbar"
        [material.steel]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [[step]]
        increments = 5
        fix = [{{ set = "beam.xmin" }}]
        pressure = [{{ set = "beam.zmax", value = {p:?} }}]
        [output]
        every = 100
        history = ["beam.xmin", "beam.xmax"]
        "#
    ));
    let run = bench.solve(2, &[]);
    let history = run.history();
    let tip = history.last("beam.xmax.uz");
    assert!(tip < -1.0, "the beam bends: {tip}");
    // The rim: reference positions on the edges of the top, in order around its middle.
    let (points, moved) = (run.points("body.beam"), run.vectors(run.written(), "body.beam", "displacement"));
    let on_rim = |x: &[f64; 3]| x[2] == 1.0 && (x[0] == 0.0 || x[0] == 10.0 || x[1] == 0.0 || x[1] == 1.0);
    let mut rim: Vec<_> = points.iter().zip(moved).filter(|(x, _)| on_rim(x)).collect();
    let angle = |x: &[f64; 3]| (x[1] - 0.5).atan2((x[0] - 5.0) / 10.0);
    rim.sort_by(|a, b| angle(a.0).total_cmp(&angle(b.0)));
    assert_eq!(rim.len(), 28);
    let at = |k: usize| nagata::Vec3::from(*rim[k % rim.len()].0) + nagata::Vec3::from(rim[k % rim.len()].1);
    let area = (0..rim.len()).map(|k| at(k).cross(&at(k + 1))).sum::<nagata::Vec3>() * 0.5;
    assert!(area.x > 0.5, "the top turned: {area}");
    for (axis, component) in ["fx", "fy", "fz"].iter().zip(area.iter()) {
        let reaction = history.last(&format!("beam.xmin.{axis}"));
        assert_small(&format!("root {axis}"), (reaction - p * component) / (p * area.norm()), 1e-9);
    }
}

/// ```text
///    |\      A quarter of a tube under inner pressure in plane strain. Lame: u(r) = (1 + nu) p a^2 / (E (b^2 - a^2))
///    | \     ((1 - 2 nu) r + b^2 / r); the cut at angle 0 bears p times the current inner radius and the length.
///     \ |    F-bar does not lock when nearly incompressible.
///      -+
/// ```
#[test]
fn tube_under_inner_pressure() {
    let (inner, outer, length) = (1.0, 2.0, 0.2);
    let p = 1e-4 * YOUNG;
    for (element, poisson, tolerance) in [("hex8", 0.3, 3e-3), ("hex8-fbar", 0.3, 3e-3), ("hex8-fbar", 0.4999, 3e-3)] {
        let bench = Bench::new(&format!(
            r#"
            [body.tube]
            material = "soft"
            element = "{element}"
            plane_strain = true
            [body.tube.block]
            sector = {{ radii = [{inner:?}, {outer:?}], angles = [0.0, 90.0], length = {length:?} }}
            elements = [12, 16, 1]
            [material.soft]
            model = "hooke"
            young = {YOUNG:?}
            poisson = {poisson:?}
            [[step]]
            increments = 1
            fix = [{{ set = "tube.amin", directions = "y" }}, {{ set = "tube.amax", directions = "x" }}]
            pressure = [{{ set = "tube.rmin", value = {p:?} }}]
            [output]
            history = ["tube.amin", "tube.amax"]
            "#
        ));
        let run = bench.solve(2, &[]);
        let (points, moved) = (run.points("body.tube"), run.vectors(1, "body.tube", "displacement"));
        for r in [inner, outer] {
            let exact = (1.0 + poisson) * p * inner * inner / (YOUNG * (outer * outer - inner * inner))
                * ((1.0 - 2.0 * poisson) * r + outer * outer / r);
            let radial = points.iter().zip(&moved).filter(|(x, _)| (x[0].hypot(x[1]) - r).abs() < 1e-9);
            for (x, u) in radial {
                let outward = (x[0] * u[0] + x[1] * u[1]) / r;
                assert!((outward / exact - 1.0).abs() < tolerance, "{element} {poisson} {x:?}: {outward} {exact}");
            }
        }
        let history = run.history();
        let at = points.iter().position(|x| x[0] == inner && x[1].abs() < 1e-12).unwrap();
        let reaction = -p * (inner + moved[at][0]) * length;
        assert_close(&format!("{element} {poisson} cut"), history.last("tube.amin.fy"), reaction, 1e-8);
        assert_close(&format!("{element} {poisson} cut"), history.last("tube.amax.fx"), reaction, 1e-8);
    }
}
