//! FGMRES with algebraic multigrid, for systems of displacements with contact multipliers.
//!
//! A system [A_uu A_ul; A_lu A_ll] has no positive diagonal at its multipliers, and multigrid does not take it. For the
//! preconditioner each contact gives way a little: with D = A_ll - ε²/k I, which is regular and block-diagonal by slave node,
//! S = A_uu - A_ul D⁻¹ A_lu is a stiffness of the bodies with springs k where they touch, ε being the size of A_ul. One V-cycle
//! on S and the way back, x_u = AMG(r_u - A_ul D⁻¹ r_l), x_l = D⁻¹ (r_l - A_lu x_u), precondition the whole system, which FGMRES
//! solves to its true residual: of k nothing is left in the solution. Springs as stiff as the bodies are take the fewest
//! iterations; ones twenty times as stiff twice as many, and on several ranks, whose smoothers do not see across, four times.
//!
//! Multigrid wants nodes of three unknowns, and the rigid motions of a body. Directions that are fixed, which have no row in
//! A, are rows of their own in S, with a diagonal alone; nodes that are fixed in all directions are left out.

use std::collections::{BTreeSet, HashMap};
use std::ptr::{null_mut, slice_from_raw_parts};
use std::time::Instant;

use mpi::collective::SystemOperation;
use mpi::datatype::{Equivalence, PartitionMut};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

use crate::error::{Error, check, forget};
use crate::krylov::{Iterated, Krylov, Preconditioner};
use crate::linear::{LinearError, LinearStatistics};
use crate::matrix::Matrix;
use crate::runtime::{Petsc, c_string};
use crate::sys;
use crate::vector::{Array, ArrayMut, Vector};

/// Iterations after which a direct solution is cheaper, or the only one.
const MAX_ITERATIONS: usize = 150;
/// What setting multigrid up costs, in iterations of a solve: it is set up anew when the old one has cost as many more, or
/// will, for a contact that has come or gone since costs one or two.
const SET_UP: usize = 15;
/// Options of multigrid where none are given.
const DEFAULTS: [(&str, &str); 4] = [
    ("amg_pc_type", "ml"),
    ("amg_mg_levels_ksp_type", "richardson"),
    ("amg_mg_levels_pc_type", "sor"),
    ("amg_mg_levels_ksp_max_it", "1"),
];

/// What the rows of this rank belong to.
#[derive(Clone, Debug, Default)]
pub struct Unknowns {
    /// In the order of their rows.
    pub nodes: Vec<Node>,
    pub multipliers: Vec<Multipliers>,
}

/// The multipliers of a slave node.
#[derive(Clone, Copy, Debug)]
pub struct Multipliers {
    /// Their rows, which follow each other: the first, counted on this rank, and how many, 1 to 3.
    pub first: u32,
    pub count: u32,
    /// With what stiffness the bodies resist there, force per length.
    pub stiffness: f64,
}

/// A node of a body, or a tool that a force drives.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Rows of its displacements, counted on this rank; `None` where it is fixed.
    pub rows: [Option<u32>; 3],
    /// The directions of these, unit vectors.
    pub directions: [[f64; 3]; 3],
    pub position: [f64; 3],
}

/// The iterative solver of one system.
pub(crate) struct Multigrid<'p> {
    petsc: &'p Petsc<'p>,
    unknowns: Unknowns,
    krylov: Krylov<'p>,
    reduced: Option<Reduced<'p>>,
    /// Iterations of the first solve after multigrid was set up, and how many more others have taken since, in all.
    fresh: Option<usize>,
    excess: usize,
}

/// S for one pattern of A, and what leads there and back.
struct Reduced<'p> {
    /// Pattern of A that it is of.
    pattern: u64,
    whole: Whole,
    offsets: Vec<i32>,
    columns: Vec<i32>,
    entries: Vec<f64>,
    matrix: Matrix<'p>,
    amg: sys::PC,
    /// Of each row of S on this rank its row in A on this rank, if it has one.
    rows: Vec<Option<u32>>,
    /// The multipliers of this rank, with D⁻¹.
    blocks: Vec<Block>,
    /// D⁻¹ when multigrid was set up.
    then: Vec<Small>,
    couplings: Option<Couplings<'p>>,
    /// In S's layout.
    load: Vector<'p>,
    motion: Vector<'p>,
}

