//! STL files of spheres, cylinders and rectangles.

use nagata::Vec3;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

pub type Triangle = [Vec3; 3];

/// A sphere about the origin: the faces of an icosahedron, each in n² parts.
pub fn sphere(n: usize, radius: f64) -> Vec<Triangle> {
    // Two poles, and two rings of five corners between them.
    let ring = |k: usize, z: f64, turn: f64| {
        let angle = (k as f64 + turn) * TAU / 5.0;
        Vec3::new(angle.cos() * (1.0 - z * z).sqrt(), angle.sin() * (1.0 - z * z).sqrt(), z)
    };
    let height = 1.0 / 5f64.sqrt();
    let mut faces = Vec::new();
    for k in 0..5 {
        let [top, next] = [ring(k, height, 0.0), ring(k + 1, height, 0.0)];
        let [low, before] = [ring(k, -height, 0.5), ring(k + 4, -height, 0.5)];
        faces.extend([[Vec3::z(), top, next], [top, low, next], [before, low, top], [-Vec3::z(), low, before]]);
    }
    let mut parts = Vec::new();
    for [a, b, c] in faces {
        let at = |i: usize, j: usize| {
            (a + (b - a) * (i as f64 / n as f64) + (c - a) * (j as f64 / n as f64)).normalize() * radius
        };
        for i in 0..n {
            for j in 0..n - i {
                parts.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 2 <= n {
                    parts.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    parts
}

/// A closed cylinder along z with n edges around, from -1 to 1: each side, and fans at its ends.
pub fn cylinder(n: usize, radius: f64) -> Vec<Triangle> {
    let at = |k: usize, z: f64| {
        let angle = TAU * k as f64 / n as f64;
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    };
    let side = |k: usize| {
        let [a, b, c, d] = [at(k, -1.0), at(k + 1, -1.0), at(k + 1, 1.0), at(k, 1.0)];
        let [below, above] = rectangle([a, b, c, d]);
        [below, above, [Vec3::z(), d, c], [-Vec3::z(), b, a]]
    };
    (0..n).flat_map(side).collect()
}

/// By its corners, counter-clockwise.
pub fn rectangle([a, b, c, d]: [Vec3; 4]) -> [Triangle; 2] {
    [[a, b, c], [a, c, d]]
}

/// As text, a solid of this name.
pub fn text(name: &str, triangles: &[Triangle]) -> String {
    let mut text = format!("solid {name}\n");
    for [a, b, c] in triangles {
        let n = (b - a).cross(&(c - a)).normalize();
        let _ = writeln!(text, "  facet normal {:e} {:e} {:e}\n    outer loop", n.x, n.y, n.z);
        for x in [a, b, c] {
            let _ = writeln!(text, "      vertex {:e} {:e} {:e}", x.x, x.y, x.z);
        }
        text += "    endloop\n  endfacet\n";
    }
    text + &format!("endsolid {name}\n")
}

/// In binary: single precision.
pub fn binary(triangles: &[Triangle]) -> Vec<u8> {
    let mut data = vec![b'*'; 80];
    data.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        data.extend([0; 12]);
        let numbers = triangle.iter().flat_map(|x| [x.x, x.y, x.z]);
        numbers.for_each(|x| data.extend((x as f32).to_le_bytes()));
        data.extend([0; 2]);
    }
    data
}

/// Points on the unit sphere, about evenly spread.
pub fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let (z, angle) = (1.0 - (2 * k + 1) as f64 / count as f64, PI * (3.0 - 5f64.sqrt()) * k as f64);
        Vec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z)
    })
}
