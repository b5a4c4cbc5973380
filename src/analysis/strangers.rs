//! Bodies that touch or are in each other while neither contact, tie nor common nodes connect them: each is as if the other were
//! not there.
//!
//! By points just outside the middles of their faces that lie in an element of the other body: so nodes need not stand on nodes,
//! and a pin is found in a face that is wider.

use crate::Vec3;
use crate::mesh::{Solid, faces::boundary};
use crate::model::Model;
use crate::model::locate::held;
use crate::mortar::Corners;
use crate::parallel::{max, word_of_largest};
use crate::partition::PartSolid;
use crate::partition::parcels::{Bounds, bounds, hull, meets};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// How far outside a face, over the edge of a square of its area.
const OUTSIDE: f64 = 1e-3;

/// The bodies that nothing connects, until it has been told that they meet.
#[derive(Clone, Debug, Default)]
pub(super) struct Strangers {
    pairs: Vec<[usize; 2]>,
    /// The faces of bodies on this rank that are of one of its elements only.
    faces: Vec<Face>,
}

#[derive(Clone, Debug)]
struct Face {
    corners: Corners<u32>,
    body: usize,
    /// Of its element, whatever the partition.
    number: u64,
}

impl Strangers {
    /// Collective.
    pub(super) fn new(comm: &SimpleCommunicator, model: &Model) -> Self {
        let mut known: BTreeSet<[usize; 2]> = model.told.iter().copied().collect();
        let mut meet = |a: usize, b: usize| known.insert([a.min(b), a.max(b)]);
        for pair in &model.pairs {
            pair.master_body().map(|body| meet(pair.side.body, body));
        }
        let count = model.bodies.len();
        let body = |component: usize| model.part.components[component].body as usize;
        let mut joined = vec![0.0; count * count];
        for (_, [a, b]) in model.tied_components(comm) {
            joined[body(a) * count + body(b)] = 1.0;
        }
        max(comm, &mut joined);
        (0..joined.len()).filter(|k| joined[*k] > 0.0).for_each(|k| {
            meet(k / count, k % count);
        });
        let all = (0..count).flat_map(|b| (0..b).map(move |a| [a, b]));
        let pairs: Vec<[usize; 2]> = all.filter(|pair| !known.contains(pair)).collect();
        let faces = if pairs.is_empty() { Vec::new() } else { outer(model) };
        Self { pairs, faces }
    }

    /// What is to be said of those that meet at displacements `u`, once of each two. Collective.
    pub(super) fn meet(&mut self, comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Vec<String> {
        if self.pairs.is_empty() {
            return Vec::new();
        }
        let part = &model.part;
        let place = |n: u32| part.points[n as usize] + u[part.tie[n as usize] as usize];
        let of = |body: usize| hull(comm, bounds(part.owned_of(body).map(|n| place(n as u32))));
        let hulls: Vec<Option<Bounds>> = (0..model.bodies.len()).map(of).collect();
        let mut told = Vec::new();
        let faces = &self.faces;
        self.pairs.retain(|&[a, b]| {
            let (Some(of_a), Some(of_b)) = (hulls[a], hulls[b]) else { return true };
            if !meets(&of_a, &of_b) {
                return true;
            }
            let within = |one: usize, other: usize, hull: &Bounds| {
                let own = faces.iter().filter(|face| face.body == one);
                let beside = own.filter_map(|face| Some((face.outside(&place)?, face.number)));
                let (points, numbers): (Vec<Vec3>, Vec<u64>) = beside.filter(|(x, _)| meets(hull, &(*x, *x))).unzip();
                let held = held(comm, model, other, &points, &place);
                let found = points.into_iter().zip(numbers).zip(held).filter(|(_, held)| *held);
                // The same on any number of ranks.
                let first = found.map(|(found, _)| found).min_by_key(|(_, number)| *number);
                word_of_largest(comm, first.map(|(x, number)| (x, -(number as f64))), |x| {
                    format!("({:.6}, {:.6}, {:.6})", x.x, x.y, x.z)
                })
            };
            let found = within(a, b, &of_b).or_else(|| within(b, a, &of_a));
            if let Some((place, _)) = &found {
                told.push(format!(
                    "bodies `{}` and `{}` touch or are in each other, such as at {place}, and neither contact nor tie is between \
                     them: they pass through each other; add a contact or a `tie`",
                    model.bodies[a].name, model.bodies[b].name
                ));
            }
            found.is_none()
        });
        told
    }
}

impl Face {
    fn outside(&self, place: &impl Fn(u32) -> Vec3) -> Option<Vec3> {
        let corners = self.corners.map(place);
        let middle = corners.all().iter().sum::<Vec3>() / corners.count as f64;
        let area = corners.area_vector();
        Some(middle + area.try_normalize(f64::MIN_POSITIVE)? * (OUTSIDE * area.norm().sqrt()))
    }
}

/// The faces of elements that this rank counts, of those that another of its elements has not, too.
fn outer(model: &Model) -> Vec<Face> {
    let solid = |solid: &PartSolid| Solid { shape: solid.shape, nodes: solid.nodes, id: solid.number };
    let solids: Vec<Solid> = model.part.solids.iter().map(solid).collect();
    let counted = boundary(&solids).into_iter().filter(|(e, _)| model.part.solids[*e as usize].mine);
    let face = |(e, face): (u32, u8)| {
        let (solid, facet) = (&model.part.solids[e as usize], solids[e as usize].face(face as usize));
        Face { corners: Corners::new(facet.nodes()), body: solid.body as usize, number: solid.number }
    };
    counted.map(face).collect()
}
