//! Plane strain at the cost of two dimensions: a hexahedron of one layer, extruded along z, whose two z-planes move as one
//! with u_z = 0.
//!
//! The lower four nodes carry it. In such a hexahedron the integration points lie in pairs above one another and see the
//! same F, so 2x2 points of the full thickness are exactly [`super::hex8`] (or [`super::hex8_fbar`]) with the forces of
//! nodes above one another added up; forces and stiffnesses along z are left out.

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
const GAUSS_POINTS: [Gradients<4>; 4] = {
    let mut points = [[[0.0; 4]; 3]; 4];
    let mut q = 0;
    while q < 4 {
        points[q] = gradients(GAUSS * NODES[q][0], GAUSS * NODES[q][1]);
        q += 1;
    }
    points
};

/// Internal forces and, if `want_tangent`, the tangent of the layer with lower reference nodes `x0` displaced by `u`, whose
/// z do not count, and with the given thickness; with F-bar if `f_bar`. `out.tangent` keeps its old entries otherwise; after
/// an error `out` is undefined.
pub fn evaluate(
    nodes: (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    thickness: f64,
    medium: Medium,
    (want_tangent, f_bar): (bool, bool),
    out: &mut ElementMatrices<12>,
) -> Result<(), Inverted> {
    let (points, centre) = points(nodes, thickness, f_bar)?;
    integrate(&points, centre.as_ref(), medium, want_tangent, out)
}

/// The integration points.
pub fn samples(
    nodes: (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    thickness: f64,
    f_bar: bool,
) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(nodes, thickness, f_bar)?.0.map(|point| point.sample()))
}

/// Integration points and, with F-bar, the gradients at the centre.
#[inline(always)]
fn points(
    (x0, u): (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    thickness: f64,
    f_bar: bool,
) -> Result<([Point<4>; POINTS], Option<Gradients<4>>), Inverted> {
    let flat = |nodes: &[[f64; 3]; 4]| nodes.map(|[x, y, _]| [x, y, 0.0]);
    let (x0, u) = (flat(x0), flat(u));
    let mut points = deform(&x0, &u, &GAUSS_POINTS, 1.0, thickness)?;
    if !f_bar {
        return Ok((points, None));
    }
    let [centre] = deform(&x0, &u, &[gradients(0.0, 0.0)], 4.0, thickness)?;
    use_volume_of(&centre, &mut points);
    Ok((points, Some(centre.gradients)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MaterialModel;
    use crate::solid::element::{hex8, hex8_fbar};
    use crate::solid::material::Material;

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
            for f_bar in [false, true] {
                let (mut plane, mut hex) = (ElementMatrices::<12>::default(), ElementMatrices::<24>::default());
                evaluate((&x0, &u), thickness, Medium::virgin(&material), (true, f_bar), &mut plane).unwrap();
                let of_hex = if f_bar { hex8_fbar::evaluate } else { hex8::evaluate };
                of_hex(&solid, &moved, Medium::virgin(&material), true, &mut hex).unwrap();
                let (force, stiffness) = folded(&hex);
                for r in 0..8 {
                    let row = 3 * (r / 2) + r % 2;
                    assert!((plane.residual[row] - force[r]).abs() < 1e-14, "{model:?} {f_bar}");
                    for c in 0..8 {
                        let column = 3 * (c / 2) + c % 2;
                        assert!((plane.tangent[row][column] - stiffness[r][c]).abs() < 2e-14, "{model:?} {f_bar}");
                    }
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
        assert!(evaluate((&x0, &u), 1.0, Medium::virgin(&material), (true, false), &mut out).is_err());
    }
}
