//! Plane strain at the cost of two dimensions: a hexahedron of one layer, extruded along z, whose two z-planes move as one
//! with u_z = 0.
//!
//! The lower four nodes carry it. In such a hexahedron the integration points lie in pairs above one another and see the
//! same F, so 2x2 points of the full thickness are exactly [`super::hex8`], or another of the hexahedra, with the forces of
//! nodes above one another added up; forces and stiffnesses along z are left out. Of the modes of [`super::hex8_eas`] those
//! that vary along z, or shear along it, are zero by symmetry.

use super::Formulation;
use super::enhanced::{self, Modes, Rule, VOLUME};
use super::hex8_sri::{self, use_mean_volume};
use super::{ElementMatrices, GAUSS, Gradients, Inverted, Medium, Point, Sample, deform, integrate, use_volume_of};

/// Integration points.
pub const POINTS: usize = 4;

/// Parameters of the nodes, counter-clockwise seen from +z.
const NODES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Derivatives of N_a = (1 + xi_a xi)(1 + eta_a eta) / 4; nothing varies along z.
const fn gradients(xi: f64, eta: f64) -> Gradients<4> {
    let mut gradients = [[0.0; 4]; 3];
    let mut a = 0;
    while a < 4 {
        let [n0, n1] = NODES[a];
        gradients[0][a] = 0.25 * n0 * (1.0 + n1 * eta);
        gradients[1][a] = 0.25 * (1.0 + n0 * xi) * n1;
        a += 1;
    }
    gradients
}

/// Derivatives at the Gauss points, all of weight 1.
const GAUSS_POINTS: [Gradients<4>; POINTS] = {
    let mut points = [[[0.0; 4]; 3]; 4];
    let mut q = 0;
    while q < 4 {
        points[q] = gradients(GAUSS * NODES[q][0], GAUSS * NODES[q][1]);
        q += 1;
    }
    points
};

/// Derivatives at the centre.
const CENTRE: Gradients<4> = gradients(0.0, 0.0);

/// The five of the modes of [`super::hex8_eas`] that do not vanish.
const MODES: Modes<5, POINTS> = {
    let mut modes = Modes { components: [0, 1, 3, 4, VOLUME], amplitudes: [[0.0; 5]; POINTS] };
    let mut q = 0;
    while q < POINTS {
        let [xi, eta] = NODES[q];
        modes.amplitudes[q] = [xi, xi, eta, eta, xi * eta];
        q += 1;
    }
    modes
};

/// Internal forces and, if `want_tangent`, the tangent of the layer with lower reference nodes `x0` displaced by `u`, whose
/// z do not count, and with the given thickness. `out.tangent` keeps its old entries otherwise; after an error `out` is
/// undefined.
pub fn evaluate(
    nodes: (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    thickness: f64,
    medium: Medium,
    (want_tangent, element): (bool, Formulation),
    out: &mut ElementMatrices<12>,
) -> Result<(), Inverted> {
    let (x0, u) = flat(nodes);
    match element {
        Formulation::Hex8Eas => enhanced::evaluate(&x0, &u, &rule(thickness), &MODES, (medium, want_tangent), out),
        Formulation::Hex8Sri => hex8_sri::integrate(&mut points(&x0, &u, thickness)?, medium, want_tangent, out),
        Formulation::Hex8Fbar => {
            let mut points = points(&x0, &u, thickness)?;
            let centre = centre(&x0, &u, thickness)?;
            use_volume_of(&centre, &mut points);
            integrate(&points, Some(&centre.gradients), medium, want_tangent, out)
        }
        _ => integrate(&points(&x0, &u, thickness)?, None, medium, want_tangent, out),
    }
}

/// The integration points.
pub fn samples(
    nodes: (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    thickness: f64,
    medium: Medium,
    element: Formulation,
) -> Result<[Sample; POINTS], Inverted> {
    let (x0, u) = flat(nodes);
    if element == Formulation::Hex8Eas {
        return enhanced::samples(&x0, &u, &rule(thickness), &MODES, medium);
    }
    let mut points = points(&x0, &u, thickness)?;
    match element {
        Formulation::Hex8Fbar => use_volume_of(&centre(&x0, &u, thickness)?, &mut points),
        Formulation::Hex8Sri => use_mean_volume(&mut points),
        _ => {}
    }
    Ok(points.map(|point| point.sample()))
}

fn flat((x0, u): (&[[f64; 3]; 4], &[[f64; 3]; 4])) -> ([[f64; 3]; 4], [[f64; 3]; 4]) {
    let flat = |nodes: &[[f64; 3]; 4]| nodes.map(|[x, y, _]| [x, y, 0.0]);
    (flat(x0), flat(u))
}

fn rule(thickness: f64) -> Rule<'static, 4, POINTS> {
    Rule { gradients: &GAUSS_POINTS, centre: &CENTRE, depth: thickness }
}

#[inline(always)]
fn points(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4], thickness: f64) -> Result<[Point<4>; POINTS], Inverted> {
    deform(x0, u, &GAUSS_POINTS, 1.0, thickness)
}

