//! Sets that a step lists anew: what held them and no longer does, and cylindrical frames that they have turned away from.

use super::super::conditions::Conditions;
use crate::model::Model;
use crate::parallel::any;
use crate::scene::{Around, Fix, Scene};
use crate::{AXIS_NAMES, Vec3};
use mpi::topology::SimpleCommunicator;

/// Sine of the angle between a direction and those along which a node is held from which it is another one.
const APART: f64 = 1e-6;
/// Degrees by which a set has turned from which its cylindrical frame is told to have stayed behind: r is then off by 9 % of r.
const TURNED: f64 = 5.0;

/// Warns of supports that a step keeps nothing of, since it lists their sets, and does not hold otherwise. Collective.
pub fn freed(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, steps: &[Conditions]) {
    let mut told = Vec::new();
    for (step, conditions) in scene.steps.iter().zip(steps) {
        for fix in &step.replaced {
            let nodes = &model.set(&fix.set.value).nodes;
            let frees = |d: &usize| {
                let is_free = |n: &u32| {
                    let layer = model.bodies[model.part.body[*n as usize] as usize].is_layer();
                    direction(fix, &model.part.points[*n as usize], *d).is_some_and(|along| {
                        !holds(conditions, *n as usize, &if layer { along.xy().push(0.0) } else { along })
                    })
                };
                any(comm, nodes.iter().any(is_free))
            };
            let freed: Vec<usize> = (0..3).filter(frees).collect();
            if freed.is_empty() {
                continue;
            }
            told.push(format!(
                "step `{}`: `{}` was held along {}, and no longer is, for the step lists it anew without that: `fix` it along \
                 {2}, too, or name it in `release`, if it is to be free there",
                step.name.value,
                fix.set.value,
                names(fix, &freed)
            ));
        }
    }
    model.warnings.extend(told);
}

/// The unit vector d along which a support holds a node that is meshed at `place`, if it does.
fn direction(fix: &Fix, place: &Vec3, d: usize) -> Option<Vec3> {
    match (&fix.around, fix.normal) {
        (Some(Around { point, axis, directions, .. }), _) => {
            let arm = place - point;
            let outward = (arm - axis * axis.dot(&arm)).try_normalize(0.0).unwrap_or_default();
            directions[d].then(|| [outward, axis.cross(&outward), *axis][d])
        }
        (None, Some(normal)) => (d == 0).then_some(normal),
        (None, None) => fix.directions[d].then(|| Vec3::ith(d, 1.0)),
    }
}

/// The directions of a support, in words.
fn names(fix: &Fix, directions: &[usize]) -> String {
    let joined = |names: [&str; 3]| directions.iter().map(|d| names[*d]).collect::<Vec<_>>().join(" and ");
    match (&fix.around, fix.normal) {
        (Some(_), _) => format!("{} of its `around`", joined(["r", "t", "z"])),
        (None, Some(n)) => format!("its `normal` ({:.3}, {:.3}, {:.3})", n.x, n.y, n.z),
        (None, None) => joined(AXIS_NAMES),
    }
}

/// Whether a step prescribes how an owned node moves along a direction.
fn holds(conditions: &Conditions, node: usize, along: &Vec3) -> bool {
    let held = (0..3).filter(|d| conditions.prescribed[3 * node + d].is_some());
    let axes = held.map(|d| conditions.axes.direction(node, d));
    (along - axes.map(|axis| axis * axis.dot(along)).sum::<Vec3>()).norm() < APART
}

/// Warns of sets that are held or moved around an axis, or away from it, after a step before has turned them: what is r and t is so
/// where they were meshed.
pub fn turned(scene: &Scene, model: &mut Model) {
    for (k, step) in scene.steps.iter().enumerate() {
        let fixed = step.fix.iter().map(|fix| (&fix.set.value, fix.around));
        let moved = step.moves.iter().map(|own| (&own.target.value, own.around));
        // Held along both they stay where they are in any frame.
        let matters = |around: &Around| match around.directions {
            [true, true, _] => around.by.xy() != nalgebra::Vector2::zeros(),
            [r, t, _] => r || t,
        };
        let framed = fixed.chain(moved).filter(|(_, around)| around.as_ref().is_some_and(matters));
        let mut sets: Vec<&String> = framed.map(|(set, _)| set).collect();
        sets.sort_unstable();
        sets.dedup();
        for set in sets {
            let of_set = scene.steps[..k].iter().flat_map(|step| &step.moves).filter(|own| own.target.value == *set);
            let turns =
                of_set.filter_map(|own| Some(own.rotate?.angle * own.table.as_ref().map_or(1.0, |table| table.end())));
            let angle = turns.sum::<f64>() % 360.0;
            if angle.abs().min(360.0 - angle.abs()) > TURNED {
                model.warnings.push(format!(
                    "step `{}`: `{set}` has turned by {angle:.0} degrees since it was meshed, and r and t of `around` have not: they lead \
                     where they led there; `move` it by `by` or `rotate`, or mesh it as it stands",
                    step.name.value
                ));
            }
        }
    }
}
