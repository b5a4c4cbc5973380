//! The grids that ParaView shows: bodies, contact surfaces, tools, and deformable masters.

use super::results::{Column, vectors};
use crate::Vec3;
use crate::contact::Pose;
use crate::error::Result;
use crate::mesh::{MOST_NODES, SolidShape};
use crate::model::Model;
use crate::output::fields::{Cell, CellShape, Field, Fields, Grid, GridData, GridId};
use crate::parallel::number;
use crate::partition::parcels::{bounds, grown, hull};
use crate::partition::{Order, PartFacet};
use crate::surface::Tessellation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// A grid, whose points and cells stand in the files in an order that does not depend on the partition.
pub struct Placed {
    pub id: GridId,
    pub points: Order,
    /// Of the cells, where they have fields.
    pub cells: Option<Order>,
}

/// The nodes of this rank that a grid shows, and the cells that refer to them.
pub struct Shown {
    pub grid: Placed,
    /// Local nodes of the part.
    pub nodes: Vec<u32>,
}

/// The grids of a file of fields.
pub struct Grids {
    pub bodies: Vec<Shown>,
    pub contacts: Vec<Shown>,
    pub tools: Vec<(Placed, Vec<Vec3>)>,
    /// Deformable masters, with the initial positions of their points.
    pub masters: Vec<(Placed, Vec<Vec3>)>,
}

/// Pieces along an edge of a smoothed patch in ParaView.
const PIECES: usize = 6;

/// A cell with its number, whatever the partition, and its local nodes.
type NumberedCell<'a> = (u64, CellShape, &'a [u32]);

/// The fields of a grid.
pub struct Columns<'g> {
    pub grid: &'g Placed,
    pub node: Vec<Column>,
    pub cell: Vec<Column>,
}

impl<'g> Columns<'g> {
    /// Those of a surface that only moves.
    pub fn moved(grid: &'g Placed, displacement: Vec<f64>) -> Self {
        Self { grid, node: vec![("displacement".into(), 3, displacement)], cell: Vec::new() }
    }

    /// Brings the values of all ranks into the order of the files. Collective.
    fn arrange(&mut self, comm: &SimpleCommunicator) {
        for (_, width, values) in &mut self.node {
            *values = self.grid.points.arrange(comm, *width, values);
        }
        for (order, (_, width, values)) in self.grid.cells.iter().cycle().zip(&mut self.cell) {
            *values = order.arrange(comm, *width, values);
        }
    }
}

impl Grids {
    /// Writes them as they begin. Collective.
    pub fn new(comm: &SimpleCommunicator, fields: &mut Fields, model: &Model) -> Result<Self> {
        let mut bodies = Vec::new();
        for (b, body) in model.bodies.iter().enumerate() {
            let nodes: Vec<u32> = model.part.owned_of(b).map(|n| n as u32).collect();
            let cells: Vec<NumberedCell> = (model.part.solids.iter().filter(|s| s.mine && s.body == b as u32))
                .map(|s| (s.number, cell_shape(s.shape), s.nodes()))
                .collect();
            bodies.push(show(comm, fields, model, &format!("body.{}", body.name), nodes, &cells)?);
        }
        let mut contacts = Vec::new();
        for pair in &model.pairs {
            let set = &model.part.sets[pair.side.set];
            let pieces = model.part.pieces(&set.facets);
            let cells: Vec<NumberedCell> = pieces.iter().filter(|f| f.mine).map(facet_cell).collect();
            contacts.push(show(comm, fields, model, &format!("contact.{}", pair.name), set.nodes.clone(), &cells)?);
        }
        let tools = add_tools(comm, fields, model)?;
        let masters = add_masters(comm, fields, model)?;
        Ok(Self { bodies, contacts, tools, masters })
    }

