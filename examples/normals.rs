//! Accuracy of nodal normals and of the Nagata patches they give, for each weight, as Markdown tables.
//!
//! Meshes have their nodes on surfaces F(x) = 0 with known gradients: the error of a normal is its angle to grad F,
//! that of a shape the distance |F|/|grad F|. All meshes come with quadrilaterals and with triangles; disturbed ones
//! have nodes moved by up to a quarter of a facet (an eighth on balls), and triangles of random diagonals.

use nagata::Vec3;
use nagata::controls::Controls;
use nagata::mesh::{Facet, Mesh};
use nagata::scene::Smoothing;
use nagata::surface::facets::{Facets, angle};
use nagata::surface::normals::Means;
use nagata::surface::{NormalOptions, Weight, patches_from_mesh};
use std::f64::consts::{FRAC_PI_4, PI};

/// Facets along one side of the meshes; orders are between the two.
const SIZES: [usize; 2] = [12, 24];

fn main() -> nagata::error::Result<()> {
    let mut rows: Vec<Row> = Vec::new();
    for surface in &SURFACES {
        for (triangles, disturbed) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut row = Vec::new();
            for (_, weight) in Weight::ALL {
                let [coarse, fine] = SIZES.map(|n| measure(surface, &surface.mesh(n, triangles, disturbed), weight));
                row.push([coarse?, fine?]);
            }
            let (shape, state) = (["quads", "triangles"][triangles as usize], ["", ", disturbed"][disturbed as usize]);
            rows.push((format!("{}, {shape}{state}", surface.name), row));
        }
    }
    println!("Meshes have {} facets along a side; orders, in brackets, are those from {} on.", SIZES[1], SIZES[0]);
    println!("\n## Over the best weight of each mesh, geometric means\n");
    print_head();
    for (quantity, title) in TITLES.iter().enumerate() {
        print_means(title, quantity, &rows);
    }
    for (quantity, title) in TITLES.iter().enumerate() {
        println!("\n## {title}\n");
        print_head();
        rows.iter().for_each(|row| print_row(row, quantity));
    }
    Ok(())
}

/// What is measured; the errors of one mesh are in this order.
const TITLES: [&str; 6] = [
    "Nodal normals inside, RMS error, degrees",
    "Nodal normals inside, largest error, degrees",
    "Nodal normals at the ends, RMS error, degrees",
    "Nodal normals at the ends, largest error, degrees",
    "Nagata patches inside, largest error of shape",
    "Nagata patches inside, largest error of the normal, degrees",
];

type Errors = [f64; TITLES.len()];

/// Below this an error is rounding.
const EXACT: f64 = 1e-10;

/// A mesh, and the errors of each weight with [`SIZES`].
type Row = (String, Vec<[Errors; 2]>);

fn print_head() {
    println!("| | {} |", Weight::ALL.map(|(name, _)| name).join(" | "));
    println!("|---|{}", "---|".repeat(Weight::ALL.len()));
}

fn print_row((name, row): &Row, quantity: usize) {
    let cell = |[coarse, fine]: &[Errors; 2]| match fine[quantity] {
        error if error < EXACT => "exact".to_string(),
        error => format!("{error:.1e} ({:.1})", (coarse[quantity] / error).log2()),
    };
    // Closed meshes have no ends.
    if row.iter().any(|errors| errors[1][quantity] > 0.0) {
        println!("| {name} | {} |", row.iter().map(cell).collect::<Vec<_>>().join(" | "));
    }
}

/// Means over the meshes on which no weight is exact.
fn print_means(title: &str, quantity: usize, rows: &[Row]) {
    let errors = rows.iter().map(|(_, row)| row.iter().map(|errors| errors[1][quantity]).collect::<Vec<_>>());
    let errors: Vec<_> = errors.filter(|row| row.iter().all(|error| *error > EXACT)).collect();
    let over_best = |k: usize| {
        let logarithm = |row: &Vec<f64>| (row[k] / row.iter().copied().fold(f64::INFINITY, f64::min)).ln();
        (errors.iter().map(logarithm).sum::<f64>() / errors.len() as f64).exp()
    };
    let means: Vec<String> = (0..Weight::ALL.len()).map(|k| format!("{:.2}", over_best(k))).collect();
    println!("| {title} | {} |", means.join(" | "));
}

