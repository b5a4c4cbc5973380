//! What `nagata calibrate` has measured, as it is kept in the user's cache: `$XDG_CACHE_HOME/nagata/machine.json`, or
//! `~/.cache/nagata/machine.json`, by host and number of ranks.

use super::work::{Rates, Work};
use crate::error::{Error, Result};
use crate::output::replace;
use crate::parallel::first_word;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// How fast this machine works on so many ranks.
#[derive(Clone, Debug)]
pub struct Machine {
    pub rates: Rates,
    /// Whether this machine has been measured, on how many ranks, and when.
    measured: Option<(usize, String)>,
}

/// What is kept of a measurement.
#[derive(Clone, Debug, PartialEq)]
struct Kept {
    host: String,
    ranks: usize,
    date: String,
    rates: Rates,
}

impl Machine {
    /// The machine at hand as it was measured, or a usual one; and a warning, where what was kept cannot be read. Collective.
    pub fn find(comm: &SimpleCommunicator) -> (Self, Option<String>) {
        let ranks = comm.size() as usize;
        let read = || cache().and_then(|path| Some((std::fs::read_to_string(&path).ok()?, path)));
        let text = (comm.rank() == 0).then(read).flatten();
        let warning = text.as_ref().filter(|(text, _)| decode(text).is_none()).map(|(_, path)| {
            format!("{} is damaged, and passed over; `nagata calibrate` writes it anew", path.display())
        });
        let warning = first_word(comm, warning);
        let text = first_word(comm, text.map(|(text, _)| text));
        let kept = text.and_then(|text| decode(&text)).unwrap_or_default();
        (Self::among(kept, &host(comm), ranks), warning)
    }

    /// Of what was measured on this host that with the nearest number of ranks.
    fn among(kept: Vec<Kept>, host: &str, ranks: usize) -> Self {
        let nearest = kept.into_iter().filter(|k| k.host == host).min_by_key(|k| k.ranks.abs_diff(ranks));
        match nearest {
            Some(kept) => Self { rates: kept.rates.on(kept.ranks, ranks), measured: Some((kept.ranks, kept.date)) },
            None => Self::usual(ranks),
        }
    }

    /// One that has not been measured.
    pub(super) fn usual(ranks: usize) -> Self {
        Self { rates: Rates::default().on(1, ranks), measured: None }
    }

    /// Whose rates these are, in words.
    pub fn origin(&self) -> String {
        let some = |n: usize| format!("{n} rank{}", if n == 1 { "" } else { "s" });
        match &self.measured {
            Some((ranks, date)) => format!("rates of this machine, calibrated on {date} with {}", some(*ranks)),
            None => "default rates; `nagata calibrate` measures this machine".into(),
        }
    }
}

/// Keeps what was measured: in which file.
///
/// # Errors
/// On the first rank, there is no place for it.
pub fn keep(comm: &SimpleCommunicator, rates: &Rates) -> Result<PathBuf> {
    let host = host(comm);
    let lost = |why: String| {
        Error::System(format!(
            "what was measured is not kept: {why}; XDG_CACHE_HOME names a folder for it, which is to be writable"
        ))
    };
    let path = cache().ok_or_else(|| lost("neither XDG_CACHE_HOME nor HOME is set".into()))?;
    if comm.rank() > 0 {
        return Ok(path);
    }
    let new = Kept { host, ranks: comm.size() as usize, date: today(), rates: rates.clone() };
    let known = std::fs::read_to_string(&path).ok().and_then(|text| decode(&text)).unwrap_or_default();
    let others = known.into_iter().filter(|k| (&k.host, k.ranks) != (&new.host, new.ranks));
    let all: Vec<Kept> = others.chain([new.clone()]).collect();
    let folder = path.parent().map(std::fs::create_dir_all).transpose();
    folder.map_err(|error| lost(format!("{}: {error}", path.display())))?;
    replace(&path, &encode(&all)).map_err(|error| lost(error.to_string()))?;
    Ok(path)
}

