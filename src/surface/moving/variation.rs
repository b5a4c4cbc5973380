//! Derivatives of a moving patch at points of it, by the positions of its nodes.
//!
//! The patch is linear in its handles y, which are its corners and the coefficients of its edges; the coefficients depend on the
//! own nodes and on the nodal normals, and each normal on nodes and on normals before it:
//!
//! ```text
//!     P(xi) = sum_h phi_h(xi) y_h,     y = (x_0 .. x_3, c_0 .. c_3, m),     phi = (w_0 .. w_3, -b_0 .. -b_4)
//! ```
//!
//! The chain rule is applied from the last normal to the first: what has been differentiated by a normal is handed on to what
//! that normal directly depends on. With first derivatives C_a of the coefficients, and second derivatives H_ab of sum_h f_h.y_h
//! for given forces f_h on the handles, by nodes and normals alike, a normal n with dn = sum_a J_a da gives
//!
//! ```text
//!     C_a += C_n J_a        H_ab += J_a^T H_nb + H_an J_b + J_a^T H_nn J_b + sum_h f_h.C_n (d2n/da db)
//! ```
//!
//! All that depends on the place in the patch are the phi_h: forces F_q on points of it are f_h = sum_q phi_h(xi_q) F_q.

use super::super::smoothing::Transfer;
use super::edge;
use super::normal::State;
use super::{MovingPatch, QuadraticFace};
use crate::surface::{Local, Patch};
use crate::{Mat3, Vec3};

/// Corners, coefficients of edges, and that of the inside; triangles leave the last of either out.
pub const HANDLES: usize = 9;

/// The first handle that is a coefficient.
pub const EDGES: usize = 4;

/// Coefficients: of the edges, and of the inside.
pub const BENDS: usize = HANDLES - EDGES;

/// Most nodes that are a patch's own: those of a face of nine.
pub const OWN: usize = 9;

/// Coefficients that do not change.
const AT_REST: [Mat3; BENDS] = [Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0); BENDS];

/// What each node of a quadratic triangle is of the coefficients of its edges: c_k = 2 (x_i + x_j) - 4 m_k.
const OF_TRIANGLE: [[f64; BENDS]; 6] = [
    [2.0, 0.0, 2.0, 0.0, 0.0],
    [2.0, 2.0, 0.0, 0.0, 0.0],
    [0.0, 2.0, 2.0, 0.0, 0.0],
    [-4.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, -4.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, -4.0, 0.0, 0.0],
];

/// The same of the quarter at corner 0 of such a triangle, a quarter of those of its edges: its corners 0, 01 and 20, then nodes 1,
/// 2 and 12.
const OF_CORNER: [[f64; BENDS]; 6] = [
    [0.5, 0.0, 0.5, 0.0, 0.0],
    [-1.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0, 0.0],
    [0.5, 0.5, 0.0, 0.0, 0.0],
    [0.0, 0.5, 0.5, 0.0, 0.0],
    [0.0, -1.0, 0.0, 0.0, 0.0],
];

/// The same of the quarter between the middles, 01, 12 and 20, then nodes 0, 1 and 2: its edges are along 20, 01 and 12.
const OF_MIDDLE: [[f64; BENDS]; 6] = [
    [0.0, -1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0, 0.0, 0.0],
    [0.5, 0.5, 0.0, 0.0, 0.0],
    [0.0, 0.5, 0.5, 0.0, 0.0],
    [0.5, 0.0, 0.5, 0.0, 0.0],
];

/// The same of a quarter of a biquadratic face: half the second differences along its edges, and -1/4 of the mixed fourth one, at
/// half the distance of the face's corners. Corners of the quarter first; see [`MovingPatch::bend_as_quarter`].
const OF_QUARTER: [[f64; BENDS]; OWN] = [
    [0.5, 0.0, 0.0, 0.5, -0.25],
    [-1.0, 0.5, 0.0, 0.0, 0.5],
    [0.0, -1.0, -1.0, 0.0, -1.0],
    [0.0, 0.0, 0.5, -1.0, 0.5],
    [0.5, 0.0, 0.0, 0.0, -0.25],
    [0.0, 0.0, 0.0, 0.0, -0.25],
    [0.0, 0.0, 0.0, 0.5, -0.25],
    [0.0, 0.0, 0.5, 0.0, 0.5],
    [0.0, 0.5, 0.0, 0.0, 0.5],
];

