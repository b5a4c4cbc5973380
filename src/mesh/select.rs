//! Takes a body or a tool out of a file: its elements, their nodes, and the groups restricted to them.

use super::faces::{self, FaceKey, Owner};
use super::raw::{FileGroup, FileMesh};
use super::{Facet, Group, Mesh, Middles, Purpose, Solid, message};
use crate::error::{Error, Location, Result};
use std::collections::HashMap;

/// What a file is asked for.
pub(super) struct Wish<'a> {
    pub purpose: Purpose,
    /// A group of volume elements (body) or facets (tool); `None` takes all.
    pub group: Option<&'a str>,
    /// Where the user asked.
    pub at: &'a Location,
}

/// What was taken.
pub(super) struct Selected {
    pub mesh: Mesh,
    /// For each facet, whether it points out of a solid of the file; the others are as the file has them.
    pub outward: Vec<bool>,
}

/// Takes what is wished for. A body's facets are boundary faces of its solids; a tool has facets alone.
pub(super) fn select(mut file: FileMesh, wish: &Wish) -> Result<Selected> {
    let named = match wish.group {
        Some(name) => Some(file.groups.get(name).ok_or_else(|| unknown(&file, name, wish))?),
        None => None,
    };
    if let Some(error) = named.map_or(&file.unread, |group| &group.unread) {
        return Err(error.clone());
    }
    let mut taken = match wish.purpose {
        Purpose::Body => take_body(&mut file, wish)?,
        Purpose::Tool => take_tool(&file, named.map(|named| &named.group), wish)?,
    };
    let outward = std::mem::take(&mut taken.outward);
    Ok(Selected { mesh: taken.restrict(file), outward })
}

/// Whether a group could have been meant.
fn fits(group: &Group, purpose: Purpose) -> bool {
    match purpose {
        Purpose::Body => !group.solids.is_empty(),
        Purpose::Tool => !group.facets.is_empty(),
    }
}

fn unknown(file: &FileMesh, name: &str, wish: &Wish) -> Error {
    let what = format!("'{}' has no group '{name}'", file.mesh.source);
    let help = message::help_on_group(name, &file.groups, |found| fits(&found.group, wish.purpose));
    Error::input(wish.at, what, help)
}

fn empty(file: &FileMesh, wish: &Wish) -> Error {
    let what = match wish.purpose {
        Purpose::Body => "volume elements (tetrahedra or hexahedra), which a body is made of",
        Purpose::Tool => "surface elements (triangles or quadrilaterals), which a tool is made of",
    };
    match wish.group {
        Some(name) => {
            let help = message::help_on_group(name, &file.groups, |found| fits(&found.group, wish.purpose));
            Error::input(wish.at, format!("group '{name}' of '{}' has no {what}", file.mesh.source), help)
        }
        None => {
            let help = match wish.purpose {
                Purpose::Body => {
                    "in Gmsh give the volume a physical group, for nothing else is saved; plane strain and rings take one layer of \
                     hexahedra: extrude the faces by one"
                }
                Purpose::Tool => "in Gmsh give the surface a physical group, for nothing else is saved",
            };
            Error::input(wish.at, format!("'{}' has no {what}", file.mesh.source), help)
        }
    }
}

/// What is taken, in the nodes of the file.
struct Taken {
    solids: Vec<Solid>,
    facets: Vec<Facet>,
    /// For each of the facets, whether it points out of a solid.
    outward: Vec<bool>,
    /// New index of each solid and facet of the file.
    solid_map: Vec<Option<u32>>,
    facet_map: Vec<Option<u32>>,
    /// Facets inside the body: they count for the nodes of their groups only.
    inside: Vec<bool>,
    /// Of all facets and lines of the file that may have some.
    middles: Middles,
}

/// Takes the solids out of the file.
fn take_body(file: &mut FileMesh, wish: &Wish) -> Result<Taken> {
    let all = std::mem::take(&mut file.mesh.solids);
    let mut solid_map = vec![None; all.len()];
    let solids = match wish.group.and_then(|name| file.groups.get(name)) {
        None => {
            solid_map.iter_mut().zip(0..).for_each(|(new, index)| *new = Some(index));
            all
        }
        Some(chosen) => {
            let mut solids = Vec::new();
            for &index in &chosen.group.solids {
                solid_map[index as usize].get_or_insert_with(|| {
                    solids.push(all[index as usize]);
                    solids.len() as u32 - 1
                });
            }
            solids
        }
    };
    let mesh = &file.mesh;
    if solids.is_empty() {
        return Err(empty(file, wish));
    }
    let lines = file.groups.values().flat_map(|found| &found.group.lines).copied();
    let middles = Middles::in_solids(solids.iter(), mesh.facets.iter().map(Facet::nodes), lines);
    let mut taken = Taken {
        solids,
        facets: Vec::new(),
        outward: Vec::new(),
        solid_map,
        facet_map: Vec::new(),
        inside: Vec::new(),
        middles,
    };
    // A face that the file has several times, as facet and as skin, is one facet.
    let mut known: HashMap<(u32, u8), u32> = HashMap::new();
    for (facet, owner) in mesh.facets.iter().zip(faces::owners(&taken.solids, &mesh.facets)) {
        taken.inside.push(owner == Owner::Shared);
        taken.facet_map.push(match owner {
            Owner::One { solid, face } => Some(*known.entry((solid, face)).or_insert_with(|| {
                taken.facets.push(Facet { id: facet.id, ..taken.solids[solid as usize].face(face as usize) });
                taken.facets.len() as u32 - 1
            })),
            _ => None,
        });
    }
    taken.outward = vec![true; taken.facets.len()];
    Ok(taken)
}

