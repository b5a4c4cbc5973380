//! Contact from node to node: each slave node meets one node of the master for good, that at whose place it begins.
//!
//! It is the contact with a patch whose foot never leaves a corner: all of the force goes to the one node, the normal is
//! that of the master there, and the gap and the path are the distance of the two nodes along and across it,
//!
//! ```text
//!     g = n·(x_s - x_m)        x̄ = x_s - g n        x̃ = x_m + R (x_s - x_m) at the last converged increment,
//! ```
//!
//! where R turns as the master's frame there has since: what goes along with a body that turns has not slid.

use super::element::upright;
use super::{BodySurface, Slave};
use crate::surface::{Polygon, Projection};
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
        let (place, frame) = self.stand(surface, surface.positions())?;
        let normal: Vec3 = frame.column(2).into();
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

    /// x̃ for a slave node that was at `before` at the last converged increment.
    pub fn slip_origin(&self, surface: &BodySurface, before: &Vec3) -> Option<Vec3> {
        let (now, frame) = self.stand(surface, surface.positions())?;
        let (then, before_that) = self.stand(surface, &surface.before)?;
        Some(now + frame * before_that.tr_mul(&(before - then)))
    }

    /// How far a node at `position` has slid from it.
    pub fn aside(&self, surface: &BodySurface, position: &Vec3) -> Option<f64> {
        let (place, frame) = self.stand(surface, surface.positions())?;
        Some(frame.tr_mul(&(position - place)).xy().norm())
    }

    /// Where the node of the master is, and the frame of its patch there, with the normal as the last column.
    fn stand(&self, surface: &BodySurface, positions: &[Vec3]) -> Option<(Vec3, Mat3)> {
        let (patch, stencil) = surface.patch(self.patch)?;
        let nodes: Vec<Vec3> = stencil.iter().map(|&n| positions[n as usize]).collect();
        let local = patch.shape(&nodes).local(self.xi);
        Some((nodes[self.corner], upright(&local)?))
    }
}

/// Finds the mates of all slave nodes, which `place` puts in space, on the surface as it is.
///
/// # Errors
/// A node that has none, and how far it is from the nearest node of the master, in words.
pub fn find(slaves: &mut [Slave], surface: &BodySurface, place: impl Fn(u32) -> Vec3) -> Result<(), (u32, String)> {
    for slave in slaves {
        let (found, distance) = nearest(surface, &place(slave.node));
        if found.is_none() {
            let told = match distance.is_finite() {
                true => format!("the nearest is {distance:.3e} away"),
                false => "there is none near".into(),
            };
            return Err((slave.node, told));
        }
        slave.mate = found;
    }
    Ok(())
}

/// The mate at `x`, on the first of the patches that share it, and the distance of the nearest node of the master.
fn nearest(surface: &BodySurface, x: &Vec3) -> (Option<Mate>, f64) {
    let (shapes, around) = (surface.shapes(), Vec3::repeat(surface.facet_size));
    let (mut found, mut least) = (None, f64::INFINITY);
    for patch in shapes.within(&(x - around), &(x + around)).into_iter().map(|k| &shapes.pieces()[k as usize]) {
        let count = patch.count as usize;
        let edge = |k: usize| (patch.nodes[(k + 1) % count] - patch.nodes[k % count]).norm();
        let shortest = (0..count).map(edge).fold(f64::INFINITY, f64::min);
        for corner in 0..count {
            let distance = (patch.nodes[corner] - x).norm();
            if distance >= least {
                continue;
            }
            least = distance;
            if distance < APART * shortest {
                found = Some(Mate { patch: patch.id, corner, xi: patch.corners(&[0.0; 4])[corner] });
            }
        }
    }
    (found, least)
}
