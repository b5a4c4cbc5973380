use super::super::testing::{CUBE, Random, add, affine, derivative, relative_error, rotation};
use super::tests::{Nodes, materials, matrices, moved, tangent_error};
use super::*;
use crate::Vec3;
use crate::mesh::faces::{HEX_EDGES, HEX_FACES};
use crate::mesh::{Quarters, Solid, SolidShape};
use crate::scene::{Hardening, MaterialModel};
use std::collections::BTreeMap;

/// The element in the place of `corners`, straight.
pub(super) fn straight(corners: &Nodes<8>) -> Nodes<27> {
    std::array::from_fn(|a| match a {
        0..8 => corners[a],
        8..20 => mean(corners, &HEX_EDGES[a - 8]),
        20..26 => mean(corners, &HEX_FACES[a - 20].map(usize::from)),
        _ => mean(corners, &[0, 1, 2, 3, 4, 5, 6, 7]),
    })
}

/// The mean of some corners.
pub(super) fn mean(corners: &[[f64; 3]], of: &[usize]) -> [f64; 3] {
    std::array::from_fn(|i| of.iter().map(|&a| corners[a][i]).sum::<f64>() / of.len() as f64)
}

/// Forces on the nodes of elements that fill a cube of side 1, by their places.
#[derive(Default)]
pub(super) struct OnNodes {
    forces: BTreeMap<[i64; 3], Vec3>,
    size: f64,
}

impl OnNodes {
    pub fn add(&mut self, places: &[[f64; 3]], residual: &[f64]) {
        for (f, x) in residual.as_chunks::<3>().0.iter().zip(places) {
            *self.forces.entry(x.map(|x| (1e9 * x).round() as i64)).or_default() += Vec3::from(*f);
            self.size = self.size.max(Vec3::from(*f).norm());
        }
    }

    /// That there is none on the 27 nodes inside.
    pub fn assert_none_inside(&self, material: &Material) {
        let is_inside = |x: &[i64; 3]| x.iter().all(|&x| x > 0 && x < 1_000_000_000);
        let inside: Vec<&Vec3> = self.forces.iter().filter(|(x, _)| is_inside(x)).map(|(_, f)| f).collect();
        assert_eq!(inside.len(), 27);
        assert!(inside.iter().all(|f| f.norm() < 1e-12 * self.size), "{material:?}");
    }
}

/// One with curved edges, and random displacements.
fn case(random: &mut Random) -> (Nodes<27>, Nodes<27>) {
    (add(&straight(&CUBE), &random.points(0.04)), random.points(0.04))
}

#[test]
fn shape_functions_are_one_at_their_nodes() {
    let places = straight(&super::hex8::NODES);
    for (a, at) in places.iter().enumerate() {
        let (values, gradients) = hex27::shape(*at);
        (0..27).for_each(|b| assert!((values[b] - f64::from(u8::from(a == b))).abs() < 1e-15));
        (0..3).for_each(|j| assert!(gradients[j].iter().sum::<f64>().abs() < 1e-14));
    }
    let solid = Solid::new(SolidShape::Hex27, &std::array::from_fn::<u32, 27, _>(|a| a as u32), 1);
    for quarter in 0..SolidShape::Hex27.face_count() {
        let facet = solid.face(quarter);
        let quarters = Quarters::in_solids([solid].iter(), [facet.nodes()].into_iter());
        let at: Vec<Vec3> =
            quarters.of(facet.nodes()).unwrap().iter().map(|&node| Vec3::from(places[node as usize])).collect();
        let face = HEX_FACES[quarter / 4].map(|corner| Vec3::from(places[corner as usize]));
        assert_eq!(at[0], face[quarter % 4]);
        assert_eq!(at[8], face.iter().sum::<Vec3>() / 4.0);
        (0..4).for_each(|k| assert_eq!(at[4 + k], 0.5 * (at[k] + at[(k + 1) % 4])));
        assert!((at[1] - at[0]).cross(&(at[3] - at[0])).dot(&at[8]) > 0.0);
    }
}

#[test]
fn values_at_gauss_points_are_brought_to_the_nodes() {
    let field = |[x, y, z]: [f64; 3]| 1.0 + x * x * y - 2.0 * y * z * z + 0.5 * x * x * y * y * z * z;
    let nodes = straight(&super::hex8::NODES);
    let at_points: [f64; 27] =
        std::array::from_fn(|q| (0..27).map(|a| hex27::VALUES[q][a] * field(nodes[a])).sum::<f64>());
    for (weights, node) in hex27::AT_NODES.iter().zip(nodes) {
        let value: f64 = weights.iter().zip(at_points).map(|(weight, value)| weight * value).sum();
        assert!((value - field(node)).abs() < 1e-13);
    }
}

#[test]
fn tangents_are_the_derivative_of_the_residual_and_symmetric() {
    let mut random = Random::new(41);
    for material in &materials() {
        let (x0, u) = case(&mut random);
        let error = tangent_error(hex27::evaluate, &x0, &u, material, 2e-4);
        assert!(error < 1e-10, "{material:?} {error}");
        let k = matrices(hex27::evaluate, &x0, &u, material).tangent;
        (0..81).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
    }
}

