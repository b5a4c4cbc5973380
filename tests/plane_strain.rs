//! `plane_strain = true` is the same as holding all nodes along z, with one plane of nodes.

mod common;

use common::{Bench, assert_small};

/// ```text
///        ( O )  ->            One layer of elements. Tied planes halve the displacements and the multipliers; forces, places
///     ___/   \_____           and pressures stay.
///    |_____________| held
/// ```
#[test]
fn as_if_held_along_z() {
    let scene = |body: &str, fix: &str| {
        let fix = format!("fix = [{{ set = \"slab.ymin\" }}{fix}]");
        Bench::new(&format!(
            r#"
            [body.slab]
            block = {{ box = {{ origin = [-4.0, -3.0, 0.0], size = [8.0, 3.0, 0.5] }}, elements = [16, 5, 1] }}
            material = "soft"
            {body}
            [material.soft]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [tool.roll]
            cylinder = {{ point = [0.0, 2.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }}
            [contact.top]
            slave = "slab.ymax"
            master = "roll"
            friction = 0.3
            [[step]]
            increments = 3
            {fix}
            move = [{{ target = "roll", by = [0.0, -0.4, 0.0] }}]
            [[step]]
            increments = 5
            {fix}
            move = [{{ target = "roll", by = [0.8, 0.0, 0.0] }}]
            force = [{{ target = "slab.xmax", total = [1.0, 0.5, 0.0] }}]
            body_force = [{{ body = "slab", per_volume = [0.0, -0.05, 0.0] }}]
            pressure = [{{ set = "slab.xmin", value = 0.5 }}]
            [output]
            history = ["slab.ymin", "slab.xmax"]
            "#
        ))
    };
    let tied = scene("plane_strain = true", "").solve(2, &[]);
    let held = scene("", ", { set = \"slab\", directions = \"z\" }").solve(2, &[]);
    let (a, b) = (tied.history(), held.history());
    assert_eq!(a.len(), b.len());
    assert!(a.column("top.slip").iter().any(|n| *n > 0.0) && a.column("top.stick").iter().any(|n| *n > 0.0));
    let scale = b.column("roll.fy").iter().fold(0.0f64, |m, f| m.max(f.abs()));
    for set in ["roll", "slab.ymin", "slab.xmax"] {
        for (component, scale) in [("fx", scale), ("fy", scale), ("fz", scale), ("ux", 1.0), ("uy", 1.0), ("uz", 1.0)] {
            let name = format!("{set}.{component}");
            let pairs = a.column(&name).iter().zip(b.column(&name));
            let worst = pairs.map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max);
            assert_small(&name, worst, 1e-8);
        }
    }
    for (name, ratio) in [("max_pressure", 1.0), ("active", 0.5), ("stick", 0.5), ("slip", 0.5)] {
        let name = format!("top.{name}");
        let worst = a.column(&name).iter().zip(b.column(&name)).map(|(a, b)| (a - ratio * b).abs()).fold(0.0, f64::max);
        assert_small(&name, worst, 1e-7);
    }
    // The two planes of the body look alike.
    let (points, moved) = (tied.points("body.slab"), tied.vectors(tied.written(), "body.slab", "displacement"));
    let (held_points, held_moved) =
        (held.points("body.slab"), held.vectors(held.written(), "body.slab", "displacement"));
    assert_eq!(points.len(), held_points.len());
    for (x, u) in points.iter().zip(&moved) {
        let other = held_points.iter().position(|y| x == y).unwrap();
        assert!((0..3).all(|d| (u[d] - held_moved[other][d]).abs() < 1e-9));
    }
    let dofs = |run: &common::Run| run.summary()["dofs"].as_u64().unwrap();
    println!("{} and {} dofs", dofs(&tied), dofs(&held));
    assert_eq!(2 * dofs(&tied), dofs(&held));
}
