//! The element on rigid tools: spheres, bores and planes.

use super::*;
use crate::contact::law::LAW;
use crate::contact::{Compliance, Pose};

/// The element of a slave node and a tool in blocks of three; without friction the multiplier is its first component.
pub struct Blocks {
    pub response: Response,
    pub force_position: Mat3,
    pub force_multiplier: Mat3,
    pub constraint_position: Mat3,
    pub constraint_multiplier: Mat3,
}

/// The element with slip origin x̃ = `origin`. What the tool gets is the opposite of what the node gets.
pub fn element(law: Law, multiplier: &Multiplier, at: &Projection, origin: Vec3, guide: &Guide) -> Blocks {
    let (tool, origin) = (Opposite::Tool(Mat3::identity(), None), Origin::Fixed(origin));
    let contact = Contact { projection: at, opposite: tool, origin, carried: Vec3::zeros() };
    let method = Method { law, transfer: Transfer::Bilinear, tangent: Tangent::Exact };
    let mut e = Element::default();
    let response = e.tangent(&method, multiplier, Some(&contact), guide);
    let first = if law.friction == 0.0 { 4 } else { 6 };
    let entry = |row: usize, column: usize| e.matrix[row * e.shape[1] + column];
    let block = |row: usize, column: usize| {
        let outside = |k: usize, start: usize| start == 3 && start + k >= first;
        Mat3::from_fn(|i, j| if outside(i, row) || outside(j, column) { 0.0 } else { entry(row + i, column + j) })
    };
    if response.status == Status::Gap {
        assert!(e.nodes.is_empty() && e.shape == [first; 2]);
    } else {
        assert_eq!((&e.nodes[..], &e.forces[..], e.shape), (&[0][..], &[-response.load][..], [first + 3; 2]));
        assert_eq!([block(first, 0), block(first, 3)], [-block(0, 0), -block(0, 3)]);
        assert_eq!([block(0, first), block(3, first), block(first, first)], [-block(0, 0), -block(3, 0), block(0, 0)]);
    }
    Blocks {
        response,
        force_position: block(0, 0),
        force_multiplier: block(0, 3),
        constraint_position: block(3, 0),
        constraint_multiplier: block(3, 3),
    }
}

/// Projection onto a sphere of radius 3 about the origin, solid or hollow, or onto the plane z = 2.9.
#[derive(Clone, Copy, Debug, PartialEq)]
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
fn gradient<const N: usize>(f: impl Fn(Vec3) -> nalgebra::SVector<f64, N>, x: Vec3) -> nalgebra::SMatrix<f64, N, 3> {
    let h = 5e-4;
    let columns = [Vec3::x(), Vec3::y(), Vec3::z()]
        .map(|e| (8.0 * (f(x + h * e) - f(x - h * e)) - (f(x + 2.0 * h * e) - f(x - 2.0 * h * e))) / (12.0 * h));
    nalgebra::SMatrix::from_columns(&columns)
}

/// The ways in which λ can enter: augmented, and as the force under each active set. The law is that of the state.
fn kinds(lambda: Vec3) -> [Multiplier; 4] {
    let [gap, stick, slip] = [Status::Gap, Status::Stick, Status::Slip].map(|set| Multiplier::Force(lambda, set));
    [Multiplier::Augmented(lambda), gap, stick, slip]
}

/// The same kind with another λ or σ.
fn with(multiplier: &Multiplier, lambda: Vec3) -> Multiplier {
    match *multiplier {
        Multiplier::Augmented(_) => Multiplier::Augmented(lambda),
        Multiplier::Force(_, set) => Multiplier::Force(lambda, set),
        Multiplier::Held { gap, tangential, .. } => Multiplier::Held { gap, tangential, force: lambda },
    }
}

