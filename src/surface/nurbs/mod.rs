//! Bézier patches and NURBS: curves and surfaces with control points and weights.
//!
//! A [`Bezier`] patch of degrees p and q has (p+1)(q+1) control points P_ij with weights w_ij (Neto, Oliveira, Menezes
//! 2017, equation numbers in brackets; Piegl and Tiller, The NURBS Book, 1997):
//!
//! ```text
//!     S(u,v) = sum B_i,p(u) B_j,q(v) w_ij P_ij / sum B_i,p(u) B_j,q(v) w_ij,    0 <= u, v <= 1        (39)
//!     B_i,p(t) = p!/(i! (p-i)!) t^i (1-t)^(p-i)                                                    (40), (41)
//! ```
//!
//! and a [`Curve`] and a [`Nurbs`] surface put B-splines on a [`KnotVector`] in the place of the Bernstein polynomials:
//!
//! ```text
//!     C(t) = sum N_i,p(t) w_i P_i / sum N_i,p(t) w_i                                                     (42)
//!     N_i,0 = 1 on [t_i, t_i+1), else 0
//!     N_i,p = (t - t_i)/(t_i+p - t_i) N_i,p-1 + (t_i+p+1 - t)/(t_i+p+1 - t_i+1) N_i+1,p-1                (43)
//!     S(u,v) = sum N_i,p(u) N_j,q(v) w_ij P_ij / sum N_i,p(u) N_j,q(v) w_ij                              (45)
//! ```
//!
//! Control point (i, j) is number i + n j of the list, n that of points along u: i, which goes with u, runs fastest.
//! With homogeneous points (w P, w) numerator and denominator are one polynomial in four dimensions, and all that is
//! done to control points is blending two of them: pieces are cut off by convex combinations only.
//! Where all points of an edge of the net are one, as at the pole of a sphere, the tangent along this edge is zero and
//! S,u x S,v is no normal.

mod bezier;
mod blossom;
mod curve;
mod exact;
mod homogeneous;
mod knots;
mod net;
mod surface;
#[cfg(test)]
mod testing;

pub use bezier::Bezier;
pub use curve::{Curve, CurveLocal};
pub use knots::{KnotVector, MAX_DEGREE};
pub use surface::{Nurbs, Rectangle};
