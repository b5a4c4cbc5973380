//! Elements with nodes that occur twice as what they are: hexahedra as wedges, pyramids or tetrahedra, wedges as the latter two.

use super::check::repeats;
use super::{Solid, SolidShape, at_side};
use smallvec::SmallVec;
use std::collections::HashMap;

/// No side.
const NONE: u8 = u8::MAX;

/// The sides of solids as files number them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sides {
    /// Of solids that are not of the shape that their file gives them, for each side there the face that it is.
    collapsed: HashMap<u32, Vec<u8>>,
}

impl Sides {
    /// Takes note of the next of some solids with nodes that occur twice, and gives it as what it is; any other as it is.
    pub(super) fn place(&mut self, solids: &[Solid], solid: Solid) -> Solid {
        match collapse(&solid) {
            Some((found, faces)) => {
                self.collapsed.insert(solids.len() as u32, faces);
                found
            }
            None => solid,
        }
    }

    /// The faces that a side is of an element which has become so many solids: none where it has shrunk to a line or a point.
    /// `None` where there is no such side.
    pub fn faces(&self, solids: &[Solid], (first, count): (u32, u32), side: u8) -> Option<Vec<(u32, u8)>> {
        if let Some(faces) = self.collapsed.get(&first) {
            let face = *faces.get(side as usize)?;
            return Some(if face == NONE { Vec::new() } else { vec![(first, face)] });
        }
        let shape = solids[first as usize].shape;
        let parts = || at_side(shape, count, side).into_iter().map(|part| (first + part, side)).collect();
        ((side as usize) < shape.face_count()).then(parts)
    }

    /// How many sides its file gives a solid.
    pub fn count(&self, solids: &[Solid], solid: u32) -> usize {
        let own = || solids[solid as usize].shape.face_count();
        self.collapsed.get(&solid).map_or_else(own, Vec::len)
    }

    /// The side that a face of a solid is in its file.
    pub fn side(&self, solid: u32, face: u8) -> u8 {
        let found = self.collapsed.get(&solid).and_then(|faces| faces.iter().position(|own| *own == face));
        found.map_or(face, |side| side as u8)
    }
}

/// The nodes of a face in their order, each once; `None` where others stand between two of the same.
pub(super) fn once(nodes: &[u32]) -> Option<SmallVec<[u32; 4]>> {
    let mut all = SmallVec::from_slice(nodes);
    all.dedup();
    while all.len() > 1 && all.first() == all.last() {
        all.pop();
    }
    (!repeats(&all)).then_some(all)
}

