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

#[cfg(test)]
mod tests {
    use super::super::{Purpose, load};
    use super::*;
    use crate::error::Location;
    use crate::scene::{Located, MeshSource};

    /// The ends of the edges with nodes in their middles, in the order of the manuals: Gmsh, "Node ordering", tetrahedron10; Abaqus,
    /// "Three-dimensional solid element library", C3D10.
    const GMSH: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
    const ABAQUS: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// The middle of a curved edge, each curved in a way of its own.
    fn bulged([i, j]: [usize; 2]) -> [f64; 3] {
        std::array::from_fn(|d| 0.5 * (CORNERS[i][d] + CORNERS[j][d]) + 0.01 * (1 + i * j + (i + j) * d) as f64)
    }

    /// Nodes 1 to 10, as lines.
    fn nodes(order: [[usize; 2]; 6], separator: &str) -> String {
        let places = CORNERS.into_iter().chain(order.map(bulged));
        let line = |(id, [x, y, z]): (usize, [f64; 3])| [id.to_string(), x.to_string(), y.to_string(), z.to_string()];
        places.enumerate().map(|(k, x)| line((k + 1, x)).join(separator) + "\n").collect()
    }

    /// The face 0-1-2 from below, and the edge 0-1.
    fn gmsh_2() -> String {
        let nodes = nodes(GMSH, " ");
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"edge\"\n2 2 \"base\"\n3 3 \"all\"\n$EndPhysicalNames\n\
             $Nodes\n10\n{nodes}$EndNodes\n$Elements\n3\n1 8 2 1 1 1 2 5\n2 9 2 2 1 1 3 2 7 6 5\n\
             3 11 2 3 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n"
        )
    }

    fn gmsh_4() -> String {
        let (mut ids, mut places) = (String::new(), String::new());
        for line in nodes(GMSH, " ").lines() {
            let (id, place) = line.split_once(' ').unwrap();
            ids += &format!("{id}\n");
            places += &format!("{place}\n");
        }
        let entity = |k: u8| format!("1 0 0 0 1 1 1 1 {k} 0\n");
        format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"edge\"\n2 2 \"base\"\n3 3 \"all\"\n$EndPhysicalNames\n\
             $Entities\n0 1 1 1\n{}{}{}$EndEntities\n$Nodes\n1 10 1 10\n3 1 0 10\n{ids}{places}$EndNodes\n\
             $Elements\n3 3 1 3\n1 1 8 1\n1 1 2 5\n2 1 9 1\n2 1 2 3 5 6 7\n3 1 11 1\n3 1 2 3 4 5 6 7 8 9 10\n$EndElements\n",
            entity(1),
            // Turned over by its group.
            entity(2).replace(" 2 0", " -2 0"),
            entity(3)
        )
    }

    fn deck(kind: &str) -> String {
        let nodes = nodes(ABAQUS, ", ");
        format!(
            "*NODE\n{nodes}*ELEMENT, TYPE={kind}, ELSET=all\n3, 1, 2, 3, 4, 5, 6, 7,\n8, 9, 10\n*SURFACE, NAME=base\n3, S1\n\
             *ELEMENT, TYPE=T3D3, ELSET=edge\n1, 1, 2, 5\n*SURFACE, NAME=side\nall, S3\n"
        )
    }

    fn read(name: &str, text: &str, group: Option<&str>, purpose: Purpose) -> Mesh {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let at = Location { file: "scene.toml".into(), line: 7, column: 1, text: "".into() };
        let group = group.map(|group| Located { value: group.to_string(), at: at.clone() });
        load(&MeshSource::File { path: Located { value: path, at }, group }, purpose).unwrap()
    }

    #[test]
    fn curved_edges_have_their_own_nodes_in_every_format() {
        let files = [("2.msh", gmsh_2()), ("4.msh", gmsh_4()), ("a.inp", deck("C3D10")), ("m.inp", deck("C3D10M"))];
        for (name, text) in files {
            let mesh = read(name, &text, None, Purpose::Body);
            let place = |n: u32| mesh.points[n as usize];
            let [solid] = mesh.solids[..] else { panic!("{name}: {:?}", mesh.solids) };
            assert_eq!(solid.shape, SolidShape::Tet10);
            assert_eq!([0, 1, 2, 3].map(|k| place(solid.nodes[k])), CORNERS, "{name}");
            for (k, ends) in TET_EDGES.into_iter().enumerate() {
                assert_eq!(place(solid.nodes[4 + k]), bulged(ends), "{name}: {ends:?}");
            }
            let base = &mesh.groups["base"];
            let corners = mesh.facets[base.facets[0] as usize].nodes();
            assert_eq!(corners.iter().map(|n| place(*n)).collect::<Vec<_>>(), [CORNERS[0], CORNERS[2], CORNERS[1]]);
            let middles = mesh.middles.of(corners).unwrap().map(place);
            assert_eq!(middles, [bulged([0, 2]), bulged([1, 2]), bulged([0, 1])], "{name}");
            assert_eq!((base.nodes.len(), mesh.groups["all"].nodes.len()), (6, 10), "{name}");
            assert_eq!(mesh.groups["edge"].nodes.iter().map(|n| place(*n)).collect::<Vec<_>>().len(), 3, "{name}");
        }
    }

    /// As a tool the same face is four triangles, which look as the quadratic one does.
    #[test]
    fn tools_take_quadratic_faces_as_four() {
        for (name, text) in [("2.msh", gmsh_2()), ("4.msh", gmsh_4()), ("a.inp", deck("C3D10"))] {
            let tool = read(name, &text, Some("base"), Purpose::Tool);
            assert_eq!((tool.points.len(), tool.facets.len(), tool.groups["base"].facets.len()), (6, 4, 4), "{name}");
            let down = |facet: &Facet| {
                let [a, b, c, _] = facet.nodes.map(|n| crate::Vec3::from(tool.points[n as usize]));
                (b - a).cross(&(c - a)).z < 0.0
            };
            assert!(tool.middles.is_empty() && tool.facets.iter().all(down), "{name}");
            if name != "a.inp" {
                assert_eq!(tool.groups["edge"].lines.len(), 2, "{name}");
            }
        }
    }
}
