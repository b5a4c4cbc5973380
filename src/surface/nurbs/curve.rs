//! A NURBS curve, equation (42) of [`super`].

use super::homogeneous::{Homogeneous, bounds, check, homogeneous, separate};
use super::knots::with_scratch;
use super::{KnotVector, blossom};
use nalgebra::{SMatrix, SVector};

/// A rational curve in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<const D: usize> {
    knots: KnotVector,
    points: Vec<SVector<f64, D>>,
    weights: Vec<f64>,
}

/// A point of a curve with its first and second derivatives in the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveLocal<const D: usize> {
    pub point: SVector<f64, D>,
    pub first: SVector<f64, D>,
    pub second: SVector<f64, D>,
}

impl<const D: usize> Curve<D> {
    /// Fails unless there are as many points and weights as the knots ask for, weights positive and all finite.
    pub fn new(knots: KnotVector, points: Vec<SVector<f64, D>>, weights: Vec<f64>) -> Result<Self, String> {
        check(knots.count(), &points, &weights)?;
        Ok(Self { knots, points, weights })
    }

    /// The knot vector.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// Control points.
    pub fn points(&self) -> &[SVector<f64, D>] {
        &self.points
    }

    /// Weights of the control points.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Lowest and highest parameter.
    pub fn domain(&self) -> [f64; 2] {
        self.knots.domain()
    }

    /// Lower and upper corner of the box of the control points, which holds the curve.
    pub fn bounds(&self) -> (SVector<f64, D>, SVector<f64, D>) {
        bounds(&self.points)
    }

    /// The curve at `t`; outside the domain the polynomial of the nearest span goes on.
    pub fn local(&self, t: f64) -> CurveLocal<D> {
        let [a, a1, a2] = with_scratch([self.knots.degree(), 0], |splines, _| {
            let first = self.knots.basis(t, splines);
            let mut sums = [Homogeneous::zero(); 3];
            for (k, spline) in splines.iter().enumerate() {
                let control = Homogeneous::new(&self.points[first + k], self.weights[first + k]);
                sums.iter_mut().zip(spline).for_each(|(sum, b)| sum.add(&control, *b));
            }
            sums
        });
        let point = a.point();
        let first = (a1.scaled - point * a1.weight) / a.weight;
        let second = (a2.scaled - first * (2.0 * a1.weight) - point * a2.weight) / a.weight;
        CurveLocal { point, first, second }
    }

    /// The curve run through from its end, on the same domain.
    pub fn reversed(&self) -> Self {
        let [start, end] = self.domain();
        let points = self.points.iter().rev().copied().collect();
        Self { knots: self.knots.onto([end, start]), points, weights: self.weights.iter().rev().copied().collect() }
    }

    /// The curve with every point x at `matrix` x + `translation`.
    pub fn transformed(&self, matrix: &SMatrix<f64, D, D>, translation: &SVector<f64, D>) -> Self {
        let points = self.points.iter().map(|point| matrix * point + translation).collect();
        Self { knots: self.knots.clone(), points, weights: self.weights.clone() }
    }

    /// The parts before and behind `t`, which keep their parameters. Fails unless `t` lies inside the domain.
    pub fn split(&self, t: f64) -> Result<[Self; 2], String> {
        let [start, end] = self.domain();
        if !(start < t && t < end) {
            return Err(format!("the curve runs from {start} to {end} and cannot be split at {t}"));
        }
        let [before, behind] = blossom::split(&self.knots, &self.homogeneous(), t);
        let [first, second] = self.knots.split(t);
        Ok([Self::from_homogeneous(first, &before), Self::from_homogeneous(second, &behind)])
    }

    /// The Bézier curves, each on [0, 1], that the curve consists of, with their intervals of the domain.
    pub fn beziers(&self) -> Vec<([f64; 2], Self)> {
        let control = self.homogeneous();
        let piece = |interval: [f64; 2]| {
            let knots = KnotVector::bezier(self.knots.degree());
            let points = self.bezier_points(&control, self.knots.span(interval[0]), interval);
            (interval, Self::from_homogeneous(knots, &points))
        };
        self.knots.spans().map(piece).collect()
    }

