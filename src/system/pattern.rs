//! The compressed-row pattern of this rank's rows, built from elements and contact.
//!
//! Within a row the columns ascend, so the free displacements of a node stand side by side: the place of an element's
//! entries is found once for each (row, node) and then only looked up.

use super::candidates::Candidates;
use super::dofs::{DofMap, NONE};
use super::foreign::Foreign;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::elements::carrying;
use crate::parallel::agree;
use mpi::topology::SimpleCommunicator;

/// Length from which a row is rid of repetitions: long before it is crowded with them.
const CROWDED: usize = 600;

/// No entry.
pub const NOWHERE: u32 = u32::MAX;

/// Rows of this rank, compressed.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    /// Start of each row in `columns`, and the end of the last.
    pub offsets: Vec<i32>,
    /// Global columns, ascending in each row.
    pub columns: Vec<i32>,
    /// For each element of the part, rows `3 a + i` by nodes b: the place of the first free column of node b.
    elements: Vec<Vec<u32>>,
    /// For each local node and direction the position among its free directions, or -1.
    shift: Vec<[i8; 3]>,
    /// Entries of contact elements of this rank in rows of others.
    pub foreign: Foreign,
    /// What it provides for.
    pub candidates: Candidates,
}

impl Pattern {
    /// Builds the pattern for elements and contact, with slave nodes at `place` and deformable masters as they are.
    /// Collective.
    ///
    /// # Errors
    /// More unknowns, or entries on a rank, than PETSc's indices count, on all ranks.
    pub fn new(comm: &SimpleCommunicator, model: &Model, dofs: &DofMap, place: impl Fn(u32) -> Vec3) -> Result<Self> {
        countable(dofs.total, "unknowns")?;
        let part = &model.part;
        let mut rows: Vec<Vec<i32>> = vec![Vec::new(); dofs.count];
        for solid in &part.solids {
            let nodes = carrying(model, solid);
            let columns: Vec<i32> = nodes.iter().flat_map(|&n| free(&dofs.node[n as usize])).collect();
            for row in nodes.iter().flat_map(|&n| dofs.node[n as usize]).filter_map(|e| dofs.local(e)) {
                rows[row].extend(&columns);
            }
            for row in nodes.iter().flat_map(|&n| dofs.node[n as usize]).filter_map(|e| dofs.local(e)) {
                if rows[row].len() > CROWDED {
                    tidy(&mut rows[row]);
                }
            }
        }
        for (pair, multipliers) in model.pairs.iter().zip(&dofs.multiplier) {
            for (slave, equations) in pair.slaves.iter().zip(multipliers) {
                let of_node: Vec<i32> = free(&dofs.node[slave.node as usize]).chain(free(equations)).collect();
                for &row in &of_node {
                    rows[(i64::from(row) - dofs.first) as usize].extend(&of_node);
                }
            }
        }
        // Tools that nothing touches yet have a stiffness, too.
        for (row, equation) in dofs.tool.iter().flatten().filter_map(|&e| Some((dofs.local(e)?, e))) {
            rows[row].push(equation as i32);
        }
        let candidates = Candidates::new(&model.pairs, &model.masters, place);
        let groups = candidates.groups(comm, &model.pairs, &model.masters, dofs);
        let (foreign, received) = Foreign::new(comm, add_groups(dofs, &groups, &mut rows), &dofs.starts);
        for [row, column] in &received {
            rows[(i64::from(*row) - dofs.first) as usize].push(*column);
        }
        rows.iter_mut().for_each(tidy);
        agree(comm, countable(rows.iter().map(Vec::len).sum::<usize>() as u64, "entries on a rank"))?;
        let mut pattern = Self { offsets: vec![0], foreign, candidates, ..Self::default() };
        for row in &rows {
            pattern.columns.extend(row);
            pattern.offsets.push(pattern.columns.len() as i32);
        }
        pattern.find_places(model, dofs);
        let local = |[row, column]: &[i32; 2]| pattern.place((i64::from(*row) - dofs.first) as usize, *column);
        let places = received.iter().map(local).collect();
        pattern.foreign.receive_at(places);
        Ok(pattern)
    }

