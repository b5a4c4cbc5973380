//! Contact in the nonlinear problem of an increment: its share of the residual and of the tangent, force-driven tools, and
//! whether the search has seen enough.
//!
//! The elements of this rank's slave nodes have rows at nodes of masters that other ranks may own, those of tools at rank 0:
//! forces and matrix entries travel to them.

use super::Newton;
use crate::Vec3;
use crate::contact::meeting::{Ahead, Meeting, Moves, Workspace};
use crate::contact::{Interference, Receiver, Segments, Status};
use crate::error::Result;
use crate::model::Model;
use crate::parallel::{any, max, sum};
use crate::system::dofs::NONE;
use crate::system::{MasterNodes, Pattern};
use smallvec::SmallVec;

/// What contact works with besides the model.
#[derive(Default)]
pub(super) struct Touching {
    /// What each slave node of each pair was evaluated with.
    meetings: Vec<Vec<Option<Meeting>>>,
    /// The points of the faces of pairs that meet from segment to segment.
    segments: Vec<Option<Segments>>,
    /// For each pair the nodes of its master.
    nodes: Vec<MasterNodes>,
    /// Least distance of the slave nodes of each pair from its master, at most the reach; 0 in contact.
    clearances: Vec<f64>,
    /// The sum of the squares of the residuals of multipliers that have no equations, N².
    pub(super) left_out: f64,
    workspace: Workspace,
}

impl Touching {
    pub fn new(model: &Model) -> Self {
        let meetings = model.pairs.iter().map(|p| vec![None; p.slaves.len()]).collect();
        let segments = vec![None; model.pairs.len()];
        Self { meetings, segments, clearances: vec![0.0; model.pairs.len()], ..Self::default() }
    }
}

