//! Contact from segment to segment: the patch test of unlike meshes in one pass, balance, ranks, restart, and what is refused.

mod common;

use common::{Bench, assert_close, assert_small, msh, nagata};
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::path::Path;

/// Cauchy stress of W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J in uniaxial strain: both cubes go from 10 to 9.5.
fn exact_stress() -> f64 {
    let (young, poisson, stretch) = (100.0, 0.3, 0.95f64);
    let (mu, lambda) = (young / (2.0 + 2.0 * poisson), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    (mu * (stretch * stretch - 1.0) + lambda * stretch.ln()) / stretch
}

/// The largest errors of stress and pressure in `inputs/patch-test.toml`, relative.
fn patch_test(ranks: usize, elements: [usize; 2], settings: &[&str]) -> [f64; 2] {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/patch-test.toml");
    let [lower, upper] = elements;
    let mut set = vec![
        "contact.joint.discretization=segment".to_string(),
        format!("body.lower.block.elements=[{lower}, {lower}, 3]"),
        format!("body.upper.block.elements=[{upper}, {upper}, 3]"),
    ];
    set.extend(settings.iter().map(|s| s.to_string()));
    let arguments: Vec<&str> = set.iter().flat_map(|s| ["--set", s]).collect();
    let run = Bench::new(&std::fs::read_to_string(scene).unwrap()).solve(ranks, &arguments);
    let of = |body| run.field(&format!("increments/{:06}/body_{body}/cell/stress", run.written()));
    let stress = [of("lower"), of("upper")].concat();
    let worst = |errors: &mut dyn Iterator<Item = f64>| errors.map(f64::abs).fold(0.0, f64::max);
    let exact = exact_stress();
    let pressure = run.scalars(run.written(), "contact.joint", "pressure");
    [
        worst(&mut stress.as_chunks::<6>().0.iter().map(|s| s[2] / exact - 1.0)),
        worst(&mut pressure.iter().map(|p| p / -exact - 1.0)),
    ]
}

#[test]
fn unlike_meshes_pass_the_patch_test_in_one_pass() {
    for (ranks, elements, settings) in [
        (1, [3, 5], &[][..]),
        (2, [2, 3], &["contact.joint.friction=0.3"]),
        (2, [3, 2], &["contact.joint.friction=0.3", "contact.joint.slave_curvature=deformed"]),
        (3, [3, 2], &["contact.joint.smoothing=facet"]),
        (2, [5, 3], &["contact.joint.method=lagrange", "contact.joint.friction=0.3"]),
        (1, [2, 3], &["contact.joint.smoothing=facet", "contact.joint.transfer=variational"]),
        (2, [3, 5], &["contact.joint.method=uzawa", "contact.joint.friction=0.3"]),
    ] {
        let [stress, pressure] = patch_test(ranks, elements, settings);
        // Uzawa's rounds end where penetrations are worth 1e-8 of the force.
        let least = if settings.contains(&"contact.joint.method=uzawa") { 3e-8 } else { 1e-10 };
        assert_small(&format!("stress {elements:?} {settings:?}"), stress, least);
        assert_small(&format!("pressure {elements:?} {settings:?}"), pressure, least);
    }
}

/// A block on another one: `(element, elements along x and y)` of both, meshes of tetrahedra askew within the faces.
fn stack(kinds: [(&str, usize); 2], rest: &str) -> Bench {
    let body = |name: &str, (element, n): (&str, usize), z: f64| {
        let mesh = match element {
            "hex8" | "hex27" => {
                format!(
                    "block = {{ box = {{ origin = [0.0, 0.0, {z:?}], size = [10.0, 8.0, 4.0] }}, elements = [{n}, {n}, 2] }}"
                )
            }
            _ => format!("mesh = \"{name}.msh\""),
        };
        format!("[body.{name}]\n{mesh}\nmaterial = \"soft\"\nelement = \"{element}\"\n")
    };
    let bench = Bench::new(&format!(
        r#"
        {}{}
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [contact.joint]
        slave = "upper.zmin"
        master = "lower.zmax"
        discretization = "segment"
        {rest}
        "#,
        body("lower", kinds[0], 0.0),
        body("upper", kinds[1], 4.0),
    ));
    for (name, (element, n), z) in [("lower", kinds[0], 0.0), ("upper", kinds[1], 4.0)] {
        let askew = |s: f64, t: f64| s + 0.05 * (PI * s).sin() * (2.0 * PI * t).sin();
        let block = msh::block([n, n, 1], true, |[s, t, r]| [10.0 * askew(s, t), 8.0 * askew(t, s), z + 4.0 * r]);
        bench.write(&format!("{name}.msh"), &if element == "tet4" { block } else { msh::second_order(&block) });
    }
    bench
}

/// Faces of six and of nine nodes, on each other and on linear ones, pass an even stress on, and all nodes have its pressure.
#[test]
fn quadratic_faces_pass_the_patch_test() {
    let press = r#"
        friction = 0.3
        [[step]]
        increments = 2
        fix = [
            { set = "lower.zmin", directions = "z" },
            { set = "lower.xmin", directions = "x" }, { set = "upper.xmin", directions = "x" },
            { set = "lower.xmax", directions = "x" }, { set = "upper.xmax", directions = "x" },
            { set = "lower.ymin", directions = "y" }, { set = "upper.ymin", directions = "y" },
            { set = "lower.ymax", directions = "y" }, { set = "upper.ymax", directions = "y" },
        ]
        move = [{ target = "upper.zmax", by = [0.0, 0.0, -0.4], directions = "z" }]
        [output]
        every = 2
    "#;
    for (kinds, ranks) in [
        ([("tet10", 2), ("tet10", 3)], 2),
        ([("tet10", 3), ("tet10", 2)], 1),
        ([("hex27", 4), ("hex27", 6)], 2),
        ([("hex27", 6), ("tet10", 2)], 1),
        ([("tet10", 3), ("hex27", 4)], 3),
        ([("hex8", 3), ("tet10-sri", 2)], 1),
        ([("tet10", 2), ("hex8", 3)], 2),
        ([("hex8", 3), ("hex27", 4)], 1),
        ([("hex27", 4), ("tet4", 3)], 1),
    ] {
        let run = stack(kinds, press).solve(ranks, &[]);
        let exact = exact_stress();
        for body in ["lower", "upper"] {
            let stress = run.field(&format!("increments/{:06}/body_{body}/cell/stress", run.written()));
            let errors = stress.as_chunks::<6>().0.iter().map(|s| (s[2] / exact - 1.0).abs());
            assert_small(&format!("stress {kinds:?}"), errors.fold(0.0, f64::max), 1e-10);
        }
        let errors =
            run.scalars(run.written(), "contact.joint", "pressure").into_iter().map(|p| (p / -exact - 1.0).abs());
        assert_small(&format!("pressure {kinds:?}"), errors.fold(0.0, f64::max), 1e-10);
        assert_eq!(run.summary()["warnings"].as_array().map(Vec::len), Some(0), "{}", run.summary()["warnings"]);
    }
}

/// Drawn over each other with friction, their forces balance, on any number of ranks and after a restart.
#[test]
fn quadratic_faces_slide() {
    let drag = r#"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{ set = "lower.zmin" }]
        move = [{ target = "upper.zmax", by = [0.0, 0.0, -0.1] }]
        [[step]]
        name = "drag"
        increments = 3
        fix = [{ set = "lower.zmin" }]
        move = [{ target = "upper.zmax", by = [0.6, 0.2, 0.0] }]
        [output]
        every = 100
        checkpoint = { increments = 3 }
        history = ["upper.zmax", "lower.zmin"]
    "#;
    for kinds in [[("tet10", 3), ("hex27", 4)], [("hex27", 4), ("tet10", 3)]] {
        let bench = stack(kinds, drag);
        let run = |ranks: usize, more: &[&str]| {
            let run = nagata(
                &bench.path(""),
                ranks,
                &[&["run", "scene.toml", "--out", "out"], more].concat(),
                bench.path("out"),
            );
            assert_eq!(run.code, 0, "{}", run.stderr);
            run.history()
        };
        let whole = run(1, &[]);
        let force = whole.largest_force("upper.zmax");
        for d in ["fx", "fy", "fz"] {
            let [above, below, between] =
                ["upper.zmax", "lower.zmin", "joint"].map(|n| whole.last(&format!("{n}.{d}")));
            assert_small("balance", (above + below) / force, 1e-9);
            assert_small("contact force", (between + above) / force, 1e-9);
        }
        assert!(whole.last("joint.slip") > 0.0);
        assert_small("ranks", run(2, &[]).difference(&whole), 1e-9);
        run(3, &["--steps", "1"]);
        assert_small("restart", run(2, &["--restart"]).difference(&whole), 1e-9);
    }
}

/// The pressure of a ball on a block against Hertz, up to its end: nodes show what they bear, and not the coefficients of its
/// functions, which are off by 8 %.
#[test]
fn pressures_are_those_of_hertz() {
    let read = |name: &str| std::fs::read_to_string(format!("{}/inputs/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let bench = Bench::new(&read("hertz-sphere.toml"));
    bench.write("hertz-sphere.msh", &read("hertz-sphere.msh"));
    let run = bench.solve(2, &["--set", "contact.spot.discretization=segment"]);
    let force = -4.0 * run.history().last("ball.back.fz");
    let a = (0.75 * force * 50.0 / (1000.0 / 0.91 / 2.0)).cbrt();
    let highest = 1.5 * force / (PI * a * a);
    let (points, pressures) = (run.points("contact.spot"), run.scalars(run.written(), "contact.spot", "pressure"));
    let squares: Vec<f64> = points
        .iter()
        .zip(&pressures)
        .map(|(x, p)| (x[0].hypot(x[1]) / a, p / highest))
        .filter(|(r, _)| *r < 1.0)
        .map(|(r, p)| (p - (1.0 - r * r).sqrt()).powi(2))
        .collect();
    assert_small("rms", (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(), 0.04);
    assert_close("highest", run.history().last("spot.max_pressure"), highest, 0.02);
    // Nodes beside those that touch bear some of it.
    let status = run.scalars(run.written(), "contact.spot", "status");
    assert!(status.iter().zip(&pressures).any(|(s, p)| *s == 0.0 && *p > 0.0));
}

/// A block is pressed into a table and drawn over it, of another mesh, askew.
fn dragged(contact: &str) -> Bench {
    Bench::new(&format!(
        r#"
        [body.table]
        block = {{ box = {{ size = [7.0, 4.0, 2.0] }}, elements = [7, 4, 1] }}
        material = "soft"
        [body.block]
        block = {{ box = {{ origin = [1.2, 1.1, 2.0], size = [3.0, 2.0, 1.5] }}, elements = [4, 3, 1] }}
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
        slave = "table.zmax"
        master = "block.zmin"
        discretization = "segment"
        {contact}
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [0.0, 0.0, -0.1] }}]
        [[step]]
        name = "drag"
        increments = 4
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [0.7, 0.2, 0.0] }}]
        [output]
        every = 100
        checkpoint = {{ increments = 3 }}
        history = ["block.zmax", "table.zmin"]
        "#
    ))
}

