//! Files are written here entity by entity and read back.

mod broken;
mod entities;
mod format;
mod loops;
mod round_trip;

use super::read;
use super::write::Draft;
use crate::Vec3;
use crate::error::Error;
use crate::surface::{Face, Nurbs};
use nalgebra::Vector2;
use std::path::Path;

const EXAMPLE: &str = include_str!("../../../../inputs/flanged-hole.igs");
/// Status of a part of something else.
const PART: u32 = 10_000;

/// An entity: kind, form, status, matrix, and parameters behind the kind.
type Row<'a> = (u32, u32, u32, usize, &'a str);

/// A file of entities.
fn file(entities: &[Row]) -> String {
    let mut draft = Draft::default();
    for &(kind, form, status, matrix, parameters) in entities {
        let parameters: Vec<String> = parameters.split(',').map(str::to_string).collect();
        draft.add([kind, form, status], matrix, &parameters);
    }
    draft.finish("die.igs")
}

/// The example with a part of the data columns of one line replaced.
fn edited(from: &str, to: &str) -> String {
    let line = |line: &str| {
        let width = if line.as_bytes()[72] == b'G' { 72 } else { 64 };
        let (data, rest) = line.split_at(width);
        format!("{:width$}{rest}", data.trim_end().replace(from, to))
    };
    assert!(EXAMPLE.contains(from));
    EXAMPLE.lines().map(line).collect::<Vec<_>>().join("\n")
}

fn read_all(text: &str) -> Vec<Face> {
    let (cad, faults) = read("die.igs", text.as_bytes()).unwrap();
    assert!(faults.is_empty(), "{}", faults[0]);
    cad.faces
}

fn message_of(text: &str) -> String {
    match read("die.igs", text.as_bytes()) {
        Err(error) => error.to_string(),
        Ok((_, faults)) => faults.first().map(Error::to_string).unwrap_or_default(),
    }
}

/// Parameters spread over the domain.
fn samples(surface: &Nurbs) -> Vec<[f64; 2]> {
    let [u, v] = surface.domain();
    let at = |[a, b]: [f64; 2], k: usize| a + (b - a) * k as f64 / 12.0;
    (0..169).map(|k| [at(u, k % 13), at(v, k / 13)]).collect()
}

/// Even-odd rule with `ray` parallel to the first parameter, the loops as polygons of many sides.
fn is_inside(face: &Face, xi: [f64; 2]) -> bool {
    let mut crossings = 0;
    for curve in face.loops.iter().flatten() {
        for [a, b] in curve.knots().spans() {
            let points: Vec<Vector2<f64>> =
                (0..=200).map(|k| curve.local(a + (b - a) * k as f64 / 200.0).point).collect();
            for pair in points.windows(2) {
                let above = pair.iter().filter(|point| point.y > xi[1]).count();
                let t = (xi[1] - pair[0].y) / (pair[1].y - pair[0].y);
                crossings += usize::from(above == 1 && pair[0].x + t * (pair[1].x - pair[0].x) > xi[0]);
            }
        }
    }
    crossings % 2 == 1
}

#[test]
fn the_example_is_a_die() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/flanged-hole.igs");
    let cad = crate::cad::read(&path, false).unwrap();
    assert_eq!(cad.unit.as_deref(), Some("mm"));
    let names: Vec<&str> = cad.faces.iter().map(|face| face.name.as_str()).collect();
    let revolution = |number| format!("surface of revolution (120) at D{number}");
    let expected =
        ["trimmed surface (144) at D11", &revolution(17), &revolution(23), "tabulated cylinder (122) at D29"];
    assert_eq!(names, expected);
    let normal = |surface: &Nurbs, xi| surface.local(xi).area_vector().normalize();
    let [flange, wall, fillet, edge] = [0, 1, 2, 3].map(|k| &cad.faces[k]);
    for xi in samples(&flange.surface) {
        let x = flange.surface.local(xi).point;
        assert!((x - Vec3::new(xi[0], xi[1], 0.0)).norm() < 1e-13 && normal(&flange.surface, xi) == Vec3::z());
        assert_eq!(is_inside(flange, [xi[0] + 1e-3, xi[1] + 1e-3]), x.norm() > 60.0 && xi[0] < 100.0 && xi[1] < 100.0);
    }
    for xi in samples(&wall.surface) {
        let x = wall.surface.local(xi).point;
        assert!((x.xy().norm() - 50.0).abs() < 1e-13 && (-60.0..=-10.0).contains(&x.z));
        assert!((normal(&wall.surface, xi) + Vec3::new(x.x, x.y, 0.0) / 50.0).norm() < 1e-14);
    }
    for xi in samples(&fillet.surface) {
        let x = fillet.surface.local(xi).point;
        let center = Vec3::new(x.x, x.y, 0.0).normalize() * 60.0 - Vec3::z() * 10.0;
        assert!(((x - center).norm() - 10.0).abs() < 1e-13, "{}", (x - center).norm() - 10.0);
        assert!((normal(&fillet.surface, xi) - (x - center) / 10.0).norm() < 1e-14);
        assert!(x.xy().norm() < 60.0 + 1e-13 && x.z > -10.0 - 1e-13);
    }
    for xi in samples(&edge.surface) {
        let x = edge.surface.local(xi).point;
        let arm = Vec3::new(0.0, x.y - 100.0, x.z + 6.0);
        assert!((arm.norm() - 6.0).abs() < 3e-14, "{:e}", arm.norm() - 6.0);
        assert!(x.x.abs() < 100.0 + 1e-13 && x.y > 100.0 - 1e-13);
        assert!((normal(&edge.surface, xi) - arm / 6.0).norm() < 1e-14);
    }
}
