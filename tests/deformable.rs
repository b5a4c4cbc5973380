//! Contact between deformable bodies: exact solutions, balance, ranks, convergence, and a published problem.

mod common;

use common::{Bench, History, Run, assert_close, assert_small, msh};

/// Two blocks with nested grids, the lower one finer, are pressed together between smooth walls: uniaxial strain.
///
/// ```text
///      ______ moved by -1
///     |__|__|                z of the faces between them: 9.5
///     |_|_|_|
///     |_|_|_|  held
/// ```
fn stack(contact: &str, lower: [usize; 3], upper: [usize; 3]) -> Bench {
    let walls = ["lower", "upper"].map(|body| {
        ["x", "y"].map(|d| {
            ["min", "max"].map(|end| format!("{{ set = \"{body}.{d}{end}\", directions = \"{d}\" }}")).join(", ")
        })
    });
    Bench::new(&format!(
        r#"
        [body.lower]
        block = {{ box = {{ size = [10.0, 10.0, 10.0] }}, elements = {lower:?} }}
        material = "soft"
        [body.upper]
        block = {{ box = {{ origin = [0.0, 0.0, 10.0], size = [10.0, 10.0, 10.0] }}, elements = {upper:?} }}
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [contact.between]
        slave = "lower.zmax"
        master = "upper.zmin"
        {contact}
        [[step]]
        increments = 2
        fix = [{{ set = "lower.zmin", directions = "z" }}, {}]
        move = [{{ target = "upper.zmax", by = [0.0, 0.0, -1.0], directions = "z" }}]
        [output]
        history = ["lower.zmin", "upper.zmax"]
        "#,
        walls.concat().join(", ")
    ))
}

#[test]
fn nested_grids_pass_pressure_on_uniformly() {
    // W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J at the stretch 0.95 of both blocks.
    let (mu, lambda, stretch) = (100.0 / 2.6, 30.0 / (1.3 * 0.4), 0.95f64);
    let pressure = -(mu * (stretch - 1.0 / stretch) + lambda * stretch.ln() / stretch);
    for contact in
        ["", "smoothing = \"facet\"", "transfer = \"bilinear\"", "friction = 0.2", "tangent = \"fixed-frame\""]
    {
        let run = stack(contact, [6, 4, 3], [3, 2, 2]).solve(2, &[]);
        let history = run.history();
        assert_close(contact, history.last("upper.zmax.fz"), -100.0 * pressure, 1e-9);
        assert_close(contact, history.last("between.fz"), -100.0 * pressure, 1e-9);
        for found in run.scalars(run.written(), "contact.between", "pressure") {
            assert_close(contact, found, pressure, 1e-8);
        }
        let (nodes, moved) =
            (run.points("contact.between"), run.vectors(run.written(), "contact.between", "displacement"));
        let off = nodes.iter().zip(moved).map(|(x, u)| (x[2] + u[2] - 9.5).abs()).fold(0.0, f64::max);
        assert_small("plane between the blocks", off, 1e-9);
        assert_eq!(run.summary()["matrix"] == "symmetric indefinite", contact.contains("facet"), "{contact}");
    }
    let run = stack("transfer = \"variational\"", [6, 4, 3], [3, 2, 2]).solve(2, &[]);
    assert_eq!(run.summary()["matrix"], "symmetric indefinite");
}

/// A small block is pressed into a wide soft one, whose faces are the coarser, and drawn over it askew.
fn dragged_block(contact: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.table]
        block = {{ box = {{ size = [9.0, 8.0, 3.0] }}, elements = [7, 6, 2] }}
        material = "soft"
        [body.block]
        block = {{ box = {{ origin = [2.1, 2.2, 3.0], size = [3.0, 3.0, 2.0] }}, elements = [4, 3, 2] }}
        material = "hard"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 400.0
        poisson = 0.2
        [contact.sole]
        slave = "block.zmin"
        master = "table.zmax"
        {contact}
        [[step]]
        name = "press"
        increments = 3
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [0.0, 0.0, -0.3] }}]
        [[step]]
        name = "drag"
        increments = 8
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [1.6, 0.7, 0.0] }}]
        [output]
        every = 100
        history = ["table.zmin", "block.zmax", "table", "block"]
        "#
    ))
}

