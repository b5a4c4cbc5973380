//! The lines of a deck and of the files it includes, and keyword lines taken apart.

use crate::encoding;
use crate::error::{Error, Location, Result};
use crate::mesh::message;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A walk over the lines of a deck.
pub(super) struct Lines {
    /// Where included files are looked for.
    folder: PathBuf,
    stack: Vec<Source>,
    name: Arc<str>,
    line: usize,
    /// The current line, trimmed.
    pub text: String,
}

struct Source {
    name: Arc<str>,
    data: Vec<u8>,
    position: usize,
    line: usize,
}

impl Lines {
    pub fn new(path: &Path, name: &str, data: Vec<u8>) -> Self {
        let name: Arc<str> = name.into();
        let first = Source { name: name.clone(), data, position: 0, line: 0 };
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Self { folder, stack: vec![first], name, line: 0, text: String::new() }
    }

    /// Goes to the next line that is neither blank nor a comment; false at the end.
    pub fn advance(&mut self) -> bool {
        while let Some(source) = self.stack.last_mut() {
            let rest = &source.data[source.position..];
            if rest.is_empty() {
                self.stack.pop();
                continue;
            }
            let length = rest.iter().position(|&c| c == b'\n').unwrap_or(rest.len());
            let line = rest[..length].trim_ascii();
            source.position += (length + 1).min(rest.len());
            source.line += 1;
            if !line.is_empty() && !line.starts_with(b"**") {
                self.line = source.line;
                self.name.clone_from(&source.name);
                self.text.clear();
                self.text.push_str(&String::from_utf8_lossy(line));
                return true;
            }
        }
        false
    }

    /// Goes on with the lines of another file, then comes back.
    pub fn include(&mut self, file: &str) -> Result<()> {
        // Programs look in the folder of the deck; a deck that a scene elsewhere includes has its own beside it.
        let beside = Path::new(&*self.name).parent().unwrap_or(Path::new("")).join(file);
        let path = Some(self.folder.join(file)).filter(|path| path.exists() || !beside.exists()).unwrap_or(beside);
        let name: Arc<str> = path.display().to_string().into();
        if self.stack.iter().any(|source| source.name == name) {
            return Err(self.error(format!("'{file}' includes itself"), ""));
        }
        let data = std::fs::read(&path).map_err(|error| {
            let help = "included files are looked for in the folder of the deck";
            self.error(format!("cannot read the included file '{}': {error}", path.display()), help)
        })?;
        let data = encoding::unmarked(&path, data)
            .map_err(|(what, help)| self.error(format!("the included file '{name}' {what}"), &help))?;
        self.stack.push(Source { name, data, position: 0, line: 0 });
        Ok(())
    }

    /// The current line.
    pub fn at(&self) -> Location {
        let text = message::shorten(self.text.as_bytes(), 100).into();
        Location { file: self.name.clone(), line: self.line, column: 1, text }
    }

    /// An error on the current line.
    pub fn error(&self, what: impl Into<String>, help: &str) -> Error {
        Error::input(&self.at(), what, help)
    }

    /// A field of the current line as a number of a node or element.
    pub fn id(&self, field: &str, what: &str) -> Result<u64> {
        field.parse().map_err(|_| self.expected(what, field))
    }

    /// A field of the current line as a real number; an empty one is 0.
    pub fn real(&self, field: &str, what: &str) -> Result<f64> {
        if field.is_empty() {
            return Ok(0.0);
        }
        number(field).ok_or_else(|| self.expected(what, field))
    }

    fn expected(&self, what: &str, field: &str) -> Error {
        self.error(format!("expected {what}, found '{}'", message::shorten(field.as_bytes(), 40)), "")
    }
}

/// A real number; Fortran's `1.5D-3` is understood.
pub(crate) fn number(field: &str) -> Option<f64> {
    field.parse().or_else(|_| field.replace(['d', 'D'], "e").parse()).ok()
}

/// The fields of a data line; a comma at its end adds none.
pub(crate) fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.strip_suffix(',').unwrap_or(line).split(',').map(str::trim)
}

/// A keyword line: `*NAME, PARAMETER=value, FLAG`.
#[derive(Clone, Debug)]
pub(crate) struct Keyword {
    /// In capitals.
    pub name: String,
    /// Parameters in capitals, values as written without quotation marks.
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// Takes the current line, which starts with `*`, and the lines that continue it.
    pub(super) fn read(lines: &mut Lines) -> Self {
        let mut text = lines.text[1..].to_string();
        while text.ends_with(',') && lines.advance() {
            text.push_str(&lines.text);
        }
        let mut parts = text.split(',');
        let words: Vec<&str> = parts.next().unwrap_or_default().split_whitespace().collect();
        let parameters = parts.map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_uppercase(), value.trim().trim_matches('"').to_string())
        });
        Self { parameters: parameters.collect(), name: words.join(" ").to_uppercase() }
    }

    /// The names of its parameters.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|parameter| parameter.0.as_str())
    }

    pub fn has(&self, key: &str) -> bool {
        self.parameters.iter().any(|parameter| parameter.0 == key)
    }

    /// Whether a parameter is said to be off.
    pub fn is_off(&self, key: &str) -> bool {
        self.get(key).is_some_and(|value| value.eq_ignore_ascii_case("NO"))
    }

    pub fn get(&self, key: &str) -> Option<&str> {
        self.parameters.iter().find(|parameter| parameter.0 == key).map(|parameter| parameter.1.as_str())
    }

    /// A parameter that must be there.
    pub(super) fn require(&self, key: &str, lines: &Lines) -> Result<&str> {
        let value = self.get(key).filter(|value| !value.is_empty());
        value.ok_or_else(|| lines.error(format!("*{} needs {key}=", self.name), ""))
    }
}
