//! The closest point of one piece of a surface to a point x.
//!
//! f = |r|^2/2 with r = x - P is minimised over the polygon of the parameters. Each step minimises the quadratic model
//! with gradient -tau_a.r and Hessian H = a - r.P,ab over the whole polygon, which takes one edge after the other in
//! two dimensions and so finds edges and corners by itself; H = a, the metric, where H is not safely positive
//! (Gauss-Newton). Steps are shortened until f falls (Armijo). At an interior minimum r = g n, and with b_ab = n.P,ab
//! and A = a - g b
//!
//! ```text
//!     dn/dx = -T a^-1 b A^-1 T^T,     T = [tau_1 tau_2]
//! ```
//!
//! On an edge curve C, n = r/|r| and dn/dx = (I - nn - C'C'/(C'.C' - r.C''))/|r|; at a corner dn/dx = (I - nn)/|r|.

use super::parametric::Local;
use super::piece::Polygon;
use crate::{Mat3, Vec3};
use nalgebra::{Matrix2, Matrix3x2};

/// The closest point of a surface to a point x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Projection {
    /// Distance, positive outside the tool.
    pub gap: f64,
    pub point: Vec3,
    /// Unit vector out of the tool; x = point + gap normal.
    pub normal: Vec3,
    /// dn/dx, symmetric.
    pub normal_gradient: Mat3,
    /// Id of the piece; 0 for analytic shapes.
    pub patch: u32,
    /// Parameters of the piece, perhaps a little beyond its domain; 0 for analytic shapes.
    pub xi: [f64; 2],
}

impl Projection {
    /// x.
    pub fn slave(&self) -> Vec3 {
        self.point + self.normal * self.gap
    }
}

crate::words!(Projection { gap, point, normal, normal_gradient, patch, xi });

/// Where the distance to one piece is least.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    pub xi: [f64; 2],
    /// Bit k is set when the foot lies on the limit of the domain beyond edge k.
    pub limits: u32,
    pub local: Local,
    pub distance: f64,
}

impl Foot {
    /// Whether it lies on the limit of the domain beyond an edge.
    pub fn is_on(&self, edge: usize) -> bool {
        self.limits >> edge & 1 == 1
    }
}

const ITERATIONS: usize = 60;
/// A Newton step this small leaves an error of its square.
const LAST_NEWTON_STEP: f64 = 1e-8;
const LAST_STEP: f64 = 1e-14;
/// Samples along each parameter that show whether a minimum was missed.
const GRID: usize = 5;

/// The local minimum of the distance from `x` that descent reaches from `start`, over the domain of `piece` extended
/// beyond each edge by `extension`. `start` must lie in it.
pub fn descend<P: Polygon + ?Sized>(piece: &P, x: &Vec3, extension: &[f64; 4], start: [f64; 2]) -> Foot {
    let corners = piece.corners(extension);
    let (mut xi, mut local) = (start, piece.local(start));
    let mut limits = 0;
    for _ in 0..ITERATIONS {
        let r = x - local.point;
        let gradient = local.tangents.map(|t| -t.dot(&r));
        let (hessian, newton) = hessian(&local, &r, piece.vanishing());
        let target;
        (target, limits) = model_minimum(piece, extension, &corners, xi, gradient, hessian);
        let full = [target[0] - xi[0], target[1] - xi[1]];
        let size = piece.step_size(&local, full);
        let slope = gradient[0] * full[0] + gradient[1] * full[1];
        let f = 0.5 * r.norm_squared();
        let rounding = 16.0 * f64::EPSILON * r.amax() * (r.amax() + x.amax());
        let mut scale = 1.0;
        loop {
            let next = if scale == 1.0 { target } else { [xi[0] + scale * full[0], xi[1] + scale * full[1]] };
            let there = piece.local(next);
            let fall = 0.5 * (x - there.point).norm_squared() - f;
            if fall <= 1e-4 * scale * slope + rounding || scale < 1e-9 {
                (xi, local) = (next, there);
                break;
            }
            scale *= 0.5;
        }
        if size < LAST_STEP || scale == 1.0 && newton && size < LAST_NEWTON_STEP || scale < 1e-9 {
            break;
        }
    }
    Foot { xi, limits, local, distance: (x - local.point).norm() }
}

