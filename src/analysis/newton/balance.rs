//! When forces are in balance.
//!
//! Each body, each contact and each tool is judged by its own forces: a soft body beside a preloaded one has a scale of its
//! own. Where bodies, or the materials of a body, share nodes, what the elements of each bear there acts on it: nothing else
//! may. A residual counts against the largest force that acts there now, or has acted there before, the latter in part, for
//! what has been eased need not be as exact as if it still bore all. Gaps, and slips of what sticks, count as the force
//! that the automatic penalty makes of them, so that no penalty that is given makes them large or small.
//!
//! No residual gets below what rounding leaves of it: of the forces of a body its stiffness times its displacements, or
//! times the size of its elements; of a contact its penalty times the coordinates. Where the tolerance asks for more, that
//! much is let through where nothing acts, as in a body that only moves. What is loaded, by a load, or by a contact with
//! more than that contact itself rounds to, or is strained, is excused no more than `rounding_cap` of the forces, and what
//! it counts against is these alone: a body of steel that rubber bears counts by the forces of the rubber, however little
//! they are to steel. If rounding leaves more, there is no result. Neither is there one where supports alone have changed
//! lengths in a body, and what rounding leaves is more than that share of the forces.

use super::super::Rounded;
use super::Newton;
use crate::Vec3;
use crate::contact::{Pair, Side, Slave, Status};
use crate::model::{Model, Section};
use crate::parallel::{max, sum};
use crate::partition::Part;
use crate::system::DofMap;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// The forces of one group, all ranks together once these have been summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Group {
    /// Largest force now, of an element on a node, and largest residual.
    force: f64,
    element: f64,
    residual: f64,
    /// Largest displacement or coordinate; penalty; by what penalty gaps count in the residual; and the automatic one.
    far: f64,
    penalty: f64,
    measure: f64,
    automatic: f64,
    /// Largest load on a section, or force that drives a tool; contact force on nodes of a section.
    load: f64,
    contact: f64,
}

const FIELDS: usize = 9;

/// Forces and residuals of an iterate, by sections of bodies, then contacts, then tools, then the torques of tools over their
/// levers.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    groups: Vec<Group>,
    /// Largest forces in converged increments.
    pub seen: Vec<f64>,
    /// Forces that count while there are none.
    floors: Vec<f64>,
    /// Forces of the elements of a section on nodes of this rank that count to another one, by node and section.
    shared: BTreeMap<(u32, u32), Vec3>,
    /// Group of each local unknown.
    group_of: Vec<u32>,
    limits: Vec<f64>,
    /// Groups that something acts on, by more than rounding.
    loaded: Vec<bool>,
    eased_share: f64,
}

impl Balance {
    /// The floors of all groups, N: a share of the stiffness times the size of an element, or what is given. That of a contact
    /// is its augmentation: a thin sheet is much stiffer across than what it rests on feels. Collective.
    pub fn floors(comm: &SimpleCommunicator, model: &Model, given: Option<f64>) -> Vec<f64> {
        let share = model.controls.force_floor_share;
        let of = |section: &Section| given.unwrap_or(share * section.stiffness * model.size);
        let largest = model.sections.iter().map(of).fold(0.0, f64::max);
        let sections = model.sections.iter().map(of);
        let largest_of = |pair: &Pair| pair.slaves.iter().map(|slave| slave.penalties.automatic).fold(0.0, f64::max);
        let mut augmentations: Vec<f64> = model.pairs.iter().map(largest_of).collect();
        max(comm, &mut augmentations);
        let pairs = augmentations.into_iter().map(|a| given.unwrap_or(share * a * model.size));
        sections.chain(pairs).chain((0..2 * model.masters.tools.len()).map(|_| largest)).collect()
    }

    pub fn new(model: &Model, dofs: &DofMap, seen: Vec<f64>, floors: Vec<f64>) -> Self {
        let groups = vec![Group::default(); floors.len()];
        let eased_share = model.controls.eased_share;
        let (limits, loaded) = (vec![0.0; floors.len()], vec![false; floors.len()]);
        let (shared, group_of) = (BTreeMap::new(), Vec::new());
        let mut balance = Self { groups, seen, limits, loaded, floors, shared, group_of, eased_share };
        balance.number(model, dofs);
        balance
    }