    /// The tools as they are with these poses, and the deformable masters with nodes displaced by `u`. Collective.
    pub fn surfaces<'g>(
        &'g self,
        comm: &SimpleCommunicator,
        model: &Model,
        (poses, u): (&[Pose], &[Vec3]),
    ) -> Vec<Columns<'g>> {
        let mut grids = Vec::new();
        for ((grid, points), pose) in self.tools.iter().zip(poses) {
            grids.push(Columns::moved(grid, vectors(points.iter().map(|x| pose.outward(x) - x))));
        }
        for ((grid, points), surface) in self.masters.iter().zip(&model.masters.surfaces) {
            let now = surface.tessellate(comm, PIECES, |n| model.part.points[n as usize] + u[n as usize]);
            let moved = vectors(now.points.iter().zip(points).map(|(now, x)| Vec3::from(*now) - x));
            grids.push(Columns::moved(grid, moved));
        }
        grids
    }
}

/// Writes the columns of grids as a time. Collective.
pub fn write(comm: &SimpleCommunicator, fields: &mut Fields, time: f64, mut grids: Vec<Columns>) -> Result<()> {
    grids.iter_mut().for_each(|columns| columns.arrange(comm));
    let columns: Vec<(Vec<Field>, Vec<Field>)> =
        grids.iter().map(|g| (as_fields(&g.node), as_fields(&g.cell))).collect();
    let data: Vec<GridData> = (grids.iter().zip(&columns))
        .map(|(g, (node, cell))| GridData { grid: g.grid.id, node_fields: node, cell_fields: cell })
        .collect();
    fields.write(comm, time, &data)
}

fn as_fields(columns: &[Column]) -> Vec<Field<'_>> {
    columns.iter().map(|(name, components, values)| Field { name, components: *components, values }).collect()
}

fn cell_shape(shape: SolidShape) -> CellShape {
    match shape {
        SolidShape::Tet4 => CellShape::Tetrahedron,
        SolidShape::Hex8 => CellShape::Hexahedron,
        SolidShape::Wedge6 => CellShape::Wedge,
        SolidShape::Pyramid5 => CellShape::Pyramid,
        SolidShape::Tet10 => CellShape::QuadraticTetrahedron,
        SolidShape::Wedge18 => CellShape::QuadraticWedge,
        SolidShape::Hex27 => CellShape::QuadraticHexahedron,
    }
}

fn facet_cell(facet: &PartFacet) -> NumberedCell<'_> {
    match facet.count {
        3 => (facet.number, CellShape::Triangle, &facet.nodes[..3]),
        _ => (facet.number, CellShape::Quadrilateral, &facet.nodes[..]),
    }
}

/// Writes the grid of some owned nodes and of cells whose nodes may be other ranks'. Collective.
fn show(
    comm: &SimpleCommunicator,
    fields: &mut Fields,
    model: &Model,
    name: &str,
    nodes: Vec<u32>,
    cells: &[NumberedCell],
) -> Result<Shown> {
    let keys: Vec<u64> = nodes.iter().map(|&n| model.part.number[n as usize]).collect();
    let order = Order::new(comm, &keys);
    let mut numbers = vec![0u64; model.part.points.len()];
    for (&n, position) in nodes.iter().zip(order.positions()) {
        numbers[n as usize] = *position;
    }
    model.part.halo.update(comm, 1, &mut numbers);
    let points: Vec<[f64; 3]> = nodes.iter().map(|&n| model.part.points[n as usize].into()).collect();
    let keys: Vec<u64> = cells.iter().map(|(number, ..)| *number).collect();
    let cells: Vec<Cell> = cells
        .iter()
        .map(|(_, shape, local)| {
            let mut of_cell = [0; MOST_NODES];
            local.iter().zip(&mut of_cell).for_each(|(&n, global)| *global = numbers[n as usize]);
            if *shape == CellShape::Wedge {
                // Both triangles of VTK's are seen clockwise from inside, where ours are seen counter-clockwise.
                of_cell.swap(1, 2);
                of_cell.swap(4, 5);
            }
            if *shape == CellShape::QuadraticWedge {
                // With both triangles seen from the other side, and the middles of their edges, of those between and of sides.
                for [a, b] in [[1, 2], [4, 5], [6, 8], [9, 11], [13, 14], [15, 17]] {
                    of_cell.swap(a, b);
                }
            }
            if *shape == CellShape::QuadraticHexahedron {
                // The middles of faces are those at -xi, xi, -eta, eta, -zeta and zeta there.
                let [bottom, top, front, right, back, left] = std::array::from_fn(|face| of_cell[20 + face]);
                of_cell[20..26].copy_from_slice(&[left, right, front, back, bottom, top]);
            }
            Cell { shape: *shape, nodes: of_cell }
        })
        .collect();
    let of_cells = Some(Order::new(comm, &keys));
    Ok(Shown { grid: place(comm, fields, (name, &points, &cells), order, of_cells)?, nodes })
}