/// The Hessian [H11, H12, H22] of f, and true, or the metric in its place, and false.
fn hessian(local: &Local, r: &Vec3, vanishing: [f64; 2]) -> ([f64; 3], bool) {
    let [t, u] = &local.tangents;
    let a = [t.norm_squared(), t.dot(u), u.norm_squared()];
    let h: [f64; 3] = std::array::from_fn(|k| a[k] - r.dot(&local.second[k]));
    // Compared with the metric direction by direction, so that long and narrow patches count as good ones.
    let (h11, h22, h12) = (h[0] / a[0], h[2] / a[2], h[1] * h[1] / (a[0] * a[2]));
    let lowest = 0.5 * (h11 + h22) - (0.25 * (h11 - h22).powi(2) + h12).sqrt();
    if lowest > 1e-6 {
        (h, true)
    } else {
        ([a[0] * (1.0 + 1e-12) + vanishing[0], a[1], a[2] * (1.0 + 1e-12) + vanishing[1]], false)
    }
}

/// Minimum over the polygon of the quadratic function with this gradient and Hessian at `xi`, and the edges it lies on.
fn model_minimum<P: Polygon + ?Sized>(
    piece: &P,
    extension: &[f64; 4],
    corners: &[[f64; 2]; 4],
    xi: [f64; 2],
    g: [f64; 2],
    h: [f64; 3],
) -> ([f64; 2], u32) {
    let det = h[0] * h[2] - h[1] * h[1];
    let free = [xi[0] - (h[2] * g[0] - h[1] * g[1]) / det, xi[1] - (h[0] * g[1] - h[1] * g[0]) / det];
    let sides = piece.sides(free);
    let count = piece.count();
    let times = |v: [f64; 2]| [h[0] * v[0] + h[1] * v[1], h[1] * v[0] + h[2] * v[1]];
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let (mut best, mut at, mut limits) = (f64::INFINITY, free, 0);
    // When the free minimum is outside, the least value is on an edge that it is beyond of.
    for k in (0..count).filter(|k| sides[*k] < -extension[*k]) {
        let (p, q) = (corners[k], corners[(k + 1) % count]);
        let along = [q[0] - p[0], q[1] - p[1]];
        let from = [p[0] - xi[0], p[1] - xi[1]];
        let slope = times(from);
        let t = -dot(along, [g[0] + slope[0], g[1] + slope[1]]) / dot(along, times(along));
        let t = t.clamp(0.0, 1.0);
        let point = if t == 1.0 { q } else { [p[0] + t * along[0], p[1] + t * along[1]] };
        let step = [point[0] - xi[0], point[1] - xi[1]];
        let value = dot(g, step) + 0.5 * dot(step, times(step));
        if value < best {
            let before = if t == 0.0 { 1 << ((k + count - 1) % count) } else { 0 };
            let after = if t == 1.0 { 1 << ((k + 1) % count) } else { 0 };
            (best, at, limits) = (value, point, 1 << k | before | after);
        }
    }
    (at, limits)
}

/// The five starts for points from which the distance may have several minima.
pub fn starts<P: Polygon + ?Sized>(piece: &P) -> [[f64; 2]; 5] {
    let center = piece.center();
    let corners = piece.corners(&[0.0; 4]);
    std::array::from_fn(|k| match k {
        0 => center,
        _ => std::array::from_fn(|a| center[a] + 0.7 * (corners[k - 1][a] - center[a])),
    })
}

/// The point of `piece`, without extension, next to `x`: the only minimum of the distance, else the least of those that
/// descent reaches from `start`, from samples all over the piece that are lower than those around them, and from any place of
/// its edges that is closer than they are. Of a piece that is farther than `most` any minimum.
pub fn closest_foot<P: Polygon + ?Sized>(
    piece: &P,
    extent: &Extent,
    x: &Vec3,
    start: Option<[f64; 2]>,
    most: f64,
) -> Foot {
    let first = descend(piece, x, &[0.0; 4], start.map_or(piece.center(), |xi| piece.clamp(xi)));
    if extent.has_one_minimum(piece, x) || is_beyond(piece, x, &first, most) {
        return first;
    }
    let closer = |a: Foot, b: Foot| if b.distance < a.distance { b } else { a };
    let corners = piece.corners(&[0.0; 4]);
    let grid: [[f64; 2]; GRID * GRID] =
        std::array::from_fn(|k| between(&corners, [k % GRID, k / GRID].map(|k| k as f64 / (GRID - 1) as f64)));
    let away = grid.map(|xi| (x - piece.point(xi)).norm());
    let lowest = (0..GRID * GRID).filter(|k| is_lowest(&away, *k));
    let mut best = lowest.map(|k| descend(piece, x, &[0.0; 4], grid[k])).fold(first, closer);
    let mut look = |xi: [f64; 2]| {
        if (x - piece.point(xi)).norm() < best.distance * (1.0 - 1e-12) {
            best = closer(best, descend(piece, x, &[0.0; 4], xi));
        }
    };
    for edge in 0..piece.count() {
        let (p, q) = (corners[edge], corners[(edge + 1) % piece.count()]);
        piece.along_edge(edge, x, &mut |t| look(std::array::from_fn(|a| p[a] + t * (q[a] - p[a]))));
    }
    best
}

