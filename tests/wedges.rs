//! Wedges between hexahedra: convergence and volume beside hexahedra alone, faces of three and of four nodes in contact and tied,
//! ranks and restarts, a deck of both, and what is refused. Closed forms of homogeneous states are in `elasticity`.

mod common;

use common::fillers::{self, assert_even, assert_same_on_ranks_and_restarted, in_tube, tubes};
use common::{Bench, assert_close, assert_small, deck, msh};
use std::fmt::Write;

/// A tube under inner pressure. With every eighth hexahedron as two wedges its error (rms) is at most twice that of hexahedra alone, and falls as that does.
#[test]
fn a_filled_tube_converges_as_one_of_hexahedra() {
    for (element, poisson) in [("hex8", 0.3), ("hex8-fbar", 0.4999)] {
        let of = |n: usize| {
            let mesh = msh::block([n, n, 1], false, |x| in_tube(0.0, x));
            let mixed = msh::wedges(&mesh, |e| (3 * (e % n) + 5 * (e / n)).is_multiple_of(8));
            [(format!("hex{n}"), mesh), (format!("mix{n}"), mixed)]
        };
        let (found, _) = tubes(element, poisson, &[of(6), of(12)].concat());
        let [hex, mix, fine_hex, fine_mix] = found[..] else { panic!() };
        assert!(mix < 2.0 * hex && fine_mix < 2.0 * fine_hex && fine_mix < 0.28 * mix, "{found:?}");
    }
}

/// A cube between plates that hold it, of hexahedra and with a third of them as wedges that stand across the load.
fn cube(n: usize) -> Bench {
    // The mesh is extruded along its z, which lies along x here.
    let place = |[x, y, z]: [f64; 3]| [z, x, y];
    let mut scene = String::from(
        "material.rubber = { model = \"neo-hookean\", young = 1.0, poisson = 0.4999 }\n\
         material.metal = { model = \"j2\", young = 1000.0, poisson = 0.3, yield_stress = 1.0, hardening = { linear = 1.0 } }\n",
    );
    let (mut fix, mut moved, mut sets) = (String::new(), String::new(), String::new());
    for (mesh, material) in [("hex", "rubber"), ("mix", "rubber"), ("hex", "metal"), ("mix", "metal")] {
        let body = format!("{mesh}-{material}");
        let _ = writeln!(scene, "body.{body} = {{ mesh = \"{mesh}.msh\", material = \"{material}\" }}");
        for (side, axis) in [("zmin", "x"), ("xmin", "y"), ("ymin", "z"), ("ymax", "xy")] {
            let _ = write!(fix, "{{ set = \"{body}.{side}\", directions = \"{axis}\" }}, ");
        }
        let _ = write!(moved, "{{ target = \"{body}.ymax\", by = [0.0, 0.0, -0.05], directions = \"z\" }}, ");
        let _ = write!(sets, "\"{body}.ymax\", \"{body}.ymin\", ");
    }
    let step = |name: &str| format!("[[step]]\nname = \"{name}\"\nincrements = 2\nfix = [{fix}]\nmove = [{moved}]\n");
    let output = format!("[output]\nevery = 4\nhistory = [{sets}]\ncheckpoint = {{ minutes = 60.0 }}\n");
    let bench = Bench::new(&(scene + &step("press") + &step("on") + &output));
    let mesh = msh::block([n, n, n], false, place);
    bench.write("mix.msh", &msh::wedges(&mesh, |e| (e % n + 2 * (e / n % n)).is_multiple_of(3)));
    bench.write("hex.msh", &mesh);
    bench
}

/// Hexahedra with full integration would take 20 times the force of the rubber, and twice that of the metal.
#[test]
fn filled_meshes_keep_their_volume_without_locking() {
    let bench = cube(4);
    let run = bench.solve(1, &[]);
    let history = run.history();
    let force = |body: &str| history.last(&format!("{body}.ymax.fz"));
    for (material, exact, most) in [("rubber", -0.1386, 0.07), ("metal", -1.329, 0.05)] {
        let [hex, mix] = ["hex", "mix"].map(|mesh| force(&format!("{mesh}-{material}")));
        assert_close("hexahedra", hex, exact, 0.03);
        assert_close("filled", mix, exact, most);
        let foot = history.last(&format!("mix-{material}.ymin.fz"));
        assert_small("balance", foot / mix + 1.0, 1e-8);
    }
    assert!(run.log().contains("body `mix-metal`: 55 % of its elements are wedges or pyramids"), "{}", run.log());
    assert_same_on_ranks_and_restarted(&bench, &history);
}

