//! Which nodes are kept out of what: one pass, two passes, node to node. The contact patch test, balance, ranks, and what is
//! said about the choice of slave and master.

mod common;

use common::{Bench, Run, assert_close, assert_small, nagata, sector};
use nagata::Vec3;
use std::path::Path;

/// Cauchy stress of W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J in uniaxial strain: both cubes go from 10 to 9.5.
fn exact_stress() -> f64 {
    let (young, poisson, stretch) = (100.0, 0.3, 0.95f64);
    let (mu, lambda) = (young / (2.0 + 2.0 * poisson), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    // J is the stretch: sigma = (mu (stretch^2 - 1) + lambda ln J) / J.
    let stress = (mu * (stretch * stretch - 1.0) + lambda * stretch.ln()) / stretch;
    assert_close("stress of the reference", stress, -7.062346, 1e-7);
    stress
}

fn patch_test(ranks: usize, settings: &[&str]) -> Run {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/patch-test.toml");
    let settings: Vec<&str> = settings.iter().flat_map(|s| ["--set", s]).collect();
    Bench::new(&std::fs::read_to_string(scene).unwrap()).solve(ranks, &settings)
}

const COARSE_SLAVE: [&str; 3] =
    ["contact.joint.discretization=one-pass", "contact.joint.slave=lower.top", "contact.joint.master=upper.bottom"];
const FINE_SLAVE: [&str; 1] = ["contact.joint.discretization=one-pass"];

/// Largest error of sigma_zz over all elements, relative.
fn stress_error(run: &Run) -> f64 {
    let exact = exact_stress();
    let of = |body| run.field(&format!("increments/{:06}/body_{body}/cell/stress", run.written()));
    let all = [of("lower"), of("upper")].concat();
    all.as_chunks::<6>().0.iter().map(|s| (s[2] / exact - 1.0).abs()).fold(0.0, f64::max)
}

/// Largest distance of the points of a grid from the plane z = 9.5.
fn bump(run: &Run, grid: &str) -> f64 {
    let moved = run.vectors(run.written(), grid, "displacement");
    run.points(grid).iter().zip(moved).map(|(x, u)| (x[2] + u[2] - 9.5).abs()).fold(0.0, f64::max)
}

/// Uniform stress and pressure, forces by area, a plane between the cubes, balance.
fn passes(run: &Run, sides: &[(&str, f64)]) {
    let stress = exact_stress();
    assert_small("uniform stress", stress_error(run), 1e-8);
    for (grid, edge) in sides {
        assert_small("plane", bump(run, grid), 1e-9);
        let forces = run.vectors(run.written(), grid, "force");
        let up = if *grid == "contact.joint" { 1.0 } else { -1.0 };
        for ((x, force), pressure) in
            run.points(grid).iter().zip(forces).zip(run.scalars(run.written(), grid, "pressure"))
        {
            // Half a facet less on each side that ends.
            let share = |t: f64| if (t - 5.0).abs() > 4.99 { 0.5 * edge } else { *edge };
            assert_close("nodal force", force[2], -up * stress * share(x[0]) * share(x[1]), 1e-8);
            assert_close("pressure", pressure, -stress, 1e-8);
        }
    }
    let history = run.history();
    for (name, sign) in [("joint", 1.0), ("lower.bottom", 1.0), ("upper.top", -1.0)] {
        assert_close(name, history.last(&format!("{name}.fz")), -100.0 * sign * stress, 1e-9);
    }
    assert_close("largest pressure", history.last("joint.max_pressure"), -stress, 1e-8);
    assert_small("penetration", history.last("joint.max_penetration"), 1e-10);
}

#[test]
fn two_passes_pass_the_patch_test() {
    let sides = [("contact.joint", 2.0), ("contact.joint.master", 10.0 / 3.0)];
    let runs = ["nagata", "facet"].map(|s| patch_test(2, &[&format!("contact.joint.smoothing={s}")]));
    runs.iter().for_each(|run| passes(run, &sides));
    let [nagata, facet] = runs.each_ref().map(Run::history);
    assert_small("patches and facets", nagata.difference(&facet), 1e-10);
    // 36 nodes above and 16 below, of which the corners yield.
    assert_eq!(nagata.last("joint.active"), 48.0);
    for smoothing in ["nagata", "facet"] {
        let friction = ["contact.joint.friction=0.3", &format!("contact.joint.smoothing={smoothing}")];
        passes(&patch_test(1, &friction), &sides);
    }
}

#[test]
fn node_to_node_passes_the_patch_test() {
    let conforming = ["contact.joint.discretization=node-to-node", "body.lower.block.elements=[5, 5, 4]"];
    for friction in ["contact.joint.friction=0.0", "contact.joint.friction=0.3"] {
        let run = patch_test(2, &[&conforming[..], &[friction]].concat());
        passes(&run, &[("contact.joint", 2.0)]);
    }
}

#[test]
fn one_pass_fails_the_patch_test_most_with_the_coarse_slave() {
    let (coarse, fine) = (patch_test(1, &COARSE_SLAVE), patch_test(1, &FINE_SLAVE));
    // Facets and patches differ here: the faces between the cubes do not stay flat.
    for (run, stress, flatness) in [(&coarse, 0.4296, 0.1064), (&fine, 0.0566, 0.0235)] {
        assert_close("stress error", stress_error(run), stress, 0.01);
        assert_close("flatness of the slave", bump(run, "contact.joint"), flatness, 0.01);
        assert_small("nodes of the slave are on the master", run.history().last("joint.max_penetration"), 1e-12);
    }
    assert!(stress_error(&coarse) > 3.0 * stress_error(&fine));
}

/// A block is pressed into a table of the same pitch and drawn over it, so that nodes pass over nodes.
fn dragged(contact: &str, by: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.table]
        block = {{ box = {{ size = [7.0, 4.0, 2.0] }}, elements = [7, 4, 1] }}
        material = "soft"
        [body.block]
        block = {{ box = {{ origin = [1.0, 1.0, 2.0], size = [3.0, 2.0, 1.5] }}, elements = [3, 2, 1] }}
        material = "hard"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 200.0
        poisson = 0.3
        [contact.sole]
        slave = "block.zmin"
        master = "table.zmax"
        {contact}
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [0.0, 0.0, -0.2] }}]
        [[step]]
        name = "drag"
        increments = 10
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [{by}, 0.0] }}]
        [output]
        every = 100
        history = ["block.zmax", "table.zmin"]
        "#
    ))
}

