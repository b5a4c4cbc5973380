//! What all figures look like: SVG by plotters, a title over the drawing.

use crate::error::{Error, Result};
use plotters::coord::Shift;
use plotters::prelude::*;

pub const FONT: &str = "sans-serif";
pub const BLUE: RGBColor = RGBColor(31, 91, 143);
pub const RED: RGBColor = RGBColor(176, 32, 36);
/// Grid lines.
pub const FINE: RGBColor = RGBColor(226, 228, 230);
/// Axes and words.
pub const DARK: RGBColor = RGBColor(60, 60, 60);
/// Height of the title, pixels.
pub const HEAD: u32 = 36;

/// A part of a figure.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The text of a figure of so many pixels, below whose title `draw` draws.
///
/// # Errors
/// [`Error::System`] when the text cannot be made, or what `draw` returns.
pub fn titled(title: &str, size: (u32, u32), draw: impl FnOnce(&Area) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (head, body) = root.split_vertically(HEAD);
        head.draw_text(title, &(FONT, 18).into_font().color(&DARK), (16, 10)).map_err(failed)?;
        draw(&body)?;
        root.present().map_err(failed)?;
    }
    Ok(text)
}

/// What drawing fails with.
pub fn failed(error: impl std::fmt::Display) -> Error {
    Error::System(format!("cannot draw a figure: {error}"))
}

/// A number on an axis of length `range`: no more digits than it needs.
pub fn tick(value: f64, range: f64) -> String {
    if value.abs() < 1e-9 * range {
        return "0".into();
    }
    if (1e-2..1e4).contains(&range) {
        let digits = (2.0 - range.log10().floor()).max(0.0) as usize;
        let text = format!("{value:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.to_string();
    }
    let text = format!("{value:.2e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_no_digits_too_many() {
        let cases = [(0.25, 1.0, "0.25"), (10.0, 60.0, "10"), (-2e-4, 5e-4, "-2e-4"), (1e-20, 1.0, "0")];
        for (value, range, text) in cases {
            assert_eq!(tick(value, range), text);
        }
    }
}
