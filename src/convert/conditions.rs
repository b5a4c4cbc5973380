//! What acts in the steps of a deck, card by card: *BOUNDARY, *CLOAD, *DLOAD and *DSLOAD.

use super::amplitudes::{self, Amplitude};
use super::bodies::{self, Bodies, Owner};
use super::cards::{Notes, is_new};
use super::contacts::faces_by_body;
use super::frames::{Frames, vectors};
use super::groups::{Groups, nodes_are};
use super::loads::{Clock, Load, Loads};
use super::materials::Material;
use super::supports::{DOFS, Supports, Wish};
use crate::error::{Error, Faults, Location, Result};
use crate::mesh::abaqus::{Card, LOWEST, Row, no_set};
use crate::mesh::{Made, Slot, is_made};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// All that acts, as it is in the step that is being read.
#[derive(Default)]
pub(super) struct Conditions {
    pub step: usize,
    /// The kinds of cards that there were in the step, and whether the first of each has OP=NEW.
    kinds_given: BTreeMap<String, bool>,
    pub supports: Supports,
    /// Forces on nodes.
    pub forces: Loads,
    /// Moments on rigid bodies, by their reference nodes.
    pub moments: Loads,
    /// Pressures on faces, as vectors of one number.
    pub pressures: Loads,
    /// Accelerations of [sections](Bodies::sections).
    pub gravity: Loads,
    /// Squares of the angular velocity of sections, as vectors of one number, and the axis of all: a point and a direction.
    pub spins: Loads,
    /// Rigid bodies on whose mass gravity or a spin acts.
    pub heavy: BTreeSet<usize>,
    /// Whether *DLOAD, and *DSLOAD, have given loads that act.
    distributed: [bool; 2],
    /// The first card of the step whose OP=NEW takes off what the other of the two has given.
    taken_off: Option<(Location, &'static str)>,
    pub spin_axis: Option<[[f64; 3]; 2]>,
}

/// What the cards refer to, and where what is passed over is told.
pub(super) struct Setting<'a> {
    pub groups: &'a Groups<'a>,
    pub bodies: &'a Bodies,
    pub frames: &'a Frames,
    pub materials: &'a [Material],
    pub amplitudes: &'a [Amplitude],
    pub notes: &'a mut Notes,
}

/// A line of a card as it is read.
struct Line<'a, 'b> {
    card: &'a Card,
    row: &'a Row,
    amplitude: Option<usize>,
    setting: &'a mut Setting<'b>,
}

impl Conditions {
    /// Goes on to the next step.
    pub fn begin(&mut self, last: &Clock, next: &Clock, amplitudes: &[Amplitude]) {
        self.step += 1;
        self.kinds_given.clear();
        self.taken_off = None;
        self.supports.begin(last, next, amplitudes);
        let kinds = [&mut self.forces, &mut self.moments, &mut self.pressures, &mut self.gravity, &mut self.spins];
        kinds.into_iter().for_each(|loads| loads.begin(last, next, amplitudes));
    }

    /// After the cards of a step: refuses what goes on from the step before and cannot.
    pub fn check(&mut self, made: &[Made]) -> Result<()> {
        self.supports.complete(made);
        self.supports.check()?;
        self.kinds().into_iter().try_for_each(Loads::check)
    }

    fn kinds(&self) -> [&Loads; 5] {
        [&self.forces, &self.moments, &self.pressures, &self.gravity, &self.spins]
    }

    /// Tells of distributed loads that a card of another kind takes off, and that are not given again in the step.
    pub fn tell_of_taken_off(&self, notes: &mut Notes) {
        let Some((at, other)) = &self.taken_off else { return };
        if !self.kinds_given.contains_key(*other) {
            let what = format!(
                "OP=NEW takes off what *{other} has given, too, as in CalculiX; Abaqus leaves that: give it again if it is to act on"
            );
            notes.at(at, what);
        }
    }

    /// All loads.
    pub fn loads(&self) -> impl Iterator<Item = &Load> {
        self.kinds().into_iter().flat_map(Loads::live)
    }