    /// The same curve with a higher degree, as Bézier pieces between `breaks`, all spans among them.
    pub(super) fn in_pieces(&self, degree: usize, breaks: &[f64]) -> Self {
        let control = self.homogeneous();
        let mut pieces = Vec::new();
        for interval in breaks.windows(2) {
            let span = self.knots.span(0.5 * (interval[0] + interval[1]));
            let mut piece = self.bezier_points(&control, span, [interval[0], interval[1]]);
            for _ in self.knots.degree()..degree {
                piece = blossom::elevate(&piece);
            }
            pieces.truncate(pieces.len().max(1) - 1);
            pieces.append(&mut piece);
        }
        Self::from_homogeneous(KnotVector::pieces(degree, breaks), &pieces)
    }

    /// The same curve with other knots, for a new domain.
    pub(super) fn with_knots(&self, knots: KnotVector) -> Self {
        Self { knots, ..self.clone() }
    }

    /// The curve of points and weights that are known to be good.
    pub(super) fn unchecked(knots: KnotVector, points: Vec<SVector<f64, D>>, weights: Vec<f64>) -> Self {
        Self { knots, points, weights }
    }

    fn homogeneous(&self) -> Vec<Homogeneous<D>> {
        homogeneous(&self.points, &self.weights)
    }

    fn from_homogeneous(knots: KnotVector, control: &[Homogeneous<D>]) -> Self {
        let (points, weights) = separate(control);
        Self { knots, points, weights }
    }

    fn bezier_points(&self, control: &[Homogeneous<D>], span: usize, interval: [f64; 2]) -> Vec<Homogeneous<D>> {
        let mut line = control[span - self.knots.degree()..=span].to_vec();
        blossom::to_bezier(&self.knots, span, interval, &mut line);
        line
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{close, curves, derivative, inside, oblique, on_curve};
    use super::*;
    use crate::{Mat3, Vec3};
    use nalgebra::Vector2;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn derivatives_match_differences(curve in curves::<3>(), s in 0.01..0.99_f64) {
            for [start, end] in curve.knots().spans() {
                let (h, t) = (3e-4 * (end - start), start + s * (end - start));
                let here = curve.local(t);
                close(&here.first, &derivative(h, |s| curve.local(t + s).point), 1e-7);
                close(&here.second, &derivative(h, |s| curve.local(t + s).first), 1e-7);
                inside(&here.point, &curve.bounds());
            }
        }

        #[test]
        fn pieces_and_parts_are_the_curve(curve in curves::<2>(), s in 0.01..0.99_f64) {
            let pieces = curve.beziers();
            for ([start, end], piece) in &pieces {
                prop_assert_eq!(piece.domain(), [0.0, 1.0]);
                for k in 0..=8 {
                    let xi = k as f64 / 8.0;
                    let t = start + (end - start) * xi;
                    on_curve(&piece.local(xi).point, &curve, t);
                }
            }
            for pair in pieces.windows(2) {
                let degree = curve.knots().degree();
                prop_assert_eq!(pair[0].1.points()[degree], pair[1].1.points()[0]);
            }
            let [start, end] = curve.domain();
            let inner = pieces.iter().skip(1).map(|([low, _], _)| *low);
            for at in inner.chain([start + s * (end - start)]) {
                let [before, behind] = curve.split(at).unwrap();
                prop_assert_eq!((before.domain(), behind.domain()), ([start, at], [at, end]));
                for part in [&before, &behind] {
                    let (knots, [low, high]) = (part.knots(), part.domain());
                    prop_assert!(KnotVector::new(knots.degree(), knots.knots().to_vec()).is_ok());
                    prop_assert_eq!((knots.count(), part.weights().len()), (part.points().len(), part.points().len()));
                    for k in 0..=8 {
                        let t = low + (high - low) * k as f64 / 8.0;
                        on_curve(&part.local(t).point, &curve, t);
                    }
                }
            }
            prop_assert!(curve.split(start).is_err() && curve.split(end).is_err() && curve.split(f64::NAN).is_err());
        }

        #[test]
        fn higher_degrees_reversal_and_maps_keep_the_curve(curve in curves::<3>(), s in 0.0..1.0_f64) {
            let [start, end] = curve.domain();
            let degree = curve.knots().degree();
            let mut breaks: Vec<f64> = curve.knots().spans().flatten().chain([start + 0.37 * (end - start)]).collect();
            breaks.sort_by(f64::total_cmp);
            breaks.dedup();
            let (higher, reversed) = (curve.in_pieces(degree + 2, &breaks), curve.reversed());
            let matrix = Mat3::from_fn(|a, b| (a as f64 + 0.5) * 0.3 - (b * b) as f64 * 0.2);
            let mapped = curve.transformed(&matrix, &oblique());
            prop_assert_eq!((higher.domain(), reversed.domain()), (curve.domain(), curve.domain()));
            prop_assert_eq!(higher.knots().degree(), degree + 2);
            let t = start + s * (end - start);
            let (here, back) = (curve.local(t), reversed.local(end - (t - start)));
            on_curve(&higher.local(t).point, &curve, t);
            close(&higher.local(t).second, &here.second, 1e-11);
            on_curve(&back.point, &curve, t);
            close(&-back.first, &here.first, 1e-11);
            close(&mapped.local(t).point, &(matrix * here.point + oblique()), 1e-14);
            close(&mapped.local(t).second, &(matrix * here.second), 1e-11);
        }
    }

