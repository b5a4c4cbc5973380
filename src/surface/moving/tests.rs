use super::*;
use crate::Mat3;
use crate::controls::Controls;
use crate::mesh::Mesh;
use crate::surface::test_meshes::{cubed_sphere, grid, indenter, indenter_normal, strip};
use crate::surface::{NormalOptions, Polygon, patches_from_mesh};
use nalgebra::Rotation3;
use proptest::prelude::*;

fn numbers(mesh: &Mesh) -> Vec<u64> {
    (0..mesh.points.len() as u64).collect()
}

fn patches(mesh: &Mesh, smoothing: Smoothing) -> Vec<MovingPatch> {
    MovingPatch::all(mesh, &numbers(mesh), smoothing, 50.0, &[], &Controls::default()).unwrap()
}

fn positions(patch: &MovingPatch, mesh: &Mesh) -> Vec<Vec3> {
    patch.nodes.iter().map(|n| Vec3::from(mesh.points[*n as usize])).collect()
}

/// Numbers between -1 and 1, always the same.
fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn perturb(positions: &mut [Vec3], by: f64) {
    positions.iter_mut().enumerate().for_each(|(i, x)| *x += Vec3::from_fn(|d, _| by * noise(3 * i + d)));
}

/// Patches of every kind, with displaced nodes: surrounded and at ends, quadrilaterals and triangles, round and flat.
pub fn samples(smoothing: Smoothing) -> Vec<(MovingPatch, Vec<Vec3>)> {
    let dome = |s: f64, t: f64| [3.0 * s, 3.0 * t, 0.4 * (s - s * s) + 0.5 * (t - t * t) + 0.2 * s * t];
    let flat = |s: f64, t: f64| [3.0 * s, 3.0 * t, 0.0];
    let bend: Vec<[f64; 2]> = (0..=6).map(|k| 0.3 * k as f64).map(|a| [-a.cos(), a.sin()]).collect();
    let mut samples = Vec::new();
    for triangles in [false, true] {
        for (mesh, chosen) in [
            (grid(3, 3, triangles, dome), [4, 0, 1]),
            (grid(3, 3, triangles, flat), [4, 2, 3]),
            (strip(&bend, 1, triangles), [3, 0, 5]),
            (indenter(2, triangles), [12, 14, 0]),
        ] {
            let all = patches(&mesh, smoothing);
            for f in chosen {
                let patch = all[if triangles { 2 * f } else { f }].clone();
                let mut x = positions(&patch, &mesh);
                let size = (x[1] - x[0]).norm();
                perturb(&mut x, 0.03 * size);
                if smoothing == Smoothing::Facet {
                    if triangles {
                        samples.push(quadratic(&patch, &x));
                        samples.extend([0, 3].map(|at| quarter_of_six(&patch, &x, at)));
                    } else {
                        samples.push(quarter(&patch, &x));
                    }
                }
                samples.push((patch, x));
            }
        }
    }
    samples
}

/// A facet with nodes near the middles of its edges, too.
fn quadratic(patch: &MovingPatch, x: &[Vec3]) -> (MovingPatch, Vec<Vec3>) {
    let (mut patch, mut x) = (patch.clone(), x.to_vec());
    patch.bend_through([97, 98, 99]);
    let size = (x[1] - x[0]).norm();
    x.extend(
        (0..3)
            .map(|k| (x[k] + x[(k + 1) % 3]) * 0.5 + Vec3::new(0.1, -0.05, 0.2) * (noise(k + 7) * size))
            .collect::<Vec<_>>(),
    );
    (patch, x)
}

/// A facet as a quarter of a face of nine nodes, which are near where a plane face would have them.
fn quarter(patch: &MovingPatch, x: &[Vec3]) -> (MovingPatch, Vec<Vec3>) {
    let (mut patch, mut x) = (patch.clone(), x.to_vec());
    let [a, ab, all, da] = [0, 1, 2, 3].map(|k| patch.nodes[k]);
    patch.bend_as_quarter(&[a, 93, 94, 95, ab, 96, 97, da, all]);
    let size = (x[1] - x[0]).norm();
    let (along, across) = (x[1] - x[0], x[3] - x[0]);
    let rest = [x[1] + along, x[2] * 2.0 - x[0], x[3] + across, x[2] + along, x[2] + across];
    let off = |(k, x): (usize, Vec3)| x + Vec3::new(0.1, -0.05, 0.2) * (noise(k + 7) * size);
    x.extend(rest.into_iter().enumerate().map(off));
    (patch, x)
}

