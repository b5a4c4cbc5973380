//! A simulation that can be driven: begin a step, advance by an increment, look, go back.

use super::last_iterate::LastIterate;
use super::newton::balance::Balance;
use super::preflight::Beginning;
use super::state::{Checkpoint, Memory};
use super::step::Running;
use super::strangers::Strangers;
use super::unpaid::Account;
use super::{Event, Observer, Rounded, State, preflight};
use crate::Vec3;
use crate::contact::meeting::{mean_of_pieces, pieces_of};
use crate::contact::{Faces, Segments, Slave, Status};
use crate::error::{Error, Result};
use crate::model::{Model, outward_of};
use crate::output::phases::Phases;
use crate::output::summary::{self, Asked, Carried, Summary};
use crate::parallel::{any, sum};
use crate::scene::{Enforcement, Scene, Step};
use mpi::topology::SimpleCommunicator;
use petsc::Petsc;
use std::collections::HashSet;
use std::path::Path;

/// A simulation in progress. All ranks make the same calls at the same time; what they are given must be the same.
///
/// ```
/// use nagata::analysis::{Event, Simulation};
/// use nagata::scene;
///
/// let universe = mpi::initialize().expect("MPI");
/// let world = universe.world();
/// let petsc = petsc::Petsc::initialize(&world, &[])?;
/// let text = r#"
///     body.cube.block = { box = { size = [1, 1, 1] }, elements = [2, 2, 2], faces = { bottom = "zmin", top = "zmax" } }
///     body.cube.material = "rubber"
///     material.rubber = { model = "neo-hookean", young = 6.0, poisson = 0.45 }
///     tool.lid.plane = { point = [0, 0, 1], normal = [0, 0, -1] }
///     contact.top = { slave = "cube.top", master = "lid" }
///     step = [{ increments = 2, fix = [{ set = "cube.bottom" }], move = [{ target = "lid", by = [0, 0, -0.1] }] }]
/// "#;
/// let scene = scene::parse("cube", text, std::path::Path::new("."), &[])?;
/// let mut simulation = Simulation::new(&world, &petsc, &scene)?;
/// simulation.begin(&scene.steps[0])?;
/// let mut observer = |_: &Event| Ok(());
/// while let Some(increment) = simulation.advance(&mut observer)? {
///     assert!(increment.residual < 1e-9);
/// }
/// let lid = simulation.tool("lid").expect("a tool of the scene");
/// let bottom = simulation.set("cube.bottom").expect("a set of the scene");
/// assert!(lid.force.z < -0.5 && (lid.force.z + bottom.reaction.z).abs() < 1e-9);
/// # Ok::<(), nagata::error::Error>(())
/// ```
pub struct Simulation<'a> {
    pub(super) comm: &'a SimpleCommunicator,
    pub(super) petsc: &'a Petsc<'a>,
    pub(super) scene: &'a Scene,
    pub(super) model: Model,
    pub(super) state: State,
    /// Forces that count while there are none.
    pub(super) floors: Vec<f64>,
    /// The step that is under way.
    pub(super) running: Option<Running<'a>>,
    /// Steps begun so far.
    pub(super) begun: usize,
    pub(super) phases: Phases,
    pub(super) summary: Summary,
    pub(super) notices: Notices,
    /// Where factors may be kept in files.
    pub(super) scratch: Option<String>,
    /// Of the last increment, if the next must account for its energy.
    pub(super) account: Option<Account>,
    /// The run ends with so many steps.
    pub(super) steps: usize,
    /// Of the increment that could not be found, after [`Self::advance`] has failed so.
    pub(super) last_iterate: Option<Box<LastIterate>>,
}

/// What the user is told of once.
pub(super) struct Notices {
    /// A line for every contact, with its gap in the beginning.
    gaps: Vec<String>,
    /// Bodies that nothing holds, and the step in which it was told.
    pub loose: Vec<(String, usize)>,
    pub strangers: Strangers,
}