/// What is put in at the top comes out at the bottom, and in between goes through the contact.
fn check_balance(run: &Run) {
    let history = run.history();
    let scale = history.largest_force("block.zmax");
    let mut worst = 0.0f64;
    for c in ["fx", "fy", "fz"] {
        let of = |name: &str| history.column(&format!("{name}.{c}"));
        for k in 0..history.len() {
            let sums = [
                of("block.zmax")[k] + of("table.zmin")[k],
                of("block.zmax")[k] + of("sole")[k],
                of("block")[k] - of("block.zmax")[k],
                of("table")[k] - of("table.zmin")[k],
            ];
            worst = sums.iter().fold(worst, |w, s| w.max(s.abs() / scale));
        }
    }
    assert_small("balance", worst, 1e-8);
}

#[test]
fn forces_balance_and_friction_is_coulombs() {
    for transfer in ["variational", "patch", "bilinear"] {
        let run = dragged_block(&format!("friction = 0.3\ntransfer = \"{transfer}\"")).solve(2, &[]);
        check_balance(&run);
        let history = run.history();
        assert_eq!(history.last("sole.slip"), history.last("sole.active"));
        // The contact force leans by the friction angle, as far as the surface is flat.
        let [x, y, z] = ["fx", "fy", "fz"].map(|c| history.last(&format!("sole.{c}")));
        assert_close(transfer, x.hypot(y) / z, 0.3, 0.1);
        assert!(x < 0.0 && y < 0.0);
    }
}

#[test]
fn the_number_of_ranks_does_not_matter() {
    let bench = dragged_block("friction = 0.3");
    let alone = bench.solve(1, &[]).history();
    for ranks in [2, 3, 4] {
        let difference = alone.difference(&bench.solve(ranks, &[]).history());
        assert_small(&format!("{ranks} ranks"), difference, 1e-8);
    }
}

#[test]
fn more_ranks_than_elements() {
    let bench = stack("friction = 0.2", [2, 2, 1], [1, 1, 1]);
    let alone = bench.solve(1, &[]).history();
    assert_small("7 ranks", alone.difference(&bench.solve(7, &[]).history()), 1e-8);
}

/// A block falls on another from beyond the reach of the search, in one increment or in many.
#[test]
fn contact_from_afar() {
    let bench = dragged_block("friction = 0.3");
    let fall = "step.press.move.0.by=[0.0, 0.0, -5.3]";
    let scene =
        std::fs::read_to_string(bench.path("scene.toml")).unwrap().replace("[2.1, 2.2, 3.0]", "[2.1, 2.2, 8.0]");
    let bench = Bench::new(&scene);
    let [many, one] = ["20", "1"].map(|n| {
        let increments = format!("step.press.increments={n}");
        bench.solve(2, &["--set", fall, "--set", &increments]).history()
    });
    let difference = one.row_difference(one.len() - 1, &many, many.len() - 1, &["block.zmax", "table.zmin"]);
    assert_small("one fall", difference, 1e-8);
}

/// Both sides are prescribed along the slide and held across it: no node can stick.
#[test]
fn nodes_drawn_along_each_other() {
    let scene = std::fs::read_to_string(dragged_block("friction = 0.3").path("scene.toml")).unwrap();
    // A rigid sole on a master that is coarser would be held more often than there are nodes to give way.
    let start = scene[..scene.find("[[step]]").unwrap()].replace("[7, 6, 2]", "[18, 16, 2]");
    let step = r#"
        [[step]]
        increments = 4
        fix = [{ set = "table", directions = "xy" }, { set = "table.zmin" }]
        move = [{ target = "block", by = [0.4, 0.0, -0.1] }]
        [output]
        every = 100
        history = ["table", "block"]
    "#;
    let history = Bench::new(&format!("{start}{step}")).solve(2, &[]).history();
    assert!(history.column("sole.stick").iter().all(|&n| n == 0.0) && history.last("sole.slip") == 20.0);
    assert_close("friction", -history.last("sole.fx") / history.last("sole.fz"), 0.3, 0.1);
    assert_close("balance", -history.last("table.fx") / history.last("block.fx"), 1.0, 1e-9);
}

