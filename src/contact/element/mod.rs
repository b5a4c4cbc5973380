//! The contact element of one slave node and its master: residual and tangent.
//!
//! The slave node has the residual F of [`super::law`], the multiplier -(λ - F), and each node of the master -W_j^T F. The
//! multiplier's unknown is λ' = λ / ε_n, a length, so that every block of the tangent is of the size of ε_n and every
//! residual is a force. Without friction one multiplier λ_n a node suffices.
//!
//! - A rigid tool is a master of one node, its translation, with the weight 1: only the place relative to it matters. With
//!   N = ∂n/∂x, which has the curvature of the surface, and ∂g/∂x = n, the closest point moves by ∂x̄/∂x = 1 - nn - gN.
//!   One that a torque turns about the axis a through p has a second node, of which only the first component counts: the
//!   angle times a length L. The slave node's way on the tool by it is -w, w = a x (x - p)/L, and n, the path Δ and what is
//!   carried turn with v = a/L. The moment of the contact force about the axis, over L, is w·F:
//!
//! ```text
//!     dg = -n·w dq,   dn = (v x n - N w) dq,   dΔ = (v x Δ - (1 - nn - gN) w) dq
//!     d(w·F) = w·dF + (F x v)·(dx - dp)
//! ```
//!
//! - The patch of a deformable master has the nodes of its stencil, with the weights W_j of the [`Transfer`]. With the
//!   variational ones, and without friction, all of it derives from a potential, and the exact tangent is symmetric; with
//!   the others it is not. The tangent has the motion of the closest point and of the normal, from `motion`, the change of
//!   the weights as the closest point moves and as the patch changes its shape, and the motion of the slip origin with the
//!   patch that it is on.
//!
//! ```text
//!     dF = F,g dg + F,n dn + F,Δ d(x̄ - x̃) + F,λ dλ       d(-W_j^T F) = -W_j^T dF - (dW_j)^T F
//! ```
//!
//! From segment to segment the slave node meets the master in many points, and the element has the other nodes of its faces,
//! too: `spread`, with the sums of `run`. From node to node it stays on a corner of the patch: `corner`.
//!
//! Geometry always has the full dependence on the nodes, whatever the transfer. A tangential force that is held is carried
//! along by the tool, or by the patch of the slip origin: its components stand still in the frame of the tangents and the
//! normal there. From node to node it turns with the corner.

mod corner;
mod motion;
mod run;
mod spread;
#[cfg(test)]
mod tests_on_patches;
#[cfg(test)]
mod tests_on_spread;
#[cfg(test)]
mod tests_on_tools;

use super::law::{self, Guide, Kinematics, Law, Multiplier, Response, Slopes, Status};
use super::method::Tangent;
use super::pose::Axle;
use crate::surface::moving::{MovingPatch, Transfer, Variation};
use crate::surface::{Local, Projection};
use crate::{Mat3, Vec3};
pub use corner::Corner;
use motion::{Motion, Part};
pub use spread::{Bed, Portion, Spread};

/// A point that moves with a patch.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    pub patch: &'a MovingPatch,
    /// Which nodes of the master `patch.nodes` are.
    pub stencil: &'a [u32],
    /// Of `patch.nodes`, at the current iterate.
    pub positions: &'a [Vec3],
    pub xi: [f64; 2],
}

/// What a slave node meets.
#[derive(Clone, Copy, Debug)]
pub enum Opposite<'a> {
    /// A rigid tool, turned so far from its frame, and the axis about which a torque turns it; its node 0 is its translation,
    /// its node 1 that rotation.
    Tool(Mat3, Option<Axle>),
    /// The patch with the closest point.
    Patch(Site<'a>),
}

/// Where slip is measured from.
#[derive(Clone, Copy, Debug)]
pub enum Origin<'a> {
    /// The contact point of the last converged increment, on the patch that it was on.
    Carried(Site<'a>),
    /// A place in space. On a tool that point as the tool has carried it; on a patch, for a node that was out of reach then,
    /// where the node itself was.
    Fixed(Vec3),
    /// A place beside the corner of the patch on which the foot is held, as that has turned.
    Beside(Vec3, &'a Corner),
}

/// Where a slave node meets the master.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'a> {
    /// Onto what it meets as that is at the current iterate.
    pub projection: &'a Projection,
    pub opposite: Opposite<'a>,
    pub origin: Origin<'a>,
    /// With a multiplier that is held, a part of λ_t in the frame of the tool, or the [`frame`] at the slip origin; beside a corner
    /// as it was before that turned.
    pub carried: Vec3,
}