/// A facet as the quarter at the corner of a triangle of six nodes, or that between its middles.
fn quarter_of_six(patch: &MovingPatch, x: &[Vec3], at: usize) -> (MovingPatch, Vec<Vec3>) {
    let (mut patch, mut x) = (patch.clone(), x.to_vec());
    let [a, b, c] = [0, 1, 2].map(|k| patch.nodes[k]);
    let size = (x[1] - x[0]).norm();
    let rest = if at < 3 {
        patch.bend_as_quarter(&[a, 93, 94, b, 95, c]);
        [x[1] * 2.0 - x[0], x[2] * 2.0 - x[0], x[1] + x[2] - x[0]]
    } else {
        patch.bend_as_quarter(&[93, 94, 95, a, b, c]);
        [x[0] + x[2] - x[1], x[0] + x[1] - x[2], x[1] + x[2] - x[0]]
    };
    let off = |(k, x): (usize, Vec3)| x + Vec3::new(0.1, -0.05, 0.2) * (noise(k + 7) * size);
    x.extend(rest.into_iter().enumerate().map(off));
    (patch, x)
}

/// The shape functions of a face of nine nodes at s and t from 0 to 1 are what its quarters have, whichever corner comes first.
#[test]
fn quarters_have_the_shape_of_their_face() {
    let along = |s: f64| [(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)];
    let at = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];
    let place =
        |k: usize| Vec3::new(at[k][0] as f64, at[k][1] as f64, 0.0) + Vec3::from_fn(|d, _| 0.3 * noise(3 * k + d));
    let facet = &patches(&grid(1, 1, false, dome), Smoothing::Facet)[0];
    for first in 0..4 {
        // As the face is named from the corner of the quarter.
        let nine: [u64; 9] = std::array::from_fn(|k| match k {
            8 => 8,
            _ => (k / 4 * 4 + (k % 4 + first) % 4) as u64,
        });
        for turned in 0..4 {
            let mut patch = facet.clone();
            patch.nodes = [nine[0], nine[4], nine[8], nine[7]].to_vec();
            patch.nodes.rotate_left(turned);
            patch.bend_as_quarter(&nine);
            assert_eq!(patch.nodes.len(), 9);
            let x: Vec<Vec3> = patch.nodes.iter().map(|&n| place(n as usize)).collect();
            for xi in [XI, [0.0, 1.0], [1.0, 1.0], [0.2, 0.9]] {
                // From the corner into the face.
                let [s, t] = xi.map(|x| 0.5 * x);
                let [s, t] = [[s, t], [1.0 - t, s], [1.0 - s, 1.0 - t], [t, 1.0 - s]][first];
                let exact: Vec3 = (0..9).map(|k| place(k) * (along(s)[at[k][0]] * along(t)[at[k][1]])).sum();
                assert!((patch.shape(&x).point(xi) - exact).norm() < 1e-14);
                let shared: Vec3 = patch.shape_functions(xi).iter().zip(&x).map(|(n, x)| x * *n).sum();
                assert!((shared - exact).norm() < 1e-14);
            }
        }
    }
}

