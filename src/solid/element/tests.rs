use super::super::testing::{CUBE, Random, add, affine, derivative, relative_error, rotation};
use super::super::voigt::to_matrix;
use super::*;
use crate::Vec3;
use crate::scene::{Hardening, Hill, Isochoric, MaterialModel};
use nalgebra::{DMatrix, DVector};

const CORNER: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) type Nodes<const N: usize> = [[f64; 3]; N];
pub(super) type Hex = fn(&Nodes<8>, &Nodes<8>, Medium, bool, &mut ElementMatrices<24>) -> Result<(), Inverted>;
type HexSamples = fn(&Nodes<8>, &Nodes<8>, Medium) -> Result<[Sample; 8], Inverted>;
pub(super) const HEXES: [Hex; 4] = [hex8::evaluate, hex8_fbar::evaluate, hex8_sri::evaluate, hex8_eas::evaluate];
/// The integration points of the same.
const SAMPLES: [HexSamples; 4] = [
    |x0, u, _| hex8::samples(x0, u),
    |x0, u, _| hex8_fbar::samples(x0, u),
    |x0, u, _| hex8_sri::samples(x0, u),
    hex8_eas::samples,
];
/// Those whose forces derive from an energy.
const WITH_ENERGY: [usize; 3] = [0, 2, 3];

pub(super) fn materials() -> [Material; 5] {
    let rubber = |law| Material::new(&MaterialModel::Hyperelastic { law, bulk: 20.0 });
    [
        Material::new(&MaterialModel::NeoHookean { young: 10.0, poisson: 0.3 }),
        Material::new(&MaterialModel::Hooke { young: 10.0, poisson: 0.3 }),
        Material::new(&MaterialModel::NeoHookean { young: 10.0, poisson: 0.4999 }),
        rubber(Isochoric::MooneyRivlin { c10: 0.8, c01: 0.2 }),
        rubber(Isochoric::Ogden(vec![[1.5, 1.3], [0.5, 4.0]])),
    ]
}

/// A distorted element and random displacements, none inverted.
fn hex_case(random: &mut Random) -> (Nodes<8>, Nodes<8>) {
    (add(&CUBE, &random.points(0.15)), random.points(0.15))
}

/// The share of such displacements at which each of [`HEXES`] is tested: under pressures of many times the shear modulus,
/// as a change of the volume gives rise to when nearly incompressible, enhanced strain may have no solution.
fn shares(material: &Material) -> [f64; 4] {
    let (lambda, mu) = material.initial_moduli();
    [1.0, 1.0, 1.0, if lambda > 100.0 * mu { SHARE } else { 1.0 }]
}
const SHARE: f64 = 0.07;

/// [`HEXES`] with their shares of displacements.
fn hexes(u: &Nodes<8>, material: &Material) -> [(Hex, Nodes<8>); 4] {
    let shares = shares(material);
    std::array::from_fn(|k| (HEXES[k], u.map(|u| u.map(|c| shares[k] * c))))
}

fn tet_case(random: &mut Random) -> (Nodes<4>, Nodes<4>) {
    (add(&CORNER, &random.points(0.1)), random.points(0.15))
}

type Tet = fn(&Nodes<10>, &Nodes<10>, Medium, bool, &mut ElementMatrices<30>) -> Result<(), Inverted>;
type TetSamples = fn(&Nodes<10>, &Nodes<10>) -> Result<[Sample; 4], Inverted>;
/// The quadratic tetrahedra, with their integration points.
const TETS: [(Tet, TetSamples); 2] = [(tet10::evaluate, tet10::samples), (tet10_sri::evaluate, tet10_sri::samples)];

/// The corners with the middles of straight edges.
fn quadratic(corners: &Nodes<4>) -> Nodes<10> {
    let edge = |a: usize| crate::mesh::faces::TET_EDGES[a - 4];
    std::array::from_fn(|a| match a {
        0..4 => corners[a],
        _ => std::array::from_fn(|i| 0.5 * (corners[edge(a)[0]][i] + corners[edge(a)[1]][i])),
    })
}

/// One with curved edges, and random displacements.
fn tet10_case(random: &mut Random) -> (Nodes<10>, Nodes<10>) {
    (add(&quadratic(&CORNER), &random.points(0.06)), random.points(0.06))
}

pub(super) fn matrices<const N: usize, const D: usize>(
    element: impl Fn(&Nodes<N>, &Nodes<N>, Medium, bool, &mut ElementMatrices<D>) -> Result<(), Inverted>,
    x0: &Nodes<N>,
    u: &Nodes<N>,
    material: &Material,
) -> ElementMatrices<D> {
    let mut out = ElementMatrices::default();
    element(x0, u, Medium::virgin(material), true, &mut out).unwrap();
    let mut forces_alone = ElementMatrices::default();
    element(x0, u, Medium::virgin(material), false, &mut forces_alone).unwrap();
    assert_eq!(out.residual, forces_alone.residual);
    out
}

