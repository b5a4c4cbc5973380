//! The watch over increments: whether a converged one may become the state, and what is to be said at the end of a run.
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
use crate::Vec3;
use crate::contact::watch::{self, Allowance, Finding, View};
use crate::contact::{Ground, Movement, Pair, Sight, Slave, Status, mates, touching_nodes};
use crate::failure::Cause;
use crate::model::{Model, states};
use crate::output::phases::Phase;
use crate::output::summary;
use crate::parallel::{agree, first_word, max, sum, word_of_largest};
use crate::partition::parcels::{bounds, grown, hull, meets};
use crate::scene::Enforcement;
use crate::system::dofs::node_name;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;
use std::time::Instant;

/// The cosine of the angle between a way along a surface and its normal: rounding.
const STILL: f64 = 1e-9;
/// It has moved into the slave, and neither off nor along it, if this share of its way is against the slave: 60 degrees.
const INTO: f64 = 0.5;

/// Nodes that let go of friction of more of a contact's force as they rest are told of: what engineers would not see in a curve.
const LET_GO: f64 = 2e-3;

/// What it would take to push a slave out of a master that is in it unfelt, each node as stiff as the surface around it, over what the
/// contact bears, from where it is looked at more closely.
const LACKS: f64 = 0.5;

/// What a contact did until now.
#[derive(Clone, Copy, Debug, Default)]
pub struct Touch {
    /// Time of the last increment in which a node touched, if there was one.
    until: Option<f64>,
    /// It touches now.
    now: bool,
    /// Force of the master on the slave then, without friction.
    force: Vec3,
    /// Middle of the nodes that touched then, in space and on the tool.
    middle: Vec3,
    on_tool: Option<Vec3>,
    /// The deepest that the master ever was between the slave's nodes, and when.
    between: Between,
    deepest_at: f64,
    /// How deep its nodes ever were behind the master.
    depth: f64,
    /// The same of nodes that leave the contact to one of the other side.
    yielded: Most,
    /// How many of its nodes ever were behind the master, past an end of it.
    past_end: Most,
    /// Sum of what its nodes bear now, N: around a shaft their forces cancel, and lose all the same.
    borne: f64,
    /// The largest share of that with which nodes slid off the master in an increment, and the largest change of it by a jump.
    slid: Loss,
    jumped: Loss,
    /// The same of friction that nodes let go of as they come to rest.
    rested: Loss,
    /// The largest share of that with which nodes bore on several tools at once, held by friction.
    shared: Most,
    /// How far nodes that bear from node to node ever were from those that they meet.
    apart: Most,
    /// The largest that it ever bore, N, and what was in it unfelt then.
    most: f64,
    let_in: LetIn,
    /// The largest force with which sides that nodes do not look at pushed them aside, N.
    aside: Most,
}

crate::words!(Touch {
    until,
    now,
    force,
    middle,
    on_tool,
    between,
    deepest_at,
    depth,
    yielded,
    past_end,
    borne,
    slid,
    jumped,
    rested,
    shared,
    apart,
    most,
    let_in,
    aside,
});

/// The master in the slave where its nodes do not feel that: between them, or, from segment to segment, at nodes that are in it while
/// the gaps around them are closed in the mean.
#[derive(Clone, Copy, Debug, Default)]
struct LetIn {
    /// The deepest.
    depth: f64,
    /// It is between nodes.
    between: bool,
    /// How far both sides have given way under the force.
    approach: f64,
    at: f64,
}

crate::words!(LetIn { depth, between, approach, at });

/// The largest that something ever was, and when.
#[derive(Clone, Copy, Debug, Default)]
struct Most {
    size: f64,
    at: f64,
}

crate::words!(Most { size, at });

impl Most {
    fn or_larger(self, size: f64, at: f64) -> Self {
        if size > self.size { Self { size, at } } else { self }
    }
}

/// A change of a contact's force that comes from its discretization, or over which there was no equilibrium.
#[derive(Clone, Copy, Debug, Default)]
struct Loss {
    /// Over the larger of both sums.
    share: f64,
    /// What its nodes bore before and after, N.
    from: f64,
    to: f64,
    /// Time of the increment.
    at: f64,
}

crate::words!(Loss { share, from, to, at });

impl Loss {
    fn new(lost: f64, [from, to]: [f64; 2], at: f64) -> Self {
        Self { share: if lost > 0.0 { lost / from.max(to) } else { 0.0 }, from, to, at }
    }

