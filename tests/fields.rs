//! Fields of bodies and probes: stresses at nodes, strains, principal values, reactions; the same on any number of ranks.

mod common;

use common::{Bench, History, Run, assert_close, assert_small, on_ranks};
use nagata::Vec3;
use nagata::analysis::Simulation;
use nagata::estimate::nodal::jumps;
use nagata::estimate::recovery::Recovered;
use nagata::scene;
use petsc::Petsc;
use std::f64::consts::TAU;
use std::path::Path;

/// A bar drawn to so many times its length, free to contract, of hexahedra that are no cubes.
const STRETCH: f64 = 1.25;
const BAR: &str = r#"
[body.bar]
material = "rubber"
block = { box = { size = [4, 1, 2] }, elements = [4, 2, 3], grading = [2, 1, 3] }
[material.rubber]
model = "neo-hookean"
young = 10.0
poisson = 0.3
[[step]]
increments = 2
fix = [
    { set = "bar.xmin", directions = "x" }, { set = "bar.ymin", directions = "y" }, { set = "bar.zmin", directions = "z" },
]
move = [{ target = "bar.xmax", by = [1, 0, 0], directions = "x" }]
[output]
history = ["bar.xmin"]
fields = [
    "reaction", "nodal_stress", "nodal_von_mises", "nodal_principal_stress", "stress_jump", "nodal_strain", "stress",
    "von_mises", "principal_stress", "strain", "principal_strain",
]
probe = [
    { name = "inside", point = [1.1, 0.3, 0.7], fields = ["displacement", "nodal_stress", "nodal_principal_strain"] },
    { name = "end", set = "bar.xmax", fields = ["displacement", "nodal_von_mises"] },
]
"#;

/// A field of the body in an increment.
fn field(run: &Run, increment: usize, name: &str) -> Vec<f64> {
    run.field(&format!("increments/{increment:06}/body_bar/{name}"))
}

fn probe(run: &Run, name: &str) -> History {
    History::read(&run.out.join(format!("probe-{name}.csv")))
}

/// A layer stands under its weight: both planes of it share what the support bears, and nothing else is held.
#[test]
fn reactions_of_a_layer_add_up_to_its_weight() {
    let bench = Bench::new(
        r#"
[body.bar]
plane_strain = true
material = "m"
block = { box = { size = [2, 1, 1] }, elements = [2, 2, 1] }
[material.m]
model = "hooke"
young = 100.0
poisson = 0.3
density = 1.0
[[step]]
increments = 1
fix = [{ set = "bar.ymin" }]
gravity = [0, -1, 0]
[output]
history = ["bar", "bar.ymin", "bar.ymax"]
fields = ["reaction"]
"#,
    );
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let reactions = field(&run, 1, "node/reaction");
        let held = reactions.chunks_exact(3).filter(|r| r[1].abs() > 1e-12).count();
        let sum: f64 = reactions.iter().skip(1).step_by(3).sum();
        assert_eq!(held, 6);
        assert_close("of the field", sum, 2.0, 1e-12);
        for (set, weight) in [("bar", 2.0), ("bar.ymin", 2.0), ("bar.ymax", 0.0)] {
            assert_small(set, run.history().last(&format!("{set}.fy")) - weight, 1e-12);
        }
    }
}

