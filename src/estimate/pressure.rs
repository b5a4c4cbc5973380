//! How well a contact resolves its pressure: nodal pressures against their means over the facets around, and how many nodes
//! there are from the edge of the contact to its middle.

use crate::Vec3;
use crate::contact::{Faces, Pair, Status};
use crate::model::elements::nodal_areas;
use crate::model::tractions::tractions;
use crate::model::{Model, outward_of};
use crate::parallel::{any, max, sum};
use crate::partition::PartFacet;
use mpi::topology::SimpleCommunicator;

/// Nodes from the edge of a contact to its middle that are counted.
const MOST: usize = 5;

/// Nodes from the edge that count as at it: the outermost stands for an area that is in part outside, and bears the less.
const AT_EDGE: f64 = 2.0;

/// The pressure of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressure {
    /// Error of the nodal pressures over them, root mean squares by area.
    pub relative: f64,
    /// Nodes that touch, from the edge of the contact to where it is widest; 5 stands for all above, and for a contact
    /// without an edge.
    pub nodes: usize,
    /// It has an edge on the slave surface.
    pub ends: bool,
    /// The highest pressure is at the edge.
    pub peaks_at_edge: bool,
    /// Work of the pressure on what the master is behind the facets by between their nodes, force times length.
    pub chord_work: f64,
    /// Work of the pressure on the gaps of facets across the edge of the contact, force times length.
    pub edge_work: f64,
}

/// A contact as its nodes see it; values of all local nodes, those of the nodes that they are tied to.
struct Nodes<'a> {
    comm: &'a SimpleCommunicator,
    model: &'a Model,
    facets: &'a [PartFacet],
}

impl Nodes<'_> {
    /// Gives nodes what those have that they are tied to, and those of other ranks that of their owners. Collective.
    fn share(&self, field: &mut [f64]) {
        let part = &self.model.part;
        for n in 0..part.owned {
            field[n] = field[part.tie[n] as usize];
        }
        part.halo.update(self.comm, 1, field);
    }

    /// The same of vectors. Collective.
    fn share_vectors(&self, field: &mut [Vec3]) {
        let part = &self.model.part;
        for n in 0..part.owned {
            field[n] = field[part.tie[n] as usize];
        }
        let mut flat: Vec<f64> = field.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
        part.halo.update(self.comm, 3, &mut flat);
        field.iter_mut().zip(flat.as_chunks::<3>().0).for_each(|(v, values)| *v = Vec3::from(*values));
    }

    /// Nodes from the edge: 0 for those that do not touch, 1 next to them, and so on; [`MOST`] beyond. Collective.
    fn depths(&self, pair: &Pair) -> Vec<f64> {
        let mut depths = vec![0.0; self.model.part.points.len()];
        for slave in pair.slaves.iter().filter(|s| s.accepted.status != Status::Gap) {
            depths[slave.node as usize] = MOST as f64;
        }
        self.share(&mut depths);
        for depth in 1..MOST {
            let before = depths.clone();
            for facet in self.facets {
                let nodes = &facet.nodes[..facet.count as usize];
                if nodes.iter().any(|&n| before[n as usize] == (depth - 1) as f64) {
                    for &n in nodes.iter().map(|&n| &self.model.part.tie[n as usize]) {
                        depths[n as usize] = depths[n as usize].min(depth as f64);
                    }
                }
            }
            self.share(&mut depths);
        }
        depths
    }

    /// Areas of the nodes, and the means of a field over the facets around them, weighted by shape functions.
    fn means(&self, field: &[f64], u: &[Vec3]) -> (Vec<f64>, Vec<f64>) {
        let mut areas = vec![0.0; field.len()];
        let mut means = vec![0.0; field.len()];
        for facet in self.facets {
            let count = facet.count as usize;
            let at = |a: usize| field[facet.nodes[a % count] as usize];
            for (a, area) in nodal_areas(self.model, &facet.nodes[..count], u).into_iter().enumerate().take(count) {
                // Rows of the mass matrix of a triangle or parallelogram.
                let mean = match count {
                    3 => (2.0 * at(a) + at(a + 1) + at(a + 2)) / 4.0,
                    _ => (4.0 * at(a) + 2.0 * at(a + 1) + at(a + 2) + 2.0 * at(a + 3)) / 9.0,
                };
                let n = self.model.part.tie[facet.nodes[a] as usize] as usize;
                areas[n] += area;
                means[n] += area * mean;
            }
        }
        means.iter_mut().zip(&areas).filter(|(_, area)| **area > 0.0).for_each(|(mean, area)| *mean /= area);
        (areas, means)
    }
}

