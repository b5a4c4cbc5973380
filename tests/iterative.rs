//! `linear = "iterative"` and `"reuse"`: the same histories as by a factorization for each system, with few iterations, or few
//! factorizations, on any number of ranks.

mod common;

use common::{Bench, assert_small};

/// Forces over the largest, displacements over theirs, statuses and iterations of Newton's method as by factorization; and no
/// more iterations of the linear solver, for each system, than `most`.
fn compare(bench: &Bench, ranks: &[usize], most: f64) {
    let direct = bench.solve(1, &["--set", "solver.linear=direct"]);
    assert_eq!(direct.summary()["linear_iterations"], 0);
    for &n in ranks {
        let run = bench.solve(n, &["--set", "solver.linear=iterative"]);
        let difference = direct.history().difference(&run.history());
        assert_small(&format!("{n} ranks"), difference, 1e-8);
        let count = |key: &str| run.summary()[key].as_u64().unwrap();
        assert_eq!([count("factorizations"), count("linear_unsolved")], [0, 0]);
        let each = count("linear_iterations") as f64 / count("iterations") as f64;
        assert!(each > 1.0 && each < most, "{n} ranks: {each} iterations a system");
        let run = bench.solve(n, &["--set", "solver.linear=reuse"]);
        assert_small(&format!("{n} ranks, reuse"), direct.history().difference(&run.history()), 1e-8);
        let count = |key: &str| run.summary()[key].as_u64().unwrap();
        let (systems, factored) = (count("iterations"), count("factorizations"));
        println!("{n} ranks: {factored} factorizations for {systems} systems");
        assert!(10 * systems <= 11 * direct.summary()["iterations"].as_u64().unwrap());
        assert!(factored + count("linear_reused") == systems && factored < systems, "{factored} of {systems}");
    }
}

fn block_and_ball(material: &str, rest: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.block]
        block = {{ box = {{ size = [6.0, 5.0, 3.0] }}, elements = [8, 7, 4] }}
        symmetry = ["xmin"]
        {material}
        [tool.ball]
        sphere = {{ center = [2.2, 2.4, 6.0], radius = 3.0 }}
        [contact.top]
        slave = "block.zmax"
        master = "ball"
        {rest}
        "#,
    ))
}

const RUBBER: &str = r#"
    material = "soft"
    [material.soft]
    model = "neo-hookean"
    young = 10.0
    poisson = 0.3
"#;

const PRESS_AND_DRAW: &str = r#"
    friction = 0.3
    [[step]]
    increments = 2
    fix = [{ set = "block.zmin" }]
    move = [{ target = "ball", by = [0.0, 0.0, -0.3] }]
    [[step]]
    increments = 3
    fix = [{ set = "block.zmin" }]
    move = [{ target = "ball", by = [0.5, 0.3, 0.0] }]
"#;

/// Stick, slip and nodes that come and go; a plane of symmetry, of whose nodes one direction is fixed.
#[test]
fn friction_on_any_number_of_ranks() {
    compare(&block_and_ball(RUBBER, PRESS_AND_DRAW), &[1, 2, 3, 4, 7], 30.0);
}

#[test]
fn enforcements() {
    for method in ["penalty", "uzawa", "lagrange"] {
        compare(&block_and_ball(RUBBER, &format!("method = \"{method}\"\n{PRESS_AND_DRAW}")), &[2], 40.0);
    }
}

fn nearly_incompressible(poisson: f64) -> Bench {
    let material = format!(
        r#"
        element = "hex8-fbar"
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = {poisson}
        "#
    );
    block_and_ball(&material, PRESS_AND_DRAW)
}

#[test]
fn nearly_incompressible_and_plastic_bodies() {
    compare(&nearly_incompressible(0.48), &[2], 60.0);
    let plastic = r#"
        element = "hex8-fbar"
        material = "soft"
        [material.soft]
        model = "j2"
        young = 1000.0
        poisson = 0.3
        yield_stress = 5.0
        hardening = { linear = 10.0 }
    "#;
    compare(&block_and_ball(plastic, PRESS_AND_DRAW), &[2], 60.0);
}

/// A matrix that is too ill-conditioned is factored, and the user told.
#[test]
fn what_multigrid_cannot_solve_is_factored() {
    let bench = nearly_incompressible(0.4999);
    let direct = bench.solve(2, &["--set", "solver.linear=direct"]).history();
    let run = bench.solve(2, &["--set", "solver.linear=iterative"]);
    assert_small("factored", direct.difference(&run.history()), 1e-8);
    // Not tried for ever: three times in each step.
    assert_eq!(run.summary()["linear_unsolved"], 6);
    let warnings = run.summary()["warnings"].to_string();
    assert!(warnings.contains("multigrid did not converge"), "{warnings}");
}

/// The tool is a node of the system, with what it may move by.
#[test]
fn a_tool_that_a_force_drives() {
    let rest = r#"
        friction = 0.3
        [[step]]
        increments = 2
        fix = [{ set = "block.zmin" }]
        force = [{ target = "ball", total = [0.0, 0.0, -4.0], directions = "z" }]
    "#;
    compare(&block_and_ball(RUBBER, rest), &[1, 2], 40.0);
}

/// Multipliers have entries at the nodes of both bodies, on whatever rank.
#[test]
fn two_bodies_with_friction() {
    let bench = Bench::new(
        r#"
        [body.low]
        block = { box = { size = [6.0, 5.0, 2.0] }, elements = [8, 7, 3] }
        material = "soft"
        [body.high]
        block = { box = { origin = [1.1, 1.2, 2.0], size = [3.0, 2.5, 2.0] }, elements = [5, 4, 3] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [contact.joint]
        slave = "high.zmin"
        master = "low.zmax"
        friction = 0.3
        [[step]]
        increments = 2
        fix = [{ set = "low.zmin" }]
        move = [{ target = "high.zmax", by = [0.0, 0.0, -0.2] }]
        [[step]]
        increments = 3
        fix = [{ set = "low.zmin" }]
        move = [{ target = "high.zmax", by = [0.5, 0.3, 0.0] }]
        "#,
    );
    compare(&bench, &[1, 2, 3], 40.0);
}

/// One layer, of which nothing moves across: three rigid motions are left of six.
#[test]
fn plane_strain() {
    let bench = Bench::new(
        r#"
        [body.slab]
        block = { box = { size = [10.0, 3.0, 1.0] }, elements = [40, 12, 1] }
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [tool.roller]
        cylinder = { point = [4.0, 5.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 2.0 }
        [contact.top]
        slave = "slab.ymax"
        master = "roller"
        friction = 0.3
        [[step]]
        increments = 3
        fix = [{ set = "slab.ymin" }]
        move = [{ target = "roller", by = [0.0, -0.3, 0.0] }]
        [[step]]
        increments = 3
        fix = [{ set = "slab.ymin" }]
        move = [{ target = "roller", by = [0.6, 0.0, 0.0] }]
        "#,
    );
    compare(&bench, &[1, 2], 40.0);
}
