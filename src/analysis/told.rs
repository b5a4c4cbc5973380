//! What is said at the end of a run of what its contacts have done: where forces lack something, or come from where nodes happen to
//! be, of masters between nodes, and of contacts that never touched or no longer do, though nothing took the tool away.

use super::Simulation;
use super::pace::Pace;
use super::touches::{LetIn, Loss, Most, Touch};
use crate::Vec3;
use crate::contact::watch::Side;
use crate::contact::{Pair, Slave, Status, mates};
use crate::model::Model;
use crate::output::summary;
use crate::parallel::sum;
use crate::partition::parcels::{bounds, grown, hull, meets};
use crate::scene::Enforcement;

/// The cosine of the angle between a way along a surface and its normal: rounding.
const STILL: f64 = 1e-9;
/// It has moved into the slave, and neither off nor along it, if this share of its way is against the slave: 60 degrees.
const INTO: f64 = 0.5;

/// Nodes that let go of friction of more of a contact's force as they rest are told of: what engineers would not see in a curve.
const LET_GO: f64 = 2e-3;

/// A contact of which is told.
struct Told<'a> {
    pair: &'a Pair,
    touch: &'a Touch,
    master: String,
}

impl Simulation<'_> {
    /// What is to be said at the end. Collective.
    pub fn last_warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(summary::Rounded { of, time, residual, lost: true, .. }) = &self.summary.rounded {
            warnings.push(format!(
                "{of}: what acts on it was so little, as what closes the rounding of a mesh, that rounding left {residual:.1e} of it \
                 (time {time:.6}, the most): what of such forces is shown is no more exact"
            ));
        }
        let count = |counts: &dyn Fn(&Pair, &Slave) -> bool| {
            let of = |pair: &Pair| pair.slaves.iter().filter(|slave| counts(pair, slave)).count() as f64;
            let mut counts: Vec<f64> = self.model.pairs.iter().map(of).collect();
            sum(self.comm, &mut counts);
            counts
        };
        let inside = count(&|_, slave| slave.sights.accepted.side == Side::Inside);
        let beside = count(&|_, slave| slave.sights.accepted.side == Side::Beside);
        // What rests and bears nothing may be off by a rounding.
        let is_near = |pair: &Pair, slave: &Slave| {
            let within = |gap: f64| gap.abs() <= pair.controls.touching_gap * pair.facet_size;
            slave.accepted.projection.is_some_and(|at| within(at.gap))
        };
        let touching = count(&|pair, slave| slave.accepted.status != Status::Gap || is_near(pair, slave));
        for (p, pair) in self.model.pairs.iter().enumerate() {
            let told = Told::new(&self.model, pair, &self.state.touches[p]);
            let of_this = [
                told.began_inside(inside[p]),
                told.past_end(Most { size: beside[p], at: self.state.time }),
                told.between(&self.model),
                told.yielded(),
                told.slid(),
                told.rested(),
                told.shared(),
                told.jumped(),
                told.apart(),
                told.gave_way(),
                told.let_in(),
                told.unfelt(),
                told.went_over(),
                told.aside(),
            ];
            warnings.extend(of_this.into_iter().flatten());
            let other = pair.pass.other().map(|other| &self.state.touches[other]);
            warnings.extend(self.left(&told, other, touching[p]));
        }
        warnings
    }

    /// A contact of which sides that nodes do not look at pushed them aside with more than is let by, in words: what the run says is
    /// not right then.
    pub fn pushed_aside(&self) -> Option<String> {
        let pairs = self.model.pairs.iter().zip(&self.state.touches);
        let told = pairs.map(|(pair, touch)| Told::new(&self.model, pair, touch));
        let found = told.filter(|told| told.share_aside() > told.pair.controls.watch_aside_most);
        found.max_by(|a, b| a.share_aside().total_cmp(&b.share_aside())).map(|told| told.word_aside())
    }

    /// A contact that never touched, or no longer does; of two passes the first speaks. Collective.
    fn left(&self, told: &Told, other: Option<&Touch>, touching: f64) -> Option<String> {
        let Told { pair, touch, master } = told;
        let is_touched = touch.last.now || other.is_some_and(|other| other.last.now);
        if pair.pass.is_second() || is_touched {
            return None;
        }
        let until = [touch.last.until, other.and_then(|other| other.last.until)];
        let what = match until.into_iter().flatten().reduce(f64::max) {
            None if touching > 0.0 => format!("nothing has ever pressed {touching} nodes that touch {master}"),
            None => format!("no node has ever touched {master}"),
            Some(_) if touching > 0.0 || self.was_taken_away(pair, touch) => return None,
            Some(time) => format!("nothing touches {master} any more since time {time:.6}"),
        };
        Some(told.word(&what))
    }

    /// Whether the tool has moved away from where it touched, against its force, or along the slave to where none of it is. Collective.
    fn was_taken_away(&self, pair: &Pair, touch: &Touch) -> bool {
        let place = |slave: &Slave| self.model.part.points[slave.node as usize] + self.state.u[slave.node as usize];
        let around = hull(self.comm, bounds(pair.slaves.iter().map(place))).map(|b| grown(b, pair.facet_size));
        let is_beside = |x: Vec3| around.is_none_or(|around| !meets(&around, &(x, x)));
        let now = |(t, point): (usize, Vec3)| self.model.masters.tools[t].committed.outward(&point);
        pair.master.tool().zip(touch.last.on_tool).map(now).is_some_and(|now| {
            let way = now - touch.last.middle;
            let into = way.dot(&touch.last.force);
            into < -STILL * way.norm() * touch.last.force.norm()
                || is_beside(now) && into < INTO * way.norm() * touch.last.force.norm()
        })
    }
}

