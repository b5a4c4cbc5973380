//! Reads numbers from a Gmsh file, written as text or in binary, and says where it could not.

use crate::error::{Error, Location, Result};
use crate::mesh::message;

/// How the numbers of a section are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// `big`: most significant byte first; `wide`: sizes have 8 bytes, not 4.
    Binary {
        big: bool,
        wide: bool,
    },
}

/// A cursor over the bytes of a file.
pub(super) struct Bytes<'a> {
    source: &'a str,
    data: &'a [u8],
    position: usize,
    pub encoding: Encoding,
}

impl<'a> Bytes<'a> {
    pub fn new(source: &'a str, data: &'a [u8]) -> Self {
        Self { source, data, position: 0, encoding: Encoding::Text }
    }

    /// An integer: a word, or 4 bytes.
    pub fn int(&mut self, what: &str) -> Result<i64> {
        match self.encoding {
            Encoding::Text => self.word_as(what),
            Encoding::Binary { big, .. } => {
                let bytes = self.take(what)?;
                Ok(if big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) }.into())
            }
        }
    }

    /// A size or a number of version 4: a word, or 4 or 8 bytes.
    pub fn size(&mut self, what: &str) -> Result<u64> {
        match self.encoding {
            Encoding::Text => self.word_as(what),
            Encoding::Binary { big, wide: true } => {
                let bytes = self.take(what)?;
                Ok(if big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
            }
            Encoding::Binary { big, wide: false } => {
                let bytes = self.take(what)?;
                Ok(if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }.into())
            }
        }
    }

    /// A real number: a word, or 8 bytes.
    pub fn real(&mut self, what: &str) -> Result<f64> {
        match self.encoding {
            Encoding::Text => self.word_as(what),
            Encoding::Binary { big, .. } => {
                let bytes = self.take(what)?;
                Ok(if big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
            }
        }
    }

    /// How many of something follow. Each takes a byte at least, so a count beyond the file's end is refused before
    /// memory is reserved for it.
    pub fn count(&mut self, what: &str) -> Result<usize> {
        let start = self.position;
        let count = self.size(what)?;
        self.fits(start, count, what)
    }

    /// A [`count`](Self::count) that is text in binary files too.
    pub fn text_count(&mut self, what: &str) -> Result<usize> {
        self.skip_space();
        let start = self.position;
        let count = self.word_as(what)?;
        self.fits(start, count, what)
    }

    fn fits(&self, start: usize, count: u64, what: &str) -> Result<usize> {
        let left = self.data.len() - self.position;
        match usize::try_from(count) {
            Ok(count) if count <= left => Ok(count),
            _ => Err(self.error(start, format!("{what} is {count}, but only {left} bytes follow"), CUT_OFF)),
        }
    }

    /// A word read as `T`, in any encoding.
    pub fn word_as<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.word();
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        value.ok_or_else(|| {
            let start = self.position - word.len();
            if word.is_empty() {
                self.error(start, format!("the file ends where {what} is expected"), CUT_OFF)
            } else {
                self.error(start, format!("expected {what}, found '{}'", message::shorten(word, 40)), "")
            }
        })
    }

    /// The next word; empty at the end.
    pub fn word(&mut self) -> &'a [u8] {
        self.skip_space();
        let rest = &self.data[self.position..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position += length;
        &rest[..length]
    }

    /// Text between quotation marks on the same line.
    pub fn quoted(&mut self, what: &str) -> Result<String> {
        let start = self.position;
        let rest = &self.data[start..];
        let line = &rest[..rest.iter().position(|&c| c == b'\n').unwrap_or(rest.len())];
        let mut marks = line.iter().enumerate().filter(|(_, c)| **c == b'"').map(|(at, _)| at);
        match (marks.next(), marks.next()) {
            (Some(open), Some(close)) => {
                self.position += close + 1;
                Ok(String::from_utf8_lossy(&line[open + 1..close]).into_owned())
            }
            _ => Err(self.error(start, format!("expected {what} in quotation marks"), "")),
        }
    }

    /// The name of the next section, behind its `$`; the cursor goes on to the next line. `None` at the end.
    pub fn section(&mut self) -> Result<Option<&'a [u8]>> {
        let word = self.word();
        let start = self.position - word.len();
        self.end_line();
        match word.strip_prefix(b"$") {
            Some(name) => Ok(Some(name)),
            None if word.is_empty() => Ok(None),
            None => Err(self.error(start, format!("expected a section such as $Nodes, found '{}'", shown(word)), "")),
        }
    }

    /// Goes on to the next line.
    pub fn end_line(&mut self) {
        let rest = &self.data[self.position..];
        self.position += rest.iter().position(|&c| c == b'\n').map_or(rest.len(), |at| at + 1);
    }

    /// Skips to the end of section `name`, wherever in it the cursor is.
    pub fn skip_section(&mut self, name: &[u8]) -> Result<()> {
        let end = [b"$End", name].concat();
        let rest = &self.data[self.position..];
        match rest.windows(end.len()).position(|text| text == end) {
            Some(at) => self.position += at + end.len(),
            None => return Err(self.error_here(format!("section ${} has no end", shown(name)), CUT_OFF)),
        }
        Ok(())
    }

    /// Expects the end of section `name` here.
    pub fn end_section(&mut self, name: &[u8]) -> Result<()> {
        let word = self.word();
        if word.strip_prefix(b"$End") == Some(name) {
            return Ok(());
        }
        let start = self.position - word.len();
        let found = if word.is_empty() { "the end of the file".into() } else { format!("'{}'", shown(word)) };
        let help = "the section holds more or less than its counts say";
        Err(self.error(start, format!("expected $End{}, found {found}", shown(name)), help))
    }

    /// An error about what was read last.
    pub fn error_here(&self, what: impl Into<String>, help: &str) -> Error {
        self.error(self.position.saturating_sub(1), what, help)
    }

    /// An error at a position: line and column of text, or the byte of binary data.
    fn error(&self, position: usize, what: impl Into<String>, help: &str) -> Error {
        if self.encoding != Encoding::Text {
            return message::whole_file(self.source, format!("byte {position}: {}", what.into()), help);
        }
        let before = &self.data[..position];
        let line_start = before.iter().rposition(|&c| c == b'\n').map_or(0, |at| at + 1);
        let line_length = self.data[line_start..].iter().position(|&c| c == b'\n');
        let line = &self.data[line_start..line_length.map_or(self.data.len(), |length| line_start + length)];
        let at = Location {
            file: self.source.into(),
            line: before.iter().filter(|&&c| c == b'\n').count() + 1,
            column: position - line_start + 1,
            text: message::shorten(line, 100).into(),
        };
        Error::input(&at, what, help)
    }

    fn skip_space(&mut self) {
        let rest = &self.data[self.position..];
        self.position += rest.iter().position(|c| !c.is_ascii_whitespace()).unwrap_or(rest.len());
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        match self.data[self.position..].first_chunk() {
            Some(bytes) => {
                self.position += N;
                Ok(*bytes)
            }
            None => Err(self.error(self.position, format!("the file ends where {what} is expected"), CUT_OFF)),
        }
    }
}

const CUT_OFF: &str = "the file seems cut off; write it again";

fn shown(name: &[u8]) -> String {
    message::shorten(name, 40)
}
