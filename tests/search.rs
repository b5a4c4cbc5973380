//! The search for contact over ranks: nothing within reach is missed, little else is held, and where the parts of the bodies
//! are makes no difference.

mod common;

use common::{Bench, assert_small, is_worker, nagata, on_ranks};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use nagata::Vec3;
use nagata::contact::BodySurface;
use nagata::controls::Controls;
use nagata::mesh::{Facet, Mesh};
use nagata::model::Model;
use nagata::output::phases::Phases;
use nagata::parallel::{Parcels, Route, exchange, sent, sum};
use nagata::partition::Bounds;
use nagata::partition::directory::recipients;
use nagata::partition::parcels::grown;
use nagata::scene::{MasterSurface, Smoothing, Transfer, parse};
use nagata::surface::{MovingPatch, PatchSet};
use std::collections::BTreeSet;
use std::path::Path;

/// The same numbers on all ranks, from 0 to 1.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.number() * n as f64) as usize
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::from_fn(|_, _| self.number())
    }
}

/// One exchange after the other, some ranks with much to say and some with nothing, and routes between them.
#[test]
fn messages_arrive() {
    on_ranks("messages_arrive", &[1, 2, 3, 7], |comm| {
        let (rank, size) = (comm.rank() as usize, comm.size() as usize);
        let mut random = Random(1);
        for round in 0..300u64 {
            // Every rank knows what each sends to each: nothing for about half of them.
            let mut counts = vec![vec![0; size]; size];
            let long = if round % 50 == 0 { 100_000 } else { 20 };
            counts.iter_mut().flatten().for_each(|n| *n = random.below(2 * long).saturating_sub(long));
            let parcel = |from: usize, to: usize| -> Vec<u64> {
                (0..counts[from][to] as u64).map(|k| round << 32 | (from * size + to) as u64 ^ k << 8).collect()
            };
            let some = |parcels: Parcels<u64>| -> Parcels<u64> {
                parcels.into_iter().filter(|(_, parcel)| !parcel.is_empty()).collect()
            };
            let own = some((0..size).map(|to| (to, parcel(rank, to))).collect());
            let expected = some((0..size).map(|from| (from, parcel(from, rank))).collect());
            let before = sent();
            let received = exchange(comm, &own);
            assert_eq!(received, expected, "round {round}");
            let others = own.keys().filter(|to| **to != rank).count() as u64;
            assert_eq!(
                sent().messages - before.messages,
                others,
                "a message to each rank that gets something, and no more"
            );
            let numbers: u64 = own.iter().filter(|(to, _)| **to != rank).map(|(_, parcel)| parcel.len() as u64).sum();
            assert_eq!(sent().bytes - before.bytes, 8 * numbers);
            let route = Route::new(&own, &received);
            let flat =
                |parcels: &Parcels<u64>| -> Vec<[u64; 2]> { parcels.values().flatten().map(|&n| [n, !n]).collect() };
            let there = route.send(comm, 2, flat(&own).as_flattened());
            assert_eq!(there, flat(&expected).as_flattened());
            assert_eq!(route.send_back(comm, 2, &there), flat(&own).as_flattened());
        }
    });
}

/// Boxes of all sizes anywhere on any rank, points of each rank in clusters and scattered; the last of several ranks has no
/// points, the one before no boxes.
#[test]
fn every_box_within_reach_of_a_point_is_found() {
    on_ranks("every_box_within_reach_of_a_point_is_found", &[1, 2, 3, 4, 5, 6, 7], |comm| {
        let (rank, size) = (comm.rank() as usize, comm.size() as usize);
        let mut random = Random(size as u64);
        for reach in [1e-3, 0.02, 0.3, 40.0] {
            let (boxes, points) = (clouds(&mut random, size, 400), scattered(&mut random, size));
            let seen = recipients(comm, &boxes[rank], &points[rank], reach);
            for (k, bounds) in boxes[rank].iter().enumerate() {
                for (to, points) in points.iter().enumerate() {
                    let listed = seen.get(&to).is_some_and(|boxes| boxes.binary_search(&(k as u32)).is_ok());
                    let near = |by: f64| points.iter().any(|x| holds(&grown(*bounds, by), x));
                    assert!(listed || !near(reach * (1.0 - 1e-12)), "box {k} of {rank} is near {to}, reach {reach}");
                    // What is listed is near but for half a cell, of the level on which the box fits.
                    let level = (((bounds.1 - bounds.0).max() + 2.0 * reach) / (3.0 * reach)).log2().ceil().max(0.0);
                    let slack = 1.5 * reach * level.exp2();
                    assert!(!listed || near(reach + slack), "box {k} of {rank} is far from {to}, reach {reach}");
                }
            }
        }
    });
}

