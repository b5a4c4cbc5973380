//! Rounds around Newton's method: Uzawa's multipliers and Lagrange's active sets stand still while it runs. When it has
//! converged, multipliers take over the forces and sets change to what gaps and multipliers ask for, until nothing
//! changes beyond the tolerance.
//!
//! Under an active set that is not the last one the iteration need not converge far: a residual of 1e-3 is enough to change
//! the set, and measured to take four fifths of the iterations.
//!
//! Where several slave nodes or masters make the same condition, only constraints that give way share the force out. When
//! they have converged, they give way about the multipliers of then, and so on (the proximal method of multipliers): it
//! ends where the conditions hold as if none had given way, with the least multipliers that bear the load.
//!
//! Self-contact, which gives way always, does so once, with some 1e-7 of the forces left; where it has given way by
//! `wide_slack`, twice with `slack`, and as little is left. Thin sheets and rubber that is confined resist far more than the
//! stiffness that this counts by: there rounds go on until less than `slack_left` is. More rounds lead nowhere. Nodes that
//! meet and stick are each held to a point of the other's patch, and contradict each other by 1e-7 of a facet: multipliers
//! grow by the same in each round, until one slips. Tips on tips have two ways to slide off, and each round makes a multiple
//! of how far they lean. Of 54 strips, one round more lets 6 fail, and one after the other while each halves what is left 6
//! as well, with thrice the iterations.
//!
//! Where what touches is to stick first, it does until the active set stands, for a set that lets bodies touch may press what
//! only friction holds; and where the iteration goes along the [central path](super::central), each of its stages is a round.
//!
//! Held multipliers grow so, too, where several contacts hold what sticks, as blocks side by side that stick to one platen and to each
//! other: by the same in each round, and by some 1e-4 of what friction can bear. What changes so is twice as much in each round
//! as in the one before.
//!
//! An active set that comes back would come back for ever: from then on one node changes in a round, that with the
//! largest violation. When a set comes back even so, the increment has failed.

use super::Newton;
use crate::Vec3;
use crate::contact::{Compliance, Held, Pair, Slave, Status};
use crate::controls::Controls;
use crate::parallel::{any, first_word, max, sum};
use crate::scene::Enforcement;
use crate::system::dofs::node_name;

/// What becomes of a converged iterate.
pub enum Round {
    Done,
    /// Newton's method goes on from it.
    Again,
    /// Why it cannot become the solution.
    Failed(String),
    /// Where conditions contradict each other.
    Contradicts(String),
}

/// Rounds so far.
#[derive(Clone, Debug, Default)]
pub struct Rounds {
    pub count: usize,
    /// Those of them that were steps on the way, under contacts that stick or on the central path, and do not count against
    /// `outer_rounds`.
    pub(super) early: usize,
    /// How often the constraints that give way were tightened.
    pub tightened: usize,
    /// The forces on the nodes of surfaces that meet themselves before that, and of each of these what it had added.
    borne: Vec<Vec3>,
    gained: Vec<f64>,
    /// The active sets of this rank that were tried.
    sets: Vec<Vec<Status>>,
    /// One node at a time changes its status.
    singly: bool,
    /// The active set is the last one, as far as is known.
    settled: bool,
    /// What Uzawa's method last added to the multipliers of this rank's slave nodes, and how often in succession twice as much of it.
    added: Vec<(f64, Vec3)>,
    doubled: i32,
}