/// The same of a face of six nodes.
#[test]
fn quarters_of_triangles_have_the_shape_of_their_face() {
    let place = |n: u64| {
        let at = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][n as usize];
        Vec3::new(at[0], at[1], 0.0) + Vec3::from_fn(|d, _| 0.3 * noise(3 * n as usize + d))
    };
    let facet = &patches(&grid(1, 1, true, dome), Smoothing::Facet)[0];
    for first in 0..4 {
        let six: [u64; 6] = std::array::from_fn(|k| (k / 3 * 3 + (k % 3 + first) % 3) as u64);
        let corners = if first < 3 { [six[0], six[3], six[5]] } else { [six[3], six[4], six[5]] };
        for turned in 0..3 {
            let mut patch = facet.clone();
            patch.nodes = corners.to_vec();
            patch.nodes.rotate_left(turned);
            patch.bend_as_quarter(&six);
            assert_eq!((patch.nodes.len(), patch.own()), (6, 6));
            let x: Vec<Vec3> = patch.nodes.iter().map(|&n| place(n)).collect();
            for [e, z] in [XI, [0.0, 0.0], [1.0, 1.0], [0.9, 0.2]] {
                // Where its corners are in the face.
                let of = |n: u64| match n {
                    0..3 => std::array::from_fn(|i| f64::from(u8::from(i == n as usize))),
                    _ => std::array::from_fn(|i| if i == (n as usize - 1) % 3 { 0.0 } else { 0.5 }),
                };
                let [p, q, r]: [[f64; 3]; 3] = [0, 1, 2].map(|k| of(patch.nodes[k]));
                let b: [f64; 3] = std::array::from_fn(|i| (1.0 - e) * p[i] + (e - z) * q[i] + z * r[i]);
                let exact: Vec3 = (0..3)
                    .map(|k| {
                        let next = (k + 1) % 3;
                        place(k as u64) * (b[k] * (2.0 * b[k] - 1.0)) + place(3 + k as u64) * (4.0 * b[k] * b[next])
                    })
                    .sum();
                assert!((patch.shape(&x).point([e, z]) - exact).norm() < 1e-14);
                let shared: Vec3 = patch.shape_functions([e, z]).iter().zip(&x).map(|(n, x)| x * *n).sum();
                assert!((shared - exact).norm() < 1e-14);
            }
        }
    }
}

/// A quarter of a dome, and the planes x = 0 and y = 0 in which it goes on.
const PLANES: [(Vec3, Vec3); 2] =
    [(Vec3::new(0.0, 0.0, 0.7), Vec3::new(1.0, 0.0, 0.0)), (Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, -2.0, 0.0))];

fn dome(s: f64, t: f64) -> [f64; 3] {
    [3.0 * s, 3.0 * t, 1.1 * (1.0 - s * s) - 0.7 * t * t + 0.3 * s * s * t * t]
}

/// Patches in one and two symmetry planes, also at ends of the surface, with displaced nodes.
fn mirrored_samples() -> Vec<(MovingPatch, Vec<Vec3>)> {
    let mut samples = Vec::new();
    for triangles in [false, true] {
        let mesh = grid(3, 3, triangles, dome);
        let all =
            MovingPatch::all(&mesh, &numbers(&mesh), Smoothing::Nagata, 50.0, &PLANES, &Controls::default()).unwrap();
        for f in [0, 1, 2, 6] {
            let patch = all[if triangles { 2 * f } else { f }].clone();
            let mut x = positions(&patch, &mesh);
            perturb(&mut x, 0.03);
            samples.push((patch, x));
        }
    }
    samples
}

/// Sixth-order difference of `f` by component `d` of node `j`.
fn difference<const N: usize>(
    x: &[Vec3],
    j: usize,
    d: usize,
    f: impl Fn(&[Vec3]) -> nalgebra::SVector<f64, N>,
) -> nalgebra::SVector<f64, N> {
    let h = 4e-4 * (x[1] - x[0]).norm();
    let at = |s: f64| {
        let mut x = x.to_vec();
        x[j][d] += s * h;
        f(&x)
    };

    (at(1.0) - at(-1.0)) * (0.75 / h) - (at(2.0) - at(-2.0)) * (0.15 / h) + (at(3.0) - at(-3.0)) * (1.0 / (60.0 * h))
}

const XI: [f64; 2] = [0.63, 0.27];

/// The samples have every rule: means, and ends with one and two directions, one and more neighbours.
#[test]
fn the_samples_have_every_rule() {
    let rules: Vec<NormalRule> = samples(Smoothing::Nagata).into_iter().flat_map(|(patch, _)| patch.normals).collect();
    let ends = |wanted: u8, several: bool| {
        rules.iter().any(|rule| match rule {
            NormalRule::End { directions, neighbours, .. } => {
                *directions == wanted && (neighbours.len() > wanted as usize) == several
            }
            NormalRule::Mean { .. } => false,
        })
    };
    assert!(rules.iter().any(|rule| matches!(rule, NormalRule::Mean { .. })));
    assert!(ends(1, false) && ends(2, false) && ends(2, true), "{rules:?}");
}

