//! 27-node hexahedron: quadratic displacements, pressures that are linear in the element and its own.
//!
//! Nodes 0 to 7 are those of [`super::hex8`], the others stand in the middles of its edges, of its faces, and of all, in the order of
//! [`crate::mesh::faces`]; N_a is the product of three of t (t - 1) / 2, 1 - t^2 and t (t + 1) / 2. Edges and faces may be curved.
//! There are 3x3x3 Gauss points.
//!
//! The equations are those of `mixed.rs` with the functions 1, xi, eta and zeta: quadratic displacements with discontinuous linear
//! pressures satisfy the inf-sup condition (Boffi, Brezzi and Fortin, Mixed Finite Element Methods and Applications, 8.6.3), so that
//! the element locks neither in volume nor in shear, and none of its pressures oscillates.

use super::mixed::{self, project};
use super::{ElementMatrices, Gradients, Inverted, Medium, Point, Sample, deform, jacobian, parameters};
use crate::mesh::faces::HEX_BETWEEN;
use crate::{Mat3, Vec3};

/// Integration points.
pub const POINTS: usize = 27;

/// Nodes.
const N: usize = 27;

/// Parameters of the nodes.
const NODES: [[f64; 3]; N] = {
    let (corners, mut nodes, mut k) = (super::hex8::NODES, [[0.0; 3]; N], 0);
    while k < 3 * N {
        let (a, d) = (k / 3, k % 3);
        nodes[a][d] = 0.5 * (corners[HEX_BETWEEN[a][0]][d] + corners[HEX_BETWEEN[a][1]][d]);
        k += 1;
    }
    nodes
};

/// Of three Gauss points, sqrt(3/5).
pub(super) const FAR: f64 = 0.774_596_669_241_483_4;

/// Parameters of the Gauss points: the nodes', nearer to the centre.
const AT: [[f64; 3]; POINTS] = scaled(FAR);

/// Their weights: of three points 5/9 at the ends and 8/9 in the middle.
const WEIGHTS: [f64; POINTS] = {
    let (mut weights, mut q) = ([1.0; POINTS], 0);
    while q < POINTS {
        let mut d = 0;
        while d < 3 {
            weights[q] *= if NODES[q][d] == 0.0 { 8.0 / 9.0 } else { 5.0 / 9.0 };
            d += 1;
        }
        q += 1;
    }
    weights
};

/// Shape functions at the Gauss points.
pub static VALUES: [[f64; N]; POINTS] = values(&AT);

/// Derivatives at the Gauss points.
static GRADIENTS: [Gradients<N>; POINTS] = gradients(&AT);

/// Derivatives at the nodes.
static NODAL_GRADIENTS: [Gradients<N>; N] = gradients(&NODES);

/// The functions that changes of volume, and pressures, are made of, at the Gauss points.
const PRESSURES: [[f64; 4]; POINTS] = {
    let (mut values, mut q) = ([[1.0; 4]; POINTS], 0);
    while q < POINTS {
        [_, values[q][1], values[q][2], values[q][3]] = [1.0, AT[q][0], AT[q][1], AT[q][2]];
        q += 1;
    }
    values
};

/// What the values at the Gauss points, each times its number here, give at each node: quadratic along each parameter. The points
/// stand at the nodes of an element that is smaller by `FAR`.
pub static AT_NODES: [[f64; POINTS]; N] = values(&scaled(1.0 / FAR));

/// The parameters of the nodes, so many times as far from the centre.
const fn scaled(by: f64) -> [[f64; 3]; N] {
    let (mut at, mut k) = (NODES, 0);
    while k < 3 * N {
        at[k / 3][k % 3] *= by;
        k += 1;
    }
    at
}

/// Shape functions at places.
const fn values(at: &[[f64; 3]; N]) -> [[f64; N]; N] {
    let (mut values, mut q) = ([[0.0; N]; N], 0);
    while q < N {
        values[q] = shape(at[q]).0;
        q += 1;
    }
    values
}

