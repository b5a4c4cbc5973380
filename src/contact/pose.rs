//! Where a rigid tool is: rotation and translation of its own frame.

use crate::{Mat3, Vec3};
use nalgebra::{Rotation3, Unit};

/// A rotation about an axis, a unit vector.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// A point of the axis but for what forces have moved the tool by, which nobody knows beforehand.
    pub point: Vec3,
    pub axis: Vec3,
    /// Degrees, right-handed.
    pub angle: f64,
}

impl Rotation {
    /// Whether its axis is this one of x, y and z.
    pub fn is_along(&self, d: usize) -> bool {
        are_along(&self.axis.normalize(), &Vec3::ith(d, 1.0))
    }
}

/// Whether two unit vectors lie on one line, but for rounding.
pub fn are_along(a: &Vec3, b: &Vec3) -> bool {
    1.0 - a.dot(b).abs() < 1e-14
}

/// An axis about which a torque turns a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axle {
    pub point: Vec3,
    /// A unit vector.
    pub axis: Vec3,
    /// A length: the unknown of the rotation is the angle times it.
    pub lever: f64,
}

crate::words!(Axle { point, axis, lever });

impl Axle {
    /// 1 if its axis has this direction, a unit vector, and -1 if it has the opposite one.
    pub fn sense(&self, direction: &Vec3) -> Option<f64> {
        const ONE: f64 = 1e-9;
        let sense = self.axis.dot(direction).signum();
        ((self.axis * sense - direction).norm() < ONE).then_some(sense)
    }

    /// The same if another axis is on its line, too.
    pub fn sense_on_line(&self, other: &Self) -> Option<f64> {
        // Over the lever: points are as exact as scenes have them.
        const ON: f64 = 1e-6;
        let aside = self.axis.cross(&(other.point - self.point)).norm();
        self.sense(&other.axis).filter(|_| aside <= ON * self.lever)
    }

    /// How fast the point `x` moves with the unknown of the rotation: a x (x - p) / lever.
    pub fn velocity(&self, x: &Vec3) -> Vec3 {
        self.axis.cross(&(x - self.point)) / self.lever
    }

    /// How fast a direction on the tool turns with it: a / lever.
    pub fn turn(&self) -> Vec3 {
        self.axis / self.lever
    }

    /// The moment about it, over the lever, of a force with its moment about the origin.
    pub fn drive(&self, force: &Vec3, moment: &Vec3) -> f64 {
        self.axis.dot(&(moment - self.point.cross(force))) / self.lever
    }
}

/// x = rotation X + translation takes the tool's frame, in which its surface was read, to space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub rotation: Mat3,
    pub translation: Vec3,
    /// What forces have moved it by, of all its ways.
    pub driven: Vec3,
    /// What torques have turned it by, each about its axis, radians.
    pub turned: f64,
    /// What of that does not count about the axis of the torque, or of the last one.
    pub before: f64,
    /// The axis about which a torque turns it, or did last, in the tool's frame.
    pub axle: Option<Axle>,
    /// A point of the first axis about which anything turned it, in the tool's frame.
    pub center: Vec3,
}

crate::words!(Pose { rotation, translation, driven, turned, before, axle, center });