/// A multiplier with the part of a held λ_t that the master carries along.
fn with_carried(multiplier: &Multiplier, carried: Vec3) -> Multiplier {
    match *multiplier {
        Multiplier::Held { gap, tangential, force } => {
            Multiplier::Held { gap, tangential: tangential + carried, force }
        }
        unknown => unknown,
    }
}

/// Tangents and unit normal of a patch, as columns.
pub fn frame(local: &Local) -> Mat3 {
    Mat3::from_columns(&[local.tangents[0], local.tangents[1], local.area_vector().normalize()])
}

/// What the element does with a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    pub law: Law,
    pub transfer: Transfer,
    pub tangent: Tangent,
}

/// The element, with buffers to be reused from one slave node to the next. In the gap it has no master nodes.
#[derive(Clone, Debug, Default)]
pub struct Element {
    /// Which nodes of the master: the tool's, or those of the current patch, which have residuals and rows, then others of
    /// the patch of the slip origin, which have columns only.
    pub nodes: Vec<u32>,
    /// Residuals -W_j^T F of the nodes with rows.
    pub forces: Vec<Vec3>,
    /// Residual of the slave node.
    pub own: Vec3,
    /// Other nodes of the slave, with their residuals.
    pub beside: Vec<u32>,
    pub beside_forces: Vec<Vec3>,
    /// Rows: slave 3, multiplier or local unknown 3 (1 without friction), each of `beside` and of `forces` 3. Columns: slave,
    /// λ' = λ / ε_n, each of `beside` and of `nodes`. A local unknown is eliminated from all rows but its own. Row by row. Rows and columns of what a guide holds mean nothing.
    pub matrix: Vec<f64>,
    /// Rows and columns of `matrix`.
    pub shape: [usize; 2],
    at_foot: Variation,
    at_origin: Variation,
    columns: Vec<Column>,
    weights: Vec<Weight>,
    sums: run::Sums,
}

/// What changes with a node: dF, the residual of the multiplier and, along the free parameters, dξ (rows).
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    force: Mat3,
    constraint: Mat3,
    parameters: [Vec3; 2],
}

impl Column {
    /// Of what moves so with the node.
    fn new(response: &Response, part: &Part) -> Self {
        let change = |by: &Slopes| by.gap * part.gap.transpose() + by.normal * part.normal + by.path * part.point;
        Self {
            force: change(&response.force_by),
            constraint: change(&response.constraint_by),
            parameters: part.parameters,
        }
    }
}

/// W_i^T and the derivatives of W_i^T F by the free parameters.
#[derive(Clone, Copy, Debug)]
struct Weight {
    transposed: Mat3,
    slopes: [Vec3; 2],
    /// The derivative of W_i^T F by the place of the slave node relative to the first node of the master, besides.
    by_place: Mat3,
}

impl Weight {
    fn constant(transposed: Mat3) -> Self {
        Self { transposed, slopes: [Vec3::zeros(); 2], by_place: Mat3::zeros() }
    }
}

impl Site<'_> {
    fn frame(&self) -> Mat3 {
        frame(&self.patch.shape(self.positions).local(self.xi))
    }
}

impl Opposite<'_> {
    fn frame(&self) -> Mat3 {
        match self {
            Self::Tool(turn, _) => *turn,
            Self::Patch(site) => site.frame(),
        }
    }
}

impl Contact<'_> {
    fn place(&self) -> Kinematics {
        let p = self.projection;
        let origin = match &self.origin {
            Origin::Carried(site) => site.patch.shape(site.positions).point(site.xi),
            Origin::Fixed(point) | Origin::Beside(point, _) => *point,
        };
        Kinematics { gap: p.gap, normal: p.normal, point: p.point, origin }
    }

    fn carried(&self) -> Vec3 {
        match &self.origin {
            Origin::Carried(site) => site.frame() * self.carried,
            Origin::Fixed(_) => self.opposite.frame() * self.carried,
            Origin::Beside(_, corner) => corner.turn * self.carried,
        }
    }
}

