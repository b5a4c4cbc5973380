//! `history.csv` read back: columns over time, compared with those of another run.

use crate::error::{Error, Result};
use std::path::Path;

/// Rows of increments.
#[derive(Clone, Debug, Default)]
pub struct History {
    names: Vec<String>,
    /// Of each row.
    steps: Vec<String>,
    /// By column.
    values: Vec<Vec<f64>>,
}

/// The three components of a vector, by the ends of their columns' names.
pub type Components = [&'static str; 3];

/// Force of a tool, set or contact.
pub const FORCE: Components = ["fx", "fy", "fz"];

/// Displacement of a tool or set.
pub const DISPLACEMENT: Components = ["ux", "uy", "uz"];

/// How far two curves are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    pub largest: f64,
    /// Root of the mean square over time.
    pub rms: f64,
}

impl History {
    /// Reads the file of a run that has ended.
    ///
    /// # Errors
    /// [`Error::System`] when it is not there, or not as `nagata` writes it.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path);
        let history = text.map_err(|e| e.to_string()).and_then(|text| Self::parse(&text).ok_or("is broken".into()));
        history.map_err(|what| Error::System(format!("cannot read {}: {what}", path.display())))
    }

    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let names: Vec<String> = lines.next()?.split(',').skip(1).map(str::to_string).collect();
        let (mut steps, mut values) = (Vec::new(), vec![Vec::new(); names.len()]);
        for line in lines {
            let (step, row) = line.split_once(',')?;
            steps.push(step.to_string());
            let row = row.split(',').map(|cell| cell.parse().ok()).collect::<Option<Vec<f64>>>()?;
            if row.len() != names.len() {
                return None;
            }
            values.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        }
        (!steps.is_empty()).then_some(Self { names, steps, values })
    }

    /// A column, a value an increment.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|known| known == name).map(|k| self.values[k].as_slice())
    }

    /// Time at the end of each increment.
    pub fn times(&self) -> &[f64] {
        self.column("time").unwrap_or_default()
    }

    /// The rows of the last increments of the steps, with the names of the steps.
    pub fn ends(&self) -> Vec<(&str, usize)> {
        let last = |k: &usize| self.steps.get(k + 1) != Some(&self.steps[*k]);
        (0..self.steps.len()).filter(last).map(|k| (self.steps[k].as_str(), k)).collect()
    }

    /// The largest value of columns that end so; `None` without such columns.
    pub fn largest(&self, end: &str) -> Option<f64> {
        let end = format!(".{end}");
        let columns = self.names.iter().zip(&self.values).filter(|(name, _)| name.ends_with(&end));
        columns.flat_map(|(_, values)| values).copied().reduce(f64::max)
    }

    /// Those whose vectors stand in the history: tools, sets, contacts.
    fn sources(&self, of: &Components) -> Vec<&str> {
        let end = format!(".{}", of[0]);
        self.names.iter().filter_map(|name| name.strip_suffix(&end)).collect()
    }

    /// The vectors of a source at all times.
    fn vectors(&self, source: &str, of: &Components) -> Option<Vec<[f64; 3]>> {
        let columns = of.map(|component| self.column(&format!("{source}.{component}")));
        let [Some(x), Some(y), Some(z)] = columns else { return None };
        Some((0..x.len()).map(|k| [x[k], y[k], z[k]]).collect())
    }

    /// How far the vectors of all sources are from those of a reference, over the longest vector of the reference: at the
    /// times of that of the two that has fewer increments in a step, with the other linear between its own. `None` when they
    /// have no source in common, or all vectors of the reference are 0.
    pub fn apart(&self, reference: &Self, of: &Components) -> Option<Apart> {
        let times = self.common_times(reference);
        let (mut largest, mut rms, mut scale) = (0.0f64, 0.0f64, 0.0f64);
        for source in reference.sources(of) {
            let exact = reference.vectors(source, of)?;
            scale = exact.iter().map(norm).fold(scale, f64::max);
            let Some(own) = self.vectors(source, of) else { continue };
            let off = times.iter().map(|&t| {
                let (a, b) = (at(self.times(), &own, t), at(reference.times(), &exact, t));
                norm(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]])
            });
            let apart = Apart::of(&times, &off.collect::<Vec<_>>());
            (largest, rms) = (largest.max(apart.largest), rms.max(apart.rms));
        }
        (scale > 0.0).then(|| Apart { largest: largest / scale, rms: rms / scale })
    }

    /// Times at the ends of increments: step by step of that of the two which has fewer of them.
    fn common_times(&self, other: &Self) -> Vec<f64> {
        let mut times = Vec::new();
        for (step, _) in self.ends() {
            let of = |history: &Self| {
                let rows = history.steps.iter().zip(history.times()).filter(|(name, _)| *name == step);
                rows.map(|(_, &time)| time).collect::<Vec<f64>>()
            };
            let (own, others) = (of(self), of(other));
            times.extend(if others.len() < own.len() { others } else { own });
        }
        times
    }
}

