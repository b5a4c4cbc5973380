//! Runs cases side by side, and prints what came out.

use crate::case::{Case, Outcome, shown};
use crate::refused::{judged, outdated, write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

impl Outcome {
    /// As it stands in the table: bad ones in capitals.
    fn words(&self) -> (&'static str, String) {
        match self {
            Self::Right(text) => ("right", text.clone()),
            Self::Warned(text) => ("warned", text.clone()),
            Self::Refused(text) => ("refused", shown(text)),
            Self::Wrong(text) => ("WRONG", text.clone()),
            Self::Failed(text) => ("FAILED", shown(text)),
            Self::Crash(text) => ("CRASH", text.clone()),
            Self::Hang(text) => ("HANG", text.clone()),
        }
    }

    pub fn is_good(&self) -> bool {
        matches!(self, Self::Right(_) | Self::Warned(_) | Self::Refused(_))
    }
}

/// Fails the test that calls it, and says why, unless each of the quick cases is right, warned of or refused.
pub fn hold(cases: Vec<Case>) {
    let quick: Vec<Case> = cases.into_iter().filter(|case| case.quick).collect();
    let mut bad = String::new();
    for case in &quick {
        let outcome = judged(&case.name, case.outcome());
        let (word, text) = outcome.words();
        println!("{}: {word}, {text}", case.name);
        if !outcome.is_good() {
            bad += &format!("{}: {word}, {text} (oracle: {})\n", case.name, case.oracle_text());
        }
    }
    assert!(bad.is_empty(), "\n{bad}");
}

/// Runs all, as many at a time as there are cores, prints the table and the counts; whether no row is bad.
pub fn print(cases: &[Case]) -> bool {
    let (next, outcomes) = (AtomicUsize::new(0), Mutex::new(vec![None; cases.len()]));
    let workers = thread::available_parallelism().map_or(2, |n| n.get());
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((k, case)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, cases.get(k)?)))
                {
                    let started = Instant::now();
                    let outcome = judged(&case.name, case.outcome());
                    let (word, text) = outcome.words();
                    let seconds = started.elapsed().as_secs_f64();
                    eprintln!("{}/{} {}: {word}: {text} ({seconds:.1} s)", k + 1, cases.len(), case.name);
                    outcomes.lock().unwrap()[k] = Some(outcome);
                }
            });
        }
    });
    let outcomes: Vec<Outcome> = outcomes.into_inner().unwrap().into_iter().flatten().collect();
    let width = |texts: &mut dyn Iterator<Item = usize>| texts.max().unwrap_or(0);
    let first = width(&mut cases.iter().map(|case| case.name.chars().count()));
    let second = width(&mut cases.iter().map(|case| case.oracle_text().chars().count())).min(64);
    println!("\n{:first$} | {:second$} | outcome", "case", "oracle");
    for (case, outcome) in cases.iter().zip(&outcomes) {
        let (word, text) = outcome.words();
        println!("{:first$} | {:second$} | {word}: {text}", case.name, case.oracle_text());
    }
    let counts = ["right", "warned", "refused", "WRONG", "FAILED", "CRASH", "HANG"]
        .map(|word| format!("{} {word}", outcomes.iter().filter(|outcome| outcome.words().0 == word).count()));
    let named = || cases.iter().map(|case| case.name.as_str()).zip(&outcomes);
    for row in outdated(named()) {
        println!("no longer refused, see tests/extremes/refused.txt: {row}");
    }
    write(named());
    println!("\n{} cases: {}", cases.len(), counts.join(", "));
    outcomes.iter().all(Outcome::is_good)
}
