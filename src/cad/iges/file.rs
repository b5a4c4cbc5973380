//! The global section and the directory of entities (IGES 5.3, chapter 2).
//!
//! The directory gives each entity two lines of fields eight columns wide; its number, by which others point to it, is
//! that of the first. Its parameters stand in lines of section P.

use super::entry::Entry;
use super::lines::{self, Line, NOT_COMPLETE, Section, padded};
use super::parameters::Record;
use crate::error::{Error, Result};
use crate::mesh::message;
use std::cell::Cell;
use std::ops::Range;

/// A file taken apart, its entities not yet read.
pub(super) struct File<'a> {
    source: &'a str,
    pub unit: Option<String>,
    pub entries: Vec<Entry>,
    data: Vec<Line<'a>>,
    /// Between parameters, and behind the last.
    delimiters: [u8; 2],
    /// How many more lines of parameters may be read before the file counts as malicious, see [`Self::record`].
    allowance: Cell<usize>,
}

impl<'a> File<'a> {
    /// Reads all but the parameters of entities. `source` names the file in messages.
    pub fn new(source: &'a str, bytes: &'a [u8]) -> Result<Self> {
        let [_, global, directory, data, _]: [Section; 5] = lines::sections(source, bytes)?;
        let allowance = Cell::new(1000 + 64 * data.len());
        let mut file = Self { source, unit: None, entries: Vec::new(), data, delimiters: *b",;", allowance };
        file.read_global(&global)?;
        file.entries = directory.chunks(2).enumerate().map(|pair| file.entry(pair)).collect::<Result<_>>()?;
        Ok(file)
    }

    /// An error about line `number` of the file.
    pub fn error(&self, line: Line, what: impl Into<String>, help: impl Into<String>) -> Error {
        lines::error(self.source, line, what, help)
    }

    /// An error about an entity.
    pub fn entry_error(&self, entry: &Entry, what: impl AsRef<str>, help: impl Into<String>) -> Error {
        let what = format!("{}: {}", entry.name(), what.as_ref());
        self.error(Line { number: entry.line, text: b"" }, what, help)
    }

    /// The entity that a pointer leads to.
    pub fn entry_at(&self, pointer: i64) -> Option<&Entry> {
        let index = usize::try_from(pointer).ok().filter(|pointer| pointer % 2 == 1)?;
        self.entries.get(index / 2)
    }

    /// The parameters of an entity.
    ///
    /// Entities share others, and those share others again: a few lines can ask for more than any computer has. All
    /// that is read here may be 64 times what the file holds.
    pub fn record(&self, entry: &Entry) -> Result<Record<'a>> {
        let lines = self.lines_of(entry)?;
        for line in &self.data[lines.clone()] {
            let owner = message::shorten(line.text.get(64..).unwrap_or_default(), 8);
            if !owner.trim().is_empty() && owner.trim().parse() != Ok(entry.number) {
                let what =
                    format!("{}: its parameters belong to D{} according to this line", entry.name(), owner.trim());
                return Err(self.error(*line, what, "columns 66 to 72 name the entity"));
            }
        }
        let Some(left) = self.allowance.get().checked_sub(lines.len()) else {
            return Err(self.entry_error(entry, "the entities of this file refer to each other too often", ""));
        };
        self.allowance.set(left);
        let record = Record::new(&self.data[lines], 64, self.delimiters);
        record.map_err(|(line, what)| self.error(line, format!("{}: {what}", entry.name()), ""))
    }

    fn lines_of(&self, entry: &Entry) -> Result<Range<usize>> {
        let [first, count] = entry.data.map(|value| usize::try_from(value).unwrap_or(0));
        let end = first.saturating_add(count);
        if first == 0 || count == 0 || end - 1 > self.data.len() {
            let [first, count] = entry.data;
            let what = format!("its parameters are said to be {count} lines from P{first} on");
            return Err(self.entry_error(entry, what, format!("section P has {} lines", self.data.len())));
        }
        Ok(first - 1..end - 1)
    }

    fn read_global(&mut self, lines: &[Line]) -> Result<()> {
        let Some(&first) = lines.first() else {
            return Err(message::whole_file(self.source, "the file has no global section (G)", NOT_COMPLETE));
        };
        let text: Vec<u8> = lines.iter().flat_map(|line| padded(line.text, 72)).collect();
        let mut at = 0;
        for delimiter in &mut self.delimiters {
            // `1H/` or nothing, which leaves the delimiter as it is; then the first of them.
            match text[at..] {
                [b'1', b'H' | b'h', given, _, ..] => {
                    *delimiter = given;
                    at += 4;
                }
                _ => at += 1,
            }
        }
        let [between, behind] = self.delimiters;
        let usable = |c: u8| c.is_ascii_graphic() && !c.is_ascii_alphanumeric() && !b"+-.".contains(&c);
        if !usable(between) || !usable(behind) || between == behind {
            let what = format!("'{}' and '{}' cannot end parameters and records", between as char, behind as char);
            return Err(self.error(first, what, "usual are 1H, and 1H;"));
        }
        let record = Record::new(lines, 72, self.delimiters);
        let record = record.map_err(|(line, what)| self.error(line, format!("global section: {what}"), ""))?;
        let flag = match record.text(13).as_deref() {
            None | Some("") => Some(1),
            Some(flag) => flag.parse().ok(),
        };
        self.unit = match flag {
            Some(3) => record.text(14).filter(|name| !name.is_empty()),
            Some(flag) => UNITS.iter().find(|unit| unit.0 == flag).map(|unit| unit.1.to_string()),
            None => return Err(self.error(first, "global section: parameter 14 is not the flag of a unit", "2 is mm")),
        };
        Ok(())
    }

    fn entry(&self, (index, lines): (usize, &[Line])) -> Result<Entry> {
        let &[first, second] = lines else {
            return Err(self.error(lines[0], "the directory ends within an entity", NOT_COMPLETE));
        };
        let field = |line: Line, index: usize, what: &str| -> Result<i64> {
            let field = line.text.get(8 * index..).unwrap_or_default();
            let field = message::shorten(&field[..field.len().min(8)], 8);
            match field.trim() {
                "" => Ok(0),
                text => text.parse().map_err(|_| {
                    let what = format!("expected {what} in columns {} to {}", 8 * index + 1, 8 * index + 8);
                    self.error(line, format!("{what}, found '{text}'"), "a whole number")
                }),
            }
        };
        let kind = field(first, 0, "the type of an entity")?;
        if field(second, 0, "the type of an entity again")? != kind {
            return Err(self.error(second, format!("the line before has an entity of type {kind}, this another"), ""));
        }
        Ok(Entry {
            number: 2 * index + 1,
            kind,
            form: field(second, 4, "the form of an entity")?,
            matrix: field(first, 6, "a pointer to a transformation")?,
            // The fourth digit of the status.
            dependent: matches!(first.text.get(67), Some(b'1' | b'3')),
            data: [field(first, 1, "the first line of the parameters")?, field(second, 3, "a number of lines")?],
            line: first.number,
        })
    }
}

/// Flag of each unit of length and its name.
const UNITS: [(i64, &str); 10] = [
    (1, "inch"),
    (2, "mm"),
    (4, "foot"),
    (5, "mile"),
    (6, "m"),
    (7, "km"),
    (8, "mil"),
    (9, "micron"),
    (10, "cm"),
    (11, "microinch"),
];
