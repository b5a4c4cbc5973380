//! Curves of runs over each other, in a panel of its own each, and bars.

use crate::error::Result;
use crate::output::figure::{Area, BLUE, DARK, FINE, FONT, RED, failed, tick};
use plotters::prelude::*;

/// Colours of runs, dark enough for lines on white.
const COLORS: [RGBColor; 8] = [
    BLUE,
    RGBColor(196, 84, 0),
    RGBColor(0, 120, 84),
    RGBColor(128, 56, 148),
    RED,
    RGBColor(0, 124, 146),
    RGBColor(122, 84, 30),
    RGBColor(90, 90, 90),
];

/// The colour of a run, by its number from 0.
pub fn color(run: usize) -> RGBColor {
    COLORS[run % COLORS.len()]
}

/// Pixels of the drawing for a pixel of the page: plotters rounds to whole ones.
const FINENESS: u32 = 2;
/// Width and height of a panel on the page.
const SIZE: (u32, u32) = (440, 260);

/// What a panel shows of a run.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Number of the run, from 0.
    pub run: usize,
    pub points: Vec<(f64, f64)>,
    /// Among the points: where increments had failed before.
    pub circles: Vec<(f64, f64)>,
    /// Among the points: jumps.
    pub crosses: Vec<(f64, f64)>,
    /// It bounds what other curves show.
    pub is_limit: bool,
}

/// Curves over each other.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What stands on the axis to the right.
    pub x: String,
    pub curves: Vec<Curve>,
    /// Upright lines.
    pub ends: Vec<f64>,
    pub is_logarithmic: bool,
    /// The curves bear the numbers of their runs.
    pub is_numbered: bool,
    /// Points are not joined.
    pub is_dotted: bool,
}

/// Draws a panel.
///
/// # Errors
/// [`crate::error::Error::System`] when the text cannot be made.
pub fn panel(panel: &Panel) -> Result<String> {
    drawn(SIZE, |area| curves(area, panel))
}

/// The text of a figure of so many pixels of the page.
fn drawn(size: (u32, u32), draw: impl FnOnce(&Area) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (FINENESS * size.0, FINENESS * size.1)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        draw(&root)?;
        root.present().map_err(failed)?;
    }
    Ok(text)
}

fn font(color: &RGBColor) -> TextStyle<'_> {
    (FONT, 14 * FINENESS).into_font().color(color)
}

fn curves(area: &Area, panel: &Panel) -> Result<()> {
    let place = |&(x, y): &(f64, f64)| (x, if panel.is_logarithmic { y.log10() } else { y });
    let shown = |points: &[(f64, f64)]| points.iter().map(place).collect::<Vec<_>>();
    let all: Vec<(f64, f64)> = panel.curves.iter().flat_map(|curve| shown(&curve.points)).collect();
    let origin = (panel.x == "time").then_some(0.0);
    let (left, right) = range(all.iter().map(|p| p.0).chain(origin), 0.0);
    let (bottom, top) = range(all.iter().map(|p| p.1), 0.06);
    let mut chart = ChartBuilder::on(area)
        .margin(6 * FINENESS)
        .margin_top(10 * FINENESS) // half of a number stands above its line
        .margin_right(16 * FINENESS)
        .x_label_area_size(36 * FINENESS)
        .y_label_area_size(60 * FINENESS)
        .build_cartesian_2d(left..right, bottom..top)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FINE)
        .axis_style(DARK)
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|x| tick(*x, right - left))
        .y_label_formatter(&|y| if panel.is_logarithmic { decade(*y) } else { tick(*y, top - bottom) })
        .x_desc(&panel.x)
        .label_style(font(&DARK))
        .axis_desc_style(font(&DARK))
        .draw()
        .map_err(failed)?;
    let ends = panel.ends.iter().filter(|end| (left..right).contains(*end));
    let uprights = ends.map(|&end| PathElement::new([(end, bottom), (end, top)], DARK.mix(0.35)));
    chart.draw_series(uprights).map_err(failed)?;
    if !panel.is_logarithmic && bottom < 0.0 && top > 0.0 {
        chart.draw_series([PathElement::new([(left, 0.0), (right, 0.0)], DARK.mix(0.6))]).map_err(failed)?;
    }
    let pixel = ((right - left) / f64::from(SIZE.0), (top - bottom) / f64::from(SIZE.1));
    let runs = 1 + panel.curves.iter().map(|curve| curve.run).max().unwrap_or_default();
    for curve in &panel.curves {
        let points = shown(&curve.points);
        let color = color(curve.run);
        // Where curves lie on each other, the first shows beside the later ones.
        let width = 2 * FINENESS + 2 * (runs - 1 - curve.run).min(3) as u32;
        let stroke = if curve.is_limit { color.mix(0.45).stroke_width(FINENESS) } else { color.stroke_width(width) };
        for piece in points.split(|p| !p.0.is_finite() || !p.1.is_finite()).filter(|piece| !piece.is_empty()) {
            let path = thinned(piece, pixel);
            if path.len() == 1 || panel.is_dotted && !curve.is_limit {
                let dots = path.iter().map(|&at| Circle::new(at, width / 2 + 2, color.filled()));
                chart.draw_series(dots).map_err(failed)?;
            } else {
                chart.draw_series([PathElement::new(path, stroke)]).map_err(failed)?;
            }
        }
        let circles = shown(&curve.circles).into_iter().map(|at| Circle::new(at, 4 * FINENESS, stroke));
        chart.draw_series(circles).map_err(failed)?;
        let crosses = shown(&curve.crosses).into_iter().map(|at| Cross::new(at, 5 * FINENESS, stroke));
        chart.draw_series(crosses).map_err(failed)?;
        if panel.is_numbered && !curve.is_limit && !points.is_empty() {
            // Each at another place, lest they cover each other where curves do.
            let at = points[((curve.run as f64 + 0.5) / runs as f64 * points.len() as f64) as usize];
            let offset = (3 * FINENESS as i32, -15 * FINENESS as i32);
            let number = EmptyElement::at(at) + Text::new((curve.run + 1).to_string(), offset, font(&color));
            chart.draw_series([number]).map_err(failed)?;
        }
    }
    Ok(())
}

