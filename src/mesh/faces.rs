//! Faces of volume elements: local tables, the boundary of a set of solids, and which solid a facet belongs to.

use super::quarters::{OF_HEXAHEDRON, OF_WEDGE};
use super::{Facet, Solid, SolidShape};
use std::collections::HashMap;

/// Local nodes of the faces of a tetrahedron, counter-clockwise seen from outside, in Abaqus' order S1..S4.
pub const TET_FACES: [[u8; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Local nodes of the faces of a hexahedron, counter-clockwise seen from outside, in Abaqus' order S1..S6.
pub const HEX_FACES: [[u8; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Local nodes of the faces of a wedge, counter-clockwise seen from outside, in Abaqus' order: S1 and S2 ...
pub const WEDGE_ENDS: [[u8; 3]; 2] = [[0, 2, 1], [3, 4, 5]];
/// ... and S3 to S5.
pub const WEDGE_SIDES: [[u8; 4]; 3] = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]];

/// Local nodes of the faces of a pyramid, counter-clockwise seen from outside, in Abaqus' order: S1 ...
pub const PYRAMID_BASE: [u8; 4] = [0, 3, 2, 1];
/// ... and S2 to S5.
pub const PYRAMID_SIDES: [[u8; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

/// Local ends of the edges of a tetrahedron, in the order in which a quadratic one has the nodes in their middles.
pub const TET_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// The same of a hexahedron, in the order of Abaqus: those of the bottom, of the top, and between them.
pub const HEX_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The same of a wedge.
pub const WEDGE_EDGES: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];

/// The same of a pyramid, which has none in their middles.
pub const PYRAMID_EDGES: [[usize; 2]; 8] = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]];

/// The corners that each node of a hexahedron of 27 stands half way between: itself, the ends of an edge, or across a face or all.
pub const HEX_BETWEEN: [[usize; 2]; 27] = between(8, &HEX_EDGES, &HEX_FACES);

/// The same of a wedge of 18.
pub const WEDGE_BETWEEN: [[usize; 2]; 18] = between(6, &WEDGE_EDGES, &WEDGE_SIDES);

/// Those of an element with so many corners, then nodes on edges and quadrilaterals, and of a hexahedron one in the middle.
const fn between<const N: usize>(corners: usize, edges: &[[usize; 2]], faces: &[[u8; 4]]) -> [[usize; 2]; N] {
    let (mut between, mut a) = ([[0, 6]; N], 0);
    while a < corners + edges.len() + faces.len() {
        between[a] = if a < corners {
            [a, a]
        } else if a < corners + edges.len() {
            edges[a - corners]
        } else {
            let face = faces[a - corners - edges.len()];
            [face[0] as usize, face[2] as usize]
        };
        a += 1;
    }
    between
}

/// The corners of a face, sorted; a triangle ends with `u32::MAX`. Equal for the two sides of a face.
pub type FaceKey = [u32; 4];

/// What a facet is a face of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Of no solid.
    None,
    /// Of one solid, so it lies on the boundary.
    One { solid: u32, face: u8 },
    /// Of several solids, so it lies inside.
    Shared,
}

impl SolidShape {
    /// The number of faces; of quadratic hexahedra and wedges their quarters count.
    pub fn face_count(self) -> usize {
        match self {
            Self::Tet4 | Self::Tet10 => TET_FACES.len(),
            Self::Hex8 => HEX_FACES.len(),
            Self::Wedge6 => WEDGE_ENDS.len() + WEDGE_SIDES.len(),
            Self::Pyramid5 => 1 + PYRAMID_SIDES.len(),
            Self::Wedge18 => OF_WEDGE.len(),
            Self::Hex27 => OF_HEXAHEDRON.len(),
        }
    }
}

impl Solid {
    /// The corners of face `face` (from 0), outward, with the number of the solid.
    pub fn face(&self, face: usize) -> Facet {
        let mut nodes = [0; 4];
        let count = match self.shape {
            SolidShape::Tet4 | SolidShape::Tet10 => gather(&self.nodes, &TET_FACES[face], &mut nodes),
            SolidShape::Hex8 => gather(&self.nodes, &HEX_FACES[face], &mut nodes),
            SolidShape::Wedge6 => match face.checked_sub(WEDGE_ENDS.len()) {
                Some(side) => gather(&self.nodes, &WEDGE_SIDES[side], &mut nodes),
                None => gather(&self.nodes, &WEDGE_ENDS[face], &mut nodes),
            },
            SolidShape::Pyramid5 => match face.checked_sub(1) {
                Some(side) => gather(&self.nodes, &PYRAMID_SIDES[side], &mut nodes),
                None => gather(&self.nodes, &PYRAMID_BASE, &mut nodes),
            },
            SolidShape::Wedge18 => gather(&self.nodes, OF_WEDGE[face].corners(), &mut nodes),
            SolidShape::Hex27 => gather(&self.nodes, OF_HEXAHEDRON[face].corners(), &mut nodes),
        };
        Facet { count, nodes, id: self.id }
    }
}

