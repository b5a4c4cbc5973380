//! Loads on the faces of solids: follower pressure, areas.
//!
//! Faces are numbered counter-clockwise seen from outside. With x = sum_a N_a x_a, the parameters s and t, and commas
//! for derivatives by them, n da = x,s x x,t ds dt points outwards, and
//!
//! ```text
//! f_a       = -p int N_a n da
//! df_a/dx_b = -p int N_a (N_b,t [x,s] - N_b,s [x,t]) ds dt,     [v] w = v x w
//! ```
//!
//! A positive pressure pushes into the body. (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element
//! Analysis.) The 2x2 Gauss rule of the quadrilateral is exact for forces and tangent, not for the area of a
//! warped face.
//!
//! On an axisymmetric body (see [`super::element::ring4`]) an upright quadrilateral between the z-planes, w apart, stands for the
//! ring that its meridian is turned to: the integrands are multiplied by 2 pi r / w, r = x = sum_a N_a x_a, and the tangent has
//! -p int N_a (2 pi / w) N_b n e_x da besides.

use super::element::GAUSS;
use crate::Vec3;
use std::f64::consts::TAU;

/// External nodal forces, node-major, and their derivative by the nodes' positions, `tangent[row][column]`, not
/// symmetric. Both enter an equilibrium residual R = internal - external with a minus.
#[derive(Clone, Debug)]
pub struct FaceLoad<const D: usize> {
    pub force: [f64; D],
    pub tangent: [[f64; D]; D],
}

/// An integration point of a face.
pub(super) struct FacePoint<const N: usize> {
    pub weight: f64,
    pub values: [f64; N],
    /// Derivatives by s and by t.
    pub gradients: [[f64; N]; 2],
}

const TRI3: [FacePoint<3>; 1] =
    [FacePoint { weight: 0.5, values: [1.0 / 3.0; 3], gradients: [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]] }];

/// The points 1/6, 1/6, 2/3 are exact for quadratic polynomials; forces of straight faces need no more, those of curved ones four
/// degrees: six points (Dunavant, IJNME 21, 1985).
pub(super) const TRI6: [FacePoint<6>; 6] = {
    const NEAR: [f64; 2] = [0.108_103_018_168_070_23, 0.091_576_213_509_770_74];
    const WEIGHTS: [f64; 2] = [0.223_381_589_678_011_47, 0.109_951_743_655_321_87];
    let [a, b] = [0.445_948_490_915_965, NEAR[1]];
    [
        tri6([NEAR[0], a, a], 0.5 * WEIGHTS[0]),
        tri6([a, NEAR[0], a], 0.5 * WEIGHTS[0]),
        tri6([a, a, NEAR[0]], 0.5 * WEIGHTS[0]),
        tri6([1.0 - 2.0 * b, b, b], 0.5 * WEIGHTS[1]),
        tri6([b, 1.0 - 2.0 * b, b], 0.5 * WEIGHTS[1]),
        tri6([b, b, 1.0 - 2.0 * b], 0.5 * WEIGHTS[1]),
    ]
};

/// At barycentric coordinates, of which s and t are the last two; corners, then the middles of 0-1, 1-2, 2-0.
pub(super) const fn tri6([r, s, t]: [f64; 3], weight: f64) -> FacePoint<6> {
    let (dr, ds, dt) = (4.0 * r - 1.0, 4.0 * s - 1.0, 4.0 * t - 1.0);
    FacePoint {
        weight,
        values: [r * (2.0 * r - 1.0), s * (2.0 * s - 1.0), t * (2.0 * t - 1.0), 4.0 * r * s, 4.0 * s * t, 4.0 * t * r],
        gradients: [[-dr, ds, 0.0, 4.0 * (r - s), 4.0 * t, -4.0 * t], [-dr, 0.0, dt, -4.0 * s, 4.0 * s, 4.0 * (r - t)]],
    }
}

const QUAD4: [FacePoint<4>; 4] =
    [quad4(-GAUSS, -GAUSS), quad4(GAUSS, -GAUSS), quad4(GAUSS, GAUSS), quad4(-GAUSS, GAUSS)];

const fn quad4(s: f64, t: f64) -> FacePoint<4> {
    let (s0, s1, t0, t1) = (0.5 * (1.0 - s), 0.5 * (1.0 + s), 0.5 * (1.0 - t), 0.5 * (1.0 + t));
    FacePoint {
        weight: 1.0,
        values: [s0 * t0, s1 * t0, s1 * t1, s0 * t1],
        gradients: [[-0.5 * t0, 0.5 * t0, 0.5 * t1, -0.5 * t1], [-0.5 * s0, -0.5 * s1, 0.5 * s1, 0.5 * s0]],
    }
}

