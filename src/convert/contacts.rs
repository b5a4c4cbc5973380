//! *CONTACT PAIR with its *SURFACE INTERACTION, and the tools that rigid masters are.

use super::bodies::{Bodies, Owner};
use super::cards::Notes;
use super::groups::{Face, Groups};
use super::names::Namer;
use crate::error::Result;
use crate::mesh::abaqus::{Card, Row, no_set};
use std::collections::BTreeMap;

/// A tool: the surface of a rigid body that something meets.
pub(super) struct Tool {
    pub name: String,
    /// By its number among the rigid bodies.
    pub rigid: usize,
    group: String,
}

/// Friction by interaction, its name in capitals.
struct Interaction {
    name: String,
    friction: f64,
}

/// The part of a surface that belongs to a body, or all of it on a rigid one.
enum Part {
    Body(usize, Vec<Face>),
    Tool(usize),
}

/// The tables of contacts.
pub(super) fn convert(
    groups: &mut Groups,
    bodies: &Bodies,
    tools: &mut Vec<Tool>,
    namer: &mut Namer,
    notes: &mut Notes,
) -> Result<String> {
    let whole = groups.whole;
    let interactions = interactions(&whole.cards, notes)?;
    let mut text = String::new();
    for card in whole.cards.iter().filter(|card| card.keyword.name == "CONTACT PAIR") {
        let wanted = card.keyword.get("INTERACTION").unwrap_or_default();
        let found = interactions.iter().find(|interaction| interaction.name.eq_ignore_ascii_case(wanted));
        let Some(interaction) = found else {
            return Err(card.error(format!("there is no *SURFACE INTERACTION '{wanted}'"), ""));
        };
        tell_of_pair(card, notes);
        for row in &card.rows {
            let [slave, master] = row.fields();
            // One surface alone meets itself.
            let master = if master.is_empty() { slave } else { master };
            let slaves = parts(groups, bodies, tools, namer, row, slave)?;
            let masters = parts(groups, bodies, tools, namer, row, master)?;
            let many = slaves.len() * masters.len() > 1;
            for own in &slaves {
                let Part::Body(body, faces) = own else {
                    let what = format!("the slave surface '{slave}' is on a rigid body");
                    return Err(row.error(what, "exchange the two: the second surface is the master"));
                };
                let slave_name = face_name(groups, bodies, *body, faces, slave)?;
                for other in &masters {
                    let (end, master_name) = match other {
                        Part::Tool(tool) => (tools[*tool].name.clone(), tools[*tool].name.clone()),
                        Part::Body(body, faces) => {
                            (bodies.bodies[*body].name.clone(), face_name(groups, bodies, *body, faces, master)?)
                        }
                    };
                    let name = match many {
                        true => format!("{slave}-{master}-{}-{end}", bodies.bodies[*body].name),
                        false => format!("{slave}-{master}"),
                    };
                    let name = namer.name(&name, "contact");
                    text += &format!("\n[contact.{name}]\nslave = {slave_name}\nmaster = ");
                    text += &match other {
                        Part::Tool(_) => format!("\"{master_name}\"\n"),
                        Part::Body(..) => format!("{master_name}\n"),
                    };
                    text += &format!("friction = {:?}\n", interaction.friction);
                }
            }
        }
    }
    Ok(text)
}

impl Tool {
    /// Its table in the scene.
    pub fn write(&self, mesh: &str) -> String {
        let (mesh, group) = (toml::Value::from(mesh), toml::Value::from(self.group.as_str()));
        format!("\n[tool.{}]\nmesh = {mesh}\ngroup = {group}\n", self.name)
    }
}

/// `"BODY.GROUP"` of faces.
pub(super) fn face_name(
    groups: &mut Groups,
    bodies: &Bodies,
    body: usize,
    faces: &[Face],
    hint: &str,
) -> Result<String> {
    let group = groups.faces(faces, bodies.is_inside(body), hint)?;
    Ok(toml::Value::from(format!("{}.{group}", bodies.bodies[body].name)).to_string())
}

/// The faces of a surface by body; those of tools are `None`.
pub(super) fn faces_by_body(
    groups: &Groups,
    bodies: &Bodies,
    row: &Row,
    name: &str,
) -> Result<BTreeMap<Option<usize>, Vec<Face>>> {
    let facets = groups.whole.surface(name).ok_or_else(|| no_set(&row.at, "surface of elements", name))?;
    let mut found: BTreeMap<Option<usize>, Vec<Face>> = BTreeMap::new();
    for &facet in facets {
        let of = &groups.whole.mesh.facets[facet as usize];
        match bodies.owners[of.nodes[0] as usize] {
            Owner::Body(body) => {
                let face = groups.face_of(facet).ok_or_else(|| {
                    let what = format!("surface '{name}' has a face of element {} that is not on a boundary", of.id);
                    row.error(what, "it lies inside the body")
                })?;
                found.entry(Some(body)).or_default().push(face);
            }
            _ => found.entry(None).or_default().push(facet),
        }
    }
    found.values_mut().for_each(|faces| faces.sort_unstable());
    if found.is_empty() {
        return Err(row.error(format!("surface '{name}' has no faces"), ""));
    }
    Ok(found)
}

