//! Masters: what slave surfaces meet, of whatever kind, behind one type.
//!
//! A rigid tool is a master of two nodes, its translation and, in the first component, its rotation by a torque. The faces of a body move with the nodes of
//! the mesh. Both say where a slave node meets them, from where its slip counts, what they remember of an accepted
//! increment, how far they have moved, and who gets the forces. Another kind of master is a variant more, here.

use super::element::frame;
use super::meeting::mean_of_pieces;
use super::method::Tangent;
use super::pose::way_past;
use super::segment::ends;
use super::{Beside, BodySurface, Outlook, Pair, Pose, Slave, Status, Tool};
use crate::parallel::max;
use crate::partition::parcels::{bounds, hull};
use crate::surface::projection::descend;
use crate::surface::{
    Even, MovingPatch, NormalOptions, Parametric, Patch, PatchSet, Polygon, Projection, Smoothing, Transfer, Way,
    looks_aslant, shortest,
};
use crate::tool::shape::{Shape, side_normal};
use crate::{Mat3, Vec3};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// What a slave surface meets, by the index of the tool or of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Master {
    /// A rigid tool.
    Tool(usize),
    /// The surface of a body, and what of it.
    Surface(usize, Meets),
}

/// What of the surface of a body slave nodes meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meets {
    /// Its faces.
    Faces,
    /// The faces that they are on themselves.
    Own,
    /// Its nodes, each slave node one for good.
    Nodes,
}

impl Master {
    /// Index of the tool, if it is one.
    pub fn tool(self) -> Option<usize> {
        match self {
            Self::Tool(t) => Some(t),
            _ => None,
        }
    }

    /// Index of the surface of a body, if it is on one.
    pub fn surface(self) -> Option<usize> {
        match self {
            Self::Tool(_) => None,
            Self::Surface(k, _) => Some(k),
        }
    }
}

/// All masters on this rank.
pub struct Masters {
    pub tools: Vec<Tool>,
    /// One for each pair with a deformable master, in their order.
    pub surfaces: Vec<BodySurface>,
}