/// A, as it is looked at to get rid of its multipliers.
struct Whole {
    /// It outlives this.
    raw: sys::Mat,
    /// Of each row on any rank its row in S, or -1 - the first row of its multipliers.
    map: Vec<i32>,
    /// First row of this rank.
    first: usize,
    /// k of the multipliers whose first row is this.
    stiffness: HashMap<i32, f64>,
    /// Copies of the rows of multipliers that rows of this rank have entries for, and of its own.
    lent: *mut sys::Mat,
    /// These rows, ascending.
    lent_rows: Vec<i32>,
}

/// A_ul and A_lu without their empty rows and columns.
struct Couplings<'p> {
    /// Rows of A: those of multipliers, and those of displacements with entries for multipliers.
    forces: Rows,
    motions: Rows,
    /// Of the latter on this rank the rows of S, counted there.
    reduced: Vec<u32>,
    /// A_ul and A_lu.
    from_forces: sys::Mat,
    from_motions: sys::Mat,
    /// In their layouts.
    force: Vector<'p>,
    motion: Vector<'p>,
}

/// Some rows of a matrix.
struct Rows {
    set: sys::IS,
}

/// The multipliers of a slave node: first row on this rank, place of that among all multipliers there, and D⁻¹.
struct Block {
    first: usize,
    place: usize,
    inverse: Small,
}

/// D⁻¹ A_lu of the multipliers of a slave node, by columns of S.
struct Elimination {
    columns: Vec<i32>,
    /// Row by row.
    entries: Vec<f64>,
    inverse: Small,
}

/// A dense matrix of 1 to 3 rows.
#[derive(Clone, Copy)]
struct Small {
    size: usize,
    a: [[f64; 3]; 3],
}

impl<'p> Multigrid<'p> {
    /// A solver of systems with these unknowns. Collective.
    pub(crate) fn new(petsc: &'p Petsc<'p>, unknowns: Unknowns) -> Result<Self, Error> {
        Ok(Self { petsc, unknowns, krylov: Krylov::new(petsc)?, reduced: None, fresh: None, excess: 0 })
    }

    /// The nodes where they are now; the next set-up has the rigid motions about there.
    pub(crate) fn place(&mut self, nodes: Vec<Node>) {
        self.unknowns.nodes = nodes;
    }

    /// Tries to solve A x = b, from x = 0: ||b - A x|| / ||b||, `None` where it does not converge. Collective.
    ///
    /// Multigrid is that of an earlier matrix, as long as this costs less than another set-up: contacts that have come or gone
    /// since cost an iteration or two each.
    ///
    /// # Safety
    /// Live vectors of the matrix's layout, distinct; `b` comes with its norm.
    pub(crate) unsafe fn solve(
        &mut self,
        matrix: &Matrix,
        (b, norm): (sys::Vec, f64),
        x: sys::Vec,
        statistics: &mut LinearStatistics,
    ) -> Result<Option<f64>, LinearError> {
        loop {
            let begun = Instant::now();
            let set_up = self.set_up(matrix);
            statistics.set_up_s += begun.elapsed().as_secs_f64();
            if set_up.is_err() {
                // Multigrid raises what others call a breakdown.
                (self.reduced, self.fresh) = (None, None);
                forget();
                return Ok(None);
            }
            let begun = Instant::now();
            let is_fresh = self.fresh.is_none();
            let most = self.fresh.map_or(MAX_ITERATIONS, |fresh| 3 * (fresh + SET_UP));
            let Some(reduced) = &mut self.reduced else { return Ok(None) };
            let most = most.min(MAX_ITERATIONS);
            // SAFETY: as for this function.
            let Iterated { solved, iterations } = unsafe { self.krylov.solve(matrix, (b, norm), x, reduced, most) }?;
            statistics.iterate_s += begun.elapsed().as_secs_f64();
            statistics.krylov_iterations += iterations;
            let fresh = *self.fresh.get_or_insert(iterations);
            self.excess += iterations.saturating_sub(fresh);
            if solved.is_none() || self.excess > SET_UP {
                (self.fresh, self.excess) = (None, 0);
            }
            if solved.is_some() || is_fresh {
                statistics.iterative_solves += usize::from(solved.is_some());
                return Ok(solved);
            }
        }
    }