/// Half of a symmetric model gives half of the forces; slave nodes on the plane of symmetry are held on the master.
#[test]
fn half_of_a_symmetric_model() {
    let scene = |half: bool| {
        let (from, share, hold) = if half {
            ([0.0, 0.0], 2, r#"{ set = "table.ymin", directions = "y" }, { set = "block.ymin", directions = "y" },"#)
        } else {
            ([-3.0, -1.5], 1, "")
        };
        Bench::new(&format!(
            r#"
            [body.table]
            block = {{ box = {{ origin = [0.0, {}, 0.0], size = [8.0, {}, 2.0] }}, elements = [6, {}, 2] }}
            material = "soft"
            [body.block]
            block = {{ box = {{ origin = [2.1, {}, 2.0], size = [3.0, {}, 2.0] }}, elements = [3, {}, 1] }}
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [contact.sole]
            slave = "block.zmin"
            master = "table.zmax"
            smoothing = "facet"
            friction = 0.3
            [[step]]
            increments = 2
            fix = [{hold} {{ set = "table.zmin" }}]
            move = [{{ target = "block.zmax", by = [0.0, 0.0, -0.02] }}]
            [[step]]
            increments = 4
            fix = [{hold} {{ set = "table.zmin" }}]
            move = [{{ target = "block.zmax", by = [0.06, 0.0, 0.0] }}]
            [output]
            every = 100
            history = ["block.zmax"]
            "#,
            from[0],
            6.0 / share as f64,
            4 / share,
            from[1],
            3.0 / share as f64,
            4 / share,
        ))
    };
    let [whole, half] = [false, true].map(|half| scene(half).solve(2, &[]).history());
    let force = whole.largest_force("block.zmax");
    for k in 0..whole.len() {
        for c in ["fx", "fz"] {
            let [whole, half] = [&whole, &half].map(|h| h.column(&format!("block.zmax.{c}"))[k]);
            // The ridge between two facets on the plane has one normal, in the half as in the whole.
            assert_small("half of the force", (2.0 * half - whole) / force, 1e-9);
        }
    }
    assert!(half.last("sole.slip") > 0.0);
}

/// Residuals over the largest force at the iterations of each increment.
fn residuals(log: &str) -> Vec<Vec<f64>> {
    let traces = log.lines().filter_map(|line| line.trim().strip_prefix("residual/force (status changes): "));
    let number = |word: &str| word.parse::<f64>().ok();
    traces.map(|trace| trace.split_whitespace().filter_map(number).collect()).collect()
}

#[test]
fn iterations_converge_quadratically() {
    let run = dragged_block("friction = 0.3").solve(1, &["--set", "solver.tolerance=1e-13"]);
    let mut seen = 0;
    for trace in residuals(&run.log()) {
        println!("{trace:?}");
        for pair in trace.windows(2).filter(|pair| (1e-6..1e-3).contains(&pair[0])) {
            assert!(pair[1] < 100.0 * pair[0] * pair[0], "{trace:?}");
            seen += 1;
        }
    }
    assert!(seen >= 3, "{seen}");
}

/// A ring cut open and held at one end: a pressure around it closes the cut, two faces of one body.
#[test]
fn a_body_meets_itself() {
    let bench = Bench::new(
        r#"
        [body.ring]
        block = { sector = { radii = [3.0, 4.0], angles = [4.0, 356.0], length = 1.0 }, elements = [3, 48, 1] }
        material = "soft"
        plane_strain = true
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [contact.ends]
        slave = "ring.amin"
        master = "ring.amax"
        friction = 0.2
        [[step]]
        increments = 12
        fix = [{ set = "ring.amax" }]
        pressure = [{ set = "ring.rmax", value = 0.02 }]
        [output]
        every = 100
        history = ["ring"]
        "#,
    );
    let history = bench.solve(2, &[]).history();
    assert!(history.column("ends.active")[0] == 0.0 && history.last("ends.active") >= 1.0);
    assert!(history.last("ends.fy") > 0.0, "the held end pushes the other one back");
}

/// The press of the elastic indenter of the ironing problem against a two-dimensional code written independently.
#[test]
fn elastic_indenter() {
    let folder = env!("CARGO_MANIFEST_DIR");
    let scene = std::fs::read_to_string(format!("{folder}/inputs/ironing-deformable.toml")).unwrap();
    let bench = Bench::new(&scene);
    bench.write("ironing-indenter-elastic.msh", include_str!("../inputs/ironing-indenter-elastic.msh"));
    let run = bench.solve(2, &["--steps", "1", "--set", "output.every=100"]);
    let history = run.history();
    let vertical = [805.4, 1669.5, 2577.5, 3513.4, 4506.49];
    for (k, expected) in vertical.into_iter().enumerate() {
        let row = 4 * k + 3;
        assert_close("vertical force", -history.column("indenter.top.fy")[row], expected, 5e-3);
    }
    let worst = (0..history.len())
        .flat_map(|k| {
            ["fx", "fy"].map(|c| {
                history.column(&format!("indenter.top.{c}"))[k] + history.column(&format!("slab.bottom.{c}"))[k]
            })
        })
        .fold(0.0f64, |w, s| w.max(s.abs()));
    assert_small("balance", worst / 4506.0, 1e-8);
}

/// Half a roller on half a slab, or the whole: the plane x = 0 in which the halves are held is one of symmetry.
///
/// ```text
///      \      |      /    The roller is moved down by 0.6 and its shape is that of Nagata patches; the grids
///    ___\_ _  | _  _/___  are mirrored, with nodes in the plane.
///   |         |         |
///   |_________|_________|
/// ```
fn pressed_roller(halves: usize, contact: &str, symmetry: bool) -> Bench {
    let body = |groups: &str| if symmetry && halves == 1 { format!("symmetry = {groups}") } else { String::new() };
    let fix = match halves {
        1 if !symmetry => {
            ", { set = \"slab.xmin\", directions = \"x\" }, { set = \"roller.amin\", directions = \"x\" }"
        }
        _ => "",
    };
    let (from, left) = if halves == 1 { (270, 0.0) } else { (210, -12.0) };
    Bench::new(&format!(
        r#"
        [body.slab]
        block = {{ box = {{ origin = [{left:?}, -8.0, 0.0], size = [{}, 8.0, 2.0] }}, elements = [{}, 6, 2] }}
        material = "soft"
        {}
        [body.roller]
        block = {{ sector = {{ center = [0.0, 10.0, 0.0], radii = [6.0, 10.0], angles = [{from}, 330], length = 2.0 }}, elements = [3, {}, 2] }}
        material = "hard"
        {}
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 300.0
        poisson = 0.3
        [contact.line]
        slave = "slab.ymax"
        master = "roller.rmax"
        {contact}
        [[step]]
        increments = 3
        fix = [{{ set = "slab.ymin" }}{fix}]
        move = [{{ target = "roller.rmin", by = [0.0, -0.6, 0.0] }}]
        [output]
        history = ["slab.ymin", "roller.rmin"]
        "#,
        12.0 * halves as f64,
        9 * halves,
        body("[\"xmin\"]"),
        5 * halves,
        body("[\"amin\"]"),
    ))
}

#[test]
fn half_with_a_plane_of_symmetry_is_half_of_the_whole() {
    for transfer in ["patch", "variational", "bilinear"] {
        let contact = format!("friction = 0.2\ntransfer = \"{transfer}\"");
        let [half, whole] = [1, 2].map(|halves| pressed_roller(halves, &contact, true).solve(2, &[]).history());
        let cut = pressed_roller(1, &contact, false).solve(2, &[]).history();
        let of = |history: &History, c: &str| history.last(&format!("line.{c}"));
        // Nodes in the plane are on both of the patches that meet there with a kink.
        let lopsided = (of(&whole, "fx") / of(&whole, "fy")).abs();
        assert!(lopsided < 1e-12, "{lopsided}");
        assert_close(transfer, 2.0 * of(&half, "fy"), of(&whole, "fy"), 1e-9);
        // Held, but without the normals of the whole.
        assert!((2.0 * of(&cut, "fy") / of(&whole, "fy") - 1.0).abs() > 1e-3);
    }
}

/// Uniform pressure on a block of quadratic tetrahedra between a plane and another block, of hexahedra that are half as fine, or
/// of such tetrahedra: forces at corners of faces are nothing, and the pressure is even all the same.
#[test]
fn quadratic_faces_pass_on_an_even_pressure() {
    const YOUNG: f64 = 100.0;
    let mesh = |low: f64| msh::second_order(&msh::block([2, 2, 2], true, |[x, y, z]| [x, y, low + z]));
    let hexahedra = "block = { box = { origin = [0.0, 0.0, -1.0], size = [1.0, 1.0, 1.0] }, elements = [2, 2, 2] }";
    for (ranks, friction, lower) in [(1, 0.0, hexahedra), (2, 0.5, "mesh = \"lower.msh\"")] {
        let bench = Bench::new(&format!(
            r#"
            [body.upper]
            mesh = "upper.msh"
            material = "soft"
            [body.lower]
            {lower}
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = {YOUNG:?}
            poisson = 0.0
            [tool.plane]
            plane = {{ point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }}
            [contact.roof]
            slave = "upper.zmax"
            master = "plane"
            friction = {friction:?}
            [contact.between]
            slave = "upper.zmin"
            master = "lower.zmax"
            friction = {friction:?}
            [[step]]
            increments = 2
            fix = [{{ set = "upper.xmin", directions = "x" }}, {{ set = "upper.ymin", directions = "y" }},
                   {{ set = "lower.xmin", directions = "x" }}, {{ set = "lower.ymin", directions = "y" }},
                   {{ set = "lower.zmin", directions = "z" }}]
            move = [{{ target = "plane", by = [0.0, 0.0, -0.2] }}]
            "#
        ));
        bench.write("upper.msh", &mesh(0.0));
        bench.write("lower.msh", &mesh(-1.0));
        let run = bench.solve(ranks, &[]);
        // Each block is shortened to 0.9, and its sides stay where they are.
        let pressure = 0.5 * YOUNG * (1.0 - 0.81) / 0.9;
        for contact in ["roof", "between"] {
            let found = run.scalars(run.written(), &format!("contact.{contact}"), "pressure");
            assert_eq!(found.len(), 25);
            let worst = found.iter().map(|p| (p / pressure - 1.0).abs()).fold(0.0, f64::max);
            assert_small(contact, worst, 1e-9);
        }
        let largest = run.history().last("between.max_pressure");
        assert_close("largest pressure", largest, pressure, 1e-9);
    }
}

/// Half of a block of quadratic tetrahedra under a ball that is pressed and drawn in its plane of symmetry: pressures and shear are
/// shown as on the whole, at the plane, too, where half of what edges share is the mirror image's.
#[test]
fn tractions_at_a_plane_of_symmetry_are_those_of_the_whole() {
    let half = msh::block([4, 2, 2], true, |[x, y, z]| [2.0 * x, y, z]);
    let run = |mesh: &str, more: &str| {
        let bench = Bench::new(&format!(
            r#"
            [body.b]
            mesh = "b.msh"
            material = "m"
            {more}
            [material.m]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [tool.t]
            sphere = {{ center = [1.1, 3.0, 0.0], radius = 2.0 }}
            [contact.c]
            slave = "b.ymax"
            master = "t"
            friction = 0.3
            [[step]]
            increments = 3
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "t", by = [0.05, -0.2, 0.0] }}]
            "#
        ));
        bench.write("b.msh", &msh::second_order(mesh));
        bench.solve(2, &[])
    };
    let (half, whole) = (run(&half, "symmetry = [\"zmin\"]"), run(&msh::with_mirror_image(&half), ""));
    let shown = |run: &Run| -> Vec<([f64; 3], f64)> {
        run.points("contact.c").into_iter().zip(run.scalars(run.written(), "contact.c", "pressure")).collect()
    };
    let (half, whole) = (shown(&half), shown(&whole));
    let largest = whole.iter().map(|(_, p)| p.abs()).fold(0.0, f64::max);
    let mut in_plane = 0;
    for (x, p) in &half {
        let (_, other) = whole.iter().find(|(y, _)| (0..3).all(|d| (x[d] - y[d]).abs() < 1e-9)).unwrap();
        assert_small(&format!("{x:?}"), (p - other) / largest, 1e-7);
        in_plane += usize::from(x[2] == 0.0 && p.abs() > 0.1 * largest);
    }
    assert!(in_plane > 2, "{in_plane}");
}