impl<'a> Simulation<'a> {
    /// Reads the meshes of a scene, makes its model, and checks it. Collective.
    ///
    /// # Errors
    /// Wrong input, with its place in the scene.
    pub fn new(comm: &'a SimpleCommunicator, petsc: &'a Petsc<'a>, scene: &'a Scene) -> Result<Self> {
        let phases = Phases::default();
        let mut model = Model::new(comm, scene, &phases)?;
        let Beginning { gaps, strangers, aside } = preflight::check(comm, scene, &mut model)?;
        let floors = Balance::floors(comm, &model, scene.solver.force_floor.as_ref().map(|floor| floor.value));
        let state = State::first(&model, floors.len());
        let summary = Summary {
            asked: Asked {
                scene: scene.name.clone(),
                accuracy: scene.solver.accuracy.key(),
                controls: scene.controls.changed().map(|(name, value, _)| (name, value)).collect(),
            },
            elements: model.part.whole.solids,
            warnings: model.warnings.clone(),
            ..Summary::default()
        };
        let mut simulation = Self {
            comm,
            petsc,
            scene,
            model,
            state,
            floors,
            running: None,
            begun: 0,
            phases,
            summary,
            notices: Notices { gaps, loose: Vec::new(), strangers },
            scratch: None,
            account: None,
            steps: scene.steps.len(),
            last_iterate: None,
        };
        simulation.look_around(&aside);
        simulation.begin_watch(&aside);
        Ok(simulation)
    }

    /// The run ends with so many steps, fewer than the scene has: what only the end shows is looked for then.
    pub fn end_after(&mut self, steps: usize) {
        self.steps = steps;
    }

    /// From the next step on factors that memory does not suffice for are kept in files of this folder, the same on all ranks.
    pub fn keep_factors_in(&mut self, folder: &Path) {
        self.scratch = folder.to_str().map(Into::into);
    }

