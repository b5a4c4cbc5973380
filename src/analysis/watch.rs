//! The watch over increments: whether a converged one may become the state.
//!
//! What a node may do is in [`crate::contact::watch`]; here all nodes of all ranks are looked at, with a reach that follows
//! from how far they and the masters have moved.

use super::Simulation;
use super::astride::astride;
use super::between::{Between, between, too_deep};
use super::conditions::Conditions;
use super::hooked::hooked;
use super::intruders::{Suspect, intruders};
use super::seams::in_seam;
use super::step::{Attempt, Converged};
use super::strays::{beyond, stray, strays};
use super::touches::{LACKS, Touch};
use crate::Vec3;
use crate::contact::watch::{self, Allowance, Finding, View};
use crate::contact::{Ground, Movement, Pair, Sight, Slave, Status};
use crate::failure::Cause;
use crate::model::Model;
use crate::output::phases::Phase;
use crate::parallel::{first_word, max, word_of_largest};
use crate::scene::Enforcement;
use crate::system::dofs::node_name;
use mpi::topology::SimpleCommunicator;
use std::time::Instant;

/// Where all is at an increment's beginning and end.
struct Motion<'a> {
    before: &'a [Vec3],
    after: &'a [Vec3],
    /// Residual that is let through at each contact, N.
    residuals: &'a [f64],
    /// At the end of a step what contacts did before, and whether it is the last one.
    ended: Option<(&'a [Touch], bool)>,
    /// Of which pairs no slave node of any rank is in contact.
    idle: &'a [bool],
}

