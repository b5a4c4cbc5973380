//! 18-node wedge: quadratic over triangles, times quadratic between them; 6 x 3 integration points.
//!
//! Nodes 0 to 5 are those of [`super::wedge6`], the others stand in the middles of its edges and of its quadrilaterals, in the order
//! of [`crate::mesh::faces`]: on these the functions of [`super::hex27`], so that both fit together. Edges and faces may be curved.
//! The six points in the triangle are exact for polynomials of four degrees, as the three between the triangles are for five.
//!
//! Bends exactly, and locks in volume when nearly incompressible, less than [`super::wedge6`]: see [`super::wedge18_sri`].

use super::hex27::{FAR, along};
use super::{ElementMatrices, Gradients, Inverted, Medium, Point, Sample, deform, integrate, jacobian, parameters};
use crate::solid::load::{TRI6, tri6};
use crate::{Mat3, Vec3};
use nalgebra::Matrix6;
use std::sync::LazyLock;

/// Integration points.
pub const POINTS: usize = 18;

/// Nodes.
const N: usize = 18;

/// Of each node that in the quadratic triangle, and how far up it is.
const NODES: [(usize, f64); N] = {
    let (mut nodes, mut k) = ([(0, 0.0); N], 0);
    while k < 3 {
        (nodes[k], nodes[3 + k], nodes[12 + k]) = ((k, -1.0), (k, 1.0), (k, 0.0));
        (nodes[6 + k], nodes[9 + k], nodes[15 + k]) = ((3 + k, -1.0), (3 + k, 1.0), (3 + k, 0.0));
        k += 1;
    }
    nodes
};

/// Parameters of the nodes of the triangle.
const IN_TRIANGLE: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];

/// Shape functions, their derivatives and weights at the integration points, six in each of three layers.
const RULE: [([f64; N], Gradients<N>, f64); POINTS] = {
    const LAYERS: [(f64, f64); 3] = [(-FAR, 5.0 / 9.0), (0.0, 8.0 / 9.0), (FAR, 5.0 / 9.0)];
    let (mut rule, mut q) = ([([0.0; N], [[0.0; N]; 3], 0.0); POINTS], 0);
    while q < POINTS {
        let (point, (zeta, weight)) = (&TRI6[q % 6], LAYERS[q / 6]);
        let (values, gradients) = product(&point.values, &point.gradients, zeta);
        rule[q] = (values, gradients, point.weight * weight);
        q += 1;
    }
    rule
};

/// Shape functions at the integration points.
pub static VALUES: [[f64; N]; POINTS] = {
    let (mut values, mut q) = ([[0.0; N]; POINTS], 0);
    while q < POINTS {
        values[q] = RULE[q].0;
        q += 1;
    }
    values
};

/// Derivatives there.
static GRADIENTS: [Gradients<N>; POINTS] = {
    let (mut gradients, mut q) = ([[[0.0; N]; 3]; POINTS], 0);
    while q < POINTS {
        gradients[q] = RULE[q].1;
        q += 1;
    }
    gradients
};

/// Derivatives at the nodes.
static NODAL_GRADIENTS: [Gradients<N>; N] = {
    let (mut gradients, mut a) = ([[[0.0; N]; 3]; N], 0);
    while a < N {
        let (k, zeta) = NODES[a];
        gradients[a] = shape([IN_TRIANGLE[k][0], IN_TRIANGLE[k][1], zeta]).1;
        a += 1;
    }
    gradients
};

/// What the values at the integration points, each times its number here, give at each node: the functions of the element.
pub static AT_NODES: LazyLock<[[f64; POINTS]; N]> = LazyLock::new(|| {
    let in_triangle = Matrix6::from_fn(|q, k| TRI6[q].values[k]).try_inverse().unwrap_or_default();
    std::array::from_fn(|a| {
        let (k, up) = NODES[a];
        std::array::from_fn(|q| in_triangle[(k, q % 6)] * along((q / 6) as f64 - 1.0, up / FAR)[0])
    })
});

/// Shape functions and their derivatives by the parameters.
pub const fn shape([xi, eta, zeta]: [f64; 3]) -> ([f64; N], Gradients<N>) {
    let in_triangle = tri6([1.0 - xi - eta, xi, eta], 0.0);
    product(&in_triangle.values, &in_triangle.gradients, zeta)
}

/// Those of the triangle times those between the triangles.
const fn product(values: &[f64; 6], by: &[[f64; 6]; 2], zeta: f64) -> ([f64; N], Gradients<N>) {
    let (mut all, mut gradients, mut a) = ([0.0; N], [[0.0; N]; 3], 0);
    while a < N {
        let (k, up) = NODES[a];
        let [share, slope] = along(up, zeta);
        all[a] = values[k] * share;
        gradients[0][a] = by[0][k] * share;
        gradients[1][a] = by[1][k] * share;
        gradients[2][a] = values[k] * slope;
        a += 1;
    }
    (all, gradients)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<54>,
) -> Result<(), Inverted> {
    integrate(&points(x0, u)?, None, medium, want_tangent, out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> Result<[Sample; POINTS], Inverted> {
    Ok(points(x0, u)?.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; N]) -> f64 {
    RULE.iter().map(|(_, gradients, weight)| weight * jacobian(x, gradients).determinant()).sum()
}

/// Smallest Jacobian over the integration points; positive in every element that can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; N]) -> f64 {
    GRADIENTS.iter().map(|gradients| 2.0 * jacobian(x, gradients).determinant()).fold(f64::INFINITY, f64::min)
}

/// Jacobians at the nodes: an element that is not positive at one is folded over there, and lies on itself.
pub fn nodal_jacobians(x: &[[f64; 3]; N]) -> [f64; N] {
    NODAL_GRADIENTS.each_ref().map(|gradients| 2.0 * jacobian(x, gradients).determinant())
}

/// Derivatives of the position by the parameters, its columns, at the integration points and the nodes.
pub fn frames(x: &[[f64; 3]; N]) -> impl Iterator<Item = Mat3> {
    GRADIENTS.iter().chain(&NODAL_GRADIENTS).map(|gradients| jacobian(x, gradients))
}

/// Parameters of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near the element.
pub fn parameters(x: &[[f64; 3]; N], point: &Vec3) -> Option<[f64; 3]> {
    parameters::find(x, point, [1.0 / 3.0, 1.0 / 3.0, 0.0], shape)
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; N], per_volume: Vec3) -> [f64; 54] {
    let mut force = [0.0; 54];
    for (values, gradients, weight) in &RULE {
        let volume = weight * jacobian(x0, gradients).determinant();
        for a in 0..N {
            (0..3).for_each(|i| force[3 * a + i] += volume * values[a] * per_volume[i]);
        }
    }
    force
}

#[inline(always)]
pub(super) fn points(x0: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> Result<[Point<N>; POINTS], Inverted> {
    let mut points = deform(x0, u, &GRADIENTS, 1.0, 0.0)?;
    points.iter_mut().zip(&RULE).for_each(|(point, (.., weight))| point.weight *= weight);
    Ok(points)
}
