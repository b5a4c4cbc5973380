//! The fields as VTK's own HDF5 layout has them: for each grid a small file of virtual datasets over the HDF5 file, so that
//! nothing is stored twice.
//!
//! A grid is a transient `UnstructuredGrid` of one part, its geometry static: see the VTKHDF specification, version 2,
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/>. Not all grids stand in one file: VTK wants the
//! order of the blocks of a collection from HDF5's record of what was created when, which the crate cannot ask for.

use super::fields::CellShape;
use super::partial;
use hdf5::DatasetBuilderEmptyShape;
use hdf5::types::FixedAscii;
use hdf5::{File, Group, H5Type, Result};
use std::ops::Range;
use std::path::Path;

/// Describes a grid of the file `h5`, by its folder there, in a file `vtkhdf` beside it, which it replaces as a whole; nothing
/// where it has no cells. The shape is that of all cells, `None` when they differ.
pub(super) fn write(h5: &Path, vtkhdf: &Path, folder: &str, shape: Option<CellShape>) -> Result<()> {
    let part = vtkhdf.with_file_name(partial(&vtkhdf.file_name().unwrap_or_default().to_string_lossy()));
    let source = Source::read(File::open(h5)?, h5)?;
    let grid = source.file.group(&format!("grids/{folder}"))?;
    let fields = source.fields(folder)?;
    if fields.is_empty() || !grid.link_exists("points") || !grid.link_exists("cells") {
        return Ok(());
    }
    let file = File::create(&part)?;
    source.describe(&file.create_group("VTKHDF")?, &grid, shape, &fields)?;
    file.close()?;
    std::fs::rename(&part, vtkhdf).map_err(|error| hdf5::Error::Internal(error.to_string()))
}

fn vector<T: H5Type>(group: &Group, name: &str, values: &[T]) -> Result<()> {
    group.new_dataset::<T>().shape(values.len()).create(name)?.write_raw(values)
}

fn sorted(group: &Group) -> Result<Vec<String>> {
    let mut names = group.member_names()?;
    names.sort();
    Ok(names)
}

/// What stands in the HDF5 file.
struct Source {
    file: File,
    /// Its name, from beside it.
    name: String,
    /// The groups of the increments, and their times.
    increments: Vec<String>,
    times: Vec<f64>,
}

/// A field of a grid.
struct Shown {
    /// As in `node/displacement`.
    path: String,
    name: String,
    is_nodal: bool,
    rows: usize,
    /// `None` of a scalar.
    width: Option<usize>,
}

