//! ```text
//!      v v v v v v  0.1      Two blocks of 1 x 1 on each other, unlike meshes, E = 2e6 Pa, nu = 0, pressed by 0.1 together: a
//!      |_|_|_|_|_|           strain of -0.05 in both, even stress (El-Abbasi and Bathe, Comput. Struct. 79 (2001) 1473-1486;
//!      |__|__|__|            Code_Aster ssnp121: -1e5 Pa by linear strain).
//!      |__|__|__| held
//! ```
//! By Hencky's law and with nu = 0 the nominal stress is E ln(0.95) / 0.95, which is -1e5 Pa to first order.

use crate::solve;
use crate::table::Oracle;

/// Mean and largest error of the nodal pressures over the closed form, with so many elements across below and above.
fn errors(below: usize, above: usize, discretization: &str) -> (f64, f64) {
    let scene = format!(
        r#"
        [body.lower]
        material = "soft"
        plane_strain = true
        block = {{ box = {{ size = [1.0, 1.0, 1.0] }}, elements = [{below}, {below}, 1] }}
        [body.upper]
        material = "soft"
        plane_strain = true
        block = {{ box = {{ origin = [0.0, 1.0, 0.0], size = [1.0, 1.0, 1.0] }}, elements = [{above}, {above}, 1] }}
        [material.soft]
        model = "hooke"
        young = 2e6
        poisson = 0.0
        [contact.joint]
        slave = "upper.ymin"
        master = "lower.ymax"
        discretization = "{discretization}"
        [[step]]
        increments = 1
        fix = [{{ set = "lower.ymin" }}]
        move = [{{ target = "upper.ymax", by = [0.0, -0.1, 0.0], directions = "xy" }}]
        [output]
        history = ["lower.ymin"]
        "#
    );
    let run = solve(1, &scene, &[]);
    let stretch: f64 = 0.95;
    let exact = -2e6 * stretch.ln() / stretch;
    // The stress in the elements: under a two-pass contact nodes share forces, and nodal pressures mean little.
    let field = run.field(&format!("increments/{:06}/body_lower/cell/stress", run.written()));
    let yy: Vec<f64> = field.chunks(6).map(|s| s[1]).collect();
    let worst = yy.iter().map(|s| (s / -exact - 1.0).abs()).fold(0.0, f64::max);
    (run.history().last("lower.ymin.fy") / exact - 1.0, worst)
}

#[test]
fn even_stress() {
    let mut oracle = Oracle::new("patch test");
    for (below, above, discretization, allowed) in [
        (4, 8, "one-pass", 1e-8f64),
        (4, 6, "two-pass", 1e-8),
        (5, 7, "two-pass", 1e-8),
        // Nodes alone do not pass an even pressure on to a grid that they do not refine.
        (4, 6, "one-pass", 0.02),
    ] {
        let (force, stress) = errors(below, above, discretization);
        let case = format!("{below}:{above}, {discretization}");
        oracle.within(&format!("force over closed form, {case}"), force + 1.0, 1.0, allowed.min(2e-3));
        oracle.within(&format!("stress, worst error, {case}"), stress, 0.0, allowed);
    }
}
