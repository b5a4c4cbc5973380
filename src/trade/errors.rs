//! The errors of a run against another, or against what is known exactly.

use super::fields::{self, Snapshot};
use super::history::{DISPLACEMENT, FORCE, History, at, largest};
use crate::error::{Error, Result};
use crate::scene::{Exact, Known, Located, MaterialModel, Scene};
use std::path::Path;

/// What errors are of. docs/trade.md has what each is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Force,
    ForceRms,
    EndForce,
    Displacement,
    Penetration,
    Pressure,
    PeakPressure,
    Stress,
    PeakStress,
    Strain,
    PeakStrain,
}

use Quantity::*;

impl Quantity {
    /// All of them, in the order of their declaration.
    pub const ALL: [Self; 11] = [
        Force,
        ForceRms,
        EndForce,
        Displacement,
        Penetration,
        Pressure,
        PeakPressure,
        Stress,
        PeakStress,
        Strain,
        PeakStrain,
    ];

    /// What tables call it.
    pub fn name(self) -> &'static str {
        match self {
            Force => "force",
            ForceRms => "force RMS",
            EndForce => "end force",
            Displacement => "displacement",
            Penetration => "penetration",
            Pressure => "pressure",
            PeakPressure => "peak pressure",
            Stress => "stress",
            PeakStress => "peak stress",
            Strain => "strain",
            PeakStrain => "peak strain",
        }
    }

    /// Whether it stands in tables and figures, not in `trade.csv` alone.
    pub fn is_shown(self) -> bool {
        matches!(self, Force | EndForce | Displacement | Penetration | Pressure | Stress | Strain)
    }

    /// Whether its error is its own value, a length, since it should be 0.
    pub fn is_absolute(self) -> bool {
        self == Penetration
    }
}

/// Errors by quantity; `None` where there is nothing to compare.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors([Option<f64>; Quantity::ALL.len()]);

impl Errors {
    pub fn get(&self, of: Quantity) -> Option<f64> {
        self.0[of as usize]
    }

    pub fn set(&mut self, of: Quantity, error: Option<f64>) {
        self.0[of as usize] = error;
    }
}

/// The results of a run that errors are made from.
#[derive(Clone, Debug)]
pub struct Reading {
    history: History,
    ends: Vec<Snapshot>,
}

