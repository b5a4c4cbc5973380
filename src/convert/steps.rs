//! *STEP with *STATIC, and the steps of the scene that they become: one each, or several where amplitudes bend.

use super::amplitudes::Amplitude;
use super::bodies::{Bodies, Owner};
use super::cards::Notes;
use super::conditions::{Conditions, Setting};
use super::contacts::Tool;
use super::frames::Frames;
use super::groups::Groups;
use super::loads::{Clock, Loads};
use super::materials::Material;
use super::names::Namer;
use super::planes::Still;
use super::scene::{self, Lists};
use super::springs::Springs;
use super::supported::Support;
use super::supports::DOFS;
use super::tables;
use crate::AXIS_NAMES;
use crate::error::{Error, Faults, Result};
use crate::mesh::abaqus::Card;
use std::collections::BTreeMap;

/// Most steps of a scene that amplitudes may make of one.
const MOST_PIECES: usize = 100;

/// A step of the deck.
struct Step<'a> {
    card: &'a Card,
    cards: Vec<&'a Card>,
    times: Times,
}

/// The data of *STATIC.
#[derive(Clone, Copy)]
struct Times {
    initial: f64,
    period: f64,
    min: Option<f64>,
    max: f64,
}

/// What the steps are made of.
pub(super) struct Model<'a> {
    pub bodies: &'a Bodies,
    pub tools: &'a [Tool],
    pub frames: &'a Frames,
    pub materials: &'a [Material],
    pub amplitudes: &'a [Amplitude],
    pub springs: Springs,
}

/// The tables of all steps, the sets that are held or moved, and the nodes that never are moved.
pub(super) fn convert(
    groups: &mut Groups,
    model: &Model,
    namer: &mut Namer,
    notes: &mut Notes,
) -> Result<(String, Vec<String>, Still)> {
    let whole = groups.whole;
    let (before, steps) = split(&whole.cards)?;
    let mut conditions = Conditions::default();
    let mut clock = Clock::default();
    let (mut text, mut history, mut still) = (String::new(), Vec::new(), Still::default());
    let mut axes = BTreeMap::new();
    let mut ended = Lists::default();
    for (number, step) in steps.iter().enumerate() {
        let next = Clock { before: clock.before + clock.period, period: step.times.period };
        let Model { bodies, frames, materials, amplitudes, .. } = *model;
        let mut setting = Setting { groups, bodies, frames, materials, amplitudes, notes };
        if number > 0 {
            conditions.begin(&clock, &next, amplitudes);
        }
        clock = next;
        let first = if number == 0 { &before[..] } else { &[] };
        Faults::all(first.iter().chain(&step.cards).map(|card| conditions.take(card, &mut setting)))?;
        conditions.check(&whole.made)?;
        still.meet(&conditions.supports, frames);
        conditions.tell_of_taken_off(notes);
        let jumps = tell_of_jumps(&conditions, &clock, (model.amplitudes, &step.times), notes);
        tell_of_step(step, notes);
        let mut ends = bends(&conditions, &clock, model.amplitudes);
        let first = step.times.initial / step.times.period;
        if jumps && first < ends[1] {
            ends.insert(1, first);
        }
        let mut writer = Writer { groups, model, conditions: &conditions, clock, axes: &mut axes, step };
        let mut parts: Vec<Lists> =
            ends.windows(2).map(|span| writer.lists(span[0], span[1])).collect::<Result<_>>()?;
        for Support { set, .. } in parts.iter().flat_map(|part| &part.supports) {
            if !history.contains(set) {
                history.push(set.clone());
            }
        }
        let name = step.card.keyword.get("NAME").map_or(format!("step-{}", number + 1), str::to_string);
        match tables::joined(&ended, &parts, &ends) {
            Some(whole) => text += &scene::step(&namer.name(&name, "step"), &step.times.of(0.0, 1.0), &whole),
            None if parts.len() > MOST_PIECES => {
                let what = format!("amplitudes turn the direction of a load or motion at {} times", parts.len() - 1);
                return Err(step.card.error(what, "each becomes a step of the scene: give them fewer points"));
            }
            None => {
                for (piece, (span, lists)) in ends.windows(2).zip(&parts).enumerate() {
                    let name = namer.name(&format!("{name}-{}", piece + 1), "step");
                    text += &scene::step(&name, &step.times.of(span[0], span[1]), lists);
                }
            }
        }
        ended = parts.pop().unwrap_or_default();
    }
    Ok((text, history, still))
}

