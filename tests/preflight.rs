//! What is refused, or warned about, before the first increment; and what is not.

mod common;

use common::{Bench, assert_close, deck, msh, nagata};

/// A block on its bottom under a plate that touches it, 2 by 2 by 1.
const BLOCK: &str = r#"
[body.block]
material = "soft"
block = { box = { size = [2.0, 2.0, 1.0] }, elements = [2, 2, 1], faces = { top = "zmax", bottom = "zmin" } }
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.plate]
plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }
[contact.top]
slave = "block.top"
master = "plate"
friction = 0.3
[[step]]
name = "press"
increments = 2
fix = [{ set = "block.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.1] }]
"#;

const PLATE: &str = "plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }";
const FIX: &str = "fix = [{ set = \"block.bottom\" }]";

/// The block with some words exchanged.
fn block(changes: &[(&str, &str)]) -> Bench {
    let exchange = |scene: String, (from, to): &(&str, &str)| {
        assert!(scene.contains(from), "{from}");
        scene.replace(from, to)
    };
    Bench::new(&changes.iter().fold(BLOCK.to_string(), exchange))
}

/// What `check` says: its exit code, and all its words.
fn verdict(bench: &Bench, ranks: usize) -> (i32, String) {
    let run = nagata(&bench.path(""), ranks, &["check", "scene.toml"], bench.path("out"));
    (run.code, run.stdout + &run.stderr)
}

#[track_caller]
fn refused(bench: &Bench, words: &[&str]) {
    let (code, text) = verdict(bench, 2);
    assert_eq!(code, 2, "{text}");
    words.iter().for_each(|words| assert!(text.contains(words), "{words}\n{text}"));
    assert_eq!(text.matches("error: ").count(), 1, "{text}");
}

#[track_caller]
fn warned(bench: &Bench, words: &[&str]) {
    let (code, text) = verdict(bench, 2);
    assert_eq!(code, 0, "{text}");
    words.iter().for_each(|words| assert!(text.contains(words), "{words}\n{text}"));
    assert!(text.contains("warning: "), "{text}");
}

/// Nothing to say against it; `words` stand in what is said.
#[track_caller]
fn accepted(bench: &Bench, words: &str) {
    let (code, text) = verdict(bench, 2);
    assert!(code == 0 && !text.contains("warning") && text.contains(words), "{code}: {text}");
}

/// Anything would be in equilibrium.
#[test]
fn a_floor_of_forces_above_all_that_act_is_refused() {
    let with = |floor: &str| block(&[("[[step]]", &format!("[solver]\nforce_floor = {floor}\n[[step]]"))]);
    refused(&with("1e12"), &["`force_floor` = 1.0e12 lets residuals of 1.0e2 through", "help: leave it out"]);
    assert_eq!(verdict(&with("1e-3"), 1).0, 0);
}

#[test]
fn gaps_are_told_however_wide() {
    let at = |z: &str| block(&[("1.0], normal", &format!("{z}], normal"))]);
    accepted(&at("1.0"), "contact `top` begins with 9 nodes that touch");
    accepted(&at("1.25"), "contact `top` begins with a gap of 2.500e-1");
    accepted(&at("9.0"), "contact `top` begins with a gap of 8.000e0");
    accepted(&at("0.95"), "contact `top` begins with 9 nodes inside, up to 5.000e-2 deep");
    warned(&at("0.7"), &["contact `top`: 9 nodes start inside the tool `plate`, up to 3.000e-1 deep"]);
    let deep = block(&[("1.0], normal", "0.5], normal"), ("friction = 0.3", "friction = 0.3\nreach = 0.4")]);
    refused(
        &deep,
        &[
            "scene.toml:11:10",
            "begins 5.000e-1 inside the tool `plate`, out of its reach of 4.000e-1",
            "with a larger `reach`, or without one",
        ],
    );
    // The run says the same.
    assert!(at("1.25").solve(2, &["--steps", "1"]).log().contains("contact `top` begins with a gap of 2.500e-1"));
}

#[test]
fn the_number_of_ranks_does_not_matter() {
    for changes in [&[("1.0], normal", "5.0], normal")][..], &[("-1.0] }\n[contact", "1.0] }\n[contact")], &[(FIX, "")]]
    {
        let bench = block(changes);
        let of = |ranks: usize| {
            let (code, text) = verdict(&bench, ranks);
            let text = text.replace(&format!("{ranks} ranks"), "1 rank");
            let costs = ["set up with ", "memory: ", "time: "];
            let of_all =
                text.lines().filter(|line| !costs.iter().any(|cost| line.starts_with(cost))).map(str::to_string);
            (code, of_all.collect::<Vec<_>>())
        };
        let alone = of(1);
        [2, 3, 7].iter().for_each(|&ranks| assert_eq!(of(ranks), alone, "{ranks} ranks"));
    }
}

#[test]
fn tools_that_look_away() {
    let tool = |tool: &str| {
        let bench = block(&[(PLATE, tool)]);
        for (name, up) in [("up.msh", true), ("down.msh", false)] {
            let (a, b) = if up { (4.0, 0.0) } else { (0.0, 4.0) };
            let sheet = |height: f64| move |s: f64, t: f64| [a * s + b * t - 1.0, b * s + a * t - 1.0, height];
            bench.write(name, &msh::surface(3, sheet(1.0)));
            bench.write(&format!("far-{name}"), &msh::surface(3, sheet(31.0)));
            bench.write(&format!("in-{name}"), &msh::surface(3, sheet(-8.0)));
        }
        bench
    };
    let away = ["scene.toml:13:10: contact `top`: the tool `plate` looks away from `block.top`", "set `flip`"];
    for plane in ["1.0", "31.0", "0.999"] {
        refused(&tool(&format!("plane = {{ point = [0, 0, {plane}], normal = [0.0, 0.0, 1.0] }}")), &away);
    }
    for file in ["up.msh", "far-up.msh"] {
        refused(&tool(&format!("mesh = \"{file}\"")), &away);
        accepted(&tool(&format!("mesh = \"{file}\"\nflip = true")), "begins with");
        accepted(&tool(&format!("mesh = \"{}\"", file.replace("up", "down"))), "begins with");
    }
    // What is below the block and looks down has the block deep inside; what looks up never meets the top.
    refused(&tool("mesh = \"in-down.msh\""), &["inside the tool `plate`, out of its reach"]);
    warned(&tool("mesh = \"in-up.msh\""), &["no slave node faces the master"]);
    // Round and closed ones, from outside and from inside.
    let sphere = |more: &str| format!("sphere = {{ center = [1.0, 1.0, 4.0], radius = 3.0{more} }}");
    accepted(&tool(&sphere("")), "1 nodes that touch");
    refused(&tool(&sphere(", hollow = true")), &away);
    let bore = "sphere = { center = [1.0, 1.0, -2.0], radius = 3.4, hollow = true }";
    accepted(&tool(bore), "begins with a gap of ");
    // Beside the block, where the faces that are near stand across its own; and all around it.
    for (corner, size, flip) in [([2.5, 0.0, 0.5], [1.0, 2.0, 1.0], false), ([-1.0; 3], [4.0; 3], true)] {
        let with = |flip: bool| {
            let bench = block(&[(PLATE, &format!("mesh = \"box.msh\"\nsmoothing = \"facet\"\nflip = {flip}"))]);
            let place = |x: [f64; 3]| std::array::from_fn(|d| corner[d] + size[d] * x[d]);
            bench.write("box.msh", &msh::block([2, 2, 2], false, place));
            bench
        };
        let (code, text) = verdict(&with(flip), 1);
        assert!(code == 0 && text.contains("begins with a gap of "), "{text}");
        refused(&with(!flip), &["contact `top`: all of `block.top` is behind the tool `plate`, a closed surface"]);
    }
}

/// All faces of the block are slave, and the tool is above it, or around it.
#[test]
fn slaves_that_wrap_around() {
    let all = "faces = { skin = [\"xmin\", \"xmax\", \"ymin\", \"ymax\", \"zmin\", \"zmax\"], top = \"zmax\", bottom = \"zmin\" }";
    let skin = |tool: &str| {
        block(&[
            ("faces = { top = \"zmax\", bottom = \"zmin\" }", all),
            ("slave = \"block.top\"", "slave = \"block.skin\""),
            (PLATE, tool),
        ])
    };
    accepted(&skin("plane = { point = [0.0, 0.0, 1.2], normal = [0.0, 0.0, -1.0] }"), "a gap of 2.000e-1");
    accepted(&skin("sphere = { center = [1.0, 1.0, 0.5], radius = 3.0, hollow = true }"), "a gap of ");
    refused(&skin("plane = { point = [0.0, 0.0, 1.2], normal = [0.0, 0.0, 1.0] }"), &["looks away"]);
    refused(&skin("sphere = { center = [1.0, 1.0, 0.5], radius = 3.0 }"), &["looks away"]);
}

#[test]
fn held_slave_nodes() {
    let inside = ["scene.toml:16:8: step `press`: node ", "inside the tool `plate`", "no force would act on it"];
    refused(&block(&[(FIX, "fix = [{ set = \"block.bottom\" }, { set = \"block.top\" }]")]), &inside);
    refused(&block(&[(FIX, "fix = [{ set = \"block.bottom\" }, { set = \"block.xmin\" }]")]), &inside);
    let pushed = "move = [{ target = \"block.top\", by = [0.0, 0.0, 0.1] }]";
    refused(&block(&[("move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]", pushed)]), &inside);
    // In the gap they may be held, and moved along the tool; a symmetry plane leaves them free.
    let side = "fix = [{ set = \"block.bottom\" }, { set = \"block.xmin\" }]";
    accepted(&block(&[(FIX, side), ("1.0], normal", "1.11], normal")]), "a gap");
    accepted(
        &block(&[(FIX, "fix = [{ set = \"block.bottom\" }, { set = \"block.xmin\", directions = \"xy\" }]")]),
        "touch",
    );
    let along = "move = [{ target = \"block.top\", by = [0.1, 0.0, 0.0] }]";
    accepted(&block(&[("move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]", along)]), "touch");
    // A node of a symmetry plane gives way before the axis of the tool comes to where it was.
    let sphere = "sphere = { center = [0.0, 1.0, 1.4], radius = 0.4 }";
    let down = "move = [{ target = \"plate\", by = [0.0, 0.0, -0.8] }]";
    let half = "fix = [{ set = \"block.bottom\" }, { set = \"block.xmin\", directions = \"x\" }]";
    accepted(
        &block(&[(FIX, half), (PLATE, sphere), ("move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]", down)]),
        "touch",
    );
    // Later steps count, with where earlier ones have brought them.
    let twice = |by: &str| {
        let step = format!(
            "[[step]]\nname = \"more\"\nincrements = 1\n{side}\nmove = [{{ target = \"plate\", by = [0.0, 0.0, {by}] }}]"
        );
        let bench = block(&[(FIX, side), ("1.0], normal", "1.15], normal")]);
        bench.write("scene.toml", &(std::fs::read_to_string(bench.path("scene.toml")).unwrap() + &step));
        bench
    };
    accepted(&twice("-0.04"), "a gap");
    refused(&twice("-0.07"), &["step `more`: node ", "comes to be 2.000e-2 inside"]);
}

#[test]
fn bodies_that_nothing_holds() {
    let free = "body `block` can move along x and y, and turn about z through (1.0000, 1.0000, 0.0000)";
    let smooth =
        [(FIX, "fix = [{ set = \"block.bottom\", directions = \"z\" }]"), ("friction = 0.3", "friction = 0.0")];
    refused(
        &block(&smooth),
        &["scene.toml:16:8: step `press`: ", free, "no support and no contact could hold that", "friction"],
    );
    accepted(&block(&smooth[..1]), "touch");
    // A node off the axis keeps it from turning.
    let pin = "fix = [{ set = \"block.bottom\", directions = \"z\" }, { set = \"block.xmin\", directions = \"x\" }, { set = \"block.ymin\", directions = \"y\" }]";
    accepted(&block(&[(FIX, pin), smooth[1]]), "touch");
    // A later step that does not repeat what holds.
    let second = "[[step]]\nname = \"slide\"\nincrements = 1\nmove = [{ target = \"plate\", by = [0.1, 0.0, 0.0] }]";
    let forgotten = block(&[smooth[1]]);
    forgotten.write("scene.toml", &(BLOCK.replace("friction = 0.3", "friction = 0.0") + second));
    refused(&forgotten, &["scene.toml:21:8: step `slide`: ", "along x and y", "repeat the `fix` of the step before"]);
    // With friction the plate could draw it along, but nothing presses it against the plate.
    forgotten.write("scene.toml", &(BLOCK.to_string() + second));
    refused(&forgotten, &["scene.toml:21:8: step `slide`: nothing presses body `block` against what touches it"]);
}

#[test]
fn bodies_that_begin_apart() {
    let push = (
        "move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]",
        "force = [{ target = \"block.bottom\", total = [0.0, 0.0, 1.0] }]",
    );
    let at = |z: &str| block(&[(FIX, ""), push, ("1.0], normal", &format!("{z}], normal"))]);
    accepted(&at("1.00001"), "gap");
    let apart = [
        "what touches at the start does not hold that",
        "`top` begins with a gap of 1.000e-3",
        "a load acts",
        "let the meshes touch",
    ];
    refused(&at("1.001"), &apart);
    // A tool that comes in the first increment holds it; later is too late.
    let moved = |by: &str| {
        block(&[
            (
                FIX,
                "fix = [{ set = \"block.xmin\", directions = \"xy\" }]\nforce = [{ target = \"block.bottom\", total = [0.0, 0.0, 1.0] }]",
            ),
            ("-0.1] }]", &format!("{by}] }}]")),
            ("1.0], normal", "1.01], normal"),
        ])
    };
    accepted(&moved("-0.04"), "gap");
    refused(&moved("-0.01"), &["along z", "what touches at the start does not hold that"]);
    // A tool that a force drives may begin apart.
    let driven = "force = [{ target = \"plate\", total = [0.0, 0.0, -9.0], directions = \"z\" }]";
    accepted(
        &block(&[("1.0], normal", "1.2], normal"), ("move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]", driven)]),
        "gap",
    );
    let nowhere = driven.replace("[0.0, 0.0, -9.0], directions = \"z\"", "[9.0, 0.0, 0.0], directions = \"x\"");
    let smooth = ("friction = 0.3", "friction = 0.0");
    let sideways = block(&[smooth, ("move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]", &nowhere)]);
    refused(&sideways, &["tool `plate` can move along x", "only where it can meet a body"]);
}

#[test]
fn a_slave_far_coarser_than_its_master() {
    let on = |elements: &str, young: &str, how: &str| {
        Bench::new(&format!(
            r#"
[body.low]
material = "soft"
block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [1, 1, 1] }}
[body.high]
material = "other"
block = {{ box = {{ origin = [0.0, 0.0, 1.0], size = [2.0, 2.0, 1.0] }}, elements = [{elements}, 1] }}
[material.soft]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[material.other]
model = "neo-hookean"
young = {young}
poisson = 0.3
[contact.c]
slave = "low.zmax"
master = "high.zmin"
{how}
[[step]]
increments = 1
fix = [{{ set = "low.zmin" }}]
move = [{{ target = "high.zmax", by = [0.0, 0.0, -0.1] }}]
"#
        ))
    };
    refused(
        &on("6, 6", "100.0", ""),
        &[
            "scene.toml:",
            "contact `c`: the facets of `low.zmax`, 2.0000e0 long, are too coarse for those of its master `high.zmin`, 3.3333e-1 long",
        ],
    );
    warned(&on("4, 4", "100.0", ""), &["`low.zmax` has the coarser mesh"]);
    accepted(&on("6, 6", "1e6", ""), "4 nodes that touch");
    accepted(&on("6, 6", "100.0", "discretization = \"two-pass\""), "nodes that touch");
}

