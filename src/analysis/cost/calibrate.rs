//! Measures how long each kind of work takes, by small models of its own.

use super::work::{Rates, Shape, Work};
use crate::Vec3;
use crate::analysis::{Event, Simulation};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::output::phases::{Phase, Phases};
use crate::parallel::{max, sum};
use crate::scene::{self, Scene};
use crate::system::assembly::internal_forces;
use crate::system::dofs::Motion;
use crate::system::{Axes, DofMap, Pattern, near};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{Factorization, Factors, LinearError, LinearSolver, LinearStatistics, Matrix, Petsc, Vector};
use std::path::Path;
use std::time::Instant;

/// Elements of a rank along each side, of which the kernels of elements are measured.
const SIDE: usize = 6;
/// Blocks that are factored: in space and in plane strain.
const FACTORED: [(bool, [usize; 3]); 4] =
    [(false, [7, 7, 7]), (false, [16, 16, 16]), (true, [60, 30, 1]), (true, [120, 40, 1])];
/// One in plane strain with so few unknowns that its factors cost little against what comes with them.
const SMALL: [usize; 3] = [18, 18, 1];
/// The block that multigrid solves.
const COARSENED: [usize; 3] = [24, 24, 12];
/// A wedge over a hexahedron with eight integration points.
const WEDGE: f64 = 0.55;
/// A quadratic one over it.
const QUADRATIC_WEDGE: f64 = 6.0;
/// A pyramid over it.
const PYRAMID: f64 = 0.6;
/// A linear and a quadratic tetrahedron over a hexahedron with eight integration points.
const TETRAHEDRA: [f64; 2] = [0.2, 0.9];

/// The rates of this machine on these ranks; each kernel runs `repeats` times, and the fastest counts. Collective.
///
/// # Errors
/// A failing library.
pub fn calibrate(comm: &SimpleCommunicator, petsc: &Petsc, repeats: usize) -> Result<Rates> {
    let mut rates = Rates::default();
    let bench = Bench { comm, petsc, repeats };
    for work in Work::all() {
        if let Work::Element(shape, material) = work {
            rates.set(work, bench.element(shape, material)?);
        }
    }
    bench.factors(&mut rates)?;
    bench.multigrid(&mut rates)?;
    bench.contact(&mut rates)?;
    Ok(rates)
}

struct Bench<'a> {
    comm: &'a SimpleCommunicator,
    petsc: &'a Petsc<'a>,
    repeats: usize,
}

/// Factors, and what they took, s.
struct Timed {
    factors: Factors,
    unknowns: f64,
    factoring: f64,
    applying: f64,
}

/// A block, and its equations.
struct Block {
    model: Model,
    dofs: DofMap,
    pattern: Pattern,
}

