//! A deck as a whole: its mesh, all of its sets, those that Abaqus/CAE calls internal too, and the cards that say what is
//! done with them.

use super::super::halves::Made;
use super::super::raw::{FileMesh, Ids, Slot};
use super::super::{Mesh, Sides, message};
use super::groups::{Placed, Surfaces};
use super::lines::number;
use super::{Deck, Keyword, Kind, Level, Lines, fields};
use crate::encoding;
use crate::error::{Error, Location, Result};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// A keyword of a deck, and the data lines below it unless they are of the mesh.
#[derive(Clone, Debug)]
pub(crate) struct Card {
    pub keyword: Keyword,
    pub at: Location,
    pub rows: Vec<Row>,
    /// The part or instance that it stands in.
    pub place: Option<String>,
}

/// A data line.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub at: Location,
    pub text: String,
}

impl Card {
    pub fn error(&self, what: impl Into<String>, help: &str) -> Error {
        Error::input(&self.at, what, help)
    }

    /// The fields of all data lines.
    pub fn fields(&self) -> impl Iterator<Item = (&Row, &str)> {
        self.rows.iter().flat_map(|row| fields(&row.text).map(move |field| (row, field)))
    }
}

impl Row {
    /// The fields; one that is not there is empty.
    pub fn fields<const N: usize>(&self) -> [&str; N] {
        let mut fields = fields(&self.text);
        std::array::from_fn(|_| fields.next().unwrap_or_default())
    }

    pub fn error(&self, what: impl Into<String>, help: &str) -> Error {
        Error::input(&self.at, what, help)
    }

    /// A number; an empty field is `default`.
    pub fn number(&self, field: &str, default: f64) -> Result<f64> {
        if field.is_empty() {
            return Ok(default);
        }
        let found = number(field).filter(|value| value.is_finite());
        found.ok_or_else(|| self.error(format!("expected a number, found '{field}'"), ""))
    }
}

impl Deck {
    pub(super) fn keep_card(&mut self, keyword: Keyword, at: Location) {
        let place = match self.level {
            Level::Root => None,
            Level::Part => self.parts.last().map(|part| part.name.clone()),
            Level::Instance => self.scopes.last().map(|instance| instance.name.clone()),
        };
        if let Some(cards) = &mut self.cards {
            cards.push(Card { keyword, at, rows: Vec::new(), place });
        }
    }

    pub(super) fn keep_row(&mut self, lines: &Lines) {
        if let Some(card) = self.cards.as_mut().and_then(|cards| cards.last_mut()) {
            card.rows.push(Row { at: lines.at(), text: lines.text.clone() });
        }
    }
}

/// All of a deck. Names of sets and surfaces are found in any case.
pub(crate) struct Whole {
    /// The nodes of a group are all that it has. Internal sets are none.
    pub mesh: Mesh,
    pub cards: Vec<Card>,
    /// Where each element went, in the order of the deck.
    pub slots: Vec<Slot>,
    /// For each solid its element.
    pub element_of: Vec<u32>,
    /// Nodes in the middles of faces and elements of second order, which the deck lacks.
    pub made: Vec<Made>,
    pub sides: Sides,
    /// Elements of a type that is not read: the first.
    pub unread: Option<Error>,
    /// For each element its type, as in `C3D8`: the first of some that have it.
    kinds: Vec<(usize, String)>,
    scopes: Vec<Scope>,
    /// Of nodes and of elements.
    sets: [BTreeMap<String, Vec<u32>>; 2],
    /// Facets.
    surfaces: BTreeMap<String, Vec<u32>>,
}

/// What counts nodes and elements on its own.
struct Scope {
    name: String,
    part: String,
    nodes: Ids,
    elements: Ids,
    first_node: usize,
    first_element: usize,
}

/// Reads a deck and all that it includes.
pub(crate) fn read_whole(path: &Path) -> Result<Whole> {
    let source = path.display().to_string();
    let data = std::fs::read(path)
        .map_err(|error| Error::input_anywhere(format!("cannot read the deck {source}: {error}"), ""))?;
    let data = encoding::unmarked(path, data)
        .map_err(|(what, help)| Error::input_anywhere(format!("the deck {source} {what}"), help))?;
    let mut deck = Deck::read(path, &source, data, Some(Vec::new()))?;
    let cards = deck.cards.take().unwrap_or_default();
    let mut file = FileMesh::new(&source);
    file.mesh.is_section = deck.draw_out(&source)?;
    let placed = Placed::new(&mut deck, &mut file)?;
    let surfaces = placed.finish(&mut file)?;
    Whole::new(placed, file, surfaces, cards)
}

