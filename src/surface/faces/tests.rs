use super::*;
use crate::Vec3;
use crate::surface::piece::Edge;
use crate::surface::projection::tests::check_derivatives;
use crate::surface::test_meshes::{patch, random_bezier};
use crate::surface::{Bezier, Curve, Face, KnotVector, Nurbs, PatchSet, Projection};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const FEATURE: f64 = 0.7;

fn face(surface: Nurbs, loops: Vec<Vec<Curve<2>>>) -> Face {
    Face { surface, loops, reversed: false, name: "a face".into() }
}

fn set(faces: &[Face], tolerance: f64) -> FaceSet {
    FaceSet::new(&sew(faces, FEATURE, tolerance, false).unwrap())
}

/// The sphere about the origin, outside out.
fn sphere(radius: f64) -> Nurbs {
    let arc = Curve::arc(Vec3::zeros(), Vec3::x(), Vec3::z(), radius, [-FRAC_PI_2, FRAC_PI_2]).unwrap();
    Nurbs::revolution(&arc, Vec3::zeros(), Vec3::z(), [0.0, TAU]).unwrap().swapped()
}

/// The torus about z with radii 3 and 1, outside out.
fn torus() -> Nurbs {
    let circle = Curve::arc(Vec3::x() * 3.0, Vec3::x(), Vec3::z(), 1.0, [0.0, TAU]).unwrap();
    Nurbs::revolution(&circle, Vec3::zeros(), Vec3::z(), [0.0, TAU]).unwrap().swapped()
}

fn square(low: f64, high: f64) -> Vec<Curve<2>> {
    let corners = [[low, low], [high, low], [high, high], [low, high]].map(Vector2::from);
    (0..4).map(|k| Curve::line(corners[k], corners[(k + 1) % 4])).collect()
}

/// The plane z = 0 over the square of side 4, parameters x and y, with a hole.
fn plate(hole: Vec<Curve<2>>) -> Face {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 4.0, 4.0]).unwrap();
    let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [4.0, 4.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let surface = Nurbs::new([knots(), knots()], corners.to_vec(), vec![1.0; 4]).unwrap();
    face(surface, vec![square(0.0, 4.0), hole])
}

fn round_hole() -> Vec<Curve<2>> {
    vec![Curve::arc(Vector2::new(2.0, 2.0), Vector2::x(), Vector2::y(), 1.0, [0.0, TAU]).unwrap()]
}

/// Points all over the place.
fn scatter(count: usize, size: f64) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let k = k as f64;
        Vec3::new((1.3 * k + 0.2).sin(), (2.1 * k).cos(), (0.7 * k + 0.4).sin()) * size
    })
}

#[test]
fn a_round_hole_has_its_rim() {
    let plate = set(&[plate(round_hole())], 1e-6);
    for p in scatter(300, 0.93) {
        let x = Vec3::new(2.0 + p.x, 2.0 + p.y, p.z);
        let arm = Vec3::new(p.x, p.y, 0.0);
        let nearest = plate.nearest(&x).unwrap();
        if arm.norm() < 1.0 {
            let exact = Vec3::new(2.0, 2.0, 0.0) + arm / arm.norm();
            assert!((nearest.point - exact).norm() < 1e-13, "{x} {nearest:?}");
            assert!((nearest.gap.abs() - (x - exact).norm()).abs() < 1e-13);
        } else {
            assert!((nearest.gap - x.z).abs() < 1e-14 && (nearest.normal - Vec3::z()).norm() < 1e-14);
        }
    }
    let x = Vec3::new(2.3, 2.2, 0.5);
    check_derivatives(&x, |x| plate.nearest(x));
    // The surface ends at the rim, but for a little extension.
    assert!(plate.closest(&x, 5.0, None).is_none());
    assert!(plate.closest(&Vec3::new(2.95, 2.0, 0.5), 5.0, None).is_some_and(|p| (p.gap - 0.5).abs() < 1e-15));
    assert!(plate.normal_projection(&Vec3::new(2.95, 2.0, 0.5), 0.1, 5.0).is_none());
    assert!(plate.normal_projection(&Vec3::new(3.05, 2.0, 0.5), 0.0, 5.0).is_some_and(|p| (p.2 - 0.5).abs() < 1e-15));
    assert!(plate.closest(&Vec3::new(-0.1, 1.0, 0.5), 5.0, None).is_some());
    assert!(plate.closest(&Vec3::new(-0.3, 1.0, 0.5), 5.0, None).is_none());
    assert!(plate.nearest(&Vec3::repeat(f64::NAN)).is_none());
    // On it a point is past the end by so much, in the hole as beside the plate.
    for (x, past) in
        [([2.95, 2.0], 0.05), ([2.0, 2.99], 0.01), ([3.05, 2.0], -1.0), ([-0.1, 1.0], 0.1), ([0.1, 1.0], -1.0)]
    {
        let x = Vec3::new(x[0], x[1], -0.01);
        let at = plate.closest(&x, 1.0, None).unwrap();
        for aside in [0.005, 0.03, 0.07, 0.2] {
            assert_eq!(plate.is_past_end(&x, &at, aside), past > aside, "{x:?} {aside}");
        }
    }
}

