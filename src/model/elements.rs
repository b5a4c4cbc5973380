//! Elements of a model: their evaluation, and what follows from one state of displacements.

use super::Model;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::failure::Cause;
use crate::mesh::{MOST_NODES, SolidShape};
use crate::partition::{PartFacet, PartSolid};
use crate::scene::Reduction;
use crate::solid::element::{
    ElementMatrices, Formulation, Inverted, Medium, Sample, hex8, hex8_eas, hex8_fbar, hex8_shell, hex8_sri, hex27,
    plane4, pyramid5, pyramid5_sri, ring4, tet4, tet10, tet10_sri, wedge6, wedge6_sri, wedge18, wedge18_sri,
};
use crate::solid::load;
use crate::solid::material::strain_between;
use std::ops::Deref;

/// Matrices of one element, made once for a sweep over all.
#[derive(Default)]
pub struct Scratch {
    pub of_eight: ElementMatrices<24>,
    pub of_four: ElementMatrices<12>,
    pub of_five: ElementMatrices<15>,
    pub of_six: ElementMatrices<18>,
    pub of_ten: ElementMatrices<30>,
    pub of_18: ElementMatrices<54>,
    pub of_27: ElementMatrices<81>,
}

/// Nodes of an element that carry it: all, but of a layer the lower four.
pub fn carrying<'a>(model: &Model, solid: &'a PartSolid) -> &'a [u32] {
    let four = solid.shape == SolidShape::Tet4 || model.is_of_layer(solid);
    if four { &solid.nodes[..4] } else { solid.nodes() }
}

impl Scratch {
    /// Evaluates element `e` of the part at displacements `u`.
    pub fn evaluate(&mut self, model: &Model, e: usize, u: &[Vec3], want_tangent: bool) -> Outcome {
        let solid = &model.part.solids[e];
        let element = model.section(solid).element.beside(solid.shape);
        let (points, medium) = (&model.part.points, medium(model, e));
        if let Some(reduction) = model.bodies[solid.body as usize].reduction {
            let (nodes, how) = ((&gather(points, solid), &gather(u, solid)), (want_tangent, element));
            return match reduction {
                Reduction::PlaneStrain => {
                    plane4::evaluate(nodes, thickness(model, solid), medium, how, &mut self.of_four)
                }
                Reduction::Axisymmetric => ring4::evaluate(nodes, medium, how, &mut self.of_four),
            };
        }
        match solid.shape {
            SolidShape::Tet4 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                tet4::evaluate(&x, &u, medium, want_tangent, &mut self.of_four)
            }
            SolidShape::Tet10 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate = if element == Formulation::Tet10 { tet10::evaluate } else { tet10_sri::evaluate };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_ten)
            }
            SolidShape::Wedge6 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate = if element == Formulation::Wedge6 { wedge6::evaluate } else { wedge6_sri::evaluate };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_six)
            }
            SolidShape::Pyramid5 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate =
                    if element == Formulation::Pyramid5 { pyramid5::evaluate } else { pyramid5_sri::evaluate };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_five)
            }
            SolidShape::Wedge18 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate = if element == Formulation::Wedge18 { wedge18::evaluate } else { wedge18_sri::evaluate };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_18)
            }
            SolidShape::Hex27 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                hex27::evaluate(&x, &u, medium, want_tangent, &mut self.of_27)
            }
            SolidShape::Hex8 => {
                let (x, u) = (gather(points, solid), gather(u, solid));
                let evaluate = match element {
                    Formulation::Hex8Shell => {
                        let layers = model.section(solid).layers;
                        return hex8_shell::evaluate((&x, &u), layers, medium, want_tangent, &mut self.of_eight);
                    }
                    Formulation::Hex8Fbar => hex8_fbar::evaluate,
                    Formulation::Hex8Sri => hex8_sri::evaluate,
                    Formulation::Hex8Eas => hex8_eas::evaluate,
                    _ => hex8::evaluate,
                };
                evaluate(&x, &u, medium, want_tangent, &mut self.of_eight)
            }
        }
    }

    /// Keeps the amplitudes at the tangent of element `e`, the last one.
    pub fn keep(&self, model: &mut Model, e: usize) {
        let four = model.is_of_layer(&model.part.solids[e]);
        if let Some(kept) = model.history.amplitudes_mut(e) {
            kept.clone_from(if four { &self.of_four.amplitudes } else { &self.of_eight.amplitudes });
        }
    }

    /// Internal forces of the last element, which so many nodes carry.
    pub fn forces(&self, nodes: usize) -> &[[f64; 3]] {
        let flat: &[f64] = match nodes {
            4 => &self.of_four.residual,
            5 => &self.of_five.residual,
            6 => &self.of_six.residual,
            10 => &self.of_ten.residual,
            18 => &self.of_18.residual,
            27 => &self.of_27.residual,
            _ => &self.of_eight.residual,
        };
        flat.as_chunks().0
    }

    /// A row of its tangent.
    pub fn row(&self, nodes: usize, row: usize) -> &[f64] {
        match nodes {
            4 => &self.of_four.tangent[row],
            5 => &self.of_five.tangent[row],
            6 => &self.of_six.tangent[row],
            10 => &self.of_ten.tangent[row],
            18 => &self.of_18.tangent[row],
            27 => &self.of_27.tangent[row],
            _ => &self.of_eight.tangent[row],
        }
    }
}