/// Two cubes of one deck with the groups `low` and `high`, which share the nodes between them or have their own.
fn two_cubes(shared: bool, more: &str) -> Bench {
    let cube = |id: usize, at: usize, first: usize, second: usize| {
        let layer = |from: usize| (0..4).map(|k| (from + k).to_string()).collect::<Vec<_>>().join(", ");
        format!("*ELEMENT, TYPE=C3D8, ELSET={}\n{id}, {}, {}\n", ["low", "high"][at], layer(first), layer(second))
    };
    let nodes = |from: usize, z: f64| {
        [[0, 0], [1, 0], [1, 1], [0, 1]]
            .iter()
            .enumerate()
            .map(|(k, [x, y])| format!("{}, {x}, {y}, {z:?}\n", from + k))
            .collect::<String>()
    };
    let upper = if shared { 5 } else { 15 };
    let twins = if shared { String::new() } else { nodes(15, 1.0) };
    let deck = format!(
        "*NODE\n{}{}{twins}{}{}{}*SURFACE, NAME=base\n1, S1\n*SURFACE, NAME=lid\n1, S2\n*SURFACE, NAME=sole\n2, S1\n*SURFACE, NAME=cap\n2, S2\n",
        nodes(1, 0.0),
        nodes(5, 1.0),
        nodes(25, 2.0),
        cube(1, 0, 1, 5),
        cube(2, 1, upper, 25)
    );
    let bench = Bench::new(&format!(
        "[body.a]\nmaterial = \"soft\"\nmesh = \"two.inp\"\ngroup = \"low\"\n[body.b]\nmaterial = \"soft\"\nmesh = \"two.inp\"\ngroup = \"high\"\n\
         [material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{more}\n\
         [[step]]\nincrements = 1\nfix = [{{ set = \"a.base\" }}, {{ set = \"b.cap\" }}]\n"
    ));
    bench.write("two.inp", &deck);
    bench
}

