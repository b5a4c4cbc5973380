//! Decks of axisymmetric elements, CAX4 and CAX8 in the plane of radius x and height y: drawn out along z by one layer of hexahedra.
//!
//! Elements keep their numbers; above node n stands node n + D, D the power of ten beyond all numbers. Side Sk of an element,
//! its edge k, becomes the face S(k+2) of the hexahedron. How thick the layer is says nothing; all parts have the same. Only
//! where no element of a deck is a solid: others write the faces of solids as CAX4.

use super::super::message;
use super::super::raw::{CellShape, above};
use super::{Deck, Scope, Side};
use crate::error::Result;
use std::collections::{BTreeMap, BTreeSet};

/// Sides of a hexahedron before those that stand upright.
pub(crate) const LOWEST: u8 = 2;

/// Of the families of axisymmetric elements those that are drawn out; letters behind them change the formulation alone.
pub(crate) const DRAWN: [&str; 2] = ["CAX4", "CAX8"];

/// Whether elements of a type are drawn out.
fn is_drawn(kind: &str) -> bool {
    DRAWN.iter().any(|family| kind.starts_with(family))
}

impl Deck {
    /// Draws the axisymmetric elements out. Says whether there are any.
    ///
    /// # Errors
    /// Triangles, or nodes off the plane z = 0.
    pub(super) fn draw_out(&mut self, source: &str) -> Result<bool> {
        let is_solid = |shape: CellShape| shape.dimension() == 3;
        let scopes = || self.scopes.iter().chain(&self.parts);
        if scopes().flat_map(|scope| &scope.cells).any(|cell| is_solid(cell.shape))
            || !scopes().any(|scope| scope.drawn().next().is_some())
        {
            return Ok(false);
        }
        let refuse = |what: String, help: &str| message::whole_file(source, what, help);
        for scope in scopes() {
            if let Some(k) = scope.of_kind("CAX").find(|&k| !is_drawn(scope.kind(k))) {
                let what = format!("element {} of type {} is not computed", scope.cells[k].id, scope.kind(k));
                return Err(refuse(what, "mesh axisymmetric bodies with CAX4 or CAX8"));
            }
        }
        let width = scopes().map(Scope::first_edge).fold(0.0, f64::max);
        let most = scopes().flat_map(|scope| &scope.point_ids).max().copied().unwrap_or_default();
        // Drawn-out nodes have the next digit besides.
        let Some(above) = above(most) else {
            return Err(refuse(format!("node number {most} leaves no room for the nodes of the second plane"), ""));
        };
        self.drawn_from = Some(above);
        for scope in self.scopes.iter_mut().chain(&mut self.parts) {
            if let Some(id) = scope.draw_out(above, width) {
                return Err(refuse(format!("node {id} of an axisymmetric element is off the plane z = 0"), ""));
            }
        }
        Ok(true)
    }
}

impl Scope {
    /// The type of a cell.
    fn kind(&self, cell: usize) -> &str {
        let after = self.kinds.partition_point(|(first, _)| *first <= cell);
        after.checked_sub(1).map_or("", |at| &self.kinds[at].1)
    }

    /// The cells whose type begins so.
    fn of_kind(&self, family: &str) -> impl Iterator<Item = usize> {
        (0..self.cells.len()).filter(move |&k| self.kind(k).starts_with(family))
    }

    /// The cells that are drawn out.
    fn drawn(&self) -> impl Iterator<Item = usize> {
        (0..self.cells.len()).filter(|&k| is_drawn(self.kind(k)))
    }

    /// The length of the first edge of its first axisymmetric element.
    fn first_edge(&self) -> f64 {
        let place = |id: u64| self.point_ids.iter().position(|other| *other == id).map(|k| self.points[k]);
        let ends = self.drawn().next().map(|k| [0, 1].map(|a| place(self.cells[k].nodes[a])));
        match ends {
            Some([Some(a), Some(b)]) => (a[0] - b[0]).hypot(a[1] - b[1]),
            _ => 0.0,
        }
    }

    /// Draws its axisymmetric elements out; a node off the plane is the answer.
    fn draw_out(&mut self, above: u64, width: f64) -> Option<u64> {
        let cells: Vec<usize> = self.drawn().collect();
        let mut nodes = BTreeSet::new();
        for &k in &cells {
            let cell = &mut self.cells[k];
            let flat = std::mem::take(&mut cell.nodes);
            nodes.extend(flat.iter().copied());
            cell.shape = if flat.len() == 4 { CellShape::Hex } else { CellShape::Layer8 };
            for ends in flat.chunks(4) {
                cell.nodes.extend(ends.iter().copied());
                cell.nodes.extend(ends.iter().map(|node| node + above));
            }
        }
        let places: BTreeMap<u64, [f64; 3]> = self.point_ids.iter().copied().zip(self.points.iter().copied()).collect();
        for id in nodes {
            // What is named and not there is told where elements are placed.
            let Some([x, y, z]) = places.get(&id).copied() else { continue };
            if z != 0.0 {
                return Some(id);
            }
            self.point_ids.push(id + above);
            self.points.push([x, y, width]);
        }
        for (_, side, _) in self.surfaces.iter_mut().flat_map(|surface| &mut surface.members) {
            if let Side::Face(face @ 0..4) = side {
                *face += LOWEST;
            }
        }
        None
    }
}
