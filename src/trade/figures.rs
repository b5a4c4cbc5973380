//! `wall.svg`, `cpu.svg`, `memory.svg`: errors against a cost, a panel a quantity.

use super::errors::Quantity;
use super::sheet::{Price, Row, Sheet};
use crate::error::Result;
use crate::output::figure::{Area, BLUE, DARK, FINE, FONT, HEAD, RED, failed, titled};
use plotters::prelude::*;

const GREY: RGBColor = RGBColor(150, 158, 166);
const ORANGE: RGBColor = RGBColor(214, 126, 20);
const BAND: RGBColor = RGBColor(243, 236, 224);

/// Width and height of a panel, width of the list of runs, and height of one of its lines.
const PANEL: (u32, u32) = (430, 300);
const LIST: u32 = 340;
const LINE: u32 = 18;

/// Draws the errors of all quantities for people against a price.
///
/// # Errors
/// [`crate::error::Error::System`] when the text cannot be made.
pub fn fronts(title: &str, sheet: &Sheet, price: Price) -> Result<String> {
    let quantities: Vec<Quantity> = sheet.shown().collect();
    let columns = if quantities.len() > 1 { 2 } else { 1 };
    let lines = quantities.len().div_ceil(columns).max(1);
    let runs = (sheet.rows.len() + sheet.failures.len() + 5) as u32;
    let height = HEAD + (PANEL.1 * lines as u32).max(LINE * runs);
    titled(title, (PANEL.0 * columns as u32 + LIST, height), |body| {
        let (panels, list) = body.split_horizontally(PANEL.0 * columns as u32);
        let (panels, _) = panels.split_vertically(PANEL.1 * lines as u32);
        for (area, of) in panels.split_evenly((lines, columns)).iter().zip(quantities) {
            panel(area, sheet, price, of)?;
        }
        legend(&list, sheet, price)
    })
}

/// The least and the largest that a logarithmic axis shows: all values, and a little more.
fn range(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let low = values.clone().filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
    let high = values.fold(0.0, f64::max);
    if low > high {
        return (0.1, 10.0);
    }
    let more = (high / low).powf(0.08).max(1.15);
    (low / more, high * more)
}

/// Decades of an axis of errors; what is smaller stands at its lower end.
const DECADES: f64 = 1e-12;

fn panel(area: &Area, sheet: &Sheet, price: Price, of: Quantity) -> Result<()> {
    let floor = sheet.floor.get(of).filter(|_| !sheet.exact.contains(&of) && !of.is_absolute());
    let error = |row: &Row| row.errors.get(of).or(floor.filter(|_| row.is_reference)).filter(|e| e.is_finite());
    let points: Vec<(&Row, f64)> = sheet.rows.iter().filter_map(|row| Some((row, error(row)?))).collect();
    let most = points.iter().map(|(_, error)| *error).fold(0.0, f64::max);
    let least = most * DECADES;
    let (left, right) = range(points.iter().map(|(row, _)| price.of(&row.cost)));
    let (bottom, top) = range(points.iter().map(|(_, error)| error.max(least)).chain(floor));
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(24)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d((left..right).log_scale(), (bottom..top).log_scale())
        .map_err(failed)?;
    if let Some(floor) = floor.filter(|floor| *floor > bottom) {
        let band = Rectangle::new([(left, bottom), (right, floor)], BAND.filled());
        chart.draw_series([band]).map_err(failed)?;
    }
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FINE)
        .axis_style(DARK)
        .x_labels(5)
        .y_labels(6)
        .x_label_formatter(&|x| tick(*x))
        .y_label_formatter(&|y| tick(*y))
        .x_desc(price.name())
        .y_desc(describe(sheet, of))
        .label_style((FONT, 13).into_font().color(&DARK))
        .axis_desc_style((FONT, 15).into_font().color(&DARK))
        .draw()
        .map_err(failed)?;
    let place = |(row, error): &(&Row, f64)| (price.of(&row.cost), error.max(least));
    let on = |row: &Row| row.on_front[price as usize][of as usize];
    let mut front: Vec<(f64, f64)> = points.iter().filter(|(row, _)| on(row)).map(place).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart.draw_series([PathElement::new(stairs(&front), BLUE.stroke_width(2))]).map_err(failed)?;
    for point in &points {
        let (row, at) = (point.0, place(point));
        let color = if row.is_reference {
            ORANGE
        } else if on(row) {
            BLUE
        } else {
            GREY
        };
        chart.draw_series([Circle::new(at, 4, color.filled())]).map_err(failed)?;
        let style = (FONT, 12).into_font().color(&if on(row) { BLUE } else { DARK });
        let number = EmptyElement::at(at) + Text::new(row.number.to_string(), (6, -12), style);
        chart.draw_series([number]).map_err(failed)?;
    }
    Ok(())
}

