//! Meshes of tools and masters that are coarse, fine, or broken.

use crate::case::Case;
use crate::oracle::{balance, near, value};
use crate::scenes::{BAR, METHODS, SLAB, STACK, bar_force, plate, stack_force};

family!(quarter_circle, finer_and_coarser, broken_facets, broken_blocks);

/// A roller of radius 2 of 1, 2, 3 and 8 facets a quarter circle, on the slab.
fn quarter_circle() -> Vec<Case> {
    let roller = |n: usize| {
        crate::common::msh::surface(2 * n, |s, t| {
            let angle = std::f64::consts::PI * (s - 0.5);
            [2.0 + 2.0 * angle.sin(), 6.0 * t - 1.0, 4.0 - 2.0 * angle.cos()]
        })
    };
    let scene = SLAB
        .replace(
            "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
            "mesh = \"roller.msh\"\nfeature_angle = 100.0\nflip = true",
        )
        .replace("elements = [4, 4, 2]", "elements = [16, 2, 4]");
    let exact = SLAB
        .replace(
            "plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }",
            "cylinder = { point = [2.0, 0.0, 4.0], axis = [0.0, 1.0, 0.0], radius = 2.0 }",
        )
        .replace("elements = [4, 4, 2]", "elements = [16, 2, 4]");
    [(1, 0.3), (2, 0.05), (3, 0.02), (8, 2e-3), (64, 1e-3)]
        .map(|(n, tolerance)| {
            Case::text(format!("{n} facets"), scene.as_str())
                .file("roller.msh", roller(n))
                .oracle(balance(&["t", "b.zmin"], 1e-8))
                .oracle(crate::oracle::same("t.fz", Case::text("exact", exact.as_str()), tolerance, "a cylinder"))
        })
        .into()
}

/// Masters 100 times finer and coarser than the slave, flat: an even pressure is the answer.
fn finer_and_coarser() -> Vec<Case> {
    let mut cases = Vec::new();
    let bar = BAR.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", "mesh = \"tool.msh\"");
    for n in [1, 7, 100, 400] {
        for smoothing in ["nagata", "facet"] {
            let case = Case::text(format!("a tool of {n} x {n} {smoothing}"), bar.as_str())
                .file("tool.msh", plate(n, 3.0, 2.0, false))
                .set(format!("tool.p.smoothing={smoothing}"))
                .oracle(value("p.fz", bar_force(10.0, 4.0, 0.8), 1e-6, "closed form"))
                .must_run();
            cases.push(case.quick_if(n < 400 && smoothing == "nagata"));
        }
    }
    for (lower, upper) in [
        ([1, 1, 1], [100, 1, 1]),
        ([2, 2, 1], [200, 2, 1]),
        ([100, 1, 1], [1, 1, 1]),
        ([200, 2, 1], [2, 2, 1]),
        ([1, 1, 1], [1, 1, 1]),
        ([3, 3, 1], [7, 7, 1]),
        ([2, 2, 1], [20, 20, 1]),
        ([20, 20, 1], [2, 2, 1]),
    ] {
        for discretization in ["one-pass", "two-pass"] {
            cases.push(
                Case::text(format!("{lower:?} on {upper:?}, {discretization}"), STACK)
                    .set(format!("body.lower.block.elements={lower:?}"))
                    .set(format!("body.upper.block.elements={upper:?}"))
                    .set(format!("contact.c.discretization={discretization}"))
                    // A coarse slave leaves the nodes of a fine master between its own free to bulge.
                    .oracle(value(
                        "upper.zmax.fz",
                        stack_force(100.0, 100.0, 0.3, 0.2),
                        if lower[0] < upper[0] { 0.25 } else { 1e-2 },
                        "closed form",
                    ))
                    .oracle(value("upper.zmax.fz/lower.zmin.fz", -1.0, 1e-8, "balance"))
                    .slow(),
            );
        }
    }
    cases
}

