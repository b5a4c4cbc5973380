//! Gmsh files, versions 2.2 and 4.1, text and binary (Gmsh reference manual, "Gmsh file formats").
//!
//! A physical group becomes a group under its name, or under its number when it has no name ("surface 1" and
//! "volume 1" where several dimensions use that number). Points and lines give their groups nodes, and lines.

mod bytes;
#[cfg(test)]
mod tests;

use super::message;
use super::raw::{Cell, CellShape, FileMesh};
use crate::error::Result;
use bytes::{Bytes, Encoding};
use smallvec::SmallVec;
use std::collections::HashMap;

/// (dimension, number) of a physical group or an entity.
type Key = (i64, i64);

/// Names of the dimensions of groups.
const DIMENSIONS: [&str; 4] = ["point", "curve", "surface", "volume"];

/// Reads a whole file; `source` names it in messages.
pub(super) fn read(source: &str, data: Vec<u8>) -> Result<FileMesh> {
    let mut listed = list(source, &data)?;
    drop(data);
    listed.unite();
    listed.finish(source)
}

/// All that a file lists.
fn list(source: &str, data: &[u8]) -> Result<Listed> {
    let mut gmsh = Gmsh { input: Bytes::new(source, data), entities: HashMap::new(), listed: Listed::default() };
    let old = gmsh.read_format()?;
    let mut missing = vec!["$Nodes", "$Elements"];
    while let Some(name) = gmsh.input.section()? {
        missing.retain(|section| section.as_bytes()[1..] != *name);
        match (name, old) {
            (b"PhysicalNames", _) => gmsh.read_names()?,
            (b"Entities", false) => gmsh.read_entities(false)?,
            (b"PartitionedEntities", false) => gmsh.read_entities(true)?,
            (b"Nodes", true) => gmsh.read_nodes_2()?,
            (b"Nodes", false) => gmsh.read_nodes_4()?,
            (b"Elements", true) => gmsh.read_elements_2()?,
            (b"Elements", false) => gmsh.read_elements_4()?,
            _ => {
                gmsh.input.skip_section(name)?;
                continue;
            }
        }
        gmsh.input.end_section(name)?;
    }
    match missing.first() {
        Some(section) => Err(message::whole_file(source, format!("the file has no {section}"), "mesh before saving")),
        None => Ok(gmsh.listed),
    }
}

struct Gmsh<'a> {
    input: Bytes<'a>,
    /// Physical groups of each entity; negative where the group turns it over.
    entities: HashMap<Key, Vec<i64>>,
    listed: Listed,
}

#[derive(Default)]
struct Listed {
    names: HashMap<Key, String>,
    point_ids: Vec<u64>,
    points: Vec<[f64; 3]>,
    cells: Vec<Cell>,
    /// In version 2 the physical group that stands beside each cell, or 0.
    physical: Vec<i64>,
    /// Cells of each physical group.
    groups: HashMap<Key, Vec<u32>>,
}

