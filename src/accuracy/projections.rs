//! Points of a CSV file projected onto a surface.

use super::described::Described;
use super::errors::reach;
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::surface::Projection;
use std::fmt::Write as _;
use std::path::Path;

/// How a point is projected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Along the normal of a piece.
    Normal,
    /// Along the normal of an extended piece.
    Extended,
    /// Only onto an edge or corner between pieces.
    Edge,
    /// Beyond the end of the surface.
    None,
}

impl Kind {
    const ALL: [Self; 4] = [Self::Normal, Self::Extended, Self::Edge, Self::None];

    /// What stands in the file.
    pub fn key(self) -> &'static str {
        ["normal", "extended", "edge", "none"][self as usize]
    }
}

/// A point and its projection; where there is no normal one, the nearest point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    pub point: Vec3,
    pub kind: Kind,
    pub piece: u32,
    pub xi: [f64; 2],
    /// Distance, positive outside.
    pub gap: f64,
    pub normal: Vec3,
}

impl Row {
    /// Length of [`Self::to_array`].
    pub const LEN: usize = 11;

    /// The row as numbers, to be sent to another rank.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let [x, n] = [self.point, self.normal];
        let head = [x.x, x.y, x.z, f64::from(self.kind as u8), f64::from(self.piece)];
        let [h0, h1, h2, h3, h4] = head;
        [h0, h1, h2, h3, h4, self.xi[0], self.xi[1], self.gap, n.x, n.y, n.z]
    }

    /// The row of [`Self::to_array`].
    pub fn from_array(a: &[f64; Self::LEN]) -> Self {
        Self {
            point: Vec3::new(a[0], a[1], a[2]),
            kind: Kind::ALL[(a[3] as usize).min(3)],
            piece: a[4] as u32,
            xi: [a[5], a[6]],
            gap: a[7],
            normal: Vec3::new(a[8], a[9], a[10]),
        }
    }
}

/// Projects a point: strictly, then on pieces extended by `extension`, then onto the nearest point.
pub fn project(surface: &dyn Described, x: &Vec3, extension: f64) -> Option<Row> {
    let nearest = surface.nearest(x)?;
    let reach = reach(nearest.gap);
    let strict = surface.normal_projection(x, 0.0, reach).map(|foot| (Kind::Normal, foot));
    let soft = || surface.normal_projection(x, extension, reach).map(|foot| (Kind::Extended, foot));
    let found = strict.or_else(|| if extension > 0.0 { soft() } else { None });
    Some(match found {
        Some((kind, foot)) => {
            let normal = surface.normal(foot.index, foot.xi);
            Row { point: *x, kind, piece: foot.piece, xi: foot.xi, gap: foot.gap, normal }
        }
        None => {
            let kind = if surface.is_beyond(x) { Kind::None } else { Kind::Edge };
            let Projection { patch: piece, xi, gap, normal, .. } = nearest;
            Row { point: *x, kind, piece, xi, gap, normal }
        }
    })
}

/// Number of rows of each kind.
pub fn count(rows: &[Row]) -> [usize; 4] {
    Kind::ALL.map(|kind| rows.iter().filter(|row| row.kind == kind).count())
}

/// `projections.csv`.
pub fn render(rows: &[Row]) -> String {
    let mut text = "x,y,z,kind,patch,xi1,xi2,gap,nx,ny,nz\n".to_string();
    for Row { point, kind, piece, xi, gap, normal } in rows {
        let [x, y, z]: [f64; 3] = (*point).into();
        let [a, b] = xi;
        let _ = writeln!(
            text,
            "{x:?},{y:?},{z:?},{},{piece},{a:?},{b:?},{gap:?},{:?},{:?},{:?}",
            kind.key(),
            normal.x,
            normal.y,
            normal.z
        );
    }
    text
}

/// Points of a CSV file: x, y, z in its first three columns; its first line may name them.
///
/// # Errors
/// Wrong input, with its line, where three finite numbers are missing.
pub fn read_points(path: &Path) -> Result<Vec<Vec3>> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::input_anywhere(format!("cannot read {name}: {error}"), "--points names a CSV file"))?;
    parse_points(&text, &name)
}

fn parse_points(text: &str, name: &str) -> Result<Vec<Vec3>> {
    let mut points = Vec::new();
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (first, (number, line)) in lines.enumerate().map(|(k, line)| (k == 0, line)) {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let numbers: Option<Vec<f64>> =
            fields.iter().take(3).map(|field| field.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match numbers.as_deref() {
            Some(&[x, y, z]) => points.push(Vec3::new(x, y, z)),
            _ if first && fields.iter().all(|field| field.parse::<f64>().is_err()) => {}
            _ => {
                let text = line.chars().take(120).collect::<String>();
                let at = Location { file: name.into(), line: number + 1, column: 1, text: text.into() };
                return Err(Error::input(&at, "is not a point", "each line is `x,y,z`, three finite numbers"));
            }
        }
    }
    match points.is_empty() {
        true => Err(Error::input_anywhere(format!("{name} has no points"), "each line is `x,y,z`")),
        false => Ok(points),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_with_and_without_names() {
        for text in ["x,y,z\n1,2,3\n\n-1e3, 0.5 ,0,more\n", "1,2,3\r\n-1e3,.5,0\r\n", "\nx y z\n1,2,3\n-1000,0.5,0"] {
            let points = parse_points(text, "a.csv").unwrap();
            assert_eq!(points, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1000.0, 0.5, 0.0)]);
        }
    }

    #[test]
    fn what_is_no_point_is_refused_with_its_line() {
        for (text, line) in [("1,2,3\n1,2\n", 2), ("x,y,z\n1,2,nan\n", 2), ("1,2\n", 1), ("1;2;3\n4,5,6\nx,y,z", 3)] {
            let error = parse_points(text, "a.csv").unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().starts_with(&format!("a.csv:{line}:1: is not a point")), "{error}");
        }
        for text in ["", "\n\n", "x,y,z\n"] {
            assert!(parse_points(text, "a.csv").unwrap_err().to_string().contains("has no points"));
        }
    }

    #[test]
    fn rows_survive_their_journey() {
        for kind in Kind::ALL {
            let row = Row {
                point: Vec3::new(1.0, -2.0, 0.3),
                kind,
                piece: 7,
                xi: [0.25, -0.01],
                gap: -1.5,
                normal: Vec3::new(0.0, 0.6, -0.8),
            };
            assert_eq!(Row::from_array(&row.to_array()), row);
        }
    }
}
