//! Loads that act until they are changed, as those of a deck do: *CLOAD, *DLOAD and *DSLOAD over the steps.

use super::amplitudes::Amplitude;
use crate::error::{Error, Location, Result};
use std::collections::{BTreeMap, BTreeSet};

/// When a step happens.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    /// Time before the step.
    pub before: f64,
    pub period: f64,
}

impl Clock {
    /// The factor of an amplitude at the fraction `s` of the step.
    pub fn factor(&self, amplitude: &Amplitude, s: f64) -> f64 {
        let time = s * self.period;
        amplitude.at(if amplitude.total { self.before + time } else { time })
    }

    /// The fractions of the step, between 0 and 1, at which an amplitude bends.
    pub fn bends<'a>(&'a self, amplitude: &'a Amplitude) -> impl Iterator<Item = f64> + 'a {
        let from = if amplitude.total { self.before } else { 0.0 };
        let fractions = amplitude.times().map(move |time| (time - from) / self.period);
        fractions.filter(|s| *s > 1e-9 && *s < 1.0 - 1e-9)
    }

    /// The factor that an amplitude has all over the step, if it has one.
    pub fn constant(&self, amplitude: &Amplitude) -> Option<f64> {
        let first = self.factor(amplitude, 0.0);
        let same = |s: f64| (self.factor(amplitude, s) - first).abs() <= 1e-12 * first.abs();
        (same(1.0) && self.bends(amplitude).all(same)).then_some(first)
    }
}

/// Vectors on nodes, faces or bodies, by their numbers.
pub(super) type Field = BTreeMap<u32, [f64; 3]>;

/// What one card or one line of it prescribes.
pub(super) struct Load {
    pub at: Location,
    /// A name for what it acts on.
    pub hint: String,
    pub step: usize,
    pub amplitude: Option<usize>,
    /// Without the factor of the amplitude.
    pub values: Field,
    /// At the begin of the step; with an amplitude that of what it takes the place of, too.
    start: Field,
    /// Why it cannot go on, if it does.
    refused: Option<Error>,
}

impl Load {
    pub fn new(at: &Location, hint: String, step: usize, amplitude: Option<usize>) -> Self {
        Self { at: at.clone(), hint, step, amplitude, values: Field::new(), start: Field::new(), refused: None }
    }

    /// At the fraction `s` of the step: by its amplitude, else linear from where it began.
    fn at(&self, s: f64, clock: &Clock, amplitudes: &[Amplitude]) -> Field {
        let mut field = Field::new();
        let mut add = |part: &Field, factor: f64| {
            for (&key, value) in part {
                let sum = field.entry(key).or_insert([0.0; 3]);
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += factor * value);
            }
        };
        match self.amplitude {
            Some(amplitude) => add(&self.values, clock.factor(&amplitudes[amplitude], s)),
            None if self.start == self.values => add(&self.values, 1.0),
            None => {
                add(&self.values, s);
                add(&self.start, 1.0 - s);
            }
        }
        field
    }

    /// Whether its amplitude begins with another load than the last step ended with.
    pub fn jumps(&self, clock: &Clock, amplitudes: &[Amplitude]) -> bool {
        // The digits that programs write.
        const DIGITS: f64 = 1e-9;
        let begin = || self.at(0.0, clock, amplitudes);
        let was = |key: &u32| self.start.get(key).copied().unwrap_or_default();
        let is_other = |(a, b): (&f64, f64)| (a - b).abs() > DIGITS * a.abs().max(b.abs());
        self.amplitude.is_some() && begin().iter().any(|(key, value)| value.iter().zip(was(key)).any(is_other))
    }

    /// Whether it loads something along an axis.
    fn acts(&self, key: u32, axis: usize) -> bool {
        self.values.get(&key).is_some_and(|value| value[axis] != 0.0)
    }
}

/// All loads of a kind.
#[derive(Default)]
pub(super) struct Loads {
    live: Vec<Load>,
    /// Taken off in this step.
    fading: Vec<Load>,
    was_reset: bool,
}

impl Loads {
    /// Goes on to the next step.
    pub fn begin(&mut self, last: &Clock, next: &Clock, amplitudes: &[Amplitude]) {
        self.fading.clear();
        self.was_reset = false;
        for load in &mut self.live {
            load.start = load.at(1.0, last, amplitudes);
            (load.amplitude, load.refused) = carried(load.amplitude, &load.at, last, next, amplitudes);
            if load.amplitude.is_none() {
                load.values.clone_from(&load.start);
            }
        }
    }

