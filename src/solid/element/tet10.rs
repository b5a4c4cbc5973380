//! 10-node tetrahedron: quadratic displacements, four integration points.
//!
//! Nodes 0 to 3 are those of [`super::tet4`], the others stand in the middles of the edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3, the order
//! of Abaqus and VTK. With barycentric coordinates b, N_a = b_a (2 b_a - 1) at corners and N_ab = 4 b_a b_b on edges. The
//! rule of four points is exact for quadratic polynomials, so that straight elements integrate exactly what is linear in
//! strain and stress. Edges may be curved. Locks in volume when nearly incompressible, less than [`super::tet4`]: see
//! [`super::tet10_sri`].

use super::{
    ElementMatrices, Gradients, Inverted, Medium, Point, Sample, deform, integrate, jacobian, parameters, tet4,
};
use crate::Vec3;

/// Integration points.
pub const POINTS: usize = 4;

/// Volume of the parent tetrahedron over the number of points.
const WEIGHT: f64 = 1.0 / 24.0;

/// Ends of the edges that nodes 4 to 9 stand on.
const EDGES: [[usize; 2]; 6] = crate::mesh::faces::TET_EDGES;

/// Barycentric coordinates of the points: (5 - sqrt 5) / 20, but (5 + 3 sqrt 5) / 20 of one corner each.
pub const RULE: [[f64; 4]; POINTS] = {
    const FAR: f64 = 0.138_196_601_125_010_5;
    let mut points = [[FAR; 4]; POINTS];
    let mut q = 0;
    while q < POINTS {
        points[q][q] = 1.0 - 3.0 * FAR;
        q += 1;
    }
    points
};

/// Shape functions at the integration points.
pub const VALUES: [[f64; 10]; POINTS] = [shape(&RULE[0]), shape(&RULE[1]), shape(&RULE[2]), shape(&RULE[3])];

/// Derivatives at the integration points.
const GRADIENTS: [Gradients<10>; POINTS] =
    [gradients(&RULE[0]), gradients(&RULE[1]), gradients(&RULE[2]), gradients(&RULE[3])];

/// Derivatives of barycentric coordinates by the parameters, which are the last three of them.
const BARYCENTRIC: Gradients<4> = [[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 1.0]];

/// What the values at the integration points, each times its number here, give at each node: linear.
pub const AT_NODES: [[f64; POINTS]; 10] = {
    // Values v at the points belong to the corner values c with v = M c, M_qk = FAR + (1 - 4 FAR) d_qk; rows of M add up to one.
    let near = 1.0 / (RULE[0][0] - RULE[0][1]);
    let far = RULE[0][1] * near;
    let (mut values, mut a) = ([[-far; POINTS]; 10], 0);
    while a < 4 {
        values[a][a] += near;
        a += 1;
    }
    while a < 10 {
        let [i, j] = EDGES[a - 4];
        values[a][i] += 0.5 * near;
        values[a][j] += 0.5 * near;
        a += 1;
    }
    values
};

/// Shape functions at barycentric coordinates.
pub const fn shape(b: &[f64; 4]) -> [f64; 10] {
    let (mut values, mut a) = ([0.0; 10], 0);
    while a < 4 {
        values[a] = b[a] * (2.0 * b[a] - 1.0);
        a += 1;
    }
    while a < 10 {
        let [i, j] = EDGES[a - 4];
        values[a] = 4.0 * b[i] * b[j];
        a += 1;
    }
    values
}

/// Their derivatives by the parameters.
pub const fn gradients(b: &[f64; 4]) -> Gradients<10> {
    let (mut gradients, mut m) = ([[0.0; 10]; 3], 0);
    while m < 3 {
        let by = BARYCENTRIC[m];
        let mut a = 0;
        while a < 4 {
            gradients[m][a] = (4.0 * b[a] - 1.0) * by[a];
            a += 1;
        }
        while a < 10 {
            let [i, j] = EDGES[a - 4];
            gradients[m][a] = 4.0 * (b[i] * by[j] + b[j] * by[i]);
            a += 1;
        }
        m += 1;
    }
    gradients
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 10],
    u: &[[f64; 3]; 10],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<30>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 10], u: &[[f64; 3]; 10]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; 10]) -> f64 {
    GRADIENTS.iter().map(|gradients| WEIGHT * jacobian(x, gradients).determinant()).sum()
}

/// Smallest Jacobian over the integration points; positive in every element that can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; 10]) -> f64 {
    GRADIENTS.iter().map(|gradients| jacobian(x, gradients).determinant()).fold(f64::INFINITY, f64::min)
}

/// Barycentric coordinates of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near
/// the element.
pub fn parameters(x: &[[f64; 3]; 10], point: &Vec3) -> Option<[f64; 4]> {
    let [_, start @ ..] = tet4::shape(&std::array::from_fn(|a| x[a]), point)?;
    let barycentric = |[xi, eta, zeta]: [f64; 3]| [1.0 - xi - eta - zeta, xi, eta, zeta];
    let found = parameters::find(x, point, start, |at| (shape(&barycentric(at)), gradients(&barycentric(at))));
    found.map(barycentric)
}

/// Consistent nodal forces of a force per reference volume: none, or against it, at the corners of a straight element.
pub fn body_force(x0: &[[f64; 3]; 10], per_volume: Vec3) -> [f64; 30] {
    let mut force = [0.0; 30];
    for (values, gradients) in VALUES.iter().zip(&GRADIENTS) {
        let weight = WEIGHT * jacobian(x0, gradients).determinant();
        for a in 0..10 {
            (0..3).for_each(|i| force[3 * a + i] += weight * values[a] * per_volume[i]);
        }
    }
    force
}

#[inline(always)]
pub(super) fn points(x0: &[[f64; 3]; 10], u: &[[f64; 3]; 10]) -> Result<[Point<10>; POINTS], Inverted> {
    deform(x0, u, &GRADIENTS, WEIGHT, 0.0)
}