fn parts(
    groups: &Groups,
    bodies: &Bodies,
    tools: &mut Vec<Tool>,
    namer: &mut Namer,
    row: &Row,
    name: &str,
) -> Result<Vec<Part>> {
    let mut parts = Vec::new();
    for (body, faces) in faces_by_body(groups, bodies, row, name)? {
        let Some(body) = body else {
            parts.push(Part::Tool(tool(groups, bodies, tools, namer, row, name, &faces)?));
            continue;
        };
        parts.push(Part::Body(body, faces));
    }
    Ok(parts)
}

/// The tool with this rigid surface.
fn tool(
    groups: &Groups,
    bodies: &Bodies,
    tools: &mut Vec<Tool>,
    namer: &mut Namer,
    row: &Row,
    name: &str,
    facets: &[u32],
) -> Result<usize> {
    let of = |facet: u32| bodies.owners[groups.whole.mesh.facets[facet as usize].nodes[0] as usize];
    let Owner::Rigid(rigid) = of(facets[0]) else {
        return Err(row.error(format!("surface '{name}' is neither of a solid nor of a rigid body"), ""));
    };
    if facets.iter().any(|&facet| of(facet) != Owner::Rigid(rigid)) {
        return Err(row.error(format!("surface '{name}' is of several rigid bodies"), "make a surface of each"));
    }
    let group = groups.rigid(facets, name).ok_or_else(|| {
        let what = format!("the rigid surface '{name}' has the name of an element set, or faces of bodies besides");
        row.error(what, "give it a name of its own")
    })?;
    if let Some(known) = tools.iter().position(|tool| tool.rigid == rigid && tool.group == group) {
        return Ok(known);
    }
    let is_first = tools.iter().all(|tool| tool.rigid != rigid);
    let name = if is_first { bodies.rigids[rigid].name.clone() } else { namer.name(name, "tool") };
    tools.push(Tool { name, rigid, group });
    Ok(tools.len() - 1)
}

fn interactions(cards: &[Card], notes: &mut Notes) -> Result<Vec<Interaction>> {
    let mut interactions: Vec<Interaction> = Vec::new();
    for card in cards {
        match card.keyword.name.as_str() {
            "SURFACE INTERACTION" => {
                let name = card.keyword.get("NAME").unwrap_or_default().to_string();
                interactions.push(Interaction { name, friction: 0.0 });
            }
            "SURFACE BEHAVIOR" => {
                let law = card.keyword.get("PRESSURE-OVERCLOSURE").unwrap_or("HARD").to_uppercase();
                if law == "TIED" {
                    return Err(card.error("tied contact cannot be converted", "mesh what is bonded as one part"));
                }
                if law != "HARD" {
                    let what = format!("the {law} pressure-overclosure becomes hard contact, without penetration");
                    notes.at(&card.at, what);
                }
            }
            "FRICTION" => {
                let [row] = &card.rows[..] else {
                    return Err(card.error("*FRICTION that varies cannot be converted", "keep one line of data"));
                };
                let [friction, stick] = row.fields();
                let interaction =
                    interactions.last_mut().ok_or_else(|| card.error("stands before a *SURFACE INTERACTION", ""))?;
                interaction.friction = row.number(friction, 0.0)?;
                if interaction.friction < 0.0 {
                    return Err(row.error("the coefficient of friction is negative", ""));
                }
                if !stick.is_empty() {
                    notes.at(&card.at, "the stiffness of sticking is passed over: nodes that stick do not slip at all");
                }
            }
            _ => {}
        }
    }
    Ok(interactions)
}

/// What of a pair is otherwise in nagata.
fn tell_of_pair(card: &Card, notes: &mut Notes) {
    if card.keyword.has("ADJUST") {
        notes.at(&card.at, "ADJUST is passed over: nodes of the slave stay where the mesh has them");
    }
    if card.keyword.has("SMALL SLIDING") {
        notes.at(&card.at, "SMALL SLIDING becomes large sliding");
    }
    let kind = card.keyword.get("TYPE").unwrap_or("NODE TO SURFACE").to_uppercase();
    if kind != "NODE TO SURFACE" {
        let what = "becomes one pass, in which the nodes of the slave are kept out of the smoothed master";
        notes.at(&card.at, format!("TYPE={kind} {what}"));
    }
}
