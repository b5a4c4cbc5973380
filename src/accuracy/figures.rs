//! `errors.svg` and `dead-zones.svg`.

use super::errors::{Projected, SampledPiece};
use crate::Vec3;
use crate::error::Result;
use crate::output::figure::{Area, BLUE, DARK, FINE, FONT, RED, failed, tick, titled};
use crate::surface::normals::tangents;
use plotters::prelude::*;

const GREY: RGBColor = RGBColor(205, 214, 222);
const ORANGE: RGBColor = RGBColor(236, 161, 55);

/// How a value is distributed: shares of the area in equal bins from `low` to `high`.
#[derive(Clone, Debug)]
pub struct Histogram {
    pub low: f64,
    pub high: f64,
    pub shares: Vec<f64>,
}

impl Histogram {
    /// Empty bins over a range, a little wider when it has no width.
    pub fn new(low: f64, high: f64) -> Self {
        const BINS: usize = 60;
        let wide = f64::max(1e-12, 1e-9 * low.abs().max(high.abs()));
        let (low, high) = if high - low > wide { (low, high) } else { (low - wide, high + wide) };
        Self { low, high, shares: vec![0.0; BINS] }
    }

    /// Adds a value with the share of the area that has it.
    pub fn add(&mut self, value: f64, share: f64) {
        let bins = self.shares.len();
        let at = (value - self.low) / (self.high - self.low) * bins as f64;
        self.shares[(at.max(0.0) as usize).min(bins - 1)] += share;
    }
}

/// Draws the distributions of distance error and normal error side by side.
///
/// # Errors
/// [`crate::error::Error::System`] when the text cannot be made.
pub fn errors(title: &str, distance: &Histogram, normal: &Histogram) -> Result<String> {
    titled(title, (1000, 380), |body| {
        let halves = body.split_evenly((1, 2));
        bars(&halves[0], distance, "distance error", "share of the area, %")?;
        bars(&halves[1], normal, "normal error, degrees", "")
    })
}

fn bars(area: &Area, histogram: &Histogram, name: &str, share: &str) -> Result<()> {
    let total: f64 = histogram.shares.iter().sum();
    let percent = |share: f64| if total > 0.0 { 100.0 * share / total } else { 0.0 };
    let top = 1.08 * histogram.shares.iter().map(|s| percent(*s)).fold(0.0, f64::max).max(1e-3);
    let width = (histogram.high - histogram.low) / histogram.shares.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(46)
        .y_label_area_size(58)
        .build_cartesian_2d(histogram.low..histogram.high, 0.0..top)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FINE)
        .axis_style(DARK)
        .x_labels(5)
        .y_labels(6)
        .x_label_formatter(&|x| tick(*x, histogram.high - histogram.low))
        .y_label_formatter(&|y| tick(*y, top))
        .x_desc(name)
        .y_desc(share)
        .label_style((FONT, 14).into_font().color(&DARK))
        .axis_desc_style((FONT, 16).into_font().color(&DARK))
        .draw()
        .map_err(failed)?;
    let bar = |(k, share): (usize, &f64)| {
        let left = histogram.low + k as f64 * width;
        Rectangle::new([(left, 0.0), (left + width, percent(*share))], BLUE.filled())
    };
    chart.draw_series(histogram.shares.iter().enumerate().filter(|(_, s)| **s > 0.0).map(bar)).map_err(failed)?;
    Ok(())
}

/// Tiles that a picture of dead zones has at most, unless there are more pieces.
const TILES: usize = 8_000;

/// Samples from one tile to the next: the least that leaves a picture of moderate size.
pub fn stride(pieces: usize, side: usize) -> usize {
    (1..side).find(|stride| pieces * (side - 1).div_ceil(*stride).pow(2) <= TILES).unwrap_or(side - 1)
}

/// A part of the surface between four samples and how much of it has normal projections: share on extended pieces only,
/// and share without any.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    pub corners: [Vec3; 4],
    pub normal: Vec3,
    /// Outside and inside.
    pub shares: [[f64; 2]; 2],
}

impl Tile {
    /// Length of [`Self::to_array`].
    pub const LEN: usize = 19;

    /// The tiles of a piece with `side` x `side` samples, each over `stride` x `stride` cells.
    pub fn of_piece(piece: &SampledPiece, side: usize, stride: usize) -> Vec<Self> {
        let next = |k: usize| (k + stride).min(side - 1);
        let tile = |j: usize, i: usize| {
            let corners =
                [(i, j), (next(i), j), (next(i), next(j)), (i, next(j))].map(|(i, j)| &piece.samples[j * side + i]);
            let cells = (j..next(j)).flat_map(|j| (i..next(i)).map(move |i| &piece.cells[j * (side - 1) + i]));
            let cells: Vec<&[Projected; 2]> = cells.collect();
            let share = |face: usize, kind: Projected| {
                cells.iter().filter(|cell| cell[face] == kind).count() as f64 / cells.len() as f64
            };
            Self {
                corners: corners.map(|sample| sample.point),
                normal: corners.iter().map(|sample| sample.normal * sample.share).sum(),
                shares: [0, 1].map(|face| [Projected::Extended, Projected::Dead].map(|kind| share(face, kind))),
            }
        };
        let firsts = || (0..side - 1).step_by(stride);
        firsts().flat_map(|j| firsts().map(move |i| (j, i))).map(|(j, i)| tile(j, i)).collect()
    }

