//! One increment as a nonlinear problem: residual, Jacobian, convergence and step length for SNES.
//!
//! Unknowns are the free displacements, the scaled multipliers λ' = λ / ε_n, the free translations of tools, and their rotations
//! by torques times a length; all are lengths, and all residuals are forces. The contact status is part of the residual. Nothing here touches the state of
//! the last converged increment. [`contact`] has the part of the contact elements, [`growth`] gives equations to slave nodes that
//! come to touch, [`rounds`] what Uzawa's method and active sets do around it, [`backtrack`] what keeps plastic flow
//! from overshooting, [`carry`] begins with what is turned, [`central`] what keeps contacts of sheets from going to and fro, [`drag`] what helps a jump along,
//! [`share`] how long an increment may be, [`unknowns`] what the unknowns stand for.

mod backtrack;
pub(super) mod balance;
mod carry;
mod central;
mod contact;
pub(super) mod drag;
mod growth;
mod rounds;
mod share;
mod spins;
mod springs;
mod ties;
mod unknowns;

use super::conditions::{Conditions, ToolMotion};
use crate::Vec3;
use crate::contact::{Manner, Pose, Status, note_bearers};
use crate::error::Error;
use crate::interrupt;
use crate::model::{Model, elements};
use crate::output::phases::{Phase, Phases};
use crate::parallel::{any, max, sum};
use crate::system::assembly;
use crate::system::dofs::Prescribed;
use crate::system::{DofMap, Pattern};
use backtrack::{LineSearch, Tried};
use balance::Balance;
pub use balance::Lost;
use contact::Touching;
use drag::Drag;
use mpi::topology::SimpleCommunicator;
use petsc::{Evaluation, Iterate, Jacobian, Problem, Verdict};
pub use rounds::Round;
use rounds::Rounds;
pub use share::Share;
use std::time::Instant;
pub use unknowns::update_halo;

/// Told the number of each iterate, its residual over the forces that that counts against, and how many contact nodes changed
/// their status, and touch.
pub type Watcher<'a> = dyn FnMut(usize, f64, [usize; 2]) -> crate::error::Result<()> + 'a;

/// What an increment is sought with.
pub struct System<'a> {
    pub comm: &'a SimpleCommunicator,
    pub model: &'a mut Model,
    pub dofs: &'a mut DofMap,
    pub pattern: &'a mut Pattern,
    pub conditions: &'a Conditions,
    pub phases: &'a Phases,
    /// Poses of the tools at the start of the step.
    pub start_poses: &'a [Pose],
    /// Converged displacements of the last increment, all local nodes, and what dashpots bore at its end on owned nodes.
    pub committed: &'a [Vec3],
    pub damped: &'a [Vec3],
}

/// An iterate, and what was found there.
pub struct Evaluated {
    /// Displacements, all local nodes.
    pub u: Vec<Vec3>,
    /// Translations of the tools along their free directions since the start of the step, then their rotations by torques.
    pub offsets: Vec<Vec3>,
    /// Internal less external forces plus contact forces on the owned nodes: zero where free, the reaction where held.
    pub forces: Vec<Vec3>,
    /// Contact force on each tool, then for each its moment about the origin.
    pub tool_forces: Vec<Vec3>,
    /// Sum of the internal forces of this rank on each body.
    internal: Vec<Vec3>,
    /// Forces and residuals. Those of other iterates do not count, for some are far from any equilibrium.
    pub(super) balance: Balance,
    /// Equation of this rank's largest residual, and that over the forces that it counts against.
    pub worst: (usize, f64),
    /// The unknowns.
    at: Vec<f64>,
}

/// How the iteration has gone so far.
#[derive(Default)]
pub struct Course {
    /// Largest residual over the forces that it counts against, at each iteration.
    pub trace: Vec<f64>,
    /// Its length when what is solved changed last, as by another active set: residuals before say nothing of how near it is.
    since: usize,
    /// Status changes at each iteration, over all ranks.
    pub changes: Vec<usize>,
    /// Nodes of this rank whose friction penalty was reduced because they kept flipping.
    pub calmed: Vec<u32>,
    /// How often the pattern was built anew.
    pub rebuilds: usize,
    /// How often slave nodes got equations, and iterations of this solve before they did.
    pub growths: usize,
    pub iterated: usize,
    /// Outer iterations.
    pub rounds: Rounds,
    /// A signal ended the iteration; the same on all ranks.
    pub interrupted: bool,
    /// Who was told of it ended the iteration; the same on all ranks.
    pub stopped: Option<Error>,
}