impl Source {
    fn read(file: File, path: &Path) -> Result<Self> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let increments = if file.link_exists("increments") { sorted(&file.group("increments")?)? } else { Vec::new() };
        let time = |number: &String| file.dataset(&format!("increments/{number}/time"))?.read_raw::<f64>();
        let times = increments.iter().map(time).collect::<Result<Vec<_>>>()?.concat();
        Ok(Self { file, name, increments, times })
    }

    /// The fields of a grid that all increments have.
    fn fields(&self, grid: &str) -> Result<Vec<Shown>> {
        let mut found = Vec::new();
        for (k, number) in self.increments.iter().enumerate() {
            let path = format!("increments/{number}/{grid}");
            if !self.file.link_exists(&path) {
                return Ok(Vec::new());
            }
            let group = self.file.group(&path)?;
            if k == 0 {
                for center in ["node", "cell"].into_iter().filter(|center| group.link_exists(center)) {
                    for name in sorted(&group.group(center)?)? {
                        let shape = group.dataset(&format!("{center}/{name}"))?.shape();
                        let (rows, width) = (shape[0], shape.get(1).copied());
                        let path = format!("{center}/{name}");
                        found.push(Shown { path, name, is_nodal: center == "node", rows, width });
                    }
                }
            }
            found.retain(|field: &Shown| group.link_exists(&field.path));
        }
        Ok(found)
    }

    /// Writes the times.
    fn steps(&self, group: &Group) -> Result<Group> {
        let steps = group.create_group("Steps")?;
        steps.new_attr::<i64>().create("NSteps")?.write_scalar(&(self.times.len() as i64))?;
        vector(&steps, "Values", &self.times)?;
        Ok(steps)
    }

    /// Writes a grid with its fields over time.
    fn describe(&self, block: &Group, grid: &Group, shape: Option<CellShape>, fields: &[Shown]) -> Result<()> {
        let kind = FixedAscii::<16>::from_ascii("UnstructuredGrid");
        let kind = kind.map_err(|error| hdf5::Error::Internal(error.to_string()))?;
        block.new_attr::<FixedAscii<16>>().create("Type")?.write_scalar(&kind)?;
        block.new_attr::<i64>().shape(2).create("Version")?.write_raw(&[2, 0])?;
        let cells = Cells::read(grid, shape)?;
        let points = grid.dataset("points")?;
        let shape = (points.shape()[0], 3);
        let builder = block.new_dataset::<f64>().shape(shape);
        builder.virtual_map(&self.name, points.name(), shape, .., shape, ..).create("Points")?;
        vector(block, "Connectivity", &cells.connectivity)?;
        vector(block, "Offsets", &cells.offsets)?;
        vector(block, "Types", &cells.types)?;
        vector(block, "NumberOfPoints", &[shape.0 as i64])?;
        vector(block, "NumberOfCells", &[cells.types.len() as i64])?;
        vector(block, "NumberOfConnectivityIds", &[cells.connectivity.len() as i64])?;
        let steps = self.steps(block)?;
        let none = vec![0i64; self.times.len()];
        vector(&steps, "PartOffsets", &none)?;
        vector(&steps, "NumberOfParts", &vec![1i64; none.len()])?;
        vector(&steps, "PointOffsets", &none)?;
        for name in ["CellOffsets", "ConnectivityIdOffsets"] {
            steps.new_dataset::<i64>().shape((none.len(), 1)).create(name)?.write_raw(&none)?;
        }
        for (is_nodal, data) in [(true, "PointData"), (false, "CellData")] {
            let (values, offsets) = (block.create_group(data)?, steps.create_group(&format!("{data}Offsets"))?);
            for field in fields.iter().filter(|field| field.is_nodal == is_nodal) {
                self.over_time(&values, grid, field)?;
                let rows: Vec<i64> = (0..none.len()).map(|k| (k * field.rows) as i64).collect();
                vector(&offsets, &field.name, &rows)?;
            }
        }
        Ok(())
    }

    /// A field of all increments, one after the other.
    fn over_time(&self, values: &Group, grid: &Group, field: &Shown) -> Result<()> {
        let name = grid.name();
        let folder = name.rsplit('/').next().unwrap_or_default();
        let (rows, all) = (field.rows, field.rows * self.increments.len());
        let paths = self.increments.iter().map(|number| format!("increments/{number}/{folder}/{}", field.path));
        let parts = paths.enumerate().map(|(k, path)| (path, k * rows..(k + 1) * rows));
        let empty = values.new_dataset::<f64>();
        match field.width {
            Some(width) => {
                let whole = empty.shape((all, width));
                let over = |whole: DatasetBuilderEmptyShape, (path, part): (String, Range<usize>)| {
                    whole.virtual_map(&self.name, path, (rows, width), .., (all, width), (part, ..))
                };
                parts.fold(whole, over).create(field.name.as_str())?;
            }
            None => {
                let over = |whole: DatasetBuilderEmptyShape, (path, part): (String, Range<usize>)| {
                    whole.virtual_map(&self.name, path, rows, .., all, part)
                };
                parts.fold(empty.shape(all), over).create(field.name.as_str())?;
            }
        }
        Ok(())
    }
}

/// The cells of a grid as VTK has them.
struct Cells {
    connectivity: Vec<i64>,
    /// Where each cell begins, and the end.
    offsets: Vec<i64>,
    types: Vec<u8>,
}

impl Cells {
    fn read(grid: &Group, of_all: Option<CellShape>) -> Result<Self> {
        let dataset = grid.dataset("cells")?;
        let numbers = dataset.read_raw::<i64>()?;
        let mut cells = Self { connectivity: Vec::new(), offsets: vec![0], types: Vec::new() };
        let mut rest = numbers.as_slice();
        while !rest.is_empty() {
            // Of unlike cells each stands behind its code.
            let (shape, nodes) = match (of_all, CellShape::of_code(rest[0])) {
                (Some(shape), _) => (shape, rest),
                (None, Some(shape)) => (shape, &rest[1..]),
                (None, None) => return Err(hdf5::Error::Internal(format!("no cell has the code {}", rest[0]))),
            };
            let (own, others) = nodes.split_at(shape.node_count());
            cells.connectivity.extend(own);
            cells.offsets.push(cells.connectivity.len() as i64);
            cells.types.push(shape.vtk_type());
            rest = others;
        }
        Ok(cells)
    }
}
