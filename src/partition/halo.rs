//! The halo: values of nodes that other ranks own.

use crate::parallel::{Parcels, Route, exchange};
use mpi::datatype::Equivalence;
use mpi::topology::SimpleCommunicator;

/// Who sends which owned nodes to whom, and where they land.
#[derive(Clone, Debug, Default)]
pub struct Halo {
    /// The owned local nodes that each rank sees, one rank after the other.
    send: Vec<u32>,
    /// The local halo nodes that each rank owns.
    receive: Vec<u32>,
    route: Route,
}

impl Halo {
    /// Sets up the exchange for a part whose halo nodes `wanted[r]`, as (local node, index among the owned nodes of rank
    /// r), belong to rank r. Collective.
    pub fn new(comm: &SimpleCommunicator, wanted: &Parcels<(u32, u32)>) -> Self {
        let ask: Parcels<u32> =
            wanted.iter().map(|(&r, w)| (r, w.iter().map(|&(_, theirs)| theirs).collect())).collect();
        let receive = wanted.values().flatten().map(|&(mine, _)| mine).collect();
        let send = exchange(comm, &ask);
        Self { route: Route::new(&send, &ask), send: send.into_values().flatten().collect(), receive }
    }

    /// Overwrites the halo entries of a node field, `width` values a node, with those of the owners. Collective.
    pub fn update<T>(&self, comm: &SimpleCommunicator, width: usize, field: &mut [T])
    where
        T: Equivalence + Copy + Default,
    {
        let of_node = |n: u32| n as usize * width..(n as usize + 1) * width;
        let sent: Vec<T> = self.send.iter().flat_map(|&n| &field[of_node(n)]).copied().collect();
        let received = self.route.send(comm, width, &sent);
        for (&node, values) in self.receive.iter().zip(received.chunks_exact(width)) {
            field[of_node(node)].copy_from_slice(values);
        }
    }

    /// Hands the halo entries of a node field, `width` a node, to the owners: `add` gets an owned node and its values, once from
    /// each rank that sees it. Collective.
    pub fn add_to_owners(
        &self,
        comm: &SimpleCommunicator,
        width: usize,
        field: &[f64],
        mut add: impl FnMut(u32, &[f64]),
    ) {
        let of_node = |n: u32| &field[n as usize * width..(n as usize + 1) * width];
        let sent: Vec<f64> = self.receive.iter().flat_map(|&n| of_node(n)).copied().collect();
        let received = self.route.send_back(comm, width, &sent);
        self.send.iter().zip(received.chunks_exact(width)).for_each(|(&node, values)| add(node, values));
    }
}