#[test]
fn bodies_with_places_in_common() {
    let contact = "[contact.c]\nslave = \"b.sole\"\nmaster = \"a.lid\"\nfriction = 0.3";
    accepted(&two_cubes(true, ""), "bodies `a` and `b` are one solid at 1 faces, whose nodes they share");
    accepted(&two_cubes(true, contact), "4 nodes that touch");
    warned(
        &two_cubes(false, ""),
        &["bodies `a` and `b` lie on each other with 1 faces", "neither contact nor tie is between them"],
    );
    accepted(&two_cubes(false, contact), "4 nodes that touch");
    // Tetrahedra on a hexahedron, whose face is none of theirs.
    let unlike = Bench::new(
        "[body.a]\nmaterial = \"soft\"\nmesh = \"two.inp\"\ngroup = \"low\"\n[body.b]\nmaterial = \"soft\"\nmesh = \"two.inp\"\n\
         group = \"high\"\n[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
         [[step]]\nincrements = 1\nfix = [{ set = \"a\" }, { set = \"b\" }]\n",
    );
    unlike.write(
        "two.inp",
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n9, 0.5, 0.5, 2\n\
         *ELEMENT, TYPE=C3D8, ELSET=low\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=C3D4, ELSET=high\n2, 5, 6, 7, 9\n3, 5, 7, 8, 9\n",
    );
    warned(
        &unlike,
        &["bodies `a` and `b` share the nodes of 1 faces of `a` that are no faces of `b`: they come apart there"],
    );
    let forgotten = two_cubes(true, "");
    let scene = std::fs::read_to_string(forgotten.path("scene.toml")).unwrap();
    forgotten.write("scene.toml", &scene.replace("group = \"low\"\n", "").replace("group = \"high\"\n", ""));
    refused(&forgotten, &["elements 1, 2 are in body `a` and in body `b`, at one place", "its own `group`"]);
    // One more block at the place of another may be a specimen to compare with.
    let twin = BLOCK.replace("[material.soft]", "[body.twin]\nmaterial = \"soft\"\nblock = { box = { size = [2.0, 2.0, 1.0] }, elements = [2, 2, 1] }\n[material.soft]");
    let twin = Bench::new(&twin.replace(FIX, "fix = [{ set = \"block.bottom\" }, { set = \"twin.zmin\" }]"));
    warned(&twin, &["at one place: they do not know of each other"]);
}

/// Bodies that lie on each other or are in each other need not have a node in common.
#[test]
fn bodies_with_nothing_between_them() {
    let pair = |z: f64, size: f64, elements: usize, more: &str| {
        Bench::new(&format!(
            "[body.low]\nmaterial = \"m\"\nblock = {{ box = {{ size = [3.0, 3.0, 1.0] }}, elements = [1, 1, 1] }}\n\
             [body.high]\nmaterial = \"m\"\n\
             block = {{ box = {{ origin = [0.2, 0.2, {z:?}], size = [{size:?}, {size:?}, 1.0] }}, elements = [{elements}, {elements}, 1] }}\n\
             [material.m]\nmodel = \"hooke\"\nyoung = 100.0\npoisson = 0.3\n{more}\n\
             [[step]]\nincrements = 1\nfix = [{{ set = \"low.zmin\" }}, {{ set = \"high.zmax\" }}]\n"
        ))
    };
    let told =
        ["bodies `low` and `high` touch or are in each other, such as at (", "neither contact nor tie is between them"];
    // A narrow one, whose faces are in that of the other; a wide one, in whose face the other's are; one that is within.
    for (z, size, elements) in [(1.0, 0.3, 2), (1.0, 9.0, 3), (0.5, 1.0, 3), (0.9, 9.0, 1)] {
        warned(&pair(z, size, elements, ""), &told);
    }
    accepted(&pair(1.01, 1.0, 3, ""), "0 contacts");
    let contact = "[contact.c]\nslave = \"high.zmin\"\nmaster = \"low.zmax\"";
    accepted(&pair(1.0, 1.0, 3, contact), "touch");
    accepted(&pair(1.0, 1.0, 3, &contact.replace("contact", "tie")), "tie `c`");
}

#[test]
fn elements_that_do_not_suit_their_material() {
    let element = |material: &str, element: &str| {
        block(&[
            ("model = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3", material),
            ("[material.soft]", &format!("{element}\n[material.soft]")),
        ])
    };
    let (rubber, firm) =
        ("model = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.499", "model = \"hooke\"\nyoung = 100.0\npoisson = 0.45");
    let metal = "model = \"j2\"\nyoung = 100.0\npoisson = 0.3\nyield_stress = 1.0";
    for (material, default) in [(rubber, "hex8-fbar"), (firm, "hex8"), (metal, "hex8-sri")] {
        accepted(&element(material, ""), &format!("body `block`: {default},"));
    }
    for (material, why) in [(rubber, "with Poisson's ratio above 0.45"), (metal, "that flows plastically")] {
        warned(&element(material, "element = \"hex8\""), &["body `block`: `hex8` is too stiff for a material", why]);
        accepted(&element(material, "element = \"hex8-eas\""), "body `block`: hex8-eas,");
    }
    let auxetic = |nu: &str| format!("model = \"hooke\"\nyoung = 100.0\npoisson = {nu}");
    let buckles =
        ["scene.toml:", "body `block`: elements with enhanced strain buckle in a material with Poisson's ratio -0.95"];
    refused(&element(&auxetic("-0.95"), "element = \"hex8-eas\""), &buckles);
    accepted(&element(&auxetic("-0.89"), "element = \"hex8-eas\""), "body `block`: hex8-eas,");
    accepted(&element(&auxetic("-0.95"), ""), "body `block`: hex8,");
    let tets = block(&[
        ("model = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3", rubber),
        (
            "block = { box = { size = [2.0, 2.0, 1.0] }, elements = [2, 2, 1], faces = { top = \"zmax\", bottom = \"zmin\" } }",
            "mesh = \"tet.inp\"",
        ),
    ]);
    tets.write("tet.inp", "*NODE\n1,0,0,0\n2,2,0,0\n3,0,2,0\n4,0,0,1\n5,2,0,1\n6,0,2,1\n*ELEMENT, TYPE=C3D4, ELSET=all\n1,1,2,3,4\n2,2,3,4,6\n3,2,4,5,6\n*SURFACE, NAME=bottom\n1, S1\n*SURFACE, NAME=top\n3, S3\n");
    warned(&tets, &["tetrahedra are too stiff for a material with Poisson's ratio above 0.45"]);
}

#[test]
fn mixed_units_and_far_origins() {
    warned(
        &block(&[("1.0], normal", "1000.0], normal")]),
        &["contact `top`: the master is 9.990e2 away", "one unit of length"],
    );
    warned(
        &block(&[
            ("-0.1] }]", "-5000.0] }]"),
            ("[0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0]", "[0.0, 0.0, -9.0], normal = [0.0, 0.0, 1.0]"),
        ]),
        &["moves `plate` by 5.000e3"],
    );
    let metal = "model = \"j2\"\nyield_stress = 2e8";
    warned(
        &block(&[("model = \"neo-hookean\"", metal)]),
        &["material `soft` yields at a strain of 2.0e6", "in one unit"],
    );
    let away = |x: &str| {
        let origin = format!("origin = [{x}, 0.0, 0.0], size = [2.0, 2.0, 1.0]");
        block(&[("size = [2.0, 2.0, 1.0]", &origin)])
    };
    accepted(&away("2e3"), "touch");
    warned(&away("9e3"), &["body `block` is 9.002e3 from the origin", "strains below"]);
    refused(&away("1e8"), &["scene.toml:2:7: body `block` is 1.000e8 from the origin, 1.0e8 times its shortest edge"]);
    let ball = |radius: f64| {
        block(&[(PLATE, &format!("sphere = {{ center = [1.0, 1.0, {:?}], radius = {radius:?} }}", 1.0 + radius))])
    };
    accepted(&ball(5e4), "touch");
    let said = "tool `plate` is 2.000e5 from the origin, in size, or on its way, 2.0e5 times the shortest edge of body `block` (1.000e0)";
    warned(&ball(2e5), &[said, "gaps below 4e-6 are lost"]);
    refused(
        &ball(5e6),
        &["scene.toml:9:7: tool `plate` is 5.000e6 from the origin", "what is nearly flat may be a `plane`"],
    );
    let comes = "[[step]]\nincrements = 1\nfix = [{ set = \"block.bottom\" }]\nmove = [{ target = \"plate\", by = [-1e8, 0.0, 0.0] }]\n";
    refused(&block(&[("[[step]]\n", &format!("{comes}[[step]]\n"))]), &["tool `plate` is 1.000e8 from the origin"]);
    for tool in [
        "plane = { point = [-1e9, 1e9, 1.0], normal = [0.0, 0.0, -1.0] }",
        "cylinder = { point = [1.0, 1e9, 1.5], axis = [0.0, 1.0, 0.0], radius = 0.5 }",
        "profile = { points = [[-1.0, 1.0], [3.0, 1.0]], extrude = { origin = [0.0, 1e9, 0.0], y = [0.0, 0.0, 1.0] } }",
    ] {
        accepted(&block(&[(PLATE, tool)]), "touch");
    }
}

/// A turn is a path: one increment is as many as it takes.
#[test]
fn a_full_turn_at_once() {
    let roller = "cylinder = { point = [1.0, 0.0, 2.5], axis = [0.0, 1.0, 0.0], radius = 1.5 }";
    let turn = |increments: usize| {
        let step = format!(
            "[[step]]\nname = \"turn\"\nincrements = {increments}\n{FIX}\nmove = [{{ target = \"plate\", rotate = {{ point = [1.0, 0.0, 2.4], axis = [0.0, 1.0, 0.0], angle = 360.0 }} }}]"
        );
        let bench = block(&[(PLATE, roller)]);
        bench.write("scene.toml", &(std::fs::read_to_string(bench.path("scene.toml")).unwrap() + &step));
        bench.solve(1, &[])
    };
    let (once, often) = (turn(1), turn(24));
    assert!(once.log().contains("warning: step `turn`: a tool or set turns by more than 30 degrees an increment"));
    assert_eq!((once.history().len(), often.history().len()), (14, 26));
    let [once, often] = [once, often].map(|run| run.history().last("plate.fx"));
    assert_close("force along the turn", once, often, 1e-6);
    assert!(once.abs() > 0.1, "{once}");
}

/// Vectors of any length are directions; hardening may begin at nothing; a foil has its planes of symmetry.
#[test]
fn extreme_numbers() {
    let force = |normal: &str| block(&[("normal = [0.0, 0.0, -1.0]", normal)]).solve(1, &[]).history().last("plate.fz");
    let unit = force("normal = [0.0, 0.0, -1.0]");
    assert!(unit < -1.0);
    for normal in ["normal = [0.0, 0.0, -1e155]", "normal = [0.0, 0.0, -1e-300]"] {
        assert_eq!(force(normal), unit);
    }
    let swift = |e0: &str| {
        let metal = format!(
            "model = \"j2\"\nyoung = 1000.0\npoisson = 0.3\nhardening = {{ swift = {{ k = 5.0, n = 0.2, e0 = {e0} }} }}"
        );
        let scene = [("model = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3", metal.as_str())];
        block(&scene).solve(1, &[]).history().last("plate.fz")
    };
    assert_close("Swift from nothing", swift("1e-100"), swift("1e-15"), 1e-3);
    let foil =
        BLOCK.replace("size = [2.0, 2.0, 1.0]", "size = [2.0, 2.0, 2e-6]").replace("1.0], normal", "2e-6], normal");
    let foil = foil.replace("material = \"soft\"", "material = \"soft\"\nsymmetry = [\"xmin\", \"ymin\", \"zmin\"]");
    accepted(&Bench::new(&foil), "mirrored across `block.xmin`, `block.ymin`, `block.zmin`");
}

/// Reference nodes, and elements that nobody takes.
#[test]
fn what_a_deck_has_besides() {
    let more = "*NODE\n900, 5.0, 5.0, 5.0\n901, 6.0, 5.0, 5.0\n*ELEMENT, TYPE=CONN3D2, ELSET=link\n950, 900, 901\n*ELSET, ELSET=all, GENERATE\n101, 104\n";
    let scene = |group: &str| {
        let of_mesh = format!("mesh = \"block.inp\"\n{group}");
        let bench = block(&[(
            "block = { box = { size = [2.0, 2.0, 1.0] }, elements = [2, 2, 1], faces = { top = \"zmax\", bottom = \"zmin\" } }",
            &of_mesh,
        )]);
        bench.write("block.inp", &(deck([2, 2, 1]) + more));
        bench
    };
    let words =
        ["nodes 900, 901 are not part of any element", "element 950 of type CONN3D2 left out, which is not read"];
    warned(&scene("group = \"all\""), &words);
    refused(&scene(""), &["element 950 has type CONN3D2, which is not read"]);
    refused(&scene("group = \"link\""), &["element 950 has type CONN3D2, which is not read"]);
}

/// Whatever their faces are called, and also in part; contacts that share only those of one side are left alone.
#[test]
fn a_contact_that_is_another_the_other_way_round_is_refused() {
    let scene = |faces: &str, slave: &str, master: &str| {
        Bench::new(&format!(
            r#"
body.low.block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1], faces = {{ {faces} }} }}
body.low.material = "soft"
body.high.block = {{ box = {{ origin = [0.0, 0.0, 1.0], size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1] }}
body.high.material = "soft"
material.soft = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
contact.down = {{ slave = "high.zmin", master = "low.zmax", friction = 0.2 }}
contact.up = {{ slave = "{slave}", master = "{master}", friction = 0.2 }}
[[step]]
increments = 1
fix = [{{ set = "low.zmin" }}]
move = [{{ target = "high.zmax", by = [0.0, 0.0, -0.1] }}]
"#
        ))
    };
    let words = [
        "scene.toml:8:24",
        "in common with contact `down`, the other way round: both keep them apart",
        "where both sides are to be slaves give that one discretization = \"two-pass\"",
    ];
    refused(&scene("", "low.zmax", "high.zmin"), &words);
    refused(&scene("top = \"zmax\"", "low.top", "high.zmin"), &words);
    refused(&scene("more = [\"zmax\", \"xmax\"]", "low.more", "high.zmin"), &words);
    for (slave, master) in [("low.xmax", "high.zmin"), ("low.zmax", "high.xmax")] {
        let (code, text) = verdict(&scene("", slave, master), 2);
        assert!(code == 0, "{text}");
    }
}