impl Element {
    /// The response of the slave node. Fills `nodes` and `forces`.
    pub fn residual(
        &mut self,
        method: &Method,
        multiplier: &Multiplier,
        contact: Option<&Contact>,
        guide: &Guide,
    ) -> Response {
        let place = contact.map(Contact::place);
        let carried = contact.filter(|c| c.carried != Vec3::zeros()).map_or(Vec3::zeros(), Contact::carried);
        let response = law::respond(method.law, &with_carried(multiplier, carried), place.as_ref(), guide);
        self.spread(method.transfer, &response, contact);
        response
    }

    /// The response and the tangent. Fills all.
    pub fn tangent(
        &mut self,
        method: &Method,
        multiplier: &Multiplier,
        contact: Option<&Contact>,
        guide: &Guide,
    ) -> Response {
        let response = self.residual(method, multiplier, contact, guide);
        let width = if method.law.friction == 0.0 { 1 } else { 3 };
        self.assemble(method, width, &response, contact);
        if response.inverse != Mat3::zeros() {
            self.condense(width, &(response.inverse / method.law.normal));
        }
        response
    }

    /// Takes all nodes away.
    fn clear(&mut self) {
        self.nodes.clear();
        self.forces.clear();
        self.beside.clear();
        self.beside_forces.clear();
    }

    /// The forces on the master nodes.
    fn spread(&mut self, transfer: Transfer, response: &Response, contact: Option<&Contact>) {
        self.clear();
        self.own = response.load;
        let Some(contact) = contact.filter(|_| response.status != Status::Gap) else { return };
        match &contact.opposite {
            Opposite::Tool(_, axle) => {
                self.nodes.push(0);
                self.forces.push(-response.load);
                if let Some(axle) = axle {
                    self.nodes.push(1);
                    self.forces.push(Vec3::x() * -axle.velocity(&contact.projection.slave()).dot(&response.load));
                }
            }
            Opposite::Patch(site) => {
                site.patch.vary(site.positions, site.xi, &mut self.at_foot);
                self.nodes.extend_from_slice(site.stencil);
                let forces = self.at_foot.on_handles(&response.load);
                self.forces.extend((0..site.stencil.len()).map(|j| -self.at_foot.force_on(transfer, j, &forces)));
            }
        }
    }

    /// The tangent, after [`Self::spread`], with `width` multipliers.
    fn assemble(&mut self, method: &Method, width: usize, response: &Response, contact: Option<&Contact>) {
        let contact = contact.filter(|_| response.status != Status::Gap);
        let own = self.nodes.len();
        self.columns.clear();
        self.weights.clear();
        let mut bends = false;
        if let Some(contact) = contact {
            match (&contact.opposite, method.tangent) {
                (Opposite::Tool(_, axle), tangent) => self.rigid(tangent, response, (contact, axle.as_ref())),
                (Opposite::Patch(_), _) if let Origin::Beside(place, corner) = &contact.origin => {
                    self.held(method.transfer, response, contact, (place, corner));
                }
                (Opposite::Patch(site), Tangent::Exact) => {
                    bends = true;
                    self.exact(method.transfer, response, (contact, site));
                }
                (Opposite::Patch(_), Tangent::FixedFrame) => {
                    self.fixed_frame(method.transfer, response, contact.projection);
                }
            }
        }
        let (normal, first) = (method.law.normal, 3 + width);
        self.shape = [first + 3 * own, first + 3 * self.nodes.len()];
        self.matrix.clear();
        self.matrix.resize(self.shape[0] * self.shape[1], 0.0);
        let by_multiplier = response.force_by.multiplier * normal;
        self.set(3, 3, [width; 2], &(response.constraint_by.multiplier * normal));
        self.set(0, 3, [3, width], &by_multiplier);
        for c in 0..self.columns.len() {
            let Column { force, constraint, .. } = self.columns[c];
            let column = if c == 0 { 0 } else { first + 3 * (c - 1) };
            self.set(0, column, [3, 3], &force);
            self.set(3, column, [width, 3], &constraint);
        }
        for i in 0..own {
            let Weight { transposed, slopes, by_place } = self.weights[i];
            let row = first + 3 * i;
            self.set(row, 3, [3, width], &-(transposed * by_multiplier));
            for c in 0..self.columns.len() {
                let Column { force, parameters, .. } = self.columns[c];
                let mut block = transposed * force;
                for (slope, parameter) in slopes.iter().zip(&parameters) {
                    block += slope * parameter.transpose();
                }
                if c < 2 {
                    block += by_place * if c == 0 { 1.0 } else { -1.0 };
                }
                if bends && (1..=own).contains(&c) {
                    block += self.at_foot.second(i, c - 1);
                }
                let column = if c == 0 { 0 } else { first + 3 * (c - 1) };
                self.set(row, column, [3, 3], &-block);
            }
        }
    }