/// `u` with degree of freedom `dof` moved by `t`.
pub(super) fn moved<const N: usize>(u: &Nodes<N>, dof: usize, t: f64) -> Nodes<N> {
    let mut u = *u;
    u[dof / 3][dof % 3] += t;
    u
}

/// Relative error of the tangent against differences of the residual.
pub(super) fn tangent_error<const N: usize, const D: usize>(
    element: impl Fn(&Nodes<N>, &Nodes<N>, Medium, bool, &mut ElementMatrices<D>) -> Result<(), Inverted>,
    x0: &Nodes<N>,
    u: &Nodes<N>,
    material: &Material,
    step: f64,
) -> f64 {
    let residual = |u: &Nodes<N>| {
        let mut out = ElementMatrices::default();
        element(x0, u, Medium::virgin(material), false, &mut out).unwrap();
        out.residual
    };
    let columns: [[f64; D]; D] = std::array::from_fn(|dof| derivative(step, |t| residual(&moved(u, dof, t))));
    let differences: [[f64; D]; D] = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
    relative_error(matrices(element, x0, u, material).tangent.as_flattened(), differences.as_flattened())
}

#[test]
fn tangents_are_the_derivative_of_the_residual() {
    let (mut random, mut of_tets) = (Random::new(21), Random::new(30));
    // Amplitudes are found to 1e-8, of which the tangent is.
    let tolerances = [1e-11, 1e-11, 1e-11, 1e-9];
    let errors = |x0: &_, u: &_, material: &_| -> [f64; 4] {
        let (hexes, shares) = (hexes(u, material), shares(material));
        std::array::from_fn(|k| tangent_error(hexes[k].0, x0, &hexes[k].1, material, 1e-3 * shares[k]))
    };
    for material in &materials() {
        for _ in 0..3 {
            let (x0, u) = hex_case(&mut random);
            let error = errors(&x0, &u, material);
            assert!(error.iter().zip(tolerances).all(|(&e, t)| e < t), "{material:?} {error:?}");
            let (x0, u) = tet_case(&mut random);
            let error = tangent_error(tet4::evaluate, &x0, &u, material, 1e-3);
            assert!(error < 1e-11, "{material:?} {error}");
            let (x0, u) = tet10_case(&mut of_tets);
            for (tet, _) in TETS {
                let error = tangent_error(tet, &x0, &u, material, 3e-4);
                assert!(error < 1e-10, "{material:?} {error}");
            }
        }
        // The undeformed state has three equal stretches everywhere.
        let error = errors(&CUBE, &[[0.0; 3]; 8], material);
        assert!(error.iter().zip(tolerances).all(|(&e, t)| e < t), "{material:?} {error:?}");
    }
}

/// Points that have flowed and flow on.
#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    let mut random = Random::new(29);
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let hill = Hill { coefficients: [0.283, 0.358, 0.642, 1.5, 1.5, 1.289], axes: rotation(Vec3::new(0.3, 0.8, -0.4)) };
    for hill in [None, Some(hill)] {
        let material =
            Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill, hardening: hardening.clone() });
        for _ in 0..3 {
            let mut states = [State::VIRGIN; 8];
            let (x0, before) = hex_case(&mut random);
            advance(&hex8::samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
            let u = add(&before, &random.points(0.1));
            for (k, hex) in HEXES.into_iter().enumerate() {
                let samples = SAMPLES[k](&x0, &u, Medium { states: &states, ..Medium::virgin(&material) }).unwrap();
                let mut after = states;
                advance(&samples, &material, &mut after).unwrap();
                assert!((0..8).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
                let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
                    hex(x0, u, Medium { states: &states, ..medium }, want, out)
                };
                // The flow goes on for all differences.
                let error = tangent_error(element, &x0, &u, &material, 5e-5);
                assert!(error < 1e-7, "{k} {error}");
            }
            let (x0, before) = tet10_case(&mut random);
            let u = add(&before, &random.points(0.04));
            for (tet, samples) in TETS {
                let mut states = [State::VIRGIN; 4];
                advance(&samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
                let mut after = states;
                advance(&samples(&x0, &u).unwrap(), &material, &mut after).unwrap();
                assert!((0..4).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
                let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
                    tet(x0, u, Medium { states: &states, ..medium }, want, out)
                };
                let error = tangent_error(element, &x0, &u, &material, 2e-5);
                assert!(error < 1e-7, "{error}");
            }
        }
    }
}