    /// Takes a card of the step.
    pub fn take(&mut self, card: &Card, setting: &mut Setting) -> Result<()> {
        let is_new = is_new(card);
        let begins_anew = *self.kinds_given.entry(card.keyword.name.clone()).or_insert(is_new);
        if is_new && !begins_anew {
            let what = "OP=NEW comes after a card of its kind without it in the same step: CalculiX passes it over, and others do not";
            return Err(card.error(what, "give it with the first card of the step"));
        }
        let amplitude = amplitudes::of(setting.amplitudes, card)?;
        let mut lines = |take: &mut dyn FnMut(Line) -> Result<()>| {
            Faults::all(card.rows.iter().map(|row| take(Line { card, row, amplitude, setting }))).map(|_| ())
        };
        match card.keyword.name.as_str() {
            "BOUNDARY" => {
                if is_new {
                    self.supports.reset();
                }
                lines(&mut |mut line| self.take_support(&mut line))
            }
            "CLOAD" => {
                if is_new {
                    self.forces.reset(self.step);
                    self.moments.reset(self.step);
                }
                // The lines with single nodes are one load, as programs write that on a face.
                let mut loads = BTreeMap::new();
                lines(&mut |mut line| self.take_force(&mut line, &mut loads))?;
                self.add_forces(loads, setting);
                Ok(())
            }
            "DLOAD" | "DSLOAD" => {
                let kind = usize::from(card.keyword.name == "DSLOAD");
                if is_new {
                    if self.distributed[1 - kind] {
                        self.taken_off.get_or_insert((card.at.clone(), ["DSLOAD", "DLOAD"][kind]));
                    }
                    self.pressures.reset(self.step);
                    self.gravity.reset(self.step);
                    self.spins.reset(self.step);
                    self.distributed = [false; 2];
                }
                self.distributed[kind] |= !card.rows.is_empty();
                lines(&mut |mut line| self.take_distributed(&mut line))
            }
            _ => Ok(()),
        }
    }

    fn take_support(&mut self, line: &mut Line) -> Result<()> {
        let (card, row) = (line.card, line.row);
        if card.keyword.get("TYPE").is_some_and(|kind| !kind.eq_ignore_ascii_case("DISPLACEMENT")) {
            return Err(card.error("only displacements can be converted", "not velocities or accelerations"));
        }
        let [set, first, last, value] = row.fields();
        let value = row.number(value, 0.0)?;
        let (dofs, value) = match named_support(&first.to_uppercase()) {
            Some(dofs) => (dofs.to_vec(), 0.0),
            None => (range(row, first, last)?, value),
        };
        let value = (!card.keyword.has("FIXED")).then_some(value);
        // What is held does not vary.
        let amplitude = line.amplitude.filter(|_| value != Some(0.0));
        let Split { of_bodies, of_rigids } = line.split(set)?;
        let mut hold = |hint: String, nodes: Rc<[u32]>, dof: usize| {
            if nodes.is_empty() {
                return Ok(());
            }
            let twice = self.supports.add(Wish { at: row.at.clone(), hint, nodes, dof, amplitude, value })?;
            if let Some(node) = twice {
                let node = line.setting.groups.whole.mesh.point_ids[node as usize];
                let what = format!(
                    "node {node} is held otherwise by an earlier line that counts in this step: this one counts"
                );
                line.setting.notes.at(&row.at, what);
            }
            Ok::<(), Error>(())
        };
        for dof in dofs {
            if dof < 3 {
                hold(hint(set), of_bodies.clone(), dof)?;
            }
            for &(rigid, is_rotation) in &of_rigids {
                let body = &line.setting.bodies.rigids[rigid];
                // The displacements of a node for the rotations are these.
                let dof = if is_rotation { dof + 3 } else { dof };
                if dof < DOFS {
                    hold(body.name.clone(), [body.reference].into(), dof)?;
                }
                if dof < 3 {
                    hold(body.name.clone(), body.nodes.as_slice().into(), dof)?;
                }
            }
        }
        Ok(())
    }

