//! 5-node pyramid: bilinear over its base, linear along the rays from there to its apex; 2 x 2 x 2 integration points.
//!
//! Nodes in the order of Gmsh, Abaqus and VTK: a quadrilateral counter-clockwise seen from inside the element, then the apex. With
//! the share t of the way from the apex to the base, and p and r between -t and t,
//!
//! ```text
//! N_a = (t + p_a p) (t + r_a r) / 4t,   p_a, r_a = -1 or 1,   a < 4;      N_4 = 1 - t
//! ```
//!
//! (G. Bedrosian, IJNME 35 (1992) 95-108): on the base the bilinear functions of [`super::hex8`], on the triangles those of
//! [`super::tet4`], so that all fit together. With p = t xi, r = t eta and t = (1 - zeta)/2 these are the functions of a hexahedron whose
//! upper corners are one node; the integration points are the Gauss points of that.
//!
//! Leads from hexahedra to tetrahedra; locks in volume when nearly incompressible: see [`super::pyramid5_sri`].

use super::{
    ElementMatrices, Gradients, Inverted, Medium, Point, Sample, deform, hex8, integrate, jacobian, parameters,
};
use crate::Vec3;

/// Integration points.
pub const POINTS: usize = hex8::POINTS;

/// p and r of the nodes of the base, where t = 1.
const BASE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Values or derivatives of the functions of a hexahedron whose upper corners are one node.
const fn collapse(of_hex: [f64; 8]) -> [f64; 5] {
    let [a, b, c, d, e, f, g, h] = of_hex;
    [a, b, c, d, e + f + g + h]
}

/// Shape functions at the integration points.
pub const VALUES: [[f64; 5]; POINTS] = {
    let (mut values, mut q) = ([[0.0; 5]; POINTS], 0);
    while q < POINTS {
        values[q] = collapse(hex8::VALUES[q]);
        q += 1;
    }
    values
};

/// Derivatives at the integration points, by xi, eta and zeta.
const GRADIENTS: [Gradients<5>; POINTS] = {
    let (mut gradients, mut q) = ([[[0.0; 5]; 3]; POINTS], 0);
    while q < POINTS {
        let [by_xi, by_eta, by_zeta] = hex8::GRADIENTS[q];
        gradients[q] = [collapse(by_xi), collapse(by_eta), collapse(by_zeta)];
        q += 1;
    }
    gradients
};

/// What the values at the integration points, each times its number here, give at each node: trilinear in xi, eta and zeta, at the
/// apex in the mean.
pub const AT_NODES: [[f64; POINTS]; 5] = {
    let (mut values, mut q) = ([[0.0; POINTS]; 5], 0);
    while q < POINTS {
        let (mut a, mut apex) = (0, 0.0);
        while a < 4 {
            values[a][q] = hex8::AT_NODES[a][q];
            apex += 0.25 * hex8::AT_NODES[a + 4][q];
            a += 1;
        }
        values[4][q] = apex;
        q += 1;
    }
    values
};

/// Shape functions and their derivatives by p, r and t; the functions at the apex are those of the base's middle.
pub fn shape(p: f64, r: f64, t: f64) -> ([f64; 5], Gradients<5>) {
    let [p_over, r_over] = [p, r].map(|along| if t == 0.0 { 0.0 } else { along / t });
    let (mut values, mut gradients) = ([0.0; 5], [[0.0; 5]; 3]);
    for (a, [sp, sr]) in BASE.into_iter().enumerate() {
        values[a] = 0.25 * (t + sp * p) * (1.0 + sr * r_over);
        gradients[0][a] = 0.25 * sp * (1.0 + sr * r_over);
        gradients[1][a] = 0.25 * sr * (1.0 + sp * p_over);
        gradients[2][a] = 0.25 * (1.0 - sp * sr * p_over * r_over);
    }
    (values[4], gradients[2][4]) = (1.0 - t, -1.0);
    (values, gradients)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 5],
    u: &[[f64; 3]; 5],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<15>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 5], u: &[[f64; 3]; 5]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; 5]) -> f64 {
    GRADIENTS.iter().map(|gradients| jacobian(x, gradients).determinant()).sum()
}

/// Smallest Jacobian over the integration points; positive in every element that can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; 5]) -> f64 {
    GRADIENTS.iter().map(|gradients| jacobian(x, gradients).determinant()).fold(f64::INFINITY, f64::min)
}

/// Jacobians by p, r and t at the nodes of the base: the same along each edge from there to the apex. An element that is not
/// positive at one is folded over there, and lies on itself.
pub fn nodal_jacobians(x: &[[f64; 3]; 5]) -> [f64; 4] {
    // t runs from the apex down.
    BASE.map(|[p, r]| -jacobian(x, &shape(p, r, 1.0).1).determinant())
}

/// p, r and t of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near the element.
pub fn parameters(x: &[[f64; 3]; 5], point: &Vec3) -> Option<[f64; 3]> {
    parameters::find(x, point, [0.0, 0.0, 0.5], |[p, r, t]| shape(p, r, t))
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; 5], per_volume: Vec3) -> [f64; 15] {
    let mut force = [0.0; 15];
    for (values, gradients) in VALUES.iter().zip(&GRADIENTS) {
        let weight = jacobian(x0, gradients).determinant();
        for a in 0..5 {
            (0..3).for_each(|i| force[3 * a + i] += weight * values[a] * per_volume[i]);
        }
    }
    force
}

#[inline(always)]
pub(super) fn points(x0: &[[f64; 3]; 5], u: &[[f64; 3]; 5]) -> Result<[Point<5>; POINTS], Inverted> {
    deform(x0, u, &GRADIENTS, 1.0, 0.0)
}