    fn find_places(&mut self, model: &Model, dofs: &DofMap) {
        self.shift = dofs
            .node
            .iter()
            .map(|e| {
                let mut next = 0;
                e.map(|equation| {
                    if equation == NONE {
                        return -1;
                    }
                    next += 1;
                    next - 1
                })
            })
            .collect();
        self.elements =
            model.part.solids.iter().map(|solid| self.element_places(carrying(model, solid), dofs)).collect();
    }

    fn element_places(&self, nodes: &[u32], dofs: &DofMap) -> Vec<u32> {
        let mut places = Vec::with_capacity(3 * nodes.len() * nodes.len());
        for row in nodes.iter().flat_map(|&a| dofs.node[a as usize]).map(|e| dofs.local(e)) {
            for &b in nodes {
                places.push(match (row, free(&dofs.node[b as usize]).next()) {
                    (Some(row), Some(column)) => self.place(row, column),
                    _ => NOWHERE,
                });
            }
        }
        places
    }

    /// Place of an entry of a local row; [`NOWHERE`] if it is not in the pattern.
    pub fn place(&self, row: usize, column: i32) -> u32 {
        let start = self.offsets[row] as usize;
        let columns = &self.columns[start..self.offsets[row + 1] as usize];
        columns.binary_search(&column).map_or(NOWHERE, |k| (start + k) as u32)
    }

    /// Adds the tangent of element `element`, rows and columns 3 a node, to the values.
    pub fn add_element<const N: usize>(
        &self,
        values: &mut [f64],
        nodes: &[u32],
        element: usize,
        tangent: &[[f64; N]; N],
    ) {
        let places = self.elements[element].chunks_exact(nodes.len());
        for (row, places) in tangent.iter().zip(places) {
            for ((&place, &node), k) in places.iter().zip(nodes).zip(row.as_chunks::<3>().0) {
                let place = place as usize;
                match (self.shift[node as usize], values.get_mut(place..place.wrapping_add(3))) {
                    // Most nodes are free in all directions.
                    ([0, 1, 2], Some(entries)) => entries.iter_mut().zip(k).for_each(|(entry, k)| *entry += k),
                    (shift, _) if place != NOWHERE as usize => {
                        for (&shift, k) in shift.iter().zip(k).filter(|(s, _)| **s >= 0) {
                            values[place + shift as usize] += k;
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    /// Adds one entry of a local row. An entry outside the pattern is a defect of the pattern.
    pub fn add(&self, values: &mut [f64], row: usize, column: i64, value: f64) {
        let place = self.place(row, column as i32);
        debug_assert_ne!(place, NOWHERE, "({row}, {column}) is not in the pattern");
        values[place as usize] += value;
    }
}

/// Couples the equations of each group in the rows of this rank, and returns the entries in rows of others.
fn add_groups(dofs: &DofMap, groups: &[Vec<i64>], rows: &mut [Vec<i32>]) -> Vec<[i32; 2]> {
    let mut foreign = Vec::new();
    for group in groups {
        let columns: Vec<i32> = group.iter().map(|&e| e as i32).collect();
        for (&row, &number) in group.iter().zip(&columns) {
            match dofs.local(row) {
                Some(local) => {
                    rows[local].extend(&columns);
                    if rows[local].len() > CROWDED {
                        tidy(&mut rows[local]);
                    }
                }
                None => foreign.extend(columns.iter().map(|&column| [number, column])),
            }
        }
    }
    foreign
}

/// Whether PETSc's indices, of 32 bits, count so many.
fn countable(count: u64, what: &str) -> Result<()> {
    match i32::try_from(count) {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::System(format!(
            "the matrix has {count} {what}: PETSc with indices of 32 bits counts {}\n  help: run on more ranks, or refine less",
            i32::MAX
        ))),
    }
}

fn free(equations: &[i64; 3]) -> impl Iterator<Item = i32> + '_ {
    equations.iter().filter(|&&e| e != NONE).map(|&e| e as i32)
}

fn tidy(row: &mut Vec<i32>) {
    row.sort_unstable();
    row.dedup();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_indices_count_is_refused() {
        assert!(countable(i32::MAX as u64, "unknowns").is_ok());
        let error = countable(1 << 31, "unknowns").unwrap_err().to_string();
        assert!(error.starts_with("the matrix has 2147483648 unknowns: "), "{error}");
    }
}
