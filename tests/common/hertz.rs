//! What the tests against Hertz share: layers of finite depth, and the ellipse through pressures.

use std::f64::consts::PI;

/// Cells of an elastic layer on a smooth base, with smooth walls at a distance `side` from the load, by symmetry and by
/// periodicity.
#[derive(Clone, Copy)]
pub struct Layer {
    pub young: f64,
    pub poisson: f64,
    pub side: f64,
    pub depth: f64,
}

impl Layer {
    pub fn modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }

    /// By how much it sinks under a pressure cos(k x) of one (Johnson, Contact Mechanics, 5.8):
    /// 2 / (E* k) (cosh 2kH - 1) / (sinh 2kH + 2kH).
    fn wave(&self, k: f64) -> f64 {
        let w = 2.0 * (k * self.depth).min(100.0);
        2.0 / (self.modulus() * k) * (w.cosh() - 1.0) / (w.sinh() + w)
    }

    /// The same for an even pressure: H (1 + nu) (1 - 2 nu) / (E (1 - nu)).
    fn even(&self) -> f64 {
        self.depth * (1.0 + self.poisson) * (1.0 - 2.0 * self.poisson) / (self.young * (1.0 - self.poisson))
    }

    /// ```text
    ///          \  R  /           Quarter of a block on rollers on all sides but the top: one cell of a layer of depth H
    ///     ______\_o_/______      on a smooth base, pressed by spheres 2 L apart. On a half space (Hertz) d = a^2 / R and
    ///    |   L       block |     F = 4/3 E* a^3 / R. Under the same load the block's middle goes down by F c more,
    ///    |H                |
    ///    o o o o o o o o o o       c = lim s->0  sum_k (1 / 4 L^2) g(k) exp(-k^2 s^2 / 2)  -  1 / (E* s sqrt(2 pi))
    /// ```
    /// the first term being the Fourier series of the layer under a load spread as a Gauss curve over s, the second the
    /// half space under it. k runs over the wave vectors pi (i, j) / L of the cell. The rest is of order (a / L)^3.
    pub fn softness(&self) -> f64 {
        let spread = 0.02 * self.side;
        let count = (8.0 * self.side / (PI * spread)) as i32;
        let mut sum = self.even();
        for (i, j) in (-count..=count).flat_map(|i| (-count..=count).map(move |j| (i, j))).filter(|&ij| ij != (0, 0)) {
            let k = PI / self.side * f64::from(i).hypot(f64::from(j));
            sum += self.wave(k) * (-0.5 * (k * spread).powi(2)).exp();
        }
        sum / (4.0 * self.side * self.side) - 1.0 / (self.modulus() * spread * (2.0 * PI).sqrt())
    }

    /// By how much the middle goes down, in plane strain, under a force per length that presses as Hertz's on the
    /// half-width `b`, whose transform is 2 J1(kb) / (kb); here by Chebyshev's rule.
    pub fn under_a_strip(&self, force: f64, b: f64) -> f64 {
        let angles: Vec<f64> = (0..200).map(|i| PI * (f64::from(i) + 0.5) / 400.0).collect();
        let weight: f64 = angles.iter().map(|a| a.sin().powi(2)).sum();
        let transform = |kb: f64| angles.iter().map(|a| a.sin().powi(2) * (kb * a.cos()).cos()).sum::<f64>() / weight;
        let waves = (1..(100.0 * self.side / b) as i32).map(|i| PI / self.side * f64::from(i));
        force / (2.0 * self.side) * (self.even() + waves.map(|k| 2.0 * self.wave(k) * transform(k * b)).sum::<f64>())
    }
}

/// Half-axes (a, v0) of v^2 = v0^2 (1 - x^2 / a^2) through the upper half of pairs (x, v).
pub fn ellipse(nodes: &[(f64, f64)]) -> (f64, f64) {
    let highest = nodes.iter().fold(0.0f64, |m, n| m.max(n.1));
    let nodes: Vec<(f64, f64)> = nodes.iter().filter(|n| n.1 > 0.5 * highest).map(|n| (n.0 * n.0, n.1 * n.1)).collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| nodes.iter().map(f).sum::<f64>() / nodes.len() as f64;
    let (x, y) = (mean(&|n| n.0), mean(&|n| n.1));
    let slope = mean(&|n| (n.0 - x) * (n.1 - y)) / mean(&|n| (n.0 - x).powi(2));
    ((x - y / slope).sqrt(), (y - slope * x).sqrt())
}

/// height sqrt(1 - (x / half)^2), zero outside.
pub fn arch(x: f64, half: f64, height: f64) -> f64 {
    height * (1.0 - (x / half).powi(2)).max(0.0).sqrt()
}
