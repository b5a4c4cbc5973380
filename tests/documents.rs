//! The documents against the program: docs/scene.md has the keys that the reader accepts, no more and no fewer; links
//! point to what exists; scenes that the documents show or name can be run.

mod common;

use common::keys::{Row, described};
use common::nagata;
use nagata::scene::parse;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text_of(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// README.md and all documents, relative to the root.
fn documents() -> Vec<PathBuf> {
    let mut found = vec![PathBuf::from("README.md")];
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            match path.extension() {
                _ if root().join(&path).is_dir() => folders.push(path),
                Some(end) if end == "md" => found.push(path),
                _ => {}
            }
        }
    }
    found.sort();
    found
}

/// A scene with all tables that the reader knows, to which the keys that are asked about are added.
const BASE: &str = r#"
[body.m]
mesh = "m.msh"
material = "e"
[body.b]
material = "e"
block = { box = { size = [1, 1, 1] }, elements = [1, 1, 1] }
[material.e]
model = "neo-hookean"
density = 1
young = 1
poisson = 0.3
[material.h]
model = "hill"
young = 1
poisson = 0.3
yield_stress = 1
hill = { f = 0.5, g = 0.5, h = 0.5, n = 1.5 }
[tool.t]
mesh = "t.msh"
nurbs = "t.igs"
[tool.u]
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[contact.t]
slave = "b.a"
master = "t"
method = "uzawa"
[contact.p]
slave = "b.a"
master = "m.a"
[contact.s]
slave = "b.a"
master = "b.a"
[tie.j]
slave = "b.a"
master = "m.a"
[[step]]
name = "s"
increments = 1
fix = [{ set = "b" }]
move = [{ target = "t", by = [0, 0, 0] }, { target = "b.a", by = [0, 0, 0] }]
force = [{ target = "m", total = [0, 0, 0] }]
pressure = [{ set = "b.a", value = 0 }]
body_force = [{ body = "b", per_volume = [0, 0, 0] }]
spin = [{ body = "b", point = [0, 0, 0], axis = [0, 0, 1], speed = 1 }]
spring = [{ set = "b.a", stiffness = [0, 0, 1] }]
duration = 1
dashpot = [{ set = "b.a", damping = [0, 0, 1] }]
torque = [{ tool = "u", total = 1, point = [0, 0, 0], axis = [0, 0, 1] }]
"#;

