//! Rows of a table in an order that does not depend on the partition.
//!
//! Whatever a rank holds has a key, its number in the whole mesh. The rows of all ranks, sorted by key, are cut into even
//! blocks, one a rank: rank after rank they make the same table on any number of ranks, and from such a table each rank
//! gets its rows back.

use crate::parallel::{Parcels, Route, exchange, scatter};
use mpi::datatype::Equivalence;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// The way of rows to their places in the table, and back.
#[derive(Clone, Debug, Default)]
pub struct Order {
    /// Where each row of this rank stands in the table.
    positions: Vec<u64>,
    /// This rank's rows by rising position.
    sorted: Vec<u32>,
    /// Where in the block of this rank each row goes that comes.
    places: Vec<u32>,
    route: Route,
    /// The first row of the block, its rows, and those of the table.
    pub first: u64,
    pub count: usize,
    pub total: u64,
}

impl Order {
    /// Of rows with these keys; ranks that have the same key hold the same row. Collective.
    pub fn new(comm: &SimpleCommunicator, keys: &[u64]) -> Self {
        let (positions, total) = positions(comm, keys);
        let (size, rank) = (comm.size() as u64, comm.rank() as u64);
        let starts: Vec<u64> = (0..=size).map(|r| r * total / size).collect();
        let mut sorted: Vec<u32> = (0..keys.len() as u32).collect();
        sorted.sort_by_key(|&k| positions[k as usize]);
        let mut sent: Parcels<u64> = Parcels::new();
        for &k in &sorted {
            let position = positions[k as usize];
            sent.entry(super::owner(&starts, &position)).or_default().push(position);
        }
        let received = exchange(comm, &sent);
        let (first, end) = (starts[rank as usize], starts[rank as usize + 1]);
        let route = Route::new(&sent, &received);
        let places = received.into_values().flatten().map(|position| (position - first) as u32).collect();
        Self { positions, sorted, places, route, first, count: (end - first) as usize, total }
    }

    /// Where each row of this rank stands in the table.
    pub fn positions(&self) -> &[u64] {
        &self.positions
    }

    /// This rank's block of the table, from the rows of all ranks, `width` values each. Collective.
    pub fn arrange<T>(&self, comm: &SimpleCommunicator, width: usize, rows: &[T]) -> Vec<T>
    where
        T: Equivalence + Copy + Default,
    {
        let received = self.route.send(comm, width, &pick(rows, &self.sorted, width));
        place(&received, &self.places, width, self.count)
    }

    /// The rows of this rank, from the blocks of all. Collective.
    pub fn hand_back<T>(&self, comm: &SimpleCommunicator, width: usize, block: &[T]) -> Vec<T>
    where
        T: Equivalence + Copy + Default,
    {
        let received = self.route.send_back(comm, width, &pick(block, &self.places, width));
        place(&received, &self.sorted, width, self.sorted.len())
    }
}

/// The rows with these indices.
fn pick<T: Copy>(rows: &[T], indices: &[u32], width: usize) -> Vec<T> {
    let row = |k: &u32| &rows[*k as usize * width..(*k as usize + 1) * width];
    indices.iter().flat_map(row).copied().collect()
}

/// So many rows, of which those with these indices are given.
fn place<T: Copy + Default>(given: &[T], indices: &[u32], width: usize, count: usize) -> Vec<T> {
    let mut rows = vec![T::default(); count * width];
    for (&k, row) in indices.iter().zip(given.chunks_exact(width.max(1))) {
        rows[k as usize * width..(k as usize + 1) * width].copy_from_slice(row);
    }
    rows
}

/// The place of each of this rank's keys among those of all, and how many there are; rank 0 sorts them. Collective.
fn positions(comm: &SimpleCommunicator, keys: &[u64]) -> (Vec<u64>, u64) {
    let all = exchange(comm, &[(0, keys.to_vec())].into());
    let mut sorted: Vec<u64> = all.values().flatten().copied().collect();
    sorted.sort_unstable();
    sorted.dedup();
    let of = |key: &u64| sorted.partition_point(|other| other < key) as u64;
    let found = all.iter().map(|(&rank, keys)| (rank, keys.iter().map(of).collect())).collect();
    let mut total = sorted.len() as u64;
    comm.process_at_rank(0).broadcast_into(&mut total);
    (scatter(comm, &found), total)
}
