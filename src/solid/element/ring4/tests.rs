//! Tests of [`super`].

use super::*;
use crate::solid::element::hex8;
use crate::solid::element::{advance, stored_energy};
use crate::solid::material::{Hardening, Material, MaterialModel, State};
use crate::solid::testing::{derivative, relative_error};

const X: [[f64; 3]; 4] = [[0.0, 0.1, 5.0], [1.3, 0.0, 5.0], [1.1, 0.9, 5.0], [0.0, 1.2, 5.0]];
const U: [[f64; 3]; 4] = [[0.0, 0.02, 0.0], [-0.1, 0.07, 0.0], [0.12, -0.1, 0.0], [0.0, 0.04, 0.0]];
const OUT: f64 = 0.7;
const KINDS: [Formulation; 3] = [Formulation::Hex8, Formulation::Hex8Fbar, Formulation::Hex8Sri];

fn ring(by: f64) -> [[f64; 3]; 4] {
    X.map(|[x, y, z]| [x + by, y, z])
}

fn materials() -> [MaterialModel; 3] {
    [
        MaterialModel::NeoHookean { young: 3.0, poisson: 0.3 },
        MaterialModel::Hooke { young: 3.0, poisson: 0.4999 },
        MaterialModel::Plastic {
            young: 3.0,
            poisson: 0.3,
            hill: None,
            hardening: Hardening::Linear { yield_stress: 0.05, modulus: 0.1 },
        },
    ]
}

fn forces(x: &[[f64; 3]; 4], u: &[[f64; 3]; 4], medium: Medium, element: Formulation) -> ElementMatrices<12> {
    let mut out = ElementMatrices::default();
    evaluate((x, u), medium, (true, element), &mut out).unwrap();
    out
}

/// On the axis, where the nodes do not move out, and beside it; with a state that has flown.
#[test]
fn tangents_are_derivatives_of_forces_and_these_of_the_energy() {
    for (model, x) in materials().iter().flat_map(|model| [(model, ring(0.0)), (model, ring(OUT))]) {
        let material = Material::new(model);
        for element in KINDS {
            let half = U.map(|u| u.map(|u| 0.5 * u));
            let mut states = [State::VIRGIN; POINTS];
            advance(&samples((&x, &half), element).unwrap(), &material, &mut states).unwrap();
            let medium = Medium { material: &material, states: &states, amplitudes: None };
            let out = forces(&x, &U, medium, element);
            let at = |column: usize, t: f64| {
                let mut u = U;
                u[column / 3][column % 3] += t;
                u
            };
            for column in (0..12).filter(|c| c % 3 == 1 || c % 3 == 0 && x[c / 3][0] > 0.0) {
                let differences = derivative(1e-3, |t| forces(&x, &at(column, t), medium, element).residual);
                let exact: [f64; 12] = std::array::from_fn(|row| out.tangent[row][column]);
                let error = relative_error(&exact, &differences);
                assert!(error < 1e-8, "{model:?} {element:?} {column}: {error}");
                if element != Formulation::Hex8Fbar && !material.remembers() {
                    let energy =
                        |t: f64| [stored_energy(&samples((&x, &at(column, t)), element).unwrap(), medium).unwrap()];
                    let [slope] = derivative(1e-3, energy);
                    let scale = out.residual.iter().fold(0.0f64, |most, r| most.max(r.abs()));
                    assert!((slope - out.residual[column]).abs() < 1e-10 * scale, "{model:?} {element:?} {column}");
                }
            }
        }
    }
}

/// A slice of a small angle of the ring, of flat hexahedra, has that part of its forces along y.
#[test]
fn it_is_a_ring_of_hexahedra() {
    let angle = 1e-4f64;
    let material = Material::new(&materials()[0]);
    let x = ring(OUT);
    let turned = |nodes: &[[f64; 3]; 4], k: usize| {
        let [r, y, _] = nodes[k % 4];
        let around = if k < 4 { -0.5 } else { 0.5 } * angle;
        [r * around.cos(), y, r * around.sin()]
    };
    let now: [[f64; 3]; 4] = std::array::from_fn(|a| std::array::from_fn(|i| x[a][i] + U[a][i]));
    let solid: [[f64; 3]; 8] = std::array::from_fn(|k| turned(&x, k));
    let moved: [[f64; 3]; 8] = std::array::from_fn(|k| {
        let to = turned(&now, k);
        std::array::from_fn(|i| to[i] - solid[k][i])
    });
    let mut hex = ElementMatrices::<24>::default();
    hex8::evaluate(&solid, &moved, Medium::virgin(&material), false, &mut hex).unwrap();
    let whole = forces(&x, &U, Medium::virgin(&material), Formulation::Hex8).residual;
    for a in 0..4 {
        let both = |k: usize| {
            let around = if k < 4 { -0.5 } else { 0.5 } * angle;
            [hex.residual[3 * k] * around.cos() + hex.residual[3 * k + 2] * around.sin(), hex.residual[3 * k + 1]]
        };
        for i in 0..2 {
            let of_slice = (both(a)[i] + both(a + 4)[i]) * TAU / angle;
            assert!((of_slice - whole[3 * a + i]).abs() < 1e-6 * whole[3 * a].abs(), "{a} {i}");
        }
    }
}

#[test]
fn a_body_force_is_that_of_the_volume_of_the_ring() {
    let forces = body_force(&[[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0], [1.0, 2.0, 0.0]], [0.5, -3.0]);
    let volume = TAU / 2.0 * (9.0 - 1.0) * 2.0;
    for (i, per_volume) in [0.5, -3.0].into_iter().enumerate() {
        let sum: f64 = forces.iter().map(|force| force[i]).sum();
        assert!((sum - per_volume * volume).abs() < 1e-13 * volume);
    }
}

#[test]
fn what_is_inside_out_or_beyond_the_axis_is_an_error() {
    let material = Material::new(&materials()[0]);
    let mut out = ElementMatrices::<12>::default();
    for u in [[[0.0; 3], [0.0; 3], [-2.0, -2.0, 0.0], [0.0; 3]], [[-0.01, 0.0, 0.0], [0.0; 3], [0.0; 3], [0.0; 3]]] {
        let medium = Medium::virgin(&material);
        let inverted = evaluate((&X, &u), medium, (true, Formulation::Hex8), &mut out).unwrap_err();
        assert!(inverted.det_f < 0.0);
    }
}
