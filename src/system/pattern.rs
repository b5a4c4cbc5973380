//! The compressed-row pattern of this rank's rows, built from elements and contact.
//!
//! The rows of a node's displacements have the same columns: elements and contact couple nodes, not directions. So columns
//! are found once a node, by its elements, and what contact adds is kept apart until then. Within a row the columns ascend,
//! and the free displacements of a node stand side by side: where an element's entries are is known by a number for each
//! pair of its nodes.

use super::axes::Axes;
use super::candidates::Candidates;
use super::dofs::{DofMap, NONE};
use super::foreign::Foreign;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::elements::carrying;
use crate::parallel::{agree, sum};
use crate::partition::Lists;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// Length from which a row is rid of repetitions, and then whenever it has grown to twice what was left.
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
    /// For each element of the part, carrying nodes a by b: where in the rows of a the free columns of b begin.
    /// [`NOWHERE`] where there is no such row or column.
    elements: Vec<u32>,
    /// Where each element begins in `elements`.
    starts: Vec<u32>,
    /// The first free row of each local node; [`NOWHERE`] if it is another rank's, or none.
    rows: Vec<u32>,
    /// For each local node and direction the position among its free directions, or -1.
    shift: Vec<[i8; 3]>,
    /// The directions of the local nodes.
    axes: Axes,
    /// Entries of contact elements of this rank in rows of others.
    pub foreign: Foreign,
    /// What it provides for.
    pub candidates: Candidates,
}

impl Pattern {
    /// Entries on all ranks. Collective.
    pub fn entries(&self, comm: &SimpleCommunicator) -> u64 {
        let mut entries = [self.columns.len() as f64];
        sum(comm, &mut entries);
        entries[0] as u64
    }

    /// Builds the pattern for elements and contact, with slave nodes at `place` and deformable masters as they are.
    /// Collective.
    ///
    /// # Errors
    /// More unknowns, or entries on a rank, than PETSc's indices count, on all ranks.
    pub fn new(comm: &SimpleCommunicator, model: &Model, dofs: &DofMap, place: impl Fn(u32) -> Vec3) -> Result<Self> {
        countable(dofs.total, "unknowns")?;
        let mut pattern = Self { candidates: Candidates::new(&model.pairs, &model.masters, place), ..Self::default() };
        pattern.axes.clone_from(&dofs.axes);
        pattern.shift = dofs.node.iter().map(positions).collect();
        let first = |equations: &[i64; 3]| equations.iter().find_map(|&e| dofs.local(e));
        pattern.rows = dofs.node.iter().map(|equations| first(equations).map_or(NOWHERE, |row| row as u32)).collect();
        let mut node_of = vec![NOWHERE; dofs.count];
        for node in (0..model.part.owned).filter(|n| model.part.tie[*n] as usize == *n) {
            for row in dofs.node[node].iter().filter_map(|&e| dofs.local(e)) {
                node_of[row] = node as u32;
            }
        }
        let mut added = Added { dofs, rows: &pattern.rows, node_of, columns: BTreeMap::new() };
        for (pair, multipliers) in model.pairs.iter().zip(&dofs.multiplier) {
            for (slave, equations) in pair.slaves.iter().zip(multipliers) {
                let of_node = free(&dofs.node[slave.node as usize]).chain(free(equations));
                added.couple(&of_node.map(i64::from).collect::<Vec<_>>());
            }
        }
        // Tools that nothing touches yet have a stiffness, too.
        for &equation in dofs.tool.iter().flatten() {
            dofs.local(equation).into_iter().for_each(|row| added.push(row, &[equation as i32]));
        }
        let groups = pattern.candidates.groups(comm, &model.pairs, &model.masters, dofs);
        let mut foreign: Vec<[i32; 2]> = groups.iter().flat_map(|group| added.couple(group)).collect();
        drop(groups);
        for (joint, equations) in model.joints.iter().zip(&dofs.tie) {
            let of_masters = dofs.of_masters(comm, joint);
            for (slave, equations) in joint.slaves.iter().zip(equations) {
                free(equations).for_each(|e| added.couple_one([i64::from(e); 2], &mut foreign));
                let own = dofs.node[slave.node as usize];
                slave.couplings(equations, own, &of_masters, |entry, _| added.couple_one(entry, &mut foreign));
            }
        }
        let (foreign, received) = Foreign::new(comm, foreign, &dofs.starts);
        received.iter().for_each(|[row, column]| added.push((i64::from(*row) - dofs.first) as usize, &[*column]));
        let Added { node_of, columns, .. } = added;
        pattern.fill(model, dofs, &node_of, columns);
        pattern.foreign = foreign;
        agree(comm, countable(pattern.columns.len() as u64, "entries on a rank"))?;
        pattern.find_places(model, dofs);
        let local = |[row, column]: &[i32; 2]| pattern.place((i64::from(*row) - dofs.first) as usize, *column);
        let places = received.iter().map(local).collect();
        pattern.foreign.receive_at(places);
        Ok(pattern)
    }