/// Work of the pressure `field` on what the master is behind the facets that this rank counts. Where normals of the master turn
/// by dn along an edge d, it bulges by dn.d/8 over the edge; of all edges the mean over a facet is the sum of dn.d/24, for
/// triangles as for quadrilaterals. As far as the slave bulges so in the initial mesh, as a bore does over a shaft, or as it is
/// deformed, where its gap counts so, its faces need not bend. Across the edge of the contact the slave goes no farther along a
/// master that turns away than the force of a node indents it.
fn works(nodes: &Nodes, pair: &Pair, field: &[f64], u: &[Vec3]) -> [f64; 2] {
    let part = &nodes.model.part;
    let mut normals = vec![Vec3::zeros(); part.points.len()];
    let (mut gaps, mut indents) = (vec![0.0; part.points.len()], vec![0.0; part.points.len()]);
    for slave in &pair.slaves {
        if let Some(p) = &slave.accepted.projection {
            let n = slave.node as usize;
            normals[n] = p.normal;
            // What touches has none but rounding.
            gaps[n] = if slave.accepted.status == Status::Gap { p.gap.max(0.0) } else { 0.0 };
            indents[n] = slave.accepted.force.norm() * pair.controls.augmentation / slave.penalties.automatic;
        }
    }
    let follows = pair.faces.as_ref().is_some_and(Faces::follow_nodes);
    let own_place = |n: usize| part.points[n] + if follows { u[n] } else { Vec3::zeros() };
    let mut outward = outward_of(part, pair, |n| own_place(n as usize));
    nodes.share_vectors(&mut normals);
    nodes.share_vectors(&mut outward);
    nodes.share(&mut gaps);
    nodes.share(&mut indents);
    let of_facet = |facet: &PartFacet| {
        let count = facet.count as usize;
        let at = |k: usize| facet.nodes[k % count] as usize;
        let turns = |normals: &[Vec3], place: &dyn Fn(usize) -> Vec3| -> f64 {
            let along = |k: usize| (normals[at(k + 1)] - normals[at(k)]).dot(&(place(at(k + 1)) - place(at(k))));
            (0..count).map(along).sum()
        };
        let bulges = turns(&normals, &|n| part.points[n] + u[n]);
        let own = -turns(&outward, &own_place);
        let bulges = bulges - own.clamp(bulges.min(0.0), bulges.max(0.0));
        let force: f64 = nodal_areas(nodes.model, &facet.nodes[..facet.count as usize], u)
            .iter()
            .zip(&facet.nodes)
            .map(|(a, n)| a * field[*n as usize])
            .sum();
        if (0..count).any(|k| normals[at(k)] == Vec3::zeros()) {
            return [0.0; 2];
        }
        let gap = (0..count).map(|k| gaps[at(k)]).sum::<f64>() / count as f64;
        let indent = (0..count).map(|k| indents[at(k)]).fold(0.0, f64::max);
        let most = if gap > 0.0 { indent } else { f64::INFINITY };
        [force * (bulges / 24.0).clamp(-most, most), force * gap.min(most)]
    };
    let all = nodes.facets.iter().filter(|facet| facet.mine).map(of_facet);
    all.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]])
}

impl Pressure {
    /// That of a pair in a state that has converged, with displacements `u`; `None` where nothing touches. Collective.
    pub fn new(comm: &SimpleCommunicator, model: &Model, pair: &Pair, u: &[Vec3]) -> Option<Self> {
        if !any(comm, pair.slaves.iter().any(|s| s.accepted.status != Status::Gap)) {
            return None;
        }
        let own_facets = &model.part.sets[pair.side.set].facets;
        let facets = model.part.pieces(own_facets);
        let nodes = Nodes { comm, model, facets: &facets };
        let tractions = tractions(comm, model, pair, u);
        let mut field = vec![0.0; model.part.points.len()];
        let (areas, _) = nodes.means(&field, u);
        for slave in &pair.slaves {
            if let Some(p) = &slave.accepted.projection {
                let n = slave.node as usize;
                field[n] = tractions[n].dot(&p.normal);
            }
        }
        nodes.share(&mut field);
        let (_, means) = nodes.means(&field, u);
        let depths = nodes.depths(pair);
        let own = || pair.slaves.iter().map(|slave| slave.node as usize);
        let [chord_work, edge_work] = works(&nodes, pair, &field, u);
        // A quadratic face bends with the master, as far as the bulges go here.
        let is_quadratic = facets.len() > own_facets.len();
        let mut squares = [0.0, 0.0, if is_quadratic { 0.0 } else { chord_work }, edge_work];
        for n in own() {
            squares[0] += areas[n] * (field[n] - means[n]).powi(2);
            squares[1] += areas[n] * field[n].powi(2);
        }
        sum(comm, &mut squares);
        let largest = |of: &[f64]| own().map(|n| of[n]).fold(0.0, f64::max);
        let ends = own().any(|n| depths[n] == 1.0);
        let mut most = [largest(&field), largest(&depths), f64::from(u8::from(ends))];
        max(comm, &mut most);
        let [highest, deepest, ends] = most;
        // Of several equal peaks that farthest from the edge.
        let mut peak = [own().filter(|n| field[*n] == highest).map(|n| depths[n]).fold(0.0, f64::max)];
        max(comm, &mut peak);
        Some(Self {
            relative: if squares[1] > 0.0 { (squares[0] / squares[1]).sqrt() } else { 0.0 },
            nodes: deepest as usize,
            chord_work: squares[2],
            edge_work: squares[3],
            ends: ends > 0.0,
            peaks_at_edge: peak[0] <= AT_EDGE && deepest > AT_EDGE + 1.0,
        })
    }
}