    fn or_larger(self, other: Self) -> Self {
        if other.share > self.share { other } else { self }
    }
}

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

    /// A contact of which sides that nodes do not look at pushed them aside with more than is let by, in words: what the run says is
    /// not right then.
    pub fn pushed_aside(&self) -> Option<String> {
        let pairs = self.model.pairs.iter().zip(&self.state.touches).enumerate();
        let shares = pairs.map(|(p, (pair, touch))| (p, touch.aside.size / touch.most, pair.controls.watch_aside_most));
        let found = shares.filter(|(_, share, most)| share > most).max_by(|a, b| a.1.total_cmp(&b.1));
        found.map(|(p, share, _)| self.word_aside(p, share))
    }

    /// Where no node has ever touched a master that is between nodes, or was on its way, by more than is told of, the force is
    /// missing as a whole: that ends the step, however little it is.
    fn recall_unfelt(&self, idle: &[bool], between: &mut [Between]) {
        let pairs = self.model.pairs.iter().zip(&self.state.touches);
        for (((pair, touch), is_idle), between) in pairs.zip(idle).zip(between) {
            let deepest = between.or_deeper(touch.between);
            if *is_idle && touch.until.is_none() && deepest.share > pair.controls.watch_between {
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
            Finding::Between(_) => return self.word_between(p, between),
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

    /// How much sides that nodes do not look at pushed them aside, with such a share of the largest force, and what helps.
    fn word_aside(&self, p: usize, share: f64) -> String {
        let (pair, aside) = (&self.model.pairs[p], &self.state.touches[p].aside);
        let master = self.model.master_name(pair);
        let other_ways = match (pair.master.tool(), pair.faces.is_some(), pair.pass.other()) {
            (_, true, _) => "",
            (Some(_), ..) | (None, _, Some(_)) => ", or take `discretization = \"segment\"`",
            _ => ", exchange slave and master, or take `discretization = \"two-pass\"` or `\"segment\"`",
        };
        format!(
            "contact `{}`: sides of {master} that none of the facets around a node looks at pushed nodes aside with {:.3e} N (time \
             {:.6}), {:.0} % of the largest force: an edge between nodes is felt by those beside it, along the side where they are, \
             and finer facets do not change that; round it off by a fillet of two facets{other_ways}",
            pair.name,
            aside.size,
            aside.at,
            100.0 * share
        )
    }

    /// How deep the master of a pair is between the nodes of the slave.
    fn word_between(&self, p: usize, Between { share, depth, place, .. }: &Between) -> String {
        let pair = &self.model.pairs[p];
        let (master, slave) = (self.model.master_name(pair), &self.model.bodies[pair.side.body].name);
        format!(
            "contact `{}`: {master} is {depth:.3e} deep in body `{slave}` between its nodes, {}at ({:.6}, {:.6}, {:.6}), \
             where nothing resists it",
            pair.name,
            if share.is_finite() { format!("{share:.2} of the facet ") } else { "which never touched it, ".into() },
            place.x,
            place.y,
            place.z
        )
    }

    /// Notes which contacts touch in an increment that was accepted, how deep masters are between nodes, and what they lost,
    /// also by a jump. Collective.
    pub(super) fn note_touches(&mut self, (between, aside): (&[Between], &[f64]), is_jump: bool) {
        const EACH: usize = 13;
        let mut sums = Vec::with_capacity(EACH * self.model.pairs.len());
        let slid = take_slid(&mut self.model.pairs);
        let shared = shared(&self.model.pairs);
        let place = |n: u32| self.model.part.points[n as usize] + self.state.u[n as usize];
        let let_in: Vec<[f64; 2]> = self.model.pairs.iter().map(|pair| let_in(&self.model, pair, place)).collect();
        for (((pair, slid), shared), [lacks, _]) in self.model.pairs.iter().zip(slid).zip(shared).zip(&let_in) {
            let let_go: f64 = pair.slaves.iter().map(|slave| slave.accepted.let_go).sum();
            let (mut count, mut borne, mut force, mut middle) = (0.0, 0.0, Vec3::zeros(), Vec3::zeros());
            for slave in pair.slaves.iter().filter(|s| s.accepted.force != Vec3::zeros()) {
                let node = slave.node as usize;
                count += 1.0;
                borne += slave.accepted.force.norm();
                force -= slave.accepted.force - slave.accepted.traction();
                middle += self.model.part.points[node] + self.state.u[node];
            }
            let is_past_end = |s: &&Slave| s.sights.accepted.side == watch::Side::Beside && !s.committed.aside;
            let past_end = pair.slaves.iter().filter(is_past_end).count() as f64;
            let [f, m] = [force, middle];
            sums.extend([count, f.x, f.y, f.z, m.x, m.y, m.z, borne, slid, shared, let_go, past_end, *lacks]);
        }
        sum(self.comm, &mut sums);
        let depth = |slave: &Slave| slave.sights.accepted.depth - slave.law.allowed;
        let deepest = |pair: &Pair, of: &dyn Fn(&Slave) -> bool| {
            pair.slaves.iter().filter(|slave| of(slave)).map(depth).fold(0.0, f64::max)
        };
        let farthest = |pair: &Pair| {
            let ground = self.model.masters.of(pair.master);
            let apart = pair.slaves.iter().filter_map(|s| apart(&ground, s, s.accepted.status, &place(s.node)));
            apart.fold(0.0, f64::max)
        };
        let all = |(pair, [_, let_in]): (&Pair, &[f64; 2])| {
            [deepest(pair, &|_| true), deepest(pair, &|slave| slave.accepted.yields), farthest(pair), *let_in]
        };
        let mut depths: Vec<f64> = self.model.pairs.iter().zip(&let_in).flat_map(all).collect();
        max(self.comm, &mut depths);
        let borne = sums.chunks_exact(EACH).map(|sums| [sums[7], sums[12]]);
        let deepest = depths.as_chunks::<4>().0;
        for (((touch, [depth, yielded, apart, let_in]), [borne, lacks]), between) in
            self.state.touches.iter_mut().zip(deepest).zip(borne).zip(between)
        {
            touch.depth = touch.depth.max(*depth);
            if borne > 0.0 && borne >= touch.most {
                touch.most = borne;
                let counts = |(lacks, depth): (f64, f64)| if lacks > LACKS * borne { depth } else { 0.0 };
                let [at_nodes, beside] = [(lacks, *let_in), (between.lacks, between.depth)].map(counts);
                let (depth, between) = (f64::max(at_nodes, beside), beside > at_nodes);
                touch.let_in = LetIn { depth, between, approach: 0.0, at: self.state.time };
            }
            touch.apart = touch.apart.or_larger(*apart, self.state.time);
            touch.yielded = touch.yielded.or_larger(*yielded, self.state.time);
        }
        for (touch, between) in self.state.touches.iter_mut().zip(between) {
            if between.share > touch.between.share {
                (touch.between, touch.deepest_at) = (*between, self.state.time);
            }
        }
        for (touch, aside) in self.state.touches.iter_mut().zip(aside) {
            touch.aside = touch.aside.or_larger(*aside, self.state.time);
        }
        self.note_approaches();
        let most = sums.chunks_exact(EACH).map(|sums| sums[7]).fold(0.0, f64::max);
        for ((touch, pair), sums) in self.state.touches.iter_mut().zip(&self.model.pairs).zip(sums.chunks_exact(EACH)) {
            let borne = [std::mem::replace(&mut touch.borne, sums[7]), sums[7]];
            touch.slid = touch.slid.or_larger(Loss::new(sums[8], borne, self.state.time));
            // Of what bears more than rounding.
            if sums[7] > 1e-9 * most {
                touch.rested = touch.rested.or_larger(Loss::new(sums[10], borne, self.state.time));
            }
            if is_jump {
                let change = (borne[1] - borne[0]).abs();
                touch.jumped = touch.jumped.or_larger(Loss::new(change, borne, self.state.time));
            }
            touch.past_end = touch.past_end.or_larger(sums[11], self.state.time);
            let shared = if sums[9] > 0.0 { sums[9] / sums[7] } else { 0.0 };
            touch.shared = touch.shared.or_larger(shared, self.state.time);
            touch.now = sums[0] > 0.0;
            if touch.now {
                touch.until = Some(self.state.time);
                touch.force = Vec3::from_column_slice(&sums[1..4]);
                touch.middle = Vec3::from_column_slice(&sums[4..7]) / sums[0];
                let tool = pair.master.tool().map(|t| &self.model.masters.tools[t]);
                touch.on_tool = tool.map(|tool| tool.committed.inward(&touch.middle));
            }
        }
    }

    /// How far both sides of contacts have given way that have just borne the most with something in them unfelt: twice their energy
    /// over the force. Collective.
    fn note_approaches(&mut self) {
        let (comm, model, u) = (self.comm, &self.model, &self.state.u);
        let energy = |body: usize| {
            agree(comm, states::energies(model, u, body)).map_or(f64::INFINITY, |[stored, work]| stored + work)
        };
        for (pair, touch) in model.pairs.iter().zip(&mut self.state.touches) {
            if touch.let_in.depth > 0.0 && touch.let_in.approach == 0.0 {
                let mut energies =
                    [pair.side.body].into_iter().chain(pair.master_body()).map(energy).collect::<Vec<_>>();
                sum(comm, &mut energies);
                touch.let_in.approach = 2.0 * energies.iter().sum::<f64>() / touch.most;
            }
        }
    }

    /// What is to be said at the end: masters between nodes, contacts that never touched, and those that no longer do, though
    /// nothing took the tool away. Collective.
    pub fn idle_contacts(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(summary::Rounded { of, time, residual, lost: true, .. }) = &self.summary.rounded {
            warnings.push(format!(
                "{of}: what acts on it was so little, as what closes the rounding of a mesh, that rounding left {residual:.1e} of it \
                 (time {time:.6}, the most): what of such forces is shown is no more exact"
            ));
        }
        let count = |side: watch::Side| {
            let of = |p: &Pair| p.slaves.iter().filter(|s| s.sights.accepted.side == side).count() as f64;
            let mut counts: Vec<f64> = self.model.pairs.iter().map(of).collect();
            sum(self.comm, &mut counts);
            counts
        };
        let [inside, beside] = [watch::Side::Inside, watch::Side::Beside].map(count);
        // What rests and bears nothing may be off by a rounding.
        let is_near = |p: &Pair, s: &Slave| {
            s.accepted.projection.is_some_and(|at| at.gap.abs() <= p.controls.touching_gap * p.facet_size)
        };
        let touches =
            |p: &Pair| p.slaves.iter().filter(|s| s.accepted.status != Status::Gap || is_near(p, s)).count() as f64;
        let mut touching: Vec<f64> = self.model.pairs.iter().map(touches).collect();
        sum(self.comm, &mut touching);
        for (p, pair) in self.model.pairs.iter().enumerate() {
            let (name, master) = (&pair.name, self.model.master_name(pair));
            if inside[p] > 0.0 {
                warnings
                    .push(format!("contact `{name}`: {} nodes that began inside {master} are still there", inside[p]));
            }
            let touch = &self.state.touches[p];
            // Those in a body end the increment.
            let past_end = touch.past_end.or_larger(beside[p], self.state.time);
            if past_end.size > 0.0 && pair.master.tool().is_some() {
                warnings.push(format!(
                    "contact `{name}`: {} nodes were behind {master}, past an end of its surface (time {:.6}, the most)",
                    past_end.size, past_end.at
                ));
            }
            if touch.between.share > pair.controls.watch_between {
                let word = self.word_between(p, &touch.between);
                warnings.push(format!("{word}; refine the slave there (time {:.6})", touch.deepest_at));
            }
            if touch.yielded.size > pair.controls.watch_yields * pair.facet_size
                && pair.rules.method != Enforcement::Penalty
            {
                warnings.push(format!(
                    "contact `{name}`: a node that stands on one of the other side, to which it leaves the contact, was {:.3e} deep \
                     in {master}, {:.1e} of a facet (time {:.6}), and forces lack what it would take to push it out: \
                     `discretization = \"one-pass\"` or `\"segment\"` do not",
                    touch.yielded.size,
                    touch.yielded.size / pair.facet_size,
                    touch.yielded.at
                ));
            }
            if touch.slid.share > pair.controls.watch_slid {
                let Loss { share, from, to, at } = touch.slid;
                warnings.push(format!(
                    "contact `{name}`: nodes slid off the end of {master} with {:.0} % of its force, which went from {from:.6e} to \
                     {to:.6e} N (time {at:.6}): between its nodes a slave does not feel where a master ends; extend that, refine \
                     the slave, or take `discretization = \"segment\"`",
                    100.0 * share
                ));
            }
            if touch.rested.share > LET_GO {
                let Loss { share, from, to, at } = touch.rested;
                warnings.push(format!(
                    "contact `{name}`: nodes that are held along {master}, which leans there, let go of friction of {:.1} % of its \
                     force as they came to rest, which went from {from:.6e} to {to:.6e} N (time {at:.6}): let them move and rest in \
                     one step, with a `table`",
                    100.0 * share
                ));
            }
            if touch.shared.size > pair.controls.watch_shared {
                warnings.push(format!(
                    "contact `{name}`: nodes that {master} and another tool hold by friction at once bear {:.0} % of its force \
                     (time {:.6}): which tool bears how much of it does not follow from equilibrium; what all tools bear does, \
                     and without friction, or with one group of nodes for each tool, so does each",
                    100.0 * touch.shared.size,
                    touch.shared.at
                ));
            }
            if touch.jumped.share > 0.0 {
                let Loss { from, to, at, .. } = touch.jumped;
                warnings.push(format!(
                    "contact `{name}`: there was no equilibrium near, and a jump took its force from {from:.6e} to {to:.6e} N (time \
                     {at:.6}, the largest): what it went through on the way is not resolved"
                ));
            }
            if touch.apart.size > mates::APART * pair.facet_size {
                warnings.push(format!(
                    "contact `{name}`: nodes slid {:.3e} from those of {master} that they meet, {:.2} of a facet (time {:.6}), and \
                     forces act there all the same: \"node-to-node\" is for small sliding, take another `discretization`",
                    touch.apart.size,
                    touch.apart.size / pair.facet_size,
                    touch.apart.at
                ));
            }
            // From segment to segment nodes are in the master by as much as it curves, whatever the penalty.
            let in_the_mean = pair.faces.as_ref().map_or(0.0, |_| pair.controls.watch_segment);
            let lets_in = match pair.rules.method {
                Enforcement::Penalty => Some(("penalty", "raise `penalty`, or take another method")),
                Enforcement::Uzawa => pair.rules.tolerance.map(|_| ("tolerance", "lower `tolerance`")),
                _ => None,
            };
            let is_deep = touch.depth > (pair.controls.watch_deep + in_the_mean) * pair.facet_size;
            if let Some((what, remedy)) = lets_in.filter(|_| is_deep) {
                warnings.push(format!(
                    "contact `{name}`: its {what} let nodes be {:.3e} deep in {master}, {:.2} of a facet, and forces lack \
                     what it would take to push them out: {remedy}",
                    touch.depth,
                    touch.depth / pair.facet_size
                ));
            }
            let LetIn { depth, between, approach, at } = touch.let_in;
            // What is too deep between nodes whatever else is told of already.
            let is_told = between && touch.between.share > pair.controls.watch_between;
            if depth > pair.controls.watch_let_in * approach && !is_told {
                let (how, or) = match between {
                    true => (
                        format!("its nodes do not feel that between them {master} is {depth:.3e} deep in their body"),
                        "",
                    ),
                    false => (
                        format!("its gaps, closed in the mean over facets, let nodes be {depth:.3e} deep in {master}"),
                        ", or `discretization = \"one-pass\"`",
                    ),
                };
                warnings.push(format!(
                    "contact `{name}`: {how}, {:.2} of a facet, when it bore the most (time {at:.6}); both sides have given way by \
                     about {approach:.1e}, and where displacements are given forces lack what it would take to give way by \
                     {depth:.1e} more: mesh the slave finer there, or take the finer side as the slave{or}",
                    depth / pair.facet_size
                ));
            }
            let share = touch.aside.size / touch.most;
            if share > pair.controls.watch_aside && share <= pair.controls.watch_aside_most {
                warnings.push(self.word_aside(p, share));
            }
            let other = pair.pass.other().map(|other| self.state.touches[other]);
            if pair.pass.is_second() || touch.now || other.is_some_and(|o| o.now) {
                continue;
            }
            let until = [touch.until, other.and_then(|o| o.until)].into_iter().flatten().reduce(f64::max);
            match until {
                None if touching[p] > 0.0 => {
                    warnings.push(format!(
                        "contact `{name}`: nothing has ever pressed {} nodes that touch {master}",
                        touching[p]
                    ));
                }
                None => warnings.push(format!("contact `{name}`: no node has ever touched {master}")),
                Some(_) if touching[p] > 0.0 || self.was_taken_away(pair, touch) => {}
                Some(time) => {
                    warnings.push(format!("contact `{name}`: nothing touches {master} any more since time {time:.6}"));
                }
            }
        }
        warnings
    }

    /// Whether the tool has moved away from where it touched, against its force, or along the slave to where none of it is. Collective.
    fn was_taken_away(&self, pair: &Pair, touch: &Touch) -> bool {
        let place = |slave: &Slave| self.model.part.points[slave.node as usize] + self.state.u[slave.node as usize];
        let around = hull(self.comm, bounds(pair.slaves.iter().map(place))).map(|b| grown(b, pair.facet_size));
        let is_beside = |x: Vec3| around.is_none_or(|around| !meets(&around, &(x, x)));
        let now = |(t, point): (usize, Vec3)| self.model.masters.tools[t].committed.outward(&point);
        pair.master.tool().zip(touch.on_tool).map(now).is_some_and(|now| {
            let way = now - touch.middle;
            let into = way.dot(&touch.force);
            into < -STILL * way.norm() * touch.force.norm()
                || is_beside(now) && into < INTO * way.norm() * touch.force.norm()
        })
    }
}

/// The force with which slave nodes of this rank slid off each master, N; not those that came onto another one. Forgets it.
fn take_slid(pairs: &mut [Pair]) -> Vec<f64> {
    let slid = |pair: &Pair| pair.slaves.iter().any(|slave| slave.committed.slid > 0.0);
    if !pairs.iter().any(slid) {
        return vec![0.0; pairs.len()];
    }
    let touching = pairs.iter().flat_map(|pair| &pair.slaves).filter(|slave| slave.accepted.status != Status::Gap);
    let touching: BTreeSet<u32> = touching.map(|slave| slave.node).collect();
    let take = |slave: &mut Slave| {
        let slid = std::mem::take(&mut slave.committed.slid);
        if touching.contains(&slave.node) { 0.0 } else { slid }
    };
    pairs.iter_mut().map(|pair| pair.slaves.iter_mut().map(take).sum()).collect()
}

/// What slave nodes of this rank bear of each tool that are on several at once, and that friction holds on one, N: forces that
/// push these tools apart are in balance by themselves.
fn shared(pairs: &[Pair]) -> Vec<f64> {
    let tool = |p: usize| pairs[p].master.tool();
    let acts = |pair: &Pair, slave: &Slave| pair.master.tool().is_some() && slave.accepted.force != Vec3::zeros();
    let holds = |(p, slave): &(usize, &Slave)| pairs[*p].rules.friction > 0.0 && slave.accepted.status == Status::Stick;
    let mut shared = vec![0.0; pairs.len()];
    for at in touching_nodes(pairs, acts).values() {
        let is_on_several = at.iter().any(|(p, _)| tool(*p) != tool(at[0].0));
        if is_on_several && at.iter().any(holds) {
            at.iter().for_each(|(p, slave)| shared[*p] += slave.accepted.force.norm());
        }
    }
    shared
}

/// What it would take to push the slave nodes of this rank out of a master in which they are though a contact from segment to segment
/// has its gaps closed in the mean, N, and how deep the deepest of them is: each as stiff as the surface around it.
fn let_in(model: &Model, pair: &Pair, place: impl Fn(u32) -> Vec3) -> [f64; 2] {
    if pair.faces.is_none() || pair.is_self() {
        return [0.0; 2];
    }
    let ground = model.masters.of(pair.master);
    let deep = |(s, slave): (usize, &Slave)| {
        let Sight { side, depth, .. } = slave.sights.accepted;
        let depth = depth - slave.law.allowed - explained(model, pair, s, 0.0);
        // Past an end the watch sees what the contact does not.
        let is_in = side == watch::Side::Front && depth > 0.0;
        let is_in = is_in && ground.project(pair, s, &place(slave.node), (None, false)).is_some();
        is_in.then(|| (slave.stiffness(&pair.controls), depth))
    };
    let deep = pair.slaves.iter().enumerate().filter_map(deep);
    deep.fold([0.0; 2], |[lacks, most], (stiffness, depth)| [lacks + stiffness * depth, most.max(depth)])
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
    let is_eased = touch.until.is_some() || !ends_run;
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
fn apart(ground: &Ground, slave: &Slave, status: Status, place: &Vec3) -> Option<f64> {
    let Ground::Surface(surface, _) = ground else { return None };
    slave.mate.filter(|_| status != Status::Gap)?.aside(surface, place)
}

/// How deep the law of contact lets a slave node be: what its force needs under a penalty, and what the tolerance leaves.
fn explained(model: &Model, pair: &Pair, s: usize, residual: f64) -> f64 {
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
