//! Units, the place of the origin and the directions of the axes do not matter.

mod common;

use common::{Bench, assert_small, msh};

/// How the scene is written down: its lengths in millimetres times `unit`, then moved by `shift`, with the axes taken on by
/// `turn`. Forces stay in newtons.
#[derive(Clone, Copy)]
struct Writing {
    unit: f64,
    shift: [f64; 3],
    turn: usize,
}

const PLAIN: Writing = Writing { unit: 1.0, shift: [0.0; 3], turn: 0 };

impl Writing {
    fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|d| v[(d + 3 - self.turn) % 3])
    }

    fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        self.direction(v).map(|x| x * self.unit)
    }

    fn point(&self, v: [f64; 3]) -> [f64; 3] {
        let v = self.vector(v);
        std::array::from_fn(|d| v[d] + self.shift[d])
    }

    fn axis(&self, d: usize) -> &'static str {
        ["x", "y", "z"][(d + self.turn) % 3]
    }

    fn scene(&self, tool: &str) -> Bench {
        let elements = [5, 4, 2];
        let elements: [usize; 3] = std::array::from_fn(|d| elements[(d + 3 - self.turn) % 3]);
        let (x, z) = (self.axis(0), self.axis(2));
        let tool = match tool {
            "ball" => {
                format!("sphere = {{ center = {:?}, radius = {:?} }}", self.point([1.2, 1.1, 3.0]), 2.0 * self.unit)
            }
            _ => "mesh = \"bowl.msh\"".to_string(),
        };
        let bench = Bench::new(&format!(
            r#"
            [body.block]
            block = {{ box = {{ origin = {:?}, size = {:?} }}, elements = {elements:?} }}
            material = "soft"
            [material.soft]
            model = "neo-hookean"
            young = {:?}
            poisson = 0.3
            [tool.tool]
            {tool}
            [contact.top]
            slave = "block.{z}max"
            master = "tool"
            friction = 0.25
            [[step]]
            increments = 2
            fix = [{{ set = "block.{z}min" }}]
            move = [{{ target = "tool", by = {:?} }}]
            [[step]]
            increments = 4
            fix = [{{ set = "block.{z}min" }}]
            move = [{{ target = "tool", by = {:?}, rotate = {{ point = {:?}, axis = {:?}, angle = 5.0 }} }}]
            force = [{{ target = "block.{x}max", total = {:?} }}]
            [output]
            every = 100
            history = ["block.{z}min", "block.{x}max"]
            "#,
            self.point([0.0; 3]),
            self.vector([3.0, 2.5, 1.0]),
            10.0 / (self.unit * self.unit),
            self.vector([0.0, 0.0, -0.2]),
            self.vector([0.3, 0.2, 0.0]),
            self.point([1.2, 1.1, 1.0]),
            self.direction([0.2, 1.0, 0.4]),
            self.direction([0.1, 0.2, 0.05]),
        ));
        let bowl = |s: f64, t: f64| {
            let (x, y) = (6.0 * s - 1.8, 4.2 - 6.0 * t);
            self.point([x, y, 1.0 + 0.1 * ((x - 1.2).powi(2) + (y - 1.1).powi(2))])
        };
        bench.write("bowl.msh", &msh::surface(4, bowl));
        bench
    }
}

/// Runs a scene as written plainly and otherwise, and compares all of the history in newtons and millimetres.
fn compare(tool: &str, writings: &[(&str, Writing)]) {
    let plain = PLAIN.scene(tool).solve(2, &[]).history();
    let force = plain.column("tool.fz").iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let most = plain.column("top.max_pressure").iter().fold(0.0f64, |m, p| m.max(*p));
    assert!(plain.column("top.slip").iter().any(|n| *n > 2.0) && plain.column("top.stick").iter().any(|n| *n > 2.0));
    for (what, writing) in writings {
        let other = writing.scene(tool).solve(2, &[]).history();
        assert_eq!(plain.len(), other.len(), "{tool} {what}");
        let mut worst = 0.0f64;
        let [x, y, z] = [0, 1, 2].map(|d| writing.axis(d));
        // The frame of a tool has its origin where that of the scene is, which moves when the tool turns about a point.
        let sets = [("block.zmin", format!("block.{z}min")), ("block.xmax", format!("block.{x}max"))];
        let mut columns = Vec::new();
        for (a, b) in sets.iter().map(|(a, b)| (*a, b.as_str())).chain([("tool", "tool")]) {
            for (c, d) in [("x", x), ("y", y), ("z", z)] {
                columns.push((format!("{a}.f{c}"), format!("{b}.f{d}"), force, 1.0));
                if a != "tool" || writing.shift == [0.0; 3] {
                    columns.push((format!("{a}.u{c}"), format!("{b}.u{d}"), 1.0, writing.unit));
                }
            }
        }
        columns.push(("top.max_pressure".into(), "top.max_pressure".into(), most, writing.unit.powi(-2)));
        for name in ["iterations", "top.active", "top.stick", "top.slip", "time"] {
            columns.push((name.into(), name.into(), 1.0, 1.0));
        }
        for (a, b, scale, unit) in &columns {
            let pairs = plain.column(a).iter().zip(other.column(b));
            let error = pairs.map(|(a, b)| (a - b / unit).abs() / scale).fold(0.0, f64::max);
            if error > 1e-8 {
                println!("{tool} {what} {a}: {:?} {:?}", plain.column(a), other.column(b));
            }
            worst = worst.max(error);
        }
        assert_small(&format!("{tool} {what}"), worst, 1e-8);
    }
}

