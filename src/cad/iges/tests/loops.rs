//! Trimming loops, in the parameters of the file and in space.

use super::{PART, Row, file, is_inside, message_of, read_all, samples};
use crate::Vec3;
use crate::surface::{Curve, Face};
use std::f64::consts::TAU;

/// Points of a chain of curves.
fn along(chain: &[Curve<2>]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for curve in chain {
        let [a, b] = curve.domain();
        points.extend((0..=50).map(|k| <[f64; 2]>::from(curve.local(a + (b - a) * k as f64 / 50.0).point)));
    }
    points
}

fn is_closed(chain: &[Curve<2>]) -> bool {
    let end = |curve: &Curve<2>, k: usize| curve.local(curve.domain()[k]).point;
    (0..chain.len()).all(|k| (end(&chain[k], 1) - end(&chain[(k + 1) % chain.len()], 0)).norm() < 1e-15 * 20.0)
}

/// A cylinder of radius 2 about z over 0 <= z <= 3, its parameters (z/3, angle), trimmed by a curve in D9 and following.
fn on_cylinder(curves: &[Row]) -> Face {
    let chain = format!("0,5,{},0,1", 7 + 2 * (curves.len() - 1));
    let trimmed = format!("5,1,0,{}", 7 + 2 * curves.len());
    let mut entities = vec![
        (110, 0, PART, 0, "2,0,0,2,0,3"),
        (110, 0, PART, 0, "0,0,0,0,0,1"),
        (120, 0, PART, 0, "3,1,0.,6.283185307179586"),
    ];
    entities.extend(curves);
    entities.extend([(142, 0, PART, 0, chain.as_str()), (144, 0, 0, 0, trimmed.as_str())]);
    let mut faces = read_all(&file(&entities));
    assert_eq!(faces.len(), 1);
    assert!(is_closed(&faces[0].loops[0]));
    faces.remove(0)
}

#[test]
fn lines_along_parameters_stay_exact() {
    let window = on_cylinder(&[(106, 63, PART, 0, "1,5,0.,.25,.4,.75,.4,.75,2.,.25,2.,.25,.4")]);
    assert_eq!(window.loops[0].len(), 4);
    assert!(window.loops[0].iter().all(|curve| curve.knots().degree() == 1));
    for [u, v] in along(&window.loops[0]) {
        let x = window.surface.local([u, v]).point;
        let angle = x.y.atan2(x.x);
        let on_side = (x.z - 0.75).abs().min((x.z - 2.25).abs()).min((angle - 0.4).abs()).min((angle - 2.0).abs());
        assert!(on_side < 1e-14, "{on_side:e}");
    }
}

#[test]
fn other_curves_follow_the_angle() {
    // A circle in the plane of (z/3, angle), and a triangle whose long side is a helix.
    let circle = on_cylinder(&[(100, 0, PART, 0, "0,.5,3,.9,3,.9,3")]);
    for [u, v] in along(&circle.loops[0]) {
        let x = circle.surface.local([u, v]).point;
        let angle = x.y.atan2(x.x).rem_euclid(TAU);
        assert!(((x.z / 3.0 - 0.5).hypot(angle - 3.0) - 0.4).abs() < 1e-9);
    }
    for [u, v] in samples(&circle.surface) {
        let x = circle.surface.local([u, v]).point;
        let angle = if v == 0.0 {
            0.0
        } else if v == TAU {
            TAU
        } else {
            x.y.atan2(x.x).rem_euclid(TAU)
        };
        assert_eq!(is_inside(&circle, [u, v]), (x.z / 3.0 - 0.5).hypot(angle - 3.0) < 0.4, "{u} {v}");
    }
    let lines = ["0,0,0,1,6,0", "1,6,0,1,0,0", "1,0,0,0,0,0"].map(|ends| (110, 0, PART, 0, ends));
    let triangle = on_cylinder(&[lines[0], lines[1], lines[2], (102, 0, PART, 0, "3,7,9,11")]);
    assert!(triangle.loops[0][0].knots().degree() == 5 && triangle.loops[0].len() == 3);
    for [u, v] in along(&triangle.loops[0][..1]) {
        let x = triangle.surface.local([u, v]).point;
        assert!((x.y.atan2(x.x).rem_euclid(TAU) - 2.0 * x.z).abs() < 1e-9);
    }
}

