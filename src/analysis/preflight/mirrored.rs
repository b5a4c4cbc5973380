//! Conditions that would be others in the mirror image of a body: of what a plane of symmetry stands for they are no part.
//!
//! A vector has the same mirror image if it lies in the plane, an axis of rotation if it is normal to it. A tool that moves
//! otherwise has a mirror image that moves the other way, which is right for two tools, not for one that the body meets in the
//! plane.

use super::super::conditions::{Conditions, ToolMotion};
use super::sight::Standing;
use crate::Vec3;
use crate::contact::Pair;
use crate::contact::moves::RIGHT;
use crate::model::{Model, SymmetryPlane};
use crate::parallel::any;
use crate::scene::{BodyForce, Scene, Spin, body_of};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// Cosine between the normals of a tool and of a plane, above which what is in the plane looks past it at one of two tools.
const PAST: f64 = 0.5;

/// Warns of motions and loads in all steps that have another mirror image. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &mut Model,
    (steps, sights): (&[Conditions], &[Vec<Standing>]),
) {
    let mut warnings = Vec::new();
    let crossing: Vec<Vec<bool>> = model.symmetry.iter().map(|plane| crossing(comm, model, plane, sights)).collect();
    for (step, conditions) in scene.steps.iter().zip(steps) {
        for (plane, crossing) in model.symmetry.iter().zip(&crossing) {
            let mut found = Vec::new();
            if step.gravity.as_ref().is_some_and(|gravity| is_across(&gravity.value.acceleration, &plane.normal)) {
                found.push("gravity has another mirror image".to_string());
            }
            let leans = |spin: &&Spin| {
                let off = (plane.normal.dot(&spin.point) - plane.at).abs();
                let is_in = off <= RIGHT * plane.extent.abs();
                let is_normal = spin.axis.cross(&plane.normal).norm() <= RIGHT;
                !is_normal && (!is_in || is_across(&spin.axis, &plane.normal))
            };
            let own = body_of(&plane.set.value);
            let pushes = |force: &&BodyForce| force.body.value == own && is_across(&force.per_volume, &plane.normal);
            let forces = step.body_forces.iter().filter(pushes);
            found.extend(
                forces.map(|force| format!("the body force of `{}` has another mirror image", force.body.value)),
            );
            let spins = step.spins.iter().filter(|spin| spin.body.value == own).filter(leans);
            found.extend(spins.map(|spin| format!("the spin of `{}` has another mirror image", spin.body.value)));
            let tools = model.masters.tools.iter().zip(&conditions.motions).zip(crossing);
            for ((tool, motion), _) in tools.filter(|(_, crosses)| **crosses) {
                let does = way_across(motion, plane);
                found.extend(does.map(|does| format!("the mirror image of tool `{}` {does} the other way", tool.name)));
            }
            let (step, set) = (&step.name.value, &plane.set.value);
            warnings.extend(found.iter().map(|found| format!("step `{step}`: in the symmetry `{set}` {found}")));
        }
    }
    warnings.extend(straddling(comm, scene, model));
    model.warnings.extend(warnings);
}

/// Slaves on both sides of a plane of symmetry of their tool, which has a surface on one of them. Collective.
fn straddling(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Vec<String> {
    let mut found = Vec::new();
    for (t, tool) in scene.tools.iter().enumerate() {
        for plane in tool.mesh.iter().flat_map(|mesh| &mesh.symmetry) {
            let normal = plane.normal.normalize();
            for pair in model.pairs.iter().filter(|pair| pair.master.tool() == Some(t)) {
                let limit = pair.controls.watch_deep * pair.facet_size;
                let height = |n: u32| normal.dot(&(model.part.points[n as usize] - plane.point));
                let is_beyond = |side: f64| pair.slaves.iter().any(|slave| side * height(slave.node) > limit);
                if any(comm, is_beyond(1.0)) && any(comm, is_beyond(-1.0)) {
                    found.push(format!(
                        "contact `{}`: the slave lies on both sides of a plane of `symmetry` of tool `{}`, which has a surface \
                         on one of them alone: the body must end there, too, or the tool be meshed as a whole",
                        pair.name, tool.name.value
                    ));
                }
            }
        }
    }
    found
}

/// Which tools slave nodes in a plane of symmetry look at.
fn crossing(comm: &SimpleCommunicator, model: &Model, plane: &SymmetryPlane, sights: &[Vec<Standing>]) -> Vec<bool> {
    let nodes: BTreeSet<u32> = model.set(&plane.set.value).nodes.iter().copied().collect();
    let looks = |sight: &Standing| sight.normal().is_some_and(|normal| normal.dot(&plane.normal).abs() <= PAST);
    let ends = |pair: &Pair, sights: &[Standing]| {
        pair.slaves.iter().zip(sights).any(|(slave, sight)| nodes.contains(&slave.node) && looks(sight))
    };
    let pairs = || model.pairs.iter().zip(sights);
    let meets = |t: usize| pairs().any(|(pair, sights)| pair.master.tool() == Some(t) && ends(pair, sights));
    (0..model.masters.tools.len()).map(|t| any(comm, meets(t))).collect()
}

fn is_across(vector: &Vec3, normal: &Vec3) -> bool {
    vector.dot(normal).abs() > RIGHT * vector.norm()
}

/// What the mirror image of a tool does otherwise.
fn way_across(motion: &ToolMotion, plane: &SymmetryPlane) -> Option<&'static str> {
    let leans = |axis: &Vec3| axis.cross(&plane.normal).norm() > RIGHT * axis.norm();
    let is_free = (0..3).any(|d| motion.free[d] && plane.normal[d].abs() > RIGHT);
    if is_across(&motion.by, &plane.normal) {
        Some("moves")
    } else if motion.rotation.is_some_and(|rotation| leans(&rotation.axis))
        || motion.axle.is_some_and(|axle| leans(&axle.axis))
    {
        Some("turns")
    } else {
        is_free.then_some("gives way")
    }
}