/// Faces that meet each other in two contacts, by whatever names.
#[test]
fn contacts_that_are_named_twice() {
    let blocks = |slave: &str, master: &str| {
        Bench::new(&format!(
            r#"
body.low.block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1], faces = {{ deck = "zmax", hull = ["zmax", "xmax"] }} }}
body.low.material = "soft"
body.high.block = {{ box = {{ origin = [0.0, 0.0, 1.0], size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1], faces = {{ sole = "zmin", skirt = ["zmin", "xmin"] }} }}
body.high.material = "soft"
material.soft = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
tool.wall = {{ plane = {{ point = [2.5, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }} }}
contact.one = {{ slave = "high.zmin", master = "low.zmax", friction = 0.2 }}
contact.two = {{ slave = "{slave}", master = "{master}" }}
contact.three = {{ slave = "low.xmax", master = "wall" }}
[[step]]
increments = 1
fix = [{{ set = "low.zmin" }}]
move = [{{ target = "high.zmax", by = [0.0, 0.0, -0.1] }}]
"#
        ))
    };
    let told = |slave: &str, master: &str, other: &str| {
        format!("has faces of `{slave}` and `{master}` in common with contact `{other}`: both keep them apart")
    };
    for (slave, master) in [("high.sole", "low.zmax"), ("high.skirt", "low.zmax"), ("high.sole", "low.hull")] {
        refused(&blocks(slave, master), &[&told(slave, master, "one"), "help: name each face in one of them"]);
    }
    refused(&blocks("low.hull", "wall"), &[&told("low.xmax", "wall", "two")]);
    for (slave, master) in [("high.xmin", "low.zmax"), ("high.sole", "low.xmax")] {
        let (code, text) = verdict(&blocks(slave, master), 2);
        assert!(code == 0, "{text}");
    }
}

