//! A chain of lines and arcs in a plane, with the solid on the left hand of the way along it.
//!
//! The closest point is that of the signed distance, with the rules of [`piece_set`](crate::surface::piece_set): outside
//! a convex corner and behind a concave one the normal points along the line between the corner and the point; inside, the
//! nearer side counts; beyond an open end there is nothing. A corner whose side comes closer than the corner has no
//! projection. Where a line runs into an arc nothing is felt.

use super::corners::{Corners, Misfit, ROUNDED, STRAIGHT, check_radii};
use super::section::{Planar, circle, corner, right};
use crate::surface::normals::more_along;
use crate::{Mat2, Vec2};

/// Lines and arcs, end to end.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    pieces: Vec<Piece>,
    /// Way along the chain to the start of each piece, and its whole length.
    starts: Vec<f64>,
    /// What is before the first piece; what is after it and each other.
    joints: Vec<Joint>,
    closed: bool,
    /// Diagonal of the box of the points.
    size: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Piece {
    Line {
        from: Vec2,
        /// Unit vector.
        along: Vec2,
        length: f64,
    },
    Arc {
        center: Vec2,
        radius: f64,
        /// Unit vector from the centre to the middle of the arc.
        middle: Vec2,
        /// Half of the angle of the arc.
        half: f64,
        /// 1 when it turns to the left, -1 to the right.
        turn: f64,
    },
}

/// What is between two pieces, or at an end of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Joint {
    Smooth,
    /// Mean of the normals of its two sides, a unit vector.
    Sharp(Vec2),
    Open,
}

/// Which end of a piece its closest point is.
#[derive(Clone, Copy, PartialEq)]
enum Limit {
    Start,
    Inside,
    End,
}

/// Lengths that differ by less, over the size of the chain, are equal.
const EQUAL: f64 = 1e-12;
/// The same for the piece of the last projection, and for pieces that a point is exactly between.
pub(super) const KEEP: f64 = 1e-6;
/// So far beyond an open end, over the length, what was on a piece is still on it: iterates do not lose nodes that stick there. Patches
/// go on by more, see [`crate::surface::EXTENSION`].
pub(super) const FARTHER: f64 = 1e-3;

