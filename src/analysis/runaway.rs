//! A tool that a force or torque drives, and that nothing can stop.
//!
//! The contact force on a tool lies at each slave node in the cone about -n, with n the normal of the tool there and the
//! friction coefficient μ. It can do something against a driving force f, of which only the free directions count, when
//!
//! ```text
//!     n·f + μ |f - (n·f) n| > 0,
//! ```
//!
//! and against a torque in the sense of w = ± a x (x - p), the velocity of the tool at the node, with w for f. Where this holds
//! for none of the slave nodes in reach, there is no equilibrium, in whatever increments it is sought. With the normal forces P
//! that there are, the moment, or the force, is at most the sum of P (n·w + μ |w - (n·w) n|): where nothing but a torque changes in
//! a step, and goes from [`TAKEN`] of that beyond it, the tool spins: one that wedges is held by normal forces that grow with
//! the torque, and is far from that. Elsewhere it is so, or the tool slides, where no shorter increment is left; friction
//! that force and torque share is one size, so that the squares of what each takes of its most add up.

use super::Simulation;
use super::conditions::Conditions;
use super::step::Frame;
use crate::Vec3;
use crate::contact::{Axle, Interference};
use crate::failure::{Cause, Failure};
use crate::parallel::{any, sum};
use std::fmt::Write;

/// Rounding of the work of a unit force.
const ROUNDING: f64 = 1e-12;
/// Share of what can be held at which a tool spins or slides if no increment is found: some friction goes another way.
const NEARLY: f64 = 0.98;

/// Share of the same that a torque has already taken where it comes to spin the tool.
const TAKEN: f64 = 0.9;

/// What drives a tool.
enum Drive {
    Force(Vec3),
    /// Its axis, and its size with the sense in which it drives.
    Torque(Axle, f64),
}

/// What slave nodes can do against a drive.
#[derive(Default)]
struct Hold {
    /// Nodes in reach, and those that can do something.
    in_reach: usize,
    can_hold: usize,
    /// The most moment or force with the normal forces that there are, where these do not grow with it.
    most: f64,
}

impl Simulation<'_> {
    /// What is wrong with a tool that nothing in reach can hold against its force or torque at fraction `end` of the step, with
    /// its slave nodes as they were at the last converged increment, at fraction `done`; `None` when all can be held, as far as is
    /// known. At the `last` attempt a torque need not be all that changes, and may stand beside a force. Collective.
    pub(super) fn runaway(&self, frame: &Frame, [done, end]: [f64; 2], last: bool) -> Option<Failure> {
        let conditions = frame.conditions();
        let tools = &self.model.masters.tools;
        for (t, tool) in tools.iter().enumerate() {
            let (free, axle) = conditions.driven(t, &tool.committed);
            let total = conditions.tool_forces[t].at(end);
            let force = Vec3::from_fn(|d, _| if free[d] { total[d] } else { 0.0 });
            let torque =
                |axle: Axle| Drive::Torque(axle, conditions.tool_forces[tools.len() + t].at(end).x * axle.lever);
            let drives = [axle.map(torque), Some(Drive::Force(force))].into_iter().flatten().filter(Drive::acts);
            let held = |drive: Drive| {
                let hold = self.against(t, &drive);
                (drive, hold)
            };
            let drives: Vec<(Drive, Hold)> = drives.map(held).collect();
            let taken: f64 = drives.iter().map(|(drive, hold)| (drive.size() / hold.most).powi(2)).sum();
            let is_loose = |(drive, hold): &&(Drive, Hold)| {
                let spins = match drive {
                    _ if last => taken > NEARLY.powi(2) && hold.most.is_finite(),
                    Drive::Torque(axle, _) => {
                        let before = (conditions.tool_forces[tools.len() + t].at(done).x * axle.lever).abs();
                        let goes_beyond = drive.size() > hold.most && before > TAKEN * hold.most;
                        goes_beyond && only_torques_change(self, conditions)
                    }
                    Drive::Force(_) => false,
                };
                hold.can_hold == 0 || spins
            };
            if let Some((drive, hold)) = drives.iter().find(is_loose) {
                let is_shared = drives.len() > 1 && drive.size() < hold.most;
                let what = tell(frame, self.state.time, &tool.name, (drive, hold, is_shared));
                let (step, time) = (frame.name().to_string(), self.state.time);
                return Some(Failure { cause: Cause::Runaway, step, time, what, ..Failure::default() });
            }
        }
        None
    }

    /// What the slave nodes of a tool can do against a drive. Collective.
    fn against(&self, t: usize, drive: &Drive) -> Hold {
        let mut sums = [0.0; 4];
        for pair in self.model.pairs.iter().filter(|pair| pair.master.tool() == Some(t)) {
            for (slave, at) in pair.slaves.iter().filter_map(|s| Some((s, s.accepted.projection?))) {
                let by = drive.velocity(&at.slave());
                let along = at.normal.dot(&by);
                let against = along + pair.rules.friction * (by - at.normal * along).norm();
                sums[0] += 1.0;
                sums[1] += f64::from(against > ROUNDING * by.norm());
                // What goes into the slave bears the more, the farther it goes; a turn does not bring what is apart.
                let meets = matches!(drive, Drive::Force(_)) || slave.accepted.force != Vec3::zeros();
                let presses = along > ROUNDING * by.norm() && meets;
                sums[3] += f64::from(presses);
                sums[2] += (against * at.normal.dot(&slave.accepted.on_node())).max(0.0);
            }
        }
        sum(self.comm, &mut sums);
        let most = if sums[3] > 0.0 { f64::INFINITY } else { sums[2] };
        Hold { in_reach: sums[0] as usize, can_hold: sums[1] as usize, most }
    }
}