#[test]
fn forces_balance_on_any_number_of_ranks_and_after_a_restart() {
    for contact in ["friction = 0.3", "friction = 0.3\nslave_curvature = \"deformed\""] {
        balances(contact);
    }
}

fn balances(contact: &str) {
    let bench = dragged(contact);
    let whole = bench.solve(1, &[]).history();
    let force = whole.largest_force("block.zmax");
    for d in ["fx", "fy", "fz"] {
        let [above, below, between] = ["block.zmax", "table.zmin", "sole"].map(|n| whole.last(&format!("{n}.{d}")));
        assert_small("balance", (above + below) / force, 1e-9);
        assert_small("contact force", (between + below) / force, 1e-9);
    }
    for ranks in [2, 3] {
        assert_small("ranks", dragged(contact).solve(ranks, &[]).history().difference(&whole), 1e-9);
    }
    let bench = dragged(contact);
    let run = |more: &[&str]| {
        nagata(&bench.path(""), 2, &[&["run", "scene.toml", "--out", "out"], more].concat(), bench.path("out"))
    };
    let part = run(&["--steps", "1"]);
    assert_eq!(part.code, 0, "{}", part.stderr);
    let rest = run(&["--restart"]);
    assert_eq!(rest.code, 0, "{}", rest.stderr);
    assert_small("restart", rest.history().difference(&whole), 1e-9);
}