    /// Eliminates a local unknown from the other rows; its own stay. `inverse` is that of its block, for λ'.
    fn condense(&mut self, width: usize, inverse: &Mat3) {
        let columns = self.shape[1];
        let (own, after) = (3 * columns, (3 + width) * columns);
        let (before, rest) = self.matrix.split_at_mut(own);
        let (local, rest) = rest.split_at_mut(after - own);
        for row in before.chunks_mut(columns).chain(rest.chunks_mut(columns)) {
            let coupling = Vec3::from_fn(|k, _| if k < width { row[3 + k] } else { 0.0 });
            let solved = inverse.tr_mul(&coupling);
            for c in (0..3).chain(3 + width..columns) {
                row[c] -= (0..width).map(|k| solved[k] * local[k * columns + c]).sum::<f64>();
            }
        }
    }

    /// The derivative of the residual of the multiplier by the slave node, or by one of `beside` and then `nodes`, in the matrix.
    pub fn constraint_by(&self, node: Option<usize>, friction: f64) -> Mat3 {
        let width = if friction == 0.0 { 1 } else { 3 };
        let first = node.map_or(0, |j| 3 + width + 3 * j);
        Mat3::from_fn(|i, j| if i < width { self.matrix[(3 + i) * self.shape[1] + first + j] } else { 0.0 })
    }

    /// Has the vector that begins with this row and column along other directions, the columns of `axes`.
    pub fn turn(&mut self, first: usize, axes: &Mat3) {
        let [rows, columns] = self.shape;
        for row in self.matrix.chunks_exact_mut(columns) {
            let turned = axes.tr_mul(&Vec3::from_column_slice(&row[first..first + 3]));
            row[first..first + 3].copy_from_slice(turned.as_slice());
        }
        for c in (0..columns).filter(|_| first < rows) {
            let turned = axes.tr_mul(&Vec3::from_fn(|i, _| self.matrix[(first + i) * columns + c]));
            (0..3).for_each(|i| self.matrix[(first + i) * columns + c] = turned[i]);
        }
    }

    /// Writes the first rows and columns of a block.
    fn set(&mut self, row: usize, column: usize, [rows, columns]: [usize; 2], block: &Mat3) {
        for i in 0..rows {
            let start = (row + i) * self.shape[1] + column;
            for j in 0..columns {
                self.matrix[start + j] = block[(i, j)];
            }
        }
    }

    /// Columns and weights of a tool, whose motion is the opposite of that of the slave node; with a fixed frame nothing but the
    /// tool's own rotation turns the normal, eqs. (68)-(70).
    fn rigid(&mut self, tangent: Tangent, response: &Response, (contact, axle): (&Contact, Option<&Axle>)) {
        let p = contact.projection;
        let turn = if tangent == Tangent::Exact { p.normal_gradient } else { Mat3::zeros() };
        // It does not change with the path along n.
        let by_position = |by: &Slopes| by.gap * p.normal.transpose() + by.path + (by.normal - by.path * p.gap) * turn;
        let [force, constraint] = [&response.force_by, &response.constraint_by].map(by_position);
        self.columns.push(Column { force, constraint, ..Column::default() });
        self.columns.push(Column { force: -force, constraint: -constraint, ..Column::default() });
        self.weights.push(Weight::constant(Mat3::identity()));
        let Some(axle) = axle else { return };
        let (x, seen) = (p.slave(), Projection { normal_gradient: turn, ..*p });
        let by_turn = Part::by_turn(&seen, &(p.point - contact.place().origin), (axle, &x));
        let Column { force, constraint, .. } = Column::new(response, &by_turn);
        let held = response.by_held * axle.turn().cross(&contact.carried()) * Vec3::x().transpose();
        self.columns.push(Column { force: force + held, constraint: constraint + held, ..Column::default() });
        let first_row = |v: &Vec3| Vec3::x() * v.transpose();
        let by_place = first_row(&response.load.cross(&axle.turn()));
        self.weights.push(Weight { by_place, ..Weight::constant(first_row(&axle.velocity(&x))) });
    }

