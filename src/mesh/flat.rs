//! The plane in which points lie.

use crate::{Mat3, Vec3};
use nalgebra::SymmetricEigen;

/// Squared extent across its length, over that along it, below which a set of points is a line.
const LINE: f64 = 1e-10;

/// Number, sum and squares of points about an origin, which add up over sets of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments(pub [f64; 13]);

impl Moments {
    pub fn of(origin: &Vec3, points: impl Iterator<Item = Vec3>) -> Self {
        let mut sums = [0.0; 13];
        for x in points.map(|x| x - origin) {
            let squares = x * x.transpose();
            let all = [1.0].into_iter().chain(x.iter().copied()).chain(squares.iter().copied());
            sums.iter_mut().zip(all).for_each(|(sum, value)| *sum += value);
        }
        Self(sums)
    }

    /// The unit normal of the plane that the points are nearest to, its largest component positive; none of points in a line.
    pub fn normal(&self) -> Option<Vec3> {
        let [count, rest @ ..] = &self.0;
        let mean = Vec3::from_column_slice(&rest[..3]) / *count;
        let spread = Mat3::from_column_slice(&rest[3..]) / *count - mean * mean.transpose();
        if !spread.iter().all(|x| x.is_finite()) {
            return None;
        }
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigenvalues[a].total_cmp(&eigenvalues[b]));
        let [least, middle, most] = order;
        let normal: Vec3 = eigenvectors.column(least).into();
        (eigenvalues[middle] > LINE * eigenvalues[most]).then(|| normal * normal[normal.iamax()].signum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_in_a_plane_have_its_normal_and_those_in_a_line_none() {
        let normal = Vec3::new(2.0, -3.0, 6.0) / 7.0;
        let along = [normal.cross(&Vec3::x()).normalize(), normal.cross(&Vec3::x()).cross(&normal).normalize()];
        let origin = Vec3::new(100.0, 200.0, -50.0);
        let grid = |i: i32| along[0] * f64::from(i % 7) + along[1] * (1e-2 * f64::from(i / 7));
        let found = Moments::of(&origin, (0..42).map(|i| origin + normal * 3.0 + grid(i))).normal().unwrap();
        assert!((found - normal).norm() < 1e-9, "{found}");
        assert_eq!(Moments::of(&origin, (0..7).map(|i| origin + grid(i))).normal(), None);
        assert_eq!(Moments::of(&origin, std::iter::empty()).normal(), None);
    }
}