#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let material = Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill: None, hardening });
    let mut random = Random::new(42);
    let (x0, before) = case(&mut random);
    let mut states = [State::VIRGIN; 27];
    advance(&hex27::samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
    let u = add(&before, &random.points(0.04));
    let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
        hex27::evaluate(x0, u, Medium { states: &states, ..medium }, want, out)
    };
    let error = tangent_error(element, &x0, &u, &material, 2e-5);
    assert!(error < 1e-6, "{error}");
}

#[test]
fn residuals_are_the_derivative_of_the_energy_and_balance() {
    let mut random = Random::new(43);
    for material in &materials() {
        let medium = Medium::virgin(material);
        let (x0, u) = case(&mut random);
        let energy = |u: &Nodes<27>| stored_energy(&hex27::samples(&x0, u).unwrap(), medium).unwrap();
        let differences: [f64; 81] = std::array::from_fn(|dof| derivative(2e-4, |t| [energy(&moved(&u, dof, t))])[0]);
        let residual = matrices(hex27::evaluate, &x0, &u, material).residual;
        let error = relative_error(&residual, &differences);
        assert!(error < 1e-9, "{material:?} {error}");
        let (mut force, mut moment, mut size) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for (f, x) in residual.as_chunks::<3>().0.iter().zip(add(&x0, &u)) {
            force += Vec3::from(*f);
            moment += Vec3::from(x).cross(&Vec3::from(*f));
            size += Vec3::from(*f).norm();
        }
        assert!(force.norm() < 1e-13 * size && moment.norm() < 1e-13 * size);
        // Rigid motion turns the forces.
        let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
        let after = add(&u, &affine(&add(&x0, &u), &r, shift));
        let turned = matrices(hex27::evaluate, &x0, &after, material).residual;
        for (f, g) in residual.as_chunks::<3>().0.iter().zip(turned.as_chunks::<3>().0) {
            assert!((r * Vec3::from(*f) - Vec3::from(*g)).norm() < 1e-12 * size);
        }
    }
}

/// Eight elements in a cube whose corners inside are moved about, straight: affine displacements give no force inside.
#[test]
fn patch_test() {
    let mut random = Random::new(44);
    let number = |at: [usize; 3]| at[0] + 3 * at[1] + 9 * at[2];
    let grid: [[f64; 3]; 27] = std::array::from_fn(|n| {
        [n % 3, n / 3 % 3, n / 9].map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 })
    });
    let f = Mat3::identity() + random.matrix(0.2);
    let shift = random.vector(1.0);
    for material in &materials() {
        let mut forces = OnNodes::default();
        for e in 0..8usize {
            let low = [e % 2, e / 2 % 2, e / 4];
            let corners = CUBE.map(|c| grid[number([0, 1, 2].map(|i| low[i] + c[i] as usize))]);
            let x0 = straight(&corners);
            forces.add(&x0, &matrices(hex27::evaluate, &x0, &affine(&x0, &f, shift), material).residual);
        }
        forces.assert_none_inside(material);
    }
}

/// A straight bar that bends, small: u = c (x y, -(x^2 + nu (y^2 - z^2)) / 2, -nu y z) has the one stress E c y, exactly.
#[test]
fn bending_is_exact() {
    for poisson in [0.0, 0.3, 0.499] {
        let material = Material::new(&MaterialModel::Hooke { young: 10.0, poisson });
        let x0 = straight(&CUBE.map(|[x, y, z]| [8.0 * x, y - 0.5, z - 0.5]));
        let c = 1e-8;
        let u = x0.map(|[x, y, z]| [c * x * y, -0.5 * c * (x * x + poisson * (y * y - z * z)), -c * poisson * y * z]);
        let medium = Medium::virgin(&material);
        let energy = stored_energy(&hex27::samples(&x0, &u).unwrap(), medium).unwrap();
        // E c^2 / 2 times the length and the second moment of area.
        let exact = 0.5 * 10.0 * c * c * 8.0 / 12.0;
        assert!((energy / exact - 1.0).abs() < 1e-6, "{poisson} {}", energy / exact);
    }
}

#[test]
fn points_are_found_and_body_forces_add_up() {
    let mut random = Random::new(45);
    let (x0, _) = case(&mut random);
    let at = [0.3, -0.8, 0.55];
    let place: Vec3 = hex27::shape(at).0.iter().zip(x0).map(|(n, x)| *n * Vec3::from(x)).sum();
    let found = hex27::parameters(&x0, &place).unwrap();
    (0..3).for_each(|d| assert!((found[d] - at[d]).abs() < 1e-12));
    let force = hex27::body_force(&x0, Vec3::new(0.0, 0.0, 2.0));
    let sum: f64 = force.as_chunks::<3>().0.iter().map(|f| f[2]).sum();
    assert!((sum - 2.0 * hex27::volume(&x0)).abs() < 1e-14);
}
