//! The grid on which a piece of a surface is sampled.

/// n x n points of a piece, ends included: parameters (s, t) of a quadrilateral, (s, s t) of a triangle, whose first row
/// falls on its first corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    n: usize,
}

impl Grid {
    /// A grid of `n` by `n` points, 2 at least.
    pub fn new(n: usize) -> Self {
        Self { n: n.max(2) }
    }

    /// Points along each side.
    pub fn side(&self) -> usize {
        self.n
    }

    /// Distance between points, of 1.
    pub fn step(&self) -> f64 {
        1.0 / (self.n - 1) as f64
    }

    /// All points (s, t) of the unit square; s runs first.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (n, step) = (self.n, self.step());
        let at = move |k: usize| if k == n - 1 { 1.0 } else { k as f64 * step };
        (0..n * n).map(move |k| [at(k % n), at(k / n)])
    }

    /// The middles of the cells between the points; s runs first.
    pub fn middles(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (cells, step) = (self.n - 1, self.step());
        (0..cells * cells).map(move |k| [((k % cells) as f64 + 0.5) * step, ((k / cells) as f64 + 0.5) * step])
    }

    /// Weights of all points for the integral over the unit square, exact for cubics in s and t when n is 3 or more.
    pub fn integration_weights(&self) -> Vec<f64> {
        self.products(&simpson(self.n))
    }

    /// Share of the unit square that belongs to each point.
    pub fn shares(&self) -> Vec<f64> {
        let mut shares = vec![self.step(); self.n];
        shares[0] *= 0.5;
        shares[self.n - 1] *= 0.5;
        self.products(&shares)
    }

    fn products(&self, line: &[f64]) -> Vec<f64> {
        line.iter().flat_map(|b| line.iter().map(move |a| a * b)).collect()
    }
}

/// Weights of n equidistant points for the integral over `[0, 1]`: Simpson's rule, with the 3/8 rule over the first three
/// intervals when their number is odd; the trapezoidal rule for two points.
fn simpson(n: usize) -> Vec<f64> {
    let intervals = n - 1;
    let mut weights = vec![0.0; n];
    let mut add = |first: usize, rule: &[f64]| {
        rule.iter().enumerate().for_each(|(k, w)| weights[first + k] += w / intervals as f64);
    };
    if intervals == 1 {
        add(0, &[0.5, 0.5]);
        return weights;
    }
    let first = if intervals % 2 == 1 { 3 } else { 0 };
    if first > 0 {
        add(0, &[0.375, 1.125, 1.125, 0.375]);
    }
    for k in (first..intervals).step_by(2) {
        add(k, &[1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0]);
    }
    weights
}

/// Climbs from `start`, where `f` is `value`, to a local maximum over the unit square: to the best of the eight neighbours
/// at a distance that begins at `step` and is halved where none is higher.
pub fn climb(f: impl Fn([f64; 2]) -> f64, start: [f64; 2], value: f64, step: f64) -> ([f64; 2], f64) {
    const AROUND: [[f64; 2]; 8] =
        [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];
    const LAST_STEP: f64 = 1e-10;
    const MOVES: usize = 1000;
    let (mut best, mut highest, mut step) = (start, value, step);
    for _ in 0..MOVES {
        let from = best;
        for [a, b] in AROUND {
            let next = [(from[0] + step * a).clamp(0.0, 1.0), (from[1] + step * b).clamp(0.0, 1.0)];
            let there = f(next);
            if there > highest {
                (best, highest) = (next, there);
            }
        }
        if best == from {
            step *= 0.5;
            if step < LAST_STEP {
                break;
            }
        }
    }
    (best, highest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_integrate_cubics_and_shares_bilinear_functions() {
        for n in 2..15 {
            let grid = Grid::new(n);
            let points: Vec<_> = grid.points().collect();
            assert_eq!(points.len(), n * n);
            assert_eq!((points[0], points[n * n - 1]), ([0.0, 0.0], [1.0, 1.0]));
            let integral = |weights: &[f64], f: &dyn Fn(f64, f64) -> f64| -> f64 {
                points.iter().zip(weights).map(|([s, t], w)| w * f(*s, *t)).sum()
            };
            let bilinear = |s: f64, t: f64| (1.0 + 2.0 * s) * (3.0 - t);
            assert!((integral(&grid.shares(), &bilinear) - 5.0).abs() < 1e-13, "{n}");
            assert!((integral(&grid.integration_weights(), &bilinear) - 5.0).abs() < 1e-13, "{n}");
            if n > 2 {
                let cubic = |s: f64, t: f64| (4.0 * s.powi(3) - s) * (3.0 * t * t + 1.0);
                assert!((integral(&grid.integration_weights(), &cubic) - 1.0).abs() < 1e-13, "{n}");
            }
        }
    }

    #[test]
    fn climbing_ends_on_the_maximum_inside_on_an_edge_and_on_a_ridge() {
        let peak = |[s, t]: [f64; 2]| 2.0 - (s - 0.31).powi(2) - 3.0 * (t - 0.62).powi(2) - (s - 0.31) * (t - 0.62);
        let (at, value) = climb(peak, [0.25, 0.75], peak([0.25, 0.75]), 0.25);
        assert!((at[0] - 0.31).abs() < 1e-7 && (at[1] - 0.62).abs() < 1e-7 && (value - 2.0).abs() < 1e-15);
        let slope = |[s, t]: [f64; 2]| s - (t - 0.7).powi(2);
        let (at, value) = climb(slope, [0.5, 0.5], slope([0.5, 0.5]), 0.25);
        assert!(at[0] == 1.0 && (value - 1.0).abs() < 1e-15);
        let ridge = |[s, t]: [f64; 2]| -(s - t).abs() - 0.1 * (s + t - 1.2).abs();
        assert!(climb(ridge, [0.0, 0.0], ridge([0.0, 0.0]), 0.25).1 > -1e-8);
    }
}