fn take_tool(file: &FileMesh, chosen: Option<&Group>, wish: &Wish) -> Result<Taken> {
    let mesh = &file.mesh;
    let indices: Vec<u32> = match chosen {
        Some(group) => group.facets.clone(),
        None => (0..mesh.facets.len() as u32).collect(),
    };
    if indices.is_empty() {
        return Err(empty(file, wish));
    }
    let all: Vec<Facet> = indices.iter().map(|&index| mesh.facets[index as usize]).collect();
    let mut facets = Vec::new();
    let mut outward = Vec::new();
    let mut facet_map = vec![None; mesh.facets.len()];
    // An element and a surface made of it are one facet; two elements on the same nodes are for the check to refuse.
    let mut known: HashMap<(FaceKey, u64), u32> = HashMap::new();
    for ((&index, facet), owner) in indices.iter().zip(&all).zip(faces::owners(&mesh.solids, &all)) {
        let new = *known.entry((facet.key(), facet.id)).or_insert_with(|| {
            outward.push(matches!(owner, Owner::One { .. }));
            facets.push(match owner {
                Owner::One { solid, face } => Facet { id: facet.id, ..mesh.solids[solid as usize].face(face as usize) },
                _ => *facet,
            });
            facets.len() as u32 - 1
        });
        facet_map[index as usize] = Some(new);
    }
    let inside = vec![false; mesh.facets.len()];
    let mut middles = Middles::in_solids(mesh.solids.iter(), facets.iter().map(Facet::nodes), [].into_iter());
    middles.join(mesh.middles.clone());
    Ok(Taken {
        solids: Vec::new(),
        facets,
        outward,
        solid_map: vec![None; mesh.solids.len()],
        facet_map,
        inside,
        middles,
    })
}

impl Taken {
    /// The mesh of what was taken, with nodes in the order of the file.
    fn restrict(mut self, file: FileMesh) -> Mesh {
        let FileMesh { mut mesh, groups, halves, .. } = file;
        mesh.solids = Vec::new();
        let mut node_map = vec![u32::MAX; mesh.points.len()];
        let solid_nodes = self.solids.iter().flat_map(Solid::nodes);
        let facet_nodes = self.facets.iter().flat_map(|facet| self.nodes_of(facet));
        solid_nodes.copied().chain(facet_nodes).for_each(|node| node_map[node as usize] = 0);
        let mut result = Mesh {
            source: mesh.source.clone(),
            warnings: mesh.warnings.clone(),
            is_section: mesh.is_section,
            has_halves: halves.into_iter().flatten().any(|solid| self.solid_map[solid as usize].is_some()),
            ..Mesh::default()
        };
        for (new, index) in node_map.iter_mut().filter(|new| **new == 0).zip(0..) {
            *new = index;
        }
        // In place: a copy may be much of the memory of a scene.
        let mut kept = node_map.iter().chain(&node_map).map(|new| *new != u32::MAX);
        result.points = std::mem::take(&mut mesh.points);
        result.points.retain(|_| kept.next() == Some(true));
        result.point_ids = std::mem::take(&mut mesh.point_ids);
        result.point_ids.retain(|_| kept.next() == Some(true));
        for (name, found) in &groups {
            let group = self.restrict_group(found, &mesh, &node_map);
            if group != Group::default() {
                result.groups.insert(name.clone(), group);
            }
        }
        let renumber = |nodes: &mut [u32]| nodes.iter_mut().for_each(|node| *node = node_map[*node as usize]);
        self.solids.iter_mut().for_each(|solid| {
            let count = solid.nodes().len();
            renumber(&mut solid.nodes[..count]);
        });
        self.facets.iter_mut().for_each(|facet| renumber(&mut facet.nodes[..facet.count as usize]));
        result.solids = self.solids;
        result.facets = self.facets;
        result.middles = self.middles.renumbered(|node| Some(node_map[node as usize]).filter(|new| *new != u32::MAX));
        result
    }

    /// The nodes of a facet, those in the middles of its edges, too.
    fn nodes_of<'a>(&'a self, facet: &'a Facet) -> impl Iterator<Item = u32> + 'a {
        facet.nodes().iter().copied().chain(self.middles.around(facet.nodes()))
    }

    fn restrict_group(&self, found: &FileGroup, mesh: &Mesh, node_map: &[u32]) -> Group {
        let listed = &found.group;
        let mut group = Group {
            solids: listed.solids.iter().filter_map(|&solid| self.solid_map[solid as usize]).collect(),
            facets: listed.facets.iter().filter_map(|&facet| self.facet_map[facet as usize]).collect(),
            nodes: listed.nodes.clone(),
            lines: listed.lines.clone(),
        };
        if !found.closed {
            group.nodes.extend(group.solids.iter().flat_map(|&solid| self.solids[solid as usize].nodes()));
            group.nodes.extend(group.facets.iter().flat_map(|&facet| self.nodes_of(&self.facets[facet as usize])));
            let inside = listed.facets.iter().filter(|&&facet| self.inside[facet as usize]);
            group.nodes.extend(inside.flat_map(|&facet| self.nodes_of(&mesh.facets[facet as usize])));
            group.nodes.extend(listed.lines.iter().filter_map(|&[a, b]| self.middles.at(a, b)));
        }
        group.nodes.iter_mut().for_each(|node| *node = node_map[*node as usize]);
        group.nodes.retain(|&node| node != u32::MAX);
        group.lines.iter_mut().flatten().for_each(|node| *node = node_map[*node as usize]);
        group.lines.retain(|line| !line.contains(&u32::MAX));
        group.lines.sort_unstable();
        group.lines.dedup();
        for indices in [&mut group.nodes, &mut group.facets, &mut group.solids] {
            indices.sort_unstable();
            indices.dedup();
        }
        group
    }
}