impl Times {
    fn read(step: &Card, cards: &[&Card]) -> Result<Self> {
        let Some(card) = cards.iter().find(|card| card.keyword.name == "STATIC") else {
            return Err(step.error("the step has no *STATIC", "nagata computes static steps"));
        };
        let fields: [&str; 4] = card.rows.first().map_or([""; 4], |row| row.fields());
        let number = |at: usize, default: f64| match card.rows.first() {
            Some(row) => row.number(fields[at], default),
            None => Ok(default),
        };
        let period = number(1, 1.0)?;
        let period = if period == 0.0 { 1.0 } else { period };
        let initial = Some(number(0, 0.0)?).filter(|initial| *initial != 0.0).unwrap_or(period);
        let min = Some(number(2, 0.0)?).filter(|min| *min != 0.0);
        let max = Some(number(3, 0.0)?).filter(|max| *max != 0.0).unwrap_or(period);
        if [initial, period, max, min.unwrap_or(1.0)].iter().any(|time| *time <= 0.0) {
            return Err(card.error("times must be above 0", "first increment, period, shortest and longest increment"));
        }
        let max = if card.keyword.has("DIRECT") { initial } else { max };
        Ok(Self { initial: initial.min(period), period, min, max: max.min(period) })
    }

    /// Of a part of the step.
    fn of(&self, from: f64, to: f64) -> scene::Times {
        let duration = if (from, to) == (0.0, 1.0) { self.period } else { self.period * (to - from) };
        let max = self.max.max(self.initial).min(duration);
        let initial = self.initial.min(duration);
        scene::Times { duration, initial, max, min: self.min.filter(|min| *min <= initial) }
    }
}

/// The cards before the first step, and the steps.
fn split(cards: &[Card]) -> Result<(Vec<&Card>, Vec<Step<'_>>)> {
    let (mut before, mut steps): (Vec<&Card>, Vec<(&Card, Vec<&Card>)>) = (Vec::new(), Vec::new());
    for card in cards {
        match (card.keyword.name.as_str(), steps.last_mut()) {
            ("STEP", _) => steps.push((card, Vec::new())),
            (_, None) => before.push(card),
            (_, Some((_, inside))) => inside.push(card),
        }
    }
    if steps.is_empty() {
        return Err(Error::input_anywhere("the deck has no *STEP", "a scene needs one or more"));
    }
    let steps = steps.into_iter().map(|(card, cards)| Ok(Step { card, times: Times::read(card, &cards)?, cards }));
    Ok((before, steps.collect::<Result<_>>()?))
}

fn tell_of_step(step: &Step, notes: &mut Notes) {
    let keyword = &step.card.keyword;
    if !keyword.has("NLGEOM") || keyword.is_off("NLGEOM") {
        notes.at(&step.card.at, "the step is geometrically linear in the deck: nagata takes finite displacements");
    }
    if let Some(card) = step.cards.iter().find(|card| card.keyword.has("STABILIZE")) {
        notes.at(&card.at, "STABILIZE is passed over: nagata adds no viscous forces");
    }
    if keyword.get("AMPLITUDE").is_some_and(|value| value.eq_ignore_ascii_case("STEP")) {
        notes.at(&step.card.at, "AMPLITUDE=STEP is passed over: loads rise linearly over the step");
    }
}

/// Tells of conditions that jump as the step begins, and whether there are any: they are where the deck has them at the end of the
/// first increment.
fn tell_of_jumps(
    conditions: &Conditions,
    clock: &Clock,
    (amplitudes, times): (&[Amplitude], &Times),
    notes: &mut Notes,
) -> bool {
    let mut what = "the amplitude begins with a jump, which becomes a ramp over the first increment".to_string();
    if times.initial == times.period {
        what += ", which is all of the step: give the step a shorter one";
    }
    let holds = conditions.supports.acting().into_iter().map(|(hold, _)| hold);
    let jumping = holds.filter(|hold| hold.jumps(clock, amplitudes)).map(|hold| &hold.at);
    let loads = conditions.loads().filter(|load| load.jumps(clock, amplitudes));
    let mut places: Vec<_> = jumping.chain(loads.map(|load| &load.at)).collect();
    places.dedup();
    places.iter().for_each(|at| notes.at(at, &*what));
    !places.is_empty()
}

