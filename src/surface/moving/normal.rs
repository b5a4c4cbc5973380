//! Rules by which nodal normals follow the nodes, with two derivatives.
//!
//! **Mean.** The edges a_i from the node to its neighbours, turned inside out to r_i = a_i/|a_i|^2, give Max's mean over
//! the corners (i, j) of the facets (J. Graph. Tools 4, 1999, 1-6; a corner weighs the sine of its angle over the lengths
//! of its edges)
//!
//! ```text
//!     n = N/|N|,     N = sum r_i x r_j
//! ```
//!
//! Of a node in symmetry planes it has the corners on the one side; the sum over all their images is a multiple of P N, with
//! P the projector onto the planes, which takes the place of N.
//!
//! **End.** At an end of the surface the normal y follows the neighbours u inside, see (*) of [`super::super::normals`].
//! With d_u = x_u - x and weights chosen on the initial mesh, it satisfies two of the conditions (y + n_u).d_u = 0:
//!
//! ```text
//!     y.t_s + h_s = 0,     t_s = sum_u w_su d_u,     h_s = sum_u w_su n_u.d_u     (s = 1, 2),     |y| = 1
//! ```
//!
//! Where all neighbours lie in one direction, t_2 = m x t_1 and h_2 = 0 with m the sum of their normals: the mirrored
//! normal, for one neighbour y = n_u - 2 (n_u.d) d/|d|^2. Both are exact on spheres and cylinders. Derivatives follow
//! from those of the conditions: with B = [t_1 t_2 y]^T, B dy = -(dh_s + y.dt_s, 0). Normals that would lean by more than
//! 60 degrees are taken orthogonal to t_1 and t_2.

use super::variation::{Hessian, Link};
use crate::{Mat3, Vec3};

/// Largest square of the part of an extrapolated normal along the surface.
const LARGEST_LEAN: f64 = 0.75;

/// How a nodal normal follows from the nodes of a patch, given as indices into [`super::MovingPatch::nodes`].
#[derive(Clone, Debug, PartialEq)]
pub enum NormalRule {
    /// The mean of `corners`, each between two of the edges from `node` to the `spokes`, counter-clockwise; `within` is the
    /// projector onto the symmetry planes in which the node lies.
    Mean { node: u32, spokes: Vec<u32>, corners: Vec<[u32; 2]>, within: Option<Mat3> },
    /// At an end of the surface, by neighbours in 1 or 2 directions.
    End { node: u32, neighbours: Vec<Neighbour>, directions: u8 },
}

/// A neighbour of a node at an end of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    pub node: u32,
    /// Its normal, an index into [`super::MovingPatch::normals`].
    pub normal: u32,
    /// Weights w_1u and w_2u of its edge.
    pub weights: [f64; 2],
}

impl NormalRule {
    /// The unit normal, with the normals before it. Without area around the node it is zero.
    pub fn value(&self, positions: &[Vec3], normals: &[Vec3]) -> Vec3 {
        match self {
            Self::Mean { node, spokes, corners, within } => {
                let inverted = |k: u32| invert(&(positions[spokes[k as usize] as usize] - positions[*node as usize]));
                let sum: Vec3 = corners.iter().map(|[i, j]| inverted(*i).cross(&inverted(*j))).sum();
                let sum = within.map_or(sum, |within| within * sum);
                sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
            }
            Self::End { node, neighbours, directions } => {
                End::new(positions, normals, *node, neighbours, *directions).normal
            }
        }
    }

    /// How the normal changes with what it directly depends on; the normals before it are known.
    pub(super) fn link(&self, state: &mut State, link: &mut Link) {
        let State { positions, normals, spokes } = state;
        link.parts.clear();
        match self {
            Self::Mean { node, spokes: ends, corners, within } => {
                spread(positions, *node, ends, corners, spokes);
                let within = within.unwrap_or_else(Mat3::identity);
                let sum: Vec3 = within * corners.iter().map(|[i, j]| cross(spokes, *i, *j)).sum::<Vec3>();
                let size = sum.norm().max(f64::MIN_POSITIVE);
                link.value = sum / size;
                link.size = size;
                link.outer = (Mat3::identity() - link.value * link.value.transpose()) / size;
                let mut all = Mat3::zeros();
                for (end, spoke) in ends.iter().zip(&*spokes) {
                    let part = within * spoke.axis.cross_matrix() * spoke.turn;
                    all -= part;
                    link.parts.push((*end as usize, part));
                }
                link.parts.push((*node as usize, all));
            }
            Self::End { node, neighbours, directions } => {
                let end = End::new(positions, normals, *node, neighbours, *directions);
                (link.value, link.size, link.outer) = (end.normal, 1.0, Mat3::identity());
                let mut all = Mat3::zeros();
                for u in neighbours {
                    let (by_edge, by_normal) = end.slopes(u, &positions[u.node as usize], &normals[u.normal as usize]);
                    all -= by_edge;
                    link.parts.push((u.node as usize, by_edge));
                    link.parts.push((positions.len() + u.normal as usize, by_normal));
                }
                link.parts.push((*node as usize, all));
            }
        }
    }

