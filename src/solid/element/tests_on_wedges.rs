use super::super::testing::{Random, add, affine, derivative, relative_error, rotation};
use super::super::voigt::to_matrix;
use super::tests::{CUBE, HEXES, Hex, Nodes, assert_edges_span, materials, matrices, moved, tangent_error};
use super::*;
use crate::Vec3;
use crate::scene::{Hardening, MaterialModel};

/// The half of [`CUBE`] below its diagonal plane, and that above.
const HALVES: [[usize; 6]; 2] = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];

type Wedge = fn(&Nodes<6>, &Nodes<6>, Medium, bool, &mut ElementMatrices<18>) -> Result<(), Inverted>;
type WedgeSamples = fn(&Nodes<6>, &Nodes<6>) -> Result<[Sample; 6], Inverted>;
const WEDGES: [(Wedge, WedgeSamples); 2] =
    [(wedge6::evaluate, wedge6::samples), (wedge6_sri::evaluate, wedge6_sri::samples)];

fn half() -> Nodes<6> {
    HALVES[0].map(|k| CUBE[k])
}

/// A distorted element and random displacements, none inverted.
fn case(random: &mut Random) -> (Nodes<6>, Nodes<6>) {
    (add(&half(), &random.points(0.12)), random.points(0.12))
}

/// Against differences of residuals, and these against differences of the energy; symmetric.
#[test]
fn forces_and_tangents_are_derivatives() {
    let mut random = Random::new(41);
    for material in &materials() {
        let medium = Medium::virgin(material);
        for (wedge, samples) in WEDGES {
            let (x0, u) = case(&mut random);
            let error = tangent_error(wedge, &x0, &u, material, 5e-4);
            assert!(error < 1e-10, "{material:?} {error}");
            let out = matrices(wedge, &x0, &u, material);
            (0..18).for_each(|i| (0..i).for_each(|j| assert_eq!(out.tangent[i][j], out.tangent[j][i])));
            let energy = |u: &Nodes<6>| stored_energy(&samples(&x0, u).unwrap(), medium).unwrap();
            let differences: [f64; 18] =
                std::array::from_fn(|dof| derivative(5e-4, |t| [energy(&moved(&u, dof, t))])[0]);
            let error = relative_error(&out.residual, &differences);
            assert!(error < 1e-10, "{material:?} {error}");
        }
    }
}

#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    let mut random = Random::new(42);
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let material = Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill: None, hardening });
    for (wedge, samples) in WEDGES {
        let (x0, before) = case(&mut random);
        let u = add(&before, &random.points(0.06));
        let mut states = [State::VIRGIN; 6];
        advance(&samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
        let mut after = states;
        advance(&samples(&x0, &u).unwrap(), &material, &mut after).unwrap();
        assert!((0..6).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
        let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
            wedge(x0, u, Medium { states: &states, ..medium }, want, out)
        };
        let error = tangent_error(element, &x0, &u, &material, 5e-5);
        assert!(error < 1e-7, "{error}");
    }
}

/// Rigid motion leaves six modes and no others without stiffness; it turns forces, which balance.
#[test]
fn rigid_motion_gives_no_force_and_nothing_else_does_not() {
    let mut random = Random::new(43);
    for (material, (wedge, _)) in materials().iter().flat_map(|m| WEDGES.map(move |wedge| (m, wedge))) {
        let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
        let (x0, u) = case(&mut random);
        let rigid = matrices(wedge, &x0, &affine(&x0, &r, shift), material);
        let stiffness = rigid.tangent.as_flattened().iter().fold(0f64, |m, k| m.max(k.abs()));
        assert!(rigid.residual.iter().all(|f| f.abs() < 1e-14 * stiffness));
        let mut modes: Vec<f64> = nalgebra::DMatrix::from_fn(18, 18, |i, j| rigid.tangent[i][j])
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect();
        modes.sort_by(f64::total_cmp);
        assert!(modes[5].abs() < 1e-13 * stiffness && modes[6] > 1e-2 * material.initial_moduli().1 / stiffness);
        let x = add(&x0, &u);
        let after = add(&u, &affine(&x, &r, shift));
        let (a, b) = (matrices(wedge, &x0, &u, material), matrices(wedge, &x0, &after, material));
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for n in 0..6 {
            let f = Vec3::from_column_slice(&a.residual[3 * n..3 * n + 3]);
            (0..3).for_each(|i| assert!(((r * f)[i] - b.residual[3 * n + i]).abs() < 1e-13 * stiffness));
            force += f;
            moment += Vec3::from(x[n]).cross(&f);
        }
        assert!(force.norm() < 1e-14 * stiffness && moment.norm() < 1e-14 * stiffness);
    }
}