/// Largest errors over the normal penalty, among the free directions, of the four blocks against differences.
fn errors(law: Law, master: Master, x: Vec3, multiplier: &Multiplier, origin: Vec3, guide: &Guide) -> f64 {
    let at = |x: Vec3, multiplier: &Multiplier| element(law, multiplier, &master.project(x), origin, guide);
    let e = at(x, multiplier);
    let lambda = match *multiplier {
        Multiplier::Augmented(lambda) | Multiplier::Force(lambda, _) => lambda,
        Multiplier::Held { force, .. } => force,
    };
    // What was eliminated is put back.
    let solved = e.response.force_by.multiplier * e.response.inverse * e.constraint_position;
    let pairs = [
        (e.force_position + solved, gradient(|x| at(x, multiplier).response.force, x)),
        (e.constraint_position, gradient(|x| at(x, multiplier).response.constraint, x)),
        (e.force_multiplier, gradient(|l| at(x, &with(multiplier, l)).response.force, lambda) * law.normal),
        (e.constraint_multiplier, gradient(|l| at(x, &with(multiplier, l)).response.constraint, lambda) * law.normal),
    ];
    let free = guide.held.map(|held| if held { 0.0 } else { 1.0 });
    let error = |(a, b): &(Mat3, Mat3)| (a - b).map_with_location(|i, j, v| v * free[i] * free[j]).amax();
    pairs.iter().map(error).fold(0.0, f64::max) / law.normal
}

#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        for (status, x, lambda, origin) in states(master) {
            // Beside the multiplier, so that the status stays.
            let compliance = Compliance { slack: 0.3, rest: lambda + Vec3::new(-0.3, 0.1, 0.2) };
            let yielding = Law { compliance, ..LAW };
            for (multiplier, law) in kinds(lambda).into_iter().flat_map(|m| [(m, LAW), (m, yielding)]) {
                let e = element(law, &multiplier, &master.project(x), origin, &Guide::default());
                let expected = if let Multiplier::Force(_, set) = multiplier { set } else { status };
                assert_eq!((e.response.status, e.response.asked), (expected, status), "{master:?}");
                let error = errors(law, master, x, &multiplier, origin, &Guide::default());
                assert!(error < 2e-9, "{master:?} {multiplier:?}: {error:e}");
            }
        }
    }
}

/// What glides has no friction, from where it is without a direction, too; its tangent is the derivative.
#[test]
fn what_glides_has_no_friction() {
    let law = Law { glides: true, ..LAW };
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        for (status, x, lambda, origin) in states(master) {
            let p = master.project(x);
            let still = p.normal * lambda.dot(&p.normal);
            for (lambda, origin) in [(lambda, origin), (still, p.point)] {
                let multiplier = Multiplier::Augmented(lambda);
                let e = element(law, &multiplier, &p, origin, &Guide::default());
                let gap = status == Status::Gap;
                assert_eq!(e.response.status, if gap { Status::Gap } else { Status::Slip });
                let across = e.response.force - p.normal * p.normal.dot(&e.response.force);
                assert!(across.norm() < 1e-15 * LAW.normal && (gap || e.response.force.norm() > 1.0));
                let error = errors(law, master, x, &multiplier, origin, &Guide::default());
                assert!(error < 2e-9, "{master:?} {status:?}: {error:e}");
            }
        }
    }
}

/// Friction that grows with slip, from a node that has slipped, and from one that has not yet.
#[test]
fn the_tangent_of_friction_that_grows_is_the_derivative_of_the_residual() {
    let law = Law { creep: 0.7, ..LAW };
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        for (_, x, lambda, origin) in states(master).into_iter().filter(|(status, ..)| *status == Status::Slip) {
            for multiplier in kinds(lambda) {
                let e = element(law, &multiplier, &master.project(x), origin, &Guide::default());
                let error = errors(law, master, x, &multiplier, origin, &Guide::default());
                assert!(error < 2e-9, "{master:?} {multiplier:?}: {error:e}");
                if e.response.status == Status::Slip && matches!(multiplier, Multiplier::Augmented(_)) {
                    let (force, normal) = (e.response.force, master.project(x).normal);
                    let pressed = -force.dot(&normal);
                    let friction = law.friction * (1.0 + law.creep * e.response.slip.norm());
                    assert!((force + pressed * normal).norm() - friction * pressed < 1e-12 * pressed);
                }
            }
        }
    }
}

