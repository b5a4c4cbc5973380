//! What goes over to another equilibrium in one increment, and is found there: a tool that a force drags past what friction bears, and
//! that the next bump holds, a sheet that snaps through. By how far the nodes and the tool of a contact go.

use super::Simulation;
use super::conditions::Conditions;
use super::state::Progress;
use super::touches::Touch;
use crate::Vec3;
use crate::contact::Pair;
use crate::parallel::max;

/// A way that is told of, over the facets of the slave: what a node bears may hang on where it is under a tool.
const FAR: f64 = 0.1;

/// How often such a way is what the increments of its step before would have, at their fastest, with what is prescribed in this one.
/// Before friction gives way the ways of a tool grow from one increment to the next by a half to twice.
const FASTER: f64 = 10.0;

/// How a contact goes on in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// The longest way in an increment of the step, over its share of the step; none before the first.
    fastest: f64,
    /// The longest way that was too fast, in the run, and over the facets, with that share and the time.
    pub way: f64,
    pub facets: f64,
    pub share: f64,
    pub at: f64,
}

crate::words!(Pace { fastest, way, facets, share, at });

impl Pace {
    /// Notes an increment, which is this share of its step.
    fn note(&mut self, ways: &Ways, way: f64, facet: f64, (share, at): (f64, f64)) {
        let expected = self.fastest * share + ways.prescribed;
        let is_far = self.fastest > 0.0 && ways.is_even && way > FAR * facet && way > FASTER * expected;
        if is_far && way > self.way {
            *self = Self { way, facets: way / facet, share, at, ..*self };
        }
        self.fastest = self.fastest.max(way / share);
    }
}

/// How far things go in an increment, on all ranks.
pub(super) struct Ways {
    /// What tools and nodes go along directions in which that is prescribed, at most.
    prescribed: f64,
    /// Loads have no tables, after which everything may go faster, and nothing turns.
    is_even: bool,
    /// The nodes, or the driven tool, of each contact, at most.
    of_pairs: Vec<f64>,
}

impl Simulation<'_> {
    /// Those to displacements `u` and the tools' new poses, up to fraction `end` of the step. Collective.
    pub(super) fn ways(&self, progress: &Progress, end: f64, u: &[Vec3]) -> Ways {
        let (model, conditions, begin) = (&self.model, &progress.conditions, progress.increments.done);
        let mut largest = vec![0.0, 0.0];
        for n in 0..model.part.owned {
            let by = conditions.moved(n, end) - conditions.moved(n, begin);
            largest[0] = by.iter().filter(|by| !by.is_nan()).fold(largest[0], |most: f64, by| most.max(by.abs()));
        }
        let of_tools: Vec<f64> = (model.masters.tools.iter().zip(&conditions.motions))
            .map(|(tool, motion)| {
                let by = tool.trial.displacement() - tool.committed.displacement();
                let free =
                    |is: bool| (0..3).filter(|d| motion.free[*d] == is).fold(0.0, |most: f64, d| most.max(by[d].abs()));
                largest[0] = largest[0].max(free(false));
                free(true)
            })
            .collect();
        largest[1] = f64::from(!is_even(conditions));
        largest.extend(model.pairs.iter().map(|pair: &Pair| {
            let way = |n: usize| (u[n] - self.state.u[n]).norm();
            let of_nodes = pair.slaves.iter().map(|slave| way(slave.node as usize)).fold(0.0, f64::max);
            of_nodes.max(pair.master.tool().map_or(0.0, |t| of_tools[t]))
        }));
        max(self.comm, &mut largest);
        Ways { prescribed: largest[0], is_even: largest[1] == 0.0, of_pairs: largest.split_off(2) }
    }

    /// Notes them, of contacts that touched at the last increment; the `first` of a step has nothing to be measured by, and of a jump is
    /// told anyway.
    pub(super) fn note_pace(&mut self, ways: &Ways, share: f64, [is_first, is_jump]: [bool; 2]) {
        let at = self.state.time;
        for ((touch, pair), way) in self.state.touches.iter_mut().zip(&self.model.pairs).zip(&ways.of_pairs) {
            let Touch { pace, last, .. } = touch;
            if is_first {
                pace.fastest = 0.0;
            }
            if last.now && !is_jump {
                pace.note(ways, *way, pair.facet_size, (share, at));
            }
        }
    }
}

/// Whether nothing has a table or turns on this rank.
fn is_even(conditions: &Conditions) -> bool {
    let turns = |n: usize| conditions.turns(n);
    let straight = conditions.loads.iter().chain(&conditions.tool_forces).all(|ramp| ramp.is_straight())
        && conditions.pressures.values().all(|ramp| ramp.is_straight())
        && conditions.spins.iter().all(|spin| spin.square.is_straight());
    let tools = conditions.motions.iter().all(|motion| motion.rotation.is_none() && motion.axle.is_none());
    straight && tools && !(0..conditions.prescribed.len() / 3).any(turns)
}