/// A block stands on a larger one, and a second contact names its side, behind which all is that it stands on: that bears nothing,
/// whether the two faces are in one plane or the block is a little in or off.
#[test]
fn the_side_of_what_stands_on_a_slave_does_not_push() {
    let run = |z: f64, side: &str, ranks: usize| {
        Bench::new(&format!(
            "[body.small]\nmaterial = \"m\"\n\
             block = {{ box = {{ origin = [0.0, 0.0, {z:?}], size = [1.0, 1.0, 1.0] }}, elements = [4, 1, 4] }}\n\
             [body.big]\nmaterial = \"m\"\nblock = {{ box = {{ size = [2.0, 1.0, 1.0] }}, elements = [8, 1, 4] }}\n\
             [material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [contact.under]\nslave = \"big.zmax\"\nmaster = \"small.zmin\"\n{side}\
             [[step]]\nincrements = 4\nfix = [{{ set = \"big.zmin\" }}]\n\
             move = [{{ target = \"small.zmax\", by = [0.0, 0.0, -0.01] }}]\n"
        ))
        .solve(ranks, &[])
    };
    let side = "[contact.side]\nslave = \"big.zmax\"\nmaster = \"small.xmax\"\n";
    for z in [1.0, 1.0 - 1e-3, 1.0 + 1e-3] {
        let [alone, beside] = ["", side].map(|side| run(z, side, 2));
        let (alone, history) = (alone.history(), beside.history());
        assert!(!beside.log().contains("inside `small.xmax`"), "{}", beside.log());
        for component in ["fx", "fy", "fz"] {
            assert_eq!(history.last(&format!("side.{component}")), 0.0);
            let force = [&alone, &history].map(|history| history.last(&format!("under.{component}")));
            assert_small("side", (force[1] - force[0]) / 0.28, 1e-9);
        }
        assert_eq!(history.last("side.max_penetration"), 0.0);
    }
}

