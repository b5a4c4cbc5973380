//! Faces of 3 or 4 corners, counter-clockwise seen from outside.

use crate::{Mat2, Vec2, Vec3};

/// Corners, of which the first 3 or 4 count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners<V> {
    pub count: usize,
    pub x: [V; 4],
}

impl<V: Copy> Corners<V> {
    /// Of the corners that count.
    pub fn new(x: &[V]) -> Self {
        let last = x.len() - 1;
        Self { count: x.len(), x: std::array::from_fn(|k| x[k.min(last)]) }
    }

    /// Those that count.
    pub fn all(&self) -> &[V] {
        &self.x[..self.count]
    }

    /// The same with other values.
    pub fn map<W>(&self, of: impl FnMut(V) -> W) -> Corners<W> {
        Corners { count: self.count, x: self.x.map(of) }
    }
}

impl Corners<Vec3> {
    /// Half the cross product of the diagonals of a quadrilateral, of two edges of a triangle: outwards, as long as its area
    /// in its mean plane.
    pub fn area_vector(&self) -> Vec3 {
        let [a, b, c, d] = &self.x;
        match self.count {
            3 => 0.5 * (b - a).cross(&(c - a)),
            _ => 0.5 * (c - a).cross(&(d - b)),
        }
    }

    /// Where shape functions are.
    pub fn at(&self, shapes: &[f64; 4]) -> Vec3 {
        self.all().iter().zip(shapes).map(|(x, w)| x * *w).sum()
    }

    /// Lower and upper corner of the box around it, with `by` more on all sides.
    pub fn around(&self, by: f64) -> (Vec3, Vec3) {
        let first = (self.x[0], self.x[0]);
        let (low, high) = self.all().iter().fold(first, |(low, high), x| (low.inf(x), high.sup(x)));
        (low.add_scalar(-by), high.add_scalar(by))
    }

    /// The edges, from corner to corner.
    pub fn edges(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.count).map(|k| self.x[(k + 1) % self.count] - self.x[k])
    }

    /// The longest edge.
    pub fn longest(&self) -> f64 {
        self.edges().map(|edge| edge.norm()).fold(0.0, f64::max)
    }
}

impl Corners<Vec2> {
    /// Whether the shape functions are polynomials of the place: triangles, parallelograms. Well above rounding, so that it does
    /// not decide as faces deform.
    pub fn is_affine(&self) -> bool {
        const ROUNDING: f64 = 1e-9;
        let [a, b, c, d] = &self.x;
        self.count == 3 || (a - b + c - d).norm() < ROUNDING * ((c - a).norm() + (d - b).norm())
    }

    /// The shape functions at a point; beyond the corners as well, where that is not far. `None` where there are none.
    pub fn shapes(&self, x: &Vec2) -> Option<[f64; 4]> {
        let [a, b, c, d] = &self.x;
        if self.count == 3 {
            let xi = Mat2::from_columns(&[b - a, c - a]).lu().solve(&(x - a))?;
            return Some([1.0 - xi.x - xi.y, xi.x, xi.y, 0.0]);
        }
        const ITERATIONS: usize = 30;
        let mut xi = Vec2::new(0.5, 0.5);
        let size = (c - a).norm() + (d - b).norm();
        for _ in 0..ITERATIONS {
            let [n, by_s, by_t] = bilinear(&xi);
            let sum = |w: &[f64; 4]| self.x.iter().zip(w).map(|(x, w)| x * *w).sum::<Vec2>();
            let off = sum(&n) - x;
            if off.norm() <= 4.0 * f64::EPSILON * size {
                break;
            }
            xi -= Mat2::from_columns(&[sum(&by_s), sum(&by_t)]).lu().solve(&off)?;
        }
        xi.iter().all(|v| v.is_finite()).then(|| bilinear(&xi)[0])
    }
}

/// Bilinear shape functions on the unit square, and their derivatives.
pub fn bilinear(xi: &Vec2) -> [[f64; 4]; 3] {
    let ([s, t], [r, q]) = ([xi.x, xi.y], [1.0 - xi.x, 1.0 - xi.y]);
    [[r * q, s * q, s * t, r * t], [-q, q, t, -t], [-r, -s, s, r]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_give_the_place_back() {
        let quad = Corners::new(&[[0.0, 0.0], [2.0, 0.2], [1.8, 1.5], [-0.3, 1.0]].map(Vec2::from));
        let triangle = Corners::new(&quad.x[..3]);
        assert!(triangle.is_affine() && !quad.is_affine());
        for face in [quad, triangle] {
            for x in [[0.5, 0.4], [1.7, 0.9], [0.0, 0.0], [2.1, 0.1]].map(Vec2::from) {
                let shapes = face.shapes(&x).unwrap();
                let place = face.x.iter().zip(shapes).map(|(x, w)| x * w).sum::<Vec2>();
                assert!((place - x).norm() < 1e-14 && (shapes.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{x:?}");
            }
        }
        assert_eq!(Corners::new(&[Vec2::zeros(); 3]).shapes(&Vec2::x()), None);
    }
}