impl Bench<'_> {
    /// The least of what some work takes, s, of the rank that takes longest. Collective.
    fn fastest(&self, mut work: impl FnMut() -> Result<f64>) -> Result<f64> {
        let mut least = f64::INFINITY;
        for _ in 0..self.repeats {
            self.comm.barrier();
            let mut took = [work()?];
            max(self.comm, &mut took);
            least = least.min(took[0]);
        }
        Ok(least)
    }

    /// A block of so many elements, fixed below.
    fn block(&self, element: &str, material: &str, plane: bool, elements: [usize; 3]) -> Result<Block> {
        let shell = if element == "hex8-shell" { ", shell = { face = \"zmin\" }" } else { "" };
        let cells = format!("{{ box = {{ size = {elements:?} }}, elements = {elements:?} }}");
        let scene = parse(&format!(
            "body.block = {{ material = \"m\", element = \"{element}\"{shell}, plane_strain = {plane}, block = {cells} }}\n\
             {}\nstep = [{{ increments = 1, fix = [{{ set = \"block.ymin\" }}] }}]",
            card(material)
        ))?;
        let model = Model::new(self.comm, &scene, &Phases::default())?;
        let owned = model.part.points.iter().take(model.part.owned);
        let held = |x: &Vec3| [0, 1, 2].map(|d| (x.y == 0.0 || plane && d == 2).then_some(Motion::still(0.0)));
        let prescribed: Vec<_> = owned.flat_map(held).collect();
        let dofs = DofMap::new(self.comm, &model, (&prescribed, &Axes::default()), &[], near::everywhere(&model.pairs));
        let pattern = Pattern::new(self.comm, &model, &dofs, |n| model.part.points[n as usize])?;
        Ok(Block { model, dofs, pattern })
    }

    /// Seconds of an element of a shape with a material.
    fn element(&self, shape: Shape, material: &str) -> Result<f64> {
        let ranks = self.comm.size() as usize;
        let (element, plane, elements) = match shape {
            Shape::Solid("tet4") => return Ok(TETRAHEDRA[0] * self.element(Shape::Solid("hex8"), material)?),
            Shape::Solid("tet10") => return Ok(TETRAHEDRA[1] * self.element(Shape::Solid("hex8"), material)?),
            Shape::Solid("tet10-sri") => return Ok(TETRAHEDRA[1] * self.element(Shape::Solid("hex8-sri"), material)?),
            Shape::Solid("pyramid5") => return Ok(PYRAMID * self.element(Shape::Solid("hex8"), material)?),
            Shape::Solid("pyramid5-sri") => return Ok(PYRAMID * self.element(Shape::Solid("hex8-sri"), material)?),
            Shape::Solid("wedge6") => return Ok(WEDGE * self.element(Shape::Solid("hex8"), material)?),
            Shape::Solid("wedge18") => return Ok(QUADRATIC_WEDGE * self.element(Shape::Solid("hex8"), material)?),
            Shape::Solid("wedge18-sri") => {
                return Ok(QUADRATIC_WEDGE * self.element(Shape::Solid("hex8-sri"), material)?);
            }
            Shape::Solid("wedge6-sri") => return Ok(WEDGE * self.element(Shape::Solid("hex8-sri"), material)?),
            Shape::Solid(element) => (element, false, [SIDE, SIDE, SIDE * ranks]),
            Shape::Plane(element) => (element, true, [3 * SIDE, 3 * SIDE * ranks, 1]),
        };
        let block = self.block(element, material, plane, elements)?;
        let u = block.strained(0.01);
        let mut values = vec![0.0; block.pattern.columns.len()];
        let mut forces = vec![Vec3::zeros(); u.len()];
        let count = block.model.part.solids.len().max(1) as f64;
        self.fastest(|| {
            let begun = Instant::now();
            let tangent = Some((&block.pattern, &mut values[..]));
            // An element that cannot be strained so takes as long.
            let _ = internal_forces(&block.model, &u, &mut forces, tangent, |_, _, _| ());
            Ok(begun.elapsed().as_secs_f64() / count)
        })
    }

    /// Seconds of factors, and of iterations with old ones.
    fn factors(&self, rates: &mut Rates) -> Result<()> {
        let alone = self.factored(true, SMALL)?.factoring;
        rates.set(Work::Factorization, alone);
        let mut found = Vec::new();
        for (plane, elements) in FACTORED {
            let Timed { factors, unknowns, factoring, applying } = self.factored(plane, elements)?;
            found.push(Timed { factors, unknowns, factoring: (factoring - alone).max(0.5 * factoring), applying });
        }
        let usual = Rates::default();
        let usual = |work| usual.of(work);
        let factored = found.iter().map(|f| (f.factors.operations, f.factors.entries, f.factoring));
        let (operation, entry) = fit(factored, (usual(Work::Operation), usual(Work::Entry)));
        rates.set(Work::Operation, operation);
        rates.set(Work::Entry, entry);
        let applied = found.iter().map(|f| (f.factors.entries, f.unknowns, f.applying));
        let (application, row) = fit(applied, (usual(Work::Application), usual(Work::Row)));
        rates.set(Work::Application, application);
        rates.set(Work::Row, row);
        rates.set(Work::Product, self.product()?);
        Ok(())
    }

    /// A block whose matrix is factored.
    fn factored(&self, plane: bool, elements: [usize; 3]) -> Result<Timed> {
        let block = self.block("hex8", "neo-hookean", plane, elements)?;
        let (mut matrix, b, mut x) = block.system(self.petsc, 0.0)?;
        let mut solver = LinearSolver::new(self.petsc, Factorization::Lu);
        let values = block.stiffness(0.0);
        let mut applying = f64::INFINITY;
        solved(solver.solve(&matrix, &b, &mut x))?;
        let factoring = self.fastest(|| {
            let before = self.logged(["MatLUFactorNum", "MatSolve"])?;
            matrix.update(&values)?;
            solved(solver.solve(&matrix, &b, &mut x))?;
            let after = self.logged(["MatLUFactorNum", "MatSolve"])?;
            let mut applied = [after[1] - before[1]];
            max(self.comm, &mut applied);
            applying = applying.min(applied[0]);
            Ok(after[0] - before[0])
        })?;
        let factors = solver.factors()?.ok_or_else(|| Error::System("no factors".into()))?;
        Ok(Timed { factors, unknowns: block.dofs.total as f64, factoring, applying })
    }

    /// Seconds an entry of the matrix in an iteration with old factors.
    fn product(&self) -> Result<f64> {
        let (plane, elements) = FACTORED[2];
        let block = self.block("hex8", "neo-hookean", plane, elements)?;
        let (mut matrix, b, mut x) = block.system(self.petsc, 0.0)?;
        let mut solver = LinearSolver::new(self.petsc, Factorization::Lu);
        solver.reuse_factors(0)?;
        let values = [block.stiffness(0.0), block.stiffness(0.02)];
        self.fastest(|| {
            matrix.update(&values[0])?;
            solved(solver.solve(&matrix, &b, &mut x))?;
            matrix.update(&values[1])?;
            let before = solver.statistics();
            solved(solver.solve(&matrix, &b, &mut x))?;
            let LinearStatistics { iterate_s, krylov_iterations, .. } = solver.statistics();
            let iterations = (krylov_iterations - before.krylov_iterations).max(1) as f64;
            Ok((iterate_s - before.iterate_s) / iterations / block.entries(self.comm))
        })
    }

    /// Seconds of multigrid.
    fn multigrid(&self, rates: &mut Rates) -> Result<()> {
        let block = self.block("hex8", "neo-hookean", false, COARSENED)?;
        let (matrix, b, mut x) = block.system(self.petsc, 0.0)?;
        let entries = block.entries(self.comm);
        let mut cycle = f64::INFINITY;
        let set_up = self.fastest(|| {
            let mut solver = LinearSolver::new(self.petsc, Factorization::Lu);
            let place = |n: u32| block.model.part.points[n as usize];
            solver.iterate(block.dofs.unknowns(&block.model, place), usize::MAX)?;
            solved(solver.solve(&matrix, &b, &mut x))?;
            let LinearStatistics { set_up_s, iterate_s, krylov_iterations, .. } = solver.statistics();
            let mut iterating = [iterate_s / krylov_iterations.max(1) as f64];
            max(self.comm, &mut iterating);
            cycle = cycle.min(iterating[0]);
            Ok(set_up_s)
        })?;
        rates.set(Work::SetUp, set_up / entries);
        rates.set(Work::Cycle, cycle / entries);
        Ok(())
    }

    /// Seconds of slave nodes, and of what comes besides, in a small analysis of its own.
    fn contact(&self, rates: &mut Rates) -> Result<()> {
        let scene = parse(CONTACT)?;
        let mut rest = f64::INFINITY;
        let slave = self.fastest(|| {
            let mut simulation = Simulation::new(self.comm, self.petsc, &scene)?;
            let searching = |of: &Simulation| of.phases().seconds(Phase::Search) + of.phases().seconds(Phase::Watch);
            let (begun, phases) = (Instant::now(), searching(&simulation));
            let before = self.logged(SOLVING)?;
            simulation.begin(&scene.steps[0])?;
            while simulation.advance(&mut |_: &Event| Ok(()))?.is_some() {}
            let (wall, summary) = (begun.elapsed().as_secs_f64(), simulation.summary());
            let solving: f64 = self.logged(SOLVING)?.iter().zip(before).map(|(after, before)| after - before).sum();
            let search = searching(&simulation) - phases;
            let counted = search + simulation.phases().seconds(Phase::Assembly) + solving;
            let counted = counted + summary.linear.iterate_s + summary.linear.set_up_s;
            let iterations = summary.counts.iterations.max(1) as f64;
            let mut besides = [(wall - counted).max(0.0) / iterations / summary.systems.dofs as f64];
            max(self.comm, &mut besides);
            rest = rest.min(besides[0]);
            let slaves = simulation.model().pairs.iter().map(|pair| pair.slaves.len()).sum::<usize>();
            Ok(if slaves > 0 { search / iterations / slaves as f64 } else { 0.0 })
        })?;
        rates.set(Work::Slave, slave);
        rates.set(Work::Unknown, rest);
        Ok(())
    }

    /// Seconds of this rank in events of PETSc.
    fn logged<const N: usize>(&self, events: [&str; N]) -> Result<[f64; N]> {
        let mut seconds = [0.0; N];
        for (seconds, event) in seconds.iter_mut().zip(events) {
            *seconds = self.petsc.log_seconds(event)?;
        }
        Ok(seconds)
    }
}

