//! Bodies, one for each connected part of the mesh, and tools, one for each rigid body.

use super::cards::Notes;
use super::groups::Groups;
use super::materials::{self, Material};
use super::names::Namer;
use crate::error::{Error, Location, Result};
use crate::mesh::abaqus::{Card, DRAWN, Whole, no_set};
use crate::mesh::{Slot, SolidShape};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// What a node belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Nothing,
    Body(usize),
    /// The rigid body of this number.
    Rigid(usize),
}

pub(super) struct Body {
    pub name: String,
    pub solids: Vec<u32>,
    /// How often each material of the deck occurs.
    materials: BTreeMap<usize, Vec<u32>>,
    group: Option<String>,
}

/// A rigid body of the deck.
pub(super) struct Rigid {
    pub name: String,
    pub at: Location,
    pub reference: u32,
    /// The node whose displacements are its rotations.
    pub rotations: Option<u32>,
    /// Nodes of bodies that move with it; a rigid body without them is all rigid, a tool.
    pub nodes: Vec<u32>,
}

pub(super) struct Bodies {
    pub bodies: Vec<Body>,
    pub rigids: Vec<Rigid>,
    /// Of each node.
    pub owners: Vec<Owner>,
}

impl Bodies {
    pub fn new(groups: &mut Groups, materials: &[Material], namer: &mut Namer, notes: &mut Notes) -> Result<Self> {
        let whole = groups.whole;
        let parts = connected(whole);
        let mut owners = vec![Owner::Nothing; whole.mesh.points.len()];
        let rigids = rigids(whole, &parts, &mut owners, namer)?;
        let sections = sections(whole, materials, &owners, notes)?;
        let mut bodies = Vec::new();
        for solids in parts {
            if matches!(owners[whole.mesh.solids[solids[0] as usize].nodes[0] as usize], Owner::Rigid(_)) {
                continue;
            }
            for &solid in &solids {
                let nodes = whole.mesh.solids[solid as usize].nodes();
                nodes.iter().for_each(|&node| owners[node as usize] = Owner::Body(bodies.len()));
            }
            bodies.push(body(groups, solids, &sections, namer)?);
        }
        if bodies.is_empty() {
            return Err(Error::input_anywhere("the deck has no solids that deform", "nagata computes C3D8 and C3D4"));
        }
        tell_of_loose(whole, &owners, notes);
        Ok(Self { bodies, rigids, owners })
    }

    /// The materials that occur.
    pub fn materials(&self) -> BTreeSet<usize> {
        self.bodies.iter().flat_map(|body| body.materials.keys().copied()).collect()
    }

    /// The parts of bodies that are of one material each: body, material, solids.
    pub fn sections(&self) -> impl Iterator<Item = (&Body, usize, &[u32])> {
        let of_bodies = self.bodies.iter().flat_map(|body| body.materials.iter().map(move |of| (body, of)));
        of_bodies.map(|(body, (&material, solids))| (body, material, solids.as_slice()))
    }

    /// Whether a node is of a body.
    pub fn is_inside(&self, body: usize) -> impl Fn(u32) -> bool + '_ {
        move |node| self.owners[node as usize] == Owner::Body(body)
    }
}

/// The solids of each connected part, in the order of the deck.
fn connected(whole: &Whole) -> Vec<Vec<u32>> {
    let mut one: Vec<u32> = (0..whole.mesh.points.len() as u32).collect();
    fn root(one: &mut [u32], mut node: u32) -> u32 {
        while one[node as usize] != node {
            one[node as usize] = one[one[node as usize] as usize];
            node = one[node as usize];
        }
        node
    }
    for solid in &whole.mesh.solids {
        let first = root(&mut one, solid.nodes[0]);
        for &node in &solid.nodes()[1..] {
            let other = root(&mut one, node);
            one[other as usize] = first;
        }
    }
    let mut number: BTreeMap<u32, usize> = BTreeMap::new();
    let mut parts: Vec<Vec<u32>> = Vec::new();
    for (solid, index) in whole.mesh.solids.iter().zip(0..) {
        let part = *number.entry(root(&mut one, solid.nodes[0])).or_insert(parts.len());
        if part == parts.len() {
            parts.push(Vec::new());
        }
        parts[part].push(index);
    }
    parts
}

