//! The contact element of one slave node: augmented Lagrangian with Coulomb friction, residual and exact tangent.
//!
//! With the gap g and outward normal n of the master at the closest point x̄, the multiplier λ (the nodal contact force,
//! N; λ·n <= 0 in contact) and the slip g_t = (I - nn)(x̄ - x̃) since the last converged increment (x̃ the contact point
//! of then, carried along by the master; eqs. (6)-(7) of Neto, Oliveira and Menezes), the augmented multiplier is
//!
//!   λ̂_n = λ·n + ε_n g,   λ̂_t = (I - nn) λ + ε_t g_t,
//!
//! and the contact force F on the master (its opposite acts on the slave) by status (eqs. (63)-(65)):
//!
//!   gap    λ̂_n > 0              F = 0
//!   stick  |λ̂_t| <= -μ λ̂_n      F = λ̂_n n + λ̂_t
//!   slip   otherwise            F = λ̂_n (n - μ t),  t = λ̂_t / |λ̂_t|
//!
//! The residual of the slave node is F, that of the multiplier -(λ - F). The multiplier's unknown is λ' = λ / ε_n, a
//! length, so that every block of the tangent is of the size of ε_n and every residual is a force.
//!
//! The tangent is exact for a rigid master: with N = ∂n/∂x (which has the curvature of the surface) ∂x̄/∂x = I - nn - gN,
//! and the master's own motion enters with the opposite sign, since only the relative position matters.
//!
//! A direction in which neither the node nor the tool can give way makes no condition of its own:
//!
//! - Where the node stands still relative to the tool (a plane of symmetry, plane strain), it meets the tool's section
//!   with the directions left to it: with their projector P and c = |P n|, the normal P n / c, the gap g / c and, the
//!   normal force being N = λ̂_n / c, friction bounded by μ N. The multiplier has no component in the held directions;
//!   the force has that of N n.
//! - Where it is drawn along the tool, it cannot stick.
//!
//! Without friction one multiplier λ_n a node suffices; the element then derives from a potential and its tangent is
//! symmetric.

use crate::surface::Projection;
use crate::{Mat3, Vec3};

/// What a slave node does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    #[default]
    Gap = 0,
    Stick = 1,
    Slip = 2,
}

impl Status {
    /// The status in words; without friction what touches neither sticks nor slips.
    pub fn name(self, friction: f64) -> &'static str {
        match self {
            Self::Gap => "not touching",
            _ if friction == 0.0 => "touching",
            Self::Stick => "sticking",
            Self::Slip => "slipping",
        }
    }
}

/// Parameters of the law at a slave node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Coulomb coefficient μ.
    pub friction: f64,
    /// Normal penalty ε_n, force per length.
    pub normal: f64,
    /// Tangential penalty ε_t, force per length.
    pub tangential: f64,
}

/// Residual and tangent of a frictional slave node; forces and forces per length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frictional {
    pub status: Status,
    /// F: the residual of the slave's displacement.
    pub force: Vec3,
    /// -(λ - F): the residual of the multiplier.
    pub multiplier_residual: Vec3,
    /// ∂F/∂x: the displacement row; also the multiplier row with respect to x.
    pub force_position: Mat3,
    /// ∂F/∂λ'.
    pub force_multiplier: Mat3,
    /// ∂(-(λ - F))/∂λ'.
    pub multiplier_multiplier: Mat3,
    /// Slip since the last converged increment, g_t.
    pub slip: Vec3,
}

/// Residual and tangent of a frictionless slave node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frictionless {
    pub status: Status,
    /// F: the residual of the slave's displacement.
    pub force: Vec3,
    /// ε_n g in contact, -λ_n in the gap: the residual of the multiplier.
    pub multiplier_residual: f64,
    /// ∂F/∂x, symmetric.
    pub force_position: Mat3,
    /// ∂F/∂λ', also the multiplier row with respect to x.
    pub force_multiplier: Vec3,
    /// ∂(residual of the multiplier)/∂λ'.
    pub multiplier_multiplier: f64,
}

