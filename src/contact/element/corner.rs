//! A corner x_m of a patch that a slave node meets for good: how it has turned since the last converged increment, and how gap,
//! normal and slip move with the nodes.
//!
//! It turns as its nodal normal n does, and about n as the edges e_j from it to the nodes that n follows do, in the mean. With
//! dashes for the last converged increment, t' any unit vector across n', and e_j' = a_j t' + b_j n' x t' + ...,
//!
//! ```text
//!     d = sum a_j e_j - n x sum b_j e_j        t along d_t = (I - nn) d        R = (t, n x t, n) (t', n' x t', n')^T
//! ```
//!
//! is the rotation in the surface that takes the e_j' nearest to the e_j in least squares. It depends neither on t' nor on how facets
//! are ordered, and of a mirror image it is the mirror image. Of a node whose edges go on in their mirror images d is the direction
//! across the plane of symmetry.
//!
//! Slip counts from x̃ = x_m + r, r = R (x_s' - x_m'):
//!
//! ```text
//!     dg = n·(dx - dx_m) + (x - x_m)·dn        ω = n × dn + n (n × t)·(dd - (n·d) dn)/|d_t|
//!     d(x̄ - x̃) = dx - dx_m - n dg - g dn - ω × r
//! ```

use super::motion::Part;
use crate::surface::moving::{MovingPatch, NormalRule};
use crate::{Mat3, Vec3};

/// How a corner stands and has turned.
#[derive(Clone, Debug)]
pub struct Corner {
    pub place: Vec3,
    pub normal: Vec3,
    /// R.
    pub turn: Mat3,
    /// Number of its normal among those of the patch.
    pub rule: usize,
    /// Which nodes of the patch are x_m and the others, with their a and b.
    node: usize,
    spokes: Vec<(usize, [f64; 2])>,
    /// d, and the sum of b e.
    mean: Vec3,
    across: Vec3,
}

impl Corner {
    /// A corner of a patch with nodes at `positions` that were at `before`; none without area around it, or of a facet.
    pub fn new(patch: &MovingPatch, corner: usize, [before, positions]: [&[Vec3]; 2]) -> Option<Self> {
        let rule = patch.corners[corner] as usize;
        let [then, normal] = [patch.normal(before, corner)?, patch.normal(positions, corner)?];
        let edge = |x: &[Vec3], j: usize| x[j] - x[corner];
        let (along, nodes) = match patch.normals.get(rule)? {
            NormalRule::Mean { within: Some(within), .. } => (out_of(within), Vec::new()),
            NormalRule::Mean { spokes, .. } => (edge(before, spokes[0] as usize), spokes.clone()),
            NormalRule::End { neighbours, .. } => {
                (edge(before, neighbours[0].node as usize), neighbours.iter().map(|u| u.node).collect())
            }
        };
        let before_that = frame(&along, &then)?;
        let parts = |j: usize| before_that.tr_mul(&edge(before, j));
        let spokes: Vec<_> = nodes.iter().map(|&j| (j as usize, parts(j as usize).xy().into())).collect();
        let sum =
            |of: usize| spokes.iter().map(|(j, parts): &(_, [f64; 2])| edge(positions, *j) * parts[of]).sum::<Vec3>();
        let across = sum(1);
        let mean = if spokes.is_empty() { along } else { sum(0) - normal.cross(&across) };
        let turn = frame(&mean, &normal)? * before_that.transpose();
        Some(Self { place: positions[corner], normal, turn, rule, node: corner, spokes, mean, across })
    }

    /// How things move with the slave node at `x`, whose slip counts from `origin`.
    pub fn motion<'a>(&'a self, x: &Vec3, origin: &Vec3) -> Motion<'a> {
        let (n, d) = (self.normal, self.mean);
        let lean = n.dot(&d);
        let along = d - n * lean;
        let (away, start) = (x - self.place, origin - self.place);
        Motion { corner: self, gap: n.dot(&away), away, start, spin: n.cross(&along) / along.norm_squared(), lean }
    }
}

/// What moves with a slave node, or a node of the patch.
#[derive(Clone, Debug)]
pub struct Motion<'a> {
    corner: &'a Corner,
    gap: f64,
    /// x - x_m, r, (n × t)/|d_t|, and n·d.
    away: Vec3,
    start: Vec3,
    spin: Vec3,
    lean: f64,
}

impl Motion<'_> {
    /// With the slave node: the point of a part is x̄ - x̃.
    pub fn of_slave(&self) -> Part {
        self.part(Mat3::identity(), &Mat3::zeros(), &Mat3::zeros()).0
    }

    /// With node j of the patch, of which n has the derivative `normal`: the part, and ω.
    pub fn of_node(&self, j: usize, normal: &Mat3) -> (Part, Mat3) {
        let Corner { node, spokes, across, normal: n, .. } = self.corner;
        let moves = |k: &usize| f64::from(u8::from(*k == j));
        let here = moves(node);
        let mut mean = across.cross_matrix() * normal;
        for (k, [a, b]) in spokes {
            let edge = moves(k) - here;
            mean += Mat3::from_diagonal_element(a * edge) - n.cross_matrix() * (b * edge);
        }
        self.part(Mat3::from_diagonal_element(-here), normal, &mean)
    }

    /// From dx - dx_m, dn and dd.
    fn part(&self, relative: Mat3, normal: &Mat3, mean: &Mat3) -> (Part, Mat3) {
        let n = &self.corner.normal;
        let gap = relative.tr_mul(n) + normal.tr_mul(&self.away);
        let spins = mean.tr_mul(&self.spin) - normal.tr_mul(&self.spin) * self.lean;
        let turn = n.cross_matrix() * normal + n * spins.transpose();
        let point = relative - n * gap.transpose() - normal * self.gap + self.start.cross_matrix() * turn;
        (Part { point, gap, normal: *normal, parameters: [Vec3::zeros(); 2] }, turn)
    }
}

/// The unit vectors along what is across `normal` of `along`, across both, and of the normal, as columns.
fn frame(along: &Vec3, normal: &Vec3) -> Option<Mat3> {
    let along = (along - normal * normal.dot(along)).try_normalize(f64::MIN_POSITIVE)?;
    Some(Mat3::from_columns(&[along, normal.cross(&along), *normal]))
}

/// A direction that the projector `within` takes away.
fn out_of(within: &Mat3) -> Vec3 {
    let rest = Mat3::identity() - within;
    rest.column(rest.diagonal().imax()).into()
}
