//! The surfaces of bodies, as they are made on rank 0: of masters, and of slaves that are smooth as these.

use super::assemble::set_of;
use super::symmetry::{self, SymmetryPlane};
use crate::Vec3;
use crate::contact::{Avoided, segment::heights, self_contact};
use crate::error::{Error, Result};
use crate::mesh::{Facet, Mesh, Quarters};
use crate::partition::{GlobalFacet, GlobalMesh};
use crate::scene::{self, Description, Discretization, Located, Scene};
use crate::surface::{MovingPatch, Patch, Smoothing};
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
    let (Some(mesh), Some(set)) = (mesh, mesh.and_then(|mesh| set_of(names, mesh, &master.value))) else {
        return Ok(Default::default());
    };
    let facets = &set.facets;
    let (surface, nodes) = surface(mesh, facets, &master.value);
    let of_corners: Vec<u64> = nodes.iter().map(|&n| numbers[n as usize]).collect();
    // Quadratic faces keep their own shape, too, unless nodes meet nodes.
    let quarters = match contact.discretization {
        Discretization::NodeToNode => Quarters::default(),
        _ => Quarters::in_solids(mesh.solids.iter(), facets.iter().map(GlobalFacet::nodes)),
    };
    let smoothing = match contact.discretization {
        _ if is_quadratic(mesh, facets) || !quarters.is_empty() => Smoothing::Facet,
        // Nodes have nodal normals, whatever is between them.
        Discretization::NodeToNode => Smoothing::Nagata,
        _ => given.smoothing,
    };
    let mirrored = mirrors(scene, planes, &master.value, &surface);
    let mut patches =
        MovingPatch::all(&surface, &of_corners, smoothing, given.feature_angle, &mirrored, &scene.controls)?;
    for (patch, facet) in patches.iter_mut().zip(facets) {
        patch.component = mesh.component[facet.nodes[0] as usize];
        if let Some(middles) = mesh.middles.of(facet.nodes()) {
            patch.bend_through(middles.map(|n| numbers[n as usize]));
        }
        if let Some(whole) = quarters.of(facet.nodes()) {
            patch.bend_as_quarter(&whole.iter().map(|&n| numbers[n as usize]).collect::<Vec<_>>());
        }
    }
    let bulges = smoothing == Smoothing::Nagata || !quarters.is_empty();
    let bulges_twice = contact.discretization == Discretization::TwoPass && bulges;
    if bulges_twice && !fit(scene, names, (contact, given), planes, mesh)? {
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

/// Whether one side of a contact is hollow in the initial mesh and the other is round, as a bore and its shaft: they may touch all
/// over, and by little more than a share of what they bulge by.
fn fit(
    scene: &Scene,
    names: &[Located<String>],
    (contact, given): (&scene::Contact, scene::MasterSurface),
    planes: &[SymmetryPlane],
    mesh: &GlobalMesh,
) -> Result<bool> {
    /// Over the size of a facet: coordinates of mesh files are as exact as that.
    const FLAT: f64 = 1e-6;
    let mut sides = [0.0; 2];
    for (side, name) in sides.iter_mut().zip([&contact.slave, &contact.master]) {
        let Some(set) = set_of(names, mesh, &name.value).filter(|set| !is_quadratic(mesh, &set.facets)) else {
            return Ok(false);
        };
        let (surface, _) = surface(mesh, &set.facets, &name.value);
        let planes = mirrors(scene, planes, &name.value, &surface);
        let shapes = initial_shapes(scene, &surface, given.feature_angle, &planes)?;
        let size = |shape: &Patch| (shape.nodes[1] - shape.nodes[0]).norm();
        let bulge: f64 = shapes.iter().flat_map(heights).sum();
        let flat = FLAT * shapes.iter().map(size).sum::<f64>();
        *side = if bulge.abs() > flat { bulge } else { 0.0 };
    }
    Ok(sides[0] * sides[1] < 0.0)
}

/// The smooth faces of a surface as they are meshed.
fn initial_shapes(scene: &Scene, surface: &Mesh, feature_angle: f64, planes: &[(Vec3, Vec3)]) -> Result<Vec<Patch>> {
    let places: Vec<u64> = (0..surface.points.len() as u64).collect();
    let patches = MovingPatch::all(surface, &places, Smoothing::Nagata, feature_angle, planes, &scene.controls)?;
    let shape = |patch: &MovingPatch| {
        let places: Vec<Vec3> = patch.nodes.iter().map(|&n| Vec3::from(surface.points[n as usize])).collect();
        patch.shape(&places)
    };
    Ok(patches.iter().map(shape).collect())
}

/// The patches over the faces of slaves that are smooth where their points count, on rank 0: of each pass that of each facet, none
/// where faces are flat as they are meshed.
///
/// # Errors
/// Faces that make no surface, or that were to follow their nodes under facets.
pub fn slave_patches(
    scene: &Scene,
    names: &[Located<String>],
    planes: &[SymmetryPlane],
    mesh: Option<&GlobalMesh>,
    numbers: &[u64],
) -> Result<Vec<Vec<MovingPatch>>> {
    scene.passes().iter().map(|contact| of_slave(scene, names, contact, planes, mesh, numbers)).collect()
}

/// Those of one contact: from segment to segment, unless the master has facets, too.
fn of_slave(
    scene: &Scene,
    names: &[Located<String>],
    contact: &scene::Contact,
    planes: &[SymmetryPlane],
    mesh: Option<&GlobalMesh>,
    numbers: &[u64],
) -> Result<Vec<MovingPatch>> {
    let slave = &contact.slave;
    let tool = scene.tools.iter().find(|tool| tool.name.value == contact.master.value);
    let faceted = match (contact.surface, tool) {
        (Some(given), _) => given.smoothing == Smoothing::Facet,
        (None, tool) => tool.is_none_or(|tool| tool.smoothing.value == Description::Mesh(Smoothing::Facet)),
    };
    let (Some(mesh), Some(set)) = (mesh, mesh.and_then(|mesh| set_of(names, mesh, &slave.value))) else {
        return Ok(Vec::new());
    };
    if faceted && contact.slave_follows {
        let what = format!(
            "contact `{}`: `slave_curvature = \"deformed\"` means nothing under a master of facets",
            contact.name.value
        );
        return Err(Error::input(&contact.slave.at, what, "smooth the master, or remove it"));
    }
    if faceted || contact.discretization != Discretization::Segment {
        return Ok(Vec::new());
    }
    // Quadratic faces have their own shape.
    let quarters = Quarters::in_solids(mesh.solids.iter(), set.facets.iter().map(GlobalFacet::nodes));
    if is_quadratic(mesh, &set.facets) || !quarters.is_empty() {
        return Ok(Vec::new());
    }
    let (surface, nodes) = surface(mesh, &set.facets, &slave.value);
    let numbers: Vec<u64> = nodes.iter().map(|&n| numbers[n as usize]).collect();
    let planes = mirrors(scene, planes, &slave.value, &surface);
    MovingPatch::all(&surface, &numbers, Smoothing::Nagata, contact.slave_feature_angle(), &planes, &scene.controls)
}

/// Some of these facets are sides of quadratic elements.
fn is_quadratic(mesh: &GlobalMesh, facets: &[GlobalFacet]) -> bool {
    facets.iter().any(|facet| mesh.middles.of(facet.nodes()).is_some())
}

/// The surface of some facets, with the nodes of the mesh that its points are.
fn surface(mesh: &GlobalMesh, facets: &[GlobalFacet], name: &str) -> (Mesh, Vec<u32>) {
    let mut nodes: Vec<u32> = facets.iter().flat_map(|f| f.nodes()).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let place = |n: u32| nodes.binary_search(&n).map_or(0, |k| k as u32);
    let surface = Mesh {
        source: name.to_string(),
        points: nodes.iter().map(|&n| mesh.points[n as usize].into()).collect(),
        point_ids: nodes.iter().map(|&n| mesh.id[n as usize]).collect(),
        facets: facets.iter().map(|f| Facet { count: f.count, nodes: f.nodes.map(place), id: f.id }).collect(),
        ..Mesh::default()
    };
    (surface, nodes)
}

/// The planes in which a surface goes on as its mirror image: those of symmetry that it ends in, and around the axis.
fn mirrors(scene: &Scene, planes: &[SymmetryPlane], set: &str, surface: &Mesh) -> Vec<(Vec3, Vec3)> {
    let mut planes = symmetry::planes_of(planes, set, &surface.points);
    let is_axis = (Vec3::zeros(), Vec3::x());
    if scene.is_axisymmetric()
        && surface.points.iter().any(|x| x[0] == 0.0)
        && planes.iter().all(|(_, normal)| normal.x == 0.0)
    {
        planes.push(is_axis);
    }
    planes
}
