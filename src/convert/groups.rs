//! Groups for nodes, faces and elements of bodies: those of the deck where it has them, else new ones.

use super::names::Namer;
use crate::error::{Error, Result};
use crate::mesh::abaqus::{LOWEST, Whole};
use crate::mesh::faces::{self, FaceKey};
use crate::mesh::{Facet, Group, Middles, message};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fmt::Write;

/// A face on the boundary of the solids, by its number in [`Groups::boundary`].
pub(super) type Face = u32;

pub(super) struct Groups<'a> {
    pub whole: &'a Whole,
    /// Solid and local face.
    pub boundary: Vec<(u32, u8)>,
    faces: HashMap<FaceKey, Face>,
    namer: Namer,
    /// New groups as cards of a deck.
    pub more: String,
    made: HashMap<(Members, Vec<u32>), String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Members {
    Nodes,
    Faces,
    Solids,
}

impl<'a> Groups<'a> {
    pub fn new(whole: &'a Whole) -> Self {
        let boundary = faces::boundary(&whole.mesh.solids);
        let key = |&(solid, face): &(u32, u8)| whole.mesh.solids[solid as usize].face(face as usize).key();
        let faces = boundary.iter().map(key).zip(0..).collect();
        let mut namer = Namer::default();
        whole.names().for_each(|name| namer.take(name));
        Self { whole, boundary, faces, namer, more: String::new(), made: HashMap::new() }
    }

    /// A face by its corners.
    pub fn facet(&self, face: Face) -> Facet {
        let (solid, local) = self.boundary[face as usize];
        self.whole.mesh.solids[solid as usize].face(local as usize)
    }

    /// The nodes in the middles of its edges, where it is quadratic.
    pub fn middles(&self, face: Face) -> Option<[u32; 3]> {
        let (solid, local) = self.boundary[face as usize];
        let solid = &self.whole.mesh.solids[solid as usize];
        let facet = solid.face(local as usize);
        Middles::in_solids([solid].into_iter(), [facet.nodes()].into_iter(), [].into_iter()).of(facet.nodes())
    }

    /// All nodes of a face.
    pub fn face_nodes(&self, face: Face) -> Vec<u32> {
        let middles = self.middles(face);
        self.facet(face).nodes().iter().copied().chain(middles.into_iter().flatten()).collect()
    }

    /// The boundary face that a facet of the mesh is.
    pub fn face_of(&self, facet: u32) -> Option<Face> {
        self.face_of_key(&self.whole.mesh.facets[facet as usize].key())
    }

    pub fn face_of_key(&self, key: &FaceKey) -> Option<Face> {
        self.faces.get(key).copied()
    }

    /// The group with these nodes of a body, all of whose nodes are those that `is_inside` holds for; without faces of it
    /// if it is to be `bare`. `hint` is a name that may fit.
    pub fn nodes(&mut self, wanted: &[u32], is_inside: impl Fn(u32) -> bool, bare: bool, hint: &str) -> Result<String> {
        let fits = |groups: &Self, group: &Group| {
            group.nodes.iter().filter(|&&node| is_inside(node)).eq(wanted)
                && !(bare && group.facets.iter().any(|&facet| groups.is_boundary(facet)))
        };
        if let Some(name) = self.existing(hint, fits) {
            return Ok(name);
        }
        let names: Option<Vec<String>> = wanted.iter().map(|&node| self.whole.node_name(node)).collect();
        self.make(Members::Nodes, wanted, hint, |name, text| {
            let _ = writeln!(text, "*NSET, NSET={name}");
            names.ok_or_else(nameless)?.chunks(8).for_each(|line| {
                let _ = writeln!(text, "{}", line.join(", "));
            });
            Ok(())
        })
    }