/// Where the rest decides: with the one that is given, each status follows from another one's multiplier.
#[test]
fn the_tangent_of_a_constraint_that_gives_way_is_the_derivative_where_the_rest_decides() {
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        let [(_, x, gap, origin), (_, _, stick, _), (_, _, slip, _)] = states(master);
        let n = master.project(x).normal;
        let along = n.cross(&Vec3::new(0.3, 1.0, 0.2)).normalize();
        for (lambda, rest, expected) in [
            (gap, -80.0 * n, Status::Stick),
            (gap, -8.0 * n + 40.0 * along, Status::Slip),
            (stick, 90.0 * n, Status::Gap),
            (stick, 40.0 * along, Status::Slip),
            (slip, -80.0 * n, Status::Stick),
            (slip, 90.0 * n, Status::Gap),
        ] {
            let law = Law { compliance: Compliance { slack: 0.3, rest }, ..LAW };
            for multiplier in kinds(lambda) {
                let e = element(law, &multiplier, &master.project(x), origin, &Guide::default());
                assert_eq!(e.response.asked, expected, "{master:?} {rest}");
                let error = errors(law, master, x, &multiplier, origin, &Guide::default());
                assert!(error < 2e-9, "{master:?} {multiplier:?}: {error:e}");
            }
            let law =
                Law { friction: 0.0, compliance: Compliance { slack: 0.3, rest: Vec3::x() * rest.dot(&n) }, ..LAW };
            for multiplier in kinds(Vec3::x() * lambda.dot(&n)) {
                let e = element(law, &multiplier, &master.project(x), Vec3::zeros(), &Guide::default());
                let error = errors(law, master, x, &multiplier, Vec3::zeros(), &Guide::default());
                assert!(error < 2e-10, "{master:?} {multiplier:?}: {error:e}");
                assert!((e.force_multiplier - e.constraint_position.transpose()).amax() < 1e-13);
            }
        }
    }
}

/// What each node has of the central path: tangents, symmetric without friction, and force times gap, near and far.
#[test]
fn on_the_central_path_force_times_gap_is_given_and_smooth() {
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        for (_, x, lambda, origin) in states(master) {
            for guide in [Guide::default(), Guide { held: [true, false, false], ..Guide::default() }] {
                let law = Law { barrier: 3.0, ..LAW };
                let lambda = guide.free() * lambda;
                let local = Multiplier::Held { gap: 0.01, tangential: Vec3::zeros(), force: lambda };
                for multiplier in [Multiplier::Augmented(lambda), local] {
                    let error = errors(law, master, x, &multiplier, origin, &guide);
                    assert!(error < 2e-9, "{master:?} {multiplier:?}: {error:e}");
                }
            }
            let law = Law { friction: 0.0, barrier: 3.0, ..LAW };
            let multiplier = Multiplier::Augmented(Vec3::x() * lambda.dot(&master.project(x).normal));
            let e = element(law, &multiplier, &master.project(x), Vec3::zeros(), &Guide::default());
            let error = errors(law, master, x, &multiplier, Vec3::zeros(), &Guide::default());
            assert!(error < 2e-9, "{master:?}: {error:e}");
            assert!((e.force_multiplier - e.constraint_position.transpose()).amax() < 1e-13);
        }
    }
    let law = Law { friction: 0.0, barrier: 3.0, ..LAW };
    let normal_gradient = Mat3::zeros();
    for gap in [1e-9, 0.1, 1e9] {
        let at = Projection { gap, point: Vec3::zeros(), normal: Vec3::z(), normal_gradient, patch: 0, xi: [0.0; 2] };
        let lambda = -law.barrier * law.barrier / (law.normal * gap);
        let e = element(law, &Multiplier::Augmented(Vec3::x() * lambda), &at, Vec3::zeros(), &Guide::default());
        assert!((e.response.force.z / lambda - 1.0).abs() < 1e-12, "{gap}: {}", e.response.force);
    }
}