impl Simulation<'_> {
    /// The first look, before anything moves, with slave nodes of each pair that are `aside` of its master. Collective.
    pub(super) fn begin_watch(&mut self, aside: &[Vec<bool>]) {
        let still = self.state.u.clone();
        let motion = Motion { before: &still, after: &still, residuals: &[], ended: None, idle: &[] };
        let travels = look_out(self.comm, &mut self.model, &motion);
        let Model { part, masters, pairs, .. } = &mut self.model;
        for ((pair, travel), aside) in pairs.iter_mut().zip(travels).zip(aside) {
            let ground = masters.of(pair.master);
            let first = |s: usize| {
                let x = part.points[pair.slaves[s].node as usize];
                let may = Allowance { aside: aside[s], ..allowance(pair, 0.0, travel) };
                watch::first_sight(&View { ground, pair, slave: s }, &x, &may)
            };
            let sights: Vec<Sight> = (0..pair.slaves.len()).map(first).collect();
            pair.slaves.iter_mut().zip(sights).for_each(|(slave, sight)| slave.sights.accepted = sight);
        }
        self.state.touches = vec![Touch::default(); self.model.pairs.len()];
        self.begin_strays();
    }

    /// Looks at what no contact names, where it is now. Collective.
    pub(super) fn begin_strays(&mut self) {
        self.state.strays = strays(self.comm, &mut self.model, &self.state.u);
    }

    /// The attempt as it is, or failed, where a node went through the master or is behind it. Collective.
    pub(super) fn watched(&mut self, attempt: Attempt, conditions: &Conditions) -> Attempt {
        let Attempt::Converged(mut converged) = attempt else { return attempt };
        let begun = Instant::now();
        let reason = match self.model.is_alone() {
            true => None,
            false => self.finding(&mut converged, conditions),
        };
        let reason = reason.or_else(|| beyond(self.comm, &self.model, &converged.u));
        self.phases.add(Phase::Watch, begun.elapsed());
        match reason {
            None => Attempt::Converged(converged),
            Some(reason) => Attempt::Failed(converged.refused(&self.model, Cause::Watch, reason)),
        }
    }

    /// The worst that some node did, in words. Collective.
    fn finding(&mut self, converged: &mut Converged, conditions: &Conditions) -> Option<String> {
        let ends_step = converged.end >= 1.0;
        let ends_run = self.begun >= self.steps;
        let ended = ends_step.then_some((&self.state.touches[..], ends_run));
        let idle = &idle(self.comm, &self.model.pairs, |slave| slave.trial.status)[..];
        let motion = Motion { before: &self.state.u, after: &converged.u, residuals: &converged.limits, ended, idle };
        let travels = look_out(self.comm, &mut self.model, &motion);
        let mut told: Option<(usize, usize, Finding)> = None;
        for (p, travel) in travels.iter().enumerate() {
            let sights = judge_pair(self.comm, &self.model, p, *travel, &motion);
            for (s, (sight, finding)) in sights.into_iter().enumerate() {
                self.model.pairs[p].slaves[s].sights.judged = sight;
                let worst = told.map_or(0.0, |(_, _, worst)| worst.size());
                told = finding.filter(|finding| finding.size() > worst).map(|finding| (p, s, finding)).or(told);
            }
        }
        let within = intruders(self.comm, &self.model, [&self.state.u, &converged.u], conditions);
        converged.between = between(self.comm, &self.model, (&travels, idle), &converged.u);
        if ends_step {
            self.recall_unfelt(idle, &mut converged.between);
        }
        let cut = astride(self.comm, &self.model, &travels, &converged.u);
        let (hooked, aside) = hooked(self.comm, &self.model, &converged.u, &converged.limits);
        converged.aside = aside;
        told = told
            .or_else(|| too_deep(&self.model, &converged.between).map(|(p, finding)| (p, 0, finding)))
            .or(cut)
            .or(hooked);
        told = told.or_else(|| self.undetermined(conditions)).or_else(|| in_seam(&self.model, &converged.u));
        let told = told.map(|told| (told, told.2.size()));
        let word = word_of_largest(self.comm, told, |(p, s, finding)| self.word(p, s, finding, &converged.between[p]));
        if let Some((word, _)) = word {
            return Some(word);
        }
        let word = first_word(self.comm, within.first().map(|intruder| self.word_within(*intruder)));
        if word.is_some() {
            return word;
        }
        let (strays, word) = stray(self.comm, &mut self.model, &self.state.strays, [&self.state.u, &converged.u]);
        converged.strays = strays;
        word
    }

    /// Where no node has ever touched a master that is between nodes, or was on its way, by more than is told of, the force is
    /// missing as a whole: that ends the step, however little it is.
    fn recall_unfelt(&self, idle: &[bool], between: &mut [Between]) {
        let pairs = self.model.pairs.iter().zip(&self.state.touches);
        for (((pair, touch), is_idle), between) in pairs.zip(idle).zip(between) {
            let deepest = between.or_deeper(touch.between);
            if *is_idle && touch.last.until.is_none() && deepest.share > pair.controls.watch_between {
                *between = Between { share: f64::INFINITY, ..deepest };
            }
        }
    }

    /// A slave node that is prescribed along the normal of a tool that a torque turns: neither can give way.
    fn undetermined(&self, conditions: &Conditions) -> Option<(usize, usize, Finding)> {
        const ACROSS: f64 = 1e-6;
        let turned = |pair: &Pair| pair.master.tool().is_some_and(|t| conditions.motions[t].axle.is_some());
        let pair_of = |p: usize| &self.model.pairs[p];
        let pairs = self.model.pairs.iter().enumerate().filter(|(_, pair)| turned(pair));
        let mut touching =
            pairs.flat_map(|(p, pair)| pair.slaves.iter().enumerate().map(move |(s, slave)| (p, s, slave)));
        touching.find_map(|(p, s, slave)| {
            let at = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap)?;
            let Movement { axes, ways } = conditions.movement(slave.node);
            let driven = pair_of(p).master.tool().map_or([false; 3], |t| conditions.motions[t].free);
            let gives_way = |d: usize| {
                ways[d].is_nan() && axes.column(d).dot(&at.normal).abs() > ACROSS
                    || driven[d] && at.normal[d].abs() > ACROSS
            };
            (!(0..3).any(gives_way)).then(|| (p, s, Finding::Undetermined(slave.trial.force.norm())))
        })
    }

    fn word(&self, p: usize, s: usize, finding: Finding, between: &Between) -> String {
        let pair = &self.model.pairs[p];
        let master = self.model.master_name(pair);
        let did = match finding {
            Finding::Behind(depth) => format!("is {depth:.3e} deep in {master}"),
            Finding::Through(_) => format!("went through {master}"),
            Finding::Lost(way) => {
                format!("went {way:.3e} along {master} in one increment, too far to see what it went through")
            }
            Finding::Apart(away) => format!(
                "has slid {away:.3e} from the node of {master} that it meets, and another one is nearer: \"node-to-node\" is for \
                 small sliding, take another `discretization`"
            ),
            Finding::Unfelt(depth) => format!(
                "is {depth:.3e} deep in {master}, but no gap is closed in the mean over the facets around a node, so that \
                 nothing resists: facets of the slave that are finer there, or `discretization = \"one-pass\"`, feel it"
            ),
            Finding::Undetermined(_) => {
                format!(
                    "cannot give way to {master}, which a torque turns, so that what it bears is undetermined: free it along \
                     the normal, or turn the tool by `rotate`"
                )
            }
            Finding::Pushed(force) => {
                format!("is pushed along its way over {master} by friction, with {force:.3e} N")
            }
            Finding::InSeam(force) => format!(
                "is held by a side of {master} that lies on another master, with {force:.3e} N: it is in the seam between both, \
                 where no surface can be; smaller increments may lead it over, and so do one tool of both, or masters without \
                 the sides that lie on each other"
            ),
            Finding::Astride(depth, at) => format!(
                "is {depth:.3e} behind {master}, which it came round an end of, and the node next to it is in front: at \
                 ({:.6}, {:.6}, {:.6}) {master} cuts the body between them, farther from all its ends than the facet there is \
                 long; extend its surface or close its holes, refine the slave there, or take `discretization = \"segment\"`",
                at.x, at.y, at.z
            ),
            Finding::Hooked(force, share) => format!(
                "is held by a side of {master} that it does not look at, beside a sharp edge, with {force:.3e} N; such nodes bear {:.0} % of \
                 the contact's force, which is that of single nodes and of no surface: round the edge off by a fillet of two facets, or take \
                 `discretization = \"segment\"`",
                100.0 * share
            ),
            Finding::Between(_) => return between.word(&self.model, pair),
        };
        format!("node {} {did} (contact `{}`)", node_name(&self.model, pair.slaves[s].node), pair.name)
    }

    /// A node inside the body of the master of a pair, in words.
    fn word_within(&self, (p, n): Suspect) -> String {
        let pair = &self.model.pairs[p];
        let body = pair.master_body().map_or("", |body| &self.model.bodies[body].name);
        format!(
            "node {} is inside body `{body}`, which it entered where no contact names a face, beside {} (contact `{}`)",
            node_name(&self.model, n),
            self.model.master_name(pair),
            pair.name
        )
    }
}

