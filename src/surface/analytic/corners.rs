//! The corners of a chain of lines: where the way turns, and what fillets take of the lines.

use crate::Vec2;

/// Way, over the size of the chain, that counts as none; also how far beyond its open ends it goes.
pub const ROUNDED: f64 = 1e-9;
/// Radians by which two lines without a fillet may differ and still go on smoothly.
pub const STRAIGHT: f64 = 1e-9;

/// What is wrong with the points and fillets of a chain: the number of the point, from 0, and whether its fillet is.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    pub point: usize,
    pub fillet: bool,
    pub what: String,
}

/// The corners of a chain, and the lines between them.
pub struct Corners<'a> {
    pub radii: &'a [f64],
    /// Of each line, its direction and length between the points.
    pub ways: Vec<Vec2>,
    pub lengths: Vec<f64>,
    /// Of each point, the angle by which the way turns to the left there, and what its fillet takes of the lines.
    pub turns: Vec<f64>,
    pub cuts: Vec<f64>,
}

impl<'a> Corners<'a> {
    /// Fails on points that repeat or turn back, lines that cross, and fillets that do not fit; `size` is that of the chain.
    pub fn new(points: &[Vec2], radii: &'a [f64], closed: bool, size: f64) -> Result<Self, Misfit> {
        let count = points.len();
        let lines = if closed { count } else { count - 1 };
        let mut corners =
            Self { radii, ways: Vec::new(), lengths: Vec::new(), turns: vec![0.0; count], cuts: vec![0.0; count] };
        for k in 0..lines {
            let line = points[(k + 1) % count] - points[k];
            if line.norm() <= ROUNDED * size {
                let what = format!("is the same as points.{k}");
                return Err(Misfit { point: (k + 1) % count, fillet: false, what });
            }
            corners.ways.push(line.normalize());
            corners.lengths.push(line.norm());
        }
        for k in (0..count).filter(|k| closed || (1..count - 1).contains(k)) {
            let (back, on) = (corners.ways[(k + lines - 1) % lines], corners.ways[k % lines]);
            let turn = back.perp(&on).atan2(back.dot(&on));
            if turn.abs() > std::f64::consts::PI - 1e-6 {
                return Err(Misfit { point: k, fillet: false, what: "turns back on itself".into() });
            }
            corners.turns[k] = if turn.abs() > STRAIGHT { turn } else { 0.0 };
            corners.cuts[k] = radii[k] * (0.5 * corners.turns[k].abs()).tan();
        }
        for k in 0..lines {
            let (from, to) = (k, (k + 1) % count);
            let room = corners.lengths[k];
            if corners.cuts[from] + corners.cuts[to] > room + ROUNDED * size {
                let point = if corners.cuts[to] >= corners.cuts[from] { to } else { from };
                let [room, taken] = [room, corners.cuts[from] + corners.cuts[to]].map(short);
                let what = format!(
                    "does not fit: the line from points.{from} to points.{to} is {room} long, its fillets take {taken} of it"
                );
                return Err(Misfit { point, fillet: true, what });
            }
        }
        if let Some((line, other)) = corners.crossing(points, size) {
            let what = format!("begins a line that crosses the one from points.{other} to points.{}", other + 1);
            return Err(Misfit { point: line, fillet: false, what });
        }
        Ok(corners)
    }

    /// The first line that crosses one before it, and that one. Neighbours meet in a point, and do not cross.
    fn crossing(&self, points: &[Vec2], size: f64) -> Option<(usize, usize)> {
        let end = |line: usize| points[(line + 1) % points.len()];
        let beside = |point: Vec2, line: usize| self.ways[line].perp(&(point - points[line]));
        let parts = |line: usize, ends: usize| {
            let [a, b] = [beside(points[ends], line), beside(end(ends), line)];
            a * b < 0.0 && a.abs().min(b.abs()) > ROUNDED * size
        };
        let lines = 0..self.ways.len();
        lines.flat_map(|line| (0..line).map(move |other| (line, other))).find(|&(a, b)| parts(a, b) && parts(b, a))
    }

    /// The direction of a line, counted around.
    pub fn way(&self, line: usize) -> Vec2 {
        self.ways[line % self.ways.len()]
    }
}

/// Radii must be above 0, but at the ends of an open chain.
pub fn check_radii(points: &[Vec2], closed: bool) -> Result<(), Misfit> {
    let last = points.len() - 1;
    let misfit = |point: usize, what: &str| Err(Misfit { point, fillet: false, what: what.into() });
    for (k, point) in points.iter().enumerate() {
        let is_end = !closed && (k == 0 || k == last);
        if point.x < 0.0 {
            return misfit(k, "has a radius below 0");
        }
        if point.x == 0.0 && !is_end {
            return misfit(k, "lies on the axis, where only the ends of a chain may lie");
        }
    }
    if !closed && last == 1 && points[0].x == 0.0 && points[1].x == 0.0 {
        return misfit(1, "lies on the axis, as the point before it");
    }
    Ok(())
}

/// A length for a message: six digits.
fn short(length: f64) -> f64 {
    format!("{length:.5e}").parse().unwrap_or(length)
}
