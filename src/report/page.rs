//! The page: sections of tables and figures.

use super::curves::{self, Figure, Group};
use super::differences::differences;
use super::plot;
use super::run::{Run, State};
use super::tables::{self, name, number};
use crate::error::Result;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Failed tries and jumps of a run that a page lists at most.
const TROUBLES: usize = 100;

/// What columns are.
const FORCES: &str = "Of tools the force on the bodies, of sets that of the support on the body, of contacts that of the master on the slave.";
const CONTACTS: &str = "Slave nodes in contact (active), sticking and slipping; without friction all slip. The largest \
                        depth of a node behind the master, and the largest nodal pressure.";

/// The page of runs, of which there is one at least.
///
/// # Errors
/// [`crate::error::Error::System`] when a figure cannot be made.
pub fn render(runs: &[Run]) -> Result<String> {
    let sections = [
        ("runs", "Runs", standing(runs)),
        ("model", "Model", model(runs)),
        ("forces", "Forces", groups(runs, &curves::forces(runs), FORCES)?),
        ("contacts", "Contacts", groups(runs, &curves::contacts(runs), CONTACTS)?),
        ("more", "More curves", groups(runs, &curves::others(runs), "")?),
        ("increments", "Increments", increments(runs)?),
        ("convergence", "Convergence", convergence(runs)?),
        ("costs", "Time and memory", costs(runs)?),
        ("errors", "Estimated errors", errors(runs)),
        ("pictures", "Pictures", pictures(runs)),
        ("scenes", "Scene", scenes(runs)),
    ];
    let sections: Vec<_> = sections.into_iter().filter(|(_, _, content)| !content.0.is_empty()).collect();
    let is_one = runs.iter().all(|run| run.title == runs[0].title);
    let title = if is_one { runs[0].title.clone() } else { format!("{} runs of nagata", runs.len()) };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content={ "nagata " (env!("CARGO_PKG_VERSION")) };
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                header {
                    h1 { (title) }
                    nav aria-label="Sections" { @for (id, name, _) in &sections { a href={ "#" (id) } { (name) } } }
                }
                main {
                    @for (id, name, content) in &sections {
                        section id=(id) aria-labelledby={ (id) "-name" } {
                            h2 id={ (id) "-name" } { (name) }
                            (content)
                        }
                    }
                }
            }
        }
    };
    Ok(page.into_string() + "\n")
}

fn standing(runs: &[Run]) -> Markup {
    let why = |run: &Run| match &run.state {
        State::Failed(why) | State::Interrupted(why) => Some(why.clone()),
        _ => None,
    };
    html! {
        @if runs.len() > 1 { p { "Curves bear the numbers of their runs. " (key(runs, |_| true)) } }
        @for (k, run) in runs.iter().enumerate() {
            @if let Some(why) = why(run) {
                div class="trouble" { h3 { (name(runs, k, run)) ": " (tables::state(run)) } pre { (why) } }
            }
        }
        (tables::overview(runs))
        @for (k, run) in runs.iter().enumerate().filter(|(_, run)| !run.told.warnings.is_empty()) {
            div class="trouble" {
                h3 { "Warnings of " (name(runs, k, run)) }
                ul { @for warning in &run.told.warnings { li { (warning) } } }
            }
        }
    }
}

/// Which colour is whose, of those that are `shown`.
fn key(runs: &[Run], shown: impl Fn(usize) -> bool) -> Markup {
    html! {
        @for (k, run) in runs.iter().enumerate().filter(|(k, _)| shown(*k)) {
            @let plotters::style::RGBColor(red, green, blue) = plot::color(k);
            span class="key" style={ "border-color: rgb(" (red) "," (green) "," (blue) ")" } { (name(runs, k, run)) }
        }
    }
}

