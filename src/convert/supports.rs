//! *BOUNDARY over the steps: displacements that hold until they are changed.

use super::amplitudes::Amplitude;
use super::loads::{Clock, carried};
use crate::error::{Error, Location, Result};
use crate::mesh::Made;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

/// Degrees of freedom: displacements along x, y and z, rotations about them.
pub(super) const DOFS: usize = 6;

/// Nodes held along one degree of freedom.
pub(super) struct Hold {
    pub at: Location,
    /// A name for the nodes.
    pub hint: String,
    pub dof: usize,
    /// All that the card names.
    pub nodes: Rc<[u32]>,
    pub amplitude: Option<usize>,
    /// Displacement from the undeformed place at the end of a step, without the factor of an amplitude; `None` where they
    /// are.
    value: Option<f64>,
    start: f64,
    /// Why it cannot go on, if it does.
    refused: Option<Error>,
    /// How many steps began before it.
    step: usize,
}

impl Hold {
    /// The displacement from the undeformed place at the fraction `s` of the step; NaN if it is not known.
    pub fn place(&self, s: f64, clock: &Clock, amplitudes: &[Amplitude]) -> f64 {
        match (self.value, self.amplitude) {
            (None, _) => self.start,
            (Some(value), Some(amplitude)) => value * clock.factor(&amplitudes[amplitude], s),
            (Some(value), None) => self.start + (value - self.start) * s,
        }
    }

    /// Whether its amplitude begins elsewhere than it is.
    pub fn jumps(&self, clock: &Clock, amplitudes: &[Amplitude]) -> bool {
        self.amplitude.is_some() && self.place(0.0, clock, amplitudes) != self.start
    }

    /// The displacement between two fractions of the step.
    pub fn by(&self, from: f64, to: f64, clock: &Clock, amplitudes: &[Amplitude]) -> f64 {
        match (self.value, self.amplitude) {
            (None, _) => 0.0,
            (Some(value), Some(amplitude)) => {
                let place = |s: f64| value * clock.factor(&amplitudes[amplitude], s);
                // A jump at the begin is part of the way.
                place(to) - if from == 0.0 { self.start } else { place(from) }
            }
            // Where the step is whole, to the last digit.
            (Some(value), None) if (from, to) == (0.0, 1.0) => value - self.start,
            (Some(value), None) => (value - self.start) * (to - from),
        }
    }
}

/// What a line of a card prescribes.
pub(super) struct Wish {
    pub at: Location,
    pub hint: String,
    pub nodes: Rc<[u32]>,
    pub dof: usize,
    pub amplitude: Option<usize>,
    /// `None`: where they are.
    pub value: Option<f64>,
}

/// All nodes that are held.
#[derive(Default)]
pub(super) struct Supports {
    pub holds: Vec<Hold>,
    /// The hold of each node.
    of: [HashMap<u32, usize>; DOFS],
    /// Displacements at the end of the last step; none before the first.
    ended: Option<[HashMap<u32, f64>; DOFS]>,
    was_reset: bool,
    step: usize,
}

impl Supports {
    /// Goes on to the next step.
    pub fn begin(&mut self, last: &Clock, next: &Clock, amplitudes: &[Amplitude]) {
        self.was_reset = false;
        self.step += 1;
        let place = |hold: usize| self.holds[hold].place(1.0, last, amplitudes);
        let ended = self.of.each_ref().map(|of| of.iter().map(|(&node, &hold)| (node, place(hold))).collect());
        let acting = self.of.each_ref().map(|of| of.values().copied().collect::<HashSet<_>>());
        for (index, hold) in self.holds.iter_mut().enumerate() {
            hold.start = hold.place(1.0, last, amplitudes);
            if acting[hold.dof].contains(&index) {
                (hold.amplitude, hold.refused) = carried(hold.amplitude, &hold.at, last, next, amplitudes);
            }
            if hold.amplitude.is_none() {
                hold.value = hold.value.map(|_| hold.start);
            }
        }
        self.ended = Some(ended);
    }

