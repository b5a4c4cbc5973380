//! The sheet as text for the terminal, as Markdown, and as CSV.

use super::child::Ended;
use super::errors::Quantity;
use super::plan::{Plan, Variant};
use super::sheet::{Price, Row, Sheet};
use std::fmt::Write as _;

/// A run's error, in a few letters: `*` on the front of wall time, in brackets what cannot be told from the reference.
fn cell(sheet: &Sheet, row: &Row, of: Quantity) -> String {
    let Some(error) = row.errors.get(of) else {
        let own = sheet.floor.get(of).filter(|_| row.is_reference);
        return own.map_or(String::new(), |own| format!("±{own:.1e}"));
    };
    let star = if row.on_front[Price::Wall as usize][of as usize] { " *" } else { "" };
    if error == 0.0 {
        return format!("0{star}");
    }
    if error < sheet.least(of) { format!("({error:.1e}){star}") } else { format!("{error:.1e}{star}") }
}

fn head(of: Quantity) -> String {
    if of.is_absolute() { format!("{}, length", of.name()) } else { of.name().to_string() }
}

/// How a run failed, in a line.
fn failure(ended: &Ended) -> String {
    match ended.code {
        Some(code) => format!("exit code {code}: {}", ended.reason),
        None => ended.reason.clone(),
    }
}

/// The heads and the cells of all runs that converged.
fn cells(sheet: &Sheet) -> Vec<Vec<String>> {
    let mut heads: Vec<String> = ["", "run", "wall s", "CPU s", "MB", "iterations"].map(String::from).to_vec();
    heads.extend(sheet.shown().map(head));
    let row = |row: &Row| {
        let cost = &row.cost;
        let mut cells = vec![row.number.to_string(), row.made.variant.label.clone()];
        cells.extend([seconds(cost.wall_s), seconds(cost.cpu_s), format!("{:.0}", cost.memory_mb)]);
        cells.push(cost.iterations.to_string());
        cells.extend(sheet.shown().map(|of| cell(sheet, row, of)));
        cells
    };
    std::iter::once(heads).chain(sheet.rows.iter().map(row)).collect()
}

fn seconds(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds:.2}") } else { format!("{seconds:.1}") }
}

const LEGEND: &str = "*: no run is faster and no worse. (...): cannot be told from the reference. ±: what the reference may be \
                      off itself.";

/// What is printed.
pub fn text(sheet: &Sheet, plan: &Plan) -> String {
    let cells = cells(sheet);
    let width = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = (0..cells[0].len()).map(width).collect();
    let mut text = String::new();
    for row in &cells {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, &width))| match k {
            1 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    let _ = writeln!(text, "{LEGEND}");
    for (number, made) in &sheet.failures {
        let _ = writeln!(text, "{number}  {}: failed, {}", made.variant.label, failure(&made.ended));
    }
    text + &left_out(plan)
}

fn left_out(plan: &Plan) -> String {
    match plan.left_out.as_slice() {
        [] => String::new(),
        all => format!("left out, as they would take too long (--budget): {}\n", all.join("; ")),
    }
}

/// `trade.md`.
pub fn markdown(title: &str, sheet: &Sheet, plan: &Plan) -> String {
    let mut text = format!("# {title}\n\n");
    let mut lines = cells(sheet).into_iter();
    let heads = lines.next().unwrap_or_default();
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    text += &line(&heads);
    text += &line(&vec!["---".to_string(); heads.len()]);
    lines.for_each(|cells| text += &line(&cells));
    let _ = writeln!(text, "\n{LEGEND}");
    if !sheet.exact.is_empty() {
        let exact: Vec<&str> = sheet.exact.iter().map(|of| of.name()).collect();
        let _ = writeln!(text, "Against exact values: {}.", exact.join(", "));
    }
    if !sheet.failures.is_empty() {
        text += "\nFailed:\n\n";
        for (number, made) in &sheet.failures {
            let _ = writeln!(text, "- {number}, {}: {}", made.variant.label, failure(&made.ended));
        }
    }
    if !plan.left_out.is_empty() {
        let _ = write!(text, "\n{}", left_out(plan));
    }
    text += "\nWhat the runs change:\n\n";
    let all = sheet.rows.iter().map(|row| (row.number, row.made)).chain(sheet.failures.iter().copied());
    for (number, made) in all {
        let Variant { label, overrides, .. } = &made.variant;
        let changes = match overrides.as_slice() {
            [] => "nothing".to_string(),
            all => format!("`{}`", all.join("` `")),
        };
        let _ = writeln!(text, "- {number}, {label}: {changes}");
    }
    text
}

/// `trade.csv`: a row a run; `front` columns have the prices (wall, cpu, memory) on whose front of the quantity it is. The row
/// of the kind `reference error` has how far the reference is off itself.
pub fn csv(sheet: &Sheet) -> String {
    let name = |of: &Quantity| of.name().replace(' ', "_");
    let mut text = "number,run,kind,code,reason,overrides,wall_s,cpu_s,memory_mb,increments,iterations".to_string();
    for of in &sheet.quantities {
        let _ = write!(text, ",{0},{0}_front", name(of));
    }
    text.push('\n');
    for row in &sheet.rows {
        let (made, cost) = (row.made, &row.cost);
        let kind = if row.is_reference { "reference" } else { "run" };
        text += &begin(row.number, &made.variant, kind, &made.ended);
        let costs = (cost.wall_s, cost.cpu_s, cost.memory_mb, cost.increments, cost.iterations);
        let _ = write!(text, ",{},{},{},{},{}", costs.0, costs.1, costs.2, costs.3, costs.4);
        for &of in &sheet.quantities {
            let prices = Price::ALL.iter().zip(["wall", "cpu", "memory"]);
            let on: Vec<&str> = prices.filter(|(p, _)| row.on_front[**p as usize][of as usize]).map(|p| p.1).collect();
            let _ = write!(text, ",{},{}", number(row.errors.get(of)), on.join(" "));
        }
        text.push('\n');
    }
    for (number, made) in &sheet.failures {
        text += &begin(*number, &made.variant, "failed", &made.ended);
        text += &",".repeat(5 + 2 * sheet.quantities.len());
        text.push('\n');
    }
    text += &format!(",,reference error{}", ",".repeat(8));
    sheet.quantities.iter().for_each(|&of| text += &format!(",{},", number(sheet.floor.get(of))));
    text.push('\n');
    text
}

fn begin(number: usize, variant: &Variant, kind: &str, ended: &Ended) -> String {
    let code = ended.code.map_or(String::new(), |code| code.to_string());
    let [label, reason, overrides] = [&variant.label, &ended.reason, &variant.overrides.join(" ")].map(|t| quoted(t));
    format!("{number},{label},{kind},{code},{reason},{overrides}")
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{value:e}"))
}

/// A text cell as RFC 4180 has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