fn model(runs: &[Run]) -> Markup {
    let same = runs.iter().all(|run| run.told.model == runs[0].told.model);
    html! {
        @for (k, run) in runs.iter().enumerate().take(if same { 1 } else { runs.len() }) {
            @if !same { h3 { (name(runs, k, run)) } }
            pre { (run.told.model.join("\n")) }
        }
    }
}

fn groups(runs: &[Run], groups: &[Group], note: &str) -> Result<Markup> {
    let parts = groups.iter().map(|group| part(runs, group)).collect::<Result<Vec<_>>>()?;
    Ok(html! {
        @if !parts.is_empty() && !note.is_empty() { p class="note" { (note) } }
        @for part in parts { (part) }
    })
}

fn part(runs: &[Run], group: &Group) -> Result<Markup> {
    let figures = figures(runs, &group.figures)?;
    Ok(html! {
        @if !group.name.is_empty() { h3 { (group.name) } }
        (figures)
        (extremes(runs, &group.figures))
        @if !group.zeros.is_empty() { p class="note" { "Zero throughout: " (group.zeros.join(", ")) } }
    })
}

fn figures(runs: &[Run], figures: &[Figure]) -> Result<Markup> {
    let drawn = figures.iter().map(|figure| drawn(runs, figure)).collect::<Result<Vec<_>>>()?;
    Ok(html! { @if !drawn.is_empty() { div class="grid" { @for figure in drawn { (figure) } } } })
}

fn drawn(runs: &[Run], figure: &Figure) -> Result<Markup> {
    let shows = |run: usize| figure.panel.curves.iter().any(|curve| curve.run == run);
    let all = (0..runs.len()).all(shows);
    let svg = plot::panel(&figure.panel)?;
    Ok(html! {
        figure {
            figcaption {
                strong { (figure.column) } " over " (figure.panel.x)
                @if !all { ", only of " (key(runs, shows)) }
            }
            div role="img" aria-label=(in_words(runs, figure)) { (PreEscaped(svg)) }
        }
    })
}

/// A value of a curve with where it stands.
type At = (f64, f64);

/// The least, the largest and the last value of a curve; `None` without any that is a number.
fn ends_of(points: &[At]) -> Option<[At; 3]> {
    let finite = || points.iter().copied().filter(|point| point.1.is_finite());
    let least = finite().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
    let most = finite().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    Some([least, most, *points.last()?])
}

/// What a figure shows, for those who do not see it.
fn in_words(runs: &[Run], figure: &Figure) -> String {
    let mut words = format!("Curve of {} over {}", figure.column, figure.panel.x);
    for curve in figure.panel.curves.iter().filter(|curve| !curve.is_limit) {
        let name = name(runs, curve.run, &runs[curve.run]);
        if let Some(ends) = ends_of(&curve.points) {
            let [least, most, last] = ends.map(|(x, y)| format!("{} at {}", number(y), number(x)));
            words += &format!("; {name}: least {least}, largest {most}, last {last}");
        }
    }
    words
}

/// The least, the largest and the last value of the columns over time.
fn extremes(runs: &[Run], figures: &[Figure]) -> Markup {
    let over_time = figures.iter().filter(|figure| figure.panel.x == "time");
    let curves = over_time.flat_map(|figure| figure.panel.curves.iter().map(move |curve| (&figure.column, curve)));
    let rows: Vec<_> =
        curves.filter_map(|(column, curve)| Some((column, curve.run, ends_of(&curve.points)?))).collect();
    html! {
        @if !rows.is_empty() {
            table {
                thead { tr {
                    @for head in ["column", "run", "least", "at time", "largest", "at time", "last"] {
                        @if head != "run" || runs.len() > 1 { th scope="col" { (head) } }
                    }
                } }
                tbody {
                    @for (column, run, [least, most, last]) in rows {
                        tr {
                            th scope="row" { (column) }
                            @if runs.len() > 1 { td { (run + 1) } }
                            td { (number(least.1)) } td { (number(least.0)) }
                            td { (number(most.1)) } td { (number(most.0)) }
                            td { (number(last.1)) }
                        }
                    }
                }
            }
        }
    }
}