/// For each rank `count` boxes, from tiny to half the world.
fn clouds(random: &mut Random, size: usize, count: usize) -> Vec<Vec<Bounds>> {
    let mut one = || {
        let (low, extent) = (random.vector() * 2.0 - Vec3::repeat(1.0), random.vector());
        (low, low + extent * 10f64.powf(-3.5 * random.number()))
    };
    let mut boxes: Vec<Vec<Bounds>> = (0..size).map(|_| (0..count).map(|_| one()).collect()).collect();
    boxes[0].push((Vec3::repeat(f64::NAN), Vec3::repeat(f64::INFINITY)));
    if size > 2 {
        boxes[size - 2].clear();
    }
    boxes
}

fn scattered(random: &mut Random, size: usize) -> Vec<Vec<Vec3>> {
    let mut of_rank = || {
        let center = random.vector() * 2.0 - Vec3::repeat(1.0);
        let mut points: Vec<Vec3> = (0..60).map(|_| center + random.vector() * 0.1).collect();
        points.extend((0..10).map(|_| random.vector() * 3.0 - Vec3::repeat(1.5)));
        points.push(Vec3::repeat(f64::NAN));
        points
    };
    let mut points: Vec<Vec<Vec3>> = (0..size).map(|_| of_rank()).collect();
    if size > 1 {
        points[size - 1].clear();
    }
    points
}

fn holds((low, high): &Bounds, x: &Vec3) -> bool {
    (0..3).all(|d| low[d] <= x[d] && x[d] <= high[d])
}

/// A surface that waves and slides under slave nodes that wander, each side cut its own way.
#[test]
fn a_moving_surface_is_followed() {
    on_ranks("a_moving_surface_is_followed", &[1, 2, 3, 4, 7], |comm| {
        let (rank, size) = (comm.rank() as usize, comm.size() as usize);
        let mesh = sheet();
        let starts: Vec<u64> = (0..=size).map(|r| (WIDE * (r * WIDE / size)) as u64).collect();
        let patches = MovingPatch::all(
            &mesh,
            &(0..NODES as u64).collect::<Vec<_>>(),
            Smoothing::Nagata,
            40.0,
            &[],
            &Controls::default(),
        )
        .unwrap();
        let given = MasterSurface { smoothing: Smoothing::Nagata, feature_angle: 40.0, transfer: Transfer::Patch };
        let dealt = if rank == 0 { &patches[..] } else { &[] };
        let mut surface = BodySurface::new(comm, "sheet", given, dealt, &starts, 0.05);
        let reach = 0.05;
        let mut fetches = 0;
        for step in 0..40 {
            let t = 0.02 * f64::from(step);
            let place = |k: u64| wave(k as usize, t);
            // Columns of slave nodes; the last of several ranks has none.
            let columns = (0..12).filter(|i| i % (size - 1).max(1) == rank);
            let slaves: Vec<Vec3> = columns.flat_map(|i| (0..12).map(move |j| above(i, j, t))).collect();
            let fetched =
                surface.follow(comm, &slaves, reach, &BTreeSet::new(), |k| place(starts[rank] + u64::from(k)));
            fetches += usize::from(fetched);
            let stencil = |p: &MovingPatch| -> Vec<Vec3> { p.nodes.iter().map(|&n| place(n)).collect() };
            let whole = PatchSet::new(patches.iter().map(|p| p.shape(&stencil(p))).collect());
            for x in &slaves {
                assert_eq!(surface.shapes().closest(x, reach, None), whole.closest(x, reach, None), "{x} at {t}");
            }
            let within = |p: &MovingPatch| {
                let bounds = grown(p.shape(&stencil(p)).bounds(), 6.0 * reach);
                slaves.iter().any(|x| holds(&bounds, x))
            };
            let near = patches.iter().filter(|p| within(p)).count();
            let held = surface.shapes().pieces().len();
            assert!(held <= near, "{held} patches, {near} are near");
        }
        assert!((2..20).contains(&fetches), "{fetches} fetches");
        let mut held = [surface.shapes().pieces().len() as f64];
        sum(comm, &mut held);
        assert!(held[0] > 0.0 && held[0] < 0.6 * (size * patches.len()) as f64);
    });
}

