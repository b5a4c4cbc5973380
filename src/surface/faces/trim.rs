//! Which part of a surface belongs to a face: points inside an odd number of loops.
//!
//! The ray from a point along the first parameter crosses a loop an odd number of times from inside and an even number
//! from outside. The loops are cut into parts along which the second parameter rises or falls; a part counts when the
//! point's second parameter lies between those of its ends, the lower included and the higher not, so that every loop
//! that closes to the last digit is counted rightly, through corners and along level parts too.

use super::curves::{bisect, monotone_parts};
use crate::surface::Curve;
use nalgebra::Vector2;

/// What the ends of two parts of a curve differ by, over their coordinates.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// The loops of a face, ready for [`Trim::holds`].
#[derive(Debug)]
pub struct Trim {
    parts: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    curve: Curve<2>,
    low: Vector2<f64>,
    high: Vector2<f64>,
    rises: bool,
}

impl Trim {
    /// Loops as Bézier curves, each beginning where another ends: to the last digit, but where a curve was cut in two, of
    /// which the one behind follows the one before.
    pub fn new<'a>(curves: impl Iterator<Item = &'a Curve<2>>) -> Self {
        let mut parts = Vec::new();
        let mut last: Option<Vector2<f64>> = None;
        for curve in curves {
            let pieces = monotone_parts(curve);
            let from = curve.points()[0];
            let joins = |last: &Vector2<f64>| (last - from).amax() <= ROUNDED * from.amax();
            let mut start = last.filter(joins).unwrap_or(from).y;
            last = curve.points().last().copied();
            for (k, piece) in pieces.iter().enumerate() {
                // Ends are shared, so that no rounding opens the loop.
                let whole = if k + 1 == pieces.len() { curve } else { piece };
                let end = whole.points()[whole.points().len() - 1].y;
                parts.extend(Part::new(piece, start, end));
                start = end;
            }
        }
        Self { parts }
    }

    /// The parts that a ray from a point in the rectangle may cross.
    pub fn seen_from(&self, low: [f64; 2], high: [f64; 2]) -> Vec<u32> {
        let seen = |part: &Part| part.low.y <= high[1] && part.high.y >= low[1] && part.high.x >= low[0];
        (0..self.parts.len()).filter(|k| seen(&self.parts[*k])).map(|k| k as u32).collect()
    }

    /// Whether `uv` is inside, when the parts in `seen` are all that its ray may cross.
    pub fn holds(&self, uv: [f64; 2], seen: &[u32]) -> bool {
        seen.iter().filter(|k| self.parts[**k as usize].is_crossed(uv)).count() % 2 == 1
    }
}

impl Part {
    /// The part from height `start` to `end`; `None` when it is level.
    fn new(curve: &Curve<2>, start: f64, end: f64) -> Option<Self> {
        let (low, high) = curve.bounds();
        let (low, high) = (Vector2::new(low.x, start.min(end)), Vector2::new(high.x, start.max(end)));
        (start != end).then(|| Self { curve: curve.clone(), low, high, rises: end > start })
    }

    fn is_crossed(&self, [u, v]: [f64; 2]) -> bool {
        if !(self.low.y <= v && v < self.high.y) || u >= self.high.x {
            return false;
        }
        u < self.low.x || u < self.curve.local(self.parameter(v)).point.x
    }

    /// Where the second coordinate is `v`: Newton's method in a bracket.
    fn parameter(&self, v: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = 0.5;
        for _ in 0..20 {
            let local = self.curve.local(t);
            let off = local.point.y - v;
            if (off > 0.0) == self.rises {
                high = t
            } else {
                low = t
            }
            let next = t - off / local.first.y;
            if (next - t).abs() < 1e-14 {
                return next.clamp(0.0, 1.0);
            }
            t = if low < next && next < high { next } else { 0.5 * (low + high) };
        }
        bisect(|t| self.curve.local(t).point.y > v, self.rises)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::KnotVector;

    fn line(from: [f64; 2], to: [f64; 2]) -> Curve<2> {
        let points = vec![Vector2::from(from), Vector2::from(to)];
        Curve::new(KnotVector::bezier(1), points, vec![1.0; 2]).unwrap()
    }

    #[test]
    fn a_side_that_was_cut_leaves_no_gap() {
        for height in [0.5, 1.0 / 3.0, std::f64::consts::FRAC_PI_2] {
            for next in [height.next_down(), height, height.next_up()] {
                let sides = [
                    line([0.0, 0.0], [1.0, 0.0]),
                    line([1.0, 0.0], [1.0, height]),
                    line([1.0, next], [1.0, 2.0]),
                    line([1.0, 2.0], [0.0, 2.0]),
                    line([0.0, 2.0], [0.0, 0.0]),
                ];
                let trim = Trim::new(sides.iter());
                let seen = trim.seen_from([0.0, 0.0], [1.0, 2.0]);
                for v in [height.next_down(), height, height.next_up(), next] {
                    assert!(trim.holds([0.5, v], &seen) && !trim.holds([1.5, v], &seen), "{v:e} {next:e}");
                }
            }
        }
    }
}
