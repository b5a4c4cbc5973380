//! What contacts have done until now, noted after each increment that is accepted: at its end a run tells of it.

use super::Simulation;
use super::between::Between;
use super::pace::Pace;
use super::watch::{apart, explained};
use crate::Vec3;
use crate::contact::watch::Side;
use crate::contact::{Ground, Pair, Sight, Slave, Status, touching_nodes};
use crate::model::{Model, states};
use crate::parallel::{agree, max, sum};
use crate::words::Words;
use std::collections::{BTreeMap, BTreeSet};

/// What it would take to push a slave out of a master that is in it unfelt, each node as stiff as the surface around it, over what the
/// contact bears, from where it is looked at more closely.
pub(super) const LACKS: f64 = 0.5;

/// What a contact did until now.
#[derive(Clone, Copy, Debug, Default)]
pub struct Touch {
    pub last: Last,
    /// The deepest that the master ever was between the slave's nodes, and when.
    pub between: Between,
    pub deepest_at: f64,
    /// How deep its nodes ever were behind the master.
    pub depth: f64,
    /// The same of nodes that leave the contact to one of the other side.
    pub yielded: Most,
    /// How many of its nodes ever were behind the master, past an end of it.
    pub past_end: Most,
    /// Sum of what its nodes bear now, N: around a shaft their forces cancel, and lose all the same.
    pub borne: f64,
    /// The largest share of that with which nodes slid off the master in an increment, and the largest change of it by a jump.
    pub slid: Loss,
    pub jumped: Loss,
    /// The same of friction that nodes let go of as they come to rest.
    pub rested: Loss,
    /// The largest share of that with which nodes bore on several tools at once, held by friction.
    pub shared: Most,
    /// How far nodes that bear from node to node ever were from those that they meet.
    pub apart: Most,
    /// The largest that it ever bore, N, and what was in it unfelt then.
    pub most: f64,
    pub let_in: LetIn,
    /// The same at the end of a step, of the worst, with half of the largest force or more.
    pub let_in_at_end: LetIn,
    /// How deep nodes ever were in the master while the contact, from segment to segment, bore nothing.
    pub unfelt: Most,
    pub pace: Pace,
    /// The largest force with which sides that nodes do not look at pushed them aside, N.
    pub aside: Most,
}

crate::words!(Touch {
    last,
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
    let_in_at_end,
    unfelt,
    pace,
    aside,
});

/// Where a contact was the last time that a node touched.
#[derive(Clone, Copy, Debug, Default)]
pub struct Last {
    /// Time of that increment, if there was one.
    pub until: Option<f64>,
    /// It is the last one.
    pub now: bool,
    /// Force of the master on the slave then, without friction.
    pub force: Vec3,
    /// Middle of the nodes that touched then, in space and on the tool.
    pub middle: Vec3,
    pub on_tool: Option<Vec3>,
}

crate::words!(Last { until, now, force, middle, on_tool });

/// The master in the slave where its nodes do not feel that: between them, or, from segment to segment, at nodes that are in it while
/// the gaps around them are closed in the mean.
#[derive(Clone, Copy, Debug, Default)]
pub struct LetIn {
    /// The deepest.
    pub depth: f64,
    /// It is between nodes.
    pub between: bool,
    /// By how much more it would have to give way, with what other contacts of its bodies let in: where they bear one after the other,
    /// as supports of a beam do, their depths add up.
    pub lacks: f64,
    /// How far all sides have given way under the force.
    pub approach: f64,
    pub at: f64,
}

crate::words!(LetIn { depth, between, lacks, approach, at });

impl LetIn {
    /// What it lacks over what has given way.
    pub fn share(&self) -> f64 {
        if self.lacks > 0.0 { self.lacks / self.approach } else { 0.0 }
    }
}

/// The largest that something ever was, and when.
#[derive(Clone, Copy, Debug, Default)]
pub struct Most {
    pub size: f64,
    pub at: f64,
}

crate::words!(Most { size, at });

impl Most {
    pub fn or_larger(self, size: f64, at: f64) -> Self {
        if size > self.size { Self { size, at } } else { self }
    }
}

/// A change of a contact's force that comes from its discretization, or over which there was no equilibrium.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loss {
    /// Over the larger of both sums.
    pub share: f64,
    /// What its nodes bore before and after, N.
    pub from: f64,
    pub to: f64,
    /// Time of the increment.
    pub at: f64,
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

impl Touch {
    fn note(&mut self, now: &Now, between: &Between, aside: f64, time: f64) {
        let Now { sums, largest } = now;
        self.depth = self.depth.max(largest.depth);
        self.yielded = self.yielded.or_larger(largest.yielded, time);
        self.apart = self.apart.or_larger(largest.apart, time);
        self.aside = self.aside.or_larger(aside, time);
        self.past_end = self.past_end.or_larger(sums.past_end, time);
        let shared = if sums.shared > 0.0 { sums.shared / sums.borne } else { 0.0 };
        self.shared = self.shared.or_larger(shared, time);
        if between.share > self.between.share {
            (self.between, self.deepest_at) = (*between, time);
        }
    }

