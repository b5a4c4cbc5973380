//! 6-node wedge: linear over triangles, times linear between two of them; 3 x 2 integration points.
//!
//! Nodes in the order of Gmsh and Abaqus: a triangle counter-clockwise seen from inside the element, then the one above it.
//! With b = (1 - xi - eta, xi, eta), N_a = b_a (1 - zeta) / 2 below and N_a+3 = b_a (1 + zeta) / 2 above: on the
//! quadrilaterals the bilinear functions of [`super::hex8`], so that both fit together. The rule of three points in the triangle
//! is exact for quadratic polynomials; with one point nothing would resist that one triangle turns over the other.
//!
//! Fills meshes of hexahedra. Strain in the plane of the triangles is constant over each, so that it is stiffer than a
//! hexahedron where that plane bends; locks in volume when nearly incompressible: see [`super::wedge6_sri`].

use super::{
    ElementMatrices, GAUSS, Gradients, Inverted, Medium, Point, Sample, deform, integrate, jacobian, parameters,
};
use crate::Vec3;

/// Integration points.
pub const POINTS: usize = 6;

/// Area of the parent triangle over the number of points in it.
const WEIGHT: f64 = 1.0 / 6.0;

/// Barycentric coordinates of the points in the triangle: 1/6, but 2/3 of one corner each.
const IN_TRIANGLE: [[f64; 3]; 3] = around(2.0 / 3.0, 1.0 / 6.0);

/// What values at these points, each times its number here, give at the corners: linear. Values v at the points belong to the
/// corner values c with v = M c, M_qk = (1 + 3 d_qk) / 6.
const AT_CORNERS: [[f64; 3]; 3] = around(5.0 / 3.0, -1.0 / 3.0);

const fn around(near: f64, far: f64) -> [[f64; 3]; 3] {
    [[near, far, far], [far, near, far], [far, far, near]]
}

/// Shape functions and their derivatives at the integration points, of which point q is the one next to node q.
const RULE: [([f64; 6], Gradients<6>); POINTS] = {
    let mut rule = [([0.0; 6], [[0.0; 6]; 3]); POINTS];
    let mut q = 0;
    while q < POINTS {
        let [_, xi, eta] = IN_TRIANGLE[q % 3];
        rule[q] = shape(xi, eta, if q < 3 { -GAUSS } else { GAUSS });
        q += 1;
    }
    rule
};

/// Shape functions at the integration points.
pub const VALUES: [[f64; 6]; POINTS] = {
    let mut values = [[0.0; 6]; POINTS];
    let mut q = 0;
    while q < POINTS {
        values[q] = RULE[q].0;
        q += 1;
    }
    values
};

/// Derivatives at the integration points.
const GRADIENTS: [Gradients<6>; POINTS] = {
    let mut gradients = [[[0.0; 6]; 3]; POINTS];
    let mut q = 0;
    while q < POINTS {
        gradients[q] = RULE[q].1;
        q += 1;
    }
    gradients
};

/// What the values at the integration points, each times its number here, give at each node: linear times linear.
pub const AT_NODES: [[f64; POINTS]; 6] = {
    let (mut values, mut a) = ([[0.0; POINTS]; 6], 0);
    while a < 6 {
        let mut q = 0;
        while q < POINTS {
            let same = if a / 3 == q / 3 { 1.0 } else { -1.0 };
            values[a][q] = AT_CORNERS[a % 3][q % 3] * 0.5 * (1.0 + same / GAUSS);
            q += 1;
        }
        a += 1;
    }
    values
};

/// Shape functions and their derivatives by the parameters.
pub const fn shape(xi: f64, eta: f64, zeta: f64) -> ([f64; 6], Gradients<6>) {
    const BY: [[f64; 3]; 2] = [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]];
    let b = [1.0 - xi - eta, xi, eta];
    let (mut values, mut gradients) = ([0.0; 6], [[0.0; 6]; 3]);
    let mut a = 0;
    while a < 6 {
        let (k, side) = (a % 3, if a < 3 { -0.5 } else { 0.5 });
        let share = 0.5 + side * zeta;
        values[a] = b[k] * share;
        gradients[0][a] = BY[0][k] * share;
        gradients[1][a] = BY[1][k] * share;
        gradients[2][a] = b[k] * side;
        a += 1;
    }
    (values, gradients)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 6],
    u: &[[f64; 3]; 6],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<18>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 6], u: &[[f64; 3]; 6]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; 6]) -> f64 {
    GRADIENTS.iter().map(|gradients| WEIGHT * jacobian(x, gradients).determinant()).sum()
}

/// Smallest Jacobian over the integration points; positive in every element that can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; 6]) -> f64 {
    GRADIENTS.iter().map(|gradients| jacobian(x, gradients).determinant()).fold(f64::INFINITY, f64::min)
}

/// Jacobians at the nodes: an element that is not positive at one is folded over there, and lies on itself.
pub fn nodal_jacobians(x: &[[f64; 3]; 6]) -> [f64; 6] {
    const CORNERS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    std::array::from_fn(|a| {
        let [xi, eta] = CORNERS[a % 3];
        jacobian(x, &shape(xi, eta, if a < 3 { -1.0 } else { 1.0 }).1).determinant()
    })
}

/// Parameters of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near the element.
pub fn parameters(x: &[[f64; 3]; 6], point: &Vec3) -> Option<[f64; 3]> {
    parameters::find(x, point, [1.0 / 3.0, 1.0 / 3.0, 0.0], |[xi, eta, zeta]| shape(xi, eta, zeta))
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; 6], per_volume: Vec3) -> [f64; 18] {
    let mut force = [0.0; 18];
    for (values, gradients) in VALUES.iter().zip(&GRADIENTS) {
        let weight = WEIGHT * jacobian(x0, gradients).determinant();
        for a in 0..6 {
            (0..3).for_each(|i| force[3 * a + i] += weight * values[a] * per_volume[i]);
        }
    }
    force
}

#[inline(always)]
pub(super) fn points(x0: &[[f64; 3]; 6], u: &[[f64; 3]; 6]) -> Result<[Point<6>; POINTS], Inverted> {
    deform(x0, u, &GRADIENTS, WEIGHT, 0.0)
}
