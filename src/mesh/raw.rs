//! A mesh as its file describes it: all of it, and before anything is selected, oriented or checked.

use super::{Facet, Group, MOST_NODES, Mesh, Solid, SolidShape};
use super::{join, message};
use crate::error::{Error, Result};
use std::collections::BTreeMap;

/// Shapes that files hold; points and lines matter to groups alone. Those of second order have the nodes in the middles of their
/// edges behind the corners, as [`SolidShape::Tet10`] has them; on a triangle between 0 and 1, 1 and 2, 2 and 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum CellShape {
    Point,
    Line,
    Triangle,
    Quad,
    Tet,
    Hex,
    Wedge,
    Line3,
    Triangle6,
    Tet10,
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
            Self::Line3 => 3,
            Self::Triangle6 => 6,
            Self::Tet10 => 10,
        }
    }
}

/// An element by the numbers of its file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub shape: CellShape,
    pub id: u64,
    /// The first `shape.node_count()` count.
    pub nodes: [u64; MOST_NODES],
}

/// Where a cell went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    Solid(u32),
    Facet(u32),
    /// A point or a line with its ends (the same twice for a point).
    Loose([u32; 2]),
}

impl Group {
    /// Adds what became of an element.
    pub(super) fn add(&mut self, slot: Slot) {
        match slot {
            Slot::Solid(solid) => self.solids.push(solid),
            Slot::Facet(facet) => self.facets.push(facet),
            Slot::Loose([a, b]) => {
                self.nodes.extend([a, b]);
                if a != b {
                    self.lines.push([a.min(b), a.max(b)]);
                }
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
    pub fn append(&mut self, ids: Vec<u64>, points: Vec<[f64; 3]>, cells: &[Cell]) -> Result<(Ids, Vec<Slot>)> {
        let base = self.mesh.points.len();
        if base + points.len().max(cells.len() * 6) >= u32::MAX as usize {
            return Err(message::whole_file(&self.mesh.source, "the mesh is too large for 32-bit numbers", ""));
        }
        let nodes = Ids::new(&ids, base as u32).map_err(|twice| {
            let what = format!("{} defined twice", message::several("node", &twice));
            message::whole_file(&self.mesh.source, what, "give each node a number of its own")
        })?;
        join(&mut self.mesh.points, points);
        join(&mut self.mesh.point_ids, ids);
        self.attached.resize(self.mesh.points.len(), false);

        let mut missing = Vec::new();
        let mut slots = Vec::with_capacity(cells.len());
        for cell in cells {
            let mut found = [0; MOST_NODES];
            for (index, &id) in found.iter_mut().zip(&cell.nodes[..cell.shape.node_count()]) {
                match nodes.get(id) {
                    Some(node) => *index = node,
                    None => missing.push((cell.id, id)),
                }
            }
            if missing.is_empty() {
                slots.push(self.place(cell, found));
            }
        }
        match missing.first() {
            None => Ok((nodes, slots)),
            Some((element, node)) => {
                let what = format!("element {element} names node {node}, which does not exist");
                let what = what + &message::and_more(missing.len() - 1);
                Err(message::whole_file(&self.mesh.source, what, "write the mesh with all its nodes"))
            }
        }
    }

    /// The nodes of a facet, those in the middles of its edges, too.
    pub fn nodes_of(&self, facet: u32) -> impl Iterator<Item = u32> + '_ {
        let nodes = self.mesh.facets[facet as usize].nodes();
        nodes.iter().copied().chain(self.mesh.middles.around(nodes))
    }

    fn place(&mut self, cell: &Cell, nodes: [u32; MOST_NODES]) -> Slot {
        let count = cell.shape.node_count();
        nodes[..count].iter().for_each(|&node| self.attached[node as usize] = true);
        match cell.shape {
            CellShape::Point => Slot::Loose([nodes[0]; 2]),
            CellShape::Line => Slot::Loose([nodes[0], nodes[1]]),
            CellShape::Line3 => {
                self.mesh.middles.add([nodes[0], nodes[1]], nodes[2]);
                Slot::Loose([nodes[0], nodes[1]])
            }
            CellShape::Triangle | CellShape::Quad | CellShape::Triangle6 => {
                let [a, b, c, mut d, e, f, ..] = nodes;
                let quadratic = cell.shape == CellShape::Triangle6;
                if quadratic {
                    for (ends, middle) in [([a, b], d), ([b, c], e), ([c, a], f)] {
                        self.mesh.middles.add(ends, middle);
                    }
                    d = 0;
                }
                let count = if quadratic { 3 } else { count as u8 };
                self.mesh.facets.push(Facet { count, nodes: [a, b, c, d], id: cell.id });
                Slot::Facet(self.mesh.facets.len() as u32 - 1)
            }
            CellShape::Tet | CellShape::Hex | CellShape::Wedge | CellShape::Tet10 => {
                let shape = match cell.shape {
                    CellShape::Tet => SolidShape::Tet4,
                    CellShape::Tet10 => SolidShape::Tet10,
                    CellShape::Wedge => SolidShape::Wedge6,
                    _ => SolidShape::Hex8,
                };
                self.mesh.solids.push(Solid { shape, nodes, id: cell.id });
                Slot::Solid(self.mesh.solids.len() as u32 - 1)
            }
        }
    }
}

impl From<Mesh> for FileMesh {
    /// A mesh that was generated.
    fn from(mut mesh: Mesh) -> Self {
        let closed = |(name, group)| (name, FileGroup { group, closed: true, unread: None });
        let groups = std::mem::take(&mut mesh.groups).into_iter().map(closed).collect();
        Self { attached: vec![true; mesh.points.len()], groups, mesh, unread: None, is_closed: false }
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
