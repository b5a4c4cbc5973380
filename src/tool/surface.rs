//! The surface of a tool on this rank: its share of the whole, and what is near this rank's points.
//!
//! The pieces of a surface are dealt out over the ranks. For its points a rank publishes one box; every rank sends the
//! pieces of its share that meet the box. What is near is complete for points inside the box without its margin, so it is
//! fetched again only when a point leaves that.

use super::geometry::{Geometry, describe};
use super::shape::Shape;
use crate::Vec3;
use crate::error::Result;
use crate::parallel::{agree, any, exchange, first_word, max};
use crate::scene::{self, Description, Smoothing};
use crate::surface::{FaceSet, Patch, PatchSet, Projection, SewnFace, Tessellation};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// The surface of a tool, in its own frame.
pub struct Surface {
    /// What this rank can project onto: the whole of an analytic shape, the near pieces of others.
    near: Shape,
    share: Share,
    /// Box, and the reach, for which `near` is complete.
    complete: Option<(Vec3, Vec3, f64)>,
    /// It is made of flat facets.
    pub faceted: bool,
    /// What it is made of, in words.
    pub summary: String,
    /// What the user should know of it.
    pub warnings: Vec<String>,
}

/// This rank's share of the pieces, by ascending id.
enum Share {
    Patches(Vec<Patch>),
    Faces(Vec<SewnFace>),
    /// Analytic shapes are not dealt out.
    Nothing,
}

/// An axis-aligned box.
pub type Bounds = (Vec3, Vec3);

impl Surface {
    /// Reads a description of a tool on rank 0 and deals out its pieces. Collective.
    ///
    /// # Errors
    /// Those of [`describe`], on all ranks.
    pub fn new(comm: &SimpleCommunicator, tool: &scene::Tool, description: Description) -> Result<Self> {
        let root = comm.rank() == 0;
        let here = root || !description.has_file();
        let described = agree(comm, if here { describe(tool, description).map(Some) } else { Ok(None) })?;
        let words = described.as_ref().map(|d| [vec![d.summary.clone()], d.warnings.clone()].concat().join("\n"));
        let words = first_word(comm, words.filter(|_| root)).unwrap_or_default();
        let mut lines = words.lines().map(str::to_string);
        let summary = lines.next().unwrap_or_default();
        let (near, share) = match described.map(|described| described.geometry) {
            Some(Geometry::Analytic(shape)) => (Shape::Analytic(shape), Share::Nothing),
            Some(Geometry::Patches(all)) => Self::of_patches(deal(comm, &all)),
            Some(Geometry::Faces(all)) => Self::of_faces(deal(comm, &all)),
            None if description.is_cad() => Self::of_faces(deal(comm, &[])),
            None => Self::of_patches(deal(comm, &[])),
        };
        Ok(Self {
            near,
            share,
            complete: None,
            faceted: description == Description::Mesh(Smoothing::Facet),
            summary,
            warnings: lines.collect(),
        })
    }

    fn of_patches(share: Vec<Patch>) -> (Shape, Share) {
        (Shape::Patches(PatchSet::new(Vec::new())), Share::Patches(share))
    }

    fn of_faces(share: Vec<SewnFace>) -> (Shape, Share) {
        (Shape::Faces(FaceSet::new(&[])), Share::Faces(share))
    }

