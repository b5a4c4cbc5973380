//! One increment as a nonlinear problem: residual, Jacobian, convergence and step length for SNES.
//!
//! Unknowns are the free displacements, the scaled multipliers λ' = λ / ε_n, and the free translations of tools; all are
//! lengths, and all residuals are forces. The contact status is part of the residual. Nothing here touches the state of
//! the last converged increment. [`contact`] has the part of the contact elements on tools, [`deformable`] that of those
//! on deformable masters, [`rounds`] what Uzawa's method and active sets do around it, [`backtrack`] what keeps plastic flow
//! from overshooting, [`drag`] what helps a jump along,
//! [`share`] how long an increment may be.

mod backtrack;
pub(super) mod balance;
mod contact;
mod deformable;
mod drag;
mod rounds;
mod share;

use super::conditions::Conditions;
use crate::Vec3;
use crate::contact::element::Element;
use crate::contact::{Manner, Pair, Pose, Slave, Status};
use crate::error::Error;
use crate::interrupt;
use crate::model::{Model, elements};
use crate::output::phases::{Phase, Phases};
use crate::parallel::{any, max, sum};
use crate::system::assembly;
use crate::system::dofs::{NONE, Prescribed};
use crate::system::{DofMap, Pattern};
use backtrack::Tried;
use balance::Balance;
pub(super) use deformable::relative_travel;
use deformable::{Meeting, Workspace};
use drag::Drag;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{Evaluation, Iterate, Jacobian, Problem, Verdict};
pub use rounds::Round;
use rounds::Rounds;
pub use share::Share;
use std::time::Instant;

/// Told the number of each iterate, its residual over the forces that that counts against, and how many contact nodes changed
/// their status.
pub type Watcher<'a> = dyn FnMut(usize, f64, usize) -> crate::error::Result<()> + 'a;

/// An increment from the last converged state to the fraction `s` of the step.
pub struct Newton<'a> {
    pub comm: &'a SimpleCommunicator,
    pub model: &'a mut Model,
    pub dofs: &'a DofMap,
    pub pattern: &'a mut Pattern,
    pub conditions: &'a Conditions,
    pub phases: &'a Phases,
    /// Poses of the tools at the start of the step.
    pub start_poses: &'a [Pose],
    /// Converged displacements of the last increment, all local nodes.
    pub committed: &'a [Vec3],
    /// Fraction of the step at the end of the increment.
    pub s: f64,
    share: Share,
    pub tolerance: f64,
    pub max_iterations: usize,
    watcher: &'a mut Watcher<'a>,
    /// Forces and residuals of this iterate. Those of other iterates do not count, for some are far from any equilibrium.
    pub(super) balance: Balance,
    /// Sum of the internal forces of this rank on each body.
    pub(super) internal: Vec<Vec3>,
    /// Displacements of the iterate, all local nodes.
    pub u: Vec<Vec3>,
    /// Internal less external forces plus contact forces on the owned nodes: zero where free, the reaction where held.
    pub forces: Vec<Vec3>,
    /// Translations of the tools along their free directions since the start of the step.
    pub offsets: Vec<Vec3>,
    /// Largest residual over the forces that it counts against, at each iteration so far.
    pub trace: Vec<f64>,
    /// Status changes at each iteration so far, over all ranks.
    pub changes: Vec<usize>,
    /// Equation of this rank's largest residual, and that over the forces that it counts against.
    pub worst: (usize, f64),
    /// Nodes of this rank whose friction penalty was reduced because they kept flipping.
    pub calmed: Vec<u32>,
    /// How often the pattern was built anew.
    pub rebuilds: usize,
    /// A signal ended the iteration; the same on all ranks.
    pub interrupted: bool,
    /// Who was told of it ended the iteration; the same on all ranks.
    pub stopped: Option<Error>,
    /// What touches sticks until all is nearly in balance.
    pub(super) settling: bool,
    /// Outer iterations of this increment.
    pub rounds: Rounds,
    elements: Vec<Vec<Option<Element>>>,
    meetings: Vec<Vec<Option<Meeting>>>,
    workspace: Workspace,
    drag: Drag,
    /// Some body can flow.
    plastic: bool,
    /// The iterate that the last step leads to, where it was tried.
    tried: Option<Tried>,
    /// Contact force on each tool.
    pub tool_forces: Vec<Vec3>,
    /// Distance of each tool from the nearest slave node, at most its reach; 0 in contact.
    clearances: Vec<f64>,
    /// The prescribed displacements enter the first iteration linearly, from the last converged state.
    predicting: bool,
    /// Some prescribed displacement differs from that of the last converged state; the same on all ranks.
    moves: bool,
    /// The square of its length, where some body can flow.
    squared_residual: f64,
    /// That of the iterates so far, and below how many of the last the next must fall.
    recent: Vec<f64>,
    memory: usize,
    evaluated_at: Vec<f64>,
    values: Vec<f64>,
}