    /// Notes what the contact lost, also by a jump, in an increment in which some contact bears `most`.
    fn note_losses(&mut self, sums: &Sums, most: f64, is_jump: bool, time: f64) {
        /// What a contact bears beside others is rounding.
        const ROUNDING: f64 = 1e-9;
        let borne = [std::mem::replace(&mut self.borne, sums.borne), sums.borne];
        self.slid = self.slid.or_larger(Loss::new(sums.slid, borne, time));
        if sums.borne > ROUNDING * most {
            self.rested = self.rested.or_larger(Loss::new(sums.let_go, borne, time));
        }
        if is_jump {
            self.jumped = self.jumped.or_larger(Loss::new((borne[1] - borne[0]).abs(), borne, time));
        }
    }
}

/// What the slave nodes of a contact do in an increment that was accepted, added up.
#[derive(Default)]
struct Sums {
    /// How many bear.
    count: f64,
    /// Force of the master on them, N, without friction.
    force: Vec3,
    /// Their places.
    middle: Vec3,
    /// What they bear, N: of all of them, of those that slid off, that several tools hold, and that let go of friction.
    borne: f64,
    slid: f64,
    shared: f64,
    let_go: f64,
    /// How many are behind the master, past an end of it.
    past_end: f64,
    /// What it would take to push those out that are in it unfelt, N.
    lacks: f64,
}

crate::words!(Sums { count, force, middle, borne, slid, shared, let_go, past_end, lacks });

impl Sums {
    /// Those of this rank.
    fn new(pair: &Pair, place: &impl Fn(u32) -> Vec3) -> Self {
        let mut sums = Self::default();
        for slave in &pair.slaves {
            let at = &slave.accepted;
            sums.let_go += at.let_go;
            if slave.sights.accepted.side == Side::Beside && !slave.committed.aside {
                sums.past_end += 1.0;
            }
            if at.force != Vec3::zeros() {
                sums.count += 1.0;
                sums.borne += at.force.norm();
                sums.force -= at.force - at.traction();
                sums.middle += place(slave.node);
            }
        }
        sums
    }
}

/// The largest of what they do.
struct Largest {
    /// How deep they are behind the master, and of these the ones that leave the contact to one of the other side.
    depth: f64,
    yielded: f64,
    /// How far from the node that they meet.
    apart: f64,
    /// How deep those are that are in the master unfelt.
    let_in: f64,
}

crate::words!(Largest { depth, yielded, apart, let_in });

impl Largest {
    /// That of this rank.
    fn new(ground: &Ground, pair: &Pair, place: &impl Fn(u32) -> Vec3) -> Self {
        let mut largest = Self { depth: 0.0, yielded: 0.0, apart: 0.0, let_in: 0.0 };
        for slave in &pair.slaves {
            let depth = slave.sights.accepted.depth - slave.law.allowed;
            largest.depth = largest.depth.max(depth);
            if slave.accepted.yields {
                largest.yielded = largest.yielded.max(depth);
            }
            let apart = apart(ground, slave, slave.accepted.status, &place(slave.node));
            largest.apart = largest.apart.max(apart.unwrap_or(0.0));
        }
        largest
    }
}

/// Both, over all ranks.
struct Now {
    sums: Sums,
    largest: Largest,
}

impl Now {
    /// How deep the master is in the slave unfelt, nothing where to push it out would take less than [`LACKS`] of what the contact
    /// bears; and whether that is between nodes.
    fn let_in(&self, between: &Between) -> (f64, bool) {
        let counts = |(lacks, depth): (f64, f64)| if lacks > LACKS * self.sums.borne { depth } else { 0.0 };
        let [at_nodes, beside] = [(self.sums.lacks, self.largest.let_in), (between.lacks, between.depth)].map(counts);
        (f64::max(at_nodes, beside), beside > at_nodes)
    }
}

