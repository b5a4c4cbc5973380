//! One tool in several descriptions: they are the same surface as far as each can be, on any number of ranks.

mod common;

use common::{Bench, History, assert_close, assert_small, msh, on_ranks};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use nagata::Vec3;
use nagata::controls::Controls;
use nagata::scene::{Description, Tool, load_tools};
use nagata::tool::{Surface, describe};
use std::path::{Path, PathBuf};

fn inputs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs")
}

/// The indenter of the ironing scene on a coarse slab, pressed by 10 mm.
fn press(smoothing: &str, ranks: usize) -> History {
    let bench = Bench::new(&std::fs::read_to_string(inputs().join("ironing-rigid.toml")).unwrap());
    for name in ["ironing-indenter.msh", "ironing-indenter.igs", "ironing-indenter.bpt"] {
        std::fs::copy(inputs().join(name), bench.path(name)).unwrap();
    }
    let mut arguments = vec!["--steps", "1"];
    let sets = ["body.slab.block.elements=[60, 10, 1]", "step.press.increments=4"];
    let smoothing = format!("tool.indenter.smoothing={smoothing}");
    for set in sets.into_iter().chain([smoothing.as_str()]) {
        arguments.extend(["--set", set]);
    }
    bench.solve(ranks, &arguments).history()
}

/// The exact descriptions give the same forces, the others forces that are off by as much as their shape is: Nagata's
/// quarter circles of four patches by 1.9e-5 of the radius, the cubic one by 2.7e-4.
#[test]
fn they_press_alike() {
    let exact = press("profile", 2);
    assert_small("profile on one rank", press("profile", 1).difference(&exact), 1e-8);
    for (smoothing, tolerance) in [("nurbs", 1e-8), ("bezier", 1e-3), ("nagata", 5e-4)] {
        let other = press(smoothing, 2);
        assert_small(smoothing, press(smoothing, 1).difference(&other), 1e-8);
        for column in ["indenter.fx", "indenter.fy"] {
            assert_close(&format!("{smoothing}: {column}"), other.last(column), exact.last(column), tolerance);
        }
    }
}

/// A block that overhangs a table by five of its facets, under a pressure.
fn overhang(table: &str, contact: &str) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.block]
        material = "soft"
        block = {{ box = {{ origin = [0.5, 0.5, 0.0], size = [12.0, 3.0, 1.5] }}, elements = [24, 6, 2] }}
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        {table}
        [contact.sole]
        slave = "block.zmin"
        {contact}
        [[step]]
        increments = 1
        fix = [{{ set = "block.xmin", directions = "x" }}, {{ set = "block.ymin", directions = "y" }}]
        pressure = [{{ set = "block.zmax", value = 0.5 }}]
        "#
    ));
    let table = |x: f64, y: f64| [10.0 * x, 4.0 * y, 0.0];
    for facets in [1, 2, 20] {
        bench.write(&format!("table-{facets}.msh"), &msh::surface(facets, table));
    }
    let corners = [[0, 0], [10, 0], [0, 4], [10, 4]].map(|[x, y]| format!("{x} {y} 0\n"));
    bench.write("table.bpt", &format!("1\n1 1\n{}", corners.concat()));
    bench
}