/// State that outlives an increment, handed to [`Newton::new`].
pub struct Start<'a> {
    pub start_poses: &'a [Pose],
    pub committed: &'a [Vec3],
    pub offsets: &'a [Vec3],
    pub s: f64,
    pub share: Share,
    pub tolerance: f64,
    pub max_iterations: usize,
    /// Largest force of each group of [`Balance`] in converged increments, and the forces that count while there are none.
    pub seen: &'a [f64],
    pub floors: &'a [f64],
    pub manner: Manner,
    /// Each residual must be below the last where plastic flow shortens steps.
    pub strict: bool,
}

impl<'a> Newton<'a> {
    pub fn new(
        comm: &'a SimpleCommunicator,
        model: &'a mut Model,
        dofs: &'a DofMap,
        pattern: &'a mut Pattern,
        conditions: &'a Conditions,
        phases: &'a Phases,
        (start, watcher): (&Start<'a>, &'a mut Watcher<'a>),
    ) -> Self {
        let elements = model.pairs.iter().map(|p| vec![None; p.slaves.len()]).collect();
        let meetings = model.pairs.iter().map(|p| vec![None; p.slaves.len()]).collect();
        let values = vec![0.0; pattern.columns.len()];
        let tools = model.tools.len();
        let owned = model.part.owned;
        let controls = model.controls;
        for slave in model.pairs.iter_mut().flat_map(|p| &mut p.slaves) {
            slave.begin(&start.manner, &controls);
        }
        let away = |(k, p): (usize, &Prescribed)| {
            p.is_some_and(|(from, by)| from + by * start.s != start.committed[k / 3][k % 3])
        };
        model.history.go_back();
        let plastic = model.can_flow();
        let moves = any(comm, conditions.prescribed.iter().enumerate().any(away));
        let balance = Balance::new(model, dofs, start.seen.to_vec(), start.floors.to_vec());
        let internal = vec![Vec3::zeros(); model.bodies.len()];
        let mut newton = Self {
            comm,
            model,
            dofs,
            pattern,
            conditions,
            phases,
            start_poses: start.start_poses,
            committed: start.committed,
            s: start.s,
            share: start.share,
            tolerance: start.tolerance,
            max_iterations: start.max_iterations,
            watcher,
            balance,
            internal,
            u: start.committed.to_vec(),
            forces: vec![Vec3::zeros(); owned],
            offsets: start.offsets.to_vec(),
            trace: Vec::new(),
            changes: Vec::new(),
            worst: (0, 0.0),
            calmed: Vec::new(),
            rebuilds: 0,
            interrupted: false,
            stopped: None,
            settling: start.manner.settles,
            rounds: Rounds::default(),
            elements,
            meetings,
            workspace: Workspace::default(),
            drag: Drag::default(),
            plastic,
            tried: None,
            tool_forces: vec![Vec3::zeros(); tools],
            clearances: vec![0.0; tools],
            predicting: true,
            moves,
            squared_residual: f64::INFINITY,
            recent: Vec::new(),
            memory: if start.strict { 1 } else { controls.line_search_memory },
            evaluated_at: Vec::new(),
            values,
        };
        newton.learn();
        newton
    }

    /// Starts from given unknowns, with the prescribed displacements of the end of the increment; or on the way there, if the
    /// increment is to be shorter.
    pub fn start_ahead(&mut self, trial: &[f64], x: &mut [f64]) {
        self.predicting = false;
        self.start_behind(x);
        let step: Vec<f64> = x.iter().zip(trial).map(|(x, t)| x - t).collect();
        let part = self.shorten(x, &step);
        if part < 1.0 {
            x.iter_mut().zip(step).for_each(|(x, s)| *x -= part * s);
        } else {
            x.copy_from_slice(trial);
        }
    }

    /// Starts from the unknowns of the last converged state; the prescribed displacements enter the first iteration linearly.
    pub fn start_behind(&self, x: &mut [f64]) {
        for n in 0..self.model.part.owned {
            for d in 0..3 {
                if let Some(k) = self.dofs.local(self.dofs.node[n][d]) {
                    x[k] = self.committed[n][d];
                }
            }
        }
        for (pair, equations) in self.model.pairs.iter().zip(&self.dofs.multiplier) {
            for (slave, equations) in pair.slaves.iter().zip(equations) {
                for d in 0..3 {
                    if let Some(k) = self.dofs.local(equations[d]) {
                        x[k] = slave.committed.multiplier[d] / slave.law.normal;
                    }
                }
            }
        }
        for (equations, offset) in self.dofs.tool.iter().zip(&self.offsets) {
            for d in 0..3 {
                if let Some(k) = self.dofs.local(equations[d]) {
                    x[k] = offset[d];
                }
            }
        }
    }

    /// The value that a prescribed displacement has in this evaluation, or its linear part that is still to come.
    fn prescribed(&self, node: usize, d: usize) -> Option<f64> {
        self.conditions.prescribed[3 * node + d]
            .map(|(start, by)| if self.predicting { self.committed[node][d] } else { start + by * self.s })
    }

    /// Sets displacements and tool poses from the unknowns. Collective.
    fn unpack(&mut self, x: &[f64]) {
        let part = &self.model.part;
        for n in 0..part.owned {
            for d in 0..3 {
                self.u[n][d] = match self.dofs.local(self.dofs.node[n][d]) {
                    Some(k) => x[k],
                    None => self.prescribed(n, d).unwrap_or(self.committed[n][d]),
                };
            }
        }
        for n in 0..part.owned {
            self.u[n] = self.u[part.tie[n] as usize];
        }
        update_halo(self.model, self.comm, &mut self.u);
        let free: Vec<(usize, usize)> = (0..self.dofs.tool.len())
            .flat_map(|t| (0..3).map(move |d| (t, d)))
            .filter(|&(t, d)| self.dofs.tool[t][d] != NONE)
            .collect();
        if !free.is_empty() {
            let mut offsets: Vec<f64> =
                free.iter().map(|&(t, d)| self.dofs.local(self.dofs.tool[t][d]).map_or(0.0, |k| x[k])).collect();
            self.comm.process_at_rank(0).broadcast_into(&mut offsets[..]);
            for (&(t, d), q) in free.iter().zip(offsets) {
                self.offsets[t][d] = q;
            }
        }
        self.conditions.place_tools(&mut self.model.tools, self.start_poses, &self.offsets, self.s);
    }

    /// Evaluates everything at `x`: forces, contact, residual. `false` if an element of this rank is inverted. Collective.
    fn evaluate(&mut self, x: &[f64], r: &mut [f64]) -> bool {
        let begun = Instant::now();
        self.unpack(x);
        let mut forces = vec![Vec3::zeros(); self.model.part.points.len()];
        self.balance.clear();
        let balance = &mut self.balance;
        let of_element = |body: u32, force: f64| balance.element(body as usize, force);
        let sound = assembly::internal_forces(self.model, &self.u, &mut forces, of_element).is_ok();
        self.internal.fill(Vec3::zeros());
        for (force, body) in forces.iter().zip(&self.model.part.body).take(self.model.part.owned) {
            self.balance.force(*body as usize, force.amax());
            self.internal[*body as usize] += force;
        }
        let ahead = (self.predicting && self.moves).then(|| self.prescribed_increments());
        if let Some(ahead) = &ahead {
            assembly::add_tangent_times(self.model, &self.u, ahead, &mut forces);
        }
        self.add_loads(&mut forces);
        forces.truncate(self.model.part.owned);
        self.forces = forces;
        self.phases.add(Phase::Assembly, begun.elapsed());
        r.fill(0.0);
        let begun = Instant::now();
        self.add_contact(x, ahead.as_deref(), r);
        self.add_deformable(x, ahead.as_deref(), r);
        self.phases.add(Phase::Search, begun.elapsed());
        for n in 0..self.model.part.owned {
            for d in 0..3 {
                if let Some(k) = self.dofs.local(self.dofs.node[n][d]) {
                    r[k] += self.forces[n][d];
                }
            }
        }
        self.add_drag(x, r);
        self.judge(r);
        if self.plastic {
            self.squared_residual = backtrack::squared(self.comm, r);
        }
        self.evaluated_at.clear();
        self.evaluated_at.extend(x);
        sound
    }

    /// Whether this is the first iteration of a step.
    fn is_first(&self) -> bool {
        self.predicting && self.share.begin == 0.0
    }

    /// How far each prescribed displacement still is from its value at the end of the increment; zero elsewhere. Collective.
    fn prescribed_increments(&self) -> Vec<Vec3> {
        let mut ahead = vec![Vec3::zeros(); self.model.part.points.len()];
        for n in 0..self.model.part.owned {
            for d in 0..3 {
                if let Some((start, by)) = self.conditions.prescribed[3 * n + d] {
                    ahead[n][d] = start + by * self.s - self.committed[n][d];
                }
            }
        }
        update_halo(self.model, self.comm, &mut ahead);
        ahead
    }

    fn add_loads(&mut self, forces: &mut [Vec3]) {
        for (n, (force, load)) in forces.iter_mut().zip(&self.conditions.loads).enumerate() {
            let load = load.at(self.s);
            *force -= load;
            self.balance.action(self.model.part.body[n] as usize, load.amax());
        }
        for (set, ramp) in &self.conditions.pressures {
            assembly::subtract_pressure(self.model, set, ramp.at(self.s), &self.u, forces);
        }
    }
}

impl Newton<'_> {
    /// The Jacobian at the last evaluated point, in `self.values`.
    fn tangent(&mut self) {
        self.values.fill(0.0);
        assembly::add_tangent(self.model, self.pattern, &self.u, &mut self.values);
        for (set, ramp) in &self.conditions.pressures {
            let system = (self.dofs, &*self.pattern);
            assembly::subtract_pressure_tangent(self.model, (set, ramp.at(self.s)), &self.u, system, &mut self.values);
        }
        self.add_contact_tangent();
        self.add_deformable_tangent();
        self.add_drag_tangent();
    }
}