fn rigids(whole: &Whole, parts: &[Vec<u32>], owners: &mut [Owner], namer: &mut Namer) -> Result<Vec<Rigid>> {
    let mut rigids = Vec::new();
    for (number, card) in whole.cards.iter().enumerate().filter(|(_, card)| is_rigid(card)) {
        let place = card.place.as_deref();
        // Nodes of solids have no rotations of their own to be left free by PIN.
        let mut of_nodes = ["NSET", "TIE NSET", "PIN NSET"].iter().filter_map(|key| card.keyword.get(key));
        let (set, members) = match (card.keyword.get("ELSET"), of_nodes.next()) {
            _ if card.keyword.name == "COUPLING" => coupled(whole, number)?,
            _ if of_nodes.next().is_some() => return Err(card.error(ONE_SET, "")),
            (Some(set), None) => {
                let elements = whole.elements(place, set).ok_or_else(|| no_set(&card.at, "element set", set))?;
                (set, elements.iter().flat_map(|&element| nodes_of(whole, whole.slots[element as usize])).collect())
            }
            (None, Some(set)) => (set, whole.nodes(place, set).ok_or_else(|| no_set(&card.at, "node set", set))?),
            _ => return Err(card.error(ONE_SET, "")),
        };
        let one = |key: &str| {
            let Some(field) = card.keyword.get(key) else { return Ok(None) };
            match whole.nodes(place, field).as_deref() {
                Some([node]) => Ok(Some(*node)),
                _ => Err(card.error(format!("{key}={field} is not one node"), "")),
            }
        };
        let Some(reference) = one("REF NODE")? else {
            return Err(card.error(format!("*{} needs REF NODE=", card.keyword.name), ""));
        };
        let members: BTreeSet<u32> = members.into_iter().collect();
        let rigid = rigids.len();
        let mut of_bodies: BTreeSet<u32> = BTreeSet::new();
        for solids in parts {
            let nodes = || solids.iter().flat_map(|&solid| whole.mesh.solids[solid as usize].nodes());
            if nodes().all(|node| members.contains(node)) {
                nodes().for_each(|&node| owners[node as usize] = Owner::Rigid(rigid));
            } else {
                of_bodies.extend(nodes().filter(|&node| members.contains(node)));
            }
        }
        for &node in members.iter().filter(|node| !of_bodies.contains(node)) {
            owners[node as usize] = Owner::Rigid(rigid);
        }
        if of_bodies.contains(&reference) {
            return Err(card.error("the reference node is a node of a body", "give the rigid body a node of its own"));
        }
        let name = namer.name(set, "rigid");
        let (at, rotations) = (card.at.clone(), one("ROT NODE")?);
        rigids.push(Rigid { name, at, reference, rotations, nodes: of_bodies.into_iter().collect() });
        for node in [Some(reference), rotations].into_iter().flatten() {
            owners[node as usize] = Owner::Rigid(rigid);
        }
    }
    Ok(rigids)
}

const ONE_SET: &str = "*RIGID BODY needs one of ELSET=, NSET=, TIE NSET= and PIN NSET=";

fn is_rigid(card: &Card) -> bool {
    matches!(card.keyword.name.as_str(), "RIGID BODY" | "COUPLING")
}

