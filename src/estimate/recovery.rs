//! Recovered fields: continuous stress and strain, better than those of the elements.
//!
//! The superconvergent patch recovery of Zienkiewicz and Zhu (IJNME 33, 1992, 1331-1364): around every node a linear
//! polynomial is fitted to the values in the middles of its elements, by least squares; its value at the node is the
//! recovered one, and between nodes shape functions interpolate. The stress of elements of second order is linear in itself: it is fitted
//! to that of all their integration points, by their weights. Where the middles lie in a plane, a line or a point, as at
//! the nodes of a face, an edge or a corner, the polynomial knows nothing of some directions; the value is then the mean of
//! those of the polynomials of the nodes next to it that know more.

use crate::error::Result;
use crate::mesh::SolidShape;
use crate::model::Model;
use crate::model::elements::{carrying, lost, medium, samples};
use crate::parallel::{agree, max};
use crate::solid::element::{Inverted, Sample, hex27, tet10, wedge18};
use crate::solid::voigt::logarithmic_strain;
use crate::{Mat3, Vec3};
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

/// Kirchhoff stress, then spatial logarithmic strain 1/2 ln b: what is recovered.
pub const WIDTH: usize = 12;
pub type Values = [f64; WIDTH];

/// Variance of the middles of elements along a direction over that of their nodes, below which they lie on top of each other;
/// in regular meshes of hexahedra it is a half inside, and zero across a face. At the nodes of regular wedges and tetrahedra that have
/// few elements it is 0.106 or less, 1/10 at many, and 0.143 or more elsewhere: none is so near that rounding decides.
const FLAT: f64 = 0.12;

/// Numbers of a [`Fit`] that travel between ranks.
const PACKED: usize = 1 + 4 * WIDTH;

/// The recovered values, each material of a body by itself: between two of them stresses jump.
pub struct Recovered {
    /// The first materials of bodies, their second, and so on; of bodies that share nodes none together.
    layers: Vec<Layer>,
    /// The layer of each section.
    layer_of: Vec<usize>,
}

/// What has been recovered from the elements of one material of each body.
struct Layer {
    /// Of each local node.
    values: Vec<f64>,
    /// Directions that the polynomial of each local node knows of.
    known: Vec<f64>,
}

/// Where an element has values, with its share of the element.
struct Point {
    place: Vec3,
    share: f64,
    values: Values,
}

/// Sums over the elements around a node, places from the node.
#[derive(Clone, Default)]
struct Sums {
    elements: f64,
    middle: Vec3,
    middles: Mat3,
    corners: f64,
    corner: Vec3,
    corner_squares: Mat3,
    value: Values,
    moments: [Vec3; WIDTH],
}

/// A linear polynomial around a node.
struct Fit {
    known: f64,
    value: Values,
    slopes: [Vec3; WIDTH],
}

impl Sums {
    fn add(&mut self, corners: impl Iterator<Item = Vec3>, points: &[Point], node: &Vec3) {
        self.elements += 1.0;
        for y in corners.map(|corner| corner - node) {
            self.corners += 1.0;
            self.corner += y;
            self.corner_squares += y * y.transpose();
        }
        for Point { place, share, values } in points {
            let y = place - node;
            self.middle += y * *share;
            self.middles += y * y.transpose() * *share;
            for ((sum, moment), value) in self.value.iter_mut().zip(&mut self.moments).zip(values) {
                *sum += share * value;
                *moment += y * (share * value);
            }
        }
    }

    /// The polynomial; in a plane nothing varies along z.
    fn fit(&self, plane: bool) -> Fit {
        let mean = self.middle / self.elements;
        let corner = self.corner / self.corners;
        let mut spread = self.middles / self.elements - mean * mean.transpose();
        let mut size = self.corner_squares / self.corners - corner * corner.transpose();
        if plane {
            for k in 0..3 {
                (spread[(2, k)], spread[(k, 2)]) = (0.0, 0.0);
                (size[(2, k)], size[(k, 2)]) = (0.0, 0.0);
            }
            size[(2, 2)] = 1.0;
        }
        // In coordinates in which the corners spread by one in all directions, so that long elements count as cubes do.
        let unit = size.cholesky().and_then(|c| c.l().try_inverse()).unwrap_or_else(Mat3::zeros);
        let eigen = (unit * spread * unit.transpose()).symmetric_eigen();
        let (mut inverse, mut known) = (Mat3::zeros(), 0.0);
        for (value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > FLAT {
                let direction = unit.transpose() * direction;
                inverse += direction * direction.transpose() / *value;
                known += 1.0;
            }
        }
        let value: Values = self.value.map(|sum| sum / self.elements);
        let slopes = std::array::from_fn(|k| inverse * (self.moments[k] / self.elements - mean * value[k]));
        Fit { known, value: std::array::from_fn(|k| value[k] - slopes[k].dot(&mean)), slopes }
    }
}

