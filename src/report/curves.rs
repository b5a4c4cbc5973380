//! Which curves a page shows: columns of the histories of all runs, over time or over each other.

use super::plot::{Curve, Panel};
use super::run::Run;
use crate::output::history::{DISPLACEMENT, FORCE};

/// A figure: a panel, and whose columns it shows.
#[derive(Debug)]
pub struct Figure {
    /// The column that it shows.
    pub column: String,
    pub panel: Panel,
}

/// Figures under a heading.
#[derive(Debug, Default)]
pub struct Group {
    pub name: String,
    pub figures: Vec<Figure>,
    /// Columns that are zero throughout, and not drawn.
    pub zeros: Vec<String>,
}

/// Part of the largest of a vector's components below which another counts as zero.
const NOTHING: f64 = 1e-9;
/// Part of the largest motion of a tool or set below which a direction counts as still.
const STILL: f64 = 1e-3;

/// Columns of contacts, with what they count.
pub const CONTACT: [&str; 5] = ["active", "stick", "slip", "max_penetration", "max_pressure"];

/// Columns that have figures of their own, or none.
const OWN: [&str; 7] = ["increment", "time", "iterations", "residual", "limit", "failures", "found"];

/// What is drawn of a column.
struct Manner<'a> {
    x: &'a str,
    /// The column whose absolute values bound it.
    limit: Option<&'a str>,
    is_logarithmic: bool,
    is_dotted: bool,
    /// Increments that had failed before, and jumps, are marked.
    is_marked: bool,
}

/// Against time.
const PLAIN: Manner = Manner { x: "time", limit: None, is_logarithmic: false, is_dotted: false, is_marked: false };

/// Forces of tools, sets and contacts, over time and over displacements.
pub fn forces(runs: &[Run]) -> Vec<Group> {
    sources(runs, FORCE[0]).into_iter().map(|source| force(runs, source)).collect()
}

fn force(runs: &[Run], source: String) -> Group {
    let column = |component: &str| format!("{source}.{component}");
    let sizes = FORCE.map(|component| size(runs, &column(component)));
    let most = sizes.into_iter().fold(0.0, f64::max);
    let (shown, zeros): (Vec<usize>, Vec<usize>) = (0..3).partition(|&d| sizes[d] > NOTHING * most);
    let mut figures: Vec<Figure> = shown.iter().filter_map(|&d| figure(runs, &column(FORCE[d]), &PLAIN)).collect();
    let travels = DISPLACEMENT.map(|component| travel(runs, &column(component)));
    let farthest = (0..3).max_by(|&a, &b| travels[a].total_cmp(&travels[b])).unwrap_or_default();
    for along in (0..3).filter(|&d| travels[d] > STILL * travels[farthest]) {
        for &d in shown.iter().filter(|&&d| d == along || along == farthest) {
            let x = column(DISPLACEMENT[along]);
            figures.extend(figure(runs, &column(FORCE[d]), &Manner { x: &x, ..PLAIN }));
        }
    }
    Group { figures, zeros: zeros.into_iter().map(|d| column(FORCE[d])).collect(), name: source }
}

/// Status, penetration and pressure of contacts over time.
pub fn contacts(runs: &[Run]) -> Vec<Group> {
    sources(runs, CONTACT[0]).into_iter().map(|source| group(runs, &source, &CONTACT)).collect()
}

/// What else stands in the histories, over time.
pub fn others(runs: &[Run]) -> Vec<Group> {
    let mut groups: Vec<(&str, Vec<&str>)> = Vec::new();
    let names = runs.iter().flat_map(|run| run.history.names()).filter(|name| !OWN.contains(&name.as_str()));
    for (source, end) in names.map(|name| name.rsplit_once('.').unwrap_or(("", name))) {
        if FORCE.contains(&end) || DISPLACEMENT.contains(&end) || CONTACT.contains(&end) {
            continue;
        }
        match groups.iter_mut().find(|(known, _)| *known == source) {
            Some((_, ends)) if ends.contains(&end) => {}
            Some((_, ends)) => ends.push(end),
            None => groups.push((source, vec![end])),
        }
    }
    groups.iter().map(|(source, ends)| group(runs, source, ends)).collect()
}

