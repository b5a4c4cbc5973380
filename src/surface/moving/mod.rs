//! Patches of a surface whose nodes move.
//!
//! What the surface looks like is decided once, on the initial mesh: which edges are sharp, which nodes are at its ends,
//! and by which rule each nodal normal follows from which nodes ([`normal`]). From then on a patch is a smooth function
//! of the positions of its own nodes and of the others that its normals depend on,
//!
//! ```text
//!     P(xi; x) = sum w_i(xi) x_i - beta sum b_k(xi) c_k,     c_k = c(d_k, n_k, n_k+1)
//! ```
//!
//! with the polynomials of [`super::patch`], the coefficients of [`edge`], d_k the vector along edge k, and the share beta
//! of the bulge that the patch takes.
//! [`variation`] has its derivatives.

pub mod edge;
mod frozen;
pub mod normal;
mod numbers;
#[cfg(test)]
mod tests;
pub mod variation;

pub use super::smoothing::Transfer;
pub use normal::{Neighbour, NormalRule};
pub use variation::Variation;

use super::patch::Patch;
use super::piece::Edge;
use super::smoothing::Smoothing;
use crate::Vec3;
use crate::controls::Controls;
use crate::error::Result;
use crate::mesh::Mesh;

/// A triangle, or a quadrilateral when `count` is 4, that moves with its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingPatch {
    /// The same on all ranks.
    pub id: u32,
    /// 3 or 4.
    pub count: u8,
    /// Global numbers: the patch's own nodes, counter-clockwise seen from outside, then the others that its normals
    /// depend on. Positions are given in this order.
    pub nodes: Vec<u64>,
    pub edges: [Edge; 4],
    /// Sharp edges, which are straight, and those in a plane of symmetry in which there is a crease: the surface ends there.
    pub straight: [bool; 4],
    /// Own nodes where the surface ends, though perhaps in an edge of another patch.
    pub on_boundary: [bool; 4],
    /// Index of the component of the mesh that it is on.
    pub component: u32,
    /// Nodal normals, each by those before it; empty for a facet.
    pub normals: Vec<NormalRule>,
    /// Which of `normals` the own nodes have.
    pub corners: [u32; 4],
    /// Share of the bulge of its edges, and of its inside, that it takes: 1, or less to be nearer to the facet.
    pub bulge: f64,
    /// What it has the shape of instead of being flat or smooth; nodes of that which are no corners come behind these.
    pub quadratic: Option<QuadraticFace>,
}

/// A face of second order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadraticFace {
    /// A triangle of six nodes.
    Triangle,
    /// A quarter at a corner of a triangle of six nodes.
    CornerOfSix,
    /// That between the middles of its edges.
    MiddleOfSix,
    /// A quarter of a quadrilateral of nine nodes.
    QuarterOfNine,
}

impl MovingPatch {
    /// The patches of the facets of `mesh`, numbered alike; `numbers` are the global numbers of its points, and in the
    /// `planes` (point, normal), which its nodes there do not leave, it goes on as its mirror image.
    ///
    /// Sharp edges, junctions and ends are those of [`super::patches_from_mesh`]. Sharp edges are straight. Fails when the
    /// facets do not make a surface, or do not end in a plane.
    pub fn all(
        mesh: &Mesh,
        numbers: &[u64],
        smoothing: Smoothing,
        feature_angle_deg: f64,
        planes: &[(Vec3, Vec3)],
        controls: &Controls,
    ) -> Result<Vec<Self>> {
        frozen::patches(mesh, numbers, smoothing, feature_angle_deg, planes, controls)
    }

    /// Gives a flat triangle the quadratic shape through the middles of its edges, too, by their global numbers. With m_k the
    /// middle of edge k from x_i to x_j
    ///
    /// ```text
    ///     c_k = 2 (x_i + x_j) - 4 m_k,     P = sum b_i (2 b_i - 1) x_i + sum 4 b_i b_j m_k
    /// ```
    pub fn bend_through(&mut self, middles: [u64; 3]) {
        self.nodes.extend(middles);
        self.quadratic = Some(QuadraticFace::Triangle);
    }

    /// Gives a flat facet the shape of the face of six or nine nodes that it is a quarter of, in the order of
    /// [`Quarters::of`](crate::mesh::Quarters::of), by their global numbers. The corner of the face becomes its first, of the
    /// quarter between the middles that on the first edge. With N of the nodes of the face, and s from 0 to 1 in it where the
    /// quarter has xi, at a corner xi/2,
    ///
    /// ```text
    ///     P(xi) = sum N_a(s) x_a
    /// ```
    pub fn bend_as_quarter(&mut self, whole: &[u64]) {
        let (first, others, face) = match *whole {
            [a, b, c, _, bc, _] if self.nodes.contains(&a) => (a, vec![b, c, bc], QuadraticFace::CornerOfSix),
            [a, b, c, ab, _, _] => (ab, vec![a, b, c], QuadraticFace::MiddleOfSix),
            [a, b, c, d, _, bc, cd, _, _] => (a, vec![b, c, d, bc, cd], QuadraticFace::QuarterOfNine),
            _ => return,
        };
        let first = self.nodes.iter().position(|&n| n == first).unwrap_or(0);
        let count = self.count as usize;
        self.nodes.rotate_left(first);
        self.edges[..count].rotate_left(first);
        self.straight[..count].rotate_left(first);
        self.on_boundary[..count].rotate_left(first);
        self.nodes.extend(others);
        self.quadratic = Some(face);
    }

    /// Nodes that are the patch's own; the others are those that its normals depend on.
    pub fn own(&self) -> usize {
        match self.quadratic {
            None => self.count as usize,
            Some(QuadraticFace::QuarterOfNine) => variation::OWN,
            Some(_) => 6,
        }
    }

    /// The nodal normal at a corner, with the nodes at `positions`; `None` of a facet, and where there is no area around the node.
    pub fn normal(&self, positions: &[Vec3], corner: usize) -> Option<Vec3> {
        self.nodal_normals(positions).get(self.corners[corner] as usize)?.try_normalize(f64::MIN_POSITIVE)
    }

    fn nodal_normals(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let mut normals = Vec::with_capacity(self.normals.len());
        for rule in &self.normals {
            normals.push(rule.value(positions, &normals));
        }
        normals
    }

    /// The patch with its nodes at `positions`.
    pub fn shape(&self, positions: &[Vec3]) -> Patch {
        let normals = self.nodal_normals(positions);
        let mut patch = self.straight(positions);
        if self.quadratic.is_some() {
            let [c0, c1, c2, c3, middle] = self.through_middles(positions);
            (patch.coefficients, patch.middle) = ([c0, c1, c2, c3], middle);
        }
        for k in (0..self.count as usize).filter(|k| self.is_curved(*k)) {
            let ([i, j], [m, n]) = (self.ends(k), self.end_normals(k));
            let c = edge::coefficient(&(positions[j] - positions[i]), &normals[m], &normals[n]);
            patch.coefficients[k] = c * self.bulge;
        }
        patch
    }
}
