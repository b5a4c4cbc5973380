//! What makes a matrix ill-conditioned, where a factorization has failed: a body that is too thin for its elements, or nearly
//! incompressible, or bodies of very unlike stiffness. Double precision leaves little of a solution then, and it looks as if
//! something could move freely.

use crate::model::{Model, Section};
use crate::parallel::max;
use mpi::topology::SimpleCommunicator;

/// Stiffest over softest response, from which it is told: condition numbers beyond 1e8 leave less than half of the digits.
const MUCH: f64 = 1e8;

/// The worst reason, in words; `None` where there is none. Collective.
pub fn reason(comm: &SimpleCommunicator, model: &Model) -> Option<String> {
    let name = |b: usize| &model.bodies[b].name;
    let aspects = aspects(comm, model).into_iter().enumerate();
    // An element bends with the square of its length over its thickness.
    let thin = aspects.map(|(b, aspect)| {
        (aspect * aspect, format!("the elements of body `{}` are {aspect:.1e} times as long as thick", name(b)))
    });
    let stiff = model.sections.iter().map(|section| {
        let (lambda, mu) = section.material.initial_moduli();
        let ratio = lambda / mu + 2.0 / 3.0;
        let text = format!("body `{}` resists volume change {ratio:.1e} times as much as shear", name(section.body));
        (ratio, format!("{text}: lower its `poisson`"))
    });
    let sections = || model.sections.iter().filter(|section| section.stiffness > 0.0);
    let softer = |a: &&Section, b: &&Section| a.stiffness.total_cmp(&b.stiffness);
    let apart = sections().max_by(softer).zip(sections().min_by(softer)).map(|(most, least)| {
        let ratio = most.stiffness / least.stiffness;
        let [stiff, soft] = [most, least].map(|section| name(section.body));
        let text = match most.body == least.body {
            true => format!("one material of body `{stiff}` is {ratio:.1e} times as stiff as another"),
            false => format!("body `{stiff}` is {ratio:.1e} times as stiff as body `{soft}`"),
        };
        (ratio, text)
    });
    let all = thin.chain(stiff).chain(apart).filter(|(ratio, _)| *ratio > MUCH);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, text)| text)
}

/// The longest over the shortest distance of two nodes of an element, for each body. Collective.
fn aspects(comm: &SimpleCommunicator, model: &Model) -> Vec<f64> {
    let mut aspects = vec![1.0f64; model.bodies.len()];
    for solid in &model.part.solids {
        let (low, high) = model.part.span(solid);
        let aspect = &mut aspects[solid.body as usize];
        *aspect = aspect.max(high / low);
    }
    max(comm, &mut aspects);
    aspects
}