impl Drive {
    fn acts(&self) -> bool {
        self.size() != 0.0
    }

    fn size(&self) -> f64 {
        match self {
            Self::Force(force) => force.norm(),
            Self::Torque(_, torque) => torque.abs(),
        }
    }

    /// The way of a point of the tool in the sense of the drive.
    fn velocity(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Force(force) => force.normalize(),
            Self::Torque(axle, torque) => axle.velocity(x) * (axle.lever * torque.signum()),
        }
    }
}

/// Whether all else in a step stays as it is. Collective.
fn only_torques_change(simulation: &Simulation, conditions: &Conditions) -> bool {
    let tools = simulation.model.masters.tools.len();
    let moves = conditions.prescribed.iter().flatten().any(|motion| !motion.stays())
        || conditions.motions.iter().any(|motion| motion.by != Vec3::zeros() || motion.rotation.is_some());
    let overlaps = simulation.model.pairs.iter().any(|pair| pair.rules.interference == Interference::Ramped);
    let spins = conditions.spins.iter().any(|spin| !spin.square.stays());
    let loads = conditions.loads.iter().chain(&conditions.tool_forces[..tools]).any(|load| !load.stays());
    !any(
        simulation.comm,
        moves
            || loads
            || spins
            || (overlaps && !conditions.overlaps.stays())
            || conditions.pressures.values().any(|pressure| !pressure.stays()),
    )
}

/// What is said of a tool that a drive makes loose, or one that shares what holds it with another.
fn tell(frame: &Frame, time: f64, tool: &str, (drive, hold, is_shared): (&Drive, &Hold, bool)) -> String {
    let (step, most) = (frame.name(), hold.most);
    let mut text = format!("step `{step}`, after time {time:.6}: ");
    let help = match drive {
        Drive::Force(force) if hold.can_hold > 0 => {
            let _ = write!(text, "the tool `{tool}` slides: its force comes to {:.3e}, and ", force.norm());
            let _ = match most > force.norm() {
                true => write!(
                    text,
                    "contact as it presses now does not hold that, though all its friction comes to {most:.3e}"
                ),
                false => write!(text, "contact as it presses now holds no more than {most:.3e}"),
            };
            "press it on harder first, give its contact more friction, or `move` it"
        }
        Drive::Force(force) => {
            let _ = write!(text, "nothing can hold the tool `{tool}` against its force ");
            let _ = write!(text, "({:.3e}, {:.3e}, {:.3e}): ", force.x, force.y, force.z);
            text += &match hold.in_reach {
                0 => "no slave node is in reach of it".to_string(),
                1 => "it pulls away from the slave node in reach, or along its surface without friction".to_string(),
                n => format!("it pulls away from all {n} slave nodes in reach, or along the surface without friction"),
            };
            "check the sign of `total`, and `directions`; a tool must touch what holds it: `move` it there first"
        }
        Drive::Torque(_, torque) => {
            let _ = write!(text, "the tool `{tool}` spins: its torque comes to {:.3e}, and ", torque.abs());
            text += &match hold.in_reach {
                0 => "no slave node is in reach of it".to_string(),
                _ if is_shared => {
                    format!(
                        "contact as it presses now does not hold that beside its force, though without one it held {most:.3e}"
                    )
                }
                _ if most > torque.abs() => {
                    format!("contact as it presses now does not hold that, though all its friction comes to {most:.3e}")
                }
                _ => format!("contact as it presses now holds no more than {most:.3e}"),
            };
            "press it on harder first, give its contact more friction, or turn it by `rotate` of `move`"
        }
    };
    format!("{text}\n  help: {help}")
}