impl Reading {
    /// The results in the folder of a run that converged.
    ///
    /// # Errors
    /// [`Error::System`] when they cannot be read.
    pub fn new(folder: &Path, scene: &Scene) -> Result<Self> {
        let history = History::read(&folder.join("history.csv"))?;
        let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.name.value.as_str()).collect();
        let contacts: Vec<&str> = scene.contacts.iter().map(|contact| contact.name.value.as_str()).collect();
        let ends = fields::read(&folder.join("fields.h5"), &history, &bodies, &contacts)?;
        Ok(Self { history, ends })
    }

    /// The errors against a reference; what is known exactly takes its place where it can.
    pub fn errors(&self, reference: &Self, exact: &[Exact]) -> Errors {
        let mut errors = self.against(reference);
        if exact.iter().any(|exact| quantity(&exact.of.value) == Some(Force)) {
            errors.set(ForceRms, None);
            errors.set(EndForce, None);
        }
        for of in Quantity::ALL {
            let known = exact.iter().filter(|exact| quantity(&exact.of.value) == Some(of));
            let found: Vec<f64> = known.map(|exact| self.off(exact, reference).unwrap_or(f64::NAN)).collect();
            if let Some(largest) = largest(found) {
                errors.set(of, Some(largest));
            }
        }
        errors
    }

    /// The errors against another run.
    fn against(&self, reference: &Self) -> Errors {
        let mut errors = Errors::default();
        let force = self.history.apart(&reference.history, &FORCE);
        errors.set(Force, force.map(|force| force.largest));
        errors.set(ForceRms, force.map(|force| force.rms));
        let ends = self.history.apart_at_ends(&reference.history, &FORCE);
        errors.set(EndForce, ends.map(|ends| ends.largest));
        let displacement = self.history.apart(&reference.history, &DISPLACEMENT);
        errors.set(Displacement, displacement.map(|displacement| displacement.largest));
        errors.set(Penetration, self.history.largest("max_penetration"));
        if self.ends.len() != reference.ends.len() {
            return errors;
        }
        let pressures = |reading: &Self| rows(&reading.ends, |end| end.pressures.values().copied().collect());
        errors.set(Pressure, relative(&pressures(self), &pressures(reference)));
        errors.set(PeakPressure, relative(&self.peaks(), &reference.peaks()));
        let high = |reading: &Self| rows(&reading.ends, |end| end.bodies.values().map(|b| b.high_stress()).collect());
        errors.set(PeakStress, relative(&high(self), &high(reference)));
        let high = |reading: &Self| {
            rows(&reading.ends, |end| end.bodies.values().filter_map(|body| body.high_strain()).collect())
        };
        errors.set(PeakStrain, relative(&high(self), &high(reference)));
        let [stress, strain] = self.fields_apart(reference);
        errors.set(Stress, stress);
        errors.set(Strain, strain);
        errors
    }

    /// Largest pressures of all contacts at the ends of steps.
    fn peaks(&self) -> Vec<f64> {
        let of = |contact: &String| self.history.column(&format!("{contact}.max_pressure")).unwrap_or_default();
        let contacts = self.ends.first().map(|end| end.pressures.keys()).into_iter().flatten();
        let columns: Vec<&[f64]> = contacts.map(of).collect();
        let at_end = |&(_, row): &(&str, usize)| columns.iter().map(move |c| c.get(row).copied().unwrap_or(f64::NAN));
        self.history.ends().iter().flat_map(at_end).collect()
    }

    /// Root mean square differences of stress and plastic strain over each body, the largest over bodies and ends of steps,
    /// over the largest root mean square of the reference.
    fn fields_apart(&self, reference: &Self) -> [Option<f64>; 2] {
        let (mut off, mut scale) = ([Vec::new(), Vec::new()], [0.0f64; 2]);
        for (end, other) in self.ends.iter().zip(&reference.ends) {
            for (name, exact) in &other.bodies {
                let Some(own) = end.bodies.get(name) else { continue };
                let (stress, strain) = own.apart(exact);
                off[0].push(stress);
                off[1].extend(strain);
                scale[0] = scale[0].max(exact.stress_scale());
                scale[1] = scale[1].max(exact.strain_scale().unwrap_or_default());
            }
        }
        let [stress, strain] = off;
        let over = |off: Vec<f64>, scale: f64| largest(off).filter(|_| scale > 0.0).map(|off| off / scale);
        [over(stress, scale[0]), over(strain, scale[1])]
    }

    /// The error against what is known exactly, relative to it, of a curve at all times of the reference, with this run linear
    /// between its own; `None` when the run has nothing of that name or at these times.
    fn off(&self, exact: &Exact, reference: &Self) -> Option<f64> {
        let (times, values) = self.curve(&exact.of.value)?;
        match &exact.known {
            Known::Value { value, step } => {
                let ends = self.history.ends();
                let row = match step {
                    Some(step) => ends.iter().find(|(name, _)| name == step)?.1,
                    None => ends.last()?.1,
                };
                let end = self.history.times()[row];
                let found = times.iter().position(|&time| time == end)?;
                Some((values[found] - value).abs() / value.abs())
            }
            Known::Curve(points) => {
                let (known_times, known): (Vec<f64>, Vec<[f64; 1]>) = points.iter().map(|p| (p[0], [p[1]])).unzip();
                let scale = known.iter().map(|[value]| value.abs()).fold(0.0, f64::max);
                let (first, last) = (points.first()?, points.last()?);
                let values: Vec<[f64; 1]> = values.into_iter().map(|value| [value]).collect();
                let (asked, _) = reference.curve(&exact.of.value)?;
                let within = asked.into_iter().filter(|time| (first[0]..=last[0]).contains(time));
                let off = within.map(|time| {
                    let exact = if time == first[0] { [first[1]] } else { at(&known_times, &known, time) };
                    (at(&times, &values, time)[0] - exact[0]).abs()
                });
                largest(off).map(|off| off / scale)
            }
        }
    }

    /// A column of the history, or a measure at the ends of steps, over time.
    fn curve(&self, name: &str) -> Option<(Vec<f64>, Vec<f64>)> {
        if let Some(column) = self.history.column(name) {
            return Some((self.history.times().to_vec(), column.to_vec()));
        }
        let (source, measure) = name.rsplit_once('.')?;
        let of = |end: &Snapshot| match measure {
            MEAN_PRESSURE => end.pressures.get(source).copied(),
            HIGH_STRESS => end.bodies.get(source).map(|body| body.high_stress()),
            HIGH_STRAIN => end.bodies.get(source)?.high_strain(),
            _ => None,
        };
        let times = self.history.ends().iter().map(|&(_, row)| self.history.times()[row]).collect();
        Some((times, self.ends.iter().map(of).collect::<Option<Vec<f64>>>()?))
    }
}

/// Measures beside the columns of the history.
const MEAN_PRESSURE: &str = "mean_pressure";
const HIGH_STRESS: &str = "von_mises_99";
const HIGH_STRAIN: &str = "plastic_strain_99";

