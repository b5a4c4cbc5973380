//! What acts in the steps of a deck, card by card: *BOUNDARY, *CLOAD, *DLOAD and *DSLOAD.

use super::amplitudes::{self, Amplitude};
use super::bodies::{Bodies, Owner};
use super::cards::Notes;
use super::contacts::faces_by_body;
use super::groups::{Groups, nodes_are};
use super::loads::{Clock, Load, Loads};
use super::materials::Material;
use super::supports::{DOFS, Supports, Wish};
use crate::error::{Error, Result};
use crate::mesh::Slot;
use crate::mesh::abaqus::{Card, Row, no_set};
use std::collections::BTreeMap;
use std::rc::Rc;

/// All that acts, as it is in the step that is being read.
#[derive(Default)]
pub(super) struct Conditions {
    pub step: usize,
    pub supports: Supports,
    /// Forces on nodes.
    pub forces: Loads,
    /// Pressures on faces, as vectors of one number.
    pub pressures: Loads,
    /// Forces per volume on bodies.
    pub body_forces: Loads,
}

/// What the cards refer to.
pub(super) struct Setting<'a> {
    pub groups: &'a Groups<'a>,
    pub bodies: &'a Bodies,
    pub materials: &'a [Material],
    pub amplitudes: &'a [Amplitude],
}

impl Conditions {
    /// Goes on to the next step.
    pub fn begin(&mut self, last: &Clock, next: &Clock, amplitudes: &[Amplitude]) -> Result<()> {
        self.step += 1;
        self.supports.begin(last, next, amplitudes)?;
        let kinds = [&mut self.forces, &mut self.pressures, &mut self.body_forces];
        kinds.into_iter().try_for_each(|loads| loads.begin(last, next, amplitudes))
    }

    /// Takes a card of the step.
    pub fn take(&mut self, card: &Card, setting: &Setting, notes: &mut Notes) -> Result<()> {
        let is_new = card.keyword.get("OP").is_some_and(|op| op.eq_ignore_ascii_case("NEW"));
        let amplitude = amplitudes::of(setting.amplitudes, card)?;
        match card.keyword.name.as_str() {
            "BOUNDARY" => {
                if is_new {
                    self.supports.reset();
                }
                card.rows.iter().try_for_each(|row| self.take_support(card, row, amplitude, setting, notes))
            }
            "CLOAD" => {
                if is_new {
                    self.forces.reset();
                }
                self.take_forces(card, amplitude, setting, notes)
            }
            "DLOAD" | "DSLOAD" => {
                if is_new {
                    self.pressures.reset();
                    self.body_forces.reset();
                }
                card.rows.iter().try_for_each(|row| self.take_distributed(card, row, amplitude, setting, notes))
            }
            _ => Ok(()),
        }
    }

    fn take_support(
        &mut self,
        card: &Card,
        row: &Row,
        amplitude: Option<usize>,
        setting: &Setting,
        notes: &mut Notes,
    ) -> Result<()> {
        if card.keyword.get("TYPE").is_some_and(|kind| !kind.eq_ignore_ascii_case("DISPLACEMENT")) {
            return Err(card.error("only displacements can be converted", "not velocities or accelerations"));
        }
        let [set, first, last, value] = row.fields();
        let nodes = nodes(setting, card, row, set)?;
        let value = row.number(value, 0.0)?;
        let (dofs, value) = match named_support(&first.to_uppercase()) {
            Some(dofs) => (dofs.to_vec(), 0.0),
            None => (range(row, first, last)?, value),
        };
        let value = (!card.keyword.has("FIXED")).then_some(value);
        if value == Some(0.0) && amplitude.is_some() {
            // What is held does not vary.
            return self.hold(row, set, &nodes, &dofs, (None, Some(0.0)), setting, notes);
        }
        self.hold(row, set, &nodes, &dofs, (amplitude, value), setting, notes)
    }

