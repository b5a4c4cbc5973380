//! Who has points near whose boxes: a global search in which no rank sees more than its share.
//!
//! Space is cut into cells; those of level l are 2^l times the smallest, which are a few reaches wide. A box, grown by the
//! reach, is looked for on the level on which it is no larger than a cell, and so meets few of them. On each level that any
//! box is on, a rank puts its points into half cells, and tells where they are by the boxes around them. Codes of cells are
//! hashed to ranks, which keep for each who has points there. So a search is a message to the keepers of the cells that a
//! rank has points or boxes in, and an answer: n log n work for n things on a rank, whatever the number of ranks, if these
//! have parts of space of their own. Cells that share a code only cost a look at more boxes.

use super::parcels::{Bounds, grown, meets};
use crate::Vec3;
use crate::parallel::{Parcels, exchange, sum, union};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::BTreeMap;

/// Edge of the smallest cells over the reach: half cells are then not much larger than that.
const CELL: f64 = 3.0;
/// Words of a registration: the code of the cell and the box of the points.
const WORDS: usize = 7;
/// About as many keepers a rank talks to.
const KEEPERS: f64 = 8.0;

/// For each rank with points less than `reach` away from some of this rank's `boxes`, in each direction of space, the
/// indices of these boxes, rising; some more for which this may hold. Boxes and points that are nowhere are left out.
/// The reach is the same on all ranks. Collective.
pub fn recipients(comm: &SimpleCommunicator, boxes: &[Bounds], points: &[Vec3], reach: f64) -> Parcels<u32> {
    let grid = Grid { size: CELL * reach };
    let boxes: Vec<Bounds> = boxes.iter().map(|b| grown(*b, reach)).collect();
    let levels: Vec<Option<u32>> = boxes.iter().map(|b| grid.level(b)).collect();
    let used = union(comm, levels.iter().flatten().fold(0, |used, level| used | 1 << level));
    let groups: Vec<Group> =
        (0..u64::BITS).filter(|l| used >> l & 1 == 1).flat_map(|l| grid.groups(points, l)).collect();
    let keepers = Keepers::new(comm, groups.len());
    let directory = register(comm, &keepers, &groups);
    let codes = |k: usize| levels[k].map_or(Vec::new(), |level| grid.cells(&boxes[k], level));
    let found = ask(comm, &keepers, &directory, (0..boxes.len()).flat_map(codes));
    let mut recipients = Parcels::new();
    for (k, bounds) in boxes.iter().enumerate() {
        for (rank, points) in codes(k).iter().filter_map(|cell| found.get(&cell.code())).flatten() {
            let of_rank: &mut Vec<u32> = recipients.entry(*rank).or_default();
            if of_rank.last() != Some(&(k as u32)) && meets(bounds, points) {
                of_rank.push(k as u32);
            }
        }
    }
    recipients.retain(|_, boxes| !boxes.is_empty());
    recipients
}

/// A cell of a level, by its place among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    level: u32,
    at: [i64; 3],
}

impl Cell {
    /// A number for the cell; cells far apart may share one.
    fn code(&self) -> u64 {
        const BITS: u32 = 19;
        self.at.iter().fold(u64::from(self.level), |code, at| code << BITS | *at as u64 & ((1 << BITS) - 1))
    }
}

/// The box of some points of this rank in a half cell.
struct Group {
    cell: Cell,
    points: Bounds,
}

struct Grid {
    /// Of the smallest cells.
    size: f64,
}

impl Grid {
    /// The level on which a box is no larger than a cell; `None` for a box that is nowhere.
    fn level(&self, (lo, hi): &Bounds) -> Option<u32> {
        let level = ((hi - lo).max() / self.size).log2().ceil().max(0.0);
        (is_somewhere(lo) && is_somewhere(hi) && level < f64::from(u64::BITS)).then_some(level as u32)
    }

    fn edge(&self, level: u32) -> f64 {
        self.size * f64::from(level).exp2()
    }