/// How the increment is sought.
struct Strategy<'a> {
    share: Share,
    tolerance: f64,
    /// A force below which nothing is of interest, N.
    least: f64,
    max_iterations: usize,
    watcher: &'a mut Watcher<'a>,
    /// What touches sticks until all is nearly in balance, or slips without friction.
    settling: bool,
    /// The latter.
    glides: bool,
    /// Constraints give way by more than they do anyway.
    yields: bool,
    /// It goes along the central path, and the stages of it that are left.
    central: bool,
    stages: usize,
    /// The prescribed displacements enter the first iteration linearly, from the last converged state.
    predicting: bool,
    /// Some prescribed displacement differs from that of the last converged state; the same on all ranks.
    moves: bool,
    drag: Drag,
}

/// An increment from the last converged state to the fraction `s` of the step.
pub struct Newton<'a> {
    pub system: System<'a>,
    /// Fraction of the step at the end of the increment.
    pub s: f64,
    pub found: Evaluated,
    pub course: Course,
    strategy: Strategy<'a>,
    line_search: LineSearch,
    touching: Touching,
    /// Entries of the Jacobian.
    values: Vec<f64>,
    /// They are the tangent of the elements at the last evaluated point, and no more yet.
    holds_elements: bool,
    /// The iterate at which the iteration stopped for slave nodes that need equations.
    growing: Option<Tried>,
    /// It goes on from there; the same on all ranks.
    resumes: bool,
}

/// State that outlives an increment, handed to [`Newton::new`].
pub struct Start<'a> {
    pub offsets: &'a [Vec3],
    pub s: f64,
    pub share: Share,
    pub tolerance: f64,
    pub max_iterations: usize,
    /// Largest force of each group of [`Balance`] in converged increments, and the forces that count while there are none.
    pub seen: &'a [f64],
    pub floors: &'a [f64],
    /// A force below which nothing is of interest, N, as it is given.
    pub least: f64,
    pub manner: Manner,
    /// Each residual must be below the last where plastic flow shortens steps.
    pub strict: bool,
}

