//! Hexahedra, wedges and quadrilaterals of second order as linear ones on the same nodes: eight, eight and four of each.
//!
//! On the quadratic faces of such elements an even pressure has nodal forces of both signs, which contact at nodes cannot bear.
//! Linear elements between all the nodes have as many unknowns and none of this. The middles of faces and of hexahedra that an
//! element lacks are put where its shape functions have them: with the corners at c and the middles of edges at m, the middle of
//! a face is at (2 sum m - sum c) / 4, that of a hexahedron at (sum m - sum c) / 4.

use super::faces::{HEX_EDGES, HEX_FACES, PYRAMID_EDGES, TET_EDGES, WEDGE_EDGES, WEDGE_SIDES};
use super::raw::CellShape;
use super::{SolidShape, message};
use crate::Vec3;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// A node that a file lacks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Made {
    pub node: u32,
    /// The corners of what it is in the middle of, then the middles of its edges. What holds for all of them holds for it.
    pub around: Vec<u32>,
    /// How many of them are corners.
    pub corners: usize,
}

/// Whether a node is one of those that a file lacks, which are in ascending order.
pub(crate) fn is_made(made: &[Made], node: u32) -> bool {
    made.binary_search_by_key(&node, |made| made.node).is_ok()
}

/// Where the nodes of an element of second order stand: corners, then the middles of edges, of faces, and of all.
struct Grid {
    corners: usize,
    edges: &'static [[usize; 2]],
    faces: &'static [[u8; 4]],
    has_centre: bool,
    /// How many parts are at corners; in one layer each is at a lower one and that above.
    parts: usize,
}

const HEX: Grid = Grid { corners: 8, edges: &HEX_EDGES, faces: &HEX_FACES, has_centre: true, parts: 8 };
const WEDGE: Grid = Grid { corners: 6, edges: &WEDGE_EDGES, faces: &WEDGE_SIDES, has_centre: false, parts: 6 };
const QUAD: Grid =
    Grid { corners: 4, edges: HEX_EDGES.split_at(4).0, faces: &[[0, 1, 2, 3]], has_centre: false, parts: 4 };

/// A quadrilateral of second order that is drawn out by one layer.
const LAYER: Grid = Grid {
    corners: 8,
    edges: HEX_EDGES.split_at(8).0,
    faces: &[[0, 1, 2, 3], [4, 5, 6, 7]],
    has_centre: false,
    parts: 4,
};

/// What an element of second order becomes.
pub(super) enum Kind {
    Solids(SolidShape),
    Facets,
}

impl CellShape {
    /// What it becomes, if it is one of those that are split.
    pub fn halves(self) -> Option<Kind> {
        Some(match self {
            Self::Hex20 | Self::Hex27 | Self::Layer8 => Kind::Solids(SolidShape::Hex8),
            Self::Wedge15 | Self::Wedge18 => Kind::Solids(SolidShape::Wedge6),
            Self::Quad8 | Self::Quad9 => Kind::Facets,
            _ => return None,
        })
    }

    fn grid(self) -> Option<&'static Grid> {
        Some(match self {
            Self::Hex20 | Self::Hex27 => &HEX,
            Self::Layer8 => &LAYER,
            Self::Wedge15 | Self::Wedge18 => &WEDGE,
            Self::Quad8 | Self::Quad9 => &QUAD,
            _ => return None,
        })
    }

    /// The edges of it as a linear element between its corners.
    fn linear_edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Hex => HEX.edges,
            Self::Wedge => WEDGE.edges,
            Self::Pyramid => &PYRAMID_EDGES,
            Self::Tet => &TET_EDGES,
            _ => &[],
        }
    }
}

impl Grid {
    /// The node half way between two corners.
    fn between(&self, a: usize, b: usize) -> usize {
        let is_edge = |edge: &[usize; 2]| *edge == [a, b] || *edge == [b, a];
        let is_across = |face: &[u8; 4]| (0..4).any(|k| (face[k] as usize, face[(k + 2) % 4] as usize) == (a, b));
        if a == b {
            return a;
        }
        if let Some(edge) = self.edges.iter().position(is_edge) {
            return self.corners + edge;
        }
        let face = self.faces.iter().position(is_across);
        self.corners + self.edges.len() + face.unwrap_or(self.faces.len())
    }