/// What fills element `e` of the part.
pub fn medium(model: &Model, e: usize) -> Medium<'_> {
    let material = &model.section(&model.part.solids[e]).material;
    Medium { material, states: model.history.of(e), amplitudes: model.history.amplitudes(e) }
}

/// Thickness of an element of a layer.
fn thickness(model: &Model, solid: &PartSolid) -> f64 {
    let z = |a: usize| model.part.points[solid.nodes[a] as usize].z;
    z(4) - z(0)
}

/// The integration points of one element.
pub struct Samples {
    few: [Sample; hex8::POINTS],
    count: usize,
    /// In the place of the few, of elements that may have more than these.
    many: Vec<Sample>,
}

impl<const Q: usize> From<[Sample; Q]> for Samples {
    fn from(points: [Sample; Q]) -> Self {
        Self { few: std::array::from_fn(|q| points[q.min(Q - 1)]), count: Q, many: Vec::new() }
    }
}

impl From<Vec<Sample>> for Samples {
    fn from(many: Vec<Sample>) -> Self {
        Self { few: [many[0]; hex8::POINTS], count: 0, many }
    }
}

impl Deref for Samples {
    type Target = [Sample];

    fn deref(&self) -> &[Sample] {
        if self.many.is_empty() { &self.few[..self.count] } else { &self.many }
    }
}

/// The integration points of element `e` of the part at displacements `u`.
pub fn samples(model: &Model, e: usize, u: &[Vec3]) -> Result<Samples, Inverted> {
    let solid = &model.part.solids[e];
    let (element, points) = (model.section(solid).element.beside(solid.shape), &model.part.points);
    let medium = medium(model, e);
    if let Some(reduction) = model.bodies[solid.body as usize].reduction {
        let nodes = (&gather(points, solid), &gather(u, solid));
        return Ok(match reduction {
            Reduction::PlaneStrain => plane4::samples(nodes, thickness(model, solid), medium, element)?.into(),
            Reduction::Axisymmetric => ring4::samples(nodes, element)?.into(),
        });
    }
    Ok(match element {
        Formulation::Hex8 => hex8::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Hex8Fbar => hex8_fbar::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Hex8Sri => hex8_sri::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Hex8Eas => hex8_eas::samples(&gather(points, solid), &gather(u, solid), medium)?.into(),
        Formulation::Hex8Shell => {
            let nodes = (&gather(points, solid), &gather(u, solid));
            hex8_shell::samples(nodes, model.section(solid).layers, medium)?.into()
        }
        Formulation::Hex27 => hex27::samples(&gather(points, solid), &gather(u, solid))?.to_vec().into(),
        Formulation::Wedge18 => wedge18::samples(&gather(points, solid), &gather(u, solid))?.to_vec().into(),
        Formulation::Wedge18Sri => wedge18_sri::samples(&gather(points, solid), &gather(u, solid))?.to_vec().into(),
        Formulation::Wedge6 => wedge6::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Wedge6Sri => wedge6_sri::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Pyramid5 => pyramid5::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Pyramid5Sri => pyramid5_sri::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Tet4 => tet4::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Tet10 => tet10::samples(&gather(points, solid), &gather(u, solid))?.into(),
        Formulation::Tet10Sri => tet10_sri::samples(&gather(points, solid), &gather(u, solid))?.into(),
    })
}

/// Whether an element could be evaluated.
pub type Outcome = std::result::Result<(), Inverted>;

/// Node vectors of an element.
pub(super) fn gather<const N: usize>(field: &[Vec3], solid: &PartSolid) -> [[f64; 3]; N] {
    std::array::from_fn(|a| field[solid.nodes[a] as usize].into())
}

