//! Sets that a step lists anew: what held them and no longer does, and cylindrical frames that they have turned away from.

use super::super::conditions::Conditions;
use crate::model::Model;
use crate::parallel::any;
use crate::scene::{Fix, Scene, Step, body_of};
use crate::{AXIS_NAMES, Vec3};
use mpi::topology::SimpleCommunicator;
use nalgebra::{Rotation3, Unit};

/// Sine of the angle between a direction and those along which a node is held from which it is another one.
const APART: f64 = 1e-6;
/// Degrees by which a set has turned from which its cylindrical frame is told to have stayed behind: r is then off by 9 % of r.
const TURNED: f64 = 5.0;

/// Warns of supports that a step keeps nothing of, since it lists their sets, and does not hold otherwise; in which step which sets
/// these are. Collective.
pub fn freed<'a>(
    comm: &SimpleCommunicator,
    scene: &'a Scene,
    model: &mut Model,
    steps: &[Conditions],
) -> Vec<(&'a Step, &'a str)> {
    let mut freed: Vec<(&Step, &str, Vec<String>)> = Vec::new();
    for (step, conditions) in scene.steps.iter().zip(steps) {
        for fix in &step.replaced {
            let set = fix.set.value.as_str();
            let is_free = |n: u32, d: usize| {
                let along = direction(fix, &model.part.points[n as usize], d);
                along.is_some_and(|along| !holds(conditions, n as usize, &along))
            };
            let frees = |d: &usize| any(comm, model.set(set).nodes.iter().any(|n| is_free(*n, *d)));
            let directions: Vec<usize> = (0..3).filter(frees).collect();
            if directions.is_empty() {
                continue;
            }
            let names = names(fix, &directions);
            match freed.last_mut().filter(|(own, other, _)| std::ptr::eq(*own, step) && *other == set) {
                Some((.., all)) => all.push(names),
                None => freed.push((step, set, vec![names])),
            }
        }
    }
    model.warnings.extend(freed.iter().map(|(step, set, names)| {
        format!(
            "step `{}`: `{set}` was held along {}, and no longer is, for the step lists it anew without that: `fix` it along \
             {1}, too, or name it in `release`, if it is to be free there",
            step.name.value,
            names.join(" and ")
        )
    }));
    freed.into_iter().map(|(step, set, _)| (step, set)).collect()
}

/// The unit vector d along which a support holds a node that is meshed at `place`, if it does.
fn direction(fix: &Fix, place: &Vec3, d: usize) -> Option<Vec3> {
    match (&fix.around, fix.normal) {
        (Some(around), _) => around.directions[d].then(|| around.frame(place).1[d]),
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
    let axes = (0..3).filter_map(|d| conditions.held_along(node, d));
    (along - axes.map(|axis| axis * axis.dot(along)).sum::<Vec3>()).norm() < APART
}

/// Warns of sets that are held or moved around an axis, or away from it, after steps before have turned them: what is r and t is so
/// where they were meshed.
pub fn turned(scene: &Scene, model: &mut Model) {
    let mut told: Vec<&str> = Vec::new();
    for (k, step) in scene.steps.iter().enumerate() {
        let fixed = step.fix.iter().map(|fix| (fix.set.value.as_str(), fix.around));
        let moved = step.moves.iter().map(|own| (own.target.value.as_str(), own.around));
        for (set, around) in fixed.chain(moved) {
            // Held along both it stays where it is in any frame.
            let matters = around.is_some_and(|around| match around.directions {
                [true, true, _] => around.by.x != 0.0 || around.by.y != 0.0,
                [r, t, _] => r || t,
            });
            let angle = turn_before(&scene.steps[..k], set);
            if !matters || angle < TURNED || told.contains(&set) {
                continue;
            }
            told.push(set);
            model.warnings.push(format!(
                "step `{}`: `{set}` has turned by {angle:.0} degrees since it was meshed, and r and t of `around` have not: they lead \
                 where they led there; `move` it by `by` or `rotate`, or mesh it as it stands",
                step.name.value
            ));
        }
    }
}

/// By how many degrees steps have turned a set, by its name or with all of its body.
fn turn_before(steps: &[Step], set: &str) -> f64 {
    let moves = steps.iter().flat_map(|step| &step.moves);
    let of_set = moves.filter(|own| own.target.value == set || own.target.value == body_of(set));
    let turns = of_set.filter_map(|own| {
        let rotation = own.rotate?;
        let share = own.table.as_ref().map_or(1.0, |table| table.end());
        let angle = (rotation.angle * share).to_radians();
        Some(Rotation3::from_axis_angle(&Unit::new_normalize(rotation.axis), angle))
    });
    turns.fold(Rotation3::identity(), |all, turn| turn * all).angle().to_degrees()
}