/// Fractions of the step, from 0 to 1, between which all is linear.
fn bends(conditions: &Conditions, clock: &Clock, amplitudes: &[Amplitude]) -> Vec<f64> {
    let holds = conditions.supports.acting().into_iter().filter_map(|(hold, _)| hold.amplitude);
    let loads = conditions.loads().filter_map(|load| load.amplitude);
    let mut ends = vec![0.0, 1.0];
    holds.chain(loads).for_each(|amplitude| ends.extend(clock.bends(&amplitudes[amplitude])));
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|b, a| *b - *a < 1e-9);
    // The end itself, not a point a rounding before it.
    ends.pop();
    ends.push(1.0);
    ends
}

/// Writes the conditions of a part of a step.
struct Writer<'a, 'b> {
    groups: &'a mut Groups<'b>,
    model: &'a Model<'a>,
    conditions: &'a Conditions,
    clock: Clock,
    /// The axis about which each rigid body turns.
    axes: &'a mut BTreeMap<usize, usize>,
    step: &'a Step<'a>,
}

impl Writer<'_, '_> {
    fn lists(&mut self, from: f64, to: f64) -> Result<Lists> {
        let mut lists = Lists::default();
        self.supports(from, to, &mut lists)?;
        self.tools(from, to, &mut lists)?;
        self.forces(to, &mut lists)?;
        self.pressures(to, &mut lists)?;
        self.gravity(to, &mut lists)?;
        self.spins(to, &mut lists)?;
        self.springs(&mut lists)?;
        Ok(lists)
    }

    /// Gravity by the densities of the scene where it acts on all alike, else by force on bodies.
    fn gravity(&mut self, s: f64, lists: &mut Lists) -> Result<()> {
        let Model { bodies, materials, amplitudes, .. } = self.model;
        let mut along = vec![[0.0; 3]; bodies.sections().count()];
        let mut last = None;
        for (load, field) in self.conditions.gravity.at(s, &self.clock, amplitudes) {
            for (section, part) in field {
                (0..3).for_each(|d| along[section as usize][d] += part[d]);
                last = Some(load);
            }
        }
        let Some(load) = last else { return Ok(()) };
        if along.windows(2).all(|pair| pair[0] == pair[1]) {
            scene::add(&mut lists.gravity, "", along[0]);
            return Ok(());
        }
        let mut forces: BTreeMap<&str, [f64; 3]> = BTreeMap::new();
        for ((body, material, _), along) in bodies.sections().zip(along) {
            let force = along.map(|part| part * materials[material].density.unwrap_or(0.0));
            if *forces.entry(&body.name).or_insert(force) != force {
                let name = &body.name;
                let what =
                    format!("gravity pulls differently at materials of the body `{name}`, and not alike at all bodies");
                return Err(Error::input(
                    &load.at,
                    what,
                    "let it act on all elements of the deck, or take one density",
                ));
            }
        }
        for (body, force) in forces.into_iter().filter(|(_, force)| *force != [0.0; 3]) {
            scene::add(&mut lists.body_forces, body, force);
        }
        Ok(())
    }

    /// Bodies whose sections all spin alike.
    fn spins(&mut self, s: f64, lists: &mut Lists) -> Result<()> {
        let Model { bodies, amplitudes, .. } = self.model;
        let mut squares = vec![0.0; bodies.sections().count()];
        let mut last = None;
        for (load, field) in self.conditions.spins.at(s, &self.clock, amplitudes) {
            for (section, [square, ..]) in field {
                squares[section as usize] += square;
                last = Some(load);
            }
        }
        let Some(load) = last else { return Ok(()) };
        let mut of_bodies: BTreeMap<&str, f64> = BTreeMap::new();
        for ((body, ..), square) in bodies.sections().zip(squares) {
            if *of_bodies.entry(&body.name).or_insert(square) != square {
                let what = format!("materials of the body `{}` spin at different speeds", body.name);
                return Err(Error::input(&load.at, what, "let CENTRIF act on all of its elements alike"));
            }
        }
        lists.spin_axis = self.conditions.spin_axis;
        for (body, square) in of_bodies.into_iter().filter(|(_, square)| *square != 0.0) {
            scene::add(&mut lists.spins, body, [square, 0.0, 0.0]);
        }
        Ok(())
    }

    fn springs(&mut self, lists: &mut Lists) -> Result<()> {
        let springs = &self.model.springs;
        for (body, nodes) in self.by_body(&springs.keys().copied().collect::<Vec<_>>()) {
            let mut alike: BTreeMap<[u64; 3], Vec<u32>> = BTreeMap::new();
            nodes.iter().for_each(|node| alike.entry(springs[node].map(f64::to_bits)).or_default().push(*node));
            for (bits, own) in alike {
                let set = self.set(body, &own, true, "springs")?;
                lists.springs.push((set, bits.map(|bits| f64::from_bits(bits) * own.len() as f64)));
            }
        }
        Ok(())
    }

