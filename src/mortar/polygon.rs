//! Convex polygons in a plane, counter-clockwise.

use crate::Vec2;

/// Twice the area of the triangle from a line to a point: positive on its left.
fn left(from: &Vec2, to: &Vec2, x: &Vec2) -> f64 {
    (to - from).perp(&(x - from))
}

/// The ends of its sides.
fn sides(polygon: &[Vec2]) -> impl Iterator<Item = (&Vec2, &Vec2)> {
    polygon.iter().zip(polygon.iter().cycle().skip(1))
}

/// The area of a polygon.
pub fn area(polygon: &[Vec2]) -> f64 {
    sides(polygon).map(|(a, b)| 0.5 * left(&polygon[0], a, b)).sum()
}

/// Its centre of gravity; the mean of its corners where it has no area.
fn centre(polygon: &[Vec2]) -> Vec2 {
    let mean = polygon.iter().sum::<Vec2>() / polygon.len() as f64;
    let (sum, whole) = sides(polygon).fold((Vec2::zeros(), 0.0), |(sum, whole), (a, b)| {
        let part = left(&mean, a, b);
        (sum + ((a - mean) + (b - mean)) * part, whole + part)
    });
    if whole > 0.0 { mean + sum / (3.0 * whole) } else { mean }
}

/// The triangles around its centre of gravity, also of a triangle: nothing depends on which corner is the first, and they change
/// continuously where corners fall together, as those of faces that lie on each other but for rounding do and do not. So do
/// integrals that the rule of a triangle does not give exactly.
pub fn triangles(polygon: &[Vec2]) -> impl Iterator<Item = [Vec2; 3]> + '_ {
    let centre = centre(polygon);
    sides(polygon).map(move |(a, b)| [centre, *a, *b])
}

/// What two have in common; nothing, where that has no area (Sutherland and Hodgman, Commun. ACM 17, 1974).
pub fn common(one: &[Vec2], other: &[Vec2]) -> Vec<Vec2> {
    let mut rest = one.to_vec();
    for (k, from) in other.iter().enumerate() {
        let to = &other[(k + 1) % other.len()];
        let heights: Vec<f64> = rest.iter().map(|x| left(from, to, x)).collect();
        let mut cut = Vec::with_capacity(rest.len() + 1);
        for (i, x) in rest.iter().enumerate() {
            let next = (i + 1) % rest.len();
            let [here, there] = [heights[i], heights[next]];
            if here >= 0.0 {
                cut.push(*x);
            }
            if here * there < 0.0 {
                cut.push(x + (rest[next] - x) * (here / (here - there)));
            }
        }
        rest = cut;
    }
    if rest.len() < 3 { Vec::new() } else { rest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, size: f64) -> Vec<Vec2> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[s, t]| Vec2::new(x + size * s, y + size * t)).to_vec()
    }

    /// Corners that fall together leave what a rule integrates, of any function, as it is.
    #[test]
    fn triangles_change_continuously() {
        let integral = |polygon: &[Vec2]| {
            let line = crate::mortar::rule::on_line(2);
            let mut sum = 0.0;
            triangles(polygon).for_each(|triangle| {
                crate::mortar::rule::on_triangle(&line, &triangle, |x, weight| {
                    sum += weight * (3.0 * x.x).sin() * (5.0 * x.y).cos()
                })
            });
            sum
        };
        let whole = square(0.0, 0.0, 1.0);
        for corners in [&whole[..3], &whole[..]] {
            for split in [&[1][..], &[1, 2], &[0, 1, 2]] {
                let mut other = Vec::new();
                for (k, x) in corners.iter().enumerate() {
                    other.push(*x);
                    if split.contains(&k) {
                        other.push(x + (corners[(k + 1) % corners.len()] - x) * 1e-9);
                    }
                }
                assert!((integral(&other) - integral(corners)).abs() < 1e-8, "{split:?}");
            }
        }
    }

    #[test]
    fn what_polygons_have_in_common_is_cut_out() {
        let is = |one: &[Vec2], other: &[Vec2], expected: f64| {
            for common in [common(one, other), common(other, one)] {
                assert!((area(&common) - expected).abs() < 1e-15, "{common:?}");
            }
        };
        is(&square(0.0, 0.0, 1.0), &square(0.75, 0.5, 1.0), 0.125);
        is(&square(0.0, 0.0, 1.0), &square(0.25, 0.25, 0.5), 0.25);
        is(&square(0.0, 0.0, 1.0), &square(0.0, 0.0, 1.0), 1.0);
        is(&square(0.0, 0.0, 1.0), &square(1.0, 0.0, 1.0), 0.0);
        is(&square(0.0, 0.0, 1.0), &square(2.0, 0.0, 1.0), 0.0);
        // A square and the same turned by 45 degrees about its middle: an octagon.
        let turned = [[0.5, -0.2], [1.2, 0.5], [0.5, 1.2], [-0.2, 0.5]].map(Vec2::from);
        is(&square(0.0, 0.0, 1.0), &turned, 1.0 - 4.0 * 0.5 * 0.3 * 0.3);
    }
}
