//! Surfaces that meet themselves.

use crate::case::Case;
use crate::common::msh::{block, together};
use crate::oracle::{balance, same, scaled, value};
use crate::scenes::bar_force;
use std::collections::HashSet;
use std::fmt::Write;

family!(frictions, segments, units, offsets, both_sides, ranks, cubes);

/// A hairpin of an elastic strip, 40 long: its lips are pressed together, then its legs, which roll onto each other.
const MESH: &str = include_str!("../../inputs/c-strip.msh");

/// The mesh, or its upper half, with its lengths times `length` and then moved by `offset` along all axes.
fn mesh(length: f64, offset: f64, is_half: bool) -> String {
    let (head, rest) = MESH.split_once("$Nodes\n").unwrap();
    let (nodes, rest) = rest.split_once("$EndNodes\n$Elements\n").unwrap();
    let (elements, _) = rest.split_once("$EndElements").unwrap();
    let (mut kept, mut places, mut count) = (HashSet::new(), String::new(), 0);
    for line in nodes.lines().skip(1) {
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        if words[2] >= 0.0 || !is_half {
            let at = |d: usize| words[d] * length + offset;
            kept.insert(words[0] as usize);
            let _ = writeln!(places, "{} {:?} {:?} {:?}", words[0], at(1), at(2), at(3));
        }
    }
    let is_whole = |line: &&str| line.split(' ').skip(5).all(|node| kept.contains(&node.parse().unwrap()));
    let elements: Vec<&str> = elements.lines().skip(1).filter(is_whole).collect();
    count += kept.len();
    let (n, elements) = (elements.len(), elements.join("\n"));
    format!("{head}$Nodes\n{count}\n{places}$EndNodes\n$Elements\n{n}\n{elements}\n$EndElements\n")
}

