//! 8-node hexahedron for thin sheets (solid-shell): one layer of any aspect ratio bends, in finite rotations and strains.
//!
//! Nodes 0 to 3 are one side of the sheet, nodes 4 to 7 the other; xi, eta, zeta are the parameters, zeta through the
//! thickness. With base vectors x_i = dx/dxi_i, X_i in the reference state, the strain has the components
//!
//! ```text
//! E_ij = (x_i . x_j - X_i . X_j) / 2
//! E_13, E_23   at the middles of the edges across, linear between them (Dvorkin and Bathe, Eng. Comput. 1, 1984)
//! E_33         at the four corners, bilinear between them              (Betsch and Stein, Commun. Numer. Meth. Eng. 11, 1995)
//! ```
//!
//! so that neither bending nor walls that lean against each other (curved sheets) give strains across the sheet that are not
//! there. What the nodes have not, enhanced modes add:
//!
//! ```text
//! x_i  += (j0/j) x0_k a_kl f_k (J0^-1 J)_li,   f = (xi, eta),  i, k, l = 1, 2        membrane: in-plane bending
//! E_33 += (j0/j) [zeta (b_0 + b_1 xi + b_2 eta + b_3 xi eta) + c (1 - 3 zeta^2)]      thickness: Poisson's effect in bending
//! ```
//!
//! J is the derivative of the reference position by the parameters, j = det J, 0 marks the centre. The first are the
//! transposed modes of [`super::hex8_eas`], which do not buckle; of the second b are as many as a distorted sheet needs to bend
//! exactly (Vu-Quoc and Tan, CMAME 192, 2003), and c lets it keep its volume where it bends to few thicknesses: then
//! 1 + 2 E_33 = (1 + z/R)^-2 over the thickness. Two points through it do not see c. As all is strain, the material sees a deformation
//! gradient F that has it, the upper triangular root:
//!
//! ```text
//! F^T F = 1 + 2 J^-T E J^-1,     S = B tau B^T,     C = dS/dE = B B c B^T B^T,     B = J^-1 F^-1
//! R = int S : dE/du dV,     r_m = int S : dE/dalpha_m dV = 0
//! K = int dE/du : C : dE/du + S : d2E/du2 dV, condensed as in `enhanced.rs`
//! ```
//!
//! for F matters up to a rotation only, and tau and c (see [`crate::solid::material`]) turn with it. For a law with an energy
//! the forces derive from it; the tangent is symmetric. A Gauss rule through the thickness, of as many points as asked
//! for, over 2 x 2 in the plane. Point 4 l + k is at place l through the thickness.
//!
//! Constant strain and constant bending are exact in a sheet of even thickness whose walls are upright, whatever its mesh;
//! where the walls lean, constant strain has errors that fade with the square of the angle between them.

mod strain;

use super::enhanced::{Factor, MOST_HALVINGS, TOLERANCE, dot};
use super::hex8::{self, NODES};
use super::{Amplitudes, ElementMatrices, Formulation, GAUSS, Inverted, Medium, Sample, add_scaled};
use crate::Mat3;
use crate::mortar::rule::on_line;
use crate::solid::eigen::symmetric_eigen;
use crate::solid::material::Material;
use crate::solid::voigt::{PAIRS, Voigt, combine, compose, congruent, right_cauchy_green, to_matrix, transpose};
use std::sync::LazyLock;
use strain::{IntegrationPoint, MEMBRANE, MODES, Point, Row, Shape, TIES, component};

/// Points through the thickness unless told otherwise: a smooth law wants no more than two.
pub fn usual_layers(material: &Material) -> usize {
    if material.remembers() { 5 } else { 2 }
}

/// Points in the plane, at each place through the thickness.
pub const POINTS: usize = 4;

/// Most iterations for the amplitudes.
const ITERATIONS: usize = 30;

/// Places and weights from 0 to 1, from the first side to the other, of [`Formulation::LAYERS`].
pub fn layers(count: usize) -> &'static [[f64; 2]] {
    static RULES: LazyLock<Vec<Vec<[f64; 2]>>> = LazyLock::new(|| {
        let rule = |n: usize| on_line(n).into_iter().rev().collect();
        Formulation::LAYERS.map(rule).collect()
    });
    &RULES[count - Formulation::LAYERS.start()]
}