/// Their derivatives there.
const fn gradients(at: &[[f64; 3]; N]) -> [Gradients<N>; N] {
    let (mut gradients, mut q) = ([[[0.0; N]; 3]; N], 0);
    while q < N {
        gradients[q] = shape(at[q]).1;
        q += 1;
    }
    gradients
}

/// The quadratic along one parameter that is 1 at `node`, one of -1, 0 and 1, and 0 at the others, and its derivative.
pub const fn along(node: f64, t: f64) -> [f64; 2] {
    if node == 0.0 { [1.0 - t * t, -2.0 * t] } else { [0.5 * t * (t + node), t + 0.5 * node] }
}

/// Shape functions and their derivatives by the parameters.
pub const fn shape([xi, eta, zeta]: [f64; 3]) -> ([f64; N], Gradients<N>) {
    let (mut values, mut gradients) = ([0.0; N], [[0.0; N]; 3]);
    let mut a = 0;
    while a < N {
        let [[r, dr], [s, ds], [t, dt]] = [along(NODES[a][0], xi), along(NODES[a][1], eta), along(NODES[a][2], zeta)];
        values[a] = r * s * t;
        gradients[0][a] = dr * s * t;
        gradients[1][a] = r * ds * t;
        gradients[2][a] = r * s * dt;
        a += 1;
    }
    (values, gradients)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; N],
    u: &[[f64; 3]; N],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<81>,
) -> Result<(), Inverted> {
    mixed::integrate(&mut points(x0, u)?, &PRESSURES, medium, want_tangent, out)
}

/// The integration points, with the projected change of volume.
pub fn samples(x0: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> Result<[Sample; POINTS], Inverted> {
    let mut points = points(x0, u)?;
    project(&mut points, &PRESSURES)?;
    Ok(points.map(|point| point.sample()))
}

/// Volume with nodes at `x`, reference or current.
pub fn volume(x: &[[f64; 3]; N]) -> f64 {
    let part = |(gradients, weight): (&Gradients<N>, f64)| weight * jacobian(x, gradients).determinant();
    GRADIENTS.iter().zip(WEIGHTS).map(part).sum()
}

/// Smallest Jacobian over the integration points, scaled to be the volume of a parallelepiped; positive in every element that
/// can be computed with.
pub fn min_jacobian(x: &[[f64; 3]; N]) -> f64 {
    GRADIENTS.iter().map(|gradients| 8.0 * jacobian(x, gradients).determinant()).fold(f64::INFINITY, f64::min)
}

/// Jacobians at the nodes: an element that is not positive at one is folded over there, and lies on itself.
pub fn nodal_jacobians(x: &[[f64; 3]; N]) -> [f64; N] {
    NODAL_GRADIENTS.each_ref().map(|gradients| 8.0 * jacobian(x, gradients).determinant())
}

/// Derivatives of the position by the parameters, its columns, at the integration points and the nodes.
pub fn frames(x: &[[f64; 3]; N]) -> impl Iterator<Item = Mat3> {
    GRADIENTS.iter().chain(&NODAL_GRADIENTS).map(|gradients| jacobian(x, gradients))
}

/// Parameters of a point in the element with nodes at `x`, by Newton's method; `None` where it finds none near the element.
pub fn parameters(x: &[[f64; 3]; N], point: &Vec3) -> Option<[f64; 3]> {
    parameters::find(x, point, [0.0; 3], shape)
}

/// Consistent nodal forces of a force per reference volume.
pub fn body_force(x0: &[[f64; 3]; N], per_volume: Vec3) -> [f64; 81] {
    let mut force = [0.0; 81];
    for ((values, gradients), weight) in VALUES.iter().zip(&GRADIENTS).zip(WEIGHTS) {
        let volume = weight * jacobian(x0, gradients).determinant();
        for a in 0..N {
            (0..3).for_each(|i| force[3 * a + i] += volume * values[a] * per_volume[i]);
        }
    }
    force
}

fn points(x0: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> Result<[Point<N>; POINTS], Inverted> {
    let mut points = deform(x0, u, &GRADIENTS, 1.0, 0.0)?;
    points.iter_mut().zip(WEIGHTS).for_each(|(point, weight)| point.weight *= weight);
    Ok(points)
}
