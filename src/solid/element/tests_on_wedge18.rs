use super::super::testing::{CUBE, Random, add, affine};
use super::super::voigt::to_matrix;
use super::tests::{Nodes, materials, matrices};
use super::tests_on_fillers::{Element, Samples};
use super::tests_on_hex27::{self as hexahedra, OnNodes};
use super::*;
use crate::Vec3;
use crate::mesh::faces::{WEDGE_EDGES, WEDGE_ENDS, WEDGE_SIDES};
use crate::mesh::{Quarters, Solid, SolidShape};
use crate::scene::MaterialModel;

/// The half of [`CUBE`] below its diagonal plane, and that above.
const HALVES: [[usize; 6]; 2] = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];

type Wedge = Element<18, 54>;
pub(super) const WEDGES: [(Wedge, Samples<18, 18>); 2] =
    [(wedge18::evaluate, wedge18::samples), (wedge18_sri::evaluate, wedge18_sri::samples)];

/// The wedge in the place of `corners`, with straight edges.
fn straight(corners: &Nodes<6>) -> Nodes<18> {
    std::array::from_fn(|a| match a {
        0..6 => corners[a],
        6..15 => hexahedra::mean(corners, &WEDGE_EDGES[a - 6]),
        _ => hexahedra::mean(corners, &WEDGE_SIDES[a - 15].map(usize::from)),
    })
}

fn half() -> Nodes<18> {
    straight(&HALVES[0].map(|k| CUBE[k]))
}

/// One with curved edges, and random displacements.
pub(super) fn case(random: &mut Random) -> (Nodes<18>, Nodes<18>) {
    (add(&half(), &random.points(0.03)), random.points(0.03))
}

#[test]
fn shape_functions_are_one_at_their_nodes_and_quarters_are_of_faces() {
    let ends = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let corners: Nodes<6> = std::array::from_fn(|a| [ends[a % 3][0], ends[a % 3][1], 2.0 * (a / 3) as f64 - 1.0]);
    let places = straight(&corners);
    for (a, at) in places.iter().enumerate() {
        let (values, gradients) = wedge18::shape(*at);
        (0..18).for_each(|b| assert!((values[b] - f64::from(u8::from(a == b))).abs() < 1e-15));
        (0..3).for_each(|j| assert!(gradients[j].iter().sum::<f64>().abs() < 1e-14));
    }
    let solid = Solid::new(SolidShape::Wedge18, &std::array::from_fn::<u32, 18, _>(|a| a as u32), 1);
    let place = |n: u32| Vec3::from(places[n as usize]);
    let middle = Vec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0);
    for k in 0..SolidShape::Wedge18.face_count() {
        let facet = solid.face(k);
        let quarters = Quarters::in_solids([solid].iter(), [facet.nodes()].into_iter());
        let whole: Vec<Vec3> = quarters.of(facet.nodes()).unwrap().iter().map(|&n| place(n)).collect();
        let face: Vec<Vec3> = match (k / 4).checked_sub(2) {
            None => WEDGE_ENDS[k / 4].map(|n| place(n.into())).to_vec(),
            Some(side) => WEDGE_SIDES[side].map(|n| place(n.into())).to_vec(),
        };
        let count = face.len();
        assert_eq!(whole[0], face[k % 4 % count]);
        (0..count).for_each(|j| assert_eq!(whole[count + j], 0.5 * (whole[j] + whole[(j + 1) % count])));
        let x: Vec<Vec3> = facet.nodes().iter().map(|&n| place(n)).collect();
        assert!((x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[0] - middle)) > 0.0);
        match count {
            3 if k % 4 == 3 => assert_eq!(x, whole[3..]),
            3 => assert_eq!(x, [whole[0], whole[3], whole[5]]),
            _ => {
                assert_eq!(whole[8], face.iter().sum::<Vec3>() / 4.0);
                assert_eq!(x, [whole[0], whole[4], whole[8], whole[7]]);
            }
        }
    }
}

