use super::super::testing::{Random, add, affine, derivative, relative_error, rotation};
use super::super::voigt::to_matrix;
use super::tests::{CUBE, HEXES, Hex, Nodes, materials, matrices, moved, tangent_error};
use super::*;
use crate::Vec3;
use crate::mesh::faces::{HEX_FACES, PYRAMID_BASE};
use crate::scene::{Hardening, MaterialModel};

const PYRAMID: Nodes<5> = [CUBE[0], CUBE[1], CUBE[2], CUBE[3], [0.5, 0.5, 0.6]];

type Pyramid = fn(&Nodes<5>, &Nodes<5>, Medium, bool, &mut ElementMatrices<15>) -> Result<(), Inverted>;
type PyramidSamples = fn(&Nodes<5>, &Nodes<5>) -> Result<[Sample; 8], Inverted>;
const PYRAMIDS: [(Pyramid, PyramidSamples); 2] =
    [(pyramid5::evaluate, pyramid5::samples), (pyramid5_sri::evaluate, pyramid5_sri::samples)];

/// A distorted element and random displacements, none inverted.
fn case(random: &mut Random) -> (Nodes<5>, Nodes<5>) {
    (add(&PYRAMID, &random.points(0.08)), random.points(0.08))
}

/// Against differences of residuals, and these against differences of the energy; symmetric.
#[test]
fn forces_and_tangents_are_derivatives() {
    let mut random = Random::new(51);
    for material in &materials() {
        let medium = Medium::virgin(material);
        for (pyramid, samples) in PYRAMIDS {
            let (x0, u) = case(&mut random);
            let error = tangent_error(pyramid, &x0, &u, material, 5e-4);
            assert!(error < 1e-10, "{material:?} {error}");
            let out = matrices(pyramid, &x0, &u, material);
            (0..15).for_each(|i| (0..i).for_each(|j| assert_eq!(out.tangent[i][j], out.tangent[j][i])));
            let energy = |u: &Nodes<5>| stored_energy(&samples(&x0, u).unwrap(), medium).unwrap();
            let differences: [f64; 15] =
                std::array::from_fn(|dof| derivative(5e-4, |t| [energy(&moved(&u, dof, t))])[0]);
            let error = relative_error(&out.residual, &differences);
            assert!(error < 1e-10, "{material:?} {error}");
        }
    }
}

#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    let mut random = Random::new(52);
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let material = Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill: None, hardening });
    for (pyramid, samples) in PYRAMIDS {
        let (x0, before) = case(&mut random);
        let u = add(&before, &random.points(0.06));
        let mut states = [State::VIRGIN; 8];
        advance(&samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
        let mut after = states;
        advance(&samples(&x0, &u).unwrap(), &material, &mut after).unwrap();
        assert!((0..8).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
        let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
            pyramid(x0, u, Medium { states: &states, ..medium }, want, out)
        };
        let error = tangent_error(element, &x0, &u, &material, 5e-5);
        assert!(error < 1e-7, "{error}");
    }
}

/// Rigid motion leaves six modes and no others without stiffness; it turns forces, which balance.
#[test]
fn rigid_motion_gives_no_force_and_nothing_else_does_not() {
    let mut random = Random::new(53);
    for (material, (pyramid, _)) in materials().iter().flat_map(|m| PYRAMIDS.map(move |pyramid| (m, pyramid))) {
        let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
        let (x0, u) = case(&mut random);
        let rigid = matrices(pyramid, &x0, &affine(&x0, &r, shift), material);
        let stiffness = rigid.tangent.as_flattened().iter().fold(0f64, |m, k| m.max(k.abs()));
        assert!(rigid.residual.iter().all(|f| f.abs() < 1e-14 * stiffness));
        let mut modes: Vec<f64> = nalgebra::DMatrix::from_fn(15, 15, |i, j| rigid.tangent[i][j])
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect();
        modes.sort_by(f64::total_cmp);
        assert!(modes[5].abs() < 1e-13 * stiffness && modes[6] > 1e-2 * material.initial_moduli().1 / stiffness);
        let x = add(&x0, &u);
        let after = add(&u, &affine(&x, &r, shift));
        let (a, b) = (matrices(pyramid, &x0, &u, material), matrices(pyramid, &x0, &after, material));
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for n in 0..5 {
            let f = Vec3::from_column_slice(&a.residual[3 * n..3 * n + 3]);
            (0..3).for_each(|i| assert!(((r * f)[i] - b.residual[3 * n + i]).abs() < 1e-13 * stiffness));
            force += f;
            moment += Vec3::from(x[n]).cross(&f);
        }
        assert!(force.norm() < 1e-14 * stiffness && moment.norm() < 1e-14 * stiffness);
    }
}

