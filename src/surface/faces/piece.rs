//! A piece of a face: a cell of its surface, and the stretches of the rims that cross it.
//!
//! The closest point of a trimmed piece is a foot inside the loops or a point of a rim; which rim is kept in the limits
//! of the foot ([`RIM`]). The edges of the cell itself are inside the face and smooth, unless the surface has a crease
//! along them; those on the border of the surface's domain are covered by rims.

use super::curves::{closest_on, crossings, descend_on, part};
use super::sewn::{Corner, Rim, SewnFace};
use super::stretch::Stretch;
use super::trim::Trim;
use crate::surface::cell::Cell;
use crate::surface::nurbs::{Nurbs, Rectangle};
use crate::surface::parametric::{Closest, Local, Parametric};
use crate::surface::piece::{EXTENSION, Edge, Piece, Polygon};
use crate::surface::piece_set::settle;
use crate::surface::projection::{Extent, Foot, closest_foot, descend, on_edge, starts};
use crate::surface::{Curve, facets};
use crate::{Mat3, Vec3};
use nalgebra::{Matrix2, Vector2};
use std::sync::Arc;

/// Set in the limits of a foot on a rim, with the number of the stretch from bit [`NUMBER`] up.
const RIM: u32 = 1 << 4;
/// Set when it is the start or the end of the rim.
const START: u32 = 1 << 5;
const END: u32 = 1 << 6;
const NUMBER: u32 = 8;

/// In the parameters of a cell: what is nearer to its edge lies on it.
const ON_EDGE: f64 = 1e-9;
/// In the parameters of a cell: how far beside a rim to ask what is inside.
const BESIDE: f64 = 1e-6;
/// Greatest extension, in the parameters of a cell, that a gap between faces can ask for.
const WIDEST: f64 = 0.5;

/// What the pieces of a face share.
#[derive(Debug)]
struct Shared {
    face: u32,
    trimmed: bool,
    trim: Trim,
    rims: Vec<Rim>,
}

/// A piece of a face of a CAD model.
#[derive(Clone, Debug)]
pub struct FacePiece {
    id: u32,
    cell: Cell,
    /// The part of the surface's domain that the cell covers.
    rect: Rectangle,
    edges: [Edge; 4],
    /// Edges on the border of the surface's domain.
    outer: [bool; 4],
    shared: Arc<Shared>,
    /// Parts of the loops that a ray from the piece may cross.
    seen: Vec<u32>,
    stretches: Vec<Stretch>,
    /// Greatest distance to a neighbour.
    gap: f64,
    /// How far beyond its rims the piece may be used, in its parameters.
    extension: f64,
}

/// A foot on a rim.
struct OnRim<'a> {
    stretch: &'a Stretch,
    rim: &'a Rim,
    t: f64,
    corner: Option<&'a Corner>,
}

impl FacePiece {
    /// The pieces of a face.
    pub fn of_face(face: &SewnFace) -> Vec<Self> {
        let trim = Trim::new(face.rims.iter().map(|rim| &rim.curve));
        let shared = Arc::new(Shared { face: face.id, trimmed: face.trimmed, trim, rims: face.rims.clone() });
        let cells = Cell::of_surface(&face.surface).into_iter().enumerate();
        cells.filter_map(|(k, (rect, cell))| Self::new(face, face.first + k as u32, rect, cell, &shared)).collect()
    }

    /// `None` when no point of the cell is in the face.
    fn new(face: &SewnFace, id: u32, rect: Rectangle, cell: Cell, shared: &Arc<Shared>) -> Option<Self> {
        let [[u0, u1], [v0, v1]] = rect;
        let margin = [(u1 - u0) * WIDEST, (v1 - v0) * WIDEST];
        let seen = shared.trim.seen_from([u0 - margin[0], v0 - margin[1]], [u1 + margin[0], v1 + margin[1]]);
        let [[low_u, high_u], [low_v, high_v]] = face.surface.domain();
        let outer = [v0 <= low_v, u1 >= high_u, v1 >= high_v, u0 <= low_u];
        let edges = creases(&face.surface, &rect, &outer, face.feature_angle);
        let shared = shared.clone();
        let empty = (Vec::new(), 0.0, EXTENSION);
        let (stretches, gap, extension) = empty;
        let mut piece = Self { id, cell, rect, edges, outer, shared, seen, stretches, gap, extension };
        for number in 0..piece.shared.rims.len() {
            piece.add_rim(number);
        }
        if piece.stretches.is_empty() && !piece.holds([0.5; 2]) {
            return None;
        }
        piece.gap = piece.stretches.iter().map(|s| piece.shared.rims[s.rim as usize].gap).fold(0.0, f64::max);
        let width = piece.cell.lengths().into_iter().filter(|length| *length > 0.0).fold(f64::INFINITY, f64::min);
        piece.extension = (EXTENSION + piece.gap / width).min(WIDEST);
        Some(piece)
    }

