//! What a run reports of its converged increments: the rows of the history and the fields for ParaView.

use super::body_fields::{BodyFields, Known};
use super::grids::{Columns, Grids, Shown, write};
use super::probes::{self, Lengths, Probes};
use super::{Increment, SetReading, Simulation, State, ToolReading, Way};
use crate::Vec3;
use crate::contact::{Pose, Status, Trial};
use crate::error::Result;
use crate::model::tractions::tractions;
use crate::model::{Body, Model, states};
use crate::output::OutputFolder;
use crate::output::fields::Fields;
use crate::output::history::HistoryFile;
use crate::output::quantity::Quantity;
use crate::parallel::{agree, max, sum};
use crate::scene::Scene;
use mpi::topology::SimpleCommunicator;
use std::path::Path;

/// Writer of history and fields.
pub struct Results {
    history: HistoryFile,
    fields: Fields,
    grids: Grids,
    /// Tools with a torque in some step, and sets, in the history.
    turned: Vec<String>,
    watched: Vec<(String, bool)>,
    /// Fields that the scene asks for.
    wanted: Vec<Quantity>,
    /// Whether VTK is to read them.
    vtkhdf: bool,
    probes: Probes,
}

/// Writes the last iterate of an increment that was not found, as `failed.xdmf`. Collective.
///
/// # Errors
/// A file that cannot be written, on all ranks.
pub fn write_failed(folder: &OutputFolder, simulation: &Simulation) -> Result<bool> {
    let (comm, model) = (simulation.comm(), simulation.model());
    let Some(last) = &simulation.last_iterate else { return Ok(false) };
    let mut fields = Fields::create(folder, FAILED, comm)?;
    let grids = Grids::new(comm, &mut fields, model)?;
    let at = |nodes: &[u32], values: &[Vec3]| vectors(nodes.iter().map(|&n| values[n as usize]));
    let tie = |n: u32| model.part.tie[n as usize] as usize;
    let mut all = Vec::new();
    for shown in &grids.bodies {
        let residual = at(&shown.nodes, &last.residual);
        let node = vec![("displacement".into(), 3, at(&shown.nodes, &last.u)), ("residual".into(), 3, residual)];
        all.push(Columns { grid: &shown.grid, node, cell: Vec::new() });
    }
    for ((shown, pair), trials) in grids.contacts.iter().zip(&model.pairs).zip(&last.trials) {
        let mut of_node = vec![None; model.part.owned];
        pair.slaves.iter().zip(trials).for_each(|(slave, trial)| of_node[slave.node as usize] = Some(trial));
        let each = |value: &dyn Fn(&Trial) -> f64| -> Vec<f64> {
            shown.nodes.iter().map(|&n| of_node[tie(n)].map_or(f64::NAN, value)).collect()
        };
        let node = vec![
            ("displacement".into(), 3, at(&shown.nodes, &last.u)),
            ("status".into(), 1, each(&|trial| f64::from(trial.status as u8))),
            ("gap".into(), 1, each(&|trial| trial.projection.map_or(f64::NAN, |p| p.gap))),
            ("flips".into(), 1, each(&|trial| f64::from(trial.flips))),
        ];
        all.push(Columns { grid: &shown.grid, node, cell: Vec::new() });
    }
    all.extend(grids.surfaces(comm, model, (&last.poses, &last.u)));
    write(comm, &mut fields, last.time, all)?;
    Ok(true)
}

/// The name of the files of an increment that was not found.
const FAILED: &str = "failed";

impl Results {
    /// Opens the files and writes the grids. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, on all ranks.
    pub fn create(comm: &SimpleCommunicator, folder: &OutputFolder, scene: &Scene, model: &Model) -> Result<Self> {
        let history = HistoryFile::create(folder, comm, &columns(model, scene))?;
        let probes = Probes::create(comm, folder, scene, model)?;
        Self::new(comm, (history, Fields::create(folder, "fields", comm)?, probes), scene, model)
    }