/// With several neighbours in one direction, and where the normal would lean too much, which no sample does.
#[test]
fn rare_ends_have_their_derivatives() {
    let neighbours = |wide: f64| vec![(1, 0, [0.7, wide]), (2, 1, [0.4, -0.9])];
    for (directions, wide, lean) in [(1, 0.0, 0.2), (2, 0.5, 0.2), (2, 0.5, 3.0)] {
        let end = neighbours(wide).into_iter().map(|(node, normal, weights)| Neighbour { node, normal, weights });
        let mean = |node: u32| NormalRule::Mean {
            node,
            spokes: vec![3, 4, 5],
            corners: vec![[0, 1], [1, 2], [2, 0]],
            within: None,
        };
        let patch = MovingPatch {
            id: 0,
            count: 3,
            nodes: (0..6).collect(),
            edges: [Edge::Smooth; 4],
            straight: [false; 4],
            on_boundary: [false; 4],
            component: 5,
            normals: vec![mean(1), mean(2), NormalRule::End { node: 0, neighbours: end.collect(), directions }],
            corners: [2, 0, 1, 0],
            bulge: 0.7,
            quadratic: None,
        };
        let x: Vec<Vec3> =
            [[0.0, 0.0, 0.0], [1.0, 0.1, 0.1], [0.3, 0.9, 0.2], [1.5, 1.6, -lean], [-0.7, 0.6, 0.1], [0.5, -1.0, 0.0]]
                .map(Vec3::from)
                .to_vec();
        let force = Vec3::new(0.3, -0.5, 0.8);
        let mut variation = Variation::default();
        patch.vary(&x, XI, &mut variation);
        patch.bend(Transfer::Variational, &variation.on_handles(&force), &mut variation);
        let other = std::cell::RefCell::new(Variation::default());
        for (j, d) in (0..6).flat_map(|j| (0..3).map(move |d| (j, d))) {
            let by = difference::<3>(&x, j, d, |x| patch.shape(x).point(XI));
            assert!((variation.by_node(j)[0].column(d) - by).norm() < 1e-9, "{directions} {lean}: {by}");
            for i in 0..6 {
                let by = difference::<3>(&x, j, d, |x| {
                    let v = &mut other.borrow_mut();
                    patch.vary(x, XI, v);
                    v.weight(Transfer::Variational, i)[0].tr_mul(&force)
                });
                assert!((variation.second(i, j).column(d) - by).norm() < 1e-8, "{directions} {lean}: {by}");
            }
        }
    }
}

#[test]
fn first_derivatives_match_differences() {
    for smoothing in [Smoothing::Facet, Smoothing::Nagata] {
        for (patch, x) in samples(smoothing).into_iter().chain(mirrored_samples()) {
            let mut variation = Variation::default();
            patch.vary(&x, XI, &mut variation);
            assert_eq!(variation.local, patch.shape(&x).local(XI));
            let size = (x[1] - x[0]).norm();
            for j in 0..x.len() {
                for d in 0..3 {
                    let by = difference::<9>(&x, j, d, |x| {
                        let local = patch.shape(x).local(XI);
                        nalgebra::SVector::from_iterator(
                            [local.point, local.tangents[0], local.tangents[1]].iter().flat_map(|v| [v.x, v.y, v.z]),
                        )
                    });
                    let rows = variation.by_node(j);
                    for a in 0..3 {
                        let error = (rows[a].column(d) - by.fixed_rows::<3>(3 * a)).norm();
                        assert!(error < 1e-9, "node {j} of {patch:?}: {error:e} of {by}, size {size}");
                    }
                }
            }
        }
    }
}

