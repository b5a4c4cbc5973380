//! The curved edges of a mesh: those of the Nagata patches of its surface.

use crate::Vec3;
use crate::controls::Controls;
use crate::error::Result;
use crate::mesh::flat::Moments;
use crate::mesh::{Facet, Group, Mesh, Solid, faces};
use crate::surface::{Edge, NormalOptions, Patch, Smoothing, patches_from_mesh};
use std::collections::{HashMap, HashSet};

/// A component of a coefficient below this times the length of its edge is rounding: planes along the axes stay exact.
const ROUNDING: f64 = 1e-12;
/// Nodes closer to each other along an axis than this times the size of the mesh are in a plane.
const FLAT: f64 = 1e-6;

/// Coefficients c of the edges that are curved, by their nodes in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    pub of: HashMap<[u32; 2], Vec3>,
    /// All edges of the surface.
    pub edges: HashSet<[u32; 2]>,
    /// Those that it is sharp at.
    pub sharp: HashSet<[u32; 2]>,
}

impl Curves {
    /// The coefficient of the edge between two nodes.
    pub fn at(&self, a: u32, b: u32) -> Option<&Vec3> {
        self.of.get(&[a.min(b), a.max(b)])
    }

    /// Adds the edges of the patch of a facet.
    fn add(&mut self, nodes: &[u32], patch: &Patch) {
        for k in 0..nodes.len() {
            let next = (k + 1) % nodes.len();
            let edge = [nodes[k].min(nodes[next]), nodes[k].max(nodes[next])];
            self.edges.insert(edge);
            let limit = ROUNDING * (patch.nodes[next] - patch.nodes[k]).norm();
            let c = patch.coefficients[k].map(|x| if x.abs() <= limit { 0.0 } else { x });
            if c != Vec3::zeros() {
                self.of.entry(edge).or_insert(c);
            }
            if patch.edges[k] == Edge::Sharp {
                self.sharp.insert(edge);
            }
        }
    }
}

/// The curved edges of a mesh of facets. `flip` turns it over, which matters to given normals alone.
///
/// # Errors
/// Those of [`patches_from_mesh`].
pub fn of_surface(mesh: &Mesh, options: &NormalOptions, flip: bool) -> Result<Curves> {
    let mut curves = Curves::default();
    let patches = patches_from_mesh(mesh, Smoothing::Nagata, options, flip)?;
    for (facet, patch) in mesh.facets.iter().zip(&patches) {
        let mut nodes = facet.nodes;
        if flip {
            nodes[1..facet.count as usize].reverse();
        }
        curves.add(&nodes[..facet.count as usize], patch);
    }
    Ok(curves)
}

/// The curved edges of the boundary of a body that goes on as its mirror image across the planes in which its groups
/// `symmetry` lie.
///
/// # Errors
/// A boundary that is no surface, and planes that do not fit it.
pub fn of_body(mesh: &Mesh, symmetry: &[&str], controls: &Controls) -> Result<Curves> {
    let planes: Vec<Plane> = symmetry.iter().filter_map(|name| Plane::of(mesh, mesh.groups.get(*name)?)).collect();
    let boundary = faces::boundary(&mesh.solids);
    let boundary = boundary.iter().map(|(solid, face)| mesh.solids[*solid as usize].face(*face as usize));
    let is_in = |plane: &Plane, nodes: &[u32]| nodes.iter().all(|n| plane.holds(&mesh.points[*n as usize]));
    let inside = |facet: &Facet| planes.iter().any(|plane| is_in(plane, facet.nodes()));
    let facets: Vec<Facet> = boundary.filter(|facet| !inside(facet)).collect();
    let mut nodes: Vec<u32> = facets.iter().flat_map(Facet::nodes).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |n: u32| nodes.binary_search(&n).map_or(0, |k| k as u32);
    let surface = Mesh {
        source: mesh.source.clone(),
        points: nodes.iter().map(|&n| mesh.points[n as usize]).collect(),
        point_ids: nodes.iter().map(|&n| mesh.point_ids[n as usize]).collect(),
        facets: facets.iter().map(|f| Facet { nodes: f.nodes.map(place), ..*f }).collect(),
        ..Mesh::default()
    };
    if facets.is_empty() {
        return Ok(Curves::default());
    }
    let ends = |plane: &&Plane| surface.points.iter().filter(|x| plane.holds(x)).count() > 1;
    let symmetry = planes.iter().filter(ends).map(|p| (p.normal * p.at, p.normal)).collect();
    let options = NormalOptions { symmetry, controls: *controls, ..NormalOptions::default() };
    let patches = patches_from_mesh(&surface, Smoothing::Nagata, &options, false)?;
    let mut curves = Curves::default();
    facets.iter().zip(&patches).for_each(|(facet, patch)| curves.add(facet.nodes(), patch));
    // Rounding would take what is in a plane of symmetry out of it.
    for (edge, c) in &mut curves.of {
        for plane in planes.iter().filter(|plane| is_in(plane, edge)) {
            *c -= plane.normal * plane.normal.dot(c);
        }
    }
    Ok(curves)
}

/// The edges of quadratic elements as they are: with the middle m between the nodes a and b, c = 2 (a + b) - 4 m.
pub fn of_quadratic(mesh: &Mesh) -> Curves {
    let mut curves = Curves::default();
    let at = |n: u32| Vec3::from(mesh.points[n as usize]);
    for ([a, b], middle) in mesh.solids.iter().flat_map(Solid::middles) {
        // Of differences, which keep straight edges along the axes straight.
        let (a_from, b_from) = (at(a) - at(middle), at(b) - at(middle));
        let limit = ROUNDING * (a_from - b_from).norm();
        let c = (2.0 * (a_from + b_from)).map(|x| if x.abs() <= limit { 0.0 } else { x });
        if c != Vec3::zeros() {
            curves.of.insert([a, b], c);
        }
    }
    curves
}

/// A plane of symmetry.
struct Plane {
    normal: Vec3,
    at: f64,
    slack: f64,
}

impl Plane {
    /// The one in which a group lies; none where it lies in no such plane, which is told of elsewhere.
    fn of(mesh: &Mesh, group: &Group) -> Option<Self> {
        let hull = |points: &mut dyn Iterator<Item = &[f64; 3]>| {
            let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
            points.map(|x| Vec3::from(*x)).fold(start, |(low, high), x| (low.inf(&x), high.sup(&x)))
        };
        let (least, most) = hull(&mut mesh.points.iter());
        let (low, high) = hull(&mut group.nodes.iter().map(|n| &mesh.points[*n as usize]));
        let slack = FLAT * (most - least).norm();
        let axis = (0..3).find(|&d| high[d] - low[d] <= slack && most[d] - least[d] > 2.0 * slack);
        if let Some(axis) = axis {
            return Some(Self { normal: Vec3::ith(axis, 1.0), at: 0.5 * (low[axis] + high[axis]), slack });
        }
        let points = || group.nodes.iter().map(|n| Vec3::from(mesh.points[*n as usize]));
        let normal = Moments::of(&(0.5 * (least + most)), points()).normal()?;
        let at = points().map(|x| normal.dot(&x)).sum::<f64>() / group.nodes.len() as f64;
        let plane = Self { normal, at, slack };
        points().all(|x| plane.holds(&x.into())).then_some(plane)
    }

    fn holds(&self, x: &[f64; 3]) -> bool {
        (self.normal.dot(&Vec3::from(*x)) - self.at).abs() <= self.slack
    }
}