impl Default for Pose {
    fn default() -> Self {
        let (rotation, still) = (Mat3::identity(), Vec3::zeros());
        Self { rotation, translation: still, driven: still, turned: 0.0, before: 0.0, axle: None, center: still }
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
            let point = r.point + self.driven;
            pose.translation = turn * (self.translation - point) + point;
            pose.center = self.center_of_turn(&point);
        }
        pose.translation += by * fraction;
        pose
    }

    /// The pose after a force has moved it by `offset`.
    pub fn driven_by(&self, offset: &Vec3) -> Self {
        Self { translation: self.translation + offset, driven: self.driven + offset, ..*self }
    }

    /// The pose after a torque has turned it about an axis in space by an angle, radians.
    pub fn turned_by(&self, axle: &Axle, angle: f64) -> Self {
        let turn = *Rotation3::from_axis_angle(&Unit::new_unchecked(axle.axis), angle).matrix();
        let rotation = turn * self.rotation;
        let translation = turn * (self.translation - axle.point) + axle.point;
        let center = self.center_of_turn(&axle.point);
        let before = match self.axle_in_space().and_then(|old| old.sense(&axle.axis)) {
            Some(1.0) => self.before,
            // What it has turned the other way.
            Some(_) => 2.0 * self.turned - self.before,
            None => self.turned,
        };
        let mut pose = Self { rotation, translation, turned: self.turned + angle, before, center, ..*self };
        let (point, axis) = (pose.inward(&axle.point), rotation.tr_mul(&axle.axis));
        pose.axle = Some(Axle { point, axis, ..*axle });
        pose
    }

    /// What torques have turned it by about the axis of the torque, or of the last one, since there was one along it, radians.
    pub fn turned_about_axle(&self) -> f64 {
        self.turned - self.before
    }

    /// The center once it turns about an axis through a point in space. As long as nothing has turned it all points go the same way.
    fn center_of_turn(&self, point: &Vec3) -> Vec3 {
        if self.rotation == Mat3::identity() { self.inward(point) } else { self.center }
    }

    /// How far its center is from where that was at first.
    pub fn displacement(&self) -> Vec3 {
        self.outward(&self.center) - self.center
    }

    /// The axis of its torque in space.
    pub fn axle_in_space(&self) -> Option<Axle> {
        self.axle.map(|axle| Axle { point: self.outward(&axle.point), axis: self.rotation * axle.axis, ..axle })
    }

    /// The moment about that axis, over its lever, of a force on it with its moment about the origin; 0 without an axis.
    pub fn drive(&self, force: &Vec3, moment: &Vec3) -> f64 {
        self.axle_in_space().map_or(0.0, |axle| axle.drive(force, moment))
    }

    /// Angle by which `other` is turned against it, in 0 to pi.
    pub fn angle(&self, other: &Self) -> f64 {
        Rotation3::from_matrix_unchecked(other.rotation * self.rotation.transpose()).angle()
    }

    /// Poses on the way to `end`, in parts of which it turns by no more than `part`, radians; none where it does not turn.
    pub fn turning(&self, end: &Self, part: f64) -> Vec<Self> {
        let parts = (self.angle(end) / part).ceil();
        if parts < 2.0 {
            return Vec::new();
        }
        (0..=parts as usize).map(|k| self.toward(end, k as f64 / parts)).collect()
    }

    /// The pose at a fraction of the screw motion to `other`.
    pub fn toward(&self, other: &Self, fraction: f64) -> Self {
        let turn = other.rotation * self.rotation.transpose();
        let way = other.translation - turn * self.translation;
        let Some((axis, angle)) = Rotation3::from_matrix_unchecked(turn).axis_angle() else {
            return Self { translation: self.translation + way * fraction, ..*self };
        };
        let along = axis.into_inner() * axis.dot(&way);
        let across = way - along;
        // The fixed point c of the part across the axis: c - Q c is that part.
        let point = (across + axis.cross(&across) / (0.5 * angle).tan()) * 0.5;
        let turn = *Rotation3::from_axis_angle(&axis, angle * fraction).matrix();
        let translation = turn * (self.translation - point) + point + along * fraction;
        Self { rotation: turn * self.rotation, translation, ..*self }
    }
}