    /// Goes on with the files of an earlier run, of which so many bytes of history and so many increments of fields stay, none
    /// of these, nor the state at time 0, without a number. Collective.
    ///
    /// # Errors
    /// Files that are not those of this scene, on all ranks.
    pub fn go_on(
        comm: &SimpleCommunicator,
        folder: &OutputFolder,
        scene: &Scene,
        model: &Model,
        (history, written, probes): (u64, Option<usize>, &Lengths),
    ) -> Result<Self> {
        probes::check_same(scene, probes)?;
        let history = HistoryFile::go_on(folder, comm, &columns(model, scene), history)?;
        let probes = Probes::go_on(comm, folder, scene, model, probes)?;
        let results =
            Self::new(comm, (history, Fields::go_on(folder, "fields", comm, written)?, probes), scene, model)?;
        // What was cut off is not told of.
        results.index(comm)?;
        Ok(results)
    }

    fn new(
        comm: &SimpleCommunicator,
        (history, mut fields, probes): (HistoryFile, Fields, Probes),
        scene: &Scene,
        model: &Model,
    ) -> Result<Self> {
        Ok(Self {
            history,
            grids: Grids::new(comm, &mut fields, model)?,
            fields,
            turned: turned(scene),
            watched: watched(scene),
            wanted: scene.output.fields.clone(),
            vtkhdf: scene.output.vtkhdf,
            probes,
        })
    }

    /// Bytes of history and of the tables of probes, which count on rank 0, and increments of fields, so far.
    pub fn lengths(&self) -> (u64, usize, Lengths) {
        (self.history.length(), self.fields.written(), self.probes.lengths())
    }

    /// Whether the fields of an earlier run are there still.
    pub fn goes_on(&self) -> bool {
        self.fields.goes_on()
    }

    /// The files that are written on and on.
    pub fn files(&self) -> Vec<&Path> {
        [self.history.file(), self.fields.file()].into_iter().chain(self.probes.files()).collect()
    }

    /// Whether recovered stresses and strains are asked for: of an increment whose fields are written, or of others.
    pub fn need_recovery(&self, written: bool) -> bool {
        written && self.wanted.iter().any(|field| field.is_recovered()) || self.probes.need_recovery(written)
    }

    /// Lets meshio read all that has been written until now, and VTK, if it is to. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, on all ranks.
    pub fn index(&self, comm: &SimpleCommunicator) -> Result<()> {
        self.fields.index(comm, self.vtkhdf)
    }

    /// Whether the fields have stresses of elements.
    pub fn has_stresses(&self) -> bool {
        self.wanted.iter().any(|field| matches!(field, Quantity::Mean(measure) if !measure.is_of_strain()))
    }

