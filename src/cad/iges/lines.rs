//! The lines of a file and their sections (IGES 5.3, chapter 2).
//!
//! A line has 72 columns of data, the letter of its section (S start, G global, D directory, P parameter data,
//! T terminate) and its number in the section.

use crate::error::{Error, Location, Result};
use crate::mesh::message;

/// A line of the file.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    /// In the file, from 1.
    pub number: usize,
    /// Up to column 72.
    pub text: &'a [u8],
}

pub(super) type Section<'a> = Vec<Line<'a>>;

pub(super) const NOT_COMPLETE: &str = "the file seems cut off; write it again";

/// An error about a line.
pub(super) fn error(source: &str, line: Line, what: impl Into<String>, help: impl Into<String>) -> Error {
    let text = message::shorten(line.text, 72).into();
    Error::input(&Location { file: source.into(), line: line.number, column: 1, text }, what, help)
}

/// The text of a line filled up with blanks.
pub(super) fn padded(text: &[u8], width: usize) -> impl Iterator<Item = u8> {
    let blanks = width.saturating_sub(text.len());
    text[..text.len().min(width)].iter().copied().chain(std::iter::repeat_n(b' ', blanks))
}

/// The lines of the sections S, G, D, P and T, which must come in this order, numbered, and as many as T says.
pub(super) fn sections<'a>(source: &str, bytes: &'a [u8]) -> Result<[Section<'a>; 5]> {
    const LETTERS: &[u8; 5] = b"SGDPT";
    let mut sections: [Section; 5] = Default::default();
    let mut current = 0;
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    let lines = bytes.split(|&c| c == end).map(|text| text.strip_suffix(b"\r").unwrap_or(text));
    for (number, text) in (1..).zip(lines).filter(|(_, text)| !text.trim_ascii().is_empty()) {
        let line = Line { number, text: &text[..text.len().min(72)] };
        let letter = text.get(72).copied().unwrap_or(b' ');
        match LETTERS.iter().position(|&section| section == letter) {
            Some(section) if section >= current => current = section,
            None if number == 1 && (letter == b'C' || letter == b'B') => {
                let what = "compressed and binary IGES files are not read";
                return Err(error(source, line, what, "write the file in fixed ASCII format"));
            }
            found => {
                let what = if found.is_some() { "a section that is over goes on here" } else { "not a line of IGES" };
                let help = "column 73 holds the section: S, G, D, P and T in this order";
                return Err(error(source, line, what, help));
            }
        }
        let place = message::shorten(&text[73..text.len().min(80)], 7);
        sections[current].push(line);
        let expected = sections[current].len();
        if !place.trim().is_empty() && place.trim().parse() != Ok(expected) {
            let what = format!("this is line {expected} of section {}, not '{}'", letter as char, place.trim());
            return Err(error(source, line, what, "a line is missing, or one too many, before"));
        }
        if letter == b'T' {
            break;
        }
    }
    let Some(&last) = sections[4].first() else {
        return Err(message::whole_file(source, "the file has no terminate section (T)", NOT_COMPLETE));
    };
    for (section, count) in sections.iter().zip(last.text.chunks(8)).take(4) {
        let text = message::shorten(count, 8);
        let said = text.get(1..).unwrap_or_default().trim();
        if said.parse() != Ok(section.len()) {
            let what = format!("section {} has {} lines, not {said}", text.get(..1).unwrap_or_default(), section.len());
            return Err(error(source, last, what, NOT_COMPLETE));
        }
    }
    Ok(sections)
}
