//! What holds bodies and force-driven tools while a step runs: supports, contacts, friction.

use super::Simulation;
use super::preflight::rigid::{Free, RigidMotions, Side};
use super::preflight::support::supported;
use super::step::{Attempt, Converged, Frame};
use crate::Vec3;
use crate::contact::{Pair, Slave, Status, Trial};
use crate::failure::Cause;
use crate::parallel::{any, max};
use crate::surface::Projection;

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

/// By how many facets of a pair a `body` of it may move as it takes the shape that it has without forces; what has `settled` has it.
fn shape(pair: &Pair, body: usize, settled: &[usize]) -> f64 {
    if settled.contains(&body) { pair.controls.touching_gap } else { pair.controls.watch_deep }
}

/// What the friction of a slave node holds, of a pair by its index.
type Friction<'a> = &'a dyn Fn(usize, &Slave) -> Hold;

impl Simulation<'_> {
    /// What supports hold, with nodes displaced by `u`.
    fn supported(&self, frame: &Frame, u: &[Vec3]) -> RigidMotions {
        supported(self.comm, &self.model, frame.conditions(), true, |n| self.model.part.points[n] + u[n])
    }

    /// Whether supports alone leave something free. Collective.
    pub(super) fn hangs(&self, frame: &Frame) -> bool {
        !self.supported(frame, &self.state.u).free(self.comm).is_empty()
    }

    /// Bodies that supports leave free to go any way. Collective.
    pub(super) fn unsupported(&self, frame: &Frame) -> Vec<usize> {
        let free = self.supported(frame, &self.state.u).free(self.comm);
        let bodies = free.iter().filter(|free| !free.is_tool && !free.is_piece && free.along.len() == 3);
        bodies.map(|free| free.index).collect()
    }

    /// Whether friction alone holds something now. Collective.
    pub(super) fn is_held_by_friction(&self, frame: &Frame) -> bool {
        let motions = self.held((frame, &[]), &self.state.u, |slave| &slave.accepted, None);
        !motions.free_along(self.comm, self.model.controls.friction_steep).is_empty()
    }

    /// Where a slave node meets its master, with nodes displaced by `u`: its component, the other side, its place, and the projection.
    fn meets(&self, pair: &Pair, slave: &Slave, trial: &Trial, u: &[Vec3]) -> Option<(usize, Side, Vec3, Projection)> {
        let (at, n) = (trial.projection?, slave.node as usize);
        let side = Side::of(pair, self.model.masters.of(pair.master).component(&at))?;
        Some((self.model.part.component[n] as usize, side, self.model.part.points[n] + u[n], at))
    }

    /// What supports and contacts hold, with nodes displaced by `u` and contacts as `of` says. What is near and [`rests`](Self::rests)
    /// counts as touching: a body that bears nothing may as well be off by a rounding as in by one. Collective.
    fn held(
        &self,
        (frame, settled): (&Frame, &[usize]),
        u: &[Vec3],
        of: impl Fn(&Slave) -> &Trial,
        friction: Option<Friction>,
    ) -> RigidMotions {
        let mut motions = self.supported(frame, u);
        for (p, pair) in self.model.pairs.iter().enumerate() {
            for slave in &pair.slaves {
                let trial = of(slave);
                let Some((own, side, x, at)) = self.meets(pair, slave, trial, u) else { continue };
                let near = slave.law.gap(at.gap) <= pair.controls.touching_gap * pair.facet_size;
                if trial.status == Status::Gap && !(near && self.rests((frame, settled), pair, slave, u)) {
                    continue;
                }
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
    /// in place what comes loose, whether it has moved by less than the shape of the body is known to, and nothing comes towards it.
    /// What has `settled` without a force has its shape, and moves by no more than it touches from.
    fn rests(&self, (frame, settled): (&Frame, &[usize]), pair: &Pair, slave: &Slave, u: &[Vec3]) -> bool {
        let n = slave.node as usize;
        let moves = |little: f64| (u[n] - self.state.u[n]).norm() > little * pair.facet_size;
        if !frame.progress.ladder.has_lingered() {
            return !moves(pair.controls.no_gap);
        }
        let little = shape(pair, pair.side.body, settled);
        !moves(little) && !self.comes(pair, slave, u, little)
    }

    /// Whether what a slave node is on has come towards it, a body by more than that many facets of the slave.
    fn comes(&self, pair: &Pair, slave: &Slave, u: &[Vec3], little: f64) -> bool {
        let (tools, n) = (&self.model.masters.tools, slave.node as usize);
        let Some(at) = slave.trial.projection else { return false };
        match pair.master.tool() {
            Some(t) => {
                let (trial, committed) = (&tools[t].trial, &tools[t].committed);
                let by = at.point - committed.outward(&trial.inward(&at.point));
                by.dot(&at.normal) > pair.controls.no_gap * pair.facet_size
            }
            None => (u[n] - self.state.u[n]).dot(&at.normal).abs() > little * pair.facet_size,
        }
    }

    /// Whether nothing that a body still touches which has come loose has come towards it, with nodes displaced by `u`: that pushes it
    /// along, against nothing. Collective.
    fn stays(&self, free: &Free, u: &[Vec3], settled: &[usize]) -> bool {
        // What bears nothing may be off by a rounding.
        let touches = |pair: &Pair, slave: &Slave| {
            let gap = slave.trial.projection.map(|at| slave.law.gap(at.gap).abs());
            slave.trial.status != Status::Gap || gap.is_some_and(|gap| gap <= pair.controls.no_gap * pair.facet_size)
        };
        let is_pushed = |pair: &Pair| {
            pair.slaves
                .iter()
                .any(|slave| touches(pair, slave) && self.comes(pair, slave, u, shape(pair, pair.side.body, settled)))
        };
        !free.is_tool && !any(self.comm, self.model.pairs.iter().filter(|pair| pair.is_of(free.index)).any(is_pushed))
    }

    /// Whether a slave node bears more than the gaps round to, and than the `limits` of what is let through of each contact.
    fn presses(&self, p: usize, slave: &Slave, trial: &Trial, limits: &[f64]) -> bool {
        let far = self.model.part.points[slave.node as usize].amax();
        let rounding = self.model.pairs[p].controls.rounding * f64::EPSILON * slave.law.normal * far;
        trial.force.norm() > rounding.max(limits[p])
    }

    /// Bodies that supports leave free and no contact presses on. Collective.
    fn unpressed(&self, frame: &Frame, u: &[Vec3], of: impl Fn(&Slave) -> &Trial, limits: &[f64]) -> Vec<Free> {
        let supported = self.supported(frame, u);
        let mut motions = supported.clone();
        for (p, pair) in self.model.pairs.iter().enumerate() {
            for slave in pair.slaves.iter().filter(|slave| self.presses(p, slave, of(slave), limits)) {
                if let Some((own, side, x, at)) = self.meets(pair, slave, of(slave), u) {
                    motions.touch(own, side, &x, &at.normal, true);
                }
            }
        }
        // As free as without contacts.
        let motions_of = |free: &Free| (free.along.len(), free.about.len());
        let before = supported.free(self.comm);
        let is_as_before = |free: &Free| before.iter().any(|b| b.who == free.who && motions_of(b) == motions_of(free));
        motions.free(self.comm).into_iter().filter(|free| !free.is_tool && is_as_before(free)).collect()
    }

    /// Bodies that no contact has pressed on in the state, where the `limits` are what residual is let through of each contact.
    /// Collective.
    pub(super) fn settled(&self, frame: &Frame, limits: &[f64]) -> Vec<usize> {
        if !frame.hangs {
            return Vec::new();
        }
        self.unpressed_before(frame, limits).iter().map(|free| free.index).collect()
    }

    /// What no contact has pressed on in the state. Collective.
    fn unpressed_before(&self, frame: &Frame, limits: &[f64]) -> Vec<Free> {
        self.unpressed(frame, &self.state.u, |slave| &slave.accepted, limits)
    }

    /// The first of bodies that no contact presses on which has gone from where it was by more than it takes its shape by, with how
    /// far. Collective.
    fn gone<'f>(
        &self,
        (from, settled): (&[Vec3], &[usize]),
        unpressed: impl Iterator<Item = &'f Free>,
        u: &[Vec3],
    ) -> Option<(&'f Free, f64)> {
        let model = &self.model;
        let farthest = |free: &Free| {
            let its = (0..model.part.components.len()).find(|&k| model.component_name(k) == free.who);
            let nodes = (0..model.part.owned).filter(|n| Some(model.part.component[*n] as usize) == its);
            let mut moved = [nodes.map(|n| (u[n] - from[n]).norm()).fold(0.0, f64::max)];
            max(self.comm, &mut moved);
            moved[0]
        };
        let may_move = |free: &Free| {
            let its = model.pairs.iter().filter(|pair| pair.is_of(free.index));
            its.map(|pair| shape(pair, free.index, settled) * pair.facet_size).fold(0.0, f64::max)
        };
        unpressed.map(|free| (free, farthest(free))).find(|(free, moved)| *moved > may_move(free))
    }

    /// A jump from the positions and the `settled` bodies before it that has ended, unless something that no contact presses on went
    /// along: how far is a matter of the drag. Collective.
    pub(super) fn unless_carried(&self, before: (&[Vec3], &[usize]), converged: Box<Converged>) -> Attempt {
        match self.gone(before, converged.unpressed.iter(), &converged.u) {
            None => Attempt::Converged(converged),
            Some((free, moved)) => {
                let reason =
                    format!("{} goes along by {moved:.3} in a jump, and no contact holds it where it ends,", free.who);
                Attempt::Failed(converged.refused(&self.model, Cause::Loose, reason))
            }
        }
    }

    /// A converged increment, unless something is free in it that contacts held: where that ends would be a matter of
    /// rounding. Collective.
    pub(super) fn still_held(&self, frame: &Frame, mut converged: Box<Converged>) -> Attempt {
        if !frame.hangs {
            return Attempt::Converged(converged);
        }
        let limits = &converged.limits;
        let unpressed = self.unpressed(frame, &converged.u, |slave| &slave.trial, limits);
        // Nothing else asks what has settled.
        let is_asked = !unpressed.is_empty() || frame.progress.ladder.has_lingered();
        let before = match is_asked {
            true => self.unpressed_before(frame, limits),
            false => Vec::new(),
        };
        let is_new = |free: &Free| before.iter().all(|before| before.who != free.who);
        converged.let_go = unpressed.iter().filter(|free| is_new(free)).map(|free| free.who.clone()).collect();
        let settled: Vec<usize> = before.iter().map(|free| free.index).collect();
        // What only touches does not pull.
        let still = unpressed.iter().filter(|free| !is_new(free) && self.stays(free, &converged.u, &settled));
        if let Some((free, moved)) = self.gone((&self.state.u, &settled), still, &converged.u) {
            let reason =
                format!("{} goes along by {moved:.3} with what it touches, and no contact holds it,", free.who);
            return Attempt::Failed(converged.refused(&self.model, Cause::Loose, reason));
        }
        converged.unpressed = unpressed;
        // A force that gaps round to says nothing of friction, which it would let hold or slip by chance. What rests has not been let
        // go.
        let bears = |p: usize, slave: &Slave| {
            self.rests((frame, &settled), &self.model.pairs[p], slave, &converged.u)
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
        let held = |friction| self.held((frame, &settled), &converged.u, |slave| &slave.trial, Some(friction));
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
        let stays = frame.progress.ladder.lingers() && free.iter().all(|free| self.stays(free, &converged.u, &settled));
        match free.first() {
            None => Attempt::Converged(converged),
            Some(_) if stays => {
                let any_way = |free: &Free| converged.unpressed.iter().any(|unpressed| unpressed.who == free.who);
                let motion = |free: &Free| Some(free.motion()).filter(|_| !any_way(free));
                converged.loose = free.into_iter().map(|free| (free.who.clone(), motion(&free))).collect();
                Attempt::Converged(converged)
            }
            Some(free) => {
                let mut slaves = self.model.pairs.iter().flat_map(|pair| &pair.slaves);
                let was_pressed =
                    || self.unpressed_before(frame, &converged.limits).iter().all(|before| before.who != free.who);
                let why = match any(self.comm, slaves.any(Slave::rubs)) {
                    true => "what touches slips, and no contact holds it",
                    false if was_pressed() => "no contact holds it any more",
                    false => "no contact holds it so",
                };
                let reason = format!("{} can {}, for {why},", free.who, free.motion());
                Attempt::Failed(converged.refused(&self.model, Cause::Loose, reason))
            }
        }
    }
}
