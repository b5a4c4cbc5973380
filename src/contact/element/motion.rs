//! How closest point, gap and normal move with slave and master nodes.
//!
//! The foot x̄ of x moves along k free parameters: both inside the patch (k = 2), that of an edge curve at a sharp edge
//! (k = 1), none at a corner. With the tangents τ_a along them, a = τ_a·τ_b, b_ab = n·τ_a,b and A = a - g b, the condition
//! τ_a·(x - x̄) = 0 gives
//!
//! ```text
//!     A dξ = τ_a·(dx - dP) + g n·dτ_a        dx̄ = dP + τ_a dξ^a        dg = n·(dx - dP)
//! ```
//!
//! with dP and dτ_a at fixed parameters, and
//!
//! ```text
//!     inside          dn = -τ^a (n·dτ_a + b_ab dξ^b)
//!     edge, corner    dn = (I - nn)(dx - dx̄)/g
//! ```

use crate::contact::pose::Axle;
use crate::surface::{Local, Patch, Polygon, Projection};
use crate::{Mat3, Vec3};

/// Motion of the foot with one node.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part {
    pub point: Mat3,
    /// dg, a row.
    pub gap: Vec3,
    pub normal: Mat3,
    /// dξ^a, rows, along the free parameters.
    pub parameters: [Vec3; 2],
}

impl Part {
    /// With the slave node over a point of a tool.
    pub fn on_tool(at: &Projection) -> Self {
        let (n, normal) = (at.normal, at.normal_gradient);
        let point = Mat3::identity() - n * n.transpose() - normal * at.gap;
        Self { point, gap: n, normal, parameters: [Vec3::zeros(); 2] }
    }

    /// With the rotation of a tool by a torque, its first component, for a point at `place` that has come along a `path`.
    pub fn by_turn(at: &Projection, path: &Vec3, (axle, place): (&Axle, &Vec3)) -> Self {
        let (by_angle, turn, of_slave) = (axle.velocity(place), axle.turn(), Self::on_tool(at));
        let first = |column: Vec3| column * Vec3::x().transpose();
        Self {
            point: first(turn.cross(path) - of_slave.point * by_angle),
            gap: Vec3::x() * -at.normal.dot(&by_angle),
            normal: first(turn.cross(&at.normal) - of_slave.normal * by_angle),
            parameters: [Vec3::zeros(); 2],
        }
    }

    /// So much of it.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            point: self.point * factor,
            gap: self.gap * factor,
            normal: self.normal * factor,
            parameters: self.parameters.map(|by| by * factor),
        }
    }
}

/// What the motion of a foot is made of.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// The free parameters as directions of xi; 0 when there are fewer than two.
    pub directions: [[f64; 2]; 2],
    gap: f64,
    normal: Vec3,
    tangents: [Vec3; 2],
    /// τ^a, inside the patch.
    dual: [Vec3; 2],
    /// b.
    curvature: [[f64; 2]; 2],
    /// A^-1 on the free parameters.
    inverse: [[f64; 2]; 2],
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Inside,
    /// On an edge or corner.
    Border,
    /// On an edge or corner that x touches, where the normal stands still.
    Touching,
}

impl Motion {
    /// Motion of the foot that `projection` found on `patch`, which is `local` there.
    pub fn new(patch: &Patch, local: &Local, projection: &Projection) -> Self {
        let (n, gap) = (projection.normal, projection.gap);
        // A foot on an edge has the direction to x as its normal.
        let inside = (local.area_vector().normalize() - n).norm() < 1e-12;
        let kind = match inside {
            true => Kind::Inside,
            false if projection.normal_gradient == Mat3::zeros() => Kind::Touching,
            false => Kind::Border,
        };
        let directions = if inside { [[1.0, 0.0], [0.0, 1.0]] } else { border_directions(patch, projection.xi) };
        let along = |[e, z]: [f64; 2], [t, u]: [Vec3; 2]| t * e + u * z;
        let tangents = directions.map(|d| along(d, local.tangents));
        let [s11, s12, s22] = local.second;
        let curvature =
            directions.map(|c| directions.map(|d| along(c, [along(d, [s11, s12]), along(d, [s12, s22])]).dot(&n)));
        let metric = tangents.map(|t| tangents.map(|u| t.dot(&u)));
        let a = std::array::from_fn(|i| std::array::from_fn(|j| metric[i][j] - gap * curvature[i][j]));
        let raised = invert(metric);
        let dual = std::array::from_fn(|i| tangents[0] * raised[i][0] + tangents[1] * raised[i][1]);
        Self { directions, gap, normal: n, tangents, dual, curvature, inverse: invert(a), kind }
    }

