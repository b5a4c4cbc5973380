//! Abaqus and CalculiX decks: nodes, elements, sets and surfaces; all else in a deck is passed over.
//!
//! A node set, an element set and a surface of one name become one group. Its nodes are those of the node set, else of
//! the surface, else of the elements: Abaqus/CAE writes sets of faces as all the elements that touch them.
//! Sets of a part are named `instance.set`, and `set` alone where no other instance has that name; an instance is a
//! group too. Names keep their case and are compared without it.
//!
//! [`read_whole`] keeps the rest of the deck, too, as [`Card`]s, for who turns it into a scene.

mod groups;
mod lines;
mod section;
#[cfg(test)]
mod tests;
mod whole;

use super::message;
use super::raw::{Cell, CellShape, FileMesh};
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::scene::did_you_mean;
use lines::Lines;
pub(crate) use lines::{Keyword, fields};
pub(crate) use section::{DRAWN, LOWEST};
use std::collections::BTreeMap;
use std::path::Path;
pub(crate) use whole::{Card, Row, Whole, no_set, read_whole};

/// Reads a deck; `path` is where it lies, `source` names it in messages;
/// the axisymmetric elements of a body are drawn out by one layer.
pub(super) fn read(path: &Path, source: &str, data: Vec<u8>, is_body: bool) -> Result<FileMesh> {
    let mut deck = Deck::read(path, source, data, None)?;
    let is_section = is_body && deck.draw_out(source)?;
    groups::finish(deck, source, is_section)
}

/// What the data lines below the last keyword are.
enum Reading {
    /// There is no keyword yet.
    Start,
    Nothing,
    Nodes {
        set: Option<String>,
        is_cylindrical: bool,
    },
    Elements {
        shape: CellShape,
        set: Option<String>,
        partial: Vec<u64>,
    },
    Set {
        kind: Kind,
        key: String,
        scope: usize,
        generate: bool,
    },
    Surface {
        index: usize,
        nodes: bool,
    },
    /// So many lines of its position are read.
    Instance {
        line: usize,
    },
    /// Elements of a type that is not read.
    Unread {
        kind: String,
        set: Option<String>,
        /// The data line goes on with the element of the line before.
        goes_on: bool,
    },
    System,
}

impl Reading {
    /// The data of a keyword are over.
    fn end(&self, lines: &Lines) -> Result<()> {
        match self {
            Self::Elements { partial, .. } if !partial.is_empty() => {
                let what = format!("element {} is not complete before this line", partial[0]);
                Err(lines.error(what, "a line that is to be continued ends with a comma"))
            }
            _ => Ok(()),
        }
    }
}

/// Sets of nodes or of elements.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Node,
    Element,
}

/// All that a deck holds.
#[derive(Default)]
struct Deck {
    /// The first is the deck outside of parts with its assembly, the others are instances.
    scopes: Vec<Scope>,
    parts: Vec<Scope>,
    level: Level,
    /// Nodes from this number on are those that axisymmetric elements have in the second plane.
    drawn_from: Option<u64>,
    /// Where they are asked for.
    cards: Option<Vec<Card>>,
}

/// Where new nodes, elements and sets go.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Level {
    #[default]
    Root,
    Part,
    Instance,
}

/// A part, an instance or the assembly: what counts nodes and elements on its own.
#[derive(Clone, Default)]
struct Scope {
    name: String,
    /// The part that an instance is of.
    part: String,
    /// The elements from this one on have this type.
    kinds: Vec<(usize, String)>,
    point_ids: Vec<u64>,
    points: Vec<[f64; 3]>,
    cells: Vec<Cell>,
    /// Elements of types that are not read.
    unread: BTreeMap<u64, Unread>,
    /// Of nodes and of elements, by name in capitals.
    sets: [BTreeMap<String, Set>; 2],
    surfaces: Vec<Surface>,
}

