//! Planes (108), which have no end and no parameters: the curves around make a face of them.

use super::curves::Piece;
use super::entry::Entry;
use super::file::File;
use super::loops;
use super::parameters::Parameters;
use super::transform::Transform;
use crate::Vec3;
use crate::error::Result;
use crate::surface::{Curve, Nurbs};
use nalgebra::Vector2;

type Vec2 = Vector2<f64>;

/// How far curves may be off the plane, over their size.
const OFF: f64 = 1e-6;

/// A plane through a point.
pub(super) struct Plane<'f> {
    point: Vec3,
    normal: Vec3,
    /// The closed curve around it (form 1).
    pub bound: Option<&'f Entry>,
}

impl<'f> Plane<'f> {
    /// A x + B y + C z = D, before the entity's own transformation.
    pub fn read(file: &'f File, entry: &'f Entry) -> Result<Self> {
        let mut parameters = Parameters::new(file, entry)?;
        let [a, b, c, d] = parameters.reals("a coefficient of the plane")?;
        let Some(normal) = Vec3::new(a, b, c).try_normalize(0.0) else {
            return Err(parameters.error("its first three coefficients are zero", "they are its normal"));
        };
        let bound = parameters.optional_entity("a closed curve")?.filter(|_| entry.form == 1);
        Ok(Self { point: normal * (d / Vec3::new(a, b, c).norm()), normal, bound })
    }

    /// The plane moved as `transform` says.
    pub fn transformed(self, transform: Option<Transform>) -> Self {
        let Some((matrix, shift)) = transform else { return self };
        let [across, along] = axes(&self.normal, None).map(|axis| matrix * axis);
        Self { point: matrix * self.point + shift, normal: across.cross(&along).normalize(), ..self }
    }

    /// The rectangle that holds all loops, along the longest line of them, with the loops in its parameters. Fails, saying why, where they are not in
    /// the plane, or not closed.
    pub fn face(&self, chains: &[Vec<Piece>]) -> Result<(Nurbs, Vec<Vec<Curve<2>>>), String> {
        let points = || chains.iter().flatten().flat_map(|piece| piece.curve.points()).map(|x| x - self.point);
        let lines = chains.iter().flatten().filter(|piece| piece.curve.points().len() == 2);
        let lines = lines.map(|piece| piece.curve.points()[1] - piece.curve.points()[0]);
        let axes = axes(&self.normal, lines.max_by(|a, b| a.norm().total_cmp(&b.norm())));
        let flat = |arm: Vec3| Vec2::new(axes[0].dot(&arm), axes[1].dot(&arm));
        let none = Vec2::repeat(f64::INFINITY);
        let (low, high) = points().map(flat).fold((none, -none), |(low, high), x| (low.inf(&x), high.sup(&x)));
        let size = high - low;
        let off = points().map(|arm| self.normal.dot(&arm).abs()).fold(0.0, f64::max);
        if off > OFF * size.norm() || size.min() <= 0.0 {
            let size = size.map(|x| x.max(0.0));
            return Err(format!("the curves around it are {off:.3e} away from it, {} by {} in it", size.x, size.y));
        }
        let corner = self.point + axes[0] * low.x + axes[1] * low.y;
        let nurbs = Nurbs::plane(corner, axes[0] * size.x, axes[1] * size.y);
        let mut closed = Vec::new();
        for chain in chains {
            let in_plane = |piece: &Piece| {
                let curve = &piece.curve;
                let points = curve.points().iter().map(|x| (flat(x - self.point) - low).component_div(&size));
                Ok(vec![Curve::new(curve.knots().clone(), points.collect(), curve.weights().to_vec())?])
            };
            closed.push(loops::close(chain.iter().map(in_plane).collect::<Result<_, String>>()?, &nurbs)?);
        }
        Ok((nurbs, closed))
    }
}

/// Orthogonal unit vectors across a normal, the first along `line` where there is one.
fn axes(normal: &Vec3, line: Option<Vec3>) -> [Vec3; 2] {
    let along = line.map(|line| line - normal * normal.dot(&line)).and_then(|line| line.try_normalize(1e-100));
    let other = || normal.cross(&Vec3::from_fn(|k, _| if k == normal.iamin() { 1.0 } else { 0.0 })).normalize();
    let first = along.unwrap_or_else(other);
    [first, normal.cross(&first)]
}
