//! STL files as the surfaces of tools: against the shapes that they are of, and broken.

mod common;

use common::stl::{Triangle, binary, cylinder, directions, rectangle, sphere, text};
use common::{Bench, assert_small};
use nagata::Vec3;
use nagata::controls::Controls;
use nagata::tool::{Described, describe};
use std::fs;

/// The surface of a tool with this file, and more keys.
fn described(data: &[u8], keys: &str) -> Result<Described, String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tool.stl"), data).unwrap();
    let scene = folder.path().join("tool.toml");
    fs::write(&scene, format!("[tool.t]\nmesh = \"tool.stl\"\n{keys}\n")).unwrap();
    let tool = nagata::scene::load_tools(&scene, &[]).unwrap().remove(0);
    describe(&tool, tool.smoothing.value, &Controls::default()).map_err(|error| error.to_string())
}

/// Largest errors of distance and normal, in radii and radians, of points 0.3 outside of a shape of radius 1.
fn errors(described: Described, points: impl Iterator<Item = (Vec3, Vec3)>) -> [f64; 2] {
    let shape = described.geometry.whole();
    points.fold([0.0; 2], |[far, turned], (x, normal)| {
        let found = shape.closest(&(x + 0.3 * normal), 1.0, None).unwrap();
        [far.max((found.gap - 0.3).abs()), turned.max(found.normal.cross(&normal).norm())]
    })
}

/// Nagata patches over the facets of a ball and a bar: twice as fine comes closer by their orders. The edges of the bar stay
/// sharp, which a point beyond one is as far from as from the circle.
#[test]
fn spheres_and_cylinders_are_smoothed() {
    let ball = |n: usize| {
        let described = described(&binary(&sphere(n, 1.0)), "").unwrap();
        assert!(described.warnings.is_empty(), "{:?}", described.warnings);
        errors(described, directions(500).map(|x| (x, x)))
    };
    let around = || directions(500).map(|x| Vec3::new(x.x, x.y, 0.0).normalize() + 0.8 * x.z * Vec3::z());
    let bar = |n: usize| {
        let described = described(text("a bar", &cylinder(n, 1.0)).as_bytes(), "group = \"a bar\"").unwrap();
        assert!(described.warnings.is_empty(), "{:?}", described.warnings);
        errors(described, around().map(|x| (x, Vec3::new(x.x, x.y, 0.0))))
    };
    for (name, coarse, fine) in [("ball", ball(3), ball(6)), ("bar", bar(16), bar(32))] {
        assert_small(&format!("{name}, coarse"), coarse[0], 2.5e-4);
        assert_small(&format!("{name}, fine"), fine[0], 2e-5);
        assert_small(&format!("{name}, normals, coarse"), coarse[1], 6e-3);
        assert_small(&format!("{name}, normals, fine"), fine[1], 9e-4);
    }
    let described = described(&binary(&cylinder(32, 1.0)), "").unwrap();
    let shape = described.geometry.whole();
    let beyond = Vec3::new(1.3, 0.0, 1.4);
    assert_small("edge", shape.closest(&beyond, 1.0, None).unwrap().gap - 0.5, 1e-6);
}

/// The flats of a punch, as CAD programs write them: each of two triangles, however long, between fillets of several. They are flat,
/// and the fillets round.
#[test]
fn flats_between_fillets_are_flat() {
    let (radius, steps) = (2.0, 4);
    let fillet = |k: usize| {
        let turn = std::f64::consts::FRAC_PI_2 * k as f64 / steps as f64;
        [5.0 + radius * turn.sin(), radius - radius * turn.cos()]
    };
    // From the left wall to the right one, mirrored.
    let mut outline: Vec<[f64; 2]> = (0..=steps).map(fillet).chain([[7.0, 9.0]]).collect();
    let left: Vec<[f64; 2]> = outline.iter().rev().map(|[x, y]| [-x, *y]).collect();
    outline.splice(0..0, left);
    let wall = |&[[ax, ay], [bx, by]]: &[[f64; 2]; 2]| {
        rectangle([[ax, ay, 0.0], [bx, by, 0.0], [bx, by, 3.0], [ax, ay, 3.0]].map(Vec3::from))
    };
    let facets: Vec<Triangle> = outline.array_windows().flat_map(wall).collect();
    let described = described(&binary(&facets), "").unwrap();
    let below = (0..40).map(|k| (Vec3::new(0.25 * f64::from(k) - 4.9, 0.0, 1.5), -Vec3::y()));
    let round = (1..20).map(|k| {
        let turn = std::f64::consts::FRAC_PI_2 * f64::from(k) / 20.0;
        let normal = Vec3::new(turn.sin(), -turn.cos(), 0.0);
        (Vec3::new(5.0, radius, 1.5) + radius * normal, normal)
    });
    let beside = (0..20).map(|k| (Vec3::new(7.0, 2.1 + 0.3 * f64::from(k), 1.5), Vec3::x()));
    let (below, round, beside): (Vec<_>, Vec<_>, Vec<_>) = (below.collect(), round.collect(), beside.collect());
    let shape = described.geometry.whole();
    // As exact as numbers of four bytes, and as arcs of a quarter of a right angle.
    for (name, points, far) in [("flat", below, 1e-6), ("fillet", round, 2e-3), ("wall", beside, 1e-6)] {
        for (x, normal) in points {
            let found = shape.closest(&(x + 0.3 * normal), 1.0, None).unwrap();
            assert_small(&format!("{name} {x}"), found.gap - 0.3, far);
        }
    }
}

