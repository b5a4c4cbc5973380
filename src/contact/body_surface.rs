//! The faces of a deformable body as a master, on this rank: its share of the patches, and those near its slave nodes.
//!
//! A patch is a facet with the nodes around it that its shape depends on, its stencil. What belongs to which patch never
//! changes and is dealt out once, each patch to the owner of its first node. The shapes change with every iterate:
//!
//! - A rank fetches the patches whose current boxes come within the reach and a margin of one of its slave nodes. Until
//!   slave nodes and master nodes have travelled the margin together, what it has is complete; the travel of master nodes
//!   counts double because a patch may bulge as it moves. Then all ranks fetch again.
//! - The positions of the stencils of the near patches, whoever owns the nodes, come anew with every iterate.
//! - A patch with the slip origin of a slave node stays, near or not.

use super::Pair;
use super::element::frame;
use super::method::MasterSurface;
use crate::parallel::{any, max, number};
use crate::partition::parcels::{bounds, collect, deal, strayed};
use crate::partition::{Bounds, Gather, Parcel, owner};
use crate::surface::Smoothing;
use crate::surface::{MovingPatch, Patch, PatchSet, Projection, Tessellation};
use crate::{Mat3, Vec3};
use mpi::datatype::Equivalence;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// A deformable master surface.
pub struct BodySurface {
    /// `body.group`.
    pub name: String,
    pub given: MasterSurface,
    /// Its faces are quadratic and keep their own shape, whatever is given.
    pub is_quadratic: bool,
    /// Patches of the whole surface.
    pub total: u64,
    /// Longest edge of a patch.
    pub facet_size: f64,
    /// How often patches were fetched.
    pub fetches: usize,
    /// Positions of the near nodes at the last converged increment.
    pub before: Vec<Vec3>,
    /// Points of slave faces ask where they were on it then.
    pub keeps_past: bool,
    share: Share,
    near: Near,
}

/// The patches that were dealt out to this rank.
struct Share {
    patches: Vec<MovingPatch>,
    nodes: Gather,
    /// First nodes of the ranks.
    starts: Vec<u64>,
}

/// The patches near slave nodes of this rank.
#[derive(Default)]
struct Near {
    /// By rising id.
    patches: Vec<MovingPatch>,
    /// Indices of the stencil of each patch among the nodes.
    stencils: Vec<Vec<u32>>,
    nodes: Gather,
    positions: Vec<Vec3>,
    shapes: PatchSet,
    /// Their shapes at the last converged increment, where points ask for them.
    past: PatchSet,
    seen: Option<Seen>,
}

impl Near {
    /// The patches with their nodes at `positions`.
    fn shapes_at(&self, positions: &[Vec3]) -> Vec<Patch> {
        let mut own = Vec::new();
        let shapes = self.patches.iter().zip(&self.stencils).map(|(patch, stencil)| {
            own.clear();
            own.extend(pick(positions, stencil));
            patch.shape(&own)
        });
        // A diverging iterate may be nowhere.
        let somewhere =
            |p: &Patch| p.nodes.iter().chain(&p.coefficients).chain([&p.middle]).flatten().all(|x| x.is_finite());
        shapes.filter(somewhere).collect()
    }
}

/// What the near patches are complete for.
struct Seen {
    reach: f64,
    /// Where this rank's slave nodes were.
    slaves: Vec<Vec3>,
    /// Where the owned nodes of the surface were.
    masters: Vec<Vec3>,
}

/// Margin of a fetch over the reach.
pub const MARGIN: f64 = 2.0;

