//! The facets of a surface mesh with their neighbours and normals, checked to be a surface.

use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use std::collections::HashMap;

/// Facets, oriented outwards.
#[derive(Clone)]
pub struct Facets {
    pub points: Vec<Vec3>,
    /// Nodes of each facet; the first `counts` hold.
    pub nodes: Vec<[u32; 4]>,
    pub counts: Vec<u8>,
    /// Facet and edge on the other side of each edge; edge k runs from node k to the next one around.
    pub across: Vec<[Option<(usize, usize)>; 4]>,
    /// Unit normal of each facet as a whole.
    pub normals: Vec<Vec3>,
}

impl Facets {
    /// The facets of `mesh`, turned over if `flip`.
    ///
    /// Fails, naming the facets, on degenerate or folded facets, edges of more than two facets, and neighbours of
    /// opposite orientation.
    pub fn new(mesh: &Mesh, flip: bool) -> Result<Self> {
        let fail = |what: String, help: &str| Error::input_anywhere(format!("{}: {what}", mesh.source), help);
        if mesh.facets.is_empty() {
            return Err(fail("the mesh has no surface facets".into(), "give a mesh of triangles and quadrilaterals"));
        }
        let mut facets = Self {
            points: mesh.points.iter().map(|p| Vec3::from(*p)).collect(),
            nodes: mesh.facets.iter().map(|f| f.nodes).collect(),
            counts: mesh.facets.iter().map(|f| f.count).collect(),
            across: vec![[None; 4]; mesh.facets.len()],
            normals: Vec::with_capacity(mesh.facets.len()),
        };
        if flip {
            facets.nodes.iter_mut().zip(&facets.counts).for_each(|(nodes, count)| nodes[1..*count as usize].reverse());
        }
        for (f, facet) in mesh.facets.iter().enumerate() {
            let normal = facets.regular_normal(f).ok_or_else(|| {
                let help = "remove facets without area, and order the nodes of each around its border";
                fail(format!("facet {} is degenerate or folded", facet.id), help)
            })?;
            facets.normals.push(normal);
        }
        facets.connect().map_err(|(f, g, same)| {
            let (f, g) = (mesh.facets[f].id, mesh.facets[g].id);
            if same {
                fail(format!("facets {f} and {g} have opposite orientations"), "turn over one of them")
            } else {
                fail(format!("facets {f} and {g} share an edge with a third"), "split the surface there")
            }
        })?;
        Ok(facets)
    }

    /// Number of edges of a facet.
    pub fn count(&self, f: usize) -> usize {
        self.counts[f] as usize
    }

    /// All corners (facet, number).
    pub fn corners(&self) -> impl Iterator<Item = (usize, usize)> {
        self.counts.iter().enumerate().flat_map(|(f, count)| (0..*count as usize).map(move |k| (f, k)))
    }

    /// The corners after and before a corner.
    pub fn beside(&self, f: usize, k: usize) -> [usize; 2] {
        let count = self.count(f);
        [(k + 1) % count, (k + count - 1) % count]
    }

    /// The corners (facet, number) at each node.
    pub fn around_nodes(&self) -> Vec<Vec<(usize, usize)>> {
        let mut around = vec![Vec::new(); self.points.len()];
        self.corners().for_each(|(f, k)| around[self.node(f, k)].push((f, k)));
        around
    }

    /// Node at a corner; corners count around.
    pub fn node(&self, f: usize, k: usize) -> usize {
        self.nodes[f][k % self.count(f)] as usize
    }

    /// The point at a corner.
    pub fn point(&self, f: usize, k: usize) -> &Vec3 {
        &self.points[self.node(f, k)]
    }

    /// The vector along edge k.
    pub fn edge(&self, f: usize, k: usize) -> Vec3 {
        self.point(f, k + 1) - self.point(f, k)
    }

    /// Mean of the nodes of a facet.
    pub fn centroid(&self, f: usize) -> Vec3 {
        (0..self.count(f)).map(|k| *self.point(f, k)).sum::<Vec3>() / self.count(f) as f64
    }