    /// The cells of a level that a box meets.
    fn cells(&self, (lo, hi): &Bounds, level: u32) -> Vec<Cell> {
        let [lo, hi] = [lo, hi].map(|x| place(x, self.edge(level)));
        let along = |d: usize| lo[d]..=hi[d];
        let all = along(0).flat_map(|x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z])));
        all.map(|at| Cell { level, at }).collect()
    }

    /// The points by half cells of a level.
    fn groups(&self, points: &[Vec3], level: u32) -> Vec<Group> {
        let half = 0.5 * self.edge(level);
        let somewhere = points.iter().filter(|x| is_somewhere(x));
        let mut placed: Vec<([i64; 3], Vec3)> = somewhere.map(|x| (place(x, half), *x)).collect();
        placed.sort_unstable_by_key(|(at, _)| *at);
        let group = |run: &[([i64; 3], Vec3)]| {
            let (at, x) = run[0];
            let points = run.iter().fold((x, x), |(lo, hi), (_, x)| (lo.inf(x), hi.sup(x)));
            Group { cell: Cell { level, at: at.map(|k| k >> 1) }, points }
        };
        placed.chunk_by(|a, b| a.0 == b.0).map(group).collect()
    }
}

fn place(x: &Vec3, edge: f64) -> [i64; 3] {
    [x.x, x.y, x.z].map(|x| (x / edge).floor() as i64)
}

fn is_somewhere(x: &Vec3) -> bool {
    x.iter().all(|x| x.is_finite())
}

/// Which rank keeps a cell: blocks of 2^shift cells along each direction are hashed.
struct Keepers {
    shift: u32,
    ranks: u64,
}

impl Keepers {
    /// With blocks so large that a surface of so many half cells on a rank is in a few of them. Collective.
    fn new(comm: &SimpleCommunicator, groups: usize) -> Self {
        let mut sums = [groups as f64, f64::from(groups > 0)];
        sum(comm, &mut sums);
        // Four half cells a cell, and 4^shift cells a block, of a surface.
        let blocks = sums[0] / sums[1].max(1.0) / (4.0 * KEEPERS);
        Self { shift: (0.5 * blocks.max(1.0).log2()).ceil() as u32, ranks: comm.size() as u64 }
    }

    fn rank(&self, cell: &Cell) -> usize {
        let block = Cell { level: cell.level, at: cell.at.map(|k| k >> self.shift) };
        // The finalizer of SplitMix64.
        let mut hash = block.code();
        hash = (hash ^ hash >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash = (hash ^ hash >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((hash ^ hash >> 31) % self.ranks) as usize
    }
}

/// Who has points in a cell, and where: by the code of the cell.
type Directory = BTreeMap<u64, Vec<(usize, Bounds)>>;

/// Tells the keepers where this rank has points; returns what this rank is to keep. Collective.
fn register(comm: &SimpleCommunicator, keepers: &Keepers, groups: &[Group]) -> Directory {
    let mut told: Parcels<u64> = Parcels::new();
    for group in groups {
        write(told.entry(keepers.rank(&group.cell)).or_default(), group.cell.code(), &group.points);
    }
    let mut directory = Directory::new();
    for (rank, words) in exchange(comm, &told) {
        for (code, points) in words.as_chunks::<WORDS>().0.iter().map(read) {
            directory.entry(code).or_default().push((rank, points));
        }
    }
    directory
}

/// Asks the keepers of `cells` who has points there. Collective.
fn ask(
    comm: &SimpleCommunicator,
    keepers: &Keepers,
    directory: &Directory,
    cells: impl Iterator<Item = Cell>,
) -> Directory {
    let mut cells: Vec<Cell> = cells.collect();
    cells.sort_unstable();
    cells.dedup();
    let mut asked: Parcels<u64> = Parcels::new();
    cells.iter().for_each(|cell| asked.entry(keepers.rank(cell)).or_default().push(cell.code()));
    let mut answers: Parcels<u64> = Parcels::new();
    for (asking, mut codes) in exchange(comm, &asked) {
        codes.sort_unstable();
        codes.dedup();
        for (code, found) in codes.iter().filter_map(|code| Some((code, directory.get(code)?))) {
            for (rank, points) in found {
                let answer = answers.entry(asking).or_default();
                answer.push(*rank as u64);
                write(answer, *code, points);
            }
        }
    }
    let mut found = Directory::new();
    for words in exchange(comm, &answers).values() {
        for [rank, rest @ ..] in words.as_chunks::<{ 1 + WORDS }>().0 {
            let (code, points) = read(rest);
            found.entry(code).or_default().push((*rank as usize, points));
        }
    }
    found
}

fn write(words: &mut Vec<u64>, code: u64, (lo, hi): &Bounds) {
    words.push(code);
    words.extend(lo.iter().chain(hi.iter()).map(|x| x.to_bits()));
}

fn read(&[code, a, b, c, d, e, f]: &[u64; WORDS]) -> (u64, Bounds) {
    let vector = |bits: [u64; 3]| Vec3::from(bits.map(f64::from_bits));
    (code, (vector([a, b, c]), vector([d, e, f])))
}
