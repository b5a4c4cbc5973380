//! How large a scene is, and what decides the course of its solution.

use super::work::Work;
use super::{patience, solver};
use crate::Vec3;
use crate::contact::Pair;
use crate::error::Result;
use crate::mesh::SolidShape;
use crate::model::{Model, Section};
use crate::output::summary::memory_mb;
use crate::parallel::{max, sum};
use crate::scene::{Formulation, Linear, Located, Scene, Step};
use crate::solid::element::hex8_shell;
use crate::system::assembly::internal_forces;
use crate::system::{DofMap, Pattern};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{Factorization, Factors, LinearSolver, Matrix, Petsc};

/// What all steps of a scene have in common; the same on all ranks.
#[derive(Clone, Debug, Default)]
pub struct Size {
    pub(super) ranks: f64,
    /// Elements of the rank that has most, by kind.
    pub(super) elements: Vec<(Work, f64)>,
    /// Slave nodes of the rank that has most; those that meet a master in the mean of faces count for as many as they cost.
    pub(super) slaves: f64,
    /// Some body may flow; some contact has friction, a body as its master, the slave itself as its master.
    pub(super) flows: bool,
    pub(super) rubs: bool,
    pub(super) meets_bodies: bool,
    pub(super) meets_itself: bool,
    pub(super) plane: bool,
    /// Bodies have few elements across.
    pub(super) thin: bool,
    /// What is held now by all ranks, MB, and what this has taken, s.
    pub(super) megabytes: f64,
    pub(super) seconds: f64,
}

/// The systems of a step; the same on all ranks.
#[derive(Clone, Copy, Debug)]
pub struct Systems {
    pub unknowns: f64,
    /// Of the matrix.
    pub entries: f64,
    pub is_symmetric: bool,
    /// What a factorization is foreseen to be, where the pattern has been analysed.
    pub factors: Option<Factors>,
    /// How the scene wants them solved.
    pub linear: Linear,
    /// What equations and pattern have taken, s.
    pub set_up_s: f64,
}

/// Increments that a step asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increments {
    /// As many as there are if none is cut.
    pub asked: f64,
    /// They may become longer and shorter than they begin.
    pub vary: bool,
}

impl Size {
    /// Of a model that has been set up in so many seconds. Collective.
    pub fn new(comm: &SimpleCommunicator, scene: &Scene, model: &Model, seconds: f64) -> Self {
        let work = |(section, (body, material)): (&Section, (usize, &Located<String>))| {
            let (is_layer, card) = (model.bodies[body].is_layer(), scene.material(&material.value)?);
            let of = |shape| Work::element(section.element.beside(shape), is_layer, card);
            Some(SHAPES.map(of))
        };
        let works: Vec<Option<[Work; SHAPES.len()]>> = model.sections.iter().zip(scene.sections()).map(work).collect();
        let all = Work::all();
        let mut counts = vec![0.0; all.len()];
        for solid in &model.part.solids {
            let shape = SHAPES.iter().position(|shape| *shape == solid.shape).unwrap_or_default();
            let (work, section) = (works[solid.section as usize].map(|of| of[shape]), model.section(solid));
            // Time goes with the points through the thickness; the rates are of as many as are usual.
            let times = match section.element {
                Formulation::Hex8Shell => section.layers as f64 / hex8_shell::usual_layers(&section.material) as f64,
                _ => 1.0,
            };
            counts.iter_mut().zip(&all).filter(|(_, kind)| Some(**kind) == work).for_each(|(count, _)| *count += times);
        }
        let times = |pair: &Pair| match (&pair.faces, pair.master.tool()) {
            (None, _) => 1.0,
            (Some(_), Some(_)) => OF_SEGMENTS[0],
            (Some(_), None) => OF_SEGMENTS[if model.is_plane() { 1 } else { 2 }],
        };
        let slaves: f64 = model.pairs.iter().map(|pair| times(pair) * pair.slaves.len() as f64).sum();
        let (mut megabytes, mut most) = ([resident_mb()], [slaves, seconds]);
        sum(comm, &mut megabytes);
        max(comm, &mut most);
        max(comm, &mut counts);
        let some = |is: &dyn Fn(&Pair) -> bool| model.pairs.iter().any(is);
        Self {
            ranks: f64::from(comm.size()),
            elements: all.into_iter().zip(counts).filter(|(_, count)| *count > 0.0).collect(),
            slaves: most[0],
            flows: model.can_flow(),
            rubs: some(&|pair| pair.rules.friction > 0.0),
            meets_bodies: some(&|pair| pair.master.surface().is_some()),
            meets_itself: some(&|pair| pair.is_self()),
            plane: model.is_plane(),
            thin: model.is_thin,
            megabytes: megabytes[0],
            seconds: most[1],
        }
    }
}

