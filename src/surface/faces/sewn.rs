//! A face with what it needs to know of its neighbours, and its way through numbers to another rank.

use crate::Vec3;
use crate::surface::numbers::Numbers;
use crate::surface::nurbs::{Curve, KnotVector, Nurbs};
use crate::surface::piece::Edge;
use nalgebra::Vector2;

/// A stretch of the border of a face that has one kind of neighbour.
#[derive(Clone, Debug, PartialEq)]
pub struct Rim {
    /// A Bézier curve in the parameters of the surface.
    pub curve: Curve<2>,
    pub edge: Edge,
    /// Greatest distance to the neighbour.
    pub gap: f64,
    /// Unit normal of the neighbour at the start, the middle and the end; 0 where the surface ends. Where the rim is one
    /// point, the sum of the normals around it.
    pub beyond: [Vec3; 3],
    /// Its start and end.
    pub corners: [Corner; 2],
}

/// Where two rims of a face meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Sum of the unit normals of all faces around times the angles that they fill.
    pub normal: Vec3,
    /// The surface ends here, though perhaps in a rim of another face.
    pub is_end: bool,
    /// One of the two rims is not sharp.
    pub is_soft: bool,
}

/// A face whose normal P,1 x P,2 points out of the tool, and which knows what lies beyond its rims.
#[derive(Clone, Debug, PartialEq)]
pub struct SewnFace {
    /// Number of the face in its model.
    pub id: u32,
    /// Id of the first of its pieces.
    pub first: u32,
    /// With the parameters exchanged when the face of the file had to be turned over.
    pub surface: Nurbs,
    /// False when the face is the whole domain of its surface.
    pub trimmed: bool,
    /// Angle, in radians, between normals from which an edge is sharp.
    pub feature_angle: f64,
    /// Lower and upper corner of a box that holds it.
    pub bounds: (Vec3, Vec3),
    /// All loops, one rim after the other; each begins where another ends.
    pub rims: Vec<Rim>,
}

impl SewnFace {
    /// The face as numbers, to be sent to another rank.
    pub fn to_numbers(&self) -> Vec<f64> {
        let mut numbers = vec![0.0, self.id as f64, self.first as f64, self.trimmed as u8 as f64, self.feature_angle];
        numbers.extend(self.bounds.0.iter().chain(&self.bounds.1));
        for knots in self.surface.knots() {
            numbers.extend([knots.degree() as f64, knots.knots().len() as f64]);
            numbers.extend(knots.knots());
        }
        self.surface.points().iter().for_each(|point| numbers.extend(point));
        numbers.extend(self.surface.weights());
        numbers.push(self.rims.len() as f64);
        for rim in &self.rims {
            numbers.extend([rim.curve.points().len() as f64, rim.edge as u8 as f64, rim.gap]);
            rim.curve.points().iter().for_each(|point| numbers.extend(point));
            numbers.extend(rim.curve.weights());
            rim.beyond.iter().for_each(|normal| numbers.extend(normal));
            for corner in &rim.corners {
                numbers.extend(&corner.normal);
                numbers.extend([corner.is_end as u8 as f64, corner.is_soft as u8 as f64]);
            }
        }
        numbers[0] = numbers.len() as f64;
        numbers
    }

    /// The faces whose [`Self::to_numbers`] stand one after the other. Ends at numbers that are no face.
    pub fn from_numbers(mut numbers: &[f64]) -> Vec<Self> {
        let mut faces = Vec::new();
        while let Some((own, rest)) = numbers.first().and_then(|len| numbers.split_at_checked(*len as usize)) {
            let Some(face) = own.get(1..).and_then(|own| Numbers(own).face()) else { break };
            faces.push(face);
            numbers = rest;
        }
        faces
    }
}

impl Numbers<'_> {
    fn knots(&mut self) -> Option<KnotVector> {
        let [degree, count] = [self.count()?, self.count()?];
        KnotVector::new(degree, self.take(count)?.to_vec()).ok()
    }

    fn rim(&mut self) -> Option<Rim> {
        let (count, edge, gap) = (self.count()?, self.number()?, self.number()?);
        let points: Vec<Vector2<f64>> = self.vectors(count)?;
        let weights = self.take(count)?.to_vec();
        let curve = Curve::new(KnotVector::bezier(count.checked_sub(1)?), points, weights).ok()?;
        let beyond = [self.vector()?, self.vector()?, self.vector()?];
        let edge = [Edge::Boundary, Edge::Smooth, Edge::Sharp].into_iter().find(|kind| *kind as u8 as f64 == edge)?;
        Some(Rim { curve, edge, gap, beyond, corners: [self.corner()?, self.corner()?] })
    }

    fn corner(&mut self) -> Option<Corner> {
        Some(Corner { normal: self.vector()?, is_end: self.number()? == 1.0, is_soft: self.number()? == 1.0 })
    }

    fn face(&mut self) -> Option<SewnFace> {
        let [id, first] = [self.number()? as u32, self.number()? as u32];
        let (trimmed, feature_angle) = (self.number()? == 1.0, self.number()?);
        let bounds = (self.vector()?, self.vector()?);
        let knots = [self.knots()?, self.knots()?];
        let count = knots[0].count() * knots[1].count();
        let points = self.vectors(count)?;
        let surface = Nurbs::new(knots, points, self.take(count)?.to_vec()).ok()?;
        let count = self.count()?;
        let rims = (0..count).map(|_| self.rim()).collect::<Option<_>>()?;
        Some(SewnFace { id, first, surface, trimmed, feature_angle, bounds, rims })
    }
}