fn scene(length: f64, modulus: f64, contact: &str, fix: &str, legs: &[(&str, f64)]) -> String {
    let moved = |part: &str, by: f64| {
        let of = |(leg, sign): &(&str, f64)| {
            format!(
                "{{ target = \"strip.{part}-{leg}\", by = [0.0, {:?}, 0.0], directions = \"y\" }}",
                -sign * by * length
            )
        };
        legs.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let of = |part: &str| legs.iter().map(|(leg, _)| format!("\"strip.{part}-{leg}\", ")).collect::<String>();
    let held: String =
        legs.iter().map(|(leg, _)| format!(", {{ set = \"strip.lip-{leg}\", directions = \"y\" }}")).collect();
    format!(
        r#"[body.strip]
mesh = "strip.msh"
material = "rubber"
plane_strain = true
[material.rubber]
model = "neo-hookean"
young = {:?}
poisson = 0.3
{contact}
[[step]]
name = "close"
increments = 5
fix = [{fix}]
move = [{}]
[[step]]
name = "roll"
increments = 5
fix = [{fix}{held}]
move = [{}]
[output]
every = 1000
history = [{}{}"strip.bend"]
"#,
        100.0 * modulus,
        moved("lip", 4.1),
        moved("leg", 2.0),
        of("lip"),
        of("leg")
    )
}

/// By symmetry each leg is as half a strip on a smooth plane, whatever the friction; and its forces go with the square of the
/// length and the modulus.
fn strip(name: String, sizes: [f64; 3], tolerance: f64) -> Case {
    strip_by("one-pass", name, sizes, tolerance)
}

fn strip_by(discretization: &str, name: String, [length, modulus, offset]: [f64; 3], tolerance: f64) -> Case {
    let how = if discretization == "segment" { "\ndiscretization = \"segment\"" } else { "" };
    let plane = "[tool.plane]\nplane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }\n[contact.inside]\nslave = \"strip.inside\"\nmaster = \"plane\"";
    let symmetric = "{ set = \"strip.bend\", directions = \"x\" }, { set = \"strip.cut\", directions = \"y\" }";
    let half = Case::text("half", scene(1.0, 1.0, &format!("{plane}{how}"), symmetric, &[("top", 1.0)]))
        .file("strip.msh", mesh(1.0, 0.0, true));
    let itself = "[contact.inside]\nslave = \"strip.inside\"\nmaster = \"strip.inside\"";
    let legs = [("top", 1.0), ("bottom", -1.0)];
    let case = Case::text(name, scene(length, modulus, &format!("{itself}{how}"), "{ set = \"strip.bend\" }", &legs))
        .file("strip.msh", mesh(length, offset, false));
    ["lip-top", "leg-top"]
        .iter()
        .fold(case, |case, part| {
            let times = length * length * modulus;
            case.oracle(scaled(&format!("strip.{part}.fy"), half.clone(), times, tolerance, "half on a plane"))
        })
        .oracle(value("strip.leg-top.fy/strip.leg-bottom.fy", -1.0, tolerance, "symmetry"))
        .oracle(balance(
            &["strip.lip-top", "strip.lip-bottom", "strip.leg-top", "strip.leg-bottom", "strip.bend"],
            tolerance,
        ))
}

/// mu = 0 to 5, in one increment and in many. Of facets tips stand on tips, and slide off to either side, but in 20 increments and up
/// to mu = 1.
fn frictions() -> Vec<Case> {
    let mut cases = Vec::new();
    for (smoothing, tolerance, increments) in [("nagata", 1e-5, &[1, 5, 20, 200][..]), ("facet", 1e-4, &[20])] {
        for mu in ["0.0", "0.2", "1.0", "5.0"] {
            for &n in increments.iter().filter(|_| smoothing == "nagata" || mu != "5.0") {
                let case = strip(format!("mu = {mu}, {n} increments, {smoothing}"), [1.0, 1.0, 0.0], tolerance)
                    .set(format!("contact.inside.friction={mu}"))
                    .set(format!("contact.inside.smoothing={smoothing}"))
                    .set(format!("step.close.increments={n}"))
                    .set(format!("step.roll.increments={n}"))
                    .must_run()
                    .limit(400);
                cases.push(case.quick_if(n == 5 && smoothing == "nagata" && mu != "1.0"));
            }
        }
    }
    cases
}

/// The same from segment to segment: what faces bulge by in the initial mesh counts once between the legs, and for each of them on the
/// plane; of facets on the plane alone.
fn segments() -> Vec<Case> {
    let mut cases = Vec::new();
    for (smoothing, tolerance) in [("nagata", 1e-2), ("facet", 5e-2)] {
        for mu in ["0.0", "0.2", "1.0", "5.0"] {
            for n in [1, 5, 20, 200] {
                let name = format!("mu = {mu}, {n} increments, {smoothing}");
                let case = strip_by("segment", name, [1.0, 1.0, 0.0], tolerance)
                    .set(format!("contact.inside.friction={mu}"))
                    .set(format!("contact.inside.smoothing={smoothing}"))
                    .set(format!("step.close.increments={n}"))
                    .set(format!("step.roll.increments={n}"))
                    .limit(400);
                cases.push(case.quick_if(n == 5 && smoothing == "nagata" && mu == "0.2"));
            }
        }
    }
    cases
}

/// Lengths of 1e-9 and 1e9, moduli of 1e-6 and 1e18.
fn units() -> Vec<Case> {
    let mut cases = Vec::new();
    for length in [1e-9, 1.0, 1e9] {
        for modulus in [1e-8, 1.0, 1e16] {
            for mu in ["0.0", "0.2", "5.0"] {
                let name = format!("lengths times {length:e}, E times {modulus:e}, mu = {mu}");
                let case = strip(name, [length, modulus, 0.0], 1e-5).set(format!("contact.inside.friction={mu}"));
                let is_quick = mu == "0.2" && (length, modulus) != (1.0, 1.0) && (length > 1.0) == (modulus < 1.0);
                cases.push(case.must_run().quick_if(is_quick));
            }
        }
    }
    cases
}

/// So many times its length away from the origin, to which the place of a node is rounded.
fn offsets() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [1, 2, 4, 6, 8] {
        for mu in ["0.0", "0.2"] {
            let case = strip(format!("1e{power} sizes, mu = {mu}"), [1.0, 1.0, 40.0 * 10f64.powi(power)], 1e-4)
                .set(format!("contact.inside.friction={mu}"));
            let case = if power <= 2 { case.must_run() } else { case };
            cases.push(case.quick_if(power == 2 && mu == "0.2"));
        }
    }
    cases
}

/// All of the skin may meet itself: the outside and the tips stay free.
fn both_sides() -> Vec<Case> {
    let mut cases = Vec::new();
    for mu in ["0.0", "0.2", "1.0", "5.0"] {
        for n in [1, 5, 20] {
            let case = strip(format!("mu = {mu}, {n} increments"), [1.0, 1.0, 0.0], 1e-5)
                .sets(["contact.inside.slave=strip.skin", "contact.inside.master=strip.skin"])
                .set(format!("contact.inside.friction={mu}"))
                .set(format!("step.close.increments={n}"))
                .set(format!("step.roll.increments={n}"));
            cases.push(case.must_run().quick_if(n == 1 && mu == "0.2"));
        }
    }
    cases
}

