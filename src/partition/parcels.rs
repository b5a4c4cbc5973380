//! Pieces of a surface dealt out over the ranks, each of which sees what is near its own points.

use super::directory::recipients;
use crate::Vec3;
use crate::parallel::{Parcels, exchange, max, scatter};
use mpi::topology::SimpleCommunicator;

/// An axis-aligned box: its lower and upper corner.
pub type Bounds = (Vec3, Vec3);

/// A piece of a surface that goes from rank to rank as numbers.
pub trait Parcel: Sized {
    /// The same on all ranks.
    fn number(&self) -> u32;

    /// Adds the piece to a parcel.
    fn pack(&self, parcel: &mut Vec<f64>);

    /// All pieces of a parcel.
    fn unpack(parcel: &[f64]) -> Vec<Self>;
}

/// This rank's share, by rising number, of the pieces that rank 0 has; `rank_of` says whose a piece is, by its index.
/// Collective.
pub fn deal<P: Parcel>(comm: &SimpleCommunicator, all: &[P], rank_of: impl Fn(usize, &P) -> usize) -> Vec<P> {
    let mut parcels: Parcels<f64> = Parcels::new();
    all.iter().enumerate().for_each(|(k, piece)| piece.pack(parcels.entry(rank_of(k, piece)).or_default()));
    unpack(&scatter(comm, &parcels))
}

/// The pieces of all shares that come within `reach` of any of this rank's points, and some more, by rising number;
/// `bounds` is a box that holds a piece. The reach is the same on all ranks. Collective.
pub fn collect<P: Parcel>(
    comm: &SimpleCommunicator,
    share: &[P],
    bounds: impl Fn(&P) -> Bounds,
    points: &[Vec3],
    reach: f64,
) -> Vec<P> {
    let boxes: Vec<Bounds> = share.iter().map(bounds).collect();
    let mut parcels: Parcels<f64> = Parcels::new();
    for (rank, pieces) in recipients(comm, &boxes, points, reach) {
        let parcel = parcels.entry(rank).or_default();
        pieces.iter().for_each(|&k| share[k as usize].pack(parcel));
    }
    let received: Vec<f64> = exchange(comm, &parcels).into_values().flatten().collect();
    unpack(&received)
}

/// Farthest that a point is from where it was; infinite where it was nowhere or there are not as many, none where it is
/// nowhere.
pub fn strayed(from: &[Vec3], to: &[Vec3]) -> f64 {
    let far = |(from, to): (&Vec3, &Vec3)| match (to - from).norm() {
        _ if !to.iter().all(|x| x.is_finite()) => 0.0,
        far if far.is_nan() => f64::INFINITY,
        far => far,
    };
    let enough = if from.len() == to.len() { 0.0 } else { f64::INFINITY };
    from.iter().zip(to).map(far).fold(enough, f64::max)
}

fn unpack<P: Parcel>(parcel: &[f64]) -> Vec<P> {
    let mut pieces = P::unpack(parcel);
    pieces.sort_by_key(P::number);
    pieces
}

/// The box of some points; `None` without points.
pub fn bounds(points: impl Iterator<Item = Vec3>) -> Option<Bounds> {
    points.fold(None, |b: Option<Bounds>, x| Some(b.map_or((x, x), |(lo, hi)| (lo.inf(&x), hi.sup(&x)))))
}

/// The box that holds those of all ranks; `None` when none has any. Collective.
pub fn hull(comm: &SimpleCommunicator, bounds: Option<Bounds>) -> Option<Bounds> {
    let mut ends = [f64::NEG_INFINITY; 6];
    if let Some((lo, hi)) = bounds {
        (0..3).for_each(|d| (ends[d], ends[3 + d]) = (-lo[d], hi[d]));
    }
    max(comm, &mut ends);
    let whole = (-Vec3::from_column_slice(&ends[..3]), Vec3::from_column_slice(&ends[3..]));
    (ends[0] > f64::NEG_INFINITY).then_some(whole)
}

/// The box with `by` more on all sides.
pub fn grown((lo, hi): Bounds, by: f64) -> Bounds {
    (lo.add_scalar(-by), hi.add_scalar(by))
}

/// Whether two boxes touch.
pub fn meets(one: &Bounds, other: &Bounds) -> bool {
    (0..3).all(|d| one.0[d] <= other.1[d] && other.0[d] <= one.1[d])
}
