//! Structs as numbers: how a checkpoint holds what a run remembers.
//!
//! Every value becomes a row of numbers, of the same length whatever it is: what is not there leaves zeros in its place.
//! [`words!`](crate::words!) does so for a struct and names all its fields, so that none can be forgotten.

use crate::{Mat3, Vec3};

/// A value that is written as numbers, and read back from them exactly.
pub trait Words: Sized {
    /// Adds its numbers.
    fn put(&self, words: &mut Vec<f64>);

    /// Takes as many numbers as [`Self::put`] adds; zeros where there are no more.
    fn take(words: &mut &[f64]) -> Self;

    /// The numbers of one value.
    fn to_words(&self) -> Vec<f64> {
        let mut words = Vec::new();
        self.put(&mut words);
        words
    }
}

/// A struct as the numbers of all its fields, one after the other.
#[macro_export]
macro_rules! words {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::words::Words for $name {
            fn put(&self, words: &mut Vec<f64>) {
                let Self { $($field),* } = self;
                $($crate::words::Words::put($field, words);)*
            }

            fn take(words: &mut &[f64]) -> Self {
                $(let $field = $crate::words::Words::take(words);)*
                Self { $($field),* }
            }
        }
    };
}

/// One of several, by its place among them.
#[macro_export]
macro_rules! choices {
    ($name:ident { $($choice:ident),* $(,)? }) => {
        impl $crate::words::Words for $name {
            fn put(&self, words: &mut Vec<f64>) {
                let place = [$(Self::$choice),*].iter().position(|choice| choice == self);
                $crate::words::Words::put(&place.unwrap_or_default(), words);
            }

            fn take(words: &mut &[f64]) -> Self {
                let all = [$(Self::$choice),*];
                let place: usize = $crate::words::Words::take(words);
                all.get(place).copied().unwrap_or(all[0])
            }
        }
    };
}

impl Words for f64 {
    fn put(&self, words: &mut Vec<f64>) {
        words.push(*self);
    }

    fn take(words: &mut &[f64]) -> Self {
        words.split_off_first().copied().unwrap_or_default()
    }
}

/// Whole numbers up to 2^53 are exact.
macro_rules! whole {
    ($($kind:ty),*) => {
        $(impl Words for $kind {
            fn put(&self, words: &mut Vec<f64>) {
                words.push(*self as f64);
            }

            fn take(words: &mut &[f64]) -> Self {
                f64::take(words) as $kind
            }
        })*
    };
}

whole!(u32, u64, usize);

impl Words for bool {
    fn put(&self, words: &mut Vec<f64>) {
        words.push(f64::from(*self));
    }

    fn take(words: &mut &[f64]) -> Self {
        f64::take(words) != 0.0
    }
}

impl<T: Words, const N: usize> Words for [T; N] {
    fn put(&self, words: &mut Vec<f64>) {
        self.iter().for_each(|value| value.put(words));
    }

    fn take(words: &mut &[f64]) -> Self {
        std::array::from_fn(|_| T::take(words))
    }
}

impl Words for Vec3 {
    fn put(&self, words: &mut Vec<f64>) {
        words.extend(self);
    }

    fn take(words: &mut &[f64]) -> Self {
        Self::from(<[f64; 3]>::take(words))
    }
}

impl Words for Mat3 {
    fn put(&self, words: &mut Vec<f64>) {
        words.extend(self);
    }

    fn take(words: &mut &[f64]) -> Self {
        Self::from_column_slice(&<[f64; 9]>::take(words))
    }
}

impl<A: Words, B: Words> Words for (A, B) {
    fn put(&self, words: &mut Vec<f64>) {
        self.0.put(words);
        self.1.put(words);
    }

    fn take(words: &mut &[f64]) -> Self {
        (A::take(words), B::take(words))
    }
}

impl<T: Words + Default> Words for Option<T> {
    fn put(&self, words: &mut Vec<f64>) {
        self.is_some().put(words);
        match self {
            Some(value) => value.put(words),
            None => words.extend(T::default().to_words().iter().map(|_| 0.0)),
        }
    }

    fn take(words: &mut &[f64]) -> Self {
        let (is_some, value) = (bool::take(words), T::take(words));
        is_some.then_some(value)
    }
}

/// Behind its length: the one kind of value that is not always as long.
impl<T: Words> Words for Vec<T> {
    fn put(&self, words: &mut Vec<f64>) {
        self.len().put(words);
        self.iter().for_each(|value| value.put(words));
    }

    fn take(words: &mut &[f64]) -> Self {
        // No more than there can be: a length that is none must not take the memory.
        let count = usize::take(words).min(words.len());
        (0..count).map(|_| T::take(words)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, PartialEq)]
    struct Thing {
        place: Option<Vec3>,
        piece: Option<(u32, [f64; 2])>,
        turns: Mat3,
        counts: Vec<usize>,
        is_in: bool,
    }

    words!(Thing { place, piece, turns, counts, is_in });

    #[test]
    fn what_is_put_is_taken() {
        let thing = Thing {
            place: None,
            piece: Some((u32::MAX, [0.1, -0.0])),
            turns: Mat3::from_fn(|i, j| (i + 3 * j) as f64 + 0.1),
            counts: vec![7, 1 << 52],
            is_in: true,
        };
        let mut words = thing.to_words();
        let length = words.len();
        Thing { place: Some(Vec3::repeat(f64::INFINITY)), ..thing.clone() }.put(&mut words);
        assert_eq!(words.len(), 2 * length);
        let mut rest = &words[..];
        assert_eq!(Thing::take(&mut rest), thing);
        assert_eq!(Thing::take(&mut rest).place, Some(Vec3::repeat(f64::INFINITY)));
        assert!(rest.is_empty());
        assert_eq!(f64::take(&mut rest), 0.0);
    }
}
