//! How far a converged state may be from the solution of what the scene describes, without a reference.
//!
//! With the Kirchhoff stress tau and the spatial logarithmic strain h = 1/2 ln b at the integration points, and recovered
//! fields tau*, h* in place of the exact ones ([`recovery`]), the error in energy is
//!
//! ```text
//! ||e||^2 = int (tau* - tau) : (h* - h) dV,     ||u||^2 = 2 (stored energy + plastic work)
//! ```
//!
//! over the reference volume. For small elastic strains the first is the square of the energy norm of the error, as tau is
//! linear in h (Zienkiewicz and Zhu, IJNME 24, 1987, 337-357); no modulus has to be chosen where strains are finite or
//! where the material flows, whose stress says little of its strain (Boroomand and Zienkiewicz, CMAME 176, 1999, 127-146).
//!
//! Displacements that are driven: of all that are admissible the solution has the least energy U = ||u||^2 / 2. Those of a mesh
//! are fewer, which costs ||e||^2 / 2; but they are kept out of the master at nodes alone. Between them the master is deeper in
//! the body, which saves the work C of the pressure p on that depth; beyond the last node that touches they gape where they
//! should not, which costs some part of the work E of the pressure on the gaps there ([`pressure`]):
//!
//! ```text
//! U_h - U = ||e||^2 / 2 - C + (0 ... 1) E
//! ```
//!
//! The force is dU/dd, d the displacement. Where U goes with d^n and the error with d^m, the force is off by
//!
//! ```text
//! dF / F = (m / n) (U_h - U) / U
//! ```
//!
//! A contact that does not grow has m = n = 2. Under a ball n = 5/2 and m = 3/2, under a roller 2 and 1, as ||e||^2 goes with
//! h^2 p^2 a^(1 or 0), C with p h^2 / R times the area. Under a given force it is d that is off by as much, the other way.
//!
//! Nodal pressures are compared with their means over the facets around ([`pressure`]), tools with the surface that they stand
//! for ([`facets`]).

pub mod energy;
pub mod facets;
pub mod nodal;
pub mod pressure;
pub mod recovery;

use crate::Vec3;
use crate::contact::Pair;
use crate::model::Model;
use crate::parallel::sum;
use energy::{Energy, OfBody};
use facets::OfTool;
use mpi::topology::SimpleCommunicator;
use pressure::Pressure;

/// What is known of a converged state.
#[derive(Clone, Debug, Default)]
pub struct Estimate {
    pub bodies: Vec<OfBody>,
    /// Of each pair that touches and is no second pass, with its index.
    pub contacts: Vec<(usize, OfContact)>,
    /// Of each tool, where it is made of facets or patches that touch.
    pub tools: Vec<Option<OfTool>>,
}

/// What is known of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfContact {
    /// Error of its force over the force, at given displacements; under a given force that of the displacement.
    pub force: f64,
    /// The size of the force, N.
    pub size: f64,
    pub pressure: Pressure,
}

/// m / n of a contact that grows.
const GROWING: f64 = 0.6;
/// Part of E that counts, as measured in mean.
const EDGE: f64 = 0.2;
/// How well ||e||^2 itself is known, of itself: where it cancels with the others, so much of it remains.
const KNOWN: f64 = 0.2;

/// Error of the force of a contact over the force.
fn force_error(error: f64, energy: f64, pressure: &Pressure) -> f64 {
    let (between, edge) = (2.0 * pressure.chord_work, 2.0 * pressure.edge_work);
    let off = (error - between).abs().max(KNOWN * error) + EDGE * edge;
    let grows = pressure.ends && !pressure.peaks_at_edge;
    if energy > 0.0 { if grows { GROWING * off / energy } else { off / energy } } else { 0.0 }
}

/// The estimate of a state, from the energy of its error; `stiffness` of each tool is dF/dg, where it is known. Collective.
pub fn of(
    comm: &SimpleCommunicator,
    model: &Model,
    energy: &Energy,
    u: &[Vec3],
    stiffness: &[Option<f64>],
) -> Estimate {
    let mut contacts = Vec::new();
    for (p, pair) in model.pairs.iter().enumerate().filter(|(_, pair)| !pair.pass.is_second()) {
        let bodies = connected(model, pair.side.body);
        let [error, all] = [|b: &OfBody| b.error, |b: &OfBody| b.energy]
            .map(|of| bodies.iter().map(|b| of(&energy.bodies[*b])).sum::<f64>());
        // What deforms nothing presses with but what rounding leaves.
        if all > 0.0
            && let Some(pressure) = Pressure::new(comm, model, pair, u)
        {
            let force = force_error(error, all, &pressure);
            contacts.push((p, OfContact { force, size: force_of(comm, pair), pressure }));
        }
    }
    let tools = (0..model.masters.tools.len()).map(|t| OfTool::new(comm, model, t, stiffness[t])).collect();
    Estimate { bodies: energy.bodies.clone(), contacts, tools }
}

/// The bodies that contacts between bodies connect with one: their compliances add up.
fn connected(model: &Model, body: usize) -> Vec<usize> {
    let mut found = vec![body];
    let mut k = 0;
    while k < found.len() {
        for pair in &model.pairs {
            let ends = [Some(pair.side.body), pair.master_body()];
            if ends.contains(&Some(found[k])) {
                found.extend(ends.into_iter().flatten().filter(|b| !found.contains(b)).collect::<Vec<_>>());
            }
        }
        k += 1;
    }
    found
}

/// The size of the force that a pair passes on; in self-contact of what its nodes press with.
fn force_of(comm: &SimpleCommunicator, pair: &Pair) -> f64 {
    let mut force = [0.0; 4];
    for slave in &pair.slaves {
        (0..3).for_each(|d| force[d] += slave.accepted.force[d]);
        force[3] += slave.accepted.force.norm();
    }
    sum(comm, &mut force);
    if pair.is_self() { force[3] } else { Vec3::new(force[0], force[1], force[2]).norm() }
}