impl Newton<'_> {
    /// After convergence: lets multipliers and active sets follow, and says whether that is all. Collective.
    pub fn end_round(&mut self) -> Round {
        if self.is_central() {
            return self.end_stage();
        }
        let Controls { uzawa_tolerance, outer_rounds, rounding, .. } = self.system.model.controls;
        let tolerance = self.tolerance_now();
        // Violations over what may be left of them.
        let [mut open, mut wrong] = [(0.0f64, None), (0.0f64, None)];
        for (p, pair) in self.system.model.pairs.iter().enumerate() {
            let group = self.system.model.sections.len() + p;
            let limit = self.found.balance.limit(group, tolerance);
            // Gaps and slips are no more exact than the places that they are between.
            let (worst, allowed, exact) = match pair.rules.method {
                Enforcement::Uzawa => {
                    // What rounding leaves is no tolerance, and is let through once.
                    let force = limit.max(uzawa_tolerance * tolerance * self.found.balance.scale(group));
                    let allowed = pair.rules.tolerance.unwrap_or(force / self.system.model.stiffness);
                    (&mut open, allowed, rounding * f64::EPSILON)
                }
                Enforcement::Lagrange => (&mut wrong, limit, 0.0),
                _ => continue,
            };
            for (s, slave) in pair.slaves.iter().enumerate() {
                let off = slave.trial.violation / allowed.max(exact * slave.trial.position.amax());
                if off > worst.0 {
                    *worst = (off, Some((p, s)));
                }
            }
        }
        let mut largest = [open.0, wrong.0];
        max(self.system.comm, &mut largest);
        let (is_open, is_wrong) = (largest[0] > 1.0, largest[1] > 1.0);
        if self.strategy.settling {
            // What a set has let touch presses bodies together that only friction holds: they stick until it stands.
            let stands = !is_wrong || self.course.rounds.count >= outer_rounds;
            let changes = !stands && self.found.balance.holds(tolerance) && self.change_set(tolerance, largest[1]);
            self.course.rounds.count += usize::from(changes);
            if !changes {
                self.let_slip();
                if self.strategy.central {
                    self.begin_central();
                }
            }
            return self.again();
        }
        if !is_open && !is_wrong {
            self.course.rounds.settled = true;
            // What held by the loose tolerance of a set that was not known to be the last is judged again.
            let now = self.tolerance_now();
            return if now >= tolerance && self.found.balance.holds(now) { Round::Done } else { self.again() };
        }
        self.course.rounds.count += 1;
        self.course.rounds.settled = !is_wrong;
        let worst = if is_open { open } else { wrong };
        let here = worst.1.filter(|_| worst.0 == if is_open { largest[0] } else { largest[1] });
        let here = here.map(|at| self.lacks(at, worst.0));
        if self.course.rounds.count - self.course.rounds.early > outer_rounds {
            return Round::Failed(self.told(here, &format!("{outer_rounds} rounds of contact forces do not settle")));
        }
        if is_open {
            self.take_over();
        }
        if is_wrong && !self.change_set(tolerance, largest[1]) {
            return Round::Failed(self.told(here, "the active set of contacts comes back again and again"));
        }
        self.again()
    }

    /// Lets the multipliers of Uzawa's method take over the forces. Collective.
    fn take_over(&mut self) {
        /// Share by which what is added twice may differ to be the same.
        const ALIKE: f64 = 0.1;
        let alike = |now: f64, change: f64| now > 0.0 && change <= ALIKE * now;
        let slaves: Vec<&mut Slave> = of_method(&mut self.system.model.pairs, Enforcement::Uzawa).collect();
        let taken: Vec<Held> = slaves.iter().map(|slave| slave.taken_over()).collect();
        // To the gap, and, where it sticks, to the friction.
        let add = |(slave, now): (&&mut Slave, &Held)| {
            let sticks = slave.trial.status == Status::Stick;
            (now.gap - slave.held.gap, if sticks { now.tangential - slave.held.tangential } else { Vec3::zeros() })
        };
        let added: Vec<(f64, Vec3)> = slaves.iter().zip(&taken).map(add).collect();
        let rounds = &mut self.course.rounds;
        let drifts = |((gap, friction), (last_gap, last)): (&(f64, Vec3), &(f64, Vec3))| {
            [alike(gap.abs(), (gap - last_gap).abs()), alike(friction.norm(), (friction - last).norm())]
        };
        let mut drifting: Vec<[bool; 2]> = added.iter().zip(&rounds.added).map(drifts).collect();
        drifting.resize(added.len(), [false; 2]);
        // Friction ends it; what only presses has no end.
        let drift = any(self.system.comm, drifting.iter().any(|[_, friction]| *friction));
        rounds.doubled = if drift { rounds.doubled + 1 } else { 0 };
        let more = 2f64.powi(rounds.doubled) - 1.0;
        for (s, slave) in slaves.into_iter().enumerate() {
            let [of_gap, of_friction] = drifting[s].map(|drifts| if drifts { more } else { 0.0 });
            slave.held = taken[s];
            slave.held.gap += of_gap * added[s].0;
            slave.held.tangential += of_friction * added[s].1;
        }
        rounds.added = added;
    }

    /// Ends the settling: what touches may slip from now on, and has friction.
    fn let_slip(&mut self) {
        self.strategy.settling = false;
        self.system.model.pairs.iter_mut().flat_map(|p| &mut p.slaves).for_each(|slave| {
            (slave.law.rough, slave.law.glides) = (false, false);
        });
        let rounds = &mut self.course.rounds;
        (rounds.singly, rounds.settled, rounds.early) = (false, false, rounds.count);
        rounds.sets.clear();
    }

    /// After convergence: lets constraints that gave way do so about the multipliers at `x` instead, and says whether that is
    /// all. Collective.
    pub fn tighten(&mut self, x: &[f64]) -> Round {
        let multipliers = self.multipliers(x);
        let (tolerance, sections) = (self.tolerance_now(), self.system.model.sections.len());
        let outer_rounds = self.system.model.controls.outer_rounds;
        let rounds = if self.strategy.yields { 2 } else { 1 };
        let (mut repeats, mut left, mut worst) = (false, 0.0, None);
        let pairs = self.system.model.pairs.iter_mut().zip(multipliers).enumerate().filter(|(_, (p, _))| p.width() > 0);
        for (p, (pair, multipliers)) in pairs {
            let limit = self.found.balance.limit(sections + p, tolerance);
            for (s, (slave, multiplier)) in pair.slaves.iter_mut().zip(multipliers).enumerate() {
                let Compliance { slack, rest } = &mut slave.law.compliance;
                let given = *slack * (multiplier - std::mem::replace(rest, multiplier)).amax();
                if let Some(narrow) = slave.repeats {
                    *slack = narrow * slave.penalties.softness;
                }
                if slave.trial.status == Status::Gap {
                    continue;
                }
                repeats |= slave.repeats.is_some();
                if slave.repeats.is_none() && given / limit > left {
                    (left, worst) = (given / limit, Some((p, s, given / slave.law.normal)));
                }
            }
        }
        let is_left = self.is_left();
        let mut most = [left, f64::from(repeats && (is_left || self.course.rounds.tightened < rounds))];
        max(self.system.comm, &mut most);
        if most[0] <= 1.0 && most[1] == 0.0 {
            return Round::Done;
        }
        self.course.rounds.tightened += 1;
        if self.course.rounds.tightened > outer_rounds {
            let worst = worst.filter(|_| left == most[0]).map(|(p, s, way)| (p, s, format!("off by {way:.1e}")));
            return Round::Contradicts(self.told(worst, "conditions of contacts contradict each other"));
        }
        self.again()
    }

    /// Whether surfaces that meet themselves lack more than `slack_left` of what their nodes bear: each round adds a share of what the
    /// one before has added, the first of all that was found. What the nodes of both sides bear against each other is no part of
    /// that. Collective.
    fn is_left(&mut self) -> bool {
        /// The share counts as no more than this.
        const MOST: f64 = 0.99;
        let (tolerance, model) = (self.tolerance_now(), &self.system.model);
        let pairs = || model.pairs.iter().enumerate().filter(|(_, pair)| pair.is_self() && pair.width() > 0);
        if pairs().next().is_none() {
            return false;
        }
        let rounds = &mut self.course.rounds;
        let mut before = std::mem::take(&mut rounds.borne).into_iter();
        let mut sums = Vec::new();
        for (_, pair) in pairs() {
            let mut of_pair = [0.0; 2];
            for force in pair.slaves.iter().map(|slave| slave.trial.on_node()) {
                of_pair[0] += force.norm();
                of_pair[1] += (force - before.next().unwrap_or_default()).norm();
                rounds.borne.push(force);
            }
            sums.extend(of_pair);
        }
        sum(self.system.comm, &mut sums);
        let mut is_left = rounds.gained.is_empty();
        for (((p, _), [all, gained]), last) in pairs().zip(sums.as_chunks::<2>().0).zip(&rounds.gained) {
            let scale = self.found.balance.limit(model.sections.len() + p, tolerance) / tolerance;
            let share = (gained / last).min(MOST);
            is_left |= gained * share / (1.0 - share) > model.controls.slack_left * all.max(scale);
        }
        rounds.gained = sums.as_chunks::<2>().0.iter().map(|[_, gained]| *gained).collect();
        is_left
    }

    /// The next solve judges this iterate again.
    pub(super) fn again(&mut self) -> Round {
        self.judge_again();
        Round::Again
    }

    /// Largest residual of a converged iterate over the forces that it counts against.
    pub(super) fn tolerance_now(&self) -> f64 {
        let sets = !self.course.rounds.settled
            && self.system.model.pairs.iter().any(|p| p.rules.method == Enforcement::Lagrange);
        if sets || self.strategy.settling || self.is_central() {
            self.strategy.tolerance.max(self.system.model.controls.loose_tolerance)
        } else {
            self.strategy.tolerance
        }
    }

    /// Changes the active set where violations exceed a tolerance, or, one node at a time, are as large as the `largest` over
    /// their limits; `false` when it was there before even so. Collective.
    fn change_set(&mut self, tolerance: f64, largest: f64) -> bool {
        let before = self.active_set();
        if self.course.rounds.sets.is_empty() {
            self.course.rounds.sets.push(before.clone());
        }
        self.take_asked(tolerance, 1.0);
        let mut returned = self.has_returned();
        if returned && !self.course.rounds.singly {
            (self.course.rounds.singly, self.course.rounds.sets) = (true, vec![before.clone()]);
            let slaves = self.system.model.pairs.iter_mut().flat_map(|p| &mut p.slaves);
            slaves.zip(&before).for_each(|(slave, status)| slave.trial.status = *status);
            self.take_asked(tolerance, largest * (1.0 - 1e-9));
            returned = false;
        }
        let now = self.active_set();
        self.course.rounds.sets.push(now);
        !returned
    }

    /// Begins the active sets of some pairs with all that touches, which alone may hold a body at first.
    pub fn begin_with_what_touches(&mut self, pairs: &[usize]) {
        for &p in pairs {
            let pair = &mut self.system.model.pairs[p];
            let near = pair.controls.touching_gap * pair.facet_size;
            let touching = pair.slaves.iter_mut().filter(|s| s.accepted.projection.is_some_and(|at| at.gap <= near));
            touching.for_each(|slave| slave.trial.status = Status::Stick);
        }
    }

    /// The statuses of this rank's slave nodes.
    fn active_set(&self) -> Vec<Status> {
        self.slaves().map(|s| s.trial.status).collect()
    }

    /// Gives nodes of which the violation is above so many limits the status that they ask for.
    fn take_asked(&mut self, tolerance: f64, times: f64) {
        let sections = self.system.model.sections.len();
        for (p, pair) in
            self.system.model.pairs.iter_mut().enumerate().filter(|(_, p)| p.rules.method == Enforcement::Lagrange)
        {
            let limit = times * self.found.balance.limit(sections + p, tolerance);
            let wrong = pair.slaves.iter_mut().filter(|s| s.trial.violation > limit);
            wrong.for_each(|slave| slave.trial.status = slave.trial.asked);
        }
    }

    /// A reason with the worst node, by its pair and place in it, and what it lacks. Collective.
    fn told(&self, worst: Option<(usize, usize, String)>, reason: &str) -> String {
        let word = worst.map(|(p, s, lacks)| {
            let (pair, slave) = (&self.system.model.pairs[p], &self.system.model.pairs[p].slaves[s]);
            let (node, is) = (node_name(self.system.model, slave.node), slave.trial.status.name(pair.rules.friction));
            format!("{reason}: node {node}, contact `{}`, {is}, {lacks}", pair.name)
        });
        first_word(self.system.comm, word).unwrap_or_else(|| reason.into())
    }

    /// What the worst node of an active set, or of Uzawa's method, lacks: so many times what may be left.
    fn lacks(&self, (p, s): (usize, usize), times: f64) -> (usize, usize, String) {
        let (pair, trial) = (&self.system.model.pairs[p], &self.system.model.pairs[p].slaves[s].trial);
        let violation = trial.violation;
        let lacks = match pair.rules.method {
            Enforcement::Lagrange => {
                format!("should be {}, force {violation:.1e}", trial.asked.name(pair.rules.friction))
            }
            _ => format!("penetration or slip {violation:.1e}, of which {:.1e} may be left", violation / times),
        };
        (p, s, lacks)
    }

    /// Whether the active set of all ranks is one that was there. Collective.
    fn has_returned(&self) -> bool {
        let now = self.active_set();
        let mut differ: Vec<f64> = self.course.rounds.sets.iter().map(|set| f64::from(*set != now)).collect();
        max(self.system.comm, &mut differ);
        differ.contains(&0.0)
    }
}

fn of_method(pairs: &mut [Pair], method: Enforcement) -> impl Iterator<Item = &mut Slave> {
    pairs.iter_mut().filter(move |p| p.rules.method == method).flat_map(|p| &mut p.slaves)
}
