//! The halo: values of nodes that other ranks own.

use crate::parallel::exchange;
use mpi::datatype::Equivalence;
use mpi::topology::SimpleCommunicator;

/// Who sends which owned nodes to whom, and where they land.
#[derive(Clone, Debug, Default)]
pub struct Halo {
    /// For each rank the owned local nodes that it sees.
    send: Vec<Vec<u32>>,
    /// For each rank the local halo nodes that it owns.
    receive: Vec<Vec<u32>>,
}

impl Halo {
    /// Sets up the exchange for a part whose halo nodes `wanted[r]`, as (local node, index among the owned nodes of rank
    /// r), belong to rank r. Collective.
    pub fn new(comm: &SimpleCommunicator, wanted: &[Vec<(u32, u32)>]) -> Self {
        let ask: Vec<Vec<u32>> = wanted.iter().map(|w| w.iter().map(|&(_, theirs)| theirs).collect()).collect();
        let receive = wanted.iter().map(|w| w.iter().map(|&(mine, _)| mine).collect()).collect();
        Self { send: exchange(comm, &ask), receive }
    }

    /// Overwrites the halo entries of a node field, `width` values a node, with those of the owners. Collective.
    pub fn update<T>(&self, comm: &SimpleCommunicator, width: usize, field: &mut [T])
    where
        T: Equivalence + Copy + Default,
    {
        if self.send.len() < 2 {
            return;
        }
        let parcels: Vec<Vec<T>> = self
            .send
            .iter()
            .map(|nodes| {
                nodes.iter().flat_map(|&n| &field[n as usize * width..(n as usize + 1) * width]).copied().collect()
            })
            .collect();
        for (nodes, values) in self.receive.iter().zip(exchange(comm, &parcels)) {
            for (&node, value) in nodes.iter().zip(values.chunks_exact(width)) {
                field[node as usize * width..(node as usize + 1) * width].copy_from_slice(value);
            }
        }
    }
}
