//! What ParaView shows: an HDF5 file with the data and an XDMF file that describes it.
//!
//! All ranks write one HDF5 file, each its own rows. The layout is
//!
//! ```text
//! grids/GRID/points            points x 3, reference positions
//! grids/GRID/cells             cells x nodes, or one vector of shape codes and nodes when the shapes differ
//! increments/NUMBER/time
//! increments/NUMBER/GRID/node/FIELD, .../cell/FIELD
//! ```
//!
//! The HDF5 file is closed after every increment, and only then the XDMF file is replaced by one that knows the increment,
//! so that a kill at any time leaves a file that opens up to the last complete increment.

use super::xdmf::{self, Reference, XdmfField, XdmfGrid};
use super::{OutputFolder, cannot_write, replace};
use crate::error::{Error, Result};
use crate::parallel::{agree, number};
use hdf5::{Dataset, File, FileBuilder, H5Type, OpenMode};
use mpi::collective::SystemOperation;
use mpi::traits::*;
use std::path::PathBuf;

/// Shape of a cell. Node order as in Gmsh, VTK and [`crate::mesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellShape {
    Triangle,
    Quadrilateral,
    Tetrahedron,
    Hexahedron,
}

/// A cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    pub shape: CellShape,
    /// Numbers of its points in the whole grid; the first 3, 4, 4 or 8 count.
    pub nodes: [u64; 8],
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
    /// Increments written.
    written: usize,
    /// Their XDMF text; on rank 0 alone.
    increments: String,
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

/// The rows of a dataset that this rank owns: `first .. first + owned` of `total`.
#[derive(Clone, Copy, Debug)]
struct Share {
    first: u64,
    owned: u64,
    total: u64,
}

/// A dataset to write, with this rank's rows.
struct Rows<'a, T> {
    path: String,
    width: usize,
    share: Share,
    values: &'a [T],
}

impl Fields {
    /// Starts an empty `NAME.h5`; `NAME.xdmf` appears with the first increment.
    ///
    /// # Errors
    /// [`Error::System`] when the file cannot be written, by these ranks together.
    pub fn create(folder: &OutputFolder, name: &str, comm: &impl Communicator) -> Result<Self> {
        let h5 = folder.file(&format!("{name}.h5"));
        let touched = if comm.rank() == 0 { std::fs::File::create(&h5).map(|_| ()) } else { Ok(()) };
        agree(comm, touched.map_err(|error| cannot_write(&h5, error)))?;
        let xdmf = folder.file(&format!("{name}.xdmf"));
        let fields = Self { h5, xdmf, grids: Vec::new(), written: 0, increments: String::new() };
        let file = fields.open(comm, OpenMode::Create)?;
        fields.close(comm, file, Ok(()))?;
        Ok(fields)
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
        self.append(comm, &[points_rows], &[cells_rows])?;
        self.grids.push(StoredGrid { folder, points, cells, xdmf });
        Ok(GridId(self.grids.len() - 1))
    }