    #[allow(clippy::too_many_arguments)] // what a line says, and what it refers to
    fn hold(
        &mut self,
        row: &Row,
        set: &str,
        nodes: &[u32],
        dofs: &[usize],
        (amplitude, value): (Option<usize>, Option<f64>),
        setting: &Setting,
        notes: &mut Notes,
    ) -> Result<()> {
        let Split { of_bodies, of_rigids } = split(setting, row, nodes, notes)?;
        for &dof in dofs {
            let mut add = |hint: String, nodes: Rc<[u32]>, dof: usize| {
                if nodes.is_empty() {
                    return Ok(());
                }
                let twice = self.supports.add(Wish { at: row.at.clone(), hint, nodes, dof, amplitude, value })?;
                if let Some(node) = twice {
                    let node = setting.groups.whole.mesh.point_ids[node as usize];
                    let what =
                        format!("node {node} is held otherwise by an earlier line of this step: this line counts");
                    notes.at(&row.at, what);
                }
                Ok::<(), Error>(())
            };
            if dof < 3 {
                add(hint(set), of_bodies.clone(), dof)?;
            }
            for &(rigid, is_rotation) in &of_rigids {
                let body = &setting.bodies.rigids[rigid];
                // The displacements of a node for the rotations are these.
                let dof = if is_rotation { dof + 3 } else { dof };
                if dof < DOFS {
                    add(body.name.clone(), [body.reference].into(), dof)?;
                }
                if dof < 3 {
                    add(body.name.clone(), body.nodes.as_slice().into(), dof)?;
                }
            }
        }
        Ok(())
    }

    fn take_forces(
        &mut self,
        card: &Card,
        amplitude: Option<usize>,
        setting: &Setting,
        notes: &mut Notes,
    ) -> Result<()> {
        // The lines with single nodes are one load, as programs write that on a face.
        let mut loads: BTreeMap<(String, usize), Load> = BTreeMap::new();
        for row in &card.rows {
            let [set, dof, value] = row.fields();
            let nodes = nodes(setting, card, row, set)?;
            let Split { of_bodies, of_rigids } = split(setting, row, &nodes, notes)?;
            let dof: usize = match dof.parse() {
                Ok(dof @ 1..=3) => dof - 1,
                Ok(4..=6) => return Err(row.error("a moment cannot be converted", "nagata's loads are forces")),
                _ => return Err(row.error(format!("expected a direction 1 to 3, found '{dof}'"), "")),
            };
            let is_one = nodes.len() == 1 && of_rigids.is_empty();
            let name = if is_one { format!("loaded-{}", card.at.line) } else { hint(set) };
            for &(rigid, is_rotation) in &of_rigids {
                let body = &setting.bodies.rigids[rigid];
                if is_rotation || !body.nodes.is_empty() {
                    let what = format!("a force or moment on the rigid body of {} cannot be converted", body.at);
                    return Err(row.error(what, "it holds nodes of a body that deforms: load those"));
                }
            }
            let value = row.number(value, 0.0)?;
            let references = of_rigids.iter().map(|&(rigid, _)| setting.bodies.rigids[rigid].reference);
            let key = (name.to_uppercase(), dof);
            let load = loads.entry(key).or_insert_with(|| Load::new(&row.at, name, self.step, amplitude));
            for node in of_bodies.iter().copied().chain(references) {
                load.values.entry(node).or_insert([0.0; 3])[dof] += value;
            }
        }
        for ((_, dof), load) in loads {
            let at = load.at.clone();
            let twice = self.forces.add(load, [0, 1, 2].map(|axis| axis == dof));
            if let Some(&node) = twice.first() {
                let node = setting.groups.whole.mesh.point_ids[node as usize];
                let what =
                    format!("node {node} is loaded several times in one direction and step: the forces are added");
                notes.at(&at, what);
            }
        }
        Ok(())
    }