/// Writes a grid in the order of its points and, where they have fields, its cells. Collective.
fn place(
    comm: &SimpleCommunicator,
    fields: &mut Fields,
    (name, points, cells): (&str, &[[f64; 3]], &[Cell]),
    order: Order,
    of_cells: Option<Order>,
) -> Result<Placed> {
    let points = order.arrange(comm, 3, points.as_flattened());
    let cells = match &of_cells {
        None => cells.to_vec(),
        Some(order) => {
            let numbers: Vec<u64> = cells.iter().flat_map(|cell| cell.to_numbers()).collect();
            let arranged = order.arrange(comm, Cell::LEN, &numbers);
            arranged.as_chunks().0.iter().map(Cell::from_numbers).collect()
        }
    };
    let id = fields.add_grid(comm, &Grid { name, points: points.as_chunks().0, cells: &cells })?;
    Ok(Placed { id, points: order, cells: of_cells })
}

/// Writes the tools as the solver sees them. Collective.
fn add_tools(comm: &SimpleCommunicator, fields: &mut Fields, model: &Model) -> Result<Vec<(Placed, Vec<Vec3>)>> {
    let whole = hull(comm, bounds(model.part.points[..model.part.owned].iter().copied()));
    let (lo, hi) = whole.unwrap_or_default();
    let clip = grown((lo, hi), 0.25 * (hi - lo).norm());
    let mut tools = Vec::new();
    for tool in &model.masters.tools {
        let surface = tool.surface.tessellate(comm.rank(), PIECES, &clip);
        // Pieces are dealt out by their numbers: those of one rank follow those of the other.
        let (first, _) = number(comm, surface.points.len() as u64);
        let numbers: Vec<u64> = (first..first + surface.points.len() as u64).collect();
        tools.push(add_surface(comm, fields, &format!("tool.{}", tool.name), &surface, &numbers)?);
    }
    Ok(tools)
}

/// Writes the deformable masters as they begin. Collective.
fn add_masters(comm: &SimpleCommunicator, fields: &mut Fields, model: &Model) -> Result<Vec<(Placed, Vec<Vec3>)>> {
    let pairs = model.pairs.iter().filter(|p| p.master.surface().is_some());
    let masters = model.masters.surfaces.iter().zip(pairs).map(|(surface, pair)| {
        let begins = surface.tessellate(comm, PIECES, |n| model.part.points[n as usize]);
        let numbers = surface.point_numbers(PIECES);
        add_surface(comm, fields, &format!("master.{}", pair.name), &begins, &numbers)
    });
    masters.collect()
}

/// Writes a tessellated surface, and gives its points, which have `numbers` whatever the partition. Collective.
fn add_surface(
    comm: &SimpleCommunicator,
    fields: &mut Fields,
    name: &str,
    surface: &Tessellation,
    numbers: &[u64],
) -> Result<(Placed, Vec<Vec3>)> {
    let order = Order::new(comm, numbers);
    let cell = |shape: CellShape, corners: &[u32]| {
        let mut nodes = [0; MOST_NODES];
        corners.iter().zip(&mut nodes).for_each(|(&n, global)| *global = order.positions()[n as usize]);
        Cell { shape, nodes }
    };
    let triangles = surface.triangles.iter().map(|t| cell(CellShape::Triangle, t));
    let quads = surface.quads.iter().map(|q| cell(CellShape::Quadrilateral, q));
    let cells: Vec<Cell> = triangles.chain(quads).collect();
    let points = surface.points.iter().map(|x| Vec3::from(*x)).collect();
    Ok((place(comm, fields, (name, &surface.points, &cells), order, None)?, points))
}