impl Newton<'_> {
    /// Lets slave nodes be as deep in their masters as what is left of overlaps that are ramped.
    pub fn allow_overlaps(&mut self) {
        let left = self.system.conditions.overlaps.at(self.s);
        for pair in &mut self.system.model.pairs {
            let left = if pair.rules.interference == Interference::Ramped { left } else { 0.0 };
            pair.slaves.iter_mut().for_each(|slave| slave.law.allowed = left * slave.overlap);
        }
    }

    /// Contact elements of the owned slave nodes: their status, forces and residuals; with prescribed displacements that are
    /// still `ahead`, as if they were done. Collective.
    pub(super) fn add_contact(&mut self, x: &[f64], ahead: Option<&[Vec3]>, r: &mut [f64]) {
        self.follow(ahead);
        self.allow_overlaps();
        let first = self.is_first();
        let Model { part, masters, pairs, sections, controls, .. } = &mut *self.system.model;
        let (dofs, balance, group) = (&*self.system.dofs, &mut self.found.balance, sections.len());
        pairs.iter_mut().flat_map(|p| &mut p.slaves).for_each(|slave| slave.trial.received = Vec3::zeros());
        let tools = masters.tools.len();
        let mut on_tools = vec![Vec3::zeros(); 2 * tools];
        let mut nearest = vec![f64::NEG_INFINITY; pairs.len()];
        self.touching.left_out = 0.0;
        let (u, committed) = (&self.found.u, self.system.committed);
        let place = |n: u32| {
            let n = n as usize;
            part.points[n] + u[n] + ahead.map_or(Vec3::zeros(), |ahead| ahead[n])
        };
        let then = |n: u32| part.points[n as usize] + committed[n as usize];
        let stalled = controls.segment_stalled;
        let settled = stalled.min(controls.segment_settled * self.strategy.tolerance);
        let trace = &self.course.trace[self.course.since..];
        let stalls = |pair: &[f64]| pair[1] < stalled && pair[1] > 0.5 * pair[0];
        // Where they carry it back up as often as they are found anew, the second time they stay.
        let returns = trace.windows(2).filter(|pair| stalls(pair)).count() > 1;
        let stand_still = match *trace {
            [.., before, last] => last < settled || last < stalled && (returns || stalls(&[before, last])),
            [last] => last < settled,
            [] => false,
        };
        let mut beside = vec![0.0; if pairs.iter().any(|p| p.faces.is_some()) { 3 * part.points.len() } else { 0 }];
        for p in 0..pairs.len() {
            let pair = &mut pairs[p];
            let ground = masters.of(pair.master);
            let still = self.touching.segments[p].as_ref().filter(|_| stand_still);
            let segments = pair.faces.as_ref().map(|faces| {
                let heights = || faces.heights(self.system.comm, place);
                Segments::find(pair, &ground, heights, place, Some(&then), still)
            });
            let mut on_master = vec![Vec3::zeros(); ground.count()];
            for s in 0..pair.slaves.len() {
                let node = pair.slaves[s].node as usize;
                let equations = dofs.multiplier[p][s].map(|e| dofs.local(e));
                let unknown = Vec3::from_fn(|d, _| equations[d].map_or(0.0, |k| x[k]));
                let unknown = dofs.axes.outward_of(pair, node as u32, &unknown);
                let slave_moves = self.system.conditions.movement(node as u32);
                let moves = Moves { slave: slave_moves, master: &self.touching.nodes[p].moves };
                let ahead = Ahead { place: &place, segments: segments.as_ref() };
                let meeting = Meeting::new(pair, &ground, (s, &ahead), &moves, &unknown, first);
                let workspace = &mut self.touching.workspace;
                let e = workspace.evaluate(&ground, (&meeting, &pair.slaves[s]), segments.as_ref(), false);
                self.touching.meetings[p][s] = Some(meeting);
                let trial = &mut pair.slaves[s].trial;
                trial.update(&e);
                nearest[p] = nearest[p].max(-trial.projection.map_or(pair.reach, |p| p.gap.max(0.0)));
                let element = &self.touching.workspace.element;
                let of_beside = element.beside.iter().copied().zip(element.beside_forces.iter().copied());
                self.found.forces[node] += element.own;
                of_beside.clone().for_each(|(n, f)| (0..3).for_each(|d| beside[3 * n as usize + d] += f[d]));
                if let Some(t) = pair.master.tool() {
                    let moment = |(n, f): (u32, Vec3)| place(n).cross(&f);
                    on_tools[tools + t] += moment((node as u32, element.own)) + of_beside.map(moment).sum::<Vec3>();
                }
                let force = e.force.amax();
                balance.force(group + p, force);
                balance.contact(part.section[node] as usize, force);
                pair.master_side
                    .iter()
                    .flat_map(|side| &side.sections)
                    .for_each(|&section| balance.contact(section, force));
                if !dofs.near[p][s] {
                    self.touching.left_out += e.constraint.norm_squared();
                }
                let constraint = dofs.axes.inward_of(pair, node as u32, &e.constraint);
                for (equation, residual) in equations.iter().zip(&constraint) {
                    if let Some(k) = equation {
                        r[*k] += residual;
                    }
                }
                element.nodes.iter().zip(&element.forces).for_each(|(&n, f)| on_master[n as usize] += f);
            }
            self.touching.segments[p] = segments;
            let (master, forces) = (pair.master, &mut self.found.forces);
            let receiver = if pair.is_self() { Some(p) } else { pair.pass.other() };
            let mut receiver = receiver.map(|p| &mut pairs[p]);
            masters.scatter(self.system.comm, master, &on_master, |to, force| match to {
                Receiver::Tool(t) => on_tools[t] -= force,
                Receiver::Node(n) => {
                    let node = part.tie[n as usize];
                    forces[node as usize] += force;
                    if let Some(pair) = receiver.as_mut()
                        && let Some(s) = pair.index_of(node)
                    {
                        pair.slaves[s].trial.received += force;
                    }
                }
            });
        }
        if !beside.is_empty() {
            let forces = &mut self.found.forces;
            forces.iter_mut().zip(beside.as_chunks::<3>().0).for_each(|(force, f)| *force += Vec3::from(*f));
            part.halo
                .add_to_owners(self.system.comm, 3, &beside, |n, f| forces[n as usize] += Vec3::from_column_slice(f));
        }
        let mut on_tools: Vec<f64> = on_tools.iter().flatten().copied().collect();
        sum(self.system.comm, &mut on_tools);
        max(self.system.comm, &mut nearest);
        self.touching.clearances = nearest.into_iter().map(|clearance| -clearance).collect();
        self.add_tool_forces(&on_tools, r);
    }

    /// Balance of the tools that forces and torques drive, with the contact forces on all tools and their moments.
    fn add_tool_forces(&mut self, on_tools: &[f64], r: &mut [f64]) {
        let first = self.system.model.sections.len() + self.system.model.pairs.len();
        for (force, on_tool) in self.found.tool_forces.iter_mut().zip(on_tools.as_chunks::<3>().0) {
            *force = Vec3::from(*on_tool);
        }
        let tools = &self.system.model.masters.tools;
        for t in 0..2 * tools.len() {
            let force = match tools.get(t) {
                Some(_) => self.found.tool_forces[t],
                None => {
                    Vec3::x()
                        * tools[t - tools.len()]
                            .trial
                            .drive(&self.found.tool_forces[t - tools.len()], &self.found.tool_forces[t])
                }
            };
            let ramp = &self.system.conditions.tool_forces[t];
            let driving = ramp.at(self.s);
            for d in 0..3 {
                if let Some(k) = self.system.dofs.local(self.system.dofs.tool[t][d]) {
                    r[k] -= force[d] + driving[d];
                    self.found.balance.force(first + t, driving[d].abs().max(force[d].abs()));
                    // A force that is to vanish may be the rounding of the one that held the tool.
                    let load = if ramp.to[d] == 0.0 && ramp.is_straight() { 0.0 } else { driving[d].abs() };
                    self.found.balance.load(first + t, load);
                }
            }
        }
    }

    /// Lets the masters follow the iterate. Collective.
    fn follow(&mut self, ahead: Option<&[Vec3]>) {
        let Model { part, masters, pairs, .. } = &mut *self.system.model;
        let u = &self.found.u;
        let place = |n: u32| {
            let n = n as usize;
            part.points[n] + u[n] + ahead.map_or(Vec3::zeros(), |ahead| ahead[n])
        };
        if masters.follow(self.system.comm, pairs, place) {
            self.learn();
        }
    }

    /// Learns what stays the same over the increment of the nodes of the masters. Collective.
    pub(super) fn learn(&mut self) {
        let Model { part, masters, pairs, .. } = &mut *self.system.model;
        let (comm, conditions) = (self.system.comm, self.system.conditions);
        masters.remember(comm, |n| part.points[n as usize] + self.system.committed[n as usize]);
        let of_tools = conditions.movements_of_tools();
        let of_pair = |master| {
            let moves = (&of_tools[..], |n: u32| conditions.movement(n));
            MasterNodes::new(comm, masters, master, self.system.dofs, moves)
        };
        self.touching.nodes = pairs.iter().map(|pair| of_pair(pair.master)).collect();
    }

    /// Whether some contact has come to where the pattern does not provide for. Collective.
    fn lacks_pattern(&self) -> bool {
        let Model { masters, pairs, .. } = &*self.system.model;
        if masters.surfaces.is_empty() {
            return false;
        }
        let mut lacks = false;
        for (p, pair) in pairs.iter().enumerate() {
            let ground = masters.of(pair.master);
            for (s, _) in pair.slaves.iter().enumerate().filter(|(_, s)| s.trial.status != Status::Gap) {
                let slave = &pair.slaves[s];
                let patches = self.touching.meetings[p][s].iter().flat_map(|meeting| meeting.patches(slave));
                let patches: SmallVec<[u32; 4]> = patches.filter(|id| ground.patch(*id).is_some()).collect();
                lacks |= !self.system.pattern.candidates.has(p, s, &patches);
            }
        }
        any(self.system.comm, lacks)
    }

    /// Builds the pattern anew if it lacks something. Says whether. Collective.
    pub(super) fn widen_pattern(&mut self) -> Result<bool> {
        let widen = self.lacks_pattern();
        if widen {
            self.renew_pattern()?;
            self.course.rebuilds += 1;
        }
        Ok(widen)
    }

    /// Has all that touches stick where it is. Says whether what would be left of the pattern is provided for. Collective.
    pub(super) fn stick(&mut self) -> bool {
        let mut meetings = std::mem::take(&mut self.touching.meetings);
        let mut slips = false;
        for (pair, meetings) in self.system.model.pairs.iter().zip(&mut meetings) {
            for (slave, meeting) in pair.slaves.iter().zip(meetings) {
                let stuck = meeting.as_ref().map(|meeting| meeting.stuck(slave.trial.status));
                slips |= matches!(stuck, Some(None));
                *meeting = stuck.flatten();
            }
        }
        self.touching.meetings = meetings;
        !any(self.system.comm, slips) && !self.lacks_pattern()
    }

    /// Builds the pattern anew around where all is. Collective.
    pub(super) fn renew_pattern(&mut self) -> Result<()> {
        let (part, u) = (&self.system.model.part, &self.found.u);
        let place = |n: u32| part.points[n as usize] + u[n as usize];
        *self.system.pattern = Pattern::new(self.system.comm, self.system.model, self.system.dofs, place)?;
        self.values.resize(self.system.pattern.columns.len(), 0.0);
        self.holds_elements = false;
        Ok(())
    }

    /// The residuals of the multipliers of a slave node as it was evaluated.
    pub(super) fn constraint(&mut self, p: usize, s: usize) -> Vec3 {
        let Model { masters, pairs, .. } = &*self.system.model;
        let Some(meeting) = &self.touching.meetings[p][s] else { return Vec3::zeros() };
        let (ground, segments) = (masters.of(pairs[p].master), self.touching.segments[p].as_ref());
        self.touching.workspace.evaluate(&ground, (meeting, &pairs[p].slaves[s]), segments, false).constraint
    }

    /// Tangents of the contact elements; with held multipliers slave nodes learn from them how their forces change. Collective.
    pub(super) fn add_contact_tangent(&mut self, learns: bool) {
        let (dofs, pattern, values) = (&*self.system.dofs, &*self.system.pattern, &mut self.values);
        let mut foreign = vec![0.0; pattern.foreign.len()];
        let Model { part, masters, pairs, .. } = &mut *self.system.model;
        let u = &self.found.u;
        let place = |n: u32| part.points[n as usize] + u[n as usize];
        let mut equations = Vec::new();
        for (p, pair) in pairs.iter_mut().enumerate() {
            let ground = masters.of(pair.master);
            let of_master = &self.touching.nodes[p];
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let Some(meeting) = &self.touching.meetings[p][s] else { continue };
                let workspace = &mut self.touching.workspace;
                let segments = self.touching.segments[p].as_ref();
                let e = workspace.evaluate(&ground, (meeting, slave), segments, true);
                let multiplier = dofs.multiplier[p][s];
                if learns && pair.rules.method.holds_multipliers() {
                    workspace.learn(slave, &e, &ground, place);
                }
                if dofs.is_inclined {
                    let width = if pair.rules.friction > 0.0 { 3 } else { 1 };
                    let of = |n: u32| dofs.axes.of(n as usize);
                    workspace.turn(slave.node, width, of, |n| of_master.axes(n));
                }
                if !pair.rules.method.holds_multipliers() && pair.rules.friction > 0.0 {
                    workspace.hold(multiplier.map(|e| e != NONE), meeting);
                }
                let element = &workspace.element;
                equations.clear();
                equations.extend(dofs.node[slave.node as usize]);
                equations.extend(&multiplier[..if pair.rules.friction > 0.0 { 3 } else { 1 }]);
                equations.extend(element.beside.iter().flat_map(|&n| dofs.node[n as usize]));
                equations.extend(element.nodes.iter().flat_map(|&n| of_master.equations[n as usize]));
                let columns = element.shape[1];
                for (&row, entries) in equations.iter().zip(element.matrix.chunks(columns)).filter(|(r, _)| **r != NONE)
                {
                    let local = dofs.local(row);
                    for (&column, &value) in equations.iter().zip(entries).filter(|(c, v)| **c != NONE && **v != 0.0) {
                        if let Some(local) = local {
                            pattern.add(values, local, column, value);
                        } else if let Some(k) = pattern.foreign.index(row as i32, column as i32) {
                            foreign[k] += value;
                        }
                    }
                }
            }
        }
        pattern.foreign.deliver(self.system.comm, &foreign, values);
        self.guide_free_tools();
    }

    /// A tool that nothing touches yet gets the stiffness with which its force, or torque, drives it to the nearest slave node,
    /// and a little into it.
    fn guide_free_tools(&mut self) {
        let (pattern, tools) = (&*self.system.pattern, self.system.model.masters.tools.len());
        for (t, equations) in self.system.dofs.tool.iter().enumerate() {
            for (row, equation) in equations.iter().filter_map(|&e| Some((self.system.dofs.local(e)?, e))) {
                let entries = pattern.offsets[row] as usize..pattern.offsets[row + 1] as usize;
                if self.values[entries].iter().any(|value| *value != 0.0) {
                    continue;
                }
                let of_tool = self.system.model.pairs.iter().zip(&self.touching.clearances);
                let distance =
                    of_tool.filter(|(pair, _)| pair.master.tool() == Some(t % tools)).map(|(_, distance)| *distance);
                let distance = distance.reduce(f64::min).unwrap_or(f64::INFINITY);
                let force = self.system.conditions.tool_forces[t].at(self.s).norm();
                let compliance = 1.0 / self.system.model.stiffness + if force > 0.0 { distance / force } else { 0.0 };
                pattern.add(&mut self.values, row, equation, 1.0 / compliance);
            }
        }
    }

    /// Reduces the friction penalty of nodes whose status or slip direction flips again and again: they overshoot the
    /// friction cone from one side to the other. The solution does not depend on the penalty, only the path to it.
    pub(super) fn calm(&mut self) {
        let controls = self.system.model.controls;
        for pair in &mut self.system.model.pairs {
            for slave in &mut pair.slaves {
                if slave.trial.flips as usize >= controls.calm_flips && slave.calm(pair.rules.method, &controls) {
                    slave.trial.flips = 0;
                    self.course.calmed.push(slave.node);
                }
            }
        }
    }

    /// After convergence: a node that moved farther than the search reaches may have crossed the surface unseen, and one
    /// outside the region that was fetched may miss a patch. Widens the search and says whether it had to. Collective.
    pub fn widen_search(&mut self) -> bool {
        let Model { part, masters, pairs, controls, .. } = &mut *self.system.model;
        let then = |n: u32| part.points[n as usize] + self.system.committed[n as usize];
        let now = |n: u32| part.points[n as usize] + self.found.u[n as usize];
        let mut widen = false;
        for pair in pairs.iter_mut() {
            let travel = masters.travel(self.system.comm, pair, controls.watch_turn, then, now);
            if travel > pair.reach {
                pair.reach = pair.controls.reach_farther * travel;
                widen = true;
            }
        }
        widen |= masters.watch(self.system.comm, pairs, now);
        if widen {
            self.judge_again();
        }
        widen
    }

    /// The next solve judges this iterate again.
    pub fn judge_again(&mut self) {
        self.course.trace.pop();
        self.course.since = self.course.trace.len();
        self.course.changes.pop();
    }
}
