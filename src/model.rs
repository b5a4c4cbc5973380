//! From the scene and its meshes to what is modelled: parts, bodies, tools, contact pairs, each only as far as the scene
//! asks for it.

use crate::Vec3;
use crate::contact::{Pair, Slave, Tool};
use crate::error::{Error, Result};
use crate::mesh::{self, Mesh, Purpose, SolidShape};
use crate::output::phases::{Phase, Phases};
use crate::parallel::{agree, max, number, sum};
use crate::partition::{GlobalFacet, GlobalMesh, GlobalSet, Part, PartSet, distribute};
use crate::scene::{self, Element, Located, Scene, did_you_mean};
use crate::solid::element::{hex8, tet4};
use crate::solid::material::Material;
use crate::system::nodal_stiffness;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::BTreeMap;

/// A deformable body on this rank.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: String,
    pub material: Material,
    pub element: Element,
    pub plane_strain: bool,
}

/// What is modelled, on this rank.
pub struct Model {
    pub part: Part,
    pub bodies: Vec<Body>,
    pub tools: Vec<Tool>,
    pub pairs: Vec<Pair>,
    /// Index of each set of the scene in [`Part::sets`].
    set_index: BTreeMap<String, usize>,
    /// Largest diagonal entry of the initial stiffness, force per length; over all ranks.
    pub stiffness: f64,
    /// Typical size of an element, the cube root of the mean element volume.
    pub size: f64,
}

impl Model {
    /// Reads the meshes on rank 0, resolves every name, partitions, and sets up tools and pairs. Collective.
    ///
    /// # Errors
    /// Wrong input, on all ranks alike.
    pub fn new(comm: &SimpleCommunicator, scene: &Scene, phases: &Phases) -> Result<Self> {
        let names = set_names(scene);
        let root = comm.rank() == 0;
        let read = || agree(comm, if root { assemble_bodies(scene, &names).map(Some) } else { Ok(None) });
        let global = phases.time(Phase::Read, read)?;
        let part = phases.time(Phase::Partition, || distribute(comm, global.as_ref()))?;
        drop(global);
        let elements = element_kinds(comm, scene, &part)?;
        let mut bodies = Vec::new();
        for (body, element) in scene.bodies.iter().zip(elements) {
            let card = scene.materials.iter().find(|m| m.name.value == body.material.value);
            let card = card.ok_or_else(|| Error::input(&body.material.at, "no such material", ""))?;
            bodies.push(Body {
                name: body.name.value.clone(),
                material: Material::new(&card.model),
                element,
                plane_strain: body.plane_strain.as_ref().is_some_and(|p| p.value),
            });
        }
        let mut tools = Vec::new();
        for tool in &scene.tools {
            tools.push(Tool::new(comm, tool)?);
        }
        let set_index: BTreeMap<String, usize> = names.iter().enumerate().map(|(k, n)| (n.value.clone(), k)).collect();
        let mut model = Self { part, bodies, tools, pairs: Vec::new(), set_index, stiffness: 0.0, size: 0.0 };
        let stiffness = agree(comm, nodal_stiffness(&model))?;
        let volume = model.volume(comm);
        model.size = (volume / model.part.total_solids as f64).cbrt();
        let mut largest = [stiffness.iter().copied().fold(0.0, f64::max)];
        max(comm, &mut largest);
        model.stiffness = largest[0];
        for contact in &scene.contacts {
            let pair = model.pair(comm, scene, contact, &stiffness);
            model.pairs.push(pair);
        }
        Ok(model)
    }

    /// The set that the scene calls so.
    pub fn set(&self, name: &str) -> &PartSet {
        &self.part.sets[self.set_index[name]]
    }

    /// Volume of all bodies. Collective.
    fn volume(&self, comm: &SimpleCommunicator) -> f64 {
        let mut volume = [0.0];
        for solid in self.part.solids.iter().filter(|s| s.mine) {
            let at = |a: usize| -> [f64; 3] { self.part.points[solid.nodes[a] as usize].into() };
            volume[0] += match solid.shape {
                SolidShape::Tet4 => tet4::volume(&std::array::from_fn(at)),
                SolidShape::Hex8 => hex8::volume(&std::array::from_fn(at)),
            };
        }
        sum(comm, &mut volume);
        volume[0]
    }

