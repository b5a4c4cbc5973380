//! Edges that the user declares sharp, by groups of the mesh.

use super::super::facets::Facets;
use crate::error::{Error, Result};
use crate::mesh::{Group, Mesh};
use crate::scene::did_you_mean;
use std::collections::HashSet;

/// Edges by their nodes.
#[derive(Default)]
pub struct SharpEdges(HashSet<[u32; 2]>);

impl SharpEdges {
    /// The edges of the groups `names`: of a group with lines or facets its lines and the border of its facets, of a
    /// group of nodes alone the edges from one to another of them.
    ///
    /// Fails on unknown groups, and on groups without an edge of the surface.
    pub fn new(mesh: &Mesh, facets: &Facets, names: &[String]) -> Result<Self> {
        let mut sharp = HashSet::new();
        for name in names {
            let group = mesh.groups.get(name).ok_or_else(|| {
                let help = did_you_mean(name, mesh.groups.keys().map(String::as_str));
                Error::input_anywhere(format!("{}: there is no group `{name}` for sharp edges", mesh.source), help)
            })?;
            let found: Vec<[u32; 2]> = facets.corners().filter_map(|(f, k)| edge_of(group, facets, f, k)).collect();
            if found.is_empty() {
                let what = format!("{}: no edge of the surface is in the group `{name}`", mesh.source);
                let help =
                    "for sharp edges, name a group of curves, of nodes along them, or of facets that they enclose";
                return Err(Error::input_anywhere(what, help));
            }
            sharp.extend(found);
        }
        Ok(Self(sharp))
    }

    /// Whether the edge between two nodes is among them.
    pub fn holds(&self, a: u32, b: u32) -> bool {
        self.0.contains(&sorted(a, b))
    }
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The nodes of an edge (facet, number) that belongs to the group.
fn edge_of(group: &Group, facets: &Facets, f: usize, k: usize) -> Option<[u32; 2]> {
    let edge = sorted(facets.node(f, k) as u32, facets.node(f, k + 1) as u32);
    let has = |f: usize| group.facets.binary_search(&(f as u32)).is_ok();
    let belongs = if group.lines.is_empty() && group.facets.is_empty() {
        edge.iter().all(|node| group.nodes.binary_search(node).is_ok())
    } else {
        let is_border = || facets.across[f][k].is_some_and(|(g, _)| has(f) != has(g));
        group.lines.binary_search(&edge).is_ok() || is_border()
    };
    belongs.then_some(edge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::piece::Edge;
    use crate::surface::test_meshes::grid;
    use crate::surface::{NormalOptions, Patch, patches_from_mesh};

    /// A bent sheet of 4 by 4 quadrilaterals; the nodes of the line x = 2 are 2, 7, 12, 17, 22.
    fn sheet(name: &str, group: Group) -> Mesh {
        let mut mesh = grid(4, 4, false, |s, t| [4.0 * s, 4.0 * t, s * s]);
        mesh.groups.insert(name.into(), group);
        mesh
    }

    fn patches(mesh: &Mesh, flip: bool) -> crate::error::Result<Vec<Patch>> {
        let options = NormalOptions { sharp: vec!["rim".into()], ..NormalOptions::default() };
        patches_from_mesh(mesh, crate::scene::Smoothing::Nagata, &options, flip)
    }

    /// The middles of the sharp edges.
    fn sharp_edges(group: Group) -> Vec<[f64; 2]> {
        let mut middles = Vec::new();
        for patch in patches(&sheet("rim", group.clone()), false).unwrap() {
            for k in (0..4).filter(|k| patch.edges[*k] == Edge::Sharp) {
                let middle = (patch.nodes[k] + patch.nodes[(k + 1) % 4]) * 0.5;
                middles.push([middle.x, middle.y]);
            }
        }
        let turned = patches(&sheet("rim", group), true).unwrap();
        let count = turned.iter().flat_map(|patch| patch.edges).filter(|edge| *edge == Edge::Sharp).count();
        assert_eq!(count, middles.len());
        middles.sort_by(|a, b| a.partial_cmp(b).unwrap());
        middles.dedup();
        middles
    }

    #[test]
    fn groups_of_lines_nodes_and_facets_are_sharp() {
        let along = [[2.0, 0.5], [2.0, 1.5], [2.0, 2.5], [2.0, 3.5]];
        let lines = Group { nodes: vec![2, 7, 12], lines: vec![[2, 7], [7, 12]], ..Group::default() };
        assert_eq!(sharp_edges(lines), along[..2]);
        // The line from 2 to 12 is no edge; nodes of a group with lines make none sharp.
        let gap = Group { nodes: vec![2, 7, 12, 17, 22], lines: vec![[2, 12], [17, 22]], ..Group::default() };
        assert_eq!(sharp_edges(gap), along[3..]);
        assert_eq!(sharp_edges(Group { nodes: vec![2, 7, 12, 17, 22], ..Group::default() }), along);
        assert_eq!(sharp_edges(Group { nodes: vec![2, 7, 22], ..Group::default() }), along[..1]);
        let half = (0..16).filter(|f| f % 4 < 2).collect();
        assert_eq!(sharp_edges(Group { nodes: (0..25).collect(), facets: half, ..Group::default() }), along);
    }

    #[test]
    fn the_two_sides_have_their_own_normals() {
        let group = Group { nodes: vec![2, 7, 12, 17, 22], ..Group::default() };
        let options = NormalOptions { sharp: vec!["rim".into()], ..NormalOptions::default() };
        let mesh = sheet("rim", group);
        let facets = Facets::new(&mesh, false).unwrap();
        let (_, sharp) = super::super::Normals::of_mesh(&mesh, &facets, &options).unwrap();
        let apart = (sharp.corners[5][1] - sharp.corners[6][0]).norm();
        assert!(sharp.edges[5][1] == Edge::Sharp && apart > 1e-3, "{apart}");
    }

    #[test]
    fn wrong_groups_are_refused() {
        let text = |mesh: &Mesh| patches(mesh, false).err().map_or(String::new(), |error| error.to_string());
        let unknown = text(&sheet("rims", Group::default()));
        assert!(unknown.contains("test: there is no group `rim` for sharp edges"), "{unknown}");
        assert!(unknown.contains("did you mean `rims`? (known: rims)"), "{unknown}");
        for nodes in [vec![], vec![7], vec![2, 12]] {
            let empty = text(&sheet("rim", Group { nodes, ..Group::default() }));
            assert!(empty.contains("no edge of the surface is in the group `rim`"), "{empty}");
        }
    }
}
