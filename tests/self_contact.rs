//! Self-contact: a strip that closes onto itself.

mod common;

use common::{Bench, History, Run, assert_small, msh, nagata};

/// Length of the facets of the legs.
const FACET: f64 = 0.8;

/// The scene and mesh of `inputs/`, with the scene's text changed.
fn strip(edit: impl Fn(String) -> String) -> Bench {
    let folder = env!("CARGO_MANIFEST_DIR");
    let bench = Bench::new(&edit(std::fs::read_to_string(format!("{folder}/inputs/c-strip.toml")).unwrap()));
    bench.write("c-strip.msh", MESH);
    bench
}

const MESH: &str = include_str!("../inputs/c-strip.msh");

/// The upper half of the mesh.
fn upper_half() -> String {
    let lines: Vec<&str> = MESH.lines().collect();
    let section = |name: &str| {
        let at = lines.iter().position(|l| *l == name).unwrap();
        let count: usize = lines[at + 1].parse().unwrap();
        (at, &lines[at + 2..at + 2 + count])
    };
    let ((head, nodes), (_, elements)) = (section("$Nodes"), section("$Elements"));
    let word = |line: &str, k: usize| line.split(' ').nth(k).unwrap().to_string();
    let nodes: Vec<&str> = nodes.iter().filter(|l| word(l, 2).parse::<f64>().unwrap() >= 0.0).copied().collect();
    let kept: std::collections::BTreeSet<String> = nodes.iter().map(|l| word(l, 0)).collect();
    let whole = |l: &&&str| l.split(' ').skip(5).all(|n| kept.contains(n));
    let elements: Vec<&str> = elements.iter().filter(whole).copied().collect();
    let list = |name: &str, lines: &[&str]| format!("${name}\n{}\n{}\n$End{name}\n", lines.len(), lines.join("\n"));
    lines[..head].join("\n") + "\n" + &list("Nodes", &nodes) + &list("Elements", &elements)
}

/// What holds and moves the strip.
const HANDLES: [&str; 5] = ["lip-top", "lip-bottom", "leg-top", "leg-bottom", "bend"];

/// The reactions balance in every increment.
fn check_balance(history: &History) {
    let scale = history.largest_force("strip.lip-top");
    for c in ["fx", "fy"] {
        let of = HANDLES.map(|handle| history.column(&format!("strip.{handle}.{c}")));
        let worst = (0..history.len()).map(|k| of.iter().map(|f| f[k]).sum::<f64>().abs()).fold(0.0, f64::max);
        assert_small("balance", worst / scale, 1e-8);
    }
}

/// Deepest that a node of the surface is below the surface of the other leg, in all increments written; over the length of
/// a facet. In the plane z = 0; a smoothed facet is six straight pieces.
fn deepest(run: &Run) -> f64 {
    let quads: Vec<i64> = hdf5::File::open(run.out.join("fields.h5"))
        .and_then(|file| file.dataset("grids/master_inside/cells")?.read_raw())
        .unwrap();
    let (nodes, surface) = (run.points("contact.inside"), run.points("master.inside"));
    let front = |quad: &[i64]| -> Vec<usize> {
        quad.iter().map(|&n| n as usize).filter(|&n| surface[n][2].abs() < 1e-9).collect()
    };
    let pieces: Vec<Vec<usize>> = quads.chunks(4).map(front).filter(|piece| piece.len() == 2).collect();
    let mut worst = f64::NEG_INFINITY;
    for increment in 1..=run.written() {
        let moved = |grid: &str, points: &[[f64; 3]]| -> Vec<[f64; 2]> {
            let u = run.vectors(increment, grid, "displacement");
            points.iter().zip(u).map(|(x, u)| [x[0] + u[0], x[1] + u[1]]).collect()
        };
        let (at, on) = (moved("contact.inside", &nodes), moved("master.inside", &surface));
        for piece in &pieces {
            // From left to right, the material of the upper leg is on the left hand and that of the lower on the right.
            let [a, b] = if surface[piece[0]][0] < surface[piece[1]][0] { [0, 1] } else { [1, 0] }.map(|k| piece[k]);
            let side = surface[a][1].signum();
            let length = (on[b][0] - on[a][0]).hypot(on[b][1] - on[a][1]);
            let along = [0, 1].map(|d| (on[b][d] - on[a][d]) / length);
            for n in (0..nodes.len()).filter(|&n| nodes[n][2] == 0.0 && is_opposite(&nodes[n], &surface[a])) {
                let d = [at[n][0] - on[a][0], at[n][1] - on[a][1]];
                let (s, depth) = (d[0] * along[0] + d[1] * along[1], side * (along[0] * d[1] - along[1] * d[0]));
                if (0.0..=length).contains(&s) && depth < 0.9 {
                    worst = worst.max(depth / FACET);
                }
            }
        }
    }
    worst
}