impl Gmsh<'_> {
    /// Reads up to the end of `$MeshFormat` and sets the encoding; true for version 2.
    fn read_format(&mut self) -> Result<bool> {
        while let Some(name) = self.input.section()? {
            match name {
                b"MeshFormat" => break,
                b"NOD" => return Err(self.input.error_here("Gmsh version 1 is not read", VERSIONS)),
                _ => self.input.skip_section(name)?,
            }
        }
        let version: f64 = self.input.word_as("the version of the format")?;
        let old = (2.0..3.0).contains(&version);
        if !old && version != 4.1 {
            return Err(self.input.error_here(format!("Gmsh version {version} is not read"), VERSIONS));
        }
        let binary: u8 = self.input.word_as("the file type (0 or 1)")?;
        let size: u8 = self.input.word_as("the data size")?;
        if size != 8 && (old || size != 4) {
            return Err(self.input.error_here(format!("data size {size} is not read"), "Gmsh writes 8"));
        }
        if binary != 0 {
            self.input.end_line();
            self.input.encoding = Encoding::Binary { big: false, wide: size == 8 };
            match self.input.int("the number 1")? {
                1 => {}
                0x0100_0000 => self.input.encoding = Encoding::Binary { big: true, wide: size == 8 },
                other => return Err(self.input.error_here(format!("expected the number 1, found {other}"), "")),
            }
        }
        self.input.end_section(b"MeshFormat")?;
        Ok(old)
    }

    fn read_names(&mut self) -> Result<()> {
        for _ in 0..self.input.text_count("the number of physical names")? {
            let dimension = self.input.word_as("a dimension")?;
            let number = self.input.word_as("the number of a physical group")?;
            let name = self.input.quoted("the name of a physical group")?;
            self.listed.names.insert((dimension, number), name);
        }
        Ok(())
    }

    /// Only the physical groups of the entities matter here.
    fn read_entities(&mut self, partitioned: bool) -> Result<()> {
        let input = &mut self.input;
        if partitioned {
            input.size("the number of partitions")?;
            for _ in 0..2 * input.count("the number of ghost entities")? {
                input.int("a ghost entity")?;
            }
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = input.count("the number of entities")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let number = input.int("the number of an entity")?;
                if partitioned {
                    input.int("the dimension of a parent")?;
                    input.int("the number of a parent")?;
                    for _ in 0..input.count("the number of partitions of an entity")? {
                        input.int("a partition")?;
                    }
                }
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    input.real("a bound of an entity")?;
                }
                let mut physical = Vec::new();
                for _ in 0..input.count("the number of physical groups of an entity")? {
                    physical.push(input.int("a physical group")?);
                }
                if dimension > 0 {
                    for _ in 0..input.count("the number of bounding entities")? {
                        input.int("a bounding entity")?;
                    }
                }
                self.entities.insert((dimension, number), physical);
            }
        }
        Ok(())
    }

    fn read_nodes_2(&mut self) -> Result<()> {
        let count = self.input.text_count("the number of nodes")?;
        self.input.end_line();
        for _ in 0..count {
            let id = self.id("a node number")?;
            self.listed.point_ids.push(id);
            self.read_point()?;
        }
        Ok(())
    }

    fn read_nodes_4(&mut self) -> Result<()> {
        let blocks = self.input.count("the number of node blocks")?;
        for what in ["the number of nodes", "the smallest node number", "the largest node number"] {
            self.input.size(what)?;
        }
        for _ in 0..blocks {
            let dimension = self.input.int("the dimension of an entity")?;
            self.input.int("the number of an entity")?;
            let parametric = self.input.int("0 or 1 for parametric coordinates")? != 0;
            let count = self.input.count("the number of nodes of a block")?;
            for _ in 0..count {
                let id = self.input.size("a node number")?;
                self.listed.point_ids.push(id);
            }
            for _ in 0..count {
                self.read_point()?;
                for _ in 0..if parametric { dimension.clamp(0, 3) } else { 0 } {
                    self.input.real("a parametric coordinate")?;
                }
            }
        }
        Ok(())
    }

    fn read_point(&mut self) -> Result<()> {
        let mut point = [0.0; 3];
        for coordinate in &mut point {
            *coordinate = self.input.real("a coordinate")?;
        }
        self.listed.points.push(point);
        Ok(())
    }

    fn read_elements_2(&mut self) -> Result<()> {
        let mut left = self.input.text_count("the number of elements")?;
        self.input.end_line();
        let text = self.input.encoding == Encoding::Text;
        while left > 0 {
            // In binary, a header serves a run of elements and stands before their numbers.
            let mut id = if text { self.id("an element number")? } else { 0 };
            let kind = self.input.int("an element type")?;
            let run = if text { 1 } else { self.input.int("the number of elements of a run")? };
            if !(1..=left as i64).contains(&run) {
                let what = format!("a run has {run} elements, but {left} are left");
                return Err(self.input.error_here(what, ""));
            }
            left -= run as usize;
            let tag_count = self.input.int("the number of tags")?;
            for _ in 0..run {
                if !text {
                    id = self.id("an element number")?;
                }
                let mut physical = 0;
                for place in 0..tag_count {
                    let tag = self.input.int("a tag")?;
                    if place == 0 {
                        physical = tag;
                    }
                }
                self.read_cell_2(kind, id, physical)?;
            }
        }
        Ok(())
    }

    fn read_cell_2(&mut self, kind: i64, id: u64, physical: i64) -> Result<()> {
        let shape = self.shape(kind, id)?;
        let mut cell = Cell { shape, id, nodes: SmallVec::new() };
        for _ in 0..shape.node_count() {
            cell.nodes.push(self.id("a node number")?);
        }
        order(&mut cell);
        self.listed.cells.push(cell);
        self.listed.physical.push(physical);
        Ok(())
    }

    fn read_elements_4(&mut self) -> Result<()> {
        let blocks = self.input.count("the number of element blocks")?;
        for what in ["the number of elements", "the smallest element number", "the largest element number"] {
            self.input.size(what)?;
        }
        for _ in 0..blocks {
            let entity = (self.input.int("the dimension of an entity")?, self.input.int("the number of an entity")?);
            let kind = self.input.int("an element type")?;
            let count = self.input.count("the number of elements of a block")?;
            let physical = self.entities.get(&entity).cloned().unwrap_or_default();
            let start = self.listed.cells.len() as u32;
            for _ in 0..count {
                let id = self.input.size("an element number")?;
                let shape = self.shape(kind, id)?;
                let mut cell = Cell { shape, id, nodes: SmallVec::new() };
                for _ in 0..shape.node_count() {
                    cell.nodes.push(self.input.size("a node number")?);
                }
                order(&mut cell);
                if physical.first().is_some_and(|&p| p < 0) {
                    turn_over(&mut cell);
                }
                self.listed.cells.push(cell);
            }
            for number in physical {
                let cells = self.listed.groups.entry((entity.0, number.abs())).or_default();
                cells.extend(start..self.listed.cells.len() as u32);
            }
        }
        Ok(())
    }

    fn id(&mut self, what: &str) -> Result<u64> {
        let value = self.input.int(what)?;
        u64::try_from(value).map_err(|_| self.input.error_here(format!("expected {what}, found {value}"), ""))
    }

    fn shape(&self, kind: i64, id: u64) -> Result<CellShape> {
        let (name, help) = match kind {
            1 => return Ok(CellShape::Line),
            2 => return Ok(CellShape::Triangle),
            3 => return Ok(CellShape::Quad),
            4 => return Ok(CellShape::Tet),
            5 => return Ok(CellShape::Hex),
            6 => return Ok(CellShape::Wedge),
            7 => return Ok(CellShape::Pyramid),
            8 => return Ok(CellShape::Line3),
            9 => return Ok(CellShape::Triangle6),
            10 => return Ok(CellShape::Quad9),
            11 => return Ok(CellShape::Tet10),
            12 => return Ok(CellShape::Hex27),
            13 => return Ok(CellShape::Wedge18),
            15 => return Ok(CellShape::Point),
            16 => return Ok(CellShape::Quad8),
            17 => return Ok(CellShape::Hex20),
            18 => return Ok(CellShape::Wedge15),
            14 | 19 => ("second-order pyramids", PYRAMIDS),
            20.. => ("such elements", ORDER),
            _ => ("such elements", LINEAR),
        };
        let what = format!("element {id} has Gmsh type {kind}; {name} are not read");
        Err(self.input.error_here(what, help))
    }
}

