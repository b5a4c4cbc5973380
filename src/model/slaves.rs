//! Slaves of contacts are nodes of faces. A group of nodes and one of faces that have one name are one group, whose other nodes
//! have no area.

use super::assemble::{set_of, with_shapes};
use crate::error::{Error, Faults, Result};
use crate::mesh::SolidShape;
use crate::partition::GlobalMesh;
use crate::scene::{Located, Scene, body_of};
use std::collections::BTreeSet;

/// # Errors
/// Nodes of a slave on none of its faces.
pub(super) fn check(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
    let quadratic = with_shapes(scene, global, &[SolidShape::Tet10]);
    Faults::all(scene.contacts.iter().map(|contact| {
        let name = &contact.slave;
        let Some(set) = set_of(names, global, &name.value) else { return Ok(()) };
        let on_faces: BTreeSet<u32> = set.facets.iter().flat_map(|facet| facet.nodes()).copied().collect();
        let off = set.nodes.iter().filter(|n| !on_faces.contains(n)).count();
        if off == 0 || set.facets.is_empty() || quadratic.contains(body_of(&name.value)) {
            return Ok(());
        }
        let what =
            format!("`{}` has {off} nodes that are on none of its faces, and {} that are", name.value, on_faces.len());
        Err(Error::input(
            &name.at,
            what,
            "name a group of these faces alone; a group of nodes of the same name is added to it",
        ))
    }))
    .map(|_: Vec<()>| ())
}