    /// Brings what takes the multipliers away up to date, and multigrid, too, if it is to be fresh. Collective.
    fn set_up(&mut self, matrix: &Matrix) -> Result<(), Error> {
        let pattern = matrix.version().pattern;
        let is_new = self.reduced.as_ref().is_none_or(|reduced| reduced.pattern != pattern);
        if is_new {
            (self.reduced, self.fresh, self.excess) = (None, None, 0);
            self.reduced = Some(Reduced::new(self.petsc, matrix, &self.unknowns)?);
        }
        let Some(reduced) = &mut self.reduced else { return Ok(()) };
        if !is_new {
            reduced.whole.lend(sys::MAT_REUSE_MATRIX)?;
            if let Some(couplings) = &mut reduced.couplings {
                couplings.copy(&reduced.whole, sys::MAT_REUSE_MATRIX)?;
            }
        }
        let lent = reduced.whole.eliminations()?;
        reduced.take_blocks(&lent, &self.unknowns);
        if self.excess + reduced.changes(self.petsc) > SET_UP {
            (self.fresh, self.excess) = (None, 0);
        }
        if self.fresh.is_none() {
            reduced.then = reduced.blocks.iter().map(|block| block.inverse).collect();
            reduced.fill(&lent)?;
            reduced.matrix.update(&reduced.entries)?;
            let raw = reduced.matrix.raw();
            set_rigid_motions(self.petsc, raw, &self.unknowns.nodes)?;
            // SAFETY: live objects.
            unsafe {
                check(sys::PCSetOperators(reduced.amg, raw, raw))?;
                check(sys::PCSetUp(reduced.amg))?;
            }
        }
        Ok(())
    }
}

impl Whole {
    /// Collective.
    fn new(petsc: &Petsc, matrix: &Matrix, unknowns: &Unknowns) -> Result<Self, Error> {
        let (raw, local) = (matrix.raw(), matrix.local_rows());
        let (mut first, mut end) = (0, 0);
        // SAFETY: a live matrix, and places for the answers.
        check(unsafe { sys::MatGetOwnershipRange(raw, &mut first, &mut end) })?;
        let first = first as usize;
        let map = map(petsc, local, first, unknowns)?;
        let own = &map[first..first + local];
        let mut met: BTreeSet<i32> = own.iter().copied().filter(|to| *to < 0).collect();
        for row in (0..local).filter(|row| own[*row] >= 0) {
            with_row(raw, first + row, |columns, _| {
                met.extend(columns.iter().map(|column| map[*column as usize]).filter(|to| *to < 0));
            })?;
        }
        let mut lent_rows: Vec<i32> = met.iter().flat_map(|code| rows_of(&map, -1 - code)).collect();
        lent_rows.sort_unstable();
        let stiffness = stiffnesses(petsc, first, unknowns);
        let mut whole = Self { raw, map, first, stiffness, lent: null_mut(), lent_rows };
        whole.lend(sys::MAT_INITIAL_MATRIX)?;
        Ok(whole)
    }

    /// Copies the rows with multipliers, or brings the copies up to date. Collective.
    fn lend(&mut self, how: sys::MatReuse) -> Result<(), Error> {
        let alone = SimpleCommunicator::self_comm();
        let (mut rows, mut columns) = (null_mut(), null_mut());
        let (count, all) = (self.lent_rows.len() as i32, self.map.len() as i32);
        // SAFETY: live objects; the index sets are destroyed here, the copies stay.
        unsafe {
            let own = self.lent_rows.as_ptr();
            check(sys::ISCreateGeneral(alone.as_raw(), count, own, sys::PETSC_COPY_VALUES, &mut rows))?;
            check(sys::ISCreateStride(alone.as_raw(), all, 0, 1, &mut columns))?;
            let copied = check(sys::MatCreateSubMatrices(self.raw, 1, &rows, &columns, how, &mut self.lent));
            check(sys::ISDestroy(&mut rows))?;
            check(sys::ISDestroy(&mut columns))?;
            copied
        }
    }

    /// What a row of this rank has, `k` counted here.
    fn with_row(&self, k: u32, see: impl FnOnce(&[i32], &[f64])) -> Result<(), Error> {
        with_row(self.raw, self.first + k as usize, see)
    }

    /// D⁻¹ A_lu of all multipliers that rows of this rank meet, and of its own.
    fn eliminations(&self) -> Result<HashMap<i32, Elimination>, Error> {
        let mut all = HashMap::new();
        let code = |row: &i32| self.map[*row as usize];
        let mut k = 0;
        for group in self.lent_rows.chunk_by(|a, b| code(a) == code(b)) {
            all.insert(code(&group[0]), self.eliminate(k, group)?);
            k += group.len();
        }
        Ok(all)
    }

