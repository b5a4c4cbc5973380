//! Meshes and patches that the tests of several modules share.

use super::facets::Facets;
use super::from_mesh::patches_from_mesh;
use super::nagata::edge_coefficient;
use super::normals::NormalOptions;
use super::patch::Patch;
use super::piece::Edge;
use crate::Vec3;
use crate::mesh::{Facet, Mesh};
use crate::surface::Bezier;
use crate::surface::Smoothing;
use proptest::prelude::*;

/// A mesh of facets numbered from 101.
pub fn mesh_of(points: Vec<[f64; 3]>, facets: &[&[u32]]) -> Mesh {
    let facet = |(k, nodes): (usize, &&[u32])| Facet {
        count: nodes.len() as u8,
        nodes: std::array::from_fn(|j| *nodes.get(j).unwrap_or(&nodes[0])),
        id: 101 + k as u64,
    };
    Mesh {
        source: "test".into(),
        point_ids: (1..=points.len() as u64).collect(),
        points,
        facets: facets.iter().enumerate().map(facet).collect(),
        ..Mesh::default()
    }
}

/// The image of the unit square, m by n quadrilaterals or twice as many triangles.
pub fn grid(m: usize, n: usize, triangles: bool, map: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let mut points = Vec::new();
    for j in 0..=n {
        points.extend((0..=m).map(|i| map(i as f64 / m as f64, j as f64 / n as f64)));
    }
    let mut quads = Vec::new();
    for j in 0..n {
        for i in 0..m {
            let [a, b] = [j * (m + 1) + i, (j + 1) * (m + 1) + i].map(|k| k as u32);
            quads.push([a, a + 1, b + 1, b]);
        }
    }
    from_quads(points, &quads, triangles)
}

fn from_quads(points: Vec<[f64; 3]>, quads: &[[u32; 4]], triangles: bool) -> Mesh {
    if !triangles {
        return mesh_of(points, &quads.iter().map(|q| &q[..]).collect::<Vec<_>>());
    }
    let halves: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    mesh_of(points, &halves.iter().map(|t| &t[..]).collect::<Vec<_>>())
}

/// A profile in the plane z = 0 drawn out over -0.5 <= z <= 1.5; its outside is on the right of the way along it.
pub fn strip(profile: &[[f64; 2]], across: usize, triangles: bool) -> Mesh {
    let m = profile.len() - 1;
    grid(m, across, triangles, |s, t| {
        let [x, y] = profile[(s * m as f64).round() as usize];
        [x, y, -0.5 + 2.0 * t]
    })
}

/// The ironing indenter: width 40, fillets of radius 10 in 4 facets each, 8 along the bottom, 5 up each side.
pub fn indenter(across: usize, triangles: bool) -> Mesh {
    let quarter = |k: i32| std::f64::consts::FRAC_PI_2 * k as f64 / 4.0;
    let mut profile: Vec<[f64; 2]> = (0..5).map(|k| [-20.0, 40.0 - 6.0 * k as f64]).collect();
    profile.extend((0..4).map(|k| [-10.0 - 10.0 * quarter(k).cos(), 10.0 - 10.0 * quarter(k).sin()]));
    profile.extend((0..8).map(|k| [-10.0 + 2.5 * k as f64, 0.0]));
    profile.extend((0..4).map(|k| [10.0 + 10.0 * quarter(k).sin(), 10.0 - 10.0 * quarter(k).cos()]));
    profile.extend((0..6).map(|k| [20.0, 10.0 + 6.0 * k as f64]));
    strip(&profile, across, triangles)
}

/// Outward normal of the exact indenter at a point of it.
pub fn indenter_normal(x: &Vec3) -> Vec3 {
    let core = Vec3::new(x.x.clamp(-10.0, 10.0), x.y.max(10.0), x.z);
    (x - core).normalize()
}

