//! `refine`: what splitting meshes does to forces, bodies that share nodes, tools, ranks and wrong input.

mod common;

use common::{Bench, Run, assert_close, assert_small, msh, nagata};
use std::f64::consts::PI;
use std::path::Path;

/// Cauchy stress of W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J in uniaxial strain, where J is the stretch: E = 100, nu =
/// 0.3.
fn stress_at(stretch: f64) -> f64 {
    let (mu, lambda) = (100.0 / 2.6, 30.0 / (1.3 * 0.4));
    (mu * (stretch * stretch - 1.0) + lambda * stretch.ln()) / stretch
}

fn stresses(run: &Run, body: &str) -> Vec<f64> {
    let all = run.field(&format!("increments/{:06}/body_{body}/cell/stress", run.written()));
    all.as_chunks::<6>().0.iter().map(|stress| stress[2]).collect()
}

/// Largest error of sigma_zz over the elements of a body.
fn scatter(run: &Run, body: &str, exact: f64) -> f64 {
    stresses(run, body).iter().map(|stress| (stress / exact - 1.0).abs()).fold(0.0, f64::max)
}

/// A distorted block from a file, hexahedra or tetrahedra, in uniaxial strain: the stress is the same everywhere, whatever the
/// mesh.
fn squeezed(tetrahedra: bool, ranks: usize, arguments: &[&str]) -> Run {
    let bench = Bench::new(
        r#"
        [body.block]
        mesh = "block.msh"
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [[step]]
        increments = 2
        fix = [
            { set = "block.zmin", directions = "z" },
            { set = "block.xmin", directions = "x" }, { set = "block.xmax", directions = "x" },
            { set = "block.ymin", directions = "y" }, { set = "block.ymax", directions = "y" },
        ]
        move = [{ target = "block.zmax", by = [0.0, 0.0, -0.6], directions = "z" }]
        [output]
        every = 2
        history = ["block.zmax"]
        "#,
    );
    let distorted = |x: [f64; 3]| {
        let inside = |d: usize| if x[d] > 1e-9 && x[d] < 1.0 - 1e-9 { 0.07 } else { 0.0 };
        let phase = 7.0 * x[0] + 11.0 * x[1] + 5.0 * x[2];
        std::array::from_fn(|d| [2.0, 1.5, 1.2][d] * (x[d] + inside(d) * (phase + 2.0 * d as f64).sin()))
    };
    bench.write("block.msh", &msh::block([2, 2, 2], tetrahedra, distorted));
    bench.solve(ranks, arguments)
}

#[test]
fn split_elements_pass_the_patch_test() {
    let exact = stress_at(0.5);
    for tetrahedra in [false, true] {
        for (times, ranks) in [("1", 2), ("2", 1)] {
            let run = squeezed(tetrahedra, ranks, &["--set", &format!("body.block.refine={times}")]);
            let parts = 1 << (3 * times.parse::<usize>().unwrap());
            assert_eq!(stresses(&run, "block").len(), parts * if tetrahedra { 48 } else { 8 });
            assert_small("uniform stress", scatter(&run, "block", exact), 1e-10);
            assert_close("force", run.history().last("block.zmax.fz"), 3.0 * exact, 1e-10);
        }
    }
}

#[test]
fn contact_passes_the_patch_test_on_split_blocks() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/patch-test.toml")).unwrap();
    let bench = Bench::new(&text);
    let solve = |lower: &str, upper: &str| {
        let sets = [("lower", lower), ("upper", upper)].map(|(body, set)| format!("body.{body}.{set}"));
        bench.solve(2, &["--set", &sets[0], "--set", &sets[1]])
    };
    bench.write("scene.toml", &text.replace("[3, 3, 3]", "[1, 1, 1]").replace("[5, 5, 5]", "[3, 3, 2]"));
    let split = solve("refine=1", "refine=1");
    let fine = solve("block.elements=[2, 2, 2]", "block.elements=[6, 6, 4]");
    assert_small("twice the numbers", split.history().difference(&fine.history()), 1e-9);
    for body in ["lower", "upper"] {
        assert_small("uniform stress", scatter(&split, body, stress_at(0.95)), 1e-8);
    }
}

