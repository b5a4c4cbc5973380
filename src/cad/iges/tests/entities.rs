//! Every type of surface and of curve, against closed forms.

use super::{PART, Row, file, read_all, samples};
use crate::Vec3;
use crate::surface::Nurbs;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The first surface of a file.
fn surface_of(entities: &[Row]) -> Nurbs {
    read_all(&file(entities)).remove(0).surface
}

#[test]
fn surfaces_of_revolution_are_round() {
    // A line, an arc about a centre on the axis, one about another centre; the axis is z through (1, 2, 0).
    let curves = [(110, "4.,2.,0.,4.,2.,5."), (100, "0.,1.,2.,4.,2.,1.,5."), (100, "0.,5.,2.,6.,2.,5.,3.")];
    for (kind, curve) in curves {
        for [start, stop] in [[0.0, TAU], [0.3, 2.0], [-1.0, 4.5]] {
            // Arcs are turned about an axis in their plane, parallel to y.
            let axis = if kind == 110 { "1.,2.,7.,1.,2.,8." } else { "1.,2.,0.,1.,3.,0." };
            let parameters = format!("1,3,{start:?},{stop:?}");
            let entities = [(110, 0, PART, 0, axis), (kind, 0, PART, 0, curve), (120, 0, 0, 0, &parameters[..])];
            let surface = &read_all(&file(&entities))[0].surface;
            for xi in samples(surface) {
                let arm = surface.local(xi).point - Vec3::new(1.0, 2.0, 0.0);
                let (off, size) = match curve.as_bytes()[3] {
                    b'2' => (arm.xy().norm() - 3.0, 3.0),
                    b'1' => (arm.norm() - 3.0, 3.0),
                    _ => (((arm.xz().norm() - 4.0).powi(2) + arm.y * arm.y).sqrt() - 1.0, 5.0),
                };
                assert!(off.abs() < 1e-15 * size * 3.0, "{kind}: {off:e}");
            }
        }
    }
}

#[test]
fn curves_move_along_lines() {
    // The directrix is in the plane z = 1; D3 turns x to y, y to z and z to x and moves by (10, 20, 30).
    let matrix = (124, 0, PART, 0, "0,0,1,10,1,0,0,20,0,1,0,30");
    let moved = |x: Vec3| Vec3::new(x.z + 10.0, x.x + 20.0, x.y + 30.0);
    // Three quarters of a circle about (1, 2), from above.
    let entities = [(100, 0, PART, 3, "1,1,2,1,4,3,2"), matrix, (122, 0, 0, 0, "1,15.,21.,34.")];
    let surface = surface_of(&entities);
    for [u, v] in samples(&surface) {
        let x = surface.local([u, v]).point - Vec3::new(4.0 * v, 0.0, 0.0);
        let arm = x - moved(Vec3::new(1.0, 2.0, 1.0));
        assert!((arm.norm() - 2.0).abs() < 4e-14 && arm.x.abs() < 1e-14);
        assert!(arm.y < 1e-13 || arm.z < 1e-13);
    }
    // Both matrices act where one transforms the other, the inner one first; here on the surface as well.
    let twice = [
        (110, 0, PART, 3, "0,0,0,1,0,0"),
        (124, 0, PART, 5, "0,0,1,10,1,0,0,20,0,1,0,30"),
        (124, 1, PART, 0, "2,0,0,0,0,2,0,0,0,0,-2,0"),
        (122, 0, 0, 3, "1,20.,41.,-60."),
    ];
    let surface = surface_of(&twice);
    let scaled = |x: Vec3| Vec3::new(2.0 * x.x, 2.0 * x.y, -2.0 * x.z);
    for [u, v] in samples(&surface) {
        let x = scaled(moved(Vec3::new(u, 0.0, 0.0))) + Vec3::new(0.0, 1.0, 0.0) * v;
        assert!((surface.local([u, v]).point - scaled(moved(x))).norm() < 1e-13);
    }
}

#[test]
fn chains_of_curves_make_several_faces() {
    let curves = [
        (110, 0, PART, 0, "5,0,-8,5,0,-1"),
        (100, 0, PART, 5, "0,0,0,1,0,0,1"),
        (124, 0, PART, 0, "-1,0,0,6,0,0,1,0,0,1,0,-1"),
        (106, 12, PART, 0, "2,3,6,0,0,8,0,0,8,0,1"),
        (102, 0, PART, 0, "3,1,3,7"),
        (110, 0, PART, 0, "0,0,0,0,0,1"),
        (120, 0, 0, 0, "11,9,0,1.5"),
        (122, 0, 0, 0, "9,5,2,-8"),
    ];
    let faces = read_all(&file(&curves));
    let names: Vec<&str> = faces.iter().map(|face| face.name.as_str()).collect();
    assert_eq!(
        names[..2],
        ["surface of revolution (120) at D13, part 1 of 3", "surface of revolution (120) at D13, part 2 of 3"]
    );
    assert_eq!((names.len(), names[5]), (6, "tabulated cylinder (122) at D15, part 3 of 3"));
    for pair in faces[..3].windows(2) {
        let [before, behind] = [0, 1].map(|k| &pair[k].surface);
        for k in 0..=10 {
            let angle = 0.15 * k as f64;
            let [end, start] = [before.domain()[0][1], behind.domain()[0][0]];
            assert!((before.local([end, angle]).point - behind.local([start, angle]).point).norm() < 1e-15 * 20.0);
        }
    }
}