#[test]
fn residuals_are_the_derivative_of_the_energy() {
    let mut random = Random::new(22);
    for material in &materials() {
        let medium = Medium::virgin(material);
        let (x0, u) = hex_case(&mut random);
        for k in WITH_ENERGY {
            let ((hex, u), step) = (hexes(&u, material)[k], 1e-3 * shares(material)[k]);
            let energy = |u: &Nodes<8>| stored_energy(&SAMPLES[k](&x0, u, medium).unwrap(), medium).unwrap();
            let differences: [f64; 24] =
                std::array::from_fn(|dof| derivative(step, |t| [energy(&moved(&u, dof, t))])[0]);
            let error = relative_error(&matrices(hex, &x0, &u, material).residual, &differences);
            // Differences by smaller steps have more of the rounding.
            assert!(error < 1e-11 * 1e-3 / step, "{k} {error}");
        }
        let (x0, u) = tet_case(&mut random);
        let energy = |u: &Nodes<4>| stored_energy(&tet4::samples(&x0, u).unwrap(), medium).unwrap();
        let differences: [f64; 12] = std::array::from_fn(|dof| derivative(1e-3, |t| [energy(&moved(&u, dof, t))])[0]);
        let error = relative_error(&matrices(tet4::evaluate, &x0, &u, material).residual, &differences);
        assert!(error < 1e-11, "{error}");
        let (x0, u) = tet10_case(&mut random);
        for (tet, samples) in TETS {
            let energy = |u: &Nodes<10>| stored_energy(&samples(&x0, u).unwrap(), medium).unwrap();
            let differences: [f64; 30] =
                std::array::from_fn(|dof| derivative(3e-4, |t| [energy(&moved(&u, dof, t))])[0]);
            let error = relative_error(&matrices(tet, &x0, &u, material).residual, &differences);
            assert!(error < 1e-10, "{error}");
        }
    }
}

#[test]
fn tangents_with_an_energy_are_symmetric() {
    let mut random = Random::new(23);
    for material in &materials() {
        let (x0, u) = hex_case(&mut random);
        for k in WITH_ENERGY {
            let (hex, u) = hexes(&u, material)[k];
            let k = matrices(hex, &x0, &u, material).tangent;
            (0..24).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
        }
        let (x0, u) = tet_case(&mut random);
        let k = matrices(tet4::evaluate, &x0, &u, material).tangent;
        (0..12).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
        let (x0, u) = tet10_case(&mut random);
        for (tet, _) in TETS {
            let k = matrices(tet, &x0, &u, material).tangent;
            (0..30).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
        }
    }
}

#[test]
fn rigid_motion_gives_no_force_and_turns_the_forces() {
    let mut random = Random::new(24);
    for material in &materials() {
        for k in 0..4 {
            let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
            let (x0, u) = hex_case(&mut random);
            let (hex, u) = hexes(&u, material)[k];
            let rigid = matrices(hex, &x0, &affine(&x0, &r, shift), material);
            let stiffness = rigid.tangent.as_flattened().iter().fold(0f64, |m, k| m.max(k.abs()));
            assert!(rigid.residual.iter().all(|f| f.abs() < 1e-14 * stiffness));

            let x = add(&x0, &u);
            let after = add(&u, &affine(&x, &r, shift));
            let (a, b) = (matrices(hex, &x0, &u, material), matrices(hex, &x0, &after, material));
            for n in 0..8 {
                let turned = r * Vec3::from_column_slice(&a.residual[3 * n..3 * n + 3]);
                (0..3).for_each(|i| assert!((turned[i] - b.residual[3 * n + i]).abs() < 1e-13 * stiffness));
            }
        }
    }
}

#[test]
fn forces_and_moments_balance() {
    let mut random = Random::new(25);
    for (material, k) in materials().iter().flat_map(|m| (0..4).map(move |k| (m, k))) {
        let (x0, u) = hex_case(&mut random);
        let (hex, u) = hexes(&u, material)[k];
        let out = matrices(hex, &x0, &u, material);
        let (mut force, mut moment, mut size) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for n in 0..8 {
            let f = Vec3::from_column_slice(&out.residual[3 * n..3 * n + 3]);
            force += f;
            moment += Vec3::from(add(&x0, &u)[n]).cross(&f);
            size += f.norm();
        }
        assert!(force.norm() < 1e-14 * size && moment.norm() < 1e-14 * size);
    }
}

/// Eight hexahedra in the unit cube whose 27 nodes, but for the corners, are moved about; affine displacement of all
/// nodes.
#[test]
fn patch_test() {
    let mut random = Random::new(26);
    let number = |i: usize, j: usize, k: usize| i + 3 * j + 9 * k;
    let mut grid = [[0.0; 3]; 27];
    for n in 0..27 {
        let at = [n % 3, n / 3 % 3, n / 9];
        grid[n] = at.map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 });
    }
    let f = Mat3::identity() + random.matrix(0.2);
    let displaced = affine(&grid, &f, random.vector(1.0));
    for (material, hex) in materials().iter().flat_map(|m| HEXES.map(move |hex| (m, hex))) {
        let (mut inner, mut size) = (Vec3::zeros(), 0f64);
        for e in 0..8 {
            let (i, j, k) = (e % 2, e / 2 % 2, e / 4);
            let nodes = CUBE.map(|c| number(i + c[0] as usize, j + c[1] as usize, k + c[2] as usize));
            let (x0, u) = (nodes.map(|n| grid[n]), nodes.map(|n| displaced[n]));
            let residual = matrices(hex, &x0, &u, material).residual;
            let a = nodes.iter().position(|&n| n == 13).unwrap();
            inner += Vec3::from_column_slice(&residual[3 * a..3 * a + 3]);
            size = residual.iter().fold(size, |m, f| m.max(f.abs()));
        }
        assert!(inner.norm() < 1e-13 * size, "{inner} {size}");
    }
}