impl Listed {
    /// Version 2 writes an element once for each of its groups. It goes where it stands first; a true duplicate, without a
    /// group or twice in one, stays, for the check to find.
    fn unite(&mut self) {
        if self.physical.is_empty() {
            return;
        }
        let mut order: Vec<(u64, u32)> = self.cells.iter().map(|cell| cell.nodes[0]).zip(0..).collect();
        order.sort_unstable();
        let mut goes: Vec<u32> = (0..order.len() as u32).collect();
        let mut groups = Vec::new();
        for near in order.chunk_by_mut(|a, b| a.0 == b.0) {
            let what = |k: u32| (self.cells[k as usize].shape as u8, &self.cells[k as usize].nodes);
            near.sort_unstable_by(|(_, a), (_, b)| (what(*a), a).cmp(&(what(*b), b)));
            for same in near.chunk_by(|a, b| what(a.1) == what(b.1)).filter(|same| same.len() > 1) {
                let mut at = same[0].1;
                groups.clear();
                for &(_, k) in same {
                    let physical = self.physical[k as usize];
                    if physical == 0 || groups.contains(&physical) || groups.is_empty() {
                        at = k;
                    }
                    goes[k as usize] = at;
                    groups.extend((physical != 0).then_some(physical));
                }
            }
        }
        let mut kept = 0;
        for k in 0..goes.len() {
            let stays = goes[k] == k as u32;
            goes[k] = if stays { kept } else { goes[goes[k] as usize] };
            if stays {
                self.cells.swap(kept as usize, k);
                kept += 1;
            }
            if self.physical[k] != 0 {
                let key = (i64::from(self.cells[goes[k] as usize].shape.dimension()), self.physical[k].abs());
                self.groups.entry(key).or_default().push(goes[k]);
            }
        }
        self.cells.truncate(kept as usize);
    }

