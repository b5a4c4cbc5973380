//! Where a rigid tool is: rotation and translation of its own frame.

use crate::scene::Rotation;
use crate::{Mat3, Vec3};
use nalgebra::{Rotation3, Unit};

/// x = rotation X + translation takes the tool's frame, in which its surface was read, to space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub rotation: Mat3,
    pub translation: Vec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self { rotation: Mat3::identity(), translation: Vec3::zeros() }
    }
}

impl Pose {
    /// A point of the tool's frame in space.
    pub fn outward(&self, point: &Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }

    /// A point of space in the tool's frame.
    pub fn inward(&self, point: &Vec3) -> Vec3 {
        self.rotation.tr_mul(&(point - self.translation))
    }

    /// The pose after rotating by `fraction` of a rotation and moving by `by`.
    pub fn moved(&self, by: &Vec3, rotation: Option<&Rotation>, fraction: f64) -> Self {
        let mut pose = *self;
        if let Some(r) = rotation {
            let angle = (r.angle * fraction).to_radians();
            let turn = *Rotation3::from_axis_angle(&Unit::new_normalize(r.axis), angle).matrix();
            pose.rotation = turn * self.rotation;
            pose.translation = turn * (self.translation - r.point) + r.point;
        }
        pose.translation += by * fraction;
        pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_an_axis_off_the_origin() {
        let turn = Rotation { point: Vec3::new(1.0, 0.0, 0.0), axis: Vec3::new(0.0, 0.0, 2.0), angle: 180.0 };
        let pose = Pose::default().moved(&Vec3::new(0.0, 0.0, 4.0), Some(&turn), 0.5);
        let x = Vec3::new(2.0, 0.0, 0.0);
        assert!((pose.outward(&x) - Vec3::new(1.0, 1.0, 2.0)).norm() < 1e-15);
        assert!((pose.inward(&pose.outward(&x)) - x).norm() < 1e-15);
    }
}
