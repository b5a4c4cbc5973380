//! The meshes of the bodies, split as the scene asks.

use super::axisymmetric::put_on_axis;
use crate::Vec3;
use crate::error::{Error, Faults, Result};
use crate::mesh::{self, Mesh, Purpose, SolidShape};
use crate::refine::{self, Curves};
use crate::scene::{Body, Formulation, Located, MeshSource, Scene};
use std::collections::HashMap;
use std::path::PathBuf;

/// The mesh of a body.
pub struct Meshed {
    pub mesh: Mesh,
    /// For each node the one whose displacement it shares.
    pub ties: Vec<u32>,
    /// The highest number of a node of its file; higher ones are of nodes that splitting has made.
    pub last: u64,
}

/// Reads and splits the meshes of all bodies.
///
/// # Errors
/// Meshes that cannot be read, are no layer where one is asked for, cannot be split, or are no sheets where elements ask for one.
pub fn load(scene: &Scene) -> Result<Vec<Meshed>> {
    let mut read: Vec<Meshed> = Faults::all(scene.bodies.iter().map(read))?;
    let mut curves = Vec::new();
    for (body, meshed) in scene.bodies.iter().zip(&read) {
        curves.push(curves_of(scene, body, meshed)?);
    }
    agree(scene, &read, &mut curves);
    for ((body, meshed), curves) in scene.bodies.iter().zip(&mut read).zip(curves) {
        let (Some(times), Some(curves)) = (&body.refine, curves) else { continue };
        let ties = std::mem::take(&mut meshed.ties);
        let is_tied = |a: u32, b: u32| a != b && ties[a as usize] == ties[b as usize];
        meshed.mesh = refine::split(std::mem::take(&mut meshed.mesh), times, &curves, is_tied)?;
        meshed.ties = tie(body, &mut meshed.mesh)?;
    }
    for (body, meshed) in scene.bodies.iter().zip(&mut read) {
        if let Some(asked) = body.element.as_ref().filter(|asked| asked.value == Formulation::Hex8Shell) {
            mesh::lay_flat(&mut meshed.mesh, &asked.at, body.shell.face.as_ref())?;
        }
    }
    Ok(read)
}

/// The mesh of a body as its file has it; a block with its numbers of elements doubled as often as it is to be split.
fn read(body: &Body) -> Result<Meshed> {
    let mut source = body.mesh.clone();
    if let (MeshSource::Block(block), Some(times)) = (&mut source, &body.refine) {
        let split = if body.is_layer() { 2 } else { 3 };
        block.value.elements[..split].iter_mut().for_each(|n| *n = n.saturating_mul(1 << times.value));
    }
    let mut mesh = mesh::load(&source, Purpose::Body)?;
    refuse_hanging(body, &mesh)?;
    if mesh.is_section && !body.is_axisymmetric() {
        let what = format!("the mesh of body `{}` is of axisymmetric elements", body.name.value);
        return Err(Error::input(&body.name.at, what, "add `axisymmetric = true`"));
    }
    let wedges = mesh.solids.iter().filter(|solid| solid.shape == SolidShape::Wedge6).count();
    let quadratic = body.element.as_ref().and_then(|asked| Some((asked, quadratic_of(asked.value)?)));
    if mesh.has_halves && quadratic.is_none() && wedges as f64 > STIFF * mesh.solids.len() as f64 {
        mesh.warnings.push(format!(
            "'{}': wedges of second order become linear ones, eight each, which are too stiff where they bend in few layers: \
             `element = \"wedge18\"` takes a mesh of them alone as such, `\"hex27\"` one with hexahedra of second order",
            mesh.source
        ));
    }
    if let Some((asked, shapes)) = quadratic {
        let block = match &source {
            MeshSource::Block(block) => Some(block.value.elements),
            MeshSource::File { .. } => None,
        };
        if let (None, Some(times)) = (block, &body.refine) {
            let help = "split a mesh of linear elements, or mesh finer";
            return Err(Error::input(&times.at, "meshes of quadratic hexahedra and wedges cannot be split", help));
        }
        mesh::make_quadratic(&mut mesh, block, shapes, &asked.at)?;
    }
    let last = mesh.point_ids.iter().copied().max().unwrap_or(0);
    let ties = tie(body, &mut mesh)?;
    Ok(Meshed { mesh, ties, last })
}

/// The elements that a formulation wants made of linear ones, if any.
fn quadratic_of(asked: Formulation) -> Option<&'static [SolidShape]> {
    match asked {
        Formulation::Hex27 => Some(&[SolidShape::Hex27, SolidShape::Wedge18]),
        Formulation::Wedge18 | Formulation::Wedge18Sri => Some(&[SolidShape::Wedge18]),
        _ => None,
    }
}

/// Share of the elements of a body that may be wedges in the place of ones that bend: a bar of them, two layers, bends by 70 % of
/// what it should, of hexahedra by 98 % (docs/validation/elements.md).
const STIFF: f64 = 0.3;

