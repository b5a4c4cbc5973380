//! Drag: a force on every free displacement and tool against its motion since the last converged state.
//!
//! Where equilibrium ends, as for a node that slips off an edge, a structure jumps. With the drag c (u - u_n) added, the
//! increment is a step of an overdamped motion, and always has a solution near u_n.

use super::Newton;
use crate::Vec3;

/// The drag of an increment.
#[derive(Clone, Debug, Default)]
pub struct Drag {
    /// Force per length.
    coefficient: f64,
    /// Translations of the tools in the last converged state.
    offsets: Vec<Vec3>,
    /// Local unknowns of displacements and tools with their values in the last converged state.
    rest: Vec<(usize, f64)>,
}

impl Newton<'_> {
    /// Drags from now on; 0 for no drag.
    pub fn set_drag(&mut self, coefficient: f64) {
        self.strategy.drag = Drag { coefficient, offsets: self.found.offsets.clone(), rest: Vec::new() };
        self.number_drag();
    }

    /// Takes over the numbers of equations.
    pub(super) fn number_drag(&mut self) {
        let at = |n: usize| self.system.dofs.axes.inward(n, &self.system.committed[n]);
        let nodes = (0..self.system.model.part.owned).map(|n| (&self.system.dofs.node[n], at(n)));
        let tools = self.system.dofs.tool.iter().zip(self.strategy.drag.offsets.iter().copied());
        let all = nodes.chain(tools).flat_map(|(equations, at)| (0..3).map(move |d| (equations[d], at[d])));
        let mut rest: Vec<_> = all.filter_map(|(e, at)| Some((self.system.dofs.local(e)?, at))).collect();
        // Nodes that move as one have one unknown.
        rest.sort_by_key(|(k, _)| *k);
        rest.dedup_by_key(|(k, _)| *k);
        self.strategy.drag.rest = rest;
    }

    pub(super) fn add_drag(&self, x: &[f64], r: &mut [f64]) {
        let Drag { coefficient, rest, .. } = &self.strategy.drag;
        if *coefficient > 0.0 {
            rest.iter().for_each(|&(k, rest)| r[k] += coefficient * (x[k] - rest));
        }
    }

    pub(super) fn add_drag_tangent(&mut self) {
        let (Drag { coefficient, rest, .. }, first) = (&self.strategy.drag, self.system.dofs.first);
        if *coefficient > 0.0 {
            rest.iter()
                .for_each(|&(k, _)| self.system.pattern.add(&mut self.values, k, first + k as i64, *coefficient));
        }
    }
}
