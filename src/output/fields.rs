//! What ParaView shows: an HDF5 file with the data, and an XDMF and a VTKHDF file that describe it.
//!
//! There is one HDF5 file, and rank 0 alone has it open: it takes the rows of the others, one rank after the other. An error
//! that one rank meets in HDF5's collective calls, such as a full disk, would leave the others waiting. The layout is
//!
//! ```text
//! grids/GRID/points            points x 3, reference positions
//! grids/GRID/cells             cells x nodes, or one vector of shape codes and nodes when the shapes differ
//! increments/NUMBER/time       number 0 is the state at time 0
//! increments/NUMBER/GRID/node/FIELD, .../cell/FIELD
//! ```
//!
//! The HDF5 file is changed as a whole with every increment ([`journal`]), and only then the XDMF file is replaced by one that
//! knows the increment, so that a kill at any time leaves a file that opens up to the last complete increment.

use super::rows::{Rows, Share};
use super::xdmf::{self, Reference, XdmfField, XdmfGrid};
use super::{OutputFolder, cannot_go_on, cannot_write, one_line, remove, replace, vtkhdf};
use crate::error::{Error, Result};
use crate::mesh::MOST_NODES;
use crate::parallel::agree;
use hdf5::File;
use journal::Change;
use mpi::collective::SystemOperation;
use mpi::traits::*;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const ANEW: &str = "move it elsewhere, and the fields begin anew at the checkpoint";

/// Shape of a cell. Node order as in VTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellShape {
    Triangle,
    Quadrilateral,
    Tetrahedron,
    Hexahedron,
    Wedge,
    Pyramid,
    QuadraticTetrahedron,
    /// 18 nodes.
    QuadraticWedge,
    /// 27 nodes.
    QuadraticHexahedron,
}

/// A cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    pub shape: CellShape,
    /// Numbers of its points in the whole grid; as many as the shape has count.
    pub nodes: [u64; MOST_NODES],
}

/// This rank's part of a grid: a body, a contact surface, a tool. Any part of it, and all of it, may be empty.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Block name in ParaView. The same on all ranks.
    pub name: &'a str,
    /// Reference positions of the points that this rank owns. The points of the whole grid are numbered by rank, and on
    /// a rank in this order: see [`crate::parallel::number`].
    pub points: &'a [[f64; 3]],
    /// The cells that this rank owns; shapes may differ.
    pub cells: &'a [Cell],
}

/// A grid of a [`Fields`] file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridId(usize);

/// This rank's part of a field.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// The same on all ranks. A node field `displacement` is what ParaView warps by.
    pub name: &'a str,
    /// 1 scalar, 3 vector, 6 symmetric tensor in the order xx yy zz xy yz xz. The same on all ranks.
    pub components: usize,
    /// `components` numbers for each point or cell that this rank gave to the grid, in that order.
    pub values: &'a [f64],
}

/// The fields of a grid in one increment; the same names in the same order on all ranks.
#[derive(Clone, Copy, Debug)]
pub struct GridData<'a> {
    pub grid: GridId,
    pub node_fields: &'a [Field<'a>],
    pub cell_fields: &'a [Field<'a>],
}

/// Writer of `NAME.h5` and `NAME.xdmf`. All methods are collective and return the same outcome on all ranks.
#[derive(Debug)]
pub struct Fields {
    h5: PathBuf,
    xdmf: PathBuf,
    grids: Vec<StoredGrid>,
    /// The last increment written.
    written: usize,
    /// Their XDMF text; on rank 0 alone.
    increments: String,
    /// The grids stand in the file already.
    goes_on: bool,
}

/// A grid as it stands in the file.
#[derive(Debug)]
struct StoredGrid {
    /// Its folder in the HDF5 file.
    folder: String,
    points: Share,
    cells: Share,
    xdmf: XdmfGrid,
}

impl Fields {
    /// Starts an empty `NAME.h5`; `NAME.xdmf` appears with the first state.
    ///
    /// # Errors
    /// [`Error::System`] when the file cannot be written.
    pub fn create(folder: &OutputFolder, name: &str, comm: &impl Communicator) -> Result<Self> {
        let h5 = folder.file(&format!("{name}.h5"));
        let xdmf = folder.file(&format!("{name}.xdmf"));
        create(&h5, comm)?;
        Ok(Self { h5, xdmf, grids: Vec::new(), written: 0, increments: String::new(), goes_on: false })
    }

