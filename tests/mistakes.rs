//! The likeliest mistakes of a new user: each is refused with its exit code and words that help, as docs/mistakes.md shows.

mod common;

use common::nagata;
use std::fs;
use std::path::Path;

#[test]
fn mistakes_are_told_with_what_would_be_right() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let list: toml::Table = fs::read_to_string(root.join("tests/mistakes.toml")).unwrap().parse().unwrap();
    let page = fs::read_to_string(root.join("docs/mistakes.md")).unwrap();
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path();
    let run = |arguments: &[&str]| nagata(folder, 1, arguments, folder.into());
    assert_eq!(run(&["new", "first.toml"]).code, 0);
    let scene = fs::read_to_string(folder.join("first.toml")).unwrap();

    let mistakes = list["mistake"].as_array().unwrap();
    assert!(mistakes.len() >= 20);
    for mistake in mistakes {
        let texts = |key: &str| -> Option<Vec<&str>> {
            Some(mistake.get(key)?.as_array()?.iter().map(|text| text.as_str().unwrap()).collect())
        };
        let [what, says] = ["what", "says"].map(|key| mistake[key].as_str().unwrap());
        let (old, new) = texts("change").map_or(("", ""), |pair| (pair[0], pair[1]));
        assert!(scene.contains(old), "{what}: `nagata new` does not write {old}");
        fs::write(folder.join("first.toml"), if old.is_empty() { scene.clone() } else { scene.replace(old, new) })
            .unwrap();
        if let Some(file) = texts("file") {
            fs::create_dir_all(folder.join(file[0]).parent().unwrap()).unwrap();
            fs::write(folder.join(file[0]), file[1]).unwrap();
        }
        let answer = run(&texts("arguments").unwrap_or_else(|| vec!["check", "first.toml"]));
        let code = mistake.get("code").map_or(2, |code| code.as_integer().unwrap());
        assert_eq!(i64::from(answer.code), code, "{what}: {}", answer.stderr);
        assert!(answer.stderr.contains(says), "{what}: {}", answer.stderr);
        assert!(page.contains(answer.stderr.trim_end()), "{what}: scripts/studies/mistakes.py writes the page anew");
        for left in fs::read_dir(folder).unwrap().map(|left| left.unwrap().path()) {
            let _ = if left.is_dir() { fs::remove_dir_all(left) } else { fs::remove_file(left) };
        }
    }
}
