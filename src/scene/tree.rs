//! A TOML text as a tree in which every key and value knows the place where the user wrote it.
//!
//! Tables keep the order of the text. The tree can be written back as TOML, which overrides need; [`with_absolute_files`]
//! makes the text fit for another folder.

use crate::error::{Error, Location, Result};
use std::fmt::Write;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub value: Value,
    pub at: Location,
}

/// What a [`Node`] holds; a leaf is never a table or an array.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Leaf(toml::Value),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key of a table and its value.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub key: String,
    pub key_at: Location,
    pub node: Node,
}

impl Node {
    /// The value of a key, when this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node),
            _ => None,
        }
    }

    /// The string that stands under `name` when this is a table with one.
    pub fn name(&self) -> Option<&str> {
        match &self.get("name")?.value {
            Value::Leaf(leaf) => leaf.as_str(),
            _ => None,
        }
    }

    /// The kind of value, with its article.
    pub fn kind(&self) -> &'static str {
        match &self.value {
            Value::Table(_) => "a table",
            Value::List(_) => "a list",
            Value::Leaf(toml::Value::String(_)) => "a string",
            Value::Leaf(toml::Value::Integer(_) | toml::Value::Float(_)) => "a number",
            Value::Leaf(toml::Value::Boolean(_)) => "a boolean",
            Value::Leaf(_) => "a date",
        }
    }
}

/// Parses a whole document. Errors name the place of what is not TOML.
pub(super) fn parse_document(file: &str, text: &str) -> Result<Node> {
    let place = |byte| locate(file, text, byte);
    let at = Location { file: file.into(), line: 0, column: 0, text: "".into() };
    match DeTable::parse(text) {
        Ok(table) => Ok(Node { value: table_of(table.get_ref(), &place)?, at }),
        Err(error) => {
            let at = error.span().map_or(at, |span| place(span.start));
            let help = if is_decimal_comma(&at) { "numbers have a decimal point, as in 6.0" } else { "" };
            Err(Error::input(&at, format!("this is not TOML: {}", error.message()), help))
        }
    }
}

/// Whether a comma between digits stands there.
fn is_decimal_comma(at: &Location) -> bool {
    let around: Vec<char> = at.text.chars().skip(at.column.saturating_sub(2)).take(3).collect();
    matches!(around[..], [before, ',', after] if before.is_ascii_digit() && after.is_ascii_digit())
}

/// Parses one value, all of it at the same place; what is not TOML is a bare string.
pub(super) fn parse_value(text: &str, at: &Location) -> Result<Node> {
    match DeValue::parse(text) {
        Ok(value) => node_of(&value, &|_| at.clone()),
        Err(_) => Ok(Node { value: Value::Leaf(toml::Value::String(text.to_string())), at: at.clone() }),
    }
}

/// Whether a text is a bare string where a value is expected: no TOML, and no blanks that would be lost.
pub(super) fn is_bare(text: &str) -> bool {
    !text.is_empty() && text == text.trim() && DeValue::parse(text).is_err()
}

/// The place of a byte of the text; its `text` is the line it stands in.
fn locate(file: &str, text: &str, byte: usize) -> Location {
    let before = &text[..text.floor_char_boundary(byte)];
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    Location {
        file: file.into(),
        line: before.matches('\n').count() + 1,
        column: before[start..].chars().count() + 1,
        text: text[start..].lines().next().unwrap_or_default().trim().into(),
    }
}

fn node_of(spanned: &Spanned<DeValue>, place: &dyn Fn(usize) -> Location) -> Result<Node> {
    let at = place(spanned.span().start);
    let value = match spanned.get_ref() {
        DeValue::Table(table) => table_of(table, place)?,
        DeValue::Array(items) => Value::List(items.iter().map(|item| node_of(item, place)).collect::<Result<_>>()?),
        DeValue::String(text) => Value::Leaf(text.to_string().into()),
        DeValue::Boolean(value) => Value::Leaf((*value).into()),
        DeValue::Datetime(date) => Value::Leaf((*date).into()),
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(value) => Value::Leaf(value.into()),
            Err(_) => return Err(Error::input(&at, format!("the integer {digits} is too large"), "")),
        },
        DeValue::Float(digits) => match digits.as_str().parse::<f64>() {
            Ok(value) => Value::Leaf(value.into()),
            Err(_) => return Err(Error::input(&at, format!("{digits} is not a number"), "")),
        },
    };
    Ok(Node { value, at })
}

