//! Bodies that nothing presses against what touches them.
//!
//! Contacts push, and friction pulls along them by no more than mu times that. Where all the forces that the contacts of a
//! body could have lie on one side, and neither a support nor a load acts against them, the only equilibrium has none: a
//! tool that is moved shoves the body along. With the normals n, and a direction d of no support, that is so if
//! n·d > mu / sqrt(1 + mu²), the sine of the angle of friction, for all of them.

use super::super::conditions::Conditions;
use super::rigid::{Side, sides};
use super::sight::Sight;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::scene::{Scene, body_of};
use mpi::topology::SimpleCommunicator;

/// Refuses steps in which nothing presses a body that has contacts. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &Model,
    (steps, sights): (&[Conditions], &[Vec<Sight>]),
) -> Result<()> {
    let sides = sides(model, scene);
    for (step, conditions) in scene.steps.iter().zip(steps) {
        let mut supports = supports(model, conditions);
        max(comm, &mut supports);
        for (b, body) in model.bodies.iter().enumerate() {
            let [x, y, z, loaded] = *supports[4 * b..].first_chunk().unwrap_or(&[1.0; 4]);
            let free = Vec3::new(1.0 - x, 1.0 - y, 1.0 - z);
            if loaded > 0.0 || free == Vec3::zeros() {
                continue;
            }
            // The normals of all contacts, as pushes on the body, with the sine of the angle of friction of each.
            let pushes = || {
                model.pairs.iter().zip(&sides).zip(sights).flat_map(|((pair, (own, other)), sights)| {
                    let sign = if *own == b { 1.0 } else { -1.0 };
                    let concerned = (*own == b) != (*other == Side::Body(b));
                    let sine = pair.friction / pair.friction.hypot(1.0);
                    let of = move |s: &Sight| s.normal().map(|n| (sign * n, sine));
                    sights.iter().filter(move |_| concerned).filter_map(of)
                })
            };
            let mut total = pushes().map(|(n, _)| n).sum::<Vec3>();
            sum(comm, total.as_mut_slice());
            let direction = total.component_mul(&free).try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
            let mut least = [f64::NEG_INFINITY];
            pushes().for_each(|(n, sine)| least[0] = least[0].max(sine - n.dot(&direction)));
            max(comm, &mut least);
            if least[0] < 0.0 && least[0].is_finite() {
                let what = format!(
                    "step `{}`: nothing presses body `{}` against what touches it: all contacts push it one way, and no support \
                     or load holds against that",
                    step.name.value, body.name
                );
                return Err(Error::input(
                    &step.name.at,
                    what,
                    "`fix` it on the other side, or let a load act; a step holds only what it lists",
                ));
            }
        }
    }
    Ok(())
}

/// By body: whether some node is prescribed along x, y, z, and whether a load acts; 1 or 0, of this rank.
fn supports(model: &Model, conditions: &Conditions) -> Vec<f64> {
    let mut found = vec![0.0f64; 4 * model.bodies.len()];
    for n in 0..model.part.owned {
        let own = &mut found[4 * model.part.body[n] as usize..];
        for d in (0..3).filter(|d| conditions.prescribed[3 * n + d].is_some()) {
            own[d] = 1.0;
        }
        let load = conditions.loads[n];
        if load.to != Vec3::zeros() || load.from != Vec3::zeros() {
            own[3] = 1.0;
        }
    }
    for set in conditions.pressures.keys() {
        let body = model.bodies.iter().position(|b| b.name == body_of(set)).unwrap_or_default();
        found[4 * body + 3] = 1.0;
    }
    found
}
