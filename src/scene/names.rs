//! Names the user chose, and how an unknown one is reported: with the nearest known name and the list of them all.

/// Similarity (Jaro-Winkler, 0 to 1) from which two words are taken for each other.
const NEAR: f64 = 0.8;

/// How many known names a message lists.
const LISTED: usize = 20;

/// Letters of a name: files of results have names of bodies and contacts in theirs, of 255 bytes at most.
pub(super) const LONGEST: usize = 128;

/// Whether `word` may name a body, material, tool, contact, step or face group: a letter, then letters, digits, `_`
/// and `-`, not too many of them.
pub(super) fn is_name(word: &str) -> bool {
    word.len() <= LONGEST
        && word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// The candidate that `word` most likely stands for; `None` when none resembles it.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let similarity = |candidate: &str| strsim::jaro_winkler(&word, &candidate.to_lowercase());
    let scored = candidates.into_iter().map(|candidate| (similarity(candidate), candidate));
    let best = scored.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.filter(|best| best.0 >= NEAR).map(|best| best.1)
}

/// Help for an unknown name: "did you mean `slab`? (known: slab, pad)", without the question when nothing is near.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let mut list = known[..known.len().min(LISTED)].join(", ");
    if known.len() > LISTED {
        list += &format!(", and {} more", known.len() - LISTED);
    }
    match nearest(word, known.iter().copied()) {
        _ if known.is_empty() => "none is defined".to_string(),
        Some(near) => format!("did you mean `{near}`? (known: {list})"),
        None => format!("known: {list}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_of_the_keyboard_and_nothing_else() {
        let keys = ["material", "mesh", "element", "plane_strain"];
        assert_eq!(nearest("materail", keys), Some("material"));
        assert_eq!(nearest("Mesh", keys), Some("mesh"));
        assert_eq!(nearest("plain_strain", keys), Some("plane_strain"));
        assert_eq!(nearest("young", keys), None);
        assert_eq!(nearest("young", []), None);
    }

    #[test]
    fn help_lists_what_is_known() {
        assert_eq!(did_you_mean("slav", ["slab", "pad"]), "did you mean `slab`? (known: slab, pad)");
        assert_eq!(did_you_mean("foot", ["slab", "pad"]), "known: slab, pad");
        assert_eq!(did_you_mean("foot", []), "none is defined");
        let many: Vec<String> = (0..23).map(|i| format!("g{i}")).collect();
        assert!(did_you_mean("q", many.iter().map(String::as_str)).ends_with("g18, g19, and 3 more"));
    }

    #[test]
    fn names_are_plain_words() {
        assert!(is_name("slab-2_b"));
        assert!(is_name(&"a".repeat(LONGEST)) && !is_name(&"a".repeat(LONGEST + 1)));
        assert!(["", "2d", "a.b", "a b", "é"].iter().all(|word| !is_name(word)));
    }
}