    fn take_distributed(
        &mut self,
        card: &Card,
        row: &Row,
        amplitude: Option<usize>,
        setting: &Setting,
        notes: &mut Notes,
    ) -> Result<()> {
        let [set, kind, value, x, y, z] = row.fields();
        let value = row.number(value, 0.0)?;
        let kind = kind.to_uppercase();
        let is_surface = card.keyword.name == "DSLOAD";
        if kind == "GRAV" && !is_surface {
            let along = [row.number(x, 0.0)?, row.number(y, 0.0)?, row.number(z, 0.0)?];
            return self.take_gravity(card, row, set, along.map(|part| part * value), amplitude, setting);
        }
        let side =
            kind.strip_prefix('P').and_then(|side| side.parse::<u8>().ok()).filter(|side| (1..=6).contains(side));
        let mut load = Load::new(&row.at, format!("{}-{kind}", hint(set)), self.step, amplitude);
        match side {
            None if is_surface && kind == "P" => {
                load.hint = hint(set);
                for (body, faces) in faces_by_body(setting.groups, setting.bodies, row, set)? {
                    if body.is_none() {
                        return Err(row.error("a pressure on a rigid body cannot be converted", "give its force"));
                    }
                    load.values.extend(faces.into_iter().map(|face| (face, [value, 0.0, 0.0])));
                }
            }
            Some(side) if !is_surface => {
                for face in self.sides(card, row, set, side - 1, setting)? {
                    load.values.insert(face, [value, 0.0, 0.0]);
                }
            }
            _ => {
                let what = format!("the load {kind} of *{} cannot be converted", card.keyword.name);
                return Err(row.error(what, "P of *DSLOAD, P1 to P6 and GRAV of *DLOAD can"));
            }
        }
        if !self.pressures.add(load, [true, false, false]).is_empty() {
            notes.at(&row.at, "a face has several pressures in one step: they are added");
        }
        Ok(())
    }

    /// One side of each element of a set.
    fn sides(&self, card: &Card, row: &Row, set: &str, side: u8, setting: &Setting) -> Result<Vec<u32>> {
        let whole = setting.groups.whole;
        let elements =
            whole.elements(card.place.as_deref(), set).ok_or_else(|| no_set(&row.at, "element or element set", set))?;
        let mut faces = Vec::new();
        for element in elements {
            let Slot::Solid(solid) = whole.slots[element as usize] else {
                let what = format!("a pressure on an element {} cannot be converted", whole.kind(element));
                return Err(row.error(what, "give it on the faces of solids"));
            };
            let solid = &whole.mesh.solids[solid as usize];
            if side as usize >= solid.shape.face_count() {
                return Err(row.error(format!("element {} has no face P{}", solid.id, side + 1), ""));
            }
            let facet = solid.face(side as usize);
            if !matches!(setting.bodies.owners[facet.nodes[0] as usize], Owner::Body(_)) {
                return Err(row.error("a pressure on a rigid body cannot be converted", "give its force"));
            }
            faces.push(setting.groups.face_of_key(&facet.key()).ok_or_else(|| {
                let what = format!("face P{} of element {} is not on a boundary", side + 1, solid.id);
                row.error(what, "it lies inside the body")
            })?);
        }
        Ok(faces)
    }

