//! What holds bodies and force-driven tools while a step runs: supports, contacts, friction.

use super::Simulation;
use super::preflight::rigid::{Free, RigidMotions, Side};
use super::preflight::support::supported;
use super::step::{Attempt, Converged, Frame};
use crate::Vec3;
use crate::contact::{Pair, Slave, Status, Trial};
use crate::controls::Controls;
use crate::failure::Cause;
use crate::parallel::any;

/// What a contact holds of a node that touches.
#[derive(Clone, Copy, PartialEq)]
enum Hold {
    /// What goes into the master.
    Normal,
    /// What goes across its slip, too, for its friction turns against that.
    Across,
    /// All.
    Firm,
}

/// What the friction of a slave node holds, of a pair by its index.
type Friction<'a> = &'a dyn Fn(usize, &Slave) -> Hold;

impl Simulation<'_> {
    /// Whether supports alone leave something free. Collective.
    pub(super) fn hangs(&self, frame: &Frame) -> bool {
        let place = |n: usize| self.model.part.points[n] + self.state.u[n];
        !supported(self.comm, &self.model, frame.conditions(), true, place).free(self.comm).is_empty()
    }

    /// Bodies that supports leave free to go any way. Collective.
    pub(super) fn unsupported(&self, frame: &Frame) -> Vec<usize> {
        let place = |n: usize| self.model.part.points[n] + self.state.u[n];
        let free = supported(self.comm, &self.model, frame.conditions(), true, place).free(self.comm);
        let bodies = free.iter().filter(|free| !free.is_tool && !free.is_piece && free.along.len() == 3);
        bodies.map(|free| free.index).collect()
    }

    /// Whether friction alone holds something now. Collective.
    pub(super) fn is_held_by_friction(&self, frame: &Frame) -> bool {
        let motions = self.held(frame, &self.state.u, |slave| &slave.accepted, None);
        !motions.free_along(self.comm, self.model.controls.friction_steep).is_empty()
    }

    /// What supports and contacts hold, with nodes displaced by `u` and contacts as `of` says. What is near and [`rests`](Self::rests)
    /// counts as touching: a body that bears nothing may as well be off by a rounding as in by one. Collective.
    fn held(
        &self,
        frame: &Frame,
        u: &[Vec3],
        of: impl Fn(&Slave) -> &Trial,
        friction: Option<Friction>,
    ) -> RigidMotions {
        let place = |n: usize| self.model.part.points[n] + u[n];
        let mut motions = supported(self.comm, &self.model, frame.conditions(), true, place);
        for (p, pair) in self.model.pairs.iter().enumerate() {
            let ground = self.model.masters.of(pair.master);
            for slave in &pair.slaves {
                let (trial, own) = (of(slave), self.model.part.component[slave.node as usize] as usize);
                let Some(at) = trial.projection else { continue };
                let Some(side) = Side::of(pair, ground.component(&at)) else { continue };
                let near = slave.law.gap(at.gap) <= pair.controls.touching_gap * pair.facet_size;
                if trial.status == Status::Gap && !(near && self.rests(frame, pair, slave, u)) {
                    continue;
                }
                let x = place(slave.node as usize);
                let hold = friction.map_or(Hold::Normal, |friction| friction(p, slave));
                motions.touch(own, side, &x, &at.normal, hold == Hold::Firm);
                let across = at.normal.cross(&trial.traction());
                if let (true, Some(across)) = (hold != Hold::Normal, across.try_normalize(f64::MIN_POSITIVE)) {
                    motions.touch(own, side, &x, &across, false);
                }
            }
        }
        motions
    }

    /// Whether a slave node has not moved since the last converged increment, with nodes displaced by `u`; where it was tried to keep
    /// in place what comes loose, whether it has moved by less than the shape of the body is known to.
    fn rests(&self, frame: &Frame, pair: &Pair, slave: &Slave, u: &[Vec3]) -> bool {
        let n = slave.node as usize;
        let Controls { no_gap, watch_deep, .. } = pair.controls;
        let little = if frame.progress.ladder.has_lingered() { watch_deep } else { no_gap };
        (u[n] - self.state.u[n]).norm() <= little * pair.facet_size
    }

    /// Whether nothing that a body still touches which has come loose has come towards it, with nodes displaced by `u`: that pushes it
    /// along, against nothing. Collective.
    fn stays(&self, free: &Free, u: &[Vec3]) -> bool {
        let tools = &self.model.masters.tools;
        let comes = |pair: &Pair, slave: &Slave| {
            let (Controls { no_gap, watch_deep, .. }, n) = (pair.controls, slave.node as usize);
            let Some(at) = slave.trial.projection else { return false };
            match pair.master.tool() {
                Some(t) => {
                    let (trial, committed) = (&tools[t].trial, &tools[t].committed);
                    (at.point - committed.outward(&trial.inward(&at.point))).dot(&at.normal) > no_gap * pair.facet_size
                }
                None => (u[n] - self.state.u[n]).dot(&at.normal).abs() > watch_deep * pair.facet_size,
            }
        };
        let own = |pair: &&Pair| [Some(pair.side.body), pair.master_body()].contains(&Some(free.index));
        // What bears nothing may be off by a rounding.
        let touches = |pair: &Pair, slave: &Slave| {
            let gap = slave.trial.projection.map(|at| slave.law.gap(at.gap).abs());
            slave.trial.status != Status::Gap || gap.is_some_and(|gap| gap <= pair.controls.no_gap * pair.facet_size)
        };
        let is_pushed = |pair: &Pair| pair.slaves.iter().any(|slave| touches(pair, slave) && comes(pair, slave));
        !free.is_tool && !any(self.comm, self.model.pairs.iter().filter(own).any(is_pushed))
    }

    /// Whether a slave node bears more than the gaps round to, and than the `limits` of what is let through of each contact.
    fn presses(&self, p: usize, slave: &Slave, trial: &Trial, limits: &[f64]) -> bool {
        let far = self.model.part.points[slave.node as usize].amax();
        let rounding = self.model.pairs[p].controls.rounding * f64::EPSILON * slave.law.normal * far;
        trial.force.norm() > rounding.max(limits[p])
    }

    /// Bodies that supports leave free and no contact presses on, in words. Collective.
    fn unpressed(&self, frame: &Frame, u: &[Vec3], of: impl Fn(&Slave) -> &Trial, limits: &[f64]) -> Vec<String> {
        let place = |n: usize| self.model.part.points[n] + u[n];
        let supported = supported(self.comm, &self.model, frame.conditions(), true, place);
        let mut motions = supported.clone();
        for (p, pair) in self.model.pairs.iter().enumerate() {
            let ground = self.model.masters.of(pair.master);
            for slave in pair.slaves.iter().filter(|slave| self.presses(p, slave, of(slave), limits)) {
                let own = self.model.part.component[slave.node as usize] as usize;
                let Some(at) = of(slave).projection else { continue };
                let Some(side) = Side::of(pair, ground.component(&at)) else { continue };
                motions.touch(own, side, &place(slave.node as usize), &at.normal, true);
            }
        }
        // As free as without contacts.
        let motions_of = |free: &Free| (free.along.len(), free.about.len());
        let before = supported.free(self.comm);
        let is_as_before = |free: &Free| before.iter().any(|b| b.who == free.who && motions_of(b) == motions_of(free));
        let bodies = motions.free(self.comm).into_iter().filter(|free| !free.is_tool && is_as_before(free));
        bodies.map(|free| free.who).collect()
    }

    /// A converged increment, unless something is free in it that contacts held: where that ends would be a matter of
    /// rounding. Collective.
    pub(super) fn still_held(&self, frame: &Frame, mut converged: Box<Converged>) -> Attempt {
        if !frame.hangs {
            return Attempt::Converged(converged);
        }
        let limits = &converged.limits;
        let mut unpressed = self.unpressed(frame, &converged.u, |slave| &slave.trial, limits);
        if !unpressed.is_empty() {
            let before = self.unpressed(frame, &self.state.u, |slave| &slave.accepted, limits);
            converged.unpressed = true;
            unpressed.retain(|who| !before.contains(who));
            converged.let_go = unpressed;
        }
        // A force that gaps round to says nothing of friction, which it would let hold or slip by chance. What rests has not been let
        // go.
        let bears = |p: usize, slave: &Slave| {
            self.rests(frame, &self.model.pairs[p], slave, &converged.u)
                || self.presses(p, slave, &slave.trial, &converged.limits)
        };
        let rubs = |p: usize| self.model.pairs[p].rules.friction > 0.0;
        let as_it_is = |p: usize, slave: &Slave| match slave.trial.status {
            _ if !rubs(p) || !bears(p, slave) => Hold::Normal,
            Status::Stick | Status::Gap => Hold::Firm,
            // What has slipped far may have been let go.
            _ if slave.law.creep > 0.0 && slave.trial.slip.norm() <= self.model.pairs[p].facet_size => Hold::Firm,
            _ => Hold::Across,
        };
        // As if all stuck that rubs, and that does not, which is not asked here.
        let stuck = |p: usize, slave: &Slave| if !rubs(p) || bears(p, slave) { Hold::Firm } else { Hold::Normal };
        let held = |friction| self.held(frame, &converged.u, |slave| &slave.trial, Some(friction));
        // A tool whose force ends is let go.
        let (conditions, end, tools) = (frame.conditions(), converged.end, self.model.masters.tools.len());
        let is_let_go = |t: usize| [t, tools + t].iter().all(|&k| conditions.tool_forces[k].at(end) == Vec3::zeros());
        let all = |free: Vec<Free>| -> Vec<Free> {
            free.into_iter().filter(|free| !(free.is_tool && is_let_go(free.index))).collect()
        };
        // What has lost all friction is not held along the slight slope of what it still touches.
        let steep = self.model.controls.friction_steep;
        let mut free = all(held(&as_it_is).free(self.comm));
        if free.is_empty() {
            free = all(held(&stuck).free_along(self.comm, steep));
        }
        let stays = frame.progress.ladder.lingers() && free.iter().all(|free| self.stays(free, &converged.u));
        match free.first() {
            None => Attempt::Converged(converged),
            Some(_) if stays => {
                converged.loose = free.into_iter().map(|free| free.who).collect();
                Attempt::Converged(converged)
            }
            Some(free) => {
                let mut slaves = self.model.pairs.iter().flat_map(|pair| &pair.slaves);
                let why = match any(self.comm, slaves.any(Slave::rubs)) {
                    true => "what touches slips, and no contact holds it",
                    false => "no contact holds it any more",
                };
                let reason = format!("{} can {}, for {why},", free.who, free.motion());
                Attempt::Failed(converged.refused(&self.model, Cause::Loose, reason))
            }
        }
    }
}
