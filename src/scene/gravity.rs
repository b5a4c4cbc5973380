//! Weights of bodies: density times gravity, per reference volume; and the densities of those that spin.

use super::reader::Item;
use super::{Amplitude, Body, BodyForce, Material, Step, amplitude};
use crate::Vec3;
use crate::error::{Error, Location, Result};

/// An acceleration of all bodies. Ramps linearly from its value at the end of the last step.
#[derive(Clone, Debug)]
pub struct Gravity {
    /// Length/time².
    pub acceleration: Vec3,
    /// As that of a force.
    pub table: Option<Amplitude>,
}

impl Gravity {
    /// What it is at the end of the step.
    pub fn last(&self) -> Vec3 {
        self.acceleration * amplitude::end(&self.table)
    }
}

/// The acceleration alone, or a table of it and its shares.
pub(super) fn read(item: &Item, duration: f64) -> Result<Gravity> {
    if !item.is_table() {
        return Ok(Gravity { acceleration: item.vector()?, table: None });
    }
    let table = item.table(&["acceleration", "table"])?;
    let acceleration = table.require("acceleration", "[0.0, 0.0, -9810.0]")?.vector()?;
    Ok(Gravity { acceleration, table: table.optional("table", |item| amplitude::read(item, duration))? })
}

/// Gives every body its weight in the steps with gravity, and its densities where it spins.
///
/// # Errors
/// A body whose material has no density.
pub(super) fn weigh(steps: &mut [Step], bodies: &[Body], materials: &[Material]) -> Result<()> {
    let sections = || bodies.iter().flat_map(|body| body.sections().map(move |material| (body, material))).enumerate();
    let density = |what: &str, at: &Location, body: &str, material: &str| {
        let card = materials.iter().find(|card| card.name.value == material);
        card.and_then(|card| card.density).ok_or_else(|| {
            let what = format!("{what} acts on body `{body}`, but its material `{material}` has no density");
            Error::input(at, what, format!("add `density` to [material.{material}]; 0 for a body without weight"))
        })
    };
    for step in steps {
        for spin in &mut step.spins {
            let own = sections().filter(|(_, (body, _))| body.name.value == spin.body.value);
            let of = |(section, (body, material)): (usize, (&Body, &super::Located<String>))| {
                Ok((section, density("a spin", &spin.body.at, &body.name.value, &material.value)?))
            };
            spin.densities = own.map(of).collect::<Result<_>>()?;
        }
        let Some(gravity) = &step.gravity else { continue };
        let Gravity { acceleration, table } = &gravity.value;
        for (section, (body, material)) in sections() {
            let per_volume = acceleration * density("gravity", &gravity.at, &body.name.value, &material.value)?;
            let (body, table) = (body.name.clone(), table.clone());
            step.weights.push(BodyForce { body, section: Some(section), per_volume, table });
        }
    }
    Ok(())
}
