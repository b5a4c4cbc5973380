//! Where right values come from, and how far off a run may be.
//!
//! A quantity is a column of `history.csv` at its end, as in `cap.fx`; `cap.fx@press` is its last value in a step, and
//! `a/b` a ratio of two.

use crate::case::{Case, Done, shown};
use crate::common::History;

#[derive(Clone)]
pub enum Oracle {
    /// A value, the length or force that an error is compared with, the share of it that is allowed, and the source.
    Value { quantity: String, value: f64, scale: f64, tolerance: f64, source: String },
    /// What another run gives.
    Same { quantity: String, as_in: Box<Case>, times: f64, tolerance: f64, source: String },
    /// The forces of these tools and sets, on which nothing else acts, add up to none.
    Balance { names: Vec<&'static str>, tolerance: f64 },
    /// A plane across this axis pushes along itself with no more than so many times what it pushes with across.
    Coulomb { tool: &'static str, axis: usize, friction: f64 },
    /// The summary counts none of these.
    None { what: &'static str },
}

/// Of an oracle.
pub struct Verdict {
    /// Nothing where it has no value to compare with: the run that was to give it failed.
    pub holds: Option<bool>,
    pub text: String,
}

/// `quantity` is `value` within a relative tolerance.
pub fn value(quantity: &str, value: f64, tolerance: f64, source: &str) -> Oracle {
    near(quantity, value, value.abs(), tolerance, source)
}

/// `quantity` is `value` within a share of `scale`.
pub fn near(quantity: &str, value: f64, scale: f64, tolerance: f64, source: &str) -> Oracle {
    Oracle::Value { quantity: quantity.into(), value, scale, tolerance, source: source.into() }
}

/// `quantity` is what another run gives.
pub fn same(quantity: &str, as_in: Case, tolerance: f64, source: &str) -> Oracle {
    scaled(quantity, as_in, 1.0, tolerance, source)
}

/// `quantity` is `times` what another run gives.
pub fn scaled(quantity: &str, as_in: Case, times: f64, tolerance: f64, source: &str) -> Oracle {
    Oracle::Same { quantity: quantity.into(), as_in: Box::new(as_in), times, tolerance, source: source.into() }
}

/// See [`Oracle::Balance`]; the tolerance is a share of the largest force.
pub fn balance(names: &[&'static str], tolerance: f64) -> Oracle {
    Oracle::Balance { names: names.to_vec(), tolerance }
}

/// See [`Oracle::Coulomb`].
pub fn coulomb(tool: &'static str, axis: usize, friction: f64) -> Oracle {
    Oracle::Coulomb { tool, axis, friction }
}

/// See [`Oracle::None`].
pub fn none(what: &'static str) -> Oracle {
    Oracle::None { what }
}

impl Oracle {
    pub fn text(&self) -> String {
        match self {
            Self::Value { quantity, value, source, .. } => format!("{quantity} = {value:.5e} ({source})"),
            Self::Same { quantity, source, .. } => format!("{quantity} as by {source}"),
            Self::Balance { names, .. } => format!("{} balance", names.join(" + ")),
            Self::Coulomb { tool, friction, .. } => format!("{tool} within the cone of {friction}"),
            Self::None { what } => format!("no {what}"),
        }
    }

    pub fn judge(&self, done: &Done) -> Verdict {
        let Some(history) = done.history.as_ref().filter(|history| history.len() > 0) else {
            return Verdict { holds: Some(false), text: "an empty history".into() };
        };
        match self {
            Self::Value { quantity, value, scale, tolerance, .. } => {
                compare(quantity, find(history, quantity), *value, *scale, *tolerance)
            }
            Self::Same { quantity, as_in, times, tolerance, .. } => {
                let other = as_in.run();
                let Some(right) = other.history.as_ref().filter(|_| other.code == Some(0)) else {
                    return Verdict { holds: None, text: format!("the oracle failed: {}", shown(&other.reason())) };
                };
                let right = times * find(right, quantity);
                compare(quantity, find(history, quantity), right, right.abs(), *tolerance)
            }
            Self::Balance { names, tolerance } => {
                let force = |name: &str| ["fx", "fy", "fz"].map(|c| history.last(&format!("{name}.{c}")));
                let forces: Vec<_> = names.iter().map(|name| force(name)).collect();
                // Of the whole run: at its end there may be none.
                let largest = names.iter().fold(f64::MIN_POSITIVE, |m, name| m.max(history.largest_force(name)));
                let rest = (0..3).map(|c| forces.iter().map(|f| f[c]).sum::<f64>().abs()).fold(0.0, f64::max);
                let error = rest / largest;
                // A NaN in the forces is no balance.
                let finite = forces.iter().flatten().all(|f| f.is_finite());
                Verdict { holds: Some(finite && error <= *tolerance), text: format!("balance {error:.1e}") }
            }
            Self::Coulomb { tool, axis, friction } => {
                let f = ["fx", "fy", "fz"].map(|c| history.last(&format!("{tool}.{c}")));
                let along = f[(axis + 1) % 3].hypot(f[(axis + 2) % 3]);
                // What the tolerance of the solution lets through is allowed.
                let holds = along <= friction * f[*axis].abs() + 1e-8 * history.largest_force(tool);
                Verdict {
                    holds: Some(holds),
                    text: format!("{tool} {:.3e} along itself over across", along / f[*axis].abs()),
                }
            }
            Self::None { what } => {
                let count = done.summary[*what].as_u64();
                Verdict {
                    holds: Some(count == Some(0)),
                    text: format!("{} {what}", count.map_or("?".into(), |n| n.to_string())),
                }
            }
        }
    }
}

fn compare(quantity: &str, found: f64, value: f64, scale: f64, tolerance: f64) -> Verdict {
    let error = (found - value).abs() / scale;
    // A NaN does not hold.
    Verdict { holds: Some(error <= tolerance), text: format!("{quantity} {found:.6e}, off by {error:.1e}") }
}

/// A quantity of a history.
pub fn find(history: &History, quantity: &str) -> f64 {
    if let Some((a, b)) = quantity.split_once('/') {
        return find(history, a) / find(history, b);
    }
    let Some((column, step)) = quantity.split_once('@') else { return history.last(quantity) };
    let row = history.steps.iter().rposition(|s| s == step);
    history.column(column)[row.unwrap_or_else(|| panic!("no step `{step}`"))]
}
