//! Which rigid motions of the bodies and tools nothing holds.
//!
//! A body moves with the velocity v + ω x (x - c), c the middle of its box; a tool that a force drives translates along its
//! free directions, and one that a torque drives turns about its axis. Every support is a row: no velocity along a direction at a point. Every contact is one, too: no
//! velocity of the two sides relative to each other along the normal, with friction that sticks along no direction.
//!
//! A motion is free when it moves no support and opens or closes no contact. Normals of meshed surfaces are not exact, so
//! that a motion along a smooth surface is not quite without an opening: what counts is the share of the velocity at the
//! contacts that goes along the normals. With the Gram matrix K of the rows, and M of all relative velocities at the same
//! points, motions are free where x·K x < TILT² x·M x. M has a little of the unit matrix besides, for what moves no point;
//! rotations are scaled by the half diagonal of the body.

use crate::contact::{Axle, Pair};
use crate::model::Model;
use crate::parallel::sum;
use crate::partition::parcels::{bounds, hull};
use crate::{AXIS_NAMES, Vec3};
use mpi::topology::SimpleCommunicator;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Share of a velocity that may be normal to a contact and count as none: 1e-3 radians, the accuracy of the normals of
/// coarse smoothed meshes.
const TILT: f64 = 1e-3;

/// Weight of a support over that of a contact.
const FIRM: f64 = 1e3;

/// Of the unit matrix in M: far below what one point of a mesh of millions weighs in it, well above rounding.
const UNIT: f64 = 1e-6;

/// Parts of motions below this are none.
const SLIGHT: f64 = 1e-4;

/// Velocities of a body: three translations, then three rotations.
const OF_BODY: usize = 6;

/// Velocities of a tool: three translations, and a rotation.
const OF_TOOL: usize = 4;

/// The free directions of a tool, and the axis about which it turns freely.
type Driven = ([bool; 3], Option<Axle>);

/// The rigid motions of a model, and what holds them on this rank.
#[derive(Clone, Debug)]
pub struct RigidMotions {
    bodies: Vec<(String, Vec3, f64)>,
    /// Tools with the free directions of each, and the axis about which it turns freely.
    tools: Vec<(String, Driven)>,
    /// Of supports, which are in both of the others, too.
    firm: DMatrix<f64>,
    held: DMatrix<f64>,
    moved: DMatrix<f64>,
}

/// What one body or tool does in the motions that nothing holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// "body `a`", "tool `b`".
    pub who: String,
    pub is_tool: bool,
    pub index: usize,
    /// Directions of free translations, unit vectors.
    pub along: Vec<Vec3>,
    /// Free rotations besides: axis, a unit vector, and a point on it.
    pub about: Vec<(Vec3, Vec3)>,
}

impl RigidMotions {
    /// All bodies, and the tools as they are `driven`; nothing holds them yet. Collective.
    pub fn new(comm: &SimpleCommunicator, model: &Model, driven: Vec<Driven>) -> Self {
        let part = &model.part;
        let middle = |b: usize| {
            let own = part.owned_of(b);
            let (low, high) = hull(comm, bounds(own.map(|n| part.points[n]))).unwrap_or_default();
            (0.5 * (low + high), 0.5 * (high - low).norm())
        };
        let named = |(b, body): (usize, &crate::model::Body)| {
            let (center, size) = middle(b);
            (body.name.clone(), center, if size > 0.0 { size } else { 1.0 })
        };
        let bodies = model.bodies.iter().enumerate().map(named).collect();
        Self::of(bodies, model.masters.tools.iter().map(|t| t.name.clone()).zip(driven).collect())
    }

    fn of(bodies: Vec<(String, Vec3, f64)>, tools: Vec<(String, Driven)>) -> Self {
        let count = OF_BODY * bodies.len() + OF_TOOL * tools.len();
        let zeros = || DMatrix::zeros(count, count);
        Self { bodies, tools, firm: zeros(), held: zeros(), moved: zeros() }
    }

