//! A rigid tool on this rank: its share of the surface, and the patches near this rank's slave nodes.
//!
//! The patches of a meshed tool are dealt out over the ranks. For its slave nodes a rank publishes one box in the tool's
//! frame; every rank sends the patches of its share that meet the box. What is near is complete for nodes inside the box
//! without its margin, so it is fetched again only when a node leaves that.

use super::{Pair, Pose};
use crate::error::Result;
use crate::parallel::{agree, any, exchange, number};
use crate::scene::{self, Smoothing, ToolShape};
use crate::surface::analytic::{Cylinder, Plane, Sphere};
use crate::surface::{Patch, PatchSet, Projection, Shape, Tessellation, patches_from_mesh};
use crate::{Vec3, mesh};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// A rigid tool.
pub struct Tool {
    pub name: String,
    /// What this rank can project onto: the whole of an analytic shape, the near patches of a mesh.
    near: Shape,
    /// This rank's share of the patches, by ascending id; empty for an analytic shape.
    share: Vec<Patch>,
    /// Box in the tool's frame, and the reach, for which `near` is complete.
    complete: Option<(Vec3, Vec3, f64)>,
    /// Pose at the last converged increment.
    pub committed: Pose,
    /// Pose of the current iterate.
    pub trial: Pose,
    /// Patches of the whole tool; 0 for an analytic shape.
    pub patches: u64,
    /// The surface is made of flat facets.
    pub faceted: bool,
}

/// An axis-aligned box.
type Bounds = (Vec3, Vec3);

impl Tool {
    /// Reads the surface on rank 0 and deals out its patches. Collective.
    ///
    /// # Errors
    /// A mesh that cannot be read or is not a surface, on all ranks.
    pub fn new(comm: &SimpleCommunicator, tool: &scene::Tool) -> Result<Self> {
        let mut share = Vec::new();
        let mut patches = 0;
        let near = match &tool.shape {
            ToolShape::Mesh { mesh, smoothing, feature_angle, flip } => {
                let all = if comm.rank() == 0 {
                    mesh::load(mesh, mesh::Purpose::Tool)
                        .and_then(|m| patches_from_mesh(&m, *smoothing, *feature_angle, *flip))
                } else {
                    Ok(Vec::new())
                };
                let all = agree(comm, all)?;
                let size = comm.size() as usize;
                let parcels: Vec<Vec<f64>> = (0..size)
                    .map(|r| {
                        let dealt = &all[all.len() * r / size..all.len() * (r + 1) / size];
                        dealt.iter().flat_map(Patch::to_array).collect()
                    })
                    .collect();
                share = decode(&exchange(comm, &parcels)[0]);
                patches = number(comm, share.len() as u64).1;
                Shape::Patches(PatchSet::new(Vec::new()))
            }
            ToolShape::Plane { point, normal } => Shape::Plane(Plane { point: *point, normal: *normal }),
            ToolShape::Cylinder { point, axis, radius, hollow } => {
                Shape::Cylinder(Cylinder { point: *point, axis: *axis, radius: *radius, hollow: *hollow })
            }
            ToolShape::Sphere { center, radius, hollow } => {
                Shape::Sphere(Sphere { center: *center, radius: *radius, hollow: *hollow })
            }
        };
        Ok(Self {
            name: tool.name.value.clone(),
            near,
            share,
            complete: None,
            committed: Pose::default(),
            trial: Pose::default(),
            patches,
            faceted: matches!(tool.shape, ToolShape::Mesh { smoothing: Smoothing::Facet, .. }),
        })
    }

    /// Makes sure that every patch within `reach` of the given points (all of this rank's slave nodes that may meet the tool,
    /// in space, with the tool at its trial pose) is near. Fetches with a margin when some rank lacks one. Collective.
    fn watch(&mut self, comm: &SimpleCommunicator, points: impl Iterator<Item = Vec3>, reach: f64) {
        let bounds = bounds(points.map(|x| self.trial.inward(&x)));
        let lacking = match (self.complete, bounds) {
            (_, None) => false,
            (None, Some(_)) => true,
            (Some((lo, hi, enough)), Some(b)) => !(inside(&(lo, hi), &b) && reach <= enough),
        };
        if self.patches == 0 || !any(comm, lacking) {
            return;
        }
        let margin = reach;
        let query = bounds.map(|(lo, hi)| (lo.add_scalar(-margin), hi.add_scalar(margin)));
        self.complete = query.map(|(lo, hi)| (lo, hi, reach));
        self.fetch(comm, query.map(|(lo, hi)| (lo.add_scalar(-reach), hi.add_scalar(reach))));
    }