/// Twelve quadratic tetrahedra around a point in the unit cube; affine displacement of all nodes. With straight edges forces on
/// nodes inside are rounding; with curved ones, whose integrals are of third order, they are a small share of the others.
#[test]
fn quadratic_tetrahedra_pass_the_patch_test() {
    let mut random = Random::new(31);
    let mut points: Vec<[f64; 3]> = CUBE.to_vec();
    points.push([0.5 + random.number(0.1), 0.5 + random.number(0.1), 0.5 + random.number(0.1)]);
    let triangles = crate::mesh::faces::HEX_FACES.map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    // Faces of the cube look outward, so that the last node is on the side from which they are clockwise.
    let tets = triangles.as_flattened().iter().map(|[a, b, c]| [*a as usize, *c as usize, *b as usize, 8]);
    let mut middles = std::collections::BTreeMap::new();
    let mut elements: Vec<[usize; 10]> = Vec::new();
    for corners in tets {
        let edges =
            crate::mesh::faces::TET_EDGES.map(|[i, j]| [corners[i].min(corners[j]), corners[i].max(corners[j])]);
        let mut number = |[i, j]: [usize; 2]| {
            *middles.entry([i, j]).or_insert_with(|| {
                points.push(std::array::from_fn(|d| 0.5 * (points[i][d] + points[j][d])));
                points.len() - 1
            })
        };
        let between = edges.map(&mut number);
        elements.push(std::array::from_fn(|a| if a < 4 { corners[a] } else { between[a - 4] }));
    }
    let inside = |x: &[f64; 3]| x.iter().all(|c| *c > 0.0 && *c < 1.0);
    let curved: Vec<[f64; 3]> = points
        .iter()
        .enumerate()
        .map(|(n, x)| if n > 8 && inside(x) { x.map(|c| c + random.number(0.02)) } else { *x })
        .collect();
    let f = Mat3::identity() + random.matrix(0.2);
    for (points, most) in [(&points, 1e-13), (&curved, 2e-3)] {
        for (material, (tet, _)) in materials().iter().flat_map(|m| TETS.map(move |tet| (m, tet))) {
            let (mut forces, mut size) = (vec![Vec3::zeros(); points.len()], 0f64);
            for nodes in &elements {
                let x0 = nodes.map(|n| points[n]);
                assert!(tet10::min_jacobian(&x0) > 0.0);
                let residual = matrices(tet, &x0, &affine(&x0, &f, Vec3::zeros()), material).residual;
                for (a, n) in nodes.iter().enumerate() {
                    forces[*n] += Vec3::from_column_slice(&residual[3 * a..3 * a + 3]);
                }
                size = residual.iter().fold(size, |m, f| m.max(f.abs()));
            }
            let rest = points.iter().zip(&forces).filter(|(x, _)| inside(x)).map(|(_, f)| f.norm()).fold(0.0, f64::max);
            assert!(rest < most * size, "{rest} of {size}");
        }
    }
}