impl Scope {
    fn sets(&self, kind: Kind) -> &BTreeMap<String, Set> {
        &self.sets[kind as usize]
    }

    /// The key of the set of this name, new if need be.
    fn declare(&mut self, kind: Kind, name: &str) -> String {
        let key = name.to_uppercase();
        let set = || Set { name: name.into(), ..Set::default() };
        self.sets[kind as usize].entry(key.clone()).or_insert_with(set);
        key
    }

    /// A declared set.
    fn set(&mut self, kind: Kind, key: &str) -> Option<&mut Set> {
        self.sets[kind as usize].get_mut(key)
    }
}

/// An element of a type that is not read.
#[derive(Clone)]
struct Unread {
    kind: String,
    at: Location,
}

impl Unread {
    fn error(&self, id: u64) -> Error {
        let what = format!("element {id} has type {}, which is not read", self.kind);
        Error::input(&self.at, what, READ)
    }
}

/// What is read.
const READ: &str = "nagata reads C3D8, C3D6, C3D5, C3D4, C3D20, C3D15, C3D10 and the surfaces S3, S4, R3D3, R3D4, CPS3, CPS4, CPS6, CPS8, \
                    ...: mesh with such, or name a `group` without other elements";

/// A set as listed.
#[derive(Clone, Default)]
struct Set {
    name: String,
    /// Made by Abaqus/CAE for its own ends, so no group.
    internal: bool,
    members: Vec<Member>,
}

/// A member of a set; `scope` 0 is the scope of the set itself, others are instances.
#[derive(Clone)]
enum Member {
    One {
        scope: usize,
        id: u64,
    },
    Range {
        scope: usize,
        first: u64,
        last: u64,
        step: u64,
    },
    Set {
        scope: usize,
        name: String,
        at: Location,
    },
    /// In a set of nodes, those of the elements of a set.
    Corners {
        scope: usize,
        name: String,
        at: Location,
    },
}

/// A surface as listed.
#[derive(Clone)]
struct Surface {
    name: String,
    /// Of nodes, not of faces.
    nodes: bool,
    members: Vec<(Member, Side, Location)>,
}

/// Which side of an element.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    /// All free faces of a solid, the positive side of a shell.
    Free,
    /// From 0.
    Face(u8),
    Positive,
    Negative,
}

impl Deck {
    /// All lines of a deck, with its cards if there is a list for them.
    fn read(path: &Path, source: &str, data: Vec<u8>, cards: Option<Vec<Card>>) -> Result<Self> {
        let mut lines = Lines::new(path, source, data);
        let mut deck = Self { cards, ..Self::default() };
        let mut reading = Reading::Start;
        while lines.advance() {
            if lines.text.starts_with('*') {
                reading.end(&lines)?;
                let at = lines.at();
                let keyword = Keyword::read(&mut lines);
                reading = deck.open(&keyword, &mut lines)?;
                deck.keep_card(keyword, at);
            } else {
                deck.take(&mut reading, &lines)?;
            }
        }
        reading.end(&lines)?;
        Ok(deck)
    }

    fn here(&mut self) -> &mut Scope {
        if self.scopes.is_empty() {
            self.scopes.push(Scope::default());
        }
        let instance = if self.level == Level::Instance { self.scopes.len() - 1 } else { 0 };
        match self.parts.last_mut() {
            Some(part) if self.level == Level::Part => part,
            _ => &mut self.scopes[instance],
        }
    }

