//! Values of nodes wherever they are owned: for surfaces that a rank sees beyond its part and its halo.
//!
//! Nodes are numbered over all ranks, those of each rank in a row, so that the owner of a number is found by where the
//! ranks begin. Who needs what of whom is agreed once; then values travel from the owners and sums back to them.

use crate::parallel::{Parcels, Route, exchange};
use mpi::datatype::Equivalence;
use mpi::topology::SimpleCommunicator;

/// The rank that owns `number`, when rank r owns `starts[r]..starts[r + 1]`.
pub fn owner<T: PartialOrd>(starts: &[T], number: &T) -> usize {
    starts.partition_point(|start| start <= number) - 1
}

/// A list of nodes of any ranks, and the way of their values.
#[derive(Clone, Debug, Default)]
pub struct Gather {
    /// Global numbers of the nodes, ascending: those of one owner stand together.
    numbers: Vec<u64>,
    /// The owned local nodes that each rank asks for, one rank after the other.
    asked: Vec<u32>,
    /// From the owners.
    route: Route,
}

impl Gather {
    /// Asks the owners for the nodes with these global numbers, in any order; `starts` as in [`owner`]. Collective.
    pub fn new(comm: &SimpleCommunicator, starts: &[u64], numbers: impl IntoIterator<Item = u64>) -> Self {
        let mut numbers: Vec<u64> = numbers.into_iter().collect();
        numbers.sort_unstable();
        numbers.dedup();
        let mut ask: Parcels<u32> = Parcels::new();
        for number in &numbers {
            let rank = owner(starts, number);
            ask.entry(rank).or_default().push((number - starts[rank]) as u32);
        }
        let asked = exchange(comm, &ask);
        Self { route: Route::new(&asked, &ask), asked: asked.into_values().flatten().collect(), numbers }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Where in the list a node stands.
    pub fn index(&self, number: u64) -> Option<u32> {
        self.numbers.binary_search(&number).ok().map(|k| k as u32)
    }

    /// Global number of a node of the list.
    pub fn number(&self, index: u32) -> u64 {
        self.numbers[index as usize]
    }

    /// The owned local nodes that some rank asks for; some more than once.
    pub fn asked(&self) -> impl Iterator<Item = u32> + '_ {
        self.asked.iter().copied()
    }

    /// The values of the listed nodes, `width` a node, from those that the owners hold for their local nodes. Collective.
    pub fn fetch<T>(&self, comm: &SimpleCommunicator, width: usize, value: impl Fn(u32, usize) -> T) -> Vec<T>
    where
        T: Equivalence + Copy + Default,
    {
        let sent: Vec<T> =
            self.asked.iter().flat_map(|&n| (0..width).map(move |d| (n, d))).map(|(n, d)| value(n, d)).collect();
        self.route.send(comm, width, &sent)
    }

    /// Hands values for the listed nodes, `width` a node, to their owners: `add` gets a local node and its values, once
    /// from each rank that lists it. Collective.
    pub fn add_to_owners(
        &self,
        comm: &SimpleCommunicator,
        width: usize,
        values: &[f64],
        mut add: impl FnMut(u32, &[f64]),
    ) {
        let received = self.route.send_back(comm, width, values);
        self.asked.iter().zip(received.chunks_exact(width)).for_each(|(&node, values)| add(node, values));
    }
}

#[cfg(test)]
mod tests {
    use super::owner;

    #[test]
    fn a_rank_without_nodes_owns_none() {
        let starts = [0u64, 3, 3, 5];
        assert_eq!([0, 2, 3, 4].map(|n| owner(&starts, &n)), [0, 0, 2, 2]);
    }
}
