//! Histories compared with those of another run.

pub use crate::output::history::{DISPLACEMENT, FORCE, History};

use crate::output::history::Components;

/// Of the largest force, what is none but rounding.
const NOTHING: f64 = 1e-9;

/// How far two curves are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    pub largest: f64,
    /// Root of the mean square over time.
    pub rms: f64,
}

impl History {
    /// The largest value of columns that end so; `None` without such columns.
    pub fn largest(&self, end: &str) -> Option<f64> {
        let columns = self.sources(end).into_iter().filter_map(|source| self.column(&format!("{source}.{end}")));
        largest(columns.flatten().copied())
    }

    /// The vectors of a source at all times.
    fn vectors(&self, source: &str, of: &Components) -> Option<Vec<[f64; 3]>> {
        let columns = of.map(|component| self.column(&format!("{source}.{component}")));
        let [Some(x), Some(y), Some(z)] = columns else { return None };
        Some((0..x.len()).map(|k| [x[k], y[k], z[k]]).collect())
    }

    /// How far the vectors of all sources are from those of a reference, over the longest vector of the reference: at all times
    /// of the reference, with this run linear between its own increments, and steps that last as long or not. `None` when all
    /// vectors of the reference are 0.
    pub fn apart(&self, reference: &Self, of: &Components) -> Option<Apart> {
        self.apart_at(reference, of, reference.times())
    }

    /// The same at the ends of steps, at which no run is between its increments.
    pub fn apart_at_ends(&self, reference: &Self, of: &Components) -> Option<Apart> {
        let times: Vec<f64> = reference.ends().iter().map(|&(_, row)| reference.times()[row]).collect();
        self.apart_at(reference, of, &times)
    }

    /// Whose vectors count. Where tools and contacts bear forces, those of sets of a body do not: at the edges of a set
    /// supports of others bear a part, which is the smaller the finer the mesh. Those of self-contact sum to nothing.
    fn counted(&self, of: &Components) -> Vec<&str> {
        let sources = self.sources(of[0]);
        let is_met = |source: &&str| !source.contains('.') || self.column(&format!("{source}.active")).is_some();
        let largest_of = |sources: &[&str]| {
            let all = sources.iter().filter_map(|source| self.vectors(source, of)).flatten();
            all.map(|vector| norm(&vector)).fold(0.0, f64::max)
        };
        let met: Vec<&str> = sources.iter().copied().filter(is_met).collect();
        let bears = of == &FORCE && largest_of(&met) > NOTHING * largest_of(&sources);
        if bears { met } else { sources }
    }

    /// The times at which it is as far in its steps as a reference is at its own.
    fn as_far(&self, reference: &Self, times: &[f64]) -> Vec<f64> {
        let bounds = |history: &Self| -> Vec<f64> {
            let ends = history.ends().into_iter().map(|(_, row)| history.times()[row]);
            std::iter::once(0.0).chain(ends).collect()
        };
        let (own, known) = (bounds(self), bounds(reference));
        if own == known || own.len() != known.len() {
            return times.to_vec();
        }
        let of = |&time: &f64| {
            let step = known.partition_point(|&end| end < time).clamp(1, known.len() - 1);
            let share = (time - known[step - 1]) / (known[step] - known[step - 1]);
            own[step - 1] + share * (own[step] - own[step - 1])
        };
        times.iter().map(of).collect()
    }

    fn apart_at(&self, reference: &Self, of: &Components, times: &[f64]) -> Option<Apart> {
        let own_times = self.as_far(reference, times);
        let (mut all, mut rms, mut scale) = (Vec::new(), Vec::new(), 0.0f64);
        for source in reference.counted(of) {
            let exact = reference.vectors(source, of)?;
            scale = exact.iter().map(norm).fold(scale, f64::max);
            let Some(own) = self.vectors(source, of) else { continue };
            let off = times.iter().zip(&own_times).map(|(&t, &own_time)| {
                let (a, b) = (at(self.times(), &own, own_time), at(reference.times(), &exact, t));
                norm(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]])
            });
            let apart = Apart::of(times, &off.collect::<Vec<_>>());
            all.push(apart.largest);
            rms.push(apart.rms);
        }
        let (all, rms) = (largest(all)?, largest(rms)?);
        (scale > 0.0).then(|| Apart { largest: all / scale, rms: rms / scale })
    }
}