/// Uzawa's method ends where multipliers that are unknowns do, in rubber that is drawn over rubber, pressed and without friction.
#[test]
fn uzawas_method_finds_the_same_forces() {
    for contact in ["", "friction = 0.3"] {
        let [whole, rounds] = ["augmented-lagrangian", "uzawa"]
            .map(|method| dragged(&format!("{contact}\nmethod = \"{method}\"")).solve(2, &[]).history());
        let force = whole.largest_force("block.zmax");
        for column in ["sole.fx", "sole.fy", "sole.fz", "block.zmax.fx", "block.zmax.fz"] {
            for (found, right) in rounds.column(column).iter().zip(whole.column(column)) {
                assert_small(&format!("{contact} {column}"), (found - right) / force, 1e-8);
            }
        }
    }
}

#[test]
fn what_it_cannot_do_is_refused() {
    for (setting, told) in [
        ("contact.sole.tangent=fixed-frame", "means nothing with \"segment\""),
        ("contact.sole.discretization=one-pass", "slave_curvature means nothing for nodes"),
        ("contact.sole.smoothing=facet", "means nothing under a master of facets"),
    ] {
        let bench = dragged("slave_curvature = \"deformed\"");
        let run = nagata(&bench.path(""), 1, &["check", "scene.toml", "--set", setting], bench.path("out"));
        assert!(run.code == 2 && run.stderr.contains(told), "{setting}: {}", run.stderr);
    }
}

/// Two blocks of unlike meshes whose side faces lie in two planes, in which all stay, pressed and drawn: edges of slave and master
/// fall together but for rounding, which must not decide where points are.
#[test]
fn blocks_with_edges_in_one_plane_slide() {
    let held = "{ set = \"low\", directions = \"z\" }, { set = \"up\", directions = \"z\" }";
    let scene = format!(
        r#"
[body.low]
material = "m"
block = {{ box = {{ size = [16, 4, 4] }}, elements = [12, 3, 1] }}
[body.up]
material = "m"
block = {{ box = {{ origin = [4, 4, 0], size = [8, 3, 4] }}, elements = [8, 2, 1] }}
[material.m]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[contact.c]
slave = "up.ymin"
master = "low.ymax"
friction = 0.3
discretization = "segment"
[output]
history = ["low.ymin", "up.ymax"]
[[step]]
increments = 4
fix = [{{ set = "low.ymin" }}, {held}]
move = [{{ target = "up.ymax", by = [0, -0.3, 0] }}]
[[step]]
increments = 8
fix = [{{ set = "low.ymin" }}, {held}]
move = [{{ target = "up.ymax", by = [3, 0, 0] }}]
"#
    );
    let run = Bench::new(&scene).solve(2, &[]);
    let history = run.history();
    for d in ["fx", "fy"] {
        let [low, up] = ["low.ymin", "up.ymax"].map(|set| history.last(&format!("{set}.{d}")));
        assert_small("balance", (low + up) / history.last("up.ymax.fy"), 1e-9);
    }
}

