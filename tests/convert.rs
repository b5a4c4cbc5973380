//! Decks as PrePoMax, FreeCAD and Abaqus/CAE write them, converted and run.

mod common;

use common::{Bench, Run, assert_close, assert_small, root};
use nagata::convert::{Converted, convert};
use nagata::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;

const PRESSURE: &str = include_str!("decks/prepomax-pressure.inp");
const FRICTION: &str = include_str!("decks/freecad-friction.inp");
const BAR: &str = include_str!("decks/abaqus-bar.inp");
const STEPS: &str = include_str!("decks/steps.inp");
const CLIP: &str = include_str!("../docs/tutorial/clip.inp");

/// A folder with the deck and the scene that was made of it.
fn converted(deck: &str) -> (Bench, Converted) {
    let bench = Bench::new("");
    bench.write("deck.inp", deck);
    fs::remove_file(bench.path("scene.toml")).unwrap();
    let found = convert(&bench.path("deck.inp"), Some(&bench.path("scene.toml"))).unwrap();
    (bench, found)
}

fn scene(bench: &Bench) -> String {
    fs::read_to_string(bench.path("scene.toml")).unwrap()
}

fn solved(deck: &str) -> Run {
    converted(deck).0.solve(1, &[])
}

/// The error of a deck: line and message.
#[track_caller]
fn refused(deck: &str) -> (usize, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.inp");
    fs::write(&path, deck).unwrap();
    let error = convert(&path, None).map(|_| ()).unwrap_err();
    assert!(!path.with_extension("toml").exists(), "nothing is written");
    match error {
        Error::Input { at, what, help } => (at.map_or(0, |at| at.line), format!("{what}; {help}")),
        other => panic!("{other}"),
    }
}

/// The line of a deck that holds a text.
fn line(deck: &str, text: &str) -> usize {
    deck.lines().position(|line| line.contains(text)).unwrap() + 1
}

/// Uniaxial compression: von Mises stress is the pressure, in elements that are warped.
#[test]
fn a_patch_under_pressure_has_its_stress() {
    let (bench, found) = converted(PRESSURE);
    assert!(found.groups.is_none(), "the deck has all groups");
    let run = bench.solve(1, &[]);
    let name = |at: usize| format!("increments/{at:06}/body_Solid_part-1/cell/von_mises");
    let stress = run.field(&name(run.written()));
    let worst = stress.iter().map(|s| (s / 500.0 - 1.0).abs()).fold(0.0, f64::max);
    assert_small("stress", worst, 1e-9);
}

/// A cube of quadratic tetrahedra with nodes as Abaqus has them, pressed on faces of elements and by nodal forces that are those of
/// a pressure: uniaxial stress.
#[test]
fn quadratic_tetrahedra_are_taken_over() {
    let mesh = common::msh::second_order(&common::msh::block([1, 1, 1], true, |x| x));
    let section = |name: &str| -> Vec<Vec<String>> {
        let begin = mesh.split_once(&format!("${name}\n")).unwrap().1;
        let lines = begin.split_once("$End").unwrap().0.lines().skip(1);
        lines.map(|line| line.split(' ').map(String::from).collect()).collect()
    };
    let nodes = section("Nodes");
    let height = |node: &String| nodes[node.parse::<usize>().unwrap() - 1][3].parse::<f64>().unwrap();
    let list = |d: usize| {
        let own = nodes.iter().filter(|node| node[1 + d] == "0.0").map(|node| node[0].clone());
        format!("*NSET, NSET=low{d}\n{}\n", own.collect::<Vec<_>>().join(",\n"))
    };
    let mut deck = String::from("*NODE\n");
    deck.extend(nodes.iter().map(|node| node.join(", ") + "\n"));
    deck += "*ELEMENT, TYPE=C3D10M, ELSET=cube\n";
    let (mut loads, mut forces) = (String::new(), String::new());
    for mut tet in section("Elements").into_iter().filter(|element| element[1] == "11") {
        let id = tet[0].clone();
        tet.drain(1..5);
        tet.swap(9, 10);
        deck += &format!("{}\n", tet.join(", "));
        for (face, corners) in [[1, 2, 3], [1, 4, 2], [2, 4, 3], [3, 4, 1]].iter().enumerate() {
            if corners.iter().all(|&k| height(&tet[k]) == 1.0) {
                loads += &format!("{id}, P{}, 6.0\n", face + 1);
            }
        }
        for middle in tet[5..].iter().filter(|node| height(node) == 1.0) {
            // A third of the pressure on each triangle of area 1/2, which have one node in common.
            let shared = nodes[middle.parse::<usize>().unwrap() - 1][1..3] == ["0.5", "0.5"];
            let line = format!("{middle}, 3, {:?}\n", if shared { -2.0 } else { -1.0 });
            if !forces.contains(&line) {
                forces += &line;
            }
        }
    }
    (0..3).for_each(|d| deck += &list(d));
    deck += "*SOLID SECTION, ELSET=cube, MATERIAL=steel\n*MATERIAL, NAME=steel\n*ELASTIC\n1e6, 0.3\n*STEP\n*STATIC\n*BOUNDARY\n";
    (0..3).for_each(|d| deck += &format!("low{d}, {0}, {0}\n", d + 1));
    for load in [format!("*DLOAD\n{loads}"), format!("*CLOAD\n{forces}")] {
        let (bench, found) = converted(&format!("{deck}{load}*END STEP\n"));
        assert!(found.notes.iter().any(|note| note.contains("elements C3D10M become `tet10`")), "{:?}", found.notes);
        let run = bench.solve(1, &[]);
        let stress = run.field(&format!("increments/{:06}/body_cube/cell/von_mises", run.written()));
        assert_eq!(stress.len(), 6);
        let worst = stress.iter().map(|s| (s / 6.0 - 1.0).abs()).fold(0.0, f64::max);
        assert_small("stress", worst, 1e-5);
    }
}