    fn take_force(&mut self, line: &mut Line, loads: &mut BTreeMap<(String, usize), Load>) -> Result<()> {
        let row = line.row;
        let [set, dof, value] = row.fields();
        let is_one = line.nodes(set)?.len() == 1;
        let Split { of_bodies, of_rigids } = line.split(set)?;
        // A force for each node of a set: those that the deck lacks have none.
        let made = &line.setting.groups.whole.made;
        let of_bodies: Vec<u32> = of_bodies.iter().copied().filter(|&node| !is_made(made, node)).collect();
        let dof: usize = match dof.parse() {
            Ok(dof @ 1..=DOFS) => dof - 1,
            _ => return Err(row.error(format!("expected a degree of freedom 1 to 6, found '{dof}'"), "")),
        };
        if dof >= 3 && !of_bodies.is_empty() {
            return Err(row.error("a moment on nodes of a body cannot be converted", "solids have no rotations"));
        }
        if let Some(&node) = of_bodies.iter().find(|&&node| line.setting.frames.has(node)) {
            let what = format!(
                "{} of a *TRANSFORM: forces there cannot be converted",
                nodes_are(line.setting.groups.whole, &[node])
            );
            return Err(row.error(what, "load other nodes, along the global axes, or the faces by a pressure"));
        }
        let is_one = is_one && of_rigids.is_empty();
        let name = if is_one { format!("loaded-{}", line.card.at.line) } else { hint(set) };
        let value = row.number(value, 0.0)?;
        let mut acts: Vec<(u32, usize)> = of_bodies.iter().map(|&node| (node, dof)).collect();
        for &(rigid, is_rotation) in &of_rigids {
            let body = &line.setting.bodies.rigids[rigid];
            if !body.nodes.is_empty() {
                let what = format!("a force or moment on the rigid body of {} cannot be converted", body.at);
                return Err(row.error(what, "it holds nodes of a body that deforms: load those"));
            }
            // The forces on a node for the rotations are moments.
            acts.push((body.reference, if is_rotation { dof + 3 } else { dof }));
        }
        for (node, dof) in acts.into_iter().filter(|(_, dof)| *dof < DOFS) {
            let new = || Load::new(&row.at, name.clone(), self.step, line.amplitude);
            let load = loads.entry((name.to_uppercase(), dof)).or_insert_with(new);
            load.values.entry(node).or_insert([0.0; 3])[dof % 3] += value;
        }
        Ok(())
    }

    /// The forces of a card, by names for what they act on and degrees of freedom.
    fn add_forces(&mut self, loads: BTreeMap<(String, usize), Load>, setting: &mut Setting) {
        for ((_, dof), load) in loads {
            let at = load.at.clone();
            let kind = if dof < 3 { &mut self.forces } else { &mut self.moments };
            let twice = kind.add(load, [0, 1, 2].map(|axis| axis == dof % 3));
            if let Some(&node) = twice.first() {
                let node = setting.groups.whole.mesh.point_ids[node as usize];
                let what =
                    format!("node {node} is loaded several times in one direction and step: the forces are added");
                setting.notes.at(&at, what);
            }
        }
    }