impl Apart {
    /// Of differences at times from 0 on; each stands for the time since the one before.
    pub fn of(times: &[f64], off: &[f64]) -> Self {
        let spans = times.iter().scan(0.0, |last, &time| Some(time - std::mem::replace(last, time)));
        let squares: f64 = spans.zip(off).map(|(span, off)| span * off * off).sum();
        let all = times.last().copied().unwrap_or_default();
        // `max` would pass over what is not a number.
        let largest = off.iter().copied().reduce(|a, b| if b <= a { a } else { b }).unwrap_or_default();
        Self { largest, rms: if all > 0.0 { (squares / all).sqrt() } else { 0.0 } }
    }
}

/// What stands at a time between values at increasing times; 0 at the time 0, and the last value after the last time.
pub fn at<const N: usize>(times: &[f64], values: &[[f64; N]], time: f64) -> [f64; N] {
    let after = times.partition_point(|&t| t < time);
    if after >= times.len() {
        return values.last().copied().unwrap_or([0.0; N]);
    }
    let (begin, first) = if after == 0 { (0.0, [0.0; N]) } else { (times[after - 1], values[after - 1]) };
    let part = if times[after] > begin { (time - begin) / (times[after] - begin) } else { 1.0 };
    std::array::from_fn(|k| first[k] + part * (values[after][k] - first[k]))
}

fn norm([x, y, z]: &[f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force t² of a tool in two steps of so many increments each, with a shift.
    fn square(increments: [usize; 2], shift: f64) -> History {
        let mut text = "step,increment,time,iterations,punch.fx,punch.fy,punch.fz,top.max_penetration\n".to_string();
        for (s, &count) in increments.iter().enumerate() {
            for k in 1..=count {
                let time = s as f64 + k as f64 / count as f64;
                text += &format!("step {s},{k},{time},3,0,{},0,{}\n", time * time + shift, 1e-3 * time);
            }
        }
        History::parse(&text).unwrap()
    }

    #[test]
    fn what_is_read_is_what_stands_there() {
        let history = square([2, 3], 0.0);
        assert_eq!(history.times(), [0.5, 1.0, 1.0 + 1.0 / 3.0, 1.0 + 2.0 / 3.0, 2.0]);
        assert_eq!(history.ends(), [("step 0", 1), ("step 1", 4)]);
        assert_eq!(history.largest("max_penetration"), Some(2e-3));
        assert_eq!(history.largest("max_pressure"), None);
        assert!(History::parse("step,time\n").is_none());
        assert!(History::parse("step,time\na,1,2\n").is_none());
        assert!(History::parse("step,time\na,b\n").is_none());
    }

    /// At common times that both have, the same curve is no error, however many increments there are.
    #[test]
    fn more_increments_on_the_same_curve_are_no_error() {
        let (coarse, fine) = (square([2, 2], 0.0), square([8, 4], 0.0));
        for (run, reference) in [(&coarse, &fine), (&fine, &coarse), (&fine, &fine)] {
            let apart = run.apart(reference, &FORCE).unwrap();
            assert!(apart.largest < 1e-15 && apart.rms < 1e-15, "{apart:?}");
        }
    }

    /// Steps of which each has fewer in another run: a chord of t² lies h²/4 above it midway.
    #[test]
    fn the_other_is_linear_between_its_increments() {
        let apart = square([1, 3], 0.0).apart(&square([2, 2], 0.0), &FORCE).unwrap();
        // At 1 and 1.5 of the one: there the other has a chord from 4/3 to 5/3, 1/36 above.
        assert!((apart.largest - 1.0 / 36.0 / 4.0).abs() < 1e-15, "{apart:?}");
        assert!((apart.rms - 1.0 / 36.0 / 4.0 * 0.25f64.sqrt()).abs() < 1e-15, "{apart:?}");
    }

    #[test]
    fn a_shift_is_over_the_largest_force() {
        let apart = square([4, 4], 0.1).apart(&square([4, 4], 0.0), &FORCE).unwrap();
        assert!((apart.largest - 0.025).abs() < 1e-15 && (apart.rms - 0.025).abs() < 1e-15, "{apart:?}");
        assert_eq!(square([4, 4], 0.1).apart(&square([4, 4], 0.0), &DISPLACEMENT), None);
    }

    #[test]
    fn what_is_not_a_number_is_not_passed_over() {
        assert!(Apart::of(&[1.0, 2.0, 3.0], &[0.0, f64::NAN, 1.0]).largest.is_nan());
    }
}
