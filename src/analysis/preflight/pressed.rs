//! Bodies that nothing presses against what touches them.
//!
//! Contacts push, and friction pulls along them by no more than mu times that. Where all the forces that the contacts of a
//! body could have lie on one side, and neither a support nor a load acts against them, there is no equilibrium, or only one
//! without any: a tool that is moved shoves the body along, a load draws it off. With the normals n, and a direction d of
//! no support, that is so if n·d > mu / sqrt(1 + mu²), the sine of the angle of friction, for all of them. Bodies that are
//! tied count as one, parts of a body that share no nodes as several. After the first step a node may touch any part of its
//! master: it counts along the normal that it sees at the beginning, and against its own.

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
    for (k, (step, conditions)) in scene.steps.iter().zip(steps).enumerate() {
        let times: Vec<f64> = [0.0, 1.0].into_iter().chain(step.corners()).collect();
        let supports = supports(comm, model, &united, conditions, &times);
        // Of each component the sum of the normals, then the direction in which nothing else holds it.
        let mut sums = vec![0.0f64; 3 * supports.len()];
        let pushes = |push: &mut dyn FnMut(usize, Vec3, f64)| pushes(model, (sights, k > 0), &united, push);
        pushes(&mut |b, normal, _| (0..3).for_each(|d| sums[3 * b + d] += normal[d]));
        sum(comm, &mut sums);
        let mut directions: Vec<Vec3> = sums.chunks_exact(3).map(Vec3::from_column_slice).collect();
        for ((b, support), direction) in supports.iter().enumerate().zip(&mut directions) {
            let Support { free, loads, pressed } = support;
            *direction = direction.component_mul(free).try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
            if united[b] != b || *pressed || loads.iter().any(|load| load.dot(direction) < 0.0) {
                *direction = Vec3::zeros();
            }
        }
        let mut least = vec![f64::NEG_INFINITY; supports.len()];
        pushes(&mut |b, normal, sine| least[b] = least[b].max(sine - normal.dot(&directions[b])));
        max(comm, &mut least);
        let is_shoved = |b: &usize| directions[*b] != Vec3::zeros() && least[*b] < 0.0 && least[*b].is_finite();
        if let Some(b) = (0..supports.len()).find(is_shoved) {
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
    Ok(())
}

/// Gives the normals of all contacts of this rank, `later` than in the first step or not, as pushes on components and those
/// `united` with them, with the sine of the angle of friction of each.
fn pushes(
    model: &Model,
    (sights, later): (&[Vec<Standing>], bool),
    united: &[usize],
    push: &mut dyn FnMut(usize, Vec3, f64),
) {
    for (pair, sights) in model.pairs.iter().zip(sights) {
        let sine = pair.rules.friction / pair.rules.friction.hypot(1.0);
        for (slave, sight) in pair.slaves.iter().zip(sights) {
            let own = united[model.part.component[slave.node as usize] as usize];
            let other = sight.component.map(|other| united[other]);
            let seen = sight.normal().filter(|_| other != Some(own));
            let against = seen.filter(|_| later && sight.outward != Vec3::zeros()).map(|_| -sight.outward);
            for normal in seen.into_iter().chain(against) {
                push(own, normal, sine);
                other.into_iter().for_each(|other| push(other, -normal, sine));
            }
        }
    }
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
    for spin in &conditions.spins {
        let across = spin.across(model.is_axisymmetric());
        for (&n, mass) in &spin.masses {
            let b = united[model.part.component[n as usize] as usize];
            let load = across * (model.part.points[n as usize] - spin.point) * *mass;
            for (sum, s) in loads[width * b..].chunks_exact_mut(3).zip(times) {
                (0..3).for_each(|d| sum[d] += load[d] * spin.square.at(*s));
            }
        }
    }
    max(comm, &mut set);
    sum(comm, &mut loads);
    let body = |k: usize| model.bodies[model.part.components[k].body as usize].name.as_str();
    let mut pressed = vec![false; count];
    for k in (0..count).filter(|&k| conditions.pressures.keys().any(|set| body(k) == body_of(set))) {
        pressed[united[k]] = true;
    }
    let one = |b: usize| Support {
        free: Vec3::from_column_slice(&set[3 * b..3 * b + 3]).map(|set| 1.0 - set),
        loads: loads[width * b..width * (b + 1)].chunks_exact(3).map(Vec3::from_column_slice).collect(),
        pressed: pressed[b],
    };
    (0..count).map(one).collect()
}
