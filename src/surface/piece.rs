//! What projection needs to know of a piece of a surface.
//!
//! A piece lives on a triangle or quadrilateral of its parameters, edge k running from corner k to the next one around,
//! and knows what lies beyond each edge. Sets of pieces are searched by [`super::piece_set`].

use super::parametric::{Local, Parametric};
use super::piece_set::settle;
use super::projection::{Extent, Foot, angle_normal, closest_foot, on_edge, on_surface, perpendicular};
use crate::{Mat3, Vec3};

/// How far beyond its edges a piece may be used, in its own parameters.
pub const EXTENSION: f64 = 0.05;

/// What lies beyond an edge of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Nothing: the surface ends here.
    Boundary,
    /// A piece with (nearly) the same normals along the edge.
    Smooth,
    /// A piece with other normals.
    Sharp,
}

/// A surface over a polygon of its parameters; by default the square `[0,1]^2`, with corners at (0,0), (1,0), (1,1), (0,1).
pub trait Polygon: Parametric {
    /// Samples along each parameter that show how it varies.
    const SAMPLES: usize = 3;

    /// Number of edges: 3 or 4.
    fn count(&self) -> usize {
        4
    }

    /// Parameters of the middle.
    fn center(&self) -> [f64; 2] {
        [0.5, 0.5]
    }

    /// Distances, in the parameters, of `xi` inside each edge; negative beyond it.
    fn sides(&self, [e, z]: [f64; 2]) -> [f64; 4] {
        [z, 1.0 - e, 1.0 - z, e]
    }

    /// Corners of the domain extended beyond each edge.
    fn corners(&self, by: &[f64; 4]) -> [[f64; 2]; 4] {
        [[-by[3], -by[0]], [1.0 + by[1], -by[0]], [1.0 + by[1], 1.0 + by[2]], [-by[3], 1.0 + by[2]]]
    }

    /// The parameters in the domain next to `xi`.
    fn clamp(&self, [e, z]: [f64; 2]) -> [f64; 2] {
        [e.clamp(0.0, 1.0), z.clamp(0.0, 1.0)]
    }

    /// Hands over places from 0 to 1 along an edge, of which one is near where the edge is nearest to `x`.
    fn along_edge(&self, _edge: usize, _x: &Vec3, look: &mut dyn FnMut(f64)) {
        const ALONG: usize = 20;
        (1..ALONG).for_each(|k| look(k as f64 / ALONG as f64));
    }

    /// How far beyond the domain `xi` lies; 0 inside.
    fn overshoot(&self, xi: [f64; 2]) -> f64 {
        self.sides(xi).iter().fold(0.0, |worst, side| f64::max(worst, -side))
    }

    /// Bounds over the domain: the greatest y.P,11, the middle of the range of y.P,12 and half its width, the greatest
    /// y.P,22.
    fn bend(&self, y: &Vec3) -> [f64; 4];

    /// A bound from above of the component of its points along a `direction`, over the domain; tight where that is close to a
    /// normal.
    fn farthest_along(&self, _direction: &Vec3) -> f64 {
        f64::INFINITY
    }

    /// |tau_a|^2 that is as good as 0, for surfaces with a pole; 0 for those without.
    fn vanishing(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Size of a step in the parameters, which leaves an error of about its square under Newton's method.
    fn step_size(&self, _: &Local, step: [f64; 2]) -> f64 {
        step[0].abs().max(step[1].abs())
    }
}

/// A piece of a surface, as a set of them sees it.
pub trait Piece: Polygon {
    /// The same on all ranks.
    fn id(&self) -> u32;

    /// What lies beyond each edge.
    fn edges(&self) -> [Edge; 4];

    /// Whether the surface ends at a corner, though perhaps in an edge of another piece.
    fn ends_at(&self, corner: usize) -> bool;

    /// Whether parts of the domain may not belong to the piece.
    fn is_trimmed(&self) -> bool {
        false
    }

    /// How far apart neighbours may be where they meet; 0 when they share their edges.
    fn seam(&self) -> f64 {
        0.0
    }

    /// The point of the piece next to `x`, without extension; the search begins at `start` if given. Of a piece that is
    /// farther than `most` any point.
    fn core(&self, extent: &Extent, x: &Vec3, start: Option<[f64; 2]>, most: f64) -> Foot {
        closest_foot(self, extent, x, start, most)
    }

    /// From the core to the foot with the extension that the edges allow, and how much of it that needs. `None` beyond
    /// an end of the surface.
    fn settle(&self, x: &Vec3, core: Foot) -> Option<(Foot, f64)> {
        settle(self, x, core)
    }

    /// Whether `xi` is on none of it, but on an extension.
    fn is_beyond(&self, xi: [f64; 2]) -> bool {
        self.overshoot(xi) > 0.0
    }

    /// Whether the surface ends where a foot is on an edge or corner.
    fn is_end(&self, foot: &Foot) -> bool {
        let edges = self.edges();
        (0..4).any(|k| foot.is_on(k) && edges[k] == Edge::Boundary)
    }

    /// Parameters and gap of the minimum of the distance inside the piece extended by `extension` of its parameters.
    fn perpendicular(&self, extent: &Extent, x: &Vec3, extension: f64) -> Option<([f64; 2], f64)> {
        perpendicular(self, extent, x, &[extension; 4])
    }

    /// Gap, normal and its gradient at a foot that is on no edge.
    fn on_surface(&self, x: &Vec3, foot: &Foot) -> (f64, Vec3, Mat3) {
        on_surface(x, &foot.local)
    }

    /// The same at a foot on an edge or corner that is not `x`; `inside` the tool or not.
    fn on_edge(&self, x: &Vec3, foot: &Foot, inside: bool) -> (f64, Vec3, Mat3) {
        on_edge(x, self, foot, inside)
    }

    /// Normal around a foot times the angle that the piece fills there.
    fn angle_normal(&self, foot: &Foot) -> Vec3 {
        angle_normal(self, foot)
    }
}