/// Whether a sample is lower than those around it; of equal ones the first.
fn is_lowest(samples: &[f64; GRID * GRID], k: usize) -> bool {
    let [column, row] = [k % GRID, k / GRID];
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(GRID);
    let mut beside = around(row).flat_map(|row| around(column).map(move |column| GRID * row + column));
    beside.all(|n| (samples[k], k) <= (samples[n], n))
}

/// Whether the plane through a minimum of the distance, across the line to it, shows that all of the piece is farther than
/// `most`, or than this minimum.
fn is_beyond<P: Polygon + ?Sized>(piece: &P, x: &Vec3, foot: &Foot, most: f64) -> bool {
    let Some(back) = (x - foot.local.point).try_normalize(0.0) else { return true };
    let rounding = 16.0 * f64::EPSILON * (x.amax() + foot.distance);
    x.dot(&back) - piece.farthest_along(&back) > most.min(foot.distance * (1.0 - 1e-12)) + rounding
}

/// The parameters at a place of the unit square mapped to the polygon with these corners.
fn between(corners: &[[f64; 2]; 4], [s, t]: [f64; 2]) -> [f64; 2] {
    let mix = |a: usize, b: usize, c: usize| corners[a][c] * (1.0 - s) + corners[b][c] * s;
    std::array::from_fn(|c| mix(0, 1, c) * (1.0 - t) + mix(3, 2, c) * t)
}

/// Parameters and gap of the foot of a perpendicular to `piece`, extended beyond each edge: of the minima of the distance
/// that are on no limit, the least.
pub fn perpendicular<P: Polygon + ?Sized>(
    piece: &P,
    extent: &Extent,
    x: &Vec3,
    extension: &[f64; 4],
) -> Option<([f64; 2], f64)> {
    let starts = starts(piece);
    let starts = if extent.has_one_minimum(piece, x) { &starts[..1] } else { &starts };
    let feet = starts.iter().map(|start| descend(piece, x, extension, *start)).filter(|foot| foot.limits == 0);
    let foot = feet.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
    Some((foot.xi, (x - foot.local.point).dot(&foot.local.area_vector().normalize())))
}

/// A ball and a slab around a piece, how far its normals turn, and bounds that tell from where the distance to it has one
/// minimum only.
///
/// With y = x - center, H = G - y.P,ab where G = a + (P - center).P,ab does not depend on x. P,ab lies between its
/// values at the corners, and G, which varies little, is sampled with a margin.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    pub center: Vec3,
    pub radius: f64,
    /// Least and greatest G11, G12 and G22.
    low: [f64; 3],
    high: [f64; 3],
    /// Unit normal in the middle, and between what coordinates along it the piece lies.
    axis: Vec3,
    along: [f64; 2],
    /// Cosine and sine of the greatest angle of a normal to it.
    turn: [f64; 2],
}

impl Extent {
    /// Bounds of `piece`.
    pub fn new<P: Polygon + ?Sized>(piece: &P) -> Self {
        let corners = piece.corners(&[0.0; 4]);
        let (center, radius) = Self::ball(piece, &piece.bounds());
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut areas = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
        let (n, last) = (P::SAMPLES, (P::SAMPLES - 1) as f64);
        for k in 0..n * n {
            let local = piece.local(between(&corners, [(k % n) as f64 / last, (k / n) as f64 / last]));
            let [u, v] = &local.tangents;
            let metric = [u.norm_squared(), u.dot(v), v.norm_squared()];
            for k in 0..3 {
                let g = metric[k] + (local.point - center).dot(&local.second[k]);
                low[k] = low[k].min(g);
                high[k] = high[k].max(g);
            }
            let area = local.area_vector();
            areas = [areas[0].inf(&area), areas[1].sup(&area)];
        }
        let margin: [f64; 3] = std::array::from_fn(|k| 0.25 * (high[k] - low[k]));
        let (low, high) = (std::array::from_fn(|k| low[k] - margin[k]), std::array::from_fn(|k| high[k] + margin[k]));
        let around = (areas[1] - areas[0]) * 0.25;
        let middle = piece.local(piece.center()).area_vector();
        let axis = middle.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        let sine = f64::min(((areas[1] - middle).sup(&(middle - areas[0])) + around).norm() / middle.norm(), 1.0);
        let turn = [(1.0 - sine * sine).sqrt(), sine];
        Self {
            center,
            radius,
            low,
            high,
            axis,
            along: [-piece.farthest_along(&-axis), piece.farthest_along(&axis)],
            turn,
        }
    }