/// Lets each rank see its tools and deformable masters as they are, as far as the watch needs. Gives for each pair how far its
/// nodes have gone against the master, at most. Collective.
fn look_out(comm: &SimpleCommunicator, model: &mut Model, motion: &Motion) -> Vec<f64> {
    let Model { part, masters, pairs, controls, .. } = model;
    let before = |n: u32| part.points[n as usize] + motion.before[n as usize];
    let after = |n: u32| part.points[n as usize] + motion.after[n as usize];
    let travels: Vec<f64> =
        pairs.iter().map(|pair| masters.travel(comm, pair, controls.watch_turn, before, after)).collect();
    masters.look_out(comm, pairs, |p| reach(&pairs[p], travels[p]), after);
    travels
}

/// Lets masters see what is around slave nodes, after they looked elsewhere. Collective.
pub(super) fn attend(comm: &SimpleCommunicator, model: &mut Model, u: &[Vec3]) {
    let Model { part, masters, pairs, .. } = model;
    masters.attend(comm, pairs, |n| part.points[n as usize] + u[n as usize]);
}

/// How far to look around nodes that have gone so far.
pub(super) fn reach(pair: &Pair, travel: f64) -> f64 {
    let around = if pair.is_self() { pair.controls.watch_around_self } else { pair.controls.watch_around };
    around * pair.facet_size + pair.controls.watch_farther * travel
}

pub(super) fn allowance(pair: &Pair, explained: f64, travel: f64) -> Allowance<'_> {
    let in_the_mean = pair.faces.as_ref().map_or(0.0, |_| pair.controls.watch_segment * pair.facet_size);
    let explained = explained + in_the_mean;
    Allowance {
        facet: pair.facet_size,
        explained,
        travel,
        reach: reach(pair, travel),
        aside: false,
        controls: &pair.controls,
    }
}

/// Of which pairs no slave node of any rank is in contact. Collective.
pub(super) fn idle(comm: &SimpleCommunicator, pairs: &[Pair], status: fn(&Slave) -> Status) -> Vec<bool> {
    let acts = |pair: &Pair| pair.slaves.iter().any(|slave| status(slave) != Status::Gap);
    let mut acting: Vec<f64> = pairs.iter().map(|pair| f64::from(acts(pair))).collect();
    max(comm, &mut acting);
    acting.iter().map(|acts| *acts == 0.0).collect()
}

/// Depth from which a node is in the master without being felt, at the end of a step: gaps closed in the mean over facets say
/// nothing where none is closed. What touched before may have been eased to no force, so that it counts by what it bore; and a step that
/// is not the last one may bring a master as near as that.
fn unfelt_from<'a>(pair: &'a Pair, touch: &'a Touch, ends_run: bool) -> Option<impl Fn(&Slave) -> f64 + 'a> {
    let is_eased = touch.last.until.is_some() || !ends_run;
    let share = if is_eased { pair.controls.watch_deep } else { pair.controls.watch_unfelt };
    let borne = LACKS * touch.most;
    let from = move |slave: &Slave| (share * pair.facet_size).max(borne / slave.stiffness(&pair.controls));
    (pair.faces.is_some() && !pair.is_self()).then_some(from)
}