#[test]
fn two_passes_slide_far_whatever_the_ranks() {
    // The last one passes nodes by a tenth of an element at most. Exactly over nodes, rounding decides the path.
    for (contact, by) in [
        ("smoothing = \"facet\"\nfriction = 0.3", "2.0, 0.3"),
        ("smoothing = \"nagata\"", "2.0, 0.3"),
        ("smoothing = \"nagata\"\nfriction = 0.3", "2.0, 0.1"),
    ] {
        let bench = dragged(&format!("discretization = \"two-pass\"\n{contact}"), by);
        let one = bench.solve(1, &[]);
        let history = one.history();
        assert_eq!((history.len(), one.summary()["cutbacks"].as_u64()), (12, Some(0)), "{contact}");
        for c in ["fx", "fy", "fz"] {
            let of = |name: &str| history.column(&format!("{name}.{c}"));
            for k in 0..history.len() {
                let scale = history.largest_force("block.zmax");
                assert_small("what is held above and below", (of("block.zmax")[k] + of("table.zmin")[k]) / scale, 1e-9);
                assert_small("what the table gives the block", (of("block.zmax")[k] + of("sole")[k]) / scale, 1e-9);
            }
        }
        // The forces of both blocks are those on all nodes of a side, own and received.
        for (grid, sign) in [("contact.sole", 1.0), ("contact.sole.master", -1.0)] {
            let forces = one.vectors(one.written(), grid, "force");
            let sum: f64 = forces.iter().map(|f| f[2]).sum();
            assert_close(grid, sum, sign * history.last("sole.fz"), 1e-9);
        }
        for ranks in 2..=4 {
            let other = bench.solve(ranks, &[]).history();
            assert_small(&format!("{contact}, {ranks} ranks"), other.difference(&history), 1e-8);
        }
    }
}