/// Blocks side by side under one platen, which stick to each other: what the platen and their faces ask of the nodes that are in both
/// says the same, and only friction that grows until it slips can tell who bears what. From nodes to surface they bear as much.
#[test]
fn blocks_side_by_side_stick_under_one_platen() {
    let scene = r#"
[body.l]
material = "m"
block = { box = { origin = [0, 0, 1], size = [1, 1, 1] }, elements = [2, 2, 2] }
[body.r]
material = "m"
block = { box = { origin = [1, 0, 1], size = [1, 1, 1] }, elements = [2, 2, 2] }
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.platen]
plane = { point = [0, 0, 2], normal = [0, 0, -1] }
[contact.between]
slave = "l.xmax"
master = "r.xmin"
friction = 0.2
[contact.left]
slave = "l.zmax"
master = "platen"
friction = 0.1
[contact.right]
slave = "r.zmax"
master = "platen"
friction = 0.1
[output]
history = ["l.xmin", "r.xmax"]
[[step]]
increments = 4
fix = [{ set = "l.zmin", directions = "z" }, { set = "r.zmin", directions = "z" }]
move = [
    { target = "platen", by = [0, 0, -0.1] },
    { target = "l.xmin", by = [0.03, 0, 0], directions = "xy" },
    { target = "r.xmax", by = [-0.03, 0, 0], directions = "xy" },
]
[[step]]
increments = 4
keep = true
move = [
    { target = "l.xmin", by = [0.1, 0, 0], directions = "xy" },
    { target = "r.xmax", by = [0.1, 0, 0], directions = "xy" },
]
"#;
    let bench = Bench::new(scene);
    let segments = bench.solve(1, &["--set", "contact.between.discretization=segment"]).history();
    let nodes = Bench::new(scene).solve(1, &[]).history();
    for (column, within) in [("platen.fz", 2e-3), ("platen.fx", 2e-3), ("l.xmin.fx", 1e-2), ("r.xmax.fx", 1e-2)] {
        assert_close(column, segments.last(column), nodes.last(column), within);
    }
    let along = ["platen.fx", "l.xmin.fx", "r.xmax.fx"].map(|column| segments.last(column));
    assert_small("balance", along.iter().sum::<f64>() / along[1], 1e-9);
}

