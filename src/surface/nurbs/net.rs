//! The control net of a surface and its evaluation from the basis functions of both directions.

use super::homogeneous::{Homogeneous, check, homogeneous, separate};
use crate::Vec3;
use crate::surface::Local;
use std::iter::StepBy;
use std::ops::Range;

/// The control points of a surface, i fastest, ready for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    pub points: Vec<Vec3>,
    pub weights: Vec<f64>,
    /// Relative to the first point, so that small surfaces far from the origin lose no digits.
    relative: Vec<Homogeneous<3>>,
    rational: bool,
}

impl Net {
    /// Fails as [`check`] does.
    pub fn new(count: usize, points: Vec<Vec3>, weights: Vec<f64>) -> Result<Self, String> {
        check(count, &points, &weights)?;
        Ok(Self::unchecked(points, weights))
    }

    /// The net of points and weights that are known to be good.
    pub fn unchecked(points: Vec<Vec3>, weights: Vec<f64>) -> Self {
        let scale = weights.iter().copied().fold(0.0, f64::max);
        let relative = |(point, weight): (&Vec3, &f64)| Homogeneous::new(&(point - points[0]), weight / scale);
        let relative = points.iter().zip(&weights).map(relative).collect();
        let rational = weights.iter().any(|weight| *weight != weights[0]);
        Self { points, weights, relative, rational }
    }

    /// All control points, not relative to the first.
    pub fn homogeneous(&self) -> Vec<Homogeneous<3>> {
        homogeneous(&self.points, &self.weights)
    }

    /// The net of these control points.
    pub fn from_homogeneous(control: &[Homogeneous<3>]) -> Self {
        let (points, weights) = separate(control);
        Self::unchecked(points, weights)
    }

    /// The surface from the basis functions `u` and `v` of its directions; the first pair of them belongs to control
    /// point `first`, and `stride` is the number of points along u.
    #[inline]
    pub fn local(&self, first: usize, stride: usize, u: &[[f64; 3]], v: &[[f64; 3]]) -> Local {
        let mut sums = [Homogeneous::zero(); 6];
        for (row, b) in self.relative[first..].chunks(stride).zip(v) {
            let mut along = [Homogeneous::zero(); 3];
            for (point, a) in row.iter().zip(u) {
                for k in 0..3 {
                    along[k].add(point, a[k]);
                }
            }
            for (sum, [k, l]) in sums.iter_mut().zip([[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]]) {
                sum.add(&along[k], b[l]);
            }
        }
        let mut local = if self.rational { quotient(&sums) } else { polynomial(&sums) };
        local.point += self.points[0];
        local
    }
}

/// The numbers of the control points along each line of a net of `size` in `direction`.
pub fn lines(size: [usize; 2], direction: usize) -> impl Iterator<Item = StepBy<Range<usize>>> {
    let [along, across] = [[1, size[0]], [size[0], 1]][direction];
    let length = size[direction] * along;
    (0..size[1 - direction]).map(move |line| (line * across..line * across + length).step_by(along))
}

fn polynomial(sums: &[Homogeneous<3>; 6]) -> Local {
    let [point, t1, t2, s11, s12, s22] = sums.map(|sum| sum.scaled);
    Local { point, tangents: [t1, t2], second: [s11, s12, s22] }
}

/// With S = A/w: S,a = (A,a - w,a S)/w and S,ab = (A,ab - w,a S,b - w,b S,a - w,ab S)/w.
fn quotient(sums: &[Homogeneous<3>; 6]) -> Local {
    let over = 1.0 / sums[0].weight;
    let point = sums[0].scaled * over;
    let tangent = |a: usize| (sums[a].scaled - point * sums[a].weight) * over;
    let tangents = [tangent(1), tangent(2)];
    let second = |ab: usize, a: usize, b: usize| {
        let mixed = tangents[b - 1] * sums[a].weight + tangents[a - 1] * sums[b].weight;
        (sums[ab].scaled - mixed - point * sums[ab].weight) * over
    };
    Local { point, tangents, second: [second(3, 1, 1), second(4, 1, 2), second(5, 2, 2)] }
}
