//! Groups of the parts.

use super::split::{Key, NONE, key};
use crate::mesh::{Group, Mesh, Middles};
use std::collections::{HashMap, HashSet};

/// What came of nodes, elements and facets.
pub(super) struct Heirs<'a> {
    pub known: &'a HashMap<Key, u32>,
    /// For each new node, from `old` on, those of the edge, face or element that it lies in.
    pub origins: &'a [[u32; 8]],
    pub old: usize,
    /// Of all edges of the parts.
    pub middles: &'a Middles,
    /// Parts of an edge.
    pub cells: u32,
    /// Where the parts of each element and of each facet begin.
    pub of_solid: Vec<u32>,
    pub of_facet: Vec<u32>,
}

impl Heirs<'_> {
    /// The parts of a group, with their nodes in `mesh`, which is split.
    pub fn group(&self, group: Group, mesh: &Mesh) -> Group {
        let parts = |starts: &[u32], of: &[u32]| -> Vec<u32> {
            of.iter().flat_map(|&k| starts[k as usize]..starts[k as usize + 1]).collect()
        };
        let solids = parts(&self.of_solid, &group.solids);
        let facets = parts(&self.of_facet, &group.facets);
        let mut lines: Vec<[u32; 2]> = group.lines.iter().flat_map(|line| self.line(*line)).collect();
        lines.sort_unstable();
        let of_solids = solids.iter().flat_map(|&k| mesh.solids[k as usize].nodes());
        let of_facets = facets.iter().flat_map(|&k| mesh.facets[k as usize].nodes());
        let between = facets.iter().flat_map(|&k| self.middles.around(mesh.facets[k as usize].nodes()));
        let between = between.chain(lines.iter().filter_map(|&[a, b]| self.middles.at(a, b)));
        let corners = of_solids.chain(of_facets).chain(lines.iter().flatten());
        let held: HashSet<u32> = corners.copied().chain(between).collect();
        let mut nodes: Vec<u32> = held.iter().copied().collect();
        nodes.extend(self.bare(&group.nodes, &held));
        nodes.extend(group.nodes);
        nodes.sort_unstable();
        nodes.dedup();
        Group { nodes, lines, facets, solids }
    }

    /// The new nodes between those of a group, of which some are not of its elements, which are `held`.
    fn bare(&self, group: &[u32], held: &HashSet<u32>) -> Vec<u32> {
        if group.iter().all(|node| held.contains(node)) {
            return Vec::new();
        }
        let within = |origin: &&[u32; 8]| {
            let mut nodes = origin.iter().filter(|node| **node != NONE);
            nodes.clone().all(|node| group.binary_search(node).is_ok()) && nodes.any(|node| !held.contains(node))
        };
        (self.old as u32..).zip(self.origins).filter(|(_, origin)| within(origin)).map(|(node, _)| node).collect()
    }

    /// The parts of a line; one that is no edge of the mesh, or whose edge is whole, stays.
    fn line(&self, [a, b]: [u32; 2]) -> Vec<[u32; 2]> {
        let node = |k: u32| key(&[(a, self.cells - k), (b, k)]).and_then(|key| self.known.get(&key).copied());
        let between: Option<Vec<u32>> = (1..self.cells).map(node).collect();
        let Some(between) = between else { return vec![[a, b]] };
        let chain: Vec<u32> = [vec![a], between, vec![b]].concat();
        chain.windows(2).map(|ends| [ends[0].min(ends[1]), ends[0].max(ends[1])]).collect()
    }
}