impl Block {
    /// Displacements that strain it about so much, unevenly.
    fn strained(&self, strain: f64) -> Vec<Vec3> {
        let field = |x: &Vec3| strain * Vec3::new(x.y, 0.3 * x.y + 0.2 * (x.x + x.z).sin(), 0.0);
        self.model.part.points.iter().map(field).collect()
    }

    /// Entries of its stiffness where it is strained so.
    fn stiffness(&self, strain: f64) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.columns.len()];
        let mut forces = vec![Vec3::zeros(); self.model.part.points.len()];
        let tangent = Some((&self.pattern, &mut values[..]));
        let _ = internal_forces(&self.model, &self.strained(strain), &mut forces, tangent, |_, _, _| ());
        values
    }

    /// Its stiffness, a load, and a place for the solution. Collective.
    fn system<'p>(&self, petsc: &'p Petsc<'p>, strain: f64) -> Result<(Matrix<'p>, Vector<'p>, Vector<'p>)> {
        let Pattern { offsets, columns, .. } = &self.pattern;
        let matrix = Matrix::from_csr(petsc, self.dofs.count, offsets, columns, &self.stiffness(strain))?;
        let load: Vec<f64> = (0..self.dofs.count).map(|k| 1.0 + (0.7 * k as f64).sin()).collect();
        Ok((matrix, Vector::from_slice(petsc, &load)?, Vector::zeros(petsc, self.dofs.count)?))
    }

    /// Entries of the matrix on all ranks. Collective.
    fn entries(&self, comm: &SimpleCommunicator) -> f64 {
        let mut entries = [self.pattern.columns.len() as f64];
        sum(comm, &mut entries);
        entries[0]
    }
}

