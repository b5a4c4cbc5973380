//! Masters whose normals look away from the slave: tools that are inside out.
//!
//! Where a slave and its master are nearest, their normals oppose each other, and the slave is in front of the master, or
//! a little inside. A slave node that is behind the master, or on it, while both look the same way, would have to go
//! through its own body to meet it; so would one in front of a master that is in its body. When such a node is nearer than
//! every node that faces the master, the master is turned the wrong way: it is no matter whether it is closed, and how far
//! away. Other nodes in front that look the same way say nothing: the upper side of a sheet sees the lower wall of a channel.
//!
//! A tool whose nearest faces all stand across the slave's normals is judged only where it is closed: what is behind such a
//! one is inside it, and no slave is inside with all its nodes.

use super::sight::Standing;
use crate::Vec3;
use crate::contact::Pair;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::locate::held;
use crate::parallel::{any, max};
use crate::scene::Contact;
use crate::surface::Projection;
use mpi::topology::SimpleCommunicator;

/// Cosine between the normals from which both sides look the same way.
const SAME: f64 = 0.5;

/// Refuses contacts whose master looks away. Collective.
pub fn check(
    comm: &SimpleCommunicator,
    contacts: &[Contact],
    model: &mut Model,
    sights: &[Vec<Standing>],
) -> Result<()> {
    for ((contact, pair), sights) in contacts.iter().zip(&model.pairs).zip(sights) {
        if pair.is_within_body() || pair.is_by_nodes() {
            continue;
        }
        let mut least = least(pair, sights);
        let within = within(comm, model, pair, sights);
        least[1] = least[1].max(within);
        max(comm, &mut least);
        let master = model.master_name(pair);
        let in_front = |s: &Standing| s.gap().is_none_or(|gap| gap >= -pair.controls.touching_gap * pair.facet_size);
        if let Some(t) = pair.master.tool()
            && model.masters.tools[t].surface.is_closed(comm)
            && !any(comm, sights.iter().any(in_front))
        {
            let what = format!(
                "contact `{}`: all of `{}` is behind {}, a closed surface, and would pass through it without a force",
                contact.name.value, contact.slave.value, master
            );
            return Err(Error::input(&contact.master.at, what, help(contact)));
        }
        let [facing, behind, away] = least.map(|l| -l);
        if behind.is_finite() && behind < facing - pair.controls.touching_gap * pair.facet_size {
            let what = format!(
                "contact `{}`: {master} looks away from `{}` where they are nearest, {behind:.3e} apart, so that it would \
                 pass through without a force",
                contact.name.value, contact.slave.value
            );
            return Err(Error::input(&contact.master.at, what, help(contact)));
        }
        if !facing.is_finite() && away.is_finite() {
            model.warnings.push(format!(
                "contact `{}`: `{}` and {master} look the same way wherever they are near as meshed: no slave node faces the \
                 master; is the slave the right side of the body?",
                contact.name.value, contact.slave.value
            ));
        }
    }
    Ok(())
}

/// Least distances of nodes that face the master, that are behind it, and of those in front that look away, as negative
/// numbers.
fn least(pair: &Pair, sights: &[Standing]) -> [f64; 3] {
    let mut least = [f64::NEG_INFINITY; 3];
    for sight in sights {
        let (Some((normal, _)), Some(gap)) = (sight.nearest, sight.gap()) else { continue };
        // Beyond an end of the master nothing tells inside from outside.
        let known = sight.contact.is_some();
        let cosine = sight.outward.dot(&normal);
        let kind = match () {
            _ if cosine < 0.0 => 0,
            _ if cosine > SAME && known && gap <= pair.controls.touching_gap * pair.facet_size => 1,
            _ if cosine > SAME => 2,
            _ => continue,
        };
        least[kind] = f64::max(least[kind], -gap.abs());
    }
    least
}

/// The least distance of nodes in front that look away from a master inside their own body, as a negative number.
/// Collective.
fn within(comm: &SimpleCommunicator, model: &Model, pair: &Pair, sights: &[Standing]) -> f64 {
    /// How far behind the master the body is asked for, over the depth of elements: one that lies on the body is not in it.
    const BEHIND: f64 = 0.1;
    let place = |n: u32| model.part.points[n as usize];
    let looks_away = |sight: &&Standing| sight.nearest.is_some_and(|(normal, _)| sight.outward.dot(&normal) > SAME);
    let feet = pair.slaves.iter().zip(sights).filter(|(_, sight)| looks_away(sight));
    let (gaps, points): (Vec<f64>, Vec<Vec3>) = feet
        .filter_map(|(slave, Standing { contact, depth, .. })| {
            let Projection { gap, normal, .. } = (*contact)?;
            (gap > 0.0).then(|| (gap, place(slave.node) - normal * (gap + BEHIND * depth)))
        })
        .unzip();
    let held = held(comm, model, pair.side.body, &points, &place);
    gaps.iter().zip(held).filter(|(_, held)| *held).fold(f64::NEG_INFINITY, |least, (gap, _)| least.max(-gap))
}

fn help(contact: &Contact) -> &'static str {
    match contact.surface {
        None => {
            "normals of a tool point to the bodies: set `flip` (mesh, CAD, profile), turn `normal` over (plane), or \
             change `hollow`"
        }
        Some(_) => "name the faces of the master that look at the slave, or move the bodies apart",
    }
}