    /// The tile as numbers, to be sent to another rank.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        for (k, corner) in self.corners.iter().chain([&self.normal]).enumerate() {
            array[3 * k..3 * k + 3].copy_from_slice(corner.as_slice());
        }
        array[15..].copy_from_slice(self.shares.as_flattened());
        array
    }

    /// The tile of [`Self::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let vector = |k: usize| Vec3::new(array[3 * k], array[3 * k + 1], array[3 * k + 2]);
        Self {
            corners: std::array::from_fn(vector),
            normal: vector(4),
            shares: [[array[15], array[16]], [array[17], array[18]]],
        }
    }
}

/// The direction from which a surface shows most of itself: against its mean normal, or aslant when it is nearly closed.
fn view_of(tiles: &[Tile]) -> Vec3 {
    let mean: Vec3 = tiles.iter().map(|tile| tile.normal).sum();
    let all: f64 = tiles.iter().map(|tile| tile.normal.norm()).sum();
    if mean.norm() > 0.1 * all { mean.normalize() } else { Vec3::new(1.0, -1.4, 0.9).normalize() }
}

/// Draws where points outside and inside have no normal projection, and their shares of all, from `dead`.
///
/// # Errors
/// [`crate::error::Error::System`] when the text cannot be made.
pub fn dead_zones(title: &str, tiles: &[Tile], dead: &[[f64; 2]; 2]) -> Result<String> {
    let view = view_of(tiles);
    let [right, up] = upright(&view);
    let mut seen: Vec<&Tile> = tiles.iter().filter(|tile| tile.normal.dot(&view) > 0.0).collect();
    let depth = |tile: &Tile| tile.corners.iter().map(|c| c.dot(&view)).sum::<f64>();
    seen.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    let flat = |x: &Vec3| (x.dot(&right), x.dot(&up));
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (x, y) in seen.iter().flat_map(|tile| tile.corners.iter().map(flat)) {
        low = [low[0].min(x), low[1].min(y)];
        high = [high[0].max(x), high[1].max(y)];
    }
    if seen.is_empty() {
        (low, high) = ([0.0; 2], [1.0; 2]);
    }
    titled(title, (1000, 580), |body| {
        let (body, foot) = body.split_vertically(510);
        for (side, (half, name)) in body.split_evenly((1, 2)).iter().zip(["outside", "inside"]).enumerate() {
            let caption = format!(
                "{name}: {:.2} % without normal projection, {:.2} % also with extension",
                100.0 * dead[side][0],
                100.0 * dead[side][1]
            );
            half.draw_text(&caption, &(FONT, 15).into_font().color(&DARK), (16, 8)).map_err(failed)?;
            let scale = (470.0 / (high[0] - low[0]).max(1e-300)).min(460.0 / (high[1] - low[1]).max(1e-300));
            let place = |x: &Vec3| {
                let (x, y) = flat(x);
                let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
                (250 + ((x - middle[0]) * scale).round() as i32, 270 - ((y - middle[1]) * scale).round() as i32)
            };
            for tile in &seen {
                let [extended, lost] = tile.shares[side];
                let color = mix(&[(GREY, 1.0 - extended - lost), (ORANGE, extended), (RED, lost)]);
                let corners: Vec<(i32, i32)> = tile.corners.iter().map(place).collect();
                half.draw(&Polygon::new(corners.clone(), color.filled())).map_err(failed)?;
                half.draw(&PathElement::new([&corners[..], &corners[..1]].concat(), color)).map_err(failed)?;
            }
        }
        legend(&foot)
    })
}

fn legend(area: &Area) -> Result<()> {
    let style = (FONT, 15).into_font().color(&DARK);
    for (k, (color, name)) in
        [(GREY, "normal projection"), (ORANGE, "on an extended piece only"), (RED, "none: dead zone")]
            .into_iter()
            .enumerate()
    {
        let left = 16 + 240 * k as i32;
        area.draw(&Rectangle::new([(left, 6), (left + 22, 22)], color.filled())).map_err(failed)?;
        area.draw_text(name, &style, (left + 30, 7)).map_err(failed)?;
    }
    Ok(())
}

fn mix(parts: &[(RGBColor, f64)]) -> RGBColor {
    let channel = |pick: fn(&RGBColor) -> u8| {
        parts.iter().map(|(color, share)| f64::from(pick(color)) * share).sum::<f64>().round() as u8
    };
    RGBColor(channel(|c| c.0), channel(|c| c.1), channel(|c| c.2))
}

/// Directions to the right and upwards in a picture seen against `view`: z, or y when looking along z, is up.
fn upright(view: &Vec3) -> [Vec3; 2] {
    let pole = if view.z.abs() < 0.9 { Vec3::z() } else { Vec3::y() };
    match pole.cross(view).try_normalize(1e-9) {
        Some(right) => [right, view.cross(&right)],
        None => tangents(view),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_fall_into_their_bins() {
        let mut histogram = Histogram::new(-1.0, 2.0);
        for (value, bin) in [(-1.0, 0), (2.0, 59), (0.0, 20), (1.999, 59), (-7.0, 0), (f64::NAN, 0)] {
            let before = histogram.shares[bin];
            histogram.add(value, 1.0);
            assert_eq!(histogram.shares[bin], before + 1.0);
        }
        let flat = Histogram::new(3.0, 3.0);
        assert!(flat.low < 3.0 && flat.high > 3.0);
        assert!(errors("flat", &flat, &histogram).unwrap().ends_with("</svg>\n"));
    }
}
