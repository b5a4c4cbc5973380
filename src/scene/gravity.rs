//! Weights of bodies: density times gravity, per reference volume; and the densities of those that spin.

use super::{Body, BodyForce, Material, Step};
use crate::error::{Error, Location, Result};

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
        for (section, (body, material)) in sections() {
            let per_volume = gravity.value * density("gravity", &gravity.at, &body.name.value, &material.value)?;
            step.weights.push(BodyForce { body: body.name.clone(), section: Some(section), per_volume, table: None });
        }
    }
    Ok(())
}