/// Shape functions at point `q` of so many places through the thickness.
pub fn values(q: usize, layer_count: usize) -> [f64; 8] {
    let [xi, eta, _] = NODES[q % POINTS];
    hex8::shape(GAUSS * xi, GAUSS * eta, 2.0 * layers(layer_count)[q / POINTS][0] - 1.0).0
}

/// What the values at the points, each times its number here, give at node `a`: bilinear in the plane, and the straight line
/// through the thickness that fits them best by the weights of the rule.
pub fn at_node(a: usize, layer_count: usize) -> Vec<f64> {
    let of_point = |([place, weight], k): ([f64; 2], usize)| {
        let line = 1.0 + 3.0 * NODES[a][2] * (2.0 * place - 1.0);
        let plane = (0..2).map(|i| 0.5 * (1.0 + NODES[a][i] * NODES[k][i] / GAUSS)).product::<f64>();
        weight * line * plane
    };
    layers(layer_count).iter().flat_map(|layer| (0..POINTS).map(|k| (*layer, k))).map(of_point).collect()
}

/// A point with its stress: S and C times the reference volume.
struct Stressed {
    point: Point,
    modes: [Voigt; MODES],
    stress: Voigt,
    moduli: [Voigt; 6],
}

/// Deformation and stress at given amplitudes, and the equations of these.
struct Trial {
    points: Vec<Stressed>,
    residual: [f64; MODES],
    tangent: [[f64; MODES]; MODES],
}

/// Amplitudes that solve their equations but for a last step, which enters the forces.
struct Solution {
    shape: Shape,
    trial: Trial,
    factor: Factor<MODES>,
    amplitudes: [f64; MODES],
    step: [f64; MODES],
}

impl Stressed {
    fn new(
        shape: &Shape,
        place: &IntegrationPoint,
        q: usize,
        amplitudes: &[f64; MODES],
        medium: Medium,
    ) -> Result<Self, Inverted> {
        let point = shape.point(place, amplitudes).ok_or(Inverted { det_f: f64::NAN })?;
        let response = medium.material.response(&point.f, medium.state(q)).ok_or(Inverted { det_f: point.det_f })?;
        let by_parameters = pull_back(&point.inverse);
        let rows = transpose(&by_parameters);
        let stress = combine(&response.kirchhoff, &rows).map(|s| place.weight * s);
        let moduli = congruent(&by_parameters, &response.tangent).map(|row| row.map(|c| place.weight * c));
        Ok(Self { modes: shape.modes(place, &point), point, stress, moduli })
    }
}

/// Takes components of a stress to those of B t B^T.
fn pull_back(b: &Mat3) -> [Voigt; 6] {
    PAIRS.map(|(i, j)| {
        PAIRS.map(|(k, l)| {
            let one = b[(i, k)] * b[(j, l)];
            if k == l { one } else { one + b[(i, l)] * b[(j, k)] }
        })
    })
}

impl Trial {
    fn new(shape: &Shape, amplitudes: &[f64; MODES], medium: Medium) -> Result<Self, Inverted> {
        let (mut residual, mut tangent) = ([0.0; MODES], [[0.0; MODES]; MODES]);
        let mut points = Vec::with_capacity(shape.places.len());
        for (q, place) in shape.places.iter().enumerate() {
            let at = Stressed::new(shape, place, q, amplitudes, medium)?;
            for m in 0..MODES {
                residual[m] += dot(&at.stress, &at.modes[m]);
                let rate = combine(&at.modes[m], &at.moduli);
                for n in 0..=m {
                    tangent[m][n] += dot(&rate, &at.modes[n]);
                    if m < MEMBRANE {
                        tangent[m][n] += shape.mode_stiffness(place, &at.stress, m, n);
                    }
                }
            }
            points.push(at);
        }
        for (m, row) in tangent.iter_mut().enumerate() {
            // What no point sees stays at zero.
            if row[m] == 0.0 {
                row[m] = medium.material.initial_moduli().1 * shape.volume;
            }
        }
        Ok(Self { points, residual, tangent })
    }

