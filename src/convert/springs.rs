//! *SPRING of elements SPRING1: springs between nodes and the ground.

use super::bodies::{Bodies, Owner};
use super::cards::Notes;
use crate::error::{Error, Result};
use crate::mesh::Slot;
use crate::mesh::abaqus::{Whole, no_set};
use std::collections::BTreeMap;

/// Stiffness along x, y and z by node.
pub(super) type Springs = BTreeMap<u32, [f64; 3]>;

/// Reads all springs.
pub(super) fn read(whole: &Whole, bodies: &Bodies, notes: &mut Notes) -> Result<Springs> {
    let mut springs = Springs::new();
    let mut known = vec![false; whole.slots.len()];
    for card in whole.cards.iter().filter(|card| card.keyword.name == "SPRING") {
        let set = card.keyword.get("ELSET").unwrap_or_default();
        let elements =
            whole.elements(card.place.as_deref(), set).ok_or_else(|| no_set(&card.at, "element set", set))?;
        if let Some(&element) = elements.iter().find(|&&element| whole.kind(element) != "SPRING1") {
            let what = format!("*SPRING of elements {} cannot be converted", whole.kind(element));
            return Err(card.error(what, "the springs of a scene are between nodes and the ground, as SPRING1 is"));
        }
        let [direction, constant] = &card.rows[..] else {
            return Err(card.error("*SPRING needs a line with a direction and one with a stiffness", ""));
        };
        let axis = match direction.fields::<1>()[0].parse::<usize>() {
            Ok(dof @ 1..=3) => dof - 1,
            _ => return Err(direction.error("expected a direction 1 to 3", "a scene has no springs against rotations")),
        };
        let stiffness = constant.number(constant.fields::<1>()[0], 0.0)?;
        if stiffness <= 0.0 {
            return Err(constant.error(format!("the stiffness {stiffness:?} is not above 0"), ""));
        }
        if whole.mesh.is_section {
            let what = "*SPRING is that of the whole ring: CalculiX takes it for its wedge of 2 degrees, of which 180 make the ring";
            notes.at(&card.at, what);
        }
        for element in elements {
            let Slot::Loose([node, _]) = whole.slots[element as usize] else { continue };
            if !matches!(bodies.owners[node as usize], Owner::Body(_)) {
                let what = format!("node {} of a spring is of no body", whole.mesh.point_ids[node as usize]);
                return Err(card.error(what, "springs hold nodes of bodies that deform"));
            }
            springs.entry(node).or_default()[axis] += stiffness;
            known[element as usize] = true;
        }
    }
    let is_spring = |element: &u32| whole.kind(*element).starts_with("SPRING") && !known[*element as usize];
    match (0..known.len() as u32).find(is_spring) {
        Some(element) => {
            let what = format!("elements of type {} have no *SPRING", whole.kind(element));
            Err(Error::input_anywhere(what, "write their stiffness, or take them out of the deck"))
        }
        None => Ok(springs),
    }
}
