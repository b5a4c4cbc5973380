//! The error of the increments, by a second run with increments twice as long.
//!
//! Friction and plastic flow are integrated by implicit Euler, whose error is in proportion to the increments: what the two runs
//! differ by at the end of a step is the error of the one with the shorter (Richardson).

use super::{Event, Simulation};
use crate::Vec3;
use crate::contact::Trial;
use crate::error::{Error, Result};
use crate::parallel::sum;
use crate::scene::{Scene, Step};
use mpi::topology::SimpleCommunicator;
use petsc::Petsc;
use serde_json::{Map, Value, json};

/// What is compared at the end of a step, on this rank.
#[derive(Clone, Debug)]
pub struct End {
    step: String,
    /// Displacement of each tool, and force on it.
    tools: Vec<[Vec3; 2]>,
    /// For each pair the forces on its slave nodes, along the normal and along the surface.
    nodes: Vec<Vec<[Vec3; 2]>>,
}

/// Whether increments leave an error at all.
pub fn matter(simulation: &Simulation) -> bool {
    simulation.model().can_flow() || simulation.model().pairs.iter().any(|pair| pair.rules.friction > 0.0)
}

impl End {
    /// Of the step that has just ended.
    pub fn of(simulation: &Simulation, step: &str) -> Self {
        let (model, state) = (simulation.model(), simulation.state());
        let tools = model.masters.tools.iter().zip(&state.tool_forces);
        let parts = |trial: &Trial| {
            let normal = trial.projection.map_or(Vec3::zeros(), |p| p.normal * p.normal.dot(&trial.on_node()));
            [normal, trial.on_node() - normal]
        };
        Self {
            step: step.to_string(),
            tools: tools.map(|(tool, force)| [tool.displacement(), *force]).collect(),
            nodes: model.pairs.iter().map(|pair| pair.slaves.iter().map(|s| parts(&s.accepted)).collect()).collect(),
        }
    }

    /// What another run differs by: of tools in displacement and force, of contacts in nodal forces, root mean squares over that
    /// of all nodal forces. Collective.
    fn against(&self, other: &Self, simulation: &Simulation) -> Value {
        let model = simulation.model();
        let tools: Map<String, Value> = (model.masters.tools.iter().zip(self.tools.iter().zip(&other.tools)))
            .map(|(tool, (a, b))| {
                let [displacement, force] = [0, 1].map(|k| (a[k] - b[k]).norm());
                (tool.name.clone(), json!({ "displacement": displacement, "force": force }))
            })
            .collect();
        let mut contacts = Map::new();
        for (p, pair) in model.pairs.iter().enumerate().filter(|(_, pair)| !pair.pass.is_second()) {
            let mut squares = [0.0; 3];
            for (a, b) in self.nodes[p].iter().zip(&other.nodes[p]) {
                squares[0] += (a[0] - b[0]).norm_squared();
                squares[1] += (a[1] - b[1]).norm_squared();
                squares[2] += a[0].norm_squared() + a[1].norm_squared();
            }
            sum(simulation.comm(), &mut squares);
            let [normal, along, all] = squares;
            if all > 0.0 {
                let value = json!({ "pressure": (normal / all).sqrt(), "shear": (along / all).sqrt() });
                contacts.insert(pair.name.clone(), value);
            }
        }
        json!({ "tools": tools, "contacts": contacts })
    }
}

/// The step with increments twice as long.
fn hastened(step: &Step) -> Step {
    let mut step = step.clone();
    let sizes = step.sizes();
    let twice = |time: f64| (2.0 * time).min(step.duration);
    (step.increment.initial, step.increment.max) = (twice(sizes.initial), twice(sizes.max));
    step
}

/// Whether the corners of its tables keep the increments of a step from being as long as they may be.
fn is_cut_short(step: &Step) -> bool {
    let ends: Vec<f64> = [0.0].into_iter().chain(step.corners()).chain([1.0]).collect();
    let shortest = ends.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    shortest * step.duration < step.sizes().max * (1.0 - 1e-9)
}

/// Runs a scene with increments twice as long, and gives for each of these ends of steps what is estimated of the errors of the
/// increments: nothing of those in which none was left to be longer. Collective.
///
/// # Errors
/// The second run does not reach the last of these ends, or a signal ends it.
pub fn compare(comm: &SimpleCommunicator, petsc: &Petsc, scene: &Scene, ends: &[End]) -> Result<Vec<Value>> {
    let mut simulation = Simulation::new(comm, petsc, scene)?;
    let mut found = Vec::new();
    let mut comparable = true;
    for (step, end) in scene.steps.iter().zip(ends) {
        let hastened = hastened(step);
        comparable &= hastened.sizes().max > step.sizes().max * (1.0 + 1e-9) && !is_cut_short(&hastened);
        simulation.begin(&hastened)?;
        while simulation.advance(&mut |_: &Event| Ok(()))?.is_some() {}
        let differs = end.against(&End::of(&simulation, &end.step), &simulation);
        found.push(if comparable { differs } else { Value::Null });
    }
    Ok(found)
}

/// Why there is no estimate, in a warning; a signal, and what is not of the second run alone, are errors.
pub fn failed(error: Error) -> Result<String> {
    match error {
        Error::Diverged(failure) => Ok(format!(
            "the error of the increments is not known: with increments twice as long, {}",
            failure.what.lines().next().unwrap_or_default()
        )),
        other => Err(other),
    }
}