#[test]
fn holes_of_any_shape_agree_with_brute_force() {
    let ellipse = Curve::arc(Vector2::new(2.0, 2.0), Vector2::new(1.2, 0.3), Vector2::new(-0.1, 0.5), 1.0, [0.0, TAU]);
    let points =
        [[1.0, 1.0], [2.2, 0.3], [3.4, 1.2], [2.4, 2.0], [3.3, 3.1], [1.9, 3.6], [1.2, 2.8], [0.4, 2.2], [1.0, 1.0]];
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0, 6.0, 6.0];
    let points = points.map(Vector2::from).to_vec();
    let spline = Curve::new(KnotVector::new(3, knots.to_vec()).unwrap(), points, vec![1.0; 9]);
    for hole in [ellipse.unwrap(), spline.unwrap()] {
        let [start, end] = hole.domain();
        let plate = set(&[plate(vec![hole.clone()])], 1e-6);
        let at = |s: f64| {
            let p = hole.local(start + (end - start) * s).point;
            Vec3::new(p.x, p.y, 0.0)
        };
        let polygon: Vec<Vec3> = (0..2000).map(|k| at(k as f64 / 2000.0)).collect();
        for p in scatter(200, 1.9) {
            let x = Vec3::new(2.0 + p.x, 2.0 + p.y, p.z);
            // Winding around the point, then the least distance by golden sections around the best sample.
            let angles = (0..2000).map(|k| {
                let [a, b] = [polygon[k] - x, polygon[(k + 1) % 2000] - x];
                (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y)
            });
            let is_hole = angles.sum::<f64>().abs() > PI;
            let exact = if is_hole {
                let best =
                    (0..2000).min_by(|a, b| (polygon[*a] - x).norm().total_cmp(&(polygon[*b] - x).norm())).unwrap();
                let (mut a, mut b) = ((best as f64 - 1.0) / 2000.0, (best as f64 + 1.0) / 2000.0);
                let distance = |s: f64| (at(s.rem_euclid(1.0)) - x).norm();
                for _ in 0..200 {
                    let [c, d] = [a + (b - a) * 0.381966, a + (b - a) * 0.618034];
                    if distance(c) < distance(d) { b = d } else { a = c }
                }
                distance(0.5 * (a + b))
            } else {
                x.z.abs()
            };
            let nearest = plate.nearest(&x).unwrap();
            assert!((nearest.gap.abs() - exact).abs() < 1e-13, "{x}: {} instead of {exact}", nearest.gap);
        }
    }
}

fn check_sphere(x: &Vec3, p: &Projection, radius: f64) {
    assert!((p.gap - (x.norm() - radius)).abs() < 1e-13, "{x} {p:?}");
    // Near a pole the direction around it has few digits.
    let rounding = 1e-12 + 1e-14 / x.xy().norm().max(1e-6);
    assert!((p.normal - x.normalize()).norm() < rounding, "{x} {p:?}");
    let n = x.normalize();
    let exact = (crate::Mat3::identity() - n * n.transpose()) / x.norm();
    assert!((p.normal_gradient - exact).norm() < 1e-8, "{x} {}", p.normal_gradient - exact);
}