/// Three points each way in the quarter of a face of nine nodes at its first.
const QUARTER: [FacePoint<9>; 9] = {
    let mut points = [const { quad9(0.0, 0.0, 0.0) }; 9];
    let mut q = 0;
    while q < 9 {
        // From -1 to 0.
        let (s, t) = (0.5 * (GAUSS_3[q % 3] - 1.0), 0.5 * (GAUSS_3[q / 3] - 1.0));
        points[q] = quad9(s, t, 0.25 * WEIGHTS_3[q % 3] * WEIGHTS_3[q / 3]);
        q += 1;
    }
    points
};

/// Corners, then the middles of 0-1, 1-2, 2-3, 3-0, and of all.
const fn quad9(s: f64, t: f64, weight: f64) -> FacePoint<9> {
    const AT: [[usize; 2]; 9] = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];
    const fn along(x: f64) -> [[f64; 2]; 3] {
        [[0.5 * x * (x - 1.0), x - 0.5], [1.0 - x * x, -2.0 * x], [0.5 * x * (x + 1.0), x + 0.5]]
    }
    let (mut values, mut by_s, mut by_t) = ([0.0; 9], [0.0; 9], [0.0; 9]);
    let mut a = 0;
    while a < 9 {
        let [[of_s, ds], [of_t, dt]] = [along(s)[AT[a][0]], along(t)[AT[a][1]]];
        values[a] = of_s * of_t;
        by_s[a] = ds * of_t;
        by_t[a] = of_s * dt;
        a += 1;
    }
    FacePoint { weight, values, gradients: [by_s, by_t] }
}

/// Three points between -1 and 1.
const GAUSS_3: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
const WEIGHTS_3: [f64; 3] = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];

/// Three points each way.
const QUAD8: [FacePoint<8>; 9] = {
    let mut points = [const { quad8(0.0, 0.0, 0.0) }; 9];
    let mut q = 0;
    while q < 9 {
        points[q] = quad8(GAUSS_3[q % 3], GAUSS_3[q / 3], WEIGHTS_3[q % 3] * WEIGHTS_3[q / 3]);
        q += 1;
    }
    points
};

/// Corners, then the middles of 0-1, 1-2, 2-3, 3-0.
const fn quad8(s: f64, t: f64, weight: f64) -> FacePoint<8> {
    const ENDS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let (s2, t2) = (1.0 - s * s, 1.0 - t * t);
    let (mut values, mut by_s, mut by_t) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    let mut a = 0;
    while a < 4 {
        let [x, y] = ENDS[a];
        let (u, v) = (1.0 + s * x, 1.0 + t * y);
        values[a] = 0.25 * u * v * (s * x + t * y - 1.0);
        by_s[a] = 0.25 * x * v * (2.0 * s * x + t * y);
        by_t[a] = 0.25 * y * u * (2.0 * t * y + s * x);
        a += 1;
    }
    let (low, high) = ([1.0 - s, 1.0 - t], [1.0 + s, 1.0 + t]);
    [values[4], by_s[4], by_t[4]] = [0.5 * s2 * low[1], -s * low[1], -0.5 * s2];
    [values[5], by_s[5], by_t[5]] = [0.5 * t2 * high[0], 0.5 * t2, -t * high[0]];
    [values[6], by_s[6], by_t[6]] = [0.5 * s2 * high[1], -s * high[1], 0.5 * s2];
    [values[7], by_s[7], by_t[7]] = [0.5 * t2 * low[0], -0.5 * t2, -t * low[0]];
    FacePoint { weight, values, gradients: [by_s, by_t] }
}

/// Pressure on a triangle with current nodes `x`.
pub fn tri3_pressure(x: &[[f64; 3]; 3], pressure: f64) -> FaceLoad<9> {
    follower_pressure(&TRI3, x, pressure, None)
}

/// Pressure on a quadratic triangle with current nodes `x`: corners, then the middles of 0-1, 1-2, 2-0.
pub fn tri6_pressure(x: &[[f64; 3]; 6], pressure: f64) -> FaceLoad<18> {
    follower_pressure(&TRI6, x, pressure, None)
}

