//! What wedges, of second order, too, and pyramids have in common.

use super::super::testing::{Random, add, affine, derivative, relative_error, rotation};
use super::tests::{Nodes, materials, matrices, moved, tangent_error};
use super::*;
use super::{tests_on_pyramids as pyramids, tests_on_wedge18 as quadratic, tests_on_wedges as wedges};
use crate::Vec3;
use crate::scene::{Hardening, MaterialModel};

pub(super) type Element<const N: usize, const D: usize> =
    fn(&Nodes<N>, &Nodes<N>, Medium, bool, &mut ElementMatrices<D>) -> Result<(), Inverted>;
pub(super) type Samples<const N: usize, const Q: usize> = fn(&Nodes<N>, &Nodes<N>) -> Result<[Sample; Q], Inverted>;

/// Formulations with their integration points, and a distorted element with random displacements.
type Family<const N: usize, const Q: usize, const D: usize> =
    ([(Element<N, D>, Samples<N, Q>); 2], fn(&mut Random) -> (Nodes<N>, Nodes<N>));

const WEDGES: Family<6, 6, 18> = (wedges::WEDGES, wedges::case);
const QUADRATIC: Family<18, 18, 54> = (quadratic::WEDGES, quadratic::case);
const PYRAMIDS: Family<5, 8, 15> = (pyramids::PYRAMIDS, pyramids::case);

/// Against differences of residuals, and these against differences of the energy; symmetric.
#[test]
fn forces_and_tangents_are_derivatives() {
    check_derivatives(WEDGES, 41);
    check_derivatives(PYRAMIDS, 51);
    check_derivatives(QUADRATIC, 61);
}

fn check_derivatives<const N: usize, const Q: usize, const D: usize>((all, case): Family<N, Q, D>, seed: u64) {
    let mut random = Random::new(seed);
    for material in &materials() {
        let medium = Medium::virgin(material);
        for (element, samples) in all {
            let (x0, u) = case(&mut random);
            let error = tangent_error(element, &x0, &u, material, 5e-4);
            assert!(error < 1e-10, "{material:?} {error}");
            let out = matrices(element, &x0, &u, material);
            (0..D).for_each(|i| (0..i).for_each(|j| assert_eq!(out.tangent[i][j], out.tangent[j][i])));
            let energy = |u: &Nodes<N>| stored_energy(&samples(&x0, u).unwrap(), medium).unwrap();
            let differences: [f64; D] =
                std::array::from_fn(|dof| derivative(5e-4, |t| [energy(&moved(&u, dof, t))])[0]);
            let error = relative_error(&out.residual, &differences);
            assert!(error < 1e-10, "{material:?} {error}");
        }
    }
}

#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    check_flow(WEDGES, 42);
    check_flow(PYRAMIDS, 52);
    check_flow(QUADRATIC, 62);
}

fn check_flow<const N: usize, const Q: usize, const D: usize>((all, case): Family<N, Q, D>, seed: u64) {
    let mut random = Random::new(seed);
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let material = Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill: None, hardening });
    for (element, samples) in all {
        let (x0, before) = case(&mut random);
        let u = add(&before, &random.points(0.06));
        let mut states = [State::VIRGIN; Q];
        advance(&samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
        let mut after = states;
        advance(&samples(&x0, &u).unwrap(), &material, &mut after).unwrap();
        assert!((0..Q).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
        let flowing = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
            element(x0, u, Medium { states: &states, ..medium }, want, out)
        };
        let error = tangent_error(flowing, &x0, &u, &material, 5e-5);
        assert!(error < 1e-7, "{error}");
    }
}

/// Rigid motion leaves six modes and no others without stiffness; it turns forces, which balance.
#[test]
fn rigid_motion_gives_no_force_and_nothing_else_does_not() {
    check_rigid_motion(WEDGES, 43);
    check_rigid_motion(PYRAMIDS, 53);
    check_rigid_motion(QUADRATIC, 63);
}

fn check_rigid_motion<const N: usize, const Q: usize, const D: usize>((all, case): Family<N, Q, D>, seed: u64) {
    let mut random = Random::new(seed);
    let both = || all.iter().zip([false, true]);
    for (material, ((element, _), is_mean)) in materials().iter().flat_map(|m| both().map(move |one| (m, one))) {
        let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
        let (x0, u) = case(&mut random);
        let rigid = matrices(*element, &x0, &affine(&x0, &r, shift), material);
        let stiffness = rigid.tangent.as_flattened().iter().fold(0f64, |m, k| m.max(k.abs()));
        assert!(rigid.residual.iter().all(|f| f.abs() < 1e-14 * stiffness));
        let mut modes: Vec<f64> = nalgebra::DMatrix::from_fn(D, D, |i, j| rigid.tangent[i][j])
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect();
        modes.sort_by(f64::total_cmp);
        // The quadratic conformal displacements change the volume alone, of which an element with one change of volume sees the mean.
        let soft = if N == 18 && is_mean { 3 } else { 0 };
        let least = 1e-2 * material.initial_moduli().1 / stiffness;
        assert!(modes[5].abs() < 1e-13 * stiffness && modes[6] > 0.0 && modes[6 + soft] > least);
        let x = add(&x0, &u);
        let after = add(&u, &affine(&x, &r, shift));
        let (a, b) = (matrices(*element, &x0, &u, material), matrices(*element, &x0, &after, material));
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for n in 0..N {
            let f = Vec3::from_column_slice(&a.residual[3 * n..3 * n + 3]);
            (0..3).for_each(|i| assert!(((r * f)[i] - b.residual[3 * n + i]).abs() < 1e-13 * stiffness));
            force += f;
            moment += Vec3::from(x[n]).cross(&f);
        }
        assert!(force.norm() < 1e-14 * stiffness && moment.norm() < 1e-14 * stiffness);
    }
}
