//! Faces, counter-clockwise seen from outside: linear ones of 3 or 4 corners, and quadratic ones of 6 or 9 nodes, whose surface is
//! taken to be that of four linear pieces on their nodes.

use crate::solid::element::{hex27, tet10};
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

    /// The cross product of the derivatives of the place, where shape functions are.
    pub fn area_at(&self, shapes: &[f64; 4]) -> Vec3 {
        let [a, b, c, _] = &self.x;
        match self.count {
            3 => (b - a).cross(&(c - a)),
            _ => {
                let [_, by_s, by_t] = bilinear(&Vec2::new(shapes[1] + shapes[2], shapes[2] + shapes[3]));
                self.at(&by_s).cross(&self.at(&by_t))
            }
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

/// Nodes of a face, at most.
pub const MOST: usize = 9;

/// A face with all its nodes: corners, then of quadratic ones the middles of the edges from each corner to the next, and of nine the
/// middle of the face.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// 3, 4, 6 or 9.
    pub nodes: Vec<u32>,
    /// The linear facets of its surface, by the places of their corners in `nodes`; of a quadratic face those that count.
    pub pieces: Vec<Corners<usize>>,
}

impl Face {
    /// Of the nodes of a linear face.
    #[cfg(test)]
    pub fn linear(corners: &[u32]) -> Self {
        let places: Vec<usize> = (0..corners.len()).collect();
        Self { nodes: corners.to_vec(), pieces: vec![Corners::new(&places)] }
    }

    /// The piece of it with these nodes at its corners.
    pub fn piece(&self, corners: &[u32]) -> Corners<usize> {
        let places: Vec<usize> = corners.iter().filter_map(|n| self.nodes.iter().position(|m| m == n)).collect();
        Corners::new(&places)
    }

    /// Its corners.
    pub fn corners(&self) -> Corners<u32> {
        Corners::new(&self.nodes[..if matches!(self.nodes.len(), 3 | 6) { 3 } else { 4 }])
    }

    /// Places of the nodes in the middles of edges, and of the ends of these.
    pub fn middles(&self) -> impl Iterator<Item = (usize, [usize; 2])> + use<> {
        let corners = match self.nodes.len() {
            6 => 3,
            9 => 4,
            _ => 0,
        };
        (0..corners).map(move |k| (corners + k, [k, (k + 1) % corners]))
    }

    /// The mean of its nodes.
    pub fn centre(&self, place: impl Fn(u32) -> Vec3) -> Vec3 {
        self.nodes.iter().map(|&n| place(n)).sum::<Vec3>() / self.nodes.len() as f64
    }

    /// It has nodes in the middles of its edges.
    pub fn is_quadratic(&self) -> bool {
        self.nodes.len() > 4
    }

    /// Where a point is in the triangle of the first two axes, or in the unit square, if the shape functions of the corners of a piece
    /// are these there.
    pub fn local(&self, piece: &Corners<usize>, shapes: &[f64; 4]) -> Vec2 {
        piece.all().iter().zip(shapes).map(|(&k, shape)| self.parameters(k) * *shape).sum()
    }

    /// Where a node is there.
    pub fn parameters(&self, node: usize) -> Vec2 {
        Vec2::from(if matches!(self.nodes.len(), 3 | 6) { OF_SIX[node] } else { OF_NINE[node] })
    }

    /// The shape functions of all its nodes, and their derivatives.
    pub fn shapes(&self, at: &Vec2) -> [[f64; MOST]; 3] {
        match self.nodes.len() {
            3 => padded([[1.0 - at.x - at.y, at.x, at.y], [-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]),
            4 => padded(bilinear(at)),
            6 => triangle(at),
            _ => biquadratic(at),
        }
    }

    /// The place of a point, and its derivatives.
    pub fn at(&self, at: &Vec2, place: impl Fn(u32) -> Vec3) -> [Vec3; 3] {
        self.shapes(at).map(|shapes| self.nodes.iter().zip(shapes).map(|(&n, shape)| place(n) * shape).sum())
    }
}

fn padded<const N: usize>(of: [[f64; N]; 3]) -> [[f64; MOST]; 3] {
    of.map(|of| std::array::from_fn(|k| of.get(k).copied().unwrap_or(0.0)))
}

/// Where the nodes are in the triangle of the first two axes, and in the unit square.
const OF_SIX: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const OF_NINE: [[f64; 2]; 9] =
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.5]];