/// In a plane of symmetry a tool that crosses it has a mirror image that goes the other way.
#[test]
fn conditions_that_a_mirror_turns() {
    let half = ("material = \"soft\"\nblock", "material = \"soft\"\nsymmetry = [\"xmin\"]\nblock");
    let by = "by = [0.0, 0.0, -0.1]";
    accepted(&block(&[half]), "9 nodes that touch");
    accepted(&block(&[half, (by, "by = [0.0, 0.1, -0.1]")]), "9 nodes that touch");
    warned(
        &block(&[half, (by, "by = [0.1, 0.0, -0.1]")]),
        &["step `press`: in the symmetry `block.xmin` the mirror image of"],
    );
    let turned = format!("{by}, rotate = {{ point = [0.0, 0.0, 1.0], axis = [0.0, 0.0, 1.0], angle = 5.0 }}");
    warned(&block(&[half, (by, &turned)]), &["the mirror image of tool `plate` turns the other way"]);
    let pushed = format!("{FIX}\nbody_force = [{{ body = \"block\", per_volume = [0.01, 0.0, 0.0] }}]");
    warned(&block(&[half, (FIX, &pushed)]), &["the body force of `block` has another mirror image"]);
    // The lower half of a block between two plates, whose sides may come to touch them.
    let lower = [
        ("material = \"soft\"\nblock", "material = \"soft\"\nsymmetry = [\"zmin\"]\nblock"),
        ("top = \"zmax\"", "top = [\"zmax\", \"xmax\"]"),
        (FIX, ""),
    ];
    let (code, text) = verdict(&block(&lower), 1);
    assert!(code == 0 && !text.contains("mirror image of"), "{code}\n{text}");
}

/// A plug that was pushed down a chamfer into a slot may be let go there: nothing but its walls touches it then.
#[test]
fn what_the_beginning_does_not_tell_of_later_steps() {
    let plug = Bench::new(
        r#"
body.plug = { material = "rubber", axisymmetric = true, block = { box = { size = [5.2, 6.0, 1.0] }, elements = [8, 10, 1] } }
material.rubber = { model = "neo-hookean", young = 5.0, poisson = 0.4 }
tool.slot = { profile = { points = [[15.0, 10.0], [5.0, 0.0], [5.0, -30.0]], fillets = [0.0, 1.0, 0.0] } }
contact.c = { slave = "plug.xmax", master = "slot", friction = 0.3 }
[[step]]
name = "push"
increments = 20
move = [{ target = "plug.ymax", by = [0.0, -10.0, 0.0], directions = "y" }]
[[step]]
name = "let-go"
increments = 4
"#,
    );
    warned(&plug, &["start inside"]);
    // A node in a plane of symmetry was carried along by the punch, and is not where it was meshed, which the punch is deep in by then.
    let bench = Bench::new(
        r#"
body.b = { material = "rubber", symmetry = ["xmin", "ymin"], block = { box = { size = [6.0, 6.0, 3.0] }, elements = [6, 6, 3] } }
material.rubber = { model = "neo-hookean", young = 100.0, poisson = 0.3 }
tool.p = { profile = { points = [[0.0, 3.0], [1.5, 3.0], [1.5, 9.0]], fillets = [0.0, 0.5, 0.0], revolve = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] } } }
contact.c = { slave = "b.zmax", master = "p" }
[[step]]
name = "press"
increments = 10
fix = [{ set = "b.xmax" }, { set = "b.ymax" }]
move = [{ target = "p", by = [0.0, 0.0, -2.4] }]
[[step]]
name = "retract"
increments = 5
fix = [{ set = "b.xmax" }, { set = "b.ymax" }]
move = [{ target = "p", by = [0.0, 0.0, 2.4] }]
"#,
    );
    accepted(&bench, "touch");
}

/// Unit cubes of one mesh, each with nodes of its own and the surfaces `base0`, `lid0`, and so on.
fn cubes(origins: &[[f64; 3]]) -> String {
    let (mut nodes, mut elements, mut faces) = (String::new(), String::new(), String::new());
    for (k, [x, y, z]) in origins.iter().enumerate() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let all = [0.0, 1.0].iter().flat_map(|up| corners.map(|[a, b]| [x + a, y + b, z + up]));
        for (n, [x, y, z]) in all.enumerate() {
            nodes += &format!("{}, {x:?}, {y:?}, {z:?}\n", 8 * k + n + 1);
        }
        let own: Vec<String> = (1..=8).map(|n| (8 * k + n).to_string()).collect();
        elements += &format!("{}, {}\n", k + 1, own.join(", "));
        faces += &format!("*SURFACE, NAME=base{k}\n{}, S1\n*SURFACE, NAME=lid{k}\n{}, S2\n", k + 1, k + 1);
    }
    let bases: String = (1..=origins.len()).map(|k| format!("{k}, S1\n")).collect();
    format!("*NODE\n{nodes}*ELEMENT, TYPE=C3D8\n{elements}{faces}*SURFACE, NAME=bases\n{bases}")
}

/// A body of such cubes.
fn parts(origins: &[[f64; 3]], more: &str, step: &str) -> Bench {
    let bench = Bench::new(&format!(
        "[body.b]\nmaterial = \"soft\"\nmesh = \"cubes.inp\"\n[material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\n\
         poisson = 0.3\n{more}\n[[step]]\nname = \"press\"\nincrements = 2\n{step}\n"
    ));
    bench.write("cubes.inp", &cubes(origins));
    bench
}