    /// The group with these faces, and no others, of a body.
    pub fn faces(&mut self, wanted: &[Face], is_inside: impl Fn(u32) -> bool, hint: &str) -> Result<String> {
        let nodes: BTreeSet<u32> = wanted.iter().flat_map(|&face| self.face_nodes(face)).collect();
        let fits = |groups: &Self, group: &Group| {
            let own = group.facets.iter().filter_map(|&facet| groups.face_of(facet));
            let mut own: Vec<Face> = own.filter(|&face| is_inside(groups.facet(face).nodes[0])).collect();
            own.sort_unstable();
            own.dedup();
            own == wanted && group.nodes.iter().filter(|&&node| is_inside(node)).eq(&nodes)
        };
        if let Some(name) = self.existing(hint, fits) {
            return Ok(name);
        }
        // Parts of one side are that side.
        let mut seen = HashSet::new();
        let is_new = |side: &(u32, u8)| seen.insert((self.whole.element_of[side.0 as usize], side.1));
        let sides = wanted.iter().map(|&face| self.boundary[face as usize]).filter(is_new).map(|(solid, local)| {
            let lowest = if self.whole.mesh.is_section { LOWEST } else { 0 };
            let side = self.whole.sides.side(solid, local);
            self.whole.solid_name(solid).map(|name| format!("{name}, S{}", side + 1 - lowest))
        });
        let sides: Option<Vec<String>> = sides.collect();
        self.make(Members::Faces, wanted, hint, |name, text| {
            let _ = writeln!(text, "*SURFACE, NAME={name}, TYPE=ELEMENT\n{}", sides.ok_or_else(nameless)?.join("\n"));
            Ok(())
        })
    }

    /// The group with these solids, of all or, where it may hold others, of those that `counts` holds for.
    pub fn solids(&mut self, wanted: &[u32], counts: impl Fn(u32) -> bool, hint: &str) -> Result<String> {
        let fits = |_: &Self, group: &Group| group.solids.iter().filter(|&&solid| counts(solid)).eq(wanted);
        if let Some(name) = self.existing(hint, fits) {
            return Ok(name);
        }
        let elements = wanted.chunk_by(|a, b| self.whole.element_of[*a as usize] == self.whole.element_of[*b as usize]);
        let names: Option<Vec<String>> = elements.map(|parts| self.whole.solid_name(parts[0])).collect();
        self.make(Members::Solids, wanted, hint, |name, text| {
            let _ = writeln!(text, "*ELSET, ELSET={name}");
            names.ok_or_else(nameless)?.chunks(8).for_each(|line| {
                let _ = writeln!(text, "{}", line.join(", "));
            });
            Ok(())
        })
    }

    /// The group of the deck with these facets of a rigid surface.
    pub fn rigid(&self, facets: &[u32], hint: &str) -> Option<String> {
        self.existing(hint, |_, group| group.facets == facets)
    }

    /// A group of the deck, `hint` if it fits.
    fn existing(&self, hint: &str, fits: impl Fn(&Self, &Group) -> bool) -> Option<String> {
        let groups = &self.whole.mesh.groups;
        let named = groups.iter().filter(|(name, _)| name.eq_ignore_ascii_case(hint.trim_matches('"')));
        let fitting = named.chain(groups.iter()).find(|(_, group)| fits(self, group));
        fitting.map(|(name, _)| name.clone())
    }

    fn is_boundary(&self, facet: u32) -> bool {
        self.face_of(facet).is_some()
    }

    fn make(
        &mut self,
        kind: Members,
        members: &[u32],
        hint: &str,
        write: impl FnOnce(&str, &mut String) -> Result<()>,
    ) -> Result<String> {
        let key = (kind, members.to_vec());
        if let Some(name) = self.made.get(&key) {
            return Ok(name.clone());
        }
        let name = self.namer.name(hint, "group");
        write(&name, &mut self.more)?;
        self.made.insert(key, name.clone());
        Ok(name)
    }
}

fn nameless() -> Error {
    Error::input_anywhere("conditions on parts without an assembly cannot be converted", "write the deck flat")
}

/// "node 3 is" of nodes by their index.
pub(super) fn nodes_are(whole: &Whole, nodes: &[u32]) -> String {
    let ids: Vec<u64> = nodes.iter().map(|&node| whole.mesh.point_ids[node as usize]).collect();
    message::several("node", &ids)
}
