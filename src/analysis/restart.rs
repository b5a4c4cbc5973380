//! A simulation as tables, and back from them on any number of ranks.
//!
//! Written is what nothing else tells: displacements, what points and contacts remember, poses of tools, how far the step is.
//! What the scene and these say is made anew: conditions, by beginning all steps until then again; equations, patterns, normals,
//! and what is near of masters. Nodes, elements and slave nodes have their rows by their numbers in the whole mesh.
//!
//! What has been read is then judged by the model, not by itself: forces are evaluated at it, and must be those that were
//! found there when it was written, and as much in balance.

use super::Simulation;
use super::conditions::Conditions;
use super::ladder::Tries;
use super::newton::{Evaluated, Newton, Share, Start, System, update_halo};
use super::state::State;
use super::step::{Frame, Running};
use super::touches::Touch;
use crate::Vec3;
use crate::contact::{Committed, Interference, Manner, Pair, Pose, Sight, Sights, Slave, Trial};
use crate::error::Result;
use crate::model::Model;
use crate::model::ties::Joint;
use crate::output::OutputFolder;
use crate::output::checkpoint::{self, Stored, Table};
use crate::parallel::{any, max};
use crate::partition::Order;
use crate::scene::Enforcement;
use crate::solid::history::History;
use crate::words::Words;
use mpi::topology::SimpleCommunicator;
use petsc::Problem;

/// Rows of nodes, elements, and the slave nodes of each pair and tie.
pub(super) struct Layout {
    nodes: Order,
    solids: Order,
    pairs: Vec<Order>,
    ties: Vec<Order>,
}

impl Layout {
    /// Of a model. Collective.
    pub fn new(comm: &SimpleCommunicator, model: &Model) -> Self {
        let part = &model.part;
        let slaves = |pair: &Pair| -> Vec<u64> { pair.slaves.iter().map(|s| part.number[s.node as usize]).collect() };
        let tied = |joint: &Joint| -> Vec<u64> { joint.slaves.iter().map(|s| part.number[s.node as usize]).collect() };
        Self {
            nodes: Order::new(comm, &part.number[..part.owned]),
            solids: Order::new(comm, &part.solids.iter().map(|solid| solid.number).collect::<Vec<_>>()),
            pairs: model.pairs.iter().map(|pair| Order::new(comm, &slaves(pair))).collect(),
            ties: model.joints.iter().map(|joint| Order::new(comm, &tied(joint))).collect(),
        }
    }
}

/// What is the same on all ranks.
#[derive(Clone, Debug)]
struct Common {
    /// Of the scene, from 0.
    step: usize,
    time: f64,
    increments: usize,
    seen: Vec<f64>,
    /// The largest residual as it is [found](Simulation::anew).
    residual: f64,
    tools: OfTools,
    touches: Vec<Touch>,
    handed: Vec<Vec<Vec3>>,
    /// Of the step: as in [`super::state::Progress`].
    start: f64,
    course: [f64; 5],
    tries: Tries,
    /// Fractions of the step of the past unknowns, and those of the tools.
    past: Vec<(f64, Vec<Vec3>)>,
    pairs: Vec<OfPair>,
    /// The most states of an element, and whether any has enhanced strain.
    points: (usize, bool),
}

crate::words!(Common {
    step,
    time,
    increments,
    seen,
    residual,
    tools,
    touches,
    handed,
    start,
    course,
    tries,
    past,
    pairs,
    points,
});

/// Of the tools.
#[derive(Clone, Debug)]
struct OfTools {
    /// Contact forces and moments at the last converged increment, and as they are [found](Simulation::anew).
    forces: Vec<Vec3>,
    found: Vec<Vec3>,
    /// At the last converged increment, and as the step began: as in [`super::state::Progress`].
    poses: Vec<Pose>,
    start_poses: Vec<Pose>,
    offsets: Vec<Vec3>,
}

crate::words!(OfTools { forces, found, poses, start_poses, offsets });

/// What a run has changed of a pair's rules.
#[derive(Clone, Copy, Debug)]
struct OfPair {
    /// Its multipliers are held though the scene says otherwise.
    held: bool,
    /// See [`crate::contact::Rules::eased`].
    eased: f64,
    /// Its overlap is pushed out over the first step.
    ramped: bool,
}