    /// Adds the row of a converged increment, in the tables of probes, too. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, or an element without stress, on all ranks.
    pub fn add_row(&mut self, simulation: &Simulation, increment: &Increment, known: Known) -> Result<()> {
        let (comm, model, state) = (simulation.comm(), simulation.model(), simulation.state());
        let mut row = Vec::new();
        for (tool, force) in model.masters.tools.iter().zip(&state.tool_forces) {
            row.extend(tool.displacement().iter());
            row.extend((-force).iter());
        }
        for ToolReading { turned, moment, .. } in self.turned.iter().filter_map(|tool| simulation.tool(tool)) {
            row.extend([turned, moment]);
        }
        for (set, turns) in &self.watched {
            if let Some(SetReading { displacement, reaction, moment }) = simulation.set(set) {
                row.extend(displacement.iter().chain(reaction.iter()));
                row.extend(turns.then_some(moment));
            }
        }
        for (b, _) in plastic_bodies(model) {
            let mut energies = agree(comm, states::energies(model, &state.u, b))?;
            sum(comm, &mut energies);
            row.extend(energies);
        }
        for pair in model.pairs.iter().filter(|p| !p.pass.is_second()) {
            let mut counts = [0.0; 3];
            let mut most = [0.0f64; 2];
            let mut force = [0.0; 3];
            for of_pass in std::iter::once(pair).chain(pair.pass.other().map(|other| &model.pairs[other])) {
                let tractions = tractions(comm, model, of_pass, &state.u);
                // Of two passes: what the slave's nodes bear, and what the slave gets as a master.
                let sign = if of_pass.pass.is_second() { 1.0 } else { -1.0 };
                for slave in &of_pass.slaves {
                    // In self-contact all that the nodes get, which adds up to nothing: what they bear themselves depends on
                    // how those that meet each other share a force, which is left open.
                    let on_slave = if pair.is_self() { slave.accepted.on_node() } else { sign * slave.accepted.force };
                    (0..3).for_each(|d| force[d] += on_slave[d]);
                    counts[0] += f64::from(slave.accepted.status != Status::Gap);
                    counts[1] += f64::from(slave.accepted.status == Status::Stick && pair.rules.friction > 0.0);
                    counts[2] += f64::from(slave.accepted.status == Status::Slip);
                    most[0] = most[0].max(slave.sights.accepted.depth);
                    if let Some(p) = &slave.accepted.projection {
                        most[1] = most[1].max(tractions[slave.node as usize].dot(&p.normal));
                    }
                }
            }
            sum(comm, &mut counts);
            max(comm, &mut most);
            row.extend(counts.iter().chain(&most));
            if pair.master.surface().is_some() {
                sum(comm, &mut force);
                row.extend(force);
            }
        }
        for joint in &model.joints {
            let mut force = joint.slaves.iter().map(|slave| -slave.force).sum::<Vec3>();
            sum(comm, force.as_mut_slice());
            row.extend(&force);
        }
        let how = match increment.way {
            Way::Newton { settle: false } => 0.0,
            Way::Newton { settle: true } => 1.0,
            Way::Jump => 2.0,
        };
        row.extend([increment.residual, increment.limit, increment.failures as f64, how]);
        let Increment { step, number, time, iterations, .. } = increment;
        self.history.row(comm, step, *number, *time, *iterations, &row)?;
        self.probes.add_increment(comm, model, (state, known))
    }

    /// Writes the fields of the last converged increment, or those before the first, and its paths. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, or an element without stress, on all ranks.
    pub fn write_fields(
        &mut self,
        comm: &SimpleCommunicator,
        model: &Model,
        state: &State,
        known: Known,
    ) -> Result<()> {
        let u = state.u.as_slice();
        let of_bodies = BodyFields::new(comm, model, state, known, &self.wanted)?;
        let mut grids = Vec::new();
        for (b, shown) in self.grids.bodies.iter().enumerate() {
            let cell = agree(comm, of_bodies.of_elements(b))?;
            grids.push(Columns { grid: &shown.grid, node: of_bodies.at_nodes(&shown.nodes), cell });
        }
        for (p, shown) in self.grids.contacts.iter().enumerate() {
            grids.push(contact_columns(comm, model, p, (shown, u, &self.wanted)));
        }
        let poses: Vec<Pose> = model.masters.tools.iter().map(|tool| tool.committed).collect();
        grids.extend(self.grids.surfaces(comm, model, (&poses, u)));
        write(comm, &mut self.fields, state.time, grids)?;
        if state.increments == 0 { Ok(()) } else { self.probes.add_paths(comm, model, (state, known)) }
    }
}

/// A field as (name, components, values).
pub(super) type Column = (String, usize, Vec<f64>);

/// The tools that a torque drives in some step.
fn turned(scene: &Scene) -> Vec<String> {
    let is_turned = |tool: &str| scene.steps.iter().flat_map(|step| &step.torques).any(|own| own.tool.value == tool);
    scene.tools.iter().map(|tool| tool.name.value.clone()).filter(|tool| is_turned(tool)).collect()
}

/// The sets in the history, and whether some step turns them.
fn watched(scene: &Scene) -> Vec<(String, bool)> {
    let turns = |set: &str| {
        let mut moves = scene.steps.iter().flat_map(|step| &step.moves);
        moves.any(|motion| motion.target.value == set && motion.rotate.is_some())
    };
    scene.output.history.iter().map(|set| (set.value.clone(), turns(&set.value))).collect()
}

pub(super) fn vectors(values: impl Iterator<Item = Vec3>) -> Vec<f64> {
    values.flat_map(|v| [v.x, v.y, v.z]).collect()
}