    /// Goes on with the files of an earlier run after so many increments that it had written, and the state at time 0; what it
    /// wrote later is taken out, without a number all of it. Begins anew where there are none.
    ///
    /// # Errors
    /// [`Error::Input`] when these are not the files.
    pub fn go_on(folder: &OutputFolder, name: &str, comm: &impl Communicator, written: Option<usize>) -> Result<Self> {
        let (h5, xdmf) = (folder.file(&format!("{name}.h5")), folder.file(&format!("{name}.xdmf")));
        let mut exists = h5.exists() && (xdmf.exists() || written.is_none());
        comm.process_at_rank(0).broadcast_into(&mut exists);
        if !exists {
            return Self::create(folder, name, comm);
        }
        let cut = || cut_off(&h5, &xdmf, written).map_err(|what| cannot_go_on(&h5, one_line(&what), ANEW));
        let increments = on_root(comm, cut)?.unwrap_or_default();
        Ok(Self { h5, xdmf, grids: Vec::new(), written: written.unwrap_or_default(), increments, goes_on: true })
    }

    /// Whether what an earlier run wrote is there still.
    pub fn goes_on(&self) -> bool {
        self.goes_on
    }

    /// Increments written.
    pub fn written(&self) -> usize {
        self.written
    }

    /// The HDF5 file.
    pub fn file(&self) -> &Path {
        &self.h5
    }

    /// Writes the geometry of a grid, which stays: what moves shows through a `displacement`.
    ///
    /// # Errors
    /// [`Error::System`] when the file cannot be written or a cell refers to a point that no rank owns.
    pub fn add_grid(&mut self, comm: &impl Communicator, grid: &Grid) -> Result<GridId> {
        let points = Share::of(comm, grid.points.len());
        let cells = Share::of(comm, grid.cells.len());
        agree(comm, check_nodes(grid, points.total))?;
        let shape = common_shape(comm, grid.cells);
        let nodes = connectivity(grid.cells, shape.is_none());
        let width = shape.map_or(1, CellShape::node_count);
        let rows = Share::of(comm, nodes.len() / width);

        let folder = self.unused_folder(grid.name);
        let (points_path, cells_path) = (format!("grids/{folder}/points"), format!("grids/{folder}/cells"));
        let xdmf = XdmfGrid {
            name: grid.name.to_string(),
            points: self.reference(&points_path, points.total, 3, false),
            cells: self.reference(&cells_path, rows.total, width, true),
            cell_count: cells.total,
            shape,
        };
        let points_rows = Rows { path: points_path, width: 3, share: points, values: grid.points.as_flattened() };
        let cells_rows = Rows { path: cells_path, width, share: rows, values: &nodes };
        if self.goes_on {
            let found = || points_rows.check(&self.h5).and_then(|()| cells_rows.check(&self.h5));
            on_root(comm, || found().map_err(|what| cannot_go_on(&self.h5, one_line(&what), ANEW)))?;
        } else {
            append(&self.h5, comm, &[points_rows], &[cells_rows])?;
        }
        self.grids.push(StoredGrid { folder, points, cells, xdmf });
        Ok(GridId(self.grids.len() - 1))
    }

    /// Writes an increment, or the state at time 0 before the first, then makes it known to ParaView. Grids without data in it
    /// do not show at that time.
    ///
    /// # Errors
    /// [`Error::System`] when a file cannot be written or the length of a field is not that of its grid. What was written
    /// before stays valid.
    pub fn write(&mut self, comm: &impl Communicator, time: f64, data: &[GridData]) -> Result<()> {
        let number = if time > 0.0 { self.written + 1 } else { 0 };
        let increment = format!("increments/{number:06}");
        let clock = [time];
        let share = Share { first: 0, owned: u64::from(comm.rank() == 0), total: 1 };
        let clock = Rows { path: format!("{increment}/time"), width: 1, share, values: &clock[..share.owned as usize] };
        let mut rows = agree(comm, self.rows(&increment, data))?;
        rows.push(clock);
        append(&self.h5, comm, &rows, &[])?;
        self.written = number;

        let shown = if comm.rank() == 0 {
            let another = self.describe(time, &increment, data);
            let longer = xdmf::lengthen(&self.xdmf, &self.increments, &another);
            self.increments.push_str(&another);
            match longer.map_err(|error| error.kind()) {
                // There is none yet, or not as it was left.
                Err(ErrorKind::NotFound | ErrorKind::InvalidData) => {
                    replace(&self.xdmf, &xdmf::document(&self.increments))
                }
                written => written.map_err(|error| cannot_write(&self.xdmf, error)),
            }
        } else {
            Ok(())
        };
        agree(comm, shown)
    }

