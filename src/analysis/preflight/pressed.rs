//! Bodies that nothing presses against what touches them.
//!
//! Contacts push, and friction pulls along them by no more than mu times that. Where all the forces that the contacts of a
//! body could have lie on one side, and neither a support nor a load acts against them, there is no equilibrium, or only one
//! without any: a tool that is moved shoves the body along, a load draws it off. With the normals n, and a direction d of no support, that is so if
//! n·d > mu / sqrt(1 + mu²), the sine of the angle of friction, for all of them. Bodies that are tied count as one,
//! parts of a body that share no nodes as several.

use super::super::conditions::Conditions;
use super::sight::Standing;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::scene::{Scene, body_of};
use mpi::topology::SimpleCommunicator;

/// Components of directions below this are none.
const SLIGHT: f64 = 1e-6;

/// Refuses steps in which nothing presses a body that has contacts. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &Model,
    (steps, sights): (&[Conditions], &[Vec<Standing>]),
) -> Result<()> {
    let united = model.united(comm);
    let component = &model.part.component;
    for (step, conditions) in scene.steps.iter().zip(steps) {
        let times: Vec<f64> = [0.0, 1.0].into_iter().chain(step.corners()).collect();
        let supports = supports(comm, model, &united, conditions, &times);
        for (b, Support { free, loads, pressed }) in supports.into_iter().enumerate() {
            if united[b] != b || pressed || free == Vec3::zeros() {
                continue;
            }
            // The normals of all contacts, as pushes on the body, with the sine of the angle of friction of each.
            let pushes = || {
                model.pairs.iter().zip(sights).flat_map(|(pair, sights)| {
                    let sine = pair.friction / pair.friction.hypot(1.0);
                    let united = &united;
                    pair.slaves.iter().zip(sights).filter_map(move |(slave, sight)| {
                        let is_own = united[component[slave.node as usize] as usize] == b;
                        let is_other = sight.component.is_some_and(|other| united[other] == b);
                        let normal = sight.normal().filter(|_| is_own != is_other)?;
                        Some((if is_own { normal } else { -normal }, sine))
                    })
                })
            };
            let mut total = pushes().map(|(n, _)| n).sum::<Vec3>();
            sum(comm, total.as_mut_slice());
            let direction = total.component_mul(&free).try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
            if loads.iter().any(|load| load.dot(&direction) < 0.0) {
                continue;
            }
            let mut least = [f64::NEG_INFINITY];
            pushes().for_each(|(n, sine)| least[0] = least[0].max(sine - n.dot(&direction)));
            max(comm, &mut least);
            if least[0] < 0.0 && least[0].is_finite() {
                let what = format!(
                    "step `{}`: nothing presses {} against what touches it: all contacts push it one way, and no support \
                     or load holds against that",
                    step.name.value,
                    model.component_name(b)
                );
                return Err(Error::input(
                    &step.name.at,
                    what,
                    "`fix` it on the other side, or let a load act; without `keep` a step holds only what it lists",
                ));
            }
        }
    }
    Ok(())
}

/// What acts on a component of a body besides contacts, on all ranks.
struct Support {
    /// 1 along x, y, z where no node is prescribed or on a spring or dashpot, by any component of a direction, else 0.
    free: Vec3,
    /// Sum of the loads at the beginning and at the end of the step, and where tables turn, N.
    loads: Vec<Vec3>,
    /// A pressure acts.
    pressed: bool,
}

/// What acts on each component of a body and those `united` with it, with the loads at these fractions of the step. Collective.
fn supports(
    comm: &SimpleCommunicator,
    model: &Model,
    united: &[usize],
    conditions: &Conditions,
    times: &[f64],
) -> Vec<Support> {
    let count = model.part.components.len();
    let mut set = vec![0.0f64; 3 * count];
    let width = 3 * times.len();
    let mut loads = vec![0.0f64; width * count];
    for n in 0..model.part.owned {
        let b = united[model.part.component[n] as usize];
        let resists = conditions.springs.get(&(n as u32)).copied().unwrap_or_default().resists();
        let held: Vec<Vec3> = (0..3).filter_map(|d| conditions.held_along(n, d)).collect();
        // Rings resist getting wider.
        let around = model.is_axisymmetric();
        for d in (0..3).filter(|&d| around && d == 0 || resists[d] || held.iter().any(|along| along[d].abs() > SLIGHT))
        {
            set[3 * b + d] = 1.0;
        }
        for (sum, s) in loads[width * b..].chunks_exact_mut(3).zip(times) {
            let load = conditions.loads[n].at(*s);
            (0..3).for_each(|d| sum[d] += load[d]);
        }
    }
    max(comm, &mut set);
    sum(comm, &mut loads);
    let body = |k: usize| model.bodies[model.part.components[k].body as usize].name.as_str();
    let of_one = |b: usize| (0..count).filter(move |&k| united[k] == b);
    let pressed = |b: usize| conditions.pressures.keys().any(|set| of_one(b).any(|k| body(k) == body_of(set)));
    let one = |b: usize| Support {
        free: Vec3::from_column_slice(&set[3 * b..3 * b + 3]).map(|set| 1.0 - set),
        loads: loads[width * b..width * (b + 1)].chunks_exact(3).map(Vec3::from_column_slice).collect(),
        pressed: pressed(b),
    };
    (0..count).map(one).collect()
}