/// Sizes of increments over time, with marks where increments had failed before, and at jumps.
pub fn increments(runs: &[Run]) -> Option<Figure> {
    figure_of(runs, "size of increments", &Manner { is_marked: true, ..PLAIN }, |run, _| Some(sizes(run)))
}

/// Newton iterations, and the residual of the last one with what was let through, over time.
pub fn convergence(runs: &[Run]) -> Vec<Figure> {
    let iterations = Manner { is_dotted: true, ..PLAIN };
    let residual = Manner { limit: Some("limit"), is_logarithmic: true, ..iterations };
    [figure(runs, "iterations", &iterations), figure(runs, "residual", &residual)].into_iter().flatten().collect()
}

/// The size of each increment in time.
pub fn sizes(run: &Run) -> Vec<f64> {
    run.history.times().iter().scan(0.0, |last, &time| Some(time - std::mem::replace(last, time))).collect()
}

/// The times at which steps ended and others began.
fn ends(run: &Run) -> Vec<f64> {
    let mut rows = run.history.ends();
    rows.pop();
    rows.into_iter().map(|(_, row)| run.history.times()[row]).collect()
}

/// Columns of a source over time.
fn group(runs: &[Run], source: &str, ends: &[&str]) -> Group {
    let columns = ends.iter().map(|end| if source.is_empty() { end.to_string() } else { format!("{source}.{end}") });
    let known = columns.filter(|column| runs.iter().any(|run| run.history.column(column).is_some()));
    let (zeros, shown): (Vec<String>, Vec<String>) = known.partition(|column| size(runs, column) == 0.0);
    let figures = shown.iter().filter_map(|column| figure(runs, column, &PLAIN)).collect();
    Group { name: source.to_string(), figures, zeros }
}

/// Those with a column of this end in any of the runs.
fn sources(runs: &[Run], end: &str) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for source in runs.iter().flat_map(|run| run.history.sources(end)) {
        if !all.iter().any(|known| known == source) {
            all.push(source.to_string());
        }
    }
    all
}

/// The largest absolute value of a column in all runs.
fn size(runs: &[Run], column: &str) -> f64 {
    let values = runs.iter().filter_map(|run| run.history.column(column)).flatten();
    values.fold(0.0, |most, value| most.max(value.abs()))
}