/// Two blocks with every other column of hexahedra as wedges, those of the seam distorted within it by `most`.
fn blocks(joint: &str, sizes: [usize; 2], most: f64) -> Bench {
    fillers::blocks(joint, sizes, most, |mesh, n, odd| msh::wedges(mesh, |e| (e % n + e / n % n) % 2 == odd))
}

/// Even stress passes through a seam of triangles and quadrilaterals over others, from segment to segment, and tied; but for
/// rounding where segments are integrated exactly, which the shape functions of distorted quadrilaterals are not.
#[test]
fn faces_of_three_and_four_nodes_pass_an_even_stress_on() {
    let contact = "[contact.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.zmax\"\ndiscretization = ";
    for (joint, meshes, ranks, distorted, tolerance) in [
        (format!("{contact}\"segment\""), [3, 4], 1, 0.0, 1e-12),
        (format!("{contact}\"segment\"\nfriction = 0.3"), [4, 3], 2, 0.05, 1e-6),
        ("[tie.joint]\nslave = \"upper.zmin\"\nmaster = \"lower.zmax\"".to_string(), [3, 4], 2, 0.05, 1e-10),
    ] {
        let run = blocks(&joint, meshes, distorted).solve(ranks, &[]);
        assert_even(&format!("{joint} {meshes:?}"), &run, tolerance);
    }
}

/// A deck of hexahedra and wedges under pressure on all of its surface, which names no faces: it shrinks alike along all axes.
#[test]
fn a_deck_of_hexahedra_and_wedges_is_converted() {
    let (young, poisson, p) = (1000.0, 0.3, 1e-3);
    let cubes = deck([2, 2, 1]);
    let cut = |line: &str| {
        let n: Vec<&str> = line.split(", ").collect();
        let wedge = |id: &str, k: [usize; 6]| format!("{id}, {}\n", k.map(|k| n[k]).join(", "));
        wedge("102", [1, 2, 3, 5, 6, 7]) + &wedge("105", [1, 3, 4, 5, 7, 8])
    };
    let line = cubes.lines().find(|line| line.starts_with("102, ") && line.len() > 12).unwrap();
    let mesh = cubes.replace(&format!("{line}\n"), "").replace(
        "*NSET, NSET=edge",
        &format!("*ELEMENT, TYPE=C3D6\n{}*ELSET, ELSET=EALL, GENERATE\n101, 105\n*NSET, NSET=edge", cut(line)),
    );
    let text = format!(
        "{mesh}*SURFACE, NAME=SKIN\nEALL\n*MATERIAL, NAME=M\n*ELASTIC\n{young:?}, {poisson:?}\n\
         *SOLID SECTION, ELSET=EALL, MATERIAL=M\n*BOUNDARY\n1, 1, 3\nEDGE, 2, 3\n7, 3\n\
         *STEP, NLGEOM\n*STATIC\n1.0, 1.0\n*DSLOAD\nSKIN, P, {p:?}\n*END STEP\n"
    );
    let bench = Bench::new("");
    std::fs::remove_file(bench.path("scene.toml")).unwrap();
    bench.write("deck.inp", &text);
    let (from, to) = (bench.path("deck.inp"), bench.path("scene.toml"));
    nagata::convert::convert(&from, Some(&to)).unwrap();
    let run = bench.solve(2, &[]);
    let scene = std::fs::read_to_string(to).unwrap();
    let body = scene.split("[body.").nth(1).and_then(|rest| rest.split(']').next()).unwrap();
    let (points, moved) =
        (run.points(&format!("body.{body}")), run.vectors(run.written(), &format!("body.{body}"), "displacement"));
    let shrinks = p * (1.0 - 2.0 * poisson) / young;
    for (x, u) in points.iter().zip(&moved) {
        (0..3).for_each(|d| assert_small("displacement", (u[d] + shrinks * x[d]) / shrinks, 1e-5));
    }
    // Of a wedge, code 8, VTK sees both triangles clockwise from inside.
    let cells = run.field(&format!("grids/body_{body}/cells"));
    let (mut rest, mut wedges) = (&cells[..], 0);
    while let [code, nodes @ ..] = rest {
        let (cell, others) = nodes.split_at(if *code == 8.0 { 6 } else { 8 });
        let at = |k: usize| nagata::Vec3::from(points[cell[k] as usize]);
        if cell.len() == 6 {
            assert!((at(1) - at(0)).cross(&(at(2) - at(0))).dot(&(at(3) - at(0))) < 0.0);
            wedges += 1;
        }
        rest = others;
    }
    assert_eq!(wedges, 2);
}