/// Whether two points are on different legs, at least one of them away from the bend.
fn is_opposite(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a[1] * b[1] < 0.0 && (a[0] > 0.0 || b[0] > 0.0)
}
/// All the way, from open to closed and drawn askew, faceted and smoothed, with friction and without. What is left is a
/// twentieth of a facet, the extension on which a node may leave its patch, times the angle to the next one.
#[test]
fn no_node_goes_through_a_face() {
    for (smoothing, friction, tolerance) in
        [("nagata", 0.0, 1e-3), ("nagata", 0.2, 1e-3), ("facet", 0.0, 2e-3), ("facet", 0.2, 2e-3)]
    {
        let of = |key: &str| format!("contact.inside.{key}");
        let (smooth, rub) = (of(&format!("smoothing={smoothing}")), of(&format!("friction={friction}")));
        let run = strip(|s| s).solve(1, &["--set", &smooth, "--set", &rub]);
        let history = run.history();
        assert_eq!(history.column("inside.active")[0], 0.0);
        assert!(history.last("inside.active") > 8.0, "{}", history.last("inside.active"));
        assert!((history.last("inside.stick") + history.last("inside.slip")) == history.last("inside.active"));
        check_balance(&history);
        assert_small(&format!("{smoothing} {friction}: penetration"), deepest(&run), tolerance);
    }
}

/// Closed and rolled without friction, each leg is half of a symmetric whole: as if it met a rigid plane. From segment to segment
/// the initial bulge of the faces counts once between the legs, and for each of them on the plane.
#[test]
fn a_symmetric_strip_is_half_a_strip_on_a_plane() {
    is_half_a_strip("one-pass", 1e-6);
    is_half_a_strip("segment", 2e-2);
}

fn is_half_a_strip(discretization: &str, tolerance: f64) {
    let how = format!("contact.inside.discretization={discretization}");
    let run = strip(|s| s).solve(1, &["--steps", "2", "--set", "contact.inside.friction=0", "--set", &how]);
    let whole = run.history();
    let half = strip(|scene| {
        let (start, rest) = scene.split_once("[contact.inside]").unwrap();
        let (_, steps) = rest.split_once("[[step]]").unwrap();
        let fixed = "{ set = \"strip.bend\", directions = \"x\" }, { set = \"strip.cut\", directions = \"y\" }";
        let above = |line: &&str| !line.contains("-bottom");
        let steps = steps.replace("{ set = \"strip.bend\" }", fixed).replace(", \"strip.", ",\n\"strip.");
        let steps = steps.lines().filter(above).collect::<Vec<_>>().join("\n");
        let plane = "[tool.plane]\nplane = { point = [0, 0, 0], normal = [0, 1, 0] }\n";
        format!(
            "{start}{plane}[contact.inside]\nslave = \"strip.inside\"\nmaster = \"plane\"\ndiscretization = \"{discretization}\"\n[[step]]{steps}"
        )
    });
    half.write("c-strip.msh", &upper_half());
    let half = half.solve(1, &["--steps", "2"]).history();
    let scale = whole.largest_force("strip.lip-top");
    for column in ["lip-top.fy", "leg-top.fy", "lip-top.ux", "leg-top.ux"].map(|c| format!("strip.{c}")) {
        let pairs = whole.column(&column).iter().zip(half.column(&column));
        let worst = pairs.map(|(w, h)| (w - h).abs()).fold(0.0, f64::max);
        assert_small(&column, worst / if column.ends_with("fy") { scale } else { 1.0 }, tolerance);
    }
    assert_eq!(whole.last("inside.active"), 2.0 * half.last("inside.active"));
    check_mirror(&run);
}

