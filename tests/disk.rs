//! An elastic disk in a bore of nearly the same radius, with friction, driven by a force from where they touch.

mod common;

use common::{Bench, Run, assert_close, assert_small};

/// The scene of `inputs/`, with its mesh.
fn scene(step: Option<&str>) -> Bench {
    let folder = env!("CARGO_MANIFEST_DIR");
    let scene = std::fs::read_to_string(format!("{folder}/inputs/disk-in-plate.toml")).unwrap();
    let bench = Bench::new(&match step {
        Some(steps) => format!("{}{steps}", &scene[..scene.find("[[step]]").unwrap()]),
        None => scene,
    });
    bench.write("disk-in-plate.msh", include_str!("../inputs/disk-in-plate.msh"));
    bench
}

const RADIUS: f64 = 10.0;
/// E* times the clearance, N/mm.
const UNIT: f64 = 210e3 / (2.0 * (1.0 - 0.3 * 0.3)) * 0.004;

/// A node of the rim: degrees from the lowest, status, tractions times R/Q.
struct Node {
    angle: f64,
    status: f64,
    pressure: f64,
    shear: f64,
    /// |F_t| / |F_n|.
    lean: f64,
}

/// The nodes in contact at the end of a run, from the lowest.
fn nodes(run: &Run, contact: &str, force: f64) -> Vec<Node> {
    let last = run.written();
    let vectors = |name: &str| run.vectors(last, contact, name);
    let scalars = |name: &str| run.scalars(last, contact, name);
    let (status, pressure) = (scalars("status"), scalars("pressure"));
    let (normal, traction, forces) = (vectors("normal"), vectors("traction"), vectors("force"));
    let mut nodes = Vec::new();
    for (i, [x, y, z]) in run.points(contact).into_iter().enumerate().filter(|(_, p)| p[2] == 0.0) {
        assert_eq!(z, 0.0);
        let ([nx, ny, _], [fx, fy, _]) = (normal[i], forces[i]);
        nodes.push(Node {
            angle: x.atan2(-y - 0.004).to_degrees(),
            status: status[i],
            pressure: pressure[i] * RADIUS / force,
            shear: (traction[i][0] * ny - traction[i][1] * nx) * RADIUS / force,
            lean: (fx * ny - fy * nx).abs() / (fx * nx + fy * ny).abs(),
        });
    }
    nodes.retain(|n| n.status > 0.0);
    nodes.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    nodes
}

fn at(nodes: &[Node], angle: f64) -> &Node {
    nodes.iter().find(|n| (n.angle - angle).abs() < 1e-6).unwrap()
}

/// The angle at which the pressure ends: that of a parabola through its squares at the three nodes before the last,
/// whose area is in part outside.
fn end_of_contact(nodes: &[Node]) -> f64 {
    let before = &nodes[nodes.len() - 4..nodes.len() - 1];
    let [f2, f1, f0] = [0, 1, 2].map(|k| before[k].pressure.powi(2));
    let (slope, bend) = ((3.0 * f0 - 4.0 * f1 + f2) / 2.0, (f0 - 2.0 * f1 + f2) / 2.0);
    let t = common::root(0.0, 3.0, |t| f0 + slope * t + bend * t * t);
    before[2].angle + t * (before[2].angle - before[1].angle)
}

/// All that the force brings in goes through the contact and out of the plate; slipping nodes are on the cone.
fn check_balance_and_cone(run: &Run, contact: &str, outside: &str, nodes: &[Node], force: f64) {
    let history = run.history();
    assert_close("force through the contact", history.last(&format!("{contact}.fy")), 0.5 * force, 1e-8);
    assert_close("force on the support", history.last(&format!("{outside}.fy")), 0.5 * force, 1e-8);
    let off = nodes.iter().filter(|n| n.status == 2.0).fold(0.0f64, |worst, n| worst.max((n.lean / 0.4 - 1.0).abs()));
    assert_small("friction cone", off, 1e-8);
    assert!(nodes.iter().all(|n| n.lean < 0.4 * (1.0 + 1e-8)));
}