#[test]
fn homogeneous_deformation_gives_the_materials_stress_in_every_element() {
    let mut random = Random::new(27);
    for material in &materials() {
        let f = Mat3::identity() + random.matrix(0.2);
        let exact = to_matrix(&material.kirchhoff(&f, &State::VIRGIN).unwrap()) / f.determinant();
        let x0 = add(&CUBE, &random.points(0.15));
        let u = affine(&x0, &f, random.vector(1.0));
        let full = matrices(hex8::evaluate, &x0, &u, material);
        for hex in HEXES {
            assert!(relative_error(&matrices(hex, &x0, &u, material).residual, &full.residual) < 1e-13);
        }
        let corners: Nodes<4> = [x0[0], x0[1], x0[3], x0[4]];
        let ten = add(&quadratic(&corners), &random.points(0.02));
        let stresses = [
            average_stress(&hex8::samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap(),
            average_stress(&hex8_fbar::samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap(),
            average_stress(&hex8_sri::samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap(),
            average_stress(&hex8_eas::samples(&x0, &u, Medium::virgin(material)).unwrap(), Medium::virgin(material))
                .unwrap(),
            average_stress(&tet4::samples(&corners, &[u[0], u[1], u[3], u[4]]).unwrap(), Medium::virgin(material))
                .unwrap(),
            average_stress(&tet10::samples(&ten, &affine(&ten, &f, Vec3::zeros())).unwrap(), Medium::virgin(material))
                .unwrap(),
            average_stress(
                &tet10_sri::samples(&ten, &affine(&ten, &f, Vec3::zeros())).unwrap(),
                Medium::virgin(material),
            )
            .unwrap(),
        ];
        for stress in stresses {
            assert!((to_matrix(&stress) - exact).norm() < 1e-12 * material.initial_moduli().0);
        }
        let current = hex8::volume(&add(&x0, &u));
        assert!((current - f.determinant() * hex8::volume(&x0)).abs() < 1e-14);
        // The mean stress is that of the nodal forces: sum_a R_a x_a^T = int sigma dv.
        let mut virial = Mat3::zeros();
        for (n, x) in add(&x0, &u).iter().enumerate() {
            virial += Vec3::from_column_slice(&full.residual[3 * n..3 * n + 3]) * Vec3::from(*x).transpose();
        }
        assert!((virial / current - exact).norm() < 1e-12 * material.initial_moduli().0);
    }
}

#[test]
fn confined_compression_of_one_element() {
    let (s, area) = (0.7, 6.0);
    let x0 = CUBE.map(|x| [2.0 * x[0], 3.0 * x[1], 4.0 * x[2]]);
    let u = affine(&x0, &Mat3::from_diagonal(&Vec3::new(1.0, 1.0, s)), Vec3::zeros());
    for (material, hex) in materials().iter().flat_map(|m| HEXES.map(move |hex| (m, hex))) {
        let (lambda, mu) = material.initial_moduli();
        let tau = match material {
            Material::NeoHookean(_) => mu * (s * s - 1.0) + lambda * s.ln(),
            Material::Hencky(_) | Material::Plastic(_) => (lambda + 2.0 * mu) * s.ln(),
            Material::Hyperelastic(_) | Material::Orthotropic(_) => continue,
        };
        let residual = matrices(hex, &x0, &u, material).residual;
        for (n, x) in x0.iter().enumerate() {
            let exact = area * tau / s / 4.0 * if x[2] > 0.0 { 1.0 } else { -1.0 };
            assert!((residual[3 * n + 2] - exact).abs() < 1e-13 * exact.abs());
        }
    }
}

/// Jacobians at nodes are the volumes that their three edges span over that of so many parameter cells of volume 1; edges join
/// nodes that differ in one coordinate, or lie across from the right angle.
pub(super) fn assert_edges_span<const N: usize>(jacobians: &[f64; N], (x, cell): (&Nodes<N>, &Nodes<N>), parts: f64) {
    for a in 0..N {
        let differ = |b: usize| (0..3).filter(|&d| cell[a][d] != cell[b][d]).count();
        let is_edge = |b: &usize| differ(*b) == 1 || N == 6 && differ(*b) == 2 && a / 3 == b / 3;
        let edges: Vec<Vec3> = (0..N).filter(is_edge).map(|b| Vec3::from(x[b]) - Vec3::from(x[a])).collect();
        let [e, f, g] = edges[..] else { panic!("{}", edges.len()) };
        assert!((jacobians[a] - e.cross(&f).dot(&g).abs() / parts).abs() < 1e-15, "{a}");
    }
}

#[test]
fn volumes_and_body_forces() {
    let mut random = Random::new(28);
    assert!((hex8::volume(&CUBE) - 1.0).abs() < 1e-15);
    assert!((hex8::min_jacobian(&CUBE) - 1.0).abs() < 1e-15);
    assert!((tet4::volume(&CORNER) - 1.0 / 6.0).abs() < 1e-16);
    let ten = quadratic(&CORNER);
    assert!((tet10::volume(&ten) - 1.0 / 6.0).abs() < 1e-16 && (tet10::min_jacobian(&ten) - 1.0).abs() < 1e-15);
    // int N_a dV is -V / 20 at corners, V / 5 between them.
    for (a, force) in tet10::body_force(&ten, Vec3::new(0.0, 0.0, 6.0)).as_chunks::<3>().0.iter().enumerate() {
        let exact = [0.0, 0.0, if a < 4 { -0.05 } else { 0.2 }];
        assert!((0..3).all(|i| (force[i] - exact[i]).abs() < 1e-15), "{a} {force:?}");
    }
    // The parameters of a point of a curved element, and what the values of linear fields at points give at nodes.
    let x = add(&ten, &random.points(0.04));
    let at = [0.2, 0.3, 0.1, 0.4];
    let place: Vec3 = tet10::shape(&at).iter().zip(&x).map(|(n, x)| *n * Vec3::from(*x)).sum();
    let found = tet10::parameters(&x, &place).unwrap();
    assert!((0..4).all(|k| (found[k] - at[k]).abs() < 1e-12), "{found:?}");
    let field = |x: &Vec3| 1.0 + 2.0 * x.x - 3.0 * x.y + 0.5 * x.z;
    let values = tet10::VALUES.map(|n| field(&n.iter().zip(&ten).map(|(n, x)| *n * Vec3::from(*x)).sum()));
    for (weights, x) in tet10::AT_NODES.iter().zip(&ten) {
        let there: f64 = weights.iter().zip(values).map(|(w, v)| w * v).sum();
        assert!((there - field(&Vec3::from(*x))).abs() < 1e-14);
    }
    let b = random.vector(1.0);
    let x0 = add(&CUBE, &random.points(0.15));
    assert_edges_span(&hex8::nodal_jacobians(&x0), (&x0, &CUBE), 8.0);
    let load = hex8::body_force(&x0, b);
    for i in 0..3 {
        let sum: f64 = (0..8).map(|a| load[3 * a + i]).sum();
        assert!((sum - hex8::volume(&x0) * b[i]).abs() < 1e-15);
    }
    // A prism over a trapezoid, 3 wide below and 1 wide above, 2 high: int N_a dA is 7/6 below and 5/6 above.
    let mut prism = CUBE;
    for x in &mut prism {
        let width = 3.0 - 2.0 * x[1];
        *x = [width * (x[0] - 0.5), 2.0 * x[1], 2.0 * x[2]];
    }
    let load = hex8::body_force(&prism, Vec3::new(1.0, 0.0, -2.0));
    for (a, x) in prism.iter().enumerate() {
        let share = if x[1] == 0.0 { 7.0 / 6.0 } else { 5.0 / 6.0 };
        assert!((load[3 * a] - share).abs() < 1e-14 && (load[3 * a + 2] + 2.0 * share).abs() < 1e-14);
        assert_eq!(load[3 * a + 1], 0.0);
    }
    let load = tet4::body_force(&CORNER, Vec3::new(0.0, -24.0, 0.0));
    (0..12).for_each(|k| assert!((load[k] - if k % 3 == 1 { -1.0 } else { 0.0 }).abs() < 1e-15));
}

#[test]
fn inversion_is_reported_with_the_worst_volume_ratio() {
    let material = &materials()[0];
    let mut u = affine(&CUBE, &Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -0.5)), Vec3::zeros());
    for hex in HEXES {
        let error = hex(&CUBE, &u, Medium::virgin(material), true, &mut ElementMatrices::default()).unwrap_err();
        assert!((error.det_f + 0.5).abs() < 1e-15);
    }
    // One node pushed through: some points stay sound, the worst is told.
    let u_one = moved(&[[0.0; 3]; 8], 20, -2.5);
    let error = hex8::samples(&CUBE, &u_one).unwrap_err();
    assert!(error.det_f < 0.0 && error.det_f > -1.0);
    u[3][1] = f64::NAN;
    for hex in HEXES {
        let error = hex(&CUBE, &u, Medium::virgin(material), false, &mut ElementMatrices::default()).unwrap_err();
        assert!(error.det_f.is_nan());
    }
    assert!(tet4::samples(&CORNER, &affine(&CORNER, &(-Mat3::identity()), Vec3::zeros())).is_err());
}

/// Tip deflection of a slender cantilever in plane strain, 16 x 4 elements of unit size, unit tip load over the depth,
/// linear.
fn cantilever(hex: Hex, material: &Material) -> f64 {
    let (nx, ny) = (16, 4);
    let node = |i: usize, j: usize, k: usize| i + (nx + 1) * (j + (ny + 1) * k);
    // Equations of x and y of the nodes off the clamped end; both z-planes share them.
    let equation = |n: usize, d: usize| {
        let (i, j) = (n % (nx + 1), n / (nx + 1) % (ny + 1));
        (i > 0 && d < 2).then(|| 2 * (nx * j + i - 1) + d)
    };
    let size = 2 * nx * (ny + 1);
    let (mut k, mut f) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let element = matrices(hex, &CUBE, &[[0.0; 3]; 8], material).tangent;
    for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
        let nodes = CUBE.map(|c| node(i + c[0] as usize, j + c[1] as usize, c[2] as usize));
        for (row, column) in (0..24).flat_map(|r| (0..24).map(move |c| (r, c))) {
            if let (Some(r), Some(c)) = (equation(nodes[row / 3], row % 3), equation(nodes[column / 3], column % 3)) {
                k[(r, c)] += element[row][column];
            }
        }
    }
    let tip = |j: usize| 2 * (nx * j + nx - 1) + 1;
    for j in 0..=ny {
        f[tip(j)] = if j == 0 || j == ny { 0.5 } else { 1.0 } / ny as f64;
    }
    k.lu().solve(&f).unwrap()[tip(ny / 2)]
}