/// A plate with a facet more: of no area, twice, or turned over.
fn broken_facets() -> Vec<Case> {
    let right = bar_force(10.0, 4.0, 0.8);
    let bar = BAR.replace("plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }", "mesh = \"tool.msh\"");
    let with = |more: &[&str]| {
        let mesh = plate(3, 3.0, 2.0, false);
        let mesh = mesh.replace("$Elements\n9\n", &format!("$Elements\n{}\n", 9 + more.len()));
        mesh.replace("$EndElements", &(more.concat() + "$EndElements"))
    };
    // Nodes 1 to 4 are a row, 5 to 8 the next.
    let cases = [
        ("no area, one node twice", with(&["10 2 2 1 1 1 2 2\n"])),
        ("no area, on a line", with(&["10 2 2 1 1 1 2 3\n"])),
        ("no area, a quadrilateral on a line", with(&["10 3 2 1 1 1 2 3 4\n"])),
        ("twice", with(&["10 3 2 1 1 6 7 11 10\n"])),
        ("twice, by triangles", with(&["10 2 2 1 1 6 7 11\n", "11 2 2 1 1 6 11 10\n"])),
        ("turned over", with(&["10 3 2 1 1 10 11 7 6\n"])),
        ("a quadrilateral that crosses itself", with(&["10 3 2 1 1 1 6 2 5\n"])),
        (
            "a node far out that none uses",
            plate(3, 3.0, 2.0, false)
                .replace("$Nodes\n16\n", "$Nodes\n17\n")
                .replace("$EndNodes", "17 1e9 1e9 1e9\n$EndNodes"),
        ),
        (
            "a node of 1e300",
            plate(3, 3.0, 2.0, false)
                .replace("$Nodes\n16\n", "$Nodes\n17\n")
                .replace("$EndNodes", "17 1e300 0 0\n$EndNodes")
                .replace("$Elements\n9\n", "$Elements\n10\n")
                .replace("$EndElements", "10 2 2 1 1 4 17 8\n$EndElements"),
        ),
        ("one facet turned over", {
            let mesh = plate(3, 3.0, 2.0, false);
            let line = mesh.lines().find(|line| line.starts_with("5 3 2")).unwrap().to_string();
            let mut words: Vec<&str> = line.split(' ').collect();
            words[5..].reverse();
            mesh.replace(&line, &words.join(" "))
        }),
    ];
    cases
        .map(|(name, mesh)| {
            Case::text(name, bar.as_str()).file("tool.msh", mesh).oracle(value("p.fz", right, 1e-6, "closed form"))
        })
        .into()
}

/// Bodies with inverted, flat and doubled elements.
fn broken_blocks() -> Vec<Case> {
    let bar = BAR.replace("block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }", "mesh = \"b.msh\"");
    let block = |place: &dyn Fn([f64; 3]) -> [f64; 3]| crate::common::msh::block([2, 2, 2], false, place);
    let bent = |z: f64| {
        block(&move |[x, y, h]| if (x, y, h) == (0.5, 0.5, 0.5) { [1.0, 1.0, z] } else { [2.0 * x, 2.0 * y, 2.0 * h] })
    };
    let right = bar_force(10.0, 4.0, 0.8);
    let case = |name: &str, mesh: String| {
        let mut case = Case::text(name, bar.as_str()).file("b.msh", mesh);
        for method in &METHODS[..1] {
            case = case.set(format!("contact.c.method={method}"));
        }
        case
    };
    vec![
        // Patch test: any mesh of a bar of one material is strained alike.
        case("bent", bent(1.6)).oracle(value("p.fz", right, 1e-6, "closed form")).must_run(),
        case("bent to the edge", bent(1.9999)).oracle(value("p.fz", right, 1e-6, "closed form")),
        case("bent beyond", bent(2.2)).must_be_refused(&[]),
        case("flat", block(&|[x, y, _]| [2.0 * x, 2.0 * y, 0.0])).must_be_refused(&[]),
        case("mirrored", block(&|[x, y, z]| [2.0 - 2.0 * x, 2.0 * y, 2.0 * z])).oracle(value(
            "p.fz",
            right,
            1e-6,
            "closed form",
        )),
        case("all in one point", block(&|_| [0.0; 3])).must_be_refused(&[]),
        case("of NaN", block(&|[x, y, z]| [2.0 * x, 2.0 * y, if z > 0.9 { f64::NAN } else { 2.0 * z }]))
            .must_be_refused(&[]),
        case("of 1e300", block(&|[x, y, z]| [2.0 * x, 2.0 * y, if z > 0.9 { 1e300 } else { 2.0 * z }]))
            .oracle(near("p.fz", 0.0, 1.0, 0.0, "none")),
    ]
}
