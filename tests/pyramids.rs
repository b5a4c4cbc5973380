//! Pyramids that lead from hexahedra to tetrahedra: convergence beside hexahedra alone, faces of three and four nodes in contact and
//! tied, ranks and restarts, meshes split further, decks, hexahedra with nodes that occur twice, and what is refused.

mod common;

use common::fillers::{assert_even, assert_same_on_ranks_and_restarted, blocks, in_tube, tubes};
use common::msh::Cut;
use common::{Bench, assert_close, assert_small, msh};

/// A tube under inner pressure: with every fourth hexahedron as six
/// pyramids its error (rms) is at most twice that of hexahedra alone, five times where the volume is kept, and falls at least as that
/// does; linear tetrahedra, inside half of the wall, are stiffer, and lock where the volume is kept.
#[test]
fn a_filled_tube_converges_as_one_of_hexahedra() {
    for (element, poisson) in [("hex8", 0.3), ("hex8-fbar", 0.4999)] {
        let mesh = |(b, (kind, n)): (usize, (&str, usize))| {
            let cut = |e: usize| match kind {
                "pyr" if (e % n + 2 * (e / n)).is_multiple_of(4) => Cut::Pyramids,
                "tet" if e % n < n / 2 => Cut::Tetrahedra,
                _ => Cut::Whole,
            };
            // One beside the other along z.
            let mesh = msh::block([n, n, 1], false, |x| in_tube(b as f64, x));
            (format!("{kind}{n}"), msh::filled(&mesh, cut))
        };
        let all = [6, 12].into_iter().flat_map(|n| ["hex", "pyr", "tet"].map(|kind| (kind, n)));
        let meshes: Vec<(String, String)> = all.enumerate().map(mesh).collect();
        let (found, log) = tubes(element, poisson, &meshes);
        let [hex, pyr, tet, fine_hex, fine_pyr, fine_tet] = found[..] else { panic!() };
        let most = if poisson < 0.4 { 2.0 } else { 5.0 };
        assert!(pyr < most * hex && fine_pyr < most * fine_hex && fine_pyr < 0.3 * pyr, "{found:?}");
        if poisson < 0.4 {
            assert!(tet < 3.0 * hex && fine_tet < 0.35 * tet, "{found:?}");
        } else {
            assert!(log.contains("body `tet12`: linear tetrahedra are too stiff"), "{log}");
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
    assert_same_on_ranks_and_restarted(&bench, &history);
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
        let fill = |mesh: &str, n: usize, _: usize| {
            msh::filled(mesh, |e| match (e % n + e / n % n) % 3 {
                0 => Cut::Whole,
                1 => Cut::Pyramids,
                _ => Cut::Tetrahedra,
            })
        };
        assert_even(joint, &blocks(joint, [3, 4], 0.0, fill).solve(2, &[]), 1e-10);
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
    let deck = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n9, 1, 0, 2\n\
                *ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=C3D4\n2, 5, 6, 7, 9\n";
    bench.write("cube.inp", deck);
    let (code, text) = said(&bench, &["body.cube.mesh=\"cube.inp\""]);
    let told = "tetrahedra stand beside hexahedra on pyramids";
    assert!(code == 2 && text.contains("lies on a quadrilateral") && text.contains(told), "{code}\n{text}");
}
