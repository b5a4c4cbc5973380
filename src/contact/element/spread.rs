//! The element of a slave node that meets the master in the points of the faces around it, with their weights w_q: residual and
//! tangent.
//!
//! With gap, normal and path as the [means](super::super::segment) of those of the points, all of which move by
//! `motion`, the force F is that of the law, and the point q bears, linear in F,
//!
//! ```text
//!     f_q = w_q B_q F,   B_q = I + (n_q - n) n^T       R_a = Σ_q T_qa f_q,   T_qa = N_a I on the slave, -W_j^T on the master
//!
//!     dR_a = (Σ_q w_q T_qa B_q) dF + [Σ_q w_q T_qa ((n_q - n) F^T - F_n I)] dn + Σ_q w_q F_n T_qa dn_q + Σ_q dT_qa f_q
//! ```
//!
//! with F_n = F·n. The mean normal may have to have no component along directions that are held: with P the projector on the
//! others dn = (I - nn)/|P m| P dm, m = Σ w_q n_q.
//! A tangential force that is held goes with the tool; with a patch it stands still in the tangent. A torque turns a tool as in
//! the [module](super): its row is T_q = -e w_qᵀ, with e for the first component, and dT_q f_q = -e (f_q x v)·(dx_q - dp).
//!
//! The points of a node that is wedged in a hollow, which share its normal force as equilibrium and not as w_q has it, bear in
//! addition k w_q (g_q - g) n_q, which has the potential k/2 Σ w_q (g_q - g)² and no part in the normal force, for g is the mean gap:
//!
//! ```text
//!     dR_a += Σ_q T_qa n_q k w_q (dg_q - dg) + Σ_q k w_q (g_q - g) T_qa dn_q
//! ```
//!
//! The points of a face on one patch are summed as [`super::run`] does.

use super::motion::{Motion, Part};
use super::run::{Run, Sums, by_patch};
use super::{Element, Method, with_carried};
use crate::contact::law::{self, Guide, Kinematics, Multiplier, Response, Status};
use crate::contact::master::{Ground, SlipOrigin};
use crate::contact::pose::Axle;
use crate::surface::moving::variation::{HANDLES, Variation};
use crate::surface::{MovingPatch, Projection, Transfer};
use crate::{Mat3, Vec3};

/// Patches and where their nodes are.
pub trait Bed {
    /// A patch that moves with nodes, with which of these it has; a tool, whose node 0 is its translation, has none.
    fn patch(&self, id: u32) -> Option<(&MovingPatch, &[u32])>;
    fn position(&self, node: u32) -> Vec3;
    /// About which a torque turns the tool, whose node 1 is that rotation.
    fn axle(&self) -> Option<Axle>;
}

impl Bed for Ground<'_> {
    fn patch(&self, id: u32) -> Option<(&MovingPatch, &[u32])> {
        Ground::patch(self, id)
    }

    fn position(&self, node: u32) -> Vec3 {
        Ground::position(self, node)
    }

    fn axle(&self) -> Option<Axle> {
        match self {
            Ground::Tool(tool) => tool.trial.axle_in_space(),
            Ground::Surface(..) => None,
        }
    }
}

/// A point of a face, with its share in a slave node's contact.
#[derive(Clone, Copy, Debug)]
pub struct Portion<'a> {
    /// w_q.
    pub weight: f64,
    /// The nodes that move the face, and N_a.
    pub nodes: &'a [u32],
    pub shapes: &'a [f64],
    /// Where they put it.
    pub place: Vec3,
    pub at: &'a Projection,
    pub origin: SlipOrigin,
    /// Where that is.
    pub start: Vec3,
}

/// What a slave node meets.
#[derive(Clone, Copy, Debug)]
pub struct Spread<'a> {
    pub node: u32,
    pub portions: &'a [Portion<'a>],
    /// Gap and normal.
    pub gap: f64,
    pub normal: Vec3,
    /// P, the projector on the directions that the normal may have.
    pub free: Mat3,
    /// With a multiplier that is held, a part of λ_t, in space.
    pub carried: Vec3,
    /// k.
    pub wedge: f64,
}

