//! Forces of tools, supports and loads add up to nothing in every increment.

mod common;

use common::{Bench, assert_small};

/// ```text
///        (O) -> x, y         A ball is pressed into a block and slides askew over it, while the block is pushed at a side and
///     ___\_/____             by its weight; the bottom is held. Ball + bottom + side + weight = 0 along x, y and z.
///    |          |<- side
///    |__________| held
/// ```
#[test]
fn tool_support_and_loads() {
    let (push, weight) = ([0.3, -0.2, 0.1], [0.02, 0.01, -0.05]);
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        block = {{ box = {{ size = [3.0, 3.0, 1.0] }}, elements = [8, 8, 2] }}
        material = "soft"
        element = "hex8-fbar"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.4
        [tool.ball]
        sphere = {{ center = [1.2, 1.3, 3.0], radius = 2.0 }}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        friction = 0.25
        [[step]]
        name = "press"
        increments = 3
        fix = [{{ set = "block.zmin" }}]
        move = [{{ target = "ball", by = [0.0, 0.0, -0.2] }}]
        force = [{{ target = "block.xmax", total = {push:?} }}]
        body_force = [{{ body = "block", per_volume = {weight:?} }}]
        [[step]]
        name = "slide"
        increments = 6
        fix = [{{ set = "block.zmin" }}]
        move = [{{ target = "ball", by = [0.5, 0.3, -0.02] }}]
        force = [{{ target = "block.xmax", total = {push:?} }}]
        body_force = [{{ body = "block", per_volume = {weight:?} }}]
        [output]
        every = 100
        history = ["block.zmin", "block"]
        "#
    ));
    let history = bench.solve(2, &[]).history();
    let largest =
        ["fx", "fy", "fz"].map(|c| history.column(&format!("ball.{c}")).iter().fold(0.0f64, |m, f| m.max(f.abs())));
    println!("ball {largest:?}, {:?} stick, {:?} slip", history.column("top.stick"), history.column("top.slip"));
    let scale = largest[2];
    assert!(largest[0] > 0.1 * scale && largest[1] > 0.05 * scale);
    assert!(
        history.column("top.slip").iter().any(|&n| n > 3.0) && history.column("top.stick").iter().any(|&n| n > 3.0)
    );
    let mut worst = 0.0f64;
    for k in 0..history.len() {
        let ramp = if history.steps[k] == "press" { history.column("time")[k] } else { 1.0 };
        for (d, c) in ["fx", "fy", "fz"].iter().enumerate() {
            let reactions = history.column(&format!("ball.{c}"))[k] + history.column(&format!("block.zmin.{c}"))[k];
            let loads = ramp * (push[d] + weight[d] * 9.0);
            worst = worst.max((reactions + loads).abs() / scale);
            // The nodes that are not held are in equilibrium.
            let all = history.column(&format!("block.{c}"))[k] - history.column(&format!("block.zmin.{c}"))[k];
            worst = worst.max(all.abs() / scale);
        }
    }
    assert_small("balance", worst, 1e-8);
}
