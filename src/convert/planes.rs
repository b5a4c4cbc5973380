//! Planes of symmetry: faces at an end of a body whose nodes stay in a plane, but are not held along it. A master that ends
//! there is smoothed as if it went on, for a deck says by its supports alone that it does.

use super::bodies::Bodies;
use super::frames::Frames;
use super::groups::{Face, Groups};
use super::supports::Supports;
use crate::AXIS_NAMES;
use crate::error::Result;
use std::collections::{BTreeSet, HashSet};

/// Of the extent of a body, what is still in a plane.
const FLAT: f64 = 1e-9;

/// Nodes that never move along x, y and z.
#[derive(Default)]
pub(super) struct Still(Option<[HashSet<u32>; 3]>);

impl Still {
    /// Takes the supports of a further step; of nodes with frames of their own nothing is known.
    pub fn meet(&mut self, supports: &Supports, frames: &Frames) {
        let mut now = supports.still();
        now.iter_mut().for_each(|nodes| nodes.retain(|&node| !frames.has(node)));
        match &mut self.0 {
            None => self.0 = Some(now),
            Some(so_far) => {
                for (nodes, now) in so_far.iter_mut().zip(now) {
                    nodes.retain(|node| now.contains(node));
                }
            }
        }
    }

    /// The groups with such planes of a body where these faces of it end.
    pub fn planes(&self, groups: &mut Groups, bodies: &Bodies, body: usize, master: &[Face]) -> Result<Vec<String>> {
        let Some(still) = &self.0 else { return Ok(Vec::new()) };
        let points = &groups.whole.mesh.points;
        let nodes = |face: Face| groups.facet(face).nodes().to_vec();
        let own: Vec<Face> =
            (0..groups.boundary.len() as u32).filter(|&face| bodies.is_inside(body)(nodes(face)[0])).collect();
        let of_master: HashSet<u32> = master.iter().flat_map(|&face| nodes(face)).collect();
        let mut found: Vec<(usize, Vec<Face>)> = Vec::new();
        for axis in 0..3 {
            let along = |face: &Face| nodes(*face).into_iter().map(|node| points[node as usize][axis]);
            let (low, high) = own
                .iter()
                .flat_map(along)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            for end in [low, high] {
                let is_there = |face: &&Face| {
                    let is_still = || nodes(**face).iter().all(|node| still[axis].contains(node));
                    along(face).all(|x| (x - end).abs() <= FLAT * (high - low)) && is_still()
                };
                let faces: Vec<Face> = own.iter().filter(is_there).copied().collect();
                let there: BTreeSet<u32> = faces.iter().flat_map(|&face| nodes(face)).collect();
                let is_free = |node: &u32| (0..3).all(|other| other == axis || !still[other].contains(node));
                if there.iter().any(is_free) && there.iter().any(|node| of_master.contains(node)) {
                    found.push((axis, faces));
                }
            }
        }
        let name = |(axis, faces): (usize, Vec<Face>)| {
            groups.faces(&faces, bodies.is_inside(body), &format!("symmetry-{}", AXIS_NAMES[axis]))
        };
        found.into_iter().map(name).collect()
    }
}