    /// Makes sure that every piece within `reach` of the given points, all that this rank will project, is near. Fetches
    /// with a margin when some rank lacks one. Collective.
    pub fn watch(&mut self, comm: &SimpleCommunicator, points: impl Iterator<Item = Vec3>, reach: f64) {
        let bounds = bounds(points);
        let lacking = match (self.complete, bounds) {
            (_, None) => false,
            (None, Some(_)) => true,
            (Some((lo, hi, enough)), Some(b)) => !(inside(&(lo, hi), &b) && reach <= enough),
        };
        if matches!(self.share, Share::Nothing) || !any(comm, lacking) {
            return;
        }
        let margin = reach;
        let query = bounds.map(|(lo, hi)| (lo.add_scalar(-margin), hi.add_scalar(margin)));
        self.complete = query.map(|(lo, hi)| (lo, hi, reach));
        let query = query.map(|(lo, hi)| (lo.add_scalar(-reach), hi.add_scalar(reach)));
        match &self.share {
            Share::Patches(share) => self.near = Shape::Patches(PatchSet::new(collect(comm, share, query))),
            Share::Faces(share) => self.near = Shape::Faces(FaceSet::new(&collect(comm, share, query))),
            Share::Nothing => {}
        }
    }

    /// Whether all pieces near a point were fetched by the last [`Self::watch`].
    pub fn covers(&self, point: &Vec3) -> bool {
        matches!(self.share, Share::Nothing)
            || self.complete.is_some_and(|(lo, hi, _)| inside(&(lo, hi), &(*point, *point)))
    }

    /// Closest point to a point that is watched, within its reach; `warm` is the piece and parameters of the last projection.
    pub fn project(&self, point: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        self.near.closest(point, reach, warm)
    }

    /// Closest points to all points that the ranks hold, each rank its own, within `reach`. Collective.
    pub fn project_all(&mut self, comm: &SimpleCommunicator, points: &[Vec3], reach: f64) -> Vec<Option<Projection>> {
        self.watch(comm, points.iter().copied(), reach);
        points.iter().map(|point| self.project(point, reach, None)).collect()
    }

    /// The nearest points to all points that the ranks hold, each rank its own, ends of the surface included, however far.
    /// Collective.
    pub fn nearest_all(&mut self, comm: &SimpleCommunicator, points: &[Vec3]) -> Vec<Option<Projection>> {
        let finite = || points.iter().filter(|x| x.iter().all(|x| x.is_finite()));
        let mut reach = self.first_reach(comm, finite());
        loop {
            self.watch(comm, finite().copied(), reach);
            let found: Vec<_> = points.iter().map(|point| self.near.nearest(point, reach)).collect();
            let missing = found.iter().filter(|found| found.is_some()).count() < finite().count();
            if reach.is_infinite() || !any(comm, missing) {
                return found;
            }
            reach *= 4.0;
        }
    }

    /// As far as any point of all ranks is from the box of the surface, and a part of the box more; infinite for what is
    /// not dealt out. Collective.
    fn first_reach<'a>(&self, comm: &SimpleCommunicator, points: impl Iterator<Item = &'a Vec3>) -> f64 {
        let boxes: Vec<Bounds> = match &self.share {
            Share::Patches(share) => share.iter().map(Parcel::bounds).collect(),
            Share::Faces(share) => share.iter().map(Parcel::bounds).collect(),
            Share::Nothing => return f64::INFINITY,
        };
        let mut whole = [f64::NEG_INFINITY; 6];
        for (lo, hi) in boxes {
            for d in 0..3 {
                (whole[d], whole[3 + d]) = (whole[d].max(-lo[d]), whole[3 + d].max(hi[d]));
            }
        }
        max(comm, &mut whole);
        let (lo, hi) = (-Vec3::from_column_slice(&whole[..3]), Vec3::from_column_slice(&whole[3..]));
        let away = |x: &Vec3| (lo - x).sup(&(x - hi)).sup(&Vec3::zeros()).norm();
        let mut farthest = [points.map(away).fold(0.0, f64::max)];
        max(comm, &mut farthest);
        farthest[0] + (hi - lo).norm() / 16.0
    }

    /// This rank's share of what the solver sees, for display: `n` by `n` cells a curved patch; analytic shapes are shown by
    /// rank 0, circles in 16 `n` pieces, and what has no end cut to about a box.
    pub fn tessellate(&self, rank: i32, n: usize, (lo, hi): &Bounds) -> Tessellation {
        match (&self.share, &self.near) {
            (Share::Patches(share), _) => Tessellation::of_patches(share, n),
            (Share::Faces(share), _) => Tessellation::of_faces(FaceSet::new(share).pieces(), n),
            (Share::Nothing, Shape::Analytic(shape)) if rank == 0 => shape.tessellate(16 * n, lo, hi),
            (Share::Nothing, _) => Tessellation::default(),
        }
    }
}