impl Spread<'_> {
    fn place(&self) -> Kinematics {
        let mean = |of: &dyn Fn(&Portion) -> Vec3| self.portions.iter().map(|p| of(p) * p.weight).sum::<Vec3>();
        let (point, origin) = (mean(&|p| p.at.point), mean(&|p| p.start));
        Kinematics { gap: self.gap, normal: self.normal, point, origin }
    }

    /// k w_q (g_q - g).
    pub(super) fn wedged(&self, point: &Portion) -> f64 {
        self.wedge * point.weight * (point.at.gap - self.gap)
    }

    /// What the force along n_q changes by where the point moves so, of a given mean.
    pub(super) fn pressing(&self, point: &Portion, response: &Response, by: &Part) -> Mat3 {
        let (n, w) = (point.at.normal, point.weight);
        let normal_force = self.normal.dot(&response.force) * w + self.wedged(point);
        by.normal * normal_force + n * by.gap.transpose() * (self.wedge * w)
    }

    /// f_q.
    pub(super) fn bears(&self, point: &Portion, force: &Vec3) -> Vec3 {
        let share = force + (point.at.normal - self.normal) * self.normal.dot(force);
        share * point.weight + point.at.normal * self.wedged(point)
    }
}

/// Where a value stands in a list, in which it is put if need be.
fn index(list: &mut Vec<u32>, value: u32) -> usize {
    list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

impl Element {
    /// The response of the slave node, with what its points bear together for the force. Fills the nodes and their residuals.
    pub fn spread_residual(
        &mut self,
        method: &Method,
        multiplier: &Multiplier,
        (spread, bed): (Option<&Spread>, &dyn Bed),
        guide: &Guide,
    ) -> Response {
        let response = self.respond(method, multiplier, (spread, bed), guide);
        summed(response, spread)
    }

    /// The response and the tangent. Fills all.
    pub fn spread_tangent(
        &mut self,
        method: &Method,
        multiplier: &Multiplier,
        (spread, bed): (Option<&Spread>, &dyn Bed),
        guide: &Guide,
    ) -> Response {
        let response = self.respond(method, multiplier, (spread, bed), guide);
        let width = if method.law.friction == 0.0 { 1 } else { 3 };
        match spread.filter(|_| response.status != Status::Gap) {
            None => self.assemble(method, width, &response, None),
            Some(spread) => {
                self.add_points(method.transfer, &response, (spread, bed));
                self.assemble_points(method, width, &response, (spread, bed));
            }
        }
        if response.inverse != Mat3::zeros() {
            self.condense(width, &(response.inverse / method.law.normal));
        }
        summed(response, spread)
    }

    fn respond(
        &mut self,
        method: &Method,
        multiplier: &Multiplier,
        (spread, bed): (Option<&Spread>, &dyn Bed),
        guide: &Guide,
    ) -> Response {
        let (place, carried) = (spread.map(Spread::place), spread.map_or(Vec3::zeros(), |spread| spread.carried));
        let response = law::respond(method.law, &with_carried(multiplier, carried), place.as_ref(), guide);
        self.clear();
        self.own = Vec3::zeros();
        let Some(spread) = spread.filter(|_| response.status != Status::Gap) else { return response };
        for points in by_patch(spread.portions) {
            let with_patch = bed.patch(points[0].at.patch);
            let mut on_handles = [Vec3::zeros(); HANDLES];
            for point in points {
                let force = spread.bears(point, &response.load);
                for (node, shape) in point.nodes.iter().zip(point.shapes) {
                    let share = force * *shape;
                    if *node == spread.node {
                        self.own += share;
                        continue;
                    }
                    let k = index(&mut self.beside, *node);
                    self.beside_forces.resize(self.beside.len(), Vec3::zeros());
                    self.beside_forces[k] += share;
                }
                match with_patch {
                    None => on_handles[0] += force,
                    Some((patch, _)) => {
                        let functions = patch.functions(point.at.xi);
                        on_handles.iter_mut().zip(functions).for_each(|(sum, [phi, ..])| *sum += force * phi);
                    }
                }
            }
            let mut add = |node: u32, force: Vec3| {
                let k = index(&mut self.nodes, node);
                self.forces.resize(self.nodes.len(), Vec3::zeros());
                self.forces[k] -= force;
            };
            match with_patch {
                None => add(0, on_handles[0]),
                Some((patch, stencil)) => {
                    link(patch, stencil, bed, (&mut self.sums.positions, &mut self.at_foot));
                    for (j, &node) in stencil.iter().enumerate() {
                        add(node, self.at_foot.force_on(method.transfer, j, &on_handles));
                    }
                }
            }
        }
        if let Some(axle) = bed.axle() {
            let turns = |point: &Portion| axle.velocity(&point.place).dot(&spread.bears(point, &response.load));
            self.nodes.push(1);
            self.forces.push(Vec3::x() * -spread.portions.iter().map(turns).sum::<f64>());
        }
        response
    }

    /// The sums over the points.
    fn add_points(&mut self, transfer: Transfer, response: &Response, (spread, bed): (&Spread, &dyn Bed)) {
        let by_path = response.constraint_by.path != Mat3::zeros() || response.force_by.path != Mat3::zeros();
        let origins = spread.portions.iter().filter_map(|point| match point.origin {
            SlipOrigin::Carried(id, xi) if by_path => Some((point.weight, id, xi)),
            _ => None,
        });
        for (_, id, _) in origins.clone() {
            for node in bed.patch(id).iter().flat_map(|(_, stencil)| *stencil) {
                index(&mut self.nodes, *node);
            }
        }
        self.forces.resize(self.nodes.len(), Vec3::zeros());
        let slaves = 1 + self.beside.len();
        let count = slaves + self.nodes.len();
        let mut sums = std::mem::take(&mut self.sums);
        sums.clear(count);
        for points in by_patch(spread.portions) {
            self.add_run(transfer, response, (spread, points), bed, &mut sums);
        }
        // Where the path begins, by patch the sums of the functions.
        let mut starts: Vec<(u32, [f64; HANDLES])> = Vec::new();
        for (weight, id, xi) in origins {
            let Some((patch, _)) = bed.patch(id) else { continue };
            let at = starts.iter().position(|(other, _)| *other == id).unwrap_or_else(|| {
                starts.push((id, [0.0; HANDLES]));
                starts.len() - 1
            });
            starts[at].1.iter_mut().zip(patch.functions(xi)).for_each(|(sum, [phi, ..])| *sum += weight * phi);
        }
        for (id, functions) in &starts {
            let Some((patch, stencil)) = bed.patch(*id) else { continue };
            link(patch, stencil, bed, (&mut sums.positions, &mut self.at_origin));
            for (j, node) in stencil.iter().enumerate() {
                let k = slaves + index(&mut self.nodes, *node);
                sums.path[k] -= self.at_origin.by_node_of(j, functions);
            }
        }
        self.sums = sums;
    }

    /// Adds points of a face on a patch to the sums.
    fn add_run(
        &mut self,
        transfer: Transfer,
        response: &Response,
        (spread, points): (&Spread, &[Portion]),
        bed: &dyn Bed,
        sums: &mut Sums,
    ) {
        let slaves = 1 + self.beside.len();
        sums.places.clear();
        let mut run = Run::default();
        let mut of_patch = None;
        match bed.patch(points[0].at.patch) {
            None => {
                sums.places.push(slaves);
                points.iter().for_each(|point| run.add_on_tool((spread, point), response));
            }
            Some((patch, stencil)) => {
                let place = |node| slaves + self.nodes.iter().position(|n| n == node).unwrap_or_default();
                sums.places.extend(stencil.iter().map(place));
                link(patch, stencil, bed, (&mut sums.positions, &mut self.at_foot));
                let shape = self.at_foot.shape(patch);
                for point in points {
                    let motion = Motion::new(&shape, &shape.local(point.at.xi), point.at);
                    run.add_on_patch((spread, point), response, &motion, &patch.functions(point.at.xi));
                }
                patch.bend(transfer, &run.forces, &mut self.at_foot);
                of_patch = Some((&self.at_foot, transfer));
            }
        }
        sums.places.extend(points[0].nodes.iter().map(|node| match *node == spread.node {
            true => 0,
            false => 1 + self.beside.iter().position(|b| b == node).unwrap_or_default(),
        }));
        sums.take(&run, of_patch);
        if let Some(axle) = bed.axle() {
            points.iter().for_each(|point| sums.turn((spread, point), response, &axle));
        }
    }

    /// The tangent from the sums.
    fn assemble_points(
        &mut self,
        method: &Method,
        width: usize,
        response: &Response,
        (spread, bed): (&Spread, &dyn Bed),
    ) {
        let sums = std::mem::take(&mut self.sums);
        let (count, epsilon, n) = (sums.gap.len(), method.law.normal, spread.normal);
        let size = 3 * count + width;
        self.shape = [size; 2];
        self.matrix.clear();
        self.matrix.resize(size * size, 0.0);
        let start = |k: usize| if k == 0 { 0 } else { 3 * k + width };
        let (by, constraint_by) = (&response.force_by, &response.constraint_by);
        self.set(3, 3, [width; 2], &(constraint_by.multiplier * epsilon));
        let free = spread.free;
        let mean: Vec3 = spread.portions.iter().map(|point| point.at.normal * point.weight).sum();
        let turn = (Mat3::identity() - n * n.transpose()) * free / (free * mean).norm();
        let normal_force = n.dot(&response.force);
        let turned: Vec<Mat3> = sums.normal.iter().map(|by| turn * by).collect();
        let mut by_column = Vec::with_capacity(count);
        // The rotation of a tool, which is last, takes what is held with it.
        let held = bed.axle().map(|axle| response.by_held * axle.turn().cross(&spread.carried));
        for k in 0..count {
            let held = held.filter(|_| k + 1 == count).map_or(Mat3::zeros(), |held| held * Vec3::x().transpose());
            let change = |by: &law::Slopes| {
                by.gap * sums.gap[k].transpose() + by.normal * turned[k] + by.path * sums.path[k] + held
            };
            by_column.push(change(by));
            self.set(3, start(k), [width, 3], &change(constraint_by));
        }
        for r in 0..count {
            let leans = sums.leaning[r] * response.force.transpose() - sums.share[r] * normal_force;
            let bearing = sums.share[r] + sums.leaning[r] * n.transpose();
            let wedged = (sums.share[r] * n + sums.leaning[r]) * spread.wedge;
            self.set(start(r), 3, [3, width], &(bearing * by.multiplier * epsilon));
            for c in 0..count {
                let block = bearing * by_column[c] + leans * turned[c] + sums.own[r * count + c]
                    - wedged * sums.gap[c].transpose();
                self.set(start(r), start(c), [3, 3], &block);
            }
        }
        self.sums = sums;
    }
}

/// Derivatives of the handles of a patch.
fn link(patch: &MovingPatch, stencil: &[u32], bed: &dyn Bed, (positions, to): (&mut Vec<Vec3>, &mut Variation)) {
    positions.clear();
    positions.extend(stencil.iter().map(|&n| bed.position(n)));
    patch.link(positions, to);
}

/// The response with the sum of what the points bear for the force.
fn summed(response: Response, spread: Option<&Spread>) -> Response {
    let Some(spread) = spread.filter(|_| response.status != Status::Gap) else { return response };
    let bears = |point: &Portion| spread.bears(point, &response.force);
    Response { force: spread.portions.iter().map(bears).sum(), ..response }
}
