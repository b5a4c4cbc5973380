//! Turns the sets and surfaces of a deck into groups.

use super::super::halves::{Made, is_made};
use super::super::raw::{FileGroup, FileMesh, Ids, Slot};
use super::super::{Group, Middles, faces, message};
use super::{Deck, Kind, LOWEST, Member, Side, Surface, Unread};
use crate::error::{Error, Location, Result};
use crate::scene::did_you_mean;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Appends all scopes to one mesh and makes the groups.
pub(super) fn finish(mut deck: Deck, source: &str, is_section: bool) -> Result<FileMesh> {
    let mut file = FileMesh::new(source);
    file.mesh.is_section = is_section;
    let placed = Placed::new(&mut deck, &mut file)?;
    placed.finish(&mut file)?;
    Ok(file)
}

/// The groups of one scope by name in capitals, each with its name as written.
type Named = BTreeMap<String, (String, FileGroup)>;

/// A deck with the places of its nodes and elements.
pub(super) struct Placed<'a> {
    pub deck: &'a Deck,
    /// By scope: to points.
    pub nodes: Vec<Ids>,
    /// By scope: its first point.
    pub first_nodes: Vec<usize>,
    /// Nodes that the deck lacks.
    pub made: Vec<Made>,
    /// By scope: to slots.
    pub cells: Vec<Ids>,
    /// By scope: its first slot; and the end.
    pub starts: Vec<usize>,
    pub slots: Vec<Slot>,
}

impl<'a> Placed<'a> {
    /// Appends all scopes to the mesh of a file.
    pub fn new(deck: &'a mut Deck, file: &mut FileMesh) -> Result<Self> {
        deck.here();
        if deck.scopes.len() == 1 {
            // Parts without an assembly stand where they are.
            let parts = std::mem::take(&mut deck.parts);
            deck.scopes.extend(parts);
        }
        let mut placed = Self {
            deck,
            nodes: Vec::new(),
            first_nodes: Vec::new(),
            made: Vec::new(),
            cells: Vec::new(),
            starts: vec![0],
            slots: Vec::new(),
        };
        for scope in &placed.deck.scopes {
            placed.first_nodes.push(file.mesh.points.len());
            let (nodes, slots) = file.append(scope.point_ids.clone(), scope.points.clone(), &scope.cells)?;
            let ids: Vec<u64> = scope.cells.iter().map(|cell| cell.id).collect();
            let cells = Ids::new(&ids, placed.slots.len() as u32).map_err(|twice| {
                let what = format!("{} defined twice", message::several("element", &twice));
                message::whole_file(&file.mesh.source, what, "give each element a number of its own")
            })?;
            placed.nodes.push(nodes);
            placed.cells.push(cells);
            placed.slots.extend(slots);
            placed.starts.push(placed.slots.len());
        }
        placed.made = std::mem::take(&mut file.made);
        Ok(placed)
    }

    /// Makes the groups; returns the facets that surfaces made.
    pub fn finish(&self, file: &mut FileMesh) -> Result<Surfaces> {
        let mut surfaces = Surfaces::default();
        let scopes = 0..self.deck.scopes.len();
        let named: Vec<_> = scopes.map(|scope| self.groups(scope, file, &mut surfaces)).collect::<Result<_>>()?;
        file.groups = self.publish(named);
        let unread = || self.deck.scopes.iter().flat_map(|scope| &scope.unread);
        let first = unread().next();
        file.unread = first.map(|(id, unread)| unread.error(*id));
        if let Some((id, Unread { kind, .. })) = first {
            let more = message::and_more(unread().count() - 1);
            let source = &file.mesh.source;
            let what = format!("'{source}': element {id} of type {kind}{more} left out, which is not read");
            file.mesh.warnings.push(what);
        }
        Ok(surfaces)
    }