/// The master of a pair as it is now.
#[derive(Clone, Copy)]
pub enum Ground<'a> {
    Tool(&'a Tool),
    Surface(&'a BodySurface, Meets),
}

/// From where slip is measured.
#[derive(Clone, Copy, Debug)]
pub enum SlipOrigin {
    /// Patch and parameters: the contact point of the last converged increment, which the patch carries along.
    Carried(u32, [f64; 2]),
    /// A place in space.
    Fixed(Vec3),
}

/// Who gets a force on a master.
#[derive(Clone, Copy, Debug)]
pub enum Receiver {
    /// A tool, from this rank's slave nodes.
    Tool(usize),
    /// An owned node, from all ranks.
    Node(u32),
}

/// What a place sees of a master, see [`Masters::seek`].
#[derive(Clone, Copy, Debug)]
pub struct Prospect {
    /// Where a node there would meet it; `None` beyond an end of it.
    pub contact: Option<Projection>,
    /// The normal where it is nearest, ends included, and the distance.
    pub nearest: Option<(Vec3, f64)>,
    /// The normals of both sides of an edge or a tip there, if the place looks at both, and at none squarely.
    pub sides: Option<[Vec3; 2]>,
    /// The component of the mesh that this is on; a tool has none.
    pub component: Option<usize>,
}

impl Prospect {
    /// With the normal of the `side` next to a place that is the most along a direction, whichever its sign, and the distance.
    fn new(
        outward: &Vec3,
        contact: Option<Projection>,
        component: Option<usize>,
        side: impl Fn(&Vec3) -> Option<(Vec3, f64)>,
    ) -> Self {
        let nearest = side(outward);
        let own = nearest.map(|(normal, _)| normal).filter(|own| looks_aslant(outward, own));
        let sides = own.and_then(|own| {
            let across = (own - outward * own.dot(outward)).normalize();
            let (other, _) = side(&(outward + across))?;
            looks_aslant(outward, &other).then_some([own, other])
        });
        Self { contact, nearest, sides, component }
    }
}

impl Masters {
    /// One of them.
    pub fn of(&self, master: Master) -> Ground<'_> {
        match master {
            Master::Tool(t) => Ground::Tool(&self.tools[t]),
            Master::Surface(k, meets) => Ground::Surface(&self.surfaces[k], meets),
        }
    }

    /// Lets every tool, at its trial pose, watch all the slave nodes of its pairs, which `place` puts in space. Says whether
    /// pieces had to be fetched. Collective.
    pub fn watch(&mut self, comm: &SimpleCommunicator, pairs: &[Pair], place: impl Fn(u32) -> Vec3) -> bool {
        self.watch_within(comm, pairs, |p| pairs[p].sight_reach(), place)
    }

    /// Lets every surface follow its nodes at `place` (owned local nodes), and keeps track of all the slave nodes of its
    /// pair. Says whether patches were fetched. Collective.
    pub fn follow(&mut self, comm: &SimpleCommunicator, pairs: &[Pair], place: impl Fn(u32) -> Vec3) -> bool {
        self.follow_within(comm, pairs, |p| pairs[p].sight_reach(), place)
    }

    /// All masters see the slave nodes of their pairs, with nodes at `place`. Collective.
    pub fn attend(&mut self, comm: &SimpleCommunicator, pairs: &[Pair], place: impl Fn(u32) -> Vec3) {
        self.look_out(comm, pairs, |p| pairs[p].sight_reach(), place);
    }

    /// The same within a `reach` of each pair, whatever is its own. Collective.
    pub fn look_out(
        &mut self,
        comm: &SimpleCommunicator,
        pairs: &[Pair],
        reach: impl Fn(usize) -> f64,
        place: impl Fn(u32) -> Vec3,
    ) {
        self.watch_within(comm, pairs, &reach, &place);
        self.follow_within(comm, pairs, reach, place);
    }

    fn watch_within(
        &mut self,
        comm: &SimpleCommunicator,
        pairs: &[Pair],
        reach: impl Fn(usize) -> f64,
        place: impl Fn(u32) -> Vec3,
    ) -> bool {
        let mut fetched = false;
        for (t, tool) in self.tools.iter_mut().enumerate() {
            // What a tool sees is replaced by each look: one for all its pairs.
            let of_tool = || pairs.iter().enumerate().filter(|(_, pair)| pair.master == Master::Tool(t));
            let reach = of_tool().map(|(p, _)| reach(p)).fold(0.0, f64::max);
            fetched |= tool.watch(comm, of_tool().map(|(_, pair)| pair), reach, &place);
        }
        fetched
    }

    fn follow_within(
        &mut self,
        comm: &SimpleCommunicator,
        pairs: &[Pair],
        reach: impl Fn(usize) -> f64,
        place: impl Fn(u32) -> Vec3,
    ) -> bool {
        let mut fetched = false;
        for (p, pair) in pairs.iter().enumerate() {
            if let Some(k) = pair.master.surface() {
                fetched |= self.surfaces[k].follow_pair(comm, pair, reach(p), &place);
            }
        }
        fetched
    }

    /// Remembers where the near nodes of the surfaces were at the last converged increment. Collective.
    pub fn remember(&mut self, comm: &SimpleCommunicator, before: impl Fn(u32) -> Vec3) {
        self.surfaces.iter_mut().for_each(|surface| surface.remember(comm, &before));
    }

    /// Three values for each node of a master that this rank sees: those of the tool, from those of the translations and then
    /// of the rotations of all tools, or those that the owners of nodes give. Collective.
    pub fn gather<T>(
        &self,
        comm: &SimpleCommunicator,
        master: Master,
        of_tools: &[[T; 3]],
        of_node: impl Fn(u32, usize) -> T,
    ) -> Vec<[T; 3]>
    where
        T: mpi::datatype::Equivalence + Copy + Default,
    {
        match master {
            Master::Tool(t) => vec![of_tools[t], of_tools[self.tools.len() + t]],
            Master::Surface(k, _) => self.surfaces[k].gather(comm, of_node),
        }
    }

    /// What points see of a master where it stands, within a reach; `None` where nothing is. Of several normals where it is
    /// nearest that which is the most along the point's `outward` one. Leaves the master with what is near these points: see
    /// [`Self::forget`]. Collective.
    pub fn seek(
        &mut self,
        comm: &SimpleCommunicator,
        master: Master,
        (points, outward): (&[Vec3], &[Vec3]),
        reach: f64,
        place: impl Fn(u32) -> Vec3,
    ) -> Vec<Option<Prospect>> {
        let points_with_normals = points.iter().zip(outward);
        match master {
            Master::Tool(t) => {
                let surface = &mut self.tools[t].surface;
                surface.watch(comm, points, reach);
                let see = |(x, outward): (&Vec3, &Vec3)| {
                    surface.near().nearest(x, reach)?;
                    let contact = surface.project(x, reach, (None, false));
                    Some(Prospect::new(outward, contact, None, |like| surface.near().side_normal(x, like)))
                };
                points_with_normals.map(see).collect()
            }
            Master::Surface(k, _) => {
                let surface = &mut self.surfaces[k];
                surface.follow(comm, points, reach, &BTreeSet::new(), place);
                let (shapes, surface) = (surface.shapes(), &*surface);
                let see = |(x, outward): (&Vec3, &Vec3)| {
                    let beside = shapes.nearest_within(x, reach)?;
                    let contact = shapes.closest(x, reach, None);
                    let component = surface.component(contact.as_ref().unwrap_or(&beside));
                    Some(Prospect::new(outward, contact, component, |like| side_normal(shapes, x, like)))
                };
                points_with_normals.map(see).collect()
            }
        }
    }

    /// Gives back what was sought of a master; the next look fetches it anew.
    pub fn forget(&mut self, master: Master) {
        match master {
            Master::Tool(t) => self.tools[t].surface.forget(),
            Master::Surface(k, _) => self.surfaces[k].forget(),
        }
    }

    /// Hands forces on the nodes of a master that this rank sees to those who have them. Collective.
    pub fn scatter(
        &self,
        comm: &SimpleCommunicator,
        master: Master,
        forces: &[Vec3],
        mut add: impl FnMut(Receiver, Vec3),
    ) {
        match master {
            Master::Tool(t) => forces.iter().take(1).for_each(|force| add(Receiver::Tool(t), *force)),
            Master::Surface(k, _) => {
                self.surfaces[k].add_forces(comm, forces, |n, force| add(Receiver::Node(n), force));
            }
        }
    }

    /// How far the slave nodes of a pair go against its master at most, between places of then and now; the way of a tool that
    /// turns, in parts of `turn` radians, is an arc. What one surface moves against another is bounded by the boxes of their
    /// motions. Collective.
    pub fn travel(
        &self,
        comm: &SimpleCommunicator,
        pair: &Pair,
        turn: f64,
        then: impl Fn(u32) -> Vec3,
        now: impl Fn(u32) -> Vec3,
    ) -> f64 {
        let nodes = || pair.slaves.iter().map(|slave| slave.node);
        match self.of(pair.master) {
            Ground::Tool(tool) => {
                let poses = tool.committed.turning(&tool.trial, turn);
                let way = |n: u32| match poses.is_empty() {
                    true => (tool.trial.inward(&now(n)) - tool.committed.inward(&then(n))).norm(),
                    false => {
                        let way = way_past(&poses, &then(n), &now(n));
                        way.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
                    }
                };
                let mut longest = [nodes().map(way).fold(0.0, f64::max)];
                max(comm, &mut longest);
                longest[0]
            }
            Ground::Surface(surface, _) => {
                let slaves = bounds(nodes().map(|n| now(n) - then(n)));
                match [hull(comm, slaves), hull(comm, surface.travel(then, now))] {
                    [Some((lo, hi)), Some((low, high))] => (hi - low).sup(&(high - lo)).sup(&Vec3::zeros()).norm(),
                    _ => 0.0,
                }
            }
        }
    }
}

