//! What the equations have of the nodes of masters, wherever these are owned.

use super::dofs::DofMap;
use crate::Mat3;
use crate::contact::{Master, Masters, Movement};
use mpi::topology::SimpleCommunicator;

/// The nodes of the master of a pair that this rank sees; a tool has two, its translation and its rotation.
#[derive(Clone, Debug, Default)]
pub struct MasterNodes {
    /// Equations of each along its directions; [`NONE`](super::dofs::NONE) where there is none.
    pub equations: Vec<[i64; 3]>,
    /// How the step moves each.
    pub moves: Vec<Movement>,
    is_tool: bool,
}

impl MasterNodes {
    /// Fetches what their owners have; `moves` are those of the tools and of owned nodes. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        masters: &Masters,
        master: Master,
        dofs: &DofMap,
        (of_tools, of_node): (&[Movement], impl Fn(u32) -> Movement),
    ) -> Self {
        let equations = equations(comm, masters, master, dofs);
        if let Some(tool) = master.tool() {
            return Self { equations, moves: vec![of_tools[tool]; 2], is_tool: true };
        }
        let ways = masters.gather(comm, master, &[], |n, d| of_node(n).ways[d]);
        let mut moves: Vec<Movement> = ways.into_iter().map(Movement::along_axes).collect();
        if dofs.is_inclined {
            let rows = [0, 1, 2].map(|i| masters.gather(comm, master, &[], |n, d| of_node(n).axes[(i, d)]));
            for (n, movement) in moves.iter_mut().enumerate() {
                movement.axes = Mat3::from_fn(|i, d| rows[i][n][d]);
            }
        }
        Self { equations, moves, is_tool: false }
    }

    /// The directions that the equations of one are along: those in which the step moves it, but of tools x, y and z.
    pub fn axes(&self, n: u32) -> Mat3 {
        if self.is_tool { Mat3::identity() } else { self.moves[n as usize].axes }
    }
}

/// Equations of the nodes of a master that this rank sees. Collective.
pub fn equations(comm: &SimpleCommunicator, masters: &Masters, master: Master, dofs: &DofMap) -> Vec<[i64; 3]> {
    masters.gather(comm, master, &dofs.tool, |n, d| dofs.node[n as usize][d])
}
