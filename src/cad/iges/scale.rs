//! From the parameter that IGES gives a curve to that of its NURBS form.
//!
//! They are the same for splines. That of a line runs from 0 to 1, that of a circular arc is the angle. An arc here is a
//! chain of n rational quadratic pieces of angle 2a; with x in [0, 1] along such a piece its angle phi from the middle,
//! -a <= phi <= a, is given by
//!
//! ```text
//!     tan(phi/2) = (2x - 1) tan(a/2)
//! ```
//!
//! as both sides are stereographic projections of the circle from the point opposite the middle.

use std::f64::consts::TAU;

/// A monotone map of parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    from: [f64; 2],
    to: [f64; 2],
    /// Number of equal arcs that follow each other; 0 where the map is linear.
    arcs: usize,
    /// The angle a of each.
    half: f64,
    /// True when the file's parameter is an angle itself.
    is_angle: bool,
}

impl Scale {
    /// No change.
    pub fn same(domain: [f64; 2]) -> Self {
        Self::linear(domain, domain)
    }

    /// `from` is mapped on `to` linearly.
    pub fn linear(from: [f64; 2], to: [f64; 2]) -> Self {
        Self { from, to, arcs: 0, half: 0.0, is_angle: false }
    }

    /// The angles `from` become the parameters `to` of `arcs` equal arcs over equal spans.
    pub fn angle(from: [f64; 2], to: [f64; 2], arcs: usize) -> Self {
        Self { from, to, arcs, half: 0.5 * (from[1] - from[0]) / arcs as f64, is_angle: true }
    }

    /// The interval of the file's parameter.
    pub fn domain(&self) -> [f64; 2] {
        self.from
    }

    /// The interval of the mapped parameter.
    pub fn range(&self) -> [f64; 2] {
        self.to
    }

    /// A full turn, where the file's parameter is an angle.
    pub fn turn(&self) -> Option<f64> {
        self.is_angle.then_some(TAU)
    }

    /// The same map for a parameter of the file that runs over `from`.
    pub fn over(self, from: [f64; 2]) -> Self {
        Self { from, is_angle: false, ..self }
    }

    /// True when straight lines stay straight.
    pub fn is_linear(&self) -> bool {
        self.arcs == 0
    }

    /// True when both stretch a common parameter in one way.
    pub fn is_like(&self, other: &Self) -> bool {
        self.arcs == other.arcs && (self.half - other.half).abs() < 1e-12
    }

    /// The mapped parameter with its first and second derivatives. Beyond the ends of arcs it goes on linearly.
    pub fn at(&self, t: f64) -> [f64; 3] {
        if self.arcs == 0 && self.from == self.to {
            return [t, 1.0, 0.0];
        }
        let [from, to] = [self.from, self.to].map(|ends| ends[1] - ends[0]);
        let place = (t - self.from[0]) / from;
        if self.arcs == 0 {
            return [blend(self.to, place), to / from, 0.0];
        }
        let count = self.arcs as f64;
        let along = (place * count).clamp(0.0, count);
        let arc = along.floor().min(count - 1.0);
        let (sin, cos) = (self.half * (along - arc - 0.5)).sin_cos();
        let middle = (0.5 * self.half).tan();
        let x = match along - arc {
            end if end == 0.0 || end == 1.0 => end,
            _ => 0.5 + 0.5 * sin / (cos * middle),
        };
        let slope = 0.5 * self.half / (cos * cos * middle);
        let beyond = place * count - along;
        let curvature = if beyond == 0.0 { 2.0 * self.half * sin / cos * slope } else { 0.0 };
        let value = blend(self.to, (arc + x + beyond * slope) / count);
        [value, slope * to / from, curvature * count * to / (from * from)]
    }
}

/// From the first end (0) to the second (1), exact at both.
fn blend(ends: [f64; 2], t: f64) -> f64 {
    if t < 0.5 { ends[0] + (ends[1] - ends[0]) * t } else { ends[1] - (ends[1] - ends[0]) * (1.0 - t) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn derivatives_match_differences(arcs in 0_usize..4, t in -0.2_f64..1.2, sweep in 0.1_f64..6.0) {
            let from = [0.3, 0.3 + sweep];
            let scale = match arcs {
                0 => Scale::linear(from, [2.0, 5.0]),
                _ => Scale::angle(from, [2.0, 5.0], arcs + 2),
            };
            let t = from[0] + t * sweep;
            let h = 1e-6 * sweep;
            let [at, up, down] = [t, t + h, t - h].map(|t| scale.at(t));
            prop_assert!(((up[0] - down[0]) / (2.0 * h) - at[1]).abs() < 1e-7 * at[1]);
            // The second derivative jumps between arcs, from one size to its opposite.
            let between = (arcs > 0).then(|| (t - from[0]) / sweep * (arcs + 2) as f64);
            prop_assume!(between.is_none_or(|place| (place - place.round()).abs() > 1e-4));
            prop_assert!(((up[1] - down[1]) / (2.0 * h) - at[2]).abs() < 1e-6 * at[1] / sweep);
        }

        #[test]
        fn monotone_and_exact_at_ends_of_arcs(arcs in 1_usize..5, sweep in 0.1_f64..1.5, t in 0.0_f64..1.0) {
            let ends = [-1.0, -1.0 + arcs as f64];
            let scale = Scale::angle([0.0, sweep * arcs as f64], ends, arcs);
            prop_assert_eq!([scale.at(0.0)[0], scale.at(sweep * arcs as f64)[0]], ends);
            for k in 0..=arcs {
                prop_assert!((scale.at(sweep * k as f64)[0] - (k as f64 - 1.0)).abs() < 1e-15 * arcs as f64);
            }
            prop_assert!(scale.at(t * sweep)[0] < scale.at(t * sweep + 1e-9)[0]);
        }
    }
}
