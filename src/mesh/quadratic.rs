//! Quadratic hexahedra and wedges from the linear ones that stand for them.

use super::faces::{HEX_BETWEEN, WEDGE_BETWEEN};
use super::{Mesh, Solid, SolidShape, check, message};
use crate::Vec3;
use crate::error::{Error, Location, Result};

/// Makes one quadratic element of every eight linear ones, of the `shapes` that are asked for: of a block of so many elements each way
/// hexahedra of those that meet in a node, of a file those that were one of second order.
///
/// # Errors
/// At `at`, where the element is asked for: a mesh that is not of such eights; elements that are inside out.
pub fn make_quadratic(mesh: &mut Mesh, block: Option<[usize; 3]>, shapes: &[SolidShape], at: &Location) -> Result<()> {
    let eights = match block {
        Some(counts) => of_block(counts, at)?,
        None => of_file(mesh, shapes, at)?,
    };
    let mut now = vec![u32::MAX; mesh.solids.len()];
    let mut solids = Vec::with_capacity(eights.len());
    for (parts, number) in eights.iter().zip(0..) {
        let (shape, nodes) = whole(|part| &mesh.solids[parts[part]]);
        // Those of a block are numbered anew.
        let id = if block.is_some() { number + 1 } else { mesh.solids[parts[0]].id };
        solids.push(Solid::new(shape, &nodes, id));
        parts.iter().for_each(|&part| now[part] = number as u32);
    }
    let folded = check::spoiled(solids.iter(), |n| Vec3::from(mesh.points[n as usize]));
    if !folded.is_empty() {
        let what = format!("{} folded over as quadratic ones", message::several("element", &folded));
        return Err(message::whole_file(
            &mesh.source,
            what,
            "curve its edges less, or leave `element` out to take eight linear ones each",
        ));
    }
    for group in mesh.groups.values_mut() {
        group.solids.iter_mut().for_each(|solid| *solid = now[*solid as usize]);
        group.solids.sort_unstable();
        group.solids.dedup();
    }
    mesh.solids = solids;
    mesh.has_halves = false;
    Ok(())
}

/// The nodes of the element that has these parts, of which those at its corners are numbered as the corners are: from a corner on its
/// part there goes half way to each other one.
fn whole<'a>(part: impl Fn(usize) -> &'a Solid) -> (SolidShape, Vec<u32>) {
    let (shape, between) = match part(0).shape {
        SolidShape::Wedge6 => (SolidShape::Wedge18, &WEDGE_BETWEEN[..]),
        _ => (SolidShape::Hex27, &HEX_BETWEEN[..]),
    };
    (shape, between.iter().map(|&[from, to]| part(from).nodes[to]).collect())
}

/// By the corners of the new elements, those of a block.
fn of_block(counts: [usize; 3], at: &Location) -> Result<Vec<[usize; 8]>> {
    if counts.iter().any(|count| count % 2 == 1) {
        let what =
            format!("a block of {counts:?} elements cannot have quadratic hexahedra, which take two along each edge");
        return Err(Error::input(at, what, "give even numbers of `elements`"));
    }
    let [nx, ny, nz] = counts;
    let at = |i: usize, j: usize, k: usize| i + nx * (j + ny * k);
    let mut eights = Vec::with_capacity(nx * ny * nz / 8);
    for k in (0..nz).step_by(2) {
        for j in (0..ny).step_by(2) {
            for i in (0..nx).step_by(2) {
                let layer = |k: usize| [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)];
                let [[a, b, c, d], [e, f, g, h]] = [layer(k), layer(k + 1)];
                eights.push([a, b, c, d, e, f, g, h]);
            }
        }
    }
    Ok(eights)
}

/// The same of a file, in which the parts of an element follow each other; those of a wedge at its corners first.
fn of_file(mesh: &Mesh, shapes: &[SolidShape], at: &Location) -> Result<Vec<[usize; 8]>> {
    let mut eights = Vec::with_capacity(mesh.solids.len() / 8);
    for (parts, first) in mesh.solids.chunks(8).zip((0..).step_by(8)) {
        let are_alike = || parts.iter().all(|part| part.shape == parts[0].shape && part.id == parts[0].id);
        let corners = match parts[0].shape {
            SolidShape::Hex8 if shapes.contains(&SolidShape::Hex27) => 8,
            SolidShape::Wedge6 if shapes.contains(&SolidShape::Wedge18) => 6,
            _ => 0,
        };
        // From each corner it is as far half way to another as back.
        let meet = || (0..corners).all(|a| (0..a).all(|b| parts[a].nodes[b] == parts[b].nodes[a]));
        if parts.len() < 8 || corners == 0 || !are_alike() || !meet() {
            let (name, help) = match shapes.contains(&SolidShape::Hex27) {
                true => {
                    ("hexahedron or wedge", "hexahedra of 20 or 27 nodes, and wedges of 15 or 18 among them, alone")
                }
                false => (
                    "wedge",
                    "wedges of 15 or 18 nodes alone, take \"hex27\" where hexahedra of second order are among them",
                ),
            };
            let what = format!("element {} of '{}' is no {name} of second order", parts[0].id, mesh.source);
            return Err(Error::input(at, what, format!("mesh the body with {help}, or leave `element` out")));
        }
        eights.push(std::array::from_fn(|corner| first + corner));
    }
    Ok(eights)
}
