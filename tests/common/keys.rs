//! The keys of a scene, as docs/scene.md lists them; tests/documents.rs holds these against the reader.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A key as docs/scene.md has it: whether it must be given, and the words it may be.
pub struct Row {
    pub must: bool,
    pub words: BTreeSet<String>,
    pub is_table: bool,
}

/// The tables of keys of docs/scene.md under their headings.
pub fn described() -> BTreeMap<String, BTreeMap<String, Row>> {
    let document = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene.md")).unwrap();
    let (mut tables, mut heading) = (BTreeMap::<String, BTreeMap<String, Row>>::new(), None);
    for line in document.lines() {
        if line.starts_with('#') {
            heading = line.split('`').nth(1).map(str::to_string);
        }
        let (Some(heading), Some(row)) = (&heading, line.strip_prefix("| `")) else { continue };
        let cells: Vec<&str> = row.split(" |").collect();
        assert_eq!(cells.len(), 5, "four columns: {line}");
        let (key, must) = cells[0].split_once('`').unwrap();
        let words = cells[1].split('`').skip(1).step_by(2).filter_map(|code| code.strip_prefix('"')?.strip_suffix('"'));
        let row = Row {
            must: must.trim() == "*",
            words: words.map(str::to_string).collect(),
            is_table: matches!(cells[1].trim(), "table" | "list of tables" | "VECTOR or table"),
        };
        let repeated = tables.entry(heading.clone()).or_default().insert(key.to_string(), row);
        assert!(repeated.is_none(), "`{key}` stands twice in {heading}");
    }
    tables
}