/// Eight distorted hexahedra around a node, some of them cut into two wedges, of each formulation of hexahedra with that of the
/// wedges beside it; affine displacement of all nodes.
#[test]
fn wedges_pass_the_patch_test_with_hexahedra() {
    let mut random = Random::new(44);
    let number = |i: usize, j: usize, k: usize| i + 3 * j + 9 * k;
    let grid: [[f64; 3]; 27] = std::array::from_fn(|n| {
        [n % 3, n / 3 % 3, n / 9].map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 })
    });
    let f = Mat3::identity() + random.matrix(0.2);
    let displaced = affine(&grid, &f, random.vector(1.0));
    let beside: [(Hex, Wedge); 4] = std::array::from_fn(|k| (HEXES[k], WEDGES[usize::from(k > 0)].0));
    for (material, (hex, wedge)) in materials().iter().flat_map(|m| beside.map(move |pair| (m, pair))) {
        let exact = to_matrix(&material.kirchhoff(&f, &State::VIRGIN).unwrap()) / f.determinant();
        let (mut inner, mut size) = (Vec3::zeros(), 0f64);
        let mut add_inner = |residual: &[f64], at: Option<usize>| {
            if let Some(a) = at {
                inner += Vec3::from_column_slice(&residual[3 * a..3 * a + 3]);
            }
            size = residual.iter().fold(size, |m, f| m.max(f.abs()));
        };
        for e in 0..8 {
            let (i, j, k) = (e % 2, e / 2 % 2, e / 4);
            let nodes = CUBE.map(|c| number(i + c[0] as usize, j + c[1] as usize, k + c[2] as usize));
            if e % 4 == 0 || e % 4 == 3 {
                let residual = matrices(hex, &nodes.map(|n| grid[n]), &nodes.map(|n| displaced[n]), material).residual;
                add_inner(&residual, nodes.iter().position(|&n| n == 13));
                continue;
            }
            for half in HALVES.map(|half| half.map(|k| nodes[k])) {
                let (x0, u) = (half.map(|n| grid[n]), half.map(|n| displaced[n]));
                add_inner(&matrices(wedge, &x0, &u, material).residual, half.iter().position(|&n| n == 13));
                for (_, samples) in WEDGES {
                    let stress = average_stress(&samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap();
                    assert!((to_matrix(&stress) - exact).norm() < 1e-12 * material.initial_moduli().0);
                }
            }
        }
        assert!(inner.norm() < 1e-13 * size, "{inner} {size}");
    }
}

/// int N_a dV, volumes, the parameters of a point, and what the values of a field at points give at nodes.
#[test]
fn volumes_points_and_body_forces() {
    let mut random = Random::new(45);
    assert!((wedge6::volume(&half()) - 0.5).abs() < 1e-15 && (wedge6::min_jacobian(&half()) - 0.5).abs() < 1e-15);
    let x = case(&mut random).0;
    assert_edges_span(&wedge6::nodal_jacobians(&x), (&x, &half()), 2.0);
    let load = wedge6::body_force(&half(), Vec3::new(0.0, 0.0, 12.0));
    assert!(load.as_chunks::<3>().0.iter().all(|f| f[0] == 0.0 && f[1] == 0.0 && (f[2] - 1.0).abs() < 1e-15));
    // The halves of a cube with a warped diagonal plane fill it, and so do those of a hexahedron with flat ends.
    let mut whole = CUBE;
    (whole[0], whole[6]) = ([0.1, -0.1, 0.0], [0.9, 1.2, 1.0]);
    let sum: f64 = HALVES.map(|half| wedge6::volume(&half.map(|k| whole[k]))).iter().sum();
    assert!((sum - hex8::volume(&whole)).abs() < 1e-15, "{sum}");
    let (x0, u) = case(&mut random);
    let f = Mat3::identity() + random.matrix(0.2);
    assert!(
        (wedge6::volume(&add(&x0, &affine(&x0, &f, u[0].into()))) - f.determinant() * wedge6::volume(&x0)).abs()
            < 1e-15
    );
    let at = [0.2, 0.5, -0.3];
    let place: Vec3 = wedge6::shape(at[0], at[1], at[2]).0.iter().zip(&x0).map(|(n, x)| *n * Vec3::from(*x)).sum();
    let found = wedge6::parameters(&x0, &place).unwrap();
    assert!((0..3).all(|k| (found[k] - at[k]).abs() < 1e-12), "{found:?}");
    let field = |x: &Vec3| 1.0 + 2.0 * x.x - 3.0 * x.y + 0.5 * x.z + x.x * x.z;
    let values = wedge6::VALUES.map(|n| field(&n.iter().zip(&half()).map(|(n, x)| *n * Vec3::from(*x)).sum()));
    for (weights, x) in wedge6::AT_NODES.iter().zip(&half()) {
        let there: f64 = weights.iter().zip(values).map(|(w, v)| w * v).sum();
        assert!((there - field(&Vec3::from(*x))).abs() < 1e-14);
    }
}