impl Whole {
    fn new(placed: Placed, mut file: FileMesh, mut made: Surfaces, cards: Vec<Card>) -> Result<Self> {
        let mut sets = [Kind::Node, Kind::Element].map(|kind| (kind, Names::default()));
        let mut surfaces = Names::default();
        let source = file.mesh.source.clone();
        for (number, scope) in placed.deck.scopes.iter().enumerate() {
            for (kind, names) in &mut sets {
                for (key, set) in scope.sets(*kind) {
                    names.add(number, &scope.name, key, placed.resolve(*kind, number, &set.members, key, &source)?);
                }
            }
            for surface in scope.surfaces.iter().filter(|surface| !surface.nodes) {
                let mut facets = Vec::new();
                placed.faces(number, surface, &mut file, &mut made, &mut facets)?;
                facets.sort_unstable();
                facets.dedup();
                surfaces.add(number, &scope.name, &surface.name.to_uppercase(), facets);
            }
        }
        complete(&mut file);
        let mut element_of = vec![0; file.mesh.solids.len()];
        for (slot, element) in placed.slots.iter().zip(0..) {
            slot.solids().for_each(|solid| element_of[solid as usize] = element);
        }
        let (mut kinds, mut scopes) = (Vec::new(), Vec::new());
        let tables = placed.nodes.into_iter().zip(placed.cells);
        let firsts = placed.first_nodes.into_iter().zip(&placed.starts);
        for ((scope, (nodes, elements)), (first_node, &start)) in placed.deck.scopes.iter().zip(tables).zip(firsts) {
            kinds.extend(scope.kinds.iter().map(|(first, kind)| (start + first, kind.clone())));
            let (name, part) = (scope.name.to_uppercase(), scope.part.to_uppercase());
            scopes.push(Scope { name, part, nodes, elements, first_node, first_element: start });
        }
        let [nodes, elements] = sets.map(|(_, names)| names.finish());
        Ok(Self {
            mesh: file.mesh,
            cards,
            slots: placed.slots,
            element_of,
            made: placed.made,
            sides: file.sides,
            unread: file.unread,
            kinds,
            scopes,
            sets: [nodes, elements],
            surfaces: surfaces.finish(),
        })
    }

    /// The nodes that a field names: a set, or a number; either may have an instance in front. In a part those of all its
    /// instances.
    pub fn nodes(&self, place: Option<&str>, field: &str) -> Option<Vec<u32>> {
        self.find(Kind::Node, place, field)
    }

    /// The same for elements.
    pub fn elements(&self, place: Option<&str>, field: &str) -> Option<Vec<u32>> {
        self.find(Kind::Element, place, field)
    }

    /// The facets of a surface of elements.
    pub fn surface(&self, field: &str) -> Option<&[u32]> {
        self.surfaces.get(&plain(field)).map(Vec::as_slice)
    }

