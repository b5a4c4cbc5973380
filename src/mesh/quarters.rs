//! The nodes of the faces of quadratic hexahedra and wedges: nine, or six at the ends of wedges.
//!
//! What is about the surface as such sees four facets in each of these faces, its quarters; loads and areas are those of the whole
//! face.

use super::faces::{FaceKey, HEX_EDGES, HEX_FACES, WEDGE_EDGES, WEDGE_ENDS, WEDGE_SIDES};
use super::{Facet, Solid, SolidShape};
use std::collections::{HashMap, HashSet};

/// A quarter of a face, by local nodes of the element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quarter {
    corners: [u8; 4],
    whole: [u8; 9],
    is_triangle: bool,
}

/// Those of a hexahedron, four a face in Abaqus' order S1..S6.
pub(super) static OF_HEXAHEDRON: [Quarter; 24] = {
    let (mut quarters, mut k) = ([NONE; 24], 0);
    while k < 24 {
        quarters[k] = of_quadrilateral(HEX_FACES[k / 4], k % 4, &HEX_EDGES, 8, 20 + k / 4);
        k += 1;
    }
    quarters
};

/// Those of a wedge, four a face in Abaqus' order S1..S5.
pub(super) static OF_WEDGE: [Quarter; 20] = {
    let (mut quarters, mut k) = ([NONE; 20], 0);
    while k < 20 {
        quarters[k] = match (k / 4).checked_sub(WEDGE_ENDS.len()) {
            None => of_triangle(WEDGE_ENDS[k / 4], k % 4),
            Some(side) => of_quadrilateral(WEDGE_SIDES[side], k % 4, &WEDGE_EDGES, 6, 15 + side),
        };
        k += 1;
    }
    quarters
};

const NONE: Quarter = Quarter { corners: [0; 4], whole: [0; 9], is_triangle: false };

/// The quarter at corner `first` of a face: the nodes of the whole are its corners from there, counter-clockwise seen from outside, the
/// middles of the edges from each to the next, and its own.
const fn of_quadrilateral(
    face: [u8; 4],
    first: usize,
    edges: &[[usize; 2]],
    on_edges: usize,
    middle: usize,
) -> Quarter {
    let (mut whole, mut at) = ([middle as u8; 9], 0);
    while at < 4 {
        whole[at] = face[(first + at) % 4];
        whole[4 + at] = between(edges, whole[at], face[(first + at + 1) % 4], on_edges);
        at += 1;
    }
    Quarter { corners: [whole[0], whole[4], whole[8], whole[7]], whole, is_triangle: false }
}

/// The quarter at corner `first` of the end of a wedge, the fourth that between the middles; the nodes of the whole are its corners from
/// there and the middles of the edges from each to the next.
const fn of_triangle(face: [u8; 3], first: usize) -> Quarter {
    let (mut whole, mut at) = ([0; 9], 0);
    while at < 3 {
        whole[at] = face[(first + at) % 3];
        whole[3 + at] = between(&WEDGE_EDGES, whole[at], face[(first + at + 1) % 3], 6);
        at += 1;
    }
    let corners = if first < 3 { [whole[0], whole[3], whole[5], 0] } else { [whole[3], whole[4], whole[5], 0] };
    Quarter { corners, whole, is_triangle: true }
}

/// The node between two corners, where those of the edges begin at `first`.
const fn between(edges: &[[usize; 2]], a: u8, b: u8, first: usize) -> u8 {
    let mut edge = 0;
    while edge < edges.len() {
        let [from, to] = [edges[edge][0] as u8, edges[edge][1] as u8];
        if (from == a && to == b) || (from == b && to == a) {
            return (first + edge) as u8;
        }
        edge += 1;
    }
    panic!("no edge of the element")
}

impl Quarter {
    /// Local nodes of its corners, three or four.
    pub fn corners(&self) -> &[u8] {
        &self.corners[..if self.is_triangle { 3 } else { 4 }]
    }
}

/// The quarters that the faces of elements of a shape have, in their order.
fn of_shape(shape: SolidShape) -> &'static [Quarter] {
    match shape {
        SolidShape::Hex27 => &OF_HEXAHEDRON,
        SolidShape::Wedge18 => &OF_WEDGE,
        _ => &[],
    }
}

/// The nodes of the faces that facets are quarters of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Quarters(HashMap<FaceKey, [u32; 9]>);

impl Quarters {
    /// Those of some facets, in these solids.
    pub fn in_solids<'a>(solids: impl Iterator<Item = &'a Solid>, corners: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut found = HashMap::new();
        let mut quadratic = solids.filter(|solid| !of_shape(solid.shape).is_empty()).peekable();
        if quadratic.peek().is_some() {
            let wanted: HashSet<FaceKey> = corners.map(|corners| Facet::new(corners, 0).key()).collect();
            for solid in quadratic {
                let faces = (0..).zip(of_shape(solid.shape)).map(|(k, quarter)| (solid.face(k).key(), quarter));
                let nodes = |quarter: &Quarter| quarter.whole.map(|local| solid.nodes[local as usize]);
                found.extend(faces.filter(|(key, _)| wanted.contains(key)).map(|(key, q)| (key, nodes(q))));
            }
        }
        Self(found)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The nodes of the face that a facet is a quarter of: the corners of the face counter-clockwise seen from outside, beginning with
    /// that of the quarter, the middles of the edges from each to the next, and, of nine, that of the face. The quarter between the
    /// middles of six begins with any.
    pub fn of(&self, corners: &[u32]) -> Option<&[u32]> {
        let whole = if self.0.is_empty() { None } else { self.0.get(&Facet::new(corners, 0).key()) };
        whole.map(|nodes| &nodes[..if corners.len() == 3 { 6 } else { 9 }])
    }
}
