//! Contact with deformable masters in the nonlinear problem of an increment.
//!
//! The elements of this rank's slave nodes have rows at master nodes that other ranks may own: forces and matrix entries
//! travel to them.

use super::Newton;
use crate::Vec3;
use crate::contact::deformable::{self, Method, Origin, Site};
use crate::contact::{BodySurface, Guide, Master, Multiplier, Pair, Response, Slave, Status, follow_all, touching};
use crate::error::Result;
use crate::model::Model;
use crate::parallel::any;
use crate::partition::Bounds;
use crate::partition::parcels::{bounds, hull};
use crate::surface::projection::descend;
use crate::surface::{Polygon, Projection};
use crate::system::Pattern;
use crate::system::dofs::NONE;
use mpi::topology::SimpleCommunicator;

/// What the element of a slave node was evaluated with, kept for its tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    method: Method,
    multiplier: Multiplier,
    /// The part of a held multiplier that the master carries along.
    carried: Vec3,
    /// On the master, unless that is out of reach or feels nothing of the node.
    contact: Option<(Projection, SlipOrigin)>,
    guide: Guide,
}

/// From where slip is measured.
#[derive(Clone, Copy, Debug)]
enum SlipOrigin {
    /// Patch and parameters.
    Carried(u32, [f64; 2]),
    /// A place beside a mate.
    Beside(Vec3),
}

/// An element, and the positions of the stencils that it works on.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    element: deformable::Element,
    positions: Vec<Vec3>,
    origin: Vec<Vec3>,
}

impl Workspace {
    /// Evaluates the element of a slave node, with its tangent if asked for.
    fn evaluate(&mut self, surface: &BodySurface, meeting: &Meeting, with_tangent: bool) -> Response {
        let Self { element, positions, origin } = self;
        let contact = meeting.contact.as_ref().and_then(|(projection, from)| {
            let (patch, stencil) = surface.patch(projection.patch)?;
            pick(positions, surface.positions(), stencil);
            let origin = match *from {
                SlipOrigin::Beside(place) => Origin::Fixed(place),
                SlipOrigin::Carried(id, xi) => {
                    let (old, old_stencil) = surface.patch(id)?;
                    pick(origin, surface.positions(), old_stencil);
                    Origin::Carried(Site { patch: old, positions: origin, xi })
                }
            };
            Some(deformable::Contact { projection, patch, positions, origin, carried: meeting.carried })
        });
        let (contact, guide, multiplier) = (contact.as_ref(), &meeting.guide, &meeting.multiplier);
        match with_tangent {
            false => element.residual(&meeting.method, multiplier, contact, guide),
            true => element.tangent(&meeting.method, multiplier, contact, guide),
        }
    }
}

