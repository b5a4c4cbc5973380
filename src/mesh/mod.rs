//! Meshes: points, solids, surface facets and named groups, read on rank 0.
//!
//! [`load`] goes from the scene to a checked mesh: a reader or [`block`] gives all of a file, `select` takes the body
//! or tool out of it and `orient` turns its facets outward, [`check`](check::check) refuses what cannot be computed. [`tie_layer`]
//! prepares a body of one layer for plane strain.

pub(crate) mod abaqus;
pub mod block;
pub mod check;
pub mod faces;
pub mod flat;
mod gmsh;
mod layer;
mod load;
pub(crate) mod message;
mod orient;
mod raw;
mod select;
mod stl;

pub use layer::tie_layer;
pub use load::load;
pub(crate) use raw::Slot;

use std::collections::BTreeMap;

/// What a mesh is loaded for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A deformable body: solids, and facets on their boundary.
    Body,
    /// A rigid surface: facets alone.
    Tool,
}

/// Shape of a volume element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SolidShape {
    /// 4 nodes.
    Tet4,
    /// 8 nodes; Gmsh and Abaqus order: bottom face counter-clockwise seen from inside the element, then the top face.
    Hex8,
}

/// A volume element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solid {
    pub shape: SolidShape,
    /// Indices into [`Mesh::points`]; the first 4 or all 8 count.
    pub nodes: [u32; 8],
    /// Its number in the file, for messages.
    pub id: u64,
}

/// A surface facet: a triangle, or a quadrilateral when `count` is 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// 3 or 4.
    pub count: u8,
    /// Counter-clockwise seen from outside.
    pub nodes: [u32; 4],
    /// Its number in the file, or that of the element it is a face of.
    pub id: u64,
}

/// A named group.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// All its nodes, sorted, each once.
    pub nodes: Vec<u32>,
    /// The nodes of its lines in ascending order, sorted.
    pub lines: Vec<[u32; 2]>,
    /// Indices into [`Mesh::facets`], sorted.
    pub facets: Vec<u32>,
    /// Indices into [`Mesh::solids`], sorted.
    pub solids: Vec<u32>,
}

/// A mesh as read or generated. Every node belongs to a solid or a facet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// File name, or "block".
    pub source: String,
    pub points: Vec<[f64; 3]>,
    /// The number of each point in its file, for messages.
    pub point_ids: Vec<u64>,
    pub solids: Vec<Solid>,
    pub facets: Vec<Facet>,
    pub groups: BTreeMap<String, Group>,
    /// What the user should know of the file.
    pub warnings: Vec<String>,
}

impl Solid {
    /// The nodes that count.
    pub fn nodes(&self) -> &[u32] {
        match self.shape {
            SolidShape::Tet4 => &self.nodes[..4],
            SolidShape::Hex8 => &self.nodes,
        }
    }
}

impl Facet {
    /// The nodes that count.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count as usize]
    }
}

/// Appends; what is first is not copied, for it may be most of the memory of a scene.
pub(crate) fn join<T>(all: &mut Vec<T>, more: Vec<T>) {
    match all.is_empty() {
        true => *all = more,
        false => all.extend(more),
    }
}
