//! Tractions at the nodes of a slave surface, from the forces there.
//!
//! On linear faces the traction is the force over the area that belongs to the node. On a quadratic triangle of area A an even
//! traction t has the forces t A/3 in the middles of the edges and none at the corners. So a corner gives what force it has in
//! equal parts to the middles of the edges that end there, and is given the mean of their tractions: tractions times areas
//! add up to the force. An edge in a plane of symmetry counts half, for half of its middle is the mirror image's. A corner that is
//! one of a quadrilateral, too, has the area of that.
//!
//! From segment to segment the force F_j of a node is spread over its faces with its function N_j. Its traction F_j / ∫ N_j dA
//! would be what such functions have at the node, which the stiffness of the mesh around it makes scatter; the one here is their mean
//! with N_i, as the force that a node of linear faces really bears, over its area:
//!
//! ```text
//!     t_i = Σ_j F_j ∫ N_i N_j dA / ∫ N_j dA / ∫ N_i dA
//! ```
//!
//! Tractions times areas add up to the force, and a node next to one that touches has some, too.
//!
//! At a sharp edge of the slave the area is that of the faces that look at what presses there: sides that stand beside it bear nothing.
//! In a plane of symmetry what acts across it is zero with the mirror image's.

use super::Model;
use super::elements::nodal_areas;
use super::symmetry::SymmetryPlane;
use crate::Vec3;
use crate::contact::{Faces, Pair};
use crate::mesh::SolidShape;
use crate::mortar::Corners;
use crate::partition::PartFacet;
use crate::scene::body_of;
use mpi::topology::SimpleCommunicator;

/// Cosine of the angle to the normal of the contact within which a face looks at it: the sides of an edge of 90 degrees that a V presses
/// both do, at 45 degrees, a side that stands on the master does not, however it bulges.
const FACING: f64 = 0.5;

/// An edge: its ends, the node in its middle, and what it counts.
type Edge = ([usize; 2], usize, f64);

/// The tractions on the owned nodes of a slave surface, with displacements `u`; zero where there is no area. Tied nodes count for
/// the node that they follow. Collective.
pub fn tractions(comm: &SimpleCommunicator, model: &Model, pair: &Pair, u: &[Vec3]) -> Vec<Vec3> {
    let mut tractions = match &pair.faces {
        Some(faces) => of_segments(comm, model, (pair, faces), u),
        None => of_nodes(comm, model, pair, u),
    };
    for (n, across) in &pair.mirrored {
        let traction = &mut tractions[*n as usize];
        *traction -= across * across.dot(traction);
    }
    tractions
}

/// The areas that belong to the nodes of a slave surface, of which owned ones have all.
struct Areas {
    /// Normals of the contact at owned nodes, where there is one.
    normals: Vec<Vec3>,
    all: Vec<f64>,
    /// Those of faces that look at the contact.
    facing: Vec<f64>,
}

impl Areas {
    fn none(model: &Model, pair: &Pair) -> Self {
        let mut normals = vec![Vec3::zeros(); model.part.points.len()];
        for slave in &pair.slaves {
            normals[slave.node as usize] = slave.accepted.projection.map_or(Vec3::zeros(), |at| at.normal);
        }
        let all = vec![0.0; normals.len()];
        Self { normals, facing: all.clone(), all }
    }

    /// Adds that of a node on a face that looks `outward`.
    fn add(&mut self, node: u32, area: f64, outward: &Vec3) {
        let n = node as usize;
        self.all[n] += area;
        if outward.dot(&self.normals[n]) <= -FACING * outward.norm() {
            self.facing[n] += area;
        }
    }

    /// Adds those of linear facets, and of quadratic ones that are counted by their nodes.
    fn add_facets(&mut self, model: &Model, facets: &[PartFacet], u: &[Vec3]) {
        let part = &model.part;
        for facet in facets {
            let nodes = part.face_nodes(facet);
            let corners = &facet.nodes[..facet.count as usize];
            let outward = Corners::new(corners).map(|n| part.points[n as usize] + u[n as usize]).area_vector();
            for (&n, area) in nodes.iter().zip(nodal_areas(model, &nodes, u)) {
                self.add(part.tie[n as usize], nodes.share * area, &outward);
            }
        }
    }

    fn of(&self, node: usize) -> f64 {
        if self.facing[node] > 0.0 { self.facing[node] } else { self.all[node] }
    }
}

