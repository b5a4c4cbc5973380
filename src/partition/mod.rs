//! The mesh cut into one part a rank: METIS on the dual graph, node ownership, and the node halo.
//!
//! Rank 0 reads the whole mesh, partitions it and sends every rank its part; nobody keeps the whole. A rank owns nodes,
//! holds every element that touches one of them, and sees the other nodes of those elements as its halo. It can then
//! assemble its own rows of any finite-element matrix without sending matrix entries. Surfaces are seen farther than that:
//! [`Gather`] fetches values of nodes wherever they are owned, [`parcels`] deals out the pieces of a surface, and
//! [`directory`] finds which of them come near the points of which rank. What is written to files stands in an
//! [`Order`] of its own, whatever the partition. Every rank knows the [`Component`]s of the whole mesh.

mod components;
pub mod directory;
mod distribute;
mod gather;
mod graph;
mod halo;
mod lists;
mod order;
pub mod parcels;

/// Planes z that are closer than this part of the thickness between two are one.
pub const ALIKE: f64 = 1e-6;

pub use components::{Component, lowest_joined};
pub use distribute::{GlobalFacet, GlobalMesh, GlobalSet, OfFile, Piece, distribute, pieces};
pub use gather::{Gather, owner};
pub use graph::{element_parts, node_owners};
pub use halo::Halo;
pub use lists::Lists;
pub use order::Order;
pub use parcels::{Bounds, Parcel};

use crate::Vec3;
use crate::mesh::middles::four;
use crate::mesh::{MOST_NODES, Middles, Quarters, SolidShape};
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use std::borrow::Cow;
use std::ops::Deref;

/// A volume element on a rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartSolid {
    pub shape: SolidShape,
    /// Local nodes; as many as the shape has count.
    pub nodes: [u32; MOST_NODES],
    /// Index of its body in the scene.
    pub body: u32,
    /// Index of its section in those of the scene.
    pub section: u32,
    /// Its number in the mesh file, for messages.
    pub id: u64,
    /// Its number among the elements of all bodies, whatever the partition.
    pub number: u64,
    /// This rank counts it in sums and writes it: it owns the element's first node.
    pub mine: bool,
}

impl PartSolid {
    /// The nodes that count.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.shape.node_count()]
    }
}

/// The local nodes that carry a facet: its corners, and those in the middles of its edges; of a quarter of a quadratic face all of it.
#[derive(Clone, Copy, Debug)]
pub struct FaceNodes {
    nodes: [u32; 9],
    count: usize,
    /// Of what the nodes bear: 1, but of a quarter of a face of six nodes 1/4, for its four quarters together bear what the face does.
    pub share: f64,
}

impl FaceNodes {
    /// Of the facet with these corners.
    pub fn of(corners: &[u32], middles: &Middles, quarters: &Quarters) -> Self {
        let with = |more: &[u32], share: f64| {
            let (mut nodes, count) = ([0; 9], corners.len() + more.len());
            nodes[..corners.len()].copy_from_slice(corners);
            nodes[corners.len()..count].copy_from_slice(more);
            Self { nodes, count, share }
        };
        match (middles.of(corners), quarters.of(corners)) {
            (Some(middles), _) => with(&middles, 1.0),
            (None, Some(whole)) => {
                let mut nodes = [0; 9];
                nodes[..whole.len()].copy_from_slice(whole);
                Self { nodes, count: whole.len(), share: if whole.len() == 6 { 0.25 } else { 1.0 } }
            }
            (None, None) => with(&[], 1.0),
        }
    }
}

impl Deref for FaceNodes {
    type Target = [u32];

    fn deref(&self) -> &[u32] {
        &self.nodes[..self.count]
    }
}

impl Part {
    /// The numbers of the local nodes over all ranks, see [`Self::starts`]. Collective.
    pub fn global_numbers(&self, comm: &SimpleCommunicator) -> Vec<u64> {
        let first = self.starts[comm.rank() as usize];
        let mut numbers: Vec<u64> = (first..first + self.points.len() as u64).collect();
        self.halo.update(comm, 1, &mut numbers);
        numbers
    }

    /// The owned nodes of a body of the scene.
    pub fn owned_of(&self, body: usize) -> impl Iterator<Item = usize> + Clone {
        (0..self.owned).filter(move |&n| self.body[n] as usize == body)
    }

    /// Vectors of the owned nodes, of which those that move as one share the sum: those that are `supported`, else all.
    pub fn evened(&self, vectors: &[Vec3], supported: &[bool]) -> Vec<Vec3> {
        let (mut sums, mut sharing) = (vec![Vec3::zeros(); self.owned], vec![[0.0; 2]; self.owned]);
        let ties = || self.tie[..self.owned].iter().map(|&tie| tie as usize);
        let bears = |n: usize| supported.get(n) == Some(&true);
        for ((n, tie), vector) in ties().enumerate().zip(vectors) {
            sums[tie] += vector;
            sharing[tie][usize::from(bears(n))] += 1.0;
        }
        let share = |(n, tie): (usize, usize)| match sharing[tie] {
            [all, 0.0] => sums[tie] / all,
            [_, some] if bears(n) => sums[tie] / some,
            _ => Vec3::zeros(),
        };
        ties().enumerate().map(share).collect()
    }