/// Tables of the schema, as the headings of docs/scene.md call them, with places in the base scene where their keys can be
/// asked for, and overrides that clear the way.
const PLACES: &[(&str, &str, &[&str])] = &[
    ("body.NAME", "body.m", &[]),
    ("body.NAME", "body.b", &[]),
    ("body.NAME.shell", "body.b.shell", &["body.b.shell={}"]),
    ("body.NAME.block", "body.b.block", &["body.b.block={ elements = [1, 1, 1] }"]),
    ("body.NAME.block", "body.b.block", &[]),
    ("body.NAME.block.box", "body.b.block.box", &[]),
    ("body.NAME.block.sector", "body.b.block.sector", &[SECTOR]),
    ("material.NAME", "material.h", &[]),
    ("material.NAME", "material.h", &[MOONEY]),
    ("material.NAME", "material.h", &["material.h={ model = \"yeoh\", c10 = 1, bulk = 9 }"]),
    ("material.NAME", "material.h", &["material.h={ model = \"ogden\", terms = [[1, 2]], bulk = 9 }"]),
    ("material.NAME", "material.h", &[WOOD]),
    ("material.NAME.orthotropic", "material.h.orthotropic", &[WOOD]),
    ("material.NAME.hardening", "material.h.hardening", &["material.h.hardening={}"]),
    (
        "material.NAME.hardening",
        "material.h.hardening",
        &["material.h={ model = \"j2\", young = 1, poisson = 0.3 }", "material.h.hardening={}"],
    ),
    ("material.NAME.hardening.swift", "material.h.hardening.swift", &[SWIFT, "material.h.yield_stress=1"]),
    (
        "material.NAME.hardening.swift",
        "material.h.hardening.swift",
        &[SWIFT, "material.h={ model = \"j2\", young = 1, poisson = 0.3 }", SWIFT],
    ),
    ("material.NAME.hardening.voce", "material.h.hardening.voce", &[VOCE]),
    ("material.NAME.hill", "material.h.hill", &[]),
    ("tool.NAME", "tool.t", &[]),
    ("tool.NAME.plane", "tool.t.plane", &["tool.t.plane={ point = [0, 0, 0], normal = [0, 0, 1] }"]),
    ("tool.NAME.cylinder", "tool.t.cylinder", &["tool.t.cylinder={ point = [0, 0, 0], axis = [0, 0, 1], radius = 1 }"]),
    ("tool.NAME.cone", "tool.t.cone", &["tool.t.cone={ apex = [0, 0, 0], axis = [0, 0, 1], angle = 1 }"]),
    ("tool.NAME.sphere", "tool.t.sphere", &["tool.t.sphere={ center = [0, 0, 0], radius = 1 }"]),
    (
        "tool.NAME.torus",
        "tool.t.torus",
        &["tool.t.torus={ center = [0, 0, 0], axis = [0, 0, 1], radius = 2, tube = 1 }"],
    ),
    ("tool.NAME.profile", "tool.t.profile", &["tool.t.profile={ points = [[0, 1], [0, 0], [1, 0]] }"]),
    (
        "tool.NAME.profile.extrude",
        "tool.t.profile.extrude",
        &["tool.t.profile={ points = [[0, 1], [0, 0], [1, 0]], extrude = {} }"],
    ),
    (
        "tool.NAME.profile.revolve",
        "tool.t.profile.revolve",
        &[
            "tool.t.profile={ points = [[0, 1], [0, 0], [1, 0]] }",
            "tool.t.profile.revolve={ point = [0, 0, 0], axis = [0, 0, 1] }",
        ],
    ),
    ("tool.NAME.symmetry", "tool.t.symmetry.0", &["tool.t.symmetry=[{ point = [0, 0, 0], normal = [0, 0, 1] }]"]),
    ("contact.NAME", "contact.t", &[]),
    ("contact.NAME", "contact.p", &[]),
    ("contact.NAME", "contact.s", &[]),
    ("tie.NAME", "tie.j", &[]),
    ("step", "step.s", &[]),
    ("step", "step.0", &["step=[{}]"]),
    ("step.increment", "step.0.increment", &["step=[{ increment = {} }]"]),
    ("step.fix", "step.s.fix.0", &[]),
    ("step.fix.around", "step.s.fix.0.around", &["step.s.fix.0.around={ point = [0, 0, 0], axis = [0, 0, 1] }"]),
    ("step.move", "step.s.move.0", &[]),
    ("step.move", "step.s.move.1", &[]),
    ("step.move.around", "step.s.move.1.around", &["step.s.move.1.around={ point = [0, 0, 0], axis = [0, 0, 1] }"]),
    (
        "step.move.rotate",
        "step.s.move.0.rotate",
        &["step.s.move.0.rotate={ point = [0, 0, 0], axis = [0, 0, 1], angle = 1 }"],
    ),
    ("step.force", "step.s.force.0", &[]),
    ("step.force", "step.s.force.0", &["step.s.force.0.target=t"]),
    ("step.pressure", "step.s.pressure.0", &[]),
    ("step.body_force", "step.s.body_force.0", &[]),
    ("step.spin", "step.s.spin.0", &[]),
    ("step.spring", "step.s.spring.0", &[]),
    ("step.dashpot", "step.s.dashpot.0", &[]),
    ("step.torque", "step.s.torque.0", &[]),
    ("step.gravity", "step.s.gravity", &["step.s.gravity={ acceleration = [0, 0, -1] }"]),
    ("output", "output", &["output={}"]),
    ("output.probe", "output.probe.p", &["output={ probe = [{ name = \"p\", point = [0, 0, 0] }] }"]),
    (
        "output.probe.path",
        "output.probe.p.path",
        &["output={ probe = [{ name = \"p\", path = { from = [0, 0, 0], to = [1, 0, 0] } }] }"],
    ),
    ("output.checkpoint", "output.checkpoint", &["output.checkpoint={}"]),
    ("solver", "solver", &["solver={}"]),
    ("trade", "trade", &["trade={}"]),
    ("trade.vary", "trade.vary.0", &["trade.vary=[{}]"]),
    ("trade.exact", "trade.exact.0", &["trade.exact=[{}]"]),
];