    /// Acts on a keyword line.
    fn open(&mut self, keyword: &Keyword, lines: &mut Lines) -> Result<Reading> {
        match keyword.name.as_str() {
            "NODE" => self.open_nodes(keyword, lines),
            "ELEMENT" => self.open_elements(keyword, lines),
            "NSET" => self.open_set(Kind::Node, "NSET", keyword, lines),
            "ELSET" => self.open_set(Kind::Element, "ELSET", keyword, lines),
            "SURFACE" => self.open_surface(keyword, lines),
            "INCLUDE" => {
                let file = keyword.require("INPUT", lines)?.to_string();
                lines.include(&file)?;
                Ok(Reading::Nothing)
            }
            "PART" => {
                let name = keyword.require("NAME", lines)?.to_string();
                self.enter(Level::Part, lines)?;
                self.parts.push(Scope { part: name.clone(), name, ..Scope::default() });
                Ok(Reading::Nothing)
            }
            "INSTANCE" => self.open_instance(keyword, lines),
            "END PART" | "END INSTANCE" => {
                self.level = Level::Root;
                Ok(Reading::Nothing)
            }
            "SYSTEM" => Ok(Reading::System),
            "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" => {
                let what = format!("*{} is not read", keyword.name);
                Err(lines.error(what, "write out all nodes and elements"))
            }
            _ => Ok(Reading::Nothing),
        }
    }

    fn enter(&mut self, level: Level, lines: &Lines) -> Result<()> {
        self.here();
        if self.level != Level::Root {
            return Err(lines.error("the part or instance before this line is still open", "close it with *END"));
        }
        self.level = level;
        Ok(())
    }

    fn open_nodes(&mut self, keyword: &Keyword, lines: &Lines) -> Result<Reading> {
        let is_cylindrical = match keyword.get("SYSTEM").map(str::to_uppercase).as_deref() {
            None | Some("R") => false,
            Some("C") => true,
            Some(_) => {
                let what = "only rectangular and cylindrical coordinates are read";
                return Err(lines.error(what, "write the nodes with SYSTEM=R, or radius, degrees and z with SYSTEM=C"));
            }
        };
        refuse_input(keyword, lines)?;
        Ok(Reading::Nodes {
            set: keyword.get("NSET").map(|name| self.here().declare(Kind::Node, name)),
            is_cylindrical,
        })
    }

    fn open_elements(&mut self, keyword: &Keyword, lines: &Lines) -> Result<Reading> {
        let kind = keyword.require("TYPE", lines)?;
        refuse_input(keyword, lines)?;
        let Some(shape) = shape(kind) else {
            let set = keyword.get("ELSET").map(|name| self.here().declare(Kind::Element, name));
            return Ok(Reading::Unread { kind: kind.to_string(), set, goes_on: false });
        };
        let set = keyword.get("ELSET").map(|name| self.here().declare(Kind::Element, name));
        let scope = self.here();
        scope.kinds.push((scope.cells.len(), kind.to_uppercase()));
        Ok(Reading::Elements { shape, set, partial: Vec::new() })
    }

    fn open_set(&mut self, kind: Kind, key: &str, keyword: &Keyword, lines: &Lines) -> Result<Reading> {
        let name = keyword.require(key, lines)?;
        let scope = match keyword.get("INSTANCE") {
            Some(instance) => self.instance(instance, lines)?,
            None => 0,
        };
        let of_elements = keyword.get("ELSET").filter(|_| kind == Kind::Node);
        let corners = of_elements.map(|elements| {
            let (scope, name) = self.place_of(scope, elements);
            Member::Corners { scope, name: name.to_string(), at: lines.at() }
        });
        let key = self.here().declare(kind, name);
        if let Some(set) = self.here().set(kind, &key) {
            set.internal |= keyword.has("INTERNAL");
            set.members.extend(corners);
        }
        Ok(Reading::Set { kind, key, scope, generate: keyword.has("GENERATE") })
    }

    fn open_surface(&mut self, keyword: &Keyword, lines: &Lines) -> Result<Reading> {
        let name = keyword.require("NAME", lines)?.to_string();
        let nodes = match keyword.get("TYPE").map(str::to_uppercase).as_deref() {
            None | Some("ELEMENT") => false,
            Some("NODE") => true,
            // Analytical surfaces and cuts hold no mesh.
            Some(_) => return Ok(Reading::Nothing),
        };
        if keyword.has("COMBINE") || keyword.has("CROP") {
            return Err(lines.error("combined surfaces are not read", "list the elements and faces"));
        }
        let surfaces = &mut self.here().surfaces;
        surfaces.push(Surface { name, nodes, members: Vec::new() });
        Ok(Reading::Surface { index: surfaces.len() - 1, nodes })
    }