/// Those of the quadratic triangle, the first face of a quadratic tetrahedron, and their derivatives.
fn triangle(at: &Vec2) -> [[f64; MOST]; 3] {
    const NODES: [usize; 6] = [0, 1, 2, 4, 5, 6];
    let b = [1.0 - at.x - at.y, at.x, at.y, 0.0];
    let [by_s, by_t, _] = tet10::gradients(&b);
    padded([tet10::shape(&b), by_s, by_t].map(|of| NODES.map(|a| of[a])))
}

/// Those of nine nodes, products of the parabolas along both axes, and their derivatives.
fn biquadratic(at: &Vec2) -> [[f64; MOST]; 3] {
    // From -1 to 1 there.
    let along = |x: f64, node: f64| hex27::along(2.0 * node - 1.0, 2.0 * x - 1.0);
    let mut all = [[0.0; MOST]; 3];
    for (k, [s, t]) in OF_NINE.into_iter().enumerate() {
        let ([s, by_s], [t, by_t]) = (along(at.x, s), along(at.y, t));
        (all[0][k], all[1][k], all[2][k]) = (s * t, 2.0 * by_s * t, 2.0 * s * by_t);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At each node its function is 1 and all others are nothing; everywhere they are those of polynomials of their degree, with
    /// these derivatives.
    #[test]
    fn functions_of_faces_are_those_of_their_nodes() {
        for n in [3, 4, 6, 9] {
            let corners: Vec<usize> = (0..if n % 3 == 0 && n < 9 { 3 } else { 4 }).collect();
            let face = Face { nodes: (10..10 + n as u32).collect(), pieces: vec![Corners::new(&corners)] };
            let places: &[[f64; 2]] = if corners.len() == 3 { &OF_SIX } else { &OF_NINE };
            for (k, &place) in places[..n].iter().enumerate() {
                let [shapes, ..] = face.shapes(&Vec2::from(place));
                assert!((0..n).all(|l| shapes[l] == f64::from(l == k)), "{n}: {shapes:?}");
                if k < corners.len() {
                    let own = std::array::from_fn(|l| f64::from(l == k));
                    assert_eq!(face.local(&face.pieces[0], &own), Vec2::from(place));
                }
            }
            let powers = |[s, t]: [f64; 2]| if n > 4 { vec![1.0, s, t, s * s, s * t, t * t] } else { vec![1.0, s, t] };
            let at = [0.3, 0.45];
            let [shapes, by_s, by_t] = face.shapes(&Vec2::from(at));
            for (power, exact) in powers(at).into_iter().enumerate() {
                let sum: f64 = places.iter().zip(shapes).map(|(place, shape)| powers(*place)[power] * shape).sum();
                assert!((sum - exact).abs() < 1e-15, "{n}: {power}: {sum}, not {exact}");
            }
            let h = 1e-5;
            for (d, slopes) in [by_s, by_t].into_iter().enumerate() {
                let [ahead, behind] = [h, -h].map(|h| {
                    let mut at = Vec2::from(at);
                    at[d] += h;
                    face.shapes(&at)[0]
                });
                for k in 0..n {
                    assert!(((ahead[k] - behind[k]) / (2.0 * h) - slopes[k]).abs() < 1e-9, "{n}: {k}");
                }
            }
            for (middle, ends) in face.middles() {
                let mean = ends.map(|k| Vec2::from(places[k])).iter().sum::<Vec2>() / 2.0;
                assert_eq!(mean, Vec2::from(places[middle]));
            }
        }
    }

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
