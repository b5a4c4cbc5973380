//! ```text
//!       v v v v v v  50 MPa       Half of an elastic plate in plane strain on a rigid plane, 40 x 40 mm, E = 130 GPa, nu = 0.2,
//!      |           | <            mu = 1, pressed on top and on the side opposite the symmetry (GRECO; Code_Aster ssnv128).
//!    o |           | < 150 MPa    Displacement along the plane at 0, 1.25, 5, 7.5, 11.25 mm from the loaded side: 28.6, 27.2,
//!    o |___________| <            22.8, 19.8, 15.0 micrometres, on elements of 1.25 mm.
//!      ///////////// mu = 1
//! ```

use crate::table::Oracle;
use crate::{component, mean, solve};

const PUBLISHED: [(f64, f64); 5] = [(0.0, 28.6e-3), (1.25, 27.2e-3), (5.0, 22.8e-3), (7.5, 19.8e-3), (11.25, 15.0e-3)];

fn slips(elements: usize) -> Vec<f64> {
    let scene = format!(
        r#"
        [body.plate]
        material = "metal"
        plane_strain = true
        symmetry = ["xmin"]
        block = {{ box = {{ size = [40.0, 40.0, 1.0] }}, elements = [{elements}, {elements}, 1] }}
        [material.metal]
        model = "hooke"
        young = 130e3
        poisson = 0.2
        [tool.ground]
        plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }}
        [contact.foot]
        slave = "plate.ymin"
        master = "ground"
        friction = 1.0
        [[step]]
        name = "press"
        increments = 5
        pressure = [{{ set = "plate.ymax", value = 50.0 }}, {{ set = "plate.xmax", value = 150.0 }}]
        [output]
        every = 100
        "#
    );
    let run = solve(1, &scene, &[]);
    let moved = component(&run.vectors(run.written(), "contact.foot", "displacement"), 0);
    let points = run.points("contact.foot");
    PUBLISHED.iter().map(|(at, _)| -mean(&points, &moved, |x| (40.0 - at - x[0]).abs() < 1e-6)).collect()
}

fn against_the_published(elements: usize) {
    let mut oracle = Oracle::new("GRECO plate");
    for ((at, published), found) in PUBLISHED.into_iter().zip(slips(elements)) {
        oracle.close(&format!("displacement at {at} mm, mm"), found, published, 0.05);
    }
}

#[test]
fn as_published() {
    against_the_published(32);
}

#[test]
#[ignore = "extremes: elements of a quarter of the size"]
fn as_published_finer() {
    against_the_published(128);
}