impl BodySurface {
    /// Deals out the patches that rank 0 has; their nodes have global numbers, as in [`crate::partition::Part::starts`].
    /// `facet_size` is the longest edge. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        name: &str,
        given: MasterSurface,
        patches: &[MovingPatch],
        starts: &[u64],
        facet_size: f64,
    ) -> Self {
        let share = deal(comm, patches, |_, patch| owner(starts, &patch.nodes[0]));
        let nodes = Gather::new(comm, starts, share.iter().flat_map(|p| p.nodes.iter().copied()));
        Self {
            name: name.into(),
            given,
            is_quadratic: any(comm, share.iter().any(|patch| patch.quadratic.is_some())),
            total: number(comm, share.len() as u64).1,
            facet_size,
            fetches: 0,
            before: Vec::new(),
            keeps_past: false,
            share: Share { patches: share, nodes, starts: starts.to_vec() },
            near: Near::default(),
        }
    }

    /// Takes the shapes for nodes at `place` (owned local nodes), with every patch within `reach` of this rank's `slaves`.
    /// Where some rank lacks one, all fetch; patches with an id in `kept` stay. Says whether they fetched. Collective.
    pub fn follow(
        &mut self,
        comm: &SimpleCommunicator,
        slaves: &[Vec3],
        reach: f64,
        kept: &BTreeSet<u32>,
        place: impl Fn(u32) -> Vec3,
    ) -> bool {
        let masters: Vec<Vec3> = self.share.nodes.asked().map(&place).collect();
        let travels = |seen: &Seen| [strayed(&seen.slaves, slaves), strayed(&seen.masters, &masters)];
        let mut travels = self.near.seen.as_ref().map_or([f64::INFINITY; 2], travels);
        max(comm, &mut travels);
        let complete = self.near.seen.as_ref().map_or(0.0, |seen| (1.0 + MARGIN) * seen.reach);
        let fetched = reach + travels[0] + 2.0 * travels[1] > complete;
        if fetched {
            self.fetch(comm, slaves, reach, kept, &place);
            self.near.seen = Some(Seen { reach, slaves: slaves.to_vec(), masters });
        }
        let positions = gather(comm, &self.near.nodes, &place);
        if fetched || positions != self.near.positions {
            self.near.shapes.follow(self.near.shapes_at(&positions));
            self.near.positions = positions;
        }
        fetched
    }

    /// The same within `reach` of all the slave nodes of its pair. Collective.
    pub fn follow_pair(
        &mut self,
        comm: &SimpleCommunicator,
        pair: &Pair,
        reach: f64,
        place: impl Fn(u32) -> Vec3,
    ) -> bool {
        let kept: BTreeSet<u32> = pair.slaves.iter().flat_map(|s| s.committed.origins()).map(|at| at.patch).collect();
        let slaves: Vec<Vec3> = pair.slaves.iter().map(|s| place(s.node)).collect();
        self.follow(comm, &slaves, reach, &kept, place)
    }

    fn fetch(
        &mut self,
        comm: &SimpleCommunicator,
        slaves: &[Vec3],
        reach: f64,
        kept: &BTreeSet<u32>,
        place: impl Fn(u32) -> Vec3,
    ) {
        let positions = gather(comm, &self.share.nodes, &place);
        let current = |p: &MovingPatch| shape_at(p, &positions, &stencil(p, &self.share.nodes)).bounds();
        let mut near = collect(comm, &self.share.patches, current, slaves, (1.0 + MARGIN) * reach);
        near.extend(self.near.patches.drain(..).filter(|p| kept.contains(&p.id)));
        near.sort_by_key(|p| p.id);
        near.dedup_by_key(|p| p.id);
        self.near.nodes = Gather::new(comm, &self.share.starts, near.iter().flat_map(|p| p.nodes.iter().copied()));
        self.near.stencils = near.iter().map(|p| stencil(p, &self.near.nodes)).collect();
        self.near.patches = near;
        self.fetches += 1;
    }

    /// Lets the next [`Self::follow`] fetch anew.
    pub fn forget(&mut self) {
        self.near.seen = None;
    }

    /// Remembers where the near nodes were at the last converged increment. Collective.
    pub fn remember(&mut self, comm: &SimpleCommunicator, before: impl Fn(u32) -> Vec3) {
        self.before = gather(comm, &self.near.nodes, before);
        if self.keeps_past {
            self.near.past.follow(self.near.shapes_at(&self.before));
        }
    }

    /// The near patches as they were then.
    pub fn shapes_before(&self) -> &PatchSet {
        &self.near.past
    }

    /// Three values of each near node, from those that the owners have of their local nodes. Collective.
    pub fn gather<T>(&self, comm: &SimpleCommunicator, value: impl Fn(u32, usize) -> T) -> Vec<[T; 3]>
    where
        T: Equivalence + Copy + Default,
    {
        self.near.nodes.fetch(comm, 3, value).as_chunks::<3>().0.to_vec()
    }

    /// The near patches as they are now.
    pub fn shapes(&self) -> &PatchSet {
        &self.near.shapes
    }

    /// A near patch, with the indices of its stencil among the near nodes.
    pub fn patch(&self, id: u32) -> Option<(&MovingPatch, &[u32])> {
        let k = self.near.patches.binary_search_by_key(&id, |p| p.id).ok()?;
        Some((&self.near.patches[k], &self.near.stencils[k]))
    }

    /// The component of the mesh that a point of a near patch is on.
    pub fn component(&self, at: &Projection) -> Option<usize> {
        self.patch(at.patch).map(|(patch, _)| patch.component as usize)
    }

    /// Tangents and unit normal of a near patch at a point of it, as columns.
    pub fn frame(&self, at: &Projection) -> Option<Mat3> {
        self.near.shapes.get(at.patch).map(|patch| frame(&patch.local(at.xi)))
    }

    /// The shape of a near patch at the last converged increment.
    pub fn shape_before(&self, id: u32) -> Option<Patch> {
        self.patch(id).map(|(patch, stencil)| shape_at(patch, &self.before, stencil))
    }

    /// Global number of a near node.
    pub fn number(&self, node: u32) -> u64 {
        self.near.nodes.number(node)
    }

    /// Current position of a near node, by its global number.
    pub fn position(&self, node: u64) -> Option<Vec3> {
        self.near.nodes.index(node).map(|k| self.near.positions[k as usize])
    }

    /// Positions of the near nodes elsewhere, given for owned local nodes. Collective.
    pub fn places(&self, comm: &SimpleCommunicator, place: impl Fn(u32) -> Vec3) -> Vec<Vec3> {
        gather(comm, &self.near.nodes, place)
    }

    /// Current positions of the near nodes.
    pub fn positions(&self) -> &[Vec3] {
        &self.near.positions
    }

    /// Hands forces on the near nodes to the owners: `add` gets a local node and a force. Collective.
    pub fn add_forces(&self, comm: &SimpleCommunicator, forces: &[Vec3], mut add: impl FnMut(u32, Vec3)) {
        let flat: Vec<f64> = forces.iter().flat_map(|f| [f.x, f.y, f.z]).collect();
        self.near.nodes.add_to_owners(comm, 3, &flat, |node, f| add(node, Vec3::new(f[0], f[1], f[2])));
    }

    /// Box of the motions of all nodes of the surface between two places of the owned ones, on this rank.
    pub fn travel(&self, from: impl Fn(u32) -> Vec3, to: impl Fn(u32) -> Vec3) -> Option<Bounds> {
        bounds(self.share.nodes.asked().map(|n| to(n) - from(n)))
    }

    /// This rank's share of the surface with nodes at `place`: each patch in `n` by `n` cells, a facet as it is.
    /// Collective.
    pub fn tessellate(&self, comm: &SimpleCommunicator, n: usize, place: impl Fn(u32) -> Vec3) -> Tessellation {
        let positions = gather(comm, &self.share.nodes, place);
        let n = self.cells(n);
        let mut cells = Tessellation::default();
        for patch in &self.share.patches {
            cells.add_patch(&shape_at(patch, &positions, &stencil(patch, &self.share.nodes)), n);
        }
        cells
    }

    /// A number for each point of [`Self::tessellate`], whatever the partition.
    pub fn point_numbers(&self, n: usize) -> Vec<u64> {
        let of_patch = |patch: &MovingPatch| {
            let first = u64::from(patch.id) << u32::BITS;
            first..first + Tessellation::points_of(patch.count, self.cells(n)) as u64
        };
        self.share.patches.iter().flat_map(of_patch).collect()
    }

    /// Cells along a side of a patch.
    fn cells(&self, n: usize) -> usize {
        if self.given.smoothing == Smoothing::Facet && !self.is_quadratic { 1 } else { n }
    }
}

/// Where a patch finds its stencil in a list of nodes that has it all.
pub(super) fn stencil(patch: &MovingPatch, nodes: &Gather) -> Vec<u32> {
    patch.nodes.iter().filter_map(|&n| nodes.index(n)).collect()
}

fn pick<'a>(positions: &'a [Vec3], stencil: &'a [u32]) -> impl Iterator<Item = Vec3> + 'a {
    stencil.iter().map(|&n| positions[n as usize])
}

/// A patch with its nodes at those of these positions that its stencil names.
pub(super) fn shape_at(patch: &MovingPatch, positions: &[Vec3], stencil: &[u32]) -> Patch {
    patch.shape(&pick(positions, stencil).collect::<Vec<_>>())
}

pub(super) fn gather(comm: &SimpleCommunicator, nodes: &Gather, place: impl Fn(u32) -> Vec3) -> Vec<Vec3> {
    let flat = nodes.fetch(comm, 3, |n, d| place(n)[d]);
    flat.as_chunks::<3>().0.iter().map(|x| Vec3::from(*x)).collect()
}

impl Parcel for MovingPatch {
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
