//! Whether a run of one scene may go on as that of another.

use super::tree::{Node, Value, inline, parse_document};
use super::{MeshSource, Scene};
use std::path::Path;

/// Tables that may be others: a name, what is written, what is tried.
const FREE: [&str; 3] = ["title", "output", "trade"];

impl Scene {
    /// The files of its bodies and tools.
    pub fn files(&self) -> Vec<&Path> {
        let bodies = self.bodies.iter().filter_map(|body| file_of(&body.mesh));
        let meshes = self.tools.iter().filter_map(|tool| file_of(&tool.mesh.as_ref()?.source));
        let cad = self.tools.iter().flat_map(|tool| [&tool.nurbs, &tool.bezier]).flatten();
        bodies.chain(meshes).chain(cad.map(|file| file.path.value.as_path())).collect()
    }

    /// Why this scene is not that of an earlier run, with its `text`, with steps added at most; `None` if it is. What is
    /// written may be another.
    pub fn differs_from(&self, text: &str) -> Option<String> {
        let [before, now] = [text, &self.text].map(|text| parse_document("the scene", text));
        match (before, now) {
            (Ok(before), Ok(now)) => difference("", &before, &now),
            _ => Some("the scene of the checkpoint cannot be read".into()),
        }
    }
}

fn file_of(source: &MeshSource) -> Option<&Path> {
    match source {
        MeshSource::File { path, .. } => Some(&path.value),
        MeshSource::Block(_) => None,
    }
}

/// The first entry at `path` or below that is another, in words.
fn difference(path: &str, before: &Node, now: &Node) -> Option<String> {
    match (&before.value, &now.value) {
        (Value::Table(old), Value::Table(new)) => {
            let counts = |key: &str| !path.is_empty() || !FREE.contains(&key);
            let gone = old.iter().filter(|entry| counts(&entry.key)).find_map(|entry| match now.get(&entry.key) {
                Some(node) => difference(&join(path, &entry.key), &entry.node, node),
                None => Some(format!("`{}` is missing", join(path, &entry.key))),
            });
            let added = new.iter().find(|entry| counts(&entry.key) && before.get(&entry.key).is_none());
            gone.or_else(|| added.map(|entry| format!("`{}` is new", join(path, &entry.key))))
        }
        (Value::List(old), Value::List(new)) => {
            let each = old.iter().zip(new).enumerate();
            let name =
                |(k, node): (usize, &Node)| join(path, node.name().map_or(k.to_string(), str::to_string).as_str());
            let other = each.clone().find_map(|(k, (old, new))| difference(&name((k, old)), old, new));
            let steps = path == "step" && new.len() >= old.len();
            let as_many = || format!("`{path}` has {} entries, and had {}", new.len(), old.len());
            other.or_else(|| (new.len() != old.len() && !steps).then(as_many))
        }
        (Value::Leaf(old), Value::Leaf(new)) if old == new || is_same_number(old, new) => None,
        (Value::Leaf(old), Value::Leaf(new)) if names_file(path) && is_same_file(old, new) => None,
        _ => Some(format!("`{path}` is {}, and was {}", inline(now), inline(before))),
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_string() } else { format!("{path}.{key}") }
}

/// Whether a key names a file of a body or a tool.
fn names_file(path: &str) -> bool {
    let (table, key) = path.split_once('.').zip(path.rsplit_once('.')).map_or(("", ""), |(a, b)| (a.0, b.1));
    matches!(table, "body" | "tool") && matches!(key, "mesh" | "nurbs" | "bezier")
}

/// The same name in whatever folder: what the files hold is compared by itself.
fn is_same_file(a: &toml::Value, b: &toml::Value) -> bool {
    let name = |value: &toml::Value| value.as_str().and_then(|path| Some(Path::new(path).file_name()?.to_owned()));
    name(a).zip(name(b)).is_some_and(|(a, b)| a == b)
}

/// 1 is 1.0.
fn is_same_number(a: &toml::Value, b: &toml::Value) -> bool {
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|n| n as f64));
    number(a).zip(number(b)).is_some_and(|(a, b)| a == b)
}