/// Directions in which neither a slave node nor its tool can give way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guide {
    /// The node stands still relative to the tool.
    pub held: [bool; 3],
    /// The node is drawn along the tool.
    pub drawn: [bool; 3],
}

impl Guide {
    /// Whether the node, or the tool, can give way to a force along `normal`. What cannot does not feel the tool.
    pub fn gives_way(&self, normal: &Vec3) -> bool {
        const ACROSS: f64 = 1e-6;
        (0..3).any(|d| !self.held[d] && !self.drawn[d] && normal[d].abs() > ACROSS)
    }
}

/// The tool as a guided node meets it: its section with the directions that are not held.
struct Section {
    normal: Vec3,
    normal_position: Mat3,
    tangential: Mat3,
    gap: f64,
    gap_position: Vec3,
    /// From the slip origin to the closest point.
    path: Vec3,
    /// Its derivative, tangential part.
    path_position: Mat3,
    /// Normal force over λ̂_n, and its derivative.
    lean: f64,
    lean_position: Vec3,
}

impl Section {
    fn new(p: &Projection, anchor: Vec3, held: [bool; 3]) -> Self {
        let free = Mat3::from_diagonal(&Vec3::from(held.map(|held| if held { 0.0 } else { 1.0 })));
        let length = (free * p.normal).norm();
        let normal = free * p.normal / length;
        let turn = free * p.normal_gradient * free;
        let tangential = free - normal * normal.transpose();
        let length_position = turn * normal;
        Self {
            normal,
            normal_position: tangential * turn / length,
            tangential,
            gap: p.gap / length,
            gap_position: normal - length_position * (p.gap / length.powi(2)),
            path: free * (p.point - anchor),
            path_position: tangential - tangential * turn * p.gap,
            lean: 1.0 / length,
            lean_position: -length_position / length.powi(2),
        }
    }
}

/// The element with friction. `multiplier` is λ (N), `anchor` x̃; without a projection the node is in the gap.
pub fn frictional(
    law: Law,
    multiplier: Vec3,
    projection: Option<&Projection>,
    anchor: Vec3,
    guide: &Guide,
) -> Frictional {
    let gap = Frictional {
        status: Status::Gap,
        force: Vec3::zeros(),
        multiplier_residual: -multiplier,
        force_position: Mat3::zeros(),
        force_multiplier: Mat3::zeros(),
        multiplier_multiplier: Mat3::identity() * -law.normal,
        slip: Vec3::zeros(),
    };
    let Some(p) = projection else { return gap };
    let section = Section::new(p, anchor, guide.held);
    let Section { normal: n, normal_position: dn, tangential, path, .. } = section;
    let slip = tangential * path;
    let slip_position = section.path_position - n * dn.tr_mul(&path).transpose() - dn * n.dot(&path);

    let normal_multiplier = multiplier.dot(&n);
    let lambda_n = normal_multiplier + law.normal * section.gap;
    let lambda_t = tangential * multiplier + law.tangential * slip;
    if lambda_n > 0.0 {
        return Frictional { slip, ..gap };
    }
    let turned = dn.tr_mul(&multiplier);
    let lambda_n_position = turned + law.normal * section.gap_position;
    let lambda_t_position = slip_position * law.tangential - n * turned.transpose() - dn * normal_multiplier;
    let size = lambda_t.norm();
    let friction = law.friction * section.lean;
    let bound = -friction * lambda_n;
    // Beyond the rounding of positions.
    let drawn = (0..3).any(|d| guide.drawn[d] && slip[d].abs() > 1e-12 * p.point.amax());

    let (status, force, force_position, force_lambda);
    // A node that slipped last stands on the cone to rounding, and is taken to slip on.
    if size <= bound * (1.0 - 1e-9) && !drawn {
        status = Status::Stick;
        force = n * lambda_n + lambda_t;
        force_position = n * lambda_n_position.transpose() + dn * lambda_n + lambda_t_position;
        force_lambda = Mat3::identity();
    } else {
        let t = lambda_t / size;
        let direction = n - friction * t;
        let turn = (Mat3::identity() - t * t.transpose()) * (bound / size);
        let leaning = t * section.lean_position.transpose() * (law.friction * lambda_n);
        status = Status::Slip;
        force = direction * lambda_n;
        force_position = direction * lambda_n_position.transpose() + dn * lambda_n + turn * lambda_t_position - leaning;
        force_lambda = direction * n.transpose() + turn * tangential;
    }
    let across = p.normal * (lambda_n * section.lean);
    let reaction = Vec3::from_fn(|d, _| if guide.held[d] { across[d] } else { 0.0 });
    Frictional {
        status,
        force: force + reaction,
        multiplier_residual: force - multiplier,
        force_position,
        force_multiplier: force_lambda * law.normal,
        multiplier_multiplier: (force_lambda - Mat3::identity()) * law.normal,
        slip,
    }
}

