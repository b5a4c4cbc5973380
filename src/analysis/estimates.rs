//! The estimates of a run: those at the ends of its steps, for the summary, and the last of them in words.

use super::Simulation;
use crate::contact::Pair;
use crate::estimate::energy::{Energy, OfBody};
use crate::estimate::facets::Stiffness;
use crate::estimate::{self, Estimate, OfContact};
use crate::model::Model;
use serde_json::{Map, Value, json};

/// Dissipated part of the energy from which a body counts as flowing.
const FLOWS: f64 = 0.01;
/// Part of the elements in a single layer from which a body counts as thin.
const THIN: f64 = 0.1;
/// Error in energy beyond which an estimate is but an order of magnitude.
const COARSE: f64 = 0.5;
/// Nodes from the edge of a contact to its middle from which it is resolved.
const RESOLVED: usize = 4;
/// Nodal pressures of a contact that is resolved are off those around them by some hundredths.
const UNEVEN: f64 = 0.2;

/// What is kept of a run.
#[derive(Clone, Debug, Default)]
pub struct Estimates {
    stiffness: Vec<Stiffness>,
    /// One for each step that has ended.
    pub steps: Vec<Value>,
    /// The last of them, and what is known of the increments.
    words: Option<String>,
    increments: Option<String>,
}

impl Estimates {
    /// Learns of a converged increment. Collective.
    pub fn learn(&mut self, simulation: &Simulation) {
        let (comm, model, forces) = (simulation.comm(), simulation.model(), &simulation.state().tool_forces);
        self.stiffness.resize(model.masters.tools.len(), Stiffness::default());
        for (t, (stiffness, force)) in self.stiffness.iter_mut().zip(forces).enumerate() {
            stiffness.learn(comm, model, t, force);
        }
    }

    /// Estimates the end of a step, from the energy of its error. Collective.
    pub fn end_step(&mut self, simulation: &Simulation, step: &str, energy: &Energy) {
        let (model, state) = (simulation.model(), simulation.state());
        let stiffness: Vec<Option<f64>> = self.stiffness.iter().map(|s| s.value).collect();
        let found = estimate::of(simulation.comm(), model, energy, &state.u, &stiffness);
        self.steps.push(record(model, &found, step, state.time));
        self.words = words(model, &found);
    }

    /// What the contacts of tools have shown so far.
    pub fn stiffness(&self) -> Vec<Stiffness> {
        self.stiffness.clone()
    }

    /// Goes on with what an earlier run knew.
    pub fn go_on(&mut self, steps: Vec<Value>, stiffness: Vec<Stiffness>) {
        (self.steps, self.stiffness) = (steps, stiffness);
    }

    /// Adds something that is known of each step.
    pub fn add(&mut self, key: &str, found: Vec<Value>) {
        for (step, found) in self.steps.iter_mut().zip(found) {
            step[key] = found;
        }
        self.increments = self.steps.last().and_then(|step| worst_increments(&step[key]));
    }

    /// The last estimate, in two lines at most.
    pub fn words(&self) -> Option<String> {
        let (words, more) = (self.words.clone()?, self.increments.as_deref().unwrap_or_default());
        let (first, rest) = words.split_once('\n').map_or((words.as_str(), None), |(a, b)| (a, Some(b)));
        Some(rest.map_or(format!("{first}{more}"), |rest| format!("{first}{more}\n{rest}")))
    }
}

/// Why the estimate of a body is not to be trusted.
fn doubts_of_body(body: &OfBody) -> Vec<&'static str> {
    let doubts = [
        (body.flown > FLOWS, "it flows: the error says where to refine, not how large it is"),
        (body.thin > THIN, "it is one element thick: what varies through the thickness is not seen"),
        (body.relative() > COARSE, "the mesh is too coarse for more than an order of magnitude"),
    ];
    doubts.into_iter().filter(|(holds, _)| *holds).map(|(_, doubt)| doubt).collect()
}

/// The same of a contact.
fn doubts_of_contact(contact: &OfContact) -> Vec<String> {
    let nodes = contact.pressure.nodes;
    let mut doubts = Vec::new();
    if nodes < RESOLVED {
        let (some, more) = match nodes {
            1 => ("node", ", nor, within half a facet, where the force acts"),
            _ => ("nodes", ""),
        };
        doubts.push(format!("{nodes} {some} from its edge to its middle: the pressure is not resolved{more}"));
    }
    if nodes >= RESOLVED && contact.pressure.relative > UNEVEN {
        let off = 100.0 * contact.pressure.relative;
        doubts.push(format!(
            "nodal pressures are {off:.0} % off those around them, and may alternate: the highest one says little, forces and \
             stresses more"
        ));
    }
    if contact.pressure.peaks_at_edge {
        doubts.push("the highest pressure is at its edge, and grows with a finer mesh where that is sharp".into());
    }
    if contact.force > 1.0 {
        let more = "its master bulges by more over a facet than it is pressed in: the force is not resolved";
        doubts.push(more.into());
    }
    doubts
}

