//! The gap or overlap that every contact begins with.
//!
//! A node that begins farther inside than the reach of its contact is never found there, and has no force.

use super::sight::Standing;
use super::worst;
use crate::contact::{Interference, Pair};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::scene::Contact;
use mpi::topology::SimpleCommunicator;

/// Depth over the size of a slave facet from which a node was hardly meant to start there.
pub const DEEP: f64 = 0.1;

/// A line about each contact; warns of nodes that begin deep inside. Collective.
///
/// # Errors
/// Nodes so deep inside that they are out of reach.
pub fn check(
    comm: &SimpleCommunicator,
    contacts: &[Contact],
    model: &mut Model,
    sights: &[Vec<Standing>],
) -> Result<Vec<String>> {
    let (mut lines, mut warnings) = (Vec::new(), Vec::new());
    for ((contact, pair), sights) in contacts.iter().zip(&model.pairs).zip(sights) {
        let gaps = || sights.iter().filter_map(Standing::gap);
        let depths = || sights.iter().enumerate().filter_map(|(s, x)| Some((pair.slaves[s].node, -x.contact?.gap)));
        let count = |more: f64| depths().filter(|(_, depth)| *depth > more * pair.facet_size).count() as f64;
        let mut counts = [
            count(pair.controls.no_gap),
            count(DEEP),
            gaps().filter(|g| g.abs() <= pair.controls.no_gap * pair.facet_size).count() as f64,
        ];
        let mut ends =
            [gaps().map(|gap| -gap).fold(f64::NEG_INFINITY, f64::max), depths().map(|(_, d)| d).fold(0.0, f64::max)];
        sum(comm, &mut counts);
        max(comm, &mut ends);
        let ([inside, deep, touching], [nearest, depth]) = (counts, ends);
        lines.push(
            format!("contact `{}` begins with {}", pair.name, told(-nearest, (inside, depth), touching))
                + ramped(pair, inside),
        );
        let too_deep: Vec<(u32, f64)> = depths().filter(|(_, depth)| *depth > pair.reach).collect();
        if let Some(node) = worst(comm, model, &too_deep) {
            let what = format!(
                "contact `{}`: node {node} begins {depth:.3e} inside {}, out of its reach of {:.3e}, where no force \
                 would act on it",
                pair.name,
                model.master_name(pair),
                pair.reach
            );
            return Err(Error::input(&contact.name.at, what, too_deep_for(pair, contact)));
        }
        if deep > 0.0 && pair.rules.interference != Interference::Ramped {
            warnings.push(format!(
                "contact `{}`: {deep} nodes start inside {}, up to {depth:.3e} deep; {}",
                pair.name,
                model.master_name(pair),
                advice(pair, contact)
            ));
        }
    }
    model.warnings.extend(warnings);
    Ok(lines)
}

/// What to do where no force would act on a node.
fn too_deep_for(pair: &Pair, contact: &Contact) -> String {
    let fits = pair.rules.interference == Interference::Ramped || pair.is_within_body();
    let reach = match contact.reach {
        _ if fits => "",
        Some(_) => "; in either case with a larger `reach`, or without one",
        None => ", and a larger `reach`",
    };
    format!("{}{reach}", advice(pair, contact))
}

fn advice(pair: &Pair, contact: &Contact) -> &'static str {
    match (&contact.surface, pair.rules.interference) {
        (_, Interference::Ramped) => "give it a larger `reach`, if so much interference is meant",
        (None, _) => {
            "move the tool out, or turn it over if it is inside out; `interference = \"ramped\"` if a fit is meant"
        }
        (Some(_), _) if pair.is_self() => "give the `thickness` of the sheet",
        (Some(_), _) if pair.is_within_body() => {
            "leave out what lies across the sheet, or name one surface as `slave` and `master`, with the `thickness` of the sheet"
        }
        (Some(_), _) => "move the bodies apart, or give the contact `interference = \"ramped\"` if a fit is meant",
    }
}

fn ramped(pair: &Pair, inside: f64) -> &'static str {
    match pair.rules.interference {
        Interference::Ramped if inside > 0.0 => ", pushed out over the first step",
        _ => "",
    }
}

fn told(least: f64, (inside, depth): (f64, f64), touching: f64) -> String {
    match () {
        _ if inside > 0.0 => format!("{inside} nodes inside, up to {depth:.3e} deep"),
        _ if touching > 0.0 => format!("{touching} nodes that touch"),
        _ if least.is_finite() => format!("a gap of {least:.3e}"),
        _ => "nothing in sight".into(),
    }
}