    /// Collects the patches that meet this rank's box. Collective.
    fn fetch(&mut self, comm: &SimpleCommunicator, query: Option<Bounds>) {
        let asked: Vec<f64> = query.map_or(Vec::new(), |(lo, hi)| lo.iter().chain(hi.iter()).copied().collect());
        let parcels: Vec<Vec<f64>> = exchange(comm, &vec![asked; comm.size() as usize])
            .iter()
            .map(|asked| {
                let meets = |p: &&Patch| {
                    let (lo, hi) = p.bounds();
                    (0..3).all(|d| lo[d] <= asked[3 + d] && hi[d] >= asked[d])
                };
                if asked.is_empty() {
                    Vec::new()
                } else {
                    self.share.iter().filter(meets).flat_map(Patch::to_array).collect()
                }
            })
            .collect();
        let received = exchange(comm, &parcels).concat();
        self.near = Shape::Patches(PatchSet::new(decode(&received)));
    }

    /// How far the origin of the tool's frame has moved since the beginning, at the last converged increment.
    pub fn displacement(&self) -> Vec3 {
        self.committed.translation
    }

    /// Whether all patches near a point in the tool's frame were fetched by the last [`watch_all`].
    pub fn covers(&self, point: &Vec3) -> bool {
        self.patches == 0 || self.complete.is_some_and(|(lo, hi, _)| inside(&(lo, hi), &(*point, *point)))
    }

    /// Closest point of the tool at its trial pose to a point in space; the search starts at patch `warm`.
    pub fn project(&self, point: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        let r = self.trial.rotation;
        self.near.closest(&self.trial.inward(point), reach, warm).map(|p| Projection {
            point: self.trial.outward(&p.point),
            normal: r * p.normal,
            normal_gradient: r * p.normal_gradient * r.transpose(),
            ..p
        })
    }

    /// This rank's share of what the solver sees, for output, in the tool's frame: `n` by `n` pieces a curved patch; analytic
    /// shapes are cut to about a box and shown by rank 0.
    pub fn tessellate(&self, rank: i32, n: usize, (lo, hi): &Bounds) -> Tessellation {
        match &self.near {
            Shape::Patches(_) => Tessellation::of_patches(&self.share, n),
            analytic if rank == 0 => analytic.tessellate(n, lo, hi),
            _ => Tessellation::default(),
        }
    }
}

/// Lets every tool watch all the slave nodes of its pairs, which `place` puts in space. Collective.
pub fn watch_all(comm: &SimpleCommunicator, tools: &mut [Tool], pairs: &[Pair], place: impl Fn(u32) -> Vec3) {
    for (t, tool) in tools.iter_mut().enumerate() {
        let of_tool = || pairs.iter().filter(|pair| pair.tool == t);
        let points = of_tool().flat_map(|pair| &pair.slaves).map(|slave| place(slave.node));
        tool.watch(comm, points, of_tool().map(|pair| pair.reach).fold(0.0, f64::max));
    }
}

fn decode(flat: &[f64]) -> Vec<Patch> {
    let mut patches: Vec<Patch> = flat.as_chunks::<{ Patch::LEN }>().0.iter().map(Patch::from_array).collect();
    patches.sort_by_key(|p| p.id);
    patches
}

fn bounds(points: impl Iterator<Item = Vec3>) -> Option<Bounds> {
    points.fold(None, |b: Option<Bounds>, x| Some(b.map_or((x, x), |(lo, hi)| (lo.inf(&x), hi.sup(&x)))))
}

fn inside(outer: &Bounds, inner: &Bounds) -> bool {
    (0..3).all(|d| outer.0[d] <= inner.0[d] && inner.1[d] <= outer.1[d])
}
