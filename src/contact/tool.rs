//! A rigid tool on this rank: where it is, and its surface as far as this rank's slave nodes can meet it.

use super::{Pair, Pose};
use crate::Vec3;
use crate::controls::Controls;
use crate::error::Result;
use crate::scene;
use crate::surface::{Even, Projection, Sides, Way};
use crate::tool::Surface;
use mpi::topology::SimpleCommunicator;

/// A rigid tool.
pub struct Tool {
    pub name: String,
    /// In the tool's frame.
    pub surface: Surface,
    /// Pose at the last converged increment.
    pub committed: Pose,
    /// Pose of the current iterate.
    pub trial: Pose,
}

impl Tool {
    /// Reads the surface that the scene chooses. Collective.
    ///
    /// # Errors
    /// A surface that cannot be read, on all ranks.
    pub fn new(comm: &SimpleCommunicator, tool: &scene::Tool, controls: &Controls) -> Result<Self> {
        Ok(Self {
            name: tool.name.value.clone(),
            surface: Surface::new(comm, tool, tool.smoothing.value, controls)?,
            committed: Pose::default(),
            trial: Pose::default(),
        })
    }

    /// The way over the tool, in its frame, of a point that was at `from` at the last converged increment and is at `to`.
    pub fn way(&self, from: &Vec3, to: &Vec3) -> Vec3 {
        self.trial.inward(to) - self.committed.inward(from)
    }

    /// How far it has moved since the beginning, at the last converged increment: where it turns, the axis of that.
    pub fn displacement(&self) -> Vec3 {
        self.committed.displacement()
    }

    /// Where its node stands: 0 is its translation, with a torque that of the axis, 1, in the first component, its rotation by the
    /// torque, as its unknown has it.
    pub fn place(&self, node: u32) -> Vec3 {
        match node {
            0 => self.trial.axle_in_space().map_or(self.trial.translation, |axle| axle.point),
            _ => Vec3::x() * (self.trial.turned * self.trial.axle.map_or(0.0, |axle| axle.lever)),
        }
    }

    /// Closest point of the tool at its trial pose to a point in space; the search starts at patch `warm`, to which the point
    /// may keep at a kink.
    pub fn project(
        &self,
        point: &Vec3,
        reach: f64,
        (warm, keeps): (Option<(u32, [f64; 2])>, bool),
    ) -> Option<Projection> {
        self.surface.project(&self.trial.inward(point), reach, (warm, keeps)).map(|p| self.in_space(&p))
    }

    /// Whether a point in space that the tool has `at` is past an end of it by more than `aside`.
    pub fn is_past_end(&self, point: &Vec3, at: &Projection, aside: f64) -> bool {
        let own = Projection { point: self.trial.inward(&at.point), ..*at };
        self.surface.near().is_past_end(&self.trial.inward(point), &own, aside)
    }

    /// Where a point in space that the tool has `at` is exactly between pieces of it: see [`crate::surface::PieceSet::evenly`].
    pub fn evenly(&self, point: &Vec3, at: &Projection, even: &Even) -> Vec<(Projection, f64)> {
        let [x, place] = [point, &at.point].map(|x| self.trial.inward(x));
        let own = Projection { normal: self.trial.rotation.tr_mul(&at.normal), point: place, ..*at };
        let even = Even { outward: self.trial.rotation.tr_mul(&even.outward), ..*even };
        let found = self.surface.near().evenly(&x, &own, &even);
        found.iter().map(|(p, angle)| (self.in_space(p), *angle)).collect()
    }

    /// The points of a point in space on given pieces of the tool that make a hollow: see [`crate::surface::PieceSet::hollow`].
    pub fn hollow(&self, point: &Vec3, ids: &[u32], turn: f64) -> Vec<Projection> {
        let found = self.surface.near().hollow(&self.trial.inward(point), ids, turn);
        found.iter().map(|p| self.in_space(p)).collect()
    }

    /// Perpendiculars from a point in space to all pieces of the tool at its trial pose, no longer than `most`; they may miss a piece
    /// by a distance of `aside`.
    pub fn perpendiculars(&self, point: &Vec3, most: f64, aside: f64) -> Vec<Projection> {
        let feet = self.surface.near().perpendiculars(&self.trial.inward(point), most, aside);
        feet.iter().map(|p| self.in_space(p)).collect()
    }

    /// The side that a point in space, `found` behind the tool at its trial pose, has come through; at the
    /// last converged increment it was at a `place` in the tool's frame, and had a `normal` in space.
    pub fn entrance(
        &self,
        point: &Vec3,
        found: &Projection,
        (place, normal): (&Vec3, Option<Vec3>),
        sides: Sides,
    ) -> Option<Projection> {
        let turn = self.trial.rotation * self.committed.rotation.transpose();
        let place = self.trial.outward(place);
        let way = Way { place: &|_| Some(place), normal: normal.map(|normal| turn * normal), sides };
        way.entrance(point, found, |most| self.perpendiculars(point, most, sides.aside))
    }

    /// A projection in the tool's frame, in space at the trial pose.
    fn in_space(&self, p: &Projection) -> Projection {
        let r = self.trial.rotation;
        Projection {
            point: self.trial.outward(&p.point),
            normal: r * p.normal,
            normal_gradient: r * p.normal_gradient * r.transpose(),
            ..*p
        }
    }

    /// Fetches what is within `reach` of all the slave nodes of its pairs, which `place` puts in space, at its trial pose. Says
    /// whether it had to. Collective.
    pub fn watch<'a>(
        &mut self,
        comm: &SimpleCommunicator,
        pairs: impl Iterator<Item = &'a Pair>,
        reach: f64,
        place: impl Fn(u32) -> Vec3,
    ) -> bool {
        let points: Vec<Vec3> =
            pairs.flat_map(|pair| &pair.slaves).map(|slave| self.trial.inward(&place(slave.node))).collect();
        self.surface.watch(comm, &points, reach)
    }
}