/// A block on a wider one, with friction, whole and as a quarter between planes of symmetry, on smooth patches and on facets.
#[test]
fn a_quarter_bears_a_quarter_of_the_force() {
    let scene = |whole: bool, smoothing: &str| {
        let block = |half: f64, elements: usize, z: f64| {
            let (origin, part) = if whole { (-half, 2) } else { (0.0, 1) };
            let (size, n) = (half * part as f64, elements * part);
            format!(
                "{{ box = {{ origin = [{origin}, {origin}, {z}], size = [{size}, {size}, 1.0] }}, elements = [{n}, {n}, 2] }}"
            )
        };
        let symmetry = if whole { "" } else { ", symmetry = [\"xmin\", \"ymin\"]" };
        Bench::new(&format!(
            r#"
            body.lower = {{ material = "m", block = {}{symmetry} }}
            body.upper = {{ material = "n", block = {}{symmetry} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            material.n = {{ model = "neo-hookean", young = 10.0, poisson = 0.4 }}
            [contact.c]
            slave = "upper.zmin"
            master = "lower.zmax"
            friction = 0.3
            discretization = "segment"
            smoothing = "{smoothing}"
            [[step]]
            name = "press"
            increments = 2
            fix = [{{ set = "lower.zmin" }}, {{ set = "upper.zmax", directions = "xy" }}]
            move = [{{ target = "upper.zmax", by = [0.0, 0.0, -0.2], directions = "z" }}]
            [output]
            history = ["lower.zmin"]
            "#,
            block(3.0, 3, -1.0),
            block(2.0, 1, 0.0),
        ))
    };
    for smoothing in ["nagata", "facet"] {
        let [whole, quarter] = [true, false].map(|whole| scene(whole, smoothing).solve(2, &[]));
        let [whole, quarter] = [whole, quarter].map(|run| run.history().last("lower.zmin.fz"));
        // Points stand still from where little is left of the residual.
        assert_small(smoothing, 4.0 * quarter / whole - 1.0, 1e-5);
    }
}

/// Rings in one another, without a gap, under pressure in the bore, and with an interference, against Lamé: the facets of
/// neither, the inner one's bulge and the outer one's are hollow, stand in for the round they are of.
#[test]
fn round_fits_bear_what_they_bear() {
    const FACETS: usize = 24;
    let rings = |slave: &str, master: &str, outer: f64, pressure: f64| {
        format!(
            r#"
            [body.i]
            material = "m"
            plane_strain = true
            symmetry = ["amin", "amax"]
            block = {{ sector = {{ radii = [1.0, {outer:?}], angles = [0.0, 90.0], length = 0.1 }}, elements = [8, {FACETS}, 1] }}
            [body.o]
            material = "m"
            plane_strain = true
            symmetry = ["amin", "amax"]
            block = {{ sector = {{ radii = [2.0, 3.0], angles = [0.0, 90.0], length = 0.1 }}, elements = [8, {FACETS}, 1] }}
            [material.m]
            model = "hooke"
            young = 1e5
            poisson = 0.3
            [contact.c]
            slave = "{slave}"
            master = "{master}"
            discretization = "segment"
            friction = 0.2
            [[step]]
            increments = 2
            pressure = [{{ set = "i.rmin", value = {pressure:?} }}]
            "#
        )
    };
    // Lamé: b = 2 between a = 1 and c = 3, which alike pressures p a²(c² - b²) / (b²(c² - a²)) and, in plane strain, an interference
    // δ of E' δ (b² - a²)(c² - b²) / (2 b³ (c² - a²)) press.
    let of_bore = |p: f64| p * 5.0 / 32.0;
    let of_fit = |d: f64| 1e5 / (1.0 - 0.09) * d * 15.0 / (16.0 * 8.0);
    for [slave, master] in [["i.rmax", "o.rmin"], ["o.rmin", "i.rmax"]] {
        for (outer, pressure, exact) in [
            (2.0, 0.0, 0.0),
            (2.0, 20.0, of_bore(20.0)),
            (2.001, 0.0, of_fit(1e-3)),
            (2.001, 20.0, of_fit(1e-3) + of_bore(20.0)),
        ] {
            let ranks = 1 + usize::from(pressure > 0.0);
            let run = Bench::new(&rings(slave, master, outer, pressure)).solve(ranks, &[]);
            let force = run.history().last("c.fx").abs() / 0.2;
            println!("{slave}, {outer}, {pressure}: {force:.5}, {exact:.5}");
            assert_small("pressure", (force - exact).abs() / exact.max(1.0), 3e-3);
        }
    }
}

/// So do rings of quadratic faces, with an interference, and their error falls with more than the cube of the size of the elements.
#[test]
fn quadratic_fits_bear_what_they_bear() {
    let wall = 0.2;
    let ring = |name: &str, element: &str, [inner, outer]: [f64; 2], n: usize| match element {
        "tet10" => format!("[body.{name}]\nmesh = \"{name}.msh\"\nmaterial = \"m\"\n"),
        _ => format!(
            "[body.{name}]\nmaterial = \"m\"\nelement = \"hex27\"\nblock = {{ sector = {{ radii = [{inner:?}, {outer:?}], \
             angles = [0.0, 90.0], length = {wall:?} }}, elements = [4, {}, 2] }}\n",
            2 * n
        ),
    };
    let sides = |name: &str, element: &str| -> [String; 6] {
        let names = if element == "tet10" {
            ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]
        } else {
            ["rmin", "rmax", "amin", "amax", "zmin", "zmax"]
        };
        names.map(|side| format!("{name}.{side}"))
    };
    for (elements, swapped) in
        [(["tet10"; 2], false), (["tet10"; 2], true), (["hex27"; 2], false), (["hex27", "tet10"], true)]
    {
        let error = |n: usize| {
            let radii = [[1.0, 2.001], [2.0, 3.0]];
            let counts = [2 * n, 3 * n];
            let [i, o] = [sides("i", elements[0]), sides("o", elements[1])];
            let [slave, master] = if swapped { [&o[0], &i[1]] } else { [&i[1], &o[0]] };
            let fix: Vec<String> = [&i, &o]
                .iter()
                .flat_map(|s| [(&s[2], "y"), (&s[3], "x"), (&s[4], "z"), (&s[5], "z")])
                .map(|(set, directions)| format!("{{ set = \"{set}\", directions = \"{directions}\" }}"))
                .collect();
            let bench = Bench::new(&format!(
                "{}{}[material.m]\nmodel = \"hooke\"\nyoung = 1e5\npoisson = 0.3\n[contact.c]\nslave = \"{slave}\"\nmaster = \"{master}\"\n\
                 discretization = \"segment\"\n[[step]]\nincrements = 1\nfix = [{}]\n",
                ring("i", elements[0], radii[0], counts[0]),
                ring("o", elements[1], radii[1], counts[1]),
                fix.join(", ")
            ));
            for ((name, [inner, outer]), n) in ["i", "o"].into_iter().zip(radii).zip(counts) {
                let place = |[r, a, z]: [f64; 3]| {
                    let (r, a) = (inner + r * (outer - inner), a * PI / 2.0);
                    [r * a.cos(), r * a.sin(), z * wall]
                };
                let straight = msh::second_order(&msh::block([2, n, 1], true, |x| x));
                bench.write(&format!("{name}.msh"), &msh::moved(&straight, place));
            }
            let force = bench.solve(1 + n / 6, &[]).history().last("c.fx").abs() / (2.0 * wall);
            let exact = 1e5 / (1.0 - 0.09) * 0.001 * 15.0 / (16.0 * 8.0);
            println!("{elements:?}, {swapped}, {n}: {force:.6}, {exact:.6}");
            (force / exact - 1.0).abs()
        };
        let [coarse, fine] = [error(3), error(6)];
        assert_small(&format!("{elements:?}"), coarse, 1e-2);
        assert_small(&format!("{elements:?}"), fine, 1e-3);
    }
}

/// A quarter of two rings of `hex27`, from one radius to the next each, of so many elements around and of one thickness.
fn quadratic_rings([inner, outer]: [[f64; 2]; 2], counts: [usize; 2], [slave, master]: [&str; 2], load: &str) -> Bench {
    let ring = |name: &str, [from, to]: [f64; 2], n: usize| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\nelement = \"hex27\"\nsymmetry = [\"amin\", \"amax\"]\nblock = {{ sector = {{ \
             radii = [{from:?}, {to:?}], angles = [0.0, 90.0], length = 0.1 }}, elements = [4, {}, 2] }}\n",
            2 * n
        )
    };
    let fix = ["i.zmin", "i.zmax", "o.zmin", "o.zmax"].map(|set| format!("{{ set = \"{set}\", directions = \"z\" }}"));
    Bench::new(&format!(
        "{}{}[material.m]\nmodel = \"hooke\"\nyoung = 1e5\npoisson = 0.3\n[contact.c]\nslave = \"{slave}\"\n\
         master = \"{master}\"\ndiscretization = \"segment\"\n[[step]]\nincrements = 1\nfix = [{}]\n{load}",
        ring("i", inner, counts[0]),
        ring("o", outer, counts[1]),
        fix.join(", ")
    ))
}