    fn supports(&mut self, from: f64, to: f64, lists: &mut Lists) -> Result<()> {
        let (conditions, clock, amplitudes) = (self.conditions, self.clock, self.model.amplitudes);
        for (hold, left) in conditions.supports.acting().into_iter().filter(|(hold, _)| hold.dof < 3) {
            let by = hold.by(from, to, &clock, amplitudes);
            let same = |&node: &u32| {
                let other = conditions.supports.of(node, hold.dof);
                other.is_some_and(|other| other.by(from, to, &clock, amplitudes).to_bits() == by.to_bits())
            };
            // Others may hold some of them just so.
            let nodes = if hold.nodes.iter().all(same) { hold.nodes.to_vec() } else { left };
            for (body, of_body) in self.by_body(&nodes) {
                for (frame, own) in self.model.frames.parts(&of_body) {
                    let set = self.set(body, &own, false, &hold.hint)?;
                    lists.add_support(&set, frame.map(|frame| &self.model.frames.frames[frame]), hold.dof, by);
                }
            }
        }
        Ok(())
    }

    /// Nodes of bodies, sorted.
    fn by_body(&self, nodes: &[u32]) -> BTreeMap<usize, Vec<u32>> {
        let mut found: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for &node in nodes {
            if let Owner::Body(body) = self.model.bodies.owners[node as usize] {
                found.entry(body).or_default().push(node);
            }
        }
        found.values_mut().for_each(|nodes| {
            nodes.sort_unstable();
            nodes.dedup();
        });
        found
    }

    /// `BODY.GROUP` of nodes.
    fn set(&mut self, body: usize, nodes: &[u32], bare: bool, hint: &str) -> Result<String> {
        let bodies = self.model.bodies;
        let group = self.groups.nodes(nodes, bodies.is_inside(body), bare, hint)?;
        Ok(format!("{}.{group}", bodies.bodies[body].name))
    }

    /// Rigid bodies: tools, and nodes of bodies that move as one.
    fn tools(&mut self, from: f64, to: f64, lists: &mut Lists) -> Result<()> {
        let (model, conditions, clock) = (self.model, self.conditions, self.clock);
        for (number, rigid) in model.bodies.rigids.iter().enumerate() {
            let tools: Vec<&Tool> = model.tools.iter().filter(|tool| tool.rigid == number).collect();
            if tools.is_empty() && rigid.nodes.is_empty() {
                continue;
            }
            let hold = |dof: usize| conditions.supports.of(rigid.reference, dof);
            let by = |dof: usize| hold(dof).map(|hold| hold.by(from, to, &clock, model.amplitudes));
            // Those that are free are none of 0.
            let turns: Vec<usize> = (3..6).filter(|&dof| by(dof) != Some(0.0)).collect();
            let axis = self.axis(number, &turns, from)?;
            let way = [0, 1, 2].map(|dof| by(dof).unwrap_or(0.0));
            let angle = axis.map(|axis| by(axis.along + 3));
            let rotation = axis.zip(angle.flatten()).map(|(axis, by)| scene::Rotation { axis, angle: by.to_degrees() });
            if !rigid.nodes.is_empty() {
                // How they move along is said by `Conditions`.
                let is_free = (0..3).any(|dof| hold(dof).is_none()) || axis.is_some() != rotation.is_some();
                if is_free || !rotation.map_or(Ok(true), |rotation| self.turn_nodes(number, rotation, lists))? {
                    let what = "nodes of a body that move freely as one, or are held besides, cannot be converted,";
                    return self.refuse(
                        number,
                        what,
                        "prescribe 1 to 6 of the reference node, and nothing of the nodes",
                    );
                }
                continue;
            }
            let free = [0, 1, 2].map(|dof| hold(dof).is_none());
            let is_free = (0..DOFS).any(|dof| hold(dof).is_none());
            if is_free && tools.len() > 1 {
                let what = "a rigid body that meets several surfaces moves freely";
                return self.refuse(number, what, "join the surfaces");
            }
            if free.contains(&true) && conditions.heavy.contains(&number) {
                let what =
                    "gravity or a spin acts on the mass of a rigid body that moves freely, which cannot be converted,";
                return self.refuse(
                    number,
                    what,
                    "let it act on the other elements, and give the weight as a force on the reference node",
                );
            }
            for tool in tools {
                lists.move_tool(&tool.name, way, rotation);
                if free.contains(&true) {
                    let force = self.on_node(&conditions.forces, rigid.reference, to);
                    lists.push_tool(&tool.name, [0, 1, 2].map(|d| if free[d] { force[d] } else { 0.0 }), free);
                }
                if let (Some(axis), Some(None)) = (axis, angle) {
                    let moment = self.on_node(&conditions.moments, rigid.reference, to);
                    lists.turn_tool(&tool.name, moment[axis.along], axis);
                }
            }
        }
        Ok(())
    }

