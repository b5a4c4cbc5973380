//! The surface of a tool on this rank: its share of the whole, and what is near this rank's points.
//!
//! The pieces of a surface are dealt out over the ranks. A rank fetches those within reach of its points, and a margin
//! more: until a point has moved farther than that, what is near is complete.

use super::geometry::{Geometry, describe};
use super::shape::Shape;
use crate::Vec3;
use crate::controls::Controls;
use crate::error::Result;
use crate::parallel::{agree, any, first_word, word_of_largest};
use crate::partition::parcels::{self, bounds, collect, hull, strayed};
use crate::partition::{ALIKE, Bounds, Parcel};
use crate::scene::{self, Description, Smoothing};
use crate::surface::analytic::ROUNDED;
use crate::surface::{Edge, FaceSet, Parametric, Patch, PatchSet, Projection, SewnFace, Tessellation};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::BTreeMap;

/// The surface of a tool, in its own frame.
pub struct Surface {
    /// What this rank can project onto: the whole of an analytic shape, the near pieces of others.
    near: Shape,
    share: Share,
    /// What `near` is complete for.
    seen: Option<Seen>,
    /// It is made of flat facets.
    pub faceted: bool,
    /// What it is made of, in words.
    pub summary: String,
    /// What the user should know of it.
    pub warnings: Vec<String>,
    controls: Controls,
    /// The way by which a surface without end was moved along itself, if that rounds.
    settled: f64,
}

/// Every piece within the distance `complete` of the points is near.
struct Seen {
    points: Vec<Vec3>,
    complete: f64,
}

/// This rank's share of the pieces, by ascending id.
enum Share {
    Patches(Vec<Patch>),
    Faces(Vec<SewnFace>),
    /// Analytic shapes are not dealt out.
    Nothing,
}

