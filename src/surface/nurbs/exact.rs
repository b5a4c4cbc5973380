//! Shapes that curves and surfaces represent exactly: lines, arcs, planes, ruled surfaces, surfaces of revolution.
//!
//! An arc of the half angle h is the quadratic with the weights 1, cos h, 1 whose middle control point is where the
//! tangents of the ends meet. Where its parameter, from -1 to 1, is s, the angle from its middle is phi with
//!
//! ```text
//!     tan(phi/2) = s tan(h/2)
//! ```
//!
//! Longer arcs consist of equal ones of 90 degrees at most (Piegl and Tiller, The NURBS Book, 1997, chapter 7).

use super::{Curve, KnotVector, Nurbs};
use crate::Vec3;
use nalgebra::{SVector, Vector2};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Sweeps this near to a full turn, in radians, are full turns.
const CLOSED: f64 = 1e-9;
/// Distance to the axis, over the size of the curve, below which a point of a surface of revolution is on the axis.
const ON_AXIS: f64 = 1e-14;

impl<const D: usize> Curve<D> {
    /// The line from `a` (t = 0) to `b` (t = 1).
    pub fn line(a: SVector<f64, D>, b: SVector<f64, D>) -> Self {
        Self::unchecked(KnotVector::bezier(1), vec![a, b], vec![1.0; 2])
    }

    /// Lines from point to point; t = k at point k, from 0. Fails unless there are two points at least.
    pub fn polyline(points: Vec<SVector<f64, D>>) -> Result<Self, String> {
        if points.len() < 2 {
            return Err(format!("a polyline of {} points; it takes 2 at least", points.len()));
        }
        let breaks: Vec<f64> = (0..points.len()).map(|k| k as f64).collect();
        let weights = vec![1.0; points.len()];
        Self::new(KnotVector::pieces(1, &breaks), points, weights)
    }

    /// The arc center + radius (x_axis cos a + y_axis sin a), a from `from` to `to` in radians; its parameter runs over
    /// the same interval and is the angle at ends and middles of equal pieces of 90 degrees at most, nearly the angle
    /// between. Axes that are not orthogonal unit vectors give an ellipse. Fails unless `from` < `to` <= `from` + 2 pi.
    pub fn arc(
        center: SVector<f64, D>,
        x_axis: SVector<f64, D>,
        y_axis: SVector<f64, D>,
        radius: f64,
        sweep: [f64; 2],
    ) -> Result<Self, String> {
        let circle = unit_arc(sweep)?;
        let points = circle.points().iter().map(|p| center + (x_axis * p.x + y_axis * p.y) * radius).collect();
        Self::new(circle.knots().clone(), points, circle.weights().to_vec())
    }
}

