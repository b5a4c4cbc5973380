//! What the study needs of a surface: its pieces as functions of parameters, the nearest point, and normal projections.

use crate::Vec3;
use crate::surface::facets::angle;
use crate::surface::projection::Extent;
use crate::surface::{Analytic, Edge, Local, Piece, PieceSet, Projection};

/// A point whose difference to x is along the surface's normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Number of the piece, from 0.
    pub index: usize,
    /// Its id.
    pub piece: u32,
    pub xi: [f64; 2],
    pub gap: f64,
}

/// A surface that is sampled: pieces over rectangles of parameters, or over 0 <= xi_2 <= xi_1 <= 1.
pub trait Described {
    /// Number of pieces.
    fn count(&self) -> usize;

    /// The id of a piece, as in [`Projection::patch`].
    fn id(&self, piece: usize) -> u32;

    /// Number of edges of a piece: 3 or 4.
    fn sides(&self, piece: usize) -> usize;

    /// What lies beyond each edge of a piece; edge k runs from corner k to the next one around. Empty when pieces are parts
    /// of faces or the whole.
    fn edges(&self, piece: usize) -> Vec<Edge>;

    /// Parameters of the corners of a piece.
    fn corners(&self, piece: usize) -> [[f64; 2]; 4];

    /// The pieces that come within `tolerance` of `x`, and their parameters there.
    fn touching(&self, x: &Vec3, tolerance: f64) -> Vec<(usize, [f64; 2])>;

    /// Whether a piece is a triangle.
    fn is_triangle(&self, piece: usize) -> bool {
        self.sides(piece) == 3
    }

    /// Lowest and highest value of each parameter of a piece.
    fn domain(&self, piece: usize) -> [[f64; 2]; 2];

    /// A piece at parameters.
    fn local(&self, piece: usize, xi: [f64; 2]) -> Local;

    /// The outward unit normal of a piece at parameters.
    fn normal(&self, piece: usize, xi: [f64; 2]) -> Vec3;

    /// Whether the surface has the point of a piece at parameters, which may be trimmed away.
    fn holds(&self, piece: usize, xi: [f64; 2]) -> bool;

    /// The nearest point, ends of the surface included; `None` where `x` is not finite.
    fn nearest(&self, x: &Vec3) -> Option<Projection>;

    /// The nearest normal projection within the distance `reach`, on pieces extended by `extension`, in their parameters,
    /// beyond all their edges; `None` in a dead zone.
    fn normal_projection(&self, x: &Vec3, extension: f64, reach: f64) -> Option<Foot>;

    /// Whether contact has no projection of `x` either, because it lies beyond an end of the surface.
    fn is_beyond(&self, x: &Vec3) -> bool;

    /// Parameters of a piece at the point (s, t) of the unit square.
    fn parameters(&self, piece: usize, [s, t]: [f64; 2]) -> [f64; 2] {
        let at = |[low, high]: [f64; 2], s: f64| if s == 1.0 { high } else { low + s * (high - low) };
        let [one, two] = self.domain(piece);
        if self.is_triangle(piece) { [s, s * t] } else { [at(one, s), at(two, t)] }
    }

    /// The point and the area of the piece for a unit of (s, t), there.
    fn at(&self, piece: usize, st: [f64; 2]) -> SurfacePoint {
        let xi = self.parameters(piece, st);
        let local = self.local(piece, xi);
        let [[a, b], [c, d]] = self.domain(piece);
        let stretch = if self.is_triangle(piece) { st[0] } else { (b - a) * (d - c) };
        let held = self.holds(piece, xi);
        let area = if held { local.area_vector().norm() * stretch } else { 0.0 };
        SurfacePoint { point: local.point, normal: self.normal(piece, xi), area, held }
    }
}

/// A point of a piece, its normal, and the area per unit of (s, t), 0 where it is trimmed away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    pub point: Vec3,
    pub normal: Vec3,
    pub area: f64,
    pub held: bool,
}

impl<P: Piece> Described for PieceSet<P> {
    fn count(&self) -> usize {
        self.pieces().len()
    }

    fn id(&self, piece: usize) -> u32 {
        self.pieces()[piece].id()
    }

