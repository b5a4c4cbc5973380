//! Slave nodes that cannot give way to a tool: those whose supports hold or move them along every direction that the
//! tool's normal has, against a tool that no force drives there. No contact force acts on them, whatever their gap; in the
//! gap that is right, inside the tool it is not.
//!
//! Motions of such nodes and tools are known beforehand, as far as no force or equilibrium has had a part in them; where
//! one had, nothing is said here. They are looked at in [`LOOKS`] places of each step, and where tables turn.
//!
//! Of such nodes on a body it is told: whole slaves, and ends of a contact at which both bodies are held.

use super::super::conditions::Conditions;
use super::worst;
use crate::Vec3;
use crate::contact::{Pair, Pose};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{any, max, to_all};
use crate::scene::{Amplitude, Scene, Smoothing, Step};
use crate::surface::Projection;
use crate::system::Axes;
use mpi::topology::SimpleCommunicator;

/// Fractions of a step that are looked at, evenly.
const LOOKS: usize = 8;
/// Depth over the size of a slave facet that counts: well above what smoothed surfaces differ from exact ones.
const DEPTH: f64 = 1e-3;
/// How far aside of where a node is known to be, over the size of a slave facet, it must be held, too: where it goes there is not
/// known, and on the axis of a tool the normal is any.
const ASIDE: f64 = 0.1;
/// How near to each other nodes stand on each other, over the size of a slave facet.
const TOGETHER: f64 = 0.1;
/// Components of a normal below this are none, as in [`crate::contact::law::Guide::gives_way`].
const ACROSS: f64 = 1e-6;

/// Warns of slaves of which a support holds or moves all nodes along all directions, against a body: as rigid as a tool, they
/// leave all that must give way to the other side. Collective.
pub fn rigid(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, steps: &[Conditions]) {
    let is_free = |pair: &Pair, conditions: &Conditions| {
        pair.slaves.iter().any(|slave| !is_led(model, pair.side.body, conditions, slave.node))
    };
    let mut warnings = Vec::new();
    for (pair, contact) in model.pairs.iter().zip(scene.passes()) {
        if pair.master.tool().is_some() || pair.is_self() || pair.is_by_nodes() {
            continue;
        }
        let held = steps.iter().map(|conditions| !any(comm, is_free(pair, conditions))).collect::<Vec<_>>();
        if let Some(k) = held.iter().position(|held| *held) {
            let set = &contact.slave.value;
            warnings.push(format!(
                "step `{}`: all nodes of `{set}`, a slave of contact `{}`, are held or moved, and cannot give way to what touches \
                 them: make it the master, in one pass",
                scene.steps[k].name.value, contact.name.value
            ));
        }
    }
    model.warnings.extend(warnings);
}

/// Warns of contacts from segment to segment at whose end both bodies are held, one on the other, in the initial mesh: where they bend,
/// the smoothed master bulges over the slave's flat faces by a twelfth of curvature times length squared, and beside nodes that are
/// held nothing gives way to that. Collective.
pub fn clamped(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, steps: &[Conditions]) {
    let part = &model.part;
    let mut warnings = Vec::new();
    for (pair, contact) in model.pairs.iter().zip(scene.passes()) {
        let is_smooth = contact.surface.is_some_and(|surface| surface.smoothing == Smoothing::Nagata);
        let presses = is_smooth && !contact.slave_follows && pair.faces.is_some() && !pair.is_self();
        let Some(other) = pair.master_side.as_ref().filter(|_| presses) else {
            continue;
        };
        let nodes: [Vec<u32>; 2] =
            [pair.slaves.iter().map(|slave| slave.node).collect(), part.sets[other.set].nodes.clone()];
        let near = TOGETHER * pair.facet_size;
        let clamps = |conditions: &Conditions| {
            let places = |body: usize, nodes: &[u32]| -> Vec<[f64; 3]> {
                let led = nodes.iter().filter(|&&n| is_led(model, body, conditions, n));
                led.map(|&n| part.points[n as usize].into()).collect()
            };
            let (own, others) = (places(pair.side.body, &nodes[0]), places(other.body, &nodes[1]));
            if !any(comm, !own.is_empty()) || !any(comm, !others.is_empty()) {
                return false;
            }
            let mut others = to_all(comm, &others);
            others.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let meets = |x: &[f64; 3]| {
                let from = others.partition_point(|y| y[0] < x[0] - near);
                let mut beside = others[from..].iter().take_while(|y| y[0] <= x[0] + near);
                beside.any(|y| (Vec3::from(*x) - Vec3::from(*y)).norm() <= near)
            };
            any(comm, own.iter().any(meets))
        };
        if let Some(k) = steps.iter().position(clamps) {
            warnings.push(format!(
                "step `{}`: nodes of `{}` and of `{}`, at the end of contact `{}`, are held or moved, one on the other: where the \
                 bodies bend beside them, smoothed faces press each other apart, on coarse meshes by several times what the contact \
                 bears; slave_curvature = \"deformed\", smoothing = \"facet\", or one pass, does not",
                scene.steps[k].name.value, contact.slave.value, contact.master.value, contact.name.value
            ));
        }
    }
    model.warnings.extend(warnings);
}

