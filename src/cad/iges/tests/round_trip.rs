//! Faces that are written and read back.

use crate::Vec3;
use crate::cad::{iges, read};
use crate::surface::{Curve, Face, KnotVector, Nurbs};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::TAU;

fn there_and_back(faces: &[Face]) -> Vec<Face> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("die.IGS");
    iges::write(&path, faces).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.lines().all(|line| line.len() == 80));
    let cad = read(&path, false).unwrap();
    assert!(cad.unit.as_deref() == Some("mm") && cad.skipped.is_empty());
    cad.faces
}

/// A clamped knot vector with inner knots anywhere.
fn knots() -> impl Strategy<Value = KnotVector> {
    let inner = proptest::collection::vec(-1.0_f64..2.0, 0..4);
    (1_usize..5, inner).prop_map(|(degree, mut inner)| {
        inner.sort_by(f64::total_cmp);
        KnotVector::new(degree, [vec![-1.5; degree + 1], inner, vec![2.25; degree + 1]].concat()).unwrap()
    })
}

fn surface() -> impl Strategy<Value = Nurbs> {
    let number = (-1e3_f64..1e3).prop_map(|x| x * x * x);
    (knots(), knots()).prop_flat_map(move |(u, v)| {
        let count = u.count() * v.count();
        let points = proptest::collection::vec([number.clone(), number.clone(), number.clone()], count);
        let weights = proptest::collection::vec(0.1_f64..10.0, count);
        (Just([u, v]), points, weights).prop_map(|(knots, points, weights)| {
            Nurbs::new(knots, points.into_iter().map(Vec3::from).collect(), weights).unwrap()
        })
    })
}

/// A triangle and a circle in the domain of [`knots`].
fn loops(corners: [[f64; 2]; 3], center: [f64; 2]) -> Vec<Vec<Curve<2>>> {
    let corners = corners.map(Vector2::from);
    let triangle = (0..3).map(|k| Curve::line(corners[k], corners[(k + 1) % 3])).collect();
    let circle = Curve::arc(Vector2::from(center), Vector2::x(), Vector2::y(), 0.01, [0.0, TAU]).unwrap();
    let mut points = circle.points().to_vec();
    points[8] = points[0];
    let circle = Curve::new(circle.knots().clone(), points, circle.weights().to_vec()).unwrap();
    vec![triangle, vec![circle]]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_is_lost(
        surface in surface(),
        corners in [[-1.4_f64..2.2, -1.4_f64..2.2], [-1.4_f64..2.2, -1.4_f64..2.2], [-1.4_f64..2.2, -1.4_f64..2.2]],
        center in [-1.4_f64..2.2, -1.4_f64..2.2],
    ) {
        let whole = Face { surface: surface.clone(), loops: Vec::new(), reversed: false, name: String::new() };
        let trimmed = Face { loops: loops(corners, center), ..whole.clone() };
        let back = there_and_back(&[whole, trimmed.clone()]);
        prop_assert_eq!(&back[0].surface, &surface);
        prop_assert!(back[0].loops.is_empty());
        prop_assert_eq!(&back[1].surface, &surface);
        // The larger loop is written first.
        let mut found = back[1].loops.clone();
        found.sort_by_key(|chain| std::cmp::Reverse(chain.len()));
        prop_assert_eq!(&found, &trimmed.loops);
    }
}

#[test]
fn the_outside_survives() {
    let surface = Nurbs::plane(Vec3::zeros(), Vec3::x() * 2.0, Vec3::y());
    let square = [[0.1, 0.2], [0.6, 0.2], [0.6, 0.9], [0.1, 0.9]].map(Vector2::from);
    let chain = (0..4).map(|k| Curve::line(square[k], square[(k + 1) % 4])).collect();
    let face = Face { surface, loops: vec![chain], reversed: true, name: String::new() };
    let back = there_and_back(&[face]).remove(0);
    assert!(!back.reversed);
    assert_eq!(back.surface.local([0.5, 0.5]).area_vector(), Vec3::z() * -2.0);
    for (curve, corner) in back.loops[0].iter().zip(square) {
        let x = back.surface.local(curve.points()[0].into()).point;
        assert!((x - Vec3::new(2.0 * corner.x, corner.y, 0.0)).norm() < 1e-15);
    }
}