    /// The same of one group, whose copies begin with row `k`.
    fn eliminate(&self, k: usize, group: &[i32]) -> Result<Elimination, Error> {
        let (head, size) = (group[0], group.len());
        // SAFETY: as many matrices as were lent: one.
        let lent = unsafe { *self.lent };
        let (mut d, mut couplings) = (Small { size, a: [[0.0; 3]; 3] }, Vec::new());
        for a in 0..size {
            with_row(lent, k + a, |columns, values| {
                for (column, value) in columns.iter().zip(values) {
                    match self.map[*column as usize] {
                        to @ 0.. => couplings.push((to, a, *value)),
                        _ if group.contains(column) => d.a[a][(column - head) as usize] = *value,
                        _ => {}
                    }
                }
            })?;
        }
        let inside = d.a.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
        let scale = couplings.iter().fold(inside, |most, (.., value)| most.max(value.abs()));
        let slack = scale * scale / self.stiffness[&head];
        (0..size).for_each(|a| d.a[a][a] -= slack);
        let inverse = d.inverse();
        let mut columns: Vec<i32> = couplings.iter().map(|(to, ..)| *to).collect();
        columns.sort_unstable();
        columns.dedup();
        let mut entries = vec![0.0; size * columns.len()];
        for (to, b, value) in couplings {
            let c = columns.partition_point(|column| *column < to);
            for a in 0..size {
                entries[a * columns.len() + c] += inverse.a[a][b] * value;
            }
        }
        Ok(Elimination { columns, entries, inverse })
    }
}

impl Drop for Whole {
    fn drop(&mut self) {
        // SAFETY: NULL, or what was lent.
        unsafe { sys::MatDestroySubMatrices(1, &mut self.lent) };
    }
}

impl<'p> Reduced<'p> {
    /// S with its columns, and no values yet. Collective.
    fn new(petsc: &'p Petsc<'p>, matrix: &Matrix, unknowns: &Unknowns) -> Result<Self, Error> {
        for (name, value) in DEFAULTS {
            if !petsc.has_option(name)? {
                petsc.option(name, value)?;
                // Asked for: nobody is told that another kind of multigrid does not ask for it.
                petsc.has_option(name)?;
            }
        }
        let whole = Whole::new(petsc, matrix, unknowns)?;
        let lent = whole.eliminations()?;
        let rows: Vec<Option<u32>> = unknowns.nodes.iter().flat_map(|node| node.rows).collect();
        let start = start_of(petsc, rows.len());
        let (mut offsets, mut columns, mut of_row) = (vec![0], Vec::new(), Vec::new());
        for (k, row) in rows.iter().enumerate() {
            of_row.clear();
            match row {
                None => of_row.push((start + k) as i32),
                Some(row) => whole.with_row(*row, |of_whole, _| {
                    for column in of_whole {
                        match whole.map[*column as usize] {
                            to @ 0.. => of_row.push(to),
                            group => of_row.extend(&lent[&group].columns),
                        }
                    }
                })?,
            }
            of_row.sort_unstable();
            of_row.dedup();
            columns.extend(&of_row);
            offsets.push(columns.len() as i32);
        }
        petsc.require(columns.len() <= i32::MAX as usize, || {
            format!("{} entries on a rank are more than 32-bit indices can count", columns.len())
        })?;
        let entries = vec![0.0; columns.len()];
        let reduced = Matrix::from_csr(petsc, rows.len(), &offsets, &columns, &entries)?;
        let (amg_prefix, mut amg) = (c_string("amg_")?, null_mut());
        // SAFETY: a live matrix and communicator, a place for the handle, a text that PETSc copies.
        unsafe {
            check(sys::MatSetBlockSize(reduced.raw(), 3))?;
            check(sys::PCCreate(petsc.raw_comm(), &mut amg))?;
            check(sys::PCSetOptionsPrefix(amg, amg_prefix.as_ptr()))?;
            check(sys::PCSetOperators(amg, reduced.raw(), reduced.raw()))?;
            check(sys::PCSetFromOptions(amg))?;
        }
        let has_multipliers = petsc.any(!whole.lent_rows.is_empty());
        let couplings = if has_multipliers { Some(Couplings::new(petsc, &whole, unknowns)?) } else { None };
        let of_reduced = rows.len();
        Ok(Self {
            pattern: matrix.version().pattern,
            whole,
            offsets,
            columns,
            entries,
            matrix: reduced,
            amg,
            rows,
            blocks: Vec::new(),
            then: Vec::new(),
            couplings,
            load: Vector::zeros(petsc, of_reduced)?,
            motion: Vector::zeros(petsc, of_reduced)?,
        })
    }