/// Quadratic elements beside linear ones have nodes in the middle of faces' edges that these do not know of.
fn refuse_hanging(body: &Body, mesh: &Mesh) -> Result<()> {
    let of = |quadratic: bool| mesh.solids.iter().find(|solid| (solid.shape == SolidShape::Tet10) == quadratic);
    let (Some(quadratic), Some(linear)) = (of(true), of(false)) else { return Ok(()) };
    let what = format!(
        "body `{}` has quadratic elements, such as {}, and linear ones, such as {}, which do not fit together",
        body.name.value, quadratic.id, linear.id
    );
    Err(Error::input(&body.name.at, what, "mesh all of the body with the same order, or take a `group` of one kind"))
}

fn tie(body: &Body, mesh: &mut Mesh) -> Result<Vec<u32>> {
    match &body.reduction {
        Some(asked) => {
            if body.is_axisymmetric() {
                put_on_axis(mesh, &asked.at)?;
            }
            mesh::tie_layer(mesh, asked.value.key(), &asked.at)
        }
        None => Ok((0..mesh.points.len() as u32).collect()),
    }
}

/// The curved edges of a body from a file that is to be split.
fn curves_of(scene: &Scene, body: &Body, meshed: &Meshed) -> Result<Option<Curves>> {
    let (Some(times), MeshSource::File { .. }) = (&body.refine, &body.mesh) else { return Ok(None) };
    if meshed.mesh.solids.iter().any(|solid| solid.shape == SolidShape::Tet10) {
        return Ok(Some(refine::of_quadratic(&meshed.mesh)));
    }
    let groups = body.symmetry.iter().filter_map(|set| set.value.split_once('.').map(|(_, group)| group));
    let groups: Vec<&str> = groups.collect();
    let mut curves = refine::of_body(&meshed.mesh, &groups, &scene.controls).map_err(|error| match error {
        Error::Input { at: None, what, help } => {
            let what = format!("the boundary of body `{}` cannot be split: {what}", body.name.value);
            Error::input(&times.at, what, help)
        }
        other => other,
    })?;
    if body.is_layer() {
        flatten(&meshed.mesh, &mut curves);
    }
    Ok(Some(curves))
}

/// In one layer of upright elements both ends of each have the same curves, within their planes.
fn flatten(mesh: &Mesh, curves: &mut Curves) {
    let mut flat = Curves { edges: std::mem::take(&mut curves.edges), ..Curves::default() };
    for solid in mesh.solids.iter().filter(|solid| solid.shape == SolidShape::Hex8) {
        for k in 0..4 {
            let ends = [0, 4].map(|layer| [solid.nodes[layer + k], solid.nodes[layer + (k + 1) % 4]]);
            let sum: Vec3 = ends.iter().filter_map(|[a, b]| curves.at(*a, *b)).sum();
            let c = Vec3::new(0.5 * sum.x, 0.5 * sum.y, 0.0);
            if c != Vec3::zeros() {
                flat.of.extend(ends.map(|[a, b]| ([a.min(b), a.max(b)], c)));
            }
        }
    }
    *curves = flat;
}

/// Bodies of one file that share nodes get the same curves for the edges that both end in, the mean of theirs.
fn agree(scene: &Scene, read: &[Meshed], curves: &mut [Option<Curves>]) {
    let file = |body: &Body| match &body.mesh {
        MeshSource::File { path: Located { value, .. }, .. } => value.canonicalize().ok(),
        MeshSource::Block(_) => None,
    };
    let files: Vec<Option<PathBuf>> = scene.bodies.iter().map(file).collect();
    let of_body = |k: usize| curves[k].as_ref().filter(|_| files[k].is_some());
    if (0..files.len()).filter(|k| of_body(*k).is_some()).count() < 2 {
        return;
    }
    let number = |k: usize, edge: &[u32; 2]| {
        let [a, b] = edge.map(|n| read[k].mesh.point_ids[n as usize]);
        (&files[k], a.min(b), a.max(b))
    };
    // The sum over the bodies whose boundary an edge is on, and how many these are.
    let mut shared: HashMap<_, (Vec3, f64)> = HashMap::new();
    for k in 0..files.len() {
        let Some(curves) = of_body(k) else { continue };
        for edge in &curves.edges {
            let entry = shared.entry(number(k, edge)).or_default();
            entry.0 += curves.of.get(edge).copied().unwrap_or_default();
            entry.1 += 1.0;
        }
    }
    let mut means: Vec<Vec<([u32; 2], Vec3)>> = vec![Vec::new(); files.len()];
    for k in 0..files.len() {
        let Some(curves) = of_body(k) else { continue };
        for edge in &curves.edges {
            if let Some((sum, count)) = shared.get(&number(k, edge)).filter(|(_, count)| *count > 1.0) {
                means[k].push((*edge, sum / *count));
            }
        }
    }
    for (curves, means) in curves.iter_mut().zip(means) {
        if let Some(curves) = curves {
            curves.of.extend(means);
        }
    }
}
