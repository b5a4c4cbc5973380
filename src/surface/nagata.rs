//! The curved edge of Nagata: from the normals at the ends of an edge to its quadratic curve.
//!
//! The edge from x0 to x1 = x0 + d with unit normals n0, n1 is C(t) = x0 + (d - c) t + c t^2, where c is the shortest
//! vector that makes C orthogonal to both normals (Nagata 2005, Comput. Aided Geom. Des. 22, 327-347). With the
//! orthogonal vectors s = n0 + n1 and t = n0 - n1 it reads
//!
//! ```text
//!     c = (t.d)/|s|^2 s + (s.d)/|t|^2 t
//! ```
//!
//! which keeps all digits where the usual form divides by 1 - (n0.n1)^2. The first term is the bulge, and it is all
//! there is on a circular arc. The second is the asymmetry of the slopes: on a nearly straight edge whose normals lean
//! the same way its size is of the order of |d| however small the lean is. It is therefore limited, and left out of
//! straight edges; normals that a quadratic cannot meet are then met in part only.

use crate::{Mat3, Vec3};
use nalgebra::SymmetricEigen;

/// Largest asymmetry term over |d|; terms below half of it are exact. From 0.12 on, edges bend sideways so far that
/// thin triangles of disturbed meshes fold.
const ASYMMETRY_LIMIT: f64 = 0.1;
/// Largest |c.d|/|d|^2; below 1 the curve never turns back. Values below half of it are exact.
const ADVANCE_LIMIT: f64 = 0.5;
/// |n0 - n1| from which the asymmetry counts in full; on straight edges, towards which it fades out, it has no
/// direction.
const STRAIGHT: f64 = 1e-3;

/// Coefficient c of the edge `d` with unit normals `n0`, `n1` at its ends; c(-d, n1, n0) = c(d, n0, n1).
///
/// Finite and continuous for any normals. Eq. (48) of the node-to-Nagata paper wherever its limits are not met.
pub fn edge_coefficient(d: &Vec3, n0: &Vec3, n1: &Vec3) -> Vec3 {
    let (s, t) = (n0 + n1, n0 - n1);
    let ss = s.norm_squared();
    // 1/|s|^2, brought smoothly to zero where the normals are more than 120 degrees apart.
    let over_ss = if ss < 1.0 { ss * (3.0 - 2.0 * ss) } else { 1.0 / ss };
    let bulge = s * (t.dot(d) * over_ss);
    limit_advance(bulge + asymmetry(d, &s, &t), d)
}

fn asymmetry(d: &Vec3, s: &Vec3, t: &Vec3) -> Vec3 {
    let turn = t.norm();
    if turn == 0.0 {
        return Vec3::zeros();
    }
    let size = s.dot(d) / turn;
    let limited = saturate(size.abs(), ASYMMETRY_LIMIT * d.norm()).copysign(size);
    t * (limited * smoothstep(turn / STRAIGHT) / turn)
}

/// Coefficient of an edge that two surfaces with different normals share: the shortest c that is orthogonal to the
/// normals `a` of one side and `b` of the other at both ends, as far as a quadratic can be (Nagata 2005, section 3.3).
pub fn crease_coefficient(d: &Vec3, a: [&Vec3; 2], b: [&Vec3; 2]) -> Vec3 {
    let mut matrix = Mat3::zeros();
    let mut right = Vec3::zeros();
    for [n0, n1] in [a, b] {
        matrix += n0 * n0.transpose() + n1 * n1.transpose();
        right += n0 * n0.dot(d) - n1 * n1.dot(d);
    }
    let eigen = SymmetricEigen::new(matrix);
    let mut c = Vec3::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        // Normals that differ by less than STRAIGHT ask for little.
        if *value > 0.0 {
            c += vector * (vector.dot(&right) * (smoothstep(value / (STRAIGHT * STRAIGHT)) / value));
        }
    }
    let size = c.norm();
    if size > 0.0 {
        c *= saturate(size, 2.0 * d.norm()) / size;
    }
    limit_advance(c, d)
}

/// True when the normals lean the same way along the edge, so that no quadratic meets both of them well.
pub fn is_inflected(d: &Vec3, n0: &Vec3, n1: &Vec3) -> bool {
    let same = (n0 + n1).dot(d).abs();
    same > 0.5 * (n0 - n1).dot(d).abs() && same > 1e-6 * d.norm()
}

