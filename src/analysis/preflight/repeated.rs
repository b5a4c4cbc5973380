//! Two contacts of the same faces, by several names, or with exchanged roles. Each makes its own conditions of the same gap, and
//! forces between them are not determined; with two passes, one contact knows of both sides.

use super::sight::Standing;
use crate::contact::Pair;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{any, sum};
use crate::scene::{Contact, Enforcement, Scene};
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

/// The faces of a contact on this rank, by their nodes.
struct Sides {
    slave: BTreeSet<Vec<u32>>,
    /// None of a tool.
    master: BTreeSet<Vec<u32>>,
}

/// Refuses contacts that have faces of both sides in common with another one, whichever of them is the slave. Collective.
///
/// # Errors
/// There are such contacts.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Result<()> {
    let facets = |set: &str| -> BTreeSet<Vec<u32>> {
        let sorted = |nodes: &[u32]| {
            let mut nodes = nodes.to_vec();
            nodes.sort_unstable();
            nodes
        };
        model.set(set).facets.iter().map(|f| sorted(&f.nodes[..f.count as usize])).collect()
    };
    let sides = |contact: &Contact| Sides {
        slave: facets(&contact.slave.value),
        master: contact.surface.iter().flat_map(|_| facets(&contact.master.value)).collect(),
    };
    let sides: Vec<Sides> = scene.contacts.iter().map(sides).collect();
    for (k, second) in scene.contacts.iter().enumerate() {
        for (first, others) in scene.contacts.iter().zip(&sides[..k]) {
            let (name, other) = (&second.name.value, &first.name.value);
            if share(comm, (first, others), (second, &sides[k])) {
                let what = format!(
                    "contact `{name}` has faces of `{}` and `{}` in common with contact `{other}`: both keep them apart, and how \
                     they share the force is not determined",
                    second.slave.value, second.master.value
                );
                return Err(Error::input(&second.slave.at, what, "name each face in one of them"));
            }
            let are_bodies = [first, second].iter().all(|contact| contact.surface.is_some() && !contact.is_self());
            if are_bodies && meet(comm, &others.slave, &sides[k].master) && meet(comm, &others.master, &sides[k].slave)
            {
                let what = format!(
                    "contact `{name}` has faces of `{}` and `{}` in common with contact `{other}`, the other way round: both \
                     keep them apart, and how they share the force is not determined",
                    second.slave.value, second.master.value
                );
                let help = "name each face in one of them, and where both sides are to be slaves give that one \
                            discretization = \"two-pass\"";
                return Err(Error::input(&second.slave.at, what, help));
            }
        }
    }
    Ok(())
}

/// Warns of contacts side by side: nodes on the seam of their slaves meet one master twice. Penalties, and what Uzawa's method makes of
/// them, share the force out. Collective.
pub fn seams(comm: &SimpleCommunicator, model: &mut Model, sights: &[Vec<Standing>]) {
    // Over the size of a facet, and as a cosine: one point, and one side.
    const SAME: f64 = 1e-6;
    const ALIKE: f64 = 0.9;
    let tie = |n: u32| model.part.tie[n as usize];
    let leaves_open = |pair: &Pair| {
        let shares = matches!(pair.rules.method, Enforcement::Penalty | Enforcement::Uzawa);
        !pair.is_self() && !pair.pass.is_second() && (!shares || pair.faces.is_some())
    };
    let mut open: Vec<(&Pair, BTreeMap<u32, &Standing>)> = Vec::new();
    for (pair, sights) in model.pairs.iter().zip(sights).filter(|(pair, _)| leaves_open(pair)) {
        open.push((pair, pair.slaves.iter().map(|slave| tie(slave.node)).zip(sights).collect()));
    }
    let mut warnings = Vec::new();
    for (q, (second, other)) in open.iter().enumerate() {
        // Each of two bodies says what it bears.
        let is_one =
            |first: &Pair| (first.master.tool(), first.master_body()) == (second.master.tool(), second.master_body());
        for (first, one) in open[..q].iter().filter(|(first, _)| is_one(first)) {
            let meets_twice = |(node, a): &(&u32, &&Standing)| {
                let both = a.contact.zip(other.get(*node).and_then(|b| b.contact));
                both.is_some_and(|(a, b)| {
                    a.normal.dot(&b.normal) > ALIKE && (a.point - b.point).norm() <= SAME * second.facet_size
                })
            };
            let mut count = [one.iter().filter(meets_twice).count() as f64];
            sum(comm, &mut count);
            if count[0] > 0.0 {
                warnings.push(format!(
                    "contacts `{}` and `{}` meet {} with {} that they have in common: what each of them bears there, and its \
                     pressure, may be up to rounding, their sum is not; name these faces in one contact",
                    first.name,
                    second.name,
                    model.master_name(second),
                    if count[0] > 1.0 { format!("{} nodes", count[0]) } else { "a node".into() }
                ));
            }
        }
    }
    model.warnings.extend(warnings);
}

/// Whether two contacts have faces of both sides in common, or such of the slave and the tool. Collective.
fn share(comm: &SimpleCommunicator, (first, one): (&Contact, &Sides), (second, other): (&Contact, &Sides)) -> bool {
    let is_one_tool = second.surface.is_none() && first.master.value == second.master.value;
    meet(comm, &one.slave, &other.slave) && (is_one_tool || meet(comm, &one.master, &other.master))
}

/// Whether two sets of faces have some in common. Collective.
fn meet(comm: &SimpleCommunicator, one: &BTreeSet<Vec<u32>>, other: &BTreeSet<Vec<u32>>) -> bool {
    any(comm, !one.is_disjoint(other))
}