/// Six thin sheets that lie on each other, held at one end, are bent by a roller at the other: all that lies on each other begins to
/// bear at once, and slips. Loaded one way, they end at the same force in few increments and in many, a little above that without
/// friction, and the held ends bear what the roller presses with.
#[test]
fn sheets_that_lie_on_each_other_bend() {
    const SHEETS: usize = 6;
    let bend = |friction: f64, increments: usize| {
        let sheet = |k: usize| {
            format!(
                "[body.s{k}]\nmaterial = \"p\"\nelement = \"hex8-eas\"\nplane_strain = true\nblock = {{ box = {{ origin = [0.0, {:?}, 0.0], size = [20.0, 0.2, 0.5] }}, elements = [40, 2, 1] }}\n",
                0.2 * k as f64
            )
        };
        let contact = |k: usize| {
            format!("[contact.k{k}]\nslave = \"s{k}.ymax\"\nmaster = \"s{}.ymin\"\nfriction = {friction:?}\n", k + 1)
        };
        let bodies: String = (0..SHEETS).map(sheet).chain((0..SHEETS - 1).map(contact)).collect();
        let ends = |of: &dyn Fn(usize) -> String| (0..SHEETS).map(of).collect::<Vec<_>>().join(", ");
        let history = Bench::new(&format!(
            "{bodies}[material.p]\nmodel = \"hooke\"\nyoung = 2000.0\npoisson = 0.3\n\
             [tool.roll]\ncylinder = {{ point = [18.0, {:?}, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }}\n\
             [contact.r]\nslave = \"s{}.ymax\"\nmaster = \"roll\"\n\
             [[step]]\nname = \"bend\"\nincrements = {increments}\nfix = [{}]\n\
             move = [{{ target = \"roll\", by = [0.0, -4.0, 0.0] }}]\n[output]\nevery = 1000\nhistory = [{}]\n",
            0.2 * SHEETS as f64 + 1.0,
            SHEETS - 1,
            ends(&|k| format!("{{ set = \"s{k}.xmin\" }}")),
            ends(&|k| format!("\"s{k}.xmin\"")),
        ))
        .solve(1, &[])
        .history();
        let force = history.last("roll.fy");
        let held: f64 = (0..SHEETS).map(|k| history.last(&format!("s{k}.xmin.fy"))).sum();
        assert_small("balance", (held + force) / force, 1e-8);
        force
    };
    let (many, few, smooth) = (bend(0.3, 20), bend(0.3, 4), bend(0.0, 4));
    assert_close("whatever the increments", many, few, 1e-8);
    assert!((1.0..1.1).contains(&(many / smooth)), "{many} {smooth}");
}