crate::words!(OfPair { held, eased, ramped });

/// What a slave node remembers.
#[derive(Clone, Copy, Debug, Default)]
struct OfSlave {
    committed: Committed,
    accepted: Trial,
    sight: Sight,
    /// In self-contact.
    deep: Option<f64>,
    /// It has equations.
    near: bool,
}

crate::words!(OfSlave { committed, accepted, sight, deep, near });

/// The same with its past multipliers.
type Remembered = (OfSlave, Vec<Vec3>);

/// Vectors of a node: its displacement, the force on it, its displacement at the start of the step, what dashpots bear, and the
/// force as it is [found](Simulation::anew).
const OF_NODE: usize = 5;

/// Forces on owned nodes and tools, and the largest residual over what it counts against, as they are found at the last
/// converged state when it is evaluated anew. The last increment ended with nearly these: friction that gives way does so in
/// each anew, and where plastic flow by Hill's criterion was not coaxial with the strain, the axes have turned by that.
struct Found {
    nodes: Vec<Vec3>,
    tools: Vec<Vec3>,
    residual: f64,
}

impl<'a> Simulation<'a> {
    /// Writes a checkpoint in a step that is under way; of its own the driver adds `texts`, and numbers that are the same on
    /// all ranks. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, on all ranks.
    pub(super) fn save(
        &mut self,
        folder: &OutputFolder,
        layout: &Layout,
        own: &impl Words,
        texts: &[(&str, &str)],
    ) -> Result<()> {
        let of = |newton: &Newton| {
            let Evaluated { forces, tool_forces, balance, .. } = &newton.found;
            Found { nodes: forces.clone(), tools: tool_forces.clone(), residual: balance.relative() }
        };
        let Some((found, _)) = self.anew(of) else { return Ok(()) };
        let Some(running) = &self.running else { return Ok(()) };
        let points = self.points();
        let mut words = self.common(running, &found, points).to_words();
        own.put(&mut words);
        let mut tables = vec![self.nodes(running, &found, &layout.nodes), self.solids(points, &layout.solids)];
        tables.extend((0..self.model.pairs.len()).map(|p| self.slaves(running, p, &layout.pairs[p])));
        tables.extend((0..self.model.joints.len()).map(|t| self.tied(running, t, &layout.ties[t])));
        checkpoint::write(folder, self.comm, texts, &words, &tables)
    }

    /// The most states of an element on all ranks, and whether any has enhanced strain. Collective.
    fn points(&self) -> (usize, bool) {
        let (most, enhanced) = self.model.history.most();
        let mut all = [most as f64, f64::from(enhanced)];
        max(self.comm, &mut all);
        (all[0] as usize, all[1] > 0.0)
    }

    fn common(&self, running: &Running, found: &Found, points: (usize, bool)) -> Common {
        let (state, progress) = (&self.state, &running.frame.progress);
        let dofs = &running.frame.dofs;
        let of_tools = |x: &[f64]| dofs.tool.iter().map(|e| unknowns(e, |e| dofs.local(e), x)).collect();
        let of_pair = |Pair { rules, .. }: &Pair| OfPair {
            held: rules.method != rules.asked.0,
            eased: rules.eased,
            ramped: rules.interference == Interference::Ramped,
        };
        Common {
            step: self.begun - 1,
            time: state.time,
            increments: state.increments,
            seen: state.seen.clone(),
            residual: found.residual,
            tools: OfTools {
                forces: state.tool_forces.clone(),
                found: found.tools.clone(),
                poses: self.model.masters.tools.iter().map(|tool| tool.committed).collect(),
                start_poses: progress.poses.clone(),
                offsets: progress.offsets.clone(),
            },
            touches: state.touches.clone(),
            handed: state.handed.clone(),
            start: progress.start,
            course: progress.increments.course(),
            tries: progress.ladder.tries(),
            past: progress.past.iter().map(|(fraction, x)| (*fraction, of_tools(x))).collect(),
            pairs: self.model.pairs.iter().map(of_pair).collect(),
            points,
        }
    }

