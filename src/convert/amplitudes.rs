//! *AMPLITUDE: factors over the time, linear between their points.

use crate::error::{Location, Result};
use crate::mesh::abaqus::Card;

pub(super) struct Amplitude {
    pub name: String,
    pub at: Location,
    /// Of the whole analysis, not of the step.
    pub total: bool,
    /// Some card names it.
    pub is_named: bool,
    /// Time and factor; none where nothing names it.
    points: Vec<[f64; 2]>,
}

/// Reads all amplitudes; of those that no card names nothing but the name counts.
pub(super) fn read(cards: &[Card]) -> Result<Vec<Amplitude>> {
    let mut amplitudes: Vec<Amplitude> = Vec::new();
    for card in cards.iter().filter(|card| card.keyword.name == "AMPLITUDE") {
        let name = card.keyword.get("NAME").unwrap_or_default().to_string();
        let mut named = cards.iter().filter_map(|card| card.keyword.get("AMPLITUDE"));
        let is_named = named.any(|named| named.eq_ignore_ascii_case(&name));
        let points = if is_named { points(card)? } else { Vec::new() };
        if amplitudes.iter().any(|other| other.is(&name)) {
            return Err(card.error(format!("two amplitudes are named '{name}'"), "rename one"));
        }
        let total = card.keyword.get("TIME").is_some_and(|time| time.eq_ignore_ascii_case("TOTAL TIME"));
        amplitudes.push(Amplitude { name, at: card.at.clone(), total, is_named, points });
    }
    Ok(amplitudes)
}

/// The times and factors of a card.
fn points(card: &Card) -> Result<Vec<[f64; 2]>> {
    let word = |key: &str| card.keyword.get(key).unwrap_or_default().to_uppercase();
    if !matches!(word("DEFINITION").as_str(), "" | "TABULAR") {
        let what = format!("*AMPLITUDE, DEFINITION={} cannot be converted", word("DEFINITION"));
        return Err(card.error(what, "write it as a table of times and factors"));
    }
    if !matches!(word("VALUE").as_str(), "" | "RELATIVE") {
        return Err(card.error("absolute amplitudes cannot be converted", "write factors"));
    }
    // An empty field at the end of a line is none.
    let fields = card.rows.iter().flat_map(|row| {
        let fields: Vec<&str> = crate::mesh::abaqus::fields(&row.text).collect();
        let count = fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
        fields.into_iter().take(count).map(move |field| (row, field)).collect::<Vec<_>>()
    });
    let numbers: Vec<f64> = fields.map(|(row, field)| row.number(field, 0.0)).collect::<Result<_>>()?;
    let points = numbers.as_chunks::<2>();
    if points.0.is_empty() || !points.1.is_empty() {
        return Err(card.error("the numbers are not pairs of time and factor", ""));
    }
    if points.0.windows(2).any(|pair| pair[1][0] <= pair[0][0]) {
        return Err(card.error("the times do not rise", "a jump cannot be converted: make it a short ramp"));
    }
    Ok(points.0.to_vec())
}

/// The amplitude that a card names.
pub(super) fn of(amplitudes: &[Amplitude], card: &Card) -> Result<Option<usize>> {
    let Some(name) = card.keyword.get("AMPLITUDE") else { return Ok(None) };
    let found = amplitudes.iter().position(|amplitude| amplitude.is(name));
    found.map(Some).ok_or_else(|| card.error(format!("there is no amplitude '{name}'"), ""))
}

impl Amplitude {
    /// Whether a card means it by this name.
    pub fn is(&self, name: &str) -> bool {
        self.name.eq_ignore_ascii_case(name)
    }

    /// The factor, that of the first or last point outside of them.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] <= time);
        match (after.checked_sub(1).map(|before| self.points[before]), self.points.get(after)) {
            (Some([t0, a0]), Some([t1, a1])) => a0 + (a1 - a0) * (time - t0) / (t1 - t0),
            (Some([_, a]), None) | (None, Some(&[_, a])) => a,
            (None, None) => 0.0,
        }
    }

    /// The times at which it bends.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| point[0])
    }
}