/// One quadratic face goes round a quarter: it is smooth, however far it turns.
#[test]
fn a_quadratic_face_may_be_a_quarter_circle() {
    for sides in [["i.rmax", "o.rmin"], ["o.rmin", "i.rmax"]] {
        let pressure = "pressure = [{ set = \"i.rmin\", value = 20.0 }]\n";
        let run = quadratic_rings([[1.0, 2.0], [2.0, 3.0]], [1, 1], sides, pressure).solve(1, &[]);
        // Lamé, as above, over the length of the chord.
        assert_small(sides[0], run.history().last("c.fx").abs() / 0.2 / (20.0 * 5.0 / 32.0) - 1.0, 5e-3);
        assert_eq!(run.summary()["cutbacks"], 0);
    }
}

/// Where faces are off the arc by as much as a fit overlaps, that is told; not where they are finer. In one pass it is the master's
/// that are, between their nodes.
#[test]
fn fits_of_coarse_faces_are_warned_of() {
    let bodies = ["i.rmax", "o.rmin"];
    let swapped = ["o.rmin", "i.rmax"];
    for (counts, sides, discretization, warns) in [
        ([2, 3], bodies, "segment", true),
        ([8, 12], bodies, "segment", false),
        ([2, 3], bodies, "one-pass", false),
        ([2, 3], swapped, "one-pass", true),
        ([3, 2], bodies, "one-pass", true),
        ([8, 12], swapped, "one-pass", false),
    ] {
        let bench = quadratic_rings([[1.0, 2.001], [2.0, 3.0]], counts, sides, "");
        for ranks in [1, 2] {
            let run = bench.solve(ranks, &["--set", &format!("contact.c.discretization={discretization:?}")]);
            let told = run.log().contains("too coarse for so small an overlap");
            assert_eq!(told, warns, "{counts:?} {sides:?} {discretization}");
        }
    }
}

/// Meshes that match node on node over a curved joint, but for the slivers by which bodies move along it: what these make of the
/// integrals is as small as they are, whatever the elements.
#[test]
fn slivers_of_matching_meshes_do_not_count() {
    for tetrahedra in [false, true] {
        for (friction, overlap) in [(0.0, 0.0), (0.0, 1e-9), (0.0, 1e-4), (0.01, 0.0)] {
            let ring = |name: &str, [inner, outer]: [f64; 2]| {
                let place = |[r, t, z]: [f64; 3]| {
                    let (radius, angle) = (inner + (outer - inner) * r, 0.5 * std::f64::consts::PI * t);
                    [radius * angle.cos(), radius * angle.sin(), 10.0 * z].map(|x| if x.abs() < 1e-9 { 0.0 } else { x })
                };
                (format!("{name}.msh"), common::msh::block([4, 6, 3], tetrahedra, place))
            };
            let body = |name: &str| {
                format!(
                    "body.{name} = {{ mesh = \"{name}.msh\", material = \"m\", symmetry = [\"ymin\", \"ymax\"] }}\n"
                )
            };
            let bench = Bench::new(&format!(
                "{}{}material.m = {{ model = \"hooke\", young = 2e5, poisson = 0.3 }}\n\
                 contact.c = {{ slave = \"shaft.xmax\", master = \"hub.xmin\", discretization = \"segment\", \
                 friction = {friction:?} }}\n\
                 [[step]]\nincrements = 2\npressure = [{{ set = \"shaft.xmin\", value = 20.0 }}]\n\
                 fix = [{{ set = \"shaft.zmin\", directions = \"z\" }}, {{ set = \"hub.zmin\", directions = \"z\" }}]\n",
                body("shaft"),
                body("hub")
            ));
            for (name, mesh) in [ring("shaft", [5.0, 20.0 + overlap]), ring("hub", [20.0, 40.0])] {
                bench.write(&name, &mesh);
            }
            let run = bench.solve(2, &[]);
            let what = format!("{tetrahedra}, {friction}, {overlap}: {}", run.log());
            assert_eq!((run.history().len(), run.history().last("failures")), (2, 0.0), "{what}");
            assert!(run.history().column("iterations").iter().all(|n| *n <= 12.0), "{what}");
        }
    }
}

/// A tool presses a block evenly, whether the slave has the block's sides or not: these see the tool as soon as they bulge, from all
/// up their height, and would keep its edges off. So does another block, and as by nodes.
#[test]
fn sides_in_the_slave_do_not_keep_its_edges_off() {
    let plane = "tool.punch.plane = { point = [0.0, 4.0, 0.0], normal = [0.0, -1.0, 0.0] }";
    let block = "body.punch = { material = \"hard\", block = { box = { origin = [0.0, 4.0, 0.0], size = [6.0, 2.0, 6.0] }, \
                 elements = [6, 1, 6] }, symmetry = [\"xmin\", \"zmin\"] }";
    for (punch, master, moved) in [(plane, "punch", "punch"), (block, "punch.ymin", "punch.ymax")] {
        let bench = Bench::new(&format!(
            r#"
{punch}
[body.block]
material = "rubber"
element = "hex8"
symmetry = ["xmin", "zmin"]
[body.block.block]
box = {{ size = [4.0, 4.0, 4.0] }}
elements = [4, 4, 4]
faces = {{ bottom = "ymin", top = "ymax", skin = ["ymax", "xmax", "zmax"] }}
[material]
rubber = {{ model = "neo-hookean", young = 60.0, poisson = 0.3 }}
hard = {{ model = "neo-hookean", young = 6e4, poisson = 0.3 }}
[contact.c]
slave = "block.skin"
master = "{master}"
discretization = "segment"
[[step]]
increments = 4
fix = [{{ set = "block.bottom", directions = "y" }}]
move = [{{ target = "{moved}", by = [0.0, -0.2, 0.0] }}]
[output]
history = ["block.bottom"]
"#
        ));
        let force = |ranks: usize, settings: &[&str]| {
            let settings: Vec<&str> = settings.iter().flat_map(|entry| ["--set", entry]).collect();
            bench.solve(ranks, &settings).history().last("block.bottom.fy")
        };
        let top = force(1, &["contact.c.slave=block.top"]);
        if punch == plane {
            assert_small("even", force(1, &["contact.c.discretization=one-pass"]) / top - 1.0, 1e-8);
        }
        for method in ["augmented-lagrangian", "lagrange"] {
            for ranks in [1, 2] {
                let skin = force(ranks, &[&format!("contact.c.method={method}")]);
                assert_small(&format!("{master}, {method}, {ranks} ranks"), skin / top - 1.0, 1e-8);
            }
        }
    }
}

