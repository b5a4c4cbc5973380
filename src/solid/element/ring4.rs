//! An axisymmetric body at the cost of two dimensions: a quadrilateral in the half-plane of radius r = x and height y, turned
//! about the y axis. It is a hexahedron of one layer along z, of which the lower four nodes carry it; z is the direction around.
//!
//! With the radius R before the motion, r = R + u_x, and u_z = 0, a deformation gradient and a rate L = F' F^-1 have
//!
//! ```text
//! F_ij = d_ij + du_i/dX_j,   F_zz = r / R,      L_ij = sum_a u_ai g_aj,   L_zz = sum_a u_ax N_a / r,      i, j = x, y     (1)
//! R    = int tau : L dV,     dV = 2 pi R dA,    K = int [ L : a : L' ] dV,    a_ijkl = c_ijkl + d_ik tau_jl            (2)
//! ```
//!
//! so that forces and stiffnesses are those of the whole ring. As F is linear in u, r included, (2) is what the other elements
//! have; L stands for the row that a displacement of a node has in it. 2x2 points: they are never on the axis.
//!
//! F-bar, of [`super::hex8_fbar`], with the trace t of L, the centre 0 that has its own r / R, and q = (cb : 1 - taub) / 3:
//!
//! ```text
//! R = int (J/J0) taub : L dV,      K = int (J/J0) [ L : ab : L' + (q : L) (t0 - t)' ] dV                             (3)
//! ```
//!
//! Selective reduced integration, of [`super::hex8_sri`], with the mean change of volume: m = sum of the shares s of the points in
//! the current volume times t, e = (m - t) / 3, Ls = L + e 1, p = tr taus / 3, P = int p dV:
//!
//! ```text
//! R = int dev taus : L dV + P m
//! K = int [ Ls : as : Ls' + (taus : L) e' + e (taus : L)' + 3 p e e' + p tr(L L') ] dV
//!     + P [ sum s (t t' - tr(L L')) - m m' ]                                                                    (4)
//! ```
//!
//! (4) are the second derivatives of int W(Fs) dV, with those of J by J (t t' - tr(L L')).

use super::{ElementMatrices, Formulation, GAUSS, Inverted, Medium, Sample};
use crate::Mat3;
use crate::solid::material::Response;
use crate::solid::voigt::{INDEX, Voigt};
use std::f64::consts::TAU;

/// Integration points.
pub const POINTS: usize = 4;

/// Displacements that count: x and y of each node.
const FREE: usize = 8;

/// The components of L that are not zero.
const PARTS: [[usize; 2]; 5] = [[0, 0], [0, 1], [1, 0], [1, 1], [2, 2]];
/// Those of its trace.
const DIAGONAL: [usize; 3] = [0, 3, 4];

/// Parameters of the nodes, counter-clockwise seen from +z.
const NODES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A value for each displacement.
type Row = [f64; FREE];

/// An integration point of a deformed ring.
#[derive(Clone, Copy)]
struct Point {
    /// L of each displacement, by [`PARTS`].
    rates: [Row; 5],
    f: Mat3,
    det_f: f64,
    /// What multiplies tau: the reference volume of the point, in standard elements.
    weight: f64,
}

/// Internal forces and, if wanted, the tangent of the ring with lower reference nodes `x0` displaced by `u`, whose z do not count;
/// entries along z are zero. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    (x0, u): (&[[f64; 3]; 4], &[[f64; 3]; 4]),
    medium: Medium,
    (want_tangent, element): (bool, Formulation),
    out: &mut ElementMatrices<12>,
) -> Result<(), Inverted> {
    let mut points = points(x0, u)?;
    let (force, tangent) = match element {
        Formulation::Hex8Sri => of_mean(&mut points, medium, want_tangent)?,
        Formulation::Hex8Fbar => {
            let centre = centre(x0, u)?;
            use_volume_of(&centre, &mut points);
            integrate(&points, Some(&centre), medium, want_tangent)?
        }
        _ => integrate(&points, None, medium, want_tangent)?,
    };
    let place = |k: usize| 3 * (k / 2) + k % 2;
    out.residual = [0.0; 12];
    (0..FREE).for_each(|k| out.residual[place(k)] = force[k]);
    if want_tangent {
        out.tangent = [[0.0; 12]; 12];
        (0..FREE).for_each(|r| (0..FREE).for_each(|c| out.tangent[place(r)][place(c)] = tangent[r][c]));
    }
    Ok(())
}