/// Eight distorted hexahedra around a node; the upper ones are cut into a pyramid on their lower face, and two tetrahedra on each
/// other, all with an apex in the middle. Affine displacement of all nodes.
#[test]
fn pyramids_pass_the_patch_test_between_hexahedra_and_tetrahedra() {
    let mut random = Random::new(54);
    let number = |i: usize, j: usize, k: usize| i + 3 * j + 9 * k;
    let grid: [[f64; 3]; 27] = std::array::from_fn(|n| {
        [n % 3, n / 3 % 3, n / 9].map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 })
    });
    let f = Mat3::identity() + random.matrix(0.2);
    let shift = random.vector(1.0);
    let displaced = affine(&grid, &f, shift);
    let beside: [(Hex, Pyramid); 4] = std::array::from_fn(|k| (HEXES[k], PYRAMIDS[usize::from(k > 0)].0));
    for (material, (hex, pyramid)) in materials().iter().flat_map(|m| beside.map(move |pair| (m, pair))) {
        let exact = to_matrix(&material.kirchhoff(&f, &State::VIRGIN).unwrap()) / f.determinant();
        // Of the grid, and of the apex in each element.
        let (mut forces, mut size) = ([Vec3::zeros(); 27 + 8], 0f64);
        let mut note = |residual: &[f64], nodes: &[usize]| {
            for (force, &n) in residual.as_chunks::<3>().0.iter().zip(nodes) {
                forces[n] += Vec3::from(*force);
            }
            size = residual.iter().fold(size, |m, f| m.max(f.abs()));
        };
        for e in 0..8 {
            let (i, j, k) = (e % 2, e / 2 % 2, e / 4);
            let nodes = CUBE.map(|c| number(i + c[0] as usize, j + c[1] as usize, k + c[2] as usize));
            if k == 0 {
                note(&matrices(hex, &nodes.map(|n| grid[n]), &nodes.map(|n| displaced[n]), material).residual, &nodes);
                continue;
            }
            let apex: [f64; 3] = std::array::from_fn(|d| nodes.iter().map(|&n| grid[n][d] / 8.0).sum());
            let moved_apex = affine(&[apex], &f, shift)[0];
            let apex_number = 27 + e;
            let at = |n: usize| if n == apex_number { (apex, moved_apex) } else { (grid[n], displaced[n]) };
            for (face, local) in HEX_FACES.iter().enumerate() {
                let corners = local.map(|k| nodes[k as usize]);
                if face == 0 {
                    let base = PYRAMID_BASE.map(|k| corners[k as usize]);
                    let own = [base[0], base[1], base[2], base[3], apex_number];
                    let (x0, u) = (own.map(|n| at(n).0), own.map(|n| at(n).1));
                    note(&matrices(pyramid, &x0, &u, material).residual, &own);
                    for (_, samples) in PYRAMIDS {
                        let stress = average_stress(&samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap();
                        assert!((to_matrix(&stress) - exact).norm() < 1e-12 * material.initial_moduli().0);
                    }
                    continue;
                }
                // The diagonal from the lowest number, as the neighbour has it.
                let first = (0..4).min_by_key(|k| corners[*k]).unwrap();
                let [a, b, c, d] = std::array::from_fn(|k| corners[(first + k) % 4]);
                for own in [[a, c, b, apex_number], [a, d, c, apex_number]] {
                    note(
                        &matrices(tet4::evaluate, &own.map(|n| at(n).0), &own.map(|n| at(n).1), material).residual,
                        &own,
                    );
                }
            }
        }
        for n in [13, 31, 32, 33, 34] {
            assert!(forces[n].norm() < 3e-13 * size, "{n} {} {size}", forces[n]);
        }
    }
}

