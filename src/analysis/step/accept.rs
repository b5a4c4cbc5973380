//! What becomes of an increment that has converged: it is made the state.

use super::super::ladder::Way;
use super::super::state::Progress;
use super::super::{ContactNodes, Increment, Simulation};
use super::Frame;
use super::attempt::Converged;
use crate::contact::Status;
use crate::controls::Controls;
use crate::error::Result;
use crate::model::{Model, states};
use crate::parallel::{agree, first_word, sum};
use crate::system::dofs::node_name;
use petsc::Vector;

impl Progress {
    /// Remembers the unknowns of a converged increment.
    fn remember(&mut self, end: f64, x: &[f64]) {
        self.past.push((end, x.to_vec()));
        if self.past.len() > 3 {
            self.past.remove(0);
        }
    }
}

impl Simulation<'_> {
    /// Makes a converged increment the state. Collective.
    ///
    /// # Errors
    /// An element that cannot follow; the state is then what it was.
    pub(in super::super) fn commit(&mut self, frame: &mut Frame, converged: &Converged) -> Result<()> {
        let flown = agree(self.comm, states::flown(&mut self.model, &converged.u))?;
        self.model.history.accept(flown);
        for tool in &mut self.model.masters.tools {
            tool.committed = tool.trial;
        }
        let Model { part, masters, pairs, joints, .. } = &mut self.model;
        for (joint, forces) in joints.iter_mut().zip(&converged.forces.ties) {
            joint.slaves.iter_mut().zip(forces).for_each(|(slave, force)| slave.force = *force);
        }
        for (pair, multipliers) in pairs.iter_mut().zip(&converged.forces.contacts) {
            let ground = masters.of(pair.master);
            for (s, multiplier) in multipliers.iter().enumerate() {
                let node = pair.slaves[s].node as usize;
                let position = part.points[node] + converged.u[node];
                let slid = pair.slid_off(s, &ground, &position);
                pair.slaves[s].commit(pair.rules.method, *multiplier, &ground, &position, slid);
            }
        }
        frame.progress.offsets.clone_from(&converged.offsets);
        self.state.u.clone_from(&converged.u);
        self.model.turn_slaves(&self.state.u);
        self.model.follow_sheets(self.comm, &self.state.u);
        // Loads act on all nodes that move as one, what resists them on the one that stands for all.
        let supported = &frame.progress.conditions.supported;
        self.state.reactions = self.model.part.evened(&converged.forces.nodes, supported);
        self.state.damped.clone_from(&converged.forces.dashpots);
        self.state.tool_forces.clone_from(&converged.forces.tools);
        Ok(())
    }

    /// Makes a converged increment the state, and says what it was. Collective.
    pub(super) fn accept(&mut self, frame: &mut Frame, converged: Converged, x: &Vector) -> Result<Increment> {
        let busy = self.is_busy(&converged.limits);
        let ways = self.ways(&frame.progress, converged.end, &converged.u);
        let Progress { increments, ladder, past, step, start, .. } = &mut frame.progress;
        let is_remedy = ladder.is_remedy() || ladder.lingers();
        let way = ladder.succeed(!converged.loose.is_empty());
        let is_jump = way == Way::Jump;
        let end = converged.end;
        let (is_first, share) = (increments.done == 0.0, end - increments.done);
        let iterations = converged.effort.residuals.len() - 1;
        let size = (end - increments.done) * step.duration;
        let time = *start + end * step.duration;
        increments.accept(end, iterations.div_ceil(1 + converged.effort.rounds), busy);
        if is_jump {
            increments.resume();
        }
        let ends_step = increments.next().is_none();
        // Where a table turns, the solution does not go on as before.
        let turns = increments.is_at_corner();
        if is_remedy || turns {
            past.clear();
        }
        if !is_remedy {
            frame.progress.remember(end, &x.array()?);
        }
        self.commit(frame, &converged)?;
        if turns {
            self.model.history.rest();
        }
        // Not those that a drag has balanced on the way.
        self.state.seen = converged.seen;
        self.state.strays = converged.strays;
        frame.plain = None;
        self.state.time = time;
        self.state.increments += 1;
        self.note_pace(&ways, share, [is_first, is_jump]);
        self.note_touches((&converged.between, &converged.aside), [is_jump, ends_step]);
        self.summary.counts.increments += 1;
        self.note_rounded(converged.effort.rounded.as_ref());
        let nodes = self.count(&converged.effort.calmed);
        Ok(Increment {
            step: frame.name().to_string(),
            number: self.state.increments,
            time,
            size,
            iterations,
            rounds: converged.effort.rounds,
            residuals: converged.effort.residuals,
            changes: converged.effort.changes,
            residual: converged.effort.residual,
            limit: converged.effort.limit,
            rounded: converged.effort.rounded,
            way,
            failures: std::mem::take(&mut frame.failures),
            nodes,
            ends_step,
        })
    }

    /// Whether this increment, which has converged, saw so much change of contact that the next should not be longer: many
    /// of the contact nodes changed sides, or a node slid so far on a curved surface that its path is no longer
    /// short against the radius of curvature. What bears no more than is let through of each contact touches or not as rounding has
    /// it, and does not count. Collective.
    fn is_busy(&self, limits: &[f64]) -> bool {
        let Controls { busy_share, busy_turn, .. } = self.model.controls;
        let mut counts = [0.0; 3];
        let slaves =
            self.model.pairs.iter().zip(limits).flat_map(|(p, limit)| p.slaves.iter().map(move |s| (s, *limit)));
        for (slave, limit) in slaves {
            let (before, now) = (slave.committed.status != Status::Gap, slave.trial.status != Status::Gap);
            let bears = slave.accepted.force.norm().max(slave.trial.force.norm()) > limit;
            counts[0] += f64::from((before || now) && bears);
            counts[1] += f64::from(before != now && bears);
            let curvature = slave.trial.projection.map_or(0.0, |p| p.normal_gradient.norm());
            counts[2] += f64::from(now && slave.trial.slip.norm() * curvature > busy_turn);
        }
        sum(self.comm, &mut counts);
        counts[1] > busy_share * counts[0] || counts[2] > 0.0
    }

    /// Slave nodes of all ranks that touch, slip, and were `calmed`. Collective.
    fn count(&self, calmed: &[u32]) -> ContactNodes {
        let mut counts = [0.0, 0.0, calmed.len() as f64];
        for slave in self.model.pairs.iter().flat_map(|p| &p.slaves) {
            counts[0] += f64::from(slave.trial.status != Status::Gap);
            counts[1] += f64::from(slave.rubs());
        }
        sum(self.comm, &mut counts);
        let [touching, slipping, all_calmed] = counts.map(|count| count as usize);
        let calmed_node = first_word(self.comm, calmed.first().map(|&n| node_name(&self.model, n)));
        ContactNodes { touching, slipping, calmed: all_calmed, calmed_node }
    }
}
