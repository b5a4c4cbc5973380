//! The error in energy: what the recovered fields differ by from those of the elements.

use super::recovery::{Recovered, Values, WIDTH, values_at};
use crate::Vec3;
use crate::error::Result;
use crate::model::elements::{carrying, lost, mine, samples};
use crate::model::{Model, states};
use crate::parallel::{agree, sum};
use crate::solid::element::{Formulation, Inverted, hex8, hex8_shell, hex27, pyramid5, tet10, wedge6, wedge18};
use crate::solid::voigt::double_contraction;
use mpi::topology::SimpleCommunicator;

/// The energy of the error, e^2 = int (tau* - tau) : (h* - h) dV.
#[derive(Clone, Debug, Default)]
pub struct Energy {
    /// Of each element that this rank counts, in their order.
    pub elements: Vec<f64>,
    /// Of each body, over all ranks.
    pub bodies: Vec<OfBody>,
}

/// What is known of a body, over all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfBody {
    /// e^2.
    pub error: f64,
    /// ||u||^2, twice the energy that was stored and dissipated.
    pub energy: f64,
    /// What was dissipated, of the energy.
    pub flown: f64,
    /// Elements of a single layer, of all.
    pub thin: f64,
}

impl OfBody {
    /// e / ||u||; zero where nothing deforms.
    pub fn relative(&self) -> f64 {
        if self.energy > 0.0 { (self.error / self.energy).sqrt() } else { 0.0 }
    }
}

/// (tau* - tau) : (h* - h) at a point.
fn product(recovered: &Values, own: &Values) -> f64 {
    let difference: Values = std::array::from_fn(|k| recovered[k] - own[k]);
    const HALF: usize = WIDTH / 2;
    double_contraction(
        &std::array::from_fn::<_, HALF, _>(|k| difference[k]),
        &std::array::from_fn(|k| difference[HALF + k]),
    )
}

/// That of an element.
fn of_element(model: &Model, recovered: &Recovered, e: usize, u: &[Vec3]) -> Result<f64, Inverted> {
    let (samples, nodes) = (samples(model, e, u)?, carrying(model, &model.part.solids[e]).len());
    let is_shell = model.section(&model.part.solids[e]).element == Formulation::Hex8Shell;
    let mut sum = 0.0;
    for (q, sample) in samples.iter().enumerate() {
        let own = values_at(model, e, q, sample)?;
        let mut add = |weight: f64, shape: &[f64]| sum += weight * product(&recovered.at(model, e, shape), &own);
        match (samples.len(), nodes) {
            // Squares of linear functions want four points.
            (1, _) => tet10::RULE.iter().for_each(|shape| add(0.25 * sample.weight, shape)),
            (_, 18) => add(sample.weight, &wedge18::VALUES[q]),
            (_, 27) => add(sample.weight, &hex27::VALUES[q]),
            (_, 10) => add(sample.weight, &tet10::VALUES[q]),
            (_, 6) => add(sample.weight, &wedge6::VALUES[q]),
            (_, 5) => add(sample.weight, &pyramid5::VALUES[q]),
            (count, 8) if is_shell => add(sample.weight, &hex8_shell::values(q, count / hex8_shell::POINTS)),
            (_, 8) => add(sample.weight, &hex8::VALUES[q]),
            // Both planes of nodes together.
            _ => add(sample.weight, &std::array::from_fn::<_, 4, _>(|a| hex8::VALUES[q][a] + hex8::VALUES[q][a + 4])),
        }
    }
    // Far from small strains the product of two differences may be below zero by a little.
    Ok(sum.max(0.0))
}

impl Energy {
    /// e_K / ||u|| of each element of a body that this rank counts: their squares add up to that of the body.
    pub fn shares(&self, model: &Model, body: usize) -> Vec<f64> {
        let all = self.bodies[body].energy;
        let own = mine(model).zip(&self.elements).filter(|(e, _)| model.part.solids[*e].body as usize == body);
        own.map(|(_, error)| if all > 0.0 { (error / all).sqrt() } else { 0.0 }).collect()
    }

    /// Of a state that has converged, with what has been recovered of it. Collective.
    ///
    /// # Errors
    /// An element that is inverted, by its number.
    pub fn new(comm: &SimpleCommunicator, model: &Model, u: &[Vec3], recovered: &Recovered) -> Result<Self> {
        let of = |e: usize| of_element(model, recovered, e, u).map_err(|_| lost(model, e));
        let elements: Vec<f64> = agree(comm, mine(model).map(of).collect())?;
        let mut sums = vec![[0.0; 5]; model.bodies.len()];
        for (e, error) in mine(model).zip(&elements) {
            let body = &mut sums[model.part.solids[e].body as usize];
            let thin = if recovered.is_thin(model, e) { 1.0 } else { 0.0 };
            body.iter_mut().zip([*error, 0.0, 0.0, thin, 1.0]).for_each(|(sum, value)| *sum += value);
        }
        for (b, body) in sums.iter_mut().enumerate() {
            let [stored, flown] = agree(comm, states::energies(model, u, b))?;
            (body[1], body[2]) = (stored + flown, flown);
        }
        sum(comm, sums.as_flattened_mut());
        // No more than the rounding of energies, as of what has been let go.
        for (body, of) in sums.iter_mut().zip(&model.bodies) {
            let rounding = 16.0 * f64::EPSILON * body[4];
            if body[1] <= 0.5 * of.stiffness * model.size.powi(2) * rounding {
                (body[0], body[1]) = (0.0, 0.0);
            }
        }
        let some = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        let bodies = sums.iter().map(|&[error, energy, flown, thin, count]| OfBody {
            error,
            energy: 2.0 * energy,
            flown: some(flown, energy),
            thin: some(thin, count),
        });
        Ok(Self { elements, bodies: bodies.collect() })
    }
}