    fn open_instance(&mut self, keyword: &Keyword, lines: &Lines) -> Result<Reading> {
        let name = keyword.require("NAME", lines)?.to_string();
        let mut scope = Scope::default();
        if let Some(part) = keyword.get("PART") {
            let found = self.parts.iter().find(|scope| scope.name.eq_ignore_ascii_case(part));
            scope = found.cloned().ok_or_else(|| {
                let names = self.parts.iter().map(|scope| scope.name.as_str());
                lines.error(format!("there is no part '{part}' above"), &did_you_mean(part, names))
            })?;
        } else if keyword.has("LIBRARY") {
            return Err(lines.error("instances of another job's results are not read", ""));
        }
        self.enter(Level::Instance, lines)?;
        scope.part = std::mem::replace(&mut scope.name, name);
        self.scopes.push(scope);
        Ok(Reading::Instance { line: 0 })
    }

    /// The scope of an instance.
    fn instance(&self, name: &str, lines: &Lines) -> Result<usize> {
        self.find_instance(name).ok_or_else(|| {
            let names = self.scopes.iter().skip(1).map(|scope| scope.name.as_str());
            lines.error(format!("there is no instance '{name}' above"), &did_you_mean(name, names))
        })
    }

    fn find_instance(&self, name: &str) -> Option<usize> {
        (1..self.scopes.len()).find(|&scope| self.scopes[scope].name.eq_ignore_ascii_case(name))
    }
}

/// Data lines.
impl Deck {
    fn take(&mut self, reading: &mut Reading, lines: &Lines) -> Result<()> {
        match reading {
            Reading::Start => {
                let found = message::shorten(lines.text.as_bytes(), 30);
                Err(lines.error(format!("expected a keyword such as *NODE, found '{found}'"), ""))
            }
            Reading::Nothing => {
                self.keep_row(lines);
                Ok(())
            }
            Reading::Nodes { set, is_cylindrical } => self.take_node(set.as_deref(), *is_cylindrical, lines),
            Reading::Elements { shape, set, partial } => self.take_element(*shape, set.as_deref(), partial, lines),
            Reading::Set { kind, key, scope, generate } => self.take_set(*kind, key, *scope, *generate, lines),
            Reading::Surface { index, nodes } => self.take_surface(*index, *nodes, lines),
            Reading::Instance { line } => {
                self.keep_row(lines);
                *line += 1;
                self.take_position(*line, lines)
            }
            Reading::System => {
                Err(lines.error("coordinate systems of nodes are not read", "write global coordinates without *SYSTEM"))
            }
            Reading::Unread { kind, set, goes_on } => {
                if !std::mem::replace(goes_on, lines.text.ends_with(',')) {
                    self.take_unread(kind, set.as_deref(), lines)?;
                }
                Ok(())
            }
        }
    }

    /// An element of a type that is not read: an error for whoever takes it.
    fn take_unread(&mut self, kind: &str, set: Option<&str>, lines: &Lines) -> Result<()> {
        let id = lines.id(fields(&lines.text).next().unwrap_or_default(), "an element number")?;
        let scope = self.here();
        scope.unread.insert(id, Unread { kind: kind.to_string(), at: lines.at() });
        if let Some(set) = set.and_then(|key| scope.set(Kind::Element, key)) {
            set.members.push(Member::One { scope: 0, id });
        }
        Ok(())
    }

