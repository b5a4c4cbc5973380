//! Slave nodes that stand exactly under a sharp edge or a tip of what is on the same body, and look at both of its sides.
//!
//! Such a node touches one of the sides, by rounding, slides off along it, and pushes aside what by symmetry stays. Elsewhere it is on
//! both sides, see [`crate::contact::Ground::evenly`]; at the edges of a block nodes look at one side alone.

use super::super::conditions::Conditions;
use super::sight::Standing;
use super::worst;
use crate::Vec3;
use crate::contact::Pair;
use crate::model::Model;
use crate::parallel::{max, sum};
use mpi::topology::SimpleCommunicator;

/// Over the size of a facet, how far it may be from the middle between the sides: coordinates are written with so many digits.
const EXACTLY: f64 = 1e-6;
/// Share of the way along the sides that supports may leave to a node that they hold there.
const HELD: f64 = 0.1;

/// Warns of such nodes, unless supports hold them between the sides in all such `steps`. Collective.
pub fn check(comm: &SimpleCommunicator, model: &mut Model, (steps, sights): (&[Conditions], &[Vec<Standing>])) {
    let mut told = Vec::new();
    // Means over a segment choose no side.
    for (pair, sights) in
        model.pairs.iter().zip(sights).filter(|(pair, _)| pair.faces.is_none() && pair.is_within_body())
    {
        let is_free = |s: usize, across: &Vec3| steps.iter().any(|conditions| left(conditions, pair, s, across) > HELD);
        let sharp = |(s, sight): (usize, &Standing)| {
            let ([a, b], at) = sight.sides.zip(sight.contact)?;
            let cosine = a.dot(&b);
            if 1.0 - cosine <= pair.controls.even_turn {
                return None;
            }
            let across = (a - b).normalize();
            let is_between = (at.gap * at.normal.dot(&across)).abs() <= EXACTLY * pair.facet_size;
            (is_between && is_free(s, &across)).then(|| (pair.slaves[s].node, cosine.clamp(-1.0, 1.0).acos()))
        };
        let found: Vec<(u32, f64)> = sights.iter().enumerate().filter_map(sharp).collect();
        let (mut count, mut most) = ([found.len() as f64], [found.iter().map(|(_, angle)| *angle).fold(0.0, f64::max)]);
        sum(comm, &mut count);
        max(comm, &mut most);
        if let Some(node) = worst(comm, model, &found) {
            told.push(format!(
                "contact `{}` has {} of its slave nodes exactly under a sharp edge or a tip of {}, whose sides are {:.0} degrees apart, as \
                 node {node}: to which side such a node slides is a matter of rounding, and it pushes aside what should stay; round \
                 the edge off, or have no node just there",
                pair.name,
                count[0],
                model.master_name(pair),
                most[0].to_degrees()
            ));
        }
    }
    model.warnings.extend(told);
}

/// How much of a unit vector supports leave to a slave node.
fn left(conditions: &Conditions, pair: &Pair, s: usize, across: &Vec3) -> f64 {
    let n = pair.slaves[s].node as usize;
    let along = conditions.axes.inward(n, across);
    Vec3::from_fn(|d, _| if conditions.prescribed[3 * n + d].is_some() { 0.0 } else { along[d] }).norm()
}
