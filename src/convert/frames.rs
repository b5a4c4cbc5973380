//! *TRANSFORM: nodes whose conditions are along axes of their own.

use super::bodies::{Bodies, Owner};
use super::groups::nodes_are;
use super::springs::Springs;
use crate::Vec3;
use crate::error::Result;
use crate::mesh::abaqus::{Card, Row, Whole, no_set};
use std::collections::{BTreeMap, HashMap};

/// Distance from the global axes that is rounding.
const GLOBAL: f64 = 1e-12;

/// Directions of nodes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Frame {
    /// Unit vectors along 1, 2 and 3.
    Axes([Vec3; 3]),
    /// Away from an axis, around it, along it.
    Around { point: Vec3, axis: Vec3 },
}

/// The frames of a deck, and the nodes that have one.
#[derive(Default)]
pub(super) struct Frames {
    pub frames: Vec<Frame>,
    of: HashMap<u32, usize>,
}

impl Frames {
    /// Reads all cards.
    pub fn read(whole: &Whole, bodies: &Bodies, springs: &Springs) -> Result<Self> {
        let mut found = Self::default();
        for card in whole.cards.iter().filter(|card| card.keyword.name == "TRANSFORM") {
            if whole.mesh.is_section {
                return Err(card.error("*TRANSFORM of axisymmetric elements cannot be converted", "take global axes"));
            }
            if card.place.is_some() {
                return Err(card.error("*TRANSFORM of a part cannot be converted", "write it in the assembly"));
            }
            let set = card.keyword.get("NSET").unwrap_or_default();
            let nodes = whole.nodes(None, set).ok_or_else(|| no_set(&card.at, "node set", set))?;
            let Some(frame) = frame(card)? else { continue };
            let number = found.frames.iter().position(|known| *known == frame).unwrap_or_else(|| {
                found.frames.push(frame);
                found.frames.len() - 1
            });
            for node in nodes {
                let rigid = match bodies.owners[node as usize] {
                    Owner::Rigid(rigid) => bodies.rigids.get(rigid),
                    _ => bodies.rigids.iter().find(|rigid| rigid.nodes.contains(&node)),
                };
                if let Some(rigid) = rigid {
                    let what = format!("{} of the rigid body of {}", nodes_are(whole, &[node]), rigid.at);
                    return Err(card.error(what, "give its conditions along the global axes"));
                }
                if let Some(axis) = springs.get(&node).and_then(|along| along.iter().position(|along| *along != 0.0)) {
                    let what = format!("{} of a *SPRING along {}", nodes_are(whole, &[node]), axis + 1);
                    return Err(card.error(what, "springs along axes of their own cannot be converted"));
                }
                if found.of.insert(node, number).is_some_and(|other| other != number) {
                    let what = format!("{} of two *TRANSFORM", nodes_are(whole, &[node]));
                    return Err(card.error(what, "a node has the conditions of one frame"));
                }
            }
        }
        Ok(found)
    }

    pub fn has(&self, node: u32) -> bool {
        self.of.contains_key(&node)
    }

    /// Nodes by their frames.
    pub fn parts(&self, nodes: &[u32]) -> BTreeMap<Option<usize>, Vec<u32>> {
        let mut parts: BTreeMap<Option<usize>, Vec<u32>> = BTreeMap::new();
        nodes.iter().for_each(|node| parts.entry(self.of.get(node).copied()).or_default().push(*node));
        parts
    }
}

/// The frame of a card; `None` of the global axes.
fn frame(card: &Card) -> Result<Option<Frame>> {
    let Some(row) = card.rows.first() else { return Err(card.error("*TRANSFORM has no data", "")) };
    let [a, b] = points(row)?;
    match card.keyword.get("TYPE").unwrap_or("R").to_uppercase().as_str() {
        "R" => {
            let z = a.cross(&b);
            if z.norm() <= 1e-9 * a.norm() * b.norm() {
                return Err(row.error("the two points are in one line with the origin", ""));
            }
            let axes = [a.normalize(), z.cross(&a).normalize(), z.normalize()];
            let is_global = (0..3).all(|d| (axes[d] - Vec3::ith(d, 1.0)).amax() <= GLOBAL);
            Ok((!is_global).then_some(Frame::Axes(axes)))
        }
        "C" => match (b - a).try_normalize(0.0) {
            Some(axis) => Ok(Some(Frame::Around { point: a, axis })),
            None => Err(row.error("the two points of the axis are one", "")),
        },
        other => Err(card.error(format!("*TRANSFORM, TYPE={other} cannot be converted"), "R and C can")),
    }
}

/// Two vectors, of six fields of a line.
pub(super) fn vectors(row: &Row, fields: &[&str]) -> Result<[[f64; 3]; 2]> {
    let mut numbers = [0.0; 6];
    for (number, field) in numbers.iter_mut().zip(fields) {
        *number = row.number(field, 0.0)?;
    }
    Ok([0, 3].map(|k| [numbers[k], numbers[k + 1], numbers[k + 2]]))
}

fn points(row: &Row) -> Result<[Vec3; 2]> {
    let fields: [&str; 6] = row.fields();
    Ok(vectors(row, &fields)?.map(Vec3::from))
}
