//! Structural forces and tangents of this rank's rows, from the elements that touch its nodes.

use super::dofs::DofMap;
use super::pattern::Pattern;
use crate::Vec3;
use crate::model::Model;
use crate::model::elements::{Outcome, Scratch, carrying, facet_pressure};

/// Values of a tangent with their pattern.
pub type Tangent<'a> = (&'a Pattern, &'a mut [f64]);

/// Adds the internal forces of all elements to `forces` (all local nodes; those of owned nodes are complete), and tells of
/// each element its section, its nodes and its forces on them. In the same pass it adds their tangents to the matrix values of
/// this rank's rows, if these are given: [`add_tangent`], but for enhanced strain, which is not kept.
///
/// # Errors
/// The first inverted element; the forces, and the values, are then of no use.
pub fn internal_forces(
    model: &Model,
    u: &[Vec3],
    forces: &mut [Vec3],
    mut tangent: Option<Tangent>,
    mut of_element: impl FnMut(u32, &[u32], &[[f64; 3]]),
) -> Outcome {
    let mut scratch = Scratch::default();
    for (e, solid) in model.part.solids.iter().enumerate() {
        scratch.evaluate(model, e, u, tangent.is_some())?;
        let nodes = carrying(model, solid);
        let own = scratch.forces(nodes.len());
        nodes.iter().zip(own).for_each(|(&n, force)| forces[n as usize] += Vec3::from(*force));
        of_element(solid.section, nodes, own);
        if let Some((pattern, values)) = &mut tangent {
            scatter(pattern, values, e, nodes, &scratch);
        }
    }
    Ok(())
}

/// Adds tangent times `du` to `forces`, with the tangent at `u`.
pub fn add_tangent_times(model: &Model, u: &[Vec3], du: &[Vec3], forces: &mut [Vec3]) {
    let mut scratch = Scratch::default();
    for (e, solid) in model.part.solids.iter().enumerate() {
        let nodes = carrying(model, solid);
        let still = nodes.iter().all(|&n| du[n as usize] == Vec3::zeros());
        if still || scratch.evaluate(model, e, u, true).is_err() {
            continue;
        }
        for (a, &n) in nodes.iter().enumerate() {
            for i in 0..3 {
                let row = scratch.row(nodes.len(), 3 * a + i);
                let moved = nodes.iter().zip(row.as_chunks::<3>().0).map(|(&b, k)| Vec3::from(*k).dot(&du[b as usize]));
                forces[n as usize][i] += moved.sum::<f64>();
            }
        }
    }
}

/// Adds the tangents of all elements to the matrix values of this rank's rows. Inverted elements add nothing. From here on
/// enhanced strain is sought from what it is here.
pub fn add_tangent(model: &mut Model, pattern: &Pattern, u: &[Vec3], values: &mut [f64]) {
    let mut scratch = Scratch::default();
    for e in 0..model.part.solids.len() {
        if scratch.evaluate(model, e, u, true).is_err() {
            continue;
        }
        scatter(pattern, values, e, carrying(model, &model.part.solids[e]), &scratch);
        scratch.keep(model, e);
    }
}

fn scatter(pattern: &Pattern, values: &mut [f64], element: usize, nodes: &[u32], scratch: &Scratch) {
    match nodes.len() {
        4 => pattern.add_element(values, nodes, element, &scratch.of_four.tangent),
        5 => pattern.add_element(values, nodes, element, &scratch.of_five.tangent),
        6 => pattern.add_element(values, nodes, element, &scratch.of_six.tangent),
        10 => pattern.add_element(values, nodes, element, &scratch.of_ten.tangent),
        18 => pattern.add_element(values, nodes, element, &scratch.of_18.tangent),
        27 => pattern.add_element(values, nodes, element, &scratch.of_27.tangent),
        _ => pattern.add_element(values, nodes, element, &scratch.of_eight.tangent),
    }
}

/// Subtracts the load of a follower pressure on a set from `forces` (all local nodes).
pub fn subtract_pressure(model: &Model, set: &str, pressure: f64, u: &[Vec3], forces: &mut [Vec3]) {
    for facet in &model.set(set).facets {
        let nodes = model.part.face_nodes(facet);
        facet_pressure(model, &nodes, nodes.share * pressure, u, |row, force, _| {
            forces[nodes[row / 3] as usize][row % 3] -= force[row % 3];
        });
    }
}

/// Subtracts the stiffness of a follower pressure on a set from the matrix values.
pub fn subtract_pressure_tangent(
    model: &Model,
    (set, pressure): (&str, f64),
    u: &[Vec3],
    (dofs, pattern): (&DofMap, &Pattern),
    values: &mut [f64],
) {
    for facet in &model.set(set).facets {
        let nodes = model.part.face_nodes(facet);
        facet_pressure(model, &nodes, nodes.share * pressure, u, |row, _, tangent| {
            for (equation, share) in dofs.shares(nodes[row / 3], row % 3) {
                let Some(local) = dofs.local(equation) else { continue };
                for (column, value) in tangent.iter().enumerate() {
                    for (equation, part) in dofs.shares(nodes[column / 3], column % 3) {
                        pattern.add(values, local, equation, -value * share * part);
                    }
                }
            }
        });
    }
}