    /// Number of the face.
    pub fn face(&self) -> u32 {
        self.shared.face
    }

    /// Parameters of the surface at parameters of the piece.
    pub fn parameters(&self, xi: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|a| self.rect[a][0] + (self.rect[a][1] - self.rect[a][0]) * xi[a])
    }

    /// Rims within `reach` of `x`: number, parameter of the rim and distance.
    pub fn rims_near(&self, x: &Vec3, reach: f64) -> impl Iterator<Item = (u32, f64, f64)> {
        let near = self.stretches.iter().filter(move |stretch| stretch.bound(x) <= reach);
        let feet = near.map(|stretch| (stretch, stretch.closest(&self.cell, x)));
        feet.filter(move |(_, (_, d))| *d <= reach).map(|(s, (t, d))| (s.rim, s.along_rim(t), d))
    }

    /// Whether a point belongs to the face.
    pub fn holds(&self, xi: [f64; 2]) -> bool {
        self.shared.trim.holds(self.parameters(xi), &self.seen)
    }

    /// Adds the stretches of a rim that lie in the cell.
    fn add_rim(&mut self, number: usize) {
        let shared = self.shared.clone();
        let [[u0, u1], [v0, v1]] = self.rect;
        let curve = &shared.rims[number].curve;
        let scale = Vector2::new(1.0 / (u1 - u0), 1.0 / (v1 - v0));
        let shift = Vector2::new(-u0 * scale.x, -v0 * scale.y);
        let curve: Curve<2> = curve.transformed(&Matrix2::from_diagonal(&scale), &shift);
        let (low, high) = curve.bounds();
        if low.max() > 1.0 + ON_EDGE || high.min() < -ON_EDGE {
            return;
        }
        let mut cuts = vec![0.0];
        for axis in 0..2 {
            cuts.extend([0.0, 1.0].iter().flat_map(|value| crossings(&curve, axis, *value, ON_EDGE)));
        }
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2).filter(|pair| pair[1] - pair[0] > 1e-14) {
            let middle = curve.local(0.5 * (pair[0] + pair[1]));
            if middle.point.min() >= -ON_EDGE && middle.point.max() <= 1.0 + ON_EDGE && self.is_beside(&middle) {
                let own = part(&curve, [pair[0], pair[1]]);
                self.stretches.extend(Stretch::all(&self.cell, number as u32, [pair[0], pair[1]], own));
            }
        }
    }

    /// Whether the face lies in this cell beside a point of a rim; no question unless the rim runs along an edge.
    fn is_beside(&self, rim: &crate::surface::CurveLocal<2>) -> bool {
        let Some(along) = rim.first.try_normalize(0.0) else { return true };
        let beside = [1.0, -1.0].map(|s| rim.point + Vector2::new(-along.y, along.x) * (s * BESIDE));
        let inside = beside.iter().filter(|p| p.min() >= 0.0 && p.max() <= 1.0);
        inside.clone().count() == 2 || inside.clone().any(|p| self.holds([p.x, p.y]))
    }

    fn on_rim(&self, foot: &Foot) -> Option<OnRim<'_>> {
        if foot.limits & RIM == 0 {
            return None;
        }
        let stretch = self.stretches.get((foot.limits >> NUMBER) as usize)?;
        let rim = &self.shared.rims[stretch.rim as usize];
        let corner = match foot.limits & (START | END) {
            0 => None,
            START => Some(&rim.corners[0]),
            _ => Some(&rim.corners[1]),
        };
        Some(OnRim { stretch, rim, t: closest_on(&stretch.curve, foot.xi).0, corner })
    }

    fn foot_on_rim(&self, number: usize, t: f64, distance: f64) -> Foot {
        let stretch = &self.stretches[number];
        let [start, end] = [t <= 0.0 && stretch.part[0] <= 0.0, t >= 1.0 && stretch.part[1] >= 1.0];
        let corner = if start { START } else { 0 } | if end { END } else { 0 };
        let xi = stretch.xi(t);
        Foot { xi, limits: RIM | corner | (number as u32) << NUMBER, local: self.cell.local(xi), distance }
    }

    /// Whether a foot of descent is a point of the face, and not one of the border that only rims know.
    fn is_own(&self, foot: &Foot) -> bool {
        let on_border = (0..4).any(|k| self.outer[k] && foot.is_on(k));
        !on_border && self.holds(foot.xi)
    }

    /// How far beyond the piece, and beyond rims that are not sharp, `xi` lies; `None` when it is too far.
    fn beyond(&self, xi: [f64; 2]) -> Option<f64> {
        let sides = self.sides(xi);
        let own = (0..4).filter(|k| !self.outer[*k]).fold(0.0, |worst, k| f64::max(worst, -sides[k]));
        if self.holds(xi) {
            return Some(own);
        }
        let distances = self.stretches.iter().map(|s| (s, closest_on(&s.curve, xi).1));
        let (stretch, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let is_soft = self.shared.rims[stretch.rim as usize].edge != Edge::Sharp;
        (is_soft && distance <= self.extension).then(|| distance.max(own))
    }

    /// The foot on the continuation of a sharp rim beyond the corner at `from`, where another rim is not sharp.
    fn along_sharp_rim(&self, x: &Vec3, from: [f64; 2]) -> Option<(Foot, f64)> {
        for (number, stretch) in self.stretches.iter().enumerate() {
            if self.shared.rims[stretch.rim as usize].edge != Edge::Sharp {
                continue;
            }
            let end = [0.0, 1.0].into_iter().find(|t| {
                let xi = stretch.xi(*t);
                (xi[0] - from[0]).hypot(xi[1] - from[1]) < ON_EDGE
            });
            let Some(end) = end else { continue };
            let reach = EXTENSION / stretch.curve.local(end).first.norm();
            let range = if end == 0.0 { [-reach, 1.0] } else { [0.0, 1.0 + reach] };
            let (t, local) = descend_on(|t| stretch.local(&self.cell, t), x, range, end);
            if range[0] < t && t < range[1] {
                let overshoot = EXTENSION * f64::max(-t, t - 1.0).max(0.0) / reach;
                let foot = self.foot_on_rim(number, t, (local.point - x).norm());
                return Some((Foot { limits: foot.limits & !(START | END), ..foot }, overshoot));
            }
        }
        None
    }
}