/// The block turns, and nodes of the table leave the contact to nodes of it that are a little aside, beside which it is lower.
#[test]
fn nodes_that_two_passes_leave_in_the_master_are_told_of() {
    let told = "a node that stands on one of the other side, to which it leaves the contact, was";
    let turn = "step.drag.move=[{ target = \"block.zmax\", rotate = { point = [2.5, 2.0, 3.5], axis = [0, 1, 0], angle = 8 } }]";
    for (contact, distance, is_told) in
        [("two-pass", 0.05, true), ("two-pass", 0.005, false), ("one-pass", 0.05, false)]
    {
        let bench = dragged(&format!("smoothing = \"facet\"\ndiscretization = \"{contact}\""), "0.0, 0.0");
        let distance = format!("controls.repeat_distance={distance:?}");
        let run = bench.solve(1, &["--set", turn, "--set", &distance, "--set", "step.drag.increments=6"]);
        assert_eq!(run.log().contains(told), is_told, "{contact}, {distance}");
    }
}

/// Two blocks on conforming meshes, or one of their height, are pressed and sheared; `grip` is how they are held together.
fn sheared(bodies: &str, grip: &str, foot: &str, by: f64) -> Run {
    Bench::new(&format!(
        r#"
        {bodies}
        {grip}
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [[step]]
        increments = 4
        fix = [{{ set = "{foot}.zmin" }}]
        move = [{{ target = "upper.zmax", by = [{by}, 0.0, -0.2] }}]
        [output]
        every = 100
        history = ["{foot}.zmin", "upper.zmax"]
        "#
    ))
    .solve(2, &[])
}

fn block(name: &str, z: f64, height: f64, layers: usize) -> String {
    format!(
        "[body.{name}]\nmaterial = \"soft\"\n[body.{name}.block]\nelements = [3, 2, {layers}]\n\
         box = {{ origin = [0.0, 0.0, {z:.1}], size = [6.0, 4.0, {height:.1}] }}\n"
    )
}

fn by_node(friction: f64) -> String {
    format!(
        "[contact.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.zmax\"\ndiscretization = \"node-to-node\"\n\
         friction = {friction}\n"
    )
}

#[test]
fn nodes_that_stick_to_nodes_make_one_body_of_two() {
    let two = block("lower", 0.0, 2.0, 1) + &block("upper", 2.0, 2.0, 1);
    let (held, whole) =
        (sheared(&two, &by_node(20.0), "lower", 0.05), sheared(&block("upper", 0.0, 4.0, 2), "", "upper", 0.05));
    assert_eq!(held.history().last("joint.stick"), 12.0);
    for c in ["fx", "fz"] {
        let column = format!("upper.zmax.{c}");
        assert_close(c, held.history().last(&column), whole.history().last(&column), 1e-9);
    }
}

/// What turns as one, pressed together, bears the same force, which turns too, and none of it slips.
#[test]
fn forces_from_node_to_node_turn_with_the_bodies() {
    let angle = 60.0f64;
    for friction in [0.0, 0.3] {
        let turned = format!("rotate = {{ point = [1.0, 1.5, 0.5], axis = [1.0, 0.0, 0.0], angle = {angle:.1} }}");
        let run = Bench::new(&format!(
            "{}{}{}[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nincrements = 2\nfix = [{{ set = \"lower.zmin\" }}]\n\
             move = [{{ target = \"upper.zmax\", by = [0.0, 0.0, -0.2] }}]\n\
             [[step]]\nincrements = 6\n\
             move = [{{ target = \"lower.zmin\", {turned} }}, {{ target = \"upper.zmax\", {turned} }}]\n\
             [output]\nhistory = [\"lower.zmin\"]\n",
            block("lower", 0.0, 2.0, 1),
            block("upper", 2.0, 2.0, 1),
            by_node(friction)
        ))
        .solve(2, &[]);
        let history = run.history();
        let [pressed, y, z] = [history.column("joint.fz")[1].abs(), history.last("joint.fy"), history.last("joint.fz")];
        let (sin, cos) = angle.to_radians().sin_cos();
        assert_close("across", y.abs(), pressed * sin, 1e-8);
        assert_close("along", z.abs(), pressed * cos, 1e-8);
        assert!(y * history.column("joint.fz")[1] < 0.0 && z * history.column("joint.fz")[1] > 0.0);
        if friction > 0.0 {
            assert_eq!(history.column("joint.slip")[1], history.last("joint.slip"));
        }
    }
}