/// A layer is held, and turned, by sets of one of its planes, or of both: each tells of all that the support bears.
#[test]
fn either_plane_of_a_layer_tells_of_all_of_its_support() {
    let deck = "*NODE\n1, 1, 0, 0\n2, 2, 0, 0\n3, 1, 1, 0\n4, 2, 1, 0\n5, 1, 0, 0.5\n6, 2, 0, 0.5\n7, 1, 1, 0.5\n8, 2, 1, 0.5\n\
        *ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 4, 3, 5, 6, 8, 7\n*NSET, NSET=LOW0\n1, 2\n*NSET, NSET=LOW1\n5, 6\n\
        *NSET, NSET=LOW\n1, 2, 5, 6\n*NSET, NSET=HIGH0\n3, 4\n*NSET, NSET=HIGH1\n7, 8\n*NSET, NSET=HIGH\n3, 4, 7, 8\n";
    let solved = |plane: &str| {
        let bench = Bench::new(&format!(
            "[body.bar]\nmesh = \"bar.inp\"\nmaterial = \"m\"\nplane_strain = true\n\
             [material.m]\nmodel = \"hooke\"\nyoung = 100.0\npoisson = 0.3\ndensity = 1.0\n\
             [[step]]\nincrements = 1\nfix = [{{ set = \"bar.LOW{plane}\" }}]\ngravity = [0, -1, 0]\n\
             move = [{{ target = \"bar.HIGH{plane}\", rotate = {{ point = [1.5, 0, 0], axis = [0, 0, 1], angle = 5 }} }}]\n\
             [output]\nhistory = [\"bar.LOW0\", \"bar.LOW1\", \"bar.LOW\", \"bar.HIGH{plane}\"]\n"
        ));
        bench.write("bar.inp", deck);
        bench.solve(1, &[]).history()
    };
    let both = solved("");
    let scale = both.last("bar.LOW.fx").abs();
    assert!(scale > 0.1 && both.last("bar.HIGH.moment").abs() > 0.1);
    for plane in ["0", "1", ""] {
        let history = solved(plane);
        for c in ["fx", "fy"] {
            for set in ["LOW0", "LOW1", "LOW"] {
                assert_close(c, history.last(&format!("bar.{set}.{c}")), both.last(&format!("bar.LOW.{c}")), 1e-9);
            }
        }
        let moment = history.last(&format!("bar.HIGH{plane}.moment"));
        assert_close("moment", moment, both.last("bar.HIGH.moment"), 1e-9);
    }
}

/// Uniform stress: all of it is the same everywhere, and nothing jumps.
#[test]
fn a_uniform_stretch() {
    let run = Bench::new(BAR).solve(1, &[]);
    let (stress, strain) = (field(&run, 2, "cell/stress"), field(&run, 2, "cell/strain"));
    assert_close("strain", strain[0], STRETCH.ln(), 1e-12);
    let scale = stress[0];
    assert!(scale > 1.0);
    let uniform = |name: &str, expected: &[f64], scale: f64| {
        let values = field(&run, 2, name);
        assert!(values.len() >= 24 * expected.len(), "{name}");
        let off = values.chunks(expected.len()).flat_map(|own| own.iter().zip(expected).map(|(a, b)| (a - b).abs()));
        assert_small(name, off.fold(0.0, f64::max) / scale, 1e-11);
    };
    uniform("node/nodal_stress", &stress[..6], scale);
    uniform("node/nodal_strain", &strain[..6], 1.0);
    uniform("node/stress_jump", &[0.0], scale);
    for name in ["node/nodal_von_mises", "cell/von_mises", "node/nodal_principal_stress_1", "cell/principal_stress_1"] {
        uniform(name, &[scale], scale);
    }
    uniform("cell/principal_stress_3", &[0.0], scale);
    uniform("cell/principal_strain_1", &[STRETCH.ln()], 1.0);
    uniform("cell/principal_strain_2", &[strain[1]], 1.0);

    // The force is the stress on the current area, and supports bear it from both ends.
    let area = 2.0 * (2.0 * strain[1]).exp();
    let (points, reaction) = (run.points("body.bar"), run.vectors(2, "body.bar", "reaction"));
    let at = |x: f64| points.iter().zip(&reaction).filter(move |(p, _)| p[0] == x).map(|(_, r)| r[0]).sum::<f64>();
    assert_close("reaction", at(4.0), scale * area, 1e-11);
    assert_close("other end", at(0.0), -scale * area, 1e-11);
    assert_close("history", run.history().last("bar.xmin.fx"), at(0.0), 1e-12);
    assert_small("inside", at(points.iter().map(|p| p[0]).find(|x| *x > 0.0 && *x < 4.0).unwrap()), 1e-9);

    // At rest in the beginning; fields that are not asked for are not there, and cost nothing.
    for name in ["cell/stress", "node/displacement", "node/nodal_stress", "node/reaction"] {
        assert!(field(&run, 0, name).iter().all(|value| *value == 0.0), "{name}");
    }
    let file = hdf5::File::open(run.out.join("fields.h5")).unwrap();
    assert!(!file.link_exists("increments/000002/body_bar/cell/error"));
    assert!(!run.out.join("fields-body_bar.vtkhdf").exists());
    meshio_has_the_fields(&run);
    let few = Bench::new(BAR).solve(1, &["--set", "output.fields=[\"reaction\"]"]);
    assert_eq!(few.summary()["carried"]["stress_fields"], 0);

    let inside = probe(&run, "inside");
    assert_close("displacement of the point", inside.last("displacement.x"), 1.1 * (STRETCH - 1.0), 1e-12);
    assert_close("stress of the point", inside.last("nodal_stress.xx"), scale, 1e-12);
    assert_close("strain of the point", inside.last("nodal_principal_strain_1"), STRETCH.ln(), 1e-12);
    assert_eq!(inside.len(), 2);
    let end = probe(&run, "end");
    for kind in ["mean", "min", "max"] {
        assert_close(kind, end.last(&format!("displacement.x.{kind}")), 1.0, 1e-12);
    }
    let thin = (strain[1].exp() - 1.0) * 2.0;
    assert_close("least", end.last("displacement.z.min"), thin, 1e-11);
    assert_small("largest", end.last("displacement.z.max"), 1e-12);
}