    /// Columns and weights where the foot stays on a corner, which bears all: it turns with the nodes of the patch.
    fn held(&mut self, transfer: Transfer, response: &Response, contact: &Contact, (origin, corner): (&Vec3, &Corner)) {
        let turns = self.at_foot.normal_by(corner.rule);
        let motion = corner.motion(&contact.projection.slave(), origin);
        self.columns.push(Column::new(response, &motion.of_slave()));
        let carried = response.by_held * contact.carried().cross_matrix();
        for (j, normal) in turns.iter().enumerate() {
            let (part, turn) = motion.of_node(j, normal);
            let Column { force, constraint, .. } = Column::new(response, &part);
            let held = carried * turn;
            self.columns.push(Column { force: force - held, constraint: constraint - held, ..Column::default() });
            self.weights.push(Weight::constant(self.at_foot.weight(transfer, j)[0].transpose()));
        }
    }

    /// Columns and weights of the exact tangent; adds the nodes of the slip origin's patch.
    fn exact(&mut self, transfer: Transfer, response: &Response, (contact, foot): (&Contact, &Site)) {
        let Response { force, force_by, constraint_by, .. } = response;
        let (patch, own) = (foot.patch, foot.stencil.len());
        let motion = Motion::new(&patch.straight(foot.positions), &self.at_foot.local, contact.projection);
        patch.bend(transfer, &self.at_foot.on_handles(force), &mut self.at_foot);
        self.columns.push(Column::new(response, &motion.of_slave()));
        for j in 0..own {
            self.columns.push(Column::new(response, &motion.of_node(&self.at_foot.by_node(j))));
            let [weight, by_e, by_z] = self.at_foot.weight(transfer, j).map(|w| w.transpose());
            let slopes = motion.directions.map(|[e, z]| (by_e * e + by_z * z) * force);
            self.weights.push(Weight { slopes, ..Weight::constant(weight) });
        }
        let Origin::Carried(site) = &contact.origin else { return };
        if constraint_by.path == Mat3::zeros() && contact.carried == Vec3::zeros() {
            return;
        }
        site.patch.vary(site.positions, site.xi, &mut self.at_origin);
        let frame = frame(&self.at_origin.local);
        let dual = frame.try_inverse().map_or(Mat3::zeros(), |inverse| inverse.transpose());
        for (j, node) in site.stencil.iter().enumerate() {
            let place = self.nodes.iter().position(|n| n == node).unwrap_or_else(|| {
                self.nodes.push(*node);
                self.columns.push(Column::default());
                self.nodes.len() - 1
            });
            let [point, by_e, by_z] = self.at_origin.by_node(j);
            let column = &mut self.columns[1 + place];
            column.force -= force_by.path * point;
            column.constraint -= constraint_by.path * point;
            if contact.carried != Vec3::zeros() {
                let n = frame.column(2);
                let turn = dual.column(0) * by_e.tr_mul(&n).transpose() + dual.column(1) * by_z.tr_mul(&n).transpose();
                let carried = by_e * contact.carried.x + by_z * contact.carried.y - turn * contact.carried.z;
                column.force += response.by_held * carried;
                column.constraint += response.by_held * carried;
            }
        }
    }

    /// Columns and weights of a patch with normal, weights and slip origin at rest: only the distance from x to x̄ changes.
    fn fixed_frame(&mut self, transfer: Transfer, response: &Response, projection: &Projection) {
        let n = projection.normal;
        let [apart, parting] = [&response.force_by, &response.constraint_by].map(|by| by.gap * n.transpose() + by.path);
        self.columns.push(Column { force: apart, constraint: parting, ..Column::default() });
        for j in 0..self.forces.len() {
            let weight = self.at_foot.weight(transfer, j)[0];
            let (force, constraint) = (-apart * weight, -parting * weight);
            self.columns.push(Column { force, constraint, ..Column::default() });
            self.weights.push(Weight::constant(weight.transpose()));
        }
    }
}