/// An estimate for `summary.json`.
fn record(model: &Model, found: &Estimate, step: &str, time: f64) -> Value {
    let body = |body: &OfBody| json!({ "energy": short(body.relative()), "doubts": doubts_of_body(body) });
    let bodies: Map<String, Value> =
        model.bodies.iter().zip(&found.bodies).map(|(b, of)| (b.name.clone(), body(of))).collect();
    let contact = |(p, of): &(usize, OfContact)| {
        let value = json!({
            "force": short(of.force),
            "force_size": short(of.force * of.size),
            "pressure": short(of.pressure.relative),
            "nodes_to_middle": of.pressure.nodes,
            "doubts": doubts_of_contact(of),
        });
        (model.pairs[*p].name.clone(), value)
    };
    let contacts: Map<String, Value> = found.contacts.iter().map(contact).collect();
    let tools: Map<String, Value> = (model.masters.tools.iter().zip(&found.tools))
        .filter_map(|(tool, of)| {
            let of = of.as_ref()?;
            Some((tool.name.clone(), json!({ "length": short(of.length), "force": of.force.map(short) })))
        })
        .collect();
    json!({ "step": step, "time": time, "bodies": bodies, "contacts": contacts, "tools": tools })
}

/// Four digits: there are no more in an estimate.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// The contact whose forces increments change the most, in words.
fn worst_increments(found: &Value) -> Option<String> {
    let off =
        |of: &Value| ["pressure", "shear"].map(|key| of[key].as_f64().unwrap_or(0.0)).into_iter().fold(0.0, f64::max);
    let contacts = found["contacts"].as_object()?.iter().map(|(name, of)| (name, off(of)));
    let (name, off) = contacts.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!("; increments, nodal forces of `{name}` {:.2} %", 100.0 * off))
}

/// An estimate in two lines at most: the worst of each kind, and what is not to be trusted.
fn words(model: &Model, found: &Estimate) -> Option<String> {
    let percent = |x: f64| if x > 1.0 { "more than 100 %".to_string() } else { format!("{:.2} %", 100.0 * x) };
    let name = |p: &usize| -> &Pair { &model.pairs[*p] };
    let mut parts = Vec::new();
    let worst = |of: fn(&OfContact) -> f64| found.contacts.iter().max_by(|a, b| of(&a.1).total_cmp(&of(&b.1)));
    let body = model.bodies.iter().zip(&found.bodies).max_by(|a, b| a.1.relative().total_cmp(&b.1.relative()));
    if let Some((body, of)) = body.filter(|(_, of)| of.energy > 0.0) {
        parts.push(format!("energy of `{}` {}", body.name, percent(of.relative())));
    }
    if let Some((p, of)) = worst(|of| of.force) {
        parts.push(format!("force of `{}` {}", name(p).name, percent(of.force)));
    }
    if let Some((p, of)) = worst(|of| of.pressure.relative) {
        parts.push(format!("pressure of `{}` {}", name(p).name, percent(of.pressure.relative)));
    }
    let tools = model.masters.tools.iter().zip(&found.tools).filter_map(|(tool, of)| Some((tool, of.as_ref()?)));
    if let Some((tool, of)) = tools.max_by(|a, b| a.1.length.total_cmp(&b.1.length)) {
        let force = of.force.map_or(String::new(), |force| format!(", {force:.1e} of force"));
        parts.push(format!("surface of `{}` {:.1e}{force}", tool.name, of.length));
    }
    if parts.is_empty() {
        return None;
    }
    let mut text = format!("estimated errors: {}", parts.join("; "));
    let bodies = model.bodies.iter().zip(&found.bodies);
    let doubts = bodies.flat_map(|(body, of)| doubts_of_body(of).into_iter().map(|d| format!("`{}`: {d}", body.name)));
    let contacts = found.contacts.iter();
    let more =
        contacts.flat_map(|(p, of)| doubts_of_contact(of).into_iter().map(|d| format!("`{}`: {d}", name(p).name)));
    let doubts: Vec<String> = doubts.chain(more).collect();
    if let [first, rest @ ..] = &doubts[..] {
        text += &format!("\n  not to be trusted: {first}");
        if !rest.is_empty() {
            text += &format!("; and {} more in summary.json", rest.len());
        }
    }
    Some(text)
}