impl<'a> Ground<'a> {
    /// In words: "the tool `punch`", "`body.faces`".
    pub fn name(&self) -> String {
        match self {
            Self::Tool(tool) => format!("the tool `{}`", tool.name),
            Self::Surface(surface, _) => format!("`{}`", surface.name),
        }
    }

    /// Number of its nodes that this rank sees.
    pub fn count(&self) -> usize {
        match self {
            Self::Tool(_) => 2,
            Self::Surface(surface, _) => surface.positions().len(),
        }
    }

    /// A patch that moves with nodes, with which of these it has; a tool has none.
    pub fn patch(&self, id: u32) -> Option<(&'a MovingPatch, &'a [u32])> {
        match self {
            Self::Tool(_) => None,
            Self::Surface(surface, _) => surface.patch(id),
        }
    }

    /// The component of the mesh that a point of a body is on; a tool has none.
    pub fn component(&self, at: &Projection) -> Option<usize> {
        match self {
            Self::Tool(_) => None,
            Self::Surface(surface, _) => surface.component(at),
        }
    }

    /// Where its nodes are now, those that this rank sees.
    pub fn position(&self, node: u32) -> Vec3 {
        match self {
            Self::Tool(tool) => tool.place(node),
            Self::Surface(surface, _) => surface.positions()[node as usize],
        }
    }