const MOONEY: &str = "material.h={ model = \"mooney-rivlin\", c10 = 1, c01 = 1, bulk = 9 }";
const WOOD: &str = "material.h={ model = \"orthotropic\", orthotropic = { e1 = 1, e2 = 1, e3 = 1, nu12 = 0, nu13 = 0, \
                    nu23 = 0, g12 = 1, g13 = 1, g23 = 1 } }";
const SECTOR: &str = "body.b.block={ sector = { radii = [1, 2], angles = [0, 90], length = 1 }, elements = [1, 1, 1] }";
const SWIFT: &str = "material.h.hardening={ swift = { k = 1, n = 1 } }";
const VOCE: &str = "material.h.hardening={ voce = { saturation = 2, rate = 1 } }";

/// What the reader says to the base scene with these overrides; empty when it accepts it.
fn said(overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    parse("base.toml", BASE, Path::new(""), &overrides).map(|_| String::new()).unwrap_or_else(|error| error.to_string())
}

/// What it says when `place.key` is `value`.
fn answer(place: &str, way: &[&str], key: &str, value: &str) -> String {
    let ask = format!("{place}.{key}={value}");
    said(&[way, &[ask.as_str()]].concat())
}

/// The words behind "known: " in a help.
fn known(text: &str) -> BTreeSet<String> {
    let list = text.split("known: ").nth(1).and_then(|list| list.lines().next());
    let list = list.unwrap_or_else(|| panic!("lists nothing: {text}"));
    assert!(!list.contains(" more"), "the list is cut short, ask for it in two parts: {text}");
    list.trim_end_matches([')', '\n']).split(", ").map(str::to_string).collect()
}

/// The keys that the reader accepts, by table: asked for with one that it does not.
fn accepted() -> BTreeMap<String, BTreeSet<String>> {
    let mut tables = BTreeMap::new();
    for (table, place, way) in PLACES {
        let text = answer(place, way, "zz9", "1");
        assert!(text.contains("unknown key `zz9`"), "{place}: {text}");
        let keys = known(&text);
        assert_eq!(tables.entry(table.to_string()).or_insert(keys.clone()), &keys, "{place}");
    }
    tables
}

#[test]
fn the_scene_document_has_the_keys_that_the_reader_accepts() {
    assert_eq!(said(&[]), "", "the base scene must be right but for what is asked");
    let (described, accepted) = (described(), accepted());
    let sorted = |table: &BTreeMap<String, Row>| table.keys().cloned().collect::<BTreeSet<_>>();
    for (table, keys) in &accepted {
        let in_document = described.get(table).map(sorted).unwrap_or_default();
        let missing: Vec<_> = keys.difference(&in_document).collect();
        let invented: Vec<_> = in_document.difference(keys).collect();
        assert!(missing.is_empty(), "docs/scene.md, `{table}`: the reader accepts {missing:?}");
        assert!(invented.is_empty(), "docs/scene.md, `{table}`: the reader does not know {invented:?}");
    }
    let headings: BTreeSet<_> = described.keys().collect();
    assert_eq!(headings, accepted.keys().collect(), "tables described and tables that can be asked");
    // The tables at the top.
    let text = said(&["zz9=1"]);
    let top: BTreeSet<String> = known(&text);
    let mut heads: BTreeSet<String> =
        headings.iter().map(|table| table.split('.').next().unwrap().to_string()).collect();
    heads.insert("title".into());
    // A table may have a document of its own, which is named.
    let text = text_of(&root().join("docs/scene.md"));
    heads.extend(top.iter().filter(|table| text.contains(&format!("`docs/{table}.md`"))).cloned());
    assert_eq!(heads, top);
}