/// What holds one part of a body holds no other that shares no nodes with it.
#[test]
fn parts_of_a_body_that_share_no_nodes() {
    let on = |gap: f64| [[0.0; 3], [0.0, 0.0, 1.0 + gap]];
    let fix = "fix = [{ set = \"b.base0\" }]\n";
    let push = "force = [{ target = \"b.lid0\", total = [0.0, 0.0, -1.0] }]\n";
    let upper =
        "the part of body `b` with node 9 at (0.000000, 0.000000, 1.000100), which shares no nodes with the rest,";
    let free = parts(&on(1e-4), "", &(fix.to_string() + push));
    let words = [
        upper,
        "can move along x, y and z, and turn about",
        "no support and no contact",
        "merge the nodes where it should be one",
    ];
    refused(&free, &words);
    // The first part, too.
    refused(
        &parts(&on(1e-4), "", &fix.replace('0', "1")),
        &["the part of body `b` with node 1 at", "can move along x, y and z"],
    );
    // Each held by itself, by a spring, or tied to the other.
    accepted(&parts(&on(1e-4), "", "fix = [{ set = \"b.base0\" }, { set = \"b.lid1\" }]"), "b");
    let spring = "spring = [{ set = \"b.lid1\", stiffness = [1.0, 1.0, 1.0] }]\n";
    accepted(&parts(&on(1e-4), "", &(fix.to_string() + spring)), "b");
    let tie = "[tie.t]\nslave = \"b.base1\"\nmaster = \"b.lid0\"";
    accepted(&parts(&on(1e-4), tie, fix), "b");
    // Under a plate nothing presses it against that but another contact.
    let plate = |gap: f64, friction: f64| {
        format!(
            "[tool.plate]\nplane = {{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, -1.0] }}\n[contact.top]\nslave = \"b.lid1\"\n\
             master = \"plate\"\nfriction = {friction:?}\n",
            2.0 + gap
        )
    };
    let between =
        |friction: f64| format!("[contact.i]\nslave = \"b.base1\"\nmaster = \"b.lid0\"\nfriction = {friction:?}\n");
    let down = format!("{fix}move = [{{ target = \"plate\", by = [0.0, 0.0, -0.05] }}]");
    refused(&parts(&on(1e-4), &plate(1e-4, 0.3), &down), &["nothing presses ", upper, "against what touches it"]);
    refused(
        &parts(&on(1e-4), &plate(1e-4, 0.0), &down),
        &[upper, "can move along x and y", "give its contact friction"],
    );
    accepted(&parts(&on(1e-8), &(plate(1e-8, 0.3) + &between(0.3)), &down), "touch");
    accepted(&parts(&on(1e-8), &(plate(1e-8, 0.3) + &between(0.0)), &down), "touch");
    refused(
        &parts(&on(1e-8), &(plate(1e-8, 0.0) + &between(0.0)), &down),
        &["the part of body `b` with node 9", "can move along x and y"],
    );
    // What only a force drives must touch, as between bodies.
    let weight = format!("{fix}force = [{{ target = \"b.lid1\", total = [0.0, 0.0, -1.0] }}]");
    refused(
        &parts(&on(1e-2), &between(0.3), &weight),
        &["what touches at the start does not hold that", "with node 9", "let the meshes touch"],
    );
    let run = parts(&on(0.0625), &between(0.3), &format!(
        "fix = [{{ set = \"b.base0\" }}]\nmove = [{{ target = \"b.lid1\", by = [0.0, 0.0, -0.0725] }}]\n[[step]]\nincrements = 1\n{weight}"
    )).solve(2, &[]);
    assert_close("weight", run.history().last("i.fz").abs(), 1.0, 1e-8);
}

/// A part of a master that no slave node is near to at the start, but comes to hold in a later step.
#[test]
fn parts_of_a_master_that_meet_the_slave_later() {
    let punches = |friction: f64| {
        let work = format!(
            "[body.w]\nmaterial = \"soft\"\nblock = {{ box = {{ origin = [-0.5, -0.5, -1.0], size = [2.0, 2.0, 1.0] }}, elements = [4, 4, 2] }}\n\
             [contact.c]\nslave = \"w.zmax\"\nmaster = \"b.bases\"\nfriction = {friction:?}\n"
        );
        let step = |fix: &str, more: &str| format!("fix = [{{ set = \"w.zmin\" }}{fix}]\n{more}\n");
        let by = |k: usize, by: &str| format!("{{ target = \"b.lid{k}\", by = [{by}] }}");
        let next = "[[step]]\nincrements = 2\n";
        let lid = |k: usize| format!(", {{ set = \"b.lid{k}\" }}");
        let steps = [
            step(&lid(1), &format!("move = [{}]", by(0, "0.0, 0.0, -0.05"))),
            step("", &format!("move = [{}, {}]", by(0, "0.0, 0.0, 1.05"), by(1, "-3.0, 0.0, 0.0"))),
            step(&lid(0), &format!("move = [{}]", by(1, "0.0, 0.0, -0.3"))),
            step(&lid(0), "force = [{ target = \"b.lid1\", total = [0.0, 0.0, -5.0] }]"),
        ];
        parts(&[[0.0; 3], [3.0, 0.0, 0.25]], &work, &steps.join(next))
    };
    assert_close("force", punches(0.3).solve(2, &[]).history().last("c.fz").abs(), 5.0, 1e-8);
    refused(
        &punches(0.0),
        &["step `step 4`: the part of body `b` with node 9", "can move along x and y, and turn about z"],
    );
}

#[test]
fn parts_on_several_ranks() {
    let row: Vec<[f64; 3]> = (0..12).map(|k| [2.0 * f64::from(k), 0.0, 0.0]).collect();
    let held = |free: usize| {
        let sets = (0..12).filter(|k| *k != free).map(|k| format!("{{ set = \"b.base{k}\" }}"));
        format!("fix = [{}]", sets.collect::<Vec<_>>().join(", "))
    };
    for ranks in 1..=4 {
        for free in [0, 7, 11] {
            let (code, text) = verdict(&parts(&row, "", &held(free)), ranks);
            let node = format!("with node {} at ({:.6}, 0.000000, 0.000000)", 8 * free + 1, 2.0 * free as f64);
            assert!(code == 2 && text.contains(&node) && text.matches("the part of").count() == 1, "{ranks}: {text}");
        }
        let (code, text) = verdict(&parts(&row, "", &held(99)), ranks);
        assert!(code == 0 && !text.contains("warning"), "{ranks}: {text}");
    }
}

#[test]
fn tools_and_bodies_that_no_contact_names() {
    let more = |more: &str| block(&[("[[step]]", &format!("{more}\n[[step]]"))]);
    let other = PLATE.replace("1.0]", "9.0]").replacen("plane", "[tool.other]\nplane", 1);
    let told = "no contact names the tool `other`: bodies pass through it";
    warned(&more(&other), &[told]);
    assert!(more(&other).solve(1, &[]).log().contains(told));
    let aside = |more: &str| {
        format!(
            "[body.aside]\nmaterial = \"soft\"\nblock = {{ box = {{ origin = [0.0, 0.0, 3.0], size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1] }}\n{more}"
        )
    };
    let held = (FIX, "fix = [{ set = \"block.bottom\" }, { set = \"aside.zmax\" }]");
    let by = |text: &str| block(&[("[[step]]", &format!("{text}\n[[step]]")), held]);
    warned(&by(&aside("")), &["neither contact nor tie names body `aside`: tools and other bodies pass through it"]);
    accepted(&by(&aside("[contact.rest]\nslave = \"aside.zmin\"\nmaster = \"block.top\"\n")), "touch");
}