#[test]
fn a_sphere_has_no_seams_and_poles() {
    let ball = set(&[face(sphere(2.0), vec![])], 1e-4);
    for k in 0..500 {
        let a = k as f64 * 2e-3 * TAU;
        let (small, height) = (0.3 * (0.37 * a).sin(), 2.0 + 0.5 * (5.0 * a).sin());
        let paths = [
            Vec3::new(a.cos(), a.sin(), 0.3 * (3.0 * a).sin()),
            Vec3::new(small * a.cos(), small * a.sin(), 1.0),
            Vec3::new(1.0, 1e-3 * (7.0 * a).sin(), (2.0 * a).cos()),
            Vec3::new(1e-6 * a.cos(), 1e-9 * a.sin(), -1.0),
        ];
        for x in paths.map(|x| x.normalize() * height) {
            for p in [ball.nearest(&x), ball.closest(&x, 5.0, None)] {
                check_sphere(&x, &p.unwrap(), 2.0);
            }
        }
    }
    for x in [Vec3::z() * 2.3, Vec3::z() * -1.6, Vec3::x() * 2.4, Vec3::new(2.0, 1e-9, 1e-7), Vec3::new(1e-9, 0.0, 2.2)]
    {
        check_sphere(&x, &ball.nearest(&x).unwrap(), 2.0);
        check_sphere(&x, &ball.closest(&x, 5.0, None).unwrap(), 2.0);
    }
    for x in
        [Vec3::new(0.2, 0.3, 2.1), Vec3::new(1e-3, 2e-3, -1.7), Vec3::new(2.2, 1e-4, 0.3), Vec3::new(1.0, 1.0, 0.2)]
    {
        check_derivatives(&x, |x| ball.closest(x, 5.0, None));
    }
    let turned = FaceSet::new(&sew(&[face(sphere(2.0), vec![])], FEATURE, 1e-4, true).unwrap());
    let x = Vec3::new(0.4, 0.3, 2.2);
    assert!((turned.closest(&x, 5.0, None).unwrap().gap + x.norm() - 2.0).abs() < 1e-13);
    let reversed = Face { reversed: true, ..face(sphere(2.0), vec![]) };
    assert!((set(&[reversed], 1e-4).nearest(&x).unwrap().gap + x.norm() - 2.0).abs() < 1e-13);
}

#[test]
fn a_torus_has_no_seams() {
    let ring = set(&[face(torus(), vec![])], 1e-4);
    for x in scatter(3000, 4.2) {
        let center = Vec3::new(x.x, x.y, 0.0).normalize() * 3.0;
        let arm = x - center;
        for p in [ring.nearest(&x).unwrap(), ring.closest(&x, 9.0, None).unwrap()] {
            assert!((p.gap - (arm.norm() - 1.0)).abs() < 1e-13, "{x} {p:?}");
            assert!((p.normal - arm.normalize()).norm() < 1e-12);
        }
    }
    for x in
        [Vec3::new(4.2, 1e-5, 0.1), Vec3::new(4.2, 1.0, 1e-5), Vec3::new(-2.0, -1.3, 1.1), Vec3::new(3.0, 0.1, 1.3)]
    {
        check_derivatives(&x, |x| ring.closest(x, 9.0, None));
    }
    // Around both ways with a warm start.
    let mut warm = None;
    for k in 0..5000 {
        let a = k as f64 * 1e-3 * TAU;
        let around = Vec3::new(a.cos(), a.sin(), 0.0);
        let out = around * (2.6 * a).cos() + Vec3::z() * (2.6 * a).sin();
        let x = around * 3.0 + out * 1.05;
        let p = ring.closest(&x, 1.0, warm).unwrap();
        assert!((p.gap - 0.05).abs() < 1e-13 && (p.normal - out).norm() < 1e-12);
        warm = Some((p.patch, p.xi));
    }
}

/// A body of revolution about z, one face for each line of the profile (radius, height); radius 0 at both ends.
fn revolved(profile: &[[f64; 2]]) -> Vec<Face> {
    let line = |pair: &[[f64; 2]]| {
        let [a, b] = [pair[0], pair[1]].map(|[r, z]| Vec3::new(r, 0.0, z));
        let surface = Nurbs::revolution(&Curve::line(a, b), Vec3::zeros(), Vec3::z(), [0.0, TAU]).unwrap().swapped();
        Face { name: format!("face at {}", b.z), ..face(surface, vec![]) }
    };
    profile.windows(2).map(line).collect()
}