/// Pressure on a quarter of a face of nine nodes, that at the first: corners, then the middles of 0-1, 1-2, 2-3, 3-0, and of all.
pub fn quarter_pressure(x: &[[f64; 3]; 9], pressure: f64) -> FaceLoad<27> {
    follower_pressure(&QUARTER, x, pressure, None)
}

/// Pressure on a quadrilateral with current nodes `x`.
pub fn quad4_pressure(x: &[[f64; 3]; 4], pressure: f64) -> FaceLoad<12> {
    follower_pressure(&QUAD4, x, pressure, None)
}

/// Pressure on the ring that a quadrilateral with current nodes `x` is turned to.
pub fn ring_pressure(x: &[[f64; 3]; 4], pressure: f64) -> FaceLoad<12> {
    follower_pressure(&QUAD4, x, pressure, Some(around(x)))
}

/// The areas int N_a da that belong to the nodes of a triangle; their sum is its area.
pub fn tri3_nodal_areas(x: &[[f64; 3]; 3]) -> [f64; 3] {
    nodal_areas(&TRI3, x, None)
}

/// The areas int N_a da that belong to the nodes of a quadratic triangle, none to the corners of a straight one; their sum is its
/// area.
pub fn tri6_nodal_areas(x: &[[f64; 3]; 6]) -> [f64; 6] {
    nodal_areas(&TRI6, x, None)
}

/// The areas int N_a da, of a quarter of a face of nine nodes, that belong to its nodes, below zero at some; their sum is that of the
/// quarter, and those of all quarters are 1/36, 1/9 and 4/9 of the face at corners, edges and in the middle of a straight one.
pub fn quarter_nodal_areas(x: &[[f64; 3]; 9]) -> [f64; 9] {
    nodal_areas(&QUARTER, x, None)
}

/// The areas int N_a da that belong to the nodes of a quadrilateral of eight nodes, below zero at the corners of a straight one; their
/// sum is its area.
pub fn quad8_nodal_areas(x: &[[f64; 3]; 8]) -> [f64; 8] {
    nodal_areas(&QUAD8, x, None)
}

/// The areas int N_a da that belong to the nodes of a quadrilateral; their sum is its area.
pub fn quad4_nodal_areas(x: &[[f64; 3]; 4]) -> [f64; 4] {
    nodal_areas(&QUAD4, x, None)
}

/// The areas int N_a da that belong to the nodes of a quadrilateral, of the ring that it is turned to; of a face within one z-plane
/// they are the volumes that it sweeps.
pub fn ring_nodal_areas(x: &[[f64; 3]; 4]) -> [f64; 4] {
    nodal_areas(&QUAD4, x, Some(around(x)))
}

/// 2 pi over the width of a face along z, that of one without it being 1.
fn around(x: &[[f64; 3]]) -> f64 {
    const FLAT: f64 = 1e-9;
    let extent = |d: usize| {
        let ends = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x[d]), high.max(x[d])));
        ends.1 - ends.0
    };
    let width = extent(2);
    if width > FLAT * (extent(0) + extent(1)) { TAU / width } else { TAU }
}

impl<const N: usize> FacePoint<N> {
    /// x,s and x,t.
    fn tangents(&self, x: &[[f64; 3]; N]) -> [Vec3; 2] {
        self.gradients.map(|by| x.iter().zip(by).map(|(x, g)| g * Vec3::from(*x)).sum())
    }

    /// What an integrand is multiplied by on a ring, `around` being that of the axis.
    fn radius(&self, x: &[[f64; 3]; N], around: Option<f64>) -> f64 {
        around.map_or(1.0, |around| around * x.iter().zip(self.values).map(|(x, value)| value * x[0]).sum::<f64>())
    }
}

fn follower_pressure<const N: usize, const Q: usize, const D: usize>(
    rule: &[FacePoint<N>; Q],
    x: &[[f64; 3]; N],
    pressure: f64,
    around: Option<f64>,
) -> FaceLoad<D> {
    const { assert!(D == 3 * N) };
    let mut load = FaceLoad { force: [0.0; D], tangent: [[0.0; D]; D] };
    for point in rule {
        let [by_s, by_t] = point.tangents(x);
        let area = by_s.cross(&by_t);
        let radius = point.radius(x, around);
        for a in 0..N {
            let share = -pressure * point.weight * point.values[a];
            let factor = share * radius;
            (0..3).for_each(|i| load.force[3 * a + i] += factor * area[i]);
            for b in 0..N {
                let v = factor * (point.gradients[1][b] * by_s - point.gradients[0][b] * by_t);
                let skew = v.cross_matrix();
                for (i, k) in (0..9).map(|n| (n / 3, n % 3)) {
                    load.tangent[3 * a + i][3 * b + k] += skew[(i, k)];
                }
                let wider = share * around.unwrap_or(0.0) * point.values[b];
                (0..3).for_each(|i| load.tangent[3 * a + i][3 * b] += wider * area[i]);
            }
        }
    }
    load
}