#[test]
fn arcs_give_their_angle_as_parameter() {
    // A quarter tube along y: u is the angle over pi/2. A straight cut across it.
    let entities = [
        (100, 0, PART, 0, "0,0,0,1,0,0,1"),
        (122, 0, PART, 0, "1,1,0,4"),
        (106, 63, PART, 0, "1,4,0.,0.,0.,1.,0.,1.,1.,0.,0."),
        (142, 0, PART, 0, "0,3,5,0,1"),
        (144, 0, 0, 0, "3,1,0,7"),
    ];
    let face = read_all(&file(&entities)).remove(0);
    assert_eq!(face.loops[0].len(), 3);
    for [u, v] in along(&face.loops[0][2..]) {
        let x = face.surface.local([u, v]).point;
        assert!((x.z / 4.0 - x.y.atan2(x.x) / (0.25 * TAU)).abs() < 1e-9);
    }
}

/// A plane, 4 by 2, with a hole; the curves behind it from D3 on.
fn on_plane(entities: &[Row]) -> String {
    let plane = "1,1,1,1,0,0,1,0,0,0,0,4,4,0,0,2,2,1,1,1,1,0,0,0,4,0,0,0,2,0,4,2,0,0,4,0,2";
    file(&[&[(128, 0, PART, 0, plane)], entities].concat())
}

#[test]
fn holes_without_an_outer_boundary_keep_the_domain() {
    let hole = [
        (100, 0, PART, 0, "0,2,1,2.5,1,2.5,1"),
        (142, 0, PART, 0, "0,1,3,0,1"),
        (144, 0, 0, 0, "1,0,1,0,5"),
        (144, 0, 0, 0, "1,0,0,0"),
    ];
    let faces = read_all(&on_plane(&hole));
    assert_eq!((faces[0].loops.len(), faces[1].loops.len()), (2, 0));
    for xi in samples(&faces[0].surface).into_iter().map(|[u, v]| [0.99 * u + 0.01, 0.99 * v + 0.01]) {
        assert_eq!(is_inside(&faces[0], xi), (xi[0] - 2.0).hypot(xi[1] - 1.0) > 0.5);
    }
    assert_eq!(faces[0].loops[1].len(), 1);
}

#[test]
fn curves_in_space_serve_where_there_are_no_others() {
    let circle = (100, 0, PART, 0, "0,2,1,2.5,1,2.5,1");
    let bounds: [&[Row]; 2] = [
        &[circle, (142, 0, PART, 0, "0,1,0,3,2"), (144, 0, 0, 0, "1,1,0,5")],
        &[circle, (141, 0, PART, 0, "0,1,1,1,3,1,0"), (143, 0, 0, 0, "0,1,1,5")],
    ];
    for entities in bounds {
        let face = read_all(&on_plane(entities)).remove(0);
        assert!(is_closed(&face.loops[0]));
        for [u, v] in along(&face.loops[0]) {
            assert!(((u - 2.0).hypot(v - 1.0) - 0.5).abs() < 5e-8);
        }
    }
    // Both representations of a boundary: the parameters are taken.
    let both = [circle, circle, (141, 0, PART, 0, "1,1,1,1,3,1,1,5"), (143, 0, 0, 0, "1,1,1,7")];
    assert_eq!(read_all(&on_plane(&both)).remove(0).loops[0].len(), 1);
}

#[test]
fn a_boundary_in_space_finds_both_sides_of_a_seam() {
    // The lower half of a cylinder: up the seam, round, down the seam, round.
    let entities = [
        (110, 0, PART, 0, "2,0,0,2,0,3"),
        (110, 0, PART, 0, "0,0,0,0,0,1"),
        (120, 0, PART, 0, "3,1,0.,6.283185307179586"),
        (110, 0, PART, 0, "2,0,0,2,0,1.5"),
        (100, 0, PART, 0, "1.5,0,0,2,0,2,0"),
        (100, 0, PART, 0, "0,0,0,2,0,2,0"),
        (141, 0, PART, 0, "0,1,5,4,7,1,0,9,1,0,7,2,0,11,2,0"),
        (143, 0, 0, 0, "0,5,1,13"),
    ];
    let face = read_all(&file(&entities)).remove(0);
    assert!(is_closed(&face.loops[0]));
    for [u, v] in samples(&face.surface).into_iter().map(|[u, v]| [0.99 * u + 0.004, 0.99 * v + 0.02]) {
        assert_eq!(is_inside(&face, [u, v]), u < 0.5);
    }
}

