//! Structural forces and tangents of this rank's rows, from the elements that touch its nodes.

use super::dofs::{DofMap, NONE};
use super::pattern::Pattern;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::failure::Cause;
use crate::mesh::SolidShape;
use crate::model::Model;
use crate::partition::{PartFacet, PartSolid};
use crate::scene::Element;
use crate::solid::element::{
    ElementMatrices, Inverted, Medium, Sample, advance, average_plastic_strain, average_stress, hex8, hex8_eas,
    hex8_fbar, hex8_sri, plane4, plastic_work, stored_energy, tet4,
};
use crate::solid::load;
use crate::solid::material::{State, strain_between};
use crate::solid::voigt::Voigt;

/// Matrices of one element, made once for a sweep over all.
#[derive(Default)]
struct Scratch {
    of_eight: ElementMatrices<24>,
    of_four: ElementMatrices<12>,
}

/// Nodes of an element that carry it: all, but in plane strain the lower four.
pub fn carrying<'a>(model: &Model, solid: &'a PartSolid) -> &'a [u32] {
    let four = solid.shape == SolidShape::Tet4 || model.bodies[solid.body as usize].plane_strain;
    if four { &solid.nodes[..4] } else { &solid.nodes }
}

impl Scratch {
    /// Evaluates element `e` of the part at displacements `u`.
    fn evaluate(&mut self, model: &Model, e: usize, u: &[Vec3], want_tangent: bool) -> Outcome {
        let solid = &model.part.solids[e];
        let body = &model.bodies[solid.body as usize];
        let (points, medium) = (&model.part.points, medium(model, e));
        if body.plane_strain {
            let (nodes, how) = ((&gather(points, solid), &gather(u, solid)), (want_tangent, body.element));
            return plane4::evaluate(nodes, thickness(model, solid), medium, how, &mut self.of_four);
        }
        match solid.shape {
            SolidShape::Tet4 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                tet4::evaluate(&x, &u, medium, want_tangent, &mut self.of_four)
            }
            SolidShape::Hex8 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate = match body.element {
                    Element::Hex8Fbar => hex8_fbar::evaluate,
                    Element::Hex8Sri => hex8_sri::evaluate,
                    Element::Hex8Eas => hex8_eas::evaluate,
                    Element::Hex8 | Element::Tet4 => hex8::evaluate,
                };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_eight)
            }
        }
    }

    /// Keeps the amplitudes at the tangent of element `e`, the last one.
    fn keep(&self, model: &mut Model, e: usize) {
        let four = model.bodies[model.part.solids[e].body as usize].plane_strain;
        if let Some(kept) = model.history.amplitudes_mut(e) {
            kept.clone_from(if four { &self.of_four.amplitudes } else { &self.of_eight.amplitudes });
        }
    }

    /// Internal forces of the last element, which so many nodes carry.
    fn forces(&self, nodes: usize) -> &[[f64; 3]] {
        let flat: &[f64] = if nodes == 4 { &self.of_four.residual } else { &self.of_eight.residual };
        flat.as_chunks().0
    }

    /// A row of its tangent.
    fn row(&self, nodes: usize, row: usize) -> &[f64] {
        if nodes == 4 { &self.of_four.tangent[row] } else { &self.of_eight.tangent[row] }
    }
}

/// What fills element `e` of the part.
fn medium(model: &Model, e: usize) -> Medium<'_> {
    let material = &model.bodies[model.part.solids[e].body as usize].material;
    Medium { material, states: model.history.of(e), amplitudes: model.history.amplitudes(e) }
}

/// Thickness of an element in plane strain.
fn thickness(model: &Model, solid: &PartSolid) -> f64 {
    let z = |a: usize| model.part.points[solid.nodes[a] as usize].z;
    z(4) - z(0)
}

