//! *CONTACT PAIR with its *SURFACE INTERACTION, the tools that rigid masters are, and *TIE.

use super::bodies::{Bodies, Owner};
use super::cards::Notes;
use super::groups::{Face, Groups};
use super::names::Namer;
use super::scene::quoted;
use crate::error::{Error, Location, Result};
use crate::mesh::abaqus::{Card, Row, no_set};
use std::collections::{BTreeMap, BTreeSet};

/// A tool: the surface of a rigid body that something meets.
pub(super) struct Tool {
    pub name: String,
    /// By its number among the rigid bodies.
    pub rigid: usize,
    group: String,
}

/// A *SURFACE INTERACTION.
struct Interaction {
    name: String,
    at: Location,
    friction: f64,
    is_used: bool,
}

/// The part of a surface that belongs to a body, or all of it on a rigid one.
enum Part {
    Body(usize, Vec<Face>),
    Tool(usize),
}

/// What the pairs of a deck become.
#[derive(Default)]
pub(super) struct Contacts {
    /// The tables of the scene.
    pub text: String,
    pub tools: Vec<Tool>,
    /// Masters on bodies.
    pub masters: Vec<(usize, Vec<Face>)>,
}

/// Converts all pairs.
pub(super) fn convert(groups: &mut Groups, bodies: &Bodies, namer: &mut Namer, notes: &mut Notes) -> Result<Contacts> {
    let whole = groups.whole;
    let cards = &whole.cards;
    let mut interactions = interactions(cards, notes)?;
    let shrinking = shrinking(cards)?;
    let mut pairs = Pairs { groups, bodies, namer, shrinking, made: Contacts::default() };
    for card in cards.iter().filter(|card| card.keyword.name == "CONTACT PAIR") {
        let wanted = card.keyword.get("INTERACTION").unwrap_or_default();
        let found = interactions.iter_mut().find(|interaction| interaction.name.eq_ignore_ascii_case(wanted));
        let Some(interaction) = found else {
            return Err(card.error(format!("there is no *SURFACE INTERACTION '{wanted}'"), ""));
        };
        interaction.is_used = true;
        tell_of_pair(card, notes);
        card.rows.iter().try_for_each(|row| pairs.convert(row, interaction.friction))?;
    }
    for card in cards.iter().filter(|card| card.keyword.name == "TIE") {
        if card.keyword.is_off("ADJUST") {
            notes.at(&card.at, "ADJUST=NO is passed over: slave nodes are moved until both sides meet in the mean");
        }
        card.rows.iter().try_for_each(|row| pairs.tie(card, row))?;
    }
    if let Some(shrinking) = pairs.shrinking.iter().find(|shrinking| !shrinking.is_used) {
        let what = "*CONTACT INTERFERENCE of surfaces that are no *CONTACT PAIR";
        return Err(Error::input(&shrinking.at, what, "name its slave first, then its master"));
    }
    for interaction in interactions.iter().filter(|interaction| !interaction.is_used) {
        let what = format!("the interaction '{}' is of no *CONTACT PAIR: it is passed over", interaction.name);
        notes.at(&interaction.at, what);
    }
    Ok(pairs.made)
}