#[test]
fn curves_in_space_may_meet_in_a_pole() {
    // A hemisphere of radius 2, its pole on x, between two meridians; the second of them is the seam.
    let entities = [
        (110, 0, PART, 0, "0,0,0,1,0,0"),
        (100, 0, PART, 0, "0,0,0,2,0,0,2"),
        (120, 0, PART, 0, "1,3,0.,6.283185307179586"),
        (124, 0, PART, 0, "1,0,0,0,0,0,-1,0,0,1,0,0"),
        (124, 0, PART, 0, "0,0,1,0,1,0,0,0,0,1,0,0"),
        // From z = -2 up to the pole, from the pole down to y = 2, along the equator back.
        (100, 0, PART, 7, "0,0,0,0,-2,2,0"),
        (100, 0, PART, 9, "0,0,0,2,0,0,-2"),
        (100, 0, PART, 0, "0,0,0,2,0,0,2"),
        (141, 0, PART, 0, "0,1,5,3,11,1,0,15,1,0,13,1,0"),
        (143, 0, 0, 0, "0,5,1,17"),
    ];
    let face = read_all(&file(&entities)).remove(0);
    assert!(is_closed(&face.loops[0]));
    for [u, v] in samples(&face.surface).into_iter().map(|[u, v]| [0.99 * u + 0.004, 0.99 * v + 0.02]) {
        assert_eq!(is_inside(&face, [u, v]), v < 0.75 * TAU, "{u} {v}");
    }
}

#[test]
fn gaps_are_closed_or_told() {
    let loops = |gap: f64| {
        let lines = [
            "0,0,0,4,0,0".to_string(),
            format!("4,{gap:?},0,2,2,0"),
            // Against the others' direction.
            format!("{gap:?},0,0,2,2,0"),
        ];
        on_plane(&[
            (110, 0, PART, 0, &lines[0]),
            (110, 0, PART, 0, &lines[1]),
            (110, 0, PART, 0, &lines[2]),
            (102, 0, PART, 0, "3,3,5,7"),
            (142, 0, PART, 0, "0,1,9,0,1"),
            (144, 0, 0, 0, "1,1,0,11"),
        ])
    };
    for (gap, count) in [(0.0, 3), (1e-10, 3), (1e-6, 5), (1e-3, 5)] {
        let chain = read_all(&loops(gap)).remove(0).loops.remove(0);
        assert!(chain.len() == count && is_closed(&chain), "{gap}: {}", chain.len());
        for (curve, corner) in chain.iter().filter(|curve| curve.bounds().1 != curve.bounds().0).zip([0, 1, 2]) {
            assert!(corner != 0 || curve.local(1.0).point.x == 4.0);
        }
    }
    let text = message_of(&loops(0.1));
    let expected =
        "curve on a surface (142) at D11: the loop is open between curves 1 and 2 of 3, from (4, 0) to (4, 0.1)";
    assert!(text.contains(expected), "{text}");
    let outside = [(100, 0, PART, 0, "0,2,1,3.5,1,3.5,1"), (142, 0, PART, 0, "0,1,3,0,1"), (144, 0, 0, 0, "1,1,0,5")];
    assert!(message_of(&on_plane(&outside)).contains("the loop leaves the parameters of the surface"));
    let high = [(100, 0, PART, 0, ".1,2,1,2.5,1,2.5,1"), (142, 0, PART, 0, "0,1,0,3,1"), (144, 0, 0, 0, "1,1,0,5")];
    assert!(message_of(&on_plane(&high)).contains("the curve in space is 1.000e-1 away from the surface"));
}

#[test]
fn what_trims_a_surface_is_moved_with_it() {
    let entities = [
        (100, 0, PART, 0, "0,2,1,2.5,1,2.5,1"),
        (142, 0, PART, 0, "0,1,0,3,1"),
        (124, 0, PART, 0, "0,-1,0,5,1,0,0,0,0,0,1,7"),
        (144, 0, 0, 7, "1,1,0,5"),
    ];
    let face = read_all(&on_plane(&entities)).remove(0);
    for xi in along(&face.loops[0]) {
        let x = face.surface.local(xi).point - Vec3::new(4.0, 2.0, 7.0);
        assert!((x.norm() - 0.5).abs() < 5e-8 && x.z.abs() < 1e-15);
    }
}