/// int N_a dV, volumes, the parameters of a point, and what the values of a field at points give at nodes.
#[test]
fn volumes_points_and_body_forces() {
    let mut random = Random::new(55);
    assert!((pyramid5::volume(&PYRAMID) - 0.2).abs() < 1e-15);
    let (x0, u) = case(&mut random);
    let f = Mat3::identity() + random.matrix(0.2);
    assert!(
        (pyramid5::volume(&add(&x0, &affine(&x0, &f, u[0].into()))) - f.determinant() * pyramid5::volume(&x0)).abs()
            < 1e-15
    );
    // By the divergence theorem, with the base as the bilinear face of a hexahedron.
    let height = |n: [usize; 3]| {
        let [a, b, c] = n.map(|k| Vec3::from(x0[k]));
        a.dot(&b.cross(&c)) / 6.0
    };
    let base = 0.5 * (height([0, 2, 1]) + height([0, 3, 2]) + height([0, 3, 1]) + height([1, 3, 2]));
    let sides: f64 = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]].map(height).iter().sum();
    assert!((pyramid5::volume(&x0) - base - sides).abs() < 1e-15);
    let jacobians = pyramid5::nodal_jacobians(&x0);
    for (a, jacobian) in jacobians.iter().enumerate() {
        let [next, last, apex] = [(a + 1) % 4, (a + 3) % 4, 4].map(|k| Vec3::from(x0[k]) - Vec3::from(x0[a]));
        assert!((4.0 * jacobian - next.cross(&last).dot(&apex)).abs() < 1e-15);
    }
    // The mass of the base's nodes is that of a pyramid 1 x 1 x 0.6: 3/16 of its volume each, 1/4 at the apex.
    let load = pyramid5::body_force(&PYRAMID, Vec3::new(0.0, 0.0, 80.0));
    let shares: Vec<f64> = load.as_chunks::<3>().0.iter().map(|f| f[2]).collect();
    assert!(shares.iter().zip([3.0, 3.0, 3.0, 3.0, 4.0]).all(|(f, exact)| (f - exact).abs() < 1e-14), "{shares:?}");
    let place = |x0: &Nodes<5>, [p, r, t]: [f64; 3]| -> Vec3 {
        pyramid5::shape(p, r, t).0.iter().zip(x0).map(|(n, x)| *n * Vec3::from(*x)).sum()
    };
    for at in [[0.2, -0.5, 0.6], [0.3, 0.3, 0.3], [-1.0, 1.0, 1.0], [0.0, 0.0, 1e-9]] {
        let found = pyramid5::parameters(&x0, &place(&x0, at)).unwrap();
        assert!((0..3).all(|k| (found[k] - at[k]).abs() < 1e-12), "{found:?} {at:?}");
    }
    let found = pyramid5::parameters(&x0, &x0[4].into()).unwrap();
    assert!(found.iter().all(|k| k.abs() < 1e-12), "{found:?}");
    // Functions and derivatives at the integration points are those by p, r and t there.
    let field = |x: &Vec3| 1.0 + 2.0 * x.x - 3.0 * x.y + 0.5 * x.z;
    let values = pyramid5::VALUES.map(|n| field(&n.iter().zip(&x0).map(|(n, x)| *n * Vec3::from(*x)).sum()));
    let (g, t) = (GAUSS, 0.5 * (1.0 + GAUSS));
    let own = pyramid5::shape(-g * t, -g * t, t).0;
    assert!((0..5).all(|a| (own[a] - pyramid5::VALUES[0][a]).abs() < 1e-15));
    for (weights, x) in pyramid5::AT_NODES.iter().zip(&x0) {
        let there: f64 = weights.iter().zip(values).map(|(w, v)| w * v).sum();
        assert!((there - field(&Vec3::from(*x))).abs() < 1e-14);
    }
}