    /// D⁻¹ of the multipliers of this rank.
    fn take_blocks(&mut self, lent: &HashMap<i32, Elimination>, unknowns: &Unknowns) {
        let (whole, mut place) = (&self.whole, 0);
        let block = |of_node: &Multipliers| {
            let (first, count) = (of_node.first as usize, of_node.count as usize);
            place += count;
            Block { first, place: place - count, inverse: lent[&whole.map[whole.first + first]].inverse }
        };
        self.blocks = unknowns.multipliers.iter().map(block).collect();
    }

    /// On how many slave nodes of all ranks the contact is another than when multigrid was set up. Collective.
    fn changes(&self, petsc: &Petsc) -> usize {
        let is_other = |(now, then): (&Block, &Small)| now.inverse.is_other(then);
        let (mine, mut all) = (self.blocks.iter().zip(&self.then).filter(|pair| is_other(*pair)).count() as u64, 0);
        petsc.own().all_reduce_into(&mine, &mut all, SystemOperation::sum());
        all as usize
    }

    /// The values of S from those of A.
    fn fill(&mut self, lent: &HashMap<i32, Elimination>) -> Result<(), Error> {
        let whole = &self.whole;
        for (node, of_node) in self.rows.chunks_exact(3).enumerate() {
            let (mut diagonal, mut free) = (0.0f64, 0.0);
            for (d, row) in of_node.iter().enumerate() {
                let Some(row) = row else { continue };
                let range = self.offsets[3 * node + d] as usize..self.offsets[3 * node + d + 1] as usize;
                let (columns, entries) = (&self.columns[range.clone()], &mut self.entries[range]);
                entries.fill(0.0);
                whole.with_row(*row, |of_row, values| {
                    // Both ascend, so that the next place is after the last.
                    let mut at = 0;
                    for (column, value) in of_row.iter().zip(values) {
                        let to = whole.map[*column as usize];
                        if to >= 0 {
                            at += columns[at..].partition_point(|c| *c < to);
                            entries[at] += value;
                            if *column as usize == whole.first + *row as usize {
                                diagonal += value.abs();
                                free += 1.0;
                            }
                        } else if *value != 0.0 {
                            let group = &lent[&to];
                            let of_multiplier = (column - (-1 - to)) as usize * group.columns.len();
                            for (to, w) in group.columns.iter().zip(&group.entries[of_multiplier..]) {
                                entries[columns.partition_point(|c| c < to)] -= value * w;
                            }
                        }
                    }
                })?;
            }
            let diagonal = if diagonal > 0.0 { diagonal / free } else { 1.0 };
            for (d, _) in of_node.iter().enumerate().filter(|(_, row)| row.is_none()) {
                self.entries[self.offsets[3 * node + d] as usize] = diagonal;
            }
        }
        Ok(())
    }
}

impl Preconditioner for Reduced<'_> {
    /// z from r, see the head of the module. Collective.
    ///
    /// # Safety
    /// Live vectors of A's layout, distinct.
    unsafe fn apply(&mut self, r: sys::Vec, z: sys::Vec) -> Result<(), LinearError> {
        // SAFETY: the caller vouches for the vectors, which are distinct.
        let (r, mut z) = unsafe { (Array::new(r)?, ArrayMut::new(z)?) };
        {
            let mut load = self.load.array_mut()?;
            load.iter_mut().zip(&self.rows).for_each(|(load, row)| *load = row.map_or(0.0, |row| r[row as usize]));
        }
        if let Some(couplings) = &mut self.couplings {
            {
                let mut force = couplings.force.array_mut()?;
                for block in &self.blocks {
                    block.inverse.times(&r[block.first..], &mut force[block.place..]);
                }
            }
            couplings.motions_from_forces()?;
            let (motion, mut load) = (couplings.motion.array()?, self.load.array_mut()?);
            for (by, at) in motion.iter().zip(&couplings.reduced) {
                load[*at as usize] -= by;
            }
        }
        // SAFETY: a live preconditioner, and vectors of its matrix's layout.
        check(unsafe { sys::PCApply(self.amg, self.load.raw(), self.motion.raw()) })?;
        let motion = self.motion.array()?;
        for (motion, row) in motion.iter().zip(&self.rows) {
            if let Some(row) = row {
                z[*row as usize] = *motion;
            }
        }
        if let Some(couplings) = &mut self.couplings {
            {
                let mut of_motions = couplings.motion.array_mut()?;
                let places = couplings.reduced.iter();
                of_motions.iter_mut().zip(places).for_each(|(to, at)| *to = motion[*at as usize]);
            }
            couplings.forces_from_motions()?;
            let image = couplings.force.array()?;
            for block in &self.blocks {
                let mut left = [0.0; 3];
                (0..block.inverse.size).for_each(|a| left[a] = r[block.first + a] - image[block.place + a]);
                block.inverse.times(&left, &mut z[block.first..]);
            }
        }
        Ok(())
    }
}

