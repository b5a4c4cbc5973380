//! Meshes: points, solids, surface facets and named groups, read on rank 0.
//!
//! [`load`] goes from the scene to a checked mesh: a reader or [`block`] gives all of a file, hexahedra, wedges and
//! quadrilaterals of second order as linear ones (`halves`), of which [`make_quadratic`] makes whole ones, and elements with nodes that occur twice as what they are
//! (`collapse`), `select` takes the body or tool out of it and `orient` turns its facets outward,
//! [`check`](check::check) refuses what cannot be computed. [`tie_layer`] prepares a body of one layer, [`lay_flat`] a sheet.

pub(crate) mod abaqus;
pub mod block;
pub mod check;
mod collapse;
pub mod faces;
pub mod flat;
mod gmsh;
mod halves;
mod layer;
mod load;
pub(crate) mod message;
pub mod middles;
mod orient;
mod quadratic;
pub mod quarters;
mod raw;
mod select;
mod shape;
mod sheet;
mod stl;

pub(crate) use collapse::Sides;
pub(crate) use halves::{Made, at_side, is_made};
pub use layer::tie_layer;
pub use load::load;
pub use middles::Middles;
pub use quadratic::make_quadratic;
pub use quarters::Quarters;
pub(crate) use raw::Slot;
pub use shape::SolidShape;
pub use sheet::lay_flat;

use std::collections::BTreeMap;

/// What a mesh is loaded for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A deformable body: solids, and facets on their boundary.
    Body,
    /// A rigid surface: facets alone.
    Tool,
}

/// The most nodes of a volume element.
pub const MOST_NODES: usize = 27;

/// A volume element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solid {
    pub shape: SolidShape,
    /// Indices into [`Mesh::points`]; as many as the shape has count.
    pub nodes: [u32; MOST_NODES],
    /// Its number in the file, for messages.
    pub id: u64,
}

/// A surface facet: a triangle, or a quadrilateral when `count` is 4. It names its corners; [`Mesh::middles`] has more nodes
/// where it is quadratic.
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
    /// The ends of its lines in ascending order, sorted.
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
    /// Of the edges of facets and lines of quadratic elements.
    pub middles: Middles,
    pub groups: BTreeMap<String, Group>,
    /// What the user should know of the file.
    pub warnings: Vec<String>,
    /// Its solids are axisymmetric elements, drawn out by one layer along z.
    pub is_section: bool,
    /// Some of its solids are parts of elements of second order.
    pub has_halves: bool,
}

impl Solid {
    /// With as many nodes as the shape has.
    pub fn new(shape: SolidShape, nodes: &[u32], id: u64) -> Self {
        let mut all = [0; MOST_NODES];
        all[..nodes.len()].copy_from_slice(nodes);
        Self { shape, nodes: all, id }
    }

    /// The nodes that count.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.shape.node_count()]
    }
}

impl Facet {
    /// With as many corners as are given.
    pub fn new(corners: &[u32], id: u64) -> Self {
        let mut nodes = [0; 4];
        nodes[..corners.len()].copy_from_slice(corners);
        Self { count: corners.len() as u8, nodes, id }
    }

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
