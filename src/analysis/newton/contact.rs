//! Contact in the nonlinear problem of an increment: its share of the residual and of the tangent, force-driven tools, and
//! whether the search has seen enough.

use super::Newton;
use crate::contact::element::{self, Frictional, Frictionless};
use crate::contact::{Guide, Status, watch_all};
use crate::model::Model;
use crate::parallel::{any, exchange, max, sum};
use crate::system::dofs::NONE;
use crate::system::{DofMap, Pattern};
use crate::{Mat3, Vec3};
use mpi::traits::*;

/// The contact element of a slave node at the current iterate.
#[derive(Clone, Copy, Debug)]
pub(super) enum Element {
    Frictional(Frictional),
    Frictionless(Frictionless),
}

impl Newton<'_> {
    /// Contact elements of the owned slave nodes: their status, forces and residuals; with prescribed displacements that are
    /// still `ahead`, as if they were done. Collective.
    pub(super) fn add_contact(&mut self, x: &[f64], ahead: Option<&[Vec3]>, r: &mut [f64], largest: &mut f64) {
        let mut on_tools = vec![0.0; 3 * self.model.tools.len()];
        let mut nearest = vec![f64::NEG_INFINITY; self.model.tools.len()];
        let Model { part, tools, pairs, .. } = &mut *self.model;
        for (p, pair) in pairs.iter_mut().enumerate() {
            let tool = &tools[pair.tool];
            let frictional = pair.width() == 3;
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let node = slave.node as usize;
                let position = part.points[node] + self.u[node] + ahead.map_or(Vec3::zeros(), |ahead| ahead[node]);
                let warm = slave.trial.projection.map(|p| (p.patch, p.xi)).or(slave.committed.warm);
                let projection = tool.project(&position, pair.reach, warm);
                slave.trial.projection = projection;
                let clearance = projection.map_or(pair.reach, |p| p.gap.max(0.0));
                nearest[pair.tool] = nearest[pair.tool].max(-clearance);
                let equations = self.dofs.multiplier[p][s];
                if equations == [NONE; 3] {
                    slave.trial.status = Status::Gap;
                    continue;
                }
                let lambda =
                    Vec3::from_fn(|d, _| self.dofs.local(equations[d]).map_or(0.0, |k| x[k] * slave.law.normal));
                let locked = self.conditions.locked(slave.node, pair.tool);
                let held = equations.map(|e| frictional && e == NONE);
                let guide = Guide { held, drawn: [0, 1, 2].map(|d| locked[d] && !held[d]) };
                let felt = projection.filter(|p| guide.gives_way(&p.normal));
                let (status, force, residual);
                if frictional {
                    let anchor = slave.slip_origin(&tool.trial);
                    let e = element::frictional(slave.law, lambda, felt.as_ref(), anchor, &guide);
                    (status, force, residual) = (e.status, e.force, e.multiplier_residual);
                    slave.trial.slip = e.slip;
                    self.elements[p][s] = Some(Element::Frictional(e));
                } else {
                    let e = element::frictionless(slave.law, lambda.x, felt.as_ref());
                    (status, force, residual) = (e.status, e.force, Vec3::new(e.multiplier_residual, 0.0, 0.0));
                    self.elements[p][s] = Some(Element::Frictionless(e));
                }
                slave.trial.update(status, force);
                self.forces[node] += force;
                *largest = largest.max(force.amax());
                for d in 0..3 {
                    if let Some(k) = self.dofs.local(equations[d]) {
                        r[k] += residual[d];
                    }
                    on_tools[3 * pair.tool + d] += force[d];
                }
            }
        }
        sum(self.comm, &mut on_tools);
        max(self.comm, &mut nearest);
        self.clearances = nearest.into_iter().map(|clearance| -clearance).collect();
        for (t, force) in self.tool_forces.iter_mut().enumerate() {
            *force = Vec3::from_column_slice(&on_tools[3 * t..3 * t + 3]);
            let driving = self.conditions.tool_forces[t].at(self.s);
            for d in 0..3 {
                if let Some(k) = self.dofs.local(self.dofs.tool[t][d]) {
                    r[k] -= force[d] + driving[d];
                    *largest = largest.max(driving[d].abs());
                }
            }
        }
    }
    /// Tangents of the contact elements. A tool that moves by q is a slave node that moves by -q. Collective when a tool is
    /// driven by force.
    pub(super) fn add_contact_tangent(&mut self) {
        let (dofs, pattern, values) = (self.dofs, self.pattern, &mut self.values);
        let mut to_tools: Vec<Entry> = Vec::new();
        for (p, pair) in self.model.pairs.iter().enumerate() {
            let tool = &dofs.tool[pair.tool];
            for (s, slave) in pair.slaves.iter().enumerate() {
                let Some(element) = &self.elements[p][s] else { continue };
                let (node, multiplier) = (&dofs.node[slave.node as usize], &dofs.multiplier[p][s]);
                let Blocks { force_position, force_multiplier, multiplier_position, multiplier_multiplier } =
                    element.blocks();
                add_block(dofs, pattern, values, node, node, &force_position);
                add_block(dofs, pattern, values, node, multiplier, &force_multiplier);
                add_block(dofs, pattern, values, multiplier, node, &multiplier_position);
                add_block(dofs, pattern, values, multiplier, multiplier, &multiplier_multiplier);
                if *tool != [NONE; 3] {
                    add_block(dofs, pattern, values, node, tool, &-force_position);
                    add_block(dofs, pattern, values, multiplier, tool, &-multiplier_position);
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
        let mut parcels = vec![Vec::new(); self.comm.size() as usize];
        parcels[0] = entries.iter().flat_map(|e| [e.row as f64, e.column as f64, e.value]).collect();
        let gathered = exchange(self.comm, &parcels).concat();
        let mut touched = vec![false; 3 * self.dofs.tool.len()];
        let equations: Vec<i64> = self.dofs.tool.iter().flatten().copied().collect();
        for entry in gathered.chunks_exact(3) {
            let (row, column) = (entry[0] as i64, entry[1] as i64);
            if let Some(local) = self.dofs.local(row) {
                self.pattern.add(&mut self.values, local, column, entry[2]);
                if row == column && entry[2] != 0.0 {
                    touched[equations.iter().position(|&e| e == row).unwrap_or_default()] = true;
                }
            }
        }
        for (k, &equation) in equations.iter().enumerate().filter(|(k, _)| !touched[*k]) {
            if let Some(row) = self.dofs.local(equation) {
                let (force, distance) = (self.conditions.tool_forces[k / 3].at(self.s).norm(), self.clearances[k / 3]);
                let compliance = 1.0 / self.model.stiffness + if force > 0.0 { distance / force } else { 0.0 };
                self.pattern.add(&mut self.values, row, equation, 1.0 / compliance);
            }
        }
    }

    /// Reduces the friction penalty of nodes whose status or slip direction flips again and again: they overshoot the
    /// friction cone from one side to the other. The solution does not depend on the penalty, only the path to it.
    pub(super) fn calm(&mut self) {
        const PATIENCE: u32 = 3;
        for slave in self.model.pairs.iter_mut().flat_map(|p| &mut p.slaves) {
            if slave.trial.flips >= PATIENCE
                && slave.law.friction > 0.0
                && slave.law.tangential > 1e-3 * slave.law.normal
            {
                slave.law.tangential *= 0.1;
                slave.trial.flips = 0;
                self.calmed.push(slave.node);
            }
        }
    }

    /// After convergence: a node that moved farther than the search reaches may have crossed the surface unseen, and one
    /// outside the region that was fetched may miss a patch. Widens the search and says whether it had to. Collective.
    pub fn widen_search(&mut self) -> bool {
        let Model { part, tools, pairs, .. } = &mut *self.model;
        let place = |n: u32| part.points[n as usize] + self.u[n as usize];
        let mut lost = false;
        for pair in pairs.iter_mut() {
            let tool = &tools[pair.tool];
            let mut longest = [0.0f64];
            for slave in &pair.slaves {
                let here = tool.trial.inward(&place(slave.node));
                longest[0] = longest[0].max(slave.committed.place.map_or(0.0, |from| (here - from).norm()));
                lost |= !tool.surface.covers(&here);
            }
            max(self.comm, &mut longest);
            if longest[0] > pair.reach {
                pair.reach = 1.5 * longest[0];
                lost = true;
            }
        }
        let widen = any(self.comm, lost);
        if widen {
            watch_all(self.comm, tools, pairs, place);
            // The next solve judges this iterate again.
            self.trace.pop();
            self.changes.pop();
        }
        widen
    }
}

/// An entry of a row that rank 0 owns.
struct Entry {
    row: i64,
    column: i64,
    value: f64,
}

/// The tangent of a contact element in 3x3 blocks; without friction the multiplier is its first component.
struct Blocks {
    force_position: Mat3,
    force_multiplier: Mat3,
    multiplier_position: Mat3,
    multiplier_multiplier: Mat3,
}

impl Element {
    fn blocks(&self) -> Blocks {
        match self {
            Self::Frictional(e) => Blocks {
                force_position: e.force_position,
                force_multiplier: e.force_multiplier,
                multiplier_position: e.force_position,
                multiplier_multiplier: e.multiplier_multiplier,
            },
            Self::Frictionless(e) => {
                let column = Mat3::from_columns(&[e.force_multiplier, Vec3::zeros(), Vec3::zeros()]);
                Blocks {
                    force_position: e.force_position,
                    force_multiplier: column,
                    multiplier_position: column.transpose(),
                    multiplier_multiplier: Mat3::from_diagonal(&Vec3::new(e.multiplier_multiplier, 0.0, 0.0)),
                }
            }
        }
    }
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
