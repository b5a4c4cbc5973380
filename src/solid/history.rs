//! The states of all integration points that have any, at the last accepted increment.

use super::material::State;

/// States of the points of elements, one element after the other.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Where the states of each element begin, and the end of the last.
    starts: Vec<u32>,
    states: Vec<State>,
}

impl History {
    /// Nothing has flowed; each element has so many points with states.
    pub fn new(points: impl IntoIterator<Item = usize>) -> Self {
        let mut end = 0;
        let ends = points.into_iter().map(|count| {
            end += count as u32;
            end
        });
        let starts: Vec<u32> = std::iter::once(0).chain(ends).collect();
        Self { starts, states: vec![State::VIRGIN; end as usize] }
    }

    /// The states of an element.
    pub fn of(&self, element: usize) -> &[State] {
        &self.states[self.starts[element] as usize..self.starts[element + 1] as usize]
    }

    /// The states of an element, to be changed.
    pub fn of_mut(&mut self, element: usize) -> &mut [State] {
        &mut self.states[self.starts[element] as usize..self.starts[element + 1] as usize]
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
        let mut history = History::new([4, 0, 1]);
        history.of_mut(2)[0].equivalent = 0.5;
        assert_eq!([0, 1, 2].map(|e| history.of(e).len()), [4, 0, 1]);
        assert_eq!((history.of(0)[3], history.of(2)[0].equivalent), (State::VIRGIN, 0.5));
        assert!(!history.is_empty() && History::new([0, 0]).is_empty());
    }
}