/// A quarter of a bar between round tools, in plane strain: one layer stays one, and all ranks compute the same.
#[test]
fn one_layer_stays_one_on_any_number_of_ranks() {
    let bench = Bench::new(
        r#"
        [body.arch]
        mesh = "arch.msh"
        material = "soft"
        plane_strain = true
        symmetry = ["ymin"]
        refine = 2
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.cap]
        mesh = "cap.msh"
        refine = 1
        smoothing = "facet"
        [contact.c]
        slave = "arch.xmax"
        master = "cap"
        friction = 0.2
        [[step]]
        increments = 3
        fix = [{ set = "arch.ymax" }]
        move = [{ target = "cap", by = [-0.06, 0.0, 0.0] }]
        [output]
        every = 3
        history = ["arch.ymax"]
        "#,
    );
    let ring = |radius: f64, angle: f64, z: f64| [radius * angle.cos(), radius * angle.sin(), z];
    bench.write("arch.msh", &msh::block([1, 4, 1], false, |x| ring(1.0 + 0.4 * x[0], PI / 3.0 * x[1], 0.25 * x[2])));
    let bore = |s: f64, t: f64| ring(1.6, 0.6 * (1.0 - 2.0 * s), 2.0 * t - 0.9);
    let shifted = move |s: f64, t: f64| {
        let [x, y, z] = bore(s, t);
        [x - 0.19, y, z]
    };
    bench.write("cap.msh", &msh::surface(4, shifted));
    let [one, two] = [1, 2].map(|ranks| bench.solve(ranks, &[]));
    assert_small("ranks", one.history().difference(&two.history()), 1e-8);
    assert_eq!(one.field("grids/body_arch/points").len(), 3 * 2 * 5 * 17);
    let history = one.history();
    assert!(history.last("cap.fx") < -0.1, "{}", history.last("cap.fx"));
    let balance = history.last("cap.fx") + history.last("arch.ymax.fx");
    assert_small("balance", balance / history.last("cap.fx"), 1e-9);
}

/// A quarter of a ring, of two elements by four, under a pressure inside: the force at its foot converges with the square of the
/// size of the parts, to that of the ring as it was meshed 16 times finer but for the error of the patches.
#[test]
fn forces_converge_on_a_round_body() {
    let bench = Bench::new(
        r#"
        [body.ring]
        mesh = "coarse.msh"
        material = "soft"
        plane_strain = true
        symmetry = ["ymin", "ymax"]
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [[step]]
        increments = 1
        pressure = [{ set = "ring.xmin", value = 2.0 }]
        [output]
        history = ["ring.ymin"]
        "#,
    );
    let ring = |x: [f64; 3]| {
        let (radius, (sine, cosine)) = (1.0 + 0.4 * x[0], (PI / 2.0 * x[1]).sin_cos());
        [radius * if x[1] == 1.0 { 0.0 } else { cosine }, radius * sine, 0.25 * x[2]]
    };
    bench.write("coarse.msh", &msh::block([2, 4, 1], false, ring));
    bench.write("fine.msh", &msh::block([32, 64, 1], false, ring));
    let force = |set: &str| bench.solve(1, &["--set", set]).history().last("ring.ymin.fy");
    let forces = [0, 1, 2, 3].map(|times| force(&format!("body.ring.refine={times}")));
    let changes: Vec<f64> = forces.windows(2).map(|pair| pair[1] - pair[0]).collect();
    println!("{forces:?}");
    for pair in changes.windows(2) {
        assert_close("order 2", pair[0] / pair[1], 4.2, 0.05);
    }
    let limit = forces[3] + changes[2] / 3.0;
    assert_small("patches", limit / force("body.ring.mesh=fine.msh") - 1.0, 3e-5);
}

/// Two bodies of one deck on a wavy common face, of which the lower one is longer: alone each would round the face
/// otherwise where the upper one ends.
fn waves(more: &str) -> Bench {
    let node = |i: usize, j: usize, l: usize| 1 + i + 4 * j + 8 * l;
    let mut deck = "*NODE\n".to_string();
    for (l, j, i) in (0..3).flat_map(|l| (0..2).flat_map(move |j| (0..4 - l / 2).map(move |i| (l, j, i)))) {
        let x = i as f64;
        let z = [0.0, 1.0 + 0.2 * (1.3 * x).sin(), 2.0][l];
        deck += &format!("{}, {x:?}, {j}, {z:?}\n", node(i, j, l));
    }
    for (l, name) in [(0, "low"), (1, "high")] {
        deck += &format!("*ELEMENT, TYPE=C3D8, ELSET={name}\n");
        for i in 0..3 - l {
            let face = |l| [node(i, 0, l), node(i + 1, 0, l), node(i + 1, 1, l), node(i, 1, l)];
            let nodes: Vec<String> = [face(l), face(l + 1)].concat().iter().map(usize::to_string).collect();
            deck += &format!("{}, {}\n", 1 + i + 3 * l, nodes.join(", "));
        }
    }
    deck += "*SURFACE, NAME=base\nlow, S1\n*SURFACE, NAME=lid\nlow, S2\n*SURFACE, NAME=sole\nhigh, S1\n*SURFACE, NAME=cap\nhigh, S2\n";
    let bench = Bench::new(&format!(
        "[body.a]\nmaterial = \"soft\"\nmesh = \"two.inp\"\ngroup = \"low\"\nrefine = 1\n\
         [body.b]\nmaterial = \"soft\"\nmesh = \"two.inp\"\ngroup = \"high\"\nrefine = 1\n\
         [material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{more}\n\
         [[step]]\nincrements = 1\nfix = [{{ set = \"a.base\" }}, {{ set = \"b.cap\" }}]\n"
    ));
    bench.write("two.inp", &deck);
    bench
}