/// Distance from a body of revolution, negative inside.
fn distance_to(profile: &[[f64; 2]], x: &Vec3) -> f64 {
    let p = Vector2::new(x.xy().norm(), x.z);
    let (mut least, mut winding) = (f64::INFINITY, 0.0);
    for pair in profile.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(Vector2::from);
        let t = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        least = least.min((a + (b - a) * t - p).norm());
        // The profile and its image beyond the axis.
        for mirror in [1.0, -1.0] {
            let [a, b] = [a, b].map(|q| Vector2::new(mirror * q.x, q.y) - p);
            winding += mirror * (a.x * b.y - a.y * b.x).atan2(a.dot(&b));
        }
    }
    if winding.abs() > PI { -least } else { least }
}

#[test]
fn bodies_with_sharp_edges_seams_and_an_apex() {
    let bottle = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.4, 1.0], [0.4, 1.5], [0.0, 2.2]];
    let mut faces = revolved(&bottle);
    let set = |faces: &[Face]| FaceSet::new(&sew(faces, 0.3, 1e-5, false).unwrap());
    let tool = set(&faces);
    // Faces as a file may have them: any order, some inside out; the first is not.
    faces.rotate_left(2);
    faces[1].reversed = true;
    faces[3].reversed = true;
    let other = set(&faces);
    for x in scatter(1500, 2.4) {
        let exact = distance_to(&bottle, &x);
        for p in [tool.nearest(&x), tool.closest(&x, 9.0, None), other.nearest(&x), other.closest(&x, 9.0, None)] {
            let p = p.unwrap();
            assert!((p.gap - exact).abs() < 1e-12, "{x}: {p:?} instead of {exact}");
            assert!((p.point + p.normal * p.gap - x).norm() < 1e-12);
        }
    }
    for x in [[1.3, 0.2, -0.4], [0.1, 0.2, 2.5], [0.7, 0.1, 1.3], [1e-3, 1.4, 1.3]].map(Vec3::from) {
        check_derivatives(&x, |x| tool.closest(x, 9.0, None));
    }
}

#[test]
fn any_selection_of_faces_answers_alike_within_its_reach() {
    let bottle = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.4, 1.0], [0.4, 1.5], [0.0, 2.2]];
    let sewn = sew(&revolved(&bottle), FEATURE, 1e-5, false).unwrap();
    let numbers: Vec<f64> = sewn.iter().flat_map(SewnFace::to_numbers).collect();
    assert_eq!(SewnFace::from_numbers(&numbers), sewn);
    assert!(SewnFace::from_numbers(&numbers[..numbers.len() - 1]).len() == sewn.len() - 1);
    let all = FaceSet::new(&sewn);
    let reach = 0.3;
    for x in scatter(300, 1.5) {
        let meets = |f: &&SewnFace| (0..3).all(|d| f.bounds.0[d] <= x[d] + reach && f.bounds.1[d] >= x[d] - reach);
        let near: Vec<SewnFace> = sewn.iter().filter(meets).cloned().collect();
        let some = FaceSet::new(&near);
        let p = all.closest(&x, reach, None);
        assert_eq!(p, some.closest(&x, reach, None));
        assert_eq!(all.nearest_within(&x, reach), some.nearest_within(&x, reach));
        if let Some(p) = p {
            let again = all.closest(&x, reach, Some((p.patch, p.xi))).unwrap();
            assert!(again.patch == p.patch && (again.point - p.point).norm() < 1e-12);
            let (face, uv) = all.face(p.patch, p.xi).unwrap();
            assert!((sewn[face as usize].surface.local(uv).point - p.point).norm() < 1e-12);
        }
    }
}