    fn sides(&self, piece: usize) -> usize {
        self.pieces()[piece].count()
    }

    fn edges(&self, piece: usize) -> Vec<Edge> {
        let piece = &self.pieces()[piece];
        piece.edges()[..piece.count()].to_vec()
    }

    fn corners(&self, piece: usize) -> [[f64; 2]; 4] {
        self.pieces()[piece].corners(&[0.0; 4])
    }

    fn touching(&self, x: &Vec3, tolerance: f64) -> Vec<(usize, [f64; 2])> {
        let around = Vec3::repeat(tolerance);
        let near = |k: u32| {
            let closest = self.pieces()[k as usize].closest(x);
            (closest.distance <= tolerance).then_some((k as usize, closest.xi))
        };
        self.within(&(x - around), &(x + around)).into_iter().filter_map(near).collect()
    }

    fn domain(&self, piece: usize) -> [[f64; 2]; 2] {
        self.pieces()[piece].domain()
    }

    fn local(&self, piece: usize, xi: [f64; 2]) -> Local {
        self.pieces()[piece].local(xi)
    }

    fn normal(&self, piece: usize, xi: [f64; 2]) -> Vec3 {
        self.pieces()[piece].normal(xi)
    }

    fn holds(&self, piece: usize, xi: [f64; 2]) -> bool {
        const ROUNDED: f64 = 1e-9;
        let piece = &self.pieces()[piece];
        if !piece.is_trimmed() {
            return true;
        }
        let (low, high) = piece.bounds();
        let foot = piece.core(&Extent::new(piece), &piece.point(xi), Some(xi), f64::INFINITY);
        foot.distance <= ROUNDED * (high - low).norm()
    }

    fn nearest(&self, x: &Vec3) -> Option<Projection> {
        self.nearest(x)
    }

    fn normal_projection(&self, x: &Vec3, extension: f64, reach: f64) -> Option<Foot> {
        let (piece, xi, gap) = self.normal_projection(x, extension, reach)?;
        let index = self.pieces().binary_search_by_key(&piece, Piece::id).ok()?;
        Some(Foot { index, piece, xi, gap })
    }

    fn is_beyond(&self, x: &Vec3) -> bool {
        self.closest(x, f64::INFINITY, None).is_none()
    }
}

/// A closed form is one piece, the whole of it.
impl Described for Analytic {
    fn count(&self) -> usize {
        1
    }

    fn id(&self, _: usize) -> u32 {
        0
    }

    fn sides(&self, _: usize) -> usize {
        4
    }

    fn edges(&self, _: usize) -> Vec<Edge> {
        Vec::new()
    }

    fn corners(&self, _: usize) -> [[f64; 2]; 4] {
        let [[a, b], [c, d]] = self.parametric().domain();
        [[a, c], [b, c], [b, d], [a, d]]
    }

    fn touching(&self, _: &Vec3, _: f64) -> Vec<(usize, [f64; 2])> {
        Vec::new()
    }

    fn domain(&self, _: usize) -> [[f64; 2]; 2] {
        self.parametric().domain()
    }

    fn local(&self, _: usize, xi: [f64; 2]) -> Local {
        self.parametric().local(xi)
    }

    fn normal(&self, _: usize, xi: [f64; 2]) -> Vec3 {
        self.parametric().normal(xi)
    }

    fn holds(&self, _: usize, _: [f64; 2]) -> bool {
        true
    }

    fn nearest(&self, x: &Vec3) -> Option<Projection> {
        self.nearest(x)
    }

    /// A foot is that of a perpendicular when the surface has the direction of the projection there.
    fn normal_projection(&self, x: &Vec3, _: f64, reach: f64) -> Option<Foot> {
        const ROUNDED: f64 = 1e-8;
        let projection = self.closest(x, reach, None)?;
        let xi = self.parametric().closest(x).xi;
        let straight = angle(&projection.normal, &self.parametric().normal(xi)) < ROUNDED;
        straight.then_some(Foot { index: 0, piece: 0, xi, gap: projection.gap })
    }

    fn is_beyond(&self, x: &Vec3) -> bool {
        self.closest(x, f64::INFINITY, None).is_none()
    }
}
