//! Which elements and nodes of a body are of which of its materials, and what elements they have.

use crate::error::{Error, Result};
use crate::mesh::{Mesh, SolidShape, message};
use crate::parallel::max;
use crate::partition::Part;
use crate::scene::{Body, Formulation, MaterialModel, Scene};
use crate::solid::element::{hex8, hex8_shell, hex27, plane4, pyramid5, tet4, tet10, wedge6, wedge18};
use crate::solid::material::Material;
use mpi::topology::SimpleCommunicator;

/// Elements of a body that are of one material.
#[derive(Clone, Debug)]
pub struct Section {
    pub body: usize,
    pub material: Material,
    /// Of the first of the shapes that it has; others have what goes with it, [`Formulation::beside`].
    pub element: Formulation,
    /// What fills in between these: wedges, pyramids and linear tetrahedra.
    pub fillers: Vec<SolidShape>,
    /// Points through the thickness of solid-shell elements.
    pub layers: usize,
    /// As of bodies, at the nodes that count as the section's.
    pub stiffness: f64,
}

impl Section {
    /// Integration points of an element of the section that have states.
    pub(super) fn points_with_memory(&self, shape: SolidShape, is_layer: bool) -> usize {
        match shape {
            _ if !self.material.remembers() => 0,
            _ if is_layer => plane4::POINTS,
            SolidShape::Hex8 if self.element == Formulation::Hex8Shell => hex8_shell::POINTS * self.layers,
            SolidShape::Hex8 => hex8::POINTS,
            SolidShape::Wedge6 => wedge6::POINTS,
            SolidShape::Pyramid5 => pyramid5::POINTS,
            SolidShape::Tet4 => tet4::POINTS,
            SolidShape::Tet10 => tet10::POINTS,
            SolidShape::Wedge18 => wedge18::POINTS,
            SolidShape::Hex27 => hex27::POINTS,
        }
    }
}

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
    for (section, (name, _)) in (1..).zip(&body.materials) {
        let elements = mesh.groups.get(&name.value).map_or(&[][..], |group| &group.solids);
        if elements.is_empty() {
            let what = format!("body `{}` has no group `{}` of elements", body.name.value, name.value);
            let help = message::help_on_group(&name.value, &mesh.groups, |group| !group.solids.is_empty());
            return Err(Error::input(&name.at, what, help));
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

/// The sections of all bodies. Collective.
///
/// # Errors
/// A material that is not there, or elements that are not those of the mesh.
pub(super) fn read(comm: &SimpleCommunicator, scene: &Scene, part: &Part, halves: &[bool]) -> Result<Vec<Section>> {
    let elements = element_kinds(comm, scene, part, halves)?;
    let mut sections = Vec::new();
    for ((body, name), (element, fillers)) in scene.sections().zip(elements) {
        let card = scene.material(&name.value);
        let card = card.ok_or_else(|| Error::input(&name.at, "no such material", ""))?;
        let material = Material::new(card);
        let layers = scene.bodies[body].shell.points.unwrap_or_else(|| hex8_shell::usual_layers(&material));
        sections.push(Section { body, material, element, fillers, layers, stiffness: 0.0 });
    }
    Ok(sections)
}

/// Whether a body for which a formulation is asked may have elements of these shapes: its own, and where that is a hexahedron what
/// fills in between some: wedges, of linear ones all may be, pyramids and tetrahedra.
fn goes_with(asked: Formulation, shapes: &[SolidShape]) -> bool {
    let own = asked.shape();
    let is_filled = own == SolidShape::Hex8 && asked != Formulation::Hex8Shell;
    let fills = |shape: SolidShape| match shape {
        SolidShape::Wedge6 => is_filled,
        SolidShape::Pyramid5 | SolidShape::Tet4 => is_filled && shapes.contains(&own),
        SolidShape::Wedge18 => own == SolidShape::Hex27 && shapes.contains(&own),
        _ => false,
    };
    shapes.iter().all(|&shape| shape == own || fills(shape))
}

/// The element formulation of each section: the user's, checked against the mesh, or the mesh's own; and
/// the other shapes of its elements. Collective.
fn element_kinds(
    comm: &SimpleCommunicator,
    scene: &Scene,
    part: &Part,
    halves: &[bool],
) -> Result<Vec<(Formulation, Vec<SolidShape>)>> {
    const SHAPES: [(SolidShape, &str); 7] = [
        (SolidShape::Hex8, "hexahedra"),
        (SolidShape::Wedge6, "wedges"),
        (SolidShape::Pyramid5, "pyramids"),
        (SolidShape::Tet4, "linear tetrahedra"),
        (SolidShape::Tet10, "quadratic tetrahedra"),
        (SolidShape::Hex27, "quadratic hexahedra"),
        (SolidShape::Wedge18, "quadratic wedges"),
    ];
    let mut present = vec![0.0; SHAPES.len() * scene.sections().count()];
    for solid in &part.solids {
        let shape = SHAPES.iter().position(|(shape, _)| *shape == solid.shape).unwrap_or_default();
        present[SHAPES.len() * solid.section as usize + shape] = 1.0;
    }
    max(comm, &mut present);
    let mut kinds = Vec::new();
    for ((body, material), has) in scene.sections().zip(present.chunks_exact(SHAPES.len())) {
        let bends = halves[body] && !scene.bodies[body].is_axisymmetric();
        let body = &scene.bodies[body];
        let has = || SHAPES.iter().zip(has).filter(|(_, has)| **has > 0.0).map(|(shape, _)| shape);
        let asked = body.element.as_ref();
        let shapes: Vec<SolidShape> = has().map(|(shape, _)| *shape).collect();
        if let Some(asked) = asked.filter(|asked| !goes_with(asked.value, &shapes)) {
            let words: Vec<&str> = has().map(|(_, word)| *word).collect();
            let what = format!("the mesh of body `{}` has {}", body.name.value, words.join(" and "));
            let help = match asked.value {
                Formulation::Hex8Shell if shapes.starts_with(&[SolidShape::Hex8]) => {
                    "solid-shell elements are hexahedra alone: mesh the sheet with these, or take \"hex8-eas\""
                }
                Formulation::Hex27 if shapes == [SolidShape::Wedge18] => {
                    "take \"wedge18\", or \"wedge18-sri\", for a mesh of wedges alone"
                }
                _ => "leave `element` out to take each element by its shape",
            };
            return Err(Error::input(&asked.at, what, help));
        }
        let (first, fillers) =
            shapes.split_first().map_or((SolidShape::Hex8, &[][..]), |(first, others)| (*first, others));
        let default = scene.default_element(&material.value, first, bends);
        kinds.push((asked.map_or(default, |e| e.value.beside(first)), fillers.to_vec()));
    }
    Ok(kinds)
}