    /// Writes the columns of all rows: those that elements couple with a node, and what else is added to its rows.
    fn fill(&mut self, model: &Model, dofs: &DofMap, node_of: &[u32], mut added: BTreeMap<usize, Row>) {
        let part = &model.part;
        let touching = Lists::new(part.owned, part.solids.len(), |e, each| {
            let nodes = carrying(model, &part.solids[e]).iter().map(|&n| part.tie[n as usize] as usize);
            nodes.filter(|&n| n < part.owned).for_each(each);
        });
        let mut seen = vec![NOWHERE; self.rows.len()];
        let mut columns = Vec::new();
        self.offsets.reserve(dofs.count + 1);
        self.offsets.push(0);
        let mut row = 0;
        while row < dofs.count {
            columns.clear();
            columns.extend(added.remove(&row).into_iter().flat_map(|row| row.columns));
            let mut rows = 1;
            if node_of[row] != NOWHERE {
                let node = node_of[row];
                let solids = touching.of(node as usize).iter().map(|&e| &part.solids[e as usize]);
                let beside = solids.flat_map(|solid| carrying(model, solid));
                let new = beside.filter(|&&n| std::mem::replace(&mut seen[n as usize], node) != node);
                columns.extend(new.flat_map(|&n| free(&dofs.node[n as usize])));
                rows = free(&dofs.node[node as usize]).count();
            }
            tidy(&mut columns);
            for _ in 0..rows {
                self.columns.extend(&columns);
                self.offsets.push(self.columns.len() as i32);
            }
            row += rows;
        }
    }

    fn find_places(&mut self, model: &Model, dofs: &DofMap) {
        let solids = &model.part.solids;
        let mut elements = Vec::with_capacity(solids.iter().map(|s| carrying(model, s).len().pow(2)).sum());
        let mut starts = Vec::with_capacity(solids.len());
        for nodes in solids.iter().map(|solid| carrying(model, solid)) {
            starts.push(elements.len() as u32);
            for &a in nodes {
                let row = self.rows[a as usize];
                elements.extend(nodes.iter().map(|&b| match free(&dofs.node[b as usize]).next() {
                    Some(column) if row != NOWHERE => {
                        self.place(row as usize, column) - self.offsets[row as usize] as u32
                    }
                    _ => NOWHERE,
                }));
            }
        }
        (self.elements, self.starts) = (elements, starts);
    }

    /// Place of an entry of a local row; [`NOWHERE`] if it is not in the pattern.
    pub fn place(&self, row: usize, column: i32) -> u32 {
        let start = self.offsets[row] as usize;
        let columns = &self.columns[start..self.offsets[row + 1] as usize];
        columns.binary_search(&column).map_or(NOWHERE, |k| (start + k) as u32)
    }

