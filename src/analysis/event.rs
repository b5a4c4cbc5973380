//! What a simulation says while it goes on.

use super::ladder::Way;
use crate::error::Result;
pub use crate::output::log::Iteration;

/// What has happened. All ranks are told the same, at once.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// An iterate of Newton's method has been judged.
    Iteration(Iteration<'a>),
    /// An increment has failed, and is tried again.
    Retried(Retried<'a>),
    /// A step of a jump begins, from 1, against such a drag over the stiffness of the bodies.
    Jumping { number: usize, drag: f64 },
    /// The structure has jumped to another equilibrium, in so many steps.
    Jumped { step: &'a str, steps: usize },
    /// An increment has converged, and is the state.
    Increment(&'a Increment),
    /// Something the user should know.
    Warning(&'a str),
    /// What helps to understand how it went.
    Detail(&'a str),
}

/// An increment that has failed.
#[derive(Clone, Copy, Debug)]
pub struct Retried<'a> {
    pub step: &'a str,
    /// Its size, in time.
    pub size: f64,
    pub reason: &'a str,
    pub remedy: Remedy,
}

/// What is done about an increment that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// A shorter one.
    Cut,
    /// What touches goes along with its master in the first iteration.
    Follow,
    /// What is turned goes along in the first iteration, all of it.
    Carry,
    /// Friction grows a little with slip.
    Creep,
    /// What comes loose stays in place.
    Linger,
    /// Constraints give way before they are tightened.
    Yield,
    /// Multipliers of contacts that make the same conditions are held.
    Hold,
    /// Multipliers that are held have lower penalties, for rounding leaves too much of forces.
    Ease,
    /// Contacts have lower penalties, or those again that they had.
    Soften,
    /// Active sets stand still until Newton's method has converged, or no more.
    Sets,
    /// Forces of contacts grow smoothly before gaps are closed.
    Central,
    /// What touches sticks until it settles.
    Settle,
    /// What begins to touch has friction once all is in balance without it.
    Glide,
    /// What overlaps is pushed out over the step.
    Ramp,
    /// A jump.
    Jump,
}

/// The worst residual above the tolerance that was let through, since rounding leaves as much of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounded {
    /// The body, contact or tool, as in "contact `top`".
    pub of: String,
    /// Over the forces that it counts against; what was let through at most.
    pub residual: f64,
    pub limit: f64,
    /// Contacts act there, by no more than what closes a gap that is none, and more of that is lost than of loads may be.
    pub lost: bool,
}

/// A converged increment.
#[derive(Clone, Debug, PartialEq)]
pub struct Increment {
    pub step: String,
    /// From 1, over all steps.
    pub number: usize,
    /// Time at its end, and its size.
    pub time: f64,
    pub size: f64,
    /// Newton iterations, and rounds around them.
    pub iterations: usize,
    pub rounds: usize,
    /// Largest residual over the forces that it counts against at each iterate, and contact nodes that changed their status.
    pub residuals: Vec<f64>,
    pub changes: Vec<usize>,
    /// Of the body, contact or tool whose residual comes nearest to what is let through there: that residual and that limit,
    /// both over the forces that they count against.
    pub residual: f64,
    pub limit: f64,
    /// What was let through above the tolerance, if anything.
    pub rounded: Option<Rounded>,
    /// How it was found, after how many failures.
    pub way: Way,
    pub failures: usize,
    pub nodes: ContactNodes,
    /// It is the last of its step.
    pub ends_step: bool,
}

/// How many slave nodes of all ranks do what.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactNodes {
    pub touching: usize,
    pub slipping: usize,
    /// Those whose friction penalty was reduced, and one of them.
    pub calmed: usize,
    pub calmed_node: Option<String>,
}

/// Who is told; an error ends the simulation, and must be the same on all ranks.
pub type Observer<'o> = dyn FnMut(&Event) -> Result<()> + 'o;
