//! A stretch of a rim within one cell: the curve S(c(t)) in space, short enough to be searched by descent.
//!
//! ```text
//!     C' = S,a c_a',    C'' = S,ab c_a' c_b' + S,a c_a''
//! ```

use super::curves::{descend_on, part};
use crate::Vec3;
use crate::surface::cell::Cell;
use crate::surface::{Curve, CurveLocal, Parametric};

/// Samples of a stretch.
const SAMPLES: usize = 9;
/// Greatest change of C'' over a stretch, over |C'|^2/size.
const CHANGE: f64 = 0.5;
/// |C'| over the size of the cell, below which the curve is a point.
const POINT: f64 = 1e-9;
/// As often a stretch is halved to make it so.
const HALVINGS: usize = 8;

/// A part of a rim, as a curve in the parameters of a cell.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Number of the rim in its face.
    pub rim: u32,
    /// The part of the rim's parameters that it covers.
    pub part: [f64; 2],
    /// A Bézier curve in the parameters of the cell.
    pub curve: Curve<2>,
    /// A ball around it in space.
    pub center: Vec3,
    pub radius: f64,
    /// Least C'.C' + (C - center).C'', mean of C'' and the farthest that it is from it.
    least: f64,
    mean: Vec3,
    spread: f64,
}

impl Stretch {
    /// The stretches that a curve in the parameters of `cell`, over `interval` of rim number `rim`, is cut into.
    pub fn all(cell: &Cell, rim: u32, interval: [f64; 2], curve: Curve<2>) -> Vec<Self> {
        let mut all = Vec::new();
        let mut open = vec![(interval, curve, 0)];
        while let Some(([a, b], curve, halvings)) = open.pop() {
            let (stretch, is_tame) = Self::new(cell, rim, [a, b], curve);
            if is_tame || halvings == HALVINGS {
                all.push(stretch);
            } else {
                let middle = 0.5 * (a + b);
                open.push(([middle, b], part(&stretch.curve, [0.5, 1.0]), halvings + 1));
                open.push(([a, middle], part(&stretch.curve, [0.0, 0.5]), halvings + 1));
            }
        }
        all
    }

    fn new(cell: &Cell, rim: u32, part: [f64; 2], curve: Curve<2>) -> (Self, bool) {
        let at = |k: usize| on_cell(cell, &curve, k as f64 / (SAMPLES - 1) as f64);
        let samples: [CurveLocal<3>; SAMPLES] = std::array::from_fn(at);
        let center = samples[SAMPLES / 2].point;
        let far = samples.iter().map(|s| (s.point - center).norm()).fold(0.0, f64::max);
        let speed = samples.iter().map(|s| s.first.norm()).fold(0.0, f64::max);
        let radius = far + speed / (SAMPLES - 1) as f64;
        let mean = samples.iter().map(|s| s.second).sum::<Vec3>() / SAMPLES as f64;
        let spread = 1.25 * samples.iter().map(|s| (s.second - mean).norm()).fold(0.0, f64::max);
        let metric = |s: &CurveLocal<3>| s.first.norm_squared() + (s.point - center).dot(&s.second);
        let [least, most] = [f64::min, f64::max].map(|f| samples.iter().map(metric).reduce(f).unwrap_or(0.0));
        let least = least - 0.25 * (most - least);
        let turn = samples.iter().all(|s| {
            s.first.dot(&samples[SAMPLES / 2].first) >= 0.9 * s.first.norm() * samples[SAMPLES / 2].first.norm()
        });
        let [a, b] = cell.lengths();
        let is_point = speed <= POINT * a.max(b);
        let is_tame = is_point || turn && spread * far <= CHANGE * speed * speed;
        (Self { rim, part, curve, center, radius, least, mean, spread }, is_tame)
    }

    /// The curve in space at `t`.
    pub fn local(&self, cell: &Cell, t: f64) -> CurveLocal<3> {
        on_cell(cell, &self.curve, t)
    }

    /// Parameters in the cell at `t`.
    pub fn xi(&self, t: f64) -> [f64; 2] {
        self.curve.local(t).point.into()
    }

    /// Parameter of the rim at `t`.
    pub fn along_rim(&self, t: f64) -> f64 {
        self.part[0] + (self.part[1] - self.part[0]) * t
    }

    /// No point of the stretch is closer to `x`.
    pub fn bound(&self, x: &Vec3) -> f64 {
        (x - self.center).norm() - self.radius
    }

    /// Parameter of the point next to `x`, and their distance.
    pub fn closest(&self, cell: &Cell, x: &Vec3) -> (f64, f64) {
        let from = |start: f64| {
            let (t, local) = descend_on(|t| self.local(cell, t), x, [0.0, 1.0], start);
            (t, (local.point - x).norm())
        };
        let y = x - self.center;
        if self.least - y.dot(&self.mean) - y.norm() * self.spread > 0.0 {
            return from(0.5);
        }
        let closer = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
        [0.0, 0.25, 0.75, 1.0].into_iter().map(from).fold(from(0.5), closer)
    }
}

fn on_cell(cell: &Cell, curve: &Curve<2>, t: f64) -> CurveLocal<3> {
    let c = curve.local(t);
    let s = cell.local(c.point.into());
    let [e, z] = [c.first.x, c.first.y];
    CurveLocal {
        point: s.point,
        first: s.tangents[0] * e + s.tangents[1] * z,
        second: s.second[0] * (e * e)
            + s.second[1] * (2.0 * e * z)
            + s.second[2] * (z * z)
            + s.tangents[0] * c.second.x
            + s.tangents[1] * c.second.y,
    }
}
