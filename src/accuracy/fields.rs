//! `surface.xdmf` and `surface.h5`: the sampled surface with its errors, for ParaView.

use super::errors::{Sample, SampledPiece};
use crate::error::Result;
use crate::output::OutputFolder;
use crate::output::fields::{Cell, CellShape, Field, Fields, Grid, GridData};
use crate::parallel::number;
use mpi::topology::SimpleCommunicator;

/// Writes the surface. `side` is the number of samples along a piece; each rank gives its own pieces. In the dead zones,
/// 0 is a normal projection, 1 one on an extended piece, 2 none. Collective.
///
/// # Errors
/// [`crate::error::Error::System`] when the files cannot be written.
pub fn write(
    comm: &SimpleCommunicator,
    folder: &OutputFolder,
    name: &str,
    pieces: &[SampledPiece],
    side: usize,
    dead_zones: bool,
) -> Result<()> {
    let samples = || pieces.iter().flat_map(|piece| &piece.samples);
    let points: Vec<[f64; 3]> = samples().map(|sample| sample.point.into()).collect();
    let (first, _) = number(comm, points.len() as u64);
    let (mut cells, mut ids, mut dead) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
    for (k, piece) in pieces.iter().enumerate() {
        for at in whole_cells(piece, side) {
            cells.push(cell(first + (k * side * side) as u64, side, at, piece.triangle));
            ids.push(f64::from(piece.id));
            if let Some(projected) = piece.cells.get(at[1] * (side - 1) + at[0]) {
                dead.iter_mut().zip(projected).for_each(|(dead, projected)| dead.push(f64::from(*projected as u8)));
            }
        }
    }
    let scalar = |pick: &dyn Fn(&Sample) -> f64| -> Vec<f64> { samples().map(pick).collect() };
    let normals: Vec<f64> = samples().flat_map(|sample| <[f64; 3]>::from(sample.normal)).collect();
    let (distance, angle) = (scalar(&|s| s.distance), scalar(&|s| s.angle));
    let field = |name, components, values| Field { name, components, values };
    let node_fields = [
        field("normal", 3, &normals[..]),
        field("distance_error", 1, &distance[..]),
        field("normal_error", 1, &angle[..]),
    ];
    let mut cell_fields = vec![field("patch", 1, &ids[..])];
    if dead_zones {
        cell_fields.extend([field("dead_outside", 1, &dead[0][..]), field("dead_inside", 1, &dead[1][..])]);
    }
    let mut fields = Fields::create(folder, "surface", comm)?;
    let grid = fields.add_grid(comm, &Grid { name, points: &points, cells: &cells })?;
    fields.write(comm, 0.0, &[GridData { grid, node_fields: &node_fields, cell_fields: &cell_fields }])
}

/// Column and row of the cells of a piece whose corners the surface has.
fn whole_cells(piece: &SampledPiece, side: usize) -> impl Iterator<Item = [usize; 2]> {
    let all = (0..side - 1).flat_map(move |t| (0..side - 1).map(move |s| [s, t]));
    all.filter(move |[s, t]| [0, 1, side, side + 1].iter().all(|k| piece.samples[t * side + s + k].held))
}

/// The cell between four samples of a piece, of which the first has the number `first`, counter-clockwise seen from outside;
/// at the first corner of a triangle, where the samples of a column coincide, it is a triangle.
fn cell(first: u64, side: usize, [s, t]: [usize; 2], triangle: bool) -> Cell {
    let [p, row] = [first + (t * side + s) as u64, side as u64];
    let [a, b, c, d] = [p, p + 1, p + row + 1, p + row];
    if triangle && s == 0 {
        Cell::new(CellShape::Triangle, &[a, b, c])
    } else {
        Cell::new(CellShape::Quadrilateral, &[a, b, c, d])
    }
}
