//! Entries that the contact elements of this rank have in rows of other ranks: nodes of a deformable master.
//!
//! Who sends which entries to whom is agreed with the pattern; then their values travel in the same order.

use crate::parallel::{Parcels, Route, exchange};
use crate::partition::owner;
use mpi::topology::SimpleCommunicator;

/// The entries, and the way of their values.
#[derive(Clone, Debug, Default)]
pub struct Foreign {
    /// (row, column), ascending: those of one owner stand together.
    entries: Vec<[i32; 2]>,
    /// To the owners of the rows.
    route: Route,
    /// The places in this rank's values of what comes, one rank after the other.
    places: Vec<u32>,
}

impl Foreign {
    /// Sends `entries` (row, column) to the owners of the rows, as `starts` has them, and returns what came here too.
    /// Call [`Self::receive_at`] when it has its place. Collective.
    pub fn new(comm: &SimpleCommunicator, mut entries: Vec<[i32; 2]>, starts: &[i64]) -> (Self, Vec<[i32; 2]>) {
        entries.sort_unstable();
        entries.dedup();
        let mut rows: Parcels<i32> = Parcels::new();
        for [row, _] in &entries {
            rows.entry(owner(starts, &i64::from(*row))).or_default().push(*row);
        }
        let received = exchange(comm, &rows);
        let route = Route::new(&rows, &received);
        let columns = route.send(comm, 1, &entries.iter().map(|[_, column]| *column).collect::<Vec<_>>());
        let received = received.into_values().flatten().zip(columns).map(|(row, column)| [row, column]).collect();
        (Self { entries, route, places: Vec::new() }, received)
    }

    /// Where the received entries stand in this rank's values.
    pub fn receive_at(&mut self, places: Vec<u32>) {
        self.places = places;
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Index of an entry among them.
    pub fn index(&self, row: i32, column: i32) -> Option<usize> {
        self.entries.binary_search(&[row, column]).ok()
    }

    /// Adds the values of the entries where they belong. Collective.
    pub fn deliver(&self, comm: &SimpleCommunicator, sent: &[f64], values: &mut [f64]) {
        for (&place, value) in self.places.iter().zip(self.route.send(comm, 1, sent)) {
            values[place as usize] += value;
        }
    }
}
