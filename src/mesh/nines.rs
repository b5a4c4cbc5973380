//! The nine nodes of the faces of quadratic hexahedra.
//!
//! What is about the surface as such sees four quadrilaterals in each of these faces, which are its facets; loads and areas are those
//! of the whole face.

use super::faces::{FaceKey, HEX_EDGES, HEX_FACES};
use super::{Facet, Solid, SolidShape};
use std::collections::{HashMap, HashSet};

/// Local nodes around each quarter of a face of a quadratic hexahedron, four a face in Abaqus' order S1..S6: the corners of the face
/// beginning with that of the quarter, counter-clockwise seen from outside, the middles of the edges from each to the next, and that
/// of the face.
pub const QUARTERS: [[u8; 9]; 24] = {
    let (mut quarters, mut k) = ([[0; 9]; 24], 0);
    while k < 24 {
        let (face, mut at) = (HEX_FACES[k / 4], 0);
        while at < 4 {
            let (from, to) = (face[(k + at) % 4], face[(k + at + 1) % 4]);
            quarters[k][at] = from;
            let mut edge = 0;
            while edge < HEX_EDGES.len() {
                let [a, b] = [HEX_EDGES[edge][0] as u8, HEX_EDGES[edge][1] as u8];
                if (a == from && b == to) || (a == to && b == from) {
                    quarters[k][4 + at] = 8 + edge as u8;
                }
                edge += 1;
            }
            at += 1;
        }
        quarters[k][8] = 20 + (k / 4) as u8;
        k += 1;
    }
    quarters
};

/// The nodes of the faces that facets are quarters of, in the order of [`QUARTERS`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Nines(HashMap<FaceKey, [u32; 9]>);

impl Nines {
    /// Those of some quadrilaterals, in these solids.
    pub fn in_solids<'a>(solids: impl Iterator<Item = &'a Solid>, corners: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut found = HashMap::new();
        let mut quadratic = solids.filter(|solid| solid.shape == SolidShape::Hex27).peekable();
        if quadratic.peek().is_some() {
            let wanted: HashSet<FaceKey> = corners.map(|corners| Facet::new(corners, 0).key()).collect();
            for solid in quadratic {
                let faces = (0..).zip(&QUARTERS).map(|(k, quarter)| (solid.face(k).key(), quarter));
                let nodes = |quarter: &[u8; 9]| quarter.map(|local| solid.nodes[local as usize]);
                found.extend(faces.filter(|(key, _)| wanted.contains(key)).map(|(key, q)| (key, nodes(q))));
            }
        }
        Self(found)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The nodes of the face that a facet is a quarter of.
    pub fn of(&self, corners: &[u32]) -> Option<&[u32; 9]> {
        if self.0.is_empty() { None } else { self.0.get(&Facet::new(corners, 0).key()) }
    }
}