    /// The name of a node that stays the same, whatever this rank sees.
    pub fn number(&self, node: u32) -> u64 {
        match self {
            Self::Tool(_) => u64::from(node),
            Self::Surface(surface, _) => surface.number(node),
        }
    }

    /// Where a node with such a name is, if this rank sees it.
    pub fn position_of(&self, number: u64) -> Option<Vec3> {
        match self {
            Self::Tool(tool) => Some(tool.place(number as u32)),
            Self::Surface(surface, _) => surface.position(number),
        }
    }

    /// Closest point to slave node `s` of a pair at `x`; the search starts at `warm`. Outside a sharp edge of a body a node
    /// meets one of the edge's sides. One that `keeps` to the patch that it comes from stays on its extension for a while:
    /// where patches meet there is a small kink, between whose sides an iteration could go to and fro.
    pub fn project(
        &self,
        pair: &Pair,
        s: usize,
        x: &Vec3,
        (warm, keeps): (Option<(u32, [f64; 2])>, bool),
    ) -> Option<Projection> {
        let (surface, outlook) = match self {
            Self::Tool(tool) => {
                let found = tool.project(x, pair.reach, (warm, keeps));
                return found.filter(|at| !tool.is_past_end(x, at, pair.overhang()));
            }
            Self::Surface(surface, Meets::Nodes) => return pair.slaves[s].mate.as_ref()?.project(surface, x),
            Self::Surface(surface, Meets::Own) => (surface, pair.outlook(s, x)),
            Self::Surface(surface, Meets::Faces) => (surface, Outlook::everywhere(x)),
        };
        let shapes = surface.shapes();
        let found = on_faces(shapes, pair, warm, &outlook)?;
        let stays = if keeps { shapes.stays(x, warm, &found, (pair.planar, &pair.controls)) } else { None };
        let found = stays.unwrap_or(found);
        let is_seen = pair.must_face(s).is_none_or(|outward| outward.dot(&found.normal) < 0.0);
        (is_seen && !shapes.is_past_end(x, &found, pair.overhang())).then_some(found)
    }

    /// The side of the master through which slave node `s` of a pair, `found` behind it at `x`, came since the last
    /// converged increment, or that it is still on: see [`Way`]; of what comes from another master beside this one, the side that
    /// goes on from that.
    pub fn entrance(&self, pair: &Pair, s: usize, x: &Vec3, found: &Projection) -> Option<Projection> {
        let (slave, sides) = (&pair.slaves[s], pair.sides());
        let place = slave.committed.place?;
        if let Some(over) = self.over_joint(pair, slave, x) {
            return Some(over);
        }
        let normal = slave.accepted.projection.map(|p| p.normal);
        match self {
            Self::Tool(tool) => tool.entrance(x, found, (&place, normal), sides),
            Self::Surface(surface, Meets::Faces) if !pair.is_within_body() => {
                let from = |at: &Projection| {
                    let before = surface.shape_before(at.patch)?;
                    Some(at.point + (place - before.point(at.xi)))
                };
                let way = Way { place: &from, normal, sides };
                way.entrance(x, found, |most| surface.shapes().perpendiculars(x, most, sides.aside))
            }
            Self::Surface(..) => None,
        }
    }

    /// The side of the master onto which a slave node at `x` goes from another one beside it, with much the same normal, as over a
    /// joint: however near the side faces of the joint are, it has not come through them.
    fn over_joint(&self, pair: &Pair, slave: &Slave, x: &Vec3) -> Option<Projection> {
        let came = slave.borne.is_some() && slave.committed.status == Status::Gap;
        let most = pair.controls.hand_over * pair.facet_size;
        let feet = if came { self.perpendiculars(pair, x, (most, pair.sides().aside)) } else { Vec::new() };
        let same = feet.into_iter().filter(|at| slave.goes_over(at, -at.gap, pair.facet_size, &pair.controls));
        same.min_by(|a, b| a.gap.abs().total_cmp(&b.gap.abs()).then(a.patch.cmp(&b.patch)))
    }

    /// Of the sides of the master that a slave node at `x` touches, `found` there, the one that looks at it the most, if that is
    /// another one; it looks `outward`.
    pub fn facing(&self, pair: &Pair, x: &Vec3, found: &Projection, outward: &Vec3) -> Option<Projection> {
        let sides = pair.sides();
        sides.facing(found, outward, |most| self.perpendiculars(pair, x, (most, sides.aside)))
    }