/// The errors of one mesh, see [`TITLES`].
fn measure(surface: &Surface, mesh: &Mesh, weight: Weight) -> nagata::error::Result<Errors> {
    let options = NormalOptions { weight, feature_angle: 90.0, ..NormalOptions::default() };
    let facets = Facets::new(mesh, false)?;
    let normals = Means::new(&facets, weight, 90f64.to_radians(), &Controls::default(), |_, _| false).normals;
    let patches = patches_from_mesh(mesh, Smoothing::Nagata, &options, false)?;
    let mut errors = Errors::default();
    let mut counts = [0.0; 2];
    for (f, k) in facets.corners() {
        let end = patches[f].on_boundary[k] as usize;
        let error = angle(&normals.corners[f][k], &(surface.level)(facets.point(f, k)).1).to_degrees();
        errors[2 * end] += error * error;
        counts[end] += 1.0;
        errors[2 * end + 1] = errors[2 * end + 1].max(error);
    }
    for end in 0..2 {
        errors[2 * end] = (errors[2 * end] / f64::max(counts[end], 1.0)).sqrt();
    }
    for patch in patches.iter().filter(|patch| patch.on_boundary == [false; 4]) {
        for k in 0..49 {
            let (s, t) = ((k % 7) as f64 / 6.0, (k / 7) as f64 / 6.0);
            let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
            let (value, gradient) = (surface.level)(&patch.point(xi));
            errors[4] = errors[4].max(value.abs() / gradient.norm());
            errors[5] = errors[5].max(angle(&patch.normal(xi), &gradient).to_degrees());
        }
    }
    Ok(errors)
}

struct Surface {
    name: &'static str,
    /// F and its gradient.
    level: fn(&Vec3) -> (f64, Vec3),
    nodes: Nodes,
}

enum Nodes {
    /// The image of the unit square, with so many times more facets along the first side than along the second.
    Sheet(fn(f64, f64) -> Vec3, usize),
    /// The image of the unit sphere, meshed like a cube.
    Ball(fn(&Vec3) -> Vec3),
}

const SURFACES: [Surface; 8] = [
    Surface { name: "sphere", level: level_of_sphere, nodes: Nodes::Ball(|x| *x) },
    Surface {
        name: "sphere, long facets",
        level: level_of_sphere,
        nodes: Nodes::Sheet(
            |s, t| {
                let (a, b) = (0.8 * s, 1.6 * (t - 0.5));
                Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin())
            },
            3,
        ),
    },
    Surface {
        name: "ellipsoid",
        level: |x| {
            let scaled = Vec3::new(x.x, x.y / 0.36, x.z / 0.09);
            (0.5 * (x.dot(&scaled) - 1.0), scaled)
        },
        nodes: Nodes::Ball(|x| Vec3::new(x.x, 0.6 * x.y, 0.3 * x.z)),
    },
    Surface {
        name: "torus",
        level: |x| {
            let ring = Vec3::new(x.x, x.y, 0.0).normalize();
            (0.5 * ((x - ring).norm_squared() - 0.16), x - ring)
        },
        nodes: Nodes::Sheet(
            |s, t| {
                let (a, b) = (1.5 * PI * s, 1.5 * PI * t);
                let radius = 1.0 + 0.4 * b.cos();
                Vec3::new(radius * a.cos(), radius * a.sin(), 0.4 * b.sin())
            },
            2,
        ),
    },
    Surface { name: "cylinder, facets 1:3", level: level_of_cylinder, nodes: Nodes::Sheet(graded_cylinder, 1) },
    Surface {
        name: "saddle",
        level: |x| (x.z - 0.5 * (x.x * x.x - x.y * x.y), Vec3::new(-x.x, x.y, 1.0)),
        nodes: Nodes::Sheet(
            |s, t| {
                let (x, y) = (2.0 * s - 1.0, 2.0 * t - 1.0);
                Vec3::new(x, y, 0.5 * (x * x - y * y))
            },
            1,
        ),
    },
    Surface {
        name: "waves",
        level: level_of_waves,
        nodes: Nodes::Sheet(|s, t| waves(2.0 * s - 1.0, 2.0 * t - 1.0), 1),
    },
    Surface {
        name: "waves, facets 1:3",
        level: level_of_waves,
        nodes: Nodes::Sheet(|s, t| waves(s * (1.0 + s) - 1.0, t * (1.0 + t) - 1.0), 1),
    },
];

