//! Drag: a force on every free displacement and tool against its motion since the last converged state.
//!
//! Where equilibrium ends, as for a node that slips off an edge, a structure jumps. With the drag c (u - u_n) added, the
//! increment is a step of an overdamped motion, and always has a solution near u_n.
//!
//! The springs of what *lingers* are the same, of a share of the stiffness of each body. From where what they hold is in balance
//! weaker ones begin, until all is in balance without them, too: they say where a body is that nothing holds.

use super::Newton;
use crate::Vec3;
use crate::controls::Controls;
use crate::model::Model;

/// The drag of an increment.
#[derive(Clone, Debug, Default)]
pub struct Drag {
    /// What it is.
    kind: Kind,
    /// Translations of the tools in the last converged state.
    offsets: Vec<Vec3>,
    /// Local unknowns of displacements and tools with their values in the last converged state, and force per length.
    rest: Vec<(usize, f64, f64)>,
    /// Of springs, the largest residual without those of the stage before, over the forces that it counts against.
    left: f64,
}

/// What drags.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kind {
    #[default]
    Nothing,
    /// Everything alike, by so much force per length.
    All(f64),
    /// Every body by such a share of its largest nodal stiffness, a tool as the softest body, in a stage, from 1.
    Each(f64, usize),
}

impl Newton<'_> {
    /// Whether anything drags.
    pub fn drags(&self) -> bool {
        self.strategy.drag.kind != Kind::Nothing
    }

    /// Whether springs keep in place what comes loose.
    pub(super) fn keeps_in_place(&self) -> bool {
        matches!(self.strategy.drag.kind, Kind::Each(..))
    }

    /// Drags from now on.
    pub fn set_drag(&mut self, kind: Kind) {
        self.strategy.drag = Drag { kind, offsets: self.found.offsets.clone(), rest: Vec::new(), left: f64::INFINITY };
        self.number_drag();
    }

    /// Whether what is in balance at `x` is so without the drag, too. If not, weaker springs begin there, so many times; then the
    /// same, while each time next to nothing is left of what was; then nothing drags any more. Collective.
    ///
    /// What springs leave has one sign at all nodes, and adds up: it is to be a small share of the tolerance, and no rounding excuses
    /// it, but in the last stage.
    pub fn stands_without_drag(&mut self, x: &[f64]) -> bool {
        let mut drag = std::mem::take(&mut self.strategy.drag);
        let sound = self.evaluate(x, &mut vec![0.0; x.len()], false);
        let Controls { linger_fall, linger_stages, .. } = self.system.model.controls;
        let (balance, tolerance) = (&self.found.balance, self.tolerance_now());
        let Kind::Each(share, stage) = drag.kind else { return sound && balance.holds(tolerance) };
        let (left, is_weakest) = (balance.relative(), stage >= linger_stages);
        let is_last = is_weakest && !(sound && left <= linger_fall * drag.left);
        let stands = sound && balance.holds(tolerance) && (is_last || left <= linger_fall * tolerance);
        if !stands && !is_last {
            let fall = if is_weakest { 1.0 } else { linger_fall };
            drag.kind = Kind::Each(share * fall, stage + 1);
            for (k, rest, force) in &mut drag.rest {
                (*rest, *force) = (x[*k], *force * fall);
            }
            self.strategy.drag = Drag { left, ..drag };
        }
        stands
    }

    /// The weakest springs of what lingers, for the tangent.
    pub fn keep_weakly_in_place(&mut self) {
        let Controls { linger, linger_fall, linger_stages, .. } = self.system.model.controls;
        self.set_drag(Kind::Each(linger * linger_fall.powi(linger_stages as i32 - 1), linger_stages));
    }

    /// Takes over the numbers of equations.
    pub(super) fn number_drag(&mut self) {
        let Model { part, sections, .. } = &*self.system.model;
        let softest =
            sections.iter().map(|section| section.stiffness).filter(|k| *k > 0.0).fold(f64::INFINITY, f64::min);
        let drags = |stiffness: f64| match self.strategy.drag.kind {
            Kind::Nothing => None,
            Kind::All(coefficient) => Some(coefficient),
            Kind::Each(share, _) => Some(share * stiffness),
        };
        let node = |n: usize| {
            let at = self.system.dofs.axes.inward(n, &self.system.committed[n]);
            (&self.system.dofs.node[n], at, sections[part.section[n] as usize].stiffness)
        };
        let nodes = (0..part.owned).map(node);
        let tools =
            self.system.dofs.tool.iter().zip(&self.strategy.drag.offsets).map(|(tool, at)| (tool, *at, softest));
        let all = nodes.chain(tools).flat_map(|(equations, at, k)| (0..3).map(move |d| (equations[d], at[d], k)));
        let mut rest: Vec<_> = all.filter_map(|(e, at, k)| Some((self.system.dofs.local(e)?, at, drags(k)?))).collect();
        // Nodes that move as one have one unknown.
        rest.sort_by_key(|(k, ..)| *k);
        rest.dedup_by_key(|(k, ..)| *k);
        self.strategy.drag.rest = rest;
    }

    pub(super) fn add_drag(&self, x: &[f64], r: &mut [f64]) {
        self.strategy.drag.rest.iter().for_each(|&(k, rest, drag)| r[k] += drag * (x[k] - rest));
    }

    pub(super) fn add_drag_tangent(&mut self) {
        let first = self.system.dofs.first;
        for &(k, _, drag) in &self.strategy.drag.rest {
            self.system.pattern.add(&mut self.values, k, first + k as i64, drag);
        }
    }
}