/// What is above is below, mirrored; and the contact forces of all nodes add up to nothing.
fn check_mirror(run: &Run) {
    let nodes = run.points("contact.inside");
    let mirrored = |x: &[f64; 3]| nodes.iter().position(|y| *y == [x[0], -x[1], x[2]]).unwrap();
    for increment in 1..=run.written() {
        let field = |name: &str| run.vectors(increment, "contact.inside", name);
        let (u, f) = (field("displacement"), field("force"));
        let off = |v: &[[f64; 3]], n: usize, m: usize| (v[n][0] - v[m][0]).abs().max((v[n][1] + v[m][1]).abs());
        let worst = |v: &[[f64; 3]]| (0..nodes.len()).map(|n| off(v, n, mirrored(&nodes[n]))).fold(0.0, f64::max);
        let scale = f.iter().flatten().fold(1.0, |m: f64, f| m.max(f.abs()));
        assert!(worst(&u) < 1e-8 && worst(&f) < 1e-8 * scale, "{:e} {:e}", worst(&u), worst(&f));
        let sum = |d: usize| f.iter().map(|f| f[d]).sum::<f64>().abs();
        assert!(sum(0) < 1e-8 * scale && sum(1) < 1e-8 * scale, "{:e} {:e}", sum(0), sum(1));
    }
}

/// Without friction closing costs what opening gives back: the forces are the same on both ways.
#[test]
fn frictionless_contact_has_no_memory() {
    let bench = strip(|scene| {
        let (start, rest) = scene.split_once("[[step]]\nname = \"roll\"").unwrap();
        let (_, output) = rest.split_once("[output]").unwrap();
        let (_, close) = start.split_once("[[step]]").unwrap();
        let open = close.replace("close", "open").replace(" 4.1", " -4.3").replace("-4.1", "4.3");
        let close = close.replace("4.1", "4.3");
        format!("{}[[step]]{close}[[step]]{open}[output]{output}", start.split_once("[[step]]").unwrap().0)
    });
    let history = bench.solve(1, &["--set", "contact.inside.friction=0"]).history();
    assert_eq!(history.len(), 40);
    assert!(history.column("inside.active")[19] > 4.0);
    let force = history.column("strip.lip-top.fy");
    let worst = (0..19).map(|k| (force[18 - k] - force[20 + k]).abs()).fold(0.0, f64::max);
    assert_small("hysteresis", worst / history.largest_force("strip.lip-top"), 1e-6);
}

/// Both sides and the ends of the strip may meet: the same as the inside alone, since no node takes the far side of its own
/// leg for something that it has penetrated. Half rolled: further on, facets without friction stand on each other tip to
/// tip, and rounding decides to which side they slide off.
#[test]
fn the_far_side_of_a_sheet_attracts_nothing() {
    for (smoothing, friction) in [("facet", 0.2), ("nagata", 0.0), ("facet", 0.0)] {
        let rub = format!("contact.inside.friction={friction}");
        let smooth = format!("contact.inside.smoothing={smoothing}");
        let common = ["--steps", "2", "--set", &rub, "--set", &smooth];
        let skin = || strip(|scene| scene.replace("strip.inside", "strip.skin"));
        let inside = strip(|s| s).solve(1, &common).history();
        let measured = skin().solve(1, &common).history();
        let given = skin().solve(1, &[common.as_slice(), &["--set", "contact.inside.thickness=2"]].concat()).history();
        for (what, found) in [("measured", measured), ("given", given)] {
            let [now, then] = [&found, &inside].map(|h| h.column("time").iter().position(|t| *t > 1.5 - 1e-9).unwrap());
            assert!(found.column("inside.active")[now] > 8.0);
            assert_eq!(found.column("inside.active")[now], inside.column("inside.active")[then]);
            let difference = found.row_difference(now, &inside, then, &["strip.lip-top", "strip.leg-top"]);
            assert_small(&format!("{smoothing}, thickness {what}"), difference, 1e-6);
        }
    }
}

