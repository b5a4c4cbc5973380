//! Parameters in free format (IGES 5.3, 2.2.3): numbers and strings between delimiters, over several lines.
//!
//! A string is `5Hhello`: it may hold delimiters and go over the end of a line. A parameter without text has its
//! default: zero for a number, none for a pointer.

use super::entry::Entry;
use super::file::File;
use super::lines::{Line, padded};
use crate::error::{Error, Result};
use crate::mesh::message;
use std::ops::Range;

/// The parameters of an entity, or of the global section.
pub(super) struct Record<'a> {
    lines: Vec<Line<'a>>,
    width: usize,
    bytes: Vec<u8>,
    /// Where in the bytes each parameter stands, without blanks around it; strings without their count.
    places: Vec<Range<usize>>,
}

impl<'a> Record<'a> {
    /// Takes the first `width` columns of lines apart. An error comes with the line it is about.
    pub fn new(lines: &[Line<'a>], width: usize, [between, behind]: [u8; 2]) -> Result<Self, (Line<'a>, String)> {
        let bytes: Vec<u8> = lines.iter().flat_map(|line| padded(line.text, width)).collect();
        let mut record = Self { lines: lines.to_vec(), width, bytes, places: Vec::new() };
        let mut at = 0;
        loop {
            let rest = &record.bytes[at..];
            at += rest.iter().position(|&c| c != b' ').unwrap_or(rest.len());
            let mut place = record.string(at).map_err(|what| (record.line(at), what))?;
            let from = if place.is_empty() { at } else { place.end };
            let rest = &record.bytes[from..];
            let Some(length) = rest.iter().position(|&c| c == between || c == behind) else {
                let what = format!("there is no '{}' at the end of the parameters", behind as char);
                return Err((record.line(from), what));
            };
            if place.is_empty() {
                place = at..at + rest[..length].trim_ascii_end().len();
            }
            record.places.push(place);
            at = from + length + 1;
            if record.bytes[at - 1] == behind {
                return Ok(record);
            }
        }
    }

    /// The text of parameter `index`, from 0.
    pub fn text(&self, index: usize) -> Option<String> {
        let place = self.places.get(index)?;
        Some(String::from_utf8_lossy(&self.bytes[place.clone()]).into_owned())
    }

    /// Where the characters of a string stand that begins at `at`; empty when none does.
    fn string(&self, at: usize) -> Result<Range<usize>, String> {
        let rest = &self.bytes[at..];
        let digits = rest.iter().take_while(|c| c.is_ascii_digit()).count();
        if digits == 0 || !matches!(rest.get(digits), Some(b'H' | b'h')) {
            return Ok(at..at);
        }
        let count = std::str::from_utf8(&rest[..digits]).ok().and_then(|digits| digits.parse::<usize>().ok());
        let start = at + digits + 1;
        match count {
            Some(count) if count <= self.bytes.len() - start => Ok(start..start + count),
            _ => Err(format!("a string is to have {} characters, but the parameters end", shown(&rest[..digits]))),
        }
    }

    /// The line that holds byte `at`.
    fn line(&self, at: usize) -> Line<'a> {
        self.lines[(at / self.width).min(self.lines.len() - 1)]
    }
}

/// The parameters of an entity, read one after the other.
pub(super) struct Parameters<'a, 'f> {
    file: &'f File<'a>,
    pub entry: &'f Entry,
    record: Record<'a>,
    next: usize,
}

impl<'a, 'f> Parameters<'a, 'f> {
    /// Those of `entry`, behind its type.
    pub fn new(file: &'f File<'a>, entry: &'f Entry) -> Result<Self> {
        let mut parameters = Self { file, entry, record: file.record(entry)?, next: 0 };
        let kind = parameters.int("the type of the entity")?;
        if kind != entry.kind {
            return Err(parameters.error(format!("its parameters are those of a type {kind}"), ""));
        }
        Ok(parameters)
    }

    /// A whole number.
    pub fn int(&mut self, what: &str) -> Result<i64> {
        let text = self.text(what)?;
        if text.is_empty() { Ok(0) } else { text.parse().map_err(|_| self.expected(what, &text)) }
    }

    /// A finite number; Fortran's `1.5D-3` is understood.
    pub fn real(&mut self, what: &str) -> Result<f64> {
        let text = self.text(what)?;
        if text.is_empty() {
            return Ok(0.0);
        }
        let value = text.parse().or_else(|_| text.replace(['d', 'D'], "e").parse());
        value.ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| self.expected(what, &text))
    }

    /// `N` coordinates.
    pub fn reals<const N: usize>(&mut self, what: &str) -> Result<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real(what)?;
        }
        Ok(values)
    }

    /// How many of something follow, of which each takes a parameter at least.
    pub fn count(&mut self, what: &str) -> Result<usize> {
        let count = self.int(what)?;
        let left = self.left();
        match usize::try_from(count) {
            Ok(count) if count <= left => Ok(count),
            _ => Err(self.error(format!("{what} is {count}, but {left} parameters follow"), "")),
        }
    }

    /// Passes over a parameter of any kind.
    pub fn skip(&mut self) {
        self.next = (self.next + 1).min(self.record.places.len());
    }

    /// Number of parameters not yet read.
    pub fn left(&self) -> usize {
        self.record.places.len() - self.next
    }

    /// Another entity.
    pub fn entity(&mut self, what: &str) -> Result<&'f Entry> {
        match self.optional_entity(what)? {
            Some(entry) => Ok(entry),
            None => Err(self.error(format!("expected {what}, found none"), "")),
        }
    }

    /// Another entity, or none.
    pub fn optional_entity(&mut self, what: &str) -> Result<Option<&'f Entry>> {
        let pointer = self.int(what)?;
        match self.file.entry_at(pointer) {
            None if pointer != 0 => {
                let help = format!("entities have odd numbers up to {}", 2 * self.file.entries.len().max(1) - 1);
                Err(self.error(format!("D{pointer} as {what} is no entity"), help))
            }
            entry => Ok(entry),
        }
    }

    /// An error about the parameter that was read last.
    pub fn error(&self, what: impl AsRef<str>, help: impl Into<String>) -> Error {
        let last = self.next.max(1) - 1;
        let place = self.record.places.get(last).or(self.record.places.last());
        let line = self.record.line(place.map_or(0, |place| place.start));
        self.file.error(line, format!("{}: {}", self.entry.name(), what.as_ref()), help)
    }

    fn text(&mut self, what: &str) -> Result<String> {
        let text = self.record.text(self.next);
        self.next += usize::from(text.is_some());
        text.ok_or_else(|| self.error(format!("the parameters end where {what} is expected"), ""))
    }

    fn expected(&self, what: &str, found: &str) -> Error {
        let text = format!("expected {what} as parameter {}, found '{}'", self.next - 1, shown(found.as_bytes()));
        self.error(text, "")
    }
}

fn shown(text: &[u8]) -> String {
    message::shorten(text, 40)
}
