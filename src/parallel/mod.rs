//! What all ranks must agree on: errors, and the global numbers of owned things; and messages between some of them.
//!
//! An error that one rank alone returns leaves the others waiting in the next collective call. So whatever may fail on
//! one rank passes through [`agree`] before any rank acts on it.

mod messages;

pub use messages::{Parcels, Route, Sent, exchange, scatter, sent, serve, to_all};

use crate::error::{Error, Location, Result};
use crate::failure::Cause;
use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use serde_json::{Value, json};

/// Returns each rank's own value when all ranks have one, else the error of the lowest failing rank on every rank.
///
/// Collective; one allreduce when nothing failed. The values of the ranks that succeeded are dropped when another failed:
/// `T` must not be a thing whose drop is collective, unless it was made collectively and so failed on all ranks or none.
pub fn agree<T>(comm: &impl Communicator, result: Result<T>) -> Result<T> {
    match first_word(comm, result.as_ref().err().map(encode)) {
        Some(message) => Err(decode(message.as_bytes())),
        None => result,
    }
}

/// What the lowest of the ranks that have something to say says, on every rank; `None` when none has.
///
/// Collective; one allreduce when nobody speaks.
pub fn first_word(comm: &impl Communicator, word: Option<String>) -> Option<String> {
    let speaking = if word.is_some() { comm.rank() } else { comm.size() };
    let mut lowest = speaking;
    comm.all_reduce_into(&speaking, &mut lowest, SystemOperation::min());
    if lowest == comm.size() {
        return None;
    }
    let speaker = comm.process_at_rank(lowest);
    let mut text = word.unwrap_or_default().into_bytes();
    let mut length = text.len() as u64;
    speaker.broadcast_into(&mut length);
    text.resize(length as usize, 0);
    // Where an empty vector is, MPI takes for MPI_IN_PLACE.
    if length > 0 {
        speaker.broadcast_into(&mut text[..]);
    }
    Some(String::from_utf8_lossy(&text).into_owned())
}

/// What the rank with the largest value says of it, of several the lowest, and that value; `None` when none has any.
///
/// Collective.
pub fn word_of_largest<T>(
    comm: &SimpleCommunicator,
    mine: Option<(T, f64)>,
    word: impl FnOnce(T) -> String,
) -> Option<(String, f64)> {
    let mut largest = [mine.as_ref().map_or(f64::NEG_INFINITY, |(_, value)| *value)];
    max(comm, &mut largest);
    let mine = mine.filter(|(_, value)| *value == largest[0]);
    first_word(comm, mine.map(|(what, _)| word(what))).map(|word| (word, largest[0]))
}

/// Numbers what the ranks own: `(offset, total)`, where this rank's `owned` things are `offset .. offset + owned`.
///
/// Collective.
pub fn number(comm: &impl Communicator, owned: u64) -> (u64, u64) {
    let (mut end, mut total) = (0, 0);
    comm.scan_into(&owned, &mut end, SystemOperation::sum());
    comm.all_reduce_into(&owned, &mut total, SystemOperation::sum());
    (end - owned, total)
}

/// Where each rank's things begin when all are numbered as by [`number`], and the end: rank r owns the numbers
/// `starts[r]..starts[r + 1]`. Collective.
pub fn starts(comm: &impl Communicator, owned: u64) -> Vec<u64> {
    let mut counts = vec![0; comm.size() as usize];
    comm.all_gather_into(&owned, &mut counts[..]);
    beginnings(&counts)
}

/// Where each of several lists begins that follow one another, and the end, by their lengths.
pub fn beginnings(lengths: &[u64]) -> Vec<u64> {
    let ends = lengths.iter().scan(0, |end, n| {
        *end += n;
        Some(*end)
    });
    std::iter::once(0).chain(ends).collect()
}

/// Sums over ranks, entry by entry. Collective.
pub fn sum(comm: &SimpleCommunicator, values: &mut [f64]) {
    let mine = values.to_vec();
    comm.all_reduce_into(&mine[..], values, SystemOperation::sum());
}

/// Largest over ranks, entry by entry. Collective.
pub fn max(comm: &SimpleCommunicator, values: &mut [f64]) {
    let mine = values.to_vec();
    comm.all_reduce_into(&mine[..], values, SystemOperation::max());
}

/// The bits that any rank has set. Collective.
pub fn union(comm: &SimpleCommunicator, bits: u64) -> u64 {
    let mut all = 0;
    comm.all_reduce_into(&bits, &mut all, SystemOperation::bitwise_or());
    all
}

/// True when any rank says so. Collective.
pub fn any(comm: &SimpleCommunicator, here: bool) -> bool {
    let mut all = 0i32;
    comm.all_reduce_into(&i32::from(here), &mut all, SystemOperation::max());
    all != 0
}

fn encode(error: &Error) -> String {
    let value = match error {
        Error::Input { at, what, help } => {
            let at = at.as_ref().map(|at| json!([*at.file, at.line, at.column, *at.text]));
            json!({ "kind": "input", "at": at, "what": what, "help": help })
        }
        Error::Inputs(errors) => {
            json!({ "kind": "inputs", "all": errors.iter().map(encode).collect::<Vec<_>>() })
        }
        Error::Diverged(failure) => json!({ "kind": "diverged", "what": failure.what }),
        Error::System(what) => json!({ "kind": "system", "what": what }),
        Error::Interrupted(what) => json!({ "kind": "interrupted", "what": what }),
    };
    value.to_string()
}

fn decode(message: &[u8]) -> Error {
    let value: Value = serde_json::from_slice(message).unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    let number = |value: &Value| value.as_u64().unwrap_or_default() as usize;
    let what = text(&value["what"]);
    match value["kind"].as_str() {
        Some("input") => {
            let at = value["at"].as_array().map(|_| &value["at"]).map(|at| Location {
                file: text(&at[0]).into(),
                line: number(&at[1]),
                column: number(&at[2]),
                text: text(&at[3]).into(),
            });
            Error::Input { at, what, help: text(&value["help"]) }
        }
        Some("inputs") => {
            let all = value["all"].as_array().into_iter().flatten();
            Error::Inputs(all.map(|error| decode(error.as_str().unwrap_or_default().as_bytes())).collect())
        }
        Some("diverged") => Error::diverged(Cause::Element, what),
        Some("interrupted") => Error::Interrupted(what),
        _ => Error::System(what),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_arrives_with_kind_place_and_help() {
        let at =
            Location { file: "a \"b\".toml".into(), line: 3, column: 14, text: "friction = -0.3 # µ\u{1F600}".into() };
        let override_at = Location { file: "--set x=1".into(), line: 0, column: 0, text: "".into() };
        for error in [
            Error::input(&at, "friction is negative", "give 0 or more\nor leave it out"),
            Error::input(&override_at, "no such key", ""),
            Error::input_anywhere("cannot write", "use --out"),
            Error::Inputs(vec![Error::input(&at, "one", "more"), Error::input_anywhere("another", "")]),
            Error::diverged(Cause::Element, "increment 7: node 12"),
            Error::System("MUMPS: INFOG(1) = -9".into()),
            Error::Interrupted("SIGTERM".into()),
        ] {
            let arrived = decode(encode(&error).as_bytes());
            assert_eq!(arrived.to_string(), error.to_string());
            assert_eq!(arrived.exit_code(), error.exit_code());
            assert_eq!(format!("{arrived:?}"), format!("{error:?}"));
        }
    }
}