/// From the least to the largest, and a part of that more to both sides.
fn range(values: impl Iterator<Item = f64>, more: f64) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return (0.0, 1.0);
    }
    let wide = (high - low).max(1e-9 * low.abs().max(high.abs()));
    let wide = if wide > 0.0 { wide } else { 1.0 };
    let more = if high - low < wide { 0.5 * wide } else { more * wide };
    (low - more, high + more)
}

/// Without points that lie within half a pixel of the last one that is kept.
fn thinned(points: &[(f64, f64)], pixel: (f64, f64)) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (k, &(x, y)) in points.iter().enumerate() {
        let is_near = |last: &&(f64, f64)| (x - last.0).abs() < 0.5 * pixel.0 && (y - last.1).abs() < 0.5 * pixel.1;
        if k + 1 == points.len() || kept.last().filter(is_near).is_none() {
            kept.push((x, y));
        }
    }
    kept
}

/// The number whose logarithm to the base 10 this is.
fn decade(exponent: f64) -> String {
    let text = format!("{:.0e}", 10f64.powf(exponent));
    if exponent.fract().abs() < 1e-9 { text } else { format!("{:.1e}", 10f64.powf(exponent)) }
}

/// Height of a bar on the page, and of the space below the bars of a name.
const BAR: (u32, u32) = (14, 8);
/// Width of bars and names, and of names alone.
const BARS: (u32, u32) = (640, 90);

/// Draws, below each other, names with a bar a run each.
///
/// # Errors
/// [`crate::error::Error::System`] when the text cannot be made.
pub fn bars(names: &[&str], values: &[Vec<f64>], write: impl Fn(f64) -> String) -> Result<String> {
    let group = BAR.0 * values.len() as u32 + BAR.1;
    let most = values.iter().flatten().copied().fold(0.0, f64::max);
    let fine = |n: u32| (n * FINENESS) as i32;
    drawn((BARS.0, group * names.len() as u32 + 4), |area| {
        for (k, name) in names.iter().enumerate() {
            let top = k as u32 * group + 4;
            area.draw_text(name, &font(&DARK), (fine(4), fine(top))).map_err(failed)?;
            for (run, of_run) in values.iter().enumerate() {
                let value = of_run.get(k).copied().unwrap_or_default();
                let share = if most > 0.0 { value / most } else { 0.0 };
                let right = fine(BARS.1) + (share * f64::from(fine(BARS.0 - BARS.1 - 80))) as i32;
                let y = top + BAR.0 * run as u32;
                let corners = [(fine(BARS.1), fine(y + 1)), (right, fine(y + BAR.0 - 1))];
                area.draw(&Rectangle::new(corners, color(run).filled())).map_err(failed)?;
                area.draw_text(&write(value), &font(&DARK), (right + fine(5), fine(y))).map_err(failed)?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_all_values_and_have_a_width() {
        assert_eq!(range([1.0, 3.0, f64::NAN].into_iter(), 0.5), (0.0, 4.0));
        for values in [vec![], vec![0.0], vec![7.0, 7.0], vec![-1e300], vec![f64::INFINITY]] {
            let (low, high) = range(values.iter().copied(), 0.1);
            assert!(low < high && values.iter().all(|v| !v.is_finite() || (low..high).contains(v)), "{values:?}");
        }
    }

    #[test]
    fn thinned_curves_keep_their_ends_and_what_stands_out() {
        let mut points: Vec<(f64, f64)> = (0..1000).map(|k| (1e-3 * f64::from(k), 0.0)).collect();
        points[500].1 = 1.0;
        let kept = thinned(&points, (0.1, 0.1));
        assert!(kept.len() < 40 && kept.contains(&points[500]), "{}", kept.len());
        assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[999]));
    }

    #[test]
    fn what_is_not_a_number_is_a_gap_in_the_curve() {
        let points = vec![(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 4.0), (4.0, 1.0)];
        let curve = Curve { run: 0, points, circles: vec![], crosses: vec![], is_limit: false };
        let shown = Panel {
            x: "time".into(),
            curves: vec![curve],
            ends: vec![],
            is_logarithmic: false,
            is_numbered: false,
            is_dotted: false,
        };
        // Paths of the width of curves.
        let paths = |panel: &Panel| super::panel(panel).unwrap().matches("stroke-width=\"4\"").count();
        assert_eq!(paths(&shown), 2);
        let whole = Curve { points: vec![(0.0, 1.0), (4.0, 1.0)], ..shown.curves[0].clone() };
        assert_eq!(paths(&Panel { curves: vec![whole], ..shown }), 1);
    }
}