/// A slave node from segment to segment over one of its kind that meets the master itself: on a tool, between bodies in a plane and in
/// space, with the tangents of all points of the overlaps around it. Fitted to meshes of 10 over 7 facets along a side.
const OF_SEGMENTS: [f64; 3] = [2.5, 40.0, 240.0];
const SHAPES: [SolidShape; 7] = [
    SolidShape::Hex8,
    SolidShape::Wedge6,
    SolidShape::Pyramid5,
    SolidShape::Tet4,
    SolidShape::Tet10,
    SolidShape::Hex27,
    SolidShape::Wedge18,
];

impl Systems {
    /// Of a step with these equations, not analysed. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        linear: Linear,
        (dofs, pattern): Equations,
        is_symmetric: bool,
        set_up_s: f64,
    ) -> Self {
        let entries = pattern.entries(comm) as f64;
        Self { unknowns: dofs.total as f64, entries, is_symmetric, factors: None, linear, set_up_s }
    }

    /// Whether the pattern is the same, as far as its size tells.
    pub fn are_like(&self, other: &Self) -> bool {
        let of = |systems: &Self| (systems.unknowns, systems.entries, systems.is_symmetric);
        of(self) == of(other)
    }

    /// What a factorization of the stiffness of a model at rest is foreseen to be, where one may be needed and the analysis takes
    /// seconds at most. Collective.
    ///
    /// # Errors
    /// A failing library.
    pub fn analysed(&self, petsc: &Petsc, model: &Model, (dofs, pattern): Equations) -> Result<Option<Factors>> {
        let unknowns = self.unknowns as u64;
        let is_asked = solver(self.linear, unknowns, model.is_flat()) != Linear::Iterative
            || patience(self.linear, unknowns) < usize::MAX;
        if unknowns > MOST_ANALYSED || !is_asked {
            return Ok(None);
        }
        let mut values = vec![0.0; pattern.columns.len()];
        let still = vec![Vec3::zeros(); model.part.points.len()];
        let tangent = Some((pattern, &mut values[..]));
        // Of an element that is inverted at rest the run will tell.
        let _ = internal_forces(model, &still, &mut still.clone(), tangent, |_, _, _| ());
        let mut matrix = Matrix::from_csr(petsc, dofs.count, &pattern.offsets, &pattern.columns, &values)?;
        matrix.set_symmetric(self.is_symmetric)?;
        let kind = if self.is_symmetric { Factorization::Ldlt } else { Factorization::Lu };
        // What cannot be analysed is estimated by its size.
        Ok(LinearSolver::new(petsc, kind).analyse(&matrix).ok())
    }
}

/// Equations of a step, and the pattern of its matrix.
pub type Equations<'a> = (&'a DofMap, &'a Pattern);

/// Unknowns above which a pattern is not analysed for an estimate.
const MOST_ANALYSED: u64 = 200_000;

impl Increments {
    /// Of a step.
    pub fn of(step: &Step) -> Self {
        let sizes = step.sizes();
        let grid = step.duration / sizes.max;
        let vary = sizes.initial < 0.99 * sizes.max;
        // As they grow to the largest, the time that so many more take is a geometric series.
        let growing = (sizes.max / sizes.initial).ln() / 1.5f64.ln();
        let spent = (sizes.max - sizes.initial) / 0.5 / sizes.max;
        let asked = if vary { (grid - spent).max(0.0) + growing } else { grid };
        // Corners of tables that lie on no increment's end make one more each.
        let off_grid = |corner: &&f64| {
            let increments = **corner * grid;
            (increments - increments.round()).abs() > 1e-6
        };
        let corners = step.corners().iter().filter(off_grid).count();
        Self { asked: (asked - 1e-9).ceil().max(1.0) + corners as f64, vary }
    }
}

/// The memory of this machine, MB of 10^6 bytes, where the system says.
pub fn machine_mb() -> Option<f64> {
    memory_mb("/proc/meminfo", "MemTotal:")
}

/// The memory that this process holds now, MB of 10^6 bytes; 0 where the system does not say.
fn resident_mb() -> f64 {
    memory_mb("/proc/self/status", "VmRSS:").unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(duration: f64, initial: f64, most: f64) -> f64 {
        let mut step = Step::new("s", 1);
        step.duration = duration;
        step.increment.initial = initial;
        step.increment.max = most;
        Increments::of(&step).asked
    }

    #[test]
    fn increments_are_those_of_the_grid_and_those_that_grow_to_it() {
        assert_eq!(asked(1.0, 0.1, 0.1), 10.0);
        assert_eq!(asked(1.0, 1.0 / 800.0, 1.0 / 800.0), 800.0);
        // 0.01, 0.015, ... below 0.05 are four, which sum up to 1.6 of the grid of ten.
        assert_eq!(asked(0.5, 0.01, 0.05), 13.0);
        assert_eq!(asked(20.0, 0.01, 0.05), 403.0);
    }
}
