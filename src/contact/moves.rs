//! How a step moves points of bodies and tools, as far as it prescribes that.

use crate::{Mat3, Vec3};

/// The bits of a way that tell courses from each other.
const COURSES: u64 = 0xffff;
/// Differences of ways over these below which they are the same: vectors are typed with some digits. Well above what a course
/// changes a way by.
const ROUNDING: f64 = 1e-6;
/// Share of a relative motion, and cosine, below which there is none along a direction. What stands still across a plane but for the
/// digits of meshes and vectors would slip there as far as it can, and friction have to be found from 1e-8 of a way.
pub const RIGHT: f64 = 1e-5;

/// How a step moves a point, along three directions at right angles to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement {
    /// The directions, its columns: the coordinate axes unless conditions are inclined.
    pub axes: Mat3,
    /// The [`way`] along each: NaN where it is free, infinite where what moves does not move alike.
    pub ways: [f64; 3],
}

impl Movement {
    /// Along the coordinate axes.
    pub fn along_axes(ways: [f64; 3]) -> Self {
        Self { axes: Mat3::identity(), ways }
    }

    /// The way along any direction, a unit vector.
    pub fn along(&self, direction: &Vec3) -> f64 {
        let parts = self.axes.column_iter().map(|axis| axis.dot(direction)).zip(self.ways);
        let parts = || parts.clone().filter(|(part, _)| part.abs() > RIGHT);
        if parts().any(|(_, way)| way.is_nan()) {
            return f64::NAN;
        }
        let mut courses = parts().filter(|(_, way)| *way != 0.0).map(|(_, way)| way.to_bits() & COURSES);
        let course = courses.next().unwrap_or(0);
        if parts().any(|(_, way)| way.is_infinite()) || courses.any(|other| other != course) {
            return f64::INFINITY;
        }
        let by = |(part, way): (f64, f64)| part * length(way);
        let (sum, most) = (parts().map(by).sum::<f64>(), parts().map(|at| by(at).abs()).sum::<f64>());
        if sum.abs() <= ROUNDING * most { 0.0 } else { way(sum, course as u32) }
    }
}

/// A number for a motion by so much on a course: two motions have the same where they go alike.
pub fn way(by: f64, course: u32) -> f64 {
    if by == 0.0 { 0.0 } else { f64::from_bits(by.to_bits() & !COURSES | u64::from(course) & COURSES) }
}

/// How far a way leads.
fn length(way: f64) -> f64 {
    f64::from_bits(way.to_bits() & !COURSES)
}

/// Whether two ways are the same, but for rounding; of what does not move alike, nothing is known to be.
pub fn alike(a: f64, b: f64) -> bool {
    let same_course = (a.to_bits() ^ b.to_bits()) & COURSES == 0;
    a == b && a.is_finite() || same_course && (a - b).is_finite() && (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
}

/// Along which of three directions two points stand still relative to each other, by their ways along these: where they move alike,
/// and where they move by next to nothing of what they go, or may go, along the others.
pub fn still(own: [f64; 3], other: [f64; 3]) -> [bool; 3] {
    // What is free may stand still.
    let known = |way: f64| if way.is_nan() { 0.0 } else { length(way) };
    let apart = |d: usize| match own[d].is_infinite() || other[d].is_infinite() {
        true => 0.0,
        false => (known(own[d]) - known(other[d])).abs(),
    };
    let slight = RIGHT * (0..3).map(apart).fold(0.0, f64::max);
    [0, 1, 2].map(|d| {
        let moves_by_nothing = own[d].abs() <= slight && other[d].abs() <= slight;
        alike(own[d], other[d]) || moves_by_nothing
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_along_inclined_directions_are_those_of_their_components() {
        let n = Vec3::new(0.6, 0.8, 0.0);
        let tool = Movement::along_axes([way(3.0, 1), way(4.0, 1), f64::NAN]);
        assert!(alike(tool.along(&n), way(5.0, 1)) && !alike(tool.along(&n), way(5.0, 2)));
        assert_eq!(tool.along(&Vec3::new(0.8, -0.6, 0.0)), 0.0);
        assert!(tool.along(&Vec3::new(0.0, 0.6, 0.8)).is_nan());
        let turning = Movement::along_axes([way(3.0, 1), way(4.0, 2), f64::INFINITY]);
        assert_eq!(turning.along(&Vec3::z()), f64::INFINITY);
        assert_eq!(turning.along(&n), f64::INFINITY, "of two courses");
        assert_eq!(turning.along(&-Vec3::x()), way(-3.0, 1));
    }

    #[test]
    fn next_to_nothing_of_a_relative_motion_is_none() {
        const FREE: f64 = f64::NAN;
        let held = [0.0, FREE, FREE];
        assert_eq!(still(held, [2e-7, way(0.1, 1), 0.0]), [true, false, false]);
        assert_eq!(still(held, [way(2e-5, 1), way(0.1, 1), 0.0]), [false; 3]);
        // What both are carried by says nothing.
        let carried = |across: f64| [way(100.0, 1), across, 0.0];
        assert_eq!(still(carried(0.0), carried(way(5e-4, 1))), [true, false, true]);
        assert_eq!(still(carried(0.0), [way(100.0, 2), 0.0, 0.0]), [false, true, true]);
        assert_eq!(still([0.0, FREE, FREE], [1e-9, f64::INFINITY, 0.0]), [false; 3]);
    }
}
