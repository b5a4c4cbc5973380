//! Profiles: a chain of lines and arcs, drawn out along a straight line or turned about an axis.

use super::axis::Axis;
use super::chain::{Chain, FARTHER};
use super::corners::STRAIGHT;
use super::section::Planar;
use crate::surface::normals::more_along;
use crate::surface::{Closest, Local, Parametric, Projection};
use crate::{Vec2, Vec3};
use nalgebra::Matrix3x2;

/// A surface with the same section everywhere; the solid is on the left hand of the way along the chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pub chain: Chain,
    pub sweep: Sweep,
}

/// What becomes of the section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// The section lies in the plane of `x` and `y`, unit vectors at a right angle, and is drawn out along x cross y: by
    /// `length`, or without end both ways. Parameters: way along the chain, way along x cross y.
    Extruded { origin: Vec3, x: Vec3, y: Vec3, length: Option<f64> },
    /// The section lies in the half plane (r, h). Parameters: angle, way along the chain.
    Revolved(Axis),
}

impl Sweep {
    /// The places of the section's origin at both ends, where it ends.
    pub fn ends(&self) -> Option<[Vec3; 2]> {
        match self {
            Self::Extruded { origin, x, y, length: Some(length) } => Some([*origin, origin + x.cross(y) * *length]),
            _ => None,
        }
    }
}

/// Part of its length by which an extruded profile goes on beyond its ends, against round-off.
pub const ROUNDED: f64 = 1e-9;

impl Profile {
    /// Closest point of the profile to `x`; `kept` is the piece of the last projection, which stays in a tie. `None` beyond
    /// the ends, where what was on a piece is a little farther.
    pub fn project(&self, x: &Vec3, kept: Option<u32>) -> Option<Projection> {
        let at = self.in_section(x, if kept.is_some() { FARTHER } else { ROUNDED })?;
        self.chain.project(&at, kept).map(|found| self.in_space(x, found))
    }

    /// Perpendiculars from `x` to all pieces of the chain, no longer than `most`; they may miss a piece by a distance of `aside`.
    pub fn perpendiculars(&self, x: &Vec3, most: f64, aside: f64) -> Vec<Projection> {
        let Some(at) = self.in_section(x, ROUNDED) else { return Vec::new() };
        let near = self.chain.perpendiculars(&at, aside).filter(|(planar, _)| planar.gap.abs() <= most);
        near.map(|found| self.in_space(x, found)).collect()
    }

    /// The projections of `x`, whose closest point is `at`, onto the sides of an edge between which it is exactly, or, in a tip on the axis,
    /// onto planes that touch the surface at four places around. None elsewhere.
    pub fn evenly(&self, x: &Vec3, at: &Projection) -> Vec<Projection> {
        let Some(own) = self.in_section(x, FARTHER) else { return Vec::new() };
        match &self.sweep {
            Sweep::Revolved(axis) if own.x <= self.chain.near() => {
                let count = self.chain.count();
                let piece = at.patch % count;
                let on = |x: &Vec2| Some(self.chain.evenly(x, at.gap).find(|(_, k)| *k == piece)?.0);
                let is_tip = on(&Vec2::new(0.0, own.y)).is_some_and(|planar| planar.normal.x.abs() > STRAIGHT);
                if is_tip { axis.around(x, (piece, count), on) } else { Vec::new() }
            }
            // Most are on one piece.
            _ if self.chain.evenly(&own, at.gap).nth(1).is_none() => Vec::new(),
            _ => self.chain.evenly(&own, at.gap).map(|found| self.in_space(x, found)).collect(),
        }
    }

    /// Where `x` is in its section; `None` beyond the ends by more than `slack` of its length.
    fn in_section(&self, x: &Vec3, slack: f64) -> Option<Vec2> {
        match &self.sweep {
            Sweep::Extruded { origin, x: right, y: up, length } => {
                let (at, along) = split(x, origin, right, up);
                let is_beyond = |length: f64| along < -slack * length || along > length * (1.0 + slack);
                (!length.is_some_and(is_beyond)).then_some(at)
            }
            Sweep::Revolved(axis) => Some(axis.split(x).0),
        }
    }