#[test]
fn volumetric_locking_is_relieved() {
    let (young, poisson, length, height) = (1000.0, 0.4999, 16.0f64, 4.0f64);
    for model in [MaterialModel::NeoHookean { young, poisson }, MaterialModel::Hooke { young, poisson }] {
        let material = Material::new(&model);
        let (modulus, shear) = (young / (1.0 - poisson * poisson), material.initial_moduli().1);
        let beam = length.powi(3) / (3.0 * modulus * height.powi(3) / 12.0) + 1.2 * length / (shear * height);
        let [full, cured @ ..] = HEXES.map(|hex| cantilever(hex, &material) / beam);
        assert!(full < 0.1, "{full}");
        assert!(cured.iter().all(|tip| (0.93..1.0).contains(tip)), "{cured:?}");
    }
}

/// Volume changes that a nearly incompressible element resists: its own alone, and under full integration six more.
#[test]
fn elements_resist_few_changes_of_volume() {
    let stiff = |hex: Hex| {
        let material = Material::new(&MaterialModel::NeoHookean { young: 1.0, poisson: 0.499_999 });
        let k = matrices(hex, &CUBE, &[[0.0; 3]; 8], &material).tangent;
        DMatrix::from_fn(24, 24, |i, j| k[i][j]).singular_values().iter().filter(|&&s| s > 1e2).count()
    };
    assert_eq!(HEXES.map(stiff), [7, 1, 1, 1]);
}

