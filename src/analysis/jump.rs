//! Increments over which there is no equilibrium near the last one: the structure jumps to another.
//!
//! A node that comes to a sharp corner, or to the end of the surface that it slides on, feels another force the moment
//! that it is past it. What holds the structure together may not balance that force anywhere near. As loads stand still,
//! the structure then moves until it finds another equilibrium. This motion is followed in steps, against a drag that
//! falls from step to step to nothing; slip origins, multipliers and plastic flow go along, so that friction and yielding act
//! against the motion.
//! The end is an equilibrium without drag.

use super::Simulation;
use super::newton::Share;
use super::state::Memory;
use super::step::{Attempt, Frame};
use super::{Event, Observer};
use crate::error::Result;
use petsc::{Snes, Vector};
use std::fmt::Write;

/// Drag of the first step over the largest nodal stiffness, and how it falls and rises.
const FIRST: f64 = 0.1;
const FALL: f64 = 0.25;
const RISE: f64 = 8.0;
/// Over the largest nodal stiffness: below the first, there may be no more need of it; below the second and beyond the third,
/// there is no use.
const NEGLIGIBLE: f64 = 1e-4;
const USELESS: f64 = 1e-9;
const STRONGEST: f64 = 100.0;
const STEPS: usize = 100;

impl Simulation<'_> {
    /// Tries the increment to fraction `end` of the step as a jump. Collective.
    pub(super) fn jump(
        &mut self,
        frame: &mut Frame,
        (snes, x): (&mut Snes, &mut Vector),
        end: f64,
        observer: &mut Observer,
    ) -> Result<Attempt> {
        let (state, memory, offsets) = (self.state.clone(), Memory::of(&self.model), frame.progress.offsets.clone());
        let attempt = self.drag_along(frame, (snes, x), end, observer);
        if !matches!(attempt, Ok(Attempt::Converged(_))) {
            self.state = state;
            memory.give(&mut self.model);
            frame.progress.offsets = offsets;
        }
        attempt
    }

    /// Follows the motion, and makes its steps the state. Collective.
    fn drag_along(
        &mut self,
        frame: &mut Frame,
        (snes, x): (&mut Snes, &mut Vector),
        end: f64,
        observer: &mut Observer,
    ) -> Result<Attempt> {
        let (mut drag, mut weakest, mut way) = (FIRST, FIRST, String::new());
        for step in 1.. {
            frame.progress.past.clear();
            let attempt = self.attempt(frame, (snes, x), (end, Share::ALL), drag * self.model.stiffness, observer)?;
            let _ = write!(way, " {drag:.1e}{}", if matches!(attempt, Attempt::Failed(_)) { "!" } else { "" });
            match attempt {
                Attempt::Converged(converged) if drag == 0.0 => {
                    self.summary.jumps += 1;
                    observer(&Event::Jumped { step: frame.name(), steps: step })?;
                    observer(&Event::Detail(&format!("    drag over stiffness (! failed):{way}")))?;
                    return Ok(Attempt::Converged(converged));
                }
                Attempt::Converged(converged) => {
                    self.commit(frame, &converged)?;
                    weakest = drag;
                    drag = if drag * FALL < NEGLIGIBLE || step >= STEPS { 0.0 } else { drag * FALL };
                }
                failed if drag > STRONGEST || weakest < USELESS || step >= STEPS => {
                    observer(&Event::Detail(&format!("    drag over stiffness (! failed):{way}")))?;
                    return Ok(failed);
                }
                // Close to where equilibrium ends little drives the motion: less drag lets it go.
                _ if drag == 0.0 => drag = FALL * weakest,
                _ => drag *= RISE,
            }
        }
        unreachable!("a failed attempt after many ends the way")
    }
}