/// What is not in order is named by the number of the facet, and refused or passed over.
#[test]
fn what_is_wrong_is_named() {
    let ball = sphere(2, 1.0);
    let with = |more: &[Triangle]| [&ball[..], more].concat();
    let [a, b, c] = ball[6];
    let mut turned = ball.clone();
    turned[3].swap(0, 1);
    let mut apart = ball.clone();
    apart.iter_mut().step_by(2).flatten().for_each(|x| *x += Vec3::new(5e-7, 0.0, -5e-7));
    let warned = |triangles: &[Triangle], words: &[&str]| {
        let said = described(text("", triangles).as_bytes(), "").unwrap().warnings.join("; ");
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
        assert_eq!(said.matches("; ").count() + 1, words.len(), "{said}");
    };
    warned(&ball[1..], &["facets 1, 16, 64 are at a border: the surface is not closed"]);
    warned(&turned, &["facet 4 is turned over, to agree with the others"]);
    warned(&with(&[[a, a, b]]), &["facet 81 is without area, two corners being one, and left out"]);
    warned(&apart, &["7.1e-7 apart are taken for one node"]);
    let refused = |data: Vec<u8>, what: &str| {
        let said = described(&data, "").map(|_| ()).unwrap_err();
        assert!(said.contains(what), "{said}");
    };
    refused(binary(&with(&[[a, b, c]])), "facets 7 and 81 have the same nodes");
    refused(binary(&with(&[[a, b, 2.0 * a]])), "has 3 facets");
    refused(text("", &with(&[[3.0 * a, 3.5 * a, 4.0 * a]])).into(), "facet 81 is degenerate: without area");
    refused(binary(&with(&[[a, b, Vec3::repeat(f64::NAN)]])), "facet 81 has a corner that is not at a finite place");
    let whole = binary(&ball);
    refused(whole[..whole.len() - 7].to_vec(), "a binary STL file of 80 facets has 4084 bytes, this has 4077");
    let named = [b"solid ball".as_slice(), &whole[10..whole.len() - 57]].concat();
    refused(named, "a binary STL file of 80 facets has 4084 bytes, this has 4027: it ends in facet 79");
    refused(whole[..40].to_vec(), "a binary STL file has 84 bytes or more, this has 40");
    let words = text("", &ball);
    refused(words.replacen("vertex", "vertix", 1).into(), "tool.stl:4:1: expected vertex or endfacet, found 'vertix");
    refused(words.replacen("vertex", "vertex 1", 1).into(), "expected 3 coordinates");
    refused(words.replacen("    endloop\n", "vertex 0 0 0\n", 1).into(), "a facet has 4 corners, not 3");
    refused(words.rsplit_once("endloop").unwrap().0.into(), "the file ends in a facet");
    refused("solid nothing\nendsolid nothing\n".into(), "the file has no facets");
}

/// A ball that presses a block: with the facets of a file about as with the exact sphere, and better on finer ones.
#[test]
fn a_ball_presses_as_its_sphere_does() {
    const SCENE: &str = r#"
[body.block]
block = { box = { origin = [-1, -1, -1], size = [2, 2, 1] }, elements = [8, 8, 4] }
material = "soft"
[material.soft]
model = "neo-hookean"
young = 100
poisson = 0.3
[tool.ball]
TOOL
[contact.top]
slave = "block.zmax"
master = "ball"
friction = 0.2
[[step]]
increments = 2
fix = [{ set = "block.zmin" }]
move = [{ target = "ball", by = [0, 0, -0.2] }]
"#;
    let force = |tool: &str, data: &[u8]| {
        let bench = Bench::new(&SCENE.replace("TOOL", tool));
        fs::write(bench.path("ball.stl"), data).unwrap();
        bench.solve(1, &[]).history().last("ball.fz")
    };
    let exact = force("sphere = { center = [0, 0, 2], radius = 2 }", &[]);
    let file = |n: usize| {
        let raised = sphere(n, 2.0).into_iter().map(|corners| corners.map(|x| x + 2.0 * Vec3::z()));
        force("mesh = \"ball.stl\"", &binary(&raised.collect::<Vec<_>>())) / exact - 1.0
    };
    assert_small("320 facets", file(4), 4e-4);
    assert_small("1280 facets", file(8), 4e-5);
}