/// Every key is asked with a table, a list of tables, and a word. So no table inside another is left out of the document,
/// and neither is a word that may be chosen.
#[test]
fn the_scene_document_has_the_tables_and_words_that_the_reader_accepts() {
    let described = described();
    for (table, keys) in &described {
        for (key, row) in keys {
            let places = || PLACES.iter().filter(|(name, ..)| name == table);
            let asked = |value: &str| -> Vec<String> {
                places().map(|(_, place, way)| answer(place, way, key, value)).collect()
            };
            let [one, list, three] =
                ["{ zz9 = 1 }", "[{ zz9 = 1 }]", "[{ zz9 = 1 }, { zz9 = 1 }, { zz9 = 1 }]"].map(asked);
            let list = [list, three].concat(); // some lists are as long as others
            let has_keys = |answers: &[String]| answers.iter().any(|text| text.contains("unknown key `zz9`"));
            let refused = |answers: &[String]| answers.iter().any(|text| text.contains(" must be "));
            let is_table = has_keys(&one) || has_keys(&list);
            assert!(is_table || (refused(&one) && refused(&list)), "{table}.{key} cannot be asked: {one:#?} {list:#?}");
            assert_eq!(is_table, row.is_table, "{table}.{key} has a table for its value");
            let inner = format!("{table}.{key}");
            assert!(!is_table || described.contains_key(&inner), "docs/scene.md has no section `{inner}`");
            if is_table {
                continue;
            }
            let words = asked("\"zz9\"");
            let choices = words.iter().find(|text| text.contains("cannot be \"zz9\"")).map(|text| known(text));
            assert_eq!(row.words, choices.unwrap_or_default(), "words of {table}.{key}");
        }
    }
}