/// A node on an edge of the master has the normal of the side that looks at the slave, whichever faces the master has.
#[test]
fn nodes_on_edges_meet_the_side_that_looks_at_them() {
    let force = |master: &str, discretization: &str| {
        let run = Bench::new(&format!(
            "{}faces = {{ top = \"zmax\", round = [\"xmin\", \"zmax\", \"xmax\", \"ymin\", \"ymax\"] }}\n{}\
             [contact.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.{master}\"\n\
             discretization = \"{discretization}\"\nfriction = 0.1\n\
             [material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nincrements = 2\nfix = [{{ set = \"lower.zmin\" }}]\n\
             move = [{{ target = \"upper.zmax\", by = [0.0, 0.0, -0.2] }}]\n[output]\nhistory = [\"lower.zmin\"]\n",
            block("lower", 0.0, 2.0, 1),
            block("upper", 2.0, 2.0, 1)
        ))
        .solve(2, &[]);
        run.history().last("lower.zmin.fz")
    };
    let alone = force("top", "node-to-node");
    assert_close("round", force("round", "node-to-node"), alone, 1e-9);
    assert_close("one pass", force("top", "one-pass"), alone, 1e-3);
}

#[test]
fn nodes_that_slip_on_nodes_obey_coulomb() {
    let two = block("lower", 0.0, 2.0, 1) + &block("upper", 2.0, 2.0, 1);
    let run = sheared(&two, &by_node(0.1), "lower", 0.4);
    let (forces, statuses) = (run.vectors(1, "contact.joint", "force"), run.scalars(1, "contact.joint", "status"));
    assert_eq!(statuses, [2.0; 12]);
    let normals = run.vectors(1, "contact.joint", "normal");
    for (force, normal) in forces.into_iter().map(Vec3::from).zip(normals.into_iter().map(Vec3::from)) {
        let pressing = force.dot(&normal);
        assert_close("friction", (force - normal * pressing).norm(), 0.1 * pressing, 1e-8);
        assert!(pressing > 0.0 && force.x - normal.x * pressing < 0.0);
    }
}