/// For one gap and slip there is one force, from whatever multiplier it is sought, and it is the multiplier: nothing pulls,
/// no gap is below zero but for what the constraint gives way by, and friction is that of the normal force.
#[test]
fn a_constraint_that_gives_way_has_one_state() {
    let n = Vec3::z();
    let slack = 0.3;
    for gap in [-0.4, -0.03, 0.01, 0.03, 0.05, 0.4] {
        for rest in [Vec3::zeros(), Vec3::new(0.5, -0.3, -4.0), Vec3::new(-2.0, 0.0, -6.0)] {
            for path in [Vec3::zeros(), Vec3::new(0.02, -0.01, 0.0), Vec3::new(0.5, 0.3, 0.0)] {
                let law = Law { compliance: Compliance { slack, rest }, ..LAW };
                let at =
                    Projection { gap, point: path, normal: n, normal_gradient: Mat3::zeros(), patch: 0, xi: [0.0; 2] };
                let from = |start: Vec3| {
                    let mut lambda = start;
                    for _ in 0..200 {
                        let multiplier = Multiplier::Augmented(lambda);
                        let e = element(law, &multiplier, &at, Vec3::zeros(), &Guide::default());
                        let Response { constraint, constraint_by, force, .. } = e.response;
                        if constraint.amax() < 1e-13 {
                            assert!((force - lambda).amax() < 1e-12);
                            return lambda;
                        }
                        lambda -= constraint_by.multiplier.try_inverse().unwrap() * constraint;
                    }
                    panic!("gap {gap}, rest {rest}, path {path}: from {start} it does not settle");
                };
                let lambda = from(Vec3::zeros());
                let again = from(Vec3::new(1.0, 2.0, -30.0));
                assert!((lambda - again).amax() < 1e-11, "gap {gap}, rest {rest}, path {path}: {lambda} {again}");
                let left = gap - slack / law.normal * (lambda.z - rest.z);
                assert!(lambda.z <= 1e-12 && left >= -1e-12 && (lambda.z * left).abs() < 1e-11);
                let flat = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
                let (along, slip) = (flat(lambda), path - flat(lambda - rest) * (slack / law.tangential));
                let bound = -law.friction * lambda.z;
                assert!(along.norm() <= bound + 1e-11);
                let lags = along - slip * (bound / slip.norm());
                assert!(slip.norm() < 1e-11 || lambda.z > -1e-11 || lags.norm() < 1e-9, "{along} {slip}");
            }
        }
    }
}