/// What must be given: without it the reader says that the table has none.
#[test]
fn the_scene_document_marks_what_must_be_given() {
    /// Tables that are right, in the places where they are read; of keys of which one must be given the one that the
    /// reader asks for.
    const RIGHT: &[(&str, &str, &str)] = &[
        ("body.NAME", "body.m", "mesh = 'm.msh', material = 'e'"),
        ("body.NAME.block", "body.b.block", "box = { size = [1, 1, 1] }, elements = [1, 1, 1]"),
        ("body.NAME.block.box", "body.b.block.box", "size = [1, 1, 1]"),
        ("body.NAME.block.sector", "body.b.block.sector", "radii = [1, 2], angles = [0, 90], length = 1"),
        (
            "material.NAME",
            "material.h",
            "model = 'hill', young = 1, poisson = 0.3, yield_stress = 1, hill = { f = 1, g = 1, h = 1, n = 1 }",
        ),
        (
            "material.NAME.orthotropic",
            "material.h.orthotropic",
            "e1 = 1, e2 = 1, e3 = 1, nu12 = 0, nu13 = 0, nu23 = 0, g12 = 1, g13 = 1, g23 = 1",
        ),
        ("material.NAME.hardening.swift", "material.h.hardening.swift", "k = 1, n = 1"),
        ("material.NAME.hardening.voce", "material.h.hardening.voce", "saturation = 2, rate = 1"),
        ("material.NAME.hill", "material.h.hill", "f = 1, g = 1, h = 1, n = 1"),
        ("tool.NAME.plane", "tool.t.plane", "point = [0, 0, 0], normal = [0, 0, 1]"),
        ("tool.NAME.cylinder", "tool.t.cylinder", "point = [0, 0, 0], axis = [0, 0, 1], radius = 1"),
        ("tool.NAME.cone", "tool.t.cone", "apex = [0, 0, 0], axis = [0, 0, 1], angle = 1"),
        ("tool.NAME.sphere", "tool.t.sphere", "center = [0, 0, 0], radius = 1"),
        ("tool.NAME.torus", "tool.t.torus", "center = [0, 0, 0], axis = [0, 0, 1], radius = 2, tube = 1"),
        ("tool.NAME.profile", "tool.t.profile", "points = [[0, 1], [0, 0], [1, 0]]"),
        ("tool.NAME.profile.revolve", "tool.t.profile.revolve", "point = [0, 0, 0], axis = [0, 0, 1]"),
        ("tool.NAME.symmetry", "tool.t.symmetry.0", "point = [0, 0, 0], normal = [0, 0, 1]"),
        ("contact.NAME", "contact.t", "slave = 'b.a', master = 't'"),
        ("tie.NAME", "tie.j", "slave = 'b.a', master = 'm.a'"),
        ("step", "step.0", "increments = 1"),
        ("step.fix", "step.s.fix.0", "set = 'b'"),
        ("step.fix.around", "step.s.fix.0.around", "point = [0, 0, 0], axis = [0, 0, 1]"),
        ("step.move", "step.s.move.0", "target = 't', by = [0, 0, 0]"),
        ("step.move.around", "step.s.move.1.around", "point = [0, 0, 0], axis = [0, 0, 1]"),
        ("step.move.rotate", "step.s.move.0.rotate", "point = [0, 0, 0], axis = [0, 0, 1], angle = 1"),
        ("step.force", "step.s.force.0", "target = 't', total = [0, 0, 0], directions = 'x'"),
        ("step.pressure", "step.s.pressure.0", "set = 'b.a', value = 0"),
        ("step.body_force", "step.s.body_force.0", "body = 'b', per_volume = [0, 0, 0]"),
        ("step.spin", "step.s.spin.0", "body = 'b', point = [0, 0, 0], axis = [0, 0, 1], speed = 1"),
        ("step.spring", "step.s.spring.0", "set = 'b.a', stiffness = [0, 0, 1]"),
        ("step.dashpot", "step.s.dashpot.0", "set = 'b.a', damping = [0, 0, 1]"),
        ("step.torque", "step.s.torque.0", "tool = 'u', total = 1, point = [0, 0, 0], axis = [0, 0, 1]"),
        ("step.gravity", "step.s.gravity", "acceleration = [0, 0, -1]"),
        ("output.probe", "output.probe.p", "name = 'p', point = [0, 0, 0]"),
        ("output.probe.path", "output.probe.p.path", "from = [0, 0, 0], to = [1, 0, 0]"),
        ("trade.exact", "trade.exact.0", "of = 't.fx', value = 1"),
    ];
    // Keys in the place of others.
    let instead =
        BTreeMap::from([("block", "mesh"), ("sector", "box"), ("increment", "increments"), ("orthotropic", "hill")]);
    for (table, keys) in described() {
        let marked: BTreeSet<&str> = keys.iter().filter(|(_, row)| row.must).map(|(key, _)| key.as_str()).collect();
        let Some((_, place, entries)) = RIGHT.iter().find(|(name, ..)| *name == table) else {
            assert!(marked.is_empty(), "{table} has {marked:?}: no right table of it is known here");
            continue;
        };
        let (.., way) = PLACES.iter().find(|(name, ..)| *name == table).unwrap();
        let all = entries_of(entries);
        for (left_out, _) in &all {
            let kept: Vec<String> =
                all.iter().filter(|(key, _)| key != left_out).map(|(key, value)| format!("{key} = {value}")).collect();
            let text = said(&[*way, &[format!("{place}={{ {} }}", kept.join(", ")).as_str()]].concat());
            let missed = [" has no ", "must have one of", "does not say how"].iter().any(|word| text.contains(word));
            let of_one = table == "step.move" && left_out == "by";
            assert_eq!(missed, marked.contains(left_out.as_str()) || of_one, "{table}.{left_out}: {text}");
        }
        let given: BTreeSet<&str> = all.iter().map(|(key, _)| key.as_str()).collect();
        let lonely: Vec<_> = marked.iter().filter(|key| !given.contains(instead.get(*key).unwrap_or(key))).collect();
        assert!(lonely.is_empty(), "{table} does not miss {lonely:?}");
    }
}

