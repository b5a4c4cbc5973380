//! Orthotropic elasticity off its axes against closed forms, with all elements that have it.

mod common;

use common::{Bench, assert_close, assert_small, msh};
use nalgebra::{Matrix3, Vector3};
use std::fmt::Write;

const YOUNG: [f64; 3] = [11000.0, 890.0, 430.0];
/// nu12, nu13, nu23 and G12, G13, G23.
const POISSON: [f64; 3] = [0.38, 0.48, 0.51];
const SHEAR: [f64; 3] = [690.0, 620.0, 40.0];
/// From x to the first axis, about z.
const ANGLE: f64 = 0.6;
const ELEMENTS: [&str; 4] = ["hex8", "hex8-fbar", "hex8-sri", "tet4"];

/// Unit cubes of `n` cells of each element along each side, under conditions of a step in which `@` is the body, all in one scene.
fn cubes(n: [usize; 3], conditions: &[(&str, &str)]) -> Bench {
    let ([e1, e2, e3], [nu12, nu13, nu23], [g12, g13, g23]) = (YOUNG, POISSON, SHEAR);
    let (sine, cosine) = ANGLE.sin_cos();
    let mut scene = format!(
        "material.wood = {{ model = \"orthotropic\", orthotropic = {{ e1 = {e1}, e2 = {e2}, e3 = {e3}, nu12 = {nu12}, \
         nu13 = {nu13}, nu23 = {nu23}, g12 = {g12}, g13 = {g13}, g23 = {g23}, x = [{cosine}, {sine}, 0], y = [0, 1, 0] }} }}\n"
    );
    for element in ELEMENTS {
        let mesh = if element == "tet4" { "tet.msh" } else { "hex.msh" };
        let _ =
            writeln!(scene, "body.{element} = {{ material = \"wood\", element = \"{element}\", mesh = \"{mesh}\" }}");
    }
    let sets = ELEMENTS.map(|element| format!("\"{element}.xmax\"")).join(", ");
    let _ = writeln!(scene, "output.history = [{sets}]\n[[step]]\nincrements = 2");
    for (key, template) in conditions {
        let all = ELEMENTS.map(|element| template.replace('@', element)).join(", ");
        let _ = writeln!(scene, "{key} = [{all}]");
    }
    let bench = Bench::new(&scene);
    bench.write("hex.msh", &msh::block(n, false, distorted));
    bench.write("tet.msh", &msh::block(n, true, distorted));
    bench
}

/// The inner node of two elements along each side is moved.
fn distorted([x, y, z]: [f64; 3]) -> [f64; 3] {
    let inside = 64.0 * x * (1.0 - x) * y * (1.0 - y) * z * (1.0 - z);
    [x + 0.1 * inside, y - 0.07 * inside, z + 0.05 * inside]
}

/// Rollers at both ends, all else free: stress along x alone, with 1/E and the coupling of shear as Lekhnitskii has them.
#[test]
fn tension_off_the_axes() {
    let conditions = [
        ("fix", "{ set = \"@.xmin\", directions = \"x\" }"),
        // Keeps it from drifting, and no more.
        ("spring", "{ set = \"@.xmin\", stiffness = [0, 0.01, 0.01] }"),
        ("move", "{ target = \"@.xmax\", by = [1e-6, 0, 0], directions = \"x\" }"),
    ];
    let history = cubes([2, 2, 2], &conditions).solve(2, &[]).history();
    let ((s, c), [e1, e2, _], nu, g) = (ANGLE.sin_cos(), YOUNG, POISSON[0], SHEAR[0]);
    let young = 1.0 / (c.powi(4) / e1 + s.powi(4) / e2 + (1.0 / g - 2.0 * nu / e1) * (s * c).powi(2));
    let (a, b) = (2.0 / e1 + 2.0 * nu / e1 - 1.0 / g, 2.0 / e2 + 2.0 * nu / e1 - 1.0 / g);
    let shear = s * c * (a * c * c - b * s * s) * young * 1e-6;
    for element in ELEMENTS {
        let of = |what: &str| history.last(&format!("{element}.xmax.{what}"));
        assert_close(&format!("{element}, force"), of("fx"), young * 1e-6, 1e-5);
        // Both ends together: the springs hold the middle of the other.
        assert_close(&format!("{element}, shear"), of("uy"), shear, 1e-4);
    }
}

/// Confined, with all nodes at the ends, the strain is ln s along x alone, and T = D E by the axes; tau_xy = T_xy x / sinh x with x = ln s.
#[test]
fn confined_tension_at_large_strain() {
    let conditions = [
        ("fix", "{ set = \"@.xmin\", directions = \"x\" }, { set = \"@\", directions = \"yz\" }"),
        ("move", "{ target = \"@.xmax\", by = [0.3, 0, 0], directions = \"x\" }"),
    ];
    let history = cubes([1, 2, 2], &conditions).solve(1, &[]).history();
    let ([e1, e2, e3], [nu12, nu13, nu23]) = (YOUNG, POISSON);
    let (a, b, c) = (-nu12 / e1, -nu13 / e1, -nu23 / e2);
    let normal = Matrix3::new(1.0 / e1, a, b, a, 1.0 / e2, c, b, c, 1.0 / e3).try_inverse().unwrap();
    let (stretch, (sine, cosine)) = (1.3f64, ANGLE.sin_cos());
    let strain = stretch.ln();
    let by_axes = Vector3::new(cosine * cosine, sine * sine, 0.0) * strain;
    let (stress, shear) = (normal * by_axes, -2.0 * SHEAR[0] * sine * cosine * strain);
    let axial = cosine * cosine * stress.x + sine * sine * stress.y - 2.0 * sine * cosine * shear;
    let across = sine * cosine * (stress.x - stress.y) + (cosine * cosine - sine * sine) * shear;
    for element in ELEMENTS {
        let of = |what: &str| history.last(&format!("{element}.xmax.{what}"));
        assert_close(&format!("{element}, along"), of("fx"), axial / stretch, 1e-9);
        assert_close(&format!("{element}, across"), of("fy"), across * strain / strain.sinh() / stretch, 1e-9);
        assert_small(&format!("{element}, aside"), of("fz"), 1e-6);
    }
}

#[test]
fn constants_that_store_no_energy_are_refused() {
    let bench = cubes([1, 1, 1], &[("fix", "{ set = \"@\" }")]);
    let scene = std::fs::read_to_string(bench.path("scene.toml")).unwrap();
    for (old, new, words) in [
        ("nu23 = 0.51", "nu23 = 1.5", "has nu23 = 1.5, where its size must be below sqrt(e2/e3) = 1.4387"),
        ("nu12 = 0.38", "nu12 = 3.4", "has constants with which some strain would store no energy"),
        ("g13 = 620", "g13 = 0", "g13 must be above 0"),
        ("orthotropic = {", "young = 3, orthotropic = {", "young does not belong to this model"),
        ("\"hex8\"", "\"hex8-eas\"", "enhanced strain may have no solution in a material that is much stiffer"),
    ] {
        bench.write("scene.toml", &scene.replacen(old, new, 1));
        let run = bench.run(1, &[]);
        assert!(run.code == 2 && run.stderr.contains(words), "{}", run.stderr);
    }
}
