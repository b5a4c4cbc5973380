//! Closest points in a plane: of circles and corners, the parts of every section.

use crate::{Mat2, Vec2};

/// The closest point of a curve to a point of its plane, as [`Projection`](crate::surface::Projection) in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planar {
    /// Distance, positive outside.
    pub gap: f64,
    /// Unit vector out of the solid.
    pub normal: Vec2,
    /// Gradient of the normal, symmetric.
    pub gradient: Mat2,
}

/// Distance, over the size of a curve, below which the direction to a corner or centre means nothing.
pub const TOUCH: f64 = 1e-12;

/// The closest point of a circle about the origin, solid inside when `sign` is 1, outside when it is -1. At the centre
/// all directions are equally close, and `otherwise`, a unit vector, is taken.
pub fn circle(arm: Vec2, radius: f64, sign: f64, otherwise: Vec2) -> Planar {
    let distance = arm.norm();
    if distance <= TOUCH * radius {
        return Planar { gap: sign * (distance - radius), normal: otherwise * sign, gradient: Mat2::zeros() };
    }
    let outward = arm / distance;
    Planar { gap: sign * (distance - radius), normal: outward * sign, gradient: across(&outward) * (sign / distance) }
}

/// The corner at the origin as the closest point to `arm`. `mean` is the mean normal of its two sides: it tells outside
/// from inside, and is the normal at the corner itself.
pub fn corner(arm: Vec2, mean: Vec2, size: f64) -> Planar {
    let distance = arm.norm();
    if distance <= TOUCH * size {
        return Planar { gap: mean.dot(&arm), normal: mean, gradient: Mat2::zeros() };
    }
    let sign = if mean.dot(&arm) < 0.0 { -1.0 } else { 1.0 };
    let direction = arm / distance;
    Planar { gap: sign * distance, normal: direction * sign, gradient: across(&direction) * (sign / distance) }
}

/// A quarter turn clockwise: from the way along a curve to the side on its right hand.
pub fn right(way: &Vec2) -> Vec2 {
    Vec2::new(way.y, -way.x)
}

/// What projects onto the directions across a unit vector.
fn across(n: &Vec2) -> Mat2 {
    Mat2::identity() - n * n.transpose()
}