    /// Adds to `hessian` the second derivatives of g.n by what this normal, number `index`, directly depends on. In the row
    /// and column of a mean, N takes the place of n, so that what is left to eliminate is dN = sum J_a da.
    pub(super) fn bend(&self, index: usize, state: &mut State, link: &Link, g: &Vec3, hessian: &mut Hessian) {
        let State { positions, normals, spokes } = state;
        match self {
            Self::Mean { node, spokes: ends, corners, within } => {
                spread(positions, *node, ends, corners, spokes);
                hessian.transform(index, &link.outer);
                Mean { node: *node as usize, ends, corners, within, spokes }.bend(index, link, g, hessian);
            }
            Self::End { node, neighbours, directions } => {
                let end = End::new(positions, normals, *node, neighbours, *directions);
                end.bend(index, *node as usize, neighbours, positions.len(), g, hessian);
            }
        }
    }
}

/// Positions and normals of a patch.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    spokes: Vec<Spoke>,
}

/// a/|a|^2.
fn invert(a: &Vec3) -> Vec3 {
    a / a.norm_squared().max(f64::MIN_POSITIVE)
}

/// An edge of a mean.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spoke {
    /// 1/|a|^2, r, and dr/da.
    over: f64,
    inverted: Vec3,
    turn: Mat3,
    /// dN = sum axis x dr.
    axis: Vec3,
}

/// The spokes of a mean.
fn spread(positions: &[Vec3], node: u32, ends: &[u32], corners: &[[u32; 2]], spokes: &mut Vec<Spoke>) {
    spokes.clear();
    spokes.extend(ends.iter().map(|end| {
        let edge = positions[*end as usize] - positions[node as usize];
        let inverted = invert(&edge);
        let over = 1.0 / edge.norm_squared().max(f64::MIN_POSITIVE);
        let turn = Mat3::from_diagonal_element(over) - inverted * inverted.transpose() * 2.0;
        Spoke { inverted, over, turn, axis: Vec3::zeros() }
    }));
    for &[i, j] in corners {
        let (i, j) = (i as usize, j as usize);
        let (r_i, r_j) = (spokes[i].inverted, spokes[j].inverted);
        spokes[i].axis -= r_j;
        spokes[j].axis += r_i;
    }
}

fn cross(spokes: &[Spoke], i: u32, j: u32) -> Vec3 {
    spokes[i as usize].inverted.cross(&spokes[j as usize].inverted)
}

/// A mean with its spokes to `ends`.
struct Mean<'a> {
    node: usize,
    ends: &'a [u32],
    corners: &'a [[u32; 2]],
    within: &'a Option<Mat3>,
    spokes: &'a [Spoke],
}

impl Mean<'_> {
    /// Adds the second derivatives of g.N/|N|: those of the normalisation by N, number `index`, those of N by the spokes.
    fn bend(&self, index: usize, link: &Link, g: &Vec3, hessian: &mut Hessian) {
        let Self { node, ends, corners, within, spokes } = *self;
        let n = link.value;
        let on_sum = link.outer * g;
        let mixed = on_sum * n.transpose();
        hessian.add_diagonal(index, &(-(mixed + mixed.transpose() + link.outer * g.dot(&n)) / link.size));
        let on_sum = within.map_or(on_sum, |within| within * on_sum);
        let mut add = |i: usize, j: usize, block: &Mat3| {
            // The edges are differences to the node.
            let (i, j) = (ends[i] as usize, ends[j] as usize);
            if i == j {
                hessian.add_diagonal(i, block);
                hessian.add_pair(i, node, &-block);
                hessian.add_diagonal(node, block);
            } else {
                hessian.add_pair(i, j, block);
                hessian.add_pair(i, node, &-block);
                hessian.add_pair(j, node, &-block.transpose());
                hessian.add_diagonal(node, &(block + block.transpose()));
            }
        };
        let twist = on_sum.cross_matrix();
        for &[i, j] in corners {
            let (i, j) = (i as usize, j as usize);
            add(i, j, &-(spokes[i].turn * twist * spokes[j].turn));
        }
        for (i, spoke) in spokes.iter().enumerate() {
            let (u, r) = (on_sum.cross(&spoke.axis), spoke.inverted);
            let (ur, lean, over) = (u * r.transpose(), u.dot(&r), spoke.over);
            let block = (ur + ur.transpose()) * (-2.0 * over) - Mat3::from_diagonal_element(2.0 * lean * over)
                + r * r.transpose() * (8.0 * lean);
            add(i, i, &block);
        }
    }
}

