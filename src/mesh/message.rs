//! Wording that the errors of meshes share.

use crate::error::{Error, Location};
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

/// Help where a mesh has no groups at all.
pub const NO_GROUPS: &str = "it has none; Gmsh writes none in format 2.2 with Mesh.SaveAll = 1";

/// "did you mean 'top'? there is: bottom, top" for a name that is not among `names`.
pub(crate) fn near<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return "there is none".into();
    }
    let lower = name.to_lowercase();
    let likeness = |other: &str| strsim::jaro_winkler(&lower, &other.to_lowercase());
    let best = names.iter().map(|other| (likeness(other), *other)).max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = best.filter(|best| best.0 > 0.75).map_or(String::new(), |best| format!("did you mean '{}'? ", best.1));
    let shown = names.len().min(20);
    format!("{hint}there is: {}{}", names[..shown].join(", "), and_more(names.len() - shown))
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
    fn near_names() {
        let names = || ["bottom", "top"].into_iter();
        assert_eq!(near("Botom", names()), "did you mean 'bottom'? there is: bottom, top");
        assert_eq!(near("xyz", names()), "there is: bottom, top");
        assert_eq!(near("xyz", std::iter::empty()), "there is none");
    }
}