    /// Longest edge of a facet; of a layer's in its plane.
    pub fn longest_edge(&self, facet: &PartFacet, is_planar: bool) -> f64 {
        let count = facet.count as usize;
        let at = |k: usize| self.points[facet.nodes[k % count] as usize];
        let length = |along: Vec3| if is_planar { along.xy().norm() } else { along.norm() };
        (0..count).map(|k| length(at(k + 1) - at(k))).fold(0.0, f64::max)
    }

    /// Facets as contacts see them: a quadratic triangle is four linear ones.
    pub fn pieces<'a>(&self, facets: &'a [PartFacet]) -> Cow<'a, [PartFacet]> {
        // Far above the numbers of facets, which are those of ranks that have linear ones alone, too.
        const PARTS: u32 = 48;
        if self.quadratic.middles.is_empty() {
            return Cow::Borrowed(facets);
        }
        let pieces = facets.iter().flat_map(|facet| {
            let [a, b, c, _] = facet.nodes;
            let parts = match self.quadratic.middles.of(&facet.nodes[..facet.count as usize]) {
                Some(middles) => four([a, b, c], middles).map(|[a, b, c]| [a, b, c, 0]).to_vec(),
                None => vec![facet.nodes],
            };
            let part = |(k, nodes)| PartFacet { nodes, number: facet.number | k << PARTS, ..*facet };
            (0u64..).zip(parts).map(part).collect::<Vec<_>>()
        });
        Cow::Owned(pieces.collect())
    }

    /// The nodes that carry a facet: 3 or 4, 6 of a quadratic triangle, or the 6 or 9 of the face that it is a quarter of.
    pub fn face_nodes(&self, facet: &PartFacet) -> FaceNodes {
        FaceNodes::of(&facet.nodes[..facet.count as usize], &self.quadratic.middles, &self.quadratic.quarters)
    }

    /// The least and the largest distance of two nodes of an element, on the initial mesh.
    pub fn span(&self, solid: &PartSolid) -> (f64, f64) {
        let place = |n: u32| self.points[n as usize];
        let nodes = solid.nodes();
        let pairs = nodes.iter().enumerate().flat_map(|(i, &a)| nodes[..i].iter().map(move |&b| (a, b)));
        let widen = |(low, high): (f64, f64), d: f64| (low.min(d), high.max(d));
        pairs.map(|(a, b)| (place(a) - place(b)).norm()).fold((f64::INFINITY, 0.0), widen)
    }
}

/// A facet of a set on a rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartFacet {
    /// 3 or 4.
    pub count: u8,
    /// Local nodes of its corners, counter-clockwise seen from outside.
    pub nodes: [u32; 4],
    /// Its number in the set, whatever the partition.
    pub number: u64,
    /// This rank counts it in sums and writes it.
    pub mine: bool,
}

/// A set of the scene on a rank.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartSet {
    /// Owned nodes of the set.
    pub nodes: Vec<u32>,
    /// Facets of the set that touch an owned node.
    pub facets: Vec<PartFacet>,
}

/// What one rank holds of the mesh.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// Nodes `0..owned` are owned, the rest is halo.
    pub owned: usize,
    /// Reference positions.
    pub points: Vec<Vec3>,
    /// Index of the body that a node belongs to.
    pub body: Vec<u32>,
    /// Index of the section of a node: of those around it the stiffest.
    pub section: Vec<u32>,
    /// Index of the component of a node in [`Self::components`].
    pub component: Vec<u32>,
    /// The parts of all bodies that share no nodes with each other, by their lowest nodes; on every rank.
    pub components: Vec<Component>,
    /// The number a node has in its mesh file, for messages.
    pub id: Vec<u64>,
    /// Its number among the nodes of all bodies, whatever the partition.
    pub number: Vec<u64>,
    /// The local node whose displacement this node shares (a layer); mostly itself.
    pub tie: Vec<u32>,
    pub solids: Vec<PartSolid>,
    pub quadratic: Quadratic,
    /// In the order in which they were given to [`distribute`].
    pub sets: Vec<PartSet>,
    pub halo: Halo,
    /// Nodes have numbers over all ranks: rank r owns `starts[r]..starts[r + 1]`, in the order of its local nodes.
    pub starts: Vec<u64>,
    pub whole: Whole,
}

/// What carries the facets of all sets where they are quadratic.
#[derive(Clone, Debug, Default)]
pub struct Quadratic {
    /// Of their edges.
    pub middles: Middles,
    pub quarters: Quarters,
}

impl Quadratic {
    pub fn is_empty(&self) -> bool {
        self.middles.is_empty() && self.quarters.is_empty()
    }
}

/// How large the whole mesh is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Whole {
    pub nodes: u64,
    pub solids: u64,
}