/// The bodies that can flow, with their numbers.
fn plastic_bodies(model: &Model) -> impl Iterator<Item = (usize, &Body)> {
    model.bodies.iter().enumerate().filter(|(b, _)| model.body_can_flow(*b))
}

/// Columns of the history after `step,increment,time,iterations`.
fn columns(model: &Model, scene: &Scene) -> Vec<String> {
    let of = |name: &str| ["ux", "uy", "uz", "fx", "fy", "fz"].map(|c| format!("{name}.{c}"));
    let mut columns: Vec<String> = model.masters.tools.iter().flat_map(|tool| of(&tool.name)).collect();
    columns.extend(turned(scene).iter().flat_map(|tool| ["angle", "moment"].map(|c| format!("{tool}.{c}"))));
    for (set, turns) in watched(scene) {
        columns.extend(of(&set));
        columns.extend(turns.then(|| format!("{set}.moment")));
    }
    for (_, body) in plastic_bodies(model) {
        columns.extend(["elastic_energy", "plastic_work"].map(|c| format!("{}.{c}", body.name)));
    }
    for pair in model.pairs.iter().filter(|p| !p.pass.is_second()) {
        let quantities = ["active", "stick", "slip", "max_penetration", "max_pressure"];
        columns.extend(quantities.map(|c| format!("{}.{c}", pair.name)));
        if pair.master.surface().is_some() {
            columns.extend(["fx", "fy", "fz"].map(|c| format!("{}.{c}", pair.name)));
        }
    }
    columns.extend(model.joints.iter().flat_map(|joint| ["fx", "fy", "fz"].map(|c| format!("{}.{c}", joint.name))));
    columns.extend(["residual", "limit", "failures", "found"].map(String::from));
    columns
}

/// What is wanted of status, gap, pressure, traction, force and normal on a slave surface. Forces are those on the slave.
/// Collective.
fn contact_columns<'g>(
    comm: &SimpleCommunicator,
    model: &Model,
    pair: usize,
    (shown, u, wanted): (&'g Shown, &[Vec3], &[Quantity]),
) -> Columns<'g> {
    let pair = &model.pairs[pair];
    let tractions = tractions(comm, model, pair, u);
    let mut of_node = vec![None; model.part.owned];
    for slave in &pair.slaves {
        of_node[slave.node as usize] = Some(&slave.accepted);
    }
    let trials: Vec<_> = shown.nodes.iter().map(|&n| of_node[model.part.tie[n as usize] as usize]).collect();
    // Nodes that share a displacement share the force that belongs to them together.
    let mut sharing = vec![0.0; model.part.owned];
    shown.nodes.iter().for_each(|&n| sharing[model.part.tie[n as usize] as usize] += 1.0);
    let tie = |n: u32| model.part.tie[n as usize] as usize;
    let projections = || trials.iter().map(|t| t.and_then(|t| t.projection));
    let force = |k: usize| trials[k].map_or(Vec3::zeros(), |t| t.on_node());
    let traction = |k: usize| tractions[tie(shown.nodes[k])];
    let all = 0..shown.nodes.len();
    let normals = || projections().map(|p| p.map_or(Vec3::zeros(), |p| p.normal));
    let values = |quantity: &Quantity| {
        let all = all.clone();
        let values = match quantity {
            Quantity::Displacement => vectors(shown.nodes.iter().map(|&n| u[n as usize])),
            Quantity::Status => trials.iter().map(|t| t.map_or(0.0, |t| f64::from(t.status as u8))).collect(),
            Quantity::Gap => projections().map(|p| p.map_or(f64::NAN, |p| p.gap)).collect(),
            Quantity::Pressure => all.zip(normals()).map(|(k, n)| traction(k).dot(&n)).collect(),
            Quantity::Traction => vectors(all.map(traction)),
            Quantity::Force => vectors(all.map(|k| force(k) / sharing[tie(shown.nodes[k])])),
            Quantity::Normal => vectors(normals()),
            _ => return None,
        };
        Some((quantity.key().to_string(), quantity.width(), values))
    };
    Columns { grid: &shown.grid, node: wanted.iter().filter_map(values).collect(), cell: Vec::new() }
}