    /// Takes over the numbers of equations.
    pub fn number(&mut self, model: &Model, dofs: &DofMap) {
        let mut group_of = vec![0; dofs.count];
        let mut give = |equation: i64, group: usize| {
            if let Some(k) = dofs.local(equation) {
                group_of[k] = group as u32;
            }
        };
        for n in 0..model.part.owned {
            dofs.node[n].iter().for_each(|&e| give(e, model.part.section[n] as usize));
        }
        for (p, of_pair) in dofs.multiplier.iter().enumerate() {
            of_pair.iter().flatten().for_each(|&e| give(e, model.sections.len() + p));
        }
        for (joint, of_joint) in model.joints.iter().zip(&dofs.tie) {
            for (slave, equations) in joint.slaves.iter().zip(of_joint) {
                equations.iter().for_each(|&e| give(e, model.part.section[slave.node as usize] as usize));
            }
        }
        for (t, of_tool) in dofs.tool.iter().enumerate() {
            of_tool.iter().for_each(|&e| give(e, model.sections.len() + model.pairs.len() + t));
        }
        self.group_of = group_of;
    }

    /// Begins another iterate.
    pub fn clear(&mut self) {
        self.groups.fill(Group::default());
        self.shared.values_mut().for_each(|force| *force = Vec3::zeros());
    }

    /// A force on a node of a section, N.
    pub fn force(&mut self, group: usize, force: f64) {
        self.groups[group].force = self.groups[group].force.max(force);
    }

    /// A load on a node of a section, or the force, or the torque over its lever, that drives a tool, N.
    pub fn load(&mut self, group: usize, force: f64) {
        self.force(group, force);
        self.groups[group].load = self.groups[group].load.max(force);
    }

    /// A contact force on a node of a section, N.
    pub fn contact(&mut self, section: usize, force: f64) {
        self.force(section, force);
        self.groups[section].contact = self.groups[section].contact.max(force);
    }

    /// The forces of an element of a section on its nodes, N.
    pub fn element(&mut self, part: &Part, section: u32, nodes: &[u32], forces: &[[f64; 3]]) {
        let largest = forces.iter().flatten().fold(0.0, |most: f64, f| most.max(f.abs()));
        let own = &mut self.groups[section as usize].element;
        *own = own.max(largest);
        for (&n, force) in nodes.iter().zip(forces) {
            if (n as usize) < part.owned && part.section[n as usize] != section {
                *self.shared.entry((n, section)).or_default() += Vec3::from(*force);
            }
        }
    }

    /// After all elements, with their forces on the owned nodes: what of these acts on each section, N.
    pub fn internal(&mut self, part: &Part, forces: &[Vec3]) {
        for (n, force) in forces.iter().enumerate().take(part.owned) {
            self.force(part.section[n] as usize, force.amax());
        }
        let shared = std::mem::take(&mut self.shared);
        for (&(n, section), force) in &shared {
            let others: Vec3 = shared.range((n, 0)..=(n, u32::MAX)).map(|(_, force)| force).sum();
            self.force(section as usize, force.amax());
            self.force(part.section[n as usize] as usize, (forces[n as usize] - others).amax());
        }
        self.shared = shared;
    }

    fn residual(&mut self, group: usize, residual: f64) {
        // A NaN stays.
        if residual > self.groups[group].residual || residual.is_nan() {
            self.groups[group].residual = residual;
        }
    }

    /// The force that a residual of a group is compared with, N.
    pub fn scale(&self, group: usize) -> f64 {
        let actual = self.actual(group);
        if self.loaded[group] { actual } else { actual.max(self.floors[group]) }
    }

    fn actual(&self, group: usize) -> f64 {
        self.groups[group].force.max(self.eased_share * self.seen[group])
    }

