//! What no contact names: nodes of a body that are no slaves of a tool that other nodes of it meet, bodies that come through a
//! tool that others meet, and bodies that come to lie beyond a plane of symmetry, in their own mirror image. Nothing holds them
//! off. The first and the last end the increment; a body that no contact brings together with a tool may be meant so, and is told
//! of.
//!
//! Nodes are watched as slave nodes are ([`crate::contact::watch`]), by their places alone, but for those that began inside;
//! and only where they may have come as far as the tool was.

use super::watch::{allowance, attend, reach};
use crate::Vec3;
use crate::contact::watch::{Allowance, Side, View, first_sight, judge};
use crate::contact::{Ground, Master, Pair, Sight};
use crate::model::Model;
use crate::parallel::{any, max, word_of_largest};
use crate::scene::{Enforcement, body_of};
use crate::system::dofs::node_name;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// The nodes of a body that its contacts with a tool do not name.
#[derive(Clone, Debug)]
pub(super) struct Strays {
    /// The first of these contacts; if there are none, the first of that tool.
    pair: usize,
    body: usize,
    /// That the tool, which the body has no contact with, came into it: told once, when the increment is accepted.
    is_in: bool,
    pub told: Option<String>,
    nodes: Vec<Stray>,
}

#[derive(Clone, Copy, Debug)]
struct Stray {
    /// An owned one.
    node: u32,
    /// What was last seen of it. If it was too far away to be looked at, it has lost its normal, and its gap is what is left of it
    /// after all ways since.
    sight: Sight,
    /// It has gone in, less deep than is told of.
    is_in: bool,
}

/// Those of all tools and bodies at displacements `u`, of which the tools see what is near. Collective.
pub(super) fn strays(comm: &SimpleCommunicator, model: &mut Model, u: &[Vec3]) -> Vec<Strays> {
    let tools = 0..model.masters.tools.len();
    let all = tools.flat_map(|t| (0..model.bodies.len()).map(move |body| (t, body)));
    let first = |(t, body): (usize, usize)| {
        let of_tool = || (0..model.pairs.len()).filter(|&p| model.pairs[p].master.tool() == Some(t));
        let own = of_tool().find(|&p| model.pairs[p].side.body == body);
        Some((own.or_else(|| of_tool().next())?, body))
    };
    let firsts: Vec<(usize, usize)> = all.filter_map(first).collect();
    let of = |(p, body): (usize, usize)| {
        let pairs = model.pairs.iter().filter(|pair| pair.master == model.pairs[p].master);
        let slaves: BTreeSet<u32> = pairs.flat_map(|pair| pair.slaves.iter().map(|slave| slave.node)).collect();
        let part = &model.part;
        let own = part.owned_of(body).filter(|&n| part.tie[n] as usize == n).map(|n| n as u32);
        let nodes: Vec<u32> = own.filter(|n| !slaves.contains(n)).collect();
        look(comm, model, p, &nodes, 0.0, u);
        let (pair, may) = (&model.pairs[p], allowed(&model.pairs[p], 0.0));
        let view = View { ground: model.masters.of(pair.master), pair, slave: 0 };
        let sight = |n: u32| first_sight(&view, &(model.part.points[n as usize] + u[n as usize]), &may);
        let nodes = nodes.into_iter().map(|node| Stray { node, sight: sight(node), is_in: false });
        let nodes = nodes.filter(|stray| stray.sight.side == Side::Front).collect();
        Strays { pair: p, body, is_in: false, told: None, nodes }
    };
    let strays = firsts.into_iter().map(of).collect();
    attend(comm, model, u);
    strays
}

/// How deep such nodes may be before they are in: a corner that folds over begins with little, and ways from there must still be
/// lifted off.
fn allowed(pair: &Pair, travel: f64) -> Allowance<'_> {
    Allowance { explained: 0.5 * pair.controls.watch_lift * pair.facet_size, ..allowance(pair, 0.0, travel) }
}

/// How deep slave nodes are that a penalty lets into the tool of a pair, or the mean over facets: nodes beside them are, too.
/// Collective.
fn let_in(comm: &SimpleCommunicator, model: &Model, p: usize) -> f64 {
    let alike = |pair: &&Pair| pair.master == model.pairs[p].master && pair.side.body == model.pairs[p].side.body;
    let gives_way = |pair: &&Pair| pair.rules.method == Enforcement::Penalty || pair.faces.is_some();
    let slaves = model.pairs.iter().filter(alike).filter(gives_way).flat_map(|pair| &pair.slaves);
    let mut deepest = [slaves.map(|slave| slave.sights.judged.depth).fold(0.0, f64::max)];
    max(comm, &mut deepest);
    deepest[0]
}

/// Lets the tool of a pair see what is around these nodes, which have gone so far, instead of what it saw. Collective.
fn look(comm: &SimpleCommunicator, model: &mut Model, p: usize, nodes: &[u32], travel: f64, u: &[Vec3]) {
    let Model { part, masters, pairs, .. } = model;
    let Master::Tool(t) = pairs[p].master else { return };
    let tool = &mut masters.tools[t];
    let points: Vec<Vec3> =
        nodes.iter().map(|&n| tool.trial.inward(&(part.points[n as usize] + u[n as usize]))).collect();
    tool.surface.watch(comm, &points, reach(&pairs[p], travel));
}

