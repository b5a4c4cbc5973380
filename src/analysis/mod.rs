//! The analysis: steps, increments, one nonlinear solve each, and what is kept of them.
//!
//! - [`Simulation`]: what a driver has in hand; [`run`] is the driver of the command line
//! - [`State`], [`Checkpoint`]: what it remembers
//! - [`Event`]: what it says while it goes on
//! - `conditions`: what a step prescribes
//! - `step`: one step: its equations, its increments, what becomes of each
//! - `newton`: one increment as a nonlinear problem for SNES, and its contact part
//! - `increments`: how long the next increment is
//! - `ladder`, `jump`: what is tried when it does not converge
//! - `hold`: what holds bodies and tools
//! - `shared_nodes`: nodes that bear several contacts with friction, or a driven tool where they cannot give way
//! - [`preflight`]: what is checked before the first increment
//! - `watch`: whether an increment that has converged may be accepted; `intruders` looks into bodies,
//!   `between` between the nodes of slaves, `seams` between masters that lie on each other, `strays` at what no contact
//!   names, `strangers` at bodies that nothing connects, `unpaid` at energy that nothing gave
//! - `touches`: what contacts have done until now, `pace`: how fast they went on; `told`: what a run says of it at its end
//! - `results`: the history and the fields of what has converged; `grids` what has them, `body_fields` those of bodies
//! - `probes`: what the fields of bodies are at points, along lines, and on sets
//! - `restart`, `keep`: checkpoints, on any number of ranks, and what a run adds to them
//! - `estimates`: how far what has converged may be from the solution
//! - `paths`: the error of the increments
//! - `ending`: what ends a run at once
//! - `conditioning`: what makes a matrix ill-conditioned
//! - `suspects`: what of its contacts may be why it does not converge
//! - `runaway`: tools that nothing can hold
//! - [`cost`]: what a run will cost
//! - [`check`](check()): what can be known without solving
//! - [`describe`]: what is said
//!
//! The state of the last converged increment is replaced only when the next has converged. A failed increment is tried
//! again from it, shorter, until it would be shorter than the scene's minimum.

mod astride;
mod between;
mod body_fields;
mod check;
mod conditioning;
mod conditions;
pub mod cost;
pub mod describe;
mod ending;
mod estimates;
mod event;
mod grids;
mod hold;
mod hooked;
mod increments;
mod intruders;
mod jump;
mod keep;
mod ladder;
mod last_iterate;
mod newton;
mod pace;
mod paths;
pub mod preflight;
mod probes;
mod restart;
mod results;
mod run;
mod runaway;
mod seams;
mod shared_nodes;
mod simulation;
mod state;
mod step;
mod strangers;
mod strays;
mod suspects;
mod told;
mod touches;
mod unpaid;
mod watch;

pub use check::check;
pub use event::{ContactNodes, Event, Increment, Iteration, Observer, Remedy, Retried, Rounded};
pub use ladder::Way;
pub use run::{Options, run};
pub use simulation::{ContactReading, SetReading, Simulation, ToolReading};
pub use state::{Checkpoint, State};