/// The integration points.
pub fn samples((x0, u): (&[[f64; 3]; 4], &[[f64; 3]; 4]), element: Formulation) -> Result<[Sample; POINTS], Inverted> {
    let mut points = points(x0, u)?;
    match element {
        Formulation::Hex8Fbar => use_volume_of(&centre(x0, u)?, &mut points),
        Formulation::Hex8Sri => use_mean_volume(&mut points),
        _ => {}
    }
    Ok(points.map(|point| Sample { f: point.f, det_f: point.det_f, weight: point.weight }))
}

/// Nodal forces, x and y of each, of a force per reference volume on the ring.
pub fn body_force(x0: &[[f64; 3]; 4], per_volume: [f64; 2]) -> [[f64; 2]; 4] {
    let mut forces = [[0.0; 2]; 4];
    for at in NODES.map(|node| node.map(|parameter| GAUSS * parameter)) {
        let shape = Shape::at(at);
        let volume = TAU * shape.radius(x0) * determinant(&shape.jacobian(x0));
        for (force, value) in forces.iter_mut().zip(shape.values) {
            (0..2).for_each(|i| force[i] += volume * value * per_volume[i]);
        }
    }
    forces
}

/// Shape functions and their derivatives by the parameters.
struct Shape {
    values: [f64; 4],
    gradients: [[f64; 4]; 2],
}

impl Shape {
    /// N_a = (1 + xi_a xi)(1 + eta_a eta) / 4.
    fn at([xi, eta]: [f64; 2]) -> Self {
        let of = |f: &dyn Fn(f64, f64) -> f64| NODES.map(|[a, b]| 0.25 * f(a, b));
        Self {
            values: of(&|a, b| (1.0 + a * xi) * (1.0 + b * eta)),
            gradients: [of(&|a, b| a * (1.0 + b * eta)), of(&|a, b| (1.0 + a * xi) * b)],
        }
    }

    fn radius(&self, x: &[[f64; 3]; 4]) -> f64 {
        (0..4).map(|a| self.values[a] * x[a][0]).sum()
    }

    /// `[i][m]` = dx_i/dxi_m.
    fn jacobian(&self, x: &[[f64; 3]; 4]) -> [[f64; 2]; 2] {
        [0, 1].map(|i| [0, 1].map(|m| (0..4).map(|a| x[a][i] * self.gradients[m][a]).sum()))
    }
}

fn determinant([[a, b], [c, d]]: &[[f64; 2]; 2]) -> f64 {
    a * d - b * c
}

fn points(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4]) -> Result<[Point; POINTS], Inverted> {
    let each = NODES.map(|node| point(x0, u, node.map(|parameter| GAUSS * parameter), 1.0));
    let worst = |worst: f64, p: &Point| if p.det_f < worst || p.det_f.is_nan() { p.det_f } else { worst };
    // Beyond the axis there is nothing; a node may come there while no point does.
    let beyond = (0..4).map(|a| x0[a][0] + u[a][0]).fold(0.0, f64::min) / x0.iter().map(|x| x[0]).fold(0.0, f64::max);
    let worst = each.iter().fold(if beyond < 0.0 { beyond } else { f64::INFINITY }, worst);
    if worst > 0.0 { Ok(each) } else { Err(Inverted { det_f: worst }) }
}

fn centre(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4]) -> Result<Point, Inverted> {
    let centre = point(x0, u, [0.0; 2], 4.0);
    if centre.det_f > 0.0 { Ok(centre) } else { Err(Inverted { det_f: centre.det_f }) }
}

