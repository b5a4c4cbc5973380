//! The planes of symmetry of bodies, found from the groups that lie in them.

use super::Model;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::flat::Moments;
use crate::parallel::{max, sum};
use crate::partition::Part;
use crate::partition::parcels::{bounds, hull};
use crate::scene::{Located, Scene, body_of};
use mpi::topology::SimpleCommunicator;
use std::cmp::{Ordering, Reverse};
use std::collections::HashSet;

/// A plane in which a body ends and goes on as its mirror image.
#[derive(Clone, Debug)]
pub struct SymmetryPlane {
    /// The nodes in it.
    pub set: Located<String>,
    /// A unit vector.
    pub normal: Vec3,
    /// n·x of its points.
    pub at: f64,
    /// How far the body reaches from there, along the normal; negative on the other side.
    pub extent: f64,
}

impl SymmetryPlane {
    /// Whether a point of its body's initial mesh is in it.
    pub fn has(&self, x: &Vec3) -> bool {
        (self.normal.dot(x) - self.at).abs() <= THIN * self.extent.abs()
    }
}

/// How far nodes may be off a plane, over the size of their body, and over its extent across the plane, if that is less.
const FLAT: f64 = 1e-6;
const THIN: f64 = 1e-3;
/// Sine of the angle between planes below which they are one.
const ALIKE: f64 = 1e-6;
const AXES: usize = 3;
/// How far nodes are off a plane that is meant, over how far they may be: their coordinates lack a digit or two.
const MANY: f64 = 100.0;
const WHOLE: &str = "name a group with all the faces in a plane of symmetry";

/// A group that is to lie in a plane of symmetry.
struct Group<'a> {
    body: usize,
    set: &'a Located<String>,
    points: Vec<Vec3>,
    /// Corners of a box around its body.
    hull: (Vec3, Vec3),
}

/// How a group lies in a plane, or near it.
#[derive(Clone, Copy)]
struct Flat {
    normal: Vec3,
    at: f64,
    extent: f64,
    /// The body is on both sides.
    is_inside: bool,
    /// How far its nodes are from each other across the plane, and how far they may be.
    width: f64,
    slack: f64,
}

impl Flat {
    fn is_flat(&self) -> bool {
        self.width <= self.slack
    }
}

/// The planes of symmetry of all bodies. Collective.
///
/// # Errors
/// Groups that do not lie in a plane, or where the body lies on both sides, on all ranks.
pub(super) fn planes(
    comm: &SimpleCommunicator,
    scene: &Scene,
    names: &[Located<String>],
    part: &Part,
) -> Result<Vec<SymmetryPlane>> {
    let points_of = |set: &Located<String>| {
        let nodes = names.iter().position(|n| n.value == set.value).map_or(&[][..], |k| &part.sets[k].nodes);
        nodes.iter().map(|n| part.points[*n as usize]).collect()
    };
    let mut groups = Vec::new();
    for (body, given) in scene.bodies.iter().enumerate().filter(|(_, given)| !given.symmetry.is_empty()) {
        let hull = hull(comm, bounds(part.owned_of(body).map(|n| part.points[n]))).unwrap_or_default();
        groups.extend(given.symmetry.iter().map(|set| Group { body, set, points: points_of(set), hull }));
    }
    // What is flat along an axis has that for its normal, to rounding.
    let mut normals: Vec<Vec3> = (0..AXES).map(|d| Vec3::ith(d, 1.0)).collect();
    for group in &groups {
        let (lowest, highest) = group.hull;
        let mut moments = Moments::of(&(0.5 * (lowest + highest)), group.points.iter().copied());
        sum(comm, &mut moments.0);
        normals.extend(moments.normal());
    }
    let flat: Vec<Vec<Flat>> = groups.iter().map(|group| flats(comm, part, group, &normals)).collect();
    // Bodies that end in one plane, each with coordinates that are rounded, have one normal: an axis, or that of most of them.
    let fit = |k: usize| {
        let found = || flat.iter().map(|of_group| of_group[k]).filter(Flat::is_flat);
        (k >= AXES, Reverse(found().count()), found().map(|flat| flat.width / flat.slack).sum::<f64>())
    };
    let mut order: Vec<usize> = (0..normals.len()).collect();
    order.sort_by(|&a, &b| fit(a).partial_cmp(&fit(b)).unwrap_or(Ordering::Equal));
    let mut planes = Vec::new();
    for (Group { body, set, .. }, of_group) in groups.iter().zip(&flat) {
        let mut own: Vec<Flat> = Vec::new();
        for flat in order.iter().map(|&k| of_group[k]).filter(Flat::is_flat) {
            if !own.iter().any(|other| other.normal.dot(&flat.normal).abs() > 0.5) {
                own.push(flat);
            }
        }
        let &[Flat { normal, at, extent, is_inside, .. }] = own.as_slice() else {
            let (lies, help) = match of_group.iter().min_by(|a, b| a.width.total_cmp(&b.width)) {
                _ if !own.is_empty() => ("lies in more than one plane".into(), WHOLE),
                Some(Flat { width, slack, .. }) if *width < MANY * slack => {
                    let lies =
                        format!("lies in no plane: its nodes are {width:.1e} apart across one, and may be {slack:.1e}");
                    (lies, "write the coordinates of the mesh with more digits")
                }
                _ => ("lies in no plane".into(), WHOLE),
            };
            return Err(Error::input(&set.at, format!("`{}` {lies}", set.value), help));
        };
        if is_inside {
            let what = format!("body `{}` lies on both sides of `{}`", scene.bodies[*body].name.value, set.value);
            return Err(Error::input(&set.at, what, "a plane of symmetry is where the mesh ends; mesh one side"));
        }
        planes.push(SymmetryPlane { set: (*set).clone(), normal, at, extent });
    }
    Ok(planes)
}