    /// Perpendiculars from a point to all pieces of the master, no longer than `most`, that miss a piece by `aside` at most; none
    /// within a body.
    fn perpendiculars(&self, pair: &Pair, x: &Vec3, (most, aside): (f64, f64)) -> Vec<Projection> {
        match self {
            Self::Tool(tool) => tool.perpendiculars(x, most, aside),
            Self::Surface(surface, Meets::Faces) if !pair.is_within_body() => {
                surface.shapes().perpendiculars(x, most, aside)
            }
            Self::Surface(..) => Vec::new(),
        }
    }

    /// The normals of two sides of the master that both touch a slave node at `x`, to `near`, where these meet in a hollow edge
    /// sharper than `even_turn` of the [controls](crate::controls).
    pub fn hollow(&self, pair: &Pair, x: &Vec3, near: f64) -> Option<[Vec3; 2]> {
        let feet = self.perpendiculars(pair, x, (near, near));
        let turns = |a: &Vec3, b: &Vec3| a.dot(b) < 1.0 - pair.controls.even_turn;
        let first = feet.first()?.normal;
        let most = feet.iter().map(|at| at.normal).min_by(|a, b| a.dot(&first).total_cmp(&b.dot(&first)))?;
        // Out of a hollow edge both sides stay in sight, out of an edge that sticks out neither.
        let out = (first + most).try_normalize(f64::MIN_POSITIVE).filter(|_| turns(&first, &most))?;
        let seen = self.perpendiculars(pair, &(x + out * (2.0 * near)), (4.0 * near, near * 1e-3));
        let sees = |side: &Vec3| seen.iter().any(|at| at.gap > 0.0 && !turns(&at.normal, side));
        (sees(&first) && sees(&most)).then_some([first, most])
    }

    /// Where slave node `s` of a pair at `x`, which has the point `at`, is exactly between pieces of the master: its points on all of
    /// them, and their shares by the angles that they fill there. The choice of one of them would push it aside. At most one
    /// elsewhere, and in a sharp hollow. One that keeps to the pieces `kept` counts on these, and on their extensions, or on none.
    pub fn evenly(
        &self,
        pair: &Pair,
        (s, x): (usize, &Vec3),
        at: &Projection,
        kept: Option<&[Beside]>,
    ) -> Vec<(Projection, f64)> {
        if !pair.may_be_between() {
            return Vec::new();
        }
        let kept: Option<Vec<u32>> = kept.map(|kept| kept.iter().map(|piece| piece.patch).collect());
        self.between(pair, (x, pair.outward[s]), at, kept.as_deref())
    }

    /// The same of a point of the slave at `x` that looks `outward`.
    fn between(
        &self,
        pair: &Pair,
        (x, outward): (&Vec3, Vec3),
        at: &Projection,
        kept: Option<&[u32]>,
    ) -> Vec<(Projection, f64)> {
        let turn = pair.controls.even_turn;
        let even = Even { turn, outward, reach: pair.reach, extension: None, kept, planar: false };
        let mut found = match self {
            Self::Tool(tool) => tool.evenly(x, at, &even),
            Self::Surface(surface, _) => {
                let extension = Some(pair.controls.edge_beside);
                surface.shapes().evenly(x, at, &Even { extension, planar: pair.planar, ..even })
            }
        };
        let is_sharp = found.iter().any(|(p, _)| p.normal.dot(&found[0].0.normal) < 1.0 - turn);
        if is_sharp && self.hollow(pair, x, at.gap.abs() + pair.controls.touching_gap * pair.facet_size).is_some() {
            return Vec::new();
        }
        let all: f64 = found.iter().map(|(_, angle)| angle).sum();
        found.iter_mut().for_each(|(_, angle)| *angle /= all);
        found
    }

    /// The points of a slave node of a pair at `x` on given pieces of the master, where any two of these make a hollow; none where
    /// they do not.
    pub fn hollow_of(&self, pair: &Pair, x: &Vec3, pieces: &[u32]) -> Vec<Projection> {
        let turn = pair.controls.even_turn;
        match self {
            Self::Tool(tool) => tool.hollow(x, pieces, turn),
            Self::Surface(surface, _) => surface.shapes().hollow(x, pieces, turn),
        }
    }