/// From segment to segment.
fn of_segments(comm: &SimpleCommunicator, model: &Model, (pair, faces): (&Pair, &Faces), u: &[Vec3]) -> Vec<Vec3> {
    let part = &model.part;
    let mut areas = Areas::none(model, pair);
    if part.quadratic.is_empty() {
        areas.add_facets(model, &part.sets[pair.side.set].facets, u);
    } else {
        let place = |n: u32| part.points[n as usize] + u[n as usize];
        faces.add_areas(place, |n, area, outward| areas.add(n, area, outward));
    }
    let mut forces = vec![0.0; 3 * part.points.len()];
    let mut add = |n: u32, force: Vec3| (0..3).for_each(|d| forces[3 * n as usize + d] += force[d]);
    for (s, slave) in pair.slaves.iter().enumerate() {
        let (own, all) = (-slave.accepted.force, slave.accepted.on_node());
        faces.spread(s, &own, &mut add);
        // What it gets as a master is at the node.
        add(slave.node, all - own);
    }
    let mut tractions: Vec<Vec3> = forces.as_chunks::<3>().0[..part.owned].iter().map(|f| Vec3::from(*f)).collect();
    part.halo.add_to_owners(comm, 3, &forces, |n, force| tractions[n as usize] += Vec3::from_column_slice(force));
    for (n, traction) in tractions.iter_mut().enumerate() {
        *traction = if areas.of(n) > 0.0 { *traction / areas.of(n) } else { Vec3::zeros() };
    }
    tractions
}

/// From node to surface.
fn of_nodes(comm: &SimpleCommunicator, model: &Model, pair: &Pair, u: &[Vec3]) -> Vec<Vec3> {
    let part = &model.part;
    let mut areas = Areas::none(model, pair);
    let facets = &part.sets[pair.side.set].facets;
    areas.add_facets(model, facets, u);
    let mut tractions = vec![Vec3::zeros(); part.points.len()];
    pair.slaves.iter().for_each(|slave| tractions[slave.node as usize] = slave.accepted.on_node());
    let edges = edges(model, pair);
    let mut ending = vec![0.0; part.points.len()];
    edges.iter().for_each(|(ends, _, share)| ends.iter().for_each(|&n| ending[n] += share));
    for facet in facets.iter().filter(|facet| facet.count == 4) {
        part.face_nodes(facet).iter().for_each(|&n| ending[n as usize] = 0.0);
    }
    let has_triangles = |shape: &SolidShape| matches!(shape, SolidShape::Tet10 | SolidShape::Wedge18);
    let mut sections = pair.side.sections.iter().map(|&s| &model.sections[s]);
    let quadratic =
        sections.any(|section| has_triangles(&section.element.shape()) || section.fillers.iter().any(has_triangles));
    if quadratic {
        let mut given: Vec<Vec3> = tractions
            .iter()
            .zip(&ending)
            .map(|(force, all)| if *all > 0.0 { force / *all } else { Vec3::zeros() })
            .collect();
        share(comm, model, &mut given);
        edges.iter().for_each(|([a, b], middle, share)| tractions[*middle] += (given[*a] + given[*b]) * *share);
    }
    for n in 0..part.owned {
        tractions[n] = if ending[n] > 0.0 || areas.of(n) == 0.0 { Vec3::zeros() } else { tractions[n] / areas.of(n) };
    }
    if quadratic {
        share(comm, model, &mut tractions);
        let at_middles = tractions.clone();
        for (ends, middle, share) in &edges {
            ends.iter()
                .filter(|&&n| ending[n] > 0.0)
                .for_each(|&n| tractions[n] += at_middles[*middle] * (share / ending[n]));
        }
    }
    tractions.truncate(part.owned);
    tractions
}

/// The edges of the quadratic triangles of a slave surface that this rank sees, whole ones and those whose quarters are facets, each
/// once.
fn edges(model: &Model, pair: &Pair) -> Vec<Edge> {
    let part = &model.part;
    let mut edges = Vec::new();
    for facet in &part.sets[pair.side.set].facets {
        let corners = &facet.nodes[..facet.count as usize];
        let mut add =
            |a: u32, b: u32, middle: u32| edges.push(([a.min(b) as usize, a.max(b) as usize], middle as usize));
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            part.quadratic.middles.at(a, b).into_iter().for_each(|middle| add(a, b, middle));
        }
        if let Some(&[a, b, c, ab, bc, ca]) = part.quadratic.quarters.of(corners) {
            [(a, b, ab), (b, c, bc), (c, a, ca)].into_iter().for_each(|(a, b, middle)| add(a, b, middle));
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let own = |plane: &&SymmetryPlane| body_of(&plane.set.value) == model.bodies[pair.side.body].name;
    let share = |ends: &[usize; 2]| -> f64 {
        let in_plane = |plane: &SymmetryPlane| ends.iter().all(|&n| plane.has(&part.points[n]));
        model.symmetry.iter().filter(own).map(|plane| if in_plane(plane) { 0.5 } else { 1.0 }).product()
    };
    edges.into_iter().map(|(ends, middle)| (ends, middle, share(&ends))).collect()
}

/// Gives nodes of other ranks the values of their owners. Collective.
fn share(comm: &SimpleCommunicator, model: &Model, field: &mut [Vec3]) {
    let mut flat: Vec<f64> = field.iter().flatten().copied().collect();
    model.part.halo.update(comm, 3, &mut flat);
    field.iter_mut().zip(flat.as_chunks::<3>().0).for_each(|(to, from)| *to = Vec3::from(*from));
}
