//! One outside for all faces.
//!
//! Joined faces must agree about the outside: going around each with its inside to the left, the common rim is passed in
//! opposite directions. From the first face on, which keeps the orientation of the file, faces are turned over as this
//! asks for; a model in which that is impossible, like a Möbius strip, is an error.

use super::sew::Sewing;
use crate::error::{Error, Result};
use crate::surface::Face;
use std::collections::{BTreeMap, VecDeque};

/// Share of a join of two faces that may ask for the opposite orientation: ends of rims, folds.
const MINORITY: f64 = 0.2;

impl Sewing {
    /// Decides which faces to turn over. Fails, naming the faces, when they cannot agree.
    pub fn orient(&mut self, faces: &[Face], flip: bool) -> Result<()> {
        let votes = self.votes();
        let mut neighbours = vec![Vec::new(); faces.len()];
        for (&(a, b), &[same, opposite]) in &votes {
            if same.min(opposite) > MINORITY * (same + opposite) || a == b && opposite > same {
                return Err(conflict(&faces[a], &faces[b]));
            }
            neighbours[a].push((b, opposite > same));
            neighbours[b].push((a, opposite > same));
        }
        let mut known: Vec<Option<bool>> = vec![None; faces.len()];
        for first in 0..faces.len() {
            if known[first].is_none() {
                known[first] = Some(flip);
                let mut open = VecDeque::from([(first, flip)]);
                while let Some((face, turned)) = open.pop_front() {
                    for &(other, opposite) in &neighbours[face] {
                        match known[other] {
                            None => {
                                known[other] = Some(turned != opposite);
                                open.push_back((other, turned != opposite));
                            }
                            Some(found) if found != (turned != opposite) => {
                                return Err(conflict(&faces[face.min(other)], &faces[face.max(other)]));
                            }
                            Some(_) => {}
                        }
                    }
                }
            }
        }
        self.turned = known.into_iter().map(|turned| turned == Some(true)).collect();
        Ok(())
    }

    /// For each pair of joined faces, how many samples of their rims say that they agree, and how many that they do not.
    fn votes(&self) -> BTreeMap<(usize, usize), [f64; 2]> {
        let mut votes: BTreeMap<(usize, usize), [f64; 2]> = BTreeMap::new();
        for (face, border) in self.borders.iter().enumerate() {
            for curve in (0..border.curves.len()).filter(|k| !border.collapsed[*k]) {
                for t in self.samples(face, curve) {
                    let Some(side) = border.side(curve, t) else { continue };
                    let Some(join) = self.join(face, curve, &side) else { continue };
                    let agrees = side.around().dot(&join.side.around()) < 0.0;
                    let pair = (face.min(join.face), face.max(join.face));
                    votes.entry(pair).or_default()[!agrees as usize] += 1.0;
                }
            }
        }
        votes
    }
}

fn conflict(a: &Face, b: &Face) -> Error {
    let what = if std::ptr::eq(a, b) {
        format!("{} joins itself with the outside in", a.name)
    } else {
        let (a, b) = (&a.name, &b.name);
        format!("{a} and {b} meet with the outside of one at the inside of the other, however they are turned")
    };
    Error::input_anywhere(what, "give a surface with two sides, or a smaller sewing tolerance")
}