#[test]
fn lines_rule_surfaces() {
    let lines = [(110, 0, PART, 0, "0,0,0,4,0,0"), (110, 0, PART, 0, "4,2,1,0,2,0"), (118, 0, 0, 0, "1,3,1,0")];
    let surface = surface_of(&lines);
    for [u, v] in samples(&surface) {
        assert!((surface.local([u, v]).point - Vec3::new(4.0 * u, 2.0 * v, u * v)).norm() < 1e-14);
    }
    // A cone between quarter circles.
    let arcs = [(100, 0, PART, 0, "0,0,0,3,0,0,3"), (100, 0, PART, 0, "2,0,0,1,0,0,1"), (118, 1, 0, 0, "1,3,0,0")];
    let surface = surface_of(&arcs);
    for xi in samples(&surface) {
        let x = surface.local(xi).point;
        assert!((x.xy().norm() - (3.0 - x.z)).abs() < 1e-15 * 3.0);
    }
}

#[test]
fn splines_have_limits() {
    // A parabola y = x^2 along u, times a line.
    let whole = "2,1,2,1,0,0,1,0,0,0,0,0,1,1,1,0,0,1,1,1,1,1,1,1,1,0,0,0,.5,0,0,1,1,0,0,0,5,.5,0,5,1,1,5";
    for (limits, u, v) in [
        ("", [0.0, 1.0], [0.0, 1.0]),
        (",.25,.75,0.,1.", [0.25, 0.75], [0.0, 1.0]),
        (",0,1.,.5,1.", [0.0, 1.0], [0.5, 1.0]),
    ] {
        let surface = surface_of(&[(128, 0, 0, 0, &format!("{whole}{limits}"))]);
        assert_eq!(surface.domain(), [u, v]);
        for [u, v] in samples(&surface) {
            assert!((surface.local([u, v]).point - Vec3::new(u, u * u, 5.0 * v)).norm() < 1e-15 * 10.0);
        }
    }
    let curve = "2,2,1,0,1,0,0,0,0,1,1,1,1,1,1,0,0,0,.5,0,0,1,1,0,.5,.75,0,0,1";
    let surface = surface_of(&[(126, 0, PART, 0, curve), (122, 0, 0, 0, "1,.5,.25,5.")]);
    assert_eq!(surface.domain(), [[0.5, 0.75], [0.0, 1.0]]);
    for [u, v] in samples(&surface) {
        assert!((surface.local([u, v]).point - Vec3::new(u, u * u, 5.0 * v)).norm() < 1e-14);
    }
}

#[test]
fn planes_have_a_curve_around() {
    // x + 2 y + 2 z = 9, inside a circle of radius 3 about the nearest point to the origin.
    let circle = (100, 0, PART, 3, "0,0,0,3,0,3,0");
    let face = read_all(&file(&[
        circle,
        (124, 0, PART, 0, &columns([[2.0, 1.0, -2.0], [-2.0, 2.0, -1.0], [1.0, 2.0, 2.0]])),
        (108, 1, 0, 0, "1,2,2,9,1,0,0,0,0"),
    ]))
    .remove(0);
    assert_eq!(face.loops.len(), 1);
    let center = Vec3::new(1.0, 2.0, 2.0);
    for xi in samples(&face.surface) {
        let local = face.surface.local(xi);
        assert!((local.point.dot(&center) - 9.0).abs() < 1e-14 * 9.0);
        assert!((local.area_vector().normalize() - center / 3.0).norm() < 1e-15 * 4.0);
    }
    for curve in &face.loops[0] {
        for k in 0..=20 {
            let t = curve.domain()[0] + (curve.domain()[1] - curve.domain()[0]) * k as f64 / 20.0;
            let xi = curve.local(t).point;
            assert!(((face.surface.local([xi.x, xi.y]).point - center).norm() - 3.0).abs() < 1e-14);
        }
    }
}

/// A matrix of columns over 3 that moves the origin to (1, 2, 2).
fn columns(columns: [[f64; 3]; 3]) -> String {
    let row = |i: usize| {
        let [a, b, c] = columns.map(|column| column[i] / 3.0);
        format!("{a:?},{b:?},{c:?},{:?}", [1.0, 2.0, 2.0][i])
    };
    [row(0), row(1), row(2)].join(",")
}

#[test]
fn arcs_end_where_they_say() {
    // Quarter, half and nearly full arcs, and a circle, as directrices.
    for (ends, sweep) in
        [("1,0,0,1", FRAC_PI_2), ("0,2,0,-2", 2.0 * FRAC_PI_2), ("0,-1,-1,0", 3.0 * FRAC_PI_2), ("1,0,1,0", TAU)]
    {
        let surface = surface_of(&[(100, 0, PART, 0, &format!("0,0,0,{ends}")), (122, 0, 0, 0, "1,0,0,7")]);
        let [start, end] = surface.domain()[0];
        assert!((end - start - sweep).abs() < 1e-15);
        let given: Vec<f64> = ends.split(',').map(|text| text.parse().unwrap()).collect();
        let [a, b] = [start, end].map(|u| surface.local([u, 0.0]).point);
        assert!(
            (a - Vec3::new(given[0], given[1], 0.0)).norm() < 1e-15
                && (b - Vec3::new(given[2], given[3], 0.0)).norm() < 1e-15 * 2.0
        );
    }
}