impl Apart {
    /// Of differences at times from 0 on; each stands for the time since the one before.
    pub fn of(times: &[f64], off: &[f64]) -> Self {
        let spans = times.iter().scan(0.0, |last, &time| Some(time - std::mem::replace(last, time)));
        let squares: f64 = spans.zip(off).map(|(span, off)| span * off * off).sum();
        let all = times.last().copied().unwrap_or_default();
        let largest = largest(off.iter().copied()).unwrap_or_default();
        Self { largest, rms: if all > 0.0 { (squares / all).sqrt() } else { 0.0 } }
    }
}

/// The largest value, or what is not a number if any is none, which `f64::max` would pass over; `None` without values.
pub fn largest(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    values.into_iter().reduce(|a, b| if a.is_nan() || b <= a { a } else { b })
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
    fn the_largest_is_that_of_all_columns_that_end_so() {
        let history = square([2, 3], 0.0);
        assert_eq!(history.largest("max_penetration"), Some(2e-3));
        assert_eq!(history.largest("max_pressure"), None);
    }

    /// At times that both have, the same curve is no error, however many increments there are.
    #[test]
    fn more_increments_on_the_same_curve_are_no_error() {
        let (coarse, fine) = (square([2, 2], 0.0), square([8, 4], 0.0));
        for apart in [fine.apart(&coarse, &FORCE), fine.apart(&fine, &FORCE), coarse.apart_at_ends(&fine, &FORCE)] {
            let apart = apart.unwrap();
            assert!(apart.largest < 1e-15 && apart.rms < 1e-15, "{apart:?}");
        }
    }

    /// A chord of t^2 over h lies h^2/4 above it midway, from the start on, where forces are 0.
    #[test]
    fn a_run_is_linear_between_its_increments() {
        let apart = square([1, 2], 0.0).apart(&square([2, 2], 0.0), &FORCE).unwrap();
        assert!((apart.largest - 0.25 / 4.0).abs() < 1e-15, "{apart:?}");
        // At one of four times.
        assert!((apart.rms - 0.25 / 4.0 * 0.5).abs() < 1e-15, "{apart:?}");
    }

    /// A step that lasts twice as long, or half as long, is the same step.
    #[test]
    fn steps_are_compared_with_themselves() {
        let stretched = |by: f64| {
            let mut text = "step,increment,time,iterations,punch.fx,punch.fy,punch.fz\n".to_string();
            for (step, force) in [("a", 1.0), ("a", 4.0), ("b", 2.0), ("b", 7.0)] {
                let rows = text.lines().count() as f64;
                let time = if step == "a" { 0.5 * rows } else { 1.0 + by * 0.5 * (rows - 2.0) };
                text += &format!("{step},1,{time},3,0,{force},0\n");
            }
            History::parse(&text).unwrap()
        };
        for by in [0.5, 2.0] {
            let (history, reference) = (stretched(by), stretched(1.0));
            for apart in [history.apart(&reference, &FORCE), history.apart_at_ends(&reference, &FORCE)] {
                assert!(apart.unwrap().largest < 1e-15);
            }
        }
    }

    #[test]
    fn a_shift_is_over_the_largest_force() {
        let apart = square([4, 4], 0.1).apart(&square([4, 4], 0.0), &FORCE).unwrap();
        assert!((apart.largest - 0.025).abs() < 1e-15 && (apart.rms - 0.025).abs() < 1e-15, "{apart:?}");
        assert_eq!(square([4, 4], 0.1).apart(&square([4, 4], 0.0), &DISPLACEMENT), None);
    }

    #[test]
    fn forces_of_sets_count_where_contacts_bear_none() {
        let of = |[more, name]: [&str; 2], base: f64, borne: f64| {
            let head = "step,increment,time,iterations,b.base.fx,b.base.fy,b.base.fz";
            let text = format!("{head},{more},{name}.fx,{name}.fy,{name}.fz\ns,1,1,3,{base},0,0,1,{borne},0,0\n");
            History::parse(&text).unwrap()
        };
        let contact = ["c.active", "c"];
        for (names, borne, expected) in [(contact, 2.0, 0.0), (contact, 0.0, 1.0), (["d", "b.c"], 2.0, 0.5)] {
            let apart = of(names, 2.0, borne).apart(&of(names, 1.0, borne), &FORCE).unwrap();
            assert_eq!(apart.largest, expected);
        }
    }

    #[test]
    fn what_is_not_a_number_is_not_passed_over() {
        assert!(Apart::of(&[1.0, 2.0, 3.0], &[0.0, f64::NAN, 1.0]).largest.is_nan());
        let broken = square([2, 2], f64::NAN);
        assert!(broken.apart(&square([2, 2], 0.0), &FORCE).unwrap().largest.is_nan());
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(values).unwrap().is_nan());
        }
    }
}
