//! What a solve costs, before it is made.
//!
//! - this module: which solver systems of a size ask for
//! - `work`: what is counted, and how long each takes; [`machine`]: the same as measured, and kept
//! - [`calibrate`]: measures it
//! - [`size`]: how large a scene is; [`predict`]: what it will take

pub mod calibrate;
pub mod machine;
pub mod predict;
pub mod size;
pub mod work;

use crate::scene::Linear;

/// How systems of so many unknowns are solved, which `Auto` leaves open. Factors take the square of their number in work, in a
/// plane and of sheets its power 3/2. On two cores, under a ball, multigrid takes a third of the time of factors at 14,500
/// unknowns, and half to two thirds of that of factors that serve several systems; below 10,000 all take seconds. On a sheet of
/// one solid-shell its iterations do not end at 61,000 unknowns, and at 119,000 it takes twice the time and as much memory.
pub fn solver(linear: Linear, unknowns: u64, is_flat: bool) -> Linear {
    const MANY: u64 = 10_000;
    const MANY_IF_FLAT: u64 = 200_000;
    match linear {
        Linear::Auto if unknowns >= if is_flat { MANY_IF_FLAT } else { MANY } => Linear::Iterative,
        Linear::Auto => Linear::Reuse,
        given => given,
    }
}

/// Iterations of multigrid a system above which factors that serve several are cheaper, which `Auto` leaves open. An
/// iteration takes time with the unknowns, a factorization with their square. Where factors take gigabytes, no number is too
/// large.
pub fn patience(linear: Linear, unknowns: u64) -> usize {
    const LEAST: u64 = 40;
    const UNKNOWNS_AN_ITERATION: u64 = 1250;
    const MANY: u64 = 100_000;
    if linear == Linear::Auto && unknowns < MANY {
        LEAST.max(unknowns / UNKNOWNS_AN_ITERATION) as usize
    } else {
        usize::MAX
    }
}

/// How many of its applications a factorization must cost to serve several systems, which `Auto` leaves open: below, what
/// FGMRES itself costs outweighs it. Some 1,000 unknowns cost 6, 7,500 in a layer 7, 14,500 in a block 22.
pub fn least_worth(linear: Linear) -> usize {
    if linear == Linear::Auto { 7 } else { 0 }
}
