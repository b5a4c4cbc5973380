//! Pyramids that lead from hexahedra to tetrahedra: convergence beside hexahedra alone, faces of three and four nodes in contact and
//! tied, ranks and restarts, meshes split further, decks, hexahedra with nodes that occur twice, and what is refused.

mod common;

use common::msh::Cut;
use common::{Bench, Run, assert_close, assert_small, msh};
use std::f64::consts::PI;
use std::fmt::Write;

/// A quarter of a tube of radii 1 and 2 in plane strain, under inner pressure, as that of `wedges`: with every fourth hexahedron as six
/// pyramids its error (rms) is at most twice that of hexahedra alone, five times where the volume is kept, and falls at least as that
/// does; linear tetrahedra, inside half of the wall, are stiffer, and lock where the volume is kept.
#[test]
fn a_filled_tube_converges_as_one_of_hexahedra() {
    let (young, p) = (100.0, 0.01);
    // One beside the other along z.
    let place = |at: f64, [r, t, z]: [f64; 3]| {
        let (sine, cosine) = (0.5 * PI * t).sin_cos();
        [(1.0 + r) * cosine, (1.0 + r) * sine, at + 0.2 * z].map(|x| if x.abs() < 1e-12 { 0.0 } else { x })
    };
    for (element, poisson) in [("hex8", 0.3), ("hex8-fbar", 0.4999)] {
        let mut scene = format!("[material.m]\nmodel = \"hooke\"\nyoung = {young:?}\npoisson = {poisson:?}\n");
        let (mut fix, mut pressure) = (String::new(), String::new());
        let sizes = [6, 12];
        let kinds = ["hex", "pyr", "tet"];
        let bodies: Vec<String> = sizes.iter().flat_map(|n| kinds.map(|kind| format!("{kind}{n}"))).collect();
        for body in &bodies {
            let _ = writeln!(scene, "[body.{body}]\nmesh = \"{body}.msh\"\nmaterial = \"m\"\nelement = \"{element}\"");
            for (side, axis) in [("ymin", "y"), ("ymax", "x"), ("zmin", "z"), ("zmax", "z")] {
                let _ = write!(fix, "{{ set = \"{body}.{side}\", directions = \"{axis}\" }}, ");
            }
            let _ = write!(pressure, "{{ set = \"{body}.xmin\", value = {p:?} }}, ");
        }
        let bench = Bench::new(&format!("{scene}[[step]]\nincrements = 1\nfix = [{fix}]\npressure = [{pressure}]\n"));
        for (b, body) in bodies.iter().enumerate() {
            let n = sizes[b / kinds.len()];
            let cut = |e: usize| match b % kinds.len() {
                1 if (e % n + 2 * (e / n)).is_multiple_of(4) => Cut::Pyramids,
                2 if e % n < n / 2 => Cut::Tetrahedra,
                _ => Cut::Whole,
            };
            let mesh = msh::block([n, n, 1], false, |x| place(b as f64, x));
            bench.write(&format!("{body}.msh"), &msh::filled(&mesh, cut));
        }
        let run = bench.solve(2, &[]);
        let error = |body: &String| {
            let grid = format!("body.{body}");
            let (points, moved) = (run.points(&grid), run.vectors(1, &grid, "displacement"));
            let off = |(x, u): (&[f64; 3], &[f64; 3])| {
                let r = x[0].hypot(x[1]);
                let exact = (1.0 + poisson) * p / (3.0 * young) * ((1.0 - 2.0 * poisson) * r + 4.0 / r);
                ((x[0] * u[0] + x[1] * u[1]) / r / exact - 1.0).powi(2)
            };
            (points.iter().zip(&moved).map(off).sum::<f64>() / points.len() as f64).sqrt()
        };
        let found: Vec<f64> = bodies.iter().map(error).collect();
        println!("{element}, {poisson}: {found:?}");
        let [hex, pyr, tet, fine_hex, fine_pyr, fine_tet] = found[..] else { panic!() };
        let most = if poisson < 0.4 { 2.0 } else { 5.0 };
        assert!(pyr < most * hex && fine_pyr < most * fine_hex && fine_pyr < 0.3 * pyr, "{found:?}");
        if poisson < 0.4 {
            assert!(tet < 3.0 * hex && fine_tet < 0.35 * tet, "{found:?}");
        } else {
            assert!(run.log().contains("body `tet12`: linear tetrahedra are too stiff"), "{}", run.log());
        }
    }
}

