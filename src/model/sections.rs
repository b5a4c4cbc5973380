//! Which elements and nodes of a body are of which of its materials.

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::scene::{Body, MaterialModel, Scene, did_you_mean};

/// Sections of a body's mesh, numbered from 0 in the order of [`Body::sections`].
pub(super) struct Sections {
    /// Of each element.
    pub solids: Vec<u32>,
    /// Of each node: of those around it the stiffest.
    pub nodes: Vec<u32>,
}

impl Sections {
    /// Of a body with this mesh.
    ///
    /// # Errors
    /// A group that the mesh has not, without elements, or one that shares elements with another.
    pub fn new(scene: &Scene, body: &Body, mesh: &Mesh) -> Result<Self> {
        let solids = of_solids(body, mesh)?;
        let young = |name: &str| scene.material(name).map_or(0.0, MaterialModel::young);
        let young: Vec<f64> = body.sections().map(|name| young(&name.value)).collect();
        let mut nodes: Vec<Option<u32>> = vec![None; mesh.points.len()];
        for (solid, &section) in mesh.solids.iter().zip(&solids) {
            for &n in solid.nodes() {
                let of_node = nodes[n as usize].get_or_insert(section);
                if young[section as usize] > young[*of_node as usize] {
                    *of_node = section;
                }
            }
        }
        Ok(Self { solids, nodes: nodes.into_iter().map(Option::unwrap_or_default).collect() })
    }
}

/// The section of each element: 0, or that of a group with a material of its own.
///
/// # Errors
/// A group that the mesh has not, without elements, or one that shares elements with another.
fn of_solids(body: &Body, mesh: &Mesh) -> Result<Vec<u32>> {
    let mut sections = vec![0; mesh.solids.len()];
    let with_elements = || mesh.groups.iter().filter(|(_, group)| !group.solids.is_empty()).map(|(name, _)| name);
    for (section, (name, _)) in (1..).zip(&body.materials) {
        let elements = mesh.groups.get(&name.value).map_or(&[][..], |group| &group.solids);
        if elements.is_empty() {
            let what = format!("body `{}` has no group `{}` of elements", body.name.value, name.value);
            return Err(Error::input(&name.at, what, did_you_mean(&name.value, with_elements().map(String::as_str))));
        }
        for &element in elements {
            let known = std::mem::replace(&mut sections[element as usize], section);
            if known > 0 {
                let id = mesh.solids[element as usize].id;
                let (other, _) = &body.materials[known as usize - 1];
                let what = format!("element {id} is in group `{}` and in group `{}`", other.value, name.value);
                return Err(Error::input(&name.at, what, "name groups that share no elements"));
            }
        }
    }
    Ok(sections)
}