    fn refuse<T>(&self, rigid: usize, what: &str, help: &str) -> Result<T> {
        let at = &self.model.bodies.rigids[rigid].at;
        Err(Error::input(at, format!("{what} in the step of line {}", self.step.card.at.line), help))
    }

    /// The axis about which a rigid body turns, or is free to, by the degrees of freedom along which it does.
    fn axis(&mut self, number: usize, turns: &[usize], from: f64) -> Result<Option<scene::Axis>> {
        let rigid = &self.model.bodies.rigids[number];
        match *turns {
            [] => Ok(None),
            [dof] if *self.axes.entry(number).or_insert(dof) == dof => {
                let place = |axis: usize| {
                    let at = self.groups.whole.mesh.points[rigid.reference as usize][axis];
                    let hold = self.conditions.supports.of(rigid.reference, axis);
                    let moved = hold.map(|hold| hold.place(from, &self.clock, self.model.amplitudes));
                    at + moved.filter(|moved| !moved.is_nan()).unwrap_or(0.0)
                };
                Ok(Some(scene::Axis { point: [0, 1, 2].map(place), along: dof - 3 }))
            }
            _ => {
                let names: Vec<_> = turns.iter().map(|dof| AXIS_NAMES[dof - 3].to_string()).collect();
                let what = format!("the rigid body turns, or is free to, about {}", names.join(" and "));
                let help = "nagata turns about one axis: hold the others of 4 to 6 of the reference node";
                self.refuse(number, &what, help)
            }
        }
    }

    /// Turns the nodes of bodies that move as one; says whether nothing else holds them.
    fn turn_nodes(&mut self, rigid: usize, rotation: scene::Rotation, lists: &mut Lists) -> Result<bool> {
        let rigid = &self.model.bodies.rigids[rigid];
        for (body, own) in self.by_body(&rigid.nodes) {
            let set = self.set(body, &own, false, &rigid.name)?;
            if !lists.turn_set(&set, rotation) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn on_node(&self, loads: &Loads, node: u32, s: f64) -> [f64; 3] {
        let fields = loads.at(s, &self.clock, self.model.amplitudes);
        let parts = fields.filter_map(|(_, field)| field.get(&node).copied());
        parts.fold([0.0; 3], |sum, part| [0, 1, 2].map(|d| sum[d] + part[d]))
    }

    fn forces(&mut self, s: f64, lists: &mut Lists) -> Result<()> {
        let conditions = self.conditions;
        for (load, field) in conditions.forces.at(s, &self.clock, self.model.amplitudes) {
            let nodes: Vec<u32> = field.keys().copied().collect();
            for (body, own) in self.by_body(&nodes) {
                let forces: Vec<[f64; 3]> = own.iter().map(|node| field[node]).collect();
                for (set, total) in super::spread::sets(self.groups, self.model.bodies, body, &own, &forces, load)? {
                    scene::add(&mut lists.forces, &set, total);
                }
            }
        }
        Ok(())
    }

    fn pressures(&mut self, s: f64, lists: &mut Lists) -> Result<()> {
        let (conditions, bodies) = (self.conditions, self.model.bodies);
        for (load, field) in conditions.pressures.at(s, &self.clock, self.model.amplitudes) {
            let mut alike: BTreeMap<(usize, u64), Vec<u32>> = BTreeMap::new();
            for (face, value) in field {
                if let Owner::Body(body) = bodies.owners[self.groups.facet(face).nodes[0] as usize] {
                    alike.entry((body, value[0].to_bits())).or_default().push(face);
                }
            }
            for ((body, value), faces) in alike {
                let group = self.groups.faces(&faces, bodies.is_inside(body), &load.hint)?;
                let set = format!("{}.{group}", bodies.bodies[body].name);
                scene::add(&mut lists.pressures, &set, [f64::from_bits(value), 0.0, 0.0]);
            }
        }
        Ok(())
    }
}