    /// The point `x` of a body has no velocity along a unit vector.
    pub fn hold(&mut self, body: usize, x: &Vec3, along: &Vec3) {
        let row = self.velocity(body, x, along);
        for gram in [&mut self.firm, &mut self.held, &mut self.moved] {
            add_square(gram, &row);
        }
    }

    /// A node of `body` at `x` touches a tool or, where `master` says so, a body, along a unit vector; with friction that
    /// sticks they move as one.
    pub fn touch(&mut self, body: usize, master: Side, x: &Vec3, normal: &Vec3, sticks: bool) {
        let relative = |motions: &Self, along: &Vec3| {
            let mut row = motions.velocity(body, x, along).to_vec();
            match master {
                Side::Body(other) => row.extend(motions.velocity(other, x, along).iter().map(|(k, v)| (*k, -v))),
                Side::Tool(t) => {
                    let first = OF_BODY * motions.bodies.len() + OF_TOOL * t;
                    let (free, axle) = motions.tools[t].1;
                    row.extend((0..3).filter(|&d| free[d]).map(|d| (first + d, -along[d])));
                    row.extend(axle.map(|axle| (first + 3, -axle.velocity(x).dot(along))));
                }
            }
            row
        };
        for d in 0..3 {
            let row = relative(self, &Vec3::ith(d, 1.0));
            add_square(&mut self.moved, &row);
            if sticks {
                add_square(&mut self.held, &row);
            }
        }
        if !sticks {
            let row = relative(self, normal);
            add_square(&mut self.held, &row);
        }
    }

    /// Adds what touches of a pair: where `state` says of a slave node that it touches at a place with a normal, and
    /// whether it sticks there. `place` says which bodies these are, as by [`sides`].
    pub fn touch_pair(
        &mut self,
        pair: &Pair,
        place: (usize, Side),
        state: impl Fn(usize) -> Option<(Vec3, Vec3, bool)>,
    ) {
        if place.1 == Side::Body(place.0) {
            return;
        }
        for (x, normal, sticks) in (0..pair.slaves.len()).filter_map(state) {
            self.touch(place.0, place.1, &x, &normal, sticks);
        }
    }

    /// The velocity of the point `x` of a body along a direction: entries of a row.
    fn velocity(&self, body: usize, x: &Vec3, along: &Vec3) -> [(usize, f64); OF_BODY] {
        let (_, center, size) = &self.bodies[body];
        let turn = (x - center).cross(along) / *size;
        let first = OF_BODY * body;
        std::array::from_fn(|k| (first + k, if k < 3 { along[k] } else { turn[k - 3] }))
    }

    /// What can move: by body, then by tool; empty when everything is held. The same on all ranks. Collective.
    pub fn free(&self, comm: &SimpleCommunicator) -> Vec<Free> {
        self.free_along(comm, TILT)
    }

    /// The same, where a velocity at the contacts of which no more than the share `tilt` is normal to them counts as free,
    /// and what moves a support does not, however many contacts there are. Collective.
    pub fn free_along(&self, comm: &SimpleCommunicator, tilt: f64) -> Vec<Free> {
        let mut all = self.clone();
        all.held += &self.firm * FIRM;
        all.moved += &self.firm * FIRM;
        sum(comm, all.held.as_mut_slice());
        sum(comm, all.moved.as_mut_slice());
        all.loose(tilt)
    }