/// Whether an element of this rank is inverted at displacements `u`, or, if asked for, one with enhanced strain has no
/// solution for it.
pub fn any_inverted(model: &Model, u: &[Vec3], solve: bool) -> bool {
    model.part.solids.iter().enumerate().any(|(e, solid)| {
        let inverted = match solid.shape {
            SolidShape::Tet4 => tet4::volume(&moved(model, solid, u)) <= 0.0,
            SolidShape::Tet10 => tet10::min_jacobian(&moved(model, solid, u)) <= 0.0,
            SolidShape::Hex8 => hex8::min_jacobian(&moved(model, solid, u)) <= 0.0,
            SolidShape::Wedge6 => wedge6::min_jacobian(&moved(model, solid, u)) <= 0.0,
            SolidShape::Pyramid5 => pyramid5::min_jacobian(&moved(model, solid, u)) <= 0.0,
            SolidShape::Wedge18 => wedge18::min_jacobian(&moved(model, solid, u)) <= 0.0,
            SolidShape::Hex27 => hex27::min_jacobian(&moved(model, solid, u)) <= 0.0,
        };
        inverted || solve && model.history.amplitudes(e).is_some() && samples(model, e, u).is_err()
    })
}

/// The first element of this rank that folds over at a node between two states of displacements, in words: that is positive
/// there before, and is not after. Linear tetrahedra cannot, and of quadratic ones that is not asked.
pub fn folded(model: &Model, before: &[Vec3], after: &[Vec3]) -> Option<String> {
    fn folds<const N: usize>(jacobians: [[f64; N]; 2]) -> bool {
        let [before, after] = jacobians;
        before.into_iter().zip(after).any(|(before, after)| before > 0.0 && after <= 0.0)
    }
    let states = [before, after];
    let folds = |solid: &&PartSolid| match solid.shape {
        SolidShape::Hex8 => folds(states.map(|u| hex8::nodal_jacobians(&moved(model, solid, u)))),
        SolidShape::Wedge6 => folds(states.map(|u| wedge6::nodal_jacobians(&moved(model, solid, u)))),
        SolidShape::Pyramid5 => folds(states.map(|u| pyramid5::nodal_jacobians(&moved(model, solid, u)))),
        SolidShape::Wedge18 => folds(states.map(|u| wedge18::nodal_jacobians(&moved(model, solid, u)))),
        SolidShape::Hex27 => folds(states.map(|u| hex27::nodal_jacobians(&moved(model, solid, u)))),
        SolidShape::Tet4 | SolidShape::Tet10 => false,
    };
    model.part.solids.iter().find(folds).map(|solid| element_name(model, solid))
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
            for i in 0..if model.is_of_layer(solid) { 2 } else { 3 } {
                diagonal[n as usize][i] += scratch.row(nodes.len(), 3 * a + i)[3 * a + i];
            }
        }
    }
    diagonal.truncate(model.part.owned);
    // A direction without stiffness is one that is not modelled; a node without any is tied to another.
    let smallest = |d: &[f64; 3]| d.iter().copied().filter(|&k| k > 0.0).reduce(f64::min).unwrap_or(0.0);
    Ok(diagonal.iter().map(smallest).collect())
}

/// Largest principal logarithmic strain between two states of displacements, of what this rank counts; infinite where an
/// element is inverted.
pub fn largest_strain(model: &Model, before: &[Vec3], after: &[Vec3]) -> f64 {
    let of = |e: usize| {
        let (before, after) = (samples(model, e, before).ok()?, samples(model, e, after).ok()?);
        let mut strains = before.iter().zip(after.iter()).map(|(from, to)| strain_between(&from.f, &to.f));
        strains.try_fold(0.0, |most: f64, strain| Some(most.max(strain?)))
    };
    mine(model).map(|e| of(e).unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
}

/// The elements that this rank counts.
pub fn mine(model: &Model) -> impl Iterator<Item = usize> + '_ {
    model.part.solids.iter().enumerate().filter(|(_, solid)| solid.mine).map(|(e, _)| e)
}

/// Those of a body.
pub fn of_body(model: &Model, body: usize) -> impl Iterator<Item = usize> + '_ {
    mine(model).filter(move |&e| model.part.solids[e].body as usize == body)
}