    pub fn comm(&self) -> &'a SimpleCommunicator {
        self.comm
    }

    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// What is modelled, with what nodes and points remember of the last converged increment.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The last converged increment.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// A line for every contact, with its gap in the beginning.
    pub fn gaps(&self) -> &[String] {
        &self.notices.gaps
    }

    /// Seconds of this rank in each phase.
    pub fn phases(&self) -> &Phases {
        &self.phases
    }

    /// What it has cost so far.
    pub fn summary(&self) -> Summary {
        let search_fetches = self.model.masters.surfaces.iter().map(|s| s.fetches).sum();
        Summary { search_fetches, ..self.summary.clone() }
    }

    /// What it carries from one increment to the next. Collective.
    pub fn carried(&self) -> Carried {
        let slaves = self.model.pairs.iter().flat_map(|pair| &pair.slaves);
        let history = &self.model.history;
        let own = [slaves.clone().count(), slaves.map(Slave::bytes).sum(), history.states().len(), history.bytes()];
        let mut all = own.map(|count| count as f64);
        sum(self.comm, &mut all);
        let [slave_nodes, contact_bytes, points, history_bytes] = all.map(|count| count as u64);
        Carried { slave_nodes, contact_bytes, points, history_bytes, ..self.summary.carried }
    }

    /// Counts an evaluation of stresses.
    pub fn count_stresses(&mut self) {
        self.summary.carried.stress_fields += 1;
    }

    /// Counts an increment that was let through above the tolerance.
    pub(super) fn note_rounded(&mut self, rounded: Option<&Rounded>) {
        let Some(Rounded { of, residual, limit, lost }) = rounded else { return };
        let told = self.summary.rounded.get_or_insert_default();
        told.increments += 1;
        if (*lost, *residual) > (told.lost, told.residual) {
            let (time, increments) = (self.state.time, told.increments);
            *told =
                summary::Rounded { increments, time, of: of.clone(), residual: *residual, limit: *limit, lost: *lost };
        }
    }

    /// Adds a warning to the summary.
    pub fn warned(&mut self, warning: String) {
        self.summary.warnings.push(warning);
    }

    pub(super) fn warn(&mut self, warning: String, observer: &mut Observer) -> Result<()> {
        observer(&Event::Warning(&warning))?;
        self.warned(warning);
        Ok(())
    }

    /// All that it goes on from, on this rank.
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            state: self.state.clone(),
            progress: self.running.as_ref().map(|running| running.frame.progress.clone()),
            near: self.running.as_ref().map(|running| running.frame.dofs.near.clone()),
            memory: Memory::of(&self.model),
        }
    }

    /// Goes back to a checkpoint of this simulation, into the step that was under way then. Collective.
    ///
    /// # Errors
    /// A failing library.
    pub fn go_back(&mut self, to: &Checkpoint) -> Result<()> {
        self.state.clone_from(&to.state);
        self.account = None;
        let same_methods = self.model.pairs.iter().map(|pair| pair.rules.method).eq(to.memory.methods());
        to.memory.give(&mut self.model);
        let same =
            |running: &&mut Running| to.progress.as_ref().is_some_and(|p| p.serial == running.frame.progress.serial);
        let near = self.running.as_ref().map(|running| &running.frame.dofs.near);
        let same_equations = same_methods && !any(self.comm, near != to.near.as_ref());
        if let (Some(running), Some(progress)) = (self.running.as_mut().filter(same), &to.progress)
            && same_equations
        {
            running.frame.progress.clone_from(progress);
            return Ok(());
        }
        self.running = None;
        let Some((progress, near)) = to.progress.clone().zip(to.near.clone()) else { return Ok(()) };
        self.set_up(progress, near)
    }

    /// Where a tool is, and what it bears; `None` where there is none of the name.
    pub fn tool(&self, name: &str) -> Option<ToolReading> {
        let t = self.model.tool_named(name)?;
        let tool = &self.model.masters.tools[t];
        Some(ToolReading {
            displacement: tool.displacement(),
            force: -self.state.tool_forces[t],
            turned: tool.committed.turned_about_axle().to_degrees(),
            moment: -self.moment_on(t),
        })
    }

    /// The moment of the contact forces on a tool about the axis of its torque, or of the last one.
    pub(super) fn moment_on(&self, t: usize) -> f64 {
        let (pose, forces) = (&self.model.masters.tools[t].committed, &self.state.tool_forces);
        let moment = &forces[self.model.masters.tools.len() + t];
        pose.drive(&forces[t], moment) * pose.axle.map_or(0.0, |axle| axle.lever)
    }

    /// Mean displacement of a set of nodes, and what its supports bear; `None` where there is none of the name. Collective.
    pub fn set(&self, name: &str) -> Option<SetReading> {
        let nodes = &self.model.find_set(name)?.nodes;
        let axis = self.axis_of(name);
        let mut sums = [0.0; 8];
        for u in nodes.iter().map(|&n| self.state.u[n as usize]) {
            (0..3).for_each(|d| sums[d] += u[d]);
            sums[6] += 1.0;
        }
        // What supports a node is shared by those of its body that move with it, as in the other plane of a layer.
        let part = &self.model.part;
        let as_one = |n: usize| (part.tie[n], part.body[n]);
        let supported: HashSet<(u32, u32)> = nodes.iter().map(|&n| as_one(n as usize)).collect();
        for n in (0..part.owned).filter(|&n| supported.contains(&as_one(n))) {
            let (u, reaction) = (self.state.u[n], self.state.reactions[n]);
            (0..3).for_each(|d| sums[3 + d] += reaction[d]);
            let moment = |(point, axis): (Vec3, Vec3)| axis.dot(&(part.points[n] + u - point).cross(&reaction));
            sums[7] += axis.map_or(0.0, moment);
        }
        sum(self.comm, &mut sums);
        let displacement = Vec3::from_column_slice(&sums[..3]) / sums[6];
        Some(SetReading { displacement, reaction: Vec3::from_column_slice(&sums[3..6]), moment: sums[7] })
    }

    /// The axis about which a set turns, or did last.
    fn axis_of(&self, set: &str) -> Option<(Vec3, Vec3)> {
        match self.running.as_ref().map(|running| &running.frame.progress) {
            Some(p) => p.conditions.axis_of(set, (self.state.time - p.start) / p.step.duration),
            None => self.state.conditions.axis_of(set, 1.0),
        }
    }

    /// What the slave nodes of a contact do that this rank owns, in one pass of two; none where there is none of the name.
    pub fn contact(&self, name: &str) -> impl Iterator<Item = ContactReading> {
        let pairs = self.model.pairs.iter().filter(move |pair| pair.name == name);
        pairs.flat_map(|pair| &pair.slaves).map(|slave| {
            let n = slave.node as usize;
            let (at, now) = (self.model.part.points[n] + self.state.u[n], &slave.accepted);
            ContactReading {
                node: self.model.part.id[n],
                at,
                status: now.status,
                gap: now.projection.map(|p| p.gap),
                normal: now.projection.map(|p| p.normal),
                force: now.on_node(),
                slip: now.slip,
            }
        })
    }

    /// Refuses a step that names what there is not: steps of a scene never do.
    pub(super) fn check_names(&self, step: &Step) -> Result<()> {
        let is_tool = |name: &str| self.model.tool_named(name).is_some();
        let is_set = |name: &str| self.model.find_set(name).is_some();
        let turned = step.torques.iter().map(|t| &t.tool).find(|tool| !is_tool(&tool.value));
        let targets = step.moves.iter().map(|m| &m.target).chain(step.forces.iter().map(|f| &f.target)).chain(turned);
        let sets = step.fix.iter().map(|f| &f.set).chain(step.pressures.iter().map(|p| &p.set));
        let sets = sets.chain(step.springs.iter().map(|s| &s.set)).chain(step.dashpots.iter().map(|d| &d.set));
        let bodies = step.body_forces.iter().map(|b| &b.body).chain(step.spins.iter().map(|spin| &spin.body));
        let unknown =
            targets.filter(|t| !is_tool(&t.value) && !is_set(&t.value)).chain(sets.filter(|s| !is_set(&s.value)));
        let is_body = |name: &str| self.model.bodies.iter().any(|body| body.name == name);
        match unknown.chain(bodies.filter(|b| !is_body(&b.value))).next() {
            None => step.check(is_tool),
            Some(name) => {
                let what = format!("step `{}`: the scene has no `{}`", step.name.value, name.value);
                Err(Error::input(&name.at, what, "name a tool, or a set that the scene refers to"))
            }
        }
    }

    /// Projects every slave node where it stands, but those that are `aside` of the master: the first slip origins. Collective.
    fn look_around(&mut self, aside: &[Vec<bool>]) {
        let Model { part, masters, pairs, .. } = &mut self.model;
        let place = |n: u32| part.points[n as usize];
        masters.attend(self.comm, pairs, place);
        for (pair, aside) in pairs.iter_mut().zip(aside) {
            let ground = masters.of(pair.master);
            let find = |faces: &Faces| Segments::find(pair, &ground, || faces.as_meshed(), place, None, None);
            let segments = pair.faces.as_ref().map(find);
            let (outward, is_self) = (outward_of(part, pair, place), pair.is_self());
            for s in 0..pair.slaves.len() {
                let node = pair.slaves[s].node;
                let position = place(node);
                let projection = ground.project(pair, s, &position, (None, false)).filter(|_| !aside[s]);
                let facing = |p| ground.facing(pair, &position, &p, &outward[node as usize]).unwrap_or(p);
                let projection = projection.map(facing);
                let projection = match &segments {
                    None => projection,
                    Some(segments) => segments.meet(pair, s, projection.as_ref()).map(|(mean, _)| mean),
                };
                let even = projection.map_or(Vec::new(), |at| ground.evenly(pair, (s, &position), &at, None));
                let slave = &mut pair.slaves[s];
                slave.committed.aside = aside[s];
                slave.trial.projection = projection.map(|at| mean_of_pieces(&even, &at).unwrap_or(at));
                slave.pieces = pieces_of(&even);
                // An active set begins with what touches; nothing else may hold a body.
                slave.overlap = projection.filter(|_| !is_self).map_or(0.0, |at| (-at.gap).max(0.0));
                let touches = projection.is_some_and(|p| p.gap <= pair.controls.touching_gap * pair.facet_size);
                if touches && pair.rules.method == Enforcement::Lagrange {
                    slave.trial.status = Status::Stick;
                }
                slave.commit(pair.rules.method, Vec3::zeros(), &ground, &position, 0.0);
            }
        }
    }
}

/// Where a tool is, and what it bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolReading {
    /// Of its reference point since the beginning.
    pub displacement: Vec3,
    /// Force that it exerts on the bodies, N.
    pub force: Vec3,
    /// By how much torques have turned it about the axis of its torque, or of the last one, since there was one along it, degrees,
    /// and its moment on the bodies about that axis; 0 without one.
    pub turned: f64,
    pub moment: f64,
}

/// What a set of nodes does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetReading {
    /// Mean displacement of its nodes.
    pub displacement: Vec3,
    /// Sum of the forces that supports exert on its nodes.
    pub reaction: Vec3,
    /// Their moment about the axis about which a step turns the set, or did last; 0 without one.
    pub moment: f64,
}

/// What a slave node does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactReading {
    /// Its number in the mesh file.
    pub node: u64,
    /// Where it is.
    pub at: Vec3,
    pub status: Status,
    /// Distance to the master and the normal there, where it is in reach.
    pub gap: Option<f64>,
    pub normal: Option<Vec3>,
    /// Contact force on the node.
    pub force: Vec3,
    /// Slip in the last increment.
    pub slip: Vec3,
}
