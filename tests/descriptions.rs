//! One tool in several descriptions: they are the same surface as far as each can be, on any number of ranks.

mod common;

use common::{Bench, History, assert_close, assert_small, on_ranks};
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