/// The functions of the handles at a point, with their derivatives by xi.
pub type Functions = [[f64; 3]; HANDLES];

/// Derivatives of a patch by its nodes in the order of [`MovingPatch::nodes`]. Made by [`MovingPatch::vary`]; the buffers are used
/// again.
#[derive(Clone, Debug, Default)]
pub struct Variation {
    /// The patch at a point.
    pub local: Local,
    functions: Functions,
    state: State,
    links: Vec<Link>,
    coefficients: [Vec3; BENDS],
    /// Derivatives of the coefficients by the nodes, then by the normals.
    turns: Vec<[Mat3; BENDS]>,
    /// Those by the own nodes at fixed normals.
    direct: [[Mat3; BENDS]; OWN],
    /// How many nodes are corners, how many the patch's own, how many coefficients count, and whether it has their quadratic shape.
    corners: usize,
    own: usize,
    bends: usize,
    is_quadratic: bool,
    hessian: Hessian,
}

/// How a normal depends on what is before it: dn = outer sum J_a da. Nodes come before normals in the numbers a.
#[derive(Clone, Debug, Default)]
pub(super) struct Link {
    pub value: Vec3,
    /// Length before normalisation.
    pub size: f64,
    pub outer: Mat3,
    pub parts: Vec<(usize, Mat3)>,
}

impl MovingPatch {
    /// Derivatives of the patch with its nodes at `positions`, at the parameters `xi`.
    pub fn vary(&self, positions: &[Vec3], xi: [f64; 2], to: &mut Variation) {
        self.link(positions, to);
        to.functions = self.functions(xi);
        to.local = to.shape(self).local(xi);
    }

    /// Derivatives of the handles with the nodes at `positions`: all that [`Self::vary`] makes but what is of one point.
    pub fn link(&self, positions: &[Vec3], to: &mut Variation) {
        let (count, nodes) = (self.count as usize, self.nodes.len());
        to.state.positions.clear();
        to.state.positions.extend_from_slice(positions);
        to.state.normals.clear();
        to.links.resize_with(self.normals.len(), Link::default);
        for (rule, link) in self.normals.iter().zip(&mut to.links) {
            rule.link(&mut to.state, link);
            to.state.normals.push(link.value);
        }
        to.turns.clear();
        to.turns.resize(nodes + self.normals.len(), AT_REST);
        to.coefficients = self.through_middles(positions);
        for k in (0..count).filter(|k| self.is_curved(*k)) {
            let [i, j] = self.ends(k);
            let [m, n] = self.end_normals(k);
            let c = edge::derivatives(&(positions[j] - positions[i]), &to.state.normals[m], &to.state.normals[n]);
            to.coefficients[k] = c.value * self.bulge;
            to.turns[i][k] -= c.by_chord * self.bulge;
            to.turns[j][k] += c.by_chord * self.bulge;
            to.turns[nodes + m][k] += c.by_normals[0] * self.bulge;
            to.turns[nodes + n][k] += c.by_normals[1] * self.bulge;
        }
        for (turns, shares) in to.turns.iter_mut().zip(self.shares()) {
            turns.iter_mut().zip(shares).for_each(|(t, share)| *t += Mat3::from_diagonal_element(share * self.bulge));
        }
        (to.corners, to.own, to.is_quadratic) = (count, self.own(), self.quadratic.is_some());
        to.bends = if to.own == OWN { BENDS } else { count };
        to.direct[..to.own].copy_from_slice(&to.turns[..to.own]);
        for (l, link) in to.links.iter().enumerate().rev() {
            for k in 0..count {
                let turn = to.turns[nodes + l][k];
                if turn != Mat3::zeros() {
                    let turn = turn * link.outer;
                    link.parts.iter().for_each(|(a, part)| to.turns[*a][k] += turn * part);
                }
            }
        }
    }