#[test]
fn poles_and_angles_are_as_others_write_them() {
    // A sphere without its cap above z = 5. The generatrix begins at the angle -pi/2, or 3 pi/2; nine digits; the loop
    // has no curve along the pole.
    for [start, end] in [["-1.570796327", "0.523598776"], ["4.71238898", "6.806784083"]] {
        let curves = [
            format!("{end},0.,0.,{end},6.283185307,0."),
            format!("{end},6.283185307,0.,{start},6.283185307,0."),
            format!("{start},1.046360549E-15,0.,{end},1.511409682E-15,0."),
        ];
        let entities = [
            (110, 0, PART, 0, "0,0,1,0,0,0"),
            (100, 0, PART, 5, "0.,0.,0.,6.123233996E-16,-10.,8.660254038,5."),
            (124, 0, PART, 0, "1.,0.,0.,0.,0.,0.,-1.,0.,0.,1.,-0.,0."),
            (120, 0, PART, 0, "1,3,0.,6.283185307"),
            (110, 0, PART, 0, &curves[0]),
            (110, 0, PART, 0, &curves[1]),
            (110, 0, PART, 0, &curves[2]),
            (102, 0, PART, 0, "3,9,11,13"),
            (142, 0, PART, 0, "0,7,15,0,3"),
            (144, 0, 0, 0, "7,1,0,17"),
            // Half of it, to the angle pi.
            (106, 11, PART, 0, &format!("1,4,0.,{end},0.,{end},3.141592654,{start},3.141592654,{start},0.")),
            (110, 0, PART, 0, &curves[2]),
            (102, 0, PART, 0, "2,21,23"),
            (142, 0, PART, 0, "0,7,25,0,3"),
            (144, 0, 0, 0, "7,1,0,27"),
        ];
        let faces = read_all(&file(&entities));
        // The first is all there is of its surface.
        assert!(faces[0].loops.is_empty() && is_closed(&faces[1].loops[0]));
        for [u, v] in samples(&faces[1].surface).into_iter().filter(|[_, v]| *v != 0.0) {
            let x = faces[1].surface.local([u, v]).point;
            assert!((x.norm() - 10.0).abs() < 1e-9 && x.z < 5.0 + 1e-8);
            assert_eq!(is_inside(&faces[1], [u, v]), u < faces[1].surface.domain()[0][1] && v < 0.51 * TAU, "{u} {v}");
        }
    }
}

#[test]
fn planes_take_their_curves_in_space() {
    // x = 3, between two squares; no parameters anywhere. The other is a plain square.
    let square = |r: u32| format!("2,5,3.,-{r},-{r},3.,{r},-{r},3.,{r},{r},3.,-{r},{r},3.,-{r},-{r}");
    let entities = [
        (108, 0, PART, 0, "-2.,0.,0.,-6.,0,0.,0.,0.,0."),
        (106, 63, PART, 0, &square(4)[..]),
        (106, 63, PART, 0, &square(1)),
        (142, 0, PART, 0, "0,1,0,3,2"),
        (142, 0, PART, 0, "0,1,0,5,2"),
        (144, 0, 0, 0, "1,1,1,7,9"),
        (144, 0, 0, 0, "1,1,0,7"),
        (144, 0, 0, 0, "1,0,1,0,7"),
    ];
    let text = file(&entities);
    assert!(message_of(&text).contains("trimmed surface (144) at D15: a plane without outer boundary is not read"));
    let faces = read_all(&file(&entities[..7]));
    assert!(faces[1].loops.is_empty());
    for face in &faces {
        for xi in samples(&face.surface).into_iter().map(|[u, v]| [0.99 * u + 0.003, 0.99 * v + 0.003]) {
            let local = face.surface.local(xi);
            assert!((local.point.x - 3.0).abs() < 1e-15 && local.area_vector().normalize() == -Vec3::x());
            assert!(local.point.amax() < 4.0);
            let hole = local.point.y.abs().max(local.point.z.abs()) < 1.0;
            assert_eq!(face.loops.is_empty() || is_inside(face, xi), !hole || face.loops.is_empty());
        }
    }
}
