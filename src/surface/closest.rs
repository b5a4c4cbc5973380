//! The closest point of one Bézier patch or NURBS surface, for single questions; many points are the business of
//! [`super::FaceSet`].
//!
//! Patches are taken by rising distance of their boxes. Each gives a point by descent, and is halved unless it is
//! certain that there is no other minimum on it, until no box is closer than the best point.

use super::cell::{Cell, halve};
use super::nurbs::{Bezier, Nurbs, Rectangle};
use super::parametric::{Closest, Local, Parametric};
use super::projection::{Extent, descend};
use crate::Vec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// As many patches are looked at; more are needed only where very many points are almost equally close.
const PATCHES: usize = 4000;
/// Distances that differ by less, over the size of the surface, are equal.
const EQUAL: f64 = 1e-12;

impl Parametric for Bezier {
    fn domain(&self) -> [[f64; 2]; 2] {
        Self::domain(self)
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        Self::local(self, xi)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        Self::bounds(self)
    }

    fn closest(&self, x: &Vec3) -> Closest {
        closest_of(vec![(Self::domain(self), self.clone())], x)
    }
}

impl Parametric for Nurbs {
    fn domain(&self) -> [[f64; 2]; 2] {
        Self::domain(self)
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        Self::local(self, xi)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        Self::bounds(self)
    }

    fn closest(&self, x: &Vec3) -> Closest {
        closest_of(self.beziers(), x)
    }
}

/// A patch that may hold the closest point; the one with the nearest box is the greatest.
struct Open {
    bound: f64,
    rect: Rectangle,
    bezier: Bezier,
}

impl Open {
    fn new(rect: Rectangle, bezier: Bezier, x: &Vec3) -> Self {
        let (low, high) = bezier.bounds();
        Self { bound: (x - x.sup(&low).inf(&high)).norm(), rect, bezier }
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

fn closest_of(patches: Vec<(Rectangle, Bezier)>, x: &Vec3) -> Closest {
    let mut open: BinaryHeap<Open> = patches.into_iter().map(|(rect, bezier)| Open::new(rect, bezier, x)).collect();
    let mut best = Closest { xi: [f64::NAN; 2], point: Vec3::repeat(f64::NAN), distance: f64::INFINITY };
    let mut slack = 0.0;
    for _ in 0..PATCHES {
        let Some(Open { bound, rect, bezier }) = open.pop().filter(|next| next.bound < best.distance - slack) else {
            break;
        };
        let cell = Cell::new(bezier);
        let extent = Extent::new(&cell);
        let foot = descend(&cell, x, &[0.0; 4], [0.5; 2]);
        slack = f64::max(slack, EQUAL * extent.radius);
        if foot.distance < best.distance {
            let xi = std::array::from_fn(|a| rect[a][0] + (rect[a][1] - rect[a][0]) * foot.xi[a]);
            best = Closest { xi, point: foot.local.point, distance: foot.distance };
        }
        if bound < best.distance - slack && !extent.has_one_minimum(&cell, x) {
            let (halves, rects) = halve(&cell.bezier, rect, cell.long_direction());
            open.extend(halves.into_iter().zip(rects).map(|(half, rect)| Open::new(rect, half, x)));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Curve;
    use crate::surface::test_meshes::random_bezier;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_torus_has_its_closed_form() {
        let circle = Curve::arc(Vec3::x() * 3.0, Vec3::x(), Vec3::z(), 1.0, [0.0, TAU]).unwrap();
        let torus = Nurbs::revolution(&circle, Vec3::zeros(), Vec3::z(), [0.0, TAU]).unwrap();
        for k in 0..40 {
            let k = k as f64;
            let x = Vec3::new((1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin()) * (0.15 * k + 0.1);
            let ring = Vec3::new(x.x, x.y, 0.0).normalize() * 3.0;
            let best = torus.closest(&x);
            assert!((best.distance - ((x - ring).norm() - 1.0).abs()).abs() < 1e-13, "{x}");
            assert!((torus.point(best.xi) - best.point).norm() < 1e-13);
            assert!((x - best.point).norm() == best.distance);
        }
        assert!((torus.closest(&Vec3::zeros()).distance - 2.0).abs() < 1e-13);
        assert!(torus.closest(&Vec3::repeat(f64::NAN)).distance.is_infinite());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn no_sample_of_a_bezier_patch_is_closer(
            bezier in random_bezier(5),
            x in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            unit in prop_oneof![Just(1.0), Just(1e-9), Just(1e9)],
        ) {
            let points = bezier.control().iter().map(|p| p * unit).collect();
            let bezier = Bezier::new(bezier.degrees(), points, bezier.weights().to_vec()).unwrap();
            let x = Vec3::from(x) * unit;
            let best = bezier.closest(&x);
            prop_assert!((bezier.local(best.xi).point - best.point).norm() <= 1e-13 * unit);
            for k in 0..10_000 {
                let xi = [(k % 100) as f64 / 99.0, (k / 100) as f64 / 99.0];
                let distance = (x - bezier.local(xi).point).norm();
                prop_assert!(best.distance <= distance + 1e-12 * unit, "{} at {xi:?}", best.distance - distance);
            }
        }
    }
}