    /// A step downhill where the tangent of the amplitudes is not positive definite.
    fn convex_step(&self) -> [f64; MODES] {
        for times in [0.1, 1.0, 10.0, 100.0] {
            let mut stiffer = self.tangent;
            (0..MODES).for_each(|m| stiffer[m][m] += times * self.tangent[m][m].abs());
            if let Some(factor) = Factor::new(&stiffer).filter(Factor::positive) {
                return factor.solve(&self.residual).map(|s| -s);
            }
        }
        [f64::NAN; MODES]
    }
}

/// Finds the amplitudes by Newton's method downhill, from where they are expected, then from zero.
fn solve((x0, u): (&[[f64; 3]; 8], &[[f64; 3]; 8]), layers: &[[f64; 2]], medium: Medium) -> Result<Solution, Inverted> {
    let shape = Shape::new(x0, u, layers);
    let enough = TOLERANCE * medium.material.initial_moduli().1 * shape.volume;
    let mut failure = Inverted { det_f: f64::NAN };
    let known = medium.amplitudes.map(|known| known.ahead(u));
    for mut amplitudes in known.into_iter().chain([[0.0; MODES]]) {
        let mut trial = match Trial::new(&shape, &amplitudes, medium) {
            Ok(trial) => trial,
            Err(inverted) => {
                failure = inverted;
                continue;
            }
        };
        for _ in 0..ITERATIONS {
            let step = match Factor::new(&trial.tangent) {
                Some(factor) if factor.energy(&trial.residual) <= enough => {
                    let step = factor.solve(&trial.residual).map(|s| -s);
                    return Ok(Solution { shape, trial, factor, amplitudes, step });
                }
                Some(factor) if factor.positive() => factor.solve(&trial.residual).map(|s| -s),
                _ => trial.convex_step(),
            };
            let slope = dot(&step, &trial.residual);
            let mut size = 1.0;
            let accepted = (0..MOST_HALVINGS).find_map(|_| {
                let tried: [f64; MODES] = std::array::from_fn(|m| amplitudes[m] + size * step[m]);
                size *= 0.5;
                let next = Trial::new(&shape, &tried, medium).map_err(|inverted| failure = inverted).ok()?;
                (dot(&step, &next.residual) <= -0.5 * slope).then_some((tried, next))
            });
            let Some(accepted) = accepted else { break };
            (amplitudes, trial) = accepted;
        }
    }
    Err(failure)
}

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u` and so many points through the thickness. `out.tangent` keeps its old entries otherwise; after an error `out` is
/// undefined.
pub fn evaluate(
    (x0, u): (&[[f64; 3]; 8], &[[f64; 3]; 8]),
    layer_count: usize,
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    let Solution { shape, trial, factor, amplitudes, step } = &solve((x0, u), layers(layer_count), medium)?;
    let ties = shape.tie_rows();
    let (mut force, mut coupling) = ([0.0; 24], [[0.0; 24]; MODES]);
    let (mut on_ties, mut initial) = ([0.0; TIES], [[0.0; 8]; 8]);
    if want_tangent {
        out.tangent = [[0.0; 24]; 24];
    }
    for (place, at) in shape.places.iter().zip(&trial.points) {
        let rows = shape.rows(place, &at.point, &ties);
        let gradients = shape.membrane_gradients(place, &at.point);
        (0..6).for_each(|v| add_scaled(&mut force, at.stress[v], &rows[v]));
        for m in 0..MODES {
            let rate = combine(&at.modes[m], &at.moduli);
            (0..6).for_each(|v| add_scaled(&mut coupling[m], rate[v], &rows[v]));
            if m < MEMBRANE {
                shape.add_mode_coupling(place, (&at.point, &gradients), &at.stress, m, &mut coupling[m]);
            }
        }
        if want_tangent {
            add_stiffness(at, &rows, &mut out.tangent);
            (0..TIES).for_each(|t| on_ties[t] += place.shares[t] * at.stress[component(t)]);
            for a in 0..8 {
                let [first, second] = [gradients[0][a], gradients[1][a]];
                add_scaled(&mut initial[a], at.stress[0] * first + at.stress[3] * second, &gradients[0]);
                add_scaled(&mut initial[a], at.stress[3] * first + at.stress[1] * second, &gradients[1]);
            }
        }
    }
    (0..MODES).for_each(|m| add_scaled(&mut force, step[m], &coupling[m]));
    out.residual = force;
    if want_tangent {
        let of_ties = shape.tie_stiffness(&on_ties);
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
            let value = initial[a][b] + of_ties[a][b];
            (0..3).for_each(|d| out.tangent[3 * a + d][3 * b + d] += value);
        }
        condense(factor, &mut coupling, &mut out.tangent);
        keep(u, factor, &coupling, (amplitudes, step), &mut out.amplitudes);
    }
    Ok(())
}

/// Adds dE/du : C : dE/du.
fn add_stiffness(at: &Stressed, rows: &[Row; 6], tangent: &mut [Row; 24]) {
    for v in 0..6 {
        let mut stress = [0.0; 24];
        (0..6).for_each(|w| add_scaled(&mut stress, at.moduli[v][w], &rows[w]));
        for (row, along) in tangent.iter_mut().zip(&rows[v]) {
            add_scaled(row, *along, &stress);
        }
    }
}

/// With K_mn = L D L^T subtracts C^T D^-1 C, C = L^-1 K_ma, which is left in `coupling`; makes the tangent exactly
/// symmetric.
fn condense(factor: &Factor<MODES>, coupling: &mut [Row; MODES], tangent: &mut [Row; 24]) {
    for m in 0..MODES {
        let (done, rest) = coupling.split_at_mut(m);
        (0..m).for_each(|n| add_scaled(&mut rest[0], -factor.lower[m][n], &done[n]));
    }
    for (row, pivot) in coupling.iter().zip(factor.diagonal) {
        for i in 0..24 {
            add_scaled(&mut tangent[i], -row[i] / pivot, row);
        }
    }
    for i in 0..24 {
        for j in 0..i {
            tangent[i][j] = tangent[j][i];
        }
    }
}

/// The amplitudes and their slopes, -K_mn^-1 K_na = -L^-T D^-1 C.
fn keep(
    u: &[[f64; 3]; 8],
    factor: &Factor<MODES>,
    coupling: &[Row; MODES],
    (amplitudes, step): (&[f64; MODES], &[f64; MODES]),
    Amplitudes { at, values, slopes }: &mut Amplitudes,
) {
    at.copy_from_slice(u.as_flattened());
    for m in (0..MODES).rev() {
        values[m] = amplitudes[m] + step[m];
        let mut row = coupling[m].map(|c| -c / factor.diagonal[m]);
        (m + 1..MODES).for_each(|n| add_scaled(&mut row, -factor.lower[n][m], &slopes[n]));
        slopes[m] = row;
    }
}

/// The integration points. Their F has the rotation of the nodes' F.
pub fn samples(
    (x0, u): (&[[f64; 3]; 8], &[[f64; 3]; 8]),
    layer_count: usize,
    medium: Medium,
) -> Result<Vec<Sample>, Inverted> {
    let Solution { shape, amplitudes, step, .. } = solve((x0, u), layers(layer_count), medium)?;
    let amplitudes = std::array::from_fn(|m| amplitudes[m] + step[m]);
    let sample = |place: &IntegrationPoint| {
        let point = shape.point(place, &amplitudes).ok_or(Inverted { det_f: f64::NAN })?;
        let compatible = shape.compatible(place);
        let rotation = compatible * power(&right_cauchy_green(&compatible), -0.5);
        let f = rotation * power(&right_cauchy_green(&point.f), 0.5);
        Ok(Sample { f, det_f: point.det_f, weight: place.weight })
    };
    shape.places.iter().map(sample).collect()
}

/// A power of a positive definite tensor.
fn power(t: &Voigt, exponent: f64) -> Mat3 {
    let (values, directions) = symmetric_eigen(t);
    to_matrix(&compose(&values.map(|value| value.powf(exponent)), &directions))
}

#[cfg(test)]
mod tests;