/// Nothing holds up what reaches over the end of a table, be that one face of CAD or hundreds of facets, whatever is in reach.
#[test]
fn what_reaches_over_an_end_hangs() {
    let rise = |bench: &Bench, ranks: usize| {
        let run = bench.solve(ranks, &[]);
        let tips = run.vectors(run.written(), "body_block", "displacement");
        (run.history().last("sole.active"), tips.iter().map(|u| u[2]).fold(0.0, f64::min))
    };
    let tool =
        |of: &str, reach: &str| overhang(&format!("[tool]\ntable = {{ {of} }}"), &format!("master = \"table\"{reach}"));
    let (active, tip) = rise(
        &tool(
            "profile = { points = [[0.0, 0.0], [10.0, 0.0]], extrude = { origin = [0, 4, 0], x = [1, 0, 0], y = [0, 0, 1], length = 4 } }, flip = true",
            "",
        ),
        2,
    );
    assert!(tip < -0.1, "{tip}");
    for of in [
        "mesh = \"table-1.msh\"",
        "mesh = \"table-2.msh\"",
        "mesh = \"table-20.msh\"",
        "mesh = \"table-1.msh\", smoothing = \"facet\"",
        "bezier = \"table.bpt\"",
    ] {
        for reach in ["", "\nreach = 3.0"] {
            let (touching, hangs) = rise(&tool(of, reach), 1);
            assert_eq!(touching, active, "{of}{reach}");
            assert_close(of, hangs, tip, 1e-9);
        }
    }
    // As stiff as steel, and a body.
    for count in [1, 2, 20] {
        let body = format!(
            "[body.table]\nmaterial = \"hard\"\nblock = {{ box = {{ origin = [0.0, 0.0, -1.0], size = [10.0, 4.0, 1.0] }}, \
             elements = [{count}, 1, 1] }}\n[material.hard]\nmodel = \"hooke\"\nyoung = 1e9\npoisson = 0.0"
        );
        let bench = overhang(&body, "master = \"table.zmax\"");
        let scene = std::fs::read_to_string(bench.path("scene.toml")).unwrap();
        bench.write("scene.toml", &scene.replace("fix = [", "fix = [{ set = \"table.zmin\" }, "));
        let (touching, hangs) = rise(&bench, 1);
        assert_eq!(touching, active, "{count}");
        assert_close("on a body", hangs, tip, 1e-6);
    }
}

/// What a rank sees of the part that it fetches is what it would see of the whole.
#[test]
fn ranks_see_the_whole() {
    on_ranks("ranks_see_the_whole", &[1, 2, 3], see_the_whole);
}

fn see_the_whole(world: &SimpleCommunicator) {
    let rank = world.rank() as usize;
    // Each rank has points of its own in a third of the box, the last of several ranks none.
    let count = if rank > 0 && rank + 1 == world.size() as usize { 0 } else { 300 };
    let spread = |low: [f64; 3], high: [f64; 3]| -> Vec<Vec3> {
        let part = |k: usize, d: usize| {
            let part = ((k + 1000 * rank) as f64 * [0.618, 0.755, 0.57][d]).fract();
            if d == 0 { (part + rank as f64) / 3.0 } else { part }
        };
        (0..count).map(|k| Vec3::from_fn(|d, _| low[d] + (high[d] - low[d]) * part(k, d))).collect()
    };
    let folder = tempfile::tempdir().unwrap();
    let die = folder.path().join("die.toml");
    let file = inputs().join("flanged-hole.igs");
    std::fs::write(&die, format!("[tool.die]\nnurbs = \"{}\"", file.display())).unwrap();
    let indenter = (inputs().join("ironing-rigid.toml"), spread([0.0, 0.0, -0.5], [50.0, 42.0, 1.5]));
    for (path, points) in [indenter, (die, spread([-90.0, -90.0, -50.0], [90.0, 110.0, 10.0]))] {
        let tool = &load_tools(&path, &[]).unwrap()[0];
        for description in tool.descriptions() {
            sees_the_whole(world, tool, description, &points);
        }
    }
}

fn sees_the_whole(world: &SimpleCommunicator, tool: &Tool, description: Description, points: &[Vec3]) {
    let whole = describe(tool, description, &Controls::default()).unwrap().geometry.whole();
    let mut surface = Surface::new(world, tool, description, &Controls::default()).unwrap();
    let mut near = 0;
    for reach in [1.0, 8.0] {
        let seen = surface.project_all(world, points, reach);
        let alone: Vec<_> = points.iter().map(|x| whole.closest(x, reach, None)).collect();
        assert_eq!(seen, alone, "{}", description.key());
        near = seen.iter().flatten().count();
    }
    assert!(points.is_empty() || near > 50, "{near}");
}