fn nodal_areas<const N: usize, const Q: usize>(
    rule: &[FacePoint<N>; Q],
    x: &[[f64; 3]; N],
    around: Option<f64>,
) -> [f64; N] {
    let mut areas = [0.0; N];
    for point in rule {
        let [by_s, by_t] = point.tangents(x);
        let area = point.weight * by_s.cross(&by_t).norm() * point.radius(x, around);
        (0..N).for_each(|a| areas[a] += area * point.values[a]);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Random, add, derivative, relative_error, rotation};
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 2.0], [3.0, 0.0, 2.0], [3.0, 1.0, 2.0], [0.0, 1.0, 2.0]];

    /// A triangle on [`SQUARE`] with the middles of its edges.
    const SIX: [[f64; 3]; 6] = [SQUARE[0], SQUARE[1], SQUARE[3], [1.5, 0.0, 2.0], [1.5, 0.5, 2.0], [0.0, 0.5, 2.0]];

    /// The tangent against differences of the force.
    fn check_tangent<const N: usize, const D: usize>(x: [[f64; 3]; N], load: impl Fn(&[[f64; 3]; N]) -> FaceLoad<D>) {
        let exact = load(&x).tangent;
        let differences: [[f64; D]; D] = std::array::from_fn(|column| {
            derivative(1e-2, |t| {
                let mut moved = x;
                moved[column / 3][column % 3] += t;
                load(&moved).force
            })
        });
        let transposed: [[f64; D]; D] = std::array::from_fn(|i| std::array::from_fn(|j| differences[j][i]));
        let error = relative_error(exact.as_flattened(), transposed.as_flattened());
        assert!(error < 2e-13, "{error}");
    }

    #[test]
    fn tangents_are_exact() {
        let mut random = Random::new(11);
        for _ in 0..10 {
            let triangle = add(&[SQUARE[0], SQUARE[1], SQUARE[3]], &random.points(0.4));
            check_tangent(triangle, |x| tri3_pressure(x, 1.7));
            check_tangent(add(&SQUARE, &random.points(0.4)), |x| quad4_pressure(x, -0.8));
            check_tangent(add(&SIX, &random.points(0.3)), |x| tri6_pressure(x, 1.3));
        }
        // Nodes of an upright face move in pairs.
        let upright =
            |[x, y]: [[f64; 2]; 2]| [[x[0], x[1], 2.0], [y[0], y[1], 2.0], [y[0], y[1], 2.7], [x[0], x[1], 2.7]];
        let flat = |t: [f64; 4]| upright([[1.0 + t[0], 0.3 + t[1]], [2.5 + t[2], 1.1 + t[3]]]);
        let exact = ring_pressure(&flat([0.0; 4]), 1.7).tangent;
        for column in 0..4 {
            let (node, d) = (column / 2, column % 2);
            let both: [f64; 12] =
                std::array::from_fn(|row| [node, 3 - node].iter().map(|n| exact[row][3 * n + d]).sum());
            let differences = derivative(1e-2, |t| {
                let mut moved = [0.0; 4];
                moved[column] = t;
                ring_pressure(&flat(moved), 1.7).force
            });
            assert!(relative_error(&both, &differences) < 2e-13);
        }
    }

    /// A cone between the radii 1 and 3, of height 2.
    #[test]
    fn a_ring_has_the_area_of_its_cone() {
        let face = [[1.0, 0.0, 0.0], [3.0, 2.0, 0.0], [3.0, 2.0, 0.4], [1.0, 0.0, 0.4]];
        let area: f64 = ring_nodal_areas(&face).iter().sum();
        assert!((area - TAU * 2.0 * 8f64.sqrt()).abs() < 1e-13 * area, "{area}");
        // Outwards is down and out: the push along y is the pressure on the ring seen from below.
        let pushed: f64 = ring_pressure(&face, 0.5).force.chunks(3).map(|force| force[1]).sum();
        assert!((pushed.abs() - 0.5 * TAU / 2.0 * (9.0 - 1.0)).abs() < 1e-12, "{pushed}");
    }

    #[test]
    fn pushes_into_the_body_with_its_area() {
        let force = quad4_pressure(&SQUARE, 2.0).force;
        let triangle = tri3_pressure(&[SQUARE[0], SQUARE[1], SQUARE[3]], 2.0).force;
        // The faces look along +z: outwards is up, the push is down.
        for a in 0..4 {
            (0..3).for_each(|i| assert!((force[3 * a + i] - [0.0, 0.0, -1.5][i]).abs() < 1e-15));
        }
        for a in 0..3 {
            (0..3).for_each(|i| assert!((triangle[3 * a + i] - [0.0, 0.0, -1.0][i]).abs() < 1e-15));
        }
    }

    #[test]
    fn a_closed_surface_feels_no_net_force_or_moment() {
        const FACES: [[usize; 4]; 6] =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let cube: [[f64; 3]; 8] = std::array::from_fn(|n| {
            let corner = [[0, 0], [1, 0], [1, 1], [0, 1]][n % 4];
            [corner[0] as f64, corner[1] as f64, (n / 4) as f64]
        });
        let x = add(&cube, &Random::new(12).points(0.2));
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for face in FACES {
            let nodes = face.map(|n| x[n]);
            let load = quad4_pressure(&nodes, 3.0).force;
            for a in 0..4 {
                let f = Vec3::from_column_slice(&load[3 * a..3 * a + 3]);
                force += f;
                moment += Vec3::from(nodes[a]).cross(&f);
            }
        }
        assert!(force.norm() < 1e-14 && moment.norm() < 1e-14);
    }

    #[test]
    fn nodal_areas_sum_to_the_area() {
        let mut random = Random::new(13);
        assert!((quad4_nodal_areas(&SQUARE).iter().sum::<f64>() - 3.0).abs() < 1e-15);
        assert!(quad4_nodal_areas(&SQUARE).iter().all(|a| (a - 0.75).abs() < 1e-15));
        // A plane trapezoid, turned: area 1/2 (3 + 1) 2; int N_a da in closed form, parallel sides along x.
        let r = rotation(random.vector(2.0));
        let trapezoid = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.5, 2.0, 0.0], [0.5, 2.0, 0.0]];
        let turned = trapezoid.map(|x| (r * Vec3::from(x)).into());
        let areas = quad4_nodal_areas(&turned);
        let exact = [7.0 / 6.0, 7.0 / 6.0, 5.0 / 6.0, 5.0 / 6.0];
        (0..4).for_each(|a| assert!((areas[a] - exact[a]).abs() < 1e-14));
        assert!((quad4_nodal_areas(&turned).iter().sum::<f64>() - 4.0).abs() < 1e-14);
        let triangle = [turned[0], turned[1], turned[3]];
        assert!((tri3_nodal_areas(&triangle).iter().sum::<f64>() - 3.0).abs() < 1e-14);
        assert!(tri3_nodal_areas(&triangle).iter().all(|a| (a - 1.0).abs() < 1e-14));
        // A straight quadratic triangle bears uniform pressure on the middles of its edges.
        for (area, exact) in tri6_nodal_areas(&SIX).iter().zip([0.0, 0.0, 0.0, 0.5, 0.5, 0.5]) {
            assert!((area - exact).abs() < 1e-15, "{area} is not {exact}");
        }
        // One of eight nodes bears it by -1/12 of its area at the corners, and 1/3 in the middles.
        let middle = |k: usize| [0, 1, 2].map(|i| 0.5 * (SQUARE[k][i] + SQUARE[(k + 1) % 4][i]));
        let eight = std::array::from_fn(|a| if a < 4 { SQUARE[a] } else { middle(a - 4) });
        let shares = [[-0.25; 4], [1.0; 4]];
        for (area, exact) in quad8_nodal_areas(&eight).iter().zip(shares.as_flattened()) {
            assert!((area - exact).abs() < 1e-14, "{area} is not {exact}");
        }
        // A curved one has the sum of the areas of a fine grid of its shape.
        let mut bent = eight;
        bent[4][2] += 0.2;
        bent[6][2] += 0.2;
        let z = |s: f64| 0.2 * (1.0 - s * s);
        let at = |k: i32| f64::from(k) / 500.0;
        let length: f64 = (-500..500).map(|k| (1.5 * (at(k + 1) - at(k))).hypot(z(at(k + 1)) - z(at(k)))).sum();
        assert!((quad8_nodal_areas(&bent).iter().sum::<f64>() - length).abs() < 1e-4);
    }
}