    #[test]
    fn a_periodic_spline_closes_smoothly() {
        let corners = [[1.0, 0.0], [0.3, 1.2], [-0.8, 0.4], [-0.5, -1.0], [0.6, -0.7]];
        let points: Vec<_> = (0..8).map(|k| Vector2::from(corners[k % 5])).collect();
        let knots = KnotVector::new(3, (-3..=8).map(|k| k as f64).collect()).unwrap();
        let curve = Curve::new(knots, points, vec![1.0; 8]).unwrap();
        assert_eq!(curve.domain(), [0.0, 5.0]);
        let (start, end) = (curve.local(0.0), curve.local(5.0));
        close(&start.point, &end.point, 1e-15);
        close(&start.first, &end.first, 1e-15);
        close(&start.second, &end.second, 1e-14);
        let pieces = curve.beziers();
        close(&pieces[0].1.points()[0], &pieces[4].1.points()[3], 1e-15);
    }

    #[test]
    fn near_knots_neither_lose_digits_nor_leave_the_hull() {
        for gap in [1e-8, 1e-13, 1.2e-16] {
            let inner = [0.5, 0.5 + gap, 0.5 + 2.0 * gap, 0.7];
            let knots = KnotVector::new(3, [&[0.0; 4], &inner[..], &[1.0; 4]].concat()).unwrap();
            let points = (0..8).map(|k| Vec3::new(k as f64, (k * k % 5) as f64, (k as f64).sin())).collect();
            let curve = Curve::new(knots, points, vec![1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.7, 1.0]).unwrap();
            for ([start, end], piece) in curve.beziers() {
                piece.points().iter().for_each(|point| inside(point, &curve.bounds()));
                if end - start > 1e-3 {
                    for k in 0..=10 {
                        let xi = k as f64 / 10.0;
                        on_curve(&piece.local(xi).point, &curve, start + (end - start) * xi);
                    }
                }
            }
        }
    }

    #[test]
    fn wrong_curves_are_explained() {
        let curve = |count| Curve::new(KnotVector::bezier(2), vec![Vec3::zeros(); count], vec![1.0; count]);
        assert!(curve(3).is_ok());
        assert!(curve(4).unwrap_err().contains("4 control points, but degrees and knots ask for 3"));
        assert!(curve(3).unwrap().split(1.5).unwrap_err().contains("cannot be split at 1.5"));
    }
}
