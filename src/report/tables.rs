//! The numbers of a page, a column a run.

use super::curves;
use super::run::{Run, State};
use crate::output::log::short;
use maud::{Markup, html};
use serde_json::Value;

/// What is not known.
const UNKNOWN: &str = "–";

/// Six significant digits at most.
pub fn number(value: f64) -> String {
    let text = short(value);
    text.strip_suffix(".0").map(str::to_string).unwrap_or(text)
}

/// What stands in `summary.json`, as it stands there.
fn written(value: &Value) -> String {
    match value {
        Value::Null => UNKNOWN.into(),
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// A part of all.
fn percent(value: &Value) -> String {
    value.as_f64().map_or(UNKNOWN.into(), |value| format!("{:.2} %", 100.0 * value))
}

/// A row: what it is, and what each run has.
type Row = (String, Vec<String>);

/// Runs side by side.
fn table(runs: &[Run], rows: &[Row]) -> Markup {
    html! {
        table {
            thead { tr { td {} @for (k, run) in runs.iter().enumerate() { th scope="col" { (name(runs, k, run)) } } } }
            tbody {
                @for (what, values) in rows {
                    tr { th scope="row" { (what) } @for value in values { td { (value) } } }
                }
            }
        }
    }
}

/// The name of a run, with its number where there are several.
pub fn name(runs: &[Run], number: usize, run: &Run) -> String {
    if runs.len() > 1 { format!("{} {}", number + 1, run.name) } else { run.name.clone() }
}

/// How a run stands, in a few words.
pub fn state(run: &Run) -> String {
    match run.state {
        State::Runs => match &run.told.last {
            Some((step, percent)) => format!("runs: step {step}, {percent}"),
            None => "runs: no increment has converged yet".into(),
        },
        State::Converged => "converged".into(),
        State::Failed(_) => "failed".into(),
        State::Interrupted(_) => "ended by a signal".into(),
        State::Killed => "ended without a summary: killed, or it runs where no locks are seen".into(),
    }
}

/// What the runs are, and what they have done.
pub fn overview(runs: &[Run]) -> Markup {
    let row = |what: &str, value: &dyn Fn(&Run) -> String| (what.to_string(), runs.iter().map(value).collect());
    let summary = |what: &str, key: &str| row(what, &|run| written(&run.summary[key]));
    let count = |run: &Run| run.history.times().len();
    let mean = |run: &Run| run.sum("iterations") / count(run).max(1) as f64;
    let jumps = |run: &Run| {
        let found = run.history.column("found").unwrap_or_default();
        found.iter().filter(|&&how| how == 2.0).count().to_string()
    };
    let sizes = |run: &Run| {
        let sizes = curves::sizes(run);
        let (least, most) = sizes.iter().fold((f64::INFINITY, 0.0f64), |(a, b), &size| (a.min(size), b.max(size)));
        if sizes.is_empty() { UNKNOWN.into() } else { format!("{} to {}", number(least), number(most)) }
    };
    let mut rows = vec![row("state", &state)];
    if runs.iter().any(|run| run.title != runs[0].title) {
        rows.push(row("title", &|run| run.title.clone()));
    }
    rows.extend([
        row("reached time", &|run| number(run.history.times().last().copied().unwrap_or_default())),
        row("increments", &|run| count(run).to_string()),
        row("sizes of increments", &sizes),
        row("failed tries of these increments", &|run| number(run.sum("failures"))),
        summary("cutbacks", "cutbacks"),
        row("jumps", &jumps),
        row("Newton iterations an increment", &|run| format!("{:.2}", mean(run))),
        summary("Newton iterations with failed tries", "iterations"),
        summary("elements", "elements"),
        summary("unknowns", "dofs"),
        summary("multipliers among them", "multipliers"),
        summary("matrix", "matrix"),
        summary("linear solver", "linear_solver"),
        summary("factorizations", "factorizations"),
        summary("accuracy", "accuracy"),
        summary("ranks", "ranks"),
    ]);
    table(runs, &rows)
}

/// The phases of a run, as `summary.json` names them in its order of work, and what is left.
const PHASES: [&str; 9] = ["read", "partition", "search", "watch", "assembly", "factor", "solve", "output", "rest"];

/// Seconds in each of the phases of each run.
pub fn phases(runs: &[Run]) -> ([&'static str; 9], Vec<Vec<f64>>) {
    let of_run = |run: &Run| {
        let second = |name: &str| run.summary["phases_s"][name].as_f64().unwrap_or_default();
        let mut seconds: Vec<f64> = PHASES[..8].iter().map(|name| second(name)).collect();
        let wall = run.summary["wall_s"].as_f64().unwrap_or_default();
        // Phases are those of the slowest rank in each, and may add up to more.
        seconds.push((wall - seconds.iter().sum::<f64>()).max(0.0));
        seconds
    };
    (PHASES, runs.iter().map(of_run).collect())
}

/// Time and memory, predicted and measured.
pub fn costs(runs: &[Run]) -> Markup {
    let row = |what: &str, value: &dyn Fn(&Value) -> &Value| {
        (what.to_string(), runs.iter().map(|run| written(value(&run.summary))).collect())
    };
    // Of a run that ended early a ratio says nothing.
    let ratio = |key: &str| {
        let of_run = |run: &Run| match run.state {
            State::Converged => written(&run.summary["predicted"][key]),
            _ => UNKNOWN.into(),
        };
        ("measured over predicted".to_string(), runs.iter().map(of_run).collect())
    };
    let per_rank = |what: &str, key: &str| {
        let ranks = |run: &Run| {
            let values = run.summary["by_rank"][key].as_array().map(Vec::as_slice).unwrap_or_default();
            values.iter().map(written).collect::<Vec<_>>().join(", ")
        };
        (what.to_string(), runs.iter().map(ranks).collect())
    };
    let rows = [
        row("wall time, s", &|s| &s["wall_s"]),
        row("predicted, s", &|s| &s["predicted"]["wall_s"]),
        ratio("wall_ratio"),
        row("processor time of all ranks, s", &|s| &s["cpu_s"]),
        row("peak memory of all ranks, MB", &|s| &s["peak_memory_mb"]),
        row("predicted, MB", &|s| &s["predicted"]["memory_mb"]),
        ratio("memory_ratio"),
        per_rank("peak memory by rank, MB", "peak_memory_mb"),
        per_rank("messages by rank", "messages"),
        per_rank("sent by rank, MB", "sent_mb"),
    ];
    table(runs, &rows)
}

/// An estimated error: of what, how large, and why it is not to be trusted.
type Line = (String, String, String);

/// The estimated errors at the end of a step.
fn lines(estimate: &Value) -> Vec<Line> {
    let mut lines = Vec::new();
    let parts = |kind: &str| estimate[kind].as_object().into_iter().flatten();
    let doubts = |of: &Value| {
        let doubts = of["doubts"].as_array().into_iter().flatten().filter_map(Value::as_str);
        doubts.collect::<Vec<_>>().join("; ")
    };
    for (name, of) in parts("bodies") {
        lines.push((format!("energy of body {name}"), percent(&of["energy"]), doubts(of)));
    }
    for (name, of) in parts("contacts") {
        let force = format!("{}, {} of force", percent(&of["force"]), written(&of["force_size"]));
        lines.push((format!("force of contact {name}"), force, String::new()));
        lines.push((format!("pressure of contact {name}"), percent(&of["pressure"]), doubts(of)));
    }
    for (name, of) in parts("tools") {
        let force = of["force"].as_f64().map_or(String::new(), |force| format!(", {} of force", number(force)));
        lines.push((format!("surface of tool {name}"), format!("{}{force}", written(&of["length"])), String::new()));
    }
    for (kind, of) in estimate["increments"].as_object().into_iter().flatten() {
        for (name, errors) in of.as_object().into_iter().flatten() {
            let all = errors.as_object().into_iter().flatten();
            let all: Vec<String> = all.map(|(what, error)| format!("{what} {}", percent(error))).collect();
            lines.push((format!("increments, {} {name}", kind.trim_end_matches('s')), all.join(", "), String::new()));
        }
    }
    lines
}

/// The estimated errors of a run, step by step; `None` without any.
pub fn errors(run: &Run, name: &str) -> Option<Markup> {
    let steps = run.summary["estimate"].as_array().filter(|steps| !steps.is_empty())?;
    Some(html! {
        table {
            caption { "Estimated errors of " (name) }
            thead { tr {
                th scope="col" { "end of step" } th scope="col" { "error of" } th scope="col" { "estimate" }
                th scope="col" { "not to be trusted, for" }
            } }
            tbody {
                @for step in steps {
                    @for (of, size, doubts) in lines(step) {
                        tr { td { (written(&step["step"])) } th scope="row" { (of) } td { (size) } td { (doubts) } }
                    }
                }
            }
        }
    })
}