#[inline(always)]
fn centre(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4], thickness: f64) -> Result<Point<4>, Inverted> {
    deform(x0, u, &[CENTRE], 4.0, thickness).map(|[centre]| centre)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::element::{average_stress, hex8, hex8_eas, hex8_fbar};
    use crate::solid::material::Material;
    use crate::solid::material::MaterialModel;

    type Hex = fn(&[[f64; 3]; 8], &[[f64; 3]; 8], Medium, bool, &mut ElementMatrices<24>) -> Result<(), Inverted>;

    /// Forces and stiffnesses of the hexahedron, folded onto its lower nodes, without z.
    fn folded(hex: &ElementMatrices<24>) -> ([f64; 8], [[f64; 8]; 8]) {
        let place = |k: usize| (k % 3 < 2).then_some(2 * (k / 3 % 4) + k % 3);
        let (mut force, mut stiffness) = ([0.0; 8], [[0.0; 8]; 8]);
        for r in 0..24 {
            let Some(row) = place(r) else { continue };
            force[row] += hex.residual[r];
            for c in 0..24 {
                let Some(column) = place(c) else { continue };
                stiffness[row][column] += hex.tangent[r][c];
            }
        }
        (force, stiffness)
    }

    #[test]
    fn it_is_the_hexahedron_with_its_planes_tied() {
        let x0 = [[0.0, 0.0, 5.0], [1.3, 0.1, 5.0], [1.1, 0.9, 5.0], [-0.2, 1.2, 5.0]];
        let u = [[0.05, 0.02, 0.0], [-0.1, 0.07, 0.0], [0.12, -0.2, 0.0], [0.03, 0.04, 0.0]];
        let thickness = 0.7;
        let up = |k: usize, nodes: &[[f64; 3]; 4], by: f64| {
            let [x, y, z] = nodes[k % 4];
            [x, y, if k < 4 { z } else { z + by }]
        };
        let solid = std::array::from_fn(|k| up(k, &x0, thickness));
        let moved = std::array::from_fn(|k| up(k, &u, 0.0));
        for model in
            [MaterialModel::NeoHookean { young: 3.0, poisson: 0.3 }, MaterialModel::Hooke { young: 3.0, poisson: 0.45 }]
        {
            let material = Material::new(&model);
            let hexes: [(Formulation, Hex); 4] = [
                (Formulation::Hex8, hex8::evaluate),
                (Formulation::Hex8Fbar, hex8_fbar::evaluate),
                (Formulation::Hex8Sri, hex8_sri::evaluate),
                (Formulation::Hex8Eas, hex8_eas::evaluate),
            ];
            for (element, of_hex) in hexes {
                let (mut plane, mut hex) = (ElementMatrices::<12>::default(), ElementMatrices::<24>::default());
                evaluate((&x0, &u), thickness, Medium::virgin(&material), (true, element), &mut plane).unwrap();
                of_hex(&solid, &moved, Medium::virgin(&material), true, &mut hex).unwrap();
                let (force, stiffness) = folded(&hex);
                for r in 0..8 {
                    let row = 3 * (r / 2) + r % 2;
                    assert!((plane.residual[row] - force[r]).abs() < 1e-14, "{model:?} {element:?}");
                    for c in 0..8 {
                        let column = 3 * (c / 2) + c % 2;
                        assert!((plane.tangent[row][column] - stiffness[r][c]).abs() < 2e-14, "{model:?} {element:?}");
                    }
                }
                let samples = samples((&x0, &u), thickness, Medium::virgin(&material), element).unwrap();
                let mut mean = average_stress(&samples, Medium::virgin(&material)).unwrap();
                let virial = |i: usize, j: usize| -> f64 {
                    (0..4).map(|a| plane.residual[3 * a + i] * (x0[a][j] + u[a][j])).sum::<f64>()
                };
                let volume: f64 = samples.iter().map(Sample::volume).sum();
                mean.iter_mut().for_each(|s| *s *= volume);
                let found = [mean[0], mean[1], mean[3], mean[3]];
                for (a, b) in found.iter().zip([virial(0, 0), virial(1, 1), virial(0, 1), virial(1, 0)]) {
                    assert!((a - b).abs() < 1e-14, "{model:?} {element:?} {a} {b}");
                }
            }
        }
    }

    #[test]
    fn an_inverted_layer_is_an_error() {
        let x0 = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let u = [[0.0; 3], [0.0; 3], [-2.0, -2.0, 0.0], [0.0; 3]];
        let material = Material::new(&MaterialModel::NeoHookean { young: 3.0, poisson: 0.3 });
        let mut out = ElementMatrices::<12>::default();
        assert!(evaluate((&x0, &u), 1.0, Medium::virgin(&material), (true, Formulation::Hex8), &mut out).is_err());
    }
}