/// The surface of a *COUPLING, the card of this number, and its nodes: with *KINEMATIC they move as a rigid body does.
fn coupled(whole: &Whole, number: usize) -> Result<(&str, Vec<u32>)> {
    let card = &whole.cards[number];
    let Some(kinematic) = whole.cards.get(number + 1).filter(|next| next.keyword.name == "KINEMATIC") else {
        return Err(
            card.error("*COUPLING has no *KINEMATIC", "only nodes that move with a reference node can be converted")
        );
    };
    let mut along = [kinematic.rows.is_empty(); 3];
    for row in &kinematic.rows {
        let [first, last] = row.fields();
        for dof in super::conditions::range(row, first, last)?.into_iter().filter(|dof| *dof < 3) {
            along[dof] = true;
        }
    }
    if along.contains(&false) {
        let what = "nodes that a reference node leaves free along 1, 2 or 3 cannot be converted";
        return Err(kinematic.error(what, "write 1, 3; or give the conditions on the nodes themselves"));
    }
    let surface = card.keyword.get("SURFACE").unwrap_or_default();
    let of_facet = |&facet: &u32| nodes_of(whole, Slot::Facets { first: facet, count: 1 });
    let of_elements = || whole.surface(surface).map(|facets| facets.iter().flat_map(of_facet).collect());
    let nodes = whole.surface_of_nodes(surface).map(<[u32]>::to_vec).or_else(of_elements);
    Ok((surface, nodes.ok_or_else(|| no_set(&card.at, "surface", surface))?))
}

/// The nodes of an element.
pub(super) fn nodes_of(whole: &Whole, slot: Slot) -> Vec<u32> {
    match slot {
        Slot::Solids { .. } => {
            slot.solids().flat_map(|solid| whole.mesh.solids[solid as usize].nodes()).copied().collect()
        }
        Slot::Facets { .. } => {
            let nodes = |facet: u32| {
                let corners = whole.mesh.facets[facet as usize].nodes();
                corners.iter().copied().chain(whole.mesh.middles.around(corners))
            };
            slot.facets().flat_map(nodes).collect()
        }
        Slot::Loose(ends) => ends.to_vec(),
        Slot::Halves(nodes) => nodes.to_vec(),
    }
}

/// For each solid its material and the set of its section.
fn sections<'a>(
    whole: &'a Whole,
    materials: &[Material],
    owners: &[Owner],
    notes: &mut Notes,
) -> Result<Vec<Option<(usize, &'a Card)>>> {
    let mut sections: Vec<Option<(usize, &Card)>> = vec![None; whole.mesh.solids.len()];
    let is_rigid = |slot| {
        let nodes = nodes_of(whole, slot);
        nodes.iter().all(|&node| matches!(owners[node as usize], Owner::Rigid(_)))
    };
    for card in &whole.cards {
        let name = card.keyword.name.as_str();
        if !matches!(name, "SOLID SECTION" | "SHELL SECTION" | "MEMBRANE SECTION") {
            continue;
        }
        let set = card.keyword.get("ELSET").unwrap_or_default();
        let elements =
            whole.elements(card.place.as_deref(), set).ok_or_else(|| no_set(&card.at, "element set", set))?;
        let material = match name {
            "SOLID SECTION" => materials::find(materials, &whole.cards, card)?,
            _ => usize::MAX,
        };
        let mut thick = false;
        for element in elements {
            let slot = whole.slots[element as usize];
            match slot {
                _ if is_rigid(slot) => thick |= name == "SHELL SECTION",
                Slot::Solids { .. } if name == "SOLID SECTION" => {
                    for solid in slot.solids() {
                        let section = &mut sections[solid as usize];
                        if section.is_some_and(|(other, _)| other != material) {
                            let id = whole.mesh.solids[solid as usize].id;
                            return Err(card.error(format!("element {id} already has a section"), ""));
                        }
                        *section = Some((material, card));
                    }
                }
                _ => {
                    let what = format!("*{name} of elements {} cannot be converted", whole.kind(element));
                    let help = "nagata computes the solids C3D8, C3D6, C3D5, C3D4, C3D20, C3D15 and C3D10, and CAX4 and CAX8; plane \
                                strain is one layer of C3D8 with `plane_strain = true`";
                    return Err(card.error(what, help));
                }
            }
        }
        let thickness = card.rows.first().map_or("", |row| row.fields::<1>()[0]);
        if thick && !thickness.is_empty() && thickness.parse() != Ok(0.0) {
            notes.at(
                &card.at,
                format!(
                    "the thickness {thickness} of shells of a rigid body is passed over: its tool is their middle surface, where \
                     CalculiX has half of it on each side; move the mesh by that"
                ),
            );
        }
    }
    Ok(sections)
}