/// The entries of the inside of an inline table.
fn entries_of(text: &str) -> Vec<(String, String)> {
    let table: toml::Table = format!("all = {{ {text} }}").parse().unwrap();
    let all = table["all"].as_table().unwrap();
    all.iter().map(|(key, value)| (key.clone(), value.to_string())).collect()
}

#[test]
fn links_of_the_documents_point_to_what_exists() {
    let (mut count, mut stale) = (0, Vec::new());
    for document in documents() {
        let text = text_of(&root().join(&document));
        let folder = root().join(&document).parent().unwrap().to_path_buf();
        for target in links(&text).into_iter().filter(|target| !target.contains("://")) {
            count += 1;
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() { root().join(&document) } else { folder.join(path) };
            if !file.exists() || (!anchor.is_empty() && !anchors(&text_of(&file)).contains(anchor)) {
                stale.push(format!("{}: {target}", document.display()));
            }
        }
        assert_eq!(text.lines().filter(|line| line.starts_with("```")).count() % 2, 0, "{}", document.display());
    }
    assert!(stale.is_empty(), "links that point to nothing: {stale:#?}");
    assert!(count > 100, "{count} links");
}

/// The targets of the links and pictures of a text, outside of its code blocks.
fn links(text: &str) -> Vec<&str> {
    let (mut found, mut in_code) = (Vec::new(), false);
    for line in text.lines() {
        in_code ^= line.starts_with("```");
        if in_code || line.starts_with("    ") {
            continue;
        }
        found.extend(line.split("](").skip(1).filter_map(|rest| rest.split(')').next()));
    }
    found
}

/// What the headings of a text are linked by.
fn anchors(text: &str) -> BTreeSet<String> {
    let letter = |c: char| match c {
        ' ' => Some('-'),
        _ if c.is_alphanumeric() || "-_".contains(c) => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    let mut in_code = false;
    let mut heading = |line: &&str| {
        in_code ^= line.starts_with("```");
        !in_code && line.starts_with('#')
    };
    text.lines()
        .filter(|line| heading(line))
        .map(|line| line.trim_start_matches('#').trim().chars().filter_map(letter).collect())
        .collect()
}

/// All pictures are shown somewhere.
#[test]
fn pictures_of_the_documents_are_shown() {
    let documents = documents();
    let mut shown = BTreeSet::new();
    for document in &documents {
        let folder = root().join(document).parent().unwrap().to_path_buf();
        let text = text_of(&root().join(document));
        shown.extend(links(&text).iter().filter_map(|link| folder.join(link).canonicalize().ok()));
    }
    let folders: BTreeSet<PathBuf> = documents.iter().map(|d| root().join(d).parent().unwrap().to_path_buf()).collect();
    for folder in folders.iter().filter(|folder| folder.starts_with(root().join("docs"))) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|end| end == "png") {
                assert!(shown.contains(&path.canonicalize().unwrap()), "{} is shown nowhere", path.display());
            }
        }
    }
}

