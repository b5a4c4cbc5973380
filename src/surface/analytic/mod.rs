//! Surfaces with closed forms.
//!
//! [`Plane`], [`Cylinder`], [`Sphere`], [`Cone`] and [`Torus`], and the [`Profile`] of lines and arcs, of which the others
//! are special cases. All but the plane are solid inside, or `hollow`: then they are bores and the normals turn round.
//! Where many points are equally close, on the axis of a bore or in the centre of a ball, one of them is taken.

mod axis;
mod chain;
mod cone;
mod corners;
mod plane;
mod profile;
mod round;
mod section;
#[cfg(test)]
mod tests;
mod torus;

pub use axis::Axis;
pub use chain::Chain;
pub use cone::Cone;
pub use corners::Misfit;
pub use plane::Plane;
pub use profile::{Profile, ROUNDED, Sweep};
pub use round::{Cylinder, Sphere};
pub use torus::Torus;

use super::{Closest, Even, Parametric, Projection, Tessellation};
use crate::{Mat3, Vec2, Vec3};

/// One of the surfaces with closed forms.
#[derive(Clone, Debug, PartialEq)]
pub enum Analytic {
    Plane(Plane),
    Cylinder(Cylinder),
    Cone(Cone),
    Sphere(Sphere),
    Torus(Torus),
    Profile(Profile),
}

/// Distances that differ by less, over the size of the coordinates, are equal.
const NEARLY: f64 = 1e-12;

impl Analytic {
    /// Closest point to `x` within the distance `reach`; `kept` is [`Projection::patch`] of the last projection, which
    /// stays in a tie. `None` when there is none, or beyond an end of a profile.
    pub fn closest(&self, x: &Vec3, reach: f64, kept: Option<u32>) -> Option<Projection> {
        let projection = match self {
            Self::Plane(plane) => plane.project(x),
            Self::Cylinder(cylinder) => cylinder.project(x),
            Self::Cone(cone) => cone.project(x),
            Self::Sphere(sphere) => sphere.project(x),
            Self::Torus(torus) => torus.project(x),
            Self::Profile(profile) => profile.project(x, kept)?,
        };
        (projection.gap.abs() <= reach).then_some(projection)
    }

    /// Where `x`, whose closest point is `at`, is exactly between the sides of a sharp edge, or in a tip on an axis of revolution:
    /// the projections onto these sides, or onto the planes that touch the tip at four places around, with equal shares. None where two
    /// of them are not one for it.
    pub fn evenly(&self, x: &Vec3, at: &Projection, even: &Even) -> Vec<(Projection, f64)> {
        let found = match self {
            Self::Cone(cone) => cone.around(x, at, even.reach),
            Self::Profile(profile) => profile.evenly(x, at),
            _ => Vec::new(),
        };
        let mut pairs = found.iter().flat_map(|a| found.iter().map(move |b| [&a.normal, &b.normal]));
        let is_edge = pairs.clone().any(|[a, b]| a.dot(b) < 1.0 - NEARLY);
        if !is_edge || !pairs.all(|[a, b]| even.joins(a, b)) || found.iter().all(|p| p.patch != at.patch) {
            return Vec::new();
        }
        found.into_iter().map(|p| (p, 1.0)).collect()
    }

    /// The point nearest to `x`, ends of a profile included: beside an end the normal points along the line between `x` and
    /// the end. `None` when `x` is not finite.
    pub fn nearest(&self, x: &Vec3) -> Option<Projection> {
        let Closest { xi, point, distance } = self.parametric().closest(x);
        let projection = self.closest(x, f64::INFINITY, None);
        if let Some(projection) = projection.filter(|p| p.gap.abs() <= distance + NEARLY * (distance + x.amax())) {
            return Some(projection);
        }
        let (arm, own) = (x - point, self.parametric().normal(xi));
        let gap = distance.copysign(arm.dot(&own));
        let normal = arm.try_normalize(0.0).map_or(own, |direction| direction * gap.signum());
        gap.is_finite().then_some(Projection { gap, point, normal, normal_gradient: Mat3::zeros(), patch: 0, xi })
    }

    /// The normal at the point next to `x`, and its distance. At a corner it is the normal of the side that is the most along
    /// `like`, whichever its sign.
    pub fn side_normal(&self, x: &Vec3, like: &Vec3) -> (Vec3, f64) {
        let normal = match self {
            Self::Plane(plane) => plane.normal,
            Self::Cylinder(cylinder) => cylinder.project(x).normal,
            Self::Cone(cone) => cone.side_normal(x, like),
            Self::Sphere(sphere) => sphere.project(x).normal,
            Self::Torus(torus) => torus.project(x).normal,
            Self::Profile(profile) => profile.side_normal(x, like),
        };
        (normal, self.parametric().closest(x).distance)
    }