impl Chain {
    /// The chain through `points`, rounded at each by a radius of `fillets`, back to the first point if `closed`.
    ///
    /// With `about_axis` the first coordinate is a radius, and an end at radius 0 is no end: the chain goes on as its mirror
    /// image there.
    ///
    /// # Errors
    /// Points that repeat or turn back, lines that cross, radii below 0, fillets that do not fit.
    pub fn new(points: &[[f64; 2]], fillets: &[f64], closed: bool, about_axis: bool) -> Result<Self, Misfit> {
        let points: Vec<Vec2> = points.iter().map(|p| Vec2::from(*p)).collect();
        let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), p| (low.inf(p), high.sup(p)));
        let size = (high - low).norm();
        if about_axis {
            check_radii(&points, closed)?;
        }
        let corners = Corners::new(&points, fillets, closed, size)?;
        let mut chain = Self { pieces: Vec::new(), starts: Vec::new(), joints: vec![Joint::Open], closed, size };
        for line in 0..corners.ways.len() {
            let (from, to) = (line, (line + 1) % points.len());
            let along = corners.ways[line];
            let length = corners.lengths[line] - corners.cuts[from] - corners.cuts[to];
            if length > ROUNDED * size {
                chain.push(Piece::Line { from: points[from] + along * corners.cuts[from], along, length });
            }
            chain.pass_corner(&corners, points[to], to, line);
        }
        chain.finish(&points, about_axis);
        Ok(chain)
    }

    fn push(&mut self, piece: Piece) {
        self.pieces.push(piece);
        self.joints.push(Joint::Smooth);
    }

    /// Adds the fillet of the corner `point` behind the line `line`, or makes the corner sharp.
    fn pass_corner(&mut self, corners: &Corners, point: Vec2, number: usize, line: usize) {
        let turn = corners.turns[number];
        if corners.radii[number] > 0.0 && turn != 0.0 {
            let (radius, half) = (corners.radii[number], 0.5 * turn.abs());
            // The centre and the middle of the arc are on the line that halves the corner.
            let into = (corners.way(line + 1) - corners.ways[line]).normalize();
            let center = point + into * (radius / half.cos());
            self.push(Piece::Arc { center, radius, middle: -into, half, turn: turn.signum() });
        } else if turn.abs() > STRAIGHT
            && let Some(last) = self.joints.last_mut()
        {
            *last = Joint::Sharp((right(&corners.ways[line]) + right(&corners.way(line + 1))).normalize());
        }
    }

    /// Settles the ends of the chain and how far along it each piece starts.
    fn finish(&mut self, points: &[Vec2], about_axis: bool) {
        let last = self.joints.len() - 1;
        if self.closed {
            let joint = if self.joints[0] == Joint::Open { self.joints[last] } else { self.joints[0] };
            (self.joints[0], self.joints[last]) = (joint, joint);
        } else {
            self.joints[last] = Joint::Open;
            for (joint, piece, at_end) in [(0, 0, false), (last, self.pieces.len() - 1, true)] {
                let point = if at_end { points[points.len() - 1] } else { points[0] };
                if about_axis && point.x == 0.0 {
                    let normal = self.pieces[piece].normal(if at_end { self.pieces[piece].length() } else { 0.0 });
                    let smooth = normal.x.abs() <= STRAIGHT;
                    self.joints[joint] =
                        if smooth { Joint::Smooth } else { Joint::Sharp(Vec2::y() * normal.y.signum()) };
                }
            }
        }
        let mut way = 0.0;
        for piece in &self.pieces {
            self.starts.push(way);
            way += piece.length();
        }
        self.starts.push(way);
    }

    /// The closest point to `x` and the number of the piece that it is on; a corner belongs to the piece before it.
    /// `kept` is the piece of the last projection, which stays in a tie. `None` beyond the ends, where what was on a piece is a
    /// little farther.
    pub fn project(&self, x: &Vec2, kept: Option<u32>) -> Option<(Planar, u32)> {
        let count = self.pieces.len();
        let mut best: Option<(Planar, u32)> = None;
        let mut consider = |next: Planar, piece: usize| {
            let piece = piece as u32;
            let closer = best.as_ref().is_none_or(|(planar, last)| {
                let margin = match kept {
                    Some(kept) if kept == piece => KEEP,
                    Some(kept) if kept == *last => -KEEP,
                    _ => -EQUAL,
                };
                next.gap.abs() < planar.gap.abs() + margin * self.size
            });
            if closer {
                best = Some((next, piece));
            }
        };
        let slack = self.size * if kept.is_some() { FARTHER } else { ROUNDED };
        let first = self.foot((0, slack), x);
        let mut foot = first;
        for k in 0..count {
            let (way, limit) = foot;
            let next = if k + 1 < count { Some(self.foot((k + 1, slack), x)) } else { self.closed.then_some(first) };
            let (before, after) = (self.joints[k], self.joints[k + 1]);
            match limit {
                Limit::Inside => consider(self.pieces[k].project(x), k),
                // The start of the chain on an axis.
                Limit::Start if k == 0 && !self.closed => {
                    self.end(x, k, 0.0, before).into_iter().for_each(|p| consider(p, k))
                }
                Limit::End if next.is_none_or(|(_, limit)| limit == Limit::Start) => {
                    self.end(x, k, way, after).into_iter().for_each(|p| consider(p, k));
                }
                _ => {}
            }
            foot = next.unwrap_or(foot);
        }
        best
    }

    /// Perpendiculars from `x` to all pieces, with the number of each; they may miss a piece by a distance of `aside`.
    pub fn perpendiculars(&self, x: &Vec2, aside: f64) -> impl Iterator<Item = (Planar, u32)> {
        let meets = move |piece: &Piece| (-aside..=piece.length() + aside).contains(&piece.foot(x));
        let pieces = self.pieces.iter().enumerate().filter(move |(_, piece)| meets(piece));
        pieces.map(|(k, piece)| (piece.project(x), k as u32))
    }

    /// The perpendiculars from `x` to all pieces that are as near as a `gap`.
    pub fn evenly(&self, x: &Vec2, gap: f64) -> impl Iterator<Item = (Planar, u32)> {
        let near = self.near();
        self.perpendiculars(x, near).filter(move |(planar, _)| (planar.gap - gap).abs() <= near)
    }

    /// The number of pieces.
    pub fn count(&self) -> u32 {
        self.pieces.len() as u32
    }

    /// Lengths that differ by less are equal for a point that is exactly between pieces.
    pub fn near(&self) -> f64 {
        KEEP * self.size
    }

    /// The way along a piece to its point next to `x`, and which end of it that is; open ends have some slack.
    fn foot(&self, (piece, slack): (usize, f64), x: &Vec2) -> (f64, Limit) {
        let slack = |joint: Joint| if joint == Joint::Open { slack } else { 0.0 };
        let (way, length) = (self.pieces[piece].foot(x), self.pieces[piece].length());
        if way < -slack(self.joints[piece]) {
            (0.0, Limit::Start)
        } else if way > length + slack(self.joints[piece + 1]) {
            (length, Limit::End)
        } else {
            (way, Limit::Inside)
        }
    }

    /// The projection on an end of a piece, `way` along it.
    fn end(&self, x: &Vec2, piece: usize, way: f64, joint: Joint) -> Option<Planar> {
        match joint {
            Joint::Open => None,
            Joint::Smooth => Some(self.pieces[piece].project(x)),
            Joint::Sharp(mean) => Some(corner(x - self.pieces[piece].point(way), mean, self.size)),
        }
    }

    /// The same chain the other way, with the solid on its other side.
    pub fn reversed(&self) -> Self {
        let joint = |joint: &Joint| match joint {
            Joint::Sharp(mean) => Joint::Sharp(-mean),
            other => *other,
        };
        let starts = self.starts.iter().rev().map(|start| self.length() - start).collect();
        let pieces = self.pieces.iter().rev().map(Piece::reversed).collect();
        Self { pieces, starts, joints: self.joints.iter().rev().map(joint).collect(), ..*self }
    }

    /// Whole length.
    pub fn length(&self) -> f64 {
        self.starts[self.pieces.len()]
    }

    /// The way along the chain to its point next to `x`, ends included.
    pub fn nearest(&self, x: &Vec2) -> f64 {
        let along = |k: usize| {
            let way = self.pieces[k].foot(x).clamp(0.0, self.pieces[k].length());
            (self.starts[k] + way, (x - self.pieces[k].point(way)).norm())
        };
        let closer = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
        (0..self.pieces.len()).map(along).fold((0.0, f64::INFINITY), closer).0
    }

    /// The normal at the point next to `x`; where several pieces meet there, that of the one that is the most along `like`,
    /// whichever its sign.
    pub fn side_normal(&self, x: &Vec2, like: &Vec2) -> Vec2 {
        let foot = |piece: &Piece| {
            let way = piece.foot(x).clamp(0.0, piece.length());
            ((x - piece.point(way)).norm(), piece.normal(way))
        };
        let least = self.pieces.iter().map(|piece| foot(piece).0).fold(f64::INFINITY, f64::min);
        let meets = |(distance, _): &(f64, Vec2)| *distance <= least + KEEP * self.size;
        let normals = self.pieces.iter().map(foot).filter(meets).map(|(_, normal)| normal);
        normals.reduce(|a, b| more_along(like, a, b)).unwrap_or_default()
    }

    /// The chain and its first and second derivatives at a way along it.
    pub fn curve(&self, way: f64) -> [Vec2; 3] {
        let (piece, way) = self.locate(way);
        let along = piece.along(way);
        [piece.point(way), along, -right(&along) * piece.curvature()]
    }

    /// The normal at a way along the chain.
    pub fn normal(&self, way: f64) -> Vec2 {
        let (piece, way) = self.locate(way);
        piece.normal(way)
    }

    /// Greatest product of a direction with the points of the chain.
    pub fn support(&self, direction: &Vec2) -> f64 {
        let of_piece = |piece: &Piece| {
            let ends = [0.0, piece.length()].map(|way| piece.point(way).dot(direction));
            let top = match piece {
                Piece::Arc { center, radius, .. } => {
                    let way = piece.foot(&(center + direction * *radius));
                    piece.point(way.clamp(0.0, piece.length())).dot(direction)
                }
                Piece::Line { .. } => f64::NEG_INFINITY,
            };
            ends[0].max(ends[1]).max(top)
        };
        self.pieces.iter().map(of_piece).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Ways along the chain between which it is a line, or nearly one: arcs are cut to `segments` in a circle.
    pub fn stations(&self, segments: usize) -> Vec<f64> {
        let mut stations = vec![0.0];
        for (piece, start) in self.pieces.iter().zip(&self.starts) {
            let count = match piece {
                Piece::Line { .. } => 1,
                Piece::Arc { half, .. } => (half / std::f64::consts::PI * segments as f64).ceil().max(1.0) as usize,
            };
            stations.extend((1..=count).map(|k| start + piece.length() * k as f64 / count as f64));
        }
        stations
    }

    /// The piece at a way along the chain, and the way along that; the first and last go on beyond their ends.
    fn locate(&self, way: f64) -> (&Piece, f64) {
        let k = self.starts.partition_point(|start| *start <= way).clamp(1, self.pieces.len()) - 1;
        (&self.pieces[k], way - self.starts[k])
    }
}