impl<'a> Newton<'a> {
    pub fn new(system: System<'a>, (start, watcher): (&Start<'a>, &'a mut Watcher<'a>)) -> Self {
        let System { comm, model, dofs, pattern, conditions, committed, .. } = &system;
        let values = vec![0.0; pattern.columns.len()];
        let away = |(k, p): (usize, &Prescribed)| {
            let at = || conditions.axes.inward(k / 3, &committed[k / 3])[k % 3];
            // Turned there and back, displacements are rounded.
            let rounding = conditions.axes.of(k / 3).map_or(0.0, |_| 1e-14 * committed[k / 3].amax());
            p.is_some_and(|p| (conditions.place(&p, start.s) - at()).abs() > rounding)
        };
        let strategy = Strategy {
            share: start.share,
            tolerance: start.tolerance,
            least: start.least,
            max_iterations: start.max_iterations,
            watcher,
            settling: start.manner.settles || start.manner.glides,
            glides: start.manner.glides,
            yields: start.manner.yields,
            central: start.manner.central,
            stages: 0,
            predicting: true,
            moves: any(comm, conditions.prescribed.iter().enumerate().any(away)),
            drag: Drag::default(),
        };
        let found = Evaluated {
            u: committed.to_vec(),
            offsets: start.offsets.to_vec(),
            forces: vec![Vec3::zeros(); model.part.owned],
            tool_forces: vec![Vec3::zeros(); 2 * model.masters.tools.len()],
            internal: vec![Vec3::zeros(); model.bodies.len()],
            balance: Balance::new(model, dofs, start.seen.to_vec(), start.floors.to_vec()),
            worst: (0, 0.0),
            at: Vec::new(),
        };
        let memory = if start.strict { 1 } else { model.controls.line_search_memory };
        let line_search = LineSearch::new(model.can_flow(), memory);
        let (course, touching) = (Course::default(), Touching::new(model));
        let mut newton = Self {
            system,
            s: start.s,
            found,
            course,
            strategy,
            line_search,
            touching,
            values,
            holds_elements: false,
            growing: None,
            resumes: false,
        };
        let model = &mut *newton.system.model;
        model.history.go_back();
        let controls = model.controls;
        for pair in &mut model.pairs {
            pair.slaves.iter_mut().for_each(|slave| slave.begin(&start.manner, &controls, pair.facet_size));
        }
        note_bearers(&mut model.pairs);
        newton.learn();
        if start.manner.central && !newton.strategy.settling {
            newton.begin_central();
        }
        newton
    }

    /// Whether Newton's method will go on from the next iterate, as far as can be foreseen: when it converges quadratically,
    /// the one after a residual below the root of what is let through is the last.
    fn will_go_on(&self) -> bool {
        self.course.trace.last().is_none_or(|residual| residual * residual > self.limit())
    }

    /// Evaluates everything at `x`: forces, contact, residual; and the tangent of the elements, if it `will_go_on` from there,
    /// for the most of both is the same. `false` if an element of this rank is inverted. Collective.
    fn evaluate(&mut self, x: &[f64], r: &mut [f64], will_go_on: bool) -> bool {
        let begun = Instant::now();
        self.unpack(x);
        let mut forces = vec![Vec3::zeros(); self.system.model.part.points.len()];
        self.found.balance.clear();
        let balance = &mut self.found.balance;
        let model = &*self.system.model;
        let of_element =
            |section: u32, nodes: &[u32], own: &[[f64; 3]]| balance.element(&model.part, section, nodes, own);
        // Enhanced strain goes on from the last tangent: one that is not used must not be it.
        let with_tangent = will_go_on && model.sections.iter().all(|section| !section.element.is_enhanced());
        let tangent = with_tangent.then(|| {
            self.values.fill(0.0);
            (&*self.system.pattern, &mut self.values[..])
        });
        let sound = assembly::internal_forces(model, &self.found.u, &mut forces, tangent, of_element).is_ok();
        self.holds_elements = with_tangent && sound;
        self.found.internal.fill(Vec3::zeros());
        let part = &model.part;
        self.found.balance.internal(part, &forces);
        for (n, force) in forces.iter().enumerate().take(part.owned) {
            self.found.internal[part.body[n] as usize] += force;
        }
        let ahead = (self.strategy.predicting && self.strategy.moves).then(|| self.prescribed_increments());
        if let Some(ahead) = &ahead {
            assembly::add_tangent_times(self.system.model, &self.found.u, ahead, &mut forces);
        }
        self.add_loads(&mut forces);
        forces.truncate(self.system.model.part.owned);
        self.found.forces = forces;
        self.system.phases.add(Phase::Assembly, begun.elapsed());
        r.fill(0.0);
        if !self.system.model.is_alone() {
            let begun = Instant::now();
            self.add_contact(x, ahead.as_deref(), r);
            self.system.phases.add(Phase::Search, begun.elapsed());
        }
        self.add_ties(x, ahead.as_deref(), r);
        for n in 0..self.system.model.part.owned {
            let force = self.system.dofs.axes.inward(n, &self.found.forces[n]);
            for d in 0..3 {
                if let Some(k) = self.system.dofs.local(self.system.dofs.node[n][d]) {
                    r[k] += force[d];
                }
            }
        }
        self.add_springs(r);
        self.add_drag(x, r);
        self.judge(r);
        if self.line_search.is_wanted {
            self.line_search.squared_residual = backtrack::squared(self.system.comm, r, self.touching.left_out);
        }
        self.found.at.clear();
        self.found.at.extend(x);
        sound
    }

    /// The iterate is no prediction any more. Says whether it was.
    fn predicted(&mut self) -> bool {
        self.system.model.pairs.iter_mut().flat_map(|p| &mut p.slaves).for_each(|slave| slave.law.clings = false);
        std::mem::replace(&mut self.strategy.predicting, false)
    }

    /// Whether this is the first iteration of a step.
    fn is_first(&self) -> bool {
        self.strategy.predicting && self.strategy.share.begin == 0.0
    }

    /// External forces on the owned nodes.
    pub(super) fn loads(&mut self) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); self.system.model.part.points.len()];
        self.add_loads(&mut forces);
        forces.truncate(self.system.model.part.owned);
        forces.into_iter().map(|force| -force).collect()
    }

    fn add_loads(&mut self, forces: &mut [Vec3]) {
        for (n, (force, load)) in forces.iter_mut().zip(&self.system.conditions.loads).enumerate() {
            let load = load.at(self.s);
            *force -= load;
            self.found.balance.load(self.system.model.part.section[n] as usize, load.amax());
        }
        self.add_spins(forces);
        if self.system.conditions.pressures.is_empty() {
            return;
        }
        let before = forces.to_vec();
        for (set, ramp) in &self.system.conditions.pressures {
            assembly::subtract_pressure(self.system.model, set, ramp.at(self.s), &self.found.u, forces);
        }
        let part = &self.system.model.part;
        for (n, (force, before)) in forces.iter().zip(&before).enumerate().take(part.owned) {
            self.found.balance.load(part.section[n] as usize, (force - before).amax());
        }
    }
}