/// Nodes of the sheet along a side.
const WIDE: usize = 41;
const NODES: usize = WIDE * WIDE;

/// Node `k` of the sheet at a time.
fn wave(k: usize, t: f64) -> Vec3 {
    let [x, y] = [k % WIDE, k / WIDE].map(|k| k as f64 / (WIDE - 1) as f64);
    Vec3::new(x + 0.3 * t, y, 0.03 * (9.0 * x + 2.0 * t).sin() * (7.0 * y).cos())
}

/// A slave node near the sheet.
fn above(i: usize, j: usize, t: f64) -> Vec3 {
    let [x, y] = [i, j].map(|k| 0.3 + 0.033 * k as f64);
    Vec3::new(x, y + 0.2 * t, 0.03 * (9.0 * (x - 0.3 * t)).sin() * (7.0 * y).cos() + 0.01)
}

fn sheet() -> Mesh {
    let facet = |k: usize| {
        let first = (k % (WIDE - 1) + WIDE * (k / (WIDE - 1))) as u32;
        let up = first + WIDE as u32;
        Facet { count: 4, nodes: [first, first + 1, up + 1, up], id: k as u64 }
    };
    Mesh {
        points: (0..NODES).map(|k| wave(k, 0.0).into()).collect(),
        point_ids: (0..NODES as u64).collect(),
        facets: (0..(WIDE - 1) * (WIDE - 1)).map(facet).collect(),
        ..Mesh::default()
    }
}

/// A soft block is pressed onto a hard table and drawn over its fine facets.
fn drawn_block(table: [usize; 3], block: [usize; 3], increments: usize) -> String {
    format!(
        r#"
        [body.table]
        block = {{ box = {{ size = [8.0, 6.0, 1.0] }}, elements = {table:?} }}
        material = "hard"
        [body.block]
        block = {{ box = {{ origin = [1.05, 1.07, 1.0], size = [3.0, 3.0, 2.0] }}, elements = {block:?} }}
        material = "soft"
        [material.soft]
        model = "neo-hookean"
        young = 10.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 4000.0
        poisson = 0.2
        [contact.sole]
        slave = "block.zmin"
        master = "table.zmax"
        friction = 0.3
        [[step]]
        name = "press"
        increments = 2
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [0.0, 0.0, -0.1] }}]
        [[step]]
        name = "drag"
        increments = {increments}
        fix = [{{ set = "table.zmin" }}]
        move = [{{ target = "block.zmax", by = [3.0, 0.7, 0.0] }}]
        [output]
        every = 100
        history = ["table.zmin", "block.zmax"]
        "#
    )
}