    /// The functions of the handles at a point.
    pub fn functions(&self, xi: [f64; 2]) -> Functions {
        let (weights, bubbles) = polynomials(self.count, xi);
        std::array::from_fn(|h| if h < EDGES { weights[h] } else { bubbles[h - EDGES].map(|b| -b) })
    }

    /// The second derivatives d(W_j^T F)/dx_k of the forces on the nodes at fixed `forces` on the handles, for
    /// [`Variation::second`], where `variation` is of this patch.
    pub fn bend(&self, transfer: Transfer, forces: &[Vec3; HANDLES], variation: &mut Variation) {
        let v = variation;
        let nodes = self.nodes.len();
        let hessian = &mut v.hessian;
        hessian.clear(nodes + self.normals.len());
        if transfer == Transfer::Bilinear {
            return;
        }
        let on_coefficients = &forces[EDGES..];
        for k in (0..self.count as usize).filter(|k| self.is_curved(*k)) {
            let [i, j] = self.ends(k);
            let normals = self.end_normals(k);
            let [m, n] = normals.map(|l| nodes + l);
            let d = v.state.positions[j] - v.state.positions[i];
            let force = on_coefficients[k] * self.bulge;
            let b = edge::bending(&d, &v.state.normals[normals[0]], &v.state.normals[normals[1]], &force);
            for (end, by) in [m, n].into_iter().zip(&b.chord_normals) {
                hessian.add_pair(j, end, by);
                hessian.add_pair(i, end, &-by);
            }
            hessian.add_diagonal(m, &b.normals[0]);
            hessian.add_diagonal(n, &b.normals[1]);
            hessian.add_pair(m, n, &b.mixed);
        }
        for (l, link) in v.links.iter().enumerate().rev() {
            let index = nodes + l;
            if transfer == Transfer::Patch {
                hessian.eliminate_columns(index, self.count as usize, link);
            } else {
                let g: Vec3 = v.turns[index].iter().zip(on_coefficients).map(|(turn, f)| turn.tr_mul(f)).sum();
                self.normals[l].bend(index, &mut v.state, link, &g, hessian);
                hessian.eliminate(index, &link.parts);
            }
        }
    }

    /// The patch at `positions` with straight edges.
    pub fn straight(&self, positions: &[Vec3]) -> Patch {
        Patch {
            id: self.id,
            count: self.count,
            nodes: std::array::from_fn(|k| positions[k % self.count as usize]),
            coefficients: [Vec3::zeros(); 4],
            middle: Vec3::zeros(),
            edges: self.edges,
            on_boundary: self.on_boundary,
            deviation: 0.0,
        }
    }

    /// What each own node is of the coefficients of a quadratic face; nothing of others.
    fn shares(&self) -> &'static [[f64; BENDS]] {
        match self.quadratic {
            None => &[],
            Some(QuadraticFace::Triangle) => &OF_TRIANGLE,
            Some(QuadraticFace::CornerOfSix) => &OF_CORNER,
            Some(QuadraticFace::MiddleOfSix) => &OF_MIDDLE,
            Some(QuadraticFace::QuarterOfNine) => &OF_QUARTER,
        }
    }

    /// The coefficients of a quadratic face; zero of others.
    pub(super) fn through_middles(&self, positions: &[Vec3]) -> [Vec3; BENDS] {
        let of = |k: usize| self.shares().iter().zip(positions).map(|(shares, x)| x * (shares[k] * self.bulge)).sum();
        std::array::from_fn(of)
    }

    /// The shape functions of the own nodes at a point, of a quadratic face the quadratic ones; the others are none.
    pub fn shape_functions(&self, xi: [f64; 2]) -> [f64; OWN] {
        let functions = self.functions(xi).map(|[phi, ..]| phi);
        let corner = |j: usize| if j < self.count as usize { functions[j] } else { 0.0 };
        let bent = |shares: &[f64; BENDS]| shares.iter().zip(&functions[EDGES..]).map(|(s, f)| s * f).sum::<f64>();
        std::array::from_fn(|j| corner(j) + self.shares().get(j).map_or(0.0, bent) * self.bulge)
    }

    pub(super) fn is_curved(&self, k: usize) -> bool {
        !self.normals.is_empty() && !self.straight[k]
    }

    /// Nodes at the ends of edge k.
    pub(super) fn ends(&self, k: usize) -> [usize; 2] {
        [k, (k + 1) % self.count as usize]
    }

    /// Normals at the ends of edge k.
    pub(super) fn end_normals(&self, k: usize) -> [usize; 2] {
        self.ends(k).map(|i| self.corners[i] as usize)
    }
}

