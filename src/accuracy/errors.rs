//! How far a described surface lies from a reference, piece by piece.
//!
//! For a point P of the surface with normal n, and the point R of the reference nearest to P with normal m,
//!
//! ```text
//!     distance error = (P - R).m,     normal error = angle between n and m, in degrees
//! ```
//!
//! Outside the reference the distance error is positive. Where the reference has an edge, m is the normal of the side that
//! is most like n. On circles and spheres these are the radial and normal errors of section 5.4 of Neto, Oliveira and
//! Menezes 2017. Root mean squares are weighted by area.
//!
//! The dead zones are those of section 6.1.2: of points R + d m and R - d m, whether they have a normal projection onto the
//! surface, on pieces as they are or extended beyond their edges. They are taken over the middles between the samples,
//! because those over an edge of a piece stand for nothing beside it. A projection more than twice as far away as the
//! nearest point belongs to another part of the surface and does not count.

use super::described::{Described, SurfacePoint};
use super::sampling::{Grid, climb};
use crate::Vec3;
use crate::surface::facets::angle;
use crate::tool::Shape;

/// How a surface is measured.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    pub grid: Grid,
    /// Follow the largest errors from the samples to the points where they are largest.
    pub refine: bool,
    /// Distance of the points whose projections are looked for.
    pub distance: Option<f64>,
    /// Extension of the pieces for points without a normal projection, of their parameters.
    pub extension: f64,
}

/// A value, and where it is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extreme {
    pub value: f64,
    pub xi: [f64; 2],
    pub point: [f64; 3],
}

/// Whether a point has a normal projection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projected {
    #[default]
    Normal,
    /// On an extended piece only.
    Extended,
    Dead,
}

/// A sample and its errors.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub point: Vec3,
    pub normal: Vec3,
    /// Its share of the area of the surface.
    pub share: f64,
    pub distance: f64,
    /// Degrees.
    pub angle: f64,
    /// Whether the surface has it; if not, the errors are 0.
    pub held: bool,
}

/// The samples of a piece, in the order of the grid, and between them the points at a distance outside and inside.
#[derive(Clone, Debug)]
pub struct SampledPiece {
    pub id: u32,
    pub triangle: bool,
    pub samples: Vec<Sample>,
    /// Empty without a distance.
    pub cells: Vec<[Projected; 2]>,
}

/// The errors of a piece, or of a whole surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Id of the piece with the extremes: highest and lowest distance error, largest normal error.
    pub pieces: [u32; 3],
    pub highest: Extreme,
    pub lowest: Extreme,
    /// Degrees.
    pub turned: Extreme,
    pub area: f64,
    /// Integrals of the squared errors over the area.
    squares: [f64; 2],
    /// Sum of the areas of the cells between the samples, and of those whose points outside and inside have no normal projection, without and with
    /// extension.
    shared: f64,
    dead: [[f64; 2]; 2],
}

impl Errors {
    /// Length of [`Self::to_array`].
    pub const LEN: usize = 29;

    /// Root mean square of the distance error.
    pub fn distance_rms(&self) -> f64 {
        (self.squares[0] / self.area).sqrt()
    }

    /// Root mean square of the normal error, degrees.
    pub fn angle_rms(&self) -> f64 {
        (self.squares[1] / self.area).sqrt()
    }

    /// Share of the points outside and inside that have no normal projection, without and with extension.
    pub fn dead(&self) -> [[f64; 2]; 2] {
        self.dead.map(|side| side.map(|area| area / self.shared))
    }

    /// The errors of both together.
    pub fn join(&self, other: &Self) -> Self {
        let mut all = *self;
        let mut take = |k: usize, into: &mut Extreme, from: &Extreme, more: bool| {
            if more {
                (*into, all.pieces[k]) = (*from, other.pieces[k]);
            }
        };
        let (mut highest, mut lowest, mut turned) = (self.highest, self.lowest, self.turned);
        take(0, &mut highest, &other.highest, other.highest.value > self.highest.value);
        take(1, &mut lowest, &other.lowest, other.lowest.value < self.lowest.value);
        take(2, &mut turned, &other.turned, other.turned.value > self.turned.value);
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            highest,
            lowest,
            turned,
            area: self.area + other.area,
            squares: add(self.squares, other.squares),
            shared: self.shared + other.shared,
            dead: [add(self.dead[0], other.dead[0]), add(self.dead[1], other.dead[1])],
            ..all
        }
    }

    /// The errors as numbers, to be sent to other ranks.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        for (k, extreme) in [&self.highest, &self.lowest, &self.turned].into_iter().enumerate() {
            array[k] = self.pieces[k].into();
            array[3 + 6 * k] = extreme.value;
            array[4 + 6 * k..6 + 6 * k].copy_from_slice(&extreme.xi);
            array[6 + 6 * k..9 + 6 * k].copy_from_slice(&extreme.point);
        }
        array[21] = self.area;
        array[22..24].copy_from_slice(&self.squares);
        array[24] = self.shared;
        array[25..29].copy_from_slice(self.dead.as_flattened());
        array
    }

    /// The errors of [`Self::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let pair = |k: usize| [array[k], array[k + 1]];
        let extreme = |k: usize| Extreme {
            value: array[3 + 6 * k],
            xi: pair(4 + 6 * k),
            point: std::array::from_fn(|i| array[6 + 6 * k + i]),
        };
        Self {
            pieces: std::array::from_fn(|k| array[k] as u32),
            highest: extreme(0),
            lowest: extreme(1),
            turned: extreme(2),
            area: array[21],
            squares: pair(22),
            shared: array[24],
            dead: [pair(25), pair(27)],
        }
    }
}