/// What is seen of them after an increment between two states, and the deepest in words. Collective.
pub(super) fn stray(
    comm: &SimpleCommunicator,
    model: &mut Model,
    strays: &[Strays],
    [before, after]: [&[Vec3]; 2],
) -> (Vec<Strays>, Option<String>) {
    let (mut told, mut looked): (Option<(usize, u32, f64)>, bool) = (None, false);
    let mut seen = strays.to_vec();
    for Strays { pair: p, body, is_in, told: says, nodes } in seen.iter_mut().filter(|strays| !strays.is_in) {
        let is_foreign = model.pairs[*p].side.body != *body;
        let mut deepest: Option<(u32, f64)> = None;
        let place = |model: &Model, u: &[Vec3], n: u32| model.part.points[n as usize] + u[n as usize];
        let Ground::Tool(tool) = model.masters.of(model.pairs[*p].master) else { continue };
        let way = |n: u32| tool.way(&place(model, before, n), &place(model, after, n)).norm();
        let ways: Vec<f64> = nodes.iter().map(|stray| way(stray.node)).collect();
        let near: Vec<usize> = (0..nodes.len()).filter(|&k| nodes[k].sight.gap <= ways[k]).collect();
        for (Stray { sight, .. }, way) in nodes.iter_mut().zip(&ways).filter(|(stray, way)| stray.sight.gap > **way) {
            let normal = sight.normal.filter(|_| *way == 0.0);
            *sight = Sight { gap: sight.gap - way, normal, ..*sight };
        }
        if !any(comm, !near.is_empty()) {
            continue;
        }
        looked = true;
        let mut travel = [near.iter().map(|&k| ways[k]).fold(0.0, f64::max)];
        max(comm, &mut travel);
        let numbers: Vec<u32> = near.iter().map(|&k| nodes[k].node).collect();
        let let_in = let_in(comm, model, *p);
        look(comm, model, *p, &numbers, travel[0], after);
        let (pair, may) = (&model.pairs[*p], allowed(&model.pairs[*p], travel[0]));
        let view = View { ground: model.masters.of(pair.master), pair, slave: 0 };
        let past = view.ground.past(comm, model.controls.watch_turn, |n| place(model, before, n));
        for k in near {
            let stray = &mut nodes[k];
            let ends = [before, after].map(|u| place(model, u, stray.node));
            let (sight, goes_in) = match stray.is_in {
                true => (first_sight(&view, &ends[1], &may), false),
                false => {
                    let (sight, finding) = judge(&view, &stray.sight, &past, [&ends[0], &ends[1]], &may);
                    (sight, finding.is_some())
                }
            };
            stray.is_in = goes_in || sight.side == Side::Inside;
            stray.sight = Sight { side: if stray.is_in { Side::Front } else { sight.side }, ..sight };
            // One that went through is in front again.
            let tells = goes_in && sight.depth == 0.0 || stray.is_in && sight.depth > let_in + may.explained;
            if tells && sight.depth >= deepest.map_or(0.0, |(_, depth)| depth) {
                deepest = Some((stray.node, sight.depth));
            }
        }
        if is_foreign {
            *says = word_of_foreign(comm, model, *p, deepest);
            *is_in = says.is_some();
        } else if let Some((node, depth)) = deepest.filter(|at| told.is_none_or(|(.., depth)| at.1 >= depth)) {
            told = Some((*p, node, depth));
        }
    }
    if looked {
        attend(comm, model, after);
    }
    let word = |(p, n): (usize, u32)| {
        let pair = &model.pairs[p];
        let (node, master) = (node_name(model, n), model.master_name(pair));
        format!(
            "node {node} is in {master} or went through it, and no force acts on it: it is in none of the faces that \
             contacts of its body with {master} name, such as `{}`; name those around it, too, or end the tool before it \
             (a plane and a cylinder go on for ever, a `profile` and a mesh end)",
            pair.name
        )
    };
    let word = word_of_largest(comm, told.map(|(p, n, depth)| ((p, n), depth)), word);
    (seen, word.map(|(word, _)| word))
}

/// A node of a body in a tool that none of its contacts names, in words. Collective.
fn word_of_foreign(comm: &SimpleCommunicator, model: &Model, p: usize, deepest: Option<(u32, f64)>) -> Option<String> {
    let word = |n: u32| {
        format!(
            "node {} is in {} or went through it, and no contact is between them: add one, or end the tool before it (a plane and \
             a cylinder go on for ever, a `profile` and a mesh end)",
            node_name(model, n),
            model.master_name(&model.pairs[p])
        )
    };
    word_of_largest(comm, deepest, word).map(|(word, _)| word)
}

/// A body that has come to lie beyond a plane of symmetry, in words. Collective.
pub(super) fn beyond(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Option<String> {
    let part = &model.part;
    for plane in &model.symmetry {
        let set = &plane.set.value;
        let body = model.bodies.iter().position(|body| body.name == body_of(set))?;
        // What holds it off under a penalty gives way.
        let gives = |pair: &&Pair| pair.side.body == body && pair.rules.method == Enforcement::Penalty;
        let given =
            model.pairs.iter().filter(gives).flat_map(|pair| &pair.slaves).map(|slave| slave.sights.judged.depth);
        let mut given = [given.fold(0.0, f64::max)];
        max(comm, &mut given);
        let limit = model.controls.watch_mirror * plane.extent.abs() + given[0];
        let inward = plane.normal * plane.extent.signum();
        let depth = |n: usize| inward.dot(&(plane.normal * plane.at - part.points[n] - u[n]));
        let nodes = part.owned_of(body).filter(|&n| part.tie[n] as usize == n);
        let deepest = nodes.map(|n| (n as u32, depth(n))).max_by(|a, b| a.1.total_cmp(&b.1));
        let word = word_of_largest(comm, deepest.filter(|(_, depth)| *depth > limit), |n| {
            format!(
                "node {} lies beyond the plane of symmetry of `{set}`, in the mirror image of its body, where nothing \
                 holds it off: put a tool with a `plane` there, and name the faces that meet it in a contact",
                node_name(model, n)
            )
        });
        if let Some((word, _)) = word {
            return Some(word);
        }
    }
    None
}