/// A set that a step keeps and lists again is free where it does not hold it: told, but where `release` says so, or the set is
/// held there by the list.
#[test]
fn what_a_step_frees_by_listing_it_again_is_told() {
    let then =
        |how: &str| Bench::new(&format!("{BLOCK}[[step]]\nname = \"then\"\nincrements = 1\nkeep = true\n{how}\n"));
    let by = "move = [{ target = \"block.bottom\", by = [0.1, 0.0, 0.0], directions =";
    let told = "step `then`: `block.bottom` was held along y, and no longer is";
    warned(&then(&format!("{by} \"xz\" }}]")), &[told, "`fix` it along y, too, or name it in `release`"]);
    let held = "fix = [{ set = \"block.bottom\", directions = \"yz\" }]";
    for how in [
        format!("{by} \"x\" }}]\n{held}"),
        format!("{by} \"xyz\" }}]"),
        format!("{by} \"xz\" }}]\nrelease = [\"block.bottom\"]"),
    ] {
        let (_, text) = verdict(&then(&how), 2);
        assert!(!text.contains("was held along"), "{text}");
    }
}

/// The same in other frames: a kept support and what takes its place count in whatever directions they have at the nodes.
#[test]
fn what_a_step_frees_in_other_frames_is_told() {
    let cylinder = "around = { axis = [0.0, 0.0, 1.0], point = [-5.0, 0.0, 0.0] }";
    let scene = |held: &str, anew: &str| {
        Bench::new(&format!(
            "[body.block]\nmaterial = \"soft\"\n\
             block = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1], faces = {{ top = \"zmax\", bottom = \"zmin\" }} }}\n\
             [material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nincrements = 1\nfix = [{{ set = \"block.top\" }}, {held}]\n\
             [[step]]\nname = \"then\"\nincrements = 1\nkeep = true\n{anew}\n"
        ))
    };
    let fix = |how: &str| format!("{{ set = \"block.bottom\"{how} }}");
    let around = |letters: &str| fix(&format!(", {cylinder}, directions = \"{letters}\""));
    let turned = "move = [{ target = \"block.bottom\", directions = \"xy\", rotate = { point = [1.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 1.0 } }]";
    let along = |normal: &str| fix(&format!(", normal = [{normal}]"));
    let corners = format!("{}, {}", along("1.0, 1.0, 0.0"), along("1.0, -1.0, 0.0"));
    let up = fix(", directions = \"z\"");
    for (held, anew, freed) in [
        (fix(""), format!("fix = [{}]", around("r")), "x and y and z"),
        (fix(""), turned.to_string(), "z"),
        (around("rtz"), format!("fix = [{}]", fix(", directions = \"xy\"")), "z of its `around`"),
        (around("rtz"), format!("fix = [{}]", around("rz")), "t of its `around`"),
        (
            format!("{corners}, {up}"),
            format!("fix = [{}, {up}]", along("1.0, 1.0, 0.0")),
            "its `normal` (0.707, -0.707, 0.000)",
        ),
    ] {
        let told = format!("step `then`: `block.bottom` was held along {freed}, and no longer is");
        warned(&scene(&held, &anew), &[&told]);
    }
    for (held, anew) in [
        (fix(""), format!("fix = [{}]", around("rtz"))),
        (around("rtz"), format!("fix = [{}]", fix(""))),
        (format!("{corners}, {up}"), format!("fix = [{}]", fix(""))),
        (fix(""), format!("{turned}\nfix = [{up}]")),
    ] {
        let (code, text) = verdict(&scene(&held, &anew), 2);
        assert!(code == 0 && !text.contains("was held along"), "{text}");
    }
}

/// What is away from an axis and around it is so where a set was meshed: told, where a step before has turned the set.
#[test]
fn cylindrical_frames_that_stay_behind_are_told() {
    let scene = |angle: f64, letters: &str, by: &str| {
        Bench::new(&format!(
            "[body.b]\nmaterial = \"m\"\nblock = {{ sector = {{ radii = [1.0, 2.0], angles = [0.0, 90.0], length = 1.0 }}, elements = [1, 2, 1] }}\n\
             [material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [[step]]\nname = \"turn\"\nincrements = 20\n\
             move = [{{ target = \"b.rmin\", rotate = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = {angle:?} }}, directions = \"xyz\" }}]\n\
             [[step]]\nname = \"then\"\nincrements = 1\nkeep = true\nrelease = [\"b.rmin\"]\n\
             fix = [{{ set = \"b.rmax\" }}]\n\
             move = [{{ target = \"b.rmin\", by = {by}, directions = \"{letters}\", around = {{ axis = [0.0, 0.0, 1.0], point = [0.0, 0.0, 0.0] }} }}]\n"
        ))
    };
    let told = "step `then`: `b.rmin` has turned by 90 degrees since it was meshed, and r and t of `around` have not";
    warned(&scene(90.0, "rtz", "[0.1, 0.0, 0.0]"), &[told]);
    for (angle, letters, by) in
        [(3.0, "rtz", "[0.1, 0.0, 0.0]"), (360.0, "rtz", "[0.1, 0.0, 0.0]"), (90.0, "z", "[0.0, 0.0, 0.1]")]
    {
        let (code, text) = verdict(&scene(angle, letters, by), 1);
        assert!(code == 0 && !text.contains("since it was meshed"), "{text}");
    }
}

/// A punch that is moved as a whole is the master.
#[test]
fn slaves_that_are_moved_as_a_whole_are_told_of() {
    let scene = |slave: &str, master: &str, punch: &str| {
        Bench::new(&format!(
            "[body.slab]\nmaterial = \"soft\"\nblock = {{ box = {{ size = [2.0, 2.0, 1.0] }}, elements = [2, 2, 1] }}\n\
             [body.punch]\nmaterial = \"soft\"\n\
             block = {{ box = {{ origin = [0.5, 0.5, 1.0], size = [1.0, 1.0, 1.0] }}, elements = [2, 2, 1] }}\n\
             [material.soft]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n\
             [contact.c]\nslave = \"{slave}\"\nmaster = \"{master}\"\n\
             [[step]]\nname = \"press\"\nincrements = 1\nfix = [{{ set = \"slab.zmin\" }}]\n\
             move = [{{ target = \"{punch}\", by = [0.0, 0.0, -0.1] }}]\n"
        ))
    };
    let told = "step `press`: all nodes of `punch.zmin`, a slave of contact `c`, are held or moved";
    warned(&scene("punch.zmin", "slab.zmax", "punch"), &[told, "make it the master, in one pass"]);
    for (slave, master, punch) in [("slab.zmax", "punch.zmin", "punch"), ("punch.zmin", "slab.zmax", "punch.zmax")] {
        let (_, text) = verdict(&scene(slave, master, punch), 2);
        assert!(!text.contains("are held or moved"), "{text}");
    }
}

/// Two cantilevers on each other, both clamped at one end: from segment to segment smoothed faces press each other apart there, and
/// it is told; on facets, and where one of them is free, there is nothing to tell.
#[test]
fn ends_at_which_both_bodies_are_held_are_told_of() {
    let beams = |how: &str, fixed: &str| {
        let beam = |name: &str, low: f64| {
            format!(
                "[body.{name}]\nblock = {{ box = {{ origin = [0.0, {low:?}, 0.0], size = [20.0, 0.5, 1.0] }}, elements = [40, 2, 1] }}\n\
                 material = \"m\"\nelement = \"hex8-eas\"\nplane_strain = true\n"
            )
        };
        Bench::new(
            &(beam("lo", -0.5)
                + &beam("up", 0.0)
                + &format!(
                    "[material.m]\nmodel = \"hooke\"\nyoung = 1e5\npoisson = 0.0\n\
                     [tool.t]\ncylinder = {{ point = [19.0, 1.5, 0.0], axis = [0, 0, 1], radius = 1.0 }}\n\
                     [contact.t]\nslave = \"up.ymax\"\nmaster = \"t\"\n\
                     [contact.c]\nslave = \"up.ymin\"\nmaster = \"lo.ymax\"\n{how}\n\
                     [[step]]\nincrements = 2\nfix = [{{ set = \"lo.xmin\" }}{fixed}]\n\
                     move = [{{ target = \"t\", by = [0.0, -0.2, 0.0] }}]\n"
                )),
        )
    };
    let (segment, both) = ("discretization = \"segment\"", ", { set = \"up.xmin\" }");
    let facets = format!("{segment}\nsmoothing = \"facet\"");
    warned(
        &beams(segment, both),
        &["`up.ymin` and of `lo.ymax`, at the end of contact `c`, are held or moved, one on the other"],
    );
    let follows = format!("{segment}\nslave_curvature = \"deformed\"");
    let free = ", { set = \"up.ymax\", directions = \"x\" }";
    for bench in [beams(&facets, both), beams(&follows, both), beams("", both), beams(segment, free)] {
        let (_, text) = verdict(&bench, 2);
        assert!(!text.contains("one on the other"), "{text}");
    }
    // Each bears half of the force.
    for how in [&facets, &follows] {
        let run = beams(how, both).solve(1, &[]);
        assert_eq!(run.log().contains("its faces curved as they are deformed"), how == &follows);
        let history = run.history();
        assert_close(how, history.last("c.fy").abs(), 0.5 * history.last("t.fy").abs(), 0.005);
    }
}