/// A cube between plates that hold it: hexahedra at the foot, tetrahedra at the head, and pyramids between, with some more about.
fn cube(n: usize, element: &str) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.cube]
        mesh = "cube.msh"
        material = "metal"
        element = "{element}"
        [material.metal]
        model = "j2"
        young = 1000.0
        poisson = 0.3
        yield_stress = 1.0
        hardening = {{ linear = 1.0 }}
        [tool.ball]
        sphere = {{ center = [0.5, 0.5, 3.0], radius = 2.0 }}
        [contact.top]
        slave = "cube.zmax"
        master = "ball"
        friction = 0.2
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "cube.zmin" }}]
        move = [{{ target = "ball", by = [0.0, 0.0, -0.05] }}]
        [[step]]
        name = "slide"
        increments = 2
        fix = [{{ set = "cube.zmin" }}]
        move = [{{ target = "ball", by = [0.1, 0.0, 0.0] }}]
        [output]
        every = 4
        history = ["cube.zmin"]
        checkpoint = {{ minutes = 60.0 }}
        "#
    ));
    let mesh = msh::block([n, n, n], false, |x| x);
    let cut = |e: usize| match e / (n * n) {
        k if 2 * k >= n => Cut::Tetrahedra,
        _ if e.is_multiple_of(5) => Cut::Pyramids,
        _ => Cut::Whole,
    };
    bench.write("cube.msh", &msh::filled(&mesh, cut));
    bench
}

/// Metal flows under a ball that slides over triangles; forces balance, on two ranks and restarted it is the same, and a finer mesh of
/// its elements can be made of it.
#[test]
fn ranks_restarts_and_refinement() {
    let bench = cube(4, "hex8-sri");
    let run = bench.solve(1, &[]);
    let log = run.log();
    assert!(log.contains("body `cube`: hex8-sri and pyramid5-sri and tet4"), "{log}");
    assert!(log.contains("body `cube`: linear tetrahedra are too stiff"), "{log}");
    let history = run.history();
    let [foot, ball] = ["cube.zmin", "ball"].map(|name| ["fx", "fz"].map(|c| history.last(&format!("{name}.{c}"))));
    assert!(ball[0].abs() > 0.1 * ball[1].abs(), "{ball:?}");
    (0..2).for_each(|d| assert_small("balance", (foot[d].abs() - ball[d].abs()) / ball[1], 1e-8));
    // Rounding decides on the last iteration.
    let same = |what: &str, other: Run| {
        assert_small(what, other.history().without("iterations").difference(&history), 1e-8);
    };
    same("two ranks", bench.solve(2, &[]));
    let first = bench.solve(2, &["--steps", "1"]);
    let (scene, out) = (bench.path("scene.toml"), first.out.to_str().unwrap());
    let on = common::nagata(
        &bench.path(""),
        1,
        &["run", scene.to_str().unwrap(), "--out", out, "--restart"],
        first.out.clone(),
    );
    assert_eq!(on.code, 0, "{}", on.stderr);
    same("restarted", on);
    let fine = bench.solve(2, &["--set", "body.cube.refine=1"]);
    assert_close("refined", fine.history().last("ball.fz"), ball[1], 0.1);
}