impl Tool {
    /// Its table in the scene.
    pub fn write(&self, mesh: &str) -> String {
        let (mesh, group) = (quoted(mesh), quoted(&self.group));
        format!("\n[tool.{}]\nmesh = {mesh}\ngroup = {group}\n", self.name)
    }
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

/// The faces of bodies whose nodes are all in a surface of nodes, each of which is to be of one.
fn faces_between(
    groups: &Groups,
    bodies: &Bodies,
    row: &Row,
    (name, nodes): (&str, &[u32]),
) -> Result<BTreeMap<Option<usize>, Vec<Face>>> {
    let mut found: BTreeMap<Option<usize>, Vec<Face>> = BTreeMap::new();
    let mut bare: BTreeSet<u32> = nodes.iter().copied().collect();
    for face in 0..groups.boundary.len() as u32 {
        let own = groups.face_nodes(face);
        if !own.iter().all(|node| nodes.binary_search(node).is_ok()) {
            continue;
        }
        if let Owner::Body(body) = bodies.owners[own[0] as usize] {
            own.iter().for_each(|node| _ = bare.remove(node));
            found.entry(Some(body)).or_default().push(face);
        }
    }
    if let Some(&node) = bare.first() {
        let id = groups.whole.mesh.point_ids[node as usize];
        let what = format!("node {id} of the surface '{name}' is of no face of a body with all its nodes in it");
        return Err(row.error(what, "name the faces, by a *SURFACE with TYPE=ELEMENT"));
    }
    Ok(found)
}

/// A pair whose overlap is pushed out over the first step.
struct Shrinking {
    /// Slave and master, in capitals.
    names: [String; 2],
    at: Location,
    is_used: bool,
}

fn shrinking(cards: &[Card]) -> Result<Vec<Shrinking>> {
    let (mut steps, mut pairs) = (0, Vec::new());
    for card in cards {
        match card.keyword.name.as_str() {
            "STEP" => steps += 1,
            "CONTACT INTERFERENCE" if steps != 1 || !card.keyword.has("SHRINK") => {
                let help =
                    "give it the parameter SHRINK, in the first step: what overlaps at the start is pushed out over it";
                return Err(card.error("no condition of a scene does this", help));
            }
            "CONTACT INTERFERENCE" => {
                pairs.extend(card.rows.iter().map(|row| Shrinking {
                    names: row.fields().map(str::to_ascii_uppercase),
                    at: row.at.clone(),
                    is_used: false,
                }));
            }
            _ => {}
        }
    }
    Ok(pairs)
}

/// Pairs that are being converted.
struct Pairs<'a, 'b> {
    groups: &'a mut Groups<'b>,
    bodies: &'a Bodies,
    namer: &'a mut Namer,
    shrinking: Vec<Shrinking>,
    made: Contacts,
}

impl Pairs<'_, '_> {
    /// The contacts of a line: one for each two bodies that its surfaces are on.
    fn convert(&mut self, row: &Row, friction: f64) -> Result<()> {
        let [slave, master] = row.fields();
        // One surface alone meets itself.
        let master = if master.is_empty() { slave } else { master };
        let names = [slave, master].map(str::to_ascii_uppercase);
        let mut shrinks = false;
        for shrinking in self.shrinking.iter_mut().filter(|shrinking| shrinking.names == names) {
            (shrinks, shrinking.is_used) = (true, true);
        }
        let slaves = self.parts(row, slave)?;
        let masters = self.parts(row, master)?;
        let many = slaves.len() * masters.len() > 1;
        for own in &slaves {
            let Part::Body(body, faces) = own else {
                let what = format!("the slave surface '{slave}' is on a rigid body");
                return Err(row.error(what, "exchange the two: the second surface is the master"));
            };
            let (slave_body, slave_name) = (&self.bodies.bodies[*body].name, self.face_name(*body, faces, slave)?);
            for other in &masters {
                let (end, master_name) = match other {
                    Part::Tool(tool) => (&self.made.tools[*tool].name, self.made.tools[*tool].name.clone()),
                    Part::Body(body, faces) => {
                        self.made.masters.push((*body, faces.clone()));
                        (&self.bodies.bodies[*body].name, self.face_name(*body, faces, master)?)
                    }
                };
                let name = match many {
                    true => format!("{slave}-{master}-{slave_body}-{end}"),
                    false => format!("{slave}-{master}"),
                };
                let name = self.namer.name(&name, "contact");
                let (slave, master) = (quoted(&slave_name), quoted(&master_name));
                self.made.text += &format!("\n[contact.{name}]\nslave = {slave}\nmaster = {master}\n");
                self.made.text += &format!("friction = {friction:?}\n");
                self.made.text += if shrinks { "interference = \"ramped\"\n" } else { "" };
            }
        }
        Ok(())
    }

    /// The tie of a line.
    fn tie(&mut self, card: &Card, row: &Row) -> Result<()> {
        let names: [&str; 2] = row.fields();
        let mut sides = Vec::new();
        for name in names {
            match &self.parts(row, name)?[..] {
                [Part::Body(body, faces)] => sides.push(self.face_name(*body, faces, name)?),
                [Part::Tool(_)] => {
                    let what = format!("the tied surface '{name}' is on a rigid body");
                    return Err(row.error(what, "take the nodes of its surface into the *RIGID BODY"));
                }
                _ => {
                    let what = format!("the tied surface '{name}' is on several bodies");
                    let help = "write a *TIE for each; of a master surface as their slaves, for a node is tied once";
                    return Err(row.error(what, help));
                }
            }
        }
        let name = self.namer.name(card.keyword.get("NAME").unwrap_or(names[0]), "tie");
        let [slave, master] = [&sides[0], &sides[1]].map(|side| quoted(side));
        self.made.text += &format!("\n[tie.{name}]\nslave = {slave}\nmaster = {master}\n");
        if let Some(tolerance) = card.keyword.get("POSITION TOLERANCE") {
            self.made.text += &format!("tolerance = {:?}\n", row.number(tolerance, 0.0)?);
        }
        Ok(())
    }

