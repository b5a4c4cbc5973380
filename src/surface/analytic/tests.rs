//! All shapes against differences, against each other, and against samples of themselves.

use super::*;
use crate::surface::projection::tests::check_derivatives;
use crate::surface::tessellation::tests::sums;
use crate::surface::test_meshes::{indenter, indenter_normal};
use proptest::prelude::*;
use std::f64::consts::PI;

fn axis() -> Vec3 {
    Vec3::new(1.0, 2.0, -0.5).normalize()
}

fn place() -> Vec3 {
    Vec3::new(0.3, -0.2, 0.1)
}

fn profile(points: &[[f64; 2]], fillets: &[f64], closed: bool, sweep: Sweep) -> Analytic {
    let about_axis = matches!(sweep, Sweep::Revolved(_));
    Analytic::Profile(Profile { chain: Chain::new(points, fillets, closed, about_axis).unwrap(), sweep })
}

fn turned() -> Sweep {
    Sweep::Revolved(Axis::new(place(), axis()))
}

fn drawn(length: Option<f64>) -> Sweep {
    let [x, y] = super::super::normals::tangents(&axis());
    Sweep::Extruded { origin: place(), x, y, length }
}

/// A punch with a fillet and a sharp edge, a step and a conical tip.
fn punch() -> Analytic {
    profile(&[[0.0, 0.3], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [3.0, 1.5]], &[0.0, 0.2, 0.0, 0.3, 0.0], false, turned())
}

/// The same drawn out.
fn step() -> Analytic {
    let points = [[0.0, 0.3], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [3.0, 1.5]];
    profile(&points, &[0.0, 0.2, 0.0, 0.3, 0.0], false, drawn(Some(4.0)))
}

/// The pairs of the plain shapes with the profiles that are the same near the origin, hollow and not.
fn pairs() -> Vec<(Analytic, Analytic)> {
    let (point, axis) = (place(), axis());
    let mut pairs = vec![(
        Analytic::Plane(Plane { point, normal: axis }),
        profile(&[[50.0, 0.0], [0.0, 0.0]], &[0.0; 2], false, turned()),
    )];
    for hollow in [false, true] {
        let chain = |points: &[[f64; 2]], fillets: &[f64], closed: bool| {
            let chain = Chain::new(points, fillets, closed, true).unwrap();
            let chain = if hollow { chain.reversed() } else { chain };
            Analytic::Profile(Profile { chain, sweep: turned() })
        };
        let (sin, cos) = 0.6_f64.sin_cos();
        pairs.extend([
            (
                Analytic::Cylinder(Cylinder { point, axis, radius: 1.5, hollow }),
                chain(&[[1.5, -50.0], [1.5, 50.0]], &[0.0; 2], false),
            ),
            (
                Analytic::Sphere(Sphere { center: point, radius: 1.5, hollow }),
                chain(&[[0.0, -1.5], [1.5, -1.5], [1.5, 1.5], [0.0, 1.5]], &[0.0, 1.5, 1.5, 0.0], false),
            ),
            (
                Analytic::Cone(Cone { apex: point, axis, angle: 0.6, hollow }),
                chain(&[[0.0, 0.0], [50.0 * sin, 50.0 * cos]], &[0.0; 2], false),
            ),
            (
                Analytic::Torus(Torus { center: point, axis, radius: 2.0, tube: 0.7, hollow }),
                chain(&[[1.3, -0.7], [2.7, -0.7], [2.7, 0.7], [1.3, 0.7]], &[0.7; 4], true),
            ),
        ]);
    }
    pairs
}

fn shapes() -> Vec<Analytic> {
    pairs().into_iter().flat_map(|(a, b)| [a, b]).chain([punch(), step()]).collect()
}