    fn take_node(&mut self, set: Option<&str>, is_cylindrical: bool, lines: &Lines) -> Result<()> {
        let mut fields = fields(&lines.text);
        let id = lines.id(fields.next().unwrap_or_default(), "a node number")?;
        let mut point = [0.0; 3];
        for (coordinate, field) in point.iter_mut().zip(&mut fields) {
            *coordinate = lines.real(field, "a coordinate")?;
        }
        if is_cylindrical {
            let [radius, degrees, z] = point;
            let (sin, cos) = degrees.to_radians().sin_cos();
            point = [radius * cos, radius * sin, z];
        }
        let scope = self.here();
        scope.point_ids.push(id);
        scope.points.push(point);
        if let Some(set) = set.and_then(|key| scope.set(Kind::Node, key)) {
            set.members.push(Member::One { scope: 0, id });
        }
        Ok(())
    }

    fn take_element(
        &mut self,
        shape: CellShape,
        set: Option<&str>,
        partial: &mut Vec<u64>,
        lines: &Lines,
    ) -> Result<()> {
        for field in fields(&lines.text) {
            partial.push(lines.id(field, if partial.is_empty() { "an element number" } else { "a node number" })?);
        }
        let id = partial.first().copied().unwrap_or_default();
        let (found, count) = (partial.len() - 1, shape.node_count());
        if found < count && lines.text.ends_with(',') {
            return Ok(());
        }
        if found != count {
            return Err(lines.error(format!("element {id} has {found} nodes, not {count}"), ""));
        }
        let cell = Cell { shape, id, nodes: partial[1..].into() };
        partial.clear();
        let scope = self.here();
        scope.cells.push(cell);
        if let Some(set) = set.and_then(|key| scope.set(Kind::Element, key)) {
            set.members.push(Member::One { scope: 0, id });
        }
        Ok(())
    }

    fn take_set(&mut self, kind: Kind, key: &str, scope: usize, generate: bool, lines: &Lines) -> Result<()> {
        let mut members = Vec::new();
        if generate {
            let mut numbers = [0, 0, 1];
            for (number, field) in numbers.iter_mut().zip(fields(&lines.text)) {
                *number = lines.id(field, "first, last and increment")?;
            }
            let [first, last, step] = numbers;
            if step == 0 || last < first {
                return Err(lines.error("expected first, last and increment", "first <= last, increment > 0"));
            }
            members.push(Member::Range { scope, first, last, step });
        } else {
            for field in fields(&lines.text).filter(|field| !field.is_empty()) {
                members.push(self.member(scope, field, lines));
            }
        }
        if let Some(set) = self.here().set(kind, key) {
            set.members.append(&mut members);
        }
        Ok(())
    }

    fn take_surface(&mut self, index: usize, nodes: bool, lines: &Lines) -> Result<()> {
        let mut fields = fields(&lines.text);
        let target = fields.next().unwrap_or_default().to_string();
        let label = fields.next().unwrap_or_default().to_uppercase();
        let side = match label.as_str() {
            _ if nodes => Side::Free,
            "" => Side::Free,
            "SPOS" | "POS" => Side::Positive,
            "SNEG" | "NEG" => Side::Negative,
            "S1" | "S2" | "S3" | "S4" | "S5" | "S6" => Side::Face(label.as_bytes()[1] - b'1'),
            _ => {
                let what = format!("expected a face S1 to S6, SPOS or SNEG, found '{label}'");
                return Err(lines.error(what, ""));
            }
        };
        if target.is_empty() {
            return Err(lines.error("expected a set or a number before the face", ""));
        }
        let member = self.member(0, &target, lines);
        if let Some(surface) = self.here().surfaces.get_mut(index) {
            surface.members.push((member, side, lines.at()));
        }
        Ok(())
    }

    /// A number or the name of a set, either with an instance in front: `12`, `top`, `instance.12`, `instance.top`.
    fn member(&self, scope: usize, field: &str, lines: &Lines) -> Member {
        let (scope, name) = self.place_of(scope, field);
        match name.parse() {
            Ok(id) => Member::One { scope, id },
            Err(_) => Member::Set { scope, name: name.to_string(), at: lines.at() },
        }
    }