impl Newton<'_> {
    /// Contact elements of slave nodes on deformable masters, as [`Newton::add_contact`] for those on tools. Collective.
    pub(super) fn add_deformable(&mut self, x: &[f64], ahead: Option<&[Vec3]>, r: &mut [f64]) {
        if self.system.model.surfaces.is_empty() {
            return;
        }
        self.follow(ahead);
        let first = self.is_first();
        let group = self.system.model.bodies.len();
        let balance = &mut self.found.balance;
        let Model { part, surfaces, pairs, .. } = &mut *self.system.model;
        pairs.iter_mut().flat_map(|p| &mut p.slaves).for_each(|slave| slave.trial.received = Vec3::zeros());
        for p in 0..pairs.len() {
            let pair = &mut pairs[p];
            let Master::Surface(k) = pair.master else { continue };
            let surface = &surfaces[k];
            let mut on_master = vec![Vec3::zeros(); surface.positions().len()];
            for s in 0..pair.slaves.len() {
                let node = pair.slaves[s].node as usize;
                let position =
                    part.points[node] + self.found.u[node] + ahead.map_or(Vec3::zeros(), |ahead| ahead[node]);
                let equations = self.system.dofs.multiplier[p][s].map(|e| self.system.dofs.local(e));
                let unknown = Vec3::from_fn(|d, _| equations[d].map_or(0.0, |k| x[k]));
                let moves = [0, 1, 2].map(|d| self.system.conditions.move_of(node as u32, d));
                let mut meeting = meet(pair, surface, s, &position, &moves, &unknown);
                if first {
                    meeting.contact = meeting
                        .contact
                        .map(|(p, origin)| (touching(p, pair.controls.touching_gap * pair.facet_size), origin));
                }
                let e = self.workspace.evaluate(surface, &meeting, false);
                self.found.meetings[p][s] = Some(meeting);
                pair.slaves[s].trial.update(&e);
                self.found.forces[node] += e.load;
                for group in [pair.body, pair.master_body.unwrap_or(pair.body), group + p] {
                    balance.action(group, e.force.amax());
                }
                for (equation, residual) in equations.iter().zip(&e.constraint) {
                    if let Some(k) = equation {
                        r[*k] += residual;
                    }
                }
                if let Some((_, stencil)) = meeting.contact.and_then(|(p, _)| surface.patch(p.patch)) {
                    stencil.iter().zip(&self.workspace.element.forces).for_each(|(&n, f)| on_master[n as usize] += f);
                }
            }
            let forces = &mut self.found.forces;
            let receiver = if pair.is_self() { Some(p) } else { pair.other };
            let mut receiver = receiver.map(|p| &mut pairs[p]);
            surface.add_forces(self.system.comm, &on_master, |n, force| {
                let node = part.tie[n as usize];
                forces[node as usize] += force;
                if let Some(slave) = receiver.as_mut().and_then(|pair| pair.slave_at(node)) {
                    slave.trial.received += force;
                }
            });
        }
    }

    /// Lets the surfaces follow the iterate. Collective.
    fn follow(&mut self, ahead: Option<&[Vec3]>) {
        let Model { part, surfaces, pairs, .. } = &mut *self.system.model;
        let u = &self.found.u;
        let place = |n: u32| {
            let n = n as usize;
            part.points[n] + u[n] + ahead.map_or(Vec3::zeros(), |ahead| ahead[n])
        };
        let fetched = follow_all(self.system.comm, surfaces, pairs, place);
        if fetched.contains(&true) {
            self.learn();
        }
    }

    /// Learns what stays the same over the increment of the nodes of the surfaces. Collective.
    pub(super) fn learn(&mut self) {
        let Model { part, surfaces, .. } = &mut *self.system.model;
        let before = |n: u32| part.points[n as usize] + self.system.committed[n as usize];
        for surface in surfaces {
            surface
                .learn(self.system.comm, before, &self.system.dofs.node, |n, d| self.system.conditions.move_of(n, d));
        }
    }

    /// Builds the pattern anew if some contact has come to where it does not provide for. Says whether. Collective.
    pub(super) fn widen_pattern(&mut self) -> Result<bool> {
        if self.system.model.surfaces.is_empty() {
            return Ok(false);
        }
        let mut lacks = false;
        for (p, pair) in
            self.system.model.pairs.iter().enumerate().filter(|(_, p)| matches!(p.master, Master::Surface(_)))
        {
            for (s, slave) in pair.slaves.iter().enumerate().filter(|(_, s)| s.trial.status != Status::Gap) {
                let Some((projection, origin)) = self.found.meetings[p][s].and_then(|m| m.contact) else { continue };
                let has = |patch: u32| self.system.pattern.candidates.has(p, s, patch);
                lacks |= !has(projection.patch);
                lacks |= pair.friction > 0.0 && matches!(origin, SlipOrigin::Carried(id, _) if !has(id));
                debug_assert!(slave.trial.projection.is_some());
            }
        }
        let widen = any(self.system.comm, lacks);
        if widen {
            let (part, u) = (&self.system.model.part, &self.found.u);
            let place = |n: u32| part.points[n as usize] + u[n as usize];
            *self.system.pattern = Pattern::new(self.system.comm, self.system.model, self.system.dofs, place)?;
            self.values.resize(self.system.pattern.columns.len(), 0.0);
            self.holds_elements = false;
            self.course.rebuilds += 1;
        }
        Ok(widen)
    }

    /// Tangents of the contact elements. Collective.
    pub(super) fn add_deformable_tangent(&mut self) {
        if self.system.model.surfaces.is_empty() {
            return;
        }
        let (dofs, pattern) = (self.system.dofs, &*self.system.pattern);
        let mut foreign = vec![0.0; pattern.foreign.len()];
        let Model { pairs, surfaces, .. } = &mut *self.system.model;
        for (p, pair) in pairs.iter_mut().enumerate() {
            let Master::Surface(k) = pair.master else { continue };
            let surface = &surfaces[k];
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let Some(meeting) = &self.found.meetings[p][s] else { continue };
                let e = self.workspace.evaluate(surface, meeting, true);
                let element = &mut self.workspace.element;
                let multiplier = dofs.multiplier[p][s];
                if pair.method.holds_multipliers() {
                    learn(slave, &e, element, surface);
                } else if pair.friction > 0.0 {
                    hold(element, &multiplier, meeting);
                }
                let mut equations = dofs.node[slave.node as usize].to_vec();
                equations.extend(&multiplier[..if pair.friction > 0.0 { 3 } else { 1 }]);
                if e.status != Status::Gap {
                    equations.extend(element.nodes.iter().flat_map(|&n| surface.equations_of(n)));
                }
                let columns = element.shape[1];
                for (&row, entries) in equations.iter().zip(element.matrix.chunks(columns)).filter(|(r, _)| **r != NONE)
                {
                    let local = dofs.local(row);
                    for (&column, &value) in equations.iter().zip(entries).filter(|(c, v)| **c != NONE && **v != 0.0) {
                        if let Some(local) = local {
                            pattern.add(&mut self.values, local, column, value);
                        } else if let Some(k) = pattern.foreign.index(row as i32, column as i32) {
                            foreign[k] += value;
                        }
                    }
                }
            }
        }
        pattern.foreign.deliver(self.system.comm, &foreign, &mut self.values);
    }

    /// After convergence, as [`Newton::widen_search`]: widens the search of pairs whose nodes came farther than it reaches.
    /// What one surface moves against the other is bounded by the boxes of their motions. Collective.
    pub(super) fn widen_deformable_search(&mut self) -> bool {
        let Model { part, surfaces, pairs, .. } = &mut *self.system.model;
        let mut widen = false;
        for pair in pairs {
            let Master::Surface(k) = pair.master else { continue };
            let motion = |n: u32| self.found.u[n as usize] - self.system.committed[n as usize];
            let slaves = bounds(pair.slaves.iter().map(|s| motion(s.node)));
            let masters = surfaces[k].travel(|n| part.points[n as usize], |n| part.points[n as usize] + motion(n));
            let travel = relative_travel(self.system.comm, slaves, masters);
            if travel > pair.reach {
                pair.reach = pair.controls.reach_farther * travel;
                widen = true;
            }
        }
        widen
    }
}