/// `scripts/studies/disk-theory.py`, friction 0.4, Poisson's ratio 0.3, plate fixed at ten radii: degrees, p R/Q, s R/Q
/// when the contact reaches to 60 degrees; s is largest at 41.5 degrees.
const THEORY: [(f64, f64, f64); 12] = [
    (0.0, 0.6146, 0.0),
    (5.0, 0.6128, 0.0188),
    (10.0, 0.6063, 0.0376),
    (15.0, 0.5956, 0.0565),
    (20.0, 0.5803, 0.0756),
    (25.0, 0.5601, 0.0947),
    (30.0, 0.5347, 0.1142),
    (35.0, 0.5034, 0.1343),
    (40.0, 0.4649, 0.1595),
    (45.0, 0.4176, 0.1670),
    (50.0, 0.3529, 0.1412),
    (55.0, 0.2575, 0.1030),
];
const STICK: f64 = 41.25;
const LARGEST_SHEAR: f64 = 0.181;
/// Forces over E* times the clearance at which the contact reaches to 10, 20, ... 60 degrees.
const FORCES: [f64; 6] = [0.02434, 0.10263, 0.25290, 0.51465, 0.97300, 1.83546];
/// dQ / d(angle) over Q there, per degree, from 58 and 62 degrees.
const GROWTH: f64 = 0.0661;

/// The contact grows by about a node an increment.
#[test]
fn tractions_are_those_of_theory() {
    let steps: String = FORCES.iter().map(|force| step(0.5 * force * UNIT, 6)).collect();
    let run = scene(Some(&format!("{steps}[output]\nevery = 100\nhistory = [\"plate.outside\"]\n"))).solve(2, &[]);
    let force = FORCES[5] * UNIT;
    let nodes = nodes(&run, "contact.bore", force);
    check_balance_and_cone(&run, "bore", "plate.outside", &nodes, force);
    assert_eq!(run.summary()["cutbacks"], 0);
    assert_eq!(nodes.len(), 37);
    for (angle, pressure, shear) in THEORY {
        let node = at(&nodes, angle);
        assert_small(&format!("pressure at {angle}"), (node.pressure - pressure) / THEORY[0].1, 0.003);
        assert_small(&format!("shear at {angle}"), (node.shear - shear) / LARGEST_SHEAR, 0.02);
    }
    let slip = nodes.iter().position(|n| n.status == 2.0).unwrap();
    assert!(nodes[slip..].iter().all(|n| n.status == 2.0));
    let (inner, outer) = (nodes[slip - 1].angle, nodes[slip].angle);
    assert!(inner < STICK && STICK < outer, "sticks to {inner}, slips from {outer}");
    let growth = GROWTH * (60.0 - end_of_contact(&nodes));
    assert_small("force when the contact reaches to 60 degrees", growth, 0.02);
}

/// Slip in one direction for a whole increment leaves more friction than the same by and by. Theory, loads in equal
/// increments from where the disk touches: s R/Q at 10, 20 and 30 degrees, and the angle to which nodes stick.
#[test]
fn friction_depends_on_the_increments() {
    let theory = [(1, [0.0258, 0.0638], 30.0), (5, [0.0298, 0.0830], 40.0)];
    for (increments, shear, stick) in theory {
        let count = format!("step.press.increments={increments}");
        let run = scene(None).solve(2, &["--set", &count, "--set", "output.every=100"]);
        let nodes = nodes(&run, "contact.bore", 1.8355 * UNIT);
        for (angle, shear) in [10.0, 20.0].into_iter().zip(shear) {
            let error = (at(&nodes, angle).shear - shear) / LARGEST_SHEAR;
            assert_small(&format!("shear at {angle} after {increments}"), error, 0.02);
        }
        let sticks = nodes.iter().rfind(|n| n.status == 1.0).unwrap();
        assert_small("angle to which nodes stick", sticks.angle - stick, 1.0 + 180.0 / 108.0);
    }
}

/// A coarse disk with a small hole, pulled down at its edge; `lift` is a gap below it.
fn coarse(contact: &str, lift: f64) -> Bench {
    let sector = |center: f64, radii: [f64; 2], elements: usize, grading: f64| {
        format!(
            "material = \"steel\"\nplane_strain = true\nblock = {{ sector = {{ center = [0.0, {center:?}, 0.0], \
             radii = {radii:?}, angles = [-90.0, 90.0], length = 1.0 }}, elements = [{elements}, 36, 1], \
             grading = [{grading:?}, 1.0, 1.0] }}\n"
        )
    };
    Bench::new(&format!(
        r#"
        [body.disk]
        {}
        [body.plate]
        {}
        [material.steel]
        model = "hooke"
        young = 210000.0
        poisson = 0.3
        [contact.bore]
        slave = "disk.rmax"
        master = "plate.rmin"
        friction = 0.4
        {contact}
        [[step]]
        increments = 12
        fix = [
            {{ set = "plate.rmax" }},
            {{ set = "plate.amin", directions = "x" }}, {{ set = "plate.amax", directions = "x" }},
            {{ set = "disk.amin", directions = "x" }}, {{ set = "disk.amax", directions = "x" }},
        ]
        force = [{{ target = "disk.rmin", total = [0.0, {:?}, 0.0] }}]
        [output]
        every = 100
        history = ["plate.rmax", "disk.rmax"]
        "#,
        sector(lift - 0.004, [0.5, 9.996], 10, 0.4),
        sector(0.0, [10.0, 100.0], 10, 30.0),
        -0.5 * FORCES[5] * UNIT,
    ))
}

