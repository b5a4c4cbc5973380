//! A Bézier patch, equations (39) to (41) of [`super`].
//!
//! The Bernstein polynomials come from their recursion B_i,p = (1-t) B_i,p-1 + t B_i-1,p-1, which adds only positive
//! numbers in the domain; derivatives from B'_i,p = p (B_i-1,p-1 - B_i,p-1).

use super::KnotVector;
use super::blossom;
use super::homogeneous::{Homogeneous, bounds};
use super::knots::{check_degree, with_scratch};
use super::net::{Net, lines};
use crate::Vec3;
use crate::surface::Local;

/// A rational tensor product patch on the square `[0,1]^2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bezier {
    degrees: [usize; 2],
    net: Net,
}

impl Bezier {
    /// The patch of degrees p and q; control point (i, j) and its weight are number i + (p+1) j. Fails unless there
    /// are (p+1)(q+1) of them, degrees 1 to 64, weights positive and all finite.
    pub fn new(degrees: [usize; 2], control: Vec<Vec3>, weights: Vec<f64>) -> Result<Self, String> {
        degrees.into_iter().try_for_each(check_degree)?;
        Ok(Self { degrees, net: Net::new((degrees[0] + 1) * (degrees[1] + 1), control, weights)? })
    }

    /// The degrees p and q.
    pub fn degrees(&self) -> [usize; 2] {
        self.degrees
    }

    /// Control points, (i, j) at i + (p+1) j.
    pub fn control(&self) -> &[Vec3] {
        &self.net.points
    }

    /// Weights of the control points.
    pub fn weights(&self) -> &[f64] {
        &self.net.weights
    }

    /// Lowest and highest value of each parameter.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    /// The patch at `xi`, which may lie outside the domain. A tangent is zero where an edge is one point.
    pub fn local(&self, xi: [f64; 2]) -> Local {
        with_scratch(self.degrees, |u, v| {
            bernstein(xi[0], u);
            bernstein(xi[1], v);
            self.net.local(0, u.len(), u, v)
        })
    }

    /// The parts with parameter number `direction` (0 or 1) below and above `t`, each on `[0,1]^2`; 0 < `t` < 1.
    pub fn split(&self, direction: usize, t: f64) -> [Self; 2] {
        let control = self.net.homogeneous();
        let knots = KnotVector::bezier(self.degrees[direction]);
        let mut parts = [control.clone(), control.clone()];
        for line in lines(self.degrees.map(|degree| degree + 1), direction) {
            let whole: Vec<_> = line.clone().map(|k| control[k]).collect();
            for (part, half) in parts.iter_mut().zip(blossom::split(&knots, &whole, t)) {
                line.clone().zip(half).for_each(|(k, point)| part[k] = point);
            }
        }
        parts.map(|control| Self::from_homogeneous(self.degrees, &control))
    }

    /// The patch of these control points, which are known to be good.
    pub(super) fn from_homogeneous(degrees: [usize; 2], control: &[Homogeneous<3>]) -> Self {
        Self { degrees, net: Net::from_homogeneous(control) }
    }

    /// Lower and upper corner of the box of the control points, which holds the patch.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(&self.net.points)
    }
}