/// What an exact value is one of.
fn quantity(name: &str) -> Option<Quantity> {
    match name.rsplit_once('.')?.1 {
        "fx" | "fy" | "fz" => Some(Force),
        "ux" | "uy" | "uz" => Some(Displacement),
        "max_pressure" => Some(PeakPressure),
        MEAN_PRESSURE => Some(Pressure),
        HIGH_STRESS => Some(PeakStress),
        HIGH_STRAIN => Some(PeakStrain),
        _ => None,
    }
}

/// The quantity of which something is known exactly.
///
/// # Errors
/// Something that no run of the scene has, in a step that it has not.
pub fn check_exact(exact: &Exact, scene: &Scene) -> Result<Quantity> {
    let name = &exact.of.value;
    let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.name.value.as_str()).collect();
    let contacts: Vec<&str> = scene.contacts.iter().map(|contact| contact.name.value.as_str()).collect();
    let tools = scene.tools.iter().map(|tool| tool.name.value.as_str());
    let moving: Vec<&str> = tools.chain(scene.output.history.iter().map(|set| set.value.as_str())).collect();
    let of_bodies = scene.contacts.iter().filter(|contact| contact.surface.is_some());
    let pushing = moving.iter().copied().chain(of_bodies.map(|contact| contact.name.value.as_str())).collect();
    let (of, sources) = match quantity(name) {
        Some(of @ Force) => (of, pushing),
        Some(of @ Displacement) => (of, moving),
        Some(of @ (Pressure | PeakPressure)) => (of, contacts),
        Some(of @ (PeakStress | PeakStrain)) => (of, bodies),
        _ => {
            let help = format!(
                "what can be: `fx fy fz` and `ux uy uz` of a tool or set of `output.history`, `max_pressure` and \
                 `{MEAN_PRESSURE}` of a contact, `{HIGH_STRESS}` and `{HIGH_STRAIN}` of a body"
            );
            return Err(Error::input(&exact.of.at, format!("`{name}` cannot be compared with something exact"), help));
        }
    };
    let (source, _) = name.rsplit_once('.').unwrap_or((name, ""));
    if !sources.contains(&source) {
        let help = crate::scene::did_you_mean(source, sources);
        return Err(Error::input(&exact.of.at, format!("no run has `{name}`"), help));
    }
    let flows =
        |material: &Located<String>| matches!(scene.material(&material.value), Some(MaterialModel::Plastic { .. }));
    let body = scene.bodies.iter().find(|body| body.name.value == source);
    if of == PeakStrain && !body.is_some_and(|body| body.sections().any(flows)) {
        let what = format!("`{source}` has no plastic strain: none of its materials flows");
        return Err(Error::input(&exact.of.at, what, "compare something else, or give it a plastic material"));
    }
    let ends: f64 = scene.steps.iter().map(|step| step.duration).sum();
    if let Known::Curve(points) = &exact.known
        && let [first, .., last] = &points[..]
        && (first[0] > ends * (1.0 + 1e-9) || last[0] < 0.0)
    {
        let what = format!("no time of the curve of `{name}` is one of the run, which goes from 0 to {ends}");
        return Err(Error::input(&exact.of.at, what, "its first numbers are times, in the order of the steps"));
    }
    if let Known::Value { step: Some(step), .. } = &exact.known
        && scene.steps.iter().all(|known| known.name.value != *step)
    {
        let help = crate::scene::did_you_mean(step, scene.steps.iter().map(|step| step.name.value.as_str()));
        return Err(Error::input(&exact.of.at, format!("the scene has no step `{step}`"), help));
    }
    Ok(of)
}

/// The values of all ends of steps, one after the other.
fn rows(ends: &[Snapshot], of: impl Fn(&Snapshot) -> Vec<f64>) -> Vec<f64> {
    ends.iter().flat_map(of).collect()
}

/// Largest difference over the largest value of the reference; `None` where there is none but 0.
fn relative(values: &[f64], reference: &[f64]) -> Option<f64> {
    let scale = reference.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let off = values.iter().zip(reference).map(|(a, b)| (a - b).abs());
    largest(off).filter(|_| scale > 0.0 && values.len() == reference.len()).map(|off| off / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_stand_in_their_order() {
        assert!(Quantity::ALL.iter().enumerate().all(|(k, of)| *of as usize == k));
    }

    #[test]
    fn differences_are_over_the_largest_of_the_reference() {
        assert_eq!(relative(&[1.0, 3.5], &[1.0, 4.0]), Some(0.125));
        assert_eq!(relative(&[1.0], &[0.0]), None);
        assert_eq!(relative(&[1.0], &[1.0, 2.0]), None);
        assert!(relative(&[f64::NAN, 1.0], &[1.0, 2.0]).unwrap().is_nan());
    }
}