/// What wedges are not for, in one line of a scene of filled meshes each.
#[test]
fn what_wedges_are_not_for_is_refused() {
    let said = |settings: &[&str]| {
        let bench = blocks("", [2, 2], 0.0);
        let (out, scene) = (bench.path("out"), bench.path("scene.toml"));
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let all: Vec<&str> = ["check", scene.to_str().unwrap()].into_iter().chain(set).collect();
        let run = common::nagata(&bench.path(""), 2, &all, out);
        (run.code, run.stdout + &run.stderr)
    };
    for (settings, told) in [
        (&["body.upper.element=\"hex8-shell\""][..], "solid-shell elements are hexahedra alone"),
        (&["body.upper.element=\"wedge6\""], "the mesh of body `upper` has hexahedra and wedges"),
        (&["body.lower.plane_strain=true"], "needs one layer of hexahedra along z: element"),
    ] {
        let (code, text) = said(settings);
        assert!(code == 2 && text.contains(told), "{settings:?}: {code}\n{text}");
    }
    let (code, text) = said(&[]);
    assert!(code == 0 && text.contains("body `lower`: hex8 and wedge6,"), "{text}");
    assert!(text.contains("body `upper`: hex8-sri and wedge6-sri,"), "{text}");
}

/// Stresses at nodes do not depend on where the body stands: what the elements around a node of a regular mesh know of a direction is
/// not left to rounding.
#[test]
fn stresses_at_nodes_do_not_depend_on_the_place() {
    let mut scene = String::from("material.m = { model = \"neo-hookean\", young = 10.0, poisson = 0.3 }\n");
    let shifts = [[0.0; 3], [-0.37, 0.2, 0.6], [3.7, 0.11, -0.29], [13.0, 7.7, 5.1]];
    let [mut fix, mut moved] = [String::new(), String::new()];
    for b in 0..shifts.len() {
        let _ = writeln!(scene, "[body.b{b}]\nmesh = \"b{b}.msh\"\nmaterial = \"m\"\nelement = \"wedge6\"");
        let _ = write!(fix, "{{ set = \"b{b}.zmin\" }}, ");
        let _ = write!(moved, "{{ target = \"b{b}.zmax\", by = [0.1, -0.1, 0.0] }}, ");
    }
    let bench = Bench::new(&format!(
        "{scene}[[step]]\nincrements = 1\nfix = [{fix}]\nmove = [{moved}]\n[output]\nfields = [\"nodal_stress\"]\n"
    ));
    for (b, [x, y, z]) in shifts.into_iter().enumerate() {
        let mesh = msh::block([3, 3, 3], false, |[r, s, t]| [0.7 * r + x, 0.9 * s + y, 1.1 * t + z]);
        bench.write(&format!("b{b}.msh"), &msh::wedges(&mesh, |_| true));
    }
    let run = bench.solve(1, &[]);
    let stress = |b: usize| run.field(&format!("increments/000001/body_b{b}/node/nodal_stress"));
    let first = stress(0);
    for b in 1..shifts.len() {
        let off = first.iter().zip(&stress(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert_small("stresses", off, 1e-9);
    }
}
