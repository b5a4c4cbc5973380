//! How well a surface is described: its errors against a reference, its dead zones, and projections of points onto it.
//!
//! - [`described`]: what the study needs of a surface
//! - [`sampling`]: the grid of samples on a piece, and the way from a sample to the maximum beside it
//! - [`size`]: area, edges, how much normals jump
//! - [`errors`]: distance and normal errors, and dead zones, of a piece
//! - [`projections`]: points of a file projected
//! - [`subject`]: the surfaces that are asked for
//! - `table`, `figures`, `fields`: what is printed, drawn and written for ParaView
//!
//! Every piece is measured by one rank. Its results are sent to all and put together in the order of the pieces, so they
//! do not depend on the number of ranks.

pub mod described;
pub mod errors;
mod fields;
pub mod figures;
pub mod projections;
pub mod sampling;
pub mod size;
pub mod subject;
mod table;

use crate::Vec3;
use crate::error::Result;
use crate::output::OutputFolder;
use crate::parallel::{agree, sum, to_all};
use crate::stdout::print_from_root;
use crate::tool::Shape;
use described::Described;
use errors::{Errors, SampledPiece, Sampling, measure};
use figures::{Histogram, Tile};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use projections::Row;
use sampling::Grid;
use size::Size;
use std::ops::Range;
use std::path::Path;
use table::Table;

/// What a study leaves in its folder.
pub const RESULTS: [&str; 7] =
    ["surface.xdmf", "surface.h5", "errors.csv", "errors.svg", "dead-zones.svg", "projections.csv", "summary.json"];

/// A surface and what it is measured against.
pub struct Subject<'a> {
    /// As in "tool `punch`, nagata".
    pub name: String,
    /// What it is made of, in words.
    pub summary: String,
    pub surface: &'a dyn Described,
    /// Whether it consists of patches, so that what their edges are says something.
    pub edges: bool,
    /// Edges whose normals the surface meets in part only, where that can be.
    pub inflected: Option<usize>,
    pub against: Option<Against<'a>>,
}

/// A reference.
pub struct Against<'a> {
    /// As in "sphere".
    pub name: String,
    pub reference: &'a Shape,
    /// The length that its errors are compared with, and what it is.
    pub length: Option<(f64, &'static str)>,
}

/// What is asked of a study.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    pub out: &'a Path,
    pub sampling: Sampling,
    /// File with points to project.
    pub points: Option<&'a Path>,
}

/// The outcome of a study, the same on all ranks.
#[derive(Clone, Debug)]
struct Outcome {
    size: Size,
    /// Of all pieces in their order, with the whole.
    errors: Option<(Vec<(u32, Errors)>, Errors)>,
    /// Rows of each kind.
    projections: Option<[usize; 4]>,
}

/// Measures a surface, prints the table on rank 0 and writes the files: without a reference and points there are none.
/// Collective; errors are the same on all ranks.
///
/// # Errors
/// Wrong input: points that cannot be read, a folder that cannot be written.
pub fn run(comm: &SimpleCommunicator, subject: &Subject, options: &Options) -> Result<()> {
    let points = agree(comm, options.points.map(projections::read_points).transpose())?;
    let size = size_of(comm, subject, &options.sampling.grid);
    let mut outcome = Outcome { size, errors: None, projections: None };
    let mut written = None;
    if subject.against.is_some() || points.is_some() {
        let inputs: Vec<_> = options.points.iter().map(|points| ("file of points", *points)).collect();
        let folder = OutputFolder::create(options.out, &RESULTS, &inputs, comm)?;
        if let Some(against) = &subject.against {
            outcome.errors = Some(measure_all(comm, &folder, subject, against, &options.sampling)?);
        }
        if let Some(points) = points {
            let rows = project_all(comm, subject.surface, &points, options.sampling.extension);
            folder.write(comm, "projections.csv", &projections::render(&rows))?;
            outcome.projections = Some(projections::count(&rows));
        }
        written = Some(folder);
    }
    let table = Table { subject, outcome: &outcome, sampling: &options.sampling };
    if let Some(folder) = written {
        if outcome.errors.is_some() {
            folder.write(comm, "errors.csv", &table.rows())?;
        }
        folder.write(comm, "summary.json", &table.summary())?;
    }
    print_from_root(comm, &table.text())
}