impl Parametric for FacePiece {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.cell.domain()
    }

    fn local(&self, xi: [f64; 2]) -> Local {
        self.cell.local(xi)
    }

    fn normal(&self, xi: [f64; 2]) -> Vec3 {
        self.cell.normal(xi)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.cell.bounds()
    }

    fn closest(&self, x: &Vec3) -> Closest {
        let foot = self.core(&Extent::new(self), x, None, f64::INFINITY);
        Closest { xi: foot.xi, point: foot.local.point, distance: foot.distance }
    }
}

impl Polygon for FacePiece {
    const SAMPLES: usize = Cell::SAMPLES;

    fn bend(&self, y: &Vec3) -> [f64; 4] {
        self.cell.bend(y)
    }

    fn vanishing(&self) -> [f64; 2] {
        self.cell.vanishing()
    }

    fn step_size(&self, local: &Local, step: [f64; 2]) -> f64 {
        self.cell.step_size(local, step)
    }
}

impl Piece for FacePiece {
    fn id(&self) -> u32 {
        self.id
    }

    fn edges(&self) -> [Edge; 4] {
        self.edges
    }

    fn ends_at(&self, _: usize) -> bool {
        false
    }

    fn is_trimmed(&self) -> bool {
        !self.stretches.is_empty()
    }

    fn seam(&self) -> f64 {
        self.gap
    }

    fn core(&self, extent: &Extent, x: &Vec3, start: Option<[f64; 2]>, most: f64) -> Foot {
        if self.stretches.is_empty() {
            return closest_foot(self, extent, x, start, most);
        }
        let closer = |a: Option<Foot>, b: Foot| Some(a.filter(|a| a.distance <= b.distance).unwrap_or(b));
        let first = descend(self, x, &[0.0; 4], start.map_or(self.center(), |xi| self.clamp(xi)));
        let mut best = None;
        if self.is_own(&first) {
            best = Some(first);
        }
        if extent.has_one_minimum(self, x) {
            if let Some(best) = best {
                return best;
            }
        } else {
            let feet = starts(self).map(|start| descend(self, x, &[0.0; 4], start));
            best = feet.into_iter().filter(|foot| self.is_own(foot)).fold(best, closer);
        }
        for (number, stretch) in self.stretches.iter().enumerate() {
            let least = best.map_or(f64::INFINITY, |foot| foot.distance);
            if stretch.bound(x) < least {
                let (t, distance) = stretch.closest(&self.cell, x);
                if distance < least {
                    best = Some(self.foot_on_rim(number, t, distance));
                }
            }
        }
        best.unwrap_or(first)
    }

