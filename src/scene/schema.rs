//! Help with writing scenes: one to start from, and the JSON schema by which editors complete and check them, made of the
//! tables of keys of docs/scene.md, which tests hold against the reader.

use crate::controls::{Control, Controls};
use crate::error::{Error, Result};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fs::{OpenOptions, remove_file};
use std::io::{self, Write as _};
use std::path::Path;

const DOCUMENT: &str = include_str!("../../docs/scene.md");

/// A scene with comments, which runs as it is.
const TEMPLATE: &str = include_str!("template.toml");

/// Writes a scene to start from, but over no file.
///
/// # Errors
/// [`Error::Input`] when there is a file, or none can be made; [`Error::System`] when it cannot be written, and is removed.
pub fn begin(path: &Path) -> Result<()> {
    let failed = |error: &io::Error| format!("cannot write {}: {error}", path.display());
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .map_err(|error| Error::input_anywhere(failed(&error), "give the name of a new file"))?;
    file.write_all(TEMPLATE.as_bytes()).map_err(|error| {
        let _ = remove_file(path); // half a scene is none
        Error::System(failed(&error))
    })
}

/// A key as the document has it.
struct Row {
    key: &'static str,
    /// It must be given.
    is_needed: bool,
    kind: &'static str,
    default: &'static str,
    meaning: &'static str,
}

/// Tables of keys by their headings, as in `body.NAME.block`.
type Tables = BTreeMap<&'static str, Vec<Row>>;

/// The schema, as JSON text: draft 7, which editors of TOML read.
pub fn schema() -> String {
    let tables = tables();
    let mut all = Map::new();
    all.insert("title".into(), json!({ "type": "string", "description": "one line about the scene" }));
    for heading in tables.keys() {
        let table = || table(&tables, heading);
        match heading.split_once('.') {
            // One for each name that the user chooses.
            Some((name, "NAME")) => {
                all.insert(name.into(), json!({ "type": "object", "additionalProperties": table() }));
            }
            None if DOCUMENT.contains(&format!("[[{heading}]]")) => {
                all.insert((*heading).into(), json!({ "type": "array", "items": table() }));
            }
            None => {
                all.insert((*heading).into(), table());
            }
            Some(_) => {}
        }
    }
    let control = |control: &Control| {
        let told = format!("{}; by default {:?}", control.unit, control.default);
        let (kind, [least, most]) = (if control.is_integer { "integer" } else { "number" }, control.range);
        let value = json!({ "type": kind, "minimum": least, "maximum": most, "description": told });
        (control.name.to_string(), value)
    };
    let controls: Map<String, Value> = Controls::TABLE.iter().map(control).collect();
    all.insert("controls".into(), closed(controls));
    let mut whole = closed(all);
    whole["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    whole["title"] = "A scene of nagata".into();
    whole["required"] = json!(["body", "material", "step"]);
    format!("{whole:#}\n")
}

/// An object with these keys and no others.
fn closed(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// The tables that have a key, by their headings; none if many have it.
pub fn tables_with(key: &str) -> Vec<&'static str> {
    const MANY: usize = 4;
    let has = |rows: &[Row]| rows.iter().any(|row| row.key == key);
    let found: Vec<_> = tables().into_iter().filter(|(_, rows)| has(rows)).map(|(heading, _)| heading).collect();
    if found.len() < MANY { found } else { Vec::new() }
}

fn tables() -> Tables {
    let (mut tables, mut heading) = (Tables::new(), None);
    for line in DOCUMENT.lines() {
        if line.starts_with('#') {
            heading = line.split('`').nth(1);
        }
        let (Some(heading), Some(rest)) = (heading, line.strip_prefix("| `")) else { continue };
        let cells: Vec<&str> = rest.split(" |").map(str::trim).collect();
        if let ([first, kind, default, meaning, ..], Some((key, _))) = (cells.as_slice(), cells[0].split_once('`')) {
            debug_assert!(first.starts_with(key));
            let is_needed = first.ends_with('*');
            tables.entry(heading).or_default().push(Row { key, is_needed, kind, default, meaning });
        }
    }
    tables
}

fn table(tables: &Tables, heading: &str) -> Value {
    let value = |row: &Row| {
        let mut value = match row.kind {
            "table" => table(tables, &format!("{heading}.{}", row.key)),
            "VECTOR or table" => {
                json!({ "anyOf": [typed("VECTOR"), table(tables, &format!("{heading}.{}", row.key))] })
            }
            "list of tables" => json!({ "type": "array", "items": table(tables, &format!("{heading}.{}", row.key)) }),
            kind => typed(kind),
        };
        let default = if row.default.is_empty() { String::new() } else { format!(" (default: {})", row.default) };
        value["description"] = format!("{}: {}{default}", row.kind, row.meaning).into();
        (row.key.to_string(), value)
    };
    let rows = || tables.get(heading).into_iter().flatten();
    let mut object = closed(rows().map(value).collect());
    let (single, choices): (Vec<_>, Vec<_>) = needed(rows()).into_iter().partition(|keys| keys.len() == 1);
    object["required"] = single.concat().into();
    if !choices.is_empty() {
        object["allOf"] = choices.iter().map(|keys| one_of(keys)).collect();
    }
    object
}

/// The keys of which exactly one must be given, whatever else is; what depends on other keys the meaning of a key tells.
fn needed<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Vec<&'static str>> {
    let depends = |row: &Row| {
        let of_some = row.meaning.starts_with("`\"") && !row.kind.starts_with('`');
        of_some || row.meaning.contains("not of") || row.meaning.starts_with("of a tool")
    };
    let mut needed: Vec<Vec<&'static str>> = Vec::new();
    for row in rows.filter(|row| row.is_needed && !depends(row)) {
        match needed.last_mut().filter(|_| row.meaning.starts_with("in its place")) {
            Some(others) => others.push(row.key),
            None => needed.push(vec![row.key]),
        }
    }
    needed
}