impl<'a> Told<'a> {
    fn new(model: &Model, pair: &'a Pair, touch: &'a Touch) -> Self {
        Self { pair, touch, master: model.master_name(pair) }
    }

    fn word(&self, what: &str) -> String {
        format!("contact `{}`: {what}", self.pair.name)
    }

    /// A length over that of a facet.
    fn facets(&self, length: f64) -> f64 {
        length / self.pair.facet_size
    }

    fn began_inside(&self, count: f64) -> Option<String> {
        let word = || self.word(&format!("{count} nodes that began inside {} are still there", self.master));
        (count > 0.0).then(word)
    }

    /// Of tools: those in a body end the increment.
    fn past_end(&self, now: Most) -> Option<String> {
        let Most { size, at } = self.touch.past_end.or_larger(now.size, now.at);
        let is_told = size > 0.0 && self.pair.master.tool().is_some();
        is_told.then(|| {
            self.word(&format!(
                "{size} nodes were behind {}, past an end of its surface (time {at:.6}, the most)",
                self.master
            ))
        })
    }

    fn is_between(&self) -> bool {
        self.touch.between.share > self.pair.controls.watch_between
    }

    fn between(&self, model: &Model) -> Option<String> {
        let word = || self.touch.between.word(model, self.pair);
        self.is_between().then(|| format!("{}; refine the slave there (time {:.6})", word(), self.touch.deepest_at))
    }

    fn yielded(&self) -> Option<String> {
        let Most { size, at } = self.touch.yielded;
        let is_told =
            self.facets(size) > self.pair.controls.watch_yields && self.pair.rules.method != Enforcement::Penalty;
        is_told.then(|| {
            self.word(&format!(
                "a node that stands on one of the other side, to which it leaves the contact, was {size:.3e} deep in {}, {:.1e} of a \
                 facet (time {at:.6}), and forces lack what it would take to push it out: `discretization = \"one-pass\"` or \
                 `\"segment\"` do not",
                self.master,
                self.facets(size)
            ))
        })
    }

    fn slid(&self) -> Option<String> {
        let Loss { share, from, to, at } = self.touch.slid;
        (share > self.pair.controls.watch_slid).then(|| {
            self.word(&format!(
                "nodes slid off the end of {} with {:.0} % of its force, which went from {from:.6e} to {to:.6e} N (time {at:.6}): \
                 between its nodes a slave does not feel where a master ends; extend that, refine the slave, or take \
                 `discretization = \"segment\"`",
                self.master,
                100.0 * share
            ))
        })
    }

    fn rested(&self) -> Option<String> {
        let Loss { share, from, to, at } = self.touch.rested;
        (share > LET_GO).then(|| {
            self.word(&format!(
                "nodes that are held along {}, which leans there, let go of friction of {:.1} % of its force as they came to rest, \
                 which went from {from:.6e} to {to:.6e} N (time {at:.6}): let them move and rest in one step, with a `table`",
                self.master,
                100.0 * share
            ))
        })
    }

    fn shared(&self) -> Option<String> {
        let Most { size, at } = self.touch.shared;
        (size > self.pair.controls.watch_shared).then(|| {
            self.word(&format!(
                "nodes that {} and another tool hold by friction at once bear {:.0} % of its force (time {at:.6}): which tool bears \
                 how much of it does not follow from equilibrium; what all tools bear does, and without friction, or with one group \
                 of nodes for each tool, so does each",
                self.master,
                100.0 * size
            ))
        })
    }

    fn jumped(&self) -> Option<String> {
        let Loss { share, from, to, at } = self.touch.jumped;
        (share > 0.0).then(|| {
            self.word(&format!(
                "there was no equilibrium near, and a jump took its force from {from:.6e} to {to:.6e} N (time {at:.6}, the largest): \
                 what it went through on the way is not resolved"
            ))
        })
    }

    fn apart(&self) -> Option<String> {
        let Most { size, at } = self.touch.apart;
        (self.facets(size) > mates::APART).then(|| {
            self.word(&format!(
                "nodes slid {size:.3e} from those of {} that they meet, {:.2} of a facet (time {at:.6}), and forces act there all the \
                 same: \"node-to-node\" is for small sliding, take another `discretization`",
                self.master,
                self.facets(size)
            ))
        })
    }

