//! 8-node hexahedron, full 2x2x2 integration.
//!
//! Nodes in the order of Gmsh and Abaqus: bottom face counter-clockwise seen from inside the element, then the top
//! face. N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta) / 8. Locks in volume when nearly incompressible: see
//! [`super::hex8_fbar`].

use super::{
    ElementMatrices, GAUSS, Gradients, Inverted, Medium, Point, Sample, deform, integrate, jacobian, parameters,
};
use crate::Vec3;

/// Integration points.
pub const POINTS: usize = 8;

/// Parameters of the nodes.
pub(super) const NODES: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Shape functions and their derivatives at the Gauss points, which stand at [`GAUSS`] times the nodes' parameters.
const RULE: [([f64; 8], Gradients<8>); 8] = {
    let mut rule = [([0.0; 8], [[0.0; 8]; 3]); 8];
    let mut q = 0;
    while q < 8 {
        rule[q] = shape(GAUSS * NODES[q][0], GAUSS * NODES[q][1], GAUSS * NODES[q][2]);
        q += 1;
    }
    rule
};

/// Shape functions at the Gauss points.
pub const VALUES: [[f64; 8]; 8] = {
    let mut values = [[0.0; 8]; 8];
    let mut q = 0;
    while q < 8 {
        values[q] = RULE[q].0;
        q += 1;
    }
    values
};

/// What the values at the Gauss points, each times its number here, give at each node: trilinear.
pub const AT_NODES: [[f64; 8]; 8] = {
    let (mut values, mut a) = ([[0.0; 8]; 8], 0);
    while a < 8 {
        // The points stand at the corners of a cube that is smaller by GAUSS.
        values[a] = shape(NODES[a][0] / GAUSS, NODES[a][1] / GAUSS, NODES[a][2] / GAUSS).0;
        a += 1;
    }
    values
};

/// Derivatives at the Gauss points.
pub(super) const GRADIENTS: [Gradients<8>; 8] = {
    let mut gradients = [[[0.0; 8]; 3]; 8];
    let mut q = 0;
    while q < 8 {
        gradients[q] = RULE[q].1;
        q += 1;
    }
    gradients
};

/// Derivatives at the centre.
pub(super) const CENTRE: Gradients<8> = shape(0.0, 0.0, 0.0).1;

/// Shape functions and their derivatives by the parameters.
pub const fn shape(xi: f64, eta: f64, zeta: f64) -> ([f64; 8], Gradients<8>) {
    let (mut values, mut gradients) = ([0.0; 8], [[0.0; 8]; 3]);
    let mut a = 0;
    while a < 8 {
        let [n0, n1, n2] = NODES[a];
        let (r, s, t) = (1.0 + n0 * xi, 1.0 + n1 * eta, 1.0 + n2 * zeta);
        values[a] = 0.125 * r * s * t;
        gradients[0][a] = 0.125 * n0 * s * t;
        gradients[1][a] = 0.125 * r * n1 * t;
        gradients[2][a] = 0.125 * r * s * n2;
        a += 1;
    }
    (values, gradients)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; 8]) -> f64 {
    GRADIENTS.iter().map(|gradients| jacobian(x, gradients).determinant()).sum()
}

/// Smallest Jacobian over the integration points and the centre, scaled to be the volume of a parallelepiped; positive
/// in every element that can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; 8]) -> f64 {
    let jacobians = GRADIENTS.iter().chain([&CENTRE]).map(|gradients| 8.0 * jacobian(x, gradients).determinant());
    jacobians.fold(f64::INFINITY, f64::min)
}

/// Jacobians at the nodes: an element that is not positive at one is folded over there, and lies on itself.
pub fn nodal_jacobians(x: &[[f64; 3]; 8]) -> [f64; 8] {
    const GRADIENTS: [Gradients<8>; 8] = {
        let (mut gradients, mut a) = ([[[0.0; 8]; 3]; 8], 0);
        while a < 8 {
            gradients[a] = shape(NODES[a][0], NODES[a][1], NODES[a][2]).1;
            a += 1;
        }
        gradients
    };
    GRADIENTS.map(|gradients| jacobian(x, &gradients).determinant())
}

/// Parameters of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near the element.
pub fn parameters(x: &[[f64; 3]; 8], point: &Vec3) -> Option<[f64; 3]> {
    parameters::find(x, point, [0.0; 3], |[xi, eta, zeta]| shape(xi, eta, zeta))
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; 8], per_volume: Vec3) -> [f64; 24] {
    let mut force = [0.0; 24];
    for (values, gradients) in VALUES.iter().zip(&GRADIENTS) {
        let weight = jacobian(x0, gradients).determinant();
        for a in 0..8 {
            (0..3).for_each(|i| force[3 * a + i] += weight * values[a] * per_volume[i]);
        }
    }
    force
}

#[inline(always)]
pub(super) fn points(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<[Point<8>; POINTS], Inverted> {
    deform(x0, u, &GRADIENTS, 1.0, 0.0)
}

/// The centre as the one point of a reduced rule.
#[inline(always)]
pub(super) fn centre(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8]) -> Result<Point<8>, Inverted> {
    deform(x0, u, &[CENTRE], 8.0, 0.0).map(|[point]| point)
}