/// Most that a point whose motion lies in one box moves against one whose motion lies in the other. Collective.
pub(in crate::analysis) fn relative_travel(
    comm: &SimpleCommunicator,
    one: Option<Bounds>,
    other: Option<Bounds>,
) -> f64 {
    match [hull(comm, one), hull(comm, other)] {
        [Some((lo, hi)), Some((low, high))] => (hi - low).sup(&(high - lo)).sup(&Vec3::zeros()).norm(),
        _ => 0.0,
    }
}

/// Keeps what the tangent has for the local unknown of a slave node.
fn learn(slave: &mut Slave, response: &Response, element: &deformable::Element, surface: &BodySurface) {
    slave.local.learn(slave.trial.sigma, response);
    let by = |node| -response.inverse * element.constraint_by(node, slave.law.friction);
    slave.local.by.push((None, by(None), slave.trial.relative));
    for (j, &n) in element.nodes.iter().enumerate() {
        slave.local.by.extend(surface.position(n).map(|x| (Some(n), by(Some(j)), x)));
    }
}

/// A multiplier that has an equation but no say, along a direction in which the node stands still on the master, is zero.
fn hold(element: &mut deformable::Element, equations: &[i64; 3], meeting: &Meeting) {
    let columns = element.shape[1];
    for d in (0..3).filter(|&d| meeting.guide.held[d] && equations[d] != NONE) {
        let row = 3 + d;
        element.matrix[row * columns..(row + 1) * columns].fill(0.0);
        element.matrix[row * columns + row] = -meeting.method.law.normal;
    }
}

/// Finds slave node `s` of `pair`, at `position` and with prescribed `moves`, on the master; `unknown` is λ'.
fn meet(
    pair: &mut Pair,
    surface: &BodySurface,
    s: usize,
    position: &Vec3,
    moves: &[f64; 3],
    unknown: &Vec3,
) -> Meeting {
    let tangent = pair.tangent;
    let slave = &pair.slaves[s];
    let warm = slave.trial.projection.map(|p| (p.patch, p.xi)).or(slave.committed.warm);
    let projection = pair.project(surface, s, position, warm).filter(|p| !is_beside(pair, surface, s, position, p));
    let slave = &mut pair.slaves[s];
    slave.trial.projection = projection;
    let guide = projection.map_or(Guide::default(), |p| guide(surface, &p, moves));
    slave.trial.yields = pair.is_second
        && projection.is_some_and(|p| repeats(surface, &p, slave.trial.yields, pair.controls.repeat_distance));
    let felt = projection.filter(|p| guide.gives_way(&p.normal) && !slave.trial.yields);
    let contact = felt.map(|p| (p, slip_origin(surface, slave, &p)));
    let sigma = slave.local.at(position, |n| surface.position(n));
    let multiplier = slave.multiplier(pair.method, unknown * slave.law.normal, Vec3::zeros(), sigma);
    (slave.trial.sigma, slave.trial.relative) = (sigma, *position);
    let from_last = contact.filter(|(_, origin)| match origin {
        SlipOrigin::Carried(id, xi) => Some((*id, *xi)) == slave.committed.warm,
        SlipOrigin::Beside(_) => true,
    });
    let carried = from_last.map_or(Vec3::zeros(), |_| slave.held.carried);
    let method = Method { law: slave.law, transfer: surface.given.transfer, tangent };
    Meeting { method, multiplier, carried, contact, guide }
}