/// The errors of a piece and its samples.
pub fn measure(
    surface: &dyn Described,
    piece: usize,
    reference: &Shape,
    sampling: &Sampling,
) -> (Errors, SampledPiece) {
    let (id, triangle) = (surface.id(piece), surface.is_triangle(piece));
    let mut sampled = SampledPiece { id, triangle, samples: Vec::new(), cells: Vec::new() };
    let mut errors = Errors { pieces: [id; 3], ..Errors::default() };
    measure_samples(surface, piece, reference, sampling, &mut errors, &mut sampled.samples);
    if let Some(distance) = sampling.distance {
        for st in sampling.grid.middles() {
            let place = surface.at(piece, st);
            if !place.held {
                sampled.cells.push([Projected::Normal; 2]);
                continue;
            }
            errors.shared += place.area;
            let points = beside(&place.point, reference, distance);
            let projected = points.map(|x| projected(surface, &x, sampling.extension));
            for (dead, projected) in errors.dead.iter_mut().zip(projected) {
                dead[0] += if projected == Projected::Normal { 0.0 } else { place.area };
                dead[1] += if projected == Projected::Dead { place.area } else { 0.0 };
            }
            sampled.cells.push(projected);
        }
    }
    (errors, sampled)
}

/// Distance and normal errors at the samples and where they are largest.
fn measure_samples(
    surface: &dyn Described,
    piece: usize,
    reference: &Shape,
    sampling: &Sampling,
    errors: &mut Errors,
    samples: &mut Vec<Sample>,
) {
    let grid = &sampling.grid;
    let (weights, shares) = (grid.integration_weights(), grid.shares());
    let mut starts = [[0.0; 2]; 3];
    let mut best = [f64::NEG_INFINITY; 3];
    for (k, st) in grid.points().enumerate() {
        let SurfacePoint { point, normal, area, held } = surface.at(piece, st);
        let (distance, angle) = if held { compare(&point, &normal, reference) } else { (0.0, 0.0) };
        for (j, value) in [distance, -distance, angle].into_iter().enumerate() {
            if held && value > best[j] {
                (best[j], starts[j]) = (value, st);
            }
        }
        let weight = weights[k] * area;
        errors.area += weight;
        errors.squares[0] += weight * distance * distance;
        errors.squares[1] += weight * angle * angle;
        samples.push(Sample { point, normal, share: shares[k] * area, distance, angle, held });
    }
    if sampling.refine && errors.area > 0.0 {
        let value = |st: [f64; 2], which: usize| {
            let place = surface.at(piece, st);
            let (distance, angle) = compare(&place.point, &place.normal, reference);
            if place.held { [distance, -distance, angle][which] } else { f64::NEG_INFINITY }
        };
        for k in 0..3 {
            (starts[k], best[k]) = climb(|st| value(st, k), starts[k], best[k], grid.step());
        }
    }
    let extreme = |value: f64, st: [f64; 2]| Extreme {
        value,
        xi: surface.parameters(piece, st),
        point: surface.at(piece, st).point.into(),
    };
    errors.highest = extreme(best[0], starts[0]);
    errors.lowest = extreme(-best[1], starts[1]);
    errors.turned = extreme(best[2], starts[2]);
}

/// Distance and normal error of a point with its normal.
fn compare(point: &Vec3, normal: &Vec3, reference: &Shape) -> (f64, f64) {
    let gap = reference.nearest(point, f64::INFINITY).map_or(f64::NAN, |nearest| nearest.gap);
    let side = reference.side_normal(point, normal);
    (gap, side.map_or(f64::NAN, |(side, _)| angle(normal, &side).to_degrees()))
}