impl Surface {
    /// Reads a description of a tool on rank 0 and deals out its pieces. Collective.
    ///
    /// # Errors
    /// Those of [`describe`], on all ranks.
    pub fn new(
        comm: &SimpleCommunicator,
        tool: &scene::Tool,
        description: Description,
        controls: &Controls,
    ) -> Result<Self> {
        let root = comm.rank() == 0;
        let here = root || !description.has_file();
        let described = agree(comm, if here { describe(tool, description, controls).map(Some) } else { Ok(None) })?;
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
            seen: None,
            faceted: description == Description::Mesh(Smoothing::Facet),
            summary,
            controls: *controls,
            warnings: lines.collect(),
            settled: 0.0,
        })
    }

    fn of_patches(share: Vec<Patch>) -> (Shape, Share) {
        (Shape::Patches(PatchSet::default()), Share::Patches(share))
    }

    fn of_faces(share: Vec<SewnFace>) -> (Shape, Share) {
        (Shape::Faces(FaceSet::new(&[])), Share::Faces(share))
    }

    /// Makes sure that every piece within `reach` of the given points, all that this rank will project, is near. Fetches
    /// with a margin when some rank lacks one, and says whether. The reach is the same on all ranks. Collective.
    pub fn watch(&mut self, comm: &SimpleCommunicator, points: &[Vec3], reach: f64) -> bool {
        let lacking = !points.is_empty()
            && self.seen.as_ref().is_none_or(|seen| reach + strayed(&seen.points, points) > seen.complete);
        if matches!(self.share, Share::Nothing) || !any(comm, lacking) {
            return false;
        }
        let far = 2.0 * reach;
        match &self.share {
            Share::Patches(share) => {
                self.near = Shape::Patches(PatchSet::new(collect(comm, share, Parametric::bounds, points, far)));
            }
            Share::Faces(share) => {
                self.near = Shape::Faces(FaceSet::new(&collect(comm, share, |f| f.bounds, points, far)));
            }
            Share::Nothing => {}
        }
        self.seen = Some(Seen { points: points.to_vec(), complete: far });
        true
    }

    /// Closest point to a point that is watched, within its reach; `warm` is the piece and parameters of the last projection,
    /// to which it may keep at a kink.
    pub fn project(
        &self,
        point: &Vec3,
        reach: f64,
        (warm, keeps): (Option<(u32, [f64; 2])>, bool),
    ) -> Option<Projection> {
        match keeps {
            true => self.near.contact(point, reach, warm, &self.controls),
            false => self.near.closest(point, reach, warm),
        }
    }

    /// What this rank can project onto, complete for what is watched.
    pub fn near(&self) -> &Shape {
        &self.near
    }

    /// Gives back what is near; the next watch fetches it anew.
    pub fn forget(&mut self) {
        match &self.share {
            Share::Patches(_) => self.near = Shape::Patches(PatchSet::default()),
            Share::Faces(_) => self.near = Shape::Faces(FaceSet::new(&[])),
            Share::Nothing => {}
        }
        self.seen = None;
    }

    /// Whether it has no end, so that what is behind it is inside; never known of closed forms. Collective.
    pub fn is_closed(&self, comm: &SimpleCommunicator) -> bool {
        let is_open = match &self.share {
            Share::Patches(all) => all.iter().any(|p| p.edges[..p.count as usize].contains(&Edge::Boundary)),
            Share::Faces(all) => all.iter().flat_map(|face| &face.rims).any(|rim| rim.edge == Edge::Boundary),
            Share::Nothing => true,
        };
        !any(comm, is_open)
    }

    /// Where the surface is not the same all along z between two planes z, to a distance of `slack`, in words; `None` where it is.
    /// What lies beyond the planes does not count. Collective.
    pub fn unlike_along_z(&mut self, comm: &SimpleCommunicator, [low, high]: [f64; 2], slack: f64) -> Option<String> {
        if let Share::Nothing = &self.share {
            return self.near.ends_along_z().and_then(|[from, to]| {
                let rounded = ROUNDED * (to - from);
                (from > low + rounded || to < high - rounded).then(|| format!("it goes from z = {from:?} to {to:?}"))
            });
        }
        let (between, across) = self.points_between([low, high]);
        let place = |x: &Vec3| format!("({:.6}, {:.6}, {:.6})", x.x, x.y, x.z);
        if let Some(told) = first_word(comm, across.map(|x| format!("it has a face across z at {}", place(&x)))) {
            return Some(told);
        }
        if !any(comm, !between.is_empty()) {
            return Some("it has nothing there".into());
        }
        let at = |x: &Vec3, z: f64| Vec3::new(x.x, x.y, z);
        let places: Vec<Vec3> = between.iter().flat_map(|x| [low, high].map(|z| at(x, z))).collect();
        self.watch(comm, &places, slack);
        let is_lost = |k: &usize| self.near.nearest(&places[*k], slack).is_none();
        let lost = (0..places.len()).filter(is_lost).min_by(|a, b| places[*a].x.total_cmp(&places[*b].x));
        self.forget();
        let told = |k: usize| {
            let z = places[k].z;
            format!("its point {} has none of it straight above or below at z = {z:?}", place(&between[k / 2]))
        };
        word_of_largest(comm, lost.map(|k| (k, -places[k].x)), told).map(|(told, _)| told)
    }

    /// Corners of this rank's cells that have more than their border between two planes z, one of those that stand over each
    /// other; and a place where a cell lies across.
    fn points_between(&self, [low, high]: [f64; 2]) -> (Vec<Vec3>, Option<Vec3>) {
        const CELLS: usize = 4;
        let cells = match &self.share {
            Share::Patches(share) => Tessellation::of_patches(share, CELLS),
            Share::Faces(share) => Tessellation::of_faces(FaceSet::new(share).pieces(), CELLS),
            Share::Nothing => Tessellation::default(),
        };
        let slack = ALIKE * (high - low);
        let (mut between, mut across) = (BTreeMap::new(), None);
        let all = (cells.triangles.iter().map(|cell| &cell[..])).chain(cells.quads.iter().map(|cell| &cell[..]));
        for corners in all.map(|cell| cell.iter().map(|k| Vec3::from(cells.points[*k as usize]))) {
            let ends = |[from, to]: [f64; 2], x: Vec3| [from.min(x.z), to.max(x.z)];
            let [from, to] = corners.clone().fold([f64::INFINITY, f64::NEG_INFINITY], ends);
            if from < high - slack && to > low + slack {
                between.extend(corners.clone().map(|x| ([x.x.to_bits(), x.y.to_bits()], x)));
            }
            // What only touches a plane may lie in it: the nodes there would meet that.
            if to - from <= slack && from < high + slack && to > low - slack {
                across = corners.clone().next();
            }
        }
        (between.into_values().collect(), across)
    }

    /// Leaves out what lies beyond two planes z, as the caps of a closed surface: a node in one of them could be nearer to that
    /// than to what it is pressed against. Analytic shapes have nothing there.
    pub fn keep_between(&mut self, [low, high]: [f64; 2]) {
        let slack = ALIKE * (high - low);
        let is_between = |(from, to): (Vec3, Vec3)| from.z < high - slack && to.z > low + slack;
        match &mut self.share {
            Share::Patches(share) => share.retain(|patch| is_between(patch.bounds())),
            Share::Faces(share) => share.retain(|face| is_between(face.bounds)),
            Share::Nothing => {}
        }
        self.forget();
    }

    /// Takes the point that says where a surface without end is to beside the bodies, see [`crate::surface::analytic::Analytic::settle`].
    pub fn settle(&mut self, (low, high): &Bounds) {
        /// Sizes of the bodies. Nearer, rounding is of no account.
        const FAR: f64 = 10.0;
        if let Shape::Analytic(shape) = &mut self.near {
            self.settled = shape.settle(&((low + high) * 0.5), FAR * (high - low).norm());
        }
    }

    /// The largest coordinate or length of the surface as it is meshed or described, in the size of which gaps are rounded.
    /// Collective.
    pub fn far(&self, comm: &SimpleCommunicator) -> f64 {
        /// What settling has rounded is the same for all points, and moves the surface by no more than that.
        const ONCE: f64 = 1e-3;
        match &self.near {
            Shape::Analytic(shape) => shape.far().max(ONCE * self.settled),
            _ => self.bounds(comm).map_or(0.0, |(low, high)| low.amax().max(high.amax())),
        }
    }

    /// The box of the surface; `None` of what has closed forms, which may go on without end. Collective.
    pub fn bounds(&self, comm: &SimpleCommunicator) -> Option<Bounds> {
        let here = match &self.share {
            Share::Patches(share) => bounds(share.iter().map(Parametric::bounds).flat_map(|(lo, hi)| [lo, hi])),
            Share::Faces(share) => bounds(share.iter().flat_map(|face| [face.bounds.0, face.bounds.1])),
            Share::Nothing => None,
        };
        hull(comm, here)
    }

    /// The point nearest to a point that is watched, ends of the surface included.
    pub fn nearest(&self, point: &Vec3, reach: f64) -> Option<Projection> {
        self.near.nearest(point, reach)
    }

    /// Closest point to a point that is watched, wherever it comes from.
    pub fn closest(&self, point: &Vec3, reach: f64) -> Option<Projection> {
        self.near.closest(point, reach, None)
    }

    /// How far a node that keeps to its piece at a kink may be behind its neighbour `piece`.
    pub fn kink(&self, piece: u32) -> f64 {
        self.near.kink(piece, &self.controls)
    }

    /// Closest points to all points that the ranks hold, each rank its own, within `reach`. Collective.
    pub fn project_all(&mut self, comm: &SimpleCommunicator, points: &[Vec3], reach: f64) -> Vec<Option<Projection>> {
        self.watch(comm, points, reach);
        points.iter().map(|point| self.project(point, reach, (None, false))).collect()
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

impl Parcel for Patch {
    fn number(&self) -> u32 {
        self.id
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

    fn pack(&self, parcel: &mut Vec<f64>) {
        parcel.extend(self.to_numbers());
    }

    fn unpack(parcel: &[f64]) -> Vec<Self> {
        Self::from_numbers(parcel)
    }
}

/// An even share of the pieces that rank 0 has. Collective.
fn deal<P: Parcel>(comm: &SimpleCommunicator, all: &[P]) -> Vec<P> {
    parcels::deal(comm, all, |k, _| k * comm.size() as usize / all.len())
}
