//! A NURBS surface, equation (45) of [`super`].

use super::homogeneous::{Homogeneous, bounds};
use super::knots::with_scratch;
use super::net::{Net, lines};
use super::{Bezier, KnotVector, blossom};
use crate::surface::Local;
use crate::{Mat3, Vec3};

/// Lowest and highest value of each parameter.
pub type Rectangle = [[f64; 2]; 2];

/// A rational tensor product surface on a rectangle of parameters (u, v).
#[derive(Clone, Debug, PartialEq)]
pub struct Nurbs {
    knots: [KnotVector; 2],
    net: Net,
}

impl Nurbs {
    /// Control point (i, j) and its weight are number i + n j, with n = `knots[0].count()`. Fails unless there are as
    /// many as the knot vectors ask for, weights positive and all finite.
    pub fn new(knots: [KnotVector; 2], points: Vec<Vec3>, weights: Vec<f64>) -> Result<Self, String> {
        let count = knots[0].count().checked_mul(knots[1].count()).ok_or("too many knots")?;
        Ok(Self { knots, net: Net::new(count, points, weights)? })
    }

    /// The knot vectors of u and v.
    pub fn knots(&self) -> &[KnotVector; 2] {
        &self.knots
    }

    /// Control points, (i, j) at i + n j.
    pub fn points(&self) -> &[Vec3] {
        &self.net.points
    }

    /// Weights of the control points.
    pub fn weights(&self) -> &[f64] {
        &self.net.weights
    }

    /// Lowest and highest value of u and of v.
    pub fn domain(&self) -> Rectangle {
        [self.knots[0].domain(), self.knots[1].domain()]
    }

    /// The surface at (u, v); outside the domain the polynomials of the nearest spans go on. A tangent is zero where an
    /// edge is one point (the pole of a sphere), and there the cross product of the tangents is no normal.
    pub fn local(&self, [u, v]: [f64; 2]) -> Local {
        let [along_u, along_v] = &self.knots;
        with_scratch([along_u.degree(), along_v.degree()], |splines_u, splines_v| {
            let (i, j) = (along_u.basis(u, splines_u), along_v.basis(v, splines_v));
            let stride = along_u.count();
            self.net.local(i + stride * j, stride, splines_u, splines_v)
        })
    }