    fn take_distributed(&mut self, line: &mut Line) -> Result<()> {
        let row = line.row;
        let [set, kind, value, x, y, z] = row.fields();
        let value = row.number(value, 0.0)?;
        let kind = kind.to_uppercase();
        let is_surface = line.card.keyword.name == "DSLOAD";
        if kind == "GRAV" && !is_surface {
            let along = [row.number(x, 0.0)?, row.number(y, 0.0)?, row.number(z, 0.0)?];
            let length = along.iter().map(|part| part * part).sum::<f64>().sqrt();
            if length == 0.0 {
                return Err(row.error("gravity has no direction", "write its value and a unit vector"));
            }
            self.heavy.extend(line.rigids_of(set)?);
            let load = line.on_sections("gravity", set, along.map(|part| part / length * value), self.step)?;
            self.gravity.add(load, [true; 3]);
            return Ok(());
        }
        if kind == "CENTRIF" && !is_surface {
            return self.take_spin(line, value);
        }
        let side =
            kind.strip_prefix('P').and_then(|side| side.parse::<u8>().ok()).filter(|side| (1..=6).contains(side));
        let mut load = Load::new(&row.at, format!("{}-{kind}", hint(set)), self.step, line.amplitude);
        match side {
            None if is_surface && kind == "P" => {
                load.hint = hint(set);
                for (body, faces) in faces_by_body(line.setting.groups, line.setting.bodies, row, set)? {
                    if body.is_none() {
                        return Err(row.error("a pressure on a rigid body cannot be converted", "give its force"));
                    }
                    load.values.extend(faces.into_iter().map(|face| (face, [value, 0.0, 0.0])));
                }
            }
            Some(side) if !is_surface => {
                let lowest = if line.setting.groups.whole.mesh.is_section { LOWEST } else { 0 };
                for face in line.sides(set, side - 1 + lowest)? {
                    load.values.insert(face, [value, 0.0, 0.0]);
                }
            }
            _ => {
                let what = format!("the load {kind} of *{} cannot be converted", line.card.keyword.name);
                return Err(row.error(what, "P of *DSLOAD, P1 to P6, GRAV and CENTRIF of *DLOAD can"));
            }
        }
        if !self.pressures.add(load, [true, false, false]).is_empty() {
            line.setting.notes.at(&row.at, "a face has several pressures in one step: they are added");
        }
        Ok(())
    }
}

impl Conditions {
    /// A centrifugal load with this square of the angular velocity.
    fn take_spin(&mut self, line: &mut Line, square: f64) -> Result<()> {
        let row = line.row;
        let fields: [&str; 9] = row.fields();
        let axis = vectors(row, &fields[3..])?;
        if axis[1] == [0.0; 3] || square < 0.0 {
            let help = "write the square of the angular velocity, a point of the axis, and its direction";
            return Err(row.error("CENTRIF has no axis, or a square below 0", help));
        }
        if *self.spin_axis.get_or_insert(axis) != axis {
            let what = "CENTRIF about several axes, or about one that is written in several ways, cannot be converted";
            return Err(row.error(what, "give all lines the same point and direction"));
        }
        self.heavy.extend(line.rigids_of(fields[0])?);
        let load = line.on_sections("CENTRIF", fields[0], [square, 0.0, 0.0], self.step)?;
        self.spins.add(load, [true, false, false]);
        Ok(())
    }
}

/// Nodes of bodies, and the rigid bodies whose reference nodes, or nodes of rotation, are among them.
struct Split {
    of_bodies: Rc<[u32]>,
    of_rigids: Vec<(usize, bool)>,
}

impl Line<'_, '_> {
    fn nodes(&self, set: &str) -> Result<Vec<u32>> {
        let found = self.setting.groups.whole.nodes(self.card.place.as_deref(), set);
        found.ok_or_else(|| no_set(&self.row.at, "node or node set", set))
    }

    fn elements(&self, set: &str) -> Result<Vec<u32>> {
        let found = self.setting.groups.whole.elements(self.card.place.as_deref(), set);
        found.ok_or_else(|| no_set(&self.row.at, "element or element set", set))
    }

    fn split(&mut self, set: &str) -> Result<Split> {
        let (mut of_bodies, mut of_rigids, mut of_nothing) = (Vec::new(), Vec::new(), Vec::new());
        let (whole, bodies) = (self.setting.groups.whole, self.setting.bodies);
        for node in self.nodes(set)? {
            match bodies.owners[node as usize] {
                Owner::Body(_) => of_bodies.push(node),
                Owner::Nothing => of_nothing.push(node),
                Owner::Rigid(rigid) => {
                    let body = &bodies.rigids[rigid];
                    match node {
                        _ if body.reference == node => of_rigids.push((rigid, false)),
                        _ if body.rotations == Some(node) => of_rigids.push((rigid, true)),
                        _ => {
                            let what = format!("{} of the rigid body of {}", nodes_are(whole, &[node]), body.at);
                            return Err(self.row.error(what, "hold, move and load its reference node instead"));
                        }
                    }
                }
            }
        }
        if !of_nothing.is_empty() {
            let what = format!("{} of no body: the condition there is passed over", nodes_are(whole, &of_nothing));
            self.setting.notes.at(&self.row.at, what);
        }
        Ok(Split { of_bodies: of_bodies.into(), of_rigids })
    }