/// A plane and a fillet that should be tangent, but are apart by a small gap along and across.
#[test]
fn gaps_of_files_do_not_show() {
    let gap = 1e-4;
    for (shift, lift) in [(gap, 0.0), (gap, gap), (-gap, 0.0), (-gap, -gap)] {
        let plane =
            Nurbs::plane(Vec3::new(-3.0, 0.0, lift), Vec3::new(3.0 - shift, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
        let arc = Curve::arc(Vec3::new(0.0, 0.0, -1.0), Vec3::z(), Vec3::x(), 1.0, [0.0, FRAC_PI_2]).unwrap();
        let fillet = Nurbs::extrusion(&arc, Vec3::new(0.0, 2.0, 0.0));
        let sewn = sew(&[face(plane, vec![]), face(fillet, vec![])], FEATURE, 1e-3, false).unwrap();
        let smooth = |f: &SewnFace| f.rims.iter().filter(|r| r.edge == Edge::Smooth).count();
        assert_eq!((smooth(&sewn[0]), smooth(&sewn[1])), (1, 1), "{shift} {lift}");
        let tool = FaceSet::new(&sewn);
        let (mut last, mut warm): (Option<Projection>, _) = (None, None);
        for k in 0..8000 {
            let x = Vec3::new(-0.4 + 1e-4 * k as f64, 1.0, 0.1);
            let p = tool.closest(&x, 1.0, warm).unwrap();
            let exact = if x.x < 0.0 { x.z } else { x.x.hypot(x.z + 1.0) - 1.0 };
            assert!((p.gap - exact).abs() < 1.2 * gap, "{x} {p:?}");
            let normal = if x.x < 0.0 { Vec3::z() } else { Vec3::new(x.x, 0.0, x.z + 1.0).normalize() };
            assert!((p.normal - normal).norm() < 2.0 * gap, "{x} {p:?}");
            if let Some(last) = last {
                assert!((p.gap - last.gap).abs() < 2.2 * gap && (p.normal - last.normal).norm() < 3.0 * gap);
            }
            (last, warm) = (Some(p), Some((p.patch, p.xi)));
        }
    }
}

/// Half of the long side of one plane continues in another; beyond the rest the surface ends.
#[test]
fn rims_are_cut_where_their_neighbour_ends() {
    let plane = |x: f64, y: f64, w: f64, h: f64| {
        face(Nurbs::plane(Vec3::new(x, y, 0.0), Vec3::new(w, 0.0, 0.0), Vec3::new(0.0, h, 0.0)), vec![])
    };
    let sewn = sew(&[plane(0.0, 0.0, 2.0, 1.0), plane(0.0, 1.0, 0.8, 1.0)], FEATURE, 1e-5, false).unwrap();
    assert_eq!(sewn[0].rims.len(), 5);
    assert_eq!(sewn[0].rims.iter().filter(|r| r.edge == Edge::Smooth).count(), 1);
    let tool = FaceSet::new(&sewn);
    assert!(tool.closest(&Vec3::new(0.4, 1.0, 0.2), 1.0, None).is_some_and(|p| (p.gap - 0.2).abs() < 1e-15));
    assert!(tool.closest(&Vec3::new(1.4, 1.2, 0.2), 1.0, None).is_none());
    assert!(tool.closest(&Vec3::new(1.4, 1.02, 0.2), 1.0, None).is_some());
}

#[test]
fn one_sided_surfaces_are_refused() {
    let strip = |twist: f64| -> Vec<Face> {
        let rung = |k: usize| {
            let (a, b) = (k as f64 / 12.0 * TAU, k as f64 / 12.0 * twist);
            let out = Vec3::new(a.cos(), a.sin(), 0.0);
            let arm = (out * b.cos() + Vec3::z() * b.sin()) * 0.3;
            Curve::line(out - arm, out + arm)
        };
        (0..12)
            .map(|k| Face { name: format!("rung {k}"), ..face(Nurbs::ruled(&rung(k), &rung(k + 1)), vec![]) })
            .collect()
    };
    assert!(sew(&strip(TAU), 1.0, 1e-6, false).is_ok());
    let error = sew(&strip(PI), 1.0, 1e-6, false).unwrap_err().to_string();
    assert!(error.contains("rung ") && error.contains("however"), "{error}");
    assert!(sew(&[], 1.0, 1e-6, false).is_err());
}

#[test]
fn a_bilinear_face_is_a_bilinear_patch() {
    let nodes = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.05], [1.1, 1.0, 0.15], [-0.05, 0.9, 0.08]].map(Vec3::from);
    let flat = crate::surface::Patch { coefficients: [Vec3::zeros(); 4], ..patch(&nodes, &[Vec3::z(); 4]) };
    let patches = PatchSet::new(vec![flat]);
    let knots = || KnotVector::bezier(1);
    let surface = Nurbs::new([knots(), knots()], vec![nodes[0], nodes[1], nodes[3], nodes[2]], vec![1.0; 4]).unwrap();
    let faces = set(&[face(surface, vec![])], 1e-6);
    for p in scatter(500, 1.0) {
        let x = Vec3::new(0.5 + p.x, 0.5 + p.y, 0.4 * p.z);
        let (a, b) = (patches.nearest(&x).unwrap(), faces.nearest(&x).unwrap());
        assert!((a.gap - b.gap).abs() < 1e-13 && (a.point - b.point).norm() < 1e-12, "{x} {a:?} {b:?}");
        let (a, b) = (patches.closest(&x, 2.0, None), faces.closest(&x, 2.0, None));
        assert_eq!(a.is_some(), b.is_some(), "{x} {a:?} {b:?}");
        if let (Some(a), Some(b)) = (a, b) {
            assert!((a.gap - b.gap).abs() < 1e-13 && (a.normal - b.normal).norm() < 1e-12);
            assert!((a.normal_gradient - b.normal_gradient).norm() < 1e-10);
        }
    }
}