fn increments(runs: &[Run]) -> Result<Markup> {
    let figures = figures(runs, curves::increments(runs).as_slice())?;
    Ok(html! {
        (figures)
        @if !figures.0.is_empty() {
            p class="note" {
                "A circle: tries had failed before it. A cross: the structure jumped to another equilibrium. "
                "Upright lines: ends of steps."
            }
        }
        @for (k, run) in runs.iter().enumerate().filter(|(_, run)| !run.told.troubles.is_empty()) {
            h3 { "Failed tries and jumps of " (name(runs, k, run)) }
            table {
                thead { tr { th scope="col" { "after increment" } th scope="col" { "what happened" } } }
                tbody {
                    @for (increment, what) in run.told.troubles.iter().take(TROUBLES) {
                        tr { td { (increment) } td { (what) } }
                    }
                }
            }
            @if run.told.troubles.len() > TROUBLES {
                p class="note" { "and " (run.told.troubles.len() - TROUBLES) " more, in log.txt" }
            }
        }
    })
}

fn convergence(runs: &[Run]) -> Result<Markup> {
    let figures = figures(runs, &curves::convergence(runs))?;
    Ok(html! {
        (figures)
        @if !figures.0.is_empty() {
            p class="note" {
                "Newton iterations of each converged increment, and the largest residual of the last one over the forces of "
                "its body, contact or tool; the pale line is what was let through."
            }
        }
    })
}

fn costs(runs: &[Run]) -> Result<Markup> {
    if runs.iter().all(|run| run.summary.is_null()) {
        return Ok(html! {});
    }
    let (names, seconds) = tables::phases(runs);
    let svg = plot::bars(&names, &seconds, |s| format!("{} s", number(s)))?;
    let words: Vec<String> = (runs.iter().enumerate().zip(&seconds))
        .map(|((k, run), of_run)| {
            let parts = names.iter().zip(of_run).map(|(phase, s)| format!("{phase} {} s", number(*s)));
            format!("{}: {}", name(runs, k, run), parts.collect::<Vec<_>>().join(", "))
        })
        .collect();
    Ok(html! {
        figure class="wide" {
            figcaption { strong { "Wall time by phase" } ", of the rank that took longest in each" }
            div role="img" aria-label=(words.join("; ")) { (PreEscaped(svg)) }
        }
        (tables::costs(runs))
    })
}

fn errors(runs: &[Run]) -> Markup {
    html! { @for (k, run) in runs.iter().enumerate() { @if let Some(table) = tables::errors(run, &name(runs, k, run)) { (table) } } }
}

fn pictures(runs: &[Run]) -> Markup {
    if runs.iter().all(|run| run.pictures.is_empty()) {
        return html! {};
    }
    html! {
        div class="grid" {
            @for (k, run) in runs.iter().enumerate() {
                @for picture in &run.pictures {
                    figure {
                        img alt={ "Picture " (picture.name) " of " (name(runs, k, run)) }
                            src={ "data:image/png;base64," (picture.base64) };
                        figcaption {
                            (name(runs, k, run)) ": " (picture.name)
                            @if picture.is_older { ", older than this run" }
                        }
                    }
                }
            }
        }
    }
}

fn scenes(runs: &[Run]) -> Markup {
    let differences = differences(runs);
    html! {
        @if !differences.is_empty() {
            table {
                caption { "Where the scenes differ" }
                thead { tr { th scope="col" { "entry" } @for (k, run) in runs.iter().enumerate() { th scope="col" { (name(runs, k, run)) } } } }
                tbody {
                    @for (entry, values) in &differences {
                        tr { th scope="row" { code { (entry) } } @for value in values { td { (value.as_deref().unwrap_or("–")) } } }
                    }
                }
            }
        }
        @for (k, run) in runs.iter().enumerate() {
            details { summary { "Scene of " (name(runs, k, run)) } pre { (run.scene) } }
        }
    }
}
