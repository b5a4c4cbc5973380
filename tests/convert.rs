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
const GRAVITY: &str = include_str!("decks/freecad-gravity.inp");
const PLASTIC: &str = include_str!("decks/freecad-plastic.inp");
const AMPLITUDE: &str = include_str!("decks/prepomax-amplitude.inp");
const BALL: &str = include_str!("decks/prepomax-ball.inp");
const RIGID: &str = include_str!("decks/prepomax-rigid.inp");
const RUBBER: &str = include_str!("decks/prepomax-rubber.inp");
const TIE: &str = include_str!("decks/freecad-tie.inp");
const TETS: &str = include_str!("decks/prepomax-tets.inp");
const WHEEL: &str = include_str!("decks/prepomax-wheel.inp");
const SLEEVE: &str = include_str!("decks/prepomax-sleeve.inp");
const CARDS: &str = include_str!("decks/calculix-rubber.inp");
const PLY: &str = include_str!("decks/calculix-ply.inp");
const RING: &str = include_str!("decks/calculix-ring.inp");
const FRAMES: &str = include_str!("decks/calculix-frames.inp");
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
    let deck = PRESSURE.replace("*Expansion", "*Conductivity\n1.0\n*Conductivity\n1.0\n*Expansion");
    let (bench, found) = converted(&deck);
    let text = scene(&bench);
    for (word, what) in [("*Conductivity", "*CONDUCTIVITY is passed over"), ("*Expansion", "*EXPANSION is passed over")]
    {
        let at = line(&deck, word);
        assert!(found.notes.iter().any(|note| note.contains(&format!("deck.inp:{at}:1: {what}"))), "{:?}", found.notes);
        assert!(text.contains(&format!("# - line {at}: {what}")), "{text}");
    }
    assert!(text.contains("requests for output are passed over"), "{text}");
    assert!(text.contains(&format!("(also line {})", line(&deck, "*Conductivity") + 2)), "{text}");
    let more = "*Material, Name=Air\n*Amplitude, Name=Wind\n0, 0, 1, 1\n*Surface interaction, Name=Ice\n** Sections";
    let deck = PRESSURE.replace("** Sections", more);
    let (_, found) = converted(&deck);
    for (card, what) in [
        ("Name=Air", "the material 'Air' is of no body"),
        ("Name=Wind", "nothing has the amplitude 'Wind'"),
        ("Name=Ice", "the interaction 'Ice' is of no *CONTACT PAIR"),
    ] {
        let place = format!("deck.inp:{}:1: {what}", line(&deck, card));
        assert!(found.notes.iter().any(|note| note.contains(&place)), "{:?}", found.notes);
    }
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