/// What docs/trouble.md quotes stands in the sources, but for `...` and capital letters in the place of names and numbers.
#[test]
fn messages_of_the_documents_are_those_of_the_program() {
    let mut sources = String::new();
    let mut folders = vec![root().join("src"), root().join("ffi/src")];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") {
                sources += &text_of(&path);
            }
        }
    }
    // Strings that go on in the next line.
    let pieces: Vec<&str> = sources.split("\\\n").collect();
    let sources = pieces.iter().enumerate().map(|(k, piece)| if k == 0 { piece } else { piece.trim_start() });
    let sources = sources.collect::<String>();
    let (mut quotes, mut strange, mut is_quoted) = (0, Vec::new(), false);
    let text = text_of(&root().join("docs/trouble.md"));
    for line in text.lines() {
        let first = line.split('|').nth(1).unwrap_or_default();
        if matches!(first.trim(), "the log says" | "message" | "warning" | "") {
            is_quoted = !first.is_empty();
        }
        for quote in first.split('`').skip(1).step_by(2).filter(|_| is_quoted) {
            quotes += 1;
            let place = |word: &&str| *word == "..." || word.len() == 1 && word.starts_with(|c: char| c.is_uppercase());
            let words: Vec<&str> = quote.split(' ').collect();
            let parts = words.split(|word| place(&word.trim_end_matches([',', ':']))).map(|part| part.join(" "));
            strange.extend(parts.filter(|part| !sources.contains(part)).map(|part| format!("{quote}: {part}")));
        }
    }
    assert!(strange.is_empty(), "docs/trouble.md quotes what no source has: {strange:#?}");
    assert!(quotes > 60, "{quotes} quotes");
}

