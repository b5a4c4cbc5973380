//! Ties of unlike meshes: even stress, rigid rotations, one bar of two halves, balance, ranks and restarts; what is refused.

mod common;

use common::{Bench, Run, assert_close, assert_small, deck, msh, nagata};
use std::f64::consts::PI;

/// Elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Hex,
    Tet,
    /// Of second order, with all nodes where the place of the block has them.
    Ten,
}
use Kind::{Hex, Ten, Tet};

/// A lower block with its top, the master, along `seam`, and an upper one with its bottom, the slave, along it.
fn blocks(
    [lower, upper]: [[usize; 3]; 2],
    [below, above]: [Kind; 2],
    seam: impl Fn(f64, f64) -> f64,
    rest: &str,
) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.lower]
        mesh = "lower.msh"
        material = "soft"
        [body.upper]
        mesh = "upper.msh"
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tie.seam]
        slave = "upper.zmin"
        master = "lower.zmax"
        {rest}
        "#
    ));
    // Nodes within a face stand askew, on a seam that is flat.
    let bend = (seam(0.0, 0.0) + seam(10.0, 0.0) - 2.0 * seam(5.0, 0.0)).abs();
    let most = if bend < 1e-9 { 0.05 } else { 0.0 };
    let askew = |s: f64, t: f64| s + most * (PI * s).sin() * (2.0 * PI * t).sin();
    let lay = |[s, t, r]: [f64; 3]| [10.0 * askew(s, t), 8.0 * askew(t, s), r];
    let low = |x: [f64; 3]| {
        let [x, y, r] = lay(x);
        [x, y, r * seam(x, y)]
    };
    let high = |x: [f64; 3]| {
        let [x, y, r] = lay(x);
        [x, y, seam(x, y) + r * (12.0 - seam(x, y))]
    };
    let mesh = |n: [usize; 3], kind: Kind, place: &dyn Fn([f64; 3]) -> [f64; 3]| match kind {
        // Edges are straight where the seam is, so that the fields of the patch test are those of the elements.
        Ten if most > 0.0 => msh::second_order(&msh::block(n, true, place)),
        Ten => msh::moved(&msh::second_order(&msh::block(n, true, |x| x)), place),
        _ => msh::block(n, kind == Tet, place),
    };
    bench.write("lower.msh", &mesh(lower, below, &low));
    bench.write("upper.msh", &mesh(upper, above, &high));
    bench
}

/// Pulled along z, free across it.
const PULL: &str = r#"
    [[step]]
    increments = 2
    fix = [
        { set = "lower.zmin", directions = "z" },
        { set = "lower.xmin", directions = "x" }, { set = "upper.xmin", directions = "x" },
        { set = "lower.ymin", directions = "y" }, { set = "upper.ymin", directions = "y" },
    ]
    move = [{ target = "upper.zmax", by = [0.0, 0.0, 0.6], directions = "z" }]
    [output]
    history = ["lower.zmin", "upper.zmax"]
"#;

/// By how much the displacements of both bodies are off those of even strain, with what is across left open.
fn off_even(run: &Run) -> f64 {
    let mut across: Option<f64> = None;
    let mut off = 0.0f64;
    for grid in ["body.lower", "body.upper"] {
        let moved = run.vectors(run.written(), grid, "displacement");
        for (x, u) in run.points(grid).iter().zip(&moved) {
            let shrinks = *across.get_or_insert_with(|| {
                let far = run.points(grid).iter().position(|x| x[0] > 9.99).unwrap();
                moved[far][0] / run.points(grid)[far][0]
            });
            let even = [shrinks * x[0], shrinks * x[1], 0.05 * x[2]];
            off = (0..3).fold(off, |off, d| off.max((u[d] - even[d]).abs()));
        }
    }
    off
}

/// A flat seam that leans against the pull.
#[test]
fn unlike_meshes_pass_an_even_stress_on() {
    let slope = |x: f64, y: f64| 6.0 + 0.2 * x - 0.1 * y;
    for (meshes, kinds, ranks) in [
        ([[2, 2, 2], [3, 3, 2]], [Hex, Hex], 1),
        ([[3, 3, 2], [2, 2, 2]], [Hex, Tet], 2),
        ([[2, 3, 1], [3, 2, 1]], [Tet, Hex], 3),
        ([[2, 2, 2], [3, 3, 2]], [Ten, Ten], 1),
        ([[3, 2, 1], [2, 3, 1]], [Ten, Hex], 2),
        ([[2, 3, 1], [3, 2, 1]], [Tet, Ten], 3),
    ] {
        let run = blocks(meshes, kinds, slope, PULL).solve(ranks, &[]);
        assert_small(&format!("{meshes:?} {kinds:?}"), off_even(&run), 1e-10);
        let (history, pull) = (run.history(), run.history().last("upper.zmax.fz"));
        assert!(pull > 1.0, "{pull}");
        assert_small("of the tie", history.last("seam.fz") / pull + 1.0, 1e-9);
        assert_small("across", history.last("seam.fx") / pull, 1e-9);
    }
}