impl Nurbs {
    /// The parallelogram corner + u edge_u + v edge_v on `[0,1]^2`.
    pub fn plane(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Self {
        Self::extrusion(&Curve::line(corner, corner + edge_u), edge_v)
    }

    /// Straight lines from points of `first` (v = 0) to those of `second` (v = 1) at the same place of their domains,
    /// of which u takes that of `first`. Where their weights differ, v advances unevenly.
    pub fn ruled(first: &Curve<3>, second: &Curve<3>) -> Self {
        let (first, second) = compatible(first, second);
        let points = [first.points(), second.points()].concat();
        let weights = [first.weights(), second.weights()].concat();
        Self::unchecked([first.knots().clone(), KnotVector::bezier(1)], points, weights)
    }

    /// The point of `curve` at u moved by v `direction`, 0 <= v <= 1.
    pub fn extrusion(curve: &Curve<3>, direction: Vec3) -> Self {
        let moved = curve.points().iter().map(|point| point + direction);
        let points = curve.points().iter().copied().chain(moved).collect();
        Self::unchecked([curve.knots().clone(), KnotVector::bezier(1)], points, curve.weights().repeat(2))
    }

    /// `curve` (along u) turned about the axis through `point`: v runs over the angles of `sweep`, in radians and by
    /// the right-hand rule, and is related to the angle as the parameter of [`Curve::arc`] is. S,u x S,v points towards
    /// the axis where the curve runs along it, [`Self::swapped`] away from it. Points of the curve on the axis are
    /// poles. Fails unless the axis has a length and the angles increase by 2 pi at most.
    pub fn revolution(curve: &Curve<3>, point: Vec3, axis: Vec3, sweep: [f64; 2]) -> Result<Self, String> {
        let axis = axis.try_normalize(0.0).filter(|axis| axis.iter().all(|x| x.is_finite()));
        let axis = axis.ok_or("the axis of a surface of revolution needs a finite length above 0")?;
        let circle = unit_arc(sweep)?;
        let size = curve.points().iter().fold(0.0, |size, x| f64::max(size, (x - point).norm()));
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for (turn, weight) in circle.points().iter().zip(circle.weights()) {
            for (control, own) in curve.points().iter().zip(curve.weights()) {
                let along = axis * (control - point).dot(&axis);
                let arm = control - point - along;
                let arm = if arm.norm() <= ON_AXIS * size { Vec3::zeros() } else { arm };
                points.push(point + along + arm * turn.x + axis.cross(&arm) * turn.y);
                weights.push(own * weight);
            }
        }
        Self::new([curve.knots().clone(), circle.knots().clone()], points, weights)
    }
}

/// The arc of the unit circle over the angles from `from` to `to`.
fn unit_arc([from, to]: [f64; 2]) -> Result<Curve<2>, String> {
    let sweep = to - from;
    if !(sweep > 0.0 && sweep <= TAU + CLOSED) {
        return Err(format!("an arc from {from} to {to}; it takes an angle above 0 up to 2 pi"));
    }
    let count = ((sweep / FRAC_PI_2 - CLOSED).ceil() as usize).max(1);
    let closed = sweep >= TAU - CLOSED;
    let half = if closed { TAU } else { sweep } / (2 * count) as f64;
    let on_circle = |k: usize| {
        let (sin, cos) = (from + half * if closed { k % (2 * count) } else { k } as f64).sin_cos();
        Vector2::new(cos, sin)
    };
    let (mut points, mut weights) = (vec![on_circle(0)], vec![1.0]);
    for k in 0..count {
        points.extend([on_circle(2 * k + 1) / half.cos(), on_circle(2 * k + 2)]);
        weights.extend([half.cos(), 1.0]);
    }
    let at = |k: usize| if k == count { to } else { from + sweep * (k as f64 / count as f64) };
    let knots = KnotVector::pieces(2, &(0..=count).map(at).collect::<Vec<_>>());
    Ok(Curve::unchecked(knots, points, weights))
}

/// The two curves with the same knots, those of the first where both have them, on its domain.
fn compatible(first: &Curve<3>, second: &Curve<3>) -> (Curve<3>, Curve<3>) {
    let [start, end] = first.domain();
    let relative = |[start, end]: [f64; 2]| start.abs().max(end.abs()) / (end - start);
    let rounding = 16.0 * f64::EPSILON * (end - start) * (relative(first.domain()) + relative(second.domain()));
    let same = |a: f64, b: f64| (a - b).abs() <= rounding;
    let (own, other) = (first.knots(), &second.knots().onto([start, end]));
    let paired =
        own.knots().len() == other.knots().len() && own.knots().iter().zip(other.knots()).all(|(a, b)| same(*a, *b));
    if own.degree() == other.degree() && paired {
        return (first.clone(), second.with_knots(own.clone()));
    }
    let mut breaks: Vec<f64> = own.spans().map(|[low, _]| low).chain([end]).collect();
    let fresh = |t: &f64| !same(breaks[breaks.partition_point(|b| *b < t - rounding).min(breaks.len() - 1)], *t);
    let others: Vec<f64> = other.spans().map(|[low, _]| low).filter(fresh).collect();
    breaks.extend(others);
    breaks.sort_by(f64::total_cmp);
    let degree = own.degree().max(other.degree());
    (first.in_pieces(degree, &breaks), second.with_knots(other.clone()).in_pieces(degree, &breaks))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{close, grid, oblique};
    use super::*;
    use crate::surface::Local;
    use nalgebra::Matrix2;
    use std::f64::consts::PI;

    /// Unit vectors e, f and axis that make a right-handed frame.
    fn frame() -> [Vec3; 3] {
        let axis = oblique().normalize();
        let e = axis.cross(&Vec3::x()).normalize();
        [e, axis.cross(&e), axis]
    }

    const CENTER: Vec3 = Vec3::new(0.4, -1.3, 2.0);

    /// The unit normal and the larger and smaller principal curvature, positive where the surface bends towards it.
    fn shape(local: &Local) -> (Vec3, [f64; 2]) {
        let [t, u] = &local.tangents;
        let normal = local.area_vector().normalize();
        let [b11, b12, b22] = local.second.map(|second| second.dot(&normal));
        let metric = Matrix2::new(t.norm_squared(), t.dot(u), t.dot(u), u.norm_squared());
        let map = metric.try_inverse().unwrap() * Matrix2::new(b11, b12, b12, b22);
        let (mean, det) = (0.5 * map.trace(), map.determinant());
        let root = (mean * mean - det).max(0.0).sqrt();
        (normal, [mean + root, mean - root])
    }

    /// The surface against a closed form: for each of its points the normal and the principal curvatures, or nothing
    /// where it is a pole; `distance` is zero on the shape.
    fn check(surface: &Nurbs, distance: impl Fn(&Vec3) -> f64, truth: impl Fn(&Vec3) -> Option<(Vec3, [f64; 2])>) {
        for place in grid(24, surface.domain()) {
            let local = surface.local(place);
            let numbers = local.tangents.iter().chain(&local.second).chain([&local.point]);
            assert!(numbers.flat_map(|v| v.iter()).all(|x| x.is_finite()));
            assert!(distance(&local.point).abs() < 1e-14, "{:e} at {place:?}", distance(&local.point));
            if let Some((normal, curvatures)) = truth(&local.point) {
                let (own, bends) = shape(&local);
                close(&own, &normal, 1e-14);
                // The curvatures come from a root, which halves the digits where they are equal.
                let sum = bends[0] + bends[1] - curvatures[0] - curvatures[1];
                let product = bends[0] * bends[1] - curvatures[0] * curvatures[1];
                assert!(sum.abs() < 1e-12 && product.abs() < 1e-12, "{bends:?} is not {curvatures:?}");
            }
        }
    }

    #[test]
    fn arcs_follow_their_closed_form() {
        let (x, y) = (Vector2::new(0.6, 0.8), Vector2::new(-0.8, 0.6));
        let center = Vector2::new(3.0, -1.0);
        for [from, to] in [[0.0, 0.3], [-1.0, 1.5], [0.2, PI], [0.0, 1.5 * PI], [1.0, 1.0 + TAU]] {
            let arc = Curve::arc(center, x, y, 2.5, [from, to]).unwrap();
            assert_eq!(arc.domain(), [from, to]);
            for [start, end] in arc.knots().spans() {
                assert!(end - start < FRAC_PI_2 * (1.0 + 1e-9));
                let (tan, slope) = ((0.25 * (end - start)).tan(), 2.0 / (end - start));
                for k in 0..10 {
                    // tan(phi/2) = s tan(h/2), with phi' and phi'' by the chain rule; phi'' jumps between pieces.
                    let s = -0.9 + 0.2 * k as f64;
                    let phi = 2.0 * (s * tan).atan();
                    let first = 2.0 * tan / (1.0 + (s * tan).powi(2)) * slope;
                    let second = -first * 2.0 * s * tan * tan / (1.0 + (s * tan).powi(2)) * slope;
                    let (sin, cos) = (0.5 * (start + end) + phi).sin_cos();
                    let (radial, around) = ((x * cos + y * sin) * 2.5, (y * cos - x * sin) * 2.5);
                    let local = arc.local(0.5 * (start + end) + s * 0.5 * (end - start));
                    close(&local.point, &(center + radial), 1e-14);
                    close(&local.first, &(around * first), 1e-14);
                    close(&local.second, &(around * second - radial * (first * first)), 4e-14);
                }
            }
        }
        let circle = Curve::arc(center, x, y, 2.5, [0.3, 0.3 + TAU]).unwrap();
        assert_eq!((circle.points()[0], circle.points().len()), (circle.points()[8], 9));
        let ellipse = Curve::arc(center, x * 2.0, y, 1.5, [0.0, 4.0]).unwrap();
        for k in 0..=20 {
            let arm = ellipse.local(0.2 * k as f64).point - center;
            assert!(((arm.dot(&x) / 3.0).powi(2) + (arm.dot(&y) / 1.5).powi(2) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn cylinders_and_cones() {
        let [e, _, axis] = frame();
        for sweep in [[0.0, FRAC_PI_2], [-2.0, 3.0], [0.0, TAU]] {
            let line = Curve::line(CENTER + e * 1.5 - axis, CENTER + e * 1.5 + axis * 2.0);
            let cylinder = Nurbs::revolution(&line, CENTER, axis * 3.0, sweep).unwrap();
            let arm = |x: &Vec3| (x - CENTER) - axis * (x - CENTER).dot(&axis);
            let truth = |x: &Vec3| Some((-arm(x) / 1.5, [1.0 / 1.5, 0.0]));
            check(&cylinder, |x| arm(x).norm() / 1.5 - 1.0, truth);
            check(&cylinder.swapped(), |x| arm(x).norm() / 1.5 - 1.0, |x| Some((arm(x) / 1.5, [0.0, -1.0 / 1.5])));
            // An apex where the radius grows by 0.5 along the axis.
            let apex = CENTER - axis * 0.5;
            let cone = Nurbs::revolution(&Curve::line(apex, apex + e + axis * 2.0), CENTER, axis, sweep).unwrap();
            let (sin, cos) = (0.2_f64.sqrt(), 0.8_f64.sqrt());
            let height = |x: &Vec3| (x - apex).dot(&axis);
            let radial = |x: &Vec3| (x - apex) - axis * height(x);
            let truth = |x: &Vec3| {
                let radius = radial(x).norm();
                (radius > 0.1).then(|| (axis * sin - radial(x) * (cos / radius), [cos / radius, 0.0]))
            };
            check(&cone, |x| radial(x).norm() - 0.5 * height(x), truth);
            for v in [sweep[0], 0.5 * (sweep[0] + sweep[1]), sweep[1]] {
                let local = cone.local([0.0, v]);
                close(&local.point, &apex, 1e-15);
                assert!(local.tangents[1].norm() < 1e-15 && local.tangents[0].norm() > 1.0);
            }
        }
    }

    #[test]
    fn spheres_have_poles_with_one_tangent() {
        let [e, _, axis] = frame();
        let half = Curve::arc(CENTER, e, axis, 2.0, [-FRAC_PI_2, FRAC_PI_2]).unwrap();
        let sphere = Nurbs::revolution(&half, CENTER, axis, [0.0, TAU]).unwrap();
        let pole = |x: &Vec3| (x - CENTER).cross(&axis).norm() < 0.1;
        let truth = |x: &Vec3| (!pole(x)).then(|| ((CENTER - x) / 2.0, [0.5; 2]));
        check(&sphere, |x| (x - CENTER).norm() / 2.0 - 1.0, truth);
        for (row, side) in [(0, -2.0), (4, 2.0)] {
            let first = sphere.points()[row];
            close(&first, &(CENTER + axis * side), 1e-15);
            assert!((0..9).all(|k| sphere.points()[row + 5 * k] == first));
            let local = sphere.local([FRAC_PI_2 * side / 2.0, 1.0]);
            assert!(local.tangents[1].norm() < 1e-15 && local.tangents[0].norm() > 1.0);
        }
        let (low, high) = sphere.bounds();
        assert!(grid(40, sphere.domain()).all(|place| {
            let x = sphere.local(place).point;
            (0..3).all(|a| low[a] - 1e-14 <= x[a] && x[a] <= high[a] + 1e-14)
        }));
        for (_, patch) in sphere.beziers() {
            for xi in grid(6, patch.domain()) {
                assert!(((patch.local(xi).point - CENTER).norm() / 2.0 - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn tori() {
        let [e, _, axis] = frame();
        let (large, small) = (3.0, 0.75);
        let circle = Curve::arc(CENTER + e * large, e, axis, small, [0.0, TAU]).unwrap();
        let torus = Nurbs::revolution(&circle, CENTER, axis, [0.0, TAU]).unwrap();
        let tube = |x: &Vec3| {
            let arm = x - CENTER;
            arm - (arm - axis * arm.dot(&axis)).normalize() * large
        };
        let truth = |x: &Vec3| {
            let radius = (x - CENTER).cross(&axis).norm();
            Some((-tube(x) / small, [1.0 / small, (radius - large) / small / radius]))
        };
        check(&torus, |x| tube(x).norm() / small - 1.0, truth);
    }

    #[test]
    fn planes_and_extrusions() {
        let [a, b, c] = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.0, 2.0, -1.0)];
        let plane = Nurbs::plane(a, b, c);
        let local = plane.local([0.3, 0.6]);
        close(&local.point, &(a + b * 0.3 + c * 0.6), 1e-15);
        assert_eq!((local.tangents, local.second), ([b, c], [Vec3::zeros(); 3]));
        let arc = Curve::arc(a, b, c, 1.0, [0.0, 2.0]).unwrap();
        let wall = Nurbs::extrusion(&arc, b);
        let (on_arc, on_wall) = (arc.local(1.3), wall.local([1.3, 0.7]));
        close(&on_wall.point, &(on_arc.point + b * 0.7), 1e-15);
        close(&on_wall.tangents[0], &on_arc.first, 1e-14);
        close(&on_wall.tangents[1], &b, 1e-14);
        close(&on_wall.second[0], &on_arc.second, 1e-14);
    }

    #[test]
    fn ruled_surfaces_join_any_two_curves() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.3, 0.0], [1.2, 1.0, 0.2], [0.0, 2.0, 0.3]];
        let lines = Curve::polyline(corners.map(Vec3::from).to_vec()).unwrap();
        let arc = Curve::arc(Vec3::z(), Vec3::x(), Vec3::y(), 1.5, [0.1, 3.3]).unwrap();
        let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.6, 1.0, 1.0, 1.0, 1.0]).unwrap();
        let points = (0..6).map(|k| Vec3::new(k as f64, (k * k % 5) as f64, 2.0)).collect();
        let spline = Curve::new(knots, points, vec![1.0, 0.4, 2.0, 1.0, 1.0, 3.0]).unwrap();
        let shifted = Curve::new(spline.knots().onto([100.0, 117.0]), spline.points().to_vec(), vec![1.0; 6]).unwrap();
        for (first, second, degree) in
            [(&lines, &arc, 2), (&arc, &spline, 3), (&spline, &lines, 3), (&spline, &shifted, 3)]
        {
            let surface = Nurbs::ruled(first, second);
            let ([start, end], [low, high]) = (first.domain(), second.domain());
            assert_eq!(surface.domain(), [[start, end], [0.0, 1.0]]);
            assert_eq!(surface.knots()[0].degree(), degree);
            for k in 0..=40 {
                let s = k as f64 / 40.0;
                let u = start + s * (end - start);
                let (a, b) = (first.local(u).point, second.local(low + s * (high - low)).point);
                close(&surface.local([u, 0.0]).point, &a, 1e-14);
                close(&surface.local([u, 1.0]).point, &b, 4e-14);
                let between = surface.local([u, 0.4]).point;
                assert!((between - a).cross(&(b - a)).norm() < 1e-13);
            }
        }
        assert_eq!(Nurbs::ruled(&spline, &shifted).knots()[0], *spline.knots());
    }

    #[test]
    fn wrong_shapes_are_explained() {
        let arc = |from, to| Curve::arc(Vec3::zeros(), Vec3::x(), Vec3::y(), 1.0, [from, to]);
        for (from, to) in [(0.0, 0.0), (1.0, 0.5), (0.0, 6.4), (0.0, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
            assert!(arc(from, to).unwrap_err().contains("an angle above 0 up to 2 pi"));
        }
        assert!(Curve::<2>::polyline(vec![]).unwrap_err().contains("2 at least"));
        let line = Curve::line(Vec3::x(), Vec3::z());
        for axis in [Vec3::zeros(), Vec3::repeat(f64::NAN), Vec3::repeat(f64::INFINITY)] {
            assert!(Nurbs::revolution(&line, Vec3::zeros(), axis, [0.0, 1.0]).unwrap_err().contains("length above 0"));
        }
    }
}
