//! Bézier patches as text (`.bpt`): the number of patches, then for each its degrees p and q and (p+1)(q+1) control
//! points, the one that goes with the first parameter running fastest.
//!
//! Each of these has a line of its own. A control point is `x y z`, or `x y z w` with a weight; `#` begins a comment.

use super::{Cad, Read};
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::mesh::message;
use crate::surface::{Face, KnotVector, Nurbs};
use std::str::FromStr;

/// Reads a whole file; `source` names it in messages.
pub(super) fn read(source: &str, data: &[u8]) -> Result<Read> {
    let mut lines = Lines { source, rest: data, number: 0, text: String::new() };
    let (mut cad, mut faults) = (Cad::default(), Vec::new());
    let [count]: [usize; 1] = lines.numbers("the number of patches")?;
    for number in 1..=count {
        let degrees: [usize; 2] = lines.numbers(&format!("two degrees, of patch {number} of {count},"))?;
        let at = lines.at();
        let [p, q] = degrees.map(|degree| degree.saturating_add(1));
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for _ in 0..p.saturating_mul(q) {
            let [x, y, z, weight] = lines.point(degrees)?;
            points.push(Vec3::new(x, y, z));
            weights.push(weight);
        }
        let name = format!("patch {number}");
        match patch(degrees, points, weights) {
            Ok(surface) => cad.faces.push(Face { surface, loops: Vec::new(), reversed: false, name }),
            Err(what) => faults.push(Error::input(&at, format!("{name}: {what}"), "")),
        }
    }
    match lines.advance() {
        true => Err(lines.error(format!("the file goes on behind its {count} patches"), "their number stands first")),
        false => Ok((cad, faults)),
    }
}

/// There are as many points as the degrees ask for.
fn patch(degrees: [usize; 2], points: Vec<Vec3>, weights: Vec<f64>) -> Result<Nurbs, String> {
    let knots = |degree: usize| KnotVector::new(degree, [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat());
    Nurbs::new([knots(degrees[0])?, knots(degrees[1])?], points, weights)
}

/// A walk over the lines that are neither blank nor comments.
struct Lines<'a> {
    source: &'a str,
    rest: &'a [u8],
    number: usize,
    /// The current line without comment.
    text: String,
}

impl Lines<'_> {
    /// Goes to the next line; false at the end.
    fn advance(&mut self) -> bool {
        while !self.rest.is_empty() {
            let length = self.rest.iter().position(|&c| c == b'\n').unwrap_or(self.rest.len());
            let line = self.rest[..length].split(|&c| c == b'#').next().unwrap_or_default();
            self.text = String::from_utf8_lossy(line).trim().to_string();
            self.rest = &self.rest[(length + 1).min(self.rest.len())..];
            self.number += 1;
            if !self.text.is_empty() {
                return true;
            }
        }
        self.text.clear();
        false
    }

    /// The next line, which must have `N` numbers.
    fn numbers<T: FromStr, const N: usize>(&mut self, what: &str) -> Result<[T; N]> {
        let numbers = if self.advance() { parse(&self.text) } else { return Err(self.cut_off(what)) };
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| self.error(format!("expected {what}"), ""))
    }

    /// The next line: three coordinates and a weight, 1 where there is none.
    fn point(&mut self, [p, q]: [usize; 2]) -> Result<[f64; 4]> {
        if !self.advance() {
            return Err(self.cut_off("a control point"));
        }
        match parse(&self.text).as_deref() {
            Some(&[x, y, z]) => Ok([x, y, z, 1.0]),
            Some(&[x, y, z, weight]) => Ok([x, y, z, weight]),
            _ => {
                let help = format!("degrees {p} and {q} have (p+1)(q+1) points: x y z, or x y z and a weight");
                Err(self.error("expected a control point", help))
            }
        }
    }

    fn cut_off(&self, what: &str) -> Error {
        message::whole_file(self.source, format!("the file ends where {what} is expected"), "it seems cut off")
    }

    fn error(&self, what: impl Into<String>, help: impl Into<String>) -> Error {
        Error::input(&self.at(), what, help)
    }

    fn at(&self) -> Location {
        let text = message::shorten(self.text.as_bytes(), 100).into();
        Location { file: self.source.into(), line: self.number, column: 1, text }
    }
}

/// All words of a line as numbers.
fn parse<T: FromStr>(text: &str) -> Option<Vec<T>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bilinear patch, and a quarter of a cylinder that is one rational patch.
    const FILE: &str = "# two patches\n2\n1 1  # degrees\n0 0 0\n1 0 0\n\n0 2 0\n1 2 5\n2 1\n\
        1 0 0\n1 1 0 0.7071067811865476\n0 1 0\n1 0 3\n1 1 3 0.7071067811865476\n0 1 3 1\n";

    fn message_of(text: &str) -> String {
        match read("die.bpt", text.as_bytes()) {
            Err(error) => error.to_string(),
            Ok((_, faults)) => faults[0].to_string(),
        }
    }

    #[test]
    fn patches_are_exact() {
        for text in [FILE.to_string(), FILE.replace('\n', "\r\n")] {
            let (cad, faults) = read("die.bpt", text.as_bytes()).unwrap();
            assert!(faults.is_empty() && cad.faces.len() == 2);
            let [plane, wall] = [0, 1].map(|k| &cad.faces[k].surface);
            assert_eq!(cad.faces[1].name, "patch 2");
            for k in 0..=10 {
                let t = k as f64 / 10.0;
                let point = plane.local([t, 0.3]).point;
                assert!((point - Vec3::new(t, 0.6, 1.5 * t)).norm() < 1e-15);
                let point = wall.local([t, 0.3]).point;
                assert!((point.xy().norm() - 1.0).abs() < 1e-15 && (point.z - 0.9).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn broken_files_say_where() {
        let broken = |from: &str, to: &str| message_of(&FILE.replacen(from, to, 1));
        assert!(broken("\n2\n", "\ntwo\n").starts_with("die.bpt:2:1: expected the number of patches\n  | two"));
        assert!(broken("\n2\n", "\n3\n").contains("ends where two degrees, of patch 3 of 3, is expected"));
        assert!(broken("\n2\n", "\n1\n").contains("die.bpt:9:1: the file goes on behind its 1 patches"));
        assert!(broken("1 1  #", "1 1 1 #").starts_with("die.bpt:3:1: expected two degrees, of patch 1 of 2,"));
        assert!(broken("1 1  #", "0 3 #").contains("die.bpt:3:1: patch 1: the degree is 0"));
        let text = broken("1 1  #", "2 2 #");
        assert!(
            text.starts_with("die.bpt:9:1: expected a control point") && text.contains("degrees 2 and 2"),
            "{text}"
        );
        assert!(broken("0 2 0", "0 nan 0").contains("not a finite number"));
        assert!(broken(" 0.7", " -0.7").contains("die.bpt:9:1: patch 2: weight 2 is -0.7"));
        let huge = broken("1 1  #", "18446744073709551615 99999999999 #");
        assert!(huge.contains("expected a control point") || huge.contains("ends where"), "{huge}");
        assert!(message_of("").contains("the file ends where the number of patches is expected"));
    }
}
