use super::super::testing::{CUBE, Random, add, affine};
use super::super::voigt::to_matrix;
use super::tests::{HEXES, Hex, Nodes, assert_edges_span, materials, matrices};
use super::tests_on_fillers::{Element, Samples};
use super::*;
use crate::Vec3;

/// The half of [`CUBE`] below its diagonal plane, and that above.
const HALVES: [[usize; 6]; 2] = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];

type Wedge = Element<6, 18>;
pub(super) const WEDGES: [(Wedge, Samples<6, 6>); 2] =
    [(wedge6::evaluate, wedge6::samples), (wedge6_sri::evaluate, wedge6_sri::samples)];

fn half() -> Nodes<6> {
    HALVES[0].map(|k| CUBE[k])
}

/// A distorted element and random displacements, none inverted.
pub(super) fn case(random: &mut Random) -> (Nodes<6>, Nodes<6>) {
    (add(&half(), &random.points(0.12)), random.points(0.12))
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