fn one_of(keys: &[&str]) -> Value {
    let required: Vec<Value> = keys.iter().map(|key| json!({ "required": [key] })).collect();
    json!({ "oneOf": required })
}

/// The type of a value; of what has several forms, nothing is said.
fn typed(kind: &str) -> Value {
    let words: Vec<&str> =
        kind.split('`').skip(1).step_by(2).filter_map(|code| code.strip_prefix('"')?.strip_suffix('"')).collect();
    let number = || json!({ "type": "number" });
    let list_of = |items: Value| json!({ "type": "array", "items": items });
    let numbers = |list: &str, kind| {
        let count = list.split(',').count();
        json!({ "type": "array", "items": { "type": kind }, "minItems": count, "maxItems": count })
    };
    if let Some(list) = kind.strip_prefix("`[") {
        let (list, _) = list.split_once(']').unwrap_or((list, ""));
        return match list.strip_prefix('[') {
            Some(pair) => list_of(numbers(pair, "number")),
            None => numbers(list, if list.starts_with("n,") { "integer" } else { "number" }),
        };
    }
    let first = kind.split([',', ' ', '/']).next().unwrap_or_default();
    match first {
        _ if !words.is_empty() && kind.starts_with('`') => json!({ "enum": words }),
        _ if !words.is_empty() => json!({ "anyOf": [number(), { "enum": words }] }),
        _ if kind.contains("or a ") => json!({}),
        _ if kind.starts_with("list of ") => list_of(json!({ "type": "string" })),
        _ if kind == "table of names" => {
            let name = || json!({ "type": "string" });
            json!({ "type": "object", "additionalProperties": { "anyOf": [name(), list_of(name())] } })
        }
        "number" | "length" | "stress" | "time" | "degrees" | "force" => number(),
        "integer" => json!({ "type": "integer" }),
        "boolean" => json!({ "type": "boolean" }),
        "VECTOR" | "direction" => json!({ "type": "array", "items": number(), "minItems": 3, "maxItems": 3 }),
        "string" | "file" | "letters" | "NAME" | "SET" | "FACES" => json!({ "type": "string" }),
        "list" => json!({ "type": "array" }),
        _ => json!({}),
    }
}