impl Variation {
    /// The patch.
    pub fn shape(&self, patch: &MovingPatch) -> Patch {
        let [c0, c1, c2, c3, middle] = self.coefficients;
        Patch { coefficients: [c0, c1, c2, c3], middle, ..patch.straight(&self.state.positions) }
    }

    /// Derivatives by node j of P, tau_1 and tau_2, at fixed xi.
    pub fn by_node(&self, j: usize) -> [Mat3; 3] {
        self.rows(j, self.turns(j))
    }

    /// W_j and its derivatives by xi.
    pub fn weight(&self, transfer: Transfer, j: usize) -> [Mat3; 3] {
        self.rows(j, self.bearing(transfer, j))
    }

    fn rows(&self, j: usize, turns: &[Mat3]) -> [Mat3; 3] {
        std::array::from_fn(|d| self.combined(j, turns, |h| self.functions[h][d]))
    }

    /// The derivative by node j of what is so linear in the handles, whose coefficients change as `turns` say.
    fn combined(&self, j: usize, turns: &[Mat3], phi: impl Fn(usize) -> f64) -> Mat3 {
        let own = Mat3::from_diagonal_element(if j < self.corners { phi(j) } else { 0.0 });
        turns.iter().zip(EDGES..).fold(own, |sum, (turn, h)| sum + turn * phi(h))
    }

    /// The derivative by node j of the sum of the handles times these.
    pub fn by_node_of(&self, j: usize, functions: &[f64; HANDLES]) -> Mat3 {
        self.combined(j, self.turns(j), |h| functions[h])
    }

    /// What a force at the point is on the handles.
    pub fn on_handles(&self, force: &Vec3) -> [Vec3; HANDLES] {
        self.functions.map(|[phi, ..]| force * phi)
    }

    /// How many nodes are corners, and so handles of their own.
    pub fn corners(&self) -> usize {
        self.corners
    }

    /// dc_k/dx_j, and dm/dx_j of what has an m.
    pub fn turns(&self, j: usize) -> &[Mat3] {
        &self.turns[j][..self.bends]
    }

    /// dn_l/dx_j of a normal by the nodes.
    pub fn normal_by(&self, l: usize) -> Vec<Mat3> {
        let nodes = self.state.positions.len();
        let mut turns = vec![Mat3::zeros(); nodes + self.links.len()];
        turns[nodes + l] = Mat3::identity();
        for (k, link) in self.links.iter().enumerate().take(l + 1).rev() {
            let turn = turns[nodes + k] * link.outer;
            link.parts.iter().for_each(|(a, part)| turns[*a] += turn * part);
        }
        turns.truncate(nodes);
        turns
    }

    /// What takes the place of dc_k/dx_j in the weights W_j.
    pub fn bearing(&self, transfer: Transfer, j: usize) -> &[Mat3] {
        let all = match transfer {
            // On a quadratic face linear weights would not be in balance with an even pressure.
            _ if self.is_quadratic => &self.turns[j],
            Transfer::Variational => &self.turns[j],
            Transfer::Patch if j < self.own => &self.direct[j],
            _ => &AT_REST,
        };
        &all[..self.bends]
    }

    /// W_j^T F of forces on the handles.
    pub fn force_on(&self, transfer: Transfer, j: usize, forces: &[Vec3; HANDLES]) -> Vec3 {
        let own = if j < self.corners { forces[j] } else { Vec3::zeros() };
        self.bearing(transfer, j).iter().zip(&forces[EDGES..]).fold(own, |sum, (turn, f)| sum + turn.tr_mul(f))
    }