/// The element without friction. `multiplier` is λ_n (N).
pub fn frictionless(law: Law, multiplier: f64, projection: Option<&Projection>) -> Frictionless {
    match projection {
        Some(p) if multiplier + law.normal * p.gap <= 0.0 => {
            let lambda_n = multiplier + law.normal * p.gap;
            Frictionless {
                status: Status::Slip,
                force: p.normal * lambda_n,
                multiplier_residual: law.normal * p.gap,
                force_position: p.normal * p.normal.transpose() * law.normal + p.normal_gradient * lambda_n,
                force_multiplier: p.normal * law.normal,
                multiplier_multiplier: 0.0,
            }
        }
        _ => Frictionless {
            status: Status::Gap,
            force: Vec3::zeros(),
            multiplier_residual: -multiplier,
            force_position: Mat3::zeros(),
            force_multiplier: Vec3::zeros(),
            multiplier_multiplier: -law.normal,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Law = Law { friction: 0.3, normal: 40.0, tangential: 25.0 };

    /// Projection onto a sphere of radius 3 about the origin, solid or hollow, or onto the plane z = 2.9.
    #[derive(Clone, Copy, Debug)]
    enum Master {
        Sphere,
        Bore,
        Plane,
    }

    impl Master {
        fn project(self, x: Vec3) -> Projection {
            let (gap, normal, normal_gradient) = match self {
                Self::Plane => (x.z - 2.9, Vec3::z(), Mat3::zeros()),
                Self::Sphere | Self::Bore => {
                    let sign = if matches!(self, Self::Sphere) { 1.0 } else { -1.0 };
                    let (r, e) = (x.norm(), x.normalize());
                    (sign * (r - 3.0), sign * e, sign * (Mat3::identity() - e * e.transpose()) / r)
                }
            };
            Projection { gap, point: x - normal * gap, normal, normal_gradient, patch: 0, xi: [0.0; 2] }
        }
    }

    impl Master {
        /// A point 0.1 or less inside the solid.
        fn penetrating(self) -> Vec3 {
            Vec3::new(0.31, -0.42, 2.86) * if matches!(self, Self::Bore) { 1.06 } else { 1.0 }
        }
    }

    /// A state in each status: (position, multiplier, slip origin).
    fn states(master: Master) -> [(Status, Vec3, Vec3, Vec3); 3] {
        let x = master.penetrating();
        let p = master.project(x);
        let origin = p.point + Vec3::new(0.05, 0.12, 0.01);
        let pressed = -8.0 * p.normal;
        let tangent = p.normal.cross(&Vec3::new(0.3, 1.0, 0.2)).normalize();
        [
            (Status::Gap, x, p.normal * (LAW.normal * p.gap.abs() + 1.0), origin),
            (Status::Stick, x, pressed - LAW.tangential * 0.2 * (p.point - origin), origin),
            (Status::Slip, x, pressed + 4.0 * tangent, origin),
        ]
    }

    /// Fourth-order difference of `f` along each axis.
    fn gradient<const N: usize>(
        f: impl Fn(Vec3) -> nalgebra::SVector<f64, N>,
        x: Vec3,
    ) -> nalgebra::SMatrix<f64, N, 3> {
        let h = 5e-4;
        let columns = [Vec3::x(), Vec3::y(), Vec3::z()]
            .map(|e| (8.0 * (f(x + h * e) - f(x - h * e)) - (f(x + 2.0 * h * e) - f(x - 2.0 * h * e))) / (12.0 * h));
        nalgebra::SMatrix::from_columns(&columns)
    }

    #[test]
    fn the_frictional_tangent_is_the_derivative_of_the_residual() {
        for master in [Master::Sphere, Master::Bore, Master::Plane] {
            for (status, x, lambda, origin) in states(master) {
                let at = |x: Vec3, lambda: Vec3| {
                    frictional(LAW, lambda, Some(&master.project(x)), origin, &Guide::default())
                };
                let e = at(x, lambda);
                assert_eq!(e.status, status, "{master:?}");
                let of_x = gradient(|x| at(x, lambda).force, x);
                let of_lambda = gradient(|l| at(x, l).force, lambda) * LAW.normal;
                let row = gradient(|l| at(x, l).multiplier_residual, lambda) * LAW.normal;
                let row_x = gradient(|x| at(x, lambda).multiplier_residual, x);
                let error = |a: Mat3, b: Mat3| (a - b).amax() / LAW.normal;
                assert!(
                    error(e.force_position, of_x) < 2e-10,
                    "{master:?} {status:?}: {}",
                    error(e.force_position, of_x)
                );
                assert!(error(e.force_position, row_x) < 2e-10, "{master:?} {status:?}");
                assert!(error(e.force_multiplier, of_lambda) < 2e-10, "{master:?} {status:?}");
                assert!(error(e.multiplier_multiplier, row) < 2e-10, "{master:?} {status:?}");
            }
        }
    }

    #[test]
    fn the_frictionless_tangent_is_symmetric_and_the_derivative_of_the_residual() {
        for master in [Master::Sphere, Master::Bore, Master::Plane] {
            let x = master.penetrating();
            for lambda in [-7.0, 30.0] {
                let at = |x: Vec3, lambda: f64| frictionless(LAW, lambda, Some(&master.project(x)));
                let e = at(x, lambda);
                assert_eq!(e.status == Status::Gap, lambda > 0.0);
                assert!((gradient(|x| at(x, lambda).force, x) - e.force_position).amax() < 1e-8);
                assert_eq!(e.force_position, e.force_position.transpose());
                let row = gradient(|x| nalgebra::Vector1::new(at(x, lambda).multiplier_residual), x);
                assert!((row.transpose() - e.force_multiplier).amax() < 1e-8);
                let slope = |f: &dyn Fn(f64) -> f64| (f(lambda + 1.0) - f(lambda - 1.0)) / 2.0 * LAW.normal;
                let by_multiplier = slope(&|l| at(x, l).multiplier_residual);
                assert!((by_multiplier - e.multiplier_multiplier).abs() < 1e-11);
                for d in 0..3 {
                    assert!((slope(&|l| at(x, l).force[d]) - e.force_multiplier[d]).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn the_tangent_of_a_held_node_is_the_derivative_in_the_free_directions() {
        for (master, held) in [Master::Sphere, Master::Bore]
            .into_iter()
            .flat_map(|m| [[true, false, false], [false, true, false], [true, true, false]].map(|held| (m, held)))
        {
            let guide = Guide { held, drawn: [false; 3] };
            let free = Vec3::from(held.map(|held| if held { 0.0 } else { 1.0 }));
            for (_, x, lambda, origin) in states(master) {
                let lambda = lambda.component_mul(&free);
                let at = |x: Vec3, l: Vec3| frictional(LAW, l, Some(&master.project(x)), origin, &guide);
                let e = at(x, lambda);
                let error = |a: Mat3, b: Mat3| {
                    let among_free = (a - b).map_with_location(|i, j, v| v * free[i] * free[j]);
                    among_free.amax() / LAW.normal
                };
                let what = format!("{master:?} {held:?} {:?}", e.status);
                assert!(error(e.force_position, gradient(|x| at(x, lambda).force, x)) < 5e-10, "{what}");
                let row_x = gradient(|x| at(x, lambda).multiplier_residual, x);
                assert!(error(e.force_position, row_x) < 5e-10, "{what}");
                let of_lambda = gradient(|l| at(x, l).force, lambda) * LAW.normal;
                assert!(error(e.force_multiplier, of_lambda) < 5e-10, "{what}");
                let row = gradient(|l| at(x, l).multiplier_residual, lambda) * LAW.normal;
                assert!(error(e.multiplier_multiplier, row) < 5e-10, "{what}");
            }
        }
    }

    #[test]
    fn a_held_node_gives_the_force_of_the_whole_normal() {
        // Without friction to speak of, the force is along the normal, whatever is held.
        let (_, x, _, origin) = states(Master::Sphere)[2];
        let p = Master::Sphere.project(x);
        let law = Law { friction: 1e-12, ..LAW };
        let guide = Guide { held: [true, false, false], drawn: [false; 3] };
        let pressed = Vec3::new(0.0, p.normal.y, p.normal.z) * -5.0;
        let e = frictional(law, pressed, Some(&p), origin, &guide);
        assert!(e.status == Status::Slip && e.force.normalize().dot(&p.normal) < -1.0 + 1e-11);
        assert!(guide.gives_way(&p.normal) && !guide.gives_way(&Vec3::x()));
    }

    #[test]
    fn a_drawn_node_cannot_stick() {
        let (status, x, lambda, origin) = states(Master::Sphere)[1];
        let p = Master::Sphere.project(x);
        let at = |drawn| frictional(LAW, lambda, Some(&p), origin, &Guide { held: [false; 3], drawn });
        assert_eq!((status, at([false; 3]).status), (Status::Stick, Status::Stick));
        let e = at([false, true, false]);
        let normal = e.force.dot(&p.normal);
        assert_eq!(e.status, Status::Slip);
        assert!(((e.force - p.normal * normal).norm() + LAW.friction * normal).abs() < 1e-14);
    }

    #[test]
    fn slipping_friction_obeys_coulomb_and_opposes_the_slip() {
        let (_, x, lambda, origin) = states(Master::Sphere)[2];
        let p = Master::Sphere.project(x);
        let e = frictional(LAW, lambda, Some(&p), origin, &Guide::default());
        let normal = e.force.dot(&p.normal);
        let tangential = e.force - p.normal * normal;
        assert!((tangential.norm() + LAW.friction * normal).abs() < 1e-14);
        // On the slave acts -F; with a multiplier of zero the only tangential force is that of the slip.
        let pressed = frictional(LAW, -0.5 * p.normal, Some(&p), origin, &Guide::default());
        assert!((-pressed.force).dot(&pressed.slip) < 0.0);
    }

    #[test]
    fn without_a_projection_the_multiplier_goes_to_zero() {
        let e = frictional(LAW, Vec3::new(1.0, 2.0, 3.0), None, Vec3::zeros(), &Guide::default());
        assert_eq!((e.status, e.force), (Status::Gap, Vec3::zeros()));
        assert_eq!(e.multiplier_residual, -Vec3::new(1.0, 2.0, 3.0));
    }
}