    /// The slave nodes of a contact on this rank.
    fn pair(&self, comm: &SimpleCommunicator, scene: &Scene, contact: &scene::Contact, stiffness: &[f64]) -> Pair {
        let set = self.set(&contact.slave.value);
        let mut nodes: Vec<u32> = set.nodes.iter().map(|&n| self.part.tie[n as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let slaves = nodes
            .into_iter()
            .map(|n| Slave::new(n, contact.friction, contact.penalty.unwrap_or(PENALTY * stiffness[n as usize])))
            .collect();
        let mut span = [0.0f64];
        for facet in &set.facets {
            let corners = &facet.nodes[..facet.count as usize];
            let at = |k: usize| self.part.points[corners[k % corners.len()] as usize];
            for k in 0..corners.len() {
                span[0] = span[0].max((at(k + 1) - at(k)).norm());
            }
        }
        max(comm, &mut span);
        let tool = scene.tools.iter().position(|t| t.name.value == contact.master.value).unwrap_or_default();
        Pair {
            name: contact.name.value.clone(),
            tool,
            friction: contact.friction,
            set: self.set_index[&contact.slave.value],
            slaves,
            reach: contact.reach.unwrap_or(2.0 * span[0]),
            facet_size: span[0],
        }
    }

    /// Slave nodes of all ranks, for each pair. Collective.
    pub fn slave_counts(&self, comm: &SimpleCommunicator) -> Vec<u64> {
        self.pairs.iter().map(|p| number(comm, p.slaves.len() as u64).1).collect()
    }
}

/// Automatic penalty over the stiffness of the slave node: measured to be robust over loading, reversal and sliding; above
/// a few times the stiffness slipping nodes flip between opposite slips, far below it slip directions turn slowly.
const PENALTY: f64 = 0.2;

/// Every set that the scene names, in the order in which they are first named.
fn set_names(scene: &Scene) -> Vec<Located<String>> {
    let tools: Vec<&str> = scene.tools.iter().map(|t| t.name.value.as_str()).collect();
    let mut names: Vec<Located<String>> = Vec::new();
    let mut add = |name: &Located<String>| {
        if !tools.contains(&name.value.as_str()) && !names.iter().any(|n| n.value == name.value) {
            names.push(name.clone());
        }
    };
    scene.contacts.iter().for_each(|c| add(&c.slave));
    for step in &scene.steps {
        step.fix.iter().for_each(|c| add(&c.set));
        step.moves.iter().for_each(|c| add(&c.target));
        step.forces.iter().for_each(|c| add(&c.target));
        step.pressures.iter().for_each(|c| add(&c.set));
    }
    scene.output.history.iter().for_each(add);
    names
}

/// Reads all bodies into one numbering and resolves the sets.
fn assemble_bodies(scene: &Scene, names: &[Located<String>]) -> Result<GlobalMesh> {
    let mut global = GlobalMesh { sets: vec![GlobalSet::default(); names.len()], ..GlobalMesh::default() };
    for (index, body) in scene.bodies.iter().enumerate() {
        let mut mesh = mesh::load(&body.mesh, Purpose::Body)?;
        let offset = global.points.len() as u32;
        let ties = match &body.plane_strain {
            Some(asked) if asked.value => mesh::tie_layer(&mut mesh, &asked.at)?,
            _ => (0..mesh.points.len() as u32).collect(),
        };
        global.tie.extend(ties.iter().map(|t| t + offset));
        global.points.extend(mesh.points.iter().map(|p| Vec3::from(*p)));
        global.body.extend(std::iter::repeat_n(index as u32, mesh.points.len()));
        global.id.extend(&mesh.point_ids);
        global.solid_body.extend(std::iter::repeat_n(index as u32, mesh.solids.len()));
        global.solids.extend(mesh.solids.iter().map(|s| {
            let mut solid = *s;
            solid.nodes.iter_mut().for_each(|n| *n += offset);
            solid
        }));
        for (set, name) in global.sets.iter_mut().zip(names) {
            if let Some(found) = resolve(&body.name.value, &mesh, name)? {
                *set = shifted(found, offset);
            }
        }
    }
    global.node_work = vec![0; global.points.len()];
    for contact in &scene.contacts {
        let slave = names.iter().position(|n| n.value == contact.slave.value).unwrap_or_default();
        for &n in &global.sets[slave].nodes {
            global.node_work[n as usize] = 1;
        }
    }
    let needs_faces = scene.contacts.iter().map(|c| &c.slave);
    for name in needs_faces.chain(scene.steps.iter().flat_map(|s| s.pressures.iter().map(|p| &p.set))) {
        if names.iter().zip(&global.sets).any(|(n, set)| n.value == name.value && set.facets.is_empty()) {
            return Err(Error::input(
                &name.at,
                format!("`{}` has no faces", name.value),
                "name a group of faces on the surface of the body",
            ));
        }
    }
    Ok(global)
}

/// The set that `name` (`body` or `body.group`) means in this body; `None` if it is another body's.
fn resolve(body: &str, mesh: &Mesh, name: &Located<String>) -> Result<Option<GlobalSet>> {
    let (of, group) = match name.value.split_once('.') {
        Some((of, group)) => (of, Some(group)),
        None => (name.value.as_str(), None),
    };
    if of != body {
        return Ok(None);
    }
    let Some(group) = group else {
        let nodes = (0..mesh.points.len() as u32).collect();
        return Ok(Some(GlobalSet { nodes, facets: Vec::new() }));
    };
    let Some(found) = mesh.groups.get(group) else {
        let what = format!("body `{body}` has no group `{group}`");
        return Err(Error::input(&name.at, what, did_you_mean(group, mesh.groups.keys().map(String::as_str))));
    };
    if found.nodes.is_empty() {
        return Err(Error::input(
            &name.at,
            format!("group `{group}` of body `{body}` is empty"),
            "name a group that has nodes",
        ));
    }
    let facets = found.facets.iter().map(|&k| &mesh.facets[k as usize]);
    let facets = facets.map(|f| GlobalFacet { count: f.count, nodes: f.nodes }).collect();
    Ok(Some(GlobalSet { nodes: found.nodes.clone(), facets }))
}

fn shifted(mut set: GlobalSet, offset: u32) -> GlobalSet {
    set.nodes.iter_mut().for_each(|n| *n += offset);
    set.facets.iter_mut().for_each(|f| f.nodes.iter_mut().for_each(|n| *n += offset));
    set
}

/// The element formulation of each body: the user's, checked against the mesh, or the mesh's own. Collective.
fn element_kinds(comm: &SimpleCommunicator, scene: &Scene, part: &Part) -> Result<Vec<Element>> {
    let mut present = vec![0.0; 2 * scene.bodies.len()];
    for solid in &part.solids {
        present[2 * solid.body as usize + usize::from(solid.shape == SolidShape::Tet4)] = 1.0;
    }
    max(comm, &mut present);
    let mut kinds = Vec::new();
    for (body, has) in scene.bodies.iter().zip(present.chunks_exact(2)) {
        let (hexes, tets) = (has[0] > 0.0, has[1] > 0.0);
        let asked = body.element.as_ref();
        let wrong = match asked.map(|e| e.value) {
            Some(Element::Tet4) => hexes,
            Some(_) => tets,
            None => false,
        };
        if let (true, Some(asked)) = (wrong, asked) {
            let has = if hexes && tets {
                "hexahedra and tetrahedra"
            } else if hexes {
                "hexahedra"
            } else {
                "tetrahedra"
            };
            let what = format!("the mesh of body `{}` has {has}", body.name.value);
            return Err(Error::input(&asked.at, what, "leave `element` out to take each element by its shape"));
        }
        kinds.push(asked.map_or(if hexes { Element::Hex8 } else { Element::Tet4 }, |e| e.value));
    }
    Ok(kinds)
}