/// What is passed over is told with its line, on the terminal and in the scene.
#[test]
fn what_is_passed_over_is_named() {
    let deck = PRESSURE.replace("*Expansion", "*Magic\n*Expansion");
    let (bench, found) = converted(&deck);
    let text = scene(&bench);
    for (word, what) in [
        ("*Magic", "*MAGIC is not known, and passed over"),
        ("*Expansion", "*EXPANSION is passed over"),
        ("*Density", "densities are passed over"),
    ] {
        let at = line(&deck, word);
        assert!(found.notes.iter().any(|note| note.contains(&format!("deck.inp:{at}:1: {what}"))), "{:?}", found.notes);
        assert!(text.contains(&format!("# - line {at}: {what}")), "{text}");
    }
    assert!(text.contains("requests for output are passed over"), "{text}");
}

/// A force on a face, written node by node, is one again; the block slips as a whole, with 0.2 of it.
#[test]
fn a_block_is_drawn_over_a_plate() {
    let (bench, _) = converted(FRICTION);
    assert_eq!(scene(&bench).matches("total = [0.0, 0.0, -900.0]").count(), 2, "{}", scene(&bench));
    let history = bench.solve(1, &[]).history();
    let plate = |component: &str| history.last(&format!("M0S0.ConstraintFixed.{component}"));
    assert_close("support", plate("fz"), 900.0, 1e-9);
    // The plate yields a little under the block, which has to climb.
    assert_close("friction", plate("fx"), -180.0, 1e-5);
    let contact = "DEPConstraintContact-INDConstraintContact";
    assert_eq!(history.last(&format!("{contact}.stick")), 0.0);
    assert_eq!(history.last(&format!("{contact}.slip")), 16.0);
}

/// Parts, internal sets, a table of yield stresses, and an amplitude that bends: the scene written by hand for a block.
#[test]
fn a_plastic_bar_is_pulled_and_pressed() {
    const HAND: &str = r#"
[body.bar]
material = "steel"
block = { box = { origin = [0, 0, 10], size = [40, 8, 8] }, elements = [4, 1, 1] }
[material.steel]
model = "j2"
young = 210e3
poisson = 0.3
hardening = { table = [[0, 250], [0.1, 400], [0.5, 420]] }
[[step]]
name = "pull"
duration = 0.25
increments = 5
fix = [{ set = "bar.xmin" }, { set = "bar.xmax", directions = "yz" }]
move = [{ target = "bar.xmax", by = [2, 0, 0], directions = "x" }]
[[step]]
name = "press"
duration = 0.75
increments = 15
fix = [{ set = "bar.xmin" }, { set = "bar.xmax", directions = "yz" }]
move = [{ target = "bar.xmax", by = [-3, 0, 0], directions = "x" }]
[output]
history = ["bar.xmax"]
"#;
    let (found, expected) = (solved(BAR).history(), Bench::new(HAND).solve(1, &[]).history());
    assert_eq!((found.len(), expected.len()), (20, 20));
    for (a, b) in found.column("Bar-1.PickedSet5.fx").iter().zip(expected.column("bar.xmax.fx")) {
        assert_small("force", a / b - 1.0, 1e-9);
    }
}