#[test]
fn gaps_have_the_normal_as_their_gradient_and_normals_their_own() {
    for shape in shapes() {
        let mut seen = 0;
        for x in
            [[1.7, 0.4, 2.0], [-0.4, 1.1, 0.6], [1.1, 2.0, 0.3], [0.6, 0.1, -0.6], [-1.5, -1.1, 0.9]].map(Vec3::from)
        {
            if shape.closest(&x, 10.0, None).is_some() {
                check_derivatives(&x, |x| shape.closest(x, 10.0, None));
                seen += 1;
            }
        }
        assert!(seen > 2, "{shape:?}");
    }
}

#[test]
fn the_derivatives_of_the_parameters_match_differences() {
    for shape in shapes() {
        let surface = shape.parametric();
        let [u, v] = surface.domain().map(|[from, to]| [from.max(-3.0), to.min(3.0)]);
        for k in 0..40 {
            let part = |[from, to]: [f64; 2], s: f64| from + (to - from) * (s.fract() * 0.98 + 0.01);
            let xi = [part(u, 0.37 * k as f64), part(v, 0.611 * k as f64)];
            let (here, h) = (surface.local(xi), 1e-5);
            for a in 0..2 {
                let at = |s: f64| surface.local(std::array::from_fn(|b| xi[b] + if a == b { s * h } else { 0.0 }));
                let (up, down) = (at(1.0), at(-1.0));
                assert!(((up.point - down.point) / (2.0 * h) - here.tangents[a]).norm() < 1e-8, "{shape:?} {xi:?}");
                for b in 0..2 {
                    let bend = (up.tangents[b] - down.tangents[b]) / (2.0 * h);
                    assert!((bend - here.second[a + b]).norm() < 1e-8, "{shape:?} {xi:?}");
                }
            }
            let normal = surface.normal(xi);
            assert!((normal - here.area_vector().normalize()).norm() < 1e-9, "{shape:?} {xi:?}");
            let (low, high) = surface.bounds();
            assert!((0..3).all(|d| here.point[d] > low[d] - 1e-12 && here.point[d] < high[d] + 1e-12), "{shape:?}");
            // A little off the surface the way back leads to the same point, from both sides.
            for gap in [1e-3, -1e-3] {
                let x = here.point + normal * gap;
                let back = surface.closest(&x);
                assert!(
                    (back.point - here.point).norm() < 1e-12 && (back.distance - 1e-3).abs() < 1e-12,
                    "{shape:?} {xi:?}"
                );
                assert!((surface.point(back.xi) - here.point).norm() < 1e-12);
                let p = shape.closest(&x, 1.0, None).unwrap();
                assert!((p.gap - gap).abs() < 1e-12 && (p.normal - normal).norm() < 1e-9, "{shape:?} {xi:?} {p:?}");
            }
        }
    }
}

#[test]
fn bounds_are_touched() {
    for shape in shapes() {
        let (low, high) = shape.parametric().bounds();
        let cells = shape.tessellate(400, &Vec3::repeat(-100.0), &Vec3::repeat(100.0));
        for d in 0..3 {
            let (from, to) = cells.points.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[d]), b.max(p[d])));
            let touched = |bound: f64, point: f64| {
                if bound.is_finite() { (bound - point).abs() < 1e-3 } else { point.abs() > 10.0 }
            };
            assert!(touched(low[d], from) && touched(high[d], to), "{shape:?} {d}: {low} {high} {from} {to}");
        }
    }
    let flat = Plane { point: place(), normal: -Vec3::y() };
    assert_eq!((flat.bounds().0.y, flat.bounds().1.y, flat.bounds().1.x), (-0.2, -0.2, f64::INFINITY));
}

#[test]
fn on_an_axis_and_in_a_centre_one_of_many_points_is_taken() {
    for (shape, same) in pairs() {
        for x in [place(), place() + axis(), place() - axis() * 0.3] {
            for shape in [&shape, &same] {
                let Some(p) = shape.closest(&x, 100.0, None) else { continue };
                assert!((p.normal.norm() - 1.0).abs() < 1e-14 && (p.point + p.normal * p.gap - x).norm() < 1e-14);
                assert!((p.gap.abs() - shape.parametric().closest(&x).distance).abs() < 1e-14, "{shape:?}");
                assert!(p.normal_gradient.iter().all(|g| g.is_finite()));
            }
        }
    }
}