    /// After the cards of a step: refuses what goes on and cannot.
    pub fn check(&self) -> Result<()> {
        let goes_on = |load: &&Load| load.values.values().any(|value| *value != [0.0; 3]);
        let refused = self.live.iter().filter(goes_on).find_map(|load| load.refused.clone());
        refused.map_or(Ok(()), Err)
    }

    /// OP=NEW in a step: all that acted until then is taken off; the first such card of a step counts.
    pub fn reset(&mut self, step: usize) {
        if !std::mem::replace(&mut self.was_reset, true) {
            let (new, old) = std::mem::take(&mut self.live).into_iter().partition(|load| load.step == step);
            self.live = new;
            self.fading.extend::<Vec<Load>>(old);
            for load in &mut self.fading {
                load.values.clear();
                load.amplitude = None;
            }
        }
    }

    /// Adds a load along some axes, in the place of what acted there until this step: of one without an amplitude, which goes from
    /// zero to its value, that fades beside it; one with an amplitude is all that acts. Returns what is loaded twice in the step.
    pub fn add(&mut self, mut load: Load, axes: [bool; 3]) -> BTreeSet<u32> {
        let mut twice = BTreeSet::new();
        if load.amplitude.is_some() {
            for old in self.fading.iter_mut().filter(|old| old.step < load.step) {
                for &key in load.values.keys() {
                    let Some(start) = old.start.get_mut(&key) else { continue };
                    for axis in (0..3).filter(|&axis| axes[axis]) {
                        load.start.entry(key).or_insert([0.0; 3])[axis] += std::mem::take(&mut start[axis]);
                    }
                }
            }
        }
        for old in &mut self.live {
            let mut faded = Field::new();
            for &key in load.values.keys() {
                for axis in (0..3).filter(|&axis| axes[axis]) {
                    if old.step == load.step {
                        if old.acts(key, axis) && load.acts(key, axis) {
                            twice.insert(key);
                        }
                        continue;
                    }
                    if let Some(value) = old.values.get_mut(&key) {
                        value[axis] = 0.0;
                    }
                    if let Some(start) = old.start.get_mut(&key) {
                        let goes = if load.amplitude.is_some() { &mut load.start } else { &mut faded };
                        goes.entry(key).or_insert([0.0; 3])[axis] += std::mem::take(&mut start[axis]);
                    }
                }
            }
            if !faded.is_empty() {
                let mut fading = Load::new(&old.at, old.hint.clone(), old.step, None);
                fading.start = faded;
                self.fading.push(fading);
            }
        }
        self.live.push(load);
        twice
    }

    /// What acts at the fraction `s` of the step, by names for what it acts on.
    pub fn at<'a>(
        &'a self,
        s: f64,
        clock: &'a Clock,
        amplitudes: &'a [Amplitude],
    ) -> impl Iterator<Item = (&'a Load, Field)> {
        let all = self.live.iter().chain(&self.fading);
        all.map(move |load| {
            let mut field = load.at(s, clock, amplitudes);
            field.retain(|_, value| *value != [0.0; 3]);
            (load, field)
        })
    }

    /// Those that act.
    pub fn live(&self) -> &[Load] {
        &self.live
    }
}

/// The amplitude of a condition, if it goes on in the next step, and why it cannot, where it has one over the time of the step,
/// on which programs do not agree: its last value stays, or it begins anew.
pub(super) fn carried(
    amplitude: Option<usize>,
    at: &Location,
    last: &Clock,
    next: &Clock,
    amplitudes: &[Amplitude],
) -> (Option<usize>, Option<Error>) {
    let Some(index) = amplitude else { return (None, None) };
    let amplitude = &amplitudes[index];
    if amplitude.total {
        return (Some(index), None);
    }
    match next.constant(amplitude) {
        Some(factor) if factor == last.factor(amplitude, 1.0) => (None, None),
        _ => {
            let what = "the amplitude of this condition is over the time of its step, and another step follows";
            let help = "repeat the condition in the next step, or write the amplitude over the time of all, with TIME=TOTAL TIME";
            (None, Some(Error::input(at, what, help)))
        }
    }
}