/// Whole scenes begin with their title. Those of the tutorial stand in files, and the documents show the same.
#[test]
fn scenes_of_the_documents_can_be_run() {
    let scratch = tempfile::tempdir().unwrap();
    let files: Vec<PathBuf> = fs::read_dir(root().join("docs/tutorial"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    let texts: Vec<String> = files.iter().map(|path| text_of(path)).collect();
    let mut scenes = files.clone();
    for document in documents() {
        let shown = text_of(&root().join(&document));
        for (k, block) in shown.split("\n```toml\n").skip(1).enumerate() {
            let block = format!("{}\n", block.split("\n```").next().unwrap());
            if block.starts_with("title = ") && !texts.contains(&block) {
                assert!(!document.ends_with("tutorial.md"), "no file of docs/tutorial/ is as shown:\n{block}");
                let path = scratch.path().join(format!("{}-{k}.toml", document.file_stem().unwrap().display()));
                fs::write(&path, block).unwrap();
                scenes.push(path);
            }
        }
    }
    assert!(scenes.len() > files.len() && files.len() >= 4, "{scenes:?}");
    for scene in &scenes {
        let run = nagata(root(), 1, &["check", scene.to_str().unwrap()], scratch.path().into());
        assert_eq!(run.code, 0, "{}: {}", scene.display(), run.stderr);
        assert!(run.stdout.contains("dofs"), "{}", run.stdout);
    }
}

/// Whether a value is as a schema says; the place and the reason if it is not.
fn fits(schema: &Value, value: &Value, at: &str) -> Result<(), String> {
    let wrong = |what: &str| Err(format!("{at}: {what}: {value}"));
    if let Some(choices) = schema["anyOf"].as_array() {
        return if choices.iter().any(|s| fits(s, value, at).is_ok()) { Ok(()) } else { wrong("none of its forms") };
    }
    if schema["enum"].as_array().is_some_and(|words| !words.contains(value)) {
        return wrong("no such word");
    }
    match schema["type"].as_str() {
        Some("number") if !value.is_number() => return wrong("no number"),
        Some("integer") if !value.is_i64() => return wrong("no integer"),
        Some("boolean") if !value.is_boolean() => return wrong("no boolean"),
        Some("string") if !value.is_string() => return wrong("no string"),
        Some("array") if !value.is_array() => return wrong("no list"),
        Some("object") if !value.is_object() => return wrong("no table"),
        _ => {}
    }
    let has = value.as_array().map_or(0, Vec::len) as u64;
    if value.is_array()
        && (schema["minItems"].as_u64() > Some(has) || schema["maxItems"].as_u64().is_some_and(|n| n < has))
    {
        return wrong("not so many");
    }
    for (k, item) in value.as_array().into_iter().flatten().enumerate() {
        fits(&schema["items"], item, &format!("{at}.{k}"))?;
    }
    for (key, inner) in value.as_object().into_iter().flatten() {
        let (own, others) = (&schema["properties"][key], &schema["additionalProperties"]);
        let of_key = if own.is_null() { others } else { own };
        if *of_key == Value::Bool(false) {
            return Err(format!("{at}: no key {key}"));
        }
        fits(of_key, inner, &format!("{at}.{key}"))?;
    }
    let Some(table) = value.as_object() else {
        let [least, most] = ["minimum", "maximum"].map(|key| schema[key].as_f64());
        let is_out = |x: f64| least.is_some_and(|least| x < least) || most.is_some_and(|most| x > most);
        return if value.as_f64().is_some_and(is_out) { wrong("out of its range") } else { Ok(()) };
    };
    let lacks = |schema: &Value| {
        let mut needed = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        needed.find(|key| !table.contains_key(*key)).map(String::from)
    };
    if let Some(key) = lacks(schema) {
        return Err(format!("{at}: lacks {key}"));
    }
    for choice in schema["allOf"].as_array().into_iter().flatten() {
        let given = choice["oneOf"].as_array().unwrap().iter().filter(|keys| lacks(keys).is_none()).count();
        if given != 1 {
            return Err(format!("{at}: {given} of {choice}"));
        }
    }
    Ok(())
}

/// Editors accept what the reader accepts; and what it begins with runs.
#[test]
fn the_schema_takes_all_scenes() {
    let scratch = tempfile::tempdir().unwrap();
    let begin = || nagata(scratch.path(), 1, &["new", "mine.toml"], scratch.path().into());
    assert_eq!(begin().code, 0);
    let again = begin();
    assert!(again.code == 2 && again.stderr.contains("cannot write mine.toml"), "{}", again.stderr);
    let run = nagata(scratch.path(), 1, &["run", "mine.toml", "--quiet"], scratch.path().into());
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));

    let printed = nagata(root(), 1, &["schema"], scratch.path().into());
    let schema: Value = serde_json::from_str(&printed.stdout).unwrap();
    let json = |path: &Path| serde_json::to_value(text_of(path).parse::<toml::Table>().unwrap()).unwrap();
    let mut scenes = vec![scratch.path().join("mine.toml")];
    for folder in ["inputs", "docs/tutorial"] {
        let files = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        scenes.extend(files.filter(|path| path.extension().is_some_and(|end| end == "toml")));
    }
    assert!(scenes.len() > 10);
    for path in &scenes {
        fits(&schema, &json(path), &path.display().to_string()).unwrap();
    }
    let scene = json(&scenes[0]);
    for (place, value, word) in [
        ("/material/rubber/young", Value::from("soft"), "no number"),
        ("/material/rubber/model", "rubber".into(), "no such word"),
        ("/step/0/fix/0/set", 1.into(), "no string"),
        ("/step/0", serde_json::json!({ "gravity": { "accel": [0, 0, -1] } }), "none of its forms"),
        ("/output/probe/0", serde_json::json!({ "nam": "p" }), "no key nam"),
        ("/body/pad/block/box/size", 1.into(), "no list"),
        ("/body/pad/block/elements", serde_json::json!([1, 1]), "not so many"),
        ("/body/pad/block/elements", serde_json::json!([1, 1, 1.5]), "no integer"),
        ("/output", serde_json::json!({ "history": [1] }), "no string"),
        (
            "/body/pad",
            serde_json::json!({ "block": { "box": { "size": [1, 1, 1] }, "elements": [1, 1, 1] } }),
            "lacks material",
        ),
        ("/body/pad/block/box", serde_json::json!({}), "lacks size"),
        ("/body/pad", serde_json::json!({ "material": "rubber" }), "0 of"),
        ("/step/0", serde_json::json!({ "increments": 1, "increment": { "initial": 0.1 } }), "2 of"),
    ] {
        let mut changed = scene.clone();
        *changed.pointer_mut(place).unwrap() = value;
        assert!(fits(&schema, &changed, "").unwrap_err().contains(word), "{place}");
    }
}
