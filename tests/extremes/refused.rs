//! Which rows of the table are refused, and why: `refused.txt`. A row that is not on that list must be right, or what ran yesterday
//! may be refused today without anybody knowing; and one that is on it may be right, or refused for the reason that stands there.
//!
//! `NAGATA_EXTREMES_LIST=1 scripts/test --extremes` writes the list anew. It does not count where `NAGATA_CONTROLS` is set.

use crate::case::Outcome;
use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// What ends a run, by words of its reason of which one is there. Which node it is, how far it was, and in which way an iteration fails,
/// depends on rounding.
const KINDS: [(&str, &[&str]); 5] = [
    ("rounding", &["rounding leaves", "nearly singular"]),
    ("watch", &["went through", " deep in ", "is inside body", "lies beyond", "it is in none of the faces"]),
    ("loose", &["can move freely", "hold it", "holds it", "can hold the tool", "spins", "slide off"]),
    ("no convergence", &["converge", "do not settle", "comes back again", "contradict", "folded", "not stable"]),
    ("rounding", &["is ill-conditioned"]),
];

/// The kind of reason of each row.
static LISTED: LazyLock<BTreeMap<&str, &str>> = LazyLock::new(|| {
    include_str!("refused.txt")
        .lines()
        .filter_map(|line| line.split_once(" <- "))
        .map(|(why, row)| (row, why))
        .collect()
});

/// What kind of reason it is: that of what failed in a step, else the words of the message but for names and numbers.
fn kind(reason: &str) -> String {
    // What follows speaks of the place.
    let reason: String = reason.chars().take(150).collect();
    if reason.starts_with("step `") {
        let is = |words: &&(&str, &[&str])| words.1.iter().any(|word| reason.contains(word));
        return KINDS.iter().find(is).map_or("in a step", |(kind, _)| kind).into();
    }
    let is_plain = |word: &&str| word.chars().all(|c| c.is_ascii_lowercase() || c == ',' || c == '\'');
    let words: Vec<&str> = reason.split(' ').filter(is_plain).take(5).collect();
    words.join(" ").trim_end_matches(',').into()
}

/// The outcome of a row as the list has it.
pub fn judged(name: &str, outcome: Outcome) -> Outcome {
    let Outcome::Refused(reason) = &outcome else { return outcome };
    if env::var_os("NAGATA_CONTROLS").is_some() || env::var_os("NAGATA_EXTREMES_LIST").is_some() {
        return outcome;
    }
    match LISTED.get(name) {
        Some(why) if *why == kind(reason) => outcome,
        Some(why) => Outcome::Failed(format!("refused for another reason than `{why}`: {reason}")),
        None => Outcome::Failed(format!("refused, and is not on the list of refused rows: {reason}")),
    }
}

/// Writes the list of what was refused, where that is asked for.
pub fn write<'a>(outcomes: impl Iterator<Item = (&'a str, &'a Outcome)>) {
    if env::var_os("NAGATA_EXTREMES_LIST").is_none() {
        return;
    }
    let line = |(name, outcome): (&str, &Outcome)| match outcome {
        Outcome::Refused(reason) => Some(format!("{} <- {name}\n", kind(reason))),
        _ => None,
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/extremes/refused.txt");
    fs::write(path, outcomes.filter_map(line).collect::<String>()).unwrap();
}

/// Rows of the list that are no longer refused.
pub fn outdated<'a>(outcomes: impl Iterator<Item = (&'a str, &'a Outcome)>) -> Vec<&'a str> {
    let is_right = |(name, outcome): &(&str, &Outcome)| {
        LISTED.contains_key(name) && matches!(outcome, Outcome::Right(_) | Outcome::Warned(_))
    };
    outcomes.filter(is_right).map(|(name, _)| name).collect()
}

#[test]
fn the_list_has_rows_of_the_table_alone() {
    let names: Vec<String> = crate::all().into_iter().map(|case| case.name).collect();
    let unknown: Vec<_> = LISTED.keys().filter(|row| !names.iter().any(|name| name == *row)).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn reasons_are_known_by_what_does_not_change() {
    let watch = "step `press`, after time 0.558615: node 2139 of body `b` at (3.6, 2.0, 0.0) went through the tool `t` (contact `c`)";
    assert_eq!(kind(watch), "watch");
    assert_eq!(
        kind("step `s`, after time 0.5: no convergence in 15 iterations with the smallest increment"),
        "no convergence"
    );
    let input = "/tmp/.tmpzc/scene.toml:9:7: tool `t` is not drawn out along z over `b.ymax`, from z = 0.0 to 10.0";
    assert_eq!(kind(input), "tool is not drawn out");
    let outcome = judged("a row that is not there", Outcome::Refused(watch.into()));
    assert!(matches!(outcome, Outcome::Failed(_)) || env::var_os("NAGATA_CONTROLS").is_some());
}
