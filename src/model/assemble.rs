//! The bodies of a scene in one numbering, on rank 0, with the sets that the scene names.

use super::bodies::{self, Meshed};
use super::sections::Sections;
use crate::Vec3;
use crate::error::{Error, Faults, Result};
use crate::mesh::{Mesh, SolidShape, join, message};
use crate::partition::{GlobalFacet, GlobalMesh, GlobalSet, OfFile};
use crate::scene::{self, Discretization, Located, Scene, body_of};
use std::collections::BTreeSet;

/// Every set that the scene names, in the order in which they are first named.
pub fn set_names(scene: &Scene) -> Vec<Located<String>> {
    let tools: Vec<&str> = scene.tools.iter().map(|t| t.name.value.as_str()).collect();
    let mut names: Vec<Located<String>> = Vec::new();
    let mut add = |name: &Located<String>| {
        if !tools.contains(&name.value.as_str()) && !names.iter().any(|n| n.value == name.value) {
            names.push(name.clone());
        }
    };
    scene.bodies.iter().flat_map(|b| &b.symmetry).for_each(&mut add);
    scene.contacts.iter().for_each(|c| add(&c.slave));
    scene.contacts.iter().for_each(|c| add(&c.master));
    scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]).for_each(&mut add);
    for step in &scene.steps {
        step.fix.iter().for_each(|c| add(&c.set));
        step.moves.iter().for_each(|c| add(&c.target));
        step.forces.iter().for_each(|c| add(&c.target));
        step.pressures.iter().for_each(|c| add(&c.set));
        step.springs.iter().for_each(|c| add(&c.set));
        step.dashpots.iter().for_each(|c| add(&c.set));
    }
    scene.output.history.iter().for_each(&mut add);
    let probed = scene.output.probes.iter().filter_map(|probe| match &probe.place {
        scene::ProbePlace::Set(set) => Some(set),
        _ => None,
    });
    probed.for_each(add);
    names
}

/// Reads all bodies into one numbering and resolves the sets.
///
/// # Errors
/// Meshes that cannot be read, or have not what the scene names.
pub fn assemble_bodies(scene: &Scene, names: &[Located<String>]) -> Result<GlobalMesh> {
    let mut global = GlobalMesh { sets: vec![GlobalSet::default(); names.len()], ..GlobalMesh::default() };
    let (mut first_section, mut faults) = (0, Faults::default());
    for (index, (body, Meshed { mut mesh, mut ties, last })) in
        scene.bodies.iter().zip(bodies::load(scene)?).enumerate()
    {
        let (offset, sections) = (global.points.len() as u32, Sections::new(scene, body, &mesh)?);
        global.files.push(OfFile {
            last_id: last,
            has_halves: mesh.has_halves,
            parts: mesh.groups.values().filter(|group| !group.solids.is_empty()).count(),
        });
        for (set, name) in global.sets.iter_mut().zip(names) {
            let found = resolve(&body.name.value, &mesh, name);
            faults.note(&found);
            if let Ok(Some(found)) = found {
                *set = shifted(found, offset);
            }
        }
        global.middles.join(mesh.middles.renumbered(|n| Some(n + offset)));
        // What is said of a file, once of all bodies from it.
        let new: Vec<&String> =
            mesh.warnings.iter().filter(|&told| !global.warnings.iter().any(|w| w.ends_with(told))).collect();
        global.warnings.extend(new.into_iter().map(|told| format!("body `{}`: {told}", body.name.value)));
        ties.iter_mut().for_each(|tie| *tie += offset);
        mesh.solids.iter_mut().flat_map(|solid| &mut solid.nodes).for_each(|n| *n += offset);
        global.section.extend(sections.nodes.iter().map(|section| first_section + section));
        global.solid_section.extend(sections.solids.iter().map(|section| first_section + section));
        first_section += body.sections().count() as u32;
        global.body.extend(std::iter::repeat_n(index as u32, mesh.points.len()));
        global.solid_body.extend(std::iter::repeat_n(index as u32, mesh.solids.len()));
        join(&mut global.tie, ties);
        join(&mut global.points, mesh.points.into_iter().map(Vec3::from).collect());
        join(&mut global.id, mesh.point_ids);
        join(&mut global.solids, mesh.solids);
    }
    faults.finish()?;
    global.connect();
    refuse_quadratic_sides(scene, &global)?;
    global.node_work = vec![0; global.points.len()];
    for contact in &scene.passes() {
        let slave = names.iter().position(|n| n.value == contact.slave.value).unwrap_or_default();
        for &n in &global.sets[slave].nodes {
            global.node_work[n as usize] = 1;
        }
    }
    let of_faces = sides(scene).chain(scene.steps.iter().flat_map(|s| s.pressures.iter().map(|p| &p.set)));
    Faults::all(of_faces.map(|name| {
        let is_bare = names.iter().zip(&global.sets).any(|(n, set)| n.value == name.value && set.facets.is_empty());
        let what = format!("`{}` has no faces", name.value);
        let help = "name a group of faces on the surface of the body";
        if is_bare { Err(Error::input(&name.at, what, help)) } else { Ok(()) }
    }))?;
    Ok(global)
}