/// Even stress passes through a seam of hexahedra and tetrahedra, both with pyramids behind, from segment to segment and tied.
#[test]
fn faces_of_three_and_four_nodes_pass_an_even_stress_on() {
    for joint in [
        "[contact.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.zmax\"\ndiscretization = \"segment\"",
        "[tie.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.zmax\"",
    ] {
        let sides = |body: &str| {
            let of = |side: &str, axis: &str| format!("{{ set = \"{body}.{side}\", directions = \"{axis}\" }}, ");
            of("xmin", "x") + &of("xmax", "x") + &of("ymin", "y") + &of("ymax", "y")
        };
        let bench = Bench::new(&format!(
            "body.lower = {{ mesh = \"lower.msh\", material = \"soft\" }}\n\
             body.upper = {{ mesh = \"upper.msh\", material = \"soft\", element = \"hex8-sri\" }}\n\
             material.soft = {{ model = \"neo-hookean\", young = 100.0, poisson = 0.3 }}\n{joint}\n\
             [[step]]\nincrements = 2\nfix = [{}{}{{ set = \"lower.zmin\", directions = \"z\" }}]\n\
             move = [{{ target = \"upper.zmax\", by = [0.0, 0.0, -1.0], directions = \"z\" }}]\n",
            sides("lower"),
            sides("upper")
        ));
        for (name, n, from) in [("lower", 3, 0.0), ("upper", 4, 10.0)] {
            let mesh = msh::block([n, n, 2], false, |[s, t, r]| [10.0 * s, 10.0 * t, from + 10.0 * r]);
            let cut = |e: usize| match (e % n + e / n % n) % 3 {
                0 => Cut::Whole,
                1 => Cut::Pyramids,
                _ => Cut::Tetrahedra,
            };
            bench.write(&format!("{name}.msh"), &msh::filled(&mesh, cut));
        }
        let run = bench.solve(2, &[]);
        for grid in ["body.lower", "body.upper"] {
            let moved = run.vectors(run.written(), grid, "displacement");
            for (x, u) in run.points(grid).iter().zip(&moved) {
                let off = u[0].abs().max(u[1].abs()).max((u[2] + 0.05 * x[2]).abs());
                assert_small(&format!("{joint} {x:?}"), off, 1e-10);
            }
        }
    }
}

/// A hexahedron with a roof, a pyramid and a tetrahedron on it, as hexahedra with nodes that occur twice and as what these are.
#[test]
fn hexahedra_that_collapse_are_what_they_are() {
    const NODES: &str = "1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
                         9, 0, 0.5, 1.6\n10, 1, 0.5, 1.6\n11, 1.7, 0.5, 0.5\n12, 1.6, 1.4, 0.5\n";
    let solve = |elements: &str, [roof, slope, tip]: [u8; 3]| -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let bench = Bench::new("");
        std::fs::remove_file(bench.path("scene.toml")).unwrap();
        bench.write(
            "deck.inp",
            &format!(
                "*NODE, NSET=NALL\n{NODES}{elements}*ELSET, ELSET=EALL, GENERATE\n1, 4\n*SURFACE, NAME=SIDE\n3, S{slope}\n\
                 *MATERIAL, NAME=M\n*ELASTIC\n100, 0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n\
                 *BOUNDARY\n1, 1, 3\n4, 1, 3\n5, 1, 3\n8, 1, 3\n*STEP, NLGEOM\n*STATIC\n1.0, 1.0\n\
                 *DLOAD\n2, P{roof}, 1.0\n4, P{tip}, 2.0\n*DSLOAD\nSIDE, P, 3.0\n*END STEP\n"
            ),
        );
        let (from, to) = (bench.path("deck.inp"), bench.path("scene.toml"));
        nagata::convert::convert(&from, Some(&to)).unwrap();
        let run = bench.solve(2, &[]);
        let scene = std::fs::read_to_string(to).unwrap();
        let body = scene.split("[body.").nth(1).and_then(|rest| rest.split(']').next()).unwrap();
        let grid = format!("body.{body}");
        (run.points(&grid), run.vectors(run.written(), &grid, "displacement"))
    };
    let collapsed = "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 5, 6, 7, 8, 9, 10, 10, 9\n\
                     3, 2, 3, 7, 6, 11, 11, 11, 11\n4, 3, 7, 11, 11, 12, 12, 12, 12\n";
    let plain = "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=C3D6\n2, 5, 8, 9, 6, 7, 10\n\
                 *ELEMENT, TYPE=C3D5\n3, 2, 3, 7, 6, 11\n*ELEMENT, TYPE=C3D4\n4, 3, 7, 11, 12\n";
    let (found, expected) = (solve(collapsed, [3, 3, 3]), solve(plain, [5, 2, 2]));
    assert_eq!(found.0, expected.0);
    let most = expected.1.iter().flatten().fold(0.0f64, |most, u| most.max(u.abs()));
    assert!(most > 0.01, "{most}");
    for (a, b) in found.1.iter().zip(&expected.1) {
        (0..3).for_each(|d| assert_small("displacement", (a[d] - b[d]) / most, 1e-12));
    }
}