    fn nodes<'l>(&self, running: &Running, found: &Found, order: &'l Order) -> Table<'l> {
        let (progress, dofs) = (&running.frame.progress, &running.frame.dofs);
        let mut rows = Vec::new();
        for n in 0..self.model.part.owned {
            let State { u, reactions, damped, .. } = &self.state;
            [u[n], reactions[n], progress.before[n], damped[n], found.nodes[n]].put(&mut rows);
            let past = progress.past.iter().map(|(_, x)| unknowns(&dofs.node[n], |e| dofs.local(e), x));
            past.for_each(|past| past.put(&mut rows));
        }
        Table { name: "nodes".into(), order, width: 3 * (OF_NODE + progress.past.len()), rows }
    }

    fn solids<'l>(&self, points: (usize, bool), order: &'l Order) -> Table<'l> {
        let mut rows = Vec::new();
        (0..self.model.part.solids.len()).for_each(|e| self.model.history.put(e, points, &mut rows));
        Table { name: "elements".into(), order, width: width_of_solid(points), rows }
    }

    fn slaves<'l>(&self, running: &Running, p: usize, order: &'l Order) -> Table<'l> {
        let (pair, frame) = (&self.model.pairs[p], &running.frame);
        let mut rows = Vec::new();
        for (s, slave) in pair.slaves.iter().enumerate() {
            let Slave { committed, accepted, sights: Sights { accepted: sight, .. }, .. } = *slave;
            let deep = pair.avoided(s).map(|avoided| avoided.deep());
            OfSlave { committed, accepted, sight, deep, near: frame.dofs.near[p][s] }.put(&mut rows);
            let equations = &frame.dofs.multiplier[p][s];
            let past = frame.progress.past.iter().map(|(_, x)| unknowns(equations, |e| frame.dofs.local(e), x));
            past.for_each(|past| past.put(&mut rows));
        }
        Table { name: name_of_pair(p), order, width: width_of_slave() + 3 * frame.progress.past.len(), rows }
    }

    fn tied<'l>(&self, running: &Running, t: usize, order: &'l Order) -> Table<'l> {
        let (joint, Frame { dofs, progress, .. }) = (&self.model.joints[t], &running.frame);
        let mut rows = Vec::new();
        for (slave, equations) in joint.slaves.iter().zip(&dofs.tie[t]) {
            slave.force.put(&mut rows);
            let past = progress.past.iter().map(|(_, x)| unknowns(equations, |e| dofs.local(e), x));
            past.for_each(|past| past.put(&mut rows));
        }
        Table { name: name_of_tie(t), order, width: 3 * (1 + progress.past.len()), rows }
    }

    /// Goes to a checkpoint of a run of the same scene, into the step that was under way; gives what the driver had added.
    /// Collective.
    ///
    /// # Errors
    /// A checkpoint of something else, or one at which forces are not as they were, on all ranks.
    pub(super) fn restore<T: Words>(&mut self, stored: &Stored, layout: &Layout) -> Result<T> {
        let words = stored.words(self.comm)?;
        let mut words = &words[..];
        let common = Common::take(&mut words);
        let own = T::take(&mut words);
        let Some(steps) = self.scene.steps.get(..=common.step) else {
            return Err(stored.refused("the scene has fewer steps than it was in"));
        };
        let past = common.past.len();
        let nodes = stored.table(self.comm, "nodes", &layout.nodes, 3 * (OF_NODE + past))?;
        let nodes = Rows { words: nodes, width: 3 * (OF_NODE + past) };
        let before = self.vectors(&nodes, 2);
        self.state = State {
            time: common.time,
            increments: common.increments,
            u: self.vectors(&nodes, 0),
            reactions: (0..self.model.part.owned).map(|n| nodes.vector(n, 1)).collect(),
            damped: (0..self.model.part.owned).map(|n| nodes.vector(n, 3)).collect(),
            tool_forces: common.tools.forces,
            seen: common.seen.clone(),
            touches: common.touches.clone(),
            strays: Vec::new(),
            conditions: Conditions::none(&self.model),
            handed: common.handed.clone(),
        };
        self.restore_solids(stored, layout, common.points)?;
        for (pair, OfPair { held, eased, ramped }) in self.model.pairs.iter_mut().zip(common.pairs) {
            if held || eased < 1.0 {
                pair.rules.eased = eased;
                pair.enforce(Enforcement::Uzawa);
            }
            if ramped {
                pair.rules.interference = Interference::Ramped;
            }
        }
        let pairs = self.restore_slaves(stored, layout, past)?;
        let ties = self.restore_ties(stored, layout, past)?;
        for (tool, pose) in self.model.masters.tools.iter_mut().zip(&common.tools.poses) {
            (tool.committed, tool.trial) = (*pose, *pose);
        }
        self.model.turn_slaves(&self.state.u);
        self.begin_strays();
        // Only of the last step do they depend on where nodes were.
        let mut last = Conditions::none(&self.model);
        for (step, forces) in steps.iter().zip(&common.handed) {
            let conditions = self.conditions(step, &before, &last, (forces, &common.tools.start_poses))?;
            self.state.conditions = std::mem::replace(&mut last, conditions);
        }
        self.begun = common.step;
        let mut progress = self.progress(&steps[common.step], last);
        progress.increments.go_on(common.course);
        progress.ladder.go_on(common.tries);
        (progress.start, progress.before, progress.poses, progress.offsets) =
            (common.start, before, common.tools.start_poses, common.tools.offsets);
        let near = pairs.iter().map(|rows| rows.iter().map(|(slave, _)| slave.near).collect()).collect();
        self.set_up(progress, near)?;
        self.restore_past(&common.past, &nodes, (&pairs, &ties));
        let nodes = (0..self.model.part.owned).map(|n| nodes.vector(n, 4)).collect();
        match self.departs(&Found { nodes, tools: common.tools.found, residual: common.residual }) {
            None => Ok(own),
            Some(what) => Err(stored.refused(&what)),
        }
    }

    /// A vector of each local node. Collective.
    fn vectors(&self, nodes: &Rows, k: usize) -> Vec<Vec3> {
        let part = &self.model.part;
        let of = |n: usize| if n < part.owned { nodes.vector(n, k) } else { Vec3::zeros() };
        let mut values: Vec<Vec3> = (0..part.points.len()).map(of).collect();
        update_halo(&self.model, self.comm, &mut values);
        values
    }

    fn restore_solids(&mut self, stored: &Stored, layout: &Layout, points: (usize, bool)) -> Result<()> {
        if points != self.points() {
            return Err(stored.refused("its elements remember other things"));
        }
        let width = width_of_solid(points);
        let rows = Rows { words: stored.table(self.comm, "elements", &layout.solids, width)?, width };
        for e in 0..self.model.part.solids.len() {
            self.model.history.take(e, points, &mut rows.of(e));
        }
        Ok(())
    }

    /// What the slave nodes of each pair remember, with their past multipliers.
    fn restore_slaves(&mut self, stored: &Stored, layout: &Layout, past: usize) -> Result<Vec<Vec<Remembered>>> {
        let mut pairs = Vec::new();
        for (p, pair) in self.model.pairs.iter_mut().enumerate() {
            let width = width_of_slave() + 3 * past;
            let rows = Rows { words: stored.table(self.comm, &name_of_pair(p), &layout.pairs[p], width)?, width };
            let mut of_pair = Vec::new();
            for (s, slave) in pair.slaves.iter_mut().enumerate() {
                let mut words = rows.of(s);
                let of = OfSlave::take(&mut words);
                (slave.committed, slave.sights.accepted) = (of.committed, of.sight);
                (slave.accepted, slave.trial) = (of.accepted, of.accepted);
                if let Some((deep, avoided)) =
                    of.deep.zip(pair.within.as_mut().and_then(|within| within.avoided.get_mut(s)))
                {
                    avoided.remember(deep);
                }
                of_pair.push((of, (0..past).map(|_| Vec3::take(&mut words)).collect()));
            }
            pairs.push(of_pair);
        }
        Ok(pairs)
    }

    /// The forces of ties, and their rows.
    fn restore_ties(&mut self, stored: &Stored, layout: &Layout, past: usize) -> Result<Vec<Rows>> {
        let mut ties = Vec::new();
        for (t, joint) in self.model.joints.iter_mut().enumerate() {
            let width = 3 * (1 + past);
            let rows = Rows { words: stored.table(self.comm, &name_of_tie(t), &layout.ties[t], width)?, width };
            joint.slaves.iter_mut().enumerate().for_each(|(s, slave)| slave.force = rows.vector(s, 0));
            ties.push(rows);
        }
        Ok(ties)
    }

    /// The past unknowns of the step, in its numbering.
    fn restore_past(&mut self, tools: &[(f64, Vec<Vec3>)], nodes: &Rows, (pairs, ties): (&[Vec<Remembered>], &[Rows])) {
        let Some(Running { frame, .. }) = &mut self.running else { return };
        let dofs = &frame.dofs;
        for (k, (fraction, of_tools)) in tools.iter().enumerate() {
            let mut x = vec![0.0; dofs.count];
            let mut set = |equations: &[i64; 3], value: Vec3| {
                for d in 0..3 {
                    if let Some(row) = dofs.local(equations[d]) {
                        x[row] = value[d];
                    }
                }
            };
            (0..self.model.part.owned).for_each(|n| set(&dofs.node[n], nodes.vector(n, OF_NODE + k)));
            for (equations, rows) in dofs.multiplier.iter().zip(pairs) {
                equations.iter().zip(rows).for_each(|(equations, (_, past))| set(equations, past[k]));
            }
            for (equations, rows) in dofs.tie.iter().zip(ties) {
                equations.iter().enumerate().for_each(|(s, equations)| set(equations, rows.vector(s, 1 + k)));
            }
            dofs.tool.iter().zip(of_tools).for_each(|(equations, value)| set(equations, *value));
            frame.progress.past.push((*fraction, x));
        }
    }

    /// Why this state is not that which was written, by forces that are evaluated anew. Collective.
    fn departs(&mut self, then: &Found) -> Option<String> {
        /// Of the forces of a body, contact or tool; and of what was let through as a residual, where rounding leaves more.
        const APART: f64 = 1e-8;
        const MORE: f64 = 10.0;
        let comm = self.comm;
        let ((off, [residual, limit]), broken) = self.anew(|newton| {
            let mut off = [apart(newton, then)];
            max(comm, &mut off);
            (off[0], [newton.found.balance.relative(), newton.limit()])
        })?;
        let allowed = APART.max(MORE * limit);
        let begun = self.running.as_ref().is_some_and(|running| running.frame.progress.increments.done > 0.0);
        let is_off = |x: f64| x.is_nan() || x > allowed;
        if broken {
            Some("an element is turned inside out at it".into())
        } else if is_off(off) {
            Some(format!("forces at it differ from those that it had by {off:.1e} of them"))
        } else if begun && is_off(residual - then.residual) {
            Some(format!("forces at it are out of balance by {residual:.1e} of them"))
        } else {
            None
        }
    }

    /// Evaluates forces anew at the last converged state of the step under way, which stays as it is, and looks at them; says,
    /// too, whether an element is turned inside out. Collective.
    fn anew<T>(&mut self, look: impl FnOnce(&Newton) -> T) -> Option<(T, bool)> {
        let mut running = self.running.take()?;
        let frame = &mut running.frame;
        let slaves: Vec<Vec<Slave>> = self.model.pairs.iter().map(|pair| pair.slaves.clone()).collect();
        let poses: Vec<Pose> = self.model.masters.tools.iter().map(|tool| tool.trial).collect();
        let done = frame.progress.increments.done;
        self.watch_ahead(frame, done);
        let start = Start {
            offsets: &frame.progress.offsets,
            s: done,
            share: Share { begin: done, ..Share::ALL },
            tolerance: self.scene.solver.tolerance,
            strict: false,
            // Steep penalties, with which it may not have been found, make much of the rounding of gaps.
            manner: Manner { automatic: true, ..Manner::default() },
            max_iterations: 1,
            seen: &self.state.seen,
            floors: &self.floors,
            least: 0.0,
        };
        let system = System {
            comm: self.comm,
            model: &mut self.model,
            dofs: &mut frame.dofs,
            pattern: &mut frame.pattern,
            conditions: &frame.progress.conditions,
            phases: &self.phases,
            start_poses: &frame.progress.poses,
            committed: &self.state.u,
            damped: &self.state.damped,
        };
        let mut watcher = |_: usize, _: f64, _: [usize; 2]| Ok(());
        let mut newton = Newton::new(system, (&start, &mut watcher));
        let mut here = vec![0.0; newton.system.dofs.count];
        newton.start_behind(&mut here);
        let (mut x, mut r) = (here.clone(), vec![0.0; here.len()]);
        newton.start_ahead(&here, &mut x);
        newton.allow_overlaps();
        let uzawa = newton.system.model.pairs.iter_mut().filter(|pair| pair.rules.method == Enforcement::Uzawa);
        uzawa.flat_map(|pair| &mut pair.slaves).for_each(Slave::hand_back);
        let broken = !matches!(newton.residual(&x, &mut r), Ok(petsc::Evaluation::Done));
        let broken = any(self.comm, broken);
        let seen = look(&newton);
        for (pair, slaves) in self.model.pairs.iter_mut().zip(slaves) {
            pair.slaves = slaves;
        }
        self.model.masters.tools.iter_mut().zip(poses).for_each(|(tool, pose)| tool.trial = pose);
        self.running = Some(running);
        Some((seen, broken))
    }
}