    /// The vector product of the two edges at a corner, and the angle between them.
    pub fn corner(&self, f: usize, k: usize) -> (Vec3, f64) {
        let (next, last) = (self.edge(f, k), -self.edge(f, k + self.count(f) - 1));
        let cross = next.cross(&last);
        (cross, cross.norm().atan2(next.dot(&last)))
    }

    /// Angle between the normals on both sides of an edge; `None` at the end of the surface.
    pub fn turn(&self, f: usize, k: usize) -> Option<f64> {
        self.across[f][k].map(|(g, _)| angle(&self.normals[f], &self.normals[g]))
    }

    /// The normal of a facet whose corners all turn the same way by a sound angle.
    fn regular_normal(&self, f: usize) -> Option<Vec3> {
        let count = self.count(f);
        let size = (0..count).map(|k| self.edge(f, k).norm_squared()).fold(0.0, f64::max);
        let sum: Vec3 = (0..count).map(|k| self.corner(f, k).0).sum();
        let normal = sum.try_normalize(f64::MIN_POSITIVE)?;
        (0..count).all(|k| self.corner(f, k).0.dot(&normal) > 1e-10 * size).then_some(normal)
    }

    /// Fills `across`, or gives two facets that do not go together and whether it is for their orientation.
    pub fn connect(&mut self) -> std::result::Result<(), (usize, usize, bool)> {
        let mut open = HashMap::new();
        let corners: Vec<_> = self.corners().collect();
        for (f, k) in corners {
            let (a, b) = (self.node(f, k), self.node(f, k + 1));
            match open.get(&(a.min(b), a.max(b))) {
                None => {
                    open.insert((a.min(b), a.max(b)), (f, k));
                }
                Some(&(g, _)) if f == g => return Err((f, g, true)),
                Some(&(g, j)) if self.across[g][j].is_some() => return Err((f, g, false)),
                Some(&(g, j)) if self.node(g, j) == a => return Err((f, g, true)),
                Some(&(g, j)) => {
                    self.across[f][k] = Some((g, j));
                    self.across[g][j] = Some((f, k));
                }
            }
        }
        Ok(())
    }
}

/// Angle between two vectors, accurate when small.
pub fn angle(a: &Vec3, b: &Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::test_meshes::{grid, mesh_of};

    fn message(mesh: &Mesh) -> String {
        Facets::new(mesh, false).err().map_or(String::new(), |e| e.to_string())
    }

    #[test]
    fn neighbours_and_normals_of_a_plane() {
        let mesh = grid(2, 1, false, |s, t| [s, t, 0.0]);
        let facets = Facets::new(&mesh, false).unwrap();
        assert_eq!(facets.across[0], [None, Some((1, 3)), None, None]);
        assert_eq!(facets.normals[0], Vec3::z());
        assert_eq!(Facets::new(&mesh, true).unwrap().normals[1], -Vec3::z());
    }

    #[test]
    fn bad_facets_are_named() {
        let points =
            vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(message(&mesh_of(points.clone(), &[&[0, 4, 1]])).contains("facet 101 is degenerate"));
        assert!(message(&mesh_of(points.clone(), &[&[0, 2, 1, 3]])).contains("facet 101 is degenerate or folded"));
        assert!(message(&mesh_of(points.clone(), &[&[0, 1, 2], &[0, 2, 3]])).is_empty());
        assert!(message(&mesh_of(points.clone(), &[&[0, 1, 2], &[2, 3, 0]])).is_empty());
        let opposite = message(&mesh_of(points.clone(), &[&[0, 1, 2], &[0, 3, 2]]));
        assert!(opposite.contains("facets 102 and 101 have opposite orientations"), "{opposite}");
        let third = message(&mesh_of(points.clone(), &[&[0, 1, 2], &[0, 2, 3], &[0, 2, 5]]));
        assert!(third.contains("share an edge with a third"), "{third}");
        assert!(message(&mesh_of(points, &[])).contains("no surface facets"));
    }
}
