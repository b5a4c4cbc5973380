//! A mesh as its file describes it: all of it, and before anything is selected, oriented or checked.

use super::collapse::{Sides, once};
use super::halves::{Kind, Made, Splitter};
use super::middles::four;
use super::{Facet, Group, Mesh, Solid, SolidShape};
use super::{join, message};
use crate::Vec3;
use crate::error::{Error, Result};
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::ops::Range;

/// Shapes that files hold; points and lines matter to groups alone. Those of second order have the nodes in the middles of their
/// edges behind the corners, as [`SolidShape::Tet10`] has them; on a triangle between 0 and 1, 1 and 2, 2 and 0. Hexahedra, wedges and
/// quadrilaterals of second order have those of Abaqus, then the middles of [`super::faces`] and of all, if they have these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum CellShape {
    Point,
    Line,
    Triangle,
    Quad,
    Tet,
    Hex,
    Wedge,
    Pyramid,
    Line3,
    Triangle6,
    Tet10,
    Quad8,
    Quad9,
    Hex20,
    Hex27,
    Wedge15,
    Wedge18,
    /// A quadrilateral of second order drawn out by one layer: corners below and above, middles of edges below and above.
    Layer8,
}

impl CellShape {
    pub fn node_count(self) -> usize {
        match self {
            Self::Point => 1,
            Self::Line => 2,
            Self::Triangle => 3,
            Self::Quad | Self::Tet => 4,
            Self::Hex => 8,
            Self::Wedge => 6,
            Self::Pyramid => 5,
            Self::Line3 => 3,
            Self::Triangle6 => 6,
            Self::Tet10 => 10,
            Self::Quad8 => 8,
            Self::Quad9 => 9,
            Self::Hex20 => 20,
            Self::Hex27 => 27,
            Self::Wedge15 => 15,
            Self::Wedge18 => 18,
            Self::Layer8 => 16,
        }
    }

    /// Points, lines, surfaces or volumes.
    pub fn dimension(self) -> u8 {
        match self {
            Self::Point => 0,
            Self::Line | Self::Line3 => 1,
            Self::Triangle | Self::Quad | Self::Triangle6 | Self::Quad8 | Self::Quad9 => 2,
            _ => 3,
        }
    }
}

/// An element by the numbers of its file.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub shape: CellShape,
    pub id: u64,
    pub nodes: SmallVec<[u64; 8]>,
}

/// Where a cell went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// A solid, or the parts of one of second order.
    Solids { first: u32, count: u32 },
    /// A facet, or the parts of one of second order.
    Facets { first: u32, count: u32 },
    /// A point or a line with its ends (the same twice for a point).
    Loose([u32; 2]),
    /// A line of second order along elements that are split: its ends and its middle.
    Halves([u32; 3]),
}

impl Slot {
    /// The solids that it has become.
    pub fn solids(self) -> Range<u32> {
        match self {
            Self::Solids { first, count } => first..first + count,
            _ => 0..0,
        }
    }

    /// The facets that it has become.
    pub fn facets(self) -> Range<u32> {
        match self {
            Self::Facets { first, count } => first..first + count,
            _ => 0..0,
        }
    }
}

impl Group {
    /// Adds what became of an element.
    pub(super) fn add(&mut self, slot: Slot) {
        match slot {
            Slot::Solids { .. } => self.solids.extend(slot.solids()),
            Slot::Facets { .. } => self.facets.extend(slot.facets()),
            Slot::Loose([a, b]) => {
                self.nodes.extend([a, b]);
                if a != b {
                    self.lines.push([a.min(b), a.max(b)]);
                }
            }
            Slot::Halves([a, b, middle]) => {
                self.nodes.extend([a, b, middle]);
                self.lines.extend([a, b].map(|end| [end.min(middle), end.max(middle)]));
            }
        }
    }
}

/// A group as listed.
#[derive(Clone, Debug, Default)]
pub(super) struct FileGroup {
    /// Its nodes are those listed as nodes only.
    pub group: Group,
    /// The listed nodes are all; otherwise those of its facets and solids join them.
    pub closed: bool,
    /// It names elements that cannot be read: the error of whoever takes it.
    pub unread: Option<Error>,
}