    /// One side of each element of a set.
    fn sides(&self, set: &str, side: u8) -> Result<Vec<u32>> {
        let (row, setting) = (self.row, &self.setting);
        let whole = setting.groups.whole;
        let mut faces = Vec::new();
        for element in self.elements(set)? {
            let Slot::Solids { first, count } = whole.slots[element as usize] else {
                let what = format!("a pressure on an element {} cannot be converted", whole.kind(element));
                return Err(row.error(what, "give it on the faces of solids"));
            };
            let id = whole.mesh.solids[first as usize].id;
            let own = whole.sides.faces(&whole.mesh.solids, (first, count), side);
            for (solid, face) in own.ok_or_else(|| row.error(format!("element {id} has no face P{}", side + 1), ""))? {
                let facet = whole.mesh.solids[solid as usize].face(face as usize);
                if !matches!(setting.bodies.owners[facet.nodes[0] as usize], Owner::Body(_)) {
                    return Err(row.error("a pressure on a rigid body cannot be converted", "give its force"));
                }
                faces.push(setting.groups.face_of_key(&facet.key()).ok_or_else(|| {
                    let what = format!("face P{} of element {id} is not on a boundary", side + 1);
                    row.error(what, "it lies inside the body")
                })?);
            }
        }
        Ok(faces)
    }

    /// The rigid bodies that have mass, by elements of a set.
    fn rigids_of(&self, set: &str) -> Result<BTreeSet<usize>> {
        let (whole, owners) = (self.setting.groups.whole, &self.setting.bodies.owners);
        let elements = if set.is_empty() { (0..whole.slots.len() as u32).collect() } else { self.elements(set)? };
        let heavy = elements.into_iter().filter(|&element| !whole.kind(element).starts_with("R3D"));
        let rigid = |element: u32| {
            let of = |node: &u32| match owners[*node as usize] {
                Owner::Rigid(rigid) => Some(rigid),
                _ => None,
            };
            let slot = whole.slots[element as usize];
            let mut all = bodies::nodes_of(whole, slot).into_iter().map(|node| of(&node));
            let first = all.next().flatten().filter(|_| slot.solids().len() + slot.facets().len() > 0);
            first.filter(|first| all.all(|other| other == Some(*first)))
        };
        Ok(heavy.filter_map(rigid).collect())
    }

    /// What acts on the mass of elements, as a load on sections.
    fn on_sections(&self, kind: &str, set: &str, value: [f64; 3], step: usize) -> Result<Load> {
        let setting = &self.setting;
        let whole = setting.groups.whole;
        let elements = if set.is_empty() { (0..whole.slots.len() as u32).collect() } else { self.elements(set)? };
        let mut has = vec![false; whole.mesh.solids.len()];
        for element in elements {
            whole.slots[element as usize].solids().for_each(|solid| has[solid as usize] = true);
        }
        let mut load = Load::new(&self.row.at, String::new(), step, self.amplitude);
        for ((body, material, solids), section) in setting.bodies.sections().zip(0..) {
            let count = solids.iter().filter(|&&solid| has[solid as usize]).count();
            if count == 0 {
                continue;
            }
            let Material { deck, density, .. } = &setting.materials[material];
            if count < solids.len() {
                let what = format!("{kind} acts on a part of what of the body `{}` is of '{deck}'", body.name);
                return Err(self.row.error(what, "let it act on all elements of the material, or on none"));
            }
            if density.is_none() {
                let what = format!("{kind} acts on the body `{}`, but its material '{deck}' has no density", body.name);
                return Err(self.row.error(what, "give the material a *DENSITY"));
            }
            load.values.insert(section, value);
        }
        Ok(load)
    }
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
pub(super) fn range(row: &Row, first: &str, last: &str) -> Result<Vec<usize>> {
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