/// What slides on nodes of a master that is sheared in its plane does so alike in the mirror image, though facets begin at other corners
/// there, and from whichever corner facets are counted.
#[test]
fn nodes_slide_on_nodes_alike_in_the_mirror_image() {
    for method in ["augmented-lagrangian", "uzawa"] {
        let forces = |side: f64| {
            let run = Bench::new(&format!(
                "{}{}{}method = \"{method}\"\n[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
                 [[step]]\nincrements = 5\nfix = [{{ set = \"lower.zmin\" }}]\n\
                 move = [{{ target = \"upper.zmax\", by = [0.2, {:?}, -0.3], \
                 rotate = {{ point = [2.0, 2.0, 0.0], axis = [0.0, 0.0, 1.0], angle = {:?} }} }}]\n\
                 [output]\nhistory = [\"lower.zmin\"]\n",
                block("lower", 0.0, 2.0, 1),
                block("upper", 2.0, 2.0, 1),
                by_node(0.15),
                0.15 * side,
                4.0 * side
            ))
            .solve(1, &[]);
            assert!(run.history().last("joint.slip") > 3.0);
            ["fx", "fy", "fz"].map(|c| run.history().last(&format!("lower.zmin.{c}")))
        };
        let ([x, y, z], [also_x, also_y, also_z]) = (forces(1.0), forces(-1.0));
        for (one, other) in [(x, also_x), (y, -also_y), (z, also_z)] {
            assert_small(method, (one - other) / z, if method == "uzawa" { 1e-7 } else { 1e-10 });
        }
    }
}

/// Whether what slides over nodes is stable is no matter of the penalty by which they are kept apart. By the symmetric part of the
/// tangent, which no potential has, it was not from 0.36 of the way on with this one.
#[test]
fn stiff_penalties_from_node_to_node_are_stable() {
    let ring = |name: &str, radii: [f64; 2], layers: usize| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\nplane_strain = true\nelement = \"hex8\"\n\
             block = {{ sector = {{ radii = {radii:?}, angles = [40.0, 140.0], length = 1.0 }}, elements = [{layers}, 20, 1] }}\n"
        )
    };
    let run = |how: &str| {
        Bench::new(&format!(
            "{}{}[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [contact.k]\nslave = \"i.rmax\"\nmaster = \"o.rmin\"\ndiscretization = \"node-to-node\"\n{how}\n\
             [[step]]\nincrements = 10\nfix = [{{ set = \"o.rmax\" }}]\nmove = [{{ target = \"i.rmin\", by = [0.0, 0.15, 0.0] }}]\n\
             [[step]]\nincrements = 5\nkeep = true\nmove = [{{ target = \"i.rmin\", rotate = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 0.6 }} }}]\n\
             [output]\nhistory = [\"o.rmax\"]\n",
            ring("i", [5.0, 8.0], 3),
            ring("o", [8.0, 10.0], 2)
        ))
        .solve(1, &[])
    };
    let exact = run("").history().last("o.rmax.fy");
    for how in [
        "method = \"penalty\"\npenalty = 1e6",
        "method = \"uzawa\"",
        "method = \"penalty\"\npenalty = 1e6\nfriction = 0.05",
    ] {
        let run = run(how);
        assert!(!run.log().contains("not stable") && run.summary()["cutbacks"] == 0, "{how}");
        if !how.contains("friction") {
            assert_close(how, run.history().last("o.rmax.fy"), exact, 1e-4);
        }
    }
}

/// A tenth of a facet is told of; a facet, from which on each node is nearer to another one, ends the run.
#[test]
fn nodes_that_slide_far_from_their_counterparts_are_told_of_and_refused() {
    let two = block("lower", 0.0, 2.0, 1) + &block("upper", 2.0, 2.0, 1);
    let scene = |by: f64| {
        Bench::new(&format!(
            "{two}{}[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n[[step]]\nincrements = 4\n\
             fix = [{{ set = \"lower.zmin\" }}]\nmove = [{{ target = \"upper.zmax\", by = [{by:.1}, 0.0, -0.2] }}]\n",
            by_node(0.1)
        ))
    };
    let told = "\"node-to-node\" is for small sliding";
    assert!(!scene(0.1).solve(1, &[]).log().contains(told));
    assert!(scene(0.8).solve(2, &[]).log().contains(told));
    let run = scene(4.0).run(2, &[]);
    assert!(
        run.code == 1 && run.stderr.contains(told) && run.stderr.contains("another one is nearer"),
        "{}",
        run.stderr
    );
}

/// Faces that look the same way do not meet, and on an edge that looks at a slave from both sides a node has no one normal.
#[test]
fn nodes_at_sides_that_look_elsewhere_are_named() {
    let refused = |upper: &str, side: &str, words: &str| {
        let body = |name: &str, origin: &str, faces: &str| {
            format!(
                "body.{name}.material = \"soft\"\nbody.{name}.block = {{ box = {{ origin = {origin}, \
                 size = [1.0, 1.0, 1.0] }}, elements = [2, 2, 2], faces = {{ sides = {faces} }} }}\n"
            )
        };
        let run = Bench::new(&format!(
            "{}{}contact.joint = {{ slave = \"upper.{side}\", master = \"lower.{side}\", \
             discretization = \"node-to-node\" }}\n\
             material.soft = {{ model = \"neo-hookean\", young = 100.0, poisson = 0.3 }}\n\
             [[step]]\nincrements = 1\nfix = [{{ set = \"lower.zmin\" }}, {{ set = \"upper.zmax\" }}]\n",
            body("lower", "[0.0, 0.0, 0.0]", "[\"xmax\", \"zmax\"]"),
            body("upper", upper, "[\"xmin\", \"zmin\"]")
        ))
        .run(2, &[]);
        assert!(run.code == 2 && run.stderr.contains(words), "{}", run.stderr);
    };
    refused(
        "[0.0, 0.0, 0.0]",
        "xmax",
        "of `upper.xmax` at (1.000000, 0.000000, 0.000000) is at a node of `lower.xmax` where no",
    );
    refused("[1.0, 0.0, 1.0]", "sides", "is at a sharp edge of `lower.sides`, of which both sides look at it");
}

#[test]
fn nodes_without_a_counterpart_are_named() {
    let bench = Bench::new(&std::fs::read_to_string("inputs/patch-test.toml").unwrap());
    let run = bench.run(2, &["--set", "contact.joint.discretization=node-to-node"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("of `upper.bottom` at (") && run.stderr.contains("no node of `lower.top`"));
    let scene = bench.path("scene.toml");
    let check = |settings: &[&str]| {
        let settings: Vec<&str> = settings.iter().flat_map(|s| ["--set", s]).collect();
        let all = [&["check", scene.to_str().unwrap()], &settings[..]].concat();
        nagata(scene.parent().unwrap(), 1, &all, bench.path("none"))
    };
    let meaningless = check(&["contact.joint.discretization=node-to-node", "contact.joint.transfer=bilinear"]);
    assert!(meaningless.code == 2 && meaningless.stderr.contains("means nothing from node to node"));
    let coarse = check(&COARSE_SLAVE);
    assert!(coarse.stdout.contains("`lower.top` has the coarser mesh (facets of 3.3333e0 against 2.0000e0"));
    let stiff = [
        &FINE_SLAVE[..],
        &["material.hard={ model = \"neo-hookean\", young = 200.0, poisson = 0.3 }", "body.upper.material=hard"],
    ]
    .concat();
    assert!(check(&stiff).stdout.contains("`upper.bottom` is the stiffer (Young's modulus 2.0000e2 against 1.0000e2"));
    for right in [&FINE_SLAVE[..], &[]] {
        assert!(!check(right).stdout.contains("warning"));
    }
}

/// A shaft in a hub of another mesh, larger by a thousandth: both sides bulge between their nodes by a quarter of that, and nodes
/// alternate where a side does not do so whole.
#[test]
fn a_press_fit_is_even_in_two_passes() {
    // Lamé, plane strain: a shaft from 0.5 to 1 and a hub from 1 to 2 of one material, with the interference δ, press by
    // E' δ (b² - a²)(c² - b²) / (2 b³ (c² - a²)).
    let exact: f64 = 1000.0 / (1.0 - 0.09) * 1e-3 * 0.75 * 3.0 / (2.0 * 3.75);
    for [shaft, hub] in [[6, 12], [6, 9], [11, 7]] {
        let rings = sector("shaft", [0.5, 1.001], [5, shaft]) + &sector("hub", [1.0, 2.0], [8, hub]);
        let run = Bench::new(&format!(
            r#"
{rings}
material.m = {{ model = "hooke", young = 1000.0, poisson = 0.3 }}
contact.c = {{ slave = "hub.rmin", master = "shaft.rmax", discretization = "two-pass" }}
[[step]]
increments = 2
"#
        ))
        .solve(1, &[]);
        for grid in ["contact.c", "contact.c.master"] {
            for pressure in run.scalars(run.written(), grid, "pressure").into_iter().filter(|p| *p > 0.0) {
                assert_small(&format!("{shaft}:{hub}, {grid}"), pressure / exact - 1.0, 7e-2);
            }
        }
    }
}

/// A tip that slides over a pad that flows: a node of the second pass that left the contact to the one that it stood on comes back
/// before it is deeper than the watch lets it be.
#[test]
fn nodes_that_leave_the_contact_to_others_come_back_before_they_are_deep() {
    let bench = Bench::new(
        r#"
        body.pad = { material = "soft", block = { box = { size = [14, 3, 3] }, elements = [14, 3, 3] }, symmetry = ["zmin"] }
        material.soft = { model = "j2", young = 7e4, poisson = 0.33, yield_stress = 150, hardening = { linear = 500 } }
        material.hard = { model = "hooke", young = 2.1e5, poisson = 0.3 }
        contact.c = { slave = "pad.ymax", master = "tip.rmax", discretization = "two-pass" }
        [body.tip]
        material = "hard"
        block = { sector = { center = [4, 5.02, 0], radii = [1, 2], angles = [200, 340], length = 1.5 }, elements = [2, 12, 3] }
        symmetry = ["zmin"]
        [[step]]
        increments = 4
        fix = [{ set = "pad.ymin" }]
        move = [{ target = "tip.rmin", by = [0, -0.12, 0] }]
        [[step]]
        increments = 2
        fix = [{ set = "pad.ymin" }]
        move = [{ target = "tip.rmin", by = [0.2, 0, 0] }]
        [output]
        every = 100
        "#,
    );
    let run = bench.solve(1, &[]);
    assert_eq!(run.summary()["cutbacks"], 0);
    // Facets of the pad have edges of 1.
    assert!(run.history().column("c.max_penetration").iter().all(|depth| *depth < 5e-3));
}