/// How far a column goes in any of the runs, from 0 on.
fn travel(runs: &[Run], column: &str) -> f64 {
    let of_run = |values: &[f64]| {
        let (low, high) = values.iter().fold((0.0f64, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
        high - low
    };
    runs.iter().filter_map(|run| run.history.column(column)).map(of_run).fold(0.0, f64::max)
}

fn figure(runs: &[Run], column: &str, manner: &Manner) -> Option<Figure> {
    figure_of(runs, column, manner, |run, column| run.history.column(column).map(<[f64]>::to_vec))
}

/// A figure of what `values` finds in runs; `None` where none has any.
fn figure_of(
    runs: &[Run],
    column: &str,
    manner: &Manner,
    values: impl Fn(&Run, &str) -> Option<Vec<f64>>,
) -> Option<Figure> {
    let mut curves = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let Some(x) = run.history.column(manner.x) else { continue };
        let points = |y: Vec<f64>| x.iter().copied().zip(y).collect::<Vec<_>>();
        let curve = |points: Vec<(f64, f64)>, is_limit: bool| {
            let marked = |name: &str, is_marked: fn(f64) -> bool| -> Vec<(f64, f64)> {
                let marks = run.history.column(name).filter(|_| manner.is_marked && !is_limit).unwrap_or_default();
                points
                    .iter()
                    .zip(marks)
                    .filter(|&(_, &mark): &(_, &f64)| is_marked(mark))
                    .map(|(point, _)| *point)
                    .collect()
            };
            let (circles, crosses) = (marked("failures", |n| n > 0.0), marked("found", |how| how == 2.0));
            Curve { run: number, circles, crosses, points, is_limit }
        };
        curves.extend(values(run, column).map(|y| curve(points(y), false)));
        let limit = manner.limit.and_then(|limit| values(run, limit));
        curves.extend(limit.map(|y| curve(points(y), true)));
    }
    if curves.iter().all(|curve| curve.points.is_empty()) {
        return None;
    }
    let last = |run: &Run| run.history.times().last().copied().unwrap_or_default();
    let longest = runs.iter().max_by(|a, b| last(a).total_cmp(&last(b))).filter(|_| manner.x == "time");
    let panel = Panel {
        x: manner.x.to_string(),
        curves,
        ends: longest.map(ends).unwrap_or_default(),
        is_logarithmic: manner.is_logarithmic,
        is_numbered: runs.len() > 1,
        is_dotted: manner.is_dotted,
    };
    Some(Figure { column: column.to_string(), panel })
}

#[cfg(test)]
mod tests {
    use super::super::log::Told;
    use super::super::run::State;
    use super::*;
    use crate::output::history::History;

    fn run(text: &str) -> Run {
        Run {
            name: "out/a".into(),
            title: String::new(),
            scene: String::new(),
            state: State::Converged,
            told: Told::default(),
            history: History::parse(&format!("step,increment,time,iterations,{text}")).unwrap(),
            summary: serde_json::Value::Null,
            pictures: Vec::new(),
        }
    }

    fn columns(group: &Group) -> Vec<(&str, &str)> {
        group.figures.iter().map(|figure| (figure.panel.x.as_str(), figure.column.as_str())).collect()
    }

    /// A punch that goes down and along x, where it goes farther.
    #[test]
    fn forces_are_drawn_over_time_and_over_what_moves() {
        let a = run("punch.ux,punch.uy,punch.uz,punch.fx,punch.fy,punch.fz,residual,limit,failures,found\n\
                     press,1,0.5,4,0,0,-1,2,1e-14,-30,1e-9,1e-8,0,0\nslide,2,2,5,9,0,-1,7,0,-20,0,1e-8,3,2\n");
        let b = run("punch.fx,punch.fy,punch.fz,pad.plastic_work\npress,1,1,4,1,0,-25,0.5\n");
        let runs = [a, b];
        let groups = forces(&runs);
        let over_time = [("time", "punch.fx"), ("time", "punch.fz")];
        let over_way = [("punch.ux", "punch.fx"), ("punch.ux", "punch.fz"), ("punch.uz", "punch.fz")];
        assert_eq!(columns(&groups[0]), [&over_time[..], &over_way].concat());
        assert_eq!(groups[0].zeros, ["punch.fy"]);
        let curves = &groups[0].figures[1].panel.curves;
        assert_eq!((curves[0].run, &curves[0].points[..]), (0, &[(0.5, -30.0), (2.0, -20.0)][..]));
        assert_eq!((curves[1].run, &curves[1].points[..]), (1, &[(1.0, -25.0)][..]));
        assert_eq!(groups[0].figures[1].panel.ends, [0.5]);
        assert_eq!(groups[0].figures[4].panel.curves[0].points, [(-1.0, -30.0), (-1.0, -20.0)]);
        let more = others(&runs);
        assert_eq!((more.len(), columns(&more[0])), (1, vec![("time", "pad.plastic_work")]));
        assert_eq!(more[0].figures[0].panel.curves[0].run, 1);
    }

    #[test]
    fn increments_are_marked_where_tries_failed_and_at_jumps() {
        let runs = [run(
            "residual,limit,failures,found\na,1,0.5,4,1e-9,1e-8,2,0\na,2,0.75,4,1e-9,1e-8,1,2\na,3,1.75,4,0,1e-8,0,0\n",
        )];
        let sizes = &increments(&runs).unwrap().panel.curves[0];
        assert_eq!(sizes.points, [(0.5, 0.5), (0.75, 0.25), (1.75, 1.0)]);
        assert_eq!((&sizes.circles[..], &sizes.crosses[..]), (&sizes.points[..2], &sizes.points[1..2]));
        let limits: Vec<bool> = convergence(&runs)[1].panel.curves.iter().map(|curve| curve.is_limit).collect();
        assert_eq!(limits, [false, true]);
        assert!(increments(&[run("residual\n")]).is_none());
    }
}