    /// The groups of a scope; facets of surfaces join the mesh.
    fn groups(&self, scope: usize, file: &mut FileMesh, surfaces: &mut Surfaces) -> Result<Named> {
        let mut nodes_of: BTreeMap<String, Vec<u32>> = BTreeMap::new();
        let mut named = Named::new();
        for (key, set) in self.deck.scopes[scope].sets(Kind::Node) {
            let nodes = self.resolve(Kind::Node, scope, &set.members, &set.name, &file.mesh.source)?;
            if let [reference] = nodes[..] {
                file.attached[reference as usize] = true;
            }
            if !set.internal {
                named.entry(key.clone()).or_insert_with(|| (set.name.clone(), FileGroup::default()));
                nodes_of.insert(key.clone(), nodes);
            }
        }
        for (key, set) in self.deck.scopes[scope].sets(Kind::Element).iter().filter(|(_, set)| !set.internal) {
            let cells = self.resolve(Kind::Element, scope, &set.members, &set.name, &file.mesh.source)?;
            let (_, group) = named.entry(key.clone()).or_insert_with(|| (set.name.clone(), FileGroup::default()));
            group.unread = self.unread(scope, &set.members);
            group.group = self.group_of(cells.iter().map(|&cell| cell as usize));
        }
        for surface in &self.deck.scopes[scope].surfaces {
            let key = surface.name.to_uppercase();
            let (_, group) = named.entry(key.clone()).or_insert_with(|| (surface.name.clone(), FileGroup::default()));
            if surface.nodes {
                for (member, ..) in &surface.members {
                    let members = std::slice::from_ref(member);
                    let found = self.resolve(Kind::Node, scope, members, &surface.name, &file.mesh.source)?;
                    nodes_of.entry(key.clone()).or_default().extend(found);
                }
            } else {
                self.faces(scope, surface, file, surfaces, &mut group.group.facets)?;
            }
            if !surface.nodes && !group.group.solids.is_empty() && !nodes_of.contains_key(&key) {
                nodes_of.insert(key, group.group.facets.iter().flat_map(|&facet| file.nodes_of(facet)).collect());
            }
        }
        for (key, nodes) in nodes_of {
            if let Some((_, group)) = named.get_mut(&key) {
                group.group.nodes = nodes;
                group.closed = true;
            }
        }
        Ok(named)
    }

    /// The facets of a surface of elements.
    pub fn faces(
        &self,
        scope: usize,
        surface: &Surface,
        file: &mut FileMesh,
        surfaces: &mut Surfaces,
        to: &mut Vec<u32>,
    ) -> Result<()> {
        for (member, side, at) in &surface.members {
            let members = std::slice::from_ref(member);
            for cell in self.resolve(Kind::Element, scope, members, &surface.name, &file.mesh.source)? {
                surfaces.add(file, self.slots[cell as usize], *side, at, to)?;
            }
        }
        Ok(())
    }

    fn group_of(&self, cells: impl Iterator<Item = usize>) -> Group {
        let mut group = Group::default();
        cells.for_each(|cell| group.add(self.slots[cell]));
        group
    }

    /// What is wrong with a set of elements: one of a type that is not read.
    fn unread(&self, scope: usize, members: &[Member]) -> Option<Error> {
        let mut stack: Vec<(usize, &Member)> = members.iter().map(|member| (scope, member)).collect();
        let mut seen = HashSet::new();
        while let Some((own, member)) = stack.pop() {
            let of = |scope: usize| if scope == 0 { own } else { scope };
            let (scope, range) = match member {
                Member::One { scope, id } => (of(*scope), (*id, *id, 1)),
                Member::Range { scope, first, last, step } => (of(*scope), (*first, *last, *step)),
                Member::Set { scope, name, .. } | Member::Corners { scope, name, .. } => {
                    let key = (of(*scope), name.to_uppercase());
                    let set = self.deck.scopes[key.0].sets(Kind::Element).get(&key.1);
                    if let Some(set) = set.filter(|_| seen.insert(key.clone())) {
                        stack.extend(set.members.iter().map(|member| (key.0, member)));
                    }
                    continue;
                }
            };
            let (first, last, step) = range;
            if first > last {
                continue;
            }
            let within = self.deck.scopes[scope].unread.range(first..=last);
            if let Some((id, unread)) = within.into_iter().find(|(id, _)| (*id - first).is_multiple_of(step)) {
                return Some(unread.error(*id));
            }
        }
        None
    }