const UNITS: [(&str, Writing); 2] =
    [("metres", Writing { unit: 1e-3, ..PLAIN }), ("micrometres", Writing { unit: 1e3, ..PLAIN })];

const PLACES: [(&str, Writing); 3] = [
    ("moved", Writing { shift: [300.0, -200.0, 100.0], ..PLAIN }),
    ("z along x", Writing { turn: 1, ..PLAIN }),
    ("z along y, moved", Writing { turn: 2, shift: [-30.0, 20.0, 10.0], ..PLAIN }),
];

/// A ball on a block in mm and MPa, m and Pa, um and MN/mm^2.
#[test]
fn units_with_a_ball() {
    compare("ball", &UNITS);
}

/// The same with a tool of Nagata patches.
#[test]
fn units_with_a_mesh() {
    compare("mesh", &UNITS);
}

#[test]
fn places_with_a_ball() {
    compare("ball", &PLACES);
}

#[test]
fn places_with_a_mesh() {
    compare("mesh", &PLACES);
}

/// A rotation by an angle about an axis that no mesh line follows.
fn turn(v: [f64; 3]) -> [f64; 3] {
    let (axis, (sin, cos)) = ([2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0], 0.83f64.sin_cos());
    let along: f64 = (0..3).map(|d| axis[d] * v[d]).sum();
    std::array::from_fn(|d| {
        let (e, f) = ((d + 1) % 3, (d + 2) % 3);
        v[d] * cos + (axis[e] * v[f] - axis[f] * v[e]) * sin + axis[d] * along * (1.0 - cos)
    })
}

/// A block dragged askew over a mound, which is the master, with points and vectors taken to space by `place`.
fn mound(contact: &str, place: impl Fn([f64; 3]) -> [f64; 3], mesh: impl Fn(&str) -> String) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.mound]
        mesh = "mound.msh"
        material = "soft"
        [body.block]
        mesh = "block.msh"
        material = "hard"
        [material.soft]
        model = "neo-hookean"
        young = 100.0
        poisson = 0.3
        [material.hard]
        model = "neo-hookean"
        young = 300.0
        poisson = 0.2
        [contact.sole]
        slave = "block.zmin"
        master = "mound.zmax"
        friction = 0.3
        {contact}
        [[step]]
        increments = 2
        fix = [{{ set = "mound.zmin" }}]
        move = [{{ target = "block.zmax", by = {:?} }}]
        [[step]]
        increments = 4
        fix = [{{ set = "mound.zmin" }}]
        move = [{{ target = "block.zmax", by = {:?} }}]
        [solver]
        tolerance = 1e-13
        [output]
        every = 100
        history = ["mound.zmin", "block.zmax"]
        "#,
        place([0.0, 0.0, -0.3]),
        place([0.9, 0.4, 0.0]),
    ));
    let on_mound = |[x, y, z]: [f64; 3]| {
        let (x, y) = (8.0 * x - 4.0, 7.0 * y - 3.5);
        place([x, y, z * (3.0 - 0.02 * (x * x + y * y))])
    };
    let on_block = |[x, y, z]: [f64; 3]| place([3.1 * x - 1.8, 2.9 * y - 1.6, 3.0 + 2.0 * z]);
    bench.write("mound.msh", &mesh(&msh::block([5, 4, 2], false, on_mound)));
    bench.write("block.msh", &mesh(&msh::block([4, 3, 2], false, on_block)));
    bench
}

/// Bodies in contact with each other, turned as a whole about an axis askew, and with other numbers of nodes.
#[test]
fn turned_and_renumbered_bodies() {
    for contact in ["", "transfer = \"variational\"", "transfer = \"bilinear\""] {
        let plain = mound(contact, |x| x, str::to_owned).solve(2, &[]).history();
        assert!(plain.last("sole.slip") > 2.0);
        let force = plain.largest_force("block.zmax");
        let compare = |what: &str, other: &common::History, place: &dyn Fn([f64; 3]) -> [f64; 3]| {
            assert_eq!(plain.column("iterations"), other.column("iterations"), "{what}");
            let mut worst = 0.0f64;
            for set in ["mound.zmin", "block.zmax", "sole"] {
                let [of_plain, of_other] = [&plain, other]
                    .map(|history| ["fx", "fy", "fz"].map(|c| history.column(&format!("{set}.{c}")).to_vec()));
                for k in 0..plain.len() {
                    let expected = place([0, 1, 2].map(|d| of_plain[d][k]));
                    worst = (0..3).map(|d| (of_other[d][k] - expected[d]).abs() / force).fold(worst, f64::max);
                }
            }
            assert_small(what, worst, 1e-10);
        };
        let turned = mound(contact, turn, str::to_owned).solve(2, &[]).history();
        compare("turned", &turned, &turn);
        let renumbered = mound(contact, |x| x, msh::renumbered).solve(2, &[]).history();
        compare("renumbered", &renumbered, &|x| x);
    }
}