/// How many slave nodes and nodes of the master each rank has.
fn sides(comm: &SimpleCommunicator, scene: &str) -> Vec<[usize; 2]> {
    let scene = parse("scene.toml", scene, Path::new("."), &[]).unwrap();
    let model = Model::new(comm, &scene, &Phases::default()).unwrap();
    let mut counts = vec![0.0; 2 * comm.size() as usize];
    let here = 2 * comm.rank() as usize;
    (counts[here], counts[here + 1]) = (model.pairs[0].slaves.len() as f64, model.set("table.zmax").nodes.len() as f64);
    sum(comm, &mut counts);
    counts.as_chunks::<2>().0.iter().map(|side| side.map(|n| n as usize)).collect()
}

/// The partition puts one body on each of two ranks: each rank has the slave or the master, and none has both.
#[test]
fn slave_and_master_never_share_a_rank() {
    let scene = drawn_block([20, 15, 1], [6, 6, 8], 3);
    on_ranks("slave_and_master_never_share_a_rank", &[2], |comm| {
        let sides = sides(comm, &scene);
        assert!(sides.iter().all(|side| side.contains(&0)) && sides[0] != sides[1], "{sides:?}");
    });
    same_history(&scene, &[2]);
}

/// Parts cut through both sides of the contact.
#[test]
fn parts_cut_both_sides() {
    let scene = drawn_block([16, 12, 1], [6, 6, 3], 4);
    on_ranks("parts_cut_both_sides", &[4, 7], |comm| {
        let sides = sides(comm, &scene);
        let sharing = |k: usize| sides.iter().filter(|side| side[k] > 0).count();
        assert!(sharing(0) > 1 && sharing(1) > 2, "{sides:?}");
    });
    same_history(&scene, &[2, 3, 4, 7]);
}

/// Factors of another pattern do not serve.
const DIRECT: [&str; 2] = ["--set", "solver.linear=direct"];

/// Runs on one rank and on others, unless this is a worker of [`on_ranks`].
fn same_history(scene: &str, ranks: &[usize]) {
    if is_worker() {
        return;
    }
    let bench = Bench::new(scene);
    let alone = bench.solve(1, &DIRECT);
    for &n in ranks {
        let run = bench.solve(n, &DIRECT);
        assert_small(&format!("{n} ranks"), alone.history().difference(&run.history()), 1e-8);
        for count in ["search_fetches", "pattern_rebuilds", "analyses"] {
            assert_eq!(run.summary()[count], alone.summary()[count], "{count} on {n} ranks");
        }
    }
}

/// Sixteen nodes slide over seven facets each. Only a new pattern makes MUMPS analyse anew, and that is seldom.
#[test]
fn few_patterns_serve_a_long_slide() {
    let run = Bench::new(&drawn_block([20, 15, 1], [3, 3, 1], 16)).solve(1, &DIRECT);
    let summary = run.summary();
    let [rebuilds, analyses] = ["pattern_rebuilds", "analyses"].map(|key| summary[key].as_u64().unwrap());
    assert_eq!(analyses, 2 + rebuilds, "one a step, and one a new pattern");
    assert!((1..=6).contains(&rebuilds), "{rebuilds}");
    let iterations = summary["iterations"].as_u64().unwrap();
    assert!(iterations > 5 * analyses, "{iterations} factorizations, {analyses} analyses");
}

/// What the contact adds to the matrix does not grow with the fineness of the master.
#[test]
fn a_fine_master_does_not_fill_the_matrix() {
    let entries = |elements: usize, far: bool| -> f64 {
        let scene = drawn_block([elements, elements, 1], [4, 4, 1], 1);
        let scene = if far { scene.replace("1.07, 1.0]", "1.07, 30.0]") } else { scene };
        let bench = Bench::new(&scene);
        let folder = bench.path("");
        let run = nagata(&folder, 1, &["check", "scene.toml"], folder.clone());
        let (_, rest) = run.stdout.split_once("matrix with ").unwrap();
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    // Coarser still, the entries of slave nodes coincide.
    let added = [60, 90].map(|elements| (entries(elements, false) - entries(elements, true)) / 25.0);
    assert!(added[1] < 1.05 * added[0] && added[1] < 12_500.0, "entries a slave node: {added:?}");
}
