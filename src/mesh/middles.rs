//! The nodes in the middle of edges, where elements are quadratic.
//!
//! Facets and lines name their corners alone: what is about the surface as such, its orientation, its neighbours and owners,
//! is the same for linear and quadratic elements.

use super::{Facet, Mesh, Solid, SolidShape, faces::TET_EDGES};
use std::collections::{HashMap, HashSet};

/// An edge by its ends in ascending order.
type Edge = [u32; 2];

fn edge(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

/// The node in the middle of each edge of facets and lines that has one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Middles(HashMap<Edge, u32>);

impl Middles {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The node between two others.
    pub fn at(&self, a: u32, b: u32) -> Option<u32> {
        self.0.get(&edge(a, b)).copied()
    }

    /// The nodes between 0 and 1, 1 and 2, 2 and 0 of a triangle that is quadratic.
    pub fn of(&self, corners: &[u32]) -> Option<[u32; 3]> {
        match corners {
            _ if self.is_empty() => None,
            &[a, b, c] => Some([self.at(a, b)?, self.at(b, c)?, self.at(c, a)?]),
            _ => None,
        }
    }

    /// Those on the edges of a facet.
    pub fn around<'a>(&'a self, corners: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        ends.filter(|_| !self.is_empty()).filter_map(|(&a, &b)| self.at(a, b))
    }

    pub fn add(&mut self, [a, b]: Edge, middle: u32) {
        self.0.entry(edge(a, b)).or_insert(middle);
    }

    /// Those of the edges of some facets and lines, in these solids.
    pub fn in_solids<'a>(
        solids: impl Iterator<Item = &'a Solid>,
        corners: impl Iterator<Item = &'a [u32]>,
        lines: impl Iterator<Item = Edge>,
    ) -> Self {
        let mut found = Self::default();
        let mut quadratic = solids.filter(|solid| solid.shape == SolidShape::Tet10).peekable();
        if quadratic.peek().is_none() {
            return found;
        }
        let ends = |corners: &'a [u32]| corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| edge(a, b));
        let wanted: HashSet<Edge> = corners.flat_map(ends).chain(lines).collect();
        for solid in quadratic {
            found.0.extend(solid.middles().filter(|(edge, _)| wanted.contains(edge)));
        }
        found
    }

    /// Those of all edges of these solids.
    pub fn in_all(solids: &[Solid]) -> Self {
        Self(solids.iter().flat_map(Solid::middles).collect())
    }

    /// The same with other numbers; an edge with a node that has none is left out.
    pub fn renumbered(&self, number: impl Fn(u32) -> Option<u32>) -> Self {
        let renumbered = |(&[a, b], &middle): (&Edge, &u32)| Some((edge(number(a)?, number(b)?), number(middle)?));
        Self(self.0.iter().filter_map(renumbered).collect())
    }

    /// Adds others.
    pub fn join(&mut self, more: Self) {
        self.0.extend(more.0);
    }
}

impl Solid {
    /// Its edges with the nodes in their middles, where it is quadratic.
    pub fn middles(&self) -> impl Iterator<Item = (Edge, u32)> + '_ {
        let quadratic = self.shape == SolidShape::Tet10;
        let edges = TET_EDGES.iter().zip(4..).filter(move |_| quadratic);
        edges.map(|([a, b], middle)| (edge(self.nodes[*a], self.nodes[*b]), self.nodes[middle]))
    }
}

/// The four linear triangles of a quadratic one: those at its corners, and the one between the middles.
pub fn four([a, b, c]: [u32; 3], [ab, bc, ca]: [u32; 3]) -> [[u32; 3]; 4] {
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// Makes four linear triangles of each quadratic one of a mesh of facets, and two of each quadratic line of its groups.
/// Also returns for each new facet the one that it is a part of.
pub fn split_facets(mesh: &mut Mesh) -> Vec<u32> {
    let (mut parts, mut origins, mut starts) = (Vec::new(), Vec::new(), vec![0]);
    for (facet, k) in mesh.facets.iter().zip(0..) {
        let [a, b, c, _] = facet.nodes;
        match mesh.middles.of(facet.nodes()) {
            Some(middles) => {
                parts.extend(four([a, b, c], middles).map(|[a, b, c]| Facet { nodes: [a, b, c, 0], ..*facet }));
            }
            None => parts.push(*facet),
        }
        origins.resize(parts.len(), k);
        starts.push(parts.len() as u32);
    }
    let middles = std::mem::take(&mut mesh.middles);
    for group in mesh.groups.values_mut() {
        group.facets = group.facets.iter().flat_map(|&k| starts[k as usize]..starts[k as usize + 1]).collect();
        let halves = |&[a, b]: &Edge| match middles.at(a, b) {
            Some(middle) => vec![edge(a, middle), edge(middle, b)],
            None => vec![[a, b]],
        };
        group.lines = group.lines.iter().flat_map(halves).collect();
        group.lines.sort_unstable();
    }
    mesh.facets = parts;
    origins
}