/// How a group lies in planes with these normals, or near them. Collective.
fn flats(comm: &SimpleCommunicator, part: &Part, group: &Group, normals: &[Vec3]) -> Vec<Flat> {
    let (lowest, highest) = group.hull;
    // Coordinates are rounded.
    let rounding = 8.0 * f64::EPSILON * lowest.amax().max(highest.amax());
    let size = (highest - lowest).norm();
    let along = |&normal: &Vec3| {
        let owned = part.owned_of(group.body).map(|n| part.points[n]);
        let [low, high] = heights(comm, group.points.iter().copied(), &normal);
        let [least, most] = heights(comm, owned, &normal);
        let slack = (FLAT * size).min(THIN * (most - least)) + rounding;
        let at = 0.5 * (low + high);
        let extent = if most - at > at - least { most - at } else { least - at };
        let is_inside = low > least + slack && high < most - slack;
        Flat { normal, at, extent, is_inside, width: high - low, slack }
    };
    normals.iter().map(along).collect()
}

/// The least and the largest n·x of points of all ranks. Collective.
fn heights(comm: &SimpleCommunicator, points: impl Iterator<Item = Vec3>, normal: &Vec3) -> [f64; 2] {
    let mut ends = [f64::NEG_INFINITY; 2];
    for height in points.map(|x| normal.dot(&x)) {
        ends = [ends[0].max(-height), ends[1].max(height)];
    }
    max(comm, &mut ends);
    [-ends[0], ends[1]]
}

impl Model {
    /// Where a surface of a body goes on as its mirror image: in planes of symmetry, and around the axis. The owned nodes there, one of
    /// those that are tied into one, with unit normals, at right angles where a node is in several planes.
    pub(super) fn mirrored(&self, surface: &str) -> Vec<(u32, Vec3)> {
        let of_body = self.symmetry.iter().filter(|plane| body_of(&plane.set.value) == body_of(surface));
        let nodes = |plane: &SymmetryPlane| self.set(&plane.set.value).nodes.iter().copied().collect();
        let planes: Vec<(Vec3, HashSet<u32>)> = of_body.map(|plane| (plane.normal, nodes(plane))).collect();
        let mut mirrored = Vec::new();
        for &n in &self.set(surface).nodes {
            let is_in = |(_, nodes): &&(Vec3, HashSet<u32>)| nodes.contains(&n);
            let normals = self
                .is_on_axis(n as usize)
                .then(Vec3::x)
                .into_iter()
                .chain(planes.iter().filter(is_in).map(|plane| plane.0));
            let mut own: Vec<Vec3> = Vec::new();
            for normal in normals {
                let rest = own.iter().fold(normal, |rest, other| rest - other * other.dot(&normal));
                own.extend(rest.try_normalize(ALIKE));
            }
            let node = self.part.tie[n as usize];
            mirrored.extend(own.into_iter().map(|normal| (node, normal)));
        }
        mirrored
    }
}

/// The planes (point, normal) of the symmetry of the body of `master` in which its faces with these nodes end.
pub(super) fn planes_of(symmetry: &[SymmetryPlane], master: &str, points: &[[f64; 3]]) -> Vec<(Vec3, Vec3)> {
    /// As far as the nodes of a surface may be off a plane in which it goes on.
    const NEAR: f64 = 1e-5;
    let of_body = symmetry.iter().filter(|plane| body_of(&plane.set.value) == body_of(master));
    let ends = |plane: &&SymmetryPlane| {
        let heights = || points.iter().map(|x| (plane.normal.dot(&Vec3::from(*x)) - plane.at).abs());
        let farthest = heights().fold(0.0, f64::max);
        farthest > 0.0 && heights().filter(|h| *h <= NEAR * farthest).count() > 1
    };
    of_body.filter(ends).map(|plane| (plane.normal * plane.at, plane.normal)).collect()
}
