//! Centrifugal forces on bodies that turn steadily about an axis, in the frame that turns with them.

use super::reader::Item;
use super::references::Names;
use super::{Amplitude, Located, amplitude};
use crate::Vec3;
use crate::error::{Error, Result};

/// A centrifugal force on a body: its density times the square of the angular velocity times the distance from the axis, where the
/// body is at the time. Ramps linearly from its value at the end of the last step.
#[derive(Clone, Debug)]
pub struct Spin {
    pub body: Located<String>,
    pub point: Vec3,
    /// A unit vector.
    pub axis: Vec3,
    /// The square of the angular velocity, radians²/time².
    pub square: f64,
    /// As that of a force.
    pub table: Option<Amplitude>,
    /// Of each of [`Scene::sections`](super::Scene::sections) of the body.
    pub densities: Vec<(usize, f64)>,
}

pub(super) fn read(item: &Item, names: &Names, duration: f64) -> Result<Spin> {
    let table = item.table(&["body", "point", "axis", "speed", "table"])?;
    let shares = |item: &Item| {
        let shares = amplitude::read(item, duration)?;
        let is_below = [0.0, 1.0].into_iter().chain(shares.corners()).any(|s| shares.at(s) < 0.0);
        match is_below {
            true => Err(item.error("goes below 0", "it has shares of the square of `speed`")),
            false => Ok(shares),
        }
    };
    Ok(Spin {
        body: names.body(&table.require("body", "\"BODY\"")?)?,
        point: table.require("point", "[0.0, 0.0, 0.0]")?.vector()?,
        axis: table.require("axis", "[0.0, 0.0, 1.0]")?.unit_vector()?,
        square: table.require("speed", "100.0")?.number()?.powi(2),
        table: table.optional("table", shares)?,
        densities: Vec::new(),
    })
}

impl Spin {
    /// The square of the angular velocity at the end of the step.
    pub fn last(&self) -> f64 {
        self.square * amplitude::end(&self.table)
    }

    /// Whether another one is about the same axis.
    pub fn is_about(&self, point: &Vec3, axis: &Vec3) -> bool {
        self.point == *point && self.axis == *axis
    }

    /// What is wrong of a body that turns about its axis in plane strain or with axial symmetry, if something is.
    pub fn across(&self, axis: usize, through_origin: bool) -> Option<Error> {
        let is_along = 1.0 - self.axis[axis].abs() < 1e-14;
        let is_through = !through_origin || (0..3).all(|d| d == axis || self.point[d] == 0.0);
        let name = crate::AXIS_NAMES[axis];
        let help = if through_origin { "of axisymmetric bodies it is the y axis" } else { "turn it about z" };
        let what =
            format!("body `{}` spins about another axis than {name}, along which it is computed", self.body.value);
        (!is_along || !is_through).then(|| Error::input(&self.body.at, what, help))
    }
}