#[test]
fn second_derivatives_match_differences() {
    let force = Vec3::new(0.3, -0.5, 0.8);
    for smoothing in [Smoothing::Facet, Smoothing::Nagata] {
        for (patch, x) in samples(smoothing).into_iter().chain(mirrored_samples()) {
            let (mut variation, other) = (Variation::default(), std::cell::RefCell::new(Variation::default()));
            let size = (x[1] - x[0]).norm();
            for transfer in [Transfer::Variational, Transfer::Patch, Transfer::Bilinear] {
                patch.vary(&x, XI, &mut variation);
                patch.bend(transfer, &variation.on_handles(&force), &mut variation);
                for j in 0..x.len() {
                    for k in 0..x.len() {
                        for d in 0..3 {
                            let by = difference::<3>(&x, k, d, |x| {
                                let v = &mut other.borrow_mut();
                                patch.vary(x, XI, v);
                                v.weight(transfer, j)[0].tr_mul(&force)
                            });
                            let error = (variation.second(j, k).column(d) - by).norm() * size;
                            assert!(error < 2e-9, "{transfer:?}, {j} {k} {d} of {patch:?}: {error:e} of {by}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn weights_change_with_the_parameters_as_they_say() {
    for (patch, x) in samples(Smoothing::Nagata) {
        let (mut here, mut there, h) = (Variation::default(), [Variation::default(), Variation::default()], 1e-3);
        patch.vary(&x, XI, &mut here);
        for a in 0..2 {
            for (s, v) in [1.0, -1.0].into_iter().zip(&mut there) {
                patch.vary(&x, std::array::from_fn(|b| XI[b] + if a == b { s * h } else { 0.0 }), v);
            }
            for j in 0..x.len() {
                for transfer in [Transfer::Variational, Transfer::Patch, Transfer::Bilinear] {
                    // The weights are cubic, and their third derivatives are small.
                    let by = (there[0].weight(transfer, j)[0] - there[1].weight(transfer, j)[0]) / (2.0 * h);
                    assert!((by - here.weight(transfer, j)[1 + a]).amax() < 1e-5);
                }
            }
        }
    }
}

/// Force balance whatever the transfer, moment balance with the variational one.
#[test]
fn forces_are_spread_in_balance() {
    let force = Vec3::new(0.3, -0.5, 0.8);
    let mut defects = [0.0_f64; 3];
    for smoothing in [Smoothing::Facet, Smoothing::Nagata] {
        for (patch, x) in samples(smoothing) {
            let mut variation = Variation::default();
            patch.vary(&x, XI, &mut variation);
            let size = (x[1] - x[0]).norm();
            for (t, transfer) in [Transfer::Variational, Transfer::Patch, Transfer::Bilinear].into_iter().enumerate() {
                let spread = |j: usize| variation.weight(transfer, j)[0].tr_mul(&force);
                let sum: Vec3 = (0..x.len()).map(spread).sum();
                let moment: Vec3 = (0..x.len()).map(|j| (x[j] - variation.local.point).cross(&spread(j))).sum();
                assert!((sum - force).norm() < 1e-14, "{transfer:?} {}", (sum - force).norm());
                defects[t] = defects[t].max(moment.norm() / size);
                if smoothing == Smoothing::Facet {
                    assert!(moment.norm() < 1e-14 * size);
                }
            }
        }
    }
    assert!(defects[0] < 1e-13, "{defects:?}");
    assert!(defects[1..].iter().all(|d| *d > 1e-3 && *d < 0.2), "{defects:?}");
}

#[test]
fn patches_move_rigidly_with_their_nodes() {
    let rotation = Rotation3::from_euler_angles(0.7, -1.2, 2.3);
    for (patch, x) in samples(Smoothing::Nagata) {
        let moved: Vec<Vec3> = x.iter().map(|x| rotation * x + Vec3::new(3.0, 1.0, -2.0)).collect();
        let (here, there) = (patch.shape(&x), patch.shape(&moved));
        for k in 0..patch.count as usize {
            assert!((rotation * here.coefficients[k] - there.coefficients[k]).norm() < 1e-13);
        }
        let scaled: Vec<Vec3> = x.iter().map(|x| x * 1e-3).collect();
        assert!((patch.shape(&scaled).point(XI) - here.point(XI) * 1e-3).norm() < 1e-16);
    }
}

/// Moved nodes, alike on all sides of the planes.
fn bent(mesh: &Mesh) -> Mesh {
    let mut bent = mesh.clone();
    for [x, y, z] in &mut bent.points {
        let (a, b) = (*x * *x, *y * *y);
        (*x, *y, *z) = (*x * (1.0 + 0.02 * b), *y * (1.1 + 0.01 * a * b), *z - 0.1 * b + 0.05 * a * b);
    }
    bent
}

/// The meshes of a quarter with its planes and of its whole, and the patches of both at each place (i, j) of the quarter.
type Quarter = ([Mesh; 2], Vec<([usize; 2], [MovingPatch; 2])>);

/// Of a surface that is given from the middle, 0, to the ends, 1.
fn quarter_and_whole(map: impl Fn(f64, f64) -> [f64; 3]) -> Quarter {
    let part = grid(3, 3, false, &map);
    let whole = grid(6, 6, false, |s, t| map(2.0 * s - 1.0, 2.0 * t - 1.0));
    let planar =
        MovingPatch::all(&part, &numbers(&part), Smoothing::Nagata, 50.0, &PLANES, &Controls::default()).unwrap();
    let of_whole = patches(&whole, Smoothing::Nagata);
    let places = (0..3).flat_map(|i| (0..3).map(move |j| [i, j]));
    let of = |[i, j]: [usize; 2]| ([i, j], [planar[3 * j + i].clone(), of_whole[6 * (j + 3) + i + 3].clone()]);
    let pairs = places.map(of).collect();
    ([part, whole], pairs)
}

/// A quarter with its planes is a quarter of the whole, wherever its nodes have gone.
#[test]
fn in_symmetry_planes_patches_are_those_of_the_whole() {
    let ([part, whole], pairs) = quarter_and_whole(dome);
    for ([i, j], [here, there]) in &pairs {
        let shape = |patch: &MovingPatch, mesh: &Mesh| patch.shape(&positions(patch, &bent(mesh)));
        let [here, there] = [shape(here, &part), shape(there, &whole)];
        for k in 0..4 {
            // Further out the surface ends.
            let off = (here.coefficients[k] - there.coefficients[k]).norm();
            assert!(off < 1e-14 || *i.max(j) == 2, "{i} {j} {k}: {off}");
            let ends = [here.nodes[k], here.nodes[(k + 1) % 4]];
            for d in (0..2).filter(|d| ends.iter().all(|x| x[*d] == 0.0)) {
                assert!(here.coefficients[k][d].abs() < 1e-15 && here.coefficients[k].norm() > 0.01);
            }
        }
    }
}

/// A ridge in a plane of symmetry is a crease as in the whole, also where it meets another plane: the faces beside it are flat.
#[test]
fn ridges_in_symmetry_planes_are_those_of_the_whole() {
    let roof = |s: f64, t: f64| [3.0 * s, 3.0 * t, -0.3 * s.abs()];
    let ([part, whole], pairs) = quarter_and_whole(roof);
    for ([i, j], [here, there]) in &pairs {
        for k in 0..4 {
            let of = |patch: &MovingPatch, mesh: &Mesh| patch.shape(&positions(patch, mesh)).coefficients[k];
            assert!(of(here, &part).norm().max(of(there, &whole).norm()) < 1e-15, "{i} {j} {k}");
            // Sharp edges stay straight as the ridge bends.
            let off = (of(here, &bent(&part)) - of(there, &bent(&whole))).norm();
            assert!(off < 1e-14 || *i.max(j) == 2, "{i} {j} {k}: {off}");
        }
    }
}

fn of_tool(mesh: &Mesh) -> Vec<Patch> {
    let options = NormalOptions { feature_angle: 50.0, ..NormalOptions::default() };
    patches_from_mesh(mesh, Smoothing::Nagata, &options, false).unwrap()
}

/// Arcs are exact, and so are the normals at their ends.
#[test]
fn round_surfaces_are_those_of_tools() {
    for triangles in [false, true] {
        for across in [1, 2] {
            let mesh = indenter(across, triangles);
            let moving = patches(&mesh, Smoothing::Nagata);
            let tools = of_tool(&mesh);
            for (patch, tool) in moving.iter().zip(&tools) {
                let shape = patch.shape(&positions(patch, &mesh));
                assert_eq!((shape.edges, shape.on_boundary, shape.nodes), (tool.edges, tool.on_boundary, tool.nodes));
                for k in 0..patch.count as usize {
                    let error = (shape.coefficients[k] - tool.coefficients[k]).norm();
                    assert!(error < 1e-12, "{across} {triangles} {k} of {}: {error:e}", patch.id);
                    let x = shape.nodes[k];
                    let normal = shape.normal(shape.corners(&[0.0; 4])[k]);
                    assert!((normal - indenter_normal(&x)).norm() < 1e-12 || shape.is_facet());
                }
            }
        }
        // Ball and cap: also with two directions at the corners of the cap.
        for faces in [1, 6] {
            let mesh = cubed_sphere(6, triangles, faces);
            let tools = of_tool(&mesh);
            for (patch, tool) in patches(&mesh, Smoothing::Nagata).iter().zip(&tools) {
                let shape = patch.shape(&positions(patch, &mesh));
                let error = |p: &Patch| (p.point(XI).norm() - 1.0).abs();
                let bound = if faces == 6 { error(tool) + 1e-14 } else { 4e-4 };
                assert!(error(&shape) < bound, "{:e} {:e}", error(&shape), error(tool));
            }
        }
    }
}

#[test]
fn flat_surfaces_stay_flat_and_their_derivatives_finite() {
    for triangles in [false, true] {
        let mesh = grid(4, 3, triangles, |s, t| [s + 0.1 * t * t, t, 0.0]);
        for patch in patches(&mesh, Smoothing::Nagata) {
            let x = positions(&patch, &mesh);
            assert!(patch.shape(&x).coefficients.iter().all(|c| c.norm() < 1e-15));
            let mut variation = Variation::default();
            patch.vary(&x, XI, &mut variation);
            patch.bend(Transfer::Variational, &variation.on_handles(&Vec3::z()), &mut variation);
            for j in 0..x.len() {
                let w = variation.weight(Transfer::Bilinear, j)[0];
                // In the plane the patch is bilinear; out of it, its normals bend it.
                assert!((variation.by_node(j)[0] - w).fixed_view::<2, 2>(0, 0).amax() < 1e-14);
                assert!((0..x.len()).all(|k| variation.second(j, k).iter().all(|v| v.is_finite())));
            }
        }
    }
}

/// A plane-strain strip keeps its normals in the plane.
#[test]
fn a_strip_one_element_wide_has_no_slope_across() {
    let bend: Vec<[f64; 2]> = (0..=6).map(|k| 0.3 * k as f64).map(|a| [-a.cos(), a.sin()]).collect();
    let mesh = strip(&bend, 1, false);
    for patch in patches(&mesh, Smoothing::Nagata) {
        let mut x = positions(&patch, &mesh);
        x.iter_mut().for_each(|x| *x += Vec3::new(0.1 * x.y, 0.2 * x.x * x.y, 0.0));
        let mut variation = Variation::default();
        patch.vary(&x, XI, &mut variation);
        assert!(variation.local.area_vector().z.abs() < 1e-15);
        for j in 0..x.len() {
            let sum: Mat3 =
                (0..x.len()).filter(|i| (x[*i] - x[j]).xy().norm() < 1e-9).map(|i| variation.by_node(i)[0]).sum();
            // A motion of both nodes of a line across stays in the plane.
            assert!(sum[(2, 0)].abs() < 1e-14 && sum[(2, 1)].abs() < 1e-14);
        }
    }
}

#[test]
fn survives_the_trip_through_numbers() {
    let samples = samples(Smoothing::Nagata).into_iter().chain(samples(Smoothing::Facet));
    let patches: Vec<MovingPatch> = samples.map(|(patch, _)| patch).collect();
    let numbers: Vec<f64> = patches.iter().flat_map(MovingPatch::to_numbers).collect();
    assert_eq!(MovingPatch::from_numbers(&numbers), patches);
    assert_eq!(MovingPatch::from_numbers(&numbers[..numbers.len() - 1]).len(), patches.len() - 1);
}

#[test]
fn surrounded_patches_depend_on_the_edges_around_them() {
    let mesh = cubed_sphere(5, false, 6);
    let all = patches(&mesh, Smoothing::Nagata);
    assert!(all.iter().all(|p| p.nodes.len() <= 12 && p.normals.len() == 4));
    assert_eq!(patches(&mesh, Smoothing::Facet)[0].nodes.len(), 4);
}

#[test]
fn too_many_facets_around_a_node_are_refused() {
    let count = 70;
    let mut points = vec![[0.0, 0.0, 1.0]];
    points.extend(
        (0..count).map(|k| 2.0 * std::f64::consts::PI * k as f64 / count as f64).map(|a| [a.cos(), a.sin(), 0.0]),
    );
    let facets: Vec<[u32; 3]> = (0..count).map(|k| [0, 1 + k, 1 + (k + 1) % count]).collect();
    let facets: Vec<&[u32]> = facets.iter().map(|f| &f[..]).collect();
    let mesh = crate::surface::test_meshes::mesh_of(points, &facets);
    let error =
        MovingPatch::all(&mesh, &numbers(&mesh), Smoothing::Nagata, 50.0, &[], &Controls::default()).unwrap_err();
    assert!(error.to_string().contains("more than 64 facets meet at a node of facet 1"), "{error}");
    assert!(MovingPatch::all(&mesh, &numbers(&mesh), Smoothing::Facet, 50.0, &[], &Controls::default()).is_ok());
}

fn unit() -> impl Strategy<Value = Vec3> {
    [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]
        .prop_map(|v| Vec3::new(v[0], v[1], v[2]))
        .prop_filter("no direction", |v| v.norm() > 0.1)
        .prop_map(|v| v.normalize())
}

proptest! {
    #[test]
    fn edges_are_regular_for_all_normals(d in unit(), n0 in unit(), n1 in unit(), size in 1e-3..1e3_f64) {
        let d = d * size;
        let c = edge::coefficient(&d, &n0, &n1);
        prop_assert!((c - edge::coefficient(&-d, &n1, &n0)).norm() <= 1e-14 * size);
        prop_assert!((c - edge::coefficient(&d, &-n0, &-n1)).norm() <= 1e-14 * size);
        if n0.dot(&n1) > -0.5 {
            prop_assert!(c.dot(&d).abs() < d.norm_squared());
        }
    }

    #[test]
    fn edges_have_their_derivatives(d in unit(), n0 in unit(), n1 in unit(), v in unit(), near in 0.0..1.0_f64) {
        // Also with normals close together.
        let n1 = (n0 + n1 * near.powi(3)).normalize();
        prop_assume!(n1.norm() > 0.5 && (n0 + n1).norm() > 0.2);
        let x = [d, n0, n1];
        let h = 4e-4;
        let stencil = |f: &dyn Fn(f64) -> Vec3| {
            (f(1.0) - f(-1.0)) * (0.75 / h) - (f(2.0) - f(-2.0)) * (0.15 / h) + (f(3.0) - f(-3.0)) / (60.0 * h)
        };
        let c = edge::derivatives(&d, &n0, &n1);
        let b = edge::bending(&d, &n0, &n1, &v);
        let first = [c.by_chord, c.by_normals[0], c.by_normals[1]];
        let second = [
            [Mat3::zeros(), b.chord_normals[0], b.chord_normals[1]],
            [b.chord_normals[0].transpose(), b.normals[0], b.mixed],
            [b.chord_normals[1].transpose(), b.mixed.transpose(), b.normals[1]],
        ];
        prop_assert_eq!(c.value, edge::coefficient(&d, &n0, &n1));
        for a in 0..3 {
            for k in 0..3 {
                let moved = |s: f64| {
                    let mut x = x;
                    x[a][k] += s * h;
                    x
                };
                let by = stencil(&|s| { let [d, n0, n1] = moved(s); edge::coefficient(&d, &n0, &n1) });
                prop_assert!((by - first[a].column(k)).norm() < 1e-7, "{} {} {}", by, first[a].column(k), a);
                for b in 0..3 {
                    let by = stencil(&|s| {
                        let [d, n0, n1] = moved(s);
                        let c = edge::derivatives(&d, &n0, &n1);
                        [c.by_chord, c.by_normals[0], c.by_normals[1]][b].tr_mul(&v)
                    });
                    let error = (by - second[b][a].column(k)).norm();
                    prop_assert!(error < 1e-5, "{} {}: {:e}", a, b, error);
                }
            }
        }
    }
}