/// An extrapolated normal y.
struct End {
    place: Vec3,
    normal: Vec3,
    directions: u8,
    /// t_1 and t_2.
    along: [Vec3; 2],
    /// m, when all neighbours lie in one direction.
    mean: Vec3,
    /// Columns of the inverse of B.
    inverse: [Vec3; 3],
    /// 1, or 0 when the h_s are left out.
    lean: f64,
}

impl End {
    fn new(positions: &[Vec3], normals: &[Vec3], node: u32, neighbours: &[Neighbour], directions: u8) -> Self {
        let place = positions[node as usize];
        let (mut along, mut offsets, mut mean) = ([Vec3::zeros(); 2], [0.0; 2], Vec3::zeros());
        for u in neighbours {
            let (d, n) = (positions[u.node as usize] - place, normals[u.normal as usize]);
            for s in 0..2 {
                along[s] += d * u.weights[s];
                offsets[s] += n.dot(&d) * u.weights[s];
            }
            mean += n * u.weights[0].abs();
        }
        if directions == 1 {
            (along[1], offsets[1]) = (mean.cross(&along[0]), 0.0);
        }
        let [t, u] = along;
        let across = t.cross(&u);
        let area = across.norm_squared().max(f64::MIN_POSITIVE);
        // The dual vectors of t_1 and t_2 in their plane.
        let dual = [u.cross(&across) / area, across.cross(&t) / area];
        let inside = -(dual[0] * offsets[0] + dual[1] * offsets[1]);
        let size = inside.norm_squared();
        let upright = across / area.sqrt();
        let (normal, lean) =
            if size < LARGEST_LEAN { (inside + upright * (1.0 - size).sqrt(), 1.0) } else { (upright, 0.0) };
        let volume = across.dot(&normal);
        let volume = if volume == 0.0 { f64::MIN_POSITIVE } else { volume };
        let inverse = [u.cross(&normal) / volume, normal.cross(&t) / volume, across / volume];
        Self { place, normal, directions, along, mean, inverse, lean }
    }

    /// dy/dd_u and dy/dn_u.
    fn slopes(&self, u: &Neighbour, position: &Vec3, normal: &Vec3) -> (Mat3, Mat3) {
        let (y, d) = (&self.normal, position - self.place);
        let [mut by_edge, mut by_normal] = [Mat3::zeros(); 2];
        for s in 0..self.directions as usize {
            let column = self.inverse[s] * -u.weights[s];
            by_edge += column * (normal * self.lean + y).transpose();
            by_normal += column * (d * self.lean).transpose();
        }
        if self.directions == 1 {
            by_edge -= self.inverse[1] * (y.cross(&self.mean) * u.weights[0]).transpose();
            by_normal -= self.inverse[1] * (self.along[0].cross(y) * u.weights[0].abs()).transpose();
        }
        (by_edge, by_normal)
    }

    /// Adds the second derivatives of g.y by y (number `index`), the neighbours' nodes and normals (from number `first`).
    fn bend(&self, index: usize, node: usize, neighbours: &[Neighbour], first: usize, g: &Vec3, hessian: &mut Hessian) {
        let multipliers = self.inverse.map(|column| column.dot(g));
        hessian.add_diagonal(index, &Mat3::from_diagonal_element(-multipliers[2]));
        let mut by_edge = |a: usize, u: &Neighbour, block: &Mat3| {
            hessian.add_pair(a, u.node as usize, block);
            hessian.add_pair(a, node, &-block);
        };
        for u in neighbours {
            let normal = first + u.normal as usize;
            for s in 0..self.directions as usize {
                let block = Mat3::from_diagonal_element(-multipliers[s] * u.weights[s]);
                by_edge(index, u, &block);
                by_edge(normal, u, &(block * self.lean));
            }
        }
        if self.directions == 1 {
            // t_2 = m x t_1.
            for u in neighbours {
                by_edge(index, u, &(self.mean.cross_matrix() * (-multipliers[1] * u.weights[0])));
                let turn = self.normal.cross_matrix() * (multipliers[1] * u.weights[0].abs());
                neighbours.iter().for_each(|w| by_edge(first + u.normal as usize, w, &(turn * w.weights[0])));
            }
            for u in neighbours {
                let turn = self.along[0].cross_matrix() * (multipliers[1] * u.weights[0].abs());
                hessian.add_pair(index, first + u.normal as usize, &turn);
            }
        }
    }
}
