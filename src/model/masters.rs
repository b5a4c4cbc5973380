//! The surfaces of bodies that are masters, as they are made on rank 0.

use super::symmetry::{self, SymmetryPlane};
use crate::Vec3;
use crate::contact::{Avoided, self_contact};
use crate::error::Result;
use crate::mesh::{Facet, Mesh};
use crate::partition::GlobalMesh;
use crate::scene::{self, Discretization, Located, Scene};
use crate::surface::{MovingPatch, Smoothing};
use std::collections::BTreeMap;

/// Patches, and what nodes avoid by their numbers.
pub type MasterPatches = (Vec<MovingPatch>, BTreeMap<u64, Avoided>);

/// The patches of each deformable master, and in self-contact what its nodes avoid, on rank 0, which has the mesh and the
/// numbers of its nodes over all ranks.
///
/// # Errors
/// Faces that make no surface.
pub fn master_patches(
    scene: &Scene,
    names: &[Located<String>],
    planes: &[SymmetryPlane],
    mesh: Option<&GlobalMesh>,
    numbers: &[u64],
) -> Result<Vec<MasterPatches>> {
    let passes = scene.passes();
    let masters = passes.iter().filter_map(|c| c.surface.map(|given| (c, given)));
    masters.map(|(contact, given)| of_master(scene, names, (contact, given), planes, mesh, numbers)).collect()
}

/// Those of one.
fn of_master(
    scene: &Scene,
    names: &[Located<String>],
    (contact, given): (&scene::Contact, scene::MasterSurface),
    planes: &[SymmetryPlane],
    mesh: Option<&GlobalMesh>,
    numbers: &[u64],
) -> Result<MasterPatches> {
    let master = &contact.master;
    let (Some(mesh), Some(set)) = (mesh, names.iter().position(|n| n.value == master.value)) else {
        return Ok(Default::default());
    };
    let facets = &mesh.sets[set].facets;
    let mut nodes: Vec<u32> = facets.iter().flat_map(|f| &f.nodes[..f.count as usize]).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |n: u32| nodes.binary_search(&n).map_or(0, |k| k as u32);
    let surface = Mesh {
        source: master.value.clone(),
        points: nodes.iter().map(|&n| mesh.points[n as usize].into()).collect(),
        point_ids: nodes.iter().map(|&n| mesh.id[n as usize]).collect(),
        facets: facets.iter().map(|f| Facet { count: f.count, nodes: f.nodes.map(place), id: f.id }).collect(),
        ..Mesh::default()
    };
    let of_corners: Vec<u64> = nodes.iter().map(|&n| numbers[n as usize]).collect();
    let is_quadratic = facets.iter().any(|facet| mesh.middles.of(facet.nodes()).is_some());
    let smoothing = if is_quadratic { Smoothing::Facet } else { given.smoothing };
    let mut planes = symmetry::planes_of(planes, &master.value, &surface.points);
    let is_axis = (Vec3::zeros(), Vec3::x());
    if scene.is_axisymmetric()
        && surface.points.iter().any(|x| x[0] == 0.0)
        && planes.iter().all(|(_, normal)| normal.x == 0.0)
    {
        planes.push(is_axis);
    }
    let mut patches =
        MovingPatch::all(&surface, &of_corners, smoothing, given.feature_angle, &planes, &scene.controls)?;
    for (patch, facet) in patches.iter_mut().zip(facets) {
        patch.component = mesh.component[facet.nodes[0] as usize];
        if let Some(middles) = mesh.middles.of(facet.nodes()) {
            patch.bend_through(middles.map(|n| numbers[n as usize]));
        }
    }
    if contact.discretization == Discretization::TwoPass {
        patches.iter_mut().for_each(|patch| patch.bulge = scene.controls.two_pass_bulge);
    }
    let points: BTreeMap<u64, Vec3> =
        of_corners.into_iter().zip(surface.points.iter().map(|x| Vec3::from(*x))).collect();
    let avoided = if contact.is_self() {
        self_contact::avoided(&patches, &scene.controls, |n| points[&n])
    } else {
        BTreeMap::new()
    };
    Ok((patches, avoided))
}
