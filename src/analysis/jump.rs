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
use crate::controls::Controls;
use crate::error::Result;
use petsc::{Snes, Vector};

impl<'a> Simulation<'a> {
    /// Tries the increment to fraction `end` of the step as a jump. Collective.
    pub(super) fn jump(
        &mut self,
        frame: &mut Frame,
        (snes, x): (&mut Snes<'a>, &mut Vector<'a>),
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
        (snes, x): (&mut Snes<'a>, &mut Vector<'a>),
        end: f64,
        observer: &mut Observer,
    ) -> Result<Attempt> {
        let Controls {
            jump_drag, jump_fall, jump_rise, jump_negligible, jump_useless, jump_strongest, jump_steps, ..
        } = self.model.controls;
        let (mut drag, mut weakest) = (jump_drag, jump_drag);
        let (from, mut settled) = (self.state.u.clone(), None);
        for step in 1.. {
            frame.progress.past.clear();
            observer(&Event::Jumping { number: step, drag })?;
            let attempt = self.attempt(frame, (snes, x), (end, Share::ALL), drag * self.model.stiffness, observer)?;
            if let (Attempt::Converged(converged), None) = (&attempt, &settled) {
                settled = Some(self.settled(frame, &converged.limits));
            }
            match attempt {
                Attempt::Converged(converged) if drag == 0.0 => {
                    let attempt = self.unless_carried((&from, &settled.unwrap_or_default()), converged);
                    if matches!(attempt, Attempt::Converged(_)) {
                        self.summary.counts.jumps += 1;
                        observer(&Event::Jumped { step: frame.name(), steps: step })?;
                    }
                    return Ok(attempt);
                }
                Attempt::Converged(converged) => {
                    self.commit(frame, &converged)?;
                    weakest = drag;
                    drag =
                        if drag * jump_fall < jump_negligible || step >= jump_steps { 0.0 } else { drag * jump_fall };
                }
                failed if drag > jump_strongest || weakest < jump_useless || step >= jump_steps => return Ok(failed),
                // Close to where equilibrium ends little drives the motion: less drag lets it go.
                _ if drag == 0.0 => drag = jump_fall * weakest,
                _ => drag *= jump_rise,
            }
        }
        unreachable!("a failed attempt after many ends the way")
    }
}
