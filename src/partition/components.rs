//! Parts of bodies that share no nodes with the rest: what holds one of them holds no other.

use super::Bounds;
use crate::Vec3;

/// A part of a body that hangs together.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    pub body: u32,
    /// It is all of its body.
    pub is_whole: bool,
    /// Its node with the lowest number, by this number in the mesh file, and where it is.
    pub node: u64,
    pub place: Vec3,
    /// The box around its nodes.
    pub bounds: Bounds,
}

/// For each of so many nodes the lowest that elements join it with.
pub fn lowest_joined<'a>(count: usize, elements: impl Iterator<Item = &'a [u32]>) -> Vec<u32> {
    let mut lowest: Vec<u32> = (0..count as u32).collect();
    let root = |lowest: &mut [u32], mut n: u32| {
        while lowest[n as usize] != n {
            lowest[n as usize] = lowest[lowest[n as usize] as usize];
            n = lowest[n as usize];
        }
        n
    };
    for nodes in elements {
        for pair in nodes.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|n| root(&mut lowest, n));
            lowest[a.max(b) as usize] = a.min(b);
        }
    }
    (0..count as u32).map(|n| root(&mut lowest, n)).collect()
}

impl Component {
    /// Length of [`Self::to_words`].
    pub const WORDS: usize = 12;

    /// As words, to be sent to another rank.
    pub fn to_words(&self) -> [u64; Self::WORDS] {
        let (low, high) = &self.bounds;
        let mut places = [&self.place, low, high].into_iter().flatten();
        std::array::from_fn(|k| match k {
            0 => u64::from(self.body),
            1 => u64::from(self.is_whole),
            2 => self.node,
            _ => places.next().copied().unwrap_or_default().to_bits(),
        })
    }

    /// That of [`Self::to_words`].
    pub fn from_words(words: &[u64; Self::WORDS]) -> Self {
        let place = |k: usize| Vec3::from_fn(|d, _| f64::from_bits(words[3 + 3 * k + d]));
        Self {
            body: words[0] as u32,
            is_whole: words[1] == 1,
            node: words[2],
            place: place(0),
            bounds: (place(1), place(2)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_join_nodes() {
        let elements: [&[u32]; 4] = [&[5, 4], &[0, 3], &[3, 6, 1], &[4, 7]];
        assert_eq!(lowest_joined(8, elements.into_iter()), [0, 0, 2, 0, 4, 4, 0, 4]);
        let long: Vec<[u32; 2]> = (0..999).rev().map(|n| [n, n + 1]).collect();
        assert!(lowest_joined(1000, long.iter().map(|pair| &pair[..])).iter().all(|n| *n == 0));
    }

    #[test]
    fn words_come_back() {
        let of = |x: f64| Vec3::new(x, -x, 2.0 * x);
        let one = Component { body: 3, is_whole: true, node: 77, place: of(1.5), bounds: (of(-2.0), of(9.0)) };
        assert_eq!(Component::from_words(&one.to_words()), one);
    }
}