/// The sets of faces that meet or are tied.
fn sides(scene: &Scene) -> impl Iterator<Item = &Located<String>> {
    let of_contacts = scene.contacts.iter().flat_map(|c| std::iter::once(&c.slave).chain(c.surface.map(|_| &c.master)));
    of_contacts.chain(scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]))
}

/// The set of a name in the scene, which all that it names have.
pub(super) fn set_of<'a>(names: &[Located<String>], global: &'a GlobalMesh, name: &str) -> Option<&'a GlobalSet> {
    names.iter().position(|known| known.value == name).map(|k| &global.sets[k])
}

/// The names of bodies with elements of these shapes.
pub(super) fn with_shapes<'a>(scene: &'a Scene, global: &GlobalMesh, shapes: &[SolidShape]) -> BTreeSet<&'a str> {
    (global.solids.iter().zip(&global.solid_body))
        .filter(|(solid, _)| shapes.contains(&solid.shape))
        .map(|(_, body)| scene.bodies[*body as usize].name.value.as_str())
        .collect()
}

/// Refuses what does not know of the nodes in the middles of the edges of quadratic tetrahedra.
fn refuse_quadratic_sides(scene: &Scene, global: &GlobalMesh) -> Result<()> {
    let quadratic = with_shapes(scene, global, &[SolidShape::Tet10]);
    for contact in scene.contacts.iter().filter(|c| c.surface.is_some()) {
        let kind = match contact.discretization {
            _ if contact.is_self() => "do not meet themselves",
            Discretization::OnePass | Discretization::Segment => continue,
            Discretization::TwoPass => "are not for two passes",
            Discretization::NodeToNode => "are not for contact from node to node",
        };
        if let Some(set) = [&contact.slave, &contact.master].into_iter().find(|s| quadratic.contains(body_of(&s.value)))
        {
            let help = "let two surfaces meet in one pass or from segment to segment, or mesh the body with hexahedra";
            return Err(Error::input(&set.at, format!("`{}` has quadratic faces, which {kind}", set.value), help));
        }
    }
    Ok(())
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
        let help = message::help_on_group(group, &mesh.groups, |_| true);
        return Err(Error::input(&name.at, what, help));
    };
    if found.nodes.is_empty() {
        return Err(Error::input(
            &name.at,
            format!("group `{group}` of body `{body}` is empty"),
            "name a group that has nodes",
        ));
    }
    let facets = found.facets.iter().map(|&k| &mesh.facets[k as usize]);
    let facets = facets.map(|f| GlobalFacet { count: f.count, nodes: f.nodes, id: f.id }).collect();
    Ok(Some(GlobalSet { nodes: found.nodes.clone(), facets }))
}

fn shifted(mut set: GlobalSet, offset: u32) -> GlobalSet {
    set.nodes.iter_mut().for_each(|n| *n += offset);
    set.facets.iter_mut().for_each(|f| f.nodes.iter_mut().for_each(|n| *n += offset));
    set
}