    /// Describes what has been written until now grid by grid, for readers of single grids: `NAME-GRID.xdmf`, and where VTK's
    /// own reader is wanted `NAME-GRID.vtkhdf`.
    ///
    /// # Errors
    /// [`Error::System`] when a file cannot be written.
    pub fn index(&self, comm: &impl Communicator, vtkhdf: bool) -> Result<()> {
        let name = self.h5.file_stem().unwrap_or_default().to_string_lossy();
        let one = |grid: &StoredGrid| {
            let path = |end| self.h5.with_file_name(format!("{name}-{}.{end}", grid.folder));
            let (xdmf, hdf) = (path("xdmf"), path("vtkhdf"));
            match xdmf::of_grid(&self.increments, &grid.xdmf.name) {
                text if text.is_empty() => remove(&xdmf).map_err(|error| cannot_write(&xdmf, error))?,
                text => replace(&xdmf, &xdmf::document(&text))?,
            }
            if !vtkhdf {
                return Ok(());
            }
            vtkhdf::write(&self.h5, &hdf, &grid.folder, grid.xdmf.shape).map_err(|error| cannot_write(&hdf, error))
        };
        on_root(comm, || self.grids.iter().try_for_each(one))?;
        Ok(())
    }

    /// The datasets of an increment.
    fn rows<'a>(&self, increment: &str, data: &[GridData<'a>]) -> Result<Vec<Rows<'a, f64>>> {
        let mut rows = Vec::new();
        for data in data {
            let grid = &self.grids[data.grid.0];
            for (center, share, fields) in
                [("node", grid.points, data.node_fields), ("cell", grid.cells, data.cell_fields)]
            {
                for field in fields {
                    let (width, values) = (field.components, field.values);
                    let path = field_path(increment, &grid.folder, center, field.name);
                    if !matches!(width, 1 | 3 | 6) || values.len() as u64 != share.owned * width as u64 {
                        return Err(Error::System(format!(
                            "field {path} has {} values of {width} components for {} {center}s",
                            values.len(),
                            share.owned
                        )));
                    }
                    rows.push(Rows { path, width, share, values });
                }
            }
        }
        Ok(rows)
    }

    /// The XDMF text of an increment. Empty grids are left out.
    fn describe(&self, time: f64, increment: &str, data: &[GridData]) -> String {
        let shown = |data: &&GridData| self.grids[data.grid.0].cells.total > 0;
        let grids: Vec<_> = data.iter().filter(shown).map(|data| self.describe_grid(increment, data)).collect();
        xdmf::increment(time, &grids)
    }

    /// A dataset as the XDMF file names it.
    fn reference(&self, path: &str, rows: u64, width: usize, integer: bool) -> Reference {
        let file = self.h5.file_name().unwrap_or_default().to_string_lossy();
        Reference { path: format!("{file}:/{path}"), rows, width, integer }
    }

    fn describe_grid(&self, increment: &str, data: &GridData) -> (&XdmfGrid, Vec<XdmfField>) {
        let grid = &self.grids[data.grid.0];
        let describe = |field: &Field, folder: &str, center: &'static str, rows: u64| XdmfField {
            name: field.name.to_string(),
            center,
            data: self.reference(
                &field_path(increment, &grid.folder, folder, field.name),
                rows,
                field.components,
                false,
            ),
        };
        let nodes = data.node_fields.iter().map(|field| describe(field, "node", "Node", grid.points.total));
        let cells = data.cell_fields.iter().map(|field| describe(field, "cell", "Cell", grid.cells.total));
        (&grid.xdmf, nodes.chain(cells).collect())
    }

    /// A name for the folder of a grid in the file that no other grid has.
    fn unused_folder(&self, name: &str) -> String {
        let mut folder = h5_name(name);
        while self.grids.iter().any(|grid| grid.folder == folder) {
            folder.push('_');
        }
        folder
    }
}

