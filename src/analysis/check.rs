//! What `nagata check` finds without solving: the model, what a run would refuse or warn of, the equations of each step, and
//! what they will take.

use super::conditions::Conditions;
use super::cost::machine::Machine;
use super::cost::predict::Prediction;
use super::cost::size::{Increments, Size, Systems, machine_mb};
use super::{cost, describe, preflight};
use crate::Vec3;
use crate::error::Result;
use crate::model::Model;
use crate::output::summary::peak_memory_mb;
use crate::parallel::{agree, max, sum};
use crate::scene::{Linear, Scene, Step};
use crate::system::{DofMap, Pattern, near};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::Petsc;
use std::fmt::Write;
use std::time::Instant;

/// What `nagata check` prints: what will be modelled and what will not, and the memory that this took. Collective.
///
/// # Errors
/// What [`preflight`] refuses.
pub fn check(
    comm: &SimpleCommunicator,
    petsc: &Petsc,
    scene: &Scene,
    model: &mut Model,
    begun: Instant,
) -> Result<String> {
    let begins = preflight::check(comm, scene, model)?.gaps;
    let mut text = format!("{}\n{}\n", describe::heading(comm, scene, model), scene.solver.describe());
    text += &describe::bodies(scene, model);
    for tool in &model.masters.tools {
        let _ = writeln!(text, "{}", describe::tool(tool));
    }
    for surface in &model.masters.surfaces {
        let _ = writeln!(text, "{}", describe::master(surface));
    }
    text += &describe::contacts(comm, model);
    for line in &begins {
        let _ = writeln!(text, "{line}");
    }
    for warning in &model.warnings {
        let _ = writeln!(text, "  warning: {warning}");
    }
    let size = Size::new(comm, scene, model, begun.elapsed().as_secs_f64());
    let mut steps: Vec<(Increments, Systems)> = Vec::new();
    let (mut last, mut set_up) = (Conditions::none(model), None);
    for step in &scene.steps {
        let (conditions, dofs, pattern, mut systems) = equations(comm, scene, model, (step, &last))?;
        // Before analyses, which take more.
        set_up.get_or_insert_with(|| memory(comm));
        let known = steps.last().filter(|(_, known)| known.are_like(&systems));
        systems.factors = match known {
            Some((_, known)) => known.factors,
            None => systems.analysed(petsc, model, (&dofs, &pattern))?,
        };
        let _ = writeln!(text, "{}", equations_of(step, model, &dofs, &systems));
        steps.push((Increments::of(step), systems));
        last = conditions;
    }
    let _ = writeln!(text, "{}", set_up.unwrap_or_else(|| memory(comm)));
    let (machine, damage) = Machine::find(comm);
    damage.iter().for_each(|warning| {
        let _ = writeln!(text, "  warning: {warning}");
    });
    let prediction = Prediction::new(&machine, &size, &steps);
    let _ = writeln!(text, "{}", prediction.describe(&machine, machine_mb()));
    Ok(text)
}

/// What a step prescribes after the last one, its equations, their pattern, and systems. Collective.
fn equations(
    comm: &SimpleCommunicator,
    scene: &Scene,
    model: &mut Model,
    (step, last): (&Step, &Conditions),
) -> Result<(Conditions, DofMap, Pattern, Systems)> {
    let still = vec![Vec3::zeros(); model.part.points.len()];
    let conditions = agree(comm, Conditions::new(comm, model, step, &still, last))?;
    let begun = Instant::now();
    let near = near::everywhere(&model.pairs);
    let dofs = DofMap::new(comm, model, conditions.supports(), &conditions.freedoms(), near);
    let Model { part, masters, pairs, .. } = &mut *model;
    masters.follow(comm, pairs, |n| part.points[n as usize]);
    let pattern = Pattern::new(comm, model, &dofs, |n| model.part.points[n as usize])?;
    let (linear, is_symmetric) = (scene.solver.linear, conditions.is_symmetric(model));
    let systems = Systems::new(comm, linear, (&dofs, &pattern), is_symmetric, begun.elapsed().as_secs_f64());
    Ok((conditions, dofs, pattern, systems))
}

/// The equations of a step in words.
fn equations_of(step: &Step, model: &Model, dofs: &DofMap, systems: &Systems) -> String {
    let (matrix, factors) = match systems.is_symmetric {
        true => ("symmetric indefinite", "MUMPS LDL^T"),
        false => ("unsymmetric", "MUMPS LU"),
    };
    let solver = match cost::solver(systems.linear, dofs.total, model.is_flat()) {
        Linear::Iterative => "FGMRES with multigrid",
        _ => factors,
    };
    format!(
        "step `{}`: at most {} dofs, {} multipliers among them, {matrix} matrix with {:.0} entries, {solver}",
        step.name.value, dofs.total, dofs.total_multipliers, systems.entries
    )
}

/// What all this has taken at its peak, on all ranks and on rank 0, which reads the meshes. Collective.
fn memory(comm: &SimpleCommunicator) -> String {
    let own = peak_memory_mb();
    let (mut all, mut largest) = ([own], [own]);
    sum(comm, &mut all);
    max(comm, &mut largest);
    match comm.size() {
        1 => format!("set up with {:.0} MB", all[0]),
        ranks => {
            let share = own / (all[0] / f64::from(ranks));
            format!(
                "set up with {:.0} MB, at most {:.0} on a rank; rank 0 with {share:.2} times the mean",
                all[0], largest[0]
            )
        }
    }
}