/// Bending of small strain: the stress goes with the height, and so it does at all nodes, also of tetrahedra's neighbours; of a single
/// layer, too, whose elements are of second order.
#[test]
fn a_linear_stress_is_recovered() {
    on_ranks("a_linear_stress_is_recovered", &[1, 2], |comm| {
        const CURVATURE: f64 = 1e-7;
        let petsc = Petsc::initialize(comm, &[]).unwrap();
        let of_one_layer = BAR
            .replace("elements = [4, 2, 3], grading = [2, 1, 3]", "elements = [8, 2, 2]")
            .replace("[body.bar]", "[body.bar]\nelement = \"hex27\"");
        for text in [BAR.to_string(), of_one_layer] {
            let scene = scene::parse("bar", &text.replace("0.3\n", "0.0\n"), Path::new("."), &[]).unwrap();
            let simulation = Simulation::new(comm, &petsc, &scene).unwrap();
            let model = simulation.model();
            // Even rows along x: the strain in the middle of an element is that of the parabola.
            let bent = |x: &Vec3| CURVATURE * Vec3::new(-x.x * x.y, 0.5 * x.x * x.x, 0.0);
            let u: Vec<Vec3> = model.part.points.iter().map(bent).collect();
            let recovered = Recovered::new(comm, model, &u).unwrap();
            for (n, x) in model.part.points.iter().enumerate() {
                let stress = recovered.stress(model, n);
                let expected = -10.0 * CURVATURE * x.y;
                assert!((stress[0] - expected).abs() < 1e-6 * 10.0 * CURVATURE, "{x:?}: {stress:?}");
            }
            let jumps = jumps(model, &recovered, &u).unwrap();
            assert!(jumps.iter().all(|jump| jump.is_finite()));
        }
    });
}

/// A beam, bent, of hexahedra or tetrahedra, linear or quadratic, askew, at whose end another body begins; and the place of a node in it.
fn beam(kind: &str) -> (Bench, [f64; 3]) {
    let askew = |[x, y, z]: [f64; 3]| {
        let bump = 0.05 * [x, y, z].iter().map(|x| (TAU * x).sin()).product::<f64>();
        [4.0 * x + bump, y + bump, z - bump]
    };
    let node = askew([0.4, 1.0 / 3.0, 2.0 / 3.0]);
    let bench = Bench::new(&format!(
        r#"
        [body.bar]
        mesh = "bar.msh"
        material = "rubber"
        [body.cap]
        material = "rubber"
        block = {{ box = {{ origin = [4, 0, 0], size = [1, 1, 1] }}, elements = [1, 1, 1] }}
        [material.rubber]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [[step]]
        increments = 2
        fix = [{{ set = "bar.xmin" }}, {{ set = "cap" }}]
        move = [{{ target = "bar.xmax", by = [0, 0, 0.5] }}]
        [output]
        every = 2
        vtkhdf = true
        fields = ["nodal_stress", "nodal_von_mises", "stress_jump", "reaction", "principal_strain"]
        probe = [
            {{ name = "node", point = {node:?} }},
            {{ name = "face", point = [4.0, 0.5, 0.5] }},
            {{ name = "other", point = [4.0, 0.5, 0.5], body = "cap" }},
            {{ name = "side", set = "bar.zmin" }},
            {{ name = "line", path = {{ from = [0.0, 0.4, 0.4], to = [5.0, 0.6, 0.55], points = 301 }} }},
        ]
        "#
    ));
    let mesh = match kind {
        "ten" => common::msh::second_order(&common::msh::block([5, 3, 3], true, askew)),
        _ => common::msh::block([5, 3, 3], kind == "tet", askew),
    };
    bench.write("bar.msh", &mesh);
    (bench, node)
}