    /// The largest residual over its scale. A section that no node counts to, as a soft layer between stiff ones, has neither.
    pub fn relative(&self) -> f64 {
        let all = (0..self.groups.len()).filter(|g| self.groups[*g].residual != 0.0);
        let of = |g: usize| self.groups[g].residual / self.scale(g);
        all.map(of).fold(0.0, |most, r| if r > most || r.is_nan() { r } else { most })
    }

    /// Whether all residuals are within the limits of a tolerance.
    pub fn holds(&self, tolerance: f64) -> bool {
        (0..self.groups.len()).all(|g| self.groups[g].residual <= self.limit(g, tolerance))
    }

    /// The largest residual of a group that is let through, N.
    pub fn limit(&self, group: usize, tolerance: f64) -> f64 {
        (tolerance * self.scale(group)).max(self.limits[group])
    }

    /// Of the group whose residual is the largest share of what a tolerance and rounding let through there: residual and
    /// limit over its scale. Without residuals 0 and the tolerance.
    pub fn nearest_to_its_limit(&self, tolerance: f64) -> [f64; 2] {
        let of = |g: usize| [self.groups[g].residual, self.limit(g, tolerance)].map(|force| force / self.scale(g));
        let share = |[residual, limit]: &[f64; 2]| residual / limit;
        let all = (0..self.groups.len()).filter(|g| self.groups[*g].residual != 0.0).map(of);
        all.max_by(|a, b| share(a).total_cmp(&share(b))).unwrap_or([0.0, tolerance])
    }

    /// The largest residual that a tolerance and rounding let through, over its scale.
    pub fn limit_of_all(&self, tolerance: f64) -> f64 {
        (0..self.groups.len()).map(|g| self.limit(g, tolerance) / self.scale(g)).fold(tolerance, f64::max)
    }

    /// The largest forces so far, when this iterate is accepted.
    pub fn accepted(&self) -> Vec<f64> {
        self.seen.iter().zip(&self.groups).map(|(seen, group)| seen.max(group.force)).collect()
    }

    /// The residual of a local unknown over its scale.
    fn worth(&self, k: usize, residual: f64) -> f64 {
        residual.abs() / self.scale(self.group_of[k] as usize)
    }
}