/// The corners of a line that falls in steps: between two runs of the front there is none better than the left one.
fn stairs(front: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let steps = front.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    steps.chain(front.last().copied()).collect()
}

fn describe(sheet: &Sheet, of: Quantity) -> String {
    match (of.is_absolute(), sheet.exact.contains(&of)) {
        (true, _) => format!("{}, length", of.name()),
        (false, true) => format!("error of {}, exact", of.name()),
        (false, false) => format!("error of {}", of.name()),
    }
}

/// The runs by their numbers, and those that failed.
fn legend(area: &Area, sheet: &Sheet, price: Price) -> Result<()> {
    let mut top = 8;
    let mut line = |text: String, color: RGBColor| {
        let style = (FONT, 13).into_font().color(&color);
        let drawn = area.draw_text(&text, &style, (8, top)).map_err(failed);
        top += LINE as i32;
        drawn
    };
    for row in &sheet.rows {
        let any = sheet.shown().any(|of| row.on_front[price as usize][of as usize]);
        let color = if row.is_reference {
            ORANGE
        } else if any {
            BLUE
        } else {
            DARK
        };
        line(short(&format!("{}  {}", row.number, row.made.variant.label)), color)?;
    }
    for (number, made) in &sheet.failures {
        line(short(&format!("{number}  {}: failed", made.variant.label)), RED)?;
    }
    line("blue: no run is cheaper and no worse".into(), BLUE)?;
    line("orange: the reference, at what it may be off".into(), ORANGE)
}

/// A text that fits into the list.
fn short(text: &str) -> String {
    const MOST: usize = 48;
    if text.chars().count() <= MOST { text.into() } else { text.chars().take(MOST - 3).chain("...".chars()).collect() }
}

/// A number on a logarithmic axis.
fn tick(value: f64) -> String {
    if (0.01..10_000.0).contains(&value) {
        let text = format!("{value:.3}");
        return text.trim_end_matches('0').trim_end_matches('.').to_string();
    }
    let text = format!("{value:.1e}");
    text.replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_all_values() {
        let (low, high) = range([0.5, 2.0, 0.0].into_iter());
        assert!(low < 0.5 && low > 0.4 && high > 2.0 && high < 2.5, "{low} {high}");
        let (low, high) = range([3.0].into_iter());
        assert!(low < 3.0 && high > 3.0);
        assert_eq!(range([0.0].into_iter()), (0.1, 10.0));
    }

    #[test]
    fn stairs_fall_at_the_next_run() {
        assert_eq!(stairs(&[(1.0, 9.0), (2.0, 4.0)]), [(1.0, 9.0), (2.0, 9.0), (2.0, 4.0)]);
        assert!(stairs(&[]).is_empty());
    }

    #[test]
    fn ticks_are_short() {
        assert_eq!([0.02, 1.5, 300.0, 1e-5, 2.5e4].map(tick), ["0.02", "1.5", "300", "1e-5", "2.5e4"]);
    }
}