fn limit_advance(c: Vec3, d: &Vec3) -> Vec3 {
    let (advance, limit) = (c.dot(d).abs(), ADVANCE_LIMIT * d.norm_squared());
    if advance > 0.5 * limit { c * (saturate(advance, limit) / advance) } else { c }
}

/// `x` up to half of `limit`, then smoothly (twice differentiable) towards `limit`.
fn saturate(x: f64, limit: f64) -> f64 {
    let half = 0.5 * limit;
    if x <= half { x } else { half + half * ((x - half) / half).tanh() }
}

fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn paper(d: &Vec3, n0: &Vec3, n1: &Vec3) -> Vec3 {
        let a = n0.dot(n1);
        let (p, q) = (n0.dot(d), -n1.dot(d));
        (n0 * (p - a * q) + n1 * (q - a * p)) / (1.0 - a * a)
    }

    fn unit() -> impl Strategy<Value = Vec3> {
        [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]
            .prop_map(|v| Vec3::new(v[0], v[1], v[2]))
            .prop_filter("no direction", |v| v.norm() > 0.1)
            .prop_map(|v| v.normalize())
    }

    #[test]
    fn is_the_printed_formula_on_regular_edges() {
        for k in 0..50 {
            let k = k as f64;
            let n0 = Vec3::new(0.2 + 0.004 * (1.1 * k).sin(), 0.05 * k.cos(), 1.0).normalize();
            let n1 = Vec3::new(-0.204 + 0.004 * (2.3 * k).cos(), 0.05 * (3.0 * k).sin(), 1.0).normalize();
            let d = Vec3::new(1.0, 0.1 * k.sin(), 0.0);
            let c = edge_coefficient(&d, &n0, &n1);
            assert!((c - paper(&d, &n0, &n1)).norm() < 1e-13);
            assert!((d - c).dot(&n0).abs() < 1e-15 && (d + c).dot(&n1).abs() < 1e-15);
        }
    }

    /// c = -2 sin(b/2) tan(b/2) along the bisector, at every angle down to where the printed form has no digits left.
    #[test]
    fn circular_arcs_are_exact_at_every_angle() {
        for b in [1e-9, 1e-7, 1e-4, 0.01, 0.4, 1.0, 1.5, 2.0] {
            let (sin, cos) = f64::sin_cos(0.5 * b);
            let (n0, n1) = (Vec3::new(-sin, cos, 0.0), Vec3::new(sin, cos, 0.0));
            let c = edge_coefficient(&(n1 - n0), &n0, &n1);
            let exact = Vec3::new(0.0, -2.0 * sin * sin / cos, 0.0);
            assert!((c - exact).norm() < 1e-13 * exact.norm(), "angle {b}: {c} against {exact}");
        }
    }

    #[test]
    fn parallel_and_opposite_normals_are_limits() {
        let d = Vec3::new(1.0, 0.2, -0.1);
        let n0 = Vec3::new(0.1, -0.3, 1.0).normalize();
        let axis = n0.cross(&Vec3::new(0.3, 1.0, 0.2)).normalize();
        let at = |angle: f64| {
            let n1 = nalgebra::Rotation3::from_scaled_axis(axis * angle) * n0;
            edge_coefficient(&d, &n0, &n1)
        };
        assert_eq!(at(0.0), Vec3::zeros());
        let mut last = at(0.0);
        for k in 0..=4000 {
            // Logarithmic steps from 1e-11 to pi: no jump is larger than the steps explain.
            let c = at(std::f64::consts::PI * 10f64.powf(-11.5 * (1.0 - k as f64 / 4000.0)));
            assert!((c - last).norm() < 0.02, "jump at step {k}");
            last = c;
        }
        assert!(last.norm() < 1e-12);
        for k in 0..=1000 {
            let c = at(std::f64::consts::PI * (1.0 - 1e-3 * (1.0 - k as f64 / 1000.0)));
            assert!(c.norm() < 0.01);
        }
    }

    #[test]
    fn a_tilted_normal_at_one_end_of_a_straight_edge_does_not_stop_the_curve() {
        let (d, up) = (Vec3::x(), Vec3::z());
        for tilt in [1e-12, 1e-8, 1e-6, 1e-4, 1e-2, 0.05, 0.3] {
            let n1 = Vec3::new(f64::sin(tilt), 0.0, f64::cos(tilt));
            let c = edge_coefficient(&d, &up, &n1);
            assert!((d + c).norm() > 0.7 && (d - c).norm() > 0.7);
            assert_eq!(is_inflected(&d, &up, &n1), tilt > 1e-6);
        }
        let (n0, n1) = (Vec3::new(-0.1, 0.0, 1.0).normalize(), Vec3::new(0.1, 0.0, 1.0).normalize());
        assert!(!is_inflected(&d, &n0, &n1) && is_inflected(&d, &n0, &n0));
    }

    #[test]
    fn a_crease_meets_the_normals_of_both_sides() {
        let b = 0.2_f64;
        let (n0, n1) = (Vec3::new(-b.sin(), b.cos(), 0.0), Vec3::new(b.sin(), b.cos(), 0.0));
        let d = n1 - n0;
        let arc = edge_coefficient(&d, &n0, &n1);
        let cap = Vec3::z();
        assert!((crease_coefficient(&d, [&n0, &n1], [&cap, &cap]) - arc).norm() < 1e-13);
        assert!((crease_coefficient(&d, [&n0, &n1], [&n0, &n1]) - arc).norm() < 1e-13);
        assert!(crease_coefficient(&d, [&cap, &cap], [&cap, &cap]).norm() < 1e-15);
    }

    #[test]
    fn an_edge_without_length_is_a_point() {
        let (a, b) = (Vec3::new(0.1, -0.3, 1.0).normalize(), Vec3::new(0.6, 0.0, 0.8));
        for [n0, n1] in [[a, b], [a, a], [a, -a], [a, Vec3::zeros()]] {
            for d in [Vec3::zeros(), Vec3::repeat(1e-170)] {
                assert!(edge_coefficient(&d, &n0, &n1).norm() <= 2.0 * d.amax());
                assert!(crease_coefficient(&d, [&n0, &n1], [&b, &b]).norm() <= 4.0 * d.amax());
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        /// Along paths through equal and opposite normals, those 120 degrees apart, and edges without length, c moves
        /// in proportion: by a few times 1/STRAIGHT times as far as the normals where the asymmetry fades out.
        #[test]
        fn is_continuous_in_the_data(
            d in unit(), n0 in unit(), axis in unit(), moves in [unit(), unit(), unit()], case in 0..4_usize,
        ) {
            let axis = n0.cross(&axis).try_normalize(0.1);
            prop_assume!(axis.is_some());
            let angle = [0.0, std::f64::consts::PI, std::f64::consts::PI / 1.5, 0.7][case];
            let n1 = nalgebra::Rotation3::from_scaled_axis(axis.unwrap_or_default() * angle) * n0;
            let start = if case == 3 { Vec3::zeros() } else { d };
            let at = |way: f64| {
                let [n0, n1] = [n0 + moves[0] * way, n1 + moves[1] * way].map(|n| n.normalize());
                let d = start + moves[2] * way;
                let crease = crease_coefficient(&d, [&n0, &n1], [&n1, &moves[1]]);
                [edge_coefficient(&d, &n0, &n1), crease]
            };
            for step in [1e-3, 1e-5, 1e-7] {
                let mut last = at(-100.0 * step);
                for k in -99..=100 {
                    let next = at(k as f64 * step);
                    let [edge, crease] = [0, 1].map(|k| (next[k] - last[k]).norm() * STRAIGHT / step);
                    prop_assert!(edge <= 2.5 && crease <= 100.0, "{edge} and {crease} in a step of {step} at {k}");
                    last = next;
                }
            }
        }

        #[test]
        fn every_pair_of_normals_gives_a_regular_curve(d in unit(), n0 in unit(), n1 in unit(), size in 1e-3..1e3_f64) {
            let d = d * size;
            let c = edge_coefficient(&d, &n0, &n1);
            prop_assert!(c.iter().all(|x| x.is_finite()));
            prop_assert!(c.dot(&d).abs() <= 0.5 * d.norm_squared() * (1.0 + 1e-12));
            prop_assert!((c - edge_coefficient(&-d, &n1, &n0)).norm() <= 1e-14 * d.norm());
            prop_assert!((c - edge_coefficient(&d, &-n0, &-n1)).norm() <= 1e-14 * d.norm());
            let crease = crease_coefficient(&d, [&n0, &n1], [&n1, &d.normalize()]);
            prop_assert!(crease.norm() <= 2.0 * d.norm() * (1.0 + 1e-12));
        }
    }
}
