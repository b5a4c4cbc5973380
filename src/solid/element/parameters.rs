//! Where a point is in an element.

use super::{Gradients, jacobian};
use crate::Vec3;

/// Parameters of a point in the element with nodes at `x`, by Newton's method from `start`; `None` where it finds none near
/// the element. `shape` gives the shape functions and their derivatives by the parameters.
pub(super) fn find<const N: usize>(
    x: &[[f64; 3]; N],
    point: &Vec3,
    start: [f64; 3],
    shape: impl Fn([f64; 3]) -> ([f64; N], Gradients<N>),
) -> Option<[f64; 3]> {
    const ITERATIONS: usize = 30;
    const FAR: f64 = 8.0;
    const ENOUGH: f64 = 1e-13;
    let mut at = Vec3::from(start);
    for _ in 0..ITERATIONS {
        let (values, gradients) = shape(at.into());
        let place: Vec3 = values.iter().zip(x).map(|(value, x)| *value * Vec3::from(*x)).sum();
        let step = jacobian(x, &gradients).try_inverse()? * (point - place);
        at += step;
        if at.amax() > FAR || !step.amax().is_finite() {
            return None;
        }
        if step.amax() < ENOUGH {
            return Some(at.into());
        }
    }
    None
}
