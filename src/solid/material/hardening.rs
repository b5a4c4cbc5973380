//! Hardening: the yield stress as a function of the equivalent plastic strain e.
//!
//! ```text
//! linear   Y = Y0 + H e
//! Swift    Y = K (e0 + e)^n
//! Voce     Y = Y0 + H e + (Y1 - Y0) (1 - exp(-r e))
//! table    linear between points, constant after the last
//! ```
//!
//! Plastic flow at yield does the work Y de per volume, so that the plastic work is the integral of Y.

use super::model::Hardening;

impl Hardening {
    /// Y(e), above 0.
    pub fn stress(&self, e: f64) -> f64 {
        match self {
            Self::Linear { yield_stress, modulus } => yield_stress + modulus * e,
            Self::Swift { k, e0, n } => k * (e0 + e).powf(*n),
            Self::Voce { yield_stress, saturation, rate, modulus } => {
                yield_stress + modulus * e - (saturation - yield_stress) * (-rate * e).exp_m1()
            }
            Self::Table(points) => match segment(points, e) {
                Ok((from, slope)) => from[1] + slope * (e - from[0]),
                Err(last) => last[1],
            },
        }
    }

    /// dY/de, not below 0; at a point of a table that of what follows.
    pub fn slope(&self, e: f64) -> f64 {
        match self {
            Self::Linear { modulus, .. } => *modulus,
            Self::Swift { k, e0, n } => k * n * (e0 + e).powf(n - 1.0),
            Self::Voce { yield_stress, saturation, rate, modulus } => {
                modulus + (saturation - yield_stress) * rate * (-rate * e).exp()
            }
            Self::Table(points) => segment(points, e).map_or(0.0, |(_, slope)| slope),
        }
    }

    /// The integral of Y from 0 to e.
    pub fn work(&self, e: f64) -> f64 {
        match self {
            Self::Linear { yield_stress, modulus } => (yield_stress + 0.5 * modulus * e) * e,
            Self::Swift { k, e0, n } => k / (n + 1.0) * ((e0 + e).powf(n + 1.0) - e0.powf(n + 1.0)),
            Self::Voce { yield_stress, saturation, rate, modulus } => {
                let rise = saturation - yield_stress;
                (yield_stress + rise + 0.5 * modulus * e) * e + rise * (-rate * e).exp_m1() / rate
            }
            Self::Table(points) => {
                let pieces = points.windows(2).map(|piece| {
                    let width = (e - piece[0][0]).clamp(0.0, piece[1][0] - piece[0][0]);
                    let slope = (piece[1][1] - piece[0][1]) / (piece[1][0] - piece[0][0]);
                    (piece[0][1] + 0.5 * slope * width) * width
                });
                let last = points[points.len() - 1];
                pieces.sum::<f64>() + last[1] * (e - last[0]).max(0.0)
            }
        }
    }
}

/// The beginning and the slope of the segment of a table that holds e, or its last point.
fn segment(points: &[[f64; 2]], e: f64) -> Result<([f64; 2], f64), [f64; 2]> {
    let next = points.partition_point(|point| point[0] <= e).max(1);
    let from = points[next - 1];
    let to = points.get(next).ok_or(from)?;
    Ok((from, (to[1] - from[1]) / (to[0] - from[0])))
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::derivative;
    use super::*;

    #[test]
    fn slope_and_work_belong_to_the_stress() {
        let laws = [
            Hardening::Linear { yield_stress: 3.0, modulus: 2.0 },
            Hardening::Swift { k: 565.32, e0: 0.0071, n: 0.2589 },
            Hardening::Voce { yield_stress: 450.0, saturation: 715.0, rate: 16.93, modulus: 129.24 },
            Hardening::Table(vec![[0.0, 2.0], [0.1, 3.0], [0.4, 3.5]]),
        ];
        for law in &laws {
            assert_eq!(law.work(0.0), 0.0);
            for e in [0.05, 0.25, 0.7] {
                let [slope, stress] = derivative(1e-3, |t| [law.stress(e + t), law.work(e + t)]);
                let scale = law.stress(e);
                assert!((slope - law.slope(e)).abs() < 1e-9 * scale, "{law:?} {e}");
                assert!((stress - law.stress(e)).abs() < 1e-11 * scale, "{law:?} {e}");
            }
        }
        let table = &laws[3];
        assert_eq!([0.0, 0.1, 0.4, 9.0].map(|e| table.stress(e)), [2.0, 3.0, 3.5, 3.5]);
        assert_eq!(table.slope(0.4), 0.0);
        assert!((table.slope(0.1) - 0.5 / 0.3).abs() < 1e-14);
    }
}