    /// Center and radius of the ball around a piece with this box.
    pub fn ball<P: Polygon + ?Sized>(piece: &P, (low, high): &(Vec3, Vec3)) -> (Vec3, f64) {
        let center = piece.point(piece.center());
        (center, (center - low).sup(&(high - center)).norm())
    }

    /// Whether all of the piece is certainly farther from `x` than `most`.
    pub fn is_beyond(&self, x: &Vec3, most: f64) -> bool {
        let height = x.dot(&self.axis);
        let most = most + 16.0 * f64::EPSILON * (x.amax() + self.radius);
        height - self.along[1] > most || self.along[0] - height > most
    }

    /// Whether `x` is certainly farther than `deep` below all points of the piece, along their normals.
    pub fn is_far_above(&self, x: &Vec3, deep: f64) -> bool {
        let height = x.dot(&self.axis) - self.along[0];
        let aside = (x - self.center).cross(&self.axis).norm() + self.radius;
        // With n at an angle t to the axis, (x - P).n is at most cos(t) height + sin(t) aside.
        height < 0.0 && self.turn[0] * height + self.turn[1] * aside < -deep
    }

    /// Whether some normal of the piece may be so far from a unit direction that the cosine between them is less than `cosine`.
    pub fn may_face(&self, direction: &Vec3, cosine: f64) -> bool {
        let along = self.axis.dot(direction);
        let across = (1.0 - along * along).max(0.0).sqrt();
        let [cos, sin] = self.turn;
        // The angle to the axis and the greatest to that of a normal: their sum is past half a turn, or its cosine less.
        across * cos + along * sin < 0.0 || along * cos - across * sin < cosine
    }

    /// True when f is convex for this `x` all over `piece`, so that its distance has one minimum only.
    pub fn has_one_minimum<P: Polygon + ?Sized>(&self, piece: &P, x: &Vec3) -> bool {
        let y = x - self.center;
        let [s11, s12, spread, s22] = piece.bend(&y);
        let (h11, h22) = (self.low[0] - s11, self.low[2] - s22);
        let h12 = (self.high[1] - s12 + spread).abs().max((self.low[1] - s12 - spread).abs());
        h11 > 0.0 && h22 > 0.0 && h11 * h22 > h12 * h12
    }
}

/// Normal, gap and gradient at an interior foot.
pub fn on_surface(x: &Vec3, local: &Local) -> (f64, Vec3, Mat3) {
    let normal = local.area_vector().normalize();
    let gap = (x - local.point).dot(&normal);
    let [t, u] = &local.tangents;
    let metric = Matrix2::new(t.norm_squared(), t.dot(u), t.dot(u), u.norm_squared());
    let [b11, b12, b22] = local.second.map(|s| s.dot(&normal));
    let curvature = Matrix2::new(b11, b12, b12, b22);
    // Singular at a focal point, where all normals are equally right.
    let gradient = match (metric.try_inverse(), (metric - curvature * gap).try_inverse()) {
        (Some(a), Some(b)) => {
            let frame = Matrix3x2::from_columns(&[*t, *u]);
            let gradient = -frame * (a * curvature * b) * frame.transpose();
            (gradient + gradient.transpose()) * 0.5
        }
        _ => Mat3::zeros(),
    };
    (gap, normal, gradient)
}