/// The size of the whole surface. Collective.
fn size_of(comm: &SimpleCommunicator, subject: &Subject, grid: &Grid) -> Size {
    let (surface, edges) = (subject.surface, subject.edges);
    let mine: Vec<_> =
        share(comm, surface.count()).map(|piece| Size::of(surface, piece, grid, edges).to_array()).collect();
    to_all(comm, &mine).iter().map(Size::from_array).fold(Size::none(), |all, size| all.join(&size))
}

/// The errors of all pieces and of the whole; writes the samples and their figures. Collective.
fn measure_all(
    comm: &SimpleCommunicator,
    folder: &OutputFolder,
    subject: &Subject,
    against: &Against,
    sampling: &Sampling,
) -> Result<(Vec<(u32, Errors)>, Errors)> {
    let surface = subject.surface;
    let (mut mine, mut pieces) = (Vec::new(), Vec::new());
    for k in share(comm, surface.count()) {
        let (errors, piece) = measure(surface, k, against.reference, sampling);
        mine.push(errors.to_array());
        pieces.push(piece);
    }
    let rows: Vec<Errors> = to_all(comm, &mine).iter().map(Errors::from_array).collect();
    let whole = rows[1..].iter().fold(rows[0], |whole, errors| whole.join(errors));
    let (side, dead_zones) = (sampling.grid.side(), sampling.distance.is_some());
    fields::write(comm, folder, &subject.name, &pieces, side, dead_zones)?;
    draw_errors(comm, folder, subject, against, &pieces, &whole)?;
    if dead_zones {
        draw_dead_zones(comm, folder, subject, sampling, &pieces, &whole)?;
    }
    let ids = (0..rows.len()).map(|k| surface.id(k));
    Ok((ids.zip(rows).collect(), whole))
}

/// Writes `errors.svg`. Collective.
fn draw_errors(
    comm: &SimpleCommunicator,
    folder: &OutputFolder,
    subject: &Subject,
    against: &Against,
    pieces: &[SampledPiece],
    whole: &Errors,
) -> Result<()> {
    let mut distance = Histogram::new(whole.lowest.value, whole.highest.value);
    let mut normal = Histogram::new(0.0, whole.turned.value);
    for sample in pieces.iter().flat_map(|piece| &piece.samples) {
        distance.add(sample.distance, sample.share);
        normal.add(sample.angle, sample.share);
    }
    sum(comm, &mut distance.shares);
    sum(comm, &mut normal.shares);
    let title = format!("{} against {}", subject.name, against.name);
    let text = if comm.rank() == 0 { figures::errors(&title, &distance, &normal) } else { Ok(String::new()) };
    folder.write(comm, "errors.svg", &agree(comm, text)?)
}

/// Writes `dead-zones.svg`. Collective.
fn draw_dead_zones(
    comm: &SimpleCommunicator,
    folder: &OutputFolder,
    subject: &Subject,
    sampling: &Sampling,
    pieces: &[SampledPiece],
    whole: &Errors,
) -> Result<()> {
    let side = sampling.grid.side();
    let stride = figures::stride(subject.surface.count(), side);
    let mine = pieces.iter().flat_map(|piece| Tile::of_piece(piece, side, stride));
    let tiles: Vec<Tile> =
        to_all(comm, &mine.map(|tile| tile.to_array()).collect::<Vec<_>>()).iter().map(Tile::from_array).collect();
    let title = format!("{}, points at the distance {}", subject.name, sampling.distance.unwrap_or_default());
    let text = if comm.rank() == 0 { figures::dead_zones(&title, &tiles, &whole.dead()) } else { Ok(String::new()) };
    folder.write(comm, "dead-zones.svg", &agree(comm, text)?)
}

/// The projections of all points, on all ranks. Collective.
fn project_all(comm: &SimpleCommunicator, surface: &dyn Described, points: &[Vec3], extension: f64) -> Vec<Row> {
    let project = |k: usize| projections::project(surface, &points[k], extension);
    let mine: Vec<_> = share(comm, points.len()).filter_map(project).map(|row| row.to_array()).collect();
    to_all(comm, &mine).iter().map(Row::from_array).collect()
}

/// The part of so many things that is this rank's.
fn share(comm: &SimpleCommunicator, count: usize) -> Range<usize> {
    let (rank, size) = (comm.rank() as usize, comm.size() as usize);
    rank * count / size..(rank + 1) * count / size
}