    fn loose(&self, tilt: f64) -> Vec<Free> {
        let tools = OF_BODY * self.bodies.len();
        let exists = |k: usize| {
            let of_tool = |k: usize| {
                let (free, axle) = self.tools[k / OF_TOOL].1;
                free.get(k % OF_TOOL).copied().unwrap_or(axle.is_some())
            };
            k < tools || of_tool(k - tools)
        };
        let columns: Vec<usize> = (0..self.held.nrows()).filter(|&k| exists(k)).collect();
        let pick =
            |m: &DMatrix<f64>| DMatrix::from_fn(columns.len(), columns.len(), |i, j| m[(columns[i], columns[j])]);
        let (held, moved) = (pick(&self.held), pick(&self.moved));
        let scale: Vec<f64> = moved.diagonal().iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { 1.0 }).collect();
        let scaled = |m: &DMatrix<f64>| DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * scale[i] * scale[j]);
        let mut mass = scaled(&moved);
        (0..mass.nrows()).for_each(|i| mass[(i, i)] += UNIT);
        let Some(factor) = mass.cholesky().map(|c| c.l()) else { return Vec::new() };
        let inverse = factor.clone().try_inverse().unwrap_or(factor);
        let pencil = &inverse * scaled(&held) * inverse.transpose();
        let eigen = SymmetricEigen::new(0.5 * (&pencil + pencil.transpose()));
        let mut motions: Vec<DVector<f64>> = Vec::new();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value < tilt * tilt {
                let motion = inverse.tr_mul(&eigen.eigenvectors.column(k));
                let mut all = DVector::zeros(self.held.nrows());
                columns.iter().enumerate().for_each(|(i, &c)| all[c] = motion[i] * scale[i]);
                motions.push(all.normalize());
            }
        }
        self.named(&motions)
    }

    /// The motions in words of bodies and tools.
    fn named(&self, motions: &[DVector<f64>]) -> Vec<Free> {
        let mut free = Vec::new();
        for (index, (name, center, size)) in self.bodies.iter().enumerate() {
            let own = basis(motions, OF_BODY * index, OF_BODY);
            let (along, about) = translations_and_rotations(&own, center, *size);
            if !own.is_empty() {
                free.push(Free { who: format!("body `{name}`"), is_tool: false, index, along, about });
            }
        }
        for (index, (name, (_, axle))) in self.tools.iter().enumerate() {
            let own = basis(motions, OF_BODY * self.bodies.len() + OF_TOOL * index, OF_TOOL);
            let along = axes_of(&own.iter().map(|m| Vec3::new(m[0], m[1], m[2])).collect::<Vec<_>>());
            let turns = own.iter().any(|m| m[3].abs() > SLIGHT);
            let about: Vec<_> = axle.iter().filter(|_| turns).map(|axle| (axle.axis, axle.point)).collect();
            if !along.is_empty() || !about.is_empty() {
                free.push(Free { who: format!("tool `{name}`"), is_tool: true, index, along, about });
            }
        }
        free
    }
}

/// The other side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Body(usize),
    Tool(usize),
}

/// The body of the slave nodes and the other side of each pair of a model.
pub fn sides(model: &Model, scene: &crate::scene::Scene) -> Vec<(usize, Side)> {
    let body = |set: &str| {
        let name = crate::scene::body_of(set);
        model.bodies.iter().position(|b| b.name == name).unwrap_or_default()
    };
    let side = |(pair, contact): (&Pair, &crate::scene::Contact)| {
        let on_body = || Side::Body(body(&contact.master.value));
        (body(&contact.slave.value), pair.master.tool().map_or_else(on_body, Side::Tool))
    };
    model.pairs.iter().zip(&scene.passes()).map(side).collect()
}

fn add_square(matrix: &mut DMatrix<f64>, row: &[(usize, f64)]) {
    for (i, a) in row {
        for (j, b) in row {
            matrix[(*i, *j)] += a * b;
        }
    }
}

/// An orthonormal basis of what the motions do in some of their components.
fn basis(motions: &[DVector<f64>], first: usize, count: usize) -> Vec<DVector<f64>> {
    if motions.is_empty() {
        return Vec::new();
    }
    let part = DMatrix::from_fn(count, motions.len(), |i, j| motions[j][first + i]);
    let (gram, largest) = (&part * part.transpose(), part.norm());
    let eigen = SymmetricEigen::new(gram);
    let is_some = |k: &usize| largest > SLIGHT && eigen.eigenvalues[*k] > SLIGHT * SLIGHT;
    (0..count).filter(is_some).map(|k| eigen.eigenvectors.column(k).into_owned()).collect()
}