    fn take_gravity(
        &mut self,
        card: &Card,
        row: &Row,
        set: &str,
        along: [f64; 3],
        amplitude: Option<usize>,
        setting: &Setting,
    ) -> Result<()> {
        let whole = setting.groups.whole;
        let elements = match set {
            "" => (0..whole.slots.len() as u32).collect(),
            _ => whole.elements(card.place.as_deref(), set).ok_or_else(|| no_set(&row.at, "element set", set))?,
        };
        let mut has = vec![false; whole.mesh.solids.len()];
        for &element in &elements {
            if let Slot::Solid(solid) = whole.slots[element as usize] {
                has[solid as usize] = true;
            }
        }
        let mut load = Load::new(&row.at, String::new(), self.step, amplitude);
        for (body, index) in setting.bodies.bodies.iter().zip(0..) {
            let count = body.solids.iter().filter(|&&solid| has[solid as usize]).count();
            if count == 0 {
                continue;
            }
            if count < body.solids.len() {
                return Err(row.error(format!("gravity acts on a part of the body `{}` only", body.name), ""));
            }
            let density = body.density(setting.materials).ok_or_else(|| {
                let what = format!("the body `{}` has no density for gravity, or several", body.name);
                row.error(what, "give its material a *DENSITY")
            })?;
            load.values.insert(index, along.map(|part| part * density));
        }
        self.body_forces.add(load, [true; 3]);
        Ok(())
    }
}

/// Nodes of bodies, and the rigid bodies whose reference nodes, or nodes of rotation, are among them.
struct Split {
    of_bodies: Rc<[u32]>,
    of_rigids: Vec<(usize, bool)>,
}

fn split(setting: &Setting, row: &Row, nodes: &[u32], notes: &mut Notes) -> Result<Split> {
    let (mut of_bodies, mut of_rigids, mut of_nothing) = (Vec::new(), Vec::new(), Vec::new());
    for &node in nodes {
        match setting.bodies.owners[node as usize] {
            Owner::Body(_) => of_bodies.push(node),
            Owner::Nothing => of_nothing.push(node),
            Owner::Rigid(rigid) => {
                let body = &setting.bodies.rigids[rigid];
                match node {
                    _ if body.reference == node => of_rigids.push((rigid, false)),
                    _ if body.rotations == Some(node) => of_rigids.push((rigid, true)),
                    _ => {
                        let what =
                            format!("{} of the rigid body of {}", nodes_are(setting.groups.whole, &[node]), body.at);
                        return Err(row.error(what, "hold, move and load its reference node instead"));
                    }
                }
            }
        }
    }
    if !of_nothing.is_empty() {
        let what =
            format!("{} of no body: the condition there is passed over", nodes_are(setting.groups.whole, &of_nothing));
        notes.at(&row.at, what);
    }
    Ok(Split { of_bodies: of_bodies.into(), of_rigids })
}

fn nodes(setting: &Setting, card: &Card, row: &Row, set: &str) -> Result<Vec<u32>> {
    let whole = setting.groups.whole;
    whole.nodes(card.place.as_deref(), set).ok_or_else(|| no_set(&row.at, "node or node set", set))
}

/// A name for the nodes of a field.
fn hint(field: &str) -> String {
    let field = field.trim_matches('"');
    match field.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("node-{field}"),
        false => field.to_string(),
    }
}

/// The degrees of freedom, from 0, that a word of Abaqus holds.
fn named_support(word: &str) -> Option<&'static [usize]> {
    Some(match word {
        "ENCASTRE" => &[0, 1, 2, 3, 4, 5],
        "PINNED" => &[0, 1, 2],
        "XSYMM" => &[0, 4, 5],
        "YSYMM" => &[1, 3, 5],
        "ZSYMM" => &[2, 3, 4],
        "XASYMM" => &[1, 2, 3],
        "YASYMM" => &[0, 2, 4],
        "ZASYMM" => &[0, 1, 5],
        _ => return None,
    })
}

/// The degrees of freedom, from 0, from first to last.
fn range(row: &Row, first: &str, last: &str) -> Result<Vec<usize>> {
    let number = |field: &str| {
        let found = field.parse::<usize>().ok().filter(|dof| (1..=DOFS).contains(dof));
        found.ok_or_else(|| row.error(format!("expected a degree of freedom 1 to 6, found '{field}'"), ""))
    };
    let from = number(first)?;
    let to = if last.is_empty() { from } else { number(last)? };
    match from <= to {
        true => Ok((from - 1..to).collect()),
        false => Err(row.error("the first degree of freedom is behind the last", "")),
    }
}