    /// The scope of what a field names, in `scope` unless it has an instance in front, and its name there.
    fn place_of<'a>(&self, scope: usize, field: &'a str) -> (usize, &'a str) {
        let name = field.trim_matches('"');
        let parts = name.split_once('.').filter(|_| self.level == Level::Root);
        let unquoted = |part: &'a str| part.trim_matches('"');
        let found = parts.and_then(|(instance, rest)| Some((self.find_instance(unquoted(instance))?, unquoted(rest))));
        found.unwrap_or((scope, name))
    }

    /// The position of an instance: first a translation, then a rotation about the axis through two points, in degrees.
    fn take_position(&mut self, line: usize, lines: &Lines) -> Result<()> {
        let mut numbers = [0.0; 7];
        let count = if line == 1 { 3 } else { 7 };
        for (number, field) in numbers[..count].iter_mut().zip(fields(&lines.text)) {
            *number = lines.real(field, "the position of an instance")?;
        }
        let [ax, ay, az, bx, by, bz, degrees] = numbers;
        let a = Vec3::new(ax, ay, az);
        let points = self.here().points.iter_mut();
        match line {
            1 => points.for_each(|point| *point = (Vec3::from(*point) + a).into()),
            2 => {
                let Some(axis) = nalgebra::Unit::try_new(Vec3::new(bx, by, bz) - a, 0.0) else {
                    return Err(lines.error("the two points of the axis are the same", ""));
                };
                let rotation = nalgebra::Rotation3::from_axis_angle(&axis, degrees.to_radians());
                points.for_each(|point| *point = (a + rotation * (Vec3::from(*point) - a)).into());
            }
            _ => return Err(lines.error("an instance has two lines of position at most", "")),
        }
        Ok(())
    }
}

/// Data in a file of their own.
fn refuse_input(keyword: &Keyword, lines: &Lines) -> Result<()> {
    if keyword.has("INPUT") {
        return Err(lines.error(format!("*{}, INPUT= is not read", keyword.name), "use *INCLUDE"));
    }
    Ok(())
}

/// The shape of an element type; letters behind it, as in C3D8R, change the formulation alone.
fn shape(kind: &str) -> Option<CellShape> {
    let kind = kind.to_uppercase();
    let is = |families: &[&str]| {
        families.iter().any(|family| {
            let rest = kind.strip_prefix(family);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(|c: char| c.is_ascii_alphabetic()))
        })
    };
    let shapes: [(CellShape, &[&str]); 14] = [
        (CellShape::Hex, &["C3D8"]),
        (CellShape::Hex20, &["C3D20"]),
        (CellShape::Wedge15, &["C3D15"]),
        (CellShape::Wedge, &["C3D6"]),
        (CellShape::Pyramid, &["C3D5"]),
        (CellShape::Tet, &["C3D4"]),
        (CellShape::Tet10, &["C3D10"]),
        // Gmsh writes all its surface elements as CPS, meshio quadrilaterals as CAX.
        (CellShape::Quad, &["S4", "R3D4", "SFM3D4", "M3D4", "DS4", "CPS4", "CPE4", "CAX4"]),
        (CellShape::Quad8, &["S8", "SFM3D8", "M3D8", "DS8", "CPS8", "CPE8", "CAX8"]),
        (CellShape::Triangle, &["S3", "R3D3", "SFM3D3", "M3D3", "DS3", "STRI3", "CPS3", "CPE3", "CAX3"]),
        (CellShape::Triangle6, &["STRI65", "S6", "SFM3D6", "M3D6", "DS6", "CPS6", "CPE6", "CAX6"]),
        (CellShape::Line, &["T3D2", "B31", "B33", "SPRINGA", "SPRING2"]),
        (CellShape::Line3, &["T3D3"]),
        (CellShape::Point, &["MASS", "ROTARYI", "SPRING1"]),
    ];
    shapes.into_iter().find(|(_, families)| is(families)).map(|found| found.0)
}