/// What is flush with the wall of a guide, its lowest nodes past the end of it, is not below the guide's top, which is the master, too:
/// the force is that of the same a rounding before the wall; of a profile within reach of the top, and of a body far from it.
#[test]
fn what_is_flush_with_a_wall_is_not_below_its_top() {
    let slider = |x: f64, low: f64, elements: &str| {
        format!(
            "[body.b]\nmaterial = \"m\"\nblock = {{ box = {{ origin = [{x:?}, 0.0, {low:?}], size = [0.5, 1.0, {:?}] }}, elements = {elements} }}\n\
             [material.m]\nmodel = \"neo-hookean\"\nyoung = 10.0\npoisson = 0.3\n",
            1.0 - low
        )
    };
    let step = |fixed: &str| {
        format!(
            "[[step]]\nincrements = 3\nfix = [{{ set = \"b.zmax\" }}{fixed}]\n\
             move = [{{ target = \"b.zmin\", by = [0.1, 0.0, 0.0], directions = \"x\" }}]\n"
        )
    };
    let profile = "[tool.g]\nprofile = { points = [[4.0, 0.0], [1.0, 0.0], [1.0, -0.3]], extrude = { origin = [0.0, 3.0, 0.0], \
                   x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0] } }\n[contact.c]\nslave = \"b.xmax\"\nmaster = \"g\"\n";
    let guide = "[body.g]\nmaterial = \"m\"\nblock = { box = { origin = [1.0, 0.0, -0.6], size = [3.0, 1.0, 0.6] }, elements = [6, 4, 2], \
                 faces = { guide = [\"xmin\", \"zmax\"] } }\n[contact.c]\nslave = \"b.xmax\"\nmaster = \"g.guide\"\n";
    for (master, low, elements, fixed, force) in
        [(profile, -0.5, "[2, 4, 6]", "", "g.fx"), (guide, -3.0, "[2, 4, 16]", ", { set = \"g.xmax\" }", "c.fx")]
    {
        let run = |x: f64| {
            let run = Bench::new(&(slider(x, low, elements) + master + &step(fixed))).solve(1, &[]);
            let warnings = run.summary()["warnings"].to_string();
            assert!(!warnings.contains("inside"), "{warnings}");
            run.history().last(force)
        };
        let before = run(0.5 - 1e-6);
        assert_close(force, run(0.5), before, 1e-3);
        assert!(before.abs() > 1e-3, "{before}");
    }
}

/// What stands exactly on an edge of a tool is behind neither of its sides, whatever rounding makes of the distance: a punch with a
/// draft, its corners over nodes, presses these from the beginning, as one that comes from a little above.
#[test]
fn what_stands_on_an_edge_is_behind_none_of_its_sides() {
    let punch = |draft: f64, above: f64| {
        let out = 4.9 * draft.to_radians().tan();
        let [low, high] = [4.1 + above, 9.0 + above];
        let bench = Bench::new(&format!(
            "[body.b]\nblock = {{ box = {{ origin = [0.1, 0.1, 0.0], size = [8.0, 4.0, 0.5] }}, elements = [16, 8, 1] }}\n\
             material = \"m\"\nplane_strain = true\n[material.m]\nmodel = \"hooke\"\nyoung = 1000.0\npoisson = 0.3\n\
             [tool.punch]\nprofile = {{ points = [[{:?}, {high:?}], [3.1, {low:?}], [5.1, {low:?}], [{:?}, {high:?}]], \
             extrude = {{ origin = [0, 0, -1], length = 3.0 }} }}\n[contact.c]\nslave = \"b.ymax\"\nmaster = \"punch\"\n\
             [[step]]\nincrements = 2\nfix = [{{ set = \"b.ymin\" }}]\n\
             move = [{{ target = \"punch\", by = [0.0, {:?}, 0.0] }}]\n",
            3.1 - out,
            5.1 + out,
            -0.1 - above
        ));
        bench.solve(1, &[]).history().last("punch.fy")
    };
    for draft in [2.0, 6.0, 10.0, 15.0, 20.0] {
        assert_close(&format!("draft {draft}"), punch(draft, 0.0), punch(draft, 1e-4), 1e-9);
    }
}

/// Of what bodies beside each other bear at a node between them each bears its own; and what bulges does so in company, too.
#[test]
fn masters_side_by_side_and_balls_in_company_are_not_warned_of() {
    let block = |name: &str, [x, y]: [f64; 2], elements: [u32; 3]| {
        format!(
            "[body.{name}]\nmaterial = \"m\"\n\
             block = {{ box = {{ origin = [{x:?}, {y:?}, 0.0], size = [1.0, 1.0, 1.0] }}, elements = {elements:?} }}\n"
        )
    };
    let material = "[material.m]\nmodel = \"hooke\"\nyoung = 1.0\npoisson = 0.3\n";
    let contact = |name: &str, slave: &str, master: &str| {
        format!("[contact.{name}]\nslave = \"{slave}\"\nmaster = \"{master}\"\n")
    };
    let seam = [
        block("a", [0.0, 0.0], [2, 2, 1]),
        block("b", [1.0, 0.0], [2, 2, 1]),
        block("c", [0.5, 1.0], [2, 2, 1]),
        material.into(),
        contact("one", "c.ymin", "a.ymax"),
        contact("two", "c.ymin", "b.ymax"),
        "[[step]]\nincrements = 1\nfix = [{ set = \"a.ymin\" }, { set = \"b.ymin\" }]\n\
         move = [{ target = \"c.ymax\", by = [0.0, -0.1, 0.0] }]\n"
            .into(),
    ]
    .concat();
    let (code, text) = verdict(&Bench::new(&seam), 2);
    assert!(code == 0 && !text.contains("have in common"), "{text}");

    // Two disks of radius 1 beside each other under a larger one.
    let disk = |[x, y]: [f64; 2], radius: f64| {
        move |[u, v, w]: [f64; 3]| {
            let [a, b] = [2.0 * u - 1.0, 2.0 * v - 1.0];
            let size = a.abs().max(b.abs()) / a.hypot(b).max(f64::MIN_POSITIVE);
            [x + radius * a * size, y + radius * b * size, w]
        }
    };
    let balls = [[-1.1, 0.0], [1.1, 0.0]].map(|at| msh::block([8, 8, 1], false, disk(at, 1.0)));
    let bench = Bench::new(
        &[
            "[body.balls]\nmesh = \"balls.msh\"\nmaterial = \"m\"\n[body.lid]\nmesh = \"lid.msh\"\nmaterial = \"m\"\n",
            material,
            &contact("c", "balls.all", "lid.ymin"),
            "[[step]]\nincrements = 1\nfix = [{ set = \"balls.ymin0\" }, { set = \"balls.ymin1\" }]\n\
             move = [{ target = \"lid.ymax\", by = [0.0, -0.1, 0.0] }]\n",
        ]
        .concat(),
    );
    bench.write("balls.msh", &msh::together(&balls.each_ref().map(|mesh| &mesh[..])));
    bench.write("lid.msh", &msh::block([8, 8, 1], false, disk([0.0, 2.2], 1.0)));
    let (code, text) = verdict(&bench, 2);
    assert!(code == 0 && !text.contains("hollow"), "{text}");
}
