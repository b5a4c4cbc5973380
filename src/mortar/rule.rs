//! Gauss points of a triangle, exact for polynomials of degree 2n - 2: up to n = 3 in places that do not depend on which corner
//! is the first, so that mirror images have the same integrals, 3 and 6 of them (Dunavant, IJNME 21, 1985); beyond, the square
//! of a rule of n points on a line, drawn together at the first corner (Duffy, SIAM J. Numer. Anal. 19, 1982).

use crate::Vec2;
use std::f64::consts::PI;

/// Points and weights of the rule of n points on the line from 0 to 1: the roots of the Legendre polynomial by Newton's method.
pub fn on_line(n: usize) -> Vec<[f64; 2]> {
    let point = |k: usize| {
        let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..16 {
            let (mut before, mut value) = (1.0, x);
            for m in 1..n {
                let m = m as f64;
                (before, value) = (value, ((2.0 * m + 1.0) * x * value - m * before) / (m + 1.0));
            }
            slope = n as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(point).collect()
}

/// Calls `each` with the points of a triangle and their weights, which add up to its area; `line` as of [`on_line`].
pub fn on_triangle(line: &[[f64; 2]], [a, b, c]: &[Vec2; 3], mut each: impl FnMut(Vec2, f64)) {
    let twice = (b - a).perp(&(c - a));
    if let Some(orbits) = orbits(line.len()) {
        for &[far, weight] in orbits {
            for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
                each(p * (1.0 - 2.0 * far) + (q + r) * far, weight * twice);
            }
        }
        return;
    }
    for [s, along] in line {
        for [t, across] in line {
            each(a + ((b - a) + (c - b) * *t) * *s, along * across * s * twice);
        }
    }
}

/// Triples of points of the rule of degree 2n - 2: their coordinates towards two of the corners, and weights over twice the area.
fn orbits(n: usize) -> Option<&'static [[f64; 2]]> {
    const THREE: [[f64; 2]; 1] = [[1.0 / 6.0; 2]];
    // (8 - √10 ± √(38 - 44 √(2/5))) / 18 and (620 ± √(213125 - 53320 √10)) / 7440.
    const SIX: [[f64; 2]; 2] = [[0.4459484909159649, 0.11169079483900573], [0.09157621350977074, 0.05497587182766093]];
    match n {
        2 => Some(&THREE),
        3 => Some(&SIX),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_integrated_exactly() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vec2::from);
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for n in [2, 3, 8] {
            let line = on_line(n);
            for (p, q) in (0..2 * n as i32 - 1).flat_map(|p| (0..2 * n as i32 - 1 - p).map(move |q| (p, q))) {
                let mut sum = 0.0;
                on_triangle(&line, &corners, |x, weight| sum += weight * x.x.powi(p) * x.y.powi(q));
                let exact = factorial(p) * factorial(q) / factorial(p + q + 2);
                assert!((sum - exact).abs() < 1e-15, "{n} points, x^{p} y^{q}: {sum}, not {exact}");
            }
        }
    }
}