/// Directions in which a body translates, and axes about which it turns besides.
fn translations_and_rotations(own: &[DVector<f64>], center: &Vec3, size: f64) -> (Vec<Vec3>, Vec<(Vec3, Vec3)>) {
    if own.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let part = |m: &DVector<f64>, from: usize| Vec3::new(m[from], m[from + 1], m[from + 2]);
    // Combinations without rotation, and those with each of the rotations that there are.
    let turns = DMatrix::from_fn(3, own.len(), |i, j| own[j][3 + i]);
    let eigen = SymmetricEigen::new(turns.tr_mul(&turns));
    let combined =
        |weights: &[f64], from: usize| own.iter().zip(weights).map(|(m, w)| part(m, from) * *w).sum::<Vec3>();
    let (mut along, mut spins) = (Vec::new(), Vec::new());
    for k in 0..own.len() {
        let weights: Vec<f64> = eigen.eigenvectors.column(k).iter().copied().collect();
        if eigen.eigenvalues[k] > SLIGHT * SLIGHT {
            spins.push((combined(&weights, 3), combined(&weights, 0)));
        } else {
            along.push(combined(&weights, 0));
        }
    }
    let along = axes_of(&along);
    let axes = axes_of(&spins.iter().map(|(turn, _)| *turn).collect::<Vec<_>>());
    let turning = |axis: &Vec3| {
        // The combination of the rotations that is this one, without what translates anyway.
        let matrix = DMatrix::from_fn(3, spins.len(), |i, j| spins[j].0[i]);
        let weights = matrix.svd(true, true).solve(&DVector::from_column_slice(axis.as_slice()), SLIGHT).ok()?;
        let mut velocity: Vec3 = spins.iter().zip(weights.iter()).map(|((_, v), w)| v * *w).sum();
        along.iter().for_each(|a| velocity -= a * a.dot(&velocity));
        Some((*axis, center + axis.cross(&velocity) * size))
    };
    let about = axes.iter().filter_map(turning).collect();
    (along, about)
}

/// An orthonormal basis of the span of vectors, of coordinate axes as far as these lie in it.
fn axes_of(vectors: &[Vec3]) -> Vec<Vec3> {
    let span = vectors.iter().map(|v| v * v.transpose()).sum::<crate::Mat3>();
    let eigen = SymmetricEigen::new(span);
    let is_some = |k: &usize| eigen.eigenvalues[*k] > SLIGHT * SLIGHT;
    let directions: Vec<Vec3> = (0..3).filter(is_some).map(|k| eigen.eigenvectors.column(k).into_owned()).collect();
    let within = |v: &Vec3| directions.iter().map(|d| d * d.dot(v)).sum::<Vec3>();
    let mut axes: Vec<Vec3> =
        (0..3).map(|d| Vec3::ith(d, 1.0)).filter(|axis| (within(axis) - axis).norm() < TILT).collect();
    for direction in &directions {
        let rest = direction - axes.iter().map(|a| a * a.dot(direction)).sum::<Vec3>();
        if axes.len() < directions.len() && rest.norm() > TILT.sqrt() {
            let rest = rest.normalize();
            axes.push(if rest[rest.iamax()] < 0.0 { -rest } else { rest });
        }
    }
    axes
}

impl Free {
    /// "along x and y, and turn about z".
    pub fn motion(&self) -> String {
        let along: Vec<String> = self.along.iter().map(name).collect();
        let about: Vec<String> = self.about.iter().map(|(axis, point)| turn(axis, point)).collect();
        match (along.is_empty(), about.is_empty()) {
            (false, true) => format!("move along {}", listed(&along)),
            (true, _) => format!("turn about {}", listed(&about)),
            (false, false) => format!("move along {}, and turn about {}", listed(&along), listed(&about)),
        }
    }
}

fn turn(axis: &Vec3, point: &Vec3) -> String {
    let on = (point - axis * axis.dot(point)).map(|x| if x.abs() < 5e-5 { 0.0 } else { x });
    format!("{} through ({:.4}, {:.4}, {:.4})", name(axis), on.x, on.y, on.z)
}

/// x, y or z, or the vector.
fn name(v: &Vec3) -> String {
    match (0..3).find(|&d| v[d].abs() > 1.0 - TILT) {
        Some(d) => AXIS_NAMES[d].into(),
        None => format!("({:.3}, {:.3}, {:.3})", v.x, v.y, v.z),
    }
}