    /// What was found in the section of `x`, in space.
    fn in_space(&self, x: &Vec3, (planar, piece): (Planar, u32)) -> Projection {
        match &self.sweep {
            Sweep::Extruded { x: right, y: up, .. } => {
                let plane = Matrix3x2::from_columns(&[*right, *up]);
                let normal = plane * planar.normal;
                Projection {
                    gap: planar.gap,
                    point: x - normal * planar.gap,
                    normal,
                    normal_gradient: plane * planar.gradient * plane.transpose(),
                    patch: piece,
                    xi: [0.0; 2],
                }
            }
            Sweep::Revolved(axis) => {
                let (at, e_r) = axis.split(x);
                Projection { patch: piece, ..axis.lift(x, at, e_r, &planar) }
            }
        }
    }

    /// The normal at the point next to `x`; at a corner that of the side that is the most along `like`, whichever its sign.
    pub fn side_normal(&self, x: &Vec3, like: &Vec3) -> Vec3 {
        match &self.sweep {
            Sweep::Extruded { origin, x: right, y: up, .. } => {
                let side =
                    self.chain.side_normal(&split(x, origin, right, up).0, &Vec2::new(like.dot(right), like.dot(up)));
                right * side.x + up * side.y
            }
            Sweep::Revolved(axis) => {
                let (at, e_r) = axis.split(x);
                // On the axis the section goes the way that is asked for.
                let across = like - axis.direction * like.dot(&axis.direction);
                let side = |e_r: Vec3| {
                    let side = self.chain.side_normal(&at, &Vec2::new(like.dot(&e_r), like.dot(&axis.direction)));
                    e_r * side.x + axis.direction * side.y
                };
                if at.x > 0.0 {
                    return side(e_r);
                }
                let e_r = across.try_normalize(0.0).unwrap_or(e_r);
                more_along(like, side(e_r), side(-e_r))
            }
        }
    }
}

impl Parametric for Profile {
    fn domain(&self) -> [[f64; 2]; 2] {
        let chain = [0.0, self.chain.length()];
        match &self.sweep {
            Sweep::Extruded { length: Some(length), .. } => [chain, [0.0, *length]],
            Sweep::Extruded { length: None, .. } => [chain, [f64::NEG_INFINITY, f64::INFINITY]],
            Sweep::Revolved(_) => [[-std::f64::consts::PI, std::f64::consts::PI], chain],
        }
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        match &self.sweep {
            Sweep::Extruded { origin, x, y, .. } => {
                let [point, along, bend] = self.chain.curve(xi[0]).map(|v| x * v.x + y * v.y);
                let out = x.cross(y);
                Local {
                    point: origin + point + out * xi[1],
                    tangents: [along, out],
                    second: [bend, Vec3::zeros(), Vec3::zeros()],
                }
            }
            Sweep::Revolved(axis) => axis.local(xi[0], self.chain.curve(xi[1])),
        }
    }

    fn normal(&self, xi: [f64; 2]) -> Vec3 {
        match &self.sweep {
            Sweep::Extruded { x, y, .. } => {
                let normal = self.chain.normal(xi[0]);
                x * normal.x + y * normal.y
            }
            Sweep::Revolved(axis) => axis.at_angle(xi[0], &self.chain.normal(xi[1])),
        }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        match &self.sweep {
            Sweep::Extruded { origin, x, y, length } => {
                let out = x.cross(y);
                let high = |k: usize, sign: f64| {
                    let along = match length {
                        Some(length) => (sign * out[k] * length).max(0.0),
                        None if out[k] == 0.0 => 0.0,
                        None => f64::INFINITY,
                    };
                    self.chain.support(&(Vec2::new(x[k], y[k]) * sign)) + along
                };
                (Vec3::from_fn(|k, _| origin[k] - high(k, -1.0)), Vec3::from_fn(|k, _| origin[k] + high(k, 1.0)))
            }
            Sweep::Revolved(axis) => axis.bounds(|direction| self.chain.support(&direction)),
        }
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let xi = match &self.sweep {
            Sweep::Extruded { origin, x: right, y: up, length } => {
                let (at, along) = split(x, origin, right, up);
                [self.chain.nearest(&at), length.map_or(along, |length| along.clamp(0.0, length))]
            }
            Sweep::Revolved(axis) => {
                let (at, e_r) = axis.split(x);
                [axis.angle(&e_r), self.chain.nearest(&at)]
            }
        };
        Closest::new(self, xi, x)
    }
}

/// The components of x - origin in the plane of the section, and across it.
fn split(x: &Vec3, origin: &Vec3, right: &Vec3, up: &Vec3) -> (Vec2, f64) {
    let arm = x - origin;
    (Vec2::new(arm.dot(right), arm.dot(up)), arm.dot(&right.cross(up)))
}
