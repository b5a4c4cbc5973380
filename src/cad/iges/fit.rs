//! Splines through smooth plane curves.
//!
//! A piece over [a, b] takes position and two derivatives at both ends: the Bézier curve of degree 5 with control points
//!
//! ```text
//!     f, f + h f'/5, f + 2h f'/5 + h^2 f''/20      at a, and likewise backwards from b, h = b - a
//! ```
//!
//! Its error falls with the sixth power of h. Pieces are halved until it is small enough between their ends.

use crate::surface::{Curve, KnotVector};
use nalgebra::Vector2;

type Vec2 = Vector2<f64>;

/// A point of a plane curve with its first and second derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub point: Vec2,
    pub first: Vec2,
    pub second: Vec2,
}

/// The most pieces that a curve may need.
const MOST: usize = 4000;

/// The spline that agrees with `curve`, defined on `domain`, as well as `is_close` demands of pairs of points. `curve`
/// gets the parameter and a guess at the point; `None` from it, or too many pieces, end the attempt.
pub(super) fn fit(
    domain: [f64; 2],
    guesses: [Vec2; 2],
    mut curve: impl FnMut(f64, &Vec2) -> Option<Jet>,
    is_close: impl Fn(&Vec2, &Vec2) -> bool,
) -> Option<Curve<2>> {
    let ends = [curve(domain[0], &guesses[0])?, curve(domain[1], &guesses[1])?];
    let mut knots = vec![domain[0]; 6];
    let mut points = vec![ends[0].point];
    // Pieces still to be done, the next one last.
    let mut pieces = vec![(domain, ends)];
    while let Some(([a, b], ends)) = pieces.pop() {
        let control = control(b - a, &ends);
        let mut is_done = true;
        let middle = 0.5 * (a + b);
        let mut inside = None;
        for x in [0.25, 0.75, 0.5] {
            let guess = quintic(&control, x);
            let jet = curve(a + x * (b - a), &guess)?;
            is_done &= is_close(&jet.point, &guess);
            inside = Some(jet);
        }
        if is_done {
            knots.extend([b; 5]);
            points.extend_from_slice(&control[1..]);
        } else {
            if pieces.len() + points.len() / 5 > MOST || middle <= a || middle >= b {
                return None;
            }
            let inside = inside?;
            pieces.push(([middle, b], [inside, ends[1]]));
            pieces.push(([a, middle], [ends[0], inside]));
        }
    }
    knots.push(domain[1]);
    let weights = vec![1.0; points.len()];
    Curve::new(KnotVector::new(5, knots).ok()?, points, weights).ok()
}

fn control(h: f64, [start, end]: &[Jet; 2]) -> [Vec2; 6] {
    let near = |jet: &Jet, h: f64| jet.point + jet.first * (h / 5.0);
    let far = |jet: &Jet, h: f64| jet.point + jet.first * (0.4 * h) + jet.second * (h * h / 20.0);
    [start.point, near(start, h), far(start, h), far(end, -h), near(end, -h), end.point]
}

/// The point of a Bézier curve.
fn quintic(control: &[Vec2; 6], x: f64) -> Vec2 {
    let mut points = *control;
    for count in (1..6).rev() {
        for k in 0..count {
            points[k] = points[k] * (1.0 - x) + points[k + 1] * x;
        }
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &Vec2, b: &Vec2) -> bool {
        (a - b).amax() <= 1e-9
    }

    #[test]
    fn a_spiral_within_the_tolerance() {
        let spiral = |t: f64, _: &Vec2| {
            let (sin, cos) = t.sin_cos();
            Some(Jet {
                point: Vec2::new(t * cos, t * sin),
                first: Vec2::new(cos - t * sin, sin + t * cos),
                second: Vec2::new(-2.0 * sin - t * cos, 2.0 * cos - t * sin),
            })
        };
        let curve = fit([0.0, 9.0], [Vec2::zeros(); 2], spiral, close).unwrap();
        for k in 0..=1000 {
            let t = 9.0 * k as f64 / 1000.0;
            assert!((curve.local(t).point - Vec2::new(t * t.cos(), t * t.sin())).amax() < 1.2e-9);
        }
        assert!(curve.knots().spans().count() < 200);
    }

    #[test]
    fn jumps_and_failures_end_it() {
        let jump = |t: f64, _: &Vec2| {
            let point = Vec2::new(if t < 0.3 { 0.0 } else { 1.0 }, 0.0);
            Some(Jet { point, first: Vec2::zeros(), second: Vec2::zeros() })
        };
        assert!(fit([0.0, 1.0], [Vec2::zeros(); 2], jump, close).is_none());
        assert!(fit([0.0, 1.0], [Vec2::zeros(); 2], |_, _| None, close).is_none());
    }
}