impl<'p> Couplings<'p> {
    /// Collective.
    fn new(petsc: &'p Petsc<'p>, whole: &Whole, unknowns: &Unknowns) -> Result<Self, Error> {
        let forces: Vec<u32> = unknowns.multipliers.iter().flat_map(|m| m.first..m.first + m.count).collect();
        let (mut motions, mut reduced) = (Vec::new(), Vec::new());
        for (k, row) in unknowns.nodes.iter().flat_map(|node| node.rows).enumerate() {
            let Some(row) = row else { continue };
            whole.with_row(row, |columns, _| {
                if columns.iter().any(|column| whole.map[*column as usize] < 0) {
                    motions.push(row);
                    reduced.push(k as u32);
                }
            })?;
        }
        let (force, motion) = (Vector::zeros(petsc, forces.len())?, Vector::zeros(petsc, motions.len())?);
        let (forces, motions) = (Rows::new(petsc, whole, forces)?, Rows::new(petsc, whole, motions)?);
        let (from_forces, from_motions) = (null_mut(), null_mut());
        let mut couplings = Self { forces, motions, reduced, from_forces, from_motions, force, motion };
        couplings.copy(whole, sys::MAT_INITIAL_MATRIX)?;
        Ok(couplings)
    }

    /// Copies the entries, anew or for the first time. Collective.
    fn copy(&mut self, whole: &Whole, how: sys::MatReuse) -> Result<(), Error> {
        let (raw, forces, motions) = (whole.raw, self.forces.set, self.motions.set);
        // SAFETY: live objects, and places for the copies, or those of the same sets.
        unsafe {
            check(sys::MatCreateSubMatrix(raw, motions, forces, how, &mut self.from_forces))?;
            check(sys::MatCreateSubMatrix(raw, forces, motions, how, &mut self.from_motions))
        }
    }

    /// motion = A_ul force. Collective.
    fn motions_from_forces(&mut self) -> Result<(), Error> {
        // SAFETY: a live matrix, and vectors of its layout.
        check(unsafe { sys::MatMult(self.from_forces, self.force.raw(), self.motion.raw()) })
    }

    /// force = A_lu motion. Collective.
    fn forces_from_motions(&mut self) -> Result<(), Error> {
        // SAFETY: a live matrix, and vectors of its layout.
        check(unsafe { sys::MatMult(self.from_motions, self.motion.raw(), self.force.raw()) })
    }
}

impl Drop for Couplings<'_> {
    fn drop(&mut self) {
        // SAFETY: NULL, or live objects that nobody else holds.
        unsafe {
            sys::MatDestroy(&mut self.from_forces);
            sys::MatDestroy(&mut self.from_motions);
        }
    }
}

impl Rows {
    /// Collective.
    fn new(petsc: &Petsc, whole: &Whole, own: Vec<u32>) -> Result<Self, Error> {
        let global: Vec<i32> = own.iter().map(|row| whole.first as i32 + *row as i32).collect();
        let mut set = null_mut();
        let (comm, count, copy) = (petsc.raw_comm(), global.len() as i32, sys::PETSC_COPY_VALUES);
        // SAFETY: a live communicator, `count` indices that PETSc copies, a place for the handle.
        check(unsafe { sys::ISCreateGeneral(comm, count, global.as_ptr(), copy, &mut set) })?;
        Ok(Self { set })
    }
}

impl Drop for Rows {
    fn drop(&mut self) {
        // SAFETY: a live index set that nobody else holds.
        unsafe { sys::ISDestroy(&mut self.set) };
    }
}