    /// `BODY.GROUP` of faces.
    fn face_name(&mut self, body: usize, faces: &[Face], hint: &str) -> Result<String> {
        let group = self.groups.faces(faces, self.bodies.is_inside(body), hint)?;
        Ok(format!("{}.{group}", self.bodies.bodies[body].name))
    }

    fn parts(&mut self, row: &Row, name: &str) -> Result<Vec<Part>> {
        let mut parts = Vec::new();
        // Sections know too few of their faces.
        let whole = self.groups.whole;
        let by_body = match whole.surface_of_nodes(name).filter(|_| !whole.mesh.is_section) {
            Some(nodes) => faces_between(self.groups, self.bodies, row, (name, nodes))?,
            None => faces_by_body(self.groups, self.bodies, row, name)?,
        };
        for (body, faces) in by_body {
            parts.push(match body {
                Some(body) => Part::Body(body, faces),
                None => Part::Tool(self.tool(row, name, &faces)?),
            });
        }
        Ok(parts)
    }

    /// The tool with this rigid surface.
    fn tool(&mut self, row: &Row, name: &str, facets: &[u32]) -> Result<usize> {
        let of = |facet: u32| self.bodies.owners[self.groups.whole.mesh.facets[facet as usize].nodes[0] as usize];
        let Owner::Rigid(rigid) = of(facets[0]) else {
            return Err(row.error(format!("surface '{name}' is neither of a solid nor of a rigid body"), ""));
        };
        if facets.iter().any(|&facet| of(facet) != Owner::Rigid(rigid)) {
            return Err(row.error(format!("surface '{name}' is of several rigid bodies"), "make a surface of each"));
        }
        let group = self.groups.rigid(facets, name).ok_or_else(|| {
            let what = format!("the rigid surface '{name}' has the name of an element set, or faces of bodies besides");
            row.error(what, "give it a name of its own")
        })?;
        if let Some(known) = self.made.tools.iter().position(|tool| tool.rigid == rigid && tool.group == group) {
            return Ok(known);
        }
        let is_first = self.made.tools.iter().all(|tool| tool.rigid != rigid);
        let name = if is_first { self.bodies.rigids[rigid].name.clone() } else { self.namer.name(name, "tool") };
        self.made.tools.push(Tool { name, rigid, group });
        Ok(self.made.tools.len() - 1)
    }
}

fn interactions(cards: &[Card], notes: &mut Notes) -> Result<Vec<Interaction>> {
    let mut interactions: Vec<Interaction> = Vec::new();
    for card in cards {
        match card.keyword.name.as_str() {
            "SURFACE INTERACTION" => {
                let name = card.keyword.get("NAME").unwrap_or_default().to_string();
                interactions.push(Interaction { name, at: card.at.clone(), friction: 0.0, is_used: false });
            }
            "SURFACE BEHAVIOR" => {
                let law = card.keyword.get("PRESSURE-OVERCLOSURE").unwrap_or("HARD").to_uppercase();
                if law == "TIED" {
                    return Err(
                        card.error("tied contact cannot be converted", "write a *TIE of the two surfaces in its place")
                    );
                }
                if let Some(what) = softness(card, &law)? {
                    let hard = "becomes hard contact, without penetration or pressure at a distance";
                    notes.at(&card.at, format!("the {law} pressure-overclosure {hard}: {what}"));
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
    if card.keyword.has("SMALL SLIDING") && !card.keyword.is_off("SMALL SLIDING") {
        notes.at(&card.at, "SMALL SLIDING becomes large sliding");
    }
    let kind = card.keyword.get("TYPE").unwrap_or("NODE TO SURFACE").to_uppercase();
    if kind != "NODE TO SURFACE" {
        let what = "becomes one pass, in which the nodes of the slave are kept out of the smoothed master";
        notes.at(&card.at, format!("TYPE={kind} {what}"));
    }
}

/// What of a pressure by overclosure is missing in hard contact.
fn softness(card: &Card, law: &str) -> Result<Option<String>> {
    let number = |at: usize| match card.fields().nth(at) {
        Some((row, field)) => row.number(field, 0.0),
        None => Ok(0.0),
    };
    Ok(Some(match law {
        "HARD" => return Ok(None),
        "LINEAR" => format!("surfaces would lie in each other by the pressure over {:?}", number(0)?),
        "EXPONENTIAL" => {
            format!("surfaces would press with {:?} where they touch, and from {:?} before", number(1)?, number(0)?)
        }
        _ => "surfaces would lie in each other by its table".into(),
    }))
}