    /// d(W_j^T F)/dx_k for the transfer and forces of the last [`MovingPatch::bend`].
    pub fn second(&self, j: usize, k: usize) -> &Mat3 {
        self.hessian.get(j, k)
    }
}

/// For each node its weight w_i, for each edge, and the inside, the factor b_k of its coefficient, with derivatives by xi.
fn polynomials(count: u8, [e, z]: [f64; 2]) -> ([[f64; 3]; 4], [[f64; 3]; BENDS]) {
    let (f, y) = (1.0 - e, 1.0 - z);
    if count == 3 {
        let b = [[f, -1.0, 0.0], [e - z, 1.0, -1.0], [z, 0.0, 1.0], [0.0; 3]];
        let product = |i: usize, j: usize| {
            [b[i][0] * b[j][0], b[i][1] * b[j][0] + b[i][0] * b[j][1], b[i][2] * b[j][0] + b[i][0] * b[j][2]]
        };
        return (b, [product(0, 1), product(1, 2), product(2, 0), [0.0; 3], [0.0; 3]]);
    }
    let ((be, de), (bz, dz)) = ((e * f, f - e), (z * y, y - z));
    (
        [[f * y, -y, -f], [e * y, y, -e], [e * z, z, e], [f * z, -z, f]],
        [
            [be * y, de * y, -be],
            [bz * e, bz, dz * e],
            [be * z, de * z, be],
            [bz * f, -bz, dz * f],
            [be * bz, de * bz, be * dz],
        ],
    )
}

/// A symmetric matrix of blocks, by nodes and normals.
#[derive(Clone, Debug, Default)]
pub(super) struct Hessian {
    size: usize,
    blocks: Vec<Mat3>,
}

impl Hessian {
    fn clear(&mut self, size: usize) {
        self.size = size;
        self.blocks.clear();
        self.blocks.resize(size * size, Mat3::zeros());
    }

    fn get(&self, a: usize, b: usize) -> &Mat3 {
        &self.blocks[a * self.size + b]
    }

    fn get_mut(&mut self, a: usize, b: usize) -> &mut Mat3 {
        &mut self.blocks[a * self.size + b]
    }

    /// Adds a symmetric block on the diagonal.
    pub fn add_diagonal(&mut self, a: usize, block: &Mat3) {
        *self.get_mut(a, a) += block;
    }

    /// Adds a block and its transpose opposite.
    pub fn add_pair(&mut self, a: usize, b: usize, block: &Mat3) {
        *self.get_mut(a, b) += block;
        *self.get_mut(b, a) += block.transpose();
    }

    /// Replaces what `y` stands for: dy = `by` dz, `by` symmetric.
    pub fn transform(&mut self, y: usize, by: &Mat3) {
        for b in 0..y {
            if *self.get(y, b) != Mat3::zeros() {
                let block = by * self.get(y, b);
                *self.get_mut(y, b) = block;
                *self.get_mut(b, y) = block.transpose();
            }
        }
        *self.get_mut(y, y) = by * self.get(y, y) * by;
    }

    /// Hands the second derivatives by `y` on to what it depends on, all of it before `y`.
    fn eliminate(&mut self, y: usize, parts: &[(usize, Mat3)]) {
        for b in 0..y {
            let block = *self.get(y, b);
            if block != Mat3::zeros() {
                parts.iter().for_each(|(a, part)| self.add_pair(*a, b, &part.tr_mul(&block)));
            }
        }
        let own = *self.get(y, y);
        for (b, by_b) in parts {
            let product = own * by_b;
            parts.iter().for_each(|(a, by_a)| *self.get_mut(*a, *b) += by_a.tr_mul(&product));
        }
    }

    /// The same in the columns alone, for the first `rows` rows.
    fn eliminate_columns(&mut self, y: usize, rows: usize, link: &Link) {
        for row in 0..rows {
            let block = self.get(row, y) * link.outer;
            if block != Mat3::zeros() {
                link.parts.iter().for_each(|(a, part)| *self.get_mut(row, *a) += block * part);
            }
        }
    }
}
