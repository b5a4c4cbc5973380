//! What `nagata trade` varies, and what it compares with: `[trade]`.

use super::Located;
use super::reader::{Item, Table};
use crate::error::{Location, Result};

/// How the speed of a scene is traded for accuracy. Whether its overrides mean anything is for `nagata trade` to see.
#[derive(Clone, Debug, Default)]
pub struct Trade {
    /// Steps that are run; `None` is all.
    pub steps: Option<usize>,
    /// Overrides of all runs, as of `--set`.
    pub set: Vec<Located<String>>,
    /// Settings; empty is those that the scene suggests.
    pub vary: Vec<Vary>,
    /// Overrides of the run that others are compared with; `None` is those that the scene suggests.
    pub reference: Option<Vec<Located<String>>>,
    /// Overrides of the run that says how far the reference is off.
    pub next: Option<Vec<Located<String>>>,
    /// What is known better than by a run.
    pub exact: Vec<Exact>,
}

/// A setting and what it is varied to.
#[derive(Clone, Debug)]
pub struct Vary {
    pub at: Location,
    pub kind: Varied,
}

/// What is varied.
#[derive(Clone, Debug)]
pub enum Varied {
    /// Keys that share each of the values, which are TOML.
    Keys { keys: Vec<String>, values: Vec<String> },
    /// Overrides that are made together.
    Together { name: String, set: Vec<Located<String>> },
}

/// A value, or a curve over time, that a column of the history or a measure has.
#[derive(Clone, Debug)]
pub struct Exact {
    /// As in `cap.fz`.
    pub of: Located<String>,
    pub known: Known,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Known {
    /// At the end of a step; `None` is the last.
    Value { value: f64, step: Option<String> },
    /// Pairs of time and value; times increase.
    Curve(Vec<[f64; 2]>),
}

/// Reads the table; without it nothing is said.
pub(super) fn read(root: &Table) -> Result<Trade> {
    let keys = ["steps", "set", "vary", "reference", "next", "exact"];
    let Some(table) = root.optional("trade", |item| item.table(&keys))? else { return Ok(Trade::default()) };
    let overrides = |item: &Item| item.list()?.iter().map(Item::located_string).collect::<Result<Vec<_>>>();
    let trade = Trade {
        steps: table.optional("steps", Item::count)?,
        set: table.optional("set", overrides)?.unwrap_or_default(),
        vary: table.each("vary", vary)?,
        reference: table.optional("reference", overrides)?,
        next: table.optional("next", overrides)?,
        exact: table.each("exact", exact)?,
    };
    match (&trade.reference, table.get("next")) {
        (None, Some(next)) => {
            let help = "add `reference = [\"KEY=VALUE\", ...]`, of which `next` is a little less than";
            Err(next.error("stands without `reference`", help))
        }
        _ => Ok(trade),
    }
}

fn vary(item: &Item) -> Result<Vary> {
    let table = item.table(&["key", "values", "name", "set"])?;
    let strings = |item: &Item| item.filled_list()?.iter().map(Item::located_string).collect::<Result<Vec<_>>>();
    let keys = table.optional("key", |item| {
        if item.is_string() {
            return Ok(vec![item.string()?.to_string()]);
        }
        if !item.is_list() {
            return Err(item.error("must be a string or a list of them", "for example `key = \"solver.tolerance\"`"));
        }
        Ok(strings(item)?.into_iter().map(|key| key.value).collect())
    })?;
    let values = table.optional("values", |item| item.filled_list()?.iter().map(Item::plain_toml).collect())?;
    let name = table.optional("name", Item::string)?.map(str::to_string);
    let set = table.optional("set", strings)?;
    let kind = match (keys, values, name, set) {
        (Some(keys), Some(values), None, None) => Varied::Keys { keys, values },
        (None, None, Some(name), Some(set)) => Varied::Together { name, set },
        _ => {
            let help = "for example `key = \"solver.tolerance\", values = [1e-6, 1e-8]`, or \
                        `name = \"rough\", set = [\"solver.tolerance=1e-6\", \"solver.linear=direct\"]`";
            return Err(table.error("must have either `key` and `values`, or `name` and `set`", help));
        }
    };
    Ok(Vary { at: item.at().clone(), kind })
}

fn exact(item: &Item) -> Result<Exact> {
    let table = item.table(&["of", "value", "step", "curve"])?;
    let help = "errors are relative to it";
    let value = table.optional("value", |item| item.number_that_is("other than 0", |value| value != 0.0, help))?;
    let step = table.optional("step", Item::string)?.map(str::to_string);
    let curve = table.optional("curve", curve)?;
    let of = table.require("of", "\"TOOL.fz\"")?.located_string()?;
    let known = match (value, curve, step) {
        (Some(value), None, step) => Known::Value { value, step },
        (None, Some(curve), None) => Known::Curve(curve),
        _ => {
            let help = "for example `value = -12.5, step = \"press\"`, or `curve = [[0.0, 0.0], [1.0, -12.5]]`";
            return Err(table.error("must have either `value`, and `step` if not the last, or `curve`", help));
        }
    };
    Ok(Exact { of, known })
}

fn curve(item: &Item) -> Result<Vec<[f64; 2]>> {
    let pair = |item: &Item| item.array::<f64, 2>(Item::number, "[0.5, -12.5]");
    let points = item.filled_list()?.iter().map(pair).collect::<Result<Vec<_>>>()?;
    if !points.is_sorted_by(|a, b| a[0] < b[0]) {
        return Err(item.error("must be pairs of time and value whose times increase", ""));
    }
    if points.iter().all(|point| point[1] == 0.0) {
        return Err(item.error("must have values other than 0", "errors are relative to the largest"));
    }
    Ok(points)
}
