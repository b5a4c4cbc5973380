//! Increments over which there is no equilibrium near the last one: the structure jumps to another.
//!
//! A node that comes to a sharp corner, or to the end of the surface that it slides on, feels another force the moment
//! that it is past it. What holds the structure together may not balance that force anywhere near. As loads stand still,
//! the structure then moves until it finds another equilibrium. This motion is followed in steps, against a drag that
//! falls from step to step to nothing; slip origins, multipliers and plastic flow go along, so that friction and yielding act
//! against the motion.
//! The end is an equilibrium without drag.

use super::Analysis;
use super::newton::Share;
use super::step::{Attempt, Frame};
use crate::Vec3;
use crate::contact::{Pair, Pose};
use crate::controls::Controls;
use crate::error::Result;
use crate::solid::history::History;
use petsc::{Snes, Vector};
use std::fmt::Write;

/// What a jump that fails leaves behind.
struct Before {
    pairs: Vec<Pair>,
    history: History,
    poses: Vec<Pose>,
    u: Vec<Vec3>,
    offsets: Vec<Vec3>,
    tool_forces: Vec<Vec3>,
    seen: Vec<f64>,
}

impl Analysis<'_> {
    /// Tries the increment to fraction `end` of the step as a jump. Collective.
    pub(super) fn jump(&mut self, frame: &mut Frame, snes: &mut Snes, x: &mut Vector, end: f64) -> Result<Attempt> {
        let before = self.before(frame);
        let attempt = self.drag_along(frame, snes, x, end);
        if !matches!(attempt, Ok(Attempt::Converged(_))) {
            self.restore(frame, before);
        }
        attempt
    }

    /// Follows the motion, and makes its steps the state. Collective.
    fn drag_along(&mut self, frame: &mut Frame, snes: &mut Snes, x: &mut Vector, end: f64) -> Result<Attempt> {
        let Controls {
            jump_drag, jump_fall, jump_rise, jump_negligible, jump_useless, jump_strongest, jump_steps, ..
        } = self.model.controls;
        let (mut drag, mut weakest, mut way) = (jump_drag, jump_drag, String::new());
        for step in 1.. {
            frame.past.clear();
            let attempt = self.attempt(frame, snes, x, (end, Share::ALL), drag * self.model.stiffness)?;
            let _ = write!(way, " {drag:.1e}{}", if matches!(attempt, Attempt::Failed(_)) { "!" } else { "" });
            match attempt {
                Attempt::Converged(converged) if drag == 0.0 => {
                    self.summary.jumps += 1;
                    let name = &frame.step.name.value;
                    self.log.line(&format!("  {name}: no equilibrium near; went on to another in {step} steps"));
                    self.log.record(&format!("    drag over stiffness (! failed):{way}"));
                    return Ok(Attempt::Converged(converged));
                }
                Attempt::Converged(converged) => {
                    self.commit(frame, &converged)?;
                    weakest = drag;
                    drag =
                        if drag * jump_fall < jump_negligible || step >= jump_steps { 0.0 } else { drag * jump_fall };
                }
                failed if drag > jump_strongest || weakest < jump_useless || step >= jump_steps => {
                    self.log.record(&format!("    drag over stiffness (! failed):{way}"));
                    return Ok(failed);
                }
                // Close to where equilibrium ends little drives the motion: less drag lets it go.
                _ if drag == 0.0 => drag = jump_fall * weakest,
                _ => drag *= jump_rise,
            }
        }
        unreachable!("a failed attempt after many ends the way")
    }

    fn before(&self, frame: &Frame) -> Before {
        Before {
            pairs: self.model.pairs.clone(),
            history: self.model.history.clone(),
            poses: self.model.tools.iter().map(|tool| tool.committed).collect(),
            u: self.state.u.clone(),
            offsets: frame.offsets.clone(),
            tool_forces: self.state.tool_forces.clone(),
            seen: self.state.seen.clone(),
        }
    }

    fn restore(&mut self, frame: &mut Frame, before: Before) {
        self.model.pairs = before.pairs;
        self.model.history = before.history;
        for (tool, pose) in self.model.tools.iter_mut().zip(before.poses) {
            tool.committed = pose;
        }
        self.state.u = before.u;
        self.state.tool_forces = before.tool_forces;
        self.state.seen = before.seen;
        frame.offsets = before.offsets;
        self.model.turn_slaves(&self.state.u);
    }
}