/// "a, b and c".
fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motions(tools: &[[bool; 3]]) -> RigidMotions {
        let tools = tools.iter().map(|free| ("t".to_string(), (*free, None))).collect();
        RigidMotions::of(vec![("a".into(), Vec3::new(1.0, 1.0, 1.0), 3f64.sqrt())], tools)
    }

    /// The corners of a face of the cube from 0 to 2.
    fn face(axis: usize, at: f64) -> [Vec3; 4] {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[u, v]| {
            let mut x = Vec3::ith(axis, at);
            (x[(axis + 1) % 3], x[(axis + 2) % 3]) = (u, v);
            x
        })
    }

    fn told(motions: &RigidMotions) -> Vec<String> {
        motions.loose(TILT).iter().map(|free| format!("{} {}", free.who, free.motion())).collect()
    }

    #[test]
    fn a_free_body_has_six_motions_and_three_points_hold_it() {
        let mut one = motions(&[]);
        assert_eq!(told(&one).len(), 1);
        let free = &one.loose(TILT)[0];
        assert_eq!((free.along.len(), free.about.len()), (3, 3));
        let [a, b, c, _] = face(2, 0.0);
        for d in 0..3 {
            one.hold(0, &a, &Vec3::ith(d, 1.0));
        }
        let free = &one.loose(TILT)[0];
        assert_eq!((free.along.len(), free.about.len()), (0, 3));
        assert!(free.about.iter().all(|(axis, x)| axis.cross(x).norm() < 1e-6), "{free:?}");
        one.hold(0, &b, &Vec3::y());
        one.hold(0, &b, &Vec3::z());
        assert_eq!(told(&one), ["body `a` turn about x through (0.0000, 0.0000, 0.0000)"]);
        one.hold(0, &c, &Vec3::z());
        assert!(one.loose(TILT).is_empty());
    }

    #[test]
    fn a_smooth_plane_holds_three_motions_and_a_rough_one_all() {
        let plane = |sticks: bool| {
            let mut one = motions(&[[false; 3]]);
            face(2, 0.0).iter().for_each(|x| one.touch(0, Side::Tool(0), x, &Vec3::z(), sticks));
            one
        };
        assert_eq!(
            told(&plane(false)),
            ["body `a` move along x and y, and turn about z through (1.0000, 1.0000, 0.0000)"]
        );
        assert!(plane(true).loose(TILT).is_empty());
    }

    #[test]
    fn a_tool_that_is_free_takes_the_body_along() {
        let mut both = motions(&[[false, false, true]]);
        face(2, 2.0).iter().for_each(|x| both.touch(0, Side::Tool(0), x, &-Vec3::z(), true));
        assert_eq!(told(&both), ["body `a` move along z", "tool `t` move along z"]);
        face(2, 0.0).iter().for_each(|x| both.hold(0, x, &Vec3::z()));
        assert!(both.loose(TILT).is_empty());
    }

    /// A clamp that is a thousandth of the body holds it; a slope that is not seen to be one does not.
    #[test]
    fn what_is_small_holds_and_what_is_inexact_does_not() {
        let mut clamp = motions(&[]);
        for x in [Vec3::zeros(), Vec3::new(2e-3, 0.0, 0.0), Vec3::new(0.0, 2e-3, 0.0)] {
            (0..3).for_each(|d| clamp.hold(0, &x, &Vec3::ith(d, 1.0)));
        }
        assert!(clamp.loose(TILT).is_empty());
        let mut ball = motions(&[[false; 3]]);
        for k in 0..60 {
            let (a, b) = (0.4 * f64::from(k), 0.1 * f64::from(k % 30));
            let out = Vec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos());
            let tilted = (out + 1e-4 * Vec3::new(b.sin(), a.cos(), a.sin())).normalize();
            ball.touch(0, Side::Tool(0), &(Vec3::repeat(1.0) + out), &-tilted, false);
        }
        let free = ball.loose(TILT);
        assert_eq!((free.len(), free[0].along.len(), free[0].about.len()), (1, 0, 3));
    }
}