fn body(groups: &mut Groups, solids: Vec<u32>, sections: &[Option<(usize, &Card)>], namer: &mut Namer) -> Result<Body> {
    let mesh = &groups.whole.mesh;
    let mut materials: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for &solid in &solids {
        let Some((material, _)) = sections[solid as usize] else {
            let what = format!("element {} has no *SOLID SECTION", mesh.solids[solid as usize].id);
            return Err(Error::input_anywhere(what, "every element needs a material"));
        };
        materials.entry(material).or_default().push(solid);
    }
    let fits = |a: SolidShape, b: SolidShape| a == b || [a, b].iter().all(|shape| FILLED.contains(shape));
    let shape = mesh.solids[solids[0] as usize].shape;
    if let Some(&other) = solids.iter().find(|&&solid| !fits(mesh.solids[solid as usize].shape, shape)) {
        let (a, b) = (mesh.solids[solids[0] as usize].id, mesh.solids[other as usize].id);
        let what = format!("elements {a} and {b} are of one part, but of different shape or order");
        return Err(Error::input_anywhere(what, "mesh each connected part with elements of one order"));
    }
    let mut sets = solids.iter().filter_map(|&solid| sections[solid as usize]?.1.keyword.get("ELSET"));
    let set = sets.next().filter(|first| sets.all(|other| other == *first));
    let set = own_name(groups.whole, &solids).or(set).unwrap_or("body");
    let group = match solids.len() == mesh.solids.len() {
        true => None,
        false => Some(groups.solids(&solids, |_| true, set)?),
    };
    let name = namer.name(group.as_deref().unwrap_or(set), "body");
    Ok(Body { name, solids, materials, group })
}

/// Shapes that a body may have together.
const FILLED: [SolidShape; 4] = [SolidShape::Hex8, SolidShape::Wedge6, SolidShape::Pyramid5, SolidShape::Tet4];

/// The name under which the deck has just these solids: that of an instance, or of their *ELEMENT.
fn own_name<'a>(whole: &'a Whole, solids: &[u32]) -> Option<&'a str> {
    let name = |card: &'a Card| match card.keyword.name.as_str() {
        "INSTANCE" => card.keyword.get("NAME"),
        "ELEMENT" => card.keyword.get("ELSET"),
        _ => None,
    };
    let has = |name: &&str| {
        let groups = &whole.mesh.groups;
        groups.iter().any(|(group, found)| group.eq_ignore_ascii_case(name) && found.solids == solids)
    };
    whole.cards.iter().filter_map(name).find(has)
}

/// Elements that are neither solids nor of a rigid body, as the facets that Gmsh writes.
fn tell_of_loose(whole: &Whole, owners: &[Owner], notes: &mut Notes) {
    let mut loose: BTreeMap<&str, usize> = BTreeMap::new();
    for (&slot, element) in whole.slots.iter().zip(0..) {
        let is_rigid = || nodes_of(whole, slot).iter().all(|&node| matches!(owners[node as usize], Owner::Rigid(_)));
        if !matches!(slot, Slot::Solids { .. }) && !whole.kind(element).starts_with("SPRING") && !is_rigid() {
            *loose.entry(whole.kind(element)).or_default() += 1;
        }
    }
    for (kind, count) in loose {
        notes.whole(format!(
            "{count} elements of type {kind} have no section and are of no rigid body: they give groups, but no stiffness"
        ));
    }
}

impl Body {
    /// Its table in the scene, without the mesh.
    pub fn write(&self, groups: &mut Groups, materials: &[Material], notes: &mut Notes) -> Result<String> {
        let name = &self.name;
        let mut text = String::new();
        if let Some(group) = &self.group {
            let _ = writeln!(text, "group = {}", toml::Value::from(group.as_str()));
        }
        let most = self.materials.iter().max_by_key(|(_, solids)| solids.len()).map_or(0, |(material, _)| *material);
        let _ = writeln!(text, "material = \"{}\"", materials[most].name);
        let mut others = Vec::new();
        for (&material, solids) in self.materials.iter().filter(|(material, _)| **material != most) {
            let own: BTreeSet<u32> = self.solids.iter().copied().collect();
            let hint = format!("{name}-{}", materials[material].name);
            let group = groups.solids(solids, |solid| own.contains(&solid), &hint)?;
            others.push(format!("{} = \"{}\"", toml::Value::from(group), materials[material].name));
        }
        if !others.is_empty() {
            let _ = writeln!(text, "materials = {{ {} }}", others.join(", "));
        }
        text += self.element(groups.whole, materials, notes);
        Ok(text)
    }