    /// The nodes (points) or elements (slots) that the members of a set named `name` stand for, sorted, each once.
    pub fn resolve(&self, kind: Kind, scope: usize, members: &[Member], name: &str, source: &str) -> Result<Vec<u32>> {
        let (ids, what) = match kind {
            Kind::Node => (&self.nodes, "node"),
            Kind::Element => (&self.cells, "element"),
        };
        let mut stack: Vec<(usize, &Member)> = members.iter().map(|member| (scope, member)).collect();
        let mut seen = HashSet::new();
        let (mut found, mut missing) = (Vec::new(), Vec::new());
        while let Some((own, member)) = stack.pop() {
            let of = |scope: usize| if scope == 0 { own } else { scope };
            match member {
                Member::One { scope, id } => match ids[of(*scope)].get(*id) {
                    Some(index) => found.push(index),
                    None if kind == Kind::Element && self.deck.scopes[of(*scope)].unread.contains_key(id) => {}
                    None => missing.push(*id),
                },
                // As in Abaqus, a range may have gaps. It means none of the nodes that are made.
                Member::Range { scope, first, last, step } => {
                    let before = found.len();
                    ids[of(*scope)].range(*first, *last, *step, &mut found);
                    if kind == Kind::Node && !self.made.is_empty() {
                        let own = found.split_off(before);
                        found.extend(own.into_iter().filter(|&node| !is_made(&self.made, node)));
                    }
                }
                Member::Set { scope, name, at } => {
                    let key = (of(*scope), name.to_uppercase());
                    let sets = self.deck.scopes[key.0].sets(kind);
                    let Some(set) = sets.get(&key.1) else {
                        let help = did_you_mean(name, sets.values().map(|set| set.name.as_str()));
                        return Err(Error::input(at, format!("there is no {what} set '{name}'"), help));
                    };
                    if seen.insert(key.clone()) {
                        stack.extend(set.members.iter().map(|member| (key.0, member)));
                    }
                }
                Member::Corners { scope, name, at } => {
                    let members = [Member::Set { scope: 0, name: name.clone(), at: at.clone() }];
                    if let Some(error) = self.unread(of(*scope), &members) {
                        return Err(error);
                    }
                    let elements = self.resolve(Kind::Element, of(*scope), &members, name, source)?;
                    found.extend(elements.iter().flat_map(|&element| self.corners(element)));
                }
            }
        }
        if let Some(id) = missing.last() {
            let more = message::and_more(missing.len() - 1);
            let text = format!("set '{name}' names {what} {id}, which does not exist{more}");
            return Err(message::whole_file(source, text, ""));
        }
        if kind == Kind::Node {
            self.complete(&mut found);
        }
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    /// The nodes of an element that the deck names.
    fn corners(&self, element: u32) -> impl Iterator<Item = u32> {
        let scope = self.starts.partition_point(|&start| start <= element as usize) - 1;
        let cell = &self.deck.scopes[scope].cells[element as usize - self.starts[scope]];
        let named = cell.nodes.iter().filter(|id| self.deck.drawn_from.is_none_or(|first| **id < first));
        named.filter_map(move |id| self.nodes[scope].get(*id))
    }

    /// Adds the nodes that are made in the middle of what the others are all around.
    fn complete(&self, nodes: &mut Vec<u32>) {
        if self.made.is_empty() || nodes.len() < 8 {
            return;
        }
        let known: HashSet<u32> = nodes.iter().copied().collect();
        let inside = self.made.iter().filter(|made| made.around.iter().all(|node| known.contains(node)));
        nodes.extend(inside.map(|made| made.node));
    }

    /// Names the groups of all scopes.
    fn publish(&self, named: Vec<Named>) -> BTreeMap<String, FileGroup> {
        let mut uses: HashMap<String, usize> = HashMap::new();
        named.iter().flat_map(Named::keys).for_each(|key| *uses.entry(key.clone()).or_default() += 1);
        let mut groups = BTreeMap::new();
        for (scope, named) in named.into_iter().enumerate() {
            for (key, (name, group)) in named {
                if scope > 0 {
                    groups.insert(format!("{}.{name}", self.deck.scopes[scope].name), group.clone());
                }
                if scope == 0 || uses[&key] == 1 {
                    groups.insert(name, group);
                }
            }
        }
        for (scope, range) in self.starts.windows(2).enumerate().skip(1) {
            let group = || FileGroup {
                group: self.group_of(range[0]..range[1]),
                closed: false,
                unread: self.deck.scopes[scope].unread.iter().next().map(|(id, unread)| unread.error(*id)),
            };
            groups.entry(self.deck.scopes[scope].name.clone()).or_insert_with(group);
        }
        groups
    }
}

/// The facets that surfaces made, each once.
#[derive(Default)]
pub(super) struct Surfaces {
    /// By solid and local face.
    of_solid: HashMap<(u32, u8), u32>,
    /// Shell facets turned over.
    turned: HashMap<u32, u32>,
    /// The boundary of all solids, once it is needed.
    free: Option<Vec<(u32, u8)>>,
}

impl Surfaces {
    /// Adds the facets of one side of an element.
    fn add(&mut self, file: &mut FileMesh, slot: Slot, side: Side, at: &Location, to: &mut Vec<u32>) -> Result<()> {
        let mesh = &mut file.mesh;
        match (slot, side) {
            (Slot::Solids { first, count }, Side::Face(face)) => {
                let Some(faces) = file.sides.faces(&mesh.solids, (first, count), face) else {
                    let (id, sides) = (mesh.solids[first as usize].id, file.sides.count(&mesh.solids, first));
                    return Err(Error::input(at, format!("element {id} has {sides} faces, no S{}", face + 1), ""));
                };
                to.extend(faces.into_iter().map(|(solid, face)| self.face(file, solid, face)));
            }
            (Slot::Solids { first, count }, Side::Free) => {
                let free = self.free.get_or_insert_with(|| faces::boundary(&mesh.solids));
                let from = free.partition_point(|face| face.0 < first);
                let own = free[from..].iter().take_while(|face| face.0 < first + count).copied();
                // The z-planes are none of its surface.
                let own: Vec<_> = own.filter(|face| !mesh.is_section || face.1 >= LOWEST).collect();
                to.extend(own.into_iter().map(|(solid, face)| self.face(file, solid, face)));
            }
            (Slot::Facets { .. }, Side::Free | Side::Positive | Side::Face(1)) => to.extend(slot.facets()),
            (Slot::Facets { .. }, Side::Negative | Side::Face(0)) => {
                to.extend(slot.facets().map(|facet| {
                    *self.turned.entry(facet).or_insert_with(|| {
                        mesh.facets.push(mesh.facets[facet as usize].reversed());
                        mesh.facets.len() as u32 - 1
                    })
                }));
            }
            (Slot::Solids { .. }, _) => {
                return Err(Error::input(at, "a solid has no positive or negative side", "use S1 to S6"));
            }
            (Slot::Facets { .. }, Side::Face(_)) => {
                let help = "of a shell use SPOS or SNEG; CPE and CPS are no bodies here, whose sides these would be: plane strain is one \
                            layer of C3D8 with `plane_strain = true`, and CAX4 and CAX8 are read";
                return Err(Error::input(at, "a surface element has no such face", help));
            }
            (Slot::Loose(_) | Slot::Halves(_), _) => {
                return Err(Error::input(at, "a point or a line has no faces", ""));
            }
        }
        Ok(())
    }

    fn face(&mut self, file: &mut FileMesh, solid: u32, face: u8) -> u32 {
        *self.of_solid.entry((solid, face)).or_insert_with(|| {
            let of = file.mesh.solids[solid as usize];
            let facet = of.face(face as usize);
            file.mesh.middles.join(Middles::in_solids([&of].into_iter(), [facet.nodes()].into_iter(), [].into_iter()));
            file.mesh.facets.push(facet);
            file.mesh.facets.len() as u32 - 1
        })
    }
}