    /// Lower and upper corner of the box of the control points, which holds the surface.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(&self.net.points)
    }

    /// The surface with u and v exchanged, and so the other side out.
    pub fn swapped(&self) -> Self {
        let [along_u, along_v] = &self.knots;
        let order = || lines([along_u.count(), along_v.count()], 1).flatten();
        let points = order().map(|k| self.net.points[k]).collect();
        let weights = order().map(|k| self.net.weights[k]).collect();
        Self::unchecked([along_v.clone(), along_u.clone()], points, weights)
    }

    /// The surface with every point x at `matrix` x + `translation`.
    pub fn transformed(&self, matrix: &Mat3, translation: &Vec3) -> Self {
        let points = self.net.points.iter().map(|point| matrix * point + translation).collect();
        Self::unchecked(self.knots.clone(), points, self.net.weights.clone())
    }

    /// The Bézier patches that the surface consists of, with their parts of the domain: the patch at xi is the surface
    /// at u = u0 + (u1 - u0) xi_1, v = v0 + (v1 - v0) xi_2. v runs slowest. Edges that two of them share have the same
    /// control points to the last digit.
    pub fn beziers(&self) -> Vec<(Rectangle, Bezier)> {
        let control = self.net.homogeneous();
        let mut patches = Vec::new();
        for v in self.knots[1].spans() {
            for u in self.knots[0].spans() {
                patches.push(([u, v], self.bezier(&control, [u, v])));
            }
        }
        patches
    }

    /// The patch on one span of u times one of v; `control` are all control points of the surface.
    fn bezier(&self, control: &[Homogeneous<3>], intervals: Rectangle) -> Bezier {
        let degrees = [0, 1].map(|a| self.knots[a].degree());
        let spans = [0, 1].map(|a| self.knots[a].span(intervals[a][0]));
        let row = |j: usize| {
            let last = j * self.knots[0].count() + spans[0];
            &control[last - degrees[0]..=last]
        };
        let mut net = (spans[1] - degrees[1]..=spans[1]).map(row).collect::<Vec<_>>().concat();
        for a in 0..2 {
            for line in lines(degrees.map(|degree| degree + 1), a) {
                let mut points: Vec<_> = line.clone().map(|k| net[k]).collect();
                blossom::to_bezier(&self.knots[a], spans[a], intervals[a], &mut points);
                line.zip(points).for_each(|(k, point)| net[k] = point);
            }
        }
        Bezier::from_homogeneous(degrees, &net)
    }

    /// The surface of points and weights that are known to be good.
    pub(super) fn unchecked(knots: [KnotVector; 2], points: Vec<Vec3>, weights: Vec<f64>) -> Self {
        Self { knots, net: Net::unchecked(points, weights) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Curve;
    use super::super::testing::{check_derivatives, close, grid, inside, oblique, surfaces};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn derivatives_match_differences(surface in surfaces(), s in 0.01..0.99_f64, t in 0.01..0.99_f64) {
            let [along_u, along_v] = surface.knots();
            for u in along_u.spans() {
                for v in along_v.spans() {
                    let (du, dv) = (u[1] - u[0], v[1] - v[0]);
                    let place = [u[0] + s * du, v[0] + t * dv];
                    check_derivatives([3e-4 * du, 3e-4 * dv], place, |place| surface.local(place));
                    inside(&surface.local(place).point, &surface.bounds());
                }
            }
        }

        #[test]
        fn lines_of_constant_parameter_are_curves_of_the_net(surface in surfaces(), s in 0.0..1.0_f64) {
            // Clamped or not, the surface at v is the curve through the points that the curves along v have there.
            let [[start, end], [low, high]] = surface.domain();
            let (u, v) = (start + s * (end - start), high - s * (high - low));
            let [along_u, along_v] = surface.knots();
            let along_column = |i: usize, value: &dyn Fn(usize) -> Vec3| {
                let points = (0..along_v.count()).map(|j| value(i + along_u.count() * j)).collect();
                Curve::new(along_v.clone(), points, vec![1.0; along_v.count()]).unwrap().local(v).point
            };
            let weight = |k: usize| Vec3::repeat(surface.weights()[k]);
            let scaled = |k: usize| surface.points()[k] * surface.weights()[k];
            let weights: Vec<f64> = (0..along_u.count()).map(|i| along_column(i, &weight).x).collect();
            let points = (0..along_u.count()).map(|i| along_column(i, &scaled) / weights[i]).collect();
            let curve = Curve::new(along_u.clone(), points, weights).unwrap().local(u);
            let here = surface.local([u, v]);
            close(&here.point, &curve.point, 1e-14);
            close(&here.tangents[0], &curve.first, 1e-12);
            close(&here.second[0], &curve.second, 1e-11);
        }

        #[test]
        fn patches_are_the_surface_and_share_their_edges(surface in surfaces()) {
            let patches = surface.beziers();
            let [columns, rows] = [0, 1].map(|a| surface.knots()[a].spans().count());
            prop_assert_eq!(patches.len(), columns * rows);
            for (k, ([u, v], patch)) in patches.iter().enumerate() {
                let [p, q] = patch.degrees();
                for xi in grid(3, patch.domain()) {
                    let place = [u[0] + (u[1] - u[0]) * xi[0], v[0] + (v[1] - v[0]) * xi[1]];
                    let here = surface.local(place);
                    let slope = here.tangents[0].norm() * place[0].abs() + here.tangents[1].norm() * place[1].abs();
                    close(&patch.local(xi).point, &here.point, 1e-14 + 4.0 * f64::EPSILON * slope);
                }
                let edge = |patch: &Bezier, first: usize, step: usize, count: usize| {
                    let numbers = (0..count).map(|k| first + k * step);
                    numbers.map(|k| (patch.control()[k], patch.weights()[k])).collect::<Vec<_>>()
                };
                if (k + 1) % columns > 0 {
                    let next = &patches[k + 1].1;
                    prop_assert_eq!(edge(patch, p, p + 1, q + 1), edge(next, 0, p + 1, q + 1));
                }
                if k + columns < patches.len() {
                    let next = &patches[k + columns].1;
                    prop_assert_eq!(edge(patch, (p + 1) * q, 1, p + 1), edge(next, 0, 1, p + 1));
                }
            }
        }

        #[test]
        fn swapping_and_maps(surface in surfaces(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            let [[start, end], [low, high]] = surface.domain();
            let [u, v] = [start + s * (end - start), low + t * (high - low)];
            let matrix = Mat3::from_fn(|a, b| (a as f64 + 0.5) * 0.3 - (b * b) as f64 * 0.2);
            let mapped = surface.transformed(&matrix, &oblique());
            let (here, swapped) = (surface.local([u, v]), surface.swapped().local([v, u]));
            close(&swapped.point, &here.point, 1e-14);
            close(&swapped.area_vector(), &-here.area_vector(), 1e-12);
            close(&swapped.second[2], &here.second[0], 1e-11);
            close(&mapped.local([u, v]).point, &(matrix * here.point + oblique()), 1e-14);
            close(&mapped.local([u, v]).second[1], &(matrix * here.second[1]), 1e-11);
            prop_assert_eq!(surface.swapped().swapped(), surface);
        }
    }

    #[test]
    fn high_degrees_work() {
        let mut inner: Vec<f64> = (1..6).map(|k| (k as f64 * 0.37).sin().abs()).collect();
        inner.sort_by(f64::total_cmp);
        let knots = KnotVector::new(25, [vec![0.0; 26], inner, vec![1.0; 26]].concat()).unwrap();
        let knots = [knots, KnotVector::bezier(11)];
        let count = knots[0].count() * knots[1].count();
        let point = |k: usize| Vec3::new((k as f64).sin(), (k as f64 * 0.7).cos(), (k as f64 * 1.3).sin());
        let weights = (0..count).map(|k| 1.5 + (k as f64).cos()).collect();
        let surface = Nurbs::new(knots, (0..count).map(point).collect(), weights).unwrap();
        for ([u, v], patch) in surface.beziers() {
            let place = [0.3 * u[0] + 0.7 * u[1], 0.6 * v[0] + 0.4 * v[1]];
            check_derivatives([1e-4 * (u[1] - u[0]), 1e-4], place, |place| surface.local(place));
            close(&patch.local([0.7, 0.4]).point, &surface.local(place).point, 1e-13);
        }
    }

    #[test]
    fn wrong_surfaces_are_explained() {
        let surface = |count| {
            Nurbs::new([KnotVector::bezier(2), KnotVector::bezier(1)], vec![Vec3::zeros(); count], vec![1.0; count])
        };
        assert!(surface(6).is_ok());
        assert!(surface(5).unwrap_err().contains("5 control points, but degrees and knots ask for 6"));
    }
}