/// A die as a file gives it: the plane z = 0, a fillet of radius 10 down into a hole of radius 50, a rounded edge.
#[test]
fn a_die_from_a_file_is_smooth_to_its_last_digits() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/flanged-hole.igs");
    let faces = crate::cad::read(&path, false).unwrap().faces;
    let tool = FaceSet::new(&sew(&faces, FEATURE, usual_tolerance(&faces), false).unwrap());
    let mut warm = None;
    for k in 0..4000 {
        let (a, s) = (k as f64 * 7.3e-3, k as f64 / 4000.0);
        // Around and around, two above the plane, around the fillet and down the hole.
        let arc = FRAC_PI_2 * (4.0 * s - 1.0).clamp(0.0, 1.0);
        let (radius, z) = (60.0 - 12.0 * arc.sin(), -10.0 + 12.0 * arc.cos());
        let (radius, z) = (radius + 10.0 * (1.0 - 4.0 * s).max(0.0), z - 2.0 * (2.0 * s - 1.0).max(0.0));
        let around = Vec3::new(a.cos(), a.sin(), 0.0);
        let p = tool.closest(&(around * radius + Vec3::z() * z), 9.0, warm).unwrap();
        let normal = Vec3::z() * arc.cos() - around * arc.sin();
        assert!((p.gap - 2.0).abs() < 1e-6 && (p.normal - normal).norm() < 1e-5, "{radius} {z} {p:?}");
        warm = Some((p.patch, p.xi));
    }
}

fn surface_of(bezier: &Bezier) -> Nurbs {
    let knots = bezier.degrees().map(KnotVector::bezier);
    Nurbs::new(knots, bezier.control().to_vec(), bezier.weights().to_vec()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn no_sample_of_a_folded_face_is_closer(
        bezier in random_bezier(5),
        x in [-1.5..1.5_f64, -1.5..1.5, -1.5..1.5],
        unit in prop_oneof![Just(1.0), Just(1e-9), Just(1e9)],
        trimmed in any::<bool>(),
    ) {
        let points = bezier.control().iter().map(|p| p * unit).collect();
        let bezier = Bezier::new(bezier.degrees(), points, bezier.weights().to_vec()).unwrap();
        let x = Vec3::from(x) * unit;
        let hole = Curve::arc(Vector2::new(0.5, 0.45), Vector2::x(), Vector2::y(), 0.3, [0.0, TAU]).unwrap();
        let loops = if trimmed { vec![square(0.0, 1.0), vec![hole]] } else { vec![] };
        let tool = set(&[face(surface_of(&bezier), loops)], 1e-6 * unit);
        let nearest = tool.nearest(&x).unwrap();
        prop_assert!((nearest.point + nearest.normal * nearest.gap - x).norm() <= 1e-9 * unit);
        for k in 0..10_000 {
            let xi = [(k % 100) as f64 / 99.0, (k / 100) as f64 / 99.0];
            if !trimmed || (xi[0] - 0.5).hypot(xi[1] - 0.45) >= 0.3 {
                let distance = (x - bezier.local(xi).point).norm();
                prop_assert!(nearest.gap.abs() <= distance + 1e-9 * unit, "{} at {xi:?}", nearest.gap.abs() - distance);
            }
        }
    }
}