    /// Closest point to a point of slave face `f` at `x`, which looks along `outward`, where the two look at each other; the search
    /// starts at `warm`. Past the end of a tool, the wall beside the point is not opposite to it; exactly between pieces of it the mean of
    /// these is. On a body points are never there.
    pub fn project_point(
        &self,
        pair: &Pair,
        f: usize,
        (x, outward): (&Vec3, &Vec3),
        warm: Option<(u32, [f64; 2])>,
    ) -> Option<Projection> {
        match self {
            Self::Tool(tool) => {
                let found = tool.project(x, pair.reach, (None, false))?;
                let at = ends::ahead(tool, pair, x, found, outward)?;
                // One side of an edge right under it would push it aside.
                let even = self.between(pair, (x, *outward), &at, None);
                Some(mean_of_pieces(&even, &at).unwrap_or(at))
            }
            Self::Surface(surface, _) => on_faces(surface.shapes(), pair, warm, &pair.outlook_of_face(f, x, outward))
                .filter(|found| ends::looks_back(found, outward)),
        }
    }

    /// Where the slip of a point of slave face `f` counts from, which was at `before` at the last converged increment and looked along
    /// `outward`, and meets the master at `now`: where it was on the master as that was then. Out of reach then, as in
    /// [`Self::slip_origin`].
    pub fn origin_of(&self, pair: &Pair, f: usize, (before, outward): (&Vec3, &Vec3), now: &Projection) -> SlipOrigin {
        let start = Some((now.patch, now.xi));
        match self {
            Self::Tool(tool) => {
                let place = tool.committed.inward(before);
                let normal = tool.trial.rotation.tr_mul(&now.normal);
                // A wall beside it is not what it slides on.
                let same = |p: &Projection| p.normal.dot(&normal) >= ends::STRAIGHT;
                let then = tool.surface.project(&place, pair.reach, (start, false)).filter(same);
                SlipOrigin::Fixed(tool.trial.outward(&then.map_or(place, |p| p.point)))
            }
            Self::Surface(surface, _) => {
                let outlook = pair.outlook_of_face(f, before, outward);
                let then = surface.shapes_before().closest_of(before, pair.reach, start, &outlook);
                let then = then.map(|p| (p.patch, p.xi));
                let (id, xi) = then.or_else(|| beside(surface, before, now)).unwrap_or((now.patch, now.xi));
                SlipOrigin::Carried(id, xi)
            }
        }
    }

    /// Where a slip origin is now.
    pub fn place_of(&self, origin: &SlipOrigin) -> Option<Vec3> {
        match (origin, self) {
            (SlipOrigin::Fixed(place), _) => Some(*place),
            (SlipOrigin::Carried(id, xi), Self::Surface(surface, _)) => Some(surface.shapes().get(*id)?.point(*xi)),
            _ => None,
        }
    }

    /// Where a slave node was at the last converged increment, as seen from the master where it has the point `at` now.
    pub fn start(&self, slave: &Slave, at: &Projection) -> Option<Vec3> {
        let place = slave.committed.place?;
        match self {
            Self::Tool(tool) => Some(tool.trial.outward(&place)),
            Self::Surface(surface, _) => {
                let before = surface.shape_before(at.patch)?;
                Some(at.point + (place - before.point(at.xi)))
            }
        }
    }

    /// Where slip is measured from: where the node was on the master at the last converged increment. One that was out of
    /// reach then counts from its own place, carried along by the tool, or beside the patch that it is on `now`; slip sees
    /// no distance along the normal.
    pub fn slip_origin(&self, slave: &Slave, now: &Projection) -> SlipOrigin {
        let surface = match self {
            Self::Tool(tool) => {
                let origin = slave.committed.anchor.or(slave.committed.place);
                return SlipOrigin::Fixed(origin.map_or(Vec3::zeros(), |origin| tool.trial.outward(&origin)));
            }
            Self::Surface(surface, _) => surface,
        };
        if let Some((mate, before)) = slave.mate.zip(slave.committed.place)
            && let Some(place) = mate.slip_origin(surface, &before)
        {
            return SlipOrigin::Fixed(place);
        }
        let kept = slave.committed.warm.filter(|(id, _)| surface.patch(*id).is_some());
        let beside = || beside(surface, &slave.committed.place?, now);
        let (id, xi) = kept.or_else(beside).unwrap_or((now.patch, now.xi));
        SlipOrigin::Carried(id, xi)
    }