impl Fit {
    fn pack(&self, into: &mut [f64]) {
        into[0] = self.known;
        into[1..=WIDTH].copy_from_slice(&self.value);
        for (k, slope) in self.slopes.iter().enumerate() {
            into[1 + WIDTH + 3 * k..][..3].copy_from_slice(slope.as_slice());
        }
    }

    /// The values of a packed polynomial so far from its node.
    fn at(packed: &[f64], y: &Vec3) -> Values {
        std::array::from_fn(|k| {
            let slope = &packed[1 + WIDTH + 3 * k..][..3];
            packed[1 + k] + slope[0] * y.x + slope[1] * y.y + slope[2] * y.z
        })
    }
}

/// Nodes that carry an element, those that others share their displacement with in place of these.
pub(super) fn nodes_of<'a>(model: &'a Model, e: usize) -> impl Iterator<Item = usize> + Clone + 'a {
    carrying(model, &model.part.solids[e]).iter().map(|&n| model.part.tie[n as usize] as usize)
}

/// Stress and strain at an integration point of element `e`.
pub fn values_at(model: &Model, e: usize, q: usize, sample: &Sample) -> std::result::Result<Values, Inverted> {
    let medium = medium(model, e);
    let lost = Inverted { det_f: sample.det_f };
    let stress = medium.material.kirchhoff(&sample.f, medium.state(q)).ok_or(lost)?;
    let strain = logarithmic_strain(&sample.f);
    Ok(std::array::from_fn(|k| if k < 6 { stress[k] } else { strain[k - 6] }))
}

/// Where element `e` has values: its middle with their mean, which is that there but for terms of second order, or, if it is of second
/// order, its integration points.
fn points_of(model: &Model, e: usize, u: &[Vec3]) -> std::result::Result<Vec<Point>, Inverted> {
    let samples = samples(model, e, u)?;
    let all: f64 = samples.iter().map(|sample| sample.weight).sum();
    let nodes = || nodes_of(model, e).map(|n| model.part.points[n]);
    let functions = |q: usize| match model.part.solids[e].shape {
        SolidShape::Wedge18 => Some(&wedge18::VALUES[q][..]),
        SolidShape::Hex27 => Some(&hex27::VALUES[q][..]),
        SolidShape::Tet10 => Some(&tet10::VALUES[q][..]),
        _ => None,
    };
    let mut points = Vec::new();
    let mut mean = Point { place: nodes().sum::<Vec3>() / nodes().count() as f64, share: 1.0, values: [0.0; WIDTH] };
    for (q, sample) in samples.iter().enumerate() {
        let (share, values) = (sample.weight / all, values_at(model, e, q, sample)?);
        match functions(q) {
            Some(shape) => {
                let place = nodes().zip(shape).map(|(x, share)| x * *share).sum();
                points.push(Point { place, share, values });
            }
            None => mean.values.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value),
        }
    }
    Ok(if points.is_empty() { vec![mean] } else { points })
}

impl Recovered {
    /// Of a state that has converged, with displacements `u` of all local nodes. Collective.
    ///
    /// # Errors
    /// An element that is inverted, by its number, on all ranks.
    pub fn new(comm: &SimpleCommunicator, model: &Model, u: &[Vec3]) -> Result<Self> {
        let layer_of = layers(comm, model);
        let count = layer_of.iter().max().map_or(0, |last| last + 1);
        let of = |layer: usize, e: usize| layer_of[model.part.solids[e].section as usize] == layer;
        let layers = (0..count).map(|layer| Layer::new(comm, model, u, &|e| of(layer, e)));
        Ok(Self { layers: layers.collect::<Result<_>>()?, layer_of })
    }

    fn layer(&self, model: &Model, e: usize) -> &Layer {
        &self.layers[self.layer_of[model.part.solids[e].section as usize]]
    }

    /// The values at local node `n`, in the material of element `e`.
    pub(super) fn beside(&self, model: &Model, e: usize, n: usize) -> Values {
        self.layer(model, e).at_node(n)
    }

    /// The values at a local node, between materials of its body those of the stiffest.
    pub(super) fn at_node(&self, model: &Model, n: usize) -> Values {
        let tie = model.part.tie[n] as usize;
        self.layers[self.layer_of[model.part.section[n] as usize]].at_node(tie)
    }

    /// Values of the nodes of element `e`, weighted by shape functions.
    pub fn at(&self, model: &Model, e: usize, shape: &[f64]) -> Values {
        let mut sum = [0.0; WIDTH];
        for (n, share) in nodes_of(model, e).zip(shape) {
            let own = &self.layer(model, e).values[n * WIDTH..][..WIDTH];
            sum.iter_mut().zip(own).for_each(|(sum, value)| *sum += share * value);
        }
        sum
    }