impl Piece {
    fn reversed(&self) -> Self {
        match *self {
            Self::Line { from, along, length } => Self::Line { from: from + along * length, along: -along, length },
            Self::Arc { center, radius, middle, half, turn } => Self::Arc { center, radius, middle, half, turn: -turn },
        }
    }

    fn length(&self) -> f64 {
        match self {
            Self::Line { length, .. } => *length,
            Self::Arc { radius, half, .. } => 2.0 * radius * half,
        }
    }

    /// The way along the line or circle, which goes on beyond the ends, to its point next to `x`.
    fn foot(&self, x: &Vec2) -> f64 {
        match self {
            Self::Line { from, along, .. } => (x - from).dot(along),
            Self::Arc { center, radius, middle, half, turn } => {
                let arm = x - center;
                radius * (half + turn * middle.perp(&arm).atan2(middle.dot(&arm)))
            }
        }
    }

    fn point(&self, way: f64) -> Vec2 {
        match self {
            Self::Line { from, along, .. } => from + along * way,
            Self::Arc { center, radius, .. } => center + self.arm(way) * *radius,
        }
    }

    /// Unit vector along the piece.
    fn along(&self, way: f64) -> Vec2 {
        match self {
            Self::Line { along, .. } => *along,
            Self::Arc { turn, .. } => -right(&self.arm(way)) * *turn,
        }
    }

    fn normal(&self, way: f64) -> Vec2 {
        right(&self.along(way))
    }

    /// Of an arc, the unit vector from the centre.
    fn arm(&self, way: f64) -> Vec2 {
        let Self::Arc { radius, middle, half, turn, .. } = self else { return Vec2::zeros() };
        let (sin, cos) = (turn * (way / radius - half)).sin_cos();
        middle * cos - right(middle) * sin
    }

    /// Above 0 to the left.
    fn curvature(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { radius, turn, .. } => turn / radius,
        }
    }

    /// The projection on the line or circle.
    fn project(&self, x: &Vec2) -> Planar {
        match self {
            Self::Line { from, along, .. } => {
                let normal = right(along);
                Planar { gap: (x - from).dot(&normal), normal, gradient: Mat2::zeros() }
            }
            Self::Arc { center, radius, middle, turn, .. } => circle(x - center, *radius, *turn, *middle),
        }
    }
}