    fn settle(&self, x: &Vec3, core: Foot) -> Option<(Foot, f64)> {
        if core.limits == 0 {
            return Some((core, 0.0));
        }
        if self.stretches.is_empty() {
            return settle(self, x, core);
        }
        let (is_soft, at_corner) = match self.on_rim(&core) {
            Some(OnRim { rim, corner, .. }) => {
                (rim.edge != Edge::Sharp || corner.is_some_and(|corner| corner.is_soft), corner.is_some())
            }
            None => ((0..4).any(|k| core.is_on(k) && self.edges[k] == Edge::Smooth), false),
        };
        if is_soft {
            let extension = self.edges.map(|edge| if edge == Edge::Sharp { 0.0 } else { self.extension });
            let free = descend(self, x, &extension, self.clamp(core.xi));
            if free.limits == 0
                && let Some(overshoot) = self.beyond(free.xi)
            {
                return Some((free, overshoot));
            }
            if at_corner && let Some(found) = self.along_sharp_rim(x, core.xi) {
                return Some(found);
            }
        }
        // Beyond all extension the smooth edge comes after any piece that needs less.
        (!self.is_end(&core)).then_some((core, if is_soft { 1.0 } else { 0.0 }))
    }

    fn is_beyond(&self, xi: [f64; 2]) -> bool {
        self.overshoot(xi) > 0.0 || self.is_trimmed() && !self.holds(xi)
    }

    fn is_end(&self, foot: &Foot) -> bool {
        let ends = |on: OnRim| on.rim.edge == Edge::Boundary || on.corner.is_some_and(|corner| corner.is_end);
        self.on_rim(foot).is_some_and(ends)
    }

    fn perpendicular(&self, extent: &Extent, x: &Vec3, extension: f64) -> Option<([f64; 2], f64)> {
        let is_open = |k: usize| self.outer[k] && !self.shared.trimmed;
        let by = std::array::from_fn(|k| if is_open(k) { extension } else { ON_EDGE });
        let starts = starts(self);
        let starts = if extent.has_one_minimum(self, x) { &starts[..1] } else { &starts };
        let feet = starts.iter().map(|start| descend(self, x, &by, *start));
        let feet = feet.filter(|foot| foot.limits == 0 && (!self.shared.trimmed || self.holds(foot.xi)));
        let foot = feet.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some((foot.xi, self.cell.on_surface(x, &foot).0))
    }

    fn on_surface(&self, x: &Vec3, foot: &Foot) -> (f64, Vec3, Mat3) {
        self.cell.on_surface(x, foot)
    }

    fn on_edge(&self, x: &Vec3, foot: &Foot, inside: bool) -> (f64, Vec3, Mat3) {
        let Some(OnRim { stretch, t, corner, .. }) = self.on_rim(foot) else {
            return on_edge(x, self, foot, inside);
        };
        let sign = if inside { -1.0 } else { 1.0 };
        let r = x - foot.local.point;
        let direction = r / foot.distance;
        let mut across = Mat3::identity() - direction * direction.transpose();
        let curve = stretch.local(&self.cell, t);
        let stiffness = curve.first.norm_squared() - r.dot(&curve.second);
        if corner.is_none() && stiffness > 1e-12 * curve.first.norm_squared() {
            across -= curve.first * curve.first.transpose() / stiffness;
        }
        (sign * foot.distance, direction * sign, across * (sign / foot.distance))
    }

    fn angle_normal(&self, foot: &Foot) -> Vec3 {
        let Some(OnRim { stretch, rim, t, corner }) = self.on_rim(foot) else {
            let angle = std::f64::consts::TAU / (1 << foot.limits.count_ones().min(2)) as f64;
            return self.cell.normal(foot.xi) * angle;
        };
        if let Some(corner) = corner {
            return corner.normal;
        }
        let own = self.cell.normal(foot.xi);
        let [start, middle, end] = &rim.beyond;
        let s = 2.0 * stretch.along_rim(t);
        let beyond = match rim.edge {
            Edge::Smooth => own,
            _ if s < 1.0 => start * (1.0 - s) + middle * s,
            _ => middle * (2.0 - s) + end * (s - 1.0),
        };
        (own + beyond) * std::f64::consts::PI
    }
}

/// What the edges of a part of the domain are: sharp where the normals on both sides of a knot differ.
fn creases(surface: &Nurbs, rect: &Rectangle, outer: &[bool; 4], feature_angle: f64) -> [Edge; 4] {
    let kind = |k: usize| {
        let (direction, high) = [(1, 0), (0, 1), (1, 1), (0, 0)][k];
        let at = rect[direction][high];
        let knots = &surface.knots()[direction];
        if outer[k] || knots.multiplicity(at) < knots.degree() {
            return Edge::Smooth;
        }
        let step = 1e-9 * (rect[direction][1] - rect[direction][0]);
        let [start, end] = rect[1 - direction];
        let is_sharp = [0.2, 0.5, 0.8].iter().any(|s| {
            let side = |sign: f64| {
                let mut uv = [start + (end - start) * s; 2];
                uv[direction] = at + sign * step;
                surface.local(uv).area_vector()
            };
            facets::angle(&side(-1.0), &side(1.0)) > feature_angle
        });
        if is_sharp { Edge::Sharp } else { Edge::Smooth }
    };
    std::array::from_fn(kind)
}