impl Newton<'_> {
    /// Judges the residuals `r` of an iterate, and names the worst. Collective.
    pub(super) fn judge(&mut self, r: &[f64]) {
        let sections = self.system.model.sections.len();
        for (k, value) in r.iter().enumerate() {
            let group = self.found.balance.group_of[k] as usize;
            if !(sections..sections + self.system.model.pairs.len()).contains(&group) {
                self.found.balance.residual(group, value.abs());
            }
        }
        for n in 0..self.system.model.part.owned {
            let own = &mut self.found.balance.groups[self.system.model.part.section[n] as usize];
            own.far = own.far.max(self.found.u[n].amax());
        }
        for (p, pair) in self.system.model.pairs.iter().enumerate() {
            let group = sections + p;
            for slave in &pair.slaves {
                let x = self.system.model.part.points[slave.node as usize] + self.found.u[slave.node as usize];
                self.found.balance.residual(group, violation(pair, slave));
                let own = &mut self.found.balance.groups[group];
                let penalty = if pair.rules.method.holds_multipliers() { slave.law.penalty } else { slave.law.normal };
                let measure = if pair.rules.method.holds_multipliers() { penalty } else { slave.measure() };
                own.far = own.far.max(x.amax());
                (own.penalty, own.measure) = (own.penalty.max(penalty), own.measure.max(measure));
                own.automatic = own.automatic.max(slave.penalties.automatic);
            }
        }
        self.share();
        self.set_limits();
        let worst = r.iter().enumerate().map(|(k, value)| (k, self.found.balance.worth(k, *value)));
        self.found.worst = worst.fold((0, 0.0), |worst, at| if at.1 > worst.1 { at } else { worst });
    }

    /// Makes the groups those of all ranks. Collective.
    fn share(&mut self) {
        let groups = &mut self.found.balance.groups;
        let broken: Vec<bool> = groups.iter().map(|g| g.residual.is_nan()).collect();
        let one = |g: &Group| {
            let residual = if g.residual.is_nan() { f64::INFINITY } else { g.residual };
            [g.force, g.element, residual, g.far, g.penalty, g.measure, g.automatic, g.load, g.contact]
        };
        let mut flat: Vec<f64> = groups.iter().flat_map(one).collect();
        max(self.system.comm, &mut flat);
        for ((group, all), broken) in groups.iter_mut().zip(flat.chunks_exact(FIELDS)).zip(broken) {
            let residual = if broken { f64::INFINITY } else { all[2] };
            let [force, element, _, far, penalty, measure, automatic, load, contact] =
                all.try_into().unwrap_or_default();
            *group = Group { force, element, residual, far, penalty, measure, automatic, load, contact };
        }
    }

    /// What rounding leaves of a sum of products, over these.
    pub(super) fn epsilon(&self) -> f64 {
        self.system.model.controls.rounding * f64::EPSILON
    }

    /// What rounding leaves of the internal forces of a section, N.
    fn own_rounding(&self, section: usize) -> f64 {
        self.epsilon()
            * self.system.model.sections[section].stiffness
            * self.found.balance.groups[section].far.max(self.system.model.size)
    }

    /// What rounding leaves of the residuals of a group, N.
    pub(super) fn rounding(&self, group: usize) -> f64 {
        let sections = self.system.model.sections.len();
        let groups = &self.found.balance.groups;
        let of_pair = |p: usize| self.epsilon() * groups[sections + p].penalty * groups[sections + p].far;
        let pairs = 0..self.system.model.pairs.len();
        if group < sections {
            let own = self.own_rounding(group);
            let acts = |p: &usize| groups[sections + p].force > 0.0;
            return pairs.filter(|p| self.touches(*p, group) && acts(p)).map(of_pair).fold(own, f64::max);
        }
        if group < sections + self.system.model.pairs.len() {
            return self.epsilon() * groups[group].measure * groups[group].far;
        }
        let tool = (group - sections - self.system.model.pairs.len()) % self.system.model.masters.tools.len();
        pairs
            .filter(|p| self.system.model.pairs[*p].master.tool() == Some(tool))
            .flat_map(|p| self.system.model.pairs[p].side.sections.iter().map(|&section| self.rounding(section)))
            .fold(0.0, f64::max)
    }

    /// Why a contact of a section leaves more by rounding than the section itself.
    fn rounded_by(&self, section: usize) -> String {
        let (first, Model { pairs, .. }) = (self.system.model.sections.len(), &*self.system.model);
        let of = |p: usize| self.found.balance.groups[first + p].penalty * self.found.balance.groups[first + p].far;
        let acts = |p: &usize| self.touches(*p, section) && self.found.balance.groups[first + p].force > 0.0;
        let touching = (0..pairs.len()).filter(acts);
        let Some(p) = touching.max_by(|a, b| of(*a).total_cmp(&of(*b))) else { return String::new() };
        let (pair, far) = (&pairs[p], self.found.balance.groups[first + p].far);
        match pair.rules.asked.1 {
            Some(_) => format!("the `penalty` of its contact `{}` is too large", pair.name),
            None if pair.rules.asked.0.holds_multipliers() => format!(
                "the penalty of its contact `{}` is too large with the method \"{}\": take \"augmented-lagrangian\", or give one",
                pair.name,
                pair.rules.asked.0.key()
            ),
            None => format!(
                "what it touches in contact `{}` is too stiff for them, or too far, {far:.1e}, from the origin",
                pair.name
            ),
        }
    }

    /// The largest residual that is let through, over the forces that it counts against.
    pub fn limit(&self) -> f64 {
        self.found.balance.limit_of_all(self.strategy.tolerance)
    }

    /// The residual that comes nearest to what is let through there, and that, both over the forces that they count against.
    pub fn nearest_to_its_limit(&self) -> [f64; 2] {
        self.found.balance.nearest_to_its_limit(self.strategy.tolerance)
    }

    /// The residual that is let through at each contact, N.
    pub fn limits(&self) -> Vec<f64> {
        let sections = self.system.model.sections.len();
        (0..self.system.model.pairs.len())
            .map(|p| self.found.balance.limit(sections + p, self.strategy.tolerance))
            .collect()
    }

    /// What is above the tolerance, and accepted as what rounding leaves.
    pub fn rounded(&self) -> Option<Rounded> {
        let (balance, tolerance) = (&self.found.balance, self.strategy.tolerance);
        let relative = |g: usize| balance.groups[g].residual / balance.scale(g);
        let lost = |g: usize| balance.loaded[g] && relative(g) > self.system.model.controls.rounding_cap;
        let above = (0..balance.groups.len()).filter(|g| relative(*g) > tolerance);
        let worst = above.max_by(|a, b| lost(*a).cmp(&lost(*b)).then(relative(*a).total_cmp(&relative(*b))))?;
        let limit = balance.limit(worst, tolerance) / balance.scale(worst);
        Some(Rounded { of: self.name_of(worst), residual: relative(worst), limit, lost: lost(worst) })
    }

    /// A group in words.
    fn name_of(&self, group: usize) -> String {
        let Model { sections, pairs, masters, bodies, .. } = &*self.system.model;
        let beyond = group.checked_sub(sections.len());
        match (sections.get(group), beyond.and_then(|p| pairs.get(p)), beyond) {
            (Some(section), ..) => format!("body `{}`", bodies[section.body].name),
            (_, Some(pair), _) => format!("contact `{}`", pair.name),
            (.., tool) => {
                let tool = tool.map_or(0, |t| (t - pairs.len()) % masters.tools.len());
                format!("tool `{}`", masters.tools[tool].name)
            }
        }
    }

    fn set_limits(&mut self) {
        let groups = 0..self.found.balance.groups.len();
        self.found.balance.loaded = groups.clone().map(|g| self.is_loaded(g)).collect();
        let capped = |g: usize| {
            let rounding = self.rounding(g);
            let cap = self.system.model.controls.rounding_cap;
            let at_stake = self.at_stake(g).filter(|_| !self.keeps_in_place());
            at_stake.map_or(rounding, |forces| rounding.min(cap * forces))
        };
        self.found.balance.limits = groups.map(capped).collect();
    }

    /// Whether a contact may act on a section or a tool.
    fn touches(&self, p: usize, group: usize) -> bool {
        let Model { sections, pairs, masters, .. } = &*self.system.model;
        let Pair { side, master_side, master, .. } = &pairs[p];
        let first = sections.len() + pairs.len();
        let of_tool = |t: usize| [first + t, first + masters.tools.len() + t].contains(&group);
        let is_on = |side: &Side| side.sections.contains(&group);
        is_on(side) || master_side.as_ref().is_some_and(is_on) || master.tool().is_some_and(of_tool)
    }

    /// The largest force of the contacts that touch a section or a tool, of those that bear more than rounding, N.
    fn borne(&self, group: usize) -> f64 {
        let (sections, pairs) = (self.system.model.sections.len(), 0..self.system.model.pairs.len());
        let real = pairs.filter(|p| self.touches(*p, group) && self.is_real(*p));
        real.map(|p| self.found.balance.groups[sections + p].force).fold(0.0, f64::max)
    }

    /// Whether a contact bears more than its gaps round to, or a share of what drives its tool, however little that is.
    fn is_real(&self, p: usize) -> bool {
        let (balance, Model { sections, controls, .. }) = (&self.found.balance, &*self.system.model);
        let Group { force, penalty, far, .. } = balance.groups[sections.len() + p];
        let driving = self.driving(p);
        let rounding =
            (self.epsilon() * penalty * far).max(self.strategy.tolerance * balance.floors[sections.len() + p]);
        force > rounding || driving > 0.0 && force > controls.rounding_cap * driving
    }

    /// Whether a load acts on a section, a contact with more than rounding, or on a tool a force that drives it, by more than
    /// what contacts bear across it rounds to. Says nothing of a stiff body's own rounding: what acts on it is as true,
    /// however little it strains it.
    fn is_loaded(&self, group: usize) -> bool {
        let (sections, pairs) = (self.system.model.sections.len(), self.system.model.pairs.len());
        let Group { load, contact, .. } = self.found.balance.groups[group];
        if group < sections {
            return load > 0.0 || contact > 0.0 && self.borne(group) > 0.0;
        }
        group >= sections + pairs && load > self.epsilon() * self.borne(group)
    }

    /// The forces of which no more than `rounding_cap` may be lost, N; `None` where there are none.
    fn at_stake(&self, group: usize) -> Option<f64> {
        let (balance, model) = (&self.found.balance, &self.system.model);
        let sections = model.sections.len();
        if balance.loaded[group] {
            return Some(balance.actual(group)).filter(|_| self.is_of_interest(group));
        }
        if group >= sections {
            // A tool that floats between contacts, along which they bear nothing.
            let is_tool = group >= sections + model.pairs.len();
            return Some(self.borne(group)).filter(|borne| is_tool && *borne > 0.0);
        }
        // Contacts of which each bears but rounding.
        let acts = |p: usize| self.touches(p, group) && balance.groups[sections + p].force > 0.0;
        let is_strained = balance.groups[group].element > model.controls.strained * self.own_rounding(group);
        (is_strained && (0..model.pairs.len()).any(acts)).then(|| balance.actual(group))
    }

    /// Whether a load acts on a section or a tool, or a contact by more than what closes a gap that is none, or that a force
    /// drives: what is less, as that of a body that but rests where the mesh is rounded, may be lost.
    fn is_of_interest(&self, group: usize) -> bool {
        let (balance, Model { sections, pairs, .. }) = (&self.found.balance, &*self.system.model);
        let bears = |p: usize| {
            let Group { force, automatic, .. } = balance.groups[sections.len() + p];
            let trifle = automatic * pairs[p].controls.no_gap * pairs[p].facet_size;
            self.is_real(p) && (self.driving(p) > 0.0 || force > trifle)
        };
        balance.groups[group].load > 0.0 || (0..pairs.len()).any(|p| self.touches(p, group) && bears(p))
    }

    /// The force that drives the tool of a contact, N.
    fn driving(&self, p: usize) -> f64 {
        let (balance, Model { sections, pairs, masters, .. }) = (&self.found.balance, &*self.system.model);
        let first = sections.len() + pairs.len();
        let of_tool =
            |t: usize| balance.groups[first + t].load.max(balance.groups[first + masters.tools.len() + t].load);
        pairs[p].master.tool().map_or(0.0, of_tool)
    }

    /// Whether a section is strained by so much that its strains, other than its forces, are resolved to `rounding_cap`: the
    /// length of a line between two nodes of an element has changed so far beyond what its coordinates round to. Collective.
    fn is_stretched(&self, section: usize) -> bool {
        let part = &self.system.model.part;
        let mut most = [0.0f64];
        for solid in part.solids.iter().filter(|solid| solid.section as usize == section) {
            for (k, &a) in solid.nodes().iter().enumerate() {
                for &b in &solid.nodes[..k] {
                    let (a, b) = (a as usize, b as usize);
                    let (line, by) = (part.points[b] - part.points[a], self.found.u[b] - self.found.u[a]);
                    let change = by.dot(&(line * 2.0 + by)).abs();
                    let far_of = |n: usize| part.points[n].amax() + self.found.u[n].amax();
                    let far = far_of(a).max(far_of(b));
                    most[0] = most[0].max(change / (line.norm() * far));
                }
            }
        }
        max(self.system.comm, &mut most);
        most[0] * self.system.model.controls.rounding_cap > self.epsilon()
    }

    /// A body or tool whose forces are lost in rounding, in words: residuals that are rounding and yet not small, or internal
    /// forces of an iterate that has `converged` that do not sum to zero, which they do whatever the state. What springs keep in
    /// place is on its way to another balance, and forces that end there are of no account. Collective.
    pub fn unresolved(&self, converged: bool) -> Option<(Lost, String)> {
        if self.keeps_in_place() {
            return None;
        }
        let model = &self.system.model;
        let mut sums: Vec<f64> = self.found.internal.iter().flat_map(|s| [s.x, s.y, s.z]).collect();
        sum(self.system.comm, &mut sums);
        // Those of a ring do so along its axis alone.
        let sums_up = [!model.is_axisymmetric(), true, !model.is_axisymmetric()];
        let rest = |group: usize| {
            // Of a body of several materials it counts against the largest forces in it.
            let force = |g: usize| self.found.balance.actual(g);
            let is_largest = |own: &Section| {
                let others = model.sections.iter().enumerate().filter(|(_, other)| other.body == own.body);
                others.map(|(g, _)| force(g)).fold(0.0, f64::max) <= force(group)
            };
            let body = model.sections.get(group).filter(|own| is_largest(own)).map(|own| own.body);
            let sum = body.and_then(|body| sums.chunks_exact(3).nth(body));
            sum.map_or(0.0, |s| {
                s.iter().zip(sums_up).filter(|(_, does)| *does).fold(0.0, |m: f64, (t, _)| m.max(t.abs()))
            })
        };
        let first_tool = model.sections.len() + model.pairs.len();
        let tools = model.masters.tools.len();
        let groups = (0..model.sections.len()).chain(first_tool..first_tool + 2 * tools);
        // What its supports alone strain has forces, which the stiffness against a change of volume may have drowned.
        let by_supports = |g: usize| {
            let Group { force, residual, .. } = self.found.balance.groups[g];
            let forces = force.max(self.found.balance.seen[g]);
            let asked = converged && g < first_tool && residual > model.controls.rounding_cap * forces;
            (asked && self.is_stretched(g)).then_some(forces)
        };
        let stakes = groups.filter_map(|g| Some((g, self.at_stake(g).or_else(|| by_supports(g))?)));
        stakes.map(|(g, forces)| (g, forces.max(self.strategy.least))).find_map(|(g, forces)| {
            let (residual, rest) = (self.found.balance.groups[g].residual, rest(g));
            let allowed = model.controls.rounding_cap.max(self.strategy.tolerance) * forces;
            let rounds = residual > allowed && residual <= self.rounding(g);
            let lost = if rounds { residual } else { rest };
            (rounds || converged && rest > model.controls.rounding_cap * forces).then(|| {
                let what = self.name_of(g);
                let why = if g >= first_tool {
                    "what it touches is too stiff for them"
                } else if self.rounding(g) > self.own_rounding(g) {
                    &self.rounded_by(g)
                } else {
                    "it is too stiff for them, too thin, or too nearly incompressible"
                };
                let word = format!(
                    "what rounding leaves of the forces of {what}, {lost:.1e}, is too much of the {forces:.1e} that act on it: {why}; \
                     stiff bodies can be tools, and forces that are of no interest, as those of a weak dashpot alone, are below \
                     `force_floor` of the table `solver`"
                );
                (Lost(lost / (model.controls.rounding_cap * forces)), word)
            })
        })
    }
}

/// How many times as much rounding leaves of the forces of a body or tool as it may.
#[derive(Clone, Copy, Debug)]
pub struct Lost(pub f64);

/// How far a slave node is from what its contact asks for, N.
fn violation(pair: &Pair, slave: &Slave) -> f64 {
    let trial = &slave.trial;
    if trial.status == Status::Gap || pair.rules.method.holds_multipliers() {
        return trial.local;
    }
    let share = slave.measure() / slave.law.normal;
    let gap = trial.projection.map_or(0.0, |p| slave.law.gap(p.gap).abs());
    let slip = if trial.status == Status::Stick { trial.slip.norm() } else { 0.0 };
    let gives = slave.law.compliance.slack > 0.0 || slave.law.barrier > 0.0;
    let open = if gives { 0.0 } else { slave.penalties.automatic * gap.max(slip) };
    (trial.local * share).max(open)
}