/// A ridge that goes into a coarse slave while the gaps around its node are hardly closed in the mean: what is borne is a small part
/// of what finer facets bear, and that is told of. One that is released again is told of as it was when it was pressed.
#[test]
fn what_a_mean_lets_in_is_told_of() {
    let pressed = |facets: usize, deep: f64, more: &str, ranks: usize| {
        let bench = Bench::new(&format!(
            r#"
body.pad.material = "soft"
body.pad.plane_strain = true
body.pad.block = {{ box = {{ origin = [-0.8, 0.0, 0.0], size = [1.6, 0.8, 1.0] }}, elements = [{facets}, {}, 1] }}
material.soft = {{ model = "neo-hookean", young = 1000.0, poisson = 0.3 }}
tool.ridge.profile = {{ points = [[3.0, -0.75], [0.0, 0.0], [-3.0, -0.75]], extrude = {{ length = 1.0 }} }}
contact.c = {{ slave = "pad.ymin", master = "ridge", discretization = "segment" }}
[[step]]
increments = 4
fix = [{{ set = "pad.ymax", directions = "x" }}]
move = [{{ target = "pad.ymax", by = [0.0, -{deep}, 0.0] }}]
{more}
"#,
            facets / 2
        ));
        let run = bench.solve(ranks, &[]);
        assert_small("across", run.history().last("ridge.fx"), 1e-10);
        let most = run.history().column("ridge.fy").iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        (most, run.log().contains("where displacements are given forces lack"))
    };
    let back = "[[step]]\nincrements = 2\nfix = [{ set = \"pad.ymax\", directions = \"x\" }]\n\
                move = [{ target = \"pad.ymax\", by = [0.0, 0.017, 0.0] }]";
    // A point of a facet right over the edge is pushed to neither side.
    assert!(pressed(5, 0.12, "", 1).0 > 0.0);
    let right = pressed(64, 0.018, "", 1);
    assert!(!right.1, "{right:?}");
    for more in ["", back] {
        for ranks in [1, 2] {
            let coarse = pressed(8, 0.018, more, ranks);
            assert!(coarse.0 < 0.3 * right.0 && coarse.1, "{coarse:?}, {right:?}");
        }
        // Released to a touch, a mesh that bore what is right is not told of for the little that is left.
        assert!(!pressed(64, 0.018, more, 1).1);
    }
}

/// Nodes that are held across the master's normal, under a roller: fields have its normal, not what is left of it.
#[test]
fn the_normal_of_nodes_that_are_held_is_that_of_the_surface() {
    let run = Bench::new(
        r#"
        [body.block]
        block = { box = { size = [1.0, 4.0, 1.0] }, elements = [1, 12, 3] }
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [tool.roller]
        cylinder = { point = [0.0, 2.0, 3.0], axis = [1.0, 0.0, 0.0], radius = 2.0 }
        [contact.top]
        slave = "block.zmax"
        master = "roller"
        discretization = "segment"
        friction = 0.2
        [[step]]
        increments = 2
        fix = [{ set = "block.zmin" }, { set = "block", directions = "y" }]
        move = [{ target = "roller", by = [0.0, 0.0, -0.4] }]
        "#,
    )
    .solve(1, &[]);
    let last = run.written();
    let (status, normals) = (run.scalars(last, "contact.top", "status"), run.vectors(last, "contact.top", "normal"));
    let (points, moved) = (run.points("contact.top"), run.vectors(last, "contact.top", "displacement"));
    let (tractions, pressures) =
        (run.vectors(last, "contact.top", "traction"), run.scalars(last, "contact.top", "pressure"));
    let mut steepest: f64 = 0.0;
    for k in (0..status.len()).filter(|&k| status[k] > 0.0) {
        let (normal, traction) = (Vector3::from(normals[k]), Vector3::from(tractions[k]));
        let away = Vector3::new(0.0, points[k][1] + moved[k][1] - 2.0, points[k][2] + moved[k][2] - 2.6);
        assert_small("normal", (normal - away.normalize()).norm(), 0.05);
        assert_close("pressure", pressures[k], normal.dot(&traction), 1e-12);
        steepest = steepest.max(normal.y.abs());
    }
    assert!(steepest > 0.3, "{steepest}");
}

