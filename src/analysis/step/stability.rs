//! Whether an equilibrium is stable.
//!
//! Of a symmetric tangent the pivots of its factors tell it, where the last system of an increment was factored. Where it was
//! not, or friction makes the tangent unsymmetric, it is judged at the solution, with all that touches sticking where it is:
//! friction never pushes a body on, and what is not stable with nodes that stick is not stable with nodes that slip. That
//! takes a factorization more, and is done a few times in a step, and wherever the determinant of the tangent has another sign
//! than at the last time: then one eigenvalue, or three, have changed theirs. An attempt that is refused for something else is
//! made again in shorter ones, which are judged anew.
//!
//! With F-bar, pressures that follow, and from node to node the tangent is far from symmetric with all that touches sticking, too: the
//! sign of its determinant tells alone, and of two eigenvalues that are negative nothing is known.
//!
//! A body that contacts alone hold may be free to move, and a motion that no force acts against is not unstable: it is judged on
//! the weakest springs of what lingers.

use super::super::newton::{Newton, System};
use crate::contact::{Pair, Slave};
use crate::error::Result;
use crate::parallel::any;
use petsc::{Factorization, LinearStatistics, Negative, Snes};

/// Where in a step stability was judged last, and what the factors of the tangent have told there.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    end: f64,
    factors: Negative,
}

/// How many eigenvalues of the tangent at a converged iterate are negative, as far as it is to be known there. Collective.
pub fn negative(newton: &mut Newton, snes: &mut Snes, hangs: bool, judged: &mut Option<Judged>) -> Result<Negative> {
    let System { comm, model, dofs, conditions, .. } = &newton.system;
    // What meets itself has conditions that repeat each other and give way.
    if model.pairs.iter().any(Pair::is_self) {
        return Ok(Negative::Unknown);
    }
    let LinearStatistics { negative: factors, null_pivots, .. } = snes.linear_statistics();
    let slips = || any(comm, model.pairs.iter().flat_map(|pair| &pair.slaves).any(Slave::rubs));
    // That of F-bar, of a pressure that follows, or from node to node has no symmetric part to judge by: what feels the gap there by b
    // and bears by w has a work of -ε |w - b|²/4 in it, whatever is stable.
    let has_potential = conditions.has_symmetric_bodies(model) && !model.pairs.iter().any(Pair::is_by_nodes);
    let by_sign = !has_potential || !conditions.pressures.is_empty();
    let tells = conditions.is_symmetric(model) || by_sign && !slips();
    if tells && factors != Negative::Unknown && !hangs {
        return Ok(factors);
    }
    // Where conditions repeat each other, or something is free, those that stick say no more.
    if snes.iterates() || null_pivots > 0 {
        return Ok(Negative::Unknown);
    }
    let interval = 1.0 / model.controls.stability_checks as f64;
    let has_changed = |last: Negative| ![last, factors].contains(&Negative::Unknown) && last != factors;
    let is_later = |last: Judged| newton.s <= last.end || newton.s >= last.end + (1.0 - 1e-6) * interval;
    let is_due = |last: Judged| is_later(last) || newton.s == 1.0 || has_changed(last.factors);
    if !judged.is_none_or(is_due) {
        return Ok(Negative::Unknown);
    }
    let multipliers = dofs.total_multipliers as usize;
    if hangs {
        newton.keep_weakly_in_place();
    }
    let factorization = if by_sign { Factorization::Lu } else { Factorization::Ldlt };
    let negative = match newton.stuck_tangent() {
        Some(values) => snes.negative_eigenvalues(values, factorization)?,
        None => Negative::Unknown,
    };
    // What is not stable is sought anew, and judged there.
    *judged = Some(Judged { end: newton.s, factors }).filter(|_| !negative.is_not(multipliers));
    Ok(negative)
}