impl Newton<'_> {
    /// The Jacobian at the last evaluated point, in `self.values`.
    fn tangent(&mut self) {
        if !std::mem::take(&mut self.holds_elements) {
            self.values.fill(0.0);
            assembly::add_tangent(self.system.model, self.system.pattern, &self.found.u, &mut self.values);
        }
        self.complete_tangent(true);
    }

    /// Adds what is not of the elements; slave nodes may learn from it.
    fn complete_tangent(&mut self, learns: bool) {
        for (set, ramp) in &self.system.conditions.pressures {
            let system = (&*self.system.dofs, &*self.system.pattern);
            assembly::subtract_pressure_tangent(
                self.system.model,
                (set, ramp.at(self.s)),
                &self.found.u,
                system,
                &mut self.values,
            );
        }
        if !self.system.model.is_alone() {
            self.add_contact_tangent(learns);
        }
        self.add_tie_tangent();
        self.add_spring_tangent();
        self.add_spin_tangent();
        self.add_drag_tangent();
    }

    /// The Jacobian at the last evaluated point if all that touches stuck there; `None` where that is not known. The meetings are
    /// of no use for a residual after that. Collective.
    pub fn stuck_tangent(&mut self) -> Option<&[f64]> {
        let begun = Instant::now();
        let mut is_known = self.stick();
        if is_known {
            let Self { system, values, found, .. } = self;
            values.fill(0.0);
            let mut forces = vec![Vec3::zeros(); found.u.len()];
            let tangent = Some((&*system.pattern, &mut values[..]));
            let done = assembly::internal_forces(system.model, &found.u, &mut forces, tangent, |_, _, _| {});
            is_known = !any(system.comm, done.is_err());
        }
        if is_known {
            self.complete_tangent(false);
        }
        self.holds_elements = false;
        self.system.phases.add(Phase::Assembly, begun.elapsed());
        is_known.then_some(&self.values[..])
    }
}