    /// The line with the element, if the scene is to say one.
    fn element(&self, whole: &Whole, materials: &[Material], notes: &mut Notes) -> &'static str {
        let kind = |&solid: &u32| whole.kind(whole.element_of[solid as usize]);
        let shape_of = |solid: &u32| whole.mesh.solids[*solid as usize].shape;
        let is_hexahedron = |solid: &u32| shape_of(solid) == SolidShape::Hex8;
        let first = self.solids.iter().copied().find(is_hexahedron).unwrap_or(self.solids[0]);
        let shape = shape_of(&first);
        // Wedges follow the hexahedra that they fill in between.
        let kinds: BTreeSet<&str> = self.solids.iter().filter(|solid| shape_of(solid) == shape).map(kind).collect();
        let named: Vec<&str> = kinds.iter().copied().collect();
        let (name, types) = (&self.name, named.join(", "));
        let is_split = |kind: &&str| kind.starts_with("C3D20") || kind.starts_with("C3D15");
        if kinds.iter().any(is_split) {
            notes.whole(format!(
                "body `{name}`: each element {types} becomes eight linear ones between its nodes, which bend as it does where the \
                 material lets enhanced strain be (see `nagata check`){}",
                match shape {
                    SolidShape::Hex8 => "; `element = \"hex27\"` takes it as such",
                    _ => "; `element = \"wedge18\"` takes it as such",
                }
            ));
            return "";
        }
        if matches!(shape, SolidShape::Wedge6 | SolidShape::Pyramid5) {
            let element = if shape == SolidShape::Wedge6 { "wedge6" } else { "pyramid5" };
            notes.whole(format!(
                "body `{name}`: elements {types} become `{element}`, or `{element}-sri` where the material nearly keeps its volume (see \
                 `nagata check`)"
            ));
            return "";
        }
        if shape == SolidShape::Tet4 {
            return "";
        }
        if shape == SolidShape::Tet10 {
            if named != ["C3D10"] {
                notes.whole(format!(
                    "body `{name}`: elements {types} become `tet10`, or `tet10-sri` where the material nearly keeps its \
                     volume (see `nagata check`)"
                ));
            }
            return "";
        }
        if whole.mesh.is_section {
            if !matches!(&named[..], [one] if DRAWN.contains(one)) {
                notes.whole(format!(
                    "body `{name}`: elements {types} become those that nagata takes for its material (see `nagata check`)"
                ));
            }
            if kinds.iter().any(|kind| kind.starts_with(DRAWN[1])) {
                notes.whole(format!("body `{name}`: each element {types} becomes four linear ones between its nodes"));
            }
            return "axisymmetric = true\n";
        }
        let is_orthotropic = self.materials.keys().any(|&material| materials[material].is_orthotropic());
        if named == ["C3D8I"] && !is_orthotropic {
            notes
                .whole(format!("body `{name}`: elements C3D8I become `hex8-eas`, which bends in one layer as they do"));
            return "element = \"hex8-eas\"       # C3D8I\n";
        }
        if named == ["C3D8"] && self.materials.keys().any(|&material| materials[material].locks()) {
            notes.whole(format!(
                "body `{name}`: elements C3D8 lock in CalculiX where the volume is all but kept, as in rubber and plastic flow; \
                 those that nagata takes do not, and give less force"
            ));
        }
        if named != ["C3D8"] {
            notes.whole(format!(
                "body `{name}`: elements {types} become those that nagata takes for its material (see `nagata check`); \
                 where it bends in few layers{}",
                if is_orthotropic { ", refine it" } else { ", set element = \"hex8-eas\"" }
            ));
        }
        ""
    }
}