    /// Writes an increment, then makes it known to ParaView. Grids without data in it do not show at that time.
    ///
    /// # Errors
    /// [`Error::System`] when a file cannot be written or the length of a field is not that of its grid. What was written
    /// before stays valid.
    pub fn write(&mut self, comm: &impl Communicator, time: f64, data: &[GridData]) -> Result<()> {
        let increment = format!("increments/{:06}", self.written + 1);
        let clock = [time];
        let share = Share { first: 0, owned: u64::from(comm.rank() == 0), total: 1 };
        let clock = Rows { path: format!("{increment}/time"), width: 1, share, values: &clock[..share.owned as usize] };
        let mut rows = agree(comm, self.rows(&increment, data))?;
        rows.push(clock);
        self.append(comm, &rows, &[])?;
        self.written += 1;

        let shown = if comm.rank() == 0 {
            self.increments.push_str(&self.describe(time, &increment, data));
            replace(&self.xdmf, &xdmf::document(&self.increments))
        } else {
            Ok(())
        };
        agree(comm, shown)
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

    /// Adds datasets to the file: all ranks create each, then every rank writes its rows.
    fn append(&self, comm: &impl Communicator, reals: &[Rows<f64>], integers: &[Rows<i64>]) -> Result<()> {
        let file = self.open(comm, OpenMode::ReadWrite)?;
        let before = std::fs::metadata(&self.h5).map_or(0, |file| file.len());
        let created = create_all(&file, reals).and_then(|reals| Ok((reals, create_all(&file, integers)?)));
        let created = agree(comm, created.map_err(|error| cannot_write(&self.h5, error)));
        let written = created.and_then(|(real_sets, integer_sets)| {
            let written = write_all(reals, &real_sets).and_then(|()| write_all(integers, &integer_sets));
            agree(comm, written.map_err(|error| cannot_write(&self.h5, error)))
        });
        let bytes = reals.iter().map(Rows::size).chain(integers.iter().map(Rows::size)).sum();
        let ready = if comm.rank() == 0 { self.make_room(before, bytes, written.is_ok()) } else { Ok(()) };
        let ready = agree(comm, ready.map_err(|error| cannot_write(&self.h5, error)));
        self.close(comm, file, written.and(ready))
    }

    /// Makes the file longer than it can get, before the close writes HDF5's tables and cuts it to its length: HDF5 refuses
    /// a file shorter than its tables say, which a kill amid the tables could otherwise leave.
    ///
    /// On a full disk the half-written data make way for the tables, without which the close would fail.
    fn make_room(&self, before: u64, added: u64, written: bool) -> std::io::Result<()> {
        let disk = std::fs::OpenOptions::new().write(true).open(&self.h5)?;
        if !written {
            disk.set_len(before)?;
        }
        let length = disk.metadata()?.len();
        disk.set_len(length.max(before + added))
    }

    /// Opens the file on all ranks together. Each looks at it by itself first: HDF5 would hang if only some could open it.
    fn open(&self, comm: &impl Communicator, mode: OpenMode) -> Result<File> {
        let reachable = std::fs::OpenOptions::new().write(true).open(&self.h5);
        agree(comm, reachable.map(|_| ()).map_err(|error| cannot_write(&self.h5, error)))?;
        let file = FileBuilder::new().with_fapl(|access| access.mpio(comm.as_raw(), None)).open_as(&self.h5, mode);
        agree(comm, file.map_err(|error| cannot_write(&self.h5, error)))
    }

    /// Closes the file, also after an error.
    fn close(&self, comm: &impl Communicator, file: File, written: Result<()>) -> Result<()> {
        let closed = agree(comm, file.close().map_err(|error| cannot_write(&self.h5, error)));
        written.and(closed)
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

impl CellShape {
    /// Nodes of a cell.
    pub fn node_count(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Quadrilateral | Self::Tetrahedron => 4,
            Self::Hexahedron => 8,
        }
    }
}

impl Cell {
    /// The nodes that count.
    pub fn nodes(&self) -> &[u64] {
        &self.nodes[..self.shape.node_count()]
    }
}

impl Share {
    fn of(comm: &impl Communicator, owned: usize) -> Self {
        let (first, total) = number(comm, owned as u64);
        Self { first, owned: owned as u64, total }
    }
}

fn create_all<T: H5Type>(file: &File, rows: &[Rows<T>]) -> hdf5::Result<Vec<Option<Dataset>>> {
    rows.iter().map(|rows| rows.create(file)).collect()
}

fn write_all<T: H5Type>(rows: &[Rows<T>], datasets: &[Option<Dataset>]) -> hdf5::Result<()> {
    rows.iter().zip(datasets).try_for_each(|(rows, dataset)| dataset.as_ref().map_or(Ok(()), |set| rows.write(set)))
}

impl<T: H5Type> Rows<'_, T> {
    /// The dataset on all ranks; none when it is empty on all.
    fn create(&self, file: &File) -> hdf5::Result<Option<Dataset>> {
        let total = self.share.total as usize;
        let builder = file.new_dataset::<T>();
        match (total, self.width) {
            (0, _) => Ok(None),
            (_, 1) => builder.shape(total).create(self.path.as_str()).map(Some),
            (_, width) => builder.shape((total, width)).create(self.path.as_str()).map(Some),
        }
    }

    /// Bytes that the dataset takes in the file at most, with its part in the tables.
    fn size(&self) -> u64 {
        const TABLES: u64 = 1 << 14;
        self.share.total * (self.width * size_of::<T>()) as u64 + TABLES
    }

    /// Writes the rows of this rank; not collective.
    fn write(&self, dataset: &Dataset) -> hdf5::Result<()> {
        match self.width {
            _ if self.share.owned == 0 => Ok(()),
            1 => dataset.write_slice(self.values, self.range()),
            3 => self.write_table::<3>(dataset),
            4 => self.write_table::<4>(dataset),
            6 => self.write_table::<6>(dataset),
            _ => self.write_table::<8>(dataset),
        }
    }

    fn write_table<const WIDTH: usize>(&self, dataset: &Dataset) -> hdf5::Result<()> {
        dataset.write_slice::<_, T, _, _>(self.values.as_chunks::<WIDTH>().0, (self.range(), 0..WIDTH))
    }

    fn range(&self) -> std::ops::Range<usize> {
        self.share.first as usize..(self.share.first + self.share.owned) as usize
    }
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
    use CellShape::*;
    let all = [Triangle, Quadrilateral, Tetrahedron, Hexahedron];
    let own = all.map(|shape| cells.iter().any(|cell| cell.shape == shape));
    let mut present = own;
    comm.all_reduce_into(&own[..], &mut present[..], SystemOperation::logical_or());
    let mut found = all.into_iter().zip(present).filter_map(|(shape, present)| present.then_some(shape));
    match (found.next(), found.next()) {
        (None, _) => Some(Triangle),
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
        let triangle = Cell { shape: CellShape::Triangle, nodes: [0, 1, 2, 0, 0, 0, 0, 0] };
        let quadrilateral = Cell { shape: CellShape::Quadrilateral, nodes: [1, 2, 3, 4, 0, 0, 0, 0] };
        assert_eq!(connectivity(&[triangle, quadrilateral], true), [4, 0, 1, 2, 5, 1, 2, 3, 4]);
        assert_eq!(connectivity(&[triangle, triangle], false), [0, 1, 2, 0, 1, 2]);
    }

    #[test]
    fn a_cell_without_its_points_is_refused() {
        let cell = Cell { shape: CellShape::Tetrahedron, nodes: [0, 1, 2, 3, 99, 99, 99, 99] };
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
