//! Meshes of tools and masters that are coarse, fine, or broken.

use crate::case::Case;
use crate::oracle::{balance, near, same, value};
use crate::scenes::{BAR, METHODS, SLAB, STACK, bar_force, plate, stack_force};

family!(quarter_circle, finer_and_coarser, broken_facets, broken_blocks, doubled, opposed);

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
                .oracle(same("t.fz", Case::text("exact", exact.as_str()), tolerance, "a cylinder"))
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

/// A mesh with more elements, each its kind, group and nodes.
fn with(mesh: &str, more: &[&str]) -> String {
    let (head, rest) = mesh.split_once("$Elements\n").unwrap();
    let (count, rest) = rest.split_once('\n').unwrap();
    let count: usize = count.parse().unwrap();
    let line = |(k, words): (usize, &&str)| {
        let [kind, group, nodes] = words.splitn(3, ' ').collect::<Vec<_>>()[..] else { panic!() };
        format!("{} {kind} 2 {group} {group} {nodes}\n", count + 1 + k)
    };
    let more: String = more.iter().enumerate().map(line).collect();
    let total = count + more.lines().count();
    format!("{head}$Elements\n{total}\n{}", rest.replace("$EndElements", &(more + "$EndElements")))
}

/// Elements and facets of a bar twice in its file. An element is an error, but in two groups; a facet counts once.
fn doubled() -> Vec<Case> {
    let bar = BAR.replace("block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }", "mesh = \"b.msh\"");
    let block = crate::common::msh::block([2, 2, 2], false, |p| p.map(|x| 2.0 * x));
    // Nodes 1 to 9 are below, 10 to 18 in the middle, 19 to 27 above; of groups zmax is the sixth, the solid the seventh.
    let named = |name: &str| {
        block
            .replace("$PhysicalNames\n7\n", "$PhysicalNames\n8\n")
            .replace("$EndPhysicalNames", &format!("{name}\n$EndPhysicalNames"))
    };
    let case = |name: &str, mesh: String| {
        let case = Case::text(name, bar.as_str()).file("b.msh", mesh);
        case.oracle(value("p.fz", bar_force(10.0, 4.0, 0.8), 1e-6, "closed form"))
    };
    let twice: &[&str] = &["same nodes"];
    // Loads are spread by area, which is there once.
    let loaded = |name: &str, load: &str| {
        let text = format!(
            "{}[[step]]\nname = \"press\"\nincrements = 2\n{load}\n[output]\nevery = 1000\nhistory = [\"b.zmin\", \"b.zmax\"]\n",
            bar.split_once("[tool.p]").unwrap().0
        );
        let once = Case::text("once", text.as_str()).file("b.msh", block.as_str());
        Case::text(name, text)
            .file("b.msh", with(&block, &["3 6 19 20 23 22"]))
            .oracle(same("b.zmin.fz", once.clone(), 1e-9, "each once"))
            .oracle(same("b.zmax.uz", once, 1e-9, "each once"))
    };
    let pressure = "pressure = [{ set = \"b.zmax\", value = 1.0 }]";
    let force = "force = [{ target = \"b.zmax\", total = [0.0, 0.0, -4.0] }]";
    vec![
        case("an element", with(&block, &["5 7 1 2 5 4 10 11 14 13"])).must_be_refused(twice),
        case("an element, listed otherwise", with(&block, &["5 7 2 5 4 1 11 14 13 10"])).must_be_refused(twice),
        case("an element, turned inside out", with(&block, &["5 7 10 11 14 13 1 2 5 4"])).must_be_refused(&[]),
        case("an element, as two wedges", with(&block, &["6 7 1 2 5 10 11 14", "6 7 1 5 4 10 14 13"]))
            .must_be_refused(&[]),
        case("an element in two groups", with(&named("3 8 \"more\""), &["5 8 1 2 5 4 10 11 14 13"])).must_run(),
        case("a facet", with(&block, &["3 6 19 20 23 22"])),
        case("a facet, turned over", with(&block, &["3 6 22 23 20 19"])),
        case("a facet, as two triangles", with(&block, &["2 6 19 20 23", "2 6 19 23 22"])),
        case("a facet in two groups", with(&named("2 8 \"more\""), &["3 8 19 20 23 22"])).must_run(),
        case("a facet in two groups, turned over", with(&named("2 8 \"more\""), &["3 8 22 23 20 19"])).must_run(),
        case("all facets", with(&block, &["3 6 19 20 23 22", "3 6 20 21 24 23", "3 6 22 23 26 25", "3 6 23 24 27 26"])),
        loaded("a facet under a pressure", pressure),
        loaded("a facet under a force", force),
        case("a facet inside", with(&block, &["3 6 10 11 14 13"])),
    ]
}

