//! What the equations have of the nodes of masters, wherever these are owned.

use super::dofs::DofMap;
use crate::contact::{Master, Masters};
use mpi::topology::SimpleCommunicator;

/// The nodes of the master of a pair that this rank sees; a tool has one.
#[derive(Clone, Debug, Default)]
pub struct MasterNodes {
    /// Equations of each along the axes; [`NONE`](super::dofs::NONE) where there is none.
    pub equations: Vec<[i64; 3]>,
    /// How far the step moves each along each direction: NaN where it is free, infinite where its points do not move alike.
    pub moves: Vec<[f64; 3]>,
}

impl MasterNodes {
    /// Fetches what their owners have; `moves` are those of the tools and of owned nodes. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        masters: &Masters,
        master: Master,
        dofs: &DofMap,
        (of_tools, of_node): (&[[f64; 3]], impl Fn(u32, usize) -> f64),
    ) -> Self {
        let equations = equations(comm, masters, master, dofs);
        Self { equations, moves: masters.gather(comm, master, of_tools, of_node) }
    }
}

/// Equations of the nodes of a master that this rank sees. Collective.
pub fn equations(comm: &SimpleCommunicator, masters: &Masters, master: Master, dofs: &DofMap) -> Vec<[i64; 3]> {
    masters.gather(comm, master, &dofs.tool, |n, d| dofs.node[n as usize][d])
}