/// A curved seam, of which each mesh has its own facets: nodes of the slave are moved onto those of the master. Where the slave
/// refines these, both bodies end in the same surface and stresses are even; else they have slits and overlaps between them, and
/// the error falls with the square of the size of the elements.
#[test]
fn a_curved_seam_is_closed() {
    let arch = |x: f64, _: f64| 5.0 + 1.5 * (PI * x / 10.0).sin();
    let run = blocks([[2, 2, 2], [4, 4, 2]], [Hex; 2], arch, PULL).solve(2, &[]);
    assert_small("2:1", off_even(&run), 1e-10);
    assert!(run.log().contains("apart by up to 2.859e-1, moved by up to 2.976e-1"), "{}", run.log());
    let off =
        |k: usize, kind: Kind| off_even(&blocks([[2 * k, k, k], [3 * k, k, k]], [kind; 2], arch, PULL).solve(2, &[]));
    let linear = [1, 2, 4].map(|k| off(k, Hex));
    assert!(linear[1] < 0.35 * linear[0] && linear[2] < 0.3 * linear[1], "{linear:?}");
    let quadratic = [1, 2, 4].map(|k| off(k, Ten));
    assert!(
        quadratic[0] < 3e-4 && quadratic[1] < 0.3 * quadratic[0] && quadratic[2] < 0.3 * quadratic[1],
        "{quadratic:?}"
    );
}