/// A slab over the end of a rigid table feels that end wherever it lies under its facets, and not the wall below: as one over a
/// stiff body does, whose faces are cut where the slab's end over them.
#[test]
fn the_end_of_a_tool_is_where_it_is() {
    let table = |reach: f64| {
        let place = |[u, v, w]: [f64; 3]| {
            let y = 6.0 * (v - 0.5);
            [-4.0 + u * (4.0 + reach + 0.4 * y), y, w - 1.0]
        };
        msh::together(&[&msh::block([4, 4, 1], false, place)])
    };
    let pressed = |master: &str, friction: f64, reach: f64| {
        let bench = Bench::new(&format!(
            r#"
body.slab.material = "soft"
body.slab.block = {{ box = {{ origin = [-3.0, -2.0, 0.0], size = [4.0, 4.0, 1.0] }}, elements = [7, 6, 1] }}
material.soft = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
material.stiff = {{ model = "neo-hookean", young = 1e9, poisson = 0.3 }}
{master}
contact.c = {{ slave = "slab.zmin", friction = {friction:?}, discretization = "segment", {} }}
[[step]]
increments = 2
fix = [{}]
move = [{{ target = "slab.zmax", by = [0.0, 0.0, -0.05] }}]
[[step]]
increments = 5
fix = [{1}]
move = [{{ target = "slab.zmax", by = [0.3, 0.0, 0.0] }}]
[output]
history = ["slab.zmax"]
every = 100
"#,
            if master.starts_with("body") { "master = \"table.zmax0\"" } else { "master = \"table\"" },
            if master.starts_with("body") { "{ set = \"table.zmin0\" }" } else { "" },
        ));
        bench.write("table.msh", &table(reach));
        let run = bench.solve(1, &[]);
        ["fx", "fy", "fz"].map(|d| run.history().last(&format!("slab.zmax.{d}")))
    };
    let body = "body.table = { mesh = \"table.msh\", material = \"stiff\" }";
    let tool = |group: &str| format!("tool.table = {{ mesh = \"table.msh\", group = \"{group}\" }}");
    for friction in [0.0, 0.3] {
        let mut last = 0.0;
        for reach in [0.4, 0.7] {
            let [over, open, closed] =
                [body, &tool("zmax0"), &tool("all")].map(|master| pressed(master, friction, reach));
            let what = format!("{friction} {reach}: {over:?}, {open:?}, {closed:?}");
            for d in 0..3 {
                assert_small(&what, (open[d] - over[d]) / over[2], 3e-4);
                assert_small(&what, (closed[d] - open[d]) / over[2], 3e-4);
            }
            assert!(open[2].abs() > last, "{what}");
            last = open[2].abs();
        }
    }
}

/// A block at rest on two tables that lie flush stands as on one, wherever their joint is, and slides off an end without a jump.
#[test]
fn a_block_stands_over_the_joint_of_two_tools() {
    let profile = |name: &str, points: &str| format!("tool.{name}.profile.points = [{points}]\n");
    let scene = |tools: &[(&str, &str)], by: f64, friction: f64| {
        let each =
            |of: &dyn Fn(&str, &str) -> String| tools.iter().map(|(name, points)| of(name, points)).collect::<String>();
        let run = Bench::new(&format!(
            r#"
body.b.material = "m"
body.b.plane_strain = true
body.b.block = {{ box = {{ origin = [3.1, 0.0, 0.0], size = [4.0, 2.0, 1.0] }}, elements = [8, 4, 1] }}
material.m = {{ model = "hooke", young = 1e3, poisson = 0.3, density = 1e-3 }}
{}{}
[output]
history = ["b.ymax"]
[[step]]
increments = 3
fix = [{{ set = "b.xmin", directions = "x" }}]
gravity = [0.0, -1000.0, 0.0]
[[step]]
increments = 20
keep = true
move = [{{ target = "b.xmin", by = [{by:?}, 0.0, 0.0], directions = "x" }}]
"#,
            each(&|name, points| profile(name, points)),
            each(&|name, _| format!(
                "contact.{name} = {{ slave = \"b.ymin\", master = \"{name}\", friction = {friction:?}, discretization = \"segment\" }}\n"
            )),
        ))
        .solve(1, &[]);
        assert!(!run.stderr.contains("jump") && run.summary()["cutbacks"] == 0, "{}", run.stderr);
        let history = run.history();
        let sum = |c: &str| tools.iter().map(|(name, _)| history.last(&format!("{name}.{c}"))).sum::<f64>();
        (history.column("b.ymax.uy").to_vec(), [sum("fx"), sum("fy")])
    };
    let flat = [("flat", "[15.0, 0.0], [-5.0, 0.0]")];
    let two = [
        ("left", "[5.0, -2.0], [5.0, 0.0], [-5.0, 0.0], [-5.0, -2.0]"),
        ("right", "[15.0, -2.0], [15.0, 0.0], [5.0, 0.0], [5.0, -2.0]"),
    ];
    // What sticks to both is shared, and bears along in another way while it is pressed.
    for (friction, tolerance) in [(0.0, 1e-9), (0.4, 1e-4)] {
        let ((one, force), (over, forces)) = (scene(&flat, 0.9, friction), scene(&two, 0.9, friction));
        for (a, b) in one.iter().zip(&over) {
            assert_small(&format!("{friction}: {b} for {a}"), (a - b) / one[2], tolerance);
        }
        for (a, b) in force.iter().zip(forces) {
            assert_small(&format!("{friction}: {forces:?} for {force:?}"), (a - b) / 8.0, tolerance);
        }
    }
    // Off the end: down by little in each increment, and with all of its weight on the tool.
    let (end, [along, up]) = scene(&two[..1], -3.1 + 2.9, 0.0);
    assert!(end.len() == 23);
    assert_small("along", along, 1e-9);
    assert_close("weight", up, 8.0, 1e-9);
}