/// The way of a node, which goes straight, in the frame of a tool at these poses on its way.
pub fn way_past(poses: &[Pose], from: &Vec3, to: &Vec3) -> Vec<Vec3> {
    let part = 1.0 / (poses.len() - 1) as f64;
    poses.iter().enumerate().map(|(k, pose)| pose.inward(&(from + (to - from) * (k as f64 * part)))).collect()
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

    #[test]
    fn the_axis_goes_along_with_what_forces_move() {
        let turn = Rotation { point: Vec3::new(1.0, 0.0, 2.0), axis: Vec3::new(0.0, 1.0, 0.0), angle: 70.0 };
        let offset = Vec3::new(0.0, 0.0, -0.3);
        let pose = Pose::default().driven_by(&offset).moved(&Vec3::new(0.5, 0.0, 0.0), Some(&turn), 1.0);
        let middle = turn.point + offset + Vec3::new(0.5, 0.0, 0.0);
        assert!((pose.outward(&turn.point) - middle).norm() < 1e-15);
        assert_eq!(pose.driven, offset);
    }

    #[test]
    fn a_torque_turns_about_an_axis_that_stays() {
        let axle = Axle { point: Vec3::new(1.0, 0.0, 2.0), axis: Vec3::new(0.0, 0.6, 0.8), lever: 2.0 };
        let start = Pose::default().driven_by(&Vec3::new(0.3, -0.2, 0.1));
        let pose = start.turned_by(&axle, 0.4).turned_by(&axle, 0.3);
        let found = pose.axle_in_space().unwrap();
        assert!((found.point - axle.point).norm() + (found.axis - axle.axis).norm() < 1e-14);
        assert_eq!(pose.turned_about_axle(), pose.turned);
        assert!((pose.turned - 0.7).abs() < 1e-15 && (start.angle(&pose) - 0.7).abs() < 1e-14);
        let (x, h) = (Vec3::new(-0.4, 2.0, 1.0), 1e-6);
        let at = |way: f64| start.turned_by(&axle, way / axle.lever).outward(&start.inward(&x));
        assert!(((at(h) - at(-h)) / (2.0 * h) - axle.velocity(&x)).norm() < 1e-9);
    }

    #[test]
    fn turns_count_about_the_axis_of_the_torque() {
        let axle = Axle { point: Vec3::new(1.0, 0.0, 2.0), axis: Vec3::new(0.0, 0.6, 0.8), lever: 2.0 };
        let [back, beside, across] = [
            Axle { axis: -axle.axis, ..axle },
            Axle { point: axle.point + Vec3::x(), ..axle },
            Axle { axis: Vec3::x(), ..axle },
        ];
        let along = Axle { point: axle.point + axle.axis * 3.0, ..back };
        assert_eq!(axle.sense_on_line(&axle), Some(1.0));
        assert_eq!(axle.sense_on_line(&along), Some(-1.0));
        assert_eq!([axle.sense_on_line(&beside), axle.sense_on_line(&across)], [None, None]);
        let mut pose = Pose::default();
        for (axle, angle, about) in [
            (axle, 0.4, 0.4),
            (back, 0.1, -0.3),
            (back, 0.2, -0.1),
            (beside, 0.2, 0.3),
            (across, 0.5, 0.5),
            (axle, 0.1, 0.1),
        ] {
            pose = pose.turned_by(&axle, angle);
            assert!((pose.turned_about_axle() - about).abs() < 1e-15, "{about}");
        }
        assert!((pose.turned - 1.5).abs() < 1e-15);
    }

    #[test]
    fn what_turns_is_displaced_by_the_way_of_its_axis_wherever_the_origin_is() {
        let axis = Vec3::new(0.0, 0.0, 1.0);
        let (by, offset) = (Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.0, -0.3, 0.1));
        for point in [Vec3::zeros(), Vec3::new(900.0, 42.0, 7.0)] {
            let lowered = Pose::default().moved(&by, None, 1.0);
            let turn = Rotation { point: point + by, axis, angle: 30.0 };
            let rolled = lowered.moved(&Vec3::zeros(), Some(&turn), 1.0).driven_by(&offset);
            let axle = Axle { point: point + by + offset, axis, lever: 2.0 };
            for pose in [rolled, lowered.driven_by(&offset).turned_by(&axle, 0.4)] {
                assert!((pose.displacement() - by - offset).norm() < 1e-12, "{point}: {}", pose.displacement());
            }
        }
    }

    #[test]
    fn a_screw_goes_the_way_of_the_rotation_that_made_it() {
        let turn = Rotation { point: Vec3::new(1.0, -2.0, 0.5), axis: Vec3::new(0.0, 0.0, 1.0), angle: 80.0 };
        let by = Vec3::new(0.0, 0.0, 3.0);
        let start = Pose::default().moved(&Vec3::new(0.3, 0.2, 0.1), Some(&turn), 0.7);
        let end = start.moved(&by, Some(&turn), 1.0);
        assert!((start.angle(&end) - 80.0f64.to_radians()).abs() < 1e-12);
        for s in [0.0, 0.25, 1.0] {
            let (exact, found) = (start.moved(&by, Some(&turn), s), start.toward(&end, s));
            assert!((exact.rotation - found.rotation).norm() < 1e-13, "{s}");
            assert!((exact.translation - found.translation).norm() < 1e-13, "{s}");
        }
        let moved = Pose { translation: start.translation + by, ..start };
        assert!((start.toward(&moved, 0.5).translation - start.translation - by * 0.5).norm() < 1e-14);
    }
}