/// Nodal forces of a force per reference volume on an element.
pub fn body_force(model: &Model, solid: &PartSolid, per_volume: &Vec3) -> [Vec3; MOST_NODES] {
    let mut forces = [Vec3::zeros(); MOST_NODES];
    let mut set = |flat: &[f64]| {
        for (force, values) in forces.iter_mut().zip(flat.as_chunks::<3>().0) {
            *force = Vec3::from(*values);
        }
    };
    if model.is_axisymmetric() {
        let of_ring = ring4::body_force(&gather(&model.part.points, solid), [per_volume.x, per_volume.y]);
        for (force, [x, y]) in forces.iter_mut().zip(of_ring) {
            *force = Vec3::new(x, y, 0.0);
        }
        return forces;
    }
    match solid.shape {
        SolidShape::Tet4 => set(&tet4::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Tet10 => set(&tet10::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Hex8 => set(&hex8::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Pyramid5 => set(&pyramid5::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Wedge18 => set(&wedge18::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Hex27 => set(&hex27::body_force(&gather(&model.part.points, solid), *per_volume)),
        SolidShape::Wedge6 => set(&wedge6::body_force(&gather(&model.part.points, solid), *per_volume)),
    }
    forces
}

/// Pressure load on a facet with these nodes: nodal forces and d(force)/d(position), in 3x3 blocks of rows and columns of them.
pub fn facet_pressure(
    model: &Model,
    nodes: &[u32],
    pressure: f64,
    u: &[Vec3],
    mut each: impl FnMut(usize, &[f64; 3], &[f64]),
) {
    let at = |a: usize| -> [f64; 3] {
        let n = nodes[a] as usize;
        (model.part.points[n] + u[n]).into()
    };
    let mut pass = |force: &[f64], row: usize, tangent: &[f64]| each(row, &force.as_chunks::<3>().0[row / 3], tangent);
    match nodes.len() {
        3 => {
            let load = load::tri3_pressure(&std::array::from_fn(at), pressure);
            load.tangent.iter().enumerate().for_each(|(row, tangent)| pass(&load.force, row, tangent));
        }
        6 => {
            let load = load::tri6_pressure(&std::array::from_fn(at), pressure);
            load.tangent.iter().enumerate().for_each(|(row, tangent)| pass(&load.force, row, tangent));
        }
        9 => {
            let load = load::quarter_pressure(&std::array::from_fn(at), pressure);
            load.tangent.iter().enumerate().for_each(|(row, tangent)| pass(&load.force, row, tangent));
        }
        _ => {
            let load = match model.is_axisymmetric() {
                true => load::ring_pressure(&std::array::from_fn(at), pressure),
                false => load::quad4_pressure(&std::array::from_fn(at), pressure),
            };
            load.tangent.iter().enumerate().for_each(|(row, tangent)| pass(&load.force, row, tangent));
        }
    }
}

/// Adds to each local node its share of the areas of the facets, with nodes at reference position plus `u`.
pub fn add_nodal_areas(model: &Model, facets: &[PartFacet], u: &[Vec3], mut add: impl FnMut(u32, f64)) {
    for facet in facets {
        let nodes = model.part.face_nodes(facet);
        nodes.iter().zip(nodal_areas(model, &nodes, u)).for_each(|(&n, area)| add(n, nodes.share * area));
    }
}

/// The parts of the area of a facet with these nodes that belong to them, at reference position plus `u`; of an axisymmetric body
/// those of the ring that the facet is turned to.
pub fn nodal_areas(model: &Model, nodes: &[u32], u: &[Vec3]) -> [f64; 9] {
    let at = |a: usize| -> [f64; 3] {
        let n = nodes[a] as usize;
        (model.part.points[n] + u[n]).into()
    };
    let mut areas = [0.0; 9];
    match nodes.len() {
        3 => areas[..3].copy_from_slice(&load::tri3_nodal_areas(&std::array::from_fn(at))),
        6 => areas[..6].copy_from_slice(&load::tri6_nodal_areas(&std::array::from_fn(at))),
        9 => areas = load::quarter_nodal_areas(&std::array::from_fn(at)),
        _ if model.is_axisymmetric() => areas[..4].copy_from_slice(&load::ring_nodal_areas(&std::array::from_fn(at))),
        _ => areas[..4].copy_from_slice(&load::quad4_nodal_areas(&std::array::from_fn(at))),
    }
    areas
}

/// What is said of an element that has no stress in a state that has converged.
pub fn lost(model: &Model, e: usize) -> Error {
    let name = element_name(model, &model.part.solids[e]);
    Error::diverged(Cause::Element, format!("{name} has turned inside out in the converged state"))
}

fn element_name(model: &Model, solid: &PartSolid) -> String {
    format!("element {} of body `{}`", solid.id, model.bodies[solid.body as usize].name)
}
