//! Pieces of B-splines, by de Boor's algorithm with its own argument u_r at each step r.
//!
//! From the control points d_i of the span k of knots t_i,
//!
//! ```text
//!     d_i <- (1-a) d_i-1 + a d_i,    a = (u_r - t_i)/(t_i+p+1-r - t_i),    i = k-p+r ... k,    r = 1 ... p
//! ```
//!
//! leaves in d_k the polar form f(u_1, ..., u_p) of the polynomial of that span: symmetric, affine in each argument,
//! and f(t, ..., t) is the curve (Ramshaw 1989, Comput. Aided Geom. Des. 6, 323-358). The Bézier points of the interval
//! [a, b] are f(a, ..., a, b, ..., b), and the points that the steps with one t leave behind on both sides are the
//! control points of the two parts of the curve cut at t. Arguments within the span make all steps convex combinations,
//! whatever the distances of the knots.

use super::KnotVector;
use super::homogeneous::Homogeneous;

/// Step `r` with the argument `u` on the control points `d` of `span`.
fn step<const D: usize>(knots: &KnotVector, span: usize, r: usize, u: f64, d: &mut [Homogeneous<D>]) {
    let (p, t) = (knots.degree(), knots.knots());
    for j in (r..=p).rev() {
        let (low, high) = (t[span - p + j], t[span + 1 + j - r]);
        d[j] = d[j - 1].blend(&d[j], (u - low) / (high - low));
    }
}

/// Turns the p+1 control points of `span` into the Bézier points of the interval [a, b] in it.
///
/// End points of neighbouring intervals are equal to the last digit.
pub fn to_bezier<const D: usize>(knots: &KnotVector, span: usize, [a, b]: [f64; 2], line: &mut [Homogeneous<D>]) {
    let control = line.to_vec();
    let mut d = control.clone();
    for i in 0..line.len() {
        d.copy_from_slice(&control);
        for r in 1..line.len() {
            step(knots, span, r, if r <= i { b } else { a }, &mut d);
        }
        line[i] = d[line.len() - 1];
    }
}

/// Control points of the parts before and behind `t`, a parameter of the domain of `knots`.
pub fn split<const D: usize>(knots: &KnotVector, control: &[Homogeneous<D>], t: f64) -> [Vec<Homogeneous<D>>; 2] {
    let p = knots.degree();
    let span = knots.span_before(t);
    let mut before = control[..=span].to_vec();
    for r in 1..=p {
        step(knots, span, r, t, &mut before[span - p..]);
    }
    let span = knots.span(t);
    let mut d = control[span - p..=span].to_vec();
    let mut behind: Vec<_> = control[span..].iter().rev().copied().collect();
    for r in 1..=p {
        step(knots, span, r, t, &mut d);
        behind.push(d[p]);
    }
    behind.reverse();
    [before, behind]
}

/// The same Bézier curve one degree higher.
pub fn elevate<const D: usize>(line: &[Homogeneous<D>]) -> Vec<Homogeneous<D>> {
    let p = line.len();
    (0..=p).map(|i| line[i.min(p - 1)].blend(&line[i.max(1) - 1], i as f64 / p as f64)).collect()
}