fn ranks() -> Vec<Case> {
    let mut cases = Vec::new();
    for ranks in [2, 3, 4, 7] {
        for mu in ["0.2", "5.0"] {
            let case = strip(format!("{ranks} ranks, mu = {mu}"), [1.0, 1.0, 0.0], 1e-5).ranks(ranks);
            let case = case.set(format!("contact.inside.friction={mu}"));
            cases.push(case.must_run().quick_if(ranks == 2 && mu == "0.2"));
        }
    }
    cases
}

/// A mesh of two blocks, of whose group `all` only the faces between them are left.
fn between(mesh: &str) -> String {
    let (head, elements) = mesh.split_once("$Elements\n").unwrap();
    let lines: Vec<&str> = elements.lines().skip(1).take_while(|line| !line.starts_with('$')).collect();
    // After the facet in `all`, the second group, it stands in that of its side: `zmax0` is the eighth, `zmin1` the thirteenth.
    let group = |k: usize| lines[k].split(' ').nth(3).unwrap();
    let is_kept = |k: usize| group(k) != "2" || ["8", "13"].contains(&group(k + 1));
    let kept: Vec<&str> = (0..lines.len()).filter(|k| is_kept(*k)).map(|k| lines[k]).collect();
    format!("{head}$Elements\n{}\n{}\n$EndElements\n", kept.len(), kept.join("\n"))
}

/// Two cubes of one mesh, 0.05 apart, whose faces may meet each other, are pressed: an even pressure. Then the upper is drawn
/// sideways: where all sticks both are one body.
fn cubes() -> Vec<Case> {
    let scene = |contact: &str, top: &str, down: f64| {
        let step = |name: &str, by: [f64; 3]| {
            format!(
                "[[step]]\nname = \"{name}\"\nincrements = 4\nfix = [{{ set = \"cubes.zmin0\" }}]\nmove = [{{ target = \"cubes.{top}\", by = {by:?} }}]\n"
            )
        };
        format!(
            "[body.cubes]\nmesh = \"cubes.msh\"\nmaterial = \"soft\"\nelement = \"hex8\"\n[material.soft]\nmodel = \"hooke\"\nyoung = 100.0\npoisson = 0.0\n{contact}{}{}[output]\nevery = 1000\nhistory = [\"cubes.zmin0\", \"cubes.{top}\"]\n",
            step("press", [0.0, 0.0, -down]),
            step("draw", [0.01, 0.0, 0.0])
        )
    };
    let lower = block([3, 3, 3], false, |p| p);
    let upper = block([3, 3, 3], false, |[x, y, z]| [x, y, z + 1.05]);
    let one = Case::text("one body", scene("", "zmax0", 0.2))
        .file("cubes.msh", together(&[&block([3, 3, 6], false, |[x, y, z]| [x, y, 2.0 * z])]));
    let mut cases = Vec::new();
    for mu in ["0.0", "0.2", "1.0", "5.0"] {
        for smoothing in ["nagata", "facet"] {
            for n in [1, 4, 100] {
                let contact = format!("[contact.c]\nslave = \"cubes.all\"\nmaster = \"cubes.all\"\nfriction = {mu}\n");
                let case =
                    Case::text(format!("mu = {mu}, {n} increments, {smoothing}"), scene(&contact, "zmax1", 0.25))
                        .file("cubes.msh", between(&together(&[&lower, &upper])))
                        .set(format!("step.press.increments={n}"))
                        .set(format!("contact.c.smoothing={smoothing}"))
                        .oracle(value("cubes.zmin0.fz@press", -bar_force(100.0, 1.0, 0.9), 1e-6, "closed form"))
                        .oracle(balance(&["cubes.zmin0", "cubes.zmax1"], 1e-8));
                // What slips stands over at its ends, and leans there.
                let case = match mu {
                    "0.0" | "0.2" => case,
                    _ => case.oracle(same("cubes.zmin0.fx", one.clone(), 1e-4, "one body")),
                };
                cases.push(case.must_run().quick_if(n == 4 && smoothing == "nagata" && mu != "0.2"));
            }
        }
    }
    cases
}