    /// The nodes of the parts: those at corners, numbered as the whole is, so that side k of one is a part of side k; a wedge has two
    /// more, in the middle of its ends.
    fn parts(&self) -> Vec<Vec<usize>> {
        let at = |c: usize, a: usize| self.between(if a < self.parts { c } else { c + self.parts }, a);
        let corner = |c: usize| (0..self.corners).map(|a| at(c, a)).collect();
        let mut parts: Vec<Vec<usize>> = (0..self.parts).map(corner).collect();
        if self.corners == 6 {
            let below = [[0, 1], [1, 2], [2, 0]];
            let (half, above) = (below.map(|[a, b]| [a, b + 3]), below.map(|[a, b]| [a + 3, b + 3]));
            let wedge = |ends: [[[usize; 2]; 3]; 2]| ends.concat().iter().map(|[a, b]| self.between(*a, *b)).collect();
            parts.extend([wedge([below, half]), wedge([half, above])]);
        }
        parts
    }
}

/// The parts of an element of so many that have a part of its side.
pub(crate) fn at_side(shape: SolidShape, count: u32, side: u8) -> Vec<u32> {
    let corners = |nodes: &[u8]| nodes.iter().map(|&node| u32::from(node)).collect();
    let k = side as usize;
    match (shape, count) {
        (SolidShape::Hex8, 8) => corners(&HEX_FACES[k]),
        (SolidShape::Hex8, 4) => {
            corners(&HEX_FACES[k]).into_iter().filter(|&corner: &u32| corner < 4 || k == 1).map(|c| c % 4).collect()
        }
        (SolidShape::Wedge6, 8) => match k {
            0 => vec![0, 1, 2, 6],
            1 => vec![3, 4, 5, 7],
            _ => corners(&WEDGE_SIDES[k - 2]),
        },
        _ => (0..count).collect(),
    }
}

/// The nodes of elements of second order as the splitting goes on.
#[derive(Default)]
pub(super) struct Splitter {
    /// The middles of quadrilaterals by their corners, sorted.
    faces: HashMap<[u32; 4], u32>,
    /// The middles of edges by their ends, sorted, with an element that has them.
    edges: HashMap<[u32; 2], (u32, u64)>,
    grids: HashMap<CellShape, Vec<Vec<usize>>>,
    pub made: Vec<Made>,
}

impl Splitter {
    /// Takes note of the middles that an element has.
    pub fn know(&mut self, shape: CellShape, nodes: &[u32], id: u64) {
        let Some(grid) = shape.grid() else { return };
        let (corners, middles) = nodes.split_at(grid.corners);
        for (&[a, b], &middle) in grid.edges.iter().zip(middles) {
            self.edges.insert([corners[a].min(corners[b]), corners[a].max(corners[b])], (middle, id));
        }
        for (face, &middle) in grid.faces.iter().zip(&middles[grid.edges.len()..]) {
            self.faces.insert(key(&face.map(|corner| corners[corner as usize])), middle);
        }
    }