    fn finish(self, source: &str) -> Result<FileMesh> {
        let mut file = FileMesh::new(source);
        let (_, slots) = file.append(self.point_ids, self.points, &self.cells)?;
        drop(self.cells);
        for (&(dimension, number), cells) in &self.groups {
            let elsewhere = |&(d, n): &Key| n == number && d != dimension && !self.names.contains_key(&(d, n));
            let name = match self.names.get(&(dimension, number)) {
                Some(name) => name.clone(),
                None if self.groups.keys().any(elsewhere) => {
                    let dimension = usize::try_from(dimension).ok().and_then(|d| DIMENSIONS.get(d));
                    format!("{} {number}", dimension.unwrap_or(&"entity"))
                }
                None => number.to_string(),
            };
            let group = &mut file.groups.entry(name).or_default().group;
            for &cell in cells {
                group.add(slots[cell as usize]);
            }
        }
        Ok(file)
    }
}

const VERSIONS: &str = "save it as version 4.1 or 2.2";
const ORDER: &str = "mesh with order 1 or 2";
const LINEAR: &str = "use hexahedra, wedges, pyramids or tetrahedra, and triangles or quadrilaterals on surfaces";
const PYRAMIDS: &str = "mesh with order 1, or with tetrahedra alone";

/// From the order of Gmsh to that of [`CellShape`].
fn order(cell: &mut Cell) {
    // Where what stands behind the corners is in Gmsh.
    let (corners, behind): (usize, &[usize]) = match cell.shape {
        CellShape::Tet10 => (8, &[9, 8]),
        CellShape::Hex20 => (8, &HEX[..12]),
        CellShape::Hex27 => (8, &HEX),
        CellShape::Wedge15 => (6, &WEDGE[..9]),
        CellShape::Wedge18 => (6, &WEDGE),
        _ => return,
    };
    let given = std::mem::take(&mut cell.nodes);
    cell.nodes = given[..corners].iter().copied().chain(behind.iter().map(|&at| given[at])).collect();
}

const HEX: [usize; 19] = [8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 20, 25, 21, 23, 24, 22, 26];
const WEDGE: [usize; 12] = [6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16];

/// A facet seen from the other side.
fn turn_over(cell: &mut Cell) {
    let corners = match cell.shape {
        CellShape::Triangle | CellShape::Triangle6 => 3,
        CellShape::Quad | CellShape::Quad8 | CellShape::Quad9 => 4,
        _ => return,
    };
    cell.nodes[1..corners].reverse();
    if cell.nodes.len() > corners {
        cell.nodes[corners..2 * corners].reverse();
    }
}