fn level_of_sphere(x: &Vec3) -> (f64, Vec3) {
    (0.5 * (x.norm_squared() - 1.0), *x)
}

fn level_of_cylinder(x: &Vec3) -> (f64, Vec3) {
    let across = Vec3::new(x.x, x.y, 0.0);
    (0.5 * (across.norm_squared() - 1.0), across)
}

fn graded_cylinder(s: f64, t: f64) -> Vec3 {
    let a = 1.5 * s * (1.0 + s);
    Vec3::new(a.cos(), a.sin(), t * (1.0 + t))
}

fn level_of_waves(x: &Vec3) -> (f64, Vec3) {
    let ((sin, cos), (sin2, cos2)) = ((3.0 * x.x).sin_cos(), (2.0 * x.y).sin_cos());
    (x.z - 0.2 * sin * cos2, Vec3::new(-0.6 * cos * cos2, 0.4 * sin * sin2, 1.0))
}

fn waves(x: f64, y: f64) -> Vec3 {
    Vec3::new(x, y, 0.2 * (3.0 * x).sin() * (2.0 * y).cos())
}

impl Surface {
    fn mesh(&self, n: usize, triangles: bool, disturbed: bool) -> Mesh {
        let mut random = Random(1);
        let amount = if disturbed { 0.25 } else { 0.0 };
        let (points, quads) = match &self.nodes {
            Nodes::Sheet(map, ratio) => sheet(n * ratio, n, amount, &mut random, map),
            Nodes::Ball(map) => ball(n, amount, &mut random, map),
        };
        let mut mesh = Mesh { source: self.name.into(), points, ..Mesh::default() };
        for [a, b, c, d] in quads {
            let mut push = |nodes: [u32; 4], count| mesh.facets.push(Facet { count, nodes, id: 0 });
            match (triangles, disturbed && random.next() < 0.0) {
                (false, _) => push([a, b, c, d], 4),
                (true, false) => [[a, b, c, c], [a, c, d, d]].into_iter().for_each(|nodes| push(nodes, 3)),
                (true, true) => [[b, c, d, d], [b, d, a, a]].into_iter().for_each(|nodes| push(nodes, 3)),
            }
        }
        mesh
    }
}

type Quads = (Vec<[f64; 3]>, Vec<[u32; 4]>);

/// m by n quadrilaterals; nodes inside are moved by up to `amount` times a facet.
fn sheet(m: usize, n: usize, amount: f64, random: &mut Random, map: &dyn Fn(f64, f64) -> Vec3) -> Quads {
    let (mut points, mut quads) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=m {
            let inside = i % m != 0 && j % n != 0;
            let moved = [i, j].map(|k| k as f64 + if inside { amount * random.next() } else { 0.0 });
            points.push(map(moved[0] / m as f64, moved[1] / n as f64).into());
        }
    }
    for j in 0..n {
        for i in 0..m {
            let [a, b] = [j * (m + 1) + i, (j + 1) * (m + 1) + i].map(|k| k as u32);
            quads.push([a, a + 1, b + 1, b]);
        }
    }
    (points, quads)
}

/// A cube blown up, n by n quadrilaterals on each face.
fn ball(n: usize, amount: f64, random: &mut Random, map: &dyn Fn(&Vec3) -> Vec3) -> Quads {
    let (mut points, mut quads) = (Vec::new(), Vec::new());
    let mut numbers = std::collections::HashMap::new();
    let tan = |k: usize| (FRAC_PI_4 * (2.0 * k as f64 / n as f64 - 1.0)).tan();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let mut node = |i: usize, j: usize| {
            let mut cube = Vec3::zeros();
            let (next, last) = if side > 0.0 { (i, j) } else { (j, i) };
            (cube[axis], cube[(axis + 1) % 3], cube[(axis + 2) % 3]) = (side, tan(next), tan(last));
            let key: [i64; 3] = cube.map(|x| (1e9 * x).round() as i64).into();
            *numbers.entry(key).or_insert_with(|| {
                let shift = Vec3::from_fn(|_, _| random.next()) * (amount * FRAC_PI_4 / n as f64);
                points.push(map(&(cube.normalize() + shift).normalize()).into());
                points.len() as u32 - 1
            })
        };
        for j in 0..n {
            for i in 0..n {
                quads.push([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
            }
        }
    }
    (points, quads)
}

/// Evenly distributed numbers between -1 and 1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // Multiplier and increment of Knuth's MMIX.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