/// The means of a coarse slave would draw its nodes out of the planes of symmetry at the ends of the seam.
#[test]
fn ends_of_a_seam_stay_in_planes_of_symmetry() {
    let ring = |name: &str, radii: [f64; 2], elements: [usize; 3]| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\nsymmetry = [\"amin\", \"amax\", \"zmin\", \"zmax\"]\n\
             block = {{ sector = {{ radii = {radii:?}, angles = [0, 90], length = 0.5 }}, elements = {elements:?} }}\n"
        )
    };
    let rest = |inside: &str, history: &str| {
        format!(
            "[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nincrements = 2\npressure = [{{ set = \"{inside}.rmin\", value = 1.0 }}]\n\
             [output]\nhistory = [{history}]\n"
        )
    };
    let tie = "[tie.seam]\nslave = \"b.rmin\"\nmaster = \"a.rmax\"\n";
    let rings = ring("a", [1.0, 2.0], [3, 12, 1]) + &ring("b", [2.0, 3.0], [3, 8, 1]) + tie;
    let ends = r#""a.amin", "a.amax", "b.amin", "b.amax""#;
    let tied = Bench::new(&(rings + &rest("a", ends))).solve(2, &[]).history();
    let one = Bench::new(&(ring("a", [1.0, 3.0], [6, 12, 1]) + &rest("a", r#""a.amin""#))).solve(1, &[]).history();
    let at = |end: &str| ["a", "b"].map(|body| tied.last(&format!("{body}.{end}"))).iter().sum::<f64>();
    assert_small("both ends alike", at("amin.fy") - at("amax.fx"), 1e-12);
    assert_close("one ring", at("amin.fy"), one.last("a.amin.fy"), 1e-3);
}

/// Two bodies with a gap between their faces, the lower on an edge along x and turned about it by another one, by 90 degrees.
#[test]
fn what_is_tied_turns_without_a_strain() {
    let bench = Bench::new(
        r#"
        [body.lower]
        mesh = "lower.inp"
        material = "soft"
        [body.upper]
        mesh = "upper.msh"
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tie.seam]
        slave = "upper.zmin"
        master = "lower.top"
        [[step]]
        name = "up"
        increments = 4
        fix = [{ set = "lower.edge" }]
        move = [{ target = "lower.driver", by = [0.0, 0.0, 2.121320343559643], directions = "z" }]
        [[step]]
        name = "over"
        increments = 4
        fix = [{ set = "lower.edge" }]
        move = [{ target = "lower.corner", by = [0.0, -2.7071067811865475, 0.0], directions = "y" }]
        "#,
    );
    let edge =
        |j: usize, k: usize| (0..=2).map(|i| (1 + i + 3 * (j + 4 * k)).to_string()).collect::<Vec<_>>().join(", ");
    let sets = format!("*NSET, NSET=driver\n{}\n*NSET, NSET=corner\n{}\n", edge(3, 0), edge(3, 2));
    bench.write("lower.inp", &(deck([2, 3, 2]) + &sets));
    let gap = |x: f64, y: f64| 0.05 * (PI * x / 2.0).sin() * (PI * y / 3.0).sin();
    let place = |[s, t, r]: [f64; 3]| [2.0 * s, 3.0 * t, 2.0 + 2.0 * r + (1.0 - r) * gap(2.0 * s, 3.0 * t)];
    bench.write("upper.msh", &msh::block([3, 2, 2], false, place));
    let run = bench.solve(2, &[]);
    for grid in ["body.lower", "body.upper"] {
        let moved = run.vectors(run.written(), grid, "displacement");
        let points = run.points(grid);
        let turned = points.iter().zip(&moved).map(|(x, u)| [u[0], x[1] + u[1] + x[2], x[2] + u[2] - x[1]]);
        let off = turned.flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert_small(grid, off, 1e-11);
    }
}

/// A cantilever that a force bends and yields, whole or in halves with a tie between them.
fn cantilever(halves: Option<[usize; 3]>, plane: bool, element: &str) -> Bench {
    let depth = if plane { 1 } else { 2 };
    let body = |name: &str, from: f64, length: f64, elements: [usize; 3]| {
        format!(
            r#"
            [body.{name}]
            block = {{ box = {{ origin = [{from:?}, 0.0, 0.0], size = [{length:?}, 2.0, 1.0] }}, elements = {elements:?} }}
            material = "steel"
            plane_strain = {plane}
            {element}
            "#
        )
    };
    let (bodies, tip) = match halves {
        None => (body("root", 0.0, 8.0, [8, 4, depth]), "root"),
        Some(tip) => {
            let tie = "[tie.middle]\nslave = \"tip.xmin\"\nmaster = \"root.xmax\"\n";
            (body("root", 0.0, 4.0, [4, 4, depth]) + &body("tip", 4.0, 4.0, tip) + tie, "tip")
        }
    };
    Bench::new(&format!(
        r#"
        {bodies}
        [material.steel]
        model = "j2"
        young = 1000.0
        poisson = 0.3
        yield_stress = 8.0
        hardening = {{ linear = 50.0 }}
        [[step]]
        increments = 6
        fix = [{{ set = "root.xmin" }}]
        move = [{{ target = "{tip}.xmax", by = [0.0, 0.6, 0.0] }}]
        [output]
        history = ["root.xmin", "{tip}.xmax"]
        "#
    ))
}

#[test]
fn a_bar_of_two_halves_is_one_bar() {
    for (plane, element) in [(false, ""), (true, ""), (false, "element = \"hex27\"")] {
        let depth = if plane { 1 } else { 2 };
        let forces = |halves: Option<[usize; 3]>, tip: &str| {
            let run = cantilever(halves, plane, element).solve(2, &[]);
            let history = run.history();
            assert!(history.last(&format!("{tip}.plastic_work")) > 0.0);
            ["fx", "fy"].map(|c| history.last(&format!("{tip}.xmax.{c}")))
        };
        let whole = forces(None, "root");
        let halves = forces(Some([4, 4, depth]), "tip");
        (0..2).for_each(|k| assert_close("same meshes", halves[k], whole[k], 1e-10));
        let unlike = forces(
            Some([
                6,
                6,
                match (plane, element) {
                    (true, _) => 1,
                    (_, "") => 3,
                    _ => 2,
                },
            ]),
            "tip",
        );
        assert_close("3:2", unlike[1], whole[1], 0.03);
    }
}

/// A plate that yields, tied with a gap to a pad of rubber, under a ball that a force presses on it with friction and a motion
/// draws along.
const PRESS: &str = r#"
[body.plate]
material = "steel"
element = "hex8-fbar"
block = { box = { origin = [-8, -8, 0], size = [16, 16, 4] }, elements = [6, 6, 2], faces = { bottom = "zmin", top = "zmax" } }
[body.pad]
material = "rubber"
element = "hex8-eas"
block = { box = { origin = [-9, -9, -6], size = [18, 18, 5.9] }, elements = [3, 3, 2], faces = { bottom = "zmin", top = "zmax" } }
[material.steel]
model = "j2"
young = 200.0
poisson = 0.3
yield_stress = 2.0
hardening = { linear = 20.0 }
[material.rubber]
model = "neo-hookean"
young = 60.0
poisson = 0.4
[tool.ball]
sphere = { center = [0.3, 0.2, 14.0], radius = 10.0 }
[contact.top]
slave = "plate.top"
master = "ball"
friction = 0.3
[tie.joint]
slave = "plate.bottom"
master = "pad.top"
[[step]]
name = "press"
increments = 3
fix = [{ set = "pad.bottom" }]
force = [{ target = "ball", total = [0.0, 0.0, -60.0], directions = "z" }]
[[step]]
name = "draw"
increments = 3
fix = [{ set = "pad.bottom" }]
force = [{ target = "ball", total = [0.0, 0.0, -50.0], directions = "z" }]
move = [{ target = "ball", by = [2.0, 0.5, 0.0] }]
[output]
every = 100
checkpoint = { minutes = 60.0 }
history = ["pad.bottom"]
"#;

/// On any number of ranks, by any solver and over a checkpoint; forces come out at the bottom as they come in at the top.
#[test]
fn plastic_and_rubber_bodies_are_tied_under_contact() {
    let bench = Bench::new(PRESS);
    let whole = bench.solve(2, &[]);
    let history = whole.history();
    assert!(history.last("plate.plastic_work") > 1.0 && history.last("top.slip") > 0.0);
    for c in ["fx", "fy", "fz"] {
        let lost = history.last(&format!("ball.{c}")) + history.last(&format!("pad.bottom.{c}"));
        assert_small(c, lost / 50.0, 1e-9);
    }
    let same = |what: &str, run: Run| assert_small(what, run.history().difference(&history), 1e-9);
    same("one rank", bench.solve(1, &[]));
    same("iterative, three ranks", bench.solve(3, &["--set", "solver.linear=iterative"]));
    let first = bench.solve(1, &["--steps", "1"]);
    let out = first.out.to_str().unwrap();
    let scene = bench.path("scene.toml");
    let all = ["run", scene.to_str().unwrap(), "--out", out, "--restart"];
    let second = nagata(&bench.path(""), 2, &all, first.out.clone());
    assert_eq!(second.code, 0, "{}", second.stderr);
    same("restarted", second);
}

/// Moments, too, across a curved seam that was open.
#[test]
fn forces_and_moments_balance_across_a_seam() {
    let arch = |x: f64, _: f64| 5.0 + 1.5 * (PI * x / 10.0).sin();
    let bend = r#"
        [[step]]
        increments = 3
        fix = [{ set = "lower.zmin" }]
        move = [{ target = "upper.zmax", by = [3.0, 1.0, 1.5] }]
        [output]
        fields = ["reaction"]
    "#;
    for kinds in [[Hex; 2], [Ten; 2], [Ten, Hex]] {
        let run = blocks([[4, 2, 2], [6, 3, 2]], kinds, arch, bend).solve(2, &[]);
        let (mut sums, mut most) = ([0.0; 6], [0.0f64; 2]);
        for grid in ["body.lower", "body.upper"] {
            let of = |name: &str| run.vectors(run.written(), grid, name);
            for ((x, u), f) in run.points(grid).iter().zip(of("displacement")).zip(of("reaction")) {
                let x = [0, 1, 2].map(|d| x[d] + u[d]);
                for d in 0..3 {
                    let (a, b) = ((d + 1) % 3, (d + 2) % 3);
                    let moment = x[a] * f[b] - x[b] * f[a];
                    (sums[d], sums[3 + d]) = (sums[d] + f[d], sums[3 + d] + moment);
                    most = [most[0].max(f[d].abs()), most[1].max(moment.abs())];
                }
            }
        }
        let off = |k: usize| {
            assert_small(&format!("{kinds:?}: {}", ["force", "moment"][k / 3]), sums[k] / most[k / 3], 1e-10)
        };
        (0..6).for_each(off);
    }
}

const PUSH: &str = "force = [{ target = \"upper.zmax\", total = [100.0, 50.0, 300.0] }]";

/// The Jacobian of the system, by differences.
#[test]
fn the_tangent_is_exact() {
    let slope = |x: f64, y: f64| 6.0 + 0.2 * x - 0.1 * y;
    // What is prescribed enters the first iteration linearly, and the differences know nothing of that.
    let pull = PULL.replace("move = [{ target = \"upper.zmax\", by = [0.0, 0.0, 0.6], directions = \"z\" }]", PUSH);
    let run = blocks([[2, 1, 1], [3, 2, 1]], [Ten, Hex], slope, &pull).solve(2, &["--", "-snes_test_jacobian"]);
    let lines = run.stdout.lines().filter_map(|line| line.trim().strip_prefix("||J - Jfd||_F/||J||_F = "));
    let errors: Vec<f64> = lines.filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    assert!(errors.len() > 3 && errors.iter().all(|error| *error < 1e-6), "{errors:?}");
}

#[test]
fn what_would_not_be_tied_is_refused() {
    let bench = Bench::new(
        r#"
        [body.a]
        block = { box = { size = [4, 4, 2] }, elements = [2, 2, 1], faces = { side = ["zmax", "xmin"] } }
        material = "soft"
        [body.b]
        block = { box = { origin = [0, 0, 2], size = [4, 4, 2] }, elements = [3, 3, 1] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.floor]
        plane = { point = [0, 0, 1.9], normal = [0, 0, 1] }
        [tie.seam]
        slave = "b.zmin"
        master = "a.zmax"
        [[step]]
        increments = 1
        fix = [{ set = "a.zmin" }]
        move = [{ target = "b.zmax", by = [0.0, 0.0, 0.1], directions = "z" }]
        "#,
    );
    let origin = |x: f64, z: f64| format!("body.b.block.box.origin=[{x:?}, 0.0, {z:?}]");
    let tie =
        |name: &str, slave: &str, master: &str| format!("tie.{name}={{ slave = \"{slave}\", master = \"{master}\" }}");
    for (changes, words) in [
        (vec![origin(0.0, 9.0)], "nothing of `b.zmin` lies on `a.zmax`"),
        (vec![origin(0.0, 2.3)], "up to 3.000e-1 apart"),
        (vec![origin(1.0, 2.0)], "25.00 % of the area of `b.zmin` lies beyond `a.zmax`"),
        (vec![origin(0.0, 0.1), tie("seam", "b.zmax", "a.zmax")], "look the same way"),
        (vec![tie("two", "b.zmin", "a.side")], "is a slave of tie `seam`, too"),
        (vec![tie("two", "a.zmax", "b.zmin")], "repeats the faces of tie.seam"),
        (vec![tie("two", "a.zmax", "a.side")], "is on both sides"),
        (vec!["step.0.fix.0.set=\"b.zmin\"".into()], "and not the master beside it alike"),
        (vec!["contact.c={ slave = \"b.zmin\", master = \"floor\" }".into()], "would hold it twice"),
        (vec!["body.b.block.box.size=[4, 4, 0.05]".into(), origin(0.0, 1.9)], "inside out"),
    ] {
        let sets: Vec<&str> = changes.iter().flat_map(|change| ["--set", change]).collect();
        let run = bench.run(2, &sets);
        assert_eq!(run.code, 2, "{words}\n{}\n{}", run.stdout, run.stderr);
        assert!(run.stderr.contains(words) && run.stderr.matches("error:").count() == 1, "{words}\n{}", run.stderr);
    }
    // A little beyond is told; what is tied is not in contact besides.
    let contact = "contact.c={ slave = \"b.zmin\", master = \"a.zmax\" }";
    let run = bench.solve(1, &["--set", &origin(0.1, 2.0), "--set", contact]);
    assert!(run.log().contains("2.50 % of the area of `b.zmin` lies beyond `a.zmax`"), "{}", run.log());
}

/// Of two tied blocks under a plane, by penalties: the seam ends in the contact, of like meshes and of others.
#[test]
fn penalties_at_the_end_of_a_seam_are_warned_of() {
    let bench = Bench::new(
        r#"
        [body.a]
        block = { box = { size = [2, 2, 2] }, elements = [3, 3, 3] }
        material = "m"
        [body.b]
        block = { box = { origin = [2, 0, 0], size = [2, 2, 2] }, elements = [4, 4, 4] }
        material = "m"
        [material.m]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.plate]
        plane = { point = [0, 0, 2], normal = [0, 0, -1] }
        [tie.seam]
        slave = "b.xmin"
        master = "a.xmax"
        [contact.first]
        slave = "a.zmax"
        master = "plate"
        method = "penalty"
        [contact.second]
        slave = "b.zmax"
        master = "plate"
        method = "penalty"
        [[step]]
        increments = 1
        fix = [
            { set = "a.xmin", directions = "x" },
            { set = "a.zmin", directions = "z" }, { set = "b.zmin", directions = "z" },
            { set = "a.ymin", directions = "y" }, { set = "b.ymin", directions = "y" },
        ]
        move = [{ target = "plate", by = [0, 0, -0.01] }]
        "#,
    );
    for (elements, told) in [("[4, 4, 4]", 1), ("[3, 3, 3]", 0)] {
        let run = bench.solve(2, &["--set", &format!("body.b.block.elements={elements}")]);
        let found = run.log().matches("presses node").count();
        assert!(found == told, "{elements}: {}", run.log());
    }
}