/// (1).
fn point(x0: &[[f64; 3]; 4], u: &[[f64; 3]; 4], at: [f64; 2], weight: f64) -> Point {
    let shape = Shape::at(at);
    let (before, moved) = (shape.jacobian(x0), shape.jacobian(u));
    let now = [0, 1].map(|i| [0, 1].map(|m| before[i][m] + moved[i][m]));
    let inverse = |j: &[[f64; 2]; 2]| {
        let det = determinant(j);
        ([[j[1][1] / det, -j[0][1] / det], [-j[1][0] / det, j[0][0] / det]], det)
    };
    let ((from, det0), (to, det)) = (inverse(&before), inverse(&now));
    let (around, moved_out) = (shape.radius(x0), shape.radius(u));
    let radius = around + moved_out;
    let mut f = Mat3::identity();
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        f[(i, j)] += moved[i][0] * from[0][j] + moved[i][1] * from[1][j];
    }
    f[(2, 2)] = 1.0 + moved_out / around;
    let mut rates = [[0.0; FREE]; 5];
    for a in 0..4 {
        let g = [0, 1].map(|j| shape.gradients[0][a] * to[0][j] + shape.gradients[1][a] * to[1][j]);
        for (part, [i, j]) in rates.iter_mut().zip(PARTS).take(4) {
            part[2 * a + i] = g[j];
        }
        rates[4][2 * a] = shape.values[a] / radius;
    }
    // The smaller of the two tells of what is inside out, where both are.
    let (area, hoop) = (det / det0, f[(2, 2)]);
    let det_f = if area < 0.0 && hoop < 0.0 { area } else { area * hoop };
    Point { rates, f, det_f, weight: weight * det0 * TAU * around }
}

/// F-bar: gives the points the volume change of the centre, and weights dV J/J0.
fn use_volume_of(centre: &Point, points: &mut [Point; POINTS]) {
    for point in points {
        let ratio = centre.det_f / point.det_f;
        point.f *= ratio.cbrt();
        point.det_f = centre.det_f;
        point.weight /= ratio;
    }
}

/// Gives all points the mean change of volume.
fn use_mean_volume(points: &mut [Point; POINTS]) {
    let (before, now) = points.iter().fold((0.0, 0.0), |(b, n), p| (b + p.weight, n + p.weight * p.det_f));
    let mean = now / before;
    for point in points {
        point.f *= (mean / point.det_f).cbrt();
        point.det_f = mean;
    }
}

/// Stress and, when wanted, tangent at a point.
fn respond(medium: Medium, point: &Point, q: usize, want_tangent: bool) -> Result<Response, Inverted> {
    let (material, state) = (medium.material, medium.state(q));
    let found = match want_tangent {
        true => material.response(&point.f, state),
        false => material.kirchhoff(&point.f, state).map(|kirchhoff| Response { kirchhoff, tangent: [[0.0; 6]; 6] }),
    };
    found.ok_or(Inverted { det_f: point.det_f })
}

/// y = y + a x.
fn add(y: &mut Row, a: f64, x: &Row) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// A tensor : L.
fn contract(tensor: &Voigt, rates: &[Row; 5]) -> Row {
    let mut sum = [0.0; FREE];
    PARTS.iter().zip(rates).for_each(|([i, j], rate)| add(&mut sum, tensor[INDEX[*i][*j]], rate));
    sum
}

/// t.
fn trace(rates: &[Row; 5]) -> Row {
    let mut sum = [0.0; FREE];
    DIAGONAL.iter().for_each(|k| add(&mut sum, 1.0, &rates[*k]));
    sum
}

/// tangent = tangent + factor rows (x) columns.
fn add_product(tangent: &mut [Row; FREE], factor: f64, rows: &Row, columns: &Row) {
    tangent.iter_mut().zip(rows).for_each(|(row, by)| add(row, factor * by, columns));
}