/// Conditions act until they are changed, OP=NEW takes the others of its kind off, and a scene says so in each step.
#[test]
fn conditions_last_until_they_are_changed() {
    let history = solved(&STEPS.replace("MATERIAL=BRASS", "MATERIAL=STEEL")).history();
    let foot = |row: usize| ["fx", "fy", "fz"].map(|c| history.column(&format!("body.FOOT.{c}"))[row]);
    let expect = |row: usize, force: [f64; 3]| {
        let found = foot(row);
        (0..3).for_each(|d| assert_small(&format!("step {row}, {d}"), (found[d] + force[d]) / 1000.0, 1e-6));
    };
    // Nine nodes with 100 each, and one with 50 along x.
    expect(0, [50.0, 0.0, -900.0]);
    // Along x 20 on each come to it; the pressure on the side turns a little with it.
    let [x, _, z] = foot(1);
    assert_close("x", x, -(50.0 + 180.0 + 2.0 * 400.0), 2e-3);
    assert_close("z", z, 900.0, 2e-3);
    // OP=NEW takes forces off, but no pressure.
    let [x, _, z] = foot(2);
    assert_close("x", x, -2.0 * 400.0, 2e-3);
    assert_close("z", z, -2700.0, 2e-3);
}

/// A bar of two sections is one body of two materials; with Poisson's ratio 0 each stretches by ln l = -p l/E.
#[test]
fn sections_of_one_part_are_materials_of_one_body() {
    let (model, _) = STEPS.split_once("*STEP").unwrap();
    let lid = "*DLOAD\n13, P2, 500.\n14, P2, 500.\n15, P2, 500.\n16, P2, 500.\n";
    let (bench, _) = converted(&format!("{model}*STEP, NLGEOM\n*STATIC\n{lid}*END STEP\n"));
    assert!(scene(&bench).contains("materials = { "), "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    let stretch = |young: f64| root(0.5, 1.0, |l| l.ln() + 500.0 * l / young);
    let expected = 20.0 * (stretch(200e3) - 1.0) + 20.0 * (stretch(100e3) - 1.0);
    let (points, moved) = (run.points("body.body"), run.vectors(run.written(), "body.body", "displacement"));
    let head: Vec<f64> = points.iter().zip(&moved).filter(|(x, _)| x[2] == 40.0).map(|(_, u)| u[2]).collect();
    assert_eq!(head.len(), 9);
    head.iter().for_each(|u| assert_close("shortening", *u, expected, 1e-9));
}

/// The rigid cam of the tutorial is the tool of the scene there.
#[test]
fn a_rigid_body_is_a_tool() {
    let (bench, _) = converted(CLIP);
    let found = bench.solve(1, &[]).history();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tutorial");
    let hand = Bench::new(&fs::read_to_string(folder.join("clip.toml")).unwrap());
    hand.write("clip.inp", CLIP);
    let expected = hand.solve(1, &[]).history();
    assert_eq!(found.len(), expected.len());
    for component in ["fx", "fz"] {
        let pairs = found.column(&format!("CAM.{component}")).iter().zip(expected.column(&format!("cam.{component}")));
        pairs.for_each(|(a, b)| assert_small(component, (a - b) / 6.0, 1e-8));
    }
}

/// What a scene cannot say is refused at its line.
#[test]
fn what_cannot_be_converted_is_refused() {
    let cases = [
        (FRICTION, "*CONTACT PAIR", "*TIE, NAME=T\n*CONTACT PAIR", "*TIE cannot be converted"),
        (FRICTION, "*ELASTIC", "*ELASTIC, TYPE=ORTHO", "TYPE=ORTHO cannot be converted"),
        (FRICTION, "600, 0.4", "600, 0.4\n500, 0.4, 80", "2 lines of data"),
        (FRICTION, "*ELASTIC\n600, 0.4", "*HYPERELASTIC, YEOH\n1,2,3,4,5,6", "parameter YEOH"),
        (FRICTION, "*SOLID SECTION, ELSET=M1S0, MATERIAL=Block_PTFE", "**", "has no *SOLID SECTION"),
        (FRICTION, "MATERIAL=Block_PTFE\n", "MATERIAL=Blok_PTFE\n", "did you mean `Block_PTFE`"),
        (FRICTION, "=LINEAR", "=TIED", "tied contact"),
        (FRICTION, "ConstraintFixed,1\n", "ConstraintFix,1\n", "no node or node set 'ConstraintFix'"),
        (FRICTION, "ConstraintFixed,1\n", "ConstraintFixed,11\n", "degree of freedom 1 to 6, found '11'"),
        (FRICTION, "*STATIC\n0.1", "*DYNAMIC\n0.1", "*DYNAMIC cannot be converted"),
        (FRICTION, "ConstraintDisplacement,1,1,6.0", "ConstraintDisplacement,3,3,-1.0", "free in the step before"),
        (FRICTION, "ConstraintDisplacement,1,1,6.0", "*DLOAD\n101, P2, 3.", "not on a boundary"),
        (FRICTION, "DEPConstraintContact,IND", "DEPConstraintContact,OUT", "no surface of elements"),
        (FRICTION, "TYPE=C3D8,", "TYPE=C3D20R,", "which is not read"),
        (CLIP, "CAMREF, 4, 6\n", "CAMREF, 4, 5\n", "free to turn about z"),
        (CLIP, "CAMREF, 4, 6\n", "CAMREF, 4, 6, 0.1\n", "turns about several axes"),
        (CLIP, "TOP, CAMFACE", "CAMFACE, TOP", "is on a rigid body"),
        (CLIP, "CAMREF, 3, 3", "1001, 3, 3", "reference node"),
        (BAR, "400., 0.1", "400., 0.1, 20", "varies with temperature"),
        (BAR, "400., 0.1", "200., 0.1", "yield stress falls"),
        (BAR, "*Plastic", "*Plastic, hardening=KINEMATIC", "HARDENING=KINEMATIC"),
        (BAR, "type=C3D8R", "type=C3D20", "which is not read"),
        (BAR, "amplitude=Pull", "amplitude=Push", "no amplitude 'Push'"),
        (BAR, "*Amplitude, name=Pull", "*Amplitude, name=Pull, definition=SMOOTH STEP", "SMOOTH STEP"),
        (STEPS, "1, 1, 50.", "1, 4, 50.", "a moment cannot be converted"),
        (STEPS, "LEFT, S6", "LOWER, S6", "not on a boundary"),
        (STEPS, "SIDE, P, 2.", "SIDE, TRVEC, 2., 0, 0, 1", "the load TRVEC"),
    ];
    for (deck, from, to, what) in cases {
        assert!(deck.contains(from), "{from}");
        let (at, said) = refused(&deck.replacen(from, to, 1));
        assert!(said.contains(what), "{to}: {said}");
        println!("{at}: {said}");
        assert!(at > 0 || what.contains("SECTION"), "{to}: {said}");
    }
}

/// A scene that someone may have changed stays; the command says so with exit code 2.
#[test]
fn nothing_is_overwritten() {
    let bench = Bench::new("");
    bench.write("deck.inp", PRESSURE);
    let command = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nagata"));
        let done = command.args(["convert", "deck.inp"]).current_dir(bench.path("")).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (done.status.code(), text(&done.stdout), text(&done.stderr))
    };
    let (code, stdout, stderr) = command();
    assert_eq!((code, stdout.as_str()), (Some(0), "deck.toml\n"), "{stderr}");
    assert!(stderr.contains("warning: deck.inp:84:1: *EXPANSION is passed over"), "{stderr}");
    fs::write(bench.path("deck.toml"), "mine").unwrap();
    let (code, _, stderr) = command();
    assert!(code == Some(2) && stderr.contains("deck.toml exists already"), "{stderr}");
    assert_eq!(fs::read_to_string(bench.path("deck.toml")).unwrap(), "mine");
}
