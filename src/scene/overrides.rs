//! Overrides of scene entries from the command line: `--set a.b.c=value`.
//!
//! The key is dotted; an element of a list is named by its index from 0, or by its `name` if it has one (steps). The
//! value is TOML, or a bare string where it is not TOML. Tables on the way are made where they are missing, but for the
//! named tables (`body.NAME` ...), of which only a whole one can be added:
//! `--set 'material.steel={ model = "hooke", young = 210000.0, poisson = 0.3 }'`.
//! Whether a key means anything is for the reader of the schema to say; it finds the override as the place of the key.

use super::names::did_you_mean;
use super::tree::{Entry, Node, Value, parse_value};
use crate::error::{Error, Location, Result};

/// Tables whose entries are named by the user.
const NAMED: [&str; 5] = ["body", "material", "tool", "contact", "tie"];

/// Applies the override `a.b.c=value` to the tree.
pub(super) fn apply(root: &mut Node, text: &str) -> Result<()> {
    let at = Location { file: format!("--set {text}").into(), line: 0, column: 0, text: "".into() };
    let malformed =
        |what: &str| Error::input(&at, what, "write `--set key=value`, as in `--set contact.top.friction=0.2`");
    let (path, value) = text.split_once('=').ok_or_else(|| malformed("the override has no `=`"))?;
    let keys: Vec<&str> = path.split('.').map(str::trim).collect();
    if keys.contains(&"") {
        return Err(malformed("the override has an empty key"));
    }
    if value.trim().is_empty() {
        return Err(malformed("the override has no value"));
    }
    let value = parse_value(value.trim(), &at)?;
    let mut node = root;
    for depth in 0..keys.len() {
        node = child(node, &keys, depth, &at)?;
    }
    *node = value;
    Ok(())
}

/// The node under `keys[depth]`, made as an empty table if it is missing and may be made.
fn child<'a>(node: &'a mut Node, keys: &[&str], depth: usize, at: &Location) -> Result<&'a mut Node> {
    let (path, key) = (keys[..depth].join("."), keys[depth]);
    let unknown = |known: Vec<String>| {
        let known = known.iter().map(String::as_str);
        Error::input(at, format!("there is no `{key}` in {path}"), did_you_mean(key, known))
    };
    let kind = node.kind();
    match &mut node.value {
        Value::Leaf(_) => Err(Error::input(at, format!("{path} is {kind}, it has no `{key}`"), "set it as a whole")),
        Value::List(items) => {
            let by_name = items.iter().position(|item| item.name() == Some(key));
            match by_name.or_else(|| key.parse().ok().filter(|&index: &usize| index < items.len())) {
                Some(index) => Ok(&mut items[index]),
                None => Err(unknown(
                    (0..items.len()).map(|i| items[i].name().map_or(i.to_string(), str::to_string)).collect(),
                )),
            }
        }
        Value::Table(entries) => {
            let index = match entries.iter().position(|entry| entry.key == key) {
                Some(index) => index,
                None if NAMED.contains(&path.as_str()) && depth + 1 < keys.len() => {
                    return Err(unknown(entries.iter().map(|entry| entry.key.clone()).collect()));
                }
                None => {
                    let node = Node { value: Value::Table(Vec::new()), at: at.clone() };
                    entries.push(Entry { key: key.to_string(), key_at: at.clone(), node });
                    entries.len() - 1
                }
            };
            Ok(&mut entries[index].node)
        }
    }
}