impl Problem for Newton<'_> {
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> std::result::Result<Evaluation, String> {
        let sound = (self.plastic && self.recall(x, r)) || self.evaluate(x, r);
        Ok(if sound { Evaluation::Done } else { Evaluation::OutOfDomain })
    }

    fn jacobian(&mut self, x: &[f64]) -> std::result::Result<Jacobian<'_>, String> {
        if any(self.comm, self.evaluated_at != x) {
            let mut r = vec![0.0; x.len()];
            self.evaluate(x, &mut r);
        }
        let begun = Instant::now();
        let is_new = self.widen_pattern().map_err(|error| error.to_string())?;
        self.tangent();
        self.phases.add(Phase::Assembly, begun.elapsed());
        let (Pattern { offsets, columns, .. }, values) = (&*self.pattern, &self.values);
        Ok(if is_new { Jacobian::Pattern { row_offsets: offsets, columns, values } } else { Jacobian::Values(values) })
    }

    fn converged(&mut self, iterate: &Iterate<'_>) -> std::result::Result<Verdict, String> {
        let iteration = iterate.iteration;
        let trials = || self.model.pairs.iter().flat_map(|p| &p.slaves).map(|s| &s.trial);
        let touching = trials().any(|t| t.status != Status::Gap);
        let mut counts =
            [trials().filter(|t| t.changed).count() as f64, f64::from(interrupt::wished()), f64::from(touching)];
        sum(self.comm, &mut counts);
        let [changes, wishes, touching] = counts;
        let residual = self.balance.relative();
        self.trace.push(residual);
        self.changes.push(changes as usize);
        if let Err(error) = (self.watcher)(iteration, residual, changes as usize) {
            self.stopped = Some(error);
            return Ok(Verdict::Diverged);
        }
        // What a motion begins with may be small against all forces and yet be its whole effect, as on a thin sheet, of which
        // the forces round to more than its contact feels of the first gap.
        let driven = self.moves || self.model.tools.iter().any(|tool| tool.trial != tool.committed);
        let begins = self.trace.len() == 1 && driven && touching > 0.0 && residual > 0.0;
        let small = self.balance.holds(self.tolerance_now()) && !begins;
        if !residual.is_finite() {
            return Ok(Verdict::Diverged);
        }
        let settled = small || self.settling && iteration >= self.model.controls.settling_iterations;
        if settled && !(self.predicting && self.moves) {
            return Ok(Verdict::Converged);
        }
        self.interrupted = wishes > 0.0;
        if self.interrupted || iteration >= self.max_iterations {
            return Ok(Verdict::Diverged);
        }
        self.calm();
        Ok(Verdict::Iterate)
    }

    /// Shortens a step that would move a slave node by more than a facet or turn an element inside out, or plastic flow too
    /// far.
    fn limit_step(&mut self, x: &[f64], step: &mut [f64]) -> std::result::Result<bool, String> {
        // The residual of a prediction says nothing.
        let judged = !std::mem::replace(&mut self.predicting, false);
        let part = if judged { 1.0 } else { self.shorten(x, step) };
        scale(step, part);
        // The longest, and the shortest that is too long; negative, so that the shortest of all ranks is found too.
        let mut longest = [0.0, f64::NEG_INFINITY];
        for pair in &self.model.pairs {
            longest[1] = longest[1].max(-pair.longest_step());
            for slave in &pair.slaves {
                for d in 0..3 {
                    if let Some(k) = self.dofs.local(self.dofs.node[slave.node as usize][d]) {
                        longest[0] = longest[0].max(step[k].abs());
                    }
                }
            }
        }
        max(self.comm, &mut longest);
        let cap = -longest[1];
        let mut factor = if longest[0] > cap { cap / longest[0] } else { 1.0 };
        for _ in 0..self.model.controls.step_halvings {
            if !self.would_invert(x, step, factor, !(self.plastic && judged)) {
                break;
            }
            factor *= 0.5;
        }
        scale(step, factor);
        if self.plastic && judged {
            let part = self.backtrack(x, step);
            scale(step, part);
            factor *= part;
        }
        Ok(part * factor < 1.0)
    }
}