#[test]
fn at_the_apex_of_a_cone_the_direction_counts() {
    for (hollow, sign) in [(false, 1.0), (true, -1.0)] {
        let cone = Cone { apex: place(), axis: axis(), angle: 0.6, hollow };
        let p = cone.project(&place());
        assert!(p.gap == 0.0 && (p.normal + axis() * sign).norm() < 1e-15);
        let behind = -axis() * 2.0 + Vec3::new(0.1, 0.2, 0.3);
        let p = cone.project(&(place() + behind));
        assert!((p.gap - sign * behind.norm()).abs() < 1e-14 && (p.point - place()).norm() < 1e-14);
        check_derivatives(&(place() + behind), |x| Some(cone.project(x)));
        check_derivatives(&(place() - axis()), |x| Some(cone.project(x)));
        let inside = cone.project(&(place() + axis()));
        assert!((inside.gap + sign * 0.6_f64.sin()).abs() < 1e-14);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn profiles_are_the_plain_shapes(x in [-4.0..4.0_f64, -4.0..4.0, -4.0..4.0]) {
        let x = Vec3::from(x);
        for (shape, same) in pairs() {
            let (a, b) = (shape.closest(&x, 100.0, None).unwrap(), same.closest(&x, 100.0, None).unwrap());
            prop_assert!((a.gap - b.gap).abs() < 1e-12, "{:?} {} {}", shape, a.gap, b.gap);
            prop_assert!((a.normal - b.normal).norm() < 1e-12 && (a.point - b.point).norm() < 1e-12, "{:?}", shape);
            // An axis and a centre are singular.
            let tolerance = 1e-10 * (1.0 + a.normal_gradient.norm().powi(2));
            prop_assert!((a.normal_gradient - b.normal_gradient).norm() < tolerance, "{:?}", shape);
            let c = shape.parametric().closest(&x);
            prop_assert!((c.distance - a.gap.abs()).abs() < 1e-12, "{:?}", shape);
        }
    }

    #[test]
    fn no_sample_is_closer(x in [-2.0..4.0_f64, -2.0..4.0, -2.0..4.0]) {
        let x = Vec3::from(x);
        for shape in [punch(), step()] {
            let surface = shape.parametric();
            let cells = shape.tessellate(64, &x, &x);
            let sample = cells.points.iter().map(|p| (x - Vec3::from(*p)).norm()).fold(f64::INFINITY, f64::min);
            let nearest = surface.closest(&x);
            prop_assert!(nearest.distance <= sample + 1e-12);
            for p in [shape.closest(&x, 100.0, None), shape.nearest(&x)].into_iter().flatten() {
                prop_assert!((p.point + p.normal * p.gap - x).norm() < 1e-12);
                prop_assert!(p.gap.abs() > nearest.distance - 1e-12);
            }
            let gap = shape.nearest(&x).map(|p| p.gap.abs());
            prop_assert!(gap.is_some_and(|gap| (gap - nearest.distance).abs() < 1e-11));
        }
    }
}

/// The rules of corners: those of `piece_set` for the same shape.
#[test]
fn corners_of_an_extruded_profile() {
    let sweep = Sweep::Extruded { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None };
    // A block with its top left open: up the right side last, then a ledge.
    let shape = profile(&[[0.0, 2.0], [0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [5.0, 1.0]], &[0.0; 5], false, sweep);
    let at = |x: f64, y: f64| shape.closest(&Vec3::new(x, y, 7.0), 10.0, None);
    // Outside the convex corners.
    let p = at(-0.3, -0.4).unwrap();
    assert!((p.gap - 0.5).abs() < 1e-15 && (p.normal - Vec3::new(-0.6, -0.8, 0.0)).norm() < 1e-15);
    check_derivatives(&Vec3::new(-0.3, -0.4, 7.0), |x| shape.closest(x, 10.0, None));
    let p = at(0.0, 0.0).unwrap();
    assert!(p.gap == 0.0 && (p.normal.norm() - 1.0).abs() < 1e-15);
    // Inside them the nearer side, and in the concave corner the nearer wall.
    assert_eq!((at(0.1, 0.2).unwrap().gap, at(0.2, 0.1).unwrap().normal), (-0.1, -Vec3::y()));
    assert_eq!((at(3.2, 0.9).unwrap().normal, at(3.1, 0.7).unwrap().normal), (-Vec3::y(), Vec3::x()));
    // Behind it the corner.
    let p = at(2.7, 1.4).unwrap();
    assert!((p.gap + 0.5).abs() < 1e-15 && (p.normal - Vec3::new(0.6, -0.8, 0.0)).norm() < 1e-14);
    // Beyond the ends nothing near; the far side of the block remains.
    let near = |x: f64, y: f64| shape.closest(&Vec3::new(x, y, 7.0), 1.0, None);
    assert!(near(5.1, 0.9).is_none() && near(-0.5, 2.1).is_none());
    assert_eq!(at(5.0, 0.5).map(|p| p.gap), Some(0.5));
    assert!((at(0.5, 2.1).unwrap().gap + 2.1).abs() < 1e-14);
    // A corner has no projection of what is closer to the lost end of its side.
    let hook = profile(&[[0.0, 0.5], [0.0, 0.0], [3.0, 0.0]], &[0.0; 3], false, sweep);
    assert!(hook.closest(&Vec3::new(-0.4, 0.9, 0.0), 10.0, None).is_none());
    assert!(hook.closest(&Vec3::new(-0.4, -0.1, 0.0), 10.0, None).is_some());
    // A finite one ends across, too.
    let sweep = Sweep::Extruded { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: Some(2.0) };
    let short = profile(&[[0.0, 0.0], [3.0, 0.0]], &[0.0; 2], false, sweep);
    let seen = [-0.1, 0.0, 2.0, 2.1].map(|z| short.closest(&Vec3::new(1.0, 0.5, z), 1.0, None).is_some());
    assert_eq!(seen, [false, true, true, false]);
}

#[test]
fn at_a_corner_the_facet_tells_the_side() {
    let tilt = Vec3::new(0.2, -0.1, 0.3);
    for shape in shapes() {
        let surface = shape.parametric();
        let [u, v] = surface.domain().map(|[from, to]| [from.max(-3.0), to.min(3.0)]);
        for k in 0..40 {
            let part = |[from, to]: [f64; 2], s: f64| from + (to - from) * (s.fract() * 0.98 + 0.01);
            let xi = [part(u, 0.37 * k as f64), part(v, 0.611 * k as f64)];
            let (side, distance) = shape.side_normal(&surface.point(xi), &(surface.normal(xi) + tilt));
            assert!((side - surface.normal(xi)).norm() < 1e-9 && distance < 1e-12, "{shape:?} {xi:?}");
        }
    }
    // The tip of the punch and its sharp edge, and the apex of a cone.
    let (about, section) = (Axis::new(place(), axis()), |r: f64, h: f64| crate::Vec2::new(r, h).normalize());
    for (r, h, sides) in
        [(0.0, 0.3, vec![section(-0.3, -1.0)]), (2.0, 0.0, vec![section(0.0, -1.0), section(1.0, 0.0)])]
    {
        let x = place() + about.at_angle(0.7, &crate::Vec2::new(r, h));
        for side in sides {
            let normal = about.at_angle(0.7, &side);
            let (side, distance) = punch().side_normal(&x, &-(normal + tilt * if r > 0.0 { 1.0 } else { 0.0 }));
            assert!((side - normal).norm() < 1e-9 && distance < 1e-12);
        }
    }
    let cone = Cone { apex: place(), axis: axis(), angle: 0.6, hollow: false };
    for angle in [0.0, 2.0] {
        let normal = cone.normal([angle, 1.0]);
        for like in [normal, -normal, normal - axis() * 0.2, axis() * 0.2 - normal] {
            assert!((cone.side_normal(&place(), &like) - normal).norm() < 1e-14);
        }
    }
}

/// In an edge and in a tip, on their bisector inside, too, a point is on all sides, whose mean looks along that; not beside it, where it
/// is smooth, outside, or where sides lean too far.
#[test]
fn sides_of_an_edge_are_even() {
    let [x, y] = super::super::normals::tangents(&axis());
    let even =
        |turn: f64| Even { turn, outward: Vec3::zeros(), reach: 5.0, extension: None, kept: None, planar: false };
    // Solid above, as in (r, h).
    let points = [[0.0, 0.0], [3.0, 1.0]];
    let slope = 1.0f64.atan2(3.0);
    let cone = Analytic::Cone(Cone { apex: place(), axis: axis(), angle: 0.5 * PI - slope, hollow: false });
    let wedge = profile(&[[-3.0, 1.0], [0.0, 0.0], [3.0, 1.0]], &[0.0; 3], false, drawn(None));
    let tip = profile(&points, &[0.0; 2], false, turned());
    for (shape, up, along, count) in [(wedge, y, x, 2), (cone, axis(), x, 4), (tip, axis(), x, 4)] {
        let at = |point: Vec3, turn: f64| shape.evenly(&point, &shape.closest(&point, 5.0, None).unwrap(), &even(turn));
        for height in [0.0, 0.3] {
            let found = at(place() + up * height, 0.234);
            assert_eq!(found.len(), count, "{shape:?}");
            let mean = found.iter().map(|(p, _)| p.normal).sum::<Vec3>() / count as f64;
            assert!((mean + up * slope.cos()).norm() < 1e-12);
            for (p, share) in &found {
                assert!(
                    (p.gap + height * slope.cos()).abs() < 1e-12 && *share == 1.0 && p.normal_gradient.norm() < 1e-12
                );
            }
        }
        for beside in [along * 1e-3, along * 1e-3 + up * 0.3, up * -0.1] {
            assert!(at(place() + beside, 0.234).is_empty(), "{shape:?}");
        }
        assert!(at(place(), 0.1).is_empty());
    }
    let rounded = profile(&[[-3.0, 1.0], [0.0, 0.0], [3.0, 1.0]], &[0.0, 1.0, 0.0], false, drawn(None));
    let ball = profile(&[[0.0, -1.0], [1.0, -1.0], [1.0, 1.0]], &[0.0, 0.999, 0.0], false, turned());
    for shape in [rounded, ball] {
        for k in 0..100 {
            let point = place() + x * (0.02 * k as f64 - 1.0);
            let Some(at) = shape.closest(&point, 5.0, None) else { continue };
            assert!(shape.evenly(&point, &at, &even(0.234)).is_empty());
        }
    }
}

/// In the middle of a plate both sides are equally close; the last one stays.
#[test]
fn the_last_piece_is_kept_in_a_tie() {
    let plate = profile(&[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], &[0.0; 4], false, drawn(None));
    let [x, y] = super::super::normals::tangents(&axis());
    let at = |s: f64| place() + x * s + y * 0.9;
    for kept in [0, 2] {
        assert_eq!(plate.closest(&at(0.5), 1.0, Some(kept)).unwrap().patch, kept);
        assert_eq!(plate.closest(&at(0.5 + 1e-7), 1.0, Some(kept)).unwrap().patch, kept);
    }
    assert_eq!(plate.closest(&at(0.5 + 1e-5), 1.0, Some(0)).unwrap().patch, 2);
}

#[test]
fn the_indenter_is_exact() {
    let sweep = Sweep::Extruded { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None };
    let points = [[-20.0, 40.0], [-20.0, 0.0], [20.0, 0.0], [20.0, 40.0]];
    let shape = profile(&points, &[0.0, 10.0, 10.0, 0.0], false, sweep);
    for point in indenter(2, false).points.iter().map(|p| Vec3::from(*p)) {
        let normal = indenter_normal(&point);
        for gap in [0.3, -0.3] {
            let p = shape.closest(&(point + normal * gap), 5.0, None).unwrap();
            assert!((p.gap - gap).abs() < 1e-13 && (p.normal - normal).norm() < 1e-13);
        }
    }
}

#[test]
fn what_does_not_fit_names_the_point() {
    let misfit = |points: &[[f64; 2]], fillets: &[f64], closed: bool, about_axis: bool| {
        let misfit = Chain::new(points, fillets, closed, about_axis).unwrap_err();
        (misfit.point, misfit.fillet)
    };
    let corner = [[0.0, 2.0], [0.0, 0.0], [1.0, 0.0], [1.0, 2.0]];
    assert_eq!(misfit(&corner, &[0.0, 0.4, 0.7, 0.0], false, false), (2, true));
    assert_eq!(misfit(&corner, &[0.0, 1.2, 0.0, 0.0], false, false), (1, true));
    assert!(Chain::new(&corner, &[0.0, 0.3, 0.7, 0.0], false, false).is_ok());
    assert_eq!(misfit(&[[0.0, 0.0], [0.0, 0.0]], &[0.0; 2], false, false), (1, false));
    assert_eq!(misfit(&[[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]], &[0.0; 3], false, false), (1, false));
    assert_eq!(misfit(&[[1.0, 0.0], [-1.0, 0.0]], &[0.0; 2], false, true), (1, false));
    assert_eq!(misfit(&[[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]], &[0.0; 3], false, true), (1, false));
    assert_eq!(misfit(&[[0.0, 0.0], [0.0, 1.0]], &[0.0; 2], false, true), (1, false));
}

#[test]
fn a_reversed_chain_is_that_of_the_reversed_points() {
    let (mut points, mut fillets) = ([[0.0, 0.3], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0]], [0.0, 0.2, 0.0, 0.0]);
    let chain = Chain::new(&points, &fillets, false, true).unwrap();
    points.reverse();
    fillets.reverse();
    let other = Chain::new(&points, &fillets, false, true).unwrap();
    for x in [[1.2, -0.3], [0.1, -1.0], [1.5, 0.2], [2.4, -0.5], [0.9, 0.1], [0.0, -1.0]].map(crate::Vec2::from) {
        let (a, b) = (chain.reversed().project(&x, None).unwrap().0, other.project(&x, None).unwrap().0);
        assert!((a.gap - b.gap).abs() < 1e-14 && (a.normal - b.normal).norm() < 1e-14);
        assert!((chain.project(&x, None).unwrap().0.gap + a.gap).abs() < 1e-14);
    }
}

#[test]
fn round_shapes_are_closed_and_turned_outwards() {
    let (low, high) = (Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 1.0, 2.0));
    for (hollow, sign) in [(false, 1.0), (true, -1.0)] {
        let about = |volume: f64, exact: f64| (sign * volume / exact - 1.0).abs() < 0.01;
        let sphere = Analytic::Sphere(Sphere { center: Vec3::new(0.1, 0.2, 0.3), radius: 2.0, hollow });
        let (area, volume) = sums(&sphere.tessellate(64, &low, &high));
        assert!(area.norm() < 1e-12 && about(volume, 4.0 / 3.0 * PI * 8.0));
        let torus = Torus { center: Vec3::new(0.1, 0.2, 0.3), axis: axis(), radius: 2.0, tube: 0.5, hollow };
        let (area, volume) = sums(&Analytic::Torus(torus).tessellate(64, &low, &high));
        assert!(area.norm() < 1e-12 && about(volume, 2.0 * PI * PI * 2.0 * 0.25));
        let cylinder = Cylinder { point: Vec3::zeros(), axis: Vec3::z(), radius: 2.0, hollow };
        let tube = Analytic::Cylinder(cylinder).tessellate(64, &low, &high);
        let (area, volume) = sums(&tube);
        assert!(area.norm() < 1e-12 && about(volume, 2.0 / 3.0 * PI * 4.0 * 3.0));
        assert!(tube.points.iter().all(|p| p[2] >= -1.0 - 1e-12 && p[2] <= 2.0 + 1e-12));
        // Without its base, the cone sweeps nothing from its apex.
        let cone = Cone { apex: Vec3::new(0.0, 0.0, 1.0), axis: -Vec3::z(), angle: PI / 4.0, hollow };
        let cells = Analytic::Cone(cone).tessellate(64, &low, &high);
        let (area, volume) = sums(&cells);
        assert!((area.z * sign / (PI * 4.0) - 1.0).abs() < 0.01 && about(volume, PI * 4.0 / 3.0), "{area} {volume}");
        assert!(cells.points.iter().all(|p| p[2] >= -1.0 - 1e-12 && p[2] <= 1.0 + 1e-12));
    }
    let plane = Analytic::Plane(Plane { point: Vec3::new(5.0, 5.0, 0.5), normal: -Vec3::z() });
    let cells = plane.tessellate(64, &low, &high);
    assert!((sums(&cells).0 + Vec3::z() * 4.0).norm() < 1e-12);
    assert!(cells.points.iter().all(|p| p[0].abs() <= 1.0 + 1e-12 && p[1].abs() <= 1.0 + 1e-12 && p[2] == 0.5));
}