    /// The surface by its parameters.
    pub fn parametric(&self) -> &dyn Parametric {
        match self {
            Self::Plane(plane) => plane,
            Self::Cylinder(cylinder) => cylinder,
            Self::Cone(cone) => cone,
            Self::Sphere(sphere) => sphere,
            Self::Torus(torus) => torus,
            Self::Profile(profile) => profile,
        }
    }

    /// Moves the point that says where a surface without end is along it, to beside `middle`, if it is farther away than
    /// `most`: coordinates are rounded there, and the surface stays the same. Gives the way, if it rounds, which that along a
    /// coordinate does not.
    pub fn settle(&mut self, middle: &Vec3, most: f64) -> f64 {
        let across = |normal: &Vec3| Mat3::identity() - normal * normal.transpose();
        let (point, free) = match self {
            Self::Plane(plane) => (&mut plane.point, across(&plane.normal)),
            Self::Cylinder(cylinder) => (&mut cylinder.point, cylinder.axis * cylinder.axis.transpose()),
            Self::Profile(Profile { sweep: Sweep::Extruded { origin, x, y, length: None }, .. }) => {
                let out = x.cross(y);
                (origin, out * out.transpose())
            }
            _ => return 0.0,
        };
        let way = free * (middle - *point);
        if way.norm() <= most {
            return 0.0;
        }
        *point += way;
        // A component that the projection leaves or takes away is exact.
        let rounds = |k: usize| (0..3).any(|j| ![0.0, 1.0].contains(&free[(j, k)].abs()));
        (0..3).filter(|k| rounds(*k)).map(|k| way[k].abs()).fold(0.0, f64::max)
    }

    /// The largest number that says where the surface is: its distance from the origin, and its size.
    pub fn far(&self) -> f64 {
        match self {
            Self::Plane(plane) => plane.point.amax(),
            Self::Cylinder(cylinder) => cylinder.point.amax().max(cylinder.radius),
            Self::Cone(cone) => cone.apex.amax(),
            Self::Sphere(sphere) => sphere.center.amax().max(sphere.radius),
            Self::Torus(torus) => torus.center.amax().max(torus.radius),
            Self::Profile(Profile { chain, sweep }) => {
                let place = match sweep {
                    Sweep::Extruded { origin, .. } => origin.amax(),
                    Sweep::Revolved(axis) => axis.point.amax(),
                };
                let ends = [Vec2::x(), -Vec2::x(), Vec2::y(), -Vec2::y()];
                ends.iter().map(|end| chain.support(end)).fold(place, f64::max)
            }
        }
    }

    /// The surface for display, circles in `segments` pieces; what has no end is cut to about the box from `low` to
    /// `high`.
    pub fn tessellate(&self, segments: usize, low: &Vec3, high: &Vec3) -> Tessellation {
        Tessellation::of_grid(self.parametric(), &self.grid(segments.max(4), low, high))
    }

    /// Values of the parameters between which the surface is nearly flat.
    fn grid(&self, segments: usize, low: &Vec3, high: &Vec3) -> [Vec<f64>; 2] {
        let spread = |[from, to]: [f64; 2], count: usize| -> Vec<f64> {
            (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
        };
        let [u, v] = self.parametric().domain();
        match self {
            Self::Plane(plane) => {
                super::normals::tangents(&plane.normal).map(|t| range(&plane.point, &t, low, high).to_vec())
            }
            Self::Cylinder(c) => [spread(u, segments), range(&c.point, &c.axis, low, high).to_vec()],
            Self::Cone(cone) => {
                let [from, to] = range(&cone.apex, &cone.axis, low, high);
                let to = if to > 0.0 { to } else { to - from };
                [spread(u, segments), [from.max(0.0), to].map(|height| height / cone.angle.cos()).to_vec()]
            }
            Self::Sphere(_) => [spread(u, segments), spread(v, segments / 2)],
            Self::Torus(_) => [spread(u, segments), spread(v, segments)],
            Self::Profile(Profile { chain, sweep }) => match sweep {
                Sweep::Extruded { length: Some(_), .. } => [chain.stations(segments), v.to_vec()],
                Sweep::Extruded { origin, x, y, .. } => {
                    [chain.stations(segments), range(origin, &x.cross(y), low, high).to_vec()]
                }
                Sweep::Revolved(_) => [spread(u, segments), chain.stations(segments)],
            },
        }
    }
}

/// Least and greatest coordinate of the corners of a box along `direction` from `origin`.
fn range(origin: &Vec3, direction: &Vec3, low: &Vec3, high: &Vec3) -> [f64; 2] {
    let middle = ((low + high) * 0.5 - origin).dot(direction);
    let half = ((high - low) * 0.5).abs().dot(&direction.abs());
    [middle - half, middle + half]
}