/// Normal, gap and gradient at a foot on an edge or corner; `inside` when x is inside the tool. Needs a distance that
/// is not 0.
pub fn on_edge<P: Polygon + ?Sized>(x: &Vec3, piece: &P, foot: &Foot, inside: bool) -> (f64, Vec3, Mat3) {
    let sign = if inside { -1.0 } else { 1.0 };
    let r = x - foot.local.point;
    let direction = r / foot.distance;
    let mut tangential = Mat3::identity() - direction * direction.transpose();
    if foot.limits.count_ones() == 1 {
        let corners = piece.corners(&[0.0; 4]);
        let k = foot.limits.trailing_zeros() as usize;
        let (p, q) = (corners[k], corners[(k + 1) % piece.count()]);
        let [e, z] = [q[0] - p[0], q[1] - p[1]];
        let along = foot.local.tangents[0] * e + foot.local.tangents[1] * z;
        let bend =
            foot.local.second[0] * (e * e) + foot.local.second[1] * (2.0 * e * z) + foot.local.second[2] * (z * z);
        let stiffness = along.norm_squared() - r.dot(&bend);
        if stiffness > 1e-12 * along.norm_squared() {
            tangential -= along * along.transpose() / stiffness;
        }
    }
    (sign * foot.distance, direction * sign, tangential * (sign / foot.distance))
}