/// Values, first and second derivatives at `t` of the Bernstein polynomials of degree `values.len() - 1`.
fn bernstein(t: f64, values: &mut [[f64; 3]]) {
    values[0] = [1.0, 0.0, 0.0];
    for degree in 1..values.len() {
        let mut carried = [0.0; 3];
        for value in &mut values[..degree] {
            let [b, slope, curvature] = [value[0], degree as f64 * value[0], degree as f64 * value[1]];
            *value = [carried[0] + (1.0 - t) * b, carried[1] - slope, carried[2] - curvature];
            carried = [t * b, slope, curvature];
        }
        values[degree] = carried;
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{check_derivatives, close, grid, inside, patches};
    use super::*;
    use proptest::prelude::*;

    /// By (39) to (41) as printed.
    fn printed(patch: &Bezier, xi: [f64; 2]) -> Vec3 {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let b = |i: usize, p: usize, t: f64| {
            factorial(p) / (factorial(i) * factorial(p - i)) * t.powi(i as i32) * (1.0 - t).powi((p - i) as i32)
        };
        let [p, q] = patch.degrees();
        let (mut above, mut below) = (Vec3::zeros(), 0.0);
        for j in 0..=q {
            for i in 0..=p {
                let k = i + (p + 1) * j;
                let factor = b(i, p, xi[0]) * b(j, q, xi[1]) * patch.weights()[k];
                above += patch.control()[k] * factor;
                below += factor;
            }
        }
        above / below
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn the_patch_is_the_printed_one_with_its_derivatives(patch in patches(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            close(&patch.local([s, t]).point, &printed(&patch, [s, t]), 1e-14);
            check_derivatives([3e-4; 2], [s, t], |xi| patch.local(xi));
            inside(&patch.local([s, t]).point, &patch.bounds());
            let far = patch.local([-0.01, 1.01]).point;
            close(&far, &printed(&patch, [-0.01, 1.01]), 1e-13);
        }

        #[test]
        fn parts_are_the_patch(patch in patches(), t in 0.0..1.0_f64) {
            let t = if t < 0.05 { 0.0 } else { t };
            for direction in 0..2 {
                let [below, above] = patch.split(direction, t);
                prop_assert_eq!(below.degrees(), patch.degrees());
                for xi in grid(4, patch.domain()) {
                    let within = |from: f64, to: f64| {
                        let place = from + (to - from) * xi[direction];
                        patch.local(std::array::from_fn(|a| if a == direction { place } else { xi[a] })).point
                    };
                    close(&below.local(xi).point, &within(0.0, t), 1e-14);
                    close(&above.local(xi).point, &within(t, 1.0), 1e-14);
                }
                let equal = |patch: &Bezier| patch.weights().iter().all(|weight| *weight == patch.weights()[0]);
                prop_assert!(!equal(&patch) || equal(&below) && equal(&above));
            }
        }
    }

    #[test]
    fn the_cubic_quarter_arc_has_its_known_error() {
        let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0);
        let arc = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]];
        let control = [0.0, 2.0].iter().flat_map(|z| arc.map(|[x, y]| Vec3::new(x, y, *z))).collect();
        let patch = Bezier::new([3, 1], control, vec![1.0; 8]).unwrap();
        let error = |k: usize| patch.local([k as f64 / 10000.0, 0.3]).point.xy().norm() - 1.0;
        let worst = (0..=10000).map(error).fold(0.0, f64::max);
        assert!((worst - 2.7253e-4).abs() < 1e-8, "{worst:e}");
        assert!((0..=10000).all(|k| error(k) > -1e-15) && error(5000).abs() < 1e-15);
    }

    #[test]
    fn small_patches_far_away_keep_their_digits() {
        let place = |i: usize, j: usize| Vec3::new(i as f64, j as f64, (i * i) as f64) * 1e-3;
        let control = |shift: f64| (0..9).map(|k| place(k % 3, k / 3) + Vec3::repeat(shift)).collect();
        let patch = |shift| Bezier::new([2, 2], control(shift), vec![3.0; 9]).unwrap();
        let (near, far) = (patch(0.0).local([0.3, 0.8]), patch(1024.0).local([0.3, 0.8]));
        // Coordinates are rounded to 1e-13, which leaves ten digits of the derivatives.
        assert!((near.tangents[0] - far.tangents[0]).norm() < 1e-12);
        assert!((near.second[0] - far.second[0]).norm() < 2e-12);
        assert!((far.second[1].norm() + far.second[2].norm()) < 1e-12);
    }

    #[test]
    fn wrong_patches_are_explained() {
        let fails = |degrees: [usize; 2], count: usize, weights: Vec<f64>, what: &str| {
            let message = Bezier::new(degrees, vec![Vec3::zeros(); count], weights).unwrap_err();
            assert!(message.contains(what), "{message}");
        };
        fails([0, 1], 2, vec![1.0; 2], "degree is 0");
        fails([1, usize::MAX], 4, vec![1.0; 4], "1 to 64");
        fails([1, 2], 5, vec![1.0; 5], "5 control points, but degrees and knots ask for 6");
        fails([1, 1], 4, vec![1.0; 3], "3 weights for 4");
        fails([1, 1], 4, vec![1.0, 1.0, 0.0, 1.0], "weight 3 is 0");
        fails([1, 1], 4, vec![1.0, f64::NAN, 1.0, 1.0], "weight 2 is NaN");
        fails([1, 1], 4, vec![1e-200, 1.0, 1.0, 1.0], "too far apart");
        let points = vec![Vec3::new(0.0, f64::INFINITY, 0.0); 4];
        assert!(Bezier::new([1, 1], points, vec![1.0; 4]).unwrap_err().contains("control point 1"));
    }
}
