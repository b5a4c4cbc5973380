//! Contact in the nonlinear problem of an increment: its share of the residual and of the tangent, force-driven tools, and
//! whether the search has seen enough.

use super::Newton;
use crate::contact::element::{self, Element};
use crate::contact::{Guide, Master, Status, touching, watch_all};
use crate::model::Model;
use crate::parallel::{Parcels, exchange, max, sum};
use crate::system::dofs::NONE;
use crate::system::{DofMap, Pattern};
use crate::{Mat3, Vec3};

impl Newton<'_> {
    /// Contact elements of the owned slave nodes: their status, forces and residuals; with prescribed displacements that are
    /// still `ahead`, as if they were done. Collective.
    pub(super) fn add_contact(&mut self, x: &[f64], ahead: Option<&[Vec3]>, r: &mut [f64]) {
        let mut on_tools = vec![0.0; 3 * self.system.model.tools.len()];
        let mut nearest = vec![f64::NEG_INFINITY; self.system.model.tools.len()];
        let first = self.is_first();
        let group = self.system.model.bodies.len();
        let Model { part, tools, pairs, .. } = &mut *self.system.model;
        let balance = &mut self.found.balance;
        for (p, pair) in pairs.iter_mut().enumerate() {
            let Master::Tool(t) = pair.master else { continue };
            let tool = &tools[t];
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let node = slave.node as usize;
                let position =
                    part.points[node] + self.found.u[node] + ahead.map_or(Vec3::zeros(), |ahead| ahead[node]);
                let warm = slave.trial.projection.map(|p| (p.patch, p.xi)).or(slave.committed.warm);
                let projection = tool.project(&position, pair.reach, warm);
                let gap = |x: &Vec3| tool.project(x, pair.reach, None).map(|p| p.gap);
                let start = |place: &Vec3| Some(tool.trial.outward(place));
                let projection = projection.filter(|p| !slave.is_beside(start, &position, p, pair.facet_size, gap));
                slave.trial.projection = projection;
                let clearance = projection.map_or(pair.reach, |p| p.gap.max(0.0));
                nearest[t] = nearest[t].max(-clearance);
                let (equations, carried) = (self.system.dofs.multiplier[p][s], self.system.dofs.carried[p][s]);
                if carried == [false; 3] {
                    slave.trial.status = Status::Gap;
                    continue;
                }
                let lambda =
                    Vec3::from_fn(|d, _| self.system.dofs.local(equations[d]).map_or(0.0, |k| x[k] * slave.law.normal));
                let locked = self.system.conditions.locked(slave.node, t);
                let held = carried.map(|can| !can);
                let guide = Guide { held, drawn: [0, 1, 2].map(|d| locked[d] && !held[d]) };
                let felt = projection.filter(|p| guide.gives_way(&p.normal)).map(|p| element::framed(p, pair.tangent));
                let felt =
                    felt.map(|p| if first { touching(p, pair.controls.touching_gap * pair.facet_size) } else { p });
                let sigma = slave.local.at(&(position - tool.trial.translation), |_| None);
                let multiplier = slave.multiplier(pair.method, lambda, tool.trial.rotation * slave.held.carried, sigma);
                let anchor = slave.slip_origin(&tool.trial);
                let e = element::element(slave.law, &multiplier, felt.as_ref(), anchor, &guide);
                self.found.elements[p][s] = Some(e);
                slave.trial.update(&e.response);
                let (force, residual) = (e.response.load, e.response.constraint);
                if pair.method.holds_multipliers() {
                    slave.trial.sigma = sigma;
                    slave.trial.relative = position - tool.trial.translation;
                }
                self.found.forces[node] += force;
                balance.action(pair.body, force.amax());
                balance.action(group + p, force.amax());
                for d in 0..3 {
                    if let Some(k) = self.system.dofs.local(equations[d]) {
                        r[k] += residual[d];
                    }
                    on_tools[3 * t + d] += force[d];
                }
            }
        }
        sum(self.system.comm, &mut on_tools);
        max(self.system.comm, &mut nearest);
        self.found.clearances = nearest.into_iter().map(|clearance| -clearance).collect();
        let pairs = self.system.model.pairs.len();
        for (t, force) in self.found.tool_forces.iter_mut().enumerate() {
            *force = Vec3::from_column_slice(&on_tools[3 * t..3 * t + 3]);
            let driving = self.system.conditions.tool_forces[t].at(self.s);
            for d in 0..3 {
                if let Some(k) = self.system.dofs.local(self.system.dofs.tool[t][d]) {
                    r[k] -= force[d] + driving[d];
                    self.found.balance.action(group + pairs + t, driving[d].abs().max(force[d].abs()));
                }
            }
        }
    }
    /// Tangents of the contact elements. A tool that moves by q is a slave node that moves by -q. Collective when a tool is
    /// driven by force.
    pub(super) fn add_contact_tangent(&mut self) {
        let (dofs, pattern, values) = (self.system.dofs, &*self.system.pattern, &mut self.values);
        let mut to_tools: Vec<Entry> = Vec::new();
        for (p, pair) in self.system.model.pairs.iter_mut().enumerate() {
            let Master::Tool(t) = pair.master else { continue };
            let tool = &dofs.tool[t];
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let Some(element) = &self.found.elements[p][s] else { continue };
                if pair.method.holds_multipliers() {
                    slave.local.learn(slave.trial.sigma, &element.response);
                    let by_slave = -element.response.inverse * element.constraint_position;
                    slave.local.by.push((None, by_slave, slave.trial.relative));
                }
                let (node, multiplier) = (&dofs.node[slave.node as usize], &dofs.multiplier[p][s]);
                let Element { force_position, force_multiplier, constraint_position, .. } = *element;
                add_block(dofs, pattern, values, node, node, &force_position);
                add_block(dofs, pattern, values, node, multiplier, &force_multiplier);
                add_block(dofs, pattern, values, multiplier, node, &constraint_position);
                add_block(dofs, pattern, values, multiplier, multiplier, &element.constraint_multiplier);
                if *tool != [NONE; 3] {
                    add_block(dofs, pattern, values, node, tool, &-force_position);
                    add_block(dofs, pattern, values, multiplier, tool, &-constraint_position);
                    collect(&mut to_tools, tool, node, &-force_position);
                    collect(&mut to_tools, tool, multiplier, &-force_multiplier);
                    collect(&mut to_tools, tool, tool, &force_position);
                }
            }
        }
        if dofs.tool.iter().flatten().any(|&e| e != NONE) {
            self.add_tool_rows(&to_tools);
        }
    }

    /// Brings the entries of tool rows to rank 0, which owns them. A tool that nothing touches yet gets the stiffness with
    /// which its force drives it to the nearest slave node, and a little into it. Collective.
    fn add_tool_rows(&mut self, entries: &[Entry]) {
        let parcel = entries.iter().flat_map(|e| [e.row as f64, e.column as f64, e.value]).collect();
        let gathered: Vec<f64> =
            exchange(self.system.comm, &Parcels::from([(0, parcel)])).into_values().flatten().collect();
        let mut touched = vec![false; 3 * self.system.dofs.tool.len()];
        let equations: Vec<i64> = self.system.dofs.tool.iter().flatten().copied().collect();
        for entry in gathered.chunks_exact(3) {
            let (row, column) = (entry[0] as i64, entry[1] as i64);
            if let Some(local) = self.system.dofs.local(row) {
                self.system.pattern.add(&mut self.values, local, column, entry[2]);
                if entry[2] != 0.0 {
                    touched[equations.iter().position(|&e| e == row).unwrap_or_default()] = true;
                }
            }
        }
        for (k, &equation) in equations.iter().enumerate().filter(|(k, _)| !touched[*k]) {
            if let Some(row) = self.system.dofs.local(equation) {
                let (force, distance) =
                    (self.system.conditions.tool_forces[k / 3].at(self.s).norm(), self.found.clearances[k / 3]);
                let compliance = 1.0 / self.system.model.stiffness + if force > 0.0 { distance / force } else { 0.0 };
                self.system.pattern.add(&mut self.values, row, equation, 1.0 / compliance);
            }
        }
    }

    /// Reduces the friction penalty of nodes whose status or slip direction flips again and again: they overshoot the
    /// friction cone from one side to the other. The solution does not depend on the penalty, only the path to it.
    pub(super) fn calm(&mut self) {
        let controls = self.system.model.controls;
        for pair in &mut self.system.model.pairs {
            for slave in &mut pair.slaves {
                if slave.trial.flips as usize >= controls.calm_flips && slave.calm(pair.method, &controls) {
                    slave.trial.flips = 0;
                    self.course.calmed.push(slave.node);
                }
            }
        }
    }

    /// After convergence: a node that moved farther than the search reaches may have crossed the surface unseen, and one
    /// outside the region that was fetched may miss a patch. Widens the search and says whether it had to. Collective.
    pub fn widen_search(&mut self) -> bool {
        let Model { part, tools, pairs, .. } = &mut *self.system.model;
        let place = |n: u32| part.points[n as usize] + self.found.u[n as usize];
        let mut lost = false;
        for pair in pairs.iter_mut() {
            let Master::Tool(t) = pair.master else { continue };
            let tool = &tools[t];
            let mut longest = [0.0f64];
            for slave in &pair.slaves {
                let here = tool.trial.inward(&place(slave.node));
                longest[0] = longest[0].max(slave.committed.place.map_or(0.0, |from| (here - from).norm()));
            }
            max(self.system.comm, &mut longest);
            if longest[0] > pair.reach {
                pair.reach = pair.controls.reach_farther * longest[0];
                lost = true;
            }
        }
        lost |= watch_all(self.system.comm, tools, pairs, place);
        let widen = self.widen_deformable_search() || lost;
        if widen {
            self.judge_again();
        }
        widen
    }
}

impl Newton<'_> {
    /// The next solve judges this iterate again.
    pub(super) fn judge_again(&mut self) {
        self.course.trace.pop();
        self.course.changes.pop();
    }
}

/// An entry of a row that rank 0 owns.
struct Entry {
    row: i64,
    column: i64,
    value: f64,
}

fn add_block(dofs: &DofMap, pattern: &Pattern, values: &mut [f64], rows: &[i64; 3], columns: &[i64; 3], block: &Mat3) {
    for i in 0..3 {
        let Some(row) = dofs.local(rows[i]) else { continue };
        for j in (0..3).filter(|&j| columns[j] != NONE) {
            pattern.add(values, row, columns[j], block[(i, j)]);
        }
    }
}

fn collect(entries: &mut Vec<Entry>, rows: &[i64; 3], columns: &[i64; 3], block: &Mat3) {
    for i in (0..3).filter(|&i| rows[i] != NONE) {
        for j in (0..3).filter(|&j| columns[j] != NONE) {
            entries.push(Entry { row: rows[i], column: columns[j], value: block[(i, j)] });
        }
    }
}