/// Adds datasets to a file: rank 0 creates each, and writes the rows of all ranks. All are added or none.
pub(super) fn append(path: &Path, comm: &impl Communicator, reals: &[Rows<f64>], integers: &[Rows<i64>]) -> Result<()> {
    let change = on_root(comm, || Change::begin(path).map_err(|error| cannot_write(path, error)))?;
    let file = change.as_ref().map(Change::file);
    // The first error of rank 0; what the others send is taken all the same.
    let mut written = Ok(());
    reals.iter().for_each(|rows| rows.add(comm, file, &mut written));
    integers.iter().for_each(|rows| rows.add(comm, file, &mut written));
    on_root(comm, || {
        let failure = change.as_ref().and_then(Change::failure);
        written.map_err(|error| cannot_write(path, failure.unwrap_or(error.to_string())))?;
        change.map_or(Ok(()), Change::commit).map_err(|error| cannot_write(path, error))
    })?;
    Ok(())
}

/// Starts an empty file. Collective.
pub(super) fn create(path: &Path, comm: &impl Communicator) -> Result<()> {
    let created = on_root(comm, || {
        remove(&journal::journal(path)).map_err(|error| cannot_write(path, error))?;
        File::create(path).and_then(File::close).map_err(|error| cannot_write(path, error))
    });
    created.map(|_| ())
}

/// What `work` gives on rank 0, and nothing on the others; its error on all.
pub(super) fn on_root<T>(comm: &impl Communicator, work: impl FnOnce() -> Result<T>) -> Result<Option<T>> {
    agree(comm, if comm.rank() == 0 { work().map(Some) } else { Ok(None) })
}

impl CellShape {
    /// All of them, in the order of their numbers.
    pub(super) const ALL: [Self; 9] = [
        Self::Triangle,
        Self::Quadrilateral,
        Self::Tetrahedron,
        Self::Hexahedron,
        Self::Wedge,
        Self::Pyramid,
        Self::QuadraticTetrahedron,
        Self::QuadraticWedge,
        Self::QuadraticHexahedron,
    ];

    /// Nodes of a cell.
    pub fn node_count(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Quadrilateral | Self::Tetrahedron => 4,
            Self::Hexahedron => 8,
            Self::Wedge => 6,
            Self::Pyramid => 5,
            Self::QuadraticTetrahedron => 10,
            Self::QuadraticWedge => 18,
            Self::QuadraticHexahedron => 27,
        }
    }
}

impl Cell {
    /// With as many nodes as the shape has.
    pub fn new(shape: CellShape, nodes: &[u64]) -> Self {
        let mut all = [0; MOST_NODES];
        all[..nodes.len()].copy_from_slice(nodes);
        Self { shape, nodes: all }
    }

    /// Length of [`Self::to_numbers`].
    pub const LEN: usize = 1 + MOST_NODES;

    pub fn to_numbers(self) -> [u64; Self::LEN] {
        let mut numbers = [self.shape as u64; Self::LEN];
        numbers[1..].copy_from_slice(&self.nodes);
        numbers
    }

    pub fn from_numbers(numbers: &[u64; Self::LEN]) -> Self {
        let mut nodes = [0; MOST_NODES];
        nodes.copy_from_slice(&numbers[1..]);
        Self { shape: CellShape::ALL[numbers[0] as usize], nodes }
    }

    /// The nodes that count.
    pub fn nodes(&self) -> &[u64] {
        &self.nodes[..self.shape.node_count()]
    }
}

