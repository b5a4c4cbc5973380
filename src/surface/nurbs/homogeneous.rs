//! Control points in homogeneous coordinates, where a rational curve or surface is a polynomial.

use nalgebra::SVector;

/// Largest over smallest weight: beyond it, products of weights leave the range of numbers.
const WEIGHT_RANGE: f64 = 1e100;

/// A control point as (w P, w).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous<const D: usize> {
    pub scaled: SVector<f64, D>,
    pub weight: f64,
}

impl<const D: usize> Homogeneous<D> {
    pub fn new(point: &SVector<f64, D>, weight: f64) -> Self {
        Self { scaled: point * weight, weight }
    }

    pub fn zero() -> Self {
        Self { scaled: SVector::zeros(), weight: 0.0 }
    }

    pub fn point(&self) -> SVector<f64, D> {
        self.scaled / self.weight
    }

    /// The point from `self` (t = 0) to `other` (t = 1), exact at both and where they are equal.
    pub fn blend(&self, other: &Self, t: f64) -> Self {
        let (near, far, t) = if t < 0.5 { (self, other, t) } else { (other, self, 1.0 - t) };
        Self {
            scaled: near.scaled + (far.scaled - near.scaled) * t,
            weight: near.weight + (far.weight - near.weight) * t,
        }
    }

    /// Adds `factor` times `other`.
    pub fn add(&mut self, other: &Self, factor: f64) {
        self.scaled += other.scaled * factor;
        self.weight += other.weight * factor;
    }
}

/// Fails unless there are `count` finite points with as many finite, positive weights.
pub fn check<const D: usize>(count: usize, points: &[SVector<f64, D>], weights: &[f64]) -> Result<(), String> {
    if points.len() != count {
        return Err(format!("{} control points, but degrees and knots ask for {count}", points.len()));
    }
    if weights.len() != count {
        return Err(format!("{} weights for {count} control points", weights.len()));
    }
    if let Some(k) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(format!("control point {} has a coordinate that is not a finite number", k + 1));
    }
    if let Some(k) = weights.iter().position(|weight| !(weight.is_finite() && *weight > 0.0)) {
        return Err(format!("weight {} is {}, but must be positive and finite", k + 1, weights[k]));
    }
    let (low, high) = weights.iter().fold((f64::INFINITY, 0.0), |(low, high), w| (w.min(low), w.max(high)));
    if high / WEIGHT_RANGE > low {
        return Err(format!("weights from {low:e} to {high:e} are too far apart"));
    }
    Ok(())
}

/// Lower and upper corner of the box of `points`.
pub fn bounds<const D: usize>(points: &[SVector<f64, D>]) -> (SVector<f64, D>, SVector<f64, D>) {
    let ends = (SVector::repeat(f64::INFINITY), SVector::repeat(f64::NEG_INFINITY));
    points.iter().fold(ends, |(low, high), point| (low.inf(point), high.sup(point)))
}

/// Control points with their weights.
pub fn homogeneous<const D: usize>(points: &[SVector<f64, D>], weights: &[f64]) -> Vec<Homogeneous<D>> {
    points.iter().zip(weights).map(|(point, weight)| Homogeneous::new(point, *weight)).collect()
}

/// Points and weights of `control`.
pub fn separate<const D: usize>(control: &[Homogeneous<D>]) -> (Vec<SVector<f64, D>>, Vec<f64>) {
    control.iter().map(|control| (control.point(), control.weight)).unzip()
}