/// Two bars of one file that have the nodes between them in common, each of its own group of elements: with facets there that
/// look at each other, or only one way, in one group or two.
fn opposed() -> Vec<Case> {
    let block = crate::common::msh::block([2, 2, 4], false, |[x, y, z]| [2.0 * x, 2.0 * y, 4.0 * z]);
    // The upper half of the solid is a group of its own.
    let (mut bricks, mut parts) = (0, String::new());
    for line in block.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        if words.len() == 13 {
            bricks += 1;
            let group = if bricks > 8 { "8" } else { "7" };
            parts += &format!("{} 5 2 {group} {group} {}\n", words[0], words[5..].join(" "));
        } else {
            parts += &format!("{line}\n");
        }
    }
    let names = "3 8 \"upper\"\n2 9 \"up\"\n2 10 \"down\"\n2 11 \"both\"\n$EndPhysicalNames";
    let parts = parts
        .replace("$PhysicalNames\n7\n", "$PhysicalNames\n11\n")
        .replace("\"solid\"", "\"lower\"")
        .replace("$EndPhysicalNames", names);
    let facets = |group: usize, is_up: bool| {
        [[19, 20, 23, 22], [20, 21, 24, 23], [22, 23, 26, 25], [23, 24, 27, 26]].map(|mut nodes: [usize; 4]| {
            if !is_up {
                nodes.reverse();
            }
            format!("3 {group} {}", nodes.map(|node| node.to_string()).join(" "))
        })
    };
    let scene = |slave: &str, master: &str| {
        STACK
            .replace(
                "block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }",
                "mesh = \"b.msh\"\ngroup = \"lower\"",
            )
            .replace(
                "block = { box = { origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }",
                "mesh = \"b.msh\"\ngroup = \"upper\"",
            )
            .replace("slave = \"lower.zmax\"", &format!("slave = \"lower.{slave}\""))
            .replace("master = \"upper.zmin\"", &format!("master = \"upper.{master}\""))
    };
    let mut cases = Vec::new();
    for discretization in ["one-pass", "two-pass", "node-to-node", "segment"] {
        let mut add = |name: &str, groups: [&str; 2], more: Vec<String>| {
            let more: Vec<&str> = more.iter().map(String::as_str).collect();
            let case = Case::text(format!("{name}, {discretization}"), scene(groups[0], groups[1]))
                .file("b.msh", with(&parts, &more))
                .set(format!("contact.c.discretization={discretization}"))
                .oracle(value("upper.zmax.fz", stack_force(100.0, 100.0, 0.3, 0.2), 1e-6, "closed form"))
                .oracle(value("lower.zmin.fz", -stack_force(100.0, 100.0, 0.3, 0.2), 1e-6, "closed form"));
            cases.push(case.quick_if(discretization == "one-pass"));
        };
        add("two groups", ["up", "down"], [facets(9, true), facets(10, false)].concat());
        add("two groups that look the wrong way", ["up", "down"], [facets(9, false), facets(10, true)].concat());
        add("one group that looks up", ["both", "both"], facets(11, true).into());
        add("one group that looks both ways", ["both", "both"], [facets(11, true), facets(11, false)].concat());
        add("one group that looks up twice", ["both", "both"], [facets(11, true), facets(11, true)].concat());
    }
    cases
}