    /// With the slave node.
    pub fn of_slave(&self) -> Part {
        self.part(Mat3::identity(), &Mat3::zeros(), [Vec3::zeros(); 2])
    }

    /// With a node of the patch, by which P and its tangents have the derivatives `rows`.
    pub fn of_node(&self, [point, by_e, by_z]: &[Mat3; 3]) -> Part {
        let leans = self.directions.map(|[e, z]| by_e.tr_mul(&self.normal) * e + by_z.tr_mul(&self.normal) * z);
        self.part(-point, point, leans)
    }

    /// With dP along a handle of the patch, of which φ is the function, and with n·dτ_a of what its derivatives along the free
    /// parameters are: what is to be multiplied by these.
    pub fn of_handles(&self) -> [Part; 3] {
        let leans = |a: usize| std::array::from_fn(|b| if a == b { self.normal } else { Vec3::zeros() });
        let still = Mat3::zeros();
        let of_point = self.part(-Mat3::identity(), &Mat3::identity(), [Vec3::zeros(); 2]);
        [of_point, self.part(still, &still, leans(0)), self.part(still, &still, leans(1))]
    }

    /// From dx - dP, dP and the rows n·dτ_a.
    fn part(&self, relative: Mat3, point: &Mat3, leans: [Vec3; 2]) -> Part {
        let sides: [Vec3; 2] = std::array::from_fn(|a| relative.tr_mul(&self.tangents[a]) + leans[a] * self.gap);
        let parameters = self.inverse.map(|row| sides[0] * row[0] + sides[1] * row[1]);
        let [t, u] = &self.tangents;
        let along = t * parameters[0].transpose() + u * parameters[1].transpose();
        let n = &self.normal;
        let normal = match self.kind {
            Kind::Inside => {
                let turns: [Vec3; 2] = std::array::from_fn(|a| {
                    leans[a] + parameters[0] * self.curvature[a][0] + parameters[1] * self.curvature[a][1]
                });
                -(self.dual[0] * turns[0].transpose() + self.dual[1] * turns[1].transpose())
            }
            Kind::Border => {
                let apart = (relative - along) / self.gap;
                apart - n * apart.tr_mul(n).transpose()
            }
            Kind::Touching => Mat3::zeros(),
        };
        Part { point: point + along, gap: relative.tr_mul(n), normal, parameters }
    }
}

/// The direction of xi along the edge on which `xi` lies; none at a corner.
fn border_directions(patch: &Patch, xi: [f64; 2]) -> [[f64; 2]; 2] {
    let (corners, sides, count) = (patch.corners(&[0.0; 4]), patch.sides(xi), patch.count as usize);
    let mut on = (0..count).filter(|k| sides[*k].abs() < 1e-13);
    match (on.next(), on.next()) {
        (Some(k), None) => {
            let (p, q) = (corners[k], corners[(k + 1) % count]);
            [[q[0] - p[0], q[1] - p[1]], [0.0; 2]]
        }
        _ => [[0.0; 2]; 2],
    }
}

/// The inverse on the rows and columns that are not zero; zero when it is singular there.
fn invert([[a, b], [c, d]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let over = |x: f64| if x == 0.0 { 0.0 } else { 1.0 / x };
    if d == 0.0 && b == 0.0 && c == 0.0 {
        return [[over(a), 0.0], [0.0; 2]];
    }
    let det = over(a * d - b * c);
    [[d * det, -b * det], [-c * det, a * det]]
}