fn host(comm: &SimpleCommunicator) -> String {
    let own = (comm.rank() == 0).then(|| mpi::environment::processor_name().unwrap_or_default());
    first_word(comm, own).unwrap_or_default()
}

fn cache() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base = folder("XDG_CACHE_HOME").or_else(|| folder("HOME").map(|home| home.join(".cache")))?;
    Some(base.join("nagata/machine.json"))
}

fn encode(all: &[Kept]) -> String {
    let of = |kept: &Kept| {
        let rates: Map<String, Value> = kept.rates.iter().map(|(work, s)| (work.name(), json!(s))).collect();
        json!({ "host": kept.host, "ranks": kept.ranks, "date": kept.date, "seconds": rates })
    };
    format!("{:#}\n", json!({ "measured": all.iter().map(of).collect::<Vec<_>>() }))
}

/// `None` where the text is no such file, or lacks a rate.
fn decode(text: &str) -> Option<Vec<Kept>> {
    let value: Value = serde_json::from_str(text).ok()?;
    value["measured"].as_array()?.iter().map(decode_one).collect()
}

fn decode_one(value: &Value) -> Option<Kept> {
    let mut rates = Rates::default();
    for work in Work::all() {
        let seconds = value["seconds"][work.name()].as_f64().filter(|s| s.is_finite() && *s >= 0.0)?;
        rates.set(work, seconds);
    }
    let ranks = value["ranks"].as_u64().filter(|ranks| *ranks > 0)? as usize;
    Some(Kept { host: value["host"].as_str()?.into(), ranks, date: value["date"].as_str()?.into(), rates })
}

fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let (year, month, day) = civil((seconds / 86_400) as i64);
    format!("{year}-{month:02}-{day:02}")
}

/// The date so many days after 1970-01-01: eras of 400 years, years that begin in March (H. Hinnant, `civil_from_days`).
fn civil(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    (year + 400 * era + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(host: &str, ranks: usize, factor: f64) -> Kept {
        let mut rates = Rates::default();
        Work::all().into_iter().for_each(|work| rates.set(work, factor * Rates::default().of(work)));
        Kept { host: host.into(), ranks, date: "2026-11-22".into(), rates }
    }

    #[test]
    fn what_is_kept_is_read_back() {
        let all = vec![kept("a", 1, 1.5), kept("b", 2, 0.25)];
        let read = decode(&encode(&all)).unwrap();
        assert_eq!(read.len(), 2);
        for (read, kept) in read.iter().zip(&all) {
            assert_eq!((&read.host, read.ranks, &read.date), (&kept.host, kept.ranks, &kept.date));
            // Decimals are rounded.
            assert!(kept.rates.iter().all(|(work, s)| (read.rates.of(work) / s - 1.0).abs() < 1e-15));
        }
    }

    #[test]
    fn damaged_files_are_none() {
        let whole = encode(&[kept("a", 1, 1.0)]);
        for damaged in ["", "{}", "[1]", &whole[..whole.len() / 2], &whole.replace("slave node", "slav node")] {
            assert_eq!(decode(damaged), None, "{damaged}");
        }
        assert_eq!(decode(&whole.replace("\"ranks\": 1", "\"ranks\": 0")), None);
    }

    #[test]
    fn the_nearest_number_of_ranks_of_the_same_host_counts() {
        let all = || vec![kept("a", 1, 1.0), kept("a", 8, 4.0), kept("b", 4, 9.0)];
        let ranks = |host: &str, ranks| Machine::among(all(), host, ranks).measured.map(|(ranks, _)| ranks);
        assert_eq!((ranks("a", 1), ranks("a", 3), ranks("a", 5), ranks("b", 1)), (Some(1), Some(1), Some(8), Some(4)));
        assert_eq!(ranks("c", 1), None);
    }

    #[test]
    fn days_are_dates() {
        for (days, date) in [(0, (1970, 1, 1)), (59, (1970, 3, 1)), (11_016, (2000, 2, 29)), (20_779, (2026, 11, 22))] {
            assert_eq!(civil(days), date);
        }
    }
}
