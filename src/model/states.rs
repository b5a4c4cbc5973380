//! What elements of a model remember, and what is shown of them: in a state that has converged.

use super::Model;
use super::elements::{Scratch, lost, medium, mine, of_body, samples};
use crate::Vec3;
use crate::error::Result;
use crate::solid::element::{
    Inverted, advance, average_plastic_strain, average_strain, average_stress, plastic_work, stored_energy,
};
use crate::solid::material::State;
use crate::solid::voigt::Voigt;

/// The states of all integration points at displacements `u`, and there the enhanced strain, too. Every rank finds those of all
/// elements that it knows, from the same numbers. [`History::accept`](crate::solid::history::History::accept) makes them
/// those of the history.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn flown(model: &mut Model, u: &[Vec3]) -> Result<Vec<State>> {
    let mut scratch = Scratch::default();
    let mut flown = model.history.states().to_vec();
    for e in 0..model.part.solids.len() {
        if model.history.amplitudes(e).is_some() {
            scratch.evaluate(model, e, u, true).map_err(|_| lost(model, e))?;
            scratch.keep(model, e);
        }
        let states = &mut flown[model.history.range(e)];
        if states.is_empty() {
            continue;
        }
        let material = &model.section(&model.part.solids[e]).material;
        let advanced = samples(model, e, u).and_then(|samples| advance(&samples, material, states));
        advanced.map_err(|_| lost(model, e))?;
    }
    Ok(flown)
}

/// Mean Cauchy stress of each element that this rank counts (xx, yy, zz, xy, yz, zx).
///
/// # Errors
/// An element that is inverted, by its number.
pub fn stresses(model: &Model, u: &[Vec3]) -> Result<Vec<Voigt>> {
    let of = |e: usize| average_stress(&samples(model, e, u)?, medium(model, e));
    mine(model).map(|e| of(e).map_err(|_| lost(model, e))).collect()
}

/// Mean logarithmic strain of each element that this rank counts (xx, yy, zz, xy, yz, zx).
///
/// # Errors
/// An element that is inverted, by its number.
pub fn strains(model: &Model, u: &[Vec3]) -> Result<Vec<Voigt>> {
    mine(model).map(|e| Ok(average_strain(&samples(model, e, u).map_err(|_| lost(model, e))?))).collect()
}

/// Mean equivalent plastic strain of each element of a body that this rank counts.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn plastic_strains(model: &Model, u: &[Vec3], body: usize) -> Result<Vec<f64>> {
    let of = |e: usize| Ok::<_, Inverted>(average_plastic_strain(&samples(model, e, u)?, model.history.of(e)));
    of_body(model, body).map(|e| of(e).map_err(|_| lost(model, e))).collect()
}

/// Stored energy and plastic work of what this rank counts of a body.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn energies(model: &Model, u: &[Vec3], body: usize) -> Result<[f64; 2]> {
    let mut sums = [0.0; 2];
    for e in of_body(model, body) {
        let medium = medium(model, e);
        let of_element = samples(model, e, u)
            .and_then(|samples| Ok([stored_energy(&samples, medium)?, plastic_work(&samples, medium)]));
        let energies = of_element.map_err(|_| lost(model, e))?;
        (0..2).for_each(|k| sums[k] += energies[k]);
    }
    Ok(sums)
}
