//! Messages between the ranks that have something to say to each other, and no others: what a rank sends and holds does
//! not grow with the number of ranks.
//!
//! [`exchange`] is for those who do not know who will write to them, by the consensus of Hoefler, Siebert and Lumsdaine
//! (2010, PPoPP, 159-168): a rank enters a barrier once all that it sent has been taken, and goes on taking messages until
//! the barrier tells that all ranks have. A [`Route`] is for ranks that exchange the same amounts again and again.

use mpi::datatype::Equivalence;
use mpi::point_to_point::MatchedReceiveVec;
use mpi::request::{Request, multiple_scope, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicI32, AtomicU64, Ordering};

/// What goes to, or has come from, each rank that is concerned.
pub type Parcels<T> = BTreeMap<usize, Vec<T>>;

const ROUTE: i32 = 100;
const SERVE: i32 = 103;
const EXCHANGE: i32 = 101;
/// Turns the tag of an exchange, so that the messages of the next are not taken for its own: a rank that has left one may
/// already write to one that has yet to hear of its end. None can be two ahead.
static TURN: AtomicI32 = AtomicI32::new(0);
static MESSAGES: AtomicU64 = AtomicU64::new(0);
static BYTES: AtomicU64 = AtomicU64::new(0);

/// What a rank has sent to others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sent {
    pub messages: u64,
    pub bytes: u64,
}

/// What this rank has sent so far, here.
pub fn sent() -> Sent {
    Sent { messages: MESSAGES.load(Ordering::Relaxed), bytes: BYTES.load(Ordering::Relaxed) }
}

fn tally<T>(parcel: &[T]) {
    MESSAGES.fetch_add(1, Ordering::Relaxed);
    BYTES.fetch_add(size_of_val(parcel) as u64, Ordering::Relaxed);
}

/// Sends the parcels to their ranks, and returns those that came here. Collective.
pub fn exchange<T: Equivalence + Clone>(comm: &SimpleCommunicator, parcels: &Parcels<T>) -> Parcels<T> {
    let tag = EXCHANGE + TURN.fetch_xor(1, Ordering::Relaxed);
    let here = comm.rank() as usize;
    let mut received: Parcels<T> = parcels.get(&here).map(|own| (here, own.clone())).into_iter().collect();
    scope(|scope| {
        let others = parcels.iter().filter(|(rank, _)| **rank != here);
        let mut sending: Vec<_> = others
            .map(|(&rank, parcel)| {
                tally(parcel);
                comm.process_at_rank(rank as i32).immediate_synchronous_send_with_tag(scope, &parcel[..], tag)
            })
            .collect();
        let mut barrier = None;
        loop {
            while let Some(message) = comm.any_process().immediate_matched_probe_with_tag(tag) {
                let (parcel, status) = message.matched_receive_vec();
                received.insert(status.source_rank() as usize, parcel);
            }
            barrier = match barrier {
                None => {
                    sending = sending.into_iter().filter_map(|request| request.test().err()).collect();
                    sending.is_empty().then(|| comm.immediate_barrier())
                }
                Some(request) => match Request::test(request) {
                    Ok(_) => break,
                    Err(request) => Some(request),
                },
            };
        }
    });
    received
}

/// The rows of all ranks, in the order of the ranks, on all ranks. Collective.
pub fn to_all<const N: usize>(comm: &SimpleCommunicator, rows: &[[f64; N]]) -> Vec<[f64; N]> {
    let parcels = (0..comm.size() as usize).map(|rank| (rank, rows.as_flattened().to_vec())).collect();
    exchange(comm, &parcels).values().flat_map(|flat| flat.as_chunks::<N>().0.to_vec()).collect()
}

/// What rank 0 has for this rank. Collective.
pub fn scatter<T: Equivalence + Clone>(comm: &SimpleCommunicator, parcels: &Parcels<T>) -> Vec<T> {
    exchange(comm, parcels).remove(&0).unwrap_or_default()
}

/// What rank 0 makes for each rank, one after the other: it holds one parcel at a time. Its own it makes last. Collective.
pub fn serve<T: Equivalence>(comm: &SimpleCommunicator, mut make: impl FnMut(usize) -> Vec<T>) -> Vec<T> {
    if comm.rank() != 0 {
        return comm.process_at_rank(0).matched_probe_with_tag(SERVE).matched_receive_vec().0;
    }
    for rank in 1..comm.size() {
        let parcel = make(rank as usize);
        tally(&parcel);
        comm.process_at_rank(rank).synchronous_send_with_tag(&parcel[..], SERVE);
    }
    make(0)
}

/// A way that values take again and again: both sides know who sends how much.
#[derive(Clone, Debug, Default)]
pub struct Route {
    /// Ranks, rising, with how much goes to each.
    to: Vec<(usize, usize)>,
    /// The same of what comes from each.
    from: Vec<(usize, usize)>,
}

impl Route {
    /// The way of all values `sent`, in this order, from one rank to the other.
    pub fn new<S, R>(sent: &Parcels<S>, received: &Parcels<R>) -> Self {
        Self { to: lengths(sent), from: lengths(received) }
    }

    /// Sends values, `width` for each that the route was made with, in the same order; returns those that come. Collective
    /// on the ranks concerned.
    pub fn send<T: Equivalence + Copy + Default>(&self, comm: &SimpleCommunicator, width: usize, sent: &[T]) -> Vec<T> {
        swap(comm, width, (&self.to, sent), &self.from)
    }

    /// Sends values the other way.
    pub fn send_back<T>(&self, comm: &SimpleCommunicator, width: usize, sent: &[T]) -> Vec<T>
    where
        T: Equivalence + Copy + Default,
    {
        swap(comm, width, (&self.from, sent), &self.to)
    }
}

fn lengths<T>(parcels: &Parcels<T>) -> Vec<(usize, usize)> {
    parcels.iter().map(|(&rank, parcel)| (rank, parcel.len())).collect()
}

/// Sends and receives what both sides know of.
fn swap<T: Equivalence + Copy + Default>(
    comm: &SimpleCommunicator,
    width: usize,
    (to, sent): (&[(usize, usize)], &[T]),
    from: &[(usize, usize)],
) -> Vec<T> {
    let here = comm.rank() as usize;
    let mut received = vec![T::default(); from.iter().map(|(_, count)| count * width).sum()];
    multiple_scope(to.len() + from.len(), |scope, requests| {
        let (mut kept, mut rest) = (None, &mut received[..]);
        for &(rank, count) in from {
            let (parcel, after) = std::mem::take(&mut rest).split_at_mut(count * width);
            rest = after;
            match rank == here {
                true => kept = Some(parcel),
                false => {
                    let source = comm.process_at_rank(rank as i32);
                    requests.add(source.immediate_receive_into_with_tag(scope, parcel, ROUTE));
                }
            }
        }
        let mut rest = sent;
        for &(rank, count) in to {
            let (parcel, after) = rest.split_at(count * width);
            rest = after;
            match rank == here {
                true => kept.iter_mut().for_each(|kept| kept.copy_from_slice(parcel)),
                false => {
                    tally(parcel);
                    let target = comm.process_at_rank(rank as i32);
                    requests.add(target.immediate_send_with_tag(scope, parcel, ROUTE));
                }
            }
        }
        requests.wait_all(&mut Vec::new());
    });
    received
}