fn check(bench: &Bench, arguments: &[&str]) -> (i32, String) {
    let run = nagata(&bench.path(""), 2, &[&["check", "scene.toml"], arguments].concat(), bench.path("none"));
    (run.code, run.stdout + &run.stderr)
}

#[test]
fn bodies_of_one_file_share_their_new_nodes() {
    let (code, text) = check(&waves(""), &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("bodies `a` and `b` are one solid at 8 faces, whose nodes they share"), "{text}");
    let contact = "[contact.c]\nslave = \"b.sole\"\nmaster = \"a.lid\"\nfriction = 0.3";
    let (code, text) = check(&waves(contact), &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("contact `c` begins with 15 nodes that touch"), "{text}");
    assert!(text.contains("body `a`: hex8, neo-hookean; no plasticity, 8 elements for each of its mesh"), "{text}");
    assert!(text.contains("\n40 elements, 108 nodes,"), "{text}");
}

/// Refined facets come to the smooth surface: on a quarter circle of radius 10 in 4 edges they are off by 10 (1 - cos 11.25) at
/// first, a quarter of that each time, until the patches' own 1.9e-3 is left.
#[test]
fn facets_come_to_the_patches() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/ironing-rigid.toml");
    let folder = tempfile::tempdir().unwrap();
    let error = |smoothing: &str, times: u32| {
        let run = nagata(
            folder.path(),
            1,
            &[
                &["surface", scene.to_str().unwrap(), "--against", "profile", "--out", "surface"],
                &["--set", &format!("tool.indenter.smoothing={smoothing}")][..],
                &["--set", &format!("tool.indenter.refine={times}")],
            ]
            .concat(),
            folder.path().join("surface"),
        );
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let facets = 26 << (2 * times);
        assert!(run.stdout.contains(&format!("pieces            {facets} quadrilaterals")), "{}", run.stdout);
        let of = |row: &str| -> f64 {
            let line = run.stdout.lines().find(|line| line.trim_start().starts_with(row)).unwrap();
            line.split_whitespace().nth(1).unwrap().parse().unwrap()
        };
        [of("highest"), of("lowest")]
    };
    for times in 0..4 {
        let angle = PI / 16.0 / f64::from(1 << times);
        let [high, low] = error("facet", times);
        // The patch is above the arc a little.
        assert_close("lowest", -low, 10.0 * (1.0 - angle.cos()), 0.05);
        if times > 0 {
            assert_close("highest", high, 1.8822e-3, 1e-3);
        }
        assert_close("patches", error("nagata", times)[0], 1.8822e-3, 1e-3);
    }
}

#[test]
fn wrong_input_says_what_would_be_right() {
    let bench = waves("[contact.c]\nslave = \"b.sole\"\nmaster = \"a.lid\"");
    for (set, words) in [
        ("body.a.refine=7", "body.a.refine must be a whole number from 0 to 6, not 7.0"),
        ("body.a.refine=-1", "body.a.refine must be a whole number from 0 to 6, not -1.0"),
        ("body.a.refine=1.5", "body.a.refine must be a whole number from 0 to 6, not 1.5"),
        ("body.a.refine=\"once\"", "body.a.refine must be a number"),
        ("tool.t={ plane = { point = [0, 0, 9], normal = [0, 0, -1] }, refine = 1 }", "tool.t.refine needs a mesh"),
    ] {
        let (code, text) = check(&bench, &["--set", set]);
        assert_eq!(code, 2, "{text}");
        assert!(text.contains(words), "{text}");
    }
    let (code, text) = check(&bench, &["--set", "body.a.refine=0", "--set", "body.b.refine=0"]);
    assert!(code == 0 && text.contains("\n5 elements, 28 nodes,"), "{text}");
    let many = Bench::new(
        "[body.a]\nmaterial = \"soft\"\nblock = { box = { size = [1, 1, 1] }, elements = [40, 40, 40] }\nrefine = 6\n\
         [material.soft]\nmodel = \"neo-hookean\"\nyoung = 1\npoisson = 0.3\n\
         [[step]]\nincrements = 1\nfix = [{ set = \"a\" }]\n",
    );
    let (code, text) = check(&many, &[]);
    assert!(code == 2 && text.contains("a block of [2560, 2560, 2560] elements is too large"), "{text}");
}