/// An element with nodes that occur twice as the wedge, pyramid or tetrahedron that it is, and for each of its faces that of the
/// found one. `None` where none occurs twice, or where it is none of these.
fn collapse(solid: &Solid) -> Option<(Solid, Vec<u8>)> {
    // Most do not.
    if !repeats(solid.nodes()) || solid.shape == SolidShape::Tet10 {
        return None;
    }
    let mut distinct = solid.nodes().to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    let faces: Vec<SmallVec<[u32; 4]>> =
        (0..solid.shape.face_count()).map(|k| once(solid.face(k).nodes())).collect::<Option<_>>()?;
    let with = |corners: usize| faces.iter().filter(move |face| face.len() == corners);
    let other = |face: &[u32]| distinct.iter().copied().find(|node| !face.contains(node));
    let found = match (distinct.len(), with(3).count(), with(4).count()) {
        (6, 2, 3) => {
            let [a, b, c] = *with(3).next()?.as_array()?;
            let above = |node: u32| {
                let beside = |face: &SmallVec<[u32; 4]>| {
                    let at = face.iter().position(|own| *own == node)?;
                    [face[(at + 1) % 4], face[(at + 3) % 4]].into_iter().find(|next| ![a, b, c].contains(next))
                };
                with(4).find_map(beside)
            };
            Solid::new(SolidShape::Wedge6, &[a, c, b, above(a)?, above(c)?, above(b)?], solid.id)
        }
        (5, 4, 1) => {
            let base = with(4).next()?;
            let [a, b, c, d] = *base.as_array()?;
            Solid::new(SolidShape::Pyramid5, &[a, d, c, b, other(base)?], solid.id)
        }
        (4, 4, 0) => {
            let base = with(3).next()?;
            let [a, b, c] = *base.as_array()?;
            Solid::new(SolidShape::Tet4, &[a, c, b, other(base)?], solid.id)
        }
        _ => return None,
    };
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let own: Vec<Vec<u32>> = (0..found.shape.face_count()).map(|k| sorted(found.face(k).nodes())).collect();
    let face_of = |nodes: &SmallVec<[u32; 4]>| match nodes.len() {
        0..3 => Some(NONE),
        _ => own.iter().position(|face| *face == sorted(nodes)).map(|face| face as u8),
    };
    let map: Vec<u8> = faces.iter().map(face_of).collect::<Option<_>>()?;
    // Every face is one side, and no more.
    (0..own.len()).all(|k| map.iter().filter(|&&face| face as usize == k).count() == 1).then_some((found, map))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::solid::element::{pyramid5, tet4, wedge6};
    use crate::solid::testing::CUBE;

    fn volume(solid: &Solid) -> f64 {
        let at = |k: usize| CUBE[solid.nodes[k] as usize];
        match solid.shape {
            SolidShape::Wedge6 => wedge6::volume(&std::array::from_fn(at)),
            SolidShape::Pyramid5 => pyramid5::volume(&std::array::from_fn(at)),
            _ => tet4::volume(&std::array::from_fn(at)),
        }
    }

    /// Each edge, pair of edges and face of a hexahedron and a wedge that can be one node: what is left has the volume between the
    /// faces, which look outward, and each keeps its number.
    #[test]
    fn what_collapses_is_what_it_is() {
        let cases: [(SolidShape, &[u32], SolidShape); 11] = [
            (SolidShape::Hex8, &[0, 1, 2, 2, 4, 5, 6, 6], SolidShape::Wedge6),
            (SolidShape::Hex8, &[0, 1, 1, 3, 4, 5, 5, 7], SolidShape::Wedge6),
            (SolidShape::Hex8, &[0, 1, 2, 3, 4, 5, 5, 4], SolidShape::Wedge6),
            (SolidShape::Hex8, &[0, 1, 2, 3, 0, 1, 6, 7], SolidShape::Wedge6),
            (SolidShape::Hex8, &[0, 1, 2, 3, 4, 4, 4, 4], SolidShape::Pyramid5),
            (SolidShape::Hex8, &[0, 0, 0, 0, 4, 5, 6, 7], SolidShape::Pyramid5),
            (SolidShape::Hex8, &[0, 1, 2, 2, 4, 4, 4, 4], SolidShape::Tet4),
            (SolidShape::Hex8, &[0, 0, 2, 3, 4, 4, 4, 4], SolidShape::Tet4),
            (SolidShape::Wedge6, &[0, 1, 3, 4, 4, 4], SolidShape::Tet4),
            (SolidShape::Wedge6, &[0, 1, 3, 0, 5, 7], SolidShape::Pyramid5),
            (SolidShape::Wedge6, &[0, 1, 3, 4, 5, 3], SolidShape::Pyramid5),
        ];
        for (shape, nodes, is) in cases {
            let solid = Solid::new(shape, nodes, 7);
            let mut sides = Sides::default();
            let found = sides.place(&[], solid);
            assert_eq!((found.shape, found.id), (is, 7), "{nodes:?}");
            let at = |n: u32| Vec3::from(CUBE[n as usize]);
            let mut under = 0.0;
            for side in 0..shape.face_count() {
                let of_side = once(solid.face(side).nodes()).unwrap();
                let faces = sides.faces(&[found], (0, 1), side as u8).unwrap();
                assert_eq!(faces.len(), usize::from(of_side.len() > 2), "{nodes:?} {side}");
                for (_, face) in faces {
                    assert_eq!(sides.side(0, face), side as u8);
                    let own = found.face(face as usize);
                    let [a, rest @ ..] = own.nodes() else { panic!() };
                    let fan = rest.windows(2).map(|pair| at(*a).dot(&at(pair[0]).cross(&at(pair[1]))) / 6.0);
                    under += fan.sum::<f64>();
                }
            }
            assert!(volume(&found) > 0.05 && (volume(&found) - under).abs() < 1e-15, "{nodes:?} {found:?} {under}");
            assert_eq!(sides.faces(&[found], (0, 1), shape.face_count() as u8), None);
        }
        // One edge alone, a twist, and a flat one are none; whole ones stay.
        for nodes in
            [[0, 1, 2, 2, 4, 5, 6, 7], [0, 1, 0, 3, 4, 5, 4, 7], [0, 1, 2, 3, 0, 1, 2, 3], [0, 1, 2, 3, 4, 5, 6, 7]]
        {
            let solid = Solid::new(SolidShape::Hex8, &nodes, 1);
            let mut sides = Sides::default();
            assert_eq!(sides.place(&[], solid), solid);
            assert_eq!(sides.faces(&[solid], (0, 1), 5), Some(vec![(0, 5)]));
        }
    }
}
