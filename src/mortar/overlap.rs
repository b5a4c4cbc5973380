//! The points of a slave face that a master face covers.

use super::face::Corners;
use super::{polygon, rule};
use crate::{Vec2, Vec3};

/// Share of a face below which what two have in common is rounding.
const NOTHING: f64 = 1e-12;

/// The mean plane of a face.
#[derive(Clone, Copy, Debug)]
pub struct MeanPlane {
    pub origin: Vec3,
    /// Outwards, a unit vector.
    pub normal: Vec3,
    axes: [Vec3; 2],
    /// Of the face in it.
    pub area: f64,
    face: Corners<Vec2>,
}

/// An integration point.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Its part of the area.
    pub weight: f64,
    /// Shape functions of the slave face and of the master face.
    pub slave: [f64; 4],
    pub master: [f64; 4],
}

impl MeanPlane {
    /// Of a face; `None` for one without an area.
    pub fn of(face: &Corners<Vec3>) -> Option<Self> {
        let area = face.area_vector();
        let normal = area.try_normalize(f64::MIN_POSITIVE)?;
        let origin = face.all().iter().sum::<Vec3>() / face.count as f64;
        let first = face.x[1] - face.x[0];
        let first = (first - normal * normal.dot(&first)).try_normalize(f64::MIN_POSITIVE)?;
        let axes = [first, normal.cross(&first)];
        let mut plane = Self { origin, normal, axes, area: area.norm(), face: Corners::new(&[Vec2::zeros(); 3]) };
        plane.face = face.map(|x| plane.project(&x));
        Some(plane)
    }

    /// A point along the normal.
    fn project(&self, x: &Vec3) -> Vec2 {
        let from = x - self.origin;
        Vec2::new(self.axes[0].dot(&from), self.axes[1].dot(&from))
    }
}

/// Integration points of what a master face covers of a slave face, with rules of `coarse` points along a line where these
/// are exact, else of `fine`.
pub fn overlap(plane: &MeanPlane, master: &Corners<Vec3>, [coarse, fine]: [&[[f64; 2]]; 2]) -> Vec<Point> {
    let slave = &plane.face;
    let mut projected: Vec<Vec2> = master.all().iter().map(|x| plane.project(x)).collect();
    let face = Corners::new(&projected);
    if polygon::area(&projected) < 0.0 {
        projected.reverse();
    }
    let common = polygon::common(&projected, slave.all());
    let mut points = Vec::new();
    if polygon::area(&common) <= NOTHING * plane.area {
        return points;
    }
    let line = if slave.is_affine() && face.is_affine() { coarse } else { fine };
    for triangle in polygon::triangles(&common) {
        rule::on_triangle(line, &triangle, |x, weight| {
            if let (Some(slave), Some(master)) = (slave.shapes(&x), face.shapes(&x)) {
                points.push(Point { weight, slave, master });
            }
        });
    }
    points
}