/// A part of a surface that goes from rank to rank as numbers.
trait Parcel: Sized {
    /// The same on all ranks.
    fn number(&self) -> u32;

    /// A box that holds the piece.
    fn bounds(&self) -> Bounds;

    /// Adds the piece to a parcel.
    fn pack(&self, parcel: &mut Vec<f64>);

    /// All pieces of a parcel.
    fn unpack(parcel: &[f64]) -> Vec<Self>;
}

impl Parcel for Patch {
    fn number(&self) -> u32 {
        self.id
    }

    fn bounds(&self) -> Bounds {
        self.bounds()
    }

    fn pack(&self, parcel: &mut Vec<f64>) {
        parcel.extend(self.to_array());
    }

    fn unpack(parcel: &[f64]) -> Vec<Self> {
        parcel.as_chunks::<{ Patch::LEN }>().0.iter().map(Patch::from_array).collect()
    }
}

impl Parcel for SewnFace {
    fn number(&self) -> u32 {
        self.id
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn pack(&self, parcel: &mut Vec<f64>) {
        parcel.extend(self.to_numbers());
    }

    fn unpack(parcel: &[f64]) -> Vec<Self> {
        Self::from_numbers(parcel)
    }
}

/// This rank's share of the pieces that rank 0 has. Collective.
fn deal<P: Parcel>(comm: &SimpleCommunicator, all: &[P]) -> Vec<P> {
    let size = comm.size() as usize;
    let parcel = |r: usize| pack(all[all.len() * r / size..all.len() * (r + 1) / size].iter());
    unpack(&exchange(comm, &(0..size).map(parcel).collect::<Vec<_>>())[0])
}

/// The pieces of all shares that meet this rank's box. Collective.
fn collect<P: Parcel>(comm: &SimpleCommunicator, share: &[P], query: Option<Bounds>) -> Vec<P> {
    let asked: Vec<f64> = query.map_or(Vec::new(), |(lo, hi)| lo.iter().chain(hi.iter()).copied().collect());
    let answer = |asked: &Vec<f64>| {
        let meets = |piece: &&P| {
            let (lo, hi) = piece.bounds();
            (0..3).all(|d| lo[d] <= asked[3 + d] && hi[d] >= asked[d])
        };
        if asked.is_empty() { Vec::new() } else { pack(share.iter().filter(meets)) }
    };
    let asked = exchange(comm, &vec![asked; comm.size() as usize]);
    unpack(&exchange(comm, &asked.iter().map(answer).collect::<Vec<_>>()).concat())
}

fn pack<'a, P: Parcel + 'a>(pieces: impl Iterator<Item = &'a P>) -> Vec<f64> {
    pieces.fold(Vec::new(), |mut parcel, piece| {
        piece.pack(&mut parcel);
        parcel
    })
}

fn unpack<P: Parcel>(parcel: &[f64]) -> Vec<P> {
    let mut pieces = P::unpack(parcel);
    pieces.sort_by_key(P::number);
    pieces
}

fn bounds(points: impl Iterator<Item = Vec3>) -> Option<Bounds> {
    points.fold(None, |b: Option<Bounds>, x| Some(b.map_or((x, x), |(lo, hi)| (lo.inf(&x), hi.sup(&x)))))
}

fn inside(outer: &Bounds, inner: &Bounds) -> bool {
    (0..3).all(|d| outer.0[d] <= inner.0[d] && inner.1[d] <= outer.1[d])
}