/// Normal of the piece at a foot times the angle that it fills around the foot.
pub fn angle_normal<P: Polygon + ?Sized>(piece: &P, foot: &Foot) -> Vec3 {
    let normal = foot.local.area_vector().normalize();
    let angle = match foot.limits.count_ones() {
        0 => 2.0 * std::f64::consts::PI,
        1 => std::f64::consts::PI,
        _ => {
            let corners = piece.corners(&[0.0; 4]);
            let count = piece.count();
            // The corner between edges k-1 and k.
            let k = (0..count).find(|&k| foot.is_on(k) && foot.is_on((k + count - 1) % count));
            let k = k.unwrap_or(0);
            let to = |j: usize| {
                let [e, z] = [corners[j][0] - corners[k][0], corners[j][1] - corners[k][1]];
                foot.local.tangents[0] * e + foot.local.tangents[1] * z
            };
            super::facets::angle(&to((k + 1) % count), &to((k + count - 1) % count))
        }
    };
    normal * angle
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::solid::testing::Random;
    use crate::surface::test_meshes::{sphere_quad, sphere_triangle, wavy_quad, wavy_triangle};

    /// The gap has the normal as its gradient, and the normal has its own, by differences through new projections.
    pub fn check_derivatives(x: &Vec3, project: impl Fn(&Vec3) -> Option<Projection>) {
        let here = project(x).unwrap();
        assert!((here.point + here.normal * here.gap - x).norm() < 1e-12 * (1.0 + x.norm()));
        assert!(
            (here.normal_gradient - here.normal_gradient.transpose()).norm()
                < 1e-14 * (1.0 + here.normal_gradient.norm())
        );
        assert!((here.normal_gradient * here.normal).norm() < 1e-11 * (1.0 + here.normal_gradient.norm()));
        let h = 1e-4 * here.gap.abs().clamp(0.01, 1.0);
        for axis in 0..3 {
            let at = |s: f64| project(&(x + Vec3::ith(axis, s * h))).unwrap();
            let difference = |value: &dyn Fn(Projection) -> Vec3| {
                (value(at(1.0)) - value(at(-1.0))) * (2.0 / (3.0 * h)) - (value(at(2.0)) - value(at(-2.0))) / (12.0 * h)
            };
            let gap = difference(&|p| Vec3::repeat(p.gap)).x;
            assert!((gap - here.normal[axis]).abs() < 1e-9, "gap along {axis}");
            let error = (difference(&|p| p.normal) - here.normal_gradient.column(axis)).norm();
            assert!(error < 1e-8 * (1.0 + here.normal_gradient.norm()), "normal along {axis}: {error:e}");
        }
    }

    fn best_of_samples(patch: &crate::surface::Patch, x: &Vec3) -> f64 {
        let n = 100;
        let mut best = f64::INFINITY;
        for i in 0..=n {
            for j in 0..=n {
                let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
                let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
                best = best.min((x - patch.point(xi)).norm());
            }
        }
        best
    }

    #[test]
    fn five_starts_find_the_closest_point_of_all() {
        let mut random = Random::new(1);
        let mut certain = 0;
        for (patch, _) in [wavy_quad(), wavy_triangle(), sphere_quad(), sphere_triangle()] {
            let extent = Extent::new(&patch);
            for k in 0..60 {
                let x = random.vector(2.0) * if k % 2 == 0 { 1.0 } else { 0.3 };
                let feet = starts(&patch).map(|start| descend(&patch, &x, &[0.0; 4], start));
                let best = feet.iter().map(|f| f.distance).fold(f64::INFINITY, f64::min);
                assert!(best <= best_of_samples(&patch, &x) + 1e-12);
                let closest = closest_foot(&patch, &extent, &x, None, f64::INFINITY).distance;
                assert!((closest - best).abs() <= 1e-12, "{closest} is not {best}");
                if extent.has_one_minimum(&patch, &x) {
                    certain += 1;
                    assert!(feet.iter().all(|f| f.distance < best + 1e-12));
                }
            }
        }
        assert!(certain > 60, "{certain}");
    }

    #[test]
    fn what_a_piece_is_far_above_is_below_all_its_points() {
        let mut random = Random::new(1);
        let mut certain = 0;
        for (patch, _) in [wavy_quad(), wavy_triangle(), sphere_quad(), sphere_triangle()] {
            let extent = Extent::new(&patch);
            for _ in 0..300 {
                let (x, deep) = (random.vector(2.0), random.number(1.0).abs());
                if extent.is_far_above(&x, deep) {
                    certain += 1;
                    for k in 0..11 * 11 {
                        let (s, t) = (f64::from(k % 11) / 10.0, f64::from(k / 11) / 10.0);
                        let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
                        assert!((x - patch.point(xi)).dot(&patch.normal(xi)) < -deep);
                    }
                }
            }
        }
        assert!(certain > 60, "{certain}");
    }

    #[test]
    fn limits_tell_where_the_foot_is() {
        let (patch, _) = wavy_quad();
        let foot = |x: [f64; 3], extension: f64| descend(&patch, &Vec3::from(x), &[extension; 4], [0.5, 0.5]);
        assert_eq!(foot([0.5, 0.5, 0.5], 0.0).limits, 0);
        assert_eq!(foot([0.5, -0.5, 0.2], 0.0).limits, 0b0001);
        assert_eq!(foot([2.0, 0.5, 0.2], 0.0).limits, 0b0010);
        assert_eq!(foot([2.0, 2.0, 0.2], 0.0).limits, 0b0110);
        assert_eq!(foot([-1.0, -1.0, 0.2], 0.0).limits, 0b1001);
        assert_eq!(foot([-1.0, -1.0, 0.2], 0.05).xi, [-0.05, -0.05]);
        let (triangle, _) = wavy_triangle();
        let foot = |x: [f64; 3]| descend(&triangle, &Vec3::from(x), &[0.0; 4], [0.6, 0.3]);
        assert_eq!(foot([0.2, 0.8, 0.3]).limits, 0b100);
        assert_eq!(foot([-1.0, -0.5, 0.3]).limits, 0b101);
        assert_eq!(foot([3.0, 3.0, 0.3]).limits, 0b110);
    }

    #[test]
    fn derivatives_inside_on_edges_and_at_corners() {
        for (patch, _) in [wavy_quad(), wavy_triangle(), sphere_quad(), sphere_triangle()] {
            let project = |x: &Vec3| {
                let foot = descend(&patch, x, &[0.0; 4], patch.center());
                let inside = foot.local.area_vector().dot(&(x - foot.local.point)) < 0.0;
                let (gap, normal, normal_gradient) =
                    if foot.limits == 0 { on_surface(x, &foot.local) } else { on_edge(x, &patch, &foot, inside) };
                Some(Projection { gap, point: foot.local.point, normal, normal_gradient, patch: 0, xi: foot.xi })
            };
            for side in [1.0, -1.0] {
                for distance in [0.05, 0.3] {
                    let xi = [0.6, 0.35];
                    check_derivatives(&(patch.point(xi) + patch.normal(xi) * (side * distance)), project);
                    let (edge, corner) = ([0.45, 0.0], [1.0, 0.0]);
                    let local = patch.local(edge);
                    let out = local.tangents[0].cross(&local.area_vector()).normalize();
                    check_derivatives(
                        &(local.point + (out * 1.5 + patch.normal(edge) * side).normalize() * distance),
                        project,
                    );
                    let local = patch.local(corner);
                    let out = (local.tangents[0].normalize() * 1.5
                        + local.tangents[0].cross(&local.area_vector()).normalize() * 2.0
                        + local.area_vector().normalize() * side)
                        .normalize();
                    check_derivatives(&(local.point + out * distance), project);
                }
            }
        }
    }
}
