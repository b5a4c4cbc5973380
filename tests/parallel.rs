//! The number of ranks does not matter.

mod common;

use common::{Bench, assert_small};

/// Runs on one rank and on others, and compares all of the history: forces, displacements, counts, iterations.
fn compare(bench: &Bench, ranks: &[usize]) {
    let alone = bench.solve(1, &[]).history();
    for &n in ranks {
        let difference = alone.difference(&bench.solve(n, &[]).history());
        assert_small(&format!("{n} ranks"), difference, 1e-8);
    }
}

/// A ball is pressed into a block, sticks and slips, and slides askew over it.
#[test]
fn ball_on_a_block() {
    let bench = Bench::new(
        r#"
        [body.block]
        block = { box = { size = [3.0, 3.0, 1.0] }, elements = [7, 6, 2] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.4
        [tool.ball]
        sphere = { center = [1.2, 1.3, 2.0], radius = 1.0 }
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        friction = 0.25
        [[step]]
        increments = 3
        fix = [{ set = "block.zmin" }]
        move = [{ target = "ball", by = [0.0, 0.0, -0.2] }]
        [[step]]
        increments = 5
        fix = [{ set = "block.zmin" }]
        move = [{ target = "ball", by = [0.5, 0.3, 0.0] }]
        [output]
        every = 100
        history = ["block.zmin", "block.zmax"]
        "#,
    );
    compare(&bench, &[2, 3, 4]);
}

/// The indenter of the ironing example, its patches dealt out over the ranks, pressed into a coarse slab and drawn along.
#[test]
fn ironing_with_a_meshed_tool() {
    let bench = Bench::new(
        r#"
        [body.slab]
        block = { box = { origin = [-20.0, -50.0, 0.0], size = [100.0, 50.0, 1.0] }, elements = [28, 6, 1] }
        material = "rubber"
        plane_strain = true
        [material.rubber]
        model = "neo-hookean"
        young = 689.6
        poisson = 0.32
        [tool.indenter]
        mesh = "indenter.msh"
        [contact.top]
        slave = "slab.ymax"
        master = "indenter"
        friction = 0.3
        [[step]]
        increments = 5
        fix = [{ set = "slab.ymin" }]
        move = [{ target = "indenter", by = [0.0, -5.0, 0.0] }]
        [[step]]
        increments = 10
        fix = [{ set = "slab.ymin" }]
        move = [{ target = "indenter", by = [10.0, 0.0, 0.0] }]
        [output]
        every = 100
        history = ["slab.ymin"]
        "#,
    );
    bench.write("indenter.msh", include_str!("../inputs/ironing-indenter.msh"));
    compare(&bench, &[2, 3, 4]);
}

/// Eight elements on thirteen ranks: some have no element, no node, no patch.
#[test]
fn more_ranks_than_elements() {
    let bench = Bench::new(
        r#"
        [body.block]
        block = { box = { origin = [0.0, 0.0, -2.0], size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
        material = "soft"
        [material.soft]
        model = "hooke"
        young = 10.0
        poisson = 0.3
        [tool.plate]
        mesh = "plate.msh"
        [contact.top]
        slave = "block.zmax"
        master = "plate"
        friction = 0.2
        [[step]]
        increments = 2
        fix = [{ set = "block.zmin" }]
        move = [{ target = "plate", by = [0.3, 0.1, -0.2] }]
        [[step]]
        increments = 2
        fix = [{ set = "block.zmin" }]
        force = [{ target = "plate", total = [0.0, 0.0, -6.0], directions = "z" }]
        [output]
        history = ["block.zmin", "block.xmax"]
        "#,
    );
    let bowl = |s: f64, t: f64| {
        let (x, y) = (4.0 * s - 1.0, 3.0 - 4.0 * t);
        [x, y, 0.05 * ((x - 0.8).powi(2) + (y - 0.9).powi(2))]
    };
    bench.write("plate.msh", &common::msh::surface(3, bowl));
    compare(&bench, &[13]);
}