/// Distorted hexahedra around a node, some of them cut into two wedges, all of second order with straight edges; affine displacement of
/// all nodes.
#[test]
fn they_pass_the_patch_test_with_hexahedra() {
    let mut random = Random::new(64);
    let number = |i: usize, j: usize, k: usize| i + 3 * j + 9 * k;
    let grid: [[f64; 3]; 27] = std::array::from_fn(|n| {
        [n % 3, n / 3 % 3, n / 9].map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 })
    });
    let f = Mat3::identity() + random.matrix(0.2);
    let shift = random.vector(1.0);
    for (material, (wedge, samples)) in materials().iter().flat_map(|m| WEDGES.map(move |wedge| (m, wedge))) {
        let exact = to_matrix(&material.kirchhoff(&f, &State::VIRGIN).unwrap()) / f.determinant();
        let mut forces = OnNodes::default();
        for e in 0..8 {
            let (i, j, k) = (e % 2, e / 2 % 2, e / 4);
            let corners = CUBE.map(|c| grid[number(i + c[0] as usize, j + c[1] as usize, k + c[2] as usize)]);
            let all = hexahedra::straight(&corners);
            if e % 4 == 0 || e % 4 == 3 {
                forces.add(&all, &matrices(hex27::evaluate, &all, &affine(&all, &f, shift), material).residual);
                continue;
            }
            for half in HALVES {
                let x0 = straight(&half.map(|k| corners[k]));
                let u = affine(&x0, &f, shift);
                forces.add(&x0, &matrices(wedge, &x0, &u, material).residual);
                let stress = average_stress(&samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap();
                assert!((to_matrix(&stress) - exact).norm() < 1e-12 * material.initial_moduli().0);
            }
        }
        forces.assert_none_inside(material);
    }
}

/// A straight bar of one wedge over another that bends, small: see the same of hexahedra. With one change of volume in the element the
/// energy lacks that of the volume, which varies over it.
#[test]
fn bending_is_exact() {
    for poisson in [0.0, 0.3] {
        let material = Material::new(&MaterialModel::Hooke { young: 10.0, poisson });
        let c = 1e-8;
        let energy = |samples: Samples<18, 18>| -> f64 {
            let of_half = |half: [usize; 6]| {
                let corners = half.map(|k| [8.0 * CUBE[k][0], CUBE[k][1] - 0.5, CUBE[k][2] - 0.5]);
                let x0 = straight(&corners);
                let u = x0
                    .map(|[x, y, z]| [c * x * y, -0.5 * c * (x * x + poisson * (y * y - z * z)), -c * poisson * y * z]);
                stored_energy(&samples(&x0, &u).unwrap(), Medium::virgin(&material)).unwrap()
            };
            HALVES.map(of_half).iter().sum()
        };
        // E c^2 / 2 times the length and the second moment of area.
        let exact = 0.5 * 10.0 * c * c * 8.0 / 12.0;
        assert!((energy(wedge18::samples) / exact - 1.0).abs() < 1e-6, "{poisson}");
        assert!(energy(wedge18_sri::samples) < 0.999 * exact);
    }
}

#[test]
fn volumes_points_and_body_forces() {
    let mut random = Random::new(65);
    assert!((wedge18::volume(&half()) - 0.5).abs() < 1e-15 && (wedge18::min_jacobian(&half()) - 1.0).abs() < 1e-14);
    let (x0, u) = case(&mut random);
    let f = Mat3::identity() + random.matrix(0.2);
    let after = wedge18::volume(&add(&x0, &affine(&x0, &f, u[0].into())));
    assert!((after - f.determinant() * wedge18::volume(&x0)).abs() < 1e-15);
    let at = [0.2, 0.5, -0.3];
    let place: Vec3 = wedge18::shape(at).0.iter().zip(x0).map(|(n, x)| *n * Vec3::from(x)).sum();
    let found = wedge18::parameters(&x0, &place).unwrap();
    assert!((0..3).all(|k| (found[k] - at[k]).abs() < 1e-12), "{found:?}");
    let force = wedge18::body_force(&x0, Vec3::new(0.0, 0.0, 2.0));
    let sum: f64 = force.as_chunks::<3>().0.iter().map(|f| f[2]).sum();
    assert!((sum - 2.0 * wedge18::volume(&x0)).abs() < 1e-14);
    let field = |[x, y, z]: [f64; 3]| 1.0 + x * x - 2.0 * x * y * z * z + 0.5 * y * y * z;
    let nodes = half();
    let at_points = wedge18::VALUES.map(|n| n.iter().zip(nodes).map(|(n, x)| n * field(x)).sum::<f64>());
    for (weights, x) in wedge18::AT_NODES.iter().zip(nodes) {
        let there: f64 = weights.iter().zip(at_points).map(|(w, v)| w * v).sum();
        assert!((there - field(x)).abs() < 1e-13);
    }
}