/// OP=NEW takes off what acted before its step alone, and nothing that the step itself gives; a card of one kind does not change its
/// mind.
#[test]
fn what_a_step_gives_stays_in_it() {
    let (model, _) = STEPS.split_once("*STEP").unwrap();
    let model = model.replace("MATERIAL=BRASS", "MATERIAL=STEEL");
    let step = |cards: &str| format!("*STEP, NLGEOM\n*STATIC\n1., 1.\n{cards}*END STEP\n");
    let first = step("*DSLOAD\nSIDE, P, 2.\n");
    let lid = "13, P2, 5.\n14, P2, 5.\n15, P2, 5.\n16, P2, 5.\n";
    let foot = |cards: &str| {
        let (bench, _) = converted(&format!("{model}{first}{}", step(cards)));
        let history = bench.solve(1, &[]).history();
        ["fx", "fz"].map(|c| history.last(&format!("body.FOOT.{c}")))
    };
    let [alone, z] = foot("*DSLOAD, OP=NEW\nSIDE, P, 0.\n");
    assert!(alone.abs() < 1e-6 && z.abs() < 1e-6, "{alone} {z}");
    let [x, z] = foot(&format!("*DLOAD\n{lid}*DSLOAD, OP=NEW\nSIDE, P, 0.\n"));
    assert!(x.abs() < 1e-2 && z > 100.0, "{x} {z}");
    for (card, line) in [("CLOAD", "HEAD, 1, 20.\n"), ("BOUNDARY", "FOOT, 1, 1, 0.1\n")] {
        let (_, told) = refused(&format!("{model}{first}{}", step(&format!("*{card}\n{line}*{card}, OP=NEW\n{line}"))));
        assert!(told.contains("OP=NEW comes after a card of its kind without it in the same step"), "{card}: {told}");
    }
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

/// Interference that shrinks over the first step is that of its contact.
#[test]
fn interference_is_taken_over() {
    let card = "*CONTACT INTERFERENCE, SHRINK\ndepConstraintContact, INDCONSTRAINTCONTACT\n*STATIC";
    let (bench, found) = converted(&FRICTION.replacen("*STATIC", card, 1));
    let contact = scene(&bench).split_once("[contact.").unwrap().1.to_string();
    assert!(contact.split("\n\n").next().unwrap().contains("interference = \"ramped\""), "{contact}");
    assert!(!found.notes.iter().any(|note| note.contains("INTERFERENCE")), "{:?}", found.notes);
    assert!(!scene(&converted(FRICTION).0).contains("interference"));
}

/// What a scene cannot say is refused at its line.
#[test]
fn what_cannot_be_converted_is_refused() {
    let cases = [
        (FRICTION, "*CONTACT PAIR", "*TIE, NAME=T, CYCLIC SYMMETRY\n*CONTACT PAIR", "parameter CYCLIC SYMMETRY"),
        (CLIP, "*STEP", "*TIE, NAME=T\nTOP, CAMFACE\n*STEP", "the tied surface 'CAMFACE' is on a rigid body"),
        (FRICTION, "*ELASTIC", "*ELASTIC, TYPE=ANISO", "TYPE=ANISO cannot be converted"),
        (PLY, "130000., 9000.", "130000., 9.", "with these constants"),
        (PLY, "ORIENTATION=TILTED", "ORIENTATION=TILT", "there is no orientation 'TILT'"),
        (PLY, "SYSTEM=RECTANGULAR", "SYSTEM=CYLINDRICAL", "this *ORIENTATION cannot be converted"),
        (PLY, "3000., 20.", "3000., 20.\n1.", "3 lines of data, not two"),
        (FRICTION, "600, 0.4", "600, 0.4\n500, 0.4, 80", "2 lines of data"),
        (FRICTION, "*ELASTIC\n600, 0.4", "*HYPERELASTIC, ARRUDA-BOYCE\n1,2,3", "parameter ARRUDA-BOYCE"),
        (CARDS, "0.002, 0.04", "0.002, 0.04, 0.1", "D2 or D3 = 0.1 cannot be converted"),
        (CARDS, "NEO HOOKE\n0.5, 0.04", "NEO HOOKE\n0.5, 0", "D1 = 1.0169e-1: write that"),
        (CARDS, "-2., 0.04, 0.\n0.", "-2.", "expected 9 constants"),
        (CARDS, "0.4, 0.1, 0.04", "0.4, 0.1, 0.04, 0, 20", "expected 3 constants, and a temperature at most, found 5"),
        (CARDS, "0.4, 0.1, 0.04", "0.4, -0.4, 0.04", "the shear modulus"),
        (CARDS, "OGDEN, N=3", "OGDEN, N=4", "N is not 1, 2 or 3"),
        (CARDS, "REDUCED POLYNOMIAL", "POLYNOMIAL", "POLYNOMIAL, N=2 or 3"),
        (FRICTION, "*CONTACT PAIR", "*CLEARANCE, VALUE=1\n*CONTACT PAIR", "*CLEARANCE cannot be converted"),
        (FRICTION, "*CONTACT PAIR", "*COHESIVE BEHAVIOR\n*CONTACT PAIR", "*COHESIVE BEHAVIOR cannot be converted"),
        (FRICTION, "*CONTACT PAIR", "*MAGIC\n*CONTACT PAIR", "*MAGIC is not known"),
        (
            FRICTION,
            "*STEP",
            "*CONTACT INTERFERENCE, SHRINK\nDEPConstraintContact,INDConstraintContact\n*STEP",
            "SHRINK, in the first step",
        ),
        (
            FRICTION,
            "*STATIC",
            "*CONTACT INTERFERENCE\nDEPConstraintContact,INDConstraintContact\n*STATIC",
            "SHRINK, in the first step",
        ),
        (
            FRICTION,
            "*STATIC",
            "*CONTACT INTERFERENCE, SHRINK\nINDConstraintContact,DEPConstraintContact\n*STATIC",
            "that are no *CONTACT PAIR",
        ),
        (FRAMES, "NSET=FOOT, TYPE=R", "NSET=FOOT, TYPE=S", "*TRANSFORM, TYPE=S cannot be converted"),
        (FRAMES, "NSET=FOOT, TYPE=R", "NSET=BORE, TYPE=R", "is of two *TRANSFORM"),
        (
            RIGID,
            "*Step, Nlgeom",
            "*Transform, Nset=Internal_Selection-1_Rigid_Body-1, Type=C\n0, 0, 0, 0, 0, 1\n*Step, Nlgeom",
            "of the rigid body of",
        ),
        (
            FRAMES,
            "*STEP",
            "*ELEMENT, TYPE=SPRING1, ELSET=S\n900, 101\n*SPRING, ELSET=S\n2\n5.\n*STEP",
            "of a *SPRING along 2",
        ),
        (FRAMES, "-1, 1, 0.5", "2, 2, 0", "in one line with the origin"),
        (FRAMES, "*BOUNDARY", "*CLOAD\nFOOT, 1, 5.\n*BOUNDARY", "of a *TRANSFORM: forces there"),
        (GRAVITY, "*DENSITY\n1.134e-08\n", "", "material 'Head_Lead' has no density"),
        (GRAVITY, "Eall,GRAV", "M1S0,GRAV", "pulls differently at materials of the body"),
        (GRAVITY, "Eall,GRAV", "12,GRAV", "gravity acts on a part of what"),
        (GRAVITY, "0.0,0.0,-1.0", "0.0,0.0,0.0", "gravity has no direction"),
        (GRAVITY, "*STEP", "*MASS, ELSET=Eall\n1.\n*STEP", "*MASS weighs under GRAV"),
        (GRAVITY, "*STEP", "*RESTART, READ, STEP=1\n*STEP", "begins from the state of another analysis"),
        (
            GRAVITY,
            "*END STEP",
            "*END STEP\n*STEP\n*STATIC\n*DLOAD\nEall,GRAV,9810.,0.,0.,1.\n*END STEP",
            "from an earlier step in another direction",
        ),
        (
            STEPS,
            "*STEP",
            "*ELEMENT, TYPE=SPRINGA, ELSET=S\n90, 1, 2\n*SPRING, ELSET=S\n\n5.\n*STEP",
            "*SPRING of elements SPRINGA",
        ),
        (FRICTION, "*SOLID SECTION, ELSET=M1S0, MATERIAL=Block_PTFE", "**", "has no *SOLID SECTION"),
        (FRICTION, "MATERIAL=Block_PTFE\n", "MATERIAL=Blok_PTFE\n", "did you mean `Block_PTFE`"),
        (FRICTION, "=LINEAR", "=TIED", "tied contact"),
        (FRICTION, "ConstraintFixed,1\n", "ConstraintFix,1\n", "no node or node set 'ConstraintFix'"),
        (FRICTION, "ConstraintFixed,1\n", "ConstraintFixed,11\n", "degree of freedom 1 to 6, found '11'"),
        (FRICTION, "*STATIC\n0.1", "*DYNAMIC\n0.1", "*DYNAMIC cannot be converted"),
        (FRICTION, "ConstraintDisplacement,1,1,6.0", "ConstraintDisplacement,3,3,-1.0", "free in the step before"),
        (FRICTION, "ConstraintDisplacement,1,1,6.0", "*DLOAD\n101, P2, 3.", "not on a boundary"),
        (FRICTION, "DEPConstraintContact,IND", "DEPConstraintContact,OUT", "no surface of elements"),
        (FRICTION, "TYPE=C3D8,", "TYPE=C3D13,", "which is not read"),
        (CLIP, "CAMREF, 4, 6\n", "CAMREF, 4, 4\n", "turns, or is free to, about y and z"),
        (WHEEL, "902, 2, 300", "902, 7, 300", "expected a degree of freedom 1 to 6, found '7'"),
        (RIGID, "*Cload, op=New", "*Cload\n902, 2, 300", "a force or moment on the rigid body of"),
        (CLIP, "CAMREF, 4, 6\n", "CAMREF, 4, 6, 0.1\n", "turns, or is free to, about x and y and z"),
        (CLIP, "TOP, CAMFACE", "CAMFACE, TOP", "is on a rigid body"),
        (CLIP, "CAMREF, 3, 3", "1001, 3, 3", "reference node"),
        (BAR, "400., 0.1", "400., 0.1, 20", "varies with temperature"),
        (BAR, "400., 0.1", "200., 0.1", "yield stress falls"),
        (BAR, "*Plastic", "*Plastic, hardening=KINEMATIC", "HARDENING=KINEMATIC"),
        (BAR, "*Plastic", "*Elastic\n10., 0.1\n*Plastic", "already has its *ELASTIC"),
        (BAR, "*Amplitude", "*Amplitude, name=PULL\n0, 0, 1, 1\n*Amplitude", "two amplitudes are named"),
        (BAR, "type=C3D8R", "type=C3D13", "which is not read"),
        (BAR, "amplitude=Pull", "amplitude=Push", "no amplitude 'Push'"),
        (BAR, "*Amplitude, name=Pull", "*Amplitude, name=Pull, definition=SMOOTH STEP", "SMOOTH STEP"),
        (STEPS, "1, 1, 50.", "1, 4, 50.", "a moment on nodes of a body cannot be converted"),
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

/// Total forces on a set at the end of each step, as CalculiX 2.20 has them (scripts/studies/decks.py), within a tolerance.
#[track_caller]
fn as_calculix(deck: &str, set: &str, steps: &[[Option<f64>; 3]], tolerance: f64) -> Run {
    let run = solved(deck);
    let history = run.history();
    let ends: Vec<usize> =
        (0..history.len()).filter(|&row| history.steps.get(row + 1) != Some(&history.steps[row])).collect();
    assert_eq!(ends.len(), steps.len());
    let largest = steps.iter().flatten().flatten().fold(0.0f64, |largest, force| largest.max(force.abs()));
    for (&row, expected) in ends.iter().zip(steps) {
        for (component, expected) in ["fx", "fy", "fz"].into_iter().zip(expected) {
            let Some(expected) = expected else { continue };
            let found = history.column(&format!("{set}.{component}"))[row];
            assert_small(&format!("{set}.{component} {found:e}"), (found - expected) / largest, tolerance);
        }
    }
    run
}

/// A cube of each rubber is stretched by a half: the constants are those of the deck.
#[test]
fn rubber_cards_are_those_of_calculix() {
    let history = solved(CARDS).history();
    for (name, force) in [
        ("NEO", -1.043787),
        ("MOONEY", -0.9753565),
        ("REDUCED", -1.020137),
        ("YEOH", -1.024205),
        ("OGDEN1", -0.9090136),
        ("OGDEN2", -0.6326375),
        ("OGDEN3", -0.5900304),
    ] {
        assert_close(name, history.last(&format!("{name}.FOOT-{name}.fz")), force, 2e-5);
    }
}

/// Bars of orthotropic constants of both kinds, sheared and pulled across their axes, which one material has by two orientations.
#[test]
fn orthotropic_cards_are_those_of_calculix() {
    let (bench, _) = converted(PLY);
    assert_eq!(scene(&bench).matches("model = \"orthotropic\"").count(), 3, "{}", scene(&bench));
    let history = bench.solve(1, &[]).history();
    for (name, force) in [
        ("PLY", [-0.1597449, 0.1130392, -1.331081]),
        ("BLOCK", [-0.008377682, 0.03998053, -0.1892203]),
        ("BARE", [-0.1142212, 0.1739467, -1.263220]),
    ] {
        for (component, force) in ["fx", "fy", "fz"].iter().zip(force) {
            let found = history.last(&format!("{name}.FOOT-{name}.{component}"));
            assert_small(&format!("{name}.{component} {found:e}"), (found - force) / 1.3, 3e-4);
        }
    }
}

/// Two cubes of a stiffness of 1000 along the fibre and 20 across, pulled by a thousandth along z: one has its fibre there. Each
/// part has an orientation of the same name, as Abaqus/CAE gives it.
#[test]
fn each_part_has_its_own_orientation() {
    let part = |name: &str, fibre: &str| {
        format!(
            "*Part, name={name}\n*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n\
             8, 0, 1, 1\n*Element, type=C3D8, elset=All\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*Nset, nset=Foot\n1, 2, 3, 4\n\
             *Nset, nset=Top\n5, 6, 7, 8\n*Nset, nset=Left\n1, 4, 5, 8\n*Nset, nset=Front\n1, 2, 5, 6\n\
             *Orientation, name=Ori-1\n{fibre}\n*Solid Section, elset=All, orientation=Ori-1, material=Wood\n,\n*End Part\n"
        )
    };
    let instance = |name: &str, x: f64| format!("*Instance, name={name}-1, part={name}\n{x}, 0, 0\n*End Instance\n");
    let boundary = |name: &str| {
        let of = |set: &str, direction: u8, by: f64| format!("{name}-1.{set}, {direction}, {direction}, {by}\n");
        of("Foot", 3, 0.0) + &of("Left", 1, 0.0) + &of("Front", 2, 0.0) + &of("Top", 3, 0.001)
    };
    let deck = |second: &str| {
        let parts = part("A", "1, 0, 0, 0, 1, 0") + &part("B", "0, 0, 1, 0, 1, 0").replace("Ori-1", second);
        format!(
            "{parts}*Assembly, name=Assembly\n{}{}*End Assembly\n*Material, name=Wood\n\
             *Elastic, type=ENGINEERING CONSTANTS\n1000, 20, 20, 0, 0, 0, 8, 8\n8\n*Step, nlgeom=NO\n*Static\n1, 1\n\
             *Boundary\n{}{}*End Step\n",
            instance("A", 0.0),
            instance("B", 5.0),
            boundary("A"),
            boundary("B")
        )
    };
    for second in ["Ori-1", "Ori-2"] {
        let history = solved(&deck(second)).history();
        let names = history.names();
        let force = |part: &str| {
            let is_it = |name: &&String| name.to_uppercase().contains(&format!("{part}-1.TOP.FZ"));
            history.last(names.iter().find(is_it).unwrap_or_else(|| panic!("{names:?}")))
        };
        assert_close("across the fibre", force("A"), 0.02, 2e-3);
        assert_close("along the fibre", force("B"), 1.0, 2e-3);
    }
    let (_, said) = refused(&deck("Ori-1").replacen(
        "*Solid Section",
        "*Orientation, name=ORI-1\n1, 0, 0, 0, 1, 0\n*Solid Section",
        1,
    ));
    assert!(said.contains("two orientations are named"), "{said}");
    let (_, said) = refused(&deck("Ori-1").replacen("orientation=Ori-1", "orientation=Ori-3", 1));
    assert!(said.contains("there is no orientation 'Ori-3'"), "{said}");
}

/// A load and a motion with amplitudes over the step may be followed by a step that takes them off, or gives others.
#[test]
fn amplitudes_over_the_step_end_with_it() {
    let (cube, step) = PRESSURE.split_once("** Steps").unwrap();
    let (held, loads) = step.split_once("** Boundary conditions").unwrap().1.split_once("** Loads").unwrap();
    let line = loads.split_once("*Dload\n").unwrap().1.lines().next().unwrap();
    let deck = |first: &str, next: &str| {
        let steps = [first, next].map(|cards| format!("*Step, Nlgeom\n*Static\n1, 1\n{cards}*End Step\n")).concat();
        format!("{cube}*Amplitude, Name=Wave\n0, 0, 0.5, 1, 1, 0.4\n{steps}")
    };
    let wave = format!("{held}*Dload, Amplitude=Wave\n{line}\n");
    let (at, said) = refused(&deck(&wave, ""));
    assert!(said.contains("the amplitude of this condition is over the time of its step") && at > 0, "{said}");
    let stress = |next: &str| {
        let run = converted(&deck(&wave, next)).0.solve(1, &[]);
        run.field(&format!("increments/{:06}/body_Solid_part-1/cell/von_mises", run.written()))
    };
    stress("*Dload, Op=New\n").iter().for_each(|stress| assert_small("off", *stress, 1e-7));
    stress(&format!("*Dload\n{line}\n")).iter().for_each(|stress| assert_close("replaced", *stress, 500.0, 1e-9));
}

/// A bonded pad of rubber is pressed and sheared: C3D8R there, F-bar here.
#[test]
fn a_rubber_pad_is_pressed_and_sheared() {
    let steps = [[Some(0.0), Some(0.0), Some(220.9527)], [Some(-36.71538), Some(0.0), Some(209.2857)]];
    as_calculix(RUBBER, "Solid_part-1.Internal_Selection-1_Fixed", &steps, 4e-2);
}

/// A block flows between rough plates, and is let go: C3D8I.
#[test]
fn a_plastic_block_is_pressed_and_let_go() {
    let steps = [[Some(0.0), Some(0.0), Some(22767.40)], [Some(0.0), Some(0.0), Some(-5900.535)]];
    as_calculix(PLASTIC, "Evolumes.ConstraintFixed", &steps, 2e-2);
}

/// A bar is bent and pressed by the nodes of a rigid body, whose rotations are held by its second node.
#[test]
fn nodes_of_a_rigid_body_move_as_one() {
    let force = [Some(-2545.497), Some(0.0), Some(11526.59)];
    as_calculix(RIGID, "Solid_part-1.Internal_Selection-1_Fixed", &[force], 5e-3);
}

/// The nodes also turn about the second: as CalculiX turns them. A *COUPLING by *KINEMATIC is the same; its surface is that of
/// the nodes. In another step the rest of the angle is turned.
#[test]
fn nodes_of_a_rigid_body_turn() {
    let bent = RIGID.replace("902, 1, 3, 0", "902, 1, 1, 0\n902, 2, 2, 0.002\n902, 3, 3, 0");
    let force = [Some(-702.2154), Some(0.0), Some(11534.80)];
    as_calculix(&bent, "Solid_part-1.Internal_Selection-1_Fixed", &[force], 5e-3);

    let text = scene(&converted(&bent).0);
    let angle = 0.002f64.to_degrees();
    let turn = format!("rotate = {{ point = [4.0, 4.0, 30.0], axis = [0.0, 1.0, 0.0], angle = {angle:?} }}");
    assert!(text.contains(&turn), "{turn}\n{text}");
    let card = "*Rigid body, Nset=Internal_Selection-1_Rigid_Body-1, Ref node=901, Rot node=902";
    let top = "*Surface, Name=Internal_Selection-1_Rigid_Body-1-S\nInternal_Selection-1_Top, S2\n";
    let coupling = "*Coupling, Constraint name=C, Ref node=901, Surface=Internal_Selection-1_Rigid_Body-1-S";
    let elements = "*Elset, Elset=Internal_Selection-1_Top, Generate\n46, 54\n";
    let coupled = |dofs: &str| {
        let cards = format!("{elements}{top}{coupling}\n*Kinematic\n{dofs}");
        let moved = bent.replace(card, &cards);
        moved.replace("902, 1, 1, 0\n902, 2, 2, 0.002\n902, 3, 3, 0", "901, 4, 4, 0\n901, 5, 5, 0.002\n901, 6, 6, 0")
    };
    let of_nodes = format!("*Surface, Type=NODE, Name={0}-S, Internal\n{0}, 1.\n", "Internal_Selection-1_Rigid_Body-1");
    let tied = bent.replace(card, &card.replace("Nset", "Tie nset"));
    for same in [coupled("1, 3"), coupled("1, 3").replace(top, &of_nodes), tied] {
        assert_eq!(scene(&converted(&same).0).matches(&turn).count(), 1);
    }
    let (_, told) = refused(&bent.replace("Ref node=901", "Ref node=901, Pin nset=Internal_Selection-1_Rigid_Body-1"));
    assert!(told.contains("needs one of ELSET=, NSET=, TIE NSET= and PIN NSET="), "{told}");
    let (_, told) = refused(&coupled("1, 2"));
    assert!(told.contains("leaves free along 1, 2 or 3"), "{told}");
    let (_, told) = refused(&coupled("1, 3").replace("*Kinematic", "*Distributing"));
    assert!(told.contains("cannot follow a reference node in the mean"), "{told}");

    let later = "*End step\n*Step, Nlgeom\n*Static\n*Boundary\n902, 2, 2, 0.003\n901, 1, 1, 0.08\n*End step";
    let text = scene(&converted(&bent.replace("*End step", later)).0);
    let rest = format!("by = [{:?}, 0.0, 0.0], rotate = {{ point = [4.05, 4.0, 29.98]", 0.08 - 0.05);
    assert!(text.contains(&rest), "{rest}\n{text}");
}

/// A part of a ring is widened and turned at its bore in a cylindrical frame, a block moves on an askew plane.
#[test]
fn conditions_along_axes_of_their_own_are_those_of_calculix() {
    let run = as_calculix(FRAMES, "RING.BORE", &[[Some(3665.467), Some(5542.532), None]], 1e-2);
    let of_head = ["fx", "fy", "fz"].map(|component| run.history().last(&format!("BLOCK.HEAD.{component}")));
    for (found, expected) in of_head.into_iter().zip([-482.3195, -64.29651, -836.0460]) {
        assert_small("block", (found - expected) / 836.0, 5e-3);
    }
    // What is held in all directions needs none of them, on an axis, too.
    let text = scene(&converted(&FRAMES.replace("RIM, 1, 2", "RIM, 1, 3")).0);
    assert!(text.contains("{ set = \"RING.RIM\" }"), "{text}");
}

/// What is wrong in several places is told at once, as in scenes.
#[test]
fn all_mistakes_of_a_deck_are_told() {
    let bench = Bench::new("");
    let told = |deck: &str| {
        bench.write("deck.inp", deck);
        match convert(&bench.path("deck.inp"), None).map(|_| ()).unwrap_err() {
            Error::Inputs(errors) => errors.iter().map(ToString::to_string).collect(),
            error => vec![error.to_string()],
        }
    };
    let steps = FRICTION
        .replace("ConstraintFixed,1\n", "ConstraintFix,1\n")
        .replace("ConstraintFixed,2\n", "ConstraintFixed,9\n");
    let found = told(&steps);
    assert!(found.len() == 2 && found[1].contains("found '9'"), "{found:#?}");
    let materials =
        BAR.replace("400., 0.1", "200., 0.1").replace("*Amplitude, name=Pull", "*Amplitude, name=Pull, value=ABSOLUTE");
    assert_eq!(told(&materials).len(), 2);
    // What nothing names does not count.
    let unused = BAR.replace("400., 0.1", "200., 0.1");
    let unused = unused.replace(
        "*Amplitude, name=Pull",
        "*Amplitude, name=Unused, value=ABSOLUTE\n0., 0., 1., 1.\n*Amplitude, name=Pull",
    );
    assert_eq!(told(&unused).len(), 1);
}

/// Amplitudes of two motions of one set: a block is pressed, and drawn along while it is let up. It slips: 0.3 of the force.
#[test]
fn a_block_is_pressed_and_drawn_by_amplitudes() {
    let steps = [[None, None, Some(4277.881)], [Some(-735.2159), Some(0.0), Some(2451.404)]];
    let run = as_calculix(AMPLITUDE, "Lower.Internal_Selection-1_Fixed", &steps, 1e-2);
    let last = |component: &str| run.history().last(&format!("Lower.Internal_Selection-1_Fixed.{component}"));
    assert_close("friction", last("fx"), -0.3 * last("fz"), 1e-3);
}

/// A post is tied to a plate of other faces, pressed and sheared: CalculiX ties the slave's nodes to faces of the master.
#[test]
fn a_tied_post_is_pressed() {
    assert_eq!(scene(&converted(TIE).0).matches("[tie.ConstraintTie]").count(), 1);
    as_calculix(TIE, "M0S0.ConstraintFixed", &[[Some(-2482.787), Some(0.0), Some(3833.076)]], 3e-2);
}

/// A leaning block of quadratic tetrahedra is pressed on a plate of them and drawn: in the end it slips as a whole.
#[test]
fn quadratic_tetrahedra_slide() {
    let steps = [[None, None, Some(2010.364)], [Some(-463.3125), Some(0.0), Some(1853.219)]];
    let run = as_calculix(TETS, "Plate.Internal_Selection-1_Fixed", &steps, 4e-2);
    let last = |component: &str| run.history().last(&format!("Plate.Internal_Selection-1_Fixed.{component}"));
    assert_close("friction", last("fx"), -0.25 * last("fz"), 1e-3);
}

/// The same, tied and moved by a thousandth, where Green's strain is as good as any; CalculiX couples each slave node with the face under
/// it.
#[test]
fn quadratic_tetrahedra_are_tied() {
    let (before, rest) = TETS.split_once("** Name: Contact_Pair-1").unwrap();
    let (_, after) = rest.split_once("** Amplitudes").unwrap();
    let after = after.replace("3, 3, -0.06", "3, 3, -0.00006").replace("1, 1, 0.8", "1, 1, 0.0008");
    let tied = format!("{before}*Tie, Name=Joint, Position tolerance=0.1\nSlave, Master\n** Amplitudes{after}");
    let steps =
        [[Some(0.06214903), Some(-0.01341501), Some(2.155958)], [Some(-7.165439), Some(-0.02998491), Some(1.325415)]];
    as_calculix(&tied, "Plate.Internal_Selection-1_Fixed", &steps, 4e-4);
    // A surface of all nodes of these faces is that of them, and one of fewer none: those of the block begin at 316, on the plate at 6.
    let (_, lines) = TETS.split_once("*Node\n").unwrap();
    let node = |line: &str| -> Vec<f64> { line.split(", ").map(|word| word.parse().unwrap()).collect() };
    let nodes = lines.lines().take_while(|line| !line.starts_with('*')).map(node);
    let feet: Vec<String> =
        nodes.filter(|node| node[0] >= 316.0 && node[3] == 6.0).map(|node| node[0].to_string()).collect();
    let of_nodes = |feet: &[String]| {
        let surface = format!("*Nset, Nset=Feet\n{}\n*Surface, Name=Slave, Type=Node\nFeet", feet.join(",\n"));
        tied.replace("*Surface, Name=Slave, Type=Element\nInternal_Selection-1_Slave_S1, S1", &surface)
    };
    as_calculix(&of_nodes(&feet), "Plate.Internal_Selection-1_Fixed", &steps, 4e-4);
    let what = refused(&of_nodes(&feet[1..])).1;
    assert!(what.contains("is of no face of a body with all its nodes in it"), "{what}");
}

/// A moment turns a rigid wheel on a pad that it is pressed on; the reference node may have it, too. A wheel that nothing turns
/// is free to.
#[test]
fn a_moment_turns_a_wheel() {
    let steps = [[Some(0.0), Some(0.0), Some(61.03974)], [Some(20.14598), Some(0.0), Some(60.45771)]];
    let run = as_calculix(WHEEL, "Pad.Internal_Selection-1_Fixed", &steps, 1e-2);
    let last = |component: &str| run.history().last(&format!("Internal_Selection-1_Rigid_Body-1.{component}"));
    assert_close("moment", last("moment"), 300.0, 1e-8);
    assert_close("angle", last("angle").to_radians(), 0.02385381, 2e-2);
    let of = |moment: &str| scene(&converted(&WHEEL.replace("902, 2, 300\n", moment)).0);
    assert_eq!(of("901, 5, 300\n"), of("902, 2, 300\n"));
    assert!(of("").contains("total = 0.0, point = [0.0, 3.0, 14.4], axis = [0.0, 1.0, 0.0] }"), "{}", of(""));
    // Half of it comes in the first tenth, and goes again.
    let wave = "*Amplitude, Name=Wave\n0, 0, 0.1, 0.5, 1, 0\n** Initial";
    let wavy = WHEEL.replacen("** Initial", wave, 1).replace("*Cload\n902", "*Cload, Amplitude=Wave\n902");
    let text = scene(&converted(&wavy).0);
    assert!(text.contains("total = 150.0") && text.contains("table = [[0.0, 0.0], [0.1, 1.0], [1.0, 0.0]]"), "{text}");
}

/// A sleeve is pushed onto a cone, axisymmetric both: forces on its nodes that are those of an even load on a ring are one.
#[test]
fn a_sleeve_is_pushed_onto_a_cone() {
    let (bench, _) = converted(SLEEVE);
    assert_eq!(scene(&bench).matches("total = ").count(), 1, "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    assert_close("force", run.history().last("Cone.Internal_Selection-1_Fixed.fy"), 6000.0, 1e-9);
    let moved = run.vectors(run.written(), "body.Sleeve", "displacement");
    let node = run.points("body.Sleeve").iter().position(|x| *x == [14.0, 9.0, 0.0]).unwrap();
    for (d, of_calculix) in [9.804491e-3, -6.851931e-2].into_iter().enumerate() {
        assert_close("outer edge", moved[node][d], of_calculix, 1e-2);
    }
}

/// A quarter of a ball in its seat: where its nodes are held in planes it goes on, or its smoothed surface would end in a ridge.
#[test]
fn a_ball_is_pressed_into_a_seat() {
    let force = [Some(-19.44939), Some(-19.44939), Some(191.0163)];
    let run = as_calculix(BALL, "Seat.Internal_Selection-1_Fixed", &[force], 5e-2);
    assert_eq!(run.summary()["cutbacks"], 0);
}

/// Loads, too, follow tables: a pressure falls from its peak.
#[test]
fn amplitudes_of_loads_are_tables() {
    let waves = "*Amplitude, Name=Wave\n0, 0, 0.5, 1, 1, 0.4\n** Steps";
    let deck = PRESSURE.replace("** Steps", waves).replace("*Dload\nI", "*Dload, Amplitude=Wave\nI");
    let (bench, _) = converted(&deck);
    assert!(scene(&bench).contains("value = 500.0, table = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.4]]"), "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    let stress = run.field(&format!("increments/{:06}/body_Solid_part-1/cell/von_mises", run.written()));
    stress.iter().for_each(|stress| assert_close("stress", *stress, 200.0, 1e-9));
}

#[test]
fn what_elements_become_is_told() {
    for (deck, what) in [
        (PLASTIC, "body `Evolumes`: elements C3D8I become `hex8-eas`"),
        (RUBBER, "body `Solid_part-1`: elements C3D8R become those that nagata takes for its material"),
    ] {
        let notes = converted(deck).1.notes;
        assert_eq!(notes.iter().filter(|note| note.contains(what)).count(), 1, "{notes:#?}");
    }
}

/// Gravity on two densities of one body, and on one body of several alone; the direction of a card is one, its length does
/// not count.
#[test]
fn bodies_have_weight() {
    let (bench, _) = converted(&GRAVITY.replace("0.0,0.0,-1.0", "0.0,0.0,-3.0"));
    assert!(scene(&bench).contains("gravity = [0.0, 0.0, -9810.0]"), "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    assert_close("weight", run.history().last("Evolumes.ConstraintFixed.fz"), WEIGHT, 1e-9);
    let sunk = run.vectors(run.written(), "body.Evolumes", "displacement");
    let largest = sunk.iter().map(|u| u.iter().map(|part| part * part).sum::<f64>().sqrt()).fold(0.0, f64::max);
    assert_close("sinking", largest, 0.0006404024, 1e-5);
    let waves = GRAVITY.replace("*STEP", "*AMPLITUDE, NAME=WAVE\n0, 0, 0.5, 1, 1, 0.25\n*STEP");
    let (bench, _) = converted(&waves.replace("*DLOAD", "*DLOAD, AMPLITUDE=WAVE"));
    let table = "gravity = { acceleration = [0.0, 0.0, -9810.0], table = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.25]] }";
    assert!(scene(&bench).contains(table) && scene(&bench).matches("[[step]]").count() == 1, "{}", scene(&bench));
    let borne = bench.solve(1, &[]).history();
    let borne = borne.column("Evolumes.ConstraintFixed.fz");
    [1.0, 0.25].iter().zip(borne).for_each(|(share, fz)| assert_close("weight by a table", *fz, share * WEIGHT, 1e-9));
    let heavy = AMPLITUDE.replace("*Elastic\n70000", "*Density\n1e-6\n*Elastic\n70000");
    let (bench, _) = converted(&heavy.replace("*Dload, op=New", "*Dload, op=New\nLower, GRAV, 1000, 0, 0, -2"));
    let half = "body_force = [{ body = \"Lower\", per_volume = [0.0, 0.0, -0.0005] }]";
    assert!(scene(&bench).contains(half) && scene(&bench).contains(&half.replace("05]", "1]")), "{}", scene(&bench));
}

/// N, of the column of two densities.
const WEIGHT: f64 = 9810.0 * 3e6 * (2.4e-9 + 1.134e-8);

/// The column stands on springs.
/// A column of six elements that turns about an axis across it, below its foot: CalculiX integrates the load within elements,
/// nagata at their nodes, which is 0.8 % more here.
#[test]
fn a_column_spins() {
    let spinning = GRAVITY.replace("Eall,GRAV,9810.0,0.0,0.0,-1.0", "Eall,CENTRIF,@,-5.,50.,-300.,3.,0.,0.");
    assert_ne!(spinning, GRAVITY);
    let (bench, _) = converted(&spinning.replace('@', "4e3"));
    let axis = "point = [-5.0, 50.0, -300.0], axis = [3.0, 0.0, 0.0], speed = 63.245553203367585 }";
    assert!(scene(&bench).contains(axis), "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    let moved = run.vectors(run.written(), "body.Evolumes", "displacement");
    let largest = moved.iter().map(|u| u.iter().map(|part| part * part).sum::<f64>().sqrt()).fold(0.0, f64::max);
    assert_close("largest displacement", largest, 0.1983359, 1e-2);
    let (_, told) = refused(&spinning.replace('@', "-1."));
    assert!(told.contains("a square below 0"), "{told}");
    let (_, told) = refused(&spinning.replace('@', "4e3").replace("*DENSITY\n1.134e-08\n", ""));
    assert!(told.contains("CENTRIF acts on the body"), "{told}");
}

#[test]
fn springs_stand_on_the_ground() {
    let springs: String = (1..=9).map(|node| format!("{}, {node}\n", 900 + node)).collect();
    let feet = format!("*ELEMENT, TYPE=SPRING1, ELSET=Feet\n{springs}*SPRING, ELSET=Feet\n3\n100.\n** Materials");
    let deck = GRAVITY.replacen("** Materials", &feet, 1).replace("ConstraintFixed,3\n", "");
    let history = solved(&deck).history();
    assert_close("weight", history.last("Evolumes.ConstraintFixed.fz"), WEIGHT, 1e-9);
    assert_close("sinking", history.last("Evolumes.ConstraintFixed.uz"), -WEIGHT / 900.0, 1e-9);
}

/// A scene that someone may have changed stays; the command says so with exit code 2.
#[test]
fn nothing_is_overwritten() {
    let bench = Bench::new("");
    bench.write("deck.inp", PRESSURE);
    let of = |deck: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nagata"));
        let done = command.args(["convert", deck]).current_dir(bench.path("")).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (done.status.code(), text(&done.stdout), text(&done.stderr))
    };
    let command = || of("deck.inp");
    let (code, stdout, stderr) = command();
    assert_eq!((code, stdout.as_str()), (Some(0), "deck.toml\n"), "{stderr}");
    assert!(stderr.contains("warning: deck.inp:84:1: *EXPANSION is passed over"), "{stderr}");
    fs::write(bench.path("deck.toml"), "mine").unwrap();
    let (code, _, stderr) = command();
    assert!(code == Some(2) && stderr.contains("deck.toml exists already"), "{stderr}");
    assert_eq!(fs::read_to_string(bench.path("deck.toml")).unwrap(), "mine");
    // What is no deck is not said to be in its own way.
    for (wrong, word) in
        [(".", "Is a directory"), ("deck.toml", "deck.toml:1:1: expected a keyword"), ("no.inp", "No such file")]
    {
        let (code, _, stderr) = of(wrong);
        assert!(code == Some(2) && stderr.contains(word), "{wrong}: {stderr}");
    }
}

/// A tube of axisymmetric elements under pressure from inside, by their sides and by a surface. Lame, as in `axisymmetric.rs`.
#[test]
fn axisymmetric_elements_become_a_layer() {
    let (n, a, b, young, poisson, p) = (8, 1.0, 2.0, 1000.0, 0.3, 1e-3);
    let node = |i: usize, j: usize| 1 + i + (n + 1) * j;
    let mut deck = "*NODE, NSET=all\n".to_string();
    for (i, j) in (0..=2).flat_map(|j| (0..=n).map(move |i| (i, j))) {
        deck += &format!("{}, {:?}, {:?}\n", node(i, j), a + (b - a) * i as f64 / n as f64, 0.25 * j as f64);
    }
    deck += "*ELEMENT, TYPE=CAX4, ELSET=tube\n";
    for (i, j) in (0..2).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let [k, l] = [node(i, j), node(i, j + 1)];
        deck += &format!("{}, {k}, {}, {}, {l}\n", 1 + i + n * j, k + 1, l + 1);
    }
    deck += &format!(
        "*NSET, NSET=low, GENERATE\n1, {}\n*NSET, NSET=high, GENERATE\n{}, {}\n*ELSET, ELSET=bore\n1, {}\n\
         *SURFACE, NAME=inner\nbore, S4\n*MATERIAL, NAME=metal\n*ELASTIC\n{young:?}, {poisson:?}\n\
         *SOLID SECTION, ELSET=tube, MATERIAL=metal\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*BOUNDARY\nlow, 2, 2\nhigh, 2, 2\n\
         *DLOAD\nbore, P4, {:?}\n*DSLOAD\ninner, P, {:?}\n*NODE PRINT, NSET=low, TOTALS=ONLY\nRF\n*END STEP\n",
        n + 1,
        node(0, 2),
        node(n, 2),
        n + 1,
        0.25 * p,
        0.75 * p
    );
    let (bench, _) = converted(&deck);
    assert!(scene(&bench).contains("axisymmetric = true"), "{}", scene(&bench));
    let run = bench.solve(1, &[]);
    let (points, moved) = (run.points("body.tube"), run.vectors(run.written(), "body.tube", "displacement"));
    for (x, u) in points.iter().zip(&moved).filter(|(x, _)| x[0] == a || x[0] == b) {
        let exact =
            (1.0 + poisson) * p * a * a / (young * (b * b - a * a)) * ((1.0 - 2.0 * poisson) * x[0] + b * b / x[0]);
        assert_small("widened", u[0] / exact - 1.0, 3e-3);
    }
    let ends = std::f64::consts::TAU * poisson * p * a * a;
    assert_close("ends", run.history().last("tube.low.fy"), -ends, 1e-4);

    let spring = "*ELEMENT, TYPE=SPRING1, ELSET=S\n900, 1\n*SPRING, ELSET=S\n2\n5.\n*STEP";
    let notes = converted(&deck.replacen("*STEP", spring, 1)).1.notes;
    assert!(notes.iter().any(|note| note.contains("*SPRING is that of the whole ring")), "{notes:#?}");
    let text = scene(&bench).replace("axisymmetric = true", "");
    bench.write("scene.toml", &text);
    let run = bench.run(1, &[]);
    assert!(run.code == 2 && run.stderr.contains("is of axisymmetric elements"), "{}", run.stderr);
    let (_, told) =
        refused(&deck.replace(
            "TYPE=CAX4, ELSET=tube\n",
            "TYPE=CAX3, ELSET=odd\n99, 1, 2, 11\n*ELEMENT, TYPE=CAX4, ELSET=tube\n",
        ));
    assert!(told.contains("element 99 of type CAX3 is not computed; mesh axisymmetric bodies with CAX4"), "{told}");
}

/// A ring of rubber, pressed between plates that hold it, with a pressure in its bore. CalculiX prints the forces of a wedge of two
/// degrees, without what acts on its sides.
#[test]
fn axisymmetric_rubber_is_that_of_calculix() {
    let run = solved(RING);
    let moved = run.vectors(run.written(), "body.pad", "displacement");
    // It counts what presses on the support's own nodes, too: on the end of the bore, which leans inwards from there on.
    let bore = run.points("body.pad").into_iter().zip(&moved).filter(|(x, _)| x[0] == 1.0 && x[1] > 0.0 && x[2] == 0.0);
    let next = bore.min_by(|(a, _), (b, _)| a[1].total_cmp(&b[1])).unwrap().1[0];
    let pressed = -2.0 * std::f64::consts::TAU * next * (1.0 / 3.0 + (1.0 + next) / 6.0);
    assert_close("force", run.history().last("pad.low.fy") + pressed, 180.0 * 1.036804, 3e-4);
    let node = run.points("body.pad").iter().position(|x| *x == [1.0, 0.5, 0.0]).unwrap();
    for (d, of_calculix) in [-3.153182E-02, -7.500000E-02].into_iter().enumerate() {
        assert_close("bore", moved[node][d], of_calculix, 2e-4);
    }
}

/// The axes of a part's orthotropic material turn with its instance: refused, not left behind.
#[test]
fn a_turned_instance_of_a_ply_is_refused() {
    let deck = |turn: &str| {
        format!(
            "*PART, NAME=P\n*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n5,0,0,1\n6,2,0,1\n7,2,1,1\n8,0,1,1\n\
             *ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,2,3,4,5,6,7,8\n\
             *ORIENTATION, NAME=FIBRE, SYSTEM=RECTANGULAR\n1,0,0,0,1,0\n\
             *SOLID SECTION, ELSET=EALL, MATERIAL=PLY, ORIENTATION=FIBRE\n*END PART\n\
             *ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n5,0,0\n{turn}*END INSTANCE\n\
             *NSET, NSET=FOOT, INSTANCE=I\n1,4,5,8\n*END ASSEMBLY\n\
             *MATERIAL, NAME=PLY\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1000,100,100,0.3,0.3,0.3,50,50\n50\n\
             *STEP, NLGEOM\n*STATIC\n1,1\n*BOUNDARY\nFOOT,1,3\n*END STEP\n"
        )
    };
    converted(&deck(""));
    let (_, said) = refused(&deck("5,0,0,5,0,1,90\n"));
    assert!(said.contains("an instance is turned, in a deck with an orthotropic material"), "{said}");
}

/// A cube of ten a side on its foot in two steps, with cards before the first.
fn cube(before: &str, first: &str, next: &str) -> String {
    format!(
        "*NODE\n1,0,0,0\n2,10,0,0\n3,10,10,0\n4,0,10,0\n5,0,0,10\n6,10,0,10\n7,10,10,10\n8,0,10,10\n\
         *ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=FOOT\n1,2,3,4\n*SURFACE, NAME=TOP, TYPE=ELEMENT\n1, S2\n\
         *MATERIAL, NAME=M\n*ELASTIC\n1e6, 0.\n*DENSITY\n1e-9\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n\
         *AMPLITUDE, NAME=PULSE\n0,0,.5,1,1,0\n*AMPLITUDE, NAME=LATE, TIME=TOTAL TIME\n0,0,1,1,1.5,1,2,2\n{before}\
         *STEP\n*STATIC\n.25,1.,,.25\n*BOUNDARY\nFOOT,1,3\n{first}*END STEP\n*STEP\n*STATIC\n.25,1.,,.25\n{next}*END STEP\n"
    )
}

/// A load that is given again with an amplitude is all that acts: nothing of the one before fades beside it. That the pulse begins with
/// a jump, which becomes a ramp over the first increment, is told.
#[test]
fn a_load_with_an_amplitude_takes_the_place_of_the_one_before() {
    let nodes = |value: &str| (5..9).map(|n| format!("{n}, 3, -{value}\n")).collect::<String>();
    let cases = [
        ("*DSLOAD\nTOP, P, 9.\n", "*DSLOAD, AMPLITUDE=PULSE\nTOP, P, 9.\n", [450.0, 900.0, 450.0, 0.0], true),
        (
            "*DSLOAD, AMPLITUDE=LATE\nTOP, P, 9.\n",
            "*DLOAD, OP=NEW\n*DSLOAD, AMPLITUDE=LATE\nTOP, P, 9.\n",
            [900.0, 900.0, 1350.0, 1800.0],
            false,
        ),
        ("*DLOAD\n1, P2, 9.\n", "*DLOAD, OP=NEW\n1, P2, 4.5\n", [787.5, 675.0, 562.5, 450.0], false),
        (
            "*DLOAD\nEALL, GRAV, 9e8, 0, 0, -1\n",
            "*DLOAD, AMPLITUDE=LATE, OP=NEW\nEALL, GRAV, 9e8, 0, 0, -1\n",
            [900.0, 900.0, 1350.0, 1800.0],
            false,
        ),
        (
            &format!("*CLOAD\n{}", nodes("225.00000001")),
            &format!("*CLOAD, AMPLITUDE=LATE\n{}", nodes("225.")),
            [900.0, 900.0, 1350.0, 1800.0],
            false,
        ),
    ];
    for (first, next, forces, jumps) in cases {
        let (bench, found) = converted(&cube("", first, next));
        let notes = found.notes.join("\n");
        assert_eq!(notes.contains("begins with a jump"), jumps, "{notes}");
        assert!(!notes.contains("takes off"), "{notes}");
        let history = bench.solve(1, &[]).history();
        let at = |time: f64| history.column("time").iter().position(|t| (t - time).abs() < 1e-9).unwrap();
        for (k, force) in forces.into_iter().enumerate() {
            let found = history.column("EALL.FOOT.fz")[at(1.25 + 0.25 * k as f64)];
            assert_small(&format!("{first}{next}{k}"), (found - force) / 900.0, 1e-9);
        }
    }
    // So it is of motions, also of one that a pulse begins with and ends without.
    let held = |card: &str, by: &str| format!("{card}\n5,3,3,{by}\n6,3,3,{by}\n7,3,3,{by}\n8,3,3,{by}\n");
    let late = "*AMPLITUDE, NAME=KNOCK\n0,1,1,0\n";
    for (name, shares) in [("PULSE", [0.5, 1.0, 0.5, 0.0]), ("KNOCK", [0.75, 0.5, 0.25, 0.0])] {
        let first = held("*BOUNDARY", if name == "PULSE" { "-0.01" } else { "0." });
        let (bench, _) = converted(&cube(late, &first, &held(&format!("*BOUNDARY, AMPLITUDE={name}"), "-0.01")));
        let history = bench.solve(1, &[]).history();
        let top = history.names().into_iter().find(|name| name.ends_with(".uz") && !name.contains("FOOT")).unwrap();
        for (k, share) in shares.into_iter().enumerate() {
            let now = history.column("time").iter().position(|t| (t - 1.25 - 0.25 * k as f64).abs() < 1e-9).unwrap();
            assert_small(&format!("{name} {k}"), history.column(&top)[now] / -0.01 - share, 1e-9);
        }
    }
    let both = "*DLOAD\nEALL, GRAV, 9e8, 0, 0, -1\n*DSLOAD\nTOP, P, 9.\n";
    let (_, found) = converted(&cube("", both, "*DSLOAD, OP=NEW\n"));
    assert!(found.notes.iter().any(|note| note.contains("takes off what *DLOAD has given, too")), "{:?}", found.notes);
}

/// The weight of a rigid body that moves freely is refused, the thickness of its shells told of; an included file may stand beside
/// its deck when the scene stands elsewhere.
#[test]
fn what_rigid_bodies_lose_is_told() {
    let plate = |elements: &str, section: &str| {
        format!(
            "*NODE\n11,-5,-5,10\n12,15,-5,10\n13,15,15,10\n14,-5,15,10\n15,-5,-5,12\n16,15,-5,12\n17,15,15,12\n18,-5,15,12\n20,5,5,12\n\
             21,5,5,12\n{elements}*RIGID BODY, ELSET=PLATE, REF NODE=20, ROT NODE=21\n{section}\
             *SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
             *CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE\nTOP, UNDER\n"
        )
    };
    let solid = plate(
        "*ELEMENT, TYPE=C3D8, ELSET=PLATE\n2,11,12,13,14,15,16,17,18\n*SURFACE, NAME=UNDER, TYPE=ELEMENT\nPLATE, S1\n",
        "*SOLID SECTION, ELSET=PLATE, MATERIAL=M\n",
    );
    let heavy = |set: &str, held: &str| {
        cube(&solid, &format!("20, 1, 2\n21, 1, 3\n{held}*DLOAD\n{set}, GRAV, 9e8, 0, 0, -1\n"), "")
    };
    let (_, said) = refused(&heavy("", ""));
    assert!(said.contains("gravity or a spin acts on the mass of a rigid body that moves freely"), "{said}");
    converted(&heavy("EALL", ""));
    converted(&heavy("", "20, 3, 3, 0.\n"));
    let shell = plate(
        "*ELEMENT, TYPE=S4, ELSET=PLATE\n2,11,14,13,12\n*SURFACE, NAME=UNDER, TYPE=ELEMENT\nPLATE, SPOS\n",
        "*SHELL SECTION, ELSET=PLATE, MATERIAL=M\n2.0\n",
    );
    let (_, found) = converted(&cube(&shell, "20, 1, 3\n21, 1, 3\n", ""));
    assert!(
        found.notes.iter().any(|note| note.contains("the thickness 2.0 of shells of a rigid body")),
        "{:?}",
        found.notes
    );

    // A group that is made includes the deck, which includes its mesh.
    let folder = tempfile::tempdir().unwrap();
    let deck = cube("", "5, 1\n6, 1\n*DLOAD\n1, P2, 9.\n", "");
    let (mesh, rest) = deck.split_at(deck.find("*NSET").unwrap());
    let [own, other] = ["own", "other"].map(|name| folder.path().join(name));
    [&own, &other].into_iter().for_each(|folder| fs::create_dir(folder).unwrap());
    fs::write(own.join("mesh.inp"), mesh).unwrap();
    fs::write(own.join("deck.inp"), format!("*INCLUDE, INPUT=mesh.inp\n{rest}")).unwrap();
    let found = convert(&own.join("deck.inp"), Some(&other.join("scene.toml"))).unwrap();
    assert!(found.groups.is_some());
    let run = common::nagata(&other, 1, &["check", "scene.toml"], other.join("out"));
    assert_eq!(run.code, 0, "{}", run.stderr);
}