/// Whether a slave node stands where a node of the master does: in the other pass that one is kept out of this one's
/// surface already, and the same condition twice would leave open how the two share the force. One that `yields` goes on
/// to do so until it is twice as far away, so that iterations do not go to and fro.
fn repeats(surface: &BodySurface, at: &Projection, yields: bool, distance: f64) -> bool {
    let Some((patch, stencil)) = surface.patch(at.patch) else { return false };
    let count = patch.count as usize;
    let place = |k: usize| surface.positions()[stencil[k % count] as usize];
    let edge = |k: usize| (place(k + 1) - place(k)).norm();
    let shortest = (0..count).map(edge).fold(f64::INFINITY, f64::min);
    let near = if yields { 2.0 } else { 1.0 } * distance * shortest;
    (0..count).any(|k| (place(k) - at.point).norm() < near)
}

/// Whether slave node `s`, found inside the master, has come past an end of it.
fn is_beside(pair: &Pair, surface: &BodySurface, s: usize, position: &Vec3, at: &Projection) -> bool {
    let start = |place: &Vec3| {
        let (patch, stencil) = surface.patch(at.patch)?;
        let mut before = Vec::new();
        pick(&mut before, &surface.before, stencil);
        Some(at.point + (place - patch.shape(&before).point(at.xi)))
    };
    let gap = |x: &Vec3| pair.project(surface, s, x, None).map(|p| p.gap);
    pair.slaves[s].is_beside(start, position, at, pair.facet_size, gap)
}

/// In which directions a slave node with prescribed moves (NaN where free) cannot give way on the master: where its nodes
/// that bear the point are prescribed too, it is held when they move alike, else drawn.
fn guide(surface: &BodySurface, at: &Projection, moves: &[f64; 3]) -> Guide {
    const BEARS: f64 = 1e-6;
    let mut guide = Guide::default();
    let Some((patch, stencil)) = surface.patch(at.patch) else { return guide };
    let [e, z] = at.xi;
    let weights = match patch.count {
        3 => [1.0 - e, e - z, z, 0.0],
        _ => [(1.0 - e) * (1.0 - z), e * (1.0 - z), e * z, (1.0 - e) * z],
    };
    for (d, &by) in moves.iter().enumerate().filter(|(_, by)| !by.is_nan()) {
        let bearing = stencil[..patch.count as usize].iter().zip(weights).filter(|(_, w)| w.abs() > BEARS);
        let mut moves = bearing.map(|(&n, _)| surface.moves[n as usize][d]);
        guide.held[d] = moves.clone().all(|m| m == by);
        guide.drawn[d] = !guide.held[d] && moves.all(|m| !m.is_nan());
    }
    guide
}

/// Where slip is measured from: where the node was on the master at the last converged increment. One that was out of
/// reach then was beside the patch that it is on now.
fn slip_origin(surface: &BodySurface, slave: &Slave, now: &Projection) -> SlipOrigin {
    const BESIDE: f64 = 2.0;
    if let Some((mate, before)) = slave.mate.zip(slave.committed.place)
        && let Some(place) = mate.slip_origin(surface, &before)
    {
        return SlipOrigin::Beside(place);
    }
    let kept = slave.committed.warm.filter(|(id, _)| surface.patch(*id).is_some());
    let beside = || {
        let (patch, stencil) = surface.patch(now.patch)?;
        let mut positions = Vec::new();
        pick(&mut positions, &surface.before, stencil);
        let shape = patch.shape(&positions);
        Some((now.patch, descend(&shape, &slave.committed.place?, &[BESIDE; 4], shape.center()).xi))
    };
    let (id, xi) = kept.or_else(beside).unwrap_or((now.patch, now.xi));
    SlipOrigin::Carried(id, xi)
}

fn pick(into: &mut Vec<Vec3>, positions: &[Vec3], stencil: &[u32]) {
    into.clear();
    into.extend(stencil.iter().map(|&n| positions[n as usize]));
}
