//! Weights of bodies: density times gravity, per reference volume.

use super::{Body, BodyForce, Material, Step};
use crate::error::{Error, Result};

/// Gives every body its weight in the steps with gravity.
///
/// # Errors
/// A body whose material has no density.
pub(super) fn weigh(steps: &mut [Step], bodies: &[Body], materials: &[Material]) -> Result<()> {
    for step in steps {
        let Some(gravity) = &step.gravity else { continue };
        let sections = bodies.iter().flat_map(|body| body.sections().map(move |material| (body, material)));
        for (section, (body, material)) in sections.enumerate() {
            let card = materials.iter().find(|card| card.name.value == material.value);
            let Some(density) = card.and_then(|card| card.density) else {
                let (material, body) = (&material.value, &body.name.value);
                let what = format!("gravity acts on body `{body}`, but its material `{material}` has no density");
                let help = format!("add `density` to [material.{material}]; 0 for a body without weight");
                return Err(Error::input(&gravity.at, what, help));
            };
            let per_volume = gravity.value * density;
            step.weights.push(BodyForce { body: body.name.clone(), section: Some(section), per_volume, table: None });
        }
    }
    Ok(())
}