    /// What penalties and tolerances let nodes be in the master.
    fn gave_way(&self) -> Option<String> {
        let Pair { controls, rules, .. } = self.pair;
        // From segment to segment nodes are in the master by as much as it curves, whatever the penalty.
        let in_the_mean = self.pair.faces.as_ref().map_or(0.0, |_| controls.watch_segment);
        let is_deep = self.facets(self.touch.depth) > controls.watch_deep + in_the_mean;
        let lets_in = match rules.method {
            Enforcement::Penalty => Some(("penalty", "raise `penalty`, or take another method")),
            Enforcement::Uzawa => rules.tolerance.map(|_| ("tolerance", "lower `tolerance`")),
            _ => None,
        };
        lets_in.filter(|_| is_deep).map(|(what, remedy)| {
            self.word(&format!(
                "its {what} let nodes be {:.3e} deep in {}, {:.2} of a facet, and forces lack what it would take to push them out: \
                 {remedy}",
                self.touch.depth,
                self.master,
                self.facets(self.touch.depth)
            ))
        })
    }

    fn let_in(&self) -> Option<String> {
        let Touch { let_in, let_in_at_end, .. } = self.touch;
        let is_at_end = let_in_at_end.share() > let_in.share();
        let LetIn { depth, between, lacks, approach, at } = *if is_at_end { let_in_at_end } else { let_in };
        // What is too deep between nodes whatever else is told of already.
        if lacks <= self.pair.controls.watch_let_in * approach || between && self.is_between() {
            return None;
        }
        let when = if is_at_end { "at the end of a step" } else { "when it bore the most" };
        let master = &self.master;
        let (how, or) = match between {
            true => (format!("its nodes do not feel that between them {master} is {depth:.3e} deep in their body"), ""),
            false => (
                format!("its gaps, closed in the mean over facets, let nodes be {depth:.3e} deep in {master}"),
                ", or `discretization = \"one-pass\"`",
            ),
        };
        let others = if lacks > depth { ", with what other contacts of its bodies let in" } else { "" };
        Some(self.word(&format!(
            "{how}, {:.2} of a facet, {when} (time {at:.6}); both sides have given way by about {approach:.1e}, and where \
             displacements are given forces lack what it would take to give way by {lacks:.1e} more{others}: mesh the slave finer \
             there, or take the finer side as the slave{or}",
            self.facets(depth)
        )))
    }

    /// At the end of a step it would end the run.
    fn unfelt(&self) -> Option<String> {
        let Most { size, at } = self.touch.unfelt;
        (self.facets(size) > self.pair.controls.watch_deep).then(|| {
            self.word(&format!(
                "nodes were {size:.3e} deep in {}, {:.2} of a facet, while no gap was closed in the mean over facets, and it bore nothing \
                 (time {at:.6}, the most): until then forces lack what it would take to push them out; mesh the slave finer there, or \
                 take `discretization = \"one-pass\"`",
                self.master,
                self.facets(size)
            ))
        })
    }

    /// Where nothing held it in between.
    fn went_over(&self) -> Option<String> {
        let Pace { way, facets, share, at, .. } = self.touch.pace;
        (way > 0.0).then(|| {
            self.word(&format!(
                "its nodes or its tool went {way:.3e}, {facets:.2} of a facet, in an increment of {share:.1e} of the step, ten times as far \
                 and more as the increments before (time {at:.6}): nothing held them in between, as where friction is overcome or a \
                 sheet snaps through, and what is shown from there on is where they came to rest again, if that is how they get there; \
                 a motion in place of the force shows what is in between"
            ))
        })
    }

    /// With what share of the contact's largest force sides that nodes do not look at pushed them aside.
    fn share_aside(&self) -> f64 {
        self.touch.aside.size / self.touch.most
    }

    fn aside(&self) -> Option<String> {
        let (share, controls) = (self.share_aside(), &self.pair.controls);
        // More of it ends the run.
        (share > controls.watch_aside && share <= controls.watch_aside_most).then(|| self.word_aside())
    }

    /// How much sides that nodes do not look at pushed them aside, and what helps.
    fn word_aside(&self) -> String {
        let pair = self.pair;
        let other_ways = match (pair.master.tool(), pair.faces.is_some(), pair.pass.other()) {
            (_, true, _) => "",
            (Some(_), ..) | (None, _, Some(_)) => ", or take `discretization = \"segment\"`",
            _ => ", exchange slave and master, or take `discretization = \"two-pass\"` or `\"segment\"`",
        };
        let Most { size, at } = self.touch.aside;
        self.word(&format!(
            "sides of {} that none of the facets around a node looks at pushed nodes aside with {size:.3e} N (time {at:.6}), {:.0} % of \
             the largest force: an edge, or a fillet smaller than a facet, between nodes is felt by those beside it, along the side \
             where they are: give an edge a fillet, and the slave facets of half its radius{other_ways}",
            self.master,
            100.0 * self.share_aside()
        ))
    }
}