    /// Adds the tangent of element `element`, rows and columns 3 a node along the coordinate axes, to the values.
    pub fn add_element<const N: usize>(
        &self,
        values: &mut [f64],
        nodes: &[u32],
        element: usize,
        tangent: &[[f64; N]; N],
    ) {
        let turned = self.axes.turned(nodes, tangent);
        let tangent = turned.as_ref().unwrap_or(tangent);
        let pairs = self.elements[self.starts[element] as usize..].chunks_exact(nodes.len());
        for ((&node, rows), starts) in nodes.iter().zip(tangent.as_chunks::<3>().0).zip(pairs) {
            let row = self.rows[node as usize];
            if row == NOWHERE {
                continue;
            }
            for (shift, tangent) in self.shift[node as usize].into_iter().zip(rows).filter(|(shift, _)| *shift >= 0) {
                let offset = self.offsets[row as usize + shift as usize] as usize;
                self.add_row(&mut values[offset..], nodes, starts, tangent);
            }
        }
    }

    /// Adds a row of a tangent to the values from the start of a row on.
    fn add_row(&self, values: &mut [f64], nodes: &[u32], starts: &[u32], tangent: &[f64]) {
        for ((&start, &node), k) in starts.iter().zip(nodes).zip(tangent.as_chunks::<3>().0) {
            let start = start as usize;
            match (self.shift[node as usize], values.get_mut(start..start.wrapping_add(3))) {
                // Most nodes are free in all directions.
                ([0, 1, 2], Some(entries)) => entries.iter_mut().zip(k).for_each(|(entry, k)| *entry += k),
                (shift, _) if start != NOWHERE as usize => {
                    for (&shift, k) in shift.iter().zip(k).filter(|(s, _)| **s >= 0) {
                        values[start + shift as usize] += k;
                    }
                }
                _ => {}
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

/// Columns that contact and tools add, by row; of the rows of a node by the first.
struct Added<'a> {
    dofs: &'a DofMap,
    /// The first row of each local node.
    rows: &'a [u32],
    /// The node of each row.
    node_of: Vec<u32>,
    columns: BTreeMap<usize, Row>,
}

/// Columns that are added to a row, some of them more than once.
#[derive(Default)]
struct Row {
    columns: Vec<i32>,
    /// So many were left when it was last rid of repetitions.
    tidy: usize,
}

impl Added<'_> {
    fn push(&mut self, row: usize, columns: &[i32]) {
        let node = self.node_of[row];
        let first = if node == NOWHERE { row } else { self.rows[node as usize] as usize };
        let row = self.columns.entry(first).or_default();
        row.columns.extend(columns);
        if row.columns.len() > CROWDED.max(2 * row.tidy) {
            tidy(&mut row.columns);
            row.tidy = row.columns.len();
        }
    }

    /// Adds an entry, by row and column, or lists it as one in a row of another rank.
    fn couple_one(&mut self, [row, column]: [i64; 2], foreign: &mut Vec<[i32; 2]>) {
        match self.dofs.local(row) {
            Some(local) => self.push(local, &[column as i32]),
            None => foreign.push([row as i32, column as i32]),
        }
    }

    /// Couples equations with each other in the rows of this rank; returns the entries in rows of others.
    fn couple(&mut self, group: &[i64]) -> Vec<[i32; 2]> {
        let columns: Vec<i32> = group.iter().map(|&e| e as i32).collect();
        let mut foreign = Vec::new();
        for (&row, &number) in group.iter().zip(&columns) {
            match self.dofs.local(row) {
                Some(local) => self.push(local, &columns),
                None => foreign.extend(columns.iter().map(|&column| [number, column])),
            }
        }
        foreign
    }
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

/// The position of each direction among the free ones of a node, or -1.
fn positions(equations: &[i64; 3]) -> [i8; 3] {
    let mut next = 0;
    equations.map(|equation| {
        if equation == NONE {
            return -1;
        }
        next += 1;
        next - 1
    })
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
