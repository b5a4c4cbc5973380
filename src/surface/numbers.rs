//! Pieces of surfaces as plain numbers, to be sent to other ranks.

use super::piece::Edge;
use crate::Vec3;
use nalgebra::SVector;

/// Numbers still to be read.
pub(super) struct Numbers<'a>(pub &'a [f64]);

impl<'a> Numbers<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [f64]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub fn number(&mut self) -> Option<f64> {
        self.take(1).map(|n| n[0])
    }

    pub fn count(&mut self) -> Option<usize> {
        self.number().map(|n| n as usize)
    }

    pub fn vector(&mut self) -> Option<Vec3> {
        self.take(3).map(Vec3::from_column_slice)
    }

    pub fn vectors<const D: usize>(&mut self, count: usize) -> Option<Vec<SVector<f64, D>>> {
        let numbers = self.take(count.checked_mul(D)?)?;
        Some(numbers.chunks_exact(D).map(SVector::from_column_slice).collect())
    }
}

/// The kinds of four edges, and which of four nodes are at ends of the surface, as one number.
pub(super) fn flags(edges: &[Edge; 4], on_boundary: &[bool; 4]) -> f64 {
    let flag = |k: usize| (edges[k] as u32) << (2 * k) | (on_boundary[k] as u32) << (8 + k);
    (0..4).fold(0, |flags, k| flags | flag(k)).into()
}

/// What [`flags`] has put together.
pub(super) fn from_flags(flags: f64) -> ([Edge; 4], [bool; 4]) {
    let flags = flags as u32;
    let edge = |k: usize| [Edge::Boundary, Edge::Smooth, Edge::Sharp, Edge::Sharp][(flags >> (2 * k) & 3) as usize];
    (std::array::from_fn(edge), std::array::from_fn(|k| flags >> (8 + k) & 1 == 1))
}