    /// After the cards of a step: holds nodes that the deck lacks where all around them are held alike.
    pub fn complete(&mut self, made: &[Made]) {
        for dof in 0..3 {
            let mut alike: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
            let what = |node: &u32| self.of(*node, dof).map(|hold| (hold.value, hold.amplitude, hold.start));
            for made in made.iter().filter(|made| !self.of[dof].contains_key(&made.node)) {
                let first = &made.around[0];
                if what(first).is_some() && made.around.iter().all(|node| what(node) == what(first)) {
                    alike.entry(self.of[dof][first]).or_default().push(made.node);
                }
            }
            for (like, nodes) in alike {
                let Hold { at, hint, amplitude, value, start, refused, step, .. } = &self.holds[like];
                self.holds.push(Hold {
                    at: at.clone(),
                    hint: format!("{hint}-middles"),
                    dof,
                    nodes: nodes.as_slice().into(),
                    amplitude: *amplitude,
                    value: *value,
                    start: *start,
                    refused: refused.clone(),
                    step: *step,
                });
                let hold = self.holds.len() - 1;
                self.of[dof].extend(nodes.into_iter().map(|node| (node, hold)));
            }
        }
    }

    /// After the cards of a step: refuses what goes on and cannot.
    pub fn check(&self) -> Result<()> {
        let refused = self.acting().into_iter().find_map(|(hold, _)| hold.refused.clone());
        refused.map_or(Ok(()), Err)
    }

    /// OP=NEW: lets all go that was held until this step; the first card of a step counts.
    pub fn reset(&mut self) {
        if !std::mem::replace(&mut self.was_reset, true) {
            self.of = Default::default();
        }
    }

    /// Holds nodes, in the place of what holds them until now. Returns one that this step already holds otherwise.
    pub fn add(&mut self, wish: Wish) -> Result<Option<u32>> {
        let differs =
            |hold: &Hold| hold.step == self.step && (hold.value, hold.amplitude) != (wish.value, wish.amplitude);
        let is_twice = |node: &&u32| self.of(**node, wish.dof).is_some_and(differs);
        let twice = wish.nodes.iter().find(is_twice).copied();
        // Nodes that begin at different places move by different ways.
        let mut begins: Vec<(f64, usize)> = Vec::new();
        for &node in wish.nodes.iter() {
            let start = self.start(&wish, node)?;
            let known = begins.iter().find(|(other, _)| other.to_bits() == start.to_bits());
            let hold = match known {
                Some((_, hold)) => *hold,
                None => {
                    let Wish { at, hint, nodes, dof, amplitude, value } = &wish;
                    self.holds.push(Hold {
                        at: at.clone(),
                        hint: hint.clone(),
                        dof: *dof,
                        nodes: nodes.clone(),
                        amplitude: *amplitude,
                        value: *value,
                        start,
                        refused: None,
                        step: self.step,
                    });
                    begins.push((start, self.holds.len() - 1));
                    self.holds.len() - 1
                }
            };
            self.of[wish.dof].insert(node, hold);
        }
        Ok(twice)
    }

    /// Where a node is when the step begins.
    fn start(&self, wish: &Wish, node: u32) -> Result<f64> {
        let Some(ended) = &self.ended else { return Ok(0.0) };
        let known = ended[wish.dof].get(&node).copied().filter(|place| !place.is_nan());
        match (known, wish.value) {
            (Some(place), _) => Ok(place),
            (None, None) => Ok(f64::NAN),
            (None, Some(_)) => {
                let what = "nodes that were free in the step before are brought to a given displacement, from one that only the \
                            computation tells";
                let help = "hold them from the first step on; or where they are, by *BOUNDARY, FIXED";
                Err(Error::input(&wish.at, what, help))
            }
        }
    }

    /// The hold of a node along a degree of freedom.
    pub fn of(&self, node: u32, dof: usize) -> Option<&Hold> {
        self.of[dof].get(&node).map(|&hold| &self.holds[hold])
    }

    /// The nodes that stay at their undeformed places along x, y and z.
    pub fn still(&self) -> [HashSet<u32>; 3] {
        let is_still = |hold: &Hold| hold.start == 0.0 && hold.value.unwrap_or(0.0) == 0.0;
        let along = |dof: usize| self.of[dof].iter().filter(|(_, hold)| is_still(&self.holds[**hold]));
        [0, 1, 2].map(|dof| along(dof).map(|(&node, _)| node).collect())
    }

    /// The holds that act, each with the nodes that it still has.
    pub fn acting(&self) -> Vec<(&Hold, Vec<u32>)> {
        let numbered = self.holds.iter().enumerate();
        let with_nodes = numbered.map(|(index, hold)| {
            let of = &self.of[hold.dof];
            (hold, hold.nodes.iter().copied().filter(|node| of.get(node) == Some(&index)).collect::<Vec<_>>())
        });
        with_nodes.filter(|(_, nodes)| !nodes.is_empty()).collect()
    }
}