/// A layer of one element in pure bending about z, with and without Poisson's effect: displacements that are exact at the
/// nodes give the exact moment, whatever the aspect ratio, and no other force.
#[test]
fn enhanced_strain_bends_exactly() {
    for (poisson, aspect) in [(0.0, 1.0), (0.3, 1.0), (0.3, 20.0), (0.499, 5.0)] {
        let material = Material::new(&MaterialModel::NeoHookean { young: 1.0, poisson });
        let x0 = CUBE.map(|[x, y, z]| [aspect * (x - 0.5), y - 0.5, 2.0 * (z - 0.5)]);
        let k = matrices(hex8_eas::evaluate, &x0, &[[0.0; 3]; 8], &material).tangent;
        let u = x0.map(|[x, y, z]| [-x * y, 0.5 * (x * x + poisson * (y * y - z * z)), poisson * y * z]);
        let force = k.map(|row| (0..24).map(|c| row[c] * u[c / 3][c % 3]).sum::<f64>());
        // E I = 2/12 on arms of 1/2, over two nodes each.
        for (n, x) in x0.iter().enumerate() {
            let exact = [-x[0].signum() * x[1].signum() / 12.0, 0.0, 0.0];
            (0..3).for_each(|i| {
                let error = (force[3 * n + i] - exact[i]).abs();
                assert!(error < 1e-11, "{poisson} {aspect} {n} {i} {}", force[3 * n + i]);
            });
        }
    }
}

/// Smallest eigenvalue over the shear modulus of a block of 3 x 3 x 3 unit elements between smooth walls, which are moved
/// homogeneously; no displacement that the walls allow should be easy.
fn stiffness_between_walls(hex: Hex, material: &Material, stretches: [f64; 3]) -> f64 {
    let n = 3;
    let u = affine(&CUBE, &Mat3::from_diagonal(&stretches.into()), Vec3::zeros());
    let element = matrices(hex, &CUBE, &u, material).tangent;
    let equation = |at: [usize; 3], d: usize| {
        let free = at[d] > 0 && at[d] < n;
        free.then(|| 3 * (at[0] + (n + 1) * (at[1] + (n + 1) * at[2])) + d)
    };
    let size = 3 * (n + 1).pow(3);
    let mut k = DMatrix::identity(size, size) * (1e3 * material.initial_moduli().1);
    let mut seen = vec![false; size];
    for e in 0..n.pow(3) {
        let corner = [e % n, e / n % n, e / n / n];
        let place = |row: usize| equation(std::array::from_fn(|d| corner[d] + CUBE[row / 3][d] as usize), row % 3);
        for r in (0..24).filter_map(|r| Some((r, place(r)?))) {
            if !std::mem::replace(&mut seen[r.1], true) {
                k[(r.1, r.1)] = 0.0;
            }
        }
        for (r, c) in (0..24).flat_map(|r| (0..24).map(move |c| (r, c))) {
            if let (Some(row), Some(column)) = (place(r), place(c)) {
                k[(row, column)] += element[r][c];
            }
        }
    }
    k.symmetric_eigenvalues().min() / material.initial_moduli().1
}

#[test]
fn no_hourglass_in_compression_or_tension() {
    for poisson in [0.3, 0.499] {
        let material = Material::new(&MaterialModel::NeoHookean { young: 1.0, poisson });
        for stretch in [0.1, 0.3, 0.6, 2.0, 5.0] {
            // Without stress along y.
            let stress = |t: f64| material.kirchhoff(&Mat3::from_diagonal(&Vec3::new(stretch, t, 1.0)), &State::VIRGIN);
            let (mut low, mut high) = (0.01, 100.0);
            for _ in 0..100 {
                let t = 0.5 * (low + high);
                if stress(t).unwrap()[1] > 0.0 { high = t } else { low = t }
            }
            for hex in WITH_ENERGY {
                let least = stiffness_between_walls(HEXES[hex], &material, [stretch, low, 1.0]);
                assert!(least > 0.01, "{poisson} {stretch} {least}");
            }
        }
    }
}