/// The first faces of a cube blown up to the unit sphere, n by n facets each.
pub fn cubed_sphere(n: usize, triangles: bool, faces: usize) -> Mesh {
    let frames: [[Vec3; 3]; 6] = [
        [Vec3::x(), Vec3::y(), Vec3::z()],
        [Vec3::y(), Vec3::x(), -Vec3::z()],
        [Vec3::y(), Vec3::z(), Vec3::x()],
        [Vec3::z(), Vec3::y(), -Vec3::x()],
        [Vec3::z(), Vec3::x(), Vec3::y()],
        [Vec3::x(), Vec3::z(), -Vec3::y()],
    ];
    let (mut points, mut quads) = (Vec::<[f64; 3]>::new(), Vec::new());
    let mut numbers = std::collections::HashMap::new();
    let angle = |k: usize| std::f64::consts::FRAC_PI_4 * (2.0 * k as f64 / n as f64 - 1.0);
    for [a, b, c] in &frames[..faces] {
        let mut node = |i: usize, j: usize| {
            let x: [f64; 3] = (a * angle(i).tan() + b * angle(j).tan() + c).normalize().into();
            *numbers.entry(x.map(|x| (x * 1e9).round() as i64)).or_insert_with(|| {
                points.push(x);
                points.len() as u32 - 1
            })
        };
        for j in 0..n {
            for i in 0..n {
                quads.push([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
            }
        }
    }
    from_quads(points, &quads, triangles)
}

/// The patches of [`cubed_sphere`] with the exact normals.
pub fn sphere_patches(n: usize, triangles: bool, faces: usize, smoothing: Smoothing) -> Vec<Patch> {
    let mesh = cubed_sphere(n, triangles, faces);
    let options = NormalOptions { feature_angle: 90.0, ..NormalOptions::default() };
    let mut patches = patches_from_mesh(&mesh, smoothing, &options, false).unwrap();
    let facets = Facets::new(&mesh, false).unwrap();
    if smoothing == Smoothing::Nagata {
        for (f, patch) in patches.iter_mut().enumerate() {
            for k in 0..facets.count(f) {
                patch.coefficients[k] =
                    edge_coefficient(&facets.edge(f, k), facets.point(f, k), facets.point(f, k + 1));
            }
        }
    }
    patches
}

/// A patch of its own with the given nodes and normals.
pub fn patch(nodes: &[Vec3], normals: &[Vec3]) -> Patch {
    let count = nodes.len();
    let mut patch = Patch {
        id: 7,
        count: count as u8,
        nodes: std::array::from_fn(|k| nodes[k % count]),
        coefficients: [Vec3::zeros(); 4],
        middle: Vec3::zeros(),
        edges: [Edge::Boundary; 4],
        on_boundary: [true; 4],
        deviation: 0.0,
    };
    for k in 0..count {
        let j = (k + 1) % count;
        patch.coefficients[k] = edge_coefficient(&(nodes[j] - nodes[k]), &normals[k], &normals[j]);
    }
    patch
}

/// A curved quadrilateral without symmetry and its nodal normals.
pub fn wavy_quad() -> (Patch, Vec<Vec3>) {
    let nodes =
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.05], [1.1, 1.0, 0.1], [-0.05, 0.9, 0.08]].map(|[x, y, z]| Vec3::new(x, y, z));
    let normals = [[-0.24, -0.3, 1.0], [0.18, -0.3, 1.0], [0.2, 0.15, 1.0], [-0.25, 0.1, 1.0]]
        .map(|[x, y, z]| Vec3::new(x, y, z).normalize());
    (patch(&nodes, &normals), normals.to_vec())
}

/// A curved triangle without symmetry and its nodal normals.
pub fn wavy_triangle() -> (Patch, Vec<Vec3>) {
    let (quad, normals) = wavy_quad();
    (patch(&quad.nodes[..3], &normals[..3]), normals[..3].to_vec())
}

/// A quadrilateral on the unit sphere, about half a radius wide.
pub fn sphere_quad() -> (Patch, Vec<Vec3>) {
    let nodes = [[-0.2, -0.3], [0.3, -0.2], [0.25, 0.3], [-0.3, 0.2]].map(|[x, y]| Vec3::new(x, y, 1.0).normalize());
    (patch(&nodes, &nodes), nodes.to_vec())
}

/// A triangle on the unit sphere, about half a radius wide.
pub fn sphere_triangle() -> (Patch, Vec<Vec3>) {
    let (quad, normals) = sphere_quad();
    (patch(&quad.nodes[..3], &normals[..3]), normals[..3].to_vec())
}

/// Rational Bézier patches of degrees up to `most`, with control points in a cube of side 2 and so with folds.
pub fn random_bezier(most: usize) -> impl Strategy<Value = Bezier> {
    [1..=most, 1..=most].prop_flat_map(|degrees| {
        let count = (degrees[0] + 1) * (degrees[1] + 1);
        let points = prop::collection::vec([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_map(Vec3::from), count);
        let weights = prop_oneof![Just(vec![1.0; count]), prop::collection::vec(0.3..3.0_f64, count)];
        (points, weights).prop_map(move |(points, weights)| Bezier::new(degrees, points, weights).unwrap())
    })
}