/// A mesh of nothing else, which has no other cells in its results.
#[test]
fn pyramids_alone() {
    let bench = Bench::new(
        "body.b = { mesh = \"b.msh\", material = \"m\", element = \"pyramid5\" }\n\
         material.m = { model = \"neo-hookean\", young = 100.0, poisson = 0.3 }\n\
         [[step]]\nincrements = 1\nfix = [{ set = \"b.zmin\", directions = \"z\" }, { set = \"b.xmin\", directions = \"x\" },\
         { set = \"b.ymin\", directions = \"y\" }]\nmove = [{ target = \"b.zmax\", by = [0, 0, 0.1], directions = \"z\" }]\n\
         [output]\nfields = [\"nodal_stress\"]\nprobe = [{ name = \"p\", point = [0.25, 0.25, 0.25] }]\n",
    );
    bench.write("b.msh", &msh::filled(&msh::block([2, 2, 2], false, |x| x), |_| Cut::Pyramids));
    let run = bench.solve(2, &[]);
    let (points, moved) = (run.points("body.b"), run.vectors(1, "body.b", "displacement"));
    for (x, u) in points.iter().zip(&moved) {
        assert_small(&format!("{x:?}"), u[2] - 0.1 * x[2], 1e-10);
    }
    assert_eq!(run.field("grids/body_b/cells").len(), 48 * 5);
    let stress = run.field("increments/000001/body_b/node/nodal_stress");
    let first = &stress[..6];
    assert!(stress.chunks(6).all(|s| s.iter().zip(first).all(|(a, b)| (a - b).abs() < 1e-9 * first[2].abs())));
}

/// What pyramids are not for.
#[test]
fn what_pyramids_are_not_for_is_refused() {
    let said = |bench: &Bench, settings: &[&str]| {
        let (out, scene) = (bench.path("out"), bench.path("scene.toml"));
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let all: Vec<&str> = ["check", scene.to_str().unwrap()].into_iter().chain(set).collect();
        let run = common::nagata(&bench.path(""), 2, &all, out);
        (run.code, run.stdout + &run.stderr)
    };
    let bench = cube(2, "hex8");
    for (settings, told) in [
        (["body.cube.element=\"hex8-shell\""], "solid-shell elements are hexahedra alone"),
        (["body.cube.element=\"tet4\""], "the mesh of body `cube` has hexahedra and pyramids and linear tetrahedra"),
    ] {
        let (code, text) = said(&bench, &settings);
        assert!(code == 2 && text.contains(told), "{settings:?}: {code}\n{text}");
    }
    // Tetrahedra right on a hexahedron, and alone where hexahedra are asked for.
    let mesh = msh::block([2, 2, 2], true, |x| x);
    bench.write("cube.msh", &mesh);
    let (code, text) = said(&bench, &[]);
    assert!(code == 2 && text.contains("the mesh of body `cube` has linear tetrahedra"), "{code}\n{text}");
    let below = msh::block([1, 1, 1], false, |[x, y, z]| [x, y, z - 1.0]);
    let above = msh::block([1, 1, 1], true, |x| x);
    bench.write("cube.msh", &merged(&below, &above));
    let (code, text) = said(&bench, &[]);
    let told = "tetrahedra stand beside hexahedra on pyramids";
    assert!(code == 2 && text.contains("lies on a quadrilateral") && text.contains(told), "{code}\n{text}");
}

/// Two blocks of one element on each other as one mesh, which share the nodes between them.
fn merged(below: &str, above: &str) -> String {
    let parts = |mesh: &str| {
        let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
        let (nodes, elements) = rest.split_once("$EndNodes\n$Elements\n").unwrap();
        let lines = |text: &str| -> Vec<String> {
            text.lines().skip(1).filter(|line| !line.starts_with('$')).map(String::from).collect()
        };
        (head.to_string(), lines(nodes), lines(elements))
    };
    let ((head, mut nodes, mut elements), (_, upper, others)) = (parts(below), parts(above));
    nodes.extend(upper[4..].iter().zip(9..).map(|(line, k)| format!("{k} {}", line.split_once(' ').unwrap().1)));
    for line in others {
        let words: Vec<usize> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let moved = words.iter().enumerate().map(|(k, word)| if k < 5 { *word } else { word + 4 });
        elements.push(moved.map(|word| word.to_string()).collect::<Vec<_>>().join(" "));
    }
    for (k, line) in elements.iter_mut().enumerate() {
        *line = format!("{} {}", k + 1, line.split_once(' ').unwrap().1);
    }
    format!(
        "{head}$Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n{}\n$EndElements\n",
        nodes.len(),
        nodes.join("\n"),
        elements.len(),
        elements.join("\n")
    )
}