/// The points at a distance from the reference outside and inside, at the foot of `point`.
fn beside(point: &Vec3, reference: &Shape, distance: f64) -> [Vec3; 2] {
    let foot =
        reference.nearest(point, f64::INFINITY).map_or((*point, Vec3::zeros()), |there| (there.point, there.normal));
    [distance, -distance].map(|distance| foot.0 + foot.1 * distance)
}

/// Whether a point has a normal projection on a surface.
pub fn projected(surface: &dyn Described, x: &Vec3, extension: f64) -> Projected {
    let reach = reach(surface.nearest(x).map_or(0.0, |nearest| nearest.gap));
    if surface.normal_projection(x, 0.0, reach).is_some() {
        Projected::Normal
    } else if extension > 0.0 && surface.normal_projection(x, extension, reach).is_some() {
        Projected::Extended
    } else {
        Projected::Dead
    }
}

/// How far away a normal projection may be when the nearest point is at the distance `gap`.
pub fn reach(gap: f64) -> f64 {
    2.0 * gap.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::NormalOptions;
    use crate::surface::PatchSet;
    use crate::surface::analytic::{Cylinder, Sphere};
    use crate::surface::patches_from_mesh;
    use crate::surface::projection::{Extent, Foot};
    use crate::surface::test_meshes::{grid, sphere_patches};
    use crate::surface::{Analytic, Closest, Edge, Local, Parametric, Patch, Piece, PieceSet, Polygon};

    const UNIT: Shape =
        Shape::Analytic(Analytic::Sphere(Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: 1.0, hollow: false }));

    fn sampling(n: usize, refine: bool) -> Sampling {
        Sampling { grid: Grid::new(n), refine, distance: None, extension: 0.05 }
    }

    fn all(surface: &PatchSet, reference: &Shape, sampling: &Sampling) -> Errors {
        let each = |k: usize| measure(surface, k, reference, sampling).0;
        (1..surface.patches().len()).fold(each(0), |errors, k| errors.join(&each(k)))
    }

    /// Facets and patches over a quarter of the unit cylinder about z: the closed forms of the arc,
    /// with b the angle of an element and C = cos(b/2), T = tan(b/2).
    #[test]
    fn arcs_have_the_errors_of_their_closed_forms() {
        let pipe = Cylinder { point: Vec3::zeros(), axis: Vec3::z(), radius: 1.0, hollow: false };
        let pipe = Shape::Analytic(Analytic::Cylinder(pipe));
        for n in [2, 3, 5, 8] {
            let mesh = grid(n, 1, false, |s, t| {
                let a = std::f64::consts::FRAC_PI_2 * s;
                [a.cos(), a.sin(), t]
            });
            let half = std::f64::consts::FRAC_PI_4 / n as f64;
            let options = NormalOptions { feature_angle: 60.0, ..NormalOptions::default() };
            let set = |smoothing| PatchSet::new(patches_from_mesh(&mesh, smoothing, &options, false).unwrap());
            let facets = all(&set(Smoothing::Facet), &pipe, &sampling(13, true));
            let sagitta = 1.0 - half.cos();
            assert!((facets.lowest.value + sagitta).abs() < 1e-14 && facets.highest.value.abs() < 1e-14);
            assert!((facets.turned.value - half.to_degrees()).abs() < 1e-9);
            assert!((facets.area - n as f64 * 2.0 * half.sin()).abs() < 1e-13);
            // Over a chord at the distance C from the centre, x = C tan(a): the mean of a^2.
            let mean = (0..20000).map(|k| (half.tan() * (k as f64 + 0.5) / 20000.0).atan().powi(2)).sum::<f64>() / 2e4;
            assert!((facets.angle_rms() / mean.sqrt().to_degrees() - 1.0).abs() < 1e-4);
            let radial = |k: i32| half.cos() * (half.tan() * (f64::from(k) + 0.5) / 20000.0).hypot(1.0) - 1.0;
            let mean = (0..20000).map(|k| radial(k).powi(2)).sum::<f64>() / 2e4;
            assert!((facets.distance_rms() / mean.sqrt() - 1.0).abs() < 1e-4);
            let nagata = all(&set(Smoothing::Nagata), &pipe, &sampling(13, true));
            assert!((nagata.highest.value / (sagitta * sagitta / (2.0 * half.cos())) - 1.0).abs() < 1e-10);
            let t = half.tan();
            let error = |s: f64| ((t * s).atan() - (t * s / (1.0 + t * t * (1.0 - s * s) / 2.0)).atan()).abs();
            let largest = (0..=100_000).map(|k| error(k as f64 / 1e5)).fold(0.0, f64::max).to_degrees();
            assert!((nagata.turned.value / largest - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn errors_on_the_sphere_are_those_at_the_samples_and_refined_those_of_a_fine_grid() {
        for triangles in [false, true] {
            let set = PatchSet::new(sphere_patches(2, triangles, 1, Smoothing::Nagata));
            let coarse = all(&set, &UNIT, &sampling(13, false));
            let refined = all(&set, &UNIT, &sampling(13, true));
            let fine = all(&set, &UNIT, &sampling(193, false));
            for k in 0..2 {
                let value = |e: &Errors| [e.highest.value, e.turned.value][k];
                assert!(value(&coarse) <= value(&fine) && value(&fine) <= value(&refined) + 1e-15);
                assert!(value(&refined) < value(&fine) * 1.0005, "{k}: {} {}", value(&refined), value(&fine));
            }
            assert!((coarse.area / fine.area - 1.0).abs() < 1e-6);
            assert!((coarse.distance_rms() / fine.distance_rms() - 1.0).abs() < 2e-3);
            assert!((coarse.angle_rms() / fine.angle_rms() - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn extremes_stand_where_they_are_found() {
        let set = PatchSet::new(sphere_patches(3, false, 2, Smoothing::Nagata));
        let errors = all(&set, &UNIT, &sampling(9, true));
        for (k, extreme) in [errors.highest, errors.lowest].iter().enumerate() {
            let piece = (0..set.count()).find(|p| Described::id(&set, *p) == errors.pieces[k]).unwrap();
            let point = set.local(piece, extreme.xi).point;
            assert!((point - Vec3::from(extreme.point)).norm() < 1e-14);
            assert!((point.norm() - 1.0 - extreme.value).abs() < 1e-14);
        }
        assert_eq!(Errors::from_array(&errors.to_array()), errors);
    }

    /// Outside a polyhedron the dead zones over its edges grow with the distance; inside there are hardly any: half of the
    /// split squares have a concave diagonal.
    #[test]
    fn facets_have_dead_zones_outside() {
        let set = PatchSet::new(sphere_patches(3, true, 6, Smoothing::Facet));
        let mut last = 0.0;
        for distance in [0.1, 0.2, 0.4] {
            let sampling = Sampling { distance: Some(distance), extension: 0.05, ..sampling(13, false) };
            let [outside, inside] = all(&set, &UNIT, &sampling).dead();
            assert!(outside[0] > last && outside[1] < outside[0] && inside[0] < 0.02, "{outside:?} {inside:?}");
            last = outside[0];
        }
    }

    /// A piece without the half of it where its second parameter is above a half.
    struct Trimmed(Patch);

    impl Parametric for Trimmed {
        fn domain(&self) -> [[f64; 2]; 2] {
            self.0.domain()
        }

        fn local(&self, xi: [f64; 2]) -> Local {
            self.0.local(xi)
        }

        fn bounds(&self) -> (Vec3, Vec3) {
            self.0.bounds()
        }

        fn closest(&self, x: &Vec3) -> Closest {
            let Closest { xi: [s, t], .. } = Parametric::closest(&self.0, x);
            Closest::new(&self.0, [s, t.min(0.5)], x)
        }
    }

    impl Piece for Trimmed {
        fn id(&self) -> u32 {
            self.0.id
        }

        fn edges(&self) -> [Edge; 4] {
            self.0.edges
        }

        fn ends_at(&self, corner: usize) -> bool {
            self.0.ends_at(corner)
        }

        fn is_trimmed(&self) -> bool {
            true
        }

        fn core(&self, extent: &Extent, x: &Vec3, start: Option<[f64; 2]>, most: f64) -> Foot {
            let foot = self.0.core(extent, x, start, most);
            let xi = [foot.xi[0], foot.xi[1].min(0.5)];
            let local = self.0.local(xi);
            Foot { xi, local, distance: (x - local.point).norm(), ..foot }
        }
    }

    impl Polygon for Trimmed {
        fn bend(&self, y: &Vec3) -> [f64; 4] {
            self.0.bend(y)
        }
    }

    #[test]
    fn what_is_trimmed_away_does_not_count() {
        let patches = || sphere_patches(1, false, 1, Smoothing::Nagata);
        let whole = PatchSet::new(patches());
        let trimmed = PieceSet::of_pieces(patches().into_iter().map(Trimmed).collect());
        let sampling = Sampling { distance: Some(0.1), ..sampling(25, true) };
        let (full, _) = measure(&whole, 0, &UNIT, &sampling);
        let (half, sampled) = measure(&trimmed, 0, &UNIT, &sampling);
        assert!((half.area / full.area - 0.5).abs() < 0.03 && half.turned.xi[1] <= 0.5 && half.highest.xi[1] <= 0.5);
        assert!((half.angle_rms() / full.angle_rms() - 1.0).abs() < 0.05, "the halves are alike");
        assert_eq!(sampled.samples.iter().filter(|sample| sample.held).count(), 13 * 25);
    }
}