/// The integration points of element `e` of the part at displacements `u`.
fn samples(model: &Model, e: usize, u: &[Vec3]) -> Result<Vec<Sample>, Inverted> {
    let solid = &model.part.solids[e];
    let (body, points) = (&model.bodies[solid.body as usize], &model.part.points);
    let medium = medium(model, e);
    if body.plane_strain {
        let nodes = (&gather(points, solid), &gather(u, solid));
        return Ok(plane4::samples(nodes, thickness(model, solid), medium, body.element)?.to_vec());
    }
    if solid.shape == SolidShape::Tet4 {
        return Ok(tet4::samples(&gather(points, solid), &gather(u, solid))?.to_vec());
    }
    let (x, u) = (gather(points, solid), gather(u, solid));
    let samples = match body.element {
        Element::Hex8Fbar => hex8_fbar::samples(&x, &u),
        Element::Hex8Sri => hex8_sri::samples(&x, &u),
        Element::Hex8Eas => hex8_eas::samples(&x, &u, medium),
        Element::Hex8 | Element::Tet4 => hex8::samples(&x, &u),
    };
    Ok(samples?.to_vec())
}

/// Whether an element could be evaluated.
type Outcome = std::result::Result<(), Inverted>;

/// Node vectors of an element.
fn gather<const N: usize>(field: &[Vec3], solid: &PartSolid) -> [[f64; 3]; N] {
    std::array::from_fn(|a| field[solid.nodes[a] as usize].into())
}

/// Adds the internal forces of all elements to `forces` (all local nodes; those of owned nodes are complete), and tells of
/// each element its body and its largest nodal force.
///
/// # Errors
/// The first inverted element; the forces are then of no use.
pub fn internal_forces(
    model: &Model,
    u: &[Vec3],
    forces: &mut [Vec3],
    mut of_element: impl FnMut(u32, f64),
) -> Outcome {
    let mut scratch = Scratch::default();
    for (e, solid) in model.part.solids.iter().enumerate() {
        scratch.evaluate(model, e, u, false)?;
        let nodes = carrying(model, solid);
        let mut largest = 0.0f64;
        for (&n, force) in nodes.iter().zip(scratch.forces(nodes.len())) {
            let force = Vec3::from(*force);
            largest = largest.max(force.amax());
            forces[n as usize] += force;
        }
        of_element(solid.body, largest);
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
        match carrying(model, &model.part.solids[e]) {
            four @ [_, _, _, _] => pattern.add_element(values, four, e, &scratch.of_four.tangent),
            eight => pattern.add_element(values, eight, e, &scratch.of_eight.tangent),
        }
        scratch.keep(model, e);
    }
}

/// Whether an element of this rank is inverted at displacements `u`, or, if asked for, one with enhanced strain has no
/// solution for it.
pub fn any_inverted(model: &Model, u: &[Vec3], solve: bool) -> bool {
    model.part.solids.iter().enumerate().any(|(e, solid)| {
        let inverted = match solid.shape {
            SolidShape::Tet4 => tet4::volume(&moved(model, solid, u)) <= 0.0,
            SolidShape::Hex8 => hex8::min_jacobian(&moved(model, solid, u)) <= 0.0,
        };
        inverted || solve && model.history.amplitudes(e).is_some() && samples(model, e, u).is_err()
    })
}

fn moved<const N: usize>(model: &Model, solid: &PartSolid, u: &[Vec3]) -> [[f64; 3]; N] {
    std::array::from_fn(|a| {
        let n = solid.nodes[a] as usize;
        (model.part.points[n] + u[n]).into()
    })
}

/// Stiffness of each owned node before anything deforms: the smallest of its diagonal entries, force per length.
///
/// # Errors
/// An element that is inverted as given, by its number.
pub fn nodal_stiffness(model: &Model) -> Result<Vec<f64>> {
    let mut diagonal = vec![[0.0; 3]; model.part.points.len()];
    let u = vec![Vec3::zeros(); model.part.points.len()];
    let mut scratch = Scratch::default();
    for (e, solid) in model.part.solids.iter().enumerate() {
        if scratch.evaluate(model, e, &u, true).is_err() {
            let what = format!("{} is inverted", element_name(model, solid));
            return Err(Error::input_anywhere(what, "number its nodes the other way round, or mend the mesh there"));
        }
        let nodes = carrying(model, solid);
        for (a, &n) in nodes.iter().enumerate() {
            for i in 0..if model.bodies[solid.body as usize].plane_strain { 2 } else { 3 } {
                diagonal[n as usize][i] += scratch.row(nodes.len(), 3 * a + i)[3 * a + i];
            }
        }
    }
    diagonal.truncate(model.part.owned);
    // A direction without stiffness is one that is not modelled; a node without any is tied to another.
    let smallest = |d: &[f64; 3]| d.iter().copied().filter(|&k| k > 0.0).reduce(f64::min).unwrap_or(0.0);
    Ok(diagonal.iter().map(smallest).collect())
}