#[test]
fn the_frictionless_tangent_is_symmetric_and_the_derivative_of_the_residual() {
    let law = Law { friction: 0.0, ..LAW };
    for master in [Master::Sphere, Master::Bore, Master::Plane] {
        let x = master.penetrating();
        for lambda in [-7.0, 30.0].map(|l| Vec3::x() * l) {
            let held = Multiplier::Held { gap: 0.01, tangential: Vec3::zeros(), force: lambda };
            for multiplier in kinds(lambda).into_iter().chain([held]) {
                let e = element(law, &multiplier, &master.project(x), Vec3::zeros(), &Guide::default());
                let error = errors(law, master, x, &multiplier, Vec3::zeros(), &Guide::default());
                assert!(error < 2e-10, "{master:?} {multiplier:?}: {error:e}");
                let skew = (e.force_position - e.force_position.transpose()).amax();
                assert!(skew < 1e-13);
                let share = if multiplier == held { 1.0 - law.normal / law.penalty } else { 1.0 };
                assert!((e.force_multiplier - e.constraint_position.transpose() * share).amax() < 1e-13);
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
        let guide = Guide { held, ..Guide::default() };
        let free = Vec3::from(held.map(|held| if held { 0.0 } else { 1.0 }));
        for (_, x, lambda, origin) in states(master) {
            let lambda = lambda.component_mul(&free);
            let tangential = Vec3::new(0.2, 0.4, 0.1);
            let local = Multiplier::Held { gap: -0.02, tangential, force: lambda };
            for multiplier in kinds(lambda).into_iter().chain([local]) {
                let error = errors(LAW, master, x, &multiplier, origin, &guide);
                assert!(error < 5e-10, "{master:?} {held:?} {multiplier:?}: {error:e}");
            }
        }
    }
}

/// Friction along held directions: the tangent is the derivative, and on the plane friction is that with what is kept, as far as the
/// cone lets it.
#[test]
fn a_held_node_keeps_the_friction_that_it_bears() {
    for (master, held) in [Master::Sphere, Master::Bore, Master::Plane]
        .into_iter()
        .flat_map(|m| [[true, false, false], [false, true, false], [true, true, false]].map(|held| (m, held)))
    {
        let free = Guide { held, ..Guide::default() }.free();
        let borne = Vec3::new(0.9, -0.6, 0.4);
        let guide = Guide { held, kept: borne - free * borne, ..Guide::default() };
        let mut seen = [false; 3];
        for (_, x, lambda, origin) in states(master) {
            for times in [1.0, 10.0] {
                let lambda = free * lambda * times;
                let local = Multiplier::Held { gap: -0.02, tangential: Vec3::new(0.2, 0.4, 0.1), force: lambda };
                for multiplier in kinds(lambda).into_iter().chain([local]) {
                    let p = master.project(x);
                    let response = element(LAW, &multiplier, &p, origin, &guide).response;
                    seen[response.status as usize] = true;
                    if response.status == response.asked {
                        let error = errors(LAW, master, x, &multiplier, origin, &guide);
                        assert!(error < 1e-8, "{master:?} {held:?} {multiplier:?} {:?}: {error:e}", response.status);
                    }
                    if response.status == Status::Stick {
                        assert_eq!(response.kept, guide.kept);
                    }
                    let friction = response.force - p.normal * p.normal.dot(&response.force);
                    let bound = -LAW.friction * p.normal.dot(&response.force);
                    let solved = master == Master::Plane && matches!(multiplier, Multiplier::Augmented(_));
                    assert!(!solved || friction.norm() < bound * (1.0 + 1e-9) + 1e-12, "{master:?} {held:?}");
                }
            }
        }
        assert!(seen[1] && seen[2], "{master:?} {held:?}");
    }
}

/// σ at which its residual is zero, from a first guess.
fn settled(law: Law, master: Master, x: Vec3, held: &Multiplier, origin: Vec3) -> Blocks {
    let mut multiplier = *held;
    for _ in 0..30 {
        let e = element(law, &multiplier, &master.project(x), origin, &Guide::default());
        let Multiplier::Held { force, .. } = multiplier else { unreachable!() };
        if e.response.constraint.amax() < 1e-14 * (1.0 + force.amax()) {
            return e;
        }
        multiplier = with(held, force - e.response.inverse * e.response.constraint);
    }
    panic!("{multiplier:?} does not settle");
}

/// The local unknown and the augmentation below the penalty change nothing: F = λ + ε g, returned to the cone.
#[test]
fn with_the_local_unknown_the_penalty_law_is_as_it_is() {
    let (gap, tangential) = (-0.02, Vec3::new(0.9, -0.4, 0.3));
    for penalty in [LAW.normal, 100.0, 1e4] {
        let law = Law { penalty, tangential: LAW.normal, ..LAW };
        for master in [Master::Sphere, Master::Bore, Master::Plane] {
            let x = master.penetrating();
            let (p, mut seen) = (master.project(x), [false; 3]);
            for slip in [1e-4, 0.3] {
                let origin = p.point + Vec3::new(0.5, 1.2, 0.1) * slip;
                let force = p.normal * (penalty * (p.gap + gap));
                let held = Multiplier::Held { gap, tangential, force };
                let of = |x: Vec3| settled(law, master, x, &held, origin);
                let e = of(x);
                let normal = penalty * (p.gap + gap);
                let along = |v: Vec3| v - p.normal * p.normal.dot(&v);
                let trial = along(tangential + (p.point - origin) * penalty);
                let bound = -law.friction * normal;
                let expected = p.normal * normal + trial * (bound / trial.norm()).min(1.0);
                assert!((e.response.force - expected).norm() < 1e-11 * expected.norm());
                assert!((e.response.load - expected).norm() < 1e-11 * expected.norm());
                // Steps that are short against the elastic slip.
                let by = |y: Vec3| of(x + y * (10.0 / penalty)).response.load / 10.0;
                let error = (gradient(by, Vec3::zeros()) - e.force_position / penalty).amax();
                assert!(error < 3e-8, "{master:?} {:?} {penalty}: {error:e}", e.response.status);
                seen[e.response.status as usize] = true;
                assert_eq!(e.response.status == Status::Stick, trial.norm() < bound);
            }
            assert!(seen[1] || penalty < 1e3);
            assert!(seen[2]);
        }
    }
}

#[test]
fn a_held_node_gives_the_force_of_the_whole_normal() {
    // Without friction to speak of, the force is along the normal, whatever is held.
    let (_, x, _, origin) = states(Master::Sphere)[2];
    let p = Master::Sphere.project(x);
    let law = Law { friction: 1e-12, ..LAW };
    let guide = Guide { held: [true, false, false], ..Guide::default() };
    let pressed = Vec3::new(0.0, p.normal.y, p.normal.z) * -5.0;
    let e = element(law, &Multiplier::Augmented(pressed), &p, origin, &guide).response;
    assert!(e.status == Status::Slip && e.force.normalize().dot(&p.normal) < -1.0 + 1e-11);
    assert!(guide.gives_way(&p.normal) && !guide.gives_way(&Vec3::x()));
}

#[test]
fn a_drawn_node_cannot_stick() {
    let (status, x, lambda, origin) = states(Master::Sphere)[1];
    let p = Master::Sphere.project(x);
    let multiplier = Multiplier::Augmented(lambda);
    let guide = |drawn| Guide { drawn, ..Guide::default() };
    let at = |drawn| element(LAW, &multiplier, &p, origin, &guide(drawn)).response;
    assert_eq!((status, at([false; 3]).status), (Status::Stick, Status::Stick));
    let e = at([false, true, false]);
    let normal = e.force.dot(&p.normal);
    assert_eq!(e.status, Status::Slip);
    assert!(((e.force - p.normal * normal).norm() + LAW.friction * normal).abs() < 1e-14);
}

/// A node that is led back has the multiplier of the way there: however short the way, friction is against it.
#[test]
fn a_drawn_node_that_turns_is_not_pushed_on() {
    let (_, x, lambda, origin) = states(Master::Sphere)[2];
    let p = Master::Sphere.project(x);
    let guide = Guide { drawn: [true; 3], ..Guide::default() };
    let normal = p.normal * p.normal.dot(&lambda);
    let way = p.point - origin;
    let way = way - p.normal * p.normal.dot(&way);
    let turned = normal - way.normalize() * (LAW.friction * normal.norm());
    for short in [1.0, 1e-3, 1e-6] {
        let origin = p.point - way * short;
        let e = element(LAW, &Multiplier::Augmented(turned), &p, origin, &guide).response;
        let tangential = e.force - p.normal * p.normal.dot(&e.force);
        let bound = -LAW.friction * p.normal.dot(&e.force);
        assert!(e.status == Status::Slip && (tangential - way.normalize() * bound).norm() < 1e-9 * bound, "{short}");
        let aside = turned + p.normal.cross(&way).normalize() * (0.4 * LAW.friction * normal.norm());
        let of = |lambda: &Vec3| element(LAW, &Multiplier::Augmented(*lambda), &p, origin, &guide).response;
        let difference = gradient(|lambda| of(&lambda).force, aside);
        let found = of(&aside);
        assert!(found.force.dot(&way) > 0.0 && found.status == Status::Slip, "{short}");
        assert!((found.force_by.multiplier - difference).norm() < 1e-7, "{short}");
    }
}

#[test]
fn slipping_friction_obeys_coulomb_and_opposes_the_slip() {
    let (_, x, lambda, origin) = states(Master::Sphere)[2];
    let p = Master::Sphere.project(x);
    let at = |lambda| element(LAW, &Multiplier::Augmented(lambda), &p, origin, &Guide::default()).response;
    let e = at(lambda);
    let normal = e.force.dot(&p.normal);
    let tangential = e.force - p.normal * normal;
    assert!((tangential.norm() + LAW.friction * normal).abs() < 1e-14);
    // On the slave acts -F; with a multiplier of zero the only tangential force is that of the slip.
    let pressed = at(-0.5 * p.normal);
    assert!((-pressed.force).dot(&pressed.slip) < 0.0);
}

/// All residuals of the element on a tool that is moved by three and turned by the fourth of `unknowns[6..]`, after those of the
/// slave node and its multiplier; with friction or without.
fn on_a_turned_tool(law: Law, master: Master, origin: Vec3, unknowns: &[f64]) -> (Vec<f64>, Element) {
    let width = if law.friction == 0.0 { 1 } else { 3 };
    let (x, by) = (Vec3::from_column_slice(&unknowns[..3]), Vec3::from_column_slice(&unknowns[3 + width..][..3]));
    let lambda = Vec3::from_fn(|k, _| if k < width { unknowns[3 + k] * law.normal } else { 0.0 });
    let axle = Axle { point: Vec3::new(0.4, -0.7, 0.3) + by, axis: Vec3::new(0.48, 0.6, 0.64), lever: 1.7 };
    let pose = Pose::default().driven_by(&by).turned_by(&axle, unknowns[6 + width] / axle.lever);
    let (r, p) = (pose.rotation, master.project(pose.inward(&x)));
    let point = pose.outward(&p.point);
    let at = Projection { point, normal: r * p.normal, normal_gradient: r * p.normal_gradient * r.transpose(), ..p };
    let contact = Contact {
        projection: &at,
        opposite: Opposite::Tool(r, pose.axle_in_space()),
        origin: Origin::Fixed(pose.outward(&origin)),
        carried: Vec3::zeros(),
    };
    let method = Method { law, transfer: Transfer::Bilinear, tangent: Tangent::Exact };
    let mut e = Element::default();
    let response = e.tangent(&method, &Multiplier::Augmented(lambda), Some(&contact), &Guide::default());
    let mut residuals: Vec<f64> = response.load.iter().copied().collect();
    residuals.extend(response.constraint.iter().take(width));
    residuals.extend(e.forces.iter().flatten());
    (residuals, e)
}

#[test]
fn the_tangent_of_a_tool_that_a_torque_turns_is_the_derivative_of_the_residual() {
    for (master, friction) in
        [Master::Sphere, Master::Bore, Master::Plane].into_iter().flat_map(|m| [(m, 0.0), (m, 0.3)])
    {
        let (law, width) = (Law { friction, ..LAW }, if friction == 0.0 { 1 } else { 3 });
        for (status, x, lambda, origin) in &states(master)[1..] {
            let mut unknowns = x.iter().copied().collect::<Vec<f64>>();
            let lambda = if friction == 0.0 { Vec3::x() * -8.0 } else { *lambda };
            unknowns.extend(lambda.iter().take(width).map(|l| l / law.normal));
            unknowns.extend([0.0; 6]);
            let (_, e) = on_a_turned_tool(law, master, *origin, &unknowns);
            let (mut worst, mut skew) = (0.0f64, 0.0f64);
            for column in 0..7 + width {
                const H: f64 = 5e-4;
                let at = |by: f64| {
                    let mut moved = unknowns.clone();
                    moved[column] += by;
                    on_a_turned_tool(law, master, *origin, &moved).0
                };
                let [a, b, c, d] = [H, -H, 2.0 * H, -2.0 * H].map(at);
                for row in 0..7 + width {
                    let difference = (8.0 * (a[row] - b[row]) - (c[row] - d[row])) / (12.0 * H);
                    worst = worst.max((e.matrix[row * e.shape[1] + column] - difference).abs() / law.normal);
                    let [entry, mirrored] = [[row, column], [column, row]].map(|[i, j]| e.matrix[i * e.shape[1] + j]);
                    skew = skew.max((entry - mirrored).abs() / law.normal);
                }
            }
            assert!(worst < 5e-9, "{master:?} {status:?} {friction}: {worst:e}");
            assert!(friction > 0.0 || skew < 1e-14, "{master:?}: {skew:e}");
        }
    }
}
