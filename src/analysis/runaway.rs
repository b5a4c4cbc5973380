//! A tool that a force drives, and that nothing can stop.
//!
//! The contact force on a tool lies at each slave node in the cone about -n, with n the normal of the tool there and the
//! friction coefficient μ. It can do something against a driving force f, of which only the free directions count, when
//!
//! ```text
//!     n·f + μ |f - (n·f) n| > 0.
//! ```
//!
//! Where this holds for none of the slave nodes in reach, there is no equilibrium, in whatever increments it is sought.

use super::Simulation;
use super::step::Frame;
use crate::Vec3;
use crate::failure::{Cause, Failure};
use crate::parallel::sum;
use std::fmt::Write;

/// Rounding of the work of a unit force.
const ROUNDING: f64 = 1e-12;

impl Simulation<'_> {
    /// What is wrong with a tool that nothing in reach can hold against its force at fraction `end` of the step, with its
    /// slave nodes as they were at the last converged increment; `None` when all can be held. Collective.
    pub(super) fn runaway(&self, frame: &Frame, end: f64) -> Option<Failure> {
        let conditions = frame.conditions();
        for (t, tool) in self.model.masters.tools.iter().enumerate() {
            let (free, total) = (conditions.motions[t].free, conditions.tool_forces[t].at(end));
            let force = Vec3::from_fn(|d, _| if free[d] { total[d] } else { 0.0 });
            let Some(direction) = force.try_normalize(0.0) else { continue };
            // Slave nodes in reach, and those that can hold it.
            let mut counts = [0.0; 2];
            for pair in self.model.pairs.iter().filter(|pair| pair.master.tool() == Some(t)) {
                for normal in pair.slaves.iter().filter_map(|s| s.accepted.projection).map(|p| p.normal) {
                    let along = normal.dot(&direction);
                    let across = (direction - normal * along).norm();
                    counts[0] += 1.0;
                    counts[1] += f64::from(along + pair.friction * across > ROUNDING);
                }
            }
            sum(self.comm, &mut counts);
            if counts[1] == 0.0 {
                let what = tell(frame, self.state.time, &tool.name, &force, counts[0] as usize);
                let (step, time) = (frame.name().to_string(), self.state.time);
                return Some(Failure { cause: Cause::Runaway, step, time, what, ..Failure::default() });
            }
        }
        None
    }
}

fn tell(frame: &Frame, time: f64, tool: &str, force: &Vec3, in_reach: usize) -> String {
    let step = frame.name();
    let mut text =
        format!("step `{step}`, after time {time:.6}: nothing can hold the tool `{tool}` against its force ");
    let _ = write!(text, "({:.3e}, {:.3e}, {:.3e}): ", force.x, force.y, force.z);
    text += &match in_reach {
        0 => "no slave node is in reach of it".to_string(),
        1 => "it pulls away from the slave node in reach, or along its surface without friction".to_string(),
        n => format!("it pulls away from all {n} slave nodes in reach, or along the surface without friction"),
    };
    text + "\n  help: check the sign of `total`, and `directions`; a tool must touch what holds it: `move` it there first"
}
