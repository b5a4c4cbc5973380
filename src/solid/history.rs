//! The states of all integration points that have any, at the last accepted increment, and the amplitudes of enhanced strain,
//! at it and at the last tangent.

use super::element::Amplitudes;
use super::material::State;
use crate::words::Words;
use std::ops::Range;

/// What elements remember, one element after the other.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Where the states of each element begin, and the end of the last.
    starts: Vec<u32>,
    states: Vec<State>,
    /// Of each element with enhanced strain, at the last tangent.
    amplitudes: Vec<Option<Box<Amplitudes>>>,
    /// At the last accepted increment.
    accepted: Vec<Option<Box<Amplitudes>>>,
}

impl History {
    /// Nothing has flowed; each element has so many points with states, and enhanced strain or not.
    pub fn new(elements: impl IntoIterator<Item = (usize, bool)>) -> Self {
        let mut end = 0;
        let (mut starts, mut amplitudes) = (vec![0], Vec::new());
        for (points, enhanced) in elements {
            end += points as u32;
            starts.push(end);
            amplitudes.push(enhanced.then(Box::default));
        }
        Self { starts, states: vec![State::VIRGIN; end as usize], accepted: amplitudes.clone(), amplitudes }
    }

    /// The states of an element.
    pub fn of(&self, element: usize) -> &[State] {
        &self.states[self.range(element)]
    }

    /// All states.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// The places of an element's states among all.
    pub fn range(&self, element: usize) -> Range<usize> {
        self.starts[element] as usize..self.starts[element + 1] as usize
    }

    /// The amplitudes of an element with enhanced strain.
    pub fn amplitudes(&self, element: usize) -> Option<&Amplitudes> {
        self.amplitudes[element].as_deref()
    }

    /// The same, to be changed.
    pub fn amplitudes_mut(&mut self, element: usize) -> Option<&mut Amplitudes> {
        self.amplitudes[element].as_deref_mut()
    }

    /// A step begins, or a table turns.
    pub fn rest(&mut self) {
        self.states.iter_mut().for_each(|state| state.rests = true);
    }

    /// An increment is accepted, with these states and the amplitudes as they are.
    pub fn accept(&mut self, states: Vec<State>) {
        self.states = states;
        self.accepted.clone_from(&self.amplitudes);
    }

    /// The most states of an element, and whether one has enhanced strain.
    pub fn most(&self) -> (usize, bool) {
        let counts = self.starts.windows(2).map(|ends| (ends[1] - ends[0]) as usize);
        (counts.max().unwrap_or(0), self.accepted.iter().any(Option::is_some))
    }

    /// Adds what an element remembers of the last accepted increment, as much as the [`most`](Self::most) have.
    pub fn put(&self, element: usize, (points, enhanced): (usize, bool), words: &mut Vec<f64>) {
        let states = self.of(element);
        let missing = std::iter::repeat_n(&State::VIRGIN, points - states.len());
        states.iter().chain(missing).for_each(|state| state.put(words));
        if enhanced {
            self.accepted[element].as_deref().cloned().put(words);
        }
    }

    /// Makes an element remember what was [`put`](Self::put).
    pub fn take(&mut self, element: usize, (points, enhanced): (usize, bool), words: &mut &[f64]) {
        let range = self.range(element);
        let states: Vec<State> = (0..points).map(|_| State::take(words)).collect();
        let count = range.len();
        self.states[range].copy_from_slice(&states[..count]);
        if enhanced {
            self.accepted[element] = <Option<Amplitudes> as Words>::take(words).map(Box::new);
            self.amplitudes[element].clone_from(&self.accepted[element]);
        }
    }

    /// Goes back to the amplitudes of the last accepted increment.
    pub fn go_back(&mut self) {
        self.amplitudes.clone_from(&self.accepted);
    }

    /// Bytes of states and amplitudes.
    pub fn bytes(&self) -> usize {
        let enhanced = self.amplitudes.iter().chain(&self.accepted).flatten().count();
        self.states.len() * size_of::<State>() + enhanced * size_of::<Amplitudes>()
    }

    /// Whether no element has states.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_with_and_without_states() {
        let mut history = History::new([(4, false), (0, true), (1, false)]);
        let mut states = history.states().to_vec();
        states[history.range(2).start].equivalent = 0.5;
        history.accept(states);
        assert_eq!([0, 1, 2].map(|e| history.of(e).len()), [4, 0, 1]);
        assert_eq!((history.of(0)[3], history.of(2)[0].equivalent), (State::VIRGIN, 0.5));
        assert_eq!(history.bytes(), 5 * size_of::<State>() + 2 * size_of::<Amplitudes>());
        assert_eq!(History::new([(0, false), (0, false)]).bytes(), 0);
        assert!(!history.is_empty() && History::new([(0, false), (0, true)]).is_empty());
        assert_eq!([0, 1, 2].map(|e| history.amplitudes(e).is_some()), [false, true, false]);
    }
}