    /// The nodes of a surface of nodes, or of a set of them.
    pub fn surface_of_nodes(&self, name: &str) -> Option<&[u32]> {
        if self.surface(name).is_some() || self.elements(None, name).is_some() {
            return None;
        }
        let mut named = self.mesh.groups.iter();
        named.find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, group)| &group.nodes[..])
    }

    /// The names of all sets and surfaces.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let sets = self.sets.iter().flat_map(BTreeMap::keys).chain(self.surfaces.keys());
        sets.chain(self.mesh.groups.keys()).map(String::as_str)
    }

    /// The type of an element.
    pub fn kind(&self, element: u32) -> &str {
        let after = self.kinds.partition_point(|(first, _)| *first <= element as usize);
        after.checked_sub(1).map_or("", |at| &self.kinds[at].1)
    }

    /// How the deck calls a node; `None` when no card can name it.
    pub fn node_name(&self, node: u32) -> Option<String> {
        self.named(self.mesh.point_ids[node as usize], |scope| scope.first_node <= node as usize)
    }

    /// How the deck calls a solid.
    pub fn solid_name(&self, solid: u32) -> Option<String> {
        let element = self.element_of[solid as usize] as usize;
        self.named(self.mesh.solids[solid as usize].id, |scope| scope.first_element <= element)
    }

    fn named(&self, id: u64, begins: impl Fn(&Scope) -> bool) -> Option<String> {
        let scope = self.scopes.partition_point(begins) - 1;
        match scope {
            0 => Some(id.to_string()),
            _ if self.cards.iter().any(|card| card.keyword.name == "INSTANCE") => {
                Some(format!("{}.{id}", self.scopes[scope].name))
            }
            _ => None,
        }
    }

    fn find(&self, kind: Kind, place: Option<&str>, field: &str) -> Option<Vec<u32>> {
        let name = plain(field);
        let Some(place) = place.map(str::to_uppercase) else {
            let set = || self.sets[kind as usize].get(&name).cloned();
            // What is a number is that of a node or element, whatever sets are called.
            return match name.parse::<u64>() {
                Ok(_) => self.one(kind, &name).or_else(set),
                Err(_) => set().or_else(|| self.one(kind, &name)),
            };
        };
        let inside = self.scopes.iter().filter(|scope| scope.part == place || scope.name == place);
        let found = inside.map(|scope| self.find(kind, None, &format!("{}.{name}", scope.name)));
        found.collect::<Option<Vec<_>>>().map(|members| members.concat())
    }

    fn one(&self, kind: Kind, name: &str) -> Option<Vec<u32>> {
        let of = |scope: &Scope, id: u64| match kind {
            Kind::Node => scope.nodes.get(id),
            Kind::Element => scope.elements.get(id),
        };
        if let Ok(id) = name.parse() {
            let found: Vec<u32> = self.scopes.iter().filter_map(|scope| of(scope, id)).collect();
            let outside = self.scopes.first().and_then(|scope| of(scope, id));
            return outside.or(found.first().copied().filter(|_| found.len() == 1)).map(|index| vec![index]);
        }
        let (instance, id) = name.rsplit_once('.')?;
        let scope = self.scopes.iter().find(|scope| scope.name == instance)?;
        of(scope, id.parse().ok()?).map(|index| vec![index])
    }
}

/// A name as it is looked for; of `"AN INSTANCE".A SET` either part may be in quotation marks.
fn plain(field: &str) -> String {
    field.trim().replace('"', "").to_uppercase()
}

/// Members by name in capitals: `INSTANCE.SET`, and `SET` alone where it is outside of instances or only in one.
#[derive(Default)]
struct Names {
    full: BTreeMap<String, Vec<u32>>,
    /// How often a name occurs, and where alone it stands.
    short: HashMap<String, (usize, String)>,
}

impl Names {
    fn add(&mut self, scope: usize, instance: &str, key: &str, members: Vec<u32>) {
        let name = match scope {
            0 => key.to_string(),
            _ => format!("{}.{key}", instance.to_uppercase()),
        };
        if scope > 0 {
            self.short.entry(key.to_string()).or_insert((0, name.clone())).0 += 1;
        }
        self.full.entry(name).or_default().extend(members);
    }

    fn finish(mut self) -> BTreeMap<String, Vec<u32>> {
        for (key, (uses, name)) in self.short {
            if uses == 1 && !self.full.contains_key(&key) {
                let members = self.full[&name].clone();
                self.full.insert(key, members);
            }
        }
        self.full
    }
}

/// Gives the mesh its groups, with all their nodes.
fn complete(file: &mut FileMesh) {
    for (name, found) in std::mem::take(&mut file.groups) {
        let mut group = found.group;
        if !found.closed {
            group.nodes.extend(group.solids.iter().flat_map(|&solid| file.mesh.solids[solid as usize].nodes()));
            group.nodes.extend(group.facets.iter().flat_map(|&facet| file.nodes_of(facet)));
            group.nodes.extend(group.lines.iter().filter_map(|&[a, b]| file.mesh.middles.at(a, b)));
        }
        for indices in [&mut group.nodes, &mut group.facets, &mut group.solids] {
            indices.sort_unstable();
            indices.dedup();
        }
        file.mesh.groups.insert(name, group);
    }
}

/// An error about a set that is not there.
pub(crate) fn no_set(at: &Location, what: &str, name: &str) -> Error {
    Error::input(at, format!("there is no {what} '{}'", message::shorten(name.as_bytes(), 60)), "")
}
