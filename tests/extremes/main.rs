//! Extremes: scenes at the ends of what can be asked for, each held against a value that does not come from the run.
//!
//! A row of the suite is right, or refused with the reason that refused.txt has for it; a run that ends with exit code 0 and
//! another answer is wrong. The rows that are quick run as tests of their families. All of them, in one table: `scripts/test --extremes`.

#[path = "../common/mod.rs"]
mod common;

#[macro_use]
mod case;
mod oracle;
mod scenes;
mod table;

mod bars;
mod checkpoints;
mod conditions;
mod curves;
mod edges;
mod elastic;
mod elements;
mod folds;
mod footings;
mod friction;
mod materials;
mod meshes;
mod numbers;
mod pairs;
mod passage;
mod penalty;
mod ranks;
mod refused;
mod rings;
mod segments;
mod sheets;
mod ties;
mod torques;
mod turns;

/// All cases, in the order of the table.
fn all() -> Vec<case::Case> {
    [
        penalty::cases(),
        materials::cases(),
        friction::cases(),
        passage::cases(),
        conditions::cases(),
        numbers::cases(),
        edges::cases(),
        meshes::cases(),
        ranks::cases(),
        segments::cases(),
        bars::cases(),
        rings::cases(),
        sheets::cases(),
        ties::cases(),
        torques::cases(),
        footings::cases(),
        elastic::cases(),
        checkpoints::cases(),
        elements::cases(),
        pairs::cases(),
        turns::cases(),
        folds::cases(),
        curves::cases(),
    ]
    .concat()
}

/// `scripts/test --extremes`. `NAGATA_EXTREMES` keeps only the cases whose names contain one of its words;
/// `NAGATA_CONTROLS`, such as "controls.reach_facets=1", is set in all scenes, here and in the quick cases.
#[test]
#[ignore = "extremes"]
fn table() {
    let filter = std::env::var("NAGATA_EXTREMES").unwrap_or_default();
    let is_chosen = |name: &str| filter.is_empty() || filter.split(',').any(|word| name.contains(word));
    let chosen: Vec<_> = all().into_iter().filter(|case| is_chosen(&case.name)).collect();
    assert!(table::print(&chosen), "rows of the table are neither right nor refused with a reason");
}