    /// The same of a node that was exactly between pieces of a body then: all the places, with their shares. What a tool carries
    /// along is the mean of them.
    pub fn slip_origins(&self, slave: &Slave, now: &Projection) -> Vec<(SlipOrigin, f64)> {
        let several = match self {
            Self::Surface(surface, Meets::Faces) if slave.committed.was_between() => {
                slave.committed.origins().all(|origin| surface.patch(origin.patch).is_some())
            }
            _ => false,
        };
        match several {
            true => slave.committed.origins().map(|at| (SlipOrigin::Carried(at.patch, at.xi), at.share)).collect(),
            false => vec![(self.slip_origin(slave, now), 1.0)],
        }
    }

    /// The shares of a patch's own nodes in the point `at`, with which of its nodes they are; a tool has but one.
    pub fn bearing(&self, at: &Projection) -> impl Iterator<Item = (u32, f64)> + Clone + 'a {
        let (nodes, weights) = match self.patch(at.patch) {
            None => (&[0][..], std::array::from_fn(|j| if j == 0 { 1.0 } else { 0.0 })),
            Some((patch, stencil)) => (&stencil[..patch.own()], patch.shape_functions(at.xi)),
        };
        nodes.iter().copied().zip(weights)
    }

    /// Whether `at` is where a node of the master, a layer if that is `planar`, stands, within a part of the shortest edge around.
    pub fn is_at_node(&self, planar: bool, at: &Projection, part: f64) -> bool {
        let Some((patch, stencil)) = self.patch(at.patch) else { return false };
        let count = patch.count as usize;
        let place = |k: usize| self.position(stencil[k % count]);
        let shortest = shortest((0..count).map(|k| place(k + 1) - place(k)), planar);
        (0..count).any(|k| (place(k) - at.point).norm() < part * shortest)
    }

    /// Whether forces on it have a potential where there is no friction.
    pub fn has_potential(&self, tangent: Tangent) -> bool {
        match self {
            Self::Tool(_) => true,
            // The normal of a corner turns with nodes that bear nothing.
            Self::Surface(_, Meets::Nodes) => false,
            // The derivatives of a facet by its own nodes are all that there are.
            Self::Surface(surface, Meets::Faces | Meets::Own) => {
                let given = &surface.given;
                tangent == Tangent::Exact
                    && (surface.is_quadratic
                        || given.transfer == Transfer::Variational
                        || given.smoothing == Smoothing::Facet)
            }
        }
    }

    /// How its forces go to its nodes.
    pub fn transfer(&self) -> Transfer {
        match self {
            Self::Tool(_) => Transfer::Bilinear,
            Self::Surface(surface, _) => surface.given.transfer,
        }
    }

    /// The frame that carries a held force along from an accepted iterate, whose contact point is `at`; nodes turn what is in space.
    pub(super) fn carrier(&self, at: Option<&Projection>) -> Mat3 {
        match self {
            Self::Tool(tool) => tool.committed.rotation,
            Self::Surface(_, Meets::Nodes) => Mat3::identity(),
            Self::Surface(surface, _) => at.and_then(|p| surface.frame(p)).unwrap_or_else(Mat3::identity),
        }
    }

    /// The frame that carries a held force along at an iterate, from a point of then: of a tool, or of the patch.
    pub fn frame_at(&self, from: Option<(u32, [f64; 2])>) -> Mat3 {
        let frame = match self {
            Self::Tool(tool) => Some(tool.trial.rotation),
            Self::Surface(surface, _) => from.and_then(|(id, xi)| Some(frame(&surface.shapes().get(id)?.local(xi)))),
        };
        frame.unwrap_or_else(Mat3::identity)
    }

    /// A place as it is remembered: in the frame of the tool, else in space.
    pub fn inward(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Tool(tool) => tool.committed.inward(x),
            _ => *x,
        }
    }

    /// A place of the last iterate in the frame in which the master is looked at: that of the tool, else space.
    pub fn seen_from(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Tool(tool) => tool.trial.inward(x),
            _ => *x,
        }
    }

    /// A place of [that frame](Self::seen_from) in space.
    pub fn in_space(&self, x: &Vec3) -> Vec3 {
        match self {
            Self::Tool(tool) => tool.trial.outward(x),
            _ => *x,
        }
    }

    /// The nearest point, ends included, to slave node `s` at `x` in [that frame](Self::seen_from).
    pub fn nearest(&self, pair: &Pair, s: usize, x: &Vec3, reach: f64) -> Option<Projection> {
        match self {
            Self::Tool(tool) => tool.surface.nearest(x, reach),
            Self::Surface(surface, _) => surface.shapes().nearest_of(x, reach, &pair.outlook(s, x)),
        }
    }

    /// The closest point there, wherever the node comes from; none beside an end.
    pub(super) fn closest(&self, pair: &Pair, s: usize, x: &Vec3, reach: f64) -> Option<Projection> {
        match self {
            Self::Tool(tool) => tool.surface.closest(x, reach),
            Self::Surface(surface, _) => surface.shapes().closest_of(x, reach, None, &pair.outlook(s, x)),
        }
    }

    /// How deep `x` is behind the inside of a patch of a body.
    pub(super) fn depth_behind(&self, patch: u32, x: &Vec3) -> Option<f64> {
        const EDGE: f64 = 1e-6;
        let surface = match self {
            Self::Tool(_) => return None,
            Self::Surface(surface, _) => surface,
        };
        let patch = surface.shapes().get(patch)?;
        let foot = patch.closest(x);
        let is_inside = patch.sides(foot.xi).iter().all(|side| *side > EDGE);
        is_inside.then(|| -(x - foot.point).dot(&patch.normal(foot.xi)))
    }

    /// How deep a node may be while it keeps to another piece than that of the point `at`, see [`Self::project`].
    pub(super) fn kink(&self, pair: &Pair, at: &Projection) -> f64 {
        match self {
            Self::Tool(tool) => tool.surface.kink(at.patch),
            Self::Surface(surface, _) => surface.shapes().kink(at.patch, (pair.planar, &pair.controls)),
        }
    }

    /// How far a patch that moves with nodes is from the facet of its nodes, at most. A tool is what its patches are.
    pub fn bulge(&self, patch: u32) -> f64 {
        match self {
            Self::Tool(_) => 0.0,
            Self::Surface(surface, _) => surface.shapes().get(patch).map_or(0.0, Patch::bulge),
        }
    }

    /// How far the arcs that it stands for are from it at one of its points, see [`Patch::off_arc`] and [`PatchSet::off_chord`]; exact
    /// shapes are not.
    pub fn off_arc(&self, at: &Projection) -> f64 {
        let of = |patches: &PatchSet, is_quadratic: bool| {
            patches.get(at.patch).map_or(0.0, |patch| patch.off_arc(at.xi, is_quadratic))
        };
        match self {
            Self::Surface(_, Meets::Nodes) => 0.0,
            Self::Surface(surface, _) if surface.given.smoothing == Smoothing::Facet && !surface.is_quadratic => {
                surface.shapes().off_chord(at, surface.given.feature_angle)
            }
            Self::Surface(surface, _) => of(surface.shapes(), surface.is_quadratic),
            Self::Tool(tool) => match tool.surface.near() {
                Shape::Patches(patches) if tool.surface.faceted => {
                    patches.off_chord(at, NormalOptions::default().feature_angle)
                }
                Shape::Patches(patches) => of(patches, false),
                Shape::Faces(_) | Shape::Analytic(_) => 0.0,
            },
        }
    }

    /// How it has moved since the last converged increment, of which `place` gives where nodes were; a tool in parts of which
    /// it turns by no more than `turn`, radians. Collective.
    pub fn past(&self, comm: &SimpleCommunicator, turn: f64, place: impl Fn(u32) -> Vec3) -> Past {
        match self {
            Self::Tool(tool) => Past::Poses(tool.committed.turning(&tool.trial, turn)),
            Self::Surface(surface, _) => Past::Places(surface.places(comm, place)),
        }
    }
}

/// Where a node that was at `before` at the last converged increment was beside the patch that it is on `now`.
fn beside(surface: &BodySurface, before: &Vec3, now: &Projection) -> Option<(u32, [f64; 2])> {
    const BESIDE: f64 = 2.0;
    let shape = surface.shape_before(now.patch)?;
    Some((now.patch, descend(&shape, before, &[BESIDE; 4], shape.center()).xi))
}

/// The point of contact on faces of a body; outside a sharp edge on one of its sides.
fn on_faces(shapes: &PatchSet, pair: &Pair, warm: Option<(u32, [f64; 2])>, outlook: &Outlook) -> Option<Projection> {
    let found = shapes.closest_of(outlook.x, pair.reach, warm, outlook)?;
    Some(shapes.beside_edge(outlook.x, &found, pair.controls.edge_beside).unwrap_or(found))
}

/// How a master has come to where it is.
pub enum Past {
    /// Poses of a tool that turns, on its way; none of one that does not.
    Poses(Vec<Pose>),
    /// Where the nodes were that this rank sees.
    Places(Vec<Vec3>),
}