/// Adds weight L : a : L'.
fn add_stiffness(point: &Point, rates: &[Row; 5], response: &Response, tangent: &mut [Row; FREE]) {
    for (m, [i, j]) in PARTS.into_iter().enumerate() {
        let mut row = [0.0; FREE];
        for (n, [k, l]) in PARTS.into_iter().enumerate() {
            let initial = if i == k { response.kirchhoff[INDEX[j][l]] } else { 0.0 };
            add(&mut row, response.tangent[INDEX[i][j]][INDEX[k][l]] + initial, &rates[n]);
        }
        add_product(tangent, point.weight, &rates[m], &row);
    }
}

/// Adds factor tr(L L').
fn add_squares(factor: f64, rates: &[Row; 5], tangent: &mut [Row; FREE]) {
    for (m, n) in [(0, 0), (1, 2), (2, 1), (3, 3), (4, 4)] {
        add_product(tangent, factor, &rates[m], &rates[n]);
    }
}

/// (2), and (3) with a centre.
fn integrate(
    points: &[Point; POINTS],
    centre: Option<&Point>,
    medium: Medium,
    want_tangent: bool,
) -> Result<(Row, [Row; FREE]), Inverted> {
    let (mut force, mut tangent) = ([0.0; FREE], [[0.0; FREE]; FREE]);
    for (q, point) in points.iter().enumerate() {
        let response = respond(medium, point, q, want_tangent)?;
        add(&mut force, point.weight, &contract(&response.kirchhoff, &point.rates));
        if !want_tangent {
            continue;
        }
        add_stiffness(point, &point.rates, &response, &mut tangent);
        if let Some(centre) = centre {
            let of_volume = |v: usize| response.tangent[v][0] + response.tangent[v][1] + response.tangent[v][2];
            let q: Voigt = std::array::from_fn(|v| (of_volume(v) - response.kirchhoff[v]) / 3.0);
            let mut change = trace(&centre.rates);
            add(&mut change, -1.0, &trace(&point.rates));
            add_product(&mut tangent, point.weight, &contract(&q, &point.rates), &change);
        }
    }
    Ok((force, tangent))
}

/// (4).
fn of_mean(points: &mut [Point; POINTS], medium: Medium, want_tangent: bool) -> Result<(Row, [Row; FREE]), Inverted> {
    let volume: f64 = points.iter().map(|p| p.weight * p.det_f).sum();
    let share = points.each_ref().map(|p| p.weight * p.det_f / volume);
    let mut mean = [0.0; FREE];
    points.iter().zip(share).for_each(|(point, share)| add(&mut mean, share, &trace(&point.rates)));
    use_mean_volume(points);

    let (mut force, mut tangent, mut total) = ([0.0; FREE], [[0.0; FREE]; FREE], 0.0);
    for (q, point) in points.iter().enumerate() {
        let response = respond(medium, point, q, want_tangent)?;
        let stress = contract(&response.kirchhoff, &point.rates);
        let pressure = (response.kirchhoff[0] + response.kirchhoff[1] + response.kirchhoff[2]) / 3.0;
        let mut change = mean;
        add(&mut change, -1.0, &trace(&point.rates));
        change.iter_mut().for_each(|e| *e /= 3.0);
        add(&mut force, point.weight, &stress);
        add(&mut force, 3.0 * point.weight * pressure, &change);
        total += point.weight * pressure;
        if !want_tangent {
            continue;
        }
        let mut rates = point.rates;
        DIAGONAL.iter().for_each(|k| add(&mut rates[*k], 1.0, &change));
        add_stiffness(point, &rates, &response, &mut tangent);
        add_product(&mut tangent, point.weight, &stress, &change);
        add_product(&mut tangent, point.weight, &change, &stress);
        add_product(&mut tangent, 3.0 * point.weight * pressure, &change, &change);
        add_squares(point.weight * pressure, &point.rates, &mut tangent);
    }
    if want_tangent {
        for (point, share) in points.iter().zip(share) {
            let trace = trace(&point.rates);
            add_product(&mut tangent, total * share, &trace, &trace);
            add_squares(-total * share, &point.rates, &mut tangent);
        }
        add_product(&mut tangent, -total, &mean, &mean);
    }
    Ok((force, tangent))
}

#[cfg(test)]
mod tests;