/// All of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct FileMesh {
    /// Its groups are empty; `groups` has them.
    pub mesh: Mesh,
    pub groups: BTreeMap<String, FileGroup>,
    /// For each point, whether an element uses it or the file means it to stand alone.
    pub attached: Vec<bool>,
    /// The file has elements that cannot be read: the error of whoever takes all of it.
    pub unread: Option<Error>,
    /// The format is for closed surfaces with their outside out: what is not so is told.
    pub is_closed: bool,
    /// Nodes in the middles of faces and elements of second order that the file lacks.
    pub made: Vec<Made>,
    /// Solids that are parts of elements of second order.
    pub halves: Vec<Range<u32>>,
    pub sides: Sides,
}

/// From the numbers of a file to indices.
pub(crate) enum Ids {
    /// Index + 1 by number - first; 0 is a gap.
    Dense { first: u64, slots: Vec<u32> },
    /// Sorted by number.
    Sparse(Vec<(u64, u32)>),
}

impl Ids {
    /// Number `ids[i]` has the index `base + i`. Fails with the numbers that occur twice.
    pub fn new(ids: &[u64], base: u32) -> std::result::Result<Self, Vec<u64>> {
        let (first, last) = ids.iter().fold((u64::MAX, 0), |(low, high), &id| (low.min(id), high.max(id)));
        let indexed = ids.iter().zip(base..);
        let mut twice = Vec::new();
        let found = if !ids.is_empty() && last - first < 4 * ids.len() as u64 {
            let mut slots = vec![0; (last - first) as usize + 1];
            for (&id, index) in indexed {
                let slot = &mut slots[(id - first) as usize];
                if *slot != 0 {
                    twice.push(id);
                }
                *slot = index + 1;
            }
            Self::Dense { first, slots }
        } else {
            let mut sorted: Vec<_> = indexed.map(|(&id, index)| (id, index)).collect();
            sorted.sort_unstable();
            twice.extend(sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[0].0));
            Self::Sparse(sorted)
        };
        if twice.is_empty() { Ok(found) } else { Err(twice) }
    }

    pub fn get(&self, id: u64) -> Option<u32> {
        match self {
            Self::Dense { first, slots } => {
                let slot = slots.get(usize::try_from(id.checked_sub(*first)?).ok()?)?;
                slot.checked_sub(1)
            }
            Self::Sparse(sorted) => sorted.binary_search_by_key(&id, |pair| pair.0).ok().map(|at| sorted[at].1),
        }
    }

    /// Adds the indices of the numbers `first, first + step, ... <= last` that exist. Takes no longer than there are
    /// numbers, however long the range.
    pub fn range(&self, first: u64, last: u64, step: u64, to: &mut Vec<u32>) {
        let wanted = |id: u64| id >= first && id <= last && (id - first).is_multiple_of(step);
        match self {
            Self::Dense { first: low, slots } => {
                let skip = first.saturating_sub(*low).min(slots.len() as u64) as usize;
                let numbered = slots.iter().enumerate().skip(skip).map(|(at, slot)| (low + at as u64, slot));
                let inside = numbered.take_while(|(id, _)| *id <= last);
                to.extend(inside.filter(|(id, slot)| wanted(*id) && **slot > 0).map(|(_, slot)| slot - 1));
            }
            Self::Sparse(sorted) => {
                let from = sorted.partition_point(|pair| pair.0 < first);
                let numbered = sorted[from..].iter().take_while(|pair| pair.0 <= last);
                to.extend(numbered.filter(|pair| wanted(pair.0)).map(|pair| pair.1));
            }
        }
    }
}

impl FileMesh {
    pub fn new(source: &str) -> Self {
        Self { mesh: Mesh { source: source.into(), ..Mesh::default() }, ..Self::default() }
    }