impl Drop for Reduced<'_> {
    fn drop(&mut self) {
        // SAFETY: a live preconditioner that nobody else holds.
        unsafe { sys::PCDestroy(&mut self.amg) };
    }
}

impl Small {
    /// By cofactors; a block that is singular all the same is passed over.
    fn inverse(&self) -> Self {
        let m = |i: usize, j: usize| if i < self.size && j < self.size { self.a[i][j] } else { f64::from(i == j) };
        let cofactor = |i: usize, j: usize| {
            let ([a, b], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
            m(a, c) * m(b, d) - m(a, d) * m(b, c)
        };
        let determinant: f64 = (0..3).map(|j| m(0, j) * cofactor(0, j)).sum();
        let mut inverse = Self { size: self.size, a: [[0.0; 3]; 3] };
        if determinant != 0.0 {
            for i in 0..self.size {
                (0..self.size).for_each(|j| inverse.a[i][j] = cofactor(j, i) / determinant);
            }
        }
        inverse
    }

    /// Whether it differs by half of what it is, or more.
    fn is_other(&self, then: &Self) -> bool {
        let pairs = || self.a.iter().flatten().zip(then.a.iter().flatten());
        let largest = pairs().fold(0.0f64, |most, (a, b)| most.max(a.abs()).max(b.abs()));
        pairs().any(|(a, b)| (a - b).abs() > 0.5 * largest)
    }

    /// y = a x.
    fn times(&self, x: &[f64], y: &mut [f64]) {
        for (y, row) in y.iter_mut().zip(&self.a).take(self.size) {
            *y = row.iter().zip(x).take(self.size).map(|(a, x)| a * x).sum();
        }
    }
}

/// Of each row of A on any rank its row in S, or -1 - the first row of its multipliers. Collective.
fn map(petsc: &Petsc, local: usize, first: usize, unknowns: &Unknowns) -> Result<Vec<i32>, Error> {
    let comm = petsc.own();
    let count = 3 * unknowns.nodes.len();
    let start = start_of(petsc, count);
    petsc.require(start + count <= i32::MAX as usize, || {
        format!("{} rows of the preconditioner are more than PETSc's 32-bit indices can count", start + count)
    })?;
    let mut own = vec![0; local];
    for (k, row) in unknowns.nodes.iter().flat_map(|node| node.rows).enumerate() {
        if let Some(row) = row {
            own[row as usize] = (start + k) as i32;
        }
    }
    for of_node in &unknowns.multipliers {
        let (row, end) = (of_node.first as usize, (of_node.first + of_node.count) as usize);
        own[row..end].fill(-1 - (first + row) as i32);
    }
    Ok(of_all_ranks(comm, &own))
}

/// k of all multipliers, by their first rows. Collective.
fn stiffnesses(petsc: &Petsc, first: usize, unknowns: &Unknowns) -> HashMap<i32, f64> {
    let heads: Vec<i32> = unknowns.multipliers.iter().map(|m| first as i32 + m.first as i32).collect();
    let stiffness: Vec<f64> = unknowns.multipliers.iter().map(|m| m.stiffness).collect();
    of_all_ranks(petsc.own(), &heads).into_iter().zip(of_all_ranks(petsc.own(), &stiffness)).collect()
}

/// What all ranks have, one after the other. Collective.
fn of_all_ranks<T: Equivalence + Copy + Default>(comm: &SimpleCommunicator, own: &[T]) -> Vec<T> {
    let mut counts = vec![0; comm.size() as usize];
    comm.all_gather_into(&(own.len() as i32), &mut counts[..]);
    let starts: Vec<i32> = counts.iter().scan(0, |next, count| Some(std::mem::replace(next, *next + count))).collect();
    let mut all = vec![T::default(); counts.iter().sum::<i32>() as usize];
    comm.all_gather_varcount_into(own, &mut PartitionMut::new(&mut all[..], counts, starts));
    all
}

/// How many the ranks before this have. Collective.
fn start_of(petsc: &Petsc, count: usize) -> usize {
    let (mine, mut before) = (count as u64, 0);
    petsc.own().exclusive_scan_into(&mine, &mut before, SystemOperation::sum());
    if petsc.own().rank() == 0 { 0 } else { before as usize }
}

/// The rows of the multipliers whose first is `head`.
fn rows_of(map: &[i32], head: i32) -> impl Iterator<Item = i32> {
    let count = map[head as usize..].iter().take(3).take_while(move |code| **code == -1 - head).count();
    head..head + count as i32
}

/// Columns, ascending, and values of a row of this rank.
fn with_row(matrix: sys::Mat, row: usize, see: impl FnOnce(&[i32], &[f64])) -> Result<(), Error> {
    let (mut count, mut columns, mut values) = (0, std::ptr::null(), std::ptr::null());
    // SAFETY: a live matrix with this row on this rank; what PETSc hands out is read before it is given back.
    unsafe {
        check(sys::MatGetRow(matrix, row as i32, &mut count, &mut columns, &mut values))?;
        if count > 0 {
            see(&*slice_from_raw_parts(columns, count as usize), &*slice_from_raw_parts(values, count as usize));
        }
        check(sys::MatRestoreRow(matrix, row as i32, &mut count, &mut columns, &mut values))
    }
}

/// Gives S the rigid motions of its nodes, zero where they are fixed: orthonormal, and without those that nothing is left of.
/// Collective.
fn set_rigid_motions(petsc: &Petsc, matrix: sys::Mat, nodes: &[Node]) -> Result<(), Error> {
    const LEAST: f64 = 1e-6;
    let mut middle = [0.0f64; 4];
    let mine = nodes.iter().fold([0.0; 4], |[x, y, z, n], node| {
        let [a, b, c] = node.position;
        [x + a, y + b, z + c, n + 1.0]
    });
    petsc.own().all_reduce_into(&mine[..], &mut middle[..], SystemOperation::sum());
    let middle = [0, 1, 2].map(|d| middle[d] / middle[3].max(1.0));
    let motion = |k: usize, x: [f64; 3]| -> [f64; 3] {
        let [x, y, z] = [0, 1, 2].map(|d| x[d] - middle[d]);
        match k {
            0 => [1.0, 0.0, 0.0],
            1 => [0.0, 1.0, 0.0],
            2 => [0.0, 0.0, 1.0],
            3 => [0.0, -z, y],
            4 => [z, 0.0, -x],
            _ => [-y, x, 0.0],
        }
    };
    let mut kept: Vec<Vector> = Vec::new();
    for k in 0..6 {
        let of_node = |node: &Node| {
            let by = motion(k, node.position);
            let along = |direction: [f64; 3]| (0..3).map(|i| direction[i] * by[i]).sum::<f64>();
            [0, 1, 2].map(|d| if node.rows[d].is_some() { along(node.directions[d]) } else { 0.0 })
        };
        let mut vector = Vector::from_slice(petsc, &nodes.iter().flat_map(of_node).collect::<Vec<_>>())?;
        let before = vector.norm2()?;
        for _ in 0..2 {
            for other in &kept {
                let along = vector.dot(other)?;
                vector.axpy(-along, other)?;
            }
        }
        let left = vector.norm2()?;
        if left > LEAST * before {
            // SAFETY: a live vector.
            check(unsafe { sys::VecScale(vector.raw(), 1.0 / left) })?;
            kept.push(vector);
        }
    }
    let (mut space, handles): (_, Vec<_>) = (null_mut(), kept.iter().map(Vector::raw).collect());
    // SAFETY: live vectors, of which the space keeps references; the matrix keeps one to the space.
    unsafe {
        let count = handles.len() as i32;
        check(sys::MatNullSpaceCreate(petsc.raw_comm(), 0, count, handles.as_ptr(), &mut space))?;
        check(sys::MatSetNearNullSpace(matrix, space))?;
        check(sys::MatNullSpaceDestroy(&mut space))
    }
}

#[cfg(test)]
mod tests {
    use super::Small;

    #[test]
    fn small_matrices_are_inverted() {
        for size in 1..4 {
            let matrix = Small { size, a: [[4.0, 1.0, -2.0], [0.5, -3.0, 1.0], [1.0, 2.0, 5.0]] };
            let (x, mut y, mut back) = ([1.0, -2.0, 3.0], [0.0; 3], [0.0; 3]);
            matrix.times(&x, &mut y);
            matrix.inverse().times(&y, &mut back);
            (0..size).for_each(|i| assert!((back[i] - x[i]).abs() < 1e-14, "{size}"));
        }
        let null = Small { size: 2, a: [[0.0; 3]; 3] };
        assert!(null.inverse().a.iter().flatten().all(|v| *v == 0.0));
    }
}