/// Refuses scenes in which such a node comes to be inside its tool. Collective.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, steps: &[Conditions]) -> Result<()> {
    let contacts = scene.passes();
    // How far each owned node has moved along its directions of the step, NaN where equilibrium has decided; and where tools
    // are.
    let mut moved = vec![Vec3::zeros(); model.part.owned];
    let mut axes = Axes::default();
    let mut poses: Vec<Option<Pose>> = model.masters.tools.iter().map(|tool| Some(tool.committed)).collect();
    let mut found = Ok(());
    for (step, conditions) in scene.steps.iter().zip(steps) {
        for (n, u) in moved.iter_mut().enumerate().filter(|(n, _)| axes.of(*n) != conditions.axes.of(*n)) {
            *u = conditions.axes.inward(n, &axes.outward(n, u));
        }
        axes.clone_from(&conditions.axes);
        let before = moved.clone();
        // Circles are those of nodes where they are meshed.
        let by = |n: usize, s: f64| match conditions.turns(n) && before[n] != Vec3::zeros() {
            true => Vec3::repeat(f64::NAN),
            false => conditions.moved(n, s),
        };
        moved.iter_mut().enumerate().for_each(|(n, u)| *u += by(n, 1.0));
        let looks = looks(step);
        for (pose, motion) in poses.iter_mut().zip(&conditions.motions) {
            *pose = pose.filter(|_| motion.free == [false; 3] && motion.axle.is_none());
        }
        for (pair, contact) in model.pairs.iter().zip(&contacts) {
            let Some(t) = pair.master.tool() else { continue };
            let Some(start) = poses[t] else { continue };
            let mut watched: Vec<usize> = (0..pair.slaves.len()).filter(|&s| is_held(pair, s, conditions)).collect();
            if !any(comm, !watched.is_empty()) {
                continue;
            }
            let motion = &conditions.motions[t];
            let tool = &mut model.masters.tools[t];
            let mut deep: Vec<(u32, f64)> = Vec::new();
            // Where a node is, as far as that is known.
            let at = |n: usize, u: &Vec3| {
                let known = u.map(|u| if u.is_nan() { 0.0 } else { u });
                model.part.points[n] + conditions.axes.outward(n, &known)
            };
            // What would be inside already as the step begins, equilibrium has carried along, and it is not there.
            let is_deep = |p: &Projection| p.gap < -DEPTH * pair.facet_size;
            let node = |k: usize| pair.slaves[k].node as usize;
            let is_known = |k: usize| before[node(k)].iter().all(|u| !u.is_nan());
            if any(comm, !watched.iter().all(|&k| is_known(k))) {
                let places: Vec<Vec3> = watched.iter().map(|&k| start.inward(&at(node(k), &before[node(k)]))).collect();
                let gone =
                    |(&k, place): (&usize, &Vec3)| (place - tool.committed.inward(&model.part.points[node(k)])).norm();
                let mut farthest = [watched.iter().zip(&places).map(gone).fold(0.0, f64::max)];
                max(comm, &mut farthest);
                let reach = pair.reach + farthest[0];
                tool.trial = start;
                tool.surface.watch(comm, &places, reach);
                let stands = |k: &usize| {
                    let stood = || tool.project(&at(node(*k), &before[node(*k)]), reach, (None, false));
                    is_known(*k) || !stood().as_ref().is_some_and(is_deep)
                };
                watched.retain(stands);
            }
            // The farthest between two looks, as they are at most 1/LOOKS apart.
            let farthest = |by: f64, course: u32| by.abs() * conditions.course(course).map_or(1.0, Amplitude::steepest);
            for &s in &looks {
                tool.trial = conditions.pose(t, &start, s);
                let place = |k: usize| {
                    let n = pair.slaves[k].node as usize;
                    let u = before[n] + by(n, s);
                    (at(n, &u), u)
                };
                let points: Vec<Vec3> = watched.iter().map(|&k| tool.trial.inward(&place(k).0)).collect();
                // As deep as a look may find it for the first time.
                let way = |k: usize| {
                    let motions = |d| conditions.prescribed[3 * pair.slaves[k].node as usize + d];
                    Vec3::from_fn(|d, _| motions(d).map_or(0.0, |m| farthest(m.length(), m.course))).norm()
                };
                let mut reach = [watched.iter().map(|&k| way(k)).fold(0.0, f64::max)];
                max(comm, &mut reach);
                let reach = pair.reach + (reach[0] + farthest(motion.by.norm(), motion.course)) / LOOKS as f64;
                tool.surface.watch(comm, &points, reach);
                let aside = ASIDE * pair.facet_size;
                for &k in &watched {
                    let (x, u) = place(k);
                    let known = |d: usize| is_set(pair, k, conditions, d) && !u[d].is_nan();
                    let node = pair.slaves[k].node as usize;
                    let began = start.inward(&at(node, &before[node]));
                    // How deep it is, if it is held there, and on the side that it came through, too.
                    let is_held = |p: &Projection| {
                        let normal = conditions.axes.inward(node, &p.normal);
                        (0..3).all(|d| normal[d].abs() <= ACROSS || known(d))
                    };
                    let depth = |x: &Vec3| {
                        let p = tool.project(x, reach, (None, false))?;
                        let came = tool.entrance(x, &p, (&began, None), pair.sides());
                        let held = is_deep(&p) && is_held(&p) && came.is_none_or(|p| is_held(&p));
                        held.then_some(-p.gap)
                    };
                    let steps = (0..3).filter(|d| !known(*d)).flat_map(|d| [Vec3::ith(d, aside), Vec3::ith(d, -aside)]);
                    let mut around = steps.map(|step| x + conditions.axes.outward(node, &step));
                    let found = depth(&x).filter(|_| around.all(|x| depth(&x).is_some()));
                    deep.extend(found.map(|depth| (pair.slaves[k].node, depth)));
                }
            }
            tool.trial = tool.committed;
            tool.surface.forget();
            let mut depth = [deep.iter().map(|(_, depth)| *depth).fold(0.0, f64::max)];
            max(comm, &mut depth);
            if let Some(node) = worst(comm, model, &deep) {
                let what = format!(
                    "step `{}`: node {node}, a slave node of contact `{}`, comes to be {:.3e} inside the tool `{}`, and \
                     supports keep it from giving way: no force would act on it",
                    step.name.value, contact.name.value, depth[0], contact.master.value
                );
                let help = "take it out of `fix` or `move` along the tool's normal, or out of the slave's faces";
                found = Err(Error::input(&step.name.at, what, help));
                break;
            }
        }
        found.clone()?;
        for (t, pose) in poses.iter_mut().enumerate() {
            *pose = pose.map(|pose| conditions.pose(t, &pose, 1.0));
        }
    }
    found
}

/// The fractions of a step that are looked at, with those at which motions turn.
fn looks(step: &Step) -> Vec<f64> {
    let mut looks: Vec<f64> = (0..=LOOKS).map(|look| look as f64 / LOOKS as f64).chain(step.corners()).collect();
    looks.sort_by(f64::total_cmp);
    looks
}

/// Whether supports set where a node of a body is along all directions that it has.
fn is_led(model: &Model, body: usize, conditions: &Conditions, node: u32) -> bool {
    let along = if model.bodies[body].is_layer() { 2 } else { 3 };
    conditions.prescribed[3 * node as usize..][..along].iter().all(Option::is_some)
}

/// Whether a support sets where slave node `s` of a pair is along a direction.
fn is_set(pair: &Pair, s: usize, conditions: &Conditions, d: usize) -> bool {
    conditions.prescribed[3 * pair.slaves[s].node as usize + d].is_some()
}

/// Whether a slave node is held at all.
fn is_held(pair: &Pair, s: usize, conditions: &Conditions) -> bool {
    (0..3).any(|d| is_set(pair, s, conditions, d))
}