    /// The nodes of the parts of an element; new ones are added to the points.
    pub fn split(&mut self, shape: CellShape, nodes: &[u32], points: &mut Vec<[f64; 3]>) -> Vec<Vec<u32>> {
        let Some(grid) = shape.grid() else { return Vec::new() };
        let mut all = nodes[..grid.corners + grid.edges.len()].to_vec();
        for face in grid.faces {
            let ends = face.map(|corner| corner as usize);
            let middles = (0..4).map(|k| all[grid.between(ends[k], ends[(k + 1) % 4])]);
            let around: Vec<u32> = ends.iter().map(|&corner| all[corner]).chain(middles).collect();
            let middle = *self.faces.entry(key(&ends.map(|corner| all[corner]))).or_insert_with(|| {
                self.made.push(Made { node: points.len() as u32, around: around.clone(), corners: 4 });
                points.push(middle_of(points, &around, 4));
                points.len() as u32 - 1
            });
            all.push(middle);
        }
        if grid.has_centre {
            let given = nodes.get(all.len()).copied();
            all.push(given.unwrap_or_else(|| {
                let around = nodes[..grid.corners + grid.edges.len()].to_vec();
                points.push(middle_of(points, &around, grid.corners));
                self.made.push(Made { node: points.len() as u32 - 1, around, corners: grid.corners });
                points.len() as u32 - 1
            }));
        }
        let parts = self.grids.entry(shape).or_insert_with(|| grid.parts());
        parts.iter().map(|part| part.iter().map(|&at| all[at]).collect()).collect()
    }

    /// The node in the middle of an edge that is split.
    pub fn middle(&self, a: u32, b: u32) -> Option<u32> {
        self.edges.get(&[a.min(b), a.max(b)]).map(|(middle, _)| *middle)
    }

    /// Refuses linear elements that have an edge which others have split: the middle of it would hang.
    pub fn check(&self, source: &str, linear: impl Iterator<Item = (CellShape, Vec<u32>, u64)>) -> Result<()> {
        if self.edges.is_empty() {
            return Ok(());
        }
        for (shape, nodes, id) in linear {
            let edges = shape.linear_edges().iter().map(|&[a, b]| [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])]);
            if let Some((_, other)) = edges.into_iter().find_map(|edge| self.edges.get(&edge)) {
                return Err(hanging(source, id, *other));
            }
        }
        Ok(())
    }
}

fn hanging(source: &str, linear: u64, quadratic: u64) -> Error {
    let what = format!(
        "elements {linear} of first order and {quadratic} of second order share an edge, whose middle node only one of them has"
    );
    message::whole_file(source, what, "mesh what belongs together with elements of one order")
}

fn key(corners: &[u32; 4]) -> [u32; 4] {
    let mut key = *corners;
    key.sort_unstable();
    key
}

