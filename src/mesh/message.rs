//! Wording that the errors of meshes share.

use crate::error::{Error, Location};
use crate::scene::did_you_mean;
use std::collections::BTreeMap;
use std::fmt::Display;

/// An error about a file as a whole.
pub(crate) fn whole_file(source: &str, what: impl Into<String>, help: impl Into<String>) -> Error {
    Error::input(&Location { file: source.into(), line: 0, column: 0, text: "".into() }, what, help)
}

/// "node 3 is", "nodes 3, 7, 9 and 12 more are".
pub(crate) fn several<T: Display>(what: &str, ids: &[T]) -> String {
    match ids {
        [one] => format!("{what} {one} is"),
        _ => {
            let first: Vec<String> = ids.iter().take(3).map(T::to_string).collect();
            format!("{what}s {}{} are", first.join(", "), and_more(ids.len() - first.len()))
        }
    }
}

/// " and 12 more", or nothing.
pub(crate) fn and_more(count: usize) -> String {
    if count == 0 { String::new() } else { format!(" and {count} more") }
}

/// Help for a group `name` that is not among those of a mesh's `groups` which `fit`.
pub(crate) fn help_on_group<G>(name: &str, groups: &BTreeMap<String, G>, fits: impl Fn(&G) -> bool) -> String {
    match groups.is_empty() {
        true => "it has none; Gmsh writes none in format 2.2 with Mesh.SaveAll = 1".into(),
        false => did_you_mean(name, groups.iter().filter(|(_, group)| fits(group)).map(|(name, _)| name.as_str())),
    }
}

/// At most `limit` characters of raw text.
pub(crate) fn shorten(bytes: &[u8], limit: usize) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * limit)]);
    let clean = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    clean.take(limit).collect::<String>().trim_end().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_cut_short() {
        assert_eq!(several("node", &[4]), "node 4 is");
        assert_eq!(several("node", &[4, 5]), "nodes 4, 5 are");
        assert_eq!(several("node", &[4, 5, 6, 7, 8]), "nodes 4, 5, 6 and 2 more are");
    }

    #[test]
    fn groups_that_fit() {
        let groups = [("bottom", 0), ("top", 1)].map(|(name, facets)| (name.to_string(), facets)).into();
        assert_eq!(help_on_group("topp", &groups, |facets| *facets > 0), "did you mean `top`? (known: top)");
        assert!(help_on_group("topp", &BTreeMap::<String, usize>::new(), |_| true).starts_with("it has none; "));
    }
}