#[test]
fn probes_and_fields_on_any_number_of_ranks() {
    for (kind, vtk) in [("hex", (12, 8)), ("tet", (10, 4)), ("ten", (24, 10))] {
        let (bench, at) = beam(kind);
        let [alone, shared] = [1, 2].map(|ranks| bench.solve(ranks, &[]));
        for name in ["node", "face", "other", "side", "line"] {
            // What iterations leave is more at corners to which stresses of second order are extrapolated.
            let tolerance = if kind == "ten" { 1e-9 } else { 1e-11 };
            assert_small(name, probe(&alone, name).difference(&probe(&shared, name)), tolerance);
        }
        same_fields(&alone, &shared);
        for run in [&alone, &shared] {
            vtk_has_the_fields(run, vtk);
        }

        // At a node it is the field; where bodies touch, that of the body that is meant.
        let points = alone.points("body.bar");
        let n = points.iter().position(|x| (0..3).all(|d| (x[d] - at[d]).abs() < 1e-12)).unwrap();
        let (node, stress) = (probe(&alone, "node"), alone.scalars(1, "body.bar", "nodal_stress"));
        let scale = stress.iter().fold(0.0f64, |most, s| most.max(s.abs()));
        assert_eq!(alone.written(), 1);
        for (k, part) in ["xx", "yy", "zz", "xy", "yz", "xz"].iter().enumerate() {
            let off = node.last(&format!("nodal_stress.{part}")) - stress[6 * n + k];
            assert_small(&format!("stress {part} at the node"), off / scale, 1e-12);
        }
        let von_mises = alone.scalars(1, "body.bar", "nodal_von_mises")[n];
        assert_close("von Mises at the node", node.last("nodal_von_mises"), von_mises, 1e-12);
        let moved = alone.vectors(1, "body.bar", "displacement")[n][2];
        assert_close("displacement of the node", node.last("displacement.z"), moved, 1e-12);
        assert_close("end of the beam", probe(&alone, "face").last("displacement.z"), 0.5, 1e-12);
        assert_eq!(probe(&alone, "other").last("displacement.z"), 0.0);
        let side = probe(&alone, "side");
        assert!(side.last("displacement.z.min") == 0.0 && side.last("displacement.z.max") == 0.5);

        // Along the line it goes on from element to element, but from body to body it does not.
        let line = probe(&alone, "line");
        assert_eq!(line.len(), 301);
        assert_close("end of the line", line.last("distance"), Vec3::new(5.0, 0.2, 0.15).norm(), 1e-12);
        for name in ["displacement.z", "nodal_stress.xx"] {
            let (values, x) = (line.column(name), line.column("x"));
            let in_beam = values.iter().zip(x).filter(|(_, x)| **x <= 4.0).map(|(value, _)| *value);
            let values: Vec<f64> = in_beam.collect();
            let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            let most = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!(values.len() == 241 && most < 0.05 * (high - low), "{kind} {name}: {most} of {low} {high}");
        }
    }
}