fn gather(from: &[u32], local: &[u8], to: &mut [u32; 4]) -> u8 {
    for (node, &at) in to.iter_mut().zip(local) {
        *node = from[at as usize];
    }
    local.len() as u8
}

impl Facet {
    /// Its nodes without their order.
    pub fn key(&self) -> FaceKey {
        let mut key = self.nodes;
        if self.count == 3 {
            key[3] = u32::MAX;
        }
        key.sort_unstable();
        key
    }

    /// The same facet seen from the other side; its first node stays first.
    pub fn reversed(mut self) -> Self {
        self.nodes[1..self.count as usize].reverse();
        self
    }
}

/// The faces that belong to one solid only, as (solid, local face), sorted.
pub fn boundary(solids: &[Solid]) -> Vec<(u32, u8)> {
    let mut faces: Vec<(FaceKey, u32, u8)> = Vec::with_capacity(6 * solids.len());
    for (index, solid) in solids.iter().enumerate() {
        faces.extend((0..solid.shape.face_count()).map(|face| (solid.face(face).key(), index as u32, face as u8)));
    }
    faces.sort_unstable();
    let mut free: Vec<_> =
        faces.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| (same[0].1, same[0].2)).collect();
    free.sort_unstable();
    free
}

/// For each facet the solid and the local face that it is.
pub fn owners(solids: &[Solid], facets: &[Facet]) -> Vec<Owner> {
    let mut owner_of: HashMap<FaceKey, Owner> = facets.iter().map(|facet| (facet.key(), Owner::None)).collect();
    // Most faces of a mesh are inside: marked nodes rule them out before they are hashed.
    let size = facets.iter().flat_map(Facet::nodes).max().map_or(0, |&last| last as usize + 1);
    let mut marked = vec![false; size];
    facets.iter().flat_map(Facet::nodes).for_each(|&node| marked[node as usize] = true);
    let is_marked = |node: &u32| marked.get(*node as usize) == Some(&true);

    for (index, solid) in solids.iter().enumerate() {
        if solid.nodes().iter().filter(|node| is_marked(node)).count() < 3 {
            continue;
        }
        for face in 0..solid.shape.face_count() {
            if let Some(owner) = owner_of.get_mut(&solid.face(face).key()) {
                *owner = match owner {
                    Owner::None => Owner::One { solid: index as u32, face: face as u8 },
                    _ => Owner::Shared,
                };
            }
        }
    }
    facets.iter().map(|facet| owner_of[&facet.key()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    fn hex(nodes: [u32; 8]) -> Solid {
        Solid::new(SolidShape::Hex8, &nodes, 1)
    }

    #[test]
    fn faces_point_outward() {
        let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let hex_points: Vec<Vec3> = corners.iter().map(|c| Vec3::from(c.map(f64::from))).collect();
        let tet_points = vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let tet = Solid::new(SolidShape::Tet4, &[0, 1, 2, 3], 1);
        let wedge = Solid::new(SolidShape::Wedge6, &[0, 1, 2, 3, 4, 5], 1);
        let pyramid = Solid::new(SolidShape::Pyramid5, &[0, 1, 2, 3, 4], 1);
        let pyramid_points = hex_points[..5].to_vec();
        let wedge_points = [0, 1, 3, 4, 5, 7].map(|k| hex_points[k]).to_vec();
        let all = [
            (tet, tet_points),
            (wedge, wedge_points),
            (pyramid, pyramid_points),
            (hex([0, 1, 2, 3, 4, 5, 6, 7]), hex_points),
        ];
        for (solid, points) in all {
            let middle = points.iter().sum::<Vec3>() / points.len() as f64;
            for face in 0..solid.shape.face_count() {
                let [a, b, c] = [0, 1, 2].map(|i| points[solid.face(face).nodes[i] as usize]);
                assert!((b - a).cross(&(c - a)).dot(&(a - middle)) > 0.0, "face {face}");
            }
        }
    }

    #[test]
    fn two_hexahedra_have_ten_free_faces() {
        let solids = [hex([0, 1, 2, 3, 4, 5, 6, 7]), hex([1, 8, 9, 2, 5, 10, 11, 6])];
        let free = boundary(&solids);
        assert_eq!(free.len(), 10);
        assert!(!free.contains(&(0, 3)) && !free.contains(&(1, 5)));

        let stranger = Facet { count: 3, nodes: [0, 1, 2, 0], id: 1 };
        let facets = [solids[0].face(3).reversed(), solids[1].face(0), stranger];
        assert_eq!(owners(&solids, &facets), [Owner::Shared, Owner::One { solid: 1, face: 0 }, Owner::None]);
        assert_eq!(owners(&solids, &[]), []);
    }

    #[test]
    fn reversing_keeps_the_first_node() {
        let quad = Facet { count: 4, nodes: [7, 8, 9, 10], id: 1 };
        assert_eq!(quad.reversed().nodes, [7, 10, 9, 8]);
        let triangle = Facet { count: 3, nodes: [7, 8, 9, 0], id: 1 };
        assert_eq!(triangle.reversed().nodes, [7, 9, 8, 0]);
        assert_eq!(triangle.key(), [7, 8, 9, u32::MAX]);
    }
}