    /// Appends points and the elements on them, which count their nodes among these points alone. Returns where the
    /// nodes and elements went. Fails on a node that is defined twice or missing.
    pub fn append(&mut self, mut ids: Vec<u64>, points: Vec<[f64; 3]>, cells: &[Cell]) -> Result<(Ids, Vec<Slot>)> {
        let base = self.mesh.points.len();
        if base + points.len().max(cells.len() * 8) >= u32::MAX as usize {
            return Err(message::whole_file(&self.mesh.source, "the mesh is too large for 32-bit numbers", ""));
        }
        let mut nodes = Ids::new(&ids, base as u32).map_err(|twice| {
            let what = format!("{} defined twice", message::several("node", &twice));
            message::whole_file(&self.mesh.source, what, "give each node a number of its own")
        })?;
        join(&mut self.mesh.points, points);
        self.attached.resize(self.mesh.points.len(), false);

        let mut missing = Vec::new();
        let mut splitter = Splitter::default();
        for cell in cells.iter().filter(|cell| cell.shape.halves().is_some()) {
            let found: Vec<u32> = cell.nodes.iter().filter_map(|&id| nodes.get(id)).collect();
            if found.len() == cell.nodes.len() {
                splitter.know(cell.shape, &found, cell.id);
            }
        }
        let mut slots = Vec::with_capacity(cells.len());
        for cell in cells {
            let mut found: SmallVec<[u32; 27]> = SmallVec::new();
            for &id in &cell.nodes {
                match nodes.get(id) {
                    Some(node) => found.push(node),
                    None => missing.push((cell.id, id)),
                }
            }
            if missing.is_empty() {
                slots.push(self.place(cell, &found, &mut splitter));
            }
        }
        if let Some((element, node)) = missing.first() {
            let what = format!("element {element} names node {node}, which does not exist");
            let what = what + &message::and_more(missing.len() - 1);
            return Err(message::whole_file(&self.mesh.source, what, "write the mesh with all its nodes"));
        }
        let indices = |cell: &Cell| cell.nodes.iter().filter_map(|&id| nodes.get(id)).collect();
        splitter.check(&self.mesh.source, cells.iter().map(|cell| (cell.shape, indices(cell), cell.id)))?;
        if !splitter.made.is_empty() {
            let above = above(ids.iter().copied().max().unwrap_or_default());
            let above = above.ok_or_else(|| {
                message::whole_file(&self.mesh.source, "node numbers leave no room for the middles of faces", "")
            })?;
            ids.extend((1..=splitter.made.len() as u64).map(|k| above + k));
            self.attached.resize(self.mesh.points.len(), true);
            nodes = Ids::new(&ids, base as u32)
                .map_err(|_| message::whole_file(&self.mesh.source, "node numbers are too large", ""))?;
        }
        join(&mut self.mesh.point_ids, ids);
        self.made.append(&mut splitter.made);
        Ok((nodes, slots))
    }

    /// The nodes of a facet, those in the middles of its edges, too.
    pub fn nodes_of(&self, facet: u32) -> impl Iterator<Item = u32> + '_ {
        let nodes = self.mesh.facets[facet as usize].nodes();
        nodes.iter().copied().chain(self.mesh.middles.around(nodes))
    }

    fn place(&mut self, cell: &Cell, nodes: &[u32], splitter: &mut Splitter) -> Slot {
        nodes.iter().for_each(|&node| self.attached[node as usize] = true);
        let mesh = &mut self.mesh;
        let (solids, facets) = (mesh.solids.len() as u32, mesh.facets.len() as u32);
        if let Some(kind) = cell.shape.halves() {
            let parts = splitter.split(cell.shape, nodes, &mut mesh.points);
            let count = parts.len() as u32;
            return match kind {
                Kind::Solids(shape) => {
                    mesh.solids.extend(parts.iter().map(|part| Solid::new(shape, part, cell.id)));
                    self.halves.push(solids..solids + count);
                    Slot::Solids { first: solids, count }
                }
                Kind::Facets => {
                    mesh.facets.extend(parts.iter().map(|part| Facet::new(part, cell.id)));
                    Slot::Facets { first: facets, count }
                }
            };
        }
        match cell.shape {
            CellShape::Point => return Slot::Loose([nodes[0]; 2]),
            CellShape::Line => return Slot::Loose([nodes[0], nodes[1]]),
            CellShape::Line3 => {
                let [a, b, middle] = along(nodes, &mesh.points);
                if splitter.middle(a, b).is_some() {
                    return Slot::Halves([a, b, middle]);
                }
                mesh.middles.add([a, b], middle);
                return Slot::Loose([a, b]);
            }
            // The end of a wedge.
            CellShape::Triangle6 if (0..3).all(|k| splitter.middle(nodes[k], nodes[(k + 1) % 3]).is_some()) => {
                let [a, b, c, ab, bc, ca] = std::array::from_fn(|k| nodes[k]);
                let parts = four([a, b, c], [ab, bc, ca]);
                mesh.facets.extend(parts.iter().map(|part| Facet::new(part, cell.id)));
                return Slot::Facets { first: facets, count: parts.len() as u32 };
            }
            CellShape::Triangle6 => {
                (0..3).for_each(|k| mesh.middles.add([nodes[k], nodes[(k + 1) % 3]], nodes[3 + k]));
            }
            _ => {}
        }
        let shape = match cell.shape {
            CellShape::Tet => SolidShape::Tet4,
            CellShape::Tet10 => SolidShape::Tet10,
            CellShape::Wedge => SolidShape::Wedge6,
            CellShape::Pyramid => SolidShape::Pyramid5,
            CellShape::Hex => SolidShape::Hex8,
            other => {
                let corners = &nodes[..if other == CellShape::Quad { 4 } else { 3 }];
                let found = once(corners).filter(|found| found.len() >= 3);
                mesh.facets.push(Facet::new(found.as_deref().unwrap_or(corners), cell.id));
                return Slot::Facets { first: facets, count: 1 };
            }
        };
        let solid = Solid::new(shape, nodes, cell.id);
        let solid = if mesh.is_section { solid } else { self.sides.place(&mesh.solids, solid) };
        mesh.solids.push(solid);
        Slot::Solids { first: solids, count: 1 }
    }
}