/// Takes what was written after so many increments out of both files, all of it without a number; gives the XDMF text of what
/// stays.
fn cut_off(h5: &Path, xdmf: &Path, written: Option<usize>) -> std::result::Result<String, String> {
    journal::recover(h5).map_err(|error| error.to_string())?;
    let begins = || File::open(h5).map(|file| file.link_exists("increments/000000")).map_err(|error| error.to_string());
    // With the state at time 0.
    let kept = written.map_or(Ok(0), |written| begins().map(|begins| written + usize::from(begins)))?;
    let text = if kept > 0 { std::fs::read_to_string(xdmf).map_err(|error| error.to_string())? } else { String::new() };
    let increments = xdmf::first(&text, kept).ok_or(format!("{} has fewer than {kept} times", xdmf.display()))?;
    // First, that it never tells of what is not there.
    match kept {
        0 => remove(xdmf).map_err(|error| error.to_string())?,
        _ => replace(xdmf, &xdmf::document(increments)).map_err(|error| error.to_string())?,
    }
    let change = Change::begin(h5).map_err(|error| error.to_string())?;
    let cut = |file: &File| -> hdf5::Result<usize> {
        if !file.link_exists("increments") {
            return Ok(0);
        }
        let group = file.group("increments")?;
        let names = group.member_names()?;
        let later = |name: &&String| name.parse::<usize>().is_ok_and(|number| written.is_none_or(|last| number > last));
        names.iter().filter(later).try_for_each(|name| group.unlink(name))?;
        Ok(group.len() as usize)
    };
    let left = cut(change.file()).map_err(|error| error.to_string())?;
    change.commit().map_err(|error| error.to_string())?;
    if left == kept { Ok(increments.to_string()) } else { Err(format!("it has {left} of {kept} times")) }
}

/// Readers crash on a cell with a point that is not there.
fn check_nodes(grid: &Grid, points: u64) -> Result<()> {
    match grid.cells.iter().flat_map(Cell::nodes).find(|&&node| node >= points) {
        None => Ok(()),
        Some(node) => {
            Err(Error::System(format!("grid {}: a cell refers to point {node}, and there are {points}", grid.name)))
        }
    }
}

/// The shape of all cells of all ranks, `None` when they differ; a triangle when there are none.
fn common_shape(comm: &impl Communicator, cells: &[Cell]) -> Option<CellShape> {
    let all = CellShape::ALL;
    let own = all.map(|shape| cells.iter().any(|cell| cell.shape == shape));
    let mut present = own;
    comm.all_reduce_into(&own[..], &mut present[..], SystemOperation::logical_or());
    let mut found = all.into_iter().zip(present).filter_map(|(shape, present)| present.then_some(shape));
    match (found.next(), found.next()) {
        (None, _) => Some(CellShape::Triangle),
        (shape, None) => shape,
        _ => None,
    }
}

/// The nodes of all cells one after the other, in a mixed topology each behind the code of its shape.
fn connectivity(cells: &[Cell], mixed: bool) -> Vec<i64> {
    let mut nodes = Vec::with_capacity(cells.len() * 9);
    for cell in cells {
        nodes.extend(mixed.then(|| cell.shape.xdmf_code()));
        nodes.extend(cell.nodes().iter().map(|&node| node as i64));
    }
    nodes
}

fn field_path(increment: &str, grid: &str, center: &str, field: &str) -> String {
    format!("{increment}/{grid}/{center}/{}", h5_name(field))
}

/// A name without what has a meaning in HDF5 paths or XDMF references.
fn h5_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if name.is_empty() { "_".into() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_cells_stand_behind_their_codes() {
        let triangle = Cell::new(CellShape::Triangle, &[0, 1, 2]);
        let quadrilateral = Cell::new(CellShape::Quadrilateral, &[1, 2, 3, 4]);
        assert_eq!(connectivity(&[triangle, quadrilateral], true), [4, 0, 1, 2, 5, 1, 2, 3, 4]);
        assert_eq!(connectivity(&[triangle, triangle], false), [0, 1, 2, 0, 1, 2]);
    }

    #[test]
    fn a_cell_without_its_points_is_refused() {
        let cell =
            Cell { nodes: std::array::from_fn(|a| if a < 4 { a as u64 } else { 99 }), shape: CellShape::Tetrahedron };
        let grid = Grid { name: "slab", points: &[], cells: &[cell] };
        assert!(check_nodes(&grid, 4).is_ok());
        let error = check_nodes(&grid, 3).unwrap_err().to_string();
        assert_eq!(error, "grid slab: a cell refers to point 3, and there are 3");
    }

    #[test]
    fn names_are_safe_in_paths() {
        assert_eq!(["slab", "slab.top", "a/b:c", "µ", ""].map(h5_name), ["slab", "slab_top", "a_b_c", "_", "_"]);
    }
}