impl Newton<'_> {
    /// The multipliers at the unknowns `x`, N; those that are held are the forces.
    pub fn multipliers(&self, x: &[f64]) -> Vec<Vec<Vec3>> {
        let of = |slave: &Slave, equations: &[i64; 3]| {
            Vec3::from_fn(|d, _| self.dofs.local(equations[d]).map_or(0.0, |k| x[k] * slave.law.normal))
        };
        let pairs = self.model.pairs.iter().zip(&self.dofs.multiplier);
        let forces = |pair: &Pair| pair.slaves.iter().map(|s| s.trial.force).collect();
        let unknowns = |pair: &Pair, all: &[[i64; 3]]| pair.slaves.iter().zip(all).map(|(s, e)| of(s, e)).collect();
        pairs.map(|(pair, all)| if pair.width() == 0 { forces(pair) } else { unknowns(pair, all) }).collect()
    }

    /// Whether an element is inverted at x - factor step, on any rank; with `solve`, or cannot be evaluated. Collective.
    fn would_invert(&mut self, x: &[f64], step: &[f64], factor: f64, solve: bool) -> bool {
        let there: Vec<f64> = x.iter().zip(step).map(|(x, s)| x - factor * s).collect();
        self.unpack(&there);
        any(self.comm, elements::any_inverted(self.model, &self.u, solve))
    }
}

fn scale(step: &mut [f64], factor: f64) {
    step.iter_mut().for_each(|v| *v *= factor);
}

/// Gives halo nodes the displacements of their owners. Collective.
pub fn update_halo(model: &Model, comm: &SimpleCommunicator, u: &mut [Vec3]) {
    let mut flat: Vec<f64> = u.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    model.part.halo.update(comm, 3, &mut flat);
    for (v, value) in u.iter_mut().zip(flat.as_chunks::<3>().0) {
        *v = Vec3::from(*value);
    }
}