impl Problem for Newton<'_> {
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> std::result::Result<Evaluation, String> {
        let may_know = std::mem::take(&mut self.resumes) || self.line_search.is_wanted;
        let sound = (may_know && self.recall(x, r)) || self.evaluate(x, r, self.will_go_on());
        Ok(if sound { Evaluation::Done } else { Evaluation::OutOfDomain })
    }

    fn jacobian(&mut self, x: &[f64]) -> std::result::Result<Jacobian<'_>, String> {
        if any(self.system.comm, self.found.at != x) {
            let mut r = vec![0.0; x.len()];
            self.evaluate(x, &mut r, true);
        }
        let begun = Instant::now();
        let is_new = self.widen_pattern().map_err(|error| error.to_string())?;
        self.tangent();
        self.system.phases.add(Phase::Assembly, begun.elapsed());
        let (Pattern { offsets, columns, .. }, values) = (&*self.system.pattern, &self.values);
        Ok(if is_new { Jacobian::Pattern { row_offsets: offsets, columns, values } } else { Jacobian::Values(values) })
    }

    fn converged(&mut self, iterate: &Iterate<'_>) -> std::result::Result<Verdict, String> {
        let iteration = self.course.iterated + iterate.iteration;
        let trials = || self.system.model.pairs.iter().flat_map(|p| &p.slaves).map(|s| &s.trial);
        let touching = trials().filter(|t| t.status != Status::Gap).count();
        let changes = trials().filter(|t| t.changed).count();
        let [wished, lacks] = [interrupt::wished(), self.lacks_equations()];
        let mut counts = [changes as f64, f64::from(wished), touching as f64, f64::from(lacks)];
        sum(self.system.comm, &mut counts);
        let [changes, wishes, touching, lacking] = counts;
        if lacking > 0.0 {
            self.stop_to_grow(iterate);
            return Ok(Verdict::Diverged);
        }
        let residual = self.found.balance.relative();
        self.course.trace.push(residual);
        self.course.changes.push(changes as usize);
        if let Err(error) = (self.strategy.watcher)(iteration, residual, [changes, touching].map(|n| n as usize)) {
            self.course.stopped = Some(error);
            return Ok(Verdict::Diverged);
        }
        // What a motion begins with may be small against all forces and yet be its whole effect, as on a thin sheet, of which
        // the forces round to more than its contact feels of the first gap.
        let driven =
            self.strategy.moves || self.system.model.masters.tools.iter().any(|tool| tool.trial != tool.committed);
        let begins = self.course.trace.len() == 1 && driven && touching > 0.0 && residual > 0.0;
        let small = self.found.balance.holds(self.tolerance_now()) && !begins;
        if !residual.is_finite() {
            return Ok(Verdict::Diverged);
        }
        let soon = self.strategy.settling && !self.strategy.glides;
        let settled = small || soon && iteration >= self.system.model.controls.settling_iterations;
        if settled && !(self.strategy.predicting && self.strategy.moves) {
            return Ok(Verdict::Converged);
        }
        self.course.interrupted = wishes > 0.0;
        if self.course.interrupted || iteration >= self.strategy.max_iterations {
            return Ok(Verdict::Diverged);
        }
        self.calm();
        Ok(Verdict::Iterate)
    }

    /// Shortens a step that would move a slave node by more than a facet or turn an element inside out, or plastic flow too
    /// far.
    fn limit_step(&mut self, x: &[f64], step: &mut [f64]) -> std::result::Result<bool, String> {
        // The residual of a prediction says nothing.
        let judged = !self.predicted();
        let part = if judged { 1.0 } else { self.shorten(x, step) };
        scale(step, part);
        // The longest, and the shortest that is too long; negative, so that the shortest of all ranks is found too; and the largest
        // angle.
        let mut longest = [0.0, f64::NEG_INFINITY, self.turning(step)];
        for pair in &self.system.model.pairs {
            longest[1] = longest[1].max(-pair.longest_step());
            for slave in &pair.slaves {
                for d in 0..3 {
                    if let Some(k) = self.system.dofs.local(self.system.dofs.node[slave.node as usize][d]) {
                        longest[0] = longest[0].max(step[k].abs());
                    }
                }
            }
        }
        max(self.system.comm, &mut longest);
        let cap = -longest[1];
        let mut factor = if longest[0] > cap { cap / longest[0] } else { 1.0 };
        let turn = self.system.model.controls.step_turn;
        factor = factor.min(turn / longest[2].max(turn));
        for _ in 0..self.system.model.controls.step_halvings {
            if !self.would_invert(x, step, factor, !(self.line_search.is_wanted && judged)) {
                break;
            }
            factor *= 0.5;
        }
        scale(step, factor);
        if self.line_search.is_wanted && judged {
            let part = self.backtrack(x, step);
            scale(step, part);
            factor *= part;
        }
        Ok(part * factor < 1.0)
    }
}

impl Newton<'_> {
    /// The largest angle by which a step turns a tool that a torque drives.
    fn turning(&self, step: &[f64]) -> f64 {
        let dofs = &*self.system.dofs;
        let own = dofs.tool[self.system.conditions.motions.len()..].iter().zip(&self.system.conditions.motions);
        let angle =
            |(equations, motion): (&[i64; 3], &ToolMotion)| Some(step[dofs.local(equations[0])?] / motion.axle?.lever);
        own.filter_map(angle).fold(0.0, |most, angle| most.max(angle.abs()))
    }

    /// Whether an element is inverted at x - factor step, on any rank; with `solve`, or cannot be evaluated. Collective.
    fn would_invert(&mut self, x: &[f64], step: &[f64], factor: f64, solve: bool) -> bool {
        let there: Vec<f64> = x.iter().zip(step).map(|(x, s)| x - factor * s).collect();
        self.unpack(&there);
        any(self.system.comm, elements::any_inverted(self.system.model, &self.found.u, solve))
    }
}

fn scale(step: &mut [f64], factor: f64) {
    step.iter_mut().for_each(|v| *v *= factor);
}