/// A surface without end is the same wherever its point is along it, and a way along a coordinate does not round; what ends, or
/// has a middle, stays.
#[test]
fn settling_changes_no_surface() {
    let (middle, far) = (Vec3::new(1.0, 2.0, 3.0), 1e6);
    let [x, y] = [Vec3::x(), Vec3::z()];
    let free = [
        (Analytic::Plane(Plane { point: Vec3::new(far, -far, 0.5), normal: Vec3::z() }), true),
        (
            Analytic::Plane(Plane {
                point: place() + crate::surface::normals::tangents(&axis())[0] * far,
                normal: axis(),
            }),
            false,
        ),
        (
            Analytic::Cylinder(Cylinder {
                point: Vec3::new(0.2, far, 0.5),
                axis: Vec3::y(),
                radius: 1.5,
                hollow: false,
            }),
            true,
        ),
        (
            Analytic::Cylinder(Cylinder { point: place() + axis() * far, axis: axis(), radius: 1.5, hollow: true }),
            false,
        ),
        (
            profile(
                &[[-9.0, 0.5], [9.0, 0.5]],
                &[0.0; 2],
                false,
                Sweep::Extruded { origin: Vec3::y() * far, x, y, length: None },
            ),
            true,
        ),
    ];
    for (shape, is_exact) in free {
        let mut settled = shape.clone();
        assert_eq!(settled.settle(&middle, 2.0 * far), 0.0);
        assert_eq!(settled, shape, "nearer than it is asked to be");
        let way = settled.settle(&middle, 10.0);
        assert!(if is_exact { way == 0.0 } else { way > 0.1 * far }, "{shape:?}: {way:e}");
        assert!(settled.far() < 20.0 && shape.far() > 0.1 * far, "{settled:?}");
        for point in [Vec3::new(2.0, -1.0, 0.4), middle, Vec3::new(-2.0, 0.3, 4.0)] {
            let [before, after] = [&shape, &settled].map(|shape| shape.closest(&point, f64::INFINITY, None).unwrap());
            let slack = if is_exact { 1e-15 } else { 1e-8 };
            assert!((before.gap - after.gap).abs() <= slack, "{shape:?}: {} {}", before.gap, after.gap);
            assert!((before.normal - after.normal).norm() <= slack, "{shape:?}");
        }
    }
    let ball = Analytic::Sphere(Sphere { center: Vec3::x() * far, radius: far, hollow: false });
    for shape in [ball, step(), punch()] {
        let mut settled = shape.clone();
        assert_eq!((settled.settle(&middle, 0.0), &settled), (0.0, &shape));
    }
}