/// As the specification of VTKHDF has it: fields of all times one after the other, cells of one type with so many nodes.
fn vtk_has_the_fields(run: &Run, (cell, nodes): (u8, usize)) {
    let file = hdf5::File::open(run.out.join("fields-body_bar.vtkhdf")).unwrap();
    let read = |name: &str| file.dataset(&format!("VTKHDF/{name}")).unwrap().read_raw::<f64>().unwrap();
    let whole = |name: &str| file.dataset(&format!("VTKHDF/{name}")).unwrap().read_raw::<i64>().unwrap();
    assert_eq!(read("Steps/Values"), [0.0, 1.0]);
    let points = run.points("body.bar");
    assert_eq!(read("Points"), points.as_flattened());
    for (data, name, width) in [("PointData", "nodal_stress", 6), ("PointData", "stress_jump", 1)] {
        assert_eq!(whole(&format!("Steps/{data}Offsets/{name}")), [0, points.len() as i64]);
        let all = read(&format!("{data}/{name}"));
        assert_eq!(all.len(), 2 * points.len() * width);
        assert_eq!(all[points.len() * width..], run.scalars(1, "body.bar", name));
    }
    let types = file.dataset("VTKHDF/Types").unwrap().read_raw::<u8>().unwrap();
    assert!(types.len() >= 45 && types.iter().all(|own| *own == cell));
    let cells = run.field("grids/body_bar/cells");
    assert_eq!(whole("Connectivity").iter().map(|n| *n as f64).collect::<Vec<_>>(), cells);
    assert_eq!(whole("Offsets"), (0..=types.len() as i64).map(|k| k * nodes as i64).collect::<Vec<_>>());
    assert_eq!(read("CellData/principal_strain_1")[types.len()..], field(run, 1, "cell/principal_strain_1"));
}