impl Simulation<'_> {
    /// Notes which contacts touch in an increment that was accepted, how deep masters are between nodes, with what force sides push nodes
    /// `aside`, and what contacts lost, also by a jump; the increment may end its step. Collective.
    pub(super) fn note_touches(&mut self, (between, aside): (&[Between], &[f64]), [is_jump, ends_step]: [bool; 2]) {
        let time = self.state.time;
        let slid = take_slid(&mut self.model.pairs);
        let all = self.look_back(&slid);
        let most = all.iter().map(|now| now.sums.borne).fold(0.0, f64::max);
        // At a corner another contact with the same master may feel it.
        let pairs = &self.model.pairs;
        let is_felt = |p: usize| {
            let shares = |pair: &Pair| {
                pair.master == pairs[p].master || pairs[p].master_body().is_some_and(|b| pair.master_body() == Some(b))
            };
            pairs.iter().zip(&all).any(|(pair, now)| now.sums.count > 0.0 && shares(pair))
        };
        for (p, (touch, now)) in self.state.touches.iter_mut().zip(&all).enumerate() {
            touch.note(now, &between[p], aside[p], time);
            if !is_felt(p) {
                touch.unfelt = touch.unfelt.or_larger(now.largest.let_in, time);
            }
            touch.note_losses(&now.sums, most, is_jump, time);
            let Sums { count, force, middle, .. } = now.sums;
            touch.last.now = count > 0.0;
            if touch.last.now {
                let middle = middle / count;
                let tool = self.model.pairs[p].master.tool().map(|t| &self.model.masters.tools[t]);
                let on_tool = tool.map(|tool| tool.committed.inward(&middle));
                touch.last = Last { until: Some(time), now: true, force, middle, on_tool };
            }
        }
        self.note_let_in((&all, between), ends_step);
    }

    /// What the slave nodes of each contact do, which slid off masters with such forces on this rank. Collective.
    fn look_back(&self, slid: &[f64]) -> Vec<Now> {
        let (model, pairs) = (&self.model, &self.model.pairs);
        let place = |n: u32| model.part.points[n as usize] + self.state.u[n as usize];
        let (mut sums, mut largest) = (Vec::new(), Vec::new());
        for ((pair, slid), shared) in pairs.iter().zip(slid).zip(shared(pairs)) {
            let [lacks, let_in] = let_in(model, pair, place);
            Sums { slid: *slid, shared, lacks, ..Sums::new(pair, &place) }.put(&mut sums);
            Largest { let_in, ..Largest::new(&model.masters.of(pair.master), pair, &place) }.put(&mut largest);
        }
        sum(self.comm, &mut sums);
        max(self.comm, &mut largest);
        let (mut sums, mut largest) = (&sums[..], &largest[..]);
        pairs.iter().map(|_| Now { sums: Sums::take(&mut sums), largest: Largest::take(&mut largest) }).collect()
    }

    /// Notes what contacts let in unfelt that have just borne the most, or bear much at the end of a step, with what those let in that a body of theirs is in, and how far
    /// all of them have given way: twice the energy of their bodies over the force. Collective.
    fn note_let_in(&mut self, (all, between): (&[Now], &[Between]), ends_step: bool) {
        /// Of the largest force, at the end of a step.
        const MUCH: f64 = 0.5;
        let (comm, model, u, at) = (self.comm, &self.model, &self.state.u, self.state.time);
        let energy_of = |body: usize| {
            let mine =
                agree(comm, states::energies(model, u, body)).map_or(f64::INFINITY, |[stored, work]| stored + work);
            let mut energy = [mine];
            sum(comm, &mut energy);
            energy[0]
        };
        let mut energies = BTreeMap::new();
        let bodies = |pair: &Pair| [pair.side.body].into_iter().chain(pair.master_body());
        let let_in: Vec<(f64, bool)> = all.iter().zip(between).map(|(now, between)| now.let_in(between)).collect();
        for (p, touch) in self.state.touches.iter_mut().enumerate() {
            let borne = all[p].sums.borne;
            let is_most = borne >= touch.most;
            let counts = is_most || ends_step && borne >= MUCH * touch.most;
            if borne == 0.0 || !counts {
                continue;
            }
            touch.most = touch.most.max(borne);
            let (depth, between) = let_in[p];
            let mut now = LetIn { depth, between, at, ..LetIn::default() };
            if is_most {
                touch.let_in = now;
            }
            if depth == 0.0 {
                continue;
            }
            let is_beside = |q: &usize| *q != p && bodies(&model.pairs[p]).any(|body| model.pairs[*q].is_of(body));
            let others: Vec<usize> = (0..all.len()).filter(|q| let_in[*q].0 > 0.0).filter(is_beside).collect();
            let strained =
                others.iter().chain([&p]).flat_map(|q| bodies(&model.pairs[*q])).collect::<BTreeSet<usize>>();
            let energy = strained.into_iter().map(|body| *energies.entry(body).or_insert_with(|| energy_of(body)));
            now.approach = 2.0 * energy.sum::<f64>() / borne;
            let of_others = others.iter().map(|q| let_in[*q].0 * all[*q].sums.borne / borne).sum::<f64>();
            now.lacks = depth + of_others;
            if is_most {
                touch.let_in = now;
            } else if now.share() > touch.let_in_at_end.share() {
                touch.let_in_at_end = now;
            }
        }
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
        let is_in = side == Side::Front && depth > 0.0;
        let is_in = is_in && ground.project(pair, s, &place(slave.node), (None, false)).is_some();
        is_in.then(|| (slave.stiffness(&pair.controls), depth))
    };
    let deep = pair.slaves.iter().enumerate().filter_map(deep);
    deep.fold([0.0; 2], |[lacks, most], (stiffness, depth)| [lacks + stiffness * depth, most.max(depth)])
}