    /// Whether element `e` is one of a single layer: no node of it has a polynomial that knows all directions.
    pub fn is_thin(&self, model: &Model, e: usize) -> bool {
        let all = if model.is_of_layer(&model.part.solids[e]) { 2.0 } else { 3.0 };
        nodes_of(model, e).all(|n| self.layer(model, e).known[n] < all)
    }
}

/// A layer for each section, another one than those of the sections of its body, and of bodies with which it shares nodes.
/// Collective.
fn layers(comm: &SimpleCommunicator, model: &Model) -> Vec<usize> {
    let (part, count) = (&model.part, model.sections.len());
    let mut around: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    let joined = |n: usize| part.body[part.tie[n] as usize] != part.body[n];
    let shared: BTreeSet<u32> = (0..part.points.len()).filter(|&n| joined(n)).map(|n| part.tie[n]).collect();
    for (e, solid) in part.solids.iter().enumerate() {
        for n in nodes_of(model, e).filter(|&n| shared.contains(&(n as u32))) {
            around.entry(n).or_default().insert(solid.section as usize);
        }
    }
    let mut meet = vec![0.0; count * count];
    for sections in around.values() {
        sections.iter().flat_map(|a| sections.iter().map(move |b| a * count + b)).for_each(|k| meet[k] = 1.0);
    }
    max(comm, &mut meet);
    let mut layer_of: Vec<usize> = Vec::with_capacity(count);
    for (k, section) in model.sections.iter().enumerate() {
        let apart = |other: &usize| model.sections[*other].body == section.body || meet[k * count + other] > 0.0;
        let taken: BTreeSet<usize> = (0..k).filter(apart).map(|other| layer_of[other]).collect();
        layer_of.push((0..).find(|layer| !taken.contains(layer)).unwrap_or(k));
    }
    layer_of
}

impl Layer {
    /// From the elements that are `of` it. Collective.
    fn new(comm: &SimpleCommunicator, model: &Model, u: &[Vec3], of: &dyn Fn(usize) -> bool) -> Result<Self> {
        let (part, count) = (&model.part, model.part.points.len());
        let mut sums = vec![Sums::default(); part.owned];
        let mut plane = vec![false; part.owned];
        let mut outcome = Ok(());
        for e in (0..part.solids.len()).filter(|e| of(*e)) {
            let points = points_of(model, e, u).unwrap_or_else(|_| {
                outcome = Err(lost(model, e));
                Vec::new()
            });
            for n in nodes_of(model, e).filter(|n| *n < part.owned) {
                sums[n].add(nodes_of(model, e).map(|m| part.points[m]), &points, &part.points[n]);
                plane[n] = model.is_of_layer(&model.part.solids[e]);
            }
        }
        let mut fits = vec![0.0; count * PACKED];
        for (n, sums) in sums.iter().enumerate().filter(|(_, sums)| sums.elements > 0.0) {
            sums.fit(plane[n]).pack(&mut fits[n * PACKED..][..PACKED]);
        }
        drop(sums);
        part.halo.update(comm, PACKED, &mut fits);
        let known: Vec<f64> = (0..count).map(|n| fits[n * PACKED]).collect();
        let mut values = Self::spread(model, &fits, &known, of);
        part.halo.update(comm, WIDTH, &mut values);
        agree(comm, outcome)?;
        Ok(Self { values, known })
    }

    /// The values at owned nodes, those that know less than others from these.
    fn spread(model: &Model, fits: &[f64], known: &[f64], of: &dyn Fn(usize) -> bool) -> Vec<f64> {
        let part = &model.part;
        let mut best = known.to_vec();
        for e in (0..part.solids.len()).filter(|e| of(*e)) {
            let most = nodes_of(model, e).map(|n| known[n]).fold(0.0, f64::max);
            nodes_of(model, e).for_each(|n| best[n] = best[n].max(most));
        }
        let mut values = vec![0.0; known.len() * WIDTH];
        let mut shares = vec![0.0; part.owned];
        for e in (0..part.solids.len()).filter(|e| of(*e)) {
            for n in nodes_of(model, e).filter(|n| *n < part.owned && known[*n] < best[*n]) {
                for m in nodes_of(model, e).filter(|m| known[*m] == best[n]) {
                    let from = Fit::at(&fits[m * PACKED..][..PACKED], &(part.points[n] - part.points[m]));
                    values[n * WIDTH..][..WIDTH].iter_mut().zip(from).for_each(|(sum, value)| *sum += value);
                    shares[n] += 1.0;
                }
            }
        }
        for n in 0..part.owned {
            let own = &mut values[n * WIDTH..][..WIDTH];
            match shares[n] {
                0.0 => own.copy_from_slice(&fits[n * PACKED + 1..][..WIDTH]),
                shares => own.iter_mut().for_each(|value| *value /= shares),
            }
        }
        values
    }

    fn at_node(&self, n: usize) -> Values {
        std::array::from_fn(|k| self.values[n * WIDTH + k])
    }
}
