//! Names of the scene for those of the deck.

use std::collections::BTreeSet;

/// Gives each thing a name of its own.
#[derive(Default)]
pub(super) struct Namer {
    /// In capitals.
    taken: BTreeSet<String>,
}

impl Namer {
    /// A name close to `wanted`, with letters, digits, `_` and `-` alone; `instead` for what has none.
    pub fn name(&mut self, wanted: &str, instead: &str) -> String {
        // What makes one of two, or takes a number, stays short enough.
        const MOST: usize = 100;
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let name: String = wanted.chars().map(plain).take(MOST).collect();
        let name = name.trim_matches(['-', '_']);
        let name = match name.chars().next() {
            None => instead.to_string(),
            Some(first) if first.is_ascii_alphabetic() => name.to_string(),
            Some(_) => format!("{instead}-{name}"),
        };
        self.unique(&name)
    }

    /// The name itself, or with a number behind it when it is taken.
    pub fn unique(&mut self, name: &str) -> String {
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let mut candidates = std::iter::once(name.to_string()).chain(numbered);
        let free = candidates.find(|candidate| !self.taken.contains(&candidate.to_uppercase()));
        let free = free.unwrap_or_default();
        self.taken.insert(free.to_uppercase());
        free
    }

    pub fn take(&mut self, name: &str) {
        self.taken.insert(name.to_uppercase());
    }
}