/// Events of PETSc that are linear algebra.
const SOLVING: [&str; 5] = ["MatLUFactorSym", "MatLUFactorNum", "MatCholFctrSym", "MatCholFctrNum", "MatSolve"];

/// A block that is pressed onto another, and drawn along it.
const CONTACT: &str = r#"
body.upper = { material = "m", block = { box = { origin = [2, 2, 3], size = [6, 6, 2] }, elements = [10, 10, 2] } }
body.lower = { material = "m", block = { box = { size = [10, 10, 3] }, elements = [12, 12, 3] } }
material.m = { model = "neo-hookean", young = 100, poisson = 0.3 }
contact.joint = { slave = "upper.zmin", master = "lower.zmax", smoothing = "nagata", friction = 0.2 }
step = [{ increments = 4, fix = [{ set = "lower.zmin" }], move = [{ target = "upper.zmax", by = [0.2, 0, -0.2] }] }]
"#;

/// A material of the name `m`.
fn card(model: &str) -> String {
    let plastic = "young = 200, poisson = 0.3, hardening = { linear = 2 }, yield_stress = 0.4";
    let rest = match model {
        "j2" => plastic.into(),
        "hill" => format!("{plastic}, hill = {{ f = 0.4, g = 0.4, h = 0.6, n = 1.3 }}"),
        _ => "young = 200, poisson = 0.3".to_string(),
    };
    format!("material.m = {{ model = \"{model}\", {rest} }}")
}

fn parse(text: &str) -> Result<Scene> {
    scene::parse("calibrate", text, Path::new("."), &[])
}

fn solved(outcome: std::result::Result<(), LinearError>) -> Result<()> {
    outcome.map_err(|error| Error::System(error.to_string()))
}

/// The x and y of least squares of the relative errors of a x + b y = t in all (a, b, t). Where noise leaves nothing of one of
/// them, which would foretell nothing for what grows with that one, they have the proportion of the `usual` ones.
fn fit(found: impl Iterator<Item = (f64, f64, f64)>, usual: (f64, f64)) -> (f64, f64) {
    let mut sums = [0.0; 5];
    for (a, b, t) in found {
        let (a, b) = (a / t, b / t);
        sums.iter_mut().zip([a * a, a * b, b * b, a, b]).for_each(|(sum, term)| *sum += term);
    }
    let [aa, ab, bb, a, b] = sums;
    let determinant = aa * bb - ab * ab;
    let (x, y) = ((a * bb - b * ab) / determinant, (b * aa - a * ab) / determinant);
    if x > 0.0 && y > 0.0 {
        return (x, y);
    }
    let (x, y) = usual;
    let times = (a * x + b * y) / (aa * x * x + 2.0 * ab * x * y + bb * y * y);
    (times * x, times * y)
}

#[cfg(test)]
mod tests {
    use super::fit;

    #[test]
    fn rates_are_found_again_and_none_is_lost_in_noise() {
        let usual = (1e-10, 5e-9);
        let times = |x: f64, y: f64| {
            let sizes = [(1e7, 1e5), (4e8, 1e6), (2e9, 3e6), (1e8, 1e6)];
            fit(sizes.into_iter().map(|(a, b)| (a, b, a * x + b * y)), usual)
        };
        let (x, y) = times(2e-10, 1e-8);
        assert!((x / 2e-10 - 1.0).abs() < 1e-9 && (y / 1e-8 - 1.0).abs() < 1e-9, "{x} {y}");
        for (x, y) in [times(2e-10, -1e-9), times(-2e-12, 1e-8)] {
            assert!(x > 1e-11 && (y / x - usual.1 / usual.0).abs() < 1e-9, "{x} {y}");
        }
    }
}