/// The ends of a line of three nodes, then its middle: some formats, and versions of programs, have that second, some last.
fn along(nodes: &[u32], points: &[[f64; 3]]) -> [u32; 3] {
    let off = |&[a, b, middle]: &[u32; 3]| {
        let [a, b, middle] = [a, b, middle].map(|node| Vec3::from(points[node as usize]));
        (0.5 * (a + b) - middle).norm()
    };
    let [a, b, c] = std::array::from_fn(|k| nodes[k]);
    [[a, b, c], [a, c, b], [b, c, a]].into_iter().min_by(|x, y| off(x).total_cmp(&off(y))).unwrap_or([a, b, c])
}

/// The power of ten beyond a number.
pub(super) fn above(number: u64) -> Option<u64> {
    10u64
        .checked_pow(number.checked_ilog10().map_or(1, |digits| digits + 1))
        .filter(|above| above.checked_mul(2).is_some())
}

impl From<Mesh> for FileMesh {
    /// A mesh that was generated.
    fn from(mut mesh: Mesh) -> Self {
        let closed = |(name, group)| (name, FileGroup { group, closed: true, unread: None });
        let groups = std::mem::take(&mut mesh.groups).into_iter().map(closed).collect();
        Self { attached: vec![true; mesh.points.len()], groups, mesh, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_found_dense_and_sparse() {
        for ids in [vec![5, 3, 9], vec![5, 3, 1 << 60], vec![u64::MAX, 0], vec![]] {
            let map = Ids::new(&ids, 10).unwrap();
            for (index, &id) in ids.iter().enumerate() {
                assert_eq!(map.get(id), Some(10 + index as u32));
            }
            assert_eq!(map.get(4), None);
            for (first, last, step) in [(3, 9, 2), (0, u64::MAX, 3), (4, 4, 1), (1, 1 << 61, 1 << 60)] {
                let mut found = Vec::new();
                map.range(first, last, step, &mut found);
                found.sort_unstable();
                let expected: Vec<u32> = (10..)
                    .zip(&ids)
                    .filter(|(_, id)| **id >= first && **id <= last && (**id - first).is_multiple_of(step))
                    .map(|(index, _)| index)
                    .collect();
                assert_eq!(found, expected);
            }
            assert_eq!(map.get(u64::MAX - 1), None);
        }
        assert_eq!(Ids::new(&[4, 5, 4], 0).err(), Some(vec![4]));
        assert_eq!(Ids::new(&[4, 1 << 50, 4], 0).err(), Some(vec![4]));
    }
}
