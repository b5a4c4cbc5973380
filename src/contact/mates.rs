//! Contact from node to node: each slave node meets one node of the master for good, that at whose place it begins.
//!
//! It is the contact with a patch whose foot never leaves a corner: all of the force goes to the one node, the normal is
//! the nodal one of the master there, and the gap and the path are the distance of the two nodes along and across it,
//!
//! ```text
//!     g = n·(x_s - x_m)        x̄ = x_s - g n        x̃ = x_m + R (x_s - x_m) at the last converged increment,
//! ```
//!
//! where R turns as the [`Corner`] there has since: what goes along with a body that turns has not slid.

use super::element::Corner;
use super::segment::ends::STRAIGHT;
use super::{BodySurface, Slave};
use crate::surface::{Polygon, Projection, shortest};
use crate::{Mat3, Vec3};

/// How far from a slave node its mate may be, over the shortest edge of the master around it.
pub const APART: f64 = 0.1;

/// A node of the master: a corner of one of its patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mate {
    pub patch: u32,
    pub corner: usize,
    pub xi: [f64; 2],
}

impl Mate {
    /// The contact of a node at `position`.
    pub fn project(&self, surface: &BodySurface, position: &Vec3) -> Option<Projection> {
        let (place, normal) = self.stand(surface)?;
        let gap = normal.dot(&(position - place));
        Some(Projection {
            gap,
            point: position - normal * gap,
            normal,
            normal_gradient: Mat3::zeros(),
            patch: self.patch,
            xi: self.xi,
        })
    }

    /// How the master has turned here since the last converged increment.
    pub fn corner(&self, surface: &BodySurface) -> Option<Corner> {
        let (patch, stencil) = surface.patch(self.patch)?;
        let [before, now] = [&surface.before[..], surface.positions()]
            .map(|x| stencil.iter().map(|&n| x[n as usize]).collect::<Vec<_>>());
        Corner::new(patch, self.corner, [&before, &now])
    }

    /// x̃ for a slave node that was at `before` at the last converged increment.
    pub fn slip_origin(&self, surface: &BodySurface, before: &Vec3) -> Option<Vec3> {
        let corner = self.corner(surface)?;
        let (_, stencil) = surface.patch(self.patch)?;
        let then = surface.before[stencil[self.corner] as usize];
        Some(corner.place + corner.turn * (before - then))
    }

    /// How far a node at `position` has slid from it.
    pub fn aside(&self, surface: &BodySurface, position: &Vec3) -> Option<f64> {
        let (place, normal) = self.stand(surface)?;
        let away = position - place;
        Some((away - normal * normal.dot(&away)).norm())
    }

    /// Where the node of the master is, and its normal.
    fn stand(&self, surface: &BodySurface) -> Option<(Vec3, Vec3)> {
        let (patch, stencil) = surface.patch(self.patch)?;
        let nodes: Vec<Vec3> = stencil.iter().map(|&n| surface.positions()[n as usize]).collect();
        Some((nodes[self.corner], patch.normal(&nodes, self.corner)?))
    }
}

/// Why a slave node has no mate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lonely {
    /// The nearest node of the master is so far away.
    Far(f64),
    /// No face of the master at its node looks at those of the slave.
    Averted,
    /// The node of the master is on a sharp edge, of which both sides look at the slave.
    OnEdge,
}

/// Finds the mates of all slave nodes, which `place` puts in space, on the surface as it is; `faces` are the normals of the slave's
/// faces around a node.
///
/// # Errors
/// A node that has none, and why.
pub fn find<'a>(
    slaves: &mut [Slave],
    (surface, planar): (&BodySurface, bool),
    place: impl Fn(u32) -> Vec3,
    faces: impl Fn(u32) -> &'a [Vec3],
) -> Result<(), (u32, Lonely)> {
    for slave in slaves {
        let found = nearest((surface, planar), &place(slave.node), faces(slave.node));
        slave.mate = Some(found.map_err(|why| (slave.node, why))?);
    }
    Ok(())
}

/// The mate at `x`, on a patch that looks at one of the `faces` of the slave: around a node on an edge others do not.
fn nearest((surface, planar): (&BodySurface, bool), x: &Vec3, faces: &[Vec3]) -> Result<Mate, Lonely> {
    /// Over the shortest edge: nodes of patches that share one are as near as that.
    const SAME: f64 = 1e-6;
    let (shapes, around) = (surface.shapes(), Vec3::repeat(surface.facet_size));
    let mut near = Vec::new();
    for patch in shapes.within(&(x - around), &(x + around)).into_iter().map(|k| &shapes.pieces()[k as usize]) {
        let count = patch.count as usize;
        let shortest = shortest((0..count).map(|k| patch.nodes[(k + 1) % count] - patch.nodes[k]), planar);
        for corner in 0..count {
            let mate = Mate { patch: patch.id, corner, xi: patch.corners(&[0.0; 4])[corner] };
            near.push(((patch.nodes[corner] - x).norm(), shortest, mate));
        }
    }
    let least = near.iter().map(|(distance, ..)| *distance).fold(f64::INFINITY, f64::min);
    near.retain(|(distance, shortest, _)| *distance <= least + SAME * shortest && *distance < APART * shortest);
    if near.is_empty() {
        return Err(Lonely::Far(least));
    }
    let faces_it = |normal: &Vec3| faces.iter().map(|face| -face.dot(normal)).fold(0.0, f64::max);
    let with_normal = |(.., mate): &(f64, f64, Mate)| {
        let (_, normal) = mate.stand(surface)?;
        Some((faces_it(&normal), normal, *mate))
    };
    let facing: Vec<_> = near.iter().filter_map(with_normal).filter(|(cosine, ..)| *cosine > STRAIGHT).collect();
    let (_, normal, mate) = facing.iter().max_by(|a, b| a.0.total_cmp(&b.0)).ok_or(Lonely::Averted)?;
    match facing.iter().all(|(_, other, _)| (other - normal).norm() < SAME) {
        true => Ok(*mate),
        false => Err(Lonely::OnEdge),
    }
}