fn table_of(table: &DeTable, place: &dyn Fn(usize) -> Location) -> Result<Value> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let entry = |(key, value): (&Spanned<_>, &Spanned<_>)| {
        let key_at = place(key.span().start);
        Ok(Entry { key: ToString::to_string(key.get_ref()), key_at, node: node_of(value, place)? })
    };
    Ok(Value::Table(entries.into_iter().map(entry).collect::<Result<_>>()?))
}

/// Writes a document as TOML: `[table]` and `[table.name]` headers, `[[list]]` of tables, the rest inline.
/// The keys must be bare, as those of a checked scene are.
pub(super) fn to_toml(root: &Node) -> String {
    let mut out = String::new();
    write_table(&mut out, "", root);
    out
}

/// A scene's text with the files of its bodies and tools, which are relative to `directory`, as absolute paths. All else
/// stays as it is, comments too.
pub(super) fn with_absolute_files(text: &str, directory: &Path) -> String {
    let Ok(root) = DeTable::parse(text) else { return text.to_string() };
    let tables = ["body", "tool"].into_iter().filter_map(|kind| root.get_ref().get(kind)?.get_ref().as_table());
    let entries: Vec<_> = tables.flat_map(|table| table.values()).collect();
    let file = |key: &'static str| entries.iter().filter_map(move |entry| entry.get_ref().get(key));
    let mut files: Vec<_> = ["mesh", "nurbs", "bezier"].into_iter().flat_map(file).collect();
    files.sort_by_key(|file| std::cmp::Reverse(file.span().start));
    let mut moved = text.to_string();
    for file in files {
        let path = file.get_ref().as_str().and_then(|name| std::path::absolute(directory.join(name)).ok());
        if let Some(path) = path.as_ref().and_then(|path| path.to_str()) {
            moved.replace_range(file.span(), &toml::Value::from(path).to_string());
        }
    }
    moved
}

fn write_table(out: &mut String, path: &str, node: &Node) {
    let Value::Table(entries) = &node.value else { return };
    let depth = if path.is_empty() { 0 } else { path.split('.').count() };
    let has_header = |entry: &Entry| match &entry.node.value {
        Value::Table(_) => depth < 2,
        Value::List(items) => {
            depth == 0 && !items.is_empty() && items.iter().all(|i| matches!(i.value, Value::Table(_)))
        }
        Value::Leaf(_) => false,
    };
    let (below, own): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| has_header(entry));
    if depth > 0 && (!own.is_empty() || below.is_empty()) {
        let _ = writeln!(out, "\n[{path}]");
    }
    for entry in own {
        let _ = writeln!(out, "{} = {}", entry.key, inline(&entry.node));
    }
    for entry in below {
        let key = &entry.key;
        match &entry.node.value {
            Value::List(items) => items.iter().for_each(|item| {
                let _ = writeln!(out, "\n[[{key}]]\n{}", inline_entries(item).join("\n"));
            }),
            _ if depth == 0 => write_table(out, key, &entry.node),
            _ => write_table(out, &format!("{path}.{key}"), &entry.node),
        }
    }
}

/// A value in one line.
pub(super) fn inline(node: &Node) -> String {
    match &node.value {
        Value::Leaf(toml::Value::Float(value)) if value.is_finite() => format!("{value:?}"),
        Value::Leaf(leaf) => leaf.to_string(),
        Value::List(items) => format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Table(_) => format!("{{ {} }}", inline_entries(node).join(", ")),
    }
}

fn inline_entries(node: &Node) -> Vec<String> {
    let Value::Table(entries) = &node.value else { return Vec::new() };
    entries.iter().map(|entry| format!("{} = {}", entry.key, inline(&entry.node))).collect()
}