/// Mean Cauchy stress of each element that this rank counts (xx, yy, zz, xy, yz, zx).
///
/// # Errors
/// An element that is inverted, by its number.
pub fn stresses(model: &Model, u: &[Vec3]) -> Result<Vec<Voigt>> {
    let of = |e: usize| average_stress(&samples(model, e, u)?, medium(model, e));
    mine(model).map(|e| of(e).map_err(|_| lost(model, e))).collect()
}

/// Mean equivalent plastic strain of each element of a body that this rank counts.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn plastic_strains(model: &Model, u: &[Vec3], body: usize) -> Result<Vec<f64>> {
    let of = |e: usize| Ok::<_, Inverted>(average_plastic_strain(&samples(model, e, u)?, model.history.of(e)));
    of_body(model, body).map(|e| of(e).map_err(|_| lost(model, e))).collect()
}

/// Stored energy and plastic work of what this rank counts of a body.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn energies(model: &Model, u: &[Vec3], body: usize) -> Result<[f64; 2]> {
    let mut sums = [0.0; 2];
    for e in of_body(model, body) {
        let medium = medium(model, e);
        let of_element = samples(model, e, u)
            .and_then(|samples| Ok([stored_energy(&samples, medium)?, plastic_work(&samples, medium)]));
        let energies = of_element.map_err(|_| lost(model, e))?;
        (0..2).for_each(|k| sums[k] += energies[k]);
    }
    Ok(sums)
}

/// What is said of an element that has no stress in a state that has converged.
fn lost(model: &Model, e: usize) -> Error {
    let name = element_name(model, &model.part.solids[e]);
    Error::diverged(Cause::Element, format!("{name} has turned inside out in the converged state"))
}

fn element_name(model: &Model, solid: &PartSolid) -> String {
    format!("element {} of body `{}`", solid.id, model.bodies[solid.body as usize].name)
}

/// Largest principal logarithmic strain between two states of displacements, of what this rank counts; infinite where an
/// element is inverted.
pub fn largest_strain(model: &Model, before: &[Vec3], after: &[Vec3]) -> f64 {
    let of = |e: usize| {
        let (before, after) = (samples(model, e, before).ok()?, samples(model, e, after).ok()?);
        let mut strains = before.iter().zip(&after).map(|(from, to)| strain_between(&from.f, &to.f));
        strains.try_fold(0.0, |most: f64, strain| Some(most.max(strain?)))
    };
    mine(model).map(|e| of(e).unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
}

/// The elements that this rank counts.
fn mine(model: &Model) -> impl Iterator<Item = usize> + '_ {
    model.part.solids.iter().enumerate().filter(|(_, solid)| solid.mine).map(|(e, _)| e)
}

/// Those of a body.
fn of_body(model: &Model, body: usize) -> impl Iterator<Item = usize> + '_ {
    mine(model).filter(move |&e| model.part.solids[e].body as usize == body)
}