/// Askew from the start, with friction: no nodes meet.
#[test]
fn the_number_of_ranks_does_not_matter() {
    let askew = ["--set", "step.close.move.0={ target = \"strip.lip-top\", by = [0.9, -4.1, 0.0] }"];
    let arguments = [askew.as_slice(), &["--steps", "2", "--set", "output.every=4"]].concat();
    let bench = strip(|s| s);
    let run = bench.solve(1, &arguments);
    let alone = run.history();
    check_balance(&alone);
    assert!(alone.last("inside.active") > 8.0);
    assert_small("penetration", deepest(&run), 1e-3);
    for ranks in [2, 3, 4, 7] {
        let difference = alone.difference(&bench.solve(ranks, &arguments).history());
        assert_small(&format!("{ranks} ranks"), difference, 1e-8);
    }
}

/// A surface that nowhere looks at itself adds no more to the matrix than the multipliers of its nodes.
#[test]
fn what_cannot_meet_before_long_is_not_coupled() {
    let bench = Bench::new(
        r#"
        [body.tube]
        material = "metal"
        block = { sector = { radii = [9.0, 10.0], angles = [0.0, 90.0], length = 10.0 }, elements = [1, 6, 6] }
        [material.metal]
        model = "neo-hookean"
        young = 1.0
        poisson = 0.3
        [tool.far]
        plane = { point = [0.0, 0.0, -9.0], normal = [0.0, 0.0, 1.0] }
        [contact.outer]
        slave = "tube.rmax"
        master = "tube.rmax"
        [[step]]
        increments = 1
        fix = [{ set = "tube.rmin" }]
    "#,
    );
    let entries = |master: &str| -> f64 {
        let master = format!("contact.outer.master={master}");
        let run = nagata(&bench.path(""), 1, &["check", "scene.toml", "--set", &master], bench.path("out/scene"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let (before, _) = run.stdout.split_once(" entries").unwrap();
        before.rsplit(' ').next().unwrap().parse().unwrap()
    };
    assert_eq!(entries("tube.rmax"), entries("far"));
}

/// Where constraints gave way by `wide_slack`, nothing of it is left: increments are found so here, in the second scene the
/// last one, and neither forces nor gaps depend on it.
#[test]
fn what_gave_way_is_tightened() {
    for (friction, increments, found) in [("0.2", 10, [2, 2, 0]), ("1", 5, [2, 2, 2])] {
        let common = format!(
            "contact.inside.friction={friction} step.close.increments={increments} step.roll.increments={increments}"
        );
        let closed = |control: &str| {
            let mut args = vec!["--steps", "2", "--set", control];
            args.extend(common.split(' ').flat_map(|entry| ["--set", entry]));
            strip(|s| s).solve(1, &args).history()
        };
        let all = ["wide_slack=0.015", "wide_slack=0.06", "step_facets=0.75"]
            .map(|entry| closed(&format!("controls.{entry}")));
        let retried = |history: &History| history.column("failures").iter().filter(|n| **n > 0.0).count();
        assert_eq!(all.each_ref().map(retried), found);
        let scale = all[2].largest_force("strip.leg-top");
        for history in &all {
            let off = history.last("strip.leg-top.fy") - all[2].last("strip.leg-top.fy");
            assert_small("force", off.abs() / scale, 1e-6);
            let deep = history.column("inside.max_penetration").iter().fold(0.0, |most: f64, deep| most.max(*deep));
            assert_small("penetration", deep / FACET, 1e-6);
            for column in ["inside.fx", "inside.fy"] {
                let sum = history.column(column).iter().fold(0.0, |most: f64, f| most.max(f.abs()));
                assert_small(column, sum / scale, 1e-9);
            }
        }
    }
}

/// Tip on tip: without friction, where the next increment was not found, and with friction, where a step begins with tips that
/// are apart by less than counts as a gap.
#[test]
fn what_stands_tip_on_tip_gets_on() {
    for (friction, half, most) in [("0", "18", 3), ("0.2", "20", 0)] {
        let entries = [
            "contact.inside.smoothing=facet".to_string(),
            format!("contact.inside.friction={friction}"),
            format!("step.close.increments={half}"),
            format!("step.roll.increments={half}"),
        ];
        let args: Vec<&str> = entries.iter().flat_map(|entry| ["--set", entry]).collect();
        let run = strip(|s| s).solve(1, &args);
        let cuts = run.summary()["cutbacks"].as_u64().unwrap();
        assert!(cuts <= most, "{friction}: {cuts} cuts");
        check_balance(&run.history());
    }
}

/// Two cubes of one mesh, all of whose faces may meet each other, come to touch exactly as an increment ends, and press each
/// other as two passes between the two sides have it.
#[test]
fn cubes_of_one_surface_press_each_other() {
    let lower = msh::block([4, 4, 4], false, |p| p);
    let upper = msh::block([4, 4, 4], false, |[x, y, z]| [x + 0.1, y + 0.1, z + 1.05]);
    let run = |slave: &str, master: &str, more: &str, ranks: usize| {
        let bench = Bench::new(&format!(
            r#"
            [body.cubes]
            mesh = "cubes.msh"
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.3
            [contact.joint]
            slave = "cubes.{slave}"
            master = "cubes.{master}"
            friction = 0.3
            {more}
            [[step]]
            increments = 8
            fix = [{{ set = "cubes.zmin0" }}]
            move = [{{ target = "cubes.zmax1", by = [0.0, 0.0, -0.4] }}]
            [output]
            history = ["cubes.zmin0", "cubes.zmax1"]
            "#
        ));
        bench.write("cubes.msh", &msh::together(&[&lower, &upper]));
        bench.solve(ranks, &[]).history()
    };
    let by_segments = |ranks: usize| run("all", "all", "discretization = \"segment\"", ranks).last("cubes.zmin0.fz");
    let all = run("all", "all", "", 1);
    let force = all.last("cubes.zmin0.fz");
    let other = run("all", "all", "", 2).last("cubes.zmin0.fz");
    assert_small("ranks", force / other - 1.0, 1e-6);
    assert_small("balance", (force + all.last("cubes.zmax1.fz")) / force, 1e-9);
    let passes = run("zmin1", "zmax0", "discretization = \"two-pass\"", 1).last("cubes.zmin0.fz");
    assert_small("two passes", force / passes - 1.0, 1e-2);
    let one_way = run("zmin1", "zmax0", "discretization = \"segment\"", 1).last("cubes.zmin0.fz");
    assert_small("segments", by_segments(1) / one_way - 1.0, 2e-2);
    assert_small("ranks", by_segments(1) / by_segments(2) - 1.0, 1e-4);
}

/// A surface of two blocks of unlike meshes that meets itself from segment to segment passes an even pressure on, but for what its
/// conditions give way; and of one body the blocks are what they are of two, to rounding.
#[test]
fn segments_within_a_body() {
    let lower = msh::block([4, 3, 2], false, |x| x);
    let upper = msh::block([3, 5, 2], false, |[x, y, z]| [x, y, z + 1.01]);
    let scene = |bodies: &str, [slave, master]: [&str; 2], [low, high]: [&str; 2]| {
        format!(
            r#"
            {bodies}
            [material.m]
            model = "neo-hookean"
            young = 100.0
            poisson = 0.0
            [contact.c]
            slave = "{slave}"
            master = "{master}"
            discretization = "segment"
            friction = 0.3
            [[step]]
            increments = 3
            fix = [{{ set = "{low}" }}]
            move = [{{ target = "{high}", by = [0.0, 0.0, -0.21] }}]
            [[step]]
            increments = 3
            keep = true
            move = [{{ target = "{high}", by = [0.1, 0.2, 0.0] }}]
            [output]
            history = ["{low}", "{high}"]
            "#
        )
    };
    let body = |name: &str| format!("[body.{name}]\nmesh = \"{name}.msh\"\nmaterial = \"m\"\n");
    let held = ["s.zmin0", "s.zmax1"];
    let one = |sides: [&str; 2]| {
        let bench = Bench::new(&scene(&body("s"), sides, held));
        bench.write("s.msh", &msh::together(&[&lower, &upper]));
        bench
    };
    let two = Bench::new(&scene(&(body("a") + &body("b")), ["b.zmin", "a.zmax"], ["a.zmin", "b.zmax"]));
    two.write("a.msh", &lower);
    two.write("b.msh", &upper);
    let (within, between) = (one(["s.zmin1", "s.zmax0"]).solve(2, &[]).history(), two.solve(1, &[]).history());
    for d in ["fx", "fy", "fz"] {
        let [of_one, of_two] = [within.column(&format!("s.zmin0.{d}")), between.column(&format!("a.zmin.{d}"))];
        let off = of_one.iter().zip(of_two).map(|(one, two)| (one - two).abs()).fold(0.0, f64::max);
        assert_small(d, off / between.largest_force("a.zmin"), 1e-10);
    }
    let own = one(["s.zmax0"; 2]);
    // The lower side of the upper block belongs to the same group.
    own.write("s.msh", &msh::together(&[&lower, &upper]).replace(" 2 13 13 ", " 2 8 8 "));
    let run = own.solve(2, &["--steps", "1"]);
    let pressures = run.scalars(run.written(), "contact.c", "pressure");
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    pressures.iter().for_each(|pressure| assert_small("pressure", pressure / mean - 1.0, 1e-2));
    assert_small("force", run.history().last("s.zmin0.fz") / mean - 1.0, 1e-2);
}

/// Sheets of a fifth of a facet and rubber that is confined resist far more than what conditions give way by counts with; two surfaces of
/// one body are right, whose conditions do not give way.
#[test]
fn what_resists_more_is_tightened_more() {
    let sides = [("xmin", "x"), ("ymin", "y"), ("xmax", "x"), ("ymax", "y")];
    // Thickness, Poisson's ratio, how many sides are held, and by how much it is pressed beyond the gap.
    for (thickness, poisson, count, by) in [(0.1, 0.0, 2, 0.02), (1.0, 0.499, 4, 0.004)] {
        let lower = msh::block([4, 4, 2], false, |[x, y, z]| [2.0 * x, 2.0 * y, thickness * z]);
        let upper = msh::block([4, 4, 2], false, |[x, y, z]| [2.0 * x, 2.0 * y, thickness * (z + 1.01)]);
        let held = |(side, along): &(&str, &str)| {
            ["0", "1"].map(|b| format!("{{ set = \"s.{side}{b}\", directions = \"{along}\" }}, ")).concat()
        };
        let held: String = sides[..count].iter().map(held).collect();
        let run = |slave: &str, master: &str, how: &str| {
            let down = -by - 0.01 * thickness;
            let bench = Bench::new(&format!(
                r#"
                [body.s]
                mesh = "s.msh"
                material = "m"
                [material.m]
                model = "neo-hookean"
                young = 100.0
                poisson = {poisson:?}
                [contact.c]
                slave = "s.{slave}"
                master = "s.{master}"
                {how}
                [[step]]
                increments = 2
                fix = [{held}{{ set = "s.zmin0" }}]
                move = [{{ target = "s.zmax1", by = [0.0, 0.0, {down:?}], directions = "z" }}]
                [output]
                history = ["s.zmin0"]
                "#
            ));
            let mesh = msh::together(&[&lower, &upper]);
            // The lower side of the upper block belongs to the same group.
            let joined = mesh.replace(" 2 13 13 ", " 2 8 8 ");
            bench.write("s.msh", if slave == master { &joined } else { &mesh });
            bench.solve(1, &[]).history().last("s.zmin0.fz")
        };
        let segments = "discretization = \"segment\"";
        let exact = run("zmin1", "zmax0", segments);
        for how in [segments, ""] {
            assert_small(how, run("zmax0", "zmax0", how) / exact - 1.0, 2e-3);
        }
    }
}

/// Stopped between steps and gone on with on another number of ranks, from segment to segment, too.
#[test]
fn segments_go_on() {
    let set = ["contact.inside.discretization=segment", "output.every=4", "output.checkpoint={ increments = 5 }"];
    let how: Vec<&str> = set.iter().flat_map(|entry| ["--set", entry]).collect();
    let bench = strip(|s| s);
    let whole = bench.solve(1, &[&how[..], &["--steps", "2"]].concat()).history();
    for (ranks, then) in [(1, 3), (3, 2)] {
        let other = strip(|s| s);
        let first = other.solve(ranks, &[&how[..], &["--steps", "1"]].concat());
        let out = first.out.to_str().unwrap();
        let arguments = [&["run", "scene.toml", "--restart", "--steps", "2", "--out", out], &how[..]].concat();
        let rest = nagata(&other.path(""), then, &arguments, first.out.clone());
        assert_eq!(rest.code, 0, "{}", rest.stderr);
        check_balance(&rest.history());
        assert_small("gone on", rest.history().difference(&whole), 1e-6);
    }
}