/// How far forces on nodes and tools are from those of then, over those of their body, or of the contacts of the tool: only one
/// that a force drives has a scale of its own.
fn apart(newton: &Newton, then: &Found) -> f64 {
    let (model, balance) = (&newton.system.model, &newton.found.balance);
    let (pairs, first) = (model.sections.len(), model.sections.len() + model.pairs.len());
    let [new, old] = [&newton.found.tool_forces, &then.tools];
    let tools = model.masters.tools.len();
    let node =
        |n: usize| (newton.found.forces[n] - then.nodes[n]).amax() / balance.scale(model.part.section[n] as usize);
    let scale = |t: usize, group: usize| {
        let of_tool = model.pairs.iter().enumerate().filter(|(_, pair)| pair.master.tool() == Some(t));
        of_tool.map(|(p, _)| balance.scale(pairs + p)).fold(balance.scale(group), f64::max)
    };
    let tool = |t: usize| (new[t] - old[t]).amax() / scale(t, first + t);
    let turning = |t: usize| {
        let drive = |forces: &[Vec3]| model.masters.tools[t].trial.drive(&forces[t], &forces[tools + t]);
        (drive(new) - drive(old)).abs() / scale(t, first + tools + t)
    };
    let all = (0..model.part.owned).map(node).chain((0..tools).map(tool)).chain((0..tools).map(turning));
    all.fold(0.0, |most, off| if off.is_nan() { f64::INFINITY } else { most.max(off) })
}

/// Rows of a table.
struct Rows {
    words: Vec<f64>,
    width: usize,
}

impl Rows {
    fn of(&self, row: usize) -> &[f64] {
        &self.words[row * self.width..(row + 1) * self.width]
    }

    /// The k-th of the vectors of a row.
    fn vector(&self, row: usize, k: usize) -> Vec3 {
        Vec3::from_column_slice(&self.of(row)[3 * k..3 * k + 3])
    }
}

/// The unknowns of three equations; zero where this rank has none.
fn unknowns(equations: &[i64; 3], local: impl Fn(i64) -> Option<usize>, x: &[f64]) -> Vec3 {
    Vec3::from_fn(|d, _| local(equations[d]).map_or(0.0, |k| x[k]))
}

fn name_of_pair(p: usize) -> String {
    format!("contact {p}")
}

fn name_of_tie(t: usize) -> String {
    format!("tie {t}")
}

fn width_of_slave() -> usize {
    OfSlave::default().to_words().len()
}

fn width_of_solid(points: (usize, bool)) -> usize {
    let mut words = Vec::new();
    History::new([points]).put(0, points, &mut words);
    words.len()
}
