use super::super::testing::{CUBE, Random, add, affine};
use super::super::voigt::to_matrix;
use super::tests::{HEXES, Hex, Nodes, materials, matrices};
use super::tests_on_fillers::{Element, Samples};
use super::*;
use crate::Vec3;
use crate::mesh::faces::{HEX_FACES, PYRAMID_BASE};

const PYRAMID: Nodes<5> = [CUBE[0], CUBE[1], CUBE[2], CUBE[3], [0.5, 0.5, 0.6]];

type Pyramid = Element<5, 15>;
pub(super) const PYRAMIDS: [(Pyramid, Samples<5, 8>); 2] =
    [(pyramid5::evaluate, pyramid5::samples), (pyramid5_sri::evaluate, pyramid5_sri::samples)];

/// A distorted element and random displacements, none inverted.
pub(super) fn case(random: &mut Random) -> (Nodes<5>, Nodes<5>) {
    (add(&PYRAMID, &random.points(0.08)), random.points(0.08))
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