/// A sheet of steel in small steps, bent and pulled by some percent with states that have flowed: the tangent is that of
/// the residual at the states, and the states that follow give the same forces.
#[test]
fn elements_of_plastic_material() {
    let mut random = Random::new(29);
    let hardening = Hardening::Swift { k: 0.5653, e0: 0.0071156, n: 0.2589 };
    let steel = MaterialModel::Plastic { young: 206.9, poisson: 0.29, hill: None, hardening };
    let material = Material::new(&steel);
    let x0 = add(&CUBE, &random.points(0.1));
    let (rate, f): (Nodes<8>, Mat3) = (random.points(0.02), Mat3::identity() + random.matrix(0.02));
    for (hex, samples) in HEXES.into_iter().zip(SAMPLES) {
        let mut states = [State::VIRGIN; 8];
        for step in 1..=4 {
            let u: Nodes<8> = std::array::from_fn(|a| {
                let homogeneous = affine(&x0, &f, Vec3::zeros())[a];
                std::array::from_fn(|i| step as f64 * (rate[a][i] + homogeneous[i]))
            });
            let medium = Medium { states: &states, ..Medium::virgin(&material) };
            let mut out = ElementMatrices::default();
            hex(&x0, &u, medium, true, &mut out).unwrap();
            let columns: [[f64; 24]; 24] = std::array::from_fn(|dof| {
                derivative(1e-6, |t| {
                    let mut out = ElementMatrices::default();
                    hex(&x0, &moved(&u, dof, t), medium, false, &mut out).unwrap();
                    out.residual
                })
            });
            let differences: [[f64; 24]; 24] = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
            let error = relative_error(out.tangent.as_flattened(), differences.as_flattened());
            assert!(error < 1e-7, "{error}");
            let mut after = states;
            advance(&samples(&x0, &u, medium).unwrap(), &material, &mut after).unwrap();
            assert!(after.iter().all(|state| state.equivalent > 0.005 * step as f64), "{after:?}");
            states = after;
            let mut again = ElementMatrices::default();
            hex(&x0, &u, Medium { states: &states, ..Medium::virgin(&material) }, false, &mut again).unwrap();
            let error = relative_error(&again.residual, &out.residual);
            assert!(error < 1e-8, "{error}");
        }
    }
}

/// Amplitudes under what a first guess of displacements may ask for: changes of volume that would need pressures of tens of
/// shear moduli of rubber, or of yield stresses.
#[test]
fn enhanced_strain_is_found_in_large_steps() {
    let hardening = Hardening::Swift { k: 0.5653, e0: 0.0071156, n: 0.2589 };
    let steel = MaterialModel::Plastic { young: 206.9, poisson: 0.29, hill: None, hardening };
    let rubber = MaterialModel::NeoHookean { young: 10.0, poisson: 0.4999 };
    for (model, size, least) in [(steel, 0.08, 98), (rubber, 0.01, 90)] {
        let (material, mut random) = (Material::new(&model), Random::new(30));
        let found = (0..100).filter(|_| {
            let (x0, u) = (add(&CUBE, &random.points(0.15)), random.points(size));
            hex8_eas::samples(&x0, &u, Medium::virgin(&material)).is_ok()
        });
        let count = found.count();
        assert!(count >= least, "{model:?}: {count} of 100");
    }
}

/// Amplitudes that are known for other displacements: their slopes are derivatives, and what is found from there after a
/// large step is what is found from zero.
#[test]
fn enhanced_strain_goes_on_from_known_amplitudes() {
    let hardening = Hardening::Swift { k: 0.5653, e0: 0.0071156, n: 0.2589 };
    let steel = MaterialModel::Plastic { young: 206.9, poisson: 0.29, hill: None, hardening };
    let (material, mut random) = (Material::new(&steel), Random::new(31));
    let (mut both, mut same) = (0, 0);
    for case in 0..100 {
        let (x0, u) = (add(&CUBE, &random.points(0.15)), random.points(0.05));
        let at = |u: &_, amplitudes| {
            let mut out = ElementMatrices::default();
            hex8_eas::evaluate(&x0, u, Medium { amplitudes, ..Medium::virgin(&material) }, true, &mut out).map(|()| out)
        };
        let Ok(ElementMatrices { amplitudes: known, .. }) = at(&u, None) else { continue };
        let slope = derivative(1e-5, |t| at(&moved(&u, case % 24, t), Some(&known)).unwrap().amplitudes.values);
        let error = relative_error(&known.slopes.map(|row| row[case % 24]), &slope);
        assert!(error < 1e-5, "{error}");
        let u = add(&u, &random.points(0.1));
        if let (Ok(a), Ok(b)) = (at(&u, Some(&known)), at(&u, None)) {
            both += 1;
            same += usize::from(relative_error(&a.residual, &b.residual) < 1e-8);
        }
    }
    // So far from a solution there may be two.
    assert!(both > 80 && same + 3 >= both, "{same} of {both}");
}