#[test]
fn coarse_disk_on_any_number_of_ranks() {
    let bench = coarse("", 0.0);
    let run = bench.solve(1, &[]);
    let force = FORCES[5] * UNIT;
    let nodes = nodes(&run, "contact.bore", force);
    check_balance_and_cone(&run, "bore", "plate.rmax", &nodes, force);
    for (angle, pressure, shear) in THEORY {
        let Some(node) = nodes.iter().find(|n| (n.angle - angle).abs() < 1e-6) else { continue };
        assert_small(&format!("pressure at {angle}"), (node.pressure - pressure) / THEORY[0].1, 0.02);
        // Twelve increments leave waves, where the contact stuck while it grew.
        assert_small(&format!("shear at {angle}"), (node.shear - shear) / LARGEST_SHEAR, 0.1);
    }
    let history = run.history();
    for ranks in [2, 3] {
        let other = bench.solve(ranks, &[]);
        let rows = other.history();
        let sets = ["plate.rmax", "disk.rmax"];
        let worst = (0..history.len()).map(|k| history.row_difference(k, &rows, k, &sets)).fold(0.0, f64::max);
        assert_small(&format!("{ranks} ranks, forces and displacements"), worst, 1e-8);
        for (a, b) in nodes.iter().zip(self::nodes(&other, "contact.bore", force)) {
            assert_eq!((a.angle, a.status), (b.angle, b.status));
            assert_small(&format!("{ranks} ranks, pressure"), a.pressure - b.pressure, 1e-8);
            assert_small(&format!("{ranks} ranks, shear"), a.shear - b.shear, 1e-8);
        }
    }
}

/// The ways in which forces go to the master hardly differ where its nodes face those of the slave.
#[test]
fn transfers_and_facets() {
    let force = FORCES[5] * UNIT;
    let mut patch = Vec::new();
    for contact in ["", "transfer = \"variational\"", "transfer = \"bilinear\"", "smoothing = \"facet\""] {
        let run = coarse(contact, 0.0).solve(2, &[]);
        let nodes = nodes(&run, "contact.bore", force);
        check_balance_and_cone(&run, "bore", "plate.rmax", &nodes, force);
        println!("{contact}: {} nodes, {} iterations", nodes.len(), run.summary()["iterations"]);
        if patch.is_empty() {
            patch = nodes;
        } else if contact.starts_with("transfer") {
            for (node, other) in nodes.iter().zip(&patch) {
                assert_small(contact, (node.pressure - other.pressure) / THEORY[0].1, 0.005);
                assert_small(contact, (node.shear - other.shear) / LARGEST_SHEAR, 0.01);
            }
        }
    }
}

/// A body that only a force drives starts from what it touches, also where rounding leaves a gap; not from afar.
#[test]
fn a_force_drives_what_touches() {
    let first = ["--set", "step.0.increments=2"];
    let touching = coarse("", 0.0).solve(2, &first).history();
    for lift in [1e-6, -1e-6] {
        let lifted = coarse("", lift).solve(2, &first).history();
        assert_eq!(lifted.len(), 2);
        assert_close("force across", lifted.last("bore.fx"), touching.last("bore.fx"), 1e-3);
    }
    let run = coarse("", 1e-3).run(2, &[]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("body `disk` can move along y"), "{}", run.stderr);
    assert!(run.stderr.contains("what touches at the start does not hold that (contact `bore`"), "{}", run.stderr);
}

fn step(force: f64, increments: usize) -> String {
    format!(
        r#"
        [[step]]
        increments = {increments}
        fix = [
            {{ set = "plate.outside" }},
            {{ set = "plate.below", directions = "x" }},
            {{ set = "plate.above", directions = "x" }},
            {{ set = "disk.axis", directions = "x" }},
        ]
        force = [{{ target = "disk.centre", total = [0.0, {:?}, 0.0] }}]
        "#,
        -force
    )
}
