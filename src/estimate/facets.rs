//! How far a tool of facets or patches may be from the surface that it stands for, where it is touched.

use crate::Vec3;
use crate::contact::{Slave, Status};
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::tool::Shape;
use mpi::topology::SimpleCommunicator;

/// The error of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfTool {
    /// Distance from the smooth surface, at most, of the pieces that are touched.
    pub length: f64,
    /// What that changes the force of the contact by, at most, where it is known how stiff it is, N.
    pub force: Option<f64>,
}

/// The slave nodes that touch a tool.
fn touching(model: &Model, t: usize) -> impl Iterator<Item = &Slave> {
    let pairs = model.pairs.iter().filter(move |pair| pair.master.tool() == Some(t));
    pairs.flat_map(|pair| &pair.slaves).filter(|slave| slave.accepted.status != Status::Gap)
}

impl OfTool {
    /// That of tool `t`; `None` where it is exact, and where nothing touches it. Collective.
    pub fn new(comm: &SimpleCommunicator, model: &Model, t: usize, stiffness: Option<f64>) -> Option<Self> {
        let mut most = [0.0f64];
        if let Shape::Patches(patches) = model.masters.tools[t].surface.near() {
            let touched = touching(model, t).filter_map(|slave| slave.accepted.projection.as_ref());
            let pieces = touched.filter_map(|p| patches.get(p.patch));
            most[0] = pieces.map(|piece| piece.deviation).fold(0.0, f64::max);
        }
        max(comm, &mut most);
        let length = most[0];
        (length > 0.0).then(|| Self { length, force: stiffness.map(|k| k * length) })
    }
}

/// How stiff the contact of a tool is against an approach, from what it did in the last increment in which it approached.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stiffness {
    /// Displacement of the tool and force on it at the last converged increment.
    last: Option<(Vec3, Vec3)>,
    /// dF/dg, force per length.
    pub value: Option<f64>,
}

crate::words!(Stiffness { last, value });

/// Part of a way along the normal of the contact, at least, for it to be an approach and not a slide.
const APPROACH: f64 = 0.1;

impl Stiffness {
    /// Learns of a converged increment of tool `t`, which bears `force`. Collective.
    pub fn learn(&mut self, comm: &SimpleCommunicator, model: &Model, t: usize, force: &Vec3) {
        let mut sums = [0.0; 3];
        for slave in touching(model, t) {
            let normal =
                slave.accepted.projection.map_or(Vec3::zeros(), |p| p.normal * slave.accepted.force.dot(&p.normal));
            (0..3).for_each(|d| sums[d] += normal[d]);
        }
        sum(comm, &mut sums);
        let now = (model.masters.tools[t].displacement(), *force);
        let before = self.last.replace(now);
        let (Some(normal), Some(before)) = (Vec3::from(sums).try_normalize(0.0), before) else { return };
        let way = now.0 - before.0;
        // The force on the tool pushes it back.
        let [approach, more] = [-way.dot(&normal), (now.1 - before.1).dot(&normal)];
        if approach.abs() > APPROACH * way.norm() && more * approach > 0.0 {
            self.value = Some(more / approach);
        }
    }
}