/// The states of all integration points at displacements `u`, by element, and there the enhanced strain, too. Every rank
/// finds those of all elements that it knows, from the same numbers. [`flow`] makes them those of the history.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn flown(model: &mut Model, u: &[Vec3]) -> Result<Vec<(usize, Vec<State>)>> {
    let mut scratch = Scratch::default();
    let mut flown = Vec::new();
    for e in 0..model.part.solids.len() {
        if model.history.amplitudes(e).is_some() {
            scratch.evaluate(model, e, u, true).map_err(|_| lost(model, e))?;
            scratch.keep(model, e);
        }
        if model.history.of(e).is_empty() {
            continue;
        }
        let material = &model.bodies[model.part.solids[e].body as usize].material;
        let mut states = model.history.of(e).to_vec();
        let advanced = samples(model, e, u).and_then(|samples| advance(&samples, material, &mut states));
        advanced.map_err(|_| lost(model, e))?;
        flown.push((e, states));
    }
    Ok(flown)
}

/// Makes the states that have been found those of the history.
pub fn flow(model: &mut Model, flown: Vec<(usize, Vec<State>)>) {
    for (e, states) in flown {
        model.history.of_mut(e).copy_from_slice(&states);
    }
    model.history.accept();
}

/// Nodal forces of a force per reference volume on an element.
pub fn body_force(model: &Model, solid: &PartSolid, per_volume: &Vec3) -> [Vec3; 8] {
    let mut forces = [Vec3::zeros(); 8];
    let mut set = |flat: &[f64]| {
        for (force, values) in forces.iter_mut().zip(flat.as_chunks::<3>().0) {
            *force = Vec3::from(*values);
        }
    };
    match solid.shape {
        SolidShape::Tet4 => set(&tet4::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Hex8 => set(&hex8::body_force(&gather(&model.part.points, solid), *per_volume)),
    }
    forces
}

/// Pressure load on a facet: nodal forces and d(force)/d(position), in 3x3 blocks of rows and columns of its nodes.
fn facet_pressure(
    model: &Model,
    facet: &PartFacet,
    pressure: f64,
    u: &[Vec3],
    mut each: impl FnMut(usize, &[f64; 3], &[f64]),
) {
    let at = |a: usize| -> [f64; 3] {
        let n = facet.nodes[a] as usize;
        (model.part.points[n] + u[n]).into()
    };
    if facet.count == 3 {
        let load = load::tri3_pressure(&std::array::from_fn(at), pressure);
        for (row, tangent) in load.tangent.iter().enumerate() {
            each(row, &load.force.as_chunks::<3>().0[row / 3], tangent);
        }
    } else {
        let load = load::quad4_pressure(&std::array::from_fn(at), pressure);
        for (row, tangent) in load.tangent.iter().enumerate() {
            each(row, &load.force.as_chunks::<3>().0[row / 3], tangent);
        }
    }
}

/// Subtracts the load of a follower pressure on a set from `forces` (all local nodes).
pub fn subtract_pressure(model: &Model, set: &str, pressure: f64, u: &[Vec3], forces: &mut [Vec3]) {
    for facet in &model.set(set).facets {
        facet_pressure(model, facet, pressure, u, |row, force, _| {
            forces[facet.nodes[row / 3] as usize][row % 3] -= force[row % 3];
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
        facet_pressure(model, facet, pressure, u, |row, _, tangent| {
            let Some(local) = dofs.local(dofs.node[facet.nodes[row / 3] as usize][row % 3]) else { return };
            for (column, value) in tangent.iter().enumerate() {
                let equation = dofs.node[facet.nodes[column / 3] as usize][column % 3];
                if equation != NONE {
                    pattern.add(values, local, equation, -value);
                }
            }
        });
    }
}

/// Adds to each local node its share of the areas of the facets, with nodes at reference position plus `u`.
pub fn add_nodal_areas(model: &Model, facets: &[PartFacet], u: &[Vec3], mut add: impl FnMut(u32, f64)) {
    for facet in facets {
        let at = |a: usize| -> [f64; 3] {
            let n = facet.nodes[a] as usize;
            (model.part.points[n] + u[n]).into()
        };
        let quad = |k: usize| load::quad4_nodal_areas(&std::array::from_fn(at))[k];
        let triangle = |k: usize| load::tri3_nodal_areas(&std::array::from_fn(at))[k];
        for k in 0..facet.count as usize {
            add(facet.nodes[k], if facet.count == 3 { triangle(k) } else { quad(k) });
        }
    }
}