/// Where the middle of a face or of a hexahedron is, between corners and middles of edges.
fn middle_of(points: &[[f64; 3]], around: &[u32], corners: usize) -> [f64; 3] {
    let sum = |nodes: &[u32]| nodes.iter().map(|&node| Vec3::from(points[node as usize])).sum::<Vec3>();
    let (ends, middles) = around.split_at(corners);
    let share = if corners == 4 { 0.5 } else { 0.25 };
    (share * sum(middles) - 0.25 * sum(ends)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of straight elements.
    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 3.0],
        [2.0, 0.0, 3.0],
        [2.0, 1.0, 3.0],
        [0.0, 1.0, 3.0],
    ];

    fn corners(shape: CellShape) -> Vec<[f64; 3]> {
        match shape {
            CellShape::Wedge15 => [0, 1, 3, 4, 5, 7].map(|k| CUBE[k]).to_vec(),
            CellShape::Quad8 => CUBE[..4].to_vec(),
            _ => CUBE.to_vec(),
        }
    }

    #[test]
    fn parts_fill_straight_elements() {
        let shapes = [
            (CellShape::Hex20, 8, 8, 6.0),
            (CellShape::Wedge15, 6, 8, 3.0),
            (CellShape::Layer8, 8, 4, 6.0),
            (CellShape::Quad8, 4, 4, 2.0),
        ];
        for (shape, count, parts, volume) in shapes {
            let grid = shape.grid().unwrap();
            let mut points = corners(shape);
            let middle = |[a, b]: [usize; 2]| [0, 1, 2].map(|i| 0.5 * (points[a][i] + points[b][i]));
            let middles: Vec<_> = grid.edges.iter().map(|ends| middle(*ends)).collect();
            points.extend(middles);
            let nodes: Vec<u32> = (0..points.len() as u32).collect();
            let mut splitter = Splitter::default();
            let found = splitter.split(shape, &nodes, &mut points);
            assert_eq!((found.len(), found[0].len()), (parts, count), "{shape:?}");
            let at = |part: &[u32], k: usize| Vec3::from(points[part[k] as usize]);
            let sizes = found.iter().map(|part| {
                let [a, b, c, d] = [0, 1, if count == 6 { 2 } else { 3 }, count / 2].map(|k| at(part, k));
                match count {
                    4 => (b - a).cross(&(c - a)).z,
                    6 => 0.5 * (b - a).cross(&(c - a)).dot(&(d - a)),
                    _ => (b - a).cross(&(c - a)).dot(&(d - a)),
                }
            });
            let sizes: Vec<f64> = sizes.collect();
            assert!(sizes.iter().all(|size| (size - volume / parts as f64).abs() < 1e-14), "{shape:?}: {sizes:?}");
            assert!(splitter.made.iter().all(|made| {
                let ends = &made.around[..made.corners];
                let mean = ends.iter().map(|&n| Vec3::from(points[n as usize])).sum::<Vec3>() / ends.len() as f64;
                (Vec3::from(points[made.node as usize]) - mean).norm() < 1e-15
            }));
        }
    }

    #[test]
    fn sides_of_parts_are_parts_of_sides() {
        for (shape, of) in [(CellShape::Hex20, 8), (CellShape::Wedge15, 8), (CellShape::Layer8, 4)] {
            let Some(Kind::Solids(solid)) = shape.halves() else { panic!() };
            let grid = shape.grid().unwrap();
            let parts: Vec<Vec<u32>> =
                grid.parts().iter().map(|part| part.iter().map(|&node| node as u32).collect()).collect();
            assert_eq!(parts.len() as u32, of);
            let whole: Vec<u32> = (0..grid.corners as u32).collect();
            let area = |face: &[u32], points: &[Vec3]| {
                let x: Vec<Vec3> = face.iter().map(|&n| points[n as usize]).collect();
                let last = x.len() - 1;
                let fan = (1..last).map(|k| 0.5 * (x[k] - x[0]).cross(&(x[k + 1] - x[0])));
                fan.sum::<Vec3>()
            };
            let ends: Vec<Vec3> = corners(shape).into_iter().map(Vec3::from).collect();
            let mut points = ends.clone();
            let mean = |nodes: &[usize]| nodes.iter().map(|&n| ends[n]).sum::<Vec3>() / nodes.len() as f64;
            points.extend(grid.edges.iter().map(|edge| mean(edge)));
            points.extend(grid.faces.iter().map(|face| mean(&face.map(usize::from))));
            points.push(mean(&(0..grid.corners).collect::<Vec<_>>()));
            for side in 0..solid.face_count() {
                let face = |nodes: &[u32]| super::super::Solid::new(solid, nodes, 1).face(side);
                let own = at_side(solid, of, side as u8);
                let sum: Vec3 = own.iter().map(|&part| area(face(&parts[part as usize]).nodes(), &points)).sum();
                assert!((sum - area(face(&whole).nodes(), &points)).norm() < 1e-14, "{shape:?} {side}");
            }
        }
    }

    #[test]
    fn curved_elements_have_their_middles_on_their_shape() {
        // A quadrilateral over z = x y (1 - x) / 2 + x^2 / 4 on the square of side 2: of second order along each edge.
        let z = |x: f64, y: f64| 0.25 * x * x + 0.5 * y * x * (2.0 - x);
        let place = |[x, y]: [f64; 2]| [x, y, z(x, y)];
        let mut points: Vec<[f64; 3]> =
            [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0], [2.0, 1.0], [1.0, 2.0], [0.0, 1.0]]
                .map(place)
                .to_vec();
        let mut splitter = Splitter::default();
        splitter.split(CellShape::Quad8, &[0, 1, 2, 3, 4, 5, 6, 7], &mut points);
        assert!((points[8][2] - z(1.0, 1.0)).abs() < 1e-15 && points[8][..2] == [1.0, 1.0]);
    }
}
