//! Forces on nodes as total forces on sets. Programs write the force on a face node by node: it is one again if the nodes
//! have the shares that nagata gives them, by area.

use super::bodies::Bodies;
use super::groups::{Face, Groups};
use super::loads::Load;
use crate::error::{Error, Result};
use crate::mesh::abaqus::LOWEST;
use crate::solid::load::{quad4_nodal_areas, quad8_nodal_areas, ring_nodal_areas, tri3_nodal_areas, tri6_nodal_areas};
use std::collections::{BTreeMap, BTreeSet};

/// How far a force may be from its share by area, of the largest: the digits that programs write.
const DIGITS: f64 = 1e-6;

/// Most sets of a load.
const MOST: usize = 200;

/// Sets, as `BODY.GROUP`, with total forces.
pub(super) fn sets(
    groups: &mut Groups,
    bodies: &Bodies,
    body: usize,
    nodes: &[u32],
    forces: &[[f64; 3]],
    load: &Load,
) -> Result<Vec<(String, [f64; 3])>> {
    let name = |group: String| format!("{}.{group}", bodies.bodies[body].name);
    let mut alike: BTreeMap<[u64; 3], Vec<u32>> = BTreeMap::new();
    for (&node, force) in nodes.iter().zip(forces) {
        alike.entry(force.map(f64::to_bits)).or_default().push(node);
    }
    if alike.len() > 1
        && let Some((faces, total)) = by_area(groups, nodes, forces)
    {
        let group = groups.faces(&faces, bodies.is_inside(body), &load.hint)?;
        return Ok(vec![(name(group), total)]);
    }
    if alike.len() > MOST {
        let what = format!("nodes are loaded with {} different forces, which are no even load on faces", alike.len());
        return Err(Error::input(&load.at, what, "give the load as a pressure, or as forces on sets of nodes"));
    }
    let mut sets = Vec::new();
    for (bits, own) in alike {
        let group = groups.nodes(&own, bodies.is_inside(body), true, &load.hint)?;
        sets.push((name(group), bits.map(|bits| f64::from_bits(bits) * own.len() as f64)));
    }
    Ok(sets)
}

/// The faces between the nodes, if the forces are those of a total force spread over them.
fn by_area(groups: &Groups, nodes: &[u32], forces: &[[f64; 3]]) -> Option<(Vec<Face>, [f64; 3])> {
    let mesh = &groups.whole.mesh;
    let loaded: BTreeSet<u32> = nodes.iter().copied().collect();
    // The deck of a section knows its upright faces alone, and of these the nodes at z = 0.
    let is_known = |node: &u32| !mesh.is_section || mesh.points[*node as usize][2] == 0.0;
    // An even load on a quadratic triangle has no force at its corners.
    let bears = |face: Face| match groups.middles(face) {
        Some(middles) => middles.iter().all(|node| loaded.contains(node)),
        None => groups.face_nodes(face).iter().all(|node| !is_known(node) || loaded.contains(node)),
    };
    let within = |face: &Face| (!mesh.is_section || groups.boundary[*face as usize].1 >= LOWEST) && bears(*face);
    let mut faces: Vec<Face> = (0..groups.boundary.len() as u32).filter(within).collect();
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    for &face in &faces {
        let nodes = groups.face_nodes(face);
        let x: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.points[node as usize]).collect();
        let shares = match x.len() {
            3 => tri3_nodal_areas(x.as_array()?).to_vec(),
            6 => tri6_nodal_areas(x.as_array()?).to_vec(),
            _ if mesh.is_section => ring_nodal_areas(x.as_array()?).to_vec(),
            _ => quad4_nodal_areas(x.as_array()?).to_vec(),
        };
        let own = nodes.iter().zip(shares).filter(|(node, _)| is_known(node));
        own.for_each(|(&node, area)| *areas.entry(node).or_default() += area);
    }
    for (parts, nodes) in quadratic(groups, &loaded) {
        let x: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.points[node as usize]).collect();
        let shares = quad8_nodal_areas(x.as_array()?);
        nodes.iter().zip(shares).for_each(|(&node, area)| *areas.entry(node).or_default() += area);
        faces.extend(parts);
    }
    faces.sort_unstable();
    let area: f64 = areas.values().sum();
    let total = forces.iter().fold([0.0; 3], |sum, force| [0, 1, 2].map(|d| sum[d] + force[d]));
    let largest = forces.iter().flatten().fold(0.0, |most: f64, force| most.max(force.abs()));
    let is_share = |(node, force): (&u32, &[f64; 3])| {
        let share = areas.get(node).copied().unwrap_or(0.0) / area;
        (0..3).all(|d| (force[d] - share * total[d]).abs() <= DIGITS * largest)
    };
    let size = total.iter().fold(0.0, |most: f64, part| most.max(part.abs()));
    let is_left_out =
        |(node, share): (&u32, &f64)| !loaded.contains(node) && (share / area * size).abs() > DIGITS * largest;
    let even = area > 0.0 && nodes.iter().zip(forces).all(is_share) && !areas.iter().any(is_left_out);
    even.then_some((faces, total))
}

/// The four parts of each quadrilateral of second order between these nodes, with its eight nodes.
fn quadratic<'a>(groups: &'a Groups, loaded: &'a BTreeSet<u32>) -> impl Iterator<Item = ([Face; 4], &'a [u32])> {
    let sides = groups.whole.made.iter().filter(|made| made.corners == 4);
    sides.filter(|made| made.around.iter().all(|node| loaded.contains(node))).filter_map(|made| {
        let (ends, middles) = made.around.split_at(4);
        let mut parts = [0; 4];
        for (k, part) in parts.iter_mut().enumerate() {
            let mut key = [ends[k], middles[k], made.node, middles[(k + 3) % 4]];
            key.sort_unstable();
            *part = groups.face_of_key(&key)?;
        }
        Some((parts, &made.around[..]))
    })
}