/// Judges the slave nodes of a pair, of which none has gone farther than `travel`. Collective.
fn judge_pair(
    comm: &SimpleCommunicator,
    model: &Model,
    p: usize,
    travel: f64,
    motion: &Motion,
) -> Vec<(Sight, Option<Finding>)> {
    let (part, pair) = (&model.part, &model.pairs[p]);
    let place = |u: &[Vec3], n: u32| part.points[n as usize] + u[n as usize];
    let ground = model.masters.of(pair.master);
    let past = ground.past(comm, model.controls.watch_turn, |n| place(motion.before, n));
    let unfelt =
        motion.ended.filter(|_| motion.idle[p]).and_then(|(touches, last)| unfelt_from(pair, &touches[p], last));
    // At a corner that another contact with the master shares, that one may feel it.
    let is_shared = |node: u32| {
        let is_of = |other: &Pair| {
            other.master == pair.master || other.master_body().is_some() && other.master_body() == pair.master_body()
        };
        let others = model.pairs.iter().zip(motion.idle);
        others.filter(|(other, idle)| !**idle && is_of(other)).any(|(other, _)| other.index_of(node).is_some())
    };
    let judge = |s: usize| {
        let slave = &pair.slaves[s];
        let [from, to] = [motion.before, motion.after].map(|u| place(u, slave.node));
        let explained = explained(model, pair, s, motion.residuals[p]);
        let may = Allowance { aside: slave.committed.aside, ..allowance(pair, explained, travel) };
        let (sight, finding) =
            watch::judge(&View { ground, pair, slave: s }, &slave.sights.accepted, &past, [&from, &to], &may);
        let apart = apart(&ground, slave, slave.trial.status, &to)
            .filter(|apart| *apart > pair.controls.watch_mates * pair.facet_size);
        let finding = finding.or(apart.map(Finding::Apart));
        let finding = finding.or_else(|| pushed(&ground, pair, s, [&from, &to], motion.residuals[p]));
        let is_unfelt = unfelt.as_ref().is_some_and(|from| {
            sight.side == watch::Side::Front && sight.depth > from(slave) + explained && !is_shared(slave.node)
        });
        (sight, finding.or(is_unfelt.then_some(Finding::Unfelt(sight.depth))))
    };
    (0..pair.slaves.len()).map(judge).collect()
}

/// Friction that pushes a node along its way over a tool, which is seen by places alone: what slips from node to node or from
/// point to point has other ways, and a penalty holds what it has before it slips.
fn pushed(ground: &Ground, pair: &Pair, s: usize, [from, to]: [&Vec3; 2], residual: f64) -> Option<Finding> {
    // Both sides of a hollow may push it along the mean of them.
    if pair.rules.friction == 0.0 {
        return None;
    }
    /// A way that is no rounding, over a facet.
    const WAY: f64 = 1e-6;
    let Ground::Tool(tool) = ground else { return None };
    let multiplies = matches!(pair.rules.method, Enforcement::AugmentedLagrangian | Enforcement::Lagrange);
    let at = &pair.slaves[s].trial;
    let normal = at.projection.filter(|_| multiplies && at.status != Status::Gap && pair.slides_at_nodes())?.normal;
    let along = |v: Vec3| v - normal * normal.dot(&v);
    let (way, force) = (along(tool.trial.rotation * tool.way(from, to)), along(-at.force));
    let is_pushed = way.norm() > WAY * pair.facet_size
        && force.norm() > residual
        && way.dot(&force) > pair.controls.watch_pushed * way.norm() * force.norm();
    is_pushed.then(|| Finding::Pushed(force.norm()))
}

/// How far a node that bears from node to node is from the one that it meets.
pub(super) fn apart(ground: &Ground, slave: &Slave, status: Status, place: &Vec3) -> Option<f64> {
    let Ground::Surface(surface, _) = ground else { return None };
    slave.mate.filter(|_| status != Status::Gap)?.aside(surface, place)
}

/// How deep the law of contact lets a slave node be: what its force needs under a penalty, and what the tolerance leaves.
pub(super) fn explained(model: &Model, pair: &Pair, s: usize, residual: f64) -> f64 {
    let slave = &pair.slaves[s];
    residual / slave.measure()
        + match pair.rules.method {
            // A node that leaves the contact to one of the other side has that one's force.
            Enforcement::Penalty => slave.trial.on_node().norm() / slave.law.penalty,
            Enforcement::Uzawa => {
                pair.rules.tolerance.unwrap_or(pair.controls.uzawa_tolerance * residual / model.stiffness)
            }
            _ => 0.0,
        }
}