/// As meshio's reader of series has it: a collection in time of nothing but uniform grids, each with its time and all of its
/// data by path.
fn meshio_has_the_fields(run: &Run) {
    let text = std::fs::read_to_string(run.out.join("fields-body_bar.xdmf")).unwrap();
    let (domain, grids) =
        text.split_once("</Domain>").unwrap().0.split_once("<Domain>\n").unwrap().1.split_once('\n').unwrap();
    assert_eq!(domain, r#"<Grid Name="fields" GridType="Collection" CollectionType="Temporal">"#);
    let grids: Vec<&str> = grids.split("<Grid ").skip(1).collect();
    assert_eq!(grids.len(), 3);
    let file = hdf5::File::open(run.out.join("fields.h5")).unwrap();
    for (k, grid) in grids.iter().enumerate() {
        let time = format!("\n<Time Value=\"{:?}\"/>\n", 0.5 * k as f64);
        assert!(grid.starts_with("Name=\"body.bar\" GridType=\"Uniform\">") && grid.contains(&time), "{grid}");
        let mut paths = Vec::new();
        for item in grid.split("<DataItem ").skip(1) {
            let (_, item) = item.split_once("Dimensions=\"").unwrap();
            let (shape, path) = item.split_once("\">fields.h5:").unwrap();
            let path = path.split('<').next().unwrap();
            let shape: Vec<usize> = shape.split(' ').map(|count| count.parse().unwrap()).collect();
            assert_eq!(file.dataset(path).unwrap().shape(), shape, "{path}");
            paths.push(path);
        }
        let begin = format!("/increments/{k:06}/body_bar");
        for path in ["/node/displacement", "/node/nodal_stress", "/cell/stress"].map(|name| format!("{begin}{name}")) {
            assert!(paths.contains(&path.as_str()), "{path}: {paths:?}");
        }
        assert_eq!(paths[..2], ["/grids/body_bar/cells", "/grids/body_bar/points"]);
    }
}

/// All fields of the beam in two runs, its points and elements in another order.
fn same_fields(one: &Run, other: &Run) {
    let key = |x: &[f64]| x.iter().map(|x| (x * 1e6).round() as i64).collect::<Vec<_>>();
    let order = |run: &Run| {
        let mut order: Vec<(Vec<i64>, usize)> =
            run.points("body.bar").iter().enumerate().map(|(n, x)| (key(x), n)).collect();
        order.sort();
        order
    };
    let (first, second) = (order(one), order(other));
    for (name, width) in [("nodal_stress", 6), ("nodal_von_mises", 1), ("stress_jump", 1), ("reaction", 3)] {
        let [own, others] = [one, other].map(|run| run.scalars(1, "body.bar", name));
        let scale = own.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        assert!(scale > 0.0);
        for ((at, n), (there, m)) in first.iter().zip(&second) {
            assert_eq!(at, there);
            let off = (0..width).map(|k| (own[width * n + k] - others[width * m + k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11 * scale, "{name} at {at:?}: {off:e} of {scale:e}");
        }
    }
    let sorted = |run: &Run| {
        let mut values = field(run, 1, "cell/principal_strain_1");
        values.sort_by(f64::total_cmp);
        values
    };
    let apart = sorted(one).iter().zip(sorted(other)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert_small("principal strain", apart, 1e-12);
}

#[test]
fn a_probe_outside_is_refused() {
    let bench = Bench::new(BAR);
    for ranks in [1, 2] {
        let run = bench.run(ranks, &["--set", "output.probe.inside.point=[1.1, 0.3, 2.75]"]);
        assert_eq!(run.code, 2, "{}", run.stderr);
        for word in ["probe `inside`", "is in no body", "nearest node", "of body `bar`", "0.8"] {
            assert!(run.stderr.contains(word), "{word}: {}", run.stderr);
        }
        assert!(!run.out.join("probe-inside.csv").exists());
    }
    let ask = |entry: &str| bench.run(1, &["--set", entry]).stderr;
    assert!(ask("output.probe.inside.fields=[\"stress\"]").contains("known: displacement, nodal_stress"));
    assert!(ask("output.probe.inside.fields=[]").contains("names no fields"));
    assert!(ask("output.fields=[\"mises\"]").contains("von_mises"));
    assert!(ask("output.probe.end.name=inside").contains("has the name of another probe"));
    assert!(ask("output.probe.end.point=[0, 0, 0]").contains("must look at one place"));
}

/// A cube that stands on a plane, of which the sides are slave faces, too, has the pressure of its bottom at all nodes of that, up to its
/// edges and corners.
#[test]
fn sides_that_bear_nothing_take_no_pressure() {
    for (element, discretization) in
        [("hex8", "one-pass"), ("hex8", "segment"), ("hex27", "one-pass"), ("hex27", "segment")]
    {
        let run = Bench::new(&format!(
            r#"
            body.b.material = "m"
            body.b.element = "{element}"
            body.b.block = {{ box = {{ size = [1, 1, 1] }}, elements = [4, 4, 4], faces = {{ all = ["ymin", "xmin", "xmax", "zmin", "zmax"] }} }}
            material.m = {{ model = "hooke", young = 100, poisson = 0 }}
            tool.floor.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
            contact.c = {{ slave = "b.all", master = "floor", discretization = "{discretization}" }}
            [[step]]
            increments = 1
            fix = [{{ set = "b.ymax", directions = "xz" }}]
            move = [{{ target = "b.ymax", by = [0, -0.1, 0], directions = "y" }}]
            "#
        ))
        .solve(2, &[]);
        // Cauchy stress of ln λ, over an area that stays.
        let right = run.history().last("floor.fy");
        let points = run.points("contact.c");
        let pressures = run.scalars(1, "contact.c", "pressure");
        let below = points.iter().zip(&pressures).filter(|(x, _)| x[1] == 0.0);
        let worst = below.map(|(_, p)| (p / right - 1.0).abs()).fold(0.0, f64::max);
        assert!(right > 10.0);
        assert_small(&format!("{element}, {discretization}"), worst, 1e-8);
    }
}

/// Nothing acts across planes of symmetry, whatever the points of segments next to them bear.
#[test]
fn tractions_lie_in_planes_of_symmetry() {
    let run = Bench::new(
        r#"
        body.b.material = "m"
        body.b.symmetry = ["xmin", "zmin"]
        body.b.block = { box = { size = [1, 1, 1] }, elements = [4, 4, 4] }
        material.m = { model = "hooke", young = 100, poisson = 0.3 }
        tool.ball.sphere = { center = [0, 2.5, 0], radius = 1.5 }
        contact.c = { slave = "b.ymax", master = "ball", friction = 0.2, discretization = "segment" }
        [[step]]
        increments = 3
        fix = [{ set = "b.ymin" }]
        move = [{ target = "ball", by = [0, -0.12, 0] }]
        "#,
    )
    .solve(2, &[]);
    let tractions = run.vectors(3, "contact.c", "traction");
    let along: f64 = tractions.iter().map(|t| t[0].hypot(t[2])).fold(0.0, f64::max);
    let in_planes = run.points("contact.c").into_iter().zip(tractions);
    let across = in_planes
        .map(|(x, t)| f64::max(if x[0] == 0.0 { t[0].abs() } else { 0.0 }, if x[2] == 0.0 { t[2].abs() } else { 0.0 }));
    let across = across.fold(0.0, f64::max);
    assert!(along > 0.01 && across < 1e-12 * along, "{across} {along}");
}
